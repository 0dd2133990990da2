//! Suggestion of joints that need play.

use nalgebra::DVector;

use super::principal_directions::{principal, widens};
use super::relief::{Reduced, reduced, size_in_metric};
use super::suggest_options::{SuggestOptions, SuggestionRank};
use super::symmetry::{maps_commands, symmetries};
use super::virtual_candidates::{Candidate, compatible, images, lacking, merged, orbits, stiffen};
use super::virtual_sets::{Class, Kind, Need, Searched, Set, estimate};
use super::{
    BeyondLimits, CommandedJoints, Mechanism, MechanismSystem, Relief, ReliefSolver, VirtualJoint,
    close, relieve,
};
use crate::Error;
use crate::constraint::System as _;

/// Sets of one size tried with the whole kinematics, best first by the linear estimate.
const MAX_TRIED: usize = 150;
/// Corrections tried to see whether a command needs play at all.
const MAX_CORRECTIONS: usize = 100;
/// Displacements that differ by no more than this share of the least are equal.
const EQUAL: f64 = 1e-6;
/// Columns below this share of the largest do nothing.
const NO_EFFECT: f64 = 1e-9;

/// A set of virtual joints that makes commanded motions possible.
#[derive(Debug, Clone, PartialEq)]
pub struct Suggestion {
    /// The virtual joints, ready for [`Mechanism::with_virtual_joints`].
    pub virtual_joints: Vec<VirtualJoint>,
    /// For each virtual joint those in the same leg that relieve the same instantaneous motion.
    pub alternatives: Vec<Vec<VirtualJoint>>,
    /// Whether every symmetry of the mechanism at home maps the set onto itself; `false` where it has none.
    pub symmetric: bool,
    /// Whether every symmetry of the mechanism that maps the commands onto each other maps the set onto itself; `false` where it has none.
    pub symmetric_for_commands: bool,
    /// The largest displacement over the commands, in the metric (m).
    pub size: f64,
    /// The largest elastic energy over the commands, ½ Σ k x² (J); `None` unless ranked by stiffness.
    pub energy: Option<f64>,
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
    /// Largest mismatch of the rigid links at home, in radians and characteristic lengths: above that of closed loops where every set also closes them.
    pub home_residual: f64,
    /// Configuration of the rigid links for each command, if no play is needed: (f) coordinates (m, rad).
    pub without_play: Vec<DVector<f64>>,
    /// Joint coordinates that are beyond their limits there.
    pub beyond_limits: Vec<BeyondLimits>,
    /// Sets, those within joint limits and clearances first, then by their rank.
    ///
    /// A symmetric set holds no smaller symmetric set that is enough, any other set no smaller set at all.
    pub sets: Vec<Suggestion>,
    /// Places and directions that were considered; those that relieve the same motion of one leg count as one.
    pub candidates: usize,
    /// Sets that were compared by the linear estimate.
    pub compared: usize,
    /// Sets in the class that was searched, compared or not.
    pub in_class: f64,
    /// Lower bound of the displacement of any set of the class, in the metric (m).
    ///
    /// It is the least displacement with all candidates at once: a set with fewer is the same mechanism with the others held at rest, so that its least displacement is no smaller.
    /// Sets with alternatives in place of candidates may deviate from it by terms of higher order.
    pub lower_bound: f64,
    /// Lower bound of the elastic energy of any set of the class, for the same reason (J); `None` unless ranked by stiffness.
    pub least_energy: Option<f64>,
    /// Sets that the linear estimate took for possible, but that were not tried with the whole kinematics.
    pub untried: usize,
    /// Whether the search was cut short at its limit.
    pub cut_short: bool,
}

impl Suggestion {
    /// Whether no virtual joint is displaced beyond the clearance of its joint, as far as clearances are known.
    #[must_use]
    pub fn is_within_clearances(&self) -> bool {
        let all = self.virtual_joints.iter().zip(&self.largest);
        all.into_iter().all(|(joint, x)| joint.clearance.is_none_or(|most| *x <= most))
    }

    /// The largest displacement of a single virtual joint, turns multiplied by a length (m).
    #[must_use]
    pub fn largest_in_metric(&self, length: f64) -> f64 {
        let sizes = self.virtual_joints.iter().zip(&self.largest).map(|(joint, x)| {
            let turns = matches!(joint.motion, super::VirtualMotion::Turn { .. });
            if turns { x * length } else { *x }
        });
        sizes.fold(0.0, f64::max)
    }
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
/// Candidates are the slides and turns that each joint lacks: radial, tangential and normal on the link that carries more joints, and the principal directions of the displacements that the commands ask for.
/// Joints in series are a leg; slides of a leg along one direction relieve the same motion and are one candidate, at the joint with the most freedoms.
/// Two slides of one leg are in one set only if they are orthogonal: a division of a displacement among several slides of a leg does not make it smaller.
/// Symmetric sets are unions of orbits of candidates under the symmetries of the mechanism, and under those of them that map the commands onto each other; they are compared first.
/// A set makes a command possible where what the command opens lies in the span of what the set can do; the best are tried with the whole kinematics.
/// Ranked by stiffness, the displacement of a set is the one of least elastic energy, not of least size, and of the joints of a leg that could have the same slide, the one with the least stiffness has it.
/// Joints that the commands leave undetermined stay as near home as they can, see [`CommandedJoints`].
///
/// # Arguments
/// * `home` – (f) coordinates without virtual joints, closed or nearly closed, see [`super::close_nearly`] (m, rad)
/// * `commanded` – indices of the commanded coordinates
/// * `commands` – values of these coordinates, a vector for each command (m, rad)
/// * `options` – extent and order of the search
///
/// # Errors
/// [`Error::NoStiffness`] for a rank by stiffness; [`Error::NotRelieved`] where not even all candidates together make a command possible; those of [`relieve`] and [`CommandedJoints::new`].
pub fn suggest(
    mechanism: &Mechanism,
    home: &DVector<f64>,
    commanded: &[usize],
    commands: &[DVector<f64>],
    options: &SuggestOptions,
) -> Result<Suggestions, Error> {
    let f = mechanism.joint_freedoms();
    super::kinematics::check_coordinates(home, f)?;
    if let Some(found) = commands.iter().find(|command| command.len() != commanded.len()) {
        let (found, expected) = (found.len(), commanded.len());
        return Err(Error::LengthMismatch { what: "a command", found, expected });
    }
    let bare = with(mechanism, &[]);
    let at_home = MechanismSystem::new(&bare, home.clone())?;
    let home_residual = at_home.mismatch(&at_home.at_home());
    let commanded = CommandedJoints::new(&at_home, commanded)?;
    if let Some(without_play) = possible_without_play(&at_home, &commanded, commands)? {
        return Ok(Suggestions {
            needed: false,
            home_residual,
            beyond_limits: beyond(&bare, &without_play),
            without_play,
            sets: Vec::new(),
            candidates: 0,
            compared: 0,
            in_class: 0.0,
            lower_bound: 0.0,
            least_energy: None,
            untried: 0,
            cut_short: false,
        });
    }
    let links = at_home.kinematics().link_poses(home)?;
    let mut candidates = merged(&at_home, lacking(&at_home)?, &links);
    let by_stiffness = options.rank == SuggestionRank::Stiffness;
    if by_stiffness {
        stiffen(mechanism, &mut candidates, options.stiffness)?;
    }
    let mut reliefs = Vec::new();
    for command in commands {
        reliefs.push(relieved(mechanism, &commanded, command, &candidates)?);
    }
    let displacements: Vec<_> = reliefs.iter().map(|one| one.virtual_joints.clone()).collect();
    let mut asked = principal(&at_home, &candidates, &links, &displacements)?;
    let mut widens = widens(&at_home, &candidates, &asked, &links);
    if by_stiffness {
        stiffen(mechanism, &mut asked, options.stiffness)?;
        // At a joint that is less stiff than others of its leg, a principal direction needs less energy.
        widens = !asked.is_empty();
    }
    candidates.extend(asked);
    let all: Vec<VirtualJoint> = candidates.iter().map(|c| c.joint.clone()).collect();
    let least = |candidates: &[Candidate]| -> Result<f64, Error> {
        let of_command = |command| relieved(mechanism, &commanded, command, candidates);
        commands.iter().try_fold(0.0, |most: f64, one| Ok(most.max(of_command(one)?.size)))
    };
    let largest = reliefs.iter().map(|one| one.size).fold(0.0, f64::max);
    let lower_bound = if widens { least(&candidates)? } else { largest };
    let (lower_bound, least_energy) = if by_stiffness {
        let mut without = candidates.clone();
        without.iter_mut().for_each(|one| one.joint.stiffness = None);
        (least(&without)?, Some(0.5 * lower_bound * lower_bound))
    } else {
        (lower_bound, None)
    };
    let with_all = with(mechanism, &all);
    let mut needs = Vec::new();
    for relief in reliefs {
        // Principal directions are at rest.
        let here = relief.coordinates.resize_vertically(f + all.len(), 0.0);
        let y = relief.virtual_joints.resize_vertically(all.len(), 0.0);
        let here = MechanismSystem::new(&with_all, here)?
            .with_characteristic_length(commanded.characteristic_length())?;
        let Reduced { relieving, roots, .. } = reduced(&here, &commanded)?;
        needs.push(Need { open: &relieving * y.component_mul(&roots), relieving });
    }
    let compatible = compatible(&at_home, &candidates, &links);
    let symmetries = symmetries(&at_home, home)?;
    let of_mechanism = images(&at_home, &links, &candidates, &symmetries);
    let of_commands: Vec<_> = std::iter::zip(&symmetries, &of_mechanism)
        .filter(|(symmetry, _)| maps_commands(&at_home, &links, symmetry, &commanded, commands))
        .map(|(_, image)| image.clone())
        .collect();
    let mut groups = Vec::new();
    if !of_mechanism.is_empty() {
        groups.push((Kind::Mechanism, orbits(candidates.len(), &of_mechanism)));
    }
    if !of_commands.is_empty() && of_commands.len() < of_mechanism.len() {
        groups.push((Kind::Commands, orbits(candidates.len(), &of_commands)));
    }
    let useful: Vec<usize> = (0..all.len())
        .filter(|&k| {
            needs.iter().any(|Need { relieving: a, .. }| a.column(k).amax() > NO_EFFECT * a.amax())
        })
        .collect();
    let class = Class { useful, compatible, orbits: groups };
    let Searched { sets, cut_short, in_class } = class.sets(&needs, options);
    let compared = sets.len();
    let mut estimated: Vec<(f64, Set)> = Vec::new();
    for set in sets {
        if let Some(size) = estimate(&needs, &set.members)? {
            estimated.push((size, set));
        }
    }
    // Symmetric sets first. Small sets first, so that a set is seen to hold one that is enough; of one size the best by the estimate.
    estimated.sort_by(|a, b| {
        let key = |(_, set): &(f64, Set)| (set.kind, set.members.len());
        key(a).cmp(&key(b)).then(a.0.total_cmp(&b.0))
    });
    let mut found: Vec<(Set, Suggestion)> = Vec::new();
    let (mut of_size, mut tries, mut untried) = ((Kind::Mechanism, 0), 0, 0);
    for (_, set) in estimated {
        let size = (set.kind, set.members.len());
        if size != of_size {
            (of_size, tries) = (size, 0);
        }
        let smaller = |(known, _): &(Set, Suggestion)| {
            known.members.iter().all(|member| set.members.contains(member))
        };
        if found.iter().any(smaller) {
            continue;
        }
        tries += 1;
        if tries > MAX_TRIED {
            untried += 1;
            continue;
        }
        let chosen: Vec<&Candidate> = set.members.iter().map(|&k| &candidates[k]).collect();
        if let Some(mut suggestion) = tried(mechanism, &commanded, commands, &chosen)? {
            suggestion.symmetric = is_symmetric(&set.members, &of_mechanism);
            suggestion.symmetric_for_commands = is_symmetric(&set.members, &of_commands);
            found.push((set, suggestion));
        }
    }
    let length = at_home.characteristic_length();
    let rank = |set: &Suggestion| match options.rank {
        SuggestionRank::Norm => set.size,
        SuggestionRank::Largest => set.largest_in_metric(length),
        SuggestionRank::Stiffness => set.energy.unwrap_or(f64::INFINITY),
    };
    let mut sets: Vec<Suggestion> = found.into_iter().map(|(_, suggestion)| suggestion).collect();
    let least = sets.iter().map(rank).fold(f64::INFINITY, f64::min);
    sets.sort_by(|a, b| {
        let outside =
            |set: &Suggestion| !set.beyond_limits.is_empty() || !set.is_within_clearances();
        // Of equal displacements the symmetric one, then the one with fewer virtual joints.
        let equal = |set: &Suggestion| (rank(set) / (least * EQUAL)).round();
        let joints = |set: &Suggestion| {
            (!set.symmetric, !set.symmetric_for_commands, set.virtual_joints.len())
        };
        outside(a)
            .cmp(&outside(b))
            .then(equal(a).total_cmp(&equal(b)))
            .then(joints(a).cmp(&joints(b)))
            .then(rank(a).total_cmp(&rank(b)))
    });
    Ok(Suggestions {
        needed: true,
        home_residual,
        without_play: Vec::new(),
        beyond_limits: Vec::new(),
        sets,
        candidates: all.len(),
        compared,
        in_class,
        lower_bound,
        least_energy,
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
        let start = home.with_home(commanded.start(command.iter().copied(), 0))?;
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

fn with(mechanism: &Mechanism, virtual_joints: &[VirtualJoint]) -> Mechanism {
    mechanism
        .clone()
        .with_virtual_joints(virtual_joints.to_vec())
        .expect("candidates have names and joints of their own")
}

/// The least displacement of candidates for a command.
fn relieved(
    mechanism: &Mechanism,
    commanded: &CommandedJoints,
    command: &DVector<f64>,
    candidates: &[Candidate],
) -> Result<Relief, Error> {
    let all: Vec<VirtualJoint> = candidates.iter().map(|one| one.joint.clone()).collect();
    commanded.relieve(&with(mechanism, &all), command.iter().copied(), ReliefSolver::LeastNorm)
}

/// Displacements of a set over all commands, if it makes all of them possible.
fn tried(
    mechanism: &Mechanism,
    commanded: &CommandedJoints,
    commands: &[DVector<f64>],
    chosen: &[&Candidate],
) -> Result<Option<Suggestion>, Error> {
    let alternatives = chosen.iter().map(|one| one.alternatives.clone()).collect();
    let chosen: Vec<VirtualJoint> = chosen.iter().map(|one| one.joint.clone()).collect();
    let relieved = with(mechanism, &chosen);
    let f = relieved.joint_freedoms();
    let elastic = !chosen.is_empty() && chosen.iter().all(|one| one.stiffness.is_some());
    let (mut size, mut energy) = (0.0_f64, elastic.then_some(0.0_f64));
    let mut largest = vec![0.0_f64; chosen.len()];
    let mut configurations = Vec::with_capacity(commands.len());
    for command in commands {
        let system = commanded.system(&relieved, command.iter().copied())?;
        let relief = match relieve(&system, commanded, ReliefSolver::LeastNorm) {
            Ok(relief) => relief,
            Err(Error::NotRelieved { .. } | Error::NotLeast { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        size = size.max(size_in_metric(&system, &relief.virtual_joints));
        energy = energy.map(|most| most.max(0.5 * relief.size * relief.size));
        for (most, x) in largest.iter_mut().zip(relief.virtual_joints.iter()) {
            *most = most.max(x.abs());
        }
        configurations.push(relief.coordinates.rows(0, f).into_owned());
    }
    let beyond_limits = beyond(mechanism, &configurations);
    Ok(Some(Suggestion {
        virtual_joints: chosen,
        alternatives,
        symmetric: false,
        symmetric_for_commands: false,
        size,
        energy,
        largest,
        configurations,
        beyond_limits,
    }))
}
