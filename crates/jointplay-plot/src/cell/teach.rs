//! Pictures of taught stations: their tilt, and the distances of taught points from the plane.

use jointplay_cell::station::teach::{FitResult, PlaneFit};
use jointplay_cell::station::{Origin, Station};
use jointplay_cell::workcell::Cell;
use nalgebra::{Rotation3, Unit, Vector3};

use crate::svg::{Anchor, INK, RIM, Svg, path_data, px};
use crate::text::{HALF_CAPITAL, LEADING, TICK, TITLE, width, wrap};
use crate::{Colour, Error, png};

/// Margin around the picture and between stations (px).
const MARGIN: f64 = 24.0;
/// Height of the description of a station (px).
const WORDS: f64 = 3.0 * ROW + 10.0;
/// Height of a line of the description (px).
const ROW: f64 = 18.0;
/// Height of a station's drawing, as a share of its width.
const HIGH: f64 = 0.5;
/// Rotation of the base to the right, and elevation of the viewer (rad).
const TURN: f64 = 0.5;
const ELEVATION: f64 = 0.42;
/// Drawn tilt of the steepest station (rad).
const DRAWN_TILT: f64 = 0.2;
/// Drawn distance of the worst point from its plane, in radii of the disc.
const DRAWN_DISTANCE: f64 = 0.3;
/// Tilts below this are round-off and are not exaggerated (rad).
const LEAST_TILT: f64 = 1e-8;
/// Distances below this are round-off and are not exaggerated (m).
const LEAST_DISTANCE: f64 = 1e-9;
/// Length of the axes (px).
const AXES: f64 = 26.0;
/// Corners of a circle.
const CORNERS: u32 = 72;

const LEVEL: &str = " stroke=\"#8c8c8c\" stroke-width=\"1\" stroke-dasharray=\"4 3\"";
const PLANE: &str =
    " fill=\"#0072b2\" fill-opacity=\"0.1\" stroke=\"#0072b2\" stroke-width=\"1.6\"";

/// Stations side by side: the plane of each over a level disc, with exaggerated tilt; taught points with exaggerated distances from the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Taught<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Its stations to be drawn, by index.
    pub stations: Vec<usize>,
    /// Title above the picture; empty for none.
    pub title: String,
    /// Width in pixels.
    pub width: f64,
}

/// Scale factors of the picture.
#[derive(Clone, Copy)]
struct Exaggeration {
    /// Factor of the tilts.
    tilt: f64,
    /// Factor of the distances from the planes.
    distance: f64,
}

/// The position of a station's disc on the page.
struct Frame {
    middle: (f64, f64),
    scale: f64,
    /// Half of the width available for labels (px).
    half: f64,
}

impl Frame {
    /// A vector from the middle of the disc (m).
    fn project(&self, v: &Vector3<f64>) -> (f64, f64) {
        let (right, away) =
            (v.x * TURN.cos() + v.y * TURN.sin(), v.y * TURN.cos() - v.x * TURN.sin());
        let up = v.z * ELEVATION.cos() + away * ELEVATION.sin();
        (self.middle.0 + self.scale * right, self.middle.1 - self.scale * up)
    }
}

impl<'a> Taught<'a> {
    /// All stations of a cell, titled by its name, 900 px wide.
    #[must_use]
    pub fn new(cell: &'a Cell) -> Self {
        let stations = (0..cell.stations.len()).collect();
        Self { cell, stations, title: format!("{}: stations", cell.name), width: 900.0 }
    }

    /// The picture as SVG with real text, on white.
    ///
    /// # Errors
    /// [`Error::Size`] if the width is out of bounds; [`Error::Extent`] if a station's points are beyond the range of numbers.
    pub fn to_svg(&self) -> Result<String, Error> {
        crate::check::width(self.width)?;
        let shown: Vec<&Station> =
            self.stations.iter().filter_map(|&k| self.cell.stations.get(k)).collect();
        let columns = shown.len().clamp(1, 2);
        #[expect(clippy::cast_precision_loss, reason = "one or two")]
        let count = columns as f64;
        let wide = (self.width - (count + 1.0) * MARGIN) / count;
        let high = HIGH * wide.min(0.5 * self.width) + WORDS;
        let title = wrap(&self.title, TITLE, self.width - 2.0 * MARGIN);
        #[expect(clippy::cast_precision_loss, reason = "counts of lines")]
        let (top, rows) =
            (26.0 + title.len() as f64 * TITLE * LEADING, shown.len().div_ceil(columns) as f64);
        let exaggeration = exaggeration(&shown);
        let bottom = top + rows * (high + MARGIN);
        let about = if self.title.is_empty() { "stations" } else { &self.title };
        let mut svg = Svg::new(self.width, bottom + ROW + MARGIN, about);
        #[expect(clippy::cast_precision_loss, reason = "a count of lines")]
        for (line, text) in title.iter().enumerate() {
            let at = (0.5 * self.width, 26.0 + line as f64 * TITLE * LEADING);
            svg.text(at, TITLE, Anchor::Middle, text, "");
        }
        #[expect(clippy::cast_precision_loss, reason = "a count of stations")]
        for (k, station) in shown.iter().enumerate() {
            let left = MARGIN + (k % columns) as f64 * (wide + MARGIN);
            let above = top + (k / columns) as f64 * (high + MARGIN);
            self.station(&mut svg, station, exaggeration, [left, above, wide, high])?;
        }
        let mut notes = vec!["dashed: level".to_owned()];
        if exaggeration.tilt > 1.0 {
            notes.push(format!("tilt scale {}×", about_by(exaggeration.tilt)));
        }
        if exaggeration.distance > 1.0 {
            notes.push(format!("distance scale {}×", about_by(exaggeration.distance)));
        }
        axes(&mut svg, (MARGIN, bottom + 0.5 * ROW));
        let at = (0.5 * self.width, bottom + 0.5 * ROW);
        svg.text(at, TICK, Anchor::Middle, &notes.join("; "), "");
        Ok(svg.finish())
    }

    /// The SVG painted as PNG, `width_px` pixels wide, with the embedded DejaVu Sans.
    ///
    /// # Errors
    /// As [`Self::to_svg`]; [`Error::Size`] if `width_px` is 0 or over 20 000; [`Error::Paint`] if painting fails.
    pub fn to_png(&self, width_px: u32) -> Result<Vec<u8>, Error> {
        png::svg_to_png(&self.to_svg()?, width_px)
    }

    fn station(
        &self,
        svg: &mut Svg,
        station: &Station,
        exaggeration: Exaggeration,
        [left, top, wide, high]: [f64; 4],
    ) -> Result<(), Error> {
        let normal = station.base_from_station.rotation * Vector3::z();
        let fit = fit(station);
        // The disc has the diameter of the wafer, or extends to the farthest point.
        let farthest = places(fit).map(|place| place.xy().norm()).fold(0.0, f64::max);
        let radius = (0.5 * self.cell.wafer.diameter).max(farthest);
        if !(radius.is_normal() && radius < 1e6) {
            let what = format!("the station {:?}", station.name);
            return Err(Error::Extent { what, found: radius, unit: "m" });
        }
        let drawn = high - WORDS;
        let up = ELEVATION.cos() * (DRAWN_TILT + DRAWN_DISTANCE) + ELEVATION.sin();
        let scale = (0.46 * wide / radius).min(0.5 * drawn / (radius * up));
        let middle = (left + 0.5 * wide, top + WORDS + 0.5 * drawn);
        let frame = Frame { middle, scale, half: 0.5 * (wide + MARGIN) };
        let turn = tilted(&normal, exaggeration.tilt);
        let disc = |turn: &Rotation3<f64>| {
            let corner = |k: u32| {
                let angle = f64::from(k) / f64::from(CORNERS) * std::f64::consts::TAU;
                frame.project(&(turn * Vector3::new(angle.cos(), angle.sin(), 0.0) * radius))
            };
            path_data(&(0..CORNERS).map(corner).collect::<Vec<_>>()) + "z"
        };
        svg.path(&disc(&Rotation3::identity()), LEVEL);
        svg.path(&disc(&turn), PLANE);
        let stem = [Vector3::zeros(), turn * Vector3::z() * (0.35 * radius)];
        let stem = stem.map(|end| frame.project(&end));
        svg.path(&path_data(&stem), " stroke=\"#0072b2\" stroke-width=\"1.6\"");
        svg.path(&dot(stem[1], 2.4), " fill=\"#0072b2\"");
        if let Some(fit) = fit {
            points(svg, &frame, fit, &turn, exaggeration.distance);
        }
        let mut y = top + HALF_CAPITAL * TICK + 0.5 * ROW;
        for (k, line) in description(self.cell, station, &normal).into_iter().enumerate() {
            let size = if k == 0 { TITLE } else { TICK };
            for part in wrap(&line, size, wide) {
                svg.text((left, y), size, Anchor::Start, &part, "");
                y += ROW;
            }
        }
        Ok(())
    }
}

/// Taught points with their distances from the plane, numbered in the order of teaching.
fn points(svg: &mut Svg, frame: &Frame, fit: &PlaneFit, turn: &Rotation3<f64>, off: f64) {
    let normal = turn * Vector3::z();
    let stems: Vec<[(f64, f64); 2]> = places(Some(fit))
        .zip(&fit.distances)
        .map(|(place, distance)| {
            let foot = turn * Vector3::new(place.x, place.y, 0.0);
            [frame.project(&foot), frame.project(&(foot + normal * (off * distance)))]
        })
        .collect();
    for (&[from, to], distance) in stems.iter().zip(&fit.distances) {
        let beyond = distance.abs() > fit.agreement.threshold;
        let colour = if beyond { Colour::VERMILLION } else { Colour::GREEN }.hex();
        let look = format!(" stroke=\"{colour}\" stroke-width=\"1.6\"");
        svg.path(&path_data(&[from, to]), &look);
        svg.path(&dot(from, 1.6), &format!(" fill=\"{INK}\""));
        svg.path(&dot(to, 4.0), &format!(" fill=\"{colour}\""));
    }
    // Labels avoid the points and labels of others as far as possible.
    let mut taken: Vec<Box2> = stems.iter().map(|&[from, to]| Box2::around(from, to)).collect();
    for (k, (&[_, to], distance)) in stems.iter().zip(&fit.distances).enumerate() {
        let tenths = (distance * 1e7).round();
        // Without a sign where it rounds to zero.
        let shown = if tenths == 0.0 { "0.0".to_owned() } else { format!("{:+.1}", tenths / 10.0) };
        let text = format!("{}: {shown} µm", k + 1);
        let (half, high) = (0.5 * width(&text, TICK), 0.5 * TICK);
        let (sideways, over) = (half + 9.0, high + 9.0);
        let outward = if to.0 < frame.middle.0 { -1.0 } else { 1.0 };
        let upward = if *distance < 0.0 { 1.0 } else { -1.0 };
        let candidates = [
            (outward * sideways, 0.0),
            (0.0, upward * over),
            (-outward * sideways, 0.0),
            (outward * sideways, upward * over),
            (0.0, -upward * over),
            (0.0, 2.0 * upward * over),
        ];
        let label = candidates.map(|(x, y)| {
            let room = (frame.half - half).max(0.0);
            let x = (to.0 + x).clamp(frame.middle.0 - room, frame.middle.0 + room);
            Box2 { middle: (x, to.1 + y), half: (half, high) }
        });
        let overlaps = |label: &Box2| {
            let others = taken.iter().enumerate().filter(|(other, _)| *other != k);
            others.map(|(_, other)| label.overlap(other)).sum::<f64>()
        };
        let best = label.iter().min_by(|a, b| overlaps(a).total_cmp(&overlaps(b)));
        let Some(&best) = best else { continue };
        let (x, y) = best.middle;
        svg.text((x, y + HALF_CAPITAL * TICK), TICK, Anchor::Middle, &text, RIM);
        taken.push(best);
    }
}

/// A box on the page (px).
#[derive(Clone, Copy)]
struct Box2 {
    middle: (f64, f64),
    half: (f64, f64),
}

impl Box2 {
    /// Around a stem with its head.
    fn around(from: (f64, f64), to: (f64, f64)) -> Self {
        let middle = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        let half = (0.5 * (from.0 - to.0).abs() + 4.0, 0.5 * (from.1 - to.1).abs() + 4.0);
        Self { middle, half }
    }

    /// Area that it has in common with another (px²).
    fn overlap(&self, other: &Self) -> f64 {
        let x = self.half.0 + other.half.0 - (self.middle.0 - other.middle.0).abs();
        let y = self.half.1 + other.half.1 - (self.middle.1 - other.middle.1).abs();
        x.max(0.0) * y.max(0.0)
    }
}

/// Taught points relative to their centre (m).
fn places(fit: Option<&PlaneFit>) -> impl Iterator<Item = Vector3<f64>> {
    fit.into_iter().flat_map(|fit| fit.points.iter().map(|point| point - fit.center))
}

fn fit(station: &Station) -> Option<&PlaneFit> {
    match &station.origin {
        Origin::Taught(taught) => taught.plane.as_ref(),
        _ => None,
    }
}

/// The description of a station, line by line.
fn description(cell: &Cell, station: &Station, normal: &Vector3<f64>) -> Vec<String> {
    let tilt = normal.xy().norm().atan2(normal.z);
    let toward = normal.y.atan2(normal.x).to_degrees();
    let orientation = if tilt > LEAST_TILT {
        format!("tilt {:.4}° toward {toward:.1}°", tilt.to_degrees())
    } else {
        "level".to_owned()
    };
    let mut lines = vec![station.name.clone(), orientation];
    match &station.origin {
        Origin::Nominal => lines.push("nominal, not taught".to_owned()),
        Origin::CarrierAxis(carrier_axis) => lines.push(format!(
            "carrier axis: the last slot is {:.3} mm off the vertical",
            carrier_axis.horizontal_offset * 1e3
        )),
        Origin::Taught(taught) => {
            if let Some(references) = &taught.references {
                lines.push(format!(
                    "{} references, deviations up to {:.1} µm (allowed {:.1})",
                    references.references.len(),
                    references.agreement.worst * 1e6,
                    references.agreement.threshold * 1e6
                ));
            }
            let Some(fit) = &taught.plane else { return lines };
            let result = match fit.result_for(cell.plane_threshold, cell.coverage_factor) {
                FitResult::Fits => "fits",
                FitResult::Untested => "untested",
                FitResult::Uncertain => "uncertain",
                FitResult::Inconsistent => "inconsistent",
            };
            let known = fit.uncertainty.as_ref().map_or_else(
                || "tilt uncertainty unknown".to_owned(),
                |known| format!("tilt ±{:.0} µrad", known.tilt_95 * 1e6),
            );
            lines.push(format!(
                "{} points, distances up to {:.1} µm (allowed {:.1}), {known}: {result}",
                fit.distances.len(),
                fit.agreement.worst * 1e6,
                fit.agreement.threshold * 1e6
            ));
        }
    }
    lines
}

/// Factors that make the steepest tilt and the worst point visible.
fn exaggeration(stations: &[&Station]) -> Exaggeration {
    let tilt = |station: &&Station| {
        let normal = station.base_from_station.rotation * Vector3::z();
        normal.xy().norm().atan2(normal.z)
    };
    let steepest = stations.iter().map(tilt).fold(0.0, f64::max);
    let fits = || stations.iter().filter_map(|station| fit(station));
    let worst = fits().map(|fit| fit.agreement.worst).fold(0.0, f64::max);
    let narrowest = fits()
        .map(|fit| places(Some(fit)).map(|place| place.xy().norm()).fold(0.0, f64::max))
        .fold(f64::INFINITY, f64::min);
    Exaggeration {
        tilt: if steepest > LEAST_TILT { (DRAWN_TILT / steepest).max(1.0) } else { 1.0 },
        distance: if worst > LEAST_DISTANCE {
            (DRAWN_DISTANCE * narrowest / worst).max(1.0)
        } else {
            1.0
        },
    }
}

/// The rotation that multiplies the tilt of a normal by a factor.
fn tilted(normal: &Vector3<f64>, factor: f64) -> Rotation3<f64> {
    let tilt = normal.xy().norm().atan2(normal.z);
    match Unit::try_new(Vector3::new(-normal.y, normal.x, 0.0), f64::MIN_POSITIVE) {
        Some(axis) => Rotation3::from_axis_angle(&axis, factor * tilt),
        None => Rotation3::identity(),
    }
}

/// A factor to two digits.
fn about_by(factor: f64) -> String {
    let step = 10_f64.powf(factor.log10().floor() - 1.0);
    let rounded = (factor / step).round() * step;
    if rounded < 10.0 { format!("{rounded:.1}") } else { format!("{rounded:.0}") }
}

/// The axes of the base frame in the view of the picture.
fn axes(svg: &mut Svg, middle: (f64, f64)) {
    let frame = Frame { middle, scale: AXES, half: AXES };
    for (name, axis) in [("x", Vector3::x()), ("y", Vector3::y()), ("z", Vector3::z())] {
        let ends = [frame.project(&Vector3::zeros()), frame.project(&axis)];
        svg.path(&path_data(&ends), &format!(" stroke=\"{INK}\" stroke-width=\"1.4\""));
        let (x, y) = frame.project(&(axis * 1.35));
        svg.text((x, y + HALF_CAPITAL * TICK), TICK, Anchor::Middle, name, "");
    }
}

fn dot((x, y): (f64, f64), radius: f64) -> String {
    let (r, d) = (px(radius), px(2.0 * radius));
    format!("M{} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z", px(x - radius), px(y))
}
