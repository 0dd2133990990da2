//! The hinge: a turn about z.

use super::Factor;

pub(super) fn factors() -> Vec<Factor> {
    vec![Factor::turn(2)]
}
