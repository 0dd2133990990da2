//! Errors of exports.

use jointplay_cell::CellError;
use jointplay_format::number::number;
use jointplay_format::place::{Errors, suggestion};
use jointplay_format::units::um;

use super::dialect::Problem;

/// Error of an export of a motion.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A sampling rate that is not positive.
    #[error("the sampling rate must be positive, got {rate} Hz; use a rate such as 100 Hz")]
    Rate {
        /// The rate found (Hz).
        rate: f64,
    },
    /// A tolerance that is not positive.
    #[error("the largest deviation of the 3D scene must be positive, got {} µm; use one such as 1 µm", number(um(*tolerance)))]
    Tolerance {
        /// The tolerance found (m).
        tolerance: f64,
    },
    /// Times of configurations that do not grow.
    #[error(
        "times of configurations must grow in single precision, but {} s is followed by {} s",
        number(*time),
        number(*next)
    )]
    Times {
        /// Time of a configuration (s).
        time: f64,
        /// Time of the next one (s).
        next: f64,
    },
    /// As many times as configurations were expected.
    #[error("expected a time for each of {configurations} configurations, got {times} times")]
    TimeCount {
        /// Number of times.
        times: usize,
        /// Number of configurations.
        configurations: usize,
    },
    /// A duration that is not positive.
    #[error("the duration must be positive, got {} s; use one such as 4 s", number(*duration))]
    Duration {
        /// The duration found (s).
        duration: f64,
    },
    /// Coordinates that are not those of the mechanism.
    #[error("a configuration of the motion: {0}")]
    Configuration(#[from] jointplay_core::Error),
    /// A file of parts that cannot be animated.
    #[error(transparent)]
    Parts(#[from] super::gltf::parts_error::PartsError),
    /// Too many samples.
    #[error(
        "the motion has {found:.0} samples at this rate, but at most {allowed:.0} are allowed; use a lower rate"
    )]
    TooManySamples {
        /// Number of samples.
        found: f64,
        /// Number allowed.
        allowed: f64,
    },
    /// A window of time outside of the motion.
    #[error(
        "the window from {} s to {} s is not within the motion, which takes {duration:.3} s: a window starts at 0 s or later, before the motion ends, and ends after it starts",
        number(*from), number(*to)
    )]
    Window {
        /// Start of the window (s).
        from: f64,
        /// End of the window (s).
        to: f64,
        /// Duration of the motion (s).
        duration: f64,
    },
    /// A window between two samples.
    #[error(
        "no sample at {} Hz is between {} s and {} s; use a higher rate or a longer window",
        number(*rate), number(*from), number(*to)
    )]
    NoSamples {
        /// The rate (Hz).
        rate: f64,
        /// Start of the window (s).
        from: f64,
        /// End of the window (s).
        to: f64,
    },
    /// An unknown column of the table of samples.
    #[error(
        "column or group `{found}` is not known{}\ngroups: {groups}; the name of an axis, of an effector, and of a column without its unit\ncolumns: {columns}",
        suggestion(nearest)
    )]
    UnknownColumn {
        /// The name found.
        found: String,
        /// The most similar known name.
        nearest: Option<String>,
        /// All groups.
        groups: String,
        /// All columns.
        columns: String,
    },
    /// A name that no frame of the robot has.
    #[error(
        "frame `{found}` is not known{}\nframes: {}",
        suggestion(nearest),
        known.join(", ")
    )]
    UnknownFrame {
        /// The name found.
        found: String,
        /// The most similar known name.
        nearest: Option<String>,
        /// Names of rods, platform, links and effectors.
        known: Vec<String>,
    },
    /// The pose of the robot is unknown at a sample.
    #[error("the pose of the robot at {time:.3} s cannot be computed: {source}")]
    Placing {
        /// Time of the sample (s).
        time: f64,
        /// Reason.
        source: Box<CellError>,
    },
    /// A motion that a dialect cannot express: an expression without a value, or a station without a code.
    #[error(transparent)]
    Dialect(Errors<Problem>),
    /// A file that is too large for its format.
    #[error("the file would have {bytes} bytes, more than glTF allows; use a lower rate")]
    TooLarge {
        /// Size of the file (bytes).
        bytes: usize,
    },
    /// Messages that do not fit the format.
    #[cfg(feature = "mcap")]
    #[error("the motion cannot be written as MCAP; use a lower rate, or csv")]
    Mcap,
    /// Too many poses for a format that is written at once.
    #[error(
        "the motion has {found:.0} poses of frames at this rate, but this format allows at most {allowed:.0}; use a lower rate, or csv, text or solidworks, which are written in parts"
    )]
    TooManyPoses {
        /// Number of poses.
        found: f64,
        /// Number allowed.
        allowed: f64,
    },
}
