//! WebAssembly module of jointplay: kinematics of one three-rod robot, without standard library and heap.
//!
//! The module has memory for one robot, for the numbers and for the message of the last call; a program creates an instance for each robot.
//! `crates/jointplay-wasm/js` is the module for JavaScript and TypeScript, with the built WebAssembly.
//!
//! | call | numbers in | numbers out |
//! | --- | --- | --- |
//! | [`Robot::set`] | limbs, limits, working height, options | – |
//! | [`Robot::inverse`] | azimuth, tilt angle, height | rods |
//! | [`Robot::broken_limits`] | rods | limits that they break, with the tilt |
//! | [`Robot::clamp`] | rods within the limits, wanted rods | the last rods within the limits |
//! | [`Robot::forward`] | rods, length of the metric, which model | the pose |
//! | [`Robot::approximate`] | azimuth, tilt angle, height | rods, the pose of the approximate model, its gaps |
#![cfg_attr(target_family = "wasm", no_std)]

#[cfg(target_family = "wasm")]
mod exports;
mod message;
mod robot;

pub use message::Message;
pub use robot::{Kind, Robot};
