//! Suggestion of joints that need play.

use nalgebra::{DMatrix, DVector};

use super::relief::{Reduced, reduced};
use super::virtual_candidates::{Candidate, Candidates, candidates};
use super::{
    BeyondLimits, CommandedJoints, Mechanism, MechanismSystem, ReliefSolver, VirtualJoint, close,
    relieve,
};
use crate::Error;
use crate::linalg::svd;

/// Sets of virtual joints compared before the search is cut short.
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
    /// Whether every symmetry of the mechanism at home maps the set onto itself; `false` where it has none.
    pub symmetric: bool,
    /// The largest displacement over the commands, in the metric (m).
    pub size: f64,
    /// (M) largest displacement of each virtual joint over the commands (m or rad).
    pub largest: Vec<f64>,
    /// Configuration for each command: (f) coordinates of the joints (m, rad).
    pub configurations: Vec<DVector<f64>>,
    /// Joint coordinates that are beyond their limits for one of the commands.
    pub beyond_limits: Vec<BeyondLimits>,
}

/// Result of a search for virtual joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Suggestions {
    /// Whether any play is needed at all: `false` where the links alone allow every command.
    pub needed: bool,
    /// Configuration of the rigid links for each command, if no play is needed: (f) coordinates (m, rad).
    pub without_play: Vec<DVector<f64>>,
    /// Joint coordinates that are beyond their limits there.
    pub beyond_limits: Vec<BeyondLimits>,
    /// Sets, those within joint limits first, then by the least displacement; none holds another that is enough.
    pub sets: Vec<Suggestion>,
    /// Places and directions that were considered.
    pub candidates: usize,
    /// Sets that were compared by the linear estimate.
    pub compared: usize,
    /// Sets that the linear estimate took for possible, but that were not tried with the whole kinematics.
    pub untried: usize,
    /// Whether the search was cut short at its limit.
    pub cut_short: bool,
}

impl Suggestions {
    /// Whether every set that the search knows of was compared and tried; if not, a smaller displacement may exist among them.
    #[must_use]
    pub fn complete(&self) -> bool {
        !self.cut_short && self.untried == 0
    }
}

/// Finds sets of virtual joints that make commands possible.
///
/// Candidates are the slides and turns that each joint lacks: radial, tangential and normal on the link that carries more joints.
/// A set makes a command possible where what the command opens lies in the span of what the set can do; the best are tried with the whole kinematics.
/// Joints that the commands leave undetermined stay as near home as they can, see [`CommandedJoints`].
///
/// # Arguments
/// * `home` – (f) closed coordinates without virtual joints (m, rad)
/// * `commanded` – indices of the commanded coordinates
/// * `commands` – values of these coordinates, a vector for each command (m, rad)
///
/// # Errors
/// [`Error::NotRelieved`] where not even all candidates together make a command possible; those of [`relieve`] and [`CommandedJoints::new`].
pub fn suggest(
    mechanism: &Mechanism,
    home: &DVector<f64>,
    commanded: &[usize],
    commands: &[DVector<f64>],
) -> Result<Suggestions, Error> {
    let f = mechanism.joint_freedoms();
    super::kinematics::check_coordinates(home, f)?;
    if let Some(found) = commands.iter().find(|command| command.len() != commanded.len()) {
        let (found, expected) = (found.len(), commanded.len());
        return Err(Error::LengthMismatch { what: "a command", found, expected });
    }
    let bare = with(mechanism, &[]);
    let at_home = MechanismSystem::new(&bare, home.clone())?;
    let commanded = CommandedJoints::new(&at_home, commanded)?;
    if let Some(without_play) = possible_without_play(&at_home, &commanded, commands)? {
        return Ok(Suggestions {
            needed: false,
            beyond_limits: beyond(&bare, &without_play),
            without_play,
            sets: Vec::new(),
            candidates: 0,
            compared: 0,
            untried: 0,
            cut_short: false,
        });
    }
    let Candidates { candidates, images } = candidates(&at_home, home)?;
    let all: Vec<VirtualJoint> = candidates.iter().map(|c| c.joint.clone()).collect();
    let relieved = with(mechanism, &all);
    let mut needs = Vec::new();
    for command in commands {
        let start = commanded.start(command.iter().copied(), all.len());
        let system = MechanismSystem::new(&relieved, start)?;
        let found = relieve(&system, &commanded, ReliefSolver::LeastNorm)?;
        let y = found.virtual_joints.clone();
        let Reduced { relieving, roots, .. } = reduced(&system.at(found.coordinates)?, &commanded)?;
        needs.push(Need { open: &relieving * y.component_mul(&roots), relieving });
    }
    let useful: Vec<usize> = (0..all.len())
        .filter(|&k| {
            needs.iter().any(|Need { relieving: a, .. }| a.column(k).amax() > NO_EFFECT * a.amax())
        })
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
    let (mut of_size, mut tries, mut untried) = (0, 0, 0);
    for (_, set) in estimated {
        if set.members.len() != of_size {
            (of_size, tries) = (set.members.len(), 0);
        }
        let smaller = |(members, _): &(Vec<usize>, Suggestion)| {
            members.iter().all(|member| set.members.contains(member))
        };
        if found.iter().any(smaller) {
            continue;
        }
        tries += 1;
        if tries > MAX_TRIED {
            untried += 1;
            continue;
        }
        let chosen: Vec<VirtualJoint> = set.members.iter().map(|&k| all[k].clone()).collect();
        let symmetric = is_symmetric(&set.members, &images);
        if let Some(suggestion) = tried(mechanism, &commanded, commands, chosen, symmetric)? {
            found.push((set.members, suggestion));
        }
    }
    let mut sets: Vec<Suggestion> = found.into_iter().map(|(_, suggestion)| suggestion).collect();
    sets.sort_by(|a, b| {
        let outside = |set: &Suggestion| !set.beyond_limits.is_empty();
        outside(a).cmp(&outside(b)).then(a.size.total_cmp(&b.size))
    });
    Ok(Suggestions {
        needed: true,
        without_play: Vec::new(),
        beyond_limits: Vec::new(),
        sets,
        candidates: all.len(),
        compared,
        untried,
        cut_short,
    })
}

/// Configurations of the rigid links for the commands, if they allow all of them.
fn possible_without_play(
    home: &MechanismSystem<'_>,
    commanded: &CommandedJoints,
    commands: &[DVector<f64>],
) -> Result<Option<Vec<DVector<f64>>>, Error> {
    let free: Vec<usize> =
        (0..home.home().len()).filter(|k| !commanded.coordinates().contains(k)).collect();
    let mut found = Vec::with_capacity(commands.len());
    for command in commands {
        let start = home.at(commanded.start(command.iter().copied(), 0))?;
        let closed = close(&start, &free, MAX_CORRECTIONS)?;
        if !closed.is_closed() {
            return Ok(None);
        }
        found.push(closed.coordinates);
    }
    Ok(Some(found))
}

/// Joint coordinates beyond their limits in one of some configurations, each once.
fn beyond(mechanism: &Mechanism, configurations: &[DVector<f64>]) -> Vec<BeyondLimits> {
    let mut found: Vec<BeyondLimits> = Vec::new();
    for one in configurations.iter().flat_map(|at| mechanism.beyond_limits(at)) {
        if !found.iter().any(|known| known.coordinate == one.coordinate) {
            found.push(one);
        }
    }
    found
}

/// Whether every symmetry maps a set onto itself; `false` where there is none.
///
/// # Arguments
/// * `images` – for each symmetry, the candidate that each is mapped onto
fn is_symmetric(members: &[usize], images: &[Vec<Option<usize>>]) -> bool {
    !images.is_empty()
        && images.iter().all(|image| {
            members.iter().all(|&k| image[k].is_some_and(|onto| members.contains(&onto)))
        })
}

/// What a command requires of the virtual joints.
struct Need {
    /// (open) mismatch that no passive joint can close.
    open: DVector<f64>,
    /// (open, M) effect of the virtual joints on it.
    relieving: DMatrix<f64>,
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

/// Displacements of a set over all commands, if it makes all of them possible.
fn tried(
    mechanism: &Mechanism,
    commanded: &CommandedJoints,
    commands: &[DVector<f64>],
    chosen: Vec<VirtualJoint>,
    symmetric: bool,
) -> Result<Option<Suggestion>, Error> {
    let relieved = with(mechanism, &chosen);
    let f = relieved.joint_freedoms();
    let (mut size, mut largest) = (0.0_f64, vec![0.0_f64; chosen.len()]);
    let mut configurations = Vec::with_capacity(commands.len());
    for command in commands {
        let start = commanded.start(command.iter().copied(), chosen.len());
        let system = MechanismSystem::new(&relieved, start)?;
        let relief = match relieve(&system, commanded, ReliefSolver::LeastNorm) {
            Ok(relief) => relief,
            Err(Error::NotRelieved { .. } | Error::NotLeast { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        size = size.max(relief.size);
        for (most, x) in largest.iter_mut().zip(relief.virtual_joints.iter()) {
            *most = most.max(x.abs());
        }
        configurations.push(relief.coordinates.rows(0, f).into_owned());
    }
    let beyond_limits = beyond(mechanism, &configurations);
    Ok(Some(Suggestion {
        virtual_joints: chosen,
        symmetric,
        size,
        largest,
        configurations,
        beyond_limits,
    }))
}

/// Symmetric sets and their pairs, then sets of single candidates up to as many as there are directions to relieve.
fn sets(candidates: &[Candidate], useful: &[usize], needs: &[Need]) -> (Vec<Set>, bool) {
    let orbits: std::collections::BTreeSet<usize> =
        useful.iter().map(|&k| candidates[k].orbit).collect();
    let members = |orbit: usize| {
        useful.iter().copied().filter(|&k| candidates[k].orbit == orbit).collect::<Vec<_>>()
    };
    let mut sets: Vec<Set> =
        orbits.iter().map(|&orbit| Set { members: members(orbit), symmetric: true }).collect();
    let symmetric = sets.iter().any(|set| set.members.len() > 1);
    if !symmetric {
        sets.clear();
    }
    for (n, &a) in orbits.iter().enumerate().filter(|_| symmetric) {
        for &b in orbits.iter().skip(n + 1) {
            sets.push(Set { members: [members(a), members(b)].concat(), symmetric: true });
        }
    }
    let directions = needs.first().map_or(0, |need| need.relieving.nrows());
    let mut chosen: Vec<usize> = Vec::new();
    let mut cut_short = false;
    for size in 1..=directions.min(useful.len()) {
        combinations(useful.len(), size, &mut chosen, 0, &mut |picked| {
            let members: Vec<usize> = picked.iter().map(|&n| useful[n]).collect();
            cut_short |= sets.len() >= MAX_SETS;
            let known =
                sets.iter().take_while(|set| set.symmetric).any(|set| set.members == members);
            if !cut_short && !known {
                sets.push(Set { members, symmetric: false });
            }
            !cut_short
        });
    }
    (sets, cut_short)
}

/// All combinations of `size` of `count`; ends when `visit` returns `false`.
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
fn estimate(needs: &[Need], members: &[usize]) -> Result<Option<f64>, Error> {
    let mut size = 0.0_f64;
    for Need { open, relieving } in needs {
        let part = relieving.select_columns(members);
        let decomposition = svd(&part)?;
        let y = decomposition.solve(open, decomposition.rank(1e-6));
        if (&part * &y - open).norm() > LEFT_OPEN * open.norm() {
            return Ok(None);
        }
        size = size.max(y.norm());
    }
    Ok(Some(size))
}
