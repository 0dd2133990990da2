//! The robot moved by hand: as far as its limits let it go, and what stops it there.

use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::{Pose, Tilt, tilt_rotation};
use nalgebra::{Rotation3, Unit, Vector3};

use crate::robot::{EffectorId, LimitViolation, RODS, WaferTarget};
use crate::station::SlotId;
use crate::wafer::Unreachable;
use crate::workcell::Cell;
use crate::{CellError, EntityId};

/// How often the way to a place that cannot be reached is halved: what is left of it is a trillionth.
const HALVINGS: usize = 40;

/// Where the robot has come to.
#[derive(Debug, Clone, PartialEq)]
pub struct JogOutcome {
    /// Of all axes, rods first ([m], [rad]).
    pub positions: Vec<f64>,
    /// Why it is not where it was told to go.
    pub stopped: Option<Stopped>,
}

/// Why the robot does not come to a place.
#[derive(Debug, Clone, PartialEq)]
pub enum Stopped {
    /// The positions asked for break these limits.
    Limits(Vec<LimitViolation>),
    /// No positions bring the wafer there.
    Place(Unreachable),
    /// These two collision objects would touch farther on.
    Contact([EntityId; 2]),
}

/// A wafer as seen from a slot, in cylinder coordinates about the axis that the arm turns about.
///
/// ```text
///    the wafer is in the slot where all are zero, its x axis then pointing inward
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SlotRelativePose {
    /// How much farther from the axis than the slot its centre is, negative before the slot [m].
    pub radial: f64,
    /// Angle about the axis from the slot to its centre [rad].
    pub turn: f64,
    /// How far its centre is above the plane that wafers rest on in the slot [m].
    pub height: f64,
    /// Where it heads, from the slot's inward direction [rad].
    pub yaw: f64,
}

/// A slot with the axis that it is seen from.
struct View {
    frame: Pose,
    normal: Vector3<f64>,
    /// Where the axis crosses the slot's plane.
    axis: Vector3<f64>,
    /// From there to the slot.
    out: Vector3<f64>,
}

impl View {
    fn seen(&self, wafer: &Pose) -> SlotRelativePose {
        let Self { frame, normal, axis, out } = self;
        let beside = wafer.translation.vector - axis;
        let height = normal.dot(&beside);
        let within = beside - normal * height;
        let ahead = wafer.rotation * Vector3::x();
        let (inward, across) = (frame.rotation * Vector3::y(), -(frame.rotation * Vector3::x()));
        SlotRelativePose {
            radial: within.norm() - out.norm(),
            turn: normal.dot(&out.cross(&within)).atan2(out.dot(&within)),
            height,
            yaw: ahead.dot(&across).atan2(ahead.dot(&inward)),
        }
    }

    fn target(&self, from_slot: &SlotRelativePose, normal: Vector3<f64>) -> WaferTarget {
        let SlotRelativePose { radial, turn, height, yaw } = *from_slot;
        let about = |angle| Rotation3::from_axis_angle(&Unit::new_unchecked(self.normal), angle);
        let out = self.out.try_normalize(f64::MIN_POSITIVE);
        let out = out.unwrap_or_else(|| self.frame.rotation * Vector3::y());
        let within = about(turn) * out * (self.out.norm() + radial);
        let ahead = about(yaw) * (self.frame.rotation * Vector3::y());
        let level = tilt_rotation(&normal).inverse() * ahead;
        WaferTarget {
            center: self.axis + within + self.normal * height,
            normal,
            heading: Some(level.y.atan2(level.x)),
        }
    }
}

impl Cell {
    /// All axes toward positions: each motor up to its stops, the rods the straight way up to their limits and that of the tilt.
    ///
    /// # Arguments
    /// * `from`, `to` – positions of all axes, rods first ([m], [rad])
    ///
    /// # Errors
    /// [`CellError::WrongLength`], [`CellError::NotFinite`]
    pub fn jog_axes(&self, from: &[f64], to: &[f64]) -> Result<JogOutcome, CellError> {
        let robot = &self.robot;
        robot.limit_violations(from)?;
        let broken = robot.limit_violations(to)?;
        let mut positions = to.to_vec();
        for (position, axis) in positions.iter_mut().zip(&robot.axes).skip(RODS) {
            *position = position.clamp(axis.min, axis.max);
        }
        let rods = |all: &[f64]| [all[0], all[1], all[2]];
        positions[..RODS].copy_from_slice(&robot.gpr.clamp_to_limits(&rods(from), &rods(to)));
        let stopped = (!broken.is_empty()).then_some(Stopped::Limits(broken));
        Ok(JogOutcome { positions, stopped })
    }

    /// The platform toward a tilt and a height, the motors staying as they are.
    ///
    /// # Errors
    /// As [`Self::jog_axes`], and those of the robot's inverse.
    pub fn jog_platform(
        &self,
        from: &[f64],
        tilt: Tilt,
        height: AxisHeight,
    ) -> Result<JogOutcome, CellError> {
        let mut to = from.to_vec();
        self.robot.limit_violations(from)?;
        to[..RODS].copy_from_slice(&self.robot.gpr.inverse(tilt, height)?);
        self.jog_axes(from, &to)
    }

    /// The wafer of an effector straight toward a place in the base frame, its plane turning evenly, droop made up for as by [`Self::reach`].
    ///
    /// # Arguments
    /// * `from` – positions of all axes that the robot is at
    /// * `loaded` – whether the effector carries a wafer
    ///
    /// Where the robot is at the start, nothing has to be known of the droop.
    ///
    /// # Errors
    /// Those of the robot's kinematics, and numbers that are none.
    pub fn jog_wafer(
        &self,
        from: &[f64],
        effector: EffectorId,
        loaded: bool,
        to: &WaferTarget,
    ) -> Result<JogOutcome, Unreachable> {
        let (pose, _) = self.wafer_pose_or_rigid(effector, from, loaded)?;
        let start = WaferTarget::of(&pose);
        let way = |share: f64| WaferTarget {
            center: start.center.lerp(&to.center, share),
            normal: start.normal.lerp(&to.normal.normalize(), share),
            heading: match (start.heading, to.heading) {
                (Some(from), Some(to)) => Some(from + share * shortest(to - from)),
                _ => to.heading,
            },
        };
        self.jog_along(from, effector, loaded, way)
    }

    /// The wafer of an effector toward a place as seen from a slot, its plane becoming that of the slot.
    ///
    /// # Errors
    /// As [`Self::jog_wafer`].
    ///
    /// # Panics
    /// If the cell has no such station.
    pub fn jog_slot_relative(
        &self,
        from: &[f64],
        effector: EffectorId,
        loaded: bool,
        slot: SlotId,
        to: &SlotRelativePose,
    ) -> Result<JogOutcome, Unreachable> {
        let (pose, _) = self.wafer_pose_or_rigid(effector, from, loaded)?;
        let view = self.view(effector, slot);
        let (start, normal) = (view.seen(&pose), pose.rotation * Vector3::z());
        let between = |from: f64, to: f64, share: f64| from + share * (to - from);
        let turned = |from: f64, to: f64, share: f64| from + share * shortest(to - from);
        let free = self.robot.heading_is_free(effector)?;
        let way = |share: f64| {
            let part = SlotRelativePose {
                radial: between(start.radial, to.radial, share),
                turn: turned(start.turn, to.turn, share),
                height: between(start.height, to.height, share),
                yaw: turned(start.yaw, to.yaw, share),
            };
            let mut target = view.target(&part, normal.lerp(&view.normal, share).normalize());
            target.heading = target.heading.filter(|_| free);
            target
        };
        self.jog_along(from, effector, loaded, way)
    }

    /// A wafer of an effector as seen from a slot.
    ///
    /// # Arguments
    /// * `wafer` – where it is in the base frame, as [`Self::wafer_pose`] tells
    ///
    /// # Panics
    /// If the cell has no such station.
    #[must_use]
    pub fn slot_relative_pose(
        &self,
        wafer: &Pose,
        effector: EffectorId,
        slot: SlotId,
    ) -> SlotRelativePose {
        self.view(effector, slot).seen(wafer)
    }

    /// A slot that cannot be reached is seen from the robot's own axis.
    fn view(&self, effector: EffectorId, slot: SlotId) -> View {
        let frame = self.stations[slot.station].slot_frame(slot.slot);
        let (center, normal) = (frame.translation.vector, frame.rotation * Vector3::z());
        let home: Vec<f64> = self.robot.axes.iter().map(|axis| axis.home).collect();
        let axis = self.turning_axis(effector, slot, &home).unwrap_or_else(|_| {
            Vector3::z() * (center.z + (normal.x * center.x + normal.y * center.y) / normal.z)
        });
        View { frame, normal, axis, out: center - axis }
    }

    /// As far along a way as there are positions for it.
    fn jog_along(
        &self,
        from: &[f64],
        effector: EffectorId,
        loaded: bool,
        way: impl Fn(f64) -> WaferTarget,
    ) -> Result<JogOutcome, Unreachable> {
        let why = match self.reach(effector, &way(1.0), loaded, from) {
            Ok(reached) => return Ok(JogOutcome { positions: reached.positions, stopped: None }),
            Err(Unreachable::Robot(error)) => return Err(Unreachable::Robot(error)),
            Err(why) => why,
        };
        let mut positions = from.to_vec();
        let (mut near, mut far) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let share = 0.5 * (near + far);
            match self.reach(effector, &way(share), loaded, from) {
                Ok(reached) => (positions, near) = (reached.positions, share),
                Err(_) => far = share,
            }
        }
        Ok(JogOutcome { positions, stopped: Some(Stopped::Place(why)) })
    }
}

/// The same turn by at most half a revolution [rad].
fn shortest(angle: f64) -> f64 {
    let turns = (angle / std::f64::consts::TAU).round();
    angle - turns * std::f64::consts::TAU
}
