//! Uncertainty of a station's frame.

use nalgebra::{Matrix3, Matrix3x6, Matrix6, SymmetricEigen, Vector3};

use super::quantile::{normal_beyond, student};

/// Uncertainty of a station's frame: the covariance of a small displacement of it.
///
/// ```text
///    displacement of a point p of the station  =  t + ω × p        (t, ω): the components, in the station frame
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameUncertainty {
    /// Covariance of the translation of the origin and of the rotation vector, in the station frame (m², m rad, rad²); zero for components that are not known.
    pub covariance: Matrix6<f64>,
    /// Which of the six components have a known uncertainty.
    pub known: [bool; 6],
    /// Degrees of freedom of the noise where it is estimated from the points, the least of all components; `None` where it is given.
    pub degrees_of_freedom: Option<usize>,
}

/// Uncertainty of a station that is stated and not computed from points; each is a standard deviation, for each direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StatedUncertainty {
    /// Of the position across and inward (m).
    pub lateral: Option<f64>,
    /// Of the height (m).
    pub height: Option<f64>,
    /// Of the rotation about the x and about the y axis (rad).
    pub tilt: Option<f64>,
    /// Of the heading (rad).
    pub heading: Option<f64>,
}

impl Default for FrameUncertainty {
    fn default() -> Self {
        Self::UNKNOWN
    }
}

impl FrameUncertainty {
    /// No component is known.
    pub const UNKNOWN: Self = Self {
        covariance: Matrix6::from_array_storage(nalgebra::ArrayStorage([[0.0; 6]; 6])),
        known: [false; 6],
        degrees_of_freedom: None,
    };

    pub(super) fn set_known(&mut self, components: &[usize], freedom: Option<usize>) {
        for &component in components {
            self.known[component] = true;
        }
        self.degrees_of_freedom = match (self.degrees_of_freedom, freedom) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, other) => one.or(other),
        };
    }

    /// Adds stated deviations for the components that are not known.
    #[must_use]
    pub fn or_stated(mut self, stated: &StatedUncertainty) -> Self {
        let StatedUncertainty { lateral, height, tilt, heading } = *stated;
        for (component, deviation) in
            [lateral, lateral, height, tilt, tilt, heading].into_iter().enumerate()
        {
            if let Some(deviation) = deviation.filter(|_| !self.known[component]) {
                self.covariance[(component, component)] = deviation * deviation;
                self.known[component] = true;
            }
        }
        self
    }

    /// Whether any component is known.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.known.contains(&true)
    }

    /// Whether the tilt is known.
    #[must_use]
    pub fn is_tilt_known(&self) -> bool {
        self.known[3] && self.known[4]
    }

    /// Covariance of the displacement of a point of the station (m²); components that are not known count as zero.
    ///
    /// # Arguments
    /// * `point` – in the station frame (m)
    #[must_use]
    pub fn displacement_covariance(&self, point: &Vector3<f64>) -> Matrix3<f64> {
        let mut by_frame = Matrix3x6::zeros();
        by_frame.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
        by_frame.fixed_view_mut::<3, 3>(0, 3).copy_from(&-point.cross_matrix());
        by_frame * self.covariance * by_frame.transpose()
    }

    /// Standard deviation of the displacement of a point in its least certain direction (m).
    #[must_use]
    pub fn largest_deviation(&self, point: &Vector3<f64>) -> f64 {
        largest_deviation(&self.displacement_covariance(point))
    }

    /// Standard deviations of the displacement of a point: in the plane of the station, in the least certain direction, and along its normal (m).
    #[must_use]
    pub fn lateral_and_height(&self, point: &Vector3<f64>) -> [f64; 2] {
        let covariance = self.displacement_covariance(point);
        let [a, b, c] = [covariance[(0, 0)], covariance[(1, 1)], covariance[(0, 1)]];
        [largest_of_two(a, b, c), covariance[(2, 2)].max(0.0).sqrt()]
    }

    /// Standard deviation of the tilt in its least certain direction (rad); `None` where it is not known.
    #[must_use]
    pub fn tilt_deviation(&self) -> Option<f64> {
        let tilt = self.covariance.fixed_view::<2, 2>(3, 3);
        let [a, b, c] = [tilt[(0, 0)], tilt[(1, 1)], tilt[(0, 1)]];
        self.is_tilt_known().then(|| largest_of_two(a, b, c))
    }

    /// Multiple of a standard deviation that contains the same share as a coverage factor does of a normal distribution; larger where the noise is estimated.
    #[must_use]
    pub fn coverage(&self, coverage_factor: f64) -> f64 {
        coverage(coverage_factor, self.degrees_of_freedom)
    }
}

/// Largest standard deviation in any direction, from the variances in two directions and their covariance.
pub(super) fn largest_of_two(a: f64, b: f64, covariance: f64) -> f64 {
    (0.5 * (a + b) + (0.5 * (a - b)).hypot(covariance)).max(0.0).sqrt()
}

/// Largest standard deviation of a covariance in any direction.
#[must_use]
pub(crate) fn largest_deviation(covariance: &Matrix3<f64>) -> f64 {
    SymmetricEigen::new(*covariance).eigenvalues.max().max(0.0).sqrt()
}

/// The coverage factor of Student's t that corresponds to one of a normal distribution.
///
/// # Arguments
/// * `freedom` – degrees of freedom of the estimated deviation; `None` where it is given
#[must_use]
pub fn coverage(coverage_factor: f64, freedom: Option<usize>) -> f64 {
    match freedom {
        None => coverage_factor,
        Some(_) => student(normal_beyond(coverage_factor), freedom),
    }
}
