//! `POST /api/v1/pose`: all that one picture of the robot needs.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use jointplay::format::explain::explain;
use jointplay::gpr::{BrokenLimit, Gpr};
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Planar, SolveOptions, Virtualization};

use super::solve_command;
use crate::body::Body;
use crate::display::display_units;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::pose::{
    AnswerDocument, AtLimits, MAX_MODELS, MobilityDocument, ModelDocument, PoseDocument,
    PoseRequest,
};
use crate::wire::{self, ModelChoice, Rods};

/// One pose under several models, with mobility and sensitivity
///
/// A pose beyond the limits of the robot is computed, and the violated limits are listed. With `from_rods_m` within the limits, the robot moves in a straight line in rod space and stops at the first limit. With `at_limits` of `slide`, it has the nearest rods within the limits, and the limits that hold it are listed in `stopped_by`.
/// A model without a solution gives the reason.
#[utoipa::path(
    post,
    path = "/api/v1/pose",
    operation_id = "pose",
    request_body = PoseRequest,
    responses(
        (status = 200, description = "The pose", body = PoseDocument),
        (status = 409, description = "There is no pose for this command", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn pose(
    State(state): State<AppState>,
    Body(request): Body<PoseRequest>,
) -> Result<Json<PoseDocument>, Problem> {
    let work = state.work.clone();
    work.run(move || compute(&state.robot(request.robot.as_ref())?.gpr, request)).await.map(Json)
}

fn compute(gpr: &Gpr, request: PoseRequest) -> Result<PoseDocument, Problem> {
    let PoseRequest {
        robot: _,
        command,
        from_rods_m: from,
        at_limits,
        models: choices,
        mobility: with_mobility,
        bounds,
    } = request;
    let asked = choices.len();
    if !(1..=MAX_MODELS).contains(&asked) {
        let detail = format!("{asked} models are given, 1 to {MAX_MODELS} are allowed");
        return Err(Problem::field("models", detail));
    }
    let models: Vec<(&ModelChoice, SolveOptions)> = choices
        .iter()
        .enumerate()
        .map(|(i, choice)| Ok((choice, choice.options(&format!("models[{i}]"))?)))
        .collect::<Result<_, Problem>>()?;
    let (first, options) = &models[0];
    let target = command.read(gpr, "command")?;
    let (rods, tilt) = solve_command(gpr, target, first.model(), options)?;
    let broken: Vec<BrokenLimit> = gpr.limits().broken(&rods, tilt).iter().collect();
    let from = from.map(|Rods(from)| wire::rods(from, "from_rods_m")).transpose()?;
    let within = |from: &[f64; 3]| gpr.limits().broken(from, gpr.plane_tilt(from)).is_empty();
    let (rods, broken, stopped_by) = match from.filter(within) {
        _ if at_limits == AtLimits::Slide => {
            let nearest = gpr.nearest_rods(&rods).ok_or_else(|| {
                let detail = "no rods within the limits are near this command";
                Problem::request(StatusCode::CONFLICT, detail)
            })?;
            (nearest.rods, Vec::new(), nearest.held_by.iter().collect())
        }
        Some(from) => (gpr.clamp_to_limits(&from, &rods), Vec::new(), broken),
        None => (rods, broken, Vec::new()),
    };
    let approximate = gpr.approximate(gpr.plane_tilt(&rods), gpr.plane_height(&rods))?;
    let mut document = PoseDocument::new(gpr, rods, &broken, &stopped_by, &approximate);
    for (choice, options) in models {
        let found = answer(gpr, rods, choice.model(), &options, bounds, with_mobility);
        let (answer, problem) = match found {
            Ok(answer) => (Some(answer), None),
            Err(error) => (None, Some(explain(&error, display_units()))),
        };
        document.models.push(ModelDocument { model: *choice, answer, problem });
    }
    if with_mobility {
        document.mobility = Some(mobility(gpr, rods)?);
    }
    Ok(document)
}

/// The platform at given rods under a model.
pub(super) fn answer(
    gpr: &Gpr,
    rods: [f64; 3],
    model: &(dyn Virtualization + Sync),
    options: &SolveOptions,
    bounds: bool,
    with_mobility: bool,
) -> Result<AnswerDocument, jointplay::Error> {
    let pose = gpr.forward(rods, model, options)?;
    let play = if bounds {
        let level = gpr.forward(gpr.inverse(Tilt::LEVEL, pose.axis_height())?, model, options)?;
        Some(gpr.play_between(level, pose, model)?)
    } else {
        None
    };
    let augmented = if with_mobility {
        let system = gpr.system(model);
        Some(augmented_mobility(&system, &system.configuration(&pose), RANK_THRESHOLD)?)
    } else {
        None
    };
    Ok(AnswerDocument::new(gpr, &pose, model, play.as_ref(), augmented.as_ref()))
}

/// The rigid mechanism has locked virtual joints; it does not depend on the virtualization.
fn mobility(gpr: &Gpr, rods: [f64; 3]) -> Result<MobilityDocument, Problem> {
    let system = gpr.system(&Planar);
    let at = system.configuration(&gpr.forward(rods, &Planar, &SolveOptions::default())?);
    let found = finite_mobility(&system, &at, RANK_THRESHOLD)?;
    Ok(MobilityDocument::new(gpr.kutzbach_mobility(), &found))
}
