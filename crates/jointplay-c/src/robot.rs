//! The three-rod robot.

use std::ffi::c_char;
use std::sync::OnceLock;

use jointplay::bulk::PoseSolver;
use jointplay::format::robot::{self, Robot};
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{BuiltIn, SolveOptions};

use crate::block::{BLOCK, Block};
use crate::catch::{Failure, entry, value};
use crate::pointer::{finite, give, in_memory, numbers, object, take, text, writable, write};
use crate::request;
use crate::status::JP_OK;
use crate::transform::{ENTRIES, entries};
use crate::virtualization::{JP_MAX_VIRTUAL_JOINTS, KNOWN, known};

/// A three-rod robot. It never changes: any number of threads may use it at a time.
pub struct JpRobot {
    gpr: Gpr,
    /// Options of every solution.
    options: SolveOptions,
    /// Forward kinematics of each virtualization, prepared at its first call.
    solvers: [OnceLock<PoseSolver>; KNOWN.len()],
}

impl JpRobot {
    fn new(robot: Robot) -> Self {
        let solvers = KNOWN.map(|_| OnceLock::new());
        Self { gpr: robot.gpr, options: SolveOptions::default(), solvers }
    }

    /// A virtualization by its code, and forward kinematics under it.
    #[inline]
    fn solver(&self, code: i32) -> Result<(BuiltIn, &PoseSolver), Failure> {
        let (index, chosen) = known(code)?;
        match self.solvers[index].get() {
            Some(solver) => Ok((chosen, solver)),
            None => Ok((chosen, self.prepared(index)?)),
        }
    }

    #[cold]
    fn prepared(&self, index: usize) -> Result<&PoseSolver, Failure> {
        let solver = PoseSolver::new(&self.gpr, KNOWN[index], &self.options)?;
        Ok(self.solvers[index].get_or_init(|| solver))
    }
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
        unsafe { give(robot, JpRobot::new(robot::paper())) };
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
        unsafe { give(robot, JpRobot::new(read)) };
        Ok(())
    })
}

/// Frees a robot; NULL does nothing.
///
/// # Safety
/// `robot` is NULL, or a robot that is not used after this call.
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

/// Pose of the platform for 3 rod lengths (m).
///
/// `pose` takes the homogeneous transform from the frame of the platform to the base frame, 16 numbers by rows (m).
/// `virtual_joints` takes the displacements of the virtual joints from nominal, `JP_MAX_VIRTUAL_JOINTS` numbers, zero beyond their number (m, rad).
/// `tilt` takes tilt direction (rad), tilt angle (rad) and axis height (m).
/// Each of the three may be NULL.
/// The first call for a robot under a virtualization prepares the robot, which takes as long as several hundred calls.
///
/// # Safety
/// `robot` is NULL or a robot; `rods` is NULL or 3 numbers; `pose`, `virtual_joints` and `tilt` are NULL or have room.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_forward(
    robot: *const JpRobot,
    virtualization: i32,
    rods: *const f64,
    pose: *mut f64,
    virtual_joints: *mut f64,
    tilt: *mut f64,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a robot.
        let robot = unsafe { object(robot, "robot") }?;
        // SAFETY: the caller promises 3 numbers.
        let rods = unsafe { numbers::<3>(rods, "rods") }?;
        let (chosen, solver) = robot.solver(virtualization)?;
        let found = solver.forward(rods);
        // A reference, since moving a pose copies it.
        let found = found.as_ref()?;
        // SAFETY: NULL or room, by the caller's promise.
        unsafe { write(pose, &entries(&found.base_from_platform)) };
        if !virtual_joints.is_null() {
            let displaced = robot.gpr.virtual_displacements(found, chosen.model());
            // SAFETY: as above.
            unsafe { write(virtual_joints, &padded(&displaced)) };
        }
        if !tilt.is_null() {
            let Tilt { azimuth, angle } = found.tilt();
            // SAFETY: as above.
            unsafe { write(tilt, &[azimuth, angle, found.axis_height().0]) };
        }
        Ok(())
    })
}

/// The same numbers, and zeros up to the largest number of virtual joints.
#[inline]
fn padded(values: &[f64]) -> [f64; JP_MAX_VIRTUAL_JOINTS] {
    let mut all = [0.0; JP_MAX_VIRTUAL_JOINTS];
    all.iter_mut().zip(values).for_each(|(to, value)| *to = *value);
    all
}

/// Why a set has no pose.
#[cold]
fn failure(solver: &PoseSolver, set: &[f64; 3]) -> Failure {
    match finite(set, "rods").and_then(|()| Ok(solver.forward(*set)?)) {
        Err(failure) => failure,
        Ok(_) => Failure::internal("a set has a pose by itself, but none among others"),
    }
}

/// Poses of the platform for `count` sets of 3 rod lengths (m), each as by `jp_robot_forward` to 10⁻¹² of the size of the platform.
///
/// Many sets are computed at a time, which takes a fraction of the time of as many calls.
/// `poses` takes 16 numbers for each set; `virtual_joints`, if not NULL, takes `JP_MAX_VIRTUAL_JOINTS` numbers for each set.
/// `codes` takes a code for each set. Sets without a pose are NaN and have their code; the function then returns the code of the first one, with its error.
///
/// # Safety
/// `robot` is NULL or a robot; `rods` is NULL or 3 · `count` numbers; the others are NULL or have room, and do not overlap `rods`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_forward_many(
    robot: *const JpRobot,
    virtualization: i32,
    count: usize,
    rods: *const f64,
    poses: *mut f64,
    virtual_joints: *mut f64,
    codes: *mut i32,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a robot.
        let robot = unsafe { object(robot, "robot") }?;
        writable(rods.cast_mut(), "rods")?;
        writable(poses, "poses")?;
        writable(codes, "codes")?;
        in_memory::<[f64; ENTRIES]>(count, "poses")?;
        let (chosen, solver) = robot.solver(virtualization)?;
        let joints = if virtual_joints.is_null() { 0 } else { chosen.model().joints().len() };
        let mut first = None;
        let (mut block, mut given) = (Block::new(), [[0.0; 3]; BLOCK]);
        for start in (0..count).step_by(BLOCK) {
            let sets = BLOCK.min(count - start);
            for (i, set) in given[..sets].iter_mut().enumerate() {
                // SAFETY: the set is below `count`, and the caller promises 3 numbers for each.
                *set = unsafe { rods.add(3 * (start + i)).cast::<[f64; 3]>().read_unaligned() };
            }
            let rods = &given[..sets];
            block.compute(solver, rods, joints)?;
            for (i, set) in rods.iter().enumerate() {
                let mut code = JP_OK;
                if !block.is_solved(i) {
                    let failure = failure(solver, set);
                    code = failure.code;
                    first.get_or_insert((start + i, failure));
                }
                // SAFETY: the set is below `count`, and the caller promises room for each.
                unsafe { write(poses.add(ENTRIES * (start + i)), &block.transform(i)) };
                // SAFETY: as above.
                unsafe { write(codes.add(start + i), &[code]) };
                if !virtual_joints.is_null() {
                    let to = virtual_joints.wrapping_add(JP_MAX_VIRTUAL_JOINTS * (start + i));
                    // SAFETY: as above.
                    unsafe { write(to, &block.virtual_joints(i)) };
                }
            }
        }
        match first {
            None => Ok(()),
            Some((i, failure)) => Err(failure.of(&format!("set {i}"))),
        }
    })
}

/// Limits that 3 rod lengths (m) exceed: 1 exceeded, 0 not, for each rod, then for the tilt.
///
/// # Safety
/// `robot` is NULL or a robot; `rods` is NULL or 3 numbers; `exceeded` is NULL or has room for 4.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_robot_limits(
    robot: *const JpRobot,
    rods: *const f64,
    exceeded: *mut i32,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a robot.
        let gpr = &unsafe { object(robot, "robot") }?.gpr;
        writable(exceeded, "exceeded")?;
        // SAFETY: the caller promises 3 numbers.
        let rods = unsafe { numbers::<3>(rods, "rods") }?;
        let found = gpr.limits().broken(&rods, gpr.plane_tilt(&rods));
        let [q_1, q_2, q_3] = found.rods();
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(exceeded, &[q_1, q_2, q_3, found.tilt()].map(i32::from)) };
        Ok(())
    })
}

/// Geometric Jacobian of the platform for 3 rod lengths (m): 6 rows of 3 numbers, angular velocity, then velocity of the origin, for unit velocities of the rods.
///
/// `virtual_joints`, if not NULL, takes `JP_MAX_VIRTUAL_JOINTS` rows of 3 numbers: the velocities of the virtual joints, zero beyond their number.
///
/// # Safety
/// `robot` is NULL or a robot; `rods` is NULL or 3 numbers; `jacobian` and `virtual_joints` are NULL or have room for 18 numbers.
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
        let robot = unsafe { object(robot, "robot") }?;
        writable(jacobian, "jacobian")?;
        // SAFETY: the caller promises 3 numbers.
        let rods = unsafe { numbers::<3>(rods, "rods") }?;
        let (chosen, solver) = robot.solver(virtualization)?;
        let pose = solver.forward(rods)?;
        let found = robot.gpr.platform_jacobian(&pose, chosen.model())?;
        let mut rows = [0.0; 18];
        let mut velocities = [0.0; 3 * JP_MAX_VIRTUAL_JOINTS];
        for k in 0..3 {
            (0..6).for_each(|i| rows[3 * i + k] = found.matrix[(i, k)]);
            for (m, velocity) in found.virtual_joints[k].iter().enumerate() {
                velocities[3 * m + k] = *velocity;
            }
        }
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(jacobian, &rows) };
        // SAFETY: NULL or room, by the caller's promise.
        unsafe { write(virtual_joints, &velocities) };
        Ok(())
    })
}

/// Answers a request in JSON: `{"kind": "forward", "rods_m": [0.499, 0.5, 0.501]}`, `inverse`, `mobility` or `sensitivity`.
///
/// The answer is the document of the command of that name with `--format json`; `jp_text_free` frees it.
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
