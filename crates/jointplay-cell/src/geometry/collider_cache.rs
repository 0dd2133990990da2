//! Colliders of the last check.

use std::convert::Infallible;

use jointplay_core::spatial::Pose;

use super::collider::Solid;
use super::shape::Shape;
use crate::incremental::{Fingerprint, GenerationalCache};

/// The solids of the last check, each with a number of its own, and so where they stand.
#[derive(Default)]
pub(crate) struct Solids {
    kept: GenerationalCache<(u64, Option<Solid>)>,
    standing: GenerationalCache<u64>,
    count: u64,
}

impl Solids {
    pub(crate) fn begin(&mut self) {
        self.kept.begin(&Fingerprint::default());
        self.standing.begin(&Fingerprint::default());
    }

    /// As [`Solid::new`].
    pub(crate) fn get(&mut self, shape: &Shape, carrier_from_shape: &Pose) -> Option<(u64, Solid)> {
        let make = || {
            self.count += 1;
            Ok::<_, Infallible>((self.count, Solid::new(shape, carrier_from_shape)))
        };
        let Ok(found) = self
            .kept
            .get_or_compute(Fingerprint::default().with(carrier_from_shape).with(shape), make);
        Some((found.0, found.1.clone()?))
    }

    /// The number of a solid that stands somewhere.
    pub(crate) fn standing(&mut self, number: u64, base_from_carrier: &Pose) -> u64 {
        let fingerprint = Fingerprint::default().with(&number).with(base_from_carrier);
        let Ok(found) = self.standing.get_or_compute::<Infallible>(fingerprint, || {
            self.count += 1;
            Ok(self.count)
        });
        *found
    }

    pub(crate) fn end(&mut self) {
        self.kept.end();
        self.standing.end();
    }
}
