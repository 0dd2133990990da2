//! `jointplay mobility`: Kutzbach, instantaneous and finite mobility.

use std::fmt::Write as _;
use std::path::PathBuf;

use clap::Args;
use jointplay::constraint::CLOSURE_TOLERANCE;
use jointplay::format::mechanism::{LengthUnit, MAX_BYTES};
use jointplay::format::number::{counted, rounded};
use jointplay::format::robot;
use jointplay::gpr::Gpr;
use jointplay::mechanism::{MechanismSystem, OpenLoops, mechanism_mobility};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility, near_mobility};
use jointplay::report::{
    self, FreedomsReport, LinkMotionReport, MechanismMobilityReport, MobilityReport,
    NearMissReport, SparseMobilityReport,
};
use jointplay::virtualization::{Planar, SolveOptions};

use crate::arguments::{AnswerArgs, RodArgs, VirtualizationName};
use crate::failure::Failure;
use crate::mechanism_input::{Input, JointValues, ToleranceArgs, joint_values};
use crate::output::{limits, magnitude, three};
use crate::play_units::in_unit;
use crate::progress::Progress;
use crate::source::{Kind, Source};
use jointplay::format::number::fixed;

/// Compute the Kutzbach, instantaneous and finite mobility, and redundant constraints
///
/// The Kutzbach mobility counts freedoms and constraints.
/// The instantaneous mobility is the dimension of the admissible velocities at one configuration.
/// The finite mobility is the dimension of the admissible motions.
/// A mechanism with finite mobility below its instantaneous mobility is infinitesimally mobile ("shaky" in rigidity theory).
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay mobility                                      level: infinitesimally mobile
  jointplay mobility --q-mm 500,501,502                   tilted
  jointplay mobility --q-mm 500,501,502 --virtualization polar
  jointplay mobility bennett                              any mechanism
  jointplay mobility four-bar --at A=30 --set coupler=0.25
  jointplay mobility bennett --set b=0.1101 --tolerance 1e-3
                                                          mobile within a tolerance of 1e-3

If a mechanism file has an [expected] table, a different result is an error; it is not compared with --at, --set or --tolerance.
Exit codes: 0 done, 1 no such configuration, a limit is exceeded, or the result differs from [expected], 2 bad input or usage.")]
pub(crate) struct Mobility {
    /// Mechanism or robot file (TOML), or a name from `jointplay catalogue` [default: the paper's robot]
    #[arg(value_name = "FILE", conflicts_with = "robot")]
    file: Option<PathBuf>,
    /// Commanded joint coordinates of a mechanism, in the units of the file
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values, requires = "file", conflicts_with_all = ["q_mm", "virtualization"])]
    at: Vec<JointValues>,
    #[command(flatten)]
    near: ToleranceArgs,
    #[command(flatten)]
    rods: RodArgs,
    /// Also compute the mobility with these virtual joints free
    #[arg(long, value_enum)]
    virtualization: Option<VirtualizationName>,
    #[command(flatten)]
    pub(crate) answer: AnswerArgs,
}

impl Mobility {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let gpr = match &self.file {
            None => {
                self.refuse_tolerance()?;
                self.answer.load()?
            }
            Some(path) => {
                let source = Source::read(path, MAX_BYTES)?;
                if source.kind() != Some(Kind::ThreeRods) {
                    return self.of_mechanism(&source);
                }
                self.robot(&source)?.without_limit_checks()
            }
        };
        // The rigid robot is the one with its virtual joints held; the choice of virtualization makes no difference.
        let options = SolveOptions::default();
        let rods = self.rods.rods(&gpr);
        let broken = self.answer.limits.check_rods(&gpr, &rods)?;
        let pose = gpr.forward(rods, &Planar, &options)?;
        let rigid = gpr.system(&Planar);
        let finite = finite_mobility(&rigid, &rigid.configuration(&pose), RANK_THRESHOLD)?;
        let augmented = match self.virtualization {
            None => None,
            Some(name) => {
                let model = name.model();
                let relieved = gpr.system(model);
                let at = relieved.configuration(&gpr.forward(pose.rods, model, &options)?);
                Some((model.name(), augmented_mobility(&relieved, &at, RANK_THRESHOLD)?))
            }
        };
        let augmented = augmented.as_ref().map(|(name, found)| (*name, found));
        let report = report::mobility(&pose, gpr.kutzbach_mobility(), &finite, augmented, &broken);
        self.answer.format.print(&report, text)
    }

    fn of_mechanism(&self, source: &Source) -> Result<(), Failure> {
        if self.rods.q_mm.is_some() || self.virtualization.is_some() {
            let text = "--q-mm and --virtualization apply to the three-rod robot; use --at for a mechanism";
            return Err(Failure::Usage(text.to_owned()));
        }
        if self.answer.limits.ignore_limits {
            let text = "--ignore-limits applies to the three-rod robot; the mobility of a mechanism beyond its limits is that of its file with wider `limits`";
            return Err(Failure::Usage(text.to_owned()));
        }
        let tolerance = self.near.tolerance;
        let input = Input { tolerance, ..Input::parse(source, &self.answer.robot.set.set)? };
        let working = Progress::of_work("mobility");
        if !input.is_dense() && tolerance.is_none() {
            let (system, _) = input.sparse(&input.commands(&self.at)?)?;
            let found = system.mobility(RANK_THRESHOLD)?;
            let report = report::sparse_mobility(&input.file, &system, &found);
            drop(working);
            let unit = input.coordinates.units().length;
            self.answer.format.print(&report, |report| sparse_text(report, unit))?;
            input.within_limits(system.coordinates())?;
            return self.compare_with_file(&input, report.joint_freedoms, &report.freedoms);
        }
        let posed = input.posed(&input.commands(&self.at)?)?;
        let system = MechanismSystem::new(&input.file.mechanism, posed.closed.coordinates.clone())?;
        let at = system.at_home();
        let near = tolerance.map(|tolerance| near_mobility(&system, &at, tolerance)).transpose()?;
        // Within a tolerance, open loops are analysed as if forced shut.
        let open_loops = match tolerance {
            Some(_) if !system.is_closed() => OpenLoops::TakenAsClosed,
            _ => OpenLoops::Refused,
        };
        let found = mechanism_mobility(&system, RANK_THRESHOLD, open_loops)?;
        let report = report::mechanism_mobility(
            &input.file,
            &system,
            &posed.closed.coordinates,
            posed.relief.as_ref(),
            &found,
            near.as_ref(),
        )?;
        drop(working);
        self.answer.format.print(&report, |report| mechanism_text(&input, report))?;
        input.within_limits(&posed.closed.coordinates)?;
        self.compare_with_file(&input, report.joint_freedoms, &report.freedoms)
    }

    /// Refuses a result that differs from the `[expected]` table of the file.
    ///
    /// The table holds for the mechanism as its file describes it: with other parameters, commanded coordinates or a tolerance it is not compared.
    fn compare_with_file(
        &self,
        input: &Input,
        joint_freedoms: usize,
        found: &FreedomsReport,
    ) -> Result<(), Failure> {
        let asked = !self.at.is_empty()
            || !self.answer.robot.set.set.is_empty()
            || input.tolerance.is_some();
        let disagreements = report::disagreements(&input.file.expected, joint_freedoms, found);
        if asked || disagreements.is_empty() {
            return Ok(());
        }
        let lines = disagreements.iter().map(|one| format!("\n  {one}"));
        Err(Failure::Unexpected(lines.collect()))
    }

    fn refuse_tolerance(&self) -> Result<(), Failure> {
        let text = "--tolerance applies to mechanism files; `gpr-mechanism` of the catalogue describes this robot as a mechanism";
        self.near.tolerance.map_or(Ok(()), |_| Err(Failure::Usage(text.to_owned())))
    }

    fn robot(&self, source: &Source) -> Result<Gpr, Failure> {
        self.refuse_tolerance()?;
        if !self.at.is_empty() {
            let text = "--at applies to mechanism files; use --q-mm for this robot";
            return Err(Failure::Usage(text.to_owned()));
        }
        let read = robot::parse_with(&source.text, &self.answer.robot.set.replaced());
        Ok(read.map_err(|errors| Failure::invalid(&errors, &source.label))?.gpr)
    }
}

/// Mobilities and constraints, in the same form for the robot and for any mechanism.
fn freedoms(text: &mut String, found: &FreedomsReport) {
    let [lower, upper] = found.finite_mobility_bounds;
    let undecided = format!("undecided, {lower} to {upper}");
    let finite = found.finite_mobility.map_or(undecided, |finite| finite.to_string());
    let _ = writeln!(text, "  Kutzbach             {:>3}", found.kutzbach_mobility);
    let _ = writeln!(text, "  instantaneous        {:>3}", found.instantaneous_mobility);
    let _ = writeln!(text, "  finite               {finite:>3}");
    let _ = writeln!(text, "constraints");
    let _ = writeln!(text, "  rank                 {:>3}", found.rank);
    let _ = writeln!(text, "  redundant            {:>3}", found.redundancy);
}

/// Singular values above and below the rank threshold.
///
/// # Arguments
/// * `unit` – of the characteristic length in the text
fn spectrum(
    text: &mut String,
    values: [&[f64]; 2],
    threshold: f64,
    length_mm: f64,
    unit: LengthUnit,
) {
    let length = rounded(in_unit(unit, length_mm), 6);
    let _ = writeln!(text, "singular values, lengths in units of {length} {}", unit.name());
    singular_values(text, values);
    let _ = writeln!(text, "  threshold            {threshold:.3e}");
}

fn text(report: &MobilityReport) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "mobility at q = {} mm", three(&report.q_mm, 6).trim_start());
    freedoms(&mut text, &report.freedoms);
    let FreedomsReport { instantaneous_mobility, finite_mobility, rank, .. } = report.freedoms;
    let values = report.singular_values.split_at(rank).into();
    let (length, unit) = (report.characteristic_length_mm, LengthUnit::Millimeter);
    spectrum(&mut text, values, report.threshold, length, unit);
    if let Some(finite) = finite_mobility.filter(|&finite| finite < instantaneous_mobility) {
        let lost = instantaneous_mobility - finite;
        let _ = writeln!(
            text,
            "infinitesimally mobile: {} only instantaneous",
            if lost == 1 { "1 motion is".to_owned() } else { format!("{lost} motions are") }
        );
    }
    if let Some(augmented) = &report.augmented {
        let _ = writeln!(text, "with the {} virtual joints free", augmented.virtualization);
        let _ = writeln!(text, "  rank                 {:>3}", augmented.augmented_rank);
        let _ = writeln!(text, "  mobility             {:>3}", augmented.augmented_mobility);
        let values = &augmented.augmented_singular_values;
        let (counted, zero) = values.split_at(augmented.augmented_rank);
        singular_values(&mut text, [counted, zero]);
    }
    text + &limits(&report.limits_broken)
}

fn sparse_text(report: &SparseMobilityReport, unit: LengthUnit) -> String {
    let mut text = format!("mobility of {}, as assembled\n", report.name);
    let _ = writeln!(text, "freedoms");
    let _ = writeln!(text, "  of all joints        {:>3}", report.joint_freedoms);
    let _ = writeln!(text, "  loops                {:>3}", report.loops);
    let counted: Vec<f64> = [Some(report.largest_singular_value), report.smallest_counted]
        .into_iter()
        .flatten()
        .collect();
    let zero: Vec<f64> = report.largest_uncounted.into_iter().collect();
    freedoms(&mut text, &report.freedoms);
    let values = [counted.as_slice(), zero.as_slice()];
    if report.loops > 0 {
        spectrum(&mut text, values, report.threshold, report.characteristic_length_mm, unit);
        let _ = writeln!(
            text,
            "  of the joint closures, by sparse algebra: the largest, the smallest above and the largest below the threshold"
        );
    }
    let _ = writeln!(text, "{}", report.class);
    text
}

fn mechanism_text(input: &Input, report: &MechanismMobilityReport) -> String {
    let at = if report.coordinates.0.is_empty() { "" } else { ", at" };
    let mut text = format!("mobility of {}{at}\n", report.name);
    text.push_str(&input.table(&report.coordinates.0, 0));
    if let Some(displaced) = &report.virtual_joints {
        text.push_str("rigid links do not close; displacement of the virtual joints\n");
        text.push_str(&input.table(&displaced.0, report.coordinates.0.len()));
    }
    let _ = writeln!(text, "freedoms");
    let _ = writeln!(text, "  of all joints        {:>3}", report.joint_freedoms);
    let _ = writeln!(text, "  loops                {:>3}", report.loops);
    if report.couplings > 0 {
        let _ = writeln!(text, "  couplings            {:>3}", report.couplings);
    }
    freedoms(&mut text, &report.freedoms);
    let values = report.singular_values.split_at(report.freedoms.rank).into();
    let unit = input.coordinates.units().length;
    spectrum(&mut text, values, report.threshold, report.characteristic_length_mm, unit);
    let _ = writeln!(
        text,
        "  singular values below the threshold and closure residuals below {CLOSURE_TOLERANCE:.0e} are treated as zero"
    );
    let _ = writeln!(text, "{}", report.class);
    text.push_str(&redundant_constraints(report));
    text.push_str(&near_words(report));
    let _ = writeln!(text, "instantaneous motions of the links");
    for (link, motion) in &report.link_motions.0 {
        let _ = writeln!(text, "  {link:<20} {}", motion_words(motion, unit));
    }
    text
}

/// Self-stresses by group, and how to remove them.
fn redundant_constraints(report: &MechanismMobilityReport) -> String {
    let (all, basis) = (&report.redundant_constraints, &report.redundant_constraint_basis);
    let mut text = String::new();
    if all.is_empty() {
        return text;
    }
    let independent = all.iter().filter(|one| one.independent).count();
    let quality = if basis.sparsest { "sparsest basis" } else { "best basis found" };
    let _ = writeln!(text, "redundant constraints ({quality} of the self-stresses)");
    for (n, one) in all.iter().enumerate() {
        let same = |other: &&report::RedundantConstraintReport| other.group == one.group;
        let members = all.iter().filter(same).count();
        if members > 1 && (n == 0 || all[n - 1].group != one.group) {
            let independent = all.iter().filter(same).filter(|one| one.independent).count();
            let _ = writeln!(text, "  {members} by symmetry, {independent} independent");
        }
        let indent = if members > 1 { "    " } else { "  " };
        let _ = writeln!(text, "{indent}{}. {}", n + 1, one.what);
    }
    if all.len() > independent {
        let _ = writeln!(text, "  {independent} of these {} are independent", all.len());
    }
    let release = "release any one of its joints along its force or about its moment";
    let remove = "remove any one of its couplings";
    let (have_joints, have_couplings) = (
        all.iter().any(|one| !one.joints.is_empty()),
        all.iter().any(|one| !one.couplings.is_empty()),
    );
    let remedy = match (have_joints, have_couplings) {
        (_, false) => release.to_owned(),
        (false, true) => remove.to_owned(),
        (true, true) => format!("{release}, or {remove}"),
    };
    let _ = writeln!(text, "  to remove one: {remedy}");
    for (what, names) in [("", &basis.joints_in_all), ("couplings ", &basis.couplings_in_all)] {
        if !names.is_empty() {
            let _ = writeln!(text, "  {what}in all self-stresses: {}", names.join(", "));
        }
    }
    text
}

/// Mobility within a tolerance of the dimensions, or a hint at `--tolerance`.
fn near_words(report: &MechanismMobilityReport) -> String {
    let mut text = String::new();
    if let Some(near) = &report.near {
        let (mobility, needed) = (near.near_mobility, near.near_tolerance_needed);
        let words = if report.freedoms.finite_mobility == Some(mobility) {
            ", equal to the finite mobility".to_owned()
        } else if needed <= CLOSURE_TOLERANCE {
            format!("; the largest mismatch along the motion, {needed:.1e}, is round-off")
        } else {
            format!(", if dimensions are accurate only to {needed:.1e}")
        };
        let _ = writeln!(text, "within a tolerance of {:.1e}: {mobility}{words}", near.tolerance);
        if let Some(gap) = near.forced_shut {
            let _ = writeln!(
                text,
                "  the finite mobility assumes that the loops are forced shut: they are open by {gap:.1e}"
            );
        }
        if let Some(more) = near.near_tolerance_for_one_more {
            let _ = writeln!(text, "  one more degree of freedom needs about {more:.1e}");
        }
    }
    if let Some(NearMissReport { near_mobility, near_tolerance_needed, tolerance_to_try }) =
        report.near_miss
    {
        let _ = writeln!(
            text,
            "near miss: mobility {near_mobility} if dimensions are accurate only to {near_tolerance_needed:.1e}; see --tolerance {tolerance_to_try:.0e}"
        );
    }
    if let Some(coordinates) = report.near_miss_not_searched {
        let _ = writeln!(
            text,
            "near misses were not searched, because of {coordinates} coordinates; use --tolerance 1e-4 to search"
        );
    }
    text
}

fn motion_words(motion: &LinkMotionReport, unit: LengthUnit) -> String {
    let LinkMotionReport { dimension, translations, pitch_mm_per_rad, axis_point_mm } = motion;
    match (dimension, pitch_mm_per_rad, axis_point_mm) {
        (0, ..) => "at rest".to_owned(),
        (1, Some(pitch), Some(point)) => {
            // An advance below round-off of the mechanism's size is zero.
            let turns = if pitch.abs()
                < 1e-9 * point.iter().fold(1.0, |most: f64, x| most.max(x.abs()))
            {
                "rotation about an axis".to_owned()
            } else {
                let pitch = fixed(in_unit(unit, *pitch), unit.decimals());
                format!("screw motion with an advance of {pitch} {}/rad about an axis", unit.name())
            };
            // A tenth of a micrometre.
            let decimals = unit.decimals().saturating_sub(2);
            let point = point.map(|x| fixed(in_unit(unit, x), decimals)).join(", ");
            format!("{turns} through ({point}) {}", unit.name())
        }
        (1, ..) => "translation".to_owned(),
        _ => format!(
            "{}, including {}",
            counted(*dimension, "freedom"),
            counted(*translations, "translation")
        ),
    }
}

/// Singular values above, then below the threshold.
fn singular_values(text: &mut String, [counted, zero]: [&[f64]; 2]) {
    let list = |values: &[f64]| {
        values.iter().map(|&value| format!(" {}", magnitude(value))).collect::<String>()
    };
    for (row, chunk) in counted.chunks(6).enumerate() {
        let label = if row == 0 { "nonzero" } else { "" };
        let _ = writeln!(text, "  {label:<20}{}", list(chunk));
    }
    if !zero.is_empty() {
        let _ = writeln!(text, "  {:<20}{}", "zero", list(zero));
    }
}
