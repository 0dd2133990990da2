//! Report on the poses of stations and their uncertainty.

use jointplay_cell::station::teach::Verdict;
use jointplay_cell::station::{Origin, Station};
use jointplay_cell::workcell::Cell;
use nalgebra::Vector3;
use serde::Serialize;

use jointplay_format::units::{deg, mm, um};

/// Result of `cell teach`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct TeachReport {
    /// Name of the cell.
    pub cell: String,
    /// Largest tilt of the robot.
    pub tilt_limit_deg: f64,
    /// The requested stations.
    pub stations: Vec<StationReport>,
}

/// Frame of a station, and its origin.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct StationReport {
    /// Name of the station.
    pub name: String,
    /// `nominal`, `taught` or `drift`.
    pub from: &'static str,
    /// Centre of the lowest wafer at rest, in the base frame.
    pub position_mm: [f64; 3],
    /// Distance between neighbouring slots, if there are several.
    pub pitch_mm: Option<f64>,
    /// Tilt direction.
    pub tilt_yaw_deg: f64,
    /// Tilt angle.
    pub tilt_pitch_deg: f64,
    /// Tilt angle as a share of the robot's limit.
    pub tilt_share: f64,
    /// The plane through taught points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneReport>,
    /// Horizontal distance of the last slot from the vertical through the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift_mm: Option<f64>,
}

/// Fit of a plane to taught points.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PlaneReport {
    /// Distance of each point from the plane, positive above.
    pub distances_um: Vec<f64>,
    /// Root mean square of the distances.
    pub residual_um: f64,
    /// Largest distance.
    pub worst_um: f64,
    /// Allowed distance.
    pub threshold_um: f64,
    /// Number of points in addition to the three that determine a plane.
    pub freedom: usize,
    /// Standard deviation of a measured coordinate, if given.
    pub noise_um: Option<f64>,
    /// Uncertainty of the plane; none for three points of unknown noise.
    pub uncertainty: Option<UncertaintyReport>,
    /// Allowed uncertainty of the tilt, the budget `plane_urad` of the cell.
    pub allowed_urad: f64,
    /// `fits`, `unproven` (too few points to test their noise), `uncertain` (the tilt is known too poorly for `allowed_urad`) or `scattered`.
    pub verdict: &'static str,
}

/// Uncertainty of a plane through taught points.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct UncertaintyReport {
    /// Standard deviation of a measured coordinate, given or estimated.
    pub noise_um: f64,
    /// Whether `noise_um` is estimated from the distances of the points.
    pub estimated: bool,
    /// Root mean square of the tilt error.
    pub tilt_rms_urad: f64,
    /// Largest tilt error with 95 % confidence.
    pub tilt_95_urad: f64,
    /// Largest height error of the lowest wafer with 95 % confidence.
    pub height_95_um: f64,
}

/// Reports the poses of stations.
///
/// # Arguments
/// * `name` – name of one station; `None` reports all
#[must_use]
pub fn teach(cell: &Cell, name: Option<&str>) -> TeachReport {
    let limit = cell.robot.gpr.limits().tilt_max;
    let asked = cell.stations.iter().filter(|station| name.is_none_or(|name| station.name == name));
    TeachReport {
        cell: cell.name.clone(),
        tilt_limit_deg: deg(limit),
        stations: asked.map(|one| station(one, limit, cell.plane_threshold)).collect(),
    }
}

fn station(station: &Station, limit: f64, allowed: f64) -> StationReport {
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
                freedom: fit.freedom,
                noise_um: fit.noise.map(um),
                uncertainty: fit.uncertainty.as_ref().map(|known| UncertaintyReport {
                    noise_um: um(known.noise),
                    estimated: known.is_estimated,
                    tilt_rms_urad: um(known.tilt()),
                    tilt_95_urad: um(known.tilt_95),
                    height_95_um: um(known.height_95(&station.slot_frame(1).translation.vector)),
                }),
                allowed_urad: um(allowed),
                verdict: match fit.verdict {
                    _ if fit.is_uncertain(allowed) => "uncertain",
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
