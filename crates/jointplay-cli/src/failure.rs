//! What can go wrong, how it is told, and the exit code.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use anstyle::{AnsiColor, Style};
use jointplay::format::coordinates;
use jointplay::format::explain::{explain, explain_limit};
use jointplay::format::number::{counted, number};
use jointplay::format::place;
use jointplay::format::report;
use jointplay::gpr::BrokenLimit;
use jointplay::virtualization::Solver;
use jointplay::{plot, study};

/// Why a command did not do what was asked.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("the pose is beyond the robot's limits:\n{}\n--ignore-limits computes past them", list(.0))]
    Limits(Vec<BrokenLimit>),
    #[error("{}", explain_core(.0))]
    Core(#[from] jointplay::Error),
    #[error("{}", explain_study(.0))]
    Study(#[from] study::Error),
    #[error("{0}")]
    Robot(String),
    /// What is wrong in files.
    #[error("{}", excerpts(.0))]
    Invalid(Vec<Diagnostic>),
    /// Where more is asked for than can be.
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
    /// A configuration of a mechanism that its joints cannot reach.
    #[error("beyond joint limits:\n{}", messages(.0))]
    BeyondLimits(Vec<report::LimitReport>),
    #[error("the mobility is not what `[expected]` of the file says:{0}")]
    Unexpected(String),
    #[error("{0}")]
    Unsolved(String),
    #[error("{0}")]
    Interrupted(String),
    #[error("cannot go on from {}: {why}", path.display())]
    Marker { path: PathBuf, why: String },
    #[error(transparent)]
    Coordinate(#[from] coordinates::Error),
    #[error("--yaw-step-deg {}: {source}", number(*.step))]
    YawStep { step: f64, source: jointplay::format::steps::Error },
    #[error("the study has {found} poses, at most {allowed} are allowed: take larger steps")]
    TooManyPoses { found: usize, allowed: usize },
    #[error("cannot read {}: {source}", path.display())]
    Read { path: PathBuf, source: io::Error },
    #[error("{} is longer than {allowed} bytes, the most that such a file may have", path.display())]
    TooLarge { path: PathBuf, allowed: u64 },
    #[error("cannot write {}: {}", path.display(), explain_write(.source))]
    Write { path: PathBuf, source: io::Error },
    #[error("{} exists: choose another name, or replace it with --force", path.display())]
    Exists { path: PathBuf },
    #[error(
        "{} holds files already: {}; choose another --out, or use --force, which replaces files of the same names",
        folder.display(), few(names)
    )]
    NotEmpty { folder: PathBuf, names: Vec<String> },
    #[error("{} ends neither in .svg nor in .png", path.display())]
    FigureKind { path: PathBuf },
    #[cfg(not(feature = "parquet"))]
    #[error(
        "this jointplay was built without Parquet: build with --features parquet, or name a table that ends in .csv"
    )]
    NoParquet,
    #[cfg(feature = "parquet")]
    #[error("the table cannot be written as Parquet; write it as csv")]
    Parquet,
    #[error(transparent)]
    Export(#[from] jointplay::format::export::Error),
    #[error(transparent)]
    Cell(#[from] jointplay::cell::CellError),
    #[error("cannot draw {figure}: {source}")]
    Figure { figure: String, source: plot::Error },
    #[cfg(feature = "studio")]
    #[error(transparent)]
    Serve(#[from] jointplay_studio::Error),
    #[error("cannot print: {0}")]
    Print(#[from] io::Error),
}

/// One thing at one place of a file.
#[derive(Debug, PartialEq)]
pub(crate) struct Diagnostic {
    pub(crate) file: String,
    pub(crate) line: usize,
    pub(crate) column: usize,
    pub(crate) message: String,
    /// The message with its line.
    pub(crate) excerpt: String,
}

impl Diagnostic {
    pub(crate) fn new<P: std::fmt::Display>(error: &place::Error<P>, file: &str) -> Self {
        let place::Place { line, column, .. } = error.place;
        let (message, excerpt) = (error.to_string(), error.with_excerpt(file));
        Self { file: file.to_owned(), line, column, message, excerpt }
    }
}

/// Most errors that text lists; JSON has all.
const MOST_ERRORS: usize = 21;
/// Most names of files that text lists.
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

/// The first of some names, and how many more there are.
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
    broken.iter().map(|limit| format!("  {}", explain_limit(limit))).collect::<Vec<_>>().join("\n")
}

/// Why there is no file, in our words where the system has only its own.
fn explain_write(error: &io::Error) -> String {
    use io::ErrorKind as Kind;
    let ours = match error.kind() {
        _ if error.get_ref().is_some() => None,
        Kind::NotFound => Some("its folder does not exist"),
        Kind::PermissionDenied => Some("it is not permitted there; choose another place"),
        Kind::ReadOnlyFilesystem => Some("the disk is read-only; choose another place"),
        Kind::StorageFull | Kind::QuotaExceeded => {
            Some("the disk is full; make room, or choose another place")
        }
        Kind::IsADirectory => Some("a folder has this name"),
        Kind::NotADirectory | Kind::AlreadyExists => {
            Some("a file is in its place, or in place of a folder of its path")
        }
        _ => None,
    };
    ours.map_or_else(|| error.to_string(), str::to_owned)
}

/// What went wrong, and which flag may help.
fn explain_core(error: &jointplay::Error) -> String {
    let hint = match error {
        jointplay::Error::NotConverged(best) if best.solver == Solver::LeastNorm => {
            "\n  a pose nearer to level may do, or --solver newton, --metric radius, --virtualization planar"
        }
        jointplay::Error::NotConverged(_) | jointplay::Error::TurnedOver { .. } => {
            "\n  a pose nearer to level may do, or --solver closed-form, --virtualization planar"
        }
        _ => "",
    };
    explain(error) + hint
}

fn explain_study(error: &study::Error) -> String {
    match error {
        study::Error::Pose { sample, yaw, pitch, source } => format!(
            "sample {sample} (yaw {:.6}°, pitch {:.6}°): {}",
            yaw.to_degrees(),
            pitch.to_degrees(),
            explain_core(source)
        ),
        study::Error::Core(error) => explain_core(error),
        other => other.to_string(),
    }
}

/// The answer is no.
const NO: u8 = 1;
/// The question is wrong.
pub(crate) const BAD_INPUT: u8 = 2;
/// Stopped by Ctrl-C, as shells number it.
pub(crate) const INTERRUPTED: u8 = 130;

impl Failure {
    /// What is wrong at one place of a file.
    pub(crate) fn at<P: std::fmt::Display>(error: &place::Error<P>, file: &str) -> Self {
        Self::Invalid(vec![Diagnostic::new(error, file)])
    }

    fn exit_code(&self) -> u8 {
        let core = |error: &jointplay::Error| match error {
            jointplay::Error::NotConverged(_)
            | jointplay::Error::DependentSides { .. }
            | jointplay::Error::TurnedOver { .. }
            | jointplay::Error::BeyondLimits(_)
            | jointplay::Error::NotAssembled(_)
            | jointplay::Error::NotRelieved { .. }
            | jointplay::Error::NotLeast { .. } => NO,
            _ => BAD_INPUT,
        };
        match self {
            Self::Limits(_)
            | Self::BeyondLimits(_)
            | Self::NotAssembled(_)
            | Self::Stopped(_)
            | Self::OverClearance(_)
            | Self::Infeasible(_)
            | Self::Unexpected(_)
            | Self::Unsolved(_) => NO,
            Self::Interrupted(_) => INTERRUPTED,
            Self::Core(error) => core(error),
            Self::Study(study::Error::Pose { source, .. }) => core(source),
            _ => BAD_INPUT,
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::Limits(_) | Self::BeyondLimits(_) => "limits",
            Self::OverClearance(_) => "clearance",
            Self::Stopped(_) => "stopped",
            Self::Unexpected(_) => "unexpected",
            Self::Interrupted(_) => "interrupted",
            _ if self.exit_code() == NO => "unsolved",
            Self::Write { .. } | Self::Print(_) => "output",
            _ => "input",
        }
    }

    /// Tells what went wrong on standard error, as text or as JSON.
    pub(crate) fn report(&self, json: bool) -> ExitCode {
        if let Self::Print(error) = self
            && error.kind() == io::ErrorKind::BrokenPipe
        {
            // Whoever reads has seen enough.
            return ExitCode::SUCCESS;
        }
        let mut stderr = anstream::stderr();
        let limits = match self {
            Self::Limits(broken) => report::limits(broken),
            Self::BeyondLimits(broken) => broken.clone(),
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
        // Where standard error is gone too, the exit code still says it.
        drop(written);
        ExitCode::from(self.exit_code())
    }
}
