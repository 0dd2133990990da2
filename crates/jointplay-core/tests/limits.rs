//! Poses beyond the limits of the three-rod robot are refused, one by one and many at a time.

use jointplay_core::Error;
use jointplay_core::bulk::{Column, Quantity, Status};
use jointplay_core::gpr::{AxisHeight, BrokenLimit, CenterHeight, Gpr};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{Planar, Polar, SolveOptions};

fn broken<T: std::fmt::Debug>(found: Result<T, Error>) -> Vec<BrokenLimit> {
    match found.unwrap_err() {
        Error::BeyondLimits(broken) => broken.iter().collect(),
        other => panic!("{other}"),
    }
}

#[test]
fn degrees_for_radians_and_millimetres_for_metres_are_refused() {
    let (gpr, options) = (Gpr::paper(), SolveOptions::default());
    let level = AxisHeight(0.5);
    // 1.5° and 30° given as though they were radians: 85.9°, with rods below zero.
    let degrees = broken(gpr.inverse(Tilt { azimuth: 30.0, angle: 1.5 }, level));
    assert_eq!(degrees.len(), 3);
    assert!(matches!(degrees[2], BrokenLimit::Tilt { angle: 1.5, .. }));
    let millimetres = broken(gpr.forward([120.0, 121.0, 122.0], &Planar, &options));
    assert!(matches!(millimetres[0], BrokenLimit::Rod { limb: 1, length: 120.0, .. }));
    assert_eq!(broken(gpr.forward([-0.1; 3], &Planar, &options)).len(), 3);
    // Each rod is within its limits, but the plane tilts by 67°.
    let steep = broken(gpr.forward([0.3, 0.7, 0.3], &Planar, &options));
    assert!(matches!(steep[..], [BrokenLimit::Tilt { .. }]));
    let tilt = Tilt { azimuth: 0.0, angle: 0.349 };
    let center = gpr.inverse_for_center(tilt, CenterHeight(0.5), &Planar, &options);
    assert!(!broken(center).is_empty());
    assert!(!broken(gpr.approximate(tilt, level)).is_empty());
    assert!(!broken(gpr.tilt_play(tilt, level, &Planar, &options)).is_empty());
    let message = gpr.inverse(Tilt { azimuth: 0.0, angle: 0.1 }, level).unwrap_err().to_string();
    let expected = "the pose is beyond the robot's limits: the tilt is 0.1 rad, up to 0.026179938779914945 rad is allowed; lengths are in m and angles in rad";
    assert_eq!(message, expected);
}

#[test]
fn the_same_robot_without_limit_checks_answers() {
    let (gpr, options) = (Gpr::paper(), SolveOptions::default());
    let free = gpr.without_limit_checks();
    assert_eq!((gpr.checks_limits(), free.checks_limits()), (true, false));
    assert_eq!(free.limits(), gpr.limits());
    let tilt = Tilt { azimuth: 0.4, angle: 0.3 };
    let rods = free.inverse(tilt, AxisHeight(0.5)).unwrap();
    assert!(gpr.inverse(tilt, AxisHeight(0.5)).is_err());
    assert!((free.forward(rods, &Polar, &options).unwrap().tilt().angle - 0.3).abs() < 1e-12);
    // Within the limits both results are equal to the bit.
    let tilt = Tilt { azimuth: 0.4, angle: 0.02 };
    let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
    assert_eq!(free.inverse(tilt, AxisHeight(0.5)), Ok(rods));
    assert_eq!(free.forward(rods, &Polar, &options), gpr.forward(rods, &Polar, &options));
}

/// Numbers spread evenly over a range, the same in each run.
fn spread(i: usize, stride: f64, least: f64, most: f64) -> f64 {
    least + (i as f64 * stride).fract() * (most - least)
}

/// The tilt of a plane by the spherical angle between its normal and the vertical: another formula than the one under test.
fn steepness(gpr: &Gpr, rods: &[f64; 3]) -> f64 {
    let [p, q, r] = gpr.ball_centers(rods);
    let normal = (q - p).cross(&(r - p)).normalize();
    2.0 * ((normal - nalgebra::Vector3::z()).norm() / 2.0).asin()
}

#[test]
fn many_poses_have_the_status_that_one_pose_has() {
    const POSES: usize = 4001;
    let gpr = Gpr::paper();
    let limits = *gpr.limits();
    // Around a third of the rods and a third of the tilts are beyond.
    let rods: [Vec<f64>; 3] = [0.754_877_666, 0.569_840_291, 0.430_159_709].map(|stride| {
        (0..POSES)
            .map(|i| {
                let base = spread(i, 0.618_033_989, 0.22, 0.78);
                base + spread(i, stride, -0.004, 0.004)
            })
            .collect()
    });
    let mut status = vec![Status::Solved; POSES];
    let mut tilt_angle = vec![0.0; POSES];
    let columns = rods.each_ref().map(|column| Column::from(&column[..]));
    let options = SolveOptions::default();
    let wanted = &mut [(Quantity::TiltAngle, &mut tilt_angle[..])];
    let tally = gpr.forward_many(columns, &Planar, &options, &mut status, wanted).unwrap();
    let mut flags = [(); 4].map(|()| vec![false; POSES]);
    let written = flags.each_mut().map(|column| &mut column[..]);
    gpr.broken_limits_many(columns, None, written).unwrap();
    for i in 0..POSES {
        let one = rods.each_ref().map(|column| column[i]);
        let rods_within = one.iter().all(|q| (limits.rod_min..=limits.rod_max).contains(q));
        let expected = rods_within && steepness(&gpr, &one) <= limits.tilt_max;
        assert_eq!(status[i] == Status::Solved, expected, "{one:?}");
        assert_eq!(tilt_angle[i].is_nan(), !expected);
        assert_eq!(gpr.forward(one, &Planar, &options).is_ok(), expected);
        assert_eq!(flags.iter().any(|column| column[i]), !expected);
        for (column, rod) in flags.iter().zip(&one) {
            assert_eq!(column[i], !(limits.rod_min..=limits.rod_max).contains(rod));
        }
    }
    let beyond = tally.count(Status::BeyondLimits);
    assert_eq!(beyond, tally.failed());
    assert!((POSES / 4..3 * POSES / 4).contains(&beyond), "{beyond}");

    let (azimuth, tilt_angle): (Vec<f64>, Vec<f64>) = (0..POSES)
        .map(|i| (spread(i, 0.754_877_666, -3.0, 3.0), spread(i, 0.569_840_291, -0.04, 0.04)))
        .unzip();
    let height: Vec<f64> = (0..POSES).map(|i| spread(i, 0.618_033_989, 0.24, 0.76)).collect();
    let mut found = [(); 3].map(|()| vec![0.0; POSES]);
    let written = found.each_mut().map(|column| &mut column[..]);
    let columns = [&azimuth, &tilt_angle, &height].map(|column| Column::from(&column[..]));
    let [azimuths, tilt_angles, heights] = columns;
    let tally = gpr.inverse_many(azimuths, tilt_angles, heights, &mut status, written).unwrap();
    for i in 0..POSES {
        let tilt = Tilt { azimuth: azimuth[i], angle: tilt_angle[i] };
        let one = gpr.inverse(tilt, AxisHeight(height[i]));
        assert_eq!(status[i] == Status::Solved, one.is_ok());
        // q_k = z − (n · B_k)/n_z, computed independently.
        let normal = tilt.normal();
        let mut within = tilt_angle[i].abs() <= limits.tilt_max;
        for (k, base) in gpr.base_points().iter().enumerate() {
            let q = height[i] - (normal.x * base.x + normal.y * base.y) / normal.z;
            within &= (limits.rod_min..=limits.rod_max).contains(&q);
            assert!(found[k][i].is_nan() || (found[k][i] - q).abs() < 1e-15);
        }
        assert_eq!(one.is_ok(), within, "{tilt:?} {}", height[i]);
        assert_eq!(found[0][i].is_nan(), !within);
    }
    assert!((POSES / 10..9 * POSES / 10).contains(&tally.count(Status::BeyondLimits)));
}

#[test]
fn a_pose_on_its_limits_is_within_them() {
    let (gpr, options) = (Gpr::paper(), SolveOptions::default());
    let limits = *gpr.limits();
    for azimuth in (0..72).map(|k| f64::from(k) * 5.0) {
        let tilt = Tilt { azimuth: azimuth.to_radians(), angle: limits.tilt_max };
        let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
        gpr.forward(rods, &Planar, &options).unwrap();
        let (mut status, mut tilt_angle) = ([Status::TurnedOver], [0.0]);
        let columns = rods.each_ref().map(|rod| Column::constant(rod, 1));
        let wanted = &mut [(Quantity::TiltAngle, &mut tilt_angle[..])];
        gpr.forward_many(columns, &Planar, &options, &mut status, wanted).unwrap();
        assert_eq!(status, [Status::Solved], "{azimuth}");
        assert!((tilt_angle[0] - limits.tilt_max).abs() < 1e-12);
    }
    for height in [limits.rod_min, limits.rod_max] {
        let rods = gpr.inverse(Tilt::LEVEL, AxisHeight(height)).unwrap();
        assert_eq!(rods, [height; 3]);
        gpr.forward(rods, &Planar, &options).unwrap();
    }
}

#[test]
fn no_length_gives_a_number_that_is_none() {
    let options = SolveOptions::default();
    let free = Gpr::paper().without_limit_checks();
    for length in [1e16, 1e60, 1e154, 1e200, 1e308, f64::MAX, f64::INFINITY, f64::NAN] {
        for rods in [[length; 3], [length, 0.5, 0.5], [length, -length, 0.5]] {
            for model in [&Planar as &dyn jointplay_core::virtualization::Virtualization, &Polar] {
                let columns = rods.each_ref().map(|rod| Column::constant(rod, 1));
                let (mut status, mut found) = ([Status::Solved], [[0.0]; 5]);
                let [a, b, c, d, e] = found.each_mut().map(|column| &mut column[..]);
                let wanted = &mut [
                    (Quantity::Origin(2), a),
                    (Quantity::AxisHeight, b),
                    (Quantity::Azimuth, c),
                    (Quantity::Residual, d),
                    (Quantity::Displacement, e),
                ];
                free.forward_many(columns, model, &options, &mut status, wanted).unwrap();
                let finite = found.iter().all(|column| column[0].is_finite());
                assert_eq!(finite, status[0] == Status::Solved, "{rods:?} {status:?} {found:?}");
                if let Ok(pose) = free.forward(rods, model, &options) {
                    assert!(pose.base_from_platform.to_homogeneous().iter().all(|x| x.is_finite()));
                    assert!(pose.axis_height().0.is_finite() && pose.solution.residual.is_finite());
                }
            }
        }
        if let Ok(rods) = free.inverse(Tilt { azimuth: 1.0, angle: 1.57 }, AxisHeight(length)) {
            assert!(rods.iter().all(|rod| rod.is_finite()));
        }
    }
}
