//! One coordinate in time, by pieces of constant jerk.

use std::hash::Hasher;

/// Adds numbers to a hash, bit by bit.
pub(super) fn put(to: &mut impl Hasher, numbers: &[f64]) {
    numbers.iter().for_each(|number| to.write_u64(number.to_bits()));
}

/// Position, velocity, acceleration and jerk of one coordinate at one time.
pub(crate) type AxisState = [f64; 4];

/// A stretch of constant jerk.
#[derive(Debug, Clone, Copy)]
struct Piece {
    start: f64,
    state: AxisState,
}

/// A coordinate from rest to rest.
#[derive(Debug, Clone)]
pub(crate) struct JerkLimitedProfile {
    pieces: Vec<Piece>,
    duration: f64,
    end: f64,
}

impl JerkLimitedProfile {
    /// Standing still for a while.
    pub(crate) fn still(position: f64, duration: f64) -> Self {
        let piece = Piece { start: 0.0, state: [position, 0.0, 0.0, 0.0] };
        Self { pieces: vec![piece], duration, end: position }
    }

    /// From one position to another at rest, by stretches of (duration, jerk).
    ///
    /// What the stretches come to is scaled onto the distance, so that the end is met to round-off.
    pub(crate) fn through(from: f64, to: f64, stretches: &[(f64, f64)]) -> Self {
        let mut pieces = Vec::with_capacity(stretches.len());
        let mut state = [0.0, 0.0, 0.0, 0.0];
        let mut start = 0.0;
        for &(duration, jerk) in stretches.iter().filter(|(duration, _)| *duration > 0.0) {
            state[3] = jerk;
            pieces.push(Piece { start, state });
            state = after(&state, duration);
            start += duration;
        }
        let scale = if state[0] == 0.0 { 0.0 } else { (to - from) / state[0] };
        for piece in &mut pieces {
            for value in &mut piece.state {
                *value *= scale;
            }
            piece.state[0] += from;
        }
        Self { pieces, duration: start, end: to }
    }

    /// Adds all that it is made of to a hash.
    pub(crate) fn hash(&self, to: &mut impl Hasher) {
        put(to, &[self.duration, self.end]);
        for piece in &self.pieces {
            put(to, &[piece.start]);
            put(to, &piece.state);
        }
    }

    /// How long it takes [s].
    pub(crate) fn duration(&self) -> f64 {
        self.duration
    }

    /// Times at which the jerk changes, and the end [s].
    pub(crate) fn breaks(&self) -> impl Iterator<Item = f64> + '_ {
        self.pieces.iter().map(|piece| piece.start).chain([self.duration])
    }

    /// The state `time` after its start [s]; at rest outside of it.
    pub(crate) fn at(&self, time: f64) -> AxisState {
        if time >= self.duration {
            return [self.end, 0.0, 0.0, 0.0];
        }
        let place = self.pieces.partition_point(|piece| piece.start <= time);
        let piece = &self.pieces[place.saturating_sub(1)];
        after(&piece.state, (time - piece.start).max(0.0))
    }

    /// [`Self::at`] of times that grow.
    pub(crate) fn walk(&self) -> impl FnMut(f64) -> AxisState + '_ {
        let mut place = 0;
        move |time| {
            if time >= self.duration {
                return [self.end, 0.0, 0.0, 0.0];
            }
            while self.pieces.get(place + 1).is_some_and(|piece| piece.start <= time) {
                place += 1;
            }
            let piece = &self.pieces[place];
            after(&piece.state, (time - piece.start).max(0.0))
        }
    }

    /// When a curve that never goes back comes to a position [s].
    pub(crate) fn when(&self, position: f64) -> f64 {
        let next = self.pieces.partition_point(|piece| piece.state[0] < position);
        let piece = &self.pieces[next.saturating_sub(1)];
        let end = self.pieces.get(next).map_or(self.duration, |next| next.start);
        let (mut early, mut late) = (0.0, end - piece.start);
        for _ in 0..30 {
            let middle = 0.5 * (early + late);
            if after(&piece.state, middle)[0] < position { early = middle } else { late = middle }
        }
        piece.start + late
    }

    /// The same way, `factor` times as long.
    pub(crate) fn slowed(&self, factor: f64) -> Self {
        let by = 1.0 / factor;
        let pieces = self.pieces.iter().map(|piece| Piece {
            start: piece.start * factor,
            state: [
                piece.state[0],
                piece.state[1] * by,
                piece.state[2] * by * by,
                piece.state[3] * by * by * by,
            ],
        });
        Self { pieces: pieces.collect(), duration: self.duration * factor, end: self.end }
    }
}

fn after(state: &AxisState, t: f64) -> AxisState {
    let [p, v, a, j] = *state;
    [p + t * (v + t * (a / 2.0 + t * j / 6.0)), v + t * (a + t * j / 2.0), a + t * j, j]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_met_and_states_are_derivatives_of_each_other() {
        let curve = JerkLimitedProfile::through(
            1.0,
            3.0,
            &[(0.5, 8.0), (0.5, -8.0), (0.0, 5.0), (0.5, -8.0), (0.5, 8.0)],
        );
        assert_eq!(curve.at(0.0)[..3], [1.0, 0.0, 0.0]);
        assert_eq!(curve.at(curve.duration()), [3.0, 0.0, 0.0, 0.0]);
        let before = curve.at(curve.duration() - 1e-9);
        assert!((before[0] - 3.0).abs() < 1e-14 && before[1].abs() < 1e-7);
        for t in [0.1, 0.7, 1.3, 1.9] {
            let (h, now) = (1e-5, curve.at(t));
            let (past, next) = (curve.at(t - h), curve.at(t + h));
            for order in 0..3 {
                let slope = (next[order] - past[order]) / (2.0 * h);
                assert!((slope - now[order + 1]).abs() < 1e-6, "{t} {order}");
            }
        }
        let mut walk = curve.walk();
        for k in 0..=40 {
            let t = 0.05 * f64::from(k);
            assert_eq!(walk(t), curve.at(t));
            let when = curve.when(curve.at(t)[0]);
            assert!((when - t).abs() < 1e-5 && curve.at(when)[0] >= curve.at(t)[0] - 1e-15, "{t}");
        }
        let slow = curve.slowed(2.0);
        assert_eq!(slow.duration(), 4.0);
        assert!((slow.at(1.4)[1] - curve.at(0.7)[1] / 2.0).abs() < 1e-14);
    }
}
