//! Calls as a C program makes them: results, errors, invalid input.
#![expect(clippy::unwrap_used, reason = "a test may fail at this place")]

use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

use jointplay::format::mechanism;
use jointplay::gpr::Gpr;
use jointplay::mechanism::relieve_commanded;
use jointplay::spatial::Tilt;
use jointplay::virtualization::{Planar, Polar, Radial, SolveOptions};
use jointplay_c::*;

const RODS: [f64; 3] = [0.4977, 0.5005, 0.5018];

fn paper() -> *mut JpRobot {
    let mut robot = null_mut();
    // SAFETY: room for a handle.
    assert_eq!(unsafe { jp_robot_paper(&raw mut robot) }, JP_OK);
    robot
}

fn catalogue(name: &str) -> *mut JpMechanism {
    let (mut found, name) = (null_mut(), CString::new(name).unwrap());
    // SAFETY: a text and room for a handle.
    assert_eq!(unsafe { jp_mechanism_catalogue(name.as_ptr(), &raw mut found) }, JP_OK);
    found
}

fn last_error() -> String {
    let mut text = [0; 1000];
    // SAFETY: room for as many bytes.
    unsafe { jp_last_error(text.as_mut_ptr(), text.len()) };
    // SAFETY: ended by NUL.
    unsafe { CStr::from_ptr(text.as_ptr()) }.to_str().unwrap().to_owned()
}

/// Entries of poses and displacements agree to 10⁻¹² of the size of the platform.
#[track_caller]
fn assert_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() < 1e-12 || a.is_nan() && b.is_nan(), "{k}: {a:e}, {b:e}");
    }
}

#[test]
fn poses_of_the_robot_are_those_of_the_library() {
    let (gpr, robot, options) = (Gpr::paper(), paper(), SolveOptions::default());
    let (mut pose, mut joints, mut tilt) = ([0.0; 16], [0.0; 6], [0.0; 3]);
    for virtualization in [JP_RADIAL, JP_POLAR, JP_OFFSET, JP_PLANAR] {
        // SAFETY: room for all.
        let code = unsafe {
            let (pose, joints, tilt) = (pose.as_mut_ptr(), joints.as_mut_ptr(), tilt.as_mut_ptr());
            jp_robot_forward(robot, virtualization, RODS.as_ptr(), pose, joints, tilt)
        };
        assert_eq!(code, JP_OK);
        let found = match virtualization {
            JP_RADIAL => gpr.forward(RODS, &Radial, &options),
            JP_POLAR => gpr.forward(RODS, &Polar, &options),
            JP_PLANAR => gpr.forward(RODS, &Planar, &options),
            _ => continue,
        }
        .unwrap();
        let expected = found.base_from_platform.to_homogeneous().transpose();
        assert_close(&pose, expected.as_slice());
        let Tilt { azimuth, angle } = found.tilt();
        assert_eq!(tilt, [azimuth, angle, found.axis_height().0]);
        let count = jp_virtual_joint_count(virtualization);
        assert!(joints[count..].iter().all(|&x| x == 0.0));
        assert!(joints[..count].iter().all(|x| x.abs() < 1e-3), "displacements from nominal");
    }
    // A radial virtual joint of this pose is displaced by some 40 µm.
    let forward = |joints: *mut f64| {
        // SAFETY: room for all.
        unsafe { jp_robot_forward(robot, JP_RADIAL, RODS.as_ptr(), null_mut(), joints, null_mut()) }
    };
    assert_eq!(forward(joints.as_mut_ptr()), JP_OK);
    assert!(joints[0].abs() > 1e-6);
    // SAFETY: not used after this.
    unsafe { jp_robot_free(robot) };
}

/// Whole and begun blocks of sets, with sets without a pose at their ends and among others.
#[test]
fn many_poses_are_those_of_as_many_calls() {
    let robot = paper();
    for virtualization in [JP_RADIAL, JP_POLAR, JP_OFFSET, JP_PLANAR] {
        for count in [0, 1, 7, 239, 240, 241, 1000] {
            let fraction = |k: usize, step: f64| (k as f64 * step).fract();
            let mut sets: Vec<[f64; 3]> = (0..count)
                .map(|k| [0.618_034, 0.414_214, 0.732_051].map(|s| 0.497 + 0.006 * fraction(k, s)))
                .collect();
            for (k, invalid) in [(3, f64::NAN), (239, 0.9), (240, f64::INFINITY), (777, 0.2)] {
                if let Some(set) = sets.get_mut(k) {
                    set[k % 3] = invalid;
                }
            }
            let (mut poses, mut joints) = (vec![7.0; 16 * count], vec![7.0; 6 * count]);
            let mut codes = vec![9; count];
            let rods = sets.as_flattened().as_ptr();
            // SAFETY: room for all.
            let code = unsafe {
                let (poses, codes) = (poses.as_mut_ptr(), codes.as_mut_ptr());
                let joints = joints.as_mut_ptr();
                jp_robot_forward_many(robot, virtualization, count, rods, poses, joints, codes)
            };
            let (text, mut first) = (last_error(), JP_OK);
            for (k, set) in sets.iter().enumerate() {
                let (mut pose, mut displaced) = ([f64::NAN; 16], [f64::NAN; 6]);
                // SAFETY: room for all.
                let code = unsafe {
                    let (pose, displaced) = (pose.as_mut_ptr(), displaced.as_mut_ptr());
                    jp_robot_forward(
                        robot,
                        virtualization,
                        set.as_ptr(),
                        pose,
                        displaced,
                        null_mut(),
                    )
                };
                assert_eq!(codes[k], code, "set {k} of {count}");
                assert_close(&poses[16 * k..][..16], &pose);
                assert_close(&joints[6 * k..][..6], &displaced);
                first = if first == JP_OK { code } else { first };
            }
            assert_eq!(code, first, "{count} sets");
            if count > 3 {
                assert!(text.starts_with("set 3: rods[0] is NaN"), "{text}");
            }
        }
    }
    // SAFETY: not used after this.
    unsafe { jp_robot_free(robot) };
}

#[test]
fn inverse_kinematics_and_many_poses() {
    let robot = paper();
    let mut rods = [0.0; 3];
    // SAFETY: room for all.
    assert_eq!(unsafe { jp_robot_inverse(robot, 0.3, 0.02, 0.5, rods.as_mut_ptr()) }, JP_OK);
    let (mut poses, mut codes, mut tilt) = ([0.0; 48], [9; 3], [0.0; 3]);
    let sets = [rods, [f64::NAN, 0.5, 0.5], [0.9, 0.5, 0.5]].concat();
    // SAFETY: room for all.
    let code = unsafe {
        let (poses, codes) = (poses.as_mut_ptr(), codes.as_mut_ptr());
        jp_robot_forward_many(robot, JP_PLANAR, 3, sets.as_ptr(), poses, null_mut(), codes)
    };
    assert_eq!((code, codes), (JP_BAD_INPUT, [JP_OK, JP_BAD_INPUT, JP_NO_ANSWER]));
    assert!(last_error().starts_with("set 1: rods[0] is NaN"), "{}", last_error());
    assert!(poses[16..].iter().all(|x| x.is_nan()));
    let mut one = [0.0; 16];
    // SAFETY: room for all.
    let code = unsafe {
        let (one, tilt) = (one.as_mut_ptr(), tilt.as_mut_ptr());
        jp_robot_forward(robot, JP_PLANAR, rods.as_ptr(), one, null_mut(), tilt)
    };
    assert_eq!(code, JP_OK);
    assert_close(&one, &poses[..16]);
    for (found, expected) in tilt.into_iter().zip([0.3, 0.02, 0.5]) {
        assert!((found - expected).abs() < 1e-12);
    }
    let mut exceeded = [7; 4];
    // SAFETY: room for all.
    unsafe { jp_robot_limits(robot, [0.9, 0.5, 0.5].as_ptr(), exceeded.as_mut_ptr()) };
    assert_eq!((exceeded[0], exceeded[1], exceeded[2], exceeded[3]), (1, 0, 0, 1));
    // SAFETY: not used after this.
    unsafe { jp_robot_free(robot) };
}

#[test]
fn jacobians_are_differences_of_poses() {
    let robot = paper();
    let (mut jacobian, mut rates) = ([0.0; 18], [0.0; 18]);
    // SAFETY: room for all.
    let code = unsafe {
        let (jacobian, rates) = (jacobian.as_mut_ptr(), rates.as_mut_ptr());
        jp_robot_jacobian(robot, JP_POLAR, RODS.as_ptr(), jacobian, rates)
    };
    assert_eq!(code, JP_OK);
    let at = |rods: [f64; 3]| {
        let (mut pose, mut joints) = ([0.0; 16], [0.0; 6]);
        // SAFETY: room for all.
        unsafe {
            let (pose, joints) = (pose.as_mut_ptr(), joints.as_mut_ptr());
            jp_robot_forward(robot, JP_POLAR, rods.as_ptr(), pose, joints, null_mut());
        }
        (pose, joints)
    };
    const STEP: f64 = 1e-6;
    for k in 0..3 {
        let (mut more, mut less) = (RODS, RODS);
        more[k] += STEP;
        less[k] -= STEP;
        let ((more, more_joints), (less, less_joints)) = (at(more), at(less));
        for i in 0..3 {
            let slope = (more[4 * i + 3] - less[4 * i + 3]) / (2.0 * STEP);
            assert!((slope - jacobian[3 * (3 + i) + k]).abs() < 1e-7);
        }
        for i in 0..6 {
            let slope = (more_joints[i] - less_joints[i]) / (2.0 * STEP);
            assert!((slope - rates[3 * i + k]).abs() < 1e-7);
        }
    }
    // SAFETY: not used after this.
    unsafe { jp_robot_free(robot) };
}

#[test]
fn a_relieved_mechanism_moves_by_its_drives() {
    let robot = catalogue("gpr-mechanism");
    // SAFETY: a mechanism.
    let (count, links, drives) = unsafe {
        (
            jp_mechanism_coordinate_count(robot),
            jp_mechanism_link_count(robot),
            jp_mechanism_drive_count(robot),
        )
    };
    assert_eq!(drives, 3);
    let mut home = vec![0.0; count];
    // SAFETY: room for all coordinates.
    assert_eq!(unsafe { jp_mechanism_home(robot, home.as_mut_ptr()) }, JP_OK);
    let values = [-0.002, 0.0005, 0.0018];
    let mut positions = home.clone();
    let solve = |positions: &mut Vec<f64>, values: &[f64; 3]| {
        // SAFETY: a value for each drive, room for all coordinates.
        unsafe { jp_mechanism_positions(robot, values.as_ptr(), positions.as_mut_ptr()) }
    };
    assert_eq!(solve(&mut positions, &values), JP_OK, "{}", last_error());
    let file = mechanism::parse(jointplay::format::catalogue::find("gpr-mechanism").unwrap().text);
    let file = file.unwrap();
    let commands: Vec<(usize, f64)> =
        file.mechanism.actuated_coordinates().into_iter().zip(values).collect();
    let relief = relieve_commanded(&file.mechanism, &commands, None).unwrap();
    for (found, expected) in positions.iter().zip(relief.coordinates.iter()) {
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }
    let poses = |positions: &[f64]| {
        let mut poses = vec![0.0; 16 * links];
        // SAFETY: all coordinates, room for all links.
        let code =
            unsafe { jp_mechanism_link_poses(robot, positions.as_ptr(), poses.as_mut_ptr()) };
        assert_eq!(code, JP_OK);
        poses
    };
    // The Jacobian of the last link is the difference of its poses.
    let (mut jacobian, mut rates) = (vec![0.0; 18], vec![0.0; 3 * count]);
    let link = links - 1;
    // SAFETY: room for 6 and `count` rows of 3.
    let code = unsafe {
        let (jacobian, rates) = (jacobian.as_mut_ptr(), rates.as_mut_ptr());
        jp_mechanism_jacobian(robot, positions.as_ptr(), link, jacobian, rates)
    };
    assert_eq!(code, JP_OK, "{}", last_error());
    const STEP: f64 = 1e-5;
    for k in 0..3 {
        let at = |sign: f64| {
            let (mut values, mut near) = (values, positions.clone());
            values[k] += sign * STEP;
            assert_eq!(solve(&mut near, &values), JP_OK);
            near
        };
        let (more, less) = (at(1.0), at(-1.0));
        for i in 0..3 {
            let place = 16 * link + 4 * i + 3;
            let slope = (poses(&more)[place] - poses(&less)[place]) / (2.0 * STEP);
            assert!((slope - jacobian[3 * (3 + i) + k]).abs() < 1e-5, "{slope}");
        }
        // SAFETY: a mechanism.
        for i in unsafe { jp_mechanism_joint_coordinate_count(robot) }..count {
            let slope = (more[i] - less[i]) / (2.0 * STEP);
            assert!((slope - rates[3 * i + k]).abs() < 1e-5, "{slope}");
        }
    }
    // Beyond the limits of the rods nothing is written.
    let mut beyond = positions.clone();
    assert_eq!(solve(&mut beyond, &[10.0, 0.0, 0.0]), JP_NO_ANSWER);
    assert_eq!(beyond, positions);
    assert_eq!(solve(&mut beyond, &[f64::NAN, 0.0, 0.0]), JP_BAD_INPUT);
    // SAFETY: a mechanism and a link that it does not have.
    let code = unsafe {
        let jacobian = jacobian.as_mut_ptr();
        jp_mechanism_jacobian(robot, positions.as_ptr(), links, jacobian, null_mut())
    };
    assert_eq!(code, JP_BAD_INPUT);
    // SAFETY: not used after this.
    unsafe { jp_mechanism_free(robot) };
}

#[test]
fn a_mechanism_serves_many_threads() {
    struct Shared(*const JpMechanism);
    // SAFETY: mechanisms may be shared.
    unsafe impl Sync for Shared {}
    let mechanism = Shared(catalogue("four-bar"));
    let shared = &mechanism;
    let solve = |angle: f64| {
        let mut positions = [0.0; 16];
        // SAFETY: a mechanism, and room for its coordinates.
        unsafe {
            assert!(jp_mechanism_coordinate_count(shared.0) <= positions.len());
            assert_eq!(jp_mechanism_home(shared.0, positions.as_mut_ptr()), JP_OK);
            let code = jp_mechanism_positions(shared.0, &raw const angle, positions.as_mut_ptr());
            assert_eq!(code, JP_OK, "{}", last_error());
        }
        positions
    };
    let expected: Vec<_> = (0..20).map(|i| solve(0.01 * f64::from(i))).collect();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                for (i, expected) in (0..).zip(&expected) {
                    assert_eq!(solve(0.01 * f64::from(i)), *expected);
                }
                // Errors are of the thread.
                assert_eq!(last_error(), "");
            });
        }
    });
    // SAFETY: not used after this.
    unsafe { jp_mechanism_free(mechanism.0.cast_mut()) };
}

#[test]
fn null_and_unknown_input_are_errors() {
    let robot = paper();
    let mut numbers = [0.0; 18];
    let numbers = numbers.as_mut_ptr();
    let unknown = CString::new("nothing").unwrap();
    let not_utf8 = c"\xff";
    let (mut other, mut mechanism, mut answer) = (null_mut(), null_mut(), null_mut());
    // SAFETY: NULL is allowed everywhere; all else is valid.
    let codes = unsafe {
        [
            jp_robot_paper(null_mut()),
            jp_robot_parse(null(), &raw mut other),
            jp_robot_inverse(null(), 0.0, 0.0, 0.5, numbers),
            jp_robot_inverse(robot, 0.0, 0.0, 0.5, null_mut()),
            jp_robot_inverse(robot, f64::INFINITY, 0.0, 0.5, numbers),
            jp_robot_forward(robot, 4, RODS.as_ptr(), numbers, null_mut(), null_mut()),
            jp_robot_forward(robot, -1, RODS.as_ptr(), numbers, null_mut(), null_mut()),
            jp_robot_forward(robot, JP_PLANAR, null(), numbers, null_mut(), null_mut()),
            jp_robot_forward_many(robot, 0, 1, null(), numbers, null_mut(), null_mut()),
            jp_robot_limits(robot, RODS.as_ptr(), null_mut()),
            jp_robot_jacobian(null(), 0, RODS.as_ptr(), numbers, null_mut()),
            jp_robot_json(robot, null(), &raw mut answer),
            jp_robot_json(robot, unknown.as_ptr(), &raw mut answer),
            jp_mechanism_parse(unknown.as_ptr(), &raw mut mechanism),
            jp_mechanism_parse(not_utf8.as_ptr(), &raw mut mechanism),
            jp_mechanism_catalogue(unknown.as_ptr(), &raw mut mechanism),
            jp_mechanism_home(null(), numbers),
            jp_mechanism_positions(null(), numbers, numbers),
            jp_mechanism_link_poses(null(), numbers, numbers),
            jp_mechanism_jacobian(null(), numbers, 0, numbers, null_mut()),
            jp_mechanism_json(null(), unknown.as_ptr(), &raw mut answer),
        ]
    };
    assert_eq!(codes, [JP_BAD_INPUT; 21]);
    assert!(other.is_null() && mechanism.is_null() && answer.is_null());
    assert_eq!(last_error(), "mechanism is NULL");
    // SAFETY: NULL is allowed.
    unsafe {
        assert!(jp_robot_working_height(null()).is_nan());
        assert_eq!(jp_mechanism_coordinate_count(null()), 0);
        assert!(jp_mechanism_link_name(null(), 0).is_null());
        assert_eq!(jp_mechanism_coordinate_is_angle(null(), 0), -1);
        jp_robot_free(null_mut());
        jp_mechanism_free(null_mut());
        jp_text_free(null_mut());
        // A short buffer gets the start of the text, ended by NUL.
        let mut short = [1; 5];
        assert_eq!(jp_last_error(short.as_mut_ptr(), 5), "mechanism is NULL".len() + 1);
        assert_eq!(CStr::from_ptr(short.as_ptr()), c"mech");
        assert_eq!(jp_last_error(null_mut(), 0), "mechanism is NULL".len() + 1);
        assert_eq!(CStr::from_ptr(jp_version()).to_str().unwrap(), env!("CARGO_PKG_VERSION"));
        jp_robot_free(robot);
    }
}

/// The answer to a request about the robot, or the error.
fn asked(robot: *const JpRobot, request: &str) -> Result<String, String> {
    let (request, mut answer) = (CString::new(request).unwrap(), null_mut());
    // SAFETY: a robot, a text, and room for an answer, which is freed once.
    unsafe {
        if jp_robot_json(robot, request.as_ptr(), &raw mut answer) != JP_OK {
            return Err(last_error());
        }
        let text = CStr::from_ptr(answer).to_str().unwrap().to_owned();
        jp_text_free(answer);
        Ok(text)
    }
}

/// Before, these were words of Rust without the field.
#[test]
fn errors_of_requests_name_the_field_what_it_is_and_what_is_allowed() {
    let robot = paper();
    for (request, message) in [
        (
            "[]",
            "request: expected an object with a `kind` of \"forward\", \"inverse\", \"mobility\", \"sensitivity\", got a list",
        ),
        (r#"{"kind": "forward"}"#, "request: missing field `rods_m`"),
        (
            r#"{"kind": "forward", "rods_m": [0.5, true, 0.5]}"#,
            "request: `rods_m[1]`: expected a number, got true",
        ),
        (
            r#"{"kind": "inverse", "tilt_ra": 0.01}"#,
            "request: `tilt_ra`: unknown field `tilt_ra` (did you mean `tilt_rad`?); known: azimuth_rad, tilt_rad, height_m, virtualization",
        ),
        (
            r#"{"kind": "inverse", "tilt_rad": 0.01, "tilt_rad": 0.02}"#,
            "request: not valid JSON: \"tilt_rad\" is given twice",
        ),
    ] {
        let error = asked(robot, request).err().unwrap();
        assert!(error.starts_with(message), "{error}");
    }
    assert!(asked(robot, r#"{"kind": "inverse", "tilt_rad": 0.01, "height_m": null}"#).is_ok());
    // SAFETY: not used after this.
    unsafe { jp_robot_free(robot) };
}

/// Buffers of bytes and packed structures have numbers at any address.
#[test]
fn pointers_need_not_be_aligned() {
    let robot = paper();
    let (mut rods, mut poses) = ([0_u8; 3 * 8 * 2 + 1], [0_u8; 16 * 8 * 2 + 1]);
    for (bytes, number) in rods[1..].chunks_exact_mut(8).zip(RODS.into_iter().chain(RODS)) {
        bytes.copy_from_slice(&number.to_ne_bytes());
    }
    let given: *const f64 = rods[1..].as_ptr().cast();
    let to: *mut f64 = poses[1..].as_mut_ptr().cast();
    let mut codes = [0_u8; 2 * 4 + 1];
    let code: *mut i32 = codes[1..].as_mut_ptr().cast();
    let mut expected = [0.0; 16];
    // SAFETY: room for all results, at any address.
    unsafe {
        let pose = expected.as_mut_ptr();
        assert_eq!(
            jp_robot_forward(robot, JP_POLAR, RODS.as_ptr(), pose, null_mut(), null_mut()),
            JP_OK
        );
        assert_eq!(jp_robot_forward_many(robot, JP_POLAR, 2, given, to, null_mut(), code), JP_OK);
    }
    let found = |bytes: &[u8]| -> Vec<f64> {
        bytes.chunks_exact(8).map(|b| f64::from_ne_bytes(b.try_into().unwrap())).collect()
    };
    assert_close(&found(&poses[1..129]), &expected);
    assert_close(&found(&poses[129..]), &expected);
    // SAFETY: as above.
    let one = unsafe { jp_robot_forward(robot, JP_POLAR, given, to, null_mut(), null_mut()) };
    assert_eq!(one, JP_OK);
    assert_close(&found(&poses[1..129]), &expected);
    // SAFETY: as above.
    assert_eq!(unsafe { jp_robot_inverse(robot, 0.1, 0.01, 0.5, to) }, JP_OK);
    // SAFETY: nothing is read or written for a count that no memory has.
    let all =
        unsafe { jp_robot_forward_many(robot, JP_POLAR, usize::MAX, given, to, null_mut(), code) };
    assert_eq!(all, JP_BAD_INPUT);
    assert!(last_error().contains("no memory has"), "{}", last_error());
    // SAFETY: used nowhere any more.
    unsafe { jp_robot_free(robot) };
}
