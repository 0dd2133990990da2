//! An imported model.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

use jointplay_core::mechanism::{JointKind, Mechanism, MechanismError};
use jointplay_format::mechanism::{
    AngleUnit, Expected, LARGEST_COORDINATE, LengthUnit, MechanismFile, Units, allowed_joint_name,
};
use jointplay_format::toml_reader::LARGEST;

use super::problem::Problem;

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
    /// The model with other names for joints and couplings whose names mechanism files do not allow, and a remark for each.
    pub(super) fn with_allowed_names(mut self) -> Result<Self, MechanismError> {
        let mut joints = self.mechanism.joints().to_vec();
        let mut couplings = self.mechanism.couplings().to_vec();
        let mut names: Vec<(&str, &mut String)> = Vec::new();
        names.extend(joints.iter_mut().map(|joint| ("joint", &mut joint.name)));
        names.extend(couplings.iter_mut().map(|coupling| ("coupling", &mut coupling.name)));
        let mut taken: BTreeSet<String> = names.iter().map(|(_, name)| (*name).clone()).collect();
        let mut remarks = Vec::new();
        for (what, name) in names {
            let Cow::Owned(allowed) = allowed_joint_name(name) else { continue };
            let numbered = (2..).map(|number| format!("{allowed} ({number})"));
            let mut candidates = std::iter::once(allowed.clone()).chain(numbered);
            let free = candidates.find(|one| taken.insert(one.clone()));
            let free = free.expect("names are finitely many");
            remarks.push(format!(
                "{what} {name:?} is called {free:?}: names have none of the letters , = [ ]"
            ));
            *name = free;
        }
        if !remarks.is_empty() {
            self.mechanism = self.mechanism.with_joints(joints)?.with_couplings(couplings)?;
            self.ignored.extend(remarks);
        }
        Ok(self)
    }

    /// Refuses numbers that a file of this mechanism may not have.
    pub(super) fn check_numbers(&self) -> Result<(), Problem> {
        let check = |what, whose: &str, values: &[f64], allowed| {
            let found = values.iter().copied().find(|value| value.abs() > allowed);
            let whose = || whose.to_owned();
            found.map_or(Ok(()), |found| {
                Err(Problem::TooLarge { what, whose: whose(), found, allowed })
            })
        };
        for joint in self.mechanism.joints() {
            for frame in &joint.frames {
                let point = frame.translation.vector.as_slice();
                check("the position (m)", &joint.name, point, LARGEST_COORDINATE)?;
            }
            if let JointKind::Helical { lead } = joint.kind {
                check("the lead (m)", &joint.name, &[lead * TAU], LARGEST)?;
            }
            check("the guess (m or rad)", &joint.name, &joint.guess, LARGEST_COORDINATE)?;
            let limits = joint.limits.iter().flatten().copied();
            let limits: Vec<f64> = limits.filter(|limit| limit.is_finite()).collect();
            check("a limit (m or rad)", &joint.name, &limits, LARGEST_COORDINATE)?;
        }
        for coupling in self.mechanism.couplings() {
            let ratios: Vec<f64> = coupling.terms.iter().map(|&(_, ratio)| ratio).collect();
            check("a ratio", &coupling.name, &ratios, LARGEST)?;
            check("the offset (m or rad)", &coupling.name, &[coupling.offset], LARGEST)?;
        }
        Ok(())
    }

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
