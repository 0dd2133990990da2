//! Which bodies come nearest, in a few lines.

use serde::Serialize;

use crate::distance::DistanceReport;

/// So many pairs are told.
const PAIRS: usize = 6;
/// How names of wafers begin.
const WAFER: &str = "wafer of ";

/// Two bodies that come near, all wafers taken for one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct NearestReport {
    /// Names of both; of pairs with wafers, those that come nearest.
    pub bodies: [String; 2],
    /// Least distance; below zero a depth.
    pub distance_mm: f64,
    /// When.
    pub time_s: f64,
    /// Pairs of the same bodies with other wafers, which come no nearer.
    pub others: usize,
}

/// The pairs that come nearest, of a list that begins with them.
pub(crate) fn nearest(distances: &[DistanceReport]) -> Vec<NearestReport> {
    let alike = |bodies: &[String; 2]| {
        let kind =
            |name: &String| if name.starts_with(WAFER) { WAFER.to_owned() } else { name.clone() };
        let mut kinds = bodies.each_ref().map(kind);
        kinds.sort();
        kinds
    };
    let mut found: Vec<([String; 2], NearestReport)> = Vec::new();
    for DistanceReport { bodies, distance_mm, time_s, .. } in distances {
        let kinds = alike(bodies);
        if let Some((_, known)) = found.iter_mut().find(|(known, _)| *known == kinds) {
            known.others += 1;
        } else {
            let (bodies, distance_mm, time_s) = (bodies.clone(), *distance_mm, *time_s);
            found.push((kinds, NearestReport { bodies, distance_mm, time_s, others: 0 }));
        }
    }
    found.into_iter().map(|(_, pair)| pair).take(PAIRS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_that_differ_by_their_wafers_are_told_once() {
        let pair = |one: &str, other: &str, distance_mm: f64| DistanceReport {
            bodies: [one.to_owned(), other.to_owned()],
            distance_mm,
            within_mm: 0.0,
            time_s: distance_mm,
        };
        let all = [
            pair("ledge", "wafer of LP1 1", 1.0),
            pair("ledge", "wafer of LP1 2", 1.5),
            pair("wafer of LP1 1", "wafer of LP1 2", 2.0),
            pair("wafer of LP1 7", "ledge", 3.0),
            pair("hand", "wall", 4.0),
        ];
        let told: Vec<(String, f64, usize)> = nearest(&all)
            .into_iter()
            .map(|one| (one.bodies.join(", "), one.distance_mm, one.others))
            .collect();
        let wanted = [
            ("ledge, wafer of LP1 1", 1.0, 2),
            ("wafer of LP1 1, wafer of LP1 2", 2.0, 0),
            ("hand, wall", 4.0, 0),
        ];
        assert_eq!(
            told,
            wanted.map(|(names, distance, others)| (names.to_owned(), distance, others))
        );
    }
}
