//! Cache keys of robots.

use jointplay_core::gpr::{Gpr, Limb, Limits};
use jointplay_core::virtualization::{BuiltIn, Metric, SolveOptions, Solver};

use super::{
    Arm, ArmJoint, Axis, AxisKind, Effector, EffectorId, HybridRobot, KinematicLimits,
    PlatformModel, PosturePath,
};
use crate::incremental::{CacheKey, CacheKeyPart};

impl CacheKeyPart for EffectorId {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { arm, effector } = self;
        key.add(arm).add(effector);
    }
}

impl CacheKeyPart for PosturePath {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { fractions, positions } = self;
        key.add(fractions).add(positions);
    }
}

impl CacheKeyPart for HybridRobot {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { name, gpr, model, axes, arms, assumed } = self;
        key.add(name).add(gpr).add(model).add(axes).add(arms).add(assumed);
    }
}

impl CacheKeyPart for Gpr {
    /// A platform is determined by its limbs, its limits and its working height.
    fn append_to(&self, key: &mut CacheKey) {
        for Limb { base_point, socket_radius, socket_angle } in self.limbs() {
            key.add(&base_point.x).add(&base_point.y);
            key.add(&socket_radius).add(&socket_angle);
        }
        let Limits { rod_min, rod_max, tilt_max } = self.limits();
        key.add(rod_min).add(rod_max).add(tilt_max).add(&self.working_height());
    }
}

impl CacheKeyPart for PlatformModel {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { virtualization, options } = self;
        let SolveOptions { solver, metric, max_iterations, relative_threshold } = options;
        key.add(&match virtualization {
            BuiltIn::Radial => 0_u64,
            BuiltIn::Polar => 1,
            BuiltIn::Offset => 2,
            BuiltIn::Planar => 3,
        });
        key.add(&match solver {
            Solver::Newton => 0_u64,
            Solver::LeastNorm => 1,
            Solver::ClosedForm => 2,
        });
        key.add(&match metric {
            Metric::Paper => (0_u64, 0.0),
            Metric::PlatformRadius => (1, 0.0),
            Metric::Length(length) => (2, *length),
        });
        key.add(max_iterations).add(relative_threshold);
    }
}

impl CacheKeyPart for Axis {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { name, kind, min, max, home, empty, loaded } = self;
        key.add(name).add(kind).add(min).add(max).add(home).add(empty).add(loaded);
    }
}

impl CacheKeyPart for AxisKind {
    fn append_to(&self, key: &mut CacheKey) {
        key.add(&match self {
            Self::Rotary => 0_u64,
            Self::Linear => 1,
        });
    }
}

impl CacheKeyPart for KinematicLimits {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { velocity, acceleration, jerk } = self;
        key.add(velocity).add(acceleration).add(jerk);
    }
}

impl CacheKeyPart for Arm {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { name, mount, joints, effectors, droop } = self;
        key.add(name).add(mount).add(joints).add(effectors).add(droop);
    }
}

impl CacheKeyPart for ArmJoint {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { kind, zero, drives, length, offset, rise } = self;
        key.add(kind).add(zero).add(drives).add(length).add(offset).add(rise);
    }
}

impl CacheKeyPart for Effector {
    fn append_to(&self, key: &mut CacheKey) {
        let Self { name, wafer_center, heading, support, friction } = self;
        key.add(name).add(wafer_center).add(heading).add(support).add(friction);
    }
}
