//! Exports of mechanisms, read again by the readers of the same formats.

use jointplay_core::constraint::System as _;
use jointplay_core::linalg::svd;
use jointplay_core::mechanism::{
    Carrier, Joint, JointKind, Kinematics, LinearAndAngular, Mechanism, MechanismSystem,
    VirtualJoint, VirtualMotion, assemble, guess,
};
use jointplay_core::spatial::Pose;
use jointplay_format::catalogue;
use jointplay_format::mechanism;
use jointplay_format::mechanism::with_loops;
use jointplay_interop::export::mechanism::{Error, Written, mjcf, modelica, sdf, urdf};
use jointplay_interop::import::{Imported, parse, parse_closed};
use nalgebra::{DMatrix, DVector, Rotation3, Translation3, Unit, Vector3};
use proptest::prelude::*;

use crate::modelica_text;

type Write = fn(&Mechanism, &DVector<f64>) -> Result<Written, Error>;

const FORMATS: [(&str, Write); 4] =
    [("MJCF", mjcf), ("Modelica", modelica_package), ("SDF", sdf), ("URDF", urdf)];

fn modelica_package(mechanism: &Mechanism, at: &DVector<f64>) -> Result<Written, Error> {
    modelica(mechanism, at, "Package")
}

/// Reads the files of an export; what is read can be saved as a mechanism file.
fn read(written: &Written) -> Mechanism {
    let Written { text, loops, .. } = written;
    if text.starts_with("package ") {
        return modelica_text::read(text);
    }
    let imported = match loops {
        None => parse(text).map_err(|error| format!("{}\n{text}", error.with_excerpt("written"))),
        Some(loops) => {
            parse_closed(text, None, loops).map_err(|error| format!("{error}\n{text}\n{loops}"))
        }
    };
    saved(&imported.unwrap())
}

/// The mechanism that is read from a mechanism file of an imported model.
fn saved(imported: &Imported) -> Mechanism {
    let text = mechanism::write(&imported.mechanism, None);
    let found = mechanism::parse(&text).map_err(|errors| format!("{errors}\n{text}")).unwrap();
    // Numbers differ by round-off, and links are in the order of the joints.
    let named = |mechanism: &Mechanism| {
        let joint = |one: &Joint| {
            (one.name.clone(), one.kind, one.links.map(|link| mechanism.links()[link].clone()))
        };
        let joints = mechanism.joints().iter().map(joint);
        let couplings = mechanism.couplings().iter().map(|one| (one.name.clone(), one.follower));
        (joints.collect::<Vec<_>>(), couplings.collect::<Vec<_>>())
    };
    assert_eq!(named(&found.mechanism), named(&imported.mechanism));
    found.mechanism
}

/// Singular values of the constraints of joints and virtual joints together, and the number of coordinates.
fn constraints(mechanism: &Mechanism, at: &DVector<f64>) -> (DVector<f64>, usize) {
    let system = MechanismSystem::new(mechanism, at.clone()).unwrap();
    let home = system.at_home();
    let length = system.characteristic_length();
    let (of_joints, of_virtual) =
        (system.constraint_jacobian(&home), system.virtual_jacobian(&home));
    let mut all = DMatrix::zeros(of_joints.nrows(), of_joints.ncols() + of_virtual.ncols());
    all.columns_mut(0, of_joints.ncols()).copy_from(&of_joints);
    all.columns_mut(of_joints.ncols(), of_virtual.ncols()).copy_from(&of_virtual);
    for (mut row, unit) in all.row_iter_mut().zip(system.constraint_dimensions()) {
        row /= unit.unit(length);
    }
    let units = system.kinematics().dimensions().to_vec();
    for (mut column, unit) in all.column_iter_mut().zip(units) {
        column *= unit.unit(length);
    }
    let count = all.ncols();
    if all.is_empty() {
        (DVector::zeros(0), count)
    } else {
        (svd(&all).unwrap().singular_values, count)
    }
}

/// The rank, if no singular value is near the threshold.
fn rank(values: &DVector<f64>) -> Option<usize> {
    let largest = values.iter().copied().fold(0.0, f64::max).max(1e-3);
    let clear = values.iter().all(|value| !(1e-11..1e-6).contains(&(value / largest)));
    clear.then(|| values.iter().filter(|&&value| value > 1e-8 * largest).count())
}

/// Compares poses, mobility, rank and limits of a mechanism at a closed configuration with what an export of it is read as.
fn check(format: &str, original: &Mechanism, at: &DVector<f64>, written: &Written) -> Mechanism {
    let found = read(written);
    let start = guess(&found);
    let system = MechanismSystem::new(&found, start.clone()).unwrap();
    let residual = system.mismatch(&system.at_home());
    assert!(residual < 1e-9, "{format} {}: open by {residual}", original.name());
    let poses = Kinematics::new(original).link_poses(at).unwrap();
    let read_poses = Kinematics::new(&found).link_poses(&start).unwrap();
    for (name, pose) in original.links().iter().zip(&poses) {
        let link = found.link(name).unwrap_or_else(|| panic!("{format}: link {name:?} is lost"));
        let off = (read_poses[link].to_homogeneous() - pose.to_homogeneous()).amax();
        assert!(off < 1e-9, "{format} {}: link {name:?} is off by {off}", original.name());
    }
    for frame in original.frames().iter().filter(|_| format != "Modelica") {
        let pose = poses[frame.link] * frame.link_from_frame;
        let found = match found.frames().iter().find(|one| one.name == frame.name) {
            Some(one) => read_poses[one.link] * one.link_from_frame,
            None => {
                assert_eq!(format, "URDF", "frame {:?} is lost", frame.name);
                read_poses[found.link(&frame.name).unwrap()]
            }
        };
        let off = (found.to_homogeneous() - pose.to_homogeneous()).amax();
        assert!(off < 1e-9, "{format} {}: frame {:?} is off by {off}", original.name(), frame.name);
    }
    let ((before, columns), (after, read_columns)) =
        (constraints(original, at), constraints(&found, &start));
    if let (Some(before), Some(after)) = (rank(&before), rank(&after)) {
        let (mobility, read_mobility) = (columns - before, read_columns - after);
        assert_eq!(mobility, read_mobility, "{format} {}: mobility", original.name());
        assert_eq!(before, after, "{format} {}: rank", original.name());
    }
    assert_eq!(found.loops(), original.loops(), "{format} {}", original.name());
    let actuated = |mechanism: &Mechanism| mechanism.actuated_coordinates().len();
    let is_listed = written.lost.iter().any(|lost| lost.contains("actuator"));
    assert!(is_listed || actuated(&found) == actuated(original), "{format} {}", original.name());
    found
}

#[test]
fn every_mechanism_of_the_catalogue_is_read_again() {
    let mut count = 0;
    for entry in catalogue::entries() {
        let Ok(file) = mechanism::parse(entry.text) else { continue };
        let original = file.mechanism;
        let at = assemble(&original, &guess(&original), &[], 200).unwrap().coordinates;
        for (format, write) in FORMATS {
            let written = write(&original, &at).unwrap();
            let found = check(format, &original, &at, &written);
            moved(format, &original, &at, &found);
            assert_eq!(written, write(&original, &at).unwrap(), "the same bytes");
        }
        count += 1;
    }
    assert!(count > 20, "{count}");
}

/// Drives one actuated joint a little in both, where actuated joints determine everything, and compares the poses of the links.
fn moved(format: &str, original: &Mechanism, at: &DVector<f64>, found: &Mechanism) {
    let motors = original.actuated_coordinates();
    let (values, columns) = constraints(original, at);
    if !original.virtual_joints().is_empty()
        || motors.is_empty()
        || rank(&values).is_none_or(|rank| columns - rank != motors.len())
    {
        return;
    }
    let start = guess(found);
    let held = found.actuated_coordinates();
    assert_eq!(held.len(), motors.len(), "{format} {}", original.name());
    let step = 1e-3;
    let mut order: Vec<usize> = Vec::new();
    let names = |mechanism: &Mechanism| -> Vec<String> {
        let joints = mechanism.joints().iter().filter(|joint| joint.actuated);
        // Joints of SDF that have the name of a link get another one.
        joints.map(|joint| joint.name.trim_end_matches(" joint").to_owned()).collect()
    };
    let found_names = names(found);
    for name in names(original) {
        order.extend(found_names.iter().position(|one| *one == name));
    }
    if order.len() != motors.len() {
        return;
    }
    let (mut to, mut read_to) = (at.clone(), start);
    to[motors[0]] += step;
    read_to[held[order[0]]] += step;
    let (Ok(closed), Ok(read_closed)) =
        (assemble(original, &to, &motors, 0), assemble(found, &read_to, &held, 0))
    else {
        return;
    };
    let poses = Kinematics::new(original).link_poses(&closed.coordinates).unwrap();
    let read_poses = Kinematics::new(found).link_poses(&read_closed.coordinates).unwrap();
    for (name, pose) in original.links().iter().zip(&poses) {
        let off = read_poses[found.link(name).unwrap()].to_homogeneous() - pose.to_homogeneous();
        assert!(off.amax() < 1e-8, "{format} {}: {name:?} by {}", original.name(), off.amax());
    }
}

/// Joints and couplings whose names have a meaning in commands, as strangers write them.
#[test]
fn forbidden_names_of_joints_are_replaced_and_reported() {
    let mjcf = r#"<mujoco><worldbody><body name="a,b"><joint name="x,y"/><geom size="1"/>
        <body><joint name="x_y" type="slide"/><geom size="1"/></body></body></worldbody>
        <equality><joint name="pair[1]" joint1="x,y" joint2="x_y"/></equality>
        <actuator><motor joint="x,y"/></actuator></mujoco>"#;
    let sdf = r#"<sdf version="1.9"><model name="m"><link name="l"/>
        <joint name="j=1" type="revolute"><parent>world</parent><child>l</child>
        <axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"#;
    let urdf = r#"<robot name="r"><link name="a"/><link name="b"/>
        <joint name="j,=1 [0]" type="continuous"><parent link="a"/><child link="b"/></joint></robot>"#;
    let check = |text: &str, joints: &[&str], renamed: &[[&str; 2]]| {
        let imported = parse(text).map_err(|error| error.with_excerpt("model")).unwrap();
        let found = saved(&imported);
        let names: Vec<&str> = found.joints().iter().map(|joint| joint.name.as_str()).collect();
        assert_eq!(names, joints);
        for [old, new] in renamed {
            let is_named = |one: &&String| {
                one.contains(&format!("{old:?}")) && one.contains(&format!("{new:?}"))
            };
            assert_eq!(imported.ignored.iter().filter(is_named).count(), 1, "{imported:?}");
        }
        found
    };
    let found = check(mjcf, &["x_y (2)", "x_y"], &[["x,y", "x_y (2)"], ["pair[1]", "pair(1)"]]);
    assert!(found.joints()[0].actuated && found.link("a,b").is_some());
    assert_eq!(found.couplings()[0].name, "pair(1)");
    check(sdf, &["j_1"], &[["j=1", "j_1"]]);
    check(urdf, &["j__1 (0)"], &[["j,=1 [0]", "j__1 (0)"]]);
    // A file of loops names joints as the model does.
    let pair = r#"<robot name="pair"><link name="base"/><link name="left"/><link name="right"/>
        <joint name="a[0]" type="continuous"><parent link="base"/><child link="left"/></joint>
        <joint name="b" type="continuous"><parent link="base"/><child link="right"/></joint></robot>"#;
    let loops = "closures:\n  - { link_a: left, link_b: right, point: [1, 0, 0], axis: [0, 0, 1] }\nindependent: ['a[0]']\ndependent: [b]\n";
    let closed = parse_closed(pair, None, loops).unwrap();
    let joints = saved(&closed).joints().to_vec();
    assert!(joints[0].name == "a(0)" && joints[0].actuated && !joints[1].actuated);
}

/// Names of MuJoCo are unique among elements of a type.
#[test]
fn constraints_may_have_the_names_of_joints() {
    let model = |equality: &str| {
        format!(
            r#"<mujoco><worldbody>
            <body name="k"><joint name="k" axis="0 1 0"/><geom size="1"/>
              <body name="m" pos="1 0 0"><joint name="m" axis="0 1 0"/><geom size="1"/></body></body>
            </worldbody><equality>{equality}</equality></mujoco>"#
        )
    };
    let read = |equality: &str| parse(&model(equality));
    let names = |equality: &str| {
        let imported = read(equality).map_err(|error| error.with_excerpt("model")).unwrap();
        let found = saved(&imported);
        let joints = found.joints().iter().map(|one| one.name.clone());
        let couplings = found.couplings().iter().map(|one| one.name.clone());
        joints.chain(couplings).collect::<Vec<_>>()
    };
    assert_eq!(names(r#"<joint name="k" joint1="k" joint2="m"/>"#), ["k", "m", "k (2)"]);
    assert_eq!(names(r#"<joint name="own" joint1="k"/>"#), ["k", "m", "own"]);
    for closure in ["connect", "weld"] {
        let closure = format!("<{closure} name=\"m\" body1=\"m\" anchor=\"0 0 1\"/>");
        let fixed = r#"<joint name="k" joint1="k" polycoef="0"/>"#;
        assert_eq!(names(&format!("{closure}{fixed}")), ["k", "m", "m (2)", "k (2)"]);
        assert_eq!(names(&format!("{fixed}{closure}")), ["k", "m", "m (2)", "k (2)"]);
        // Two constraints of one name: MuJoCo refuses them, too.
        let twice = format!("{closure}<joint name=\"m\" joint1=\"k\"/>");
        let error = read(&twice).unwrap_err().with_excerpt("model");
        assert!(error.contains("\"m\" is used twice"), "{error}");
    }
}

fn kind() -> impl Strategy<Value = JointKind> {
    prop_oneof![
        3 => Just(JointKind::Revolute),
        2 => Just(JointKind::Prismatic),
        1 => Just(JointKind::Cylindrical),
        1 => Just(JointKind::Universal),
        3 => Just(JointKind::Spherical),
        1 => Just(JointKind::Planar),
        1 => Just(JointKind::Floating),
        1 => Just(JointKind::Fixed),
    ]
}

fn pose() -> impl Strategy<Value = Pose> {
    (prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-1.5..1.5_f64)).prop_map(
        |(point, turn)| {
            let turn = Rotation3::new(Vector3::from(turn));
            Pose::from_parts(Translation3::from(Vector3::from(point)), turn)
        },
    )
}

/// A random mechanism at a random closed configuration: the last joint frames are placed so that loops close.
fn random() -> impl Strategy<Value = (Mechanism, DVector<f64>)> {
    (3..6_usize).prop_flat_map(|links| {
        let joints = prop::collection::vec(
            (kind(), pose(), pose(), any::<bool>(), any::<bool>()),
            links + 1,
        );
        let ends = prop::collection::vec((0..links, 1..links), 2);
        let plays = prop::collection::vec(
            (0..links + 1, any::<bool>(), any::<bool>(), prop::array::uniform3(-1.0..1.0_f64)),
            0..4,
        );
        let values = prop::collection::vec(-0.4..0.4_f64, 60);
        (Just(links), joints, ends, plays, values).prop_map(
            |(links, joints, ends, plays, values)| {
                let extra = ends.iter().map(|&(a, step)| [a, (a + step) % links]);
                let all = (1..links).map(|k| [k - 1, k]).chain(extra);
                let made = all.zip(joints).enumerate().map(|(k, (ends, made))| {
                    let (kind, first, second, turned, actuated) = made;
                    Joint {
                        name: format!("j {k}"),
                        kind,
                        links: if turned { [ends[1], ends[0]] } else { ends },
                        frames: [first, second],
                        actuated: actuated && kind.freedoms() > 0 && kind != JointKind::Spherical,
                        guess: Vec::new(),
                        limits: Vec::new(),
                        clearance: LinearAndAngular::default(),
                        stiffness: LinearAndAngular::default(),
                    }
                });
                let mut joints: Vec<Joint> = made.collect();
                let names: Vec<String> =
                    (0..links).map(|k| format!("link <{k}> & \"co\"")).collect();
                let plays: Vec<VirtualJoint> = plays
                    .iter()
                    .enumerate()
                    .map(|(k, &(joint, second, turns, axis))| {
                        let axis = Vector3::from(axis) + Vector3::new(0.0, 0.0, 2.0);
                        let axis = Unit::new_normalize(axis);
                        let point = Vector3::new(0.1, -0.2, 0.3);
                        VirtualJoint {
                            name: format!("play {k}"),
                            joint,
                            carrier: if second { Carrier::Second } else { Carrier::First },
                            motion: if turns {
                                VirtualMotion::Turn { axis, point }
                            } else {
                                VirtualMotion::Slide(axis)
                            },
                            clearance: (k % 2 == 0).then_some(1.0),
                            stiffness: None,
                        }
                    })
                    .collect();
                let built = |joints: &[Joint]| {
                    Mechanism::new("random <&>", names.clone(), joints.to_vec())
                        .unwrap()
                        .with_virtual_joints(plays.clone())
                        .unwrap()
                };
                let first = built(&joints);
                let count = first.joint_freedoms() + plays.len();
                let at = DVector::from_iterator(count, values.into_iter().take(count));
                // Each joint beyond the tree gets the frame on its second link that closes its loop.
                let kinematics = Kinematics::new(&first);
                let poses = kinematics.link_poses(&at).unwrap();
                for &joint in kinematics.closing_joints() {
                    let [a, b] = first.joints()[joint].links;
                    let chain = kinematics.elementary_chain(joint);
                    let open = poses[a] * chain.transform(at.as_slice());
                    // The frame on the first link takes up the mismatch, before all motions but those of its virtual joints.
                    let on_first =
                        |one: &&VirtualJoint| one.joint == joint && one.carrier == Carrier::First;
                    let before = plays.iter().filter(on_first).count();
                    let stacked =
                        chain.motions[..before].iter().fold(Pose::identity(), |pose, one| {
                            pose * one.before * one.transform(at.as_slice())
                        });
                    let inner = (poses[a] * stacked).inverse() * open;
                    let wanted = (poses[a] * stacked).inverse() * poses[b];
                    joints[joint].frames[0] = wanted * inner.inverse() * joints[joint].frames[0];
                }
                (built(&joints), at)
            },
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn random_mechanisms_are_read_again((original, at) in random()) {
        let system = MechanismSystem::new(&original, at.clone()).unwrap();
        prop_assert!(system.mismatch(&system.at_home()) < 1e-9, "the test closes the loops");
        for (format, write) in FORMATS {
            let written = write(&original, &at).unwrap();
            check(format, &original, &at, &written);
        }
    }
}

#[test]
fn names_of_couplings_that_a_format_does_not_have_are_reported() {
    let coupled = |name: &str| {
        let text = format!(
            r#"
kind = "mechanism"
name = "gears"
units = {{ length = "mm", angle = "deg" }}
base = "box"
joint = [
  {{ name = "wheel", kind = "revolute", links = ["box", "gear"], point = [0, 0, 0], axis = [0, 0, 1] }},
  {{ name = "motor", kind = "revolute", links = ["box", "pinion"], point = [90, 0, 0], axis = [0, 0, 1], actuated = true }},
]
coupling = [{{ name = "{name}", coordinate = "wheel", terms = [{{ coordinate = "motor", ratio = -2 }}] }}]
"#
        );
        mechanism::parse(&text).map_err(|error| error.with_excerpt("gears")).unwrap().mechanism
    };
    for (format, write) in FORMATS {
        for name in ["teeth", "mimic of wheel"] {
            let original = coupled(name);
            let written = write(&original, &guess(&original)).unwrap();
            let found = read(&written);
            let is_kept = found.couplings()[0].name == name;
            let report = format!("name of the coupling {name:?}");
            assert_eq!(!is_kept, written.lost.contains(&report), "{format}: {:?}", written.lost);
        }
    }
}

#[test]
fn couplings_are_read_again() {
    let coupled = |couplings: &str| {
        let text = format!(
            r#"
kind = "mechanism"
name = "coupled"
units = {{ length = "mm", angle = "deg" }}
base = "ground"
joint = [
  {{ name = "turn", kind = "revolute", links = ["ground", "disc"], point = [0, 0, 0], axis = [0, 0, 1], guess = 20 }},
  {{ name = "nut", kind = "cylindrical", links = ["disc", "sleeve"], point = [90, 0, 0], axis = [1, 1, 0] }},
  {{ name = "hook", kind = "universal", links = ["sleeve", "tool"], point = [190, 0, 0], axis = [0, 1, 0], second_axis = [1, 0, 0] }},
]
{couplings}"#
        );
        mechanism::parse(&text).map_err(|error| error.with_excerpt("coupled")).unwrap().mechanism
    };
    let thread = r#"
[[coupling]]
name = "thread"
coordinate = "nut[0]"
terms = [{ coordinate = "nut[1]", ratio = "5 / 360" }]
offset = 2
[[coupling]]
name = "belt"
coordinate = "hook[1]"
terms = [{ coordinate = "turn", ratio = -1.5 }]
"#;
    let original = coupled(thread);
    let at = assemble(&original, &guess(&original), &[0], 30).unwrap().coordinates;
    for (format, write) in FORMATS {
        let written = write(&original, &at).unwrap();
        let found = check(format, &original, &at, &written);
        assert_eq!(found.couplings().len(), 2, "{format}");
        // Names of split joints need no repair, which a file of loops that is read afterwards would not know.
        if let Some(loops) = &written.loops {
            let chain = parse(&written.text).unwrap();
            assert!(!chain.ignored.iter().any(|one| one.contains("is called")), "{chain:?}");
            assert_eq!(with_loops(&chain.mechanism, loops).unwrap().couplings().len(), 2);
        }
        assert_eq!(found.kutzbach_mobility(), original.kutzbach_mobility(), "{format}");
        // Both move alike from the reference, whatever their coordinates are called.
        let turned = |mechanism: &Mechanism, at: &DVector<f64>| {
            let turn = mechanism.joint("turn").unwrap();
            let index = Kinematics::new(mechanism).coordinates_of(turn).start;
            let hook = mechanism.joints().iter().position(|one| one.name.contains("hook(0)"));
            let hook = hook.unwrap_or_else(|| mechanism.joint("hook").unwrap());
            let nut = mechanism.joints().iter().position(|one| one.name.contains("nut(1)"));
            let nut = nut.map_or_else(
                || {
                    Kinematics::new(mechanism).coordinates_of(mechanism.joint("nut").unwrap()).start
                        + 1
                },
                |nut| Kinematics::new(mechanism).coordinates_of(nut).start,
            );
            let hook = Kinematics::new(mechanism).coordinates_of(hook).start;
            let mut start = at.clone();
            start[index] += 0.3;
            start[nut] += 0.7;
            let closed = assemble(mechanism, &start, &[index, hook, nut], 30).unwrap();
            let poses = Kinematics::new(mechanism).link_poses(&closed.coordinates).unwrap();
            poses[mechanism.link("tool").unwrap()].to_homogeneous()
        };
        let off = turned(&original, &at) - turned(&found, &guess(&found));
        assert!(off.amax() < 1e-9, "{format}: {off}");
    }
    let held = coupled("[[coupling]]\nname = \"brake\"\ncoordinate = \"turn\"\noffset = 20\n");
    let at = guess(&held);
    let found = check("MJCF", &held, &at, &mjcf(&held, &at).unwrap());
    assert!((found.couplings()[0].offset - f64::to_radians(20.0)).abs() < 1e-12);
    let found = check("Modelica", &held, &at, &modelica_package(&held, &at).unwrap());
    assert!((found.couplings()[0].offset - f64::to_radians(20.0)).abs() < 1e-12);
    let found = check("URDF", &held, &at, &urdf(&held, &at).unwrap());
    assert_eq!(found.couplings()[0].terms, []);
    let three = coupled(
        "[[coupling]]\nname = \"sum\"\ncoordinate = \"turn\"\nterms = [{ coordinate = \"hook[0]\", ratio = 1 }, { coordinate = \"hook[1]\", ratio = 1 }]\noffset = 20\n",
    );
    let at = assemble(&three, &guess(&three), &[], 30).unwrap().coordinates;
    let found = check("MJCF", &three, &at, &mjcf(&three, &at).unwrap());
    let in_modelica = check("Modelica", &three, &at, &modelica_package(&three, &at).unwrap());
    assert_eq!(in_modelica.couplings()[0].terms.len(), 2);
    let [sum] = found.couplings() else { panic!("{found:?}") };
    let ratios: Vec<f64> = sum.terms.iter().map(|&(_, ratio)| ratio).collect();
    assert_eq!(ratios, [1.0, 1.0]);
    assert!((sum.offset - f64::to_radians(20.0)).abs() < 1e-12);
    let written = urdf(&three, &at).unwrap();
    assert!(written.lost.iter().any(|one| one.contains("file of loops")), "{:?}", written.lost);
    let found = check("URDF", &three, &at, &written);
    assert_eq!(found.couplings()[0].terms.len(), 2);
    assert!(matches!(sdf(&three, &at), Err(Error::Coupling { .. })));
    let second = "[[coupling]]\nname = \"again\"\ncoordinate = \"nut[0]\"\nterms = [{ coordinate = \"turn\", ratio = 0.01 }]\n";
    let twice = coupled(&format!("{thread}{second}"));
    let at = assemble(&twice, &guess(&twice), &[], 30).unwrap().coordinates;
    // A follower of two coordinates leads one of them.
    check("SDF", &twice, &at, &sdf(&twice, &at).unwrap());
}

/// SDF separates the names of nested models by `::`, and has `__…__` for its own.
#[test]
fn names_that_sdf_reserves_are_replaced() {
    let text = "kind = \"mechanism\"\nname = \"cell::arm\"\nunits = { length = \"mm\", angle = \"deg\" }\nbase = \"__root__\"\n\
        [[joint]]\nname = \"cell::J1\"\nkind = \"revolute\"\nlinks = [\"__root__\", \"arm::upper\"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nactuated = true\n\
        [[joint]]\nname = \"cell/J1\"\nkind = \"prismatic\"\nlinks = [\"arm::upper\", \"____\"]\npoint = [100, 0, 0]\naxis = [0, 0, 1]\n\
        [[joint]]\nname = \"world\"\nkind = \"revolute\"\nlinks = [\"____\", \"a_\"]\npoint = [200, 0, 0]\naxis = [0, 0, 1]\n\
        [[frame]]\nname = \"__world__\"\nlink = \"a_\"\npoint = [0, 0, 0]\n";
    let mechanism =
        mechanism::parse(text).map_err(|error| error.with_excerpt("names")).unwrap().mechanism;
    let at = guess(&mechanism);
    let written = sdf(&mechanism, &at).unwrap();
    // Names of plugins are those of Gazebo.
    let of_model = written.text.lines().filter(|line| !line.contains("<plugin"));
    assert!(!of_model.clone().any(|line| line.contains("::") || line.contains("__")));
    let found = read(&written);
    assert_eq!(found.name(), "cell/arm");
    assert_eq!(found.links()[1..], ["root", "arm/upper", "link", "a_"]);
    let joints: Vec<&str> = found.joints().iter().map(|joint| joint.name.as_str()).collect();
    assert!(joints.ends_with(&["cell/J1 (2)", "cell/J1", "world joint"]), "{joints:?}");
    assert!(written.text.contains("<frame name=\"world frame\" attached_to=\"a_\">"));
    let of_names = |lost: &&String| lost.contains("SDF reserves its name");
    assert_eq!(written.lost.iter().filter(of_names).count(), 7, "{:?}", written.lost);
}

/// Wheels A, B and C on parallel axes.
fn wheels(actuated: [bool; 3], couplings: &[(&str, &str, &str, f64, f64)]) -> Mechanism {
    let mut text = "kind = \"mechanism\"\nname = \"gears\"\nunits = { length = \"mm\", angle = \"rad\" }\nbase = \"frame\"\n".to_owned();
    for ((k, name), actuated) in ["A", "B", "C"].into_iter().enumerate().zip(actuated) {
        text += &format!(
            "[[joint]]\nname = {name:?}\nkind = \"revolute\"\nlinks = [\"frame\", \"w{k}\"]\npoint = [{}, 0, 0]\naxis = [0, 0, 1]\nactuated = {actuated}\n",
            30 * k
        );
    }
    for (name, follower, leader, ratio, offset) in couplings {
        text += &format!(
            "[[coupling]]\nname = {name:?}\ncoordinate = {follower:?}\nterms = [{{ coordinate = {leader:?}, ratio = {ratio} }}]\noffset = {offset}\n"
        );
    }
    mechanism::parse(&text).map_err(|errors| format!("{errors}\n{text}")).unwrap().mechanism
}

/// The rules of ROS: a joint mimics at most one other, none over others itself, and no joint that mimics has a command interface.
fn check_mimics(text: &str) -> Vec<[String; 2]> {
    let document = roxmltree::Document::parse(text).unwrap();
    let root = document.root_element();
    let elements = |name: &'static str| root.children().filter(move |one| one.has_tag_name(name));
    let mut mimics = Vec::new();
    for joint in elements("joint") {
        let found: Vec<_> = joint.children().filter(|one| one.has_tag_name("mimic")).collect();
        assert!(found.len() < 2, "{text}");
        let name = joint.attribute("name").unwrap().to_owned();
        mimics
            .extend(found.iter().map(|one| [name.clone(), one.attribute("joint").unwrap().into()]));
    }
    let leader =
        |of: &str| mimics.iter().find(|[one, _]| one == of).map(|[_, leader]| leader.as_str());
    for [joint, _] in &mimics {
        let chain = std::iter::successors(leader(joint), |one| leader(one));
        assert!(
            chain.take(mimics.len() + 1).count() <= mimics.len(),
            "{joint} is in a cycle: {text}"
        );
    }
    for joint in elements("ros2_control").flat_map(|one| one.children()) {
        let commands = joint.children().filter(|one| one.has_tag_name("command_interface")).count();
        let mimics = joint.attribute("name").is_some_and(|name| leader(name).is_some());
        assert!(commands == 0 || !mimics, "{:?}: {text}", joint.attribute("name"));
    }
    mimics
}

#[test]
fn joints_of_ros_mimic_in_no_cycle_and_have_no_command_interface() {
    let urdf_of = |mechanism: &Mechanism| {
        let at = assemble(mechanism, &guess(mechanism), &[], 50).unwrap().coordinates;
        let written = urdf(mechanism, &at).unwrap();
        let mimics = check_mimics(&written.text);
        let found = check("URDF", mechanism, &at, &written);
        (mimics, written.lost, found)
    };
    let pairs =
        |all: &[[&str; 2]]| all.iter().map(|one| one.map(str::to_owned)).collect::<Vec<_>>();
    // The follower has the motor.
    let turned = wheels([false, true, false], &[("belt", "B", "A", -2.0, 0.5)]);
    let (mimics, _, found) = urdf_of(&turned);
    assert_eq!(mimics, pairs(&[["A", "B"]]));
    let [belt] = found.couplings() else { panic!("{found:?}") };
    assert_eq!((belt.terms[0].1, belt.offset), (-0.5, 0.25));
    assert!(found.joints()[1].actuated);
    // A follower of two is one of them and leads the other.
    let (mimics, ..) = urdf_of(&wheels(
        [true, false, false],
        &[("AB", "B", "A", 2.0, 0.0), ("CB", "B", "C", 3.0, 0.1)],
    ));
    assert_eq!(mimics, pairs(&[["B", "A"], ["C", "B"]]));
    // A ring of gears: the last coupling is implied by the others.
    let ring =
        [("AB", "B", "A", -2.0, 0.0), ("BC", "C", "B", -0.5, 0.0), ("CA", "A", "C", 1.0, 0.0)];
    let elsewhere = |lost: &[String], name: &str| {
        let start = format!("coupling {name:?} is in the file of loops");
        assert!(lost.iter().any(|one| one.starts_with(&start)), "{lost:?}");
    };
    let (mimics, lost, found) = urdf_of(&wheels([true, false, false], &ring));
    assert_eq!(mimics, pairs(&[["B", "A"], ["C", "B"]]));
    elsewhere(&lost, "CA");
    assert_eq!(found.couplings().len(), 3);
    // Two motors on one train: one leads, the other is listed.
    let (mimics, lost, _) = urdf_of(&wheels([false, true, true], &[ring[0], ring[1]]));
    assert_eq!(mimics, pairs(&[["A", "B"], ["C", "B"]]));
    assert!(lost.iter().any(|one| one == "actuator of \"C\": it follows \"B\""), "{lost:?}");
    // A ring of another ratio does not move, and a ratio of zero fixes its follower.
    let still = [ring[0], ring[1], ("CA", "A", "C", 1.1, 0.0)];
    for (couplings, name) in [(&still[..], "CA"), (&[("still", "B", "A", 0.0, 0.3)], "still")] {
        let fixed = wheels([true, false, false], couplings);
        let (_, lost, _) = urdf_of(&fixed);
        elsewhere(&lost, name);
        let at = assemble(&fixed, &guess(&fixed), &[], 50).unwrap().coordinates;
        assert!(matches!(sdf(&fixed, &at), Err(Error::Coupling { .. })), "{couplings:?}");
    }
    // In SDF a motor leads, too.
    let at = guess(&turned);
    let closed = assemble(&turned, &at, &[], 50).unwrap().coordinates;
    let found = check("SDF", &turned, &closed, &sdf(&turned, &closed).unwrap());
    assert_eq!(found.couplings()[0].follower.joint, found.joint("A").unwrap());
}

/// Before, such joints and frames had the world as child in SDF, which Gazebo refuses.
#[test]
fn joints_that_end_at_the_world_and_frames_of_it_are_read_again() {
    let chain = "kind = \"mechanism\"\nname = \"gate\"\nunits = { length = \"m\", angle = \"deg\" }\nbase = \"world\"\n\
        [[frame]]\nname = \"post\"\nlink = \"world\"\npoint = [1, 2, 3]\n\
        [[joint]]\nname = \"hinge\"\nkind = \"revolute\"\nlinks = [\"world\", \"crank\"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\n\
        [[joint]]\nname = \"pin\"\nkind = \"revolute\"\nlinks = [\"crank\", \"rod\"]\npoint = [1, 1, 0]\naxis = [0, 0, 1]\n";
    for kind in
        ["revolute", "prismatic", "universal", "spherical", "cylindrical", "planar", "fixed"]
    {
        let axes = match kind {
            "spherical" => "",
            "universal" => "axis = [0, 0, 1]\nsecond_axis = [1, 0, 0]\n",
            "revolute" | "planar" => "axis = [0, 0, 1]\n",
            _ => "axis = [1, 0, 0]\n",
        };
        let end = format!(
            "[[joint]]\nname = \"end\"\nkind = \"{kind}\"\nlinks = [\"rod\", \"world\"]\npoint = [3, 0, 0]\n{axes}"
        );
        let file = mechanism::parse(&(chain.to_owned() + &end));
        let mechanism =
            file.unwrap_or_else(|error| panic!("{}", error.with_excerpt(kind))).mechanism;
        let at = assemble(&mechanism, &guess(&mechanism), &[], 0).unwrap().coordinates;
        for (format, write) in FORMATS {
            let written = write(&mechanism, &at).unwrap();
            check(format, &mechanism, &at, &written);
            for refused in ["<child>world<", "relative_to=\"world\"", "attached_to=\"world\""] {
                assert!(!written.text.contains(refused), "{kind}: {}", written.text);
            }
        }
    }
}

#[test]
fn a_screw_is_kept_by_modelica_and_sdf_and_refused_by_others() {
    let screw = |pitch: f64| {
        let joint = Joint {
            name: "spindle".to_owned(),
            kind: JointKind::Helical { lead: pitch },
            links: [0, 1],
            frames: [Pose::identity(), Pose::translation(0.1, 0.0, 0.0)],
            actuated: true,
            guess: Vec::new(),
            limits: vec![[-1.0, 2.0]],
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        };
        Mechanism::new("press", vec!["frame".to_owned(), "ram".to_owned()], vec![joint]).unwrap()
    };
    let press = screw(0.002);
    let at = DVector::from_element(1, 0.5);
    for (format, write) in FORMATS {
        if ["MJCF", "URDF"].contains(&format) {
            let error = write(&press, &at).unwrap_err().to_string();
            assert!(error.contains("spindle") && error.contains("helical"), "{format}: {error}");
            continue;
        }
        let found = check(format, &press, &at, &write(&press, &at).unwrap());
        let spindle = &found.joints()[found.joint("spindle").unwrap()];
        let JointKind::Helical { lead } = spindle.kind else { panic!("{:?}", spindle.kind) };
        assert!((lead - 0.002).abs() < 1e-15 && spindle.actuated, "{format}");
    }
}

#[test]
fn limits_and_coordinates_are_kept() {
    let text = catalogue::find("gpr-mechanism").unwrap().text;
    let original = mechanism::parse(text).unwrap().mechanism;
    let mut at = guess(&original);
    // A common heave.
    (0..3).for_each(|k| at[k] = 0.05);
    for (format, write) in FORMATS {
        let found = check(format, &original, &at, &write(&original, &at).unwrap());
        let rod = found.joint("rod 1").or_else(|| found.joint("rod 1 joint")).unwrap();
        let rod = &found.joints()[rod];
        let (zero, limits) = match format {
            "SDF" => (0.0, [-0.304, 0.204]),
            _ => (0.05, [-0.254, 0.254]),
        };
        assert_eq!(rod.guess.first().copied().unwrap_or(0.0), zero, "{format}");
        let off = (rod.limits[0][0] - limits[0]).abs().max((rod.limits[0][1] - limits[1]).abs());
        assert!(off < 1e-12 && rod.actuated, "{format}: {:?}", rod.limits);
    }
}
