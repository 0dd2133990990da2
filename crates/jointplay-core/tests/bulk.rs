//! Many poses at a time equal those computed one by one.

use std::f64::consts::TAU;

use jointplay_core::Error;
use jointplay_core::bulk::{Column, Quantity, Status, StatusCounts};
use jointplay_core::gpr::{AxisHeight, Gpr, Limb, Limits, PlatformPose};
use jointplay_core::mobility::RANK_THRESHOLD;
use jointplay_core::nalgebra::Vector2;
use jointplay_core::sensitivity::sensitivity;
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{
    Metric, Platform, Polar, Sockets, SolveOptions, Solver, VirtualJoint, Virtualization, built_in,
};
use proptest::prelude::*;

const SOLVERS: [Solver; 3] = [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm];

/// A built-in virtualization under another name, without its kernel.
struct Own<'a>(&'a dyn Virtualization);

impl Virtualization for Own<'_> {
    fn name(&self) -> &str {
        "own"
    }
    fn joints(&self) -> &[VirtualJoint] {
        self.0.joints()
    }
    fn nominal(&self, platform: &Platform, x: &mut [f64]) {
        self.0.nominal(platform, x);
    }
    fn sockets(&self, platform: &Platform, x: &[f64]) -> Sockets {
        self.0.sockets(platform, x)
    }
    fn socket_velocities(&self, platform: &Platform, x: &[f64], velocities: &mut [Sockets]) {
        self.0.socket_velocities(platform, x, velocities);
    }
    fn closed_form(&self, platform: &Platform, sides: &[f64; 3], x: &mut [f64]) -> bool {
        self.0.closed_form(platform, sides, x)
    }
}

fn quantities(joints: usize) -> Vec<Quantity> {
    let three = [
        Quantity::Side,
        Quantity::Origin,
        Quantity::Normal,
        Quantity::Sensitivity,
        Quantity::BallDisplacement,
    ];
    let mut all: Vec<_> = three.iter().flat_map(|of| (0..3).map(of)).collect();
    all.extend((0..joints).map(Quantity::VirtualJoint));
    all.extend((0..joints).map(Quantity::VirtualDisplacement));
    all.extend((0..9).map(|k| Quantity::Rotation(k / 3, k % 3)));
    all.extend([Quantity::Azimuth, Quantity::TiltAngle, Quantity::Torsion, Quantity::AxisHeight]);
    all.extend([Quantity::Displacement, Quantity::Residual, Quantity::Iterations]);
    all
}

/// The columns of all quantities, and the statuses.
fn forward_many(
    gpr: &Gpr,
    rods: &[[f64; 3]],
    model: &dyn Virtualization,
    options: &SolveOptions,
) -> (Vec<(Quantity, Vec<f64>)>, Vec<Status>) {
    let flat = rods.as_flattened();
    let column = |k: usize| Column::strided(flat.get(k..).unwrap_or(&[]), 3, rods.len()).unwrap();
    let mut status = vec![Status::Solved; rods.len()];
    let mut columns: Vec<_> = quantities(model.joints().len())
        .into_iter()
        .map(|quantity| (quantity, vec![1e99; rods.len()]))
        .collect();
    let mut wanted: Vec<_> = columns.iter_mut().map(|(q, values)| (*q, &mut values[..])).collect();
    let tally = gpr
        .forward_many([column(0), column(1), column(2)], model, options, &mut status, &mut wanted)
        .unwrap();
    assert_eq!(tally, StatusCounts::of(&status));
    (columns, status)
}

/// Result of the scalar kernel, and the largest difference allowed to the bulk kernel.
fn expected(
    gpr: &Gpr,
    pose: &PlatformPose,
    model: &dyn Virtualization,
    quantity: Quantity,
) -> (f64, f64) {
    // Sides far longer than the platform bring their own round-off.
    let size = pose.sides.into_iter().fold(gpr.platform().mean_radius(), f64::max);
    let rho = pose.solution.characteristic_length;
    let length = 1e-12 * size;
    let angle = 1e-12;
    match quantity {
        Quantity::Side(side) => (pose.sides[side], length),
        Quantity::VirtualJoint(joint) => (pose.solution.virtual_joints[joint], length.max(angle)),
        Quantity::VirtualDisplacement(joint) => {
            let mut nominal = vec![0.0; model.joints().len()];
            model.nominal(gpr.platform(), &mut nominal);
            (pose.solution.virtual_joints[joint] - nominal[joint], length.max(angle))
        }
        Quantity::Origin(axis) => (pose.base_from_platform.translation.vector[axis], length),
        Quantity::Normal(axis) => (pose.normal()[axis], angle),
        Quantity::Rotation(row, column) => {
            let unit = nalgebra::Vector3::ith(column, 1.0);
            ((pose.base_from_platform * unit)[row], angle)
        }
        // The smaller a tilt, the less accurate its azimuth.
        Quantity::Azimuth => (pose.tilt().azimuth, angle.max(1e-15 / pose.tilt().angle)),
        Quantity::TiltAngle => (pose.tilt().angle, angle),
        Quantity::Torsion => (pose.torsion(), angle),
        Quantity::AxisHeight => (pose.axis_height().0, length),
        Quantity::Displacement => {
            let mut nominal = vec![0.0; model.joints().len()];
            model.nominal(gpr.platform(), &mut nominal);
            let squares = pose.solution.virtual_joints.iter().zip(&nominal).zip(model.joints());
            let squares = squares.map(|((x, n), j)| ((x - n) * j.motion.weight(rho)).powi(2));
            (squares.sum::<f64>().sqrt(), length)
        }
        Quantity::BallDisplacement(ball) => {
            // From where the ball is, without the virtual joints.
            let nominal = gpr.platform().sockets()[ball].push(0.0);
            let placed = pose.base_from_platform * nalgebra::Point3::from(nominal);
            let away = placed.coords - gpr.ball_centers(&pose.rods)[ball];
            (away.norm(), length + 2.0 * pose.solution.residual)
        }
        Quantity::Sensitivity(index) => {
            let system = gpr.system(model);
            let found =
                sensitivity(&system, &system.configuration(pose), rho, RANK_THRESHOLD).unwrap();
            (found.singular_values()[index], 1e-12 * found.singular_values()[0])
        }
        Quantity::Residual => (pose.solution.residual, 2e-13 * size * 3.0_f64.sqrt()),
        Quantity::Iterations => (pose.solution.iterations as f64, 0.0),
    }
}

/// The pose that the scalar kernel finds, with the number of iterations that the bulk kernel took.
///
/// A residual within round-off of the threshold ends one kernel and not the other; one more step then moves angles on short arms by far more than round-off.
fn pose_after(
    gpr: &Gpr,
    rods: [f64; 3],
    model: &dyn Virtualization,
    options: &SolveOptions,
    iterations: f64,
) -> Result<PlatformPose, Error> {
    let pose = gpr.forward(rods, model, options)?;
    let share = match (pose.solution.iterations as f64).total_cmp(&iterations) {
        std::cmp::Ordering::Equal => return Ok(pose),
        std::cmp::Ordering::Less => 0.99,
        std::cmp::Ordering::Greater => 1.01,
    };
    let relative_threshold = share * options.relative_threshold;
    gpr.forward(rods, model, &SolveOptions { relative_threshold, ..*options })
}

fn same(found: f64, expected: f64, within: f64) -> bool {
    (found - expected).abs() <= within
}

#[track_caller]
fn check(gpr: &Gpr, rods: &[[f64; 3]], model: &dyn Virtualization, options: &SolveOptions) {
    let (columns, status) = forward_many(gpr, rods, model, options);
    for (i, rods) in rods.iter().enumerate() {
        let iterations = columns[columns.len() - 1].1[i];
        match pose_after(gpr, *rods, model, options, iterations) {
            Ok(pose) => {
                assert_eq!(status[i], Status::Solved);
                for (quantity, column) in &columns {
                    let (expected, within) = expected(gpr, &pose, model, *quantity);
                    let turn = if *quantity == Quantity::Azimuth { TAU } else { 0.0 };
                    assert!(
                        [0.0, turn, -turn].iter().any(|t| same(column[i] + t, expected, within)),
                        "{} {:?} {quantity:?}: {:e} for {expected:e} within {within:e}, {pose:?}",
                        model.name(),
                        options.solver,
                        column[i],
                    );
                }
            }
            Err(error) => {
                let reason = match error {
                    Error::NotFinite { .. } => Status::NotFinite,
                    Error::TooLong { .. } => Status::BeyondLimits,
                    Error::NotConverged(_) => Status::NotConverged,
                    Error::DependentSides { .. } => Status::DependentSides,
                    Error::TurnedOver { .. } => Status::TurnedOver,
                    other => panic!("{other}"),
                };
                assert_eq!(status[i], reason, "{} {options:?} {rods:?}", model.name());
                assert!(columns.iter().all(|(_, column)| column[i].is_nan()));
            }
        }
    }
}

fn robots() -> impl Strategy<Value = Gpr> {
    let limb = || (0.05..0.15_f64, -0.2..0.2_f64, -1e-3..1e-3_f64, -1e-3..1e-3_f64);
    let even = (0.05..0.15_f64, -3.0..3.0_f64).prop_map(|(radius, turn)| {
        [0.0, 1.0, 2.0].map(|k| Limb::under_socket(radius, turn + k * TAU / 3.0))
    });
    let uneven = ([limb(), limb(), limb()], proptest::bool::ANY).prop_map(|(limbs, mirrored)| {
        let sense = if mirrored { -1.0 } else { 1.0 };
        [0, 1, 2].map(|k| {
            let (radius, angle, x, y) = limbs[k];
            let mut limb = Limb::under_socket(radius, sense * (angle + k as f64 * TAU / 3.0));
            limb.base_point += Vector2::new(x, y);
            limb
        })
    });
    prop_oneof![even, uneven].prop_map(|limbs| {
        let limits = Limits { rod_min: 0.2, rod_max: 0.8, tilt_max: 0.1 };
        Gpr::new(limbs, limits, 0.5).unwrap().without_limit_checks()
    })
}

/// Tilts of every size, level among them.
fn tilts() -> impl Strategy<Value = Vec<Tilt>> {
    let tilt_angle = prop_oneof![Just(0.0), -0.04..0.04_f64, -0.3..0.3_f64, -1e-6..1e-6_f64];
    let tilt = (-7.0..7.0_f64, tilt_angle)
        .prop_map(|(azimuth, tilt_angle)| Tilt { azimuth, angle: tilt_angle });
    proptest::collection::vec(tilt, 1..37)
}

fn metrics() -> impl Strategy<Value = Metric> {
    prop_oneof![
        Just(Metric::Paper),
        Just(Metric::PlatformRadius),
        (1e-4..1.0).prop_map(Metric::Length)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn forward_agrees_with_one_pose_at_a_time(gpr in robots(), tilts in tilts(), metric in metrics()) {
        let rods: Vec<_> = tilts.iter().map(|t| gpr.inverse(*t, AxisHeight(0.5)).unwrap()).collect();
        for model in built_in() {
            for solver in SOLVERS {
                check(&gpr, &rods, model, &SolveOptions { solver, metric, ..SolveOptions::default() });
            }
        }
    }

    #[test]
    fn inverse_agrees_with_one_pose_at_a_time(gpr in robots(), tilts in tilts(), height in 0.1..1.0_f64) {
        let azimuth: Vec<_> = tilts.iter().map(|tilt| tilt.azimuth * 30.0).collect();
        let mut tilt_angle: Vec<_> = tilts.iter().map(|tilt| tilt.angle * 6.0).collect();
        let spoilt = tilts.len() / 2;
        tilt_angle[spoilt] = f64::NAN;
        let mut rods = [vec![0.0; azimuth.len()], vec![0.0; azimuth.len()], vec![0.0; azimuth.len()]];
        let mut status = vec![Status::Solved; azimuth.len()];
        let [q_1, q_2, q_3] = &mut rods;
        let height_column = Column::constant(&height, azimuth.len());
        gpr.inverse_many(azimuth[..].into(), tilt_angle[..].into(), height_column, &mut status, [q_1, q_2, q_3]).unwrap();
        for i in 0..azimuth.len() {
            let found = [0, 1, 2].map(|k| rods[k][i]);
            match gpr.inverse(Tilt { azimuth: azimuth[i], angle: tilt_angle[i] }, AxisHeight(height)) {
                Ok(expected) => {
                    prop_assert_eq!(status[i], Status::Solved);
                    for k in 0..3 {
                        // A steep plane magnifies the last bit of the tilt angle.
                        let within = 1e-12 * (1.0 + expected[k].abs());
                        prop_assert!(same(found[k], expected[k], within), "{} {}", found[k], expected[k]);
                    }
                }
                Err(Error::TiltTooLarge { .. }) => prop_assert_eq!(status[i], Status::TiltTooLarge),
                Err(_) => prop_assert_eq!(status[i], Status::NotFinite),
            }
            prop_assert_eq!(status[i] == Status::Solved, found.iter().all(|q| q.is_finite()));
        }
    }

    #[test]
    fn a_pose_does_not_depend_on_its_neighbours(gpr in robots(), tilts in tilts()) {
        let mut rods: Vec<_> = tilts.iter().map(|t| gpr.inverse(*t, AxisHeight(0.5)).unwrap()).collect();
        rods.push([0.5, f64::INFINITY, 0.5]);
        for model in built_in() {
            for solver in SOLVERS {
                let options = SolveOptions { solver, ..SolveOptions::default() };
                let (together, _) = forward_many(&gpr, &rods, model, &options);
                for (i, one) in rods.iter().enumerate() {
                    let (alone, _) = forward_many(&gpr, &[*one], model, &options);
                    for ((quantity, alone), (_, together)) in alone.iter().zip(&together) {
                        prop_assert_eq!(alone[0].to_bits(), together[i].to_bits(), "{:?}", quantity);
                    }
                }
            }
        }
    }
}

#[test]
fn rods_that_make_no_pose() {
    let gpr = Gpr::paper().without_limit_checks();
    let rods = [
        [0.5, 0.5, 0.5],
        [f64::NAN, 0.5, 0.5],
        [0.5, f64::NAN, 0.5],
        [0.5, 0.5, f64::NAN],
        [f64::NAN; 3],
        [0.5, 0.9, 0.1],
        [0.5, f64::INFINITY, 0.5],
        [1e200, 0.5, -1e200],
        [0.5, 0.501, 0.502],
        [0.0, 3.0, -7.0],
        [0.5, 0.500001, 0.5],
        [0.4, 0.5, 0.6],
        [0.5, 0.5, 0.5000000000001],
    ];
    for model in built_in() {
        for solver in SOLVERS {
            check(&gpr, &rods, model, &SolveOptions { solver, ..SolveOptions::default() });
            let hasty = SolveOptions { solver, max_iterations: 1, ..SolveOptions::default() };
            check(&gpr, &rods, model, &hasty);
            let none = SolveOptions { solver, max_iterations: 0, ..SolveOptions::default() };
            check(&gpr, &rods, model, &none);
        }
    }
}

/// A pose whose sensitivity is made of a 12×3 matrix on which faer 0.24 does not converge.
#[test]
fn a_matrix_on_which_the_iteration_gets_stuck() {
    let (radius, angle) = (0.084_934_567_122_908_13, 0.015_040_788_630_096_358);
    let limbs = [0.0, 1.0, 2.0].map(|k| Limb::under_socket(radius, angle + k * TAU / 3.0));
    let limits = Limits { rod_min: 0.2, rod_max: 0.8, tilt_max: 0.1 };
    let gpr = Gpr::new(limbs, limits, 0.5).unwrap().without_limit_checks();
    let tilt = Tilt { azimuth: 1.678_717_274_536_944_5, angle: 4.631_782_060_479_133e-7 };
    let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
    for model in built_in() {
        check(&gpr, &[rods], model, &SolveOptions::default());
    }
}

/// Weights of an angle that make the sides nearly dependent, and exactly so.
#[test]
fn metrics_out_of_proportion() {
    let gpr = Gpr::paper().without_limit_checks();
    let rods = [[0.5, 0.501, 0.502], [0.5; 3], [0.498, 0.5, 0.5]];
    for metric in [1e-12, 1e-7, 1e-5, 10.0, 1e6, 1e12] {
        for model in built_in() {
            for solver in SOLVERS {
                let metric = Metric::Length(metric);
                let options = SolveOptions { solver, metric, ..SolveOptions::default() };
                let (_, status) = forward_many(&gpr, &rods, model, &options);
                for (rods, status) in rods.iter().zip(status) {
                    let one = gpr.forward(*rods, model, &options);
                    assert_eq!(one.is_ok(), status == Status::Solved, "{metric:?}");
                }
            }
        }
    }
}

#[test]
fn virtualizations_without_a_kernel() {
    let gpr = Gpr::paper().without_limit_checks();
    let rods = [[0.5, 0.501, 0.502], [f64::NAN; 3], [0.498, 0.5, 0.5]];
    for model in built_in() {
        let options = SolveOptions::default();
        check(&gpr, &rods, &Own(model), &options);
    }
}

#[test]
fn no_poses_at_all() {
    let (columns, status) =
        forward_many(&Gpr::paper().without_limit_checks(), &[], &Polar, &SolveOptions::default());
    assert!(status.is_empty() && columns.iter().all(|(_, column)| column.is_empty()));
}

#[test]
fn what_is_asked_for_wrongly() {
    let gpr = Gpr::paper().without_limit_checks();
    let (q, rods) = ([0.5; 4], 0.5);
    let given =
        |len| [Column::from(&q[..]), Column::constant(&rods, len), Column::constant(&rods, 4)];
    let options = SolveOptions::default();
    let message = |given, poses: usize, quantity, len: usize, options: &SolveOptions| {
        let (mut status, mut column) = (vec![Status::Solved; poses], vec![7.0; len]);
        let wanted = &mut [(quantity, &mut column[..])];
        let found = gpr.forward_many(given, &Polar, options, &mut status, wanted);
        assert_eq!(column, vec![7.0; len], "nothing is written");
        found.unwrap_err().to_string()
    };
    assert_eq!(
        message(given(3), 4, Quantity::TiltAngle, 4, &options),
        "a column of rods has 3 entries, but 4 are needed"
    );
    assert_eq!(
        message(given(4), 4, Quantity::TiltAngle, 5, &options),
        "a column of results has 5 entries, but 4 are needed"
    );
    assert_eq!(
        message(given(4), 4, Quantity::VirtualJoint(6), 4, &options),
        "there is no virtual joint 6: they are counted from 0, and there are 6"
    );
    assert_eq!(
        message(given(4), 4, Quantity::Side(3), 4, &options),
        "there is no side 3: they are counted from 0, and there are 3"
    );
    let metric = Metric::Length(-1.0);
    let invalid = SolveOptions { metric, ..options };
    assert!(
        message(given(4), 4, Quantity::TiltAngle, 4, &invalid).contains("characteristic length")
    );
}
