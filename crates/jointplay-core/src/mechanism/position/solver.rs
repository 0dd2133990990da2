//! The solver for positions.

use nalgebra::Matrix3;

use super::bordered::{Bordered, EliminationPlan};
use super::frame::Frame;
use super::opening::{Closing, Meeting, TreeEdge, moved_by};
use super::unknown::{Ball, CoupledRow, Unknown};
use super::walk::{Part, Screw, Turned, Walk};
use crate::Error;
use crate::constraint::{CLOSURE_TOLERANCE, System};
use crate::mechanism::coupling_rows::coupling_rows;
use crate::mechanism::joint::Factor;
use crate::mechanism::kinematics::Element;
use crate::mechanism::tree::spanning_tree;
use crate::mechanism::{MechanismSystem, ReliefSolver, virtual_weights};
use crate::spatial::Pose;

/// Scaled residual at which the iteration ends; the next step would only move round-off.
pub(super) const ROUND_OFF: f64 = 1e-13;
/// Changes of the virtual joints below this, in units of their metric, are the end of the search for the least…
const SETTLED: f64 = 1e-13;
/// …and so are those below this that no longer shrink: round-off.
const SETTLING: f64 = 1e-9;
/// Longest step, in radians and characteristic lengths.
pub(super) const LONGEST_STEP: f64 = 0.5;
const MAX_ITERATIONS: usize = 50;

/// Closes the loops of a mechanism for commanded coordinates, its couplings included, again and again.
///
/// Everything that does not depend on the coordinates is laid out once; a solution allocates nothing.
/// Loops are opened where most freedoms pass: a ball leaves three equations between two points, a hinge five between two axes, and its own coordinates follow.
///
/// One solver serves one thread; clone it for more.
///
/// # Numerics
/// Newton's method with passive joints eliminated by Householder reflections and virtual joints by least norm.
/// Redundant constraints do not stop it.
/// It is meant for starts nearby, as along a path: steps are shortened, but there is no search; [`crate::mechanism::close`] and [`crate::mechanism::assemble`] converge from farther.
///
/// # Source
/// Own derivation, `docs/explanation/mechanisms.md`
#[derive(Debug, Clone)]
pub struct PositionSolver {
    pub(super) tree: Vec<TreeEdge>,
    pub(super) closings: Vec<Closing>,
    pub(super) couplings: Vec<CoupledRow>,
    pub(super) balls: Vec<Ball>,
    pub(super) unknowns: Vec<Unknown>,
    pub(super) passive: usize,
    pub(super) length: f64,
    // Room to work in.
    start: Vec<f64>,
    /// Where walks start: of each link the frame behind its joint of the tree, then frames that are fixed to the base.
    pub(super) frames: Vec<Frame>,
    /// (links) the frame of each link in the one behind its joint of the tree.
    placed: Vec<Pose>,
    pub(super) turns: Vec<Turned>,
    /// How each ball is turned.
    pub(super) orientations: Vec<Matrix3<f64>>,
    pub(super) screws: Vec<Screw>,
    pub(super) relieved: Vec<f64>,
    pub(super) elimination: Bordered,
    /// The order of elimination where the solver was laid out; none where virtual joints are displaced.
    pub(super) plan: Option<EliminationPlan>,
}

/// Loops closed for commanded coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Position {
    /// Largest mismatch, in radians and characteristic lengths.
    pub residual: f64,
    /// Steps done.
    pub iterations: usize,
}

/// How an iteration ended.
struct Run {
    residual: f64,
    /// Whether the virtual joints no longer change.
    settled: bool,
    iterations: usize,
    /// After how many steps it was best, and the residual there; infinite where there was none.
    best: (usize, f64),
}

impl PositionSolver {
    /// Lays out the solution for given commanded coordinates.
    ///
    /// # Arguments
    /// * `system` – gives the mechanism, the characteristic length and the metric of the virtual joints
    /// * `commanded` – indices of the coordinates that keep their values, among those of joints and virtual joints
    ///
    /// # Errors
    /// [`Error::PartlyCommanded`] for one or two coordinates of a ball, [`Error::NoSuchQuantity`] for an index of no coordinate.
    pub fn new(system: &MechanismSystem<'_>, commanded: &[usize]) -> Result<Self, Error> {
        let mut solver = Self::lay_out(system, commanded, &[])?;
        if solver.relieved.is_empty() {
            let home = system.home().as_slice();
            solver.orient(home);
            solver.mismatch(home);
            solver.linearize();
            solver.plan = Some(solver.elimination.plan());
        }
        Ok(solver)
    }

    /// Lays out the solution, with the screws of some commanded coordinates behind those of the unknowns.
    ///
    /// # Arguments
    /// * `recorded` – indices of these coordinates, ascending
    pub(super) fn lay_out(
        system: &MechanismSystem<'_>,
        commanded: &[usize],
        recorded: &[usize],
    ) -> Result<Self, Error> {
        let kinematics = system.kinematics();
        let (mechanism, chains) = (kinematics.mechanism(), kinematics.chains());
        let dimensions = kinematics.dimensions();
        crate::error::indices("coordinate", commanded, dimensions.len())?;
        let free = |k: usize| !commanded.contains(&k);
        let joint_freedoms = mechanism.joint_freedoms();
        let length = system.characteristic_length();
        let coupled = coupling_rows(kinematics, length);
        // The motion of a joint at which a loop is best opened: a ball, else a hinge.
        let opening = |j: usize| {
            let elements = &chains[j].elements;
            // Coupled coordinates are unknowns, and do not follow from a loop alone.
            let is_coupled = |k: usize| coupled.iter().any(|row| row.contains(k));
            let own = |e: &Element| {
                let k = e.coordinate;
                k < joint_freedoms && free(k) && !is_coupled(k)
            };
            let ball = elements.iter().position(|e| e.factor == Factor::Ball && own(e));
            ball.or_else(|| elements.iter().position(|e| e.factor == Factor::turn(2) && own(e)))
        };
        let mut balls = Vec::new();
        for element in chains.iter().flat_map(|chain| &chain.elements) {
            if element.factor == Factor::Ball {
                let k = element.coordinate;
                if (k + 1..k + 3).any(|other| free(other) != free(k)) {
                    return Err(Error::PartlyCommanded { coordinate: k });
                }
                balls.push(Ball { coordinate: k, column: None, opened: false });
            }
        }
        let freedoms_of = |j: usize| {
            let of_joint = kinematics.coordinates_of(j).filter(|&k| free(k)).count();
            // Opening at a ball spares six unknowns and equations in all, at a hinge two.
            let spared =
                opening(j).map_or(0, |e| 2 * chains[j].elements[e].factor.coordinates().len());
            of_joint + spared
        };
        let branches = spanning_tree(mechanism, freedoms_of);
        let mut in_tree = vec![false; chains.len()];
        branches.iter().for_each(|&(j, _)| in_tree[j] = true);
        let cuts: Vec<usize> = (0..chains.len()).filter(|&j| !in_tree[j]).collect();

        let follows = |k: usize| {
            let of_cut = |&j: &usize| {
                opening(j).is_some_and(|e| {
                    let element = &chains[j].elements[e];
                    let count = element.factor.coordinates().len();
                    (element.coordinate..element.coordinate + count).contains(&k)
                })
            };
            cuts.iter().any(of_cut)
        };
        // A unit of the metric moves no virtual joint by more than a radian or characteristic length, whatever the scale of the mechanism.
        let weights = virtual_weights(system);
        let natural = |k: usize| dimensions[k].unit(length);
        let of_metric = weights.iter().enumerate();
        let of_metric = of_metric.map(|(m, weight)| weight.sqrt() * natural(joint_freedoms + m));
        let metric_unit = of_metric.fold(f64::INFINITY, f64::min);
        let unknowns: Vec<Unknown> = (0..dimensions.len())
            .filter(|&k| free(k) && !follows(k))
            .map(|k| {
                let unit = k
                    .checked_sub(joint_freedoms)
                    .map_or_else(|| natural(k), |m| metric_unit / weights[m].sqrt());
                Unknown { coordinate: k, unit }
            })
            .collect();
        let column = |k: usize| {
            let unknown = unknowns.iter().position(|unknown| unknown.coordinate == k);
            let recorded = || recorded.binary_search(&k).ok().map(|j| unknowns.len() + j);
            unknown.or_else(recorded)
        };
        for ball in &mut balls {
            ball.column = column(ball.coordinate);
            ball.opened = follows(ball.coordinate);
        }
        let ball_at = |k: usize| {
            balls.iter().position(|ball| ball.coordinate == k).expect("every ball is listed")
        };
        let mut turns = 0;
        let mut walk = |j: usize, part: Part, start: &Pose| {
            Walk::new(&chains[j], part, start, column, ball_at, &mut turns)
        };
        let mut frames = vec![Frame::BASE; mechanism.links().len()];
        let mut placed = vec![Pose::identity(); frames.len()];
        // What leads from the base to the first motion never changes.
        let mut begin = |link: usize, walk: &mut Walk| {
            if link > 0 {
                return link;
            }
            frames.push(walk.begin());
            frames.len() - 1
        };

        let mut tree = Vec::with_capacity(branches.len());
        for &(j, against) in &branches {
            let [first, second] = mechanism.joints()[j].links;
            let (from, to, part) = if against {
                (second, first, Part::Backward)
            } else {
                (first, second, Part::Forward)
            };
            let (mut walk, behind) = walk(j, part, &placed[from]);
            placed[to] = behind;
            tree.push(TreeEdge { from, to, start: begin(from, &mut walk), walk });
        }
        let mut row = 0;
        let mut closings: Vec<Closing> = cuts
            .iter()
            .map(|&j| {
                // Both sides up to the excluded motion; else the frames behind all motions.
                let count = chains[j].elements.len();
                let (before, from) = opening(j).map_or((count, count), |e| (e, e + 1));
                let links = mechanism.joints()[j].links;
                let mut side = |part: Part, link: usize| {
                    let (walk, behind) = walk(j, part, &placed[link]);
                    let mut walk = walk.with_tail(&behind);
                    (begin(link, &mut walk), walk)
                };
                let (first_start, first_side) = side(Part::Before(before), links[0]);
                let (second_start, second_side) = side(Part::From(from), links[1]);
                let sides = [first_side, second_side];
                let meeting = opening(j).map_or(Meeting::Frames, |e| {
                    let element = &chains[j].elements[e];
                    match element.factor {
                        Factor::Ball => Meeting::Points(ball_at(element.coordinate)),
                        _ => Meeting::Axes(element.coordinate),
                    }
                });
                let first = row;
                row += meeting.equations();
                Closing {
                    links,
                    starts: [first_start, second_start],
                    moved_by: moved_by(&tree, links, &sides),
                    sides,
                    meeting,
                    row: first,
                    frames: [Frame::BASE; 2],
                }
            })
            .collect();
        let couplings: Vec<CoupledRow> = coupled
            .into_iter()
            .map(|equation| {
                let columns = equation.entries.iter();
                let columns = columns.filter_map(|&(k, factor)| Some((column(k)?, factor)));
                let columns = columns.collect();
                row += 1;
                CoupledRow { equation, columns, row: row - 1 }
            })
            .collect();
        let passive = unknowns.iter().filter(|u| u.coordinate < joint_freedoms).count();
        let virtuals = unknowns.len() - passive;
        Ok(Self {
            start: vec![0.0; dimensions.len()],
            frames,
            placed,
            turns: vec![Turned::NONE; turns],
            orientations: vec![Matrix3::identity(); balls.len()],
            screws: vec![Screw::STILL; unknowns.len() + recorded.len()],
            relieved: vec![0.0; virtuals],
            elimination: Bordered::new(&mut closings, &couplings, passive, virtuals),
            tree,
            closings,
            couplings,
            balls,
            unknowns,
            passive,
            length,
            plan: None,
        })
    }

    /// Moves passive and virtual joints until all loops are closed.
    ///
    /// # Arguments
    /// * `coordinates` – (f + M) commanded coordinates at their values, the others near; takes the solution, or the best iterate where there is none (m, rad)
    /// * `solver` – which of the virtual displacements that close the loops; nothing to choose where there are no virtual joints
    ///
    /// # Errors
    /// [`Error::LengthMismatch`], [`Error::NotFinite`], [`Error::NotReached`].
    pub fn solve(
        &mut self,
        coordinates: &mut [f64],
        solver: ReliefSolver,
    ) -> Result<Position, Error> {
        self.check(coordinates)?;
        self.start.copy_from_slice(coordinates);
        let run = self.iterate(coordinates, solver, MAX_ITERATIONS);
        if run.residual <= CLOSURE_TOLERANCE && run.settled {
            self.close_openings(coordinates);
            return Ok(Position { residual: run.residual, iterations: run.iterations });
        }
        // No iterate is stored, which would slow down all solutions that converge: the iteration is repeated up to its best.
        coordinates.copy_from_slice(&self.start);
        let (best, residual) = run.best;
        if residual.is_finite() {
            self.iterate(coordinates, solver, best);
            self.close_openings(coordinates);
        }
        Err(Error::NotReached { residual, allowed: CLOSURE_TOLERANCE, iterations: run.iterations })
    }

    /// Whether a coordinate vector has as many numbers as needed, all finite.
    pub(super) fn check(&self, coordinates: &[f64]) -> Result<(), Error> {
        let what = "the coordinate vector";
        if coordinates.len() != self.start.len() {
            let (found, expected) = (coordinates.len(), self.start.len());
            return Err(Error::LengthMismatch { what, found, expected });
        }
        coordinates.iter().try_for_each(|&value| crate::error::finite(what, value).map(|_| ()))
    }

    /// Number of links.
    pub(super) fn link_count(&self) -> usize {
        self.placed.len()
    }

    /// Where a link was at the last evaluation.
    pub(super) fn link_pose(&self, link: usize) -> Pose {
        self.frames[link].pose() * self.placed[link]
    }

    /// Number of all coordinates.
    pub(super) fn coordinate_count(&self) -> usize {
        self.start.len()
    }

    /// First coordinates of all balls.
    pub(super) fn ball_coordinates(&self) -> impl Iterator<Item = usize> + '_ {
        self.balls.iter().map(|ball| ball.coordinate)
    }

    /// First coordinate of a ball.
    pub(super) fn ball_coordinate(&self, ball: usize) -> usize {
        self.balls[ball].coordinate
    }

    /// Newton's method, for at most so many steps; deterministic.
    fn iterate(&mut self, coordinates: &mut [f64], solver: ReliefSolver, most: usize) -> Run {
        self.orient(coordinates);
        let least_norm = solver == ReliefSolver::LeastNorm && !self.relieved.is_empty();
        let (mut before, mut moved_before) = (f64::INFINITY, f64::INFINITY);
        let (mut settled, mut iterations) = (!least_norm, 0);
        let mut best = (0, f64::INFINITY);
        loop {
            let residual = self.mismatch(coordinates);
            // Of those that are closed the last: its virtual joints have settled most.
            if residual <= best.1.max(CLOSURE_TOLERANCE) {
                best = (iterations, residual);
            }
            let at_the_end =
                residual <= ROUND_OFF || (residual <= CLOSURE_TOLERANCE && residual > 0.5 * before);
            if (at_the_end && settled) || iterations == most || residual.is_nan() {
                return Run { residual, settled, iterations, best };
            }
            // Newton's steps square the mismatch; by the last factor the next one still takes a share as large as the last step left.
            // The least displacement depends on the derivatives at this point, which therefore have to be recomputed.
            let with_last_factor = 2.0 * residual * residual / before;
            if iterations == 0 || with_last_factor > ROUND_OFF || least_norm {
                self.linearize();
            }
            iterations += 1;
            before = residual;
            let moved = self.step(coordinates, solver);
            settled = !least_norm
                || moved <= SETTLED
                || (moved <= SETTLING && moved > 0.5 * moved_before);
            moved_before = moved;
        }
    }
}
