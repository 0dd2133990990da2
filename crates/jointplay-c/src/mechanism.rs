//! Mechanisms with loops.

use std::ffi::{CString, c_char};
use std::sync::Mutex;

use jointplay::format::catalogue;
use jointplay::format::coordinates::Coordinates;
use jointplay::format::mechanism::{self, MechanismFile};
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{
    CommandedPositions, FrameId, Kinematics, Mechanism, ReliefSolver, close_at_rest,
};
use jointplay::nalgebra::DVector;
use jointplay::report;

use crate::catch::{Failure, entry, value};
use crate::pointer::{finite, give, many, object, take, text, writable, write};
use crate::request;
use crate::transform::{by_rows, entries};

/// A mechanism. Any number of threads may use it; its positions are computed one at a time.
pub struct JpMechanism {
    file: MechanismFile,
    coordinates: Coordinates,
    coordinate_names: Vec<CString>,
    link_names: Vec<CString>,
    /// Coordinates of the actuated joints.
    drives: Vec<usize>,
    /// Made when it is first needed.
    driven: Mutex<Option<Driven>>,
}

/// Memory for the positions of a mechanism.
struct Driven {
    /// (f + M) closed coordinates nearest to the guesses of the file (m, rad).
    home: DVector<f64>,
    positions: CommandedPositions,
}

impl Driven {
    fn new(mechanism: &Mechanism, drives: &[usize]) -> Result<Self, Failure> {
        let home = close_at_rest(mechanism, None)?.coordinates;
        let positions = CommandedPositions::new(mechanism, &home, drives)?;
        Ok(Self { home, positions })
    }

    /// The closed configuration for values of the drives, on the branch of another one.
    fn solve(
        &mut self,
        mechanism: &Mechanism,
        values: &[f64],
        near: Vec<f64>,
    ) -> Result<DVector<f64>, Failure> {
        let mut found = DVector::from_vec(near);
        self.positions.solve_next(mechanism, values, &mut found, ReliefSolver::LeastNorm)?;
        Ok(found)
    }
}

impl JpMechanism {
    fn new(toml: &str, label: &str) -> Result<Self, Failure> {
        let read = mechanism::parse(toml);
        let file = read.map_err(|errors| Failure::input(errors.with_excerpt(label)))?;
        let coordinates = Coordinates::of(&file);
        let name = |name: &str| {
            CString::new(name).map_err(|_| Failure::input(format!("the name {name:?} has a NUL")))
        };
        let coordinate_names = coordinates.all().iter().map(|one| name(&one.name));
        let coordinate_names = coordinate_names.collect::<Result<_, _>>()?;
        let link_names = file.mechanism.links().iter().map(|link| name(link));
        let link_names = link_names.collect::<Result<_, _>>()?;
        let drives = file.mechanism.actuated_coordinates();
        let driven = Mutex::default();
        Ok(Self { file, coordinates, coordinate_names, link_names, drives, driven })
    }

    /// Calls a function with the memory for positions.
    fn with_driven<T>(
        &self,
        work: impl FnOnce(&Mechanism, &mut Driven) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let mut driven = self.driven.lock().unwrap_or_else(|poisoned| {
            // What a panic has left is made again.
            self.driven.clear_poison();
            let mut driven = poisoned.into_inner();
            *driven = None;
            driven
        });
        let mechanism = &self.file.mechanism;
        let driven = match &mut *driven {
            Some(driven) => driven,
            none => none.insert(Driven::new(mechanism, &self.drives)?),
        };
        work(mechanism, driven)
    }

    /// Refuses a configuration beyond joint limits or clearances.
    fn within_limits(&self, found: &DVector<f64>) -> Result<(), Failure> {
        let beyond = self.file.mechanism.beyond_limits(found);
        if beyond.is_empty() {
            return Ok(());
        }
        let beyond = report::beyond_limits(&self.coordinates, &beyond);
        let lines: Vec<String> = beyond.into_iter().map(|one| one.message).collect();
        Err(Failure::no_answer(format!("joint limits exceeded: {}", lines.join("; "))))
    }
}

/// The mechanism of the text of a mechanism file (TOML).
///
/// # Safety
/// `toml` is NULL or ended by NUL; `mechanism` is NULL or has room for a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_parse(
    toml: *const c_char,
    mechanism: *mut *mut JpMechanism,
) -> i32 {
    entry(|| {
        writable(mechanism, "mechanism")?;
        // SAFETY: the caller promises the NUL.
        let toml = unsafe { text(toml, "toml") }?;
        let made = JpMechanism::new(toml, "text")?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { give(mechanism, made) };
        Ok(())
    })
}

/// A mechanism of the catalogue by its name, such as `four-bar`.
///
/// # Safety
/// `name` is NULL or ended by NUL; `mechanism` is NULL or has room for a handle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_catalogue(
    name: *const c_char,
    mechanism: *mut *mut JpMechanism,
) -> i32 {
    entry(|| {
        writable(mechanism, "mechanism")?;
        // SAFETY: the caller promises the NUL.
        let name = unsafe { text(name, "name") }?;
        let found = catalogue::find(name);
        let found = found.filter(|entry| entry.kind().as_deref() == Some("mechanism"));
        let missing = || Failure::input(format!("the catalogue has no mechanism {name:?}"));
        let made = JpMechanism::new(found.ok_or_else(missing)?.text, name)?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { give(mechanism, made) };
        Ok(())
    })
}

/// Frees a mechanism; NULL does nothing.
///
/// # Safety
/// `mechanism` is NULL, or a mechanism that is not used after this call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_free(mechanism: *mut JpMechanism) {
    // SAFETY: the caller's promise.
    value((), || unsafe { take(mechanism) });
}

/// A value of a mechanism; `otherwise` for NULL, or where there is none.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
unsafe fn fact<T: Copy>(
    mechanism: *const JpMechanism,
    otherwise: T,
    read: impl FnOnce(&JpMechanism) -> Option<T>,
) -> T {
    value(otherwise, || {
        // SAFETY: the caller's promise.
        let mechanism = unsafe { object(mechanism, "mechanism") }.ok();
        mechanism.and_then(read).unwrap_or(otherwise)
    })
}

/// Number of coordinates: those of joints, then those of virtual joints; 0 for NULL.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_coordinate_count(mechanism: *const JpMechanism) -> usize {
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, 0, |one| Some(one.coordinate_names.len())) }
}

/// Number of coordinates of joints; the coordinates after them are displacements of virtual joints; 0 for NULL.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_joint_coordinate_count(
    mechanism: *const JpMechanism,
) -> usize {
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, 0, |one| Some(one.coordinates.joints())) }
}

/// Name of a coordinate, counted from 0; NULL where there is none. The text belongs to the mechanism.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_coordinate_name(
    mechanism: *const JpMechanism,
    coordinate: usize,
) -> *const c_char {
    let name = |one: &JpMechanism| one.coordinate_names.get(coordinate).map(|name| name.as_ptr());
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, std::ptr::null(), name) }
}

/// 1 if a coordinate is an angle (rad), 0 if it is a length (m); -1 where there is none.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_coordinate_is_angle(
    mechanism: *const JpMechanism,
    coordinate: usize,
) -> i32 {
    let is_angle = |one: &JpMechanism| {
        let named = one.coordinates.all().get(coordinate)?;
        Some(i32::from(matches!(named.quantity, Coordinate::Turn)))
    };
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, -1, is_angle) }
}

/// Number of drives: coordinates of actuated joints; 0 for NULL.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_drive_count(mechanism: *const JpMechanism) -> usize {
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, 0, |one| Some(one.drives.len())) }
}

/// Coordinate of a drive, both counted from 0; -1 where there is none.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_drive_coordinate(
    mechanism: *const JpMechanism,
    drive: usize,
) -> i32 {
    let coordinate = |one: &JpMechanism| one.drives.get(drive).and_then(|&k| i32::try_from(k).ok());
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, -1, coordinate) }
}

/// Number of links, the base first; 0 for NULL.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_link_count(mechanism: *const JpMechanism) -> usize {
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, 0, |one| Some(one.link_names.len())) }
}

/// Name of a link, counted from 0; NULL where there is none. The text belongs to the mechanism.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_link_name(
    mechanism: *const JpMechanism,
    link: usize,
) -> *const c_char {
    let name = |one: &JpMechanism| one.link_names.get(link).map(|name| name.as_ptr());
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, std::ptr::null(), name) }
}

/// All coordinates (m, rad) of the closed configuration nearest to the guesses of the file, virtual joints at rest.
///
/// # Safety
/// `mechanism` is NULL or a mechanism; `positions` is NULL or has room for all coordinates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_home(
    mechanism: *const JpMechanism,
    positions: *mut f64,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a mechanism.
        let mechanism = unsafe { object(mechanism, "mechanism") }?;
        writable(positions, "positions")?;
        let home = mechanism.with_driven(|_, driven| Ok(driven.home.clone()))?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(positions, home.as_slice()) };
        Ok(())
    })
}

/// All coordinates (m, rad) with the loops closed, for values of all drives (m, rad); virtual joints take their least displacement.
///
/// `positions` holds a configuration nearby, such as that of `jp_mechanism_home` or of the call before, and takes the result.
/// It is unchanged after an error; configurations beyond joint limits or clearances, or more than 100 rad or characteristic lengths away, are `JP_NO_ANSWER`.
///
/// # Safety
/// `mechanism` is NULL or a mechanism; `drives` is NULL or has a number for each drive; `positions` is NULL or has all coordinates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_positions(
    mechanism: *const JpMechanism,
    drives: *const f64,
    positions: *mut f64,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a mechanism.
        let mechanism = unsafe { object(mechanism, "mechanism") }?;
        writable(positions, "positions")?;
        // SAFETY: the caller promises a number for each drive.
        let drives = unsafe { many(drives, mechanism.drives.len(), "drives") }?;
        finite(&drives, "drives")?;
        for (&k, &value) in mechanism.drives.iter().zip(&drives) {
            let checked = mechanism.coordinates.checked(k, value);
            checked.map_err(|error| Failure::input(error.to_string()))?;
        }
        let count = mechanism.coordinates.all().len();
        // SAFETY: the caller promises all coordinates.
        let near = unsafe { many(positions.cast_const(), count, "positions") }?;
        finite(&near, "positions")?;
        let found = mechanism.with_driven(|one, driven| driven.solve(one, &drives, near))?;
        mechanism.within_limits(&found)?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(positions, found.as_slice()) };
        Ok(())
    })
}

/// Poses of all links for all coordinates (m, rad): homogeneous transforms from the frame of the link to the base frame, 16 numbers by rows for each link (m).
///
/// # Safety
/// `mechanism` is NULL or a mechanism; `positions` is NULL or has all coordinates; `poses` is NULL or has room for 16 numbers for each link.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_link_poses(
    mechanism: *const JpMechanism,
    positions: *const f64,
    poses: *mut f64,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a mechanism.
        let mechanism = unsafe { object(mechanism, "mechanism") }?;
        writable(poses, "poses")?;
        let count = mechanism.coordinates.all().len();
        // SAFETY: the caller promises all coordinates.
        let positions = unsafe { many(positions, count, "positions") }?;
        finite(&positions, "positions")?;
        let kinematics = Kinematics::new(&mechanism.file.mechanism);
        let found = kinematics.link_poses(&DVector::from_vec(positions))?;
        let rows: Vec<f64> = found.iter().flat_map(entries).collect();
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(poses, &rows) };
        Ok(())
    })
}

/// Geometric Jacobian of a link, counted from 0: 6 rows with a number for each drive, angular velocity, then velocity of the origin, for unit velocities of the drives.
///
/// `positions` has all coordinates (m, rad), as `jp_mechanism_positions` returns them.
/// `rates`, if not NULL, takes a row for each coordinate, with a number for each drive: the velocities of the coordinates.
///
/// # Safety
/// `mechanism` is NULL or a mechanism; `positions` is NULL or has all coordinates; `jacobian` and `rates` are NULL or have room for their rows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_jacobian(
    mechanism: *const JpMechanism,
    positions: *const f64,
    link: usize,
    jacobian: *mut f64,
    rates: *mut f64,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a mechanism.
        let mechanism = unsafe { object(mechanism, "mechanism") }?;
        writable(jacobian, "jacobian")?;
        let count = mechanism.coordinates.all().len();
        // SAFETY: the caller promises all coordinates.
        let positions = unsafe { many(positions, count, "positions") }?;
        finite(&positions, "positions")?;
        let links = mechanism.link_names.len();
        if link >= links {
            let text =
                format!("there is no link {link}: they are counted from 0, and there are {links}");
            return Err(Failure::input(text));
        }
        let values: Vec<f64> = mechanism.drives.iter().map(|&k| positions[k]).collect();
        let (matrix, all) = mechanism.with_driven(|one, driven| {
            let found = driven.solve(one, &values, positions)?;
            let kinematics = driven.positions.linearize(&found)?;
            Ok((kinematics.jacobian(FrameId::Link(link))?, kinematics.coordinate_derivatives()?))
        })?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(jacobian, &by_rows(&matrix)) };
        // SAFETY: NULL or room, by the caller's promise.
        unsafe { write(rates, &by_rows(&all)) };
        Ok(())
    })
}

/// Answers a request in JSON: `{"kind": "mobility", "at": {"A": 0.5}}`, `assemble`, `jacobian`, `sensitivity`, `move` or `suggest`; joint coordinates in m and rad.
///
/// The answer is the document of the command of that name with `--format json`; `jp_text_free` frees it.
///
/// # Safety
/// `mechanism` is NULL or a mechanism; `request` is NULL or ended by NUL; `answer` is NULL or has room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_json(
    mechanism: *const JpMechanism,
    request: *const c_char,
    answer: *mut *mut c_char,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a mechanism.
        let mechanism = unsafe { object(mechanism, "mechanism") }?;
        writable(answer, "answer")?;
        // SAFETY: the caller promises the NUL.
        let request = unsafe { text(request, "request") }?;
        let document = request::of_mechanism(&mechanism.file, &mechanism.coordinates, request)?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { answer.write(document.into_raw()) };
        Ok(())
    })
}
