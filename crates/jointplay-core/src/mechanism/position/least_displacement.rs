//! Rates of the least displacement, where virtual joints have more freedoms than the loops need.
//!
//! Virtual joints are springs and all other joints transmit no force; the loops carry f.
//! Along a motion the forces stay in equilibrium, which determines the freedoms that the loops leave.

use super::closing_geometry::power;
use super::differential::{DifferentialKinematics, Order};
use super::elimination::{factor_symmetric, solve_symmetric};
use super::opening::SideUnknown;
use crate::Error;
use crate::constraint::CLOSURE_TOLERANCE;
use crate::mechanism::kinematics::{bracket, plus, scaled};

/// Curvatures of the size of the virtual displacement up to this share of the largest determine nothing.
const FLAT: f64 = 1e-9;
/// Share of the virtual displacements by which they may miss the least ones.
const LEAST: f64 = 1e-6;

impl DifferentialKinematics {
    /// The forces of the least displacement, and its curvature along the motions that loops and commands leave.
    pub(super) fn least(&mut self, coordinates: &[f64]) -> Result<(), Error> {
        let (unknowns, free) = (self.weights.len(), self.state.free);
        for (j, motion) in self.free[..free * unknowns].chunks_exact_mut(unknowns).enumerate() {
            self.elimination.null_vector(j, &mut self.right, motion);
        }
        for k in 0..unknowns {
            self.load[k] = -self.weights[k] * coordinates[self.coordinates[k]] / self.units[k];
        }
        let size = self.load.iter().map(|load| load * load).sum::<f64>().sqrt();
        for motion in self.free[..free * unknowns].chunks_exact(unknowns) {
            let along: f64 = motion.iter().zip(&self.load).map(|(a, b)| a * b).sum();
            let of_motion = motion.iter().map(|a| a * a).sum::<f64>().sqrt();
            let excess = along.abs() / of_motion;
            let allowed = LEAST * size + CLOSURE_TOLERANCE;
            if excess > allowed {
                return Err(Error::NotLeastDisplacement { excess, allowed });
            }
        }
        self.elimination.multipliers(&self.load, &mut self.multipliers);
        for j in 0..free {
            self.velocity.rates.fill(0.0);
            for k in 0..unknowns {
                self.velocity.rates[k] = self.free[j * unknowns + k] * self.units[k];
            }
            self.spread_velocities();
            self.load_of_velocities();
            for i in 0..free {
                let motion = &self.free[i * unknowns..(i + 1) * unknowns];
                let entry: f64 = motion.iter().zip(&self.load).map(|(a, b)| a * b).sum();
                self.curvature[i * free + j] = entry;
            }
        }
        // Symmetric but for round-off; the factor takes the lower triangle.
        factor_symmetric(&mut self.curvature[..free * free], free, 0.0);
        let pivots = (0..free).map(|k| self.curvature[k * free + k]);
        let largest = pivots.clone().fold(0.0, f64::max);
        self.state.undetermined = pivots.filter(|&pivot| pivot <= FLAT * largest).count();
        Ok(())
    }

    /// (unknowns) W u̇ + Ȧᵀ f for the velocities as spread, into `load`.
    pub(super) fn load_of_velocities(&mut self) {
        let unknowns = self.weights.len();
        for k in 0..unknowns {
            self.load[k] = self.weights[k] * self.velocity.rates[k] / self.units[k];
        }
        for (l, closing) in self.loops.closings.iter().enumerate() {
            let multipliers = &self.multipliers[closing.row..];
            let geometry = &self.geometry[l];
            let wrench = geometry.wrench(multipliers, self.loops.length);
            let rate = geometry.rate(&self.velocity.sides[l]);
            let wrench_rate = rate.wrench(multipliers, self.loops.length);
            for &SideUnknown { column, sense, .. } in &closing.moved_by {
                if column < unknowns {
                    let screw = &self.screws[column];
                    let screw_rate = bracket(&self.velocity.carriers[column], screw);
                    let total = power(&wrench, &screw_rate) + power(&wrench_rate, screw);
                    self.load[column] += sense * self.units[column] * total;
                }
            }
        }
    }

    /// (unknowns) W ü + Äᵀ f + 2 Ȧᵀ ḟ for velocities and accelerations as spread, into `load`.
    pub(super) fn load_of_accelerations(&mut self) {
        let unknowns = self.weights.len();
        for k in 0..unknowns {
            self.load[k] = self.weights[k] * self.acceleration.rates[k] / self.units[k];
        }
        let length = self.loops.length;
        for (l, closing) in self.loops.closings.iter().enumerate() {
            let multipliers = &self.multipliers[closing.row..];
            let rates = &self.multiplier_rates[closing.row..];
            let geometry = &self.geometry[l];
            let rate = geometry.rate(&self.velocity.sides[l]);
            let second =
                geometry.second_rate(&rate, &self.velocity.sides[l], &self.acceleration.sides[l]);
            let wrench = geometry.wrench(multipliers, length);
            let wrench_rate =
                plus(&rate.wrench(multipliers, length), &geometry.wrench(rates, length));
            let wrench_second = plus(
                &second.wrench(multipliers, length),
                &scaled(&rate.wrench(rates, length), 2.0),
            );
            for &SideUnknown { column, sense, .. } in &closing.moved_by {
                if column < unknowns {
                    let screw = &self.screws[column];
                    let screw_rate = &self.screw_rates[column];
                    let screw_second = plus(
                        &bracket(&self.acceleration.carriers[column], screw),
                        &bracket(&self.velocity.carriers[column], screw_rate),
                    );
                    let total = power(&wrench, &screw_second)
                        + 2.0 * power(&wrench_rate, screw_rate)
                        + power(&wrench_second, screw);
                    self.load[column] += sense * self.units[column] * total;
                }
            }
        }
    }

    /// Adds the free motions that keep the displacement the least, for the `load` of the rates without them.
    pub(super) fn correct(&mut self, order: Order) {
        let (unknowns, free) = (self.weights.len(), self.state.free);
        let field = match order {
            Order::First => &mut self.velocity,
            Order::Second => &mut self.acceleration,
        };
        let along_free = &mut self.along_free[..free];
        for (along, motion) in along_free.iter_mut().zip(self.free.chunks_exact(unknowns)) {
            *along = -motion.iter().zip(&self.load).map(|(a, b)| a * b).sum::<f64>();
        }
        solve_symmetric(&self.curvature[..free * free], along_free);
        for (&along, motion) in along_free.iter().zip(self.free.chunks_exact(unknowns)) {
            for (k, part) in motion.iter().enumerate() {
                field.rates[k] += along * part * self.units[k];
            }
        }
    }
}
