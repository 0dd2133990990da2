//! The state that all requests share.

use std::sync::Arc;

use axum::http::StatusCode;
use jointplay::format::robot::Robot;

use crate::controller::ControllerMonitor;
use crate::mechanism_file::MechanismSession;
use crate::meshes::MeshFolder;
use crate::problem::Problem;
use crate::robot_file::{RobotSession, unlimited};
use crate::session::WorkcellSession;
use crate::wire::robot::StartedWith;
use crate::wire::robot_file::RobotSource;
use crate::work::{Deadlines, WorkerPool};

/// The state that all requests share.
#[derive(Clone)]
pub(crate) struct AppState {
    pub(crate) robot: RobotSession,
    pub(crate) work: WorkerPool,
    pub(crate) meshes: MeshFolder,
    /// The work cell; `None` for a server that was started without one.
    pub(crate) cell: Option<WorkcellSession>,
    /// The simulated controller; `None` for a server that was started without one.
    pub(crate) controller: Option<ControllerMonitor>,
    /// The mechanism; `None` for a server that was started without one.
    pub(crate) mechanism: Option<MechanismSession>,
}

impl AppState {
    pub(crate) fn new(robot: Robot, meshes: MeshFolder, deadlines: Deadlines) -> Self {
        Self {
            robot: RobotSession::new(robot),
            work: WorkerPool::new(deadlines),
            meshes,
            cell: None,
            controller: None,
            mechanism: None,
        }
    }

    pub(crate) fn started_with(&self) -> StartedWith {
        StartedWith {
            cell: self.cell.is_some(),
            controller: self.controller.is_some(),
            mechanism: self.mechanism.is_some(),
        }
    }

    /// The robot of a request: the one that it names in its field `robot`, else that of this server.
    ///
    /// # Errors
    /// The errors of its text.
    pub(crate) fn robot(&self, source: Option<&RobotSource>) -> Result<Arc<Robot>, Problem> {
        source.map_or_else(|| Ok(self.robot.robot()), |source| source.read("robot").map(unlimited))
    }

    /// The mechanism that the server was started with.
    ///
    /// # Errors
    /// 404 for a server without a mechanism.
    pub(crate) fn mechanism(&self) -> Result<MechanismSession, Problem> {
        self.mechanism.clone().ok_or_else(|| {
            let detail = "this server was started without a mechanism; start it with `jointplay studio FILE`";
            Problem::request(StatusCode::NOT_FOUND, detail)
        })
    }

    /// The simulated controller.
    ///
    /// # Errors
    /// 404 for a server without a controller.
    pub(crate) fn controller(&self) -> Result<ControllerMonitor, Problem> {
        self.controller.clone().ok_or_else(|| {
            let detail =
                "this server has no controller; start it with `jointplay cell serve --studio`";
            Problem::request(StatusCode::NOT_FOUND, detail)
        })
    }

    /// The session of the work cell.
    ///
    /// # Errors
    /// 404 for a server without a cell.
    pub(crate) fn session(&self) -> Result<WorkcellSession, Problem> {
        self.cell.clone().ok_or_else(|| {
            let detail = "this server has no cell; start it with `jointplay studio --cell`";
            Problem::request(StatusCode::NOT_FOUND, detail)
        })
    }
}
