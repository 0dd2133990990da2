//! Candidates of the search: an order of hand-offs with its speeds and blend radii.

use std::collections::BTreeMap;

/// A program that the search proposes.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Order of its hand-offs; 0 is that of the program.
    pub order: usize,
    /// Speed and blend radius of all motions but those of `stations`.
    pub settings: MotionSettings,
    /// Stations whose hand-offs have settings of their own, by index.
    pub stations: BTreeMap<usize, MotionSettings>,
}

/// Speed and blend radius of motions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionSettings {
    /// Share of the limits, above 0 and at most 1.
    pub speed: f64,
    /// Blend radius; 0 for none (m).
    pub blend_radius: f64,
}

impl MotionSettings {
    /// Full speed without blends.
    pub const FULL_SPEED: Self = Self { speed: 1.0, blend_radius: 0.0 };
}

impl Candidate {
    /// An order with one speed and one blend radius.
    #[must_use]
    pub fn uniform(order: usize, settings: MotionSettings) -> Self {
        Self { order, settings, stations: BTreeMap::new() }
    }

    /// Settings of the motions to a station and of the hand-offs there.
    #[must_use]
    pub fn settings_at(&self, station: usize) -> MotionSettings {
        self.stations.get(&station).copied().unwrap_or(self.settings)
    }
}
