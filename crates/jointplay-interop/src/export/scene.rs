//! Moving frames of a cell with their trajectories: rods, platform, links, wafers.

use jointplay_cell::EntityId;
use jointplay_cell::program::Handover;
use jointplay_cell::robot::{ChainPose, EffectorId, RODS};
use jointplay_cell::station::SlotId;
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Pose;
use nalgebra::{SVector, UnitQuaternion, Vector4};

use super::error::Error;
use super::motion_export::MotionExport;
use super::samples::{loaded, placed};

/// Interval before and after a sample over which rates are differences (s).
const MOMENT: f64 = 1e-5;

/// Largest number of poses that are kept in memory, 112 bytes each.
const MOST_POSES: f64 = 2e7;

/// A frame that may move.
pub(super) struct Track {
    pub(super) name: String,
    /// The part of the cell to which the frame belongs.
    pub(super) of: Part,
    /// Index of the parent track, to which the poses refer; `None` for the base.
    pub(super) parent: Option<usize>,
    /// Origin in the parent, at each time (m).
    pub(super) places: Vec<[f64; 3]>,
    /// Unit quaternion x, y, z, w in the parent, at each time; neighbours have a positive dot product.
    pub(super) turns: Vec<[f64; 4]>,
    /// Rates of both, at each time; empty unless requested.
    pub(super) rates: Vec<Rate>,
    /// Slots in which a wafer rests, with their times.
    pub(super) rests: Vec<RestingWafer>,
}

/// Rate of change of a pose in its parent.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Rate {
    /// Velocity of its origin (m/s).
    pub(super) place: [f64; 3],
    /// Derivative of its unit quaternion (1/s).
    pub(super) turn: [f64; 4],
}

/// A wafer at rest in a slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct RestingWafer {
    pub(super) slot: SlotId,
    /// Start and end of the interval (s).
    pub(super) from: f64,
    pub(super) to: f64,
}

/// Part of the cell to which a track belongs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Rod(usize),
    Platform,
    Link {
        arm: usize,
        link: usize,
    },
    /// Index of a wafer: wafers in slots first, then those on effectors.
    Wafer(usize),
}

/// All frames that move.
pub(super) struct Scene {
    /// Sample times (s).
    pub(super) times: Vec<f64>,
    /// Parents come before children.
    pub(super) tracks: Vec<Track>,
}

/// Support of a wafer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Held {
    /// Pose of a wafer at rest, in the base frame.
    InSlot(Pose),
    /// Pose of a carried wafer, in the wafer frame of its effector.
    On(EffectorId, Pose),
}

pub(super) struct Wafer {
    name: String,
    pub(super) held: Held,
    rests: Vec<RestingWafer>,
}

impl Wafer {
    /// Pose of the wafer for a pose of the robot.
    fn place(&self, pose: &ChainPose) -> Pose {
        match self.held {
            Held::InSlot(at) => at,
            Held::On(id, at) => pose.base_from_wafer[id.arm][id.effector] * at,
        }
    }
}

impl Scene {
    /// The frames of a motion at equal intervals of time and at its end.
    ///
    /// # Arguments
    /// * `with_rates` – whether to compute the rates
    pub(super) fn of(
        motion_export: &MotionExport<'_>,
        rate: f64,
        with_rates: bool,
    ) -> Result<Self, Error> {
        motion_export.check_rate(rate)?;
        let MotionExport { cell, motion, .. } = *motion_export;
        let mut scene = Self { times: Vec::new(), tracks: tracks(cell) };
        let mut wafers = Wafers::new(motion_export);
        scene.tracks.extend(wafers.tracks());
        let found = motion.duration() * rate * scene.tracks.len() as f64;
        if found > MOST_POSES {
            return Err(Error::TooManyPoses { found, allowed: MOST_POSES });
        }
        for sample in motion.samples(rate) {
            wafers.until(motion_export, sample.time)?;
            let carried = loaded(motion_export, sample.step);
            let pose = |moment: f64| {
                let gone = sample.positions.iter().zip(&sample.velocities);
                let positions: Vec<f64> = gone.map(|(at, speed)| at + moment * speed).collect();
                placed(motion_export, sample.time, &positions, carried)
            };
            let now = pose(0.0)?;
            scene.times.push(sample.time);
            for track in &mut scene.tracks {
                track.push(&track.pose(cell, &wafers.all, &now));
            }
            if !with_rates {
                continue;
            }
            if sample.velocities.iter().all(|&speed| speed == 0.0) {
                scene.tracks.iter_mut().for_each(|track| track.rates.push(Rate::default()));
                continue;
            }
            let [before, after] = [pose(-MOMENT)?, pose(MOMENT)?];
            for track in &mut scene.tracks {
                let poses = [&before, &now, &after].map(|it| track.pose(cell, &wafers.all, it));
                track.push_rate(&poses);
            }
        }
        for track in &mut scene.tracks {
            if let Part::Wafer(k) = track.of {
                track.rests = std::mem::take(&mut wafers.all[k].rests);
            }
        }
        Ok(scene)
    }
}

impl Track {
    fn new(name: &str, of: Part, parent: Option<usize>) -> Self {
        let name = name.to_owned();
        let (places, turns, rates) = (Vec::new(), Vec::new(), Vec::new());
        Self { name, of, parent, places, turns, rates, rests: Vec::new() }
    }

    /// Pose in the parent for a pose of the robot.
    fn pose(&self, cell: &Cell, wafers: &[Wafer], pose: &ChainPose) -> Pose {
        let platform = &pose.platform;
        match self.of {
            Part::Rod(k) => {
                let base = cell.robot.gpr.base_points()[k];
                Pose::translation(base.x, base.y, platform.rods[k])
            }
            Part::Platform => platform.base_from_platform,
            Part::Link { arm, link: 0 } => {
                platform.base_from_platform.inverse() * pose.base_from_link[arm][0]
            }
            Part::Link { arm, link } => {
                let links = &pose.base_from_link[arm];
                links[link - 1].inverse() * links[link]
            }
            Part::Wafer(k) => wafers[k].place(pose),
        }
    }

    fn push(&mut self, pose: &Pose) {
        let turn = self.turn(pose);
        // Rounded, so that frames at rest have equal poses.
        self.places.push(<[f64; 3]>::from(pose.translation.vector).map(|part| rounded(part, 1e9)));
        self.turns.push(<[f64; 4]>::from(turn).map(|part| rounded(part, 1e12)));
    }

    /// Adds the rate at the last pose, from the poses a [`MOMENT`] before, at, and after its time.
    fn push_rate(&mut self, poses: &[Pose; 3]) {
        // Most wafers do not move.
        if poses[0] == poses[1] && poses[1] == poses[2] {
            return self.rates.push(Rate::default());
        }
        let place = slower(poses.each_ref().map(|pose| pose.translation.vector));
        let turn = slower(poses.each_ref().map(|pose| self.turn(pose)));
        self.rates.push(Rate { place, turn });
    }

    /// The unit quaternion x, y, z, w of a pose.
    fn turn(&self, pose: &Pose) -> Vector4<f64> {
        let turn = UnitQuaternion::from_rotation_matrix(&pose.rotation).into_inner().coords;
        // q and −q are one rotation; interpolation must take the shorter arc.
        let other_side =
            self.turns.last().is_some_and(|&last| turn.dot(&Vector4::from(last)) < 0.0);
        if other_side { -turn } else { turn }
    }
}

/// Rate from the smaller of both one-sided differences: at the edge of a droop table, where the droop jumps, the other one contains the jump.
fn slower<const N: usize>([before, now, after]: [SVector<f64, N>; 3]) -> [f64; N] {
    let (one, other) = (now - before, after - now);
    let gone = if one.norm() < other.norm() { one } else { other };
    <[f64; N]>::from(gone / MOMENT).map(|part| rounded(part, 1e6))
}

/// A number to the nearest fraction.
pub(super) fn rounded(value: f64, fractions: f64) -> f64 {
    // Adding zero removes the sign of a negative zero, which would differ bit by bit.
    (value * fractions).round() / fractions + 0.0
}

/// Whether sample `k` of a series is needed for linear interpolation: the ends, and samples that differ from a neighbour.
pub(super) fn is_key<T: PartialEq>(series: &[T], k: usize) -> bool {
    k == 0 || k + 1 == series.len() || series[k] != series[k - 1] || series[k] != series[k + 1]
}

/// Tracks of the robot without samples.
fn tracks(cell: &Cell) -> Vec<Track> {
    let robot = &cell.robot;
    let rods = (0..RODS).map(|k| Track::new(&robot.axes[k].name, Part::Rod(k), None));
    let mut tracks: Vec<Track> = rods.collect();
    let platform = tracks.len();
    tracks.push(Track::new("platform", Part::Platform, None));
    for (k, arm) in robot.arms.iter().enumerate() {
        for link in 0..arm.joints.len() {
            let parent = if link == 0 { platform } else { tracks.len() - 1 };
            let name = format!("{} link {}", arm.name, link + 1);
            tracks.push(Track::new(&name, Part::Link { arm: k, link }, Some(parent)));
        }
    }
    tracks
}

/// All wafers, those of slots first.
pub(super) struct Wafers {
    pub(super) all: Vec<Wafer>,
    in_slot: Vec<(SlotId, usize)>,
    /// The next step that may hand over a wafer.
    step: usize,
}

impl Wafers {
    /// Wafers in the initial occupancy.
    pub(super) fn new(motion_export: &MotionExport<'_>) -> Self {
        let (cell, to) = (motion_export.cell, motion_export.motion.duration());
        let in_slots = cell.occupied.iter().map(|&slot| {
            let station = &cell.stations[slot.station];
            let name = cell.entity_name(EntityId::Wafer(slot));
            let held = Held::InSlot(station.slot_frame(slot.slot));
            Wafer { name, held, rests: vec![RestingWafer { slot, from: 0.0, to }] }
        });
        let carried = cell.carried.iter().map(|&id| {
            let name = cell.entity_name(EntityId::HeldWafer(id));
            Wafer { name, held: Held::On(id, Pose::identity()), rests: Vec::new() }
        });
        let in_slot = cell.occupied.iter().copied().enumerate().map(|(k, slot)| (slot, k));
        Self { all: in_slots.chain(carried).collect(), in_slot: in_slot.collect(), step: 0 }
    }

    /// A track without samples for each wafer.
    fn tracks(&self) -> impl Iterator<Item = Track> {
        let named = self.all.iter().enumerate();
        named.map(|(k, wafer)| Track::new(&wafer.name, Part::Wafer(k), None))
    }

    /// Executes the hand-offs up to a time (s).
    fn until(&mut self, motion_export: &MotionExport<'_>, time: f64) -> Result<(), Error> {
        let motion = motion_export.motion;
        while self.step < motion.steps.len() && motion.times[self.step + 1] <= time {
            self.next_step(motion_export)?;
        }
        Ok(())
    }

    /// Executes the hand-off at the end of the next step: index of the wafer and its new slot, which is `None` for an effector.
    pub(super) fn next_step(
        &mut self,
        motion_export: &MotionExport<'_>,
    ) -> Result<Option<(usize, Option<SlotId>)>, Error> {
        let (motion, step) = (motion_export.motion, self.step);
        self.step += 1;
        let Some(handover) = motion.steps[step].handover else { return Ok(None) };
        let time = motion.times[step + 1];
        let at = motion.sample_at(time);
        // Until the hand-off the arm droops as in the step that ends.
        let pose = placed(motion_export, time, &at.positions, loaded(motion_export, step))?;
        Ok(self.hand_over(handover, &pose, [time, motion.duration()]))
    }

    /// Attaches the wafer to its new support at its current pose.
    fn hand_over(
        &mut self,
        handover: Handover,
        pose: &ChainPose,
        [time, end]: [f64; 2],
    ) -> Option<(usize, Option<SlotId>)> {
        let Self { all: wafers, in_slot, .. } = self;
        let effector = |id: EffectorId| pose.base_from_wafer[id.arm][id.effector];
        match handover {
            Handover::Picked(id, slot) => {
                let found = in_slot.iter().position(|&(one, _)| one == slot)?;
                let (_, k) = in_slot.remove(found);
                if let Held::InSlot(at) = wafers[k].held {
                    wafers[k].held = Held::On(id, effector(id).inverse() * at);
                }
                if let Some(lying) = wafers[k].rests.last_mut() {
                    lying.to = time;
                }
                Some((k, None))
            }
            Handover::Placed(id, slot) => {
                let on = |wafer: &Wafer| matches!(wafer.held, Held::On(with, _) if with == id);
                let k = wafers.iter().position(on)?;
                if let Held::On(_, at) = wafers[k].held {
                    wafers[k].held = Held::InSlot(effector(id) * at);
                    wafers[k].rests.push(RestingWafer { slot, from: time, to: end });
                    in_slot.push((slot, k));
                }
                Some((k, Some(slot)))
            }
        }
    }
}

/// A moving frame relative to its parent; named and nested as in [`gltf`](fn@super::gltf).
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Name of the frame.
    pub name: String,
    /// Origin in the parent (m).
    pub place: [f64; 3],
    /// Unit quaternion x, y, z, w in the parent.
    pub turn: [f64; 4],
}

/// Frames of the cell for other positions of the axes, with the wafers as at a time of the motion, and the effectors that carry a wafer then.
///
/// # Arguments
/// * `time` – time of the motion that determines the occupancy (s)
/// * `positions` – of all axes, rods first ((m), (rad))
///
/// # Errors
/// [`Error::Placing`]
pub fn frames(
    motion_export: &MotionExport<'_>,
    time: f64,
    positions: &[f64],
) -> Result<(Vec<Frame>, Vec<EffectorId>), Error> {
    let mut wafers = Wafers::new(motion_export);
    wafers.until(motion_export, time)?;
    let carried = wafers.all.iter().filter_map(|wafer| match wafer.held {
        Held::On(id, _) => Some(id),
        Held::InSlot(_) => None,
    });
    let carried: Vec<EffectorId> = carried.collect();
    let pose = placed(motion_export, time, positions, &carried)?;
    let frame = |mut track: Track| {
        track.push(&track.pose(motion_export.cell, &wafers.all, &pose));
        Frame { place: track.places[0], turn: track.turns[0], name: track.name }
    };
    let tracks = tracks(motion_export.cell).into_iter().chain(wafers.tracks());
    Ok((tracks.map(frame).collect(), carried))
}
