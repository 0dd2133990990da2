//! Taught points of a station: noise, sensors, plane, reference points, stated uncertainty.

use std::collections::BTreeMap;

use crate::display_units::DisplayUnits;
use jointplay_cell::station::teach::{
    FitResult, NominalFrame, PlaneFit, ReferenceFit, ReferencePoint, StatedUncertainty,
    TaughtFrame, TeachError, fit_plane, fit_references,
};
use nalgebra::{Vector2, Vector3};

use super::explain::explain_teach;
use super::pose::points;
use super::problem::Fault;
use super::tree::{AllowedRange, Entry, Reader, Table};
use super::unique::unique;
use crate::file_problem::FileProblem;
use crate::number::number;
use crate::units::{m_from_mm, shift, um};

/// Default of the largest distance of taught points from their fit (µm).
const THRESHOLD_UM: f64 = 100.0;

/// Standard deviations of the coordinates that the sensors of a cell measure, by name (m).
pub(super) type Sensors = BTreeMap<String, f64>;

/// The sensors of a cell.
pub(super) fn sensors(top: &Table) -> Sensors {
    let mut names = BTreeMap::new();
    let mut sensors = Sensors::new();
    for mut table in top.tables("sensor") {
        let name = table.name("name");
        if let Some(name) = &name {
            table.whose = format!("the sensor {name:?}");
            unique(&table, "sensor", name, &mut names);
        }
        let noise = table.number("noise_um", AllowedRange::Positive);
        table.finish();
        if let (Some(name), Some(noise)) = (name, noise) {
            sensors.insert(name, shift(noise, -6));
        }
    }
    sensors
}

/// Whether taught points determine the plane of a station, so that it has no nominal tilt.
pub(super) fn has_plane(taught: &Table) -> bool {
    taught.entry("points_mm").is_some()
}

/// The taught parts of a station's frame.
pub(super) fn taught(
    taught: &Table,
    nominal: Option<NominalFrame>,
    sensors: &Sensors,
) -> Option<TaughtFrame> {
    let reader = taught.reader;
    let threshold = taught.number_or("threshold_um", AllowedRange::Positive, THRESHOLD_UM);
    let threshold = shift(threshold, -6);
    let at = taught.entry("points_mm");
    let measured = at.as_ref().map(|entry| points(entry, reader));
    let plane_noise = ["noise_um", "sensor"];
    let of_plane = measured.as_ref().and_then(Option::as_ref).map(Vec::len);
    let noise = noise(taught, plane_noise, of_plane, sensors);
    let listed = taught.entry("references");
    let references = listed.as_ref().map(|entry| references(entry, reader));
    let of_references = references.as_ref().and_then(Option::as_ref).map(Vec::len);
    let reference_noise =
        self::noise(taught, ["reference_noise_um", "reference_sensor"], of_references, sensors);
    taught.finish();
    if measured.is_none() && references.is_none() {
        taught.missing("points_mm` or `references");
        return None;
    }
    let plane = match measured {
        Some(points) => Some(plane(taught, &points?, threshold, noise?.as_deref())?),
        None => None,
    };
    let references = match references {
        Some(found) => {
            let in_plane = nominal?.in_plane(plane.as_ref());
            let fit = fit_references(&in_plane, &found?, threshold, reference_noise?.as_deref());
            let fit = fit
                .map_err(|error| {
                    taught.report_at(
                        "references",
                        Fault::Unfit(explain_teach(&error, DisplayUnits::Metric)),
                    );
                })
                .ok()?;
            if fit.agreement.result == FitResult::Inconsistent {
                report_point(taught, "references", fit.suspect(), inconsistent_references(&fit));
            }
            Some(fit)
        }
        None => None,
    };
    Some(TaughtFrame { plane, references })
}

fn plane(
    taught: &Table,
    points: &[Vector3<f64>],
    threshold: f64,
    noise: Option<&[f64]>,
) -> Option<PlaneFit> {
    let fit = fit_plane(points, threshold, noise);
    let fit = fit
        .map_err(|error| {
            let second = match error {
                TeachError::Repeated { second, .. } => Some(second),
                _ => None,
            };
            report_point(taught, "points_mm", second, explain_teach(&error, DisplayUnits::Metric));
        })
        .ok()?;
    if fit.agreement.result == FitResult::Inconsistent {
        report_point(taught, "points_mm", fit.suspect(), inconsistent_points(&fit));
    }
    Some(fit)
}

/// Reports an error at one point of a list, or at the whole list.
fn report_point(taught: &Table, key: &'static str, index: Option<usize>, message: String) {
    let entry = taught.entry(key);
    let list = entry.as_ref().and_then(|entry| entry.list(taught.reader));
    let point = index.and_then(|index| list.as_ref()?.get(index).map(Entry::span));
    let span = point.or_else(|| entry.as_ref().map(Entry::span));
    taught.reader.report(span.unwrap_or_else(|| taught.span.clone()), Fault::Unfit(message));
}

/// The message of taught points that do not lie in one plane.
#[must_use]
pub fn inconsistent_points(fit: &PlaneFit) -> String {
    let relative = |index: usize| match fit.agreement.diagnostics[index].standardized {
        Some(times) => format!(", by {:.1} times its standard deviation", times.abs()),
        None => String::new(),
    };
    let mut message = match fit.suspect() {
        Some(index) => format!(
            "taught point {} deviates most{}: it is {:.1} µm from the plane of all points",
            index + 1,
            relative(index),
            um(fit.distances[index]).abs()
        ),
        None => format!(
            "the taught points are up to {:.1} µm from their plane, and one redundant point does not determine which of them deviates",
            um(fit.agreement.worst)
        ),
    };
    if fit.agreement.worst > fit.agreement.threshold {
        message += &format!("; at most {} µm are allowed", number(um(fit.agreement.threshold)));
    } else if let (Some(found), Some(limit)) =
        (fit.agreement.chi_square, fit.agreement.chi_square_limit)
    {
        message += &format!(
            "; the noise does not explain the deviations (chi-square {found:.1}, limit {limit:.1} at {} degrees of freedom)",
            fit.agreement.redundancy
        );
    }
    message
        + match (fit.suspect(), fit.agreement.worst > fit.agreement.threshold) {
            (Some(_), _) => ": measure this point again",
            (None, true) => ": measure all points again, or increase `threshold_um`",
            (None, false) => ": measure all points again, or state the noise of the measurement",
        }
}

/// The message of reference points that do not agree.
#[must_use]
pub fn inconsistent_references(fit: &ReferenceFit) -> String {
    let allowed = number(um(fit.agreement.threshold));
    match fit.suspect() {
        Some(index) => format!(
            "reference {} deviates most: it is {:.1} µm from its place in the fitted frame; at most {allowed} µm are allowed, and the noise has to explain the deviation: measure it again, or check its `station_mm`",
            index + 1,
            um(fit.deviations[index].norm())
        ),
        None => format!(
            "the references deviate by up to {:.1} µm from the fitted frame, and two of them do not determine which one deviates; at most {allowed} µm are allowed: measure them again, or add a third",
            um(fit.agreement.worst)
        ),
    }
}

/// Standard deviation of each point's coordinates; the outer `None` is an error, the inner one an unknown noise.
#[expect(clippy::option_option, reason = "an error differs from an unknown noise")]
fn noise(
    table: &Table,
    [noise_key, sensor_key]: [&'static str; 2],
    points: Option<usize>,
    sensors: &Sensors,
) -> Option<Option<Vec<f64>>> {
    let reader = table.reader;
    let (noise, sensor) = (table.entry(noise_key), table.entry(sensor_key));
    let (entry, is_sensor) = match (noise, sensor) {
        (Some(_), Some(sensor)) => {
            let why =
                format!("`{noise_key}` and `{sensor_key}` both state the noise: keep one of them");
            sensor.report(reader, Fault::Unfit(why));
            return None;
        }
        (Some(noise), None) => (noise, false),
        (None, Some(sensor)) => (sensor, true),
        (None, None) => return Some(None),
    };
    let one = |entry: &Entry| {
        if !is_sensor {
            return entry.number(reader, AllowedRange::Positive).map(|noise| shift(noise, -6));
        }
        let name = entry.name(reader)?;
        let found = sensors.get(&name).copied();
        if found.is_none() {
            let known: Vec<String> = sensors.keys().cloned().collect();
            entry.unknown(reader, "sensor", &name, &known);
        }
        found
    };
    if entry.is_text() || entry.any_number().is_some() {
        let value = one(&entry)?;
        return Some(points.map(|count| vec![value; count]));
    }
    let list: Vec<Option<f64>> = entry.list(reader)?.iter().map(one).collect();
    let values: Vec<f64> = list.into_iter().collect::<Option<_>>()?;
    if let Some(points) = points.filter(|&points| points != values.len()) {
        let key = if is_sensor { sensor_key } else { noise_key };
        let (found, needed) = (values.len(), format!("{points}, one for each point"));
        entry.report(reader, FileProblem::Count { key: key.to_owned(), found, needed });
        return None;
    }
    Some(Some(values))
}

/// Reference points: `{ station_mm = [x, y], measured_mm = [x, y, z] }`.
fn references(entry: &Entry, reader: &Reader) -> Option<Vec<ReferencePoint>> {
    let one = |entry: &Entry| {
        let table = entry.table(reader, "a reference point")?;
        let nominal = table.entry("station_mm").map_or(Some(Vector2::zeros()), |entry| {
            let place: [f64; 2] = entry.numbers(reader, AllowedRange::Any)?;
            Some(Vector2::from(place.map(m_from_mm)))
        });
        let measured = table.point("measured_mm");
        table.finish();
        Some(ReferencePoint { nominal: nominal?, measured: measured? })
    };
    // All references are read before the first error returns.
    let found: Vec<Option<ReferencePoint>> = entry.list(reader)?.iter().map(one).collect();
    found.into_iter().collect()
}

/// The stated uncertainty of a station.
pub(super) fn stated_uncertainty(table: &Table) -> StatedUncertainty {
    let Some(stated) = table.table("uncertainty", "an uncertainty") else {
        return StatedUncertainty::default();
    };
    let micro = |key| {
        let value = stated.entry(key)?.number(table.reader, AllowedRange::NotNegative)?;
        Some(shift(value, -6))
    };
    let found = StatedUncertainty {
        lateral: micro("lateral_um"),
        height: micro("height_um"),
        tilt: micro("tilt_urad"),
        heading: micro("heading_urad"),
    };
    stated.finish();
    found
}
