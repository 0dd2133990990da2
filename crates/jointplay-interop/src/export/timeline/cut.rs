//! Division of a motion into windows.

/// Boundaries of windows: indices of steps, the first 0 and the last their number.
///
/// Windows begin where instructions begin.
/// Where the first or the last steps are those of another motion, its boundaries remain, so that unchanged steps remain in unchanged windows.
///
/// # Arguments
/// * `marks` – hash of the content of each step
/// * `starts` – whether an instruction starts with a step
/// * `most` – approximate number of steps of a window
/// * `previous` – marks and boundaries of the other motion
pub(super) fn edges(
    marks: &[u64],
    starts: &dyn Fn(usize) -> bool,
    most: usize,
    previous: Option<(&[u64], Vec<usize>)>,
) -> Vec<usize> {
    let count = marks.len();
    let mut kept = vec![0];
    if let Some((old, edges)) = previous {
        let alike = |(one, other): &(&u64, &u64)| one == other;
        let first = marks.iter().zip(old).take_while(alike).count();
        let rest = first.min(count).min(old.len());
        let last = marks[rest..].iter().rev().zip(old[rest..].iter().rev());
        let last = last.take_while(alike).count();
        for edge in edges {
            if edge <= first && edge <= count {
                kept.push(edge);
            } else if edge + last >= old.len() {
                kept.push(edge + count - old.len());
            }
        }
    }
    kept.push(count);
    kept.sort_unstable();
    kept.dedup();
    kept.retain(|&edge| edge == count || starts(edge));
    let found = filled(&kept, count, starts, most);
    // Many changes leave many short windows.
    if found.len() > 8 + 2 * (count / most + 1) {
        return filled(&[0, count], count, starts, most);
    }
    found
}

/// Adds boundaries where there are too many steps between two.
fn filled(kept: &[usize], count: usize, starts: &dyn Fn(usize) -> bool, most: usize) -> Vec<usize> {
    let mut edges = vec![0];
    for &end in kept {
        let mut from = edges[edges.len() - 1];
        while end.saturating_sub(from) > most + most / 2 {
            let Some(next) = (from + most..end).find(|&step| starts(step)) else { break };
            edges.push(next);
            from = next;
        }
        if end > from {
            edges.push(end);
        }
    }
    if count == 0 { Vec::new() } else { edges }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Instructions of three steps each, whose marks are their numbers.
    fn steps(instructions: &[u64]) -> Vec<u64> {
        instructions.iter().flat_map(|&one| [3 * one, 3 * one + 1, 3 * one + 2]).collect()
    }

    #[test]
    fn all_steps_are_in_windows_that_begin_with_instructions() {
        let marks = steps(&(0..100).collect::<Vec<_>>());
        let starts = |step: usize| step.is_multiple_of(3);
        let found = edges(&marks, &starts, 20, None);
        assert_eq!((found[0], found[found.len() - 1]), (0, 300));
        for pair in found.windows(2) {
            assert!(pair[0] < pair[1] && pair[1] - pair[0] <= 32, "{found:?}");
        }
        assert!(found.iter().all(|&edge| starts(edge)));
        assert_eq!(edges(&[], &starts, 20, None), Vec::<usize>::new());
    }

    #[test]
    fn a_line_more_or_less_changes_one_window() {
        // Repeated instructions: the content of a step does not identify its place.
        let many: Vec<u64> = (0..1000).map(|k| k % 2).collect();
        let starts = |step: usize| step.is_multiple_of(3);
        let old = edges(&steps(&many), &starts, 20, None);
        for at in [0, 1, 499, 998, 1000] {
            let mut more = many.clone();
            more.insert(at, 7);
            let new = edges(&steps(&more), &starts, 20, Some((&steps(&many), old.clone())));
            let lengths = |edges: &[usize]| -> Vec<usize> {
                edges.windows(2).map(|pair| pair[1] - pair[0]).collect()
            };
            let (before, after) = (lengths(&old), lengths(&new));
            let first = before.iter().zip(&after).take_while(|(a, b)| a == b).count();
            let last = before.iter().rev().zip(after.iter().rev()).take_while(|(a, b)| a == b);
            assert!(first + last.count() + 2 >= before.len(), "{at}: {before:?} {after:?}");
            assert_eq!(new[new.len() - 1], 3003);
        }
    }
}
