//! Poses of links, end effectors and wafers, arms deflected: one calculation for check, jog, export and pictures.

use std::convert::Infallible;

use jointplay_core::spatial::Pose;

use crate::CellError;
use crate::robot::{ChainPose, EffectorId};
use crate::wafer::{Deflection, Droop, DroopError};
use crate::workcell::Cell;

impl Cell {
    /// Appends the poses of one arm in the base frame: its links without deflection, and then for each effector the deflected last link and the wafer.
    ///
    /// ```text
    ///    base_from_wafer  =  D · base_from_last · last_from_wafer,      base_from_tip  =  D · base_from_last
    /// ```
    /// D: deflection of the arm at the effector's reach and load, see [`apply_deflection`](crate::wafer::apply_deflection).
    ///
    /// # Arguments
    /// * `loaded` – whether an effector holds a wafer
    /// * `resolve` – deflection to use, given the computed one or its error
    ///
    /// # Errors
    /// Those of `resolve`.
    pub(crate) fn append_arm_poses<E>(
        &self,
        arm: usize,
        base_from_platform: &Pose,
        positions: &[f64],
        loaded: impl Fn(EffectorId) -> bool,
        resolve: impl Fn(Result<Deflection, DroopError>) -> Result<Deflection, E>,
        to: &mut Vec<Pose>,
    ) -> Result<(), E> {
        let described = &self.robot.arms[arm];
        let first = to.len();
        described.links(base_from_platform, positions, to);
        let last = to[first..].last().copied().unwrap_or(*base_from_platform);
        for (effector, shape) in described.effectors.iter().enumerate() {
            let last_from_wafer = shape.link_from_wafer();
            let rigid = last * last_from_wafer;
            if described.droop == Droop::Rigid {
                to.extend([last, rigid]);
                continue;
            }
            let loaded = loaded(EffectorId { arm, effector });
            let wafer_of_rigid_arm = self.rigid_wafer_at(arm, base_from_platform, rigid);
            let deflection = resolve(self.deflection(&wafer_of_rigid_arm, loaded))?;
            let wafer = wafer_of_rigid_arm.deflected(deflection);
            to.extend([wafer * last_from_wafer.inverse(), wafer]);
        }
        Ok(())
    }

    /// Poses of all links and wafers with deflection: wafers as by [`Self::wafer_pose`], the last link of an arm with its effector, links before it rigid.
    ///
    /// Bodies attached to a link move with it; the collision check, the jog, glTF and pictures all take poses from this calculation.
    /// With several effectors on one link, the link takes the deflection of the effector that drops most; the collision check tests the bodies of such a link at the deflection of each effector.
    /// Where the droop is unknown, there is no deflection.
    ///
    /// # Arguments
    /// * `loaded` – effectors that hold a wafer
    ///
    /// # Errors
    /// As [`crate::robot::HybridRobot::forward`].
    pub fn forward_with_deflection(
        &self,
        positions: &[f64],
        loaded: &[EffectorId],
    ) -> Result<ChainPose, CellError> {
        self.robot.check_positions(positions)?;
        let platform = self.robot.platform(positions)?;
        let base_from_platform = platform.base_from_platform;
        let (mut base_from_link, mut base_from_wafer) = (Vec::new(), Vec::new());
        for (arm, described) in self.robot.arms.iter().enumerate() {
            let mut links = Vec::with_capacity(described.joints.len() + 2);
            let Ok(()) = self.append_arm_poses::<Infallible>(
                arm,
                &base_from_platform,
                positions,
                |id| loaded.contains(&id),
                |found| Ok(found.unwrap_or_default()),
                &mut links,
            );
            let ends = links.split_off(described.joints.len());
            let rigid = links.last().copied().unwrap_or(base_from_platform);
            let drop = |wafer: &Pose, effector: usize| {
                let from = rigid * described.effectors[effector].link_from_wafer();
                (from.translation.z - wafer.translation.z).abs()
            };
            let (mut most, mut wafers) = (f64::NEG_INFINITY, Vec::new());
            for (effector, end) in ends.chunks_exact(2).enumerate() {
                let [tip, wafer] = [end[0], end[1]];
                let drop = drop(&wafer, effector);
                if drop > most {
                    most = drop;
                    if let Some(last) = links.last_mut() {
                        *last = tip;
                    }
                }
                wafers.push(wafer);
            }
            base_from_wafer.push(wafers);
            base_from_link.push(links);
        }
        Ok(ChainPose { platform, base_from_link, base_from_wafer })
    }
}
