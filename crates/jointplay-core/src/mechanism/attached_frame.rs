//! Frames of a mechanism: those of its links, and those that the user attaches to links.

use crate::spatial::Pose;

/// A frame that the user attaches to a link, such as the center of a platform.
#[derive(Debug, Clone, PartialEq)]
pub struct AttachedFrame {
    /// Name, unique among the attached frames and the links.
    pub name: String,
    /// Index of the link that it moves with.
    pub link: usize,
    /// Its pose in the frame of the link (m).
    pub link_from_frame: Pose,
}

/// A frame whose motion is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FrameId {
    /// The frame of a link, by its index among the links.
    Link(usize),
    /// An attached frame, by its index among the attached frames.
    Attached(usize),
}
