//! Digests of studies and files.

use std::fmt::Write as _;

use jointplay_format::study::StudyFile;
use serde_json::Value;

use crate::instructions::instructions;
use crate::sha256::sha256;

/// Version of this program.
pub(super) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The version that wrote a file of a folder of parts, if it is not this one; its keys may be others.
pub(super) fn other_version(file: &Value) -> Option<&str> {
    file["jointplay"].as_str().filter(|found| *found != VERSION)
}

/// SHA-256, in hexadecimal, of everything that decides the numbers of a study, with the version of the program and the rows of a part.
///
/// Studies of mechanisms and cells include the instruction set of the processor, see [`Study::depends_on_processor`](jointplay_study::plan::Study::depends_on_processor).
/// Names and comments of the study file are not included.
#[must_use]
pub fn digest(study: &StudyFile) -> String {
    let mut text = format!("jointplay {VERSION}\nrows {}\n", study.plan.portions().chunk);
    if let Some(instructions) = instructions(study) {
        let _ = writeln!(text, "instructions {instructions}");
    }
    for (key, value) in study.facts() {
        let _ = writeln!(text, "{key} {} {value}", value.len());
    }
    sha256(text.as_bytes())
}
