//! The report of a check as text.

use std::fmt::Write as _;

use jointplay::cell::check::ViolationKind;
use jointplay::cell::program::SourceLocation;
use jointplay::format::number::{counted, number};
use jointplay::report::{
    CellReport, InstructionReport, OccurrenceReport, ScheduleReport, ShareReport, StationUseReport,
    ViolationGroupReport, violation_groups,
};

use super::input::Planned;
use super::slowest::slowest_segments;
use crate::output::fixed;

/// Largest number of instructions listed of a violation group.
const OCCURRENCES: usize = 4;
/// Shortest wait for a process that is listed (s).
const SHORTEST_WAIT: f64 = 0.05;
/// Largest number of violation groups listed.
const GROUPS: usize = 12;

/// CheckResult, violations, and a table by program line.
pub(super) fn report(report: &CellReport, planned: &Planned) -> String {
    let mut text = format!("{} with {}\n", report.cell, report.robot);
    let metric = report
        .metric_mm
        .map_or(String::new(), |length| format!(", characteristic length {} mm", fixed(length, 3)));
    let _ = writeln!(
        text,
        "  platform             {} virtualization, {}{metric}",
        report.virtualization, report.solver
    );
    let count = report.violations.len();
    let result = match count {
        0 => "passed".to_owned(),
        count => format!("{}, not safe to run", counted(count, "violation")),
    };
    let _ = writeln!(text, "  result               {result}");
    let _ = writeln!(
        text,
        "  program              {}, {} in {}",
        planned.input.label,
        counted(report.instructions.len(), "instruction"),
        counted(report.steps, "segment")
    );
    let _ = writeln!(text, "  time                 {} s", fixed(report.duration_s, 3));
    if let Some(rate) = report.wafers_per_hour {
        let _ = writeln!(
            text,
            "  throughput           {}, {} wafers/h if repeated",
            counted(report.wafers, "wafer"),
            fixed(rate, 1)
        );
    }
    schedule(&mut text, &report.schedule);
    if let Some(straight) = &report.straight {
        let _ = writeln!(
            text,
            "  Cartesian lines      {}, wafer centre within {} µm",
            straight.motions,
            fixed(straight.off_um, 3)
        );
    }
    if let Some(blended) = &report.blended {
        let _ = writeln!(
            text,
            "  blended              {}, overlap {} s, wafer centre within {} mm of the unblended path",
            counted(blended.motions, "corner"),
            fixed(blended.overlap_s, 3),
            fixed(blended.off_mm, 3)
        );
    }
    if let Some(compensated) = &report.compensated {
        let _ = writeln!(
            text,
            "  compensated          droop up to {} µm and {} mrad, sag up to {} µm, at {}",
            fixed(compensated.drop_um, 1),
            fixed(compensated.slope_mrad, 3),
            fixed(compensated.sag_um, 1),
            counted(compensated.handoffs, "hand-off")
        );
        let _ = writeln!(
            text,
            "  residual             {} µm and {} mrad from the slot planes; residual curvature of wafers {} µm",
            fixed(compensated.left_um, 3),
            fixed(compensated.left_mrad, 4),
            fixed(compensated.bent_um, 1)
        );
        let _ = writeln!(
            text,
            "  hand-off step        effectors move by up to {} µm as they take or release the weight",
            fixed(compensated.jump_um, 1)
        );
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
            let _ = writeln!(
                text,
                "  stations             known to {} (coverage factor {}); in slot clearance and plane budget",
                known.join(", "),
                number(compensated.coverage_factor)
            );
        }
        if !compensated.taught_unknown.is_empty() {
            let _ = writeln!(
                text,
                "  stations             tilt counted as exact: {}; add `taught` with `noise_um`, or `uncertainty`",
                compensated.taught_unknown.join(", ")
            );
        }
    }
    let _ = writeln!(text, "  checked at           {}", counted(report.samples, "sample"));
    if !report.assumed.is_empty() {
        let assumed = counted(report.assumed.len(), "parameter");
        let _ = writeln!(text, "  assumed              {assumed} without a known value:");
        for assumed in &report.assumed {
            let _ = writeln!(text, "    {assumed}");
        }
    }
    if count > 0 {
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
    stations(&mut text, &report.schedule);
    lines(&mut text, report);
    text.push_str(&slowest_segments(report));
    axes(&mut text, report);
    if !report.nearest.is_empty() {
        let _ = writeln!(text, "minimum distances");
        for pair in &report.nearest {
            let [a, b] = &pair.bodies;
            let others = match pair.others {
                0 => String::new(),
                1 => "; one similar pair is farther apart".to_owned(),
                others => format!("; {others} similar pairs are farther apart"),
            };
            let _ = writeln!(
                text,
                "  {:>10} mm at {:>9} s   {a}, {b}{others}",
                fixed(pair.distance_mm, 3),
                fixed(pair.time_s, 3)
            );
        }
    }
    text
}

/// Waits, bottleneck and periodic parts.
fn schedule(text: &mut String, schedule: &ScheduleReport) {
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
    let _ = writeln!(
        text,
        "  robot                moving {} % of the time, {waits}",
        percent(robot.busy_share)
    );
    for part in &schedule.periodic_parts {
        let lines = match part.lines {
            [first, last] if first == last => format!("line {first}"),
            [first, last] => format!("lines {first} to {last}"),
        };
        let _ = writeln!(
            text,
            "  periodic             {lines}: {} of {} s ({} to {}), {} wafers/h",
            counted(part.cycles, "cycle"),
            fixed(part.period_s, 3),
            fixed(part.shortest_period_s, 3),
            fixed(part.longest_period_s, 3),
            fixed(part.wafers_per_hour, 1)
        );
    }
    if let Some(bottleneck) = &schedule.bottleneck {
        let name = match bottleneck.kind {
            "process" => format!("process of {}", bottleneck.name),
            "wait command" => "WAIT commands".to_owned(),
            _ => "robot".to_owned(),
        };
        let of =
            if schedule.periodic_parts.is_empty() { "program" } else { "longest periodic part" };
        let _ = writeln!(
            text,
            "  bottleneck           {name}: {} % of the critical path of the {of}",
            percent(bottleneck.share)
        );
    }
}

/// A row for each station that the program uses.
fn stations(text: &mut String, schedule: &ScheduleReport) {
    let used: Vec<&StationUseReport> =
        schedule.stations.iter().filter(|station| station.visits > 0).collect();
    if used.is_empty() {
        return;
    }
    text.push_str("stations, shares of the time in %\n");
    text.push_str(
        "  station     visits  occupied  processing  robot waits s  shortest stay s  longest stay s\n",
    );
    for station in used {
        let seconds = |time: Option<f64>| time.map_or("–".to_owned(), |time| fixed(time, 1));
        let limit =
            station.max_dwell_s.map_or(String::new(), |max| format!(" of {}", fixed(max, 1)));
        let _ = writeln!(
            text,
            "  {:<12} {:>5} {:>9} {:>11} {:>14} {:>16} {:>15}{limit}",
            station.name,
            station.visits,
            percent(station.occupied_share),
            percent(station.busy_share),
            fixed(station.robot_waits_s, 1),
            seconds(station.shortest_stay_s),
            seconds(station.longest_stay_s)
        );
    }
}

/// Violations by cause, worst first: the worst of each group with an excerpt, and the number of violations by instruction and station.
pub(super) fn violations(planned: &Planned) -> String {
    let all = &planned.report.violations;
    let groups = violation_groups(planned.cell(), &planned.motion.steps, all);
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
            "    {}{wafers}; first at {} s, worst at {} s{excess}",
            counted(group.count, "time"),
            fixed(group.first_s, 3),
            fixed(group.worst_s, 3)
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

/// A row for each line of the program, over all its executions.
fn lines(text: &mut String, report: &CellReport) {
    let mut rows: Vec<(usize, Vec<&InstructionReport>)> = Vec::new();
    for one in &report.instructions {
        match rows.iter_mut().find(|(line, _)| *line == one.line) {
            Some((_, runs)) => runs.push(one),
            None => rows.push((one.line, vec![one])),
        }
    }
    rows.sort_by_key(|&(line, _)| line);
    let _ = writeln!(text, "by line, maximum over all executions; shares of limits in %");
    let _ = writeln!(
        text,
        "  line  runs   s each  speed  accel.  jerk  tilt  play  slip  nearest mm  violations"
    );
    for (line, runs) in rows {
        let most = |pick: &dyn Fn(&InstructionReport) -> f64| {
            runs.iter().map(|one| pick(one)).fold(0.0, f64::max)
        };
        let share = |of: fn(&InstructionReport) -> &Option<ShareReport>| {
            percent(most(&|one| of(one).as_ref().map_or(0.0, |share| share.share)))
        };
        #[expect(clippy::cast_precision_loss, reason = "a count of runs")]
        let each = runs.iter().map(|one| one.duration_s).sum::<f64>() / runs.len() as f64;
        let nearest =
            runs.iter().filter_map(|one| one.nearest.as_ref().map(|pair| pair.distance_mm));
        let nearest = nearest.reduce(f64::min).map_or("–".to_owned(), |mm| fixed(mm, 2));
        let _ = writeln!(
            text,
            "  {line:>4} {:>5} {:>8} {:>6} {:>7} {:>5} {:>5} {:>5} {:>5} {nearest:>11} {:>11}  {}",
            runs.len(),
            fixed(each, 3),
            share(|one| &one.speed),
            share(|one| &one.acceleration),
            share(|one| &one.jerk),
            percent(most(&|one| one.tilt)),
            percent(most(&|one| one.play)),
            share(|one| &one.slip),
            runs.iter().map(|one| one.violations).sum::<usize>(),
            runs[0].text
        );
    }
}

fn axes(text: &mut String, report: &CellReport) {
    let _ = writeln!(text, "axes");
    for axis in &report.axes {
        let share = if report.duration_s > 0.0 { axis.moving_s / report.duration_s } else { 0.0 };
        let _ = writeln!(
            text,
            "  {:<20} moving {:>10} s, {:>3} % of the time",
            axis.name,
            fixed(axis.moving_s, 3),
            percent(share)
        );
    }
}

/// A share in %; very large shares, such as of a limit of zero, are shown as >9999.
fn percent(share: f64) -> String {
    if share.is_finite() && share < 99.995 { fixed(100.0 * share, 0) } else { ">9999".to_owned() }
}
