//! `jointplay sensitivity FILE`: displacement of the virtual joints of a mechanism for a command.

use std::fmt::Write as _;

use jointplay::format::display_units::DisplayUnits;
use jointplay::report::{self, ReliefReport};

use crate::arguments::AnswerArgs;
use crate::failure::Failure;
use crate::mechanism_input::{Input, JointValues};
use crate::output::magnitude;
use crate::play_units::{in_display_units, in_unit};
use crate::progress::Progress;
use jointplay::format::number::{fixed, rounded};

/// Prints the displacement of the virtual joints for a command; fails if one exceeds its clearance.
pub(super) fn run(
    input: &Input,
    command: &[JointValues],
    answer: &AnswerArgs,
) -> Result<(), Failure> {
    if input.file.mechanism.virtual_joints().is_empty() {
        let text = "this mechanism has no virtual joints; add [[virtual_joint]] tables at joints with play";
        return Err(Failure::Usage(text.to_owned()));
    }
    if command.is_empty() {
        let text = "no command is given; use --command JOINT=VALUE";
        return Err(Failure::Usage(text.to_owned()));
    }
    let commands = input.commands(command)?;
    let working = Progress::of_work("sensitivity");
    let relief = input.relieved(&commands)?;
    let commanded: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
    let sensitivity = relief.sensitivity(&input.file.mechanism, &commanded)?;
    let values = sensitivity.singular_values().as_slice();
    let report = report::relief(&input.file, &relief, &commanded, values);
    drop(working);
    answer.format.print(&report, |report| text(input, report))?;
    let of_joints = relief.coordinates.rows(0, input.coordinates.joints()).into_owned();
    input.within_limits(&of_joints)?;
    let over: Vec<&str> =
        report.virtual_joints.iter().filter(|one| one.over).map(|one| one.name.as_str()).collect();
    if over.is_empty() {
        Ok(())
    } else {
        Err(Failure::OverClearance(format!(
            "the displacement exceeds the clearance of {}",
            over.join(", ")
        )))
    }
}

fn text(input: &Input, report: &ReliefReport) -> String {
    let mut text = format!("{}, with virtual joints, at\n", report.name);
    text.push_str(&input.table(&report.coordinates.0, 0));
    let _ = writeln!(text, "virtual joints             displacement       clearance");
    let (length_unit, units) = (input.file.units.length, DisplayUnits::of(input.file.units.length));
    for joint in &report.virtual_joints {
        let (displacement, unit) = in_display_units(units, joint.displacement, joint.unit);
        let clearance = joint.clearance.map_or("-".to_owned(), |value| {
            format!("±{}", fixed(in_display_units(units, value, joint.unit).0, 3))
        });
        let over = if joint.over { "  exceeded" } else { "" };
        let pad = " ".repeat(20_usize.saturating_sub(joint.name.chars().count()));
        let _ = writeln!(
            text,
            "  {}{pad}{:>16} {:>15} {unit}{over}",
            joint.name,
            fixed(displacement, 3),
            clearance
        );
    }
    let (size, unit) = in_display_units(units, report.size, report.size_unit);
    let _ = writeln!(text, "  norm              {:>18} {:>15} {unit}", fixed(size, 3), "");
    let values: String =
        report.singular_values.iter().map(|&value| format!(" {}", magnitude(value))).collect();
    let rows: Vec<&str> = report.virtual_joints.iter().map(|one| one.name.as_str()).collect();
    let length = rounded(in_unit(length_unit, report.characteristic_length_mm), 6);
    let unit = length_unit.name();
    let _ = writeln!(
        text,
        "sensitivity of the virtual joints to the commanded coordinates, {unit} per {unit} (angles are multiplied by {length} {unit})"
    );
    let _ = writeln!(text, "  rows                 {}", rows.join(", "));
    let _ = writeln!(text, "  columns              {}", report.commanded.join(", "));
    let _ = writeln!(text, "  singular values     {values}");
    text
}
