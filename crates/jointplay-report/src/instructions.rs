//! The instruction set on which the numbers of a study depend.

use jointplay_core::bulk::instruction_set;
use jointplay_format::study::StudyFile;

/// The instruction set of this processor, if the numbers of a study depend on it.
pub(crate) fn instructions(study: &StudyFile) -> Option<&'static str> {
    study.plan.depends_on_processor().then(instruction_set)
}
