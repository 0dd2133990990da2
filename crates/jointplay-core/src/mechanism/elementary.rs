//! Joints as sequences of elementary motions, for programs that know elementary joints only.

use super::joint::Factor;
use super::{Kinematics, Mechanism};
use crate::spatial::Pose;

/// A fixed displacement, then a motion of a joint or virtual joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementaryMotion {
    /// Displacement from the frame behind the previous motion to the frame of this one.
    pub before: Pose,
    /// The motion.
    pub factor: Factor,
    /// First of its coordinates among the (f + M) coordinates of the mechanism.
    pub coordinate: usize,
    /// Whether the motion is that of the negative coordinate.
    pub reversed: bool,
}

/// The transform between the links of a joint, virtual joints included.
///
/// ```text
///    from_from_to  =  before₁ · T₁(± q₁) · before₂ · T₂(± q₂) · … · end
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ElementaryChain {
    /// Motions, the one nearest the first link first.
    pub motions: Vec<ElementaryMotion>,
    /// Displacement from the frame behind the last motion to the frame of the second link.
    pub end: Pose,
}

impl ElementaryMotion {
    /// Its transform at coordinates of the mechanism.
    ///
    /// # Panics
    /// If there are too few coordinates.
    #[must_use]
    pub fn transform(&self, coordinates: &[f64]) -> Pose {
        let count = self.factor.coordinates().len();
        let values = coordinates[self.coordinate..][..count].iter();
        let values: Vec<f64> = values.map(|q| if self.reversed { -q } else { *q }).collect();
        self.factor.transform(&values)
    }
}

impl ElementaryChain {
    /// The transform from the second link of the joint to the first.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let mut before = self.end.inverse();
        let mut motions = Vec::with_capacity(self.motions.len());
        for motion in self.motions.iter().rev() {
            let reversed = !motion.reversed;
            motions.push(ElementaryMotion { before, reversed, ..*motion });
            before = motion.before.inverse();
        }
        Self { motions, end: before }
    }

    /// The transform at coordinates of the mechanism.
    ///
    /// # Panics
    /// If there are too few coordinates.
    #[must_use]
    pub fn transform(&self, coordinates: &[f64]) -> Pose {
        let pose = self.motions.iter().fold(Pose::identity(), |pose, motion| {
            pose * motion.before * motion.transform(coordinates)
        });
        pose * self.end
    }
}

impl Kinematics<'_> {
    /// The transform from the first link of a joint to the second as elementary motions.
    ///
    /// # Panics
    /// For a joint that the mechanism does not have.
    #[must_use]
    pub fn elementary_chain(&self, joint: usize) -> ElementaryChain {
        let chain = &self.chains()[joint];
        let motion = |element: &super::kinematics::Element| ElementaryMotion {
            before: element.before,
            factor: element.factor,
            coordinate: element.coordinate,
            reversed: element.sign < 0.0,
        };
        ElementaryChain { motions: chain.elements.iter().map(motion).collect(), end: chain.end }
    }
}

impl Mechanism {
    /// The joints of a spanning tree in the order in which they reach new links from the base, with `true` where a joint is passed from its second link to its first.
    ///
    /// # Arguments
    /// * `cost` – of a joint: of the joints within reach, the cheapest is taken first, then the one that came within reach first
    #[must_use]
    pub fn spanning_tree(&self, cost: impl Fn(usize) -> usize) -> Vec<(usize, bool)> {
        super::tree::spanning_tree(self, cost)
    }
}
