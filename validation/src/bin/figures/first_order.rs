//! First-order analysis: singular values near level, and bounds of the true displacement.

use jointplay::Error;
use jointplay::gpr::{EvaluatedBounds, Gpr};
use jointplay::mobility::{RANK_THRESHOLD, instantaneous_mobility};
use jointplay::plot::{Axis, Colour, Curve, Dash, Figure, Panel, Style};
use jointplay::virtualization::{Metric, Planar, Radial, Solver};
use jointplay_validation::cases::{HEIGHT, options, tilt};

use crate::{by_decades, evenly};

/// The two vanishing singular values of the scaled ∂Φ/∂P against a difference between the rods.
///
/// The twelfth is round-off, and may differ between builds; it is omitted.
pub(crate) fn singular_values() -> Result<Figure, Error> {
    let gpr = Gpr::paper().without_limit_checks();
    let system = gpr.system(&Planar);
    let differences = by_decades(1e-15, 1e-2, 131);
    let in_mm: Vec<f64> = differences.iter().map(|difference| difference * 1e3).collect();
    let mut values = [Vec::new(), Vec::new()];
    let mut threshold = Vec::new();
    for difference in &differences {
        let rods = [0.5, 0.5 + difference, 0.5 - difference];
        let pose = gpr.forward(rods, &Planar, &options(Solver::ClosedForm, Metric::Paper))?;
        let found = instantaneous_mobility(&system, &system.configuration(&pose), RANK_THRESHOLD)?;
        for (k, column) in values.iter_mut().enumerate() {
            column.push(found.singular_values[9 + k]);
        }
        threshold.push(found.threshold);
    }
    let [tenth, eleventh] = values;
    let panel = Panel::new(
        Axis::log10("difference between the rods, q₂ − q₁ = q₁ − q₃ (mm)"),
        Axis::log10("singular value").with_range(1e-15, 1.0),
    )
    .with_curve(Curve::new("tenth", in_mm.clone(), tenth, Style::line(Colour::BLUE, Dash::Solid)))
    .with_curve(Curve::new(
        "eleventh",
        in_mm.clone(),
        eleventh,
        Style::line(Colour::VERMILLION, Dash::Dashed),
    ))
    .with_curve(Curve::new(
        "threshold",
        in_mm,
        threshold,
        Style::line(Colour::GREY, Dash::LongDash),
    ))
    .with_height(260.0);
    Ok(Figure::new("Smallest singular values of the scaled ∂Φ/∂P near level").with_panel(panel))
}

/// ‖ΔX‖ of the radial model and its bounds, for derivatives at three places.
pub(crate) fn bounds() -> Result<Figure, Error> {
    let gpr = Gpr::paper().without_limit_checks();
    let tilt_angles = evenly(0.0, 2.0, 41);
    let options = options(Solver::Newton, Metric::Paper);
    let plays = tilt_angles
        .iter()
        .map(|tilt_angle| gpr.tilt_play(tilt(15.0, *tilt_angle), HEIGHT, &Radial, &options))
        .collect::<Result<Vec<_>, _>>()?;
    let mut panel =
        Panel::new(Axis::linear("tilt toward an azimuth of 15° (°)"), Axis::linear("‖ΔX‖ (µm)"))
            .with_height(280.0)
            .with_curve(Curve::new(
                "true ‖ΔX‖",
                tilt_angles.clone(),
                plays.iter().map(|play| play.displacement * 1e6).collect(),
                Style::line(Colour::BLACK, Dash::Solid).with_width(2.4),
            ));
    let places: [(&str, Vec<&EvaluatedBounds>, Colour); 3] = [
        ("start", plays.iter().map(|play| &play.at_start).collect(), Colour::GREY),
        ("midway", plays.iter().map(|play| &play.at_midpoint).collect(), Colour::BLUE),
        ("end", plays.iter().map(|play| &play.at_end).collect(), Colour::VERMILLION),
    ];
    for (place, bounded, colour) in places {
        let lower = bounded.iter().map(|b| b.bounds.lower * 1e6).collect();
        let upper = bounded.iter().map(|b| b.bounds.upper * 1e6).collect();
        panel = panel
            .with_curve(Curve::new(
                format!("lower, {place}"),
                tilt_angles.clone(),
                lower,
                Style::line(colour, Dash::Dotted),
            ))
            .with_curve(Curve::new(
                format!("upper, {place}"),
                tilt_angles.clone(),
                upper,
                Style::line(colour, Dash::Dashed),
            ));
    }
    Ok(Figure::new("Radial play and the bounds (5), derivatives at three places").with_panel(panel))
}
