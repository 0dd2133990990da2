//! From what all axes do to how an effector's wafer moves.

use jointplay_core::gpr::PlatformPose;
use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector2, Vector3};

use super::arm_chain::{ArmChain, AxisCoefficients, dot, perpendicular, turned};
use super::{EffectorId, HybridRobot, Positions, RODS};
use crate::CellError;

/// Half of the step of differences in time [s]: short against what jerk does, long against round-off.
const STEP: f64 = 1e-4;

/// What all axes do at one time, rods first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxesMotion<'a> {
    /// Of each axis [m or rad].
    pub positions: &'a [f64],
    /// Of each axis [m/s or rad/s].
    pub velocities: &'a [f64],
    /// Of each axis [m/s² or rad/s²].
    pub accelerations: &'a [f64],
}

/// How a frame moves at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameMotion {
    /// Where it is.
    pub base_from_frame: Pose,
    /// Of its origin, in the base frame [m/s].
    pub velocity: Vector3<f64>,
    /// Of its origin, in the base frame [m/s²].
    pub acceleration: Vector3<f64>,
    /// In the base frame [rad/s].
    pub angular_velocity: Vector3<f64>,
    /// In the base frame [rad/s²].
    pub angular_acceleration: Vector3<f64>,
}

impl FrameMotion {
    /// Of a frame that stands.
    #[must_use]
    pub fn still(base_from_frame: Pose) -> Self {
        let zero = Vector3::zeros();
        Self {
            base_from_frame,
            velocity: zero,
            acceleration: zero,
            angular_velocity: zero,
            angular_acceleration: zero,
        }
    }

    /// How a point moves that is fixed in the frame: its place, velocity and acceleration in the base frame [m, m/s, m/s²].
    ///
    /// ```text
    ///    p̈  =  ö + α × r + ω × (ω × r)
    /// ```
    ///
    /// # Example
    /// ```
    /// use jointplay_cell::robot::FrameMotion;
    /// use jointplay_core::spatial::Pose;
    /// use nalgebra::Vector3;
    ///
    /// // A turn at 2 rad/s takes what is 0.5 m out along at 1 m/s, and inward with 2 m/s².
    /// let turn = FrameMotion {
    ///     angular_velocity: Vector3::new(0.0, 0.0, 2.0),
    ///     ..FrameMotion::still(Pose::identity())
    /// };
    /// let [_, velocity, acceleration] = turn.point(&Vector3::new(0.5, 0.0, 0.0));
    /// assert_eq!(velocity, Vector3::new(0.0, 1.0, 0.0));
    /// assert_eq!(acceleration, Vector3::new(-2.0, 0.0, 0.0));
    /// ```
    #[must_use]
    pub fn point(&self, in_frame: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let (omega, alpha) = (&self.angular_velocity, &self.angular_acceleration);
        let lever = self.base_from_frame.rotation * in_frame;
        let around = omega.cross(&lever);
        [
            self.base_from_frame.translation.vector + lever,
            self.velocity + around,
            self.acceleration + alpha.cross(&lever) + omega.cross(&around),
        ]
    }

    /// How a frame moves that moves on this one, told in this one.
    ///
    /// ```text
    ///    v  =  v_1 + ω_1 × r + R_1 v_2                                          r  =  R_1 o_2
    ///    a  =  a_1 + α_1 × r + ω_1 × (ω_1 × r) + 2 ω_1 × R_1 v_2 + R_1 a_2
    ///    ω  =  ω_1 + R_1 ω_2,       α  =  α_1 + R_1 α_2 + ω_1 × R_1 ω_2
    /// ```
    #[must_use]
    pub fn carrying(&self, other: &Self) -> Self {
        let [_, velocity, acceleration] = self.point(&other.base_from_frame.translation.vector);
        let rotation = &self.base_from_frame.rotation;
        let (moving, turning) = (rotation * other.velocity, rotation * other.angular_velocity);
        let omega = &self.angular_velocity;
        Self {
            base_from_frame: self.base_from_frame * other.base_from_frame,
            velocity: velocity + moving,
            acceleration: acceleration + omega.cross(&moving) * 2.0 + rotation * other.acceleration,
            angular_velocity: omega + turning,
            angular_acceleration: self.angular_acceleration
                + rotation * other.angular_acceleration
                + omega.cross(&turning),
        }
    }
}

impl ArmChain {
    /// Positions, velocities and accelerations of its axes, of those of all axes.
    pub(crate) fn own_rates(&self, motion: &AxesMotion<'_>) -> [AxisCoefficients; 3] {
        [motion.positions, motion.velocities, motion.accelerations].map(|rates| self.own(rates))
    }

    /// How the wafer moves on the platform, by positions, velocities and accelerations of its axes.
    pub(crate) fn moving(&self, own: &[AxisCoefficients; 3]) -> FrameMotion {
        let [tip, velocity, acceleration] = self.tip_motion(own, 0.0);
        let [_, speed, hurry] = own.each_ref().map(|rates| dot(&self.heading.1, rates));
        FrameMotion {
            base_from_frame: self.at(&tip, &own[0]),
            velocity: velocity.push(0.0),
            acceleration: acceleration.push(0.0),
            angular_velocity: Vector3::z() * speed,
            angular_acceleration: Vector3::z() * hurry,
        }
    }

    /// The same as the wafer sees it.
    pub(crate) fn seen(&self, own: &[AxisCoefficients; 3]) -> FrameAcceleration {
        let heading = own.each_ref().map(|rates| dot(&self.heading.1, rates));
        let [place, velocity, acceleration] = self.tip_motion(own, -heading[0]);
        FrameAcceleration { place, velocity, acceleration, heading }
    }

    /// Place, velocity and acceleration of the tip on the platform, turned by an angle.
    fn tip_motion(&self, own: &[AxisCoefficients; 3], turn: f64) -> [Vector2<f64>; 3] {
        let (mut velocity, mut acceleration) = (Vector2::zeros(), Vector2::zeros());
        let mut tip = turned(&self.origin, turn);
        let by = |slopes: &AxisCoefficients| own.each_ref().map(|rates| dot(slopes, rates));
        for arrow in self.arrows() {
            let [angle, speed, hurry] = by(&arrow.turn);
            let arrow = turned(&arrow.vector, turn + angle);
            tip += arrow;
            velocity += perpendicular(&arrow) * speed;
            acceleration += perpendicular(&arrow) * hurry - arrow * (speed * speed);
        }
        for slide in self.slides() {
            let [angle, speed, hurry] = by(&slide.along.turn);
            let [length, growth, urge] = by(&slide.growth);
            let along = turned(&slide.along.vector, turn + angle);
            tip += along * length;
            velocity += along * growth + perpendicular(&along) * (length * speed);
            acceleration += along * (urge - length * speed * speed)
                + perpendicular(&along) * (2.0 * growth * speed + length * hurry);
        }
        [tip, velocity, acceleration]
    }
}

/// How a wafer moves on the platform, along its own axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FrameAcceleration {
    /// Of its centre from the platform's origin [m].
    pub(crate) place: Vector2<f64>,
    /// [m/s]
    pub(crate) velocity: Vector2<f64>,
    /// [m/s²]
    pub(crate) acceleration: Vector2<f64>,
    /// Its heading, up to a constant, with its first and second derivative [rad, rad/s, rad/s²].
    pub(crate) heading: [f64; 3],
}

impl HybridRobot {
    /// How the wafer frame of one effector moves; rigid, nothing droops.
    ///
    /// # Arguments
    /// * `motion` – what all axes do
    ///
    /// # Errors
    /// As [`Self::effector_pose`], for each of the three.
    ///
    /// # Numerics
    /// Exact for the arms, and for a platform that goes up and down.
    /// While rods go unevenly, of the platform's velocities by second order differences in time, over 0.1 ms to either side: relatively off by some 1e-7.
    pub fn effector_motion(
        &self,
        motion: &AxesMotion<'_>,
        id: EffectorId,
    ) -> Result<FrameMotion, CellError> {
        self.check_effector(id)?;
        self.check_motion(motion)?;
        let platform = self.platform(motion.positions)?;
        let platform = self.platform_motion(&platform, motion)?;
        let planar = ArmChain::new(self, id);
        Ok(platform.carrying(&planar.moving(&planar.own_rates(motion))))
    }

    pub(crate) fn check_motion(&self, motion: &AxesMotion<'_>) -> Result<(), CellError> {
        self.check_each("position", motion.positions)?;
        self.check_each("velocity", motion.velocities)?;
        self.check_each("acceleration", motion.accelerations)
    }

    /// How the platform moves that is there now.
    pub(crate) fn platform_motion(
        &self,
        now: &PlatformPose,
        motion: &AxesMotion<'_>,
    ) -> Result<FrameMotion, CellError> {
        let (velocities, accelerations) =
            (&motion.velocities[..RODS], &motion.accelerations[..RODS]);
        let even = |values: &[f64]| values[1] == values[0] && values[2] == values[0];
        if even(velocities) && even(accelerations) {
            return Ok(FrameMotion {
                velocity: Vector3::z() * velocities[0],
                acceleration: Vector3::z() * accelerations[0],
                ..FrameMotion::still(now.base_from_platform)
            });
        }
        let on_parabola = |t: f64| {
            let mut moved = Positions::new(&motion.positions[..RODS]);
            for (rod, position) in moved.iter_mut().enumerate() {
                *position += t * (velocities[rod] + 0.5 * t * accelerations[rod]);
            }
            Ok::<_, CellError>(self.platform(&moved)?.base_from_platform)
        };
        let (before, after) = (on_parabola(-STEP)?, on_parabola(STEP)?);
        let now = now.base_from_platform;
        let at = |pose: &Pose| pose.translation.vector;
        let (last, first) = (at(&now) - at(&before), at(&after) - at(&now));
        let turns = [
            turn_between(&before.rotation, &now.rotation),
            turn_between(&now.rotation, &after.rotation),
        ];
        Ok(FrameMotion {
            base_from_frame: now,
            velocity: (first + last) / (2.0 * STEP),
            acceleration: (first - last) / (STEP * STEP),
            angular_velocity: (turns[1] + turns[0]) / (2.0 * STEP),
            angular_acceleration: (turns[1] - turns[0]) / (STEP * STEP),
        })
    }
}

/// The turn from one rotation to another that is near, as a vector in the base frame, as long as its sine [rad].
pub(super) fn turn_between(from: &Rotation3<f64>, to: &Rotation3<f64>) -> Vector3<f64> {
    let turn = (to * from.inverse()).into_inner();
    let twice = Vector3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    );
    twice * 0.5
}
