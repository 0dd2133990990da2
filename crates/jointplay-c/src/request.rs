//! Requests and answers in JSON.

use std::ffi::CString;

use jointplay::format::coordinates::{self, Coordinates};
use jointplay::format::json;
use jointplay::format::mechanism::MechanismFile;
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::mechanism::{
    FrameId, MechanismSystem, OpenLoops, close_sparse, mechanism_mobility, pose_commanded,
    relieve_commanded,
};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay::report;
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Planar, SolveOptions};
use serde::{Deserialize, Serialize};

use crate::catch::Failure;
use crate::motion_request::{Move, Named, Suggest, Values};
use crate::virtualization::named;

/// Rod lengths, and the virtual joints that take up the play.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Forward {
    rods_m: [f64; 3],
    virtualization: Option<String>,
}

/// A tilt; level at the working height, if not given.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Inverse {
    azimuth_rad: Option<f64>,
    tilt_rad: Option<f64>,
    height_m: Option<f64>,
    virtualization: Option<String>,
}

/// Rod lengths, of the level platform at the working height if not given; also with play, if a virtualization is given.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotMobility {
    rods_m: Option<[f64; 3]>,
    virtualization: Option<String>,
}

/// A tilt that the joint play makes possible.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TiltPlay {
    azimuth_rad: Option<f64>,
    tilt_rad: f64,
    height_m: Option<f64>,
    virtualization: Option<String>,
}

/// Commanded coordinates; the closed configuration of the file, if there are none.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Configuration {
    at: Option<Values>,
}

/// Derivatives at a configuration.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Jacobian {
    at: Option<Values>,
    /// The actuated coordinates, if not given.
    commanded: Option<Vec<String>>,
    /// The attached frames or else the links, if not given.
    frames: Option<Vec<String>>,
}

/// A command that the virtual joints make possible.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sensitivity {
    command: Values,
}

fn document(report: &impl Serialize) -> Result<CString, Failure> {
    let text = serde_json::to_string(report).map_err(|error| Failure::internal(error.to_string()));
    CString::new(text?).map_err(|error| Failure::internal(error.to_string()))
}

/// Answers a request about a robot.
pub(crate) fn of_robot(gpr: &Gpr, request: &str) -> Result<CString, Failure> {
    let options = SolveOptions::default();
    let height = |given: Option<f64>| AxisHeight(given.unwrap_or(gpr.working_height()));
    let known = &["forward", "inverse", "mobility", "sensitivity"];
    let (kind, request) = json::request_of_kind(request.as_bytes(), known)?;
    match kind {
        "forward" => {
            let request: Forward = json::read_value(request, "")?;
            let model = named(request.virtualization.as_deref())?;
            let pose = gpr.forward(request.rods_m, model, &options)?;
            document(&report::forward(gpr, &pose, model, &[]))
        }
        "inverse" => {
            let request: Inverse = json::read_value(request, "")?;
            let azimuth = request.azimuth_rad.unwrap_or(0.0);
            let angle = request.tilt_rad.unwrap_or(0.0);
            let model = named(request.virtualization.as_deref())?;
            let rods = gpr.inverse(Tilt { azimuth, angle }, height(request.height_m))?;
            let pose = gpr.forward(rods, model, &options)?;
            document(&report::forward(gpr, &pose, model, &[]))
        }
        "mobility" => {
            let request: RobotMobility = json::read_value(request, "")?;
            let level = || gpr.inverse(Tilt::LEVEL, height(None));
            let rods = request.rods_m.map_or_else(level, Ok)?;
            // Rigid links: the choice of virtualization makes no difference.
            let pose = gpr.forward(rods, &Planar, &options)?;
            let rigid = gpr.system(&Planar);
            let finite = finite_mobility(&rigid, &rigid.configuration(&pose), RANK_THRESHOLD)?;
            let augmented = match request.virtualization {
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
            let request: TiltPlay = json::read_value(request, "")?;
            let (azimuth, angle) = (request.azimuth_rad.unwrap_or(0.0), request.tilt_rad);
            let model = named(request.virtualization.as_deref())?;
            let height = height(request.height_m);
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
    let known = &["assemble", "mobility", "jacobian", "sensitivity", "move", "suggest"];
    let (kind, request) = json::request_of_kind(request.as_bytes(), known)?;
    match kind {
        "assemble" => {
            let request: Configuration = json::read_value(request, "")?;
            let at = request.at.unwrap_or_default();
            let posed = pose_commanded(mechanism, &commands(&at)?, None)?;
            let relief = posed.relief.as_ref();
            document(&report::assembly(file, &posed.closed, relief, None, None))
        }
        "mobility" if !MechanismSystem::fits(mechanism) => {
            let request: Configuration = json::read_value(request, "")?;
            let at = request.at.unwrap_or_default();
            let (system, _) = close_sparse(mechanism, &commands(&at)?)?;
            let found = system.mobility(RANK_THRESHOLD)?;
            document(&report::sparse_mobility(file, &system, &found))
        }
        "mobility" => {
            let request: Configuration = json::read_value(request, "")?;
            let at = request.at.unwrap_or_default();
            let posed = pose_commanded(mechanism, &commands(&at)?, None)?;
            let values = &posed.closed.coordinates;
            let system = MechanismSystem::new(mechanism, values.clone())?;
            let found = mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused)?;
            let relief = posed.relief.as_ref();
            let report = report::mechanism_mobility(file, &system, values, relief, &found, None);
            document(&report?)
        }
        "jacobian" => {
            let request: Jacobian = json::read_value(request, "")?;
            let at = request.at.unwrap_or_default();
            let commanded = match request.commanded {
                None => mechanism.actuated_coordinates(),
                Some(names) => names.iter().map(index).collect::<Result<Vec<usize>, _>>()?,
            };
            if let Some(n) = (1..commanded.len()).find(|&n| commanded[..n].contains(&commanded[n]))
            {
                let name = &coordinates.all()[commanded[n]].name;
                return Err(Failure::input(format!("commanded names {name:?} twice")));
            }
            let frames = match request.frames {
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
        "move" => document(&json::read_value::<Move>(request, "")?.answer(of_file)?),
        "suggest" => document(&json::read_value::<Suggest>(request, "")?.answer(of_file)?),
        _ => {
            let Sensitivity { command } = json::read_value(request, "")?;
            if mechanism.virtual_joints().is_empty() || command.is_empty() {
                let text = "sensitivity needs a mechanism with virtual joints, and a command";
                return Err(Failure::input(text));
            }
            let commands = commands(&command)?;
            let commanded: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
            let relief = relieve_commanded(mechanism, &commands, None)?;
            let found = relief.sensitivity(mechanism, &commanded)?;
            let values = found.singular_values().as_slice();
            document(&report::relief(file, &relief, &commanded, values))
        }
    }
}
