//! Exact decimal writing of n · 10^exponent: tick labels never pass through binary fractions.

/// The minus sign of typography, as wide as a plus.
const MINUS: char = '\u{2212}';

/// `n · 10^exponent` in plain digits.
pub(crate) fn plain(n: i64, exponent: i32) -> String {
    let digits = n.unsigned_abs().to_string();
    let body = if exponent >= 0 {
        let zeros = if n == 0 { 0 } else { exponent as usize };
        digits + &"0".repeat(zeros)
    } else {
        let places = exponent.unsigned_abs() as usize;
        let digits = format!("{digits:0>width$}", width = places + 1);
        let (whole, fraction) = digits.split_at(digits.len() - places);
        format!("{whole}.{fraction}")
    };
    if n < 0 { format!("{MINUS}{body}") } else { body }
}

/// `n · 10^exponent` in as few signs as it needs: `93.218`, or `1.5×10⁻²⁰` where digits are many.
pub(crate) fn short(n: i64, exponent: i32) -> String {
    let text = trimmed(n, exponent);
    if text.len() <= 14 {
        return text;
    }
    let top = n.unsigned_abs().to_string().len() as i32 - 1;
    format!("{}×{}", trimmed(n, -top), power_of_ten(exponent + top))
}

/// `n · 10^exponent` without zeros at the end of the fraction.
fn trimmed(n: i64, exponent: i32) -> String {
    let text = plain(n, exponent);
    if !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

/// `10ⁿ`.
pub(crate) fn power_of_ten(exponent: i32) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let mut text = String::from("10");
    if exponent < 0 {
        text.push('⁻');
    }
    text.extend(
        exponent.unsigned_abs().to_string().bytes().map(|digit| RAISED[(digit - b'0') as usize]),
    );
    text
}

/// The nearest number to `n · 10^exponent`.
pub(crate) fn value(n: i64, exponent: i32) -> f64 {
    format!("{n}e{exponent}").parse().expect("an integer, e and an integer is a number")
}

/// ⌊log10 `value`⌋ of a positive, finite value, right also where log10 rounds.
pub(crate) fn order(positive: f64) -> i32 {
    let guess = positive.log10().floor() as i32;
    if value(1, guess + 1) <= positive {
        guess + 1
    } else if value(1, guess) > positive {
        guess - 1
    } else {
        guess
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits() {
        for (n, exponent, expected) in [
            (932180, -4, "93.2180"),
            (-5, -1, "−0.5"),
            (5, -4, "0.0005"),
            (0, 3, "0"),
            (0, -2, "0.00"),
            (12, 3, "12000"),
        ] {
            assert_eq!(plain(n, exponent), expected);
        }
        assert_eq!(trimmed(932180, -4), "93.218");
        assert_eq!(trimmed(-9300, -2), "−93");
        assert_eq!(trimmed(100, 0), "100");
        assert_eq!(short(932180, -4), "93.218");
        assert_eq!(short(1500, -23), "1.5×10⁻²⁰");
        assert_eq!(power_of_ten(-13), "10⁻¹³");
    }

    #[test]
    fn orders() {
        for exponent in -320..308 {
            assert_eq!(order(value(1, exponent)), exponent, "1e{exponent}");
        }
        assert_eq!(order(999.9), 2);
    }
}
