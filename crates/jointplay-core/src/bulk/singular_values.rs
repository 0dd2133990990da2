//! Singular values of the sensitivity of many poses.

use pulp::Simd;

use crate::kernel::{Balls, Lanes, Mask, Model, Shape, Task, Three};

/// Sweeps over the three pairs of columns; four are enough for six digits more than there are.
const SWEEPS: usize = 10;
/// Columns whose cosine is below this are orthogonal.
const ORTHOGONAL: f64 = 1e-15;

/// Singular values of ∂X/∂P in the metric, the largest first; with them, where they were found.
///
/// ```text
///    C^−½ ∂X/∂P = (E C^½)† A        A Aᵀ = L Lᵀ        σ(C^−½ ∂X/∂P) = 1 / σ(C^½ Eᵀ L⁻ᵀ)
/// ```
/// E: derivative of the squared sides with respect to the virtual joints, C = W⁻¹: inverse weights of the metric, A: derivative of the squared sides with respect to the balls.
///
/// # Source
/// \[Virtualization\], eq. (3); the form is own derivation, `docs/explanation/kinematics.md`. One-sided Jacobi rotations: \[GolubVanLoan\], 8.6
#[inline(always)]
pub(super) fn sensitivity<S: Simd, M: Model>(
    task: &Task<'_>,
    balls: &Balls<S>,
    shape: &Shape<S>,
) -> (Three<S>, Mask<S>) {
    let [l_1, l_2, l_3] = balls.squares;
    let zero = l_1.like(0.0);
    // A Aᵀ in units of E: twice the squared edges, and less the products of neighbours, which follow from the third edge.
    let diagonal = [l_1 + l_1, l_2 + l_2, l_3 + l_3];
    let product = |opposite: Lanes<S>, a: Lanes<S>, b: Lanes<S>| (a + b - opposite) * 0.5;
    let (b_01, b_12, b_20) =
        (product(l_3, l_1, l_2), product(l_1, l_2, l_3), product(l_2, l_3, l_1));
    // A Aᵀ = L Lᵀ, with one over the diagonal of L.
    let i_0 = diagonal[0].sqrt().inverse();
    let (l_10, l_20) = (b_01 * i_0, b_20 * i_0);
    let i_1 = l_10.times_from(l_10, diagonal[1]).sqrt().inverse();
    let l_21 = l_10.times_from(l_20, b_12) * i_1;
    let i_2 = l_21.times_from(l_21, l_20.times_from(l_20, diagonal[2])).sqrt().inverse();

    let response = shape.response::<M>();
    let across = task.compliance.sqrt();
    let mut columns = [[zero; 6]; 3];
    for k in 0..3 {
        let before = (k + 2) % 3;
        let parts = if M::ACROSS { 2 } else { 1 };
        for part in 0..parts {
            let (mut leaving, mut arriving) =
                (-response.leaving[k][part], response.arriving[k][part]);
            if part == 1 {
                (leaving, arriving) = (leaving * across, arriving * across);
            }
            let mut e = [zero; 3];
            (e[k], e[before]) = (leaving, arriving);
            let w_0 = e[0] * i_0;
            let w_1 = l_10.times_from(w_0, e[1]) * i_1;
            let w_2 = l_21.times_from(w_1, l_20.times_from(w_0, e[2])) * i_2;
            let joint = 2 * k + part;
            (columns[0][joint], columns[1][joint], columns[2][joint]) = (w_0, w_1, w_2);
        }
    }
    let mut orthogonal = zero.below(zero);
    for _ in 0..SWEEPS {
        orthogonal = zero.at_most(zero);
        for (p, q) in [(0, 1), (1, 2), (2, 0)] {
            let already = rotate(&mut columns, p, q);
            orthogonal = orthogonal & already;
        }
        if orthogonal.all() {
            break;
        }
    }
    let mut values = [zero; 3];
    for (value, column) in values.iter_mut().zip(&columns) {
        *value = dot(column, column).sqrt().inverse();
    }
    let [a, b, c] = values;
    let (a, b) = (a.max(b), a.min(b));
    let (b, c) = (b.max(c), b.min(c));
    ([a.max(b), a.min(b), c], orthogonal)
}

#[inline(always)]
fn dot<S: Simd>(a: &[Lanes<S>; 6], b: &[Lanes<S>; 6]) -> Lanes<S> {
    let mut sum = a[0] * b[0];
    for (a, b) in a[1..].iter().zip(&b[1..]) {
        sum = a.times_plus(*b, sum);
    }
    sum
}

/// Makes two columns orthogonal; returns where they already were, and leaves those unchanged.
#[inline(always)]
fn rotate<S: Simd>(columns: &mut [[Lanes<S>; 6]; 3], p: usize, q: usize) -> Mask<S> {
    let (pp, qq) = (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]));
    let pq = dot(&columns[p], &columns[q]);
    let one = pp.like(1.0);
    let already = pq.squared().at_most(pp * qq * (ORTHOGONAL * ORTHOGONAL));
    // tan = sign(ζ)/(|ζ| + √(1 + ζ²)), ζ = (qq − pp)/(2 pq).
    let zeta = (qq - pp) / already.select(one, pq + pq);
    let root = zeta.times_plus(zeta, one).sqrt();
    let tangent = zeta.below(pp.like(0.0)).select(-one, one) / (zeta.abs() + root);
    let cosine = tangent.times_plus(tangent, one).sqrt().inverse();
    let sine = already.select(pp.like(0.0), cosine * tangent);
    let cosine = already.select(one, cosine);
    let [of_p, of_q] = [columns[p], columns[q]];
    for (joint, (x, y)) in of_p.into_iter().zip(of_q).enumerate() {
        columns[p][joint] = sine.times_from(y, cosine * x);
        columns[q][joint] = sine.times_plus(x, cosine * y);
    }
    already
}
