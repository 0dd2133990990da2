//! `POST /api/v1/mechanism/poses`: poses of the links of any mechanism.

use std::collections::BTreeMap;

use axum::Json;
use axum::extract::State;
use jointplay::format::catalogue;
use jointplay::format::coordinates::Coordinates;
use jointplay::format::mechanism::MechanismFile;
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{Kinematics, pose_commanded};
use jointplay::nalgebra::DVector;
use jointplay::report;

use crate::body::Body;
use crate::mechanism_source::{self, ReadMechanism, Unread, how_to_open};
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::mechanism::{
    CoordinateDocument, MechanismFrame, MechanismPosesDocument, MechanismPosesRequest,
};
use crate::wire::mechanism_view::MechanismSource;

/// The poses of all links and attached frames of a mechanism
///
/// The mechanism is the text of a file or an entry of the catalogue; commanded joints are closed with rigid links, or with the least displacement of the virtual joints.
#[utoipa::path(
    post,
    path = "/api/v1/mechanism/poses",
    operation_id = "mechanism_poses",
    request_body = MechanismPosesRequest,
    responses(
        (status = 200, description = "The poses", body = MechanismPosesDocument),
        (status = 409, description = "The loops cannot be closed", body = Problem, content_type = "application/problem+json"),
        (status = "4XX", description = "The request is invalid", body = Problem, content_type = "application/problem+json"),
        (status = "5XX", description = "The server cannot process the request", body = Problem, content_type = "application/problem+json"),
    )
)]
pub(crate) async fn mechanism_poses(
    State(state): State<AppState>,
    Body(request): Body<MechanismPosesRequest>,
) -> Result<Json<MechanismPosesDocument>, Problem> {
    state.work.run(move || compute(&request)).await.map(Json)
}

/// The mechanism of a request.
fn read(request: &MechanismPosesRequest) -> Result<ReadMechanism, Problem> {
    let name = match (&request.mechanism, &request.catalogue) {
        (Some(source), None) => return mechanism_source::required(source),
        (None, Some(name)) => name,
        _ => return Err(Problem::field("", "expected either `mechanism` or `catalogue`")),
    };
    let unknown = || Problem::field("catalogue", format!("unknown entry {name:?}"));
    let entry = catalogue::find(name).ok_or_else(unknown)?;
    let text = entry.text.to_owned();
    let source = MechanismSource { text, loops: None, parameters: BTreeMap::new() };
    mechanism_source::read(&source).map_err(|unread| match unread {
        Unread::OtherKind(kind) => Problem::field("catalogue", how_to_open(kind)),
        Unread::Invalid(_) => unknown(),
    })
}

fn compute(request: &MechanismPosesRequest) -> Result<MechanismPosesDocument, Problem> {
    let ReadMechanism { file, coordinates, .. } = read(request)?;
    let mechanism = &file.mechanism;
    let mut commands = BTreeMap::new();
    for (name, &value) in &request.at {
        let failed = |why: String| Problem::field(format!("at.{name}"), why);
        let k = coordinates.find(mechanism, name).map_err(|error| failed(error.to_string()))?;
        let value = coordinates.checked(k, value);
        commands.insert(k, value.map_err(|error| failed(error.to_string()))?);
    }
    let commands: Vec<(usize, f64)> = commands.into_iter().collect();
    let closed = pose_commanded(mechanism, &commands, None)?.closed.coordinates;
    document(&file, &coordinates, &closed)
}

fn document(
    file: &MechanismFile,
    coordinates: &Coordinates,
    closed: &DVector<f64>,
) -> Result<MechanismPosesDocument, Problem> {
    let mechanism = &file.mechanism;
    let kinematics = Kinematics::new(mechanism);
    let links = kinematics.link_poses(closed)?;
    let frames = mechanism.moving_frames().map(|frame| MechanismFrame {
        name: mechanism.frame_name(frame).to_owned(),
        pose: (&kinematics.frame_pose(frame, &links)).into(),
    });
    let values = coordinates.all().iter().zip(closed.iter()).map(|(named, &value)| {
        let unit = match named.quantity {
            Coordinate::Slide => "m",
            Coordinate::Turn => "rad",
        };
        CoordinateDocument { name: named.name.clone(), value, unit }
    });
    let beyond = mechanism.beyond_limits(closed);
    Ok(MechanismPosesDocument {
        name: mechanism.name().to_owned(),
        base: mechanism.links()[0].clone(),
        frames: frames.collect(),
        coordinates: values.collect(),
        limits_broken: report::beyond_limits(coordinates, &beyond),
    })
}
