//! Distances of bodies in one step, looked at only as often as they can matter.

use std::ops::Range;

use nalgebra::Vector3;

use super::allowed_collisions::Rule;
use super::link_poses::Places;
use super::motion_bound::{Gearing, Travel};
use super::motion_bound_coefficients::Levers;
use super::object::Holder;
use super::sampled_segment::Course;
use super::scene::Scene;
use super::unknown_pose::Lost;
use crate::geometry::{Placed, apart, between_balls, depth, distance, gap_along};
use crate::trajectory::{Sample, Trajectory};
use crate::violation::{Found, Hit, Kind, Stretch, Unit, When};

/// By how much a least distance may be passed over, as a share of it.
const PASSED_SHARE: f64 = 0.02;
/// And at least [m].
const PASSED: f64 = 2e-5;
/// Travel between two looks below which nothing is looked for between them [m].
const FINEST: f64 = 2e-6;
/// Resolution of comparisons of distances with what is asked for: what distances are tested to be exact to [m].
///
/// A pair is too near where its distance is less than what is asked for by more than this; where it touches, it is so whatever is asked for.
pub(crate) const RESOLUTION: f64 = 1e-8;

/// How much less than a least distance another one may have been that was passed over [m].
pub(crate) fn passed(distance: f64) -> f64 {
    (PASSED_SHARE * distance).max(PASSED)
}

/// What is found of the distances in a step; items are indices into those that were looked at, times are since its start.
pub(crate) struct Near {
    pub(crate) least: Vec<Least>,
    pub(crate) found: Vec<Stretch>,
}

/// The least distance of a pair at the samples, where it is followed.
pub(crate) struct Least {
    pub(crate) items: [usize; 2],
    pub(crate) distance: f64,
    pub(crate) time: f64,
}

/// Two items, the first of which moves, and what is asked of them.
#[derive(Clone, Copy)]
pub(crate) struct Pair {
    pub(crate) items: [usize; 2],
    pub(crate) rule: Rule,
}

/// Pairs, and what is known of them from the windows of a step that were looked at.
pub(crate) struct Pairs<'p> {
    pairs: &'p [Pair],
    /// Of each: the least distance, and when.
    least: Vec<Option<(f64, f64)>>,
    /// Of each: along what the second was from the first where that was looked at last.
    along: Vec<Option<Vector3<f64>>>,
    found: Found,
}

impl<'p> Pairs<'p> {
    pub(crate) fn new(pairs: &'p [Pair]) -> Self {
        let (least, along) = (vec![None; pairs.len()], vec![None; pairs.len()]);
        Self { pairs, least, along, found: Found::default() }
    }

    pub(crate) fn finished(self) -> Near {
        let pairs = self.pairs.iter().zip(self.least);
        let least = pairs.filter_map(|(pair, least)| {
            least.map(|(distance, time)| Least { items: pair.items, distance, time })
        });
        Near { least: least.collect(), found: self.found.finished() }
    }
}

/// A window of a step, and what is near its way.
pub(crate) struct Look<'a> {
    pub(crate) scene: &'a Scene<'a>,
    pub(crate) motion: &'a Trajectory,
    pub(crate) step: usize,
    pub(crate) course: &'a mut Course,
    /// Items of the scene, those that move first, as in the course.
    pub(crate) items: &'a [usize],
    pub(crate) gearing: &'a Gearing,
    /// Of those that move.
    pub(crate) levers: &'a [Levers],
    /// Of the pairs of them, which come first, against what carries both.
    pub(crate) between: &'a [(Levers, Holder)],
    /// Distance from which on none is followed [m].
    pub(crate) near: f64,
}

impl Look<'_> {
    /// Looks at pairs during runs of samples of the step, as far as they are in the window.
    ///
    /// ```text
    ///    min d  ≥  (d_0 + d_1 − way) / 2
    ///    min d  ≥  min(g_0, g_1) - bend dt / 4 - across
    /// ```
    /// over an interval with the distances d_0 and d_1 at its ends, or lower bounds of them, where no point goes farther than the way, and with the gaps g_0 and g_1 along one direction, from which points that go straight beside what is there do not stray:
    /// as long as neither keeps a pair apart, the interval is halved, down to the samples, and between them where they do not rule out that the pair comes too near.
    pub(crate) fn at(&mut self, pairs: &mut Pairs<'_>, runs: &[Range<usize>]) {
        let (first, count) = (self.course.first(), self.course.times().len());
        let within = |run: &Range<usize>| {
            let local = run.start.saturating_sub(first)..run.end.saturating_sub(first).min(count);
            (!local.is_empty()).then_some(local)
        };
        let runs: Vec<Range<usize>> = runs.iter().filter_map(within).collect();
        let mut lost: Vec<Lost> = Vec::new();
        for (place, pair) in pairs.pairs.iter().enumerate() {
            let asked = match pair.rule {
                Rule::Apart(limit) | Rule::Slots(limit) => limit,
                Rule::Free | Rule::Out => 0.0,
            };
            let limit = (asked - RESOLUTION).max(0.0);
            // What stands is no less than the world.
            let of_mover = || (self.levers[pair.items[0]], Holder::World);
            let (levers, common) = self.between.get(place).copied().unwrap_or_else(of_mover);
            let mut search = Search {
                look: self,
                pair,
                limit,
                levers,
                common,
                least: pairs.least[place],
                seen: Vec::new(),
                along: pairs.along[place],
            };
            for run in &runs {
                if let Err(one) = search.run(run) {
                    lost.push(one);
                }
            }
            let Search { least, mut seen, along, .. } = search;
            (pairs.least[place], pairs.along[place]) = (least, along);
            seen.sort_by(|one, other| one.when.time.total_cmp(&other.when.time));
            for Seen { when: When { time, sample }, apart, deep } in seen {
                let when = When { time, sample: first + sample };
                pairs.found.add(when, pair.hit(apart, deep, asked), String::new);
            }
        }
        // Between two samples a pose may be unknown that is known at both: nothing is known of the pair there.
        lost.sort_by(|one, other| one.when.time.total_cmp(&other.when.time));
        for mut lost in lost {
            lost.when.sample += first;
            lost.report(&mut pairs.found);
        }
    }

    fn placed<'b>(&'b self, places: &'b Places, [a, b]: [usize; 2]) -> [Placed<'b>; 2] {
        [a, b].map(|item| self.scene.placed(self.items[item], places))
    }
}

impl Pair {
    fn hit(&self, apart: f64, deep: f64, limit: f64) -> Hit {
        let (kind, value, limit) = match self.rule {
            Rule::Out => (Kind::KeepOut, 0.0 - deep, 0.0),
            _ if apart == 0.0 => (Kind::Collision, -deep, 0.0),
            Rule::Slots(_) => (Kind::SlotClearance, apart, limit),
            _ => (Kind::Clearance, apart, limit),
        };
        let [a, b] = self.items;
        let about = (Kind::Collision, a, b);
        Hit { about, kind, severity: -value, value, limit, unit: Unit::Length }
    }
}

/// A pair too near.
struct Seen {
    when: When,
    apart: f64,
    deep: f64,
}

/// One pair.
struct Search<'l, 'a> {
    look: &'l mut Look<'a>,
    pair: &'l Pair,
    /// Distance at which it is too near: the one asked for, less the resolution [m].
    limit: f64,
    levers: Levers,
    /// What they move against.
    common: Holder,
    /// Least distance, and when.
    least: Option<(f64, f64)>,
    seen: Vec<Seen>,
    /// Along what the second was from the first where that was looked at last, as seen from what they move against: it is about the same near by.
    along: Option<Vector3<f64>>,
}

/// What is known of a distance at one time.
#[derive(Clone, Copy)]
struct Known {
    /// The distance, or a lower bound of it [m].
    apart: f64,
    is_exact: bool,
    /// Its part along the platform's normal, at least: where arms do not go [m].
    gap: f64,
}

/// How far both came in an interval, at most.
#[derive(Clone, Copy)]
struct Way {
    /// In any direction [m].
    whole: f64,
    /// Along the platform's normal [m].
    along: f64,
    /// By the rods alone [m].
    plane: f64,
    /// By droop alone [m].
    droop: f64,
    /// Of that, in other directions than up and down [m].
    aside: f64,
    /// Angle by which the platform's normal turned [rad].
    lean: f64,
    /// How far from straight the arms took anything [m].
    bent: f64,
}

impl Way {
    /// In either half of the interval: ways are those at the largest speed for the whole time.
    fn half(self) -> Self {
        let Self { whole, along, plane, droop, aside, lean, bent } = self;
        let [whole, along, plane, droop, aside, lean] =
            [whole, along, plane, droop, aside, lean].map(|way| 0.5 * way);
        Self { whole, along, plane, droop, aside, lean, bent }
    }
}

/// A lower bound of the distance in an interval.
fn bound(left: &Known, right: &Known, way: Way) -> f64 {
    let plain = left.apart + right.apart - way.whole;
    let gap = left.gap + right.gap - way.along;
    0.5 * plain.max(gap)
}

impl Known {
    fn of(look: &Look<'_>, places: &Places, items: [usize; 2]) -> Self {
        let [a, b] = look.placed(places, items);
        let gap = gap_along(a, b, &places.normal);
        Self { apart: between_balls(a, b), is_exact: false, gap }
    }
}

impl Search<'_, '_> {
    fn run(&mut self, run: &Range<usize>) -> Result<(), Lost> {
        let last = run.end - 1;
        let mut left = self.known(run.start)?;
        if last == run.start {
            return self.matters(run.start, &mut left);
        }
        let mut right = self.known(last)?;
        self.search(run.start..last, &mut left, &mut right)
    }

    /// Between two samples.
    fn search(
        &mut self,
        between: Range<usize>,
        left: &mut Known,
        right: &mut Known,
    ) -> Result<(), Lost> {
        let way = self.way(&between);
        if bound(left, right, way) > self.threshold() {
            return Ok(());
        }
        self.tighten(between.start, left)?;
        self.tighten(between.end, right)?;
        if bound(left, right, way).max(self.beside(&between, way)?) > self.threshold() {
            return Ok(());
        }
        if between.len() == 1 {
            self.matters(between.start, left)?;
            self.matters(between.end, right)?;
            if bound(left, right, way).max(self.beside(&between, way)?) > self.limit {
                return Ok(());
            }
            self.exact(between.start, left)?;
            self.exact(between.end, right)?;
            let times = [between.start, between.end].map(|k| self.look.course.times()[k]);
            self.between(between.end, times, [*left, *right], way)?;
            return Ok(());
        }
        let middle = between.start.midpoint(between.end);
        let mut center = self.known(middle)?;
        // The nearer half first: what it comes to spares looks at the other.
        if left.apart <= right.apart {
            self.search(between.start..middle, left, &mut center)?;
            self.search(middle..between.end, &mut center, right)
        } else {
            self.search(middle..between.end, &mut center, right)?;
            self.search(between.start..middle, left, &mut center)
        }
    }

    /// Between two neighbouring samples, where they do not rule out that the pair comes too near; whether it was found to touch.
    fn between(
        &mut self,
        sample: usize,
        times: [f64; 2],
        ends: [Known; 2],
        way: Way,
    ) -> Result<bool, Lost> {
        let [left, right] = &ends;
        if left.apart == 0.0 || right.apart == 0.0 {
            return Ok(false);
        }
        // Where it is too near already, only a contact is worse.
        let level = if left.apart.min(right.apart) <= self.limit { 0.0 } else { self.limit };
        if bound(left, right, way) > level || way.whole < FINEST {
            return Ok(false);
        }
        let time = 0.5 * (times[0] + times[1]);
        let when = When { time, sample };
        let look = &mut *self.look;
        let mut state = Sample::default();
        look.motion.write_sample_in_step(look.step, time, &mut state);
        let places = look.scene.places(&state.positions, Vec::new());
        let places = places.map_err(|why| Lost { when, why })?;
        let [a, b] = look.placed(&places, self.pair.items);
        let mut middle = Known::of(look, &places, self.pair.items);
        (middle.apart, middle.is_exact) = (distance(a, b), true);
        if middle.apart <= self.limit {
            self.seen.push(Seen { when, apart: middle.apart, deep: 0.0 });
        }
        if middle.apart == 0.0 {
            self.note(0.0, time);
            return Ok(true);
        }
        let half = way.half();
        Ok(self.between(sample, [times[0], time], [*left, middle], half)?
            || self.between(sample, [time, times[1]], [middle, *right], half)?)
    }

    fn known(&mut self, sample: usize) -> Result<Known, Lost> {
        let look = &mut *self.look;
        look.course.place(look.scene, sample)?;
        Ok(Known::of(look, look.course.placed(sample)?, self.pair.items))
    }

    /// Raises the lower bound to the gap along what the two were apart when last looked at.
    fn tighten(&mut self, sample: usize, known: &mut Known) -> Result<(), Lost> {
        let (false, Some(along)) = (known.is_exact, &self.along) else { return Ok(()) };
        let places = self.look.course.placed(sample)?;
        let [a, b] = self.look.placed(places, self.pair.items);
        let turned = self.look.scene.turned(self.common, places);
        known.apart = known.apart.max(gap_along(a, b, &(turned * along)));
        Ok(())
    }

    /// Finds the distance at a sample, unless it is known not to matter.
    fn matters(&mut self, sample: usize, known: &mut Known) -> Result<(), Lost> {
        if known.apart.max(known.gap) <= self.threshold() {
            self.tighten(sample, known)?;
        }
        if known.apart.max(known.gap) <= self.threshold() {
            self.exact(sample, known)?;
        }
        Ok(())
    }

    /// The distance itself.
    fn exact(&mut self, sample: usize, known: &mut Known) -> Result<(), Lost> {
        if known.is_exact {
            return Ok(());
        }
        let look = &mut *self.look;
        let places = look.course.placed(sample)?;
        let [a, b] = look.placed(places, self.pair.items);
        let turned = look.scene.turned(self.common, places);
        let guess = self.along.map(|along| turned * along);
        let found = apart(a, b, guess.as_ref());
        let apart = found.distance;
        self.along = found.along.map(|along| turned.inverse() * along).or(self.along);
        (known.apart, known.is_exact) = (apart, true);
        let time = look.course.times()[sample];
        if apart <= self.limit {
            let deep = if apart == 0.0 { depth(a, b) } else { 0.0 };
            self.seen.push(Seen { when: When { time, sample }, apart, deep });
        }
        self.note(apart, time);
        Ok(())
    }

    fn note(&mut self, apart: f64, time: f64) {
        let nearer = match self.least {
            Some((least, earlier)) => apart < least || (apart == least && time < earlier),
            None => apart < self.look.near,
        };
        if nearer && self.pair.rule != Rule::Out {
            self.least = Some((apart, time));
        }
    }

    /// Distance above which nothing matters [m].
    fn threshold(&self) -> f64 {
        if self.pair.rule == Rule::Out {
            return 0.0;
        }
        let known = self.least.map_or(self.look.near, |(least, _)| least);
        self.limit.max(known - passed(known))
    }

    fn way(&self, between: &Range<usize>) -> Way {
        let Look { course, gearing, .. } = &*self.look;
        let moved = course.moved(between);
        let levers = &self.levers;
        let Travel { plane, arm, droop, aside, hang } = gearing.travel(levers, &moved);
        let [from, to] = [between.start, between.end].map(|k| course.times()[k]);
        let bent = 0.25 * (to - from) * gearing.bend(levers, &moved);
        let lean = moved.lean.min(1.0);
        // Where the platform carries both, it changes no more than how they droop.
        let (plane, swung) =
            if self.common == Holder::World { (plane, lean * arm) } else { (hang, 0.0) };
        let (whole, along) = (plane + arm + droop, plane + droop + swung);
        Way { whole, along, plane, droop, aside, lean, bent }
    }

    /// A lower bound of the distance in an interval, by the gap along what the two were apart when last looked at.
    ///
    /// A point whose coordinate along it changes its speed by `bend` in all strays from the straight way between two times by `bend dt / 4` at most.
    fn beside(&self, between: &Range<usize>, way: Way) -> Result<f64, Lost> {
        let Some(along) = &self.along else { return Ok(f64::NEG_INFINITY) };
        let look = &*self.look;
        let mut least = f64::INFINITY;
        let mut upward = 0.0_f64;
        for sample in [between.start, between.end] {
            let places = look.course.placed(sample)?;
            let [a, b] = look.placed(places, self.pair.items);
            let along = look.scene.turned(self.common, places) * along;
            // On the same side at both ends: what passes through something is apart from it before and after.
            least = least.min(b.span(&along).least - a.span(&along).most);
            let tilt = (places.normal - Vector3::z()).norm();
            upward = upward.max(along.dot(&places.normal).abs() + tilt);
        }
        // What droops goes down, and hardly aside.
        let droop = (upward + way.lean).min(1.0) * way.droop + way.aside;
        Ok(least - way.bent - 2.0 * (way.plane + droop))
    }
}
