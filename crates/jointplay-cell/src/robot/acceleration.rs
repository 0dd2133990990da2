//! From positions, velocities and accelerations of the axes to the motion of an effector's wafer.

use jointplay_core::bulk::sin_cos;
use jointplay_core::gpr::PlatformPose;
use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector2, Vector3};

use super::arm_chain::{ArmChain, ArmVector, RotatedVectors, dot, perpendicular};
use super::hybrid_robot::{EffectorId, HybridRobot, RODS};
use super::positions::Positions;
use crate::CellError;
use crate::columns::map_rows;

/// Half of the time step of differences (s): short against changes by jerk, long against round-off.
const STEP: f64 = 1e-4;

/// Positions, velocities and accelerations of all axes at one time, rods first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxesMotion<'a> {
    /// Position of each axis (m or rad).
    pub positions: &'a [f64],
    /// Velocity of each axis (m/s or rad/s).
    pub velocities: &'a [f64],
    /// Acceleration of each axis (m/s² or rad/s²).
    pub accelerations: &'a [f64],
}

/// Pose, velocity and acceleration of a frame at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameMotion {
    /// Pose of the frame.
    pub base_from_frame: Pose,
    /// Velocity of the origin, in the base frame (m/s).
    pub velocity: Vector3<f64>,
    /// Acceleration of the origin, in the base frame (m/s²).
    pub acceleration: Vector3<f64>,
    /// Angular velocity, in the base frame (rad/s).
    pub angular_velocity: Vector3<f64>,
    /// Angular acceleration, in the base frame (rad/s²).
    pub angular_acceleration: Vector3<f64>,
}

impl FrameMotion {
    /// Motion of a frame at rest.
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

    /// Position, velocity and acceleration in the base frame of a point that is fixed in the frame (m, m/s, m/s²).
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
    /// // A rotation at 2 rad/s moves a point at 0.5 m with 1 m/s, and accelerates it inward with 2 m/s².
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

    /// Motion in the base frame of a frame whose motion relative to this one is known.
    ///
    /// ```text
    ///    v  =  v_1 + ω_1 × r + R_1 v_2                                          r  =  R_1 o_2
    ///    a  =  a_1 + α_1 × r + ω_1 × (ω_1 × r) + 2 ω_1 × R_1 v_2 + R_1 a_2
    ///    ω  =  ω_1 + R_1 ω_2,       α  =  α_1 + R_1 α_2 + ω_1 × R_1 ω_2
    /// ```
    #[must_use]
    pub fn composed_with(&self, other: &Self) -> Self {
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
    /// Positions, velocities and accelerations of the arm's own axes, from those of all axes.
    pub(crate) fn arm_states(&self, motion: &AxesMotion<'_>) -> [ArmVector; 3] {
        [motion.positions, motion.velocities, motion.accelerations]
            .map(|rates| self.arm_positions(rates))
    }

    /// Motion of the wafer relative to the platform, from positions, velocities and accelerations of the arm's own axes.
    pub(crate) fn wafer_motion(&self, arm_states: &[ArmVector; 3]) -> FrameMotion {
        let rotated = self.rotated_vectors(&arm_states[0]);
        let [tip, velocity, acceleration] = self.tip_motion(&rotated, arm_states);
        let [_, rate, acceleration_of_heading] =
            arm_states.each_ref().map(|rates| dot(&self.heading.1, rates));
        FrameMotion {
            base_from_frame: self.wafer_pose(&tip, &rotated),
            velocity: velocity.push(0.0),
            acceleration: acceleration.push(0.0),
            angular_velocity: Vector3::z() * rate,
            angular_acceleration: Vector3::z() * acceleration_of_heading,
        }
    }

    /// Motions of the wafer relative to the platform in the axes of the wafer, at many times.
    ///
    /// # Arguments
    /// * `axes` – columns of positions, velocities and accelerations of each of [`Self::axes`]
    pub(crate) fn motions_in_wafer_frame(&self, axes: &[[&[f64]; 3]]) -> PlanarMotions {
        let count = axes.first().map_or(1, |columns| columns[0].len());
        let weighted = |slopes: &ArmVector, order: usize| {
            let mut sum = vec![0.0; count];
            for (slope, columns) in slopes.iter().zip(axes).filter(|(slope, _)| **slope != 0.0) {
                sum.iter_mut().zip(columns[order]).for_each(|(sum, value)| *sum += slope * value);
            }
            sum
        };
        let heading = [0, 1, 2].map(|order| weighted(&self.heading.1, order));
        let links = self.link_vectors().iter().map(|link_vector| &link_vector.turn);
        let slides = self.prismatic_joints().iter().map(|slide| &slide.along.turn);
        // The origin, then the vectors of all links and slides.
        let mut angles: Vec<f64> = heading[0].iter().map(|heading| -heading).collect();
        for turn in links.chain(slides) {
            let turned = weighted(turn, 0);
            angles.extend(turned.iter().zip(&heading[0]).map(|(angle, heading)| angle - heading));
        }
        let (mut sines, mut cosines) = (vec![0.0; angles.len()], vec![0.0; angles.len()]);
        sin_cos(&angles, &mut sines, &mut cosines).expect("the columns have one length");
        let mut turns = sines.chunks_exact(count).zip(cosines.chunks_exact(count));
        let mut turned = || turns.next().expect("there is an angle for each vector");
        let mut sum: [Vec<f64>; 6] = std::array::from_fn(|_| vec![0.0; count]);
        let mut next = sum.clone();
        let (sin, cos) = turned();
        let (x, y) = (self.origin.x, self.origin.y);
        let [tip_x, tip_y, ..] = &mut sum;
        map_rows([sin, cos], [tip_x, tip_y], |[sin, cos]| [cos * x - sin * y, sin * x + cos * y]);
        for link_vector in self.link_vectors() {
            let (sin, cos) = turned();
            let (x, y) = (link_vector.vector.x, link_vector.vector.y);
            let [omega, alpha] = [1, 2].map(|order| weighted(&link_vector.turn, order));
            let [p_x, p_y, v_x, v_y, a_x, a_y] = sum.each_ref().map(Vec::as_slice);
            map_rows(
                [sin, cos, &omega, &alpha, p_x, p_y, v_x, v_y, a_x, a_y],
                next.each_mut().map(Vec::as_mut_slice),
                |[sin, cos, omega, alpha, p_x, p_y, v_x, v_y, a_x, a_y]| {
                    let (x, y) = (cos * x - sin * y, sin * x + cos * y);
                    let inward = omega * omega;
                    [
                        p_x + x,
                        p_y + y,
                        v_x - omega * y,
                        v_y + omega * x,
                        a_x - alpha * y - inward * x,
                        a_y + alpha * x - inward * y,
                    ]
                },
            );
            std::mem::swap(&mut sum, &mut next);
        }
        for slide in self.prismatic_joints() {
            let (sin, cos) = turned();
            let (x, y) = (slide.along.vector.x, slide.along.vector.y);
            let [omega, alpha] = [1, 2].map(|order| weighted(&slide.along.turn, order));
            let [length, rate, second] = [0, 1, 2].map(|order| weighted(&slide.extension, order));
            let [p_x, p_y, v_x, v_y, a_x, a_y] = sum.each_ref().map(Vec::as_slice);
            map_rows(
                [sin, cos, &omega, &alpha, &length, &rate, &second, p_x, p_y, v_x, v_y, a_x, a_y],
                next.each_mut().map(Vec::as_mut_slice),
                |[sin, cos, omega, alpha, length, rate, second, p_x, p_y, v_x, v_y, a_x, a_y]| {
                    let (x, y) = (cos * x - sin * y, sin * x + cos * y);
                    let (along, across) =
                        (second - length * omega * omega, 2.0 * rate * omega + length * alpha);
                    [
                        p_x + length * x,
                        p_y + length * y,
                        v_x + rate * x - length * omega * y,
                        v_y + rate * y + length * omega * x,
                        a_x + along * x - across * y,
                        a_y + along * y + across * x,
                    ]
                },
            );
            std::mem::swap(&mut sum, &mut next);
        }
        let [p_x, p_y, v_x, v_y, a_x, a_y] = sum;
        let [angle, angular_velocity, angular_acceleration] = heading;
        PlanarMotions([p_x, p_y, v_x, v_y, a_x, a_y, angle, angular_velocity, angular_acceleration])
    }

    /// Position, velocity and acceleration of the tip relative to the platform.
    fn tip_motion(
        &self,
        rotated: &RotatedVectors,
        arm_states: &[ArmVector; 3],
    ) -> [Vector2<f64>; 3] {
        let (mut velocity, mut acceleration) = (Vector2::zeros(), Vector2::zeros());
        let mut tip = self.origin;
        let by = |slopes: &ArmVector| arm_states.each_ref().map(|rates| dot(slopes, rates));
        for (link_vector, rotated) in self.link_vectors().iter().zip(rotated.links()) {
            let [_, omega, alpha] = by(&link_vector.turn);
            tip += rotated;
            velocity += perpendicular(rotated) * omega;
            acceleration += perpendicular(rotated) * alpha - rotated * (omega * omega);
        }
        for (slide, along) in self.prismatic_joints().iter().zip(rotated.prismatic_joints()) {
            let [_, omega, alpha] = by(&slide.along.turn);
            let [length, rate, length_acceleration] = by(&slide.extension);
            tip += along * length;
            velocity += along * rate + perpendicular(along) * (length * omega);
            acceleration += along * (length_acceleration - length * omega * omega)
                + perpendicular(along) * (2.0 * rate * omega + length * alpha);
        }
        [tip, velocity, acceleration]
    }
}

/// Motions of a wafer relative to the platform in the axes of the wafer, at many times.
///
/// Columns of x and y of position, velocity and acceleration of the centre (m, m/s, m/s²), then of the heading, up to a constant, and its first and second derivatives (rad, rad/s, rad/s²).
#[derive(Debug)]
pub(crate) struct PlanarMotions(pub(crate) [Vec<f64>; 9]);

impl HybridRobot {
    /// Motion of the wafer frame of one effector; bodies are rigid, nothing droops.
    ///
    /// # Arguments
    /// * `motion` – positions, velocities and accelerations of all axes
    ///
    /// # Errors
    /// As [`Self::effector_pose`], for each of the three.
    ///
    /// # Numerics
    /// Exact for the arms, and for a platform that moves up and down without tilting.
    /// While rods move at different speeds, the platform's motion follows from second order differences in time, over 0.1 ms to either side: relative error about 1e-7.
    pub fn effector_motion(
        &self,
        motion: &AxesMotion<'_>,
        id: EffectorId,
    ) -> Result<FrameMotion, CellError> {
        self.check_effector(id)?;
        self.check_motion(motion)?;
        let platform = self.platform(motion.positions)?;
        let platform = self.platform_motion(&platform, motion)?;
        let chain = ArmChain::new(self, id);
        Ok(platform.composed_with(&chain.wafer_motion(&chain.arm_states(motion))))
    }

    pub(crate) fn check_motion(&self, motion: &AxesMotion<'_>) -> Result<(), CellError> {
        self.check_each("position", motion.positions)?;
        self.check_each("velocity", motion.velocities)?;
        self.check_each("acceleration", motion.accelerations)
    }

    /// Motion of the platform, its pose known.
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

/// Rotation vector from one rotation to another that is near, in the base frame, its length the sine of the angle instead of the angle (rad).
pub(super) fn turn_between(from: &Rotation3<f64>, to: &Rotation3<f64>) -> Vector3<f64> {
    let turn = (to * from.inverse()).into_inner();
    let twice = Vector3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    );
    twice * 0.5
}
