//! Input files: from the disk, the catalogue or standard input, and their kinds.

use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use jointplay::format::{catalogue, place};
pub(crate) use jointplay::interop::FileKind as Kind;
use jointplay::interop::import;

use crate::console;
use crate::failure::Failure;

/// The name of standard input and of standard output.
pub(crate) const STANDARD: &str = "-";

/// Bytes that distinguish an archive from text.
const ARCHIVE_START: u64 = 4;

/// Set after standard input was read: it can be read only once.
static STANDARD_INPUT_READ: AtomicBool = AtomicBool::new(false);

/// The text of a file, and its name in messages.
pub(crate) struct Source {
    pub(crate) label: String,
    pub(crate) text: String,
    /// Folder of the file, for files that it names; `None` for the catalogue and standard input.
    pub(crate) folder: Option<PathBuf>,
}

impl Source {
    /// Reads a file, else the catalogue entry of this name, or standard input for `-`.
    ///
    /// # Arguments
    /// * `allowed` – largest accepted size (bytes)
    pub(crate) fn read(path: &Path, allowed: usize) -> Result<Self, Failure> {
        let label = label(path);
        if path != Path::new(STANDARD) && !path.exists() {
            if let Some(entry) = catalogue::find(&label) {
                console::detail(&format!("{label}: from the catalogue"));
                return Ok(Self { label, text: entry.text.to_owned(), folder: None });
            }
            if is_name(path) {
                let known: Vec<String> =
                    catalogue::entries().iter().map(|entry| entry.name.to_owned()).collect();
                let text = place::not_known("the file or catalogue entry", &label, &known);
                return Err(Failure::Usage(text));
            }
        }
        let parent = path.parent().filter(|_| path != Path::new(STANDARD));
        let folder = parent.map(Path::to_owned);
        Ok(Self { label, text: read_text(path, allowed as u64)?, folder })
    }

    /// The kind that the file declares.
    pub(crate) fn kind(&self) -> Option<Kind> {
        Kind::detect(&self.text)
    }

    /// Refuses a file that declares another kind.
    ///
    /// # Arguments
    /// * `needed` – the accepted kinds in words, for the message
    pub(crate) fn require(&self, kinds: &[Kind], needed: &str) -> Result<(), Failure> {
        match self.kind().filter(|kind| !kinds.contains(kind)) {
            None => Ok(()),
            Some(kind @ (Kind::Picture | Kind::Fmu)) => Err(unread(kind, &self.label)),
            Some(kind) => {
                let (label, noun, used) = (&self.label, kind.noun(), used_by(kind, &self.label));
                let hint = if kind == Kind::Mechanism && kinds.contains(&Kind::ThreeRods) {
                    format!(
                        "\n  a mechanism that is a three-rod robot becomes a robot file by `jointplay import {label} --to gpr --tilt-limit-deg DEG`"
                    )
                } else {
                    String::new()
                };
                Err(Failure::Usage(format!(
                    "{label} is {noun}, but {needed} is needed\n  {used}{hint}"
                )))
            }
        }
    }
}

/// The failure for a file of a kind that no command reads.
fn unread(kind: Kind, label: &str) -> Failure {
    let noun = kind.noun();
    Failure::Usage(format!("{label} is {noun}, which no command reads\n  {}", used_by(kind, label)))
}

/// The commands that accept a file of a kind.
fn used_by(kind: Kind, label: &str) -> String {
    match kind {
        Kind::Mechanism | Kind::Model => {
            format!(
                "commands for it: jointplay mobility, assemble, move, draw, suggest or studio {label}"
            )
        }
        Kind::ThreeRods => format!(
            "commands for it: jointplay forward, inverse, mobility, sensitivity, compare, simulate or studio --robot {label}; jointplay draw, move, suggest or jacobian {label}"
        ),
        Kind::Arms => format!(
            "a work cell refers to it by robot = \"{label}\"; use `jointplay cell example` for an example"
        ),
        Kind::Cell => {
            format!(
                "commands for it: jointplay cell check {label}, jointplay studio --cell {label}"
            )
        }
        Kind::Part => format!(
            "a work cell includes it by a table [[part]] with part = \"{label}\""
        ),
        Kind::Program => format!(
            "commands for it: jointplay cell check CELL {label}, jointplay cell format {label}"
        ),
        Kind::Study => format!("the command for it: jointplay study {label}"),
        Kind::Loops => format!("the command for it: jointplay import MODEL --loops {label}"),
        Kind::Picture => "a picture is written from the file of a mechanism by `jointplay draw FILE`".to_owned(),
        Kind::Fmu => "simulators read it; it is written from the file of a mechanism by `jointplay export FILE --to fmu`".to_owned(),
    }
}

/// Whether a path is a bare name, which can only refer to the catalogue.
fn is_name(path: &Path) -> bool {
    path.extension().is_none() && path.components().count() == 1
}

/// The name of a file in messages.
pub(crate) fn label(path: &Path) -> String {
    if path == Path::new(STANDARD) {
        "standard input".to_owned()
    } else {
        path.display().to_string()
    }
}

/// The name of a file without its extension, for result files.
pub(crate) fn stem(path: &Path) -> String {
    if path == Path::new(STANDARD) {
        return "input".to_owned();
    }
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The text of a file, or of standard input for `-`; refused if longer than `allowed` bytes.
///
/// Of a document of FreeCAD, an archive, it is the text of the objects.
pub(crate) fn read_text(path: &Path, allowed: u64) -> Result<String, Failure> {
    let named = PathBuf::from(label(path));
    let failed = |source| Failure::Read { path: named.clone(), source };
    let mut bytes = Vec::new();
    // Counted while reading, since pipes and devices do not report their length.
    let read = if path == Path::new(STANDARD) {
        if STANDARD_INPUT_READ.swap(true, Ordering::Relaxed) {
            let text = "standard input can be read only once: use a file in place of the other `-`";
            return Err(Failure::Usage(text.to_owned()));
        }
        std::io::stdin().lock().take(allowed + 1).read_to_end(&mut bytes)
    } else {
        if path.is_dir() {
            let text = format!("{} is a folder, but a file is needed", named.display());
            return Err(Failure::Usage(text));
        }
        let mut file = std::fs::File::open(path).map_err(failed)?;
        file.by_ref().take(ARCHIVE_START).read_to_end(&mut bytes).map_err(failed)?;
        if import::is_archive(&bytes) {
            return document(file, &named);
        }
        file.take(allowed + 1 - bytes.len() as u64).read_to_end(&mut bytes)
    };
    if bytes.len() as u64 > allowed {
        return Err(Failure::TooLarge { path: named, allowed });
    }
    read.map_err(failed)?;
    if let Some(kind) = Kind::detect_binary(&bytes) {
        return Err(unread(kind, &named.display().to_string()));
    }
    console::detail(&format!("{}: {} bytes read", named.display(), bytes.len()));
    if import::is_archive(&bytes) {
        return document(std::io::Cursor::new(bytes), &named);
    }
    let text = String::from_utf8(bytes);
    // A document that was unpacked is text in XML.
    if import::is_document_name(path) && !text.as_ref().is_ok_and(|text| import::is_model(text)) {
        let error = import::ArchiveError::NoArchive;
        return Err(Failure::Usage(format!("{}: {error}", named.display())));
    }
    text.map_err(|error| {
        let message = match error.as_bytes() {
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "the text is in UTF-16; save it in UTF-8",
            _ => "the file is not text in UTF-8",
        };
        failed(std::io::Error::new(std::io::ErrorKind::InvalidData, message))
    })
}

/// The text of the objects in a document of FreeCAD.
fn document(archive: impl Read + Seek, named: &Path) -> Result<String, Failure> {
    import::document_text(archive).map_err(|error| match error {
        import::ArchiveError::Fmu => unread(Kind::Fmu, &named.display().to_string()),
        error => Failure::Usage(format!("{}: {error}", named.display())),
    })
}

/// The bytes of a file; refused if longer than `allowed` bytes.
pub(crate) fn read_bytes(path: &Path, allowed: u64) -> Result<Vec<u8>, Failure> {
    let failed = |source| Failure::Read { path: path.to_owned(), source };
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(failed)?;
    file.take(allowed.saturating_add(1)).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > allowed {
        return Err(Failure::TooLarge { path: path.to_owned(), allowed });
    }
    Ok(bytes)
}
