//! Closed-form positions of the two unknowns that place the wafer's centre in the arm's plane.

use nalgebra::Vector2;

use super::decomposition::{BeltDrivenLink, Decomposition, FreeSlide, Link, Pair};
use super::solution::{Configuration, Elbow, OutOfReach, ReachDirection};
use crate::robot::arm_chain::{ArmChain, LinkVector, dot, perpendicular, turned};

/// Fraction of the stretched length by which a point may be out of reach and counts as reached: round-off.
const ROUND_OFF: f64 = 1e-14;

/// One solution for both unknowns, with its configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PairSolution {
    pub(super) pair: [f64; 2],
    pub(super) configuration: Configuration,
    /// Both link vectors; for a prismatic pair the whole span, and its direction (m).
    pub(super) link_vectors: [Vector2<f64>; 2],
    /// Coordinate that indicates singular configurations: for two links the cosine of the elbow angle, ±1 where stretched or folded;
    /// for the other pairs the reach ahead of the first joint, negative backward, 0 where its direction changes (m).
    pub(super) singular_coordinate: f64,
}

/// Up to four solutions.
pub(super) type PairSolutions = [Option<PairSolution>; 4];

fn angle(vector: &Vector2<f64>) -> f64 {
    vector.y.atan2(vector.x)
}

/// A vector in the frame of another, multiplied by the length of that one.
fn within(frame: &Vector2<f64>, vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(frame.dot(vector), frame.perp(vector))
}

impl Decomposition {
    /// All values of the pair that span `point` (m) in configurations that agree with a given one.
    ///
    /// # Arguments
    /// * `like` – values of the pair that decide where any direction would do
    /// * `extension` – extension of a free prismatic joint (m)
    #[inline]
    pub(super) fn solve_links(
        &self,
        chain: &ArmChain,
        point: &Vector2<f64>,
        wanted: Configuration,
        like: [f64; 2],
        extension: f64,
    ) -> Result<PairSolutions, OutOfReach> {
        match (&self.pair, self.slide) {
            (Pair::Links(pair), Some(FreeSlide { link_vector, .. })) => {
                let pair = pair.map(|link| match link.link_vector {
                    k if k == link_vector => {
                        Link::from_vector(k, &self.extended(chain, k, extension))
                    }
                    _ => link,
                });
                links(&pair, point, wanted, like)
            }
            (Pair::Links(pair), None) => links(pair, point, wanted, like),
            (Pair::Belt(pair, belt_driven_link), _) => {
                belt(pair, belt_driven_link, point, wanted, like)
            }
            (Pair::Prismatic(g), _) => {
                let prismatic_joints = chain.prismatic_joints();
                prismatic(
                    &chain.link_vectors()[*g],
                    &prismatic_joints[0].along.vector,
                    point,
                    wanted,
                    like,
                )
            }
        }
    }

    /// Derivatives of the spanned vector with respect to both unknowns.
    #[inline]
    pub(super) fn span_change(&self, found: &PairSolution, point: &Vector2<f64>) -> SpanChange {
        let [one, other] = found.link_vectors;
        match &self.pair {
            Pair::Links(_) => SpanChange {
                velocities: [perpendicular(&one), perpendicular(&other)],
                second: [-one, Vector2::zeros(), -other],
            },
            Pair::Belt(..) => {
                let quarter = (point - one - other) * 0.25;
                let half = perpendicular(&quarter) * 2.0;
                SpanChange {
                    velocities: [perpendicular(&one) + half, perpendicular(&other) + half],
                    second: [-one - quarter, -quarter, -other - quarter],
                }
            }
            Pair::Prismatic(_) => SpanChange {
                velocities: [perpendicular(&one), other],
                second: [-one, perpendicular(&other), Vector2::zeros()],
            },
        }
    }

    /// Direction in which a belt-coupled pair moves its wafer; for other pairs, the direction of the first link.
    pub(super) fn middle(&self, chain: &ArmChain, pair: [f64; 2]) -> Vector2<f64> {
        let first = |k: usize| turned(&chain.link_vectors()[k].vector, pair[0]).normalize();
        match &self.pair {
            Pair::Belt(_, belt_driven_link) => {
                turned(&Vector2::x(), 0.5 * (pair[0] + pair[1]) + belt_driven_link.middle)
            }
            Pair::Links([one, _]) => first(one.link_vector),
            Pair::Prismatic(g) => first(*g),
        }
    }

    /// Configuration of the arm at positions of its axes.
    pub(super) fn configuration(
        &self,
        chain: &ArmChain,
        arm_positions: &[f64; 4],
    ) -> Configuration {
        let link_vectors = chain.link_vectors();
        let at = |k: usize| self.rotated(chain, k, arm_positions);
        match &self.pair {
            Pair::Links([i, j]) => Configuration {
                elbow: elbow(-at(i.link_vector).perp(&at(j.link_vector))),
                reaching: None,
            },
            Pair::Belt(links, belt_driven_link) => {
                let [i, j] = links.map(|link| link.link_vector);
                let pair = [i, j].map(|k| dot(&link_vectors[k].turn, arm_positions));
                let axis = self.middle(chain, pair);
                Configuration {
                    elbow: elbow(axis.perp(&at(i))),
                    reaching: reaching(
                        axis.dot(&(at(i) + at(j) + at(belt_driven_link.link_vector))),
                    ),
                }
            }
            Pair::Prismatic(g) => {
                let prismatic = &chain.prismatic_joints()[0];
                let along =
                    turned(&prismatic.along.vector, dot(&prismatic.along.turn, arm_positions));
                let tip = at(*g) + along * dot(&prismatic.extension, arm_positions);
                Configuration { elbow: None, reaching: reaching(along.dot(&tip)) }
            }
        }
    }
}

/// Derivatives of a spanned vector with respect to the two unknowns of a pair.
pub(super) struct SpanChange {
    /// First derivatives, by either unknown.
    pub(super) velocities: [Vector2<f64>; 2],
    /// Second derivatives: by the first unknown, by both, by the second.
    pub(super) second: [Vector2<f64>; 3],
}

fn elbow(left: f64) -> Option<Elbow> {
    match left {
        left if left > 0.0 => Some(Elbow::Left),
        left if left < 0.0 => Some(Elbow::Right),
        _ => None,
    }
}

fn reaching(forward: f64) -> Option<ReachDirection> {
    match forward {
        forward if forward > 0.0 => Some(ReachDirection::Forward),
        forward if forward < 0.0 => Some(ReachDirection::Backward),
        _ => None,
    }
}

/// Two links: the law of cosines, with the sine by Heron's product, which does not cancel near the stretched arm.
#[inline]
fn links(
    [one, other]: &[Link; 2],
    point: &Vector2<f64>,
    wanted: Configuration,
    like: [f64; 2],
) -> Result<PairSolutions, OutOfReach> {
    let (a, b, d) = (one.length, other.length, point.norm());
    let (min, max) = ((a - b).abs(), a + b);
    if d > max + ROUND_OFF * max || d < min - ROUND_OFF * max {
        return Err(OutOfReach { distance: d, min, max });
    }
    let cosine = (d * d - a * a - b * b) * 0.5;
    let product = (d + a + b) * (a + b - d) * (d + a - b) * (d - a + b);
    let sine = product.max(0.0).sqrt() * 0.5;
    let angle_between = sine.atan2(cosine);
    // The spanned vector in the frame of the first link, multiplied by the length of that link.
    let reach = Vector2::new(a * a + cosine, sine);
    let solution = |side: f64| {
        let configuration = Configuration { elbow: elbow(-side * sine), reaching: None };
        configuration.agrees_with(wanted).then(|| {
            let aside = Vector2::new(reach.x, side * reach.y);
            // The first link multiplied by the squared distance.
            let along = within(&aside, point);
            let (first, link) = if d > 0.0 {
                (angle(&along), along / (d * d))
            } else {
                let first = like[0] + one.angle;
                (first, turned(&Vector2::new(a, 0.0), first))
            };
            let pair = [first - one.angle, first + side * angle_between - other.angle];
            let singular_coordinate = cosine / (a * b);
            PairSolution {
                pair,
                configuration,
                link_vectors: [link, point - link],
                singular_coordinate,
            }
        })
    };
    // Stretched or folded, both solutions are one.
    let second = if sine > 0.0 { solution(-1.0) } else { None };
    Ok([solution(1.0), second, None, None])
}

/// Links of length A at ±δ about the direction of the third link w: 2 A cos δ + w spans the distance.
#[inline]
fn belt(
    [one, other]: &[Link; 2],
    belt_driven_link: &BeltDrivenLink,
    point: &Vector2<f64>,
    wanted: Configuration,
    like: [f64; 2],
) -> Result<PairSolutions, OutOfReach> {
    let w = &belt_driven_link.vector;
    let (stretched, d) = (2.0 * one.length, point.norm());
    let along = (d - w.y.abs()) * (d + w.y.abs());
    let far = Vector2::new(w.x + stretched, w.y).norm();
    let near = Vector2::new((w.x - stretched).max(0.0), w.y).norm();
    if d > far * (1.0 + ROUND_OFF) || d < near - ROUND_OFF * far {
        return Err(OutOfReach { distance: d, min: near, max: far });
    }
    let along = along.max(0.0).sqrt();
    let mut solutions = [None; 4];
    let mut count = 0;
    for (sign, reaching) in [(1.0, ReachDirection::Forward), (-1.0, ReachDirection::Backward)] {
        let grown = sign * along - w.x;
        if grown.abs() > stretched * (1.0 + ROUND_OFF) || (sign < 0.0 && along == 0.0) {
            continue;
        }
        let reaching = (along > 0.0).then_some(reaching);
        if !(Configuration { elbow: None, reaching }).agrees_with(wanted) {
            continue;
        }
        // cos δ and sin δ in a form that does not cancel near the stretched arm.
        let across = ((stretched - grown) * (stretched + grown)).max(0.0).sqrt();
        let half = across.atan2(grown);
        let (direction, unit) = if d > 0.0 {
            let unit = within(&Vector2::new(sign * along, w.y), point) / (d * d);
            (angle(&unit), unit)
        } else {
            let direction = 0.5 * (like[0] + like[1]) + belt_driven_link.middle;
            (direction, turned(&Vector2::x(), direction))
        };
        for side in [1.0, -1.0] {
            let configuration = Configuration { elbow: elbow(side * across), reaching };
            if !configuration.agrees_with(wanted) || (across == 0.0 && side < 0.0) || count == 4 {
                continue;
            }
            let half = side * half;
            let pair = [direction + half - one.angle, direction - half - other.angle];
            let (along, aside) =
                (unit * (0.5 * grown), perpendicular(&unit) * (0.5 * side * across));
            let link_vectors = [along + aside, along - aside];
            let singular_coordinate = grown + w.x;
            solutions[count] =
                Some(PairSolution { pair, configuration, link_vectors, singular_coordinate });
            count += 1;
        }
    }
    Ok(solutions)
}

/// A prismatic joint along `unit` that carries a link.
#[inline]
fn prismatic(
    belt_driven_link: &LinkVector,
    unit: &Vector2<f64>,
    point: &Vector2<f64>,
    wanted: Configuration,
    like: [f64; 2],
) -> Result<PairSolutions, OutOfReach> {
    let w = within(unit, &belt_driven_link.vector);
    let d = point.norm();
    let aside = w.y.abs();
    if d < aside * (1.0 - ROUND_OFF) {
        return Err(OutOfReach { distance: d, min: aside, max: f64::INFINITY });
    }
    let along = ((d - aside) * (d + aside)).max(0.0).sqrt();
    let solution = |sign: f64, reaching| {
        let reaching = (along > 0.0).then_some(reaching);
        let configuration = Configuration { elbow: None, reaching };
        configuration.agrees_with(wanted).then(|| {
            let singular_coordinate = sign * along;
            let (turn, direction) = if d > 0.0 {
                let direction = within(&Vector2::new(singular_coordinate, w.y), point) / (d * d);
                (angle(&within(unit, &direction)), direction)
            } else {
                (like[0], turned(unit, like[0]))
            };
            let pair = [turn, singular_coordinate - w.x];
            PairSolution {
                pair,
                configuration,
                link_vectors: [*point, direction],
                singular_coordinate,
            }
        })
    };
    let backward = if along > 0.0 { solution(-1.0, ReachDirection::Backward) } else { None };
    Ok([solution(1.0, ReachDirection::Forward), backward, None, None])
}
