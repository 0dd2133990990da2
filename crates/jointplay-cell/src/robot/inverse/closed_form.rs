//! Closed-form positions of the two unknowns that place the wafer's centre in the arm's plane.

use nalgebra::Vector2;

use super::decomposition::{Carried, Link, Pair, Plan};
use super::solution::{Configuration, Elbow, OutOfReach, ReachDirection};
use crate::robot::arm_chain::{ArmChain, LinkVector, dot, perpendicular, turned};

/// Share of the stretched length by which a point may be out of reach and counts as reached: round-off.
const STRETCHED: f64 = 1e-14;

/// One solution for both unknowns, with its configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub(super) pair: [f64; 2],
    pub(super) configuration: Configuration,
    /// Both link vectors; for a prismatic pair the whole span, and its direction [m].
    pub(super) arrows: [Vector2<f64>; 2],
    /// Distance of the configuration from its ends: the cosine of the elbow angle, or the reach ahead of the first joint [m].
    pub(super) from_end: f64,
}

/// Up to four solutions.
pub(super) type Ways = [Option<Found>; 4];

fn angle(vector: &Vector2<f64>) -> f64 {
    vector.y.atan2(vector.x)
}

/// A vector in the frame of another, multiplied by the length of that one.
fn within(frame: &Vector2<f64>, vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(frame.dot(vector), frame.perp(vector))
}

impl Plan {
    /// All values of the pair that span `point` [m] in configurations that agree with a given one.
    ///
    /// # Arguments
    /// * `like` – values of the pair that decide where any direction would do
    #[inline]
    pub(super) fn span(
        &self,
        planar: &ArmChain,
        point: &Vector2<f64>,
        bend: Configuration,
        like: [f64; 2],
    ) -> Result<Ways, OutOfReach> {
        match &self.pair {
            Pair::Links(pair) => links(pair, point, bend, like),
            Pair::Belt(pair, carried) => belt(pair, carried, point, bend, like),
            Pair::Slide(g) => {
                let slides = planar.slides();
                slide(&planar.arrows()[*g], &slides[0].along.vector, point, bend, like)
            }
        }
    }

    /// Derivatives of the spanned vector by both unknowns.
    #[inline]
    pub(super) fn span_change(&self, found: &Found, point: &Vector2<f64>) -> SpanChange {
        let [one, other] = found.arrows;
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
            Pair::Slide(_) => SpanChange {
                velocities: [perpendicular(&one), other],
                second: [-one, perpendicular(&other), Vector2::zeros()],
            },
        }
    }

    /// Direction in which a belt-coupled pair moves its wafer; for other pairs, the direction of the first link.
    pub(super) fn middle(&self, planar: &ArmChain, pair: [f64; 2]) -> Vector2<f64> {
        let first = |k: usize| turned(&planar.arrows()[k].vector, pair[0]).normalize();
        match &self.pair {
            Pair::Belt(_, carried) => {
                turned(&Vector2::x(), 0.5 * (pair[0] + pair[1]) + carried.middle)
            }
            Pair::Links([one, _]) => first(one.arrow),
            Pair::Slide(g) => first(*g),
        }
    }

    /// Configuration of the arm at positions of its axes.
    pub(super) fn configuration(&self, planar: &ArmChain, own: &[f64; 4]) -> Configuration {
        let arrows = planar.arrows();
        let at = |k: usize| turned(&arrows[k].vector, dot(&arrows[k].turn, own));
        match &self.pair {
            Pair::Links([i, j]) => {
                Configuration { elbow: elbow(-at(i.arrow).perp(&at(j.arrow))), reaching: None }
            }
            Pair::Belt(links, carried) => {
                let [i, j] = links.map(|link| link.arrow);
                let pair = [i, j].map(|k| dot(&arrows[k].turn, own));
                let axis = self.middle(planar, pair);
                Configuration {
                    elbow: elbow(axis.perp(&at(i))),
                    reaching: reaching(axis.dot(&(at(i) + at(j) + at(carried.arrow)))),
                }
            }
            Pair::Slide(g) => {
                let slide = &planar.slides()[0];
                let along = turned(&slide.along.vector, dot(&slide.along.turn, own));
                let tip = at(*g) + along * dot(&slide.growth, own);
                Configuration { elbow: None, reaching: reaching(along.dot(&tip)) }
            }
        }
    }
}

/// Derivatives of a spanned vector by the two unknowns of a pair.
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
    bend: Configuration,
    like: [f64; 2],
) -> Result<Ways, OutOfReach> {
    let (a, b, d) = (one.length, other.length, point.norm());
    let (min, max) = ((a - b).abs(), a + b);
    if d > max + STRETCHED * max || d < min - STRETCHED * max {
        return Err(OutOfReach { distance: d, min, max });
    }
    let cosine = (d * d - a * a - b * b) * 0.5;
    let product = (d + a + b) * (a + b - d) * (d + a - b) * (d - a + b);
    let sine = product.max(0.0).sqrt() * 0.5;
    let angle_between = sine.atan2(cosine);
    // The spanned vector in the frame of the first link, multiplied by the length of that link.
    let reach = Vector2::new(a * a + cosine, sine);
    let way = |side: f64| {
        let configuration = Configuration { elbow: elbow(-side * sine), reaching: None };
        configuration.agrees_with(bend).then(|| {
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
            let from_end = cosine / (a * b);
            Found { pair, configuration, arrows: [link, point - link], from_end }
        })
    };
    // Stretched or folded, both solutions are one.
    let second = if sine > 0.0 { way(-1.0) } else { None };
    Ok([way(1.0), second, None, None])
}

/// Links of length A at ±δ about the direction of the third link w: 2 A cos δ + w spans the distance.
#[inline]
fn belt(
    [one, other]: &[Link; 2],
    carried: &Carried,
    point: &Vector2<f64>,
    bend: Configuration,
    like: [f64; 2],
) -> Result<Ways, OutOfReach> {
    let w = &carried.vector;
    let (stretched, d) = (2.0 * one.length, point.norm());
    let along = (d - w.y.abs()) * (d + w.y.abs());
    let far = Vector2::new(w.x + stretched, w.y).norm();
    let near = Vector2::new((w.x - stretched).max(0.0), w.y).norm();
    if d > far * (1.0 + STRETCHED) || d < near - STRETCHED * far {
        return Err(OutOfReach { distance: d, min: near, max: far });
    }
    let along = along.max(0.0).sqrt();
    let mut ways = [None; 4];
    let mut count = 0;
    for (sign, reaching) in [(1.0, ReachDirection::Forward), (-1.0, ReachDirection::Backward)] {
        let grown = sign * along - w.x;
        if grown.abs() > stretched * (1.0 + STRETCHED) || (sign < 0.0 && along == 0.0) {
            continue;
        }
        let reaching = (along > 0.0).then_some(reaching);
        if !(Configuration { elbow: None, reaching }).agrees_with(bend) {
            continue;
        }
        // cos δ and sin δ in a form that does not cancel near the stretched arm.
        let across = ((stretched - grown) * (stretched + grown)).max(0.0).sqrt();
        let half = across.atan2(grown);
        let (direction, unit) = if d > 0.0 {
            let unit = within(&Vector2::new(sign * along, w.y), point) / (d * d);
            (angle(&unit), unit)
        } else {
            let direction = 0.5 * (like[0] + like[1]) + carried.middle;
            (direction, turned(&Vector2::x(), direction))
        };
        for side in [1.0, -1.0] {
            let configuration = Configuration { elbow: elbow(side * across), reaching };
            if !configuration.agrees_with(bend) || (across == 0.0 && side < 0.0) || count == 4 {
                continue;
            }
            let half = side * half;
            let pair = [direction + half - one.angle, direction - half - other.angle];
            let (along, aside) =
                (unit * (0.5 * grown), perpendicular(&unit) * (0.5 * side * across));
            let arrows = [along + aside, along - aside];
            let from_end = grown + w.x;
            ways[count] = Some(Found { pair, configuration, arrows, from_end });
            count += 1;
        }
    }
    Ok(ways)
}

/// A prismatic joint along `unit` that carries a link.
#[inline]
fn slide(
    carried: &LinkVector,
    unit: &Vector2<f64>,
    point: &Vector2<f64>,
    bend: Configuration,
    like: [f64; 2],
) -> Result<Ways, OutOfReach> {
    let w = within(unit, &carried.vector);
    let d = point.norm();
    let aside = w.y.abs();
    if d < aside * (1.0 - STRETCHED) {
        return Err(OutOfReach { distance: d, min: aside, max: f64::INFINITY });
    }
    let along = ((d - aside) * (d + aside)).max(0.0).sqrt();
    let way = |sign: f64, reaching| {
        let reaching = (along > 0.0).then_some(reaching);
        let configuration = Configuration { elbow: None, reaching };
        configuration.agrees_with(bend).then(|| {
            let from_end = sign * along;
            let (turn, direction) = if d > 0.0 {
                let direction = within(&Vector2::new(from_end, w.y), point) / (d * d);
                (angle(&within(unit, &direction)), direction)
            } else {
                (like[0], turned(unit, like[0]))
            };
            let pair = [turn, from_end - w.x];
            Found { pair, configuration, arrows: [*point, direction], from_end }
        })
    };
    let backward = if along > 0.0 { way(-1.0, ReachDirection::Backward) } else { None };
    Ok([way(1.0, ReachDirection::Forward), backward, None, None])
}
