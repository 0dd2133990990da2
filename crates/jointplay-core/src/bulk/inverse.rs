//! From many tilts to their rods.

use std::f64::consts::FRAC_PI_2;

use pulp::{Arch, Simd, WithSimd};

use super::{Column, Status, StatusCounts};
use crate::Error;
use crate::error::LARGEST_LENGTH;
use crate::gpr::{AxisHeight, Gpr};
use crate::kernel::{Lanes, sin_cos};
use crate::spatial::Tilt;

impl Gpr {
    /// Rods that put the platform plane at each of many tilts; see [`Self::inverse`].
    ///
    /// # Arguments
    /// * `azimuth`, `tilt_angle` – (n) tilts (rad)
    /// * `height` – (n) where the platform plane crosses the base axis (m)
    /// * `status` – (n) written: what became of each pose
    /// * `rods` – three columns of n, written: q_1, q_2, q_3 (m)
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] for columns of different lengths. Poses without rods, or beyond the limits of a robot that checks them, are NaN and have their status.
    ///
    /// # Numerics
    /// Does not allocate. Equal to [`Self::inverse`] to 10⁻¹² of the rod and the base.
    pub fn inverse_many(
        &self,
        azimuth: Column<'_>,
        tilt_angle: Column<'_>,
        height: Column<'_>,
        status: &mut [Status],
        rods: [&mut [f64]; 3],
    ) -> Result<StatusCounts, Error> {
        let lengths = [
            ("the column of azimuths", azimuth.len()),
            ("the column of tilt angles", tilt_angle.len()),
            ("the column of heights", height.len()),
            ("a column of rods", rods[0].len()),
            ("a column of rods", rods[1].len()),
            ("a column of rods", rods[2].len()),
        ];
        super::column::same_lengths(status.len(), lengths)?;
        let (shortest, longest, tilt_max) = if self.checks_limits() {
            let limits = self.limits();
            (limits.rod_min, limits.rod_max, limits.tilt_max)
        } else {
            (-LARGEST_LENGTH, LARGEST_LENGTH, FRAC_PI_2.next_down())
        };
        let given = [azimuth, tilt_angle, height];
        let blocks = Blocks { gpr: self, given, shortest, longest, tilt_max, status, rods };
        Arch::new().dispatch(blocks)?;
        Ok(StatusCounts::of(status))
    }
}

/// The work cut into blocks of as many tilts as the machine computes side by side.
struct Blocks<'a> {
    gpr: &'a Gpr,
    given: [Column<'a>; 3],
    /// Rods and tilt angles within these have an answer; of others the scalar kernel decides (m, m, rad).
    shortest: f64,
    longest: f64,
    tilt_max: f64,
    status: &'a mut [Status],
    rods: [&'a mut [f64]; 3],
}

impl WithSimd for Blocks<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Result<(), Error> {
        let tilts = self.status.len();
        let given = self.given.map(Column::blocks::<S>);
        for block in 0..tilts.div_ceil(Lanes::<S>::COUNT) {
            let first = block * Lanes::<S>::COUNT;
            let azimuth = given[0].block(simd, block);
            let tilt_angle = given[1].block(simd, block);
            let height = given[2].block(simd, block);
            let ((sin, cos), (rise, run)) = (sin_cos(azimuth), sin_cos(tilt_angle));
            let slope = rise / run;
            let (slope_x, slope_y) = (slope * cos, slope * sin);
            // Written so that what is not a number is no tilt.
            let mut reached = tilt_angle.abs().at_most(tilt_angle.like(self.tilt_max));
            let (shortest, longest) =
                (tilt_angle.like(self.shortest), tilt_angle.like(self.longest));
            for (rods, point) in self.rods.iter_mut().zip(self.gpr.base_points()) {
                let lower = slope_x.times_plus(slope.like(point.x), slope_y * point.y);
                let rod = height - lower;
                reached = reached & shortest.at_most(rod) & rod.at_most(longest);
                rod.store(rods, first);
            }
            let end = (first + Lanes::<S>::COUNT).min(tilts);
            if reached.all() {
                self.status[first..end].fill(Status::Solved);
                continue;
            }
            for (lane, reached) in reached.answers()[..end - first].iter().enumerate() {
                if *reached {
                    self.status[first + lane] = Status::Solved;
                } else {
                    self.one(first + lane)?;
                }
            }
        }
        Ok(())
    }
}

impl Blocks<'_> {
    /// One tilt by the scalar kernel, which also finds the reason where there is no answer.
    fn one(&mut self, i: usize) -> Result<(), Error> {
        let [azimuth, tilt_angle, height] = self.given.map(|column| column.at(i));
        let (status, found) =
            match self.gpr.inverse(Tilt { azimuth, angle: tilt_angle }, AxisHeight(height)) {
                Ok(rods) => (Status::Solved, rods),
                Err(error) => (Status::from_error(&error).ok_or(error)?, [f64::NAN; 3]),
            };
        self.status[i] = status;
        for (rods, rod) in self.rods.iter_mut().zip(found) {
            rods[i] = rod;
        }
        Ok(())
    }
}
