//! Studies of mechanisms with loops.

use std::sync::Arc;

use jointplay_core::Error as CoreError;
use jointplay_core::bulk::Status;
use jointplay_core::mechanism::{
    CommandedPositions, FrameId, LinkPoses, Mechanism, MechanismSystem, ReliefSolver, close,
    close_at_rest, close_commanded, virtual_weights,
};
use jointplay_core::mobility::{RANK_THRESHOLD, instantaneous_mobility};
use jointplay_core::spatial::{Pose, continued_quaternion, rotation_vector};
use nalgebra::DVector;

use super::block::{Block, Outcome, Portions, SampleLimit};
use super::grid::{self, Grid};
use super::random::{DRIVE_STREAMS, PARAMETER_STREAMS};
use super::study::{self, Study};
use super::variation::Variation;
use crate::Error;

/// Corrections from the closed configuration of the design to that of other dimensions.
const CORRECTIONS: usize = 50;

/// Makes a mechanism of the values of its varied parameters, in the order of the study; `None` where they make none.
pub type MechanismOf = Arc<dyn Fn(&[f64]) -> Option<Mechanism> + Send + Sync>;

/// A varied parameter of a mechanism.
#[derive(Debug, Clone, PartialEq)]
pub struct VariedParameter {
    /// Number of the parameter in its file, which chooses its random numbers.
    pub number: usize,
    /// Its values, in the units of the file.
    pub values: Variation,
}

/// A commanded joint coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct VariedDrive {
    /// Index of the coordinate.
    pub coordinate: usize,
    /// Its values (m, rad).
    pub values: Variation,
}

/// A number that each sample of a mechanism has, in its SI unit; indices count from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MechanismQuantity {
    /// A varied parameter, as given (in the units of its file).
    Parameter(usize),
    /// A commanded coordinate, as given (m, rad).
    Drive(usize),
    /// A coordinate of a joint or virtual joint (m, rad).
    Coordinate(usize),
    /// Coordinate x, y or z of the origin of a frame in the base frame (m).
    Origin(FrameId, usize),
    /// Component w, x, y or z of the unit quaternion of a frame in the base frame, w ≥ 0.
    Quaternion(FrameId, usize),
    /// Distance of the origin of a frame from where the design has it for the same commands (m).
    PositionError(FrameId),
    /// Angle between a frame and its orientation in the design for the same commands (rad).
    OrientationError(FrameId),
    /// Size of the displacement of the virtual joints: √(Σ w x²) (m).
    Displacement,
    /// Instantaneous mobility with virtual joints locked.
    Mobility,
    /// Rank of the closure equations.
    Rank,
    /// Redundant closure equations.
    Redundant,
}

impl MechanismQuantity {
    fn needs_poses(self) -> bool {
        matches!(self, Self::Origin(..) | Self::Quaternion(..)) || self.needs_design()
    }

    fn needs_design(self) -> bool {
        matches!(self, Self::PositionError(_) | Self::OrientationError(_))
    }

    fn needs_mobility(self) -> bool {
        matches!(self, Self::Mobility | Self::Rank | Self::Redundant)
    }
}

/// Definition of a study of a mechanism: dimensions and commands that vary, and what is computed of each sample.
///
/// Lists of values make a grid: every value with every other, the last drive running fastest, and the first parameter slowest.
/// Each draw of what is random runs through the whole grid.
///
/// # Numerics
/// The closed configuration of other dimensions is the one nearest to that of the design; from there, the commanded coordinates move to their values along a straight line, and virtual joints take their least displacement ([`CommandedPositions::follow`]).
#[derive(Clone)]
pub struct MechanismPlan {
    /// The mechanism as designed.
    pub design: Mechanism,
    /// The mechanism of varied parameters.
    pub mechanism_of: MechanismOf,
    /// Parameters that vary.
    pub parameters: Vec<VariedParameter>,
    /// Joint coordinates that are commanded.
    pub drives: Vec<VariedDrive>,
    /// Number of draws of the random quantities; 1 where nothing is random.
    pub draws: u64,
    /// Seed of the random draws.
    pub seed: u64,
    /// Quantities to compute of each sample, a column each.
    pub wanted: Vec<MechanismQuantity>,
}

impl MechanismPlan {
    /// All that varies, the last running fastest, with the numbers of the random streams.
    fn varied(&self) -> impl Iterator<Item = (&Variation, u64)> + Clone {
        let parameters = self.parameters.iter();
        let parameters = parameters.map(|one| (&one.values, PARAMETER_STREAMS + one.number as u64));
        let drives = self.drives.iter();
        let drives = drives.map(|one| (&one.values, DRIVE_STREAMS + one.coordinate as u64));
        parameters.chain(drives)
    }

    /// Commanded coordinates.
    fn commanded(&self) -> Vec<usize> {
        self.drives.iter().map(|drive| drive.coordinate).collect()
    }

    /// Whether anything is random.
    #[must_use]
    pub fn draws_anything(&self) -> bool {
        self.varied().any(|(one, _)| one.is_random())
    }

    /// The design at the configuration that everything starts from.
    ///
    /// # Errors
    /// [`Error::Core`] if its loops do not close, or if its joints cannot be commanded.
    pub fn check(&self) -> Result<(), Error> {
        let home = close_at_rest(&self.design, None)?.coordinates;
        Posed::new(self.design.clone(), home, &self.commanded())?;
        Ok(())
    }
}

impl Study for MechanismPlan {
    fn samples(&self) -> Result<u64, Error> {
        grid::samples(self.varied().map(|(one, _)| one), self.draws)
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn columns(&self) -> usize {
        self.wanted.len()
    }

    fn solved_for(&self) -> Vec<String> {
        vec!["positions".to_owned()]
    }

    fn limits(&self) -> &'static [SampleLimit] {
        &[SampleLimit::Joints]
    }

    fn depends_on_processor(&self) -> bool {
        true
    }

    fn portions(&self) -> Portions {
        Portions::SLOW
    }

    fn compute(&self, samples: &[u64]) -> Result<Block, Error> {
        study::check(self, samples)?;
        let grid = Grid::new(self.varied(), self.draws, self.seed)?;
        let mut work = Work::new(self)?;
        grid.compute(samples, self.wanted.len(), |values, row| work.sample(values, row))
    }
}

/// A mechanism of certain dimensions, ready for commands.
struct Posed {
    mechanism: Mechanism,
    /// (f + M) closed coordinates (m, rad).
    home: DVector<f64>,
    positions: CommandedPositions,
    link_poses: LinkPoses,
    /// Of the virtual joints.
    weights: DVector<f64>,
}

impl Posed {
    fn new(
        mechanism: Mechanism,
        home: DVector<f64>,
        commanded: &[usize],
    ) -> Result<Self, CoreError> {
        let positions = CommandedPositions::new(&mechanism, &home, commanded)?;
        Self::with(mechanism, home, positions)
    }

    fn with(
        mechanism: Mechanism,
        home: DVector<f64>,
        positions: CommandedPositions,
    ) -> Result<Self, CoreError> {
        let weights = virtual_weights(&MechanismSystem::new(&mechanism, home.clone())?);
        let link_poses = LinkPoses::new(&mechanism);
        Ok(Self { mechanism, home, positions, link_poses, weights })
    }

    /// The configuration for commands; `None` where none was found.
    fn configuration(&mut self, commands: &[f64]) -> Result<Option<DVector<f64>>, Error> {
        let mut coordinates = self.home.clone();
        if commands.is_empty() {
            return Ok(Some(coordinates));
        }
        let (mechanism, solver) = (&self.mechanism, ReliefSolver::LeastNorm);
        match self.positions.follow(mechanism, commands, &mut coordinates, solver) {
            Ok(_) => Ok(Some(coordinates)),
            Err(error) if error.is_infeasible() => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    fn poses(&self, coordinates: &DVector<f64>) -> Result<Vec<Pose>, Error> {
        Ok(self.link_poses.compute(coordinates)?)
    }
}

/// Samples under computation.
struct Work<'a> {
    plan: &'a MechanismPlan,
    design_home: DVector<f64>,
    /// The design, where samples are compared with it.
    design: Option<Posed>,
    /// The mechanism of the last parameters; `None` inside where they make none, or loops that do not close.
    last: Option<(Vec<f64>, Result<Posed, Outcome>)>,
}

impl<'a> Work<'a> {
    fn new(plan: &'a MechanismPlan) -> Result<Self, Error> {
        let design_home = close_at_rest(&plan.design, None)?.coordinates;
        let is_compared = plan.wanted.iter().any(|one| one.needs_design());
        let design = || Posed::new(plan.design.clone(), design_home.clone(), &plan.commanded());
        let design = is_compared.then(design).transpose()?;
        Ok(Self { plan, design_home, design, last: None })
    }

    /// Computes a sample into the row: its outcome, and whether a joint is beyond its limits.
    fn sample(&mut self, values: &[f64], row: &mut [f64]) -> Result<(Outcome, bool), Error> {
        let (parameters, commands) = values.split_at(self.plan.parameters.len());
        for (entry, wanted) in row.iter_mut().zip(&self.plan.wanted) {
            *entry = match *wanted {
                MechanismQuantity::Parameter(k) => parameters[k],
                MechanismQuantity::Drive(k) => commands[k],
                _ => f64::NAN,
            };
        }
        let same =
            |last: &[f64]| last.iter().zip(parameters).all(|(a, b)| a.to_bits() == b.to_bits());
        if self.last.as_ref().is_none_or(|(last, _)| !same(last)) {
            let made = self.mechanism(parameters)?;
            self.last = Some((parameters.to_vec(), made));
        }
        let Some((_, made)) = &mut self.last else { return Ok((Outcome::NoMechanism, false)) };
        let posed = match made {
            Ok(posed) => posed,
            Err(outcome) => return Ok((*outcome, false)),
        };
        let Some(coordinates) = posed.configuration(commands)? else {
            return Ok((Outcome::Pose(Status::NotConverged), false));
        };
        let poses = match self.plan.wanted.iter().any(|one| one.needs_poses()) {
            true => posed.poses(&coordinates)?,
            false => Vec::new(),
        };
        let design = match &mut self.design {
            None => None,
            Some(design) => match design.configuration(commands)? {
                Some(found) => Some(design.poses(&found)?),
                None => None,
            },
        };
        let mobility = match self.plan.wanted.iter().any(|one| one.needs_mobility()) {
            true => {
                let system = MechanismSystem::new(&posed.mechanism, coordinates.clone())?;
                Some(instantaneous_mobility(&system, &system.at_home(), RANK_THRESHOLD)?)
            }
            false => None,
        };
        let joints = posed.mechanism.joint_freedoms();
        let whole = |count: Option<usize>| count.map_or(f64::NAN, |count| count as f64);
        let frame = |poses: &[Pose], frame| posed.mechanism.frame_pose(frame, poses);
        let compared = |of, measure: &dyn Fn(&Pose, &Pose) -> f64| {
            let design = design.as_ref().map(|poses| self.plan.design.frame_pose(of, poses));
            design.map_or(f64::NAN, |design| measure(&frame(&poses, of), &design))
        };
        for (entry, wanted) in row.iter_mut().zip(&self.plan.wanted) {
            *entry = match *wanted {
                MechanismQuantity::Parameter(_) | MechanismQuantity::Drive(_) => continue,
                MechanismQuantity::Coordinate(k) => coordinates[k],
                MechanismQuantity::Origin(of, axis) => frame(&poses, of).translation.vector[axis],
                MechanismQuantity::Quaternion(of, part) => {
                    continued_quaternion(&frame(&poses, of).rotation, None)[part]
                }
                MechanismQuantity::PositionError(of) => compared(of, &|found, design| {
                    (found.translation.vector - design.translation.vector).norm()
                }),
                MechanismQuantity::OrientationError(of) => compared(of, &|found, design| {
                    rotation_vector(&(design.rotation.inverse() * found.rotation)).norm()
                }),
                MechanismQuantity::Displacement => {
                    let squares = coordinates.rows_range(joints..).map(|value| value * value);
                    squares.dot(&posed.weights).sqrt()
                }
                MechanismQuantity::Mobility => whole(mobility.as_ref().map(|found| found.mobility)),
                MechanismQuantity::Rank => whole(mobility.as_ref().map(|found| found.rank)),
                MechanismQuantity::Redundant => {
                    whole(mobility.as_ref().map(|found| found.redundancy))
                }
            };
        }
        let is_beyond = !posed.mechanism.beyond_limits(&coordinates).is_empty();
        Ok((Outcome::Pose(Status::Solved), is_beyond))
    }

    /// The mechanism of some parameters, or why there is none.
    fn mechanism(&self, parameters: &[f64]) -> Result<Result<Posed, Outcome>, Error> {
        let mechanism = match parameters.is_empty() {
            true => self.plan.design.clone(),
            false => match (self.plan.mechanism_of)(parameters) {
                Some(mechanism) => mechanism,
                None => return Ok(Err(Outcome::NoMechanism)),
            },
        };
        match self.posed(mechanism) {
            Ok(posed) => Ok(Ok(posed)),
            Err(error) if error.is_infeasible() => Ok(Err(Outcome::Pose(Status::NotConverged))),
            Err(error) => Err(error.into()),
        }
    }

    /// A mechanism at the closed configuration nearest to that of the design, with virtual joints displaced if rigid links do not close.
    fn posed(&self, mechanism: Mechanism) -> Result<Posed, CoreError> {
        let commanded = self.plan.commanded();
        let near = MechanismSystem::new(&mechanism, self.design_home.clone())?;
        let joints: Vec<usize> = (0..mechanism.joint_freedoms()).collect();
        let found = close(&near, &joints, CORRECTIONS)?;
        if found.is_closed() {
            return Posed::new(mechanism, found.coordinates, &commanded);
        }
        if mechanism.virtual_joints().is_empty() || commanded.is_empty() {
            let found = close_commanded(&mechanism, &[], None)?;
            return Posed::new(mechanism, found.coordinates, &commanded);
        }
        let mut home = self.design_home.clone();
        let commands: Vec<f64> = commanded.iter().map(|&k| home[k]).collect();
        let mut positions = CommandedPositions::new(&mechanism, &home, &commanded)?;
        positions.solve(&mechanism, &commands, &mut home, ReliefSolver::LeastNorm)?;
        Posed::with(mechanism, home, positions)
    }
}
