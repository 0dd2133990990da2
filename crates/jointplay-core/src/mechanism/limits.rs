//! Joint limits, and clearances of virtual joints.

use nalgebra::DVector;

use super::{Kinematics, Mechanism};

/// Round-off at a limit is not beyond it: this share of the range, or of 1 m or 1 rad where the range has one end only.
pub(super) const ROUND_OFF: f64 = 1e-9;

/// A joint coordinate beyond its limits, or a virtual joint beyond its clearance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeyondLimits {
    /// Index of the coordinate: joints, then virtual joints.
    pub coordinate: usize,
    /// Value found (m or rad).
    pub value: f64,
    /// Least and greatest value allowed, infinite where there is none (m or rad).
    pub limits: [f64; 2],
}

impl BeyondLimits {
    /// The limit that the value is beyond (m or rad).
    #[must_use]
    pub fn nearest(&self) -> f64 {
        self.value.clamp(self.limits[0], self.limits[1])
    }

    /// How far the value is beyond, as a share of the range.
    #[must_use]
    pub fn share(&self) -> f64 {
        (self.value - self.nearest()).abs() / range_scale(self.limits).max(f64::MIN_POSITIVE)
    }
}

/// Length of a range; 1 m or 1 rad where it has one end only.
pub(super) fn range_scale([least, greatest]: [f64; 2]) -> f64 {
    let range = greatest - least;
    if range.is_finite() { range } else { 1.0 }
}

/// Whether coordinates are within their limits.
///
/// # Arguments
/// * `among` – indices of the coordinates that are looked at
/// * `coordinates` – (f + M) (m, rad)
pub(super) fn within_limits(
    mechanism: &Mechanism,
    among: &[usize],
    coordinates: &DVector<f64>,
) -> bool {
    mechanism.beyond_limits(coordinates).iter().all(|one| !among.contains(&one.coordinate))
}

impl Mechanism {
    /// Limits of every coordinate, joints, then virtual joints (m or rad); `None` where there are none.
    fn all_limits(&self) -> impl Iterator<Item = Option<[f64; 2]>> + '_ {
        let of_joints = self
            .joints()
            .iter()
            .flat_map(|joint| (0..joint.kind.freedoms()).map(|k| joint.limits.get(k).copied()))
            .map(|limits| limits.filter(|range| range.iter().any(|end| end.is_finite())));
        let clearance = |most: f64| [-most, most];
        of_joints.chain(self.virtual_joints().iter().map(move |one| one.clearance.map(clearance)))
    }

    /// (f + M) limits of every coordinate, see [`Mechanism::beyond_limits`]; infinite at an end without limit (m, rad).
    #[must_use]
    pub fn limits(&self) -> Vec<Option<[f64; 2]>> {
        self.all_limits().collect()
    }

    /// The coordinate that differs most between two configurations, relative to a turn of one radian and a length, and by how much (m or rad); `None` without coordinates.
    ///
    /// # Arguments
    /// * `from`, `to` – at least (f) coordinates (m, rad)
    /// * `length` – the characteristic length (m)
    #[must_use]
    pub fn largest_displacement(
        &self,
        from: &DVector<f64>,
        to: &DVector<f64>,
        length: f64,
    ) -> Option<(usize, f64)> {
        let kinematics = Kinematics::new(self);
        let by = kinematics.displacement(from, to);
        let size = |k: usize| by[k].abs() / kinematics.dimensions()[k].unit(length);
        (0..by.len()).max_by(|&a, &b| size(a).total_cmp(&size(b))).map(|k| (k, by[k]))
    }

    /// The coordinates of a configuration that are beyond their limits or clearance; NaN is beyond.
    ///
    /// # Arguments
    /// * `coordinates` – (f + M), or (f) where virtual joints are not to be looked at (m, rad)
    #[must_use]
    pub fn beyond_limits(&self, coordinates: &DVector<f64>) -> Vec<BeyondLimits> {
        let found = self.all_limits().zip(coordinates.iter()).enumerate();
        let beyond = |(coordinate, (limits, &value)): (usize, (Option<[f64; 2]>, &f64))| {
            let limits @ [least, greatest] = limits?;
            let slack = ROUND_OFF * range_scale(limits);
            let within = value >= least - slack && value <= greatest + slack;
            (!within).then_some(BeyondLimits { coordinate, value, limits })
        };
        found.filter_map(beyond).collect()
    }
}
