//! Linkages of the catalogue against their closed forms, at every step of a drive over as much of the cycle as there is.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use jointplay::format::catalogue;
use jointplay::format::mechanism::parse_with;
use jointplay::mechanism::{Drive, Mechanism, MechanismSystem, assemble, drive, guess};
use jointplay::mobility::{RANK_THRESHOLD, finite_mobility};
use jointplay::spatial::Pose;
use nalgebra::{DVector, Matrix3, Rotation3, Translation3, Vector2, Vector3};

/// Steps of a drive are closed to round-off, which the loops hand on to angles some hundredfold: closed forms hold to 2·10⁻¹³ here.
const TOLERANCE: f64 = 1e-12;

/// A mechanism of the catalogue in motion.
struct Ride {
    mechanism: Mechanism,
    /// Joint coordinates at every step (m, rad).
    steps: Vec<DVector<f64>>,
}

impl Ride {
    /// Drives joints, from the closed guess to the first of two values each and on to the second.
    fn new(name: &str, set: &[(&str, f64)], drives: &[(&str, f64, f64)], count: usize) -> Self {
        let set: Vec<(String, f64)> =
            set.iter().map(|&(name, value)| (name.to_owned(), value)).collect();
        let text = catalogue::find(name).unwrap().text;
        let mechanism = parse_with(text, &set).unwrap().mechanism;
        let start = assemble(&mechanism, &guess(&mechanism), &[], 0).unwrap().coordinates;
        let mut ride = Self { mechanism, steps: vec![start] };
        let there =
            |k: usize| drives.iter().map(move |drive| (drive.0, [drive.1, drive.2][k])).collect();
        ride.go(&there(0), count);
        ride.steps.drain(..ride.steps.len() - 1);
        ride.go(&there(1), count);
        assert_eq!(ride.steps.len(), count + 1);
        ride
    }

    fn go(&mut self, to: &Vec<(&str, f64)>, count: usize) {
        let drives: Vec<Drive> =
            to.iter().map(|&(joint, to)| Drive { coordinate: self.index(joint), to }).collect();
        let free: Vec<usize> = (0..self.mechanism.joint_freedoms())
            .filter(|k| drives.iter().all(|one| one.coordinate != *k))
            .collect();
        let here = self.steps.last().unwrap().clone();
        let system = MechanismSystem::new(&self.mechanism, here).unwrap();
        let motion = drive(&system, &drives, &free, count).unwrap();
        assert_eq!(motion.stopped, None, "{}", self.mechanism.name());
        self.steps.extend(motion.waypoints.into_iter().skip(1).map(|there| there.coordinates));
    }

    fn index(&self, joint: &str) -> usize {
        let joint = self.mechanism.joint(joint).unwrap();
        self.mechanism.joints()[..joint].iter().map(|before| before.kind.freedoms()).sum()
    }

    /// A joint coordinate (m, rad).
    fn value(&self, at: &DVector<f64>, joint: &str) -> f64 {
        at[self.index(joint)]
    }

    fn poses(&self, at: &DVector<f64>) -> Vec<Pose> {
        jointplay::mechanism::Kinematics::new(&self.mechanism).link_poses(at).unwrap()
    }

    fn pose(&self, at: &DVector<f64>, link: &str) -> Pose {
        self.poses(at)[self.mechanism.link(link).unwrap()]
    }

    /// A point of a joint (m) and the direction of its axis.
    fn axis(&self, at: &DVector<f64>, joint: &str) -> (Vector3<f64>, Vector3<f64>) {
        let joint = &self.mechanism.joints()[self.mechanism.joint(joint).unwrap()];
        let frame = self.poses(at)[joint.links[1]] * joint.frames[1];
        (frame.translation.vector, frame.rotation * Vector3::z())
    }
}

#[track_caller]
fn near(found: f64, expected: f64) {
    let off = (found - expected).abs();
    assert!(off <= TOLERANCE, "found {found:e}, expected {expected:e}, off by {off:e}");
}

/// The same angle, whole turns aside.
#[track_caller]
fn same_turn(found: f64, expected: f64) {
    let off = found - expected;
    near(off - (off / TAU).round() * TAU, 0.0);
}

#[track_caller]
fn only_moved(pose: &Pose, by: Vector3<f64>) {
    near((pose.rotation.matrix() - Matrix3::identity()).norm(), 0.0);
    near((pose.translation.vector - by).norm(), 0.0);
}

fn deg(angle: f64) -> f64 {
    angle.to_radians()
}

/// sin((β + α)/2) / sin((β − α)/2): what tan θ₁/2 · tan θ₂/2 is in Bennett's linkage.
fn bennett_ratio(alpha: f64, beta: f64) -> f64 {
    (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin()
}

/// tan x · tan y = ratio, without infinities.
#[track_caller]
fn tangents(x: f64, y: f64, ratio: f64) {
    near(x.sin() * y.sin() - ratio * x.cos() * y.cos(), 0.0);
}

#[test]
fn bennett_linkage_turns_a_full_revolution() {
    let ride = Ride::new("bennett", &[], &[("J1", 0.9, 0.9 + TAU)], 240);
    // Printed in the file.
    near(ride.value(&ride.steps[0], "J2"), 2.597630785817415);
    let ratio = bennett_ratio(deg(90.0), deg(150.0));
    for at in &ride.steps {
        let [one, two, three, four] = ["J1", "J2", "J3", "J4"].map(|joint| ride.value(at, joint));
        tangents(0.5 * one, 0.5 * two, ratio);
        same_turn(three, -one);
        same_turn(four, -two);
    }
    // Whole turns of the one are whole turns of the other.
    near(ride.value(ride.steps.last().unwrap(), "J2") - ride.value(&ride.steps[0], "J2"), -TAU);
}

#[test]
fn cells_of_a_row_of_bennett_linkages_move_as_one() {
    let ride = Ride::new("bennett-network", &[], &[("P1", 0.3, 2.8)], 100);
    let ratio = bennett_ratio(deg(90.0), deg(150.0));
    for at in &ride.steps {
        let [p, q] = ["P1", "Q1"].map(|joint| ride.value(at, joint));
        tangents(0.5 * p, 0.5 * q, ratio);
        for (joint, expected) in [("P2", -p), ("P3", p), ("P4", -p), ("R1", -q), ("Q2", -q)] {
            same_turn(ride.value(at, joint), expected);
        }
        for (joint, expected) in [("R2", q), ("Q3", q), ("R3", -q)] {
            same_turn(ride.value(at, joint), expected);
        }
    }
}

#[test]
fn goldberg_is_two_of_bennetts() {
    let ride = Ride::new("goldberg-5r", &[], &[("J1", 0.2, 6.0)], 200);
    let twist = |b: f64| PI - (b / 0.22).asin();
    for at in &ride.steps {
        let [one, two, three, four, five] =
            ["J1", "J2", "J3", "J4", "J5"].map(|joint| ride.value(at, joint));
        tangents(0.5 * one, 0.5 * two, bennett_ratio(deg(90.0), twist(0.11)));
        tangents(0.5 * four, 0.5 * five, bennett_ratio(deg(90.0), twist(0.16)));
        // The omitted link has one direction in both.
        same_turn(three, PI - one - five);
    }
}

#[test]
fn myard_is_a_bennett_and_its_mirror_image() {
    let ride = Ride::new("myard", &[], &[("J1", -2.5, 2.5)], 200);
    let ratio = bennett_ratio(deg(50.0), FRAC_PI_2);
    for at in &ride.steps {
        let [one, two, three, four, five] =
            ["J1", "J2", "J3", "J4", "J5"].map(|joint| ride.value(at, joint));
        // The plane of symmetry halves the angle at the base.
        tangents(0.25 * (one + PI), 0.5 * two, ratio);
        same_turn(five, -two);
        same_turn(four, three - PI);
    }
}

#[test]
fn sarrus_guides_straight_and_does_not_turn() {
    let ride = Ride::new("sarrus", &[], &[("A1", deg(-45.0), deg(35.0))], 100);
    let height = |angle: f64| 2.0 * 0.2 * angle.sin();
    for at in &ride.steps {
        let up = height(deg(40.0) - ride.value(at, "A1")) - height(deg(40.0));
        only_moved(&ride.pose(at, "table"), Vector3::new(0.0, 0.0, up));
    }
}

#[test]
fn parallelogram_carries_its_coupler_on_a_circle() {
    let ride = Ride::new("parallelogram", &[], &[("A1", deg(-60.0), deg(110.0))], 100);
    let crank = |angle: f64| Vector3::new(angle.cos(), angle.sin(), 0.0) * 0.1;
    for at in &ride.steps {
        let turned = ride.value(at, "A1");
        let moved = crank(deg(65.0) + turned) - crank(deg(65.0));
        only_moved(&ride.pose(at, "coupler"), moved);
        same_turn(ride.value(at, "A3"), turned);
    }
}

#[test]
fn double_parallelogram_carries_its_stage_on_two_circles() {
    let drives = [("A1", deg(-30.0), deg(40.0)), ("C1", deg(25.0), deg(-35.0))];
    let ride = Ride::new("double-parallelogram", &[], &drives, 100);
    let turned = |arm: Vector2<f64>, angle: f64| {
        let moved = nalgebra::Rotation2::new(angle) * arm - arm;
        Vector3::new(moved.x, moved.y, 0.0)
    };
    let outer = Vector2::new(deg(8.0).sin(), -deg(8.0).cos()) * 0.04;
    let inner = Vector2::new(deg(5.0).sin(), deg(5.0).cos()) * 0.04;
    for at in &ride.steps {
        let by = turned(outer, ride.value(at, "A1")) + turned(inner, ride.value(at, "C1"));
        only_moved(&ride.pose(at, "stage"), by);
    }
}

#[test]
fn four_bar_by_freudenstein() {
    let ride = Ride::new("four-bar", &[], &[("A", 0.0, TAU)], 240);
    let (ground, crank, coupler, rocker) = (0.3, 0.1, 0.26, 0.2);
    let (c, _) = ride.axis(&ride.steps[0], "C");
    let slope = c.y.atan2(c.x - ground);
    let constant = (crank * crank - coupler * coupler + rocker * rocker + ground * ground)
        / (2.0 * crank * rocker);
    for at in &ride.steps {
        let (theta, phi) = (deg(70.0) + ride.value(at, "A"), slope + ride.value(at, "D"));
        let sides = ground / crank * phi.cos() - ground / rocker * theta.cos() + constant;
        near(sides, (theta - phi).cos());
    }
    near(ride.value(ride.steps.last().unwrap(), "D"), 0.0);
}

#[test]
fn slider_crank_piston() {
    let ride = Ride::new("slider-crank", &[], &[("main bearing", 0.0, TAU)], 240);
    let piston = |angle: f64| {
        0.045 * angle.cos() + (0.14_f64.powi(2) - (0.045 * angle.sin()).powi(2)).sqrt()
    };
    for at in &ride.steps {
        let angle = deg(50.0) + ride.value(at, "main bearing");
        near(ride.value(at, "cylinder"), piston(angle) - piston(deg(50.0)));
    }
}

#[test]
fn scissors_lift_three_times_the_height_of_one() {
    let ride = Ride::new("scissor-lift", &[], &[("slide 0", -0.6, 0.1)], 100);
    let height = |width: f64| 3.0 * (0.8_f64.powi(2) - width * width).sqrt();
    let width = 0.8 * deg(35.0).cos();
    for at in &ride.steps {
        let up = height(width + ride.value(at, "slide 0")) - height(width);
        only_moved(&ride.pose(at, "table"), Vector3::new(0.0, up, 0.0));
    }
}

#[test]
fn spherical_four_bar_by_the_cosine_law() {
    // Nearly from the one dead point to the other.
    let ride = Ride::new("spherical-4r", &[], &[("A", deg(-174.0), deg(23.0))], 200);
    let rest = DVector::zeros(4);
    let [a, b, c, d] = ["A", "B", "C", "D"].map(|joint| ride.axis(&rest, joint).1);
    let (crank, coupler, rocker, ground) = (a.angle(&b), b.angle(&c), c.angle(&d), a.angle(&d));
    // Turn about an axis, from the great circle to `other` to the one to `point`.
    let azimuth = |axis: &Vector3<f64>, other: &Vector3<f64>, point: &Vector3<f64>| {
        let (u, v) = (axis.cross(other), axis.cross(point));
        axis.dot(&u.cross(&v)).atan2(u.dot(&v))
    };
    let (theta, phi) = (azimuth(&a, &d, &b), azimuth(&d, &a, &c));
    for at in &ride.steps {
        let (theta, phi) = (theta + ride.value(at, "A"), phi + ride.value(at, "D"));
        let along = crank.cos() * ground.cos() + crank.sin() * ground.sin() * theta.cos();
        let across = (crank.cos() * ground.sin() - crank.sin() * ground.cos() * theta.cos())
            * phi.cos()
            - crank.sin() * theta.sin() * phi.sin();
        near(along * rocker.cos() + across * rocker.sin(), coupler.cos());
    }
}

#[test]
fn orthogonal_bricard_angles() {
    // With θ = 90° + J of the one kind of joints and φ of the other: cos θ + cos φ + cos θ cos φ = 0.
    let ride = Ride::new("bricard-orthogonal", &[], &[("J1", -0.5, 1.4)], 200);
    for at in &ride.steps {
        let odd = ride.value(at, "J1");
        let even = ride.value(at, "J2");
        near(odd.sin() + even.sin() + odd.sin() * even.sin(), 0.0);
        for (joint, expected) in [("J3", odd), ("J5", odd), ("J4", even), ("J6", -even)] {
            same_turn(ride.value(at, joint), expected);
        }
    }
}

#[test]
fn trihedral_bricard_with_equal_links() {
    let equal: Vec<(&str, f64)> =
        ["a1", "a2", "a3", "a4", "a6"].into_iter().map(|name| (name, 0.3)).collect();
    let ride = Ride::new("bricard-trihedral", &equal, &[("J1", 1.0, 1.7)], 100);
    for at in &ride.steps {
        let [odd, even] = ["J1", "J2"].map(|joint| ride.value(at, joint));
        near(odd.cos() + even.cos() + odd.cos() * even.cos(), 0.0);
        for (joint, expected) in [("J3", odd), ("J5", odd), ("J4", even), ("J6", even)] {
            same_turn(ride.value(at, joint), expected);
        }
    }
}

#[test]
fn trihedral_bricard_axes_meet_in_two_points() {
    let ride = Ride::new("bricard-trihedral", &[], &[("J1", 0.7, 1.6)], 100);
    for at in &ride.steps {
        for three in [["J1", "J3", "J5"], ["J2", "J4", "J6"]] {
            let axes = three.map(|joint| ride.axis(at, joint));
            // Sum of the projections square to each axis, and of what they make of its point.
            let square = |z: &Vector3<f64>| Matrix3::identity() - z * z.transpose();
            let normal: Matrix3<f64> = axes.iter().map(|(_, z)| square(z)).sum();
            let right: Vector3<f64> = axes.iter().map(|(p, z)| square(z) * p).sum();
            let meeting = normal.try_inverse().unwrap() * right;
            for (p, z) in &axes {
                near((square(z) * (meeting - p)).norm(), 0.0);
            }
        }
    }
}

/// Poses about the reference configuration: shift (m), then rotation vector (rad).
const TARGETS: [([f64; 3], [f64; 3]); 4] = [
    ([0.05, -0.03, 0.04], [0.1, 0.0, 0.0]),
    ([-0.06, 0.02, -0.05], [0.05, -0.12, 0.2]),
    ([0.0, 0.08, 0.03], [0.0, 0.15, -0.1]),
    ([0.02, 0.03, 0.1], [-0.1, 0.1, 0.15]),
];

#[test]
fn hexapod_legs_of_a_pose() {
    let legs: Vec<[String; 3]> =
        (1..=6).map(|k| ["U", "P", "S"].map(|kind| format!("{kind}{k}"))).collect();
    let home = Ride::new("hexapod", &[], &[("P1", 0.0, 0.0)], 1);
    let rest = DVector::zeros(36);
    for (shift, turn) in TARGETS {
        let target = Pose::from_parts(
            Translation3::from(Vector3::from(shift)),
            Rotation3::new(Vector3::from(turn)),
        );
        let lengths: Vec<f64> = legs
            .iter()
            .map(|[u, _, s]| {
                let [foot, head] = [u, s].map(|joint| home.axis(&rest, joint).0);
                let moved = target.rotation * head + target.translation.vector;
                (moved - foot).norm() - (head - foot).norm()
            })
            .collect();
        let drives: Vec<(&str, f64, f64)> = legs
            .iter()
            .zip(&lengths)
            .map(|([_, p, _], &length)| (p.as_str(), 0.0, length))
            .collect();
        let ride = Ride::new("hexapod", &[], &drives, 10);
        let found = ride.pose(ride.steps.last().unwrap(), "platform");
        only_moved(&(target.inverse() * found), Vector3::zeros());
    }
}

#[test]
fn tsai_platform_legs_of_a_shift() {
    let home = Ride::new("3-upu-tsai", &[], &[("P1", 0.0, 0.0)], 1);
    let rest = DVector::zeros(15);
    for (shift, _) in TARGETS {
        let shift = Vector3::from(shift);
        let lengths = [1, 2, 3].map(|k| {
            let [foot, head] = ["U", "V"].map(|kind| home.axis(&rest, &format!("{kind}{k}")).0);
            (head + shift - foot).norm() - (head - foot).norm()
        });
        let drives = [("P1", 0.0, lengths[0]), ("P2", 0.0, lengths[1]), ("P3", 0.0, lengths[2])];
        let ride = Ride::new("3-upu-tsai", &[], &drives, 10);
        only_moved(&ride.pose(ride.steps.last().unwrap(), "platform"), shift);
    }
}

#[test]
fn delta_by_three_spheres() {
    let (rb, rp, arm, rod, angle) = (0.12, 0.04, 0.16, 0.32, deg(-20.0));
    // Elbows drawn in by the platform's radius; the platform's centre is a rod away from each.
    let centre = |turns: [f64; 3]| {
        let elbows = [0, 1, 2].map(|k| {
            let (sin, cos) = deg(120.0 * f64::from(k as i32)).sin_cos();
            let swing = angle + turns[k];
            let out = rb + arm * swing.cos() - rp;
            Vector3::new(out * cos, out * sin, arm * swing.sin())
        });
        let (ab, ac) = (elbows[1] - elbows[0], elbows[2] - elbows[0]);
        let normal = ab.cross(&ac);
        // Centre of the elbows' circle, then down to the spheres' common point below.
        let to_circle = (normal.cross(&ab) * ac.norm_squared()
            + ac.cross(&normal) * ab.norm_squared())
            / (2.0 * normal.norm_squared());
        let depth = (rod * rod - to_circle.norm_squared()).sqrt();
        elbows[0] + to_circle - normal.normalize() * depth
    };
    for turns in [[0.2, -0.3, 0.1], [0.5, 0.4, -0.2], [-0.6, -0.5, -0.7], [0.0, 0.6, 0.0]] {
        let [one, two, three] = turns;
        let drives = [("drive 1", 0.0, one), ("drive 2", 0.0, two), ("drive 3", 0.0, three)];
        let ride = Ride::new("delta", &[], &drives, 10);
        for at in &ride.steps {
            let turns = ["drive 1", "drive 2", "drive 3"].map(|joint| ride.value(at, joint));
            only_moved(&ride.pose(at, "platform"), centre(turns) - centre([0.0; 3]));
        }
    }
}

#[test]
fn tripteron_and_its_kin_move_as_their_slides() {
    for (name, slides) in [("tripteron", ["Px", "Py", "Pz"]), ("3-crr", ["Cx", "Cy", "Cz"])] {
        for shift in [[0.05, -0.03, 0.08], [-0.08, 0.1, 0.02]] {
            let drives = [0, 1, 2].map(|k| (slides[k], 0.0, shift[k]));
            let ride = Ride::new(name, &[], &drives, 10);
            for at in &ride.steps {
                let moved = slides.map(|slide| ride.value(at, slide));
                only_moved(&ride.pose(at, "platform"), Vector3::from(moved));
            }
        }
    }
}

#[test]
fn orthoglide_slides_of_a_point() {
    let start = Vector3::new(0.03, -0.02, 0.05);
    // Position of the slide of an axis for a platform there: a bar's length behind it.
    let slides = |p: Vector3<f64>| {
        [0, 1, 2].map(|k| {
            let aside = p.norm_squared() - p[k] * p[k];
            p[k] - (0.31_f64.powi(2) - aside).sqrt()
        })
    };
    for shift in [[0.05, 0.03, -0.06], [-0.08, 0.07, 0.04], [0.0, 0.0, -0.12]] {
        let shift = Vector3::from(shift);
        let (here, there) = (slides(start), slides(start + shift));
        let names = ["Px", "Py", "Pz"];
        let drives = [0, 1, 2].map(|k| (names[k], 0.0, there[k] - here[k]));
        let ride = Ride::new("orthoglide", &[], &drives, 10);
        only_moved(&ride.pose(ride.steps.last().unwrap(), "platform"), shift);
    }
}

/// Bars of one kind after they have turned, seen from the base of a drawing with parameters t, c0 and c1.
struct Bars {
    near: Vector2<f64>,
    far: Vector2<f64>,
}

impl Bars {
    fn new(ride: &Ride, at: &DVector<f64>, [near, far]: [&str; 2], ends: [[&str; 2]; 2]) -> Self {
        let rest = DVector::zeros(at.len());
        let bar = |link: &str, [from, to]: [&str; 2]| {
            let drawn = ride.axis(&rest, to).0 - ride.axis(&rest, from).0;
            (ride.pose(at, link).rotation * drawn).xy()
        };
        Self { near: bar(near, ends[0]), far: bar(far, ends[1]) }
    }

    fn difference(&self) -> Vector2<f64> {
        self.far - self.near
    }
}

#[test]
fn wunderlich_moves_with_one_freedom_and_with_two() {
    // Pins by the ends of the bars: P1, P2 of c1 and P3, P4 of c2 at the near end, for a likewise P1, P5 and P3, P7.
    let bars = |ride: &Ride, at: &DVector<f64>| {
        let a = Bars::new(ride, at, ["a1", "a3"], [["P1", "P5"], ["P3", "P7"]]);
        let c = Bars::new(ride, at, ["c1", "c2"], [["P1", "P2"], ["P3", "P4"]]);
        (a, c)
    };
    let one = Ride::new("wunderlich-12-bar", &[], &[("P1", -0.1, 0.2)], 60);
    let mut least_turn = f64::MAX;
    for at in &one.steps {
        let (a, c) = bars(&one, at);
        near(a.difference().dot(&c.difference()), 0.0);
        let diagonals = a.difference().norm_squared() + c.difference().norm_squared();
        near(diagonals / 144.0, 1.0);
        // Both ends of a bar c turn alike against bars a, which are parallel, but not against bars b.
        same_turn(one.value(at, "Q1"), one.value(at, "Q2"));
        least_turn = least_turn.min(c.difference().norm());
    }
    assert!(least_turn > 1.0, "{least_turn}");
    // The other branch: bars c parallel, in any direction.
    for c0 in [10.0, 40.0, 100.0] {
        let set = [("c0", c0), ("c1", c0)];
        let two = Ride::new("wunderlich-12-bar", &set, &[("P1", 0.0, 0.05)], 5);
        let (_, c) = bars(&two, two.steps.last().unwrap());
        near(c.difference().norm(), 0.0);
        assert_eq!(mobilities(&two, 0), (2, Some(2)));
    }
    assert_eq!(mobilities(&one, 0), (1, Some(1)));
    // Where both branches meet, the instantaneous mobility is 3.
    let both = Ride::new("wunderlich-12-bar", &[("t", 0.0)], &[("P1", 0.0, 0.0)], 1);
    assert_eq!(mobilities(&both, 0), (3, Some(2)));
}

/// Instantaneous and finite mobility.
fn mobilities(ride: &Ride, step: usize) -> (usize, Option<usize>) {
    let system = MechanismSystem::new(&ride.mechanism, ride.steps[step].clone()).unwrap();
    let found = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
    (found.instantaneous.mobility, found.mobility)
}
