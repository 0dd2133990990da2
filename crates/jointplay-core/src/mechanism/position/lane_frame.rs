//! Frames of many configurations side by side.

use nalgebra::{Matrix3, Rotation3, Vector3};
use pulp::Simd;

use super::frame::Frame;
use super::walk::{Lead, Motion, Walk};
use crate::kernel::{Lanes, angle_of, sin_cos};
use crate::spatial::{NEARLY_HALF, rotation_vector};

/// Three numbers of each configuration.
pub(super) type Three<S> = [Lanes<S>; 3];

/// Position and orientation of a frame in the base frame; the rotation by columns.
#[derive(Clone, Copy)]
pub(super) struct LaneFrame<S: Simd> {
    pub(super) axes: [Three<S>; 3],
    pub(super) origin: Three<S>,
}

/// How a link moves with one coordinate, in the base frame.
#[derive(Clone, Copy)]
pub(super) struct LaneScrew<S: Simd> {
    pub(super) angular: Three<S>,
    /// Velocity of the point `at`.
    linear: Three<S>,
    at: Three<S>,
}

/// Lengths of rotation vectors, and sines, below which their ratio is one (rad).
const TINY: f64 = 1e-100;

/// Three values by their index; a closure would not be inlined, and be compiled without the machine's wide instructions.
macro_rules! three {
    ($k:ident => $value:expr) => {
        [
            {
                let $k = 0;
                $value
            },
            {
                let $k = 1;
                $value
            },
            {
                let $k = 2;
                $value
            },
        ]
    };
}
pub(super) use three;

#[inline(always)]
pub(super) fn dot<S: Simd>(a: &Three<S>, b: &Three<S>) -> Lanes<S> {
    a[2].times_plus(b[2], a[1].times_plus(b[1], a[0] * b[0]))
}

#[inline(always)]
pub(super) fn cross<S: Simd>(a: &Three<S>, b: &Three<S>) -> Three<S> {
    [
        a[2].times_from(b[1], a[1] * b[2]),
        a[0].times_from(b[2], a[2] * b[0]),
        a[1].times_from(b[0], a[0] * b[1]),
    ]
}

#[inline(always)]
pub(super) fn minus<S: Simd>(a: &Three<S>, b: &Three<S>) -> Three<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn times<S: Simd>(a: &Three<S>, factor: Lanes<S>) -> Three<S> {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// `to + along · by`.
#[inline(always)]
fn advanced<S: Simd>(to: &Three<S>, along: &Three<S>, by: Lanes<S>) -> Three<S> {
    [along[0].times_plus(by, to[0]), along[1].times_plus(by, to[1]), along[2].times_plus(by, to[2])]
}

impl<S: Simd> LaneScrew<S> {
    pub(super) fn still(simd: S) -> Self {
        let zero = [Lanes::splat(simd, 0.0); 3];
        Self { angular: zero, linear: zero, at: zero }
    }

    /// Velocity of a point that moves with it.
    #[inline(always)]
    pub(super) fn velocity_of(&self, point: &Three<S>) -> Three<S> {
        let turned = cross(&self.angular, &minus(point, &self.at));
        three!(k => self.linear[k] + turned[k])
    }
}

impl<S: Simd> LaneFrame<S> {
    /// The same frame for all configurations.
    pub(super) fn splat(simd: S, frame: &Frame) -> Self {
        let splat = |value| Lanes::splat(simd, value);
        Self {
            axes: [0, 1, 2].map(|c| [0, 1, 2].map(|r| splat(frame.axis(c)[r]))),
            origin: [0, 1, 2].map(|r| splat(frame.origin()[r])),
        }
    }

    /// A fixed direction of the frame, in the base frame.
    #[inline(always)]
    fn along(&self, v: &Vector3<f64>) -> Three<S> {
        let [x, y, z] = &self.axes;
        let [a, b, c] = three!(k => x[0].like(v[k]));
        three!(r => z[r].times_plus(c, y[r].times_plus(b, x[r] * a)))
    }

    #[inline(always)]
    fn displace(&mut self, by: &Lead) {
        match by {
            Lead::Nothing => {}
            Lead::Shift(shift) => self.shift(shift),
            Lead::Frame(by) => {
                self.shift(&by.origin());
                self.axes = three!(c => self.along(&by.axis(c)));
            }
        }
    }

    #[inline(always)]
    fn shift(&mut self, by: &Vector3<f64>) {
        let by = self.along(by);
        self.origin = three!(r => self.origin[r] + by[r]);
    }

    /// R B, or R Bᵀ.
    #[inline(always)]
    fn turned(&self, turn: &[Three<S>; 3], forward: bool) -> [Three<S>; 3] {
        let [x, y, z] = &self.axes;
        three!(c => {
            let [a, b, d] = three!(k => if forward { turn[c][k] } else { turn[k][c] });
            three!(r => z[r].times_plus(d, y[r].times_plus(b, x[r] * a)))
        })
    }

    /// Moves along a chain, and records the screws of the unknowns.
    #[inline(always)]
    pub(super) fn follow(
        &mut self,
        walk: &Walk,
        coordinates: &[Lanes<S>],
        balls: &[[Three<S>; 3]],
        screws: &mut [LaneScrew<S>],
    ) {
        let zero = self.origin[0].like(0.0);
        for step in &walk.steps {
            self.displace(&step.lead);
            let value = coordinates[step.coordinate] * step.sign;
            let sign = zero.like(step.sign);
            match step.motion {
                Motion::Turn(_) | Motion::Screw(..) => {
                    let [x, y, z] = self.axes;
                    let advance = match step.motion {
                        Motion::Screw(_, lead) => zero.like(lead),
                        _ => zero,
                    };
                    if let Some(column) = step.column {
                        let angular = times(&z, sign);
                        let linear = times(&z, advance * sign);
                        screws[column] = LaneScrew { angular, linear, at: self.origin };
                    }
                    self.origin = advanced(&self.origin, &z, advance * value);
                    let (sine, cosine) = sin_cos(value);
                    self.axes[0] = advanced(&times(&x, cosine), &y, sine);
                    self.axes[1] = advanced(&times(&y, cosine), &x, -sine);
                }
                Motion::Slide(axis) => {
                    let direction = self.along(&axis);
                    if let Some(column) = step.column {
                        let linear = times(&direction, sign);
                        screws[column] = LaneScrew { angular: [zero; 3], linear, at: [zero; 3] };
                    }
                    self.origin = advanced(&self.origin, &direction, value);
                }
                Motion::Ball(ball) => {
                    let forward = step.sign > 0.0;
                    let before = self.axes;
                    self.axes = self.turned(&balls[ball], forward);
                    if let Some(column) = step.column {
                        // The axes of the side that the ball's coordinates turn.
                        let axes = if forward { &self.axes } else { &before };
                        for (k, axis) in axes.iter().enumerate() {
                            let angular = times(axis, sign);
                            screws[column + k] =
                                LaneScrew { angular, linear: [zero; 3], at: self.origin };
                        }
                    }
                }
            }
        }
        self.displace(&walk.tail);
    }
}

/// The rotation of a rotation vector (rad), by columns.
#[inline(always)]
pub(super) fn rotation_of<S: Simd>(vector: &Three<S>) -> [Three<S>; 3] {
    let square = dot(vector, vector);
    let angle = square.sqrt();
    let (sine, cosine) = sin_cos(angle * 0.5);
    let tiny = angle.at_most(angle.like(TINY));
    let one = angle.like(1.0);
    // sin(θ/2) / (θ/2)
    let ratio = tiny.select(one, sine / tiny.select(one, angle * 0.5));
    let (first, second) = (ratio * cosine, ratio * ratio * 0.5);
    let diagonal = (sine * -2.0).times_plus(sine, one);
    let [x, y, z] = *vector;
    let (xy, xz, yz) = (second * x * y, second * x * z, second * y * z);
    let [tx, ty, tz] = times(vector, first);
    [
        [second * x * x + diagonal, xy + tz, xz - ty],
        [xy - tz, second * y * y + diagonal, yz + tx],
        [xz + ty, yz - tx, second * z * z + diagonal],
    ]
}

/// The rotation vector of a rotation by columns (rad).
#[inline(always)]
pub(super) fn rotation_vector_of<S: Simd>(simd: S, rotation: &[Three<S>; 3]) -> Three<S> {
    let [x, y, z] = rotation;
    let skew = [(y[2] - z[1]) * 0.5, (z[0] - x[2]) * 0.5, (x[1] - y[0]) * 0.5];
    let sine = dot(&skew, &skew).sqrt();
    let cosine = (x[0] + y[1] + z[2] - 1.0) * 0.5;
    let tiny = sine.at_most(sine.like(TINY));
    let one = sine.like(1.0);
    let ratio = tiny.select(one, angle_of(sine, cosine) / tiny.select(one, sine));
    let vector = times(&skew, ratio);
    let half = cosine.below(cosine.like(NEARLY_HALF));
    if !half.any() {
        return vector;
    }
    let numbers = three!(c => three!(r => rotation[c][r].numbers()));
    let (mut found, is_half) = (three!(k => vector[k].numbers()), half.answers());
    for lane in (0..Lanes::<S>::COUNT).filter(|&lane| is_half[lane]) {
        let matrix = Matrix3::from_fn(|row, column| numbers[column][row][lane]);
        let exact = rotation_vector(&Rotation3::from_matrix_unchecked(matrix));
        (0..3).for_each(|k| found[k][lane] = exact[k]);
    }
    three!(k => Lanes::of(simd, &found[k][..Lanes::<S>::COUNT]))
}

/// A rotation turned further by a small rotation vector, as [`crate::mechanism::ball::cayley`] turns.
#[inline(always)]
pub(super) fn turned_by<S: Simd>(rotation: &[Three<S>; 3], by: &Three<S>) -> [Three<S>; 3] {
    let u = times(by, by[0].like(0.5));
    let scale = (dot(&u, &u) + 1.0).inverse() * 2.0;
    let [x, y, z] = u;
    let (sx, sy, sz) = (scale * x, scale * y, scale * z);
    let one = scale.like(1.0);
    let turn = [
        [one - sy * y - sz * z, sx * y + sz, sx * z - sy],
        [sx * y - sz, one - sx * x - sz * z, sy * z + sx],
        [sx * z + sy, sy * z - sx, one - sx * x - sy * y],
    ];
    let frame = LaneFrame { axes: *rotation, origin: u };
    frame.turned(&turn, true)
}
