//! Where stations are, and what is known of it.

use jointplay_cell::station::teach::Verdict;
use jointplay_cell::station::{Origin, Station};
use jointplay_cell::workcell::Cell;
use nalgebra::Vector3;
use serde::Serialize;

use jointplay_format::units::{deg, mm, um};

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
    /// Points beyond the three that a plane takes.
    pub freedom: usize,
    /// Standard deviation of a measured coordinate, where it is given.
    pub noise_um: Option<f64>,
    /// How well the points determine the plane; none for three points of unknown noise.
    pub uncertainty: Option<UncertaintyReport>,
    /// Tilt by which the plane may be off, the budget `plane_urad` of the cell.
    pub allowed_urad: f64,
    /// `fits`, `unproven` (too few points to test their noise), `uncertain` (the tilt is known too poorly for `allowed_urad`) or `scattered`.
    pub verdict: &'static str,
}

/// How well taught points determine a plane.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct UncertaintyReport {
    /// Standard deviation of a measured coordinate, given or estimated.
    pub noise_um: f64,
    /// Whether that is estimated from the distances of the points.
    pub estimated: bool,
    /// Root of the mean square of the tilt by which the plane is off.
    pub tilt_rms_urad: f64,
    /// Tilt by which the plane is off at most, with 95 % confidence.
    pub tilt_95_urad: f64,
    /// Height by which the lowest wafer's place is off at most, with 95 % confidence.
    pub height_95_um: f64,
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
