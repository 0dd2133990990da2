//! Suggestions of virtual joints.

use jointplay::mechanism::{
    LinearAndAngular, SuggestOptions, SuggestionRank, close_nearly, suggest,
};
use jointplay::nalgebra::DVector;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::mechanism::PyMechanism;
use crate::numbers::count;
use crate::{errors, mechanism_results as results};

/// The most sets that a search may compare.
const MOST_SETS: usize = 100_000_000;

#[pymethods]
impl PyMechanism {
    /// Where the mechanism would have to have play for commands to be possible.
    ///
    /// Virtual joints are tried at every joint, in every direction that the joint constrains; those of the file are ignored.
    ///
    /// Parameters
    /// ----------
    /// commands : sequence of dict of str to float
    ///     Each with values for the same joint coordinates (m, rad).
    /// limit : int, optional
    ///     Largest number of sets to compare, default 50,000.
    /// joints : int, optional
    ///     Largest number of virtual joints in a set; by default as many as there are directions to relieve.
    /// symmetric : bool, optional
    ///     Compare only symmetric sets.
    /// rank : str, optional
    ///     Rank by the norm of all displacements, ``'norm'``, by the largest single displacement, ``'largest'``, or by elastic energy, ``'stiffness'``.
    /// linear_stiffness, angular_stiffness : float, optional
    ///     Stiffness of joints that have none in the file, for the rank by stiffness (N/m, N m/rad).
    #[pyo3(signature = (commands, *, limit=None, joints=None, symmetric=false, rank="norm", linear_stiffness=None, angular_stiffness=None))]
    #[expect(clippy::too_many_arguments, reason = "options of a Python function")]
    fn suggest<'py>(
        &self,
        py: Python<'py>,
        commands: Vec<Bound<'py, PyDict>>,
        limit: Option<&Bound<'py, PyAny>>,
        joints: Option<&Bound<'py, PyAny>>,
        symmetric: bool,
        rank: &str,
        linear_stiffness: Option<f64>,
        angular_stiffness: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut options = SuggestOptions { symmetric_only: symmetric, ..SuggestOptions::default() };
        if let Some(limit) = limit {
            options.limit = count(limit, "limit", 1..=MOST_SETS)?;
        }
        options.joints = joints.map(|given| count(given, "joints", 1..=MOST_SETS)).transpose()?;
        options.rank = match rank {
            "norm" => SuggestionRank::Norm,
            "largest" => SuggestionRank::Largest,
            "stiffness" => SuggestionRank::Stiffness,
            other => {
                let known = ["norm", "largest", "stiffness"].map(str::to_owned);
                return Err(errors::unknown_name(py, "rank", other, &known));
            }
        };
        for (name, value) in
            [("linear_stiffness", linear_stiffness), ("angular_stiffness", angular_stiffness)]
        {
            match value {
                Some(value) if !(value.is_finite() && value > 0.0) => {
                    let text = format!("{name} must be a positive finite number, got {value}");
                    return Err(errors::input(py, &text));
                }
                Some(_) if options.rank != SuggestionRank::Stiffness => {
                    let text = format!("{name} needs rank=\"stiffness\"");
                    return Err(errors::input(py, &text));
                }
                _ => {}
            }
        }
        options.stiffness =
            LinearAndAngular { linear: linear_stiffness, angular: angular_stiffness };
        let Some(first) = commands.first() else {
            return Err(errors::input(
                py,
                "no command is given; expected a list such as [{\"crank\": 0.5}]",
            ));
        };
        let commanded: Vec<usize> =
            self.commands(py, Some(first))?.iter().map(|&(k, _)| k).collect();
        let mut all = Vec::with_capacity(commands.len());
        for command in &commands {
            let given = self.commands(py, Some(command))?;
            let value = |k: &usize| given.iter().find(|(known, _)| known == k).map(|one| one.1);
            match commanded.iter().map(value).collect::<Option<Vec<f64>>>() {
                Some(values) if given.len() == commanded.len() => {
                    all.push(DVector::from_vec(values))
                }
                _ => return Err(errors::input(py, "every command has to name the same joints")),
            }
        }
        let bare = self.file.mechanism.clone().with_virtual_joints(Vec::new());
        let bare = bare.map_err(|error| errors::internal(&error.to_string()))?;
        let found = py.detach(|| {
            let home = close_nearly(&self.file.mechanism)?;
            suggest(&bare, &home.coordinates, &commanded, &all, &options)
        });
        let found = found.map_err(|error| errors::core(py, &error))?;
        results::suggestions(py, self, &bare, &found)
    }

    /// A new mechanism with these virtual joints in place of its own.
    ///
    /// Parameters
    /// ----------
    /// suggestion : Suggestion or sequence of SuggestedJoint
    ///     The virtual joints; the alternatives of a `SuggestedJoint` are accepted in its place.
    ///
    /// Returns
    /// -------
    /// Mechanism
    ///     Its file has the comments and the parameters of this one.
    fn with_virtual_joints(&self, py: Python<'_>, suggestion: &Bound<'_, PyAny>) -> PyResult<Self> {
        let joints = match suggestion.getattr_opt("virtual_joints")? {
            Some(joints) => joints,
            None => suggestion.clone(),
        };
        let joints = joints
            .try_iter()?
            .map(|one| results::virtual_joint(py, &self.file.mechanism, &one?))
            .collect::<PyResult<Vec<_>>>()?;
        self.with_play(py, &joints)
    }
}
