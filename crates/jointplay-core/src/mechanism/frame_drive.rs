//! Driving frames of links along paths.

use nalgebra::{DVector, Rotation3, Translation3, Vector3};

use super::frame_path::{FramePath, MeasuredPath};
use super::limits::{BeyondLimits, ROUND_OFF};
use super::motion::{DriveProblem, STEP_THRESHOLD};
use super::{
    Closure, CommandedJoints, DrivePath, DrivenMotion, Joint, JointKind, LinearAndAngular,
    Mechanism, MechanismSystem, Relief, ReliefSolver, Stop, relieve,
};
use crate::Error;
use crate::constraint::System as _;
use crate::spatial::Pose;

/// Joints of the chain that measures one frame.
const CHAIN: usize = 6;
/// Halvings of the step in which a motion stops.
const HALVINGS: usize = 24;

/// Drives frames of links along commanded poses; everything else moves least.
///
/// Virtual joints take their least displacement; among the configurations with it, the actuated coordinates are as near as possible to home, in radians and characteristic lengths, and then all other coordinates.
/// Where this leaves joint limits, coordinates stop at them, and the others compensate.
///
/// # Arguments
/// * `home` – closed, virtual joints at rest
/// * `start` – (f + M) where the motion begins, near the first targets (m, rad)
/// * `paths` – of different frames, all with the same number of targets
/// * `progress` – called with the number of points done after each
///
/// # Errors
/// [`Error::LengthMismatch`] for no path, or for paths or targets that do not agree; [`Error::OutOfRange`] for a tilt beyond 80° across the axis of the largest one; those of [`CommandedJoints::new`].
/// A motion that stops is not an error: see [`DrivenMotion::stopped`]; its last waypoint is then the last configuration that is possible, before the first that is not.
///
/// # Numerics
/// Each frame is joined to the base by six joints that constrain nothing and measure its pose; these are the driven joints.
/// Coordinates at their limits are found one after the other, and are not released again at the same point.
pub fn drive_frames(
    home: &MechanismSystem<'_>,
    start: &DVector<f64>,
    paths: &[FramePath],
    progress: &mut dyn FnMut(usize),
) -> Result<DrivenMotion, Error> {
    let expected = paths.first().map_or(2, |path| path.targets.len());
    for path in paths {
        let what = "the targets of a frame";
        if path.targets.len() != expected {
            return Err(Error::LengthMismatch { what, found: path.targets.len(), expected });
        }
    }
    let measured = Measured::new(home, paths)?;
    let at_home = measured.system(home, home.home())?;
    let free = measured.free();
    let commanded = CommandedJoints::new(&at_home, measured.path.coordinates())?
        .with_least(&measured.mechanism.actuated_coordinates());
    let run = DriveProblem::new(&at_home, &measured.path, &free);
    let mut here = measured.coordinates(start);
    let mut motion =
        DrivenMotion { waypoints: Vec::new(), singular: Vec::new(), stopped: None, steps: 0 };
    let mut regular_rank = None;
    let segments = measured.path.segments();
    let mut waypoint = |share: f64, found: &Relief| {
        let closed = Closure {
            coordinates: found.coordinates.clone(),
            residual: found.residual,
            iterations: found.iterations,
            is_searched: false,
        };
        let decomposition = run.decomposed(&closed.coordinates)?;
        let rank = *regular_rank.get_or_insert_with(|| decomposition.rank(STEP_THRESHOLD));
        let mut waypoint = run.waypoint(share, closed, &decomposition, rank);
        waypoint.coordinates = measured.original(&waypoint.coordinates);
        Ok::<_, Error>(waypoint)
    };
    #[expect(clippy::cast_precision_loss, reason = "counts of points")]
    for k in 0..=segments {
        let share = k as f64 / segments as f64;
        match measured.solve(&at_home, &commanded, &here, share)? {
            Ok(found) => {
                motion.waypoints.push(waypoint(share, &found)?);
                here = found.coordinates;
            }
            Err(mut stop) => {
                // The last place that is possible.
                let (mut low, mut high) = ((k.max(1) - 1) as f64 / segments as f64, share);
                let mut last = None;
                for _ in 0..if k == 0 { 0 } else { HALVINGS } {
                    let middle = 0.5 * (low + high);
                    match measured.solve(&at_home, &commanded, &here, middle)? {
                        Ok(found) => {
                            low = middle;
                            here.copy_from(&found.coordinates);
                            last = Some(found);
                        }
                        Err(reason) => (high, stop) = (middle, reason),
                    }
                }
                if let Some(found) = last {
                    motion.waypoints.push(waypoint(low, &found)?);
                }
                motion.stopped = Some(stop);
                break;
            }
        }
        motion.steps = k;
        progress(k + 1);
    }
    Ok(motion)
}

/// The mechanism with chains that measure frames; its joints come last.
struct Measured {
    mechanism: Mechanism,
    /// Coordinates of joints of the original mechanism.
    joints: usize,
    /// Coordinates of the chains.
    chains: usize,
    path: DrivePath,
    characteristic_length: f64,
}

impl Measured {
    fn new(home: &MechanismSystem<'_>, paths: &[FramePath]) -> Result<Self, Error> {
        let mechanism = home.kinematics().mechanism();
        let links_at_home = home.kinematics().link_poses(home.home())?;
        let (mut links, mut joints) = (mechanism.links().to_vec(), mechanism.joints().to_vec());
        let f = mechanism.joint_freedoms();
        let mut coordinates = Vec::new();
        let count = paths.first().map_or(0, |path| path.targets.len());
        let mut points = vec![Vec::new(); count];
        for (n, path) in paths.iter().enumerate() {
            let pose = home.kinematics().frame_pose(path.frame, &links_at_home);
            let measured = MeasuredPath::new(path, &pose)?;
            let link = mechanism.link_of_frame(path.frame);
            let on_link = mechanism.link_from_frame(path.frame);
            chain(&mut links, &mut joints, n, [&pose, &on_link], &measured.axes, link);
            let first = f + CHAIN * n;
            let commanded = measured.commanded.into_iter().enumerate();
            coordinates.extend(commanded.filter_map(|(k, one)| one.then_some(first + k)));
            for (all, own) in points.iter_mut().zip(measured.points) {
                all.extend(own);
            }
        }
        let path = DrivePath::through(coordinates, points)?;
        let valid = "links and joints in addition to a valid mechanism";
        let characteristic_length = home.characteristic_length();
        let measured = Mechanism::new(mechanism.name().to_owned(), links, joints)
            .and_then(|made| made.with_virtual_joints(mechanism.virtual_joints().to_vec()))
            .and_then(|made| made.with_couplings(mechanism.couplings().to_vec()))
            .and_then(|made| made.with_characteristic_length(characteristic_length))
            .expect(valid);
        let chains = CHAIN * paths.len();
        Ok(Self { mechanism: measured, joints: f, chains, path, characteristic_length })
    }

    /// Coordinates of the measured mechanism, the chains at home.
    fn coordinates(&self, original: &DVector<f64>) -> DVector<f64> {
        let virtuals = original.len() - self.joints;
        let mut all = DVector::zeros(original.len() + self.chains);
        all.rows_mut(0, self.joints).copy_from(&original.rows(0, self.joints));
        let first = self.joints + self.chains;
        all.rows_mut(first, virtuals).copy_from(&original.rows(self.joints, virtuals));
        all
    }

    /// Coordinates of the original mechanism.
    fn original(&self, all: &DVector<f64>) -> DVector<f64> {
        let chain = self.joints..self.joints + self.chains;
        let kept = all.iter().enumerate().filter(|(k, _)| !chain.contains(k));
        DVector::from_vec(kept.map(|(_, &value)| value).collect())
    }

    fn system(
        &self,
        home: &MechanismSystem<'_>,
        at: &DVector<f64>,
    ) -> Result<MechanismSystem<'_>, Error> {
        debug_assert_eq!(home.home().len(), at.len());
        MechanismSystem::new(&self.mechanism, self.coordinates(at))?
            .with_characteristic_length(self.characteristic_length)
    }

    /// Joint coordinates that are not commanded.
    fn free(&self) -> Vec<usize> {
        let driven = self.path.coordinates();
        (0..self.joints + self.chains).filter(|k| !driven.contains(k)).collect()
    }

    /// The configuration at a share of the path within joint limits, or why there is none.
    fn solve(
        &self,
        at_home: &MechanismSystem<'_>,
        commanded: &CommandedJoints,
        near: &DVector<f64>,
        share: f64,
    ) -> Result<Result<Relief, Stop>, Error> {
        let mut values: Vec<f64> = self.path.values_at(share).map(|(_, value)| value).collect();
        let mut commanded = commanded.clone();
        loop {
            let mut start = near.clone();
            for (&k, &value) in commanded.coordinates().iter().zip(&values) {
                start[k] = value;
            }
            let f = self.joints + self.chains;
            start.rows_mut(f, near.len() - f).fill(0.0);
            let found =
                match relieve(&at_home.with_home(start)?, &commanded, ReliefSolver::LeastNorm) {
                    Ok(found) => found,
                    Err(Error::NotRelieved { .. }) => return Ok(Err(Stop::Incompatible)),
                    Err(Error::NotLeast { .. }) => return Ok(Err(Stop::NotLeast)),
                    Err(other) => return Err(other),
                };
            let joints = found.coordinates.rows(0, self.joints).into_owned();
            let beyond = self.mechanism.beyond_limits(&joints);
            let Some((worst, limit)) = worst(&beyond) else { return Ok(Ok(found)) };
            // At its limit, unless that takes displacement of virtual joints instead of freedom.
            let mut coordinates = commanded.coordinates().to_vec();
            coordinates.push(worst);
            let held = CommandedJoints::new(at_home, &coordinates)?
                .with_least(&self.mechanism.actuated_coordinates());
            if held.undetermined() >= commanded.undetermined() {
                return Ok(Err(Stop::BeyondLimits { coordinate: worst }));
            }
            commanded = held;
            values.push(limit);
        }
    }
}

/// The coordinate that is beyond its limits by the largest share of its range, and the limit; the first of several that differ by round-off.
fn worst(beyond: &[BeyondLimits]) -> Option<(usize, f64)> {
    let largest = beyond.iter().map(BeyondLimits::share).fold(0.0, f64::max);
    let worst = beyond.iter().find(|one| one.share() >= largest - ROUND_OFF)?;
    Some((worst.coordinate, worst.nearest()))
}

/// Appends six joints between the base and a link: slides along x, y, z of the base, turns about x, y, z of the axes.
///
/// # Arguments
/// * `poses` – the frame at home in the base frame, and on its link (m)
fn chain(
    links: &mut Vec<String>,
    joints: &mut Vec<Joint>,
    n: usize,
    [home, on_link]: [&Pose; 2],
    axes: &Rotation3<f64>,
    link: usize,
) {
    // The joint frame of each: at the origin of the frame, z along its axis.
    let along = |direction: Vector3<f64>| {
        let rotation = Rotation3::rotation_between(&Vector3::z(), &direction);
        rotation
            .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
    };
    let base = [Vector3::x(), Vector3::y(), Vector3::z()];
    let steps = base
        .map(|axis| (JointKind::Prismatic, axis))
        .into_iter()
        .chain(base.map(|axis| (JointKind::Revolute, axes * axis)));
    let mut from = 0;
    for (k, (kind, direction)) in steps.enumerate() {
        let to = if k + 1 == CHAIN { link } else { links.len() };
        if k + 1 < CHAIN {
            links.push(format!("measured {n}, link {k}"));
        }
        let turned = Pose::from_parts(Translation3::identity(), along(direction));
        // Frames of the links between are parallel to the base, at the origin of the frame.
        let first =
            if k == 0 { Pose::from_parts(home.translation, turned.rotation) } else { turned };
        let second = if k + 1 == CHAIN {
            on_link * Pose::from_parts(Translation3::identity(), home.rotation.inverse()) * turned
        } else {
            turned
        };
        joints.push(Joint {
            name: format!("measured {n}, joint {k}"),
            kind,
            links: [from, to],
            frames: [first, second],
            actuated: false,
            guess: Vec::new(),
            limits: Vec::new(),
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        });
        from = to;
    }
}
