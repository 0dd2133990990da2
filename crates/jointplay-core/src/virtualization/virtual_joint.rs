//! Virtual joints, and their displacements.

use core::ops::{Deref, DerefMut};

/// The most virtual joints that a virtualization may have: four for each limb, twice what moves a socket in its plane.
pub const MAX_VIRTUAL_JOINTS: usize = 12;

/// Whether a virtual joint slides or turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VirtualJointKind {
    /// Its coordinate is a length (m).
    Linear,
    /// Its coordinate is an angle (rad).
    Angular,
}

/// One virtual joint of a virtualization.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VirtualJoint {
    /// The symbol that joints of this kind share, in ASCII, such as `phi`.
    pub symbol: &'static str,
    /// The limb it belongs to, counted from 0.
    pub limb: usize,
    /// Whether it slides or turns.
    pub motion: VirtualJointKind,
}

impl VirtualJoint {
    /// Three joints of one kind, one for each limb.
    pub(crate) const fn on_each_limb(symbol: &'static str, motion: VirtualJointKind) -> [Self; 3] {
        [
            Self { symbol, limb: 0, motion },
            Self { symbol, limb: 1, motion },
            Self { symbol, limb: 2, motion },
        ]
    }

    /// Two kinds on each limb: the first kind on all limbs, then the second.
    pub(crate) const fn pairs(
        first: (&'static str, VirtualJointKind),
        second: (&'static str, VirtualJointKind),
    ) -> [Self; 6] {
        let a = Self::on_each_limb(first.0, first.1);
        let b = Self::on_each_limb(second.0, second.1);
        [a[0], a[1], a[2], b[0], b[1], b[2]]
    }
}

/// Displacements X of up to [`MAX_VIRTUAL_JOINTS`] virtual joints, kept without allocating; reads as a slice.
#[derive(Clone, Copy, PartialEq)]
pub struct VirtualJoints {
    values: [f64; MAX_VIRTUAL_JOINTS],
    count: usize,
}

impl VirtualJoints {
    /// `count` zeros.
    ///
    /// # Panics
    /// If `count` exceeds [`MAX_VIRTUAL_JOINTS`].
    #[must_use]
    pub fn zeros(count: usize) -> Self {
        assert!(
            count <= MAX_VIRTUAL_JOINTS,
            "at most {MAX_VIRTUAL_JOINTS} virtual joints, not {count}"
        );
        Self { values: [0.0; MAX_VIRTUAL_JOINTS], count }
    }
}

impl Deref for VirtualJoints {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

impl DerefMut for VirtualJoints {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values[..self.count]
    }
}

impl core::fmt::Debug for VirtualJoints {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter.debug_list().entries(self.iter()).finish()
    }
}
