//! Studies of any length: values or distributions of what is varied, quantities to compute, computed in chunks.
//!
//! | to… | use |
//! | --- | --- |
//! | define what is varied, and what is computed: of the three-rod robot | [`Plan`], [`Variation`], [`Tolerances`], [`OutputQuantity`] |
//! | of any mechanism | [`MechanismPlan`], [`Variation`], [`MechanismQuantity`] |
//! | of anything else, by a function of the varied values | [`SweepPlan`] |
//! | compute some samples | [`Study::compute`] → [`Block`] |
//! | compute a chunk of them | [`compute_chunk`] |
//! | compute all of them over all cores, in order, in memory that does not grow | [`run`]; some chunks [`run_chunks`] |
//! | accumulate columns | [`Totals`], [`Moments`] |
//! | compute medians and other quantiles | [`quantiles`] |
//!
//! Every sample depends on the plan and its number alone: not on chunks, threads, or where a run was taken up again.
//!
//! ```
//! use jointplay_core::{bulk::Quantity, gpr::Gpr, virtualization::{Planar, SolveOptions}};
//! use jointplay_study::plan::*;
//!
//! let plan = Plan {
//!     gpr: Gpr::paper(),
//!     height: Variation::Values(vec![0.5]),
//!     tilt: Tilts { form: TiltForm::AzimuthAngle, first: Variation::Uniform { from: 0.0, to: 6.28 }, second: Variation::Values(vec![0.01, 0.02]) },
//!     tolerances: Tolerances::default(),
//!     rods_from: RodsFrom::Nominal,
//!     draws: 1000,
//!     seed: 7,
//!     models: vec![&Planar],
//!     options: SolveOptions::default(),
//!     wanted: vec![OutputQuantity::Model { model: 0, measure: PlatformQuantity::CenterShift }],
//! };
//! let block = plan.compute(&[0, 1999])?;
//! assert_eq!((plan.samples()?, block.columns[0].len()), (2000, 2));
//! # Ok::<(), jointplay_study::Error>(())
//! ```

mod as_built;
mod block;
mod compute;
mod definition;
mod grid;
mod inputs;
mod mechanism;
mod moments;
mod output;
mod quantiles;
mod random;
mod run;
mod study;
mod sweep;
mod totals;
mod variation;

pub use as_built::{Dimension, RodsFrom, Tolerances};
pub use block::{Block, Outcome, Portions, ProgramOutcome, SampleLimit};
pub use definition::{Plan, TiltForm, Tilts};
pub use mechanism::{MechanismOf, MechanismPlan, MechanismQuantity, VariedDrive, VariedParameter};
pub use moments::Moments;
pub use output::{OutputQuantity, PlatformQuantity};
pub use quantiles::quantiles;
pub use run::{compute_chunk, run, run_chunks};
pub use study::Study;
pub use sweep::{SampleFunction, SweepPlan, SweptValue};
pub use totals::{Outcomes, Totals};
pub use variation::Variation;
