//! Jerk-limited profile of one coordinate: pieces of constant jerk.

use std::hash::Hasher;

use super::axis_state::{AxisState, StateColumns};

/// Largest number of steps in the search for the time at which a position is passed.
const MAX_ROOT_STEPS: usize = 60;
/// Change of that time at which the search ends, relative to the duration of the piece.
///
/// Newton's method squares it in the next step, which would be round-off.
const ROOT_TOLERANCE: f64 = 1e-7;

/// Adds numbers to a hash, bit by bit.
pub(super) fn hash_numbers(hasher: &mut impl Hasher, numbers: &[f64]) {
    numbers.iter().for_each(|number| hasher.write_u64(number.to_bits()));
}

/// A piece of a profile, in which the jerk is constant.
#[derive(Debug, Clone, Copy)]
struct Piece {
    start: f64,
    state: AxisState,
}

/// A piece of a profile, by itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProfilePiece {
    /// Duration (s).
    pub(crate) duration: f64,
    /// State at the start.
    initial: AxisState,
}

impl ProfilePiece {
    /// State at a time since the start of the piece (s).
    pub(crate) fn state(&self, time: f64) -> AxisState {
        advanced(&self.initial, time)
    }
}

/// Position of a coordinate over time, from rest to rest.
#[derive(Debug, Clone)]
pub(crate) struct JerkLimitedProfile {
    pieces: Vec<Piece>,
    duration: f64,
    end: f64,
}

impl JerkLimitedProfile {
    /// A profile at rest in one position.
    pub(crate) fn at_rest(position: f64, duration: f64) -> Self {
        let piece = Piece { start: 0.0, state: [position, 0.0, 0.0, 0.0] };
        Self { pieces: vec![piece], duration, end: position }
    }

    /// A profile from rest in one position to rest in another, by pieces of (duration, jerk).
    ///
    /// All derivatives are scaled so that the pieces amount to the displacement, and the end is met to round-off.
    pub(crate) fn from_pieces(from: f64, to: f64, pieces: &[(f64, f64)]) -> Self {
        let mut profile = Vec::with_capacity(pieces.len());
        let mut state = [0.0, 0.0, 0.0, 0.0];
        let mut start = 0.0;
        for &(duration, jerk) in pieces.iter().filter(|(duration, _)| *duration > 0.0) {
            state[3] = jerk;
            profile.push(Piece { start, state });
            state = advanced(&state, duration);
            start += duration;
        }
        let scale = if state[0] == 0.0 { 0.0 } else { (to - from) / state[0] };
        for piece in &mut profile {
            for value in &mut piece.state {
                *value *= scale;
            }
            piece.state[0] += from;
        }
        Self { pieces: profile, duration: start, end: to }
    }

    /// Adds everything that determines the profile to a hash.
    pub(crate) fn hash(&self, hasher: &mut impl Hasher) {
        hash_numbers(hasher, &[self.duration, self.end]);
        for piece in &self.pieces {
            hash_numbers(hasher, &[piece.start]);
            hash_numbers(hasher, &piece.state);
        }
    }

    /// Duration (s).
    pub(crate) fn duration(&self) -> f64 {
        self.duration
    }

    /// Duration of the first piece, in which the acceleration grows from zero (s).
    pub(crate) fn ramp_duration(&self) -> f64 {
        self.pieces.get(1).map_or(self.duration, |second| second.start)
    }

    /// Times at which the jerk changes, and the end (s).
    pub(crate) fn jerk_discontinuities(&self) -> impl Iterator<Item = f64> + '_ {
        self.pieces.iter().map(|piece| piece.start).chain([self.duration])
    }

    /// Pieces of constant jerk, in order.
    pub(crate) fn pieces(&self) -> impl ExactSizeIterator<Item = ProfilePiece> + '_ {
        (0..self.pieces.len()).map(|index| {
            let piece = &self.pieces[index];
            let end = self.pieces.get(index + 1).map_or(self.duration, |next| next.start);
            ProfilePiece { duration: end - piece.start, initial: piece.state }
        })
    }

    /// State at a time since the start (s); from the end on at rest.
    pub(crate) fn state(&self, time: f64) -> AxisState {
        if time >= self.duration {
            return [self.end, 0.0, 0.0, 0.0];
        }
        let next = self.pieces.partition_point(|piece| piece.start <= time);
        let piece = &self.pieces[next.saturating_sub(1)];
        advanced(&piece.state, (time - piece.start).max(0.0))
    }

    /// As [`Self::state`], for times in growing order: each call continues the search where the last one ended.
    pub(crate) fn states_in_order(&self) -> impl FnMut(f64) -> AxisState + '_ {
        let mut current = 0;
        move |time| {
            if time >= self.duration {
                return [self.end, 0.0, 0.0, 0.0];
            }
            while self.pieces.get(current + 1).is_some_and(|piece| piece.start <= time) {
                current += 1;
            }
            let piece = &self.pieces[current];
            advanced(&piece.state, (time - piece.start).max(0.0))
        }
    }

    /// States at times in growing order (s), as by [`Self::state`].
    ///
    /// # Arguments
    /// * `lift` – length that is added to all positions (m)
    pub(super) fn write_states(&self, times: &[f64], lift: f64, states: &mut StateColumns) {
        let ended = times.partition_point(|&time| time < self.duration);
        let mut first = 0;
        for (index, piece) in self.pieces.iter().enumerate() {
            let end = match self.pieces.get(index + 1) {
                Some(next) => {
                    first + times[first..ended].partition_point(|&time| time < next.start)
                }
                None => ended,
            };
            states.map(first..end, [times], |[time]| {
                let [position, velocity, acceleration, jerk] =
                    advanced(&piece.state, time - piece.start);
                [position + lift, velocity, acceleration, jerk]
            });
            first = end;
        }
        states.fill(ended..times.len(), [self.end + lift, 0.0, 0.0, 0.0]);
    }

    /// Times at which a profile whose velocity is never negative passes positions in growing order (s).
    pub(crate) fn times_at(&self, positions: &[f64]) -> impl Iterator<Item = f64> {
        let mut current = 0;
        positions.iter().map(move |&position| {
            while self.pieces.get(current + 1).is_some_and(|next| next.state[0] < position) {
                current += 1;
            }
            self.time_in_piece(current, position)
        })
    }

    /// Time at which a piece passes a position (s).
    fn time_in_piece(&self, index: usize, position: f64) -> f64 {
        let piece = &self.pieces[index];
        let (end, end_position) = match self.pieces.get(index + 1) {
            Some(next) => (next.start, next.state[0]),
            None => (self.duration, self.end),
        };
        let whole = end - piece.start;
        let (mut early, mut late) = (0.0, whole);
        let fraction = (position - piece.state[0]) / (end_position - piece.state[0]);
        let mut time = if fraction > 0.0 { fraction.min(1.0) * whole } else { 0.0 };
        // Newton's method in a bracket, which is halved where a step would leave it.
        for _ in 0..MAX_ROOT_STEPS {
            let [reached, velocity, ..] = advanced(&piece.state, time);
            if reached < position {
                early = time;
            } else {
                late = time;
            }
            let newton = time + (position - reached) / velocity;
            let is_inside = newton >= early && newton <= late;
            let next = if is_inside { newton } else { 0.5 * (early + late) };
            let is_found = (next - time).abs() <= ROOT_TOLERANCE * whole;
            time = next;
            if is_found {
                break;
            }
        }
        piece.start + time
    }

    /// The profile stretched in time by a factor.
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

/// A state after a time (s) at its constant jerk.
#[inline(always)]
fn advanced(state: &AxisState, t: f64) -> AxisState {
    let [p, v, a, j] = *state;
    [p + t * (v + t * (a / 2.0 + t * j / 6.0)), v + t * (a + t * j / 2.0), a + t * j, j]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profile_meets_its_end_and_its_state_holds_derivatives() {
        let profile = JerkLimitedProfile::from_pieces(
            1.0,
            3.0,
            &[(0.5, 8.0), (0.5, -8.0), (0.0, 5.0), (0.5, -8.0), (0.5, 8.0)],
        );
        assert_eq!(profile.state(0.0)[..3], [1.0, 0.0, 0.0]);
        assert_eq!(profile.state(profile.duration()), [3.0, 0.0, 0.0, 0.0]);
        let before = profile.state(profile.duration() - 1e-9);
        assert!((before[0] - 3.0).abs() < 1e-14 && before[1].abs() < 1e-7);
        for t in [0.1, 0.7, 1.3, 1.9] {
            let (h, now) = (1e-5, profile.state(t));
            let (past, next) = (profile.state(t - h), profile.state(t + h));
            for order in 0..3 {
                let slope = (next[order] - past[order]) / (2.0 * h);
                assert!((slope - now[order + 1]).abs() < 1e-6, "{t} {order}");
            }
        }
        let mut in_order = profile.states_in_order();
        for k in 0..=40 {
            let t = 0.05 * f64::from(k);
            assert_eq!(in_order(t), profile.state(t));
            let found = profile.times_at(&[profile.state(t)[0]]).next().unwrap();
            assert!(
                (found - t).abs() < 1e-5 && profile.state(found)[0] >= profile.state(t)[0] - 1e-15,
                "{t}"
            );
        }
        let slow = profile.slowed(2.0);
        assert_eq!(slow.duration(), 4.0);
        assert!((slow.state(1.4)[1] - profile.state(0.7)[1] / 2.0).abs() < 1e-14);
    }
}
