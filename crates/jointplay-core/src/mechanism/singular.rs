//! Singular configurations of a drive: turning points, and branches that meet.

use nalgebra::{DMatrix, DVector};

use super::MechanismSystem;
use crate::Error;
use crate::constraint::{
    Configuration, Dimension, NewtonLimits, ScaledSystem, System, newton_at_rank, units,
};
use crate::linalg::svd;
use crate::mobility::{instantaneous_mobility, quadrics};

/// Singular values below this share of the largest make a configuration singular.
pub(super) const SINGULAR: f64 = 1e-6;
/// The same for the curve of configurations, whose largest singular value is another.
const CROSSING: f64 = 10.0 * SINGULAR;
/// Entries of quadrics up to this share of the largest count as zero: singular configurations are found to [`SINGULAR`], and their null spaces with them.
const QUADRIC_THRESHOLD: f64 = 1e-4;
/// Distance for which a branch is followed to confirm it, in radians and characteristic lengths.
const RADIUS: f64 = 1e-2;
/// A branch leaves its tangent by no more than this share of [`RADIUS`].
const BENT: f64 = 0.1;
/// Displacements of the drives up to this one at [`RADIUS`] from a singular configuration are round-off of the place of that configuration, which is found to [`SINGULAR`].
const DRIVES_AT_REST: f64 = 10.0 * SINGULAR * RADIUS;
/// Residual of a configuration on the curve, scaled.
const ON_CURVE: f64 = 1e-13;
/// Corrections onto the curve.
const MAX_CORRECTIONS: usize = 20;
/// First step along the curve toward a turning point, and how far one is looked for.
const FIRST_STEP: f64 = 1e-4;
const FARTHEST: f64 = 0.3;

/// The branches of a motion that meet at a configuration.
pub(super) struct MeetingBranches {
    /// How many: 1 where none cross, `None` where second order does not decide.
    pub(super) count: Option<usize>,
    /// Whether the drives reverse on the only branch; `None` where several branches meet, or it is not decided.
    pub(super) drives_reverse: Option<bool>,
}

/// A displacement to the curve, and an orthonormal basis of its tangent directions.
type OnCurve = (DVector<f64>, DMatrix<f64>);

/// The curve of configurations of a drive: the coordinates that follow, and the displacement of the drives.
///
/// The last coordinate is the displacement of the drives in units of their scaled length; without a direction, the drives are held.
pub(super) struct DrivenCurve<'a> {
    system: &'a MechanismSystem<'a>,
    free: &'a [usize],
    /// (f + M) displacement of the drives for a unit of the last coordinate.
    direction: Option<DVector<f64>>,
}

impl<'a> DrivenCurve<'a> {
    pub(super) fn new(
        system: &'a MechanismSystem<'a>,
        free: &'a [usize],
        direction: Option<DVector<f64>>,
    ) -> Self {
        Self { system, free, direction }
    }

    /// The configuration that nothing is displaced from.
    pub(super) fn here(&self) -> Configuration {
        let count = self.free.len() + usize::from(self.direction.is_some());
        Configuration { coordinates: DVector::zeros(count), ..self.system.at_home() }
    }

    fn full(&self, at: &Configuration) -> Configuration {
        let mut full = self.system.at_home();
        for (value, &k) in at.coordinates.iter().zip(self.free) {
            full.coordinates[k] = *value;
        }
        if let Some(direction) = &self.direction {
            let count = full.coordinates.len();
            full.coordinates += direction.rows(0, count) * at.coordinates[self.free.len()];
        }
        full
    }

    /// The same for displacements in the scaled coordinates of the curve.
    fn displaced(&self, by: &DVector<f64>) -> Configuration {
        let columns = units(&self.coordinate_dimensions(), self.characteristic_length());
        Configuration { coordinates: by.component_mul(&columns), ..self.here() }
    }

    /// (f + M) coordinates of a displacement on the curve (m, rad).
    pub(super) fn coordinates(&self, by: &DVector<f64>) -> DVector<f64> {
        let joints = self.full(&self.displaced(by)).coordinates;
        let mut all = DVector::zeros(self.system.home().len());
        all.rows_mut(0, joints.len()).copy_from(&joints);
        self.system.kinematics().moved(self.system.home(), &all)
    }

    /// The point of the curve nearest a displacement, with the tangent directions of the curve there.
    fn on_curve(&self, by: DVector<f64>, rank: usize) -> Result<Option<OnCurve>, Error> {
        let scaled = ScaledSystem::new(self, self.characteristic_length());
        let found = newton_at_rank(
            &scaled,
            &self.here(),
            by,
            &NewtonLimits { rank, corrections: MAX_CORRECTIONS },
            |at| scaled.residual(at),
            |_| ON_CURVE,
            |by| by.norm().is_finite(),
        )?;
        Ok(found.map(|(by, decomposition)| (by, decomposition.null_space(rank))))
    }

    /// Turning point beyond here, where the drives stop and would reverse: (f + M) coordinates, and the displacement of the drives up to there in units of the last coordinate.
    ///
    /// The curve of configurations is followed by its arc, on which a turning point is nothing special, until its tangent has no component along the drives.
    pub(super) fn turning_point(&self, rank: usize) -> Result<Option<(DVector<f64>, f64)>, Error> {
        let along = self.free.len();
        let start = DVector::zeros(along + 1);
        let Some((mut here, tangents)) = self.on_curve(start, rank)? else { return Ok(None) };
        let projected = |tangents: &DMatrix<f64>, before: &DVector<f64>| {
            (tangents * (tangents.transpose() * before)).try_normalize(f64::MIN_POSITIVE)
        };
        let drives = DVector::from_fn(along + 1, |k, _| if k == along { 1.0 } else { 0.0 });
        let Some(mut tangent) = projected(&tangents, &drives) else { return Ok(None) };
        let mut step = FIRST_STEP;
        let mut beyond = None;
        while step < FARTHEST {
            let Some((there, tangents)) = self.on_curve(&here + &tangent * step, rank)? else {
                return Ok(None);
            };
            let Some(next) = projected(&tangents, &tangent) else { return Ok(None) };
            if next[along] <= 0.0 {
                beyond = Some(next[along]);
                break;
            }
            (here, tangent) = (there, next);
            step *= 1.5;
        }
        let Some(mut high_value) = beyond else { return Ok(None) };
        // The component along the drives changes sign within the step: regula falsi, the end that stays being halved.
        let (mut low, mut high, mut low_value) = (0.0, step, tangent[along]);
        let (mut found, mut stayed) = (here.clone(), 0);
        for _ in 0..60 {
            let at = low + (high - low) * low_value / (low_value - high_value);
            let Some((there, tangents)) = self.on_curve(&here + &tangent * at, rank)? else {
                return Ok(None);
            };
            let Some(next) = projected(&tangents, &tangent) else { return Ok(None) };
            let value = next[along];
            found = there;
            if value.abs() < 1e-14 || high - low < 1e-15 {
                break;
            }
            if value > 0.0 {
                (low, low_value) = (at, value);
                high_value *= if stayed == 1 { 0.5 } else { 1.0 };
                stayed = 1;
            } else {
                (high, high_value) = (at, value);
                low_value *= if stayed == 2 { 0.5 } else { 1.0 };
                stayed = 2;
            }
        }
        Ok(Some((self.coordinates(&found), found[along])))
    }

    /// The branches of the motion that meet here.
    ///
    /// # Arguments
    /// * `rank` – of the constraints at configurations nearby
    pub(super) fn branches(&self, rank: usize) -> Result<MeetingBranches, Error> {
        let here = self.here();
        let first = instantaneous_mobility(self, &here, CROSSING)?;
        if first.rank >= rank {
            let drives_reverse = self.drives_reverse(&first.null_space, rank)?;
            return Ok(MeetingBranches { count: Some(1), drives_reverse });
        }
        let undecided = MeetingBranches { count: None, drives_reverse: None };
        let quadrics = quadrics(self, &here, &first);
        let largest = quadrics.iter().map(DMatrix::amax).fold(0.0, f64::max);
        let h = first.mobility;
        let stacked = DMatrix::from_fn(h * quadrics.len(), h, |row, column| {
            quadrics[row / h][(row % h, column)]
        });
        let stacked = svd(&stacked)?;
        let cut = QUADRIC_THRESHOLD * largest;
        let stopped = stacked.singular_values.iter().filter(|&&value| value > cut).count();
        // Motions on which no quadric depends, such as idle freedoms, continue along every branch.
        if largest <= QUADRIC_THRESHOLD || stopped != 2 {
            return Ok(undecided);
        }
        let plane = stacked.v.columns(0, 2);
        let Some(lines) = lines(&quadrics, &plane.into_owned(), cut)? else {
            return Ok(undecided);
        };
        let mut branches = Vec::new();
        for line in lines {
            let tangent = &first.null_space * (plane * line);
            if self.followed(&tangent, rank)?.is_some() {
                branches.push(tangent);
            }
        }
        match &branches[..] {
            [] => Ok(undecided),
            [only] => {
                let tangent = DMatrix::from_column_slice(only.len(), 1, only.as_slice());
                let drives_reverse = self.drives_reverse(&tangent, rank)?;
                Ok(MeetingBranches { count: Some(1), drives_reverse })
            }
            _ => Ok(MeetingBranches { count: Some(branches.len()), drives_reverse: None }),
        }
    }

    /// The point of the curve at [`RADIUS`] along a tangent of unit length, if the curve leaves the tangent by little up to there.
    fn followed(&self, tangent: &DVector<f64>, rank: usize) -> Result<Option<DVector<f64>>, Error> {
        let by = tangent * RADIUS;
        let there = self.on_curve(by.clone(), rank)?.map(|(there, _)| there);
        Ok(there.filter(|there| (there - &by).norm() <= BENT * RADIUS))
    }

    /// Whether the drives are displaced to the same side along a branch and against it; `None` where the branch is not followed to both sides, or the drives rest on it.
    ///
    /// Among several tangents, which idle freedoms add to the one of the branch, the one along which the drives move most decides.
    fn drives_reverse(&self, tangents: &DMatrix<f64>, rank: usize) -> Result<Option<bool>, Error> {
        let along = self.free.len();
        let mut most = (DRIVES_AT_REST, None);
        for tangent in tangents.column_iter() {
            let tangent = tangent.into_owned();
            let (Some(there), Some(back)) =
                (self.followed(&tangent, rank)?, self.followed(&-tangent, rank)?)
            else {
                continue;
            };
            let sides = [there[along], back[along]];
            let moved = sides[0].abs().min(sides[1].abs());
            if moved > most.0 {
                most = (moved, Some(sides[0] * sides[1] > 0.0));
            }
        }
        Ok(most.1)
    }
}

/// Directions in a plane on which all quadrics vanish; `None` where two of them fall together.
fn lines(
    quadrics: &[DMatrix<f64>],
    plane: &DMatrix<f64>,
    cut: f64,
) -> Result<Option<Vec<DVector<f64>>>, Error> {
    let restricted: Vec<DMatrix<f64>> =
        quadrics.iter().map(|quadric| plane.transpose() * quadric * plane).collect();
    // Each is a x² + 2 b x y + c y²; independent combinations of them, the largest first.
    let rows = DMatrix::from_fn(restricted.len(), 3, |s, k| {
        let quadric = &restricted[s];
        [quadric[(0, 0)], quadric[(0, 1)], quadric[(1, 1)]][k]
    });
    let combined = svd(&rows)?;
    let count = combined.singular_values.iter().filter(|&&value| value > cut).count();
    let value = |k: usize, line: &DVector<f64>| {
        let of = combined.v.column(k);
        of[0] * line[0] * line[0] + 2.0 * of[1] * line[0] * line[1] + of[2] * line[1] * line[1]
    };
    let [a, b, c] = [0, 1, 2].map(|k| combined.v[(k, 0)]);
    let discriminant = b * b - a * c;
    if discriminant.abs() < QUADRIC_THRESHOLD {
        return Ok(None);
    }
    if discriminant < 0.0 {
        return Ok(Some(Vec::new()));
    }
    // (x, y) with a x² + 2 b x y + c y² = 0, from the larger sum so that nothing cancels.
    let sum = -(b + discriminant.sqrt().copysign(b));
    let candidates = [[sum, a], [c, sum]].map(|line| DVector::from_row_slice(&line).normalize());
    let lines = candidates
        .into_iter()
        .filter(|line| (1..count).all(|k| value(k, line).abs() <= QUADRIC_THRESHOLD));
    Ok(Some(lines.collect()))
}

impl System for DrivenCurve<'_> {
    fn constraint_dimensions(&self) -> Vec<Dimension> {
        self.system.constraint_dimensions()
    }

    fn coordinate_dimensions(&self) -> Vec<Dimension> {
        let all = self.system.coordinate_dimensions();
        let drives = self.direction.iter().map(|_| Dimension::Angle);
        self.free.iter().map(|&k| all[k]).chain(drives).collect()
    }

    fn virtual_joint_dimensions(&self) -> Vec<Dimension> {
        self.system.virtual_joint_dimensions()
    }

    fn characteristic_length(&self) -> f64 {
        self.system.characteristic_length()
    }

    fn round_off(&self) -> f64 {
        self.system.round_off()
    }

    fn residual(&self, at: &Configuration) -> DVector<f64> {
        self.system.residual(&self.full(at))
    }

    fn constraint_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        let all = self.system.constraint_jacobian(&self.full(at));
        let count = self.free.len();
        let mut jacobian =
            all.select_columns(self.free).resize_horizontally(at.coordinates.len(), 0.0);
        if let Some(direction) = &self.direction {
            jacobian.set_column(count, &(&all * direction.rows(0, all.ncols())));
        }
        jacobian
    }

    fn virtual_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        self.system.virtual_jacobian(&self.full(at))
    }

    fn second_derivative(&self, at: &Configuration, direction: &DVector<f64>) -> DVector<f64> {
        let along = Configuration { coordinates: direction.clone(), ..at.clone() };
        let along = self.full(&along).coordinates;
        self.system.second_derivative(&self.full(at), &along)
    }
}
