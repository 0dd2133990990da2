//! Forward kinematics: from positions of all axes to poses of all links.

use jointplay_core::bulk::sin_cos;
use jointplay_core::gpr::PlatformPose;
use jointplay_core::spatial::Pose;
use nalgebra::{Translation3, Vector3};

use super::arm_chain::ArmChain;
use super::hybrid_robot::{Arm, AxisKind, Effector, EffectorId, HybridRobot, MAX_JOINTS, RODS};
use super::rotation_about_z::{rotated_about_z, rotation_about_z};
use crate::CellError;

/// Poses of all links and wafers of a robot; bodies are rigid, nothing droops.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainPose {
    /// Pose of the platform over its rods.
    pub platform: PlatformPose,
    /// Frame of each link, by arm: origin at its joint, x along the link.
    pub base_from_link: Vec<Vec<Pose>>,
    /// Frame of each effector's wafer, by arm: origin at the wafer's centre on its resting plane, x along its heading.
    pub base_from_wafer: Vec<Vec<Pose>>,
}

/// Displacement of an effector by a change of positions that was made for another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectorDisplacement {
    /// The effector.
    pub effector: EffectorId,
    /// Its wafer frame before the change.
    pub before: Pose,
    /// Its wafer frame after the change.
    pub after: Pose,
}

impl EffectorDisplacement {
    /// Displacement of the wafer's centre, in the base frame (m).
    #[must_use]
    pub fn shift(&self) -> Vector3<f64> {
        self.after.translation.vector - self.before.translation.vector
    }

    /// Angle between the wafer's planes before and after (rad).
    #[must_use]
    pub fn tilting(&self) -> f64 {
        let (before, after) = (self.before.rotation.matrix(), self.after.rotation.matrix());
        before
            .column(2)
            .cross(&after.column(2))
            .norm()
            .atan2(before.column(2).dot(&after.column(2)))
    }
}

impl Arm {
    /// Appends the poses of the arm's links, from the first on.
    pub(crate) fn links(&self, base_from_platform: &Pose, positions: &[f64], to: &mut Vec<Pose>) {
        let mut link = base_from_platform * Translation3::from(self.mount);
        let mut to_next = Vector3::zeros();
        // A robot that was not validated may have more joints.
        for joints in self.joints.chunks(MAX_JOINTS) {
            let mut values = [0.0; MAX_JOINTS];
            for (value, joint) in values.iter_mut().zip(joints) {
                let driven = joint.drives.iter().map(|&(axis, ratio)| ratio * positions[axis]);
                *value = joint.zero + driven.sum::<f64>();
            }
            let (mut sines, mut cosines) = ([0.0; MAX_JOINTS], [0.0; MAX_JOINTS]);
            sin_cos(&values, &mut sines, &mut cosines).expect("the columns have one length");
            let turns = sines.into_iter().zip(cosines);
            for ((joint, value), (sin, cos)) in joints.iter().zip(values).zip(turns) {
                to_next.z += joint.rise;
                if joint.kind == AxisKind::Linear {
                    to_next.x += value;
                }
                link *= Translation3::from(to_next);
                if joint.kind == AxisKind::Rotary {
                    link = rotated_about_z(&link, sin, cos);
                }
                to_next = Vector3::new(joint.length, joint.offset, 0.0);
                to.push(link);
            }
        }
    }
}

impl Effector {
    /// Pose of the wafer on the last link.
    pub(crate) fn link_from_wafer(&self) -> Pose {
        Pose::from_parts(self.wafer_center.into(), rotation_about_z(self.heading))
    }
}

impl HybridRobot {
    /// Poses of all links and wafers in given positions.
    ///
    /// ```text
    ///    base_from_wafer  =  base_from_platform(rods) · platform_from_link(motors) · link_from_wafer
    /// ```
    ///
    /// # Arguments
    /// * `positions` – positions of all axes, rods first (m or rad)
    ///
    /// # Errors
    /// [`CellError::LengthMismatch`], [`CellError::NotFinite`], and those of the platform model.
    pub fn forward(&self, positions: &[f64]) -> Result<ChainPose, CellError> {
        self.check_positions(positions)?;
        let platform = self.platform(positions)?;
        let base_from_platform = platform.base_from_platform;
        let (mut base_from_link, mut base_from_wafer) = (Vec::new(), Vec::new());
        for arm in &self.arms {
            let mut links = Vec::with_capacity(arm.joints.len());
            arm.links(&base_from_platform, positions, &mut links);
            let last = links.last().copied().unwrap_or(base_from_platform);
            let wafers = arm.effectors.iter().map(|effector| last * effector.link_from_wafer());
            base_from_wafer.push(wafers.collect());
            base_from_link.push(links);
        }
        Ok(ChainPose { platform, base_from_link, base_from_wafer })
    }

    /// Pose of the wafer of one effector: origin at its centre on the resting plane, x along its heading.
    ///
    /// # Errors
    /// As [`Self::forward`], and [`CellError::NoSuchEffector`].
    ///
    /// # Numerics
    /// Does not allocate.
    pub fn effector_pose(&self, positions: &[f64], id: EffectorId) -> Result<Pose, CellError> {
        Ok(self.platform_and_effector(positions, id)?.1)
    }

    /// Pose of the platform, and that of one effector's wafer as by [`Self::effector_pose`].
    ///
    /// # Errors
    /// As [`Self::effector_pose`].
    ///
    /// # Numerics
    /// Does not allocate.
    pub fn platform_and_effector(
        &self,
        positions: &[f64],
        id: EffectorId,
    ) -> Result<(Pose, Pose), CellError> {
        self.check_effector(id)?;
        self.check_positions(positions)?;
        let base_from_platform = self.platform(positions)?.base_from_platform;
        Ok((base_from_platform, base_from_platform * self.wafer(id, positions)))
    }

    /// Displacements of all other effectors by a change of positions: effectors share the tilt, and may share motors.
    ///
    /// # Errors
    /// As [`Self::forward`].
    pub fn effects_on_others(
        &self,
        id: EffectorId,
        from: &[f64],
        to: &[f64],
    ) -> Result<Vec<EffectorDisplacement>, CellError> {
        self.check_positions(from)?;
        self.check_positions(to)?;
        let before = self.platform(from)?.base_from_platform;
        let after = self.platform(to)?.base_from_platform;
        let others =
            self.effectors().filter(|&other| other != id).map(|effector| EffectorDisplacement {
                effector,
                before: before * self.wafer(effector, from),
                after: after * self.wafer(effector, to),
            });
        Ok(others.collect())
    }

    /// Height of an effector's wafer over the platform plane: the lever of a tilt (m).
    ///
    /// # Errors
    /// [`CellError::NoSuchEffector`]
    pub fn wafer_height(&self, id: EffectorId) -> Result<f64, CellError> {
        self.check_effector(id)?;
        Ok(ArmChain::new(self, id).height())
    }

    /// All effectors, arm by arm.
    pub fn effectors(&self) -> impl Iterator<Item = EffectorId> + '_ {
        self.arms.iter().enumerate().flat_map(|(arm, one)| {
            (0..one.effectors.len()).map(move |effector| EffectorId { arm, effector })
        })
    }

    /// Indices of the axes that move an effector's wafer, rods first.
    ///
    /// # Errors
    /// [`CellError::NoSuchEffector`]
    pub fn axes_of(&self, id: EffectorId) -> Result<Vec<usize>, CellError> {
        self.check_effector(id)?;
        let mut axes: Vec<usize> = (0..RODS).collect();
        axes.extend(ArmChain::new(self, id).axes());
        axes.sort_unstable();
        Ok(axes)
    }

    /// Pose of the platform over its rods.
    #[inline]
    pub(crate) fn platform(&self, positions: &[f64]) -> Result<PlatformPose, CellError> {
        let rods = [positions[0], positions[1], positions[2]];
        Ok(self.model.forward(&self.gpr, rods)?)
    }

    /// Pose `platform_from_wafer`.
    fn wafer(&self, id: EffectorId, positions: &[f64]) -> Pose {
        ArmChain::new(self, id).wafer(positions)
    }

    pub(crate) fn check_positions(&self, positions: &[f64]) -> Result<(), CellError> {
        self.check_each("position", positions)
    }

    /// Checks that there is one finite number for each axis.
    pub(super) fn check_each(&self, what: &str, values: &[f64]) -> Result<(), CellError> {
        if values.len() != self.axes.len() {
            let (found, expected) = (values.len(), self.axes.len());
            return Err(CellError::LengthMismatch { found, expected });
        }
        match values.iter().zip(&self.axes).find(|(value, _)| !value.is_finite()) {
            Some((&value, axis)) => {
                let what = format!("the {what} of axis {}", axis.name);
                Err(CellError::NotFinite { what, value })
            }
            None => Ok(()),
        }
    }

    pub(crate) fn check_effector(&self, id: EffectorId) -> Result<(), CellError> {
        let EffectorId { arm, effector } = id;
        match self.arms.get(arm).and_then(|arm| arm.effectors.get(effector)) {
            Some(_) => Ok(()),
            None => Err(CellError::NoSuchEffector { arm, effector }),
        }
    }
}
