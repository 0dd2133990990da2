//! Windows of a motion: their channels compared with the poses of the cell.

use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Pose;
use jointplay_core::virtualization::{BuiltIn, Planar, Polar, Virtualization};
use jointplay_interop::export::{MotionExport, Timeline};
use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use serde_json::Value;

use crate::planned::{example, planned};

const TEXT: &str = "BLEND 20 mm\nHOME\nTRANSFER LP1 SLOT 1 TO PM1 WITH A\nTRANSFER PM1 TO LP2 SLOT 25 WITH B\nHOME\n";

fn unpacked(bytes: &[u8]) -> (Value, Vec<f64>) {
    let (length, rest) = bytes.split_at(4);
    let (text, numbers) = rest.split_at(u32::from_le_bytes(length.try_into().unwrap()) as usize);
    let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().unwrap());
    (serde_json::from_slice(text).unwrap(), numbers.chunks_exact(8).map(number).collect())
}

/// A channel at a time, by the sum of the four Hermite polynomials.
fn value(place: &Value, numbers: &[f64], time: f64) -> f64 {
    let [from, count] = [0, 1].map(|k| place[k].as_u64().unwrap() as usize);
    let part = |k: usize| &numbers[from + k * count..from + (k + 1) * count];
    let (times, values, rates) = (part(0), part(1), part(2));
    let Some(k) = times.windows(2).position(|pair| pair[0] <= time && time <= pair[1]) else {
        return if time < times[0] { values[0] } else { values[count - 1] };
    };
    let h = times[k + 1] - times[k];
    let s = (time - times[k]) / h;
    (2.0 * s.powi(3) - 3.0 * s * s + 1.0) * values[k]
        + (s.powi(3) - 2.0 * s * s + s) * h * rates[k]
        + (3.0 * s * s - 2.0 * s.powi(3)) * values[k + 1]
        + (s.powi(3) - s * s) * h * rates[k + 1]
}

fn pose(numbers: &[f64]) -> Pose {
    let [x, y, z] = [numbers[3], numbers[4], numbers[5]];
    let w = (1.0 - x * x - y * y - z * z).sqrt();
    let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    let place = Translation3::new(numbers[0], numbers[1], numbers[2]);
    Pose::from_parts(place, turn.to_rotation_matrix())
}

fn off(one: &Pose, other: &Pose) -> f64 {
    let place = (one.translation.vector - other.translation.vector).norm();
    place.max((one.rotation.matrix() - other.rotation.matrix()).norm())
}

fn check(cell: &Cell, text: &str) {
    let motion = planned(cell, text);
    let motion_export = MotionExport { cell, motion: &motion, program: text, violation_notes: &[] };
    let timeline = Timeline::new(&motion_export, &[], None).unwrap();
    let axes = cell.robot.axes.len();
    let (mut worst, mut worst_axis, mut looks) = (0_f64, 0_f64, 0);
    let (mut worst_play, mut largest) = (0_f64, 0_f64);
    for (index, window) in timeline.windows.iter().enumerate() {
        let (description, numbers) =
            unpacked(&timeline.content(&motion_export, &[], index).unwrap());
        let mut start = window.start;
        for (k, step) in description["steps"].as_array().unwrap().iter().enumerate() {
            let segment = &description["segments"][step["segment"].as_u64().unwrap() as usize];
            let duration = segment["duration_s"].as_f64().unwrap();
            let described = &motion.steps[window.steps.start + k];
            assert!((start - motion.times[window.steps.start + k]).abs() < 1e-9);
            for look in 0_u32..17 {
                // Irregular shares of the step, which are not those of keys.
                let since = duration * (f64::from(look) + 0.37 * f64::from(look % 3)) / 17.0;
                let all: Vec<f64> = segment["channels"]
                    .as_array()
                    .unwrap()
                    .iter()
                    .map(|one| {
                        value(
                            &description["channels"][one.as_u64().unwrap() as usize],
                            &numbers,
                            since,
                        )
                    })
                    .collect();
                let sample = motion.sample_at(start + since);
                if sample.step != window.steps.start + k {
                    continue;
                }
                looks += 1;
                for (one, other) in all.iter().zip(&sample.positions) {
                    worst_axis = worst_axis.max((one - other).abs());
                }
                let real =
                    cell.forward_with_deflection(&sample.positions, &described.loaded).unwrap();
                let robot = &cell.robot;
                let virtualization: &dyn Virtualization = match robot.model.virtualization {
                    BuiltIn::Polar => &Polar,
                    _ => &Planar,
                };
                let displacement = robot.gpr.displacement(&real.platform, virtualization);
                largest = largest.max(displacement);
                worst_play = worst_play.max((displacement - all.last().unwrap()).abs());
                let rigid = cell.robot.forward(&sample.positions).unwrap();
                let poses: Vec<Pose> = all[axes..].chunks_exact(6).map(pose).collect();
                worst = worst.max(off(&poses[0], &real.platform.base_from_platform));
                let (mut next, mut effector) = (1, 1 + cell.robot.arms.len());
                for (arm, links) in rigid.base_from_link.iter().enumerate() {
                    let last = links.last().unwrap();
                    worst = worst
                        .max(off(&(last * poses[next]), real.base_from_link[arm].last().unwrap()));
                    next += 1;
                    for (wafer, rigid) in
                        real.base_from_wafer[arm].iter().zip(&rigid.base_from_wafer[arm])
                    {
                        let found = last * poses[effector] * (last.inverse() * rigid);
                        worst = worst.max(off(&found, wafer));
                        effector += 1;
                    }
                }
            }
            start += duration;
        }
    }
    assert!(looks > 300, "{looks}");
    assert!(worst_axis < 1e-7 && worst < 1e-6, "{worst_axis} {worst}");
    // The displacement has a corner where the platform is level, between keys that are a millisecond apart.
    assert!(largest > 1e-6 && worst_play < 2e-8, "{largest} {worst_play}");
}

#[test]
fn channels_of_windows_follow_the_motion() {
    let mut cell = example();
    check(&cell, TEXT);
    // A platform without a closed form.
    cell.robot.model.virtualization = BuiltIn::Polar;
    check(&cell, TEXT);
}

#[test]
fn one_bit_of_a_cell_changes_the_hash_on_which_its_windows_depend() {
    let given = example().kinematics_hash();
    assert_eq!(given, example().kinematics_hash());
    let changed = |change: fn(&mut Cell)| {
        let mut cell = example();
        change(&mut cell);
        cell.kinematics_hash()
    };
    let hashes = [
        changed(|cell| cell.gravity = cell.gravity.next_up()),
        changed(|cell| cell.robot.axes[0].max = cell.robot.axes[0].max.next_up()),
        changed(|cell| cell.robot.model.virtualization = BuiltIn::Polar),
        changed(|cell| cell.wafer.thickness = cell.wafer.thickness.next_up()),
    ];
    assert!(hashes.iter().all(|hash| *hash != given), "{hashes:?}");
}
