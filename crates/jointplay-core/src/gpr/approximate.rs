//! The model that the paper sets out to replace: a platform that turns about its centre as though no rods held it.

use nalgebra::{Translation3, Vector3};

use super::{AxisHeight, Gpr};
use crate::Error;
use crate::spatial::{Pose, Tilt, tilt_rotation};

/// The approximate pose, and how far it tears the sockets off the balls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ApproximatePose {
    /// Rods of the exact inverse kinematics for the same plane (m).
    pub rods: [f64; 3],
    /// Pose with O_p on the base axis.
    pub base_from_platform: Pose,
    /// From each ball to its socket, in the base frame (m).
    pub gaps: [Vector3<f64>; 3],
}

impl Gpr {
    /// The approximate model of the paper's Fig. 2, kept for comparison.
    ///
    /// # Errors
    /// As [`Self::inverse`].
    ///
    /// # Source
    /// \[Virtualization\], III and Fig. 2
    pub fn approximate(&self, tilt: Tilt, height: AxisHeight) -> Result<ApproximatePose, Error> {
        let rods = self.inverse(tilt, height)?;
        let origin = Translation3::new(0.0, 0.0, height.0);
        let base_from_platform = Pose::from_parts(origin, tilt_rotation(&tilt.normal()));
        let balls = self.ball_centers(&rods);
        let gaps = [0, 1, 2].map(|k| {
            let socket = self.platform().sockets()[k].push(0.0);
            base_from_platform.rotation * socket + base_from_platform.translation.vector - balls[k]
        });
        Ok(ApproximatePose { rods, base_from_platform, gaps })
    }
}
