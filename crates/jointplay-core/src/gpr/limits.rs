//! Limits of rods and tilt.

use crate::spatial::Tilt;

/// Limits of rods and tilt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Shortest rod (m).
    pub rod_min: f64,
    /// Longest rod (m).
    pub rod_max: f64,
    /// Largest tilt toward any azimuth (rad).
    pub tilt_max: f64,
}

/// One limit that a pose breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BrokenLimit {
    /// A rod is too short or too long.
    Rod {
        /// Which rod, counted from 1.
        limb: usize,
        /// Its length (m).
        length: f64,
        /// Shortest allowed (m).
        min: f64,
        /// Longest allowed (m).
        max: f64,
    },
    /// The tilt is too large.
    Tilt {
        /// Tilt found (rad).
        angle: f64,
        /// Largest tilt allowed (rad).
        max: f64,
    },
}

/// The limits that a pose breaks; holds them without heap memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrokenLimits {
    limits: Limits,
    rods: [f64; 3],
    tilt_angle: f64,
    /// Of each rod, then of the tilt.
    broken: [bool; 4],
}

impl BrokenLimits {
    /// Broken limits of a pose, with its values.
    pub(super) fn new(limits: Limits, rods: [f64; 3], tilt: Tilt, broken: [bool; 4]) -> Self {
        Self { limits, rods, tilt_angle: tilt.angle.abs(), broken }
    }

    /// Whether the pose is within all limits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.broken == [false; 4]
    }

    /// Which rods are too short or too long.
    #[must_use]
    pub fn rods(&self) -> [bool; 3] {
        let [q_1, q_2, q_3, _] = self.broken;
        [q_1, q_2, q_3]
    }

    /// Whether the platform tilts too far.
    #[must_use]
    pub fn tilt(&self) -> bool {
        self.broken[3]
    }

    /// The broken limits, rods first.
    pub fn iter(&self) -> impl Iterator<Item = BrokenLimit> + '_ {
        let Limits { rod_min: min, rod_max: max, tilt_max } = self.limits;
        let rods = (0..3).filter(|&k| self.broken[k]).map(move |k| BrokenLimit::Rod {
            limb: k + 1,
            length: self.rods[k],
            min,
            max,
        });
        let tilt = BrokenLimit::Tilt { angle: self.tilt_angle, max: tilt_max };
        rods.chain(self.tilt().then_some(tilt))
    }
}

/// Such as `rod 1 is 0.2 m, from 0.246 to 0.754 m is allowed, and the tilt is 1.5 rad, up to 0.026 rad is allowed`.
impl core::fmt::Display for BrokenLimits {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for (place, limit) in self.iter().enumerate() {
            formatter.write_str(if place == 0 { "" } else { ", and " })?;
            match limit {
                BrokenLimit::Rod { limb, length, min, max } => {
                    write!(
                        formatter,
                        "rod {limb} is {length} m, from {min} to {max} m is allowed"
                    )?;
                }
                BrokenLimit::Tilt { angle: tilt_angle, max } => {
                    write!(formatter, "the tilt is {tilt_angle} rad, up to {max} rad is allowed")?;
                }
            }
        }
        Ok(())
    }
}

impl Limits {
    /// Relative slack, and for the tilt absolute slack (rad), so that a pose computed to lie on a limit is not beyond it by round-off.
    const SLACK: f64 = 1e-12;

    /// Every limit that rods of these lengths (m) and this tilt break.
    #[must_use]
    pub fn broken(&self, rods: &[f64; 3], tilt: Tilt) -> BrokenLimits {
        let (min, max) = (self.rod_min, self.rod_max);
        let slack = Self::SLACK * max.abs().max(min.abs());
        let [q_1, q_2, q_3] = rods.map(|length| !(length >= min - slack && length <= max + slack));
        let tilt_angle = tilt.angle.abs();
        let tilted =
            tilt_angle.is_nan() || tilt_angle > self.tilt_max * (1.0 + Self::SLACK) + Self::SLACK;
        BrokenLimits { limits: *self, rods: *rods, tilt_angle, broken: [q_1, q_2, q_3, tilted] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { rod_min: 0.246, rod_max: 0.754, tilt_max: 0.03 };

    #[track_caller]
    fn check(rods: [f64; 3], tilt_angle: f64, limbs: &[usize], tilt: bool) {
        let broken = LIMITS.broken(&rods, Tilt { azimuth: 1.0, angle: tilt_angle });
        let mut found = Vec::new();
        let mut tilted = false;
        for limit in broken.iter() {
            match limit {
                BrokenLimit::Rod { limb, length, min, max } => {
                    assert!(!tilted, "rods come first");
                    assert_eq!((min, max), (0.246, 0.754));
                    assert_eq!(length.to_bits(), rods[limb - 1].to_bits());
                    found.push(limb);
                }
                BrokenLimit::Tilt { angle: found, max } => {
                    assert_eq!((found.to_bits(), max), (tilt_angle.abs().to_bits(), 0.03));
                    tilted = true;
                }
            }
        }
        assert_eq!((found.as_slice(), tilted), (limbs, tilt));
        assert_eq!(broken.is_empty(), limbs.is_empty() && !tilt);
        assert_eq!((broken.rods(), broken.tilt()), ([1, 2, 3].map(|k| limbs.contains(&k)), tilt));
    }

    #[test]
    fn within_at_and_beyond() {
        check([0.3, 0.5, 0.7], 0.02, &[], false);
        check([0.2, 0.5, 0.8], 0.02, &[1, 3], false);
        check([0.3, 0.2, 0.7], -0.04, &[2], true);
        check([0.3, 0.5, 0.7], 0.0301, &[], true);
        // On the limit, and beyond it by round-off only.
        check([0.246, 0.754, 0.5], -0.03, &[], false);
        check([0.246_f64.next_down(), 0.754_f64.next_up(), 0.5], 0.03_f64.next_up(), &[], false);
        check([0.246 - 1e-11, 0.754 + 1e-11, 0.5], 0.03 + 1e-11, &[1, 2], true);
        // NaN and infinity exceed every limit.
        check([f64::NAN, f64::INFINITY, f64::NEG_INFINITY], f64::NAN, &[1, 2, 3], true);
    }
}
