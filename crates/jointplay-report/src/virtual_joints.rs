//! Displacements of virtual joints, grouped by symbol.

use jointplay_core::virtualization::{VirtualJoint, VirtualJointKind};
use jointplay_format::units::{deg, mm};
use serde::ser::{Serialize, SerializeMap, Serializer};

/// Displacements of virtual joints grouped by symbol, such as `l_mm` → three lengths; written as a map.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[cfg_attr(feature = "schema", schema(value_type = std::collections::BTreeMap<String, Vec<f64>>))]
pub struct VirtualJointGroups(pub Vec<(String, Vec<f64>)>);

impl VirtualJointGroups {
    /// Groups displacements X ((m), (rad)) by the symbols of their joints.
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
