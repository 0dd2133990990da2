//! Variables of a unit.

use jointplay_core::mechanism::joint::Coordinate;

/// A scalar variable of a unit, in SI units.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name, unique in the unit.
    pub name: String,
    /// Value reference: 1 for the first drive; 0 is the time.
    pub reference: u32,
    /// Whether the environment sets or reads it.
    pub causality: Causality,
    /// Physical quantity.
    pub quantity: Quantity,
    /// One line for users.
    pub description: String,
    /// Initial value of an input (m, rad).
    pub start: Option<f64>,
    /// Least and greatest value, infinite where there is none (m, rad), where the file states limits.
    pub limits: Option<[f64; 2]>,
}

/// Whether the environment sets or reads a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Causality {
    /// Set by the environment: a drive.
    Input,
    /// Read by the environment.
    Output,
}

/// Physical quantity of a variable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A length (m).
    Length,
    /// An angle (rad).
    Angle,
    /// A component of a unit quaternion.
    Component,
}

impl Quantity {
    /// Symbol of the SI unit; `None` for numbers without one.
    #[must_use]
    pub fn unit(self) -> Option<&'static str> {
        match self {
            Self::Length => Some("m"),
            Self::Angle => Some("rad"),
            Self::Component => None,
        }
    }
}

impl From<Coordinate> for Quantity {
    fn from(coordinate: Coordinate) -> Self {
        match coordinate {
            Coordinate::Slide => Self::Length,
            Coordinate::Turn => Self::Angle,
        }
    }
}

/// Outputs of a pose: position, then unit quaternion.
pub(super) const POSE_OUTPUTS: usize = 7;

/// A part of a structured name: as it is where it is an identifier, quoted otherwise.
///
/// Different texts have different parts.
///
/// # Source
/// \[FMI2\], section 2.2.9; \[FMI3\], section 2.4.7.5.1
pub(super) fn name_part(text: &str) -> String {
    let mut letters = text.chars();
    let starts = letters.next().is_some_and(|first| first.is_ascii_alphabetic() || first == '_');
    if starts && letters.all(|one| one.is_ascii_alphanumeric() || one == '_') {
        return text.to_owned();
    }
    let mut quoted = String::from("'");
    for letter in text.chars() {
        if matches!(letter, '\'' | '\\') {
            quoted.push('\\');
        }
        quoted.push(letter);
    }
    quoted.push('\'');
    quoted
}

/// Whether a name has only letters that structured names have.
pub(super) fn is_structured(name: &str) -> bool {
    name.chars().all(|one| (' '..='~').contains(&one) && !matches!(one, '`' | '"' | '\\'))
}

/// The variables of a model in the order of their value references: drives, poses, virtual joints.
#[derive(Debug, Default)]
pub(super) struct Variables(pub(super) Vec<Variable>);

impl Variables {
    fn add(&mut self, name: String, quantity: Quantity, description: String) -> &mut Variable {
        let reference = u32::try_from(self.0.len() + 1).expect("far fewer joints and links");
        let causality = Causality::Output;
        let (start, limits) = (None, None);
        let added = Variable { name, reference, causality, quantity, description, start, limits };
        self.0.push(added);
        self.0.last_mut().expect("it was added")
    }

    /// A drive, as an input.
    pub(super) fn drive(
        &mut self,
        part: &str,
        quantity: Quantity,
        start: f64,
        limits: Option<[f64; 2]>,
        description: String,
    ) {
        let drive = self.add(format!("drive.{part}"), quantity, description);
        (drive.causality, drive.start, drive.limits) = (Causality::Input, Some(start), limits);
    }

    /// Position and unit quaternion of a frame.
    pub(super) fn pose(&mut self, of: &str) {
        let part = name_part(of);
        for axis in ["x", "y", "z"] {
            let description = format!("position of {of} in the base frame, {axis}");
            self.add(format!("pose.{part}.{axis}"), Quantity::Length, description);
        }
        for component in ["qw", "qx", "qy", "qz"] {
            let description =
                format!("orientation of {of} in the base frame, unit quaternion, {component}");
            self.add(format!("pose.{part}.{component}"), Quantity::Component, description);
        }
    }

    /// Displacement of a virtual joint.
    pub(super) fn virtual_joint(&mut self, name: &str, quantity: Quantity) {
        let description = format!("displacement of the virtual joint {name}");
        self.add(format!("virtual_joint.{}", name_part(name)), quantity, description);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_names() {
        let check = |text: &str, part: &str, structured: bool| {
            assert_eq!(name_part(text), part);
            assert_eq!(is_structured(part), structured, "{part}");
        };
        check("crank_1", "crank_1", true);
        check("rod 1", "'rod 1'", true);
        check("1st", "'1st'", true);
        check("a.b", "'a.b'", true);
        check("'a.b'", "'\\'a.b\\''", false);
        check("Kurbel ä", "'Kurbel ä'", false);
    }
}
