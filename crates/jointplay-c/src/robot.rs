//! The three-rod robot.

use std::ffi::{CString, c_char};

use jointplay::format::robot;
use jointplay::gpr::{AxisHeight, Gpr, PlatformPose};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{
    Offset, Planar, Polar, Radial, SolveOptions, VirtualJoints, Virtualization,
};

use crate::catch::{Failure, entry, value};
use crate::pointer::{finite, give, numbers, object, take, text, writable, write};
use crate::request;

/// Radial virtual joints, three.
pub const JP_RADIAL: i32 = 0;
/// Polar virtual joints, six.
pub const JP_POLAR: i32 = 1;
/// Offset virtual joints, six.
pub const JP_OFFSET: i32 = 2;
/// Planar virtual joints, six.
pub const JP_PLANAR: i32 = 3;
/// The most virtual joints that one of the virtualizations has.
pub const JP_MAX_VIRTUAL_JOINTS: usize = 6;

/// A three-rod robot. It never changes: any number of threads may use it at a time.
pub struct JpRobot {
    gpr: Gpr,
}

/// A pose of the platform.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JpPose {
    /// Homogeneous transform from the platform's frame to the base, by rows (m).
    pub base_from_platform: [f64; 16],
    /// Displacements of the virtual joints from nominal (m, rad); zero beyond their number.
    pub virtual_joints: [f64; JP_MAX_VIRTUAL_JOINTS],
    /// Number of virtual joints.
    pub virtual_joint_count: usize,
    /// Tilt direction: azimuth of the platform's normal (rad).
    pub azimuth: f64,
    /// Tilt angle (rad).
    pub tilt: f64,
    /// Height at which the platform plane crosses the base axis (m).
    pub axis_height: f64,
}

/// Runs an expression with the chosen virtualization as its type, so that nothing is decided in the loops.
macro_rules! with_virtualization {
    ($chosen:expr, $name:ident => $body:expr) => {
        match $chosen {
            JP_RADIAL => {
                let $name = &Radial;
                $body
            }
            JP_POLAR => {
                let $name = &Polar;
                $body
            }
            JP_OFFSET => {
                let $name = &Offset;
                $body
            }
            JP_PLANAR => {
                let $name = &Planar;
                $body
            }
            other => Err(unknown(other)),
        }
    };
}

#[cold]
fn unknown(virtualization: i32) -> Failure {
    Failure::input(format!(
        "virtualization {virtualization} is not known; known: 0 radial, 1 polar, 2 offset, 3 planar"
    ))
}

/// The robot of the paper: three sockets 120° apart on a radius of 93.218 mm.
///
/// # Safety
/// `robot` is NULL or has room for a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_paper(robot: *mut *mut JpRobot) -> i32 {
    entry(|| {
        writable(robot, "robot")?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { give(robot, JpRobot { gpr: robot::paper().gpr }) };
        Ok(())
    })
}

/// The robot of the text of a robot file (TOML).
///
/// # Safety
/// `toml` is NULL or ended by NUL; `robot` is NULL or has room for a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_parse(toml: *const c_char, robot: *mut *mut JpRobot) -> i32 {
    entry(|| {
        writable(robot, "robot")?;
        // SAFETY: the caller promises the NUL.
        let toml = unsafe { text(toml, "toml") }?;
        let read = robot::parse(toml);
        let read = read.map_err(|errors| Failure::input(errors.with_excerpt("text")))?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { give(robot, JpRobot { gpr: read.gpr }) };
        Ok(())
    })
}

/// Frees a robot; NULL does nothing.
///
/// # Safety
/// `robot` is NULL or from this library, and no thread uses it any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_free(robot: *mut JpRobot) {
    // SAFETY: the caller's promise.
    value((), || unsafe { take(robot) });
}

/// Working height of the robot (m); NaN for NULL.
///
/// # Safety
/// `robot` is NULL or a robot.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_working_height(robot: *const JpRobot) -> f64 {
    value(f64::NAN, || {
        // SAFETY: the caller promises a robot.
        let robot = unsafe { object(robot, "robot") };
        robot.map_or(f64::NAN, |robot| robot.gpr.working_height())
    })
}

/// Rod lengths (m) for a tilt (rad) and an axis height (m).
///
/// # Safety
/// `robot` is NULL or a robot; `rods` is NULL or has room for 3 numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_inverse(
    robot: *const JpRobot,
    azimuth: f64,
    tilt: f64,
    height: f64,
    rods: *mut f64,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a robot.
        let robot = unsafe { object(robot, "robot") }?;
        writable(rods, "rods")?;
        finite(&[azimuth, tilt, height], "(azimuth, tilt, height)")?;
        let found = robot.gpr.inverse(Tilt { azimuth, angle: tilt }, AxisHeight(height))?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(rods, &found) };
        Ok(())
    })
}

/// Pose of the platform for rod lengths (m).
///
/// # Safety
/// `robot` is NULL or a robot; `rods` is NULL or 3 numbers; `pose` is NULL or has room for a pose.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_forward(
    robot: *const JpRobot,
    virtualization: i32,
    rods: *const f64,
    pose: *mut JpPose,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a robot.
        let gpr = &unsafe { object(robot, "robot") }?.gpr;
        writable(pose, "pose")?;
        // SAFETY: the caller promises 3 numbers.
        let rods = unsafe { numbers::<3>(rods, "rods") }?;
        let found = with_virtualization!(virtualization, v => {
            let found = gpr.forward(rods, v, &SolveOptions::default())?;
            Ok(pose_of(gpr, &found, v))
        })?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { pose.write(found) };
        Ok(())
    })
}

#[inline]
fn pose_of<V: Virtualization>(gpr: &Gpr, pose: &PlatformPose, virtualization: &V) -> JpPose {
    let x = &pose.solution.virtual_joints;
    let mut nominal = VirtualJoints::zeros(x.len());
    virtualization.nominal(gpr.platform(), &mut nominal);
    let mut virtual_joints = [0.0; JP_MAX_VIRTUAL_JOINTS];
    for (to, (x, nominal)) in virtual_joints.iter_mut().zip(x.iter().zip(nominal.iter())) {
        *to = x - nominal;
    }
    let tilt = pose.tilt();
    JpPose {
        base_from_platform: request::rows(&pose.base_from_platform),
        virtual_joints,
        virtual_joint_count: x.len(),
        azimuth: tilt.azimuth,
        tilt: tilt.angle,
        axis_height: pose.axis_height().0,
    }
}

/// Which limits rod lengths (m) break: each rod, then the tilt; 1 is broken, 0 not. `JP_OK` either way.
///
/// # Safety
/// `robot` is NULL or a robot; `rods` is NULL or 3 numbers; `broken` is NULL or has room for 4.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_limits(
    robot: *const JpRobot,
    rods: *const f64,
    broken: *mut i32,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a robot.
        let gpr = &unsafe { object(robot, "robot") }?.gpr;
        writable(broken, "broken")?;
        // SAFETY: the caller promises 3 numbers.
        let rods = unsafe { numbers::<3>(rods, "rods") }?;
        let found = gpr.limits().broken(&rods, gpr.plane_tilt(&rods));
        let [q_1, q_2, q_3] = found.rods();
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(broken, &[q_1, q_2, q_3, found.tilt()].map(i32::from)) };
        Ok(())
    })
}

/// Geometric Jacobian of the platform's frame for rod lengths (m): 6 rows of 3 numbers, angular velocity, then velocity of its origin, for unit rates of the rods.
///
/// `virtual_joints`, if not NULL, gets `JP_MAX_VIRTUAL_JOINTS` rows of 3 numbers: the rates of the virtual joints, zero beyond their number.
///
/// # Safety
/// `robot` is NULL or a robot; `rods` is NULL or 3 numbers; `jacobian` and `virtual_joints` are NULL or have room for 18.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_jacobian(
    robot: *const JpRobot,
    virtualization: i32,
    rods: *const f64,
    jacobian: *mut f64,
    virtual_joints: *mut f64,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a robot.
        let gpr = &unsafe { object(robot, "robot") }?.gpr;
        writable(jacobian, "jacobian")?;
        // SAFETY: the caller promises 3 numbers.
        let rods = unsafe { numbers::<3>(rods, "rods") }?;
        let found = with_virtualization!(virtualization, v => {
            let pose = gpr.forward(rods, v, &SolveOptions::default())?;
            Ok(gpr.platform_jacobian(&pose, v)?)
        })?;
        let mut rows = [0.0; 18];
        let mut rates = [0.0; 3 * JP_MAX_VIRTUAL_JOINTS];
        for k in 0..3 {
            (0..6).for_each(|i| rows[3 * i + k] = found.matrix[(i, k)]);
            for (m, rate) in found.virtual_joints[k].iter().enumerate() {
                rates[3 * m + k] = *rate;
            }
        }
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(jacobian, &rows) };
        if !virtual_joints.is_null() {
            // SAFETY: not NULL, and the caller promises room.
            unsafe { write(virtual_joints, &rates) };
        }
        Ok(())
    })
}

/// Any other question as JSON: `{"kind": "mobility"}` or `{"kind": "sensitivity", "tilt_rad": 0.02}`.
///
/// The answer is the document of the command of the same name, to be freed by `jp_text_free`.
///
/// # Safety
/// `robot` is NULL or a robot; `request` is NULL or ended by NUL; `answer` is NULL or has room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_json(
    robot: *const JpRobot,
    request: *const c_char,
    answer: *mut *mut c_char,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a robot.
        let robot = unsafe { object(robot, "robot") }?;
        writable(answer, "answer")?;
        // SAFETY: the caller promises the NUL.
        let request = unsafe { text(request, "request") }?;
        let document = request::of_robot(&robot.gpr, request)?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { answer.write(document.into_raw()) };
        Ok(())
    })
}

/// Frees an answer; NULL does nothing.
///
/// # Safety
/// `text` is NULL, or an answer of this library that is used nowhere any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_text_free(text: *mut c_char) {
    if !text.is_null() {
        // SAFETY: the caller's promise.
        drop(unsafe { CString::from_raw(text) });
    }
}
