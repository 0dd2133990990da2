//! Mechanisms: positions with loops closed, virtual joints at their least displacement.

use jointplay_core::Error as CoreError;
use jointplay_core::mechanism::{
    CommandedPositions, FrameId, JointKind, LinkPoses, ReliefSolver, pose_commanded,
};
use jointplay_core::spatial::quaternion_rate;
use jointplay_format::coordinates::Coordinates;
use jointplay_format::mechanism::{MechanismFile, parse_with};
use jointplay_report::{FreeMotionsReport, beyond_limits};
use nalgebra::DVector;

use super::error::Error;
use super::resources::{RESOURCE_FILES, Resources};
use super::solved::{Solved, push_pose, quaternion};
use super::variable::{POSE_OUTPUTS, Variables, name_part};

#[derive(Debug, Clone)]
pub(super) struct MechanismModel {
    file: MechanismFile,
    coordinates: Coordinates,
    /// Coordinates of the actuated joints.
    drives: Vec<usize>,
    /// Links other than the base, then attached frames.
    frames: Vec<FrameId>,
    positions: CommandedPositions,
    link_poses: LinkPoses,
    /// Rates of all coordinates.
    velocities: Vec<f64>,
}

impl MechanismModel {
    pub(super) fn new(resources: &Resources) -> Result<(Self, Variables, Solved), Error> {
        if let Some(found) = resources.virtualization.clone() {
            return Err(Error::Virtualization { found, known: Vec::new() });
        }
        let file = parse_with(&resources.model, &resources.parameters).map_err(|errors| {
            let file = RESOURCE_FILES[0].to_owned();
            Error::Resource { message: errors.with_excerpt(&file), file }
        })?;
        let mechanism = &file.mechanism;
        let drives = mechanism.actuated_coordinates();
        if drives.is_empty() {
            return Err(Error::NoDrives { mechanism: mechanism.name().to_owned() });
        }
        let mut actuated = mechanism.joints().iter().filter(|joint| joint.actuated);
        if let Some(ball) = actuated.find(|joint| joint.kind == JointKind::Spherical) {
            return Err(Error::ActuatedBall { joint: ball.name.clone() });
        }
        let coordinates = Coordinates::of(&file);
        let commands = resources.start.iter().map(|(name, value)| {
            let k = coordinates.find(mechanism, name)?;
            Ok((k, coordinates.checked(k, *value)?))
        });
        let commands: Vec<(usize, f64)> = commands.collect::<Result<_, Error>>()?;
        let start = pose_commanded(mechanism, &commands, None)?.closed.coordinates;
        let positions = CommandedPositions::new(mechanism, &start, &drives)?;
        let variables = variables(&file, &coordinates, &drives, &start);
        let frames = mechanism.moving_frames().collect();
        let velocities = vec![0.0; coordinates.all().len()];
        let link_poses = LinkPoses::new(mechanism);
        let values: Vec<f64> = drives.iter().map(|&k| start[k]).collect();
        let mut model =
            Self { file, coordinates, drives, frames, positions, link_poses, velocities };
        let first = Solved { drives: values, coordinates: start, outputs: Vec::new() };
        let solved = model.solve(&first.drives, &first)?;
        // Motions that the drives do not determine, and drives that hinder each other, are found before a simulation.
        let still = vec![0.0; model.drives.len()];
        for k in 0..still.len() {
            let mut rates = still.clone();
            rates[k] = 1.0;
            model.rates(&solved, &rates).map_err(|error| model.named(error, &solved))?;
        }
        Ok((model, variables, solved))
    }

    pub(super) fn solve(&mut self, drives: &[f64], near: &Solved) -> Result<Solved, Error> {
        for (&k, &value) in self.drives.iter().zip(drives) {
            self.coordinates.checked(k, value)?;
        }
        let mut coordinates = near.coordinates.clone();
        let (mechanism, solver) = (&self.file.mechanism, ReliefSolver::LeastNorm);
        match self.positions.solve(mechanism, drives, &mut coordinates, solver) {
            Ok(_) => self.solved(drives, coordinates, near),
            Err(error) => Err(self.explained(error, drives, near)),
        }
    }

    pub(super) fn initialize(&mut self, drives: &[f64], near: &Solved) -> Result<Solved, Error> {
        match self.solve(drives, near) {
            Err(Error::TooFar { .. }) => {
                let commands: Vec<(usize, f64)> =
                    self.drives.iter().copied().zip(drives.iter().copied()).collect();
                let found = pose_commanded(&self.file.mechanism, &commands, None)?;
                let near = Solved { coordinates: found.closed.coordinates, ..near.clone() };
                self.solve(drives, &near)
            }
            found => found,
        }
    }

    /// The free motions of an error that counts them.
    fn named(&self, error: Error, at: &Solved) -> Error {
        if !matches!(error, Error::Core(CoreError::Undetermined(_))) {
            return error;
        }
        match FreeMotionsReport::new(&self.file.mechanism, &at.coordinates, &self.drives) {
            Ok(motions) if motions.count() > 0 => Error::FreeMotions { motions },
            _ => error,
        }
    }

    /// An iteration that did not converge, with the drive that moved most.
    fn explained(&self, error: CoreError, drives: &[f64], near: &Solved) -> Error {
        let unreached = matches!(
            error,
            CoreError::NotReached { .. }
                | CoreError::NotRelieved { .. }
                | CoreError::NotLeast { .. }
        );
        let moved = drives.iter().zip(&near.drives).map(|(to, from)| (to - from).abs());
        let most = moved.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        match most {
            Some((k, distance)) if unreached && distance > 0.0 => {
                let named = &self.coordinates.all()[self.drives[k]];
                let (variable, quantity) = (drive_name(&named.name), named.quantity);
                Error::TooFar {
                    source: Box::new(error),
                    variable: format!("drive.{variable}"),
                    distance,
                    quantity,
                }
            }
            _ => error.into(),
        }
    }

    fn solved(
        &self,
        drives: &[f64],
        coordinates: DVector<f64>,
        near: &Solved,
    ) -> Result<Solved, Error> {
        let mechanism = &self.file.mechanism;
        let beyond = mechanism.beyond_limits(&coordinates);
        if !beyond.is_empty() {
            let found = beyond_limits(&self.coordinates, &beyond);
            let messages = found.into_iter().map(|one| one.message).collect();
            return Err(Error::BeyondLimits { messages });
        }
        let links = self.link_poses.compute(&coordinates)?;
        let count = POSE_OUTPUTS * self.frames.len() + mechanism.virtual_joints().len();
        let mut outputs = Vec::with_capacity(count);
        for &frame in &self.frames {
            let pose = mechanism.frame_pose(frame, &links);
            push_pose(&mut outputs, &pose, Some(&near.outputs));
        }
        outputs.extend(coordinates.iter().skip(self.coordinates.joints()));
        Ok(Solved { drives: drives.to_vec(), coordinates, outputs })
    }

    pub(super) fn rates(&mut self, at: &Solved, drives: &[f64]) -> Result<Vec<f64>, Error> {
        // The configuration found last may be another one; the same commands have the same solution.
        let mut coordinates = at.coordinates.clone();
        let (mechanism, solver) = (&self.file.mechanism, ReliefSolver::LeastNorm);
        self.positions.solve(mechanism, &at.drives, &mut coordinates, solver)?;
        let kinematics = self.positions.linearize(&coordinates)?;
        kinematics.velocities(drives, &mut self.velocities)?;
        let mut rates = Vec::with_capacity(at.outputs.len());
        for &frame in &self.frames {
            let twist = kinematics.frame_velocity(frame)?;
            let turn = quaternion(&at.outputs, rates.len()).unwrap_or([1.0, 0.0, 0.0, 0.0]);
            rates.extend_from_slice(twist.linear.as_slice());
            rates.extend(quaternion_rate(&turn, &twist.angular));
        }
        rates.extend(self.velocities.iter().skip(self.coordinates.joints()));
        Ok(rates)
    }
}

/// The part of a variable's name for a coordinate such as `crank` or `S1[2]`.
fn drive_name(coordinate: &str) -> String {
    match coordinate.split_once('[') {
        // Names of joints have no brackets.
        Some((joint, index)) => format!("{}[{index}", name_part(joint)),
        None => name_part(coordinate),
    }
}

fn variables(
    file: &MechanismFile,
    coordinates: &Coordinates,
    drives: &[usize],
    start: &DVector<f64>,
) -> Variables {
    let mechanism = &file.mechanism;
    let limits = mechanism.limits();
    let mut variables = Variables::default();
    for &k in drives {
        let named = &coordinates.all()[k];
        let description = format!("position of the joint {}", named.name);
        let (part, quantity) = (drive_name(&named.name), named.quantity.into());
        variables.drive(&part, quantity, start[k], limits[k], description);
    }
    for frame in mechanism.moving_frames() {
        variables.pose(mechanism.frame_name(frame));
    }
    for named in &coordinates.all()[coordinates.joints()..] {
        variables.virtual_joint(&named.name, named.quantity.into());
    }
    variables
}
