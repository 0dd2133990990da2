//! Where a wafer is, its arm giving way under it.

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Translation3, Unit, Vector3};

use crate::cell::Cell;
use crate::robot::{ChainPose, EffectorId};
use crate::wafer::Droop;

/// The wafer frame of an effector, lowered and turned as its arm droops.
///
/// # Errors
/// Where nothing is known of how the arm droops, in words.
pub(crate) fn drooped(
    cell: &Cell,
    chain: &ChainPose,
    effector: EffectorId,
    loaded: bool,
) -> Result<Pose, String> {
    let rigid = chain.base_from_wafer[effector.arm][effector.effector];
    let droop = &cell.robot.arms[effector.arm].droop;
    if *droop == Droop::Rigid {
        return Ok(rigid);
    }
    let first = chain.base_from_link[effector.arm][0].translation.vector;
    let out = rigid.translation.vector - first;
    let reach = out.x.hypot(out.y);
    let load = if loaded { cell.wafer.mass() } else { 0.0 };
    let by = droop.at(reach, load, cell.gravity).map_err(|error| error.to_string())?;
    let lowered = Translation3::new(0.0, 0.0, -by.drop) * rigid.translation;
    if reach == 0.0 {
        return Ok(Pose::from_parts(lowered, rigid.rotation));
    }
    // About the horizontal axis across the arm, outer end down.
    let across = Unit::new_normalize(Vector3::new(-out.y, out.x, 0.0));
    let turn = Rotation3::from_axis_angle(&across, by.slope);
    Ok(Pose::from_parts(lowered, turn * rigid.rotation))
}

/// The same for positions of all axes.
///
/// # Errors
/// Where the platform cannot be placed, or nothing is known of how the arm droops, in words.
pub(crate) fn wafer_pose(
    cell: &Cell,
    positions: &[f64],
    effector: EffectorId,
    loaded: bool,
) -> Result<Pose, String> {
    if cell.robot.arms[effector.arm].droop == Droop::Rigid {
        return cell.robot.effector_pose(positions, effector).map_err(|error| error.to_string());
    }
    let chain = cell.robot.forward(positions).map_err(|error| error.to_string())?;
    drooped(cell, &chain, effector, loaded)
}
