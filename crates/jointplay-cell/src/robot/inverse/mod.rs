//! Inverse kinematics: from a wafer's plane, centre and heading to all positions of the axes that reach it.
//!
//! | file | contents |
//! | --- | --- |
//! | `solution` | targets, branches, and the limits that they violate |
//! | `decomposition` | the joints of an arm by their role: redundant first joint, pair that places the centre, last joint that turns the wafer |
//! | `closed_form` | the pair's positions in closed form |
//! | `redundant`, `barrier` | redundancy resolution by a barrier function of limits and elbow, or by the distance from the present positions |
//! | `posture_path` | paths of a wafer in the arm's plane, and postures along them |
//! | `posture_search`, `posture_smoothing`, `posture_planner` | postures for a whole path: shortest paths through a grid, smoothed |
//! | `posture_change` | motions between postures with the wafer close to the axis of the first joint |
//! | `newton` | any other arm, from several starts |
//! | `polish` | Newton's method on the whole chain |
//! | `revolutions` | branches that differ by whole revolutions of axes |
//! | `branches` | all branches of the whole chain, and the choice among them |

mod barrier;
mod branches;
mod closed_form;
mod decomposition;
mod newton;
mod polish;
mod posture_change;
mod posture_path;
mod posture_planner;
mod posture_search;
mod posture_smoothing;
mod redundant;
mod revolutions;
mod solution;

pub(crate) use posture_change::PostureChange;
pub(crate) use posture_path::PlanarPath;
pub use posture_path::PosturePath;
pub(crate) use posture_search::PostureCandidate;
pub use solution::{
    Branch, BranchSelection, Configuration, Elbow, Inverse, LimitViolation, OutOfReach,
    ReachDirection, Redundancy, WaferTarget,
};
