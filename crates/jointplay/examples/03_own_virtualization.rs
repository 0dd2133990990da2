//! Bring your own virtual joints: sockets that slide along lines slanted against their radii.
//!
//! One trait, five short functions; kinematics, mobility and sensitivity come with it.
//! Prints how the centre shift of one tilt turns with the slant, from the radial model's value at 0°.

#![expect(clippy::print_stdout, reason = "an example prints")]

use std::f64::consts::FRAC_PI_3;

use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility};
use jointplay::nalgebra::{Rotation2, Vector2};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{
    Platform, Sockets, SolveOptions, VirtualJoint, VirtualJointKind, Virtualization,
};

/// Socket k slides by s_k in the direction β_k + slant.
struct Slanted {
    /// Angle between each slide and its radius (rad).
    slant: f64,
}

impl Slanted {
    fn direction(&self, platform: &Platform, limb: usize) -> Vector2<f64> {
        Rotation2::new(self.slant) * platform.directions()[limb]
    }
}

impl Virtualization for Slanted {
    fn name(&self) -> &str {
        "slanted"
    }

    fn joints(&self) -> &[VirtualJoint] {
        static SLIDES: [VirtualJoint; 3] = [
            VirtualJoint { symbol: "s", limb: 0, motion: VirtualJointKind::Linear },
            VirtualJoint { symbol: "s", limb: 1, motion: VirtualJointKind::Linear },
            VirtualJoint { symbol: "s", limb: 2, motion: VirtualJointKind::Linear },
        ];
        &SLIDES
    }

    fn nominal(&self, _platform: &Platform, x: &mut [f64]) {
        x.fill(0.0);
    }

    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets {
        [0, 1, 2].map(|k| platform.sockets()[k] + self.direction(platform, k) * x[k])
    }

    fn socket_velocities(&self, platform: &Platform, _x: &[f64], velocities: &mut [Sockets]) {
        for (k, velocity) in velocities.iter_mut().enumerate() {
            *velocity = Sockets::default();
            velocity[k] = self.direction(platform, k);
        }
    }
}

fn main() -> Result<(), jointplay::Error> {
    let gpr = Gpr::paper();
    let tilt = Tilt { azimuth: 0.0, angle: 1.5_f64.to_radians() };
    let rods = gpr.inverse(tilt, AxisHeight(0.5))?;
    println!("slant (°)  centre shift x, y (µm)  rank  mobility");
    for slant in [0.0, 0.25 * FRAC_PI_3, 0.5 * FRAC_PI_3, 0.75 * FRAC_PI_3, FRAC_PI_3] {
        let slanted = Slanted { slant };
        let pose = gpr.forward(rods, &slanted, &SolveOptions::default())?;
        let system = gpr.system(&slanted);
        let relieved = augmented_mobility(&system, &system.configuration(&pose), RANK_THRESHOLD)?;
        let shift = pose.center_shift() * 1e6;
        println!(
            "{:<9.0}  {:>9.3} {:>9.3}     {:<4}  {}",
            slant.to_degrees(),
            shift.x,
            shift.y,
            relieved.rank,
            relieved.mobility
        );
    }
    Ok(())
}
