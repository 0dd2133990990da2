//! Encoding of a window: a description as JSON, then numbers.

use std::collections::BTreeMap;

use jointplay_cell::robot::EffectorId;
use jointplay_format::program::phase_name;
use serde_json::{Value, json};

use super::Timeline;
use super::held_at::HeldAt;
use super::relative_time::since;
use crate::export::channel::Channel;
use crate::export::error::Error;
use crate::export::motion_export::MotionExport;
use jointplay_report::ViolationReport;

/// Distinct channels.
#[derive(Default)]
struct Pool {
    known: BTreeMap<Vec<u64>, usize>,
    /// Offset of the numbers of each channel, and its number of keys.
    places: Vec<[usize; 2]>,
    numbers: Vec<f64>,
}

impl Pool {
    fn add(&mut self, Channel { times, values, rates }: &Channel) -> usize {
        let all = || times.iter().chain(values).chain(rates);
        let bits: Vec<u64> = all().map(|number| number.to_bits()).collect();
        let next = self.places.len();
        *self.known.entry(bits).or_insert_with(|| {
            self.places.push([self.numbers.len(), times.len()]);
            self.numbers.extend(all());
            next
        })
    }
}

impl Timeline {
    /// The content of a window.
    ///
    /// ```text
    ///    length of the JSON text [u32, little-endian] | JSON text, spaces up to a multiple of 8 bytes | numbers [f64, little-endian]
    /// ```
    /// A channel is an offset in the numbers and a number of keys n: n times since the start of its step, n values, n slopes. Between two keys it is their cubic; before the first and after the last it is constant.
    ///
    /// # Arguments
    /// * `violations` – the violations passed to [`Timeline::new`]
    ///
    /// # Errors
    /// [`Error::Placing`]
    ///
    /// # Panics
    /// If there is no such window.
    pub fn content(
        &self,
        motion_export: &MotionExport<'_>,
        violations: &[ViolationReport],
        index: usize,
    ) -> Result<Vec<u8>, Error> {
        let MotionExport { cell, motion, .. } = *motion_export;
        let window = &self.windows[index];
        let effectors: Vec<EffectorId> = cell.robot.effectors().collect();
        let number = |id: EffectorId| effectors.iter().position(|&one| one == id);
        let held = |wafer: usize, held: &HeldAt| {
            json!({
                "wafer": wafer,
                "effector": held.location.effector().and_then(number),
                "slot": held.location.slot().map(|slot| json!([slot.station, slot.slot])),
                "pose": held.pose,
            })
        };
        let mut pool = Pool::default();
        let mut segments: Vec<Value> = Vec::new();
        let mut known: BTreeMap<(u64, Vec<EffectorId>), usize> = BTreeMap::new();
        let mut steps = Vec::with_capacity(window.steps.len());
        for step in window.steps.clone() {
            let described = &motion.steps[step];
            let key = (self.motions[step], described.loaded.clone());
            let segment = match known.get(&key) {
                Some(&segment) => segment,
                None => {
                    let made = self.segment(motion_export, step)?;
                    let channels: Vec<usize> =
                        made.channels.iter().map(|one| pool.add(one)).collect();
                    segments.push(json!({
                        "duration_s": made.duration,
                        "channels": channels,
                        "moving": motion.moving_axes(step),
                    }));
                    known.insert(key, segments.len() - 1);
                    segments.len() - 1
                }
            };
            steps.push(json!({
                "segment": segment,
                "instruction": described.instruction - window.instruction,
                "line": described.place.line as i64 - window.line as i64,
                "phase": phase_name(described.phase),
                "station": described.slot.map(|slot| slot.station),
                "loaded": described.loaded.iter().filter_map(|&id| number(id)).collect::<Vec<_>>(),
            }));
        }
        let moved = self.moved(window.steps.start);
        let changes = self.changes_in(&window.steps).iter().map(|change| {
            let mut change_of = held(change.wafer, &change.to);
            change_of["step"] = json!(change.step - window.steps.start);
            change_of
        });
        let violations = self.violations(motion, violations, window).map(|one| {
            json!({
                "entities": one.entities,
                "message": one.message,
                "phase": one.phase,
                "line": one.line as i64 - window.line as i64,
                "start_s": since(one.start_s, window.start),
                "end_s": since(one.end_s, window.start),
            })
        });
        let description = json!({
            "steps": steps,
            "segments": segments,
            "channels": pool.places,
            "wafers": moved.iter().map(|(&wafer, at)| held(wafer, at)).collect::<Vec<_>>(),
            "changes": changes.collect::<Vec<_>>(),
            "violations": violations.collect::<Vec<_>>(),
        });
        Ok(block(&description, &pool.numbers))
    }

    /// [`Timeline::envelopes`] in the encoding of [`Timeline::content`]: for each window and axis least and largest position, velocity and acceleration, and the time of motion.
    #[must_use]
    pub fn overview(&self, motion_export: &MotionExport<'_>, windows: &[usize]) -> Vec<u8> {
        let envelopes = self.envelopes(motion_export, windows);
        let mut numbers = Vec::new();
        for envelope in envelopes.iter().flatten() {
            numbers.extend(envelope.bounds.as_flattened());
            numbers.push(envelope.moving);
        }
        let axes = motion_export.cell.robot.axes.len();
        block(&json!({ "windows": envelopes.len(), "axes": axes }), &numbers)
    }
}

/// JSON and numbers in one block.
fn block(description: &Value, numbers: &[f64]) -> Vec<u8> {
    let mut text = description.to_string();
    while !(4 + text.len()).is_multiple_of(8) {
        text.push(' ');
    }
    let length = u32::try_from(text.len()).unwrap_or(u32::MAX);
    let mut bytes = Vec::with_capacity(4 + text.len() + 8 * numbers.len());
    bytes.extend(length.to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}
