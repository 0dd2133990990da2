//! Virtual joints as polynomials of the slopes of the plane through the balls.
//!
//! ```text
//!    X(x, y)  =  X(0, 0)  +  Σ  s^(n−m) (a_nm Re z^2m + b_nm Im z^2m)        1 ≤ n ≤ N, m ≤ n
//!
//!    z = x + i y, s = |z|²        x, y: slopes of the plane, divided by the largest
//! ```
//! The sides depend on squares of differences of rods, so that X is an even function of the slopes, and smooth near level.
//! Its polynomial of degree 2N is interpolated: in s at nodes of Chebyshev (those of Radau, which include level), along the circles by Fourier coefficients.
//!
//! # Source
//! Own derivation; interpolation as in \[Trefethen\], 2 and 3

use std::f64::consts::PI;

use super::lanes::MOST;
use crate::virtualization::{RELATIVE_THRESHOLD, VirtualJoints};

/// Most terms of a polynomial.
pub(super) const TERMS: usize = 25;
/// Most virtual joints.
pub(super) const JOINTS: usize = 6;
/// Column of the sine of the torsion, behind which are the coordinates of the centroid of the sockets in the plane.
pub(super) const SINE: usize = MOST;
/// Columns of coefficients: those of the virtual joints fill the widest register, and the rest another.
pub(super) const COLUMNS: usize = 2 * MOST;
/// Largest torsion (rad).
const LARGEST_TORSION: f64 = 0.5;
/// Largest slope that is tried: that of 20°.
const LARGEST_SLOPE: f64 = 0.36;
/// Polynomials up to this slope or less are not worth their preparation.
const LEAST_SLOPE: f64 = 0.003;

/// Half the degree of polynomials.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    Three,
    Four,
}

/// The virtual joints of a robot as polynomials, for slopes up to a largest one.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointPolynomials {
    order: Order,
    /// Up to which they are made.
    largest_slope: f64,
    /// From the first two differences of rods to slopes, divided by the largest (1/m).
    pub(super) slopes: [[f64; 2]; 2],
    pub(super) coefficients: Coefficients,
    /// Constant and factor of L² of a bound of 1/2 L, for each side L ((1/m), (1/m³)).
    pub(super) half_inverses: [[f64; 2]; 3],
    /// A quarter of the square of the longest side of the base (m²).
    pub(super) longest_squared: f64,
}

/// For each term, its coefficient in each virtual joint ((m), (rad)) and from [`SINE`] on in the place of the platform; zeros between them.
#[derive(Debug, Clone, PartialEq)]
#[repr(align(64))]
pub(super) struct Coefficients(pub(super) [[f64; COLUMNS]; TERMS]);

impl Coefficients {
    /// # Arguments
    /// * `rows` – coefficients of each value of a [`Sample`]
    fn new(rows: &[[f64; TERMS]; SAMPLE]) -> Self {
        let mut coefficients = [[0.0; COLUMNS]; TERMS];
        for (value, row) in rows.iter().enumerate() {
            let column = if value < JOINTS { value } else { SINE + value - JOINTS };
            for (term, coefficient) in row.iter().enumerate() {
                coefficients[term][column] = *coefficient;
            }
        }
        Self(coefficients)
    }
}

/// What the polynomials are interpolated from, at one slope.
pub(crate) struct Sample {
    pub(crate) virtual_joints: VirtualJoints,
    /// Turn about the normal beyond the shortest rotation to it (rad).
    pub(crate) torsion: f64,
    /// Centroid of the sockets in the platform frame (m).
    pub(crate) center: [f64; 2],
}

/// Values of a sample: virtual joints, the sine of the torsion, the centroid of the sockets in the plane.
const SAMPLE: usize = JOINTS + 3;

impl Sample {
    fn values(&self) -> Option<[f64; SAMPLE]> {
        let mut values = [0.0; SAMPLE];
        values[..self.virtual_joints.len()].copy_from_slice(&self.virtual_joints);
        let ((sine, cosine), [x, y]) = (libm::sincos(self.torsion), self.center);
        values[JOINTS..].copy_from_slice(&[sine, cosine * x - sine * y, sine * x + cosine * y]);
        (self.torsion.abs() < LARGEST_TORSION).then_some(values)
    }
}

impl JointPolynomials {
    pub(crate) fn order(&self) -> Order {
        self.order
    }

    /// Whether they are made for all planes up to this slope.
    pub(crate) fn reach(&self, slope: f64) -> bool {
        self.largest_slope >= slope
    }

    /// Polynomials for slopes up to a largest one, or up to less where they would err by more than [`RELATIVE_THRESHOLD`] of the longest side; `None` where all would.
    ///
    /// # Arguments
    /// * `base_edges` – edges of the base triangle (m)
    /// * `largest_slope` – up to which they are wanted
    /// * `joint_weights` – lengths of units of the virtual joints ((m/m), (m/rad))
    /// * `radius` – of the platform, at which its torsion counts (m)
    /// * `sample` – virtual joints and platform for given slopes of the plane through the balls
    pub(crate) fn new(
        base_edges: &[[f64; 2]; 3],
        largest_slope: f64,
        joint_weights: &[f64],
        radius: f64,
        sample: impl Fn([f64; 2]) -> Option<Sample>,
    ) -> Option<Self> {
        let joints = |slope: [f64; 2]| sample(slope)?.values();
        let mut weights = [1.0; SAMPLE];
        weights[..joint_weights.len()].copy_from_slice(joint_weights);
        weights[JOINTS] = radius;
        let squares = base_edges.map(|[x, y]| x * x + y * y);
        let allowed = RELATIVE_THRESHOLD * squares[0].max(squares[1]).max(squares[2]).sqrt();
        let error = |coefficients: &[[f64; TERMS]; SAMPLE], order: usize, largest: f64| {
            let mut error = 0.0_f64;
            for point in points(order, extrema, 0.5) {
                let expected = joints(point.map(|slope| slope * largest))?;
                let terms = terms(point[0], point[1], order);
                for ((row, weight), expected) in coefficients.iter().zip(weights).zip(expected) {
                    let value: f64 = row.iter().zip(terms).map(|(a, term)| a * term).sum();
                    error = error.max(weight * (value - expected).abs());
                }
            }
            error.is_finite().then_some(error)
        };
        let mut largest = largest_slope.min(LARGEST_SLOPE);
        while largest > LEAST_SLOPE {
            let mut shrink = 0.5;
            for (order, number) in [(Order::Three, 3), (Order::Four, 4)] {
                let Some(coefficients) = interpolate(&joints, number, largest) else { continue };
                let Some(error) = error(&coefficients, number, largest) else { continue };
                if error <= allowed {
                    return Some(Self {
                        order,
                        largest_slope: largest,
                        slopes: slopes(base_edges, largest),
                        coefficients: Coefficients::new(&coefficients),
                        half_inverses: squares.map(|square| half_inverse(square, largest)),
                        longest_squared: 0.25 * squares[0].max(squares[1]).max(squares[2]),
                    });
                }
                // The first omitted term is of this degree.
                shrink =
                    (0.9 * libm::pow(allowed / error, 0.5 / (number + 1) as f64)).clamp(0.5, 0.9);
            }
            largest *= shrink;
        }
        None
    }
}

/// From the first two differences of rods to slopes of the plane through the balls, divided by the largest (1/m).
fn slopes(base_edges: &[[f64; 2]; 3], largest: f64) -> [[f64; 2]; 2] {
    let [[x_1, y_1], [x_2, y_2], _] = *base_edges;
    let scale = (x_1 * y_2 - y_1 * x_2) * largest;
    [[y_2 / scale, -y_1 / scale], [-x_2 / scale, x_1 / scale]]
}

/// Constant and factor of L² in a bound of 1/2 L, for sides L above an edge of the base up to the largest slope: the chord of a convex function.
///
/// # Arguments
/// * `square` – of the edge of the base (m²)
fn half_inverse(square: f64, largest: f64) -> [f64; 2] {
    let (level, rise) = (0.5 / square.sqrt(), largest * largest);
    let falls = (1.0 - 1.0 / (1.0 + rise).sqrt()) / rise;
    [level * (1.0 + falls), -level * falls / square]
}

/// Terms of a polynomial, the constant first.
fn terms(x: f64, y: f64, order: usize) -> [f64; TERMS] {
    let mut terms = [0.0; TERMS];
    let (s, square) = (x * x + y * y, [x * x - y * y, 2.0 * x * y]);
    let mut power = [1.0, 0.0];
    for m in 0..=order {
        let mut scale = 1.0;
        for n in m..=order {
            let [real, imaginary] = places(n, m);
            if m > 0 {
                terms[imaginary] = power[1] * scale;
            }
            terms[real] = power[0] * scale;
            scale *= s;
        }
        power = [
            power[0] * square[0] - power[1] * square[1],
            power[0] * square[1] + power[1] * square[0],
        ];
    }
    terms
}

/// Places of s^(n−m) Re z^2m and s^(n−m) Im z^2m among the terms; for m = 0 the second has no meaning.
fn places(n: usize, m: usize) -> [usize; 2] {
    let first = n * n;
    if m == 0 { [first, first] } else { [first + 2 * m - 1, first + 2 * m] }
}

/// Squared radii of the circles, which are nodes of Chebyshev together with level, where the virtual joints are known.
fn nodes(k: usize, order: usize) -> f64 {
    0.5 - 0.5 * libm::cos(2.0 * PI * (k + 1) as f64 / (2 * order + 1) as f64)
}

/// Squared radii between them, where the error of an interpolation is largest.
fn extrema(k: usize, order: usize) -> f64 {
    0.5 + 0.5 * libm::cos(2.0 * PI * k as f64 / (2 * order + 1) as f64)
}

/// Points of half a disc of radius one: circles, and on each so many points that the even functions of a polynomial are independent there.
fn points(
    order: usize,
    squared_radius: fn(usize, usize) -> f64,
    shift: f64,
) -> impl Iterator<Item = [f64; 2]> {
    let along = 2 * order + 1;
    (0..order).flat_map(move |circle| {
        let radius = squared_radius(circle, order).sqrt();
        (0..along).map(move |k| {
            let (sine, cosine) = libm::sincos((k as f64 + shift) * PI / along as f64);
            [radius * cosine, radius * sine]
        })
    })
}

/// Coefficients of the polynomials that interpolate the virtual joints; `None` where a point has none.
fn interpolate(
    joints: &impl Fn([f64; 2]) -> Option<[f64; SAMPLE]>,
    order: usize,
    largest: f64,
) -> Option<[[f64; TERMS]; SAMPLE]> {
    let along = 2 * order + 1;
    let level = joints([0.0; 2])?;
    let mut values = [[[0.0; 9]; 4]; SAMPLE];
    for (i, point) in points(order, nodes, 0.0).enumerate() {
        let (circle, k) = (i / along, i % along);
        let found = joints(point.map(|slope| slope * largest))?;
        for ((value, found), level) in values.iter_mut().zip(found).zip(level) {
            value[circle][k] = (found - level) / nodes(circle, order);
        }
    }
    let mut rows = [[0.0; TERMS]; SAMPLE];
    for ((row, values), level) in rows.iter_mut().zip(&values).zip(level) {
        row[0] = level;
        for m in 0..=order {
            let (mut real, mut imaginary) = ([0.0; 4], [0.0; 4]);
            for circle in 0..order {
                for (k, value) in values[circle][..along].iter().enumerate() {
                    let angle = (2 * m * k) as f64 * PI / along as f64;
                    let share = if m == 0 { 1.0 } else { 2.0 } / along as f64;
                    let (sine, cosine) = libm::sincos(angle);
                    real[circle] += share * cosine * value;
                    imaginary[circle] += share * sine * value;
                }
            }
            let (real, imaginary) = (powers(real, order), powers(imaginary, order));
            for n in m.max(1)..=order {
                let [at_real, at_imaginary] = places(n, m);
                if m > 0 {
                    row[at_imaginary] = imaginary[n - 1];
                }
                row[at_real] = real[n - 1];
            }
        }
    }
    Some(rows)
}

/// Coefficients of the polynomial with given values at the nodes, by divided differences.
fn powers(mut values: [f64; 4], order: usize) -> [f64; 4] {
    for step in 1..order {
        for k in (step..order).rev() {
            let apart = nodes(k, order) - nodes(k - step, order);
            values[k] = (values[k] - values[k - 1]) / apart;
        }
    }
    let mut powers = [0.0; 4];
    for k in (0..order).rev() {
        // Times (t − t_k), and the next difference.
        for power in (1..order).rev() {
            powers[power] = powers[power - 1] - nodes(k, order) * powers[power];
        }
        powers[0] = values[k] - nodes(k, order) * powers[0];
    }
    powers
}
