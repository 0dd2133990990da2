//! Documents of the simulated controller.

use jointplay::cell::program::WaferLocation;
use jointplay::cell::workcell::Cell;
use jointplay::interop::host::{HostEvent, Outcome};
use serde::Serialize;
use utoipa::ToSchema;

use super::cell_jogged::{AxisDocument, FrameDocument, axes};
use crate::controller::{ConnectedHost, ControllerMonitor};
use crate::problem::Problem;

/// A simulated controller.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct ControllerDocument {
    /// Address where it listens for hosts.
    pub(crate) address: String,
    /// Name of the language of its hosts.
    pub(crate) language: String,
    /// Factor of the time of the robot.
    pub(crate) speed: f64,
    /// The connected hosts, in the order of their numbers.
    pub(crate) hosts: Vec<HostSummary>,
}

/// A connected host.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct HostSummary {
    /// Number of the host, from 1.
    pub(crate) number: usize,
    /// Its address.
    pub(crate) peer: String,
    /// The command in execution; `null` at rest.
    #[schema(required = true)]
    pub(crate) command: Option<String>,
}

/// The robot of a host.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct HostDocument {
    /// Number of the host, from 1.
    pub(crate) number: usize,
    /// Time since its connection (s).
    pub(crate) time_s: f64,
    /// The command in execution; `null` at rest.
    #[schema(required = true)]
    pub(crate) command: Option<String>,
    /// Time since the start of the motion, by the time of the robot; zero at rest (s).
    pub(crate) elapsed_s: f64,
    /// Duration of the motion, by the time of the robot; zero at rest (s).
    pub(crate) duration_s: f64,
    /// All axes, rods first.
    pub(crate) axes: Vec<AxisDocument>,
    /// All effectors.
    pub(crate) effectors: Vec<LoadedDocument>,
    /// The wafers in slots.
    pub(crate) resting: Vec<RestingWafer>,
    /// Poses of all moving frames, with the names and parents of the 3D scene.
    pub(crate) frames: Vec<FrameDocument>,
    /// The last commands and what became of them, the oldest first.
    pub(crate) events: Vec<EventDocument>,
}

/// Whether an effector holds a wafer.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct LoadedDocument {
    /// Name.
    pub(crate) name: String,
    /// Whether it holds a wafer.
    pub(crate) loaded: bool,
}

/// A wafer in a slot.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct RestingWafer {
    /// Name of the wafer in the 3D scene.
    pub(crate) wafer: String,
    /// Name of the station.
    pub(crate) station: String,
    /// Number of the slot.
    pub(crate) slot: usize,
}

/// A command of a host and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct EventDocument {
    /// Time since the connection of the host (s).
    pub(crate) time_s: f64,
    /// Text of the command.
    pub(crate) command: String,
    /// What became of it.
    pub(crate) outcome: OutcomeName,
    /// Duration of the motion, by the time of the robot; `null` for a refusal (s).
    #[schema(required = true)]
    pub(crate) duration_s: Option<f64>,
    /// Kind of a refusal; `null` for other outcomes.
    #[schema(required = true)]
    pub(crate) reason: Option<&'static str>,
    /// Why it was refused; `null` for other outcomes.
    #[schema(required = true)]
    pub(crate) message: Option<String>,
}

/// What became of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum OutcomeName {
    /// Its motion started.
    Accepted,
    /// Its motion ended as planned.
    Completed,
    /// Its motion was stopped.
    Stopped,
    /// It was refused.
    Refused,
}

impl ControllerDocument {
    pub(crate) fn new(controller: &ControllerMonitor) -> Self {
        let hosts = controller.connected();
        let summary = |host: &ConnectedHost| HostSummary {
            number: host.number,
            peer: host.peer.clone(),
            command: host.snapshot().state_at(host.now()).command,
        };
        Self {
            address: controller.address().to_owned(),
            language: controller.language().to_owned(),
            speed: controller.speed(),
            hosts: hosts.iter().map(summary).collect(),
        }
    }
}

impl HostDocument {
    /// The robot of a host at this time.
    ///
    /// # Errors
    /// A pose that the platform does not have.
    pub(crate) fn new(host: &ConnectedHost) -> Result<Self, Problem> {
        let (snapshot, now) = (host.snapshot(), host.now());
        let (cell, state) = (snapshot.cell(), snapshot.state_at(now));
        let frames =
            snapshot.frames_at(now).map_err(|error| Problem::broken(&error.to_string()))?;
        let at = |place: WaferLocation| state.wafers.iter().any(|(_, location)| *location == place);
        let effectors = cell.robot.effectors().map(|id| LoadedDocument {
            name: cell.effector_name(id).to_owned(),
            loaded: at(WaferLocation::Effector(id)),
        });
        Ok(Self {
            number: host.number,
            time_s: now,
            elapsed_s: state.elapsed,
            duration_s: state.duration,
            axes: axes(cell, &state.positions),
            effectors: effectors.collect(),
            resting: state.wafers.iter().filter_map(|wafer| resting(cell, wafer)).collect(),
            frames: frames.into_iter().map(Into::into).collect(),
            events: snapshot.events().iter().map(EventDocument::new).collect(),
            command: state.command,
        })
    }
}

fn resting(cell: &Cell, (wafer, location): &(String, WaferLocation)) -> Option<RestingWafer> {
    let slot = location.slot()?;
    let station = cell.stations[slot.station].name.clone();
    Some(RestingWafer { wafer: wafer.clone(), station, slot: slot.slot })
}

impl EventDocument {
    fn new(event: &HostEvent) -> Self {
        let (outcome, duration_s, refusal) = match &event.outcome {
            Outcome::Accepted { duration } => (OutcomeName::Accepted, Some(*duration), None),
            Outcome::Completed { duration } => (OutcomeName::Completed, Some(*duration), None),
            Outcome::Stopped { duration } => (OutcomeName::Stopped, Some(*duration), None),
            Outcome::Refused { reason, message } => {
                (OutcomeName::Refused, None, Some((reason.word(), message.clone())))
            }
        };
        let (reason, message) = refusal.unzip();
        let (time_s, command) = (event.time, event.command.clone());
        Self { time_s, command, outcome, duration_s, reason, message }
    }
}
