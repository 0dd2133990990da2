//! Calls of the C interface with any text and any numbers neither crash nor read or write out of bounds.

#![no_main]

use std::ffi::CString;
use std::ptr::null_mut;

use jointplay_c::*;
use libfuzzer_sys::fuzz_target;

/// Coordinates of the largest mechanism that is moved.
const MOST: usize = 64;

fuzz_target!(|input: (Vec<f64>, i32, &str, &str)| {
    let (numbers, virtualization, toml, request) = input;
    let (Ok(toml), Ok(request)) = (CString::new(toml), CString::new(request)) else { return };
    let mut given = [0.25; MOST];
    given.iter_mut().zip(numbers).for_each(|(to, number)| *to = number);
    let (mut robot, mut mechanism, mut answer) = (null_mut(), null_mut(), null_mut());
    let (mut pose, mut joints, mut tilt) = ([0.0; 16], [0.0; JP_MAX_VIRTUAL_JOINTS], [0.0; 3]);
    // SAFETY: valid texts, room for all results.
    unsafe {
        if jp_robot_parse(toml.as_ptr(), &raw mut robot) != JP_OK {
            jp_robot_paper(&raw mut robot);
        }
        let (pose, joints, tilt) = (pose.as_mut_ptr(), joints.as_mut_ptr(), tilt.as_mut_ptr());
        jp_robot_forward(robot, virtualization, given.as_ptr(), pose, joints, tilt);
        jp_robot_json(robot, request.as_ptr(), &raw mut answer);
        jp_text_free(answer);
        jp_robot_free(robot);
        if jp_mechanism_parse(toml.as_ptr(), &raw mut mechanism) == JP_OK {
            let links = jp_mechanism_link_count(mechanism);
            if jp_mechanism_coordinate_count(mechanism) <= MOST {
                let mut positions = [0.0; MOST];
                let mut poses = vec![0.0; 16 * links];
                jp_mechanism_home(mechanism, positions.as_mut_ptr());
                jp_mechanism_positions(mechanism, given.as_ptr(), positions.as_mut_ptr());
                jp_mechanism_link_poses(mechanism, given.as_ptr(), poses.as_mut_ptr());
            }
            answer = null_mut();
            jp_mechanism_json(mechanism, request.as_ptr(), &raw mut answer);
            jp_text_free(answer);
        }
        jp_mechanism_free(mechanism);
    }
});
