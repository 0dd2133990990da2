//! Why a browser does not print a page.

use std::io;
use std::process::ExitStatus;

/// Why a browser did not print a page.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PrintError {
    /// The page cannot be written for the browser.
    #[error("the page cannot be written for it ({})", .0.kind())]
    Page(#[source] io::Error),
    #[error("it does not start ({})", .0.kind())]
    Start(#[source] io::Error),
    /// The browser failed.
    #[error("{status}, {message}")]
    Failed { status: ExitStatus, message: String },
    #[error("{}, {message}", unread(.source))]
    File { source: io::Error, message: String },
    #[error("its file is not a PDF")]
    NotPdf,
}

fn unread(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "it wrote no file".to_owned(),
        kind => format!("its file cannot be read ({kind})"),
    }
}
