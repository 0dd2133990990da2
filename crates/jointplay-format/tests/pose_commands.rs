//! Commands to poses, against closed forms and against neighbouring configurations.

use jointplay_core::mechanism::{
    DrivenMotion, FramePath, FrameTarget, Mechanism, MechanismSystem, OrientationTarget, Stop,
    assemble, close_at_rest, drive_frames, guess, pose_commanded, relieve_commanded,
};
use jointplay_core::spatial::Pose;
use jointplay_format::catalogue;
use jointplay_format::command::{Names, PoseCommand, PosePoint, frame_paths};
use jointplay_format::mechanism::{MechanismFile, parse};
use nalgebra::{DVector, Rotation3, Vector3};
use proptest::prelude::*;

fn home(mechanism: &Mechanism) -> MechanismSystem<'_> {
    let closed = assemble(mechanism, &guess(mechanism), &[], 30).unwrap();
    MechanismSystem::new(mechanism, closed.coordinates).unwrap()
}

/// The motion to a commanded pose, in steps.
fn to(file: &MechanismFile, text: &str, steps: u32) -> DrivenMotion {
    let names = Names::of(file);
    let home = home(&file.mechanism);
    let command = PoseCommand::parse(text, &file.mechanism, &names).unwrap();
    let links = home.kinematics().link_poses(home.home()).unwrap();
    let pose = home.kinematics().frame_pose(command.frame(), &links);
    let share = |k| PosePoint { at: 0.0, share: f64::from(k) / f64::from(steps) };
    let points: Vec<PosePoint> = (0..=steps).map(share).collect();
    let paths = frame_paths(&[command], &[pose], &names, &points).unwrap();
    drive_frames(&home, home.home(), &paths, &mut |_| ()).unwrap()
}

fn end(motion: &DrivenMotion) -> &DVector<f64> {
    assert_eq!(motion.stopped, None);
    &motion.waypoints.last().unwrap().coordinates
}

fn value(file: &MechanismFile, at: &DVector<f64>, joint: &str) -> f64 {
    let coordinates = jointplay_format::coordinates::Coordinates::of(file);
    at[coordinates.find(&file.mechanism, joint).unwrap()]
}

/// A hexapod whose pose is commanded in part: free coordinates take the legs to less motion than the upright pose needs, in any number of steps.
#[test]
fn free_coordinates_of_a_hexapod_move_its_legs_least() {
    let file = parse(catalogue::find("hexapod").unwrap().text).unwrap();
    let legs = file.mechanism.actuated_coordinates();
    let strokes = |motion: &DrivenMotion| -> f64 {
        legs.iter().map(|&k| end(motion)[k] * end(motion)[k]).sum()
    };
    for height in [0.1, -0.05] {
        let [free, finer] =
            [10, 40].map(|steps| to(&file, &format!("platform: move by [_, _, {height}]"), steps));
        let upright = format!("platform: turn 0 about [0, 0, 1]; move by [0, 0, {height}]");
        assert!(strokes(&free) < strokes(&to(&file, &upright, 10)));
        assert!((strokes(&free) - strokes(&finer)).abs() < 1e-9);
    }
}

/// A plate on three or four vertical legs with balls, with play along x and y at each ball; lengths in mm.
fn legs(places: &[[f64; 2]]) -> MechanismFile {
    let mut text = String::from(
        "kind = \"mechanism\"\nname = \"legs\"\nunits = { length = \"mm\", angle = \"deg\" }\nbase = \"floor\"\n",
    );
    for (i, [x, y]) in places.iter().enumerate() {
        let n = i + 1;
        text += &format!(
            "\n[[joint]]\nname = \"leg {n}\"\nkind = \"prismatic\"\nlinks = [\"floor\", \"post {n}\"]\npoint = [{x:?}, {y:?}, 400]\naxis = [0, 0, 1]\nactuated = true\nlimits = [-20, 20]\n\n[[joint]]\nname = \"ball {n}\"\nkind = \"spherical\"\nlinks = [\"post {n}\", \"top\"]\npoint = [{x:?}, {y:?}, 400]\n",
        );
        for (axis, along) in [("x", "[1, 0, 0]"), ("y", "[0, 1, 0]")] {
            text += &format!(
                "\n[[virtual_joint]]\nname = \"{axis}{n}\"\njoint = \"ball {n}\"\nslide = {along}\n"
            );
        }
    }
    text += "\n[[frame]]\nname = \"centre\"\nlink = \"top\"\npoint = [0, 0, 400]\n";
    parse(&text).unwrap()
}

/// A beam that is 12 µm longer than the distance of its columns, with play at one end; lengths in mm.
const LONG_BEAM: &str = r#"
kind = "mechanism"
name = "lift"
units = { length = "mm", angle = "deg" }
base = "frame"
[[joint]]
name = "left"
kind = "prismatic"
links = ["frame", "left column"]
frames = [{ point = [-200, 0, 0], axis = [0, 0, 1], zero = [1, 0, 0] }, { point = [0, 0, 0], axis = [0, 0, 1], zero = [1, 0, 0] }]
actuated = true
[[joint]]
name = "right"
kind = "prismatic"
links = ["frame", "right column"]
frames = [{ point = [200, 0, 0], axis = [0, 0, 1], zero = [1, 0, 0] }, { point = [0, 0, 0], axis = [0, 0, 1], zero = [1, 0, 0] }]
actuated = true
[[joint]]
name = "left pin"
kind = "revolute"
links = ["left column", "beam"]
frames = [{ point = [0, 0, 0], axis = [0, 1, 0], zero = [1, 0, 0] }, { point = [-200.006, 0, 0], axis = [0, 1, 0], zero = [1, 0, 0] }]
[[joint]]
name = "right pin"
kind = "revolute"
links = ["right column", "beam"]
frames = [{ point = [0, 0, 0], axis = [0, 1, 0], zero = [1, 0, 0] }, { point = [200.006, 0, 0], axis = [0, 1, 0], zero = [1, 0, 0] }]
[[virtual_joint]]
name = "play"
joint = "left pin"
on = "beam"
slide = [1, 0, 0]
clearance = 0.05
"#;

/// Rigid links of measured dimensions do not close; play takes up the rest, by the theorem of Pythagoras.
#[test]
fn play_closes_loops_of_measured_dimensions() {
    let file = parse(LONG_BEAM).unwrap();
    let joints = file.mechanism.joint_freedoms();
    let play = |left: f64| {
        let commands = [(0, left * 1e-3), (1, 0.0)];
        let commands = if left == 0.0 { &[][..] } else { &commands };
        let posed = pose_commanded(&file.mechanism, commands, None).unwrap();
        assert!(posed.closed.is_closed());
        posed.closed.coordinates[joints]
    };
    for left in [0.0, 1.0, 2.0, -3.0] {
        let expected = 0.400012 - 0.4_f64.hypot(left * 1e-3);
        assert!((play(left).abs() - expected).abs() < 1e-12, "{left}");
    }
    let home = close_at_rest(&file.mechanism, None).unwrap();
    assert_eq!(home.coordinates[joints], 0.0);
    assert!(home.coordinates.rows(0, joints).amax() < 1e-12);
    let relief = relieve_commanded(&file.mechanism, &[(0, 2e-3), (1, 0.0)], None).unwrap();
    assert!((relief.virtual_joints[0].abs() - (0.400012 - 0.4_f64.hypot(2e-3))).abs() < 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_tilted_plate_takes_the_legs_to_its_plane_and_the_free_height_moves_them_least(
        azimuth in -180.0..180.0_f64,
        angle in -3.0..3.0_f64,
        height in proptest::option::of(-5.0..5.0_f64),
        hx in 80.0..200.0_f64,
        hy in 80.0..200.0_f64,
    ) {
        let places = [[hx, hy], [-hx, hy], [-hx, -hy], [hx, -hy]];
        let file = legs(&places);
        let lift = height.map_or(String::new(), |h| format!("; move by [_, _, {h}]"));
        let text = format!("centre: tilt {angle} toward {azimuth}{lift}");
        let motion = to(&file, &text, 3);
        let found = end(&motion);
        // The balls lie in a plane of slope tan α that falls toward the azimuth; legs move least around the level of home.
        let slope = angle.to_radians().tan();
        let toward = [azimuth.to_radians().cos(), azimuth.to_radians().sin()];
        for (i, [x, y]) in places.iter().enumerate() {
            let expected = height.unwrap_or(0.0) - slope * (x * toward[0] + y * toward[1]);
            let leg = 1e3 * value(&file, found, &format!("leg {}", i + 1));
            prop_assert!((leg - expected).abs() < 1e-6, "{text}: leg {}: {leg} {expected}", i + 1);
        }
    }
}

#[test]
fn limits_stop_a_tilt_where_two_opposite_legs_reach_them() {
    let file = legs(&[[150.0, 100.0], [-150.0, 100.0], [-150.0, -100.0], [150.0, -100.0]]);
    let motion = to(&file, "centre: tilt 15 toward 30", 10);
    assert!(matches!(motion.stopped, Some(Stop::BeyondLimits { .. })));
    let most = (20.0 / (150.0 * 30_f64.to_radians().cos() + 100.0 * 0.5)).atan().to_degrees();
    let reached = 15.0 * motion.waypoints.last().unwrap().share;
    assert!((reached - most).abs() < 1e-5, "{reached} {most}");
}

#[test]
fn free_height_is_used_where_one_leg_is_at_its_limit() {
    // About x through legs 3 and 4: the other two would need 1.5 times their stroke if the middle stayed.
    let file = legs(&[[100.0, 300.0], [-100.0, 300.0], [-100.0, -50.0], [100.0, -50.0]]);
    let motion = to(&file, "centre: tilt 6 about [1, 0, 0]", 6);
    let found = end(&motion);
    let rise = 350.0 * 6_f64.to_radians().tan();
    let [one, three] = ["leg 1", "leg 3"].map(|leg| 1e3 * value(&file, found, leg));
    assert!((one - three - rise).abs() < 1e-5, "{one} {three} {rise}");
    assert!(one.abs() <= 20.0 + 1e-6 && three.abs() <= 20.0 + 1e-6);
}

#[test]
fn the_tilt_of_the_hexapod_moves_its_legs_least() {
    let file = parse(catalogue::find("hexapod").unwrap().text).unwrap();
    let mechanism = &file.mechanism;
    let start = home(mechanism);
    let motion = to(&file, "platform: tilt 5 about [1, 0.3, 0]", 6);
    let found = end(&motion);
    let motors = mechanism.actuated_coordinates();
    let size = |at: &DVector<f64>| -> f64 {
        motors.iter().map(|&k| (at[k] - start.home()[k]).powi(2)).sum::<f64>()
    };
    let frame = mechanism.frame("platform").unwrap();
    let pose_of = |at: &DVector<f64>| {
        start.kinematics().frame_pose(frame, &start.kinematics().link_poses(at).unwrap())
    };
    let pose = pose_of(found);
    let tilt =
        (pose.rotation * Vector3::z()).angle(&(pose_of(start.home()).rotation * Vector3::z()));
    assert!((tilt - 5_f64.to_radians()).abs() < 1e-9, "{tilt}");
    let least = size(found);
    assert!(least > 0.0);
    // Every neighbouring pose with this tilt takes more: full poses leave nothing to choose.
    let by = 1e-3;
    let rotated =
        |angle: f64| pose.rotation * Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    for (shift, angle) in [
        (Vector3::x() * by, 0.0),
        (-Vector3::x() * by, 0.0),
        (Vector3::y() * by, 0.0),
        (-Vector3::y() * by, 0.0),
        (Vector3::z() * by, 0.0),
        (-Vector3::z() * by, 0.0),
        (Vector3::zeros(), by),
        (Vector3::zeros(), -by),
    ] {
        let target = |pose: &Pose| FrameTarget {
            position: [0, 1, 2].map(|k| Some(pose.translation.vector[k])),
            orientation: OrientationTarget::Full(pose.rotation),
        };
        let other = Pose::from_parts((pose.translation.vector + shift).into(), rotated(angle));
        let path = FramePath { frame, targets: vec![target(&pose), target(&other)] };
        let near = drive_frames(&start, found, &[path], &mut |_| ()).unwrap();
        assert!((size(&near.waypoints[0].coordinates) - least).abs() < 1e-12);
        let more = size(end(&near));
        assert!(more > least, "{shift:?} {angle}: {more} {least}");
    }
}

#[test]
fn the_paper_s_robot_tilts_by_its_closed_form() {
    let file = parse(catalogue::find("gpr-mechanism").unwrap().text).unwrap();
    let motion = to(&file, "platform: tilt 1 about [1, 1, 0]", 4);
    let found = end(&motion);
    let rods = ["rod 1", "rod 2", "rod 3"].map(|rod| value(&file, found, rod));
    // Rods at 0°, 120° and 240° about the axis, the sum of their strokes is least at zero.
    assert!(rods.iter().sum::<f64>().abs() < 1e-12, "{rods:?}");
    let toward = -45_f64.to_radians();
    for (rod, at) in rods.iter().zip([0.0_f64, 120.0, 240.0]) {
        let expected = -93.218e-3 * 1_f64.to_radians().tan() * (at.to_radians() - toward).cos();
        assert!((rod - expected).abs() < 1e-9, "{rod} {expected}");
    }
}
