//! The sleeve: slide along z and turn about it.

use super::Factor;

pub(super) fn factors() -> Vec<Factor> {
    vec![Factor::slide(2), Factor::turn(2)]
}
