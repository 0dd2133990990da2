//! Analyses of mechanisms by jointplay, and the same mechanisms as files for other programs.

use std::path::Path;

use jointplay::constraint::System as _;
use jointplay::format::{catalogue, mechanism as file};
use jointplay::gpr::AxisHeight;
use jointplay::mechanism::{
    CommandedJoints, Kinematics, Mechanism, MechanismSystem, ReliefSolver, assemble, guess, relieve,
};
use jointplay::mobility::{RANK_THRESHOLD, finite_mobility, kutzbach_mobility};
use jointplay::nalgebra::{DVector, Translation3};
use jointplay::spatial::Tilt;
use serde_json::{Value, json};

use crate::gpr;
use crate::tree::Tree;

const MECHANISMS: [&str; 7] =
    ["four-bar", "bennett", "bricard-orthogonal", "sarrus", "3-rps", "3-upu-tsai", "3-upu-snu"];
/// Commanded tilt of the platform.
const TILT: Tilt = Tilt { azimuth: 0.0, angle: 2.0 * std::f64::consts::PI / 180.0 };

/// Commanded rise of the platform (m).
const RISE: f64 = 0.01;

/// Writes a file for each mechanism and configuration, and the analyses of jointplay.
pub(crate) fn write(folder: &Path) -> Result<(), Box<dyn std::error::Error>> {
    std::fs::create_dir_all(folder)?;
    let mut analyses = Vec::new();
    let mut analyse = |name: &str, mechanism: &Mechanism, at: &DVector<f64>| {
        let actuated = actuated(mechanism);
        let text = Tree::of(mechanism).text(&actuated, 1e-12, std::slice::from_ref(at));
        analyses.push(mobility(name, mechanism, at)?);
        std::fs::write(folder.join(format!("{name}.txt")), text)?;
        Ok::<_, Box<dyn std::error::Error>>(())
    };
    for name in MECHANISMS {
        let mechanism = parsed(name)?;
        let closed = assemble(&mechanism, &guess(&mechanism), &actuated(&mechanism), 0)?;
        analyse(name, &mechanism, &closed.coordinates)?;
    }
    let (rigid, level) = rigid()?;
    analyse("gpr-level", &rigid, &level)?;
    let rods = gpr::robot().inverse(TILT, AxisHeight(gpr::HEIGHT))?.map(|rod| rod - gpr::HEIGHT);
    let (fitted, tilted) = fitted(rods)?;
    analyse("gpr-tilted", &fitted, &tilted)?;

    // The rigid robot, commanded to rise and to tilt: rods at those lengths, everything else where it was.
    let mut asked = serde_json::Map::new();
    for (name, lengths) in [("rise", [RISE; 3]), ("tilt", rods)] {
        let mut start = level.clone();
        start.rows_mut(0, 3).copy_from_slice(&lengths);
        let text = Tree::of(&rigid).text(&gpr::RODS, 1e-12, std::slice::from_ref(&start));
        std::fs::write(folder.join(format!("gpr-asked-to-{name}.txt")), text)?;
        let answer = match assemble(&rigid, &start, &gpr::RODS, 20) {
            Ok(closed) => format!("closed, mismatch {:.0e}", closed.residual),
            Err(error) => format!("error: {error}"),
        };
        asked.insert(name.to_owned(), answer.into());
    }
    let whole = json!({ "mechanisms": analyses, "asked_to": asked });
    std::fs::write(folder.join("jointplay.json"), serde_json::to_string_pretty(&whole)?)?;
    Ok(())
}

fn mobility(
    name: &str,
    mechanism: &Mechanism,
    at: &DVector<f64>,
) -> Result<Value, jointplay::Error> {
    let system = MechanismSystem::new(mechanism, at.clone())?;
    let found = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD)?;
    let freedoms: Vec<usize> =
        mechanism.joints().iter().map(|joint| joint.kind.freedoms()).collect();
    Ok(json!({
        "name": name,
        "freedoms": mechanism.joint_freedoms(),
        "rows": system.constraint_dimensions().len(),
        "rank": found.instantaneous.rank,
        "kutzbach": kutzbach_mobility(mechanism.links().len(), &freedoms),
        "instantaneous": found.instantaneous.mobility,
        "finite": found.mobility,
        "redundancy": found.instantaneous.redundancy,
    }))
}

fn parsed(name: &str) -> Result<Mechanism, Box<dyn std::error::Error>> {
    let entry = catalogue::find(name).ok_or("a mechanism is not in the catalogue")?;
    Ok(file::parse(entry.text)?.mechanism)
}

fn actuated(mechanism: &Mechanism) -> Vec<usize> {
    let kinematics = Kinematics::new(mechanism);
    let joints = mechanism.joints().iter().enumerate().filter(|(_, joint)| joint.actuated);
    joints.flat_map(|(j, _)| kinematics.coordinates_of(j)).collect()
}

/// The robot without virtual joints, level.
fn rigid() -> Result<(Mechanism, DVector<f64>), Box<dyn std::error::Error>> {
    let mechanism = parsed("gpr-mechanism")?.with_virtual_joints(Vec::new())?;
    let level = DVector::zeros(mechanism.joint_freedoms());
    Ok((mechanism, level))
}

/// The tilted robot, its sockets fixed where the virtual joints moved them.
fn fitted(rods: [f64; 3]) -> Result<(Mechanism, DVector<f64>), Box<dyn std::error::Error>> {
    let relieved = parsed("gpr-mechanism")?;
    let freedoms = relieved.joint_freedoms();
    let mut home = DVector::zeros(freedoms + relieved.virtual_joints().len());
    home.rows_mut(0, 3).copy_from_slice(&rods);
    let start = MechanismSystem::new(&relieved, home)?;
    let at_home = MechanismSystem::new(&relieved, DVector::zeros(start.home().len()))?;
    let commanded = CommandedJoints::new(&at_home, &gpr::RODS)?;
    let relief = relieve(&start, &commanded, ReliefSolver::LeastNorm)?;
    let mut joints = relieved.joints().to_vec();
    for (virtual_joint, slide) in relieved.virtual_joints().iter().zip(&relief.virtual_joints) {
        let factor = match virtual_joint.motion {
            jointplay::mechanism::VirtualMotion::Slide(axis) => axis.scale(*slide),
            jointplay::mechanism::VirtualMotion::Turn { .. } => return Err("slides only".into()),
        };
        let socket = &mut joints[virtual_joint.joint].frames[1];
        *socket = Translation3::from(factor) * *socket;
    }
    let mechanism = Mechanism::new(relieved.name(), relieved.links().to_vec(), joints)?
        .with_characteristic_length(relieved.characteristic_length().ok_or("it has a length")?)?;
    Ok((mechanism, relief.coordinates.rows(0, freedoms).into_owned()))
}
