//! Velocities, accelerations and Jacobians of mechanisms: against differences of positions, and where there are none.

use crate::robot;

use jointplay_core::Error;
use jointplay_core::gpr::{AxisHeight, Gpr};
use jointplay_core::mechanism::{
    AttachedFrame, Carrier, ChangedDimension, DifferentialKinematics, FrameId, JointKind,
    Kinematics, Mechanism, MechanismSystem, PositionSolver, ReliefSolver, VirtualJoint,
    VirtualMotion, assemble,
};
use jointplay_core::mobility::RANK_THRESHOLD;
use jointplay_core::nalgebra::{DVector, Rotation3, Unit, Vector3, Vector6};
use jointplay_core::sensitivity::commanded_sensitivity;
use jointplay_core::spatial::{Pose, Tilt, rotation_vector};
use jointplay_core::virtualization::{
    Planar, Platform, Polar, Radial, Sockets, SolveOptions, Solver, Virtualization,
};

use robot::{gpr, joint, names, planar, polar, radial};

/// A mechanism at a closed configuration, driven.
struct Case {
    mechanism: Mechanism,
    commanded: Vec<usize>,
    at: DVector<f64>,
}

impl Case {
    /// With an attached frame at an odd place on each link, closed with the commanded coordinates at values.
    fn new(mechanism: Mechanism, commanded: &[(usize, f64)]) -> Self {
        let place = |link: usize| {
            let far = 0.1 + 0.01 * link as f64;
            let turn = Rotation3::new(Vector3::new(0.3, -0.2, far));
            let frame = Pose::from_parts(Vector3::new(far, -0.07, 0.05).into(), turn);
            AttachedFrame { name: format!("frame {link}"), link, link_from_frame: frame }
        };
        let frames = (1..mechanism.links().len()).map(place).collect();
        let mechanism = mechanism.with_frames(frames).unwrap();
        let count = mechanism.joint_freedoms() + mechanism.virtual_joints().len();
        let held: Vec<usize> = commanded.iter().map(|&(k, _)| k).collect();
        let rest = DVector::zeros(count);
        let home = assemble(&mechanism, &rest, &[], 30).unwrap().coordinates;
        let system = MechanismSystem::new(&mechanism, home.clone()).unwrap();
        let mut solver = PositionSolver::new(&system, &held).unwrap();
        let mut at = home.clone();
        for share in 1..=10 {
            for &(k, value) in commanded {
                at[k] = home[k] + (value - home[k]) * f64::from(share) / 10.0;
            }
            solver.solve(at.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
        }
        // By the metric of the configuration itself: its characteristic length weighs turns.
        let system = MechanismSystem::new(&mechanism, at.clone()).unwrap();
        let mut solver = PositionSolver::new(&system, &held).unwrap();
        solver.solve(at.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
        Self { mechanism, commanded: held, at }
    }

    fn system(&self) -> MechanismSystem<'_> {
        MechanismSystem::new(&self.mechanism, self.at.clone()).unwrap()
    }

    /// The configuration after a time, at constant commanded accelerations; a commanded ball turns on in its own frame.
    fn after(&self, time: f64, velocity: &[f64], acceleration: &[f64]) -> DVector<f64> {
        let system = self.system();
        let mut solver = PositionSolver::new(&system, &self.commanded).unwrap();
        let mut by = DVector::zeros(self.at.len());
        for (j, &k) in self.commanded.iter().enumerate() {
            by[k] = velocity[j] * time + 0.5 * acceleration[j] * time * time;
        }
        let mut there = &self.at + &by;
        let mut k = 0;
        for joint in self.mechanism.joints() {
            if joint.kind == JointKind::Spherical && self.commanded.contains(&k) {
                let vector = |from: &DVector<f64>| from.fixed_rows::<3>(k).into_owned();
                let turn = Rotation3::new(vector(&self.at)) * Rotation3::new(vector(&by));
                there.fixed_rows_mut::<3>(k).copy_from(&rotation_vector(&turn));
            }
            k += joint.kind.freedoms();
        }
        solver.solve(there.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
        there
    }

    /// Difference of two configurations, balls by the rotation between them in the turned frame.
    fn between(&self, from: &DVector<f64>, to: &DVector<f64>) -> DVector<f64> {
        let mut difference = to - from;
        let mut k = 0;
        for joint in self.mechanism.joints() {
            if joint.kind == JointKind::Spherical {
                let turn = |at: &DVector<f64>| Rotation3::new(at.fixed_rows::<3>(k).into_owned());
                let by = rotation_vector(&(turn(from).inverse() * turn(to)));
                difference.fixed_rows_mut::<3>(k).copy_from(&by);
            }
            k += joint.kind.freedoms();
        }
        difference
    }

    fn velocity_at(
        &self,
        at: &DVector<f64>,
        velocity: &[f64],
    ) -> (DVector<f64>, Vec<Vector6<f64>>) {
        let system = self.system();
        let mut rates = DifferentialKinematics::new(&system, &self.commanded).unwrap();
        rates.linearize(at.as_slice()).unwrap();
        let mut all = DVector::zeros(self.at.len());
        rates.velocities(velocity, all.as_mut_slice()).unwrap();
        let twists = self.mechanism.moving_frames().map(|frame| {
            let twist = rates.frame_velocity(frame).unwrap();
            stacked(&twist.angular, &twist.linear)
        });
        (all, twists.collect())
    }

    fn poses(&self, at: &DVector<f64>) -> Vec<Pose> {
        let kinematics = Kinematics::new(&self.mechanism);
        let links = kinematics.link_poses(at).unwrap();
        self.mechanism.moving_frames().map(|frame| kinematics.frame_pose(frame, &links)).collect()
    }
}

fn stacked(angular: &Vector3<f64>, linear: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(angular.x, angular.y, angular.z, linear.x, linear.y, linear.z)
}

#[track_caller]
fn near(found: &[f64], expected: &[f64], share: f64) {
    let size = expected.iter().map(|value| value.abs()).fold(1e-3, f64::max);
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off <= share * size, "{off:e} of {size:e}: {found:?} {expected:?}");
}

/// Velocities, accelerations and Jacobians against central differences of positions.
#[track_caller]
fn check(case: &Case) {
    let count = case.commanded.len();
    let velocity: Vec<f64> = (0..count).map(|j| 0.05 * (1.3 + j as f64).sin()).collect();
    let acceleration: Vec<f64> = (0..count).map(|j| 0.08 * (0.4 + 2.0 * j as f64).cos()).collect();
    let h = 2e-3;
    let ends = [-h, h].map(|time| case.after(time, &velocity, &acceleration));
    let far = [-2.0 * h, 2.0 * h].map(|time| case.after(time, &velocity, &acceleration));
    // Two steps cancel the error of third order.
    let richardson = |near: DVector<f64>, far: DVector<f64>| (near * 8.0 - far) / (12.0 * h);
    let difference = |ends: &[DVector<f64>; 2]| {
        case.between(&case.at, &ends[1]) - case.between(&case.at, &ends[0])
    };
    let expected = richardson(difference(&ends), difference(&far));
    let (all, twists) = case.velocity_at(&case.at, &velocity);
    near(all.as_slice(), expected.as_slice(), 1e-8);

    // Velocities of frames against their poses.
    let [before, after] = [&ends[0], &ends[1]].map(|at| case.poses(at));
    for ((before, after), twist) in before.iter().zip(&after).zip(&twists) {
        let angular = rotation_vector(&(after.rotation * before.rotation.inverse())) / (2.0 * h);
        let linear = (after.translation.vector - before.translation.vector) / (2.0 * h);
        near(twist.as_slice(), stacked(&angular, &linear).as_slice(), 1e-5);
    }

    // Accelerations against velocities, which hold there.
    let system = case.system();
    let mut rates = DifferentialKinematics::new(&system, &case.commanded).unwrap();
    rates.linearize(case.at.as_slice()).unwrap();
    let mut again = DVector::zeros(case.at.len());
    rates.velocities(&velocity, again.as_mut_slice()).unwrap();
    let mut accelerations = DVector::zeros(case.at.len());
    rates.accelerations(&acceleration, accelerations.as_mut_slice()).unwrap();
    let speed = |time: f64| -> Vec<f64> {
        velocity.iter().zip(&acceleration).map(|(v, a)| v + a * time).collect()
    };
    let at = |time: f64, place: &DVector<f64>| case.velocity_at(place, &speed(time));
    let (ends, far) =
        ([at(-h, &ends[0]), at(h, &ends[1])], [at(-2.0 * h, &far[0]), at(2.0 * h, &far[1])]);
    let expected = richardson(&ends[1].0 - &ends[0].0, &far[1].0 - &far[0].0);
    near(accelerations.as_slice(), expected.as_slice(), 1e-7);
    for (i, frame) in case.mechanism.moving_frames().enumerate() {
        let found = rates.frame_acceleration(frame).unwrap();
        let found = stacked(&found.angular, &found.linear);
        let expected =
            ((ends[1].1[i] - ends[0].1[i]) * 8.0 - (far[1].1[i] - far[0].1[i])) / (12.0 * h);
        near(found.as_slice(), expected.as_slice(), 1e-7);
    }

    // The Jacobian gives the same velocities, and with its derivative the same accelerations, column by column.
    for (i, frame) in case.mechanism.moving_frames().enumerate() {
        let jacobian = rates.jacobian(frame).unwrap();
        near(
            (&jacobian * DVector::from_column_slice(&velocity)).as_slice(),
            twists[i].as_slice(),
            1e-12,
        );
        let derivative = rates.jacobian_derivative(frame, &velocity).unwrap();
        let jacobian_at = |time: f64| {
            let mut there = DifferentialKinematics::new(&system, &case.commanded).unwrap();
            let still = vec![0.0; count];
            there.linearize(case.after(time, &velocity, &still).as_slice()).unwrap();
            there.jacobian(frame).unwrap()
        };
        let expected = ((jacobian_at(h) - jacobian_at(-h)) * 8.0
            - (jacobian_at(2.0 * h) - jacobian_at(-2.0 * h)))
            / (12.0 * h);
        near(derivative.as_slice(), expected.as_slice(), 1e-7);
    }
}

fn slide(
    name: &str,
    joint: usize,
    carrier: Carrier,
    axis: [f64; 3],
    stiffness: Option<f64>,
) -> VirtualJoint {
    let motion = VirtualMotion::Slide(Unit::new_normalize(Vector3::from(axis)));
    VirtualJoint { name: name.to_owned(), joint, carrier, motion, clearance: None, stiffness }
}

/// A spatial four-bar with a hinge, two balls and a universal joint.
fn spatial_four_bar() -> Mechanism {
    let joints = vec![
        joint("crank", JointKind::Revolute, [0, 1], [0.0, 0.0, 0.0], [0.1, 0.2, 1.0]),
        joint("ball", JointKind::Spherical, [1, 2], [0.12, 0.03, 0.02], [0.0, 0.0, 1.0]),
        joint("cross", JointKind::Universal, [2, 3], [0.4, 0.25, 0.1], [0.0, 0.0, 1.0]),
        joint("rocker", JointKind::Revolute, [0, 3], [0.5, 0.0, 0.05], [0.0, 0.3, 1.0]),
    ];
    Mechanism::new("RSUR", names(4), joints).unwrap()
}

/// A table on upright legs of which three are driven: `virtual_joints` at the balls.
fn table(virtual_joints: Vec<VirtualJoint>) -> Mechanism {
    let corners = [[0.15, 0.1, 0.4], [-0.15, 0.1, 0.4], [-0.15, -0.1, 0.4], [0.15, -0.1, 0.4]];
    let mut joints = Vec::new();
    for (k, &corner) in corners.iter().enumerate() {
        let up = [0.0, 0.0, 1.0];
        joints.push(joint(["1", "2", "3", "4"][k], JointKind::Prismatic, [0, k + 1], corner, up));
    }
    for (k, &corner) in corners.iter().enumerate() {
        let up = [0.0, 0.0, 1.0];
        joints.push(joint(["a", "b", "c", "d"][k], JointKind::Spherical, [k + 1, 5], corner, up));
    }
    Mechanism::new("table", names(6), joints).unwrap().with_virtual_joints(virtual_joints).unwrap()
}

/// Two slides at each of the four balls: eight, where five are enough.
fn eight_slides(stiffness: impl Fn(usize) -> Option<f64>) -> Vec<VirtualJoint> {
    (0..8)
        .map(|k| {
            let axis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][k % 2];
            let carrier = [Carrier::Second, Carrier::First][k / 4];
            slide(&format!("v{k}"), 4 + k / 2, carrier, axis, stiffness(k))
        })
        .collect()
}

#[test]
fn a_spatial_four_bar_moves_as_its_positions_do() {
    for angle in [0.0, 0.3, -0.4] {
        check(&Case::new(spatial_four_bar(), &[(0, angle)]));
    }
}

#[test]
fn least_displacements_move_as_the_least_displacements_of_neighbours_do() {
    // Displaced by up to 5°, where the curvature of the constraints matters.
    let heights = [(0, 0.012), (1, 0.004), (2, -0.014)];
    check(&Case::new(table(eight_slides(|_| None)), &heights));
    let stiff = |k: usize| Some([1e6, 3e6, 2e5, 8e6][k % 4]);
    check(&Case::new(table(eight_slides(stiff)), &heights));
}

#[test]
fn the_robot_moves_as_its_positions_do_with_every_set_of_virtual_joints() {
    let rods = [(0, 0.504), (4, 0.4985), (8, 0.5)];
    for mechanism in [gpr(radial), gpr(polar), gpr(planar)] {
        check(&Case::new(mechanism, &rods));
    }
}

/// The pseudo-inverse of the constraint Jacobian alone is not the derivative of the least displacement.
#[test]
fn the_curvature_of_the_constraints_is_needed() {
    let heights = [(0, 0.012), (1, 0.004), (2, -0.014)];
    let case = Case::new(table(eight_slides(|_| None)), &heights);
    let (all, _) = case.velocity_at(&case.at, &[1.0, 0.0, 0.0]);
    let found = all.rows(16, 8).into_owned();
    let system = case.system();
    let at = system.at_home();
    let pseudo_inverse =
        commanded_sensitivity(&system, &at, &case.commanded, 1.0, RANK_THRESHOLD).unwrap();
    let off = (pseudo_inverse.matrix.column(0) - &found).norm() / found.norm();
    assert!(off > 1e-4, "{off}");
    // Without displacement both are the same.
    let level = Case::new(table(eight_slides(|_| None)), &[(0, 0.0), (1, 0.0), (2, 0.0)]);
    let (all, _) = level.velocity_at(&level.at, &[1.0, 0.0, 0.0]);
    assert!(all.rows(16, 8).norm() < 1e-12);
}

/// Two slides in series between a drive and the base: each has the share of its compliance, and half without stiffness.
#[test]
fn the_sensitivity_is_weighted_by_stiffness() {
    for (stiffness, shares) in [(None, [0.5, 0.5]), (Some([1e6, 9e6]), [0.9, 0.1])] {
        let joints = vec![
            joint("drive", JointKind::Prismatic, [0, 1], [0.0; 3], [1.0, 0.0, 0.0]),
            joint("pin", JointKind::Revolute, [1, 2], [0.0; 3], [0.0, 0.0, 1.0]),
            joint("anchor", JointKind::Revolute, [2, 0], [0.1, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ];
        let springs = [0, 1].map(|k| {
            let stiffness = stiffness.map(|both: [f64; 2]| both[k]);
            slide(["soft", "hard"][k], 1 + k, Carrier::First, [1.0, 0.0, 0.0], stiffness)
        });
        let mechanism = Mechanism::new("springs", names(3), joints).unwrap();
        let mechanism = mechanism.with_virtual_joints(springs.to_vec()).unwrap();
        let case = Case::new(mechanism, &[(0, 1e-4)]);
        let system = case.system();
        let found =
            commanded_sensitivity(&system, &system.at_home(), &case.commanded, 0.1, RANK_THRESHOLD)
                .unwrap();
        near(found.matrix.abs().as_slice(), &shares, 1e-12);
        let length = f64::hypot(shares[0], shares[1]);
        assert!((found.singular_values()[0] - length).abs() < 1e-12);
        let (all, _) = case.velocity_at(&case.at, &[1.0]);
        near(found.matrix.as_slice(), all.rows(3, 2).as_slice(), 1e-9);
    }
}

#[test]
fn a_commanded_ball_moves_by_its_angular_velocity() {
    // An open chain, commanded by all of its joints.
    let joints = vec![
        joint("x", JointKind::Prismatic, [0, 1], [0.0, 0.0, 0.3], [1.0, 0.2, 0.0]),
        joint("ball", JointKind::Spherical, [1, 2], [0.0, 0.0, 0.3], [0.0, 0.0, 1.0]),
        joint("arm", JointKind::Revolute, [2, 3], [0.2, 0.1, 0.3], [0.0, 1.0, 0.4]),
    ];
    let open = Mechanism::new("open", names(4), joints).unwrap();
    check(&Case::new(open, &[(0, 0.02), (1, 0.3), (2, -0.5), (3, 0.2), (4, 0.7)]));
}

#[test]
fn a_dead_point_has_no_velocities() {
    let points = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [2.5, 1.2]];
    let joints = (0..4).map(|k| {
        let [x, y] = points[k];
        joint(
            ["A", "B", "C", "D"][k],
            JointKind::Revolute,
            [k, (k + 1) % 4],
            [x, y, 0.0],
            [0.0, 0.0, 1.0],
        )
    });
    let linkage = Mechanism::new("stretched", names(4), joints.collect()).unwrap();
    let system = MechanismSystem::new(&linkage, DVector::zeros(4)).unwrap();
    // Crank and coupler are in line: the rocker cannot drive.
    let mut rates = DifferentialKinematics::new(&system, &[3]).unwrap();
    rates.linearize(&[0.0; 4]).unwrap();
    let mut all = [0.0; 4];
    let Err(Error::Undetermined(found)) = rates.velocities(&[1.0], &mut all) else { panic!() };
    assert_eq!(found.motions, 1);
    assert!(found.singular_values.min() < 1e-15 && found.singular_values.max() > 0.1);
    assert_eq!(rates.jacobian(FrameId::Link(1)), Err(Error::Undetermined(found)));
    // The crank can.
    let mut rates = DifferentialKinematics::new(&system, &[0]).unwrap();
    assert_eq!(rates.velocities(&[1.0], &mut all), Err(Error::NotLinearized));
    rates.linearize(&[0.0; 4]).unwrap();
    rates.velocities(&[1.0], &mut all).unwrap();
    assert!(rates.accelerations(&[1.0, 2.0], &mut all).is_err());
    // And both cannot at once, unless the loop agrees.
    let mut both = DifferentialKinematics::new(&system, &[0, 3]).unwrap();
    both.linearize(&[0.0; 4]).unwrap();
    assert!(matches!(
        both.velocities(&[1.0, 1.0], &mut [0.0; 4]),
        Err(Error::DependentCommands { .. })
    ));
    both.velocities(&[1.0, all[3]], &mut [0.0; 4]).unwrap();
}

/// Rates of a loop by Pinocchio 4.1.0 and NumPy 2.4.6, from `validation/golden/differential_reference.py`.
///
/// Crank at 0.3 rad, 0.7 rad/s and −0.4 rad/s²; rows: crank, ball (angular velocity in the turned frame), cross. Both solutions are at round-off, hence the tolerance.
#[test]
fn rates_of_a_spatial_loop_are_those_of_pinocchio() {
    let velocities = [
        0.7,
        -0.010977399884284617,
        -0.14764527393918667,
        -0.9064184663814605,
        0.2188436638666932,
        -0.0490607120611633,
    ];
    let accelerations = [
        -0.4,
        0.19591550125625845,
        0.1536286458867945,
        0.59918335656483,
        0.10693062969966947,
        -0.13435722543187462,
    ];
    let case = Case::new(spatial_four_bar(), &[(0, 0.3)]);
    let system = case.system();
    let mut rates = DifferentialKinematics::new(&system, &[0]).unwrap();
    rates.linearize(case.at.as_slice()).unwrap();
    let mut found = [0.0; 7];
    rates.velocities(&[0.7], &mut found).unwrap();
    near(&found[..6], &velocities, 1e-12);
    rates.accelerations(&[-0.4], &mut found).unwrap();
    near(&found[..6], &accelerations, 1e-12);
}

/// At level nothing determines a rod that is not commanded: play is not used there, and none of its derivatives is.
#[test]
fn a_freedom_without_displacement_is_undetermined() {
    let mechanism = gpr(planar);
    let at = DVector::<f64>::zeros(18);
    let system = MechanismSystem::new(&mechanism, at.clone()).unwrap();
    let mut rates = DifferentialKinematics::new(&system, &[0, 4]).unwrap();
    rates.linearize(at.as_slice()).unwrap();
    let Err(Error::Undetermined(found)) = rates.velocities(&[1.0, 0.0], &mut [0.0; 18]) else {
        panic!()
    };
    assert_eq!(found.motions, 1);
    // Four freedoms are left, of which the least displacement determines three.
    assert_eq!(found.singular_values.iter().filter(|&&value| value < 1e-12).count(), 4);
}

#[test]
fn open_loops_and_displacements_that_are_not_least_are_refused() {
    let mechanism = spatial_four_bar();
    let system = MechanismSystem::new(&mechanism, DVector::zeros(7)).unwrap();
    let mut rates = DifferentialKinematics::new(&system, &[0]).unwrap();
    let mut at = [0.0; 7];
    at[0] = 0.1;
    assert!(matches!(rates.linearize(&at), Err(Error::NotClosed { .. })));
    assert!(matches!(rates.linearize(&[f64::NAN; 7]), Err(Error::NotFinite { .. })));
    assert!(matches!(rates.linearize(&[0.0; 3]), Err(Error::LengthMismatch { .. })));
    // A table shifted as a whole by its slides: closed, but for nothing.
    let mechanism = table(eight_slides(|_| None));
    let mut at = DVector::zeros(24);
    for k in 0..8 {
        at[16 + k] = if k % 2 == 1 {
            0.0
        } else if k < 4 {
            -1e-4
        } else {
            1e-4
        };
    }
    let system = MechanismSystem::new(&mechanism, DVector::zeros(24)).unwrap();
    let mut rates = DifferentialKinematics::new(&system, &[0, 1, 2]).unwrap();
    assert!(matches!(rates.linearize(at.as_slice()), Err(Error::NotLeastDisplacement { .. })));
}

/// The robot in closed form and link by link, for each set of virtual joints: velocities, accelerations, and both of the virtual joints.
#[test]
fn the_closed_forms_of_the_robot_are_those_of_the_mechanism() {
    let robot = Gpr::paper();
    let rods = [0.502, 0.499, 0.5];
    let (velocity, acceleration) = ([0.05, -0.02, 0.03], [0.4, 0.1, -0.3]);
    // Coordinates of the rods, and the places of X among the virtual joints of the mechanism.
    let commanded = [0, 4, 8];
    let cases: [(Mechanism, &dyn Virtualization, &[usize]); 3] = [
        (gpr(radial), &Radial, &[0, 1, 2]),
        (gpr(polar), &Polar, &[1, 3, 5, 0, 2, 4]),
        (gpr(planar), &Planar, &[0, 2, 4, 1, 3, 5]),
    ];
    for (mechanism, model, places) in cases {
        let mechanism = mechanism.with_characteristic_length(1e-3).unwrap();
        let at: Vec<_> = commanded.into_iter().zip(rods).collect();
        let mut case = Case::new(mechanism, &at);
        let system = MechanismSystem::new(&case.mechanism, case.at.clone()).unwrap();
        let mut solver = PositionSolver::new(&system, &commanded).unwrap();
        solver.solve(case.at.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
        let mut rates = DifferentialKinematics::new(&system, &commanded).unwrap();
        rates.linearize(case.at.as_slice()).unwrap();
        let (mut first, mut second) = (vec![0.0; case.at.len()], vec![0.0; case.at.len()]);
        rates.velocities(&velocity, &mut first).unwrap();
        rates.accelerations(&acceleration, &mut second).unwrap();
        let platform = FrameId::Link(4);

        let pose = robot.forward(rods, model, &SolveOptions::default()).unwrap();
        let found = robot.platform_derivatives(&pose, model).unwrap();
        let expected = rates.clone().jacobian(platform).unwrap();
        near(found.jacobian.matrix.as_slice(), expected.as_slice(), 1e-10);
        let (velocity, acceleration) = (Vector3::from(velocity), Vector3::from(acceleration));
        let moving = found.jacobian.velocity(&velocity);
        let expected = rates.frame_velocity(platform).unwrap();
        near(moving.angular.as_slice(), expected.angular.as_slice(), 1e-10);
        near(moving.linear.as_slice(), expected.linear.as_slice(), 1e-10);
        let moving = found.acceleration(&velocity, &acceleration);
        let expected = rates.frame_acceleration(platform).unwrap();
        near(moving.angular.as_slice(), expected.angular.as_slice(), 1e-9);
        near(moving.linear.as_slice(), expected.linear.as_slice(), 1e-9);
        let placed = |all: &[f64]| places.iter().map(|&m| all[12 + m]).collect::<Vec<_>>();
        near(&found.jacobian.virtual_velocities(&velocity), &placed(&first), 1e-10);
        near(&found.virtual_accelerations(&velocity, &acceleration), &placed(&second), 1e-9);
    }
}

/// The equations of the radial virtualization, as a user would write them.
struct Own;

impl Virtualization for Own {
    fn name(&self) -> &str {
        "own"
    }
    fn joints(&self) -> &[jointplay_core::virtualization::VirtualJoint] {
        Radial.joints()
    }
    fn nominal(&self, platform: &Platform, x: &mut [f64]) {
        Radial.nominal(platform, x);
    }
    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets {
        Radial.sockets(platform, x)
    }
    fn socket_velocities(&self, platform: &Platform, x: &[f64], velocities: &mut [Sockets]) {
        Radial.socket_velocities(platform, x, velocities);
    }
}

#[test]
fn derivatives_of_a_pose_are_refused_where_no_equation_gives_them() {
    let robot = Gpr::paper();
    let (rods, newton) =
        ([0.502, 0.499, 0.5], SolveOptions { solver: Solver::Newton, ..SolveOptions::default() });
    let by_newton = robot.forward(rods, &Polar, &newton).unwrap();
    assert_eq!(
        robot.platform_jacobian(&by_newton, &Polar),
        Err(Error::NewtonSolution { virtual_joints: 6 })
    );
    // Three virtual joints have one solution near nominal.
    let three = robot.forward(rods, &Radial, &newton).unwrap();
    robot.platform_jacobian(&three, &Radial).unwrap();
    // A pose of another robot, and one of another virtualization.
    let mut elsewhere = three;
    elsewhere.rods[0] += 1e-4;
    assert!(matches!(robot.platform_jacobian(&elsewhere, &Radial), Err(Error::NotClosed { .. })));
    elsewhere.rods[0] = f64::NAN;
    assert!(matches!(robot.platform_jacobian(&elsewhere, &Radial), Err(Error::NotClosed { .. })));
    assert!(matches!(robot.platform_jacobian(&three, &Polar), Err(Error::LengthMismatch { .. })));
    assert_eq!(robot.platform_jacobian(&three, &Own), Err(Error::OwnVirtualization));
    assert!(matches!(
        robot.rod_derivatives(Tilt { azimuth: 0.0, angle: 0.1 }, AxisHeight(0.5)),
        Err(Error::BeyondLimits(_))
    ));
}

/// A mechanism for each value of a dimension, and the value of interest.
struct Dimension<'a> {
    mechanism: &'a dyn Fn(f64) -> Mechanism,
    value: f64,
    step: f64,
    commanded: &'a [(usize, f64)],
}

impl Dimension<'_> {
    fn case(&self, value: f64) -> Case {
        Case::new((self.mechanism)(value), self.commanded)
    }

    fn changed(&self, case: &Case) -> ChangedDimension {
        let frames = case.mechanism.frames().to_vec();
        let mechanisms = [-2.0, -1.0, 1.0, 2.0].map(|steps| {
            let mechanism = (self.mechanism)(self.value + steps * self.step);
            mechanism.with_frames(frames.clone()).unwrap()
        });
        ChangedDimension { mechanisms, step: self.step }
    }

    /// Derivatives of the mechanism by its dimension against differences of the whole closed mechanism.
    #[track_caller]
    fn check(&self) {
        let case = self.case(self.value);
        let system = case.system();
        let mut rates = DifferentialKinematics::new(&system, &case.commanded).unwrap();
        rates.linearize(case.at.as_slice()).unwrap();
        let changed = self.changed(&case);
        let found = rates.dimension_derivatives(case.at.as_slice(), &changed).unwrap();
        let h = 20.0 * self.step;
        let [far_less, less, more, far_more] =
            [-2.0, -1.0, 1.0, 2.0].map(|steps| self.case(self.value + steps * h));
        let by = |to: &Case| case.between(&case.at, &to.at);
        let difference =
            ((by(&more) - by(&less)) * 8.0 - (by(&far_more) - by(&far_less))) / (12.0 * h);
        near(found.coordinates.as_slice(), difference.as_slice(), 1e-8);
        let here = case.poses(&case.at);
        let moved = |to: &Case| -> Vec<Vector6<f64>> {
            let poses = to.poses(&to.at);
            let by = poses.iter().zip(&here).map(|(there, here)| {
                let turn = rotation_vector(&(there.rotation * here.rotation.inverse()));
                stacked(&turn, &(there.translation.vector - here.translation.vector))
            });
            by.collect()
        };
        let [far_less, less, more, far_more] =
            [far_less, less, more, far_more].map(|to| moved(&to));
        assert_eq!(found.frames.len(), here.len());
        for (k, frame) in found.frames.iter().enumerate() {
            let expected = ((more[k] - less[k]) * 8.0 - (far_more[k] - far_less[k])) / (12.0 * h);
            near(stacked(&frame.angular, &frame.linear).as_slice(), expected.as_slice(), 1e-8);
        }
    }
}

#[test]
fn dimensions_of_loops_move_the_mechanism_as_another_assembly_does() {
    // The length of the coupler, and the inclination of the rocker.
    let four_bar = |length: f64, tilt: f64| {
        let mut joints = spatial_four_bar().joints().to_vec();
        joints[1] =
            joint("ball", JointKind::Spherical, [1, 2], [length, 0.03, 0.02], [0.0, 0.0, 1.0]);
        joints[3] =
            joint("rocker", JointKind::Revolute, [0, 3], [0.5, 0.0, 0.05], [0.0, tilt, 1.0]);
        Mechanism::new("RSUR", names(4), joints).unwrap()
    };
    let commanded = &[(0, 0.3)];
    let of_length = |length: f64| four_bar(length, 0.3);
    Dimension { mechanism: &of_length, value: 0.12, step: 3e-5, commanded }.check();
    let of_tilt = |tilt: f64| four_bar(0.12, tilt);
    Dimension { mechanism: &of_tilt, value: 0.3, step: 1e-4, commanded }.check();
    // Lead of a screw, which drives a slider: 0 is a value like any other.
    let screw = |lead: f64| {
        let up = [0.1, 0.0, 1.0];
        let joints = vec![
            joint("screw", JointKind::Helical { lead }, [0, 1], [0.0, 0.0, 0.1], up),
            joint("nut", JointKind::Prismatic, [0, 2], [0.2, 0.0, 0.1], up),
            joint("bearing", JointKind::Revolute, [1, 2], [0.0, 0.0, 0.1], up),
        ];
        Mechanism::new("screw", names(3), joints).unwrap()
    };
    for lead in [0.0, 0.002] {
        Dimension { mechanism: &screw, value: lead, step: 1e-5, commanded: &[(0, 0.7)] }.check();
    }
}

#[test]
fn dimensions_move_the_least_displacement_of_virtual_joints() {
    let commanded = &[(0, 0.012), (1, 0.004), (2, -0.014)];
    // Direction of the first slide, at which there is a displacement; stiffness of another; height of a corner.
    let turned = |angle: f64| {
        let mut joints = eight_slides(|_| None);
        let axis = [angle.cos(), angle.sin(), 0.0];
        joints[0] = slide("v0", 4, Carrier::Second, axis, None);
        table(joints)
    };
    Dimension { mechanism: &turned, value: 0.4, step: 1e-4, commanded }.check();
    let stiff = |stiffness: f64| {
        table(eight_slides(|k| Some(if k == 2 { stiffness } else { [1e6, 3e6, 2e5, 8e6][k % 4] })))
    };
    Dimension { mechanism: &stiff, value: 4e5, step: 40.0, commanded }.check();
    let higher = |height: f64| {
        let mechanism = table(eight_slides(|_| None));
        let mut joints = mechanism.joints().to_vec();
        joints[5].frames[1].translation.vector.z = height;
        Mechanism::new("table", names(6), joints)
            .unwrap()
            .with_virtual_joints(mechanism.virtual_joints().to_vec())
            .unwrap()
    };
    Dimension { mechanism: &higher, value: 0.4005, step: 1e-4, commanded }.check();
}

#[test]
fn dimensions_without_a_derivative_are_refused() {
    let case = Case::new(spatial_four_bar(), &[(0, 0.3)]);
    let system = case.system();
    let mut rates = DifferentialKinematics::new(&system, &[0]).unwrap();
    let shifted = |shift: f64| {
        let mut joints = case.mechanism.joints().to_vec();
        joints[1].frames[0].translation.vector.x += shift;
        Mechanism::new("RSUR", names(4), joints)
            .unwrap()
            .with_frames(case.mechanism.frames().to_vec())
            .unwrap()
    };
    let changed = |of: &dyn Fn(f64) -> f64| {
        let mechanisms = [-2e-5, -1e-5, 1e-5, 2e-5].map(|change| shifted(of(change)));
        ChangedDimension { mechanisms, step: 1e-5 }
    };
    let at = case.at.as_slice();
    assert_eq!(rates.dimension_derivatives(at, &changed(&|x| x)), Err(Error::NotLinearized));
    rates.linearize(at).unwrap();
    rates.dimension_derivatives(at, &changed(&|x| x)).unwrap();
    for rough in [&f64::abs as &dyn Fn(f64) -> f64, &|x: f64| if x > 0.0 { 1e-3 } else { 0.0 }] {
        let refused = rates.dimension_derivatives(at, &changed(rough));
        assert!(matches!(refused, Err(Error::NotSmooth { .. })), "{refused:?}");
    }
    let mut other = changed(&|x| x);
    other.mechanisms[0] = table(Vec::new());
    assert!(rates.dimension_derivatives(at, &other).is_err());

    // A parallelogram with a third crank moves for equal cranks only.
    let equal = Case::new(cranks(0.1), &[(0, 0.5)]);
    let system = equal.system();
    let mut rates = DifferentialKinematics::new(&system, &[0]).unwrap();
    rates.linearize(equal.at.as_slice()).unwrap();
    let frames = equal.mechanism.frames();
    let mechanisms = [-2e-5, -1e-5, 1e-5, 2e-5]
        .map(|change| cranks(0.1 + change).with_frames(frames.to_vec()).unwrap());
    let changed = ChangedDimension { mechanisms, step: 1e-5 };
    let refused = rates.dimension_derivatives(equal.at.as_slice(), &changed);
    assert!(matches!(refused, Err(Error::DimensionOpensLoops { .. })), "{refused:?}");
}

/// A parallelogram with a third crank, which moves for equal cranks only.
fn cranks(length: f64) -> Mechanism {
    let up = [0.0, 0.0, 1.0];
    let mut joints = Vec::new();
    for (k, x) in [0.0, 0.2, 0.5].into_iter().enumerate() {
        let y = if k == 2 { length } else { 0.1 };
        joints.push(joint(["A", "B", "C"][k], JointKind::Revolute, [0, k + 1], [x, 0.0, 0.0], up));
        let mut end = joint(["a", "b", "c"][k], JointKind::Revolute, [k + 1, 4], [x, y, 0.0], up);
        end.frames[1].translation.vector.y = 0.1;
        joints.push(end);
    }
    Mechanism::new("cranks", names(5), joints).unwrap()
}

/// The motions that the loops would open by cancel to round-off, which is no motion that they do not follow.
#[test]
fn equal_cranks_turn_alike_whatever_their_rates() {
    for angle in [-1.2, -0.7, 0.1, 0.5, 1.3] {
        let case = Case::new(cranks(0.1), &[(0, angle)]);
        let mut rates = DifferentialKinematics::new(&case.system(), &[0]).unwrap();
        rates.linearize(case.at.as_slice()).unwrap();
        let mut found = vec![0.0; case.at.len()];
        for (speed, acceleration) in
            [(1.0, 0.0), (-3.7, 0.0), (2.0, 1e-12), (1e-3, 5.0), (1e60, 0.0)]
        {
            // A crank turns against the base, and the coupler back against the crank.
            for (order, of_crank) in [speed, acceleration].into_iter().enumerate() {
                match order {
                    0 => rates.velocities(&[speed], &mut found).unwrap(),
                    _ => rates.accelerations(&[acceleration], &mut found).unwrap(),
                }
                for (k, rate) in found.iter().enumerate() {
                    let expected = if k % 2 == 0 { of_crank } else { -of_crank };
                    let size = speed.abs().max(speed * speed).max(acceleration);
                    assert!((rate - expected).abs() < 1e-11 * size, "{angle} {speed} {k}: {rate}");
                }
            }
        }
        let refused = rates.velocities(&[1e200], &mut found);
        assert!(matches!(refused, Err(Error::OutOfRange { .. })), "{refused:?}");
    }
}
