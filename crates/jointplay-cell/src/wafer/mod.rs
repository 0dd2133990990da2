//! What is carried: plates that sag and may slip, arms that droop, and how the platform makes up for it.

mod acceleration;
mod compensation;
mod droop;
mod friction;
mod plate;
mod sag;

pub use compensation::{CompensatedPose, RejectedBranch, Unreachable, apply_deflection};
pub use droop::{Deflection, DroopError};
pub(crate) use droop::{DroopBounds, SHORTEST};
pub use friction::FrictionMargin;
pub use sag::{Sag, SagError, sag};

/// What a wafer is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// What it is called.
    pub name: String,
    /// Young's modulus [Pa].
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density [kg/m³].
    pub density: f64,
}

/// A round plate.
#[derive(Debug, Clone, PartialEq)]
pub struct Wafer {
    /// Diameter [m].
    pub diameter: f64,
    /// Thickness [m].
    pub thickness: f64,
    /// What it is made of.
    pub material: Material,
}

impl Wafer {
    /// Mass [kg].
    #[must_use]
    pub fn mass(&self) -> f64 {
        let area = std::f64::consts::PI * self.diameter * self.diameter / 4.0;
        area * self.thickness * self.material.density
    }

    /// Weight of a unit of area, q [Pa].
    #[must_use]
    pub fn weight_by_area(&self, gravity: f64) -> f64 {
        self.material.density * gravity * self.thickness
    }

    /// Bending stiffness D = E h³ / 12 (1 − ν²) [N m].
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        let Material { young, poisson, .. } = self.material;
        young * self.thickness.powi(3) / (12.0 * (1.0 - poisson * poisson))
    }
}

/// What a wafer rests on.
#[derive(Debug, Clone, PartialEq)]
pub enum Support {
    /// Along the whole edge, free to turn there.
    Edge,
    /// On three points, evenly round a circle about its centre.
    ThreePoints {
        /// Radius of the circle [m].
        radius: f64,
    },
    /// On two parallel straight rails, the same distance on both sides of its centre.
    TwoRails {
        /// Distance between the rails [m].
        distance: f64,
    },
}

/// How an arm gives way, by reach and load.
#[derive(Debug, Clone, PartialEq)]
pub enum Droop {
    /// Not at all.
    Rigid,
    /// Measured: drop and slope at reaches, empty and loaded; linear between.
    Table {
        /// One row a reach, reaches growing.
        rows: Vec<DroopRow>,
    },
    /// A cantilever of constant stiffness with its own weight along it and the load at its tip.
    Cantilever {
        /// Bending stiffness E·I [N m²].
        stiffness: f64,
        /// Mass of the arm by length [kg/m].
        mass_per_length: f64,
    },
}

/// What is measured of a drooping arm at one reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DroopRow {
    /// Distance of the wafer centre from the first joint [m].
    pub reach: f64,
    /// Drop of the empty effector at the wafer centre, down positive [m].
    pub empty_drop: f64,
    /// Slope of the empty effector, outer end down positive [rad].
    pub empty_slope: f64,
    /// Drop with the load [m].
    pub loaded_drop: f64,
    /// Slope with the load [rad].
    pub loaded_slope: f64,
    /// Mass of the load that was measured with [kg].
    pub load: f64,
}
