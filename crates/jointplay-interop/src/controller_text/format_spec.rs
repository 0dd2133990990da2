//! Formats of values: the part after the colon of `{slot:02}`.
//!
//! ```text
//!    format  =  [[fill] align] [sign] ["0"] [width] ["." precision] [type]
//!    align   =  "<" | ">" | "^" | "="           sign  =  "+" | "-" | " "
//!    type    =  "s" | "d" | "x" | "X" | "o" | "b" | "f" | "e" | "E"
//! ```
//!
//! # Source
//! The format specification of Python without its options `z`, `#`, `,` and `_`.
//! Numbers with decimals have the type `f` without a type, and zero never has a minus sign, as with Python's option `z`.

use super::problem::Problem;

/// Largest width of a field.
const MOST_WIDTH: usize = 200;
/// Largest precision of a number: a double has no more digits.
const MOST_PRECISION: usize = 17;

/// Kind of a value in a template.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Text,
    Integer,
    /// A number with `decimals` of the dialect.
    Real,
    /// A time with `time_decimals` of the dialect (s).
    Time,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Text => "a text",
            Self::Integer => "a whole number",
            Self::Real | Self::Time => "a number with decimals",
        }
    }

    /// Description of the formats that such a value allows.
    fn allowed(self) -> &'static str {
        match self {
            Self::Text => "fill and alignment by <, > or ^, a width, a precision, and the type s",
            Self::Integer => {
                "fill and alignment, a sign, 0, a width, and one of the types d, x, X, o, b; with f, e or E also a precision"
            }
            Self::Real | Self::Time => {
                "fill and alignment, a sign, 0, a width, a precision, and one of the types f, e, E; round(…) makes a whole number"
            }
        }
    }
}

/// A value of a template.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Text(String),
    Integer(i64),
    /// A finite number.
    Real(f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Align {
    Left,
    Right,
    Center,
    /// Between sign and digits.
    AfterSign,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sign {
    /// Only of negative numbers.
    Minus,
    Plus,
    Space,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Type {
    Text,
    Decimal,
    Hexadecimal { upper: bool },
    Octal,
    Binary,
    Fixed,
    Exponent { upper: bool },
}

/// Format of a value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FormatSpec {
    fill: char,
    align: Align,
    sign: Sign,
    width: usize,
    precision: Option<usize>,
    type_: Type,
}

impl FormatSpec {
    /// Parses the format of a value of a kind.
    ///
    /// # Arguments
    /// * `decimals` – digits after the point of a number without a precision
    pub(crate) fn parse(text: &str, kind: Kind, decimals: usize) -> Result<Self, Problem> {
        let invalid = || Problem::Format {
            found: text.to_owned(),
            kind: kind.name(),
            allowed: kind.allowed(),
        };
        let mut rest: &[char] = &text.chars().collect::<Vec<_>>();
        let align_of = |letter: &char| match letter {
            '<' => Some(Align::Left),
            '>' => Some(Align::Right),
            '^' => Some(Align::Center),
            '=' => Some(Align::AfterSign),
            _ => None,
        };
        let (mut fill, mut align) = (None, None);
        if let [first, second, after @ ..] = rest
            && let Some(found) = align_of(second)
        {
            (fill, align, rest) = (Some(*first), Some(found), after);
        } else if let [first, after @ ..] = rest
            && let Some(found) = align_of(first)
        {
            (align, rest) = (Some(found), after);
        }
        let mut sign = None;
        if let [first @ ('+' | '-' | ' '), after @ ..] = rest {
            sign = Some(match first {
                '+' => Sign::Plus,
                ' ' => Sign::Space,
                _ => Sign::Minus,
            });
            rest = after;
        }
        let mut zero = false;
        if let ['0', after @ ..] = rest {
            (zero, rest) = (true, after);
        }
        let width = leading_number(&mut rest);
        let mut precision = None;
        if let ['.', after @ ..] = rest {
            rest = after;
            precision = Some(leading_number(&mut rest).ok_or_else(invalid)?);
        }
        let type_ = match rest {
            [] => match kind {
                Kind::Text => Type::Text,
                Kind::Integer => Type::Decimal,
                Kind::Real | Kind::Time => Type::Fixed,
            },
            ['s'] => Type::Text,
            ['d'] => Type::Decimal,
            ['x'] => Type::Hexadecimal { upper: false },
            ['X'] => Type::Hexadecimal { upper: true },
            ['o'] => Type::Octal,
            ['b'] => Type::Binary,
            ['f'] => Type::Fixed,
            ['e'] => Type::Exponent { upper: false },
            ['E'] => Type::Exponent { upper: true },
            _ => return Err(invalid()),
        };
        let is_decimal = matches!(type_, Type::Fixed | Type::Exponent { .. });
        let fits = match kind {
            Kind::Text => {
                let is_plain = sign.is_none() && !zero && align != Some(Align::AfterSign);
                is_plain && type_ == Type::Text
            }
            Kind::Integer => type_ != Type::Text && (precision.is_none() || is_decimal),
            Kind::Real | Kind::Time => is_decimal,
        };
        let most_precision = if kind == Kind::Text { MOST_WIDTH } else { MOST_PRECISION };
        if !fits || width > Some(MOST_WIDTH) || precision > Some(most_precision) {
            return Err(invalid());
        }
        let by_default = match kind {
            Kind::Text => Align::Left,
            _ if zero => Align::AfterSign,
            _ => Align::Right,
        };
        Ok(Self {
            fill: fill.unwrap_or(if zero { '0' } else { ' ' }),
            align: align.unwrap_or(by_default),
            sign: sign.unwrap_or(Sign::Minus),
            width: width.unwrap_or(0),
            precision: precision.or(is_decimal.then_some(decimals)),
            type_,
        })
    }

    /// Whether fill can be written before or after a value.
    pub(crate) fn pads(&self) -> bool {
        self.width > 0
    }

    /// Whether the format is that of a whole number.
    pub(crate) fn names_whole_type(text: &str) -> bool {
        text.ends_with(['d', 'x', 'X', 'o', 'b'])
    }

    /// A value in this format.
    pub(crate) fn apply(&self, value: &Value) -> String {
        let (negative, digits) = match value {
            Value::Text(text) => {
                let shown = text.chars().take(self.precision.unwrap_or(usize::MAX)).collect();
                return self.padded("", shown);
            }
            Value::Integer(value) => (*value < 0, self.whole(*value)),
            Value::Real(value) => (*value < 0.0, self.decimal(value.abs())),
        };
        let sign = match self.sign {
            _ if negative && !self.is_zero(&digits) => "-",
            Sign::Minus => "",
            Sign::Plus => "+",
            Sign::Space => " ",
        };
        self.padded(sign, digits)
    }

    /// Whether a number with decimals is rounded to zero.
    fn is_zero(&self, digits: &str) -> bool {
        let mantissa = digits.split(['e', 'E']).next().unwrap_or_default();
        matches!(self.type_, Type::Fixed | Type::Exponent { .. })
            && mantissa.chars().all(|digit| matches!(digit, '0' | '.'))
    }

    fn whole(&self, value: i64) -> String {
        let value_without_sign = value.unsigned_abs();
        match self.type_ {
            Type::Hexadecimal { upper: false } => format!("{value_without_sign:x}"),
            Type::Hexadecimal { upper: true } => format!("{value_without_sign:X}"),
            Type::Octal => format!("{value_without_sign:o}"),
            Type::Binary => format!("{value_without_sign:b}"),
            Type::Fixed | Type::Exponent { .. } => self.decimal(value_without_sign as f64),
            Type::Text | Type::Decimal => value_without_sign.to_string(),
        }
    }

    /// A number that is not negative, with decimals.
    fn decimal(&self, value: f64) -> String {
        let precision = self.precision.unwrap_or(0);
        let Type::Exponent { upper } = self.type_ else { return format!("{value:.precision$}") };
        let text = format!("{value:.precision$e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let letter = if upper { 'E' } else { 'e' };
        let (sign, digits) = match exponent.strip_prefix('-') {
            Some(digits) => ('-', digits),
            None => ('+', exponent),
        };
        format!("{mantissa}{letter}{sign}{digits:0>2}")
    }

    fn padded(&self, sign: &str, text: String) -> String {
        let missing = self.width.saturating_sub(sign.chars().count() + text.chars().count());
        let fill = |count: usize| self.fill.to_string().repeat(count);
        match self.align {
            Align::Left => format!("{sign}{text}{}", fill(missing)),
            Align::Right => format!("{}{sign}{text}", fill(missing)),
            Align::AfterSign => format!("{sign}{}{text}", fill(missing)),
            Align::Center => {
                format!("{}{sign}{text}{}", fill(missing / 2), fill(missing - missing / 2))
            }
        }
    }
}

/// The number at the start of the text, which is then passed; `usize::MAX` for one that is too large.
fn leading_number(rest: &mut &[char]) -> Option<usize> {
    let count = rest.iter().take_while(|letter| letter.is_ascii_digit()).count();
    let digits: String = rest[..count].iter().collect();
    *rest = &rest[count..];
    (count > 0).then(|| digits.parse().unwrap_or(usize::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_agree_with_python() {
        let table = include_str!("../../golden/controller-formats.csv");
        let mut rows = 0;
        for record in csv::Reader::from_reader(table.as_bytes()).records() {
            let record = record.unwrap();
            let [kind, format, value, text] = [0, 1, 2, 3].map(|column| &record[column]);
            let (kind, value) = match kind {
                "integer" => (Kind::Integer, Value::Integer(value.parse().unwrap())),
                "real" => (Kind::Real, Value::Real(value.parse().unwrap())),
                _ => (Kind::Text, Value::Text(value.to_owned())),
            };
            let spec = FormatSpec::parse(format, kind, 6).unwrap();
            assert_eq!(spec.apply(&value), text, "{format:?} of {value:?}");
            rows += 1;
        }
        assert!(rows > 100, "{rows}");
    }

    #[test]
    fn formats_that_do_not_fit_the_value_are_rejected() {
        let kinds = [Kind::Text, Kind::Integer, Kind::Real];
        for (format, fits) in [
            ("", [true, true, true]),
            ("5", [true, true, true]),
            ("*^5", [true, true, true]),
            ("s", [true, false, false]),
            (".3", [true, false, true]),
            ("05", [false, true, true]),
            ("=5", [false, true, true]),
            ("+", [false, true, true]),
            ("d", [false, true, false]),
            ("X", [false, true, false]),
            (".2f", [false, true, true]),
            ("E", [false, true, true]),
            (",", [false; 3]),
            ("#x", [false; 3]),
            ("g", [false; 3]),
            ("5.f", [false; 3]),
            ("201", [false; 3]),
            (".18f", [false; 3]),
            ("<40.40", [true, false, false]),
            (".201", [false; 3]),
            ("99999999999999999999999", [false; 3]),
        ] {
            let found = kinds.map(|kind| FormatSpec::parse(format, kind, 6).is_ok());
            assert_eq!(found, fits, "{format}");
        }
    }
}
