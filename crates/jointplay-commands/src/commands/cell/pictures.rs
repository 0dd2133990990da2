//! Pictures of a cell and of its trajectory.

use jointplay::interop::export::{timing_diagram, top_view};

use super::input::Planned;
use crate::failure::Failure;
use crate::figure::svg_and_png;

/// Names of the four pictures.
pub(super) const PICTURES: [&str; 4] = ["top.svg", "top.png", "gantt.svg", "gantt.png"];

/// The top view and the timing diagram, as SVG and PNG.
pub(super) fn pictures(planned: &Planned) -> Result<[(String, Vec<u8>); 4], Failure> {
    let (motion_export, report) = (planned.motion_export(), &planned.report);
    let [top_svg, top_png] = svg_and_png("top", &top_view(&motion_export, report)?)?;
    let [gantt_svg, gantt_png] = svg_and_png("gantt", &timing_diagram(&motion_export, report))?;
    Ok([top_svg, top_png, gantt_svg, gantt_png])
}
