//! A motion in windows of steps, each of which is described by itself: for viewers that show a part of a long motion.

mod cut;
mod encode;

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use jointplay_cell::program::Phase;
use jointplay_cell::robot::EffectorId;
use jointplay_cell::station::SlotId;
use jointplay_cell::trajectory::{Sample, Trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Pose;

use super::scene::{Held, Wafers, rounded};
use super::segment::{POSE_NUMBERS, Segment, numbers_of};
use super::{Error, Recording};
use crate::report::ViolationReport;

/// Steps of a window, unless a motion has so many that there would be more than [`MOST_WINDOWS`].
const STEPS: usize = 96;
/// Most windows of a motion, about.
const MOST_WINDOWS: usize = 2048;
/// Where a wafer lies is noted to this fraction of a metre, and of the vector part of its quaternion.
const PLACES: f64 = 1e9;

/// A motion in windows of steps.
///
/// The content of a window depends on its steps, on where the wafers are at its start and on the violations in it, and not on when it starts.
/// Its key is a hash of all that its content depends on: windows with the same key are the same.
pub struct Timeline {
    /// In order; together they hold all steps.
    pub windows: Vec<Window>,
    /// Of each step, a hash of what happens in it.
    marks: Vec<u64>,
    /// Of each step, a hash of how the axes move in it.
    motions: Vec<u64>,
    /// Where wafers go, in order.
    changes: Vec<Change>,
    /// Hash of what all windows of the cell depend on.
    shared: u64,
    /// Those that were asked for last, of this motion and the ones before.
    segments: Arc<Mutex<Segments>>,
}

/// Segments by hashes of the cell and of the motion, and by the effectors that carry a wafer.
type Segments = BTreeMap<(u64, u64, Vec<EffectorId>), Arc<Segment>>;

/// Segments that are remembered.
const MOST_SEGMENTS: usize = 512;

/// Some steps of a motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// Hash of its content, as hexadecimal digits.
    pub key: String,
    /// Its steps.
    pub steps: Range<usize>,
    /// When it starts [s].
    pub start: f64,
    /// Index of its first instruction.
    pub instruction: usize,
    /// Line of that.
    pub line: usize,
}

/// A wafer that changes hands at the end of a step.
#[derive(Debug, Clone, Copy)]
struct Change {
    step: usize,
    wafer: usize,
    to: HeldAt,
}

/// What holds a wafer, and its frame there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldAt {
    /// The effector; `None` where it lies in a slot.
    pub effector: Option<EffectorId>,
    /// The slot; `None` where an effector carries it.
    pub slot: Option<SlotId>,
    /// Origin x, y, z [m] and vector part x, y, z of its unit quaternion, whose scalar part is positive: in the wafer frame of the effector, or in the base frame.
    pub pose: [f64; POSE_NUMBERS],
}

/// Least and largest values of an axis over a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    /// Of position, velocity and acceleration: least, then largest [m or rad, and these by s and s²].
    pub bounds: [[f64; 2]; 3],
    /// How long it moves [s].
    pub moving: f64,
}

/// Where all wafers are before a program starts, in the order of a cell's wafers.
#[must_use]
pub fn wafers_at_start(cell: &Cell) -> Vec<HeldAt> {
    let in_slots = cell.occupied.iter().map(|&slot| {
        let at = cell.stations[slot.station].slot_frame(slot.slot);
        HeldAt { effector: None, slot: Some(slot), pose: numbers_of(&at) }
    });
    let carried = cell.carried.iter().map(|&id| HeldAt {
        effector: Some(id),
        slot: None,
        pose: numbers_of(&Pose::identity()),
    });
    in_slots.chain(carried).collect()
}

impl Timeline {
    /// Cuts a motion into windows.
    ///
    /// # Arguments
    /// * `violations` – all of the motion
    /// * `previous` – windows of another motion: where steps at the beginning and at the end are those of it, so are the windows
    ///
    /// # Errors
    /// [`Error::Placing`]
    pub fn new(
        recording: &Recording<'_>,
        violations: &[ViolationReport],
        previous: Option<&Self>,
    ) -> Result<Self, Error> {
        let motion = recording.motion;
        let changes = changes(recording)?;
        let motions = motion.fingerprints();
        let marks: Vec<u64> =
            (0..motion.steps.len()).map(|k| mark(motion, motions[k], k)).collect();
        let starts = |step: usize| {
            step == 0 || motion.steps[step].instruction != motion.steps[step - 1].instruction
        };
        let most = STEPS.max(motion.steps.len() / MOST_WINDOWS);
        let known = previous.map(|previous| (previous.marks.as_slice(), previous.edges()));
        let edges = cut::edges(&marks, &starts, most, known);
        let shared = shared(recording.cell);
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

    /// A step as channels.
    fn segment(&self, recording: &Recording<'_>, step: usize) -> Result<Arc<Segment>, Error> {
        let known = || self.segments.lock().unwrap_or_else(PoisonError::into_inner);
        let key = (self.shared, self.motions[step], recording.motion.steps[step].loaded.clone());
        if let Some(segment) = known().get(&key) {
            return Ok(Arc::clone(segment));
        }
        let made = Arc::new(Segment::new(recording, step)?);
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

    /// Index of the window of a key.
    #[must_use]
    pub fn find(&self, key: &str) -> Option<usize> {
        self.windows.iter().position(|window| window.key == key)
    }

    /// Wafers that have changed hands before a step, by index.
    fn moved(&self, step: usize) -> BTreeMap<usize, HeldAt> {
        let before = self.changes.partition_point(|change| change.step < step);
        self.changes[..before].iter().map(|change| (change.wafer, change.to)).collect()
    }

    /// Wafers that change hands in some steps.
    fn changes_in(&self, steps: &Range<usize>) -> &[Change] {
        let at = |step: usize| self.changes.partition_point(|change| change.step < step);
        &self.changes[at(steps.start)..at(steps.end)]
    }

    /// Hash of all that the content of a window depends on.
    fn key(
        &self,
        motion: &Trajectory,
        violations: &[ViolationReport],
        window: &Window,
        (shared, moved): (u64, &BTreeMap<usize, HeldAt>),
    ) -> String {
        let digits = |seed: u64| {
            let mut hasher = DefaultHasher::new();
            (seed, shared, env!("CARGO_PKG_VERSION")).hash(&mut hasher);
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
                (&one.kind, &one.names, &one.message).hash(&mut hasher);
                for time in [one.start_s, one.end_s] {
                    encode::since(time, window.start).to_bits().hash(&mut hasher);
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
        // By time of start; none lasts beyond its instruction, which begins in this window or the one before.
        violations.iter().filter(move |one| one.start_s <= end && one.end_s >= start)
    }

    /// Least and largest values of all axes in some windows, by index; those that are not there are left out.
    #[must_use]
    pub fn envelopes(&self, recording: &Recording<'_>, windows: &[usize]) -> Vec<Vec<Envelope>> {
        let Recording { cell, motion, .. } = *recording;
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

impl Envelope {
    const NOTHING: Self = Self { bounds: [[f64::INFINITY, f64::NEG_INFINITY]; 3], moving: 0.0 };

    fn add(&mut self, other: &Self) {
        for (all, one) in self.bounds.iter_mut().zip(&other.bounds) {
            *all = [all[0].min(one[0]), all[1].max(one[1])];
        }
        self.moving += other.moving;
    }

    fn reach(&mut self, values: [f64; 3]) {
        for (bounds, value) in self.bounds.iter_mut().zip(values) {
            *bounds = [bounds[0].min(value), bounds[1].max(value)];
        }
    }
}

impl HeldAt {
    fn hash_into(&self, hasher: &mut impl Hasher) {
        (self.effector, self.slot.map(|slot| (slot.station, slot.slot))).hash(hasher);
        self.pose.map(f64::to_bits).hash(hasher);
    }

    fn new(held: &Held, slot: Option<SlotId>) -> Self {
        let (effector, pose) = match held {
            Held::Lying(at) => (None, at),
            Held::On(id, at) => (Some(*id), at),
        };
        // The same place after any number of moves.
        Self { effector, slot, pose: numbers_of(pose).map(|number| rounded(number, PLACES)) }
    }
}

/// All wafers that change hands.
fn changes(recording: &Recording<'_>) -> Result<Vec<Change>, Error> {
    let mut wafers = Wafers::new(recording);
    let mut changes = Vec::new();
    for step in 0..recording.motion.steps.len() {
        if let Some((wafer, slot)) = wafers.next_step(recording)? {
            let to = HeldAt::new(&wafers.all[wafer].held, slot);
            changes.push(Change { step, wafer, to });
        }
    }
    Ok(changes)
}

/// Hash of what all windows of a cell depend on: numbers are printed so that no two of them look alike.
fn shared(cell: &Cell) -> u64 {
    let mut hasher = DefaultHasher::new();
    format!("{:?} {:?} {:?}", cell.robot, cell.wafer, cell.gravity).hash(&mut hasher);
    hasher.finish()
}

/// Hash of what happens in a step, whose axes move so.
fn mark(motion: &Trajectory, axes: u64, index: usize) -> u64 {
    let step = &motion.steps[index];
    let mut hasher = DefaultHasher::new();
    (axes, phase(step.phase), &step.loaded).hash(&mut hasher);
    step.handover.is_some().hash(&mut hasher);
    motion.has_duration(index).hash(&mut hasher);
    let begins = index == 0 || motion.steps[index - 1].instruction != step.instruction;
    begins.hash(&mut hasher);
    hasher.finish()
}

/// What a part of an instruction is called.
pub(crate) fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Move => "move",
        Phase::TuckIn => "tuck in",
        Phase::Turn => "turn",
        Phase::Enter => "enter",
        Phase::Extend => "extend",
        Phase::Lift => "lift",
        Phase::Lower => "lower",
        Phase::Retract => "retract",
        Phase::Level => "level",
        Phase::Wait => "wait",
    }
}

/// Least and largest values in a step: where jerks jump, between, and where speeds and accelerations turn back.
fn of_step(motion: &Trajectory, step: usize, axes: usize) -> Vec<Envelope> {
    let mut found = vec![Envelope::NOTHING; axes];
    for axis in motion.moving_axes(step) {
        found[axis].moving = motion.intrinsic_step_duration(step);
    }
    let mut last: Option<Sample> = None;
    for time in motion.jerk_discontinuities(step) {
        let now = motion.sample_in_step(step, time);
        let mut looks = Vec::new();
        if let Some(last) = &last {
            let width = now.time - last.time;
            looks.extend([0.25, 0.5, 0.75].map(|share| last.time + share * width));
            let zero = |before: f64, after: f64| {
                (before * after < 0.0).then(|| last.time + width * before / (before - after))
            };
            for axis in 0..axes {
                looks.extend(zero(last.accelerations[axis], now.accelerations[axis]));
                looks.extend(zero(last.velocities[axis], now.velocities[axis]));
            }
        }
        let between = looks.into_iter().map(|time| motion.sample_in_step(step, time));
        for sample in between.chain([now.clone()]) {
            for (axis, envelope) in found.iter_mut().enumerate() {
                let rates = (sample.velocities[axis], sample.accelerations[axis]);
                envelope.reach([sample.positions[axis], rates.0, rates.1]);
            }
        }
        last = Some(now);
    }
    found
}
