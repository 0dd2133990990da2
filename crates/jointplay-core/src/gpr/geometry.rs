//! The robot: its dimensions and limits, which are constant.

use nalgebra::{Vector2, Vector3};

use super::Limits;
use crate::Error;
use crate::error::{finite, length};
#[cfg(feature = "std")]
use crate::kernel::Geometry;
use crate::virtualization::{Platform, Sides, Sockets, signed_area};

/// One limb: a guide in the base, a rod, and a socket in the platform.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limb {
    /// B_k, where the rod's axis crosses the base plane, in the base frame (m).
    pub base_point: Vector2<f64>,
    /// r_k, distance of the nominal socket from O_p (m).
    pub socket_radius: f64,
    /// β_k, direction of the nominal socket from e_p1 toward e_p2 (rad).
    pub socket_angle: f64,
}

impl Limb {
    /// A limb whose rod is below its nominal socket when the platform is level.
    #[must_use]
    pub fn under_socket(socket_radius: f64, socket_angle: f64) -> Self {
        let (sin, cos) = libm::sincos(socket_angle);
        let base_point = Vector2::new(cos, sin) * socket_radius;
        Self { base_point, socket_radius, socket_angle }
    }
}

/// A three-rod robot.
///
/// Its kinematics answer within its limits only, see [`Self::without_limit_checks`].
#[derive(Debug, Clone, PartialEq)]
pub struct Gpr {
    base_points: Sockets,
    platform: Platform,
    limits: Limits,
    working_height: f64,
    /// tan of the largest tilt.
    steepest: f64,
    checks_limits: bool,
    /// Clearance of the balls, as a radius, if known (m).
    pub(super) ball_clearance: Option<f64>,
    #[cfg(feature = "std")]
    dimensions: Geometry,
}

impl Gpr {
    /// A robot from its limbs, limits and working height (m).
    ///
    /// # Errors
    /// [`Error::NotFinite`], [`Error::TooLong`], [`Error::NotPositive`] for a socket radius, [`Error::Collinear`] base points or sockets,
    /// [`Error::OppositeSenses`], [`Error::LimitsReversed`], [`Error::OutOfRange`] for the tilt limit or a working height beyond the rods.
    pub fn new(limbs: [Limb; 3], limits: Limits, working_height: f64) -> Result<Self, Error> {
        for limb in &limbs {
            length("a base point", limb.base_point.x)?;
            length("a base point", limb.base_point.y)?;
            length("a socket radius", limb.socket_radius)?;
        }
        let base_points = limbs.map(|limb| limb.base_point);
        crate::virtualization::check_not_collinear("base points", &base_points)?;
        let platform = Platform::new(
            limbs.map(|limb| limb.socket_radius),
            limbs.map(|limb| limb.socket_angle),
        )?;
        if signed_area(&base_points) * signed_area(platform.sockets()) < 0.0 {
            return Err(Error::OppositeSenses);
        }
        let limits = checked_limits(limits)?;
        let (min, max) = (limits.rod_min, limits.rod_max);
        if !(min..=max).contains(&finite("the working height", working_height)?) {
            return Err(Error::OutOfRange {
                what: "working height",
                value: working_height,
                min,
                max,
                unit: "m",
            });
        }
        let steepest = libm::tan(limits.tilt_max);
        let checks_limits = true;
        let ball_clearance = None;
        Ok(Self {
            #[cfg(feature = "std")]
            dimensions: Geometry::new(&base_points, &platform),
            base_points,
            platform,
            limits,
            working_height,
            steepest,
            checks_limits,
            ball_clearance,
        })
    }

    /// The robot of the paper: three sockets 120° apart on a radius of 93.218 mm, each over its rod.
    ///
    /// Tilt limit ±1.5° and stroke 508 mm are the paper's; that the rods run from 246 mm to 754 mm is our assumption.
    ///
    /// # Source
    /// \[Virtualization\], I and VI
    #[must_use]
    pub fn paper() -> Self {
        let limbs =
            [0.0_f64, 120.0, 240.0].map(|angle| Limb::under_socket(0.093218, angle.to_radians()));
        let limits = Limits { rod_min: 0.246, rod_max: 0.754, tilt_max: 1.5_f64.to_radians() };
        Self::new(limbs, limits, 0.5).expect("the paper's dimensions are valid")
    }

    /// Base points B_k in the base frame (m).
    #[must_use]
    pub fn base_points(&self) -> &[Vector2<f64>; 3] {
        &self.base_points
    }

    /// The platform's nominal sockets.
    #[must_use]
    pub fn platform(&self) -> &Platform {
        &self.platform
    }

    /// Limits of rods and tilt.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The robot with the same dimensions and limits, whose kinematics also answer beyond the limits.
    ///
    /// For analysis: [`Limits::broken`](super::Limits::broken) reports the limits that a pose breaks.
    #[must_use]
    pub fn without_limit_checks(&self) -> Self {
        Self { checks_limits: false, ..self.clone() }
    }

    /// Whether poses beyond the limits are refused.
    #[must_use]
    #[inline]
    pub fn checks_limits(&self) -> bool {
        self.checks_limits
    }

    /// Dimensions of the robot, for the kernels.
    #[cfg(feature = "std")]
    #[inline]
    pub(crate) fn dimensions(&self) -> &Geometry {
        &self.dimensions
    }

    /// tan of the largest tilt.
    #[inline]
    pub(crate) fn steepest(&self) -> f64 {
        self.steepest
    }

    /// The axis height at which the robot usually works (m).
    #[must_use]
    pub fn working_height(&self) -> f64 {
        self.working_height
    }

    /// The three limbs, as given to [`Self::new`].
    #[must_use]
    pub fn limbs(&self) -> [Limb; 3] {
        [0, 1, 2].map(|k| Limb {
            base_point: self.base_points[k],
            socket_radius: self.platform.radii()[k],
            socket_angle: self.platform.angles()[k],
        })
    }

    /// Ball centres P_k for rods of these lengths, in the base frame (m).
    #[must_use]
    #[inline]
    pub fn ball_centers(&self, rods: &[f64; 3]) -> [Vector3<f64>; 3] {
        let [b_1, b_2, b_3] = &self.base_points;
        [b_1.push(rods[0]), b_2.push(rods[1]), b_3.push(rods[2])]
    }
}

/// Sides L_12, L_23, L_31 of the triangle of the ball centres (m).
#[must_use]
#[inline]
pub fn ball_sides(ball_centers: &[Vector3<f64>; 3]) -> Sides {
    let [p_1, p_2, p_3] = ball_centers;
    [(p_2 - p_1).norm(), (p_3 - p_2).norm(), (p_1 - p_3).norm()]
}

/// Limits that are finite, in order, and below a right angle.
fn checked_limits(limits: Limits) -> Result<Limits, Error> {
    length("the shortest rod", limits.rod_min)?;
    length("the longest rod", limits.rod_max)?;
    if limits.rod_min >= limits.rod_max {
        return Err(Error::LimitsReversed {
            what: "rod",
            min: limits.rod_min,
            max: limits.rod_max,
        });
    }
    let right_angle = core::f64::consts::FRAC_PI_2;
    if !(finite("the largest tilt", limits.tilt_max)? > 0.0 && limits.tilt_max < right_angle) {
        return Err(Error::OutOfRange {
            what: "largest tilt",
            value: limits.tilt_max,
            min: 0.0,
            max: right_angle,
            unit: "rad",
        });
    }
    Ok(limits)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limbs() -> [Limb; 3] {
        Gpr::paper().limbs()
    }

    #[track_caller]
    fn check(limbs: [Limb; 3], limits: Limits, working_height: f64, message: &str) {
        let error = Gpr::new(limbs, limits, working_height).unwrap_err();
        assert_eq!(error.to_string(), message);
    }

    #[test]
    fn limbs_that_make_no_robot() {
        let limits = *Gpr::paper().limits();
        let with = |change: &dyn Fn(&mut [Limb; 3])| {
            let mut changed = limbs();
            change(&mut changed);
            changed
        };
        let bad = |change: &dyn Fn(&mut [Limb; 3]), message: &str| {
            check(with(change), limits, 0.5, message)
        };
        bad(
            &|limbs| limbs[1].base_point.x = f64::NAN,
            "a base point is NaN, but has to be a finite number",
        );
        bad(
            &|limbs| limbs[2].base_point.y = f64::INFINITY,
            "a base point is inf, but has to be a finite number",
        );
        bad(
            &|limbs| limbs[0].socket_radius = f64::NAN,
            "a socket radius is NaN, but has to be a finite number",
        );
        bad(
            &|limbs| limbs[0].socket_angle = f64::INFINITY,
            "a socket angle is inf, but has to be a finite number",
        );
        bad(
            &|limbs| limbs[2].socket_radius = 0.0,
            "the socket radius of limb 3 is 0 m, but has to be positive",
        );
        bad(
            &|limbs| limbs[0].socket_radius = -0.1,
            "the socket radius of limb 1 is -0.1 m, but has to be positive",
        );
        let on_one_line = |what: &str| {
            format!(
                "the three {what} lie on one line: their triangle is 0 times as high as it is long, at least 0.000001 is needed"
            )
        };
        let base_points = &|limbs: &mut [Limb; 3]| {
            limbs.iter_mut().for_each(|limb| limb.base_point.y = 0.1);
        };
        bad(base_points, &on_one_line("base points"));
        let sockets =
            &|limbs: &mut [Limb; 3]| limbs.iter_mut().for_each(|limb| limb.socket_angle = 1.0);
        bad(sockets, &on_one_line("sockets"));
        bad(
            &|limbs| limbs.iter_mut().for_each(|limb| limb.socket_angle *= -1.0),
            "base points and sockets run round in opposite senses: number the sockets in the order of the base points",
        );
    }

    #[test]
    fn limits_that_are_none() {
        let limits = *Gpr::paper().limits();
        let bad = |limits, height, message: &str| check(limbs(), limits, height, message);
        bad(
            Limits { rod_min: f64::NAN, ..limits },
            0.5,
            "the shortest rod is NaN, but has to be a finite number",
        );
        bad(
            Limits { rod_max: f64::INFINITY, ..limits },
            0.5,
            "the longest rod is inf, but has to be a finite number",
        );
        bad(
            Limits { rod_min: 0.8, ..limits },
            0.5,
            "the rod limits are reversed: least 0.8 m, most 0.754 m",
        );
        bad(
            Limits { rod_min: 0.754, ..limits },
            0.5,
            "the rod limits are reversed: least 0.754 m, most 0.754 m",
        );
        for tilt_max in [0.0, -0.1, std::f64::consts::FRAC_PI_2, 2.0] {
            bad(
                Limits { tilt_max, ..limits },
                0.5,
                &format!(
                    "the largest tilt is {tilt_max} rad, but has to lie from 0 to {} rad",
                    std::f64::consts::FRAC_PI_2
                ),
            );
        }
        bad(
            Limits { tilt_max: f64::NAN, ..limits },
            0.5,
            "the largest tilt is NaN, but has to be a finite number",
        );
        bad(limits, f64::NAN, "the working height is NaN, but has to be a finite number");
        bad(limits, 0.2, "the working height is 0.2 m, but has to lie from 0.246 to 0.754 m");
        bad(limits, 0.8, "the working height is 0.8 m, but has to lie from 0.246 to 0.754 m");
    }

    #[test]
    fn the_robot_of_the_paper() {
        let gpr = Gpr::paper();
        assert_eq!(gpr.working_height(), 0.5);
        assert!(gpr.platform().equally_spaced());
        let sides = ball_sides(&gpr.ball_centers(&[0.5; 3]));
        for side in sides {
            assert!((side - 0.093218 * 3.0_f64.sqrt()).abs() < 1e-16);
        }
        assert_eq!(Gpr::new(gpr.limbs(), *gpr.limits(), 0.5).unwrap(), gpr);
    }
}
