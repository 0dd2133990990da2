//! `jointplay cell report`: one page on a cell and its program.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::program::Setting;
use jointplay::interop::export::report_page;
use jointplay::report::{CellReport, KeyFigure, PageProgram, TableColumn, TextTable, key_figures};
use serde::Serialize;

use super::input::{InputArgs, Planned, setting};
use crate::failure::Failure;
use crate::folder::{self, ForceArgs};
use crate::output;
use crate::print_page::{Browser, print_page};

/// Write a report on a program: cell, schedule, margins, accuracy, violations and assumptions on one page
///
/// The page needs no other files, and no network. A second program, --before, is compared by its key figures.
/// A file name that ends in .pdf makes the same page as PDF, printed by a Chromium-based browser of this machine.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell report
  jointplay cell report cell.toml lot.program --before old.program --out report.pdf
  jointplay cell report cell.toml lot.program --set lot=25 --before lot.program --before-set lot=13

Exit codes: 0 no violations, 1 violations or unreachable, 2 bad input or usage, 130 interrupted.")]
pub(super) struct ReportCommand {
    #[command(flatten)]
    pub(super) input: InputArgs,
    /// Program before a change, in the same cell, for comparison
    #[arg(long, value_name = "PROGRAM")]
    before: Option<PathBuf>,
    /// Values of parameters for the program before the change, as for --set [default: those of --set]
    #[arg(long, value_name = "PARAMETER=VALUE", value_delimiter = ',', value_parser = setting, requires = "before")]
    before_set: Vec<Setting>,
    /// File of the report; its name ends in .html or .pdf
    #[arg(short, long, value_name = "FILE", default_value = "cell-report.html", value_parser = page_file)]
    out: PageFile,
    /// Browser that prints the PDF [default: the first that is found of Chromium, Chrome and Edge]
    #[arg(long, value_name = "FILE")]
    browser: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
}

/// The file of a page, and whether it is a PDF.
#[derive(Debug, Clone)]
struct PageFile {
    path: PathBuf,
    is_pdf: bool,
}

fn page_file(text: &str) -> Result<PageFile, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().map(|end| end.to_ascii_lowercase());
    match extension.as_ref().and_then(|end| end.to_str()) {
        Some("html" | "htm") => Ok(PageFile { path, is_pdf: false }),
        Some("pdf") => Ok(PageFile { path, is_pdf: true }),
        _ => Err("the name must end in .html or .pdf".to_owned()),
    }
}

/// Result of `cell report`.
#[derive(Serialize)]
struct ReportDocument {
    /// The file written.
    file: PathBuf,
    /// Result of the check: `passed` or `failed`.
    result: &'static str,
    /// Key figures of the program.
    key_figures: Vec<KeyFigure>,
    /// Key figures of the program before the change, if given.
    before: Option<Vec<KeyFigure>>,
}

impl ReportCommand {
    pub(super) fn run(&self) -> Result<(), Failure> {
        folder::check_file(&self.out.path, self.force)?;
        // A missing browser is reported before the planning.
        let browser = match self.out.is_pdf {
            true => Some(Browser::find(self.browser.as_deref())?),
            false => None,
        };
        let planned = self.input.plan()?;
        let document = planned.document();
        let before = match &self.before {
            Some(program) => {
                let set = Some(&self.before_set[..]).filter(|set| !set.is_empty());
                Some(self.input.with_program(program, set).plan()?)
            }
            None => None,
        };
        let before_document = before.as_ref().map(Planned::document);
        let page = page(&planned, &document, before.as_ref().zip(before_document.as_ref()))?;
        let bytes = match &browser {
            Some(browser) => print_page(browser, &page)?,
            None => page.into_bytes(),
        };
        folder::write_file(&self.out.path, &bytes, self.force)?;
        let written = ReportDocument {
            file: self.out.path.clone(),
            result: document.result,
            key_figures: key_figures(&document),
            before: before_document.as_ref().map(key_figures),
        };
        if self.input.format().json() {
            output::json(&written)?;
        } else {
            output::text(&text(&written))?;
        }
        planned.exit()
    }
}

/// The key figures, and the file.
fn text(written: &ReportDocument) -> String {
    let figures = written.key_figures.iter();
    let number = TableColumn::number;
    let table = match &written.before {
        None => TextTable {
            title: "key figures",
            columns: vec![TableColumn::text(""), number("")],
            rows: figures.map(|one| vec![one.name.to_owned(), one.to_text()]).collect(),
        },
        Some(before) => TextTable {
            title: "key figures",
            columns: vec![
                TableColumn::text(""),
                number("before"),
                number("after"),
                number("difference"),
            ],
            rows: figures
                .zip(before)
                .map(|(one, old)| {
                    vec![one.name.to_owned(), old.to_text(), one.to_text(), one.difference(old)]
                })
                .collect(),
        },
    };
    format!("{}written: {}\n", table.to_text(), written.file.display())
}

/// Name of the file of a program.
fn file_name(planned: &Planned) -> &str {
    let label = &planned.input.label;
    Path::new(label).file_name().and_then(|name| name.to_str()).unwrap_or(label)
}

fn page(
    planned: &Planned,
    document: &CellReport,
    before: Option<(&Planned, &CellReport)>,
) -> Result<String, Failure> {
    let name = file_name(planned);
    // Without folders, unless the names are equal.
    let names = match before {
        Some((before, _)) if file_name(before) != name => [name, file_name(before)],
        Some((before, _)) => [planned.input.label.as_str(), before.input.label.as_str()],
        None => [name, ""],
    };
    let program = PageProgram { name: names[0], text: &planned.input.text, report: document };
    let before = before.map(|(planned, report)| PageProgram {
        name: names[1],
        text: &planned.input.text,
        report,
    });
    Ok(report_page(&planned.motion_export(), &planned.report, program, before)?)
}
