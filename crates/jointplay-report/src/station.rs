//! Report on the poses of stations and their uncertainty.

use jointplay_cell::station::teach::{FitResult, PlaneFit, ReferenceFit};
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
    /// `nominal`, `taught` or `carrier axis`.
    pub from: &'static str,
    /// Centre of the lowest wafer at rest, in the base frame.
    pub position_mm: [f64; 3],
    /// Distance between neighbouring slots, if there are several.
    pub pitch_mm: Option<f64>,
    /// Tilt direction.
    pub tilt_azimuth_deg: f64,
    /// Tilt angle.
    pub tilt_angle_deg: f64,
    /// Tilt angle as a share of the robot's limit.
    pub tilt_share: f64,
    /// The plane through taught points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneReport>,
    /// Centre and heading from reference points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub references: Option<ReferenceReport>,
    /// Expanded uncertainty of the wafers at rest.
    pub uncertainty: StationUncertaintyReport,
    /// Horizontal distance of the last slot from the vertical through the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub horizontal_offset_mm: Option<f64>,
}

/// Fit of a plane to taught points.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PlaneReport {
    /// Distance of each point from the plane, positive above.
    pub distances_um: Vec<f64>,
    /// Share of an error of each point that the plane follows, so that the error does not show.
    pub leverages: Vec<f64>,
    /// Distance of each point divided by its standard deviation, studentized where the noise is estimated; none where it is not known.
    pub standardized: Vec<Option<f64>>,
    /// Root mean square of the distances.
    pub residual_um: f64,
    /// Largest distance.
    pub worst_um: f64,
    /// Allowed distance.
    pub threshold_um: f64,
    /// Number of points in addition to the three that determine a plane.
    pub freedom: usize,
    /// Standard deviation of the coordinates of each point, if given.
    pub noise_um: Option<Vec<f64>>,
    /// Sum of the squared distances, each divided by its variance, if the noise is given.
    pub chi_square: Option<f64>,
    /// Largest accepted `chi_square`: the 99.9 % quantile; none without points to test.
    pub chi_square_limit: Option<f64>,
    /// Uncertainty of the plane; none for three points of unknown noise.
    pub uncertainty: Option<UncertaintyReport>,
    /// Allowed uncertainty of the tilt, the budget `plane_urad` of the cell.
    pub allowed_urad: f64,
    /// `fits`, `untested` (too few points to judge them), `uncertain` (the tilt is known too poorly for `allowed_urad`) or `inconsistent`.
    pub result: &'static str,
    /// Number of the point to be measured again, from 1, if the points are inconsistent and determine it.
    pub remeasure: Option<usize>,
    /// Further points that are needed, if any.
    pub next: Option<NextPointsReport>,
}

/// Further points that a plane needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct NextPointsReport {
    /// The points, the most useful first; places a few millimetres away are equivalent.
    pub points_mm: Vec<[f64; 3]>,
    /// Whether they suffice.
    pub suffices: bool,
    /// Noise with which the present points would make the tilt certain enough; none where it does not limit them.
    pub noise_um: Option<f64>,
}

/// Uncertainty of a plane through taught points.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct UncertaintyReport {
    /// Standard deviation of a measured coordinate, given or estimated; of the most accurate point.
    pub noise_um: f64,
    /// Whether `noise_um` is estimated from the distances of the points.
    pub estimated: bool,
    /// Root mean square of the tilt error.
    pub tilt_rms_urad: f64,
    /// Largest tilt error with 95 % confidence.
    pub tilt_95_urad: f64,
    /// Standard deviation of the tilt in its least certain direction, times the coverage factor.
    pub tilt_expanded_urad: f64,
    /// Largest height error of the lowest wafer with 95 % confidence.
    pub height_95_um: f64,
}

/// Fit of centre and heading to reference points.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ReferenceReport {
    /// Displacement of the station from its nominal position, across and inward.
    pub shift_mm: [f64; 2],
    /// Rotation of the station from its nominal heading; none where the references do not determine it.
    pub turn_deg: Option<f64>,
    /// Distance of each reference from its place in the fitted frame.
    pub deviations_um: Vec<f64>,
    /// Share of an error of each reference that the fit follows.
    pub leverages: Vec<f64>,
    /// Deviation of each reference divided by its standard deviation; none where that is not known.
    pub standardized: Vec<Option<f64>>,
    /// Largest deviation.
    pub worst_um: f64,
    /// Allowed deviation.
    pub threshold_um: f64,
    /// Number of coordinates in addition to those that determine centre and heading.
    pub freedom: usize,
    /// Standard deviation of the coordinates of each reference, if given.
    pub noise_um: Option<Vec<f64>>,
    /// Sum of the squared deviations, each divided by its variance, if the noise is given.
    pub chi_square: Option<f64>,
    /// Largest accepted `chi_square`: the 99.9 % quantile; none without redundancy.
    pub chi_square_limit: Option<f64>,
    /// `fits`, `untested` or `inconsistent`.
    pub result: &'static str,
    /// Number of further references with which the fit can be judged.
    pub missing: usize,
}

/// Expanded uncertainty of a station: standard deviations times the coverage factor.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct StationUncertaintyReport {
    /// The coverage factor of the cell.
    pub coverage_factor: f64,
    /// The factor that was applied: larger where the noise is estimated from few points.
    pub applied_factor: f64,
    /// Components without a known uncertainty: `position`, `height`, `tilt`, `heading`; they count as exact.
    pub unknown: Vec<&'static str>,
    /// Tilt in its least certain direction; none where it is not known.
    pub tilt_urad: Option<f64>,
    /// Heading; none where it is not known.
    pub heading_urad: Option<f64>,
    /// The wafer in the lowest slot, and in the highest; none where nothing is known.
    pub slots: Vec<SlotUncertaintyReport>,
}

/// Expanded uncertainty of the centre of a wafer at rest, from the known components.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SlotUncertaintyReport {
    /// The slot, from 1.
    pub slot: usize,
    /// In the plane of the wafer, in the least certain direction.
    pub lateral_um: f64,
    /// Along the normal of the plane.
    pub height_um: f64,
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
        stations: asked.map(|one| station(cell, one)).collect(),
    }
}

fn station(cell: &Cell, station: &Station) -> StationReport {
    let limit = cell.robot.gpr.limits().tilt_max;
    let normal = station.base_from_station.rotation * Vector3::z();
    let tilt_angle = normal.x.hypot(normal.y).atan2(normal.z);
    let azimuth = if tilt_angle > 0.0 { normal.y.atan2(normal.x) } else { 0.0 };
    let (from, taught, carrier_axis) = match &station.origin {
        Origin::Nominal => ("nominal", None, None),
        Origin::Taught(taught) => ("taught", Some(taught), None),
        Origin::CarrierAxis(carrier_axis) => {
            ("carrier axis", None, Some(mm(carrier_axis.horizontal_offset)))
        }
    };
    let fit = taught.and_then(|taught| taught.plane.as_ref());
    StationReport {
        name: station.name.clone(),
        from,
        position_mm: <[f64; 3]>::from(station.base_from_station.translation.vector).map(mm),
        pitch_mm: (station.slots > 1).then(|| mm(station.pitch)),
        tilt_azimuth_deg: deg(azimuth),
        tilt_angle_deg: deg(tilt_angle),
        tilt_share: tilt_angle / limit,
        plane: fit.map(|fit| plane(cell, station, fit)),
        references: taught.and_then(|taught| taught.references.as_ref()).map(references),
        uncertainty: uncertainty(cell, station),
        horizontal_offset_mm: carrier_axis,
    }
}

fn result(result: FitResult) -> &'static str {
    match result {
        FitResult::Fits => "fits",
        FitResult::Untested => "untested",
        FitResult::Uncertain => "uncertain",
        FitResult::Inconsistent => "inconsistent",
    }
}

fn plane(cell: &Cell, station: &Station, fit: &PlaneFit) -> PlaneReport {
    let (allowed, factor) = (cell.plane_threshold, cell.coverage_factor);
    PlaneReport {
        distances_um: fit.distances.iter().map(|&one| um(one)).collect(),
        leverages: fit.agreement.diagnostics.iter().map(|one| one.leverage).collect(),
        standardized: fit.agreement.diagnostics.iter().map(|one| one.standardized).collect(),
        residual_um: um(fit.residual),
        worst_um: um(fit.agreement.worst),
        threshold_um: um(fit.agreement.threshold),
        freedom: fit.agreement.redundancy,
        noise_um: fit
            .agreement
            .noise
            .as_ref()
            .map(|noise| noise.iter().map(|&one| um(one)).collect()),
        chi_square: fit.agreement.chi_square,
        chi_square_limit: fit.agreement.chi_square_limit,
        uncertainty: fit.uncertainty.as_ref().map(|known| UncertaintyReport {
            noise_um: um(known.noise),
            estimated: known.is_estimated,
            tilt_rms_urad: um(known.tilt()),
            tilt_95_urad: um(known.tilt_95),
            tilt_expanded_urad: um(known.expanded_tilt(factor)),
            height_95_um: um(known.height_95(&station.slot_frame(1).translation.vector)),
        }),
        allowed_urad: um(allowed),
        result: result(fit.result_for(allowed, factor)),
        remeasure: fit.suspect().map(|index| index + 1),
        next: fit.next_points(allowed, factor).map(|next| NextPointsReport {
            points_mm: next.points.iter().map(|point| <[f64; 3]>::from(*point).map(mm)).collect(),
            suffices: next.suffices,
            noise_um: next.noise.map(um),
        }),
    }
}

fn references(fit: &ReferenceFit) -> ReferenceReport {
    ReferenceReport {
        shift_mm: [mm(fit.shift.x), mm(fit.shift.y)],
        turn_deg: fit.turn.map(deg),
        deviations_um: fit.deviations.iter().map(|one| um(one.norm())).collect(),
        leverages: fit.agreement.diagnostics.iter().map(|one| one.leverage).collect(),
        standardized: fit.agreement.diagnostics.iter().map(|one| one.standardized).collect(),
        worst_um: um(fit.agreement.worst),
        threshold_um: um(fit.agreement.threshold),
        freedom: fit.agreement.redundancy,
        noise_um: fit
            .agreement
            .noise
            .as_ref()
            .map(|noise| noise.iter().map(|&one| um(one)).collect()),
        chi_square: fit.agreement.chi_square,
        chi_square_limit: fit.agreement.chi_square_limit,
        result: result(fit.agreement.result),
        missing: fit.missing(),
    }
}

fn uncertainty(cell: &Cell, station: &Station) -> StationUncertaintyReport {
    let known = &station.uncertainty;
    let factor = known.coverage(cell.coverage_factor);
    let components = [("position", 0..2), ("height", 2..3), ("tilt", 3..5), ("heading", 5..6)];
    let unknown =
        components.into_iter().filter(|(_, range)| known.known[range.clone()].contains(&false));
    let last = (station.slots > 1).then_some(station.slots);
    let slots = std::iter::once(1).chain(last).filter(|_| known.is_known());
    StationUncertaintyReport {
        coverage_factor: cell.coverage_factor,
        applied_factor: factor,
        unknown: unknown.map(|(name, _)| name).collect(),
        tilt_urad: known.tilt_deviation().map(|deviation| um(factor * deviation)),
        heading_urad: known.known[5].then(|| um(factor * known.covariance[(5, 5)].sqrt())),
        slots: slots
            .map(|slot| {
                let [lateral, height] = known.lateral_and_height(&station.slot_position(slot));
                SlotUncertaintyReport {
                    slot,
                    lateral_um: um(factor * lateral),
                    height_um: um(factor * height),
                }
            })
            .collect(),
    }
}
