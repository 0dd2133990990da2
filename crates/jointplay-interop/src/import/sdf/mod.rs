//! Models of Gazebo (SDF): links and joints in any graph, with poses in frames.
//!
//! The world is the base; in a model that is not fixed to a world, the canonical link is the base.
//! Links of static models are fixed to the world.

mod frames;
mod gearboxes;
mod joints;
mod mimics;
mod pose;
mod reader;

pub(super) use reader::read;
