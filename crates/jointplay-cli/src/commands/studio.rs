//! `jointplay studio`: the graphical interface, in a browser.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::cell::MAX_BYTES;
use jointplay_studio::{CellFiles, EXAMPLE, Error, Server};
use serde::Serialize;

use crate::arguments::{RobotArgs, whole};
use crate::failure::Failure;
use crate::output::FormatArgs;
use crate::source::{Kind, Source};

/// Show robots and work cells in the browser: pose, jog, compare models, edit and check programs
///
/// Serves the page on this machine only, until Ctrl-C.
/// The server has an HTTP API; it is described in /api/v1/openapi.json.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay studio
  jointplay studio --cell
  jointplay studio --robot my-robot.toml --port 8080 --no-open")]
pub(crate) struct Studio {
    /// Robot or work cell file (TOML), or a robot from `jointplay catalogue`
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    #[command(flatten)]
    robot: RobotArgs,
    /// Port of 127.0.0.1 to serve on [default: 4816, or a free port if it is taken]
    #[arg(long, value_name = "N", value_parser = |text: &str| whole::<u16>(text, 0, 65_535))]
    port: Option<u16>,
    /// Also show a work cell (TOML) and the program with the same name that ends in .program; without FILE, the included example
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = EXAMPLE)]
    cell: Option<PathBuf>,
    /// Do not open the browser
    #[arg(long)]
    no_open: bool,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

/// The address of a running server.
#[derive(Serialize)]
struct Address<'a> {
    url: &'a str,
}

impl Studio {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let Some(file) = &self.file else { return self.serve(&self.robot, self.cell.as_deref()) };
        let source = Source::read(file, MAX_BYTES)?;
        source.require(&[Kind::ThreeRods, Kind::Cell], "a three-rod robot or a work cell")?;
        if source.kind() != Some(Kind::Cell) {
            return self.serve(&self.robot.or(file)?, self.cell.as_deref());
        }
        if self.cell.is_some() {
            let text = "the work cell is given twice: by FILE and by --cell";
            return Err(Failure::Usage(text.to_owned()));
        }
        self.serve(&self.robot, Some(file))
    }

    fn serve(&self, robot: &RobotArgs, cell: Option<&Path>) -> Result<(), Failure> {
        let file = robot.file();
        let folder = file.map(|file| match file.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        });
        let bound = Server::bind(robot.load()?, folder, self.port);
        let server = bound.map_err(|error| match (error, file) {
            (Error::Mesh(error), Some(file)) => Failure::at(&error, &file.display().to_string()),
            (error, _) => error.into(),
        })?;
        let server = match cell {
            None => server,
            Some(path) if path == Path::new(EXAMPLE) && !path.exists() => {
                server.with_cell(CellFiles::example())
            }
            Some(path) => {
                if path.exists() || path.extension().is_none() {
                    Source::read(path, MAX_BYTES)?.require(&[Kind::Cell], "a work cell")?;
                }
                let files = CellFiles::open(path).map_err(Failure::Robot)?;
                let errors = files.errors();
                if !errors.is_empty() {
                    let text =
                        format!("{}\nthe errors can be fixed in the studio", errors.join("\n"));
                    // If standard error is closed, the page still shows them.
                    let _ = writeln!(anstream::stderr(), "{text}");
                }
                server.with_cell(files)
            }
        };
        let url = server.url();
        self.format.print(&Address { url: &url }, |Address { url }| {
            format!("studio: {url}\n  press Ctrl-C to stop\n")
        })?;
        if !self.no_open
            && let Err(error) = open::that_detached(&url)
        {
            // If standard error is closed too, there is no reader.
            let _ = writeln!(anstream::stderr(), "cannot start a browser ({error}): open {url}");
        }
        Ok(server.run()?)
    }
}
