//! How much of the play is angular, and how far the iteration ends from the least play.

use jointplay::gpr::Gpr;
use jointplay::plot::{Axis, Colour, Curve, Dash, Figure, Model, Panel, Style, model_style};
use jointplay::virtualization::{Metric, Offset, Planar, Polar, Solver, Virtualization};
use jointplay_validation::cases::{RADIUS, pose};
use nalgebra::Vector2;

use crate::{by_decades, evenly};

const UM: f64 = 1e-6;

/// Polar: lengths and arcs; offset and planar: sideways displacement.
pub(crate) fn angular_parts() -> Figure {
    let azimuths = evenly(0.0, 360.0, 181);
    let polar =
        |azimuth| pose(&Polar, Solver::Newton, Metric::Paper, azimuth, 2.0).solution.virtual_joints;
    let lengths = azimuths.iter().map(|azimuth| (polar(*azimuth)[0] - RADIUS) / UM).collect();
    let arcs =
        azimuths.iter().map(|azimuth| polar(*azimuth)[0] * polar(*azimuth)[3] / UM).collect();
    let parts = Panel::new(Axis::linear("azimuth (°)"), Axis::linear("displacement (µm)"))
        .with_title("(a) polar, ρ = 1 mm, socket 1: the “negligible” angle is the larger part")
        .with_curve(Curve::new(
            "length, l₁ − R",
            azimuths.clone(),
            lengths,
            model_style(Model::Radial),
        ))
        .with_curve(Curve::new("arc, l₁ φ₁", azimuths.clone(), arcs, model_style(Model::Polar)));
    let mut sideways = Panel::new(
        Axis::linear("azimuth (°)"),
        Axis::log10("sideways displacement (µm)").with_range(1e-7, 1e3),
    )
    .with_title("(b) socket 1 at right angles to its radius: offset hides what planar shows");
    for (name, model, solver, style) in [
        (
            "planar",
            &Planar as &dyn Virtualization,
            Solver::ClosedForm,
            model_style(Model::Planar).with_width(2.4),
        ),
        ("offset, least norm", &Offset, Solver::LeastNorm, Style::line(Colour::BLUE, Dash::Dashed)),
        ("offset, the paper's iteration", &Offset, Solver::Newton, model_style(Model::Offset)),
    ] {
        let y = azimuths.iter().map(|azimuth| across(model, solver, *azimuth)).collect();
        sideways = sideways.with_curve(Curve::new(name, azimuths.clone(), y, style));
    }
    Figure::new("Angular parts at a tilt of 2°").with_panel(parts).with_panel(sideways)
}

/// Displacement of socket 1 at right angles to its radius, not a number where it vanishes (µm).
fn across(model: &dyn Virtualization, solver: Solver, azimuth: f64) -> f64 {
    let gpr = Gpr::paper().without_limit_checks();
    let x = pose(model, solver, Metric::Paper, azimuth, 2.0).solution.virtual_joints;
    let moved: Vector2<f64> = model.sockets(gpr.platform(), &x)[0] - gpr.platform().sockets()[0];
    let across = gpr.platform().directions()[0].perp(&moved).abs();
    if across < 1e-13 { f64::NAN } else { across / UM }
}

/// Largest difference of a length between the iteration's end and the least norm.
pub(crate) fn newton_least_norm() -> Figure {
    let tilt_angles = by_decades(0.3, 5.0, 50);
    let gap = |metric, tilt_angle| {
        let lengths =
            |solver| pose(&Polar, solver, metric, 0.0, tilt_angle).solution.virtual_joints;
        let (newton, least) = (lengths(Solver::Newton), lengths(Solver::LeastNorm));
        (0..3).map(|k| (newton[k] - least[k]).abs()).fold(0.0, f64::max) * 1e9
    };
    let mut panel =
        Panel::new(Axis::log10("tilt toward rod 1 (°)"), Axis::log10("difference (nm)"))
            .with_height(260.0);
    for (name, metric, style) in [
        ("polar, ρ = 1 mm", Metric::Paper, model_style(Model::Polar)),
        ("polar, ρ = R", Metric::PlatformRadius, Style::line(Colour::BLUE, Dash::Solid)),
    ] {
        let y = tilt_angles.iter().map(|tilt_angle| gap(metric, *tilt_angle)).collect();
        panel = panel.with_curve(Curve::new(name, tilt_angles.clone(), y, style));
    }
    let scale = gap(Metric::Paper, 2.0) / 16.0 * 3.0;
    let fourth = tilt_angles.iter().map(|tilt_angle| scale * tilt_angle.powi(4)).collect();
    let panel = panel.with_curve(Curve::new(
        "fourth power of the tilt",
        tilt_angles,
        fourth,
        Style::line(Colour::GREY, Dash::Dotted),
    ));
    Figure::new("Largest difference of an l between the paper's iteration and the least norm")
        .with_panel(panel)
}
