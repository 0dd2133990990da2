//! Errors of a study.

use jointplay_core::spatial::Tilt;

/// Why a study has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A study without poses.
    #[error(
        "the study has no poses: azimuth has {azimuths} values and the tilt angle {tilt_angles}, each needs at least one"
    )]
    Empty {
        /// Number of azimuth values.
        azimuths: usize,
        /// Number of tilt angle values.
        tilt_angles: usize,
    },
    /// A motion with fewer than two key poses.
    #[error("the motion has {found} key poses, it needs at least two")]
    FewKeyPoses {
        /// How many there are.
        found: usize,
    },
    /// A number that has to be positive and finite.
    #[error("{what} is {value}, it has to be positive")]
    NotPositive {
        /// Name of the quantity.
        what: &'static str,
        /// Value found.
        value: f64,
    },
    /// One pose cannot be computed.
    #[error("sample {sample} (azimuth {}°, tilt angle {}°): {source}", azimuth.to_degrees(), tilt_angle.to_degrees())]
    Pose {
        /// Which sample, counted from 0.
        sample: usize,
        /// Its azimuth (rad).
        azimuth: f64,
        /// Its tilt angle (rad).
        tilt_angle: f64,
        /// Why.
        source: Box<jointplay_core::Error>,
    },
    /// Something that is varied over no values at all.
    #[error("the study has no samples: whatever varies needs at least one value")]
    NoValues,
    /// More samples than can be counted.
    #[error(
        "{} values × {draws} draws are more samples than can be counted: at most 2⁶³ − 1",
        values.iter().map(u64::to_string).collect::<Vec<_>>().join(" × ")
    )]
    TooManySamples {
        /// Number of values of each quantity that varies.
        values: Vec<u64>,
        /// Number of draws.
        draws: u64,
    },
    /// A sample beyond the end of the study.
    #[error("there is no sample {found}: they are numbered from 0, and there are {count}")]
    NoSuchSample {
        /// Which one.
        found: u64,
        /// How many there are.
        count: u64,
    },
    /// A chunk beyond the end of the study.
    #[error("there is no chunk {found}: they are numbered from 0, and there are {count}")]
    NoSuchChunk {
        /// Which one.
        found: u64,
        /// How many there are.
        count: u64,
    },
    /// A virtualization that the study does not have.
    #[error("there is no virtualization {found}: they are numbered from 0, and there are {count}")]
    NoSuchModel {
        /// Which one.
        found: usize,
        /// How many there are.
        count: usize,
    },
    /// An error of the core that concerns all samples.
    #[error(transparent)]
    Core(#[from] jointplay_core::Error),
}

impl Error {
    pub(crate) fn pose(sample: usize, tilt: Tilt, source: jointplay_core::Error) -> Self {
        Self::Pose {
            sample,
            azimuth: tilt.azimuth,
            tilt_angle: tilt.angle,
            source: Box::new(source),
        }
    }
}
