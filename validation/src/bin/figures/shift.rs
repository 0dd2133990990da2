//! Shift of the platform's centre.

use std::f64::consts::FRAC_PI_2;

use jointplay::Error;
use jointplay::gpr::Gpr;
use jointplay::plot::{Axis, Colour, Curve, Dash, Figure, Model, Panel, Point, Style, model_style};
use jointplay::spatial::nearest_angle;
use jointplay::virtualization::{Metric, Offset, Planar, Polar, Radial, Solver, Virtualization};
use jointplay_validation::cases::{HEIGHT, RADIUS, pose, tilt};
use jointplay_validation::centers::{centroid, circumcenter, fermat_point};
use jointplay_validation::elastic::equilibrium;
use nalgebra::{Vector2, Vector3};

use crate::{by_decades, evenly};

const UM: f64 = 1e-6;

/// Models that determine the position of the centre, with their styles in the figures.
fn models() -> [(&'static str, &'static dyn Virtualization, Solver, Style); 4] {
    let (newton, closed) = (Solver::Newton, Solver::ClosedForm);
    [
        ("radial", &Radial, closed, model_style(Model::Radial)),
        ("polar, ρ = 1 mm", &Polar, newton, model_style(Model::Polar)),
        ("offset", &Offset, newton, model_style(Model::Offset).with_width(3.2)),
        ("planar", &Planar, closed, model_style(Model::Planar).with_width(2.4)),
    ]
}

fn elastic_style() -> Style {
    Style::line(Colour::GREEN, Dash::Solid)
}

/// Shift of the polar model at 2° against ρ.
pub(crate) fn against_characteristic_length() -> Result<Figure, Error> {
    let lengths = by_decades(1e-5, 1e2, 141);
    let shift = |rho: f64| {
        let found = pose(&Polar, Solver::Newton, Metric::Length(rho), 0.0, 2.0);
        found.center_shift().x / UM
    };
    let in_mm = |lengths: &[f64]| lengths.iter().map(|rho| rho * 1e3).collect::<Vec<_>>();
    let balls = Gpr::paper()
        .ball_centers(&Gpr::paper().without_limit_checks().inverse(tilt(0.0, 2.0), HEIGHT)?);
    let ends = vec![1e-2, 1e5];
    let line = |name, point: Vector3<f64>, style| {
        Curve::new(name, ends.clone(), vec![point.x / UM; 2], style)
    };
    let panel = Panel::new(
        Axis::log10("characteristic length ρ (mm)"),
        Axis::linear("centre shift toward rod 1 (µm)").with_range(-34.0, 34.0),
    )
    .with_curve(line("circumcentre", circumcenter(&balls), thin(Colour::VERMILLION, Dash::Dashed)))
    .with_curve(line("centroid", centroid(&balls), thin(Colour::PURPLE, Dash::Dotted)))
    .with_curve(line("Fermat point", fermat_point(&balls), thin(Colour::BLACK, Dash::DashDot)))
    .with_curve(Curve::new(
        "polar",
        in_mm(&lengths),
        lengths.iter().map(|rho| shift(*rho)).collect(),
        Style::line(Colour::ORANGE, Dash::Solid).with_width(2.4),
    ))
    .with_marker(1.0, "1 mm")
    .with_marker(RADIUS * 1e3, "R")
    .with_marker(1e3, "1 m")
    .with_height(260.0);
    Ok(Figure::new("One robot, one tilt of 2°: the polar model answers by its unit")
        .with_panel(panel))
}

const fn thin(colour: Colour, dash: Dash) -> Style {
    Style::line(colour, dash).with_width(1.2)
}

/// Shift of every model against the tilt, and its azimuth over a full turn of the azimuth.
pub(crate) fn against_tilt() -> Result<Figure, Error> {
    let gpr = Gpr::paper().without_limit_checks();
    let tilt_angles = evenly(0.0, 2.0, 41);
    let directions = evenly(0.0, 180.0, 181);
    let mut shifts =
        Panel::new(Axis::linear("tilt (°)"), Axis::linear("centre shift toward rod 1 (µm)"))
            .with_title("(a) tilt toward rod 1");
    let mut azimuths = Panel::new(
        Axis::linear("azimuth of the tilt (°)"),
        Axis::linear("azimuth of the shift (°)").with_range(-370.0, 190.0),
    )
    .with_title("(b) azimuth of the shift at a tilt of 2°");
    for (name, model, solver, style) in models() {
        let at = |azimuth, tilt_angle| {
            pose(model, solver, Metric::Paper, azimuth, tilt_angle).center_shift() / UM
        };
        let y = tilt_angles.iter().map(|tilt_angle| at(0.0, *tilt_angle).x).collect();
        shifts = shifts.with_curve(Curve::new(name, tilt_angles.clone(), y, style));
        // The planar centre stays, so that its shift has no azimuth.
        if name != "planar" {
            let y = azimuths_deg(directions.iter().map(|azimuth| at(*azimuth, 2.0)));
            azimuths = azimuths.with_curve(Curve::new(name, directions.clone(), y, style));
        }
    }
    let rest = |azimuth: f64, tilt_angle: f64| -> Result<Vector2<f64>, Error> {
        let balls = gpr.ball_centers(&gpr.inverse(tilt(azimuth, tilt_angle), HEIGHT)?);
        Ok(equilibrium(gpr.platform().sockets(), &balls).origin.xy() / UM)
    };
    let name = "elastic rods";
    let along = tilt_angles
        .iter()
        .map(|tilt_angle| rest(0.0, *tilt_angle))
        .collect::<Result<Vec<_>, _>>()?;
    let y = along.iter().map(|at| at.x).collect();
    shifts = shifts.with_curve(Curve::new(name, tilt_angles.clone(), y, elastic_style()));
    let around =
        directions.iter().map(|azimuth| rest(*azimuth, 2.0)).collect::<Result<Vec<_>, _>>()?;
    let y = azimuths_deg(around.into_iter());
    azimuths = azimuths.with_curve(Curve::new(name, directions, y, elastic_style()));
    let approximate = model_style(Model::Approximate);
    let zero = vec![0.0; tilt_angles.len()];
    shifts = shifts.with_curve(Curve::new("approximate", tilt_angles, zero, approximate));
    Ok(Figure::new("Shift of the centre of the platform").with_panel(shifts).with_panel(azimuths))
}

/// Azimuths without jumps of a whole turn (°).
fn azimuths_deg(shifts: impl Iterator<Item = Vector2<f64>>) -> Vec<f64> {
    let mut last: Option<f64> = None;
    shifts
        .map(|shift| {
            // The first one in −90°…270°, so that round-off does not throw 180° to −180°.
            let near = last.unwrap_or(FRAC_PI_2);
            let azimuth = nearest_angle(shift.y.atan2(shift.x), near);
            last = Some(azimuth);
            azimuth.to_degrees()
        })
        .collect()
}

/// The triangle of the ball centres in its own plane, for a tilt far beyond the robot's.
pub(crate) fn triangle() -> Figure {
    let tilt_angle = 45.0_f64.to_radians();
    // Toward rod 1 the triangle is drawn out along the slope, by 1/cos α.
    let corners = [0.0_f64, 120.0, 240.0].map(|angle| {
        let (sin, cos) = angle.to_radians().sin_cos();
        Vector3::new(cos / tilt_angle.cos(), sin, 0.0) * RADIUS * 1e3
    });
    let outline = |corners: &[Vector3<f64>; 3]| -> (Vec<f64>, Vec<f64>) {
        [0, 1, 2, 0].iter().map(|k: &usize| (corners[*k].x, corners[*k].y)).unzip()
    };
    let (x, y) = outline(&corners);
    let mut panel = Panel::new(Axis::linear("along the slope (mm)"), Axis::linear("across (mm)"))
        .with_curve(Curve::new("ball centres", x, y, thin(Colour::BLACK, Dash::Solid)))
        .with_equal_aspect();
    for (name, center, point, colour) in [
        ("Fermat point: radial", fermat_point(&corners), Point::Triangle, Colour::BLACK),
        ("centroid: planar", centroid(&corners), Point::Circle, Colour::PURPLE),
        ("circumcentre: polar with ρ → 0", circumcenter(&corners), Point::Square, Colour::ORANGE),
    ] {
        let spokes: (Vec<f64>, Vec<f64>) = corners
            .iter()
            .flat_map(|corner| [(center.x, center.y), (corner.x, corner.y), (f64::NAN, f64::NAN)])
            .unzip();
        panel = panel
            .with_curve(Curve::new("", spokes.0, spokes.1, thin(colour, Dash::Dotted)))
            .with_curve(Curve::new(
                name,
                vec![center.x],
                vec![center.y],
                Style::points(colour, point),
            ));
    }
    for (k, corner) in corners.iter().enumerate() {
        panel = panel.with_label(corner.x, corner.y, ["P₁", "P₂", "P₃"][k]);
    }
    Figure::new("Three centres of one triangle, tilt exaggerated to 45°").with_panel(panel)
}
