//! The limits that many poses break.

use super::Column;
use crate::Error;
use crate::gpr::Gpr;
use crate::spatial::Tilt;

impl Gpr {
    /// The limits that each of many poses breaks; see [`Limits::broken`](crate::gpr::Limits::broken).
    ///
    /// # Arguments
    /// * `rods` – three columns of n: q_1, q_2, q_3 (m)
    /// * `tilt_angle` – (n) tilt angles (rad); `None` for those of the planes through the balls
    /// * `broken` – four columns of n, written: whether rod 1, rod 2, rod 3 and the tilt are beyond their limits
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] for columns of different lengths.
    ///
    /// # Numerics
    /// Does not allocate.
    pub fn broken_limits_many(
        &self,
        rods: [Column<'_>; 3],
        tilt_angle: Option<Column<'_>>,
        broken: [&mut [bool]; 4],
    ) -> Result<(), Error> {
        let expected = rods[0].len();
        super::column::same_lengths(
            expected,
            rods.map(|column| ("a column of rods", column.len())),
        )?;
        super::column::same_lengths(
            expected,
            tilt_angle.map(|column| ("the column of tilt angles", column.len())),
        )?;
        let written = broken.each_ref().map(|column| ("a column of results", column.len()));
        super::column::same_lengths(expected, written)?;
        let [first, second, third, tilted] = broken;
        let written = first.iter_mut().zip(second).zip(third).zip(tilted).enumerate();
        for (i, (((first, second), third), tilted)) in written {
            let rods = rods.map(|column| column.at(i));
            let tilt = match &tilt_angle {
                Some(tilt_angle) => Tilt { azimuth: 0.0, angle: tilt_angle.at(i) },
                None => self.plane_tilt(&rods),
            };
            let found = self.limits().broken(&rods, tilt);
            [*first, *second, *third] = found.rods();
            *tilted = found.tilt();
        }
        Ok(())
    }
}
