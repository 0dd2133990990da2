//! Mechanisms from files of other programs. What a mechanism has no place for is listed, and never passed over in silence.

pub mod mjcf;
