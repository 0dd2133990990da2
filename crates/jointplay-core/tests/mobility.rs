//! Mobility of the paper's robot: counted, instantaneous, augmented, finite.

use jointplay_core::gpr::{AxisHeight, Gpr};
use jointplay_core::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{Offset, Planar, Polar, Radial, SolveOptions, Virtualization};

#[track_caller]
fn check(tilt_deg: f64, rank: usize, instantaneous: usize, finite: usize) {
    let gpr = Gpr::paper().without_limit_checks();
    assert_eq!(gpr.kutzbach_mobility(), 0);
    let tilt = Tilt { azimuth: 0.7, angle: tilt_deg.to_radians() };
    let rods = gpr.inverse(tilt, AxisHeight(0.5)).unwrap();
    let all: [&dyn Virtualization; 4] = [&Radial, &Polar, &Offset, &Planar];
    for virtualization in all {
        let pose = gpr.forward(rods, virtualization, &SolveOptions::default()).unwrap();
        let system = gpr.system(virtualization);
        let at = system.configuration(&pose);
        let found = finite_mobility(&system, &at, RANK_THRESHOLD).unwrap();
        let first = &found.instantaneous;
        assert_eq!(
            (first.rank, first.mobility, first.redundancy),
            (rank, instantaneous, 12 - rank)
        );
        assert_eq!(found.mobility, Some(finite), "{found:#?}");
        let augmented = augmented_mobility(&system, &at, RANK_THRESHOLD).unwrap();
        let joints = virtualization.joints().len();
        assert_eq!((augmented.rank, augmented.mobility, augmented.redundancy), (12, joints, 0));
    }
}

#[test]
fn level_pose_is_infinitesimally_mobile() {
    check(0.0, 9, 3, 1);
}

#[test]
fn tilted_is_stiff_however_little() {
    check(1e-8, 11, 1, 1);
    check(0.1, 11, 1, 1);
    check(2.0, 11, 1, 1);
    check(5.0, 11, 1, 1);
}
