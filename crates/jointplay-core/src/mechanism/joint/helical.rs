//! The screw: a turn about z with an advance along it.

use super::Factor;

pub(super) fn factors(lead: f64) -> Vec<Factor> {
    vec![Factor::Screw { lead }]
}
