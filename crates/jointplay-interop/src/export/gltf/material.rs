//! Materials of the parts.

use gltf_json::material::{AlphaMode, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::validation::Checked::Valid;

/// Appearances of the parts.
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
    /// The material as glTF has it.
    pub(super) fn describe(self) -> gltf_json::Material {
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
        let alpha_mode = if alpha < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque };
        gltf_json::Material {
            name: Some(name.to_owned()),
            double_sided: true,
            alpha_mode: Valid(alpha_mode),
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor([red, green, blue, alpha]),
                metallic_factor: StrengthFactor(0.1),
                roughness_factor: StrengthFactor(0.7),
                ..Default::default()
            },
            ..Default::default()
        }
    }
}
