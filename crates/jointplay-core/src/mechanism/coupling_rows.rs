//! Couplings as equations, and their checks.

use nalgebra::DVector;

use super::coupling::{Coupling, JointCoordinate};
use super::description::Mechanism;
use super::joint::Factor;
use super::kinematics::Kinematics;
use super::mechanism_error::MechanismError;

/// Most coordinates of a coupling: each pair of their links is a block of sparse matrices.
pub(super) const MAX_COUPLED: usize = 64;

/// A coupling as an equation between coordinates of the mechanism, without unit.
///
/// Its gradient has length 1 in radians and characteristic lengths, so that neither the choice of the follower nor the units change it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct CouplingRow {
    /// Indices of coordinates, with their factors.
    pub(super) entries: Vec<(usize, f64)>,
    pub(super) constant: f64,
}

impl CouplingRow {
    /// Whether a coordinate is in the relation.
    pub(super) fn contains(&self, coordinate: usize) -> bool {
        self.entries.iter().any(|&(k, _)| k == coordinate)
    }

    /// Violation, in radians and characteristic lengths.
    pub(super) fn residual(&self, coordinate: impl Fn(usize) -> f64) -> f64 {
        self.entries.iter().map(|&(k, factor)| factor * coordinate(k)).sum::<f64>() - self.constant
    }
}

/// The couplings of a mechanism as equations.
///
/// # Arguments
/// * `length` – characteristic length (m)
pub(super) fn coupling_rows(kinematics: &Kinematics<'_>, length: f64) -> Vec<CouplingRow> {
    let index = |one: JointCoordinate| kinematics.coordinates_of(one.joint).start + one.freedom;
    let row = |coupling: &Coupling| {
        let terms = coupling.terms.iter().map(|&(one, ratio)| (index(one), -ratio));
        let mut entries: Vec<(usize, f64)> =
            std::iter::once((index(coupling.follower), 1.0)).chain(terms).collect();
        let scaled = |&(k, factor): &(usize, f64)| factor * kinematics.dimensions()[k].unit(length);
        let size = entries.iter().map(scaled).fold(0.0, f64::hypot);
        entries.iter_mut().for_each(|(_, factor)| *factor /= size);
        CouplingRow { entries, constant: coupling.offset / size }
    };
    kinematics.mechanism().couplings().iter().map(row).collect()
}

impl Mechanism {
    /// The same mechanism with these couplings in place of its own.
    ///
    /// # Errors
    /// [`MechanismError::NoSuchCoordinate`], [`MechanismError::CoupledRotation`] for coordinates of a rotation vector, [`MechanismError::CoupledTwice`] for a coordinate that is in one coupling twice, [`MechanismError::CoupledMany`] beyond 64 coordinates; [`MechanismError::NotFinite`], [`MechanismError::NameTwice`].
    pub fn with_couplings(mut self, couplings: Vec<Coupling>) -> Result<Self, MechanismError> {
        couplings.iter().try_for_each(|coupling| self.check_coupling(coupling))?;
        self.couplings = couplings;
        self.check_names()?;
        Ok(self)
    }

    /// Its couplings.
    #[must_use]
    pub fn couplings(&self) -> &[Coupling] {
        &self.couplings
    }

    /// Whether every coupling holds to a tolerance at some coordinates.
    ///
    /// # Arguments
    /// * `coordinates` – at least the (f) coordinates of the joints (m, rad)
    /// * `tolerance` – largest violation, in radians and characteristic lengths of 1 m
    #[must_use]
    pub fn couplings_hold(&self, coordinates: &DVector<f64>, tolerance: f64) -> bool {
        let rows = coupling_rows(&Kinematics::new(self), 1.0);
        rows.iter().all(|row| row.residual(|k| coordinates[k]).abs() <= tolerance)
    }

    fn check_coupling(&self, coupling: &Coupling) -> Result<(), MechanismError> {
        let name = || coupling.name.clone();
        let found = 1 + coupling.terms.len();
        if found > MAX_COUPLED {
            let (coupling, allowed) = (name(), MAX_COUPLED);
            return Err(MechanismError::CoupledMany { coupling, found, allowed });
        }
        let mut seen = Vec::new();
        for one in coupling.coordinates() {
            let joint = self.joints().get(one.joint);
            let Some(joint) = joint.filter(|joint| one.freedom < joint.kind.freedoms()) else {
                let JointCoordinate { joint, freedom } = one;
                return Err(MechanismError::NoSuchCoordinate { coupling: name(), joint, freedom });
            };
            let factors = joint.kind.factors();
            let mut elements = factors.iter().flat_map(|factor| {
                factor.coordinates().iter().map(move |_| *factor == Factor::Ball)
            });
            if elements.nth(one.freedom) == Some(true) {
                let joint = joint.name.clone();
                return Err(MechanismError::CoupledRotation { coupling: name(), joint });
            }
            if seen.contains(&one) {
                let joint = joint.name.clone();
                return Err(MechanismError::CoupledTwice { coupling: name(), joint });
            }
            seen.push(one);
        }
        let ratios = coupling.terms.iter().map(|&(_, ratio)| ("a ratio", ratio));
        let mut numbers = ratios.chain([("the offset", coupling.offset)]);
        match numbers.find(|(_, value)| !value.is_finite()) {
            None => Ok(()),
            Some((what, value)) => Err(MechanismError::NotFinite { what, name: name(), value }),
        }
    }
}
