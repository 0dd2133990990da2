//! Pictures of a cell and of its trajectory.

use std::collections::BTreeSet;

use jointplay::cell::EntityId;
use jointplay::cell::check::Violation;
use jointplay::cell::program::Handoff;
use jointplay::cell::robot::EffectorId;
use jointplay::cell::schedule::schedule;
use jointplay::cell::station::Origin;
use jointplay::cell::workcell::ParentFrame;
use jointplay::interop::export;
use jointplay::plot::cell::{ArmPosture, EffectorPath, Gantt, Taught, TopView};

use super::input::Planned;
use crate::failure::Failure;
use crate::figure::{svg, svg_and_png};

/// Sampling rate of the paths of wafer centres (Hz).
const PATH_RATE: f64 = 50.0;
/// Largest number of points of a path: more are not visible.
const MAX_PATH_POINTS: f64 = 40_000.0;

/// Names of the four pictures.
pub(super) const PICTURES: [&str; 4] = ["top.svg", "top.png", "gantt.svg", "gantt.png"];

/// The top view and the timing diagram, as SVG and PNG.
pub(super) fn pictures(planned: &Planned) -> Result<[(String, Vec<u8>); 4], Failure> {
    let [top_svg, top_png] = svg_and_png("top", &top_view(planned)?)?;
    let [gantt_svg, gantt_png] = svg_and_png("gantt", &gantt(planned))?;
    Ok([top_svg, top_png, gantt_svg, gantt_png])
}

/// The top view as SVG.
pub(super) fn top_view_svg(planned: &Planned) -> Result<String, Failure> {
    svg("top", &TopView { title: String::new(), ..top_view(planned)? })
}

/// The arms at the first hand-off at each station, seen from above, as SVG.
pub(super) fn postures_svg(planned: &Planned) -> Result<String, Failure> {
    let cell = planned.cell();
    let mut view = TopView::new(cell);
    view.title = String::new();
    let mut visited = BTreeSet::new();
    for step in &planned.motion.steps {
        let Some(Handoff::Picked(effector, slot) | Handoff::Placed(effector, slot)) = step.handoff
        else {
            continue;
        };
        if visited.insert(slot.station) {
            let pose = cell.forward_with_deflection(&step.to, &step.loaded)?;
            view.postures.push(ArmPosture { effector, pose });
        }
    }
    svg("arms", &view)
}

/// Parts of the timing diagram as SVG, without titles.
///
/// # Arguments
/// * `windows` – start and end of each part (s)
/// * `max_bands` – largest number of bands of a part
pub(super) fn gantt_svgs(
    planned: &Planned,
    windows: &[[f64; 2]],
    max_bands: u32,
) -> Result<Vec<String>, Failure> {
    let whole = Gantt { title: String::new(), max_bands, ..gantt(planned) };
    let part = |&window| svg("gantt", &Gantt { window, ..whole.clone() });
    windows.iter().map(part).collect()
}

/// The taught stations as SVG; none without taught stations.
pub(super) fn taught_svg(planned: &Planned) -> Result<Option<String>, Failure> {
    let stations = &planned.cell().stations;
    let is_taught = |&index: &usize| matches!(stations[index].origin, Origin::Taught(_));
    let stations: Vec<usize> = (0..stations.len()).filter(is_taught).collect();
    if stations.is_empty() {
        return Ok(None);
    }
    svg("stations", &Taught { stations, title: String::new(), ..Taught::new(planned.cell()) })
        .map(Some)
}

fn top_view(planned: &Planned) -> Result<TopView<'_>, Failure> {
    let robot = &planned.cell().robot;
    let rate = PATH_RATE.min(MAX_PATH_POINTS / planned.motion.duration().max(1.0));
    let paths = export::tracks(&planned.motion_export(), rate)?;
    let mut view = TopView::new(planned.cell());
    for (effector, points) in planned.effectors().into_iter().zip(paths) {
        let reach = robot.reach_range(effector)?;
        view.paths.push(EffectorPath { effector, reach, points });
    }
    for one in &planned.report.violations {
        let sample = planned.motion.sample_at(one.worst_time);
        let loaded = planned.motion.steps.get(sample.step).map_or(&[][..], |step| &step.loaded);
        let pose = planned.cell().forward_with_deflection(&sample.positions, loaded)?;
        for id in involved(planned, one) {
            let at = pose.base_from_wafer[id.arm][id.effector].translation.vector;
            view.violations.push([at.x, at.y]);
        }
        let known = |entity: &&EntityId| !view.violating.contains(entity);
        let entities: Vec<EntityId> = one.entities.iter().filter(known).copied().collect();
        view.violating.extend(entities);
    }
    Ok(view)
}

/// Effectors involved in a violation: those named, those of arms with named bodies, else those that carry wafers.
fn involved(planned: &Planned, one: &Violation) -> Vec<EffectorId> {
    let cell = planned.cell();
    let all = planned.effectors();
    let named = |id: &EffectorId| {
        one.entities.iter().any(|&entity| match entity {
            EntityId::Effector(effector) => effector == *id,
            EntityId::Body(body) => {
                matches!(cell.bodies[body].parent, ParentFrame::Link { arm, .. } if arm == id.arm)
            }
            _ => false,
        })
    };
    let found: Vec<EffectorId> = all.into_iter().filter(named).collect();
    if found.is_empty() { planned.motion.steps[one.step].loaded.clone() } else { found }
}

fn gantt(planned: &Planned) -> Gantt {
    let violations: Vec<[f64; 2]> =
        planned.report.violations.iter().map(|one| [one.start, one.end]).collect();
    let (cell, motion) = (planned.cell(), &planned.motion);
    let title = format!("{}: axes, wafers and stations over time", cell.name);
    Gantt::new(&title, cell, motion, &schedule(cell, motion), &planned.input.text, &violations)
}
