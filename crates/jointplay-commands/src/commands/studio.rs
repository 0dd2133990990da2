//! `jointplay studio`: the graphical interface, in a browser.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::cell::MAX_BYTES as MAX_CELL_BYTES;
use jointplay::format::mechanism::MAX_BYTES as MAX_MECHANISM_BYTES;
use jointplay_studio::{
    CellFiles, DEFAULT_PORT, EXAMPLE, Error, MechanismFileOnDisk, RobotFileOnDisk, Server,
};
use serde::Serialize;

use crate::arguments::{RobotArgs, whole};
use crate::failure::Failure;
use crate::model_input::expanded;
use crate::output::FormatArgs;
use crate::source::{Kind, Source};

/// Show robots, mechanisms and work cells in the browser: pose, drive, compare models, edit and check
///
/// Serves the page on this machine only, until Ctrl-C.
/// The server has an HTTP API; it is described in /api/v1/openapi.json.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay studio
  jointplay studio hexapod
  jointplay studio my-mechanism.toml
  jointplay studio arm.urdf --loops arm-loops.toml
  jointplay studio --cell
  jointplay studio --robot my-robot.toml --port 8080 --no-open
  jointplay studio --ping                              exit code 1 if none answers")]
pub(crate) struct Studio {
    /// Robot, mechanism or work cell file (TOML), model (MJCF, SDF, URDF, .FCStd), or a name from `jointplay
    /// catalogue`
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
    /// Also show a mechanism (TOML), a model (MJCF, SDF, URDF, .FCStd), or a mechanism from `jointplay
    /// catalogue`
    #[arg(long, value_name = "FILE")]
    mechanism: Option<PathBuf>,
    /// File that closes the loops of the model (TOML or YAML), as in `jointplay import`
    #[arg(long, value_name = "FILE")]
    loops: Option<PathBuf>,
    /// Do not open the browser
    #[arg(long)]
    no_open: bool,
    /// Start nothing, and report whether a studio answers on the port
    #[arg(long, conflicts_with_all = ["file", "robot", "cell", "mechanism", "loops", "no_open"])]
    ping: bool,
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
        if self.ping {
            return self.ping();
        }
        let Some(file) = &self.file else {
            return self.serve(&self.robot, self.cell.as_deref(), self.mechanism.as_deref());
        };
        // The largest limit of all kinds; the file is read again with that of its kind.
        let source = Source::read(file, MAX_CELL_BYTES.max(MAX_MECHANISM_BYTES))?;
        let kinds = [Kind::ThreeRods, Kind::Mechanism, Kind::Model, Kind::Cell];
        source.require(&kinds, "a robot, a mechanism or a work cell")?;
        let twice = |what: &str, flag: &str| {
            let text = format!("the {what} is given twice: by FILE and by {flag}");
            Err(Failure::Usage(text))
        };
        match source.kind() {
            Some(Kind::Cell) if self.cell.is_some() => twice("work cell", "--cell"),
            Some(Kind::Cell) => self.serve(&self.robot, Some(file), self.mechanism.as_deref()),
            Some(Kind::Mechanism | Kind::Model) if self.mechanism.is_some() => {
                twice("mechanism", "--mechanism")
            }
            Some(Kind::Mechanism | Kind::Model) => {
                self.serve(&self.robot, self.cell.as_deref(), Some(file))
            }
            _ => self.serve(&self.robot.or(file)?, self.cell.as_deref(), self.mechanism.as_deref()),
        }
    }

    /// Prints the address of the studio that runs already.
    fn ping(&self) -> Result<(), Failure> {
        let port = self.port.unwrap_or(DEFAULT_PORT);
        let url = jointplay_studio::ping(port).map_err(|error| {
            Failure::Unsolved(format!("no studio answers on port {port} of 127.0.0.1: {error}"))
        })?;
        self.format.print(&Address { url: &url }, |Address { url }| format!("studio: {url}\n"))
    }

    fn serve(
        &self,
        robot: &RobotArgs,
        cell: Option<&Path>,
        mechanism: Option<&Path>,
    ) -> Result<(), Failure> {
        let mechanism = mechanism.map(|path| self.mechanism_file(path)).transpose()?;
        if self.loops.is_some() && mechanism.is_none() {
            let text = "--loops closes the loops of a model: name its file too";
            return Err(Failure::Usage(text.to_owned()));
        }
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
        let server = server.with_robot_file(robot_file(robot)?);
        let server = match cell {
            None => server,
            Some(path) => server.with_cell(cell_files(path)?),
        };
        let server = match mechanism {
            None => server,
            Some(file) => server.with_mechanism(file),
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

    /// A mechanism for the page; errors in its text are shown there.
    fn mechanism_file(&self, path: &Path) -> Result<MechanismFileOnDisk, Failure> {
        let source = Source::read(path, MAX_MECHANISM_BYTES)?;
        source.require(&[Kind::Mechanism, Kind::Model, Kind::ThreeRods], "a mechanism")?;
        let is_model = source.kind() == Some(Kind::Model);
        if self.loops.is_some() && !is_model {
            let found = source.kind().map_or("a file of an unknown kind", Kind::noun);
            let text = format!(
                "--loops needs a model (MJCF, SDF, URDF, .FCStd), but {} is {found}",
                source.label
            );
            return Err(Failure::Usage(text));
        }
        let read = |path: &PathBuf| Ok::<_, Failure>(Source::read(path, MAX_MECHANISM_BYTES)?.text);
        let loops = self.loops.as_ref().map(read).transpose()?;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let on_disk = path.is_file() && source.kind() == Some(Kind::Mechanism);
        let text = if is_model { expanded(&source)?.text } else { source.text };
        Ok(MechanismFileOnDisk { name, path: on_disk.then(|| path.to_owned()), text, loops })
    }
}

/// The text of the robot file.
fn robot_file(robot: &RobotArgs) -> Result<RobotFileOnDisk, Failure> {
    let (name, text) = robot.text()?;
    let path = robot.file().map(Path::to_owned);
    let parameters = robot.set.replaced().into_iter().collect();
    Ok(RobotFileOnDisk { name, path, text, parameters })
}

/// The files of a work cell; errors in the cell file are reported on standard error and shown on the page.
fn cell_files(path: &Path) -> Result<CellFiles, Failure> {
    if path == Path::new(EXAMPLE) && !path.exists() {
        return Ok(CellFiles::example());
    }
    if path.exists() || path.extension().is_none() {
        Source::read(path, MAX_CELL_BYTES)?.require(&[Kind::Cell], "a work cell")?;
    }
    let files = CellFiles::open(path).map_err(Failure::Robot)?;
    let errors = files.errors();
    if !errors.is_empty() {
        let text = format!("{}\nthe errors can be fixed in the studio", errors.join("\n"));
        // If standard error is closed, the page still shows them.
        let _ = writeln!(anstream::stderr(), "{text}");
    }
    Ok(files)
}
