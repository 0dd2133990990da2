//! An imported model.

use jointplay_core::mechanism::Mechanism;
use jointplay_format::mechanism::{AngleUnit, Expected, LengthUnit, MechanismFile, Units};

/// An imported model.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The mechanism (m, rad).
    pub mechanism: Mechanism,
    /// Format of the file.
    pub dialect: Dialect,
    /// Ignored parts, with their numbers.
    pub ignored: Vec<String>,
}

/// Formats of model files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// Assemblies of FreeCAD, in the text format of its solver.
    Asmt,
    /// Documents of FreeCAD.
    FcStd,
    /// Models of MuJoCo.
    Mjcf,
    /// The Simulation Description Format of Gazebo.
    Sdf,
    /// The Unified Robot Description Format of ROS.
    Urdf,
}

impl Dialect {
    /// Name of the format.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Asmt => "ASMT",
            Self::FcStd => "FCStd",
            Self::Mjcf => "MJCF",
            Self::Sdf => "SDF",
            Self::Urdf => "URDF",
        }
    }
}

impl Imported {
    /// The mechanism as a mechanism file in m and rad.
    #[must_use]
    pub fn into_file(self) -> MechanismFile {
        MechanismFile {
            mechanism: self.mechanism,
            source: None,
            units: Units { length: LengthUnit::Meter, angle: AngleUnit::Radian },
            parameters: Vec::new(),
            expected: Expected::default(),
        }
    }
}
