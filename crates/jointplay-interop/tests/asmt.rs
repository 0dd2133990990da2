//! Assemblies of the solver of FreeCAD: joints, limits, couplings, and what is refused.

use jointplay_core::mechanism::{Kinematics, assemble, guess};
use jointplay_format::mechanism::LengthUnit;
use jointplay_interop::import::{Dialect, Error, Imported, parse_with_unit};
use nalgebra::Vector3;

use super::testing;

const SLIDER_CRANK: &str = include_str!("../../../validation/golden/models/slider-crank.asmt");
const FLIPPED: &str = include_str!("../../../validation/golden/models/flipped-four-bar.asmt");

const GEARS: &str = include_str!("../../../validation/golden/models/gear-train.asmt");
const RACK: &str = include_str!("../../../validation/golden/models/rack-and-screw.asmt");
const CARDAN: &str = include_str!("../../../validation/golden/models/cardan.asmt");

#[test]
fn assemblies_close_as_drawn() {
    for (text, joints, actuated, links, couplings) in [
        (SLIDER_CRANK, 4, 1, 4, 0),
        (FLIPPED, 4, 1, 4, 0),
        (CARDAN, 3, 1, 3, 0),
        (GEARS, 4, 1, 5, 3),
        (RACK, 4, 1, 5, 4),
    ] {
        let model = testing::read(text);
        let mechanism = &model.mechanism;
        assert_eq!((model.dialect, mechanism.joints().len()), (Dialect::Asmt, joints));
        assert_eq!((mechanism.links().len(), mechanism.couplings().len()), (links, couplings));
        assert_eq!(mechanism.joints().iter().filter(|j| j.actuated).count(), actuated);
        let start = guess(mechanism);
        let closed = assemble(mechanism, &start, &[], 0).unwrap();
        assert!((closed.coordinates - start).amax() < 1e-9);
    }
}

/// Poses that the solver of FreeCAD finds along the motion, see `asmt_reference.py`.
#[test]
fn parts_move_as_in_the_solver_of_freecad() {
    let rows = include_str!("../../../validation/golden/asmt-poses.csv");
    let models = [
        ("slider-crank", SLIDER_CRANK),
        ("flipped-four-bar", FLIPPED),
        ("cardan", CARDAN),
        ("gear-train", GEARS),
        ("rack-and-screw", RACK),
    ];
    let mut compared = 0;
    for row in rows.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let [model, angle, part, x, y, z] = cells[..] else { panic!("{row}") };
        let text = models.iter().find(|(name, _)| *name == model).unwrap().1;
        let mechanism = testing::read(text).mechanism;
        let kinematics = Kinematics::new(&mechanism);
        let crank = mechanism.joints().iter().position(|j| j.actuated).unwrap();
        let k = kinematics.coordinates_of(crank).start;
        let mut start = guess(&mechanism);
        let target = start[k] + angle.parse::<f64>().unwrap();
        // In small steps, which stay on the branch.
        let steps = 40;
        let first = start[k];
        for step in 1..=steps {
            start[k] = first + (target - first) * f64::from(step) / f64::from(steps);
            start = assemble(&mechanism, &start, &[k], 0).unwrap().coordinates;
        }
        let poses = kinematics.link_poses(&start).unwrap();
        let link = mechanism.links().iter().position(|link| link == part).unwrap();
        let expected = [x, y, z].map(|text| text.parse::<f64>().unwrap());
        let difference = poses[link].translation.vector - Vector3::from(expected);
        assert!(difference.amax() < 1e-6, "{row}: {difference}");
        compared += 1;
    }
    assert!(compared >= 36);
}

#[test]
fn lengths_are_in_the_unit_asked_for() {
    let length = |text: Result<Imported, Error>| {
        let model = text.unwrap();
        model.mechanism.joints().iter().map(|j| j.frames[0].translation.vector.norm()).sum()
    };
    let m: f64 = length(parse_with_unit(SLIDER_CRANK, LengthUnit::Meter));
    let mm: f64 = length(parse_with_unit(SLIDER_CRANK, LengthUnit::Millimeter));
    assert!((m / mm - 1000.0).abs() < 1e-9);
}

/// Limits and a motion as FreeCAD writes them: by their markers, with an empty `MotionJoint`.
fn with_limits(limits: &[(&str, [&str; 2], &str, &str)]) -> String {
    let mut block = "\t\tLimits\n".to_owned();
    for (number, (kind, [first, second], value, comparison)) in limits.iter().enumerate() {
        block += &format!(
            "\t\t\t{kind}\n\t\t\t\tName\n\t\t\t\t\tl{number}\n\
            \t\t\t\tMarkerI\n\t\t\t\t\t/slider-crank/{first}\n\t\t\t\tMarkerJ\n\t\t\t\t\t/slider-crank/{second}\n\
            \t\t\t\tMotionJoint\n\t\t\t\t\t\n\t\t\t\tLimit\n\t\t\t\t\t{value}\n\
            \t\t\t\tType\n\t\t\t\t\t{comparison}\n\t\t\t\tTol\n\t\t\t\t\t1.0e-9\n"
        );
    }
    let general = "\t\tGeneralConstraintSets";
    assert!(SLIDER_CRANK.contains(general));
    SLIDER_CRANK.replacen(general, &(block + general), 1)
}

const DRIVE: [&str; 2] = ["pivot", "crank/hub"];
const GUIDE: [&str; 2] = ["guide", "slider/guided"];

#[test]
fn limits_of_joints_are_read_from_their_markers() {
    let text = with_limits(&[
        ("RotationLimit", DRIVE, "-30.000000*pi/180.0", "=>"),
        ("RotationLimit", DRIVE, "120.000000*pi/180.0", "=<"),
        ("TranslationLimit", GUIDE, "200.000000", "=>"),
        ("TranslationLimit", GUIDE, "400.000000", "=<"),
    ]);
    let model = parse_with_unit(&text, LengthUnit::Millimeter).unwrap();
    let limits = |name: &str| {
        let joints = model.mechanism.joints();
        joints.iter().find(|joint| joint.name == name).unwrap().limits.clone()
    };
    let close = |found: &[[f64; 2]], expected: [f64; 2]| {
        assert_eq!(found.len(), 1);
        assert!((found[0][0] - expected[0]).abs() + (found[0][1] - expected[1]).abs() < 1e-12);
    };
    close(&limits("drive"), [-30_f64.to_radians(), 120_f64.to_radians()]);
    close(&limits("guide"), [0.2, 0.4]);
    assert_eq!(limits("tip"), Vec::<[f64; 2]>::new());
    let one = with_limits(&[("RotationLimit", DRIVE, "1", "=>")]);
    let model = parse_with_unit(&one, LengthUnit::Millimeter).unwrap();
    assert_eq!(model.mechanism.joints()[0].limits, [[1.0, f64::INFINITY]]);
    assert_eq!(model.ignored, ["3 × PrincipalMassMarker"]);
}

#[test]
fn limits_without_a_counterpart_are_listed() {
    for (limit, listed) in [
        (("RotationLimit", DRIVE, "sin(time)", "=>"), "RotationLimit that is not a number"),
        (("TranslationLimit", DRIVE, "1", "=<"), "limit of joint \"drive\", which has no such"),
        (("RotationLimit", [DRIVE[1], DRIVE[0]], "1", "=<"), "of two markers without a joint"),
    ] {
        let ignored = testing::read(&with_limits(&[limit])).ignored;
        assert!(ignored.iter().any(|one| one.contains(listed)), "{ignored:?}");
    }
    let reversed =
        with_limits(&[("RotationLimit", DRIVE, "1", "=>"), ("RotationLimit", DRIVE, "0.5", "=<")]);
    testing::refuse(&reversed, "", "", "RevoluteJoint", "the limits of \"drive\" are reversed");
    let unknown = with_limits(&[("RotationLimit", DRIVE, "1", ">=")]);
    testing::refuse(&unknown, "", "", ">=", "has to be \"=>\" or \"=<\"");
}

#[test]
fn motions_of_freecad_name_their_markers() {
    let by_path = "\t\t\t\tMotionJoint\n\t\t\t\t\t/slider-crank/drive\n";
    let by_markers = "\t\t\t\tMarkerI\n\t\t\t\t\t/slider-crank/pivot\n\
        \t\t\t\tMarkerJ\n\t\t\t\t\t/slider-crank/crank/hub\n\t\t\t\tMotionJoint\n\t\t\t\t\t\n";
    assert!(SLIDER_CRANK.contains(by_path));
    let model = testing::read(&SLIDER_CRANK.replacen(by_path, by_markers, 1));
    assert_eq!(model.mechanism, testing::read(SLIDER_CRANK).mechanism);
    let elsewhere = by_markers.replace("pivot", "guide");
    let text = SLIDER_CRANK.replacen(by_path, &elsewhere, 1);
    testing::refuse(&text, "", "", "RotationalMotion", "only motions of joints are imported");
}

#[test]
fn gears_racks_and_screws_of_other_axes_are_refused() {
    let gears = |from, to, blamed, message| testing::refuse(GEARS, from, to, blamed, message);
    let rack = |from, to, blamed, message| testing::refuse(RACK, from, to, blamed, message);
    gears("radiusJ\n\t\t\t\t\t0.2", "radiusJ\n\t\t\t\t\t0.0", "GearJoint", "other than 0");
    gears("radiusJ\n\t\t\t\t\t0.2", "radiusJ\n\t\t\t\t\tx", "x", "a number");
    gears("radiusI", "RadiusI", "GearJoint", "needs `radiusI`");
    let turning = "must turn about z of its frames";
    gears(
        "RevoluteJoint\n\t\t\t\tName\n\t\t\t\t\tbevel",
        "SphericalJoint\n\t\t\t\tName\n\t\t\t\t\tbevel",
        "GearJoint",
        turning,
    );
    let sliding = "one of its parts must slide on a slider joint";
    rack(
        "TranslationalJoint\n\t\t\t\tName\n\t\t\t\t\tslide",
        "CylindricalJoint\n\t\t\t\tName\n\t\t\t\t\tslide",
        "RackPinionJoint",
        sliding,
    );
    let advancing = "one cylindrical joint between them";
    rack(
        "TranslationalJoint\n\t\t\t\tName\n\t\t\t\t\tlift",
        "PlanarJoint\n\t\t\t\tName\n\t\t\t\t\tlift",
        "ScrewJoint",
        advancing,
    );
    rack("pitch\n\t\t\t\t\t0.4", "pitch\n\t\t\t\t\t0.0", "ScrewJoint", "other than 0");
}

#[test]
fn joints_without_names_and_joints_of_a_part_with_itself() {
    let nameless =
        SLIDER_CRANK.replacen("\t\t\t\t\ttip\n\t\t\t\tMarkerI", "\t\t\t\t\t\n\t\t\t\tMarkerI", 1);
    assert_ne!(nameless, SLIDER_CRANK);
    let model = testing::read(&nameless);
    let names: Vec<&str> = model.mechanism.joints().iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["drive", "RevoluteJoint 2", "pin", "guide"]);
    let general = SLIDER_CRANK.replacen("RotationalMotion", "GeneralMotion", 1);
    let read = testing::read(&general);
    assert!(read.ignored.contains(&"1 × GeneralMotion".to_owned()), "{:?}", read.ignored);
    assert!(read.mechanism.actuated_coordinates().is_empty());
    let own = "\t\t\tFixedJoint\n\t\t\t\tName\n\t\t\t\t\tself\n\t\t\t\tMarkerI\n\t\t\t\t\t/slider-crank/pivot\n\t\t\t\tMarkerJ\n\t\t\t\t\t/slider-crank/guide\n";
    let motions = "\t\tMotions\n";
    assert!(SLIDER_CRANK.contains(motions));
    let read = testing::read(&SLIDER_CRANK.replacen(motions, &(own.to_owned() + motions), 1));
    let listed = "1 × joint \"self\" of a part with itself".to_owned();
    assert!(read.ignored.contains(&listed), "{:?}", read.ignored);
    assert_eq!(read.mechanism, testing::read(SLIDER_CRANK).mechanism);
}

#[test]
fn an_offset_of_a_plane_is_kept() {
    let planar = SLIDER_CRANK.replacen("SphericalJoint", "PlanarJoint", 1);
    let end = "/slider-crank/slider/pin\n";
    let with_offset = planar.replacen(end, &format!("{end}\t\t\t\toffset\n\t\t\t\t\t0.25\n"), 1);
    assert_ne!(planar, with_offset);
    let [flat, raised] = [planar, with_offset].map(|text| {
        let joints = testing::read(&text).mechanism.joints().to_vec();
        joints.iter().find(|joint| joint.name == "pin").unwrap().frames[0]
    });
    let shift = (flat.inverse() * raised).translation.vector;
    assert!((shift - Vector3::new(0.0, 0.0, 0.25)).amax() < 1e-12, "{shift}");
}

#[test]
fn what_would_change_the_mechanism_is_refused() {
    let refuse = |from: &str, to: &str, blamed: &str, message: &str| {
        testing::refuse(SLIDER_CRANK, from, to, blamed, message);
    };
    refuse("RevoluteJoint", "NoRotationJoint", "NoRotationJoint", "imported are Angle");
    // Also where its markers are unknown: curves and surfaces of a cam have no markers.
    let pivot = "RevoluteJoint\n\t\t\t\tName\n\t\t\t\t\tdrive\n\t\t\t\tMarkerI\n\t\t\t\t\t/slider-crank/pivot";
    let cam = pivot.replace("RevoluteJoint", "PointCurveJoint").replace("pivot", "curve");
    refuse(pivot, &cam, "PointCurveJoint", "joint \"PointCurveJoint\" cannot be imported");
    refuse("RevoluteJoint", "GearJoint", "GearJoint", "needs `radiusI`");
    refuse(
        "/slider-crank/crank/tip",
        "/slider-crank/crank/tap",
        "/slider-crank/crank/tap",
        "did you mean",
    );
    refuse("RotationalMotion", "AllowRotation", "AllowRotation", "motion \"AllowRotation\"");
    refuse("0.1\t0.0\t0.0", "0.1\tx\t0.0", "0.1\tx\t0.0", "3 numbers");
}

#[test]
fn truncated_assemblies_do_not_panic() {
    for cut in (0..SLIDER_CRANK.len()).step_by(7) {
        for text in [&SLIDER_CRANK[..cut], &SLIDER_CRANK[cut..]] {
            let text = format!("{}\n{text}", "OndselSolver");
            if let Err(error) = parse_with_unit(&text, LengthUnit::Meter) {
                let _ = error.with_excerpt("x");
            }
        }
    }
}
