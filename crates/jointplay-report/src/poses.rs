//! Poses of links and attached frames of a mechanism along a motion.

use jointplay_core::Error;
use jointplay_core::mechanism::{FrameId, Kinematics};
use jointplay_core::spatial::continued_quaternion;
use jointplay_format::mechanism::MechanismFile;
use nalgebra::DVector;

use crate::mechanism::ByName;
use crate::table::{Column, Values};

/// Poses along a motion, by the name of the link or frame; lengths in the unit of the file.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(transparent)]
pub struct PosesReport(pub ByName<PoseSeries>);

/// Pose of one link or frame in the base frame along a motion.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct PoseSeries {
    /// Origin at each configuration, in the unit of lengths of the file.
    pub position: Vec<[f64; 3]>,
    /// Unit quaternion w, x, y, z at each configuration; the first has w ≥ 0, every other a sign without jumps.
    pub quaternion: Vec<[f64; 4]>,
    /// Unit of lengths, for the names of columns.
    #[serde(skip)]
    unit: &'static str,
}

impl PosesReport {
    /// Poses of all links but the base, and of all attached frames.
    ///
    /// # Arguments
    /// * `configurations` – (f + M) coordinates of each configuration (m, rad)
    ///
    /// # Errors
    /// Those of [`Kinematics::link_poses`].
    pub fn along(file: &MechanismFile, configurations: &[&DVector<f64>]) -> Result<Self, Error> {
        let kinematics = Kinematics::new(&file.mechanism);
        let frames: Vec<FrameId> = file.mechanism.moving_frames().collect();
        let unit = file.units.length;
        let empty = PoseSeries { position: Vec::new(), quaternion: Vec::new(), unit: unit.name() };
        let mut series = vec![empty; frames.len()];
        for configuration in configurations {
            let links = kinematics.link_poses(configuration)?;
            for (one, &frame) in series.iter_mut().zip(&frames) {
                let pose = kinematics.frame_pose(frame, &links);
                one.position
                    .push(pose.translation.vector.map(|value| unit.from_meters(value)).into());
                one.quaternion.push(continued_quaternion(&pose.rotation, one.quaternion.last()));
            }
        }
        let name = |&frame: &FrameId| file.mechanism.frame_name(frame).to_owned();
        Ok(Self(ByName(frames.iter().map(name).zip(series).collect())))
    }

    /// The poses as columns of a table: `platform_x_mm`, …, `platform_qw`, ….
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        let of_frame = |(name, series): &(String, PoseSeries)| {
            let column =
                |name: String, values: Vec<f64>| Column { name, values: Values::Real(values) };
            let origin = ["x", "y", "z"].into_iter().enumerate().map(|(axis, letter)| {
                let values = series.position.iter().map(|at| at[axis]).collect();
                column(format!("{name}_{letter}_{}", series.unit), values)
            });
            let quaternion = ["qw", "qx", "qy", "qz"].into_iter().enumerate().map(|(k, part)| {
                let values = series.quaternion.iter().map(|q| q[k]).collect();
                column(format!("{name}_{part}"), values)
            });
            origin.chain(quaternion).collect::<Vec<_>>()
        };
        self.0.0.iter().flat_map(of_frame).collect()
    }
}
