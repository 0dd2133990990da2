//! The report of a check as text.

use std::fmt::Write as _;

use jointplay::cell::check::ViolationKind;
use jointplay::cell::program::SourceLocation;
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::number::counted;
use jointplay::report::{
    CellReport, OccurrenceReport, ViolationGroupReport, cell_facts, cell_tables, violation_groups,
};

use super::input::Planned;
use jointplay::format::number::fixed;

/// Largest number of instructions listed of a violation group.
const OCCURRENCES: usize = 4;
/// Largest number of violation groups listed.
const GROUPS: usize = 12;

/// Results, violations by cause, and tables.
pub(super) fn report(report: &CellReport, planned: &Planned) -> String {
    let mut text = format!("{} with {}\n", report.cell, report.robot);
    for fact in cell_facts(report, &planned.input.label) {
        let _ = writeln!(text, "  {:<20} {}", fact.label, fact.text);
    }
    if !report.assumed.is_empty() {
        let assumed = counted(report.assumed.len(), "parameter");
        let _ = writeln!(text, "  assumed              {assumed} without a known value:");
        for assumed in &report.assumed {
            let _ = writeln!(text, "    {assumed}");
        }
    }
    if !report.violations.is_empty() {
        text.push_str("violations by cause\n");
        text.push_str(&violations(planned));
    }
    let remedies = report.remedies.as_deref().unwrap_or_default();
    if !remedies.is_empty() {
        text.push_str("remedies, each verified by a check of the program\n");
        for remedy in remedies {
            let _ = writeln!(text, "  {}", remedy.message);
        }
    }
    if !report.bodies_in_zones.is_empty() {
        text.push_str(
            "fixed bodies in keep-out zones, which restrict only the robot and its wafers\n",
        );
        for one in &report.bodies_in_zones {
            let depth = fixed(one.depth_mm, 3);
            let _ = writeln!(text, "  {} is in {}, {depth} mm deep", one.body, one.zone);
        }
    }
    for table in cell_tables(report) {
        text.push_str(&table.to_text());
    }
    text
}

/// Violations by cause, worst first: the worst of each group with an excerpt, and the number of violations by instruction and station.
pub(super) fn violations(planned: &Planned) -> String {
    let all = &planned.report.violations;
    let groups = violation_groups(planned.cell(), &planned.motion.steps, all, DisplayUnits::Metric);
    let mut text = String::new();
    for group in groups.iter().take(GROUPS) {
        let place = SourceLocation { line: group.line, column: group.column };
        let message = format!("{}: {}", group.kind, group.message);
        for line in planned.input.excerpt(place, &message).lines() {
            let _ = writeln!(text, "  {line}");
        }
        let excess = depth(group, group.excess);
        let wafers = match group.wafers {
            0 | 1 => String::new(),
            wafers => format!(", {wafers} wafers"),
        };
        let _ = writeln!(
            text,
            "    {}{wafers}; first at {} s, worst at {} s during {}{excess}",
            counted(group.count, "time"),
            fixed(group.first_s, 3),
            fixed(group.worst_s, 3),
            group.phase
        );
        if group.occurrences.len() > 1 {
            for one in group.occurrences.iter().take(OCCURRENCES) {
                text.push_str(&occurrence(group, one));
            }
            let left = &group.occurrences[group.occurrences.len().min(OCCURRENCES)..];
            if !left.is_empty() {
                let count = left.iter().map(|one| one.count).sum();
                let _ = writeln!(text, "      and {} elsewhere", counted(count, "time"));
            }
        }
    }
    let left = &groups[groups.len().min(GROUPS)..];
    if !left.is_empty() {
        let count: usize = left.iter().map(|group| group.count).sum();
        let _ = writeln!(
            text,
            "  and {} more in {} (--format json lists all)",
            counted(count, "violation"),
            counted(left.len(), "group")
        );
    }
    text
}

/// Depth of a violation of two bodies or of a body and a zone, for a list; empty for other violations.
fn depth(group: &ViolationGroupReport, excess: Option<f64>) -> String {
    let is_of = |kinds: &[ViolationKind]| kinds.iter().any(|kind| group.kind == kind.to_string());
    let is_pair =
        [ViolationKind::Collision, ViolationKind::Clearance, ViolationKind::SlotClearance];
    let meaning = if is_of(&is_pair) {
        "too close"
    } else if is_of(&[ViolationKind::KeepOut]) {
        "deep"
    } else {
        return String::new();
    };
    excess
        .map_or(String::new(), |excess| format!(", {} {} {meaning}", fixed(excess, 3), group.unit))
}

/// Violations of a group in one instruction.
fn occurrence(group: &ViolationGroupReport, one: &OccurrenceReport) -> String {
    let station = one.station.as_ref().map_or(String::new(), |name| format!(" {name},"));
    let excess = depth(group, one.excess);
    format!(
        "      line {},{station} {}: {}, worst at {} s{excess}\n",
        one.line,
        one.phase,
        counted(one.count, "time"),
        fixed(one.worst_s, 3)
    )
}
