//! Frames of stations from a taught plane and taught reference points.

use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Matrix6, Vector3};

use super::carrier_axis::CarrierAxis;
use super::frame::frame;
use super::plane::PlaneFit;
use super::references::ReferenceFit;
use super::uncertainty::FrameUncertainty;

/// Position, heading and normal of a station from its drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NominalFrame {
    /// Position of the lowest wafer, in the base frame (m).
    pub origin: Vector3<f64>,
    /// Heading: rotation about the vertical, before the tilt (rad).
    pub heading: f64,
    /// Unit normal, in the base frame.
    pub normal: Vector3<f64>,
}

/// Taught parts of a station's frame; the others are nominal.
#[derive(Debug, Clone, PartialEq)]
pub struct TaughtFrame {
    /// Tilt and height.
    pub plane: Option<PlaneFit>,
    /// Centre and heading.
    pub references: Option<ReferenceFit>,
}

impl NominalFrame {
    /// The nominal frame, laid into a taught plane if there is one.
    #[must_use]
    pub fn in_plane(&self, plane: Option<&PlaneFit>) -> Pose {
        match plane {
            Some(plane) => plane.frame(&self.origin, self.heading),
            None => frame(self.origin, &self.normal, self.heading),
        }
    }
}

impl TaughtFrame {
    /// Frame of the station.
    #[must_use]
    pub fn frame(&self, nominal: &NominalFrame) -> Pose {
        let in_plane = nominal.in_plane(self.plane.as_ref());
        let Some(references) = &self.references else { return in_plane };
        let origin = in_plane * nalgebra::Point3::from(references.shift.push(0.0));
        let normal = in_plane.rotation * Vector3::z();
        frame(origin.coords, &normal, nominal.heading + references.turn.unwrap_or(0.0))
    }

    /// Uncertainty of the frame.
    ///
    /// # Arguments
    /// * `base_from_station` – [`Self::frame`]
    #[must_use]
    pub fn uncertainty(&self, base_from_station: &Pose) -> FrameUncertainty {
        let mut found = FrameUncertainty::UNKNOWN;
        let mut tilt = Matrix3::zeros();
        if let Some(known) = self.plane.as_ref().and_then(|plane| plane.uncertainty.as_deref()) {
            // Height at the centre of the points, and slopes along both directions, to height of the origin and rotation vector.
            let lever = known.lever(&base_from_station.translation.vector);
            let mut by_fit = Matrix3::zeros();
            by_fit[(0, 0)] = 1.0;
            for (k, direction) in known.directions.iter().enumerate() {
                let along = base_from_station.rotation.inverse() * direction;
                by_fit[(0, k + 1)] = lever[k];
                by_fit[(1, k + 1)] = along.y;
                by_fit[(2, k + 1)] = -along.x;
            }
            let [first, second] = known.slopes;
            let variances = Vector3::new(known.height, first, second).map(|one| one * one);
            tilt = by_fit * Matrix3::from_diagonal(&variances) * by_fit.transpose();
            found.set_known(&[2, 3, 4], known.degrees_of_freedom);
        }
        let place = |covariance: &mut Matrix6<f64>, i: usize, j: usize, value: f64| {
            covariance[(i, j)] += value;
        };
        for i in 0..3 {
            for j in 0..3 {
                place(&mut found.covariance, i + 2, j + 2, tilt[(i, j)]);
            }
        }
        if let Some(fit) = &self.references
            && let Some(known) = &fit.uncertainty
        {
            // Errors of the centroid and of the heading, then those by the plane: the shift turns about the centroid.
            let around = Vector3::new(known.nominal_center.y, -known.nominal_center.x, 1.0);
            let own = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)) * known.center.powi(2)
                + around * around.transpose() * known.turn.powi(2);
            let by_tilt = nalgebra::Matrix3x2::from_fn(|row, axis| match row {
                2 => known.turn_by_tilt[axis],
                row => known.shift_by_tilt[axis][row],
            });
            let rotation = tilt.fixed_view::<2, 2>(1, 1).into_owned();
            let lateral = own + by_tilt * rotation * by_tilt.transpose();
            let with_plane = by_tilt * tilt.fixed_view::<2, 3>(1, 0);
            let rows = [0, 1, 5];
            for (i, &row) in rows.iter().enumerate() {
                for (j, &column) in rows.iter().enumerate() {
                    place(&mut found.covariance, row, column, lateral[(i, j)]);
                }
                for j in 0..3 {
                    place(&mut found.covariance, row, j + 2, with_plane[(i, j)]);
                    place(&mut found.covariance, j + 2, row, with_plane[(i, j)]);
                }
            }
            let known_rows: &[usize] = if fit.turn.is_some() { &rows } else { &rows[..2] };
            found.set_known(known_rows, known.degrees_of_freedom);
        }
        found
    }
}

impl CarrierAxis {
    /// Uncertainty of a station's frame from its first and last slot.
    #[must_use]
    pub fn uncertainty(&self) -> FrameUncertainty {
        let mut found = FrameUncertainty::UNKNOWN;
        let Some(noise) = self.noise else { return found };
        let variance = noise * noise;
        for k in 0..3 {
            found.covariance[(k, k)] = variance;
        }
        // The rotation about x moves the last slot by −length along y, that about y by +length along x; both slots have errors.
        for (rotation, shift, sign) in [(3, 1, -1.0), (4, 0, 1.0)] {
            found.covariance[(rotation, rotation)] = 2.0 * variance / self.length.powi(2);
            let coupling = -sign * variance / self.length;
            found.covariance[(rotation, shift)] = coupling;
            found.covariance[(shift, rotation)] = coupling;
        }
        found.set_known(&[0, 1, 2, 3, 4], None);
        found
    }
}
