//! From many tilts to their rods.

use std::f64::consts::FRAC_PI_2;

use pulp::{Arch, Simd, WithSimd};

use super::{Column, Status, StatusCounts};
use crate::Error;
use crate::error::LARGEST_LENGTH;
use crate::gpr::{AxisHeight, Gpr};
use crate::kernel::{Lanes, Mask, Three, gradient};
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
        let bounds = if self.checks_limits() {
            let limits = self.limits();
            Bounds { shortest: limits.rod_min, longest: limits.rod_max, tilt_max: limits.tilt_max }
        } else {
            Bounds {
                shortest: -LARGEST_LENGTH,
                longest: LARGEST_LENGTH,
                tilt_max: FRAC_PI_2.next_down(),
            }
        };
        let given = [azimuth, tilt_angle, height];
        let blocks = Blocks { gpr: self, given, bounds, status, rods };
        blocks.compute(Arch::new())?;
        Ok(StatusCounts::of(status))
    }
}

/// The work cut into blocks of as many tilts as the machine computes side by side.
struct Blocks<'a> {
    gpr: &'a Gpr,
    given: [Column<'a>; 3],
    bounds: Bounds,
    status: &'a mut [Status],
    rods: [&'a mut [f64]; 3],
}

/// Rods (m) and tilt angles (rad) within these have an answer; of others the scalar kernel decides.
#[derive(Clone, Copy)]
struct Bounds {
    shortest: f64,
    longest: f64,
    tilt_max: f64,
}

impl WithSimd for Blocks<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Result<(), Error> {
        let tilts = self.status.len();
        let count = Lanes::<S>::COUNT;
        let [azimuths, angles, heights] = self.given.map(|column| column.blocks(simd));
        let (points, bounds) = (self.gpr.base_points().map(Into::into), self.bounds);
        let status = &mut *self.status;
        status.fill(Status::Solved);
        let mut doubtful = false;
        let [(q_1, rest_1), (q_2, rest_2), (q_3, rest_3)] =
            self.rods.each_mut().map(|rods| S::as_mut_simd_f64s(rods));
        for block in 0..tilts.div_ceil(count) {
            let tilts = Tilts {
                azimuth: azimuths.block(simd, block),
                angle: angles.block(simd, block),
                height: heights.block(simd, block),
            };
            let ([r_1, r_2, r_3], reached) = tilts.rods(&points, &bounds);
            if block < q_1.len() && block < q_2.len() && block < q_3.len() {
                q_1[block] = r_1.register();
                q_2[block] = r_2.register();
                q_3[block] = r_3.register();
            } else {
                rest_1.copy_from_slice(&r_1.numbers()[..rest_1.len()]);
                rest_2.copy_from_slice(&r_2.numbers()[..rest_2.len()]);
                rest_3.copy_from_slice(&r_3.numbers()[..rest_3.len()]);
            }
            if !reached.all() {
                doubtful = true;
                let answers = &reached.answers()[..count];
                Status::mark(&mut status[block * count..], answers, Status::TiltTooLarge);
            }
        }
        if doubtful { self.one_by_one() } else { Ok(()) }
    }
}

/// Tilts side by side.
struct Tilts<S: Simd> {
    azimuth: Lanes<S>,
    angle: Lanes<S>,
    height: Lanes<S>,
}

impl<S: Simd> Tilts<S> {
    /// The rods at these points of the base, and where they have an answer.
    #[inline(always)]
    fn rods(&self, points: &[[f64; 2]; 3], bounds: &Bounds) -> (Three<S>, Mask<S>) {
        let Self { azimuth, angle, height } = *self;
        let [slope_x, slope_y] = gradient(azimuth, angle);
        let mut rods = [height; 3];
        for (rod, [x, y]) in rods.iter_mut().zip(points) {
            *rod = slope_y.times_from(height.like(*y), slope_x.times_from(height.like(*x), height));
        }
        // Written so that what is not a number is no tilt.
        let [q_1, q_2, q_3] = rods;
        let reached = angle.abs().at_most(angle.like(bounds.tilt_max))
            & angle.like(bounds.shortest).at_most(q_1.min(q_2).min(q_3))
            & q_1.max(q_2).max(q_3).at_most(angle.like(bounds.longest));
        (rods, reached)
    }
}

impl Blocks<'_> {
    /// Computes all tilts with these instructions.
    fn compute(self, arch: Arch) -> Result<(), Error> {
        arch.dispatch(self)
    }

    /// Tilts that the blocks have left.
    #[cold]
    fn one_by_one(&mut self) -> Result<(), Error> {
        for i in 0..self.status.len() {
            if self.status[i] != Status::Solved {
                self.one(i)?;
            }
        }
        Ok(())
    }

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bulk::instruction_set::instruction_sets;

    /// Bits of the rods and statuses of tilts, some beyond the limits and some not numbers.
    fn with(
        kernel: &dyn Fn(Blocks<'_>) -> Result<(), Error>,
        gpr: &Gpr,
    ) -> (Vec<u64>, Vec<Status>) {
        const TILTS: usize = 61;
        let of = |scale: f64| -> Vec<f64> { (0..TILTS).map(|i| i as f64 * scale).collect() };
        let (mut azimuth, mut tilt_angle, mut height) = (of(0.7), of(0.0007), of(0.001));
        height.iter_mut().for_each(|height| *height += 0.47);
        for (i, odd) in [f64::NAN, f64::INFINITY, 2e6, -1.0, 1e300].into_iter().enumerate() {
            azimuth[5 + 3 * i] = odd;
            tilt_angle[6 + 3 * i] = odd;
            height[7 + 3 * i] = odd;
        }
        let mut status = vec![Status::TurnedOver; TILTS];
        let mut rods = [const { [0.0; TILTS] }; 3];
        let limits = gpr.limits();
        let blocks = Blocks {
            gpr,
            given: [&azimuth, &tilt_angle, &height].map(|column| Column::from(&column[..])),
            bounds: Bounds {
                shortest: limits.rod_min,
                longest: limits.rod_max,
                tilt_max: limits.tilt_max,
            },
            status: &mut status,
            rods: rods.each_mut().map(|rods| &mut rods[..]),
        };
        kernel(blocks).unwrap();
        for i in 0..TILTS {
            let tilt = Tilt { azimuth: azimuth[i], angle: tilt_angle[i] };
            match gpr.inverse(tilt, AxisHeight(height[i])) {
                Ok(found) => {
                    assert_eq!(status[i], Status::Solved, "{i}");
                    for (rods, expected) in rods.iter().zip(found) {
                        assert!((rods[i] - expected).abs() < 1e-12, "{i}: {} {expected}", rods[i]);
                    }
                }
                Err(error) => {
                    assert_eq!(Some(status[i]), Status::from_error(&error), "{i}");
                    assert!(rods.iter().all(|rods| rods[i].is_nan()), "{i}");
                }
            }
        }
        (rods.as_flattened().iter().map(|rod| rod.to_bits()).collect(), status)
    }

    #[test]
    fn all_register_widths_give_the_same_bits() {
        let gpr = Gpr::paper();
        let by = |arch| with(&|blocks: Blocks<'_>| blocks.compute(arch), &gpr);
        let one_lane = by(Arch::Scalar);
        let failed = one_lane.1.iter().filter(|status| **status != Status::Solved).count();
        assert!((15..40).contains(&failed), "{failed}");
        let two_lanes = with(&|blocks: Blocks<'_>| pulp::Scalar128b.vectorize(blocks), &gpr);
        assert!(two_lanes == one_lane, "two lanes");
        for (instructions, arch) in instruction_sets() {
            assert!(by(arch) == one_lane, "{instructions}");
        }
    }
}
