//! Programs on all robots with arms of the catalogue.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fmt::Write;

use jointplay_cell::program::expand;
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_format::cell::robot::names;
use jointplay_format::{cell, program};

/// A cell of stations at (azimuth in degrees, distance in mm), entered by `approach`.
fn cell_of(robot: &str, stations: &[(f64, f64)], approach: &str, retract: f64) -> String {
    let mut text = format!(
        "kind = \"cell\"\nname = \"c\"\nrobot = \"{robot}\"\n[wafer]\ndiameter_mm = 300.0\nthickness_mm = 0.775\nmaterial = \"silicon\"\n[budgets]\nplay_um = 60.0\nclearance_mm = 1.0\nslot_clearance_mm = 1.0\nplane_urad = 20.0\n"
    );
    for (k, (azimuth, distance)) in stations.iter().enumerate() {
        let (sin, cos) = azimuth.to_radians().sin_cos();
        write!(
            text,
            "[[station]]\nname = \"S{k}\"\nslots = 25\npitch_mm = 10.0\nposition_mm = [{}, {}, 520.0]\nyaw_deg = {}\nstroke = {{ below_mm = 4.0, above_mm = 3.0, speed_mm_s = 20.0 }}\nretract_mm = {retract}\napproach = \"{approach}\"\n{}",
            distance * cos,
            distance * sin,
            azimuth - 90.0,
            if k == 0 { "wafers = \"all\"\n" } else { "" },
        )
        .unwrap();
    }
    text
}

#[test]
fn experiment() {
    for robot in names() {
        for approach in ["radial", "line"] {
            for retract in [10.0, 150.0, 300.0] {
                for distance in [600.0, 700.0] {
                    let stations = [(135.0, distance), (-135.0, distance), (0.0, distance)];
                    let text = cell_of(robot, &stations, approach, retract);
                    let started = std::time::Instant::now();
                    let cell = cell::read(&text, &mut |_| Err("no files".to_owned())).unwrap_or_else(|errors| panic!("{errors:#?}"));
                    let with = if cell.robot.arms.len() > 1 || cell.robot.arms[0].effectors.len() > 1 { " WITH A" } else { "" };
                    let parsed = program::parse(&format!(
                        "TRANSFER S0 SLOT 1 TO S1 SLOT 3{with}\nTRANSFER S1 SLOT 3 TO S2 SLOT 20{with}\nTRANSFER S2 SLOT 20 TO S0 SLOT 1{with}\n"
                    ))
                    .unwrap();
                    let result = match expand(&cell, &parsed) {
                        Err(errors) => program::explain(&cell.robot, "", &errors[0]).problem.message,
                        Ok(steps) => match plan_trajectory(&cell, steps, &TrajectoryOptions::default()) {
                            Ok(trajectory) => format!("{:.2} s", trajectory.duration()),
                            Err(error) => format!("{error}").chars().take(300).collect(),
                        },
                    };
                    println!("{robot} {approach} {retract} {distance}: {result} [{:.2?}]", started.elapsed());
                }
            }
        }
    }
}
