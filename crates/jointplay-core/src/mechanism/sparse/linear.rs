//! The linearized closures of all joints, as a sparse system in the twists of the links.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Vector3, Vector6};

use super::block_cholesky::{Block, BlockMatrix, BlockPattern, EMPTY, NotPositive, Place};
use super::coupling::{LinearCoupling, SparseCoupling};
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

/// Most independent motions of a joint.
const MOST: usize = 6;

/// A motion that a joint allows, of a coordinate that follows and does not depend on others.
#[derive(Debug, Clone, Copy)]
struct AllowedMotion {
    coordinate: usize,
    /// Rate of the coordinate, of the relative twist.
    rate: Vector6<f64>,
    /// Direction that the coordinate adds to those before it; the directions of a joint are orthonormal.
    unit: Vector6<f64>,
}

/// Takes apart the twists of the coordinates of a joint that follow.
fn allowed_motions(
    mut screws: impl Iterator<Item = (usize, Vector6<f64>)>,
    motions: &mut Vec<AllowedMotion>,
) {
    let first = motions.len();
    let Some(one) = screws.next() else { return };
    let Some(two) = screws.next() else {
        // The usual joint, of one coordinate.
        let (coordinate, screw) = one;
        let norm = screw.norm();
        if norm > 0.0 {
            let unit = screw / norm;
            motions.push(AllowedMotion { coordinate, rate: unit / norm, unit });
        }
        return;
    };
    let mut all = [Vector6::zeros(); MOST];
    let mut names = [0; MOST];
    let mut found = 0;
    let mut largest = 0.0_f64;
    for (k, screw) in [one, two].into_iter().chain(screws).take(MOST) {
        (all[found], names[found]) = (screw, k);
        largest = largest.max(screw.norm());
        found += 1;
    }
    // The part of each that is outside the span of the directions so far.
    let mut rest = all;
    let mut order = [0; MOST];
    while motions.len() - first < found {
        let longest = (0..found).max_by(|&a, &b| rest[a].norm().total_cmp(&rest[b].norm()));
        let Some(next) = longest else { break };
        let norm = rest[next].norm();
        if norm <= DEPENDENT * largest || norm.is_nan() {
            break;
        }
        let unit = rest[next] / norm;
        order[motions.len() - first] = next;
        motions.push(AllowedMotion { coordinate: names[next], rate: unit, unit });
        for vector in &mut rest[..found] {
            for _ in 0..2 {
                *vector -= unit * unit.dot(vector);
            }
        }
        rest[next].fill(0.0);
    }
    // The twists in terms of the directions are triangular.
    let own = &mut motions[first..];
    for i in (0..own.len()).rev() {
        let unit = own[i].unit;
        let component = |j: usize| unit.dot(&all[order[j]]);
        let known: Vector6<f64> =
            own.iter().enumerate().skip(i + 1).map(|(j, later)| later.rate * component(j)).sum();
        own[i].rate = (unit - known) / component(i);
    }
}

/// What joints allow, and how much they resist it.
///
/// ```text
///    min over q̇   | V − S q̇ |² + r² / (1 − r²) | S q̇ |²   =   | M V |²        M = 1 − (1 − r) Σ u uᵀ,  S q̇ = (1 − r²) Σ u uᵀ V
/// ```
#[derive(Debug)]
struct Motions {
    /// Of all joints, those of each one after the other.
    all: Vec<AllowedMotion>,
    /// r: 0 for joints that move freely, towards 1 for joints that hardly move; with it, steps near singular configurations are short.
    resistance: f64,
}

impl Motions {
    /// 1 − r²: of a relative twist along an allowed direction, the share that the joint follows.
    fn share(&self) -> f64 {
        1.0 - self.resistance * self.resistance
    }
}

/// One joint linearized at a point of its own; lengths over the length of the system.
#[derive(Debug, Clone)]
pub(super) struct JointRow {
    pub(super) links: [usize; 2],
    /// From the middle of each link to the point.
    pub(super) arms: [Vector3<f64>; 2],
    /// Where its allowed motions begin and end.
    allowed: [usize; 2],
}

impl JointRow {
    /// The motions that the joint allows.
    fn allowed<'m>(&self, motions: &'m Motions) -> &'m [AllowedMotion] {
        &motions.all[self.allowed[0]..self.allowed[1]]
    }

    /// The part of a twist, or of a wrench, that the joint does not allow, and the share [`Motions::resistance`] of the part that it does.
    fn refused(&self, motions: &Motions, of: &Vector6<f64>) -> Vector6<f64> {
        let allowed = self.allowed(motions);
        if allowed.len() == MOST {
            // A joint with six freedoms has no constraint, only round-off.
            return Vector6::zeros();
        }
        let share = 1.0 - motions.resistance;
        allowed.iter().fold(*of, |rest, motion| rest - motion.unit * (share * motion.unit.dot(of)))
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

    /// Tᵀ w: a wrench at the joint's point as one at the middle of a link.
    fn at_middle(&self, side: usize, wrench: &Vector6<f64>) -> Vector6<f64> {
        let force = wrench.fixed_rows::<3>(3);
        let moment = wrench.fixed_rows::<3>(0) + self.arms[side].cross(&force);
        Vector6::new(moment.x, moment.y, moment.z, force[0], force[1], force[2])
    }

    /// Adds what the joint refuses to the normal equations.
    ///
    /// ```text
    ///    ( T_aᵀ M² T_b )  =  T_aᵀ T_b  −  (1 − r²) Σ (T_aᵀ u)(T_bᵀ u)ᵀ        T: twist at the joint's point of a link's own
    /// ```
    fn add_to(
        &self,
        motions: &Motions,
        matrix: &mut BlockMatrix,
        pattern: &Pattern,
        between: Option<Place>,
    ) {
        let allowed = self.allowed(motions);
        if allowed.len() == MOST {
            return;
        }
        let share = motions.share();
        let block = |a: usize, b: usize| {
            let mut block = transported(&self.arms[a], &self.arms[b]);
            for motion in allowed {
                let [of_a, of_b] = [a, b].map(|side| self.at_middle(side, &motion.unit));
                for (column, factor) in block.iter_mut().zip((of_b * share).iter()) {
                    for (entry, value) in column.iter_mut().zip(of_a.iter()) {
                        *entry -= value * factor;
                    }
                }
            }
            block
        };
        for side in 0..2 {
            if let Some(link) = self.links[side].checked_sub(1) {
                matrix.add_diagonal(&pattern.blocks, link, &block(side, side));
            }
        }
        if let Some(place) = between {
            let mut block = block(1, 0);
            block.as_flattened_mut().iter_mut().for_each(|entry| *entry = -*entry);
            matrix.add(place, &block);
        }
    }
}

/// Joints linearized one after the other.
#[derive(Debug)]
pub(super) struct JointRows {
    joints: Vec<JointRow>,
    motions: Motions,
}

impl JointRows {
    /// Room for a number of joints and coordinates.
    ///
    /// # Arguments
    /// * `resistance` – see [`Motions`]
    pub(super) fn with_capacity(joints: usize, coordinates: usize, resistance: f64) -> Self {
        let all = Vec::with_capacity(coordinates);
        Self { joints: Vec::with_capacity(joints), motions: Motions { all, resistance } }
    }

    /// Adds the next joint.
    ///
    /// # Arguments
    /// * `arms` – from the middle of each link to the point
    /// * `follows` – the coordinates that follow, with their twists
    pub(super) fn push(
        &mut self,
        links: [usize; 2],
        arms: [Vector3<f64>; 2],
        follows: impl Iterator<Item = (usize, Vector6<f64>)>,
    ) {
        let first = self.motions.all.len();
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

/// T_aᵀ T_b of the transports of two arms.
///
/// ```text
///    T  =  (   1    0 )        T_aᵀ T_b  =  ( 1 − [a][b]   [a] )
///          ( −[a]   1 )                     (   −[b]        1  )
/// ```
fn transported(a: &Vector3<f64>, b: &Vector3<f64>) -> Block {
    let mut block = EMPTY;
    let dot = a.dot(b);
    for column in 0..3 {
        for row in 0..3 {
            // [a][b] = b aᵀ − (a · b) 1
            block[column][row] = -b[row] * a[column];
        }
        block[column][column] += 1.0 + dot;
        block[3 + column][3 + column] = 1.0;
    }
    let cross = |block: &mut Block, [row, column]: [usize; 2], v: &Vector3<f64>| {
        block[column + 1][row] = -v.z;
        block[column + 2][row] = v.y;
        block[column][row + 1] = v.z;
        block[column + 2][row + 1] = -v.x;
        block[column][row + 2] = -v.y;
        block[column + 1][row + 2] = v.x;
    };
    cross(&mut block, [0, 3], a);
    cross(&mut block, [3, 0], &-b);
    block
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
    size: usize,
}

impl Linear {
    pub(super) fn new(
        pattern: &Arc<Pattern>,
        links: usize,
        rows: JointRows,
        couplings: Vec<LinearCoupling>,
        screws: Vec<Twist>,
    ) -> Result<Self, Error> {
        let JointRows { joints, motions } = rows;
        let size = 6 * (links - 1);
        let assembled = || {
            let mut matrix = BlockMatrix::zeros(&pattern.blocks);
            for (joint, between) in joints.iter().zip(&pattern.between) {
                joint.add_to(&motions, &mut matrix, pattern, *between);
            }
            for (coupling, places) in couplings.iter().zip(&pattern.coupled) {
                coupling.add_to(&mut matrix, &pattern.blocks, places);
            }
            matrix
        };
        let mut matrix = assembled();
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
            matrix = assembled();
        }
        let pattern = pattern.clone();
        Ok(Self { joints, couplings, motions, screws, pattern, factor: matrix, damping, size })
    }

    /// Number of independent motions that all joints allow.
    pub(super) fn allowed(&self) -> usize {
        self.motions.all.len()
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
            let refused = joint.refused(&self.motions, &joint.relative(x));
            y.fixed_rows_mut::<6>(6 * j).copy_from(&refused);
        }
        for (c, coupling) in self.couplings.iter().enumerate() {
            y[joints + c] = coupling.apply(x);
        }
        y
    }

    /// Violations while no link moves: of each joint the part of its twist that it refuses, of each coupling the change by rates of coordinates.
    ///
    /// # Arguments
    /// * `beyond` – (6 joints) twists of the joints
    /// * `rates` – rates of all coordinates for these twists (m, rad)
    pub(super) fn violated(&self, beyond: &DVector<f64>, rates: &DVector<f64>) -> DVector<f64> {
        let joints = 6 * self.joints.len();
        let mut violated = DVector::zeros(joints + self.couplings.len());
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
        let mut x = DVector::zeros(self.size);
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

    /// N⁻¹ b in place, for each column.
    pub(super) fn solve(&self, b: &mut DMatrix<f64>) {
        let mut room = vec![0.0; self.size];
        if self.size > 0 {
            for column in b.as_mut_slice().chunks_exact_mut(self.size) {
                self.factor.solve(&self.pattern.blocks, column, &mut room);
            }
        }
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
