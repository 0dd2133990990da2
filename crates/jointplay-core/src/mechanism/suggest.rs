//! Where a mechanism would have to have play.

use nalgebra::{DMatrix, DVector, Unit, Vector3};

use super::relief::{Reduced, reduced};
use super::{
    Carrier, Mechanism, MechanismSystem, Relief, ReliefSolver, VirtualJoint, VirtualMotion, close,
    relieve,
};
use crate::Error;
use crate::linalg::svd;
use crate::spatial::Pose;

/// Sets of virtual joints looked at before the search is cut short.
const MAX_SETS: usize = 50_000;
/// Sets of one size tried with the whole kinematics, best first by the linear estimate.
const MAX_TRIED: usize = 40;
/// A set that leaves more than this share of what is asked, by the linear estimate, is not tried.
const LEFT_OPEN: f64 = 0.1;
/// Corrections tried to see whether a command needs play at all.
const MAX_CORRECTIONS: usize = 100;
/// Columns below this share of the largest do nothing.
const NO_EFFECT: f64 = 1e-9;

/// A set of virtual joints that makes commanded motions possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Suggestion {
    /// The virtual joints, ready for [`Mechanism::with_virtual_joints`].
    pub virtual_joints: Vec<VirtualJoint>,
    /// Whether they are alike: the same motion at every joint of the same kind and place.
    pub symmetric: bool,
    /// The largest displacement over the commands, in the metric [m].
    pub size: f64,
    /// (M) how far each virtual joint goes at most over the commands [m or rad].
    pub largest: Vec<f64>,
}

/// What a search for virtual joints found.
#[derive(Debug, Clone, PartialEq)]
pub struct Suggestions {
    /// Whether any play is needed at all: `false` where the links alone allow every command.
    pub needed: bool,
    /// Sets, those that have to move least first; none holds another that is enough.
    pub sets: Vec<Suggestion>,
    /// Places and directions that were considered.
    pub candidates: usize,
    /// Sets that were compared by the linear estimate.
    pub compared: usize,
    /// Whether the search was cut short at its limit.
    pub cut_short: bool,
}

/// Finds sets of virtual joints that make commands possible.
///
/// Candidates are the slides and turns that each joint lacks: radial, tangential and normal on the link that carries more joints.
/// A set makes a command possible where what the command opens lies in the span of what the set can do; the best are tried with the whole kinematics.
///
/// # Arguments
/// * `home` – (f) closed coordinates without virtual joints [m, rad]
/// * `commanded` – indices of the commanded coordinates
/// * `commands` – values of these coordinates, a vector for each command [m, rad]
///
/// # Errors
/// [`Error::NotRelieved`] where not even all candidates together make a command possible.
pub fn suggest(
    mechanism: &Mechanism,
    home: &DVector<f64>,
    commanded: &[usize],
    commands: &[DVector<f64>],
) -> Result<Suggestions, Error> {
    let f = mechanism.joint_freedoms();
    super::system::check(home, f)?;
    if possible_without_play(mechanism, home, commanded, commands)? {
        let sets = Vec::new();
        return Ok(Suggestions {
            needed: false,
            sets,
            candidates: 0,
            compared: 0,
            cut_short: false,
        });
    }
    let candidates = candidates(mechanism, home)?;
    let all: Vec<VirtualJoint> = candidates.iter().map(|c| c.joint.clone()).collect();
    let relieved = with(mechanism, &all);
    let mut needs = Vec::new();
    for command in commands {
        let start = commanded_start(home, commanded, command, all.len())?;
        let system = MechanismSystem::new(&relieved, start)?;
        let found = relieve(&system, commanded, ReliefSolver::LeastNorm)?;
        let y = found.virtual_joints.clone();
        let Reduced { relieving, roots, .. } = reduced(&system.at(found.coordinates)?, commanded)?;
        needs.push((&relieving * y.component_mul(&roots), relieving));
    }
    let useful: Vec<usize> = (0..all.len())
        .filter(|&k| needs.iter().any(|(_, a)| a.column(k).amax() > NO_EFFECT * a.amax()))
        .collect();
    let (sets, cut_short) = sets(&candidates, &useful, &needs);
    let compared = sets.len();
    let mut estimated: Vec<(f64, Set)> = Vec::new();
    for set in sets {
        if let Some(size) = estimate(&needs, &set.members)? {
            estimated.push((size, set));
        }
    }
    // Small sets first, so that a set is seen to hold one that is enough; of one size the best by the estimate.
    estimated.sort_by(|a, b| {
        let key = |(_, set): &(f64, Set)| (set.members.len(), !set.symmetric);
        key(a).cmp(&key(b)).then(a.0.total_cmp(&b.0))
    });
    let mut found: Vec<(Vec<usize>, Suggestion)> = Vec::new();
    let (mut of_size, mut tries) = (0, 0);
    for (_, set) in estimated {
        if set.members.len() != of_size {
            (of_size, tries) = (set.members.len(), 0);
        }
        tries += 1;
        if tries > MAX_TRIED {
            continue;
        }
        let smaller = |(members, _): &(Vec<usize>, Suggestion)| {
            members.iter().all(|member| set.members.contains(member))
        };
        if found.iter().any(smaller) {
            continue;
        }
        let chosen: Vec<VirtualJoint> = set.members.iter().map(|&k| all[k].clone()).collect();
        if let Some((size, largest)) = tried(mechanism, home, commanded, commands, &chosen)? {
            let symmetric = set.symmetric;
            found.push((
                set.members,
                Suggestion { virtual_joints: chosen, symmetric, size, largest },
            ));
        }
    }
    let mut sets: Vec<Suggestion> = found.into_iter().map(|(_, suggestion)| suggestion).collect();
    sets.sort_by(|a, b| a.size.total_cmp(&b.size));
    Ok(Suggestions { needed: true, sets, candidates: all.len(), compared, cut_short })
}

fn possible_without_play(
    mechanism: &Mechanism,
    home: &DVector<f64>,
    commanded: &[usize],
    commands: &[DVector<f64>],
) -> Result<bool, Error> {
    let bare = with(mechanism, &[]);
    let free: Vec<usize> = (0..home.len()).filter(|k| !commanded.contains(k)).collect();
    for command in commands {
        let start = commanded_start(home, commanded, command, 0)?;
        let closed = close(&MechanismSystem::new(&bare, start)?, &free, MAX_CORRECTIONS)?;
        if !closed.is_closed() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// A place and direction, and which others are alike.
struct Candidate {
    joint: VirtualJoint,
    orbit: usize,
}

struct Set {
    members: Vec<usize>,
    symmetric: bool,
}

fn with(mechanism: &Mechanism, virtual_joints: &[VirtualJoint]) -> Mechanism {
    mechanism
        .clone()
        .with_virtual_joints(virtual_joints.to_vec())
        .expect("candidates have names and joints of their own")
}

fn commanded_start(
    home: &DVector<f64>,
    commanded: &[usize],
    command: &DVector<f64>,
    virtual_joints: usize,
) -> Result<DVector<f64>, Error> {
    if command.len() != commanded.len() {
        let (found, expected) = (command.len(), commanded.len());
        return Err(Error::WrongLength { what: "a command", found, expected });
    }
    let mut start = home.clone().resize_vertically(home.len() + virtual_joints, 0.0);
    commanded.iter().zip(command.iter()).for_each(|(&k, &value)| start[k] = value);
    Ok(start)
}

/// Size and largest displacements over all commands, if the set makes all of them possible.
fn tried(
    mechanism: &Mechanism,
    home: &DVector<f64>,
    commanded: &[usize],
    commands: &[DVector<f64>],
    chosen: &[VirtualJoint],
) -> Result<Option<(f64, Vec<f64>)>, Error> {
    let relieved = with(mechanism, chosen);
    let (mut size, mut largest) = (0.0_f64, vec![0.0_f64; chosen.len()]);
    for command in commands {
        let start = commanded_start(home, commanded, command, chosen.len())?;
        let system = MechanismSystem::new(&relieved, start)?;
        let Relief { virtual_joints, size: here, .. } =
            match relieve(&system, commanded, ReliefSolver::LeastNorm) {
                Ok(relief) => relief,
                Err(Error::NotRelieved { .. }) => return Ok(None),
                Err(error) => return Err(error),
            };
        size = size.max(here);
        for (most, x) in largest.iter_mut().zip(virtual_joints.iter()) {
            *most = most.max(x.abs());
        }
    }
    Ok(Some((size, largest)))
}

/// Symmetric sets and their pairs, then sets of single candidates up to as many as there are directions to relieve.
fn sets(
    candidates: &[Candidate],
    useful: &[usize],
    needs: &[(DVector<f64>, DMatrix<f64>)],
) -> (Vec<Set>, bool) {
    let orbits: std::collections::BTreeSet<usize> =
        useful.iter().map(|&k| candidates[k].orbit).collect();
    let members = |orbit: usize| {
        useful.iter().copied().filter(|&k| candidates[k].orbit == orbit).collect::<Vec<_>>()
    };
    let mut sets: Vec<Set> =
        orbits.iter().map(|&orbit| Set { members: members(orbit), symmetric: true }).collect();
    for (n, &a) in orbits.iter().enumerate() {
        for &b in orbits.iter().skip(n + 1) {
            sets.push(Set { members: [members(a), members(b)].concat(), symmetric: true });
        }
    }
    let directions = needs.first().map_or(0, |(_, relieving)| relieving.nrows());
    let mut chosen: Vec<usize> = Vec::new();
    let mut cut_short = false;
    for size in 1..=directions.min(useful.len()) {
        combinations(useful.len(), size, &mut chosen, 0, &mut |picked| {
            let members: Vec<usize> = picked.iter().map(|&n| useful[n]).collect();
            cut_short |= sets.len() >= MAX_SETS;
            let known = sets.iter().take(orbits.len()).any(|set| set.members == members);
            if !cut_short && !known {
                sets.push(Set { members, symmetric: false });
            }
            !cut_short
        });
    }
    (sets, cut_short)
}

/// All ways to pick `size` of `count`; ends when `visit` says so.
fn combinations(
    count: usize,
    size: usize,
    chosen: &mut Vec<usize>,
    from: usize,
    visit: &mut impl FnMut(&[usize]) -> bool,
) -> bool {
    if chosen.len() == size {
        return visit(chosen);
    }
    for next in from..count {
        chosen.push(next);
        let go_on = combinations(count, size, chosen, next + 1, visit);
        chosen.pop();
        if !go_on {
            return false;
        }
    }
    true
}

/// Largest linear least-norm displacement over the commands, if the set spans what they ask.
fn estimate(
    needs: &[(DVector<f64>, DMatrix<f64>)],
    members: &[usize],
) -> Result<Option<f64>, Error> {
    let mut size = 0.0_f64;
    for (need, relieving) in needs {
        let part = relieving.select_columns(members);
        let decomposition = svd(&part)?;
        let y = decomposition.solve(need, decomposition.rank(1e-6));
        if (&part * &y - need).norm() > LEFT_OPEN * need.norm() {
            return Ok(None);
        }
        size = size.max(y.norm());
    }
    Ok(Some(size))
}

/// The slides and turns that the joints lack.
fn candidates(mechanism: &Mechanism, home: &DVector<f64>) -> Result<Vec<Candidate>, Error> {
    let bare = with(mechanism, &[]);
    let system = MechanismSystem::new(&bare, home.clone())?;
    let unit = crate::constraint::System::characteristic_length(&system);
    let on_link = |link: usize| {
        mechanism.joints().iter().flat_map(move |joint| {
            [0, 1].into_iter().filter(move |&s| joint.links[s] == link).map(|s| &joint.frames[s])
        })
    };
    let (mut found, mut keys): (Vec<Candidate>, Vec<String>) = (Vec::new(), Vec::new());
    for (j, joint) in mechanism.joints().iter().enumerate() {
        let counts = joint.links.map(|link| on_link(link).count());
        let side = usize::from(counts[1] >= counts[0]);
        let carrier = if side == 0 { Carrier::First } else { Carrier::Second };
        let link = joint.links[side];
        let places: Vec<Vector3<f64>> =
            on_link(link).map(|frame| frame.translation.vector).collect();
        let (triad, radius) = triad(&places, &joint.frames[side], unit);
        for (label, direction) in ["radial", "tangential", "normal"].into_iter().zip(triad) {
            for slides in [true, false] {
                let point = joint.frames[side].translation.vector;
                let motion = if slides {
                    VirtualMotion::Slide(direction)
                } else {
                    VirtualMotion::Turn { axis: direction, point }
                };
                if already_free(joint.kind, &joint.frames[side], direction, slides)? {
                    continue;
                }
                let what = if slides { "slide" } else { "turn" };
                let key = format!(
                    "{} {} {label} {what} {} {:.6}",
                    joint.kind.name(),
                    joint.actuated,
                    counts[side],
                    radius / unit
                );
                let orbit = keys.iter().position(|known| *known == key).unwrap_or_else(|| {
                    keys.push(key);
                    keys.len() - 1
                });
                let name =
                    format!("{label} {what} of {} at {}", mechanism.links()[link], joint.name);
                found.push(Candidate {
                    orbit,
                    joint: VirtualJoint {
                        name,
                        joint: j,
                        carrier,
                        motion,
                        clearance: if slides {
                            joint.clearance.linear
                        } else {
                            joint.clearance.angular
                        },
                        stiffness: None,
                    },
                });
            }
        }
    }
    Ok(found)
}

/// Radial, tangential and normal direction at a joint's place on a link, and how far it is from the link's middle [m].
fn triad(places: &[Vector3<f64>], frame: &Pose, unit: f64) -> ([Unit<Vector3<f64>>; 3], f64) {
    #[expect(clippy::cast_precision_loss, reason = "a count of joints")]
    let middle = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
    // The plane of the joints, where they have one; else the joint's axis.
    let area = places
        .iter()
        .flat_map(|a| places.iter().map(move |b| (a - middle).cross(&(b - middle))))
        .max_by(|a, b| a.norm().total_cmp(&b.norm()))
        .unwrap_or_default();
    let axis = frame.rotation * Vector3::z();
    let normal = Unit::try_new(area, 1e-9 * unit * unit).unwrap_or(Unit::new_normalize(axis));
    let arm = frame.translation.vector - middle;
    let arm = arm - normal.scale(arm.dot(&normal));
    let own = frame.rotation * Vector3::x();
    let fallback = own - normal.scale(own.dot(&normal));
    let other = frame.rotation * Vector3::y();
    let last = other - normal.scale(other.dot(&normal));
    let radial = Unit::try_new(arm, 1e-9 * unit)
        .or_else(|| Unit::try_new(fallback, 0.5))
        .unwrap_or_else(|| Unit::new_normalize(last));
    let tangential = Unit::new_normalize(normal.cross(&radial));
    ([radial, tangential, normal], arm.norm())
}

/// Whether a joint already has a motion, or a combination of its motions that is this one.
fn already_free(
    kind: super::JointKind,
    frame: &Pose,
    direction: Unit<Vector3<f64>>,
    slides: bool,
) -> Result<bool, Error> {
    let local = frame.rotation.inverse() * direction.into_inner();
    let zero = Vector3::zeros();
    let candidate = if slides { (zero, local) } else { (local, zero) };
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let column = |(angular, linear): (Vector3<f64>, Vector3<f64>)| {
        DVector::from_iterator(6, angular.iter().chain(linear.iter()).copied())
    };
    for factor in kind.factors() {
        columns.extend((0..factor.coordinates().len()).map(|k| column(factor.screw(k))));
    }
    if columns.is_empty() {
        return Ok(false);
    }
    let own = svd(&DMatrix::from_columns(&columns))?;
    let rank = own.rank(1e-9);
    let candidate = column(candidate);
    let within = own.u.columns(0, rank).transpose() * &candidate;
    Ok(within.norm() > 1.0 - 1e-9)
}
