//! `jointplay export`: mechanisms in formats of other programs; a file for each family of formats.

mod files;
mod fmu;
mod simulator;

use std::path::PathBuf;

use clap::Args;
use jointplay::interop::export::mechanism::{mjcf, modelica, modelica_class, sdf, urdf};
use jointplay::mechanism::{Mechanism, Posed};
use serde::Serialize;

use self::files::{Files, Format};
use self::fmu::FmuArgs;
use crate::failure::Failure;
use crate::folder::{self, ForceArgs};
use crate::mechanism_input::{JointValues, MechanismArgs, joint_values};
use crate::source;

/// Export a mechanism for MuJoCo (MJCF), Gazebo (SDF), ROS (URDF) or Modelica, with its play as joints, or as a functional mock-up unit (FMI)
///
/// In MJCF, SDF, URDF and Modelica virtual joints become slides and hinges with a spring, and a range where the file states their clearance; actuated joints have position actuators, or inputs in Modelica.
/// The configuration nearest to the guess of the file, or that of --at, is the reference configuration of the model.
/// Everything that a format cannot keep is listed.
/// A functional mock-up unit for co-simulation has the drives as inputs, and as outputs the poses of links and attached frames and the displacements of virtual joints; it computes with this library, which it contains.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay export gpr-mechanism --to mjcf
  jointplay export hexapod --to mjcf,sdf,urdf --out models
  jointplay export four-bar --to mjcf --at A=30 --out crank-at-30
  jointplay export gpr-mechanism --to modelica --out modelica
  jointplay export gpr-mechanism --to mjcf --rigid --out rigid
  jointplay export hexapod --to fmu --out units
  jointplay export gpr --to fmu --fmi 3 --virtualization polar --out polar-units

Exit codes: 0 written, 1 the loops do not close or drives do not determine the motion, 2 bad input or usage, or a joint that the format does not have.")]
pub(crate) struct Export {
    #[command(flatten)]
    pub(crate) mechanism: MechanismArgs,
    /// Formats, separated by commas
    #[arg(long, value_enum, value_name = "FORMATS", value_delimiter = ',', required = true)]
    to: Vec<Format>,
    /// Commanded joint coordinates of the reference configuration, in the units of the file
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values)]
    at: Vec<JointValues>,
    /// Omit the virtual joints
    #[arg(long)]
    rigid: bool,
    /// Folder for the files
    #[arg(short, long, value_name = "FOLDER", default_value = "export")]
    out: PathBuf,
    #[command(flatten)]
    fmu: FmuArgs,
    #[command(flatten)]
    force: ForceArgs,
}

/// The exported models.
#[derive(Serialize)]
struct ExportReport {
    name: String,
    exports: Vec<Exported>,
}

/// The files of one format.
#[derive(Serialize)]
struct Exported {
    format: &'static str,
    files: Vec<String>,
    /// Properties of the mechanism that the format does not keep.
    lost: Vec<String>,
}

impl Export {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if !self.to.contains(&Format::Fmu) {
            self.fmu.refuse()?;
        }
        folder::check_folder(&self.out, self.force)?;
        let mut input = self.mechanism.load()?;
        if self.rigid {
            input.remove_virtual_joints();
        }
        let commands = input.commands(&self.at)?;
        let mechanism = &input.file.mechanism;
        let stem = source::stem(self.mechanism.path());
        let mut formats: Vec<Format> = Vec::new();
        for &format in &self.to {
            if !formats.contains(&format) {
                formats.push(format);
            }
        }
        // A unit finds its initial configuration itself; a model starts at one, and its limits are those of the mechanism.
        let at = match formats.iter().all(|&format| format == Format::Fmu) {
            true => None,
            false => {
                let Posed { closed, .. } = input.posed(&commands)?;
                input.within_limits(&closed.coordinates)?;
                Some(closed.coordinates)
            }
        };
        let exports: Vec<Files> = formats
            .into_iter()
            .map(|format| match (format, &at) {
                (Format::Mjcf, Some(at)) => {
                    simulator::files(("MJCF", "xml"), mjcf(mechanism, at), &stem)
                }
                (Format::Modelica, Some(at)) => {
                    let class = modelica_class(&stem);
                    let written = modelica(mechanism, at, &class);
                    simulator::files(("Modelica", "mo"), written, &class)
                }
                (Format::Sdf, Some(at)) => {
                    simulator::files(("SDF", "sdf"), sdf(mechanism, at), &stem)
                }
                (Format::Urdf, Some(at)) => {
                    simulator::files(("URDF", "urdf"), urdf(mechanism, at), &stem)
                }
                (Format::Fmu, _) | (_, None) => {
                    self.fmu.files(&input, &commands, self.rigid, &stem)
                }
            })
            .collect::<Result<_, _>>()?;
        let files: Vec<(String, Vec<u8>)> =
            exports.iter().flat_map(|one| one.files.iter().cloned()).collect();
        folder::write(&self.out, &files, self.force)?;
        self.print(mechanism, exports)
    }

    fn print(&self, mechanism: &Mechanism, exports: Vec<Files>) -> Result<(), Failure> {
        let path = |(name, _): &(String, Vec<u8>)| self.out.join(name).display().to_string();
        let exports = exports
            .into_iter()
            .map(|Files { format, files, lost }| Exported {
                format,
                files: files.iter().map(path).collect(),
                lost,
            })
            .collect();
        let report = ExportReport { name: mechanism.name().to_owned(), exports };
        self.mechanism.format.print(&report, |report| {
            let mut text = format!("{}, exported\n", report.name);
            for Exported { format, files, lost } in &report.exports {
                text += &format!("  {format:<5} {}\n", files.join(", "));
                for one in lost {
                    text += &format!("        lost or changed: {one}\n");
                }
            }
            text
        })
    }
}
