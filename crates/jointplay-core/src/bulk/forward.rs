//! From many rods to the poses of the platform.

use std::marker::PhantomData;

use pulp::{Arch, Simd, WithSimd};

use super::singular_values;
use super::{Column, Quantity, Status, StatusCounts};
use crate::Error;
use crate::gpr::{Gpr, Limits, PlatformPose};
use crate::kernel::{
    self, Balls, ByPolynomials, ClosedForm, FirstStep, Found, Geometry, JointPolynomials, Lanes,
    LeastNorm, Mask, Method, Model, Newton, Offset, Order, Planar, Plane, PlatformPoses, Polar,
    Radial, Shape, Task, Three,
};
use crate::mobility::RANK_THRESHOLD;
use crate::sensitivity::sensitivity;
use crate::virtualization::{BuiltIn, SolveOptions, Solver, Virtualization, signed_area};

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

impl Work<'_, '_> {
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
                let polynomials = self.polynomials;
                let task = Task { first_step: Some(first_step), polynomials, ..task };
                // What a model never asks for is not compiled for it.
                match (task.solver, polynomials.map(JointPolynomials::order)) {
                    (Solver::Newton, _) => self.by_method::<M, Newton>(task),
                    (Solver::ClosedForm, _) if M::CLOSED_FORM => {
                        self.by_method::<M, ClosedForm>(task)
                    }
                    (_, Some(Order::Three)) if M::SETTLES => {
                        self.by_method::<M, ByPolynomials<3>>(task)
                    }
                    (_, Some(Order::Four)) if M::SETTLES => {
                        self.by_method::<M, ByPolynomials<4>>(task)
                    }
                    _ => self.by_method::<M, LeastNorm>(task),
                }
            }
            _ => self.one_by_one(0..self.status.len()),
        }
    }

    fn by_method<M: Model, W: Method>(&mut self, task: Task<'_>) -> Result<(), Error> {
        let limits = self.gpr.checks_limits().then(|| Within::of(self.gpr));
        let kernel = PhantomData::<(M, W)>;
        let doubtful = Arch::new().dispatch(Blocks { work: &mut *self, task, limits, kernel });
        if doubtful { self.by_scalar_kernel() } else { Ok(()) }
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

/// The work cut into blocks of as many poses as the machine computes side by side.
struct Blocks<'w, 'a, 'b, M, W> {
    work: &'w mut Work<'a, 'b>,
    task: Task<'w>,
    /// `None` where limits are not checked.
    limits: Option<Within>,
    kernel: PhantomData<(M, W)>,
}

/// Limits as a kernel checks them: poses within these are within the limits; of others the scalar kernel decides.
#[derive(Clone, Copy)]
struct Within {
    rod_min: f64,
    rod_max: f64,
    /// Square of the largest horizontal part of the plane's normal, of the length of twice the triangle's area in the base (m⁴).
    horizontal_squared: f64,
}

impl Within {
    fn of(gpr: &Gpr) -> Self {
        let Limits { rod_min, rod_max, .. } = *gpr.limits();
        let horizontal = signed_area(gpr.base_points()) * gpr.steepest();
        Self { rod_min, rod_max, horizontal_squared: horizontal * horizontal }
    }

    #[inline(always)]
    fn holds<S: Simd>(&self, geometry: &Geometry, rods: &Three<S>, balls: &Balls<S>) -> Mask<S> {
        let horizontal = Plane::new(geometry, balls).horizontal_squared();
        let (least, most) = (horizontal.like(self.rod_min), horizontal.like(self.rod_max));
        let mut within = horizontal.at_most(horizontal.like(self.horizontal_squared));
        for rod in rods {
            within = within & least.at_most(*rod) & rod.at_most(most);
        }
        within
    }
}

/// Place of a quantity, and its column as registers with the rest behind them.
type Registers<'c, S> = (usize, &'c mut [<S as Simd>::f64s], &'c mut [f64]);

impl<M: Model, W: Method> WithSimd for Blocks<'_, '_, '_, M, W> {
    /// Whether poses remain for the scalar kernel; their status is another than solved.
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let Self { work, task, limits, .. } = self;
        let geometry = task.geometry;
        let poses = work.status.len();
        let whole = poses / Lanes::<S>::COUNT;
        let needs = Needs::of(work.wanted);
        let mut values = [Lanes::splat(simd, 0.0); PLACES];
        // Columns as registers, so that a whole block is written without a check of its end.
        let mut columns: [Registers<'_, S>; PLACES] =
            std::array::from_fn(|_| (0, &mut [][..], &mut [][..]));
        let count = work.wanted.len().min(PLACES);
        let (direct, others) = work.wanted.split_at_mut(count);
        for ((quantity, wanted), column) in direct.iter_mut().zip(&mut columns) {
            let (registers, rest) = S::as_mut_simd_f64s(wanted);
            *column = (place(*quantity), registers, rest);
        }
        let columns = &mut columns[..count];
        let mut doubtful = false;
        work.status.fill(Status::Solved);
        for block in 0..poses.div_ceil(Lanes::<S>::COUNT) {
            let first = block * Lanes::<S>::COUNT;
            let rods = [
                work.rods[0].lanes(simd, first),
                work.rods[1].lanes(simd, first),
                work.rods[2].lanes(simd, first),
            ];
            let balls = Balls::new(geometry, rods);
            let found = W::found::<S, M>(&task, &balls);
            let upright = balls.mean.like(0.0).below(found.area * geometry.base_area);
            let certain = fill::<S, M>(&mut values, &needs, &task, &balls, &found);
            let mut solved = found.met & upright & certain & balls.moderate(&rods);
            if let Some(limits) = &limits {
                solved = solved & limits.holds(geometry, &rods, &balls);
            }
            if block < whole {
                for (place, registers, _) in &mut *columns {
                    registers[block] = values[*place].register();
                }
            } else {
                for (place, _, rest) in &mut *columns {
                    values[*place].store(rest, 0);
                }
            }
            for (quantity, column) in &mut *others {
                values[place(*quantity)].store(column, first);
            }
            if !solved.all() {
                doubtful = true;
                let lanes = Lanes::<S>::COUNT.min(poses - first);
                for (lane, solved) in solved.answers()[..lanes].iter().enumerate() {
                    if !solved {
                        work.status[first + lane] = Status::NotConverged;
                    }
                }
            }
        }
        doubtful
    }
}

/// Groups of quantities that are requested; no others are computed.
struct Needs {
    sides: bool,
    displacement: bool,
    virtual_displacements: bool,
    ball_displacements: bool,
    residual: bool,
    iterations: bool,
    pose: bool,
    rotation: bool,
    /// Angles of the tilt, or the height.
    coordinates: bool,
    azimuth: bool,
    tilt_angle: bool,
    torsion: bool,
    axis_height: bool,
    sensitivity: bool,
}

impl Needs {
    fn of(wanted: &[(Quantity, &mut [f64])]) -> Self {
        let any = |asked: fn(Quantity) -> bool| wanted.iter().any(|(quantity, _)| asked(*quantity));
        let azimuth = any(|q| q == Quantity::Azimuth);
        let tilt_angle = any(|q| q == Quantity::TiltAngle);
        let torsion = any(|q| q == Quantity::Torsion);
        let axis_height = any(|q| q == Quantity::AxisHeight);
        let pose = any(|q| matches!(q, Quantity::Origin(_) | Quantity::Normal(_)));
        let rotation = any(|q| matches!(q, Quantity::Rotation(..)));
        let coordinates = azimuth || tilt_angle || axis_height;
        Self {
            sides: any(|q| matches!(q, Quantity::Side(_))),
            displacement: any(|q| q == Quantity::Displacement),
            virtual_displacements: any(|q| matches!(q, Quantity::VirtualDisplacement(_))),
            ball_displacements: any(|q| matches!(q, Quantity::BallDisplacement(_))),
            residual: any(|q| q == Quantity::Residual),
            iterations: any(|q| q == Quantity::Iterations),
            pose: pose || coordinates || torsion || rotation,
            rotation,
            coordinates,
            azimuth,
            tilt_angle,
            torsion,
            axis_height,
            sensitivity: any(|q| matches!(q, Quantity::Sensitivity(_))),
        }
    }
}

/// Places for the values of all quantities.
const PLACES: usize = 43;

/// Index of the value of a quantity among those of a block.
#[inline]
fn place(quantity: Quantity) -> usize {
    match quantity {
        Quantity::VirtualJoint(joint) => joint,
        Quantity::Side(side) => 6 + side,
        Quantity::Origin(axis) => 9 + axis,
        Quantity::Normal(axis) => 12 + axis,
        Quantity::Sensitivity(index) => 15 + index,
        Quantity::Azimuth => 18,
        Quantity::TiltAngle => 19,
        Quantity::Torsion => 20,
        Quantity::AxisHeight => 21,
        Quantity::Displacement => 22,
        Quantity::Residual => 23,
        Quantity::Iterations => 24,
        Quantity::BallDisplacement(ball) => 25 + ball,
        Quantity::VirtualDisplacement(joint) => 28 + joint,
        Quantity::Rotation(row, column) => 34 + 3 * row + column,
    }
}

/// Writes the values that are needed, each what [`value`] is for one pose; returns the lanes whose values are valid.
#[inline(always)]
fn fill<S: Simd, M: Model>(
    values: &mut [Lanes<S>; PLACES],
    needs: &Needs,
    task: &Task<'_>,
    balls: &Balls<S>,
    found: &Found<S>,
) -> Mask<S> {
    let zero = balls.mean.like(0.0);
    let mut certain = zero.at_most(zero);
    if needs.iterations {
        values[place(Quantity::Iterations)] = found.iterations;
    }
    for k in 0..3 {
        values[place(Quantity::VirtualJoint(k))] = found.a[k];
        if M::ACROSS {
            values[place(Quantity::VirtualJoint(3 + k))] = found.b[k];
        }
    }
    if needs.virtual_displacements {
        let start = task.geometry.start::<M>();
        for k in 0..3 {
            values[place(Quantity::VirtualDisplacement(k))] = found.a[k] - start[k];
            values[place(Quantity::VirtualDisplacement(3 + k))] = found.b[k];
        }
    }
    if needs.sides {
        for k in 0..3 {
            values[place(Quantity::Side(k))] = balls.squares[k].sqrt();
        }
    }
    if needs.displacement {
        values[place(Quantity::Displacement)] = displacement::<S, M>(task, found);
    }
    if needs.ball_displacements {
        let shape = Shape::at::<M>(task.geometry, found.a, found.b);
        for (k, displacement) in shape.ball_displacements(task.geometry).into_iter().enumerate() {
            values[place(Quantity::BallDisplacement(k))] = displacement;
        }
    }
    if needs.residual {
        values[place(Quantity::Residual)] = found.residual(task.geometry, balls);
    }
    if needs.pose {
        let shape = Shape::at::<M>(task.geometry, found.a, found.b);
        let plane = Plane::new(task.geometry, balls);
        let placed = PlatformPoses::new(task.geometry, balls, &plane, &shape);
        for axis in 0..3 {
            values[place(Quantity::Origin(axis))] = placed.origin[axis];
            values[place(Quantity::Normal(axis))] = placed.normal[axis];
        }
        if needs.torsion {
            values[place(Quantity::Torsion)] = placed.torsion();
        }
        if needs.rotation {
            let values = &mut *values;
            zero.outlined(
                #[inline(always)]
                move || {
                    for (column, axis) in placed.axes().into_iter().enumerate() {
                        for (row, entry) in axis.into_iter().enumerate() {
                            values[place(Quantity::Rotation(row, column))] = entry;
                        }
                    }
                },
            );
        }
        if needs.coordinates {
            let values = &mut *values;
            zero.outlined(
                #[inline(always)]
                move || fill_coordinates(values, needs, &placed),
            );
        }
    }
    if needs.sensitivity {
        let (balls, a, b) = (*balls, found.a, found.b);
        let (singular_values, orthogonal) = zero.outlined(
            #[inline(always)]
            move || {
                let shape = Shape::at::<M>(task.geometry, a, b);
                singular_values::sensitivity::<S, M>(task, &balls, &shape)
            },
        );
        for (index, value) in singular_values.into_iter().enumerate() {
            values[place(Quantity::Sensitivity(index))] = value;
        }
        certain = orthogonal;
    }
    certain
}

/// Angles of the tilt, and the height.
#[inline(always)]
fn fill_coordinates<S: Simd>(
    values: &mut [Lanes<S>; PLACES],
    needs: &Needs,
    placed: &PlatformPoses<S>,
) {
    if needs.azimuth {
        values[place(Quantity::Azimuth)] = placed.azimuth();
    }
    if needs.tilt_angle {
        values[place(Quantity::TiltAngle)] = placed.tilt_angle();
    }
    if needs.axis_height {
        values[place(Quantity::AxisHeight)] = placed.axis_height();
    }
}

#[inline(always)]
fn displacement<S: Simd, M: Model>(task: &Task<'_>, found: &Found<S>) -> Lanes<S> {
    let mut a = found.a;
    for (a, start) in a.iter_mut().zip(task.geometry.start::<M>()) {
        *a = *a - start;
    }
    kernel::squared::<S, M>(task, &a, &found.b).sqrt()
}

/// A quantity of one pose.
fn value(
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
    use crate::gpr::AxisHeight;
    use crate::spatial::Tilt;
    use crate::virtualization::{self, Solver, built_in};

    const POSES: usize = 67;

    fn vectorized<S: Simd, M: Model, W: Method>(
        simd: S,
        work: &mut Work<'_, '_>,
        task: Task<'_>,
    ) -> bool {
        simd.vectorize(Blocks { work, task, limits: None, kernel: PhantomData::<(M, W)> })
    }

    /// Bits of all quantities of a virtualization, computed with one kind of registers, with the statuses.
    fn with<S: Simd, M: Model>(
        simd: S,
        gpr: &Gpr,
        virtualization: &dyn Virtualization,
        rods: &[Vec<f64>; 3],
        options: &SolveOptions,
    ) -> (Vec<Vec<u64>>, Vec<Status>) {
        // Sensitivities are in the kernels too; the scalar kernel leaves them to a matrix library, which uses the processor as it likes.
        let three =
            [Quantity::Side, Quantity::Origin, Quantity::Normal, Quantity::BallDisplacement];
        let mut quantities: Vec<_> = three.iter().flat_map(|of| (0..3).map(of)).collect();
        let joints = virtualization.joints().len();
        quantities.extend((0..joints).map(Quantity::VirtualJoint));
        quantities.extend((0..joints).map(Quantity::VirtualDisplacement));
        quantities.extend((0..9).map(|k| Quantity::Rotation(k / 3, k % 3)));
        quantities.extend([Quantity::Azimuth, Quantity::TiltAngle, Quantity::Torsion]);
        quantities.extend([Quantity::AxisHeight, Quantity::Displacement, Quantity::Residual]);
        quantities.push(Quantity::Iterations);
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
            polynomials: None,
            status: &mut status,
            wanted: &mut wanted,
        };
        let length = options.metric.characteristic_length(gpr.platform()).unwrap();
        let first_step = FirstStep::new(gpr.platform(), virtualization, length);
        let task = Task::new::<M>(gpr.dimensions(), options, length);
        let task = Task { first_step: first_step.as_ref(), ..task };
        let doubtful = match task.solver {
            Solver::Newton => vectorized::<S, M, Newton>(simd, &mut work, task),
            Solver::LeastNorm => vectorized::<S, M, LeastNorm>(simd, &mut work, task),
            Solver::ClosedForm => vectorized::<S, M, ClosedForm>(simd, &mut work, task),
        };
        if doubtful {
            work.by_scalar_kernel().unwrap();
        }
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

    fn check_all_widths<M: Model>(virtualization: &dyn Virtualization) {
        let gpr = Gpr::paper().without_limit_checks();
        let rods = rods(&gpr);
        for solver in [Solver::Newton, Solver::LeastNorm, Solver::ClosedForm] {
            let options = &SolveOptions { solver, ..SolveOptions::default() };
            let one_lane = with::<_, M>(pulp::Scalar, &gpr, virtualization, &rods, options);
            let solved = one_lane.1.iter().filter(|status| **status == Status::Solved).count();
            assert!((POSES / 2..POSES + 5).contains(&solved), "{solved}");
            let check = |name: &str, lanes: (Vec<Vec<u64>>, Vec<Status>)| {
                assert!(lanes == one_lane, "{name}, {}, {solver}", virtualization.name());
            };
            let two_lanes = pulp::Scalar128b;
            check("two lanes", with::<_, M>(two_lanes, &gpr, virtualization, &rods, options));
            #[cfg(target_arch = "x86_64")]
            {
                use pulp::x86::{V3, V4};
                if let Some(simd) = V3::try_new() {
                    check("AVX2", with::<_, M>(simd, &gpr, virtualization, &rods, options));
                }
                if let Some(simd) = V4::try_new() {
                    check("AVX-512", with::<_, M>(simd, &gpr, virtualization, &rods, options));
                }
            }
        }
    }

    /// Studies are computed in parts on processors of different kinds.
    #[test]
    fn all_register_widths_give_the_same_bits() {
        check_all_widths::<Radial>(&virtualization::Radial);
        check_all_widths::<Polar>(&virtualization::Polar);
        check_all_widths::<Offset>(&virtualization::Offset);
        check_all_widths::<Planar>(&virtualization::Planar);
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
