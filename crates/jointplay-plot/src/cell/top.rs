//! The top view of a cell.

use jointplay_cell::EntityId;
use jointplay_cell::robot::EffectorId;
use jointplay_cell::workcell::{Cell, ParentFrame, ZoneRule};

use super::effector_colour;
use super::outline::outline;
use super::posture::ArmPosture;
use super::station_label::{Circle, Obstacles, place};
use crate::path::Rectangle;
use crate::scale_bar::scale_bar;
use crate::svg::{Anchor, INK, RIM, Svg, element, path_data, px};
use crate::text::{HALF_CAPITAL, LEADING, TICK, TITLE, width, wrap};
use crate::{Colour, Error, png};

/// Margin around the cell, for labels (px).
const MARGIN: f64 = 40.0;
/// Height of a line of the legend (px).
const ROW: f64 = 20.0;
/// Height of the axes and the scale (px).
const FOOT: f64 = 56.0;
/// Largest height of the cell, as a share of the page width.
const HIGH: f64 = 1.0;
/// Length of the axes (px).
const AXES: f64 = 26.0;

const FORBIDDEN: &str = " fill=\"#d55e00\" fill-opacity=\"0.12\" stroke=\"#d55e00\" stroke-width=\"1.2\" stroke-dasharray=\"6 3\"";
const ALLOWED: &str = " fill=\"#009e73\" fill-opacity=\"0.05\" stroke=\"#009e73\" stroke-width=\"1.2\" stroke-dasharray=\"6 3\"";
const BODY: &str = " fill=\"#d9d9d6\" stroke=\"#8c8c8c\" stroke-width=\"1\"";
const VIOLATING: &str =
    " fill=\"#d55e00\" fill-opacity=\"0.25\" stroke=\"#d55e00\" stroke-width=\"2\"";
const STATION: &str =
    " fill=\"#ffffff\" fill-opacity=\"0.8\" stroke=\"#222222\" stroke-width=\"1.4\"";
const ROBOT: &str = " fill=\"#ececec\" stroke=\"#5c5c5c\" stroke-width=\"1.2\"";

/// The reach of an effector and the path of its wafer centre.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectorPath {
    /// The effector.
    pub effector: EffectorId,
    /// Least and greatest distance of its wafer centre from the base axis (m).
    pub reach: [f64; 2],
    /// Path of its wafer centre in the base frame (m).
    pub points: Vec<[f64; 2]>,
}

/// The top view of a cell: robot, reach, stations, bodies, zones, and paths of wafer centres.
#[derive(Debug, Clone, PartialEq)]
pub struct TopView<'a> {
    /// The cell.
    pub cell: &'a Cell,
    /// Reaches and paths of its effectors.
    pub paths: Vec<EffectorPath>,
    /// Arms at some positions.
    pub postures: Vec<ArmPosture>,
    /// Positions of violations in the base frame (m).
    pub violations: Vec<[f64; 2]>,
    /// Bodies and zones involved in violations; only fixed ones are drawn.
    pub violating: Vec<EntityId>,
    /// Title above the picture; empty for none.
    pub title: String,
    /// Width in pixels.
    pub width: f64,
}

/// The projection from the base frame onto the page.
struct Camera {
    scale: f64,
    middle: (f64, f64),
}

impl Camera {
    fn project(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        (self.middle.0 + self.scale * x, self.middle.1 - self.scale * y)
    }
}

impl<'a> TopView<'a> {
    /// A picture titled by the cell's name, 720 px wide, of the cell alone.
    #[must_use]
    pub fn new(cell: &'a Cell) -> Self {
        let title = cell.name.clone();
        Self {
            cell,
            paths: Vec::new(),
            postures: Vec::new(),
            violations: Vec::new(),
            violating: Vec::new(),
            title,
            width: 720.0,
        }
    }

    /// The picture as SVG with real text, on white.
    ///
    /// # Errors
    /// [`Error::Size`] if the width is out of bounds; [`Error::Extent`] if the cell is beyond the range of numbers.
    pub fn to_svg(&self) -> Result<String, Error> {
        crate::check::width(self.width)?;
        let (low, high) = self.extent()?;
        let title = wrap(&self.title, TITLE, self.width - 2.0 * MARGIN);
        let legend = self.legend_rows();
        #[expect(clippy::cast_precision_loss, reason = "counts of lines")]
        let (top, key) = (12.0 + title.len() as f64 * TITLE * LEADING, legend.len() as f64 * ROW);
        let (across, up) = (high[0] - low[0], high[1] - low[1]);
        let scale = ((self.width - 2.0 * MARGIN) / across).min(HIGH * self.width / up);
        let bottom = top + 2.0 * MARGIN + scale * up;
        let camera = Camera {
            scale,
            middle: (
                0.5 * self.width - 0.5 * (low[0] + high[0]) * scale,
                0.5 * (top + bottom) + 0.5 * (low[1] + high[1]) * scale,
            ),
        };
        let about = if title.is_empty() { &self.cell.name } else { &self.title };
        let mut svg = Svg::new(self.width, bottom + FOOT + key, about);
        #[expect(clippy::cast_precision_loss, reason = "a count of lines")]
        for (line, text) in title.iter().enumerate() {
            let at = (0.5 * self.width, 26.0 + line as f64 * TITLE * LEADING);
            svg.text(at, TITLE, Anchor::Middle, text, "");
        }
        self.bodies(&mut svg, &camera);
        self.robot(&mut svg, &camera);
        self.zones(&mut svg, &camera);
        self.stations(&mut svg, &camera);
        self.arms(&mut svg, &camera);
        self.effector_paths(&mut svg, &camera);
        self.violating_bodies(&mut svg, &camera);
        let frame = Rectangle { x: 2.0, y: top, w: self.width - 4.0, h: bottom - top };
        self.station_labels(&mut svg, &camera, &frame);
        for &at in &self.violations {
            let (x, y) = camera.project(at);
            let data = format!("M{} {}l9 9m0 -9l-9 9", px(x - 4.5), px(y - 4.5));
            svg.path(
                &data,
                &format!(" stroke=\"{}\" stroke-width=\"2.4\"", Colour::VERMILLION.hex()),
            );
        }
        axes(&mut svg, (MARGIN, bottom + 34.0));
        scale_bar(&mut svg, 1.0 / scale, (self.width - MARGIN, bottom + 34.0), 0.2 * self.width);
        for (row, entries) in legend.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a count of lines")]
            let y = bottom + FOOT + (row as f64 + 0.3) * ROW;
            self.draw_legend(&mut svg, entries, y);
        }
        Ok(svg.finish())
    }

    /// The SVG painted as PNG, `width_px` pixels wide, with the embedded DejaVu Sans.
    ///
    /// # Errors
    /// As [`Self::to_svg`]; [`Error::Size`] if `width_px` is 0 or over 20 000; [`Error::Paint`] if painting fails.
    pub fn to_png(&self, width_px: u32) -> Result<Vec<u8>, Error> {
        png::svg_to_png(&self.to_svg()?, width_px)
    }

    /// Corners of the visible part of the base plane (m).
    fn extent(&self) -> Result<([f64; 2], [f64; 2]), Error> {
        let reach = self.paths.iter().map(|path| path.reach[1]).fold(self.platform(), f64::max);
        let mut points = vec![[-reach, -reach], [reach, reach]];
        let half = 0.5 * self.cell.wafer.diameter;
        for station in &self.cell.stations {
            let [x, y] = center(station.slot_frame(1).translation.vector);
            points.extend([[x - half, y - half], [x + half, y + half]]);
        }
        for body in self.cell.bodies.iter().filter(|body| body.parent == ParentFrame::World) {
            points.extend(outline(&body.shape, &body.parent_from_shape));
        }
        for zone in &self.cell.zones {
            points.extend(outline(&zone.shape, &zone.base_from_shape));
        }
        points.extend(self.paths.iter().flat_map(|path| path.points.iter().copied()));
        for posture in &self.postures {
            points.extend(posture.outlines(self.cell).into_iter().flatten());
            points.extend(posture.joints());
        }
        let (mut low, mut high) = ([f64::MAX; 2], [f64::MIN; 2]);
        for point in points {
            low = [low[0].min(point[0]), low[1].min(point[1])];
            high = [high[0].max(point[0]), high[1].max(point[1])];
        }
        let size = (high[0] - low[0]).min(high[1] - low[1]);
        if size.is_normal() && size < 1e6 {
            Ok((low, high))
        } else {
            Err(Error::Extent {
                what: format!("the cell {:?}", self.cell.name),
                found: size,
                unit: "m",
            })
        }
    }

    /// Radius of the platform (m).
    fn platform(&self) -> f64 {
        self.cell.robot.gpr.platform().mean_radius()
    }

    fn zones(&self, svg: &mut Svg, camera: &Camera) {
        for zone in &self.cell.zones {
            let look = match zone.rule {
                ZoneRule::KeepOut => FORBIDDEN,
                ZoneRule::Safe => ALLOWED,
            };
            svg.path(&polygon(camera, &outline(&zone.shape, &zone.base_from_shape)), look);
        }
    }

    fn bodies(&self, svg: &mut Svg, camera: &Camera) {
        for body in self.cell.bodies.iter().filter(|body| body.parent == ParentFrame::World) {
            svg.path(&polygon(camera, &outline(&body.shape, &body.parent_from_shape)), BODY);
        }
    }

    /// Names and outlines of bodies and zones involved in violations.
    fn outlines_in_violation(&self) -> impl Iterator<Item = (&str, Vec<[f64; 2]>)> {
        let bodies = self.cell.bodies.iter().enumerate().filter_map(|(k, body)| {
            let is_marked =
                body.parent == ParentFrame::World && self.violating.contains(&EntityId::Body(k));
            is_marked.then_some((&body.name, &body.shape, &body.parent_from_shape))
        });
        let zones = self.cell.zones.iter().enumerate().filter_map(|(k, zone)| {
            let is_marked = self.violating.contains(&EntityId::Zone(k));
            is_marked.then_some((&zone.name, &zone.shape, &zone.base_from_shape))
        });
        bodies.chain(zones).map(|(name, shape, pose)| (name.as_str(), outline(shape, pose)))
    }

    /// Bodies and zones involved in violations, with their names.
    fn violating_bodies(&self, svg: &mut Svg, camera: &Camera) {
        for (name, outline) in self.outlines_in_violation() {
            svg.path(&polygon(camera, &outline), VIOLATING);
            let mean = |k: usize| {
                #[expect(clippy::cast_precision_loss, reason = "a count of corners")]
                let count = outline.len() as f64;
                outline.iter().map(|corner| corner[k]).sum::<f64>() / count
            };
            let (x, y) = camera.project([mean(0), mean(1)]);
            let half = 0.5 * width(name, TICK);
            let x = x.clamp(half + 4.0, (self.width - half - 4.0).max(half + 4.0));
            svg.text((x, y + HALF_CAPITAL * TICK), TICK, Anchor::Middle, name, RIM);
        }
    }

    fn robot(&self, svg: &mut Svg, camera: &Camera) {
        svg.path(&circle(camera, [0.0; 2], self.platform()), ROBOT);
        for base in self.cell.robot.gpr.base_points() {
            let (x, y) = camera.project([base.x, base.y]);
            svg.path(&dot((x, y), 3.0), &format!(" fill=\"{INK}\""));
        }
    }

    /// Bodies of the arms, with lines through their joints, and the wafers that they carry.
    fn arms(&self, svg: &mut Svg, camera: &Camera) {
        for posture in &self.postures {
            let colour = effector_colour(self.effector_index(posture.effector)).hex();
            let look = format!(
                " fill=\"{colour}\" fill-opacity=\"0.12\" stroke=\"{colour}\" stroke-width=\"1.2\""
            );
            for outline in posture.outlines(self.cell) {
                svg.path(&polygon(camera, &outline), &look);
            }
            let joints: Vec<_> = posture.joints().iter().map(|&at| camera.project(at)).collect();
            svg.path(
                &path_data(&joints),
                &format!(" stroke=\"{colour}\" stroke-width=\"2.4\" stroke-linejoin=\"round\""),
            );
            for &joint in &joints[..joints.len() - 1] {
                svg.path(&dot(joint, 3.0), &format!(" fill=\"{colour}\""));
            }
            let radius = 0.5 * self.cell.wafer.diameter;
            svg.path(
                &circle(camera, posture.wafer_centre(), radius),
                &format!(" stroke=\"{colour}\" stroke-width=\"2\""),
            );
        }
    }

    /// Index of an effector among all of the robot, which determines its colour.
    fn effector_index(&self, effector: EffectorId) -> usize {
        self.cell.robot.effectors().position(|one| one == effector).unwrap_or(0)
    }

    fn effector_paths(&self, svg: &mut Svg, camera: &Camera) {
        for (k, path) in self.paths.iter().enumerate() {
            for reach in path.reach.into_iter().filter(|&reach| reach * camera.scale > 2.0) {
                svg.path(&circle(camera, [0.0; 2], reach), &self.reach_style(k));
            }
            // Points that coincide on the page are omitted.
            let mut line: Vec<(f64, f64)> = Vec::new();
            for at in path.points.iter().map(|&point| camera.project(point)) {
                if line.last().is_none_or(|last| (last.0 - at.0).hypot(last.1 - at.1) > 0.4) {
                    line.push(at);
                }
            }
            if line.len() > 1 {
                svg.path(&path_data(&line), &self.path_style(k));
            }
        }
    }

    /// Style of the path of an effector: the first is the widest, so that coincident paths remain visible.
    fn path_style(&self, k: usize) -> String {
        let colour = effector_colour(k).hex();
        #[expect(clippy::cast_precision_loss, reason = "a count of effectors")]
        let wide = 1.4 + 2.6 * (self.paths.len() - 1 - k).min(3) as f64;
        format!(" stroke=\"{colour}\" stroke-width=\"{wide}\" stroke-linejoin=\"round\"")
    }

    /// Style of the reach of an effector: its dashes fill the gaps of the others, so that equal reaches remain visible.
    fn reach_style(&self, k: usize) -> String {
        let colour = effector_colour(k).hex();
        #[expect(clippy::cast_precision_loss, reason = "a count of effectors")]
        let [count, place] = [self.paths.len().max(1) as f64, k as f64];
        let (gap, offset) = (7.0 * count - 4.0, -7.0 * place);
        format!(
            " stroke=\"{colour}\" stroke-width=\"1.2\" stroke-dasharray=\"4 {gap}\" stroke-dashoffset=\"{offset}\""
        )
    }

    /// Stations, as outlines of a wafer.
    fn stations(&self, svg: &mut Svg, camera: &Camera) {
        for station in &self.cell.stations {
            let place = center(station.slot_frame(1).translation.vector);
            svg.path(&circle(camera, place, 0.5 * self.cell.wafer.diameter), STATION);
        }
    }

    /// Labels of stations, and arrows in the direction of entry.
    fn station_labels(&self, svg: &mut Svg, camera: &Camera, frame: &Rectangle) {
        let radius = 0.5 * self.cell.wafer.diameter * camera.scale;
        let places = self.cell.stations.iter().map(|station| station.slot_frame(1));
        let outline = |frame: jointplay_core::spatial::Pose| Circle {
            center: camera.project(center(frame.translation.vector)),
            radius,
        };
        let reaches = self
            .paths
            .iter()
            .flat_map(|path| path.reach)
            .map(|reach| Circle { center: camera.project([0.0; 2]), radius: reach * camera.scale });
        let paths = self
            .paths
            .iter()
            .map(|path| path.points.iter().map(|&point| camera.project(point)).collect::<Vec<_>>());
        let mut obstacles = Obstacles {
            circles: places.map(outline).chain(reaches).collect(),
            paths: paths.collect(),
            labels: Vec::new(),
        };
        for station in &self.cell.stations {
            let slot = station.slot_frame(1);
            let inward = slot.rotation * nalgebra::Vector3::y();
            let (x, y) = camera.project(center(slot.translation.vector));
            let r = radius;
            let arrow = [
                (x - 0.75 * r * inward.x, y + 0.75 * r * inward.y),
                (x - 0.25 * r * inward.x, y + 0.25 * r * inward.y),
            ];
            svg.path(&path_data(&arrow), &format!(" stroke=\"{INK}\" stroke-width=\"1.4\""));
            svg.path(&dot(arrow[1], 2.6), &format!(" fill=\"{INK}\""));
            let normal = slot.rotation * nalgebra::Vector3::z();
            let tilt = normal.x.hypot(normal.y).atan2(normal.z).to_degrees();
            let slots = if station.slots > 1 {
                format!(", {} slots", station.slots)
            } else {
                String::new()
            };
            let tilt = if tilt > 5e-4 { format!(", {}°", short(tilt)) } else { String::new() };
            let text = format!("{}{slots}{tilt}", station.name);
            let below = slot.translation.vector.y < 0.0;
            let at = place(&text, outline(slot), below, &mut obstacles, frame);
            svg.text(at, TICK, Anchor::Middle, &text, RIM);
        }
    }

    /// The legend in rows that fit the page: a symbol and a text for each entry.
    fn legend_rows(&self) -> Vec<Vec<(String, String)>> {
        let mut entries: Vec<(String, String)> = Vec::new();
        for (k, path) in self.paths.iter().enumerate() {
            let name =
                &self.cell.robot.arms[path.effector.arm].effectors[path.effector.effector].name;
            let [path_style, reach_style] = [self.path_style(k), self.reach_style(k)];
            entries.push((element("M0 0h20", &path_style), format!("wafer centre of {name}")));
            entries.push((element("M0 0h20", &reach_style), format!("reach of {name}")));
        }
        for effector in self.cell.robot.effectors() {
            if self.postures.iter().any(|posture| posture.effector == effector) {
                let name = &self.cell.robot.arms[effector.arm].effectors[effector.effector].name;
                let colour = effector_colour(self.effector_index(effector)).hex();
                let look = format!(" stroke=\"{colour}\" stroke-width=\"2.4\"");
                entries.push((element("M0 0h20", &look), format!("arm with {name}")));
            }
        }
        if !self.cell.stations.is_empty() {
            let arrow = element("M0 0h14", &format!(" stroke=\"{INK}\" stroke-width=\"1.4\""))
                + &element(&dot((14.0, 0.0), 2.6), &format!(" fill=\"{INK}\""));
            entries.push((arrow, "entry of a station".to_owned()));
        }
        let rod = element(&dot((10.0, 0.0), 3.0), &format!(" fill=\"{INK}\""));
        entries.push((rod, "rod".to_owned()));
        let swatch = |look: &str| element("M0 -5h20v10h-20z", look);
        if self.cell.zones.iter().any(|zone| zone.rule == ZoneRule::KeepOut) {
            entries.push((swatch(FORBIDDEN), "keep-out zone".to_owned()));
        }
        if self.cell.zones.iter().any(|zone| zone.rule == ZoneRule::Safe) {
            entries.push((swatch(ALLOWED), "safe zone".to_owned()));
        }
        if self.cell.bodies.iter().any(|body| body.parent == ParentFrame::World) {
            entries.push((swatch(BODY), "body".to_owned()));
        }
        if self.outlines_in_violation().next().is_some() {
            entries.push((swatch(VIOLATING), "in violation".to_owned()));
        }
        if !self.violations.is_empty() {
            let look = format!(" stroke=\"{}\" stroke-width=\"2.4\"", Colour::VERMILLION.hex());
            entries.push((element("M5 -4.5l9 9m0 -9l-9 9", &look), "violation".to_owned()));
        }
        let mut rows: Vec<Vec<(String, String)>> = Vec::new();
        let mut room = 0.0;
        for entry in entries {
            let wide = entry_width(&entry.1);
            if rows.is_empty() || wide > room {
                rows.push(Vec::new());
                room = self.width - 2.0 * MARGIN + 16.0;
            }
            room -= wide;
            if let Some(row) = rows.last_mut() {
                row.push(entry);
            }
        }
        rows
    }

    fn draw_legend(&self, svg: &mut Svg, entries: &[(String, String)], y: f64) {
        let total: f64 = entries.iter().map(|(_, text)| entry_width(text)).sum::<f64>() - 16.0;
        let mut x = 0.5 * (self.width - total);
        for (drawn, text) in entries {
            svg.elements(&format!(
                "<g transform=\"translate({} {})\">\n{drawn}</g>\n",
                px(x),
                px(y)
            ));
            svg.text((x + 26.0, y + HALF_CAPITAL * TICK), TICK, Anchor::Start, text, "");
            x += entry_width(text);
        }
    }
}

/// Width of a legend entry with the gap after it (px).
fn entry_width(text: &str) -> f64 {
    26.0 + width(text, TICK) + 16.0
}

/// A number with at most three decimals.
fn short(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn center(vector: nalgebra::Vector3<f64>) -> [f64; 2] {
    [vector.x, vector.y]
}

fn polygon(camera: &Camera, corners: &[[f64; 2]]) -> String {
    if corners.len() < 3 {
        return String::new();
    }
    let spots: Vec<(f64, f64)> = corners.iter().map(|&corner| camera.project(corner)).collect();
    path_data(&spots) + "z"
}

fn circle(camera: &Camera, middle: [f64; 2], radius: f64) -> String {
    dot(camera.project(middle), radius * camera.scale)
}

fn dot((x, y): (f64, f64), radius: f64) -> String {
    let (r, d) = (px(radius), px(2.0 * radius));
    format!("M{} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0z", px(x - radius), px(y))
}

/// The directions of x and y.
fn axes(svg: &mut Svg, (x, y): (f64, f64)) {
    let data = format!("M{} {}V{}H{}", px(x), px(y - AXES), px(y), px(x + AXES));
    svg.path(&data, &format!(" stroke=\"{INK}\" stroke-width=\"1.4\""));
    svg.text((x + AXES + 9.0, y + HALF_CAPITAL * TICK), TICK, Anchor::Middle, "x", "");
    svg.text((x, y - AXES - 6.0), TICK, Anchor::Middle, "y", "");
}
