//! Pictures of a cell and of its checked motion.

use std::collections::BTreeSet;

use jointplay_cell::check::{Report, Violation};
use jointplay_cell::program::Handoff;
use jointplay_cell::robot::EffectorId;
use jointplay_cell::schedule::schedule;
use jointplay_cell::station::Origin;
use jointplay_cell::workcell::{Cell, ParentFrame};
use jointplay_cell::{CellError, EntityId};
use jointplay_plot::cell::{ArmPosture, EffectorPath, Gantt, Taught, TopView};

use super::error::Error;
use super::motion_export::MotionExport;
use super::samples::tracks;

/// Sampling rate of the paths of wafer centres (Hz).
const PATH_RATE: f64 = 50.0;
/// Largest number of points of a path: more are not visible.
const MAX_PATH_POINTS: f64 = 40_000.0;

/// Error of a picture of a motion, or of a page with pictures.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// The motion cannot be sampled.
    #[error(transparent)]
    Samples(#[from] Error),
    /// A pose of the robot cannot be computed.
    #[error(transparent)]
    Pose(#[from] CellError),
    /// A picture cannot be drawn.
    #[error("cannot draw {picture}: {source}")]
    Drawing {
        /// Name of the picture.
        picture: &'static str,
        /// Reason.
        source: jointplay_plot::Error,
    },
}

/// The cell from above, with the paths of the wafer centres and the violations.
///
/// # Errors
/// [`PictureError::Samples`], [`PictureError::Pose`]
pub fn top_view<'a>(
    motion_export: &MotionExport<'a>,
    report: &Report,
) -> Result<TopView<'a>, PictureError> {
    let MotionExport { cell, motion, .. } = *motion_export;
    let rate = PATH_RATE.min(MAX_PATH_POINTS / motion.duration().max(1.0));
    let paths = tracks(motion_export, rate)?;
    let mut view = TopView::new(cell);
    for (effector, points) in cell.robot.effectors().zip(paths) {
        let reach = cell.robot.reach_range(effector)?;
        view.paths.push(EffectorPath { effector, reach, points });
    }
    for one in &report.violations {
        let sample = motion.sample_at(one.worst_time);
        let loaded = motion.steps.get(sample.step).map_or(&[][..], |step| &step.loaded);
        let pose = cell.forward_with_deflection(&sample.positions, loaded)?;
        for id in involved(motion_export, one) {
            let at = pose.base_from_wafer[id.arm][id.effector].translation.vector;
            view.violations.push([at.x, at.y]);
        }
        let known = |entity: &&EntityId| !view.violating.contains(entity);
        let entities: Vec<EntityId> = one.entities.iter().filter(known).copied().collect();
        view.violating.extend(entities);
    }
    Ok(view)
}

/// The arms at the first hand-off at each station, seen from above, without a title.
///
/// # Errors
/// [`PictureError::Pose`]
pub fn postures_view<'a>(motion_export: &MotionExport<'a>) -> Result<TopView<'a>, PictureError> {
    let MotionExport { cell, motion, .. } = *motion_export;
    let mut view = TopView::new(cell);
    view.title = String::new();
    let mut visited = BTreeSet::new();
    for step in &motion.steps {
        let Some(Handoff::Picked(effector, slot) | Handoff::Placed(effector, slot)) = step.handoff
        else {
            continue;
        };
        if visited.insert(slot.station) {
            let pose = cell.forward_with_deflection(&step.to, &step.loaded)?;
            view.postures.push(ArmPosture { effector, pose });
        }
    }
    Ok(view)
}

/// The timing diagram of a checked motion: axes, wafers and stations over time.
#[must_use]
pub fn timing_diagram(motion_export: &MotionExport<'_>, report: &Report) -> Gantt {
    let MotionExport { cell, motion, program, .. } = *motion_export;
    let violations: Vec<[f64; 2]> =
        report.violations.iter().map(|one| [one.start, one.end]).collect();
    let title = format!("{}: axes, wafers and stations over time", cell.name);
    Gantt::new(&title, cell, motion, &schedule(cell, motion), program, &violations)
}

/// The planes of the taught stations, without a title; `None` without taught stations.
#[must_use]
pub fn taught_planes(cell: &Cell) -> Option<Taught<'_>> {
    let is_taught = |&index: &usize| matches!(cell.stations[index].origin, Origin::Taught(_));
    let stations: Vec<usize> = (0..cell.stations.len()).filter(is_taught).collect();
    let any = !stations.is_empty();
    any.then(|| Taught { stations, title: String::new(), ..Taught::new(cell) })
}

/// Effectors involved in a violation: those named, those of arms with named bodies, else those that carry wafers.
fn involved(motion_export: &MotionExport<'_>, one: &Violation) -> Vec<EffectorId> {
    let cell = motion_export.cell;
    let named = |id: &EffectorId| {
        one.entities.iter().any(|&entity| match entity {
            EntityId::Effector(effector) => effector == *id,
            EntityId::Body(body) => {
                matches!(cell.bodies[body].parent, ParentFrame::Link { arm, .. } if arm == id.arm)
            }
            _ => false,
        })
    };
    let found: Vec<EffectorId> = cell.robot.effectors().filter(named).collect();
    if found.is_empty() { motion_export.motion.steps[one.step].loaded.clone() } else { found }
}
