//! Laws that hold for every mechanism: numbering, tree, base and unit of length mean nothing.

use jointplay_core::mechanism::{
    Joint, JointKind, LinearAndAngular, Mechanism, MechanismMobility, MechanismSystem, OpenLoops,
    SparseSystem, assemble, mechanism_mobility,
};
use jointplay_core::mobility::{InstantaneousMobility, RANK_THRESHOLD, instantaneous_mobility};
use jointplay_core::nalgebra::{DVector, Rotation3, Translation3, Vector3};
use jointplay_core::spatial::Pose;
use proptest::prelude::*;
use proptest::strategy::ValueTree as _;
use proptest::test_runner::TestRunner;

fn kind() -> impl Strategy<Value = JointKind> {
    prop_oneof![
        4 => Just(JointKind::Revolute),
        2 => Just(JointKind::Prismatic),
        1 => Just(JointKind::Helical { lead: 0.1 }),
        1 => Just(JointKind::Cylindrical),
        1 => Just(JointKind::Universal),
        2 => Just(JointKind::Spherical),
        1 => Just(JointKind::Planar),
        1 => Just(JointKind::Floating),
        1 => Just(JointKind::Fixed),
    ]
}

fn pose() -> impl Strategy<Value = Pose> {
    (prop::array::uniform3(-1.0..1.0_f64), prop::array::uniform3(-1.5..1.5_f64)).prop_map(
        |(point, turn)| {
            Pose::from_parts(
                Translation3::from(Vector3::from(point)),
                Rotation3::new(Vector3::from(turn)),
            )
        },
    )
}

/// Joints along a chain of links, and a few that close loops; half of them parallel, so that redundancy is common.
fn joints() -> impl Strategy<Value = (usize, Vec<Joint>)> {
    (3..7_usize).prop_flat_map(|links| {
        let extra = prop::collection::vec((0..links, 1..links), 1..4);
        (extra, prop::collection::vec((kind(), pose(), any::<bool>(), any::<bool>()), links + 2))
            .prop_map(move |(extra, made)| {
                let ends = (1..links)
                    .map(|k| [k - 1, k])
                    .chain(extra.iter().map(|&(a, step)| [a, (a + step) % links]));
                let joints =
                    ends.zip(made).enumerate().map(|(k, (ends, (kind, place, flat, turned)))| {
                        let upright = Pose::from_parts(place.translation, Rotation3::identity());
                        let links = if turned { [ends[1], ends[0]] } else { ends };
                        joint(&format!("j{k}"), kind, links, if flat { upright } else { place })
                    });
                (links, joints.collect())
            })
    })
}

fn names(links: usize) -> Vec<String> {
    (0..links).map(|k| format!("l{k}")).collect()
}

fn analysed(links: usize, joints: Vec<Joint>) -> InstantaneousMobility {
    let mechanism = Mechanism::new("random", names(links), joints).unwrap();
    let home = DVector::zeros(mechanism.joint_freedoms());
    let system = MechanismSystem::new(&mechanism, home).unwrap();
    instantaneous_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap()
}

fn same(a: &InstantaneousMobility, b: &InstantaneousMobility) -> Result<(), TestCaseError> {
    // A random mechanism may have a singular value near the threshold; what counts is that the values agree.
    let off = (&a.singular_values - &b.singular_values).amax();
    let largest = a.singular_values.iter().copied().fold(1.0, f64::max);
    prop_assert!(off < 1e-11 * largest, "{off}");
    if a.smallest_nonzero().is_none_or(|least| least > 1e-9) {
        prop_assert_eq!(a.rank, b.rank);
    }
    Ok(())
}

fn finite(links: usize, joints: Vec<Joint>) -> MechanismMobility {
    let mechanism = Mechanism::new("random", names(links), joints).unwrap();
    let home = DVector::zeros(mechanism.joint_freedoms());
    let system = MechanismSystem::new(&mechanism, home).unwrap();
    mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused).unwrap()
}

/// Whether no singular value is near the threshold.
fn clear(found: &MechanismMobility) -> bool {
    found.finite.instantaneous.smallest_nonzero().is_none_or(|least| least > 1e-6)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Two mechanisms on one base, one on a link of the other, or one beyond a hinge on that link.
    #[test]
    fn mobility_of_a_union_is_the_sum(
        (links, joints) in joints(),
        (more_links, more) in joints(),
        on in 0..7_usize,
        hinged in any::<bool>(),
    ) {
        let (a, b) = (finite(links, joints.clone()), finite(more_links, more.clone()));
        prop_assume!(clear(&a) && clear(&b));
        let on = on % links;
        let base = if hinged { links } else { on };
        let first = links + usize::from(hinged);
        let mut all = joints;
        if hinged {
            all.push(joint("hinge", JointKind::Revolute, [on, base], Pose::translation(0.3, 0.1, 0.2)));
        }
        all.extend(more.into_iter().map(|joint| Joint {
            name: format!("more {}", joint.name),
            links: joint.links.map(|link| if link == 0 { base } else { first + link - 1 }),
            ..joint
        }));
        let both = finite(first + more_links - 1, all);
        prop_assume!(clear(&both));
        let tree = usize::from(hinged);
        let sums = |of: fn(&MechanismMobility) -> usize| of(&a) + of(&b);
        let (found, first) = (&both.finite, &both.finite.instantaneous);
        prop_assert_eq!(first.mobility, tree + sums(|m| m.finite.instantaneous.mobility));
        prop_assert_eq!(first.redundancy, sums(|m| m.finite.instantaneous.redundancy));
        prop_assert_eq!(found.lower_bound, tree + sums(|m| m.finite.lower_bound));
        prop_assert_eq!(found.upper_bound, tree + sums(|m| m.finite.upper_bound));
        // The dimension of a branch is at most the upper bound.
        let largest = both.branch_dimensions.as_ref().and_then(|all| all.last().copied());
        prop_assert!(largest.is_none_or(|largest| largest == found.lower_bound));
    }

    #[test]
    fn numbering_does_not_change_what_is_decided((links, joints) in joints(), turn in 0..20_usize) {
        let a = finite(links, joints.clone());
        let mut other = joints;
        let count = other.len();
        other.rotate_left(turn % count);
        for joint in &mut other {
            joint.links = joint.links.map(|link| if link == 0 { 0 } else { links - link });
        }
        let b = finite(links, other);
        prop_assume!(clear(&a) && clear(&b));
        prop_assert!(a.finite.lower_bound <= b.finite.upper_bound);
        prop_assert!(b.finite.lower_bound <= a.finite.upper_bound);
        if a.finite.mobility.is_some() && b.finite.mobility.is_some() {
            prop_assert_eq!(a.finite.mobility, b.finite.mobility);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn numbering_and_tree_mean_nothing((links, joints) in joints(), turn in 0..20_usize) {
        let first = analysed(links, joints.clone());
        let mut other = joints;
        let count = other.len();
        other.rotate_left(turn % count);
        // Another joint order is another spanning tree; another order of the links besides the base too.
        for joint in &mut other {
            joint.links = joint.links.map(|link| if link == 0 { 0 } else { links - link });
        }
        same(&first, &analysed(links, other))?;
    }

    #[test]
    fn link_twists_and_joint_rates_say_the_same((links, joints) in joints()) {
        let first = analysed(links, joints.clone());
        let mechanism = Mechanism::new("random", names(links), joints).unwrap();
        let home = DVector::zeros(mechanism.joint_freedoms());
        let sparse = SparseSystem::new(&mechanism, home).unwrap().mobility(RANK_THRESHOLD).unwrap();
        if first.smallest_nonzero().is_none_or(|least| least > 1e-9) {
            let counts = (first.mobility, first.rank, first.redundancy);
            prop_assert_eq!((sparse.mobility, sparse.rank, sparse.redundancy), counts);
        }
    }

    #[test]
    fn the_sense_of_a_joint_means_nothing((links, joints) in joints()) {
        let first = analysed(links, joints.clone());
        // Swapping the links of a universal joint swaps its axes; its screws at rest are the same.
        let other = joints
            .into_iter()
            .map(|joint| Joint { links: [joint.links[1], joint.links[0]], ..joint })
            .collect();
        same(&first, &analysed(links, other))?;
    }

    #[test]
    fn the_base_and_its_place_mean_nothing((links, joints) in joints(), by in pose()) {
        let first = analysed(links, joints.clone());
        let other: Vec<Joint> = joints
            .into_iter()
            .map(|joint| Joint {
                // The last link becomes the base, and everything is moved.
                links: joint.links.map(|link| (link + 1) % links),
                frames: joint.frames.map(|frame| by * frame),
                ..joint
            })
            .collect();
        same(&first, &analysed(links, other))?;
    }

    #[test]
    fn the_unit_of_length_means_nothing((links, joints) in joints()) {
        let first = analysed(links, joints.clone());
        let other = joints
            .into_iter()
            .map(|mut joint| {
                joint.frames.iter_mut().for_each(|frame| frame.translation.vector *= 1000.0);
                if let JointKind::Helical { lead } = &mut joint.kind {
                    *lead *= 1000.0;
                }
                joint
            })
            .collect();
        same(&first, &analysed(links, other))?;
    }

    #[test]
    fn null_space_and_self_stress_are_what_they_say((links, joints) in joints()) {
        let mechanism = Mechanism::new("random", names(links), joints).unwrap();
        let system = MechanismSystem::new(&mechanism, DVector::zeros(mechanism.joint_freedoms())).unwrap();
        let found = instantaneous_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
        prop_assert_eq!(found.mobility + found.rank, mechanism.joint_freedoms());
        prop_assert_eq!(found.redundancy + found.rank, 6 * mechanism.loops());
        let counted = jointplay_core::mobility::kutzbach_mobility(
            links,
            &mechanism.joints().iter().map(|joint| joint.kind.freedoms()).collect::<Vec<_>>(),
        );
        // Kutzbach mobility is instantaneous mobility minus redundancy.
        prop_assert_eq!(counted, found.mobility as i64 - found.redundancy as i64);
    }
}

fn joint(name: &str, kind: JointKind, links: [usize; 2], frame: Pose) -> Joint {
    Joint {
        name: name.to_owned(),
        kind,
        links,
        frames: [frame; 2],
        actuated: false,
        guess: Vec::new(),
        limits: Vec::new(),
        clearance: LinearAndAngular::default(),
        stiffness: LinearAndAngular::default(),
    }
}

/// A hinge and a slide that a weld locks, carriers, and a loop of four joints: the redundant equations of the weld are round-off, along which no coordinate may move.
#[test]
fn coordinates_on_no_loop_keep_their_values_when_loops_are_closed() {
    use JointKind::{Fixed, Prismatic, Revolute, Spherical};
    const GUESS: f64 = 0.2;
    let tree = [
        (Revolute, 0),
        (Revolute, 1),
        (Revolute, 2),
        (Prismatic, 3),
        (Prismatic, 4),
        (Prismatic, 5),
        (Revolute, 6),
        (Prismatic, 7),
        (Revolute, 8),
        (Revolute, 5),
    ];
    let closing = [(Fixed, [4, 2]), (Spherical, [9, 6])];
    let mut runner = TestRunner::deterministic();
    let poses = prop::collection::vec(pose(), 2 * tree.len() + closing.len());
    for case in 0..100 {
        let drawn = poses.new_tree(&mut runner).unwrap().current();
        let (steps, places) = drawn.split_at(tree.len());
        let mut base_from = vec![Pose::identity()];
        for ((_, parent), step) in tree.iter().zip(steps) {
            base_from.push(base_from[*parent] * step);
        }
        // Each joint is where both of its links have it, in frames of the links, as models of simulators place joints.
        let ends = tree.iter().enumerate().map(|(k, &(kind, parent))| (kind, [parent, k + 1]));
        let joints =
            ends.chain(closing).zip(places).enumerate().map(|(k, ((kind, ends), place))| {
                let moved = match kind {
                    Revolute => Pose::from_parts(
                        Translation3::identity(),
                        Rotation3::new(-Vector3::z() * GUESS),
                    ),
                    Prismatic => Translation3::new(0.0, 0.0, -GUESS).into(),
                    _ => Pose::identity(),
                };
                let [first, second] = ends.map(|link| base_from[link].inverse() * place);
                Joint {
                    frames: [first * moved, second],
                    ..joint(&format!("j{k}"), kind, ends, *place)
                }
            });
        let mechanism = Mechanism::new("locked", names(base_from.len()), joints.collect()).unwrap();
        let mut start = DVector::from_element(mechanism.joint_freedoms(), GUESS);
        start.rows_mut(tree.len(), 3).fill(0.0);
        let closed = assemble(&mechanism, &start, &[], 0).unwrap();
        let off = (closed.coordinates - start).amax();
        assert!(off < 1e-9, "case {case}: {off:e}");
    }
}

/// Joints before a loop carry it whole, wherever the base is: what round-off leaves of them is no constraint.
#[test]
fn a_loop_of_fixed_joints_constrains_nothing() {
    let by = Pose::from_parts(
        Translation3::new(0.1, 0.2, -0.3),
        Rotation3::new(Vector3::new(0.01, -0.47, -0.07)),
    );
    let joint = |name: &str, kind, links| joint(name, kind, links, by);
    // The hinges are between the base and the loop, or beyond it.
    for turn in 0..4 {
        let at = |links: [usize; 2]| links.map(|link| (link + turn) % 4);
        let joints = vec![
            joint("plate", JointKind::Fixed, at([0, 1])),
            joint("near hinge", JointKind::Revolute, at([1, 2])),
            joint("far hinge", JointKind::Revolute, at([2, 3])),
            joint("second plate", JointKind::Fixed, at([1, 0])),
        ];
        let found = analysed(4, joints);
        assert_eq!((found.mobility, found.rank, found.redundancy), (2, 0, 6), "turn {turn}");
    }
}

#[test]
fn a_loop_of_floating_joints_constrains_nothing() {
    let place = Pose::from_parts(Translation3::new(0.4, -0.1, 0.7), Rotation3::identity());
    let joints = [[0, 1], [1, 2], [0, 1]].map(|links| joint("", JointKind::Floating, links, place));
    let mut numbered = joints.to_vec();
    numbered.iter_mut().enumerate().for_each(|(k, joint)| joint.name = format!("j{k}"));
    let dense = analysed(3, numbered.clone());
    assert_eq!((dense.mobility, dense.rank, dense.redundancy), (12, 6, 0));
    let mechanism = Mechanism::new("loose", names(3), numbered).unwrap();
    let sparse = SparseSystem::new(&mechanism, DVector::zeros(18)).unwrap();
    let sparse = sparse.mobility(RANK_THRESHOLD).unwrap();
    assert_eq!((sparse.mobility, sparse.rank, sparse.redundancy), (12, 6, 0));
}
