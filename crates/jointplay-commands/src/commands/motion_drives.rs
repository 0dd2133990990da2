//! Drives of `jointplay move`: ranges, curves and tables.

use std::path::PathBuf;

use clap::Args;
use jointplay::constraint::System as _;
use jointplay::format::command::{CommandValue, Names, PoseCommand};
use jointplay::format::steps::spread;
use jointplay::interop::import;
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{DrivePath, MechanismSystem, SparseSystem, held_actuators};
use jointplay::nalgebra::DVector;
use jointplay::report::MotionParameter;

use super::motion_course::{Course, STEPS};
use super::motion_table;
use crate::arguments::whole;
use crate::failure::Failure;
use crate::mechanism_input::{Input, split};

/// Largest number of steps of a path.
const MOST_STEPS: usize = import::MAX_ROWS - 1;
/// Default variable of curves.
const VARIABLE: &str = "t";

/// Driven coordinates, and those that follow.
#[derive(Args)]
pub(crate) struct DriveArgs {
    /// Joint coordinates to drive along ranges or curves, separated by commas; FROM and STEP are optional, and STEP must divide the range; all are driven simultaneously
    #[arg(long = "drive", value_name = "JOINT=FROM:TO[:STEP]|JOINT=EXPRESSION", value_parser = drives)]
    drives: Vec<DriveTexts>,
    /// Pose of a link or frame to reach, from where the loops close: tilt ANGLE about [X,Y,Z] or toward AZIMUTH, precess ANGLE, turn ANGLE about [X,Y,Z], move by or to [X,Y,Z], `_` for a free coordinate; everything else moves least, within joint limits
    #[arg(long = "pose", value_name = "FRAME: COMMAND[; COMMAND]", conflicts_with_all = ["drives", "table", "free"])]
    pub(super) pose_commands: Vec<String>,
    /// Variable of the curves with its range [default: t over one turn, 0:360 or 0:2*pi in the angle unit of the file]
    #[arg(long, value_name = "VARIABLE=FROM:TO[:STEP]", value_parser = over)]
    over: Option<RangeText>,
    /// Number of steps [default: 60]
    #[arg(long, value_name = "N", value_parser = |text: &str| whole::<u32>(text, 1, 100_000))]
    steps: Option<u32>,
    /// Table of values to drive along (CSV): a column for each driven coordinate, headed by its name or name_unit; a first column of another name is the variable
    #[arg(long, value_name = "FILE", conflicts_with_all = ["drives", "over", "steps"])]
    table: Option<PathBuf>,
    /// Actuated joints that are free to follow instead of being held, separated by commas
    #[arg(long, value_name = "JOINT", value_delimiter = ',')]
    free: Vec<String>,
}

/// `JOINT=FROM:TO[:STEP]` or `JOINT=EXPRESSION`.
#[derive(Clone, Debug)]
struct DriveText {
    joint: String,
    values: Values,
}

#[derive(Clone, Debug)]
enum Values {
    Range { from: Option<String>, to: String, step: Option<String> },
    Expression(String),
}

/// `VARIABLE=FROM:TO[:STEP]`.
#[derive(Clone, Debug)]
struct RangeText {
    name: String,
    from: String,
    to: String,
    step: Option<String>,
}

/// The drives of one flag.
#[derive(Clone, Debug)]
struct DriveTexts(Vec<DriveText>);

fn drives(text: &str) -> Result<DriveTexts, String> {
    split(text, ',').into_iter().map(drive).collect::<Result<_, _>>().map(DriveTexts)
}

fn drive(text: &str) -> Result<DriveText, String> {
    let form = || {
        format!(
            "invalid drive {text:?}: expected JOINT=FROM:TO, JOINT=FROM:TO:STEP or JOINT=EXPRESSION"
        )
    };
    let (joint, values) = text.rsplit_once('=').ok_or_else(form)?;
    let parts: Vec<String> = values.split(':').map(|part| part.trim().to_owned()).collect();
    let some = |text: String| Some(text).filter(|text| !text.is_empty());
    let values = match <[String; 3]>::try_from(parts) {
        Ok([from, to, step]) => Values::Range { from: some(from), to, step: Some(step) },
        Err(parts) => match <[String; 2]>::try_from(parts) {
            Ok([from, to]) => Values::Range { from: some(from), to, step: None },
            Err(parts) => match <[String; 1]>::try_from(parts) {
                Ok([expression]) => Values::Expression(expression),
                Err(_) => return Err(form()),
            },
        },
    };
    Ok(DriveText { joint: joint.trim().to_owned(), values })
}

fn over(text: &str) -> Result<RangeText, String> {
    let form =
        || format!("invalid variable {text:?}: expected VARIABLE=FROM:TO or VARIABLE=FROM:TO:STEP");
    let DriveText { joint: name, values } = drive(text).map_err(|_| form())?;
    match values {
        Values::Range { from: Some(from), to, step } => Ok(RangeText { name, from, to, step }),
        _ => Err(form()),
    }
}

/// Commanded poses along a path.
pub(super) struct PoseCourse<'i> {
    pub(super) names: Names<'i>,
    pub(super) commands: Vec<PoseCommand>,
    /// Whether the commands depend on the variable.
    pub(super) is_curve: bool,
    /// Values of the variable, or shares of the command, at the points of the path.
    pub(super) values: Vec<f64>,
}

/// The range of one driven coordinate (m, rad).
struct Range {
    coordinate: usize,
    from: f64,
    to: f64,
    step: Option<f64>,
    /// Name in messages.
    name: String,
}

/// Drive of one coordinate.
enum Driver {
    Range(Range),
    Curve { coordinate: usize, value: CommandValue },
}

impl Driver {
    fn coordinate(&self) -> usize {
        match self {
            Self::Range(Range { coordinate, .. }) | Self::Curve { coordinate, .. } => *coordinate,
        }
    }
}

/// Number of steps of a range, with its name in messages.
struct StepCount {
    name: String,
    steps: usize,
}

impl DriveArgs {
    fn drives(&self) -> impl Iterator<Item = &DriveText> {
        self.drives.iter().flat_map(|DriveTexts(drives)| drives)
    }

    /// The path that the flags describe.
    ///
    /// # Arguments
    /// * `start` – the closed configuration, where ranges without FROM begin
    pub(super) fn course(&self, input: &Input, start: &DVector<f64>) -> Result<Course, Failure> {
        if let Some(table) = &self.table {
            return motion_table::course(input, table);
        }
        if self.drives.is_empty() {
            if self.over.is_some() {
                let text = "--over needs a --drive JOINT=EXPRESSION of its variable";
                return Err(Failure::Usage(text.to_owned()));
            }
            let range = default_range(input, start)?;
            let steps = self.steps.map_or(STEPS, |steps| steps as usize);
            let path =
                DrivePath::through(vec![range.coordinate], vec![vec![range.from], vec![range.to]])?;
            return Ok(Course { path, steps, parameter: None });
        }
        let names = self.names(input)?;
        let drivers = self.drivers(input, start, &names)?;
        let varies =
            |driver: &Driver| matches!(driver, Driver::Curve { value, .. } if value.varies(&names));
        if drivers.iter().any(varies) {
            self.curve(input, &names, &drivers)
        } else if let Some(over) = &self.over {
            Err(Failure::Usage(format!(
                "--over {}: no drive depends on `{}`",
                over.name, over.name
            )))
        } else {
            self.line(input, &names, start, &drivers)
        }
    }

    /// Indices of the actuated coordinates that are held.
    pub(super) fn held(&self, input: &Input, driven: &[usize]) -> Result<Vec<usize>, Failure> {
        let mut held = held_actuators(&input.file.mechanism, driven);
        for name in &self.free {
            let of_joint = |k: &usize| {
                let named = &input.coordinates.all()[*k];
                named.name == *name || named.joint == *name
            };
            if !held.iter().any(of_joint) {
                if input.file.mechanism.joint(name).is_none() {
                    input.find(name)?;
                }
                return Err(Failure::Usage(format!(
                    "--free {name}: the joint is not held; without --free, held are: {}",
                    names_of(input, &held)
                )));
            }
            held.retain(|k| !of_joint(k));
        }
        Ok(held)
    }

    /// Names of the file with the variable; without --over, `t` may be a parameter of the file that no drive uses.
    fn names<'i>(&self, input: &'i Input) -> Result<Names<'i>, Failure> {
        let names = Names::of(&input.file);
        let variable = self.over.as_ref().map_or(VARIABLE, |over| &over.name);
        let usage = |error: jointplay::format::command::Error| Failure::Usage(error.to_string());
        match names.clone().with_variable(variable) {
            Ok(names) => Ok(names),
            Err(error) if self.over.is_some() => Err(usage(error)),
            Err(error) => {
                for one in self.drives() {
                    let Values::Expression(text) = &one.values else { continue };
                    if input.expression(&one.joint, text, &names)?.uses(VARIABLE) {
                        return Err(usage(error));
                    }
                }
                for text in &self.pose_commands {
                    let pose = PoseCommand::parse(text, &input.file.mechanism, &names);
                    if pose.map_err(usage)?.uses(VARIABLE) {
                        return Err(usage(error));
                    }
                }
                Ok(names)
            }
        }
    }

    fn drivers(
        &self,
        input: &Input,
        start: &DVector<f64>,
        names: &Names<'_>,
    ) -> Result<Vec<Driver>, Failure> {
        let mut drivers: Vec<Driver> = Vec::new();
        for one in self.drives() {
            let coordinate = input.find(&one.joint)?;
            if drivers.iter().any(|driver| driver.coordinate() == coordinate) {
                return Err(Failure::Usage(format!("--drive {} is given twice", one.joint)));
            }
            let constant = |text: &str| {
                let value = input.expression(&one.joint, text, names)?;
                if value.varies(names) {
                    let text = format!(
                        "--drive {}: FROM, TO and STEP cannot depend on the variable `{}`; use JOINT=EXPRESSION",
                        one.joint,
                        names.variable().unwrap_or_default(),
                    );
                    return Err(Failure::Usage(text));
                }
                input.value(coordinate, &value, names, 0.0)
            };
            drivers.push(match &one.values {
                Values::Expression(text) => {
                    let value = input.expression(&one.joint, text, names)?;
                    Driver::Curve { coordinate, value }
                }
                Values::Range { from, to, step } => {
                    let from = from.as_deref().map(constant).transpose()?;
                    let (to, step) = (constant(to)?, step.as_deref().map(constant).transpose()?);
                    if from == Some(to) {
                        let text = format!("--drive {}: FROM and TO are equal", one.joint);
                        return Err(Failure::Usage(text));
                    }
                    if step == Some(0.0) {
                        let text = format!("--drive {}: STEP must not be 0", one.joint);
                        return Err(Failure::Usage(text));
                    }
                    let from = from.unwrap_or(start[coordinate]);
                    Driver::Range(Range { coordinate, from, to, step, name: one.joint.clone() })
                }
            });
        }
        Ok(drivers)
    }

    /// The straight path of drives that do not depend on a variable.
    fn line(
        &self,
        input: &Input,
        names: &Names<'_>,
        start: &DVector<f64>,
        drivers: &[Driver],
    ) -> Result<Course, Failure> {
        let ends = drivers
            .iter()
            .map(|driver| match driver {
                Driver::Range(range) => Ok([range.from, range.to]),
                Driver::Curve { coordinate, value } => {
                    Ok([start[*coordinate], input.value(*coordinate, value, names, 0.0)?])
                }
            })
            .collect::<Result<Vec<_>, Failure>>()?;
        let points = [0, 1].map(|end| ends.iter().map(|ends| ends[end]).collect()).to_vec();
        let path = DrivePath::through(drivers.iter().map(Driver::coordinate).collect(), points)?;
        let steps = self.step_count(input, drivers, None)?;
        Ok(Course { path, steps, parameter: None })
    }

    /// The path through points of a curve.
    fn curve(
        &self,
        input: &Input,
        names: &Names<'_>,
        drivers: &[Driver],
    ) -> Result<Course, Failure> {
        let values = self.variable_values(input, drivers)?;
        let steps = values.len() - 1;
        #[expect(clippy::cast_precision_loss, reason = "counts of steps")]
        let share = |i: usize| i as f64 / steps as f64;
        let point = |(i, &at): (usize, &f64)| {
            let value = |driver: &Driver| match driver {
                Driver::Range(range) => Ok(range.from + (range.to - range.from) * share(i)),
                Driver::Curve { coordinate, value } => input.value(*coordinate, value, names, at),
            };
            drivers.iter().map(value).collect::<Result<Vec<f64>, Failure>>()
        };
        let points = values.iter().enumerate().map(point).collect::<Result<_, _>>()?;
        let path = DrivePath::through(drivers.iter().map(Driver::coordinate).collect(), points)?;
        let name = names.variable().unwrap_or_default().to_owned();
        Ok(Course { path, steps, parameter: Some(MotionParameter { name, values }) })
    }

    /// Values of the variable at the points of a curve.
    fn variable_values(&self, input: &Input, drivers: &[Driver]) -> Result<Vec<f64>, Failure> {
        let names = Names::of(&input.file);
        let number = |text: &str| {
            let value = input.expression("--over", text, &names)?;
            value.number(&names, 0.0).map_err(|error| Failure::Usage(format!("--over: {error}")))
        };
        let turn = input.file.units.angle.from_radians(std::f64::consts::TAU);
        let (from, to, step) = match &self.over {
            None => (0.0, turn, None),
            Some(over) => {
                let step = over.step.as_deref().map(number).transpose()?;
                (number(&over.from)?, number(&over.to)?, step)
            }
        };
        if from == to {
            return Err(Failure::Usage("--over: FROM and TO are equal".to_owned()));
        }
        let own = step.map(|step| spread_count("--over", [from, to, step])).transpose()?;
        let steps = self.step_count(input, drivers, own)?;
        #[expect(clippy::cast_precision_loss, reason = "counts of steps")]
        let value = |i: usize| from + (to - from) * (i as f64 / steps as f64);
        Ok((0..=steps).map(value).collect())
    }

    /// Commanded poses with the points of their path.
    pub(super) fn pose_course<'i>(&self, input: &'i Input) -> Result<PoseCourse<'i>, Failure> {
        let usage = |error: jointplay::format::command::Error| Failure::Usage(error.to_string());
        let names = self.names(input)?;
        let parse = |text: &String| PoseCommand::parse(text, &input.file.mechanism, &names);
        let commands: Vec<PoseCommand> =
            self.pose_commands.iter().map(parse).collect::<Result<_, _>>().map_err(usage)?;
        let is_curve = commands.iter().any(|command| command.varies(&names));
        let values = if is_curve {
            self.variable_values(input, &[])?
        } else if let Some(over) = &self.over {
            let text = format!("--over {}: no pose depends on `{}`", over.name, over.name);
            return Err(Failure::Usage(text));
        } else {
            let steps = self.step_count(input, &[], None)?;
            #[expect(clippy::cast_precision_loss, reason = "counts of steps")]
            let share = |i: usize| i as f64 / steps as f64;
            (0..=steps).map(share).collect()
        };
        Ok(PoseCourse { names, commands, is_curve, values })
    }

    /// Number of steps by --steps and by the steps of ranges, which have to agree.
    fn step_count(
        &self,
        input: &Input,
        drivers: &[Driver],
        over: Option<StepCount>,
    ) -> Result<usize, Failure> {
        let mut counts: Vec<StepCount> = over.into_iter().collect();
        if let Some(steps) = self.steps {
            counts.push(StepCount { name: "--steps".to_owned(), steps: steps as usize });
        }
        for driver in drivers {
            let Driver::Range(Range { coordinate, from, to, step: Some(step), name }) = driver
            else {
                continue;
            };
            let in_file = |value: &f64| rounded(input.coordinates.from_si(*coordinate, *value));
            let unit = input.coordinates.unit(*coordinate);
            let name = format!("--drive {name}");
            let counted =
                spread_count(&format!("{name} (in {unit})"), [from, to, step].map(in_file))?;
            counts.push(StepCount { name, ..counted });
        }
        let Some((first, others)) = counts.split_first() else { return Ok(STEPS) };
        if let Some(other) = others.iter().find(|other| other.steps != first.steps) {
            return Err(Failure::Usage(format!(
                "{} has {} steps and {} has {}: simultaneous drives need the same number of steps; give STEP for one of them only",
                first.name, first.steps, other.name, other.steps
            )));
        }
        Ok(first.steps)
    }
}

/// Number of steps of a range.
fn spread_count(name: &str, [from, to, step]: [f64; 3]) -> Result<StepCount, Failure> {
    let values =
        spread(from, to, step).map_err(|error| Failure::Usage(format!("{name}: {error}")))?;
    let steps = values.len() - 1;
    if steps > MOST_STEPS {
        let text = format!("{name}: a path has at most {MOST_STEPS} steps; use a larger STEP");
        return Err(Failure::Usage(text));
    }
    Ok(StepCount { name: name.to_owned(), steps })
}

/// Names of coordinates, separated by commas.
fn names_of(input: &Input, coordinates: &[usize]) -> String {
    let names = coordinates.iter().map(|&k| input.coordinates.all()[k].name.as_str());
    let names = names.collect::<Vec<_>>().join(", ");
    if names.is_empty() { "none".to_owned() } else { names }
}

/// The first actuated joint between its limits, or over a default range.
fn default_range(input: &Input, start: &DVector<f64>) -> Result<Range, Failure> {
    let mechanism = &input.file.mechanism;
    let actuated = mechanism.joints().iter().find(|j| j.actuated && j.kind.freedoms() > 0);
    let Some(joint) = actuated else {
        let text = "no joint of this mechanism is actuated; use --drive JOINT=FROM:TO";
        return Err(Failure::Usage(text.to_owned()));
    };
    let named = input.coordinates.all();
    let found = named.iter().position(|one| one.joint == joint.name);
    let coordinate = found.unwrap_or_default();
    let [least, greatest] =
        joint.limits.first().copied().unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    if let ([from, to], true) = ([least, greatest], least.is_finite() && greatest.is_finite()) {
        let name = joint.name.clone();
        return Ok(Range { coordinate, from, to, step: None, name });
    }
    let reach = match named[coordinate].quantity {
        Coordinate::Turn => 20_f64.to_radians(),
        Coordinate::Slide => {
            if input.is_dense() {
                MechanismSystem::new(mechanism, start.clone())?.characteristic_length() / 10.0
            } else {
                SparseSystem::new(mechanism, start.clone())?.characteristic_length() / 10.0
            }
        }
    };
    // A start beyond a limit: the range begins at the limit.
    let here = start[coordinate].clamp(least, greatest);
    let name = joint.name.clone();
    let (from, to) = ((here - reach).max(least), (here + reach).min(greatest));
    Ok(Range { coordinate, from, to, step: None, name })
}

/// A number with fifteen digits: a change of units must not add a step to a range by round-off.
fn rounded(value: f64) -> f64 {
    format!("{value:.14e}").parse().unwrap_or(value)
}
