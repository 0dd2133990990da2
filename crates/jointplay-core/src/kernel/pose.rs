//! Platform poses of many poses, from their sockets.

use pulp::Simd;

use super::found::Laid;
use super::geometry::Geometry;
use super::lanes::Lanes;
use super::plane::Plane;
use super::shape::{Balls, Shape, Three};
use super::trigonometry::{angle_of, small_angle_of};

/// The platforms of many poses.
#[derive(Clone, Copy)]
pub(crate) struct PlatformPoses<S: Simd> {
    /// O_p in the base frame (m).
    pub(crate) origin: Three<S>,
    /// Platform normal in the base frame.
    pub(crate) normal: Three<S>,
    /// Cosine and sine of the turn about the normal.
    turn: [Lanes<S>; 2],
    /// n/(1 + n_z), its horizontal part.
    slope: [Lanes<S>; 2],
}

impl<S: Simd> PlatformPoses<S> {
    /// What [`fit_in_plane`](crate::spatial::fit_in_plane) does, for triangles that are equal to the threshold.
    #[inline(always)]
    pub(crate) fn new(geometry: &Geometry, balls: &Balls<S>, shape: &Shape<S>) -> Self {
        let tilted = Tilted::new(&balls.plane, balls.plane.factors());
        let (mut cosine, mut sine) = (balls.mean.like(0.0), balls.mean.like(0.0));
        for k in 0..3 {
            let [onto_x, onto_y] = tilted.edge(geometry, balls, k);
            let [from_x, from_y] = shape.edges[k];
            cosine = from_x.times_plus(onto_x, from_y.times_plus(onto_y, cosine));
            sine = from_y.times_from(onto_x, from_x.times_plus(onto_y, sine));
        }
        // The length of (cosine, sine) is the sum of the squared sides but for what is missing from them; one step of Newton's method for the root takes that away.
        let [l_1, l_2, l_3] = balls.squares;
        let rough = (l_1 + l_2 + l_3).inverse();
        let (cosine, sine) = (cosine * rough, sine * rough);
        let length = cosine.times_plus(cosine, sine * sine);
        let exact = length.times_from(length.like(0.5), length.like(1.5));
        let (cosine, sine) = (cosine * exact, sine * exact);
        // A second step to length one, with what is missing from it to the last digit, so that a platform without torsion has none.
        let one = cosine.like(1.0);
        let missing = sine.times_from(sine, cosine.times_from(cosine, one)) * 0.5;
        let turn = [cosine.times_plus(missing, cosine), sine.times_plus(missing, sine)];
        tilted.turned(geometry, balls, turn, shape.center())
    }

    /// As [`Self::new`], for a triangle whose sides are those of the balls to round-off: its first side is at that of the balls.
    #[inline(always)]
    pub(super) fn laid(geometry: &Geometry, balls: &Balls<S>, laid: &Laid<S>) -> Self {
        let tilted = Tilted::new(&balls.plane, laid.factors);
        let [onto_x, onto_y] = tilted.edge(geometry, balls, 0);
        let [x, y] = laid.side;
        let cosine = x.times_plus(onto_x, y * onto_y);
        let sine = y.times_from(onto_x, x * onto_y);
        tilted.turned(geometry, balls, [cosine, sine], laid.center)
    }

    /// The platform in the plane through the balls at a known place in it.
    #[inline(always)]
    pub(super) fn at(
        geometry: &Geometry,
        balls: &Balls<S>,
        InPlane { sine, center }: InPlane<S>,
    ) -> Self {
        let cosine = sine.times_from(sine, sine.like(1.0)).sqrt();
        Tilted::new(&balls.plane, balls.plane.factors()).placed(
            geometry,
            balls,
            [cosine, sine],
            center,
        )
    }

    /// Axes of the platform frame in the base frame: columns of the rotation.
    #[inline(always)]
    pub(crate) fn axes(&self) -> [Three<S>; 3] {
        let ([n_x, n_y, n_z], [slope_x, slope_y]) = (self.normal, self.slope);
        let one = n_x.like(1.0);
        let slope_z = one + n_z;
        // The axes of a platform without torsion, then turned about the normal.
        let first = [slope_x.times_from(n_x, one), -(slope_x * n_y), -(slope_x * slope_z)];
        let second = [-(slope_y * n_x), slope_y.times_from(n_y, one), -(slope_y * slope_z)];
        let [cosine, sine] = self.turn;
        let mut axes = [first, second, self.normal];
        for axis in 0..3 {
            let (a, b) = (first[axis], second[axis]);
            axes[0][axis] = sine.times_plus(b, cosine * a);
            axes[1][axis] = sine.times_from(a, cosine * b);
        }
        axes
    }

    /// Azimuth toward which the platform tilts (rad).
    #[inline(always)]
    pub(crate) fn azimuth(&self) -> Lanes<S> {
        let [x, y, _] = self.normal;
        // A level platform has no azimuth, and no sign of a zero.
        let level = (x.abs() + y.abs()).at_most(x.like(0.0));
        level.select(x.like(0.0), angle_of(y, x))
    }

    /// Tilt angle (rad).
    #[inline(always)]
    pub(crate) fn tilt_angle(&self) -> Lanes<S> {
        let [x, y, z] = self.normal;
        angle_of(x.times_plus(x, y * y).sqrt(), z)
    }

    /// Turn about the normal beyond the shortest rotation to it (rad).
    #[inline(always)]
    pub(crate) fn torsion(&self) -> Lanes<S> {
        let [cosine, sine] = self.turn;
        small_angle_of(sine, cosine)
    }

    /// Axis height: height at which the platform plane crosses the base axis (m).
    #[inline(always)]
    pub(crate) fn axis_height(&self) -> Lanes<S> {
        let ([x, y, z], [o_x, o_y, o_z]) = (self.normal, self.origin);
        x.times_plus(o_x, y * o_y) / z + o_z
    }
}

/// Where platforms sit in the planes through their balls, in axes of the planes without a torsion.
#[derive(Clone, Copy)]
pub(super) struct InPlane<S: Simd> {
    /// Sine of the torsion, whose cosine is positive.
    pub(super) sine: Lanes<S>,
    /// Centroid of the sockets, seen from O_p (m).
    pub(super) center: [Lanes<S>; 2],
}

/// Axes of planes.
#[derive(Clone, Copy)]
struct Tilted<S: Simd> {
    /// Upward, in the base frame.
    normal: Three<S>,
    /// n/(1 + n_z), its horizontal part: e_1 − slope_x (n + e_3) and e_2 − slope_y (n + e_3) are the axes of a platform that tilts without a torsion.
    slope: [Lanes<S>; 2],
}

impl<S: Simd> Tilted<S> {
    #[inline(always)]
    fn new(plane: &Plane<S>, [per_area, per_slope]: [Lanes<S>; 2]) -> Self {
        let [x, y, z] = plane.across;
        let normal = [x * per_area, y * per_area, z * per_area];
        Self { normal, slope: [x * per_slope, y * per_slope] }
    }

    /// An edge between the balls, in axes of the plane.
    #[inline(always)]
    fn edge(&self, geometry: &Geometry, balls: &Balls<S>, k: usize) -> [Lanes<S>; 2] {
        let ([slope_x, slope_y], rise) = (self.slope, balls.rises[k]);
        let [base_x, base_y] = geometry.base_edges[k].map(|base| rise.like(base));
        [slope_x.times_from(rise, base_x), slope_y.times_from(rise, base_y)]
    }

    /// Platforms with a turn, and with the centroids of their sockets, seen from O_p, at those of the balls.
    #[inline(always)]
    fn turned(
        self,
        geometry: &Geometry,
        balls: &Balls<S>,
        turn: [Lanes<S>; 2],
        [x, y]: [Lanes<S>; 2],
    ) -> PlatformPoses<S> {
        let [cosine, sine] = turn;
        let center = [sine.times_from(y, cosine * x), sine.times_plus(x, cosine * y)];
        self.placed(geometry, balls, turn, center)
    }

    /// Platforms with a turn, and with the centroids of their sockets at those of the balls.
    #[inline(always)]
    fn placed(
        self,
        geometry: &Geometry,
        balls: &Balls<S>,
        turn: [Lanes<S>; 2],
        center: [Lanes<S>; 2],
    ) -> PlatformPoses<S> {
        let Self { normal, slope } = self;
        let along_slope = slope[0].times_plus(center[0], slope[1] * center[1]);
        let rise = normal[0].times_plus(center[0], normal[1] * center[1]);
        let [base_x, base_y] = geometry.base_center.map(|base| rise.like(base));
        let origin = [
            normal[0].times_plus(along_slope, base_x - center[0]),
            normal[1].times_plus(along_slope, base_y - center[1]),
            balls.mean + rise,
        ];
        PlatformPoses { origin, normal, turn, slope }
    }
}
