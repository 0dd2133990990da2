//! Three-rod robots as mechanisms, and mechanisms that are three-rod robots.

use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::BuiltIn;

use crate::explain::explain_recognition;
use crate::mechanism::{Expected, MechanismFile, Units};
use crate::robot::Robot;

/// The mechanism of a robot, with the virtual joints of a virtualization.
///
/// Lengths of messages are in mm and angles in degrees, as in robot files.
#[must_use]
pub fn mechanism_file(robot: &Robot, virtualization: BuiltIn) -> MechanismFile {
    let mechanism = robot.gpr.to_relieved_mechanism(&robot.name, virtualization);
    MechanismFile {
        mechanism: mechanism.expect("the sockets of a robot have directions"),
        source: None,
        units: Units::MM,
        parameters: Vec::new(),
        expected: Expected::default(),
    }
}

/// The robot that a mechanism describes.
///
/// # Arguments
/// * `tilt_max` – largest tilt toward any azimuth (rad), which a mechanism does not state
///
/// # Errors
/// Why the mechanism is not a three-rod robot, in mm and degrees.
pub fn robot(file: &MechanismFile, tilt_max: f64) -> Result<Robot, String> {
    let found = Gpr::from_mechanism(&file.mechanism, tilt_max);
    let gpr = found.map_err(|error| explain_recognition(&error))?.gpr;
    let name = file.mechanism.name().to_owned();
    Ok(Robot { name, gpr, base_mesh: None, platform_mesh: None })
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let made = mechanism_file(&robot::paper(), BuiltIn::Radial).mechanism;
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
    fn a_mechanism_that_is_no_three_rod_robot_is_refused_with_its_reason() {
        let refused = |name: &str| {
            let file = mechanism::parse(catalogue::find(name).unwrap().text).unwrap();
            super::robot(&file, 0.1).unwrap_err()
        };
        assert!(refused("hexapod").contains("but there are 6 prismatic"), "{}", refused("hexapod"));
        assert!(refused("3-rps").contains("3 other joints"), "{}", refused("3-rps"));
    }
}
