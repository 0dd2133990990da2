//! Frames of stations from taught points, with their uncertainty.

mod drift;
mod error;
mod frame;
mod next_points;
mod plane;
mod quantile;
mod references;
mod taught_frame;
mod uncertainty;
mod verdict;

pub use drift::{Drift, drift};
pub use error::TeachError;
pub use frame::{frame, yaw};
pub use next_points::{MAX_NEXT_POINTS, NextPoints};
pub use plane::{ENOUGH, PlaneFit, PlaneUncertainty, fit_plane};
pub use references::{ReferenceFit, ReferencePoint, ReferenceUncertainty, fit_references};
pub use taught_frame::{NominalFrame, TaughtFrame};
pub use uncertainty::{FrameUncertainty, StatedUncertainty, coverage};
pub use verdict::{PointDiagnostic, Verdict};
