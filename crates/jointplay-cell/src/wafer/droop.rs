//! Deflection of an arm at its end by reach and load.

use super::model::{Droop, DroopRow};
use super::monotone_cubic::{CubicPiece, Measured};

/// Relative tolerance at the ends of a table: a reach computed to lie on its end is not beyond it by round-off.
const RANGE_TOLERANCE: f64 = 1e-9;
/// Reach below which the droop of an arm is negligible (m).
pub(crate) const MIN_REACH: f64 = 0.05;

/// Deflection of the end of an arm.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Deflection {
    /// Displacement downward (m).
    pub drop: f64,
    /// Rotation, the outer end downward (rad).
    pub slope: f64,
}

/// Reason why the droop of an arm is not known.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DroopError {
    /// The reach is outside the measured table.
    #[error(
        "the droop at a reach of {reach} m is not known: the table ranges from {min} to {max} m; measure there, or give a cantilever"
    )]
    Reach {
        /// Reach asked for (m).
        reach: f64,
        /// Least reach of the table (m).
        min: f64,
        /// Largest reach of the table (m).
        max: f64,
    },
    /// The load is above the measured load, or negative.
    #[error(
        "the droop under {load} kg is not known: the table ranges from 0 to {max} kg; measure with more, or give a cantilever"
    )]
    Load {
        /// Load asked for (kg).
        load: f64,
        /// Largest load of the table (kg).
        max: f64,
    },
}

impl Droop {
    /// Deflection of the arm at its end.
    ///
    /// ```text
    ///    cantilever:   drop  =  q L⁴ / (8 EI)  +  P L³ / (3 EI)        q: own weight per length, P: load at the tip
    ///                  slope =  q L³ / (6 EI)  +  P L² / (2 EI)
    /// ```
    /// A table is interpolated between reaches by a shape-preserving cubic, and between empty and loaded in proportion to the load.
    ///
    /// # Arguments
    /// * `reach` – from the first joint to the centre of the wafer (m)
    /// * `load` – mass of the load (kg)
    /// * `gravity` – acceleration of gravity; tables apply to the gravity under which they were measured (m/s²)
    ///
    /// # Errors
    /// [`DroopError`] outside the table.
    ///
    /// # Source
    /// \[Roark\], beams
    pub fn deflection(
        &self,
        reach: f64,
        load: f64,
        gravity: f64,
    ) -> Result<Deflection, DroopError> {
        self.derivatives_by_reach(reach, load, gravity).map(|[at, ..]| at)
    }

    /// Deflection with its first and second derivative with respect to the reach.
    pub(super) fn derivatives_by_reach(
        &self,
        reach: f64,
        load: f64,
        gravity: f64,
    ) -> Result<[Deflection; 3], DroopError> {
        match self {
            Self::Rigid => Ok([Deflection::default(); 3]),
            Self::Cantilever { stiffness, mass_per_length } => {
                let (own, tip, l) = (mass_per_length * gravity, load * gravity, reach);
                let by = |drop: f64, slope: f64| Deflection {
                    drop: drop / stiffness,
                    slope: slope / stiffness,
                };
                Ok([
                    by(
                        l.powi(3) * (own * l / 8.0 + tip / 3.0),
                        l.powi(2) * (own * l / 6.0 + tip / 2.0),
                    ),
                    by(l.powi(2) * (own * l / 2.0 + tip), l * (own * l / 2.0 + tip)),
                    by(l * (own * l * 1.5 + 2.0 * tip), own * l + tip),
                ])
            }
            Self::Table { rows } => interpolated(rows, reach, load),
        }
    }

    /// Upper bounds on the deflection and its derivatives up to a reach, empty or with a load.
    ///
    /// Rows of a table whose load is smaller are excluded: there the wafer is not known, and no motion with it is checked.
    pub(crate) fn at_most(&self, reach: f64, load: f64, gravity: f64) -> DroopBounds {
        let Self::Table { rows } = self else {
            // All derivatives grow with reach and load.
            let [value, by_reach, second_by_reach] =
                self.derivatives_by_reach(reach, load, gravity).unwrap_or_default();
            return DroopBounds {
                value,
                by_reach,
                second_by_reach,
                slope_per_reach: by_reach.slope,
            };
        };
        let mut most = DroopBounds::default();
        for load in [0.0, load] {
            let known = rows.iter().filter_map(|row| Some((row.reach, row.under(load).ok()?)));
            let known: Vec<(f64, Deflection)> = known.collect();
            for &(reach, at) in &known {
                most.value = most.value.or(at);
                most.slope_per_reach =
                    most.slope_per_reach.max(at.slope.abs() / reach.abs().max(MIN_REACH));
            }
            for above in 1..rows.len() {
                let Ok([drop, slope]) = pieces(rows, above, load) else { continue };
                let [rates, bends] = {
                    let [drop, slope] = [drop, slope].map(|piece| piece.largest_derivatives());
                    [0, 1].map(|order| Deflection { drop: drop[order], slope: slope[order] })
                };
                (most.by_reach, most.second_by_reach) =
                    (most.by_reach.or(rates), most.second_by_reach.or(bends));
                // Between two rows a value is at most the larger of both.
                let ends = [above - 1, above].map(|row| rows[row].reach);
                let largest = ends.map(|reach| slope.value_and_derivatives(reach)[0].abs());
                let steepest = largest[0].max(largest[1]) / ends[0].abs().max(MIN_REACH);
                most.slope_per_reach = most.slope_per_reach.max(steepest);
            }
        }
        most
    }
}

/// Upper bounds on the magnitudes of a deflection and its derivatives with respect to the reach.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct DroopBounds {
    pub(crate) value: Deflection,
    /// First derivative with respect to the reach.
    pub(crate) by_reach: Deflection,
    /// Second derivative with respect to the reach.
    pub(crate) second_by_reach: Deflection,
    /// Slope divided by its reach (rad/m).
    pub(crate) slope_per_reach: f64,
}

impl Deflection {
    /// The larger magnitudes of two deflections.
    fn or(self, other: Self) -> Self {
        let Self { drop, slope } = self;
        Self { drop: drop.max(other.drop.abs()), slope: slope.max(other.slope.abs()) }
    }
}

impl DroopRow {
    /// Deflection of a row under a load.
    fn under(&self, load: f64) -> Result<Deflection, DroopError> {
        if !(load >= 0.0 && load <= self.load * (1.0 + RANGE_TOLERANCE)) {
            return Err(DroopError::Load { load, max: self.load });
        }
        let fraction = if load == 0.0 { 0.0 } else { load / self.load };
        Ok(Deflection {
            drop: self.empty_drop + fraction * (self.loaded_drop - self.empty_drop),
            slope: self.empty_slope + fraction * (self.loaded_slope - self.empty_slope),
        })
    }
}

fn interpolated(rows: &[DroopRow], reach: f64, load: f64) -> Result<[Deflection; 3], DroopError> {
    let (min, max) = match rows {
        [first, .., last] => (first.reach, last.reach),
        [only] => (only.reach, only.reach),
        [] => (f64::NAN, f64::NAN),
    };
    let tolerance = RANGE_TOLERANCE * max.abs();
    // Written so that NaN counts as outside.
    if !(reach >= min - tolerance && reach <= max + tolerance) {
        return Err(DroopError::Reach { reach, min, max });
    }
    if rows.len() == 1 {
        return Ok([rows[0].under(load)?, Deflection::default(), Deflection::default()]);
    }
    let above = rows.partition_point(|row| row.reach < reach).clamp(1, rows.len() - 1);
    let [drop, slope] = pieces(rows, above, load)?.map(|piece| piece.value_and_derivatives(reach));
    Ok([0, 1, 2].map(|order| Deflection { drop: drop[order], slope: slope[order] }))
}

/// Drop and slope between a row and the one before it; rows beyond these two count where they cover the load.
fn pieces(rows: &[DroopRow], above: usize, load: f64) -> Result<[CubicPiece; 2], DroopError> {
    let at = |row: &DroopRow| Ok((row.reach, row.under(load)?));
    let ends = [at(&rows[above - 1])?, at(&rows[above])?];
    let outer = [above.checked_sub(2), Some(above + 1)]
        .map(|row| row.and_then(|row| at(rows.get(row)?).ok()));
    let piece = |of: fn(&Deflection) -> f64| {
        let measured = |(position, at): (f64, Deflection)| Measured { position, value: of(&at) };
        let [before, after] = outer.map(|row| row.map(measured));
        CubicPiece::new(before, ends.map(measured), after)
    };
    Ok([piece(|at| at.drop), piece(|at| at.slope)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(reach: f64, drop: f64) -> DroopRow {
        DroopRow {
            reach,
            empty_drop: drop,
            empty_slope: drop / 2.0,
            loaded_drop: drop * 3.0,
            loaded_slope: drop,
            load: 0.2,
        }
    }

    #[test]
    fn cantilever_satisfies_its_differential_equation() {
        // E I w'''' = q, with w = w' = 0 at the joint, no moment and the load at the tip, integrated from the tip.
        let (stiffness, mass_per_length, load, gravity, l) = (900.0, 2.5, 0.13, 9.81, 0.7);
        let droop = Droop::Cantilever { stiffness, mass_per_length };
        let found = droop.deflection(l, load, gravity).unwrap();
        let steps = 20_000;
        let (mut slope, mut drop) = (0.0, 0.0);
        for k in 0..steps {
            let dx = l / f64::from(steps);
            let rest = l - (f64::from(k) + 0.5) * dx;
            let moment = gravity * (load * rest + mass_per_length * rest * rest / 2.0);
            let bend = moment / stiffness * dx;
            drop += (slope + bend / 2.0) * dx;
            slope += bend;
        }
        assert!((found.drop - drop).abs() < 1e-7 * drop, "{found:?} {drop}");
        assert!((found.slope - slope).abs() < 1e-7 * slope, "{found:?} {slope}");
    }

    #[test]
    fn droop_bounds_are_upper_bounds() {
        let up_and_down = vec![row(0.1, 0.0), row(0.3, 4e-3), row(0.4, -2e-3), row(0.7, 1e-3)];
        let mut weak = up_and_down.clone();
        weak[2].load = 0.05;
        for droop in [
            Droop::Rigid,
            Droop::Cantilever { stiffness: 300.0, mass_per_length: 2.5 },
            Droop::Table { rows: up_and_down },
            Droop::Table { rows: weak },
            Droop::Table { rows: vec![row(0.0, 1e-3), row(0.01, 2e-3), row(0.7, 3e-3)] },
        ] {
            let most = droop.at_most(0.7, 0.13, 9.81);
            let (mut seen, mut looks) = (DroopBounds::default(), 0);
            for k in 0..=70_000 {
                for load in [0.0, 0.13] {
                    let reach = 1e-5 * f64::from(k);
                    let Ok([at, rate, bend]) = droop.derivatives_by_reach(reach, load, 9.81) else {
                        continue;
                    };
                    looks += 1;
                    seen.value = seen.value.or(at);
                    seen.by_reach = seen.by_reach.or(rate);
                    seen.second_by_reach = seen.second_by_reach.or(bend);
                    seen.slope_per_reach =
                        seen.slope_per_reach.max(at.slope.abs() / reach.max(MIN_REACH));
                }
            }
            assert!(looks > 80_000, "{looks}");
            let pairs = [
                (most.value, seen.value),
                (most.by_reach, seen.by_reach),
                (most.second_by_reach, seen.second_by_reach),
            ];
            for (most, seen) in pairs {
                for (most, seen) in [(most.drop, seen.drop), (most.slope, seen.slope)] {
                    assert!(seen <= most * (1.0 + 1e-12), "{droop:?}: {seen} above {most}");
                    assert!(most <= 1.01 * seen, "{droop:?}: {most} far above {seen}");
                }
            }
            assert!(seen.slope_per_reach <= most.slope_per_reach * (1.0 + 1e-12), "{droop:?}");
        }
    }

    #[test]
    fn droop_table_is_interpolated_and_not_extrapolated() {
        let droop = Droop::Table { rows: vec![row(0.2, 1e-4), row(0.4, 3e-4), row(0.5, 7e-4)] };
        let drop = |reach, load| droop.deflection(reach, load, 9.81).unwrap().drop;
        assert!((drop(0.2, 0.0) - 1e-4).abs() < 1e-18);
        // Between rows the drop bends as its neighbours do, and stays between them.
        assert!(drop(0.3, 0.0) > 1e-4 && drop(0.3, 0.0) < 2e-4);
        assert!(drop(0.45, 0.0) > 3e-4 && drop(0.45, 0.0) < 5e-4);
        assert!((drop(0.5, 0.2) - 21e-4).abs() < 1e-18);
        assert!((drop(0.3, 0.1) - 2.0 * drop(0.3, 0.0)).abs() < 1e-18);
        let error = droop.deflection(0.51, 0.0, 9.81).unwrap_err();
        assert_eq!(error, DroopError::Reach { reach: 0.51, min: 0.2, max: 0.5 });
        assert!(droop.deflection(f64::NAN, 0.0, 9.81).is_err());
        let error = droop.deflection(0.3, 0.3, 9.81).unwrap_err();
        assert_eq!(error, DroopError::Load { load: 0.3, max: 0.2 });
        let single = Droop::Table { rows: vec![row(0.2, 1e-4)] };
        assert_eq!(single.deflection(0.2, 0.0, 9.81).unwrap().drop, 1e-4);
        assert!(Droop::Table { rows: vec![] }.deflection(0.2, 0.0, 9.81).is_err());
    }
}
