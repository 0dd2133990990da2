//! Errors of commands, their messages and exit codes.

use std::io::{self, Write};
use std::path::PathBuf;

use anstyle::{AnsiColor, Style};
use jointplay::format::cell;
use jointplay::format::coordinates;
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::explain::{explain, explain_limit};
use jointplay::format::number::{counted, number};
use jointplay::format::place;
use jointplay::gpr::BrokenLimit;
use jointplay::report;
use jointplay::virtualization::Solver;
use jointplay::{plot, study};
use jointplay_files::{explain_read, explain_write};

use crate::print_error::PrintError;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("the pose exceeds the robot's limits:\n{}\nuse --ignore-limits to compute it anyway", list(.0))]
    Limits(Vec<BrokenLimit>),
    #[error("{}", explain_core(.0))]
    Core(#[from] jointplay::Error),
    #[error("{}", explain_study(.0))]
    Study(#[from] study::Error),
    /// An error of a robot or a cell, in words.
    #[error("{0}")]
    Robot(String),
    /// Errors in a cell file and in a program file.
    #[error("{cell}\n{program}")]
    CellAndProgram { cell: Box<Failure>, program: Box<Failure> },
    #[error("{program}: the program contains no motion (all axes stay at home)")]
    NoMotion { program: String },
    #[error(
        "{} did not print the page: {source}; write a file that ends in .html and print it from any browser",
        browser.display()
    )]
    Pdf { browser: PathBuf, source: PrintError },
    /// Errors in files.
    #[error("{}", excerpts(.0))]
    Invalid(Vec<Diagnostic>),
    /// Valid requests that the robot cannot satisfy.
    #[error("{}", excerpts(.0))]
    Infeasible(Vec<Diagnostic>),
    #[error("{0}")]
    Usage(String),
    #[error("{0}")]
    NotAssembled(String),
    #[error("{0}")]
    Stopped(String),
    #[error("{0}")]
    OverClearance(String),
    /// A configuration of a mechanism beyond joint limits.
    #[error("joint limits exceeded:\n{}", messages(.0))]
    BeyondLimits(Vec<report::LimitReport>),
    /// A motion of a mechanism that leaves joint limits.
    #[error("joint limits exceeded, first at {place}:\n{}", messages(.limits))]
    BeyondLimitsAt { place: String, limits: Vec<report::LimitReport> },
    #[error("the mobility differs from the `[expected]` table of the file:{0}")]
    Unexpected(String),
    #[error("{0}")]
    Unsolved(String),
    #[error("{0}")]
    Interrupted(String),
    #[error("cannot resume from {}: {why}", path.display())]
    Marker { path: PathBuf, why: String },
    /// An invalid line in the log of a search.
    #[error(
        "{}, line {line}, column {}: invalid evaluation; remove the line, or use --force to start again",
        path.display(), source.column()
    )]
    EvaluationLine { path: PathBuf, line: usize, source: serde_json::Error },
    #[error("{}: {source}", folder.display())]
    Parts { folder: PathBuf, source: Box<report::study_parts::PartsError> },
    #[error(transparent)]
    Coordinate(#[from] coordinates::Error),
    #[error("--azimuth-step-deg {}: {source}", number(*.step))]
    AzimuthStep { step: f64, source: jointplay::format::steps::Error },
    #[error("the study has {found} poses, but at most {allowed} are allowed: use larger steps")]
    TooManyPoses { found: usize, allowed: usize },
    #[error("cannot read {}: {}", path.display(), explain_read(.source))]
    Read { path: PathBuf, source: io::Error },
    #[error("{} is too large: at most {allowed} bytes are allowed", path.display())]
    TooLarge { path: PathBuf, allowed: u64 },
    #[error("cannot write {}: {}", path.display(), explain_write(.source))]
    Write { path: PathBuf, source: io::Error },
    #[error("{} exists: choose another name, or use --force to replace it", path.display())]
    Exists { path: PathBuf },
    #[error(
        "{} contains files: {}; choose another --out, or use --force to replace files of the same names",
        folder.display(), few(names)
    )]
    NotEmpty { folder: PathBuf, names: Vec<String> },
    #[error("{}: the name of a figure must end in .svg, .png, .pdf or .tex", path.display())]
    FigureKind { path: PathBuf },
    #[cfg(not(feature = "parquet"))]
    #[error(
        "this jointplay was built without Parquet: build with --features parquet, or choose a table that ends in .csv"
    )]
    NoParquet,
    #[cfg(feature = "parquet")]
    #[error("cannot write the table as Parquet; use CSV")]
    Parquet,
    #[error(transparent)]
    Export(#[from] jointplay::interop::export::Error),
    #[error(transparent)]
    Cell(#[from] jointplay::cell::CellError),
    #[error(transparent)]
    Picture(#[from] jointplay::interop::export::PictureError),
    #[error("cannot draw {figure}: {source}")]
    Figure { figure: String, source: plot::Error },
    #[cfg(feature = "studio")]
    #[error(transparent)]
    Serve(#[from] jointplay_studio::Error),
    #[error("cannot print: {0}")]
    Print(#[from] io::Error),
}

/// One error at one position of a file.
#[derive(Debug, PartialEq)]
pub(crate) struct Diagnostic {
    pub(crate) file: String,
    pub(crate) line: usize,
    pub(crate) column: usize,
    pub(crate) message: String,
    /// The message with the line of the file and a caret.
    pub(crate) excerpt: String,
}

impl Diagnostic {
    pub(crate) fn new<P: std::fmt::Display>(error: &place::Error<P>, file: &str) -> Self {
        let place::Place { line, column, .. } = error.place;
        let (message, excerpt) = (error.to_string(), error.with_excerpt(file));
        Self { file: file.to_owned(), line, column, message, excerpt }
    }

    /// The errors of a file.
    pub(crate) fn list<P: std::fmt::Display>(errors: &[place::Error<P>], file: &str) -> Vec<Self> {
        errors.iter().map(|error| Self::new(error, file)).collect()
    }

    /// The errors of a cell file; those of a file that it names follow the place where it names it.
    fn list_cell(errors: &[cell::Problem], file: &str) -> Vec<Self> {
        let mut all = Vec::new();
        for error in errors {
            let cell::Fault::Within { name, inner, others } = &*error.problem else {
                all.push(Self::new(error, file));
                continue;
            };
            let inner: Vec<cell::Problem> =
                std::iter::once(&**inner).chain(others).cloned().collect();
            let message = format!("{name:?} has {}", counted(inner.len(), "error"));
            let named = place::Error { place: error.place.clone(), problem: Box::new(message) };
            all.push(Self::new(&named, file));
            let path = match file.rsplit_once('/') {
                Some((folder, _)) if name.contains('.') => format!("{folder}/{name}"),
                _ => name.clone(),
            };
            all.extend(Self::list_cell(&inner, &path));
        }
        all
    }
}

/// Largest number of errors listed in text; JSON lists all.
const MOST_ERRORS: usize = 21;
/// Largest number of file names listed in text.
const MOST_NAMES: usize = 5;

fn excerpts(all: &[Diagnostic]) -> String {
    let mut text: Vec<&str> = all.iter().take(MOST_ERRORS).map(|one| &*one.excerpt).collect();
    let more = match all.len().saturating_sub(MOST_ERRORS) {
        0 => return text.join("\n"),
        more => format!("and {} (--format json lists all)", counted(more, "more error")),
    };
    text.push(&more);
    text.join("\n")
}

/// The first names of a list, and the number of the others.
fn few(names: &[String]) -> String {
    let listed = names[..names.len().min(MOST_NAMES)].join(", ");
    match names.len().saturating_sub(MOST_NAMES) {
        0 => listed,
        more => format!("{listed} and {more} more"),
    }
}

fn messages(broken: &[report::LimitReport]) -> String {
    broken.iter().map(|limit| format!("  {}", limit.message)).collect::<Vec<_>>().join("\n")
}

fn list(broken: &[BrokenLimit]) -> String {
    broken
        .iter()
        .map(|limit| format!("  {}", explain_limit(limit, DisplayUnits::Metric)))
        .collect::<Vec<_>>()
        .join("\n")
}

/// The message of an error, with flags that may help.
fn explain_core(error: &jointplay::Error) -> String {
    let hint = match error {
        jointplay::Error::NotConverged(best) if best.solver == Solver::LeastNorm => {
            "\n  try a pose closer to level, --solver newton, --metric radius, or --virtualization planar"
        }
        jointplay::Error::NotConverged(_) | jointplay::Error::TurnedOver { .. } => {
            "\n  try a pose closer to level, --solver closed-form, or --virtualization planar"
        }
        _ => "",
    };
    explain(error, DisplayUnits::Metric) + hint
}

fn explain_study(error: &study::Error) -> String {
    match error {
        study::Error::Pose { sample, azimuth, tilt_angle, source } => format!(
            "sample {sample} (azimuth {:.6}°, tilt angle {:.6}°): {}",
            azimuth.to_degrees(),
            tilt_angle.to_degrees(),
            explain_core(source)
        ),
        study::Error::Core(error) => explain_core(error),
        other => other.to_string(),
    }
}

/// Exit code of a valid but infeasible request.
const INFEASIBLE: u8 = 1;
/// Exit code of bad input or usage.
pub(crate) const BAD_INPUT: u8 = 2;
/// Exit code after Ctrl-C, by the convention of shells.
pub(crate) const INTERRUPTED: u8 = 130;

/// Whether parts of a study are missing, which is no error of the input.
fn is_missing(error: &report::study_parts::PartsError) -> bool {
    matches!(error, report::study_parts::PartsError::Missing { .. })
}

impl Failure {
    /// An error at one position of a file.
    pub(crate) fn at<P: std::fmt::Display>(error: &place::Error<P>, file: &str) -> Self {
        Self::Invalid(vec![Diagnostic::new(error, file)])
    }

    /// All errors of a file.
    pub(crate) fn invalid<P: std::fmt::Display>(errors: &[place::Error<P>], file: &str) -> Self {
        Self::Invalid(Diagnostic::list(errors, file))
    }

    /// All errors of a cell file, and of the files that it names.
    pub(crate) fn invalid_cell(errors: &[cell::Problem], file: &str) -> Self {
        Self::Invalid(Diagnostic::list_cell(errors, file))
    }

    fn exit_code(&self) -> u8 {
        let core = |error: &jointplay::Error| {
            if error.is_infeasible() { INFEASIBLE } else { BAD_INPUT }
        };
        match self {
            Self::Limits(_)
            | Self::BeyondLimits(_)
            | Self::BeyondLimitsAt { .. }
            | Self::NotAssembled(_)
            | Self::Stopped(_)
            | Self::OverClearance(_)
            | Self::Infeasible(_)
            | Self::Unexpected(_)
            | Self::Unsolved(_) => INFEASIBLE,
            Self::Parts { source, .. } if is_missing(source) => INFEASIBLE,
            Self::Interrupted(_) => INTERRUPTED,
            Self::Core(error) => core(error),
            Self::Study(study::Error::Pose { source, .. }) => core(source),
            _ => BAD_INPUT,
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Limits(_) | Self::BeyondLimits(_) | Self::BeyondLimitsAt { .. } => "limits",
            Self::OverClearance(_) => "clearance",
            Self::Stopped(_) => "stopped",
            Self::Unexpected(_) => "unexpected",
            Self::Parts { source, .. } if is_missing(source) => "missing",
            Self::Interrupted(_) => "interrupted",
            _ if self.exit_code() == INFEASIBLE => "unsolved",
            Self::Write { .. } | Self::Print(_) => "output",
            _ => "input",
        }
    }

    /// Reports the error on standard error, as text or as JSON.
    pub(crate) fn report(&self, json: bool) -> u8 {
        if let Self::Print(error) = self
            && error.kind() == io::ErrorKind::BrokenPipe
        {
            // The reader closed the pipe: this is no error.
            return 0;
        }
        let mut stderr = anstream::stderr();
        let limits = match self {
            Self::Limits(broken) => report::limits(broken, DisplayUnits::Metric),
            Self::BeyondLimits(broken) | Self::BeyondLimitsAt { limits: broken, .. } => {
                broken.clone()
            }
            _ => Vec::new(),
        };
        let written = if json {
            let kind = self.kind();
            let message = self.to_string();
            let places =
                if let Self::Invalid(all) | Self::Infeasible(all) = self { &all[..] } else { &[] };
            let place = |one: &Diagnostic| {
                let Diagnostic { file, line, column, message, .. } = one;
                serde_json::json!({ "file": file, "line": line, "column": column, "message": message })
            };
            let places: Vec<_> = places.iter().map(place).collect();
            let error = serde_json::json!({
                "kind": kind, "message": message, "limits_broken": limits, "places": places,
            });
            writeln!(stderr, "{}", serde_json::json!({ "error": error }))
        } else {
            let (color, word) = match self {
                Self::Interrupted(_) => (AnsiColor::Yellow, "interrupted"),
                _ => (AnsiColor::Red, "error"),
            };
            let style = Style::new().bold().fg_color(Some(color.into()));
            writeln!(stderr, "{style}{word}:{style:#} {self}")
        };
        // If standard error is closed too, the exit code still reports the error.
        drop(written);
        self.exit_code()
    }
}
