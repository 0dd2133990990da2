//! One step towards closed loops: passive joints eliminated, virtual joints by least norm.

use crate::mechanism::ReliefSolver;

/// Columns of which elimination leaves no more than this share are combinations of those before them.
pub(super) const DEPENDENT: f64 = 1e-9;
/// Columns of which elimination leaves this share of the longest are taken as they come, without a search for longer ones.
pub(super) const LONG_ENOUGH: f64 = 0.05;
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
    /// (rows, passive + virtuals) by columns: the equations, and once factored the triangle with its mirrors below.
    pub(super) matrix: Vec<f64>,
    /// (rows) −r.
    pub(super) right: Vec<f64>,
    /// (passive + virtuals) the step.
    step: Vec<f64>,
    /// Passive column at each position.
    order: Vec<usize>,
    /// First entry of each mirror, which the triangle leaves no room for, and twice the inverse of its square.
    mirrors: Vec<[f64; 2]>,
    /// How many passive columns are independent.
    rank: usize,
    /// (rows, rows) factor of what virtual joints can do about what is open: L, and D on its diagonal, by rows.
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
            matrix: vec![0.0; rows * (passive + virtuals)],
            right: vec![0.0; rows],
            step: vec![0.0; passive + virtuals],
            order: vec![0; passive],
            mirrors: vec![[0.0; 2]; passive],
            rank: 0,
            gram: vec![0.0; rows * rows],
            multipliers: vec![0.0; rows],
        }
    }

    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    pub(super) fn virtuals(&self) -> usize {
        self.virtuals
    }

    /// (passive + virtuals) the step found last.
    pub(super) fn step(&self) -> &[f64] {
        &self.step[..self.passive + self.virtuals]
    }

    /// Passive column at each position, and how many of them are independent.
    pub(super) fn elimination_order(&self) -> (&[usize], usize) {
        (&self.order[..self.passive], self.rank.min(self.passive))
    }

    /// Fewer equations and passive columns than there is room for.
    pub(super) fn resize(&mut self, rows: usize, passive: usize) {
        (self.rows, self.passive) = (rows, passive);
    }

    /// Reflects the passive columns to a triangle, and all other columns along; returns their rank.
    pub(super) fn reflect_columns(&mut self) -> usize {
        // The usual sizes, as in `factor`.
        self.rank = match self.rows {
            3 => self.triangulate(3, 0.0),
            5 => self.triangulate(5, 0.0),
            6 => self.triangulate(6, 0.0),
            15 => self.triangulate(15, 0.0),
            m => self.triangulate(m, 0.0),
        };
        self.rank
    }

    /// Qᵀ v in place: a right-hand side as reflected with the columns.
    pub(super) fn reflect_right(&self, vector: &mut [f64]) {
        (0..self.rank).for_each(|k| self.mirror(k, vector));
    }

    /// Reflects a vector by the mirror of a column.
    fn mirror(&self, k: usize, vector: &mut [f64]) {
        let below = &self.matrix[k * self.rows + k + 1..(k + 1) * self.rows];
        let [head, scale] = self.mirrors[k];
        let (first, rest) = vector[k..].split_at_mut(1);
        let dot = head * first[0] + below.iter().zip(&*rest).map(|(a, b)| a * b).sum::<f64>();
        first[0] -= scale * dot * head;
        rest.iter_mut().zip(below).for_each(|(value, a)| *value -= scale * dot * a);
    }

    /// Solves for the passive columns, with zero for those that depend on others.
    ///
    /// # Arguments
    /// * `right` – (rows) reflected; used up
    /// * `step` – (passive) takes the solution
    pub(super) fn substitute(&self, right: &mut [f64], step: &mut [f64]) {
        step.fill(0.0);
        for k in (0..self.rank).rev() {
            let column = &self.matrix[k * self.rows..(k + 1) * self.rows];
            let value = right[k] / column[k];
            step[self.order[k]] = value;
            right[..k].iter_mut().zip(column).for_each(|(entry, a)| *entry -= a * value);
        }
    }

    /// The motion of the passive columns that leaves all equations as they are and moves one dependent column by 1.
    ///
    /// # Arguments
    /// * `dependent` – index among the columns beyond the rank
    /// * `room` – (rows)
    /// * `motion` – (passive) takes the motion
    pub(super) fn null_vector(&self, dependent: usize, room: &mut [f64], motion: &mut [f64]) {
        let k = self.rank + dependent;
        let column = &self.matrix[k * self.rows..(k + 1) * self.rows];
        room.iter_mut().zip(column).for_each(|(entry, a)| *entry = -a);
        self.substitute(room, motion);
        motion[self.order[k]] = 1.0;
    }

    /// The multipliers λ of least norm with A_pᵀ λ = load in the independent columns.
    ///
    /// # Arguments
    /// * `load` – (passive)
    /// * `multipliers` – (rows) takes λ
    pub(super) fn multipliers(&self, load: &[f64], multipliers: &mut [f64]) {
        multipliers.fill(0.0);
        for k in 0..self.rank {
            let column = &self.matrix[k * self.rows..k * self.rows + k];
            let known: f64 = column.iter().zip(&*multipliers).map(|(a, b)| a * b).sum();
            multipliers[k] = (load[self.order[k]] - known) / self.matrix[k * self.rows + k];
        }
        (0..self.rank).rev().for_each(|k| self.mirror(k, multipliers));
    }

    /// Factors the equations in `matrix`.
    ///
    /// # Arguments
    /// * `largest` – length of the longest column of which these are what is left
    pub(super) fn factor(&mut self, largest: f64) {
        // The usual sizes get code of their own.
        match self.rows {
            2 => self.factor_rows(2, largest),
            3 => self.factor_rows(3, largest),
            4 => self.factor_rows(4, largest),
            5 => self.factor_rows(5, largest),
            6 => self.factor_rows(6, largest),
            m => self.factor_rows(m, largest),
        }
    }

    #[inline(always)]
    fn factor_rows(&mut self, m: usize, largest: f64) {
        self.rank = self.triangulate(m, largest);
        let (rank, open) = (self.rank, m - self.rank);
        if self.virtuals == 0 || open == 0 {
            return;
        }
        let gram = &mut self.gram[..open * open];
        gram.fill(0.0);
        let virtual_part = &self.matrix[self.passive * m..][..self.virtuals * m];
        for column in virtual_part.chunks_exact(m) {
            let below = &column[rank..];
            for (i, &a) in below.iter().enumerate() {
                for (entry, &b) in gram[i * open..].iter_mut().zip(&below[..=i]) {
                    *entry += a * b;
                }
            }
        }
        factor_symmetric(gram, open, DEPENDENT * largest);
    }

    /// Reflects the passive columns to a triangle, short ones last, and the virtual ones along; returns their rank.
    #[inline(always)]
    fn triangulate(&mut self, m: usize, mut largest: f64) -> usize {
        let n = self.passive;
        for (k, place) in self.order.iter_mut().enumerate() {
            *place = k;
        }
        for k in 0..n.min(m) {
            let below = |column: &[f64]| column[k..].iter().map(|value| value * value).sum::<f64>();
            let columns = self.matrix[..n * m].chunks_exact(m);
            // The next column, if it is long enough to go by; else the longest.
            let (mut best, mut best_square) = (k, below(&self.matrix[k * m..(k + 1) * m]));
            if k == 0 || best_square < (LONG_ENOUGH * largest).powi(2) || best_square.is_nan() {
                for (column, entries) in columns.enumerate().skip(k + 1) {
                    let square = below(entries);
                    if square > best_square {
                        (best, best_square) = (column, square);
                    }
                }
            }
            let norm = best_square.sqrt();
            if k == 0 {
                largest = norm.max(largest);
            }
            if norm <= DEPENDENT * largest || norm.is_nan() {
                return k;
            }
            if best != k {
                let (left, right) = self.matrix.split_at_mut(best * m);
                left[k * m..(k + 1) * m].swap_with_slice(&mut right[..m]);
                self.order.swap(k, best);
            }
            if k + 1 == m {
                // One equation is left: nothing to reflect.
                self.mirrors[k] = [0.0; 2];
                return m;
            }
            let all = &mut self.matrix[..(n + self.virtuals) * m];
            let (left, right) = all.split_at_mut((k + 1) * m);
            let mirror = &mut left[k * m + k..];
            let head = mirror[0];
            let onto = -norm.copysign(head);
            mirror[0] = head - onto;
            let scale = 1.0 / (norm * (norm + head.abs()));
            for column in right.chunks_exact_mut(m) {
                reflect(&mut column[k..], mirror, scale);
            }
            self.mirrors[k] = [mirror[0], scale];
            mirror[0] = onto;
        }
        n.min(m)
    }

    /// Solves for the step with the equations as factored; `y` are the virtual joints in their metric.
    pub(super) fn solve(&mut self, y: &[f64], solver: ReliefSolver) {
        match self.rows {
            2 => self.solve_rows(2, y, solver),
            3 => self.solve_rows(3, y, solver),
            4 => self.solve_rows(4, y, solver),
            5 => self.solve_rows(5, y, solver),
            6 => self.solve_rows(6, y, solver),
            m => self.solve_rows(m, y, solver),
        }
    }

    #[inline(always)]
    fn solve_rows(&mut self, m: usize, y: &[f64], solver: ReliefSolver) {
        let (n, rank) = (self.passive, self.rank);
        let right = &mut self.right[..m];
        for (k, column) in self.matrix[..n * m].chunks_exact_mut(m).enumerate().take(rank) {
            let [head, scale] = self.mirrors[k];
            let onto = std::mem::replace(&mut column[k], head);
            reflect(&mut right[k..], &column[k..], scale);
            column[k] = onto;
        }
        self.step.fill(0.0);
        let (passive_step, rest) = self.step.split_at_mut(n);
        let virtual_step = &mut rest[..self.virtuals];
        let virtual_part = &self.matrix[n * m..][..self.virtuals * m];
        if self.virtuals > 0 && rank < m {
            // The least virtual displacements that meet the equations which no passive joint can.
            let open = m - rank;
            let least_norm = solver == ReliefSolver::LeastNorm;
            let multipliers = &mut self.multipliers[..open];
            multipliers.copy_from_slice(&right[rank..]);
            if least_norm {
                for (column, &value) in virtual_part.chunks_exact(m).zip(y) {
                    for (multiplier, &a) in multipliers.iter_mut().zip(&column[rank..]) {
                        *multiplier += a * value;
                    }
                }
            }
            solve_symmetric(&self.gram[..open * open], multipliers);
            for ((column, &value), step) in
                virtual_part.chunks_exact(m).zip(y).zip(virtual_step.iter_mut())
            {
                let reached: f64 =
                    column[rank..].iter().zip(multipliers.iter()).map(|(a, b)| a * b).sum();
                *step = if least_norm { reached - value } else { reached };
            }
        }
        // The mismatch that remains for the passive joints.
        for (column, step) in virtual_part.chunks_exact(m).zip(virtual_step.iter()) {
            for (entry, &a) in right[..rank].iter_mut().zip(column) {
                *entry -= a * step;
            }
        }
        for k in (0..rank).rev() {
            let column = &self.matrix[k * m..(k + 1) * m];
            let value = right[k] / column[k];
            passive_step[self.order[k]] = value;
            for (entry, &a) in right[..k].iter_mut().zip(column) {
                *entry -= a * value;
            }
        }
    }
}

/// Reflects a vector by a mirror; `scale` is twice the inverse of the mirror's square.
#[inline(always)]
pub(super) fn reflect(vector: &mut [f64], mirror: &[f64], scale: f64) {
    let dot: f64 = mirror.iter().zip(vector.iter()).map(|(a, b)| a * b).sum();
    for (value, normal) in vector.iter_mut().zip(mirror) {
        *value -= scale * dot * normal;
    }
}

/// Factors G = L D Lᵀ of a matrix with no negative direction in place; equations that depend on those before them get a zero in D.
///
/// # Arguments
/// * `gram` – holds the lower triangle by rows
/// * `round_off` – length of a column that is round-off of those of which the matrix is the product
pub(super) fn factor_symmetric(gram: &mut [f64], n: usize, round_off: f64) {
    let largest = (0..n).map(|k| gram[k * n + k]).fold(0.0, f64::max);
    let least = (DEPENDENT_SQUARED * largest).max(round_off * round_off);
    for i in 0..n {
        for j in 0..=i {
            let mut sum = gram[i * n + j];
            for k in 0..j {
                sum -= gram[i * n + k] * gram[j * n + k] * gram[k * n + k];
            }
            let pivot = gram[j * n + j];
            gram[i * n + j] = if i == j {
                if sum > least { sum } else { 0.0 }
            } else if pivot > 0.0 {
                sum / pivot
            } else {
                0.0
            };
        }
    }
}

/// Solves L D Lᵀ x = b in place; x is zero for equations that were dropped.
pub(super) fn solve_symmetric(factor: &[f64], b: &mut [f64]) {
    let n = b.len();
    for i in 0..n {
        for k in 0..i {
            b[i] -= factor[i * n + k] * b[k];
        }
    }
    for i in 0..n {
        let pivot = factor[i * n + i];
        b[i] = if pivot > 0.0 { b[i] / pivot } else { 0.0 };
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            b[i] -= factor[k * n + i] * b[k];
        }
    }
}

/// The larger of two numbers, NaN if one is.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}
