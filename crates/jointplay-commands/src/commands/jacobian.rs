//! `jointplay jacobian`: velocities, accelerations and Jacobians of a mechanism.

use std::fmt::Write as _;

use clap::Args;
use jointplay::format::number::{fixed, rounded};
use jointplay::mechanism::{FrameId, MechanismSystem};
use jointplay::mobility::RANK_THRESHOLD;
use jointplay::report::{
    self, CommandedRates, FrameReport, JacobianError, JacobianReport, ParameterReport,
};

use crate::failure::Failure;
use crate::mechanism_input::{Input, JointValues, MechanismArgs, joint_values};
use crate::output::magnitude;
use crate::play_units::in_unit;
use crate::progress::Progress;

/// Compute Jacobians, velocities and accelerations of a mechanism with its loops closed
///
/// The Jacobian of a frame has six rows in the base frame: its angular velocity, then the velocity of its origin; and a column for each actuated coordinate.
/// Virtual joints follow with the least displacement.
/// Without --frame, all attached frames are reported, or all links if the file has no frames.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay jacobian four-bar
  jointplay jacobian gpr-mechanism --at \"rod 1=3,rod 2=0,rod 3=0\" --frame platform
  jointplay jacobian four-bar --parameters=coupler
  jointplay jacobian gpr-mechanism --frame platform --velocity \"rod 1=10\" --acceleration \"rod 2=100\" --format json

Condition number and manipulability depend on the characteristic length wherever a frame both turns and translates.

Exit codes: 0 done, 1 the motion is not determined, a parameter has no derivative, the loops do not close, or a joint limit or clearance is exceeded, 2 bad input or usage.")]
pub(crate) struct Jacobian {
    #[command(flatten)]
    pub(crate) mechanism: MechanismArgs,
    /// Joint coordinates of the configuration, in the units of the file
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values)]
    at: Vec<JointValues>,
    /// Commanded coordinates [default: those of the actuated joints]
    #[arg(long, value_name = "JOINT", value_delimiter = ',')]
    commanded: Vec<String>,
    /// Links or attached frames to report
    #[arg(long, visible_alias = "link", value_name = "NAME")]
    frame: Vec<String>,
    /// Velocities of commanded coordinates, in the units of the file per second; 0 for those not named
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values)]
    velocity: Vec<JointValues>,
    /// Accelerations of commanded coordinates, in the units of the file per second²; 0 for those not named
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values)]
    acceleration: Vec<JointValues>,
    /// Also report derivatives by parameters of the file, commanded coordinates held [default: all parameters]
    #[arg(long, value_name = "NAME", value_delimiter = ',', num_args = 0.., require_equals = true)]
    parameters: Option<Vec<String>>,
}

impl Jacobian {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let input = self.mechanism.load()?;
        let mechanism = &input.file.mechanism;
        let commanded = self.commanded(&input)?;
        let frames = self.frames(&input)?;
        let velocities = rates(&input, &commanded, &self.velocity, "--velocity")?;
        let accelerations = rates(&input, &commanded, &self.acceleration, "--acceleration")?;
        let parameters = match &self.parameters {
            Some(names) => input.changed(names)?,
            None => Vec::new(),
        };
        let working = Progress::of_work("jacobian");
        let mut at = input.posed(&input.commands(&self.at)?)?.closed.coordinates;
        let mut relief = None;
        let mut system = MechanismSystem::new(mechanism, at.clone())?;
        if !mechanism.virtual_joints().is_empty() {
            // The least displacement for what is commanded here, which --at need not be.
            let commands: Vec<(usize, f64)> = commanded.iter().map(|&k| (k, at[k])).collect();
            let found = input.relieved(&commands)?;
            at = found.coordinates.clone();
            system = found.system(mechanism)?;
            relief = Some(found);
        }
        let is_moving = !self.velocity.is_empty() || !self.acceleration.is_empty();
        let rates = is_moving
            .then_some(CommandedRates { velocities: &velocities, accelerations: &accelerations });
        let report = report::jacobian(
            &input.file,
            &system,
            &commanded,
            &frames,
            relief.as_ref(),
            rates,
            &parameters,
        )
        .map_err(|error| match error {
            JacobianError::Motion(jointplay::Error::PartlyCommanded { coordinate }) => {
                Failure::Usage(input.coordinates.partly_commanded(coordinate).to_string())
            }
            JacobianError::Motion(error) => Failure::from(error),
            error @ (JacobianError::FreeMotions(_) | JacobianError::Parameter { .. }) => {
                Failure::Unsolved(error.to_string())
            }
        })?;
        drop(working);
        let units: Vec<&str> = commanded.iter().map(|&k| input.coordinates.unit(k)).collect();
        self.mechanism.format.print(&report, |report| text(&input, report, &units))?;
        input.within_limits(&at)
    }

    fn commanded(&self, input: &Input) -> Result<Vec<usize>, Failure> {
        let mut commanded = Vec::new();
        for name in &self.commanded {
            let k = input.find(name)?;
            if commanded.contains(&k) {
                return Err(Failure::Usage(format!("--commanded names {name} twice")));
            }
            commanded.push(k);
        }
        if self.commanded.is_empty() {
            commanded = input.file.mechanism.actuated_coordinates();
        }
        if commanded.is_empty() {
            let text = "no joint of this mechanism is actuated; use --commanded JOINT";
            return Err(Failure::Usage(text.to_owned()));
        }
        Ok(commanded)
    }

    fn frames(&self, input: &Input) -> Result<Vec<FrameId>, Failure> {
        let mechanism = &input.file.mechanism;
        if self.frame.is_empty() {
            let attached = (0..mechanism.frames().len()).map(FrameId::Attached);
            let links = (1..mechanism.links().len()).map(FrameId::Link);
            return Ok(if mechanism.frames().is_empty() {
                links.collect()
            } else {
                attached.collect()
            });
        }
        input.frames(&self.frame)
    }
}

/// Rates of the commanded coordinates (m, rad per second), 0 for those not named.
fn rates(
    input: &Input,
    commanded: &[usize],
    given: &[JointValues],
    flag: &str,
) -> Result<Vec<f64>, Failure> {
    let mut rates = vec![0.0; commanded.len()];
    for (k, value) in input.commands(given)? {
        let Some(j) = commanded.iter().position(|&one| one == k) else {
            let names: Vec<&str> =
                commanded.iter().map(|&k| input.coordinates.all()[k].name.as_str()).collect();
            return Err(Failure::Usage(format!(
                "{flag}: {} is not commanded; commanded are {}",
                input.coordinates.all()[k].name,
                names.join(", ")
            )));
        };
        rates[j] = value;
    }
    Ok(rates)
}

fn text(input: &Input, report: &JacobianReport, units: &[&str]) -> String {
    let mut text = format!("{}, at\n", report.name);
    text.push_str(&input.table(&report.coordinates.0, 0));
    if let Some(displaced) = &report.virtual_joints {
        text.push_str("displacement of the virtual joints\n");
        text.push_str(&input.table(&displaced.0, report.coordinates.0.len()));
    }
    for frame in &report.frames.0 {
        frame_text(&mut text, report, units, frame);
    }
    if let (Some(velocities), Some(accelerations)) = (&report.velocities, &report.accelerations) {
        let _ =
            writeln!(text, "rates of all coordinates     velocity (per s)  acceleration (per s²)");
        let pairs = velocities.0.iter().zip(&accelerations.0).enumerate();
        for (k, ((name, velocity), (_, acceleration))) in pairs {
            let pad = " ".repeat(22_usize.saturating_sub(name.chars().count()));
            let decimals = input.coordinates.decimals(k);
            let [velocity, acceleration] = [velocity, acceleration].map(|&v| fixed(v, decimals));
            let unit = input.coordinates.unit(k);
            let _ = writeln!(text, "  {name}{pad}{velocity:>18}{acceleration:>18} {unit}");
        }
    }
    if let Some(parameters) = &report.parameters {
        parameters_text(&mut text, input, report, &parameters.0);
    }
    let zero = RANK_THRESHOLD * report.singular_values.first().copied().unwrap_or_default();
    let shown = |&value: &f64| format!(" {}", magnitude(if value > zero { value } else { 0.0 }));
    let values: String = report.singular_values.iter().map(shown).collect();
    let unit = input.file.units.length;
    let length = rounded(in_unit(unit, report.characteristic_length_mm), 6);
    let _ = writeln!(
        text,
        "loops with {} held, in radians and lengths of {length} {}",
        report.commanded.join(", "),
        unit.name()
    );
    let _ = writeln!(text, "  singular values     {values}");
    text
}

/// Jacobian, velocity and acceleration of a frame.
///
/// # Arguments
/// * `units` – of the commanded coordinates
fn frame_text(
    text: &mut String,
    report: &JacobianReport,
    units: &[&str],
    (name, frame): &(String, FrameReport),
) {
    let (length, angle) = (report.units.length, report.units.angle);
    let [x, y, z] = frame.position.map(|value| fixed(value, 6));
    let _ = writeln!(text, "Jacobian of {name}, origin at ({x}, {y}, {z}) {length}");
    let _ = write!(text, "  {:<20}", "per");
    report.commanded.iter().zip(units).for_each(|(one, unit)| {
        let _ = write!(text, "{:>16}", format!("{one} ({unit})"));
    });
    let moving = frame.velocity.zip(frame.acceleration);
    if moving.is_some() {
        let _ = write!(text, "{:>16}{:>16}", "velocity", "acceleration");
    }
    text.push('\n');
    for (row, entries) in frame.jacobian.iter().enumerate() {
        let (part, unit) = if row < 3 { ("angular", angle) } else { ("linear", length) };
        let axis = ["x", "y", "z"][row % 3];
        let _ = write!(text, "  {:<20}", format!("{part} {axis} ({unit})"));
        entries.iter().for_each(|&entry| {
            let _ = write!(text, "{:>16}", fixed(entry, 9));
        });
        if let Some((velocity, acceleration)) = moving {
            for rates in [velocity, acceleration] {
                let part = if row < 3 { rates.angular } else { rates.linear };
                let _ = write!(text, "{:>16}", fixed(part[row % 3], 6));
            }
        }
        text.push('\n');
    }
    let values: String =
        frame.singular_values.iter().map(|&value| format!(" {}", magnitude(value))).collect();
    let condition = frame.condition_number.map_or("infinite".to_owned(), magnitude);
    let _ = writeln!(text, "  singular values     {values}");
    let _ = writeln!(
        text,
        "  condition number     {}, manipulability {}",
        condition.trim(),
        magnitude(frame.manipulability).trim()
    );
}

/// Largest number of columns of a table of parameters.
const COLUMNS: usize = 5;

/// Derivatives by parameters.
fn parameters_text(
    text: &mut String,
    input: &Input,
    report: &JacobianReport,
    parameters: &[(String, ParameterReport)],
) {
    let _ = writeln!(
        text,
        "derivatives by parameters, for a change by 1 with {} held",
        report.commanded.join(", ")
    );
    let mut row = |title: String, values: Vec<f64>| {
        let pad = " ".repeat(28_usize.saturating_sub(title.chars().count()));
        let _ = write!(text, "  {title}{pad}");
        values.iter().for_each(|&value| {
            let _ = write!(text, "{:>16}", fixed(value, 9));
        });
        text.push('\n');
    };
    for parameters in parameters.chunks(COLUMNS) {
        let names: String = parameters.iter().map(|(name, _)| format!("{name:>16}")).collect();
        row(format!("{:<28}{names}", "per"), Vec::new());
        for (k, named) in input.coordinates.all().iter().enumerate() {
            let title = format!("{} ({})", named.name, input.coordinates.unit(k));
            row(title, parameters.iter().map(|(_, one)| one.coordinates.0[k].1).collect());
        }
        for (i, (name, _)) in report.frames.0.iter().enumerate() {
            for axis in 0..6 {
                let (part, unit) = if axis < 3 {
                    ("angular", report.units.angle)
                } else {
                    ("linear", report.units.length)
                };
                let title = format!("{name} {part} {} ({unit})", ["x", "y", "z"][axis % 3]);
                let value = |(_, one): &(String, ParameterReport)| {
                    let twist = one.frames.0[i].1;
                    if axis < 3 { twist.angular[axis] } else { twist.linear[axis - 3] }
                };
                row(title, parameters.iter().map(value).collect());
            }
        }
    }
}
