//! Spanning trees of the graph of links and joints.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Mechanism;
use crate::spatial::Pose;

/// A joint of the tree, and whether it is walked from its second link to its first.
pub(super) type Branch = (usize, bool);

/// Joints in the order in which they reach new links from the base, the cheapest within reach first, then the one that came within reach first.
///
/// With one cost for all this is breadth first in the order of the joints.
pub(super) fn spanning_tree(mechanism: &Mechanism, cost: impl Fn(usize) -> usize) -> Vec<Branch> {
    let joints = mechanism.joints();
    let mut at_link = vec![Vec::new(); mechanism.links().len()];
    for (j, joint) in joints.iter().enumerate() {
        at_link[joint.links[0]].push(j);
        at_link[joint.links[1]].push(j);
    }
    let mut reached = vec![false; mechanism.links().len()];
    let (mut tree, mut within_reach, mut seen) = (Vec::new(), BinaryHeap::new(), 0_usize);
    let mut arrive = |link: usize, within_reach: &mut BinaryHeap<_>| {
        for &j in &at_link[link] {
            within_reach.push(Reverse((cost(j), seen, j, joints[j].links[1] == link)));
            seen += 1;
        }
    };
    reached[0] = true;
    arrive(0, &mut within_reach);
    while let Some(Reverse((_, _, j, against))) = within_reach.pop() {
        let next = joints[j].links[usize::from(!against)];
        if !std::mem::replace(&mut reached[next], true) {
            tree.push((j, against));
            arrive(next, &mut within_reach);
        }
    }
    tree
}

/// Pose of each link in the base frame, reached over the branches of a tree in their order.
///
/// # Arguments
/// * `branches` – first and second link of a joint, whether it is walked from the second to the first, and its displacement from the first to the second
pub(super) fn link_poses(
    links: usize,
    branches: impl Iterator<Item = ([usize; 2], bool, Pose)>,
) -> Vec<Pose> {
    let mut poses = vec![Pose::identity(); links];
    for ([first, second], against, transform) in branches {
        if against {
            poses[first] = poses[second] * transform.inverse();
        } else {
            poses[second] = poses[first] * transform;
        }
    }
    poses
}
