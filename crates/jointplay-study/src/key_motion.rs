//! A motion through key poses: from rest to rest, straight in tilt and height.

use jointplay_core::gpr::AxisHeight;
use jointplay_core::sampling;
use jointplay_core::spatial::Tilt;

use crate::Error;

/// A pose that a motion passes, at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KeyPose {
    /// Tilt of the platform.
    pub tilt: Tilt,
    /// Height at which its plane crosses the base axis.
    pub height: AxisHeight,
    /// Duration of the motion to this pose; ignored for the first (s).
    pub duration: f64,
}

/// A motion through key poses, sampled evenly in time.
#[derive(Debug, Clone, PartialEq)]
pub struct KeyMotion {
    keys: Vec<KeyPose>,
    /// When each key pose is reached (s).
    reached: Vec<f64>,
    intervals: usize,
}

impl KeyMotion {
    /// A motion from the first key pose to the last.
    ///
    /// # Arguments
    /// * `rate` – samples a second, at least; as many more as end at the last pose exactly
    ///
    /// # Errors
    /// [`Error::FewKeyPoses`] below two; [`Error::NotPositive`] for a duration or the rate.
    pub fn new(keys: Vec<KeyPose>, rate: f64) -> Result<Self, Error> {
        if keys.len() < 2 {
            return Err(Error::FewKeyPoses { found: keys.len() });
        }
        let positive = |what, value: f64| {
            let fits = value.is_finite() && value > 0.0;
            if fits { Ok(value) } else { Err(Error::NotPositive { what, value }) }
        };
        let rate = positive("the rate", rate)?;
        let mut reached = vec![0.0];
        for key in &keys[1..] {
            let so_far = reached[reached.len() - 1];
            reached.push(so_far + positive("the duration of a key pose", key.duration)?);
        }
        // Saturates for durations that no computer can sample.
        let intervals = sampling::intervals(reached[reached.len() - 1], rate).max(1);
        let intervals = usize::try_from(intervals).unwrap_or(usize::MAX);
        Ok(Self { keys, reached, intervals })
    }

    /// Number of samples, both ends included.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.intervals.saturating_add(1)
    }

    /// When a sample is (s).
    #[must_use]
    pub fn time(&self, sample: usize) -> f64 {
        let end = self.reached[self.reached.len() - 1];
        if sample >= self.intervals { end } else { end * (sample as f64 / self.intervals as f64) }
    }

    /// The pose commanded at a time (s); before the start the first, after the end the last.
    ///
    /// ```text
    ///    s(u)  =  u³ (10 − 15 u + 6 u²)        (θ_x, θ_y, z)  =  (1 − s) from  +  s to        0 ≤ u ≤ 1: share of the duration
    /// ```
    /// The polynomial of least degree that starts and ends without speed and acceleration.
    #[must_use]
    pub fn tilt_and_height_at(&self, time: f64) -> (Tilt, AxisHeight) {
        let next = self.reached.partition_point(|&reached| reached <= time);
        let Some(to) = self.keys.get(next) else {
            let last = self.keys[self.keys.len() - 1];
            return (last.tilt, last.height);
        };
        let Some(before) = next.checked_sub(1) else { return (to.tilt, to.height) };
        let from = self.keys[before];
        let u = (time - self.reached[before]) / to.duration;
        let s = u * u * u * (10.0 + u * (6.0 * u - 15.0));
        let between = |a: f64, b: f64| a + (b - a) * s;
        let ((from_x, from_y), (to_x, to_y)) = (from.tilt.about_x_and_y(), to.tilt.about_x_and_y());
        let tilt = Tilt::from_about_x_and_y(between(from_x, to_x), between(from_y, to_y));
        (tilt, AxisHeight(between(from.height.0, to.height.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(azimuth: f64, tilt_angle: f64, height: f64, duration: f64) -> KeyPose {
        KeyPose { tilt: Tilt { azimuth, angle: tilt_angle }, height: AxisHeight(height), duration }
    }

    #[test]
    fn key_poses_are_reached_at_rest() {
        let keys =
            vec![key(0.0, 0.0, 0.5, 9.0), key(1.0, 0.02, 0.6, 2.0), key(4.0, 0.01, 0.4, 0.5)];
        let motion = KeyMotion::new(keys.clone(), 100.0).unwrap();
        assert_eq!(motion.samples(), 251);
        assert_eq!((motion.time(0), motion.time(200), motion.time(250)), (0.0, 2.0, 2.5));
        for (time, key) in [0.0, 2.0, 2.5].into_iter().zip(&keys) {
            let (tilt, height) = motion.tilt_and_height_at(time);
            assert!((tilt.normal() - key.tilt.normal()).norm() < 1e-15);
            assert!((height.0 - key.height.0).abs() < 1e-15);
            // At rest: 1 ms off in time is of third order in position.
            for near in [time - 1e-3, time + 1e-3] {
                let (tilt, height) = motion.tilt_and_height_at(near);
                assert!((tilt.normal() - key.tilt.normal()).norm() < 1e-8, "{near}");
                assert!((height.0 - key.height.0).abs() < 1e-7, "{near}");
            }
        }
        let (_, half) = motion.tilt_and_height_at(1.0);
        assert!((half.0 - 0.55).abs() < 1e-15, "midway at half the time");
        assert_eq!(motion.tilt_and_height_at(-1.0), motion.tilt_and_height_at(0.0));
        assert_eq!(motion.tilt_and_height_at(99.0), motion.tilt_and_height_at(2.5));
    }

    #[test]
    fn samples_end_on_the_last_pose() {
        let motion = KeyMotion::new(vec![key(0.0, 0.0, 0.5, 0.0), key(0.0, 0.01, 0.5, 1.0)], 0.3);
        let motion = motion.unwrap();
        assert_eq!((motion.samples(), motion.time(1)), (2, 1.0));
        let motion = KeyMotion::new(vec![key(0.0, 0.0, 0.5, 0.0), key(0.0, 0.01, 0.5, 0.7)], 3.0);
        let motion = motion.unwrap();
        assert_eq!((motion.samples(), motion.time(3)), (4, 0.7));
    }

    #[test]
    fn round_off_of_durations_adds_no_sample() {
        let keys = [0.0, 0.1, 0.2].map(|duration| key(0.0, 0.0, 0.5, duration)).to_vec();
        let motion = KeyMotion::new(keys, 100.0).unwrap();
        assert_eq!((motion.samples(), motion.time(30)), (31, 0.1 + 0.2));
    }

    #[test]
    fn invalid_motions_are_refused() {
        let refuse = |keys: Vec<KeyPose>, rate: f64, message: &str| {
            assert_eq!(KeyMotion::new(keys, rate).unwrap_err().to_string(), message);
        };
        let start = key(0.0, 0.0, 0.5, 0.0);
        refuse(vec![start], 10.0, "the motion has 1 key poses, it needs at least two");
        refuse(vec![start, start], 10.0, "the duration of a key pose is 0, it has to be positive");
        let second = key(0.0, 0.0, 0.5, f64::INFINITY);
        refuse(
            vec![start, second],
            10.0,
            "the duration of a key pose is inf, it has to be positive",
        );
        let second = key(0.0, 0.0, 0.5, 1.0);
        refuse(vec![start, second], -1.0, "the rate is -1, it has to be positive");
    }
}
