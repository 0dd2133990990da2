//! The triangle of the sockets of many poses, and how the virtual joints move it.

use pulp::Simd;

use super::geometry::{FirstStep, Geometry};
use super::lanes::{Lanes, Mask};
use super::model::Model;
use super::plane::Plane;
use crate::error::LARGEST_LENGTH;

/// Three numbers of each pose.
pub(crate) type Three<S> = [Lanes<S>; 3];
/// Three vectors of the platform plane of each pose.
pub(crate) type Vectors<S> = [[Lanes<S>; 2]; 3];

/// The triangle of the balls of many poses.
#[derive(Clone, Copy)]
pub(crate) struct Balls<S: Simd> {
    /// Mean rod (m).
    pub(crate) mean: Lanes<S>,
    /// Differences of rods, q_j − q_i (m).
    pub(crate) rises: Three<S>,
    /// Squared sides L_ij² (m²).
    pub(crate) squares: Three<S>,
    /// The plane through them.
    pub(crate) plane: Plane<S>,
}

impl<S: Simd> Balls<S> {
    #[inline(always)]
    pub(crate) fn new(geometry: &Geometry, rods: Three<S>) -> Self {
        let [q_1, q_2, q_3] = rods;
        let rises = [q_2 - q_1, q_3 - q_2, q_1 - q_3];
        let mut squares = rises;
        for k in 0..3 {
            squares[k] = rises[k].times_plus(rises[k], q_1.like(geometry.base_squares[k]));
        }
        let plane = Plane::new(geometry, &rises);
        Self { mean: (q_1 + q_2 + q_3) * (1.0 / 3.0), rises, squares, plane }
    }

    /// Difference of each squared side from that of the nominal sockets (m²).
    #[inline(always)]
    pub(crate) fn missing_at_start(&self, geometry: &Geometry) -> Three<S> {
        let mut missing = self.squares;
        for (k, missing) in missing.iter_mut().enumerate() {
            *missing = *missing - geometry.socket_squares[k];
        }
        missing
    }

    /// Largest of |L − l| = |L² − l²|/(L + l), where L + l is 2 L beyond all digits (m).
    ///
    /// ```text
    ///    1/L  =  (1 + x)^(-1/2)/b  ≤  (1 − x/2 + 3x²/8)/b        L² = b² (1 + x)
    /// ```
    /// b: side of the base triangle, of which x is the squared slope.
    /// A block of poses would wait for the answer of a root and a division.
    ///
    /// # Numerics
    /// By the series up to a tilt of 14°: never too small, and too large by 0.01 % of itself at most.
    #[inline(always)]
    pub(crate) fn residual(&self, geometry: &Geometry, missing: &Three<S>) -> Lanes<S> {
        let mut shares = *missing;
        for (k, share) in shares.iter_mut().enumerate() {
            let (square, [constant, linear, quadratic]) =
                (self.squares[k], geometry.half_inverses[k]);
            let series = square.times_plus(square.like(quadratic), square.like(linear));
            *share = share.abs() * square.times_plus(series, square.like(constant));
        }
        let [a, b, c] = shares;
        let by_series = a.max(b).max(c);
        let ([l_1, l_2, l_3], [i_1, i_2, i_3]) = (self.squares, geometry.base_inverse_squares);
        // The squared slopes along the sides have a sum of at most 0.1.
        let stretched = l_1.times_plus(a.like(i_1), l_2.times_plus(a.like(i_2), l_3 * i_3));
        let flat = stretched.at_most(a.like(3.1));
        if flat.all() {
            return by_series;
        }
        let [m_1, m_2, m_3] = *missing;
        // Each share times the product of all squares, so that one division is enough.
        let (a, b, c) = (m_1.squared() * l_2, m_2.squared() * l_1, m_3.squared() * l_2);
        let worst = (a.max(b) * l_3).max(c * l_1);
        let product = l_1 * l_2 * l_3;
        flat.select(by_series, (worst * (product.like(0.25) / product)).sqrt())
    }

    /// Bounds of the squared differences of squared sides within the threshold of a task, for [`within`]; negative (m⁴).
    ///
    /// Zero where numbers are too small for it, so that nothing is within.
    #[inline(always)]
    pub(crate) fn bounds(&self, threshold: f64) -> Three<S> {
        // |L − l| ≤ ε max L, squared and with (L + l)² = 4 L², for which no root is needed.
        let most = self.longest_squared() * -threshold;
        let [l_1, l_2, l_3] = self.squares;
        [most * l_1, most * l_2, most * l_3]
    }

    /// Lanes whose rods and squared sides are far below [`LARGEST_LENGTH`]; false where any is not a number.
    #[inline(always)]
    pub(crate) fn moderate(&self, rods: &Three<S>) -> Mask<S> {
        // Sums, since the larger of a number and none may be the number; rods differ by less than a side.
        let [l_1, l_2, l_3] = self.squares;
        (l_1 + l_3 + l_2 + rods[0].abs()).at_most(l_1.like(0.25 * LARGEST_LENGTH))
    }

    /// Square of the longest side (m²).
    #[inline(always)]
    pub(crate) fn longest_squared(&self) -> Lanes<S> {
        let [l_1, l_2, l_3] = self.squares;
        l_1.max(l_2).max(l_3)
    }
}

/// Where the squares of three numbers are below their bounds, whose negatives are given.
///
/// A number that is none may pass unseen: poses with one are found by [`Balls::moderate`].
#[inline(always)]
pub(super) fn within<S: Simd>(numbers: &Three<S>, bounds: &Three<S>) -> Mask<S> {
    let [a, b, c] = *numbers;
    let (over_a, over_b) = (a.times_plus(a, bounds[0]), b.times_plus(b, bounds[1]));
    let over_c = c.times_plus(c, bounds[2]);
    over_a.max(over_b).max(over_c).below(a.like(0.0))
}

/// The triangle of the sockets of many poses, with the virtual joints that make it.
#[derive(Clone, Copy)]
pub(crate) struct Shape<S: Simd> {
    /// Coordinates along the directions (m).
    pub(crate) a: Three<S>,
    /// Coordinates across ((m), (rad)).
    pub(crate) b: Three<S>,
    /// Directions along which `a` moves the sockets.
    directions: Vectors<S>,
    /// p_j − p_i (m).
    pub(crate) edges: Vectors<S>,
    /// p_k (m).
    pub(crate) sockets: Vectors<S>,
}

/// How the sides of the triangle answer to the virtual joints.
#[derive(Clone, Copy)]
pub(crate) struct Response<S: Simd> {
    /// Effect of `a` and `b` of limb k on the edge that leaves socket k.
    pub(crate) leaving: Vectors<S>,
    /// Effect of `a` and `b` of limb k on the edge that arrives at socket k.
    pub(crate) arriving: Vectors<S>,
}

impl<S: Simd> Shape<S> {
    /// The nominal sockets.
    #[inline(always)]
    pub(crate) fn start<M: Model>(geometry: &Geometry, any: Lanes<S>) -> Self {
        let zero = any.like(0.0);
        let mut shape = Self {
            a: [zero; 3],
            b: [zero; 3],
            directions: [[zero; 2]; 3],
            edges: [[zero; 2]; 3],
            sockets: [[zero; 2]; 3],
        };
        for k in 0..3 {
            shape.a[k] = any.like(geometry.start::<M>()[k]);
            for axis in 0..2 {
                shape.directions[k][axis] = any.like(geometry.directions::<M>()[k][axis]);
            }
        }
        shape.lay_out::<M>(geometry);
        shape
    }

    /// The shape of given virtual joints.
    #[inline(always)]
    pub(crate) fn at<M: Model>(geometry: &Geometry, a: Three<S>, b: Three<S>) -> Self {
        let mut shape = Self::start::<M>(geometry, a[0]);
        (shape.a, shape.b) = (a, b);
        if M::TURNS {
            let (sines, versines) = super::trigonometry::sin_cos_of_steps(b);
            for k in 0..3 {
                let [x, y] = shape.directions[k];
                shape.directions[k] = [
                    versines[k].times_from(x, sines[k].times_from(y, x)),
                    versines[k].times_from(y, sines[k].times_plus(x, y)),
                ];
            }
        }
        shape.lay_out::<M>(geometry);
        shape
    }

    /// Moves the virtual joints.
    #[inline(always)]
    pub(crate) fn advance<M: Model>(
        &mut self,
        geometry: &Geometry,
        by_a: Three<S>,
        by_b: Three<S>,
    ) {
        for k in 0..3 {
            self.a[k] = self.a[k] + by_a[k];
            if M::ACROSS {
                self.b[k] = self.b[k] + by_b[k];
            }
            if M::TURNS {
                let (sine, cosine) = super::trigonometry::sin_cos_of_step(by_b[k]);
                let [x, y] = self.directions[k];
                self.directions[k] =
                    [sine.times_from(y, x * cosine), sine.times_plus(x, y * cosine)];
            }
        }
        self.lay_out::<M>(geometry);
    }

    /// Sockets and edges for the coordinates and directions.
    #[inline(always)]
    fn lay_out<M: Model>(&mut self, geometry: &Geometry) {
        for k in 0..3 {
            let [x, y] = self.directions[k];
            let moved = if M::TOWARD_SOCKET {
                [self.a[k] * x, self.a[k] * y]
            } else {
                [self.a[k], self.b[k]]
            };
            self.sockets[k] = if M::FROM_SOCKET {
                let [start_x, start_y] = geometry.sockets[k];
                [moved[0] + start_x, moved[1] + start_y]
            } else {
                moved
            };
        }
        for k in 0..3 {
            for axis in 0..2 {
                self.edges[k][axis] = self.sockets[(k + 1) % 3][axis] - self.sockets[k][axis];
            }
        }
    }

    /// Difference of each squared side from that of this triangle (m²).
    #[inline(always)]
    pub(crate) fn missing(&self, balls: &Balls<S>) -> Three<S> {
        missing(&self.edges, balls)
    }

    /// Distance of each ball from the centre of its nominal socket (m).
    #[inline(always)]
    pub(crate) fn ball_displacements(&self, geometry: &Geometry) -> Three<S> {
        let mut displacements = self.a;
        for (k, displacement) in displacements.iter_mut().enumerate() {
            let [x, y] = [0, 1].map(|axis| self.sockets[k][axis] - geometry.sockets[k][axis]);
            *displacement = x.times_plus(x, y * y).sqrt();
        }
        displacements
    }

    /// Centroid of the sockets (m).
    #[inline(always)]
    pub(super) fn center(&self) -> [Lanes<S>; 2] {
        let [p_1, p_2, p_3] = self.sockets;
        [(p_1[0] + p_2[0] + p_3[0]) * (1.0 / 3.0), (p_1[1] + p_2[1] + p_3[1]) * (1.0 / 3.0)]
    }

    /// Twice the signed area (m²).
    #[inline(always)]
    pub(crate) fn area(&self) -> Lanes<S> {
        let ([x_1, y_1], [x_2, y_2]) = (self.edges[0], self.edges[1]);
        y_1.times_from(x_2, x_1 * y_2)
    }

    /// Products of the edges with the velocities of the sockets.
    #[inline(always)]
    pub(crate) fn response<M: Model>(&self) -> Response<S> {
        let zero = self.a[0].like(0.0);
        let mut response = Response { leaving: [[zero; 2]; 3], arriving: [[zero; 2]; 3] };
        for k in 0..3 {
            let [x, y] = self.directions[k];
            let (leaving, arriving) = (self.edges[k], self.edges[(k + 2) % 3]);
            for (edge, products) in
                [(leaving, &mut response.leaving[k]), (arriving, &mut response.arriving[k])]
            {
                *products = if !M::TOWARD_SOCKET {
                    edge
                } else {
                    let along = x.times_plus(edge[0], y * edge[1]);
                    let across = y.times_from(edge[0], x * edge[1]);
                    [along, if M::TURNS { across * self.a[k] } else { across }]
                };
            }
        }
        response
    }
}

/// Difference of each squared side from that of a triangle with these edges (m²).
#[inline(always)]
pub(super) fn missing<S: Simd>(edges: &Vectors<S>, balls: &Balls<S>) -> Three<S> {
    let mut missing = balls.squares;
    for (missing, [x, y]) in missing.iter_mut().zip(edges) {
        *missing = y.times_from(*y, x.times_from(*x, *missing));
    }
    missing
}

/// The first step from nominal, which is the same linear map for all poses.
#[inline(always)]
pub(crate) fn first_step<S: Simd, M: Model>(
    first_step: &FirstStep,
    missing: &Three<S>,
) -> (Three<S>, Three<S>) {
    let zero = missing[0].like(0.0);
    let (mut by_a, mut by_b) = ([zero; 3], [zero; 3]);
    for k in 0..3 {
        by_a[k] = row(&first_step.0[k], missing);
        if M::ACROSS {
            by_b[k] = row(&first_step.0[3 + k], missing);
        }
    }
    (by_a, by_b)
}

#[inline(always)]
fn row<S: Simd>(row: &[f64; 3], missing: &Three<S>) -> Lanes<S> {
    let [m_1, m_2, m_3] = *missing;
    m_1.times_plus(m_1.like(row[0]), m_2.times_plus(m_2.like(row[1]), m_3 * row[2]))
}
