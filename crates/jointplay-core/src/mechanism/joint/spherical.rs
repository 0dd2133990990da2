//! The ball.

use super::Factor;

pub(super) fn factors() -> Vec<Factor> {
    vec![Factor::Ball]
}
