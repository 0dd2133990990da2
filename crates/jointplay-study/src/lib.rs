//! Sweeps over many poses: results as columns, in SI units.
//!
//! | to… | use |
//! | --- | --- |
//! | define a raster of poses, such as the paper's | [`Raster`] |
//! | move through key poses | [`KeyMotion`] |
//! | compute all poses under one virtualization | [`simulate`] → [`Samples`] |
//! | compute columns of poses on all cores | [`parallel`] |
//! | sum them up | [`summarize`] → [`Summary`] |
//! | check them against the bounds of sensitivity | [`check_bounds`] → [`BoundsCheck`] |
//! | compare all models | [`compare`] → [`Comparison`]; limits of the tilts: [`broken_limits`] |
//! | compute millions of samples, from grids or at random, of robots as built | [`plan`] |
//!
//! ```
//! use jointplay_core::{gpr::Gpr, virtualization::{Polar, SolveOptions}};
//! use jointplay_study::{Raster, simulate};
//!
//! let samples = simulate(&Gpr::paper(), &Raster::paper(), &Polar, &SolveOptions::default(), &mut |_| ())?;
//! assert_eq!(samples.len(), 777);
//! # Ok::<(), jointplay_study::Error>(())
//! ```

mod bounds_check;
mod compare;
mod error;
mod key_motion;
pub mod parallel;
pub mod plan;
mod raster;
mod samples;
mod summary;

pub use bounds_check::{BoundsCheck, check_bounds};
pub use compare::{Comparison, ModelCurve, broken_limits, compare};
pub use error::Error;
pub use key_motion::{KeyMotion, KeyPose};
pub use raster::{Order, Raster, refine};
pub use samples::{Samples, Series, SeriesKind, simulate};
pub use summary::{SeriesSummary, Summary, summarize};
