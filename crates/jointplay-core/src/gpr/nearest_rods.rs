//! The nearest rods within the limits.

use nalgebra::{Matrix2, SMatrix, SymmetricEigen, Vector2, Vector3};

use super::{BrokenLimits, Gpr};

/// The rods within the limits that are nearest to wanted ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestRods {
    /// The rods (m).
    pub rods: [f64; 3],
    /// The limits that the rods are at and that keep them from the wanted ones, with the wanted value where it is beyond the limit; empty if the wanted rods are within the limits.
    pub held_by: BrokenLimits,
}

/// Relative distance from a limit at which rods or tilt are at it.
const AT_LIMIT: f64 = 1e-9;
/// Number of bisections, after which the interval of a multiplier is two neighbouring numbers.
const BISECTIONS: usize = 2100;

impl Gpr {
    /// The rods within the limits with the least distance from wanted ones: where a rod is driven beyond a limit, the robot moves along it.
    ///
    /// ```text
    ///    min ‖q − q_wanted‖   with   q_min ≤ q_k ≤ q_max,   ‖G q‖ ≤ tan α_max
    ///                                G: (2,3) slope of the plane through the balls by the rods
    /// ```
    ///
    /// Rods within the limits make up a convex set, so that there is one nearest point.
    ///
    /// # Arguments
    /// * `wanted` – (3) lengths q_k (m)
    ///
    /// # Returns
    /// `None` for numbers that are not finite, and if no rods are within the limits.
    ///
    /// # Numerics
    /// All 27 choices of rods at their limits are compared; with the tilt at its limit, its multiplier is found by bisection.
    ///
    /// # Source
    /// Own derivation, by the conditions of Karush, Kuhn and Tucker
    #[must_use]
    pub fn nearest_rods(&self, wanted: &[f64; 3]) -> Option<NearestRods> {
        if wanted.iter().any(|length| !length.is_finite()) {
            return None;
        }
        let limits = self.limits();
        let beyond = limits.broken(wanted, self.plane_tilt(wanted));
        if beyond.is_empty() {
            return Some(NearestRods { rods: *wanted, held_by: beyond });
        }
        let slope = self.slope_by_rods();
        let largest = libm::tan(limits.tilt_max);
        let bounds = [limits.rod_min, limits.rod_max];
        let mut best: Option<(f64, [f64; 3])> = None;
        // Each rod is free, or at one of its limits.
        for choice in 0..27_usize {
            let fixed = [choice % 3, choice / 3 % 3, choice / 9]
                .map(|state| (state > 0).then(|| bounds[state - 1]));
            let Some(rods) = nearest_with(&slope, largest, wanted, fixed) else { continue };
            let slack = 1e-13 * limits.rod_max.abs().max(limits.rod_min.abs());
            let within =
                |length: f64| (limits.rod_min - slack..=limits.rod_max + slack).contains(&length);
            if !rods.into_iter().all(within) {
                continue;
            }
            let rods = rods.map(|length| length.clamp(limits.rod_min, limits.rod_max));
            if !limits.broken(&rods, self.plane_tilt(&rods)).is_empty() {
                continue;
            }
            let distance = (Vector3::from(rods) - Vector3::from(*wanted)).norm_squared();
            if best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, rods));
            }
        }
        let (_, rods) = best?;
        let span = limits.rod_max - limits.rod_min;
        let at = [0, 1, 2].map(|k| {
            let room = (rods[k] - limits.rod_min).min(limits.rod_max - rods[k]);
            room <= AT_LIMIT * span && rods[k].to_bits() != wanted[k].to_bits()
        });
        let tilted = self.plane_tilt(&rods).angle >= limits.tilt_max * (1.0 - AT_LIMIT);
        let reported = [0, 1, 2].map(|k| if beyond.rods()[k] { wanted[k] } else { rods[k] });
        let tilt = if beyond.tilt() { self.plane_tilt(wanted) } else { self.plane_tilt(&rods) };
        let held_by = BrokenLimits::at(*limits, reported, tilt, [at[0], at[1], at[2], tilted]);
        Some(NearestRods { rods, held_by })
    }

    /// Slope of the plane through the balls, linear in the rods (1/m).
    fn slope_by_rods(&self) -> SMatrix<f64, 2, 3> {
        let normal = |rods: [f64; 3]| {
            let balls = self.ball_centers(&rods);
            (balls[1] - balls[0]).cross(&(balls[2] - balls[0]))
        };
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|unit| {
            let normal = normal(unit);
            normal.xy() / normal.z
        });
        SMatrix::from_columns(&columns)
    }
}

/// The nearest rods with some of them fixed and the slope within a circle; `None` if there are none.
fn nearest_with(
    slope: &SMatrix<f64, 2, 3>,
    largest: f64,
    wanted: &[f64; 3],
    fixed: [Option<f64>; 3],
) -> Option<[f64; 3]> {
    let start = Vector3::from([0, 1, 2].map(|k| fixed[k].unwrap_or(wanted[k])));
    let mut free = *slope;
    for (mut column, fixed) in free.column_iter_mut().zip(fixed) {
        if fixed.is_some() {
            column.fill(0.0);
        }
    }
    let at_start: Vector2<f64> = slope * start;
    if at_start.norm() <= largest {
        return Some(start.into());
    }
    // y = G q satisfies (1 + λ F Fᵀ) y = G q_start with the columns F of free rods, and ‖y‖ = tan α_max.
    let eigen = SymmetricEigen::new(Matrix2::from(free * free.transpose()));
    let parts = eigen.eigenvectors.transpose() * at_start;
    let slope_at = |multiplier: f64| {
        let scaled = parts
            .zip_map(&eigen.eigenvalues, |part, value| part / (1.0 + multiplier * value.max(0.0)));
        eigen.eigenvectors * scaled
    };
    let mut low = 0.0;
    let mut high = 1.0;
    // Where fixed rods alone tilt the platform too far, no multiplier is large enough.
    while slope_at(high).norm() > largest {
        low = high;
        high *= 2.0;
        if !f64::is_finite(high) {
            return None;
        }
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if slope_at(middle).norm() > largest { low = middle } else { high = middle }
    }
    Some((start - high * (free.transpose() * slope_at(high))).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpr::{AxisHeight, BrokenLimit, Limb, Limits};
    use crate::random::Random;
    use crate::spatial::Tilt;

    /// Robots of other shapes: equilateral, right-angled with rods away from their sockets, narrow.
    fn robots() -> Vec<Gpr> {
        let limb = |radius, angle_deg: f64| Limb::under_socket(radius, angle_deg.to_radians());
        let moved = |mut limb: Limb, x: f64, y: f64| {
            limb.base_point += Vector2::new(x, y);
            limb
        };
        let limits = Limits { rod_min: 0.4, rod_max: 0.42, tilt_max: 0.05 };
        let square = [
            moved(limb(0.1, 0.0), 0.003, 0.001),
            limb(0.12, 90.0),
            moved(limb(0.1, 225.0), -0.002, 0.004),
        ];
        let narrow = [limb(0.05, 10.0), limb(0.2, 170.0), limb(0.2, 190.0)];
        vec![
            Gpr::paper().without_limit_checks(),
            Gpr::new(square, limits, 0.41).unwrap().without_limit_checks(),
            Gpr::new(narrow, limits, 0.41).unwrap().without_limit_checks(),
        ]
    }

    /// No rods within the limits are nearer: the angle between the displacement back and that to any of them is obtuse.
    #[test]
    fn the_nearest_rods_satisfy_the_variational_inequality() {
        for gpr in robots() {
            let limits = gpr.limits();
            let broken = |rods: &[f64; 3]| gpr.limits().broken(rods, gpr.plane_tilt(rods));
            let middle = 0.5 * (limits.rod_min + limits.rod_max);
            let reach = 0.7 * (limits.rod_max - limits.rod_min);
            let mut random = Random(7);
            let mut point = |scale: f64| [(); 3].map(|()| middle + scale * random.next());
            let inside: Vec<[f64; 3]> = (0..4000)
                .map(|k| {
                    // Close to level, else hardly any are within the tilt limit.
                    let height = point(reach)[0];
                    point(reach * 0.05 * f64::from(k % 8)).map(|length| height + length - middle)
                })
                .filter(|rods| broken(rods).is_empty())
                .collect();
            assert!(inside.len() > 100);
            let mut held = [0; 4];
            for _ in 0..300 {
                let wanted = point(1.5 * reach);
                let found = gpr.nearest_rods(&wanted).unwrap();
                assert!(broken(&found.rods).is_empty(), "{wanted:?} {found:?}");
                let back = Vector3::from(wanted) - Vector3::from(found.rods);
                for other in &inside {
                    let product = back.dot(&(Vector3::from(*other) - Vector3::from(found.rods)));
                    assert!(product <= 1e-12, "{wanted:?} {found:?} {other:?}: {product}");
                }
                assert_eq!(found.held_by.is_empty(), broken(&wanted).is_empty());
                let [q_1, q_2, q_3] = found.held_by.rods();
                for (count, is_held) in held.iter_mut().zip([q_1, q_2, q_3, found.held_by.tilt()]) {
                    *count += usize::from(is_held);
                }
                // It is its own nearest point, and the same for any order of evaluation.
                let again = gpr.nearest_rods(&found.rods).unwrap();
                assert_eq!(again.rods, found.rods);
                assert!(again.held_by.is_empty());
            }
            assert!(held.iter().all(|&count| count > 10), "{held:?}");
        }
    }

    #[test]
    fn a_single_rod_slides_along_the_tilt_limit() {
        let gpr = Gpr::paper().without_limit_checks();
        let mut before = 0.0;
        for step in 1..20 {
            let wanted = [0.5 + 0.002 * f64::from(step), 0.5, 0.5];
            let found = gpr.nearest_rods(&wanted).unwrap();
            // Equilateral: the mean of the rods is kept, and their differences are reduced in proportion.
            let mean = wanted.iter().sum::<f64>() / 3.0;
            assert!((found.rods.iter().sum::<f64>() / 3.0 - mean).abs() < 1e-14);
            assert!((found.rods[1] - found.rods[2]).abs() < 1e-14);
            assert!(found.rods[0] > before);
            before = found.rods[0];
            let tilt = gpr.plane_tilt(&found.rods);
            if found.held_by.is_empty() {
                assert_eq!(found.rods, wanted);
            } else {
                assert!((tilt.angle - gpr.limits().tilt_max).abs() < 1e-13);
                let held: Vec<BrokenLimit> = found.held_by.iter().collect();
                let asked = gpr.plane_tilt(&wanted).angle;
                assert_eq!(held, [BrokenLimit::Tilt { angle: asked, max: gpr.limits().tilt_max }]);
            }
        }
    }

    #[test]
    fn a_rod_at_its_limit_is_named_and_numbers_that_are_none_have_no_nearest() {
        let gpr = Gpr::paper().without_limit_checks();
        let found = gpr.nearest_rods(&[0.76, 0.753, 0.753]).unwrap();
        assert_eq!(found.rods, [0.754, 0.753, 0.753]);
        let held: Vec<BrokenLimit> = found.held_by.iter().collect();
        assert_eq!(held, [BrokenLimit::Rod { limb: 1, length: 0.76, min: 0.246, max: 0.754 }]);
        let far = gpr.nearest_rods(&[1e6, -1e6, 0.0]).unwrap();
        let rods = gpr.inverse(Tilt::LEVEL, AxisHeight(0.5)).unwrap();
        assert!(far.rods.iter().zip(rods).all(|(far, level)| (far - level).abs() < 0.3));
        for strange in [f64::NAN, f64::INFINITY] {
            assert!(gpr.nearest_rods(&[0.5, strange, 0.5]).is_none());
        }
    }
}
