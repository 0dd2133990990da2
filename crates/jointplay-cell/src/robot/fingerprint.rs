//! Fingerprints of robots.

use jointplay_core::gpr::{Gpr, Limb, Limits};
use jointplay_core::virtualization::{BuiltIn, Metric, SolveOptions, Solver};

use super::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, KinematicLimits,
    PlatformModel, PosturePath,
};
use crate::incremental::{Fingerprint, Fingerprinted};

impl Fingerprinted for EffectorId {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { arm, effector } = self;
        fingerprint.add(arm).add(effector);
    }
}

impl Fingerprinted for PosturePath {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { shares, positions } = self;
        fingerprint.add(shares).add(positions);
    }
}

impl Fingerprinted for HybridRobot {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { name, gpr, model, axes, arms, assumed } = self;
        fingerprint.add(name).add(gpr).add(model).add(axes).add(arms).add(assumed);
    }
}

impl Fingerprinted for Gpr {
    /// A platform is determined by its limbs, its limits and its working height.
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        for Limb { base_point, socket_radius, socket_angle } in self.limbs() {
            fingerprint.add(&base_point.x).add(&base_point.y);
            fingerprint.add(&socket_radius).add(&socket_angle);
        }
        let Limits { rod_min, rod_max, tilt_max } = self.limits();
        fingerprint.add(rod_min).add(rod_max).add(tilt_max).add(&self.working_height());
    }
}

impl Fingerprinted for PlatformModel {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { virtualization, options } = self;
        let SolveOptions { solver, metric, max_iterations, relative_threshold } = options;
        fingerprint.add(&match virtualization {
            BuiltIn::Radial => 0_u64,
            BuiltIn::Polar => 1,
            BuiltIn::Offset => 2,
            BuiltIn::Planar => 3,
        });
        fingerprint.add(&match solver {
            Solver::Newton => 0_u64,
            Solver::LeastNorm => 1,
            Solver::ClosedForm => 2,
        });
        fingerprint.add(&match metric {
            Metric::Paper => (0_u64, 0.0),
            Metric::PlatformRadius => (1, 0.0),
            Metric::Length(length) => (2, *length),
        });
        fingerprint.add(max_iterations).add(relative_threshold);
    }
}

impl Fingerprinted for Axis {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { name, kind, min, max, home, empty, loaded } = self;
        fingerprint.add(name).add(kind).add(min).add(max).add(home).add(empty).add(loaded);
    }
}

impl Fingerprinted for AxisKind {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        fingerprint.add(&match self {
            Self::Rotary => 0_u64,
            Self::Linear => 1,
        });
    }
}

impl Fingerprinted for KinematicLimits {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { velocity, acceleration, jerk } = self;
        fingerprint.add(velocity).add(acceleration).add(jerk);
    }
}

impl Fingerprinted for Arm {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { name, mount, joints, effectors, droop } = self;
        fingerprint.add(name).add(mount).add(joints).add(effectors).add(droop);
    }
}

impl Fingerprinted for ArmJoint {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { kind, zero, drives, length, offset, rise } = self;
        fingerprint.add(kind).add(zero).add(drives).add(length).add(offset).add(rise);
    }
}

impl Fingerprinted for Effector {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { name, wafer_center, heading, support, friction } = self;
        fingerprint.add(name).add(wafer_center).add(heading).add(support).add(friction);
    }
}
