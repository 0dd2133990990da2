//! Checksums of lines and files.

use crc::{Crc, Digest as CrcDigest};

/// A checksum over bytes.
///
/// # Source
/// The cyclic redundancy checks have the names of the catalogue of parametrised CRC algorithms; LRC is that of ISO 1155.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Checksum {
    /// XOR of all bytes.
    Xor,
    /// Sum of all bytes modulo 256.
    Sum,
    /// Two's complement of the sum of all bytes modulo 256.
    Lrc,
    /// CRC-16/XMODEM.
    Xmodem,
    /// CRC-16/IBM-3740, also known as CCITT-FALSE.
    CcittFalse,
    /// CRC-16/KERMIT, also known as CCITT.
    Kermit,
    /// CRC-16/MODBUS.
    Modbus,
    /// CRC-32/ISO-HDLC, that of zip and Ethernet.
    Crc32,
}

static XMODEM: Crc<u16> = Crc::<u16>::new(&crc::CRC_16_XMODEM);
static IBM_3740: Crc<u16> = Crc::<u16>::new(&crc::CRC_16_IBM_3740);
static KERMIT: Crc<u16> = Crc::<u16>::new(&crc::CRC_16_KERMIT);
static MODBUS: Crc<u16> = Crc::<u16>::new(&crc::CRC_16_MODBUS);
static ISO_HDLC: Crc<u32> = Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

impl Checksum {
    /// All of them, with their names in files.
    pub(crate) const ALL: [(&str, Self); 9] = [
        ("xor", Self::Xor),
        ("sum", Self::Sum),
        ("lrc", Self::Lrc),
        ("crc-16/xmodem", Self::Xmodem),
        ("crc-16/ccitt-false", Self::CcittFalse),
        ("crc-16/ibm-3740", Self::CcittFalse),
        ("crc-16/kermit", Self::Kermit),
        ("crc-16/modbus", Self::Modbus),
        ("crc-32", Self::Crc32),
    ];

    pub(crate) fn digest(self) -> Digest {
        match self {
            Self::Xor => Digest::Xor(0),
            Self::Sum => Digest::Sum(0),
            Self::Lrc => Digest::Lrc(0),
            Self::Xmodem => Digest::Crc16(XMODEM.digest()),
            Self::CcittFalse => Digest::Crc16(IBM_3740.digest()),
            Self::Kermit => Digest::Crc16(KERMIT.digest()),
            Self::Modbus => Digest::Crc16(MODBUS.digest()),
            Self::Crc32 => Digest::Crc32(ISO_HDLC.digest()),
        }
    }

    /// The checksum of bytes.
    pub(crate) fn compute(self, bytes: &[u8]) -> i64 {
        let mut digest = self.digest();
        digest.update(bytes);
        digest.value()
    }
}

/// A checksum over the bytes so far.
#[derive(Clone)]
pub(crate) enum Digest {
    Xor(u8),
    Sum(u8),
    Lrc(u8),
    Crc16(CrcDigest<'static, u16>),
    Crc32(CrcDigest<'static, u32>),
}

impl Digest {
    pub(crate) fn update(&mut self, bytes: &[u8]) {
        match self {
            Self::Xor(value) => *value = bytes.iter().fold(*value, |value, byte| value ^ byte),
            Self::Sum(sum) | Self::Lrc(sum) => {
                *sum = bytes.iter().fold(*sum, |sum, &byte| sum.wrapping_add(byte));
            }
            Self::Crc16(digest) => digest.update(bytes),
            Self::Crc32(digest) => digest.update(bytes),
        }
    }

    pub(crate) fn value(&self) -> i64 {
        match self {
            Self::Xor(value) | Self::Sum(value) => (*value).into(),
            Self::Lrc(sum) => sum.wrapping_neg().into(),
            Self::Crc16(digest) => digest.clone().finalize().into(),
            Self::Crc32(digest) => digest.clone().finalize().into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_agree_with_python() {
        let table = include_str!("../../golden/controller-checksums.csv");
        let mut names = std::collections::BTreeSet::new();
        for record in csv::Reader::from_reader(table.as_bytes()).records() {
            let record = record.unwrap();
            let digits: Vec<char> = record[1].chars().collect();
            let byte = |two: &[char]| u8::from_str_radix(&String::from_iter(two), 16).unwrap();
            let bytes: Vec<u8> = digits.chunks(2).map(byte).collect();
            let (_, checksum) = Checksum::ALL.iter().find(|(name, _)| *name == &record[0]).unwrap();
            assert_eq!(checksum.compute(&bytes).to_string(), &record[2], "{record:?}");
            // In parts, as of a file.
            let mut digest = checksum.digest();
            bytes.chunks(3).for_each(|part| digest.update(part));
            assert_eq!(digest.value(), checksum.compute(&bytes));
            names.insert(record[0].to_owned());
        }
        // All of them; one has two names.
        assert_eq!(names.len() + 1, Checksum::ALL.len());
    }
}
