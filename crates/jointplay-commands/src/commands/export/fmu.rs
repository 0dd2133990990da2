//! Functional mock-up units.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use jointplay::format::mechanism;
use jointplay::interop::fmu::{
    ArchiveError, Binary, Error, FmiVersion, Resources, archive, library_places,
};

use super::files::Files;
use crate::arguments::{RodArgs, VirtualizationName};
use crate::failure::Failure;
use crate::mechanism_input::Input;
use crate::source;

/// Largest accepted library (bytes).
const LARGEST_LIBRARY: u64 = 1 << 30;

/// Flags of `--to fmu`.
#[derive(Args)]
pub(super) struct FmuArgs {
    /// Version of FMI for --to fmu [default: 2]
    #[arg(long, value_enum, value_name = "VERSION")]
    fmi: Option<FmiName>,
    /// Library of jointplay for --to fmu, once for each platform [default: that of this command]
    #[arg(long, value_name = "PATH")]
    library: Vec<PathBuf>,
    /// Virtualization of a robot file for --to fmu [default: planar]
    #[arg(long, value_enum)]
    virtualization: Option<VirtualizationName>,
    #[command(flatten)]
    rods: RodArgs,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FmiName {
    /// FMI 2.0
    #[value(name = "2")]
    V2,
    /// FMI 3.0
    #[value(name = "3")]
    V3,
}

impl FmuArgs {
    /// Refuses flags that have no use without `--to fmu`.
    pub(super) fn refuse(&self) -> Result<(), Failure> {
        let given = [
            ("--fmi", self.fmi.is_some()),
            ("--library", !self.library.is_empty()),
            ("--virtualization", self.virtualization.is_some()),
            ("--q-mm", self.rods.q_mm.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((flag, _)) => Err(Failure::Usage(format!("{flag} needs --to fmu"))),
            None => Ok(()),
        }
    }

    /// The unit of a mechanism or robot.
    ///
    /// # Arguments
    /// * `commands` – coordinates of the initial configuration (m, rad)
    /// * `is_changed` – whether the mechanism is no longer that of its text
    pub(super) fn files(
        &self,
        input: &Input,
        commands: &[(usize, f64)],
        is_changed: bool,
        stem: &str,
    ) -> Result<Files, Failure> {
        let resources = match &input.robot_text {
            Some(text) => self.of_robot(input, text, commands, is_changed)?,
            None => self.of_mechanism(input, commands, is_changed)?,
        };
        let version = match self.fmi {
            None | Some(FmiName::V2) => FmiVersion::V2,
            Some(FmiName::V3) => FmiVersion::V3,
        };
        let bytes = archive(&resources, stem, &self.binaries()?, version).map_err(failure)?;
        Ok(Files { format: "FMU", files: vec![(format!("{stem}.fmu"), bytes)], lost: Vec::new() })
    }

    fn of_mechanism(
        &self,
        input: &Input,
        commands: &[(usize, f64)],
        is_changed: bool,
    ) -> Result<Resources, Failure> {
        if self.virtualization.is_some() || self.rods.q_mm.is_some() {
            let text = "--virtualization and --q-mm are for robot files; a mechanism has its own virtual joints, and --at";
            return Err(Failure::Usage(text.to_owned()));
        }
        let named = |&(k, value): &(usize, f64)| (input.coordinates.all()[k].name.clone(), value);
        let start = commands.iter().map(named).collect();
        Ok(match &input.text {
            Some(text) if !is_changed => Resources {
                parameters: input.replaced.clone(),
                start,
                ..Resources::for_model(text)
            },
            _ => Resources {
                start,
                ..Resources::for_model(mechanism::write(&input.file.mechanism, None))
            },
        })
    }

    fn of_robot(
        &self,
        input: &Input,
        text: &str,
        commands: &[(usize, f64)],
        is_changed: bool,
    ) -> Result<Resources, Failure> {
        if is_changed || !commands.is_empty() {
            let text = "--to fmu of a robot file takes --q-mm in place of --at, and not --rigid: its drives are the lengths of its rods";
            return Err(Failure::Usage(text.to_owned()));
        }
        let rods = self.rods.q_mm.as_ref().map(|rods| rods.0);
        let named = |(k, length): (usize, f64)| (format!("rod {}", k + 1), length);
        Ok(Resources {
            parameters: input.replaced.clone(),
            start: rods.into_iter().flatten().enumerate().map(named).collect(),
            virtualization: self.virtualization.map(|one| one.model().name().to_owned()),
            ..Resources::for_model(text)
        })
    }

    fn binaries(&self) -> Result<Vec<Binary>, Failure> {
        let own;
        let paths = if self.library.is_empty() {
            own = [own_library()?];
            &own[..]
        } else {
            &self.library
        };
        let read = |path: &PathBuf| {
            let bytes = source::read_bytes(path, LARGEST_LIBRARY)?;
            let named = |error| Failure::Usage(format!("{}: {error}", path.display()));
            Binary::new(bytes).map_err(named)
        };
        paths.iter().map(read).collect()
    }
}

/// The library that was built with this command, or installed next to it.
fn own_library() -> Result<PathBuf, Failure> {
    let command = std::env::current_exe().unwrap_or_default();
    let folder = command.parent().map(PathBuf::from).unwrap_or_default();
    let places = library_places(&folder);
    let installed = format!("{DLL_PREFIX}jointplay{DLL_SUFFIX}");
    // Of several the newest: Cargo does not renew all of them with every build.
    let dated = |path: &PathBuf| Some((path.metadata().ok()?.modified().ok()?, path.clone()));
    if let Some((_, found)) = places.iter().filter_map(dated).max() {
        return Ok(found);
    }
    let listed: Vec<String> = places.iter().map(|path| path.display().to_string()).collect();
    Err(Failure::Usage(format!(
        "--to fmu needs the library of jointplay, which is none of {}\n  build it from a copy of the repository by `cargo xtask c-library --prefix FOLDER`, and use --library FOLDER/lib/{installed}",
        listed.join(", ")
    )))
}

fn failure(error: ArchiveError) -> Failure {
    match error {
        ArchiveError::Model(Error::Core(error)) => Failure::Core(error),
        ArchiveError::Model(error) if error.is_infeasible() => Failure::Unsolved(error.to_string()),
        other => Failure::Usage(other.to_string()),
    }
}
