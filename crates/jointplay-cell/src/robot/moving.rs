//! From what all axes do to how an effector's wafer moves.

use jointplay_core::gpr::Forward;
use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector2, Vector3};

use super::planar::{Planar, Slopes, ahead, dot, turned};
use super::{EffectorId, HybridRobot, MAX_JOINTS, Positions, RODS};
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

impl Planar {
    /// Positions, velocities and accelerations of its axes, of those of all axes.
    pub(crate) fn own_rates(&self, motion: &AxesMotion<'_>) -> [Slopes; 3] {
        [motion.positions, motion.velocities, motion.accelerations].map(|rates| self.own(rates))
    }

    /// How the wafer moves on the platform, by positions, velocities and accelerations of its axes.
    pub(crate) fn moving(&self, own: &[Slopes; 3]) -> FrameMotion {
        let (mut velocity, mut acceleration) = (Vector2::zeros(), Vector2::zeros());
        let mut tip = self.origin;
        let by = |slopes: &Slopes| own.each_ref().map(|rates| dot(slopes, rates));
        for arrow in self.arrows() {
            let [angle, speed, hurry] = by(&arrow.turn);
            let arrow = turned(&arrow.vector, angle);
            tip += arrow;
            velocity += ahead(&arrow) * speed;
            acceleration += ahead(&arrow) * hurry - arrow * (speed * speed);
        }
        for slide in self.slides() {
            let [angle, speed, hurry] = by(&slide.along.turn);
            let [length, growth, urge] = by(&slide.growth);
            let along = turned(&slide.along.vector, angle);
            tip += along * length;
            velocity += along * growth + ahead(&along) * (length * speed);
            acceleration += along * (urge - length * speed * speed)
                + ahead(&along) * (2.0 * growth * speed + length * hurry);
        }
        let [_, speed, hurry] = by(&self.heading.1);
        FrameMotion {
            base_from_frame: self.at(&tip, &own[0]),
            velocity: velocity.push(0.0),
            acceleration: acceleration.push(0.0),
            angular_velocity: Vector3::z() * speed,
            angular_acceleration: Vector3::z() * hurry,
        }
    }
}

/// How much an arm's part of a wafer's motion changes between two times, at most, seen from the wafer.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Change {
    /// Of the acceleration of its centre [m/s²].
    pub(crate) acceleration: f64,
    /// Of the velocity of its centre [m/s].
    pub(crate) velocity: f64,
    /// Of its place [m].
    pub(crate) way: f64,
    /// Of its heading [rad].
    pub(crate) turn: f64,
    /// Of the angular acceleration of its heading [rad/s²].
    pub(crate) spin: f64,
    /// Its speed at the second time, at most [m/s].
    pub(crate) speed: f64,
    /// Its distance from the platform's origin at the second time, at most [m].
    pub(crate) reach: f64,
}

/// Position, velocity and acceleration of something.
type Rates = [f64; 3];

/// What an arm does at one time: turns of its heading, of its arrows and of its slides, and lengths of these.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Doing {
    heading: Rates,
    arrows: [Rates; MAX_JOINTS],
    slides: [[Rates; 2]; MAX_JOINTS],
}

impl Planar {
    /// What it does at one time, by positions, velocities and accelerations of its axes.
    pub(crate) fn doing(&self, own: &[Slopes; 3]) -> Doing {
        let by = |slopes: &Slopes| own.each_ref().map(|rates| dot(slopes, rates));
        let mut doing = Doing {
            heading: by(&self.heading.1),
            arrows: Default::default(),
            slides: Default::default(),
        };
        for (rates, arrow) in doing.arrows.iter_mut().zip(self.arrows()) {
            *rates = by(&arrow.turn);
        }
        for (rates, slide) in doing.slides.iter_mut().zip(self.slides()) {
            *rates = [by(&slide.along.turn), by(&slide.growth)];
        }
        doing
    }

    /// How much a wafer's motion changes from one time to the next.
    pub(crate) fn change(&self, from: &Doing, to: &Doing) -> Change {
        let turn = to.heading[0] - from.heading[0];
        let mut change = Change {
            turn: turn.abs(),
            spin: (to.heading[2] - from.heading[2]).abs(),
            reach: self.origin.norm() + self.height.abs(),
            ..Change::default()
        };
        for ((arrow, before), after) in self.arrows().iter().zip(&from.arrows).zip(&to.arrows) {
            let length = arrow.vector.norm();
            let aside = (after[0] - before[0] - turn).abs();
            let squares = [before, after].map(|rates| rates[1] * rates[1]);
            change.acceleration += length
                * ((after[2] - before[2]).abs()
                    + (squares[1] - squares[0]).abs()
                    + aside * (after[2].abs() + squares[1]));
            change.velocity += length * ((after[1] - before[1]).abs() + aside * after[1].abs());
            change.way += length * aside;
            change.speed += length * after[1].abs();
            change.reach += length;
        }
        for (before, after) in from.slides.iter().zip(&to.slides).take(self.slides().len()) {
            let aside = (after[0][0] - before[0][0] - turn).abs();
            // Along and across.
            let hurries = [before, after].map(|[angle, length]| {
                [
                    length[2] - length[0] * angle[1] * angle[1],
                    2.0 * length[1] * angle[1] + length[0] * angle[2],
                ]
            });
            let speeds = [before, after].map(|[angle, length]| [length[1], length[0] * angle[1]]);
            let changed = |of: [[f64; 2]; 2]| -> f64 {
                (0..2).map(|k| (of[1][k] - of[0][k]).abs() + aside * of[1][k].abs()).sum()
            };
            change.acceleration += changed(hurries);
            change.velocity += changed(speeds);
            change.way += (after[1][0] - before[1][0]).abs() + aside * after[1][0].abs();
            change.speed += speeds[1][0].abs() + speeds[1][1].abs();
            change.reach += after[1][0].abs();
        }
        change
    }
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
        let planar = Planar::new(self, id);
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
        now: &Forward,
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
