//! The report of a check as text.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use jointplay::cell::EntityId;
use jointplay::cell::check::{Kind, Violation};
use jointplay::cell::program::SourceLocation;
use jointplay::format::number::counted;
use jointplay::report::{CellReport, InstructionReport, ShareReport, explain_violation};

use super::input::Planned;
use super::slowest::slowest_segments;
use crate::output::fixed;

/// Largest number of times listed of a repeated violation.
const TIMES: usize = 4;
/// Largest number of violation groups listed.
const GROUPS: usize = 12;

/// Verdict, violations, and a table by program line.
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
    let verdict = match count {
        0 => "sound".to_owned(),
        count => format!("{}, not safe to run", counted(count, "violation")),
    };
    let _ = writeln!(text, "  verdict              {verdict}");
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
        if let (Some(mrad), Some(height)) = (compensated.taught_mrad, compensated.taught_um) {
            let _ = writeln!(
                text,
                "  taught planes        additional uncertainty ±{} mrad and ±{} µm (95 %)",
                fixed(mrad, 4),
                fixed(height, 1)
            );
        }
        if !compensated.taught_unknown.is_empty() {
            let _ = writeln!(
                text,
                "  taught planes        uncertainty unknown for {}: add `noise_um` or more points",
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
        text.push_str("violations\n");
        text.push_str(&violations(planned));
    }
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

/// The common properties of a group of violations; wafers count as one entity, `None`.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct GroupKey {
    place: SourceLocation,
    kind: Kind,
    entities: Vec<Option<EntityId>>,
}

/// Violations grouped by command and pair, worst first: the worst of each group with an excerpt, and the times and number of the others.
pub(super) fn violations(planned: &Planned) -> String {
    let mut groups: BTreeMap<GroupKey, Vec<&Violation>> = BTreeMap::new();
    for one in &planned.report.violations {
        let entities = one.entities.iter().map(|&one| (!one.is_wafer()).then_some(one)).collect();
        let key = GroupKey { place: one.place, kind: one.kind, entities };
        groups.entry(key).or_default().push(one);
    }
    let mut groups: Vec<Vec<&Violation>> = groups.into_values().collect();
    for group in &mut groups {
        // The worst one represents the group; of equal ones the first.
        group.sort_by(|a, b| excess(b).total_cmp(&excess(a)).then(a.start.total_cmp(&b.start)));
    }
    groups.sort_by(|a, b| {
        let [one, other] = [a[0], b[0]];
        let by_kind = severity(one.kind).cmp(&severity(other.kind));
        by_kind.then(excess(other).total_cmp(&excess(one))).then(one.start.total_cmp(&other.start))
    });
    let mut text = String::new();
    for group in groups.iter().take(GROUPS) {
        let worst = group[0];
        let message = format!("{}: {}", worst.kind, explain_violation(planned.cell(), worst));
        for line in planned.input.excerpt(worst.place, &message).lines() {
            let _ = writeln!(text, "  {line}");
        }
        let times: Vec<String> = group
            .iter()
            .take(TIMES)
            .map(|one| match (fixed(one.start, 3), fixed(one.end, 3)) {
                (start, end) if start == end => start,
                (start, end) => format!("{start} to {end}"),
            })
            .collect();
        let more = match group.len().saturating_sub(TIMES) {
            0 => String::new(),
            more => format!(", and {} more", counted(more, "time")),
        };
        let entities = group.iter().flat_map(|one| &one.entities);
        let wafers: BTreeSet<&EntityId> = entities.filter(|one| one.is_wafer()).collect();
        let wafers = match wafers.len() {
            0 | 1 => String::new(),
            wafers => format!("; {wafers} wafers in total"),
        };
        let _ = writeln!(text, "    at {} s{more}{wafers}", times.join(", "));
    }
    let left = &groups[groups.len().min(GROUPS)..];
    if !left.is_empty() {
        let count: usize = left.iter().map(Vec::len).sum();
        let _ = writeln!(
            text,
            "  and {} more in {} (--format json lists all)",
            counted(count, "violation"),
            counted(left.len(), "group")
        );
    }
    text
}

/// Amount by which a limit is exceeded, in SI units; not comparable between kinds.
fn excess(one: &Violation) -> f64 {
    (one.worst - one.limit).abs()
}

/// Rank of a kind: damage first, then clearances, then limits of the axes.
fn severity(kind: Kind) -> u8 {
    match kind {
        Kind::Platform | Kind::Droop => 0,
        Kind::Collision => 1,
        Kind::KeepOut => 2,
        Kind::Clearance | Kind::SlotClearance | Kind::SafeZone => 3,
        Kind::Slip => 4,
        _ => 5,
    }
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
