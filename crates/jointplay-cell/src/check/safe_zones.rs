//! Safe zones, which the centres of end effectors must not leave while the robot turns.

use jointplay_core::spatial::Pose;

use super::step_findings::StepFindings;
use crate::collision::{
    MotionBoundCoefficients, MotionBoundModel, SampledStep, Scene, UnknownPose,
};
use crate::geometry::{PlacedCollider, signed_distance};
use crate::robot::EffectorId;
use crate::violation::{
    IntervalMerger, SampleTime, SampleViolation, Subject, ViolationKind, ViolationQuantity,
};

impl StepFindings {
    /// Checks the centre of an effector against the safe zones, at samples where it may have reached a boundary.
    ///
    /// # Arguments
    /// * `index` – number of the effector among all effectors
    pub(super) fn check_safe_zones(
        &self,
        scene: &Scene<'_>,
        sampled: &SampledStep,
        bounds: &MotionBoundModel,
        index: usize,
        effector: EffectorId,
        violations: &mut IntervalMerger,
    ) {
        let kind = ViolationKind::SafeZone;
        let coefficients = MotionBoundCoefficients::of_wafer_center(scene.cell, effector);
        for run in &self.runs {
            let (mut sample, mut stride) = (run.start, 1);
            while sample < run.end {
                let at = SampleTime { time: sampled.times()[sample], sample };
                let pose = match scene.wafer_pose(effector, &sampled.positions(sample)) {
                    Ok(pose) => pose,
                    Err(error) => {
                        UnknownPose { at, error }.report(violations);
                        (sample, stride) = (sample + 1, 1);
                        continue;
                    }
                };
                let mut margin = f64::INFINITY;
                for (zone, collider) in &scene.safe_zones {
                    let base_from_parent = &Pose::identity();
                    let placed = PlacedCollider { collider, base_from_parent };
                    let outside = signed_distance(placed, &pose.translation.vector);
                    margin = margin.min(-outside);
                    if outside > 0.0 {
                        let subject = Subject { kind, first: index, second: *zone };
                        let (value, limit, quantity) = (outside, 0.0, ViolationQuantity::Length);
                        let severity = outside;
                        let violation =
                            SampleViolation { subject, kind, severity, value, limit, quantity };
                        violations.add(at, violation, String::new);
                    }
                }
                // The last sample to which the centre cannot have left: first doubled strides, then bisection.
                let stays_inside = |to: usize| {
                    let travel = sampled.axis_travel(&(sample..to));
                    bounds.displacement(&coefficients, &travel).total() < margin
                };
                let mut near = sample;
                let mut far = (sample + stride).min(run.end);
                while far < run.end && stays_inside(far) {
                    near = far;
                    far = (sample + 2 * (far - sample)).min(run.end);
                }
                while near + 1 < far {
                    let middle = near.midpoint(far);
                    if stays_inside(middle) { near = middle } else { far = middle }
                }
                stride = near + 1 - sample;
                sample = near + 1;
            }
        }
    }
}
