//! Representative figures, as SVG and as PNG: complete, readable, sound, and the same every time.

use std::io::Read as _;

use crate::gallery;

use jointplay_plot::{Axis, Curve, Error, Figure, Panel, rod_style};
use resvg::tiny_skia::{Pixmap, Rect};
use resvg::usvg::{Group, Node, Options, Tree, roxmltree::Document};

/// An SVG as another program understands it, with the embedded font.
pub(crate) fn parse(svg: &str) -> Tree {
    let mut font = Vec::new();
    let packed = &include_bytes!("../fonts/DejaVuSans.ttf.gz")[..];
    flate2::read::GzDecoder::new(packed).read_to_end(&mut font).unwrap();
    let mut options = Options::default();
    options.fontdb_mut().load_font_data(font);
    Tree::from_str(svg, &options).expect("the SVG is understood")
}

/// The texts of a tree with the boxes they fill.
fn texts(group: &Group, found: &mut Vec<(String, Rect)>) {
    for node in group.children() {
        match node {
            Node::Group(inner) => texts(inner, found),
            Node::Text(text) => {
                let content = text.chunks().iter().map(|chunk| chunk.text()).collect();
                found.push((content, text.abs_bounding_box()));
            }
            _ => {}
        }
    }
}

/// Checks all that holds of every figure, and that these `expected` texts are in it.
fn check(name: &str, figure: &Figure, expected: &[&str]) -> String {
    let svg = figure.to_svg().unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(svg, figure.to_svg().expect("drawn before"), "{name} differs the second time");
    for unsound in ["NaN", "inf"] {
        assert!(!svg.contains(unsound), "{name} contains {unsound}");
    }
    let document = Document::parse(&svg).expect("the SVG is well-formed");
    let written: Vec<&str> = document
        .descendants()
        .filter(|node| node.has_tag_name("text"))
        .filter_map(|node| node.text())
        .collect();
    for text in expected {
        assert!(written.contains(text), "{name}: no {text:?} among {written:?}");
    }

    // Nothing is cut off, and no text covers another.
    let tree = parse(&svg);
    let mut boxes = Vec::new();
    texts(tree.root(), &mut boxes);
    assert_eq!(boxes.len(), written.len());
    for (index, (text, room)) in boxes.iter().enumerate() {
        let inside = room.left() >= 0.0
            && room.top() >= 0.0
            && room.right() <= tree.size().width()
            && room.bottom() <= tree.size().height();
        assert!(inside, "{name}: {text:?} is cut off at {room:?}");
        for (other, place) in &boxes[index + 1..] {
            let apart = room.right() <= place.left()
                || place.right() <= room.left()
                || room.bottom() <= place.top()
                || place.bottom() <= room.top();
            assert!(apart, "{name}: {text:?} at {room:?} covers {other:?} at {place:?}");
        }
    }
    svg
}

#[test]
fn three_rods_over_a_raster() {
    let expected = ["sample", "rod length (mm)", "rod 1", "rod 2", "rod 3", "700"];
    let svg = check("rods", &gallery::rods(), &expected);
    // 21 rows: 21 strokes per rod.
    let document = Document::parse(&svg).expect("checked before");
    let strokes = |colour: &str| {
        let paths = document.descendants().filter(|node| node.attribute("stroke") == Some(colour));
        paths.filter_map(|path| path.attribute("d")).map(|d| d.matches('M').count()).max()
    };
    assert_eq!(strokes("#0072b2"), Some(21));
    assert_eq!(strokes("#d55e00"), Some(21));
}

#[test]
fn micrometres_about_93_218_mm() {
    let ticks = ["93.2180", "93.2185", "93.2190", "93.2195", "93.2200"];
    check("zoom", &gallery::zoom(), &ticks);
    check("zoom", &gallery::zoom(), &["singular pass", "radial", "planar", "approximate"]);
}

#[test]
fn stacked_panels_share_legend_and_x_axis() {
    let svg = check("stacked", &gallery::stacked(), &["10⁻³", "10⁻¹⁵", "×10⁻⁶", "(a) error"]);
    for once in [">rod 2</text>", ">iteration</text>"] {
        assert_eq!(svg.matches(once).count(), 1, "{once}");
    }
}

#[test]
fn triangle_with_its_centres_is_to_scale() {
    let svg = check("triangle", &gallery::triangle(), &["A₁", "G", "orthocentre", "x (mm)"]);
    let document = Document::parse(&svg).expect("checked before");
    let outline = document
        .descendants()
        .filter(|node| node.attribute("stroke") == Some("#000000"))
        .filter_map(|node| node.attribute("d"))
        .max_by_key(|data| data.len())
        .expect("the outline is drawn");
    let numbers: Vec<f64> = outline
        .split(['M', 'L', ' '])
        .filter(|text| !text.is_empty())
        .map(|text| text.parse().expect("a number"))
        .collect();
    let (base, height) = (numbers[2] - numbers[0], numbers[1] - numbers[5]);
    assert!((base / height - 120.0 / 85.0).abs() < 1e-3, "{base} px by {height} px");
}

#[test]
fn long_series_stay_small_files() {
    let svg = check("long", &gallery::long(), &["deviation (µm)", "rod 3"]);
    assert!(svg.len() < 200_000, "{} bytes", svg.len());
}

#[test]
fn odd_figures() {
    check("flat", &gallery::flat(), &["93.0", "93.5"]);
    let long = "first & <best> of all the models that were ever";
    check("column", &gallery::column(), &["×10⁻⁹ + 93.218", long]);
    check("mixed", &gallery::mixed(), &["10⁻¹⁵⁰", "rank 3", "0.05", "(c) to scale"]);
}

#[test]
fn pictures_have_the_width_asked_for() {
    for (name, figure) in gallery::all() {
        let png = figure.to_png(300).unwrap_or_else(|error| panic!("{name}: {error}"));
        let picture = Pixmap::decode_png(&png).expect("a PNG");
        assert_eq!(picture.width(), 300, "{name}");
        let pixels = picture.pixels();
        assert!(pixels.iter().all(|pixel| pixel.is_opaque()), "{name} is not on white");
        assert!(pixels.iter().any(|pixel| pixel.red() < 100), "{name} is empty");
    }
    let flat = gallery::flat();
    assert_eq!(flat.to_png(400), flat.to_png(400));
}

fn plot(x: Axis, y: Axis, xs: &[f64], ys: &[f64]) -> Figure {
    let curve = Curve::new("residual", xs.to_vec(), ys.to_vec(), rod_style(0));
    Figure::new("t").with_panel(Panel::new(x, y).with_curve(curve))
}

#[test]
fn values_of_any_size_are_drawn() {
    let shapes: [&[f64]; 4] = [&[0.0, 1.0], &[-1.0, 1.0, 0.5], &[1.0, 1.0 + 1e-9], &[-3.0, -3.0]];
    for exponent in (-322..308).step_by(30) {
        let unit: f64 = format!("1e{exponent}").parse().expect("a number");
        for shape in shapes {
            let ys: Vec<f64> = shape.iter().map(|y| y * unit).collect();
            let xs: Vec<f64> = (0..ys.len()).map(|x| x as f64).collect();
            let name = format!("{shape:?} · 1e{exponent}");
            check(&name, &plot(Axis::linear("x"), Axis::linear("y"), &xs, &ys), &["y"]);
            check(&name, &plot(Axis::linear("x"), Axis::linear("y"), &ys, &xs), &["x"]);
            if ys.iter().all(|y| *y > 0.0) {
                check(&name, &plot(Axis::linear("x"), Axis::log10("y"), &xs, &ys), &["y"]);
            }
        }
    }
}

fn refuse(figure: &Figure, message: &str) {
    let error = figure.to_svg().expect_err("the figure cannot be drawn");
    assert_eq!(error.to_string(), message);
    let png = figure.to_png(100).expect_err("no picture without SVG");
    assert_eq!(png.to_string(), message);
}

#[test]
fn what_cannot_be_drawn() {
    let (x, y) = (|| Axis::linear("x"), || Axis::linear("y"));
    let log = || Axis::log10("y");
    refuse(&Figure::new("t"), "figure \"t\" has no panel: add at least one");
    refuse(
        &plot(x(), y(), &[1.0], &[1.0, 2.0]),
        "panel 0, curve \"residual\": 1 values of x but 2 values of y",
    );
    refuse(
        &plot(x(), y(), &[1.0, f64::INFINITY], &[f64::NAN, 2.0]),
        "panel 0: none of its 1 curves has a finite point",
    );
    refuse(
        &plot(x(), log(), &[1.0, 2.0], &[1e-9, 0.0]),
        "panel 0, curve \"residual\", point 1: 0.0 on the logarithmic axis \"y\" must be above 0",
    );
    refuse(
        &plot(x(), y().with_range(2.0, 1.0), &[1.0], &[1.0]),
        "panel 0, axis \"y\": cannot draw the range from 2.0 to 1.0",
    );
    refuse(
        &plot(x(), log().with_range(-1.0, 1.0), &[1.0], &[1.0]),
        "panel 0, lower end of the range: -1.0 on the logarithmic axis \"y\" must be above 0",
    );
    let mut marked = plot(x(), y(), &[1.0], &[1.0]);
    marked.panels[0].markers.push(jointplay_plot::Marker { x: f64::NAN, label: "m".to_string() });
    refuse(&marked, "panel 0, marker \"m\": position NaN on axis \"x\" is not finite");
    let mut aspect = plot(x(), log(), &[1.0], &[1.0]);
    aspect.panels[0].equal_aspect = true;
    refuse(&aspect, "panel 0: equal aspect needs two linear axes, but \"y\" is logarithmic");
    let narrow = plot(x(), y(), &[1.0], &[1.0]).with_width(3.0);
    refuse(&narrow, "width of the figure is 3 px, outside 240 px to 4000 px");
    let wide = plot(x(), y(), &[1.0], &[1.0]).to_png(0);
    assert!(matches!(wide, Err(Error::Size { found: 0.0, .. })));
}
