//! Ranges in the notation `FROM:TO:STEP`.

use crate::number::{number, rounded};

/// Largest number of values of a range.
pub const MOST: usize = 1_000_000;

/// Error in the text of a range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A text other than three numbers with colons between them.
    #[error("invalid range {text:?}: expected FROM:TO:STEP, such as -2:2:0.2")]
    Form {
        /// What was found.
        text: String,
    },
    /// A number that is NaN or infinite.
    #[error("a number of the range is {}, but has to be finite", number(*.value))]
    NotFinite {
        /// What was found.
        value: f64,
    },
    /// A step that is zero or has the opposite sign of the range.
    #[error("a step of {} does not lead from {} to {}", number(*.step), number(*.from), number(*.to))]
    Direction {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Step.
        step: f64,
    },
    /// A step that does not divide the range.
    #[error(
        "steps of {} from {} miss {}: the range is {} steps long; a step of {} fits",
        number(*.step),
        number(*.from),
        number(*.to),
        rounded(*.intervals, 6),
        number(*.nearest)
    )]
    Misses {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// Step.
        step: f64,
        /// Length of the range in steps.
        intervals: f64,
        /// A similar step that divides the range.
        nearest: f64,
    },
    /// Too many values.
    #[error("the range has {} values, at most {MOST} are allowed", number(*.found))]
    TooMany {
        /// Number of values.
        found: f64,
    },
}

/// The values of `FROM:TO:STEP`, both ends included; a single number is a range of one value.
///
/// Every value is the double nearest to its decimal: rounding errors do not accumulate.
///
/// # Errors
/// [`Error`]: not of the form, not finite, a zero or reversed step, a step that misses the end, too many values.
pub fn parse(text: &str) -> Result<Vec<f64>, Error> {
    let numbers: Vec<f64> = text
        .split(':')
        .map(|part| part.trim().parse())
        .collect::<Result<_, _>>()
        .map_err(|_| Error::Form { text: text.to_owned() })?;
    if let Some(&value) = numbers.iter().find(|value| !value.is_finite()) {
        return Err(Error::NotFinite { value });
    }
    match numbers[..] {
        [value] => Ok(vec![value]),
        [from, to, step] => spread(from, to, step),
        _ => Err(Error::Form { text: text.to_owned() }),
    }
}

/// Values from `from` to `to` by `step`, both ends included, in the unit of its arguments.
///
/// # Errors
/// As [`parse`].
pub fn spread(from: f64, to: f64, step: f64) -> Result<Vec<f64>, Error> {
    let intervals = (to - from) / step;
    if !(intervals >= 0.0 && step != 0.0) {
        return Err(Error::Direction { from, to, step });
    }
    let whole = intervals.round();
    #[expect(clippy::cast_precision_loss, reason = "far below 2⁵³")]
    let most = MOST as f64;
    if whole >= most {
        return Err(Error::TooMany { found: whole + 1.0 });
    }
    if !is_whole(intervals) {
        let nearest = shortest_fitting(to - from, (to - from) / whole.max(1.0));
        return Err(Error::Misses { from, to, step, intervals, nearest });
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked above")]
    let count = whole as u32;
    // Counted in units of the last decimal, which are whole numbers: each value is one division away from its decimal.
    let unit = 10_f64.powi(decimals(from).max(decimals(step)));
    let (first, stride) = ((from * unit).round(), (step * unit).round());
    let at = |i: u32| if i == count { to } else { (first + stride * f64::from(i)) / unit };
    Ok(if count == 0 { vec![from] } else { (0..=count).map(at).collect() })
}

/// Whether a number of steps is whole, up to the rounding of decimal input.
fn is_whole(intervals: f64) -> bool {
    let whole = intervals.round();
    (intervals - whole).abs() <= 1e-9 * whole.max(1.0)
}

/// The decimal with the fewest digits near `step` that divides `range` into whole steps.
fn shortest_fitting(range: f64, step: f64) -> f64 {
    let rounded = |digits: usize| format!("{step:.digits$e}").parse::<f64>().ok();
    (0..16).filter_map(rounded).find(|&short| is_whole(range / short)).unwrap_or(step)
}

/// Fractional digits of the shortest decimal that represents a number; at most 15.
fn decimals(value: f64) -> i32 {
    let text = format!("{value}");
    let digits = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    i32::try_from(digits.min(15)).unwrap_or(15)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_equal_their_decimals() {
        let values = parse("-2:2:0.2").unwrap();
        assert_eq!(values.len(), 21);
        assert_eq!((values[0], values[7], values[10], values[20]), (-2.0, -0.6, 0.0, 2.0));
        let uneven = parse("-0.7:1.1:0.1").unwrap();
        assert_eq!((uneven[3], uneven[6], uneven[7], uneven[18]), (-0.4, -0.1, 0.0, 1.1));
        assert_eq!(parse("0:1:0.3333333333333333").unwrap().len(), 4);
        assert_eq!(parse("0:360:10").unwrap().len(), 37);
        assert_eq!(parse("1.5").unwrap(), [1.5]);
        assert_eq!(parse("2:2:1").unwrap(), [2.0]);
        assert_eq!(parse("1:0:-0.5").unwrap(), [1.0, 0.5, 0.0]);
    }

    #[track_caller]
    fn refuse(text: &str, message: &str) {
        let error = parse(text).unwrap_err().to_string();
        assert!(error.contains(message), "{text}: {error}");
    }

    #[test]
    fn invalid_ranges_are_rejected() {
        refuse("", "expected FROM:TO:STEP");
        refuse("1:2", "expected FROM:TO:STEP");
        refuse("1:2:3:4", "expected FROM:TO:STEP");
        refuse("a:b:c", "expected FROM:TO:STEP");
        refuse("0:nan:1", "finite");
        refuse("0:inf:1", "finite");
        refuse("0:1:0", "does not lead");
        refuse("2:-2:0.2", "does not lead");
        refuse("0:1:0.3", "a step of 0.333333333 fits");
        refuse("-2:2:0.003", "a step of 0.00300075019 fits");
        refuse("0:1:1e-9", "at most 1000000");
    }
}
