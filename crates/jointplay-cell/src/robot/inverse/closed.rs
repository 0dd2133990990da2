//! Two unknowns of an arm from a point of its plane.

use nalgebra::Vector2;

use super::super::planar::{Arrow, Planar, ahead, dot, turned};
use super::plan::{Pair, Plan};
use super::{Configuration, Elbow, OutOfReach, Reaching};

/// A point counts as reached where it is beyond the stretched arm by no more than this share: round-off.
const STRETCHED: f64 = 1e-14;

/// Both unknowns, and how the arm is then bent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub(super) pair: [f64; 2],
    pub(super) configuration: Configuration,
}

/// Up to four ways.
pub(super) type Ways = [Option<Found>; 4];

fn angle(vector: &Vector2<f64>) -> f64 {
    vector.y.atan2(vector.x)
}

/// A vector in the frame of a unit vector.
fn within(unit: &Vector2<f64>, vector: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(unit.dot(vector), unit.perp(vector))
}

impl Plan {
    /// All values of the pair that span `point` [m].
    ///
    /// # Arguments
    /// * `like` – values of the pair that decide where every turn would do
    pub(super) fn span(
        &self,
        planar: &Planar,
        point: &Vector2<f64>,
        like: [f64; 2],
    ) -> Result<Ways, OutOfReach> {
        let arrows = planar.arrows();
        match self.pair {
            Pair::Links([i, j]) => links(&arrows[i], &arrows[j], point, like),
            Pair::Belt([i, j], w) => belt(&arrows[i], &arrows[j], &arrows[w], point, like),
            Pair::Slide(g) => slide(&arrows[g], &planar.slides()[0].along.vector, point, like),
        }
    }

    /// Velocities of the span by both unknowns.
    pub(super) fn span_velocities(&self, planar: &Planar, pair: [f64; 2]) -> [Vector2<f64>; 2] {
        let arrows = planar.arrows();
        match self.pair {
            Pair::Links([i, j]) => [
                ahead(&turned(&arrows[i].vector, pair[0])),
                ahead(&turned(&arrows[j].vector, pair[1])),
            ],
            Pair::Belt([i, j], w) => {
                let half = ahead(&turned(&arrows[w].vector, 0.5 * (pair[0] + pair[1]))) * 0.5;
                [
                    ahead(&turned(&arrows[i].vector, pair[0])) + half,
                    ahead(&turned(&arrows[j].vector, pair[1])) + half,
                ]
            }
            Pair::Slide(g) => {
                let along = turned(&planar.slides()[0].along.vector, pair[0]);
                let reach = turned(&arrows[g].vector, pair[0]) + along * pair[1];
                [ahead(&reach), along]
            }
        }
    }

    /// The direction in which a belt-coupled pair moves its wafer; that of the first arrow, where there is no belt.
    pub(super) fn middle(&self, planar: &Planar, pair: [f64; 2]) -> Vector2<f64> {
        let arrows = planar.arrows();
        match self.pair {
            Pair::Belt([i, j], w) => {
                let middle = Middle::of(&arrows[i], &arrows[j], &arrows[w]);
                turned(&Vector2::x(), 0.5 * (pair[0] + pair[1]) + middle.angle)
            }
            Pair::Links([i, _]) | Pair::Slide(i) => turned(&arrows[i].vector, pair[0]).normalize(),
        }
    }

    /// How the arm is bent at positions of its axes.
    pub(super) fn configuration(&self, planar: &Planar, own: &[f64; 4]) -> Configuration {
        let arrows = planar.arrows();
        let at = |k: usize| turned(&arrows[k].vector, dot(&arrows[k].turn, own));
        match self.pair {
            Pair::Links([i, j]) => {
                Configuration { elbow: elbow(-at(i).perp(&at(j))), reaching: None }
            }
            Pair::Belt([i, j], w) => {
                let pair = [i, j].map(|k| dot(&arrows[k].turn, own));
                let axis = self.middle(planar, pair);
                Configuration {
                    elbow: elbow(axis.perp(&at(i))),
                    reaching: reaching(axis.dot(&(at(i) + at(j) + at(w)))),
                }
            }
            Pair::Slide(g) => {
                let slide = &planar.slides()[0];
                let along = turned(&slide.along.vector, dot(&slide.along.turn, own));
                let tip = at(g) + along * dot(&slide.growth, own);
                Configuration { elbow: None, reaching: reaching(along.dot(&tip)) }
            }
        }
    }
}

fn elbow(left: f64) -> Option<Elbow> {
    match left {
        left if left > 0.0 => Some(Elbow::Left),
        left if left < 0.0 => Some(Elbow::Right),
        _ => None,
    }
}

fn reaching(forward: f64) -> Option<Reaching> {
    match forward {
        forward if forward > 0.0 => Some(Reaching::Forward),
        forward if forward < 0.0 => Some(Reaching::Backward),
        _ => None,
    }
}

/// Two links: the law of cosines, its sine by Heron's product so that nothing cancels near the stretched arm.
fn links(
    one: &Arrow,
    other: &Arrow,
    point: &Vector2<f64>,
    like: [f64; 2],
) -> Result<Ways, OutOfReach> {
    let (a, b, d) = (one.vector.norm(), other.vector.norm(), point.norm());
    let (min, max) = ((a - b).abs(), a + b);
    if d > max + STRETCHED * max || d < min - STRETCHED * max {
        return Err(OutOfReach { distance: d, min, max });
    }
    let cosine = (d * d - a * a - b * b) * 0.5;
    let product = (d + a + b) * (a + b - d) * (d + a - b) * (d - a + b);
    let sine = product.max(0.0).sqrt() * 0.5;
    let bend = sine.atan2(cosine);
    let (angle_one, angle_other) = (angle(&one.vector), angle(&other.vector));
    let way = |bend: f64| {
        let reach = Vector2::new(a + b * bend.cos(), b * bend.sin());
        let first = if d > 0.0 { angle(point) - angle(&reach) } else { like[0] + angle_one };
        Found {
            pair: [first - angle_one, first + bend - angle_other],
            configuration: Configuration { elbow: elbow(-bend.sin()), reaching: None },
        }
    };
    // Stretched or folded, both are one.
    let second = if sine > 0.0 { Some(way(-bend)) } else { None };
    Ok([Some(way(bend)), second, None, None])
}

/// The direction in which a belt-coupled arm moves its wafer.
struct Middle {
    angle_one: f64,
    angle_other: f64,
    /// Mean of both, from the mean of both turns [rad].
    angle: f64,
    /// The third arrow in that direction's frame, its x not negative [m].
    carried: Vector2<f64>,
}

impl Middle {
    fn of(one: &Arrow, other: &Arrow, carried: &Arrow) -> Self {
        let (angle_one, mut angle_other) = (angle(&one.vector), angle(&other.vector));
        let mut middle = 0.5 * (angle_one + angle_other);
        let mut w = turned(&carried.vector, -middle);
        if w.x < 0.0 {
            // Of the two mean directions the one in which the wafer is carried.
            let turn = if angle_other > 0.0 { -1.0 } else { 1.0 } * std::f64::consts::TAU;
            angle_other += turn;
            middle += 0.5 * turn;
            w = -w;
        }
        Self { angle_one, angle_other, angle: middle, carried: w }
    }
}

/// Links of length A at ±δ about the direction of the third arrow w: 2 A cos δ + w spans the distance.
fn belt(
    one: &Arrow,
    other: &Arrow,
    carried: &Arrow,
    point: &Vector2<f64>,
    like: [f64; 2],
) -> Result<Ways, OutOfReach> {
    let Middle { angle_one, angle_other, angle: middle, carried: w } =
        Middle::of(one, other, carried);
    let (stretched, d) = (2.0 * one.vector.norm(), point.norm());
    let along = (d - w.y.abs()) * (d + w.y.abs());
    let far = Vector2::new(w.x + stretched, w.y).norm();
    let near = Vector2::new((w.x - stretched).max(0.0), w.y).norm();
    if d > far * (1.0 + STRETCHED) || d < near - STRETCHED * far {
        return Err(OutOfReach { distance: d, min: near, max: far });
    }
    let along = along.max(0.0).sqrt();
    let mut ways = [None; 4];
    let mut count = 0;
    for (sign, reaching) in [(1.0, Reaching::Forward), (-1.0, Reaching::Backward)] {
        let grown = sign * along - w.x;
        if grown.abs() > stretched * (1.0 + STRETCHED) || (sign < 0.0 && along == 0.0) {
            continue;
        }
        // cos δ and sin δ without cancelling near the stretched arm.
        let across = ((stretched - grown) * (stretched + grown)).max(0.0).sqrt();
        let half = across.atan2(grown);
        let direction = if d > 0.0 {
            angle(point) - angle(&Vector2::new(sign * along, w.y))
        } else {
            0.5 * (like[0] + like[1]) + middle
        };
        for half in [half, -half] {
            let way = Found {
                pair: [direction + half - angle_one, direction - half - angle_other],
                configuration: Configuration {
                    elbow: elbow(half.sin()),
                    reaching: (along > 0.0).then_some(reaching),
                },
            };
            if !(across == 0.0 && half < 0.0) && count < 4 {
                ways[count] = Some(way);
                count += 1;
            }
        }
    }
    Ok(ways)
}

/// A slide along `unit` with an arrow on it.
fn slide(
    carried: &Arrow,
    unit: &Vector2<f64>,
    point: &Vector2<f64>,
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
        let turn = if d > 0.0 {
            angle(point) - angle(&Vector2::new(sign * along, w.y)) - angle(unit)
        } else {
            like[0]
        };
        Found {
            pair: [turn, sign * along - w.x],
            configuration: Configuration {
                elbow: None,
                reaching: (along > 0.0).then_some(reaching),
            },
        }
    };
    let backward = (along > 0.0).then(|| way(-1.0, Reaching::Backward));
    Ok([Some(way(1.0, Reaching::Forward)), backward, None, None])
}
