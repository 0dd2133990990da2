//! Translations of fixed bodies and zones that remove their violations.

use jointplay_core::spatial::Pose;
use nalgebra::{Translation3, Vector3};

use super::checker::CheckCache;
use super::options::CheckOptions;
use super::report::Report;
use crate::EntityId;
use crate::collision::{CONTACT_RESOLUTION, ClearanceRule, LinkPoses, Scene};
use crate::geometry::{ColliderCache, PlacedCollider, distance};
use crate::incremental::{Interrupted, JobContext, StopRequested};
use crate::program::WaferLocations;
use crate::trajectory::{Sample, Trajectory};
use crate::violation::{Violation, ViolationKind};
use crate::workcell::{Cell, ParentFrame};

/// Largest number of bodies and zones for which a remedy is searched, the most severe first.
const MAX_OBSTACLES: usize = 4;
/// Directions that are verified by a check of the whole program, the shortest translation first.
const MAX_DIRECTIONS: usize = 3;
/// Largest number of translations that are verified along one direction.
const MAX_VERIFICATIONS: usize = 3;
/// Approximate number of moments at which the translations of one obstacle are computed.
const MOMENTS: usize = 4000;
/// Least and largest number of moments of one violation, in addition to its worst.
const MOMENTS_PER_VIOLATION: [usize; 2] = [2, 64];
/// Translations are rounded up to a multiple of this (m).
const INCREMENT: f64 = 1e-4;
/// Bisections of a translation; they leave less than a nanometre of a metre.
const BISECTIONS: usize = 30;

/// Translation of a fixed body or a keep-out zone that removes all its violations.
///
/// The whole program was checked with it: no violation of the body or zone is left.
/// Other fixed bodies are not considered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remedy {
    /// The body or zone.
    pub entity: EntityId,
    /// Translation in the base frame, along one of its axes, a multiple of 0.1 mm (m).
    pub translation: [f64; 3],
    /// Number of violations that it removes.
    pub violations: usize,
}

/// Fixed body or keep-out zone.
#[derive(Clone, Copy, PartialEq)]
enum Obstacle {
    Body(usize),
    Zone(usize),
}

/// For each of the fixed bodies and keep-out zones with the most severe violations: the shortest translation along an axis of the base frame that removes all its violations, if there is one.
///
/// # Numerics
/// A translation is the least with which the body has its required clearance at samples of all its violations, found by bisection; distances of convex bodies grow monotonically beyond it.
/// It is rounded up to 0.1 mm, verified by a check of the whole program, and extended by what is missing between the samples.
///
/// # Errors
/// [`Interrupted`]
pub fn remedies(
    cell: &Cell,
    trajectory: &Trajectory,
    options: &CheckOptions,
    report: &Report,
    stop: StopRequested<'_>,
) -> Result<Vec<Remedy>, Interrupted> {
    let context = JobContext { stop, observer: &|_| {} };
    let mut worst: Vec<(Obstacle, &Violation)> = Vec::new();
    for violation in &report.violations {
        let Some(obstacle) = obstacle_of(cell, violation) else { continue };
        match worst.iter_mut().find(|(known, _)| *known == obstacle) {
            Some((_, known)) if is_more_severe(violation, known) => *known = violation,
            Some(_) => {}
            None => worst.push((obstacle, violation)),
        }
    }
    worst.sort_by(|(_, one), (_, other)| {
        let by_kind = one.kind.severity_rank().cmp(&other.kind.severity_rank());
        by_kind.then(other.excess().total_cmp(&one.excess()))
    });
    let mut cache = CheckCache::default();
    let mut found = Vec::new();
    for &(obstacle, _) in worst.iter().take(MAX_OBSTACLES) {
        let violations: Vec<&Violation> = obstacle.violations(cell, report).collect();
        let mut needs = needed_translations(cell, trajectory, obstacle, &violations);
        needs.sort_by(|one, other| one.distance.total_cmp(&other.distance));
        'directions: for Need { direction, distance } in needs.into_iter().take(MAX_DIRECTIONS) {
            let mut distance = rounded_up(distance);
            for _ in 0..MAX_VERIFICATIONS {
                if !distance.is_finite() {
                    continue 'directions;
                }
                let translation = direction * distance;
                let moved = obstacle.translated(cell, &translation);
                let checked = cache.check(&moved, trajectory, options, context)?;
                let left = obstacle.violations(cell, &checked).map(Violation::excess);
                let Some(left) = left.reduce(f64::max) else {
                    found.push(Remedy {
                        entity: obstacle.entity(),
                        translation: translation.into(),
                        violations: violations.len(),
                    });
                    break 'directions;
                };
                distance = rounded_up(distance + left);
            }
        }
    }
    Ok(found)
}

fn rounded_up(distance: f64) -> f64 {
    // A multiple of the increment stays one, whatever its round-off.
    (distance / INCREMENT - 1e-6).ceil().max(1.0) * INCREMENT
}

fn is_more_severe(one: &Violation, other: &Violation) -> bool {
    let rank = |violation: &Violation| violation.kind.severity_rank();
    rank(one) < rank(other) || (rank(one) == rank(other) && one.excess() > other.excess())
}

/// The fixed body or zone of a violation between it and something that moves.
fn obstacle_of(cell: &Cell, violation: &Violation) -> Option<Obstacle> {
    let is_pair = matches!(
        violation.kind,
        ViolationKind::Collision
            | ViolationKind::Clearance
            | ViolationKind::SlotClearance
            | ViolationKind::KeepOut
    );
    if !is_pair {
        return None;
    }
    violation.entities.iter().find_map(|&entity| match entity {
        EntityId::Zone(zone) => Some(Obstacle::Zone(zone)),
        EntityId::Body(body) if cell.bodies[body].parent == ParentFrame::World => {
            Some(Obstacle::Body(body))
        }
        _ => None,
    })
}

impl Obstacle {
    fn entity(self) -> EntityId {
        match self {
            Self::Body(body) => EntityId::Body(body),
            Self::Zone(zone) => EntityId::Zone(zone),
        }
    }

    fn violations<'r>(
        self,
        cell: &Cell,
        report: &'r Report,
    ) -> impl Iterator<Item = &'r Violation> {
        report.violations.iter().filter(move |one| obstacle_of(cell, one) == Some(self))
    }

    fn translated(self, cell: &Cell, translation: &Vector3<f64>) -> Cell {
        let mut moved = cell.clone();
        let pose = match self {
            Self::Body(body) => &mut moved.bodies[body].parent_from_shape,
            Self::Zone(zone) => &mut moved.zones[zone].base_from_shape,
        };
        *pose = Translation3::from(*translation) * *pose;
        moved
    }
}

/// Translation along a direction that an obstacle needs.
struct Need {
    direction: Vector3<f64>,
    /// Length of the translation; infinite where a pose is unknown (m).
    distance: f64,
}

/// A moment of a violation.
struct Moment<'v> {
    step: usize,
    time: f64,
    violation: &'v Violation,
}

/// Least translations along all axes with which an obstacle has its required clearances at samples of its violations.
fn needed_translations(
    cell: &Cell,
    trajectory: &Trajectory,
    obstacle: Obstacle,
    violations: &[&Violation],
) -> [Need; 6] {
    let mut needs = [0, 1, 2, 3, 4, 5].map(|side: usize| {
        let mut direction = Vector3::zeros();
        direction[side / 2] = if side.is_multiple_of(2) { 1.0 } else { -1.0 };
        Need { direction, distance: 0.0 }
    });
    let mut moments = Vec::new();
    let [least, most] = MOMENTS_PER_VIOLATION;
    let count = (MOMENTS / violations.len().max(1)).clamp(least, most);
    for violation in violations {
        let (start, end) = (violation.start, violation.end);
        #[expect(clippy::cast_precision_loss, reason = "a few samples")]
        let at = |k: usize| start + (end - start) * k as f64 / (count - 1) as f64;
        let times = std::iter::once(violation.worst_time).chain((0..count).map(at));
        moments.extend(times.map(|time| {
            let step = trajectory.step_at(time);
            Moment { step, time, violation }
        }));
    }
    moments.sort_by(|one, other| one.time.total_cmp(&other.time));
    let mut colliders = ColliderCache::default();
    colliders.begin();
    let mut scene = Scene::new(cell, &mut colliders);
    let locations = WaferLocations::of_steps(cell, &trajectory.steps);
    let mut changes = locations.location_changes().iter().peekable();
    let mut sample = Sample::default();
    for Moment { step, time, violation } in moments {
        while let Some(change) = changes.next_if(|change| change.step < step) {
            scene.move_wafer(change, &mut colliders);
        }
        let time_in_step = (time - trajectory.times[step]).min(trajectory.step_duration(step));
        trajectory.write_sample_in_step(step, time_in_step, &mut sample);
        match scene.link_poses(&sample.positions, Vec::new()) {
            Ok(poses) => {
                let pairs = pairs_of(&scene, violation, obstacle.entity());
                for [mover, fixed] in pairs {
                    let rule = scene.clearance_rule(mover, fixed, &trajectory.steps[step]);
                    for need in &mut needs {
                        need.extend(&scene, &poses, [mover, fixed], rule);
                    }
                }
            }
            Err(_) => needs.iter_mut().for_each(|need| need.distance = f64::INFINITY),
        }
    }
    needs
}

/// Objects of the other entity of a violation, each with the object of the obstacle.
fn pairs_of(scene: &Scene<'_>, violation: &Violation, obstacle: EntityId) -> Vec<[usize; 2]> {
    let indices = |entity: EntityId| {
        let objects = scene.objects.iter().enumerate();
        objects.filter(move |(_, object)| object.entity == entity).map(|(index, _)| index)
    };
    let others = violation.entities.iter().copied().filter(|&entity| entity != obstacle);
    let movers: Vec<usize> = others.flat_map(indices).collect();
    let fixed: Vec<usize> = indices(obstacle).collect();
    movers
        .into_iter()
        .flat_map(|mover| fixed.iter().map(move |&fixed| [mover, fixed]))
        .filter(|&[mover, _]| scene.objects[mover].parent.moves())
        .collect()
}

impl Need {
    /// Extends the translation until a fixed object has its required clearance to a moving one.
    fn extend(
        &mut self,
        scene: &Scene<'_>,
        poses: &LinkPoses,
        [mover, fixed]: [usize; 2],
        rule: ClearanceRule,
    ) {
        let required = match rule {
            ClearanceRule::Unchecked => return,
            ClearanceRule::MinClearance(clearance) | ClearanceRule::SlotClearance(clearance) => {
                clearance
            }
            ClearanceRule::KeepOut => 0.0,
        };
        let (mover, placed) = (scene.collider_at(mover, poses), scene.collider_at(fixed, poses));
        let is_clear = |translation: f64| {
            let translation = Translation3::from(self.direction * translation);
            let base_from_parent: Pose = translation * *placed.base_from_parent;
            let moved =
                PlacedCollider { collider: placed.collider, base_from_parent: &base_from_parent };
            let found = distance(mover, moved);
            found > 0.0 && found >= required - CONTACT_RESOLUTION
        };
        if !self.distance.is_finite() || is_clear(self.distance) {
            return;
        }
        let along = |placed: &PlacedCollider<'_>| placed.extent_along(&self.direction);
        let (mut low, mut high) =
            (self.distance, along(&mover).max - along(&placed).min + required + INCREMENT);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if is_clear(middle) { high = middle } else { low = middle }
        }
        self.distance = high.max(self.distance);
    }
}
