//! Status of each pose.

use crate::Error;
use crate::linalg::LinalgError;

/// Whether a pose is solved, or the reason why not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Status {
    /// The pose is solved.
    #[default]
    Solved = 0,
    /// A number given is NaN or infinite.
    NotFinite = 1,
    /// The tilt angle is ±90° or beyond.
    TiltTooLarge = 2,
    /// The iteration for the virtual joints did not converge.
    NotConverged = 3,
    /// The virtual joints cannot change the three sides independently there.
    DependentSides = 4,
    /// The virtual joints found mirror the platform.
    TurnedOver = 5,
    /// A rod or the tilt is beyond the robot's limits.
    BeyondLimits = 6,
    /// A virtual joint of a mechanism is beyond its clearance.
    BeyondClearance = 7,
}

impl Status {
    /// All of them, each at the index that is its number.
    pub const ALL: [Self; 8] = [
        Self::Solved,
        Self::NotFinite,
        Self::TiltTooLarge,
        Self::NotConverged,
        Self::DependentSides,
        Self::TurnedOver,
        Self::BeyondLimits,
        Self::BeyondClearance,
    ];

    /// The status in words, as shown to users.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::NotFinite => "not a finite number",
            Self::TiltTooLarge => "tilt angle of 90° or more",
            Self::NotConverged => "not converged",
            Self::DependentSides => "sides not independent",
            Self::TurnedOver => "turned over",
            Self::BeyondLimits => "beyond the limits",
            Self::BeyondClearance => "beyond the clearance",
        }
    }

    /// Gives the poses of a block that are not solved another status than solved.
    // Apart from the loops over blocks, whose registers its indices would take.
    #[cold]
    #[inline(never)]
    pub(super) fn mark(statuses: &mut [Self], solved: &[bool], otherwise: Self) {
        for (status, solved) in statuses.iter_mut().zip(solved) {
            if !solved {
                *status = otherwise;
            }
        }
    }

    /// The status of a pose that fails with an error; `None` for errors that concern all poses alike.
    #[must_use]
    pub fn from_error(error: &Error) -> Option<Self> {
        Some(match error {
            Error::NotFinite { .. } | Error::Linalg(LinalgError::NotFinite { .. }) => {
                Self::NotFinite
            }
            Error::TooLong { .. } | Error::BeyondLimits(_) => Self::BeyondLimits,
            Error::TiltTooLarge { .. } => Self::TiltTooLarge,
            Error::NotConverged(_)
            | Error::NotReached { .. }
            | Error::NotFollowed { .. }
            | Error::NotRelieved { .. }
            | Error::NotLeast { .. } => Self::NotConverged,
            Error::DependentSides { .. } => Self::DependentSides,
            Error::TurnedOver { .. } => Self::TurnedOver,
            _ => return None,
        })
    }
}

/// Number of poses by status.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StatusCounts {
    counts: [usize; Status::ALL.len()],
}

impl StatusCounts {
    /// Counts a column of statuses.
    #[must_use]
    pub fn of(statuses: &[Status]) -> Self {
        let mut tally = Self::default();
        // Nearly all poses have an answer; these are counted many at a time, in bytes that cannot overflow.
        let solved = |some: &[Status]| -> u8 {
            some.iter().map(|status| u8::from(*status == Status::Solved)).sum()
        };
        let solved = statuses.chunks(255).map(|some| usize::from(solved(some))).sum();
        tally.counts[Status::Solved as usize] = solved;
        if solved < statuses.len() {
            for status in statuses.iter().filter(|status| **status != Status::Solved) {
                tally.counts[*status as usize] += 1;
            }
        }
        tally
    }

    /// Number of poses with this status.
    #[must_use]
    pub fn count(&self, status: Status) -> usize {
        self.counts[status as usize]
    }

    /// How many poses have no answer.
    #[must_use]
    pub fn failed(&self) -> usize {
        self.counts[1..].iter().sum()
    }

    /// How many poses there are.
    #[must_use]
    pub fn poses(&self) -> usize {
        self.counts.iter().sum()
    }
}

impl std::ops::AddAssign for StatusCounts {
    fn add_assign(&mut self, other: Self) {
        for (count, more) in self.counts.iter_mut().zip(other.counts) {
            *count += more;
        }
    }
}

/// Such as `3 of 1000 poses have no answer: 2 not converged, 1 turned over`.
impl std::fmt::Display for StatusCounts {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.failed() == 0 {
            return write!(formatter, "all {} poses have an answer", self.poses());
        }
        write!(formatter, "{} of {} poses have no answer", self.failed(), self.poses())?;
        let reasons = Status::ALL[1..].iter().filter(|status| self.count(**status) > 0);
        for (place, status) in reasons.enumerate() {
            let before = if place == 0 { ':' } else { ',' };
            write!(formatter, "{before} {} {}", self.count(*status), status.name())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_words() {
        for (number, status) in Status::ALL.iter().enumerate() {
            assert_eq!(*status as usize, number);
        }
        assert_eq!(
            StatusCounts::of(&[Status::Solved; 3]).to_string(),
            "all 3 poses have an answer"
        );
        let mut tally =
            StatusCounts::of(&[Status::NotConverged, Status::Solved, Status::NotConverged]);
        tally += StatusCounts::of(&[Status::TurnedOver]);
        assert_eq!(
            tally.to_string(),
            "3 of 4 poses have no answer: 2 not converged, 1 turned over"
        );
        assert_eq!((tally.failed(), tally.poses(), tally.count(Status::NotConverged)), (3, 4, 2));
    }
}
