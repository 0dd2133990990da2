//! Clearance of the balls in their sockets that a pose needs.

use super::{Gpr, PlatformPose};
use crate::Error;
use crate::virtualization::{Virtualization, sides_of};

/// Clearance that a pose needs, as the radius by which each ball can leave the centre of its socket.
///
/// Parts are rigid here: where the clearance is too small, a real robot takes the pose only by elastic deformation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallClearance {
    /// Distance of each ball from the centre of its nominal socket, under the virtualization of the pose (m).
    pub displacements: [f64; 3],
    /// Radius that is needed wherever the platform settles: half of the largest difference between a side and its nominal length (m).
    pub lower_bound: f64,
    /// Radius that the robot has, if known (m).
    pub available: Option<f64>,
}

impl BallClearance {
    /// Relative amount by which round-off may exceed the available clearance.
    const SLACK: f64 = 1e-9;

    /// Largest of the displacements: with this radius the pose is possible (m).
    #[must_use]
    pub fn upper_bound(&self) -> f64 {
        self.displacements.into_iter().fold(0.0, f64::max)
    }

    /// Whether the available clearance is sufficient for the pose; `None` where it is unknown, or between the bounds.
    ///
    /// Sufficient is a clearance at which every ball stays in its socket where the virtualization places the platform; insufficient is one below the lower bound, at which no placement exists.
    #[must_use]
    pub fn is_sufficient(&self) -> Option<bool> {
        let available = self.available? * (1.0 + Self::SLACK);
        if self.displacements.iter().all(|&displacement| displacement <= available) {
            Some(true)
        } else if available < self.lower_bound {
            Some(false)
        } else {
            None
        }
    }
}

impl Gpr {
    /// The same robot with a known clearance of its balls in their sockets.
    ///
    /// The kinematics do not depend on it: [`Self::needed_clearance`] compares it with what a pose needs.
    ///
    /// # Arguments
    /// * `radius` – distance by which each ball can leave the centre of its socket (m): half of the clearance of the diameters
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a negative or infinite radius, and NaN.
    pub fn with_ball_clearance(self, radius: f64) -> Result<Self, Error> {
        if !(0.0..f64::INFINITY).contains(&radius) {
            return Err(Error::OutOfRange {
                what: "clearance of the balls",
                value: radius,
                min: 0.0,
                max: f64::MAX,
                unit: "m",
            });
        }
        let mut robot = self;
        robot.ball_clearance = Some(radius);
        Ok(robot)
    }

    /// Clearance of the balls in their sockets, as a radius, if known (m).
    #[must_use]
    pub fn ball_clearance(&self) -> Option<f64> {
        self.ball_clearance
    }

    /// Clearance that a pose needs, next to the one that the robot has.
    ///
    /// # Source
    /// Triangle inequality: two balls within c of their sockets are at most 2c closer or farther than these
    #[must_use]
    pub fn needed_clearance<V: Virtualization + ?Sized>(
        &self,
        pose: &PlatformPose,
        virtualization: &V,
    ) -> BallClearance {
        let nominal = self.platform().sockets();
        let sides = sides_of(nominal);
        let largest = pose.sides.iter().zip(sides).map(|(side, nominal)| (side - nominal).abs());
        let displacements = self.ball_displacements(pose, virtualization);
        // The pose is a placement; where it is the best one, the two differ by round-off.
        let lower_bound =
            (0.5 * largest.fold(0.0, f64::max)).min(displacements.into_iter().fold(0.0, f64::max));
        BallClearance { displacements, lower_bound, available: self.ball_clearance }
    }

    /// Distance of each ball from the centre of its nominal socket (m).
    pub(crate) fn ball_displacements<V: Virtualization + ?Sized>(
        &self,
        pose: &PlatformPose,
        virtualization: &V,
    ) -> [f64; 3] {
        let nominal = self.platform().sockets();
        let sockets = virtualization.sockets(self.platform(), &pose.solution.virtual_joints);
        [0, 1, 2].map(|k| (sockets[k] - nominal[k]).norm())
    }
}
