//! Motion of frames, for velocities and accelerations of the coordinates.

use nalgebra::Vector3;

use super::differential::{DifferentialKinematics, Known};
use crate::Error;
use crate::mechanism::FrameId;
use crate::spatial::{FrameTwist, Pose};

impl DifferentialKinematics {
    /// Velocity of a frame, for the velocities computed last.
    ///
    /// # Errors
    /// [`Error::NotLinearized`] before [`velocities`](Self::velocities), [`Error::NoSuchQuantity`].
    pub fn frame_velocity(&self, frame: FrameId) -> Result<FrameTwist, Error> {
        self.known(Known::Velocities)?;
        let (link, arm) = self.arm(frame)?;
        let (angular, linear) = self.velocity.links[link];
        Ok(FrameTwist { angular, linear: linear + angular.cross(&arm) })
    }

    /// Acceleration of a frame, for the accelerations computed last: angular acceleration, and acceleration of the origin.
    ///
    /// # Errors
    /// [`Error::NotLinearized`] before [`accelerations`](Self::accelerations), [`Error::NoSuchQuantity`].
    pub fn frame_acceleration(&self, frame: FrameId) -> Result<FrameTwist, Error> {
        self.known(Known::Accelerations)?;
        let (link, arm) = self.arm(frame)?;
        let velocity = self.frame_velocity(frame)?;
        let (angular, linear) = self.acceleration.links[link];
        let linear = linear + angular.cross(&arm) + velocity.angular.cross(&velocity.linear);
        Ok(FrameTwist { angular, linear })
    }

    /// Pose of a frame in the base frame, at the configuration of [`linearize`](Self::linearize) (m).
    ///
    /// # Errors
    /// [`Error::NotLinearized`] before it, [`Error::NoSuchQuantity`].
    pub fn frame_pose(&self, frame: FrameId) -> Result<Pose, Error> {
        self.known(Known::Loops)?;
        let (link, link_from_frame) = self.on_link(frame)?;
        Ok(self.loops.link_pose(link) * link_from_frame)
    }

    /// Link of a frame, and its pose there.
    fn on_link(&self, frame: FrameId) -> Result<(usize, Pose), Error> {
        let (what, index, count) = match frame {
            FrameId::Link(link) => ("link", link, self.loops.link_count()),
            FrameId::Attached(k) => ("attached frame", k, self.attached.len()),
        };
        if index >= count {
            return Err(Error::NoSuchQuantity { what, index, count });
        }
        Ok(match frame {
            FrameId::Link(link) => (link, Pose::identity()),
            FrameId::Attached(k) => self.attached[k],
        })
    }

    /// Link of a frame, and its origin from the reference point in the base frame (m).
    pub(super) fn arm(&self, frame: FrameId) -> Result<(usize, Vector3<f64>), Error> {
        let (link, link_from_frame) = self.on_link(frame)?;
        let origin = (self.loops.link_pose(link) * link_from_frame).translation.vector;
        Ok((link, origin - self.reference))
    }
}
