//! The slider: along z.

use super::Factor;

pub(super) fn factors() -> Vec<Factor> {
    vec![Factor::slide(2)]
}
