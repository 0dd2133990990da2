//! Mobility of mechanisms with many loops.

use nalgebra::{DMatrix, DVector, Vector3};

use super::linear::Linear;
use super::system::SparseSystem;
use crate::Error;
use crate::constraint::{ACCEPTED_RESIDUAL, Dimension};
use crate::mechanism::kinematics::TwistAndRate;
use crate::mechanism::{MechanismSystem, blocks};
use crate::mobility::{SecondOrder, finite_mobility};
use crate::random::Random;

/// Distance for which the fastest coordinate is followed in every direction, in radians and characteristic lengths: one step where its correction is small.
const KEPT: f64 = 0.3;
/// The shortest step of that, as a share of it.
const SHORTEST_STEP: f64 = 1e-2;
/// Changes of a projection onto what joints can meet below this share of it are the end.
const SETTLED: f64 = 1e-12;

/// Mobility of a mechanism with many loops, with its evidence.
///
/// Rank and redundancy are those of the loop closures, as in [`crate::mobility::InstantaneousMobility`]; singular values are those of the joint closures in link twists.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseMobility {
    /// Instantaneous mobility: dimension of the null space of the constraint Jacobian.
    pub mobility: usize,
    /// Independent loop closures.
    pub rank: usize,
    /// Number of redundant loop closures.
    pub redundancy: usize,
    /// Finite mobility, or `None` where the bounds differ.
    pub finite: Option<usize>,
    /// Lower bound of the finite mobility: 0 where not every direction could be followed.
    pub lower_bound: usize,
    /// Dimension that first and second order leave room for.
    pub upper_bound: usize,
    /// Independent motions of first order: of each the coordinates that move, with their rates; lengths in characteristic lengths.
    pub motions: Vec<Vec<(usize, f64)>>,
    /// Largest singular value.
    pub largest: f64,
    /// Least singular value that counts, if there is one.
    pub smallest_nonzero: Option<f64>,
    /// Largest singular value that counts as zero, if one does.
    pub largest_zero: Option<f64>,
    /// Values at or below this one count as zero.
    pub threshold: f64,
    /// Length by which lengths and angles are compared (m).
    pub characteristic_length: f64,
}

/// Entries of a null space above which it is not written as a matrix: a tree of 1,000 hinges has as many.
const MAX_ENTRIES: usize = 1_000_000;

impl SparseMobility {
    /// (f, mobility) the motions as a matrix, one a column; `None` beyond a million entries.
    #[must_use]
    pub fn null_space(&self) -> Option<DMatrix<f64>> {
        let freedoms = self.rank + self.mobility;
        if freedoms.saturating_mul(self.mobility) > MAX_ENTRIES {
            return None;
        }
        let mut all = DMatrix::zeros(freedoms, self.mobility);
        for (column, motion) in self.motions.iter().enumerate() {
            motion.iter().for_each(|&(k, rate)| all[(k, column)] = rate);
        }
        Some(all)
    }

    /// A mechanism without joints, to which blocks are added.
    fn nothing(characteristic_length: f64) -> Self {
        Self {
            mobility: 0,
            rank: 0,
            redundancy: 0,
            finite: Some(0),
            lower_bound: 0,
            upper_bound: 0,
            motions: Vec::new(),
            largest: 0.0,
            smallest_nonzero: None,
            largest_zero: None,
            threshold: 0.0,
            characteristic_length,
        }
    }

    /// Adds a block, whose coordinates have these indices and dimensions in the whole.
    fn add(&mut self, block: &Self, coordinates: &[usize], dimensions: &[Dimension]) {
        self.mobility += block.mobility;
        self.rank += block.rank;
        self.redundancy += block.redundancy;
        self.finite = self.finite.zip(block.finite).map(|(sum, found)| sum + found);
        self.lower_bound += block.lower_bound;
        self.upper_bound += block.upper_bound;
        let unit = |k: usize| match dimensions[k] {
            Dimension::Angle => 1.0,
            _ => block.characteristic_length / self.characteristic_length,
        };
        let motions = block.motions.iter().map(|motion| {
            motion.iter().map(|&(k, rate)| (coordinates[k], rate * unit(coordinates[k]))).collect()
        });
        self.motions.extend(motions);
        self.largest = self.largest.max(block.largest);
        let counted = [self.smallest_nonzero, block.smallest_nonzero].into_iter().flatten();
        self.smallest_nonzero = counted.reduce(f64::min);
        let uncounted = [self.largest_zero, block.largest_zero].into_iter().flatten();
        self.largest_zero = uncounted.reduce(f64::max);
        self.threshold = self.threshold.max(block.threshold);
    }
}

impl SparseSystem<'_> {
    /// Mobility of the closed mechanism, instantaneous and finite, block by block.
    ///
    /// # Arguments
    /// * `relative_threshold` – [`crate::mobility::RANK_THRESHOLD`], or another share of the largest singular value
    ///
    /// # Errors
    /// [`Error::NotClosed`] if a joint is open.
    ///
    /// # Numerics
    /// Least singular values from the Krylov space of the inverse, with the sparse factor of the damped normal equations; the violation by each vector is formed without squaring, so that zeros are exact to round-off.
    /// The least value that counts is known to 2 × 10⁻³, unless the next one is nearer: then between both, and to 3 % at worst.
    /// All motions are finite if every direction of a few at random, more than there are motions, can be followed for 0.3 rad of its fastest joint.
    /// Otherwise second derivatives bound the mobility from above, and the lower bound is left at zero, unless the block is small enough for [`finite_mobility`], which then decides.
    /// A joint on no loop needs no linear algebra: the time for a tree is proportional to its joints.
    ///
    /// # Source
    /// \[GolubVanLoan\], sections 10.1 and 10.3, for Krylov spaces; the bounds as in [`crate::mobility::finite_mobility`]
    pub fn mobility(&self, relative_threshold: f64) -> Result<SparseMobility, Error> {
        let residual = self.residual();
        if residual.is_nan() || residual > ACCEPTED_RESIDUAL {
            return Err(Error::NotClosed { residual, allowed: ACCEPTED_RESIDUAL });
        }
        let blocks = blocks(self.kinematics.mechanism());
        if let [one] = blocks.as_slice()
            && one.has_constraints()
        {
            return self.block_mobility(relative_threshold);
        }
        let dimensions = self.kinematics.dimensions();
        let mut all = SparseMobility::nothing(self.length);
        for block in &blocks {
            if !block.has_constraints() {
                for k in self.kinematics.coordinates_of(block.joints[0]) {
                    all.mobility += 1;
                    all.motions.push(vec![(k, 1.0)]);
                }
                let freedoms = self.kinematics.coordinates_of(block.joints[0]).len();
                all.finite = all.finite.map(|sum| sum + freedoms);
                all.lower_bound += freedoms;
                all.upper_bound += freedoms;
                continue;
            }
            let (part, links) = block.mechanism(self.kinematics.mechanism());
            let coordinates = block.coordinates(&self.kinematics);
            let home = coordinates.iter().map(|&k| self.coordinates[k]);
            let mut system =
                SparseSystem::new(&part, DVector::from_iterator(coordinates.len(), home))?;
            // The current poses of the links, and not those from the tree of the block.
            let base = self.poses[block.base].inverse();
            system.poses = links.iter().map(|&link| base * self.poses[link]).collect();
            all.add(&system.block_mobility(relative_threshold)?, &coordinates, dimensions);
        }
        Ok(all)
    }

    /// Mobility of a mechanism as a whole.
    fn block_mobility(&self, relative_threshold: f64) -> Result<SparseMobility, Error> {
        let held = self.held([]);
        let linear = self.linear(&held, 0.0, None)?;
        let spectrum = linear.smallest(relative_threshold, 4)?;
        let mechanism = self.kinematics.mechanism();
        let freedoms = mechanism.joint_freedoms();
        let independent = linear.allowed();
        // Links that stay where they are while a coordinate moves: joints whose own motions depend on each other.
        let idle = freedoms - independent;
        let mobility = spectrum.zeros + idle;
        let rank = freedoms - mobility;
        let redundancy = mechanism.constraints() - rank;
        let twists = spectrum.vectors.columns(0, spectrum.zeros).into_owned();
        let still = DVector::zeros(6 * linear.joints.len());
        let rates: Vec<DVector<f64>> = twists
            .column_iter()
            .map(|x| linear.rates(x.as_slice(), &still, self.coordinates.len()))
            .collect();
        let first_order_decides = redundancy == 0 || mobility == 0;
        let (lower_bound, upper_bound) =
            if first_order_decides || (idle == 0 && self.all_kept(&rates)?) {
                (mobility, mobility)
            } else if let Some(bounds) = self.dense_bounds(relative_threshold, mobility)? {
                bounds
            } else {
                let quadrics = self.quadrics(&linear, &twists, &rates)?;
                (0, SecondOrder::from_quadrics(quadrics, spectrum.zeros)?.upper_bound + idle)
            };
        let units = self.units();
        let motions = rates.iter().map(|rates| {
            let scaled = rates.component_div(&units);
            scaled.iter().copied().enumerate().take(freedoms).collect()
        });
        let motions = motions.collect();
        Ok(SparseMobility {
            mobility,
            rank,
            redundancy,
            finite: (lower_bound == upper_bound).then_some(lower_bound),
            lower_bound,
            upper_bound,
            motions,
            largest: spectrum.largest,
            smallest_nonzero: spectrum.values.get(spectrum.zeros).copied(),
            largest_zero: spectrum.zeros.checked_sub(1).map(|last| spectrum.values[last]),
            threshold: relative_threshold * spectrum.largest,
            characteristic_length: self.length,
        })
    }

    /// Bounds of the finite mobility by dense algebra, where the mechanism is small enough and its first order is the same.
    fn dense_bounds(
        &self,
        relative_threshold: f64,
        mobility: usize,
    ) -> Result<Option<(usize, usize)>, Error> {
        let mechanism = self.kinematics.mechanism();
        if !MechanismSystem::fits(mechanism) {
            return Ok(None);
        }
        let system = MechanismSystem::new(mechanism, self.coordinates.clone())?;
        match finite_mobility(&system, &system.at_home(), relative_threshold) {
            Ok(found) if found.instantaneous.mobility == mobility => {
                Ok(Some((found.lower_bound, found.upper_bound)))
            }
            // Open by the measure of loops.
            Ok(_) | Err(Error::NotClosed { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Whether motions in random directions, each given by as many coordinates as there are motions, are all finite; of a single motion, both directions.
    fn all_kept(&self, rates: &[DVector<f64>]) -> Result<bool, Error> {
        let units = self.units();
        let leading = leading(rates, &units);
        let held = self.held(leading.iter().copied());
        let (here, mut former) = (self.linear(&held, 0.0, None)?, None);
        let mut random = Random(2);
        let directions: Vec<Vec<f64>> = match rates {
            [_] => vec![vec![1.0], vec![-1.0]],
            _ => (0..rates.len() + 2)
                .map(|_| rates.iter().map(|_| random.next()).collect())
                .collect(),
        };
        for shares in directions {
            let mut direction = DVector::zeros(self.coordinates.len());
            for (rate, share) in rates.iter().zip(shares) {
                direction.axpy(share, rate, 1.0);
            }
            direction *= KEPT / self.largest(&direction);
            let mut drives = DVector::zeros(direction.len());
            for &k in &leading {
                drives[k] = direction[k];
            }
            let mut there = self.clone();
            let done = there.follow(&drives, &held, &here, &mut 1.0, SHORTEST_STEP, &mut former)?;
            if done < 1.0 {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Second-order violations that no first-order motion can compensate, as quadrics of the motions.
    fn quadrics(
        &self,
        linear: &Linear,
        twists: &DMatrix<f64>,
        rates: &[DVector<f64>],
    ) -> Result<Vec<DMatrix<f64>>, Error> {
        let h = rates.len();
        let pairs: Vec<(usize, usize)> =
            (0..h).flat_map(|a| (0..=a).map(move |b| (a, b))).collect();
        let open: Vec<DVector<f64>> = pairs
            .iter()
            .map(|&(a, b)| {
                let along = |sign: f64| {
                    let x = twists.column(a) + twists.column(b) * sign;
                    self.second_derivative(linear, &x, &(&rates[a] + &rates[b] * sign))
                };
                let mixed = (along(1.0) - along(-1.0)) * 0.25;
                let met = linear.apply(linear.solve_least(&mixed, SETTLED).as_slice());
                mixed - met
            })
            .collect();
        if open.is_empty() {
            return Ok(Vec::new());
        }
        let combined = DMatrix::from_columns(&open).qr().r();
        let quadrics = combined.row_iter().map(|row| {
            let mut quadric = DMatrix::zeros(h, h);
            for (&(a, b), &value) in pairs.iter().zip(row.iter()) {
                quadric[(a, b)] = value;
                quadric[(b, a)] = value;
            }
            quadric
        });
        Ok(quadrics.collect())
    }

    /// Violation of each joint and coupling as links and coordinates continue at constant speed: second derivative of closures and couplings.
    fn second_derivative(
        &self,
        linear: &Linear,
        x: &DVector<f64>,
        rates: &DVector<f64>,
    ) -> DVector<f64> {
        let still = Vector3::zeros();
        let mut broken = DVector::zeros(6 * linear.joints.len());
        for (j, joint) in linear.joints.iter().enumerate() {
            let (angular, at_point) =
                joint.links[0].checked_sub(1).map_or((still, still), |link| {
                    let angular = x.fixed_rows::<3>(6 * link).into_owned();
                    let linear = x.fixed_rows::<3>(6 * link + 3) + angular.cross(&joint.arms[0]);
                    (angular, linear * self.length)
                });
            let from = TwistAndRate { velocity: (angular, at_point), acceleration: (still, still) };
            let no_rates = vec![still; self.kinematics.chains()[j].elements.len()];
            let beyond = self.kinematics.through(&linear.screws, &no_rates, j, rates, &from);
            let (angular, linear) = beyond.acceleration;
            broken.fixed_rows_mut::<6>(6 * j).copy_from(&self.scaled(&angular, &linear));
        }
        // Links that do not accelerate require accelerations of the coordinates, which the couplings join.
        let still = DVector::zeros(linear.size());
        let following = linear.rates(still.as_slice(), &broken, self.coordinates.len());
        linear.violated(&broken, &following)
    }

    fn units(&self) -> DVector<f64> {
        crate::constraint::units(self.kinematics.dimensions(), self.length)
    }
}

/// Coordinates that distinguish the motions best, one for each.
fn leading(rates: &[DVector<f64>], units: &DVector<f64>) -> Vec<usize> {
    let mut rest: Vec<DVector<f64>> = rates.iter().map(|rate| rate.component_div(units)).collect();
    let mut leading = Vec::with_capacity(rest.len());
    for motion in 0..rest.len() {
        let mut best = (motion, 0, -1.0);
        for (m, rate) in rest.iter().enumerate().skip(motion) {
            let k = rate.iamax();
            if rate[k].abs() > best.2 {
                best = (m, k, rate[k].abs());
            }
        }
        let (m, k, size) = best;
        rest.swap(motion, m);
        leading.push(k);
        if size > 0.0 {
            let pivot = &rest[motion] / rest[motion][k];
            for rate in rest.iter_mut().skip(motion + 1) {
                let factor = rate[k];
                *rate -= &pivot * factor;
            }
        }
    }
    leading
}
