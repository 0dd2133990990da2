//! No joint at all: all six freedoms.

use super::Factor;

pub(super) fn factors() -> Vec<Factor> {
    vec![Factor::slide(0), Factor::slide(1), Factor::slide(2), Factor::Ball]
}
