//! Formats of mechanisms, and their files.

use clap::ValueEnum;

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// functional mock-up unit, for simulators with FMI
    Fmu,
    /// model of MuJoCo
    Mjcf,
    /// package in Modelica, which needs no library
    Modelica,
    /// model of Gazebo
    Sdf,
    /// robot of ROS, with a second file of the joints that close loops
    Urdf,
}

/// Files of one format, with their contents.
pub(super) struct Files {
    pub(super) format: &'static str,
    pub(super) files: Vec<(String, Vec<u8>)>,
    pub(super) lost: Vec<String>,
}
