//! Torsion gathered over three turns of precession.

use jointplay::gpr::Gpr;
use jointplay::plot::{Axis, Colour, Curve, Dash, Figure, Model, Panel, Style, model_style};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Metric, Offset, Planar, Solver, Virtualization};
use jointplay_validation::cases::{HEIGHT, options};
use jointplay_validation::paths::{least_rotation, torsion, turn, warm_started};

const SAMPLES: u32 = 120;

/// From nominal, from the last X, and by least rotation.
pub(crate) fn figure() -> Figure {
    let gpr = Gpr::paper().without_limit_checks();
    let tilts: Vec<Tilt> = (0..3).flat_map(|_| turn(2.0_f64.to_radians(), SAMPLES)).collect();
    let turns: Vec<f64> = (0..3)
        .flat_map(|n| (0..=SAMPLES).map(move |i| f64::from(n) + f64::from(i) / f64::from(SAMPLES)))
        .collect();
    let nominal: Vec<f64> = tilts
        .iter()
        .map(|tilt| {
            let rods = gpr.inverse(*tilt, HEIGHT).expect("a pose of the robot");
            let options = options(Solver::Newton, Metric::Paper);
            gpr.forward(rods, &Planar, &options).expect("near level").torsion()
        })
        .collect();
    let scaled =
        |torsion: &[f64], scale: f64| torsion.iter().map(|t| t * scale).collect::<Vec<_>>();
    let nominal_style = Style::line(Colour::BLUE, Dash::Solid).with_width(2.2);
    let rotation: Vec<f64> = least_rotation(&tilts).iter().map(torsion).collect();
    let whole = Panel::new(Axis::linear("turns of precession"), Axis::linear("torsion (mrad)"))
        .with_title("(a) least rotation of the platform from the last pose")
        .with_curve(Curve::new(
            "least rotation",
            turns.clone(),
            scaled(&rotation, 1e3),
            Style::line(Colour::VERMILLION, Dash::Dashed),
        ))
        .with_curve(Curve::new(
            "planar, from nominal",
            turns.clone(),
            scaled(&nominal, 1e3),
            nominal_style,
        ));
    let mut fine = Panel::new(Axis::linear("turns of precession"), Axis::linear("torsion (µrad)"))
        .with_title("(b) the solve started at the last X")
        .with_curve(Curve::new(
            "planar, from nominal",
            turns.clone(),
            scaled(&nominal, 1e6),
            nominal_style,
        ));
    for (name, model, style) in [
        (
            "planar, from the last X",
            &Planar as &dyn Virtualization,
            model_style(Model::Planar).with_width(2.4),
        ),
        ("offset, from the last X", &Offset, model_style(Model::Offset)),
    ] {
        let torsion: Vec<f64> = warm_started(&gpr, model, 1e-3, &tilts)
            .iter()
            .map(|pose| torsion(&pose.rotation))
            .collect();
        fine = fine.with_curve(Curve::new(name, turns.clone(), scaled(&torsion, 1e6), style));
    }
    Figure::new("The same poses three times over, tilt 2°: torsion about the normal")
        .with_panel(whole)
        .with_panel(fine)
}
