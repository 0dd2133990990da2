//! A motion in independent windows of steps, for viewers that show a part of a long motion.

mod cut;
mod encode;
mod envelope;
mod held_at;
mod relative_time;

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use jointplay_cell::program::LocationChange;
use jointplay_cell::robot::EffectorId;
use jointplay_cell::trajectory::Trajectory;
use jointplay_format::program::phase_name;

use self::envelope::of_step;
use self::relative_time::since;
use super::error::Error;
use super::motion_export::MotionExport;
use super::segment::Segment;
use super::wafer_frames::WaferFrames;
use jointplay_report::ViolationReport;

pub use envelope::Envelope;
pub use held_at::{HeldAt, wafers_at_start};

/// Steps of a window, unless a motion has so many that there would be more than [`MOST_WINDOWS`].
const STEPS: usize = 96;
/// Number of the encoding of windows, as a part of their keys; browsers keep the content of a key.
const ENCODING: u32 = 2;
/// Approximate largest number of windows of a motion.
const MOST_WINDOWS: usize = 2048;

/// A motion in windows of steps.
///
/// The content of a window depends on its steps, on the occupancy at its start and on its violations, and not on its start time.
/// The key of a window is a hash of all inputs of its content: windows with equal keys are equal.
pub struct Timeline {
    /// Windows in order; together they contain all steps.
    pub windows: Vec<Window>,
    /// Hash of the content of each step.
    marks: Vec<u64>,
    /// Hash of the axis motion of each step.
    motions: Vec<u64>,
    /// Hand-offs, in order.
    changes: Vec<Change>,
    /// Hash of the inputs that all windows of the cell share.
    shared: u64,
    /// Recently used segments, of this motion and previous ones.
    segments: Arc<Mutex<Segments>>,
}

/// Segments by hashes of the cell and of the motion, and by the effectors that carry a wafer.
type Segments = BTreeMap<(u64, u64, Vec<EffectorId>), Arc<Segment>>;

/// Largest number of cached segments.
const MOST_SEGMENTS: usize = 512;

/// Consecutive steps of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// Hash of the content, in hexadecimal digits.
    pub key: String,
    /// Indices of the steps.
    pub steps: Range<usize>,
    /// Start time (s).
    pub start: f64,
    /// Index of its first instruction.
    pub instruction: usize,
    /// Program line of the first instruction.
    pub line: usize,
}

/// A hand-off at the end of a step.
#[derive(Debug, Clone, Copy)]
struct Change {
    step: usize,
    wafer: usize,
    to: HeldAt,
}

impl Timeline {
    /// Divides a motion into windows.
    ///
    /// # Arguments
    /// * `violations` – all violations of the motion
    /// * `previous` – timeline of another motion: equal steps at the beginning and at the end have the same windows
    ///
    /// # Errors
    /// [`Error::Placing`]
    pub fn new(
        motion_export: &MotionExport<'_>,
        violations: &[ViolationReport],
        previous: Option<&Self>,
    ) -> Result<Self, Error> {
        let motion = motion_export.motion;
        let changes = changes(motion_export)?;
        let motions = motion.motion_hashes();
        let marks: Vec<u64> =
            (0..motion.steps.len()).map(|k| mark(motion, motions[k], k)).collect();
        let starts = |step: usize| {
            step == 0 || motion.steps[step].instruction != motion.steps[step - 1].instruction
        };
        let most = STEPS.max(motion.steps.len() / MOST_WINDOWS);
        let known = previous.map(|previous| (previous.marks.as_slice(), previous.edges()));
        let edges = cut::edges(&marks, &starts, most, known);
        let shared = motion_export.cell.kinematics_hash();
        let segments = previous.map_or_else(Arc::default, |one| Arc::clone(&one.segments));
        let mut timeline = Self { windows: Vec::new(), marks, motions, changes, shared, segments };
        let mut moved = BTreeMap::new();
        for pair in edges.windows(2) {
            let steps = pair[0]..pair[1];
            let first = &motion.steps[steps.start];
            let (start, instruction, line) =
                (motion.times[steps.start], first.instruction, first.place.line);
            let mut window = Window { key: String::new(), steps, start, instruction, line };
            window.key = timeline.key(motion, violations, &window, (shared, &moved));
            for change in timeline.changes_in(&window.steps) {
                moved.insert(change.wafer, change.to);
            }
            timeline.windows.push(window);
        }
        Ok(timeline)
    }

    /// The channels of a step.
    fn segment(
        &self,
        motion_export: &MotionExport<'_>,
        step: usize,
    ) -> Result<Arc<Segment>, Error> {
        let known = || self.segments.lock().unwrap_or_else(PoisonError::into_inner);
        let key =
            (self.shared, self.motions[step], motion_export.motion.steps[step].loaded.clone());
        if let Some(segment) = known().get(&key) {
            return Ok(Arc::clone(segment));
        }
        let made = Arc::new(Segment::new(motion_export, step)?);
        let mut known = known();
        if known.len() >= MOST_SEGMENTS {
            known.clear();
        }
        known.insert(key, Arc::clone(&made));
        Ok(made)
    }

    fn edges(&self) -> Vec<usize> {
        let ends = self.windows.iter().map(|window| window.steps.end);
        std::iter::once(0).chain(ends).collect()
    }

    /// Index of the window with this key.
    #[must_use]
    pub fn find(&self, key: &str) -> Option<usize> {
        self.windows.iter().position(|window| window.key == key)
    }

    /// Wafers that were handed over before a step, by index.
    fn moved(&self, step: usize) -> BTreeMap<usize, HeldAt> {
        let before = self.changes.partition_point(|change| change.step < step);
        self.changes[..before].iter().map(|change| (change.wafer, change.to)).collect()
    }

    /// Hand-offs in a range of steps.
    fn changes_in(&self, steps: &Range<usize>) -> &[Change] {
        let at = |step: usize| self.changes.partition_point(|change| change.step < step);
        &self.changes[at(steps.start)..at(steps.end)]
    }

    /// Hash of all inputs of a window's content.
    fn key(
        &self,
        motion: &Trajectory,
        violations: &[ViolationReport],
        window: &Window,
        (shared, moved): (u64, &BTreeMap<usize, HeldAt>),
    ) -> String {
        let digits = |seed: u64| {
            let mut hasher = DefaultHasher::new();
            (seed, shared, ENCODING, env!("CARGO_PKG_VERSION")).hash(&mut hasher);
            for step in window.steps.clone() {
                let described = &motion.steps[step];
                self.marks[step].hash(&mut hasher);
                (described.instruction - window.instruction).hash(&mut hasher);
                described.place.line.wrapping_sub(window.line).hash(&mut hasher);
            }
            for (wafer, held) in moved {
                wafer.hash(&mut hasher);
                held.hash_into(&mut hasher);
            }
            for change in self.changes_in(&window.steps) {
                (change.step - window.steps.start, change.wafer).hash(&mut hasher);
                change.to.hash_into(&mut hasher);
            }
            for one in self.violations(motion, violations, window) {
                (&one.kind, &one.entities, &one.phase, &one.message).hash(&mut hasher);
                for time in [one.start_s, one.end_s] {
                    since(time, window.start).to_bits().hash(&mut hasher);
                }
                one.line.wrapping_sub(window.line).hash(&mut hasher);
            }
            hasher.finish()
        };
        format!("{:016x}{:016x}", digits(0), digits(1))
    }

    /// Violations of instructions that are at least partly in a window.
    fn violations<'v>(
        &self,
        motion: &Trajectory,
        violations: &'v [ViolationReport],
        window: &Window,
    ) -> impl Iterator<Item = &'v ViolationReport> + use<'v> {
        let (start, end) = (window.start, motion.times[window.steps.end]);
        // Sorted by start; none lasts beyond its instruction, which begins in this window or the one before.
        violations.iter().filter(move |one| one.start_s <= end && one.end_s >= start)
    }

    /// Least and largest values of all axes in some windows, by index; unknown indices are omitted.
    #[must_use]
    pub fn envelopes(
        &self,
        motion_export: &MotionExport<'_>,
        windows: &[usize],
    ) -> Vec<Vec<Envelope>> {
        let MotionExport { cell, motion, .. } = *motion_export;
        let axes = cell.robot.axes.len();
        let mut known: BTreeMap<u64, Vec<Envelope>> = BTreeMap::new();
        let of_window = |window: &Window| {
            let mut whole = vec![Envelope::NOTHING; axes];
            for step in window.steps.clone() {
                let found =
                    known.entry(self.motions[step]).or_insert_with(|| of_step(motion, step, axes));
                whole.iter_mut().zip(found).for_each(|(whole, found)| whole.add(found));
            }
            whole
        };
        windows.iter().filter_map(|&index| self.windows.get(index)).map(of_window).collect()
    }
}

/// All hand-offs.
fn changes(motion_export: &MotionExport<'_>) -> Result<Vec<Change>, Error> {
    let mut wafers = WaferFrames::new(motion_export);
    let mut changes = Vec::new();
    while let Some(LocationChange { step, wafer, .. }) = wafers.apply_next()? {
        changes.push(Change { step, wafer, to: HeldAt::new(&wafers.frames[wafer]) });
    }
    Ok(changes)
}

/// Hash of the content of a step.
fn mark(motion: &Trajectory, axes: u64, index: usize) -> u64 {
    let step = &motion.steps[index];
    let mut hasher = DefaultHasher::new();
    (axes, phase_name(step.phase), &step.loaded).hash(&mut hasher);
    step.slot.map(|slot| slot.station).hash(&mut hasher);
    step.handoff.is_some().hash(&mut hasher);
    motion.has_duration(index).hash(&mut hasher);
    let begins = index == 0 || motion.steps[index - 1].instruction != step.instruction;
    begins.hash(&mut hasher);
    hasher.finish()
}
