//! Moving frames of a cell with their trajectories: rods, platform, links, wafers.

use jointplay_cell::EntityId;
use jointplay_cell::program::{WaferLocations, WaferStay};
use jointplay_cell::robot::{ChainPose, EffectorId, RODS};
use jointplay_cell::station::SlotId;
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Pose;
use nalgebra::{SVector, UnitQuaternion, Vector4};

use super::error::Error;
use super::motion_export::MotionExport;
use super::sample_columns::RobotFrame;
use super::samples::{loaded, placed};
use super::wafer_frames::{WaferFrame, WaferFrames};

/// Interval before and after a sample over which rates are differences (s).
const MOMENT: f64 = 1e-5;

/// Differences of two neighbouring [`MOMENT`]s above this have a jump between them: an acceleration of 100 m/s² or 1/s² makes a difference of it (m, or parts of a quaternion).
const JUMP: f64 = 1e-8;

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
    /// Stays of a wafer in slots; empty for other parts.
    pub(super) slot_stays: Vec<SlotStay>,
    /// The pose of the last sample.
    last: Option<Pose>,
}

/// Rate of change of a pose in its parent.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Rate {
    /// Velocity of its origin (m/s).
    pub(super) place: [f64; 3],
    /// Derivative of its unit quaternion (1/s).
    pub(super) turn: [f64; 4],
}

/// Stay of a wafer in a slot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SlotStay {
    pub(super) slot: SlotId,
    /// Start and end (s).
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

impl Scene {
    /// The frames of a motion at given times.
    ///
    /// # Arguments
    /// * `times` – in growing order (s)
    /// * `with_rates` – whether to compute the rates
    pub(super) fn at_times(
        motion_export: &MotionExport<'_>,
        times: Vec<f64>,
        with_rates: bool,
    ) -> Result<Self, Error> {
        let MotionExport { cell, motion, .. } = *motion_export;
        let mut scene = Self { times, tracks: tracks(cell) };
        let mut wafers = WaferFrames::new(motion_export);
        scene.tracks.extend(wafer_tracks(cell, &wafers.locations));
        let found = scene.times.len() as f64 * scene.tracks.len() as f64;
        if found > MOST_POSES {
            return Err(Error::TooManyPoses { found, allowed: MOST_POSES });
        }
        for &time in &scene.times {
            let sample = motion.sample_at(time);
            wafers.advance_to(sample.time)?;
            let carried = loaded(motion_export, sample.step);
            let pose = |moment: f64| {
                let gone = sample.positions.iter().zip(&sample.velocities);
                let positions: Vec<f64> = gone.map(|(at, speed)| at + moment * speed).collect();
                placed(motion_export, sample.time, &positions, carried)
            };
            let now = pose(0.0)?;
            let moves = with_rates && sample.velocities.iter().any(|&speed| speed != 0.0);
            let near = if moves { Some([pose(-MOMENT)?, pose(MOMENT)?]) } else { None };
            for track in &mut scene.tracks {
                let here = track.pose(cell, &wafers.frames, &now);
                track.push(&here);
                match &near {
                    Some(near) if !track.rests(&wafers.frames) => {
                        let [before, after] =
                            near.each_ref().map(|it| track.pose(cell, &wafers.frames, it));
                        track.push_rate(&[before, here, after]);
                    }
                    _ if with_rates => track.rates.push(Rate::default()),
                    _ => {}
                }
            }
        }
        let mut slot_stays = slot_stays(motion_export, &wafers.locations);
        for track in &mut scene.tracks {
            if let Part::Wafer(k) = track.of {
                track.slot_stays = std::mem::take(&mut slot_stays[k]);
            }
        }
        Ok(scene)
    }
}

impl Track {
    fn new(name: &str, of: Part, parent: Option<usize>) -> Self {
        let name = name.to_owned();
        let (places, turns, rates) = (Vec::new(), Vec::new(), Vec::new());
        Self { name, of, parent, places, turns, rates, slot_stays: Vec::new(), last: None }
    }

    /// Where it is in its parent, the robot being posed like this.
    fn pose(&self, cell: &Cell, wafers: &[WaferFrame], pose: &ChainPose) -> Pose {
        let platform = &pose.platform;
        match self.of {
            Part::Rod(k) => RobotFrame::Rod(k).of(cell, pose),
            Part::Platform => platform.base_from_platform,
            Part::Link { arm, link: 0 } => {
                platform.base_from_platform.inverse() * pose.base_from_link[arm][0]
            }
            Part::Link { arm, link } => {
                let links = &pose.base_from_link[arm];
                links[link - 1].inverse() * links[link]
            }
            Part::Wafer(k) => wafers[k].base_from_wafer(pose),
        }
    }

    /// Whether it is a wafer in a slot, which does not move with the robot.
    fn rests(&self, wafers: &[WaferFrame]) -> bool {
        matches!(self.of, Part::Wafer(k) if wafers[k].location.slot().is_some())
    }

    fn push(&mut self, pose: &Pose) {
        // Most wafers do not move.
        if self.last.as_ref() == Some(pose) {
            self.places.extend_from_within(self.places.len() - 1..);
            self.turns.extend_from_within(self.turns.len() - 1..);
            return;
        }
        self.last = Some(*pose);
        let turn = self.turn(pose);
        // Rounded, so that frames at rest have equal poses.
        self.places.push(<[f64; 3]>::from(pose.translation.vector).map(|part| rounded(part, 1e9)));
        self.turns.push(<[f64; 4]>::from(turn).map(|part| rounded(part, 1e12)));
    }

    /// Adds the rate at the last pose, from the poses a [`MOMENT`] before, at, and after its time.
    fn push_rate(&mut self, poses: &[Pose; 3]) {
        if poses[0] == poses[1] && poses[1] == poses[2] {
            return self.rates.push(Rate::default());
        }
        let place = rate(poses.each_ref().map(|pose| pose.translation.vector));
        let turn = rate(poses.each_ref().map(|pose| self.turn(pose)));
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

/// Rate from the difference over both moments, or from the smaller of both one-sided differences at the edge of a droop table, where the droop jumps: the other one contains the jump.
fn rate<const N: usize>([before, now, after]: [SVector<f64, N>; 3]) -> [f64; N] {
    let (one, other) = (now - before, after - now);
    let gone = if (other - one).norm() < JUMP {
        (after - before) * 0.5
    } else if one.norm() < other.norm() {
        one
    } else {
        other
    };
    <[f64; N]>::from(gone / MOMENT).map(|part| rounded(part, 1e6))
}

/// A number to the nearest fraction.
pub(super) fn rounded(value: f64, fractions: f64) -> f64 {
    // Adding zero removes the sign of a negative zero, which would differ bit by bit.
    (value * fractions).round() / fractions + 0.0
}

#[cfg(feature = "mcap")]
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
            let name = cell.entity_name(EntityId::Link { arm: k, link });
            tracks.push(Track::new(&name, Part::Link { arm: k, link }, Some(parent)));
        }
    }
    tracks
}

/// Stays of all wafers in slots.
fn slot_stays(motion_export: &MotionExport<'_>, locations: &WaferLocations) -> Vec<Vec<SlotStay>> {
    let motion = motion_export.motion;
    let slot_stay = |stay: &WaferStay| {
        Some(SlotStay {
            slot: stay.location.slot()?,
            from: stay.arrival_step.map_or(0.0, |step| motion.times[step + 1]),
            to: stay.departure_step.map_or(motion.duration(), |step| motion.times[step + 1]),
        })
    };
    let stays = |wafer| locations.stays(wafer).iter().filter_map(slot_stay).collect();
    locations.wafers().map(stays).collect()
}

/// Tracks of all wafers, without samples.
fn wafer_tracks(cell: &Cell, locations: &WaferLocations) -> impl Iterator<Item = Track> {
    locations.wafers().map(|wafer| {
        Track::new(&cell.entity_name(locations.wafer_id(wafer)), Part::Wafer(wafer), None)
    })
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
    let mut wafers = WaferFrames::new(motion_export);
    wafers.advance_to(time)?;
    let carried = wafers.frames.iter().filter_map(|frame| frame.location.effector());
    let carried: Vec<EffectorId> = carried.collect();
    let pose = placed(motion_export, time, positions, &carried)?;
    let frame = |mut track: Track| {
        track.push(&track.pose(motion_export.cell, &wafers.frames, &pose));
        Frame { place: track.places[0], turn: track.turns[0], name: track.name }
    };
    let tracks = tracks(motion_export.cell)
        .into_iter()
        .chain(wafer_tracks(motion_export.cell, &wafers.locations));
    Ok((tracks.map(frame).collect(), carried))
}
