//! From many tilts to their rods.

use super::{Column, Status, Tally};
use crate::Error;
use crate::gpr::{AxisHeight, Gpr};
use crate::spatial::Tilt;

impl Gpr {
    /// Rods that put the platform plane at each of many tilts; see [`Self::inverse`].
    ///
    /// # Arguments
    /// * `yaw`, `pitch` – (n) tilts [rad]
    /// * `height` – (n) where the platform plane crosses the base axis [m]
    /// * `status` – (n) written: what became of each pose
    /// * `rods` – three columns of n, written: q_1, q_2, q_3 [m]
    ///
    /// # Errors
    /// [`Error::WrongLength`] for columns of different lengths. Poses without rods are NaN and have their status.
    ///
    /// # Numerics
    /// Does not allocate. Equal to [`Self::inverse`] to 10⁻¹² of the rod.
    pub fn inverse_many(
        &self,
        yaw: Column<'_>,
        pitch: Column<'_>,
        height: Column<'_>,
        status: &mut [Status],
        rods: [&mut [f64]; 3],
    ) -> Result<Tally, Error> {
        let expected = status.len();
        let lengths = [
            ("the column of yaws", yaw.len()),
            ("the column of pitches", pitch.len()),
            ("the column of heights", height.len()),
            ("a column of rods", rods[0].len()),
            ("a column of rods", rods[1].len()),
            ("a column of rods", rods[2].len()),
        ];
        super::same_lengths(expected, lengths)?;
        for (i, ended) in status.iter_mut().enumerate() {
            let tilt = Tilt { yaw: yaw.at(i), pitch: pitch.at(i) };
            match self.inverse(tilt, AxisHeight(height.at(i))) {
                Ok(found) => {
                    *ended = Status::Solved;
                    (rods[0][i], rods[1][i], rods[2][i]) = found.into();
                }
                Err(error) => {
                    *ended = Status::of(&error).ok_or(error)?;
                    (rods[0][i], rods[1][i], rods[2][i]) = (f64::NAN, f64::NAN, f64::NAN);
                }
            }
        }
        Ok(Tally::of(status))
    }
}
