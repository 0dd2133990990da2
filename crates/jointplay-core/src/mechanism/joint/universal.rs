//! The Hooke joint: a turn about z, then about the turned x.

use super::Factor;

pub(super) fn factors() -> Vec<Factor> {
    vec![Factor::turn(2), Factor::turn(0)]
}
