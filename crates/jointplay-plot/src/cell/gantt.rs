//! The timing diagram of a trajectory: motions of the axes by instruction, and wafers on effectors and at stations.

use jointplay_cell::program::{Handoff, Step};
use jointplay_cell::robot::EffectorId;
use jointplay_cell::schedule::Schedule;
use jointplay_cell::station::SlotId;
use jointplay_cell::trajectory::Trajectory;
use jointplay_cell::workcell::Cell;

use super::gantt_interval::{Interval, IntervalKind};
use super::gantt_places::places;
use crate::linear_ticks::linear_ticks;
use crate::svg::{Anchor, INK, Svg, px};
use crate::text::{HALF_CAPITAL, LEADING, TICK, TITLE, width, wrap};
use crate::{Colour, Error, png};

/// Margin on the right (px).
const MARGIN: f64 = 16.0;
/// Height of a row, and of the bar in it (px).
const ROW: f64 = 16.0;
const BAR: f64 = 10.0;
/// Height of the ticks below the rows, with their labels and the gap to the next band (px).
const TICKS: f64 = 36.0;
/// Smallest duration of a band (s).
const SHORTEST: f64 = 60.0;
/// Default of the largest number of bands.
const MAX_BANDS: u32 = 12;

/// The timing diagram of a trajectory; long trajectories are split into bands, one below the other.
#[derive(Debug, Clone, PartialEq)]
pub struct Gantt {
    /// Names of the axes.
    pub axes: Vec<String>,
    /// Names of effectors and stations with wafers.
    pub places: Vec<String>,
    /// Intervals of instructions, motions, wafers and violations.
    pub intervals: Vec<Interval>,
    /// Start and end of the drawn part of the trajectory (s).
    pub window: [f64; 2],
    /// Largest number of bands.
    pub max_bands: u32,
    /// Title above the picture; empty for none.
    pub title: String,
    /// Width in pixels.
    pub width: f64,
}

impl Gantt {
    /// The timing diagram of a trajectory.
    ///
    /// # Arguments
    /// * `cell` – the cell of the trajectory
    /// * `schedule` – of the trajectory
    /// * `lines` – text of the program, for the labels of instructions
    /// * `violations` – start and end of each violation (s)
    #[must_use]
    pub fn new(
        title: &str,
        cell: &Cell,
        motion: &Trajectory,
        schedule: &Schedule,
        lines: &str,
        violations: &[[f64; 2]],
    ) -> Self {
        let axes: Vec<String> = cell.robot.axes.iter().map(|axis| axis.name.clone()).collect();
        let quoted: Vec<&str> = lines.lines().map(str::trim).collect();
        let mut intervals: Vec<Interval> = Vec::new();
        let mut instruction = None;
        for (k, step) in motion.steps.iter().enumerate() {
            let (from, to) = (motion.times[k], motion.times[k + 1]);
            if instruction == Some(step.instruction) {
                if let Some(interval) = intervals
                    .iter_mut()
                    .rev()
                    .find(|interval| matches!(interval.kind, IntervalKind::Instruction(_)))
                {
                    interval.to = to;
                }
            } else {
                instruction = Some(step.instruction);
                let line = step.place.line;
                let text = quoted.get(line.wrapping_sub(1)).copied().unwrap_or_default();
                let steps_of_line =
                    motion.steps[k..].iter().take_while(|one| one.instruction == step.instruction);
                let kind = IntervalKind::Instruction(labels(cell, line, text, steps_of_line));
                intervals.push(Interval { from, to, kind });
            }
            // An axis can move and return within a segment.
            let middle: Vec<_> =
                (1..8).map(|k| motion.sample_at(from + f64::from(k) / 8.0 * (to - from))).collect();
            for axis in 0..axes.len() {
                let moves = step.from[axis] != step.to[axis]
                    || middle.iter().any(|sample| sample.velocities[axis].abs() > 1e-9);
                if moves && to > from {
                    let kind = if step.loaded.is_empty() {
                        IntervalKind::Empty(axis)
                    } else {
                        IntervalKind::Loaded(axis)
                    };
                    intervals.push(Interval { from, to, kind });
                }
            }
        }
        let (places, of_places) = places(cell, schedule);
        intervals.extend(of_places);
        intervals.extend(violations.iter().map(|&[from, to]| Interval {
            from,
            to,
            kind: IntervalKind::Violation,
        }));
        let window = [0.0, motion.duration()];
        Self {
            axes,
            places,
            intervals,
            window,
            max_bands: MAX_BANDS,
            title: title.to_owned(),
            width: 1080.0,
        }
    }

    /// The picture as SVG with real text, on white.
    ///
    /// # Errors
    /// [`Error::Size`] if the width is out of bounds; [`Error::Extent`] if the drawn part takes no time, or not a finite one.
    pub fn to_svg(&self) -> Result<String, Error> {
        crate::check::width(self.width)?;
        let [start, end] = self.window;
        let duration = end - start;
        if !(duration.is_finite() && duration > 0.0) {
            let what = "the trajectory".to_owned();
            return Err(Error::Extent { what, found: duration, unit: "s" });
        }
        let has_violations =
            self.intervals.iter().any(|interval| interval.kind == IntervalKind::Violation);
        let mut rows: Vec<&str> = vec![""];
        rows.extend(self.axes.iter().chain(&self.places).map(String::as_str));
        if has_violations {
            rows.push("violations");
        }
        let label =
            rows.iter().map(|name| width(name, TICK)).fold(0.0, f64::max).min(0.3 * self.width);
        let left = label + 18.0;
        let room = self.width - left - MARGIN;
        let bands = (duration / SHORTEST).ceil().clamp(1.0, f64::from(self.max_bands.max(1)));
        let length = duration / bands;
        let title = wrap(&self.title, TITLE, self.width - 2.0 * MARGIN);
        #[expect(clippy::cast_precision_loss, reason = "counts of lines")]
        let (top, high) =
            (18.0 + title.len() as f64 * TITLE * LEADING, rows.len() as f64 * ROW + TICKS);
        let about = if self.title.is_empty() { "axes over time" } else { &self.title };
        let mut svg = Svg::new(self.width, top + bands * high + 34.0, about);
        for (line, text) in title.iter().enumerate() {
            #[expect(clippy::cast_precision_loss, reason = "a count of lines")]
            let at = (0.5 * self.width, 26.0 + line as f64 * TITLE * LEADING);
            svg.text(at, TITLE, Anchor::Middle, text, "");
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most max_bands"
        )]
        for band in 0..bands as u32 {
            let from = start + f64::from(band) * length;
            let place =
                Band { left, room, top: top + f64::from(band) * high, from, to: from + length };
            self.band(&mut svg, &place, &rows);
        }
        self.legend(&mut svg, top + bands * high + 12.0, has_violations);
        Ok(svg.finish())
    }

    /// The SVG painted as PNG, `width_px` pixels wide, with the embedded DejaVu Sans.
    ///
    /// # Errors
    /// As [`Self::to_svg`]; [`Error::Size`] if `width_px` is 0 or over 20 000; [`Error::Paint`] if painting fails.
    pub fn to_png(&self, width_px: u32) -> Result<Vec<u8>, Error> {
        png::svg_to_png(&self.to_svg()?, width_px)
    }

    fn band(&self, svg: &mut Svg, band: &Band, rows: &[&str]) {
        #[expect(clippy::cast_precision_loss, reason = "a count of rows")]
        let row_top = |row: usize| band.top + row as f64 * ROW;
        let bottom = row_top(rows.len());
        let ticks = linear_ticks(band.from, band.to, 60.0 / band.room);
        let mut grid = String::new();
        for tick in &ticks.major {
            grid += &format!("M{} {}V{}", px(band.across(tick.value)), px(row_top(1)), px(bottom));
        }
        svg.path(&grid, " stroke=\"#e2e2e2\" stroke-width=\"1\"");
        let mut number = 0_usize;
        for interval in &self.intervals {
            let is_instruction = matches!(interval.kind, IntervalKind::Instruction(_));
            if is_instruction {
                number += 1;
            }
            if interval.to < band.from || interval.from > band.to {
                continue;
            }
            let (x0, x1) =
                (band.across(interval.from.max(band.from)), band.across(interval.to.min(band.to)));
            let (row, fill) = match &interval.kind {
                IntervalKind::Empty(axis) => (axis + 1, Colour::SKY_BLUE.hex()),
                IntervalKind::Loaded(axis) => (axis + 1, Colour::BLUE.hex()),
                IntervalKind::Instruction(_) if number.is_multiple_of(2) => {
                    (0, "#e4e4e0".to_owned())
                }
                IntervalKind::Instruction(_) => (0, "#cfcfca".to_owned()),
                IntervalKind::Wafers { row, .. } => {
                    (self.axes.len() + row + 1, Colour::GREEN.hex())
                }
                IntervalKind::Process(row) => (self.axes.len() + row + 1, Colour::ORANGE.hex()),
                IntervalKind::Violation => (rows.len() - 1, Colour::VERMILLION.hex()),
            };
            // A momentary violation stays visible.
            let wide =
                if interval.kind == IntervalKind::Violation { (x1 - x0).max(2.0) } else { x1 - x0 };
            if wide <= 0.0 {
                continue;
            }
            let bottom = row_top(row) + 0.5 * (ROW + BAR);
            let (y, high) = match interval.kind {
                IntervalKind::Instruction(_) => (row_top(row) + 1.0, ROW - 2.0),
                // A single wafer of many stays visible.
                IntervalKind::Wafers { share, .. } => {
                    let high = (share * BAR).max(1.0);
                    (bottom - high, high)
                }
                _ => (bottom - BAR, BAR),
            };
            svg.elements(&format!(
                "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{fill}\"/>\n",
                px(x0),
                px(y),
                px(wide),
                px(high)
            ));
            if let IntervalKind::Instruction(labels) = &interval.kind {
                let shown = fitting(labels, x1 - x0 - 8.0);
                let at = (x0 + 2.0, row_top(0) + 0.5 * ROW + HALF_CAPITAL * (TICK - 2.0));
                if !shown.is_empty() {
                    svg.text(at, TICK - 2.0, Anchor::Start, shown, "");
                }
            }
        }
        for (row, name) in rows.iter().enumerate().skip(1) {
            let at = (band.left - 8.0, row_top(row) + 0.5 * ROW + HALF_CAPITAL * TICK);
            svg.text(at, TICK, Anchor::End, name, "");
        }
        let frame = format!("M{} {}H{}", px(band.left), px(bottom), px(band.left + band.room));
        svg.path(&frame, &format!(" stroke=\"{INK}\" stroke-width=\"1\""));
        let unit = (band.left - 8.0, bottom + 16.0);
        svg.text(unit, TICK, Anchor::End, "s", "");
        for tick in &ticks.major {
            let x = band.across(tick.value);
            svg.path(
                &format!("M{} {}v4", px(x), px(bottom)),
                &format!(" stroke=\"{INK}\" stroke-width=\"1\""),
            );
            let half = 0.5 * width(&tick.label, TICK);
            // Within the page, and clear of the unit.
            let x = x.min(self.width - half - 2.0).max(unit.0 + half + 3.0);
            svg.text((x, bottom + 16.0), TICK, Anchor::Middle, &tick.label, "");
        }
    }

    fn legend(&self, svg: &mut Svg, y: f64, has_violations: bool) {
        let mut entries = vec![
            (Colour::SKY_BLUE.hex(), "moving without wafer"),
            (Colour::BLUE.hex(), "moving with wafer"),
        ];
        let shows = |is_kind: fn(&IntervalKind) -> bool| {
            self.intervals.iter().any(|interval| is_kind(&interval.kind))
        };
        if shows(|kind| matches!(kind, IntervalKind::Wafers { .. })) {
            entries.push((Colour::GREEN.hex(), "wafers, share of slots"));
        }
        if shows(|kind| matches!(kind, IntervalKind::Process(_))) {
            entries.push((Colour::ORANGE.hex(), "process"));
        }
        if has_violations {
            entries.push((Colour::VERMILLION.hex(), "violation"));
        }
        let wide = |text: &str| 24.0 + width(text, TICK) + 20.0;
        let total = entries.iter().map(|(_, text)| wide(text)).sum::<f64>() - 20.0;
        let mut x = 0.5 * (self.width - total);
        for (fill, text) in entries {
            svg.elements(&format!(
                "<rect x=\"{}\" y=\"{}\" width=\"18\" height=\"{BAR}\" fill=\"{fill}\"/>\n",
                px(x),
                px(y - 0.5 * BAR)
            ));
            svg.text((x + 24.0, y + HALF_CAPITAL * TICK), TICK, Anchor::Start, text, "");
            x += wide(text);
        }
    }
}

/// A band of the diagram on the page.
struct Band {
    left: f64,
    room: f64,
    top: f64,
    from: f64,
    to: f64,
}

impl Band {
    fn across(&self, time: f64) -> f64 {
        self.left + (time - self.from) / (self.to - self.from) * self.room
    }
}

/// The first text that fits; empty if none does.
fn fitting(texts: &[String], room: f64) -> &str {
    let fits = texts.iter().find(|text| width(text, TICK - 2.0) <= room);
    fits.map_or("", String::as_str)
}

/// Labels of an instruction, from long to short: its line number with its text, or with the slots that wafers are moved between.
fn labels<'s>(
    cell: &Cell,
    line: usize,
    text: &str,
    steps: impl Iterator<Item = &'s Step>,
) -> Vec<String> {
    let slot_name = |slot: SlotId| {
        let station = &cell.stations[slot.station];
        if station.slots > 1 {
            format!("{} {}", station.name, slot.slot)
        } else {
            station.name.clone()
        }
    };
    let effector_name = |id: EffectorId| &cell.robot.arms[id.arm].effectors[id.effector].name;
    let mut carried: Vec<(EffectorId, String)> = Vec::new();
    let mut moves: Vec<String> = Vec::new();
    for handoff in steps.filter_map(|step| step.handoff) {
        match handoff {
            Handoff::Picked(id, slot) => carried.push((id, slot_name(slot))),
            Handoff::Placed(id, slot) => {
                let from = carried.iter().position(|(with, _)| *with == id);
                let from = from.map(|place| carried.remove(place).1);
                let from = from.unwrap_or_else(|| effector_name(id).clone());
                moves.push(format!("{from}→{}", slot_name(slot)));
            }
        }
    }
    moves.extend(carried.iter().map(|(id, from)| format!("{from}→{}", effector_name(*id))));
    let words = text.split('#').next().unwrap_or_default().trim();
    let first = words.split_whitespace().next().unwrap_or_default();
    let mut labels = Vec::new();
    if moves.is_empty() {
        labels.extend([format!("{line} {words}"), format!("{line} {first}")]);
    } else {
        let all = moves.join(", ");
        labels.extend([format!("{line} {first} {all}"), format!("{line} {all}")]);
        labels.push(format!("{line} {}", moves[0]));
        let from = moves[0].split('→').next().unwrap_or_default();
        labels.push(format!("{line} {from}"));
    }
    labels.push(line.to_string());
    labels
}
