//! `jointplay suggest`: virtual joints that make a motion possible.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::mechanism::{self, MechanismFile, Units};
use jointplay::mechanism::{
    Commands, LinearAndAngular, SingleCommand, SuggestOptions, Suggestion, SuggestionRank,
    Suggestions, VirtualJoint, single_commands, single_displacements, small_commands, suggest,
};
use jointplay::nalgebra::DVector;
use jointplay::report::{self, ByName, SetReport, SingleCommandReport, SuggestReport, WrittenSet};

use crate::arguments::{finite, positive_whole};
use crate::failure::Failure;
use crate::folder::{self, ForceArgs};
use crate::mechanism_input::{Input, JointValues, MechanismArgs, joint_values};
use crate::play_units::{in_display_units, play_length};
use crate::progress::Progress;
use jointplay::format::number::{counted, fixed, number};

/// Number of sets listed in text; JSON lists all.
const LISTED: usize = 10;

/// Find the virtual joints with the least displacement that make a commanded motion possible
///
/// Virtual joints are tried at every joint, in every direction that the joint constrains; the sets are ranked by their displacement.
/// Without a command, each actuator of the file is driven by a small amount, one at a time.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay suggest gpr-mechanism
  jointplay suggest gpr-mechanism --symmetric --rank largest
  jointplay suggest gpr-mechanism --rank stiffness --stiffness linear=2e7,angular=5e3
  jointplay suggest parallelogram --command A1=5,A2=4.9 --command A1=-5,A2=-5.1
  jointplay suggest gpr-mechanism --write 1 --out with-play.toml

Exit codes: 0 done, 1 no set was found, or none within joint limits and clearances, 2 bad input or usage.")]
pub(crate) struct Suggest {
    #[command(flatten)]
    pub(crate) mechanism: MechanismArgs,
    /// Commanded joint coordinates, in the units of the file; repeat the flag for further commands to the same joints
    #[arg(long, value_name = "JOINT=VALUE,…", value_parser = joint_values)]
    command: Vec<JointValues>,
    /// Largest number of sets to compare
    #[arg(long, value_name = "N", default_value_t = SuggestOptions::default().limit, value_parser = positive_whole::<usize>)]
    limit: usize,
    /// Largest number of virtual joints in a set [default: the number of directions to relieve; no limit for symmetric sets]
    #[arg(long, value_name = "N", value_parser = positive_whole::<usize>)]
    joints: Option<usize>,
    /// Compare only symmetric sets
    #[arg(long)]
    symmetric: bool,
    /// Rank by the norm of all displacements, by the largest single displacement, or by elastic energy, for which every joint needs a stiffness
    #[arg(long, value_name = "BY", value_enum, default_value_t = Rank::Norm)]
    rank: Rank,
    /// Stiffness of joints that have none in the file, for --rank stiffness: in N/m along a direction, in N m/rad about one
    #[arg(long, value_name = "linear=K,angular=K", value_parser = stiffness)]
    stiffness: Option<LinearAndAngular>,
    /// Write the virtual joints of set N into the mechanism file, in place of its own
    #[arg(long, value_name = "N", value_parser = positive_whole::<u32>)]
    write: Option<u32>,
    /// New mechanism file for --write [default: change the mechanism file itself]
    #[arg(long, value_name = "FILE", requires = "write")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
}

/// Order of the sets.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Rank {
    Norm,
    Largest,
    Stiffness,
}

/// Stiffness along and about directions, either or both.
fn stiffness(text: &str) -> Result<LinearAndAngular, String> {
    let mut found = LinearAndAngular::default();
    for part in text.split(',') {
        let expected = || format!("invalid stiffness {part:?}: expected linear=K or angular=K");
        let (name, value) = part.split_once('=').ok_or_else(expected)?;
        let name = name.trim();
        let place = match name {
            "linear" => &mut found.linear,
            "angular" => &mut found.angular,
            _ => return Err(expected()),
        };
        let value = finite(value)?;
        if value <= 0.0 {
            return Err(format!("{name} stiffness must be positive, got {}", number(value)));
        }
        if place.replace(value).is_some() {
            return Err(format!("{name} stiffness is given twice"));
        }
    }
    Ok(found)
}

/// Refuses a set that needs more than the clearances of the joints.
fn within_clearances(set: &SetReport) -> Result<(), Failure> {
    let exceeded = set.virtual_joints.iter().filter(|one| one.exceeds_clearance == Some(true));
    let exceeded: Vec<&str> = exceeded.map(|one| one.virtual_joint.name.as_str()).collect();
    if exceeded.is_empty() {
        return Ok(());
    }
    let text = format!("beyond the clearance of the joint: {}", exceeded.join(", "));
    Err(Failure::OverClearance(text))
}

/// Index of a set, from its number.
fn chosen(number: u32, sets: usize) -> Result<usize, Failure> {
    let index = usize::try_from(number).unwrap_or(usize::MAX) - 1;
    match sets {
        0 => Err(Failure::Unsolved("no set of virtual joints to write".to_owned())),
        _ if index < sets => Ok(index),
        _ => Err(Failure::Usage(format!("--write must be from 1 to {sets}, got {number}"))),
    }
}

impl Suggest {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if self.stiffness.is_some() && !matches!(self.rank, Rank::Stiffness) {
            return Err(Failure::Usage("--stiffness needs --rank stiffness".to_owned()));
        }
        let mut input = self.mechanism.load()?;
        // The search replaces the virtual joints of the file.
        let replaced = input.file.mechanism.virtual_joints().len();
        let destination = self.write.map(|_| self.destination(&input, replaced)).transpose()?;
        let nearly_closed = input.nearly_assembled()?;
        let bare = input.file.mechanism.clone().with_virtual_joints(Vec::new());
        input.file.mechanism = bare.expect("a mechanism without virtual joints is valid");
        input.note_search(&[], &nearly_closed);
        let home = nearly_closed.coordinates;
        let all = self.commands(&input, &home)?;
        let Commands { commanded, values: commands } = &all;
        let working = Progress::of_work("comparing sets");
        let options = SuggestOptions {
            limit: self.limit,
            joints: self.joints,
            symmetric_only: self.symmetric,
            rank: match self.rank {
                Rank::Norm => SuggestionRank::Norm,
                Rank::Largest => SuggestionRank::Largest,
                Rank::Stiffness => SuggestionRank::Stiffness,
            },
            stiffness: self.stiffness.unwrap_or_default(),
        };
        let found = suggest(&input.file.mechanism, &home, commanded, commands, &options)?;
        drop(working);
        let coordinates = &input.coordinates;
        let names = commanded.iter().map(|&k| coordinates.all()[k].name.clone()).collect();
        let in_units = |command: &DVector<f64>| {
            let values = commanded.iter().zip(command.iter());
            values.map(|(&k, &value)| coordinates.from_si(k, value)).collect()
        };
        let in_file_units = commands.iter().map(in_units).collect();
        let mut report = report::suggestions(&input.file, names, in_file_units, &found);
        let single = single(&input, &home, &all, &found)?;
        report::add_single_commands(&mut report, &input.file, &single);
        // An invalid number of a set is reported after the sets.
        let chosen = self.write.map_or(Ok(0), |number| chosen(number, report.sets.len()));
        if let (Some(path), Ok(k)) = (destination, &chosen) {
            let text = self.with_play(&input, &found.sets[*k].virtual_joints)?;
            folder::write_file(path, text.as_bytes(), self.replaces())?;
            let file = path.display().to_string();
            report.written = Some(WrittenSet { file, set: k + 1, replaced });
        }
        self.mechanism
            .format
            .print(&report, |report| text(&input, commanded, report, self.rank))?;
        let k = chosen?;
        if !found.needed {
            return found.without_play.iter().try_for_each(|at| input.within_limits(at));
        }
        // Sets within limits are listed first.
        match report.sets.into_iter().nth(k) {
            Some(best) if !best.limits_broken.is_empty() => {
                Err(Failure::BeyondLimits(best.limits_broken))
            }
            Some(best) => within_clearances(&best),
            None => Err(Failure::Unsolved("no set of virtual joints was found".to_owned())),
        }
    }

    /// The file to write, checked before the search.
    ///
    /// # Arguments
    /// * `replaced` – number of virtual joints that the mechanism has
    fn destination(&self, input: &Input, replaced: usize) -> Result<&Path, Failure> {
        if let Some(path) = &self.out {
            folder::check_file(path, self.force)?;
            return Ok(path);
        }
        let path = self.mechanism.path();
        if input.text.is_none() || !path.is_file() {
            let text = "--write without --out changes a mechanism file: use --out FILE for models, the catalogue and standard input";
            return Err(Failure::Usage(text.to_owned()));
        }
        if replaced > 0 && !self.force.is_given() {
            return Err(Failure::Usage(format!(
                "{} has {}, which --write replaces: use --out for a new file, or --force",
                path.display(),
                counted(replaced, "virtual joint")
            )));
        }
        Ok(path)
    }

    /// Whether an existing file may be replaced: without `--out` it is the file to change.
    fn replaces(&self) -> ForceArgs {
        if self.out.is_none() { ForceArgs::REPLACE } else { self.force }
    }

    /// The text of the mechanism file with virtual joints.
    fn with_play(&self, input: &Input, joints: &[VirtualJoint]) -> Result<String, Failure> {
        let MechanismFile { mechanism, source, units, .. } = &input.file;
        let (text, units) = match &input.text {
            Some(text) => (text.clone(), *units),
            None => (mechanism::write(mechanism, source.as_deref()), Units::SI),
        };
        let replaced = self.mechanism.replaced_parameters();
        mechanism::with_virtual_joints(&text, mechanism, units, joints, &replaced).map_err(
            |error| Failure::invalid(&[error], &self.mechanism.path().display().to_string()),
        )
    }

    /// The commands of the flags, or the default ones.
    fn commands(&self, input: &Input, home: &DVector<f64>) -> Result<Commands, Failure> {
        let Some((first, others)) = self.command.split_first() else {
            let text = "the file has no actuated joint; use --command to command joints";
            let small = small_commands(&input.file.mechanism, home)?;
            return small.ok_or_else(|| Failure::Usage(text.to_owned()));
        };
        let first = input.commands(std::slice::from_ref(first))?;
        let commanded: Vec<usize> = first.iter().map(|&(k, _)| k).collect();
        let mut commands = vec![DVector::from_iterator(first.len(), first.iter().map(|c| c.1))];
        for other in others {
            let other = input.commands(std::slice::from_ref(other))?;
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

/// Displacements of single motors, or of single commanded coordinates without motors, for the sets that text lists.
fn single(
    input: &Input,
    home: &DVector<f64>,
    commands: &Commands,
    found: &Suggestions,
) -> Result<Vec<Vec<SingleCommand>>, Failure> {
    let mechanism = &input.file.mechanism;
    let displacements = single_displacements(mechanism, home, commands)?;
    let of_set = |set: &Suggestion| {
        let relieved = mechanism.clone().with_virtual_joints(set.virtual_joints.clone());
        let relieved = relieved.expect("suggested joints are valid");
        Ok(single_commands(&relieved, home, &displacements)?)
    };
    found.sets.iter().take(LISTED).map(of_set).collect()
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

/// Lines with the displacements of single coordinates that a set makes possible, and those that it does not.
fn single_text(input: &Input, commands: &[SingleCommandReport]) -> String {
    let units = DisplayUnits::of(input.file.units.length);
    let mut text = String::new();
    for (possible, heading) in [(true, "also possible"), (false, "not possible")] {
        let listed: Vec<String> = commands
            .iter()
            .filter(|one| one.size_mm.is_some() == possible)
            .map(|one| {
                let unit = input.find(&one.coordinate).map_or("", |k| input.coordinates.unit(k));
                let by = format!("{} ±{} {unit}", one.coordinate, fixed(one.by, 3));
                match one.size_mm {
                    Some(size) => format!("{by} by {}", play_length(units, size)),
                    None => by,
                }
            })
            .collect();
        if !listed.is_empty() {
            let _ = writeln!(text, "   {heading} alone: {}", listed.join(", "));
        }
    }
    text
}

/// Distance of the first set from the optimum, by the lower bound.
fn optimality(report: &SuggestReport, rank: Rank) -> String {
    let first = report.sets.first().map(|set| (set.energy_mj, set.size_mm));
    let (found, least) = match (rank, first, report.lower_bound_mj) {
        (Rank::Stiffness, Some((Some(energy), _)), Some(least)) => (energy, least),
        (Rank::Norm, Some((_, size)), _) => (size, report.lower_bound_mm),
        _ => return "a smaller displacement may exist".to_owned(),
    };
    let share = (1.0 - least / found).max(0.0) * 100.0;
    match share {
        // The bound is round-off below a set that reaches it.
        0.0..=1e-6 => "the first one is optimal".to_owned(),
        0.0..0.01 => "another may need less than the first one, by less than 0.01 %".to_owned(),
        _ => format!("another may need less than the first one, by at most {} %", fixed(share, 2)),
    }
}

fn text(input: &Input, commanded: &[usize], report: &SuggestReport, rank: Rank) -> String {
    let shown = shown(input, commanded);
    let units = DisplayUnits::of(input.file.units.length);
    let mut text = format!("virtual joints for {}\n", report.name);
    for command in &report.commands {
        let values: Vec<String> = report
            .commanded
            .iter()
            .zip(command)
            .zip(commanded)
            .map(|((name, value), &k)| {
                format!("{name} = {} {}", fixed(*value, 4), input.coordinates.unit(k))
            })
            .collect();
        let _ = writeln!(text, "  commanded {}", values.join(", "));
    }
    if let Some(residual) = report.home_residual {
        let _ = writeln!(
            text,
            "rigid links do not close, by {residual:.1e} (radians and characteristic lengths): each set closes them too"
        );
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
    let compared = report.sets_compared - report.sets_untried;
    let _ = if report.cut_short || report.sets_untried > 0 {
        writeln!(
            text,
            "best found among {compared} of {} sets; {}",
            report.sets_in_class,
            optimality(report, rank)
        )
    } else {
        writeln!(text, "sets of virtual joints, all {} compared", report.sets_in_class)
    };
    let least = match report.lower_bound_mj {
        Some(energy) => format!("{} mJ", fixed(energy, 5)),
        None => play_length(units, report.lower_bound_mm),
    };
    let _ = writeln!(
        text,
        "  {} candidate joints and directions; no set of them needs less than {least}",
        report.candidates
    );
    if report.sets.is_empty() {
        text.push_str("no tried set makes the motion possible\n");
    }
    for (n, set) in report.sets.iter().take(LISTED).enumerate() {
        let alike = match (set.symmetric, set.symmetric_for_commands) {
            (true, _) => ", symmetric",
            (false, true) => ", symmetric for the commands",
            (false, false) => "",
        };
        let energy = set.energy_mj.map(|energy| format!("energy {} mJ, ", fixed(energy, 5)));
        let energy = energy.unwrap_or_default();
        let size = play_length(units, set.size_mm);
        let _ = writeln!(text, "{}. {energy}displacement {size}{alike}", n + 1);
        for joint in &set.virtual_joints {
            let (largest, unit) = in_display_units(units, joint.largest, joint.unit);
            let name = &joint.virtual_joint.name;
            let clearance = match joint.exceeds_clearance {
                Some(true) => ", exceeds the clearance",
                Some(false) => ", within the clearance",
                None => "",
            };
            let largest = fixed(largest, 3);
            let _ = writeln!(text, "   {name:<44}{largest:>12} {unit}{clearance}");
            for alternative in &joint.alternatives {
                let _ = writeln!(text, "     or {}", alternative.name);
            }
        }
        text.push_str(&places(input, &shown, &set.configurations));
        if set.within_limits == Some(true) {
            text.push_str("   within the joint limits\n");
        }
        for limit in &set.limits_broken {
            let _ = writeln!(text, "   joint limit exceeded: {}", limit.message);
        }
        text.push_str(&single_text(input, set.single_commands.as_deref().unwrap_or_default()));
    }
    if let Some(WrittenSet { file, set, replaced }) = &report.written {
        let _ = write!(text, "set {set} written to {file}");
        if *replaced > 0 {
            let _ = write!(text, ", in place of {}", counted(*replaced, "virtual joint"));
        }
        text.push('\n');
    }
    if report.sets.len() > LISTED {
        let more = report.sets.len() - LISTED;
        let _ = writeln!(text, "and {more} more (--format json lists all)");
    }
    text
}
