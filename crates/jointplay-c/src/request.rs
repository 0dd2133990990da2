//! Requests and answers in JSON.

use std::ffi::CString;

use jointplay::format::coordinates::{self, Coordinates};
use jointplay::format::mechanism::MechanismFile;
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::mechanism::{
    FrameId, MechanismSystem, OpenLoops, close_sparse, mechanism_mobility, pose_commanded,
    relieve_commanded,
};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay::report;
use jointplay::sensitivity::commanded_sensitivity;
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Planar, SolveOptions};
use serde::Serialize;

use crate::catch::Failure;
use crate::fields::{Fields, Values, needed};
use crate::motion_request::{Move, Named, Suggest};
use crate::virtualization::named;

fn document(report: &impl Serialize) -> Result<CString, Failure> {
    let text = serde_json::to_string(report).map_err(|error| Failure::internal(error.to_string()));
    CString::new(text?).map_err(|error| Failure::internal(error.to_string()))
}

/// Answers a request about a robot.
pub(crate) fn of_robot(gpr: &Gpr, request: &str) -> Result<CString, Failure> {
    let options = SolveOptions::default();
    let height = |given: Option<f64>| AxisHeight(given.unwrap_or(gpr.working_height()));
    let mut fields = Fields::of_request(request)?;
    let tilted = ["azimuth_rad", "tilt_rad", "height_m", "virtualization"];
    match fields.kind(&["forward", "inverse", "mobility", "sensitivity"])? {
        "forward" => {
            let mut fields = fields.only(&["rods_m", "virtualization"])?;
            let rods = needed("rods_m", fields.three("rods_m")?)?;
            let model = named(fields.text("virtualization")?.as_deref())?;
            let pose = gpr.forward(rods, model, &options)?;
            document(&report::forward(gpr, &pose, model, &[]))
        }
        "inverse" => {
            let mut fields = fields.only(&tilted)?;
            let azimuth = fields.number("azimuth_rad")?.unwrap_or(0.0);
            let angle = fields.number("tilt_rad")?.unwrap_or(0.0);
            let height = height(fields.number("height_m")?);
            let model = named(fields.text("virtualization")?.as_deref())?;
            let rods = gpr.inverse(Tilt { azimuth, angle }, height)?;
            let pose = gpr.forward(rods, model, &options)?;
            document(&report::forward(gpr, &pose, model, &[]))
        }
        "mobility" => {
            let mut fields = fields.only(&["rods_m", "virtualization"])?;
            // Level at the working height, if not given.
            let level = || gpr.inverse(Tilt::LEVEL, height(None));
            let rods = fields.three("rods_m")?.map_or_else(level, Ok)?;
            // Rigid links: the choice of virtualization makes no difference.
            let pose = gpr.forward(rods, &Planar, &options)?;
            let rigid = gpr.system(&Planar);
            let finite = finite_mobility(&rigid, &rigid.configuration(&pose), RANK_THRESHOLD)?;
            let augmented = match fields.text("virtualization")? {
                None => None,
                Some(name) => {
                    let model = named(Some(&name))?;
                    let relieved = gpr.system(model);
                    let at = relieved.configuration(&gpr.forward(rods, model, &options)?);
                    Some((model.name(), augmented_mobility(&relieved, &at, RANK_THRESHOLD)?))
                }
            };
            let augmented = augmented.as_ref().map(|(name, found)| (*name, found));
            let kutzbach = gpr.kutzbach_mobility();
            document(&report::mobility(&pose, kutzbach, &finite, augmented, &[]))
        }
        _ => {
            let mut fields = fields.only(&tilted)?;
            let azimuth = fields.number("azimuth_rad")?.unwrap_or(0.0);
            let angle = needed("tilt_rad", fields.number("tilt_rad")?)?;
            let height = height(fields.number("height_m")?);
            let model = named(fields.text("virtualization")?.as_deref())?;
            let play = gpr.tilt_play(Tilt { azimuth, angle }, height, model, &options)?;
            document(&report::sensitivity(gpr, &play, model, &[]))
        }
    }
}

/// Answers a request about a mechanism.
pub(crate) fn of_mechanism(
    file: &MechanismFile,
    coordinates: &Coordinates,
    request: &str,
) -> Result<CString, Failure> {
    let mechanism = &file.mechanism;
    let of_file = Named { file, coordinates };
    let index = |name: &String| of_file.index(name);
    let commands = |values: &Values| of_file.commands(values);
    let mut fields = Fields::of_request(request)?;
    let known = ["assemble", "mobility", "jacobian", "sensitivity", "move", "suggest"];
    match fields.kind(&known)? {
        "assemble" => {
            let at = fields.only(&["at"])?.values("at")?.unwrap_or_default();
            let posed = pose_commanded(mechanism, &commands(&at)?, None)?;
            let relief = posed.relief.as_ref();
            document(&report::assembly(file, &posed.closed, relief, None, None))
        }
        "mobility" if !MechanismSystem::fits(mechanism) => {
            let at = fields.only(&["at"])?.values("at")?.unwrap_or_default();
            let (system, _) = close_sparse(mechanism, &commands(&at)?)?;
            let found = system.mobility(RANK_THRESHOLD)?;
            document(&report::sparse_mobility(file, &system, &found))
        }
        "mobility" => {
            let at = fields.only(&["at"])?.values("at")?.unwrap_or_default();
            let posed = pose_commanded(mechanism, &commands(&at)?, None)?;
            let values = &posed.closed.coordinates;
            let system = MechanismSystem::new(mechanism, values.clone())?;
            let found = mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused)?;
            let relief = posed.relief.as_ref();
            let report = report::mechanism_mobility(file, &system, values, relief, &found, None);
            document(&report?)
        }
        "jacobian" => {
            let mut fields = fields.only(&["at", "commanded", "frames"])?;
            let at = fields.values("at")?.unwrap_or_default();
            let frames = fields.texts("frames")?;
            // The actuated ones, if not given; attached frames, or else links.
            let commanded = match fields.texts("commanded")? {
                None => mechanism.actuated_coordinates(),
                Some(names) => names.iter().map(index).collect::<Result<Vec<usize>, _>>()?,
            };
            if let Some(n) = (1..commanded.len()).find(|&n| commanded[..n].contains(&commanded[n]))
            {
                let name = &coordinates.all()[commanded[n]].name;
                return Err(Failure::input(format!("commanded names {name:?} twice")));
            }
            let frames = match frames {
                None if mechanism.frames().is_empty() => {
                    (1..mechanism.links().len()).map(FrameId::Link).collect()
                }
                None => (0..mechanism.frames().len()).map(FrameId::Attached).collect(),
                Some(names) => {
                    let frame = |name: &String| {
                        coordinates::frame(mechanism, name)
                            .map_err(|error| Failure::input(error.to_string()))
                    };
                    names.iter().map(frame).collect::<Result<Vec<FrameId>, _>>()?
                }
            };
            let posed = pose_commanded(mechanism, &commands(&at)?, None)?;
            let mut system = MechanismSystem::new(mechanism, posed.closed.coordinates.clone())?;
            let mut relief = None;
            if !mechanism.virtual_joints().is_empty() {
                let of = |&k: &usize| (k, posed.closed.coordinates[k]);
                let values: Vec<(usize, f64)> = commanded.iter().map(of).collect();
                let found = relieve_commanded(mechanism, &values, None)?;
                system = found.system(mechanism)?;
                relief = Some(found);
            }
            let relief = relief.as_ref();
            match report::jacobian(file, &system, &commanded, &frames, relief, None, &[]) {
                Ok(report) => document(&report),
                Err(report::JacobianError::Motion(error)) => Err(error.into()),
                Err(error) => Err(Failure::no_answer(error.to_string())),
            }
        }
        "move" => document(&Move::read(fields)?.answer(of_file)?),
        "suggest" => document(&Suggest::read(fields)?.answer(of_file)?),
        _ => {
            let command = fields.only(&["command"])?.values("command")?;
            let command = needed("command", command)?;
            if mechanism.virtual_joints().is_empty() || command.is_empty() {
                let text = "sensitivity needs a mechanism with virtual joints, and a command";
                return Err(Failure::input(text));
            }
            let commands = commands(&command)?;
            let commanded: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
            let relief = relieve_commanded(mechanism, &commands, None)?;
            let system = relief.system(mechanism)?;
            let (at, length) = (system.at_home(), relief.characteristic_length);
            let found = commanded_sensitivity(&system, &at, &commanded, length, RANK_THRESHOLD)?;
            let values = found.singular_values().as_slice();
            document(&report::relief(file, &relief, &commanded, values))
        }
    }
}
