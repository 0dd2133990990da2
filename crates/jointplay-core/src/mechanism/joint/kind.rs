//! Kinds of joints, each a sequence of elementary motions.

use super::factor::{Coordinate, Factor};

/// Kind of a joint: the relative motions that it allows.
///
/// The z axis of the joint frame is the axis, where there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// A turn about z (rad).
    Revolute,
    /// A slide along z (m).
    Prismatic,
    /// A turn about z (rad) with an advance along it.
    Helical {
        /// Advance for a turn of one radian (m/rad).
        lead: f64,
    },
    /// A slide along z (m), then a turn about z (rad).
    Cylindrical,
    /// A turn about z (rad), then one about the turned x (rad).
    Universal,
    /// A rotation: rotation vector in the joint frame (rad, rad, rad).
    Spherical,
    /// Slides along x and y (m, m), then a turn about z (rad).
    Planar,
    /// Nothing.
    Fixed,
    /// A displacement along x, y, z (m, m, m), then a rotation vector (rad, rad, rad).
    Floating,
}

impl JointKind {
    /// The elementary motions that it is made of, from the first link to the second.
    #[must_use]
    pub fn factors(self) -> Vec<Factor> {
        match self {
            Self::Revolute => vec![Factor::turn(2)],
            Self::Prismatic => vec![Factor::slide(2)],
            Self::Helical { lead } => vec![Factor::Screw { lead }],
            Self::Cylindrical => vec![Factor::slide(2), Factor::turn(2)],
            Self::Universal => vec![Factor::turn(2), Factor::turn(0)],
            Self::Spherical => vec![Factor::Ball],
            Self::Planar => vec![Factor::slide(0), Factor::slide(1), Factor::turn(2)],
            Self::Fixed => Vec::new(),
            Self::Floating => {
                vec![Factor::slide(0), Factor::slide(1), Factor::slide(2), Factor::Ball]
            }
        }
    }

    /// Kind of each coordinate.
    #[must_use]
    pub fn coordinates(self) -> Vec<Coordinate> {
        self.factors().iter().flat_map(|factor| factor.coordinates()).copied().collect()
    }

    /// Number of freedoms.
    #[must_use]
    pub fn freedoms(self) -> usize {
        self.coordinates().len()
    }

    /// Its name, as in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
            Self::Helical { .. } => "helical",
            Self::Cylindrical => "cylindrical",
            Self::Universal => "universal",
            Self::Spherical => "spherical",
            Self::Planar => "planar",
            Self::Fixed => "fixed",
            Self::Floating => "floating",
        }
    }
}
