//! Jogging: interactive motion of the robot up to its limits, and the reason of a stop.

use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::{Pose, Tilt, tilt_rotation, wrap_angle};
use nalgebra::{Rotation3, Unit, Vector3};

use crate::robot::{EffectorId, LimitViolation, RODS, Redundancy, WaferTarget};
use crate::station::SlotId;
use crate::wafer::Unreachable;
use crate::workcell::Cell;
use crate::{CellError, EntityId};

/// Bisections of the path to an unreachable target: the rest is 2⁻⁴⁰ of it.
const BISECTIONS: usize = 40;

/// Positions after a jog, and why it stopped.
#[derive(Debug, Clone, PartialEq)]
pub struct JogOutcome {
    /// Positions of all axes, rods first (m or rad).
    pub positions: Vec<f64>,
    /// Why the target was not reached; `None` if it was.
    pub stopped: Option<StopReason>,
}

/// Why a jog stops before its target.
#[derive(Debug, Clone, PartialEq)]
pub enum StopReason {
    /// The target violates these limits.
    Limits(Vec<LimitViolation>),
    /// No axis positions exist for the target.
    Unreachable(Unreachable),
    /// These two collision objects would touch beyond.
    Contact([EntityId; 2]),
}

/// Pose of a wafer relative to a slot, in cylindrical coordinates about the axis of the arm's first joint.
///
/// ```text
///    the wafer is in the slot where all coordinates are zero; its x axis then points inward
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SlotRelativePose {
    /// Distance of its centre from the axis less that of the slot; negative in front of the slot (m).
    pub radial: f64,
    /// Angle about the axis from the slot to its centre (rad).
    pub turn: f64,
    /// Height of its centre above the resting plane of the slot (m).
    pub height: f64,
    /// Heading relative to the slot's inward direction (rad).
    pub heading: f64,
}

/// Frame of a slot and the axis of the cylindrical coordinates.
struct SlotFrame {
    frame: Pose,
    normal: Vector3<f64>,
    /// Intersection of the axis with the slot's plane (m).
    axis: Vector3<f64>,
    /// Vector from there to the slot (m).
    out: Vector3<f64>,
}

impl SlotFrame {
    fn relative_pose(&self, wafer: &Pose) -> SlotRelativePose {
        let Self { frame, normal, axis, out } = self;
        let offset = wafer.translation.vector - axis;
        let height = normal.dot(&offset);
        let within = offset - normal * height;
        let ahead = wafer.rotation * Vector3::x();
        let (inward, across) = (frame.rotation * Vector3::y(), -(frame.rotation * Vector3::x()));
        SlotRelativePose {
            radial: within.norm() - out.norm(),
            turn: normal.dot(&out.cross(&within)).atan2(out.dot(&within)),
            height,
            heading: ahead.dot(&across).atan2(ahead.dot(&inward)),
        }
    }

    fn target(&self, from_slot: &SlotRelativePose, normal: Vector3<f64>) -> WaferTarget {
        let SlotRelativePose { radial, turn, height, heading } = *from_slot;
        let about = |angle| Rotation3::from_axis_angle(&Unit::new_unchecked(self.normal), angle);
        let out = self.out.try_normalize(f64::MIN_POSITIVE);
        let out = out.unwrap_or_else(|| self.frame.rotation * Vector3::y());
        let within = about(turn) * out * (self.out.norm() + radial);
        let ahead = about(heading) * (self.frame.rotation * Vector3::y());
        let level = tilt_rotation(&normal).inverse() * ahead;
        WaferTarget {
            center: self.axis + within + self.normal * height,
            normal,
            heading: Some(level.y.atan2(level.x)),
        }
    }
}

impl Cell {
    /// Moves all axes toward positions: each motor up to its limits, the rods along a straight line up to their limits and that of the tilt.
    ///
    /// # Arguments
    /// * `from`, `to` – positions of all axes, rods first (m or rad)
    ///
    /// # Errors
    /// [`CellError::LengthMismatch`], [`CellError::NotFinite`]
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
        let stopped = (!broken.is_empty()).then_some(StopReason::Limits(broken));
        Ok(JogOutcome { positions, stopped })
    }

    /// Moves the platform toward a tilt and a height; the motors of the arms do not move.
    ///
    /// # Arguments
    /// * `from` – present positions of all axes, rods first (m or rad)
    /// * `height` – height at which the platform plane crosses the base axis
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

    /// Moves the wafer of an effector along a straight line toward a target in the base frame, its plane rotating evenly, with droop compensated as by [`Self::compensated_inverse`].
    ///
    /// A redundant arm takes the posture nearest to the present one.
    /// Where the droop at the start is unknown, the line starts at the pose of the wafer on the rigid arm.
    ///
    /// # Arguments
    /// * `from` – present positions of all axes, rods first (m or rad)
    /// * `loaded` – whether the effector holds a wafer
    /// * `to` – target at the end of the line
    ///
    /// # Errors
    /// Those of the robot's kinematics, and numbers that are not finite.
    pub fn jog_wafer(
        &self,
        from: &[f64],
        effector: EffectorId,
        loaded: bool,
        to: &WaferTarget,
    ) -> Result<JogOutcome, Unreachable> {
        let (pose, _) = self.wafer_pose_or_rigid(effector, from, loaded)?;
        let start = WaferTarget::from_pose(&pose);
        let path = |fraction: f64| WaferTarget {
            center: start.center.lerp(&to.center, fraction),
            normal: start.normal.lerp(&to.normal.normalize(), fraction),
            heading: match (start.heading, to.heading) {
                (Some(from), Some(to)) => Some(from + fraction * wrap_angle(to - from)),
                _ => to.heading,
            },
        };
        self.jog_along(from, effector, loaded, path)
    }

    /// Moves the wafer of an effector toward a pose relative to a slot; its plane becomes that of the slot.
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
        let view = self.slot_view(effector, slot);
        let (start, normal) = (view.relative_pose(&pose), pose.rotation * Vector3::z());
        let between = |from: f64, to: f64, fraction: f64| from + fraction * (to - from);
        let turned = |from: f64, to: f64, fraction: f64| from + fraction * wrap_angle(to - from);
        let free = self.robot.heading_is_free(effector)?;
        let path = |fraction: f64| {
            let part = SlotRelativePose {
                radial: between(start.radial, to.radial, fraction),
                turn: turned(start.turn, to.turn, fraction),
                height: between(start.height, to.height, fraction),
                heading: turned(start.heading, to.heading, fraction),
            };
            let mut target = view.target(&part, normal.lerp(&view.normal, fraction).normalize());
            target.heading = target.heading.filter(|_| free);
            target
        };
        self.jog_along(from, effector, loaded, path)
    }

    /// Pose of a wafer relative to a slot.
    ///
    /// # Arguments
    /// * `wafer` – its pose in the base frame, as by [`Self::wafer_pose`]
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
        self.slot_view(effector, slot).relative_pose(wafer)
    }

    /// Frame of a slot, with the axis of the arm's first joint; for an unreachable slot, with the base axis.
    fn slot_view(&self, effector: EffectorId, slot: SlotId) -> SlotFrame {
        let frame = self.stations[slot.station].slot_frame(slot.slot);
        let (center, normal) = (frame.translation.vector, frame.rotation * Vector3::z());
        let home: Vec<f64> = self.robot.axes.iter().map(|axis| axis.home).collect();
        let axis = self.shoulder_point(effector, slot, &home).unwrap_or_else(|_| {
            Vector3::z() * (center.z + (normal.x * center.x + normal.y * center.y) / normal.z)
        });
        SlotFrame { frame, normal, axis, out: center - axis }
    }

    /// Moves along a path as far as axis positions exist for it.
    fn jog_along(
        &self,
        from: &[f64],
        effector: EffectorId,
        loaded: bool,
        path: impl Fn(f64) -> WaferTarget,
    ) -> Result<JogOutcome, Unreachable> {
        let solve = |fraction| {
            let (target, redundancy) = (path(fraction), Redundancy::NearestToPresent);
            self.compensated_inverse_by(effector, &target, loaded, from, redundancy)
        };
        let why = match solve(1.0) {
            Ok(reached) => return Ok(JogOutcome { positions: reached.positions, stopped: None }),
            Err(Unreachable::Robot(error)) => return Err(Unreachable::Robot(error)),
            Err(why) => why,
        };
        let mut positions = from.to_vec();
        let (mut near, mut far) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let fraction = 0.5 * (near + far);
            match solve(fraction) {
                Ok(reached) => (positions, near) = (reached.positions, fraction),
                Err(_) => far = fraction,
            }
        }
        Ok(JogOutcome { positions, stopped: Some(StopReason::Unreachable(why)) })
    }
}
