//! A barrier function with poles at the limits of its terms, and its minimization.

use std::array::from_fn;

use nalgebra::Vector2;

/// Fraction of a range beyond which the cost is continued as a parabola, so that it is finite beyond the limit.
const CONTINUED_FROM: f64 = 0.9999;

/// Largest number of axes; unused ones count as centred in their range and cost 1.
pub(super) const AXES: usize = 4;

/// Largest number of barriers at the singular positions of an arm.
pub(super) const MAX_BARRIERS: usize = 2;

/// Largest number of Newton steps; two to four are usual, ten for a start at a distance of 10⁻⁴ from a pole.
const MAX_ITERATIONS: usize = 30;

/// Fraction of both the total gain and the cost below which a step is the last: convergence is quadratic, and the gain of the next step would be about the square of this fraction.
const LAST_STEP_GAIN: f64 = 0.01;

/// Fraction of the cost below which a gain ends the descent.
pub(super) const RELATIVE_TOLERANCE: f64 = 2e-9;

/// One number for each axis.
pub(super) type PerAxis = [f64; AXES];

/// Cost 1/(1 − u²) of axes from −1 at one limit to 1 at the other, continued as a parabola beyond; with slopes and curvatures.
#[inline]
pub(super) fn of_limits(u: &PerAxis) -> [PerAxis; 3] {
    let within: PerAxis = from_fn(|a| u[a].clamp(-CONTINUED_FROM, CONTINUED_FROM));
    let beyond: PerAxis = from_fn(|a| u[a] - within[a]);
    let cost: PerAxis = from_fn(|a| 1.0 / (1.0 - within[a] * within[a]));
    let slope: PerAxis = from_fn(|a| 2.0 * within[a] * cost[a] * cost[a]);
    let curvature: PerAxis =
        from_fn(|a| (2.0 + 6.0 * within[a] * within[a]) * (cost[a] * cost[a]) * cost[a]);
    [
        from_fn(|a| cost[a] + (slope[a] + 0.5 * curvature[a] * beyond[a]) * beyond[a]),
        from_fn(|a| slope[a] + curvature[a] * beyond[a]),
        curvature,
    ]
}

/// Cost near a singular position: the stretched or folded elbow, or the reach at which a radial arm changes its direction.
#[derive(Debug, Clone, Copy)]
pub(super) enum EndBarrier {
    /// No cost: the arm has no such position.
    None,
    /// 1/(1 − u²), infinite beyond ±1.
    Elbow,
    /// k²/u² of a positive number, infinite beyond 0.
    Reach(f64),
}

impl EndBarrier {
    /// Cost with slope and curvature.
    #[inline]
    pub(super) fn cost_and_derivatives(self, u: f64) -> [f64; 3] {
        match self {
            Self::None => [0.0; 3],
            Self::Elbow if u.abs() < 1.0 => {
                let cost = 1.0 / (1.0 - u * u);
                let square = cost * cost;
                [cost, 2.0 * u * square, (2.0 + 6.0 * u * u) * square * cost]
            }
            Self::Reach(k) if u > 0.0 => {
                let by = 1.0 / u;
                let cost = k * k * by * by;
                [cost, -2.0 * cost * by, 6.0 * cost * by * by]
            }
            Self::Elbow | Self::Reach(_) => [f64::INFINITY; 3],
        }
    }
}

/// Second-order model of several numbers in two unknowns.
#[derive(Debug, Clone, Copy)]
pub(super) struct QuadraticModel<const N: usize> {
    pub(super) values: [f64; N],
    pub(super) slopes: [[f64; N]; 2],
    /// Second derivatives: by the first unknown, by both, by the second.
    pub(super) curvatures: [[f64; N]; 3],
}

impl<const N: usize> QuadraticModel<N> {
    /// Values and slopes after a step.
    #[inline]
    fn values_and_slopes(&self, x: &Vector2<f64>) -> ([f64; N], [[f64; N]; 2]) {
        let [one, both, other] = &self.curvatures;
        let [first, second] = &self.slopes;
        let by_first: [f64; N] = from_fn(|t| first[t] + (one[t] * x[0] + both[t] * x[1]));
        let by_second: [f64; N] = from_fn(|t| second[t] + (both[t] * x[0] + other[t] * x[1]));
        let values = from_fn(|t| {
            let twice = (first[t] + by_first[t]) * x[0] + (second[t] + by_second[t]) * x[1];
            self.values[t] + 0.5 * twice
        });
        (values, [by_first, by_second])
    }
}

/// Second-order model of the cost.
pub(super) struct Model {
    pub(super) limits: QuadraticModel<AXES>,
    pub(super) ends: QuadraticModel<MAX_BARRIERS>,
    pub(super) poles: [EndBarrier; MAX_BARRIERS],
    /// Whether each unknown is free.
    pub(super) free: [bool; 2],
}

/// Cost with its derivatives.
#[derive(Default)]
struct Local {
    cost: f64,
    slope: [f64; 2],
    curvature: [f64; 3],
}

/// A step, and its gain.
pub(super) struct DescentStep {
    pub(super) step: Vector2<f64>,
    pub(super) gain: f64,
}

impl Local {
    #[inline]
    fn add<const N: usize>(
        &mut self,
        bent: &QuadraticModel<N>,
        [first, second]: &[[f64; N]; 2],
        [costs, rising, curving]: &[[f64; N]; 3],
        fraction: f64,
    ) {
        let sum = |of: [f64; N]| of.iter().sum::<f64>();
        let [one, both, other] = &bent.curvatures;
        self.cost += sum(*costs);
        self.slope[0] += sum(from_fn(|t| first[t] * rising[t]));
        self.slope[1] += sum(from_fn(|t| second[t] * rising[t]));
        let rising: [f64; N] = from_fn(|t| rising[t] * fraction);
        self.curvature[0] +=
            sum(from_fn(|t| first[t] * first[t] * curving[t] + one[t] * rising[t]));
        self.curvature[1] +=
            sum(from_fn(|t| first[t] * second[t] * curving[t] + both[t] * rising[t]));
        self.curvature[2] +=
            sum(from_fn(|t| second[t] * second[t] * curving[t] + other[t] * rising[t]));
    }

    /// Newton's step and its gain; `None` where it would lead uphill.
    #[inline]
    fn step(&self) -> Option<DescentStep> {
        let [one, both, other] = self.curvature;
        let determinant = one * other - both * both;
        let is_bowl = one > 0.0 && determinant > 0.0;
        let [x, y] = self.slope;
        let step = Vector2::new(both * y - other * x, both * x - one * y) / determinant;
        let decrement = -(x * step[0] + y * step[1]);
        let fraction = 1.0 - 1.5 * decrement / (self.cost - (AXES as f64 - 1.0));
        // Beyond a limit the parabola is exact: no transformation is needed.
        let longer = if fraction > 0.2 && fraction < 1.0 { 1.0 / fraction } else { 1.0 };
        is_bowl.then_some(DescentStep { step: step * longer, gain: 0.5 * decrement })
    }
}

impl Model {
    /// # Arguments
    /// * `fraction` – 1, or 0 to neglect the curvature of the numbers: the remaining curvature of the cost is never negative
    #[inline]
    fn at(&self, x: &Vector2<f64>, fraction: f64) -> Local {
        let mut local = Local::default();
        let (numbers, along) = self.limits.values_and_slopes(x);
        local.add(&self.limits, &along, &of_limits(&numbers), fraction);
        let (numbers, along) = self.ends.values_and_slopes(x);
        let [one, other]: [[f64; 3]; MAX_BARRIERS] =
            from_fn(|t| self.poles[t].cost_and_derivatives(numbers[t]));
        local.add(&self.ends, &along, &from_fn(|k| [one[k], other[k]]), fraction);
        for (k, free) in self.free.into_iter().enumerate() {
            if !free {
                local.curvature[2 * k] = 1.0;
            }
        }
        local
    }

    /// The step to the least cost near the present point, within a box around it.
    ///
    /// Newton's method on −(cost − c)^(−1/2), c the least cost of all other axes: near its pole a term is linear in this scale, where steps for the cost itself would only halve the distance.
    pub(super) fn least(&self, radius: f64) -> Option<DescentStep> {
        let mut x = Vector2::zeros();
        let mut here = self.at(&x, 1.0);
        let start = here.cost;
        for _ in 0..MAX_ITERATIONS {
            let DescentStep { step, gain } = here.step().or_else(|| self.at(&x, 0.0).step())?;
            let gained = start - here.cost;
            let mut fraction = room(&x, &step, radius);
            if gain
                <= f64::max(LAST_STEP_GAIN * gained.min(here.cost), RELATIVE_TOLERANCE * here.cost)
            {
                return Some(DescentStep {
                    step: x + step * fraction,
                    gain: gained + gain * fraction,
                });
            }
            let next = loop {
                let to = x + step * fraction;
                let there = self.at(&to, 1.0);
                if there.cost < here.cost {
                    break Some((to, there));
                }
                fraction *= 0.25;
                if fraction < 1e-5 {
                    break None;
                }
            };
            let Some((to, there)) = next else { break };
            (x, here) = (to, there);
        }
        Some(DescentStep { step: x, gain: start - here.cost })
    }
}

/// Fraction of a step that stays within a box.
#[inline]
fn room(x: &Vector2<f64>, step: &Vector2<f64>, radius: f64) -> f64 {
    let mut fraction = 1.0_f64;
    for (x, step) in x.iter().zip(step.iter()) {
        let room = radius - x * step.signum();
        if step.abs() * fraction > room {
            fraction = (room / step.abs()).max(0.0);
        }
    }
    fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(values: PerAxis) -> Model {
        let slopes = [[0.9, -0.4, 0.3, 0.0], [0.1, 0.8, -0.5, 0.2]];
        let curvatures = [[0.2, -0.1, 0.3, 0.1], [0.05, 0.1, -0.2, 0.1], [-0.1, 0.2, 0.1, 0.0]];
        let ends = QuadraticModel {
            values: [0.3, 0.8],
            slopes: [[-0.6, 0.2], [0.4, 0.3]],
            curvatures: [[0.3, 0.1], [-0.2, 0.0], [0.1, -0.1]],
        };
        let poles = [EndBarrier::Elbow, EndBarrier::Reach(0.3)];
        Model {
            limits: QuadraticModel { values, slopes, curvatures },
            ends,
            poles,
            free: [true; 2],
        }
    }

    #[test]
    fn barrier_derivatives_agree_with_differences() {
        let step = 1e-5;
        for values in [[0.1, -0.3, 0.6, -0.8], [0.1, 1.2, 0.6, -1.1]] {
            let model = limits(values);
            let x = Vector2::new(0.03, -0.05);
            let here = model.at(&x, 1.0);
            for (k, along) in [Vector2::x() * step, Vector2::y() * step].into_iter().enumerate() {
                let (before, after) = (model.at(&(x - along), 1.0), model.at(&(x + along), 1.0));
                let slope = (after.cost - before.cost) / (2.0 * step);
                assert!((slope - here.slope[k]).abs() <= 1e-6 * here.slope[k].abs());
                let curvature = (after.slope[k] - before.slope[k]) / (2.0 * step);
                assert!((curvature - here.curvature[2 * k]).abs() <= 1e-6 * here.curvature[2 * k]);
                let mixed = (after.slope[1 - k] - before.slope[1 - k]) / (2.0 * step);
                assert!((mixed - here.curvature[1]).abs() <= 1e-6 * here.curvature[2 * k]);
            }
        }
    }

    #[test]
    fn minimization_converges_on_both_sides_of_a_pole() {
        for values in [[0.1, -0.3, 0.6, -0.8], [0.9999, 0.2, 0.6, 0.1], [1.3, 0.2, -0.4, 0.1]] {
            let model = limits(values);
            let found = model.least(1.0).unwrap();
            let there = model.at(&found.step, 1.0);
            let start = model.at(&Vector2::zeros(), 1.0).cost;
            let stated = start - found.gain;
            assert!(
                (stated - there.cost).abs() <= LAST_STEP_GAIN * there.cost,
                "{stated} {}",
                there.cost
            );
            // The remaining gain is a small part of the total gain.
            let left = there.step().unwrap().gain;
            assert!(
                left <= LAST_STEP_GAIN * found.gain.min(there.cost),
                "{left:e} {:e}",
                found.gain
            );
            // In a box that is too small, the step ends on its boundary.
            let near = model.least(0.01).unwrap();
            assert!((near.step.amax() - 0.01).abs() <= 1e-12 && near.gain > 0.0);
        }
        let mut held = limits([0.5, 0.0, 0.0, 0.0]);
        held.free[1] = false;
        (held.limits.slopes[1], held.ends.slopes[1]) = ([0.0; AXES], [0.0; MAX_BARRIERS]);
        for k in [1, 2] {
            (held.limits.curvatures[k], held.ends.curvatures[k]) =
                ([0.0; AXES], [0.0; MAX_BARRIERS]);
        }
        assert_eq!(held.least(1.0).unwrap().step[1], 0.0);
    }
}
