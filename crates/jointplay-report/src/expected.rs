//! Comparison of an analysis with the results that the mechanism's file expects.

use crate::mobility::FreedomsReport;
use jointplay_format::mechanism::Expected;

/// A quantity that is not what the file of the mechanism expects.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct DisagreementReport {
    /// Key of `[expected]`.
    pub quantity: &'static str,
    /// Value in the file.
    pub expected: i64,
    /// Value found; `null` where undecided.
    pub found: Option<i64>,
}

/// Formats as `finite: 0 expected, 1 found`.
impl std::fmt::Display for DisagreementReport {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { quantity, expected, found } = self;
        match found {
            Some(found) => write!(formatter, "{quantity}: {expected} expected, {found} found"),
            None => write!(formatter, "{quantity}: {expected} expected, undecided"),
        }
    }
}

/// Quantities of an analysis that differ from the file's `[expected]`; an undecided quantity differs.
#[must_use]
pub fn disagreements(
    expected: &Expected,
    joint_freedoms: usize,
    found: &FreedomsReport,
) -> Vec<DisagreementReport> {
    let whole = |value: usize| i64::try_from(value).unwrap_or(i64::MAX);
    let rows = [
        ("freedoms", expected.freedoms.map(whole), Some(whole(joint_freedoms))),
        ("rank", expected.rank.map(whole), Some(whole(found.rank))),
        ("kutzbach", expected.kutzbach, Some(found.kutzbach_mobility)),
        (
            "instantaneous",
            expected.instantaneous.map(whole),
            Some(whole(found.instantaneous_mobility)),
        ),
        ("finite", expected.finite.map(whole), found.finite_mobility.map(whole)),
        ("redundancy", expected.redundancy.map(whole), Some(whole(found.redundancy))),
    ];
    rows.into_iter()
        .filter_map(|(quantity, expected, found)| Some((quantity, expected?, found)))
        .filter(|(_, expected, found)| Some(*expected) != *found)
        .map(|(quantity, expected, found)| DisagreementReport { quantity, expected, found })
        .collect()
}
