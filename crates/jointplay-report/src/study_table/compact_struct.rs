//! Encoded structures of Thrift, as in the footer of a Parquet file: whether one is complete and of bounded cost.

/// Deepest nesting of structures and lists; that of a footer is 8.
const DEEPEST: usize = 16;

/// Kinds of values.
const STOP: u8 = 0;
const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const I16: u8 = 4;
const I64: u8 = 6;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const STRUCT: u8 = 12;
const UUID: u8 = 13;

/// Whether bytes are one structure whose lists have as many elements as they state.
///
/// Maps and lists of truth values, which no footer has, are refused: truth values in lists would take no bytes in some readers, and so any number of them no file.
///
/// # Source
/// \[Thrift\], compact protocol
pub(super) fn is_compact_struct(bytes: &[u8]) -> bool {
    let mut rest = Rest(bytes);
    rest.structure(DEEPEST).is_some() && rest.0.is_empty()
}

/// Bytes that were not yet passed.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, after) = self.0.split_first()?;
        self.0 = after;
        Some(*first)
    }

    fn pass(&mut self, count: u64) -> Option<()> {
        self.0 = self.0.get(usize::try_from(count).ok()?..)?;
        Some(())
    }

    /// A number in groups of seven bits, the lowest first.
    fn number(&mut self) -> Option<u64> {
        let mut number = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(number);
            }
        }
        None
    }

    fn structure(&mut self, depth: usize) -> Option<()> {
        loop {
            let head = self.byte()?;
            let kind = head & 0x0f;
            if kind == STOP {
                return Some(());
            }
            // A field that is far from the one before it has its whole number.
            if head >> 4 == 0 {
                self.number()?;
            }
            if !matches!(kind, TRUE | FALSE) {
                self.value(kind, depth)?;
            }
        }
    }

    fn value(&mut self, kind: u8, depth: usize) -> Option<()> {
        match kind {
            BYTE => self.pass(1),
            I16..=I64 => self.number().map(|_| ()),
            DOUBLE => self.pass(8),
            BINARY => {
                let length = self.number()?;
                self.pass(length)
            }
            LIST | SET => {
                let depth = depth.checked_sub(1)?;
                let head = self.byte()?;
                let count = match head >> 4 {
                    15 => self.number()?,
                    count => u64::from(count),
                };
                // Each element has a byte or more, so that their number is bounded by the rest.
                (0..count).try_for_each(|_| self.value(head & 0x0f, depth))
            }
            STRUCT => self.structure(depth.checked_sub(1)?),
            UUID => self.pass(16),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structures_are_complete_and_their_lists_as_long_as_stated() {
        // Fields 1: i32 2, 2: list of 2 binaries, 4: true, 20: structure with a double.
        let whole =
            [0x15, 4, 0x19, 0x28, 1, b'a', 0, 0x21, 0x0c, 40, 0x17, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        assert!(is_compact_struct(&whole));
        for cut in 0..whole.len() {
            assert!(!is_compact_struct(&whole[..cut]), "{cut}");
        }
        assert!(!is_compact_struct(&[&whole[..], &[0]].concat()));
    }

    #[test]
    fn lists_longer_than_the_file_truth_values_in_lists_maps_and_deep_nesting_are_refused() {
        let long = [0xff, 0xff, 0xff, 0xff, 7];
        let list_of = |kind: u8| [&[0x19, 0xf0 | kind][..], &long, &[0; 40]].concat();
        for kind in 0..16 {
            assert!(!is_compact_struct(&list_of(kind)), "{kind}");
        }
        assert!(!is_compact_struct(&[0x1b, 0, 0]));
        for (open, close) in [(&[0x1c][..], &[0][..]), (&[0x19, 0x1c], &[0])] {
            let nested = |depth| [open.repeat(depth), close.repeat(depth + 1)].concat();
            assert!(is_compact_struct(&nested(8)), "{open:?}");
            assert!(!is_compact_struct(&nested(17)), "{open:?}");
            assert!(!is_compact_struct(&nested(1_000_000)), "{open:?}");
        }
    }
}
