//! Text with fields in braces, where a doubled brace is the brace itself.

use std::iter::Peekable;
use std::ops::Range;
use std::str::CharIndices;

/// A brace without the other one, with its part of the text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Unpaired {
    Opening(Range<usize>),
    Closing(Range<usize>),
}

/// Plain text, and the span of the field that follows it, without braces; no field follows the last text.
pub(crate) type Piece = (String, Option<Range<usize>>);

/// The pieces of a text, from left to right; a brace without the other one is the last item.
pub(crate) struct Pieces<'t> {
    length: usize,
    letters: Peekable<CharIndices<'t>>,
    is_over: bool,
}

impl<'t> Pieces<'t> {
    pub(crate) fn of(text: &'t str) -> Self {
        Self { length: text.len(), letters: text.char_indices().peekable(), is_over: false }
    }

    fn piece(&mut self) -> Result<Piece, Unpaired> {
        let mut plain = String::new();
        while let Some((at, letter)) = self.letters.next() {
            match letter {
                '{' | '}' if self.letters.next_if(|(_, next)| *next == letter).is_some() => {
                    plain.push(letter);
                }
                '{' => {
                    let end = self.letters.find(|(_, letter)| *letter == '}');
                    let (end, _) = end.ok_or(Unpaired::Opening(at..self.length))?;
                    return Ok((plain, Some(at + 1..end)));
                }
                '}' => return Err(Unpaired::Closing(at..at + 1)),
                letter => plain.push(letter),
            }
        }
        Ok((plain, None))
    }
}

impl Iterator for Pieces<'_> {
    type Item = Result<Piece, Unpaired>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.is_over {
            return None;
        }
        let piece = self.piece();
        self.is_over = !matches!(piece, Ok((_, Some(_))));
        Some(piece)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pieces(text: &str) -> Vec<Result<Piece, Unpaired>> {
        Pieces::of(text).collect()
    }

    fn field(plain: &str, span: Range<usize>) -> Result<Piece, Unpaired> {
        Ok((plain.to_owned(), Some(span)))
    }

    #[test]
    fn fields_and_the_text_between_them() {
        let end = |plain: &str| Ok((plain.to_owned(), None));
        assert_eq!(pieces(""), [end("")]);
        assert_eq!(pieces("µ{a}{{b}}{}"), [field("µ", 3..4), field("{b}", 11..11), end("")]);
        assert_eq!(pieces("{a}{b} c"), [field("", 1..2), field("", 4..5), end(" c")]);
    }

    #[test]
    fn a_brace_without_the_other_one_is_the_last_piece() {
        assert_eq!(pieces("{a}b{c"), [field("", 1..2), Err(Unpaired::Opening(4..6))]);
        assert_eq!(pieces("a}{b}"), [Err(Unpaired::Closing(1..2))]);
        assert_eq!(pieces("{{{a"), [Err(Unpaired::Opening(2..4))]);
    }
}
