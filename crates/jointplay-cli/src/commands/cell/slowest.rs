//! The slowest segments of a program, and what limits them, as text.

use std::fmt::Write as _;

use jointplay::report::{CellReport, LimitingReport, SegmentReport};

use crate::output::fixed;

/// Largest number of rows.
const ROWS: usize = 8;

/// Segments of one phase of one line of the program that are limited alike.
struct Group<'a> {
    line: usize,
    runs: usize,
    total_s: f64,
    longest: &'a SegmentReport,
}

/// A table of the segments that take most of the time in total; empty where nothing moves.
pub(super) fn slowest_segments(report: &CellReport) -> String {
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
    if groups.is_empty() {
        return String::new();
    }
    groups.sort_by(|a, b| b.total_s.total_cmp(&a.total_s));
    let mut text =
        "segments that take most time, and the limit that is reached longest\n".to_owned();
    let _ = writeln!(text, "  line  runs   s each  segment  limited by");
    for group in groups.iter().take(ROWS) {
        #[expect(clippy::cast_precision_loss, reason = "a count of runs")]
        let each = group.total_s / group.runs as f64;
        let _ = writeln!(
            text,
            "  {:>4} {:>5} {:>8}  {:<7}  {}",
            group.line,
            group.runs,
            fixed(each, 3),
            group.longest.phase,
            explained(group.longest)
        );
    }
    text
}

/// Limit and name of what limits a segment.
fn limit(segment: &SegmentReport) -> Option<(&str, Option<&str>)> {
    segment.limited_by.as_ref().map(|one| (one.limit, one.name.as_deref()))
}

/// What limits a segment, where, and for how long.
fn explained(segment: &SegmentReport) -> String {
    let Some(limiting) = &segment.limited_by else {
        return "no limit: slower for a longer blend".to_owned();
    };
    let LimitingReport { limit, name, time_share, from_share, to_share } = limiting;
    let name = name.as_ref().map_or(String::new(), |name| format!(" of {name}"));
    let percent = |share: &f64| fixed(100.0 * share, 0);
    let path = if segment.path == "line" { "line" } else { "move" };
    format!(
        "{limit}{name} for {} % of the time, from {} to {} % of the {path}",
        percent(time_share),
        percent(from_share),
        percent(to_share)
    )
}
