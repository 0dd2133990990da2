//! The uncertainty of taught planes against many simulated teachings with random noise.

use jointplay_cell::station::teach::{PlaneFit, fit_plane, frame};
use jointplay_core::spatial::Tilt;
use nalgebra::Vector3;

fn plane(tilt: Tilt, places: &[(f64, f64)]) -> Vec<Vector3<f64>> {
    let frame = frame(Vector3::new(0.7, -0.2, 0.9), &tilt.normal(), 0.4);
    let point =
        |&(x, y): &(f64, f64)| frame.rotation * Vector3::new(x, y, 0.0) + frame.translation.vector;
    places.iter().map(point).collect()
}

/// Normally distributed numbers of mean 0 and deviation 1, the same in each run.
fn normals() -> impl FnMut() -> f64 {
    let mut state = 7_u64;
    let mut uniform = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    move || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

#[test]
fn plane_uncertainty_agrees_with_simulated_teachings() {
    // Points on the axes at 120 mm, and six that are far apart in one direction and close in the other.
    let cross = [(0.12, 0.0), (0.0, 0.12), (-0.12, 0.0), (0.0, -0.12)];
    let long = [(0.2, 0.02), (0.1, -0.02), (0.0, 0.02), (0.0, -0.02), (-0.1, 0.02), (-0.2, -0.02)];
    let (noise, draws) = (20e-6, 4000_u32);
    let tilt = Tilt { yaw: 0.7, pitch: 0.01 };
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
            let fit = fit_plane(&taught, 1e-3, Some(noise)).unwrap();
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
