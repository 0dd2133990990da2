//! Postures of an arm along the line into a station.

use std::sync::Arc;

use jointplay_core::spatial::tilt_rotation;
use nalgebra::{Vector2, Vector3};

use super::description::SlotId;
use super::waypoints::Waypoints;
use crate::robot::{
    ArmChain, Axis, EffectorId, HybridRobot, PlanarPath, PostureCandidate, PosturePath,
};
use crate::wafer::Unreachable;
use crate::workcell::Cell;

/// Waypoint on the line into a slot, at any height of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LinePoint {
    /// The retracted pose.
    Retracted,
    /// A via point, counted from the retracted pose.
    Via(usize),
    /// The pose in the slot.
    Slot,
}

/// Postures of an arm between its retracted pose and the slots of a station, to choose from.
///
/// They are planned for the lowest slot and a platform parallel to it.
#[derive(Debug, Clone)]
pub(crate) struct PostureOptions {
    line: PlanarPath,
    /// For each elbow side and each revolution that can drive the line, at least one; the cheapest first.
    pub(crate) candidates: Vec<PostureCandidate>,
}

/// Postures of an arm between its retracted pose and the slots of a station.
///
/// On the line of any slot they are the reference for the redundant angles of the arm.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StationPostures {
    /// Positions of the arm's motors along the line from the retracted pose to the slot.
    pub(crate) path: Arc<PosturePath>,
    /// Fractions of the line's length at the retracted pose, the via points and the slot.
    at_waypoints: Vec<f64>,
    /// Whether the line prescribes the wafer's heading.
    pub(crate) prescribes_heading: bool,
}

impl PostureOptions {
    /// The postures of a candidate.
    ///
    /// # Panics
    /// There is no such candidate.
    pub(crate) fn postures(
        &self,
        robot: &HybridRobot,
        effector: EffectorId,
        candidate: usize,
    ) -> StationPostures {
        let path = robot.posture_path(effector, &self.line, &self.candidates[candidate]);
        StationPostures {
            path: Arc::new(path),
            at_waypoints: self.line.fractions(),
            prescribes_heading: self.line.heading.is_some(),
        }
    }
}

impl StationPostures {
    /// Fraction of the line's length at a waypoint.
    pub(crate) fn fraction(&self, point: LinePoint) -> f64 {
        match point {
            LinePoint::Retracted => 0.0,
            LinePoint::Via(index) => self.at_waypoints[1 + index],
            LinePoint::Slot => 1.0,
        }
    }

    /// Positions of all axes at a waypoint, the rods and the motors of other arms as they are.
    pub(crate) fn near(&self, chain: &ArmChain, point: LinePoint, positions: &[f64]) -> Vec<f64> {
        let mut near = positions.to_vec();
        let arm_positions = self.path.at(self.fraction(point));
        for (&axis, arm_positions) in chain.axes().iter().zip(arm_positions) {
            near[axis] = arm_positions;
        }
        near
    }
}

/// A line into a station that no motion of an arm's motors follows.
#[derive(Debug, Clone, PartialEq)]
pub struct InfeasibleLine {
    /// Largest fraction of the line that can be followed from the retracted pose.
    pub fraction: f64,
    /// Distance of the wafer's centre from the axis of the arm's first joint, where the part of the line that can be followed ends (m).
    pub reach: f64,
    /// Changes, each of which alone gives a line that can be followed.
    pub remedies: Vec<LineRemedy>,
}

/// A change of a station or of an arm that makes a line possible.
#[derive(Debug, Clone, PartialEq)]
pub enum LineRemedy {
    /// Another distance of the retracted wafer from the axis of the arm's first joint (m).
    Retract(f64),
    /// Another distance of the slot from that axis (m).
    Radius(f64),
    /// A heading that the arm chooses.
    FreeHeading,
    /// Other limits of an axis: least and largest position (m or rad).
    Limits {
        /// Index of the axis.
        axis: usize,
        /// Least position on the line.
        min: f64,
        /// Largest position on the line.
        max: f64,
    },
}

/// Distances of the retracted wafer, and of the slot, that are tried as remedies, from that of the station (m).
const REMEDY_STEP: f64 = 0.02;
/// Largest number of steps in either direction.
const REMEDY_STEPS: usize = 20;
/// Range of a rotary axis without a limit (rad).
const UNLIMITED: f64 = 3.0 * std::f64::consts::PI;

impl Cell {
    /// Postures of an arm along the line into a station, to choose from; `None` where the arm has no choice.
    ///
    /// # Errors
    /// Those of [`Cell::waypoints`]; inside, [`InfeasibleLine`] where no motion of the motors follows the line.
    pub(crate) fn posture_options(
        &self,
        effector: EffectorId,
        station: usize,
    ) -> Result<Result<Option<PostureOptions>, InfeasibleLine>, Unreachable> {
        if !self.robot.has_posture_paths(effector) {
            return Ok(Ok(None));
        }
        let line = self.planar_line(effector, station)?;
        if !self.robot.plans_postures(effector, line.heading.is_some()) {
            return Ok(Ok(None));
        }
        Ok(
            match self
                .robot
                .posture_candidates(effector, &line)
                .or_else(|_| self.robot.fine_posture_candidates(effector, &line))
            {
                Ok(candidates) => Ok(Some(PostureOptions { line, candidates })),
                Err(blocked) => Err(InfeasibleLine {
                    fraction: blocked.fraction,
                    reach: (line.at(blocked.fraction) - self.mount(effector)).norm(),
                    remedies: self.line_remedies(effector, &line),
                }),
            },
        )
    }

    fn mount(&self, effector: EffectorId) -> Vector2<f64> {
        let [x, y, _] = self.robot.arms[effector.arm].mount;
        Vector2::new(x, y)
    }

    /// The line into the lowest slot of a station, in the plane of the arm over a platform parallel to the slot.
    fn planar_line(&self, effector: EffectorId, station: usize) -> Result<PlanarPath, Unreachable> {
        let home: Vec<f64> = self.robot.axes.iter().map(|axis| axis.home).collect();
        let slot = SlotId { station, slot: 1 };
        let axis = self.shoulder_point(effector, slot, &home)?;
        let Waypoints { retracted_below, via_below, below, .. } =
            self.waypoints(effector, slot, &home)?;
        let level = tilt_rotation(&below.normal.normalize()).inverse();
        let planar = |center: &Vector3<f64>| (level * (center - axis)).xy() + self.mount(effector);
        let centers = std::iter::once(&retracted_below).chain(&via_below).chain([&below]);
        let corners = centers.map(|target| planar(&target.center)).collect();
        Ok(PlanarPath { corners, heading: below.heading })
    }

    /// Changes that make a blocked line possible.
    fn line_remedies(&self, effector: EffectorId, line: &PlanarPath) -> Vec<LineRemedy> {
        let passes = |line: &PlanarPath| self.robot.posture_candidates(effector, line).is_ok();
        let mut remedies = Vec::new();
        if line.heading.is_some() && passes(&PlanarPath { heading: None, ..line.clone() }) {
            remedies.push(LineRemedy::FreeHeading);
        }
        let mount = self.mount(effector);
        let end = line.corners.len() - 1;
        for (corner, remedy) in
            [(0, LineRemedy::Retract as fn(f64) -> _), (end, LineRemedy::Radius as fn(f64) -> _)]
        {
            // Along the line, away from the other end or toward it, the nearest first.
            let along = match corner {
                0 => line.corners[0] - line.corners[1],
                _ => line.corners[end] - line.corners[end - 1],
            };
            let Some(along) = along.try_normalize(f64::MIN_POSITIVE) else { continue };
            let steps = (1..=REMEDY_STEPS).flat_map(|k| [-(k as f64), k as f64]);
            let moved = steps.filter_map(|k| {
                let mut changed = line.clone();
                changed.corners[corner] += along * (k * REMEDY_STEP);
                // Not past the other end.
                let rest = line.corners[0] - line.corners[end];
                let left = changed.corners[0] - changed.corners[end];
                (left.dot(&rest) > 0.0).then_some(changed)
            });
            if let Some(found) = moved.into_iter().find(|line| passes(line)) {
                remedies.push(remedy((found.corners[corner] - mount).norm()));
            }
        }
        remedies.extend(self.limit_remedies(effector, line));
        remedies
    }

    /// Limits of single axes that would make a line possible.
    fn limit_remedies(&self, effector: EffectorId, line: &PlanarPath) -> Vec<LineRemedy> {
        let chain = ArmChain::new(&self.robot, effector);
        let widened = chain.axes().iter().enumerate().filter_map(|(index, &axis)| {
            let mut robot = self.robot.clone();
            let limits = &mut robot.axes[axis];
            (limits.min, limits.max) = (limits.min.min(-UNLIMITED), limits.max.max(UNLIMITED));
            let candidates = robot.posture_candidates(effector, line).ok()?;
            let path = robot.posture_path(effector, line, candidates.first()?);
            let positions = path.positions.iter().map(|arm_positions| arm_positions[index]);
            let Axis { min, max, .. } = &self.robot.axes[axis];
            let (min, max) = positions.fold((*min, *max), |(a, b), q| (a.min(q), b.max(q)));
            Some(LineRemedy::Limits { axis, min, max })
        });
        widened.collect()
    }
}
