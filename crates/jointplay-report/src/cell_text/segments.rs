//! The slowest segments of a program, and what limits them.

use jointplay_format::number::fixed;

use super::text_table::{TableColumn, TextTable};
use crate::cell::CellReport;
use crate::segment::{LimitingReport, SegmentReport};

/// Largest number of rows.
const ROWS: usize = 8;

/// Segments of one phase of one line of the program that are limited alike.
struct Group<'a> {
    line: usize,
    runs: usize,
    total_s: f64,
    longest: &'a SegmentReport,
}

/// The segments that take most of the time in total.
pub(super) fn slowest_segments(report: &CellReport) -> TextTable {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for instruction in &report.instructions {
        for segment in &instruction.segments {
            let is_alike = |group: &&mut Group<'_>| {
                group.line == instruction.line
                    && group.longest.phase == segment.phase
                    && group.longest.path == segment.path
                    && limit(group.longest) == limit(segment)
            };
            match groups.iter_mut().find(is_alike) {
                Some(group) => {
                    group.runs += 1;
                    group.total_s += segment.duration_s;
                    if segment.duration_s > group.longest.duration_s {
                        group.longest = segment;
                    }
                }
                None => groups.push(Group {
                    line: instruction.line,
                    runs: 1,
                    total_s: segment.duration_s,
                    longest: segment,
                }),
            }
        }
    }
    groups.sort_by(|a, b| b.total_s.total_cmp(&a.total_s));
    let row = |group: &Group<'_>| {
        #[expect(clippy::cast_precision_loss, reason = "a count of runs")]
        let each = group.total_s / group.runs as f64;
        vec![
            group.line.to_string(),
            group.runs.to_string(),
            fixed(each, 3),
            group.longest.phase.to_owned(),
            explained(group.longest),
        ]
    };
    TextTable {
        title: "segments that take most time, and the limit that is reached longest",
        columns: vec![
            TableColumn::number("line"),
            TableColumn::number("runs"),
            TableColumn::number("s each"),
            TableColumn::text("segment"),
            TableColumn::text("limited by"),
        ],
        rows: groups.iter().take(ROWS).map(row).collect(),
    }
}

/// Limit and name of what limits a segment.
fn limit(segment: &SegmentReport) -> Option<(&str, Option<&str>)> {
    segment.limited_by.as_ref().map(|one| (one.limit, one.name.as_deref()))
}

/// Limiting constraint of a segment, with its places and durations.
fn explained(segment: &SegmentReport) -> String {
    let Some(limiting) = &segment.limited_by else {
        let reason = if segment.blended {
            "no limit: slower for a longer blend"
        } else {
            "limits reached for less than 1 % of the time"
        };
        return reason.to_owned();
    };
    let LimitingReport { limit, name, time_share, from_share, to_share } = limiting;
    let name = name.as_ref().map_or(String::new(), |name| format!(" of {name}"));
    let percent = |share: &f64| fixed(100.0 * share, 0);
    format!(
        "{limit}{name} for {} % of the time (first at {} %, last at {} % of the path)",
        percent(time_share),
        percent(from_share),
        percent(to_share)
    )
}
