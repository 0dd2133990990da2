//! Mobility: level, the robot is infinitesimally mobile; tilted, it is rigid; with virtual joints, it is neither.
//!
//! Prints counted, instantaneous, finite and augmented mobility: 0, 3, 1, 6 when level and 0, 1, 1, 6 when tilted.

#![expect(clippy::print_stdout, reason = "an example prints")]

use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Planar, SolveOptions};

fn main() -> Result<(), jointplay::Error> {
    let gpr = Gpr::paper();
    let system = gpr.system(&Planar);
    println!("tilt (°)   counted  instantaneous  finite  with virtual joints");
    for tilt_angle in [0.0_f64, 0.001, 1.5] {
        let tilt = Tilt { azimuth: 0.0, angle: tilt_angle.to_radians() };
        let pose =
            gpr.forward(gpr.inverse(tilt, AxisHeight(0.5))?, &Planar, &SolveOptions::default())?;
        let at = system.configuration(&pose);

        let rigid = finite_mobility(&system, &at, RANK_THRESHOLD)?;
        let relieved = augmented_mobility(&system, &at, RANK_THRESHOLD)?;
        println!(
            "{tilt_angle:<9}  {:<7}  {:<13}  {:<6}  {}",
            gpr.kutzbach_mobility(),
            rigid.instantaneous.mobility,
            // An honest third answer: the bounds need not meet.
            rigid.mobility.map_or("undecided".to_owned(), |h| h.to_string()),
            relieved.mobility,
        );
    }

    // Play that a tilt requires, and its first-order bounds.
    let tilt = Tilt { azimuth: 0.0, angle: gpr.limits().tilt_max };
    let play = gpr.tilt_play(tilt, AxisHeight(0.5), &Planar, &SolveOptions::default())?;
    let bounds = play.at_midpoint.bounds;
    println!(
        "\nplay at {:.1}°: {:.3} µm, first-order bounds along the chord {:.3} to {:.3} µm",
        tilt.angle.to_degrees(),
        play.displacement * 1e6,
        bounds.lower * 1e6,
        bounds.upper * 1e6
    );
    Ok(())
}
