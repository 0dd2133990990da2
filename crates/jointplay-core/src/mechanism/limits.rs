//! The ranges of the coordinates of a mechanism.

use super::Mechanism;

/// Share of a range by which a coordinate may be beyond its end, so that round-off at the end of a motion to a limit is not beyond it.
const SLACK: f64 = 1e-9;

/// Limits of joints and clearances of virtual joints, for each coordinate ([m], [rad]).
#[derive(Debug, Clone, PartialEq)]
pub struct CoordinateLimits {
    /// Joints, then virtual joints.
    ranges: Vec<Option<[f64; 2]>>,
}

impl CoordinateLimits {
    /// The limits and clearances of a mechanism's description.
    #[must_use]
    pub fn of(mechanism: &Mechanism) -> Self {
        let limits = mechanism
            .joints()
            .iter()
            .flat_map(|joint| (0..joint.kind.freedoms()).map(|k| joint.limits.get(k).copied()));
        let clearances = mechanism
            .virtual_joints()
            .iter()
            .map(|joint| joint.clearance.map(|most| [-most, most]));
        Self { ranges: limits.chain(clearances).collect() }
    }

    /// Indices of the coordinates that are beyond their range, joints first; what is not a number is beyond any.
    ///
    /// # Arguments
    /// * `coordinates` – (f + M) joints, then virtual joints ([m], [rad])
    pub fn broken<'a>(&'a self, coordinates: &'a [f64]) -> impl Iterator<Item = usize> + 'a {
        let ranges = self.ranges.iter().zip(coordinates).enumerate();
        ranges.filter_map(|(k, (range, value))| {
            let [least, most] = (*range)?;
            let slack = SLACK * (most - least);
            (!(least - slack..=most + slack).contains(value)).then_some(k)
        })
    }
}
