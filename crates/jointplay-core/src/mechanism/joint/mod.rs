//! Kinds of joints, a file each: the factors of their motion.

mod cylindrical;
mod factor;
mod fixed;
mod floating;
mod helical;
mod planar;
mod prismatic;
mod revolute;
mod spherical;
mod universal;

pub(crate) use factor::Twist;
pub use factor::{Coordinate, Factor};

/// Which relative motions a joint allows.
///
/// The z axis of the joint frame is the axis, where there is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointKind {
    /// A turn about z [rad].
    Revolute,
    /// A slide along z [m].
    Prismatic,
    /// A turn about z [rad] with an advance along it.
    Helical {
        /// Advance for a turn of one radian [m/rad].
        lead: f64,
    },
    /// A slide along z [m], then a turn about z [rad].
    Cylindrical,
    /// A turn about z [rad], then one about the turned x [rad].
    Universal,
    /// A rotation: rotation vector in the joint frame [rad, rad, rad].
    Spherical,
    /// Slides along x and y [m, m], then a turn about z [rad].
    Planar,
    /// Nothing.
    Fixed,
    /// A displacement along x, y, z [m, m, m], then a rotation vector [rad, rad, rad].
    Floating,
}

impl JointKind {
    /// The elementary motions that it is made of, from the first link to the second.
    #[must_use]
    pub fn factors(self) -> Vec<Factor> {
        match self {
            Self::Revolute => revolute::factors(),
            Self::Prismatic => prismatic::factors(),
            Self::Helical { lead } => helical::factors(lead),
            Self::Cylindrical => cylindrical::factors(),
            Self::Universal => universal::factors(),
            Self::Spherical => spherical::factors(),
            Self::Planar => planar::factors(),
            Self::Fixed => fixed::factors(),
            Self::Floating => floating::factors(),
        }
    }

    /// What kind of quantity each coordinate is.
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
