//! Mechanism files and values of their joints, as given on the command line.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::command::{CommandValue, Names};
use jointplay::format::coordinates::{self, Coordinates};
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::explain::explain_unassembled;
use jointplay::format::mechanism::{self, MAX_BYTES, MechanismFile};
use jointplay::format::number::{fixed, number};
use jointplay::format::place;
use jointplay::format::{robot, three_rods};
use jointplay::interop::import;
use jointplay::mechanism::{
    Branches, ChangedDimension, Closure, FrameId, MechanismSystem, Posed, Relief, SparseSystem,
    branches, close_at_rest, close_nearly, close_sparse, commanded_guess, is_same_configuration,
    near_miss_at_guess, pose_commanded, relieve_commanded,
};
use jointplay::mobility::TOLERANCES;
use jointplay::nalgebra::DVector;
use jointplay::report;
use jointplay::virtualization::BuiltIn;
use jointplay::{Error, format};

use crate::arguments::finite;
use crate::console;
use crate::failure::Failure;
use crate::model_input::imported;
use crate::output::{self, FormatArgs};
use crate::set_args::{Assignment, SetArgs};
use crate::source::{Kind, Source};

/// `JOINT=VALUE`; the value is an expression of the parameters of the file, with an optional unit.
#[derive(Clone, Debug)]
pub(crate) struct JointValue {
    pub(crate) name: String,
    pub(crate) text: String,
}

/// `JOINT=VALUE,JOINT=VALUE,…`.
#[derive(Clone, Debug)]
pub(crate) struct JointValues(pub(crate) Vec<JointValue>);

pub(crate) fn joint_values(text: &str) -> Result<JointValues, String> {
    let one = |text: &str| {
        let (name, value) = text
            .rsplit_once('=')
            .ok_or_else(|| format!("invalid value {text:?}: expected JOINT=VALUE"))?;
        Ok(JointValue { name: name.trim().to_owned(), text: value.trim().to_owned() })
    };
    split(text, ',').into_iter().map(one).collect::<Result<_, _>>().map(JointValues)
}

/// The parts of a text between separators that are in no parentheses or brackets.
pub(crate) fn split(text: &str, separator: char) -> Vec<&str> {
    let mut depth = 0_usize;
    text.split(|character: char| {
        match character {
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        depth == 0 && character == separator
    })
    .collect()
}

/// The accuracy of the dimensions of a mechanism.
#[derive(Args)]
pub(crate) struct ToleranceArgs {
    /// Relative accuracy of the dimensions: in characteristic lengths, and in radians; from 1e-11 to 1e-2
    #[arg(long, value_name = "SHARE", value_parser = share)]
    pub(crate) tolerance: Option<f64>,
}

fn share(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if TOLERANCES.contains(&value) {
        Ok(value)
    } else {
        let (least, greatest) = (TOLERANCES.start(), TOLERANCES.end());
        Err(format!("the tolerance must be from {least:e} to {greatest:e}, got {}", number(value)))
    }
}

/// Flags of commands that analyse one mechanism.
#[derive(Args)]
pub(crate) struct MechanismArgs {
    /// Mechanism or three-rod robot (TOML), model (MJCF, SDF, URDF, .FCStd), or a name from `jointplay
    /// catalogue`
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

    /// Values of parameters given by the user, in the units of the file.
    pub(crate) fn replaced_parameters(&self) -> Vec<(String, f64)> {
        self.set.replaced()
    }
}

/// A mechanism file, parsed.
pub(crate) struct Input {
    pub(crate) file: MechanismFile,
    pub(crate) coordinates: Coordinates,
    /// Text of the mechanism file; `None` for a model.
    pub(crate) text: Option<String>,
    /// Text of the robot file, of which this is the mechanism; `None` for mechanisms and models.
    pub(crate) robot_text: Option<String>,
    /// Accepted mismatch of the loops, in radians and characteristic lengths; `None` for loops that close exactly.
    pub(crate) tolerance: Option<f64>,
    /// Values of parameters in place of those of the file.
    pub(crate) replaced: Vec<(String, f64)>,
}

impl Input {
    /// Reads a mechanism file, a model, or a mechanism of the catalogue.
    pub(crate) fn read(path: &Path, set: &[Assignment]) -> Result<Self, Failure> {
        Self::parse(&Source::read(path, MAX_BYTES)?, set)
    }

    pub(crate) fn parse(source: &Source, set: &[Assignment]) -> Result<Self, Failure> {
        source.require(&[Kind::Mechanism, Kind::Model, Kind::ThreeRods], "a mechanism")?;
        if source.kind() == Some(Kind::ThreeRods) {
            return Self::of_robot(source, set);
        }
        if import::is_model(&source.text) {
            if let Some(one) = set.first() {
                let name = &one.name;
                return Err(Failure::Usage(format!(
                    "--set {name}: a model has no parameters; convert it with `jointplay import` into a mechanism file, which can have parameters"
                )));
            }
            let model = imported(source, None)?;
            output::ignored(&model.ignored);
            let file = model.into_file();
            let coordinates = Coordinates::of(&file);
            let replaced = Vec::new();
            return Ok(Self {
                file,
                coordinates,
                text: None,
                robot_text: None,
                tolerance: None,
                replaced,
            });
        }
        let replaced: Vec<(String, f64)> =
            set.iter().map(|one| (one.name.clone(), one.value)).collect();
        let file = mechanism::parse_with(&source.text, &replaced)
            .map_err(|errors| Failure::invalid(&errors, &source.label))?;
        let coordinates = Coordinates::of(&file);
        let text = Some(source.text.clone());
        Ok(Self { file, coordinates, text, robot_text: None, tolerance: None, replaced })
    }

    /// A three-rod robot as a mechanism, with virtual joints of the planar model, as commands for robots use by default.
    fn of_robot(source: &Source, set: &[Assignment]) -> Result<Self, Failure> {
        let replaced: Vec<(String, f64)> =
            set.iter().map(|one| (one.name.clone(), one.value)).collect();
        let robot = robot::parse_with(&source.text, &replaced)
            .map_err(|errors| Failure::invalid(&errors, &source.label))?;
        let file = three_rods::mechanism_file(&robot, BuiltIn::Planar)
            .expect("the planar virtualization has slides");
        let coordinates = Coordinates::of(&file);
        let robot_text = Some(source.text.clone());
        Ok(Self { file, coordinates, text: None, robot_text, tolerance: None, replaced })
    }

    /// Removes the virtual joints.
    pub(crate) fn remove_virtual_joints(&mut self) {
        let rigid = self.file.mechanism.clone().with_virtual_joints(Vec::new());
        self.file.mechanism = rigid.expect("without virtual joints there is nothing to refuse");
        self.coordinates = Coordinates::of(&self.file);
    }

    /// Index of the joint coordinate with a name.
    pub(crate) fn find(&self, name: &str) -> Result<usize, Failure> {
        Ok(self.coordinates.find(&self.file.mechanism, name)?)
    }

    /// The mechanism with other values of some of its parameters, or of all of them without names.
    pub(crate) fn changed(
        &self,
        names: &[String],
    ) -> Result<Vec<(String, ChangedDimension)>, Failure> {
        let parameters = &self.file.parameters;
        let known: Vec<String> = parameters.iter().map(|(name, _)| name.clone()).collect();
        let Some(text) = self.text.as_deref().filter(|_| !known.is_empty()) else {
            let message = "--parameters needs a mechanism file with a table [parameters]";
            return Err(Failure::Usage(message.to_owned()));
        };
        let asked = if names.is_empty() { &known[..] } else { names };
        let changed = asked.iter().map(|name| {
            let Some((_, value)) = parameters.iter().find(|(one, _)| one == name) else {
                return Err(Failure::Usage(place::not_known("parameter", name, &known)));
            };
            let parameter = (name.as_str(), *value);
            let changed = mechanism::changed_dimension(&self.file, text, &self.replaced, parameter)
                .map_err(|error| Failure::Unsolved(error.to_string()))?;
            Ok((name.clone(), changed))
        });
        changed.collect()
    }

    /// The links or attached frames that the values of a flag name: each value is one name, which may have commas, or several separated by commas.
    pub(crate) fn frames(&self, values: &[String]) -> Result<Vec<FrameId>, Failure> {
        let find = |name: &str| coordinates::frame(&self.file.mechanism, name.trim());
        let mut found = Vec::new();
        for value in values {
            match find(value) {
                Ok(frame) => found.push(frame),
                Err(_) => {
                    for name in value.split(',') {
                        found.push(find(name)?);
                    }
                }
            }
        }
        Ok(found)
    }

    /// Commanded coordinates with their values (m, rad).
    pub(crate) fn commands(&self, at: &[JointValues]) -> Result<Vec<(usize, f64)>, Failure> {
        let names = Names::of(&self.file);
        let mut commands: Vec<(usize, f64)> = Vec::new();
        for one in at.iter().flat_map(|values| &values.0) {
            let k = self.find(&one.name)?;
            if commands.iter().any(|&(other, _)| other == k) {
                return Err(Failure::Usage(format!("{} has two values", one.name)));
            }
            let value = self.expression(&one.name, &one.text, &names)?;
            commands.push((k, self.value(k, &value, &names, 0.0)?));
        }
        Ok(commands)
    }

    /// The expression in the text of a value of a joint.
    pub(crate) fn expression(
        &self,
        joint: &str,
        text: &str,
        names: &Names<'_>,
    ) -> Result<CommandValue, Failure> {
        CommandValue::parse(text, names)
            .map_err(|error| Failure::Usage(format!("{joint}: {error}")))
    }

    /// A coordinate value in SI units (m, rad); refused beyond the largest displacement.
    ///
    /// # Arguments
    /// * `at` – value of the variable of `names`
    pub(crate) fn value(
        &self,
        k: usize,
        value: &CommandValue,
        names: &Names<'_>,
        at: f64,
    ) -> Result<f64, Failure> {
        let named = &self.coordinates.all()[k];
        let si = value.evaluate(named.quantity, names, at).map_err(|error| {
            let place = names.variable().filter(|_| value.varies(names));
            let place =
                place.map_or(String::new(), |variable| format!(" at {variable} = {}", number(at)));
            Failure::Usage(format!("{}{place}: {error}", named.name))
        })?;
        self.reachable(k, si)
    }

    /// A coordinate value (m, rad), refused beyond the largest displacement.
    pub(crate) fn reachable(&self, k: usize, si: f64) -> Result<f64, Failure> {
        Ok(self.coordinates.checked(k, si)?)
    }

    /// The configuration that displacements of virtual joints are counted from.
    pub(crate) fn at_rest(&self) -> Result<Closure, Failure> {
        let closed = close_at_rest(&self.file.mechanism, self.tolerance)
            .map_err(|error| self.unassembled(error))?;
        self.note_search(&[], &closed);
        Ok(closed)
    }

    /// The configuration of the rigid links from which virtual joints are suggested.
    pub(crate) fn nearly_assembled(&self) -> Result<Closure, Failure> {
        close_nearly(&self.file.mechanism).map_err(|error| self.unassembled(error))
    }

    /// A note of the distance from the guess, where corrections from it do not close the loops within the limits.
    pub(crate) fn note_search(&self, commands: &[(usize, f64)], closed: &Closure) {
        let start = commanded_guess(&self.file.mechanism, commands);
        if let Some(note) = report::search_note(&self.file, &start, closed) {
            console::note(&note);
        }
    }

    /// Whether the mechanism is small enough for dense algebra.
    pub(crate) fn is_dense(&self) -> bool {
        MechanismSystem::fits(&self.file.mechanism)
    }

    /// The closed configuration nearest to the guess by sparse algebra, and the number of corrections.
    pub(crate) fn sparse(
        &self,
        commands: &[(usize, f64)],
    ) -> Result<(SparseSystem<'_>, usize), Failure> {
        close_sparse(&self.file.mechanism, commands).map_err(|error| self.unassembled(error))
    }

    /// Closed configurations found from a number of other starts, except the assembled one.
    pub(crate) fn other_branches(
        &self,
        commands: &[(usize, f64)],
        starts: usize,
        assembled: &Closure,
    ) -> Result<Branches, Failure> {
        let mechanism = &self.file.mechanism;
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let start = commanded_guess(mechanism, commands);
        let found = branches(mechanism, &start, &held, starts)?;
        let mut closures = Vec::new();
        for branch in found.closures {
            if !is_same_configuration(mechanism, &assembled.coordinates, &branch.coordinates)? {
                closures.push(branch);
            }
        }
        Ok(Branches { closures, ..found })
    }

    /// The closed configuration with commanded coordinates held, with virtual joints displaced if rigid links do not close.
    pub(crate) fn posed(&self, commands: &[(usize, f64)]) -> Result<Posed, Failure> {
        let posed = pose_commanded(&self.file.mechanism, commands, self.tolerance)
            .map_err(|error| self.unrelieved(commands, error))?;
        self.note_search(commands, &posed.closed);
        if commands.is_empty() && posed.relief.is_none() {
            self.note_near_miss(&posed.closed)?;
        }
        Ok(posed)
    }

    /// A note of the near miss at the guess, where the loops close exactly only far from it.
    fn note_near_miss(&self, closed: &Closure) -> Result<(), Failure> {
        let mechanism = &self.file.mechanism;
        if self.tolerance.is_some() || !self.is_dense() {
            return Ok(());
        }
        if let Some(near) = near_miss_at_guess(mechanism, closed)? {
            console::note(&report::near_miss_note(&self.file, &near, closed));
        }
        Ok(())
    }

    /// The least displacement of the virtual joints that makes the commanded coordinates possible.
    pub(crate) fn relieved(&self, commands: &[(usize, f64)]) -> Result<Relief, Failure> {
        relieve_commanded(&self.file.mechanism, commands, self.tolerance)
            .map_err(|error| self.unrelieved(commands, error))
    }

    /// An error of a relief; commanded values beyond joint limits explain it better.
    fn unrelieved(&self, commands: &[(usize, f64)], error: Error) -> Failure {
        let is_explained = matches!(error, Error::NotRelieved { .. } | Error::NotLeast { .. });
        let mechanism = &self.file.mechanism;
        let mut beyond = mechanism.beyond_limits(&commanded_guess(mechanism, commands));
        beyond.retain(|one| commands.iter().any(|&(k, _)| k == one.coordinate));
        if is_explained && !beyond.is_empty() {
            return Failure::BeyondLimits(report::beyond_limits(&self.coordinates, &beyond));
        }
        self.unassembled(error)
    }

    /// Refuses a configuration beyond joint limits or clearances.
    ///
    /// # Arguments
    /// * `values` – (f + M), or (f) to check joint limits only (m, rad)
    pub(crate) fn within_limits(&self, values: &DVector<f64>) -> Result<(), Failure> {
        let beyond = self.file.mechanism.beyond_limits(values);
        if beyond.is_empty() {
            return Ok(());
        }
        Err(Failure::BeyondLimits(report::beyond_limits(&self.coordinates, &beyond)))
    }

    /// An assembly error with the configurations found, in the units of the file.
    pub(crate) fn unassembled(&self, error: Error) -> Failure {
        if let Error::NotReached { .. } = &error {
            return Failure::NotAssembled(format::explain::explain(&error, DisplayUnits::Metric));
        }
        let Error::NotAssembled(found) = &error else { return error.into() };
        let mut text = explain_unassembled(found, self.coordinates.units());
        if found.near_miss().is_some() {
            text.push_str("\n  use --tolerance of assemble and mobility");
        }
        for (i, branch) in found.branches.iter().enumerate() {
            let values = report::by_name(&self.coordinates, &branch.coordinates).0.into_iter();
            let listed: Vec<String> = values
                .enumerate()
                .map(|(k, (name, value))| {
                    let number = fixed(value, self.coordinates.decimals(k));
                    format!("{name} = {number} {}", self.coordinates.unit(k))
                })
                .collect();
            text.push_str(&format!("\n  {}: {}", i + 1, listed.join(", ")));
        }
        Failure::NotAssembled(text)
    }

    /// A table of coordinates: name, value, unit.
    pub(crate) fn table(&self, values: &[(String, f64)], first: usize) -> String {
        let width = values.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(20);
        let line = |(i, (name, value)): (usize, &(String, f64))| {
            let (k, pad) = (first + i, width - name.chars().count());
            let number = fixed(*value, self.coordinates.decimals(k));
            format!("  {name}{}{number:>16} {}\n", " ".repeat(pad), self.coordinates.unit(k))
        };
        values.iter().enumerate().map(line).collect()
    }
}
