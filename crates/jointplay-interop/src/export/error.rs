//! Why a motion is not exported.

use jointplay_cell::CellError;

/// Why a motion is not exported.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A rate that is none.
    #[error("{rate} samples a second are none; ask for a rate above 0, such as 100")]
    Rate {
        /// What was asked for (Hz).
        rate: f64,
    },
    /// More samples than anybody reads.
    #[error("these are {found:.0} samples, at most {allowed:.0} are allowed; take a lower rate")]
    TooManySamples {
        /// How many there would be.
        found: f64,
        /// How many there may be.
        allowed: f64,
    },
    /// The robot is nowhere for the positions of a sample.
    #[error("at {time:.3} s the robot cannot be placed: {source}")]
    Placing {
        /// When (s).
        time: f64,
        /// Why.
        source: Box<CellError>,
    },
    /// More bytes than the format can count.
    #[error("the file would have {bytes} bytes, more than glTF can hold; take a lower rate")]
    TooLarge {
        /// How many there would be.
        bytes: usize,
    },
    /// The messages do not fit the format.
    #[cfg(feature = "mcap")]
    #[error("the motion cannot be written as MCAP; take a lower rate, or csv")]
    Mcap,
    /// More than a format can be written with at once.
    #[error(
        "these are {found:.0} poses of frames, this format is written with at most {allowed:.0}; take a lower rate, or csv, text or solidworks, which are written in parts"
    )]
    TooManyPoses {
        /// How many there would be.
        found: f64,
        /// How many there may be.
        allowed: f64,
    },
}
