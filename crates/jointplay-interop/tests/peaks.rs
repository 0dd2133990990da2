//! Samples whose linear interpolation is the motion.

use jointplay_interop::export::{MotionExport, SampleOptions, samples, samples_with};
use jointplay_report::table::{Column, Values};

use crate::planned::{example, planned};

const PROGRAM: &str = "HOME\nBLEND 5 mm\nTRANSFER LP1 SLOT 1 TO PM1 WITH A\nMOVE T 0.5 deg\n";

fn values<'c>(columns: &'c [Column], name: &str) -> &'c [f64] {
    let column = columns.iter().find(|column| column.name == name).unwrap();
    let Values::Real(values) = &column.values else { panic!("{name} is not real") };
    values
}

/// Linear interpolation between the samples before and after a time.
fn drawn(times: &[f64], values: &[f64], time: f64) -> f64 {
    let k = times.partition_point(|&at| at <= time).clamp(1, times.len() - 1);
    let share = (time - times[k - 1]) / (times[k] - times[k - 1]);
    values[k - 1] + share * (values[k] - values[k - 1])
}

#[test]
fn lines_between_samples_with_peaks_are_the_motion() {
    let cell = example();
    let motion = planned(&cell, PROGRAM);
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: PROGRAM, violation_notes: &[] };
    let even = samples(&motion_export, 25.0).unwrap();
    let found = samples_with(
        &motion_export,
        &SampleOptions { peaks: true, ..SampleOptions::at_rate(25.0) },
    )
    .unwrap();
    let fine = samples(&motion_export, 5000.0).unwrap();
    let (times, fine_times) = (values(&found, "time_s"), values(&fine, "time_s"));
    assert!(times.windows(2).all(|pair| pair[1] - pair[0] > 1e-9));
    assert_eq!((times[0], times.last()), (0.0, fine_times.last()));
    for time in values(&even, "time_s").iter().chain(&motion.times) {
        assert!(times.iter().any(|at| (at - time).abs() < 1e-9), "{time}");
    }
    // A few times as many as at equal intervals, and fewer than at 1000 Hz.
    let many = times.len() as f64 / motion.duration();
    assert!(many < 250.0, "{many} a second");
    let (mut cut, even_times) = (0.0_f64, values(&even, "time_s"));
    for axis in &cell.robot.axes {
        let turns = axis.kind == jointplay_cell::robot::AxisKind::Rotary;
        let (unit, factor) = if turns { ("deg", f64::to_degrees(1.0)) } else { ("mm", 1e3) };
        let limits = [("_per_s", axis.empty.velocity), ("_per_s2", axis.empty.acceleration)];
        for (rate, limit) in limits.map(|(rate, limit)| (rate, limit * factor)) {
            let name = format!("{}_{unit}{rate}", axis.name);
            let (here, exact) = (values(&found, &name), values(&fine, &name));
            let most =
                |values: &[f64]| values.iter().fold(0.0_f64, |most, one| most.max(one.abs()));
            assert!(most(exact) - most(here) < 3e-3 * limit, "{name}: the peak is cut");
            let plain = values(&even, &name);
            for (&time, &value) in fine_times.iter().zip(exact) {
                let off = (drawn(times, here, time) - value).abs() / limit;
                assert!(off < 0.01, "{name} at {time}: {off} of the limit off");
                cut = cut.max((drawn(even_times, plain, time) - value).abs() / limit);
            }
        }
    }
    // Samples at equal intervals alone miss the peaks.
    assert!(cut > 0.15, "{cut}");
}
