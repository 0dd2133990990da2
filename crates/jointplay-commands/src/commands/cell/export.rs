//! `jointplay cell export`: trajectories in formats of other programs.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jointplay::format::number::{counted, number};
use jointplay::interop::export::dialect::{DIALECTS, Dialect, IncludedDialect, MAX_BYTES};
use jointplay::interop::export::{
    self, COLUMN_GROUPS, DEFAULT_COLUMNS, MotionExport, POSE_COLUMNS, SampleColumn, SampleOptions,
    sample_columns, select_columns,
};
#[cfg(feature = "parquet")]
use jointplay::report::TableError;
use jointplay::report::{TableColumn, TextTable, table};
use serde::Serialize;

use super::input::{InputArgs, Planned};
use super::text::violations;
use crate::arguments::finite;
use crate::failure::Failure;
use crate::folder::{self, Contents, ForceArgs, Staged, WrittenFile};
use crate::output;
use crate::progress::Progress;
use crate::source::{STANDARD, label, read_text};

/// A sampling rate (Hz).
#[derive(Clone, Copy)]
pub(super) struct Rate(pub(super) f64);

pub(super) fn rate(text: &str) -> Result<Rate, String> {
    let value = finite(text)?;
    if (0.1..=100_000.0).contains(&value) {
        Ok(Rate(value))
    } else {
        Err(format!("sampling rate must be from 0.1 to 100000 Hz, got {} Hz", number(value)))
    }
}

/// Export the trajectory of a program: tables, glTF, MCAP, SolidWorks, controller text
///
/// Every file has exactly the duration of the trajectory; tables (csv, parquet) can have chosen columns, and a window of time.
/// A program with violations is exported only with --despite-errors; names and contents of the files then contain a warning.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell export
  jointplay cell export --to gltf --rate 60 --out scene
  jointplay cell export --columns time,heading,tilt --from-s 10 --to-s 12.5 --out approach
  jointplay cell export --poses --out poses
  jointplay cell export --columns list
  jointplay cell export --to text --dialect points --out controller

Exit codes: 0 written, 1 not safe to run or unreachable, 2 bad input or usage, 130 interrupted.")]
pub(super) struct Export {
    #[command(flatten)]
    pub(super) input: InputArgs,
    /// Formats, separated by commas; parquet and mcap need a build with the feature of that name [default: csv,gltf,solidworks,text; with chosen columns or a window: csv]
    #[arg(long, value_enum, value_delimiter = ',')]
    to: Vec<Kind>,
    /// Columns of the tables, by name or group, separated by commas; `list` prints all names and groups
    #[arg(long, value_name = "COLUMNS", value_delimiter = ',')]
    columns: Vec<String>,
    /// Add the poses of rods, platform, links and wafers on effectors in the base frame to the tables: origin, and unit quaternion
    #[arg(long)]
    poses: bool,
    /// Start of the window of the tables [default: start of the motion]
    #[arg(long, value_name = "S", value_parser = finite)]
    from_s: Option<f64>,
    /// End of the window of the tables [default: end of the motion]
    #[arg(long, value_name = "S", value_parser = finite)]
    to_s: Option<f64>,
    /// Dialect of the controller text: an included one (neutral, points), or a dialect file [default: neutral]
    #[arg(long, value_name = "DIALECT")]
    dialect: Option<PathBuf>,
    /// Sampling rate
    #[arg(long, value_name = "HZ", default_value = "100", value_parser = rate)]
    rate: Rate,
    /// Largest deviation of points of the animated 3D scene, and of those that motors of SolidWorks move, from the samples that are left to interpolation
    #[arg(long, value_name = "UM", default_value = "1", value_parser = finite)]
    tolerance_um: f64,
    /// Folder for the files
    #[arg(short, long, value_name = "FOLDER", default_value = "cell-export")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgs,
    /// Export a program with violations
    #[arg(long)]
    despite_errors: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// samples as comma-separated values
    Csv,
    /// samples as Parquet
    #[cfg(feature = "parquet")]
    Parquet,
    /// animated 3D scene of the cell, one binary glTF file
    Gltf,
    /// joint states, trajectories and transforms, for Foxglove and ROS 2
    #[cfg(feature = "mcap")]
    Mcap,
    /// time series of each axis, and a macro that loads them
    Solidworks,
    /// controller text, by --dialect
    Text,
}

/// Argument of `--columns` that prints the columns.
const LIST: &str = "list";

impl Kind {
    fn is_table(self) -> bool {
        match self {
            Self::Csv => true,
            #[cfg(feature = "parquet")]
            Self::Parquet => true,
            _ => false,
        }
    }
}

/// A dialect, and its name in messages.
struct NamedDialect {
    dialect: Dialect,
    label: String,
}

/// Data common to the files of all formats.
struct FileContents<'a> {
    /// Name of a file without its ending.
    stem: &'a str,
    dialect: &'a NamedDialect,
    table: &'a SampleOptions,
}

/// The columns that tables can have.
#[derive(Serialize)]
struct ColumnList {
    columns: Vec<ListedColumn>,
    groups: Vec<ListedGroup>,
}

#[derive(Serialize)]
struct ListedColumn {
    name: String,
    meaning: String,
    groups: Vec<String>,
}

#[derive(Serialize)]
struct ListedGroup {
    name: &'static str,
    meaning: &'static str,
}

/// The files written.
#[derive(Serialize)]
struct Written {
    result: &'static str,
    violations: usize,
    duration_s: f64,
    rate_hz: f64,
    files: Vec<PathBuf>,
    /// Names of the columns of the tables; `null` for the default ones.
    columns: Option<Vec<String>>,
    /// First and last time of the tables; `null` for the whole motion.
    window_s: Option<[f64; 2]>,
}

impl Export {
    pub(super) fn run(&self) -> Result<(), Failure> {
        if self.columns.iter().any(|name| name == LIST) {
            return self.list_columns();
        }
        let kinds = self.kinds()?;
        folder::check_folder(&self.out, self.force)?;
        let dialect = dialect(self.dialect.as_deref().unwrap_or(Path::new(DIALECTS[0].name)))?;
        let columns = self.selected_columns()?;
        let planned = self.input.plan()?;
        if !planned.passed() && !self.despite_errors {
            let count = counted(planned.report.violations.len(), "violation");
            return Err(Failure::Unsolved(format!(
                "{}: {count}, not safe to run\n{}nothing is exported; use --despite-errors to export it anyway",
                planned.input.label,
                violations(&planned)
            )));
        }
        let table = self.table(&planned, columns);
        let files = self.files(&planned, &kinds, &dialect, &table)?;
        let names = |columns: &Vec<SampleColumn>| {
            columns.iter().map(|column| column.name.clone()).collect()
        };
        let written = Written {
            result: planned.document().result,
            violations: planned.report.violations.len(),
            duration_s: planned.motion.duration(),
            rate_hz: self.rate.0,
            files: files.iter().map(|file| file.path.clone()).collect(),
            columns: table.columns.as_ref().map(names),
            window_s: table.window,
        };
        if self.input.format().json() {
            output::json(&written)
        } else {
            output::text(&text(&written, &files))
        }
    }

    /// The formats without repetitions.
    fn kinds(&self) -> Result<Vec<Kind>, Failure> {
        let has_window = self.from_s.is_some() || self.to_s.is_some();
        let mut kinds: Vec<Kind> = Vec::new();
        for &kind in &self.to {
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        if kinds.is_empty() {
            let for_tables = has_window || self.poses || !self.columns.is_empty();
            let all: &[Kind] = &[Kind::Csv, Kind::Gltf, Kind::Solidworks, Kind::Text];
            kinds = if for_tables { vec![Kind::Csv] } else { all.to_vec() };
        }
        let other = kinds.iter().find(|kind| !kind.is_table());
        if let (Some(other), true) = (other, has_window) {
            let name = other.to_possible_value().map_or(String::new(), |one| one.get_name().into());
            return Err(Failure::Usage(format!(
                "--from-s and --to-s select rows of tables, but --to {name} always has the whole motion; use --to csv"
            )));
        }
        let option = if self.poses { "--poses adds" } else { "--columns selects" };
        if (self.poses || !self.columns.is_empty()) && !kinds.iter().any(|kind| kind.is_table()) {
            return Err(Failure::Usage(format!(
                "{option} columns of tables, but --to names no table; use --to csv"
            )));
        }
        self.refuse_dialect_without_text(&kinds)?;
        Ok(kinds)
    }

    fn refuse_dialect_without_text(&self, kinds: &[Kind]) -> Result<(), Failure> {
        if self.dialect.is_none() || kinds.contains(&Kind::Text) {
            return Ok(());
        }
        let text = "--dialect is for controller text, which is not exported; use --to text";
        Err(Failure::Usage(text.to_owned()))
    }

    /// The chosen columns; unknown ones are refused before the planning.
    fn selected_columns(&self) -> Result<Option<Vec<SampleColumn>>, Failure> {
        let mut names = self.columns.clone();
        if self.poses {
            if names.is_empty() {
                names.push(DEFAULT_COLUMNS.to_owned());
            }
            names.push(POSE_COLUMNS.to_owned());
        }
        if names.is_empty() {
            return Ok(None);
        }
        let cell = self.input.load()?.cell.cell;
        let columns = select_columns(&cell, &names);
        columns.map(Some).map_err(|error| Failure::Usage(error.to_string()))
    }

    /// Rows and columns of the tables.
    fn table(&self, planned: &Planned, columns: Option<Vec<SampleColumn>>) -> SampleOptions {
        let has_window = self.from_s.is_some() || self.to_s.is_some();
        let (from, to) = (self.from_s.unwrap_or(0.0), self.to_s);
        let window = has_window.then(|| [from, to.unwrap_or(planned.motion.duration())]);
        SampleOptions { window, columns, ..SampleOptions::at_rate(self.rate.0) }
    }

    /// Prints the columns that tables can have.
    fn list_columns(&self) -> Result<(), Failure> {
        let cell = self.input.load()?.cell.cell;
        let column =
            |SampleColumn { name, meaning, groups, .. }| ListedColumn { name, meaning, groups };
        let columns = sample_columns(&cell).into_iter().map(column).collect();
        let groups = COLUMN_GROUPS.map(|(name, meaning)| ListedGroup { name, meaning }).into();
        self.input.format().print(&ColumnList { columns, groups }, columns_text)
    }

    /// Writes the files of all formats.
    fn files(
        &self,
        planned: &Planned,
        kinds: &[Kind],
        dialect: &NamedDialect,
        table: &SampleOptions,
    ) -> Result<Vec<WrittenFile>, Failure> {
        let motion_export = planned.motion_export();
        let stem = format!("{}{}", planned.input.cell.stem, motion_export.name_warning());
        let contents = FileContents { stem: &stem, dialect, table };
        let progress = Progress::new(kinds.len());
        let reporter = progress.reporter();
        reporter.stage("writing");
        reporter.parts(kinds.len());
        let mut staged = Staged::into(&self.out, self.force)?;
        for &kind in kinds {
            self.file(kind, &motion_export, &contents, &mut staged)?;
            reporter.part_done();
        }
        staged.publish()
    }

    fn file(
        &self,
        kind: Kind,
        motion_export: &MotionExport<'_>,
        &FileContents { stem, dialect, table }: &FileContents<'_>,
        staged: &mut Staged,
    ) -> Result<(), Failure> {
        let Rate(rate) = self.rate;
        match kind {
            Kind::Csv => csv(staged, &format!("{stem}.csv"), motion_export, table),
            #[cfg(feature = "parquet")]
            Kind::Parquet => parquet(staged, &format!("{stem}.parquet"), motion_export, table),
            Kind::Gltf => staged.add(&format!("{stem}.glb"), |writer| {
                let scene = export::gltf_within(motion_export, rate, 1e-6 * self.tolerance_um)?;
                Ok(writer.write_all(&scene)?)
            }),
            #[cfg(feature = "mcap")]
            Kind::Mcap => mcap(staged, &format!("{stem}.mcap"), motion_export, rate),
            Kind::Solidworks => {
                let tolerance = 1e-6 * self.tolerance_um;
                for (index, name) in export::motors(motion_export).iter().enumerate() {
                    staged.add(name, |mut writer| {
                        Ok(export::motor(motion_export, rate, tolerance, index, &mut writer)??)
                    })?;
                }
                let (name, text) = export::loader(motion_export);
                staged.add(&name, |writer| Ok(writer.write_all(text.as_bytes())?))
            }
            Kind::Text => {
                let NamedDialect { dialect, label } = dialect;
                let name = format!("{stem}-{}.{}", dialect.name, dialect.extension);
                staged.add(&name, |writer| {
                    let written = dialect.write_in_parts(motion_export, rate, |part| {
                        Ok::<_, Contents>(writer.write_all(part.as_bytes())?)
                    });
                    written.map_err(|error| match error {
                        Contents::Other(Failure::Export(export::Error::Dialect(errors))) => {
                            Contents::Other(Failure::invalid(&errors, label))
                        }
                        other => other,
                    })
                })
            }
        }
    }
}

/// The samples of a trajectory as comma-separated values.
pub(super) fn csv(
    staged: &mut Staged,
    name: &str,
    motion_export: &MotionExport<'_>,
    options: &SampleOptions,
) -> Result<(), Failure> {
    staged.add(name, |mut writer| {
        let mut header = true;
        export::samples_in_parts(motion_export, options, |columns| {
            table::write_csv(columns, std::mem::take(&mut header), &mut writer)?;
            Ok::<_, Contents>(())
        })
    })
}

/// An included dialect, or the dialect in a file.
fn dialect(path: &Path) -> Result<NamedDialect, Failure> {
    let label = label(path);
    let is_name = !path.exists() && path.extension().is_none() && path != Path::new(STANDARD);
    let text = if is_name {
        IncludedDialect::named(&label).map_err(Failure::Usage)?.text.to_owned()
    } else {
        read_text(path, MAX_BYTES as u64)?
    };
    match Dialect::parse(&text) {
        Ok(dialect) => Ok(NamedDialect { dialect, label }),
        Err(errors) => Err(Failure::invalid(&errors, &label)),
    }
}

#[cfg(feature = "parquet")]
fn parquet(
    staged: &mut Staged,
    name: &str,
    motion_export: &MotionExport<'_>,
    options: &SampleOptions,
) -> Result<(), Failure> {
    let failed = |error: TableError| match error {
        TableError::Write(source) => Contents::Write(source),
        _ => Contents::Other(Failure::Parquet),
    };
    staged.add(name, |writer| {
        // The writer needs the columns of the first part.
        let mut file = None;
        let mut writer = Some(writer);
        export::samples_in_parts(motion_export, options, |columns| {
            if let Some(writer) = writer.take() {
                file = Some(table::ParquetTable::new(columns, writer).map_err(failed)?);
            }
            file.as_mut().map_or(Ok(()), |file| file.push(columns)).map_err(failed)
        })?;
        file.map_or(Ok(()), |file| file.finish().map(drop)).map_err(failed)
    })
}

#[cfg(feature = "mcap")]
fn mcap(
    staged: &mut Staged,
    name: &str,
    motion_export: &MotionExport<'_>,
    rate: f64,
) -> Result<(), Failure> {
    staged.add(name, |writer| Ok(writer.write_all(&export::mcap::write(motion_export, rate)?)?))
}

fn columns_text(list: &ColumnList) -> String {
    let rows = |rows: Vec<[String; 2]>| rows.into_iter().map(Vec::from).collect();
    let columns = list.columns.iter().map(|one| [one.name.clone(), one.meaning.clone()]).collect();
    let groups = list.groups.iter().map(|one| [one.name.to_owned(), one.meaning.to_owned()]);
    let table = |title, rows| TextTable {
        title,
        columns: vec![TableColumn::text("name"), TableColumn::text("meaning")],
        rows,
    };
    format!(
        "{}\n{}the name of an axis, of an effector, and of a column without its unit are groups\n",
        table("columns", rows(columns)).to_text(),
        table("groups", rows(groups.collect())).to_text(),
    )
}

fn text(written: &Written, files: &[WrittenFile]) -> String {
    let mut text = format!(
        "trajectory of {:.3} s at {} samples/s\n",
        written.duration_s,
        number(written.rate_hz)
    );
    if written.violations > 0 {
        text.push_str("NOT SAFE TO RUN: every file contains this warning\n");
    }
    for WrittenFile { path, length } in files {
        text.push_str(&format!("  {:<44} {length:>12} bytes\n", path.display()));
    }
    text
}
