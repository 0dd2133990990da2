//! `jointplay import`: conversion of MJCF, SDF and URDF models.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::mechanism::{self, MAX_BYTES};
use jointplay::format::number::counted;
use jointplay::interop::import::{self, Imported};
use jointplay::mechanism::Mechanism;
use serde::Serialize;

use crate::failure::Failure;
use crate::folder::ForceArgs;
use crate::mechanism_input::imported;
use crate::output::FormatArgs;
use crate::source::{Kind, STANDARD, Source};
use crate::{folder, output};

/// Convert a MuJoCo (MJCF), Gazebo (SDF) or ROS (URDF) model into a mechanism file
///
/// Elements without a counterpart in a mechanism, such as masses and shapes, are listed as ignored.
/// Elements that would change the mechanism if ignored are errors.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay import robot.urdf
  jointplay import robot.urdf --loops loops.toml --output robot.toml")]
pub(crate) struct Import {
    /// Model file; the format is detected from its root element
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// File of joints that close loops, for URDF, which describes trees only
    #[arg(long, value_name = "FILE")]
    loops: Option<PathBuf>,
    /// Mechanism file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

/// The imported mechanism: the file that it was written to, or its text.
#[derive(Serialize)]
struct ImportReport {
    model_format: &'static str,
    links: usize,
    joints: usize,
    loops: usize,
    ignored: Vec<String>,
    file: Option<String>,
    text: Option<String>,
}

impl Import {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let source = Source::read(&self.model, MAX_BYTES)?;
        source.require(&[Kind::Model], "a model of MuJoCo, Gazebo or ROS")?;
        if !import::is_model(&source.text) {
            let label = &source.label;
            return Err(Failure::Usage(format!(
                "{label} is not a model: models are XML files of MuJoCo, Gazebo or ROS"
            )));
        }
        let Imported { mechanism, dialect, ignored } = imported(&source)?;
        let mechanism = match &self.loops {
            Some(loops) => close(&mechanism, loops)?,
            None => mechanism,
        };
        let file_name = if self.model == Path::new(STANDARD) {
            source.label.as_str().into()
        } else {
            self.model.file_name().unwrap_or_default().to_string_lossy()
        };
        let origin = format!("{file_name}, a model in {}", dialect.name());
        let text = mechanism::write(&mechanism, Some(&origin));
        if !self.format.json() {
            output::ignored(&ignored);
        }
        let path = self.output.as_deref().filter(|path| *path != Path::new(STANDARD));
        if let Some(path) = path {
            if let Some(folder) = path.parent() {
                std::fs::create_dir_all(folder)
                    .map_err(|source| Failure::Write { path: folder.to_owned(), source })?;
            }
            folder::write_file(path, text.as_bytes(), self.force)?;
        } else if !self.format.json() {
            return output::raw(&text);
        }
        let report = ImportReport {
            model_format: dialect.name(),
            links: mechanism.links().len(),
            joints: mechanism.joints().len(),
            loops: mechanism.loops(),
            ignored,
            file: path.map(|path| path.display().to_string()),
            text: path.is_none().then_some(text),
        };
        self.format.print(&report, |report| {
            format!(
                "written to {}: {}, {}, {}\n",
                report.file.as_deref().unwrap_or_default(),
                counted(report.links, "link"),
                counted(report.joints, "joint"),
                counted(report.loops, "loop"),
            )
        })
    }
}

fn close(chain: &Mechanism, loops: &Path) -> Result<Mechanism, Failure> {
    let source = Source::read(loops, MAX_BYTES)?;
    source.require(&[Kind::Loops], "a file of loops")?;
    let closed = mechanism::with_loops(chain, &source.text);
    closed.map_err(|errors| Failure::invalid(&errors, &source.label))
}
