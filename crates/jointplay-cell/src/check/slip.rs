//! Slip of held wafers, evaluated at samples where the required friction may be the largest or too large.

use std::ops::Range;

use crate::collision::{AxisStates, MotionBoundModel, SampledStep, Scene, droop_bounds};
use crate::columns::map_rows;
use crate::extrema::larger;
use crate::robot::{AxesMotion, EffectorId, MAX_JOINTS, PlanarMotions, RODS};
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
        let inputs = VariationInputs { scene, effector, sampled, bounds, tilt, droop: &droop };
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
        let on_platform = self.on_platform();
        let [by_rods, heave] = self.by_rods(&on_platform);
        let mut total = ForceVariation::default();
        let increments = on_platform.variation.iter().zip(&by_rods).zip(&heave);
        let sums = increments.map(|((by_arm, by_rods), heave)| {
            total.any_direction += INFLATION * (by_arm + by_rods);
            total.vertical += heave;
            total
        });
        std::iter::once(ForceVariation::default()).chain(sums).collect()
    }

    /// Motion of the wafer on the platform from each sample to the next.
    fn on_platform(&self) -> OnPlatform {
        let Self { scene, effector, sampled, tilt, droop, .. } = *self;
        let cell = scene.cell;
        let chain = scene.chain(effector);
        let moving = sampled.moving_axes();
        let arm_moves = moving.moving().iter().any(|axis| chain.axes().contains(axis));
        let states: Vec<_> = chain
            .axes()
            .iter()
            .map(|&axis| moving.states_or_at_rest(axis, sampled.from()[axis]))
            .collect();
        // One row for all samples of an arm at rest.
        let rows = if arm_moves { sampled.times().len() } else { 1 };
        let axes = states.iter().map(|states| {
            let [positions, velocities, accelerations, _] = states.columns();
            [positions, velocities, accelerations].map(|column| &column[..rows])
        });
        let axes: Vec<[&[f64]; 3]> = axes.collect();
        let PlanarMotions(motions) = chain.motions_in_wafer_frame(&axes);
        let height = chain.height().abs();
        let intervals = sampled.times().len() - 1;
        let column = |value: f64| vec![value; intervals];
        let mut found = OnPlatform {
            variation: column(0.0),
            displacement: column(0.0),
            turn: column(0.0),
            speed: column(0.0),
            velocity_change: column(0.0),
            radius: column(motions[0][0].hypot(motions[1][0]) + height),
        };
        if !arm_moves {
            return found;
        }
        let OnPlatform { variation, displacement, turn, speed, velocity_change, radius } =
            &mut found;
        let [x, y, _] = cell.robot.arms[effector.arm].mount;
        let mount_radius = x.hypot(y);
        let described = &cell.robot.arms[effector.arm].effectors[effector.effector];
        let wafer_radius = 0.5 * cell.wafer.diameter;
        let torsion_radius =
            0.5 * wafer_radius * wafer_radius / described.support.lever(&cell.wafer);
        map_rows(
            pairs(motions.each_ref().map(Vec::as_slice)),
            [variation, displacement, turn, speed, velocity_change, radius],
            #[inline(always)]
            |[x, y, v_x, v_y, a_x, a_y, heading, _, heading_acceleration, next @ ..]: [f64; 18]| {
                let [next_x, next_y, next_v_x, next_v_y, next_a_x, next_a_y, ..] = next;
                let [.., next_heading, _, next_heading_acceleration] = next;
                let length = |x: f64, y: f64| (x * x + y * y).sqrt();
                let distance = length(x, y);
                let speed = length(v_x, v_y);
                let acceleration = length(a_x, a_y);
                let displacement = length(next_x - x, next_y - y);
                let velocity_change = length(next_v_x - v_x, next_v_y - v_y);
                let acceleration_change = length(next_a_x - a_x, next_a_y - a_y);
                let turn = (next_heading - heading).abs();
                let reach = larger((distance - mount_radius).abs(), MIN_REACH);
                let transport = acceleration * displacement
                    + speed * (4.0 * velocity_change + speed * displacement / reach);
                let slope_change = (droop.by_reach.slope + droop.slope_per_reach) * displacement
                    + droop.value.slope * turn;
                let variation = (1.0 + droop.by_reach.drop) * acceleration_change
                    + (droop.by_reach.drop / reach + 3.0 * droop.second_by_reach.drop) * transport
                    + (cell.gravity + acceleration) * slope_change
                    + cell.gravity * tilt * turn
                    + torsion_radius * (next_heading_acceleration - heading_acceleration).abs();
                [variation, displacement, turn, speed, velocity_change, distance + height]
            },
        );
        found
    }

    /// Variation by the rods from each sample to the next: in any direction, without the factor [`INFLATION`], and along the vertical, with it.
    fn by_rods(&self, on_platform: &OnPlatform) -> [Vec<f64>; 2] {
        let Self { scene, sampled, bounds, .. } = *self;
        let gravity = scene.cell.gravity;
        let moving = sampled.moving_axes();
        let intervals = sampled.times().len() - 1;
        let mut variation = [vec![0.0; intervals], vec![0.0; intervals]];
        if moving.moving().first().is_none_or(|&axis| axis >= RODS) {
            return variation;
        }
        let rods: [_; RODS] =
            std::array::from_fn(|rod| moving.states_or_at_rest(rod, sampled.from()[rod]));
        // Positions of all rods, then their velocities, then their accelerations.
        let columns: [&[f64]; 9] = std::array::from_fn(|k| rods[k % RODS].columns()[k / RODS]);
        let pairs: [&[f64]; 18] = pairs(columns);
        let OnPlatform { displacement, turn, speed, velocity_change, radius, .. } = on_platform;
        let on_platform = [displacement, turn, speed, velocity_change, radius];
        let inputs: [&[f64]; 23] =
            std::array::from_fn(|k| if k < 18 { pairs[k] } else { on_platform[k - 18] });
        map_rows(
            inputs,
            variation.each_mut().map(Vec::as_mut_slice),
            #[inline(always)]
            |row| {
                let [.., displacement, turn, speed, velocity_change, radius] = row;
                let after = |order: usize| -> [f64; RODS] {
                    std::array::from_fn(|rod| row[9 + RODS * order + rod])
                };
                let difference = |order: usize| -> [f64; RODS] {
                    std::array::from_fn(|rod| after(order)[rod] - row[RODS * order + rod])
                };
                let rate = |order: usize| INFLATION * bounds.tilt_bound(&after(order));
                let [tilt_change, tilt_velocity, tilt_acceleration] =
                    [0, 1, 2].map(|order| INFLATION * bounds.tilt_bound(&difference(order)));
                let variation = tilt_acceleration * radius
                    + rate(2) * (displacement + turn * radius)
                    + 2.0 * (tilt_velocity * speed + rate(1) * (velocity_change + turn * speed))
                    + 2.0 * gravity * tilt_change;
                [variation, INFLATION * bounds.heave_bound(&difference(2))]
            },
        );
        variation
    }
}

/// Motion of a wafer on the platform from each sample to the next, by columns.
struct OnPlatform {
    /// Variation of the specific force by the arm, without the factor [`INFLATION`] (m/s²).
    variation: Vec<f64>,
    /// |Δr| (m)
    displacement: Vec<f64>,
    /// |Δϑ| (rad)
    turn: Vec<f64>,
    /// |ṙ| at the first of the two samples (m/s).
    speed: Vec<f64>,
    /// |Δṙ| (m/s)
    velocity_change: Vec<f64>,
    /// ρ at the first of the two samples (m).
    radius: Vec<f64>,
}

/// Each column without its last row, then each without its first: pairs of successive rows.
fn pairs<const N: usize, const M: usize>(columns: [&[f64]; N]) -> [&[f64]; M] {
    std::array::from_fn(|k| match columns.get(k) {
        Some(column) => &column[..column.len() - 1],
        None => &columns[k - N][1..],
    })
}
