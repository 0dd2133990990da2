//! Arms without a closed form: Newton's method from several starts.

use jointplay_core::linalg::least_norm_of_three;
use jointplay_core::spatial::wrap_angle;
use nalgebra::{Vector2, Vector3};

use super::revolutions::Ranges;
use crate::robot::arm_chain::{ArmChain, ArmVector};

/// Number of starts along each axis, between its limits.
const STARTS: usize = 5;

const MAX_ITERATIONS: usize = 40;

/// Largest step, as a fraction of the ranges of the axes: farther, the linearization is too inaccurate.
const MAX_STEP: f64 = 0.25;

/// Distance below which two solutions are one, as a fraction of the ranges.
const SAME_SOLUTION: f64 = 1e-6;

/// Largest number of solutions.
const MAX_SOLUTIONS: usize = 16;

/// Solutions from several starts, the one nearest to `seed` first.
///
/// Steps have least norm in units of the ranges of the axes: an arm with more motors than needed stays near its start, which is `seed` if that leads to a solution.
pub(super) fn solutions(
    chain: &ArmChain,
    ranges: &Ranges,
    point: &Vector2<f64>,
    heading: Option<f64>,
    seed: &ArmVector,
) -> Vec<ArmVector> {
    let free = ranges.count > 2 + usize::from(heading.is_some());
    let first = descend(chain, ranges, point, heading, seed);
    let mut found: Vec<ArmVector> = first.into_iter().collect();
    if free && !found.is_empty() {
        return found;
    }
    let apart = |one: &ArmVector, other: &ArmVector| {
        let fractions = (0..ranges.count).map(|a| ((one[a] - other[a]) / ranges.half(a)).powi(2));
        fractions.sum::<f64>().sqrt()
    };
    for start in 0..STARTS.pow(ranges.count as u32) {
        let mut rest = start;
        let mut arm_positions = [0.0; 4];
        for (a, arm_positions) in arm_positions.iter_mut().enumerate().take(ranges.count) {
            let fraction = ((rest % STARTS) as f64 + 0.5) / STARTS as f64;
            *arm_positions = ranges.min[a] + fraction * (ranges.max[a] - ranges.min[a]);
            rest /= STARTS;
        }
        let Some(solution) = descend(chain, ranges, point, heading, &arm_positions) else {
            continue;
        };
        if found.iter().all(|known| apart(known, &solution) > SAME_SOLUTION) {
            found.push(solution);
        }
    }
    found.sort_by(|one, other| apart(one, seed).total_cmp(&apart(other, seed)));
    found.truncate(if free { 1 } else { MAX_SOLUTIONS });
    found
}

fn descend(
    chain: &ArmChain,
    ranges: &Ranges,
    point: &Vector2<f64>,
    heading: Option<f64>,
    start: &ArmVector,
) -> Option<ArmVector> {
    let mut arm_positions = *start;
    // One more column than axes, for a heading that is not prescribed.
    let count = ranges.count + 1;
    let mut compliance = [1.0; 5];
    for (a, compliance) in compliance.iter_mut().enumerate().take(ranges.count) {
        *compliance = ranges.half(a).powi(2);
    }
    let size = point.norm()
        + chain.link_vectors().iter().map(|link_vector| link_vector.vector.norm()).sum::<f64>();
    for _ in 0..MAX_ITERATIONS {
        let missing = point - chain.tip(&arm_positions);
        let turn =
            heading.map_or(0.0, |heading| wrap_angle(heading - chain.heading(&arm_positions)));
        if missing.norm() <= 1e-15 * size.max(f64::MIN_POSITIVE) * 8.0 && turn.abs() <= 1e-14 {
            return Some(arm_positions);
        }
        let velocities = chain.tip_velocities(&arm_positions);
        let mut columns = [Vector3::z() * if heading.is_some() { 0.0 } else { 1.0 }; 5];
        for a in 0..ranges.count {
            let turning = if heading.is_some() { chain.heading.1[a] } else { 0.0 };
            columns[a] = velocities[a].push(turning);
        }
        columns[ranges.count] = columns[4];
        let mut step = [0.0; 5];
        let target = missing.push(turn);
        if !least_norm_of_three(
            &columns[..count],
            &compliance[..count],
            &target,
            &mut step[..count],
        ) {
            return None;
        }
        let largest =
            (0..ranges.count).map(|a| (step[a] / ranges.half(a)).abs()).fold(0.0, f64::max);
        let fraction = (2.0 * MAX_STEP / largest).min(1.0);
        for a in 0..ranges.count {
            arm_positions[a] += fraction * step[a];
        }
    }
    let missing = (point - chain.tip(&arm_positions)).norm();
    (missing <= 1e-13 * size).then_some(arm_positions)
}
