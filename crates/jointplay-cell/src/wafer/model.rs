//! Descriptions of wafers, their supports, and the droop of arms.

/// Material of a wafer.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name.
    pub name: String,
    /// Young's modulus (Pa).
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Density (kg/m³).
    pub density: f64,
}

/// A round plate of constant thickness.
#[derive(Debug, Clone, PartialEq)]
pub struct Wafer {
    /// Diameter (m).
    pub diameter: f64,
    /// Thickness (m).
    pub thickness: f64,
    /// Material.
    pub material: Material,
}

impl Wafer {
    /// Mass (kg).
    #[must_use]
    pub fn mass(&self) -> f64 {
        let area = std::f64::consts::PI * self.diameter * self.diameter / 4.0;
        area * self.thickness * self.material.density
    }

    /// Weight per area, q (Pa).
    #[must_use]
    pub fn weight_per_area(&self, gravity: f64) -> f64 {
        self.material.density * gravity * self.thickness
    }

    /// Flexural rigidity D = E h³ / (12 (1 − ν²)) (N m).
    #[must_use]
    pub fn flexural_rigidity(&self) -> f64 {
        let Material { young, poisson, .. } = self.material;
        young * self.thickness.powi(3) / (12.0 * (1.0 - poisson * poisson))
    }
}

/// Support of a wafer.
#[derive(Debug, Clone, PartialEq)]
pub enum Support {
    /// The whole edge, simply supported.
    Edge,
    /// Three points, evenly spaced on a circle around the centre.
    ThreePoints {
        /// Radius of the circle (m).
        radius: f64,
    },
    /// Two parallel straight rails, at the same distance on both sides of the centre.
    TwoRails {
        /// Distance between the rails (m).
        distance: f64,
    },
}

/// Deflection of an arm by reach and load.
#[derive(Debug, Clone, PartialEq)]
pub enum Droop {
    /// No deflection.
    Rigid,
    /// Measured deflection at several reaches, empty and loaded; interpolated over the reach by a shape-preserving cubic, and linearly between empty and loaded.
    Table {
        /// One row for each reach, in growing order.
        rows: Vec<DroopRow>,
    },
    /// A cantilever of constant stiffness with its own weight distributed along it and the load at its tip.
    Cantilever {
        /// Bending stiffness E·I (N m²).
        stiffness: f64,
        /// Mass of the arm per length (kg/m).
        mass_per_length: f64,
    },
}

/// Measured deflection of an arm at one reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DroopRow {
    /// Distance of the wafer centre from the first joint (m).
    pub reach: f64,
    /// Drop of the empty effector at the wafer centre, down positive (m).
    pub empty_drop: f64,
    /// Slope of the empty effector, outer end down positive (rad).
    pub empty_slope: f64,
    /// Drop with the load (m).
    pub loaded_drop: f64,
    /// Slope with the load (rad).
    pub loaded_slope: f64,
    /// Mass of the load of the measurement (kg).
    pub load: f64,
}
