//! One joint linearized: the motions that it allows, and what it refuses.

use nalgebra::{Vector3, Vector6};

use super::block_cholesky::{Block, BlockMatrix, BlockPattern, EMPTY, Place};

/// Screws of a joint of which those before leave no more than this share are combinations of them.
const DEPENDENT: f64 = 1e-9;

/// Most independent motions of a joint.
const MOST: usize = 6;

/// A motion that a joint allows, of a coordinate that follows and does not depend on others.
#[derive(Debug, Clone, Copy)]
pub(super) struct AllowedMotion {
    pub(super) coordinate: usize,
    /// Rate of the coordinate, of the relative twist.
    pub(super) rate: Vector6<f64>,
    /// Direction that the coordinate adds to those before it; the directions of a joint are orthonormal.
    pub(super) unit: Vector6<f64>,
}

/// Takes apart the twists of the coordinates of a joint that follow.
pub(super) fn allowed_motions(
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
pub(super) struct Motions {
    /// Of all joints, those of each one after the other.
    pub(super) all: Vec<AllowedMotion>,
    /// r: 0 for joints that move freely, towards 1 for joints that hardly move; with it, steps near singular configurations are short.
    pub(super) resistance: f64,
}

impl Motions {
    /// 1 − r²: of a relative twist along an allowed direction, the share that the joint follows.
    pub(super) fn share(&self) -> f64 {
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
    pub(super) allowed: [usize; 2],
}

impl JointRow {
    /// The motions that the joint allows.
    pub(super) fn allowed<'m>(&self, motions: &'m Motions) -> &'m [AllowedMotion] {
        &motions.all[self.allowed[0]..self.allowed[1]]
    }

    /// The part of a twist, or of a wrench, that the joint does not allow, and the share [`Motions::resistance`] of the part that it does.
    pub(super) fn refused(&self, motions: &Motions, of: &Vector6<f64>) -> Vector6<f64> {
        let allowed = self.allowed(motions);
        if allowed.len() == MOST {
            // A joint with six freedoms has no constraint, only round-off.
            return Vector6::zeros();
        }
        let share = 1.0 - motions.resistance;
        allowed.iter().fold(*of, |rest, motion| rest - motion.unit * (share * motion.unit.dot(of)))
    }

    /// Twist of the first link beyond that of the second, at the joint's point.
    pub(super) fn relative(&self, x: &[f64]) -> Vector6<f64> {
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
    pub(super) fn at_middle(&self, side: usize, wrench: &Vector6<f64>) -> Vector6<f64> {
        let force = wrench.fixed_rows::<3>(3);
        let moment = wrench.fixed_rows::<3>(0) + self.arms[side].cross(&force);
        Vector6::new(moment.x, moment.y, moment.z, force[0], force[1], force[2])
    }

    /// Adds what the joint refuses to the normal equations.
    ///
    /// ```text
    ///    ( T_aᵀ M² T_b )  =  T_aᵀ T_b  −  (1 − r²) Σ (T_aᵀ u)(T_bᵀ u)ᵀ        T: twist at the joint's point of a link's own
    /// ```
    pub(super) fn add_to(
        &self,
        motions: &Motions,
        matrix: &mut BlockMatrix,
        pattern: &BlockPattern,
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
                matrix.add_diagonal(pattern, link, &block(side, side));
            }
        }
        if let Some(place) = between {
            let mut block = block(1, 0);
            block.as_flattened_mut().iter_mut().for_each(|entry| *entry = -*entry);
            matrix.add(place, &block);
        }
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
