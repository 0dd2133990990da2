//! Equations of an opened loop between velocities, and their derivatives.

use nalgebra::Vector3;

use super::opening::{Closing, Meeting};
use crate::mechanism::joint::Twist;

/// No motion.
pub(super) const STILL: Twist = (Vector3::new(0.0, 0.0, 0.0), Vector3::new(0.0, 0.0, 0.0));

/// Where the two sides of a loop meet, or a derivative of it.
///
/// ```text
///    velocities:  L t  =  ( v + ω × a,  b_i · ω )        for the relative twist t = (ω, v) at the reference point
///    wrenches:    Lᵀ f =  ( a × F + Σ m_i b_i,  F )      (moment, force) at the reference point, f = (F, m_i)
/// ```
#[derive(Debug, Clone, Copy)]
pub(super) struct ClosingGeometry {
    /// a: from the reference point to the meeting point (m).
    arm: Vector3<f64>,
    /// b: directions about which the sides do not turn against each other.
    axes: [Vector3<f64>; 3],
    /// Number of these directions.
    count: usize,
    /// Whether they turn with the second side.
    turning: bool,
    /// 1, or 0 for a derivative: v does not depend on the geometry.
    of_linear: f64,
}

impl ClosingGeometry {
    pub(super) fn of(closing: &Closing, reference: &Vector3<f64>) -> Self {
        let second = &closing.frames[1];
        let x = second.axis(0);
        let y = second.axis(1);
        let base = [Vector3::x(), Vector3::y(), Vector3::z()];
        let (axes, count, turning) = match closing.meeting {
            Meeting::Points(_) => (base, 0, false),
            Meeting::Axes(_) => ([x, y, Vector3::zeros()], 2, true),
            Meeting::Frames => (base, 3, false),
        };
        let arm = closing.frames[0].origin() - reference;
        Self { arm, axes, count, turning, of_linear: 1.0 }
    }

    /// How the geometry changes with the motions of the sides.
    pub(super) fn rate(&self, sides: &[Twist; 2]) -> Self {
        let [(angular, linear), (turn, _)] = sides;
        let turn = if self.turning { *turn } else { Vector3::zeros() };
        Self {
            arm: linear + angular.cross(&self.arm),
            axes: self.axes.map(|axis| turn.cross(&axis)),
            of_linear: 0.0,
            ..*self
        }
    }

    /// How the rate changes, for velocities of the sides and their accelerations.
    pub(super) fn second_rate(
        &self,
        rate: &Self,
        velocities: &[Twist; 2],
        accelerations: &[Twist; 2],
    ) -> Self {
        let by_acceleration = self.rate(accelerations);
        let turn = if self.turning { velocities[1].0 } else { Vector3::zeros() };
        let mut second = by_acceleration;
        second.arm += velocities[0].0.cross(&rate.arm);
        for (axis, rate) in second.axes.iter_mut().zip(&rate.axes) {
            *axis += turn.cross(rate);
        }
        second
    }

    /// L t, lengths in units of `length`, added to `entries` with a factor.
    #[inline]
    pub(super) fn add(
        &self,
        (angular, linear): &Twist,
        length: f64,
        factor: f64,
        entries: &mut [f64],
    ) {
        let at_point = (linear * self.of_linear + angular.cross(&self.arm)) * (factor / length);
        for (entry, value) in entries.iter_mut().zip(at_point.iter()) {
            *entry += value;
        }
        for (entry, axis) in entries[3..].iter_mut().zip(&self.axes[..self.count]) {
            *entry += axis.dot(angular) * factor;
        }
    }

    /// Lᵀ f: the wrench (moment, force) of multipliers at the reference point.
    #[inline]
    pub(super) fn wrench(&self, multipliers: &[f64], length: f64) -> Twist {
        let force = Vector3::new(multipliers[0], multipliers[1], multipliers[2]) / length;
        let mut moment = self.arm.cross(&force);
        for (axis, size) in self.axes[..self.count].iter().zip(&multipliers[3..]) {
            moment += axis * *size;
        }
        (moment, force * self.of_linear)
    }
}

/// Power of a wrench (moment, force) on a twist (angular, linear).
#[inline]
pub(super) fn power(wrench: &Twist, twist: &Twist) -> f64 {
    wrench.0.dot(&twist.0) + wrench.1.dot(&twist.1)
}
