//! Three-rod robots as mechanisms, and mechanisms that are three-rod robots.

use jointplay_core::gpr::{Gpr, NotThreeRods};
use jointplay_core::virtualization::BuiltIn;

use crate::mechanism::{Expected, MechanismFile, Units};
use crate::number::number;
use crate::robot::Robot;
use crate::units::deg;

/// The mechanism of a robot, with the virtual joints of a virtualization; `None` for one that has no virtual joints of mechanisms.
///
/// Its messages are in mm and degrees, as in robot files.
#[must_use]
pub fn mechanism_file(robot: &Robot, virtualization: BuiltIn) -> Option<MechanismFile> {
    Some(MechanismFile {
        mechanism: robot.gpr.to_relieved_mechanism(&robot.name, virtualization)?,
        source: None,
        units: Units::MM,
        parameters: Vec::new(),
        expected: Expected::default(),
    })
}

/// Parts of a robot file that its mechanism does not have.
#[must_use]
pub fn lost_in_mechanism(robot: &Robot) -> Vec<String> {
    let tilt = format!("largest tilt of {}°", number(deg(robot.gpr.limits().tilt_max)));
    let meshes = [("base_mesh", &robot.base_mesh), ("platform_mesh", &robot.platform_mesh)];
    let meshes = meshes.into_iter().filter(|(_, mesh)| mesh.is_some());
    [tilt].into_iter().chain(meshes.map(|(key, _)| key.to_owned())).collect()
}

/// The robot that a mechanism describes.
///
/// # Arguments
/// * `tilt_max` – largest tilt toward any azimuth (rad), which a mechanism does not state
///
/// # Errors
/// [`NotThreeRods`]; [`explain_recognition`](crate::explain::explain_recognition) makes a message of it.
pub fn robot(file: &MechanismFile, tilt_max: f64) -> Result<Robot, NotThreeRods> {
    let gpr = Gpr::from_mechanism(&file.mechanism, tilt_max)?.gpr;
    let name = file.mechanism.name().to_owned();
    Ok(Robot { name, gpr, base_mesh: None, platform_mesh: None })
}

/// Parts of a mechanism that its robot does not have.
#[must_use]
pub fn lost_in_robot(file: &MechanismFile) -> Vec<String> {
    let mechanism = &file.mechanism;
    let stiff = mechanism.joints().iter().filter(|joint| joint.stiffness != Default::default());
    [
        (mechanism.virtual_joints().len(), "virtual_joint"),
        (mechanism.frames().len(), "frame"),
        (stiff.count(), "stiffness of a joint"),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} × {what}"))
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::display_units::DisplayUnits;
    use crate::explain::explain_recognition;
    use crate::{catalogue, mechanism, robot};

    #[test]
    fn both_included_descriptions_of_the_paper_s_robot_are_the_same_robot() {
        let text = catalogue::find("gpr-mechanism").unwrap().text;
        let file = mechanism::parse(text).unwrap();
        let found = super::robot(&file, Gpr::paper().limits().tilt_max).unwrap().gpr;
        let (a, b) = (found.limbs(), Gpr::paper().limbs());
        for k in 0..3 {
            assert!((a[k].base_point - b[k].base_point).norm() < 1e-15);
            assert!((a[k].socket_radius - b[k].socket_radius).abs() < 1e-15);
        }
        assert_eq!(found.limits(), Gpr::paper().limits());
        // And back: the same joints, links and virtual joints.
        let made = mechanism_file(&robot::paper(), BuiltIn::Radial).unwrap().mechanism;
        let there = mechanism::write(&made, None);
        let again = mechanism::parse(&there).unwrap();
        let found = super::robot(&again, Gpr::paper().limits().tilt_max).unwrap();
        let written = robot::write(&Robot { name: robot::paper().name, ..found });
        let read = robot::parse(&written).unwrap().gpr;
        for (a, b) in read.limbs().iter().zip(&b) {
            assert!((a.base_point - b.base_point).norm() < 1e-15, "{written}");
        }
        assert_eq!(made.virtual_joints().len(), file.mechanism.virtual_joints().len());
    }

    #[test]
    fn parts_without_a_counterpart_are_listed() {
        assert_eq!(lost_in_mechanism(&robot::paper()), ["largest tilt of 1.5°"]);
        let file = mechanism_file(&robot::paper(), BuiltIn::Planar).unwrap();
        assert_eq!(lost_in_robot(&file), ["6 × virtual_joint"]);
        assert!(mechanism_file(&robot::paper(), BuiltIn::Offset).is_none());
    }

    #[test]
    fn a_mechanism_that_is_no_three_rod_robot_is_refused_with_its_reason() {
        let refused = |name: &str| {
            let file = mechanism::parse(catalogue::find(name).unwrap().text).unwrap();
            let error = super::robot(&file, 0.1).unwrap_err();
            explain_recognition(name, &error, DisplayUnits::Metric)
        };
        assert!(refused("hexapod").contains("but there are 6 prismatic"), "{}", refused("hexapod"));
        let paper = mechanism_file(&robot::paper(), BuiltIn::Planar).unwrap();
        let error = super::robot(&paper, -0.1).unwrap_err();
        let message = explain_recognition("GPR", &error, DisplayUnits::Metric);
        assert!(message.starts_with("the largest tilt is"), "{message}");
        assert!(refused("3-rps").contains("3 other joints"), "{}", refused("3-rps"));
    }
}
