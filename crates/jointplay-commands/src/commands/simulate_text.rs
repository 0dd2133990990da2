//! A study in a short table, one column a virtualization.

use std::fmt::Write as _;

use jointplay::report::StudyReport;

use jointplay::format::number::fixed;

/// Terms of the table, in one line each.
const NOTES: &str = "  X: virtual joint coordinates; singular pass: a sample at zero tilt, where the rods are equally long
  within estimates: tilted poses whose displacement |ΔX| is within the first-order estimates of the sensitivity,
    with the Jacobian at the midpoint of the motion from level or at the tilted pose (there it need not be)
";

/// The file that explains the others of a study's folder.
pub(super) const READ_ME: &str = include_str!("simulate_folder.md");

type Row<'a> = (&'a str, &'a dyn Fn(&StudyReport) -> String);

/// The table, under a heading.
pub(super) fn table(heading: &str, studies: &[&StudyReport]) -> String {
    let rows: &[Row<'_>] = &[
        ("solver", &|s| s.solver.clone()),
        ("iterations, most", &|s| s.most_iterations.to_string()),
        ("side residual, largest (mm)", &|s| format!("{:.1e}", s.largest_residual_mm)),
        ("linear X at singular passes", &|s| at_passes(s, "_mm")),
        ("linear X, least (mm)", &|s| least(s, "_mm", 6)),
        ("linear X, greatest (mm)", &|s| greatest(s, "_mm", 6)),
        ("angular X at singular passes", &|s| at_passes(s, "_deg")),
        ("angular X, least (deg)", &|s| least(s, "_deg", 6)),
        ("angular X, greatest (deg)", &|s| greatest(s, "_deg", 6)),
        ("centre shift, largest (µm)", &|s| fixed(s.largest_center_shift_um, 3)),
        ("torsion, largest (deg)", &|s| format!("{:.1e}", s.largest_torsion_deg)),
        ("within estimates, midpoint", &|s| within(s.bounds.held_at_midpoint, s.bounds.poses)),
        ("within estimates, tilted pose", &|s| within(s.bounds.held_at_end, s.bounds.poses)),
    ];
    let mut text = format!("{heading}\n");
    let mut line = |name: &str, cells: &mut dyn Iterator<Item = String>| {
        let cells: String = cells.map(|cell| format!("{cell:>16}")).collect();
        let _ = writeln!(text, "  {name:<30}{cells}");
    };
    line("", &mut studies.iter().map(|study| study.virtualization.clone()));
    for (name, cell) in rows {
        line(name, &mut studies.iter().map(|study| cell(study)));
    }
    text.push_str(NOTES);
    if let Some(study) = studies.first() {
        if let Some(sides) = study.series.iter().find(|series| series.name == "L12_mm") {
            let passes = sides.at_singular_passes;
            let at =
                passes.map_or("none".to_owned(), |[value, _]| format!("{} mm", fixed(value, 6)));
            let _ =
                writeln!(text, "  {} singular passes, side L12 there: {at}", study.singular_passes);
        }
        if study.samples_beyond_tilt_limit > 0 {
            let _ = writeln!(
                text,
                "  {} poses tilt beyond the robot's limit of ±{}°: on purpose, as in the paper",
                study.samples_beyond_tilt_limit, study.tilt_limit_deg
            );
        }
        if study.samples_beyond_stroke > 0 {
            let _ = writeln!(
                text,
                "  {} poses have rods beyond the robot's stroke",
                study.samples_beyond_stroke
            );
        }
    }
    text
}

fn within(satisfied: usize, poses: usize) -> String {
    format!("{satisfied} of {poses}")
}

/// Values of the virtual joints of one unit at the singular passes, if all are the same.
fn at_passes(study: &StudyReport, unit: &str) -> String {
    let values: Vec<f64> = virtual_joints(study, unit)
        .filter_map(|series| series.at_singular_passes)
        .flatten()
        .collect();
    match values.split_first() {
        None => "-".to_owned(),
        Some((first, rest)) if rest.iter().all(|value| value == first) => format!("{first}"),
        // A closed form meets the nominal place to round-off only.
        Some((first, rest)) if rest.iter().all(|value| (value - first).abs() < 1e-9) => {
            fixed(*first, 6)
        }
        Some(_) => "differ".to_owned(),
    }
}

fn least(study: &StudyReport, unit: &str, decimals: usize) -> String {
    let least = virtual_joints(study, unit).map(|series| series.min).min_by(f64::total_cmp);
    least.map_or("-".to_owned(), |value| fixed(value, decimals))
}

fn greatest(study: &StudyReport, unit: &str, decimals: usize) -> String {
    let greatest = virtual_joints(study, unit).map(|series| series.max).max_by(f64::total_cmp);
    greatest.map_or("-".to_owned(), |value| fixed(value, decimals))
}

/// Series of the virtual joints: all but rods and sides.
fn virtual_joints<'a>(
    study: &'a StudyReport,
    unit: &'a str,
) -> impl Iterator<Item = &'a jointplay::report::SeriesReport> {
    let rod_or_side = |name: &str| name.starts_with('q') || name.starts_with('L');
    study
        .series
        .iter()
        .filter(move |series| series.name.ends_with(unit) && !rod_or_side(&series.name))
}
