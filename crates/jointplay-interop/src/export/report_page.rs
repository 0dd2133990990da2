//! The report on a program as one page of HTML.

use jointplay_cell::check::Report;
use jointplay_format::number::fixed;
use jointplay_plot::cell::{Gantt, TopView};
use jointplay_report::{CellPage, CellReport, PagePicture, PageProgram};

use super::motion_export::MotionExport;
use super::pictures::{PictureError, postures_view, taught_planes, timing_diagram, top_view};

/// Duration of a part of the timing diagram (s), number of its bands, and largest number of parts: a part fits on a printed page.
const PART: f64 = 240.0;
const BANDS: u32 = 4;
const MAX_PARTS: f64 = 6.0;

/// The page of a report: cell, schedule, margins, accuracy, violations and assumptions of a program.
///
/// # Arguments
/// * `report` – the check of the motion
/// * `program` – name, text and report document of the program
/// * `before` – those of a program before a change, which is compared by its key figures
///
/// # Errors
/// [`PictureError`]
pub fn report_page(
    motion_export: &MotionExport<'_>,
    report: &Report,
    program: PageProgram<'_>,
    before: Option<PageProgram<'_>>,
) -> Result<String, PictureError> {
    let drawing =
        |picture| move |source: jointplay_plot::Error| PictureError::Drawing { picture, source };
    let picture = |caption: &str, svg: String| PagePicture { caption: caption.to_owned(), svg };
    let from_above = TopView { title: String::new(), ..top_view(motion_export, report)? };
    let cell = vec![
        picture(
            "From above: stations with their entries, bodies, zones, reach of the arms and paths of the wafer centres.",
            from_above.to_svg().map_err(drawing("top"))?,
        ),
        picture(
            "The arms at the first hand-off at each station.",
            postures_view(motion_export)?.to_svg().map_err(drawing("arms"))?,
        ),
    ];
    let whole = Gantt { title: String::new(), ..timing_diagram(motion_export, report) };
    let part = |window: [f64; 2], max_bands: u32| {
        let part = Gantt { window, max_bands, ..whole.clone() };
        part.to_svg().map_err(drawing("gantt"))
    };
    let mut timing = Vec::new();
    if let Some(window) = middle_periods(program.report) {
        let caption = "Two periods in the middle of the longest periodic part.";
        timing.push(picture(caption, part(window, 1)?));
    }
    let duration = motion_export.motion.duration();
    let parts = (duration / PART).ceil().clamp(1.0, MAX_PARTS);
    for index in (0..MAX_PARTS as u32).map(f64::from).take_while(|&index| index < parts) {
        let [from, to] = [index / parts * duration, (index + 1.0) / parts * duration];
        let caption = format!("From {} to {} s.", fixed(from, 0), fixed(to, 0));
        timing.push(picture(&caption, part([from, to], BANDS)?));
    }
    let stations = match taught_planes(motion_export.cell) {
        None => None,
        Some(planes) => Some(picture(
            "Planes of the taught stations, with exaggerated tilt and distances.",
            planes.to_svg().map_err(drawing("stations"))?,
        )),
    };
    let version = env!("CARGO_PKG_VERSION");
    Ok(CellPage { program, before, cell, timing, stations, version }.to_html())
}

/// Two periods in the middle of the longest periodic part, where neither its start nor its end matter (s).
fn middle_periods(document: &CellReport) -> Option<[f64; 2]> {
    let parts = document.schedule.periodic_parts.iter();
    let part = parts.max_by(|a, b| (a.end_s - a.start_s).total_cmp(&(b.end_s - b.start_s)))?;
    let periods = 2.0 * part.period_s;
    let start = (0.5 * (part.start_s + part.end_s - periods)).max(part.start_s);
    Some([start, (start + periods).min(part.end_s)])
}
