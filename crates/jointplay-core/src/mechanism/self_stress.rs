//! Self-stresses: redundant constraints as wrenches in equilibrium, each in as few joints as possible.

use nalgebra::{DMatrix, DVector, Matrix3, Unit, Vector3};

use super::span::Span;
use super::supports::{Evidence, Support};
use super::symmetry::{Symmetry, symmetries};
use super::{JointKind, MechanismSystem};
use crate::Error;
use crate::linalg::LinalgError;
use crate::mobility::InstantaneousMobility;

/// Least share of a self-stress that counts as a part of it.
const LEAST_SHARE: f64 = 1e-9;
/// The null space is inaccurate by threshold over least singular value; shares up to this many times that count as none.
const ROUND_OFF: f64 = 16.0;
/// Supports that are enumerated before the basis is only the best found.
const MAX_SUPPORTS: usize = 2_000;
/// Supports of single components that are enumerated in search of a simple self-stress.
const MAX_COMPONENT_SUPPORTS: usize = 200;
/// Subspaces of more dimensions are searched in the axes of the base alone.
const MAX_DIMENSION: usize = 3;
/// Wrenches and lines that differ by no more than this are the same.
const PARALLEL: f64 = 1e-6;

/// A wrench that the mechanism carries in itself, without an external load.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfStress {
    /// The joints that carry it, with their wrenches; the largest entry of all is ±1.
    pub wrenches: Vec<JointWrench>,
    /// The couplings that carry it, with their forces, which the largest entry of all includes.
    pub couplings: Vec<CouplingForce>,
    /// Line of action of the wrench that all of them transmit, or of the largest one if they differ.
    pub screw: StressScrew,
    /// Whether every joint of it transmits the same wrench, in either sense.
    pub single_loop: bool,
    /// Number of its group: self-stresses of one group are mapped onto each other by symmetries of the mechanism.
    pub group: usize,
    /// Whether it is a member of the basis; the others of its group depend on the basis.
    pub independent: bool,
}

/// Wrench that a joint carries in a self-stress, in the base frame about [`MechanismSystem::reference`].
///
/// It acts on the second link of the joint, and its opposite on the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointWrench {
    /// Index of the joint.
    pub joint: usize,
    /// Moment.
    pub moment: Vector3<f64>,
    /// Force times the characteristic length.
    pub force: Vector3<f64>,
    /// Place of the joint, in the base frame (m).
    pub place: Vector3<f64>,
    /// Moment about that place.
    pub moment_at_place: Vector3<f64>,
}

/// Force of a coupling in a self-stress, on the combination of its coordinates that has length 1 in radians and characteristic lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CouplingForce {
    /// Index of the coupling.
    pub coupling: usize,
    /// Force.
    pub force: f64,
}

impl JointWrench {
    fn largest(&self) -> f64 {
        self.moment.amax().max(self.force.amax())
    }
}

/// Line of action of a wrench, in the base frame.
#[derive(Debug, Clone, PartialEq)]
pub enum StressScrew {
    /// No wrench: the forces of couplings alone.
    Couplings,
    /// A moment alone.
    Moment {
        /// Direction of the moment.
        direction: Unit<Vector3<f64>>,
    },
    /// A force along a line, with a moment about it where the pitch is not zero.
    Force {
        /// Direction of the line.
        direction: Unit<Vector3<f64>>,
        /// Point of the line nearest the middle of the joints (m).
        point: Vector3<f64>,
        /// Moment over force (m); zero for a pure force.
        pitch: f64,
        /// Indices of the spherical joints of the self-stress whose centres the line contains.
        centers: Vec<usize>,
    },
}

/// Self-stresses of a configuration: a sparsest basis, and what symmetries map it onto.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfStresses {
    /// By group; in each group those of the basis first.
    pub stresses: Vec<SelfStress>,
    /// Indices of the joints that take part in all self-stresses.
    pub in_all: Vec<usize>,
    /// Indices of the couplings that take part in all self-stresses.
    pub couplings_in_all: Vec<usize>,
    /// Whether no basis has fewer joints in total; else the basis is the best one found.
    pub sparsest: bool,
    /// Largest share of a self-stress that counts as none, if there is one.
    pub largest_zero: f64,
    /// Smallest share of a self-stress that counts.
    pub smallest_nonzero: f64,
}

/// A sparsest basis of the self-stresses: of all bases the one with the fewest joints in total.
///
/// # Errors
/// [`Error::Linalg`] (never seen).
///
/// # Numerics
/// Self-stresses are vectors, their number of joints is a weight, and independent sets of vectors are a matroid.
/// So the greedy choice is optimal: take the lightest self-stress that does not depend on those taken before.
/// The self-stresses within a set of joints are a subspace; all such subspaces are enumerated by setting the wrenches of one joint after another to zero.
/// Each self-stress v lies in the subspace of its own joints, which this enumeration meets, so that the choice is among all self-stresses.
/// Beyond [a limit](SelfStresses::sparsest) of subspaces and of the work that they need, the choice is among those found and the self-stresses of an elimination with full pivoting, each of which is zero at the pivots of all others.
/// Self-stresses of the same joints are chosen by the fewest components, in the axes of the base or of one of the joints.
///
/// # Source
/// Optimality of the greedy choice: \[Edmonds\]; self-stress: \[ConnellyWhiteley\]
pub fn self_stresses(
    system: &MechanismSystem<'_>,
    first: &InstantaneousMobility,
) -> Result<SelfStresses, Error> {
    let redundancy = first.redundancy;
    let gap = first.smallest_nonzero().map_or(0.0, |least| first.threshold / least);
    let mut evidence = Evidence {
        tolerance: LEAST_SHARE.max(ROUND_OFF * gap),
        largest_zero: 0.0,
        smallest_nonzero: 1.0,
    };
    let all = joint_wrenches(system, first);
    let joints = system.cycles().ncols();
    let couplings = system.kinematics().mechanism().couplings().len();
    let rows = |block: usize| block_rows(block, joints);
    let block = |block: usize| all.rows_range(rows(block)).into_owned();
    let blocks: Vec<DMatrix<f64>> = (0..joints + couplings).map(block).collect();
    let whole = DMatrix::identity(redundancy, redundancy);
    let (mut supports, sparsest) = evidence.supports(&blocks, &whole, MAX_SUPPORTS)?;
    if !sparsest {
        // A choice within subspaces of several dimensions would take as long as the enumeration.
        supports.retain(|one| one.basis.ncols() == 1);
        supports.extend(evidence.eliminated(&all, &blocks));
    }
    supports.sort_by(|a, b| (a.blocks.len(), &a.blocks).cmp(&(b.blocks.len(), &b.blocks)));
    let symmetries = symmetries(system, system.home())?;
    let places = Places::of(system);
    let mut span = Span { vectors: Vec::new(), most: redundancy };
    let mut groups: Vec<Vec<(DVector<f64>, bool)>> = Vec::new();
    for support in &supports {
        while let Some(found) = evidence.simplest(&all, support, &span, &places)? {
            let images: Vec<DVector<f64>> =
                symmetries.iter().filter_map(|one| image(system, &all, one, &found)).collect();
            // It is outside the span, even if its angle with a known one is small: each round extends the span.
            let independent = span.add(&found);
            let mut group = vec![(found, independent)];
            for one in images {
                let parallel =
                    |(other, _): &(DVector<f64>, bool)| other.dot(&one).abs() > 1.0 - PARALLEL;
                if !groups.iter().chain([&group]).flatten().any(parallel) {
                    let independent = span.add(&one);
                    group.push((one, independent));
                }
            }
            group.sort_by_key(|&(_, independent)| !independent);
            groups.push(group);
        }
    }
    let mut stresses = Vec::new();
    for (n, group) in groups.iter().enumerate() {
        for (coefficients, independent) in group {
            let found = described(system, &places, &(&all * coefficients), evidence.tolerance);
            stresses.push(SelfStress { group: n, independent: *independent, ..found });
        }
    }
    let (mut in_all, mut couplings_in_all) = (Vec::new(), Vec::new());
    for (b, block) in blocks.iter().enumerate().filter(|_| redundancy > 0) {
        // With fewer rows than self-stresses, some of them do without the block.
        if block.nrows() >= redundancy && evidence.kernel(block, &whole)?.ncols() == 0 {
            match b.checked_sub(joints) {
                None => in_all.push(b),
                Some(coupling) => couplings_in_all.push(coupling),
            }
        }
    }
    let Evidence { largest_zero, smallest_nonzero, .. } = evidence;
    Ok(SelfStresses {
        stresses,
        in_all,
        couplings_in_all,
        sparsest,
        largest_zero,
        smallest_nonzero,
    })
}

/// Rows of a joint or, beyond the joints, of a coupling.
fn block_rows(block: usize, joints: usize) -> std::ops::Range<usize> {
    match block.checked_sub(joints) {
        None => 6 * block..6 * block + 6,
        Some(coupling) => 6 * joints + coupling..6 * joints + coupling + 1,
    }
}

/// (6·joints + couplings, redundancy) wrench of each joint and force of each coupling in each basis self-stress; the columns are orthonormal, since cycles and self-stresses are.
fn joint_wrenches(system: &MechanismSystem<'_>, first: &InstantaneousMobility) -> DMatrix<f64> {
    let cycles = system.cycles();
    let (loops, joints) = cycles.shape();
    let couplings = system.kinematics().mechanism().couplings().len();
    DMatrix::from_fn(6 * joints + couplings, first.redundancy, |row, s| {
        if let Some(coupling) = row.checked_sub(6 * joints) {
            return first.self_stress[(6 * loops + coupling, s)];
        }
        let (j, part) = (row / 6, row % 6);
        (0..cycles.nrows()).map(|l| cycles[(l, j)] * first.self_stress[(6 * l + part, s)]).sum()
    })
}

/// Frames of the joints, in the base frame.
struct Places {
    /// Origin of each joint frame (m).
    points: Vec<Vector3<f64>>,
    /// Axes of each joint frame, in columns.
    axes: Vec<Matrix3<f64>>,
    reference: Vector3<f64>,
    length: f64,
}

impl Places {
    fn of(system: &MechanismSystem<'_>) -> Self {
        let zero = DVector::zeros(system.home().len());
        let placed = system.kinematics().placed(system.home(), &zero, &system.reference(), None);
        let joints = system.kinematics().mechanism().joints();
        let frames: Vec<_> =
            joints.iter().map(|joint| placed.links[joint.links[0]] * joint.frames[0]).collect();
        Self {
            points: frames.iter().map(|frame| frame.translation.vector).collect(),
            axes: frames.iter().map(|frame| *frame.rotation.matrix()).collect(),
            reference: system.reference(),
            length: crate::constraint::System::characteristic_length(system),
        }
    }
}

impl Evidence {
    /// The self-stress within a support that is outside a span and has the fewest components, in the axes of the base or of a joint.
    fn simplest(
        &mut self,
        all: &DMatrix<f64>,
        support: &Support,
        span: &Span,
        places: &Places,
    ) -> Result<Option<DVector<f64>>, LinalgError> {
        let candidate = |column: usize| support.basis.column(column).into_owned();
        let first = (0..support.basis.ncols()).map(candidate).find(|vector| span.excludes(vector));
        if support.basis.ncols() == 1 || first.is_none() {
            return Ok(first);
        }
        let mut best: Option<(usize, DVector<f64>)> = None;
        let small = support.basis.ncols() <= MAX_DIMENSION;
        let of_joints = |j: &usize| small && *j < places.points.len();
        let joints = support.blocks.iter().copied().filter(of_joints);
        let frames = std::iter::once(None).chain(joints.map(Some));
        for frame in frames {
            let rows = components(all, support, frame, places);
            let (found, _) = self.supports(&rows, &support.basis, MAX_COMPONENT_SUPPORTS)?;
            for Support { blocks, basis } in found.iter().filter(|one| one.basis.ncols() == 1) {
                let vector = basis.column(0).into_owned();
                let fewer = best.as_ref().is_none_or(|(count, _)| blocks.len() < *count);
                if fewer && span.excludes(&vector) {
                    best = Some((blocks.len(), vector));
                }
            }
        }
        Ok(best.map(|(_, vector)| vector).or(first))
    }
}

/// Components of the wrenches of the joints of a support, each a row: about the reference point in the base axes, or about the place of a joint in its axes.
fn components(
    all: &DMatrix<f64>,
    support: &Support,
    frame: Option<usize>,
    places: &Places,
) -> Vec<DMatrix<f64>> {
    let mut rows = Vec::with_capacity(6 * support.blocks.len());
    let (axes, arm) = frame.map_or((Matrix3::identity(), Vector3::zeros()), |at| {
        (places.axes[at], (places.reference - places.points[at]) / places.length)
    });
    let (turn, cross) = (axes.transpose(), arm.cross_matrix());
    for &j in &support.blocks {
        let Some(joint_rows) = (j < places.points.len()).then_some(6 * j) else {
            rows.push(all.rows_range(block_rows(j, places.points.len())).into_owned());
            continue;
        };
        let force = all.rows(joint_rows + 3, 3);
        let moment = all.rows(joint_rows, 3) + cross * force;
        for part in [turn * moment, turn * force] {
            let row = |axis: usize| DMatrix::from_fn(1, part.ncols(), |_, c| part[(axis, c)]);
            rows.extend((0..3).map(row));
        }
    }
    rows
}

/// The self-stress that a symmetry maps one onto, unless the symmetry is none of the self-stresses.
fn image(
    system: &MechanismSystem<'_>,
    all: &DMatrix<f64>,
    symmetry: &Symmetry,
    coefficients: &DVector<f64>,
) -> Option<DVector<f64>> {
    let joints = system.kinematics().mechanism().joints();
    let from = all * coefficients;
    let mut to = DVector::zeros(from.len());
    for (j, &onto) in symmetry.joints.iter().enumerate() {
        // Wrenches act on the second link of a joint, which may be mapped onto the first of the other.
        let reversed = symmetry.links[joints[j].links[0]] != joints[onto].links[0];
        let sense = if reversed { -1.0 } else { 1.0 };
        let force = symmetry.turn * from.fixed_rows::<3>(6 * j + 3) * sense;
        // Moments are axial vectors.
        let moment = symmetry.turn * from.fixed_rows::<3>(6 * j) * sense;
        let moment = moment * symmetry.turn.determinant();
        to.fixed_rows_mut::<3>(6 * onto).copy_from(&moment);
        to.fixed_rows_mut::<3>(6 * onto + 3).copy_from(&force);
    }
    let image = all.transpose() * &to;
    ((all * &image - &to).norm() < PARALLEL).then(|| image.normalize())
}

/// Wrenches and line of action of a self-stress.
///
/// # Arguments
/// * `all` – (6·joints + couplings) its wrenches and forces, of norm 1
fn described(
    system: &MechanismSystem<'_>,
    places: &Places,
    all: &DVector<f64>,
    tolerance: f64,
) -> SelfStress {
    let larger = |a: f64, b: &f64| if b.abs() > a.abs() * (1.0 + PARALLEL) { *b } else { a };
    let scale = all.iter().fold(0.0, larger);
    let part = |row: usize| {
        let part: Vector3<f64> = all.fixed_rows::<3>(row).into_owned();
        part.map(|value| if value.abs() <= tolerance { 0.0 } else { value / scale })
    };
    let joints = system.kinematics().mechanism().joints();
    let wrenches: Vec<JointWrench> = (0..joints.len())
        .map(|joint| {
            let (moment, force) = (part(6 * joint), part(6 * joint + 3));
            let arm = (places.reference - places.points[joint]) / places.length;
            let moment_at_place = moment + arm.cross(&force);
            JointWrench { joint, moment, force, place: places.points[joint], moment_at_place }
        })
        .filter(|wrench| wrench.largest() > 0.0)
        .collect();
    let forces = all.iter().skip(6 * joints.len()).enumerate();
    let couplings = forces
        .filter(|(_, force)| force.abs() > tolerance)
        .map(|(coupling, force)| CouplingForce { coupling, force: force / scale })
        .collect();
    let main = wrenches
        .iter()
        .reduce(|a, b| if b.largest() > a.largest() * (1.0 + PARALLEL) { b } else { a });
    let Some(main) = main else {
        let screw = StressScrew::Couplings;
        let (group, single_loop, independent) = (0, false, false);
        return SelfStress { wrenches, couplings, screw, single_loop, group, independent };
    };
    let same = |other: &JointWrench| {
        [1.0, -1.0].iter().any(|sense| {
            let moment = main.moment - other.moment * *sense;
            let force = main.force - other.force * *sense;
            moment.amax().max(force.amax()) <= PARALLEL
        })
    };
    let balls: Vec<usize> = wrenches
        .iter()
        .map(|wrench| wrench.joint)
        .filter(|&joint| joints[joint].kind == JointKind::Spherical)
        .collect();
    SelfStress {
        screw: screw(main, places, &balls),
        single_loop: wrenches.iter().all(same),
        wrenches,
        couplings,
        group: 0,
        independent: false,
    }
}

/// Line of action of a wrench, with the balls whose centres it contains.
fn screw(wrench: &JointWrench, places: &Places, balls: &[usize]) -> StressScrew {
    let (force, moment) = (wrench.force, wrench.moment);
    let Some(direction) = Unit::try_new(force, PARALLEL) else {
        return StressScrew::Moment { direction: Unit::new_normalize(moment) };
    };
    let squared = force.norm_squared();
    let point = places.reference + force.cross(&moment) / squared * places.length;
    let pitch = force.dot(&moment) / squared;
    let pitch = if pitch.abs() <= PARALLEL { 0.0 } else { pitch * places.length };
    let on_line = |joint: &usize| {
        let off = (places.points[*joint] - point).cross(&direction);
        pitch == 0.0 && off.norm() <= PARALLEL * places.length
    };
    StressScrew::Force {
        direction,
        point,
        pitch,
        centers: balls.iter().copied().filter(on_line).collect(),
    }
}
