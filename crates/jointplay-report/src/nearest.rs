//! The smallest minimum distances.

use jointplay_cell::check::MinimumDistance;
use jointplay_cell::workcell::Cell;
use jointplay_format::units::mm;
use serde::Serialize;

/// Largest number of listed pairs.
const PAIRS: usize = 6;

/// A pair with a small minimum distance, with all wafers counted as one.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct NearestReport {
    /// Names of both; for pairs with wafers, those of the closest pair.
    pub bodies: [String; 2],
    /// Minimum distance; negative for a penetration depth.
    pub distance_mm: f64,
    /// Time of the minimum.
    pub time_s: f64,
    /// Number of pairs that differ only by their wafers and have a larger distance.
    pub others: usize,
}

/// The pairs of least distance, from a list sorted by distance; pairs that differ only by their wafers are listed once.
pub(crate) fn nearest(cell: &Cell, distances: &[MinimumDistance]) -> Vec<NearestReport> {
    let report = |(pair, others): (&MinimumDistance, usize)| NearestReport {
        bodies: pair.entities.map(|one| cell.entity_label(one)),
        distance_mm: mm(pair.distance),
        time_s: pair.time,
        others,
    };
    grouped(distances).into_iter().take(PAIRS).map(report).collect()
}

/// Groups of pairs that differ only by their wafers: the first pair of each group, and the number of the others.
fn grouped(distances: &[MinimumDistance]) -> Vec<(&MinimumDistance, usize)> {
    // All wafers count as one.
    let alike = |pair: &MinimumDistance| {
        let mut entities = pair.entities.map(|one| (!one.is_wafer()).then_some(one));
        entities.sort();
        entities
    };
    let mut found: Vec<(&MinimumDistance, usize)> = Vec::new();
    for pair in distances {
        match found.iter_mut().find(|(known, _)| alike(known) == alike(pair)) {
            Some((_, others)) => *others += 1,
            None => found.push((pair, 0)),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use jointplay_cell::EntityId;
    use jointplay_cell::station::SlotId;

    use super::*;

    #[test]
    fn pairs_that_differ_only_by_their_wafers_are_listed_once() {
        let wafer = |slot| EntityId::Wafer(SlotId { station: 0, slot });
        let (ledge, hand, wall) = (EntityId::Body(0), EntityId::Body(1), EntityId::Body(2));
        let pair = |one: EntityId, other: EntityId, distance: f64| MinimumDistance {
            entities: [one, other],
            distance,
            tolerance: 0.0,
            time: distance,
            step: 0,
        };
        let all = [
            pair(ledge, wafer(1), 1.0),
            pair(ledge, wafer(2), 1.5),
            pair(wafer(1), wafer(2), 2.0),
            pair(wafer(7), ledge, 3.0),
            pair(hand, wall, 4.0),
        ];
        let found: Vec<_> = grouped(&all)
            .into_iter()
            .map(|(pair, others)| (pair.entities, pair.distance, others))
            .collect();
        let expected =
            [([ledge, wafer(1)], 1.0, 2), ([wafer(1), wafer(2)], 2.0, 0), ([hand, wall], 4.0, 0)];
        assert_eq!(found, expected);
    }
}
