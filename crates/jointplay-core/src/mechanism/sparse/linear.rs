//! The linearized closures of all joints, as a sparse system in the twists of the links.

use faer::linalg::solvers::SolveCore;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use faer::{Conj, MatMut, Side};
use nalgebra::{DMatrix, DVector, Matrix6, Vector3, Vector6};

use super::coupling::{LinearCoupling, SparseCoupling, for_each_coupled};
use crate::Error;
use crate::mechanism::Kinematics;
use crate::mechanism::joint::Twist;

/// Damping of the normal equations, as a share of their largest entry: above round-off, and what it hides is found by iteration.
const DAMPING: f64 = 1e-14;
/// Conjugate gradient steps at most: near a singular configuration damping has the last word.
const MAX_STEPS: usize = 10;
/// Growth of the damping where factorisation fails.
const MORE_DAMPING: f64 = 100.0;
/// Screws of a joint of which those before leave no more than this share are combinations of them.
const DEPENDENT: f64 = 1e-9;

/// Sparsity pattern of the normal equations, which depends on the graph only.
#[derive(Debug, Clone)]
pub(super) struct Pattern {
    symbolic: SymbolicSparseColMat<usize>,
    argsort: Argsort<usize>,
    factor: SymbolicLlt<usize>,
}

impl Pattern {
    pub(super) fn new(kinematics: &Kinematics<'_>, couplings: &[SparseCoupling]) -> Self {
        let mechanism = kinematics.mechanism();
        let size = 6 * (mechanism.links().len() - 1);
        let mut places = Vec::new();
        for joint in mechanism.joints() {
            for_each_place(joint.links, |_, row, column| places.push(Pair { row, col: column }));
        }
        for coupling in couplings {
            for_each_coupled(coupling.links(), |_, _, row, column| {
                places.push(Pair { row, col: column });
            });
        }
        places.extend((0..size).map(|k| Pair { row: k, col: k }));
        let (symbolic, argsort) = SymbolicSparseColMat::try_new_from_indices(size, size, &places)
            .expect("places are within the matrix");
        let factor = SymbolicLlt::try_new(symbolic.as_ref(), Side::Lower)
            .expect("a pattern of this size fits into memory");
        Self { symbolic, argsort, factor }
    }
}

/// Entries of the lower triangle that a joint touches: which block (first–first, second–second, between), row and column of the block, row and column of the matrix.
fn for_each_place(links: [usize; 2], mut see: impl FnMut((usize, usize, usize), usize, usize)) {
    for (block, [a, b]) in [[0, 0], [1, 1], [1, 0]].into_iter().enumerate() {
        if links[a] == 0 || links[b] == 0 {
            continue;
        }
        for row in 0..6 {
            for column in 0..6 {
                let at = [6 * (links[a] - 1) + row, 6 * (links[b] - 1) + column];
                let within = a == b;
                if within && column > row {
                    continue;
                }
                if at[0] >= at[1] {
                    see((block, row, column), at[0], at[1]);
                } else {
                    see((block, row, column), at[1], at[0]);
                }
            }
        }
    }
}

/// One joint linearized at a point of its own; lengths over the length of the system.
#[derive(Debug, Clone)]
pub(super) struct JointRow {
    pub(super) links: [usize; 2],
    /// From the middle of each link to the point.
    pub(super) arms: [Vector3<f64>; 2],
    /// (6) what the first link and the joint make of the second link's pose, against where it is.
    pub(super) mismatch: Vector6<f64>,
    /// Coordinates that follow, without those that depend on others.
    pub(super) follows: Vec<usize>,
    /// (follows, 6) how fast they go, of the relative twist.
    pub(super) rates: DMatrix<f64>,
    /// Projector onto the twists that the joint does not allow.
    pub(super) refused: Matrix6<f64>,
    /// How many it allows.
    pub(super) freedoms: usize,
}

impl JointRow {
    /// Takes apart the twists of the coordinates that follow.
    pub(super) fn split(
        screws: &[(usize, Vector6<f64>)],
    ) -> (Vec<usize>, DMatrix<f64>, Matrix6<f64>) {
        let mut order: Vec<usize> = Vec::new();
        let mut basis: Vec<Vector6<f64>> = Vec::new();
        let largest = screws.iter().map(|(_, screw)| screw.norm()).fold(0.0, f64::max);
        // The part of each that is outside the span of the basis so far.
        let mut rest: Vec<Vector6<f64>> = screws.iter().map(|&(_, screw)| screw).collect();
        while let Some(next) =
            (0..rest.len()).max_by(|&a, &b| rest[a].norm().total_cmp(&rest[b].norm()))
        {
            let norm = rest[next].norm();
            if norm <= DEPENDENT * largest || norm.is_nan() || order.contains(&next) {
                break;
            }
            let unit = rest[next] / norm;
            order.push(next);
            basis.push(unit);
            for vector in &mut rest {
                for _ in 0..2 {
                    *vector -= unit * unit.dot(vector);
                }
            }
            rest[next].fill(0.0);
        }
        let count = order.len();
        let onto = DMatrix::from_fn(count, 6, |k, row| basis[k][row]);
        // The basis in terms of the screws is triangular.
        let triangle = DMatrix::from_fn(count, count, |i, j| basis[i].dot(&screws[order[j]].1));
        let rates =
            triangle.solve_upper_triangular(&onto).unwrap_or_else(|| DMatrix::zeros(count, 6));
        let mut refused = Matrix6::identity();
        if count < 6 {
            basis.iter().for_each(|unit| refused -= unit * unit.transpose());
        } else {
            // A joint with six freedoms has no constraint, only round-off.
            refused.fill(0.0);
        }
        let follows = order.iter().map(|&k| screws[k].0).collect();
        (follows, rates, refused)
    }

    /// Twist of the first link beyond that of the second, at the joint's point.
    fn relative(&self, x: &[f64]) -> Vector6<f64> {
        let mut twist = Vector6::zeros();
        for (side, sense) in [(0, 1.0), (1, -1.0)] {
            if let Some(link) = self.links[side].checked_sub(1) {
                let angular = Vector3::from_column_slice(&x[6 * link..6 * link + 3]);
                let linear = Vector3::from_column_slice(&x[6 * link + 3..6 * link + 6]);
                let linear = linear + angular.cross(&self.arms[side]);
                for axis in 0..3 {
                    twist[axis] += sense * angular[axis];
                    twist[3 + axis] += sense * linear[axis];
                }
            }
        }
        twist
    }

    /// Both links, each with the derivative of a coordinate by its twist; nothing where the coordinate does not follow.
    pub(super) fn rates_by_twists(&self, coordinate: usize) -> Option<[(usize, Vector6<f64>); 2]> {
        let row = self.follows.iter().position(|&follows| follows == coordinate)?;
        let rate = self.rates.row(row).transpose();
        let of = |side: usize, sense: f64| {
            (self.links[side], self.transport(side).tr_mul(&rate) * sense)
        };
        Some([of(0, -1.0), of(1, 1.0)])
    }

    /// (6,6) the twist at the joint's point of a link's own.
    fn transport(&self, side: usize) -> Matrix6<f64> {
        let mut matrix = Matrix6::identity();
        matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&(-self.arms[side].cross_matrix()));
        matrix
    }
}

/// All joints and couplings linearized, and the factor of their damped normal equations.
///
/// ```text
///    J x  =  M (x_first − x_second)  at each joint        M: what the joint refuses
///            g · x                   of each coupling
///    N    =  Jᵀ J + δ² 1  =  L Lᵀ
/// ```
pub(super) struct Linear {
    pub(super) joints: Vec<JointRow>,
    pub(super) couplings: Vec<LinearCoupling>,
    /// Twist of each coordinate in the base frame, the linear part at the point of its joint (m).
    pub(super) screws: Vec<Twist>,
    factor: Llt<usize, f64>,
    /// δ²
    pub(super) damping: f64,
    size: usize,
}

impl Linear {
    pub(super) fn new(
        pattern: &Pattern,
        links: usize,
        joints: Vec<JointRow>,
        couplings: Vec<LinearCoupling>,
        screws: Vec<Twist>,
    ) -> Result<Self, Error> {
        let size = 6 * (links - 1);
        let mut values = Vec::new();
        for joint in &joints {
            let [first, second] = [joint.transport(0), joint.transport(1)];
            let blocks = [
                first.transpose() * joint.refused * first,
                second.transpose() * joint.refused * second,
                -(second.transpose() * joint.refused * first),
            ];
            for_each_place(joint.links, |(block, row, column), _, _| {
                values.push(blocks[block][(row, column)]);
            });
        }
        for coupling in &couplings {
            coupling.for_each_product(|product| values.push(product));
        }
        // No less than one joint that refuses anything would make it.
        let largest = values.iter().copied().map(f64::abs).fold(1.0, f64::max);
        let entries = values.len();
        values.resize(entries + size, 0.0);
        let mut damping = DAMPING * largest;
        loop {
            values[entries..].fill(damping);
            let matrix =
                SparseColMat::new_from_argsort(pattern.symbolic.clone(), &pattern.argsort, &values)
                    .expect("as many values as places");
            let factor =
                Llt::try_new_with_symbolic(pattern.factor.clone(), matrix.as_ref(), Side::Lower);
            match factor {
                Ok(factor) => return Ok(Self { joints, couplings, screws, factor, damping, size }),
                // Not positive to round-off; with damping as large as the matrix itself it is.
                Err(_) if damping < largest => damping *= MORE_DAMPING,
                Err(_) => {
                    let what = "an entry of the normal equations";
                    return Err(Error::NotFinite { what, value: f64::NAN });
                }
            }
        }
    }

    /// (6·(links − 1)) number of unknowns.
    pub(super) fn size(&self) -> usize {
        self.size
    }

    /// J x, six numbers a joint and one a coupling.
    pub(super) fn apply(&self, x: &[f64]) -> DVector<f64> {
        let joints = 6 * self.joints.len();
        let mut y = DVector::zeros(joints + self.couplings.len());
        for (j, joint) in self.joints.iter().enumerate() {
            y.fixed_rows_mut::<6>(6 * j).copy_from(&(joint.refused * joint.relative(x)));
        }
        for (c, coupling) in self.couplings.iter().enumerate() {
            y[joints + c] = coupling.apply(x);
        }
        y
    }

    /// What is violated while no link moves: of each joint the part of its twist that it refuses, of each coupling the change by rates of coordinates.
    ///
    /// # Arguments
    /// * `beyond` – (6 joints) twists of the joints
    /// * `rates` – rates of all coordinates for these twists (m, rad)
    pub(super) fn violated(&self, beyond: &DVector<f64>, rates: &DVector<f64>) -> DVector<f64> {
        let joints = 6 * self.joints.len();
        let mut violated = DVector::zeros(joints + self.couplings.len());
        for (j, joint) in self.joints.iter().enumerate() {
            violated
                .fixed_rows_mut::<6>(6 * j)
                .copy_from(&(joint.refused * beyond.fixed_rows::<6>(6 * j)));
        }
        for (c, coupling) in self.couplings.iter().enumerate() {
            violated[joints + c] = coupling.change(rates);
        }
        violated
    }

    /// Jᵀ y.
    pub(super) fn apply_transposed(&self, y: &DVector<f64>) -> DVector<f64> {
        let mut x = DVector::zeros(self.size);
        for (j, joint) in self.joints.iter().enumerate() {
            let wrench = joint.refused * y.fixed_rows::<6>(6 * j);
            let (moment, force) = (wrench.fixed_rows::<3>(0), wrench.fixed_rows::<3>(3));
            for (side, sense) in [(0, 1.0), (1, -1.0)] {
                if let Some(link) = joint.links[side].checked_sub(1) {
                    let moment = moment + joint.arms[side].cross(&force);
                    for axis in 0..3 {
                        x[6 * link + axis] += sense * moment[axis];
                        x[6 * link + 3 + axis] += sense * force[axis];
                    }
                }
            }
        }
        for (c, coupling) in self.couplings.iter().enumerate() {
            coupling.add_transposed(y[6 * self.joints.len() + c], &mut x);
        }
        x
    }

    /// N⁻¹ b in place, for each column.
    pub(super) fn solve(&self, b: &mut DMatrix<f64>) {
        let (rows, columns) = b.shape();
        let b = MatMut::from_column_major_slice_mut(b.as_mut_slice(), rows, columns);
        self.factor.solve_in_place_with_conj(Conj::No, b);
    }

    /// The shortest x for which J x = y, or nearest to it: by conjugate gradients with the factor as preconditioner, until steps are shorter than a share of x.
    ///
    /// The factor leaves to them only what damping hides: a few motions that break next to nothing.
    pub(super) fn solve_least(&self, y: &DVector<f64>, settled: f64) -> DVector<f64> {
        let mut x = DVector::zeros(self.size);
        let mut open = y.clone();
        let mut along: DVector<f64> = DVector::zeros(self.size);
        let mut slope = f64::INFINITY;
        for _ in 0..=MAX_STEPS {
            let gradient = self.apply_transposed(&open);
            let mut steepest = DMatrix::from_columns(std::slice::from_ref(&gradient));
            self.solve(&mut steepest);
            let steepest = steepest.column(0);
            let next = gradient.dot(&steepest);
            along = steepest + along * (next / slope);
            slope = next;
            let closed = self.apply(along.as_slice());
            let reach = slope / closed.norm_squared();
            if !reach.is_finite() {
                break;
            }
            x.axpy(reach, &along, 1.0);
            open.axpy(-reach, &closed, 1.0);
            if reach.abs() * along.norm() <= settled * x.norm() {
                break;
            }
        }
        x
    }

    /// Rates of the coordinates that follow, for twists of the links, and for what drives add to each joint's twist.
    pub(super) fn rates(
        &self,
        x: &[f64],
        beyond: &DVector<f64>,
        coordinates: usize,
    ) -> DVector<f64> {
        let mut rates = DVector::zeros(coordinates);
        for (j, joint) in self.joints.iter().enumerate() {
            // S q̇ = V_second − V_first − beyond.
            let asked = -(joint.relative(x) + beyond.fixed_rows::<6>(6 * j));
            for (row, &k) in joint.follows.iter().enumerate() {
                rates[k] = (0..6).map(|i| joint.rates[(row, i)] * asked[i]).sum();
            }
        }
        rates
    }
}
