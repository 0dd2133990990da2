//! Cells of a few stations around a robot of the catalogue.

use std::fmt::Write;

use jointplay_cell::workcell::Cell;
use jointplay_format::cell;

/// Place of a station, and the line into it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StationPlace {
    pub(crate) azimuth_deg: f64,
    pub(crate) distance_mm: f64,
    pub(crate) retract_mm: f64,
    /// Direction of the line into the station from the radial one (°); `None` for the radial line of any heading.
    pub(crate) oblique_deg: Option<f64>,
}

/// A cell with stations of which the first ones hold wafers.
pub(crate) fn small_cell(robot: &str, stations: &[StationPlace], holding: usize) -> Cell {
    let mut text = format!(
        "kind = \"cell\"\nname = \"stations of a test\"\nrobot = \"{robot}\"\n{}",
        include_str!("wafer_and_budgets.toml")
    );
    for (index, at) in stations.iter().enumerate() {
        let (sin, cos) = at.azimuth_deg.to_radians().sin_cos();
        write!(
            text,
            r#"
[[station]]
name = "S{index}"
slots = 25
pitch_mm = 10.0
position_mm = [{}, {}, 520.0]
heading_deg = {}
stroke = {{ below_mm = 4.0, above_mm = 3.0, speed_mm_s = 20.0 }}
retract_mm = {}
approach = "{}"
{}
"#,
            at.distance_mm * cos,
            at.distance_mm * sin,
            at.azimuth_deg - 90.0 + at.oblique_deg.unwrap_or(0.0),
            at.retract_mm,
            if at.oblique_deg.is_some() { "line" } else { "radial" },
            if index < holding { "wafers = \"all\"" } else { "" },
        )
        .unwrap();
    }
    cell::read(&text, &mut |_| Err("no files".to_owned())).unwrap()
}
