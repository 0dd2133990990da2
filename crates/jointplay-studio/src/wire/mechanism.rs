//! Poses of the links of a mechanism.

use std::collections::BTreeMap;

use jointplay::report::LimitReport;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::mechanism_view::MechanismSource;
use super::pose::PlacedDocument;

/// Request of the poses of the links of a mechanism.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MechanismPosesRequest {
    /// The mechanism; this or `catalogue`.
    pub(crate) mechanism: Option<MechanismSource>,
    /// Name of a mechanism or three-rod robot of the catalogue.
    #[serde(default)]
    pub(crate) catalogue: Option<String>,
    /// Values of commanded joint coordinates by name; default: none (m, rad).
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) at: BTreeMap<String, f64>,
}

/// A closed configuration of a mechanism, with the poses of its links.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MechanismPosesDocument {
    /// Name of the mechanism.
    pub(crate) name: String,
    /// The link in whose frame the poses are.
    pub(crate) base: String,
    /// Poses of all links but the base, then of all attached frames.
    pub(crate) frames: Vec<MechanismFrame>,
    /// Coordinates of the joints, then of the virtual joints.
    pub(crate) coordinates: Vec<CoordinateDocument>,
    /// Coordinates beyond their limits or clearances, in the units of the file.
    pub(crate) limits_broken: Vec<LimitReport>,
}

/// Pose of a link or attached frame in the base frame.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct MechanismFrame {
    /// Name of the link or frame.
    pub(crate) name: String,
    /// Its pose.
    pub(crate) pose: PlacedDocument,
}

/// Value of a coordinate.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct CoordinateDocument {
    /// Name of the joint, with an index if it has several freedoms.
    pub(crate) name: String,
    /// Value, in `unit`.
    pub(crate) value: f64,
    /// `m` or `rad`.
    pub(crate) unit: &'static str,
}
