//! Representative figures; their numbers are made up.

use jointplay_plot::{
    Axis, Colour, Curve, Figure, Model, Panel, Point, Style, model_style, rod_style,
};

fn samples(count: usize, y: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
    let x: Vec<f64> = (0..count).map(|sample| sample as f64).collect();
    let y = x.iter().map(|x| y(*x)).collect();
    (x, y)
}

fn curve(name: &str, count: usize, style: Style, y: impl Fn(f64) -> f64) -> Curve {
    let (x, y) = samples(count, y);
    Curve::new(name, x, y, style)
}

/// Three rods over a raster of 21 rows of 37 samples; the line breaks where a row ends.
pub(crate) fn rods() -> Figure {
    let mut panel = Panel::new(Axis::linear("sample"), Axis::linear("rod length (mm)"));
    for rod in 0..3 {
        let phase = rod as f64 * 2.0944;
        let length = move |i: f64| {
            let (row, column) = ((i / 37.0).floor() - 10.0, i % 37.0 - 18.0);
            if i % 37.0 == 36.0 {
                return f64::NAN;
            }
            93.218 + 0.9 * row * phase.sin() + 0.5 * column * phase.cos() + 0.02 * row * row
        };
        panel = panel.with_curve(curve(&format!("rod {}", rod + 1), 777, rod_style(rod), length));
    }
    Figure::new("Rod lengths along the raster").with_panel(panel)
}

/// Micrometres about 93.218 mm, with a named pass.
pub(crate) fn zoom() -> Figure {
    let mut panel = Panel::new(Axis::linear("pass"), Axis::linear("rod length (mm)"))
        .with_marker(41.0, "singular pass")
        .with_marker(55.0, "second singular pass");
    for (k, model) in Model::ALL.into_iter().enumerate() {
        let y = move |i: f64| 93.2190 + 0.0010 * (i * 0.06 + k as f64).sin();
        panel = panel.with_curve(curve(
            &format!("{model:?}").to_lowercase(),
            120,
            model_style(model),
            y,
        ));
    }
    Figure::new("Models about the home position").with_panel(panel)
}

/// Two panels over one x axis, the lower with residuals from 1e-3 down to 1e-15.
pub(crate) fn stacked() -> Figure {
    let mut lengths = Panel::new(Axis::linear("iteration"), Axis::linear("error of length (m)"))
        .with_title("(a) error");
    let mut residuals = Panel::new(Axis::linear("iteration"), Axis::log10("residual (m)"))
        .with_title("(b) residual")
        .with_marker(7.5, "switch of step");
    for rod in 0..3 {
        let name = format!("rod {}", rod + 1);
        let style = rod_style(rod).with_point([Point::Circle, Point::Square, Point::Ring][rod]);
        let slope = 0.8 + 0.1 * rod as f64;
        let wave = move |i: f64| 5e-4 * (-0.3 * i).exp() * (i + rod as f64).cos();
        lengths = lengths.with_curve(curve(&name, 14, style, wave));
        let fall = move |i: f64| 10f64.powf(-3.0 - slope * i);
        residuals = residuals.with_curve(curve(&name, 14, style, fall));
    }
    Figure::new("Convergence").with_panel(lengths).with_panel(residuals)
}

/// A triangle with its centres, drawn to scale.
pub(crate) fn triangle() -> Figure {
    let (a, b, c) = ((0.0, 0.0), (120.0, 0.0), (35.0, 85.0));
    let outline = Curve::new(
        "platform",
        vec![a.0, b.0, c.0, a.0],
        vec![a.1, b.1, c.1, a.1],
        Style::line(Colour::BLACK, jointplay_plot::Dash::Solid),
    );
    let centre = |name: &str, x: f64, y: f64, style| Curve::new(name, vec![x], vec![y], style);
    let panel = Panel::new(Axis::linear("x (mm)"), Axis::linear("y (mm)"))
        .with_curve(outline)
        .with_curve(centre("centroid", 51.67, 28.33, Style::points(Colour::BLUE, Point::Circle)))
        .with_curve(centre(
            "circumcentre",
            60.0,
            25.0,
            Style::points(Colour::VERMILLION, Point::Square),
        ))
        .with_curve(centre(
            "orthocentre",
            35.0,
            35.0,
            Style::points(Colour::GREEN, Point::Triangle),
        ))
        .with_label(51.67, 28.33, "G")
        .with_label(60.0, 25.0, "O")
        .with_label(35.0, 35.0, "H")
        .with_label(a.0, a.1, "A₁")
        .with_label(b.0, b.1, "A₂")
        .with_label(c.0, c.1, "A₃")
        .with_equal_aspect();
    Figure::new("Platform and its centres").with_panel(panel)
}

/// Three noisy curves of 8000 points, one of them flat.
pub(crate) fn long() -> Figure {
    let mut panel = Panel::new(Axis::linear("sample"), Axis::linear("deviation (µm)"));
    for rod in 0..3 {
        let noise = move |i: f64| {
            let grain = (i * 12.9898 + rod as f64).sin() * 43758.5453;
            match rod {
                2 => 5.0,
                _ => 4.0 * rod as f64 + grain.fract() + (i * 1e-3).sin(),
            }
        };
        panel = panel.with_curve(curve(&format!("rod {}", rod + 1), 8000, rod_style(rod), noise));
    }
    Figure::new("").with_panel(panel)
}

/// One value all along.
pub(crate) fn flat() -> Figure {
    let panel = Panel::new(Axis::linear("sample"), Axis::linear("rod length (mm)"))
        .with_curve(curve("rod 1", 50, rod_style(0), |_| 93.218));
    Figure::new("A flat series").with_panel(panel)
}

/// Nanometres about 93.218 mm, in the width of a column, with a long title and long names.
pub(crate) fn column() -> Figure {
    let panel = Panel::new(
        Axis::linear("time since the start of the program (s)").with_range(1000.0, 1000.002),
        Axis::linear("length of the rod between the centres of its two joints, as measured (mm)"),
    )
    .with_curve(Curve::new(
        "first & <best> of all the models that were ever compared",
        (0..200).map(|i| 1000.0 + 1e-5 * f64::from(i)).collect(),
        (0..200).map(|i| 93.218 + 1e-9 * f64::from(i % 50)).collect(),
        model_style(Model::Radial),
    ))
    .with_curve(Curve::new(
        "second",
        vec![1000.0, 1000.002],
        vec![93.218, 93.218 + 5e-8],
        model_style(Model::Polar),
    ));
    Figure::new("A figure as wide as a column with a title that needs two lines")
        .with_width(360.0)
        .with_panel(panel)
}

/// Panels with different curves, axes and scales.
pub(crate) fn mixed() -> Figure {
    let power = |exponent: f64| (1..=60).map(move |i| f64::from(i).powf(exponent)).collect();
    let log = Panel::new(Axis::log10("number of cores"), Axis::log10("time (s)"))
        .with_title("(a) both axes logarithmic, less than two decades")
        .with_curve(Curve::new("all", power(1.0), power(-0.8), model_style(Model::Radial)));
    let wide = Panel::new(Axis::log10("threshold"), Axis::linear("rank"))
        .with_title("(b) many decades")
        .with_curve(Curve::new(
            "rank",
            (0..200).map(|i| 10f64.powi(-i)).collect(),
            (0..200).map(|i| f64::from(i / 40)).collect(),
            rod_style(1),
        ))
        .with_label(1e-120, 3.0, "rank 3");
    let ring: Vec<f64> = (0..=200).map(|i| f64::from(i) * 0.0314159).collect();
    let circle = Panel::new(Axis::linear("x (mm)"), Axis::linear("y (mm)"))
        .with_title("(c) to scale")
        .with_curve(Curve::new(
            "orbit",
            ring.iter().map(|t| 3.0 * t.cos()).collect(),
            ring.iter().map(|t| t.sin()).collect(),
            rod_style(2),
        ))
        .with_equal_aspect()
        .with_height(220.0);
    Figure::new("Mixed panels").with_panel(log).with_panel(wide).with_panel(circle)
}

/// All of them, by name.
pub(crate) fn all() -> Vec<(&'static str, Figure)> {
    vec![
        ("rods", rods()),
        ("zoom", zoom()),
        ("stacked", stacked()),
        ("triangle", triangle()),
        ("long", long()),
        ("flat", flat()),
        ("column", column()),
        ("mixed", mixed()),
    ]
}
