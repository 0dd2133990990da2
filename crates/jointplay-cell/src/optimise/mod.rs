//! Optimisation of a program: the order and arms of its hand-offs by a beam search on measured times, blends and speeds on a grid, and settings of single stations one after the other.
//!
//! | file | contents |
//! | --- | --- |
//! | `flow` | slots that each wafer visits, which an optimised program keeps |
//! | `timing_model` | times between hand-offs, measured in trajectories |
//! | `beam_search` | orders of hand-offs with a short duration in the model |
//! | `candidate` | an order with its speeds and blend radii |
//! | `order_program` | the program of an order |
//! | `pareto` | objectives and their Pareto front |
//! | `search` | rounds of proposals and evaluations |
//!
//! Every reported program is planned and checked as any other; the model only proposes orders.

mod beam_search;
mod candidate;
mod flow;
mod order_program;
mod pareto;
mod search;
mod timing_model;

pub use candidate::{Candidate, MotionSettings};
pub use flow::{FlowError, WaferFlow};
pub use pareto::{Objectives, pareto_front};
pub use search::{Evaluation, OptimiseOptions, Search};
pub use timing_model::{Signature, TimingModel, TimingSample};
