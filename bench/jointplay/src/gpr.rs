//! Positions of the three-rod robot with polar virtual joints, for given rods, each from nominal.

use std::cell::Cell;
use std::fmt::Write as _;
use std::hint::black_box;

use jointplay::bulk::PoseSolver;
use jointplay::format::{catalogue, mechanism as file, robot};
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::mechanism::{
    Carrier, Kinematics, Mechanism, MechanismSystem, PositionSolver, ReliefSolver, VirtualJoint,
    VirtualMotion,
};
use jointplay::nalgebra::{DVector, Unit, Vector3};
use jointplay::spatial::{Pose, Tilt};
use jointplay::virtualization::{BuiltIn, Metric, SolveOptions, Solver};

use crate::work::Work;

/// Height of the platform plane on the base axis (m).
pub(crate) const HEIGHT: f64 = 0.5;
/// ρ of the metric in which virtual joints are least (m).
const METRIC: f64 = 1e-3;
/// Largest gap between a socket and its ball that counts as solved (m).
const GAP: f64 = 1e-12;
/// Coordinates of the rods in the graph.
pub(crate) const RODS: [usize; 3] = [0, 1, 2];

/// The robot of the catalogue.
pub(crate) fn robot() -> Gpr {
    let entry = catalogue::find("gpr").expect("the catalogue has the robot");
    robot::parse(entry.text).expect("catalogue files can be read").gpr.without_limit_checks()
}

/// Every tilt: 360 azimuths, 20 tilt angles either side of level, none at it.
pub(crate) fn tilts() -> impl Iterator<Item = Tilt> {
    let tilt_angles = (-20..=20).filter(|&step| step != 0);
    let steps = (0..360)
        .flat_map(move |azimuth| tilt_angles.clone().map(move |tilt_angle| (azimuth, tilt_angle)));
    steps.map(|(azimuth, tilt_angle)| Tilt {
        azimuth: f64::from(azimuth).to_radians(),
        angle: (f64::from(tilt_angle) / 10.0).to_radians(),
    })
}

/// The rods of every tilt.
pub(crate) fn rods() -> Vec<[f64; 3]> {
    let gpr = robot();
    let rods =
        tilts().map(|tilt| gpr.inverse(tilt, AxisHeight(HEIGHT)).expect("tilts of 2° are reached"));
    rods.collect()
}

/// The work as text: sockets, metric, height, then the rods of each pose.
pub(crate) fn text() -> String {
    let gpr = robot();
    let rods = rods();
    let mut text = String::new();
    for k in 0..3 {
        let (radius, direction) = (gpr.platform().radii()[k], gpr.platform().directions()[k]);
        let base = gpr.base_points()[k];
        writeln!(text, "{radius} {} {} {} {}", direction.x, direction.y, base.x, base.y)
            .expect("text grows");
    }
    writeln!(text, "{METRIC} {HEIGHT} {GAP} {}", rods.len()).expect("text grows");
    for [a, b, c] in rods {
        writeln!(text, "{a} {b} {c}").expect("text grows");
    }
    text
}

/// Options with the tolerance as a share of the longest side, and the metric.
pub(crate) fn options(gpr: &Gpr, solver: Solver) -> SolveOptions {
    let side = gpr.platform().mean_radius() * 3_f64.sqrt();
    SolveOptions {
        solver,
        metric: Metric::Length(METRIC),
        relative_threshold: GAP / side,
        ..SolveOptions::default()
    }
}

/// The robot with polar virtual joints, prepared once.
fn prepared(solver: Solver) -> PoseSolver {
    let gpr = robot();
    PoseSolver::new(&gpr, BuiltIn::Polar, &options(&gpr, solver)).expect("the metric is valid")
}

/// A pose and its virtual joints, as other programs report them too.
pub(crate) type Answer = (Pose, [f64; 6]);

pub(crate) fn numbers((pose, virtual_joints): &Answer) -> Vec<f64> {
    let rotation = pose.rotation.matrix().transpose();
    rotation.iter().chain(pose.translation.vector.iter()).chain(virtual_joints).copied().collect()
}

/// The robot's own equations, pose by pose.
pub(crate) struct Own {
    solver: PoseSolver,
    rods: Vec<[f64; 3]>,
    answers: Vec<Option<Answer>>,
}

impl Own {
    pub(crate) fn new(solver: Solver) -> Self {
        Self { solver: prepared(solver), rods: rods(), answers: Vec::new() }
    }
}

impl Work for Own {
    fn solve(&mut self) -> usize {
        self.answers.clear();
        self.answers.extend(self.rods.iter().map(|&rods| {
            // By reference: a pose with all that belongs to it is not copied.
            let forward = &self.solver.forward(rods);
            let forward = forward.as_ref().ok()?;
            let mut virtual_joints = [0.0; 6];
            virtual_joints.copy_from_slice(&forward.solution.virtual_joints);
            Some((forward.base_from_platform, virtual_joints))
        }));
        self.answers.iter().flatten().count()
    }

    fn call(&mut self, times: usize) -> Option<usize> {
        let waiting = Waiting::default();
        let solved = self.rods.iter().cycle().take(times).filter(|rods| {
            let forward = self.solver.forward(waiting.after(rods));
            forward.is_ok_and(|found| waiting.record(found.base_from_platform.translation.x))
        });
        Some(solved.count())
    }

    fn answers(&self) -> Vec<Option<Vec<f64>>> {
        self.answers.iter().map(|answer| answer.as_ref().map(numbers)).collect()
    }
}

/// Its virtual joints alone, pose by pose, without placing the platform.
pub(crate) struct JointsAlone {
    solver: PoseSolver,
    rods: Vec<[f64; 3]>,
    answers: Vec<Option<[f64; 6]>>,
}

impl JointsAlone {
    pub(crate) fn new(solver: Solver) -> Self {
        Self { solver: prepared(solver), rods: rods(), answers: Vec::new() }
    }

    #[inline]
    fn one(&self, rods: &[f64; 3]) -> Option<[f64; 6]> {
        let found = self.solver.virtual_joints(*rods).ok()?;
        let mut virtual_joints = [0.0; 6];
        virtual_joints.copy_from_slice(&found.virtual_joints);
        Some(virtual_joints)
    }
}

impl Work for JointsAlone {
    fn solve(&mut self) -> usize {
        let mut answers = std::mem::take(&mut self.answers);
        answers.clear();
        answers.extend(self.rods.iter().map(|rods| self.one(rods)));
        self.answers = answers;
        self.answers.iter().flatten().count()
    }

    fn call(&mut self, times: usize) -> Option<usize> {
        let waiting = Waiting::default();
        let solved = self.rods.iter().cycle().take(times).filter(|rods| {
            self.one(&waiting.after(rods)).is_some_and(|found| waiting.record(found[0]))
        });
        Some(solved.count())
    }

    fn answers(&self) -> Vec<Option<Vec<f64>>> {
        self.answers.iter().map(|answer| answer.map(|numbers| numbers.to_vec())).collect()
    }
}

/// Makes a call wait for the answer of the call before, as in a control loop: adds nothing of it, which the processor does not know.
struct Waiting {
    nothing: f64,
    last: Cell<f64>,
}

impl Default for Waiting {
    fn default() -> Self {
        Self { nothing: black_box(0.0), last: Cell::new(0.0) }
    }
}

impl Waiting {
    fn after(&self, rods: &[f64; 3]) -> [f64; 3] {
        rods.map(|rod| rod + self.nothing * self.last.get())
    }

    fn record(&self, answer: f64) -> bool {
        self.last.set(answer);
        true
    }
}

/// The same robot as a graph of links and joints, which knows nothing of its equations.
pub(crate) struct General {
    mechanism: Mechanism,
    rest: DVector<f64>,
    solver: PositionSolver,
    relief: ReliefSolver,
    rods: Vec<[f64; 3]>,
    answers: Vec<Option<DVector<f64>>>,
}

/// The graph, with a turn about the platform's middle and then a radial slide at each ball.
pub(crate) fn graph() -> Mechanism {
    let entry = catalogue::find("gpr-mechanism").expect("the catalogue has the graph");
    let mechanism = file::parse(entry.text).expect("catalogue files can be read").mechanism;
    let gpr = robot();
    let pairs = (0..3).flat_map(|k| {
        let joint = mechanism.joint(&format!("S{}", k + 1)).expect("three balls");
        let out = gpr.platform().directions()[k];
        let virtual_joint = |name: &str, motion, stiffness| VirtualJoint {
            name: format!("{name}{}", k + 1),
            joint,
            carrier: Carrier::Second,
            motion,
            clearance: None,
            stiffness: Some(stiffness),
        };
        let middle = Vector3::new(0.0, 0.0, HEIGHT);
        [
            virtual_joint(
                "phi",
                VirtualMotion::Turn { axis: Vector3::z_axis(), point: middle },
                METRIC * METRIC,
            ),
            virtual_joint(
                "l",
                VirtualMotion::Slide(Unit::new_normalize(Vector3::new(out.x, out.y, 0.0))),
                1.0,
            ),
        ]
    });
    let pairs = pairs.collect();
    mechanism.with_virtual_joints(pairs).expect("these are virtual joints")
}

impl General {
    pub(crate) fn new(relief: ReliefSolver) -> Self {
        let mechanism = graph();
        let rest = DVector::zeros(mechanism.joint_freedoms() + mechanism.virtual_joints().len());
        let system = MechanismSystem::new(&mechanism, rest.clone()).expect("a small mechanism");
        let solver = PositionSolver::new(&system, &RODS).expect("rods are no balls");
        Self { mechanism, rest, solver, relief, rods: rods(), answers: Vec::new() }
    }
}

impl Work for General {
    fn solve(&mut self) -> usize {
        self.answers.clear();
        self.answers.extend(self.rods.iter().map(|rods| {
            let mut coordinates = self.rest.clone();
            RODS.iter().zip(rods).for_each(|(&k, rod)| coordinates[k] = rod - HEIGHT);
            self.solver.solve(coordinates.as_mut_slice(), self.relief).ok()?;
            Some(coordinates)
        }));
        self.answers.iter().flatten().count()
    }

    fn call(&mut self, times: usize) -> Option<usize> {
        let waiting = Waiting::default();
        let mut coordinates = self.rest.clone();
        let mut solved = 0;
        for rods in self.rods.iter().cycle().take(times) {
            coordinates.copy_from(&self.rest);
            let rods = waiting.after(rods);
            RODS.iter().zip(&rods).for_each(|(&k, rod)| coordinates[k] = rod - HEIGHT);
            if self.solver.solve(coordinates.as_mut_slice(), self.relief).is_ok() {
                waiting.record(coordinates[coordinates.len() - 1]);
                solved += 1;
            }
        }
        Some(solved)
    }

    fn answers(&self) -> Vec<Option<Vec<f64>>> {
        let mechanism = &self.mechanism;
        let kinematics = Kinematics::new(mechanism);
        let platform = mechanism.link("platform").expect("the graph has a platform");
        let radii = *robot().platform().radii();
        let answers = self.answers.iter().map(|coordinates| {
            let coordinates = coordinates.as_ref()?;
            let x = coordinates.rows(mechanism.joint_freedoms(), 6);
            let mut pose = kinematics.link_poses(coordinates).ok()?[platform];
            pose.translation.vector += pose.rotation * Vector3::new(0.0, 0.0, HEIGHT);
            let l = [0, 1, 2].map(|k| radii[k] + x[2 * k + 1]);
            Some(numbers(&(pose, [l[0], l[1], l[2], x[0], x[2], x[4]])))
        });
        answers.collect()
    }
}
