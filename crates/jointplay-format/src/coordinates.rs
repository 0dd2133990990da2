//! Names, units and values of a mechanism's coordinates in its file.

use jointplay_core::mechanism::joint::Coordinate;
use jointplay_core::mechanism::{FrameId, Mechanism, VirtualMotion};

use crate::mechanism::{AngleUnit, MechanismFile, Units};
use crate::number::number;
use crate::place::{listed, nearest, suggestion};

/// A coordinate of a joint or virtual joint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Name of the joint; with an index `[k]` from 0 if the joint has several freedoms.
    pub name: String,
    /// Name of the joint without an index.
    pub joint: String,
    /// Whether it is a length or an angle.
    pub quantity: Coordinate,
}

/// All coordinates of a mechanism, joints first, then virtual joints, in the units of its file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Coordinates {
    units: Units,
    named: Vec<Named>,
    joints: usize,
}

/// Error of a text that should name a coordinate.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An unknown name.
    #[error("joint `{found}` is not known{}; known: {}", suggestion(nearest), listed(known))]
    Unknown {
        /// What was found.
        found: String,
        /// The most similar known name.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// An unknown name of a link or frame.
    #[error(
        "link or frame `{found}` is not known{}; known: {}",
        suggestion(nearest),
        listed(known)
    )]
    UnknownFrame {
        /// What was found.
        found: String,
        /// The most similar known name.
        nearest: Option<String>,
        /// All known names.
        known: Vec<String>,
    },
    /// A joint with several freedoms; the name needs an index.
    #[error("joint `{joint}` has {} freedoms: choose one of {}", names.len(), listed(names))]
    Several {
        /// The joint.
        joint: String,
        /// Names of its coordinates.
        names: Vec<String>,
    },
    /// A value beyond every mechanism.
    #[error("{name} = {found} {unit} is too large, values must be within ±{largest} {unit}")]
    TooLarge {
        /// Name of the coordinate.
        name: String,
        /// The value, in `unit`.
        found: String,
        /// The largest allowed value, in `unit`.
        largest: String,
        /// The unit of the file, or that of SI where the value is too large for the former.
        unit: String,
    },
    /// A ball of which only one or two coordinates are commanded.
    #[error(
        "joint `{joint}` is a ball: command all of {joint}[0], {joint}[1], {joint}[2], its rotation vector, or none of them"
    )]
    PartlyCommanded {
        /// The joint.
        joint: String,
    },
    /// A joint without freedoms.
    #[error("joint `{joint}` is fixed and has no coordinate")]
    Fixed {
        /// The joint.
        joint: String,
    },
}

/// Largest displacement of a joint (m).
const LARGEST_DISPLACEMENT: f64 = 1e3;
/// Largest rotation of a joint (rad): ten thousand turns.
const LARGEST_ROTATION: f64 = 1e4 * std::f64::consts::TAU;

/// The attached frame with a name, or the frame of the link with it.
///
/// # Errors
/// [`Error::UnknownFrame`].
pub fn frame(mechanism: &Mechanism, name: &str) -> Result<FrameId, Error> {
    mechanism.frame(name).ok_or_else(|| {
        let attached = mechanism.frames().iter().map(|frame| &frame.name);
        let known: Vec<String> = mechanism.links().iter().chain(attached).cloned().collect();
        let nearest = nearest(name, known.iter().map(String::as_str));
        Error::UnknownFrame { found: name.to_owned(), nearest, known }
    })
}

impl Coordinates {
    /// A value of a coordinate (m, rad), if it is not beyond every mechanism.
    ///
    /// # Errors
    /// [`Error::TooLarge`]
    pub fn checked(&self, k: usize, value: f64) -> Result<f64, Error> {
        if value.abs() <= self.largest_si(k) {
            return Ok(value);
        }
        let (name, in_unit) = (self.named[k].name.clone(), self.from_si(k, value));
        if value.is_finite() && in_unit.is_infinite() {
            // The unit of the file has no finite number for it.
            let unit = match self.named[k].quantity {
                Coordinate::Slide => "m",
                Coordinate::Turn => "rad",
            };
            let (found, largest) = (number(value), number(self.largest_si(k)));
            return Err(Error::TooLarge { name, found, largest, unit: unit.to_owned() });
        }
        Err(Error::TooLarge {
            name,
            found: number(in_unit),
            largest: number(self.largest(k)),
            unit: self.unit(k).to_owned(),
        })
    }

    /// The largest value of a coordinate, in the unit of the file.
    #[must_use]
    pub fn largest(&self, k: usize) -> f64 {
        self.from_si(k, self.largest_si(k))
    }

    fn largest_si(&self, k: usize) -> f64 {
        match self.named[k].quantity {
            Coordinate::Slide => LARGEST_DISPLACEMENT,
            Coordinate::Turn => LARGEST_ROTATION,
        }
    }

    /// The coordinates of a file's mechanism.
    #[must_use]
    pub fn of(file: &MechanismFile) -> Self {
        let mechanism = &file.mechanism;
        let mut named = Vec::new();
        for joint in mechanism.joints() {
            let quantities = joint.kind.coordinates();
            let several = quantities.len() > 1;
            for (k, quantity) in quantities.into_iter().enumerate() {
                let name =
                    if several { format!("{}[{k}]", joint.name) } else { joint.name.clone() };
                named.push(Named { name, joint: joint.name.clone(), quantity });
            }
        }
        let joints = named.len();
        named.extend(mechanism.virtual_joints().iter().map(|joint| Named {
            name: joint.name.clone(),
            joint: joint.name.clone(),
            quantity: match joint.motion {
                VirtualMotion::Slide(_) => Coordinate::Slide,
                VirtualMotion::Turn { .. } => Coordinate::Turn,
            },
        }));
        Self { units: file.units, named, joints }
    }

    /// All coordinates, in the order of the coordinate vector.
    #[must_use]
    pub fn all(&self) -> &[Named] {
        &self.named
    }

    /// The units of the file.
    #[must_use]
    pub fn units(&self) -> Units {
        self.units
    }

    /// Number of coordinates of joints; the remaining ones belong to virtual joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Index of the joint coordinate with a name such as `crank` or `S1[2]`.
    ///
    /// # Errors
    /// [`Error`]: the name is unknown, or the joint has several coordinates or none.
    pub fn find(&self, mechanism: &Mechanism, name: &str) -> Result<usize, Error> {
        let named = &self.named[..self.joints];
        if let Some(found) = named.iter().position(|one| one.name == name) {
            return Ok(found);
        }
        let joint = name.to_owned();
        let names: Vec<String> =
            named.iter().filter(|one| one.joint == name).map(|one| one.name.clone()).collect();
        if !names.is_empty() {
            return Err(Error::Several { joint, names });
        }
        if mechanism.joint(name).is_some() {
            return Err(Error::Fixed { joint });
        }
        let known: Vec<String> = named.iter().map(|one| one.name.clone()).collect();
        let nearest = nearest(name, known.iter().map(String::as_str));
        Err(Error::Unknown { found: joint, nearest, known })
    }

    /// The error of commands that have only some coordinates of the ball at coordinate `k`.
    #[must_use]
    pub fn partly_commanded(&self, k: usize) -> Error {
        Error::PartlyCommanded { joint: self.named[k].joint.clone() }
    }

    /// Converts a value of coordinate `k` from the file's unit to SI (m, rad).
    #[must_use]
    pub fn to_si(&self, k: usize, value: f64) -> f64 {
        match self.named[k].quantity {
            Coordinate::Slide => self.units.length.to_meters(value),
            Coordinate::Turn => self.units.angle.to_radians(value),
        }
    }

    /// Converts a value of coordinate `k` to the unit of the file.
    ///
    /// # Arguments
    /// * `value` – (m, rad)
    #[must_use]
    pub fn from_si(&self, k: usize, value: f64) -> f64 {
        match self.named[k].quantity {
            Coordinate::Slide => self.units.length.from_meters(value),
            Coordinate::Turn => self.units.angle.from_radians(value),
        }
    }

    /// The file's unit of coordinate `k`.
    #[must_use]
    pub fn unit(&self, k: usize) -> &'static str {
        match self.named[k].quantity {
            Coordinate::Slide => self.units.length.name(),
            Coordinate::Turn => self.units.angle.name(),
        }
    }

    /// Column heading of coordinate `k`, name and unit: `crank_deg`.
    #[must_use]
    pub fn column(&self, k: usize) -> String {
        format!("{}_{}", self.named[k].name, self.unit(k))
    }

    /// Decimals that resolve about a millionth of a millimetre or of a degree.
    #[must_use]
    pub fn decimals(&self, k: usize) -> usize {
        match (self.named[k].quantity, self.units.angle) {
            (Coordinate::Slide, _) => self.units.length.decimals(),
            (Coordinate::Turn, AngleUnit::Degree) => 6,
            (Coordinate::Turn, AngleUnit::Radian) => 8,
        }
    }
}
