//! Mechanism files and values for their joints, as given on the command line.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::coordinates::Coordinates;
use jointplay::format::import::{self, Imported};
use jointplay::format::mechanism::{self, MAX_BYTES, MechanismFile};
use jointplay::format::number::number;
use jointplay::format::report;
use jointplay::format::units::m_from_mm;
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{
    Closure, Commanded, MechanismSystem, Relief, ReliefSolver, SparseSystem, assemble, branches,
    guess, relieve,
};
use jointplay::mobility::TOLERANCES;
use jointplay::nalgebra::DVector;
use jointplay::{Error, format};

use crate::arguments::finite;
use crate::failure::Failure;
use crate::output::{self, FormatArgs};
use crate::source::{Kind, Source};

/// Other starts tried where the guess of a file does not close.
const STARTS: usize = 30;
/// Corrections at most of a mechanism with many loops, which is closed from its guess or not at all.
const CORRECTIONS: usize = 200;

/// `NAME=VALUE`, in the unit of the file.
#[derive(Clone, Debug)]
pub(crate) struct Assignment {
    pub(crate) name: String,
    pub(crate) value: f64,
}

pub(crate) fn assignment(text: &str) -> Result<Assignment, String> {
    let (name, value) =
        text.rsplit_once('=').ok_or_else(|| format!("{text:?} is not NAME=VALUE"))?;
    Ok(Assignment { name: name.trim().to_owned(), value: finite(value)? })
}

/// Values for parameters of the file.
#[derive(Args)]
pub(crate) struct SetArgs {
    /// Other values for parameters of the file, in its units
    #[arg(long, value_name = "PARAMETER=VALUE", value_delimiter = ',', value_parser = assignment)]
    pub(crate) set: Vec<Assignment>,
}

impl SetArgs {
    pub(crate) fn refuse_without_file(&self) -> Result<(), Failure> {
        if self.set.is_empty() {
            Ok(())
        } else {
            Err(Failure::Usage("--set needs a mechanism file".to_owned()))
        }
    }
}

/// How true the dimensions of a mechanism are.
#[derive(Args)]
pub(crate) struct ToleranceArgs {
    /// Take dimensions as true only to this share: of the characteristic length, and in radians; from 1e-11 to 1e-2
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(crate) tolerance: Option<f64>,
}

fn share(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if TOLERANCES.contains(&value) {
        Ok(value)
    } else {
        let (least, greatest) = (TOLERANCES.start(), TOLERANCES.end());
        Err(format!("{} is not within {least:e} to {greatest:e}", number(value)))
    }
}

/// What every command about one mechanism has.
#[derive(Args)]
pub(crate) struct MechanismArgs {
    /// Mechanism file (TOML), model (MJCF, SDF, URDF), or a name from `jointplay catalogue`
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

impl MechanismArgs {
    pub(crate) fn load(&self) -> Result<Input, Failure> {
        Input::read(&self.file, &self.set.set)
    }

    pub(crate) fn path(&self) -> &Path {
        &self.file
    }
}

/// The model of another program.
pub(crate) fn imported(source: &Source) -> Result<Imported, Failure> {
    import::parse(&source.text).map_err(|error| Failure::at(&error, &source.label))
}

/// A mechanism file as read.
pub(crate) struct Input {
    pub(crate) file: MechanismFile,
    pub(crate) coordinates: Coordinates,
    /// Mismatch that counts as closed, in radians and characteristic lengths; `None` for loops that close exactly.
    pub(crate) tolerance: Option<f64>,
}

/// A closed configuration, with virtual joints displaced where they had to be.
pub(crate) struct Posed {
    /// (f + M) [m, rad], and how well the loops close there.
    pub(crate) closed: Closure,
    pub(crate) relief: Option<Relief>,
}

/// The largest length [mm] and the largest angle [deg] that a joint may be asked for: a kilometre, or 10,000 turns.
const FARTHEST: (f64, f64) = (1e6, 3.6e6);

impl Input {
    /// Reads a mechanism file, a model, or a mechanism of the catalogue.
    pub(crate) fn read(path: &Path, set: &[Assignment]) -> Result<Self, Failure> {
        Self::parse(&Source::read(path, MAX_BYTES)?, set)
    }

    pub(crate) fn parse(source: &Source, set: &[Assignment]) -> Result<Self, Failure> {
        source.require(&[Kind::Mechanism, Kind::Model], "a mechanism")?;
        if import::is_model(&source.text) {
            if let Some(one) = set.first() {
                let name = &one.name;
                return Err(Failure::Usage(format!(
                    "--set {name}: a model has no parameters; `jointplay import` makes a mechanism file of it, which can have some"
                )));
            }
            let model = imported(source)?;
            output::ignored(&model.ignored);
            let file = model.into_file();
            let coordinates = Coordinates::of(&file);
            return Ok(Self { file, coordinates, tolerance: None });
        }
        let replaced: Vec<(String, f64)> =
            set.iter().map(|one| (one.name.clone(), one.value)).collect();
        let file = mechanism::parse_with(&source.text, &replaced)
            .map_err(|error| Failure::at(&error, &source.label))?;
        let coordinates = Coordinates::of(&file);
        Ok(Self { file, coordinates, tolerance: None })
    }

    /// Index of the joint coordinate of a name.
    pub(crate) fn find(&self, name: &str) -> Result<usize, Failure> {
        Ok(self.coordinates.find(&self.file.mechanism, name)?)
    }

    /// Coordinates that are asked for, with their values [m, rad].
    pub(crate) fn commands(&self, at: &[Assignment]) -> Result<Vec<(usize, f64)>, Failure> {
        at.iter()
            .map(|one| {
                let k = self.find(&one.name)?;
                Ok((k, self.value(k, one.value)?))
            })
            .collect()
    }

    /// A value of a coordinate in the unit of the file [m, rad], refused where no joint goes so far.
    pub(crate) fn value(&self, k: usize, value: f64) -> Result<f64, Failure> {
        let si = self.coordinates.to_si(k, value);
        let most = match self.coordinates.all()[k].quantity {
            Coordinate::Slide => m_from_mm(FARTHEST.0),
            Coordinate::Turn => FARTHEST.1.to_radians(),
        };
        if si.abs() <= most {
            return Ok(si);
        }
        let (name, unit) = (&self.coordinates.all()[k].name, self.coordinates.unit(k));
        Err(Failure::Usage(format!(
            "{name} = {} {unit} is too far, values have to lie within ±{} {unit}",
            number(value),
            number(self.coordinates.from_si(k, most))
        )))
    }

    /// The guesses of the file, with these coordinates at their values.
    fn start(&self, commands: &[(usize, f64)]) -> DVector<f64> {
        let mut start = guess(&self.file.mechanism);
        commands.iter().for_each(|&(k, value)| start[k] = value);
        start
    }

    /// The closed configuration nearest the guesses, with these coordinates held.
    pub(crate) fn assembled(&self, commands: &[(usize, f64)]) -> Result<Closure, Failure> {
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        // Near misses are for dense algebra, which says so itself where it cannot.
        if !self.is_dense() && self.tolerance.is_none() {
            return self.sparse(commands).map(|(system, iterations)| system.closure(iterations));
        }
        let found = assemble(&self.file.mechanism, &self.start(commands), &held, STARTS);
        match (found, self.tolerance) {
            (Err(Error::NotAssembled(found)), Some(tolerance)) => match found.within(tolerance) {
                Some(closure) => Ok(closure.clone()),
                None => Err(self.unassembled(Error::NotAssembled(found))),
            },
            (found, _) => found.map_err(|error| self.unassembled(error)),
        }
    }

    /// Whether the mechanism is small enough for dense algebra.
    pub(crate) fn is_dense(&self) -> bool {
        MechanismSystem::fits(&self.file.mechanism)
    }

    /// The closed configuration nearest the guesses by sparse algebra, and the corrections done.
    pub(crate) fn sparse(
        &self,
        commands: &[(usize, f64)],
    ) -> Result<(SparseSystem<'_>, usize), Failure> {
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let mut system = SparseSystem::new(&self.file.mechanism, self.start(commands))?;
        match system.close(&held, CORRECTIONS) {
            Ok(iterations) => Ok((system, iterations)),
            Err(error @ Error::NotReached { .. }) => {
                Err(Failure::NotAssembled(format::explain::explain(&error)))
            }
            Err(other) => Err(other.into()),
        }
    }

    /// Closed configurations found from that many other starts.
    pub(crate) fn branches(
        &self,
        commands: &[(usize, f64)],
        starts: usize,
    ) -> Result<Vec<Closure>, Failure> {
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        Ok(branches(&self.file.mechanism, &self.start(commands), &held, starts)?)
    }

    /// The closed configuration with these coordinates held, by virtual joints where it takes them.
    pub(crate) fn posed(&self, commands: &[(usize, f64)]) -> Result<Posed, Failure> {
        let closed = self.assembled(commands);
        let has_play = !self.file.mechanism.virtual_joints().is_empty();
        match closed {
            Ok(closed) => Ok(Posed { closed, relief: None }),
            Err(Failure::NotAssembled(_)) if has_play && !commands.is_empty() => {
                let relief = self.relieved(commands)?;
                let closed = Closure {
                    coordinates: relief.coordinates.clone(),
                    residual: relief.residual,
                    iterations: relief.iterations,
                };
                Ok(Posed { closed, relief: Some(relief) })
            }
            Err(other) => Err(other),
        }
    }

    /// The least displacement of the virtual joints that lets these coordinates be where they are asked to be.
    pub(crate) fn relieved(&self, commands: &[(usize, f64)]) -> Result<Relief, Failure> {
        let mechanism = &self.file.mechanism;
        let home = MechanismSystem::new(mechanism, self.assembled(&[])?.coordinates)?;
        let (coordinates, values): (Vec<usize>, Vec<f64>) = commands.iter().copied().unzip();
        let commanded = Commanded::new(&home, &coordinates)?;
        let start = commanded.start(values, mechanism.virtual_joints().len());
        let system = MechanismSystem::new(mechanism, start)?;
        relieve(&system, &commanded, ReliefSolver::LeastNorm).map_err(|error| {
            // Values that the commanded joints cannot have are the better reason.
            let beyond = mechanism.beyond_limits(system.home());
            let beyond: Vec<_> =
                beyond.into_iter().filter(|one| coordinates.contains(&one.coordinate)).collect();
            match beyond.is_empty() {
                true => error.into(),
                false => Failure::BeyondLimits(report::beyond_limits(&self.coordinates, &beyond)),
            }
        })
    }

    /// Refuses a configuration that is beyond joint limits or clearances.
    ///
    /// # Arguments
    /// * `values` – (f + M), or (f) where clearances are not to be looked at [m, rad]
    pub(crate) fn within_limits(&self, values: &DVector<f64>) -> Result<(), Failure> {
        let beyond = self.file.mechanism.beyond_limits(values);
        if beyond.is_empty() {
            return Ok(());
        }
        Err(Failure::BeyondLimits(report::beyond_limits(&self.coordinates, &beyond)))
    }

    /// An error of the core with the configurations that were found, in the units of the file.
    fn unassembled(&self, error: Error) -> Failure {
        let Error::NotAssembled(found) = &error else { return error.into() };
        let mut text = format::explain::explain(&error);
        if found.near_miss().is_some() {
            text.push_str("\n  assemble and mobility have --tolerance for that");
        }
        for (i, branch) in found.branches.iter().enumerate() {
            let values = report::by_name(&self.coordinates, &branch.coordinates).0.into_iter();
            let listed: Vec<String> = values
                .enumerate()
                .map(|(k, (name, value))| {
                    format!("{name} = {}", output::fixed(value, self.coordinates.decimals(k)))
                })
                .collect();
            text.push_str(&format!("\n  {}: {}", i + 1, listed.join(", ")));
        }
        Failure::NotAssembled(text)
    }

    /// One line for each coordinate: name, value, unit.
    pub(crate) fn table(&self, values: &[(String, f64)], first: usize) -> String {
        let width = values.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(20);
        let line = |(i, (name, value)): (usize, &(String, f64))| {
            let (k, pad) = (first + i, width - name.chars().count());
            let number = output::fixed(*value, self.coordinates.decimals(k));
            format!("  {name}{}{number:>16} {}\n", " ".repeat(pad), self.coordinates.unit(k))
        };
        values.iter().enumerate().map(line).collect()
    }
}
