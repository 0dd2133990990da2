//! Results as a program reads them: one serialisable document for each command, in mm and degrees.

mod beyond;
mod cell;
mod compare;
mod expected;
mod forward;
mod mechanism;
mod mobility;
mod motion;
mod nearest;
mod relief;
mod sensitivity;
mod station;
mod study;
mod suggest;
mod totals;
mod violation;

use jointplay_core::gpr::BrokenLimit;
use jointplay_core::virtualization::{VirtualJoint, VirtualJointKind};
use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::explain::explain_limit;
use crate::units::{deg, mm};

pub use beyond::beyond_limits;
pub use cell::{
    AxisReport, CellReport, DistanceReport, InstructionReport, ShareReport, ViolationReport, cell,
    excerpt, flaws,
};
pub use compare::{CompareReport, ModelReport, compare};
pub use expected::{DisagreementReport, disagreements};
pub use forward::{ForwardReport, PlatformReport, forward};
pub use mechanism::{
    AssemblyReport, ByName, CarriedTwiceReport, ConfigurationReport, LinkMotionReport,
    MechanismMobilityReport, NearMissReport, NearReport, SparseMobilityReport, UnitsReport,
    assembly, by_name, configuration, mechanism_mobility, sparse_mobility,
};
pub use mobility::{FreedomsReport, MobilityReport, mobility};
pub use motion::{MotionReport, SingularReport, motion};
pub use nearest::NearestReport;
pub use relief::{ReliefReport, VirtualJointReport, relief};
pub use sensitivity::{BoundsReport, SensitivityReport, sensitivity};
pub use station::{PlaneReport, StationReport, TeachReport, UncertaintyReport, teach};
pub use study::{BoundsHeldReport, SeriesReport, StudyReport, study};
pub use suggest::{SetReport, SuggestReport, SuggestedJoint, suggestions};
pub use totals::{ColumnReport, OutcomeReport, SHARES, TotalsReport, totals};
pub use violation::explain_violation;

/// Displacements of virtual joints grouped by symbol, such as `l_mm` → three lengths; written as a map.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "schema", schema(value_type = std::collections::BTreeMap<String, Vec<f64>>))]
pub struct VirtualJointGroups(pub Vec<(String, Vec<f64>)>);

impl VirtualJointGroups {
    /// Groups displacements X ([m], [rad]) by the symbols of their joints.
    #[must_use]
    pub fn new(joints: &[VirtualJoint], x: &[f64]) -> Self {
        let mut groups: Vec<(String, Vec<f64>)> = Vec::new();
        for (joint, &x) in joints.iter().zip(x) {
            let (unit, value) = match joint.motion {
                VirtualJointKind::Linear => ("mm", mm(x)),
                VirtualJointKind::Angular => ("deg", deg(x)),
            };
            let name = format!("{}_{unit}", joint.symbol);
            match groups.iter_mut().find(|(known, _)| *known == name) {
                Some((_, values)) => values.push(value),
                None => groups.push((name, vec![value])),
            }
        }
        Self(groups)
    }
}

impl Serialize for VirtualJointGroups {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, values) in &self.0 {
            map.serialize_entry(name, values)?;
        }
        map.end()
    }
}

/// A broken limit for a program to read.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct LimitReport {
    /// `rod 1`, `rod 2`, `rod 3` or `tilt`; of a mechanism, the name of a coordinate.
    pub limit: String,
    /// What was found, in `unit`.
    pub found: f64,
    /// Least allowed, in `unit`.
    pub min: f64,
    /// Greatest allowed, in `unit`.
    pub max: f64,
    /// `mm` or `deg`; of a mechanism, a unit of its file.
    pub unit: &'static str,
    /// The same in words.
    pub message: String,
}

/// Broken limits for a program to read.
#[must_use]
pub fn limits(broken: &[BrokenLimit]) -> Vec<LimitReport> {
    broken
        .iter()
        .map(|limit| {
            let message = explain_limit(limit);
            match *limit {
                BrokenLimit::Rod { limb, length, min, max } => LimitReport {
                    limit: format!("rod {limb}"),
                    found: mm(length),
                    min: mm(min),
                    max: mm(max),
                    unit: "mm",
                    message,
                },
                BrokenLimit::Tilt { pitch, max } => LimitReport {
                    limit: "tilt".to_owned(),
                    found: deg(pitch),
                    min: 0.0,
                    max: deg(max),
                    unit: "deg",
                    message,
                },
            }
        })
        .collect()
}
