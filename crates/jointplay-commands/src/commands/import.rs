//! `jointplay import`: conversion of MJCF, SDF, URDF and FreeCAD models, and between three-rod robots and mechanisms.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::explain::explain_recognition;
use jointplay::format::mechanism::{self, Expected, LengthUnit, MAX_BYTES, MechanismFile, Units};
use jointplay::format::number::counted;
use jointplay::format::{robot, three_rods};
use jointplay::interop::import::{self, ClosedError, Imported, LoopsError};
use jointplay::mechanism::Mechanism;
use serde::Serialize;

use crate::arguments::{VirtualizationName, tilt_angle};
use crate::failure::Failure;
use crate::folder::ForceArgs;
use crate::mechanism_input::Input;
use crate::model_input::{expanded, imported, located};
use crate::output::FormatArgs;
use crate::source::{Kind, STANDARD, Source};
use crate::{folder, output};

/// Convert a model of MuJoCo (MJCF), Gazebo (SDF), ROS (URDF) or FreeCAD (.FCStd, .asmt) into a mechanism file
///
/// A three-rod robot also becomes a mechanism, with the virtual joints of a virtualization; with `--to
/// gpr`, a mechanism or model that is a three-rod robot becomes a robot file.
///
/// Elements without a counterpart in a mechanism, such as masses and shapes, are listed as ignored.
/// Elements that would change the mechanism if ignored are errors.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay import robot.urdf
  jointplay import robot.urdf --loops loops.toml --out robot.toml
  jointplay import robot.urdf --loops loop_closures.yaml
  jointplay import assembly.FCStd
  jointplay import assembly.asmt --units mm
  jointplay import gpr --virtualization radial
  jointplay import gpr-mechanism --to gpr --tilt-limit-deg 1.5")]
pub(crate) struct Import {
    /// Model: MJCF, SDF or URDF, a document of FreeCAD (.FCStd) or its assembly (.asmt), detected from
    /// their contents; a three-rod robot or a mechanism (TOML); or a name from `jointplay catalogue`
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// Unit of lengths of an ASMT assembly of FreeCAD, which does not state it; FreeCAD writes mm
    #[arg(long, value_name = "UNIT", value_parser = unit)]
    units: Option<LengthUnit>,
    /// Kind of the file to write
    #[arg(long, value_name = "KIND", default_value = "mechanism")]
    to: Target,
    /// Virtual joints of a three-rod robot as a mechanism [default: planar]
    #[arg(long, value_name = "MODEL")]
    virtualization: Option<VirtualizationName>,
    /// Largest tilt of a three-rod robot, which a mechanism does not state
    #[arg(long, value_name = "DEG", value_parser = tilt_angle)]
    tilt_limit_deg: Option<f64>,
    /// File of joints that close loops, for URDF, which describes trees only: TOML, or YAML with
    /// `closures` (loop_closures.yaml of exporters) or `closed_loop` (robot.yaml of collections)
    #[arg(long, value_name = "FILE")]
    loops: Option<PathBuf>,
    /// Mechanism file to write [default: standard output]
    #[arg(short, long, alias = "output", value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

/// Kinds of files that are written.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Target {
    /// A mechanism file
    Mechanism,
    /// A file of a three-rod robot
    Gpr,
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
        let (kinds, needed): (&[Kind], _) = match self.to {
            Target::Mechanism => (
                &[Kind::Model, Kind::ThreeRods],
                "a model of MuJoCo, Gazebo, ROS or FreeCAD, or a three-rod robot",
            ),
            Target::Gpr => (&[Kind::Model, Kind::Mechanism], "a mechanism or a model"),
        };
        source.require(kinds, needed)?;
        let kind = source.kind();
        self.refuse_unused(&source)?;
        let Imported { mechanism, dialect, ignored } = match kind {
            Some(Kind::Model) => match &self.loops {
                Some(loops) => closed(&source, self.units, loops)?,
                None => imported(&source, self.units)?,
            },
            Some(Kind::ThreeRods) => return self.write_mechanism(&source),
            Some(Kind::Mechanism) => {
                let file = Input::parse(&source, &[])?.file;
                return self.write_robot("mechanism", &file, Vec::new());
            }
            _ => {
                let label = &source.label;
                return Err(Failure::Usage(format!(
                    "{label} is not a model: models are files of MuJoCo, Gazebo, ROS or FreeCAD"
                )));
            }
        };
        let origin = format!("{}, a model in {}", self.file_name(&source), dialect.name());
        if self.to == Target::Gpr {
            let file = MechanismFile {
                mechanism,
                source: Some(origin),
                units: Units::SI,
                parameters: Vec::new(),
                expected: Expected::default(),
            };
            return self.write_robot(dialect.name(), &file, ignored);
        }
        let text = mechanism::write(&mechanism, Some(&origin));
        self.write(dialect.name(), &mechanism, ignored, text)
    }

    /// Refuses options that apply to another conversion.
    fn refuse_unused(&self, source: &Source) -> Result<(), Failure> {
        let kind = source.kind();
        let unused = [
            (self.loops.is_some() && kind != Some(Kind::Model), "--loops applies to models"),
            (
                self.units.is_some() && !import::is_assembly(&source.text),
                "--units applies to assemblies of FreeCAD in ASMT; other files state their units",
            ),
            (
                self.virtualization.is_some() && kind != Some(Kind::ThreeRods),
                "--virtualization applies to three-rod robots",
            ),
            (
                self.tilt_limit_deg.is_some() && self.to != Target::Gpr,
                "--tilt-limit-deg applies to `--to gpr`",
            ),
        ];
        match unused.into_iter().find(|(unused, _)| *unused) {
            Some((_, text)) => Err(Failure::Usage(text.to_owned())),
            None => Ok(()),
        }
    }

    /// The name of the input in the file written.
    fn file_name(&self, source: &Source) -> String {
        if self.model == Path::new(STANDARD) {
            return source.label.clone();
        }
        self.model.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Writes a three-rod robot as a mechanism.
    fn write_mechanism(&self, source: &Source) -> Result<(), Failure> {
        let robot = robot::parse(&source.text)
            .map_err(|errors| Failure::invalid(&errors, &source.label))?;
        let model = self.virtualization.unwrap_or(VirtualizationName::Planar).built_in();
        let Some(file) = three_rods::mechanism_file(&robot, model) else {
            let text = "no virtual joint of a mechanism is a displacement in polar coordinates: use --virtualization radial, polar or planar";
            return Err(Failure::Usage(text.to_owned()));
        };
        let mechanism = file.mechanism;
        let origin = format!("{}, a three-rod robot", self.file_name(source));
        let text = mechanism::write(&mechanism, Some(&origin));
        self.write("three-rod robot", &mechanism, three_rods::lost_in_mechanism(&robot), text)
    }

    /// Writes a mechanism that is a three-rod robot as a robot file.
    fn write_robot(
        &self,
        model_format: &'static str,
        file: &MechanismFile,
        mut ignored: Vec<String>,
    ) -> Result<(), Failure> {
        let Some(tilt_deg) = self.tilt_limit_deg else {
            let text = "a mechanism does not state a largest tilt: give --tilt-limit-deg";
            return Err(Failure::Usage(text.to_owned()));
        };
        let robot = three_rods::robot(file, tilt_deg.to_radians()).map_err(|error| {
            Failure::Usage(explain_recognition(file.mechanism.name(), &error, DisplayUnits::Metric))
        })?;
        ignored.extend(three_rods::lost_in_robot(file));
        self.write(model_format, &file.mechanism, ignored, robot::write(&robot))
    }

    /// Writes the converted file and reports it.
    fn write(
        &self,
        model_format: &'static str,
        mechanism: &Mechanism,
        ignored: Vec<String>,
        text: String,
    ) -> Result<(), Failure> {
        if !self.format.json() {
            output::ignored(&ignored);
        }
        let path = self.out.as_deref().filter(|path| *path != Path::new(STANDARD));
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
            model_format,
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

fn unit(text: &str) -> Result<LengthUnit, String> {
    let known = LengthUnit::ALL;
    let found = known.into_iter().find(|(name, _)| *name == text);
    found.map(|(_, unit)| unit).ok_or_else(|| {
        let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
        format!("the unit must be one of {}, got {text:?}", names.join(", "))
    })
}

/// A model with its loops closed by a second file.
fn closed(model: &Source, unit: Option<LengthUnit>, loops: &Path) -> Result<Imported, Failure> {
    let source = Source::read(loops, MAX_BYTES)?;
    source.require(&[Kind::Loops], "a file of loops")?;
    let text = expanded(model)?;
    import::parse_closed(&text.text, unit, &source.text).map_err(|error| match error {
        ClosedError::Model(error) => located(model, &text.locate(error)),
        ClosedError::Loops(LoopsError::Toml(errors)) => Failure::invalid(&errors, &source.label),
        ClosedError::Loops(LoopsError::Yaml(error)) => Failure::at(&error, &source.label),
        other => Failure::Usage(other.to_string()),
    })
}
