//! Linear effects of the robot's parameters on the position of a wafer.

use jointplay_core::gpr::Gpr;
use nalgebra::Vector3;

use super::cause::Cause;
use super::tolerances::Tolerances;
use crate::CellError;
use crate::robot::{AxisKind, EffectorId, HybridRobot, RODS};
use crate::wafer::Unreachable;
use crate::workcell::Cell;

/// Half the step of differences (m or rad): errors of the third derivative are below 10⁻⁹ of the effect, round-off about as much.
const STEP: f64 = 1e-5;

/// Effect of one parameter of the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterEffect {
    /// Cause that the parameter belongs to.
    pub cause: Cause,
    /// Name of the parameter.
    pub parameter: String,
    /// Displacement of the wafer's centre for a unit of the parameter, in the base frame (m/m or m/rad).
    pub effect: Vector3<f64>,
    /// Largest deviation of the parameter to either side (m or rad).
    pub half_width: f64,
}

/// Function that changes a robot, or the positions of its axes, by a deviation of a parameter.
type Change = Box<dyn Fn(&mut HybridRobot, &mut [f64], f64) -> Result<(), CellError>>;

/// Parameter of a robot, with a function that changes it.
struct Parameter {
    cause: Cause,
    name: String,
    half_width: f64,
    change: Change,
}

/// Effects of all parameters whose tolerance is known on the wafer of an effector, at given positions of the axes.
///
/// # Errors
/// Those of [`Cell::wafer_pose`].
///
/// # Numerics
/// Central differences of the whole forward kinematics, with platform model and droop; the axes stay where the nominal robot is commanded to.
pub fn parameter_effects(
    cell: &Cell,
    effector: EffectorId,
    positions: &[f64],
    tolerances: &Tolerances,
) -> Result<Vec<ParameterEffect>, Unreachable> {
    cell.robot.check_effector(effector)?;
    let mut changed = cell.clone();
    // A deviation at a limit is not a motion beyond it.
    changed.robot.gpr = cell.robot.gpr.without_limit_checks();
    let unchecked = changed.robot.clone();
    let mut center = |parameter: &Parameter, value: f64| {
        let mut positions = positions.to_vec();
        changed.robot.clone_from(&unchecked);
        (parameter.change)(&mut changed.robot, &mut positions, value)?;
        let pose = changed.wafer_pose(effector, &positions, true)?;
        Ok::<_, Unreachable>(pose.translation.vector)
    };
    let parameters = parameters(&cell.robot, effector, tolerances);
    let effects = parameters.into_iter().map(|parameter| {
        let (before, after) = (center(&parameter, -STEP)?, center(&parameter, STEP)?);
        let effect = (after - before) / (2.0 * STEP);
        let Parameter { cause, name, half_width, .. } = parameter;
        Ok(ParameterEffect { cause, parameter: name, effect, half_width })
    });
    effects.collect()
}

fn parameters(
    robot: &HybridRobot,
    effector: EffectorId,
    tolerances: &Tolerances,
) -> Vec<Parameter> {
    let mut found = Vec::new();
    let mut add = |cause, name: String, half_width: Option<f64>, change| {
        found.extend(half_width.map(|half_width| Parameter { cause, name, half_width, change }));
    };
    for k in 0..RODS {
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let name = format!("guide {} {name}", k + 1);
            let change = limb_change(move |limb, by| limb.base_point[axis] += by, k);
            add(Cause::PlatformTolerances, name, tolerances.guide, change);
        }
        let radial = limb_change(|limb, by| limb.socket_radius += by, k);
        let name = format!("socket {} radially", k + 1);
        add(Cause::PlatformTolerances, name, tolerances.socket, radial);
        let tangential = limb_change(|limb, by| limb.socket_angle += by / limb.socket_radius, k);
        let name = format!("socket {} tangentially", k + 1);
        add(Cause::PlatformTolerances, name, tolerances.socket, tangential);
        let name = format!("zero of {}", robot.axes[k].name);
        add(Cause::PlatformTolerances, name, tolerances.rod_zero, axis_change(k));
    }
    let EffectorId { arm, effector } = effector;
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        let change = arm_change(move |robot, by| robot.arms[arm].mount[axis] += by);
        add(Cause::ArmTolerances, format!("mount {name}"), tolerances.mount, change);
    }
    let joints = &robot.arms[arm].joints;
    for (index, joint) in joints.iter().enumerate() {
        let name = |what: &str| format!("{what} of link {}", index + 1);
        let is_last = index + 1 == joints.len();
        // On the last link, the position of the wafer takes the place of length and offset.
        let length = arm_change(move |robot, by| match is_last {
            true => robot.arms[arm].effectors[effector].wafer_center[0] += by,
            false => robot.arms[arm].joints[index].length += by,
        });
        let offset = arm_change(move |robot, by| match is_last {
            true => robot.arms[arm].effectors[effector].wafer_center[1] += by,
            false => robot.arms[arm].joints[index].offset += by,
        });
        let rise = arm_change(move |robot, by| robot.arms[arm].joints[index].rise += by);
        add(Cause::ArmTolerances, name("length"), tolerances.link, length);
        add(Cause::ArmTolerances, name("offset"), tolerances.link, offset);
        add(Cause::ArmTolerances, name("rise"), tolerances.link, rise);
        let zero = arm_change(move |robot, by| robot.arms[arm].joints[index].zero += by);
        let of_zero = match joint.kind {
            AxisKind::Rotary => tolerances.joint_zero,
            AxisKind::Linear => tolerances.link,
        };
        add(Cause::ArmTolerances, format!("zero of joint {}", index + 1), of_zero, zero);
    }
    let moving = robot.axes_of(EffectorId { arm, effector }).unwrap_or_default();
    for axis in moving {
        let step = match robot.axes[axis].kind {
            AxisKind::Rotary => tolerances.rotary_resolution,
            AxisKind::Linear => tolerances.linear_resolution,
        };
        let name = format!("resolution of {}", robot.axes[axis].name);
        add(Cause::AxisResolution, name, step.map(|step| 0.5 * step), axis_change(axis));
    }
    found
}

/// Change of one limb of the platform.
fn limb_change(
    change: impl Fn(&mut jointplay_core::gpr::Limb, f64) + 'static,
    limb: usize,
) -> Change {
    Box::new(move |robot, _, by| {
        let mut limbs = robot.gpr.limbs();
        change(&mut limbs[limb], by);
        let (limits, height) = (*robot.gpr.limits(), robot.gpr.working_height());
        robot.gpr = Gpr::new(limbs, limits, height)?.without_limit_checks();
        Ok(())
    })
}

/// Change of an arm.
fn arm_change(change: impl Fn(&mut HybridRobot, f64) + 'static) -> Change {
    Box::new(move |robot, _, by| {
        change(robot, by);
        Ok(())
    })
}

/// Change of the position of an axis.
fn axis_change(axis: usize) -> Change {
    Box::new(move |_, positions, by| {
        positions[axis] += by;
        Ok(())
    })
}
