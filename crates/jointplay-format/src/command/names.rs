//! Names in the expressions of commands.

use super::problem::Error;
use crate::expression::is_free_name;
use crate::mechanism::{MechanismFile, Units};

/// Units of a mechanism file, its parameters, and the variable of a curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Names<'f> {
    units: Units,
    parameters: &'f [(String, f64)],
    variable: Option<String>,
}

impl<'f> Names<'f> {
    /// The parameters of a file.
    #[must_use]
    pub fn of(file: &'f MechanismFile) -> Self {
        Self { units: file.units, parameters: &file.parameters, variable: None }
    }

    /// No names, for values without a file.
    #[must_use]
    pub fn none(units: Units) -> Self {
        Self { units, parameters: &[], variable: None }
    }

    /// The same with a variable.
    ///
    /// # Errors
    /// [`Error::VariableIsParameter`], [`Error::VariableName`].
    pub fn with_variable(self, name: &str) -> Result<Self, Error> {
        let name = name.to_owned();
        if !is_free_name(&name) {
            return Err(Error::VariableName { name });
        }
        let is_parameter = |name: &str| self.parameters.iter().any(|(known, _)| known == name);
        if is_parameter(&name) {
            let other = ["t", "s", "u", "tau"].into_iter().find(|other| !is_parameter(other));
            return Err(Error::VariableIsParameter { name, other: other.unwrap_or("variable") });
        }
        Ok(Self { variable: Some(name), ..self })
    }

    /// The units of the file.
    #[must_use]
    pub fn units(&self) -> Units {
        self.units
    }

    /// The variable.
    #[must_use]
    pub fn variable(&self) -> Option<&str> {
        self.variable.as_deref()
    }

    /// All names that an expression may use, without `pi`.
    pub(super) fn all(&self) -> impl Iterator<Item = &str> + Clone {
        self.parameters.iter().map(|(name, _)| name.as_str()).chain(self.variable())
    }

    /// Value of a name in the units of the file.
    ///
    /// # Arguments
    /// * `at` – value of the variable
    pub(super) fn value(&self, name: &str, at: f64) -> Option<f64> {
        if self.variable() == Some(name) {
            return Some(at);
        }
        self.parameters.iter().find(|(known, _)| known == name).map(|(_, value)| *value)
    }
}
