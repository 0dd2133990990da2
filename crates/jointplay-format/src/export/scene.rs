//! What moves in a cell, as frames with their ways: rods, platform, links, wafers.

use jointplay_cell::cell::Cell;
use jointplay_cell::program::Handover;
use jointplay_cell::robot::{ChainPose, EffectorId, RODS};
use jointplay_cell::station::SlotId;
use jointplay_core::spatial::Pose;
use nalgebra::{UnitQuaternion, Vector3};

use super::samples::{loaded, placed};
use super::{Error, Recording};

/// A frame that may move.
pub(super) struct Track {
    pub(super) name: String,
    /// What it is of.
    pub(super) of: Part,
    /// Index of the track that its poses are told in; `None` for the base.
    pub(super) parent: Option<usize>,
    /// Origin in the parent, at each time [m].
    pub(super) places: Vec<[f64; 3]>,
    /// Unit quaternion x, y, z, w in the parent, at each time; neighbours on the same side.
    pub(super) turns: Vec<[f64; 4]>,
    /// Of a wafer: in which slots it lies, and when.
    pub(super) lies: Vec<Lying>,
}

/// A wafer lying in a slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lying {
    pub(super) slot: SlotId,
    /// From when on, and until when [s].
    pub(super) from: f64,
    pub(super) to: f64,
}

/// What a track is of.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Part {
    Rod(usize),
    Platform,
    Link { arm: usize, link: usize },
    Wafer,
}

/// All frames that move.
pub(super) struct Scene {
    /// [s].
    pub(super) times: Vec<f64>,
    /// Parents before children.
    pub(super) tracks: Vec<Track>,
}

/// Where a wafer is.
#[derive(Clone, Copy)]
enum Held {
    /// Lying somewhere, in the base frame.
    Lying(Pose),
    /// On an effector, in its wafer frame.
    On(EffectorId, Pose),
}

struct Wafer {
    name: String,
    held: Held,
    lies: Vec<Lying>,
}

impl Wafer {
    /// Where it is, the robot being posed like this.
    fn place(&self, pose: &ChainPose) -> Pose {
        match self.held {
            Held::Lying(at) => at,
            Held::On(id, at) => pose.base_from_wafer[id.arm][id.effector] * at,
        }
    }
}

impl Scene {
    /// The frames of a motion at even times and at its end.
    pub(super) fn of(recording: &Recording<'_>, rate: f64) -> Result<Self, Error> {
        recording.check_rate(rate)?;
        let Recording { cell, motion, .. } = *recording;
        let mut scene = Self { times: Vec::new(), tracks: tracks(cell) };
        let mut wafers = Wafers::new(recording);
        let first = scene.tracks.len();
        let tracks = wafers.all.iter().map(|wafer| Track::new(&wafer.name, Part::Wafer, None));
        scene.tracks.extend(tracks);
        for sample in motion.samples(rate) {
            wafers.until(recording, sample.time)?;
            let pose =
                placed(recording, sample.time, &sample.positions, loaded(recording, sample.step))?;
            scene.times.push(sample.time);
            scene.place_robot(cell, &pose);
            for (track, wafer) in scene.tracks[first..].iter_mut().zip(&wafers.all) {
                track.push(&wafer.place(&pose));
            }
        }
        for (track, wafer) in scene.tracks[first..].iter_mut().zip(wafers.all) {
            track.lies = wafer.lies;
        }
        Ok(scene)
    }

    fn place_robot(&mut self, cell: &Cell, pose: &ChainPose) {
        let platform = &pose.platform;
        for track in &mut self.tracks {
            let at = match track.of {
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
                Part::Wafer => continue,
            };
            track.push(&at);
        }
    }
}

impl Track {
    fn new(name: &str, of: Part, parent: Option<usize>) -> Self {
        let name = name.to_owned();
        Self { name, of, parent, places: Vec::new(), turns: Vec::new(), lies: Vec::new() }
    }

    fn push(&mut self, pose: &Pose) {
        let place: Vector3<f64> = pose.translation.vector;
        let turn = UnitQuaternion::from_rotation_matrix(&pose.rotation).into_inner().coords;
        let mut turn: [f64; 4] = turn.into();
        // q and −q are one rotation; what is interpolated between must not go the long way round.
        if let Some(last) = self.turns.last() {
            let dot: f64 = last.iter().zip(&turn).map(|(a, b)| a * b).sum();
            if dot < 0.0 {
                turn = turn.map(|part| -part);
            }
        }
        // What does not move is told as such, round-off or not.
        self.places.push(<[f64; 3]>::from(place).map(|part| rounded(part, 1e9)));
        self.turns.push(turn.map(|part| rounded(part, 1e12)));
    }
}

/// A number to the nearest fraction.
fn rounded(value: f64, fractions: f64) -> f64 {
    // Without a minus before a zero, which would be another number than zero for those who compare bits.
    (value * fractions).round() / fractions + 0.0
}

/// Whether sample `k` of a series has to be told for the rest to follow by straight interpolation: the ends, and wherever it differs from a neighbour.
pub(super) fn is_key<T: PartialEq>(series: &[T], k: usize) -> bool {
    k == 0 || k + 1 == series.len() || series[k] != series[k - 1] || series[k] != series[k + 1]
}

/// Frames of the robot, nowhere yet.
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
struct Wafers {
    all: Vec<Wafer>,
    in_slot: Vec<(SlotId, usize)>,
    /// The step that may hand one over next.
    step: usize,
}

impl Wafers {
    /// Where they are at the start.
    fn new(recording: &Recording<'_>) -> Self {
        let (cell, to) = (recording.cell, recording.motion.duration());
        let in_slots = cell.occupied.iter().map(|&slot| {
            let station = &cell.stations[slot.station];
            let name = format!("wafer of {} {}", station.name, slot.slot);
            let held = Held::Lying(station.slot_frame(slot.slot));
            Wafer { name, held, lies: vec![Lying { slot, from: 0.0, to }] }
        });
        let carried = cell.carried.iter().map(|&id| {
            let name = format!("wafer of {}", recording.effector_name(id));
            Wafer { name, held: Held::On(id, Pose::identity()), lies: Vec::new() }
        });
        let in_slot = cell.occupied.iter().copied().enumerate().map(|(k, slot)| (slot, k));
        Self { all: in_slots.chain(carried).collect(), in_slot: in_slot.collect(), step: 0 }
    }

    /// Hands over what is handed over until a time [s].
    fn until(&mut self, recording: &Recording<'_>, time: f64) -> Result<(), Error> {
        let motion = recording.motion;
        while self.step < motion.steps.len() && motion.times[self.step + 1] <= time {
            if let Some(handover) = motion.steps[self.step].handover {
                let time = motion.times[self.step + 1];
                let at = motion.at(time);
                // Up to then the arm droops as in the step that ends.
                let pose = placed(recording, time, &at.positions, loaded(recording, self.step))?;
                self.hand_over(handover, &pose, [time, motion.duration()]);
            }
            self.step += 1;
        }
        Ok(())
    }

    /// From then on the wafer moves with what holds it, from exactly where it is.
    fn hand_over(&mut self, handover: Handover, pose: &ChainPose, [time, end]: [f64; 2]) {
        let Self { all: wafers, in_slot, .. } = self;
        let effector = |id: EffectorId| pose.base_from_wafer[id.arm][id.effector];
        match handover {
            Handover::Taken(id, slot) => {
                let Some(found) = in_slot.iter().position(|&(one, _)| one == slot) else { return };
                let (_, k) = in_slot.remove(found);
                if let Held::Lying(at) = wafers[k].held {
                    wafers[k].held = Held::On(id, effector(id).inverse() * at);
                }
                if let Some(lying) = wafers[k].lies.last_mut() {
                    lying.to = time;
                }
            }
            Handover::Left(id, slot) => {
                let on = |wafer: &Wafer| matches!(wafer.held, Held::On(with, _) if with == id);
                let Some(k) = wafers.iter().position(on) else { return };
                if let Held::On(_, at) = wafers[k].held {
                    wafers[k].held = Held::Lying(effector(id) * at);
                    wafers[k].lies.push(Lying { slot, from: time, to: end });
                    in_slot.push((slot, k));
                }
            }
        }
    }
}

/// A frame that moves, in the one that it moves with; named and nested as in [`gltf`](fn@super::gltf).
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// What it is called.
    pub name: String,
    /// Its origin [m].
    pub place: [f64; 3],
    /// Its unit quaternion x, y, z, w.
    pub turn: [f64; 4],
}

/// Where all would be at a moment of the motion if the axes stood elsewhere, and who carries a wafer then.
///
/// # Arguments
/// * `time` – the moment that tells which wafers are where [s]
/// * `positions` – of all axes, rods first ([m], [rad])
///
/// # Errors
/// [`Error::Placing`]
pub fn frames(
    recording: &Recording<'_>,
    time: f64,
    positions: &[f64],
) -> Result<(Vec<Frame>, Vec<EffectorId>), Error> {
    let mut wafers = Wafers::new(recording);
    wafers.until(recording, time)?;
    let carried = wafers.all.iter().filter_map(|wafer| match wafer.held {
        Held::On(id, _) => Some(id),
        Held::Lying(_) => None,
    });
    let carried: Vec<EffectorId> = carried.collect();
    let pose = placed(recording, time, positions, &carried)?;
    let mut scene = Scene { times: Vec::new(), tracks: tracks(recording.cell) };
    scene.place_robot(recording.cell, &pose);
    for wafer in &wafers.all {
        let mut track = Track::new(&wafer.name, Part::Wafer, None);
        track.push(&wafer.place(&pose));
        scene.tracks.push(track);
    }
    let frame =
        |track: Track| Frame { place: track.places[0], turn: track.turns[0], name: track.name };
    Ok((scene.tracks.into_iter().map(frame).collect(), carried))
}
