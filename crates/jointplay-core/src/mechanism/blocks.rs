//! Blocks of a mechanism: parts whose loops have no joint in common, each analysed by itself.

use nalgebra::DVector;

use super::{Coupling, JointCoordinate, Mechanism, MechanismSystem, MobilityClass};
use crate::Error;
use crate::mobility::{
    BoundOrigin, FiniteMobility, ForcedClosure, FreeMotions, branch_dimensions, finite_mobility,
    instantaneous_mobility,
};

/// A biconnected component of the graph of links and joints, or several of them that couplings connect, with those between them.
///
/// A joint on no loop and in no coupling is a block of its own, and all of its freedoms are motions.
/// Every loop and every coupling lies in one block, so that mobilities and redundant constraints of a mechanism are sums over its blocks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// Indices of its joints, ascending.
    pub joints: Vec<usize>,
    /// Index of the link that carries it: of its links the one nearest the base.
    pub base: usize,
    /// Indices of its couplings, ascending.
    pub couplings: Vec<usize>,
}

impl Block {
    /// Whether it has a loop or a coupling; a block without constraints is a single joint.
    #[must_use]
    pub fn has_constraints(&self) -> bool {
        self.joints.len() > 1 || !self.couplings.is_empty()
    }

    /// The block as a mechanism with its carrying link as base, and the index of each of its links in the whole mechanism.
    pub(super) fn mechanism(&self, whole: &Mechanism) -> (Mechanism, Vec<usize>) {
        let local_joint = |joint: usize| self.joints.binary_search(&joint).ok();
        let mut links = vec![self.base];
        let mut joints = Vec::with_capacity(self.joints.len());
        let mut local = std::collections::BTreeMap::from([(self.base, 0)]);
        for &j in &self.joints {
            let mut joint = whole.joints()[j].clone();
            joint.links = joint.links.map(|link| {
                *local.entry(link).or_insert_with(|| {
                    links.push(link);
                    links.len() - 1
                })
            });
            joints.push(joint);
        }
        let virtual_joints = whole
            .virtual_joints()
            .iter()
            .filter_map(|one| {
                let joint = local_joint(one.joint)?;
                Some(super::VirtualJoint { joint, ..one.clone() })
            })
            .collect();
        let moved = |one: JointCoordinate| {
            let joint = local_joint(one.joint).expect("a coupling is in the block of its joints");
            JointCoordinate { joint, ..one }
        };
        let couplings = self.couplings.iter().map(|&c| {
            let coupling = &whole.couplings()[c];
            let terms = coupling.terms.iter().map(|&(one, ratio)| (moved(one), ratio)).collect();
            Coupling { follower: moved(coupling.follower), terms, ..coupling.clone() }
        });
        let couplings = couplings.collect();
        let names = links.iter().map(|&link| whole.links()[link].clone()).collect();
        let valid = "a block of a valid mechanism is one";
        let mut block = Mechanism::new(whole.name(), names, joints)
            .and_then(|block| block.with_virtual_joints(virtual_joints))
            .and_then(|block| block.with_couplings(couplings))
            .expect(valid);
        block.characteristic_length = whole.characteristic_length();
        (block, links)
    }

    /// Indices of its coordinates among those of the whole mechanism: of its joints, then of its virtual joints.
    pub(super) fn coordinates(&self, kinematics: &super::Kinematics<'_>) -> Vec<usize> {
        let whole = kinematics.mechanism();
        let of_joints = self.joints.iter().flat_map(|&j| kinematics.coordinates_of(j));
        let first = whole.joint_freedoms();
        let on_block = |&(_, one): &(usize, &super::VirtualJoint)| {
            self.joints.binary_search(&one.joint).is_ok()
        };
        let virtual_joints = whole.virtual_joints().iter().enumerate().filter(on_block);
        of_joints.chain(virtual_joints.map(|(m, _)| first + m)).collect()
    }
}

/// Blocks of a mechanism, in the order of their first joints.
///
/// # Numerics
/// O(links + joints), one depth-first search without recursion.
///
/// # Source
/// \[Tarjan\]
#[must_use]
pub fn blocks(mechanism: &Mechanism) -> Vec<Block> {
    let joints = mechanism.joints();
    let mut at_link = vec![Vec::new(); mechanism.links().len()];
    for (j, joint) in joints.iter().enumerate() {
        joint.links.iter().for_each(|&link| at_link[link].push(j));
    }
    // Order of discovery, from 1; the earliest link reached from a link or from those beyond it.
    let (mut found, mut earliest) = (vec![0; at_link.len()], vec![0; at_link.len()]);
    let (mut open, mut blocks) = (Vec::new(), Vec::new());
    // Each link of the current path with the joint it was reached over, and how many of its joints are done.
    let mut path = vec![(0, usize::MAX, 0)];
    (found[0], earliest[0]) = (1, 1);
    let mut count = 1;
    while let Some(&mut (link, over, ref mut done)) = path.last_mut() {
        if let Some(&j) = at_link[link].get(*done) {
            *done += 1;
            let [first, second] = joints[j].links;
            let other = if first == link { second } else { first };
            if j == over {
                continue;
            }
            if found[other] == 0 {
                count += 1;
                (found[other], earliest[other]) = (count, count);
                open.push(j);
                path.push((other, j, 0));
            } else if found[other] < found[link] {
                open.push(j);
                earliest[link] = earliest[link].min(found[other]);
            }
            continue;
        }
        path.pop();
        let Some(&(before, _, _)) = path.last() else { break };
        earliest[before] = earliest[before].min(earliest[link]);
        if earliest[link] >= found[before] {
            let from = open.iter().rposition(|&j| j == over).expect("the path is open");
            let mut joints = open.split_off(from);
            joints.sort_unstable();
            blocks.push(Block { joints, base: before, couplings: Vec::new() });
        }
    }
    let mut blocks = coupled(mechanism, blocks);
    blocks.sort_by_key(|block| block.joints[0]);
    blocks
}

/// Blocks with those of each coupling merged, and those between them, so that each is connected.
///
/// # Arguments
/// * `blocks` – biconnected components, each after those that it carries
fn coupled(mechanism: &Mechanism, blocks: Vec<Block>) -> Vec<Block> {
    if mechanism.couplings().is_empty() {
        return blocks;
    }
    let joints = mechanism.joints();
    let mut block_of = vec![0; joints.len()];
    // The block that a link was reached over; none for the base.
    let mut carried_by = vec![None; mechanism.links().len()];
    for (b, block) in blocks.iter().enumerate() {
        for &j in &block.joints {
            block_of[j] = b;
            let links = joints[j].links.into_iter().filter(|&link| link != block.base);
            links.for_each(|link| carried_by[link] = Some(b));
        }
    }
    let carriers = |block: usize| -> Vec<usize> {
        std::iter::successors(Some(block), |&b| carried_by[blocks[b].base]).collect()
    };
    // Blocks with the same label become one.
    let mut label: Vec<usize> = (0..blocks.len()).collect();
    let mut merge = |a: usize, b: usize| {
        let (from, to) = (label[a], label[b]);
        label.iter_mut().filter(|one| **one == from).for_each(|one| *one = to);
    };
    for coupling in mechanism.couplings() {
        let first = block_of[coupling.follower.joint];
        for (other, _) in &coupling.terms {
            let (mut one, mut other) = (carriers(first), carriers(block_of[other.joint]));
            // Both paths end at the base; what they have in common does not lie between the blocks.
            let mut last = None;
            while one.last().is_some() && one.last() == other.last() {
                last = one.pop();
                other.pop();
            }
            let bases = [&one, &other].map(|path| path.last().map(|&b| blocks[b].base));
            let meets = bases[0].is_some() && bases[0] == bases[1];
            let between = one.into_iter().chain(other).chain(last.filter(|_| !meets));
            between.for_each(|b| merge(b, first));
        }
    }
    let mut merged: Vec<Block> = Vec::new();
    let mut place = vec![None; blocks.len()];
    // A block that carries others follows them.
    for (b, block) in blocks.iter().enumerate() {
        match place[label[b]] {
            None => {
                place[label[b]] = Some(merged.len());
                merged.push(block.clone());
            }
            Some(at) => {
                let one: &mut Block = &mut merged[at];
                one.joints.extend(&block.joints);
                one.base = block.base;
            }
        }
    }
    for (c, coupling) in mechanism.couplings().iter().enumerate() {
        let at = place[label[block_of[coupling.follower.joint]]].expect("every block has a place");
        merged[at].couplings.push(c);
    }
    merged.iter_mut().for_each(|block| block.joints.sort_unstable());
    merged
}

/// Finite mobility of a mechanism, with the dimensions of the branches that meet.
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismMobility {
    /// The finite mobility; its first-order part is that of the whole mechanism.
    pub finite: FiniteMobility,
    /// Dimensions of the branches that meet at the configuration, smallest first; `None` where every motion of first order is finite.
    pub branch_dimensions: Option<Vec<usize>>,
}

impl MechanismMobility {
    /// The class of the mechanism.
    #[must_use]
    pub fn class(&self) -> MobilityClass {
        MobilityClass::classify(&self.finite)
            .with_branches(self.branch_dimensions.as_deref().unwrap_or_default())
    }
}

/// Treatment of loops that are open at the configuration of an analysis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OpenLoops {
    /// The analysis fails with [`Error::NotClosed`].
    Refused,
    /// The loops are taken as closed where they are, as [`ForcedClosure`] does.
    TakenAsClosed,
}

/// Finite mobility of a mechanism at its home configuration, block by block, and the branches that meet there.
///
/// Mobilities and their bounds add; the branches of the mechanism are combinations of branches of its blocks, and their dimensions add.
///
/// # Arguments
/// * `system` – at its home, closed or taken as closed
/// * `relative_threshold` – as for [`instantaneous_mobility`]
/// * `open_loops` – whether loops that are open at the home are refused
///
/// # Errors
/// Those of [`finite_mobility`].
///
/// # Numerics
/// One singular value decomposition of the whole, for the evidence of first order; everything else costs as much as the blocks by themselves.
pub fn mechanism_mobility(
    system: &MechanismSystem<'_>,
    relative_threshold: f64,
    open_loops: OpenLoops,
) -> Result<MechanismMobility, Error> {
    let mechanism = system.kinematics().mechanism();
    let blocks = blocks(mechanism);
    if blocks.len() > 1
        && blocks.iter().any(Block::has_constraints)
        && let Some(found) = by_blocks(system, &blocks, relative_threshold, open_loops)?
    {
        return Ok(found);
    }
    analysed(system, relative_threshold, open_loops)
}

/// One block, or a mechanism as a whole.
fn analysed(
    system: &MechanismSystem<'_>,
    relative_threshold: f64,
    open_loops: OpenLoops,
) -> Result<MechanismMobility, Error> {
    let at = system.at_home();
    let with = |system: &dyn crate::constraint::System| {
        let finite = finite_mobility(system, &at, relative_threshold)?;
        let branch_dimensions = match finite.mobility {
            Some(found) if found == finite.instantaneous.mobility => None,
            _ => Some(branch_dimensions(system, &at, &finite)?),
        };
        Ok(MechanismMobility { finite, branch_dimensions })
    };
    match open_loops {
        OpenLoops::Refused => with(system),
        OpenLoops::TakenAsClosed => with(&ForcedClosure::new(system, &at)),
    }
}

/// Sums over the blocks; `None` where they do not agree with the whole on the first order, as may be with a singular value at the threshold.
fn by_blocks(
    system: &MechanismSystem<'_>,
    blocks: &[Block],
    relative_threshold: f64,
    open_loops: OpenLoops,
) -> Result<Option<MechanismMobility>, Error> {
    let kinematics = system.kinematics();
    let whole = kinematics.mechanism();
    let mut sum = FiniteMobility {
        mobility: Some(0),
        lower_bound: 0,
        lower_bound_origin: BoundOrigin::FirstOrder,
        upper_bound: 0,
        upper_bound_origin: BoundOrigin::FirstOrder,
        instantaneous: instantaneous_mobility(system, &system.at_home(), relative_threshold)?,
        second_order: None,
        free_motions: FreeMotions::NotFinite,
        nearby: None,
    };
    let (mut mobility, mut redundancy) = (0, 0);
    let mut branches = Some(vec![0]);
    for block in blocks {
        let found = if block.has_constraints() {
            let (part, _) = block.mechanism(whole);
            let coordinates = block.coordinates(kinematics);
            let home = DVector::from_iterator(
                coordinates.len(),
                coordinates.iter().map(|&k| system.home()[k]),
            );
            match analysed(&MechanismSystem::new(&part, home)?, relative_threshold, open_loops) {
                // Closed by the measure of the whole, which is larger.
                Err(Error::NotClosed { .. }) => return Ok(None),
                found => Some(found?),
            }
        } else {
            None
        };
        let Some(MechanismMobility { finite, branch_dimensions }) = found else {
            let freedoms = whole.joints()[block.joints[0]].kind.freedoms();
            mobility += freedoms;
            sum.mobility = sum.mobility.map(|sum| sum + freedoms);
            sum.lower_bound += freedoms;
            sum.upper_bound += freedoms;
            branches = branches.map(|all| added(&all, &[freedoms]));
            continue;
        };
        mobility += finite.instantaneous.mobility;
        redundancy += finite.instantaneous.redundancy;
        sum.mobility = sum.mobility.zip(finite.mobility).map(|(sum, found)| sum + found);
        sum.lower_bound += finite.lower_bound;
        sum.upper_bound += finite.upper_bound;
        sum.lower_bound_origin = sum.lower_bound_origin.max(finite.lower_bound_origin);
        sum.upper_bound_origin = sum.upper_bound_origin.max(finite.upper_bound_origin);
        let dimensions = match (branch_dimensions, finite.mobility) {
            (None, Some(all)) | (Some(_), Some(all @ 0)) => Some(vec![all]),
            (found, _) => found.filter(|dimensions| !dimensions.is_empty()),
        };
        branches = branches.zip(dimensions).map(|(all, found)| added(&all, &found));
    }
    let first = &sum.instantaneous;
    if (mobility, redundancy) != (first.mobility, first.redundancy) {
        return Ok(None);
    }
    let branch_dimensions = if sum.mobility == Some(mobility) {
        None
    } else {
        // Of blocks that do not move at all there are no branches.
        Some(branches.unwrap_or_default().into_iter().filter(|&dimension| dimension > 0).collect())
    };
    Ok(Some(MechanismMobility { finite: sum, branch_dimensions }))
}

/// All sums of a member of each set, ascending.
fn added(a: &[usize], b: &[usize]) -> Vec<usize> {
    let sums: std::collections::BTreeSet<usize> =
        a.iter().flat_map(|a| b.iter().map(move |b| a + b)).collect();
    sums.into_iter().collect()
}
