//! Robots as built, which differ from the design by tolerances.

use jointplay_core::Error;
use jointplay_core::gpr::{Gpr, Limb};

use super::Variation;
use super::random::{DIMENSION_STREAMS, Stream};

/// A dimension of a limb.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// r_k (m).
    SocketRadius,
    /// β_k (rad).
    SocketAngle,
    /// e_b1 coordinate of B_k (m).
    BaseX,
    /// e_b2 coordinate of B_k (m).
    BaseY,
}

impl Dimension {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::SocketRadius, Self::SocketAngle, Self::BaseX, Self::BaseY];
}

/// Whose dimensions the rods of a commanded pose are computed from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RodsFrom {
    /// The design's: the robot is commanded as if it were built right.
    #[default]
    Nominal,
    /// Its own: the robot was measured.
    AsBuilt,
}

/// Difference of each dimension of each limb from the design, drawn for every limb separately ((m), (rad)).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tolerances {
    /// Of r_k (m).
    pub socket_radius: Option<Variation>,
    /// Of β_k (rad).
    pub socket_angle: Option<Variation>,
    /// Of the e_b1 coordinate of B_k (m).
    pub base_x: Option<Variation>,
    /// Of the e_b2 coordinate of B_k (m).
    pub base_y: Option<Variation>,
}

impl Tolerances {
    /// The variation of one dimension; `None` for a dimension without tolerance.
    #[must_use]
    pub fn variation(&self, dimension: Dimension) -> Option<&Variation> {
        match dimension {
            Dimension::SocketRadius => self.socket_radius.as_ref(),
            Dimension::SocketAngle => self.socket_angle.as_ref(),
            Dimension::BaseX => self.base_x.as_ref(),
            Dimension::BaseY => self.base_y.as_ref(),
        }
    }

    /// Whether any dimension differs.
    #[must_use]
    pub fn any(&self) -> bool {
        Dimension::ALL.iter().any(|&dimension| self.variation(dimension).is_some())
    }
}

/// A dimension of a limb, to read or to change.
fn entry(limb: &mut Limb, dimension: Dimension) -> &mut f64 {
    match dimension {
        Dimension::SocketRadius => &mut limb.socket_radius,
        Dimension::SocketAngle => &mut limb.socket_angle,
        Dimension::BaseX => &mut limb.base_point.x,
        Dimension::BaseY => &mut limb.base_point.y,
    }
}

/// The value of a dimension, in its SI unit.
pub(super) fn value(mut limb: Limb, dimension: Dimension) -> f64 {
    *entry(&mut limb, dimension)
}

/// A dimension that differs from the design.
struct DimensionError<'a> {
    limb: usize,
    dimension: Dimension,
    /// Values or distribution of the difference.
    error: &'a Variation,
    /// Random numbers of the difference.
    stream: Stream,
}

/// Draws robots.
pub(super) struct RobotSampler<'a> {
    design: &'a Gpr,
    errors: Vec<DimensionError<'a>>,
}

impl<'a> RobotSampler<'a> {
    pub(super) fn new(design: &'a Gpr, tolerances: &'a Tolerances, seed: u64) -> Self {
        let errors = (0..3)
            .flat_map(|limb| (0..).zip(Dimension::ALL).map(move |(k, d)| (limb, k, d)))
            .filter_map(|(limb, k, dimension)| {
                let stream = DIMENSION_STREAMS + 4 * limb as u64 + k;
                let error = tolerances.variation(dimension)?;
                Some(DimensionError { limb, dimension, error, stream: Stream::new(seed, stream) })
            })
            .collect();
        Self { design, errors }
    }

    /// The limbs of a draw.
    pub(super) fn limbs(&mut self, draw: u64) -> [Limb; 3] {
        let mut limbs = self.design.limbs();
        for DimensionError { limb, dimension, error, stream } in &mut self.errors {
            *entry(&mut limbs[*limb], *dimension) += error.value(stream, 0, draw);
        }
        limbs
    }

    /// The robot of such limbs.
    pub(super) fn robot(&self, limbs: [Limb; 3]) -> Result<Gpr, Error> {
        let made = Gpr::new(limbs, *self.design.limits(), self.design.working_height())?;
        Ok(made.without_limit_checks())
    }
}
