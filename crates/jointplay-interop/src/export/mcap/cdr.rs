//! Messages of ROS 2 as bytes: the Common Data Representation, little-endian.

/// Header of a message: the representation, without options.
const HEAD: [u8; 4] = [0, 1, 0, 0];

/// An incomplete message.
pub(super) struct Cdr(Vec<u8>);

/// Whole seconds and nanoseconds of a time (s).
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "nanoseconds of a day fit"
)]
pub(super) fn split(time: f64) -> (i32, u32) {
    let nanoseconds = (time.max(0.0) * 1e9).round() as u64;
    (
        i32::try_from(nanoseconds / 1_000_000_000).unwrap_or(i32::MAX),
        (nanoseconds % 1_000_000_000) as u32,
    )
}

impl Cdr {
    pub(super) fn new() -> Self {
        Self(HEAD.to_vec())
    }

    pub(super) fn finish(self) -> Vec<u8> {
        self.0
    }

    /// Pads to a multiple of a number's size, counted after the header.
    fn align(&mut self, size: usize) {
        while !(self.0.len() - HEAD.len()).is_multiple_of(size) {
            self.0.push(0);
        }
    }

    fn word(&mut self, value: u32) {
        self.align(4);
        self.0.extend(value.to_le_bytes());
    }

    /// Writes the length of a sequence.
    pub(super) fn count(&mut self, count: usize) {
        self.word(u32::try_from(count).unwrap_or(u32::MAX));
    }

    pub(super) fn string(&mut self, text: &str) {
        // The length includes the zero at the end.
        self.count(text.len() + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    pub(super) fn strings(&mut self, texts: &[&str]) {
        self.count(texts.len());
        texts.iter().for_each(|text| self.string(text));
    }

    pub(super) fn numbers(&mut self, values: &[f64]) {
        self.count(values.len());
        self.fixed(values);
    }

    /// Numbers of an array with a fixed length.
    pub(super) fn fixed(&mut self, values: &[f64]) {
        for value in values {
            self.align(8);
            self.0.extend(value.to_le_bytes());
        }
    }

    /// A time or a duration (s).
    pub(super) fn time(&mut self, time: f64) {
        let (sec, nanosec) = split(time);
        self.word(sec.cast_unsigned());
        self.word(nanosec);
    }

    pub(super) fn header(&mut self, time: f64, frame: &str) {
        self.time(time);
        self.string(frame);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_to_their_size() {
        let mut message = Cdr::new();
        message.string("ab");
        message.numbers(&[1.5]);
        let expected: Vec<u8> =
            [&HEAD[..], &[3, 0, 0, 0, b'a', b'b', 0, 0], &[1, 0, 0, 0, 0, 0, 0, 0]].concat();
        assert_eq!(message.0[..20], expected);
        assert_eq!(message.0[20..], 1.5_f64.to_le_bytes());
    }

    #[test]
    fn times_are_rounded_to_nanoseconds() {
        for (time, expected) in
            [(0.0, (0, 0)), (1.25, (1, 250_000_000)), (2.999_999_999_9, (3, 0)), (-1.0, (0, 0))]
        {
            assert_eq!(split(time), expected, "{time}");
        }
    }
}
