//! Files of a study as a part of JSON documents.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

/// The files of a study by name: texts as such, others in hexadecimal.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct StudyFiles(BTreeMap<String, Content>);

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
enum Content {
    Text(String),
    #[serde(rename_all = "snake_case")]
    Binary {
        hexadecimal: String,
    },
}

impl StudyFiles {
    pub(crate) fn new(files: &BTreeMap<String, Vec<u8>>) -> Self {
        let content = |bytes: &Vec<u8>| match std::str::from_utf8(bytes) {
            Ok(text) => Content::Text(text.to_owned()),
            Err(_) => Content::Binary { hexadecimal: to_hexadecimal(bytes) },
        };
        Self(files.iter().map(|(name, bytes)| (name.clone(), content(bytes))).collect())
    }

    /// The files, or what is malformed.
    pub(crate) fn read(self) -> Result<BTreeMap<String, Vec<u8>>, &'static str> {
        let bytes = |content| match content {
            Content::Text(text) => Ok(text.into_bytes()),
            Content::Binary { hexadecimal } => {
                from_hexadecimal(&hexadecimal).ok_or("a file in it is not hexadecimal")
            }
        };
        self.0.into_iter().map(|(name, content)| Ok((name, bytes(content)?))).collect()
    }
}

/// Bytes as pairs of hexadecimal digits.
pub(crate) fn to_hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// Bytes from pairs of hexadecimal digits.
pub(crate) fn from_hexadecimal(text: &str) -> Option<Vec<u8>> {
    let digits: Vec<u8> =
        text.chars().map(|digit| Some(digit.to_digit(16)? as u8)).collect::<Option<_>>()?;
    let pairs = digits.chunks_exact(2);
    pairs.remainder().is_empty().then(|| pairs.map(|pair| 16 * pair[0] + pair[1]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_other_bytes_are_read_as_written() {
        let files = [("cell.toml", "kind = \"Zelle ä\"".as_bytes()), ("a.stl", &[0, 255, 16, 128])];
        let files: BTreeMap<String, Vec<u8>> =
            files.map(|(name, bytes)| (name.to_owned(), bytes.to_vec())).into();
        let text = serde_json::to_string(&StudyFiles::new(&files)).unwrap();
        assert!(text.contains(r#""a.stl":{"hexadecimal":"00ff1080"}"#), "{text}");
        let read: StudyFiles = serde_json::from_str(&text).unwrap();
        assert_eq!(read.read().unwrap(), files);
        for malformed in ["0", "0g", "ä0"] {
            let text = format!(r#"{{"a": {{"hexadecimal": "{malformed}"}}}}"#);
            let read: StudyFiles = serde_json::from_str(&text).unwrap();
            assert!(read.read().is_err(), "{malformed}");
        }
    }
}
