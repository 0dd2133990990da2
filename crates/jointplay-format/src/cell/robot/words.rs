//! Fixed texts of robot files.

use jointplay_cell::robot::{AxisKind, RODS};

/// The `kind` of files of robots with arms.
pub const KIND: &str = "hybrid";

/// Names of the rods as axes.
pub(in super::super) const ROD_NAMES: [&str; RODS] = ["q1", "q2", "q3"];

/// Kinds of axes.
pub(super) const MOTIONS: [(&str, AxisKind); 2] =
    [("turn", AxisKind::Rotary), ("slide", AxisKind::Linear)];
