//! Functions of time as cubics between keys.

/// Functions of time that channels approximate, one number each.
pub(super) trait Functions {
    type Error;

    /// Values at a time.
    fn values(&self, time: f64) -> Result<Vec<f64>, Self::Error>;

    /// Derivatives by time at a time, which may take longer than the values.
    fn rates(&self, time: f64) -> Result<Vec<f64>, Self::Error>;
}

/// Values and rates of all channels at one time.
#[derive(Clone)]
struct State {
    time: f64,
    values: Vec<f64>,
    rates: Vec<f64>,
}

/// A function of time as cubics between keys; before the first key and after the last it is constant.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Channel {
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
    pub(super) rates: Vec<f64>,
}

/// Shortest interval that is halved (s).
const SHORTEST: f64 = 1e-3;
/// Shares of an interval at which its cubic is compared with the function; the first one is that of the next key.
const PROBES: [f64; 3] = [0.5, 0.25, 0.75];

/// The value of the cubic between two keys, a time after the first.
pub(super) fn cubic([v0, v1]: [f64; 2], [r0, r1]: [f64; 2], width: f64, since: f64) -> f64 {
    let s = since / width;
    let (one, two) = (v1 - v0 - r0 * width, r1 * width - (v1 - v0));
    // Newton form: exact at both ends, with their slopes.
    v0 + s * (r0 * width + s * (one + (s - 1.0) * (two - one)))
}

/// Keys of several channels over an interval of time.
///
/// Intervals between breaks are halved until the cubics are within their tolerances; then keys that follow from their neighbours are removed, channel by channel.
/// Rates are computed at the ends of these intervals only.
///
/// # Arguments
/// * `breaks` – growing times at which a derivative of a channel may jump; first and last are the ends (s)
/// * `tolerances` – for each channel, in its unit
///
/// # Errors
/// Those of the functions.
pub(super) fn channels<F: Functions>(
    breaks: &[f64],
    tolerances: &[f64],
    functions: &F,
) -> Result<Vec<Channel>, F::Error> {
    let mut states: Vec<State> = Vec::with_capacity(2 * breaks.len());
    for &time in breaks {
        let next = State { time, values: functions.values(time)?, rates: functions.rates(time)? };
        if let Some(last) = states.pop() {
            between(last, &next, tolerances, functions, &mut states)?;
        }
        states.push(next);
    }
    Ok(tolerances.iter().enumerate().map(|(k, &tolerance)| pruned(&states, k, tolerance)).collect())
}

/// Adds the first state, and those that are needed between it and the second.
fn between<F: Functions>(
    first: State,
    second: &State,
    tolerances: &[f64],
    functions: &F,
    states: &mut Vec<State>,
) -> Result<(), F::Error> {
    let width = second.time - first.time;
    if width > 2.0 * SHORTEST {
        let fits = |time: f64, expected: &[f64]| {
            tolerances.iter().enumerate().all(|(k, tolerance)| {
                let (values, rates) =
                    ([first.values[k], second.values[k]], [first.rates[k], second.rates[k]]);
                let found = cubic(values, rates, width, time - first.time);
                (found - expected[k]).abs() <= *tolerance
            })
        };
        let [time, early, late] = PROBES.map(|share| first.time + share * width);
        let values = functions.values(time)?;
        // A cubic that is not within its tolerance usually misses the middle.
        let all_fit = fits(time, &values)
            && fits(early, &functions.values(early)?)
            && fits(late, &functions.values(late)?);
        if !all_fit {
            let middle = State { time, values, rates: functions.rates(time)? };
            between(first, &middle, tolerances, functions, states)?;
            return between(middle, second, tolerances, functions, states);
        }
    }
    states.push(first);
    Ok(())
}

/// One channel with as few of the states as it needs.
fn pruned(states: &[State], k: usize, tolerance: f64) -> Channel {
    let mut channel = Channel::default();
    let mut add = |state: &State| {
        channel.times.push(state.time);
        channel.values.push(state.values[k]);
        channel.rates.push(state.rates[k]);
    };
    let (first, last) = (0, states.len() - 1);
    let is_constant = states.iter().all(|state| {
        (state.values[k] - states[first].values[k]).abs() <= 0.5 * tolerance
            && state.rates[k].abs() * (state.time - states[first].time) <= tolerance
    });
    if is_constant {
        let start = &states[first];
        channel.times.push(start.time);
        channel.values.push(start.values[k]);
        channel.rates.push(0.0);
        return channel;
    }
    add(&states[first]);
    let mut from = first;
    while from < last {
        // The longest span of one cubic: steps that double, then halve.
        let (mut to, mut stride) = (from + 1, 1);
        while to + stride <= last && spans(&states[from..=to + stride], k, tolerance) {
            to += stride;
            stride *= 2;
        }
        while stride > 0 {
            if to + stride <= last && spans(&states[from..=to + stride], k, tolerance) {
                to += stride;
            }
            stride /= 2;
        }
        add(&states[to]);
        from = to;
    }
    channel
}

/// Whether the cubic between the first and the last state is within the tolerance at the others.
fn spans(states: &[State], k: usize, tolerance: f64) -> bool {
    let (from, to) = (&states[0], &states[states.len() - 1]);
    let width = to.time - from.time;
    let (values, rates) = ([from.values[k], to.values[k]], [from.rates[k], to.rates[k]]);
    states.windows(2).skip(1).all(|pair| {
        let (state, near) = (&pair[0], pair[1].time - pair[0].time);
        let since = state.time - from.time;
        let found = cubic(values, rates, width, since);
        let by = 1e-3 * near;
        let rate = (cubic(values, rates, width, since + by)
            - cubic(values, rates, width, since - by))
            / (2.0 * by);
        (found - state.values[k]).abs() <= 0.5 * tolerance
            && (rate - state.rates[k]).abs() * near <= 2.0 * tolerance
    })
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::convert::Infallible;

    use super::*;

    fn value(channel: &Channel, time: f64) -> f64 {
        let Channel { times, values, rates } = channel;
        let next = times.partition_point(|&key| key <= time);
        if next == 0 || next == times.len() {
            return values[next.saturating_sub(1)];
        }
        let k = next - 1;
        let width = times[next] - times[k];
        cubic([values[k], values[next]], [rates[k], rates[next]], width, time - times[k])
    }

    /// A cubic, a sine and a constant, with the number of times at which values and rates were computed.
    #[derive(Default)]
    struct CubicAndSine {
        values: Cell<usize>,
        rates: Cell<usize>,
    }

    impl Functions for CubicAndSine {
        type Error = Infallible;

        fn values(&self, t: f64) -> Result<Vec<f64>, Infallible> {
            self.values.set(self.values.get() + 1);
            Ok(vec![1.0 + t * (2.0 - t * (0.5 - t)), (3.0 * t).sin(), 7.0])
        }

        fn rates(&self, t: f64) -> Result<Vec<f64>, Infallible> {
            self.rates.set(self.rates.get() + 1);
            Ok(vec![2.0 - t + 3.0 * t * t, 3.0 * (3.0 * t).cos(), 0.0])
        }
    }

    #[test]
    fn rates_are_computed_at_the_ends_of_intervals_only() {
        // One interval that fits: its two ends, and values at three times between them.
        let functions = CubicAndSine::default();
        let Ok(_) = channels(&[0.0, 1e-2], &[1e-9, 1e-6, 1e-9], &functions);
        assert_eq!((functions.rates.get(), functions.values.get()), (2, 5));
        // Halved n times: n middles with rates, and three more values for each of the n + 1 intervals.
        let functions = CubicAndSine::default();
        let Ok(_) = channels(&[0.0, 2.0], &[1e-9, 1e-6, 1e-9], &functions);
        let halved = functions.rates.get() - 2;
        assert!(halved > 6, "{halved}");
        assert_eq!(functions.values.get(), 2 + halved + 3 * (halved + 1));
    }

    #[test]
    fn cubics_are_exact_and_other_functions_are_within_their_tolerance() {
        let Ok(found) = channels(&[0.0, 0.3, 2.0], &[1e-9, 1e-6, 1e-9], &CubicAndSine::default());
        assert_eq!(found[0].times, [0.0, 2.0], "the break is none of the cubic");
        assert_eq!((found[2].times.len(), found[2].values[0]), (1, 7.0));
        let sine = found[1].times.len();
        assert!((8..80).contains(&sine), "{sine}");
        for k in 0..=2000 {
            let t = f64::from(k) * 1e-3;
            let Ok(expected) = CubicAndSine::default().values(t);
            for ((channel, expected), within) in found.iter().zip(expected).zip([1e-13, 3e-6, 0.0])
            {
                assert!((value(channel, t) - expected).abs() <= within, "{t}");
            }
        }
    }
}
