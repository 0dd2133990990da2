//! The paper's iteration with its derivatives as printed and as they should be.

use jointplay::gpr::{Gpr, ball_sides};
use jointplay::plot::{Axis, Colour, Curve, Dash, Figure, Panel, Point, Style};
use jointplay_validation::cases::{HEIGHT, RADIUS, tilt};
use jointplay_validation::printed::{ByL, Step, ThirdColumn, iterate};

const STEPS: usize = 10;
/// Residuals below this one are round-off (m).
const ROUND_OFF: f64 = 1e-16;

/// Residual and distance from the right answer, step by step.
pub(crate) fn figure() -> Figure {
    let gpr = Gpr::paper().without_limit_checks();
    let rods = gpr.inverse(tilt(0.0, 2.0), HEIGHT).expect("a pose of the robot");
    let sides = ball_sides(&gpr.ball_centers(&rods));
    let start = [RADIUS, RADIUS, RADIUS, 0.0, 0.0, 0.0];
    let run = |third, rho| iterate(third, ByL::Midpoint, start, &sides, rho, STEPS);
    let mut residuals = Panel::new(Axis::linear("iteration"), Axis::log10("residual (µm)"))
        .with_title("(a) largest error of a side");
    let mut distances = Panel::new(Axis::linear("iteration"), Axis::log10("distance (µm)"))
        .with_title("(b) distance in X from the right answer");
    for (name, third, rho, style) in [
        (
            "as printed, ρ = 1 mm",
            ThirdColumn::Printed,
            1e-3,
            Style::line(Colour::VERMILLION, Dash::Solid).with_point(Point::Circle),
        ),
        (
            "as printed, ρ = R",
            ThirdColumn::Printed,
            RADIUS,
            Style::line(Colour::ORANGE, Dash::Dashed).with_point(Point::Square),
        ),
        (
            "put right, ρ = 1 mm",
            ThirdColumn::Right,
            1e-3,
            Style::line(Colour::BLUE, Dash::Solid).with_point(Point::Ring),
        ),
    ] {
        let steps = run(third, rho);
        let right = run(ThirdColumn::Right, rho)[STEPS].x;
        let off = |step: &Step| {
            let part = |m: usize| {
                let weight = if m < 3 { 1.0 } else { rho };
                (weight * (step.x[m] - right[m])).powi(2)
            };
            (0..6).map(part).sum::<f64>().sqrt()
        };
        let iteration: Vec<f64> = (0_u32..).take(steps.len()).map(f64::from).collect();
        let in_um = |value: f64| value.max(ROUND_OFF) * 1e6;
        let y = steps.iter().map(|step| in_um(step.residual)).collect();
        residuals = residuals.with_curve(Curve::new(name, iteration.clone(), y, style));
        let y = steps.iter().map(|step| in_um(off(step))).collect();
        distances = distances.with_curve(Curve::new(name, iteration, y, style));
    }
    Figure::new("The iteration of IV.B with ∂F/∂X of V.A, tilt 2°")
        .with_panel(residuals)
        .with_panel(distances)
}
