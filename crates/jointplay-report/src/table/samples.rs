//! A study as a table: one row per sample, units in the column names.

use jointplay_study::{Samples, SeriesKind};

use jointplay_format::units::{deg, mm};

use super::column::{Column, Values};

/// The name of a series with its unit.
#[must_use]
pub fn column_name(name: &str, kind: SeriesKind) -> String {
    let unit = if kind == SeriesKind::Angular { "deg" } else { "mm" };
    format!("{name}_{unit}")
}

/// A value of a series in the unit of its column name.
#[must_use]
pub fn column_value(value: f64, kind: SeriesKind) -> f64 {
    if kind == SeriesKind::Angular { deg(value) } else { mm(value) }
}

/// All columns of a study: sample, tilt, rods, sides, virtual joints, origin, torsion, iterations, residual.
#[must_use]
pub fn columns(samples: &Samples) -> Vec<Column> {
    let real = |name: String, values: &[f64], convert: fn(f64) -> f64| Column {
        name,
        values: Values::Real(values.iter().map(|&value| convert(value)).collect()),
    };
    let count = |name: &str, values: &mut dyn Iterator<Item = usize>| Column {
        name: name.to_owned(),
        values: Values::Count(
            values.map(|value| u32::try_from(value).unwrap_or(u32::MAX)).collect(),
        ),
    };
    let mut columns = vec![
        count("sample", &mut (0..samples.len())),
        real("azimuth_deg".into(), &samples.azimuth, deg),
        real("tilt_deg".into(), &samples.tilt_angle, deg),
    ];
    for series in samples.series() {
        let convert = if series.kind == SeriesKind::Angular { deg } else { mm };
        columns.push(real(column_name(&series.name, series.kind), series.values, convert));
    }
    for (axis, values) in ["x", "y", "z"].into_iter().zip(&samples.origin) {
        columns.push(real(format!("{axis}_mm"), values, mm));
    }
    columns.push(real("torsion_deg".into(), &samples.torsion, deg));
    columns.push(count("iterations", &mut samples.iterations.iter().copied()));
    columns.push(real("residual_mm".into(), &samples.residual, mm));
    columns
}
