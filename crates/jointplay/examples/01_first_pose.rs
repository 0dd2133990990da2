//! Tilt the paper's robot: rods for a tilt, and where its platform then is.
//!
//! Prints the rods, the pose and the play that the tilt takes; the tilt angle equals the commanded one.

#![expect(clippy::print_stdout, reason = "an example prints")]

use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Planar, SolveOptions};

fn main() -> Result<(), jointplay::Error> {
    let gpr = Gpr::paper();
    let tilt = Tilt { azimuth: 30_f64.to_radians(), angle: 1.5_f64.to_radians() };

    // The three ball centres fix the platform's plane, so the rods do not depend on how play is modelled.
    let rods = gpr.inverse(tilt, AxisHeight(0.5))?;
    println!("rods      {:.6?} mm", rods.map(|q| q * 1e3));

    // Where the platform sits over the three balls does: here by the least displacement of its sockets.
    let platform = gpr.forward(rods, &Planar, &SolveOptions::default())?;
    println!("tilt      {:.6}°", platform.tilt().angle.to_degrees());
    println!(
        "origin    {:.6?} mm",
        platform.base_from_platform.translation.vector.map(|x| x * 1e3).as_slice()
    );

    // What a rigid mechanism could not do: the sockets have moved within the platform.
    let moved = platform.solution.virtual_joints.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    println!("play      {:.3} µm at most", moved * 1e6);
    Ok(())
}
