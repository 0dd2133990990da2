//! Poses in blocks of as many as the machine computes side by side.

use std::marker::PhantomData;

use pulp::{Simd, WithSimd};

use super::results::{
    Anything, Block, Extent, Joints, Needs, OfPlatform, PLACES, Results, place, repeat,
};
use super::{Column, Quantity, Status, singular_values};
use crate::gpr::{Gpr, Limits};
use crate::kernel::{
    self, Ahead, Balls, ByPolynomials, Chosen, ClosedForm, Found, Lanes, Mask, Method, Model,
    Order, PlatformPoses, Shape, Task, Three,
};
use crate::virtualization::{Solver, signed_area};

/// The work cut into blocks.
pub(super) struct Blocks<'w, 'b, M> {
    pub(super) rods: [Column<'w>; 3],
    pub(super) status: &'w mut [Status],
    pub(super) wanted: &'w mut [(Quantity, &'b mut [f64])],
    pub(super) task: Task<'w>,
    /// `None` where limits are not checked.
    pub(super) limits: Option<Within>,
    pub(super) model: PhantomData<M>,
    pub(super) method: Chosen<'w>,
}

/// Limits as a kernel checks them: poses within these are within the limits; of others the scalar kernel decides.
#[derive(Clone, Copy)]
pub(super) struct Within {
    rod_min: f64,
    rod_max: f64,
    /// Square of the largest horizontal part of the plane's normal, of the length of twice the triangle's area in the base (m⁴).
    horizontal_squared: f64,
}

impl Within {
    pub(super) fn of(gpr: &Gpr) -> Self {
        let Limits { rod_min, rod_max, .. } = *gpr.limits();
        let horizontal = signed_area(gpr.base_points()) * gpr.steepest();
        Self { rod_min, rod_max, horizontal_squared: horizontal * horizontal }
    }

    #[inline(always)]
    fn holds<S: Simd>(&self, rods: &Three<S>, balls: &Balls<S>) -> Mask<S> {
        // A rod that is not a number may pass; its pose is found by [`Balls::moderate`].
        let ([q_1, q_2, q_3], any) = (*rods, rods[0]);
        balls.plane.horizontal_squared().at_most(any.like(self.horizontal_squared))
            & any.like(self.rod_min).at_most(q_1.min(q_2).min(q_3))
            & q_1.max(q_2).max(q_3).at_most(any.like(self.rod_max))
    }
}

impl<M: Model> WithSimd for Blocks<'_, '_, M> {
    /// Whether poses remain without an answer; their status is another than solved.
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> bool {
        let needs = Needs::of(self.wanted);
        // Where a pose takes steps, or instructions are few, the loop for anything is as fast.
        let few = Lanes::<S>::COUNT > 2 && (needs.only_joints || needs.only_platform);
        let Chosen(polynomials) = self.method;
        match (polynomials, self.task.solver) {
            (Some(polynomials), _) if few && M::SETTLES => match polynomials.order() {
                Order::Three => self.few(simd, &needs, ByPolynomials::<3>(polynomials)),
                Order::Four => self.few(simd, &needs, ByPolynomials::<4>(polynomials)),
            },
            (None, Solver::ClosedForm) if few && M::CLOSED_FORM => {
                self.few(simd, &needs, ClosedForm)
            }
            (polynomials, _) => self.all::<S, _, Anything>(simd, &needs, Chosen(polynomials)),
        }
    }
}

impl<M: Model> Blocks<'_, '_, M> {
    /// Computes virtual joints and platforms, and nothing else.
    #[inline(always)]
    fn few<S: Simd, W: Method>(self, simd: S, needs: &Needs, method: W) -> bool {
        if needs.only_joints {
            self.all::<S, W, Joints>(simd, needs, method)
        } else {
            self.all::<S, W, OfPlatform>(simd, needs, method)
        }
    }

    /// Computes all poses; whether some remain without an answer.
    #[inline(always)]
    fn all<S: Simd, W: Method, E: Extent>(self, simd: S, needs: &Needs, method: W) -> bool {
        simd.vectorize(
            #[inline(always)]
            || self.each::<S, W, E>(simd, needs, method),
        )
    }

    #[inline(always)]
    fn each<S: Simd, W: Method, E: Extent>(self, simd: S, needs: &Needs, method: W) -> bool {
        let Self { rods: columns, status, wanted, task, limits, .. } = self;
        let count = Lanes::<S>::COUNT;
        let poses = status.len();
        let (whole, blocks) = (poses / count, poses.div_ceil(count));
        let given = columns.map(|column| column.blocks(simd));
        let [q_1, q_2, q_3] = &given;
        let contiguous = q_1.contiguous() & q_2.contiguous() & q_3.contiguous();
        let together = if contiguous { whole.max(1) } else { COPIED };
        let mut copies = [[simd.splat_f64s(0.0); COPIED]; 3];
        let mut rest = [simd.splat_f64s(0.0); PLACES];
        let mut doubtful = false;
        status.fill(Status::Solved);
        for part in [0..whole, whole..blocks] {
            // Whole blocks are written to the columns, the rest is copied to them afterwards.
            let written_from = part.start;
            let mut results =
                if part.end == whole { Results::<S>::new(wanted) } else { Results::one(&mut rest) };
            let mut from = part.start;
            while from < part.end {
                let some = from..part.end.min(from + together);
                let length = some.len();
                let [c_1, c_2, c_3] = &mut copies;
                let rods = [
                    &q_1.some(simd, some.clone(), c_1)[..length],
                    &q_2.some(simd, some.clone(), c_2)[..length],
                    &q_3.some(simd, some, c_3)[..length],
                ];
                let mut sequence = Sequence::<S, M, W, E>::new(simd, &task, &method, rods);
                for block in 0..length {
                    let (rods, balls, ahead) = sequence.current(block);
                    let found = method.found::<S, M>(&task, &balls, ahead);
                    let mut written = results.block(from + block - written_from);
                    let certain =
                        fill::<S, M, W, E>(&mut written, needs, &method, &task, &balls, &found);
                    let mut solved = certain & balls.moderate(&rods);
                    if let Some(limits) = &limits {
                        solved = solved & limits.holds(&rods, &balls);
                    }
                    if !solved.all() {
                        doubtful = true;
                        let answers = &solved.answers()[..count];
                        let first = (from + block) * count;
                        Status::mark(&mut status[first..], answers, Status::NotConverged);
                    }
                    sequence.advance(block);
                }
                from += length;
            }
        }
        repeat(wanted, whole * count);
        for (quantity, column) in &mut *wanted {
            let register = rest[place(*quantity)];
            Lanes::from_register(simd, register).store(column, whole * count);
        }
        doubtful
    }
}

/// Blocks that are copied together from columns that are not contiguous.
const COPIED: usize = 16;

/// Consecutive blocks, with roots and quotients computed ahead.
///
/// A processor executes instructions out of order, but its window holds less than two blocks of joints, so that it waits for the roots of each.
/// [`Method::ahead`] is therefore computed two blocks ahead, and areas of triangles three.
/// A block of platforms takes longer than its roots, and has no registers left: one block less ahead.
struct Sequence<'l, S: Simd, M, W, E> {
    simd: S,
    task: &'l Task<'l>,
    method: &'l W,
    rods: [&'l [S::f64s]; 3],
    /// Balls of this block and of the next two; of platforms, of the next one.
    balls: [Balls<S>; 3],
    /// What was computed ahead of this block and of the next one; of platforms, of this one.
    aheads: [Ahead<S>; 2],
    model: PhantomData<(M, E)>,
}

impl<'l, S: Simd, M: Model, W: Method, E: Extent> Sequence<'l, S, M, W, E> {
    #[inline(always)]
    fn new(simd: S, task: &'l Task<'l>, method: &'l W, rods: [&'l [S::f64s]; 3]) -> Self {
        let first = Balls::new(task.geometry, rods_at(simd, &rods, 0));
        let second = Balls::new(task.geometry, rods_at(simd, &rods, 1));
        let third = Balls::new(task.geometry, rods_at(simd, &rods, 2));
        let aheads = [method.ahead::<S, M>(task, &first), method.ahead::<S, M>(task, &second)];
        let balls = [first, second, third];
        Self { simd, task, method, rods, balls, aheads, model: PhantomData }
    }

    /// Rods, balls and what was computed ahead of a block, after [`Self::advance`] for each block before.
    #[inline(always)]
    fn current(&self, block: usize) -> (Three<S>, Balls<S>, Ahead<S>) {
        let rods = rods_at(self.simd, &self.rods, block);
        let balls = if W::AHEAD { self.balls[0] } else { Balls::new(self.task.geometry, rods) };
        (rods, balls, self.aheads[0])
    }

    /// Computes ahead for the blocks after this one, at its end: the compiler moves roots there anyway, and would store their operands until then.
    #[inline(always)]
    fn advance(&mut self, block: usize) {
        if !W::AHEAD {
            return;
        }
        let [_, next, after] = self.balls;
        let balls = |block| Balls::new(self.task.geometry, rods_at(self.simd, &self.rods, block));
        if E::PLATFORM {
            let ahead = self.method.ahead::<S, M>(self.task, &next);
            (self.balls, self.aheads) = ([next, balls(block + 2), after], [ahead; 2]);
        } else {
            let ahead = self.method.ahead::<S, M>(self.task, &after);
            self.balls = [next, after, balls(block + 3)];
            self.aheads = [self.aheads[1], ahead];
        }
    }
}

/// The rods of a block, or of the last one beyond the end.
#[inline(always)]
fn rods_at<S: Simd>(simd: S, [q_1, q_2, q_3]: &[&[S::f64s]; 3], block: usize) -> Three<S> {
    let block = block.min(q_1.len() - 1);
    [
        Lanes::from_register(simd, q_1[block]),
        Lanes::from_register(simd, q_2[block]),
        Lanes::from_register(simd, q_3[block]),
    ]
}

/// Writes the values that are needed, each what [`value`](super::forward::value) is for one pose; returns the lanes that are met and whose values are valid.
#[inline(always)]
fn fill<S: Simd, M: Model, W: Method, E: Extent>(
    results: &mut Block<'_, '_, S>,
    needs: &Needs,
    method: &W,
    task: &Task<'_>,
    balls: &Balls<S>,
    found: &Found<S>,
) -> Mask<S> {
    let zero = balls.mean.like(0.0);
    let mut certain = found.met;
    if E::ANYTHING && needs.iterations {
        results.put(Quantity::Iterations, found.iterations);
    }
    for k in 0..3 {
        results.put(Quantity::VirtualJoint(k), found.a[k]);
        if M::ACROSS {
            results.put(Quantity::VirtualJoint(3 + k), found.b[k]);
        }
    }
    if E::ANYTHING && needs.virtual_displacements {
        let start = task.geometry.start::<M>();
        for (k, start) in start.into_iter().enumerate() {
            results.put(Quantity::VirtualDisplacement(k), found.a[k] - start);
            results.put(Quantity::VirtualDisplacement(3 + k), found.b[k]);
        }
    }
    if E::ANYTHING && needs.sides {
        for k in 0..3 {
            results.put(Quantity::Side(k), balls.squares[k].sqrt());
        }
    }
    if E::ANYTHING && needs.displacement {
        results.put(Quantity::Displacement, displacement::<S, M>(task, found));
    }
    if E::ANYTHING && needs.ball_displacements {
        let shape = Shape::at::<M>(task.geometry, found.a, found.b);
        for (k, displacement) in shape.ball_displacements(task.geometry).into_iter().enumerate() {
            results.put(Quantity::BallDisplacement(k), displacement);
        }
    }
    if needs.residual {
        results.put(Quantity::Residual, found.residual(task.geometry, balls));
    }
    if E::PLATFORM && needs.pose {
        let placed = method.placed::<S, M>(task.geometry, balls, found);
        for axis in 0..3 {
            results.put(Quantity::Origin(axis), placed.origin[axis]);
            results.put(Quantity::Normal(axis), placed.normal[axis]);
        }
        if needs.torsion {
            results.put(Quantity::Torsion, placed.torsion());
        }
        if E::ANYTHING && needs.rotation {
            let results = &mut *results;
            zero.outlined(
                #[inline(always)]
                move || {
                    for (column, axis) in placed.axes().into_iter().enumerate() {
                        for (row, entry) in axis.into_iter().enumerate() {
                            results.put(Quantity::Rotation(row, column), entry);
                        }
                    }
                },
            );
        }
        if E::ANYTHING && needs.coordinates {
            let results = &mut *results;
            zero.outlined(
                #[inline(always)]
                move || fill_coordinates(results, needs, &placed),
            );
        }
    }
    if E::ANYTHING && needs.sensitivity {
        let (balls, a, b) = (*balls, found.a, found.b);
        let (singular_values, orthogonal) = zero.outlined(
            #[inline(always)]
            move || {
                let shape = Shape::at::<M>(task.geometry, a, b);
                singular_values::sensitivity::<S, M>(task, &balls, &shape)
            },
        );
        for (index, value) in singular_values.into_iter().enumerate() {
            results.put(Quantity::Sensitivity(index), value);
        }
        certain = certain & orthogonal;
    }
    certain
}

/// Angles of the tilt, and the height.
#[inline(always)]
fn fill_coordinates<S: Simd>(
    results: &mut Block<'_, '_, S>,
    needs: &Needs,
    placed: &PlatformPoses<S>,
) {
    if needs.azimuth {
        results.put(Quantity::Azimuth, placed.azimuth());
    }
    if needs.tilt_angle {
        results.put(Quantity::TiltAngle, placed.tilt_angle());
    }
    if needs.axis_height {
        results.put(Quantity::AxisHeight, placed.axis_height());
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
