//! The folder of resources of a unit.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use jointplay::interop::fmu::{RESOURCE_FILES, Resources};

/// Largest resource file (bytes), more than any file that the readers accept.
const MAX_BYTES: u64 = 1 << 26;

/// The path in the location of FMI 2.0, such as `file:///tmp/unit/resources`.
pub(super) fn path_of_location(location: &str) -> Result<PathBuf, String> {
    let refused = || {
        format!(
            "resource location {location:?} is no URI of a local folder, such as file:///tmp/unit/resources"
        )
    };
    let path = location.strip_prefix("file:").ok_or_else(refused)?;
    // file:///path, file://localhost/path, or file:/path.
    let path = match path.strip_prefix("//") {
        Some(rest) => {
            let start = rest.find('/').ok_or_else(refused)?;
            if !matches!(&rest[..start], "" | "localhost") {
                return Err(refused());
            }
            &rest[start..]
        }
        None => path,
    };
    let path = decoded(path).ok_or_else(refused)?;
    // file:///C:/path
    let drive =
        path.as_bytes().get(1..3).is_some_and(|two| two[0].is_ascii_alphabetic() && two[1] == b':');
    Ok(PathBuf::from(if drive { &path[1..] } else { &path }))
}

/// A text with `%20` and the like as the bytes that they are.
fn decoded(text: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        rest = after;
        if first == b'%' {
            let (digits, after) = rest.split_at_checked(2)?;
            let digits = std::str::from_utf8(digits).ok().filter(|two| !two.starts_with('+'))?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = after;
        } else {
            bytes.push(first);
        }
    }
    String::from_utf8(bytes).ok()
}

/// Reads the model of a unit.
pub(super) fn read(folder: &Path) -> Result<Resources, String> {
    let text = |name: &str| {
        let path = folder.join(name);
        let failed = |error: std::io::Error| format!("cannot read {}: {error}", path.display());
        let file = File::open(&path).map_err(failed)?;
        let mut text = String::new();
        file.take(MAX_BYTES + 1).read_to_string(&mut text).map_err(failed)?;
        if text.len() as u64 > MAX_BYTES {
            return Err(format!("{} has more than {MAX_BYTES} bytes", path.display()));
        }
        Ok(text)
    };
    let [model, settings] = RESOURCE_FILES.map(text);
    Resources::parse([&model?, &settings?]).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locations() {
        let check = |location: &str, path: Option<&str>| {
            assert_eq!(path_of_location(location).ok(), path.map(PathBuf::from), "{location}");
        };
        check("file:///tmp/a/resources", Some("/tmp/a/resources"));
        check("file:/tmp/a%20b/%C3%A4", Some("/tmp/a b/ä"));
        check("file://localhost/tmp", Some("/tmp"));
        check("file:///C:/Temp/x", Some("C:/Temp/x"));
        for refused in ["/tmp", "http://host/tmp", "file://host/tmp", "file:///a%2", "file:///%+1"]
        {
            check(refused, None);
        }
    }
}
