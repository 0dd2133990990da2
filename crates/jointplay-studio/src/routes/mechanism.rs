//! `POST /api/v1/mechanism/poses`: poses of the links of any mechanism.

use std::collections::BTreeMap;

use axum::Json;
use axum::extract::State;
use jointplay::format::catalogue;
use jointplay::format::coordinates::Coordinates;
use jointplay::format::mechanism::{self, MechanismFile};
use jointplay::format::{robot, three_rods};
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{Kinematics, pose_commanded};
use jointplay::nalgebra::DVector;
use jointplay::report;
use jointplay::virtualization::BuiltIn;

use crate::body::Body;
use crate::problem::Problem;
use crate::state::AppState;
use crate::wire::mechanism::{
    CoordinateDocument, MechanismFrame, MechanismPosesDocument, MechanismPosesRequest,
};

/// The poses of all links and attached frames of a mechanism
///
/// The mechanism is an entry of the catalogue or the text of a file; commanded joints are closed with rigid links, or with the least displacement of the virtual joints.
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
fn read(request: &MechanismPosesRequest) -> Result<MechanismFile, Problem> {
    let (field, text) = match (&request.catalogue, &request.text) {
        (Some(name), None) => match catalogue::find(name) {
            Some(entry) => ("catalogue", entry.text),
            None => return Err(Problem::field("catalogue", format!("unknown entry {name:?}"))),
        },
        (None, Some(text)) => ("text", text.as_str()),
        _ => return Err(Problem::field("", "expected either `catalogue` or `text`")),
    };
    if mechanism::kind_of(text).as_deref() == Some("gpr") {
        let robot =
            robot::parse(text).map_err(|errors| Problem::field(field, errors.to_string()))?;
        let virtualization = BuiltIn::Planar;
        return Ok(three_rods::mechanism_file(&robot, virtualization).expect("it has slides only"));
    }
    mechanism::parse(text).map_err(|errors| Problem::field(field, errors.to_string()))
}

fn compute(request: &MechanismPosesRequest) -> Result<MechanismPosesDocument, Problem> {
    let file = read(request)?;
    let (mechanism, coordinates) = (&file.mechanism, Coordinates::of(&file));
    let mut commands = BTreeMap::new();
    for (name, &value) in &request.at {
        let field = || format!("at.{name}");
        let k = coordinates
            .find(mechanism, name)
            .map_err(|error| Problem::field(field(), error.to_string()))?;
        if !value.is_finite() {
            return Err(Problem::field(field(), "must be a finite number"));
        }
        commands.insert(k, value);
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
