//! The paper's own equations as code, as printed and put right, and its iteration.
//!
//! Formulas are written as the paper writes them, with indices 1, 2, 3 → 0, 1, 2 and SI units; nothing here calls the library's models.

use jointplay::linalg::least_norm_of_three;
use jointplay::virtualization::Sides;
use nalgebra::{Vector2, Vector3};

/// X of the extended models: three lengths (m), then three angles (rad).
pub type X = [f64; 6];

/// The rows of ∂F/∂X as the paper prints it, one for each entry of X, each with F_12, F_23, F_31.
pub type FByX = [Vector3<f64>; 6];

/// How the third column of ∂F/∂X in V.A, the one of L_31, is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThirdColumn {
    /// To the letter.
    Printed,
    /// The entries of φ_1 and φ_3 put right, those of l_1 and l_3 as printed.
    SignsRight,
    /// The entries of l_1 and l_3 put right, those of φ_1 and φ_3 as printed.
    LengthsRight,
    /// Both put right.
    Right,
}

const TURN: f64 = 2.0 * std::f64::consts::FRAC_PI_3;

/// The virtual sides of V.A: √(l_i² + l_j² − 2 l_i l_j cos(120° − φ_i + φ_j)) (m).
///
/// # Source
/// \[Virtualization\], V.A, first equation
#[must_use]
pub fn polar_sides(x: &X) -> Sides {
    [0, 1, 2].map(|i| {
        let j = (i + 1) % 3;
        let angle = TURN - x[3 + i] + x[3 + j];
        (x[i] * x[i] + x[j] * x[j] - 2.0 * x[i] * x[j] * angle.cos()).sqrt()
    })
}

/// ∂F/∂X of V.A.
///
/// # Source
/// \[Virtualization\], V.A, the 6×3 matrix before its transposition
#[must_use]
pub fn polar_by_x(x: &X, third: ThirdColumn) -> FByX {
    let [l_1, l_2, l_3, phi_1, phi_2, phi_3] = *x;
    let (s_12, c_12) = (TURN - phi_1 + phi_2).sin_cos();
    let (s_23, c_23) = (TURN - phi_2 + phi_3).sin_cos();
    let (s_31, c_31) = (TURN - phi_3 + phi_1).sin_cos();
    let printed = (2.0 * l_3 - 2.0 * l_1 * c_31, 2.0 * l_1 - 2.0 * l_3 * c_31);
    let (by_l_1, by_l_3) = match third {
        ThirdColumn::Printed | ThirdColumn::SignsRight => printed,
        ThirdColumn::LengthsRight | ThirdColumn::Right => (printed.1, printed.0),
    };
    let printed = (-2.0 * l_3 * l_1 * s_31, 2.0 * l_3 * l_1 * s_31);
    let (by_phi_1, by_phi_3) = match third {
        ThirdColumn::Printed | ThirdColumn::LengthsRight => printed,
        ThirdColumn::SignsRight | ThirdColumn::Right => (printed.1, printed.0),
    };
    [
        Vector3::new(2.0 * l_1 - 2.0 * l_2 * c_12, 0.0, by_l_1),
        Vector3::new(2.0 * l_2 - 2.0 * l_1 * c_12, 2.0 * l_2 - 2.0 * l_3 * c_23, 0.0),
        Vector3::new(0.0, 2.0 * l_3 - 2.0 * l_2 * c_23, by_l_3),
        Vector3::new(-2.0 * l_1 * l_2 * s_12, 0.0, by_phi_1),
        Vector3::new(2.0 * l_1 * l_2 * s_12, -2.0 * l_2 * l_3 * s_23, 0.0),
        Vector3::new(0.0, 2.0 * l_2 * l_3 * s_23, by_phi_3),
    ]
}

/// The points r_1, r_2, r_3 of V.B as printed: the first component of r_3 has dφ_2 (m).
///
/// # Source
/// \[Virtualization\], V.B
#[must_use]
pub fn offset_points_printed(radius: f64, x: &X) -> [Vector2<f64>; 3] {
    let [dr_1, dr_2, dr_3, dphi_1, dphi_2, dphi_3] = *x;
    [
        Vector2::new(radius + dr_1 * dphi_1.cos(), dr_1 * dphi_1.sin()),
        Vector2::new(
            radius * TURN.cos() + dr_2 * (TURN + dphi_2).cos(),
            radius * TURN.sin() + dr_2 * (TURN + dphi_2).sin(),
        ),
        Vector2::new(
            radius * (2.0 * TURN).cos() + dr_3 * (2.0 * TURN + dphi_2).cos(),
            radius * (2.0 * TURN).sin() + dr_3 * (2.0 * TURN + dphi_3).sin(),
        ),
    ]
}

/// The same with dφ_3 in r_3 (m).
#[must_use]
pub fn offset_points_right(radius: f64, x: &X) -> [Vector2<f64>; 3] {
    let mut points = offset_points_printed(radius, x);
    points[2].x = radius * (2.0 * TURN).cos() + x[2] * (2.0 * TURN + x[5]).cos();
    points
}

/// Where ∂F/∂L = −2 diag(L) of (7) is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByL {
    /// At the current L(X), as (8) reads: a step on the lengths.
    Letter,
    /// Midway between L(X) and L: a step on their squares.
    Midpoint,
}

/// One step of the iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// X after the step ((m), (rad)).
    pub x: X,
    /// Largest difference between a side and its virtual length there (m).
    pub residual: f64,
}

/// The paper's iteration X_k = X_{k−1} + ∂X/∂L (L − L_{k−1}); the first entry is the start.
///
/// Stops early where X is no longer finite or no step exists.
///
/// # Arguments
/// * `rho` – ρ of the metric, 1 mm in the paper (m)
///
/// # Source
/// \[Virtualization\], IV.B and eq. (8)
#[must_use]
pub fn iterate(
    third: ThirdColumn,
    by_l: ByL,
    start: X,
    sides: &Sides,
    rho: f64,
    steps: usize,
) -> Vec<Step> {
    let turn = 1.0 / (rho * rho);
    let compliance = [1.0, 1.0, 1.0, turn, turn, turn];
    let residual = |x: &X| {
        let found = polar_sides(x);
        (0..3).map(|k| (sides[k] - found[k]).abs()).fold(0.0, f64::max)
    };
    let mut done = vec![Step { x: start, residual: residual(&start) }];
    let mut x = start;
    for _ in 0..steps {
        let now = polar_sides(&x);
        let target = Vector3::from([0, 1, 2].map(|k| {
            let l = match by_l {
                ByL::Letter => 2.0 * now[k],
                ByL::Midpoint => now[k] + sides[k],
            };
            l * (sides[k] - now[k])
        }));
        let mut step = X::default();
        if !least_norm_of_three(&polar_by_x(&x, third), &compliance, &target, &mut step) {
            break;
        }
        for (value, change) in x.iter_mut().zip(step) {
            *value += change;
        }
        if !residual(&x).is_finite() {
            break;
        }
        done.push(Step { x, residual: residual(&x) });
    }
    done
}
