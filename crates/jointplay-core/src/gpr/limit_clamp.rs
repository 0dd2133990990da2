//! Clamping of straight rod motions to the limits.

use super::Gpr;
use crate::float::sqrt;

impl Gpr {
    /// Rods clamped to the limits: the last ones within the limits on the straight motion between two sets of rods (m).
    ///
    /// Rods within the limits make up a convex set: each between two lengths, and the horizontal part of the normal, linear in the rods, within a circle.
    /// So a straight motion leaves it once, at a rod's limit or at the root of a quadratic equation.
    ///
    /// # Arguments
    /// * `from` – (3) rods within the limits (m); from elsewhere, as toward what is no number, nothing moves
    /// * `to` – (3) rods wanted (m); returned to the bit where they are within the limits
    #[must_use]
    pub fn clamp_to_limits(&self, from: &[f64; 3], to: &[f64; 3]) -> [f64; 3] {
        let limits = self.limits();
        let lost = to.iter().any(|length| !length.is_finite());
        if lost || !limits.broken(from, self.plane_tilt(from)).is_empty() {
            return *from;
        }
        if limits.broken(to, self.plane_tilt(to)).is_empty() {
            return *to;
        }
        let mut part: f64 = 1.0;
        for (&start, &end) in from.iter().zip(to) {
            if end < limits.rod_min {
                part = part.min((limits.rod_min - start) / (end - start));
            } else if end > limits.rod_max {
                part = part.min((limits.rod_max - start) / (end - start));
            }
        }
        // |a + t d| = r for the horizontal parts of the normals, their vertical part being the same all along.
        let [start, end] = [from, to].map(|rods| {
            let balls = self.ball_centers(rods);
            (balls[1] - balls[0]).cross(&(balls[2] - balls[0]))
        });
        let (a, d) = (start.xy(), end.xy() - start.xy());
        let r = start.z * libm::tan(limits.tilt_max);
        if end.xy().norm_squared() > r * r {
            let (along, room) = (a.dot(&d), r * r - a.norm_squared());
            let root = sqrt((along * along + d.norm_squared() * room).max(0.0));
            let leaves =
                if along > 0.0 { room / (along + root) } else { (root - along) / d.norm_squared() };
            part = part.min(leaves);
        }
        let part = part.max(0.0);
        [0, 1, 2].map(|k| from[k] + part * (to[k] - from[k]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpr::{AxisHeight, BrokenLimit};
    use crate::spatial::Tilt;

    /// Clamps a motion, and checks both sides of its end.
    #[track_caller]
    fn check(from: [f64; 3], to: [f64; 3], limbs: &[usize], tilted: bool) {
        let gpr = Gpr::paper().without_limit_checks();
        let broken = |rods: &[f64; 3]| gpr.limits().broken(rods, gpr.plane_tilt(rods));
        let last = gpr.clamp_to_limits(&from, &to);
        assert!(broken(&last).is_empty(), "{last:?}");
        let beyond = [0, 1, 2]
            .map(|k| last[k] + 1e-9 * (to[k] - from[k]).signum() * f64::from(to[k] != from[k]));
        let found: Vec<BrokenLimit> = broken(&beyond).iter().collect();
        let rods: Vec<usize> = found
            .iter()
            .filter_map(|limit| match limit {
                BrokenLimit::Rod { limb, .. } => Some(*limb),
                BrokenLimit::Tilt { .. } => None,
            })
            .collect();
        assert_eq!((rods.as_slice(), found.len() > rods.len()), (limbs, tilted), "{beyond:?}");
        // The result is on the straight motion.
        let along = |k: usize| {
            (last[k] - from[k]) * (to[0] - from[0]) - (last[0] - from[0]) * (to[k] - from[k])
        };
        assert!(along(1).abs() < 1e-15 && along(2).abs() < 1e-15);
    }

    #[test]
    fn motions_end_at_the_first_limit() {
        let gpr = Gpr::paper().without_limit_checks();
        let level = [0.5; 3];
        check(level, [0.52, 0.5, 0.5], &[], true);
        check(level, [0.9; 3], &[1, 2, 3], false);
        check(level, [0.1; 3], &[1, 2, 3], false);
        check([0.753, 0.752, 0.752], [0.756, 0.754, 0.754], &[1], false);
        let most = gpr.limits().tilt_max;
        let at = |azimuth, tilt_angle| {
            gpr.inverse(Tilt { azimuth, angle: tilt_angle }, AxisHeight(0.5)).unwrap()
        };
        // From the limit outward nothing moves; along it only up to the end of a chord.
        let (start, end) = (at(0.3, most), at(0.3, 2.0 * most));
        let last = gpr.clamp_to_limits(&start, &end);
        assert!(last.iter().zip(start).all(|(last, start)| (last - start).abs() < 1e-12));
        check(start, at(2.8, 1.7 * most), &[], true);
        check(at(0.3, 0.5 * most), end, &[], true);
    }

    #[test]
    fn rods_within_the_limits_are_reached_and_motions_from_outside_do_not_start() {
        let gpr = Gpr::paper().without_limit_checks();
        let (level, near) = ([0.5; 3], [0.5005, 0.4995, 0.5]);
        assert_eq!(gpr.clamp_to_limits(&level, &near), near);
        assert_eq!(gpr.clamp_to_limits(&[0.9; 3], &level), [0.9; 3]);
        assert_eq!(gpr.clamp_to_limits(&level, &[f64::NAN; 3]), level);
        assert_eq!(gpr.clamp_to_limits(&level, &[f64::INFINITY, 0.5, 0.5]), level);
    }
}
