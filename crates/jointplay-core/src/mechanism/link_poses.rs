//! Poses of the links of one mechanism, again and again.

use nalgebra::DVector;

use super::description::Mechanism;
use super::kinematics::{Chain, Kinematics, check_coordinates};
use super::tree::link_poses;
use crate::Error;
use crate::spatial::Pose;

/// Computes the poses of all links of one mechanism again and again: [`Kinematics::link_poses`], laid out once.
#[derive(Debug, Clone)]
pub struct LinkPoses {
    branches: Vec<([usize; 2], bool, Chain)>,
    links: usize,
    /// (f + M) zeros.
    still: DVector<f64>,
}

impl LinkPoses {
    /// Derives the tree and the chains of a mechanism.
    #[must_use]
    pub fn new(mechanism: &Mechanism) -> Self {
        let kinematics = Kinematics::new(mechanism);
        let chain = |j: usize| kinematics.chains()[j].clone();
        Self {
            branches: kinematics
                .branches()
                .map(|(j, links, against)| (links, against, chain(j)))
                .collect(),
            links: mechanism.links().len(),
            still: DVector::zeros(kinematics.dimensions().len()),
        }
    }

    /// Pose of each link in the base frame at some coordinates, to the bit that of [`Kinematics::link_poses`].
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`].
    pub fn compute(&self, coordinates: &DVector<f64>) -> Result<Vec<Pose>, Error> {
        check_coordinates(coordinates, self.still.len())?;
        let branch = |(links, against, chain): &([usize; 2], bool, Chain)| {
            (*links, *against, chain.transform(coordinates, &self.still))
        };
        Ok(link_poses(self.links, self.branches.iter().map(branch)))
    }
}
