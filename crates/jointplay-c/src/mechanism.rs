//! Mechanisms with loops.

use std::ffi::{CString, c_char};

use jointplay::Error;

use jointplay::format::catalogue;
use jointplay::format::coordinates::Coordinates;
use jointplay::format::mechanism::{self, MechanismFile};
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{
    CommandedJoints, Kinematics, MechanismSystem, Relief, ReliefSolver, SparseSystem, assemble,
    guess, relieve,
};
use jointplay::nalgebra::DVector;
use jointplay::report;

use crate::catch::{Failure, entry, value};
use crate::pointer::{finite, give, many, object, take, text, writable, write};
use crate::request;

/// Other starts tried where the guess of a file does not close.
const STARTS: usize = 30;
/// Corrections at most of a mechanism with many loops, which is closed from its guess or not at all.
const CORRECTIONS: usize = 200;

/// A mechanism. It never changes: any number of threads may use it at a time.
pub struct JpMechanism {
    pub(crate) file: MechanismFile,
    pub(crate) coordinates: Coordinates,
    coordinate_names: Vec<CString>,
    link_names: Vec<CString>,
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
        Ok(Self { file, coordinates, coordinate_names, link_names })
    }

    fn start(&self, commands: &[(usize, f64)]) -> DVector<f64> {
        let mut start = guess(&self.file.mechanism);
        commands.iter().for_each(|&(k, value)| start[k] = value);
        start
    }

    /// The closed configuration by sparse algebra, and the corrections done.
    pub(crate) fn sparse(
        &self,
        commands: &[(usize, f64)],
    ) -> Result<(SparseSystem<'_>, usize), Error> {
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let mut system = SparseSystem::new(&self.file.mechanism, self.start(commands))?;
        let iterations = system.close(&held, CORRECTIONS)?;
        Ok((system, iterations))
    }

    fn assembled(&self, commands: &[(usize, f64)]) -> Result<DVector<f64>, Error> {
        if !MechanismSystem::fits(&self.file.mechanism) {
            let (system, iterations) = self.sparse(commands)?;
            return Ok(system.closure(iterations).coordinates);
        }
        let held: Vec<usize> = commands.iter().map(|&(k, _)| k).collect();
        let closed = assemble(&self.file.mechanism, &self.start(commands), &held, STARTS)?;
        Ok(closed.coordinates)
    }

    /// The closed configuration with these coordinates held, virtual joints displaced where they have to be.
    pub(crate) fn posed(
        &self,
        commands: &[(usize, f64)],
    ) -> Result<(DVector<f64>, Option<Relief>), Error> {
        let mechanism = &self.file.mechanism;
        match self.assembled(commands) {
            Err(Error::NotAssembled(_))
                if !mechanism.virtual_joints().is_empty() && !commands.is_empty() =>
            {
                let (held, values): (Vec<usize>, Vec<f64>) = commands.iter().copied().unzip();
                let home = MechanismSystem::new(mechanism, self.assembled(&[])?)?;
                let commanded = CommandedJoints::new(&home, &held)?;
                let start = commanded.start(values, mechanism.virtual_joints().len());
                let system = MechanismSystem::new(mechanism, start)?;
                let relief = relieve(&system, &commanded, ReliefSolver::LeastNorm)?;
                Ok((relief.coordinates.clone(), Some(relief)))
            }
            closed => Ok((closed?, None)),
        }
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
/// `mechanism` is NULL or from this library, and no thread uses it any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_free(mechanism: *mut JpMechanism) {
    // SAFETY: the caller's promise.
    value((), || unsafe { take(mechanism) });
}

/// What a mechanism answers without error, and what NULL gets.
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

/// Number of coordinates: joints, then virtual joints; 0 for NULL.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_coordinate_count(mechanism: *const JpMechanism) -> usize {
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, 0, |one| Some(one.coordinate_names.len())) }
}

/// Number of those coordinates that are of joints and not of virtual joints; 0 for NULL.
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

/// Name of a coordinate, counted from 0; NULL where there is none. It belongs to the mechanism.
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

/// Whether a coordinate is an angle (rad), 1, or a length (m), 0; -1 where there is none.
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

/// Number of links; 0 for NULL.
///
/// # Safety
/// `mechanism` is NULL or a mechanism.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_link_count(mechanism: *const JpMechanism) -> usize {
    // SAFETY: the caller's promise.
    unsafe { fact(mechanism, 0, |one| Some(one.link_names.len())) }
}

/// Name of a link, counted from 0; NULL where there is none. It belongs to the mechanism.
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

/// All coordinates (m, rad) with the loops closed, for commanded values of `count` joint coordinates.
///
/// Where rigid links cannot, the virtual joints take the least displacement that makes the command possible.
/// Beyond joint limits or clearances the positions are written, with `JP_NO_ANSWER`; in all other errors nothing is.
///
/// # Safety
/// `mechanism` is NULL or a mechanism; `commanded` and `values` are NULL or have `count` entries; `positions` is NULL or has room for all coordinates.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_mechanism_positions(
    mechanism: *const JpMechanism,
    commanded: *const usize,
    values: *const f64,
    count: usize,
    positions: *mut f64,
) -> i32 {
    entry(|| {
        // SAFETY: the caller promises a mechanism.
        let mechanism = unsafe { object(mechanism, "mechanism") }?;
        writable(positions, "positions")?;
        let joints = mechanism.coordinates.joints();
        if count > joints {
            let text = format!("{count} coordinates are commanded, but the joints have {joints}");
            return Err(Failure::input(text));
        }
        // SAFETY: the caller promises `count` entries.
        let commanded = unsafe { many(commanded, count, "commanded") }?;
        // SAFETY: as above.
        let values = unsafe { many(values, count, "values") }?;
        finite(&values, "values")?;
        for (place, &k) in commanded.iter().enumerate() {
            if k >= joints {
                let text = format!(
                    "there is no joint coordinate {k}: they are counted from 0, and there are {joints}"
                );
                return Err(Failure::input(text));
            }
            if commanded[..place].contains(&k) {
                return Err(Failure::input(format!("coordinate {k} is commanded twice")));
            }
        }
        let commands: Vec<(usize, f64)> = commanded.into_iter().zip(values).collect();
        let (found, _) = mechanism.posed(&commands)?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(positions, found.as_slice()) };
        let beyond = mechanism.file.mechanism.beyond_limits(&found);
        let beyond = report::beyond_limits(&mechanism.coordinates, &beyond);
        if beyond.is_empty() {
            return Ok(());
        }
        let lines: Vec<String> = beyond.into_iter().map(|one| one.message).collect();
        Err(Failure::no_answer(lines.join("\n")))
    })
}

/// Poses of all links for all coordinates (m, rad): homogeneous transforms from the link's frame to the base, by rows, 16 numbers a link.
///
/// # Safety
/// `mechanism` is NULL or a mechanism; `positions` is NULL or has all coordinates; `poses` is NULL or has room for 16 numbers a link.
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
        let rows: Vec<f64> = found.iter().flat_map(request::rows).collect();
        // SAFETY: not NULL, and the caller promises room.
        unsafe { write(poses, &rows) };
        Ok(())
    })
}

/// Any other question as JSON: `{"kind": "mobility", "at": {"A": 0.5}}`, commanded coordinates in m and rad.
///
/// The answer is the document of the command of the same name, to be freed by `jp_text_free`.
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
        let document = request::of_mechanism(mechanism, request)?;
        // SAFETY: not NULL, and the caller promises room.
        unsafe { answer.write(document.into_raw()) };
        Ok(())
    })
}
