//! `jointplay move`: joints driven along a path.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use jointplay::format::number::{fixed, number};
use jointplay::mechanism::DrivenMotion;
use jointplay::mechanism::joint::Coordinate;
use jointplay::plot::results::{Follower, motion};
use jointplay::report::table;
use jointplay::report::{self, MotionParameter, MotionReport, PosesReport};

use super::motion_drives::DriveArgs;
use super::motion_pose::{PoseMotion, nearest_possible, pose_motion};
use super::motion_run::{at_start, follow};
use super::motion_scene::SceneArgs;
use crate::failure::Failure;
use crate::figure::svg_and_png;
use crate::folder::{self, ForceArgs};
use crate::mechanism_input::{Input, MechanismArgs};
use crate::{console, source};

/// Drive joints along a path and solve for the remaining ones
///
/// The loops are closed from the initial guess in the file; the joints are driven to FROM and then, step by step, to TO.
/// An expression drives a joint along a curve: its variable `t` takes the range of --over, one turn by default.
/// Values are expressions of the parameters of the file, in the units of the file or in the unit that follows (`2.5 mm`).
/// Without --drive, the first actuated joint is driven between its limits, or by ±20° or ± a tenth of the characteristic length.
/// If only actuated joints are driven, the other actuated joints are held; otherwise all other joints are solved for.
/// Virtual joints are displaced by the least amount.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay move four-bar
  jointplay move four-bar --drive A=0:360:5 --out four-bar-motion
  jointplay move hexapod --drive P1=0:0.02 --drive P2=0:-0.02:-0.005 --format json
  jointplay move gpr-mechanism --drive \"rod 1=0:3\" --poses --out tilt
  jointplay move hexapod --drive \"P1=0.02*sin(t)\" --drive \"P4=-0.02*sin(t)\" --steps 90
  jointplay move gpr-mechanism --drive \"rod 1=0:3\" --to gltf --exaggerate 500 --out scene
  jointplay move gpr-mechanism --pose \"platform: tilt 1 about [1, 1, 0]\"
  jointplay move gpr-mechanism --pose \"platform: precess 1\" --steps 36

Exit codes: 0 reached the end, 1 stopped before the end, or a joint limit or clearance was exceeded, 2 bad input or usage.")]
pub(crate) struct Move {
    #[command(flatten)]
    pub(crate) mechanism: MechanismArgs,
    #[command(flatten)]
    drives: DriveArgs,
    /// Add the poses of all links and attached frames in the base frame: origin, and unit quaternion
    #[arg(long)]
    poses: bool,
    /// Folder for the files of --to; by default none are written
    #[arg(short, long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Files to write into --out, separated by commas
    #[arg(
        long,
        value_enum,
        value_name = "FORMATS",
        value_delimiter = ',',
        default_value = "csv",
        requires_if("gltf", "out")
    )]
    to: Vec<MotionFormat>,
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    force: ForceArgs,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MotionFormat {
    /// series of all coordinates (CSV), and their figure over the first driven one or over the variable (SVG, PNG)
    Csv,
    /// animated 3D scene of the links or of --parts, one binary glTF file
    Gltf,
}

impl Move {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        if self.scene.is_given() && !self.to.contains(&MotionFormat::Gltf) {
            let text = "--parts and --exaggerate apply to the 3D scene: use --to gltf";
            return Err(Failure::Usage(text.to_owned()));
        }
        let input = self.mechanism.load()?;
        if let Some(folder) = &self.out {
            folder::check_folder(folder, self.force)?;
        }
        if self.drives.pose_commands.is_empty() {
            self.drive(&input)
        } else {
            let course = self.drives.pose_course(&input)?;
            let PoseMotion { moved, parameter, nearest } = pose_motion(&input, &course)?;
            let commanded =
                course.commands.iter().map(|command| command.text().to_owned()).collect();
            let report = report::motion(&input.file, &[], &[], Some(&parameter), &moved);
            self.finish(&input, report.with_pose_commands(commanded, nearest), &moved)
        }
    }

    /// Drives joints.
    fn drive(&self, input: &Input) -> Result<(), Failure> {
        let start = input.at_rest()?.coordinates;
        let course = self.drives.course(input, &start)?;
        let held = self.drives.held(input, course.path.coordinates())?;
        let start = at_start(input, start, &course, &held)?;
        let moved = follow(input, &start, &course, &held, "driving")?;
        let (driven, parameter) = (course.path.coordinates(), course.parameter.as_ref());
        let commanded = [driven, &held].concat();
        let report = report::motion(&input.file, driven, &held, parameter, &moved)
            .with_free_motions(&input.file, &moved, &commanded)?;
        self.finish(input, report, &moved)
    }

    /// Writes and prints a motion, and fails where it stopped or left limits.
    fn finish(
        &self,
        input: &Input,
        mut report: MotionReport,
        moved: &DrivenMotion,
    ) -> Result<(), Failure> {
        if self.poses {
            report = report.with_poses(&input.file, moved)?;
        }
        let driven: Vec<usize> =
            report.driven.iter().map(|name| input.find(name)).collect::<Result<_, _>>()?;
        let mut written = 0;
        if let Some(folder) = &self.out {
            let stem = format!("{}-motion", source::stem(self.mechanism.path()));
            let mut files = Vec::new();
            if self.to.contains(&MotionFormat::Csv) {
                files = series(input, &report, &driven, &stem)?;
            }
            if self.to.contains(&MotionFormat::Gltf) {
                let reference = input.at_rest()?.coordinates;
                let scene =
                    self.scene.scene(input, &reference, moved, report.parameter.as_ref())?;
                for link in &scene.missing {
                    console::note(&format!("no part moves with link {link:?}"));
                }
                files.push((format!("{stem}.glb"), scene.bytes));
            }
            folder::write(folder, &files, self.force)?;
            written = files.len();
        }
        self.mechanism.format.print(&report, |report| {
            let mut text = self.text(input, report, &driven);
            if let Some(folder) = &self.out {
                let files = if written == 1 { "1 file" } else { &format!("{written} files") };
                let _ = writeln!(text, "{files} written into {}", folder.display());
            }
            text
        })?;
        if let Some(message) = report.message {
            return Err(Failure::Stopped(message + &nearest_possible(report.nearest_pose)));
        }
        match report.first_beyond_limits {
            None => Ok(()),
            Some(first) => {
                Err(Failure::BeyondLimitsAt { place: first.place, limits: first.limits_broken })
            }
        }
    }

    fn text(&self, input: &Input, report: &MotionReport, driven: &[usize]) -> String {
        let mut text = format!("{}, driven\n", report.name);
        for command in &report.pose_commands {
            let _ = writeln!(text, "  {command}");
        }
        if let Some(MotionParameter { name, values }) = &report.parameter
            && let ([from, ..], [.., to]) = (&values[..], &values[..])
        {
            let _ = writeln!(text, "  {name} from {} to {}", number(*from), number(*to));
        }
        // Poses drive the motors.
        let motors = input.file.mechanism.actuated_coordinates();
        let listed = if report.pose_commands.is_empty() { driven } else { &motors };
        for &k in listed {
            let name = &input.coordinates.all()[k].name;
            let values = &report.series.0[k].1;
            let number = |value: Option<&f64>| {
                value.map_or(String::new(), |&value| fixed(value, input.coordinates.decimals(k)))
            };
            let (from, to) = (number(values.first()), number(values.last()));
            let _ = writeln!(text, "  {name} from {from} to {to} {}", input.coordinates.unit(k));
        }
        if !report.held.is_empty() {
            let _ = writeln!(text, "  held: {}", report.held.join(", "));
        }
        match &report.free_motions {
            Some(free) if free.count() > 0 => {
                let _ = writeln!(text, "  left free: {free}");
            }
            None if report.pose_commands.is_empty() => {
                let _ = writeln!(text, "  left free: not determined for a mechanism of this size");
            }
            _ => {}
        }
        let _ = writeln!(text, "path");
        let _ = writeln!(text, "  solver steps         {}", report.solver_steps);
        let _ = writeln!(text, "  largest residual     {:.1e}", report.largest_residual);
        for (k, (name, value)) in report.largest_displacements.iter().flat_map(|d| &d.0).enumerate()
        {
            let k = input.coordinates.joints() + k;
            let number = fixed(*value, input.coordinates.decimals(k));
            let label = if k == input.coordinates.joints() { "virtual joints up to" } else { "" };
            let _ = writeln!(text, "  {label:<20} {name} {number} {}", input.coordinates.unit(k));
        }
        if !report.limits_broken.is_empty() {
            let _ = writeln!(text, "  limits exceeded      {}", report.limits_broken.join(", "));
        }
        let _ = writeln!(text, "dead points and crossings: {}", report.singular.len());
        for singular in &report.singular {
            let at: Vec<String> = singular
                .drives
                .0
                .iter()
                .zip(driven)
                .map(|((name, value), &k)| {
                    let decimals = input.coordinates.decimals(k);
                    format!("{name} = {} {}", fixed(*value, decimals), input.coordinates.unit(k))
                })
                .collect();
            let mobility = singular.instantaneous_mobility;
            let branches = match (singular.branches, singular.drives_reverse) {
                (Some(1), Some(true)) => {
                    "one branch, on which the driven coordinates reverse".to_owned()
                }
                (Some(1), Some(false)) => {
                    "one branch, on which the driven coordinates continue".to_owned()
                }
                (Some(1), None) => "one branch".to_owned(),
                (Some(count), _) => format!("{count} branches cross"),
                (None, _) => "branches undecided".to_owned(),
            };
            let at = at.join(", ");
            let _ = writeln!(text, "  {at}: instantaneous mobility {mobility}, {branches}");
        }
        if let Some(poses) = &report.poses {
            text.push_str(&poses_text(input, poses));
        }
        text
    }
}

/// Poses at the start and at the end of a motion.
fn poses_text(input: &Input, poses: &PosesReport) -> String {
    let unit = input.coordinates.units().length;
    let decimals = unit.decimals();
    let unit = unit.name();
    let width = poses.0.0.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0).max(18);
    let mut text = format!(
        "poses at the start and at the end, in the base frame: origin ({unit}), quaternion w x y z\n"
    );
    for (name, series) in &poses.0.0 {
        let ends = [series.position.first(), series.position.last()];
        let turns = [series.quaternion.first(), series.quaternion.last()];
        for (k, (position, quaternion)) in ends.iter().zip(turns).enumerate() {
            let (Some(position), Some(quaternion)) = (position, quaternion) else { continue };
            let label = if k == 0 { name } else { "" };
            let pad = " ".repeat(width - label.chars().count());
            let _ = write!(text, "  {label}{pad}");
            position.iter().for_each(|&at| {
                let _ = write!(text, " {:>16}", fixed(at, decimals));
            });
            text.push_str("  ");
            quaternion.iter().for_each(|&part| {
                let _ = write!(text, " {:>12}", fixed(part, 9));
            });
            text.push('\n');
        }
    }
    text
}

/// The series, and the figure of a mechanism in which other coordinates follow the first, as files.
fn series(
    input: &Input,
    report: &MotionReport,
    driven: &[usize],
    stem: &str,
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let joints = input.coordinates.joints();
    let follower = |k: usize| {
        let named = &input.coordinates.all()[k];
        let values = &report.series.0[k].1;
        // Play is some micrometres where strokes are millimetres.
        let (unit, values) = match named.quantity {
            _ if k < joints => (input.coordinates.unit(k), values.clone()),
            Coordinate::Slide => ("µm", in_si(input, k, values, 1e6)),
            Coordinate::Turn => ("mrad", in_si(input, k, values, 1e3)),
        };
        Follower { name: named.name.clone(), unit, is_virtual: k >= joints, values }
    };
    let parameter = report.parameter.as_ref().map(|parameter| Follower {
        name: parameter.name.clone(),
        unit: "",
        is_virtual: false,
        values: parameter.values.clone(),
    });
    let first = driven.first().copied().unwrap_or_default();
    let drive = parameter.clone().unwrap_or_else(|| follower(first));
    let others: Vec<Follower> = (0..input.coordinates.all().len())
        .filter(|&k| parameter.is_some() || k != first)
        .map(follower)
        .collect();
    let singular: Vec<f64> = if parameter.is_some() {
        report.singular.iter().filter_map(|singular| singular.parameter).collect()
    } else {
        let first = |singular: &report::SingularReport| singular.drives.0.first().map(|one| one.1);
        report.singular.iter().filter_map(first).collect()
    };
    let mut files = vec![(format!("{stem}.csv"), table::csv(&report.columns()).into_bytes())];
    if !others.is_empty() {
        let figure = motion(&report.name, &drive, &others, &singular);
        files.extend(svg_and_png(stem, &figure)?);
    }
    Ok(files)
}

/// Values of a coordinate in other units: `per` for one metre or radian.
fn in_si(input: &Input, k: usize, values: &[f64], per: f64) -> Vec<f64> {
    values.iter().map(|&value| per * input.coordinates.to_si(k, value)).collect()
}
