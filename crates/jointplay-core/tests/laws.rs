//! Laws of every robot, of any dimensions.

use jointplay_core::constraint::{Configuration, System};
use jointplay_core::gpr::{
    AxisHeight, CenterHeight, Gpr, GprSystem, Limb, Limits, PlatformPose, ball_sides,
};
use jointplay_core::mobility::{
    InstantaneousMobility, RANK_THRESHOLD, augmented_mobility, finite_mobility,
    instantaneous_mobility,
};
use jointplay_core::sensitivity::sensitivity;
use jointplay_core::spatial::{Tilt, rotation_vector};
use jointplay_core::virtualization::{
    Metric, Planar, Polar, Radial, Sockets, SolveOptions, Solver, VirtualJointKind, Virtualization,
    built_in,
};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation2, Vector2, Vector3};
use proptest::prelude::*;

const SOLVERS: [Solver; 3] = [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm];

/// A robot near the usual shape, as numbers that a law can change.
#[derive(Debug, Clone, Copy)]
struct Robot {
    limbs: [Limb; 3],
    working_height: f64,
}

impl Robot {
    fn gpr(&self) -> Gpr {
        let limits = Limits {
            rod_min: 0.5 * self.working_height,
            rod_max: 1.5 * self.working_height,
            tilt_max: 0.1,
        };
        Gpr::new(self.limbs, limits, self.working_height).unwrap().without_limit_checks()
    }

    /// The same robot, `factor` times as large.
    fn scaled(&self, factor: f64) -> Self {
        let limbs = self.limbs.map(|limb| Limb {
            base_point: limb.base_point * factor,
            socket_radius: limb.socket_radius * factor,
            ..limb
        });
        Self { limbs, working_height: self.working_height * factor }
    }

    /// The same robot turned about the vertical.
    fn turned(&self, angle: f64) -> Self {
        let turn = Rotation2::new(angle);
        let limbs = self.limbs.map(|limb| Limb {
            base_point: turn * limb.base_point,
            socket_angle: limb.socket_angle + angle,
            ..limb
        });
        Self { limbs, ..*self }
    }

    /// The same robot with its limbs numbered from the next one on.
    fn renumbered(&self) -> Self {
        Self { limbs: [self.limbs[1], self.limbs[2], self.limbs[0]], ..*self }
    }
}

/// One pose to be tested: robot, tilt, height, model, solver, metric.
#[derive(Debug, Clone, Copy)]
struct Case {
    robot: Robot,
    tilt: Tilt,
    height: f64,
    model: usize,
    options: SolveOptions,
}

impl Case {
    fn model(&self) -> &'static dyn Virtualization {
        built_in()[self.model]
    }

    fn pose(&self, gpr: &Gpr) -> PlatformPose {
        let rods = gpr.inverse(self.tilt, AxisHeight(self.height)).unwrap();
        gpr.forward(rods, self.model(), &self.options).unwrap()
    }
}

/// No file is written for failing cases: they are printed, and become named cases.
fn runs(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

fn robots() -> impl Strategy<Value = Robot> {
    let each = || prop::array::uniform3(-1.0..1.0);
    (0.05..0.2, each(), each(), each(), each(), any::<bool>(), -3.0..3.0).prop_map(
        |(radius, radii, angles, x, y, clockwise, turn): (f64, [f64; 3], _, _, _, _, f64)| {
            let limbs = [0, 1, 2].map(|k: usize| {
                let third = [0.0_f64, 120.0, 240.0][k] + 10.0 * angles[k];
                let angle = third.to_radians() + turn;
                let socket_angle = if clockwise { -angle } else { angle };
                let limb = Limb::under_socket(radius * (1.0 + 0.1 * radii[k]), socket_angle);
                let offset = Vector2::new(x[k], y[k]) * (0.03 * radius);
                Limb { base_point: limb.base_point + offset, ..limb }
            });
            Robot { limbs, working_height: 0.5 }
        },
    )
}

/// Sockets 120° apart on one radius, each over its rod.
fn symmetric_robots() -> impl Strategy<Value = Robot> {
    (0.05..0.2, -3.0..3.0).prop_map(|(radius, turn): (f64, f64)| {
        let limbs = [0.0_f64, 120.0, 240.0]
            .map(|angle| Limb::under_socket(radius, angle.to_radians() + turn));
        Robot { limbs, working_height: 0.5 }
    })
}

fn tilts() -> impl Strategy<Value = Tilt> {
    (-7.0..7.0, -5.0..5.0_f64)
        .prop_map(|(azimuth, tilt_angle)| Tilt { azimuth, angle: tilt_angle.to_radians() })
}

fn options() -> impl Strategy<Value = SolveOptions> {
    let metrics = prop_oneof![
        Just(Metric::Paper),
        Just(Metric::PlatformRadius),
        (-4.0..1.0_f64).prop_map(|exponent| Metric::Length(10_f64.powf(exponent))),
    ];
    (prop::sample::select(&SOLVERS[..]), metrics).prop_map(|(solver, metric)| SolveOptions {
        solver,
        metric,
        ..SolveOptions::default()
    })
}

fn cases_of(robots: impl Strategy<Value = Robot>) -> impl Strategy<Value = Case> {
    (robots, tilts(), 0.3..0.7, 0..4_usize, options()).prop_map(
        |(robot, tilt, height, model, mut options)| {
            // Where angles cost less than offsets are long, the offset model has many least displacements, or none that can be found.
            if built_in()[model].name() == "offset" {
                options.metric = Metric::PlatformRadius;
            }
            Case { robot, tilt, height, model, options }
        },
    )
}

fn cases() -> impl Strategy<Value = Case> {
    cases_of(robots())
}

#[track_caller]
fn near(what: &str, found: f64, expected: f64, tolerance: f64) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{what} is {found:e}, off by {off:e}, more than {tolerance:e}");
}

#[track_caller]
fn all_near(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (found, expected) in found.iter().zip(expected) {
        near(what, *found, *expected, tolerance);
    }
}

/// Weighted norm of a displacement from the nominal X, in the metric of the solution.
fn displacement(gpr: &Gpr, model: &dyn Virtualization, pose: &PlatformPose) -> f64 {
    from_nominal(gpr, model, pose).norm()
}

/// X − X_0, angles times ρ.
fn from_nominal(gpr: &Gpr, model: &dyn Virtualization, pose: &PlatformPose) -> DVector<f64> {
    let x = &pose.solution.virtual_joints;
    let mut nominal = *x;
    model.nominal(gpr.platform(), &mut nominal);
    DVector::from_fn(x.len(), |m, _| {
        let weight = model.joints()[m].motion.weight(pose.solution.characteristic_length);
        (x[m] - nominal[m]) * weight
    })
}

/// Derivative of a vector function along one unknown, by central difference.
fn difference(f: impl Fn(f64) -> DVector<f64>, step: f64) -> DVector<f64> {
    (f(step) - f(-step)) / (2.0 * step)
}

fn first_order<V: Virtualization + ?Sized>(
    system: &GprSystem<'_, V>,
    pose: &PlatformPose,
) -> InstantaneousMobility {
    instantaneous_mobility(system, &system.configuration(pose), RANK_THRESHOLD).unwrap()
}

proptest! {
    #![proptest_config(runs(512))]

    #[test]
    fn forward_undoes_inverse_and_inverse_forward(case in cases()) {
        let gpr = case.robot.gpr();
        let pose = case.pose(&gpr);
        prop_assert!((pose.normal() - case.tilt.normal()).norm() < 1e-12);
        near("axis height", pose.axis_height().0, case.height, 1e-12);
        let rods = gpr.inverse(pose.tilt(), pose.axis_height()).unwrap();
        all_near("rods", &rods, &pose.rods, 1e-12);
    }

    #[test]
    fn sockets_fall_on_the_balls(case in cases()) {
        let gpr = case.robot.gpr();
        let pose = case.pose(&gpr);
        let sockets = case.model().sockets(gpr.platform(), &pose.solution.virtual_joints);
        let balls = gpr.ball_centers(&pose.rods);
        // Squares of sides are fused in a kernel: the last bit differs.
        all_near("sides", &pose.sides, &ball_sides(&balls), 1e-15);
        all_near("virtual sides", &ball_sides(&sockets.map(|p| p.push(0.0))), &pose.sides, 1e-12);
        let to_base = pose.base_from_platform;
        for k in 0..3 {
            let ball = to_base.rotation * sockets[k].push(0.0) + to_base.translation.vector;
            prop_assert!((ball - balls[k]).norm() < 1e-12, "ball {k}: {:e}", (ball - balls[k]).norm());
        }
        let rotation = to_base.rotation.matrix();
        prop_assert!((rotation.transpose() * rotation - Matrix3::identity()).amax() < 1e-14);
        near("determinant", rotation.determinant(), 1.0, 1e-14);
        prop_assert!(pose.solution.residual <= 1e-13 * pose.sides.iter().fold(0.0, |a: f64, b| a.max(*b)));
    }

    #[test]
    fn the_centre_reaches_the_height_asked_for(case in cases()) {
        let gpr = case.robot.gpr();
        let height = CenterHeight(case.height);
        let pose = gpr.inverse_for_center(case.tilt, height, case.model(), &case.options).unwrap();
        near("centre height", pose.base_from_platform.translation.z, case.height, 1e-13);
        prop_assert!((pose.normal() - case.tilt.normal()).norm() < 1e-12);
    }

    #[test]
    fn the_same_input_gives_the_same_bits(case in cases()) {
        let gpr = case.robot.gpr();
        let (one, other) = (case.pose(&gpr), case.pose(&case.robot.gpr()));
        prop_assert_eq!(format!("{one:?}"), format!("{other:?}"));
        let last = one.solution.virtual_joints.iter().zip(other.solution.virtual_joints.iter());
        for (a, b) in last {
            prop_assert_eq!(a.to_bits(), b.to_bits());
        }
    }

    #[test]
    fn jacobians_are_central_differences(case in cases()) {
        let gpr = case.robot.gpr();
        let (model, system) = (case.model(), gpr.system(case.model()));
        let at = system.configuration(&case.pose(&gpr));
        let residual = |coordinate: Option<usize>, joint: Option<usize>, step: f64| {
            let mut moved = at.clone();
            if let Some(i) = coordinate { moved.coordinates[i] += step; }
            if let Some(m) = joint { moved.virtual_joints[m] += step; }
            system.residual(&moved)
        };
        let by_coordinates = system.constraint_jacobian(&at);
        for i in 0..12 {
            let found = difference(|step| residual(Some(i), None, step), 1e-4);
            prop_assert!((found - by_coordinates.column(i)).amax() < 1e-10);
        }
        let by_joints = system.virtual_jacobian(&at);
        for (m, joint) in model.joints().iter().enumerate() {
            let step = if joint.motion == VirtualJointKind::Linear { 1e-5 } else { 1e-4 };
            let found = difference(|step| residual(None, Some(m), step), step);
            prop_assert!((found - by_joints.column(m)).amax() < 1e-8);
        }
    }

    #[test]
    fn second_derivatives_are_differences_of_first(
        case in cases(),
        direction in prop::collection::vec(-1.0..1.0, 12),
    ) {
        let gpr = case.robot.gpr();
        let system = gpr.system(case.model());
        let at = system.configuration(&case.pose(&gpr));
        let direction = DVector::from_vec(direction);
        let slope = |step: f64| {
            let mut moved = at.clone();
            moved.coordinates += &direction * step;
            system.constraint_jacobian(&moved) * &direction
        };
        let found = difference(slope, 1e-3);
        prop_assert!((found - system.second_derivative(&at, &direction)).amax() < 1e-10);
    }

    #[test]
    fn socket_velocities_are_central_differences(case in cases()) {
        let (gpr, model) = (case.robot.gpr(), case.model());
        let x = case.pose(&gpr).solution.virtual_joints;
        let mut velocities = vec![Sockets::default(); x.len()];
        model.socket_velocities(gpr.platform(), &x, &mut velocities);
        for m in 0..x.len() {
            for (k, velocity) in velocities[m].iter().enumerate() {
                let socket = |step: f64| {
                    let mut moved = x;
                    moved[m] += step;
                    let socket = model.sockets(gpr.platform(), &moved)[k];
                    DVector::from_column_slice(socket.as_slice())
                };
                let found = difference(socket, 1e-5);
                prop_assert!((found - velocity).amax() < 1e-9);
            }
        }
    }

    #[test]
    fn least_norm_is_least(case in cases()) {
        let (gpr, model) = (case.robot.gpr(), case.model());
        let with = |solver| case_with(&case, solver).pose(&gpr);
        let (newton, least) = (with(Solver::Newton), with(Solver::LeastNorm));
        let (of_newton, of_least) =
            (displacement(&gpr, model, &newton), displacement(&gpr, model, &least));
        prop_assert!(of_least <= of_newton * (1.0 + 1e-9) + 1e-12, "{of_least:e} {of_newton:e}");

        // Least: the displacement is a combination of the gradients of the sides, nothing of it in their null space.
        let system = gpr.system(model);
        let jacobian = system.virtual_jacobian(&system.configuration(&least));
        let gradients = DMatrix::from_fn(3, model.joints().len(), |i, m| {
            jacobian[(9 + i, m)] / model.joints()[m].motion.weight(least.solution.characteristic_length)
        });
        let moved = from_nominal(&gpr, model, &least);
        let rows = jointplay_core::linalg::svd(&gradients).unwrap();
        let along = rows.null_space(3).transpose() * &moved;
        prop_assert!(along.amax() <= 1e-11, "{:e} of {:e}", along.amax(), moved.norm());

        let closed = with(Solver::ClosedForm);
        if closed.solution.solver == Solver::ClosedForm {
            let joints = &closed.solution.virtual_joints;
            all_near("closed form", joints, &least.solution.virtual_joints, 1e-12);
        }
    }

    #[test]
    fn closed_forms_are_the_least_norm(case in cases_of(symmetric_robots())) {
        let gpr = case.robot.gpr();
        for (model, name) in [(0, "radial"), (3, "planar")] {
            let case = Case { model, ..case };
            prop_assert_eq!(case.model().name(), name);
            let closed = case_with(&case, Solver::ClosedForm).pose(&gpr);
            prop_assert_eq!(closed.solution.solver, Solver::ClosedForm);
            let least = case_with(&case, Solver::LeastNorm).pose(&gpr);
            let joints = &closed.solution.virtual_joints;
            all_near(name, joints, &least.solution.virtual_joints, 1e-13);
        }
    }

    #[test]
    fn raising_all_rods_raises_the_platform_only(case in cases(), rise in -0.2..0.2_f64) {
        let gpr = case.robot.gpr();
        let low = case.pose(&gpr);
        let high = gpr.forward(low.rods.map(|q| q + rise), case.model(), &case.options).unwrap();
        all_near("sides", &high.sides, &low.sides, 1e-15);
        let (up, down) = (high.base_from_platform, low.base_from_platform);
        let moved = up.translation.vector - down.translation.vector - Vector3::z() * rise;
        // Of the offset angles only the products with the offsets are felt.
        prop_assert!(moved.norm() < 1e-12);
        prop_assert!((up.rotation.matrix() - down.rotation.matrix()).amax() < 1e-11);
    }

    #[test]
    fn renumbering_limbs_renumbers_the_answer(case in cases()) {
        let gpr = case.robot.gpr();
        let renumbered = Case { robot: case.robot.renumbered(), ..case };
        let (one, other) = (case.pose(&gpr), renumbered.pose(&renumbered.robot.gpr()));
        let next = |values: &[f64]| [values[1], values[2], values[0]];
        all_near("rods", &other.rods, &next(&one.rods), 0.0);
        all_near("sides", &other.sides, &next(&one.sides), 0.0);
        let (x, renumbered) = (&one.solution.virtual_joints, &other.solution.virtual_joints);
        for kind in 0..x.len() / 3 {
            let of = 3 * kind..3 * kind + 3;
            all_near("X", &renumbered[of.clone()], &next(&x[of]), angle_tolerance(&case, kind));
        }
        let off = one.base_from_platform.to_homogeneous() - other.base_from_platform.to_homogeneous();
        prop_assert!(off.amax() < 1e-11, "{off}");
    }

    #[test]
    fn turning_the_robot_turns_the_answer(case in cases(), angle in -3.0..3.0) {
        let gpr = case.robot.gpr();
        let tilt = Tilt { azimuth: case.tilt.azimuth + angle, ..case.tilt };
        let turned = Case { robot: case.robot.turned(angle), tilt, ..case };
        let (one, other) = (case.pose(&gpr), turned.pose(&turned.robot.gpr()));
        all_near("rods", &other.rods, &one.rods, 1e-13);
        let turn = Rotation2::new(angle);
        prop_assert!((turn * one.center_shift() - other.center_shift()).norm() < 1e-12);
        near("torsion", other.torsion(), one.torsion(), 1e-11);
        let (x, turned_x) = (&one.solution.virtual_joints, &other.solution.virtual_joints);
        if case.model().name() == "planar" {
            for k in 0..3 {
                let (before, after) =
                    (Vector2::new(x[k], x[3 + k]), Vector2::new(turned_x[k], turned_x[3 + k]));
                prop_assert!((turn * before - after).norm() < 1e-12);
            }
        } else {
            for kind in 0..x.len() / 3 {
                let of = 3 * kind..3 * kind + 3;
                all_near("X", &turned_x[of.clone()], &x[of], angle_tolerance(&case, kind));
            }
        }
    }

    #[test]
    fn size_changes_lengths_only(case in cases(), exponent in -3.0..3.0_f64) {
        let factor = 10_f64.powf(exponent);
        let gpr = case.robot.gpr();
        let length = case.options.metric.characteristic_length(gpr.platform()).unwrap();
        let options = SolveOptions { metric: Metric::Length(length * factor), ..case.options };
        let robot = case.robot.scaled(factor);
        let scaled = Case { robot, height: case.height * factor, options, ..case };
        let scaled_gpr = robot.gpr();
        let (one, other) = (case.pose(&gpr), scaled.pose(&scaled_gpr));
        for k in 0..3 {
            near("rod", other.rods[k] / factor, one.rods[k], 1e-14);
            near("side", other.sides[k] / factor, one.sides[k], 1e-14);
        }
        for (m, joint) in case.model().joints().iter().enumerate() {
            let unit = if joint.motion == VirtualJointKind::Linear { factor } else { 1.0 };
            let found = other.solution.virtual_joints[m] / unit;
            near("X", found, one.solution.virtual_joints[m], angle_tolerance(&case, m / 3));
        }
        prop_assert!((one.normal() - other.normal()).norm() < 1e-13);
        near("torsion", other.torsion(), one.torsion(), 1e-11);

        let (system, scaled_system) = (gpr.system(case.model()), scaled_gpr.system(case.model()));
        let (before, after) = (first_order(&system, &one), first_order(&scaled_system, &other));
        prop_assert_eq!(before.rank, after.rank);
        let (values, scaled_values) = (before.singular_values, after.singular_values);
        all_near("singular values", scaled_values.as_slice(), values.as_slice(), 1e-13);

        let sigma = |system: &GprSystem<'_, dyn Virtualization>, pose: &PlatformPose| {
            let rho = pose.solution.characteristic_length;
            sensitivity(system, &system.configuration(pose), rho, RANK_THRESHOLD).unwrap()
        };
        let (before, after) = (sigma(&system, &one), sigma(&scaled_system, &other));
        prop_assert_eq!((before.rank, after.rank), (3, 3));
        for k in 0..3 {
            let ratio = after.singular_values()[k] / before.singular_values()[k];
            near("ratio of sensitivities", ratio, 1.0, 1e-9);
        }
    }

    #[test]
    fn bounds_enclose_the_linear_displacement(
        case in cases(),
        motion in prop::collection::vec(-1.0..1.0, 12),
    ) {
        let gpr = case.robot.gpr();
        let system = gpr.system(case.model());
        let pose = case.pose(&gpr);
        let at = system.configuration(&pose);
        let rho = pose.solution.characteristic_length;
        let found = sensitivity(&system, &at, rho, RANK_THRESHOLD).unwrap();
        let motion = DVector::from_vec(motion);
        let bounds = found.bounds(&motion).unwrap();
        prop_assert!(bounds.hold(bounds.linear, 1e-10), "{bounds:?}");
        prop_assert!(bounds.upper <= bounds.coarse_upper * (1.0 + 1e-14));
        // The eigenvalues of the squared matrix know half the digits.
        near("(4) lower", bounds.eigenvalue_lower, bounds.lower, 1e-7 * bounds.upper);
        near("(4) upper", bounds.eigenvalue_upper, bounds.upper, 1e-12 * bounds.upper);

        let limbs = [0, 1, 2].map(GprSystem::<dyn Virtualization>::limb_coordinates);
        let limbs = limbs.each_ref().map(|limb| &limb[..]);
        let by_limb = found.shares_by_coordinates(&motion, &limbs).unwrap().unwrap();
        near("shares of the limbs", by_limb.iter().sum(), 1.0, 1e-11);
        let all: Vec<usize> = (0..12).collect();
        let by_constraint = found.shares_by_constraints(&motion, &all).unwrap().unwrap();
        near("shares of the constraints", by_constraint.iter().sum(), 1.0, 1e-11);
    }
}

fn case_with(case: &Case, solver: Solver) -> Case {
    Case { options: SolveOptions { solver, ..case.options }, ..*case }
}

/// Offset angles are known as well as the offsets that they turn are large; all else to round-off.
fn angle_tolerance(case: &Case, kind: usize) -> f64 {
    match (case.model().name(), kind) {
        ("offset", 1) => 1e-8,
        (_, 1) => 1e-11,
        _ => 1e-12,
    }
}

proptest! {
    // A search for neighbours takes milliseconds.
    #![proptest_config(runs(256))]

    #[test]
    fn ranks_and_null_spaces(case in cases()) {
        let gpr = case.robot.gpr();
        let system = gpr.system(case.model());
        let pose = case.pose(&gpr);
        let at = system.configuration(&pose);
        prop_assume!(pose.tilt().angle > 1e-6, "a level pose is another law");
        let found = finite_mobility(&system, &at, RANK_THRESHOLD).unwrap();
        prop_assert_eq!(found.mobility, Some(1), "{:#?}", found);
        let first = found.instantaneous;
        prop_assert_eq!((first.rank, first.mobility, first.redundancy), (11, 1, 1));
        let augmented = augmented_mobility(&system, &at, RANK_THRESHOLD).unwrap();
        let joints = case.model().joints().len();
        prop_assert_eq!((augmented.rank, augmented.mobility, augmented.redundancy), (12, joints, 0));
        prop_assert!(kept(&system, &at, &first));
    }

    #[test]
    fn level_pose_is_infinitesimally_mobile(robot in robots(), height in 0.3..0.7, model in 0..4_usize) {
        // Only where the sockets are over the rods is every level pose without play, and singular.
        let mut robot = robot;
        for limb in &mut robot.limbs {
            *limb = Limb::under_socket(limb.socket_radius, limb.socket_angle);
        }
        let gpr = robot.gpr();
        let model = built_in()[model];
        let system = gpr.system(model);
        let pose = gpr.forward([height; 3], model, &SolveOptions::default()).unwrap();
        let at = system.configuration(&pose);
        let found = finite_mobility(&system, &at, RANK_THRESHOLD).unwrap();
        prop_assert_eq!(found.mobility, Some(1));
        prop_assert_eq!((found.instantaneous.rank, found.instantaneous.mobility), (9, 3));
        prop_assert!(kept(&system, &at, &found.instantaneous));
        let augmented = augmented_mobility(&system, &at, RANK_THRESHOLD).unwrap();
        prop_assert_eq!(augmented.rank, 12);
    }
}

/// J N = 0, SᵀJ = 0, NᵀN = 1, SᵀS = 1, rank + nullity = n.
fn kept(system: &dyn System, at: &Configuration, found: &InstantaneousMobility) -> bool {
    let length = found.characteristic_length;
    let scaled = |dimensions: Vec<jointplay_core::constraint::Dimension>| {
        dimensions.into_iter().map(|d| d.unit(length)).collect::<Vec<f64>>()
    };
    let (rows, columns) =
        (scaled(system.constraint_dimensions()), scaled(system.coordinate_dimensions()));
    let jacobian = system.constraint_jacobian(at);
    let jacobian = DMatrix::from_fn(12, 12, |i, j| jacobian[(i, j)] * columns[j] / rows[i]);
    let (n, s) = (&found.null_space, &found.self_stress);
    let identity = |matrix: &DMatrix<f64>| {
        let count = matrix.ncols();
        (matrix.transpose() * matrix - DMatrix::identity(count, count)).amax() < 1e-13
    };
    (&jacobian * n).amax() < 1e-13
        && (s.transpose() * &jacobian).amax() < 1e-13
        && identity(n)
        && identity(s)
        && found.rank + n.ncols() == 12
        && found.rank + s.ncols() == 12
}

/// The paper's robot over its whole range, in steps and not at random.
#[test]
fn newton_takes_three_steps_within_two_degrees() {
    let gpr = Gpr::paper().without_limit_checks();
    for model in built_in() {
        for azimuth_deg in 0..360 {
            for tenth in -20..=20 {
                let tilt_angle = (f64::from(tenth) / 10.0).to_radians();
                let tilt = Tilt { azimuth: f64::from(azimuth_deg).to_radians(), angle: tilt_angle };
                let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
                for metric in [Metric::Paper, Metric::PlatformRadius] {
                    let options =
                        SolveOptions { solver: Solver::Newton, metric, ..SolveOptions::default() };
                    let found = gpr.forward(rods, model, &options).unwrap().solution;
                    assert!(found.iterations <= 3, "{} at {tilt:?}", model.name());
                    assert!(found.residual < 1e-12);
                }
            }
        }
    }
}

/// At the level pose all virtual joints are nominal, under every model, solver and metric.
#[test]
fn level_poses_need_no_play() {
    let gpr = Gpr::paper().without_limit_checks();
    for model in [&Radial as &dyn Virtualization, &Polar, &Planar, built_in()[2]] {
        for solver in SOLVERS {
            let options = SolveOptions { solver, ..SolveOptions::default() };
            let pose = gpr.forward([0.5; 3], model, &options).unwrap();
            assert!(displacement(&gpr, model, &pose) < 1e-15, "{} {solver}", model.name());
            assert!(pose.center_shift().norm() < 1e-15 && pose.tilt().angle < 1e-15);
        }
    }
}

/// A central difference of fourth order: an odd error is cancelled by a second step.
fn fine_difference(f: impl Fn(f64) -> DVector<f64>, step: f64) -> DVector<f64> {
    (difference(&f, step) * 4.0 - difference(&f, 2.0 * step)) / 3.0
}

/// Random poses by least displacement, at random tilts, all derivatives of which exist.
fn differentiable_cases() -> impl Strategy<Value = Case> {
    cases().prop_map(|mut case| {
        case.options.solver = if case.options.solver == Solver::Newton {
            Solver::LeastNorm
        } else {
            case.options.solver
        };
        // Lighter angles leave the numbers of the iteration too few digits for differences.
        if case.options.metric != Metric::Paper {
            case.options.metric = Metric::PlatformRadius;
        }
        case
    })
}

/// A vector that is near another one, as a share of the size of what is compared.
#[track_caller]
fn near_in_size(what: &str, found: &DVector<f64>, expected: &DVector<f64>, share: f64) {
    let size = expected.amax().max(1.0);
    let off = (found - expected).amax();
    assert!(off <= share * size, "{what} is off by {off:e} of {size:e}: {found} {expected}");
}

proptest! {
    #![proptest_config(runs(256))]

    #[test]
    fn rods_have_the_derivatives_of_their_differences(
        robot in robots(),
        about in prop::array::uniform2(-0.2..0.2),
        level in 0..4_u8,
    ) {
        let gpr = robot.gpr();
        let [x, y] = if level == 0 { [0.0; 2] } else { about };
        let at = |by: &Vector3<f64>| {
            let tilt = Tilt::from_about_x_and_y(x + by.x, y + by.y);
            gpr.rod_derivatives(tilt, AxisHeight(0.5 + by.z)).unwrap()
        };
        let here = at(&Vector3::zeros());
        for j in 0..3 {
            let along = |step: f64| at(&Vector3::ith(j, step));
            let rods = fine_difference(|step| DVector::from_column_slice(&along(step).rods), 1e-3);
            let column = here.rod_jacobian.column(j);
            near_in_size("rods", &DVector::from_column_slice(column.clone_owned().as_slice()), &rods, 1e-11);
            for k in 0..3 {
                let row = |step: f64| {
                    DVector::from_iterator(3, along(step).rod_jacobian.row(k).iter().copied())
                };
                let column = here.second[k].column(j).clone_owned();
                let expected = fine_difference(row, 1e-3);
                near_in_size("rod Jacobian", &DVector::from_column_slice(column.as_slice()), &expected, 1e-11);
            }
        }
    }

    #[test]
    fn poses_have_the_derivatives_of_their_differences(case in differentiable_cases(), level in 0..4_u8) {
        let case = if level == 0 { Case { tilt: Tilt::LEVEL, ..case } } else { case };
        let (gpr, model) = (case.robot.gpr(), case.model());
        let here = case.pose(&gpr);
        let rods = Vector3::from(here.rods);
        let pose_at = |by: Vector3<f64>| gpr.forward((rods + by).into(), model, &case.options).unwrap();
        let found = gpr.platform_derivatives(&here, model).unwrap();
        prop_assert_eq!(found.jacobian, gpr.platform_jacobian(&here, model).unwrap());
        let flat = |joints: &[f64]| DVector::from_column_slice(joints);
        for k in 0..3 {
            let along = |step: f64| pose_at(Vector3::ith(k, step));
            // Rotation from here, whose derivative is the angular velocity.
            let moved = |step: f64| {
                let pose = along(step);
                let turn = pose.base_from_platform.rotation * here.base_from_platform.rotation.inverse();
                let turn = rotation_vector(&turn);
                let to = pose.base_from_platform.translation.vector;
                DVector::from_column_slice(&[turn.x, turn.y, turn.z, to.x, to.y, to.z])
            };
            let step = 1e-4;
            let column = DVector::from_column_slice(found.jacobian.matrix.column(k).clone_owned().as_slice());
            near_in_size("pose", &column, &fine_difference(moved, step), 1e-8);
            let joints = |step: f64| flat(&along(step).solution.virtual_joints);
            near_in_size("virtual joints", &flat(&found.jacobian.virtual_joints[k]), &fine_difference(joints, step), 1e-8);

            let jacobian = |step: f64| gpr.platform_jacobian(&along(step), model).unwrap();
            let matrix = |step: f64| DVector::from_column_slice(jacobian(step).matrix.as_slice());
            let derivative = DVector::from_column_slice(found.jacobian_derivatives[k].as_slice());
            near_in_size("Jacobian", &derivative, &fine_difference(matrix, step), 1e-7);
            for j in 0..3 {
                let joints = |step: f64| flat(&jacobian(step).virtual_joints[j]);
                let second = flat(&found.virtual_joints[j][k]);
                near_in_size("their derivatives", &second, &fine_difference(joints, step), 1e-7);
                // As exact as the iteration finds the least displacement.
                near_in_size("their order", &second, &flat(&found.virtual_joints[k][j]), 1e-8);
            }
        }
    }

    #[test]
    fn a_commanded_tilt_is_the_velocity_of_the_platform(
        case in differentiable_cases(),
        rates in prop::array::uniform3(-1.0..1.0),
        changes in prop::array::uniform3(-1.0..1.0),
    ) {
        let (gpr, model) = (case.robot.gpr(), case.model());
        let (rates, changes) = (Vector3::from(rates), Vector3::from(changes));
        let rods = gpr.rod_derivatives(case.tilt, AxisHeight(case.height)).unwrap();
        let platform = gpr.platform_derivatives(&case.pose(&gpr), model).unwrap();
        let (velocities, accelerations) = (rods.velocities(&rates), rods.accelerations(&rates, &changes));
        let velocity = platform.jacobian.velocity(&velocities);
        let acceleration = platform.acceleration(&velocities, &accelerations);
        let (x, y) = case.tilt.about_x_and_y();
        let normal = |time: f64| {
            let about = |start: f64, i: usize| start + rates[i] * time + 0.5 * changes[i] * time * time;
            Tilt::from_about_x_and_y(about(x, 0), about(y, 1)).normal()
        };
        let here = normal(0.0);
        let first = (normal(1e-4) - normal(-1e-4)) / 2e-4;
        let second = (normal(1e-3) - here * 2.0 + normal(-1e-3)) / 1e-6;
        let turned = velocity.angular.cross(&here);
        prop_assert!((turned - first).amax() < 1e-7);
        let bent = acceleration.angular.cross(&here) + velocity.angular.cross(&turned);
        prop_assert!((bent - second).amax() < 1e-4 * second.amax().max(1.0));
    }
}
