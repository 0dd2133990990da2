//! Times at which the poses of the links are unknown.

use super::link_poses::PoseError;
use crate::violation::{IntervalMerger, SampleTime, SampleViolation, Subject, ViolationQuantity};

/// A time at which the poses of the links are unknown, with the reason.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct UnknownPose {
    pub(crate) at: SampleTime,
    pub(crate) error: PoseError,
}

impl UnknownPose {
    /// Adds a violation: an unknown distance does not satisfy a clearance.
    pub(crate) fn report(self, violations: &mut IntervalMerger) {
        let Self { at, error: PoseError { kind, reason } } = self;
        let subject = Subject::of(kind);
        let (severity, value, limit, quantity) = (0.0, 0.0, 0.0, ViolationQuantity::None);
        let violation = SampleViolation { subject, kind, severity, value, limit, quantity };
        violations.add(at, violation, || reason);
    }
}
