//! `jointplay import`: models of other programs as mechanism files.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::import::{self, Imported};
use jointplay::format::mechanism;
use jointplay::mechanism::Mechanism;

use crate::failure::Failure;
use crate::mechanism_input::{Source, imported};
use crate::{folder, output};

/// Take over a model of MuJoCo (MJCF), Gazebo (SDF) or ROS (URDF) as a mechanism file
///
/// What has no place in a mechanism is listed as ignored; what would change the mechanism if it were ignored is an error.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay import robot.urdf
  jointplay import robot.urdf --loops loops.toml --output robot.toml")]
pub(crate) struct Import {
    /// Model file; its root element tells which kind it is
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// Joints that close loops, for URDF, which can write trees only
    #[arg(long, value_name = "FILE")]
    loops: Option<PathBuf>,
    /// The mechanism file to write; without it, standard output
    #[arg(long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Import {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let source = Source::read(&self.model)?;
        if !import::is_model(&source.text) {
            let label = &source.label;
            return Err(Failure::Misused(format!(
                "{label} is no model: models are XML files, of MuJoCo, Gazebo or ROS"
            )));
        }
        let Imported { mechanism, dialect, ignored } = imported(&source)?;
        let mechanism = match &self.loops {
            Some(loops) => close(&mechanism, loops)?,
            None => mechanism,
        };
        let file_name = self.model.file_name().unwrap_or_default().to_string_lossy();
        let origin = format!("{file_name}, a model in {}", dialect.name());
        let text = mechanism::write(&mechanism, Some(&origin));
        output::ignored(&ignored);
        let Some(path) = &self.output else { return output::raw(&text) };
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        folder::write_new(folder, path, text.as_bytes())?;
        output::text(&format!(
            "written to {}: {} links, {} joints, {} loops\n",
            path.display(),
            mechanism.links().len(),
            mechanism.joints().len(),
            mechanism.loops(),
        ))
    }
}

fn close(chain: &Mechanism, loops: &Path) -> Result<Mechanism, Failure> {
    let source = Source::read(loops)?;
    let closed = mechanism::with_loops(chain, &source.text);
    closed.map_err(|error| Failure::at(&error, &source.label))
}
