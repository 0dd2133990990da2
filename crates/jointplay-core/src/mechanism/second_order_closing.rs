//! Closing loops where corrections end at a near miss: steps of second order.

use nalgebra::{DMatrix, DVector};

use super::closing::close;
use super::closure::Closure;
use super::limits::within_limits;
use super::singular::DrivenCurve;
use super::system::MechanismSystem;
use crate::Error;
use crate::constraint::{ScaledSystem, System, units};
use crate::linalg::svd;
use crate::mobility::{InstantaneousMobility, TOLERANCES, instantaneous_mobility, quadrics};

/// Singular values up to this many times the root of the residual are those of soft motions: a soft motion that closes the loops is about as long as that root, and its singular value becomes about as large.
const SOFT: f64 = 3.0;
/// Singular values above this are always stiff.
const STIFF: f64 = 0.1;
/// Longest natural length of a soft motion, in radians and characteristic lengths: that of motions without curvature, which exact dimensions leave free; and longest step of stiff motions.
const LONGEST: f64 = 0.5;
/// Longest step of soft motions, in their natural lengths; a shorter one follows where it gains nothing.
const LONGEST_STEPS: [f64; 3] = [2.0, 0.5, 0.125];
/// Steps from one near miss.
const MAX_STEPS: usize = 24;
/// A step that leaves more than this share of the residual gains nothing.
const GAINED: f64 = 0.98;
/// Corrections after a step.
const MAX_CORRECTIONS: usize = 60;
/// Steps of the descent of the quadratic model, and halvings of one.
const MAX_DESCENT: usize = 60;
const MAX_HALVINGS: usize = 12;
/// Curvatures below this share of the largest are none.
const NO_CURVATURE: f64 = 1e-9;
/// Minima of the model nearer to each other than this are one, in natural lengths.
const SAME_MINIMUM: f64 = 1e-3;
/// Soft motions are looked at up to this number: their quadrics cost its square.
const MAX_SOFT: usize = 48;

/// Closes loops that corrections of first order leave open by a small mismatch, within the limits of the free coordinates; `None` where no step of second order leads to a closed configuration, and for mechanisms with virtual joints, which take up a small mismatch.
///
/// Dimensions that are inaccurate by ε leave a mismatch of the size of ε near a singular configuration of the exact mechanism.
/// Corrections of first order end there: the soft motions, whose singular values are as small as ε, change the mismatch by their curvature alone, and its gradient vanishes.
/// Where the remaining constraints are satisfied, what is left is a system of quadrics in the soft motions a,
///
/// ```text
///    e + L a + ½ Q(a, a)  =  0        e, L: mismatch and Jacobian in the left singular vectors of the soft motions
/// ```
/// Its roots are as long as the root of ε, and at a configuration where Lᵀ e = 0 and L a is small against e, a root a* has negative curvature: e · Q(a*, a*) = −2 |e|².
/// In units of a natural length of each motion, the root of |e| over its curvature, all numbers of the system are of the order one, whatever ε is.
///
/// # Arguments
/// * `system` – its reference point and lengths are used throughout
/// * `free` – indices of the coordinates that may move
/// * `near` – where corrections of first order ended
///
/// # Errors
/// [`Error::Linalg`] (never seen).
///
/// # Numerics
/// The sum of squares of the model is descended from both sides along each direction of negative curvature; each minimum is corrected by [`close`], and the one with the least mismatch is the next near miss.
/// A descent may end at a near miss although a closed configuration exists.
/// Second derivatives are those of the sine of an angular mismatch; those of its rotation vector differ by terms of the size of the squared mismatch.
///
/// # Source
/// Own derivation, `docs/explanation/mechanisms.md`; directions of negative curvature: \[NocedalWright\], chapter 3
pub(super) fn close_at_second_order(
    system: &MechanismSystem<'_>,
    free: &[usize],
    near: &Closure,
) -> Result<Option<Closure>, Error> {
    if near.is_closed() || near.residual.is_nan() || near.residual > *TOLERANCES.end() {
        return Ok(None);
    }
    let mechanism = system.kinematics().mechanism();
    if !mechanism.virtual_joints().is_empty() {
        return Ok(None);
    }
    let mut here = system.moved_to(near.coordinates.clone())?;
    let mut iterations = near.iterations;
    for _ in 0..MAX_STEPS {
        let before = mismatch(&here);
        let Some(model) = Model::new(&here, free, before)? else { break };
        let mut least: Option<(f64, Closure)> = None;
        for longest in LONGEST_STEPS {
            for minimum in model.minima(longest)? {
                let there = here.moved_to(model.coordinates(&here, free, &minimum))?;
                let found = close(&there, free, MAX_CORRECTIONS)?;
                iterations += found.iterations;
                if found.is_closed() {
                    if within_limits(mechanism, free, &found.coordinates) {
                        return Ok(Some(Closure { iterations, is_searched: true, ..found }));
                    }
                    continue;
                }
                let reached = mismatch(&here.moved_to(found.coordinates.clone())?);
                if reached < least.as_ref().map_or(GAINED * before, |(least, _)| *least) {
                    least = Some((reached, found));
                }
            }
            if least.is_some() {
                break;
            }
        }
        let Some((_, next)) = least else { break };
        here = here.moved_to(next.coordinates)?;
    }
    Ok(None)
}

/// The near miss next to a guess: the loops closed as far as stiff motions can close them, soft ones at rest.
///
/// Corrections by all motions may move far along soft ones, which change the mismatch little, and end beyond limits although a closed configuration is near the guess.
///
/// # Errors
/// [`Error::Linalg`] (never seen).
pub(super) fn near_miss_at(guess: &MechanismSystem<'_>, free: &[usize]) -> Result<Closure, Error> {
    let mut here = guess.clone();
    let (mut before, mut iterations) = (mismatch(&here), 0);
    while iterations < MAX_CORRECTIONS {
        let curve = DrivenCurve::new(&here, free, None);
        let scaled = ScaledSystem::new(&curve, curve.characteristic_length());
        let decomposition = scaled.decomposed(&curve.here())?;
        let soft = (SOFT * before.sqrt()).min(STIFF);
        let values = decomposition.singular_values.iter();
        let step = -decomposition
            .solve(&scaled.residual(&curve.here()), values.filter(|&&value| value > soft).count());
        let share = (LONGEST / step.norm()).min(1.0);
        let there = here.moved_to(curve.coordinates(&(step * share)))?;
        let reached = mismatch(&there);
        iterations += 1;
        if reached.is_nan() || reached > GAINED * before {
            break;
        }
        (here, before) = (there, reached);
    }
    let residual = here.mismatch(&here.at_home());
    Ok(Closure { coordinates: here.home().clone(), residual, iterations, is_searched: false })
}

/// Norm of the mismatch at home, in radians and characteristic lengths.
fn mismatch(system: &MechanismSystem<'_>) -> f64 {
    let rows = units(&system.constraint_dimensions(), system.characteristic_length());
    system.residual(&system.at_home()).component_div(&rows).norm()
}

/// The mismatch in soft motions, each in its natural length, up to second order, and as a share of the mismatch.
struct Model {
    open: DVector<f64>,
    linear: DMatrix<f64>,
    quadrics: Vec<DMatrix<f64>>,
    /// (n, soft) motions of the free coordinates for a natural length, in radians and characteristic lengths.
    motions: DMatrix<f64>,
}

impl Model {
    /// `None` where the soft motions have no curvature, or there are too many.
    fn new(
        here: &MechanismSystem<'_>,
        free: &[usize],
        mismatch: f64,
    ) -> Result<Option<Self>, Error> {
        let curve = DrivenCurve::new(here, free, None);
        let at = curve.here();
        let scaled = ScaledSystem::new(&curve, curve.characteristic_length());
        let jacobian = scaled.jacobian(&at);
        let largest = svd(&jacobian)?.largest();
        let first = instantaneous_mobility(&curve, &at, SOFT * mismatch.sqrt() / largest)?;
        if first.mobility == 0 || first.redundancy == 0 || first.mobility > MAX_SOFT {
            return Ok(None);
        }
        let quadrics = quadrics(&curve, &at, &first);
        let InstantaneousMobility { null_space, self_stress, mobility: h, .. } = first;
        let stacked = DMatrix::from_fn(h * quadrics.len(), h, |row, column| {
            quadrics[row / h][(row % h, column)]
        });
        let curvatures = svd(&stacked)?;
        if curvatures.largest() * LONGEST * LONGEST <= mismatch {
            return Ok(None);
        }
        let lengths = DVector::from_fn(h, |k, _| {
            let curvature = curvatures.singular_values.get(k).copied().unwrap_or(0.0);
            (mismatch / curvature.max(f64::MIN_POSITIVE)).sqrt().min(LONGEST)
        });
        let of_soft = &curvatures.v * DMatrix::from_diagonal(&lengths);
        let motions = &null_space * &of_soft;
        let per_mismatch = 1.0 / mismatch;
        Ok(Some(Self {
            open: self_stress.tr_mul(&scaled.residual(&at)) * per_mismatch,
            linear: self_stress.tr_mul(&(jacobian * &motions)) * per_mismatch,
            quadrics: quadrics
                .iter()
                .map(|quadric| of_soft.tr_mul(&(quadric * &of_soft)) * per_mismatch)
                .collect(),
            motions,
        }))
    }

    /// (f + M) coordinates after soft motions (m, rad).
    fn coordinates(
        &self,
        here: &MechanismSystem<'_>,
        free: &[usize],
        by: &DVector<f64>,
    ) -> DVector<f64> {
        DrivenCurve::new(here, free, None).coordinates(&(&self.motions * by))
    }

    /// Mismatch after soft motions, and its derivative.
    fn linearized(&self, by: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let products: Vec<DVector<f64>> = self.quadrics.iter().map(|q| q * by).collect();
        let curved = DVector::from_iterator(products.len(), products.iter().map(|p| p.dot(by)));
        let value = &self.open + &self.linear * by + curved * 0.5;
        let mut derivative = self.linear.clone();
        for (mut row, product) in derivative.row_iter_mut().zip(&products) {
            row += product.transpose();
        }
        (value, derivative)
    }

    /// Minima of the mismatch within a distance, in natural lengths: the closed ones first, the nearer ones first; then by their mismatch.
    fn minima(&self, longest: f64) -> Result<Vec<DVector<f64>>, Error> {
        let count = self.motions.ncols();
        let (value, derivative) = self.linearized(&DVector::zeros(count));
        let curvature = self.curvature(&value, &derivative).symmetric_eigen();
        let cut = NO_CURVATURE * curvature.eigenvalues.amax();
        let mut starts = vec![DVector::zeros(count)];
        for (k, &eigenvalue) in curvature.eigenvalues.iter().enumerate() {
            if eigenvalue < -cut {
                let direction = curvature.eigenvectors.column(k).into_owned();
                starts.extend([&direction * longest, &direction * -longest]);
            }
        }
        let mut found: Vec<(f64, DVector<f64>)> = Vec::new();
        for start in starts {
            let (size, minimum) = self.descended(start, longest);
            let is_known = |(_, known): &(f64, DVector<f64>)| {
                (known - &minimum).norm() <= SAME_MINIMUM * longest
            };
            if minimum.norm() > SAME_MINIMUM * longest && !found.iter().any(is_known) {
                found.push((size, minimum));
            }
        }
        let key = |(size, minimum): &(f64, DVector<f64>)| {
            if *size <= SAME_MINIMUM { (0.0, minimum.norm()) } else { (*size, 0.0) }
        };
        found.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        Ok(found.into_iter().map(|(_, minimum)| minimum).collect())
    }

    /// Second derivative of half the sum of squares.
    fn curvature(&self, value: &DVector<f64>, derivative: &DMatrix<f64>) -> DMatrix<f64> {
        let first = derivative.tr_mul(derivative);
        let parts = self.quadrics.iter().zip(value.iter());
        parts.fold(first, |sum, (quadric, value)| sum + quadric * *value)
    }

    /// A minimum of the mismatch within a distance, by Newton steps whose curvatures are taken without sign, and the mismatch there.
    fn descended(&self, mut by: DVector<f64>, longest: f64) -> (f64, DVector<f64>) {
        let (mut value, mut derivative) = self.linearized(&by);
        for _ in 0..MAX_DESCENT {
            let gradient = derivative.tr_mul(&value);
            let curvature = self.curvature(&value, &derivative).symmetric_eigen();
            let least = NO_CURVATURE * curvature.eigenvalues.amax();
            let along = curvature.eigenvectors.tr_mul(&gradient);
            let step = along.zip_map(&curvature.eigenvalues, |along, eigenvalue| {
                -along / eigenvalue.abs().max(least).max(f64::MIN_POSITIVE)
            });
            let step = &curvature.eigenvectors * step;
            let before = value.norm();
            let mut share = 1.0;
            let mut accepted = false;
            for _ in 0..MAX_HALVINGS {
                let mut there = &by + &step * share;
                let far = there.norm() / longest;
                if far > 1.0 {
                    there /= far;
                }
                let reached = self.linearized(&there);
                if reached.0.norm() < before * (1.0 - NO_CURVATURE) {
                    by = there;
                    (value, derivative) = reached;
                    accepted = true;
                    break;
                }
                share *= 0.5;
            }
            if !accepted {
                break;
            }
        }
        (value.norm(), by)
    }
}
