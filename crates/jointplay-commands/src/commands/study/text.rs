//! The summary of a study as text.

use std::fmt::Write as _;
use std::path::Path;

use jointplay::format::number::fixed;
use jointplay::format::study::StudyFile;
use jointplay::report::study_parts::StatusReport;
use jointplay::report::{ColumnReport, OutcomeReport, TotalsReport};

use super::estimate::Estimate;
use crate::console;
use crate::failure::Failure;
use crate::output;

/// Prints the summary of a completed study; without a file of its table, on standard error.
pub(super) fn print_summary(
    report: &TotalsReport,
    out: Option<&Path>,
    json: bool,
) -> Result<(), Failure> {
    match (json, out) {
        (true, None) => console::print(&output::to_json(report)),
        (true, Some(_)) => output::json(report)?,
        (false, None) => console::note(summary(report, None).trim_end()),
        (false, Some(_)) => output::text(&summary(report, out))?,
    }
    if report.outcomes.iter().all(|model| model.solved == 0) {
        return Err(Failure::Unsolved(format!(
            "no sample could be solved; {} has the kind of error of each: for its message, give the values of a row to the command for a single case",
            out.map_or("the table".to_owned(), |out| out.display().to_string())
        )));
    }
    Ok(())
}

/// The summary of a completed study, and the file of its table.
fn summary(report: &TotalsReport, out: Option<&Path>) -> String {
    let samples = report.samples;
    let mut text = format!("{}, {}: {}\n", report.study, report.mechanism, sample_count(samples));
    for model in &report.outcomes {
        let _ = writeln!(text, "  {}: {}", model.name, outcome(model));
    }
    for (count, limits) in [
        (report.beyond_tilt_limit, "exceed the robot's tilt limit"),
        (report.beyond_rod_limits, "exceed a rod limit"),
        (report.beyond_joint_limits, "exceed a joint limit or clearance"),
    ] {
        if let Some(count) = count.filter(|&count| count > 0) {
            let _ = writeln!(text, "  {count} samples {limits}; they are included");
        }
    }
    let width = report.columns.iter().map(|column| column.name.len()).max().unwrap_or_default();
    let heads = ["minimum", "5 %", "median", "95 %", "maximum", "mean", "std. dev."];
    let heads: String = heads.iter().map(|head| format!("{head:>14}")).collect();
    let _ = writeln!(text, "  {:width$}{heads}", "");
    for column in &report.columns {
        let cells: String = cells(column).iter().map(|cell| format!("{cell:>14}")).collect();
        let _ = writeln!(text, "  {:width$}{cells}", column.name);
    }
    if report.percentiles_from < samples {
        let _ = writeln!(
            text,
            "  percentiles are estimated from {} samples, drawn uniformly from the study (standard error of each rank at most {:.1} %)",
            report.percentiles_from,
            50.0 / (report.percentiles_from as f64).sqrt()
        );
    }
    if let Some(out) = out {
        let _ = writeln!(text, "{} written", out.display());
    }
    text
}

fn outcome(model: &OutcomeReport) -> String {
    let all = model.solved + model.failed;
    if model.failed == 0 {
        return match all {
            1 => "the sample is solved".to_owned(),
            all => format!("all {all} samples are solved"),
        };
    }
    let reasons: Vec<String> =
        model.reasons.iter().map(|(why, count)| format!("{count} {why}")).collect();
    format!("{} of {all} samples are not solved: {}", model.failed, reasons.join(", "))
}

fn cells(column: &ColumnReport) -> [String; 7] {
    [
        column.min,
        column.percentile(5),
        column.percentile(50),
        column.percentile(95),
        column.max,
        column.mean.map(|mean| without_round_off(mean, column)),
        column.standard_deviation,
    ]
    .map(|value| value.map_or("-".to_owned(), number))
}

/// Largest mean of a column that is shown as zero, as a share of its values: sums of that many numbers differ by it.
const ROUND_OFF: f64 = 1e-12;

/// The mean of a column, zero where values of both signs cancel up to their round-off.
fn without_round_off(mean: f64, column: &ColumnReport) -> f64 {
    let largest =
        column.min.into_iter().chain(column.max).fold(0.0, |most: f64, end| most.max(end.abs()));
    if mean.abs() <= ROUND_OFF * largest { 0.0 } else { mean }
}

/// A number with seven significant digits.
fn number(value: f64) -> String {
    let size = value.abs();
    if !value.is_finite() {
        "-".to_owned()
    } else if size == 0.0 {
        "0".to_owned()
    } else if (1e-3..1e6).contains(&size) {
        let whole = size.log10().floor().max(0.0) as usize;
        fixed(value, 6 - whole.min(6))
    } else {
        format!("{value:.4e}")
    }
}

/// Largest number of runs of missing parts that are listed in text; JSON lists all.
const MOST_RUNS: usize = 12;

/// A number of finished parts, such as `3 parts of the share 0/2 are finished`.
pub(super) fn finished(parts: u64, of: &str) -> String {
    if parts == 1 {
        format!("1 part{of} is finished")
    } else {
        format!("{parts} parts{of} are finished")
    }
}

/// Progress of a study in parts.
pub(super) fn status(report: &StatusReport) -> String {
    let StatusReport { study, parts, done, missing, missing_ranges, .. } = report;
    let mut text = format!("{study}: {done} of {}\n", finished(*parts, ""));
    if *missing > 0 {
        let runs = missing_ranges.iter().take(MOST_RUNS);
        let run = |[first, last]: &[u64; 2]| match first == last {
            true => first.to_string(),
            false => format!("{first} to {last}"),
        };
        let mut listed: Vec<String> = runs.map(run).collect();
        if missing_ranges.len() > MOST_RUNS {
            listed.push("… (--format json lists all)".to_owned());
        }
        let _ = writeln!(text, "  missing  {missing}: {}", listed.join(", "));
    }
    text
}

/// Prints the expected size and duration of a study, as text or as JSON.
pub(super) fn dry_run(
    file: &StudyFile,
    out: &Path,
    estimate: &Estimate,
    json: bool,
) -> Result<(), Failure> {
    let columns: Vec<&str> = file.columns.iter().map(|column| column.name.as_str()).collect();
    if json {
        return output::json(&serde_json::json!({
            "study": file.name,
            "table": out.display().to_string(),
            "samples": estimate.samples,
            "columns": columns,
            "expected_bytes": estimate.bytes.round(),
            "expected_seconds": estimate.time,
        }));
    }
    let mut text = format!("{}: {}, nothing computed\n", file.name, sample_count(estimate.samples));
    let _ = writeln!(text, "  table    {}, about {}", out.display(), size(estimate.bytes));
    let _ = writeln!(text, "  time     about {}", time(estimate.time));
    let _ = writeln!(text, "  columns  {}: {}", columns.len(), columns.join(", "));
    output::text(&text)
}

fn sample_count(count: u64) -> String {
    if count == 1 { "1 sample".to_owned() } else { format!("{count} samples") }
}

/// A file size with its unit.
pub(super) fn size(bytes: f64) -> String {
    let text = output::short(bytes);
    if text.contains(' ') { text + "B" } else { text + " B" }
}

/// A duration with its unit.
fn time(seconds: f64) -> String {
    const YEAR: f64 = 365.25 * 86_400.0;
    for (unit, name) in [(YEAR, "years"), (86_400.0, "days"), (3600.0, "h"), (60.0, "min")] {
        if seconds >= unit {
            return format!("{:.1} {name}", seconds / unit);
        }
    }
    format!("{seconds:.2} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_finished_part_is_singular() {
        assert_eq!(finished(1, ""), "1 part is finished");
        assert_eq!(finished(0, " of the share 1/2"), "0 parts of the share 1/2 are finished");
    }
}
