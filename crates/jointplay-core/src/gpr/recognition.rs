//! Mechanisms that are three-rod robots.

use nalgebra::{Isometry, Point3, Rotation3, Translation3, Unit, Vector3};

use super::{Gpr, Limb, Limits};
use crate::Error;
use crate::mechanism::{Joint, JointKind, Mechanism};
use crate::spatial::{Pose, tilt_rotation};

/// Largest angle between axes that count as parallel (rad): dimensions in files have round-off.
const PARALLEL: f64 = 1e-9;

/// Largest relative difference of two limits or clearances that count as equal.
const EQUAL: f64 = 1e-9;

/// A mechanism that is a three-rod robot: its closed forms and virtualizations apply to it.
#[derive(Debug, Clone, PartialEq)]
pub struct ThreeRodMechanism {
    /// The robot; its limb k has the kth prismatic joint of the mechanism.
    pub gpr: Gpr,
    /// The length of each rod as a function of the coordinates of the mechanism.
    pub rods: [RodCoordinate; 3],
    /// Index of the link that is the platform.
    pub platform: usize,
    /// The robot's base frame in that of the mechanism's base.
    pub link_from_base: Pose,
    /// The robot's platform frame in that of the mechanism's platform.
    pub link_from_platform: Pose,
}

/// The length of a rod: `sign * coordinate + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RodCoordinate {
    /// Index of the coordinate in the mechanism.
    pub index: usize,
    /// 1, or −1 where a positive coordinate shortens the rod.
    pub sign: f64,
    /// Length at the coordinate zero (m).
    pub offset: f64,
}

impl RodCoordinate {
    /// Length of the rod for a coordinate of the mechanism (m).
    #[must_use]
    pub fn length(&self, coordinate: f64) -> f64 {
        self.sign * coordinate + self.offset
    }

    /// Coordinate of the mechanism for a length of the rod (m).
    #[must_use]
    pub fn coordinate(&self, length: f64) -> f64 {
        self.sign * (length - self.offset)
    }
}

/// Why a mechanism is not a three-rod robot.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotThreeRods {
    /// Other joints than three prismatic and three spherical ones.
    #[error(
        "a three-rod robot has 3 prismatic and 3 spherical joints, but there are {prismatic} prismatic, {spherical} spherical and {other} other joints"
    )]
    Joints {
        /// Number of prismatic joints.
        prismatic: usize,
        /// Number of spherical joints.
        spherical: usize,
        /// Number of other joints.
        other: usize,
    },
    /// Joints that do not join base, rods and platform.
    #[error(
        "joint {joint:?} joins other links than a rod with the base, or a rod with the platform"
    )]
    Links {
        /// The joint.
        joint: String,
    },
    /// A rod that is not parallel to the first.
    #[error("joint {joint:?} is inclined by {angle:e} rad to the first rod, but rods are parallel")]
    NotParallel {
        /// The joint.
        joint: String,
        /// Angle between both axes (rad).
        angle: f64,
    },
    /// A rod without limits.
    #[error("joint {joint:?} has no limits, but a three-rod robot has limits of its rods")]
    NoLimits {
        /// The joint.
        joint: String,
    },
    /// Limits of rods that differ.
    #[error(
        "the rod of joint {joint:?} has limits from {min} to {max} m, but the first has others"
    )]
    UnequalLimits {
        /// The joint.
        joint: String,
        /// Shortest rod (m).
        min: f64,
        /// Longest rod (m).
        max: f64,
    },
    /// A spherical joint with limits.
    #[error("joint {joint:?} has limits, but the balls of a three-rod robot have none")]
    BallLimits {
        /// The joint.
        joint: String,
    },
    /// Clearances of balls that differ.
    #[error("joint {joint:?} has another clearance than the first ball")]
    UnequalClearances {
        /// The joint.
        joint: String,
    },
    /// Couplings of joints.
    #[error("the mechanism has {found} coupling{}, but a three-rod robot has none", if *found == 1 { "" } else { "s" })]
    Couplings {
        /// Number of couplings.
        found: usize,
    },
    /// Dimensions that define no robot.
    #[error(transparent)]
    Dimensions(#[from] Error),
}

impl Gpr {
    /// The robot that a mechanism describes.
    ///
    /// Its base frame is that of the base with e_b3 along the rods, and its platform frame that of the platform with e_p3 normal to the plane of the balls; both keep the link frame where it already is so.
    /// If O_p would be in a socket, the centroid of the sockets takes its place. Virtual joints of the mechanism are not regarded: a virtualization is chosen for each analysis.
    ///
    /// # Arguments
    /// * `tilt_max` – largest tilt toward any azimuth (rad), which a mechanism does not state
    ///
    /// # Errors
    /// [`NotThreeRods`].
    pub fn from_mechanism(
        mechanism: &Mechanism,
        tilt_max: f64,
    ) -> Result<ThreeRodMechanism, NotThreeRods> {
        let couplings = mechanism.couplings().len();
        if couplings > 0 {
            return Err(NotThreeRods::Couplings { found: couplings });
        }
        let limbs = limbs(mechanism)?;
        let up = upward(&limbs[0].base_axis);
        for limb in &limbs {
            let (sine, cosine) = (limb.base_axis.cross(&up).norm(), limb.base_axis.dot(&up));
            let angle = sine.atan2(cosine.abs());
            if angle > PARALLEL {
                let joint = limb.rod.name.clone();
                return Err(NotThreeRods::NotParallel { joint, angle });
            }
        }
        let link_from_base = Pose::from_parts(Translation3::identity(), rotation_to(&up));
        let balls = limbs.each_ref().map(|limb| link_from_base.inverse() * limb.ball_in_base);
        let rods = limbs.each_ref().map(|limb| limb.coordinate(&up));
        let rods = [0, 1, 2].map(|k| RodCoordinate { offset: balls[k].z, ..rods[k] });
        let link_from_platform = platform_frame(&limbs, &balls);
        let sockets = limbs
            .each_ref()
            .map(|limb| (link_from_platform.inverse() * limb.ball_in_platform).coords.xy());
        let described = [0, 1, 2].map(|k| Limb {
            base_point: balls[k].coords.xy(),
            socket_radius: sockets[k].norm(),
            socket_angle: sockets[k].y.atan2(sockets[k].x),
        });
        let [rod_min, rod_max] = rod_limits(&limbs, &rods)?;
        let at_zero = rods.iter().map(|rod| rod.offset / 3.0).sum::<f64>();
        let height = at_zero.clamp(rod_min, rod_max.max(rod_min));
        let gpr = Self::new(described, Limits { rod_min, rod_max, tilt_max }, height)?;
        let gpr = match clearance(&limbs)? {
            Some(radius) => gpr.with_ball_clearance(radius)?,
            None => gpr,
        };
        let platform = limbs[0].platform;
        Ok(ThreeRodMechanism { gpr, rods, platform, link_from_base, link_from_platform })
    }
}

/// A rod with its ball, at the coordinate zero.
struct RodAndBall<'a> {
    rod: &'a Joint,
    ball: &'a Joint,
    /// Index of the coordinate of the rod.
    coordinate: usize,
    /// Direction in which the rod moves for a positive coordinate, in the base frame.
    base_axis: Vector3<f64>,
    /// Centre of the ball in the base frame (m).
    ball_in_base: Point3<f64>,
    /// Index of the platform link.
    platform: usize,
    /// Centre of the ball in the frame of the platform link (m).
    ball_in_platform: Point3<f64>,
}

impl RodAndBall<'_> {
    fn coordinate(&self, up: &Unit<Vector3<f64>>) -> RodCoordinate {
        let sign = self.base_axis.dot(up).signum();
        RodCoordinate { index: self.coordinate, sign, offset: 0.0 }
    }
}

/// The three rods in the order of their joints, each with its ball.
fn limbs<'a>(mechanism: &'a Mechanism) -> Result<[RodAndBall<'a>; 3], NotThreeRods> {
    let joints = mechanism.joints();
    let of_kind = |kind: JointKind| joints.iter().filter(move |joint| joint.kind == kind);
    let balls: Vec<&Joint> = of_kind(JointKind::Spherical).collect();
    let (prismatic, spherical) = (of_kind(JointKind::Prismatic).count(), balls.len());
    let other = joints.len() - prismatic - spherical;
    let mut first = 0;
    let mut found = Vec::new();
    for joint in joints {
        if joint.kind == JointKind::Prismatic {
            found.push((joint, first));
        }
        first += joint.kind.freedoms();
    }
    let ([a, b, c], 3, 0) = (found.as_slice(), spherical, other) else {
        return Err(NotThreeRods::Joints { prismatic, spherical, other });
    };
    let elsewhere = |joint: &Joint| NotThreeRods::Links { joint: joint.name.clone() };
    let limb = |&(rod, coordinate): &(&'a Joint, usize)| -> Result<RodAndBall<'a>, NotThreeRods> {
        let (link, base_from_rod, base_axis) = rod_at_zero(rod).ok_or_else(|| elsewhere(rod))?;
        let ball = balls.iter().find(|ball| ball.links.contains(&link));
        let ball = *ball.ok_or_else(|| elsewhere(rod))?;
        let side = usize::from(ball.links[1] == link);
        let at = |side: usize| Point3::from(ball.frames[side].translation.vector);
        Ok(RodAndBall {
            rod,
            ball,
            coordinate,
            base_axis,
            ball_in_base: base_from_rod * at(side),
            platform: ball.links[1 - side],
            ball_in_platform: at(1 - side),
        })
    };
    let limbs = [limb(a)?, limb(b)?, limb(c)?];
    // Five links: no two rods are one, and one platform joins all.
    for limb in &limbs {
        if limb.platform != limbs[0].platform || limb.platform == 0 || mechanism.links().len() != 5
        {
            return Err(elsewhere(limb.ball));
        }
    }
    Ok(limbs)
}

/// The link of a rod, its pose at the coordinate zero, and its direction; `None` for a joint that is not at the base.
fn rod_at_zero(rod: &Joint) -> Option<(usize, Pose, Vector3<f64>)> {
    let [first, second] = rod.frames;
    let axis = |frame: &Pose| frame.rotation * Vector3::z();
    match rod.links {
        [0, link] => Some((link, first * second.inverse(), axis(&first))),
        [link, 0] => Some((link, second * first.inverse(), -axis(&second))),
        _ => None,
    }
}

/// The direction of the rods that is up: e_b3 where they are along it, else that of the first rod.
fn upward(axis: &Vector3<f64>) -> Unit<Vector3<f64>> {
    let z = Vector3::z_axis();
    if axis.cross(&z).norm() > PARALLEL {
        return Unit::new_normalize(*axis);
    }
    z
}

/// A rotation that carries e_3 onto a direction, the shortest where there is one.
fn rotation_to(direction: &Unit<Vector3<f64>>) -> Rotation3<f64> {
    if direction.z < -0.5 {
        let turned = Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
        return tilt_rotation(&-direction.into_inner()) * turned;
    }
    tilt_rotation(direction)
}

/// The robot's platform frame in that of the platform link.
///
/// # Arguments
/// * `balls` – centres of the balls in the robot's base frame, which define the sense of the triangle (m)
fn platform_frame(limbs: &[RodAndBall<'_>; 3], balls: &[Point3<f64>; 3]) -> Pose {
    let [p_1, p_2, p_3] = limbs.each_ref().map(|limb| limb.ball_in_platform);
    let area = (balls[1] - balls[0]).xy().perp(&(balls[2] - balls[0]).xy());
    let normal = (p_2 - p_1).cross(&(p_3 - p_1)) * area.signum();
    // Sockets on one line are an error of the dimensions.
    let normal = Unit::try_new(normal, 0.0).unwrap_or(Vector3::z_axis());
    let rotation = rotation_to(&normal);
    let height = p_1.coords.dot(&normal);
    let origin = normal.into_inner() * height;
    let centroid = (p_1.coords + p_2.coords + p_3.coords) / 3.0;
    let size = (p_1.coords - centroid).norm();
    let in_socket = [p_1, p_2, p_3].iter().any(|p| (p.coords - origin).norm() < EQUAL * size);
    let origin = if in_socket { centroid } else { origin };
    Isometry::from_parts(Translation3::from(origin), rotation)
}

/// Shortest and longest rod (m).
fn rod_limits(
    limbs: &[RodAndBall<'_>; 3],
    rods: &[RodCoordinate; 3],
) -> Result<[f64; 2], NotThreeRods> {
    let mut first = None;
    for (limb, rod) in limbs.iter().zip(rods) {
        let joint = limb.rod.name.clone();
        let limits = limb.rod.limits.first().filter(|ends| ends.iter().all(|end| end.is_finite()));
        let [Some(a), Some(b)] = [0, 1].map(|end| Some(rod.length(limits?[end]))) else {
            return Err(NotThreeRods::NoLimits { joint });
        };
        let (min, max) = (a.min(b), a.max(b));
        let [least, greatest] = *first.get_or_insert([min, max]);
        let allowed = EQUAL * (greatest - least);
        if (min - least).abs() > allowed || (max - greatest).abs() > allowed {
            return Err(NotThreeRods::UnequalLimits { joint, min, max });
        }
    }
    first.ok_or_else(|| NotThreeRods::NoLimits { joint: limbs[0].rod.name.clone() })
}

/// Clearance of the balls as a radius, if stated (m).
fn clearance(limbs: &[RodAndBall<'_>; 3]) -> Result<Option<f64>, NotThreeRods> {
    let first = limbs[0].ball.clearance.linear;
    for limb in limbs {
        let joint = limb.ball.name.clone();
        if !limb.ball.limits.is_empty() {
            return Err(NotThreeRods::BallLimits { joint });
        }
        let equal = match (first, limb.ball.clearance.linear) {
            (Some(a), Some(b)) => (a - b).abs() <= EQUAL * a,
            (a, b) => a == b,
        };
        if !equal {
            return Err(NotThreeRods::UnequalClearances { joint });
        }
    }
    Ok(first)
}
