//! One pose of the robot, checked as the poses of a program are; and how far it may go straight until something touches.

use super::checker::examine;
use super::options::CheckOptions;
use super::report::Report;
use super::segments::Steps;
use crate::collision::Scene;
use crate::geometry::Solids;
use crate::incremental::{Execution, uninterrupted};
use crate::program::{Path, Phase, Place, Step};
use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::trajectory::{Trajectory, straight};
use crate::violation::Kind;
use crate::workcell::Cell;
use crate::{CellError, EntityId};

/// How often the last part before a contact is halved: what is left of a metre is a nanometre.
const HALVINGS: usize = 30;
/// How often a path that was cut short is checked again, something having been touched before.
const MOST_CUTS: usize = 16;
/// Share of a path within which the last state without contact is found.
const BEFORE: f64 = 1e-9;
/// Share of a path that is left to the contact.
const MARGIN: f64 = 1e-7;

/// Who carries what, and what the robot is about: the state in which a pose is judged.
#[derive(Debug, Clone, Copy)]
pub struct Moment<'m> {
    /// The motion of a program.
    pub motion: &'m Trajectory,
    /// Time in it that says where wafers are [s].
    pub time: f64,
    /// The effector that reaches into a slot, and the slot; without it, those of the step at that time.
    pub reaches: Option<(EffectorId, SlotId)>,
}

/// How far a path leads without a contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Straight {
    /// Positions of all axes, rods first ([m], [rad]).
    pub positions: Vec<f64>,
    /// Share of the path, 1 where nothing stops it.
    pub share: f64,
    /// The two collision objects that touch beyond, where something stops it.
    pub touching: Option<[EntityId; 2]>,
}

/// What is wrong with one pose: limits of axes and of the tilt, play, droop, distances and zones.
///
/// Poses, pairs, allowed pairs and distances asked for are those of [`check`](super::check); the robot stands still.
/// `distances` of the report lists the minimum distance of each relevant pair that is nearer than `near` of the options.
///
/// # Errors
/// As [`HybridRobot::forward`](crate::robot::HybridRobot::forward) for positions that are not those of the robot's axes.
pub fn check_pose(
    cell: &Cell,
    moment: &Moment<'_>,
    positions: &[f64],
    options: &CheckOptions,
) -> Result<Report, CellError> {
    cell.robot.check_positions(positions)?;
    Ok(Held::new(cell, moment).pose(positions, options))
}

/// The last state without contact on the straight path of all axes from one pose toward another.
///
/// The path is checked as that of a program is, between its samples too.
/// A contact is a distance of zero, or a body in a zone that it must not enter; pairs that touch at the start are left out, so that a robot in contact can be moved out of it.
///
/// # Errors
/// As [`check_pose`], for both poses.
pub fn advance_until_contact(
    cell: &Cell,
    moment: &Moment<'_>,
    [from, to]: [&[f64]; 2],
    options: &CheckOptions,
) -> Result<Straight, CellError> {
    cell.robot.check_positions(from)?;
    cell.robot.check_positions(to)?;
    Ok(Held::new(cell, moment).straight([from, to], options))
}

/// Wafers where they are at one moment.
struct Held<'a> {
    cell: &'a Cell,
    solids: Solids,
    scene: Scene<'a>,
    template: Step,
}

impl<'a> Held<'a> {
    fn new(cell: &'a Cell, moment: &Moment<'_>) -> Self {
        let Moment { motion, time, reaches } = *moment;
        let mut solids = Solids::default();
        solids.begin();
        let mut scene = Scene::new(cell, &mut solids);
        let ended = motion.times.iter().skip(1).take_while(|&&end| end <= time).count();
        for handover in motion.steps.iter().take(ended).filter_map(|step| step.handover) {
            scene.hand_over(handover, &mut solids);
        }
        let current = motion.steps.get(ended.min(motion.steps.len().saturating_sub(1)));
        let of_step = current.and_then(|step| match step.path {
            Path::Line(id) => Some((id, step.slot?, step.phase)),
            _ => None,
        });
        // Whoever reaches into a slot by hand may lift its wafer.
        let reaches = reaches.map(|(id, slot)| (id, slot, Phase::Lift)).or(of_step);
        let loaded = cell.robot.effectors().filter(|&id| scene.carried_by(id).is_some());
        let template = Step {
            instruction: 0,
            place: Place::default(),
            phase: reaches.map_or(Phase::Move, |(.., phase)| phase),
            from: Vec::new(),
            to: Vec::new(),
            path: reaches.map_or(Path::PointToPoint, |(id, ..)| Path::Line(id)),
            speed: 1.0,
            blend: 0.0,
            line_speed: None,
            loaded: loaded.collect(),
            handover: None,
            slot: reaches.map(|(_, slot, _)| slot),
        };
        Self { cell, solids, scene, template }
    }

    fn report(&mut self, [from, to]: [&[f64]; 2], options: &CheckOptions) -> (Trajectory, Report) {
        let mut step = self.template.clone();
        (step.from, step.to) = (from.to_vec(), to.to_vec());
        let motion = straight(step);
        let all = (&motion, 0..motion.steps.len());
        let (scene, execution) = (self.scene.clone(), Execution::unobserved());
        let (steps, starts) =
            uninterrupted(Steps::new(all, options, scene, &mut self.solids, execution));
        let report = examine(self.cell, &motion, steps, &starts);
        (motion, report)
    }

    fn pose(&mut self, positions: &[f64], options: &CheckOptions) -> Report {
        self.report([positions, positions], options).1
    }

    fn straight(&mut self, [from, to]: [&[f64]; 2], options: &CheckOptions) -> Straight {
        let at_start = contacts(&self.pose(from, options));
        let new = |report: &Report| -> Option<[EntityId; 2]> {
            contacts(report).into_iter().find(|pair| !at_start.contains(pair))
        };
        let at = |share: f64| -> Vec<f64> {
            from.iter().zip(to).map(|(from, to)| from + share * (to - from)).collect()
        };
        let (mut share, mut touching) = (1.0, None);
        for _ in 0..MOST_CUTS {
            let end = if share == 1.0 { to.to_vec() } else { at(share) };
            let (motion, report) = self.report([from, &end], options);
            // A violation begins where a pair comes too near; at its worst time it touches.
            let new_contacts = report.violations.iter().filter(|one| {
                is_contact(one.kind)
                    && pair_of(&one.entities).is_some_and(|pair| !at_start.contains(&pair))
            });
            let first =
                new_contacts.min_by(|one, other| one.worst_time.total_cmp(&other.worst_time));
            let Some(first) = first else {
                return Straight { positions: end, share, touching };
            };
            touching = pair_of(&first.entities);
            // Where that is, as a share of the whole path.
            let reached = motion.sample_at(first.worst_time).positions;
            let (mut free, mut touched) = (0.0, share_of([from, to], &reached).min(share));
            for _ in 0..HALVINGS {
                let middle = 0.5 * (free + touched);
                if touched - free < BEFORE {
                    break;
                }
                match new(&self.pose(&at(middle), options)) {
                    Some(_) => touched = middle,
                    None => free = middle,
                }
            }
            // Before it by more than what distances are compared with.
            share = (free - MARGIN).max(0.0);
        }
        // As often as it was cut, something was touched before.
        Straight { positions: from.to_vec(), share: 0.0, touching }
    }
}

/// The share of a straight path at which positions are.
fn share_of([from, to]: [&[f64]; 2], at: &[f64]) -> f64 {
    let (mut along, mut squares) = (0.0, 0.0);
    for ((from, to), at) in from.iter().zip(to).zip(at) {
        along += (at - from) * (to - from);
        squares += (to - from).powi(2);
    }
    if squares > 0.0 { (along / squares).clamp(0.0, 1.0) } else { 1.0 }
}

fn is_contact(kind: Kind) -> bool {
    matches!(kind, Kind::Collision | Kind::KeepOut)
}

fn pair_of(entities: &[EntityId]) -> Option<[EntityId; 2]> {
    entities.try_into().ok()
}

/// The pairs that touch.
fn contacts(report: &Report) -> Vec<[EntityId; 2]> {
    let touching = report.violations.iter().filter(|one| is_contact(one.kind));
    touching.filter_map(|one| pair_of(&one.entities)).collect()
}
