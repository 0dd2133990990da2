//! Results of a check as labelled lines.

use jointplay_format::number::{counted, fixed, number, percent};

use crate::cell::{CellReport, CompensatedReport};
use crate::schedule::ScheduleReport;

/// Shortest wait for a process that is listed (s).
const SHORTEST_WAIT: f64 = 0.05;

/// A labelled line of a report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fact {
    /// Its name, such as `throughput`.
    pub label: &'static str,
    /// Values with units.
    pub text: String,
}

fn fact(label: &'static str, text: impl Into<String>) -> Fact {
    Fact { label, text: text.into() }
}

/// Results of a check, the most important first.
///
/// # Arguments
/// * `program` – name of the program
#[must_use]
pub fn cell_facts(report: &CellReport, program: &str) -> Vec<Fact> {
    let metric = report
        .metric_mm
        .map_or(String::new(), |length| format!(", characteristic length {} mm", fixed(length, 3)));
    let platform = format!("{} virtualization, {}{metric}", report.virtualization, report.solver);
    let result = match report.violations.len() {
        0 if report.result == "no_motion" => "no motion".to_owned(),
        0 if !report.not_checked.is_empty() => "no violations in what was checked".to_owned(),
        0 => "passed".to_owned(),
        count => format!("{}, not safe to run", counted(count, "violation")),
    };
    let size = format!(
        "{program}, {} in {}",
        counted(report.instructions.len(), "instruction"),
        counted(report.steps, "segment")
    );
    let mut facts = vec![fact("platform", platform), fact("result", result)];
    if !report.not_checked.is_empty() {
        let parts = report.not_checked.join(", ");
        facts.push(fact(
            "not checked",
            format!("collisions of {parts}: without bodies in the cell file"),
        ));
    }
    facts.push(fact("program", size));
    facts.push(fact("time", format!("{} s", fixed(report.duration_s, 3))));
    if let Some(rate) = report.wafers_per_hour {
        let wafers = counted(report.wafers, "wafer");
        let text = format!("{wafers}, {} wafers/h if repeated", fixed(rate, 1));
        facts.push(fact("throughput", text));
    }
    schedule(&mut facts, &report.schedule);
    if let Some(straight) = &report.straight {
        let (count, off) = (straight.motions, fixed(straight.off_um, 3));
        facts.push(fact("Cartesian lines", format!("{count}, wafer centre within {off} µm")));
    }
    if let Some(blended) = &report.blended {
        let text = format!(
            "{}, overlap {} s, wafer centre within {} mm of the unblended path",
            counted(blended.motions, "corner"),
            fixed(blended.overlap_s, 3),
            fixed(blended.off_mm, 3)
        );
        facts.push(fact("blended", text));
    }
    if let Some(compensated) = &report.compensated {
        deflection(&mut facts, compensated);
    }
    facts.push(fact("checked at", counted(report.samples, "sample")));
    facts
}

/// Compensated deflection, and the uncertainty of stations.
fn deflection(facts: &mut Vec<Fact>, compensated: &CompensatedReport) {
    let text = format!(
        "droop up to {} µm and {} mrad, sag up to {} µm, at {}",
        fixed(compensated.droop_um, 1),
        fixed(compensated.slope_mrad, 3),
        fixed(compensated.sag_um, 1),
        counted(compensated.handoffs, "hand-off")
    );
    facts.push(fact("compensated", text));
    let text = format!(
        "{} µm and {} mrad from the slot planes; residual sag of wafers {} µm",
        fixed(compensated.residual_um, 3),
        fixed(compensated.residual_mrad, 4),
        fixed(compensated.residual_sag_um, 1)
    );
    facts.push(fact("residual", text));
    let jump = fixed(compensated.jump_um, 1);
    let text = format!("effectors move by up to {jump} µm as they take or release the weight");
    facts.push(fact("hand-off step", text));
    let known = [
        (compensated.taught_mrad, 4, "mrad of tilt"),
        (compensated.taught_um, 1, "µm in height"),
        (compensated.taught_sideways_um, 1, "µm sideways"),
    ];
    let known: Vec<String> = known
        .iter()
        .filter_map(|(value, decimals, unit)| {
            value.map(|value| format!("±{} {unit}", fixed(value, *decimals)))
        })
        .collect();
    if !known.is_empty() {
        let text = format!(
            "known to {} (coverage factor {}); included in the checks of slot clearance and plane budget",
            known.join(", "),
            number(compensated.coverage_factor)
        );
        facts.push(fact("stations", text));
    }
    if !compensated.taught_unknown.is_empty() {
        let text = format!(
            "tilt counted as exact: {}; add `taught` with `noise_um`, or `uncertainty`",
            compensated.taught_unknown.join(", ")
        );
        facts.push(fact("stations", text));
    }
}

/// Waits, periodic parts and bottleneck.
fn schedule(facts: &mut Vec<Fact>, schedule: &ScheduleReport) {
    let robot = &schedule.robot;
    let mut waits: Vec<String> = robot
        .process_waits
        .iter()
        .filter(|wait| wait.waiting_s >= SHORTEST_WAIT)
        .map(|wait| format!("{} s for {}", fixed(wait.waiting_s, 1), wait.station))
        .collect();
    if robot.commanded_waits_s > 0.0 {
        waits.push(format!("{} s by WAIT", fixed(robot.commanded_waits_s, 1)));
    }
    let waits = match waits.len() {
        0 => "no waits".to_owned(),
        1 => format!("waits {}", waits[0]),
        _ => format!("waits {} s: {}", fixed(robot.waiting_s, 1), waits.join(", ")),
    };
    let text = format!("moving {} % of the time, {waits}", percent(robot.busy_share));
    facts.push(fact("robot", text));
    for part in &schedule.periodic_parts {
        let lines = match part.lines {
            [first, last] if first == last => format!("line {first}"),
            [first, last] => format!("lines {first} to {last}"),
        };
        let text = format!(
            "{lines}: {}, period {} s ({} to {}), {} wafers/h",
            counted(part.cycles, "cycle"),
            fixed(part.period_s, 3),
            fixed(part.shortest_period_s, 3),
            fixed(part.longest_period_s, 3),
            fixed(part.wafers_per_hour, 1)
        );
        facts.push(fact("periodic", text));
    }
    if let Some(bottleneck) = &schedule.bottleneck {
        let name = match bottleneck.kind {
            "process" => format!("process of {}", bottleneck.name),
            "wait command" => "WAIT commands".to_owned(),
            _ => "robot".to_owned(),
        };
        let of =
            if schedule.periodic_parts.is_empty() { "program" } else { "longest periodic part" };
        let share = percent(bottleneck.share);
        let text = format!("{name}: {share} % of the critical path of the {of}");
        facts.push(fact("bottleneck", text));
    }
}
