//! Report on an assembled mechanism.

use jointplay_core::mechanism::{Branches, Closure, MAX_BRANCHES, Relief, guess};

use crate::beyond::beyond_limits;
use crate::limits::LimitReport;
use crate::mechanism::{
    ByName, ConfigurationReport, CoordinateDisplacementReport, UnitsReport, configuration,
    largest_displacement, virtual_by_name,
};
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::MechanismFile;

/// Result of `assemble`.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct AssemblyReport {
    /// Name of the mechanism.
    pub name: String,
    /// Units of the coordinates.
    pub units: UnitsReport,
    /// The closed configuration nearest the guess.
    #[serde(flatten)]
    pub closed: ConfigurationReport,
    /// The coordinate that is farthest from the guess of the file; `None` without coordinates and for mechanisms with very many loops.
    pub farthest_from_guess: Option<CoordinateDisplacementReport>,
    /// Displacements of the virtual joints by name, if rigid links cannot close the loops with the given values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub virtual_joints: Option<ByName<f64>>,
    /// Coordinates beyond their limits or clearance.
    pub limits_broken: Vec<LimitReport>,
    /// Accepted closure residual, if the loops did not close exactly, in radians and characteristic lengths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
    /// Other closed configurations, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branches: Option<Vec<ConfigurationReport>>,
    /// The search for other closed configurations, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch_search: Option<BranchSearchReport>,
}

/// The search for other closed configurations.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct BranchSearchReport {
    /// Number of starts that were tried.
    pub starts: usize,
    /// Number of configurations at which the search ends.
    pub limit: usize,
    /// Whether it ended there before the requested number of starts, so that there may be more.
    pub limit_reached: bool,
}

/// Reports an assembled mechanism.
///
/// # Arguments
/// * `relief` – displacements of the virtual joints, if any were necessary
/// * `tolerance` – largest closure residual that counts as closed, if one was given, in radians and characteristic lengths
#[must_use]
pub fn assembly(
    file: &MechanismFile,
    closed: &Closure,
    relief: Option<&Relief>,
    tolerance: Option<f64>,
    branches: Option<&Branches>,
) -> AssemblyReport {
    let coordinates = Coordinates::of(file);
    let report = |closed| configuration(&coordinates, closed);
    AssemblyReport {
        name: file.mechanism.name().to_owned(),
        units: UnitsReport::of(&coordinates),
        closed: report(closed),
        farthest_from_guess: largest_displacement(
            file,
            &guess(&file.mechanism),
            &closed.coordinates,
        ),
        virtual_joints: relief.map(|relief| virtual_by_name(&coordinates, relief)),
        limits_broken: beyond_limits(
            &coordinates,
            &file.mechanism.beyond_limits(&closed.coordinates),
        ),
        tolerance: tolerance.filter(|_| !closed.is_closed()),
        branches: branches.map(|found| found.closures.iter().map(report).collect()),
        branch_search: branches.map(|found| BranchSearchReport {
            starts: found.starts,
            limit: MAX_BRANCHES,
            limit_reached: found.is_limited,
        }),
    }
}
