//! Questions and answers as JSON.

use std::collections::BTreeMap;
use std::ffi::CString;

use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::mechanism::{MechanismSystem, mechanism_mobility};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay::report;
use jointplay::spatial::{Pose, Tilt};
use jointplay::virtualization::{Planar, SolveOptions, Virtualization, built_in};
use serde::{Deserialize, Serialize};

use crate::catch::Failure;
use crate::mechanism::JpMechanism;

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
enum OfRobot {
    Mobility {
        /// Level at the working height, if not given.
        rods_m: Option<[f64; 3]>,
        virtualization: Option<String>,
    },
    Sensitivity {
        #[serde(default)]
        azimuth_rad: f64,
        tilt_rad: f64,
        /// The working height, if not given.
        height_m: Option<f64>,
        virtualization: Option<String>,
    },
}

#[derive(Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
enum OfMechanism {
    Mobility {
        /// Commanded coordinates (m, rad).
        #[serde(default)]
        at: BTreeMap<String, f64>,
    },
}

fn parse<'a, T: Deserialize<'a>>(request: &'a str) -> Result<T, Failure> {
    serde_json::from_str(request).map_err(|error| Failure::input(format!("request: {error}")))
}

fn document(report: &impl Serialize) -> Result<CString, Failure> {
    let text = serde_json::to_string(report).map_err(|error| Failure::internal(error.to_string()));
    CString::new(text?).map_err(|error| Failure::internal(error.to_string()))
}

/// A virtualization of the library by its name.
fn model(name: &str) -> Result<&'static dyn Virtualization, Failure> {
    let found = built_in().iter().copied().find(|model| model.name() == name);
    found.ok_or_else(|| {
        let known: Vec<&str> = built_in().iter().map(|model| model.name()).collect();
        Failure::input(format!("virtualization {name:?} is not known; known: {}", known.join(", ")))
    })
}

/// Answers a question about the three-rod robot.
pub(crate) fn of_robot(gpr: &Gpr, request: &str) -> Result<CString, Failure> {
    let options = SolveOptions::default();
    let working = AxisHeight(gpr.working_height());
    match parse(request)? {
        OfRobot::Mobility { rods_m, virtualization } => {
            let model = virtualization.as_deref().map(model).transpose()?;
            let rods = match rods_m {
                Some(rods) => rods,
                None => gpr.inverse(Tilt::LEVEL, working)?,
            };
            // The rigid robot is the one with its virtual joints held; the choice of virtualization makes no difference.
            let pose = gpr.forward(rods, &Planar, &options)?;
            let rigid = gpr.system(&Planar);
            let finite = finite_mobility(&rigid, &rigid.configuration(&pose), RANK_THRESHOLD)?;
            let augmented = match model {
                None => None,
                Some(model) => {
                    let relieved = gpr.system(model);
                    let at = relieved.configuration(&gpr.forward(rods, model, &options)?);
                    Some((model.name(), augmented_mobility(&relieved, &at, RANK_THRESHOLD)?))
                }
            };
            let augmented = augmented.as_ref().map(|(name, found)| (*name, found));
            let kutzbach = gpr.kutzbach_mobility();
            document(&report::mobility(&pose, kutzbach, &finite, augmented, &[]))
        }
        OfRobot::Sensitivity { azimuth_rad, tilt_rad, height_m, virtualization } => {
            let model = model(virtualization.as_deref().unwrap_or(Planar.name()))?;
            let tilt = Tilt { azimuth: azimuth_rad, angle: tilt_rad };
            let height = height_m.map_or(working, AxisHeight);
            let play = gpr.tilt_play(tilt, height, model, &options)?;
            document(&report::sensitivity(gpr, &play, model, &[]))
        }
    }
}

/// Answers a question about a mechanism.
pub(crate) fn of_mechanism(mechanism: &JpMechanism, request: &str) -> Result<CString, Failure> {
    let OfMechanism::Mobility { at } = parse(request)?;
    let file = &mechanism.file;
    let command = |(name, value): (&String, &f64)| {
        let found = mechanism.coordinates.find(&file.mechanism, name);
        found.map(|k| (k, *value)).map_err(|error| Failure::input(error.to_string()))
    };
    let commands = at.iter().map(command).collect::<Result<Vec<_>, _>>()?;
    if !MechanismSystem::fits(&file.mechanism) {
        let (system, _) = mechanism.sparse(&commands)?;
        let found = system.mobility(RANK_THRESHOLD)?;
        return document(&report::sparse_mobility(file, &system, &found));
    }
    let (values, relief) = mechanism.posed(&commands)?;
    let system = MechanismSystem::new(&file.mechanism, values.clone())?;
    let found = mechanism_mobility(&system, RANK_THRESHOLD, false)?;
    let report = report::mechanism_mobility(file, &system, &values, relief.as_ref(), &found, None)?;
    document(&report)
}

/// A homogeneous transform by rows.
#[inline]
pub(crate) fn rows(pose: &Pose) -> [f64; 16] {
    let rotation = pose.rotation.matrix();
    let origin = &pose.translation.vector;
    let mut rows = [0.0; 16];
    for i in 0..3 {
        (0..3).for_each(|j| rows[4 * i + j] = rotation[(i, j)]);
        rows[4 * i + 3] = origin[i];
    }
    rows[15] = 1.0;
    rows
}
