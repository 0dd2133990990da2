//! The animated 3D scene of `jointplay move`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jointplay::interop::export::{
    AnimatedParts, MechanismMotion, PartTable, PartsFile, UpAxis, proportional_times,
};
use jointplay::mechanism::DrivenMotion;
use jointplay::nalgebra::DVector;
use jointplay::report::MotionParameter;

use crate::arguments::finite;
use crate::failure::Failure;
use crate::mechanism_input::Input;
use crate::source::{Source, read_bytes};

/// Largest accepted file of parts (bytes).
const MAX_PARTS: u64 = 500_000_000;
/// Largest accepted table of parts (bytes).
const MAX_TABLE: usize = 4_000_000;

/// Flags of the animated 3D scene.
#[derive(Args)]
pub(crate) struct SceneArgs {
    /// Parts of the 3D scene: a binary glTF file (GLB) whose nodes have the names of links, such as one that cascadio makes of STEP; by default links are drawn as bars
    #[arg(long, value_name = "FILE")]
    parts: Option<PathBuf>,
    /// Node of the parts that moves with a link of another name
    #[arg(long = "part", value_name = "NODE=LINK", value_parser = part, requires = "parts")]
    part: Vec<(String, String)>,
    /// Table of the parts that move with links of other names (TOML: `kind = "parts"`, and in `[links]` names of nodes for each link)
    #[arg(long, value_name = "FILE", requires = "parts")]
    part_table: Option<PathBuf>,
    /// Axis of the file of parts that is z of the base frame [default: that of the table; z if Open CASCADE wrote the file, such as cascadio, y otherwise]
    #[arg(long, value_name = "AXIS", requires = "parts")]
    parts_up: Option<Up>,
    /// Factor of the displacements of virtual joints in the 3D scene
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = finite)]
    exaggerate: f64,
    /// Duration of the motion in the 3D scene, which follows the variable of curves and tables evenly [default: that of a variable in seconds, such as `time_s`; 4 for others]
    #[arg(long, value_name = "S", value_parser = finite)]
    duration_s: Option<f64>,
    /// Largest deviation of the 3D scene from the steps of the motion, between which it is interpolated [default: 1]
    #[arg(long, value_name = "UM", value_parser = finite)]
    tolerance_um: Option<f64>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Up {
    /// y, as in glTF files of 3D programs
    Y,
    /// z, as in CAD models
    Z,
}

fn part(text: &str) -> Result<(String, String), String> {
    let (node, link) = text
        .rsplit_once('=')
        .ok_or_else(|| format!("invalid part {text:?}: expected NODE=LINK"))?;
    Ok((node.trim().to_owned(), link.trim().to_owned()))
}

fn part_table(path: &Path) -> Result<PartTable, Failure> {
    let source = Source::read(path, MAX_TABLE)?;
    PartTable::parse(&source.text).map_err(|errors| Failure::invalid(&errors, &source.label))
}

impl SceneArgs {
    /// Whether a flag is given that is of no effect without a scene.
    pub(crate) fn is_given(&self) -> bool {
        self.parts.is_some()
            || self.exaggerate != 1.0
            || self.duration_s.is_some()
            || self.tolerance_um.is_some()
    }

    /// The bytes of the scene, with the names of links without a part.
    ///
    /// # Arguments
    /// * `variable` – of the motion's curves or table, with its values at each configuration
    pub(crate) fn scene(
        &self,
        input: &Input,
        reference: &DVector<f64>,
        moved: &DrivenMotion,
        variable: Option<&MotionParameter>,
    ) -> Result<AnimatedParts, Failure> {
        let configurations = moved.waypoints.iter().map(|waypoint| &waypoint.coordinates);
        let duration = self.duration_s.or_else(|| variable?.seconds()).unwrap_or(4.0);
        let times = match variable {
            Some(variable) => proportional_times(duration, &variable.values)?,
            None => {
                let shares: Vec<f64> = moved.waypoints.iter().map(|one| one.share).collect();
                proportional_times(duration, &shares)?
            }
        };
        let motion = MechanismMotion::new(
            &input.file.mechanism,
            reference,
            configurations,
            times,
            self.exaggerate,
        )?;
        let tolerance = 1e-6 * self.tolerance_um.unwrap_or(1.0);
        let Some(path) = &self.parts else {
            let bytes = motion.gltf(tolerance)?;
            return Ok(AnimatedParts { bytes, missing: Vec::new() });
        };
        let parts = PartsFile::parse(&read_bytes(path, MAX_PARTS)?)
            .map_err(jointplay::interop::export::Error::from)?;
        let mut table = match &self.part_table {
            Some(path) => part_table(path)?,
            None => PartTable::default(),
        };
        table.parts.extend(self.part.iter().cloned());
        let up = match self.parts_up {
            Some(Up::Y) => UpAxis::Y,
            Some(Up::Z) => UpAxis::Z,
            None => table.up.unwrap_or_else(|| parts.up_axis()),
        };
        Ok(motion.gltf_of_parts(&parts, &table.parts, up, tolerance)?)
    }
}
