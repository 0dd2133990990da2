//! Shared libraries of units, and the platforms that they are for.

use super::description::FmiVersion;

/// The text before the version in every shared library that runs units; elsewhere the two are not joined.
const MARK: &str = "jointplay library of functional mock-up units";
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A text in every shared library that runs units of this version.
#[must_use]
pub const fn library_mark() -> &'static str {
    concat!("jointplay library of functional mock-up units", "\t", env!("CARGO_PKG_VERSION"), "\n")
}

/// A shared library that runs units, with the platform that its contents name.
#[derive(Debug, Clone)]
pub struct Binary {
    bytes: Vec<u8>,
    platform: Platform,
}

/// Why a file is no library for units.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BinaryError {
    /// Neither ELF, Mach-O nor PE, or of a processor without a folder.
    #[error("it is not a shared library for Linux, Windows or macOS on x86-64 or AArch64")]
    Platform,
    /// Another library, or another version of it.
    #[error(
        "it is not jointplay's library for C of version {expected}: build it from the same source"
    )]
    Version {
        /// The version.
        expected: &'static str,
    },
    /// A platform for which the version of FMI has no folder.
    #[error("FMI {version} has no folder for libraries of {platform}: use --fmi 3")]
    NoFolder {
        /// The version.
        version: &'static str,
        /// The platform, as FMI 3.0 names it.
        platform: &'static str,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Platform {
    /// Name of the folder in FMI 3.0.
    tuple: &'static str,
    /// Name of the folder in FMI 2.0.
    short: Option<&'static str>,
    /// End of the name of the library.
    extension: &'static str,
}

const fn platform(
    tuple: &'static str,
    short: Option<&'static str>,
    extension: &'static str,
) -> Platform {
    Platform { tuple, short, extension }
}

impl Binary {
    /// Recognises the platform of a library.
    ///
    /// # Errors
    /// [`BinaryError::Platform`], [`BinaryError::Version`].
    ///
    /// # Source
    /// \[FMI2\], section 2.3; \[FMI3\], section 2.5.1.4.2: names of folders
    pub fn new(bytes: Vec<u8>) -> Result<Self, BinaryError> {
        let platform = platform_of(&bytes).ok_or(BinaryError::Platform)?;
        let mut rest = &bytes[..];
        // A loop over the first letter is much faster than comparing every window.
        while let Some(at) = rest.iter().position(|&byte| byte == MARK.as_bytes()[0]) {
            if is_mark(&rest[at..]) {
                return Ok(Self { bytes, platform });
            }
            rest = &rest[at + 1..];
        }
        Err(BinaryError::Version { expected: VERSION })
    }

    /// Name of its platform in FMI 3.0.
    #[must_use]
    pub fn platform(&self) -> &'static str {
        self.platform.tuple
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Its path in a unit.
    pub(super) fn path(
        &self,
        identifier: &str,
        version: FmiVersion,
    ) -> Result<String, BinaryError> {
        let Platform { tuple, short, extension } = self.platform;
        let folder = match version {
            FmiVersion::V2 => {
                short.ok_or(BinaryError::NoFolder { version: "2.0", platform: tuple })?
            }
            FmiVersion::V3 => tuple,
        };
        Ok(format!("binaries/{folder}/{identifier}.{extension}"))
    }
}

fn is_mark(bytes: &[u8]) -> bool {
    let version = bytes.strip_prefix(MARK.as_bytes()).and_then(|rest| rest.strip_prefix(b"\t"));
    let end = version.and_then(|rest| rest.strip_prefix(VERSION.as_bytes()));
    end.is_some_and(|rest| rest.starts_with(b"\n"))
}

/// The platform in the header of a library.
fn platform_of(bytes: &[u8]) -> Option<Platform> {
    let half = |at: usize| Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    match bytes.get(..4)? {
        // 64 bits, little-endian.
        b"\x7fELF" if bytes.get(4..6)? == [2, 1] => match half(18)? {
            0x3e => Some(platform("x86_64-linux", Some("linux64"), "so")),
            0xb7 => Some(platform("aarch64-linux", None, "so")),
            _ => None,
        },
        // Mach-O of 64 bits.
        [0xcf, 0xfa, 0xed, 0xfe] => match word(4)? {
            0x0100_0007 => Some(platform("x86_64-darwin", Some("darwin64"), "dylib")),
            0x0100_000c => Some(platform("aarch64-darwin", Some("darwin64"), "dylib")),
            _ => None,
        },
        [b'M', b'Z', ..] => {
            let header = usize::try_from(word(0x3c)?).ok()?;
            let end = header.checked_add(6)?;
            let found = bytes.get(header..end)?;
            match found {
                [b'P', b'E', 0, 0, 0x64, 0x86] => {
                    Some(platform("x86_64-windows", Some("win64"), "dll"))
                }
                [b'P', b'E', 0, 0, 0x64, 0xaa] => Some(platform("aarch64-windows", None, "dll")),
                _ => None,
            }
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn platforms_are_recognised_by_headers() {
        let elf = |machine: u8| {
            let mut bytes = b"\x7fELF\x02\x01\x01".to_vec();
            bytes.resize(18, 0);
            bytes.extend([machine, 0]);
            bytes
        };
        let mut pe = b"MZ".to_vec();
        pe.resize(0x3c, 0);
        pe.extend([0x80, 0, 0, 0]);
        pe.resize(0x80, 0);
        pe.extend(b"PE\0\0\x64\x86");
        let macho = [0xcf, 0xfa, 0xed, 0xfe, 0x0c, 0, 0, 1].to_vec();
        let check = |bytes: &[u8], expect: Option<(&str, Option<&str>)>| {
            let found = platform_of(bytes).map(|one| (one.tuple, one.short));
            assert_eq!(found, expect);
        };
        check(&elf(0x3e), Some(("x86_64-linux", Some("linux64"))));
        check(&elf(0xb7), Some(("aarch64-linux", None)));
        check(&elf(0x28), None);
        check(&pe, Some(("x86_64-windows", Some("win64"))));
        check(&macho, Some(("aarch64-darwin", Some("darwin64"))));
        for bytes in [&b""[..], b"MZ", b"\x7fELF", b"#!/bin/sh\nexit 0\n"] {
            check(bytes, None);
        }
        let mut cut = pe.clone();
        cut[0x3c..0x40].copy_from_slice(&[0xff; 4]);
        check(&cut, None);
    }

    #[test]
    fn other_libraries_are_refused() {
        let mut bytes = b"\x7fELF\x02\x01\x01".to_vec();
        bytes.resize(18, 0);
        bytes.extend([0xb7, 0]);
        let refused = Binary::new(bytes.clone()).unwrap_err();
        assert!(refused.to_string().contains(env!("CARGO_PKG_VERSION")), "{refused}");
        bytes.extend(b"jjjointplay");
        bytes.extend(library_mark().bytes());
        let binary = Binary::new(bytes).unwrap();
        assert_eq!(binary.path("m", FmiVersion::V3).unwrap(), "binaries/aarch64-linux/m.so");
        let refused = binary.path("m", FmiVersion::V2).unwrap_err();
        assert_eq!(refused, BinaryError::NoFolder { version: "2.0", platform: "aarch64-linux" });
        assert_eq!(Binary::new(b"text".to_vec()).unwrap_err(), BinaryError::Platform);
    }
}
