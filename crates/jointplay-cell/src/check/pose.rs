//! Check of a single pose, and of a joint-space line up to the first contact.

use super::checker::check_uncached;
use super::options::CheckOptions;
use super::report::{MinimumDistance, Report};
use super::step_checks::StepChecks;
use crate::collision::Scene;
use crate::geometry::{self, ColliderCache};
use crate::incremental::{JobContext, uninterrupted};
use crate::program::{Path, Phase, SourceLocation, Step, WaferLocations};
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::trajectory::{Trajectory, joint_space_line};
use crate::violation::ViolationKind;
use crate::workcell::Cell;
use crate::{CellError, EntityId};
use nalgebra::Vector3;

/// Bisections of the path before a contact: 2⁻³⁰ m is a nanometre.
const BISECTIONS: usize = 30;
/// Largest number of times that a path is shortened because of an earlier contact.
const MAX_SHORTENINGS: usize = 16;
/// Tolerance of the last state without contact, as a fraction of the path.
const CONTACT_TOLERANCE: f64 = 1e-9;
/// Margin to the contact, as a fraction of the path.
const MARGIN: f64 = 1e-7;

/// Largest difference between the reported distance of a pair and that of its nearest points (m).
const NEAREST_POINTS_TOLERANCE: f64 = 1e-6;

/// Context of a pose: locations of the wafers, and the slot that an effector may enter.
#[derive(Debug, Clone, Copy)]
pub struct PoseContext<'m> {
    /// Trajectory of the program.
    pub trajectory: &'m Trajectory,
    /// Time in the trajectory that determines where the wafers are (s).
    pub time: f64,
    /// Effector that may enter a slot, and the slot; `None` for those of the step at that time.
    pub slot_access: Option<(EffectorId, SlotId)>,
}

/// Part of a joint-space line before the first contact.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactFreePath {
    /// Positions of all axes at its end, rods first (m or rad).
    pub positions: Vec<f64>,
    /// Fraction of the path, 1 for a path without contact.
    pub fraction: f64,
    /// The two collision objects that touch beyond; `None` for a path without contact.
    pub touching: Option<[EntityId; 2]>,
}

/// Checks one pose against the limits of axes, tilt and play, droop, clearances and zones.
///
/// Pairs, allowed collisions and required clearances are those of [`check`](super::check); the robot is at rest.
/// `distances` of the report lists the minimum distance of each relevant pair that is smaller than `report_distance` of the options.
///
/// # Errors
/// As [`HybridRobot::forward`](crate::robot::HybridRobot::forward) for positions that are not those of the robot's axes.
pub fn check_pose(
    cell: &Cell,
    context: &PoseContext<'_>,
    positions: &[f64],
    options: &CheckOptions,
) -> Result<Report, CellError> {
    cell.robot.check_positions(positions)?;
    Ok(SceneAtTime::new(cell, context).pose(positions, options))
}

/// Nearest points of pairs of collision objects in one pose, in the base frame, in the order of the pair (m).
///
/// The distance of both points is that of [`check_pose`] in the same context.
/// A pair has no points where it is in contact, or where the pose is unknown because the arm exceeds its droop data.
///
/// # Errors
/// As [`check_pose`].
pub fn nearest_points(
    cell: &Cell,
    context: &PoseContext<'_>,
    positions: &[f64],
    distances: &[MinimumDistance],
) -> Result<Vec<Option<[Vector3<f64>; 2]>>, CellError> {
    cell.robot.check_positions(positions)?;
    let SceneAtTime { scene, .. } = SceneAtTime::new(cell, context);
    let Ok(poses) = scene.link_poses(positions, Vec::new()) else {
        return Ok(vec![None; distances.len()]);
    };
    let objects = |entity: EntityId| {
        let numbered = scene.objects.iter().enumerate();
        numbered.filter(move |(_, object)| object.entity == entity).map(|(index, _)| index)
    };
    let points = |minimum: &MinimumDistance| {
        let [first, second] = minimum.entities;
        // A body may consist of several objects, some of which are exempt from the check: those at the reported distance are meant.
        let pairs = objects(first).flat_map(|one| objects(second).map(move |other| [one, other]));
        let points = pairs.filter_map(|pair| {
            let [one, other] = pair.map(|object| scene.collider_at(object, &poses));
            geometry::nearest_points(one, other)
        });
        let error =
            |[one, other]: &[Vector3<f64>; 2]| ((other - one).norm() - minimum.distance).abs();
        let nearest = points.min_by(|one, other| error(one).total_cmp(&error(other)));
        nearest.filter(|points| error(points) <= NEAREST_POINTS_TOLERANCE)
    };
    Ok(distances.iter().map(points).collect())
}

/// Moves all axes along a joint-space line from one pose toward another, up to the last state without contact.
///
/// The path is checked continuously, as that of a program.
/// A contact is a distance of zero, or a body in a keep-out zone; pairs that touch at the start are not checked, so that a robot in contact can be moved out of it.
///
/// # Errors
/// As [`check_pose`], for both poses.
pub fn advance_until_contact(
    cell: &Cell,
    context: &PoseContext<'_>,
    [from, to]: [&[f64]; 2],
    options: &CheckOptions,
) -> Result<ContactFreePath, CellError> {
    cell.robot.check_positions(from)?;
    cell.robot.check_positions(to)?;
    Ok(SceneAtTime::new(cell, context).contact_free_path([from, to], options))
}

/// Scene at one time.
struct SceneAtTime<'a> {
    cell: &'a Cell,
    colliders: ColliderCache,
    scene: Scene<'a>,
    /// Number of different wafers that were placed before.
    placed_wafers: usize,
    template: Step,
}

impl<'a> SceneAtTime<'a> {
    fn new(cell: &'a Cell, context: &PoseContext<'_>) -> Self {
        let PoseContext { trajectory, time, slot_access } = *context;
        let mut colliders = ColliderCache::default();
        colliders.begin();
        let mut scene = Scene::new(cell, &mut colliders);
        let ended = trajectory.times.iter().skip(1).take_while(|&&end| end <= time).count();
        let locations = WaferLocations::of_steps(cell, &trajectory.steps[..ended]);
        for change in locations.location_changes() {
            scene.move_wafer(change, &mut colliders);
        }
        let placed_wafers = locations.placed_wafers();
        let current = trajectory.steps.get(ended.min(trajectory.steps.len().saturating_sub(1)));
        let of_step = current.and_then(|step| match step.path {
            Path::Line(id) => Some((id, step.slot?, step.phase)),
            _ => None,
        });
        // An effector that is jogged into a slot may lift its wafer.
        let slot_access = slot_access.map(|(id, slot)| (id, slot, Phase::Lift)).or(of_step);
        let loaded = cell.robot.effectors().filter(|&id| scene.held_wafer(id).is_some());
        let template = Step {
            instruction: 0,
            place: SourceLocation::default(),
            phase: slot_access.map_or(Phase::Move, |(.., phase)| phase),
            from: Vec::new(),
            to: Vec::new(),
            path: slot_access.map_or(Path::PointToPoint, |(id, ..)| Path::Line(id)),
            speed_scaling: 1.0,
            blend_radius: 0.0,
            postures: None,
            line_speed: None,
            loaded: loaded.collect(),
            handoff: None,
            slot: slot_access.map(|(_, slot, _)| slot),
        };
        Self { cell, colliders, scene, placed_wafers, template }
    }

    fn report(&mut self, [from, to]: [&[f64]; 2], options: &CheckOptions) -> (Trajectory, Report) {
        let mut step = self.template.clone();
        (step.from, step.to) = (from.to_vec(), to.to_vec());
        let trajectory = joint_space_line(step);
        let (scene, context) = (self.scene.clone(), JobContext::unmonitored());
        let (steps, starts) = uninterrupted(StepChecks::new(
            &trajectory,
            0..trajectory.steps.len(),
            &[],
            options,
            scene,
            &mut self.colliders,
            context,
        ));
        let report = check_uncached(self.cell, &trajectory, steps, &starts, self.placed_wafers);
        (trajectory, report)
    }

    fn pose(&mut self, positions: &[f64], options: &CheckOptions) -> Report {
        self.report([positions, positions], options).1
    }

    fn contact_free_path(
        &mut self,
        [from, to]: [&[f64]; 2],
        options: &CheckOptions,
    ) -> ContactFreePath {
        let at_start = contacts(&self.pose(from, options));
        let new = |report: &Report| -> Option<[EntityId; 2]> {
            contacts(report).into_iter().find(|pair| !at_start.contains(pair))
        };
        let at = |fraction: f64| -> Vec<f64> {
            from.iter().zip(to).map(|(from, to)| from + fraction * (to - from)).collect()
        };
        let (mut fraction, mut touching) = (1.0, None);
        for _ in 0..MAX_SHORTENINGS {
            let end = if fraction == 1.0 { to.to_vec() } else { at(fraction) };
            let (trajectory, report) = self.report([from, &end], options);
            // A violation begins with the clearance; the contact is at its worst time.
            let new_contacts = report.violations.iter().filter(|one| {
                is_contact(one.kind)
                    && pair_of(&one.entities).is_some_and(|pair| !at_start.contains(&pair))
            });
            let first =
                new_contacts.min_by(|one, other| one.worst_time.total_cmp(&other.worst_time));
            let Some(first) = first else {
                return ContactFreePath { positions: end, fraction, touching };
            };
            touching = pair_of(&first.entities);
            // The position of the contact as a fraction of the whole path.
            let reached = trajectory.sample_at(first.worst_time).positions;
            let (mut free, mut touched) = (0.0, share_of([from, to], &reached).min(fraction));
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (free + touched);
                if touched - free < CONTACT_TOLERANCE {
                    break;
                }
                match new(&self.pose(&at(middle), options)) {
                    Some(_) => touched = middle,
                    None => free = middle,
                }
            }
            // The margin exceeds the resolution of distances.
            fraction = (free - MARGIN).max(0.0);
        }
        // Each shortened path had an earlier contact.
        ContactFreePath { positions: from.to_vec(), fraction: 0.0, touching }
    }
}

/// Fraction of a joint-space line at which positions are.
fn share_of([from, to]: [&[f64]; 2], at: &[f64]) -> f64 {
    let (mut along, mut squares) = (0.0, 0.0);
    for ((from, to), at) in from.iter().zip(to).zip(at) {
        along += (at - from) * (to - from);
        squares += (to - from).powi(2);
    }
    if squares > 0.0 { (along / squares).clamp(0.0, 1.0) } else { 1.0 }
}

fn is_contact(kind: ViolationKind) -> bool {
    matches!(kind, ViolationKind::Collision | ViolationKind::KeepOut)
}

fn pair_of(entities: &[EntityId]) -> Option<[EntityId; 2]> {
    entities.try_into().ok()
}

/// The pairs that touch.
fn contacts(report: &Report) -> Vec<[EntityId; 2]> {
    let touching = report.violations.iter().filter(|one| is_contact(one.kind));
    touching.filter_map(|one| pair_of(&one.entities)).collect()
}
