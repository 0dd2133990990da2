//! Results of a check as tables.

use jointplay_format::number::{fixed, percent};

use super::segments::slowest_segments;
use super::text_table::{TableColumn, TextTable};
use crate::cell::{CellReport, InstructionReport, ShareReport};
use crate::schedule::{ScheduleReport, StationUseReport};

/// Tables of a check: use of the stations, lines of the program, slowest segments, axes, minimum distances; those without rows are omitted.
#[must_use]
pub fn cell_tables(report: &CellReport) -> Vec<TextTable> {
    let all = [
        stations(&report.schedule),
        lines(report),
        slowest_segments(report),
        axes(report),
        distances(report),
    ];
    all.into_iter().filter(|table| !table.rows.is_empty()).collect()
}

/// A row for each station that the program uses.
fn stations(schedule: &ScheduleReport) -> TextTable {
    let seconds = |time: Option<f64>| time.map_or("–".to_owned(), |time| fixed(time, 1));
    let row = |station: &StationUseReport| {
        vec![
            station.name.clone(),
            station.visits.to_string(),
            percent(station.occupied_share),
            percent(station.busy_share),
            fixed(station.robot_waits_s, 1),
            seconds(station.shortest_dwell_s),
            seconds(station.longest_dwell_s),
            seconds(station.max_dwell_s),
        ]
    };
    TextTable {
        title: "stations, shares of the time in %",
        columns: vec![
            TableColumn::text("station"),
            TableColumn::number("visits"),
            TableColumn::number("occupied"),
            TableColumn::number("processing"),
            TableColumn::number("robot waits s"),
            TableColumn::number("shortest dwell s"),
            TableColumn::number("longest dwell s"),
            TableColumn::number("allowed s"),
        ],
        rows: schedule.stations.iter().filter(|one| one.visits > 0).map(row).collect(),
    }
}

/// A row for each line of the program, over all its executions.
fn lines(report: &CellReport) -> TextTable {
    let mut lines: Vec<(usize, Vec<&InstructionReport>)> = Vec::new();
    for one in &report.instructions {
        match lines.iter_mut().find(|(line, _)| *line == one.line) {
            Some((_, runs)) => runs.push(one),
            None => lines.push((one.line, vec![one])),
        }
    }
    lines.sort_by_key(|&(line, _)| line);
    TextTable {
        title: "by line, maximum over all executions; shares of limits in %",
        columns: vec![
            TableColumn::number("line"),
            TableColumn::number("runs"),
            TableColumn::number("s each"),
            TableColumn::number("speed"),
            TableColumn::number("accel."),
            TableColumn::number("jerk"),
            TableColumn::number("tilt"),
            TableColumn::number("play"),
            TableColumn::number("slip"),
            TableColumn::number("least distance mm"),
            TableColumn::number("violations"),
            TableColumn::text("instruction"),
        ],
        rows: lines.iter().map(|(line, runs)| line_row(*line, runs)).collect(),
    }
}

/// Row of a line of the program.
///
/// # Arguments
/// * `runs` – its executions, at least one
fn line_row(line: usize, runs: &[&InstructionReport]) -> Vec<String> {
    let most = |pick: &dyn Fn(&InstructionReport) -> f64| {
        runs.iter().map(|one| pick(one)).fold(0.0, f64::max)
    };
    let share = |of: fn(&InstructionReport) -> &Option<ShareReport>| {
        percent(most(&|one| of(one).as_ref().map_or(0.0, |share| share.share)))
    };
    #[expect(clippy::cast_precision_loss, reason = "a count of runs")]
    let each = runs.iter().map(|one| one.duration_s).sum::<f64>() / runs.len() as f64;
    let nearest = runs.iter().filter_map(|one| one.nearest.as_ref().map(|pair| pair.distance_mm));
    let nearest = nearest.reduce(f64::min).map_or("–".to_owned(), |mm| fixed(mm, 2));
    vec![
        line.to_string(),
        runs.len().to_string(),
        fixed(each, 3),
        share(|one| &one.speed),
        share(|one| &one.acceleration),
        share(|one| &one.jerk),
        percent(most(&|one| one.tilt)),
        percent(most(&|one| one.play)),
        share(|one| &one.slip),
        nearest,
        runs.iter().map(|one| one.violations).sum::<usize>().to_string(),
        runs[0].text.clone(),
    ]
}

/// A row for each axis.
fn axes(report: &CellReport) -> TextTable {
    let share =
        |moving: f64| if report.duration_s > 0.0 { moving / report.duration_s } else { 0.0 };
    TextTable {
        title: "axes, share of the time in motion in %",
        columns: vec![
            TableColumn::text("axis"),
            TableColumn::number("moving s"),
            TableColumn::number("share"),
        ],
        rows: report
            .axes
            .iter()
            .map(|axis| {
                vec![axis.name.clone(), fixed(axis.moving_s, 3), percent(share(axis.moving_s))]
            })
            .collect(),
    }
}

/// A row for each of the pairs with the smallest distances.
fn distances(report: &CellReport) -> TextTable {
    TextTable {
        title: "minimum distances; of pairs that differ only by their wafers, the closest",
        columns: vec![
            TableColumn::number("mm"),
            TableColumn::number("at s"),
            TableColumn::text("bodies"),
            TableColumn::number("similar pairs"),
        ],
        rows: report
            .nearest
            .iter()
            .map(|pair| {
                vec![
                    fixed(pair.distance_mm, 3),
                    fixed(pair.time_s, 3),
                    pair.bodies.join(", "),
                    pair.others.to_string(),
                ]
            })
            .collect(),
    }
}
