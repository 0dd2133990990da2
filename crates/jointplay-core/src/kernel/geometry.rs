//! What a kernel knows of a robot.

use nalgebra::Vector3;

use super::model::Model;
use super::processor::Processor;
use crate::linalg::least_norm_of_three;
use crate::virtualization::{
    MAX_VIRTUAL_JOINTS, Platform, Sockets, SolveOptions, Solver, VirtualJoints, Virtualization,
    sides_of, signed_area,
};

/// Dimensions of a robot that all poses share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Geometry {
    /// B_j − B_i in the base plane (m).
    pub(crate) base_edges: [[f64; 2]; 3],
    /// Their squared lengths (m²).
    pub(crate) base_squares: [f64; 3],
    /// Inverses of their squared lengths (1/m²).
    pub(super) base_inverse_squares: [f64; 3],
    /// Coefficients of 1, L² and L⁴ in a series of 1/(2 L) about each of their lengths, see [`Balls::residual`](super::shape::Balls::residual).
    pub(super) half_inverses: [[f64; 3]; 3],
    /// Product of the squares of their longest and shortest lengths (m⁴).
    extremes: f64,
    /// Centroid of the base points (m).
    pub(crate) base_center: [f64; 2],
    /// Twice the signed area of the base points (m²).
    pub(crate) base_area: f64,
    /// Its square (m⁴).
    pub(super) base_area_squared: f64,
    /// Sense of the base points: 1 where they are in counter-clockwise order, else −1.
    pub(super) sense: f64,
    /// Base edges that leave and reach the first ball, reversed where the base points are in clockwise order (m).
    pub(super) first_edges: [[f64; 2]; 2],
    /// Nominal sockets (m).
    pub(crate) sockets: [[f64; 2]; 3],
    /// Centroid of the nominal sockets (m).
    pub(crate) socket_center: [f64; 2],
    /// Nominal sockets, seen from their centroid (m).
    pub(super) from_center: [[f64; 2]; 3],
    /// With f_k the nominal sockets seen from their centroid: −f_i · f_j for each side, and 2 |f_1 × f_2| (m²).
    pub(super) fit: ([f64; 3], f64),
    /// Squared sides of the nominal sockets (m²).
    pub(crate) socket_squares: [f64; 3],
    /// Whether sockets are 120° apart.
    pub(crate) equally_spaced: bool,
    radii: [f64; 3],
    directions: [[f64; 2]; 3],
    /// Cosines and sines of the angles from each direction to the next.
    pub(super) between: [[f64; 2]; 3],
    /// That of the machine on which the robot was made.
    pub(crate) processor: Processor,
}

impl Geometry {
    pub(crate) fn new(base_points: &Sockets, platform: &Platform) -> Self {
        let sockets = platform.sockets();
        let base_edges = [0, 1, 2].map(|k| (base_points[(k + 1) % 3] - base_points[k]).into());
        let center = |points: &Sockets| (points[0] + points[1] + points[2]) / 3.0;
        let socket_center = center(sockets);
        let from_center = sockets.map(|socket| socket - socket_center);
        let base_area = signed_area(base_points);
        let sides = sides_of(base_points);
        let base_squares = base_edges.map(|[x, y]: [f64; 2]| x * x + y * y);
        let [l_1, l_2, l_3] = base_squares;
        Self {
            base_edges,
            base_squares,
            base_inverse_squares: base_squares.map(|square| 1.0 / square),
            half_inverses: [0, 1, 2].map(|k| {
                let (square, half) = (base_squares[k], 0.5 / sides[k]);
                [1.875 * half, -1.25 * half / square, 0.375 * half / square / square]
            }),
            extremes: l_1.max(l_2).max(l_3) * l_1.min(l_2).min(l_3),
            base_center: center(base_points).into(),
            base_area,
            base_area_squared: base_area * base_area,
            sense: base_area.signum(),
            first_edges: [0, 2].map(|k| base_edges[k].map(|edge: f64| edge * base_area.signum())),
            sockets: sockets.map(Into::into),
            socket_center: socket_center.into(),
            from_center: from_center.map(Into::into),
            fit: (
                [0, 1, 2].map(|k| -from_center[k].dot(&from_center[(k + 1) % 3])),
                2.0 * from_center[0].perp(&from_center[1]).abs(),
            ),
            socket_squares: sides_of(sockets).map(|side| side * side),
            equally_spaced: platform.equally_spaced(),
            radii: *platform.radii(),
            directions: platform.directions().map(Into::into),
            between: [0, 1, 2].map(|k| {
                let (own, next) = (platform.directions()[k], platform.directions()[(k + 1) % 3]);
                [own.dot(&next), own.perp(&next)]
            }),
            processor: Processor::new(),
        }
    }

    /// Nominal coordinates along the directions (m); those across are zero.
    #[inline(always)]
    pub(crate) fn start<M: Model>(&self) -> [f64; 3] {
        if M::FROM_SOCKET { [0.0; 3] } else { self.radii }
    }

    /// Directions of the coordinates along, at nominal.
    #[inline(always)]
    pub(crate) fn directions<M: Model>(&self) -> [[f64; 2]; 3] {
        if M::TOWARD_SOCKET { self.directions } else { [[1.0, 0.0]; 3] }
    }
}

/// What a kernel is asked: the robot, and how its virtual joints are found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task<'a> {
    pub(crate) geometry: &'a Geometry,
    /// The requested solver, or least norm where a closed form does not exist.
    pub(crate) solver: Solver,
    pub(crate) max_iterations: usize,
    /// Compliance of coordinates across relative to those along: 1/ρ² for angles, 1 for lengths.
    pub(crate) compliance: f64,
    /// 4 · relative threshold².
    pub(crate) threshold: f64,
    /// Sides are met where the squares of what is missing from all three squared sides have a sum below this (m⁴).
    ///
    /// For sides that are found to round-off: less than [`Self::threshold`] allows for any of them, whose pose has longer sides than the base.
    pub(crate) all_missing: f64,
    /// The first step from nominal, where it pays to compute it once.
    pub(crate) first_step: Option<&'a FirstStep>,
}

impl<'a> Task<'a> {
    /// # Arguments
    /// * `characteristic_length` – ρ of the metric (m)
    #[inline(always)]
    pub(crate) fn new<M: Model>(
        geometry: &'a Geometry,
        options: &SolveOptions,
        characteristic_length: f64,
    ) -> Self {
        let weight = characteristic_length * characteristic_length;
        let threshold = 4.0 * options.relative_threshold * options.relative_threshold;
        let has_closed_form = M::CLOSED_FORM && (!M::TOWARD_SOCKET || geometry.equally_spaced);
        Self {
            geometry,
            solver: match options.solver {
                Solver::ClosedForm if !has_closed_form => Solver::LeastNorm,
                solver => solver,
            },
            max_iterations: options.max_iterations,
            compliance: if M::TURNS { 1.0 / weight } else { 1.0 },
            threshold,
            all_missing: threshold * geometry.extremes,
            first_step: None,
        }
    }
}

/// The first step from nominal, which is the same linear map for all poses: joints by sides, per change of a squared side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FirstStep(pub(super) [[f64; 3]; 6]);

impl FirstStep {
    /// `None` where the sides are dependent at nominal.
    ///
    /// # Arguments
    /// * `characteristic_length` – ρ of the metric (m)
    pub(crate) fn new(
        platform: &Platform,
        virtualization: &dyn Virtualization,
        characteristic_length: f64,
    ) -> Option<Self> {
        let joints = virtualization.joints();
        let count = joints.len();
        let mut nominal = VirtualJoints::zeros(count);
        virtualization.nominal(platform, &mut nominal);
        let mut velocities = [Sockets::default(); MAX_VIRTUAL_JOINTS];
        virtualization.socket_velocities(platform, &nominal, &mut velocities[..count]);
        let sockets = platform.sockets();
        let mut columns = [Vector3::zeros(); 6];
        let mut compliance = [1.0; 6];
        for (m, joint) in joints.iter().enumerate() {
            for k in 0..3 {
                let next = (k + 1) % 3;
                let edge = (sockets[next] - sockets[k]) * 2.0;
                columns[m][k] = edge.dot(&(velocities[m][next] - velocities[m][k]));
            }
            let weight = joint.motion.weight(characteristic_length);
            compliance[m] = 1.0 / (weight * weight);
        }
        let mut first_step = [[0.0; 3]; 6];
        for side in 0..3 {
            let (mut unit, mut step) = (Vector3::zeros(), [0.0; 6]);
            unit[side] = 1.0;
            let (columns, compliance) = (&columns[..count], &compliance[..count]);
            if !least_norm_of_three(columns, compliance, &unit, &mut step[..count]) {
                return None;
            }
            for (row, value) in first_step.iter_mut().zip(step) {
                row[side] = value;
            }
        }
        Some(Self(first_step))
    }
}
