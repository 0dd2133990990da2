//! Finite mobility of systems small enough to know the answer by thought.

use jointplay_core::constraint::{Configuration, Dimension, System};
use jointplay_core::mobility::{
    BoundOrigin, FiniteMobility, FreeMotions, RANK_THRESHOLD, branch_dimensions, finite_mobility,
};
use nalgebra::{DMatrix, DVector};

/// A polynomial: terms of a factor and an exponent for each unknown.
type Polynomial<'a> = &'a [(f64, &'a [i32])];

/// Polynomials that have to vanish, with the origin as configuration.
struct Polynomials<'a>(usize, &'a [Polynomial<'a>]);

impl Polynomials<'_> {
    /// Sum over the terms of the derivative with respect to the unknowns in `by`.
    fn derivative(polynomial: Polynomial, x: &DVector<f64>, by: &[usize]) -> f64 {
        let value = |&(factor, exponents): &(f64, &[i32])| {
            let mut exponents = exponents.to_vec();
            let mut value = factor;
            for &i in by {
                value *= f64::from(exponents[i]);
                exponents[i] -= 1;
            }
            if value == 0.0 {
                return 0.0;
            }
            exponents.iter().zip(x).fold(value, |product, (&e, &x)| product * x.powi(e))
        };
        polynomial.iter().map(value).sum()
    }
}

impl System for Polynomials<'_> {
    fn constraint_dimensions(&self) -> Vec<Dimension> {
        vec![Dimension::Angle; self.1.len()]
    }
    fn coordinate_dimensions(&self) -> Vec<Dimension> {
        vec![Dimension::Angle; self.0]
    }
    fn virtual_joint_dimensions(&self) -> Vec<Dimension> {
        Vec::new()
    }
    fn characteristic_length(&self) -> f64 {
        1.0
    }
    fn residual(&self, at: &Configuration) -> DVector<f64> {
        DVector::from_fn(self.1.len(), |c, _| Self::derivative(self.1[c], &at.coordinates, &[]))
    }
    fn constraint_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        DMatrix::from_fn(self.1.len(), self.0, |c, i| {
            Self::derivative(self.1[c], &at.coordinates, &[i])
        })
    }
    fn virtual_jacobian(&self, _at: &Configuration) -> DMatrix<f64> {
        DMatrix::zeros(self.1.len(), 0)
    }
    fn second_derivative(&self, at: &Configuration, v: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.1.len(), |c, _| {
            let hessian = DMatrix::from_fn(self.0, self.0, |i, j| {
                Self::derivative(self.1[c], &at.coordinates, &[i, j])
            });
            v.dot(&(hessian * v))
        })
    }
}

/// Bars of fixed length between pins in a plane; the first few pins are fixed (m).
struct Bars {
    fixed: Vec<[f64; 2]>,
    free: Vec<[f64; 2]>,
    bars: Vec<(usize, usize)>,
    /// Pins held on the line through their place in a direction.
    slots: Vec<(usize, [f64; 2])>,
}

impl Bars {
    fn pin(&self, at: &DVector<f64>, i: usize) -> [f64; 2] {
        match i.checked_sub(self.fixed.len()) {
            None => self.fixed[i],
            Some(free) => [at[2 * free], at[2 * free + 1]],
        }
    }
    fn start(&self) -> DVector<f64> {
        DVector::from_iterator(2 * self.free.len(), self.free.iter().flatten().copied())
    }
    fn squared(&self, at: &DVector<f64>, (i, j): (usize, usize)) -> f64 {
        let (a, b) = (self.pin(at, i), self.pin(at, j));
        (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)
    }
}

impl System for Bars {
    fn constraint_dimensions(&self) -> Vec<Dimension> {
        let mut dimensions = vec![Dimension::SquaredLength; self.bars.len()];
        dimensions.extend(vec![Dimension::Length; self.slots.len()]);
        dimensions
    }
    fn coordinate_dimensions(&self) -> Vec<Dimension> {
        vec![Dimension::Length; 2 * self.free.len()]
    }
    fn virtual_joint_dimensions(&self) -> Vec<Dimension> {
        Vec::new()
    }
    fn characteristic_length(&self) -> f64 {
        1.0
    }
    fn residual(&self, at: &Configuration) -> DVector<f64> {
        let start = self.start();
        let bars = self
            .bars
            .iter()
            .map(|&bar| self.squared(&at.coordinates, bar) - self.squared(&start, bar));
        let slots = self.slots.iter().map(|&(pin, [x, y])| {
            let (now, then) = (self.pin(&at.coordinates, pin), self.pin(&start, pin));
            -(now[0] - then[0]) * y + (now[1] - then[1]) * x
        });
        DVector::from_vec(bars.chain(slots).collect())
    }
    fn constraint_jacobian(&self, at: &Configuration) -> DMatrix<f64> {
        let mut jacobian = DMatrix::zeros(self.bars.len() + self.slots.len(), 2 * self.free.len());
        let fixed = self.fixed.len();
        for (row, &(i, j)) in self.bars.iter().enumerate() {
            let (a, b) = (self.pin(&at.coordinates, i), self.pin(&at.coordinates, j));
            for axis in 0..2 {
                let slope = 2.0 * (b[axis] - a[axis]);
                if i >= fixed {
                    jacobian[(row, 2 * (i - fixed) + axis)] = -slope;
                }
                if j >= fixed {
                    jacobian[(row, 2 * (j - fixed) + axis)] = slope;
                }
            }
        }
        for (row, &(pin, [x, y])) in (self.bars.len()..).zip(&self.slots) {
            jacobian[(row, 2 * (pin - fixed))] = -y;
            jacobian[(row, 2 * (pin - fixed) + 1)] = x;
        }
        jacobian
    }
    fn virtual_jacobian(&self, _at: &Configuration) -> DMatrix<f64> {
        DMatrix::zeros(self.bars.len() + self.slots.len(), 0)
    }
    fn second_derivative(&self, _at: &Configuration, v: &DVector<f64>) -> DVector<f64> {
        let velocity = |i: usize| match i.checked_sub(self.fixed.len()) {
            None => [0.0, 0.0],
            Some(free) => [v[2 * free], v[2 * free + 1]],
        };
        let bars = self.bars.iter().map(|&(i, j)| {
            let (a, b) = (velocity(i), velocity(j));
            2.0 * ((b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2))
        });
        DVector::from_vec(bars.chain(self.slots.iter().map(|_| 0.0)).collect())
    }
}

/// Known and expected mobilities.
struct Expect {
    instantaneous: usize,
    /// The true dimension of the configurations near, by thought.
    truth: usize,
    /// The expected result of the analysis: the true dimension, or undecided.
    decided: bool,
}

#[track_caller]
fn check(system: &dyn System, start: DVector<f64>, expect: &Expect) -> FiniteMobility {
    let at = Configuration { coordinates: start, virtual_joints: DVector::zeros(0) };
    let found = finite_mobility(system, &at, RANK_THRESHOLD).unwrap();
    assert_eq!(found.instantaneous.mobility, expect.instantaneous, "{found:#?}");
    assert_eq!(found.mobility, expect.decided.then_some(expect.truth), "{found:#?}");
    assert!(found.lower_bound <= expect.truth && expect.truth <= found.upper_bound, "{found:#?}");
    found
}

#[track_caller]
fn polynomials(
    unknowns: usize,
    polynomials: &[Polynomial],
    instantaneous: usize,
    truth: usize,
    decided: bool,
) -> FiniteMobility {
    check(
        &Polynomials(unknowns, polynomials),
        DVector::zeros(unknowns),
        &Expect { instantaneous, truth, decided },
    )
}

/// The dimensions of the branches at the origin.
#[track_caller]
fn branches(unknowns: usize, polynomials: &[Polynomial], expected: &[usize]) {
    let system = Polynomials(unknowns, polynomials);
    let at =
        Configuration { coordinates: DVector::zeros(unknowns), virtual_joints: DVector::zeros(0) };
    let found = finite_mobility(&system, &at, RANK_THRESHOLD).unwrap();
    assert_eq!(branch_dimensions(&system, &at, &found).unwrap(), expected, "{polynomials:?}");
}

#[track_caller]
fn bars(system: &Bars, instantaneous: usize, truth: usize, decided: bool) -> FiniteMobility {
    check(system, system.start(), &Expect { instantaneous, truth, decided })
}

/// Four bars, opposite ones of equal length; `angle` of the cranks to the base (rad).
fn parallelogram(angle: f64) -> Bars {
    let (sin, cos) = f64::sin_cos(angle);
    Bars {
        fixed: vec![[0.0, 0.0], [2.0, 0.0]],
        free: vec![[cos, sin], [2.0 + cos, sin]],
        bars: vec![(0, 2), (2, 3), (3, 1)],
        slots: vec![],
    }
}

#[test]
fn parallelogram_moves_along_one_branch_at_a_time() {
    for angle in [0.1, 1.0, 2.0] {
        let found = bars(&parallelogram(angle), 1, 1, true);
        assert!(found.second_order.is_none(), "full row rank needs no second order");
    }
    // Flat: the parallelogram and the crossed one meet, two branches, each of one dimension.
    bars(&parallelogram(0.0), 2, 1, true);
}

#[test]
fn three_parallel_cranks_hold_each_other_up_and_move() {
    let mut system = parallelogram(1.0);
    let (sin, cos) = 1.0_f64.sin_cos();
    // A third crank to a pin that two bars fix to the coupler.
    system.fixed.push([1.0, 0.5]);
    system.free.push([1.0 + cos, 0.5 + sin]);
    system.bars = vec![(0, 3), (3, 4), (4, 1), (3, 5), (4, 5), (2, 5)];
    let found = bars(&system, 1, 1, true);
    assert_eq!(found.instantaneous.redundancy, 1);
}

/// A redundant constraint that is open by less than counts cannot be closed by moving; the motion is there all the same.
#[test]
fn loops_closed_only_nearly_move_all_the_same() {
    // x = 0 and x = open, y is free.
    for open in [1e-15, 1e-13, 1e-11] {
        let twice: &[Polynomial] = &[&[(1.0, &[1, 0])], &[(1.0, &[1, 0]), (-open, &[0, 0])]];
        polynomials(2, twice, 1, 1, true);
    }
}

#[test]
fn two_collinear_bars_are_infinitesimally_mobile() {
    let mut system = Bars {
        fixed: vec![[0.0, 0.0], [2.0, 0.0]],
        free: vec![[1.0, 0.0]],
        bars: vec![(0, 2), (1, 2)],
        slots: vec![],
    };
    let found = bars(&system, 1, 0, true);
    assert!(found.second_order.unwrap().definite);
    // A third bar alike makes nothing new of it.
    system.fixed.push([3.0, 0.0]);
    system.bars = vec![(0, 3), (1, 3), (2, 3)];
    bars(&system, 1, 0, true);
    // Out of line they are simply stiff.
    system.free[0] = [1.0, 0.5];
    bars(&system, 0, 0, true);
}

#[test]
fn two_bars_that_fold_together_turn_as_one() {
    let system = Bars {
        fixed: vec![[0.0, 0.0], [0.0, 0.0]],
        free: vec![[0.6, 0.8]],
        bars: vec![(0, 2), (1, 2)],
        slots: vec![],
    };
    let found = bars(&system, 1, 1, true);
    assert_eq!(found.instantaneous.redundancy, 1);
}

#[test]
fn branches_that_cross_or_touch() {
    // A plane and a line: xy = xz = 0.
    polynomials(3, &[&[(1.0, &[1, 1, 0])], &[(1.0, &[1, 0, 1])]], 3, 2, true);
    // Three lines: xy = yz = zx = 0.
    let lines: &[Polynomial] = &[&[(1.0, &[1, 1, 0])], &[(1.0, &[0, 1, 1])], &[(1.0, &[1, 0, 1])]];
    polynomials(3, lines, 3, 1, true);
    // Two parabolas that touch: z = 0 and z = x² − y⁴.
    polynomials(
        3,
        &[&[(1.0, &[0, 0, 1])], &[(1.0, &[0, 0, 1]), (-1.0, &[2, 0, 0]), (1.0, &[0, 4, 0])]],
        2,
        1,
        true,
    );
    // A cusp: z = 0 and z = x² − y³.
    polynomials(
        3,
        &[&[(1.0, &[0, 0, 1])], &[(1.0, &[0, 0, 1]), (-1.0, &[2, 0, 0]), (1.0, &[0, 3, 0])]],
        2,
        1,
        true,
    );
    // A line counted twice: x² = 0.
    polynomials(2, &[&[(1.0, &[2, 0])]], 2, 1, true);
    // A cone and a point: x² + y² = z², x² + y² + z² = 0.
    let squares: Polynomial = &[(1.0, &[2, 0, 0]), (1.0, &[0, 2, 0]), (-1.0, &[0, 0, 2])];
    polynomials(3, &[squares], 3, 2, true);
    let point: Polynomial = &[(1.0, &[2, 0, 0]), (1.0, &[0, 2, 0]), (1.0, &[0, 0, 2])];
    polynomials(3, &[point], 3, 0, true);
}

/// x² + y² is positive across the z axis, so that every curve through the origin is tangent to it; the configurations have two dimensions all the same.
#[test]
fn a_definite_quadric_does_not_bound_the_dimension_by_that_of_its_null_space() {
    let sum = [(1.0, &[2, 0, 0][..]), (1.0, &[0, 2, 0])];
    // x² + y² = zᵖ: a horn on one side of the origin for odd p, on both sides for even p.
    for p in 3..=6 {
        let horn: Polynomial = &[sum[0], sum[1], (-1.0, &[0, 0, p])];
        polynomials(3, &[horn], 3, 2, true);
        branches(3, &[horn], &[2]);
    }
    // x² + y² = 2xz² contains the z axis, so that the free motion is finite, and is a surface all the same: its gradient is not zero along the axis.
    let along_the_axis: Polynomial = &[sum[0], sum[1], (-2.0, &[1, 0, 2])];
    let found = polynomials(3, &[along_the_axis], 3, 2, true);
    assert_eq!(found.free_motions, FreeMotions::Finite);
    branches(3, &[along_the_axis], &[2]);
    // x² + y² = −z⁴ is the origin: no real second-order bound shows it.
    polynomials(3, &[&[sum[0], sum[1], (1.0, &[0, 0, 4])]], 3, 0, false);
}

/// Sums of two squares that vanish on a curve only: their gradient is zero along it, the self-stress persists.
#[test]
fn a_self_stress_that_persists_along_the_free_motion_isolates_it() {
    let sum = [(1.0, &[2, 0, 0][..]), (1.0, &[0, 2, 0])];
    let axis: Polynomial = &sum;
    let scaled: Polynomial = &[sum[0], sum[1], (1.0, &[2, 0, 1]), (1.0, &[1, 1, 2])];
    // (x − z²)² + y²: a parabola.
    let parabola: Polynomial = &[sum[0], sum[1], (-2.0, &[1, 0, 2]), (1.0, &[0, 0, 4])];
    for polynomial in [axis, scaled, parabola] {
        let found = polynomials(3, &[polynomial], 3, 1, true);
        assert_eq!(found.free_motions, FreeMotions::FiniteWithPersistentSelfStress);
        assert_eq!(found.upper_bound_origin, BoundOrigin::PersistentSelfStress);
        assert!(!found.is_proved(), "numerical evidence is no proof");
        branches(3, &[polynomial], &[1]);
    }
}

/// x² = y² = 0 has no other complex zeros than the z axis: second order alone bounds the dimension.
#[test]
fn quadrics_without_complex_zeros_bound_the_dimension_at_second_order() {
    let squares: &[Polynomial] = &[&[(1.0, &[2, 0, 0]), (1.0, &[0, 0, 3])], &[(1.0, &[0, 2, 0])]];
    // x² + z³ = y² = 0: a cusp.
    let found = polynomials(3, squares, 3, 1, true);
    assert_eq!(found.upper_bound_origin, BoundOrigin::SecondOrder);
    let point: &[Polynomial] = &[&[(1.0, &[2, 0])], &[(1.0, &[0, 2])]];
    assert!(polynomials(2, point, 2, 0, true).is_proved());
}

/// z = 0 and z = xᵖ: first order allows x, order p stops it; y is free, or stopped at second order.
#[test]
fn motion_obstructed_at_any_order_next_to_a_free_one() {
    for p in 3..=10 {
        let stopped: &[Polynomial] = &[&[(1.0, &[0, 1])], &[(1.0, &[0, 1]), (-1.0, &[p, 0])]];
        polynomials(2, stopped, 1, 0, true);
        let next_to_a_free_one: &[Polynomial] =
            &[&[(1.0, &[0, 0, 1])], &[(1.0, &[0, 0, 1]), (-1.0, &[p, 0, 0])]];
        polynomials(3, next_to_a_free_one, 2, 1, true);
        let at_mixed_orders: &[Polynomial] =
            &[&[(1.0, &[0, 0, 1])], &[(1.0, &[0, 0, 1]), (1.0, &[p, 0, 0]), (1.0, &[0, 2, 0])]];
        // Of odd order it is a cusp, or two branches that touch, and moves; of even order two motions are stopped, one at second order, and what is left stays undecided.
        let (truth, decided) = if p % 2 == 0 { (0, false) } else { (1, true) };
        polynomials(3, at_mixed_orders, 2, truth, decided);
    }
}

/// Watt's linkage, its middle pin in the slot that it follows almost: deviation of fifth order.
#[test]
fn watts_linkage_in_a_straight_slot_is_rigid() {
    // Cranks of length 2 and a coupler of length 1 across, its middle pin held by two bars in line.
    // A search that stops where all constraints are kept to 10⁻¹⁴ takes this for a motion.
    let system = Bars {
        fixed: vec![[-2.0, 0.5], [2.0, -0.5]],
        free: vec![[0.0, 0.5], [0.0, -0.5], [0.0, 0.0]],
        bars: vec![(0, 2), (1, 3), (2, 3), (2, 4), (3, 4)],
        slots: vec![(4, [0.0, 1.0])],
    };
    bars(&system, 1, 0, true);
}

#[test]
fn branches_of_different_dimension_are_reported() {
    let xz: Polynomial = &[(1.0, &[1, 0, 1])];
    let yz: Polynomial = &[(1.0, &[0, 1, 1])];
    let xy: Polynomial = &[(1.0, &[1, 1, 0])];
    let touching: Polynomial = &[(1.0, &[0, 2, 0]), (-1.0, &[4, 0, 0])];
    let flat: Polynomial = &[(1.0, &[0, 0, 1])];
    let none: Polynomial = &[(1.0, &[2, 0, 0]), (1.0, &[0, 2, 0]), (1.0, &[0, 0, 2])];
    // A plane and the line across it; two planes; two curves that touch; a point; all of space.
    let cases: [(&[Polynomial], &[usize]); 5] = [
        (&[xz, yz], &[1, 2]),
        (&[xy], &[2]),
        (&[touching, flat], &[1]),
        (&[none], &[]),
        (&[flat], &[2]),
    ];
    for (polynomials, expected) in cases {
        branches(3, polynomials, expected);
    }
}
