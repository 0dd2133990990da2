//! The text of the last error, in fixed memory.

use core::fmt;

/// Bytes of a message; longer ones are cut.
const LONGEST: usize = 512;

/// A text of at most 512 bytes, UTF-8.
#[derive(Debug)]
pub struct Message {
    bytes: [u8; LONGEST],
    length: usize,
}

impl Message {
    pub(crate) const EMPTY: Self = Self { bytes: [0; LONGEST], length: 0 };

    /// The bytes of the text.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.length]
    }

    /// Replaces the text by that of an error.
    pub(crate) fn set(&mut self, error: &dyn fmt::Display) {
        self.length = 0;
        // Writing here never fails.
        let _ = fmt::write(self, format_args!("{error}"));
    }
}

impl fmt::Write for Message {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for letter in text.chars() {
            let end = self.length + letter.len_utf8();
            let Some(room) = self.bytes.get_mut(self.length..end) else { break };
            letter.encode_utf8(room);
            self.length = end;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_messages_end_at_a_letter() {
        let mut message = Message::EMPTY;
        message.set(&"±".repeat(300));
        assert_eq!(std::str::from_utf8(message.bytes()).unwrap().chars().count(), 256);
        message.set(&format!("a{}", "±".repeat(300)));
        assert_eq!(message.bytes().len(), 511);
        message.set(&"short");
        assert_eq!(message.bytes(), b"short");
    }
}
