//! Columns of tables: headings, tilts and speeds compared with other formulas, and windows with the whole table.

use jointplay_cell::check::{CheckOptions, check};
use jointplay_cell::trajectory::Trajectory;
use jointplay_cell::workcell::Cell;
use jointplay_interop::export::{
    Error, MotionExport, SampleOptions, frame_poses, samples, samples_in_parts, samples_with,
    select_columns,
};
use jointplay_report::table::{Column, Values};
use nalgebra::{Quaternion, UnitQuaternion};
use proptest::prelude::*;

use crate::planned::{example, planned};

const PROGRAM: &str = "HOME\nTRANSFER LP1 SLOT 1 TO LP2 SLOT 25 WITH B\nHOME\n";

fn example_motion() -> (Cell, Trajectory) {
    let cell = example();
    let motion = planned(&cell, PROGRAM);
    (cell, motion)
}

fn motion_export<'a>(cell: &'a Cell, motion: &'a Trajectory) -> MotionExport<'a> {
    MotionExport { cell, motion, program: PROGRAM, violation_notes: &[] }
}

fn options(cell: &Cell, rate: f64, columns: &[&str]) -> SampleOptions {
    let names: Vec<String> = columns.iter().map(|&name| name.to_owned()).collect();
    let columns = Some(select_columns(cell, &names).unwrap());
    SampleOptions { columns, ..SampleOptions::at_rate(rate) }
}

fn real<'c>(columns: &'c [Column], name: &str) -> &'c [f64] {
    let column = columns.iter().find(|column| column.name == name).unwrap();
    let Values::Real(values) = &column.values else { panic!("{name} is not real") };
    values
}

/// Difference of two angles (degrees).
fn between(a: f64, b: f64) -> f64 {
    (a - b + 180.0).rem_euclid(360.0) - 180.0
}

#[test]
fn heading_and_tilt_agree_with_the_quaternion_and_the_normal() {
    let (cell, motion) = example_motion();
    let motion_export = motion_export(&cell, &motion);
    let columns = samples_with(&motion_export, &options(&cell, 20.0, &["all"])).unwrap();
    let (mut largest, mut loaded) = (0.0_f64, 0);
    for (k, &time) in real(&columns, "time_s").iter().enumerate() {
        let sample = motion.sample_at(time);
        let carried = &motion.steps[sample.step].loaded;
        let pose = cell.forward_with_deflection(&sample.positions, carried).unwrap();
        for (name, pose) in [
            ("platform", pose.platform.base_from_platform),
            ("A", pose.base_from_wafer[0][0]),
            ("B", pose.base_from_wafer[1][0]),
        ] {
            let value = |end: &str| real(&columns, &format!("{name}_{end}"))[k];
            // The twist of the swing-twist decomposition about z.
            let turn = UnitQuaternion::from_rotation_matrix(&pose.rotation);
            let twist = 2.0 * turn.k.atan2(turn.w).to_degrees();
            let shown = value(if name == "platform" { "torsion_deg" } else { "heading_deg" });
            assert!(between(shown, twist).abs() < 1e-9, "{name} {time}");
            let normal = pose.rotation.matrix().column(2);
            let tilt = normal.xy().norm().asin().to_degrees();
            assert!((value("tilt_deg") - tilt).abs() < 1e-9, "{name} {time}");
            if tilt > 1e-3 {
                let direction = normal.y.atan2(normal.x).to_degrees();
                assert!(between(value("tilt_azimuth_deg"), direction).abs() < 1e-9);
            }
            assert!((value("z_mm") - 1e3 * pose.translation.z).abs() < 1e-9);
            largest = largest.max(tilt);
        }
        let column = columns.iter().find(|column| column.name == "B_loaded").unwrap();
        let Values::Count(counts) = &column.values else { panic!("not counted") };
        assert_eq!(counts[k], u32::from(!carried.is_empty()));
        loaded += counts[k];
    }
    // The second station is tilted by 0.8°.
    assert!(largest > 0.7 && loaded > 10, "{largest} {loaded}");
}

#[test]
fn budgets_peak_where_the_check_reports_them() {
    let (cell, motion) = example_motion();
    let columns =
        samples_with(&motion_export(&cell, &motion), &options(&cell, 1000.0, &["budgets"]));
    let columns = columns.unwrap();
    let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["platform_tilt_percent", "A_friction_percent", "B_friction_percent"]);
    let peak = |name: &str| real(&columns, name).iter().copied().fold(0.0, f64::max);
    let report = check(&cell, &motion, &CheckOptions::default());
    let rows = || report.by_instruction.iter();
    let tilt = rows().map(|row| row.tilt).fold(0.0, f64::max);
    assert!((peak("platform_tilt_percent") - 100.0 * tilt).abs() < 1e-6);
    // The check omits samples whose share is at most 0.0001 more; at the time that it reports, the shares are equal.
    let slips = rows().filter_map(|row| row.slip.as_ref());
    let most = slips.max_by(|a, b| a.ratio.total_cmp(&b.ratio)).unwrap();
    assert!(peak("B_friction_percent") - 100.0 * most.ratio < 0.011);
    // A rate of which a sample is at this time.
    let rate = (1000.0 * most.time).ceil() / most.time;
    let window = Some([most.time - 1e-4, most.time + 1e-4]);
    let there = SampleOptions { window, ..options(&cell, rate, &["time", "budgets"]) };
    let there = samples_with(&motion_export(&cell, &motion), &there).unwrap();
    let [time, share] = ["time_s", "B_friction_percent"].map(|name| real(&there, name)[0]);
    assert!((time - most.time).abs() < 1e-12, "{time} {most:?}");
    assert!((share - 100.0 * most.ratio).abs() < 1e-6, "{share} {most:?}");
    // The free effector holds no wafer.
    assert_eq!(peak("A_friction_percent"), 0.0);
}

#[test]
fn speeds_of_wafer_centres_are_the_derivatives_of_their_positions() {
    let (cell, motion) = example_motion();
    let motion_export = motion_export(&cell, &motion);
    // Within the motion to the tilted station, where the arm is loaded.
    let step = motion.steps.iter().position(|step| !step.loaded.is_empty()).unwrap() + 1;
    let window = Some([motion.times[step], motion.times[step + 1]]);
    let table = options(&cell, 1000.0, &["time", "B"]);
    let columns = samples_with(&motion_export, &SampleOptions { window, ..table }).unwrap();
    let [x, y, z] = ["x", "y", "z"].map(|axis| real(&columns, &format!("B_{axis}_mm")));
    let speed = real(&columns, "B_speed_mm_per_s");
    let fastest = speed.iter().copied().fold(0.0, f64::max);
    assert!(fastest > 100.0, "{fastest}");
    for k in 1..speed.len() - 1 {
        let rate = |values: &[f64]| (values[k + 1] - values[k - 1]) * 500.0;
        let expected = (rate(x).powi(2) + rate(y).powi(2) + rate(z).powi(2)).sqrt();
        assert!((speed[k] - expected).abs() < 1e-3 * fastest, "{k}: {} {expected}", speed[k]);
    }
}

#[test]
fn the_default_table_is_the_group_of_that_name() {
    let (cell, motion) = example_motion();
    let motion_export = motion_export(&cell, &motion);
    let named = samples_with(&motion_export, &options(&cell, 10.0, &["default"])).unwrap();
    assert_eq!(samples(&motion_export, 10.0).unwrap(), named);
    let all = samples_with(&motion_export, &options(&cell, 10.0, &["all"])).unwrap();
    for column in &named {
        assert!(all.contains(column), "{}", column.name);
    }
}

#[test]
fn poses_of_frames_are_those_of_the_robot_with_quaternions_that_do_not_jump() {
    let (cell, motion) = example_motion();
    let motion_export = motion_export(&cell, &motion);
    let table = options(&cell, 50.0, &["time", "poses"]);
    let columns = samples_with(&motion_export, &table).unwrap();
    let ends = columns.iter().filter_map(|column| column.name.strip_suffix("_qw"));
    let frames: Vec<&str> = ends.collect();
    assert_eq!(frames.len(), 3 + 1 + 2 * 4 + 2, "{frames:?}");
    assert_eq!(columns.len(), 2 + 7 * frames.len());
    let times = real(&columns, "time_s").to_vec();
    let mut below_zero = 0;
    for name in frames {
        let poses = frame_poses(&motion_export, name, &table).unwrap();
        assert_eq!(poses.len(), times.len());
        let mut last: Option<UnitQuaternion<f64>> = None;
        for (k, pose) in poses.iter().enumerate() {
            for (axis, value) in ["x", "y", "z"].iter().zip(pose.translation.vector.iter()) {
                let shown = real(&columns, &format!("{name}_{axis}_mm"))[k];
                assert!((shown - 1e3 * value).abs() < 1e-9, "{name} {axis} {k}");
            }
            let [w, x, y, z] =
                ["w", "x", "y", "z"].map(|part| real(&columns, &format!("{name}_q{part}"))[k]);
            let turn = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            let off = turn.to_rotation_matrix().matrix() - pose.rotation.matrix();
            assert!(off.amax() < 1e-12, "{name} {k}");
            match last {
                None => assert!(w >= 0.0, "{name}"),
                Some(last) => assert!(turn.coords.dot(&last.coords) > 0.5, "{name} {k}"),
            }
            below_zero += usize::from(w < 0.0);
            last = Some(turn);
        }
    }
    // Effectors and links turn so far that a sign by w ≥ 0 would jump.
    assert!(below_zero > 0);
    let k = times.len() / 2;
    let sample = motion.sample_at(times[k]);
    let carried = &motion.steps[sample.step].loaded;
    let pose = cell.forward_with_deflection(&sample.positions, carried).unwrap();
    let poses = frame_poses(&motion_export, "lower link 4", &table).unwrap();
    assert_eq!(poses[k], pose.base_from_link[1][3]);
    let rod = frame_poses(&motion_export, "q2", &table).unwrap()[k];
    assert_eq!(rod.translation.z, sample.positions[1]);
    let error = frame_poses(&motion_export, "uper link 1", &table).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("did you mean `upper link 1`"), "{message}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_window_has_the_bits_of_the_whole_table(
        rate in 1.0..200.0_f64, ends in (0.0..1.0_f64, 0.0..1.0_f64)
    ) {
        static PLANNED: std::sync::LazyLock<(Cell, Trajectory)> = std::sync::LazyLock::new(example_motion);
        let (cell, motion) = &*PLANNED;
        let motion_export = motion_export(cell, motion);
        let [from, to] = [ends.0.min(ends.1), ends.0.max(ends.1)].map(|part| part * motion.duration());
        let whole = options(cell, rate, &["time", "tilt", "B_x", "B_speed", "program", "poses"]);
        let window = SampleOptions { window: Some([from, to]), ..whole.clone() };
        let mut expected = samples_with(&motion_export, &whole).unwrap();
        let times = real(&expected, "time_s").to_vec();
        let first = times.partition_point(|&time| time < from);
        let last = times.partition_point(|&time| time <= to);
        for column in &mut expected {
            match &mut column.values {
                Values::Real(values) => *values = values[first..last].to_vec(),
                Values::Count(values) => *values = values[first..last].to_vec(),
            }
        }
        prop_assert_eq!(&samples_with(&motion_export, &window).unwrap(), &expected);
        let mut parts = Vec::new();
        let found = samples_in_parts(&motion_export, &window, |part| {
            parts.push(part.to_vec());
            Ok::<_, Error>(())
        });
        if first == last {
            prop_assert_eq!(found, Err(Error::NoSamples { rate, from, to }));
        } else {
            prop_assert_eq!(parts, [expected]);
        }
    }
}
