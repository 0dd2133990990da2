//! Studies as a caller sees them: order, errors, sums, comparisons.

use jointplay_core::gpr::{AxisHeight, BrokenLimit, Gpr};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{Planar, Polar, SolveOptions, Solver, built_in};
use jointplay_study::{
    Error, Order, Raster, Samples, SeriesKind, broken_limits, check_bounds, compare, simulate,
    summarize,
};

fn newton() -> SolveOptions {
    SolveOptions { solver: Solver::Newton, ..SolveOptions::default() }
}

fn run(raster: &Raster) -> Samples {
    simulate(&Gpr::paper(), raster, &Polar, &newton(), &mut |_| ())
        .expect("poses that can be reached")
}

/// A raster of these angles in degrees.
fn raster(azimuths: &[f64], tilt_angles: &[f64]) -> Raster {
    let radians = |degrees: &[f64]| degrees.iter().map(|angle| angle.to_radians()).collect();
    Raster { azimuths: radians(azimuths), tilt_angles: radians(tilt_angles), ..Raster::paper() }
}

#[test]
fn the_paper_s_raster_runs_through_level_in_each_row() {
    let raster = Raster::paper();
    let tilts: Vec<Tilt> = raster.tilts().collect();
    assert_eq!((raster.len(), tilts.len()), (777, 777));
    assert_eq!(tilts[0], Tilt { azimuth: 0.0, angle: (-2_f64).to_radians() });
    assert_eq!(tilts[20], Tilt { azimuth: 0.0, angle: 2_f64.to_radians() });
    assert_eq!(tilts[776], Tilt { azimuth: 360_f64.to_radians(), angle: 2_f64.to_radians() });
    let passes: Vec<usize> = run(&raster).singular_passes().collect();
    assert_eq!(passes, (0..37).map(|row| 21 * row + 10).collect::<Vec<usize>>());
}

#[test]
fn a_serpentine_is_the_raster_with_every_other_row_reversed() {
    let raster = Raster::paper();
    let (there, back) = (run(&raster), run(&Raster { order: Order::Serpentine, ..raster.clone() }));
    for i in 0..there.len() {
        let (row, column) = (i / 21, i % 21);
        let j = 21 * row + if row % 2 == 1 { 20 - column } else { column };
        assert_eq!((there.azimuth[i], there.tilt_angle[i]), (back.azimuth[j], back.tilt_angle[j]));
        for (a, b) in there.series().iter().zip(back.series()) {
            assert_eq!(a.values[i].to_bits(), b.values[j].to_bits(), "{}", a.name);
        }
    }
    // Continuous in time: neighbours differ in azimuth or in tilt angle, by one step.
    for i in 1..back.len() {
        let (azimuth, tilt_angle) =
            (back.azimuth[i] - back.azimuth[i - 1], back.tilt_angle[i] - back.tilt_angle[i - 1]);
        assert!(
            (azimuth == 0.0) != (tilt_angle == 0.0) && tilt_angle.abs() < 0.21_f64.to_radians()
        );
    }
}

#[test]
fn a_study_without_poses_is_refused() {
    let error = |raster: &Raster| {
        simulate(&Gpr::paper(), raster, &Polar, &newton(), &mut |_| ()).unwrap_err()
    };
    assert_eq!(error(&raster(&[], &[1.0])), Error::Empty { azimuths: 0, tilt_angles: 1 });
    assert!(
        error(&raster(&[0.0], &[]))
            .to_string()
            .contains("azimuth has 1 values and the tilt angle 0")
    );
    let options = newton();
    let none = compare(&Gpr::paper(), &built_in(), 0.0, &[], AxisHeight(0.5), &options);
    assert_eq!(none.unwrap_err(), Error::Empty { azimuths: 1, tilt_angles: 0 });
}

#[test]
fn the_first_pose_that_fails_is_named() {
    let steep = raster(&[0.0, 20.0], &[1.0, 95.0]);
    let error = simulate(&Gpr::paper(), &steep, &Polar, &newton(), &mut |_| ()).unwrap_err();
    let Error::Pose { sample, tilt_angle, ref source, .. } = error else { panic!("{error}") };
    assert_eq!((sample, tilt_angle), (1, 95_f64.to_radians()));
    assert_eq!(**source, jointplay_core::Error::TiltTooLarge { tilt_angle });
    assert!(
        error.to_string().starts_with("sample 1 (azimuth 0°, tilt angle 95°): the tilt angle is"),
        "{error}"
    );

    let impatient = SolveOptions { max_iterations: 1, ..newton() };
    let error =
        simulate(&Gpr::paper(), &Raster::paper(), &Polar, &impatient, &mut |_| ()).unwrap_err();
    assert!(error.to_string().contains("did not converge"), "{error}");
    let check = check_bounds(&Gpr::paper(), &Raster::paper(), &Polar, &impatient, &mut |_| ());
    assert!(matches!(check, Err(Error::Pose { .. })));
}

#[test]
fn progress_runs_up_to_the_number_of_samples() {
    let mut seen = Vec::new();
    simulate(&Gpr::paper(), &Raster::paper(), &Planar, &newton(), &mut |done| seen.push(done))
        .unwrap();
    assert!(seen.is_sorted() && seen.len() > 2, "{seen:?}");
    assert_eq!(seen.last(), Some(&777));
}

#[test]
fn a_summary_adds_up() {
    let (gpr, raster) = (Gpr::paper(), raster(&[0.0, 40.0], &[-2.0, -1.0, 0.0, 1.0, 2.0]));
    let samples = run(&raster);
    let summary = summarize(&gpr, &samples);
    assert_eq!((summary.samples, summary.singular_passes, summary.beyond_tilt), (10, 2, 4));
    assert_eq!(summary.iterations.iter().sum::<usize>(), 10);
    assert_eq!(summary.iterations[0], 2, "level takes no step");
    let names: Vec<&str> = summary.series.iter().map(|series| series.name.as_str()).collect();
    let expected =
        ["q1", "q2", "q3", "L12", "L23", "L31", "l1", "l2", "l3", "phi1", "phi2", "phi3"];
    assert_eq!(names, expected);
    for (summed, series) in summary.series.iter().zip(samples.series()) {
        assert!(series.values.iter().all(|&v| (summed.min..=summed.max).contains(&v)));
        assert!(series.values.contains(&summed.min) && series.values.contains(&summed.max));
        assert_eq!(series.values[2], summed.pass_min.unwrap());
        let extrema = summed.minimum_at + summed.maximum_at + summed.constant_at;
        let at_passes = if series.kind == SeriesKind::Rod { 0 } else { 2 };
        assert_eq!(extrema, at_passes, "{}", summed.name);
    }
    // Without a sample at level there is no pass to speak of.
    let tilted = summarize(&gpr, &run(&Raster { tilt_angles: vec![0.01, 0.02], ..raster }));
    assert_eq!((tilted.singular_passes, tilted.series[0].pass_min), (0, None));
}

#[test]
fn bounds_hold_along_the_chord_only() {
    let gpr = Gpr::paper().without_limit_checks();
    for virtualization in built_in() {
        let raster = raster(&[0.0, 25.0], &[-2.0, 0.0, 1.0]);
        let check = check_bounds(&gpr, &raster, virtualization, &newton(), &mut |_| ()).unwrap();
        assert_eq!((check.poses, check.held_at_start, check.held_at_midpoint), (4, 0, 4));
    }
}

#[test]
fn a_comparison_is_its_poses() {
    let (gpr, options, azimuth) = (Gpr::paper().without_limit_checks(), newton(), 0.3);
    let tilt_angles = [0.0, 0.01, 0.02];
    let found =
        compare(&gpr, &built_in(), azimuth, &tilt_angles, AxisHeight(0.5), &options).unwrap();
    assert_eq!(found.models.len(), 4);
    for (curve, virtualization) in found.models.iter().zip(built_in()) {
        assert_eq!(curve.name, virtualization.name());
        for (i, &tilt_angle) in tilt_angles.iter().enumerate() {
            let rods = gpr.inverse(Tilt { azimuth, angle: tilt_angle }, AxisHeight(0.5)).unwrap();
            let pose = gpr.forward(rods, virtualization, &options).unwrap();
            assert_eq!(curve.center_shift[i], pose.center_shift());
        }
        assert_eq!(curve.largest_displacement[0], 0.0);
        assert!(curve.largest_displacement.is_sorted());
    }
    // What the approximate model calls a gap, the planar model calls a displacement.
    for (gap, moved) in found.approximate_gap.iter().zip(&found.models[3].largest_displacement) {
        assert!((gap - moved).abs() < 1e-15);
    }
}

/// Rods and tilts that each tilt of a range breaks, one by one, and those of the whole range.
#[test]
fn a_range_of_tilts_breaks_the_limits_that_its_tilts_break() {
    let gpr = Gpr::paper().without_limit_checks();
    // 0 for the tilt, else the number of the rod.
    let which = |limit: &BrokenLimit| match limit {
        BrokenLimit::Rod { limb, .. } => *limb,
        BrokenLimit::Tilt { .. } => 0,
    };
    for (from, to) in [(-1.0, 1.0), (0.0, 2.0), (-2.0, 1.0), (-80.0, 10.0), (-75.0, 78.0)] {
        for (height, azimuth) in [(0.5, 0.0), (0.5, 2.0), (0.74, 0.3), (0.25, 4.0)] {
            let share = |k: usize| from + (to - from) * f64::from(u8::try_from(k).unwrap()) / 50.0;
            let angles: Vec<f64> = (0..=50).map(|k| share(k).to_radians()).collect();
            let found = broken_limits(&gpr, azimuth, &angles, AxisHeight(height)).unwrap();
            let mut all: Vec<usize> = found.iter().map(which).collect();
            let mut expected = Vec::new();
            for &angle in &angles {
                let tilt = Tilt { azimuth, angle };
                let rods = gpr.inverse(tilt, AxisHeight(height)).unwrap();
                expected.extend(gpr.limits().broken(&rods, tilt).iter().map(|one| which(&one)));
            }
            for of in [&mut all, &mut expected] {
                of.sort_unstable();
                of.dedup();
            }
            assert_eq!(all, expected, "{from}° to {to}°, {height} m, azimuth {azimuth}");
        }
    }
}
