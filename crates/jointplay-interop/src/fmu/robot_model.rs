//! Three-rod robots: forward kinematics under a virtualization.

use jointplay_core::Error as CoreError;
use jointplay_core::bulk::PoseSolver;
use jointplay_core::gpr::Gpr;
use jointplay_core::spatial::quaternion_rate;
use jointplay_core::virtualization::{
    BuiltIn, SolveOptions, VirtualJointKind, Virtualization, built_in,
};
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::explain::explain_limit;
use jointplay_format::robot::parse_with;
use nalgebra::{DVector, Vector3};

use super::error::Error;
use super::resources::{RESOURCE_FILES, Resources};
use super::solved::{Solved, push_pose, quaternion};
use super::variable::{POSE_OUTPUTS, Quantity, Variables, name_part};

/// Names of the rods, those of the robot as a mechanism.
const RODS: [&str; 3] = ["rod 1", "rod 2", "rod 3"];

#[derive(Clone)]
pub(super) struct RobotModel {
    gpr: Gpr,
    virtualization: &'static dyn Virtualization,
    solver: PoseSolver,
}

impl std::fmt::Debug for RobotModel {
    fn fmt(&self, to: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let virtualization = self.virtualization.name();
        to.debug_struct("RobotModel")
            .field("gpr", &self.gpr)
            .field("virtualization", &virtualization)
            .finish()
    }
}

impl RobotModel {
    pub(super) fn new(resources: &Resources) -> Result<(Self, Variables, Solved), Error> {
        let built_in = named(resources.virtualization.as_deref())?;
        let read = parse_with(&resources.model, &resources.parameters);
        let robot = read.map_err(|errors| {
            let file = RESOURCE_FILES[0].to_owned();
            Error::Resource { message: errors.with_excerpt(&file), file }
        })?;
        let gpr = robot.gpr;
        let mut rods = [gpr.working_height(); 3];
        for (name, value) in &resources.start {
            let k = RODS.iter().position(|rod| rod == name).ok_or_else(|| {
                let known = RODS.map(str::to_owned).to_vec();
                let found = name.clone();
                Error::Coordinate(jointplay_format::coordinates::Error::Unknown {
                    found,
                    nearest: None,
                    known,
                })
            })?;
            rods[k] = *value;
        }
        let solver = PoseSolver::new(&gpr, built_in, &SolveOptions::default())?;
        let model = Self { gpr, virtualization: built_in.model(), solver };
        let variables = model.variables(&rods);
        let solved = model.solve(&rods, None)?;
        Ok((model, variables, solved))
    }

    fn variables(&self, start: &[f64; 3]) -> Variables {
        let limits = self.gpr.limits();
        let limits = [limits.rod_min, limits.rod_max];
        let mut variables = Variables::default();
        for (rod, &start) in RODS.iter().zip(start) {
            let (part, description) = (name_part(rod), format!("length of {rod}"));
            variables.drive(&part, Quantity::Length, start, Some(limits), description);
        }
        variables.pose("platform");
        for joint in self.virtualization.joints() {
            let quantity = match joint.motion {
                VirtualJointKind::Linear => Quantity::Length,
                VirtualJointKind::Angular => Quantity::Angle,
            };
            variables.virtual_joint(&format!("{}{}", joint.symbol, joint.limb + 1), quantity);
        }
        variables
    }

    /// The pose for lengths of the rods (m).
    pub(super) fn solve(&self, drives: &[f64], near: Option<&Solved>) -> Result<Solved, Error> {
        let rods: [f64; 3] = three(drives)?;
        let found = self.solver.forward(rods);
        let pose = found.map_err(|error| match error {
            CoreError::BeyondLimits(broken) => Error::BeyondLimits {
                messages: broken
                    .iter()
                    .map(|one| explain_limit(&one, DisplayUnits::Metric))
                    .collect(),
            },
            other => other.into(),
        })?;
        let mut outputs = Vec::with_capacity(POSE_OUTPUTS + self.virtualization.joints().len());
        push_pose(&mut outputs, &pose.base_from_platform, near.map(|near| &near.outputs[..]));
        outputs.extend(self.gpr.virtual_displacements(&pose, self.virtualization).iter());
        Ok(Solved { drives: drives.to_vec(), coordinates: DVector::zeros(0), outputs })
    }

    pub(super) fn rates(&self, at: &Solved, drives: &[f64]) -> Result<Vec<f64>, Error> {
        let pose = self.solver.forward(three(&at.drives)?)?;
        let jacobian = self.gpr.platform_jacobian(&pose, self.virtualization)?;
        let velocities = Vector3::from(three(drives)?);
        let twist = jacobian.velocity(&velocities);
        let turn = quaternion(&at.outputs, 0).unwrap_or([1.0, 0.0, 0.0, 0.0]);
        let mut rates = twist.linear.as_slice().to_vec();
        rates.extend(quaternion_rate(&turn, &twist.angular));
        rates.extend(jacobian.virtual_velocities(&velocities).iter());
        Ok(rates)
    }
}

fn three(values: &[f64]) -> Result<[f64; 3], CoreError> {
    let what = "the vector of rod lengths";
    values.try_into().map_err(|_| CoreError::LengthMismatch {
        what,
        found: values.len(),
        expected: 3,
    })
}

/// A virtualization of the library by its name; the planar one without a name.
fn named(name: Option<&str>) -> Result<BuiltIn, Error> {
    let Some(name) = name else { return Ok(BuiltIn::Planar) };
    let found = built_in().into_iter().find(|model| model.name() == name);
    found.and_then(Virtualization::as_built_in).ok_or_else(|| {
        let known = built_in().iter().map(|model| model.name().to_owned()).collect();
        Error::Virtualization { found: name.to_owned(), known }
    })
}
