//! What makes a robot.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::planar::Planar;
use super::{Arm, Axis, EffectorId, HybridRobot, MAX_ARMS, MAX_AXES, MAX_JOINTS, MotionKind, RODS};
use crate::CellError;

/// Most effectors of an arm.
const MAX_EFFECTORS: usize = 4;

/// Widest range of a turning axis: ten turns [rad].
const WIDEST_TURN: f64 = 10.0 * std::f64::consts::TAU;

/// Velocities whose parallelogram is flatter than this share of their squares have one direction.
const FLAT: f64 = 1e-9;

impl MotionKind {
    /// `m` or `rad`.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Turn => "rad",
            Self::Slide => "m",
        }
    }
}

impl HybridRobot {
    /// The robot, if it is one: names are unique, counts possible, numbers finite, limits in order, home positions within them, and each arm can be moved in its plane.
    ///
    /// All other functions of a robot take this for granted, and may panic on one that was never checked.
    ///
    /// # Errors
    /// Of [`CellError`], the first fault found.
    pub fn checked(self) -> Result<Self, CellError> {
        if self.name.trim().is_empty() {
            return Err(CellError::NoName { what: "the robot".to_owned() });
        }
        count("arms", self.arms.len(), 1, MAX_ARMS)?;
        count("axes, rods included", self.axes.len(), RODS + 1, MAX_AXES)?;
        unique("axes", self.axes.iter().map(|axis| &axis.name))?;
        unique("arms", self.arms.iter().map(|arm| &arm.name))?;
        let effectors = self.arms.iter().flat_map(|arm| &arm.effectors);
        unique("effectors", effectors.map(|effector| &effector.name))?;
        for (index, axis) in self.axes.iter().enumerate() {
            self.check_axis_of(index, axis)?;
        }
        let home = [0, 1, 2].map(|rod| self.axes[rod].home);
        let pitch = self.gpr.plane_tilt(&home).pitch;
        let max = self.gpr.limits().tilt_max;
        if pitch > max {
            let what = "the tilt of the home position".to_owned();
            return Err(CellError::OutOfRange { what, value: pitch, min: 0.0, max, unit: "rad" });
        }
        for (index, arm) in self.arms.iter().enumerate() {
            self.check_arm(index, arm)?;
        }
        for (index, axis) in self.axes.iter().enumerate().skip(RODS) {
            let joints = self.arms.iter().flat_map(|arm| &arm.joints);
            let mut drives = joints.flat_map(|joint| &joint.drives);
            if !drives.any(|&(driven, _)| driven == index) {
                return Err(CellError::IdleAxis { axis: axis.name.clone() });
            }
        }
        Ok(self)
    }

    fn check_axis_of(&self, index: usize, axis: &Axis) -> Result<(), CellError> {
        let Axis { name, kind, min, max, home, empty, loaded } = axis;
        let unit = kind.unit();
        let of = |what: &str| format!("the {what} of axis {name}");
        finite(of("least position"), *min)?;
        finite(of("largest position"), *max)?;
        finite(of("home position"), *home)?;
        if min >= max {
            let what = format!("axis {name}");
            return Err(CellError::LimitsReversed { what, min: *min, max: *max, unit });
        }
        in_range(of("home position"), *home, *min, *max, unit)?;
        if *kind == MotionKind::Turn {
            in_range(of("range"), max - min, 0.0, WIDEST_TURN, unit)?;
        }
        let units = match kind {
            MotionKind::Turn => ["rad/s", "rad/s²", "rad/s³"],
            MotionKind::Slide => ["m/s", "m/s²", "m/s³"],
        };
        let rows = [
            ("velocity", empty.velocity, loaded.velocity),
            ("acceleration", empty.acceleration, loaded.acceleration),
            ("jerk", empty.jerk, loaded.jerk),
        ];
        for ((what, empty, loaded), unit) in rows.into_iter().zip(units) {
            positive(of(&format!("{what} without a wafer")), empty, unit)?;
            positive(of(&format!("{what} with a wafer")), loaded, unit)?;
            in_range(of(&format!("{what} with a wafer")), loaded, 0.0, empty, unit)?;
        }
        if index < RODS {
            if *kind != MotionKind::Slide {
                let why = "the first three axes are those of the rods, and have to slide";
                return Err(CellError::WrongAxis { axis: name.clone(), why: why.to_owned() });
            }
            let limits = self.gpr.limits();
            let (least, most) = (limits.rod_min, limits.rod_max);
            in_range(of("least position"), *min, least, most, unit)?;
            in_range(of("largest position"), *max, least, most, unit)?;
        }
        Ok(())
    }

    fn check_arm(&self, index: usize, arm: &Arm) -> Result<(), CellError> {
        let of = |what: &str| format!("{what} of arm {}", arm.name);
        for value in arm.mount {
            finite(of("the mount"), value)?;
        }
        count(&of("joints"), arm.joints.len(), 1, MAX_JOINTS)?;
        count(&of("effectors"), arm.effectors.len(), 1, MAX_EFFECTORS)?;
        let mut motors = BTreeSet::new();
        for (k, joint) in arm.joints.iter().enumerate() {
            let of = |what: &str| format!("{what} of joint {} of arm {}", k + 1, arm.name);
            for (what, value) in [
                ("the zero", joint.zero),
                ("the length", joint.length),
                ("the offset", joint.offset),
                ("the rise", joint.rise),
            ] {
                finite(of(what), value)?;
            }
            count(&of("drives"), joint.drives.len(), 1, MAX_JOINTS)?;
            let mut driven = BTreeSet::new();
            for &(axis, ratio) in &joint.drives {
                if !(RODS..self.axes.len()).contains(&axis) {
                    return Err(CellError::NoSuch {
                        what: of("a drive"),
                        kind: "axis",
                        index: axis,
                        min: RODS,
                        max: self.axes.len() - 1,
                    });
                }
                let Axis { name, kind, .. } = &self.axes[axis];
                if finite(of("a ratio"), ratio)? == 0.0 {
                    let why = format!("{} is zero; leave it out", of("its ratio to the value"));
                    return Err(CellError::WrongAxis { axis: name.clone(), why });
                }
                if !driven.insert(axis) {
                    let why = format!("it drives {} twice; add the ratios", of("the value"));
                    return Err(CellError::WrongAxis { axis: name.clone(), why });
                }
                if *kind != joint.kind {
                    let why = format!(
                        "its position is in {}, but {} is in {}",
                        kind.unit(),
                        of("the value"),
                        joint.kind.unit()
                    );
                    return Err(CellError::WrongAxis { axis: name.clone(), why });
                }
                motors.insert(axis);
            }
        }
        // More could not be told apart, and their positions would be anyone's choice.
        count(&of("motors"), motors.len(), 1, arm.joints.len())?;
        for (effector, found) in arm.effectors.iter().enumerate() {
            let of = |what: &str| format!("the {what} of effector {}", found.name);
            for value in found.wafer_center {
                finite(of("wafer's centre"), value)?;
            }
            finite(of("heading"), found.heading)?;
            if finite(of("friction"), found.friction)? < 0.0 {
                return Err(CellError::NotPositive {
                    what: of("friction"),
                    value: found.friction,
                    unit: "",
                });
            }
            let directions = self.directions(EffectorId { arm: index, effector });
            if directions < 2 {
                return Err(CellError::NotMovable {
                    arm: arm.name.clone(),
                    effector: found.name.clone(),
                    directions,
                });
            }
        }
        Ok(())
    }

    /// Independent directions in which an effector's motors move its wafer, the most over a few positions.
    fn directions(&self, id: EffectorId) -> usize {
        let planar = Planar::new(self, id);
        let axes = planar.axes();
        let at = |share: f64| {
            let mut own = [0.0; MAX_JOINTS];
            for (k, (own, &axis)) in own.iter_mut().zip(axes).enumerate() {
                // Unlike shares, so that no arm is stretched by all of them.
                let share = (share + 0.211 * k as f64).fract();
                *own = self.axes[axis].min + share * (self.axes[axis].max - self.axes[axis].min);
            }
            let velocities = planar.tip_velocities(&own);
            let largest = velocities.iter().map(Vector2::norm_squared).fold(0.0, f64::max);
            let flat = |one: &Vector2<f64>| {
                velocities.iter().all(|other| one.perp(other).abs() <= FLAT * largest)
            };
            match largest {
                0.0 => 0,
                _ if velocities.iter().all(flat) => 1,
                _ => 2,
            }
        };
        [0.31, 0.47, 0.62, 0.83].into_iter().map(at).max().unwrap_or(0)
    }
}

fn finite(what: String, value: f64) -> Result<f64, CellError> {
    if value.is_finite() { Ok(value) } else { Err(CellError::NotFinite { what, value }) }
}

fn positive(what: String, value: f64, unit: &'static str) -> Result<(), CellError> {
    if finite(what.clone(), value)? > 0.0 {
        Ok(())
    } else {
        Err(CellError::NotPositive { what, value, unit })
    }
}

fn in_range(
    what: String,
    value: f64,
    min: f64,
    max: f64,
    unit: &'static str,
) -> Result<(), CellError> {
    if (min..=max).contains(&value) {
        Ok(())
    } else {
        Err(CellError::OutOfRange { what, value, min, max, unit })
    }
}

fn count(what: &str, found: usize, min: usize, max: usize) -> Result<(), CellError> {
    if (min..=max).contains(&found) {
        Ok(())
    } else {
        Err(CellError::Count { what: what.to_owned(), found, min, max })
    }
}

fn unique<'a>(
    what: &'static str,
    names: impl Iterator<Item = &'a String>,
) -> Result<(), CellError> {
    let mut known = BTreeSet::new();
    for name in names {
        if name.trim().is_empty() {
            return Err(CellError::NoName { what: format!("one of the {what}") });
        }
        if !known.insert(name) {
            return Err(CellError::NameTwice { what, name: name.clone() });
        }
    }
    Ok(())
}
