//! Poses of wafers in templates.

use jointplay_cell::robot::{ChainPose, EffectorId};
use jointplay_cell::trajectory::Sample;

use super::language::Dialect;
use super::write::invalid;
use crate::controller_text::{Kind, Template, Value};
use crate::export::error::Error;
use crate::export::motion_export::MotionExport;
use crate::export::sample_columns::FrameQuantity;
use crate::export::samples::{frame_quantity, loaded, placed};

/// Numbers of a pose in the base frame, with their kinds.
pub(super) const POSE: [(&str, Kind); 6] = [
    ("x", Kind::Real),
    ("y", Kind::Real),
    ("z", Kind::Real),
    ("heading", Kind::Real),
    ("tilt", Kind::Real),
    ("tilt_azimuth", Kind::Real),
];

/// Whether templates use a number of a pose.
pub(super) fn uses_pose(templates: &[Template]) -> bool {
    POSE.iter().any(|(name, _)| templates.iter().any(|one| one.uses(name)))
}

/// Whether templates use the poses of all effectors.
fn uses_poses(templates: &[Template]) -> bool {
    templates.iter().any(|one| one.uses("poses"))
}

impl Dialect {
    /// Poses of the robot at a sample, where templates use the pose of an effector or of all.
    pub(super) fn chain_pose(
        &self,
        motion_export: &MotionExport<'_>,
        templates: &[Template],
        sample: &Sample,
    ) -> Result<Option<ChainPose>, Error> {
        if !uses_pose(templates) && !uses_poses(templates) {
            return Ok(None);
        }
        let loaded = loaded(motion_export, sample.step);
        placed(motion_export, sample.time, &sample.positions, loaded).map(Some)
    }

    /// A number of the pose of an effector's wafer, in the units of the dialect; `None` for other names.
    pub(super) fn pose_value(
        &self,
        pose: Option<&ChainPose>,
        EffectorId { arm, effector }: EffectorId,
        name: &str,
    ) -> Option<Value> {
        let (quantity, is_length) = match name {
            "x" => (FrameQuantity::X, true),
            "y" => (FrameQuantity::Y, true),
            "z" => (FrameQuantity::Z, true),
            "heading" => (FrameQuantity::Heading, false),
            "tilt" => (FrameQuantity::Tilt, false),
            "tilt_azimuth" => (FrameQuantity::TiltAzimuth, false),
            _ => return None,
        };
        let value = frame_quantity(&pose?.base_from_wafer[arm][effector], quantity);
        Some(Value::Real(if is_length {
            self.axis.length.from_meters(value)
        } else {
            self.axis.angle.from_radians(value)
        }))
    }

    /// The poses of all effectors by the template `pose`; empty without poses.
    pub(super) fn poses(
        &self,
        motion_export: &MotionExport<'_>,
        pose: Option<&ChainPose>,
        templates: &[Template],
    ) -> Result<String, Error> {
        let Some(template) = self.pose.as_ref().filter(|_| uses_poses(templates)) else {
            return Ok(String::new());
        };
        let filled = motion_export.cell.robot.effectors().map(|id| {
            let name = motion_export.effector_name(id);
            let filled = template.fill(|field| {
                self.pose_value(pose, id, field).unwrap_or_else(|| match field {
                    "effector" => Value::Text(name.to_owned()),
                    _ => self.effector_code(name),
                })
            });
            filled.map_err(invalid)
        });
        Ok(filled.collect::<Result<Vec<_>, Error>>()?.join(&self.axis.between))
    }
}
