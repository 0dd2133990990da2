//! Mechanisms with their play as joints, in the formats of simulators.
//!
//! Virtual joints become slides and hinges with a spring, and a range where their clearance is known.
//! Each writer lists what its format cannot keep.
//!
//! | to… | use | loops |
//! | --- | --- | --- |
//! | MuJoCo | [`mjcf`](fn@mjcf) | `connect` and `weld` |
//! | Gazebo | [`sdf`](fn@sdf) | joints |
//! | ROS | [`urdf`](fn@urdf) | a second file of joints, see [`jointplay_format::mechanism::with_loops`] |
//! | Modelica | [`modelica`](fn@modelica) | stiff springs |

mod error;
mod mimics;
mod mjcf;
mod modelica;
mod sdf;
mod sdf_names;
mod skeleton;
mod urdf;
pub(crate) mod xml;

pub use error::Error;
pub use mjcf::mjcf;
pub use modelica::{modelica, modelica_class};
pub use sdf::sdf;
pub use urdf::urdf;

/// Plugin of Gazebo that drives a joint to positions.
pub(crate) const POSITION_CONTROLLER: &str = "gz::sim::systems::JointPositionController";

/// A mechanism in a format of a simulator.
#[derive(Debug, Clone, PartialEq)]
pub struct Written {
    /// The file.
    pub text: String,
    /// The second file, of joints that close loops, where the format describes trees only.
    pub loops: Option<String>,
    /// Parts of the mechanism that the files do not keep, and changes.
    pub lost: Vec<String>,
}
