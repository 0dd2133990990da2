//! Pages as PDF, printed by a browser of this machine.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::failure::Failure;
use crate::print_error::PrintError;

/// Commands of browsers that can print pages without a window.
const COMMANDS: [&str; 7] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "microsoft-edge",
    "msedge",
];

/// Browsers that are usually not on the search path.
const FILES: [&str; 5] = [
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Microsoft Edge.app/Contents/MacOS/Microsoft Edge",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
    r"C:\Program Files (x86)\Microsoft\Edge\Application\msedge.exe",
];

/// A Chromium-based browser.
pub(crate) struct Browser {
    path: PathBuf,
}

impl Browser {
    /// A given browser, or the first that is found.
    pub(crate) fn find(given: Option<&Path>) -> Result<Self, Failure> {
        if let Some(path) = given {
            // A bare name is a file here, and no command of the search path.
            return match std::path::absolute(path) {
                Ok(path) if path.is_file() => Ok(Self { path }),
                _ => Err(Failure::Usage(format!("the browser {} is not a file", path.display()))),
            };
        }
        let folders = std::env::var_os("PATH").unwrap_or_default();
        let folders: Vec<PathBuf> = std::env::split_paths(&folders).collect();
        let on_path = COMMANDS
            .iter()
            .flat_map(|name| folders.iter().map(move |folder| folder.join(name)))
            .map(|path| path.with_extension(std::env::consts::EXE_EXTENSION));
        let mut all = on_path.chain(FILES.iter().map(PathBuf::from));
        all.find(|path| path.is_file()).map(|path| Self { path }).ok_or_else(|| {
            Failure::Usage(
                "no Chromium, Chrome or Edge was found to print the PDF: name one with --browser, or write a file that ends in .html and print it from any browser"
                    .to_owned(),
            )
        })
    }
}

/// A page as PDF.
///
/// # Arguments
/// * `html` – the page, which needs no other files
pub(crate) fn print_page(browser: &Browser, html: &str) -> Result<Vec<u8>, Failure> {
    printed(browser, html).map_err(|source| Failure::Pdf { browser: browser.path.clone(), source })
}

fn printed(browser: &Browser, html: &str) -> Result<Vec<u8>, PrintError> {
    let folder = tempfile::tempdir().map_err(PrintError::Page)?;
    let (page, pdf) = (folder.path().join("page.html"), folder.path().join("page.pdf"));
    std::fs::write(&page, html).map_err(PrintError::Page)?;
    let mut command = Command::new(&browser.path);
    command
        .args(["--headless", "--disable-gpu", "--no-pdf-header-footer", "--disable-extensions"])
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("--print-to-pdf={}", pdf.display()));
    if is_administrator(&page) {
        // Chromium refuses to run with its sandbox there; the page has no scripts.
        command.arg("--no-sandbox");
    }
    let output = command.arg(&page).output().map_err(PrintError::Start)?;
    let last_line = || {
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        errors.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no message").to_owned()
    };
    if !output.status.success() {
        return Err(PrintError::Failed { status: output.status, message: last_line() });
    }
    let bytes =
        std::fs::read(&pdf).map_err(|source| PrintError::File { source, message: last_line() })?;
    if bytes.starts_with(b"%PDF-") { Ok(bytes) } else { Err(PrintError::NotPdf) }
}

/// Whether the owner of a file that was just written is the administrator.
#[cfg(unix)]
fn is_administrator(written: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    std::fs::metadata(written).is_ok_and(|found| found.uid() == 0)
}

#[cfg(not(unix))]
const fn is_administrator(_: &Path) -> bool {
    false
}
