//! What can go wrong in a study.

use jointplay_core::spatial::Tilt;

/// Why a study has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A study without poses.
    #[error(
        "the study has no poses: yaw has {yaws} values and pitch {pitches}, each needs at least one"
    )]
    Empty {
        /// Number of yaw values.
        yaws: usize,
        /// Number of pitch values.
        pitches: usize,
    },
    /// One pose cannot be computed.
    #[error("sample {sample} (yaw {}°, pitch {}°): {source}", yaw.to_degrees(), pitch.to_degrees())]
    Pose {
        /// Which sample, counted from 0.
        sample: usize,
        /// Its yaw [rad].
        yaw: f64,
        /// Its pitch [rad].
        pitch: f64,
        /// Why.
        source: Box<jointplay_core::Error>,
    },
}

impl Error {
    pub(crate) fn pose(sample: usize, tilt: Tilt, source: jointplay_core::Error) -> Self {
        Self::Pose { sample, yaw: tilt.yaw, pitch: tilt.pitch, source: Box::new(source) }
    }
}
