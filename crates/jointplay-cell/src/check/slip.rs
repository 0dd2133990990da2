//! Slip of held wafers, evaluated at samples where the required friction may be the largest or too large.

use std::ops::Range;

use crate::collision::{AxisStates, MotionBoundModel, SampledStep, Scene, droop_bounds};
use crate::robot::{AxesMotion, EffectorId, MAX_JOINTS, RODS};
use crate::wafer::{DroopBounds, FrictionDemand, MIN_REACH};

/// Factor of the bound for effects that it neglects.
///
/// These are the offset of the centre of pressure of the pads, and the in-plane motion of the platform as it tilts: both are of second order in tilt and acceleration.
/// A tenth covers them with a margin; tests compare the largest utilization with that of all samples.
const INFLATION: f64 = 1.1;
/// Tolerance of the largest utilization of friction: samples that were not evaluated may have this much more, to the accuracy of [`INFLATION`].
const UTILIZATION_TOLERANCE: f64 = 1e-4;

/// A held wafer at the samples of a step.
pub(super) struct HeldWafer<'a> {
    scene: &'a Scene<'a>,
    rods: AxisStates<'a, RODS>,
    arm: AxisStates<'a, MAX_JOINTS>,
    effector: EffectorId,
    /// Upper bound of the sine of the wafer's tilt in the step.
    sin_tilt: f64,
    /// Variation of the required specific force since the start, by sample.
    variation: Vec<ForceVariation>,
    /// Largest utilization of friction so far.
    peak: f64,
    /// Evaluated samples with their friction.
    pub(super) evaluated: Vec<(usize, FrictionDemand)>,
}

impl<'a> HeldWafer<'a> {
    /// # Arguments
    /// * `tilt` – largest tilt of the platform in the step (rad)
    pub(super) fn new(
        scene: &'a Scene<'a>,
        sampled: &'a SampledStep,
        bounds: &MotionBoundModel,
        effector: EffectorId,
        tilt: f64,
    ) -> Self {
        let rods = sampled.axis_states(&[0, 1, 2]);
        let arm = sampled.axis_states(scene.chain(effector).axes());
        let droop = droop_bounds(scene.cell, effector);
        let inputs = VariationInputs {
            scene,
            effector,
            sampled,
            bounds,
            rods: &rods,
            arm: &arm,
            tilt,
            droop: &droop,
        };
        let variation = inputs.accumulate();
        let sin_tilt = tilt.sin() + droop.value.slope;
        let evaluated = Vec::new();
        Self { scene, rods, arm, effector, sin_tilt, variation, peak: 0.0, evaluated }
    }

    /// Checks a run of samples.
    pub(super) fn check_run(&mut self, run: &Range<usize>) {
        let (first, last) = (run.start, run.end - 1);
        let left = self.evaluate(first);
        if last > first {
            let right = self.evaluate(last);
            self.bisect(first..last, left, right);
        }
    }

    /// Bisects the interval between two samples unless the friction in it is bounded.
    ///
    /// ```text
    ///    max φ  ≤  (φ₀ + φ₁ + (1 + η µ) Δ + (sin α + η µ) Δ_z) / 2          φ  =  required − η available,   available = µ f_n
    /// ```
    /// φ₀, φ₁: values at both ends; η: largest utilization so far, below 1; µ: coefficient of friction; f_n: normal component of the specific force;
    /// α: largest tilt of the wafer; Δ, Δ_z: variation of the specific force in any direction, and along the vertical. Where φ ≤ 0, no utilization exceeds η.
    fn bisect(&mut self, interval: Range<usize>, left: FrictionDemand, right: FrictionDemand) {
        if interval.len() < 2 {
            return;
        }
        // Below 1: a sample that slips is always evaluated.
        let utilization = self.peak.min(1.0 - UTILIZATION_TOLERANCE);
        let effector = &self.scene.cell.robot.arms[self.effector.arm].effectors;
        let friction = effector[self.effector.effector].friction;
        let [from, to] = [interval.start, interval.end].map(|sample| self.variation[sample]);
        let pressing = utilization * friction;
        let variation = (1.0 + pressing) * (to.any_direction - from.any_direction)
            + (self.sin_tilt + pressing) * (to.vertical - from.vertical);
        let excess = |margin: FrictionDemand| {
            margin.required - (utilization + UTILIZATION_TOLERANCE) * margin.available
        };
        if excess(left) + excess(right) + variation <= 0.0 {
            return;
        }
        let middle = interval.start.midpoint(interval.end);
        let center = self.evaluate(middle);
        // The half with the larger utilization first: the peak found there may rule out the other half.
        if left.utilization() >= right.utilization() {
            self.bisect(interval.start..middle, left, center);
            self.bisect(middle..interval.end, center, right);
        } else {
            self.bisect(middle..interval.end, center, right);
            self.bisect(interval.start..middle, left, center);
        }
    }

    /// Friction at a sample; infinite where the acceleration is unknown, so that no neighbouring interval is ruled out.
    fn evaluate(&mut self, sample: usize) -> FrictionDemand {
        let Some(margin) = self.friction_demand(sample) else {
            return FrictionDemand { required: f64::INFINITY, available: 0.0 };
        };
        self.peak = self.peak.max(margin.utilization());
        self.evaluated.push((sample, margin));
        margin
    }

    fn friction_demand(&self, sample: usize) -> Option<FrictionDemand> {
        let cell = self.scene.cell;
        let rods = self.rods.at(sample);
        let [positions, velocities, accelerations] = rods.each_ref().map(|values| &values[..]);
        let motion = AxesMotion { positions, velocities, accelerations };
        let now = cell.robot.platform(positions).ok()?;
        let platform = cell.robot.platform_motion(&now, &motion).ok()?;
        let on_platform = self.scene.chain(self.effector).wafer_motion(&self.arm.at(sample));
        let wafer = cell.deflected_motion(&platform, &on_platform, self.effector, true).ok()?;
        Some(cell.friction_demand_of(self.effector, &wafer))
    }
}

/// Variation of the specific force that a wafer requires since the start of the step, accumulated as an upper bound (m/s²).
#[derive(Debug, Clone, Copy, Default)]
struct ForceVariation {
    /// Variation in any direction (m/s²).
    any_direction: f64,
    /// Vertical part in the base frame, in addition (m/s²).
    vertical: f64,
}

/// Inputs of the variation of the specific force.
struct VariationInputs<'i> {
    scene: &'i Scene<'i>,
    effector: EffectorId,
    sampled: &'i SampledStep,
    bounds: &'i MotionBoundModel,
    rods: &'i AxisStates<'i, RODS>,
    arm: &'i AxisStates<'i, MAX_JOINTS>,
    /// Largest tilt of the platform in the step (rad).
    tilt: f64,
    droop: &'i DroopBounds,
}

impl VariationInputs<'_> {
    /// Accumulates the variation by sample.
    ///
    /// ```text
    ///    arm                 |Δr̈|
    ///    heave               |Δz̈|
    ///    platform            |Δα̈| ρ + |α̈| (|Δr| + ρ |Δϑ|) + 2 |Δα̇| |ṙ| + 2 |α̇| (|Δṙ| + |ṙ| |Δϑ|)
    ///    gravity             2 g |Δα| + g α |Δϑ|
    ///    heading acceleration    R² |Δϑ̈| / 2b
    ///    deflection          d' |Δr̈| + (d' / l + 3 d'') (|r̈| |Δr| + 4 |ṙ| |Δṙ| + ṙ² |Δr| / l) + (g + |r̈|) ((s' + s / l) |Δr| + s |Δϑ|)
    /// ```
    /// Δ: change from one sample to the next.
    /// r, ϑ: position of the wafer's centre and heading on the platform, r along the wafer's axes; ρ: distance of the centre from the platform's origin, at most.
    /// z: height of the platform; α: its tilt, in bounds of magnitude only; g: gravity.
    /// R: radius of the wafer; b: lever arm of friction against rotation.
    /// d, s: drop and slope of the deflection at the reach l, with derivatives with respect to the reach.
    fn accumulate(&self) -> Vec<ForceVariation> {
        let Self { scene, effector, sampled, bounds, rods, arm, tilt, droop } = *self;
        let cell = scene.cell;
        let chain = scene.chain(effector);
        let described = &cell.robot.arms[effector.arm].effectors[effector.effector];
        let radius = 0.5 * cell.wafer.diameter;
        let torsion_radius = 0.5 * radius * radius / described.support.lever(&cell.wafer);
        let (moving, count) = (sampled.moving_axes().moving(), sampled.times().len());
        let [x, y, _] = cell.robot.arms[effector.arm].mount;
        let mount_radius = x.hypot(y);
        let rods_move = moving.first().is_some_and(|&axis| axis < RODS);
        let arm_moves = moving.iter().any(|axis| chain.axes().contains(axis));
        let mut before = rods.at(0);
        let mut previous = chain.motion_in_wafer_frame(&arm.at(0));
        let mut total = ForceVariation::default();
        let mut variation = Vec::with_capacity(count);
        variation.push(total);
        for sample in 1..count {
            let mut change = 0.0;
            let now =
                if arm_moves { chain.motion_in_wafer_frame(&arm.at(sample)) } else { previous };
            let [turn, _, heading_acceleration] =
                std::array::from_fn(|k| (now.heading[k] - previous.heading[k]).abs());
            let (speed, wafer_radius) =
                (previous.velocity.norm(), previous.position.norm() + chain.height().abs());
            let displacement = (now.position - previous.position).norm();
            let velocity_change = (now.velocity - previous.velocity).norm();
            if arm_moves {
                let acceleration_change = (now.acceleration - previous.acceleration).norm();
                let reach = (previous.position.norm() - mount_radius).abs().max(MIN_REACH);
                let acceleration = previous.acceleration.norm();
                let transport = acceleration * displacement
                    + speed * (4.0 * velocity_change + speed * displacement / reach);
                let slope_change = (droop.by_reach.slope + droop.slope_per_reach) * displacement
                    + droop.value.slope * turn;
                change += (1.0 + droop.by_reach.drop) * acceleration_change
                    + (droop.by_reach.drop / reach + 3.0 * droop.second_by_reach.drop) * transport
                    + (cell.gravity + acceleration) * slope_change
                    + cell.gravity * tilt * turn
                    + torsion_radius * heading_acceleration;
            }
            if rods_move {
                let after = rods.at(sample);
                let difference = |order: usize| -> [f64; RODS] {
                    std::array::from_fn(|rod| after[order][rod] - before[order][rod])
                };
                let rate = |order: usize| INFLATION * bounds.tilt_bound(&after[order]);
                let [tilt_change, tilt_velocity, tilt_acceleration] =
                    [0, 1, 2].map(|order| INFLATION * bounds.tilt_bound(&difference(order)));
                total.vertical += INFLATION * bounds.heave_bound(&difference(2));
                change += tilt_acceleration * wafer_radius
                    + rate(2) * (displacement + turn * wafer_radius)
                    + 2.0 * (tilt_velocity * speed + rate(1) * (velocity_change + turn * speed))
                    + 2.0 * cell.gravity * tilt_change;
                before = after;
            }
            previous = now;
            total.any_direction += INFLATION * change;
            variation.push(total);
        }
        variation
    }
}
