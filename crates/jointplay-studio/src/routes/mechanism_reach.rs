//! `POST /api/v1/mechanism/reach`: a point of a link, moved by hand.

use axum::Json;
use axum::extract::State;
use jointplay::format::display_units::DisplayUnits;
use jointplay::mechanism::{
    Kinematics, PointTarget, ReachedPoint, exaggerated_link_poses, reach_point,
};
use jointplay::nalgebra::Vector3;

use crate::body::Body;
use crate::mechanism_source::{self, play_scale};
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::mechanism_view::{ReachRequest, ReachedDocument};
use crate::wire::{self, Triple};

/// A distance below this is none (m).
const REACHED: f64 = 1e-7;

/// Move a point of a link as near as possible to a position
///
/// The mechanism moves along its closed configurations within joint limits, on the branch of the configuration where it begins, until the distance has a local minimum. With virtual joints, its actuators move, and the virtual joints take their least displacement.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/reach",
    operation_id = "mechanism_reach",
    request_body = ReachRequest,
    responses(
        (status = 200, description = "The configuration", body = ReachedDocument),
        (status = 409, description = "The loops are not closed where the motion begins", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mechanism_reach(
    State(state): State<AppState>,
    Body(request): Body<ReachRequest>,
) -> Result<Json<ReachedDocument>, Problem> {
    state.work.run(move || reach(&request)).await.map(Json)
}

fn reach(request: &ReachRequest) -> Result<ReachedDocument, Problem> {
    let scale = play_scale(request.play_scale)?;
    let read = mechanism_source::required(&request.mechanism)?;
    let from = read.closed_at(read.checked(&request.from, "from")?)?;
    let mechanism = &read.file.mechanism;
    let unknown = || Problem::field("link", format!("unknown link {:?}", request.link));
    let link = mechanism.links().iter().position(|name| *name == request.link);
    let link = link.ok_or_else(unknown)?;
    let point = vector(request.point_m, "point_m")?;
    let poses = Kinematics::new(mechanism).link_poses(&from.coordinates)?;
    let position = poses[link].rotation * point + poses[link].translation.vector;
    let Some(to) = request.to_m else {
        return Ok(ReachedDocument {
            configuration: read.configuration(&from, scale)?,
            position_m: Triple(position.into()),
            distance_m: 0.0,
            at_limits: Vec::new(),
            message: None,
        });
    };
    let mut to = vector(to, "to_m")?;
    if request.as_drawn {
        let drawn = exaggerated_link_poses(mechanism, &from.coordinates, scale)?[link];
        to += position - (drawn.rotation * point + drawn.translation.vector);
    }
    let target = PointTarget { link, point_in_link: point, position_in_base: to };
    let found = reach_point(mechanism, &from.coordinates, &target)?;
    let names = found.at_limits.iter().map(|&k| read.coordinates.all()[k].name.clone());
    let at_limits: Vec<String> = names.collect();
    Ok(ReachedDocument {
        message: message(&found, &at_limits, DisplayUnits::of(read.file.units.length)),
        configuration: read.configuration(&found.closed, scale)?,
        position_m: Triple(found.position_in_base.into()),
        distance_m: found.distance,
        at_limits,
    })
}

fn vector(Triple(values): Triple, field: &str) -> Result<Vector3<f64>, Problem> {
    for (k, &value) in values.iter().enumerate() {
        wire::length(value, &format!("{field}[{k}]"))?;
    }
    Ok(Vector3::from(values))
}

/// The remaining distance, and what keeps the point there.
fn message(found: &ReachedPoint, at_limits: &[String], units: DisplayUnits) -> Option<String> {
    if found.distance <= REACHED {
        return None;
    }
    let distance = units.length(found.distance, 4);
    Some(match at_limits {
        [] => format!("The nearest reachable position is {distance} away."),
        [one] => format!("The nearest position within the limits of {one} is {distance} away."),
        several => {
            let several = several.join(", ");
            format!("The nearest position within the limits of {several} is {distance} away.")
        }
    })
}
