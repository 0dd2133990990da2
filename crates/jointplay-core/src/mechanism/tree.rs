//! Spanning trees of the graph of links and joints.

use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use super::Mechanism;
use crate::spatial::Pose;

/// A joint of the tree, and whether it is walked from its second link to its first.
pub(super) type Branch = (usize, bool);

/// Joints in the order in which they reach new links from the base, the cheapest within reach first, then the one that came within reach first.
///
/// With one cost for all this is breadth first in the order of the joints.
pub(super) fn spanning_tree(mechanism: &Mechanism, cost: impl Fn(usize) -> usize) -> Vec<Branch> {
    let joints = mechanism.joints();
    let at_link = joints_of_links(mechanism);
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

/// Joints at each link, ascending.
fn joints_of_links(mechanism: &Mechanism) -> Vec<Vec<usize>> {
    let mut at_link = vec![Vec::new(); mechanism.links().len()];
    for (j, joint) in mechanism.joints().iter().enumerate() {
        at_link[joint.links[0]].push(j);
        at_link[joint.links[1]].push(j);
    }
    at_link
}

/// Links within reach of a closing joint among which its shortest loop is looked for: those of a few loops around it.
const NEARBY_LINKS: usize = 64;

/// A spanning tree in which the loops closed by the other joints are short, so that a displacement of a joint opens the loops near it only.
///
/// A tree breadth first climbs a ladder over both rails, and each rung closes a loop down to the base; the tree wanted here contains the rungs, which are in two short loops each.
/// The joints of most short loops come first; loops of many links are not counted.
///
/// # Numerics
/// O(links + joints), with at most 64 links around each closing joint.
pub(super) fn short_loop_tree(mechanism: &Mechanism, closing: &[usize]) -> Vec<Branch> {
    let joints = mechanism.joints();
    let mut loops = vec![0; joints.len()];
    if !closing.is_empty() {
        let at_link = joints_of_links(mechanism);
        let mut search =
            LoopSearch { mechanism, at_link, over: vec![None; mechanism.links().len()] };
        let short: BTreeSet<Vec<usize>> =
            closing.iter().filter_map(|&j| search.shortest_loop(j)).collect();
        short.iter().flatten().for_each(|&j| loops[j] += 1);
    }
    spanning_tree(mechanism, |j| usize::MAX - loops[j])
}

/// A search for short loops, breadth first.
struct LoopSearch<'a> {
    mechanism: &'a Mechanism,
    at_link: Vec<Vec<usize>>,
    /// The joint over which each link was reached, and the link before it.
    over: Vec<Option<(usize, usize)>>,
}

impl LoopSearch<'_> {
    /// Joints of the shortest loop through a joint, ascending; `None` where it is long, or where there is none.
    fn shortest_loop(&mut self, joint: usize) -> Option<Vec<usize>> {
        let joints = self.mechanism.joints();
        let [from, to] = joints[joint].links;
        let mut reached = vec![from];
        self.over[from] = Some((joint, to));
        let mut next = 0;
        while self.over[to].is_none() && next < reached.len() && reached.len() < NEARBY_LINKS {
            let link = reached[next];
            next += 1;
            for &j in self.at_link[link].iter().filter(|&&j| j != joint) {
                let [first, second] = joints[j].links;
                let other = if first == link { second } else { first };
                if self.over[other].is_none() {
                    self.over[other] = Some((j, link));
                    reached.push(other);
                }
            }
        }
        let found = self.over[to].is_some().then(|| {
            let mut all = vec![joint];
            let mut link = to;
            while let Some((j, before)) = self.over[link]
                && link != from
            {
                all.push(j);
                link = before;
            }
            all.sort_unstable();
            all
        });
        reached.into_iter().for_each(|link| self.over[link] = None);
        found
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Joint, JointKind, LinearAndAngular};

    fn hinged(links: usize, pairs: impl IntoIterator<Item = [usize; 2]>) -> Mechanism {
        let joint = |(k, links): (usize, [usize; 2])| Joint {
            name: format!("j{k}"),
            kind: JointKind::Revolute,
            links,
            frames: [Pose::identity(); 2],
            actuated: false,
            guess: vec![0.0],
            limits: Vec::new(),
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        };
        let names = (0..links).map(|link| format!("link {link}")).collect();
        Mechanism::new("m", names, pairs.into_iter().enumerate().map(joint).collect()).unwrap()
    }

    /// Links of the longest loop that a joint beyond the tree closes; the tree reaches every link once.
    #[track_caller]
    fn longest_loop(mechanism: &Mechanism, tree: &[Branch]) -> usize {
        let links = mechanism.links().len();
        let mut before = vec![None; links];
        assert_eq!(tree.len(), links - 1);
        let mut in_tree = vec![false; mechanism.joints().len()];
        for &(j, against) in tree {
            let [first, second] = mechanism.joints()[j].links;
            let (from, to) = if against { (second, first) } else { (first, second) };
            assert!(to != 0 && before[to].is_none() && (from == 0 || before[from].is_some()));
            before[to] = Some(from);
            in_tree[j] = true;
        }
        let to_base = |link| std::iter::successors(Some(link), |&link: &usize| before[link]);
        let closing = mechanism.joints().iter().zip(in_tree).filter(|(_, in_tree)| !in_tree);
        let lengths = closing.map(|(joint, _)| {
            let [a, b] = joint.links.map(|link| to_base(link).collect::<BTreeSet<_>>());
            a.symmetric_difference(&b).count() + 1
        });
        lengths.max().unwrap_or(0)
    }

    /// Two rails on the base, and the rungs between them.
    fn ladder(rungs: usize) -> Mechanism {
        let rails = (1..2 * rungs - 1).map(|k| [k, k + 2]);
        let rungs_between = (0..rungs).map(|k| [2 * k + 1, 2 * k + 2]);
        hinged(2 * rungs + 1, [[0, 1], [0, 2]].into_iter().chain(rails).chain(rungs_between))
    }

    #[test]
    fn loops_of_a_ladder_are_short() {
        let ladder = ladder(300);
        let breadth_first = spanning_tree(&ladder, |_| 0);
        let closing: Vec<usize> = (0..ladder.joints().len())
            .filter(|&j| breadth_first.iter().all(|b| b.0 != j))
            .collect();
        assert_eq!(longest_loop(&ladder, &breadth_first), 601);
        assert_eq!(longest_loop(&ladder, &short_loop_tree(&ladder, &closing)), 4);
    }

    #[test]
    fn every_graph_has_its_tree() {
        // A chain, a ring longer than what is searched, parallel joints, a ring around a hub.
        let chain = hinged(5, (0..4).map(|k| [k, k + 1]));
        assert_eq!(longest_loop(&chain, &short_loop_tree(&chain, &[])), 0);
        let ring = hinged(200, (0..200).map(|k| [k, (k + 1) % 200]));
        assert_eq!(longest_loop(&ring, &short_loop_tree(&ring, &[100])), 200);
        let parallel = hinged(2, [[0, 1], [1, 0], [0, 1]]);
        assert_eq!(longest_loop(&parallel, &short_loop_tree(&parallel, &[1, 2])), 2);
        let rim = (1..50).flat_map(|k| [[0, k], [k, k % 49 + 1]]);
        let wheel = hinged(50, rim);
        let closing: Vec<usize> = (0..49).map(|k| 2 * k + 1).collect();
        assert_eq!(longest_loop(&wheel, &short_loop_tree(&wheel, &closing)), 3);
    }
}
