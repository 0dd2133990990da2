//! Where stations are, and what is known of it.

use jointplay_cell::cell::Cell;
use jointplay_cell::station::teach::Verdict;
use jointplay_cell::station::{Origin, Station};
use nalgebra::Vector3;
use serde::Serialize;

use crate::units::{deg, mm, um};

/// What `cell teach` answers.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct TeachReport {
    /// What the cell is called.
    pub cell: String,
    /// How far the robot can tilt.
    pub tilt_limit_deg: f64,
    /// The stations asked about.
    pub stations: Vec<StationReport>,
}

/// A station's frame, and what it comes from.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct StationReport {
    /// What it is called.
    pub name: String,
    /// `nominal`, `taught` or `drift`.
    pub from: &'static str,
    /// Where the lowest wafer rests, in the base frame.
    pub position_mm: [f64; 3],
    /// From slot to slot, where there are several.
    pub pitch_mm: Option<f64>,
    /// Azimuth toward which it leans.
    pub tilt_yaw_deg: f64,
    /// How far it leans.
    pub tilt_pitch_deg: f64,
    /// The same as a share of the robot's limit.
    pub tilt_share: f64,
    /// The plane through taught points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneReport>,
    /// How far the last slot stands off the vertical above the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_mm: Option<f64>,
}

/// How well taught points lie in a plane.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PlaneReport {
    /// Distance of each point from it, above positive.
    pub distances_um: Vec<f64>,
    /// Root of the mean square of the distances.
    pub residual_um: f64,
    /// Largest distance.
    pub worst_um: f64,
    /// What that may be.
    pub threshold_um: f64,
    /// `fits`, `unproven` (three points always lie in a plane) or `scattered`.
    pub verdict: &'static str,
}

/// Tells where stations are.
///
/// # Arguments
/// * `name` – of the only one to tell; `None` tells all
#[must_use]
pub fn teach(cell: &Cell, name: Option<&str>) -> TeachReport {
    let limit = cell.robot.gpr.limits().tilt_max;
    let asked = cell.stations.iter().filter(|station| name.is_none_or(|name| station.name == name));
    TeachReport {
        cell: cell.name.clone(),
        tilt_limit_deg: deg(limit),
        stations: asked.map(|one| station(one, limit)).collect(),
    }
}

fn station(station: &Station, limit: f64) -> StationReport {
    let normal = station.base_from_station.rotation * Vector3::z();
    let pitch = normal.x.hypot(normal.y).atan2(normal.z);
    let yaw = if pitch > 0.0 { normal.y.atan2(normal.x) } else { 0.0 };
    let (from, plane, drift) = match &station.origin {
        Origin::Nominal => ("nominal", None, None),
        Origin::Taught(fit) => {
            let plane = PlaneReport {
                distances_um: fit.distances.iter().map(|&one| um(one)).collect(),
                residual_um: um(fit.residual),
                worst_um: um(fit.worst),
                threshold_um: um(fit.threshold),
                verdict: match fit.verdict {
                    Verdict::Fits => "fits",
                    Verdict::Unproven => "unproven",
                    Verdict::Scattered => "scattered",
                },
            };
            ("taught", Some(plane), None)
        }
        Origin::Drift(drift) => ("drift", None, Some(mm(drift.drift))),
    };
    StationReport {
        name: station.name.clone(),
        from,
        position_mm: <[f64; 3]>::from(station.base_from_station.translation.vector).map(mm),
        pitch_mm: (station.slots > 1).then(|| mm(station.pitch)),
        tilt_yaw_deg: deg(yaw),
        tilt_pitch_deg: deg(pitch),
        tilt_share: pitch / limit,
        plane,
        drift_mm: drift,
    }
}
