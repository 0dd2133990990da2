//! Functional mock-up units: the numbers of the library, and refusals.

use std::collections::BTreeSet;
use std::io::{Cursor, Read as _};

use jointplay_core::bulk::PoseSolver;
use jointplay_core::gpr::Gpr;
use jointplay_core::mechanism::{
    CommandedPositions, Kinematics, ReliefSolver, close_commanded, pose_commanded,
};
use jointplay_core::spatial::Pose;
use jointplay_core::virtualization::{Polar, SolveOptions, Virtualization, built_in};
use jointplay_format::{catalogue, mechanism, robot};
use jointplay_interop::fmu::{
    Binary, Causality, Error, FmiVersion, Fmu, Resources, Variable, archive, library_mark,
    model_description, model_identifier,
};
use nalgebra::{Quaternion, UnitQuaternion};

/// A table on four columns, one more than it needs: balls with play in all directions.
const TABLE: &str = include_str!("fmu/table.toml");
/// A pan-tilt head on a telescope, without loops: names with spaces, dots, quotes and letters beyond ASCII.
const HEAD: &str = include_str!("fmu/head.toml");
/// A lamp that a spindle lifts: a parallelogram of two arms, a helical drive, a relieved hinge.
const LAMP: &str = include_str!("fmu/lamp.toml");
/// A three-rod robot whose rods differ, with a parameter.
const TRIPOD: &str = include_str!("fmu/tripod.toml");

fn from_catalogue(name: &str) -> Resources {
    Resources::for_model(catalogue::find(name).unwrap().text)
}

fn inputs(fmu: &Fmu) -> Vec<Variable> {
    let all = fmu.variables().iter();
    all.filter(|one| one.causality == Causality::Input).cloned().collect()
}

fn outputs(fmu: &Fmu) -> Vec<Variable> {
    let all = fmu.variables().iter();
    all.filter(|one| one.causality == Causality::Output).cloned().collect()
}

fn values(fmu: &Fmu, of: &[Variable]) -> Vec<f64> {
    of.iter().map(|one| fmu.value(one.reference).unwrap()).collect()
}

/// A path of the drives, from their initial values: each swings with its own phase.
fn path(fmu: &Fmu, amplitude: f64) -> impl Iterator<Item = Vec<(u32, f64)>> + use<> {
    let drives = inputs(fmu);
    (1..=24).map(move |step| {
        let swing = |(k, one): (usize, &Variable)| {
            let phase = 0.1 * f64::from(step) + k as f64;
            (one.reference, one.start.unwrap() + amplitude * (phase.sin() - (k as f64).sin()))
        };
        drives.iter().enumerate().map(swing).collect()
    })
}

fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u64> {
    numbers.into_iter().map(f64::to_bits).collect()
}

/// The outputs of a path, compared with calls of the library that share nothing with the unit but the mechanism.
fn check_mechanism(text: &str, amplitude: f64) {
    let mut fmu = Fmu::new(&Resources::for_model(text)).unwrap();
    let file = mechanism::parse(text).unwrap();
    let mechanism = &file.mechanism;
    let drives = mechanism.actuated_coordinates();
    let mut at = close_commanded(mechanism, &[], None).unwrap().coordinates;
    let mut positions = CommandedPositions::new(mechanism, &at, &drives).unwrap();
    let start: Vec<f64> = drives.iter().map(|&k| at[k]).collect();
    positions.solve(mechanism, &start, &mut at, ReliefSolver::LeastNorm).unwrap();
    let listed = outputs(&fmu);
    let frames: Vec<_> = mechanism.moving_frames().collect();
    assert_eq!(listed.len(), 7 * frames.len() + mechanism.virtual_joints().len());
    let steps: Vec<_> = path(&fmu, amplitude).collect();
    for set in steps {
        fmu.set(&set).unwrap();
        fmu.update().unwrap();
        let command: Vec<f64> = set.iter().map(|&(_, value)| value).collect();
        positions.solve(mechanism, &command, &mut at, ReliefSolver::LeastNorm).unwrap();
        let found = values(&fmu, &listed);
        let kinematics = Kinematics::new(mechanism);
        let links = kinematics.link_poses(&at).unwrap();
        for (numbers, &frame) in found.chunks(7).zip(&frames) {
            check_pose(numbers, &kinematics.frame_pose(frame, &links));
        }
        let displacements = at.iter().skip(mechanism.joint_freedoms()).copied();
        assert_eq!(bits(found[7 * frames.len()..].iter().copied()), bits(displacements));
    }
}

/// Position to the bit; the quaternion turns as the rotation matrix does.
fn check_pose(numbers: &[f64], pose: &Pose) {
    assert_eq!(bits(numbers[..3].iter().copied()), bits(pose.translation.vector.iter().copied()));
    let &[w, x, y, z] = &numbers[3..7] else { panic!("seven numbers") };
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)).to_rotation_matrix();
    assert!((turn.matrix() - pose.rotation.matrix()).norm() < 1e-14);
}

#[test]
fn outputs_of_mechanisms_are_those_of_the_library_to_the_bit() {
    check_mechanism(TABLE, 0.004);
    check_mechanism(HEAD, 0.3);
    check_mechanism(LAMP, 0.02);
    for (name, amplitude) in [
        ("gpr-mechanism", 1e-3),
        ("hexapod", 0.01),
        ("four-bar", 0.8),
        ("3-rps", 0.01),
        ("bennett", 0.5),
        ("tripteron", 0.01),
    ] {
        check_mechanism(catalogue::find(name).unwrap().text, amplitude);
    }
}

#[test]
fn outputs_of_robots_are_those_of_the_library_to_the_bit() {
    let options = SolveOptions::default();
    for (resources, virtualization) in built_in().into_iter().flat_map(|one| {
        let named = |resources: Resources| Resources {
            virtualization: Some(one.name().to_owned()),
            ..resources
        };
        [(named(from_catalogue("gpr")), one), (named(Resources::for_model(TRIPOD)), one)]
    }) {
        let gpr = robot::parse(&resources.model).unwrap().gpr;
        let prepared = PoseSolver::new(&gpr, virtualization.as_built_in().unwrap(), &options);
        let prepared = prepared.unwrap();
        let mut fmu = Fmu::new(&resources).unwrap();
        let listed = outputs(&fmu);
        let steps: Vec<_> = path(&fmu, 5e-4).collect();
        for set in steps {
            fmu.set(&set).unwrap();
            fmu.update().unwrap();
            let rods: Vec<f64> = set.iter().map(|&(_, value)| value).collect();
            let pose = prepared.forward(rods.try_into().unwrap()).unwrap();
            let found = values(&fmu, &listed);
            check_pose(&found[..7], &pose.base_from_platform);
            let moved = gpr.virtual_displacements(&pose, virtualization);
            assert_eq!(bits(found[7..].iter().copied()), bits(moved.iter().copied()));
        }
    }
}

/// Directional derivatives, compared with central differences of the outputs.
fn check_rates(resources: &Resources, h: f64, threshold: f64) {
    let mut fmu = Fmu::new(resources).unwrap();
    let (drives, listed) = (inputs(&fmu), outputs(&fmu));
    let references: Vec<u32> = listed.iter().map(|one| one.reference).collect();
    let steps: Vec<_> = path(&fmu, 40.0 * h).collect();
    for set in steps.into_iter().step_by(6) {
        fmu.set(&set).unwrap();
        fmu.update().unwrap();
        let here = fmu.state();
        // A direction in which all drives move, each by another rate.
        let rate = |k: usize| 1.0 - 0.37 * k as f64;
        let direction: Vec<(u32, f64)> =
            drives.iter().enumerate().map(|(k, one)| (one.reference, rate(k))).collect();
        let found = fmu.rates(&references, &direction).unwrap();
        let mut moved = |sign: f64| {
            fmu.set_state(&here).unwrap();
            let there: Vec<(u32, f64)> = set
                .iter()
                .zip(&direction)
                .map(|(&(reference, value), &(_, rate))| (reference, value + sign * h * rate))
                .collect();
            fmu.set(&there).unwrap();
            fmu.update().unwrap();
            values(&fmu, &listed)
        };
        let (after, before) = (moved(1.0), moved(-1.0));
        for (k, one) in listed.iter().enumerate() {
            let expected = (after[k] - before[k]) / (2.0 * h);
            let error = (found[k] - expected).abs();
            let name = &one.name;
            assert!(error < threshold, "{name}: {} instead of {expected}", found[k]);
        }
        fmu.set_state(&here).unwrap();
    }
}

#[test]
fn directional_derivatives_are_those_of_the_outputs() {
    for text in [TABLE, HEAD, LAMP, TRIPOD] {
        check_rates(&Resources::for_model(text), 1e-5, 2e-6);
    }
    for name in ["gpr-mechanism", "gpr", "hexapod", "four-bar", "bennett"] {
        check_rates(&from_catalogue(name), 1e-5, 2e-6);
    }
    let polar = Some(Polar.name().to_owned());
    check_rates(&Resources { virtualization: polar, ..from_catalogue("gpr") }, 1e-5, 2e-6);
}

#[test]
fn a_state_restored_from_its_bytes_has_the_same_outputs_afterwards() {
    for text in [TABLE, HEAD, LAMP, TRIPOD] {
        let resources = Resources::for_model(text);
        let mut fmu = Fmu::new(&resources).unwrap();
        let listed = outputs(&fmu);
        let references: Vec<u32> = listed.iter().map(|one| one.reference).collect();
        let direction: Vec<(u32, f64)> =
            inputs(&fmu).iter().map(|one| (one.reference, 0.7)).collect();
        let steps: Vec<_> = path(&fmu, 5e-4).collect();
        let (first, rest) = steps.split_at(10);
        for set in first {
            fmu.set(set).unwrap();
            fmu.update().unwrap();
        }
        fmu.set_time(1.25);
        // Inputs that are set, and not yet used, belong to the state.
        fmu.set(&rest[0]).unwrap();
        let bytes = fmu.state().to_bytes();
        assert_eq!(bytes.len(), fmu.state().byte_count());
        let go_on = |fmu: &mut Fmu| {
            let mut all = vec![fmu.time()];
            all.extend(fmu.rates(&references, &direction).unwrap());
            fmu.update().unwrap();
            for set in rest {
                fmu.set(set).unwrap();
                fmu.update().unwrap();
                all.extend(values(fmu, &listed));
                all.extend(fmu.rates(&references, &direction).unwrap());
            }
            bits(all)
        };
        let mut other = Fmu::new(&resources).unwrap();
        let state = other.state_from_bytes(&bytes).unwrap();
        assert_eq!(state, fmu.state());
        other.set_state(&state).unwrap();
        let expected = go_on(&mut fmu);
        assert_eq!(go_on(&mut other), expected);
        // Back again, after all that.
        other.set_state(&state).unwrap();
        assert_eq!(go_on(&mut other), expected);
        other.reset();
        assert_eq!(other.state(), Fmu::new(&resources).unwrap().state());
        // Damaged, cut, or of another unit.
        let mut damaged = bytes.clone();
        damaged[3] ^= 1;
        let mut nan = bytes.clone();
        let last = nan.len() - 8;
        nan[last..].copy_from_slice(&f64::NAN.to_le_bytes());
        let of_other = Fmu::new(&from_catalogue("four-bar")).unwrap().state();
        for bytes in [&damaged, &bytes[..bytes.len() - 1].to_vec(), &nan, &of_other.to_bytes()] {
            let refused = other.state_from_bytes(bytes).unwrap_err();
            assert!(matches!(refused, Error::State { .. }), "{refused}");
        }
        assert!(matches!(other.set_state(&of_other), Err(Error::State { .. })));
    }
}

#[test]
fn names_do_not_collide() {
    let fmu = Fmu::new(&Resources::for_model(HEAD)).unwrap();
    let names: Vec<&str> = fmu.variables().iter().map(|one| one.name.as_str()).collect();
    let different: BTreeSet<&str> = names.iter().copied().collect();
    assert_eq!(different.len(), names.len());
    for name in [
        "drive.'pan.tilt'[0]",
        "drive.'pan.tilt'[1]",
        "drive.'Auszug 1'",
        "pose.'Rohr \"ä\"'.qw",
        "pose.camera.x",
        "pose.'camera.x'.x",
    ] {
        assert!(different.contains(name), "{name}: {names:?}");
    }
    let flat = model_description(&fmu, "head & <co>", "head", FmiVersion::V2);
    assert!(flat.contains("variableNamingConvention=\"flat\""));
    for version in [FmiVersion::V2, FmiVersion::V3] {
        let text = model_description(&fmu, "head & <co>", "head", version);
        let document = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(document.root_element().attribute("modelName"), Some("head & <co>"));
        let named: BTreeSet<&str> = document
            .descendants()
            .filter(|one| matches!(one.tag_name().name(), "ScalarVariable" | "Float64"))
            .filter_map(|one| one.attribute("name"))
            .filter(|&name| name != "time")
            .collect();
        assert_eq!(named, different);
    }
    let table = Fmu::new(&Resources::for_model(TABLE)).unwrap();
    let text = model_description(&table, "table", "table", FmiVersion::V3);
    assert!(text.contains("variableNamingConvention=\"structured\""));
    assert_eq!(model_identifier("3-rps v2.1 ä"), "_3_rps_v2_1__");
    assert_eq!(model_identifier(""), "_");
}

#[test]
fn a_start_is_the_initial_configuration() {
    let text = catalogue::find("four-bar").unwrap().text;
    let start = vec![("A".to_owned(), 0.5)];
    let resources = Resources { start, ..Resources::for_model(text) };
    let fmu = Fmu::new(&resources).unwrap();
    let drive = &inputs(&fmu)[0];
    assert_eq!((drive.start, fmu.value(drive.reference).unwrap()), (Some(0.5), 0.5));
    let file = mechanism::parse(text).unwrap();
    let expected = pose_commanded(&file.mechanism, &[(0, 0.5)], None).unwrap().closed.coordinates;
    let links = Kinematics::new(&file.mechanism).link_poses(&expected).unwrap();
    let first: Vec<f64> = values(&fmu, &outputs(&fmu)[..3]);
    let origin = links[1].translation.vector;
    assert!(first.iter().zip(&origin).all(|(a, b)| (a - b).abs() < 1e-12));
    // An initial value far away needs the search of the initialization; a step as long is refused.
    let mut fmu = Fmu::new(&from_catalogue("gpr-mechanism")).unwrap();
    let rods = inputs(&fmu);
    let far: Vec<(u32, f64)> = rods.iter().map(|one| (one.reference, 0.1)).collect();
    fmu.set(&far).unwrap();
    fmu.initialize().unwrap();
    let platform = fmu.variables().iter().find(|one| one.name == "pose.platform.z").unwrap();
    assert!((fmu.value(platform.reference).unwrap() - 0.1).abs() < 1e-12);
    // Parameters replace those of the file.
    let resources =
        Resources { parameters: vec![("reach".to_owned(), 120.0)], ..Resources::for_model(TRIPOD) };
    assert!(Fmu::new(&resources).is_ok());
    let resources =
        Resources { parameters: vec![("none".to_owned(), 1.0)], ..Resources::for_model(TRIPOD) };
    assert!(matches!(Fmu::new(&resources), Err(Error::Resource { .. })));
}

#[test]
fn what_cannot_be_a_unit_is_refused() {
    let check = |resources: Resources, infeasible: bool, message: &str| {
        let error = Fmu::new(&resources).unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
        assert_eq!(error.is_infeasible(), infeasible, "{error}");
    };
    check(from_catalogue("3-crr"), false, "no actuated joint");
    // Bars that turn about themselves between two balls.
    check(from_catalogue("delta"), true, "leave 6 motions free");
    // More drives than freedoms, and no play.
    let text = catalogue::find("gpr-mechanism").unwrap().text;
    let rigid = &text[..text.find("[[virtual_joint]]").unwrap()];
    let tilted = vec![("rod 1".to_owned(), 0.002)];
    check(Resources { start: tilted, ..Resources::for_model(rigid) }, true, "");
    let ball = text.replacen("kind = \"spherical\"", "kind = \"spherical\"\nactuated = true", 1);
    check(Resources::for_model(ball), false, "actuated ball");
    let beyond = vec![("rod 1".to_owned(), 0.3)];
    check(
        Resources { start: beyond, ..Resources::for_model(text) },
        true,
        "limits are -254 to 254 mm",
    );
    let unknown = vec![("rod 7".to_owned(), 0.3)];
    check(Resources { start: unknown.clone(), ..Resources::for_model(text) }, false, "rod 7");
    check(Resources { start: unknown, ..from_catalogue("gpr") }, false, "rod 7");
    let beyond = vec![("rod 1".to_owned(), 3.0)];
    check(Resources { start: beyond, ..from_catalogue("gpr") }, true, "limits exceeded: ");
    let polar =
        |name: &str| Resources { virtualization: Some("Polar".to_owned()), ..from_catalogue(name) };
    check(polar("gpr"), false, "known are radial, polar, offset, planar");
    check(polar("four-bar"), false, "a mechanism has its own virtual joints");
    check(Resources::for_model("kind = \"mechanism\"\nname = 3"), false, "model.toml:2");
    check(Resources::for_model(""), false, "model.toml");
    check(Resources::for_model("kind = \"gpr\""), false, "model.toml");
}

#[test]
fn a_refused_call_changes_nothing() {
    let mut fmu = Fmu::new(&from_catalogue("gpr-mechanism")).unwrap();
    let (rods, listed) = (inputs(&fmu), outputs(&fmu));
    let reference = rods[0].reference;
    let last = listed[listed.len() - 1].reference;
    let before = fmu.state();
    for (set, message) in [
        (vec![(reference, 1e-3), (reference + 1, f64::NAN)], "finite"),
        (vec![(reference, f64::INFINITY)], "finite"),
        (vec![(reference, 1e-3), (last, 0.0)], "is not an input"),
        (vec![(last + 1, 0.0)], "no variable"),
        (vec![(0, 0.0)], "time is not an input"),
    ] {
        let refused = fmu.set(&set).unwrap_err();
        assert!(!refused.is_infeasible() && refused.to_string().contains(message), "{refused}");
        assert_eq!(fmu.state(), before);
    }
    assert!(matches!(fmu.value(u32::MAX), Err(Error::NoVariable { .. })));
    let refused = fmu.rates(&[reference], &[(reference, 1.0)]).unwrap_err();
    assert!(matches!(refused, Error::NotOutput { .. }), "{refused}");
    let refused = fmu.rates(&[last], &[(last, 1.0)]).unwrap_err();
    assert!(matches!(refused, Error::NotInput { .. }), "{refused}");
    // A step without a solution: beyond limits, far beyond every mechanism, and too far.
    for (value, message) in [(0.3, "254"), (1e9, "too large"), (1e300, "too large")] {
        fmu.set(&[(reference, value)]).unwrap();
        let refused = fmu.update().unwrap_err();
        assert!(refused.to_string().contains(message), "{refused}");
        assert_eq!(values(&fmu, &listed), {
            let mut same = fmu.clone();
            same.set_state(&before).unwrap();
            values(&same, &listed)
        });
    }
    fmu.set(&[(reference, 1e-3)]).unwrap();
    fmu.update().unwrap();
    // A crank-rocker cannot be where the rocker would leave its limits; one step over a dead point is none.
    let text = catalogue::find("slider-crank").unwrap().text;
    let mut fmu = Fmu::new(&Resources::for_model(text)).unwrap();
    let crank = inputs(&fmu)[0].clone();
    for step in 0..40 {
        fmu.set(&[(crank.reference, crank.start.unwrap() + 0.2 * f64::from(step))]).unwrap();
        fmu.update().unwrap();
    }
}

#[test]
fn the_archive_is_the_same_for_the_same_contents() {
    let mut library = b"\x7fELF\x02\x01\x01".to_vec();
    library.resize(18, 0);
    library.extend([0x3e, 0]);
    library.extend(library_mark().bytes());
    let binary = Binary::new(library.clone()).unwrap();
    let resources =
        Resources { virtualization: Some("radial".to_owned()), ..from_catalogue("gpr") };
    for (version, folder) in [(FmiVersion::V2, "linux64"), (FmiVersion::V3, "x86_64-linux")] {
        let made = archive(&resources, "my gpr", std::slice::from_ref(&binary), version).unwrap();
        assert_eq!(
            made,
            archive(&resources, "my gpr", std::slice::from_ref(&binary), version).unwrap()
        );
        let mut zip = zip::ZipArchive::new(Cursor::new(made)).unwrap();
        let mut text = |name: &str| {
            let mut bytes = Vec::new();
            zip.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
            bytes
        };
        assert_eq!(text(&format!("binaries/{folder}/my_gpr.so")), library);
        let [model, settings] =
            ["model.toml", "settings.toml"].map(|name| text(&format!("resources/{name}")));
        let read =
            Resources::parse([&model, &settings].map(|one| std::str::from_utf8(one).unwrap()));
        let read = read.unwrap();
        assert_eq!(read, resources);
        let description = String::from_utf8(text("modelDescription.xml")).unwrap();
        assert!(description.contains(&read.token()) && description.contains("\"my_gpr\""));
    }
    let refused = archive(&resources, "a", &[binary.clone(), binary], FmiVersion::V2).unwrap_err();
    assert!(refused.to_string().contains("two libraries"), "{refused}");
    assert!(Gpr::paper().limits().rod_min > 0.0);
}

/// The bars of the Delta robot spin about the lines through their balls; the remedy of the message removes the spins, and nothing else.
#[test]
fn free_motions_are_named_and_their_remedy_removes_them() {
    let text = catalogue::find("delta").unwrap().text;
    let Err(Error::FreeMotions { motions }) = Fmu::new(&Resources::for_model(text)) else {
        panic!("the drives do not determine the spins of the rods")
    };
    let motions = motions.0;
    let links: Vec<&str> = motions.iter().flat_map(|one| &one.links).map(String::as_str).collect();
    let expected = [1, 2, 3].map(|k| [format!("rod {k} left"), format!("rod {k} right")]);
    assert_eq!(links, expected.concat());
    assert!(motions.iter().all(|one| one.is_spin && one.count == 1 && one.joints.len() == 2));

    let delta = mechanism::parse(text).unwrap().mechanism;
    let start = pose_commanded(&delta, &[], None).unwrap().closed.coordinates;
    let poses = Kinematics::new(&delta).link_poses(&start).unwrap();
    let mut joints = delta.joints().to_vec();
    for motion in &motions {
        let [elbow, wrist] = [0, 1].map(|k| delta.joint(&motion.joints[k]).unwrap());
        let place = |joint: usize| {
            let joint = &delta.joints()[joint];
            (poses[joint.links[0]] * joint.frames[0]).translation.vector
        };
        let bar = (place(wrist) - place(elbow)).normalize();
        let first = bar.cross(&nalgebra::Vector3::z()).normalize();
        // z and x of the joint are perpendicular to the bar.
        let axes = nalgebra::Matrix3::from_columns(&[
            first.cross(&bar),
            first.cross(&first.cross(&bar)),
            first,
        ]);
        let turn = nalgebra::Rotation3::from_matrix_unchecked(axes);
        let world = Pose::from_parts(place(elbow).into(), turn);
        let joint = &mut joints[elbow];
        joint.kind = jointplay_core::mechanism::JointKind::Universal;
        joint.frames = joint.links.map(|link| poses[link].inverse() * world);
        joint.guess.clear();
    }
    let remedied = delta.clone().with_joints(joints).unwrap();
    let mut fmu = Fmu::new(&Resources::for_model(mechanism::write(&remedied, None))).unwrap();
    let platform = delta.link("platform").unwrap();
    let drives = delta.actuated_coordinates();
    let mut at = start.clone();
    for step in path(&fmu, 0.2) {
        fmu.set(&step).unwrap();
        fmu.update().unwrap();
        let commands: Vec<(usize, f64)> =
            drives.iter().copied().zip(step.iter().map(|one| one.1)).collect();
        for &(k, value) in &commands {
            at[k] = value;
        }
        at = jointplay_core::mechanism::assemble(&delta, &at, &drives, 0).unwrap().coordinates;
        let pose = Kinematics::new(&delta).link_poses(&at).unwrap()[platform];
        let variables = fmu.variables();
        let value = |of: &str| {
            let name = format!("pose.platform.{of}");
            let found = variables.iter().find(|one| one.name == name).unwrap();
            fmu.value(found.reference).unwrap()
        };
        let off = ["x", "y", "z"]
            .map(&value)
            .into_iter()
            .zip(pose.translation.vector.iter())
            .map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9 && value("qw") > 1.0 - 1e-12);
    }
}

/// A chain with a joint that no drive moves: its motion is no spin, and the remedy is another.
#[test]
fn free_motions_of_chains_are_named() {
    let text = "kind = \"mechanism\"\nname = \"crane\"\nunits = { length = \"m\", angle = \"rad\" }\nbase = \"mast\"\n[[joint]]\nname = \"slew\"\nkind = \"revolute\"\nlinks = [\"mast\", \"jib\"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\nactuated = true\n[[joint]]\nname = \"hook\"\nkind = \"universal\"\nlinks = [\"jib\", \"load\"]\npoint = [3, 0, 0]\naxis = [1, 0, 0]\nsecond_axis = [0, 1, 0]\n";
    let error = Fmu::new(&Resources::for_model(text)).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("leave 2 motions free") && message.contains("hook"), "{message}");
    assert!(message.contains("actuated = true") && error.is_infeasible(), "{message}");
    let Error::FreeMotions { motions } = error else { panic!("{message}") };
    assert!(motions.0.iter().all(|one| one.links == ["load"] && !one.is_spin));
}
