//! The plate on a plane: slides along x and y, a turn about z.

use super::Factor;

pub(super) fn factors() -> Vec<Factor> {
    vec![Factor::slide(0), Factor::slide(1), Factor::turn(2)]
}
