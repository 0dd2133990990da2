//! A study file; shared by the tests of several crates.

use jointplay_format::study::{StudyFile, included, parse};

/// A study of a robot with values of all kinds.
pub(crate) const STUDY: &str = r#"kind = "study"
name = "a study"
robot = "gpr"
virtualizations = ["planar", "polar"]
solver = "newton"
metric = 12.5
samples = 100
seed = 9
quantities = ["q1_mm", "center_shift_um", "virtual_joints"]

[pose]
azimuth_deg = { uniform = [0, 360] }
tilt_deg = "-1:1:0.5"
height_mm = [480.1, 500]

[tolerances]
base_x_mm = { normal = [0, 0.01] }
"#;

/// Reads a study without errors.
pub(crate) fn study(text: &str) -> StudyFile {
    parse(text, &mut included).unwrap_or_else(|error| panic!("{}", error.with_excerpt("s.toml")))
}
