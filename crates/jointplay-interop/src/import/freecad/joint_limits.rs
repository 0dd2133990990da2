//! Limits of the distance and the angle between the two frames of a joint.

use std::f64::consts::TAU;

use jointplay_core::mechanism::{Joint, JointKind};

/// The motion of the second frame against the first that a limit or a drive is about.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FrameMotion {
    /// Along z of the first frame.
    Slide,
    /// Of x about z of the first frame.
    Turn,
}

/// The end of a range.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum RangeEnd {
    Least,
    Greatest,
}

/// One end of the range of a motion.
pub(super) struct FrameLimit {
    pub(super) motion: FrameMotion,
    pub(super) end: RangeEnd,
    /// Distance (m) or angle (rad).
    pub(super) value: f64,
}

/// Applies limits to a joint, and lists those of motions that it does not have.
///
/// A drawn angle that is within the limits after whole turns starts there.
pub(super) fn apply(joint: &mut Joint, limits: &[FrameLimit], ignore: &mut impl FnMut(String)) {
    let mut ranges = vec![[f64::NEG_INFINITY, f64::INFINITY]; joint.kind.freedoms()];
    let mut used = 0;
    for limit in limits {
        let Some(k) = coordinate(joint.kind, limit.motion) else { continue };
        let [least, greatest] = &mut ranges[k];
        match limit.end {
            RangeEnd::Least => *least = least.max(limit.value),
            RangeEnd::Greatest => *greatest = greatest.min(limit.value),
        }
        used += 1;
    }
    if used < limits.len() {
        ignore(format!("limit of joint {:?}, which has no such motion", joint.name));
    }
    if used == 0 {
        return;
    }
    for (k, &[least, greatest]) in ranges.iter().enumerate() {
        if Some(k) == coordinate(joint.kind, FrameMotion::Turn) {
            let drawn = joint.guess[k];
            let turns = match drawn < least {
                true => ((least - drawn) / TAU).ceil(),
                false => ((greatest - drawn) / TAU).floor(),
            };
            let within = drawn + turns * TAU;
            let is_outside = !(least..=greatest).contains(&drawn);
            if is_outside && (least..=greatest).contains(&within) {
                joint.guess[k] = within;
            }
        }
    }
    joint.limits = ranges;
}

/// The coordinate of a kind of joint that is this motion.
fn coordinate(kind: JointKind, motion: FrameMotion) -> Option<usize> {
    match (kind, motion) {
        (JointKind::Prismatic | JointKind::Cylindrical, FrameMotion::Slide)
        | (JointKind::Revolute, FrameMotion::Turn) => Some(0),
        (JointKind::Cylindrical, FrameMotion::Turn) => Some(1),
        (JointKind::Planar, FrameMotion::Turn) => Some(2),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use jointplay_core::spatial::Pose;

    use super::*;
    use crate::import::draft::bare;

    const LEAST: RangeEnd = RangeEnd::Least;
    const GREATEST: RangeEnd = RangeEnd::Greatest;

    #[track_caller]
    fn check(
        kind: JointKind,
        guess: &[f64],
        limits: &[(FrameMotion, RangeEnd, f64)],
        expected: &[[f64; 2]],
        start: &[f64],
        listed: usize,
    ) {
        let mut joint = bare("j".to_owned(), kind, [0, 1], [Pose::identity(); 2]);
        joint.guess = guess.to_vec();
        let limits: Vec<FrameLimit> =
            limits.iter().map(|&(motion, end, value)| FrameLimit { motion, end, value }).collect();
        let mut ignored = Vec::new();
        apply(&mut joint, &limits, &mut |what| ignored.push(what));
        assert_eq!((joint.limits.as_slice(), ignored.len()), (expected, listed), "{ignored:?}");
        for (found, expected) in joint.guess.iter().zip(start) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn limits_are_kept_at_the_ends_that_they_have() {
        use FrameMotion::{Slide, Turn};
        let range = [(Turn, LEAST, -1.0), (Turn, GREATEST, 2.0)];
        check(JointKind::Revolute, &[0.5], &range, &[[-1.0, 2.0]], &[0.5], 0);
        // The tightest count.
        let more = [range[0], range[1], (Turn, LEAST, 0.0), (Turn, GREATEST, 3.0)];
        check(JointKind::Revolute, &[0.5], &more, &[[0.0, 2.0]], &[0.5], 0);
        // One end only, and a motion that the joint does not have.
        let endless = [f64::NEG_INFINITY, f64::INFINITY];
        let open = [[-1.0, f64::INFINITY]];
        check(JointKind::Revolute, &[0.5], &range[..1], &open, &[0.5], 0);
        check(JointKind::Prismatic, &[0.5], &range, &[], &[0.5], 1);
        check(JointKind::Spherical, &[0.0; 3], &range, &[], &[0.0; 3], 1);
        let both = [range[0], range[1], (Slide, LEAST, 0.1), (Slide, GREATEST, 0.3)];
        let slide = [[0.1, 0.3], endless];
        check(JointKind::Cylindrical, &[0.2, 0.0], &both[2..], &slide, &[0.2, 0.0], 0);
        let expected = [[0.1, 0.3], [-1.0, 2.0]];
        check(JointKind::Cylindrical, &[0.2, 0.0], &both, &expected, &[0.2, 0.0], 0);
    }

    #[test]
    fn drawn_angles_start_within_their_limits_by_whole_turns() {
        use FrameMotion::Turn;
        // 190° is drawn as −170°.
        let range = [(Turn, LEAST, TAU / 4.0), (Turn, GREATEST, TAU * 0.75)];
        let drawn = -170_f64.to_radians();
        let kept = [[TAU / 4.0, TAU * 0.75]];
        check(JointKind::Revolute, &[drawn], &range, &kept, &[drawn + TAU], 0);
        // Outside by any number of turns: as drawn.
        check(JointKind::Revolute, &[0.0], &range, &kept, &[0.0], 0);
        let negative = [(Turn, LEAST, -TAU), (Turn, GREATEST, -TAU / 2.0)];
        let expected = [[-TAU, -TAU / 2.0]];
        check(JointKind::Revolute, &[2.0], &negative, &expected, &[2.0 - TAU], 0);
        // One end: the nearest angle within.
        let least = [(Turn, LEAST, 7.0)];
        check(JointKind::Revolute, &[2.0], &least, &[[7.0, f64::INFINITY]], &[2.0 + TAU], 0);
        let greatest = [(Turn, GREATEST, -7.0)];
        let expected = [[f64::NEG_INFINITY, -7.0]];
        check(JointKind::Revolute, &[2.0], &greatest, &expected, &[2.0 - 2.0 * TAU], 0);
    }
}
