//! From many rods to the poses of the platform.

use super::{Column, Quantity, Status, Tally};
use crate::Error;
use crate::gpr::{Forward, Gpr};
use crate::mobility::RANK_THRESHOLD;
use crate::sensitivity::sensitivity;
use crate::virtualization::{SolveOptions, VirtualJoints, Virtualization};

impl Gpr {
    /// Where the platform is for each of many rods; see [`Self::forward`].
    ///
    /// # Arguments
    /// * `rods` – three columns of n: q_1, q_2, q_3 [m]
    /// * `status` – (n) written: what became of each pose
    /// * `wanted` – what is asked for, each with a column of n that is written, in the unit of the quantity
    ///
    /// # Errors
    /// [`Error::WrongLength`] for columns of different lengths, [`Error::NoSuchQuantity`], [`Error::VirtualJointCount`], [`Error::OutOfRange`] for the metric.
    /// Poses without an answer are NaN and have their status.
    ///
    /// # Numerics
    /// Does not allocate, but for sensitivities. Equal to [`Self::forward`] to 10⁻¹² of the platform's size; only what is asked for is computed.
    pub fn forward_many<V: Virtualization + ?Sized>(
        &self,
        rods: [Column<'_>; 3],
        virtualization: &V,
        options: &SolveOptions,
        status: &mut [Status],
        wanted: &mut [(Quantity, &mut [f64])],
    ) -> Result<Tally, Error> {
        let expected = status.len();
        super::same_lengths(
            expected,
            rods.iter().map(|column| ("a column of rods", column.len())),
        )?;
        super::same_lengths(
            expected,
            wanted.iter().map(|(_, column)| ("a column of results", column.len())),
        )?;
        for (quantity, _) in &*wanted {
            quantity.check(virtualization)?;
        }
        for i in 0..expected {
            status[i] =
                self.one([0, 1, 2].map(|k| rods[k].at(i)), virtualization, options, |told| {
                    for (quantity, column) in &mut *wanted {
                        column[i] = told(*quantity)?;
                    }
                    Ok(())
                })?;
        }
        Ok(Tally::of(status))
    }

    /// One pose by the scalar kernel, its quantities handed to `write`.
    fn one<V: Virtualization + ?Sized>(
        &self,
        rods: [f64; 3],
        virtualization: &V,
        options: &SolveOptions,
        write: impl FnOnce(&dyn Fn(Quantity) -> Result<f64, Error>) -> Result<(), Error>,
    ) -> Result<Status, Error> {
        match self.forward(rods, virtualization, options) {
            Ok(pose) => {
                write(&|quantity| self.value(&pose, virtualization, quantity))?;
                Ok(Status::Solved)
            }
            Err(error) => {
                write(&|_| Ok(f64::NAN))?;
                Status::of(&error).ok_or(error)
            }
        }
    }

    fn value<V: Virtualization + ?Sized>(
        &self,
        pose: &Forward,
        virtualization: &V,
        quantity: Quantity,
    ) -> Result<f64, Error> {
        Ok(match quantity {
            Quantity::Side(side) => pose.sides[side],
            Quantity::VirtualJoint(joint) => pose.solution.virtual_joints[joint],
            Quantity::Origin(axis) => pose.base_from_platform.translation.vector[axis],
            Quantity::Normal(axis) => pose.normal()[axis],
            Quantity::Yaw => pose.tilt().yaw,
            Quantity::Pitch => pose.tilt().pitch,
            Quantity::Twist => pose.twist_about_normal(),
            Quantity::AxisHeight => pose.axis_height().0,
            Quantity::Displacement => self.displacement(pose, virtualization),
            Quantity::Sensitivity(index) => {
                let system = self.system(virtualization);
                let at = system.configuration(pose);
                let rho = pose.solution.characteristic_length;
                sensitivity(&system, &at, rho, RANK_THRESHOLD)?.singular_values()[index]
            }
            Quantity::Residual => pose.solution.residual,
            // A whole number of iterations far below 2⁵³.
            Quantity::Iterations => pose.solution.iterations as f64,
        })
    }

    /// ‖X − X_0‖ in the metric [m].
    fn displacement<V: Virtualization + ?Sized>(&self, pose: &Forward, virtualization: &V) -> f64 {
        let x = &pose.solution.virtual_joints;
        let mut nominal = VirtualJoints::zeros(x.len());
        virtualization.nominal(self.platform(), &mut nominal);
        let rho = pose.solution.characteristic_length;
        x.iter()
            .zip(nominal.iter())
            .zip(virtualization.joints())
            .map(|((x, start), joint)| ((x - start) * joint.motion.weight(rho)).powi(2))
            .sum::<f64>()
            .sqrt()
    }
}
