//! Pictures of a cell and of its motion.

use jointplay::cell::EntityId;
use jointplay::cell::check::Violation;
use jointplay::cell::robot::EffectorId;
use jointplay::cell::workcell::Carrier;
use jointplay::interop::export;
use jointplay::plot;
use jointplay::plot::cell::{Gantt, TopView, Track};

use super::input::Planned;
use crate::failure::Failure;

/// Width of a PNG figure [px].
pub(super) const PNG_WIDTH: u32 = 1800;
/// Points of the paths of wafer centres [Hz].
const POINTS: f64 = 50.0;
/// And at most: a picture shows no more.
const MOST_POINTS: f64 = 40_000.0;

/// Names of the four pictures.
pub(super) const PICTURES: [&str; 4] = ["top.svg", "top.png", "gantt.svg", "gantt.png"];

/// The cell from above and the axes over time, as SVG and PNG.
pub(super) fn pictures(planned: &Planned) -> Result<[(String, Vec<u8>); 4], Failure> {
    let (top, gantt) = (top_view(planned)?, gantt(planned));
    let failed = |name: &'static str| {
        move |source: plot::Error| Failure::Figure { figure: name.to_owned(), source }
    };
    let [top_svg, top_png, gantt_svg, gantt_png] = PICTURES;
    Ok([
        (top_svg.to_owned(), top.to_svg().map_err(failed(top_svg))?.into_bytes()),
        (top_png.to_owned(), top.to_png(PNG_WIDTH).map_err(failed(top_png))?),
        (gantt_svg.to_owned(), gantt.to_svg().map_err(failed(gantt_svg))?.into_bytes()),
        (gantt_png.to_owned(), gantt.to_png(PNG_WIDTH).map_err(failed(gantt_png))?),
    ])
}

fn top_view(planned: &Planned) -> Result<TopView<'_>, Failure> {
    let robot = &planned.cell().robot;
    let rate = POINTS.min(MOST_POINTS / planned.motion.duration().max(1.0));
    let ways = export::tracks(&planned.motion_export(), rate)?;
    let mut view = TopView::new(planned.cell());
    for (effector, points) in planned.effectors().into_iter().zip(ways) {
        let reach = robot.reach(effector)?;
        view.tracks.push(Track { effector, reach, points });
    }
    for one in &planned.report.violations {
        let sample = planned.motion.sample_at(one.worst_time);
        let loaded = planned.motion.steps.get(sample.step).map_or(&[][..], |step| &step.loaded);
        let pose = planned.cell().drooping(&sample.positions, loaded)?;
        for id in concerned(planned, one) {
            let at = pose.base_from_wafer[id.arm][id.effector].translation.vector;
            view.wrong.push([at.x, at.y]);
        }
        let known = |entity: &&EntityId| !view.broken.contains(entity);
        let entities: Vec<EntityId> = one.entities.iter().filter(known).copied().collect();
        view.broken.extend(entities);
    }
    Ok(view)
}

/// Effectors that a violation is about: those named, those of arms whose bodies are named, else those that carry wafers.
fn concerned(planned: &Planned, one: &Violation) -> Vec<EffectorId> {
    let cell = planned.cell();
    let all = planned.effectors();
    let named = |id: &EffectorId| {
        one.entities.iter().any(|&entity| match entity {
            EntityId::Effector(effector) => effector == *id,
            EntityId::Body(body) => {
                matches!(cell.bodies[body].carrier, Carrier::Link { arm, .. } if arm == id.arm)
            }
            _ => false,
        })
    };
    let found: Vec<EffectorId> = all.into_iter().filter(named).collect();
    if found.is_empty() { planned.motion.steps[one.step].loaded.clone() } else { found }
}

fn gantt(planned: &Planned) -> Gantt {
    let wrong: Vec<[f64; 2]> =
        planned.report.violations.iter().map(|one| [one.start, one.end]).collect();
    let title = format!("{}: axes over time", planned.cell().name);
    Gantt::new(&title, planned.cell(), &planned.motion, &planned.input.text, &wrong)
}
