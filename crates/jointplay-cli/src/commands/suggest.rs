//! `jointplay suggest`: virtual joints that make a motion possible.

use std::fmt::Write as _;

use clap::Args;
use jointplay::mechanism::suggest;
use jointplay::nalgebra::DVector;
use jointplay::report::{self, ByName, SuggestReport};

use crate::failure::Failure;
use crate::mechanism_input::{Assignment, Input, MechanismArgs, assignment};
use crate::progress::Progress;
use jointplay::format::number::fixed;

/// Number of sets listed in text; JSON lists all.
const LISTED: usize = 10;
/// Default displacement of each actuator: in radians, or as a share of the characteristic length.
const SMALL_TURN: f64 = 0.05;

/// Find the virtual joints with the least displacement that make a commanded motion possible
///
/// Virtual joints are tried at every joint, in every direction that the joint constrains; the sets are ranked by their displacement.
/// Without a command, each actuator of the file is driven by a small amount, one at a time.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay suggest gpr-mechanism
  jointplay suggest gpr-mechanism --format json
  jointplay suggest parallelogram --command A1=5,A2=4.9 --command A1=-5,A2=-5.1

Exit codes: 0 done, 1 no set was found, or none within joint limits, 2 bad input or usage.")]
pub(crate) struct Suggest {
    #[command(flatten)]
    pub(crate) mechanism: MechanismArgs,
    /// Commanded joint coordinates, in the units of the file; repeat the flag for further commands to the same joints
    #[arg(long, value_name = "JOINT=VALUE,…", value_parser = assignments)]
    command: Vec<Assignments>,
}

/// One command.
#[derive(Clone, Debug)]
struct Assignments(Vec<Assignment>);

fn assignments(text: &str) -> Result<Assignments, String> {
    text.split(',').map(assignment).collect::<Result<_, _>>().map(Assignments)
}

/// Commands to the same coordinates.
struct Commands {
    /// Indices of the commanded coordinates.
    commanded: Vec<usize>,
    /// Values of the commanded coordinates, for each command (m, rad).
    values: Vec<DVector<f64>>,
}

impl Suggest {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let mut input = self.mechanism.load()?;
        // The search replaces the virtual joints of the file.
        let bare = input.file.mechanism.clone().with_virtual_joints(Vec::new());
        input.file.mechanism = bare.expect("a mechanism without virtual joints is valid");
        let home = input.assembled(&[])?.coordinates;
        let Commands { commanded, values: commands } = self.commands(&input, &home)?;
        let working = Progress::of_work("comparing sets");
        let found = suggest(&input.file.mechanism, &home, &commanded, &commands)?;
        drop(working);
        let coordinates = &input.coordinates;
        let names = commanded.iter().map(|&k| coordinates.all()[k].name.clone()).collect();
        let in_units = |command: &DVector<f64>| {
            let values = commanded.iter().zip(command.iter());
            values.map(|(&k, &value)| coordinates.from_si(k, value)).collect()
        };
        let in_file_units = commands.iter().map(in_units).collect();
        let report = report::suggestions(&input.file, names, in_file_units, &found);
        self.mechanism.format.print(&report, |report| text(&input, &commanded, report))?;
        if !found.needed {
            return found.without_play.iter().try_for_each(|at| input.within_limits(at));
        }
        match report.sets.into_iter().next() {
            // Sets within limits are listed first.
            Some(best) if best.limits_broken.is_empty() => Ok(()),
            Some(best) => Err(Failure::BeyondLimits(best.limits_broken)),
            None => Err(Failure::Unsolved("no set of virtual joints was found".to_owned())),
        }
    }

    /// The commands of the flags, or the default ones.
    fn commands(&self, input: &Input, home: &DVector<f64>) -> Result<Commands, Failure> {
        let Some((first, others)) = self.command.split_first() else {
            return small_steps(input, home);
        };
        let first = input.commands(&first.0)?;
        let commanded: Vec<usize> = first.iter().map(|&(k, _)| k).collect();
        let mut commands = vec![DVector::from_iterator(first.len(), first.iter().map(|c| c.1))];
        for other in others {
            let other = input.commands(&other.0)?;
            let value = |k: &usize| other.iter().find(|(name, _)| name == k).map(|c| c.1);
            match commanded.iter().map(value).collect::<Option<Vec<f64>>>() {
                Some(values) if other.len() == commanded.len() => {
                    commands.push(DVector::from_vec(values));
                }
                _ => {
                    let text = "every --command must name the same joints";
                    return Err(Failure::Usage(text.to_owned()));
                }
            }
        }
        Ok(Commands { commanded, values: commands })
    }
}

/// One command for each actuator: a small displacement, with the others held.
fn small_steps(input: &Input, home: &DVector<f64>) -> Result<Commands, Failure> {
    let system = jointplay::mechanism::MechanismSystem::new(&input.file.mechanism, home.clone())?;
    let joints = input.file.mechanism.joints().iter().enumerate();
    let motors: Vec<usize> = joints
        .filter(|(_, joint)| joint.actuated)
        .flat_map(|(j, _)| system.kinematics().coordinates_of(j))
        .collect();
    if motors.is_empty() {
        let text = "the file has no actuated joint; use --command to command joints";
        return Err(Failure::Usage(text.to_owned()));
    }
    let length = jointplay::constraint::System::characteristic_length(&system);
    let at_home = DVector::from_iterator(motors.len(), motors.iter().map(|&k| home[k]));
    let commands = motors.iter().enumerate().map(|(n, &k)| {
        let mut command = at_home.clone();
        command[n] += SMALL_TURN * system.kinematics().dimensions()[k].unit(length);
        command
    });
    let values = commands.collect();
    Ok(Commands { commanded: motors, values })
}

/// Coordinates that describe the configuration: actuators that are not commanded, or joints with one freedom if there are no actuators.
fn shown(input: &Input, commanded: &[usize]) -> Vec<usize> {
    let joints = input.file.mechanism.joints();
    let motors = joints.iter().any(|joint| joint.actuated);
    let shows = joints.iter().flat_map(|joint| {
        let freedoms = joint.kind.freedoms();
        std::iter::repeat_n(if motors { joint.actuated } else { freedoms == 1 }, freedoms)
    });
    let shows = shows.enumerate().filter(|&(_, shows)| shows).map(|(k, _)| k);
    shows.filter(|k| !commanded.contains(k)).collect()
}

/// A line with the configuration for each command.
fn places(input: &Input, shown: &[usize], configurations: &[ByName<f64>]) -> String {
    let mut text = String::new();
    for at in configurations.iter().filter(|_| !shown.is_empty()) {
        let values: Vec<String> = shown
            .iter()
            .map(|&k| {
                let (name, value) = &at.0[k];
                let number = fixed(*value, input.coordinates.decimals(k));
                format!("{name} = {number} {}", input.coordinates.unit(k))
            })
            .collect();
        let _ = writeln!(text, "   at {}", values.join(", "));
    }
    text
}

fn text(input: &Input, commanded: &[usize], report: &SuggestReport) -> String {
    let shown = shown(input, commanded);
    let mut text = format!("virtual joints for {}\n", report.name);
    for command in &report.commands {
        let values: Vec<String> = report
            .commanded
            .iter()
            .zip(command)
            .map(|(name, value)| format!("{name} = {}", fixed(*value, 4)))
            .collect();
        let _ = writeln!(text, "  commanded {}", values.join(", "));
    }
    if !report.play_needed {
        text.push_str(if report.open_chain {
            "none needed: an open chain has no loops that constrain a command\n  use `jointplay import --loops` to add loops to a URDF model\n"
        } else {
            "none needed: rigid links close for each command\n"
        });
        text.push_str(&places(input, &shown, &report.without_play));
        return text;
    }
    let _ = writeln!(
        text,
        "{}",
        if report.cut_short || report.sets_untried > 0 {
            "best sets found, by displacement; the search was not exhaustive, so a smaller displacement may exist"
        } else {
            "sets of virtual joints, by displacement"
        }
    );
    let _ = writeln!(
        text,
        "  {} candidate joints and directions, {} sets compared{}, {} not tried",
        report.candidates,
        report.sets_compared,
        if report.cut_short { " (the limit)" } else { "" },
        report.sets_untried
    );
    if report.sets.is_empty() {
        text.push_str("no tried set makes the motion possible\n");
    }
    for (n, set) in report.sets.iter().take(LISTED).enumerate() {
        let alike = if set.symmetric { ", symmetric" } else { "" };
        let _ = writeln!(text, "{}. displacement {} mm{alike}", n + 1, fixed(set.size_mm, 5));
        for joint in &set.virtual_joints {
            let unit = if joint.unit == "um" { "µm" } else { "mrad" };
            let _ = writeln!(text, "   {:<44}{:>12} {unit}", joint.name, fixed(joint.largest, 3));
        }
        text.push_str(&places(input, &shown, &set.configurations));
        for limit in &set.limits_broken {
            let _ = writeln!(text, "   joint limit exceeded: {}", limit.message);
        }
    }
    if report.sets.len() > LISTED {
        let more = report.sets.len() - LISTED;
        let _ = writeln!(text, "and {more} more (--format json lists all)");
    }
    text
}
