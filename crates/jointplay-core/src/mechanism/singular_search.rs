//! Singular configurations between the waypoints of a motion.

use super::driven_motion::{SingularConfiguration, Waypoint};
use super::motion::DriveProblem;
use super::singular::SINGULAR;
use crate::Error;

/// Halvings of a step in the search for a singular configuration.
const HALVINGS: usize = 3;
/// A singular configuration is searched for no closer than to this least singular value, as a share of the largest.
const FOUND: f64 = 1e-3 * SINGULAR;
/// Share of a step over which the slope of the least singular value is measured at an end of the path: a singular configuration within this share of the end is that end, as far as [`SINGULAR`] distinguishes them.
const SLOPE_SHARE: f64 = 1e-6;

impl DriveProblem<'_> {
    /// Looks into a dip of the least singular value between the last three waypoints.
    ///
    /// A dip in the first step, which has no waypoint before it, shows by the slope at the start.
    pub(super) fn note_singular(
        &self,
        trail: &[Waypoint],
        regular_rank: usize,
        found: &mut Vec<SingularConfiguration>,
    ) -> Result<(), Error> {
        match trail {
            [start, next]
                if next.least_singular_value > start.least_singular_value
                    && self.falls_toward(start, next, regular_rank)? =>
            {
                self.search_dip(start, next, start, regular_rank, found)?;
            }
            [.., before, middle, last] => {
                let values = [before, middle, last].map(|point| point.least_singular_value);
                if values[1] <= values[0] && values[1] < values[2] {
                    self.search_dip(before, last, middle, regular_rank, found)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Looks into a dip of the least singular value in the last step, which has no waypoint behind it: it shows by the slope at the end.
    pub(super) fn note_last_step(
        &self,
        trail: &[Waypoint],
        regular_rank: usize,
        found: &mut Vec<SingularConfiguration>,
    ) -> Result<(), Error> {
        let [.., before, end] = trail else { return Ok(()) };
        let is_lower = end.least_singular_value <= before.least_singular_value;
        // A singular end is no dip within the step.
        if is_lower
            && end.least_singular_value >= SINGULAR
            && self.falls_toward(end, before, regular_rank)?
        {
            self.search_dip(before, end, end, regular_rank, found)?;
        }
        Ok(())
    }

    /// Whether the least singular value falls from a waypoint toward the next one or the one before.
    fn falls_toward(
        &self,
        from: &Waypoint,
        toward: &Waypoint,
        regular_rank: usize,
    ) -> Result<bool, Error> {
        let share = from.share + SLOPE_SHARE * (toward.share - from.share);
        let near = self.step(from, from, share, regular_rank)?;
        Ok(near.is_some_and(|near| near.least_singular_value < from.least_singular_value))
    }

    /// Looks for a singular configuration at the least singular value between two waypoints.
    ///
    /// # Arguments
    /// * `least` – the waypoint with the least singular value so far
    fn search_dip(
        &self,
        from: &Waypoint,
        to: &Waypoint,
        least: &Waypoint,
        regular_rank: usize,
        found: &mut Vec<SingularConfiguration>,
    ) -> Result<(), Error> {
        let (mut low, mut high) = (from.share, to.share);
        let mut least = least.clone();
        // Moves along: from near, a step to the singular configuration is predicted well.
        let mut base = from.clone();
        for _ in 0..60 {
            if least.least_singular_value < FOUND || high - low < 1e-12 {
                break;
            }
            let shares = [low + (high - low) / 3.0, high - (high - low) / 3.0];
            let [Some(a), Some(b)] = [
                self.reached(&base, shares[0], regular_rank, HALVINGS)?,
                self.reached(&base, shares[1], regular_rank, HALVINGS)?,
            ] else {
                break;
            };
            if a.least_singular_value < b.least_singular_value {
                high = shares[1];
            } else {
                low = shares[0];
                base = a.clone();
            }
            for candidate in [a, b] {
                if candidate.least_singular_value < least.least_singular_value {
                    least = candidate;
                }
            }
        }
        if least.least_singular_value < SINGULAR {
            found.push(self.singular(&least, regular_rank)?);
        }
        Ok(())
    }
}
