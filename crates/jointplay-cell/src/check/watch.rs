//! Distances between all pairs, looked at only as often as they can matter.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::found::{Found, Hit, When};
use super::report::{Kind, PairDistance, Unit};
use super::scene::{Places, Role, Rule, Scene};
use super::solid::{between_balls, depth, distance, gap_along};
use super::travel::{Gearing, Levers, Travel};
use crate::motion::{Motion, Sample};
use crate::program::Step;

/// By how much a least distance may be passed over, as a share of it.
const PASSED_SHARE: f64 = 0.02;
/// And at least [m].
const PASSED: f64 = 2e-5;
/// Travel between two looks below which nothing is looked for between them [m].
const FINEST: f64 = 2e-6;
/// How much of an arm's travel may go across its plane as the droop changes with reach.
const DROOPING: f64 = 0.02;

/// A lower bound of a distance, and how it wears off.
#[derive(Clone, Copy)]
struct Bound {
    distance: f64,
    /// Travel of both items when it was found.
    plane: f64,
    arm: f64,
    /// Angle that the platform's normal had turned by then.
    lean: f64,
    /// How much of the arms' travel counts: all of it, or what goes along the direction of a gap.
    sine: f64,
}

struct Pair {
    items: [usize; 2],
    rule: Rule,
    bound: Option<Bound>,
    least: Option<(f64, f64, usize)>,
}

/// Travel to come to before a pair is looked at, in the order of a heap.
#[derive(PartialEq)]
struct Due(f64, usize);

impl Eq for Due {}
impl PartialOrd for Due {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Due {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

/// All pairs of items.
pub(super) struct Watch {
    pairs: Vec<Pair>,
    gearing: Gearing,
    levers: Vec<Levers>,
    /// Of each item since the start, at most.
    travelled: Vec<Travel>,
    /// In the last interval.
    stepped: Vec<Travel>,
    lean: f64,
    /// By item that moves: pairs with one that stands, by the travel they are due at.
    due: Vec<BinaryHeap<Reverse<Due>>>,
    /// Pairs of which both move.
    both: Vec<usize>,
    /// Distance from which on none is followed [m].
    near: f64,
    /// The nearest pair of the instruction.
    pub(super) nearest: Option<(usize, f64, f64, usize)>,
    /// Looks at exact distances.
    pub(super) looks: usize,
}

/// One sample, with all that is needed at it.
pub(super) struct Now<'a> {
    pub(super) motion: &'a Motion,
    pub(super) scene: &'a Scene<'a>,
    pub(super) when: When<'a>,
    pub(super) places: &'a Places,
    /// The sample before, where the interval between lies within one step.
    pub(super) before: Option<&'a Sample>,
}

impl Watch {
    pub(super) fn new(scene: &Scene<'_>, near: f64) -> Self {
        let count = scene.items.len();
        let mut pairs = Vec::new();
        for a in 0..count {
            for b in a + 1..count {
                let zones = [a, b].map(|item| scene.items[item].role == Role::KeepOut);
                let still = [a, b].map(|item| {
                    scene.items[item].role != Role::Wafer && !scene.items[item].holder.moves()
                });
                if zones == [true, true] || still == [true, true] {
                    continue;
                }
                pairs.push(Pair { items: [a, b], rule: Rule::Free, bound: None, least: None });
            }
        }
        let robot = &scene.cell.robot;
        Self {
            pairs,
            gearing: Gearing::new(robot),
            levers: scene.items.iter().map(|item| Levers::new(robot, item)).collect(),
            travelled: vec![Travel::default(); count],
            stepped: vec![Travel::default(); count],
            lean: 0.0,
            due: (0..count).map(|_| BinaryHeap::new()).collect(),
            both: Vec::new(),
            near,
            nearest: None,
            looks: 0,
        }
    }

    /// An item changed hands: what was known of its distances holds no more.
    pub(super) fn forget(&mut self, scene: &Scene<'_>, item: usize) {
        self.levers[item] = Levers::new(&scene.cell.robot, &scene.items[item]);
        for pair in &mut self.pairs {
            if pair.items.contains(&item) {
                pair.bound = None;
            }
        }
    }

    /// What is asked of each pair in a step; all are due.
    pub(super) fn begin(&mut self, scene: &Scene<'_>, step: &Step) {
        for heap in &mut self.due {
            heap.clear();
        }
        self.both.clear();
        for (index, pair) in self.pairs.iter_mut().enumerate() {
            let [a, b] = pair.items;
            pair.rule = scene.rule(a, b, step);
            if pair.rule == Rule::Free {
                pair.bound = None;
                continue;
            }
            match (scene.items[a].holder.moves(), scene.items[b].holder.moves()) {
                (true, true) => self.both.push(index),
                (true, false) => self.due[a].push(Reverse(Due(f64::NEG_INFINITY, index))),
                (false, true) => self.due[b].push(Reverse(Due(f64::NEG_INFINITY, index))),
                (false, false) => {}
            }
        }
    }

    /// Counts what moved between two samples.
    pub(super) fn advance(&mut self, scene: &Scene<'_>, from: &Sample, to: &Sample) {
        let moved = self.gearing.moved(from, to);
        self.lean += moved.lean;
        for (item, levers) in self.levers.iter().enumerate() {
            if scene.items[item].holder.moves() {
                let travel = self.gearing.travel(levers, &moved);
                self.stepped[item] = travel;
                self.travelled[item].plane += travel.plane;
                self.travelled[item].arm += travel.arm;
            } else {
                self.stepped[item] = Travel::default();
            }
        }
    }

    /// What moved since the last sample is not known: no bound holds any more.
    pub(super) fn lose(&mut self) {
        for pair in &mut self.pairs {
            pair.bound = None;
        }
        for heap in &mut self.due {
            let all = std::mem::take(heap).into_iter();
            heap.extend(all.map(|Reverse(Due(_, index))| Reverse(Due(f64::NEG_INFINITY, index))));
        }
    }

    /// Looks at all pairs that are due.
    pub(super) fn look(&mut self, now: &Now<'_>, found: &mut Found) {
        for item in 0..self.due.len() {
            let travelled = self.travelled[item].total();
            let mut again = Vec::new();
            while let Some(Reverse(Due(at, index))) = self.due[item].peek() {
                if *at > travelled {
                    break;
                }
                let index = *index;
                self.due[item].pop();
                let slack = self.follow(index, now, found);
                again.push(Reverse(Due(travelled + slack.max(0.0), index)));
            }
            self.due[item].extend(again);
        }
        for place in 0..self.both.len() {
            self.follow(self.both[place], now, found);
        }
    }

    /// What is left of a pair's bound, and where that does not do, a new one; how much of it is to spare.
    fn follow(&mut self, index: usize, now: &Now<'_>, found: &mut Found) -> f64 {
        let pair = &self.pairs[index];
        let [a, b] = pair.items;
        let (rule, bound) = (pair.rule, pair.bound);
        let (limit, wanted) = match rule {
            Rule::Free => return f64::INFINITY,
            Rule::Out => (0.0, 0.0),
            Rule::Apart(limit) | Rule::Slots(limit) => (limit, self.wanted(index)),
        };
        let threshold = limit.max(wanted);
        let left = bound.map(|bound| self.left(&bound, a, b));
        if let Some(left) = left
            && left > threshold
        {
            return left - threshold;
        }
        let (first, second) = (now.scene.placed(a, now.places), now.scene.placed(b, now.places));
        let stepped = self.stepped[a].total() + self.stepped[b].total();
        // What the distance was at least at the sample before.
        let earlier = now.before.and(left).map(|left| left + stepped);
        let clear = |here: f64| earlier.is_none_or(|earlier| earlier + here > stepped);
        let balls = between_balls(first, second);
        if balls > threshold && clear(balls) {
            self.bind(index, balls, 1.0);
            return balls - threshold;
        }
        let normal = now.places.normal();
        let gap = gap_along(first, second, &normal);
        // Worth it only while it lasts: the platform's normal is where arms do not go.
        if gap > threshold && clear(gap) {
            self.bind(index, gap, DROOPING);
            return gap - threshold;
        }
        self.looks += 1;
        let apart = distance(first, second);
        let when = now.when;
        if rule != Rule::Out {
            self.note(index, apart, when);
        }
        if apart <= limit {
            self.report(index, now, found, apart, when.time, limit);
        }
        // Between the samples: contact, where the way between them is long enough for it.
        if let (Some(earlier), Some(before)) = (earlier, now.before)
            && apart > 0.0
            && earlier > 0.0
        {
            let ends = [(before.time, earlier), (when.time, apart)];
            if let Some(time) = self.between(index, now, ends, stepped) {
                self.report(index, now, found, 0.0, time, limit);
                if rule != Rule::Out {
                    self.note(index, 0.0, When { time, ..when });
                }
            }
        }
        self.bind(index, apart, 1.0);
        (apart - threshold).max(0.0)
    }

    /// A contact between two times with distances, or lower bounds of them, where no point goes farther than `way`.
    ///
    /// ```text
    ///    min d  ≥  (d_0 + d_1 − way) / 2
    /// ```
    fn between(
        &mut self,
        index: usize,
        now: &Now<'_>,
        [(t0, d0), (t1, d1)]: [(f64, f64); 2],
        way: f64,
    ) -> Option<f64> {
        if d0 + d1 > way || way < FINEST {
            return None;
        }
        let middle = 0.5 * (t0 + t1);
        let [a, b] = self.pairs[index].items;
        let places = now.scene.places(&now.motion.at(middle).positions).ok()?;
        self.looks += 1;
        let apart = distance(now.scene.placed(a, &places), now.scene.placed(b, &places));
        if apart == 0.0 {
            return Some(middle);
        }
        self.between(index, now, [(t0, d0), (middle, apart)], 0.5 * way)
            .or_else(|| self.between(index, now, [(middle, apart), (t1, d1)], 0.5 * way))
    }

    /// Distance below which a pair would be nearer than what is known already [m].
    fn wanted(&self, index: usize) -> f64 {
        let own = self.pairs[index].least.map_or(self.near, |(least, ..)| least);
        let all = self.nearest.map_or(self.near, |(_, least, ..)| least);
        let less = |value: f64| value - (PASSED_SHARE * value).max(PASSED);
        less(own.min(self.near)).max(less(all.min(self.near)))
    }

    fn bind(&mut self, index: usize, distance: f64, sine: f64) {
        let [a, b] = self.pairs[index].items;
        self.pairs[index].bound = Some(Bound {
            distance,
            plane: self.travelled[a].plane + self.travelled[b].plane,
            arm: self.travelled[a].arm + self.travelled[b].arm,
            lean: self.lean,
            sine,
        });
    }

    /// What is left of a bound.
    fn left(&self, bound: &Bound, a: usize, b: usize) -> f64 {
        let plane = self.travelled[a].plane + self.travelled[b].plane - bound.plane;
        let arm = self.travelled[a].arm + self.travelled[b].arm - bound.arm;
        bound.distance - plane - (bound.sine + self.lean - bound.lean).min(1.0) * arm
    }

    fn note(&mut self, index: usize, apart: f64, when: When<'_>) {
        let pair = &mut self.pairs[index];
        if apart < self.near && pair.least.is_none_or(|(least, ..)| apart < least) {
            pair.least = Some((apart, when.time, when.index));
        }
        if apart < self.near && self.nearest.is_none_or(|(_, least, ..)| apart < least) {
            self.nearest = Some((index, apart, when.time, when.index));
        }
    }

    fn report(
        &self,
        index: usize,
        now: &Now<'_>,
        found: &mut Found,
        apart: f64,
        time: f64,
        limit: f64,
    ) {
        let pair = &self.pairs[index];
        let [a, b] = pair.items;
        // What moves comes first.
        let [a, b] = if now.scene.items[a].holder.moves() { [a, b] } else { [b, a] };
        let (kind, value, limit) = match pair.rule {
            Rule::Out => (Kind::KeepOut, 0.0, 0.0),
            _ if apart == 0.0 => {
                let deep = if time == now.when.time {
                    depth(now.scene.placed(a, now.places), now.scene.placed(b, now.places))
                } else {
                    0.0
                };
                (Kind::Collision, -deep, 0.0)
            }
            Rule::Slots(_) => (Kind::SlotClearance, apart, limit),
            _ => (Kind::Clearance, apart, limit),
        };
        let hit = Hit {
            about: (Kind::Collision, a, b),
            kind,
            severity: -value,
            value,
            limit,
            unit: Unit::Length,
        };
        let when = When { time, ..now.when };
        found.add(when, &hit, || {
            let names = [a, b].map(|item| now.scene.items[item].name.clone());
            (names.to_vec(), String::new())
        });
    }

    /// The pair by index as a row.
    pub(super) fn row(
        &self,
        scene: &Scene<'_>,
        (index, distance, time, step): (usize, f64, f64, usize),
    ) -> PairDistance {
        let names = self.pairs[index].items.map(|item| scene.items[item].name.clone());
        let within = (PASSED_SHARE * distance).max(PASSED).min(distance);
        PairDistance { names, distance, within, time, step }
    }

    /// How near pairs came, nearest first.
    pub(super) fn distances(&self, scene: &Scene<'_>) -> Vec<PairDistance> {
        let mut rows: Vec<PairDistance> = (0..self.pairs.len())
            .filter_map(|index| {
                let (distance, time, step) = self.pairs[index].least?;
                Some(self.row(scene, (index, distance, time, step)))
            })
            .collect();
        rows.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.time.total_cmp(&b.time)));
        rows
    }
}
