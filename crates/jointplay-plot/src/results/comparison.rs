//! All models side by side over a range of tilts.

use jointplay_study::Comparison;

use super::coincident;
use crate::{Axis, Curve, Figure, Model, Panel, Style, model_style, rod_style};

/// Centre shift and largest displacement of every model against the tilt angle.
///
/// The shift across e_b1 gets a panel of its own only where there is one.
#[must_use]
pub fn comparison(comparison: &Comparison) -> Figure {
    let tilt_angle: Vec<f64> =
        comparison.tilt_angles.iter().map(|tilt_angle| tilt_angle.to_degrees()).collect();
    let none = vec![0.0; tilt_angle.len()];
    let panel = |label: &str| Panel::new(Axis::linear("tilt angle (deg)"), Axis::linear(label));
    let approximate = model_style(Model::Approximate);
    let mut figure = Figure::new("Models compared over the tilt angle");
    let sideways =
        comparison.models.iter().flat_map(|model| &model.center_shift).any(|s| s.y.abs() > 1e-9);
    let axes: &[(usize, &str)] = if sideways {
        &[(0, "centre shift x (µm)"), (1, "centre shift y (µm)")]
    } else {
        &[(0, "centre shift (µm)")]
    };
    for &(axis, label) in axes {
        let mut shift = panel(label);
        for (index, model) in comparison.models.iter().enumerate() {
            let values: Vec<f64> =
                model.center_shift.iter().map(|shift| shift[axis] * 1e6).collect();
            shift = shift.with_curve(Curve::new(
                &model.name,
                tilt_angle[..values.len()].to_vec(),
                values,
                style(&model.name, index),
            ));
        }
        shift = shift.with_curve(Curve::new(
            "approximate",
            tilt_angle.clone(),
            none.clone(),
            approximate,
        ));
        shift.curves = coincident::merged(shift.curves, "µm", shift.height);
        figure = figure.with_panel(shift);
    }
    let mut displacement = panel("displacement at the balls (µm)");
    for (index, model) in comparison.models.iter().enumerate() {
        let values: Vec<f64> = model.largest_displacement.iter().map(|moved| moved * 1e6).collect();
        let curve = Curve::new(
            &model.name,
            tilt_angle[..values.len()].to_vec(),
            values,
            style(&model.name, index),
        );
        displacement = displacement.with_curve(curve);
    }
    let gaps = comparison.approximate_gap.iter().map(|gap| gap * 1e6).collect();
    displacement =
        displacement.with_curve(Curve::new("approximate", tilt_angle.clone(), gaps, approximate));
    displacement.curves = coincident::merged(displacement.curves, "µm", displacement.height);
    figure.with_panel(displacement)
}

/// The fixed look of a known model; others get those of further rods.
fn style(name: &str, index: usize) -> Style {
    match name {
        "radial" => model_style(Model::Radial),
        "polar" => model_style(Model::Polar),
        "offset" => model_style(Model::Offset),
        "planar" => model_style(Model::Planar),
        _ => rod_style(index),
    }
}
