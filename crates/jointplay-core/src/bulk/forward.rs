//! From many rods to the poses of the platform.

use std::marker::PhantomData;

use pulp::Arch;

use super::blocks::{Blocks, Within};
use super::results::{PLACES, place};
use super::{Column, Quantity, Status, StatusCounts};
use crate::Error;
use crate::gpr::{Gpr, PlatformPose};
use crate::kernel::{
    Chosen, FirstStep, JointPolynomials, Model, Offset, Planar, Polar, Radial, Task,
};
use crate::mobility::RANK_THRESHOLD;
use crate::sensitivity::sensitivity;
use crate::virtualization::{BuiltIn, SolveOptions, Solver, Virtualization};

impl Gpr {
    /// Platform poses for many sets of rods; see [`Self::forward`].
    ///
    /// # Arguments
    /// * `rods` – three columns of n: q_1, q_2, q_3 (m)
    /// * `status` – (n) written: what became of each pose
    /// * `wanted` – what is asked for, each with a column of n that is written, in the unit of the quantity
    ///
    /// # Errors
    /// [`Error::LengthMismatch`] for columns of different lengths, [`Error::NoSuchQuantity`], [`Error::VirtualJointCount`], [`Error::OutOfRange`] for the metric.
    /// Poses without an answer, or beyond the limits of a robot that checks them, are NaN and have their status.
    ///
    /// # Numerics
    /// Does not allocate, save for sensitivities of a virtualization without a [`BuiltIn`].
    /// Equal to [`Self::forward`] to 10⁻¹² of the platform's size; where a residual is within round-off of the threshold, after one iteration more or less.
    /// Only what is asked for is computed.
    /// Poses that do not end within a few steps, and virtualizations without a kernel, are computed one by one.
    pub fn forward_many(
        &self,
        rods: [Column<'_>; 3],
        virtualization: &dyn Virtualization,
        options: &SolveOptions,
        status: &mut [Status],
        wanted: &mut [(Quantity, &mut [f64])],
    ) -> Result<StatusCounts, Error> {
        let (first_step, polynomials) = (None, None);
        Work { gpr: self, rods, virtualization, options, first_step, polynomials, status, wanted }
            .compute()
    }
}

/// The work of one call.
pub(super) struct Work<'a, 'b> {
    pub(super) gpr: &'a Gpr,
    pub(super) rods: [Column<'a>; 3],
    pub(super) virtualization: &'a dyn Virtualization,
    pub(super) options: &'a SolveOptions,
    /// The first step from nominal, where it was prepared.
    pub(super) first_step: Option<&'a FirstStep>,
    /// The virtual joints as polynomials, where they were prepared.
    pub(super) polynomials: Option<&'a JointPolynomials>,
    pub(super) status: &'a mut [Status],
    pub(super) wanted: &'a mut [(Quantity, &'b mut [f64])],
}

impl<'b> Work<'_, 'b> {
    /// Computes all poses.
    ///
    /// # Errors
    /// Those of [`Gpr::forward_many`].
    pub(super) fn compute(mut self) -> Result<StatusCounts, Error> {
        let expected = self.status.len();
        super::column::same_lengths(
            expected,
            self.rods.iter().map(|column| ("a column of rods", column.len())),
        )?;
        super::column::same_lengths(
            expected,
            self.wanted.iter().map(|(_, column)| ("a column of results", column.len())),
        )?;
        for (quantity, _) in &*self.wanted {
            quantity.check(self.virtualization)?;
        }
        match self.virtualization.as_built_in() {
            Some(BuiltIn::Radial) => self.by_kernel::<Radial>(),
            Some(BuiltIn::Polar) => self.by_kernel::<Polar>(),
            Some(BuiltIn::Offset) => self.by_kernel::<Offset>(),
            Some(BuiltIn::Planar) => self.by_kernel::<Planar>(),
            None => self.one_by_one(0..expected),
        }?;
        Ok(StatusCounts::of(self.status))
    }

    fn by_kernel<M: Model>(&mut self) -> Result<(), Error> {
        let platform = self.gpr.platform();
        let length = self.options.metric.characteristic_length(platform)?;
        let task = Task::new::<M>(self.gpr.dimensions(), self.options, length);
        let own = match self.first_step {
            Some(_) => None,
            None => FirstStep::new(platform, self.virtualization, length),
        };
        match self.first_step.or(own.as_ref()) {
            // The kernel always takes one step.
            Some(first_step) if self.options.max_iterations > 0 => {
                let task = Task { first_step: Some(first_step), ..task };
                // Where many tilts of the robot are beyond the polynomials, trying them costs more than it gains.
                let steepest = self.gpr.steepest();
                self.polynomials =
                    self.polynomials.filter(|polynomials| polynomials.reach(steepest));
                if task.solver == Solver::ClosedForm {
                    self.polynomials = None;
                }
                M::by_blocks(self, task, Arch::new())
            }
            _ => self.one_by_one(0..self.status.len()),
        }
    }

    fn blocks<'w, M: Model>(&'w mut self, task: Task<'w>) -> Blocks<'w, 'b, M> {
        Blocks {
            rods: self.rods,
            status: &mut *self.status,
            wanted: &mut *self.wanted,
            task,
            limits: self.gpr.checks_limits().then(|| Within::of(self.gpr)),
            model: PhantomData,
            method: Chosen(self.polynomials),
        }
    }

    /// Poses that a kernel has left.
    fn the_rest(&mut self) -> Result<(), Error> {
        if self.polynomials.is_some() {
            self.without_polynomials()
        } else {
            self.by_scalar_kernel()
        }
    }

    /// Poses that the polynomials have left, by the solver of the options.
    fn without_polynomials(&mut self) -> Result<(), Error> {
        let mut done = 0;
        while done < self.status.len() {
            let mut group = Group::new();
            while done < self.status.len() && group.count < TOGETHER {
                if self.status[done] != Status::Solved {
                    group.add(done, [0, 1, 2].map(|k| self.rods[k].at(done)));
                }
                done += 1;
            }
            group.compute(self)?;
        }
        Ok(())
    }

    /// Poses that a kernel has left, by the scalar kernel.
    fn by_scalar_kernel(&mut self) -> Result<(), Error> {
        for i in 0..self.status.len() {
            if self.status[i] != Status::Solved {
                self.one_by_one(i..i + 1)?;
            }
        }
        Ok(())
    }

    /// Poses by the scalar kernel, which also finds the reason where there is no answer.
    fn one_by_one(&mut self, poses: std::ops::Range<usize>) -> Result<(), Error> {
        for i in poses {
            let rods = [0, 1, 2].map(|k| self.rods[k].at(i));
            match self.gpr.forward(rods, self.virtualization, self.options) {
                Ok(pose) => {
                    self.status[i] = Status::Solved;
                    for (quantity, column) in &mut *self.wanted {
                        column[i] = value(self.gpr, &pose, self.virtualization, *quantity)?;
                    }
                }
                Err(error) => {
                    self.status[i] = Status::from_error(&error).ok_or(error)?;
                    for (_, column) in &mut *self.wanted {
                        column[i] = f64::NAN;
                    }
                }
            }
        }
        Ok(())
    }
}

/// A method of the model, with which it is compiled.
trait ByBlocks: Model {
    /// The poses with these instructions, then those that the kernel has left.
    fn by_blocks(work: &mut Work<'_, '_>, task: Task<'_>, arch: Arch) -> Result<(), Error> {
        let doubtful = arch.dispatch(work.blocks::<Self>(task));
        if doubtful { work.the_rest() } else { Ok(()) }
    }
}

impl<M: Model> ByBlocks for M {}

/// Poses of a group.
const TOGETHER: usize = 64;

/// Poses that are anywhere in the columns.
struct Group {
    count: usize,
    poses: [usize; TOGETHER],
    rods: [[f64; TOGETHER]; 3],
}

impl Group {
    fn new() -> Self {
        Self { count: 0, poses: [0; TOGETHER], rods: [[0.0; TOGETHER]; 3] }
    }

    fn add(&mut self, pose: usize, rods: [f64; 3]) {
        self.poses[self.count] = pose;
        for (column, rod) in self.rods.iter_mut().zip(rods) {
            column[self.count] = rod;
        }
        self.count += 1;
    }

    /// Computes the poses without polynomials, and writes them to their places.
    fn compute(&self, work: &mut Work<'_, '_>) -> Result<(), Error> {
        let mut status = [Status::Solved; TOGETHER];
        let mut values = [[0.0; TOGETHER]; PLACES];
        // A column for each quantity, however often it is wanted.
        let mut quantities = [None; PLACES];
        for (quantity, _) in &*work.wanted {
            quantities[place(*quantity)] = Some(*quantity);
        }
        let mut count = 0;
        let mut columns = values.iter_mut().zip(quantities);
        let mut wanted: [_; PLACES] = std::array::from_fn(|_| {
            let next = columns.find_map(|(column, quantity)| Some((quantity?, column)));
            count += usize::from(next.is_some());
            let (quantity, column) =
                next.map_or((Quantity::Residual, &mut [][..]), |(q, c)| (q, &mut c[..self.count]));
            (quantity, column)
        });
        Work {
            rods: self.rods.each_ref().map(|column| Column::from(&column[..self.count])),
            polynomials: None,
            status: &mut status[..self.count],
            wanted: &mut wanted[..count],
            ..*work
        }
        .compute()?;
        for (k, &pose) in self.poses[..self.count].iter().enumerate() {
            work.status[pose] = status[k];
            for (quantity, column) in &mut *work.wanted {
                column[pose] = values[place(*quantity)][k];
            }
        }
        Ok(())
    }
}

/// A quantity of one pose.
pub(super) fn value(
    gpr: &Gpr,
    pose: &PlatformPose,
    virtualization: &dyn Virtualization,
    quantity: Quantity,
) -> Result<f64, Error> {
    Ok(match quantity {
        Quantity::Side(side) => pose.sides[side],
        Quantity::VirtualJoint(joint) => pose.solution.virtual_joints[joint],
        Quantity::VirtualDisplacement(joint) => {
            gpr.virtual_displacements(pose, virtualization)[joint]
        }
        Quantity::Origin(axis) => pose.base_from_platform.translation.vector[axis],
        Quantity::Normal(axis) => pose.normal()[axis],
        Quantity::Rotation(row, column) => pose.base_from_platform.rotation[(row, column)],
        Quantity::Azimuth => pose.tilt().azimuth,
        Quantity::TiltAngle => pose.tilt().angle,
        Quantity::Torsion => pose.torsion(),
        Quantity::AxisHeight => pose.axis_height().0,
        Quantity::Displacement => gpr.displacement(pose, virtualization),
        Quantity::BallDisplacement(ball) => gpr.ball_displacements(pose, virtualization)[ball],
        Quantity::Sensitivity(index) => {
            let system = gpr.system(virtualization);
            let at = system.configuration(pose);
            let rho = pose.solution.characteristic_length;
            sensitivity(&system, &at, rho, RANK_THRESHOLD)?.singular_values()[index]
        }
        Quantity::Residual => pose.solution.residual,
        // A whole number of iterations far below 2⁵³.
        Quantity::Iterations => pose.solution.iterations as f64,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bulk::PoseSolver;
    use crate::bulk::instruction_set::instruction_sets;
    use crate::gpr::AxisHeight;
    use crate::spatial::Tilt;
    use crate::virtualization::built_in;

    const POSES: usize = 67;

    /// What is computed with all instruction sets.
    type Given<'g> = (
        &'g (dyn Virtualization + Sync),
        &'g [Vec<f64>; 3],
        &'g SolveOptions,
        Option<&'g JointPolynomials>,
    );
    /// Bits of all quantities of a virtualization, computed with one instruction set, with the statuses.
    ///
    /// Where few quantities are wanted, another loop has the same bits.
    fn with<M: Model>(arch: Arch, gpr: &Gpr, given: Given<'_>) -> (Vec<Vec<u64>>, Vec<Status>) {
        let joints = given.0.joints().len();
        let mut quantities: Vec<_> = (0..joints).map(Quantity::VirtualJoint).collect();
        quantities.push(Quantity::Residual);
        let of_joints = quantities.len();
        quantities.extend((0..3).map(Quantity::Origin).chain((0..3).map(Quantity::Normal)));
        quantities.push(Quantity::Torsion);
        let of_platform = quantities.len();
        // Sensitivities are in the kernels too; the scalar kernel leaves them to a matrix library, which uses the processor as it likes.
        quantities.extend((0..3).flat_map(|k| [Quantity::Side(k), Quantity::BallDisplacement(k)]));
        quantities.extend((0..joints).map(Quantity::VirtualDisplacement));
        quantities.extend((0..9).map(|k| Quantity::Rotation(k / 3, k % 3)));
        quantities.extend([Quantity::Azimuth, Quantity::TiltAngle, Quantity::AxisHeight]);
        quantities.extend([Quantity::Displacement, Quantity::Iterations]);
        let all = bits::<M>(arch, gpr, given, &quantities);
        for few in [of_joints, of_platform] {
            let (columns, status) = bits::<M>(arch, gpr, given, &quantities[..few]);
            assert!(columns == all.0[..few] && status == all.1, "{few} columns");
        }
        all
    }

    fn bits<M: Model>(
        arch: Arch,
        gpr: &Gpr,
        (virtualization, rods, options, polynomials): Given<'_>,
        quantities: &[Quantity],
    ) -> (Vec<Vec<u64>>, Vec<Status>) {
        let count = rods[0].len();
        let mut columns = vec![vec![0.0; count]; quantities.len()];
        let mut wanted: Vec<_> = quantities
            .iter()
            .zip(&mut columns)
            .map(|(quantity, column)| (*quantity, &mut column[..]))
            .collect();
        let mut status = vec![Status::TurnedOver; count];
        let mut work = Work {
            gpr,
            rods: rods.each_ref().map(|column| Column::from(&column[..])),
            virtualization,
            options,
            first_step: None,
            polynomials,
            status: &mut status,
            wanted: &mut wanted,
        };
        let length = options.metric.characteristic_length(gpr.platform()).unwrap();
        let first_step = FirstStep::new(gpr.platform(), virtualization, length);
        let task = Task::new::<M>(gpr.dimensions(), options, length);
        let task = Task { first_step: first_step.as_ref(), ..task };
        M::by_blocks(&mut work, task, arch).unwrap();
        let bits = |column: &Vec<f64>| {
            // The bits of what is no number have no meaning.
            column.iter().map(|v| if v.is_nan() { u64::MAX } else { v.to_bits() }).collect()
        };
        (columns.iter().map(bits).collect(), status)
    }

    /// Rods of tilts from level to beyond what has a pose, with a few that have none.
    fn rods(gpr: &Gpr) -> [Vec<f64>; 3] {
        let mut rods = [const { Vec::new() }; 3];
        for i in 0..POSES {
            let tilt = Tilt { azimuth: i as f64 * 0.7, angle: i as f64 * 0.004 };
            let found = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
            rods.iter_mut().zip(found).for_each(|(column, rod)| column.push(rod));
        }
        for odd in
            [[0.1, 0.9, 0.5], [f64::NAN, 0.5, 0.5], [0.5; 3], [1e9, 0.0, 0.5], [0.4, 0.6, 0.5]]
        {
            rods.iter_mut().zip(odd).for_each(|(column, rod)| column.push(rod));
        }
        rods
    }

    fn check_all_widths<M: Model>(built_in: BuiltIn) {
        let gpr = Gpr::paper().without_limit_checks();
        let rods = rods(&gpr);
        let virtualization = built_in.model();
        for solver in [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm] {
            let options = &SolveOptions { solver, ..SolveOptions::default() };
            let prepared = PoseSolver::new(&gpr, built_in, options).unwrap();
            assert_eq!(prepared.polynomials.is_some(), M::SETTLES);
            for polynomials in [None, prepared.polynomials.as_ref()] {
                let given = (virtualization, &rods, options, polynomials);
                let by = |arch| with::<M>(arch, &gpr, given);
                let one_lane = by(Arch::Scalar);
                let solved = one_lane.1.iter().filter(|status| **status == Status::Solved).count();
                assert!((POSES / 2..POSES + 5).contains(&solved), "{solved}");
                let name = virtualization.name();
                for (instructions, arch) in instruction_sets() {
                    assert!(by(arch) == one_lane, "{instructions}, {name}, {solver}");
                }
            }
        }
    }

    /// Studies are computed in parts on processors of different kinds.
    #[test]
    fn all_register_widths_give_the_same_bits() {
        check_all_widths::<Radial>(BuiltIn::Radial);
        check_all_widths::<Polar>(BuiltIn::Polar);
        check_all_widths::<Offset>(BuiltIn::Offset);
        check_all_widths::<Planar>(BuiltIn::Planar);
    }

    #[test]
    fn every_quantity_has_a_place_of_its_own() {
        let three = [
            Quantity::Side,
            Quantity::Origin,
            Quantity::Normal,
            Quantity::Sensitivity,
            Quantity::BallDisplacement,
        ];
        let mut places: Vec<_> = three.iter().flat_map(|of| (0..3).map(|k| place(of(k)))).collect();
        places.extend((0..6).map(|joint| place(Quantity::VirtualJoint(joint))));
        places.extend((0..6).map(|joint| place(Quantity::VirtualDisplacement(joint))));
        places.extend((0..9).map(|k| place(Quantity::Rotation(k / 3, k % 3))));
        places.extend([Quantity::Azimuth, Quantity::TiltAngle, Quantity::Torsion].map(place));
        places.extend([Quantity::AxisHeight, Quantity::Displacement].map(place));
        places.extend([Quantity::Residual, Quantity::Iterations].map(place));
        places.sort_unstable();
        assert_eq!(places, (0..PLACES).collect::<Vec<_>>());
        assert!(built_in().iter().all(|model| model.joints().len() <= 6));
    }
}
