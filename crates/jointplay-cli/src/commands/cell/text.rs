//! What a check finds, in words.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use jointplay::cell::EntityId;
use jointplay::cell::check::{Kind, Violation};
use jointplay::cell::program::Place;
use jointplay::report::{CellReport, InstructionReport, ShareReport, explain_violation};

use super::input::Planned;
use crate::output::fixed;

/// Times that are listed of one violation that comes again and again.
const TIMES: usize = 4;
/// Groups of violations that are listed.
const GROUPS: usize = 12;

/// Verdict, what is wrong, and a table by line of the program.
pub(super) fn report(report: &CellReport, planned: &Planned) -> String {
    let mut text = format!("{} with {}\n", report.cell, report.robot);
    let metric = report.metric_mm.map_or(String::new(), |length| {
        format!(", an angle of 1 rad counted as {} mm", fixed(length, 3))
    });
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
        counted(report.steps, "motion")
    );
    let _ = writeln!(text, "  time                 {} s", fixed(report.duration_s, 3));
    if let Some(rate) = report.wafers_per_hour {
        let _ = writeln!(
            text,
            "  throughput           {} in it, {} an hour where it is repeated",
            counted(report.wafers, "wafer"),
            fixed(rate, 1)
        );
    }
    if let Some(straight) = &report.straight {
        let _ = writeln!(
            text,
            "  straight lines       {}, wafers within {} µm",
            straight.motions,
            fixed(straight.off_um, 3)
        );
    }
    if let Some(blended) = &report.blended {
        let _ = writeln!(
            text,
            "  blended              {}, {} s at once, wafers within {} mm of the way without",
            counted(blended.motions, "corner"),
            fixed(blended.overlap_s, 3),
            fixed(blended.off_mm, 3)
        );
    }
    if let Some(made) = &report.compensated {
        let _ = writeln!(
            text,
            "  made up for          droop to {} µm and {} mrad, sag of {} µm, in {}",
            fixed(made.drop_um, 1),
            fixed(made.slope_mrad, 3),
            fixed(made.sag_um, 1),
            counted(made.handovers, "handover")
        );
        let _ = writeln!(
            text,
            "  left of it           {} µm and {} mrad off the slots' planes; wafers stay bent by {} µm",
            fixed(made.left_um, 3),
            fixed(made.left_mrad, 4),
            fixed(made.bent_um, 1)
        );
        let _ = writeln!(
            text,
            "  at a handover        an effector moves by up to {} µm as the weight passes over, at once in poses and files",
            fixed(made.jump_um, 1)
        );
        if let (Some(mrad), Some(height)) = (made.taught_mrad, made.taught_um) {
            let _ = writeln!(
                text,
                "  taught planes        known to ±{} mrad and ±{} µm (95 %), in addition",
                fixed(mrad, 4),
                fixed(height, 1)
            );
        }
        if !made.taught_unknown.is_empty() {
            let _ = writeln!(
                text,
                "  taught planes        uncertainty unknown for {}: `noise_um` or more points give it",
                made.taught_unknown.join(", ")
            );
        }
    }
    let _ = writeln!(text, "  looked at            {}", counted(report.samples, "sample"));
    if !report.assumed.is_empty() {
        let assumed = counted(report.assumed.len(), "parameter");
        let _ = writeln!(text, "  assumed, not known   {assumed}:");
        for assumed in &report.assumed {
            let _ = writeln!(text, "    {assumed}");
        }
    }
    if count > 0 {
        text.push_str("violations\n");
        text.push_str(&violations(planned));
    }
    lines(&mut text, report);
    axes(&mut text, report);
    if !report.nearest.is_empty() {
        let _ = writeln!(text, "bodies that come nearest");
        for pair in &report.nearest {
            let [a, b] = &pair.bodies;
            let others = match pair.others {
                0 => String::new(),
                1 => "; another such pair comes no nearer".to_owned(),
                others => format!("; {others} more such pairs come no nearer"),
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

/// What a group of violations has in common: command, kind, and the entities concerned, `None` for any wafer.
type Group = (Place, Kind, Vec<Option<EntityId>>);

/// Violations grouped by command and pair, worst first: the worst of each group under an excerpt, with times and number of the others.
pub(super) fn violations(planned: &Planned) -> String {
    let mut groups: BTreeMap<Group, Vec<&Violation>> = BTreeMap::new();
    for one in &planned.report.violations {
        let entities = one.entities.iter().map(|&one| (!one.is_wafer()).then_some(one)).collect();
        groups.entry((one.place, one.kind, entities)).or_default().push(one);
    }
    let mut groups: Vec<Vec<&Violation>> = groups.into_values().collect();
    for group in &mut groups {
        // The worst of them stands for all; of equal ones the first.
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
            wafers => format!("; {wafers} wafers in all"),
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

/// By how much a limit is broken, in SI; of no meaning between kinds.
fn excess(one: &Violation) -> f64 {
    (one.worst - one.limit).abs()
}

/// Which kinds come first: what breaks something, then what comes too near, then the limits of the axes.
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

/// A row for each line of the program, over all its runs.
fn lines(text: &mut String, report: &CellReport) {
    let mut rows: Vec<(usize, Vec<&InstructionReport>)> = Vec::new();
    for one in &report.instructions {
        match rows.iter_mut().find(|(line, _)| *line == one.line) {
            Some((_, runs)) => runs.push(one),
            None => rows.push((one.line, vec![one])),
        }
    }
    rows.sort_by_key(|&(line, _)| line);
    let _ = writeln!(text, "by line, the most of all its runs; shares of limits in %");
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
            "  {:<20} moves {:>10} s, {:>3} % of the time",
            axis.name,
            fixed(axis.moving_s, 3),
            percent(share)
        );
    }
}

/// A number of things: the word takes its plural by an s.
pub(super) fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A share in %; what is beyond all bounds, such as of a limit of zero, is more than can be shown.
fn percent(share: f64) -> String {
    if share.is_finite() && share < 99.995 { fixed(100.0 * share, 0) } else { ">9999".to_owned() }
}
