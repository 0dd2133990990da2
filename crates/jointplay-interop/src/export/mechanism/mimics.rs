//! Couplings as joints that follow one other joint each, without cycles.

use std::collections::{BTreeMap, VecDeque};

use jointplay_core::mechanism::Coupling;

use super::skeleton::Skeleton;

/// Two couplings of the same coordinates with ratios as close as this state the same relation: round-off of their products.
const SAME_RATIO: f64 = 1e-9;

/// A coordinate that follows another: follower = ratio · leader + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mimic {
    /// Index of the coordinate among all.
    pub(super) follower: usize,
    /// Index of the coordinate among all.
    pub(super) leader: usize,
    /// Change of the follower for a unit of the leader (m/m, m/rad, rad/m or rad/rad).
    pub(super) ratio: f64,
    /// Value of the follower with the leader at zero (m, rad).
    pub(super) offset: f64,
}

impl Mimic {
    /// Whether two relations join the same coordinates, in either direction.
    fn joins(&self, other: &Self) -> bool {
        let ends = |one: &Self| (one.follower.min(one.leader), one.follower.max(one.leader));
        ends(self) == ends(other)
    }

    /// The same relation, solved for the other coordinate.
    fn turned(self) -> Self {
        Self {
            follower: self.leader,
            leader: self.follower,
            ratio: 1.0 / self.ratio,
            offset: -self.offset / self.ratio,
        }
    }
}

/// The couplings of a mechanism, such that each coordinate follows at most one other, and none itself over others.
pub(super) struct Mimics {
    pub(super) all: Vec<Mimic>,
    /// Couplings that follow from others.
    pub(super) implied: Vec<Coupling>,
    /// Couplings that no coordinate can follow, with the reason.
    pub(super) impossible: Vec<(Coupling, &'static str)>,
    /// Actuators of coordinates that have to follow, and names of couplings.
    pub(super) lost: Vec<String>,
}

impl Mimics {
    /// The relation of a coordinate that follows another.
    pub(super) fn of(&self, follower: usize) -> Option<Mimic> {
        self.all.iter().find(|mimic| mimic.follower == follower).copied()
    }

    /// Couplings that are not among the relations.
    pub(super) fn others(&self) -> Vec<Coupling> {
        self.implied.iter().chain(self.impossible.iter().map(|(one, _)| one)).cloned().collect()
    }

    /// Turns couplings round where one of the coordinates that they join has an actuator and does not lead.
    ///
    /// # Arguments
    /// * `is_possible` – whether the format has the coordinates of a coupling
    pub(super) fn new(skeleton: &Skeleton<'_>, is_possible: impl Fn(&Coupling) -> bool) -> Self {
        let mut groups = Groups::default();
        let mut kept: Vec<Mimic> = Vec::new();
        let mut names: Vec<&str> = Vec::new();
        let (mut implied, mut impossible) = (Vec::new(), Vec::new());
        for coupling in skeleton.mechanism.couplings() {
            let [(leader, ratio)] = coupling.terms[..] else {
                impossible.push((coupling.clone(), "`mimic` has two coordinates; choose MJCF"));
                continue;
            };
            if ratio == 0.0 || !is_possible(coupling) {
                impossible.push((coupling.clone(), "it joins no two coordinates; choose MJCF"));
                continue;
            }
            let [follower, leader] =
                [coupling.follower, leader].map(|one| skeleton.coordinate(one));
            let mimic = Mimic { follower, leader, ratio, offset: coupling.offset };
            match groups.join(mimic) {
                Joined::New => {
                    kept.push(mimic);
                    names.push(&coupling.name);
                }
                Joined::Implied => implied.push(coupling.clone()),
                Joined::Fixed => {
                    let reason = "with the other couplings it fixes its coordinates; choose MJCF";
                    impossible.push((coupling.clone(), reason));
                }
            }
        }
        let is_actuated = |coordinate| actuated_joint(skeleton, coordinate);
        let all = directed(&kept, is_actuated);
        let followers = all.iter().filter(|mimic| is_actuated(mimic.follower));
        let lost = followers.map(|mimic| {
            let [follower, leader] =
                [mimic.follower, mimic.leader].map(|one| skeleton.motion_name(one));
            format!("actuator of {follower:?}: it follows {leader:?}")
        });
        let renamed = kept.iter().zip(names).filter(|(one, name)| {
            let written = all.iter().find(|mimic| mimic.joins(one));
            let imported =
                written.map(|mimic| format!("mimic of {}", skeleton.motion_name(mimic.follower)));
            imported.as_deref() != Some(name)
        });
        let renamed = renamed.map(|(_, name)| format!("name of the coupling {name:?}"));
        let lost = lost.chain(renamed).collect();
        Self { all, implied, impossible, lost }
    }
}

/// Whether the joint of a coordinate is actuated.
fn actuated_joint(skeleton: &Skeleton<'_>, coordinate: usize) -> bool {
    let mut end = 0;
    let mut joints = skeleton.mechanism.joints().iter();
    let joint = joints.find(|joint| {
        end += joint.kind.freedoms();
        coordinate < end
    });
    joint.is_some_and(|joint| joint.actuated)
}

/// Coordinates that couplings join: each is a multiple of the first of its group, up to an offset.
#[derive(Default)]
struct Groups {
    /// Group and ratio of each coupled coordinate.
    of: BTreeMap<usize, (usize, f64)>,
}

enum Joined {
    New,
    /// The relation follows from earlier ones.
    Implied,
    /// It holds with earlier ones at single values only.
    Fixed,
}

impl Groups {
    fn join(&mut self, mimic: Mimic) -> Joined {
        let (kept, by_leader) = *self.of.entry(mimic.leader).or_insert((mimic.leader, 1.0));
        let (joined, by_follower) = *self.of.entry(mimic.follower).or_insert((mimic.follower, 1.0));
        let expected = mimic.ratio * by_leader;
        if kept == joined {
            let off = (expected - by_follower).abs();
            let is_same = off <= SAME_RATIO * expected.abs().max(by_follower.abs());
            return if is_same { Joined::Implied } else { Joined::Fixed };
        }
        let change = expected / by_follower;
        for (group, ratio) in self.of.values_mut().filter(|(group, _)| *group == joined) {
            (*group, *ratio) = (kept, *ratio * change);
        }
        Joined::New
    }
}

/// Relations without cycles, directed away from one coordinate of each group: an actuated one if there is any, one that follows none before others.
fn directed(relations: &[Mimic], is_actuated: impl Fn(usize) -> bool) -> Vec<Mimic> {
    let follows = |coordinate| relations.iter().any(|one| one.follower == coordinate);
    let mut roots: Vec<usize> =
        relations.iter().flat_map(|one| [one.leader, one.follower]).collect();
    roots.sort_by_key(|&one| (!is_actuated(one), follows(one), one));
    let mut is_directed = vec![false; relations.len()];
    let mut all: Vec<(usize, Mimic)> = Vec::new();
    for root in roots {
        let mut open = VecDeque::from([root]);
        while let Some(leader) = open.pop_front() {
            for (k, relation) in relations.iter().enumerate() {
                if is_directed[k] || ![relation.leader, relation.follower].contains(&leader) {
                    continue;
                }
                is_directed[k] = true;
                let mimic = if relation.leader == leader { *relation } else { relation.turned() };
                open.push_back(mimic.follower);
                all.push((k, mimic));
            }
        }
    }
    all.sort_by_key(|(k, _)| *k);
    all.into_iter().map(|(_, mimic)| mimic).collect()
}
