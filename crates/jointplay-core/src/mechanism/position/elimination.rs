//! One step towards closed loops: passive joints eliminated, virtual joints by least norm.

use crate::mechanism::ReliefSolver;

/// Columns of which elimination leaves no more than this share are combinations of those before them.
const DEPENDENT: f64 = 1e-9;
/// Equations between virtual joints that are combinations of others: the share is squared in a product of the matrix with itself.
const DEPENDENT_SQUARED: f64 = 1e-14;

/// Linear equations of a step, and room for their solution.
///
/// ```text
///    A_p δp  +  A_y δy  =  −r        least |δy|, or least |y + δy|
///   (m,n)      (m,M)      (m)
/// ```
#[derive(Debug, Clone)]
pub(super) struct Elimination {
    rows: usize,
    passive: usize,
    virtuals: usize,
    /// (rows, passive + virtuals + 1) by columns, −r last.
    pub(super) matrix: Vec<f64>,
    /// (passive + virtuals) the step.
    pub(super) step: Vec<f64>,
    /// Which passive column stands where.
    order: Vec<usize>,
    /// (rows, rows) lower triangle of what virtual joints can do about what is open.
    gram: Vec<f64>,
    /// (rows) multipliers.
    multipliers: Vec<f64>,
}

impl Elimination {
    pub(super) fn new(rows: usize, passive: usize, virtuals: usize) -> Self {
        Self {
            rows,
            passive,
            virtuals,
            matrix: vec![0.0; rows * (passive + virtuals + 1)],
            step: vec![0.0; passive + virtuals],
            order: vec![0; passive],
            gram: vec![0.0; rows * rows],
            multipliers: vec![0.0; rows],
        }
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Solves for the step; `y` are the virtual joints in their metric.
    pub(super) fn solve(&mut self, y: &[f64], solver: ReliefSolver) {
        let rank = self.triangulate();
        self.step.fill(0.0);
        if self.virtuals > 0 {
            self.relieve(rank, y, solver);
        }
        // What the virtual joints leave to the passive ones.
        let (m, right) = (self.rows, self.passive + self.virtuals);
        for v in 0..self.virtuals {
            let step = self.step[self.passive + v];
            for row in 0..rank {
                self.matrix[right * m + row] -= self.matrix[(self.passive + v) * m + row] * step;
            }
        }
        for k in (0..rank).rev() {
            let value = self.matrix[right * m + k] / self.matrix[k * m + k];
            self.step[self.order[k]] = value;
            for row in 0..k {
                self.matrix[right * m + row] -= self.matrix[k * m + row] * value;
            }
        }
    }

    /// Reflects the passive columns to a triangle, the longest first, and all others along; returns their rank.
    fn triangulate(&mut self) -> usize {
        let (m, n) = (self.rows, self.passive);
        let columns = n + self.virtuals + 1;
        for (k, place) in self.order.iter_mut().enumerate() {
            *place = k;
        }
        let mut largest = 0.0;
        for k in 0..n.min(m) {
            let (mut best, mut best_square) = (k, -1.0);
            for column in k..n {
                let below = &self.matrix[column * m + k..(column + 1) * m];
                let square = below.iter().map(|value| value * value).sum::<f64>();
                if square > best_square {
                    (best, best_square) = (column, square);
                }
            }
            let norm = best_square.sqrt();
            if k == 0 {
                largest = norm;
            }
            if norm <= DEPENDENT * largest || norm.is_nan() {
                return k;
            }
            if best != k {
                let (left, right) = self.matrix.split_at_mut(best * m);
                left[k * m..(k + 1) * m].swap_with_slice(&mut right[..m]);
                self.order.swap(k, best);
            }
            let (left, right) = self.matrix.split_at_mut((k + 1) * m);
            let mirror = &mut left[k * m + k..];
            let head = mirror[0];
            let onto = -norm.copysign(head);
            mirror[0] = head - onto;
            let scale = 1.0 / (norm * (norm + head.abs()));
            for column in right[..(columns - k - 1) * m].chunks_exact_mut(m) {
                let below = &mut column[k..];
                let dot: f64 = mirror.iter().zip(below.iter()).map(|(a, b)| a * b).sum();
                for (value, normal) in below.iter_mut().zip(mirror.iter()) {
                    *value -= scale * dot * normal;
                }
            }
            mirror[0] = onto;
        }
        n.min(m)
    }

    /// The least virtual displacements that meet the equations which no passive joint can.
    fn relieve(&mut self, rank: usize, y: &[f64], solver: ReliefSolver) {
        let (m, n) = (self.rows, self.passive);
        let open = m - rank;
        let least_norm = solver == ReliefSolver::LeastNorm;
        let virtual_part = &self.matrix[n * m..];
        let (virtual_part, right) = virtual_part.split_at(self.virtuals * m);
        self.multipliers[..open].copy_from_slice(&right[rank..m]);
        self.gram[..open * open].fill(0.0);
        for (column, &value) in virtual_part.chunks_exact(m).zip(y) {
            let below = &column[rank..];
            for (i, &a) in below.iter().enumerate() {
                if least_norm {
                    self.multipliers[i] += a * value;
                }
                for (j, &b) in below[..=i].iter().enumerate() {
                    self.gram[i * open + j] += a * b;
                }
            }
        }
        solve_symmetric(&mut self.gram[..open * open], &mut self.multipliers[..open]);
        for ((column, &value), step) in virtual_part.chunks_exact(m).zip(y).zip(&mut self.step[n..])
        {
            let reached: f64 =
                column[rank..].iter().zip(&self.multipliers).map(|(a, b)| a * b).sum();
            *step = if least_norm { reached - value } else { reached };
        }
    }
}

/// Solves G x = b in place by L D Lᵀ of a matrix with no negative direction; equations that depend on those before them are left out.
///
/// `gram` holds the lower triangle by rows.
fn solve_symmetric(gram: &mut [f64], b: &mut [f64]) {
    let n = b.len();
    let largest = (0..n).map(|k| gram[k * n + k]).fold(0.0, f64::max);
    for i in 0..n {
        for j in 0..=i {
            let mut sum = gram[i * n + j];
            for k in 0..j {
                sum -= gram[i * n + k] * gram[j * n + k] * gram[k * n + k];
            }
            let pivot = gram[j * n + j];
            gram[i * n + j] = if i == j {
                if sum > DEPENDENT_SQUARED * largest { sum } else { 0.0 }
            } else if pivot > 0.0 {
                sum / pivot
            } else {
                0.0
            };
        }
    }
    for i in 0..n {
        for k in 0..i {
            b[i] -= gram[i * n + k] * b[k];
        }
    }
    for i in 0..n {
        let pivot = gram[i * n + i];
        b[i] = if pivot > 0.0 { b[i] / pivot } else { 0.0 };
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= gram[k * n + i] * b[k];
        }
    }
}
