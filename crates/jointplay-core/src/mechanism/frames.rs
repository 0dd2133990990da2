//! The frames of a mechanism.

use super::attached_frame::{AttachedFrame, FrameId};
use super::description::Mechanism;
use super::mechanism_error::MechanismError;
use crate::spatial::Pose;

impl Mechanism {
    /// The same mechanism with these attached frames in place of its own.
    ///
    /// # Errors
    /// [`MechanismError`].
    pub fn with_frames(mut self, frames: Vec<AttachedFrame>) -> Result<Self, MechanismError> {
        let links = self.links().len();
        for AttachedFrame { name, link, link_from_frame } in &frames {
            if *link >= links {
                let (frame, link) = (name.clone(), *link);
                return Err(MechanismError::NoLinkOfFrame { frame, link, links });
            }
            let numbers = link_from_frame.to_homogeneous();
            if let Some(&value) = numbers.iter().find(|value| !value.is_finite()) {
                let (what, name) = ("the pose", name.clone());
                return Err(MechanismError::NotFinite { what, name, value });
            }
        }
        self.frames = frames;
        self.check_names()?;
        Ok(self)
    }

    /// The attached frames.
    #[must_use]
    pub fn frames(&self) -> &[AttachedFrame] {
        &self.frames
    }

    /// A frame by its name, or the name of its link.
    #[must_use]
    pub fn frame(&self, name: &str) -> Option<FrameId> {
        let attached = self.frames.iter().position(|frame| frame.name == name);
        attached.map(FrameId::Attached).or_else(|| self.link(name).map(FrameId::Link))
    }

    /// The frames of all links but the base, then the attached ones.
    pub fn moving_frames(&self) -> impl Iterator<Item = FrameId> + '_ {
        let links = (1..self.links().len()).map(FrameId::Link);
        links.chain((0..self.frames.len()).map(FrameId::Attached))
    }

    /// Name of a frame.
    ///
    /// # Panics
    /// For a frame that the mechanism does not have.
    #[must_use]
    pub fn frame_name(&self, frame: FrameId) -> &str {
        match frame {
            FrameId::Link(link) => &self.links()[link],
            FrameId::Attached(k) => &self.frames[k].name,
        }
    }

    /// Index of the link of a frame.
    ///
    /// # Panics
    /// For a frame that the mechanism does not have.
    #[must_use]
    pub fn link_of_frame(&self, frame: FrameId) -> usize {
        match frame {
            FrameId::Link(link) => link,
            FrameId::Attached(k) => self.frames[k].link,
        }
    }

    /// Pose of a frame in the frame of its link (m).
    ///
    /// # Panics
    /// For a frame that the mechanism does not have.
    #[must_use]
    pub fn link_from_frame(&self, frame: FrameId) -> Pose {
        match frame {
            FrameId::Link(_) => Pose::identity(),
            FrameId::Attached(k) => self.frames[k].link_from_frame,
        }
    }
    /// Pose of a frame in the base frame, from the poses of the links (m).
    ///
    /// # Arguments
    /// * `base_from_link` – pose of each link
    ///
    /// # Panics
    /// For a frame that the mechanism does not have.
    #[must_use]
    pub fn frame_pose(&self, frame: FrameId, base_from_link: &[Pose]) -> Pose {
        base_from_link[self.link_of_frame(frame)] * self.link_from_frame(frame)
    }
}
