//! `POST /api/v1/mechanism/suggest`: virtual joints that make a motion possible, ready to be applied.

use axum::Json;
use axum::extract::State;
use jointplay::format::mechanism::{Units, with_virtual_joints};
use jointplay::interop::FileKind;
use jointplay::mechanism::{
    Commands, MechanismSystem, SuggestOptions, close_nearly, small_commands, suggest,
};
use jointplay::nalgebra::DVector;
use jointplay::report;

use crate::body::Body;
use crate::mechanism_source::{self, too_large};
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::mechanism_view::{SuggestDocument, SuggestRequest};

/// Number of sets with their texts.
const TEXTS: usize = 10;

/// Find the virtual joints with the least displacement that make a motion possible
///
/// The report is that of `jointplay suggest --format json`. Without a command, each actuated joint is displaced by a small amount, one at a time.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/suggest",
    operation_id = "mechanism_suggest",
    request_body = SuggestRequest,
    responses(
        (status = 200, description = "The sets of virtual joints", body = SuggestDocument),
        (status = 409, description = "The loops cannot be closed", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn suggest_virtual_joints(
    State(state): State<AppState>,
    Body(request): Body<SuggestRequest>,
) -> Result<Json<SuggestDocument>, Problem> {
    state.work.run(move || compute(&request)).await.map(Json)
}

fn compute(request: &SuggestRequest) -> Result<SuggestDocument, Problem> {
    let mut read = mechanism_source::required(&request.mechanism)?;
    let bare = read.file.mechanism.clone().with_virtual_joints(Vec::new());
    let bare = bare.expect("a mechanism without virtual joints is valid");
    MechanismSystem::check_size(&bare).map_err(|error| too_large(&error))?;
    let home = close_nearly(&read.file.mechanism)?.coordinates;
    read.file.mechanism = bare;
    read.coordinates = jointplay::format::coordinates::Coordinates::of(&read.file);
    let mechanism = &read.file.mechanism;
    let commands = read.commands(&request.command, "command")?;
    let commands = if commands.is_empty() {
        let detail = "the mechanism has no actuated joint: command joints by `command`";
        small_commands(mechanism, &home)?.ok_or_else(|| Problem::field("command", detail))?
    } else {
        let (commanded, values): (Vec<usize>, Vec<f64>) = commands.into_iter().unzip();
        Commands { commanded, values: vec![DVector::from_vec(values)] }
    };
    let Commands { commanded, values } = commands;
    let found = suggest(mechanism, &home, &commanded, &values, &SuggestOptions::default())?;
    let all = &read.coordinates;
    let names = commanded.iter().map(|&k| all.all()[k].name.clone()).collect();
    let in_units = |command: &DVector<f64>| {
        commanded.iter().zip(command.iter()).map(|(&k, &value)| all.from_si(k, value)).collect()
    };
    let in_units = values.iter().map(in_units).collect();
    let units = if read.kind == FileKind::Mechanism { read.file.units } else { Units::SI };
    let replaced: Vec<(String, f64)> =
        request.mechanism.parameters.iter().map(|(name, &value)| (name.clone(), value)).collect();
    let text = |set: &jointplay::mechanism::Suggestion| {
        with_virtual_joints(&read.text, mechanism, units, &set.virtual_joints, &replaced)
            .map_err(|error| Problem::field("mechanism.text", error.to_string()))
    };
    Ok(SuggestDocument {
        texts: found.sets.iter().take(TEXTS).map(text).collect::<Result<_, _>>()?,
        report: report::suggestions(&read.file, names, in_units, &found),
    })
}
