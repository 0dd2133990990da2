//! The unknowns of an arm: angles of its links, as linear functions of the positions of its axes.

use std::f64::consts::TAU;

use nalgebra::{Matrix4, Vector2};

use crate::robot::arm_chain::{ArmChain, ArmVector, LinkVector, dot, turned};

/// Relative difference of length up to which links of a belt-coupled arm count as equally long.
const SAME_LENGTH: f64 = 1e-12;

/// The two unknowns that place the wafer's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Pair {
    /// Two links that rotate independently.
    Links([Link; 2]),
    /// Two links of equal length and a third that rotates by the mean of both: they move it along its own direction.
    Belt([Link; 2], BeltDrivenLink),
    /// A link on a prismatic joint that rotates with it.
    Prismatic(usize),
}

/// A link vector in polar coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Link {
    pub(super) link_vector: usize,
    /// Length (m).
    pub(super) length: f64,
    /// Direction where the unknown is zero (rad).
    pub(super) angle: f64,
}

/// The link that a belt-coupled pair moves along its own direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BeltDrivenLink {
    pub(super) link_vector: usize,
    /// Direction in which the pair moves the link where both unknowns are zero: the mean of the links' directions (rad).
    pub(super) middle: f64,
    /// The link vector in the frame of that direction, its x not negative (m).
    pub(super) vector: Vector2<f64>,
}

/// A prismatic joint whose extension is free, while two rotating links place the wafer's centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FreeSlide {
    /// Index of the extension among the unknowns: that of the first link, or that of the last link where the last link is part of the pair.
    pub(super) unknown: usize,
    /// The link vector that rotates with the joint, and that it lengthens.
    pub(super) link_vector: usize,
}

/// The unknowns of an arm: the two of the pair, then the angle of the last link, then that of the first; an extension is in the place of a link that the arm does not have.
///
/// ```text
///    y = Y a        y: unknowns,   a: positions of the axes;   as many of both, `count`
/// ```
#[derive(Debug, Clone, Copy)]
pub(super) struct Decomposition {
    pub(super) pair: Pair,
    /// Link that rotates with the wafer, where it is not part of the pair.
    pub(super) last: Option<usize>,
    /// Link at the platform, where it is not part of the pair.
    pub(super) first: Option<usize>,
    /// Prismatic joint that is not part of the pair.
    pub(super) slide: Option<FreeSlide>,
    pub(super) count: usize,
    /// Y⁻¹, padded with the identity.
    pub(super) inverse: Matrix4<f64>,
    /// Y, padded with the identity.
    pub(super) forward: Matrix4<f64>,
}

impl Decomposition {
    /// The decomposition of an arm; `None` where the arm has no closed form.
    pub(super) fn new(chain: &ArmChain) -> Option<Self> {
        Self::without_free_slide(chain).or_else(|| Self::with_free_slide(chain))
    }

    fn without_free_slide(chain: &ArmChain) -> Option<Self> {
        let count = chain.axes().len();
        let link_vectors = chain.link_vectors();
        let mut rest: [usize; 4] = [0; 4];
        let mut left = 0;
        let last = if count > 2 {
            Some(link_vectors.iter().position(|link_vector| link_vector.turn == chain.heading.1)?)
        } else {
            None
        };
        let first =
            if count > 3 { (0..link_vectors.len()).find(|&k| Some(k) != last) } else { None };
        for k in (0..link_vectors.len()).filter(|&k| Some(k) != last && Some(k) != first) {
            rest[left] = k;
            left += 1;
        }
        let pair = match (chain.prismatic_joints(), &rest[..left]) {
            ([], &[i, j]) => Pair::Links([i, j].map(|k| Link::of(link_vectors, k))),
            ([], &[i, j, k]) => {
                let order = [[i, j, k], [i, k, j], [j, k, i]];
                let [i, j, w] = order.into_iter().find(|&[i, j, w]| is_belt(chain, i, j, w))?;
                belt([i, j].map(|k| Link::of(link_vectors, k)), link_vectors, w)
            }
            ([prismatic], &[g]) if prismatic.along.turn == link_vectors[g].turn => {
                Pair::Prismatic(g)
            }
            _ => return None,
        };
        let rows: [&ArmVector; 2] = match pair {
            Pair::Links(pair) | Pair::Belt(pair, _) => {
                pair.map(|link| &link_vectors[link.link_vector].turn)
            }
            Pair::Prismatic(g) => [&link_vectors[g].turn, &chain.prismatic_joints()[0].extension],
        };
        let rows = [
            Some(rows[0]),
            Some(rows[1]),
            last.map(|k| &link_vectors[k].turn),
            first.map(|k| &link_vectors[k].turn),
        ];
        Self { last, first, ..Self::from_rows(pair, rows, count)? }.into()
    }

    /// Two links that place the wafer's centre, while the extension of a prismatic joint is free.
    fn with_free_slide(chain: &ArmChain) -> Option<Self> {
        let (count, link_vectors) = (chain.axes().len(), chain.link_vectors());
        let [prismatic] = chain.prismatic_joints() else { return None };
        let rotates_as = |turn: &ArmVector| link_vectors.iter().position(|it| it.turn == *turn);
        let last = if count > 3 { Some(rotates_as(&chain.heading.1)?) } else { None };
        let mut links = (0..link_vectors.len()).filter(|&k| Some(k) != last);
        let (Some(i), Some(j), None) = (links.next(), links.next(), links.next()) else {
            return None;
        };
        let pair = Pair::Links([i, j].map(|k| Link::of(link_vectors, k)));
        let mut rows = [Some(&link_vectors[i].turn), Some(&link_vectors[j].turn), None, None];
        rows[2] = last.map(|k| &link_vectors[k].turn);
        let unknown = count - 1;
        *rows.get_mut(unknown)? = Some(&prismatic.extension);
        let slide = FreeSlide { unknown, link_vector: rotates_as(&prismatic.along.turn)? };
        Some(Self { last, slide: Some(slide), ..Self::from_rows(pair, rows, count)? })
    }

    fn from_rows(pair: Pair, rows: [Option<&ArmVector>; 4], count: usize) -> Option<Self> {
        let used = rows.iter().flatten().count();
        let mut forward = Matrix4::identity();
        for (r, row) in rows.into_iter().enumerate() {
            if let Some(row) = row {
                forward.set_row(r, &nalgebra::RowVector4::from_row_slice(row));
            }
        }
        if used != count || forward.determinant().abs() < 1e-9 {
            return None;
        }
        let inverse = forward.try_inverse()?;
        Some(Self { pair, last: None, first: None, slide: None, count, inverse, forward })
    }

    /// Whether the last and the first unknown are free.
    pub(super) fn free_unknowns(&self, prescribes_heading: bool) -> [bool; 2] {
        let slides = |unknown| self.slide.is_some_and(|slide| slide.unknown == unknown);
        let last = self.last.is_some() && !prescribes_heading;
        [last || slides(2), self.first.is_some() || slides(3)]
    }

    /// Whether the arm has more motors than a target needs.
    pub(super) fn is_redundant(&self, prescribes_heading: bool) -> bool {
        self.count > 2 + usize::from(prescribes_heading)
    }

    /// Whether the pair follows in closed form: not where a prescribed heading fixes one of its links.
    pub(super) fn is_closed(&self, prescribes_heading: bool) -> bool {
        self.last.is_some() || self.slide.is_none() || !prescribes_heading
    }

    /// Whether an unknown is the angle of a link, and not an extension.
    #[inline]
    pub(super) fn is_angle(&self, unknown: usize) -> bool {
        (unknown != 1 || !matches!(self.pair, Pair::Prismatic(_)))
            && self.slide.is_none_or(|slide| slide.unknown != unknown)
    }

    /// Extension of the free prismatic joint for given free unknowns, 0 for other arms (m).
    #[inline]
    pub(super) fn free_extension(&self, free: [f64; 2]) -> f64 {
        self.slide.map_or(0.0, |slide| free[slide.unknown - 2])
    }

    /// A link vector where all axes are at zero, but for the extension of the free prismatic joint (m).
    #[inline]
    pub(super) fn extended(&self, chain: &ArmChain, k: usize, extension: f64) -> Vector2<f64> {
        let vector = chain.link_vectors()[k].vector;
        match self.slide {
            Some(slide) if slide.link_vector == k => {
                vector + chain.prismatic_joints()[0].along.vector * extension
            }
            _ => vector,
        }
    }

    /// A link vector at positions of the axes (m).
    pub(super) fn rotated(
        &self,
        chain: &ArmChain,
        k: usize,
        arm_positions: &ArmVector,
    ) -> Vector2<f64> {
        let extension = match (self.slide, chain.prismatic_joints()) {
            (Some(_), [prismatic]) => dot(&prismatic.extension, arm_positions),
            _ => 0.0,
        };
        let turn = dot(&chain.link_vectors()[k].turn, arm_positions);
        turned(&self.extended(chain, k, extension), turn)
    }

    /// Positions of the axes for given unknowns.
    #[inline]
    pub(super) fn positions(&self, unknown: &ArmVector) -> ArmVector {
        (self.inverse * nalgebra::Vector4::from(*unknown)).into()
    }

    /// Unknowns for given positions of the axes.
    #[inline]
    pub(super) fn unknown(&self, arm_positions: &ArmVector) -> ArmVector {
        (self.forward * nalgebra::Vector4::from(*arm_positions)).into()
    }
}

impl Link {
    fn of(link_vectors: &[LinkVector], link_vector: usize) -> Self {
        Self::from_vector(link_vector, &link_vectors[link_vector].vector)
    }

    pub(super) fn from_vector(link_vector: usize, vector: &Vector2<f64>) -> Self {
        Self { link_vector, length: vector.norm(), angle: vector.y.atan2(vector.x) }
    }
}

/// A belt-coupled pair, with the one of its two mean directions along which the wafer points.
fn belt([one, mut other]: [Link; 2], link_vectors: &[LinkVector], link_vector: usize) -> Pair {
    let mut middle = 0.5 * (one.angle + other.angle);
    let mut vector = turned(&link_vectors[link_vector].vector, -middle);
    if vector.x < 0.0 {
        let turn = if other.angle > 0.0 { -TAU } else { TAU };
        other.angle += turn;
        middle += 0.5 * turn;
        vector = -vector;
    }
    Pair::Belt([one, other], BeltDrivenLink { link_vector, middle, vector })
}

fn is_belt(chain: &ArmChain, i: usize, j: usize, w: usize) -> bool {
    let link_vectors = chain.link_vectors();
    let (one, other) = (link_vectors[i].vector.norm(), link_vectors[j].vector.norm());
    let mean = (0..4).all(|a| {
        let mean = 0.5 * (link_vectors[i].turn[a] + link_vectors[j].turn[a]);
        (link_vectors[w].turn[a] - mean).abs() <= 1e-12
    });
    mean && (one - other).abs() <= SAME_LENGTH * one
}
