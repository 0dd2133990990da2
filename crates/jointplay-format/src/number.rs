//! Numbers as messages show them.

/// Significant digits of a number that a message repeats: enough for every number that is typed.
const DIGITS: usize = 12;

/// A number for a message, with at most twelve significant digits.
///
/// Long or short numbers get an exponent, zero has no sign, and a value that is not finite is described in words.
#[must_use]
pub fn number(value: f64) -> String {
    rounded(value, DIGITS)
}

/// A computed number for a message, rounded to `digits` significant digits.
///
/// # Arguments
/// * `digits` – at least 1
#[must_use]
pub fn rounded(value: f64, digits: usize) -> String {
    if value.is_nan() {
        return "not a number".to_owned();
    }
    if value.is_infinite() {
        return if value > 0.0 { "infinite" } else { "minus infinite" }.to_owned();
    }
    let digits = digits.clamp(1, 17);
    let scientific = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if value != 0.0 && !(-5..12).contains(&exponent) {
        return format!("{}e{exponent}", without_zeros(mantissa));
    }
    let decimals = usize::try_from(i32::try_from(digits).unwrap_or(0) - 1 - exponent).unwrap_or(0);
    let plain = format!("{value:.decimals$}");
    let plain = without_zeros(&plain);
    if plain == "-0" { "0".to_owned() } else { plain.to_owned() }
}

/// A decimal without zeros at the end of its fraction.
fn without_zeros(decimal: &str) -> &str {
    if decimal.contains('.') {
        decimal.trim_end_matches('0').trim_end_matches('.')
    } else {
        decimal
    }
}

/// A number with fixed decimals, without a minus before zero; a dash for one that is not finite.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    // Beyond this size a double has no decimals.
    if value.abs() >= 1e12 {
        return rounded(value, 6);
    }
    let text = format!("{value:.decimals$}");
    let zero = text.chars().all(|letter| matches!(letter, '-' | '0' | '.'));
    if zero { text.replace('-', "") } else { text }
}

/// A share in %; very large shares, such as of a limit of zero, are shown as >9999.
#[must_use]
pub fn percent(share: f64) -> String {
    if share.is_finite() && share < 99.995 { fixed(100.0 * share, 0) } else { ">9999".to_owned() }
}

/// A count with its noun, whose plural ends in s: `1 loop`, `2 loops`.
#[must_use]
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// A number of entries: `1 entry`, `2 entries`.
pub fn entries(count: usize) -> String {
    if count == 1 { "1 entry".to_owned() } else { format!("{count} entries") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_finite_in_messages() {
        for (value, shown) in [
            (1.5, "1.5"),
            (-0.0, "0"),
            (754.0000001, "754.0000001"),
            (1e308, "1e308"),
            (-1.7505345285313506e-17, "-1.75053452853e-17"),
            (200.04811917523034, "200.048119175"),
            (1e6, "1000000"),
            (1e-5, "0.00001"),
            (5e-324, "4.94065645841e-324"),
            (f64::NAN, "not a number"),
            (f64::INFINITY, "infinite"),
            (f64::NEG_INFINITY, "minus infinite"),
            (99_999_999_999_999.9, "1e14"),
        ] {
            assert_eq!(number(value), shown);
        }
        assert_eq!(rounded(200.04811917523034, 6), "200.048");
        assert_eq!(rounded(123_456_789.0, 3), "123456789");
    }

    #[test]
    fn nouns_have_a_singular() {
        assert_eq!([counted(0, "loop"), counted(1, "loop")], ["0 loops", "1 loop"]);
    }
}
