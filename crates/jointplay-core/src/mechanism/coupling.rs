//! Couplings: linear relations between joint coordinates, such as those of gears, belts and screws.

/// A coordinate of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct JointCoordinate {
    /// Index of the joint.
    pub joint: usize,
    /// Index of the coordinate among those of the joint.
    pub freedom: usize,
}

/// A linear relation between joint coordinates.
///
/// ```text
///    q_follower  =  offset  +  Σ ratio · q
/// ```
/// One term is a gear, a belt or a screw, two are a differential; without terms the follower is fixed at the offset.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// Name, unique among joints, virtual joints and couplings.
    pub name: String,
    /// The coordinate that follows the others.
    pub follower: JointCoordinate,
    /// The other coordinates, each with its ratio: change of the follower for a unit of the coordinate (m/m, m/rad, rad/m or rad/rad).
    pub terms: Vec<(JointCoordinate, f64)>,
    /// Value of the follower with the other coordinates at zero (m, rad).
    pub offset: f64,
}

impl Coupling {
    /// All coordinates of the relation, the follower first.
    pub fn coordinates(&self) -> impl Iterator<Item = JointCoordinate> + '_ {
        std::iter::once(self.follower).chain(self.terms.iter().map(|&(coordinate, _)| coordinate))
    }
}
