//! Why the system refuses a file, in words for users.

use std::io::{self, ErrorKind as Kind};

/// Why a file cannot be read, with advice where the message of the system has none.
#[must_use]
pub fn explain_read(error: &io::Error) -> String {
    let explained = match error.kind() {
        Kind::NotFound => Some("there is no such file"),
        Kind::PermissionDenied => Some("no permission to read it"),
        Kind::IsADirectory => Some("it is a folder"),
        Kind::NotADirectory => Some("a part of its path is a file, not a folder"),
        _ => None,
    };
    in_words(error, explained)
}

/// Why a file cannot be written, with advice where the message of the system has none.
#[must_use]
pub fn explain_write(error: &io::Error) -> String {
    let explained = match error.kind() {
        Kind::NotFound => Some("its folder does not exist"),
        Kind::PermissionDenied => Some("no permission to write there; choose another folder"),
        Kind::ReadOnlyFilesystem => Some("the disk is read-only; choose another folder"),
        Kind::StorageFull | Kind::QuotaExceeded => {
            Some("the disk is full; free some space, or choose another folder")
        }
        Kind::IsADirectory => Some("a folder has this name"),
        Kind::NotADirectory | Kind::AlreadyExists => {
            Some("a file exists at this path, or at the path of one of its folders")
        }
        _ => None,
    };
    in_words(error, explained)
}

/// Errors that this program makes have words of their own.
fn in_words(error: &io::Error, explained: Option<&str>) -> String {
    match explained {
        Some(words) if error.get_ref().is_none() => words.to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_the_system_are_in_words_and_those_of_the_program_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/robot.toml");
        let missing = std::fs::File::open(&path).unwrap_err();
        assert_eq!(explain_read(&missing), "there is no such file");
        let unwritten = std::fs::File::create(&path).unwrap_err();
        assert_eq!(explain_write(&unwritten), "its folder does not exist");
        let own = || io::Error::new(Kind::PermissionDenied, "locked by another window");
        assert_eq!(explain_read(&own()), "locked by another window");
        assert_eq!(explain_write(&own()), "locked by another window");
    }
}
