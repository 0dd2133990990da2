//! The linearized closures of all joints, as a sparse system in the twists of the links.

use std::sync::Arc;

use nalgebra::{DVector, Vector3, Vector6};

use super::block_cholesky::{BlockMatrix, BlockPattern, NotPositive, Place, Row};
use super::coupling::{LinearCoupling, SparseCoupling};
use super::joint_row::{JointRow, Motions, allowed_motions};
use crate::Error;
use crate::mechanism::Kinematics;
use crate::mechanism::joint::Twist;

/// Damping of the normal equations, as a share of their largest entry: above round-off, and what it hides is found by iteration.
const DAMPING: f64 = 1e-14;
/// Conjugate gradient steps at most: near a singular configuration damping has the last word.
const MAX_STEPS: usize = 10;
/// Columns of which one pass through the factor solves the equations.
const TOGETHER: usize = 4;
/// Growth of the damping where factorisation fails.
const MORE_DAMPING: f64 = 100.0;

/// Sparsity pattern of the normal equations, which depends on the graph only.
#[derive(Debug, Clone)]
pub(super) struct Pattern {
    blocks: BlockPattern,
    /// For each joint the block between its second link and its first, unless one of them is the base.
    between: Vec<Option<Place>>,
    /// For each coupling the blocks between its links.
    coupled: Vec<Vec<Place>>,
}

impl Pattern {
    pub(super) fn new(
        kinematics: &Kinematics<'_>,
        couplings: &[SparseCoupling],
    ) -> Result<Self, Error> {
        let mechanism = kinematics.mechanism();
        let pair = |links: [usize; 2]| Some([links[1].checked_sub(1)?, links[0].checked_sub(1)?]);
        let pairs = mechanism.joints().iter().map(|joint| pair(joint.links));
        let coupled = couplings.iter().flat_map(SparseCoupling::pairs);
        let links = mechanism.links().len() - 1;
        let blocks = BlockPattern::new(links, pairs.clone().flatten().chain(coupled))?;
        let between = pairs.map(|pair| pair.map(|pair| blocks.place(pair))).collect();
        let places = |one: &SparseCoupling| one.pairs().map(|pair| blocks.place(pair)).collect();
        let coupled = couplings.iter().map(places).collect();
        Ok(Self { blocks, between, coupled })
    }
}

/// Joints linearized one after the other, and memory for what is made of them.
#[derive(Debug)]
pub(super) struct JointRows {
    joints: Vec<JointRow>,
    motions: Motions,
    pub(super) screws: Vec<Twist>,
    matrix: BlockMatrix,
}

impl JointRows {
    /// No joint yet.
    ///
    /// # Arguments
    /// * `pattern` – of the normal equations
    /// * `resistance` – see [`Motions`]
    /// * `screws` – of all coordinates, see [`Linear`]
    /// * `former` – closures of the same mechanism that are not needed any more; their memory is used again
    pub(super) fn new(
        pattern: &Pattern,
        resistance: f64,
        screws: &[Twist],
        former: Option<Linear>,
    ) -> Self {
        let mut rows = match former {
            Some(Linear { joints, motions, screws, factor: matrix, .. }) => {
                Self { joints, motions, screws, matrix }
            }
            None => Self {
                joints: Vec::with_capacity(pattern.between.len()),
                motions: Motions { all: Vec::with_capacity(screws.len()), resistance },
                screws: Vec::with_capacity(screws.len()),
                matrix: BlockMatrix::zeros(&pattern.blocks),
            },
        };
        rows.joints.clear();
        rows.motions.all.clear();
        rows.motions.resistance = resistance;
        rows.screws.clear();
        rows.screws.extend_from_slice(screws);
        rows
    }

    /// Adds the next joint.
    ///
    /// # Arguments
    /// * `arms` – from the middle of each link to the point
    /// * `follows` – the coordinates that follow
    /// * `scaled` – a twist with lengths over the length of the system
    pub(super) fn push(
        &mut self,
        links: [usize; 2],
        arms: [Vector3<f64>; 2],
        follows: impl Iterator<Item = usize>,
        scaled: impl Fn(&Twist) -> Vector6<f64>,
    ) {
        let first = self.motions.all.len();
        let follows = follows.map(|k| (k, scaled(&self.screws[k])));
        allowed_motions(follows, &mut self.motions.all);
        self.joints.push(JointRow { links, arms, allowed: [first, self.motions.all.len()] });
    }
}

impl JointRows {
    /// The two links of a joint, each with the derivative of a coordinate by the six numbers of its twist; `None` where the coordinate does not follow, or depends on others.
    pub(super) fn rates_by_twists(
        &self,
        joint: usize,
        coordinate: usize,
    ) -> Option<[(usize, Vector6<f64>); 2]> {
        let row = &self.joints[joint];
        let motion = row.allowed(&self.motions).iter().find(|one| one.coordinate == coordinate)?;
        let rate = motion.rate * self.motions.share();
        let by = |side: usize| (row.links[side], row.at_middle(side, &rate));
        let [(first, by_first), second] = [0, 1].map(by);
        Some([(first, -by_first), second])
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
    motions: Motions,
    /// Twist of each coordinate in the base frame, the linear part at the point of its joint (m).
    pub(super) screws: Vec<Twist>,
    pattern: Arc<Pattern>,
    factor: BlockMatrix,
    /// δ²
    pub(super) damping: f64,
}

impl Linear {
    pub(super) fn new(
        pattern: &Arc<Pattern>,
        rows: JointRows,
        couplings: Vec<LinearCoupling>,
    ) -> Result<Self, Error> {
        let JointRows { joints, motions, screws, mut matrix } = rows;
        let assemble = |matrix: &mut BlockMatrix| {
            matrix.clear();
            for (joint, between) in joints.iter().zip(&pattern.between) {
                joint.add_to(&motions, matrix, &pattern.blocks, *between);
            }
            for (coupling, places) in couplings.iter().zip(&pattern.coupled) {
                coupling.add_to(matrix, &pattern.blocks, places);
            }
        };
        assemble(&mut matrix);
        // No less than one joint that refuses anything would make it.
        let largest = matrix.largest().max(1.0);
        let mut damping = DAMPING * largest;
        loop {
            matrix.add_to_diagonal(damping);
            match matrix.factor(&pattern.blocks) {
                Ok(()) => break,
                // Not positive to round-off; with damping as large as the matrix itself it is.
                Err(NotPositive) if damping < largest => damping *= MORE_DAMPING,
                Err(NotPositive) => {
                    let what = "an entry of the normal equations";
                    return Err(Error::NotFinite { what, value: f64::NAN });
                }
            }
            assemble(&mut matrix);
        }
        let pattern = pattern.clone();
        Ok(Self { joints, couplings, motions, screws, pattern, factor: matrix, damping })
    }

    /// Number of independent motions that all joints allow.
    pub(super) fn allowed(&self) -> usize {
        self.motions.all.len()
    }

    /// (6·(links − 1)) number of unknowns.
    pub(super) fn size(&self) -> usize {
        self.pattern.blocks.unknowns()
    }

    /// Number of closures: six a joint and one a coupling.
    pub(super) fn closures(&self) -> usize {
        6 * self.joints.len() + self.couplings.len()
    }

    /// J x, six numbers a joint and one a coupling.
    pub(super) fn apply(&self, x: &[f64]) -> DVector<f64> {
        let mut y = DVector::zeros(self.closures());
        self.apply_to(x, y.as_mut_slice());
        y
    }

    /// Writes J x.
    pub(super) fn apply_to(&self, x: &[f64], y: &mut [f64]) {
        let (of_joints, of_couplings) = y.split_at_mut(6 * self.joints.len());
        for (joint, y) in self.joints.iter().zip(of_joints.as_chunks_mut::<6>().0) {
            *y = joint.refused(&self.motions, &joint.relative(x)).into();
        }
        for (coupling, y) in self.couplings.iter().zip(of_couplings) {
            *y = coupling.apply(x);
        }
    }

    /// Violations while no link moves: of each joint the part of its twist that it refuses, of each coupling the change by rates of coordinates.
    ///
    /// # Arguments
    /// * `beyond` – (6 joints) twists of the joints
    /// * `rates` – rates of all coordinates for these twists (m, rad)
    pub(super) fn violated(&self, beyond: &DVector<f64>, rates: &DVector<f64>) -> DVector<f64> {
        let joints = 6 * self.joints.len();
        let mut violated = DVector::zeros(self.closures());
        for (j, joint) in self.joints.iter().enumerate() {
            let refused = joint.refused(&self.motions, &beyond.fixed_rows::<6>(6 * j).into_owned());
            violated.fixed_rows_mut::<6>(6 * j).copy_from(&refused);
        }
        for (c, coupling) in self.couplings.iter().enumerate() {
            violated[joints + c] = coupling.change(rates);
        }
        violated
    }

    /// Jᵀ y.
    pub(super) fn apply_transposed(&self, y: &DVector<f64>) -> DVector<f64> {
        let mut x = DVector::zeros(self.size());
        for (j, joint) in self.joints.iter().enumerate() {
            let wrench = joint.refused(&self.motions, &y.fixed_rows::<6>(6 * j).into_owned());
            for (side, sense) in [(0, 1.0), (1, -1.0)] {
                if let Some(link) = joint.links[side].checked_sub(1) {
                    let wrench = joint.at_middle(side, &wrench);
                    x.fixed_rows_mut::<6>(6 * link).axpy(sense, &wrench, 1.0);
                }
            }
        }
        for (c, coupling) in self.couplings.iter().enumerate() {
            coupling.add_transposed(y[6 * self.joints.len() + c], &mut x);
        }
        x
    }

    /// N⁻¹ b in place, for columns one after the other.
    pub(super) fn solve(&self, b: &mut [f64]) {
        let size = self.size();
        if size == 0 {
            return;
        }
        let mut several = b.chunks_exact_mut(TOGETHER * size);
        let mut room = Vec::new();
        for columns in &mut several {
            self.solve_columns::<TOGETHER>(columns, &mut room);
        }
        let mut room = Vec::new();
        for column in several.into_remainder().chunks_exact_mut(size) {
            self.solve_columns::<1>(column, &mut room);
        }
    }

    fn solve_columns<const COLUMNS: usize>(
        &self,
        columns: &mut [f64],
        room: &mut Vec<Row<COLUMNS>>,
    ) {
        room.resize(self.pattern.blocks.size(), [[0.0; COLUMNS]; 6]);
        self.factor.solve(&self.pattern.blocks, columns, room);
    }

    /// The shortest x for which J x = y, or nearest to it: by conjugate gradients with the factor as preconditioner, until steps are shorter than a share of x.
    ///
    /// The factor leaves to them only what damping hides: a few motions that break next to nothing.
    pub(super) fn solve_least(&self, y: &DVector<f64>, settled: f64) -> DVector<f64> {
        let mut x = DVector::zeros(self.size());
        let mut open = y.clone();
        let mut along: DVector<f64> = DVector::zeros(self.size());
        let mut room = Vec::new();
        let mut slope = f64::INFINITY;
        for _ in 0..=MAX_STEPS {
            let gradient = self.apply_transposed(&open);
            let mut steepest = gradient.clone();
            self.solve_columns::<1>(steepest.as_mut_slice(), &mut room);
            let next = gradient.dot(&steepest);
            along *= next / slope;
            along += steepest;
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
        let share = self.motions.share();
        for (j, joint) in self.joints.iter().enumerate() {
            // S q̇ = V_second − V_first − beyond.
            let asked = -(joint.relative(x) + beyond.fixed_rows::<6>(6 * j));
            for motion in joint.allowed(&self.motions) {
                rates[motion.coordinate] = share * motion.rate.dot(&asked);
            }
        }
        rates
    }
}
