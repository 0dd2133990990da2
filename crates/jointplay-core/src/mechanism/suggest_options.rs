//! Extent and order of a search for virtual joints.

use super::LinearAndAngular;

/// Default number of sets that are compared before the search is cut short.
const DEFAULT_LIMIT: usize = 50_000;

/// Quantity by which sets are ranked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SuggestionRank {
    /// The displacement in the metric.
    #[default]
    Norm,
    /// The largest displacement of a single virtual joint, turns multiplied by the characteristic length.
    Largest,
    /// The elastic energy of the displacement of least energy.
    Stiffness,
}

/// Extent and order of a search for virtual joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SuggestOptions {
    /// The most sets that are compared by the linear estimate.
    pub limit: usize,
    /// The most virtual joints in a set; `None` for as many as there are directions to relieve.
    pub joints: Option<usize>,
    /// Whether only symmetric sets are compared.
    pub symmetric_only: bool,
    /// Order of the sets that are found.
    pub rank: SuggestionRank,
    /// Stiffness of joints that have none of their own, for a rank by stiffness (N/m, N m/rad).
    pub stiffness: LinearAndAngular,
}

impl Default for SuggestOptions {
    fn default() -> Self {
        Self {
            limit: DEFAULT_LIMIT,
            joints: None,
            symmetric_only: false,
            rank: SuggestionRank::Norm,
            stiffness: LinearAndAngular::default(),
        }
    }
}
