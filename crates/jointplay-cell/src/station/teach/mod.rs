//! Frames of stations from taught points, with their uncertainty.

mod carrier_axis;
mod error;
mod fit_result;
mod frame;
mod next_points;
mod plane;
mod quantile;
mod references;
mod taught_frame;
mod uncertainty;

pub use carrier_axis::{CarrierAxis, carrier_axis};
pub use error::TeachError;
pub use fit_result::{Agreement, FitResult, PointDiagnostic};
pub use frame::frame;
pub use next_points::{MAX_NEXT_POINTS, NextPoints};
pub use plane::{MIN_POINTS_OF_UNKNOWN_NOISE, PlaneFit, PlaneUncertainty, fit_plane};
pub use references::{ReferenceFit, ReferencePoint, ReferenceUncertainty, fit_references};
pub use taught_frame::{NominalFrame, TaughtFrame};
pub use uncertainty::{FrameUncertainty, StatedUncertainty, coverage};
