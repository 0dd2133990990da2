//! Displacements of virtual joints along a motion do not depend on the scale of the mechanism, nor on the number of steps.

use crate::planar;
use std::ops::ControlFlow;

use jointplay_core::constraint::CLOSURE_TOLERANCE;
use jointplay_core::mechanism::{
    Carrier, CommandedPositions, Drive, DrivePath, JointKind, Mechanism, ReliefSolver,
    VirtualJoint, VirtualMotion, close_at_rest, drive_from, relieve_commanded,
};
use jointplay_core::nalgebra::{DVector, Rotation3, Translation3, UnitVector3, Vector3};
use jointplay_core::spatial::Pose;
use planar::joint;
use proptest::prelude::*;

/// From micrometres to kilometres.
const SCALES: [f64; 5] = [1e-6, 1e-4, 1e-3, 1.0, 1e3];

/// A stage on parallel cranks of length 1 about z.
#[derive(Debug, Clone)]
struct Stage {
    /// Places of the cranks on the base.
    places: Vec<[f64; 2]>,
    /// Angle of the cranks from x where all coordinates are zero (rad).
    angle: f64,
    /// By how much the cranks are too long.
    excess: Vec<f64>,
    /// Play at the tip of a crank, along x or y of the stage.
    play: Vec<(usize, Vector3<f64>)>,
    stiffness: Option<f64>,
}

impl Stage {
    /// Coordinates: for each crank its angle, then that of the stage on its tip.
    fn mechanism(&self, scale: f64) -> Mechanism {
        let count = self.places.len();
        let place = |x: f64, y: f64| {
            let shift = Vector3::new(x, y, 0.0) * scale;
            Pose::from_parts(Translation3::from(shift), Rotation3::identity())
        };
        let mut joints = Vec::new();
        for (k, [x, y]) in self.places.iter().copied().enumerate() {
            let tip =
                |length: f64| place(x + length * self.angle.cos(), y + length * self.angle.sin());
            let base = [place(x, y); 2];
            let mut crank = joint(&format!("M{k}"), JointKind::Revolute, [0, 1 + k], base);
            crank.actuated = k == 0;
            let ends = [tip(1.0 + self.excess[k]), tip(1.0)];
            joints.push(crank);
            joints.push(joint(&format!("B{k}"), JointKind::Revolute, [1 + k, 1 + count], ends));
        }
        let links = (0..count + 2).map(|k| format!("link {k}")).collect();
        let play = self.play.iter().enumerate().map(|(n, (crank, direction))| VirtualJoint {
            name: format!("play {n}"),
            joint: 2 * crank + 1,
            carrier: Carrier::Second,
            motion: VirtualMotion::Slide(UnitVector3::new_normalize(*direction)),
            clearance: None,
            stiffness: self.stiffness,
        });
        let mechanism = Mechanism::new("stage", links, joints).unwrap();
        mechanism.with_virtual_joints(play.collect()).unwrap()
    }

    /// Angles (rad), and displacements in lengths of a crank, after a motion of the first crank.
    fn moved(&self, scale: f64, to: f64, steps: usize) -> DVector<f64> {
        let mechanism = self.mechanism(scale);
        let home = close_at_rest(&mechanism, None).unwrap().coordinates;
        let path = DrivePath::line(&home, &[Drive { coordinate: 0, to }]).unwrap();
        let motion = drive_from(&mechanism, &home, &path, &[], steps, None, &mut |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(motion.stopped, None, "{self:?} {scale} {steps}");
        self.without_scale(scale, &motion.waypoints.last().unwrap().coordinates)
    }

    /// As [`Self::moved`], for a command without a motion.
    fn commanded(&self, scale: f64, to: f64) -> DVector<f64> {
        let found = relieve_commanded(&self.mechanism(scale), &[(0, to)], None).unwrap();
        self.without_scale(scale, &found.coordinates)
    }

    fn without_scale(&self, scale: f64, coordinates: &DVector<f64>) -> DVector<f64> {
        let joints = 2 * self.places.len();
        let value = |k: usize, value: f64| if k < joints { value } else { value / scale };
        DVector::from_fn(coordinates.len(), |k, _| value(k, coordinates[k]))
    }

    /// All cranks equal and parallel, and no play displaced.
    fn parallel(&self, to: f64) -> DVector<f64> {
        let joints = 2 * self.places.len();
        let sense = |k: usize| if k.is_multiple_of(2) { to } else { -to };
        DVector::from_fn(joints + self.play.len(), |k, _| if k < joints { sense(k) } else { 0.0 })
    }
}

fn stage(places: &[[f64; 2]], angle_deg: f64, play: &[(usize, [f64; 3])]) -> Stage {
    Stage {
        places: places.to_vec(),
        angle: angle_deg.to_radians(),
        excess: vec![0.0; places.len()],
        play: play.iter().map(|&(crank, direction)| (crank, Vector3::from(direction))).collect(),
        stiffness: None,
    }
}

/// The cranks are perpendicular to the play or along it, so that a crank that turns back closes the loops too, with play of a quarter of its length.
#[test]
fn a_stage_with_play_follows_its_crank_and_does_not_turn_back() {
    let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let uneven = [[0.0, 0.0], [1.16, 0.83], [2.66, 0.66], [4.13, 0.04]];
    let on_a_line = [[0.0, 0.04], [1.14, 0.0], [4.42, 0.0], [5.15, 0.09]];
    let cases = [
        (stage(&uneven, 0.0, &[(0, y)]), "flat"),
        (stage(&on_a_line, 90.0, &[(1, x)]), "upright"),
        (stage(&on_a_line[..3], 90.0, &[(0, x), (1, x), (2, x)]), "all with play"),
        (stage(&on_a_line[..3], 45.0, &[(2, x), (2, y)]), "inclined"),
    ];
    for (stage, name) in cases {
        for to in [8.0_f64, -8.0, 0.5, 40.0].map(f64::to_radians) {
            let expected = stage.parallel(to);
            for scale in SCALES {
                for steps in [1, 2, 24] {
                    let off = (stage.moved(scale, to, steps) - &expected).amax();
                    assert!(off < 1e-7, "{name} {to} {scale} {steps}: {off}");
                }
                let off = (stage.commanded(scale, to) - &expected).amax();
                assert!(off < 1e-7, "{name} {to} {scale}: {off}");
            }
        }
    }
}

fn stages() -> impl Strategy<Value = Stage> {
    let places = prop::collection::vec((0.5..2.5_f64, -1.0..1.0_f64), 3..5);
    // Of flat stages, whose branches meet within the inaccuracy, the lengths are exact.
    let angle = 30.0..150.0_f64;
    let excess = prop::collection::vec(-1.0..1.0_f64, 4);
    let size = prop_oneof![Just(0.0), Just(1e-5), Just(1e-3)];
    let play = prop::collection::vec(any::<bool>(), 3);
    let stiffness = prop_oneof![Just(None), Just(Some(1e6))];
    (places, angle, excess, size, play, stiffness).prop_map(
        |(places, angle, excess, size, play, stiffness)| {
            let mut along = 0.0;
            let places = places.into_iter().map(|(step, across)| {
                along += step;
                [along, 0.3 * across]
            });
            let places: Vec<[f64; 2]> = places.collect();
            let count = places.len();
            let mut of_tips = Vec::new();
            for crank in 1..count {
                of_tips.push((crank, Vector3::x()));
                // With play in one direction, cranks that are too long lock at their dead points.
                if play[crank - 1] || size > 0.0 {
                    of_tips.push((crank, Vector3::y()));
                }
            }
            Stage {
                places,
                angle: angle.to_radians(),
                excess: excess[..count].iter().map(|one| one * size).collect(),
                play: of_tips,
                stiffness,
            }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn one_step_at_any_scale_ends_where_many_steps_end(
        stage in stages(),
        to_deg in -20.0..20.0_f64,
        scale in prop::sample::select(&SCALES[..]),
    ) {
        let to = to_deg.to_radians();
        let expected = match stage.excess.iter().all(|&excess| excess == 0.0) {
            true => stage.parallel(to),
            false => stage.moved(1.0, to, 60),
        };
        let found = stage.moved(scale, to, 1);
        let off = (&found - &expected).amax();
        prop_assert!(off < 1e-7, "{scale}: {off} {found} {expected}");
        let found = stage.commanded(scale, to);
        let off = (&found - &expected).amax();
        prop_assert!(off < 1e-7, "command, {scale}: {off} {found} {expected}");
    }
}

/// Positions one by one, as bindings ask for them, in a metric of any scale.
#[test]
fn positions_near_each_other_are_found_at_every_scale() {
    let on_a_line = [[0.0, 0.04], [1.14, 0.0], [4.42, 0.0], [5.15, 0.09]];
    for stiffness in [None, Some(1e3), Some(1e9)] {
        let stage = Stage { stiffness, ..stage(&on_a_line, 90.0, &[(1, [1.0, 0.0, 0.0])]) };
        for scale in SCALES {
            let mechanism = stage.mechanism(scale);
            let mut at = close_at_rest(&mechanism, None).unwrap().coordinates;
            let mut positions = CommandedPositions::new(&mechanism, &at, &[0]).unwrap();
            for to in [2.0_f64, 4.0, 6.0, 8.0].map(f64::to_radians) {
                let solver = ReliefSolver::LeastNorm;
                let residual = positions.solve(&mechanism, &[to], &mut at, solver).unwrap();
                assert!(residual < CLOSURE_TOLERANCE);
                let off = (stage.without_scale(scale, &at) - stage.parallel(to)).amax();
                assert!(off < 1e-7, "{stiffness:?} {scale} {to}: {off}");
            }
        }
    }
}
