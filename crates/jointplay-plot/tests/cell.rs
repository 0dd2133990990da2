//! Pictures of cells: what they hold, and that nothing is cut off.

use jointplay_cell::EntityId;
use jointplay_cell::geometry::Shape;
use jointplay_cell::robot::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, KinematicLimits,
    PlatformModel,
};
use jointplay_cell::station::teach::{FrameUncertainty, TaughtFrame, fit_plane};
use jointplay_cell::station::{Approach, Origin, Station, Stroke};
use jointplay_cell::wafer::{Droop, Material, Support, Wafer};
use jointplay_cell::workcell::{Body, Cell, ParentFrame, Zone, ZoneRule};
use jointplay_core::gpr::Gpr;
use jointplay_core::spatial::{Pose, Tilt, tilt_rotation};
use jointplay_plot::Error;
use jointplay_plot::cell::{EffectorPath, Gantt, Interval, IntervalKind, Taught, TopView};
use nalgebra::Vector3;
use resvg::usvg::{Group, Node, roxmltree::Document};

/// The colour of violations.
const VERMILLION: &str = "#d55e00";
const ID: EffectorId = EffectorId { arm: 0, effector: 0 };

/// A robot with a prismatic axis in front of two stations, one of them tilted, a wall and a zone.
fn cell() -> Cell {
    let dynamics = KinematicLimits { velocity: 1.0, acceleration: 5.0, jerk: 50.0 };
    let axis = |name: &str, kind, min, max| Axis {
        name: name.to_owned(),
        kind,
        min,
        max,
        home: 0.5 * (min + max),
        empty: dynamics,
        loaded: dynamics,
    };
    let gpr = Gpr::paper();
    let rod = |name| axis(name, AxisKind::Linear, gpr.limits().rod_min, gpr.limits().rod_max);
    let joint = |kind, drives: usize| ArmJoint {
        kind,
        zero: 0.0,
        drives: vec![(drives, 1.0)],
        length: 0.1,
        offset: 0.0,
        rise: 0.01,
    };
    let arm = Arm {
        name: "slide".to_owned(),
        mount: [0.0, 0.0, 0.1],
        joints: vec![joint(AxisKind::Rotary, 3), joint(AxisKind::Linear, 4)],
        effectors: vec![Effector {
            name: "A".to_owned(),
            wafer_center: [0.2, 0.0, 0.0],
            heading: 0.0,
            support: Support::Edge,
            friction: 0.4,
        }],
        droop: Droop::Rigid,
    };
    let axes = vec![
        rod("q1"),
        rod("q2"),
        rod("q3"),
        axis("T", AxisKind::Rotary, -3.0, 3.0),
        axis("R", AxisKind::Linear, 0.0, 0.3),
    ];
    let (model, assumed) = (PlatformModel::default(), vec![]);
    let robot =
        HybridRobot { name: "one arm".to_owned(), gpr, model, axes, arms: vec![arm], assumed };
    let station = |name: &str, x: f64, y: f64, slots: usize, angle: f64| Station {
        name: name.to_owned(),
        base_from_station: Pose::from_parts(
            nalgebra::Translation3::new(x, y, 0.62),
            tilt_rotation(&Tilt { azimuth: 0.4, angle }.normal()),
        ),
        origin: Origin::Nominal,
        uncertainty: FrameUncertainty::UNKNOWN,
        slots,
        pitch: 0.01,
        slot_step: [0.0; 2],
        stroke: Stroke { below: 0.005, above: 0.005, speed: 0.05 },
        offset: [0.0; 3],
        retract_reach: 0.3,
        via: vec![],
        approach: Approach::Radial,
        effectors: vec![ID],
        process_time: 0.0,
    };
    let wall = Body {
        name: "wall".to_owned(),
        parent: ParentFrame::World,
        parent_from_shape: Pose::translation(0.0, -0.5, 0.5),
        shape: Shape::Box { half: [0.3, 0.02, 0.5] },
        station: None,
    };
    let zone = Zone {
        name: "door".to_owned(),
        rule: ZoneRule::KeepOut,
        base_from_shape: Pose::translation(-0.5, 0.3, 0.5),
        shape: Shape::Cylinder { radius: 0.1, half_height: 0.5 },
    };
    let silicon =
        Material { name: "silicon".to_owned(), young: 147e9, poisson: 0.18, density: 2329.0 };
    Cell {
        name: "a cell".to_owned(),
        assumed: vec![],
        robot: robot.checked().unwrap(),
        wafer: Wafer { diameter: 0.3, thickness: 775e-6, material: silicon },
        stations: vec![station("port", 0.6, 0.2, 25, 0.0), station("aligner", 0.1, 0.6, 1, 0.014)],
        occupied: vec![],
        loaded_effectors: vec![],
        bodies: vec![wall],
        allowed_pairs: vec![],
        zones: vec![zone],
        rules: jointplay_cell::station::WaferRules::default(),
        play_budget: 1e-4,
        clearance: 0.001,
        slot_clearance: 0.001,
        gravity: 9.81,
        plane_threshold: 1e-3,
        coverage_factor: 2.0,
        tolerances: jointplay_cell::displacement::Tolerances::default(),
    }
}

fn texts(group: &Group, found: &mut Vec<(String, resvg::tiny_skia::Rect)>) {
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

/// Checks that a picture is sound, that no text is cut off, and that these `expected` texts are in it; all texts with their room.
fn check(svg: &str, expected: &[&str]) -> Vec<(String, resvg::tiny_skia::Rect)> {
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    Document::parse(svg).unwrap();
    let tree = crate::figures::parse(svg);
    let mut found = Vec::new();
    texts(tree.root(), &mut found);
    for text in expected {
        assert!(found.iter().any(|(known, _)| known == text), "no {text:?} among {found:?}");
    }
    for (text, room) in &found {
        let inside = room.left() >= 0.0
            && room.top() >= 0.0
            && room.right() <= tree.size().width()
            && room.bottom() <= tree.size().height();
        assert!(inside, "{text:?} is cut off at {room:?}");
    }
    found
}

#[test]
fn a_cell_from_above() {
    let cell = cell();
    let mut view = TopView::new(&cell);
    let points = (0..200).map(|k| {
        let angle = 0.01 * f64::from(k);
        [0.5 * angle.cos(), 0.5 * angle.sin()]
    });
    view.paths.push(EffectorPath { effector: ID, reach: [0.3, 0.6], points: points.collect() });
    assert!(!view.to_svg().unwrap().contains(">wall</text>"));
    view.violations.push([0.3, 0.4]);
    view.violating.extend([EntityId::Body(0), EntityId::Zone(0), EntityId::Body(1)]);
    let svg = view.to_svg().unwrap();
    let expected = [
        "wall",
        "door",
        "in violation",
        "a cell",
        "port, 25 slots",
        "aligner, 0.802°",
        "wafer centre of A",
        "reach of A",
        "keep-out zone",
        "body",
        "violation",
    ];
    check(&svg, &expected);
    assert_eq!(svg, view.to_svg().unwrap());
    assert!(view.to_png(400).unwrap().starts_with(b"\x89PNG"));
    view.width = 10.0;
    assert!(matches!(view.to_svg(), Err(Error::Size { .. })));
}

#[test]
fn a_cell_that_is_too_large_is_refused() {
    let mut cell = cell();
    cell.stations[0].base_from_station = Pose::translation(1e9, 0.0, 0.0);
    cell.stations[1].base_from_station = Pose::translation(0.0, f64::NAN, 0.0);
    let mut view = TopView::new(&cell);
    view.paths.push(EffectorPath { effector: ID, reach: [0.0, f64::INFINITY], points: vec![] });
    assert!(matches!(view.to_svg(), Err(Error::Extent { .. })));
}

/// A station whose four taught points are off their plane by a height, up and down in turn.
fn taught(off: f64, threshold: f64) -> Cell {
    let mut cell = cell();
    let point = |k: u32| {
        let (x, y) = [(0.1, 0.0), (0.0, 0.1), (-0.1, 0.0), (0.0, -0.1)][k as usize];
        let height = if k.is_multiple_of(2) { off } else { -off };
        Vector3::new(0.6 + x, 0.2 + y, 0.62 + 0.01 * x + height)
    };
    let points: Vec<Vector3<f64>> = (0..4).map(point).collect();
    let fit = fit_plane(&points, threshold, None).unwrap();
    cell.stations[0].base_from_station = fit.frame(&points[0], 0.0);
    cell.stations[0].origin =
        Origin::Taught(Box::new(TaughtFrame { plane: Some(fit), references: None }));
    cell
}

#[test]
fn stations_as_they_were_taught() {
    let cell = taught(2e-5, 1e-4);
    let mut picture = Taught::new(&cell);
    let expected = [
        "a cell: stations",
        "port",
        "tilt 0.5729° toward 180.0°",
        "4 points, distances up to 20.0 µm (allowed 100.0), tilt ±5649 µrad:",
        "untested",
        "1: +20.0 µm",
        "4: -20.0 µm",
        "aligner",
        "tilt 0.8021° toward 22.9°",
        "nominal, not taught",
        "dashed: level; tilt scale 14×; distance scale 1500×",
    ];
    let svg = picture.to_svg().unwrap();
    check(&svg, &expected);
    assert_eq!(svg, picture.to_svg().unwrap());
    assert!(picture.to_png(400).unwrap().starts_with(b"\x89PNG"));
    // Points beyond the threshold look otherwise; points on the plane take no factor.
    assert!(!svg.contains(VERMILLION));
    let inconsistent = taught(2e-5, 1e-5);
    let svg = Taught::new(&inconsistent).to_svg().unwrap();
    let lines =
        ["4 points, distances up to 20.0 µm (allowed 10.0), tilt ±5649 µrad:", "inconsistent"];
    check(&svg, &lines);
    assert_eq!(svg.matches(VERMILLION).count(), 8);
    // Points of known noise that agree.
    let mut noisy = taught(0.0, 1e-4);
    let points: Vec<Vector3<f64>> = (0..8)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::FRAC_PI_4;
            Vector3::new(0.6 + 0.1 * angle.cos(), 0.2 + 0.1 * angle.sin(), 0.62)
        })
        .collect();
    let fit = fit_plane(&points, 1e-4, Some(&[1e-5; 8])).unwrap();
    noisy.stations[0].origin =
        Origin::Taught(Box::new(TaughtFrame { plane: Some(fit), references: None }));
    for (budget, result) in [(1e-3, "fits"), (1e-5, "uncertain")] {
        noisy.plane_threshold = budget;
        let svg = Taught::new(&noisy).to_svg().unwrap();
        assert!(svg.contains(&format!("{result}</text>")), "{budget}: {svg}");
        // Distances that round to zero have no sign.
        assert!(svg.contains("1: 0.0 µm"), "{svg}");
    }
    let even = taught(0.0, 1e-5);
    let mut one = Taught::new(&even);
    one.stations = vec![0];
    check(&one.to_svg().unwrap(), &["dashed: level; tilt scale 20×"]);
    one.stations = vec![1, 7];
    assert!(!one.to_svg().unwrap().contains(">port</text>"));
    picture.width = 10.0;
    assert!(matches!(picture.to_svg(), Err(Error::Size { .. })));
    let mut far = taught(2e-5, 1e-4);
    far.wafer.diameter = 1e9;
    assert!(matches!(Taught::new(&far).to_svg(), Err(Error::Extent { .. })));
}

fn labels(text: &str) -> Vec<String> {
    let first = text.split_whitespace().next().unwrap_or_default();
    vec![text.to_owned(), first.to_owned()]
}

fn gantt(duration: f64) -> Gantt {
    let span = |from: f64, to: f64, kind| Interval { from, to, kind };
    Gantt {
        axes: vec!["q1".to_owned(), "T".to_owned()],
        places: vec!["wafer on A".to_owned(), "port".to_owned()],
        intervals: vec![
            span(0.0, 0.5 * duration, IntervalKind::Instruction(labels("GET port SLOT 1 WITH A"))),
            span(0.5 * duration, duration, IntervalKind::Instruction(labels("PUT aligner"))),
            span(0.0, 0.4 * duration, IntervalKind::Empty(1)),
            span(0.5 * duration, duration, IntervalKind::Loaded(0)),
            span(0.2 * duration, 0.7 * duration, IntervalKind::Wafers { row: 0, share: 1.0 }),
            span(0.7 * duration, duration, IntervalKind::Wafers { row: 1, share: 0.04 }),
            span(0.7 * duration, 0.9 * duration, IntervalKind::Process(1)),
            span(0.6 * duration, 0.6 * duration, IntervalKind::Violation),
        ],
        window: [0.0, duration],
        max_bands: 12,
        title: "axes".to_owned(),
        width: 720.0,
    }
}

#[test]
fn axes_over_time() {
    let expected = [
        "axes",
        "q1",
        "T",
        "wafer on A",
        "port",
        "violations",
        "GET port SLOT 1 WITH A",
        "moving without wafer",
        "wafers, share of slots",
        "process",
        "violation",
    ];
    check(&gantt(8.0).to_svg().unwrap(), &expected);
}

#[test]
fn a_long_motion_takes_several_bands() {
    let (short, long) = (gantt(50.0).to_svg().unwrap(), gantt(500.0).to_svg().unwrap());
    let rows = |svg: &str| svg.matches(">q1</text>").count();
    assert_eq!((rows(&short), rows(&long)), (1, 9));
    check(&long, &["axes", "q1"]);
    check(&gantt(1e5).to_svg().unwrap(), &["axes", "q1"]);
}

#[test]
fn no_number_runs_into_the_unit_of_time() {
    // Rows that begin at a number, and others that begin just before one.
    for duration in [851.143_8, 600.0, 4321.0] {
        let found = check(&gantt(duration).to_svg().unwrap(), &["s"]);
        let units = found.iter().filter(|(text, _)| text == "s");
        for (_, unit) in units {
            for (text, room) in found.iter().filter(|(text, _)| text.parse::<f64>().is_ok()) {
                let apart = room.left() > unit.right() + 1.0
                    || room.top() > unit.bottom()
                    || room.bottom() < unit.top();
                assert!(apart, "{text} overlaps the s at {unit:?}: {room:?}");
            }
        }
    }
}

#[test]
fn a_motion_that_takes_no_time_is_refused() {
    for duration in [0.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(gantt(duration).to_svg(), Err(Error::Extent { .. })), "{duration}");
    }
}
