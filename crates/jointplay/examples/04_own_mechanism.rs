//! Bring your own mechanism: a file as text, its mobility with evidence, a motion, and where it would need play.

#![expect(clippy::print_stdout, reason = "an example prints")]

use jointplay::format::mechanism::parse;
use jointplay::mechanism::{
    Drive, MechanismSystem, MobilityClass, SuggestOptions, assemble, drive, guess, self_stresses,
    suggest,
};
use jointplay::mobility::{RANK_THRESHOLD, finite_mobility};
use jointplay::nalgebra::DVector;

/// A four-bar whose last pin is tilted by a degree: no longer planar, no longer movable.
const TILTED: &str = r#"
kind = "mechanism"
name = "four-bar with a tilted pin"
units = { length = "mm", angle = "deg" }
base = "ground"

[parameters]
tilt = 1

[[joint]]
name = "A"
kind = "revolute"
links = ["ground", "crank"]
point = [0, 0, 0]
axis = [0, 0, 1]
actuated = true

[[joint]]
name = "B"
kind = "revolute"
links = ["crank", "coupler"]
point = [0, 40, 0]
axis = [0, 0, 1]

[[joint]]
name = "C"
kind = "revolute"
links = ["coupler", "rocker"]
point = [120, 80, 0]
axis = [0, 0, 1]

[[joint]]
name = "D"
kind = "revolute"
links = ["rocker", "ground"]
point = [140, 0, 0]
axis = ["sin(tilt)", 0, "cos(tilt)"]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let straight = TILTED.replace("tilt = 1", "tilt = 0");
    for (what, text) in [("straight", straight.as_str()), ("tilted", TILTED)] {
        let mechanism = parse(text)?.mechanism;
        let closed = assemble(&mechanism, &guess(&mechanism), &[], 10)?;
        let system = MechanismSystem::new(&mechanism, closed.coordinates)?;
        let found = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD)?;
        println!("{what}: {}", MobilityClass::classify(&found).description());
        for stress in self_stresses(&system, &found.instantaneous)?.stresses {
            let joints: Vec<&str> = stress
                .wrenches
                .iter()
                .map(|wrench| mechanism.joints()[wrench.joint].name.as_str())
                .collect();
            println!("  redundant constraint in {}: {:?}", joints.join(", "), stress.screw);
        }
        let quarter = Drive { coordinate: 0, to: 0.5 };
        let motion = drive(&system, &[quarter], &[1, 2, 3], 10)?;
        println!(
            "  crank driven by 0.5 rad: {:?}, stopped {:?}",
            motion.waypoints.len(),
            motion.stopped
        );
        let command = DVector::from_element(1, 0.5);
        let play =
            suggest(&mechanism, system.home(), &[0], &[command], &SuggestOptions::default())?;
        match play.sets.first() {
            None => println!("  needs no play"),
            Some(set) => {
                let names: Vec<&str> =
                    set.virtual_joints.iter().map(|joint| joint.name.as_str()).collect();
                println!("  least play: {} by {:.3e}", names.join(", "), set.largest[0]);
            }
        }
    }
    Ok(())
}
