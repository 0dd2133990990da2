//! Digests that stay the same from version to version.

use sha2::{Digest as _, Sha256};

use crate::study_files::to_hexadecimal;

/// SHA-256 of bytes, as 64 hexadecimal digits: for files, and for keys that outlive a run.
#[must_use]
pub fn sha256(bytes: &[u8]) -> String {
    to_hexadecimal(&Sha256::digest(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Examples of FIPS 180.
    #[test]
    fn digests_are_those_of_the_standard() {
        let expected = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";
        assert_eq!(sha256(b""), expected);
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(b"abc"), expected);
    }
}
