//! Rules for the stays of wafers at stations, and for the order of their visits.

use std::collections::BTreeSet;

use crate::CellError;
use crate::conditions::{in_range, index};

/// Longest time in a rule (s).
const MAX_TIME: f64 = 1e12;

/// Rules that the schedule of a program has to fulfil.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WaferRules {
    /// Limits of the stay of a wafer, one for a station at most.
    pub dwell: Vec<DwellLimits>,
    /// Visits that wafers have to make.
    pub visits: Vec<VisitRule>,
}

/// Limits of the stay of a wafer at a station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DwellLimits {
    /// Index of the station.
    pub station: usize,
    /// Shortest dwell of a wafer that the program places (s).
    pub min: f64,
    /// Longest dwell; no wafer may be left there at the end of the program. `None` for any stay (s).
    pub max: Option<f64>,
}

/// Visit of a station that wafers have to make.
#[derive(Debug, Clone, PartialEq)]
pub struct VisitRule {
    /// Name.
    pub name: String,
    /// Indices of the stations, one of which a wafer has to visit.
    pub stations: Vec<usize>,
    /// Indices of the stations before whose first visit the wafer has to visit one of [`stations`](Self::stations); wafers that visit none of them are exempt; empty for any time in the program.
    pub before: Vec<usize>,
    /// Indices of the stations in which the wafers are at the start; empty for all wafers that the program moves.
    pub origins: Vec<usize>,
    /// Number of visits; `None` for one or more.
    pub count: Option<usize>,
}

impl WaferRules {
    /// Limits of the stay at a station.
    #[must_use]
    pub fn dwell_at(&self, station: usize) -> Option<&DwellLimits> {
        self.dwell.iter().find(|limits| limits.station == station)
    }

    /// Checks that the rules refer to stations that exist, and do not contradict each other.
    ///
    /// # Errors
    /// [`CellError`] of the first condition that is violated.
    pub fn validate(&self, stations: usize) -> Result<(), CellError> {
        let mut limited = BTreeSet::new();
        for &DwellLimits { station, min, max } in &self.dwell {
            index("a dwell limit", "station", station, stations)?;
            in_range("the shortest dwell".to_owned(), min, 0.0, MAX_TIME, "s")?;
            if let Some(max) = max {
                in_range("the longest dwell".to_owned(), max, 0.0, MAX_TIME, "s")?;
                if min > max {
                    let what = "a stay at a station".to_owned();
                    return Err(CellError::LimitsReversed { what, min, max, unit: "s" });
                }
            }
            if !limited.insert(station) {
                let what = "two limits of the stay at one station".to_owned();
                return Err(CellError::Contradiction { what });
            }
        }
        for rule in &self.visits {
            let all = rule.stations.iter().chain(&rule.before).chain(&rule.origins);
            for &station in all {
                index(&format!("rule {}", rule.name), "station", station, stations)?;
            }
            if rule.stations.is_empty() {
                return Err(CellError::NoName { what: format!("a station of rule {}", rule.name) });
            }
            if rule.count == Some(0) {
                let what = format!("rule {:?}, which requires 0 visits", rule.name);
                return Err(CellError::Contradiction { what });
            }
        }
        self.check_order(stations)
    }

    /// Checks that no rule requires a visit before itself, over any number of rules.
    fn check_order(&self, stations: usize) -> Result<(), CellError> {
        // Only rules with a single station force an order on their own; alternatives may be chosen.
        let mut reached: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); stations];
        for rule in &self.visits {
            if let [station] = rule.stations.as_slice() {
                reached[*station].extend(&rule.before);
            }
        }
        for middle in 0..stations {
            let beyond = reached[middle].clone();
            for after in &mut reached {
                if after.contains(&middle) {
                    after.extend(&beyond);
                }
            }
        }
        let circular = |rule: &&VisitRule| {
            rule.stations
                .iter()
                .all(|station| rule.before.contains(station) || reached[*station].contains(station))
                && !rule.before.is_empty()
        };
        match self.visits.iter().find(circular) {
            None => Ok(()),
            Some(rule) => {
                let what = format!(
                    "rule {:?}, which with the other rules requires a visit before itself",
                    rule.name
                );
                Err(CellError::Contradiction { what })
            }
        }
    }
}
