//! An imported model.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use jointplay_core::mechanism::{Coupling, Joint, JointCoordinate, Mechanism, MechanismError};
use jointplay_format::mechanism::{
    AngleUnit, Expected, LengthUnit, MechanismFile, Units, allowed_joint_name,
};

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
    /// The model as a mechanism file can have it, see [`Imported::with_allowed_names`] and [`coupled_guesses`].
    pub(super) fn completed(mut self) -> Result<Self, MechanismError> {
        let guesses = coupled_guesses(&self.mechanism);
        if !guesses.is_empty() {
            let mut joints = self.mechanism.joints().to_vec();
            for (JointCoordinate { joint, freedom }, value) in guesses {
                let Joint { kind, guess, .. } = &mut joints[joint];
                guess.resize(kind.freedoms(), 0.0);
                guess[freedom] = value;
            }
            self.mechanism = self.mechanism.with_joints(joints)?;
        }
        self.with_allowed_names()
    }

    /// The model with other names for joints and couplings whose names mechanism files do not allow, and a remark for each.
    fn with_allowed_names(mut self) -> Result<Self, MechanismError> {
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

/// Guesses of coordinates that follow others, for joints without one: the values of their couplings at the guesses of the others.
///
/// Where several couplings have the same follower, the first counts; a cycle starts at zero.
fn coupled_guesses(mechanism: &Mechanism) -> Vec<(JointCoordinate, f64)> {
    let joints = mechanism.joints();
    let mut couplings: BTreeMap<JointCoordinate, &Coupling> = BTreeMap::new();
    for coupling in mechanism.couplings() {
        if joints[coupling.follower.joint].guess.is_empty() {
            couplings.entry(coupling.follower).or_insert(coupling);
        }
    }
    let mut values: BTreeMap<JointCoordinate, f64> = BTreeMap::new();
    let mut is_open: BTreeSet<JointCoordinate> = BTreeSet::new();
    for &follower in couplings.keys() {
        if values.contains_key(&follower) {
            continue;
        }
        // An explicit stack, because a chain of followers can be as long as the file.
        let mut open = vec![follower];
        while let Some(&last) = open.last() {
            is_open.insert(last);
            let Coupling { terms, offset, .. } = couplings[&last];
            let is_missing =
                |one: &JointCoordinate| couplings.contains_key(one) && !is_open.contains(one);
            match terms.iter().map(|&(one, _)| one).find(is_missing) {
                Some(next) => open.push(next),
                None => {
                    let value = |one: JointCoordinate| {
                        let stated = joints[one.joint].guess.get(one.freedom);
                        values.get(&one).or(stated).copied().unwrap_or(0.0)
                    };
                    let sum = terms.iter().map(|&(one, ratio)| ratio * value(one)).sum::<f64>();
                    values.insert(last, offset + sum);
                    open.pop();
                }
            }
        }
    }
    values.into_iter().filter(|(_, value)| value.is_finite() && *value != 0.0).collect()
}
