//! Displacement of a wafer at one pose of the robot.

use std::collections::BTreeSet;

use jointplay_core::gpr::AxisHeight;
use jointplay_core::spatial::{Pose, Tilt, tilt_rotation};
use jointplay_core::virtualization::BuiltIn;
use nalgebra::{Translation3, Vector2, Vector3};

use super::cause::Cause;
use super::contribution::Contribution;
use super::effects::parameter_effects;
use super::tolerances::Tolerances;
use crate::CellError;
use crate::program::{Handoff, Step};
use crate::robot::{ArmChain, EffectorId, PlatformModel, WaferTarget};
use crate::station::SlotId;
use crate::wafer::Unreachable;
use crate::workcell::Cell;

/// All virtualizations.
const VIRTUALIZATIONS: [BuiltIn; 4] =
    [BuiltIn::Radial, BuiltIn::Polar, BuiltIn::Offset, BuiltIn::Planar];

/// Relative tolerance on the robot's largest tilt.
const TILT_TOLERANCE: f64 = 1e-9;

/// A wafer that an effector holds at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedWafer {
    /// The effector.
    pub effector: EffectorId,
    /// Positions of all axes, rods first (m or rad).
    pub positions: Vec<f64>,
    /// Slot in which the effector holds the wafer, if any.
    pub slot: Option<SlotId>,
    /// Height of the wafer above its resting position in the slot, along the normal; 0 without a slot (m).
    pub lift: f64,
}

/// Known displacement of the wafer's centre by one cause.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NominalShift {
    /// The cause.
    pub cause: Cause,
    /// Displacement, in the base frame (m).
    pub shift: Vector3<f64>,
}

/// Displacement of a wafer's centre from where it is over the level platform of a rigid robot with the same positions of the arm's motors, and its uncertainty.
///
/// ```text
///    total  =  lever + platform model + droop + sag        each from the pose that the causes before it give
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct WaferDisplacement {
    /// The wafer.
    pub wafer: PlacedWafer,
    /// Tilt of the platform.
    pub tilt: Tilt,
    /// Distance of the wafer's centre from the base axis, over the level platform (m).
    pub reach: f64,
    /// Height of the wafer over the platform plane: the lever of the tilt (m).
    pub lever: f64,
    /// Displacement of the platform's centre O_p from the base axis, in the base frame (m).
    pub platform_shift: Vector3<f64>,
    /// Known displacements, whose sum is the total.
    pub shifts: Vec<NominalShift>,
    /// Sum of the known displacements (m).
    pub total: Vector3<f64>,
    /// Contributions to the uncertainty of the position; relative to the slot if the wafer is in one.
    pub contributions: Vec<Contribution>,
    /// Causes without data: their contribution is not known and not included.
    pub unknown: Vec<Cause>,
}

/// Horizontal displacement of a point over the platform's centre by a tilt about it (m).
///
/// # Arguments
/// * `height` – of the point over the platform plane (m)
#[must_use]
pub fn lever_shift(height: f64, tilt: Tilt) -> Vector2<f64> {
    tilt.normal().xy() * height
}

impl Cell {
    /// The wafer that an effector holds at rest in a slot, its droop and sag compensated.
    ///
    /// # Errors
    /// [`Unreachable`]
    ///
    /// # Panics
    /// If the cell has no such station.
    pub fn wafer_in_slot(
        &self,
        effector: EffectorId,
        slot: SlotId,
    ) -> Result<PlacedWafer, Unreachable> {
        let near: Vec<f64> = self.robot.axes.iter().map(|axis| axis.home).collect();
        let mut target = self.waypoints(effector, slot, &near)?.resting;
        target.center -= target.normal * self.sag_height(effector).unwrap_or(0.0);
        // The displacement does not depend on the posture, which a redundant arm chooses along its whole line.
        let found = if self.robot.has_posture_paths(effector) {
            self.compensated_inverse_beyond_limits(effector, &target, true, &near)?
        } else {
            self.compensated_inverse(effector, &target, true, &near)?
        };
        Ok(PlacedWafer { effector, positions: found.positions, slot: Some(slot), lift: 0.0 })
    }

    /// The wafer of an effector, with the platform tilted and the arm where it is over the level platform.
    ///
    /// # Arguments
    /// * `center` – horizontal position of the wafer over the level platform (m); `None` for the home positions of the motors
    ///
    /// # Errors
    /// [`Unreachable`]
    pub fn wafer_over_tilt(
        &self,
        effector: EffectorId,
        tilt: Tilt,
        center: Option<[f64; 2]>,
    ) -> Result<PlacedWafer, Unreachable> {
        self.robot.check_effector(effector)?;
        let allowed = self.robot.gpr.limits().tilt_max;
        if tilt.angle.abs() > allowed * (1.0 + TILT_TOLERANCE) {
            let (needed, threshold) = (tilt.angle.abs(), self.plane_threshold);
            return Err(Unreachable::Tilt {
                needed,
                allowed,
                residual: needed - allowed,
                threshold,
            });
        }
        let home: Vec<f64> = self.robot.axes.iter().map(|axis| axis.home).collect();
        let mut positions = match center {
            None => home.clone(),
            Some([x, y]) => {
                let height = self.robot.effector_pose(&home, effector)?.translation.z;
                let center = Vector3::new(x, y, height);
                let target = WaferTarget { center, normal: Vector3::z(), heading: None };
                let level = self.robot.inverse(effector, &target, &home)?;
                match level.chosen() {
                    Some(branch) => branch.positions.to_vec(),
                    None => {
                        return Err(self
                            .compensated_inverse(effector, &target, false, &home)
                            .err()
                            .unwrap_or(Unreachable::NoBranch));
                    }
                }
            }
        };
        let level = self.robot.gpr.plane_height(&[home[0], home[1], home[2]]);
        let rods = self.robot.gpr.inverse(tilt, level).map_err(CellError::from)?;
        positions[..rods.len()].copy_from_slice(&rods);
        Ok(PlacedWafer { effector, positions, slot: None, lift: 0.0 })
    }

    /// The wafers at the hand-offs of a program: each effector in each slot once, in the order of the program.
    #[must_use]
    pub fn wafers_at_handoffs(&self, steps: &[Step]) -> Vec<PlacedWafer> {
        let mut known = BTreeSet::new();
        let wafer = |(index, step): (usize, &Step)| {
            let (effector, slot, at, lift) = match step.handoff? {
                Handoff::Placed(effector, slot) => (effector, slot, step, 0.0),
                // At the hand-off the effector is still empty; the next step lifts the wafer.
                Handoff::Picked(effector, slot) => {
                    let above = self.stations[slot.station].stroke.above;
                    (effector, slot, steps.get(index + 1)?, above)
                }
            };
            let is_new = known.insert((effector, slot));
            let positions = at.to.clone();
            is_new.then_some(PlacedWafer { effector, positions, slot: Some(slot), lift })
        };
        steps.iter().enumerate().filter_map(wafer).collect()
    }

    /// Height of the wafer's mean plane over its supports (m); `None` where they do not carry it.
    fn sag_height(&self, effector: EffectorId) -> Option<f64> {
        self.sag(effector).ok().map(|sag| sag.plane_height)
    }

    /// Displacement of a wafer by all known causes, and the uncertainty of its position by all others.
    ///
    /// Tolerances are rectangular: any deviation within them is equally probable. The model of the platform contributes the largest difference of the other virtualizations from the chosen one, as a tolerance does.
    ///
    /// # Errors
    /// [`Unreachable`], where the pose or the droop is not known.
    pub fn wafer_displacement(
        &self,
        wafer: &PlacedWafer,
        tolerances: &Tolerances,
    ) -> Result<WaferDisplacement, Unreachable> {
        let PlacedWafer { effector, ref positions, slot, lift } = *wafer;
        self.robot.check_effector(effector)?;
        self.robot.check_positions(positions)?;
        let platform = self.robot.platform(positions)?;
        let (tilt, AxisHeight(height)) = (platform.tilt(), platform.axis_height());
        let platform_from_wafer = ArmChain::new(&self.robot, effector).wafer(positions);
        let center = |base_from_platform: &Pose| {
            (base_from_platform * platform_from_wafer).translation.vector
        };
        let origin = Translation3::new(0.0, 0.0, height);
        let level = center(&Pose::from_parts(origin, nalgebra::Rotation3::identity()));
        let ideal = center(&Pose::from_parts(origin, tilt_rotation(&platform.normal())));
        let modelled = center(&platform.base_from_platform);
        let drooping = self.wafer_pose(effector, positions, true)?;
        let drooped = drooping.translation.vector;
        let normal = drooping.rotation * Vector3::z();
        let sag = self.sag_height(effector);
        let mean = drooped + normal * sag.unwrap_or(0.0);
        let shift = |cause, shift| NominalShift { cause, shift };
        let shifts = vec![
            shift(Cause::Lever, ideal - level),
            shift(Cause::PlatformModel, modelled - ideal),
            shift(Cause::Droop, drooped - modelled),
            shift(Cause::Sag, mean - drooped),
        ];
        let mut contributions = vec![self.model_contribution(positions, &center, &modelled)?];
        let mut unknown = Vec::new();
        let effects = parameter_effects(self, effector, positions, tolerances)?;
        for cause in [Cause::AxisResolution, Cause::PlatformTolerances, Cause::ArmTolerances] {
            let mut contribution = Contribution::new(cause);
            for one in effects.iter().filter(|one| one.cause == cause) {
                contribution.add_rectangular(&one.effect, one.half_width);
            }
            contributions.extend((contribution.parameters > 0).then_some(contribution));
            if !tolerances.is_complete(cause) {
                unknown.push(cause);
            }
        }
        for (cause, share, shift) in [
            (Cause::Droop, tolerances.droop_share, drooped - modelled),
            (Cause::Sag, tolerances.sag_share, mean - drooped),
        ] {
            match share {
                Some(share) => {
                    let mut contribution = Contribution::new(cause);
                    contribution.add_rectangular(&shift, share);
                    contributions.push(contribution);
                }
                None if shift.norm() > 0.0 || (cause == Cause::Sag && sag.is_none()) => {
                    unknown.push(cause);
                }
                None => {}
            }
        }
        if let Some(slot) = slot {
            let resting = self.stations[slot.station].slot_frame(slot.slot);
            let target = resting.translation.vector + resting.rotation * Vector3::z() * lift;
            let mut compensation = Contribution::new(Cause::Compensation);
            compensation.add_offset(&(mean - target));
            contributions.push(compensation);
            contributions.extend(self.station_contribution(slot));
            if self.stations[slot.station].uncertainty.known.contains(&false) {
                unknown.push(Cause::Station);
            }
        }
        Ok(WaferDisplacement {
            wafer: wafer.clone(),
            tilt,
            reach: level.xy().norm(),
            lever: platform_from_wafer.translation.z,
            platform_shift: platform.base_from_platform.translation.vector
                - Vector3::new(0.0, 0.0, height),
            total: mean - level,
            shifts,
            contributions,
            unknown,
        })
    }

    /// The largest difference of the other virtualizations from that of the robot.
    fn model_contribution(
        &self,
        positions: &[f64],
        center: &impl Fn(&Pose) -> Vector3<f64>,
        modelled: &Vector3<f64>,
    ) -> Result<Contribution, Unreachable> {
        let rods = [positions[0], positions[1], positions[2]];
        let mut largest = Vector3::zeros();
        for virtualization in VIRTUALIZATIONS {
            let model = PlatformModel { virtualization, options: self.robot.model.options };
            let pose = model.forward(&self.robot.gpr, rods).map_err(CellError::from)?;
            let difference = center(&pose.base_from_platform) - modelled;
            if difference.norm() > largest.norm() {
                largest = difference;
            }
        }
        let mut contribution = Contribution::new(Cause::PlatformModel);
        contribution.add_rectangular(&largest, 1.0);
        Ok(contribution)
    }

    /// Uncertainty of the slot; in the linear sum, the coverage factor times the standard deviation.
    fn station_contribution(&self, slot: SlotId) -> Option<Contribution> {
        let station = &self.stations[slot.station];
        let known = &station.uncertainty;
        if !known.is_known() || self.coverage_factor == 0.0 {
            return None;
        }
        let rotation = station.base_from_station.rotation;
        let own = known.displacement_covariance(&station.slot_position(slot.slot));
        // With an estimated noise, the deviation is enlarged so that the coverage factor covers as much.
        let factor = known.coverage(self.coverage_factor) / self.coverage_factor;
        let mut contribution = Contribution::new(Cause::Station);
        contribution.parameters = known.known.iter().filter(|known| **known).count();
        contribution.covariance = rotation * own * rotation.inverse() * (factor * factor);
        contribution.set_worst_to_expanded(self.coverage_factor);
        Some(contribution)
    }
}
