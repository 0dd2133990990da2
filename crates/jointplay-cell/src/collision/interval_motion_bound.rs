//! Bound of the relative motion of two collision objects in an interval of time.

use std::ops::Range;

use super::motion_bound::{DisplacementBound, MotionBoundModel};
use super::motion_bound_coefficients::MotionBoundCoefficients;
use super::object::Parent;
use super::sampled_step::SampledStep;
use super::scene::Scene;
use super::unknown_pose::UnknownPose;

/// Bound of the relative motion of a pair in an interval.
#[derive(Clone, Copy)]
pub(super) struct IntervalMotionBound {
    /// Travel in any direction (m).
    pub(super) total: f64,
    /// Travel along the platform's normal (m).
    pub(super) along_normal: f64,
    /// Travel by the rods alone (m).
    pub(super) platform: f64,
    /// Travel by changes of the arms' deflection alone (m).
    pub(super) deflection: f64,
    /// Horizontal part of `deflection` (m).
    pub(super) lateral_deflection: f64,
    /// Rotation of the platform's normal (rad).
    pub(super) normal_rotation: f64,
}

impl IntervalMotionBound {
    /// The bound with another bound of the deflection, and its horizontal part (m).
    pub(super) fn with_deflection(self, deflection: f64, lateral_deflection: f64) -> Self {
        let excess = self.deflection - deflection;
        let (total, along_normal) = (self.total - excess, self.along_normal - excess);
        Self { total, along_normal, deflection, lateral_deflection, ..self }
    }

    /// Bound for either half of the interval: travel is bounded by the largest speed over the whole time, and so is additive over halves.
    pub(super) fn half(self) -> Self {
        let Self { total, along_normal, platform, deflection, lateral_deflection, normal_rotation } =
            self;
        Self {
            total: 0.5 * total,
            along_normal: 0.5 * along_normal,
            platform: 0.5 * platform,
            deflection: 0.5 * deflection,
            lateral_deflection: 0.5 * lateral_deflection,
            normal_rotation: 0.5 * normal_rotation,
        }
    }
}

/// Relative motion of a pair in a window of a step.
pub(super) struct PairMotion<'q> {
    pub(super) scene: &'q Scene<'q>,
    pub(super) sampled: &'q SampledStep,
    pub(super) bounds: &'q MotionBoundModel,
    pub(super) coefficients: &'q MotionBoundCoefficients,
    /// Last body that carries both objects.
    pub(super) ancestor: Parent,
}

impl PairMotion<'_> {
    /// Bound between two samples.
    pub(super) fn bound(&self, interval: &Range<usize>) -> IntervalMotionBound {
        let travel = self.sampled.axis_travel(interval);
        let DisplacementBound {
            platform,
            arms,
            deflection,
            lateral_deflection,
            platform_deflection,
        } = self.bounds.displacement(self.coefficients, &travel);
        let normal_rotation = travel.normal_rotation.min(1.0);
        // A common platform moves both alike: of its motion only the change of the deflections in its frame counts.
        let (platform, by_rotation) = if self.ancestor == Parent::World {
            (platform, normal_rotation * arms)
        } else {
            (platform_deflection, 0.0)
        };
        IntervalMotionBound {
            total: platform + arms + deflection,
            along_normal: platform + deflection + by_rotation,
            platform,
            deflection,
            lateral_deflection,
            normal_rotation,
        }
    }

    /// A bound between two samples with deflections by the reach of the arms in the interval, instead of their largest one.
    ///
    /// # Errors
    /// [`UnknownPose`], where a pose was not computed.
    pub(super) fn with_droop_in_interval(
        &self,
        interval: &Range<usize>,
        motion: IntervalMotionBound,
    ) -> Result<IntervalMotionBound, UnknownPose> {
        let first = self.sampled.link_poses(interval.start)?;
        let last = self.sampled.link_poses(interval.end)?;
        let travel = self.sampled.axis_travel(interval);
        let (mut deflection, mut lateral_deflection) = (0.0, 0.0);
        for of_arm in self.coefficients.deflections.iter().flatten() {
            let [from, to] = [first, last].map(|poses| self.scene.reach(of_arm.effector(), poses));
            let bound = of_arm.in_interval(self.scene.cell, from.max(to), travel.paths());
            deflection += bound.total;
            lateral_deflection += bound.lateral;
        }
        Ok(motion.with_deflection(deflection, lateral_deflection))
    }

    /// Largest deviation of the arms' part of the relative motion from the chord between two samples (m).
    ///
    /// A coordinate whose velocity varies by `v` in all deviates from the chord between two times by `v dt / 4` at most.
    pub(super) fn chord_deviation(&self, interval: &Range<usize>) -> f64 {
        let [from, to] = [interval.start, interval.end].map(|k| self.sampled.times()[k]);
        let travel = self.sampled.axis_travel(interval);
        0.25 * (to - from) * self.bounds.velocity_variation(self.coefficients, &travel)
    }
}
