//! Models of Gazebo (SDF): links and joints in any graph, placed by frames.
//!
//! The world is the base; a model that nothing holds to the world stands on its canonical link.
//! Links of static models are fixed to the world.

mod frames;
mod joints;
mod pose;
mod reader;

pub(super) use reader::read;
