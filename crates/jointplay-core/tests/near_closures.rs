//! Exact closures of mechanisms whose dimensions are inaccurate, found at every scale of the deviations.

use crate::planar;

use jointplay_core::gpr::Gpr;
use jointplay_core::mechanism::{Closure, Mechanism, assemble, close_commanded};
use jointplay_core::nalgebra::{DVector, Rotation3, Translation3, Vector3};
use jointplay_core::spatial::Pose;
use planar::hinge;
use proptest::prelude::*;

/// Half the travel of a rod (m), and the radius of the sockets (m).
const TRAVEL: f64 = 0.254;
const RADIUS: f64 = 0.093_218;
/// Heights of the first rod at which the sides are compared.
const HEIGHTS: i32 = 4000;

/// Frames of six joints, each off by up to one.
type Deviations = Vec<([f64; 3], [f64; 3])>;

fn deviations() -> impl Strategy<Value = Deviations> {
    let one = prop::array::uniform3(-1.0..1.0_f64);
    prop::collection::vec((one.clone(), one), 12)
}

/// The three-rod robot with each joint off on both of its links, in radians and radii.
fn inaccurate_robot(deviations: &Deviations, by: f64) -> Mechanism {
    let exact = Gpr::paper().to_mechanism("inaccurate");
    let mut joints = exact.joints().to_vec();
    let frames = joints.iter_mut().flat_map(|joint| &mut joint.frames);
    for (frame, (turn, shift)) in frames.zip(deviations) {
        let turn = Rotation3::new(Vector3::from(*turn) * by);
        let shift = Vector3::from(*shift) * (by * RADIUS);
        *frame *= Pose::from_parts(Translation3::from(shift), turn);
    }
    exact.with_joints(joints).unwrap()
}

/// The centres of the balls lie on lines, where the rods carry them, and at given distances, where the platform holds them.
struct Sides {
    /// Point and direction of each line.
    lines: [(Vector3<f64>, Vector3<f64>); 3],
    sockets: [Vector3<f64>; 3],
}

impl Sides {
    fn of(mechanism: &Mechanism) -> Self {
        let [rods, balls] = [0, 3].map(|first| &mechanism.joints()[first..first + 3]);
        let line = |k: usize| {
            let [base, rod] = rods[k].frames;
            let in_rod = rod.inverse() * balls[k].frames[0];
            let center = base * in_rod;
            (center.translation.vector, base.rotation * Vector3::z())
        };
        let socket = |k: usize| balls[k].frames[1].translation.vector;
        Self { lines: [0, 1, 2].map(line), sockets: [0, 1, 2].map(socket) }
    }

    fn ball(&self, k: usize, q: f64) -> Vector3<f64> {
        self.lines[k].0 + self.lines[k].1 * q
    }

    fn side(&self, i: usize, j: usize) -> f64 {
        (self.sockets[i] - self.sockets[j]).norm()
    }

    /// Positions of a rod at which its ball is a side away from the ball of the first rod.
    fn rods_at_a_side(&self, k: usize, first: f64) -> Option<[f64; 2]> {
        let off = self.lines[k].0 - self.ball(0, first);
        let along = off.dot(&self.lines[k].1);
        let root = along * along - off.norm_squared() + self.side(0, k).powi(2);
        (root >= 0.0).then(|| [-along + root.sqrt(), -along - root.sqrt()])
    }

    /// Rods (second and third) and the mismatch of the last side, for a height of the first rod; a closed curve of four parts, between heights at which two of them meet.
    fn at(&self, first: f64) -> Option<[([f64; 2], f64); 4]> {
        let second = self.rods_at_a_side(1, first)?;
        let third = self.rods_at_a_side(2, first)?;
        let one = |(a, b): (usize, usize)| {
            let q = [second[a], third[b]];
            let length = (self.ball(1, q[0]) - self.ball(2, q[1])).norm();
            (q, length - self.side(1, 2))
        };
        Some([(0, 0), (0, 1), (1, 0), (1, 1)].map(one))
    }

    /// Heights of the first rod at which the sides fit, with all rods within their travel.
    fn closures(&self) -> Vec<f64> {
        let heights = (-HEIGHTS..=HEIGHTS).map(|k| TRAVEL * f64::from(k) / f64::from(HEIGHTS));
        let all: Vec<_> = heights.map(|height| (height, self.at(height))).collect();
        let within = |q: &[f64; 2]| q.iter().all(|q| q.abs() < TRAVEL);
        let mut found = Vec::new();
        for pair in all.windows(2) {
            match [pair[0].1, pair[1].1] {
                [Some(before), Some(after)] => found.extend((0..4).filter_map(|part| {
                    let changes = (before[part].1 > 0.0) != (after[part].1 > 0.0);
                    (changes && within(&before[part].0)).then_some(pair[0].0)
                })),
                // Two parts meet between the heights.
                [Some(at), None] | [None, Some(at)] => {
                    let beyond = if pair[0].1.is_none() { pair[0].0 } else { pair[1].0 };
                    let meet = match self.rods_at_a_side(1, beyond) {
                        None => [(0, 2), (1, 3)],
                        Some(_) => [(0, 1), (2, 3)],
                    };
                    found.extend(meet.into_iter().filter_map(|(one, other)| {
                        let changes = (at[one].1 > 0.0) != (at[other].1 > 0.0);
                        (changes && within(&at[one].0)).then_some(pair[0].0)
                    }));
                }
                [None, None] => {}
            }
        }
        found
    }

    /// Largest difference of a side (m).
    fn missed_by(&self, rods: &[f64]) -> f64 {
        let missed = |(i, j): (usize, usize)| {
            ((self.ball(i, rods[i]) - self.ball(j, rods[j])).norm() - self.side(i, j)).abs()
        };
        [(0, 1), (1, 2), (2, 0)].into_iter().map(missed).fold(0.0, f64::max)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// Wherever a tilt closes the robot within the travel of its rods, a closure is found, with rods that differ by the root of the deviation.
    #[test]
    fn small_tilts_close_inaccurate_robots_at_every_scale(deviations in deviations(), digits in 3.0..7.0_f64) {
        let by = 10_f64.powf(-digits);
        let mechanism = inaccurate_robot(&deviations, by);
        let sides = Sides::of(&mechanism);
        let expected = sides.closures();
        let found = close_commanded(&mechanism, &[], None).ok();
        let rods = |found: &Closure| [0, 1, 2].map(|k| found.coordinates[k]);
        let within = |found: &Closure| rods(found).iter().all(|q| q.abs() <= TRAVEL);
        let found = found.filter(within);
        prop_assert!(found.is_some() || expected.is_empty(), "{} {:?}", by, expected);
        let Some(found) = found else { return Ok(()) };
        let rods = rods(&found);
        prop_assert!(sides.missed_by(&rods) < 1e-11 * RADIUS, "{:?}", rods);
        let [least, greatest] = rods.iter().fold([f64::MAX, f64::MIN], |[a, b], q| [a.min(*q), b.max(*q)]);
        prop_assert!(greatest - least < 10.0 * RADIUS * by.sqrt(), "{} {:?}", by, rods);
    }

    /// Three links in line, one of which has a length that deviates: the triangle closes where no link is longer than the two others together.
    #[test]
    fn triangles_in_line_open_as_far_as_their_lengths_ask(
        share in 0.2..0.8_f64, digits in 3.0..8.0_f64, is_longer: bool,
    ) {
        let by = 10_f64.powf(-digits) * if is_longer { 1.0 } else { -1.0 };
        let lengths = [1.0, share, 1.0 - share + by];
        let joints = vec![
            hinge("A", [0, 1], [0.0, 0.0]),
            hinge("B", [1, 2], [lengths[1], 0.0]),
            hinge("C", [2, 0], [lengths[2], 1.0]),
        ];
        let links = ["a", "b", "c"].map(str::to_owned).to_vec();
        let mechanism = Mechanism::new("triangle", links, joints).unwrap();
        let mechanism = mechanism.with_characteristic_length(1.0).unwrap();
        let found = assemble(&mechanism, &DVector::zeros(3), &[], 0);
        prop_assert_eq!(found.is_ok(), is_longer, "{} {:?}", by, found);
        let Ok(found) = found else { return Ok(()) };
        // The law of cosines by half the angle, in which nothing cancels.
        let [base, side, opposite] = lengths;
        let half = (by * (opposite + base - side) / (4.0 * base * side)).sqrt().asin();
        let angle = 2.0 * half;
        let turned = found.coordinates[0].abs();
        prop_assert!((turned / angle - 1.0).abs() < 1e-3, "{} {} {}", by, turned, angle);
    }
}
