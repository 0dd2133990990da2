//! Further points that a plane needs, and where they are best.

use nalgebra::{Matrix3, Vector3};

use super::fit_result::FitResult;
use super::plane::{PlaneFit, is_testable};
use super::uncertainty::{coverage, largest_of_two};

/// Largest number of further points that are proposed.
pub const MAX_NEXT_POINTS: usize = 40;

/// Number of directions in which points are tried.
const DIRECTIONS: usize = 72;
/// Relative difference below which two places are equally good: the first of them is proposed.
const EQUAL: f64 = 1e-9;

/// Further points of a plane, in the order of their benefit.
#[derive(Debug, Clone, PartialEq)]
pub struct NextPoints {
    /// The points, in the fitted plane and in the base frame (m).
    pub points: Vec<Vector3<f64>>,
    /// Whether these points suffice; otherwise [`MAX_NEXT_POINTS`] of them do not make the tilt certain enough.
    pub suffices: bool,
    /// Noise at which the present points make the tilt certain enough, for all of them alike (m); `None` where it does not limit them.
    pub noise: Option<f64>,
}

impl PlaneFit {
    /// Further points with which the plane can be judged, and its tilt is certain enough; `None` where nothing is missing, and where the points are inconsistent.
    ///
    /// Each point is the one that adds most to the determinant of the information matrix (D-optimal design): the one where the height of the plane is known least.
    ///
    /// # Arguments
    /// * `allowed` – largest allowed error of the tilt (rad)
    /// * `coverage_factor` – multiple of the standard deviation that has to be allowed
    ///
    /// # Numerics
    /// The variance of the height is convex, so that its maximum over a disc is on the circle; 72 directions are tried.
    ///
    /// # Assumptions
    /// Further points can be measured as far from the centre of the points as the farthest of them, with the noise of the most accurate of them.
    #[must_use]
    pub fn next_points(&self, allowed: f64, coverage_factor: f64) -> Option<NextPoints> {
        let is_certain = !self.is_uncertain(allowed, coverage_factor);
        if self.agreement.result == FitResult::Inconsistent
            || (self.agreement.result == FitResult::Fits && is_certain)
        {
            return None;
        }
        let known = self.agreement.noise.is_some();
        let least = |noise: &Vec<f64>| noise.iter().copied().fold(f64::INFINITY, f64::min);
        let sigma = self.agreement.noise.as_ref().map_or(1.0, least);
        let along = (self.points[0] - self.center).normalize();
        let across = self.normal.cross(&along);
        let coordinates = |point: &Vector3<f64>| {
            let from_center = point - self.center;
            Vector3::new(1.0, from_center.dot(&along), from_center.dot(&across))
        };
        let mut information = Matrix3::zeros();
        let mut radius = 0.0_f64;
        for (k, point) in self.points.iter().enumerate() {
            let row = coordinates(point);
            let noise = self.agreement.noise.as_ref().map_or(1.0, |noise| noise[k]);
            information += row * row.transpose() / (noise * noise);
            radius = radius.max(row.y.hypot(row.z));
        }
        // Where the noise is not known, an estimate from enough points counts; until there is one, that of the new points decides about the tilt.
        let is_estimated = !known && is_testable(false, self.points.len());
        let estimated = self.uncertainty.as_ref().filter(|_| is_estimated).map(|it| it.noise);
        let is_enough = |information: &Matrix3<f64>, points: usize| {
            let tilt = match estimated {
                Some(noise) => {
                    noise * coverage(coverage_factor, Some(points - 3)) * largest_slope(information)
                }
                None if known => coverage_factor * largest_slope(information),
                None => 0.0,
            };
            is_testable(known, points) && tilt <= allowed
        };
        // Less noise alone helps only where the points can be tested.
        let noise = (known
            && is_testable(known, self.points.len())
            && coverage_factor * largest_slope(&information) > allowed)
            .then(|| sigma * allowed / (coverage_factor * largest_slope(&information)));
        let mut points = Vec::new();
        while points.len() < MAX_NEXT_POINTS
            && !is_enough(&information, self.points.len() + points.len())
        {
            let covariance = information.try_inverse()?;
            let candidates = (0..DIRECTIONS).map(|k| {
                let angle = std::f64::consts::TAU * k as f64 / DIRECTIONS as f64;
                let row = Vector3::new(1.0, radius * angle.cos(), radius * angle.sin());
                (row, row.dot(&(covariance * row)))
            });
            let best = candidates.reduce(
                |best, next| {
                    if next.1 > best.1 * (1.0 + EQUAL) { next } else { best }
                },
            );
            let (row, _) = best?;
            information += row * row.transpose() / (sigma * sigma);
            points.push(self.center + along * row.y + across * row.z);
        }
        let suffices = is_enough(&information, self.points.len() + points.len());
        Some(NextPoints { points, suffices, noise })
    }
}

/// Largest standard deviation of the slope in any direction (rad), from the information matrix of height and slopes.
fn largest_slope(information: &Matrix3<f64>) -> f64 {
    let Some(covariance) = information.try_inverse() else { return f64::INFINITY };
    let [a, b, c] = [covariance[(1, 1)], covariance[(2, 2)], covariance[(1, 2)]];
    largest_of_two(a, b, c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::station::teach::fit_plane;

    fn points(places: &[(f64, f64)]) -> Vec<Vector3<f64>> {
        places.iter().map(|&(x, y)| Vector3::new(0.7 + x, y, 0.6)).collect()
    }

    #[test]
    fn proposed_points_make_the_plane_fit() {
        let places = points(&[(0.1, 0.0), (-0.05, 0.08), (-0.05, -0.08)]);
        for (noise, allowed) in [(Some(2e-6), 40e-6), (Some(2e-6), 20e-6), (None, 20e-6)] {
            let all = |points: &[Vector3<f64>]| {
                let noise = noise.map(|noise| vec![noise; points.len()]);
                fit_plane(points, 1e-4, noise.as_deref()).unwrap()
            };
            let next = all(&places).next_points(allowed, 2.0).unwrap();
            assert!(next.suffices && !next.points.is_empty(), "{next:?}");
            let mut more = places.clone();
            more.extend(&next.points);
            assert!(all(&more).next_points(allowed, 2.0).is_none(), "{next:?}");
            // One less does not suffice.
            more.pop();
            assert!(all(&more).next_points(allowed, 2.0).is_some(), "{next:?}");
        }
    }

    #[test]
    fn an_estimated_noise_determines_how_many_points_are_missing() {
        let mut places = points(&[(0.1, 0.0), (0.0, 0.1), (-0.1, 0.0), (0.0, -0.1)]);
        places.extend(points(&[(0.07, 0.07), (-0.07, 0.07), (-0.07, -0.07)]));
        places.iter_mut().enumerate().for_each(|(k, at)| at.z += 4e-6 * (k as f64 * 2.4).sin());
        let fit = fit_plane(&places, 1e-4, None).unwrap();
        let uncertain = fit.uncertainty.as_ref().unwrap().expanded_tilt(2.0);
        let allowed = 0.7 * uncertain;
        assert_eq!(fit.result_for(allowed, 2.0), FitResult::Uncertain);
        let next = fit.next_points(allowed, 2.0).unwrap();
        assert!(next.suffices && !next.points.is_empty() && next.noise.is_none(), "{next:?}");
        // Further points that repeat the noise of the others make the tilt certain enough.
        let noise = fit.uncertainty.as_ref().unwrap().noise;
        places.extend(
            next.points
                .iter()
                .enumerate()
                .map(|(k, at)| at + fit.normal * noise * if k % 2 == 0 { 0.5 } else { -0.5 }),
        );
        let more = fit_plane(&places, 1e-4, None).unwrap();
        assert_eq!(more.result_for(allowed, 2.0), FitResult::Fits);
    }

    #[test]
    fn best_point_is_across_a_narrow_row() {
        // Points along x within 20 mm of one line: the tilt about it is known least, so that the next point is far across.
        let places = points(&[(0.1, 0.02), (0.03, -0.02), (-0.03, 0.02), (-0.1, -0.02)]);
        let fit = fit_plane(&places, 1e-4, Some(&[1e-5; 4])).unwrap();
        let next = fit.next_points(1e-3, 2.0).unwrap();
        let from_center = next.points[0] - fit.center;
        assert!(from_center.y.abs() > 0.09 && from_center.x.abs() < 0.05, "{from_center}");
    }

    #[test]
    fn less_noise_is_no_advice_for_too_few_points() {
        let places = points(&[(0.1, 0.0), (-0.05, 0.08), (-0.05, -0.08)]);
        let fit = fit_plane(&places, 1e-4, Some(&[1e-5; 3])).unwrap();
        let next = fit.next_points(20e-6, 2.0).unwrap();
        assert_eq!(next.noise, None);
        // They stay untested with exact points too.
        let exact = fit_plane(&places, 1e-4, Some(&[1e-12; 3])).unwrap();
        assert_eq!(exact.agreement.result, FitResult::Untested);
    }

    #[test]
    fn noise_that_suffices_is_named_where_points_do_not() {
        let places = points(&[(0.1, 0.0), (0.0, 0.1), (-0.1, 0.0), (0.0, -0.1), (0.07, 0.07)]);
        let fit = fit_plane(&places, 1e-3, Some(&[1e-4; 5])).unwrap();
        let next = fit.next_points(20e-6, 2.0).unwrap();
        assert!(!next.suffices && next.points.len() == MAX_NEXT_POINTS);
        let better = fit_plane(&places, 1e-3, Some(&[next.noise.unwrap() * 0.999; 5])).unwrap();
        assert!(better.next_points(20e-6, 2.0).is_none());
    }
}
