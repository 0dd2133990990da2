//! Functions of time as cubics between keys.

/// Values and rates of all channels at one time.
pub(super) struct State {
    pub(super) time: f64,
    pub(super) values: Vec<f64>,
    pub(super) rates: Vec<f64>,
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
/// Shares of an interval at which its cubic is compared with the function.
const PROBES: [f64; 3] = [0.25, 0.5, 0.75];

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
///
/// # Arguments
/// * `breaks` – growing times at which a derivative of a channel may jump; first and last are the ends (s)
/// * `tolerances` – for each channel, in its unit
///
/// # Errors
/// Those of `at`.
pub(super) fn channels<E>(
    breaks: &[f64],
    tolerances: &[f64],
    at: &dyn Fn(f64) -> Result<State, E>,
) -> Result<Vec<Channel>, E> {
    let mut states: Vec<State> = Vec::with_capacity(2 * breaks.len());
    for &time in breaks {
        let next = at(time)?;
        if let Some(last) = states.pop() {
            between(last, &next, tolerances, at, &mut states)?;
        }
        states.push(next);
    }
    Ok(tolerances.iter().enumerate().map(|(k, &tolerance)| pruned(&states, k, tolerance)).collect())
}

/// Adds the first state, and those that are needed between it and the second.
fn between<E>(
    first: State,
    second: &State,
    tolerances: &[f64],
    at: &dyn Fn(f64) -> Result<State, E>,
    states: &mut Vec<State>,
) -> Result<(), E> {
    let width = second.time - first.time;
    if width > 2.0 * SHORTEST {
        let probes = PROBES.map(|share| at(first.time + share * width));
        let [early, middle, late] = probes;
        let probes = [early?, middle?, late?];
        let fits = |probe: &State| {
            tolerances.iter().enumerate().all(|(k, tolerance)| {
                let (values, rates) =
                    ([first.values[k], second.values[k]], [first.rates[k], second.rates[k]]);
                let found = cubic(values, rates, width, probe.time - first.time);
                (found - probe.values[k]).abs() <= *tolerance
            })
        };
        if !probes.iter().all(fits) {
            let [_, middle, _] = probes;
            let at_middle = State {
                time: middle.time,
                values: middle.values.clone(),
                rates: middle.rates.clone(),
            };
            between(first, &middle, tolerances, at, states)?;
            return between(at_middle, second, tolerances, at, states);
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

    #[test]
    fn cubics_are_exact_and_other_functions_are_within_their_tolerance() {
        let functions = |t: f64| {
            let values = vec![1.0 + t * (2.0 - t * (0.5 - t)), (3.0 * t).sin(), 7.0];
            let rates = vec![2.0 - t + 3.0 * t * t, 3.0 * (3.0 * t).cos(), 0.0];
            Ok::<_, ()>(State { time: t, values, rates })
        };
        let found = channels(&[0.0, 0.3, 2.0], &[1e-9, 1e-6, 1e-9], &functions).unwrap();
        assert_eq!(found[0].times, [0.0, 2.0], "the break is none of the cubic");
        assert_eq!((found[2].times.len(), found[2].values[0]), (1, 7.0));
        let sine = found[1].times.len();
        assert!((8..80).contains(&sine), "{sine}");
        for k in 0..=2000 {
            let t = f64::from(k) * 1e-3;
            let expected = functions(t).unwrap().values;
            for ((channel, expected), within) in found.iter().zip(expected).zip([1e-13, 3e-6, 0.0])
            {
                assert!((value(channel, t) - expected).abs() <= within, "{t}");
            }
        }
    }
}
