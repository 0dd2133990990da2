//! Materials of the parts.

use serde_json::{Value, json};

/// How things look.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Material {
    Robot,
    Arm,
    OtherArm,
    Wafer,
    Station,
    Body,
    KeepOut,
    Safe,
}

impl Material {
    pub(super) fn describe(self) -> Value {
        let (name, [red, green, blue, alpha]) = match self {
            Self::Robot => ("robot", [0.55, 0.57, 0.6, 1.0]),
            Self::Arm => ("arm", [0.0, 0.3, 0.6, 1.0]),
            Self::OtherArm => ("other arm", [0.75, 0.3, 0.05, 1.0]),
            Self::Wafer => ("wafer", [0.25, 0.2, 0.35, 1.0]),
            Self::Station => ("station", [0.3, 0.6, 0.3, 0.25]),
            Self::Body => ("body", [0.6, 0.6, 0.55, 0.6]),
            Self::KeepOut => ("keep out", [0.8, 0.1, 0.1, 0.2]),
            Self::Safe => ("safe", [0.1, 0.6, 0.2, 0.12]),
        };
        let mut material = json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": {
                "baseColorFactor": [red, green, blue, alpha],
                "metallicFactor": 0.1,
                "roughnessFactor": 0.7,
            },
        });
        if alpha < 1.0 {
            material["alphaMode"] = json!("BLEND");
        }
        material
    }
}
