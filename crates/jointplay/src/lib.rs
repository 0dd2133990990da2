//! Model, analyse and simulate overconstrained robots, some of whose motions need play in the joints.
//!
//! | module | role |
//! | --- | --- |
//! | [`gpr`] | the three-rod robot: geometry, inverse and forward kinematics |
//! | [`bulk`] | the same for many poses at a time, columns in and columns out |
//! | [`virtualization`] | virtual joints: radial, polar, offset, planar, or your own |
//! | [`mobility`], [`sensitivity`] | what can move, and how much play it takes |
//! | [`constraint`] | the interface that both speak to |
//! | [`linalg`], [`spatial`] | ranks and null spaces, poses and tilts |
//! | [`study`] | sweeps over many poses |
//! | [`cell`] | robots with arms, stations, programs, timed and checked motion |
//! | [`mod@format`] | files of robots, mechanisms, cells, programs and studies |
//! | [`report`] | results as documents and tables |
//! | [`interop`] | models and motions in the formats of other programs |
//! | [`plot`] | figures as SVG, PNG and PDF |

#[doc = include_str!("../README.md")]
#[cfg(doctest)]
struct ReadmeCompiles;

pub use jointplay_cell as cell;
pub use jointplay_core::{
    Error, Unconverged, bulk, constraint, gpr, linalg, mechanism, mobility, nalgebra, sensitivity,
    spatial, virtualization,
};
pub use jointplay_format as format;
pub use jointplay_interop as interop;
pub use jointplay_plot as plot;
pub use jointplay_report as report;
pub use jointplay_study as study;
