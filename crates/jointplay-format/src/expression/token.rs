//! Tokens of expressions.

use std::borrow::Cow;
use std::ops::Range;

/// A token of an expression.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Token<'t> {
    pub(crate) kind: TokenKind<'t>,
    /// The token as written.
    pub(crate) text: &'t str,
    /// Column of its first character, counted from 1.
    pub(crate) column: usize,
    /// Its bytes.
    pub(crate) span: Range<usize>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum TokenKind<'t> {
    /// A number without a sign.
    Number(f64),
    /// A name.
    Name(Cow<'t, str>),
    /// Anything else: an operator, a parenthesis, a comma, or a character that no expression has.
    Sign,
}

/// The tokens of a text.
pub(super) fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut tokens, mut at, mut column) = (Vec::new(), 0, 1);
    loop {
        let rest = &text[at..];
        let blank = rest.len() - rest.trim_start().len();
        column += rest[..blank].chars().count();
        at += blank;
        let rest = &text[at..];
        let Some(first) = rest.chars().next() else { return tokens };
        let digits = number_length(rest);
        let (kind, length) = if starts_name(first) {
            let length = rest.find(|next| !continues_name(next)).unwrap_or(rest.len());
            (TokenKind::Name(Cow::Borrowed(&rest[..length])), length)
        } else if let (1.., Ok(value)) = (digits, rest[..digits].parse()) {
            (TokenKind::Number(value), digits)
        } else {
            (TokenKind::Sign, first.len_utf8())
        };
        let (text, span) = (&rest[..length], at..at + length);
        tokens.push(Token { kind, text, column, span });
        column += text.chars().count();
        at += length;
    }
}

/// Length of the decimal number without sign at the start of a text; 0 if there is none.
pub(crate) fn number_length(text: &str) -> usize {
    let text = text.as_bytes();
    let digits = |from: usize| {
        text[from.min(text.len())..].iter().take_while(|byte| byte.is_ascii_digit()).count()
    };
    let whole = digits(0);
    let mut end = whole;
    if text.get(end) == Some(&b'.') {
        let fraction = digits(end + 1);
        if whole + fraction == 0 {
            return 0;
        }
        end += 1 + fraction;
    } else if whole == 0 {
        return 0;
    }
    // Without digits, the letter `e` starts a name.
    if matches!(text.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

/// Whether a parameter can have this name: expressions cannot refer to other names.
pub(crate) fn is_free_name(name: &str) -> bool {
    let mut characters = name.chars();
    characters.next().is_some_and(starts_name) && characters.all(continues_name) && name != "pi"
}

fn starts_name(character: char) -> bool {
    character.is_alphabetic() || character == '_'
}

fn continues_name(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}
