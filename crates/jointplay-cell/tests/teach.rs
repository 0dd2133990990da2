//! The uncertainty of taught frames against many simulated teachings with random noise.

use jointplay_cell::station::teach::{
    CarrierAxis, FrameUncertainty, NominalFrame, PlaneFit, ReferencePoint, StatedUncertainty,
    TaughtFrame, carrier_axis, fit_plane, fit_references, frame,
};
use jointplay_core::spatial::{Pose, Tilt, heading, rotation_vector};
use nalgebra::{Point3, Vector2, Vector3, Vector6};
use proptest::prelude::RngExt;
use proptest::test_runner::{RngAlgorithm, TestRng};

fn plane(tilt: Tilt, places: &[(f64, f64)]) -> Vec<Vector3<f64>> {
    let frame = frame(Vector3::new(0.7, -0.2, 0.9), &tilt.normal(), 0.4);
    let point =
        |&(x, y): &(f64, f64)| frame.rotation * Vector3::new(x, y, 0.0) + frame.translation.vector;
    places.iter().map(point).collect()
}

/// Normally distributed numbers of mean 0 and deviation 1, the same in each run.
fn normals() -> impl FnMut() -> f64 {
    let mut generator = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    let mut uniform = move || generator.random::<f64>();
    move || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

#[test]
fn plane_uncertainty_agrees_with_simulated_teachings() {
    // Points on the axes at 120 mm, and six that are far apart in one direction and close in the other.
    let cross = [(0.12, 0.0), (0.0, 0.12), (-0.12, 0.0), (0.0, -0.12)];
    let long = [(0.2, 0.02), (0.1, -0.02), (0.0, 0.02), (0.0, -0.02), (-0.1, 0.02), (-0.2, -0.02)];
    let (noise, draws) = (20e-6, 4000_u32);
    let tilt = Tilt { azimuth: 0.7, angle: 0.01 };
    let mut normal = normals();
    for (places, expected_rms) in [(&cross[..], 166.7e-6), (&long[..], 427.6e-6)] {
        let exact = plane(tilt, places);
        let asked = Vector3::new(0.9, 0.1, 0.0);
        let true_height = |fit: &PlaneFit| {
            let on = fit.frame(&asked, 0.0).translation.vector;
            (on - exact[0]).dot(&tilt.normal())
        };
        let (mut squares, mut within, mut heights, mut estimated) =
            (0.0, 0_usize, 0_usize, 0_usize);
        let mut bounds = [0.0; 2];
        for draw in 0..draws {
            let taught: Vec<_> = exact
                .iter()
                .map(|point| point + Vector3::from_fn(|_, _| noise * normal()))
                .collect();
            let fit = fit_plane(&taught, 1e-3, Some(&vec![noise; places.len()])).unwrap();
            let known = fit.uncertainty.clone().unwrap();
            let off = fit.normal.cross(&tilt.normal()).norm();
            squares += off * off;
            within += usize::from(off <= known.tilt_95);
            let on = fit.frame(&asked, 0.0).translation.vector;
            heights += usize::from(true_height(&fit).abs() <= known.height_95(&on));
            bounds = [known.tilt(), known.tilt_95];
            if draw % 4 == 0 {
                let guessed = fit_plane(&taught, 1e-3, None).unwrap().uncertainty.unwrap();
                assert!(guessed.is_estimated);
                estimated += 4 * usize::from(off <= guessed.tilt_95);
            }
        }
        let rms = (squares / f64::from(draws)).sqrt();
        assert!((rms / expected_rms - 1.0).abs() < 0.03, "{rms}");
        assert!((bounds[0] / rms - 1.0).abs() < 0.03, "{bounds:?} {rms}");
        let fraction = |count: usize| count as f64 / f64::from(draws);
        assert!((fraction(within) - 0.95).abs() < 0.012, "{}", fraction(within));
        assert!((fraction(heights) - 0.95).abs() < 0.012, "{}", fraction(heights));
        // Estimated from the distances alone, the bound holds at least as often.
        assert!((0.93..=1.0).contains(&fraction(estimated)), "{}", fraction(estimated));
    }
}

/// Displacement of the true frame from a taught one, in the taught frame.
fn displacement(taught: &Pose, truth: &Pose) -> Vector6<f64> {
    let difference = taught.inverse() * truth;
    let shift = difference.translation.vector;
    let turn = rotation_vector(&difference.rotation);
    Vector6::new(shift.x, shift.y, shift.z, turn.x, turn.y, turn.z)
}

/// A station that is taught with points of different noise, and reference points at some height over its plane.
struct Teaching {
    truth: Pose,
    nominal: NominalFrame,
    places: Vec<(f64, f64)>,
    references: Vec<(f64, f64, f64)>,
    noise: Vec<f64>,
    reference_noise: Vec<f64>,
}

impl Teaching {
    fn new() -> Self {
        let normal = Tilt { azimuth: 0.7, angle: 0.012 }.normal();
        let truth = frame(Vector3::new(0.7, -0.2, 0.9), &normal, 0.4);
        Self {
            truth,
            nominal: NominalFrame {
                origin: Vector3::new(0.7012, -0.2007, 0.901),
                heading: 0.402,
                normal: Vector3::z(),
            },
            places: vec![(0.12, 0.01), (0.03, 0.11), (-0.1, 0.05), (-0.06, -0.1), (0.09, -0.08)],
            references: vec![(0.0, 0.0, 0.03), (0.14, 0.02, 0.05), (-0.08, 0.1, 0.01)],
            noise: vec![20e-6, 10e-6, 20e-6, 40e-6, 15e-6],
            reference_noise: vec![15e-6, 30e-6, 20e-6],
        }
    }

    /// Teaches the station once.
    fn teach(&self, normal: &mut impl FnMut() -> f64, is_noise_given: bool) -> TaughtFrame {
        let mut measured = |place: Vector3<f64>, noise: f64| {
            let error = Vector3::from_fn(|_, _| noise * normal());
            (self.truth * Point3::from(place)).coords + error
        };
        let points = self.places.iter().zip(&self.noise);
        let points: Vec<_> =
            points.map(|(&(x, y), &noise)| measured(Vector3::new(x, y, 0.0), noise)).collect();
        let references = self.references.iter().zip(&self.reference_noise);
        let references: Vec<_> = references
            .map(|(&(x, y, z), &noise)| ReferencePoint {
                nominal: Vector2::new(x, y),
                measured: measured(Vector3::new(x, y, z), noise),
            })
            .collect();
        let given = |noise: &[f64]| is_noise_given.then(|| noise.to_vec());
        let plane = fit_plane(&points, 1e-3, given(&self.noise).as_deref())
            .expect("the points define a plane");
        let in_plane = self.nominal.in_plane(Some(&plane));
        let noise = given(&self.reference_noise);
        let references = fit_references(&in_plane, &references, 1e-3, noise.as_deref())
            .expect("the references define a frame");
        TaughtFrame { plane: Some(plane), references: Some(references) }
    }
}

#[test]
fn two_hundred_teaches_cover_the_true_frame_in_95_percent() {
    let teaching = Teaching::new();
    let mut normal = normals();
    // 95 % quantiles of chi-square with 6 and 3 degrees of freedom, and of the absolute value of a normal number.
    let (of_frame, of_slot, of_one) = (12.592, 7.815, 1.959_964);
    let slot = Vector3::new(0.0, 0.0, 0.24);
    // Batches of 200 teaches; each share scatters by 1.5 % around 95 %.
    let (batches, draws) = (25_u32, 200_u32);
    let (mut total, mut within) = ([0_u32; 4], [0_u32; 4]);
    for _ in 0..batches {
        let mut covered = [0_u32; 4];
        for _ in 0..draws {
            let taught = teaching.teach(&mut normal, true);
            let found = taught.frame(&teaching.nominal);
            let known = taught.uncertainty(&found);
            assert_eq!(known.known, [true; 6]);
            let error = displacement(&found, &teaching.truth);
            let weighted = known.covariance.try_inverse().unwrap() * error;
            covered[0] += u32::from(error.dot(&weighted) <= of_frame);
            let at_slot = (teaching.truth * Point3::from(slot)) - (found * Point3::from(slot));
            let at_slot = found.rotation.inverse() * at_slot;
            let covariance = known.displacement_covariance(&slot);
            let weighted = covariance.try_inverse().unwrap() * at_slot;
            covered[1] += u32::from(at_slot.dot(&weighted) <= of_slot);
            let [sideways, height] =
                [0, 2].map(|axis| at_slot[axis].abs() / covariance[(axis, axis)].sqrt());
            covered[2] += u32::from(sideways <= of_one);
            covered[3] += u32::from(height <= of_one);
        }
        for k in 0..4 {
            total[k] += covered[k];
            within[k] += u32::from(covered[k].abs_diff(190) <= 4);
        }
    }
    // The whole frame, the wafer in slot 25, its position across, and its height.
    for (total, within) in total.into_iter().zip(within) {
        let share = f64::from(total) / f64::from(batches * draws);
        assert!((share - 0.95).abs() <= 0.01, "{share}");
        // 186 to 194 of 200 are expected in 82 % of the batches.
        assert!(within >= 16, "{within}");
    }
}

#[test]
fn exact_points_give_the_true_frame() {
    let mut teaching = Teaching::new();
    let taught = teaching.teach(&mut || 0.0, true);
    let error = displacement(&taught.frame(&teaching.nominal), &teaching.truth);
    assert!(error.norm() < 1e-14, "{error}");
    // One reference leaves the heading nominal, and determines the centre.
    teaching.references.truncate(1);
    teaching.reference_noise.truncate(1);
    let taught = teaching.teach(&mut || 0.0, true);
    let found = taught.frame(&teaching.nominal);
    assert!((heading(&found) - 0.402).abs() < 1e-14);
    assert!((found.translation.vector - teaching.truth.translation.vector).norm() < 1e-14);
    let known = taught.uncertainty(&found);
    assert_eq!(known.known, [true, true, true, true, true, false]);
    let stated = StatedUncertainty { heading: Some(1e-4), ..StatedUncertainty::default() };
    let known = known.or_stated(&stated);
    assert!(known.known[5] && (known.covariance[(5, 5)] - 1e-8).abs() < 1e-22);
}

#[test]
fn carrier_axis_uncertainty_agrees_with_simulated_teachings() {
    let (noise, draws, mut normal) = (30e-6, 4000, normals());
    let truth = Tilt { azimuth: 2.1, angle: 0.01 };
    let first = Vector3::new(0.6, 0.1, 0.5);
    let last = first + truth.normal() * 0.24;
    let base_from_station = frame(first, &truth.normal(), 0.3);
    let mut covered = 0;
    for _ in 0..draws {
        let mut noisy = |point: Vector3<f64>| point + Vector3::from_fn(|_, _| noise * normal());
        let found: CarrierAxis = carrier_axis(noisy(first), noisy(last), 25, Some(noise)).unwrap();
        let known: FrameUncertainty = found.uncertainty();
        let taught = frame(found.first, &found.tilt.normal(), 0.3);
        let error = displacement(&taught, &base_from_station);
        let five = error.fixed_rows::<5>(0).into_owned();
        let covariance = known.covariance.fixed_view::<5, 5>(0, 0).into_owned();
        let weighted = covariance.try_inverse().unwrap() * five;
        covered += i32::from(five.dot(&weighted) <= 11.070);
    }
    let share = f64::from(covered) / f64::from(draws);
    assert!((share - 0.95).abs() < 0.012, "{share}");
}
