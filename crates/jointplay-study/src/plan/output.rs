//! Quantities to compute of a sample.

use jointplay_core::bulk::Quantity;
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::Virtualization;
use nalgebra::Vector3;

use super::Dimension;
use crate::Error;

/// A number that each sample has, in its SI unit; indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputQuantity {
    /// Height, as commanded (m).
    Height,
    /// First angle of the tilt, as commanded (rad).
    FirstAngle,
    /// Second angle of the tilt, as commanded (rad).
    SecondAngle,
    /// Rod q_k (m).
    Rod(usize),
    /// Side L_12, L_23 or L_31 (m).
    Side(usize),
    /// A dimension of a limb as it is built ((m), (rad)).
    Built {
        /// Which limb.
        limb: usize,
        /// Which of its dimensions.
        dimension: Dimension,
    },
    /// Something of the platform under a virtualization.
    Model {
        /// Which of the plan's virtualizations.
        model: usize,
        /// What.
        measure: PlatformQuantity,
    },
}

/// A number that the platform has under a virtualization.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlatformQuantity {
    /// A quantity of the core.
    Quantity(Quantity),
    /// Distance of O_p from the base axis (m).
    CenterShift,
    /// Tilt about e_b1 (rad).
    TiltX,
    /// Tilt about e_b2 (rad).
    TiltY,
    /// Angle between the platform normal and the one commanded (rad).
    TiltError,
}

/// Columns of the core with what they hold.
pub(super) type Columns = Vec<(Quantity, Vec<f64>)>;

impl PlatformQuantity {
    /// Quantities of the core that it is computed from.
    fn made_of(self) -> Vec<Quantity> {
        match self {
            Self::Quantity(quantity) => vec![quantity],
            Self::CenterShift => vec![Quantity::Origin(0), Quantity::Origin(1)],
            Self::TiltX | Self::TiltY => vec![Quantity::Azimuth, Quantity::TiltAngle],
            Self::TiltError => [0, 1, 2].map(Quantity::Normal).to_vec(),
        }
    }

    /// Whether it exists for a virtualization.
    ///
    /// # Errors
    /// As [`Quantity::check`].
    pub fn check(self, virtualization: &dyn Virtualization) -> Result<(), Error> {
        Ok(self.made_of().into_iter().try_for_each(|quantity| quantity.check(virtualization))?)
    }

    /// Its values from what it is made of, where `commanded` is the tilt of a sample.
    pub(super) fn values(self, columns: &Columns, commanded: impl Fn(usize) -> Tilt) -> Vec<f64> {
        let parts: Vec<&[f64]> =
            self.made_of().into_iter().map(|quantity| column(columns, quantity)).collect();
        let each = |value: &dyn Fn(usize) -> f64| (0..parts[0].len()).map(value).collect();
        let about = |i: usize| Tilt { azimuth: parts[0][i], angle: parts[1][i] }.about_x_and_y();
        match self {
            Self::Quantity(_) => parts[0].to_vec(),
            Self::CenterShift => each(&|i| libm::hypot(parts[0][i], parts[1][i])),
            Self::TiltX => each(&|i| about(i).0),
            Self::TiltY => each(&|i| about(i).1),
            Self::TiltError => each(&|i| {
                let normal = Vector3::new(parts[0][i], parts[1][i], parts[2][i]);
                let asked = commanded(i).normal();
                // An arc cosine would lose half the digits of a small angle.
                libm::atan2(normal.cross(&asked).norm(), normal.dot(&asked))
            }),
        }
    }
}

/// Columns for all that measures are made of, each once.
pub(super) fn columns(measures: impl Iterator<Item = PlatformQuantity>, len: usize) -> Columns {
    let mut columns = Columns::new();
    for quantity in measures.flat_map(PlatformQuantity::made_of) {
        if columns.iter().all(|(known, _)| *known != quantity) {
            columns.push((quantity, vec![f64::NAN; len]));
        }
    }
    columns
}

fn column(columns: &Columns, wanted: Quantity) -> &[f64] {
    let found = columns.iter().find(|(quantity, _)| *quantity == wanted);
    &found.expect("there are columns for all that measures are made of").1
}
