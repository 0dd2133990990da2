//! Configurations of mechanisms as documents.

use jointplay::constraint::{CLOSURE_TOLERANCE, System as _};
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::explain::explain;
use jointplay::interop::export::MechanismShapes;
use jointplay::mechanism::joint::Coordinate;
use jointplay::mechanism::{
    Carrier, Closure, Kinematics, Mechanism, MechanismSystem, SparseSystem, VirtualMotion,
    assemble, close_sparse, exaggerated_link_poses, guess, pose_commanded,
};
use jointplay::nalgebra::DVector;
use jointplay::plot::MechanismPicture;
use jointplay::report;

use crate::mechanism_source::ReadMechanism;
use crate::problem::Problem;
use crate::wire::Triple;
use crate::wire::mechanism_view::{
    BarDocument, ConfigurationDocument, CoordinateInfo, LinkDocument, MechanismDocument,
    MechanismJoint, MechanismParameter, VirtualJointDocument,
};

impl ReadMechanism {
    /// The closed configuration near given coordinates, or from the guess of the file.
    pub(crate) fn closed(&self, from: Option<&DVector<f64>>) -> Result<Closure, jointplay::Error> {
        let mechanism = &self.file.mechanism;
        if !MechanismSystem::fits(mechanism) {
            let (system, iterations) = close_sparse(mechanism, &[])?;
            let coordinates = system.coordinates().clone();
            let residual = system.residual();
            return Ok(Closure { coordinates, residual, iterations, is_searched: false });
        }
        let motors = mechanism.actuated_coordinates();
        if let Some(from) = from {
            let commands: Vec<(usize, f64)> = motors.iter().map(|&k| (k, from[k])).collect();
            let near = if mechanism.virtual_joints().is_empty() {
                assemble(mechanism, from, &motors, 0).or_else(|_| assemble(mechanism, from, &[], 0))
            } else {
                pose_commanded(mechanism, &commands, None).map(|posed| posed.closed)
            };
            if let Ok(near) = near {
                return Ok(near);
            }
        }
        Ok(pose_commanded(mechanism, &[], None)?.closed)
    }

    /// A configuration that has to be closed.
    pub(crate) fn closed_at(&self, coordinates: DVector<f64>) -> Result<Closure, jointplay::Error> {
        let mechanism = &self.file.mechanism;
        let residual = if MechanismSystem::fits(mechanism) {
            let system = MechanismSystem::new(mechanism, coordinates.clone())?;
            system.mismatch(&system.at_home())
        } else {
            SparseSystem::new(mechanism, coordinates.clone())?.residual()
        };
        let closed = Closure { coordinates, residual, iterations: 0, is_searched: false };
        if closed.is_closed() {
            return Ok(closed);
        }
        Err(jointplay::Error::NotClosed { residual, allowed: CLOSURE_TOLERANCE })
    }

    /// The document of a closed configuration.
    ///
    /// # Arguments
    /// * `play_scale` – factor of the displacements of virtual joints in the poses
    pub(crate) fn configuration(
        &self,
        closed: &Closure,
        play_scale: f64,
    ) -> Result<ConfigurationDocument, Problem> {
        let (mechanism, at) = (&self.file.mechanism, &closed.coordinates);
        let poses = exaggerated_link_poses(mechanism, at, play_scale)?;
        let beyond = mechanism.beyond_limits(at);
        let joints = self.coordinates.joints();
        let note = report::search_note(&self.file, &guess(mechanism), closed);
        let note = note.map(|note| {
            let mut letters = note.chars();
            let first = letters.next().map(char::to_uppercase).into_iter().flatten();
            first.chain(letters).chain(['.']).collect()
        });
        Ok(ConfigurationDocument {
            coordinates: at.iter().copied().collect(),
            values: at
                .iter()
                .enumerate()
                .map(|(k, &value)| self.coordinates.from_si(k, value))
                .collect(),
            poses: poses.iter().map(Into::into).collect(),
            residual: closed.residual,
            displaced: at.iter().skip(joints).any(|&value| value != 0.0),
            limits_broken: report::beyond_limits(&self.coordinates, &beyond),
            note,
        })
    }

    /// The document of the mechanism.
    ///
    /// # Arguments
    /// * `from` – coordinates near which the loops are closed (m, rad)
    pub(crate) fn document(
        &self,
        from: Option<&DVector<f64>>,
        play_scale: f64,
    ) -> Result<MechanismDocument, Problem> {
        let (file, mechanism) = (&self.file, &self.file.mechanism);
        let closed = self.closed(from);
        let at =
            closed.as_ref().map_or_else(|_| guess(mechanism), |closed| closed.coordinates.clone());
        let poses = Kinematics::new(mechanism).link_poses(&at)?;
        let shapes = MechanismShapes::of(mechanism, &poses);
        let links = mechanism.links().iter().zip(&shapes.bars).map(|(name, bars)| LinkDocument {
            name: name.clone(),
            bars: bars
                .iter()
                .map(|&[from, to]| BarDocument {
                    from_m: Triple(from.into()),
                    to_m: Triple(to.into()),
                })
                .collect(),
        });
        let joints = mechanism.joints().iter().map(|joint| MechanismJoint {
            name: joint.name.clone(),
            kind: joint.kind.name(),
            links: joint.links,
            frames: [0, 1].map(|side: usize| (&joint.frames[side]).into()),
            actuated: joint.actuated,
        });
        let (configuration, problem) = match &closed {
            Ok(closed) => (Some(self.configuration(closed, play_scale)?), None),
            Err(error) => (None, Some(explain(error, DisplayUnits::of(file.units.length)))),
        };
        Ok(MechanismDocument {
            name: mechanism.name().to_owned(),
            source: file.source.clone(),
            length_unit: file.units.length.name(),
            angle_unit: file.units.angle.name(),
            links: links.collect(),
            joints: joints.collect(),
            virtual_joints: virtual_joints(mechanism),
            coordinates: self.coordinate_infos(&at, shapes.size),
            parameters: file
                .parameters
                .iter()
                .map(|(name, value)| MechanismParameter { name: name.clone(), value: *value })
                .collect(),
            size_m: shapes.size,
            view_direction: MechanismPicture::new(mechanism, at)
                .toward_viewer()
                .ok()
                .map(|toward| Triple(toward.into())),
            bar_radius_m: shapes.bar_radius,
            joint_radius_m: shapes.joint_radius,
            configuration,
            problem,
        })
    }

    fn coordinate_infos(&self, at: &DVector<f64>, size: f64) -> Vec<CoordinateInfo> {
        let (mechanism, coordinates) = (&self.file.mechanism, &self.coordinates);
        let actuated = mechanism.actuated_coordinates();
        let limits = mechanism.limits();
        let all = coordinates.all().iter().enumerate();
        all.map(|(k, named)| {
            let in_file = |range: [f64; 2]| range.map(|value| coordinates.from_si(k, value));
            let reach = match named.quantity {
                Coordinate::Turn => std::f64::consts::PI,
                Coordinate::Slide => size,
            };
            let is_joint = k < coordinates.joints();
            CoordinateInfo {
                name: named.name.clone(),
                joint: named.joint.clone(),
                unit: coordinates.unit(k),
                decimals: coordinates.decimals(k),
                actuated: actuated.contains(&k),
                virtual_joint: !is_joint,
                limits: limits[k]
                    .map(|range| in_file(range).map(|end| end.is_finite().then_some(end))),
                range: is_joint.then(|| in_file(slider_range(limits[k], at[k], reach))),
            }
        })
        .collect()
    }
}

/// The limits of a coordinate, with a reach from the configuration or the other end where there is none.
fn slider_range(limits: Option<[f64; 2]>, at: f64, reach: f64) -> [f64; 2] {
    let around = [at - reach, at + reach];
    match limits {
        Some([least, greatest]) if greatest.is_finite() && !least.is_finite() => {
            [around[0].min(greatest - reach), greatest]
        }
        Some([least, greatest]) if least.is_finite() && !greatest.is_finite() => {
            [least, around[1].max(least + reach)]
        }
        Some(limits) => limits,
        None => around,
    }
}

fn virtual_joints(mechanism: &Mechanism) -> Vec<VirtualJointDocument> {
    let one = |one: &jointplay::mechanism::VirtualJoint| {
        let (motion, direction) = match one.motion {
            VirtualMotion::Slide(direction) => ("slide", direction),
            VirtualMotion::Turn { axis, .. } => ("turn", axis),
        };
        VirtualJointDocument {
            name: one.name.clone(),
            joint: one.joint,
            link: mechanism.joints()[one.joint].links[usize::from(one.carrier == Carrier::Second)],
            motion,
            direction: Triple((*direction).into()),
        }
    };
    mechanism.virtual_joints().iter().map(one).collect()
}
