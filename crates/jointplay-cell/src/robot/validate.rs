//! Conditions that the description of a robot has to fulfil.

use std::collections::BTreeSet;

use nalgebra::Vector2;

use super::arm_chain::ArmChain;
use super::hybrid_robot::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, MAX_ARMS, MAX_AXES,
    MAX_EFFECTORS, MAX_JOINTS, RODS,
};
use crate::CellError;
use crate::conditions::{count, finite, in_range, positive, unique};
use crate::wafer::Droop;

/// Largest range of a rotary axis: ten revolutions (rad).
const MAX_ROTATION: f64 = 10.0 * std::f64::consts::TAU;

/// Least difference of reach between rows of a droop table (m).
const MIN_ROW_SPACING: f64 = 1e-6;
/// Largest reach of a droop table (m).
const MAX_REACH: f64 = 100.0;

/// Fraction of their squares below which the parallelogram of two velocities is flat: they have one direction.
const MIN_RELATIVE_AREA: f64 = 1e-9;

impl AxisKind {
    /// Unit of positions: `m` or `rad`.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Rotary => "rad",
            Self::Linear => "m",
        }
    }

    fn verb(self) -> &'static str {
        match self {
            Self::Rotary => "turns",
            Self::Linear => "slides",
        }
    }
}

/// Part of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RobotPart {
    /// The whole robot.
    Robot,
    /// An axis, by index.
    Axis(usize),
    /// An arm, by index.
    Arm(usize),
    /// A joint of an arm, both by index.
    Joint(usize, usize),
    /// An effector of an arm, both by index.
    Effector(usize, usize),
}

type Fault = (RobotPart, Box<CellError>);

impl RobotPart {
    fn at_fault(self) -> impl Fn(CellError) -> Fault {
        move |error| (self, Box::new(error))
    }
}

impl HybridRobot {
    /// The robot with its conditions checked: names are unique, counts possible, numbers finite, limits in order, home positions within them, and each arm can move its wafers in its plane.
    ///
    /// All other functions of a robot assume these conditions, and may panic on a robot that was never checked.
    /// The limit checks of the returned robot's [`gpr`](Self::gpr) are switched off: [`Self::limit_violations`] checks the limits of axes and tilt for whole sets of positions.
    ///
    /// # Errors
    /// [`CellError`] of the first condition that is violated.
    pub fn checked(self) -> Result<Self, CellError> {
        match self.check() {
            // Limits of axes and tilt are checked for whole sets of positions.
            Ok(()) => Ok(Self { gpr: self.gpr.without_limit_checks(), ..self }),
            Err((_, error)) => Err(*error),
        }
    }

    /// Checks the conditions of [`Self::checked`]; the error names the part that violates one.
    ///
    /// # Errors
    /// The first condition that is violated.
    pub fn check(&self) -> Result<(), (RobotPart, Box<CellError>)> {
        let whole = RobotPart::Robot.at_fault();
        if self.name.trim().is_empty() {
            return Err(whole(CellError::NoName { what: "the robot".to_owned() }));
        }
        count("arms", self.arms.len(), 1, MAX_ARMS).map_err(&whole)?;
        count("axes, rods included", self.axes.len(), RODS + 1, MAX_AXES).map_err(&whole)?;
        unique("axes", self.axes.iter().map(|axis| &axis.name))
            .map_err(|(index, error)| RobotPart::Axis(index).at_fault()(error))?;
        unique("arms", self.arms.iter().map(|arm| &arm.name))
            .map_err(|(index, error)| RobotPart::Arm(index).at_fault()(error))?;
        let effectors: Vec<(usize, usize)> = (0..self.arms.len())
            .flat_map(|arm| (0..self.arms[arm].effectors.len()).map(move |k| (arm, k)))
            .collect();
        let names = effectors.iter().map(|&(arm, k)| &self.arms[arm].effectors[k].name);
        unique("effectors", names).map_err(|(index, error)| {
            let (arm, k) = effectors[index];
            RobotPart::Effector(arm, k).at_fault()(error)
        })?;
        for (index, axis) in self.axes.iter().enumerate() {
            self.check_axis_of(index, axis).map_err(RobotPart::Axis(index).at_fault())?;
        }
        let home = [0, 1, 2].map(|rod| self.axes[rod].home);
        let angle = self.gpr.plane_tilt(&home).angle;
        let what = "the tilt of the home position".to_owned();
        in_range(what, angle, 0.0, self.gpr.limits().tilt_max, "rad").map_err(&whole)?;
        for (index, arm) in self.arms.iter().enumerate() {
            self.check_arm(index, arm)?;
        }
        for (index, axis) in self.axes.iter().enumerate().skip(RODS) {
            let joints = self.arms.iter().flat_map(|arm| &arm.joints);
            let mut drives = joints.flat_map(|joint| &joint.drives);
            if !drives.any(|&(driven, _)| driven == index) {
                let idle = CellError::IdleAxis { axis: axis.name.clone() };
                return Err(RobotPart::Axis(index).at_fault()(idle));
            }
        }
        Ok(())
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
        if *kind == AxisKind::Rotary {
            in_range(of("range"), max - min, 0.0, MAX_ROTATION, unit)?;
        }
        let units = match kind {
            AxisKind::Rotary => ["rad/s", "rad/s²", "rad/s³"],
            AxisKind::Linear => ["m/s", "m/s²", "m/s³"],
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
            if *kind != AxisKind::Linear {
                let why = "the first three axes are those of the rods, and have to slide";
                return Err(CellError::InvalidAxis { axis: name.clone(), why: why.to_owned() });
            }
            let limits = self.gpr.limits();
            let (least, most) = (limits.rod_min, limits.rod_max);
            in_range(of("least position"), *min, least, most, unit)?;
            in_range(of("largest position"), *max, least, most, unit)?;
        }
        Ok(())
    }

    fn check_arm(&self, index: usize, arm: &Arm) -> Result<(), Fault> {
        let of = |what: &str| format!("{what} of arm {}", arm.name);
        let at_fault = RobotPart::Arm(index).at_fault();
        for value in arm.mount {
            finite(of("the mount"), value).map_err(&at_fault)?;
        }
        count(&of("joints"), arm.joints.len(), 1, MAX_JOINTS).map_err(&at_fault)?;
        count(&of("effectors"), arm.effectors.len(), 1, MAX_EFFECTORS).map_err(&at_fault)?;
        check_droop(&arm.droop, of).map_err(&at_fault)?;
        let mut motors = BTreeSet::new();
        for (k, joint) in arm.joints.iter().enumerate() {
            let of = |what: &str| format!("{what} of joint {} of arm {}", k + 1, arm.name);
            self.check_joint(joint, of).map_err(RobotPart::Joint(index, k).at_fault())?;
            motors.extend(joint.drives.iter().map(|&(axis, _)| axis));
        }
        // More motors than joints could not be distinguished: their positions would be arbitrary.
        count(&of("motors"), motors.len(), 1, arm.joints.len()).map_err(&at_fault)?;
        for (k, effector) in arm.effectors.iter().enumerate() {
            let id = EffectorId { arm: index, effector: k };
            let checked = self.check_effector_of(id, arm, effector);
            checked.map_err(RobotPart::Effector(index, k).at_fault())?;
        }
        Ok(())
    }

    fn check_joint(&self, joint: &ArmJoint, of: impl Fn(&str) -> String) -> Result<(), CellError> {
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
            let invalid = |why| CellError::InvalidAxis { axis: name.clone(), why };
            if finite(of("a ratio"), ratio)? == 0.0 {
                return Err(invalid(format!("{} is 0; remove it", of("its ratio to the value"))));
            }
            if !driven.insert(axis) {
                return Err(invalid(format!(
                    "it drives {} twice; add the ratios",
                    of("the value")
                )));
            }
            if *kind != joint.kind {
                let (axis, value) = (kind.verb(), joint.kind.verb());
                let joint = of("the value");
                return Err(invalid(format!(
                    "it {axis}, but {joint} {value}; an axis drives its like"
                )));
            }
        }
        Ok(())
    }

    fn check_effector_of(
        &self,
        id: EffectorId,
        arm: &Arm,
        effector: &Effector,
    ) -> Result<(), CellError> {
        let of = |what: &str| format!("the {what} of effector {}", effector.name);
        for value in effector.wafer_center {
            finite(of("wafer's centre"), value)?;
        }
        finite(of("heading"), effector.heading)?;
        if finite(of("friction"), effector.friction)? < 0.0 {
            let value = effector.friction;
            return Err(CellError::NotPositive { what: of("friction"), value, unit: "" });
        }
        let directions = self.directions(id);
        if directions < 2 {
            let (arm, effector) = (arm.name.clone(), effector.name.clone());
            return Err(CellError::NotMovable { arm, effector, directions });
        }
        Ok(())
    }

    /// Number of independent directions in which an effector's motors move its wafer, the largest over a few positions.
    fn directions(&self, id: EffectorId) -> usize {
        let chain = ArmChain::new(self, id);
        let axes = chain.axes();
        let at = |fraction: f64| {
            let mut arm_positions = [0.0; MAX_JOINTS];
            for (k, (arm_positions, &axis)) in arm_positions.iter_mut().zip(axes).enumerate() {
                // Different shares for each axis: no arm is stretched in all of the positions.
                let fraction = (fraction + 0.211 * k as f64).fract();
                *arm_positions =
                    self.axes[axis].min + fraction * (self.axes[axis].max - self.axes[axis].min);
            }
            let velocities = chain.tip_velocities(&arm_positions);
            let largest = velocities.iter().map(Vector2::norm_squared).fold(0.0, f64::max);
            let flat = |one: &Vector2<f64>| {
                velocities.iter().all(|other| one.perp(other).abs() <= MIN_RELATIVE_AREA * largest)
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

/// Checks that the numbers of a droop are valid, and that the rows of a table are sorted by reach.
fn check_droop(droop: &Droop, of: impl Fn(&str) -> String) -> Result<(), CellError> {
    match droop {
        Droop::Rigid => Ok(()),
        Droop::Cantilever { stiffness, mass_per_length } => {
            positive(of("the stiffness"), *stiffness, "N m²")?;
            in_range(of("the mass per length"), *mass_per_length, 0.0, f64::MAX, "kg/m")
        }
        Droop::Table { rows } => {
            let mut least = 0.0;
            for (k, row) in rows.iter().enumerate() {
                let of = |what: &str| of(&format!("{what} in row {} of the droop", k + 1));
                in_range(of("the reach"), row.reach, least, MAX_REACH, "m")?;
                positive(of("the load"), row.load, "kg")?;
                for drop in [row.empty_drop, row.loaded_drop] {
                    finite(of("the drop"), drop)?;
                }
                for slope in [row.empty_slope, row.loaded_slope] {
                    finite(of("the slope"), slope)?;
                }
                least = row.reach + MIN_ROW_SPACING;
            }
            Ok(())
        }
    }
}
