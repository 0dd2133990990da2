//! Assemblies of FreeCAD: the document and the export of one assembly, written by FreeCAD.

use std::io::Cursor;

use jointplay_core::mechanism::{JointKind, Kinematics, Mechanism, assemble, guess};
use jointplay_format::mechanism::LengthUnit;
use jointplay_interop::import::{
    Dialect, Imported, document_text, is_archive, is_assembly, is_model, parse, parse_with_unit,
};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

const DOCUMENT: &[u8] = include_bytes!("../../../validation/golden/models/crank-press.FCStd");
const EXPORT: &str = include_str!("../../../validation/golden/models/crank-press.asmt");

fn text() -> String {
    assert!(is_archive(DOCUMENT));
    document_text(Cursor::new(DOCUMENT)).expect("the document is an archive of FreeCAD")
}

fn read(text: &str) -> Imported {
    parse(text)
        .map_err(|error| error.with_excerpt("Document.xml"))
        .unwrap_or_else(|m| panic!("{m}"))
}

#[test]
fn document_and_export_of_an_assembly_are_the_same_mechanism() {
    let text = text();
    assert!(is_model(&text) && !is_assembly(&text));
    let (document, export) =
        (read(&text), parse_with_unit(EXPORT, LengthUnit::Millimeter).unwrap());
    assert_eq!((document.dialect, export.dialect), (Dialect::FcStd, Dialect::Asmt));
    let (a, b) = (&document.mechanism, &export.mechanism);
    assert_eq!((a.name(), a.links()), (b.name(), b.links()));
    assert_eq!(a.links(), ["crank press", "frame", "crank ø6", "rod", "carriage"]);
    assert_eq!(a.joints().len(), b.joints().len());
    for (a, b) in a.joints().iter().zip(b.joints()) {
        assert_eq!((&a.name, a.kind, a.links), (&b.name, b.kind, b.links));
        assert_eq!(a.actuated, b.actuated, "{}", a.name);
        for (a, b) in a.frames.iter().zip(&b.frames) {
            let difference = a.to_homogeneous() - b.to_homogeneous();
            assert!(difference.amax() < 1e-12, "{difference}");
        }
        let numbers = |joint: &jointplay_core::mechanism::Joint| {
            let limits = joint.limits.iter().flatten();
            joint.guess.iter().chain(limits).copied().collect::<Vec<f64>>()
        };
        let (a, b) = (numbers(a), numbers(b));
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            assert!(a == b || (a - b).abs() < 1e-12, "{a} {b}");
        }
    }
    // What a file has and the other does not.
    let own = |model: &Imported| {
        let other = if model.dialect == Dialect::Asmt { &document } else { &export };
        model.ignored.iter().filter(|one| !other.ignored.contains(one)).cloned().collect::<Vec<_>>()
    };
    assert_eq!(own(&export), Vec::<String>::new());
    assert_eq!(
        own(&document),
        ["1 × part \"spare\", which has no joints", "1 × suppressed joint \"old guide\""]
    );
}

/// Against the drawing, of which neither reader knows: crank 30 mm, rod 90 mm.
#[test]
fn the_assembly_is_closed_as_drawn_and_moves_as_a_slider_crank() {
    let model = read(&text());
    let mechanism = &model.mechanism;
    let kinematics = Kinematics::new(mechanism);
    let start = guess(mechanism);
    let closed = assemble(mechanism, &start, &[], 0).unwrap().coordinates;
    assert!((&closed - &start).amax() < 1e-12);
    let number = |name: &str| mechanism.joints().iter().position(|j| j.name == name).unwrap();
    let drive = number("drive");
    assert!(mechanism.joints()[drive].actuated);
    assert_eq!(mechanism.joints()[number("eye")].kind, JointKind::Cylindrical);
    let [limits] = mechanism.joints()[number("pin")].limits[..] else { panic!("one pair") };
    assert_eq!(limits.iter().filter(|end| end.is_finite()).count(), 1, "{limits:?}");
    let (k, slide) =
        (kinematics.coordinates_of(drive).start, kinematics.coordinates_of(number("slide")).start);
    let reach =
        |angle: f64| 0.03 * angle.cos() + (0.09_f64.powi(2) - (0.03 * angle.sin()).powi(2)).sqrt();
    let mut at = closed.clone();
    for step in 1..=40 {
        let turned = 0.05 * f64::from(step);
        at[k] = closed[k] + turned;
        at = assemble(mechanism, &at, &[k], 0).unwrap().coordinates;
        let expected = reach(0.7 + turned) - reach(0.7);
        assert!((at[slide] - closed[slide] - expected).abs() < 1e-11);
    }
}

#[track_caller]
fn refuse(from: &str, to: &str, message: &str) {
    let text = text();
    assert!(text.contains(from), "{from:?} is not in the document");
    let error = parse(&text.replace(from, to)).expect_err("the document is refused");
    assert!(error.to_string().contains(message), "{error}");
    let _ = error.with_excerpt("Document.xml");
}

#[test]
fn documents_that_would_be_another_mechanism_are_refused() {
    // Revolute joints as others, by their numbers.
    let number = |k: usize| format!("<Integer value=\"{k}\" CustomEnum=\"true\"/>");
    refuse(&number(1), &number(5), "of type \"Distance\" to \"Face");
    refuse(&number(1), &number(9), "one of its parts must slide on a slider joint");
    refuse(&number(1), &number(10), "its parts need one cylindrical joint between them");
    for k in [11, 12] {
        refuse(&number(1), &number(k), "`Joint` needs `Distance2`");
    }
    refuse(&number(1), &number(13), "the number of a choice");
    refuse(&number(1), "<Integer value=\"-1\"/>", "the number of a choice");
    refuse("Assembly::AssemblyObject", "App::Part", "without an assembly of FreeCAD 1.0");
    refuse(
        "App::PropertyBool\" group=\"Joint\" doc=\"\" attr=\"0\" ro=\"0\" hide=\"0\" status=\"2097152\">\n                    <Bool value=\"true\"",
        "App::PropertyBool\">\n<Bool value=\"maybe\"",
        "true or false",
    );
    refuse("Crank.Face3", "Krank.Face3", "without object \"Krank\"");
    refuse("Crank.Face3", "Face3", "the parts of joints are in the assembly");
    refuse("Crank.Face3", "Frame.Face3", "joins link \"frame\" to itself");
    refuse(
        "<XLink file=\"\" stamp=\"\" name=\"Column\"/>",
        "<XLink file=\"other.FCStd\" name=\"Column\"/>",
        "in a part of another file",
    );
    refuse(
        "<XLink file=\"\" stamp=\"\" name=\"Assembly\" count",
        "<XLink file=\"other.FCStd\" name=\"Assembly\" count",
        "a reference to the file \"other.FCStd\"",
    );
    refuse("Q3=\"", "Q3=\"x", "has to be a number");
    refuse("<Object name=\"Crank\"", "<Object", "`Object` needs `name`");
    refuse("<Float value=\"-170.0000000000000000\"/>", "", "`Joint` needs `AngleMin`");
    refuse("name=\"Reference2\"", "name=\"Reference3\"", "`Joint` needs `Reference2`");
}

#[test]
fn flexible_sub_assemblies_and_several_assemblies_are_refused() {
    let text = text();
    let rigid = text.find("name=\"Rigid\"").unwrap();
    let flexible = text[..rigid].to_owned() + &text[rigid..].replacen("true", "false", 1);
    let error = parse(&flexible).unwrap_err().to_string();
    assert!(error.contains("the flexible sub-assembly \"Carriage\""), "{error}");
    let second = "<Object type=\"Assembly::AssemblyObject\" name=\"Other\" id=\"99999\"/>";
    let objects = text.find("<Object type=").unwrap();
    let two = format!("{}{second}{}", &text[..objects], &text[objects..]);
    let error = parse(&two).unwrap_err().to_string();
    assert!(error.contains("the assemblies \"Other\" and \"Assembly\""), "{error}");
    let twice = format!("{}{second}{second}{}", &text[..objects], &text[objects..]);
    assert!(parse(&twice).unwrap_err().to_string().contains("a second object \"Other\""));
}

#[test]
fn parts_without_labels_or_with_equal_ones_have_their_names_in_the_file() {
    let text = text();
    let unnamed = text.replace("<String value=\"rod\"/>", "<String value=\"\"/>");
    assert_eq!(read(&unnamed).mechanism.links()[3], "Rod");
    let equal = text.replace("<String value=\"rod\"/>", "<String value=\"frame\"/>");
    assert_eq!(read(&equal).mechanism.links()[3], "frame (Rod)");
    let equal = text.replace("<String value=\"eye\"/>", "<String value=\"pin\"/>");
    let joints = read(&equal).mechanism.joints()[3].name.clone();
    assert!(joints.starts_with("pin (Joint"), "{joints}");
}

#[test]
fn entities_deep_elements_and_groups_in_themselves_are_refused_or_end() {
    let bomb = "<?xml version='1.0'?><!DOCTYPE d [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;\">]><Document>&b;</Document>";
    assert!(parse(bomb).unwrap_err().to_string().contains("remove `<!DOCTYPE"));
    let deep = format!("<Document>{}{}</Document>", "<a>".repeat(5000), "</a>".repeat(5000));
    assert!(parse(&deep).unwrap_err().to_string().contains("more than 1000 deep"));
    // The group of the joints contains itself.
    let text = text();
    let circle =
        text.replace("<LinkList count=\"6\">", "<LinkList count=\"7\"><Link value=\"Joints\"/>");
    assert_ne!(circle, text);
    assert_eq!(read(&circle).mechanism, read(&text).mechanism);
    let long = format!("<Document>{}</Document>", " ".repeat(32_000_000));
    assert!(parse(&long).unwrap_err().to_string().contains("at most 32000000 are allowed"));
    assert!(parse("<Document/>").unwrap_err().to_string().contains("without an assembly"));
}

#[test]
fn truncated_and_mutated_documents_do_not_panic() {
    let text = text();
    let start = text.find("<ObjectData").unwrap();
    for (number, cut) in (start..text.len()).step_by(997).enumerate() {
        let (Some(before), Some(after)) = (text.get(..cut), text.get(cut + 40 * (number % 3)..))
        else {
            continue;
        };
        for changed in
            [before.to_owned(), format!("{before}{after}"), format!("{before}\"/>{after}")]
        {
            if let Err(error) = parse(&changed) {
                let _ = error.with_excerpt("Document.xml");
            }
        }
    }
}

/// A rack that slides along x, and a pinion about z next to it, in millimetres; the joint between them names either first.
fn rack_and_pinion(is_rack_first: bool) -> String {
    let property =
        |name: &str, value: &str| format!("<Property name=\"{name}\">{value}</Property>");
    let label = |name: &str| property("Label", &format!("<String value=\"{name}\"/>"));
    let placed = |name: &str, [x, y]: [f64; 2], [q0, q1, q2, q3]: [f64; 4]| {
        let place = format!(
            "Px=\"{x}\" Py=\"{y}\" Pz=\"0\" Q0=\"{q0}\" Q1=\"{q1}\" Q2=\"{q2}\" Q3=\"{q3}\""
        );
        property(name, &format!("<PropertyPlacement {place}/>"))
    };
    let level = [0.0, 0.0, 0.0, 1.0];
    // z along x.
    let along_x = [0.0, 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()];
    let joint = |kind: usize, ends: [(&str, [f64; 2], [f64; 4]); 2]| {
        let mut text = property("JointType", &format!("<Integer value=\"{kind}\"/>"));
        for (k, (part, at, turn)) in ends.into_iter().enumerate() {
            let link =
                format!("<XLink file=\"\" name=\"Assembly\"><Sub value=\"{part}.Face1\"/></XLink>");
            text += &property(&format!("Reference{}", k + 1), &link);
            text += &placed(&format!("Placement{}", k + 1), at, turn);
        }
        let off = "<Bool value=\"false\"/>";
        for name in ["EnableLengthMin", "EnableLengthMax", "EnableAngleMin", "EnableAngleMax"] {
            text += &property(name, off);
        }
        text + &property("Distance", "<Float value=\"20\"/>")
    };
    let group = |names: &[&str]| {
        let links: String = names.iter().map(|name| format!("<Link value=\"{name}\"/>")).collect();
        property("Group", &format!("<LinkList>{links}</LinkList>"))
    };
    let mut ends = [("Rack", [30.0, 0.0], along_x), ("Pinion", [0.0, 0.0], level)];
    if !is_rack_first {
        ends.reverse();
    }
    let part = |name: &str, at| label(name) + &placed("Placement", at, level);
    let objects = [
        (
            "Assembly",
            "Assembly::AssemblyObject",
            label("drive") + &group(&["Joints", "Base", "Rack", "Pinion"]),
        ),
        ("Joints", "Assembly::JointGroup", group(&["Ground", "Slide", "Axle", "Teeth"])),
        ("Base", "Part::Box", part("base", [0.0, 0.0])),
        ("Rack", "Part::Box", part("rack", [10.0, -20.0])),
        ("Pinion", "Part::Box", part("pinion", [50.0, 0.0])),
        (
            "Ground",
            "App::FeaturePython",
            label("ground") + &property("ObjectToGround", "<Link value=\"Base\"/>"),
        ),
        ("Teeth", "App::FeaturePython", label("teeth") + &joint(9, ends)),
        (
            "Slide",
            "App::FeaturePython",
            label("slide")
                + &joint(3, [("Base", [10.0, -20.0], along_x), ("Rack", [0.0, 0.0], along_x)]),
        ),
        (
            "Axle",
            "App::FeaturePython",
            label("axle")
                + &joint(1, [("Base", [50.0, 0.0], level), ("Pinion", [0.0, 0.0], level)]),
        ),
    ];
    let declared: String = objects
        .iter()
        .map(|(name, kind, _)| format!("<Object type=\"{kind}\" name=\"{name}\"/>"))
        .collect();
    let data: String = objects
        .iter()
        .map(|(name, _, all)| {
            format!("<Object name=\"{name}\"><Properties>{all}</Properties></Object>")
        })
        .collect();
    format!("<Document><Objects>{declared}</Objects><ObjectData>{data}</ObjectData></Document>")
}

#[test]
fn a_rack_moves_by_the_radius_of_its_pinion() {
    for is_rack_first in [true, false] {
        let model = read(&rack_and_pinion(is_rack_first));
        let [coupling] = model.mechanism.couplings() else { panic!("{model:?}") };
        assert_eq!(coupling.name, "teeth");
        let mechanism = &model.mechanism;
        let index = |name: &str| {
            Kinematics::new(mechanism).coordinates_of(mechanism.joint(name).unwrap()).start
        };
        let mut at = guess(mechanism);
        at[index("axle")] += 0.5;
        let closed = assemble(mechanism, &at, &[index("axle")], 10).unwrap().coordinates;
        let slid = closed[index("slide")] - guess(mechanism)[index("slide")];
        assert!((slid - 0.01).abs() < 1e-12, "{is_rack_first}: {slid}");
    }
}

/// Written by FreeCAD 1.0.0 of Debian 13, see `validation/golden/freecad_assemblies.py`.
const CRANK: &[u8] = include_bytes!("../../../validation/golden/models/freecad-crank.FCStd");
const CRANK_EXPORT: &str = include_str!("../../../validation/golden/models/freecad-crank.asmt");
const CONSTRAINTS: &str =
    include_str!("../../../validation/golden/models/freecad-constraints.asmt");
/// Poses of parts that the solver of FreeCAD finds, with the crank held at some angles.
const CRANK_POSES: &str = include_str!("../../../validation/golden/freecad-crank-poses.csv");

fn crank() -> Imported {
    read(&document_text(Cursor::new(CRANK)).expect("the document is an archive of FreeCAD"))
}

fn freedoms(mechanism: &Mechanism) -> usize {
    mechanism.joints().iter().map(|joint| joint.kind.freedoms()).sum()
}

#[test]
fn a_document_of_freecad_1_moves_as_its_solver_moves_it() {
    let Imported { mechanism, ignored, .. } = crank();
    assert_eq!(mechanism.joints()[1].name, "drive");
    assert_eq!(mechanism.joints()[1].limits[0][1], f64::INFINITY);
    assert_eq!(ignored, ["1 × opposite direction of an axis"; 0]);
    // A rod with a ball at one end and a universal joint at the other is a distance of two points.
    let kinds = |name: &str| {
        let joints = mechanism.joints().iter().filter(|joint| joint.name.starts_with(name));
        joints.map(|joint| joint.kind).collect::<Vec<_>>()
    };
    assert_eq!(kinds("wire"), [JointKind::Universal, JointKind::Spherical]);
    assert_eq!(kinds("square").len(), 4);
    assert_eq!(kinds("tilt").len(), 5);
    let kinematics = Kinematics::new(&mechanism);
    let start = assemble(&mechanism, &guess(&mechanism), &[], 0).unwrap().coordinates;
    assert!((&start - guess(&mechanism)).amax() < 1e-8, "{}", &start - guess(&mechanism));
    let drive = kinematics.coordinates_of(1).start;
    let mut compared = 0;
    let mut at = start.clone();
    for row in CRANK_POSES.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |k: usize| cells[k].parse::<f64>().unwrap();
        let target = start[drive] + number(0);
        if (at[drive] - target).abs() > 1e-12 {
            at[drive] = target;
            at = assemble(&mechanism, &at, &[drive], 0).unwrap().coordinates;
        }
        let link = mechanism.links().iter().position(|link| link == cells[1]).unwrap();
        let pose = kinematics.link_poses(&at).unwrap()[link];
        let place = Vector3::new(number(2), number(3), number(4)) * 1e-3;
        assert!((pose.translation.vector - place).amax() < 1e-8, "{row}: {pose}");
        let turn = Quaternion::new(number(8), number(5), number(6), number(7));
        let turn = UnitQuaternion::from_quaternion(turn).to_rotation_matrix();
        // The spin of the rod about its own axis follows from the cylindrical joint.
        assert!((pose.rotation.matrix() - turn.matrix()).amax() < 1e-7, "{row}: {pose}");
        compared += 1;
    }
    assert_eq!(compared, 36);
}

/// FreeCAD 1.0 of Linux writes names of joints without their first four letters and with an `E` at the end.
#[test]
fn an_export_with_cut_names_of_joints_is_the_document() {
    assert!(CRANK_EXPORT.contains("\tluteJointE") && !CRANK_EXPORT.contains("RevoluteJoint"));
    // The cut name of a distance of two points is also that of a point and a line.
    let error = parse_with_unit(CRANK_EXPORT, LengthUnit::Millimeter).unwrap_err().to_string();
    assert!(error.contains("CylSphJoint or SphSphJoint") && error.contains(".FCStd"), "{error}");
    let export = CRANK_EXPORT.replace("phJointE", "SphSphJoint");
    let export = parse_with_unit(&export, LengthUnit::Millimeter).unwrap().mechanism;
    let document = crank().mechanism;
    assert_eq!(export.joints().len(), document.joints().len());
    for (one, other) in export.joints().iter().zip(document.joints()) {
        assert_eq!(one.kind, other.kind);
        assert_eq!(one.links, other.links);
        assert_eq!(one.limits.len(), other.limits.len());
        for (one, other) in one.frames.iter().zip(&other.frames) {
            assert!((one.to_homogeneous() - other.to_homogeneous()).amax() < 1e-9);
        }
    }
}

#[test]
fn each_constraint_of_freecad_leaves_its_freedoms_and_is_closed_as_solved() {
    let text = CONSTRAINTS.replace("phJointE", "CylSphJoint");
    let mechanism = parse_with_unit(&text, LengthUnit::Millimeter).unwrap().mechanism;
    // A point in a plane 5, a point near a line 5, parallel lines 3, a line in a plane 4, parallel planes 3, parallel axes 4, perpendicular axes 5, axes at an angle 5.
    assert_eq!(freedoms(&mechanism), 5 + 5 + 3 + 4 + 3 + 4 + 5 + 5);
    // There is no loop that could correct the start: the parts are where the solver had them.
    let poses = Kinematics::new(&mechanism).link_poses(&guess(&mechanism)).unwrap();
    let drawn: Vec<Vector3<f64>> = CONSTRAINTS
        .split("\n\t\tPart\n")
        .skip(1)
        .map(|part| {
            let line = part.split("Position3D\n").nth(1).unwrap().lines().next().unwrap();
            let numbers: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
            Vector3::new(numbers[0], numbers[1], numbers[2]) * 1e-3
        })
        .collect();
    assert_eq!(drawn.len(), 9);
    for (link, drawn) in drawn.iter().enumerate() {
        // Link 0 is the assembly.
        let found = poses[link + 1].translation.vector;
        assert!((found - drawn).amax() < 1e-9, "{}: {found} {drawn}", mechanism.links()[link + 1]);
    }
}

#[test]
fn a_distance_of_other_elements_is_refused_in_a_document() {
    let text = document_text(Cursor::new(CRANK)).unwrap();
    assert!(text.contains("Box001.Vertex1\"/>"));
    let start = text.find("<String value=\"wire\"/>").unwrap();
    let face = text[..start].to_owned()
        + &text[start..].replacen("Box001.Vertex1\"/>", "Box001.Face2\"/>", 1);
    let error = parse(&face).unwrap_err().to_string();
    assert!(error.contains("joint \"wire\" of type \"Distance\" to \"Face2\""), "{error}");
    assert!(error.contains("depend on their shapes"), "{error}");
}
