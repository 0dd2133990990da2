//! What a check finds, in words.

use std::fmt::Write as _;

use jointplay::cell::check::{Kind, Violation};
use jointplay::cell::program::Place;
use jointplay::format::report::{CellReport, InstructionReport, ShareReport, explain_violation};

use super::input::Planned;
use crate::output::fixed;

/// Times that are listed of one violation that comes again and again.
const TIMES: usize = 4;

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

/// Every violation with its moment; those of one line and kind under one excerpt.
pub(super) fn violations(planned: &Planned) -> String {
    let mut text = String::new();
    type About<'a> = (Place, Kind, &'a [String]);
    let mut told: Vec<(About<'_>, Vec<&Violation>)> = Vec::new();
    for one in &planned.report.violations {
        let about = (one.place, one.kind, &one.names[..]);
        match told.iter_mut().find(|(known, _)| *known == about) {
            Some((_, all)) => all.push(one),
            None => told.push((about, vec![one])),
        }
    }
    for ((place, kind, _), all) in told {
        // The worst of them stands for all, and each is told its time.
        let excess = |one: &&&Violation| (one.worst - one.limit).abs();
        let worst = all.iter().max_by(|a, b| excess(a).total_cmp(&excess(b)));
        let Some(worst) = worst else { continue };
        let message = format!("{kind}: {}", explain_violation(worst));
        for line in planned.input.excerpt(place, &message).lines() {
            let _ = writeln!(text, "  {line}");
        }
        let times: Vec<String> = all
            .iter()
            .take(TIMES)
            .map(|one| match (fixed(one.start, 3), fixed(one.end, 3)) {
                (start, end) if start == end => start,
                (start, end) => format!("{start} to {end}"),
            })
            .collect();
        let more = match all.len().saturating_sub(TIMES) {
            0 => String::new(),
            more => {
                format!(", and {} more (--format json has them all)", counted(more, "time"))
            }
        };
        let _ = writeln!(text, "    at {} s{more}", times.join(", "));
    }
    text
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

fn percent(share: f64) -> String {
    fixed(100.0 * share, 0)
}
