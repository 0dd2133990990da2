//! Robot, stations, wafers, bodies and zones together.

use jointplay_core::spatial::Pose;

use crate::geometry::Shape;
use crate::incremental::{Fingerprint, Fingerprinted};
use crate::robot::{EffectorId, HybridRobot};
use crate::station::{SlotId, Station};
use crate::wafer::{Sag, SagError, Wafer, sag};

/// What a body is attached to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    /// The base frame.
    World,
    /// The platform frame.
    Platform,
    /// The frame of a link of an arm, both by index: origin at its joint, x along the link.
    Link {
        /// Which arm.
        arm: usize,
        /// Which link.
        link: usize,
    },
}

/// Something that may be run into.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// What it is called.
    pub name: String,
    /// What it moves with.
    pub carrier: Carrier,
    /// Where its shape is in the carrier's frame.
    pub carrier_from_shape: Pose,
    /// Its shape.
    pub shape: Shape,
    /// The station that it belongs to, by index, where it is told in that one's frame; it stands still in the world.
    pub station: Option<usize>,
}

/// A region with a rule.
#[derive(Debug, Clone, PartialEq)]
pub struct Zone {
    /// What it is called.
    pub name: String,
    /// Whether bodies of the robot have to stay out of it, or wafers within it.
    pub rule: ZoneRule,
    /// Where it is.
    pub base_from_shape: Pose,
    /// Its shape.
    pub shape: Shape,
}

/// What a zone asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZoneRule {
    /// No body of the robot and no carried wafer may enter.
    KeepOut,
    /// The centre of each effector stays within while its arm is retracted and the robot turns.
    Safe,
}

/// Everything that a program runs in.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// What it is called.
    pub name: String,
    /// What of it is assumed rather than known, each with its reason.
    pub assumed: Vec<String>,
    /// The robot.
    pub robot: HybridRobot,
    /// All wafers are alike.
    pub wafer: Wafer,
    /// Places of wafers.
    pub stations: Vec<Station>,
    /// Slots that hold a wafer at the start.
    pub occupied: Vec<SlotId>,
    /// Effectors that carry one at the start.
    pub carried: Vec<EffectorId>,
    /// Bodies besides the wafers.
    pub bodies: Vec<Body>,
    /// Pairs of bodies, by index, whose distance is not asked for.
    pub allowed_pairs: Vec<[usize; 2]>,
    /// Regions with rules.
    pub zones: Vec<Zone>,
    /// Largest displacement of virtual joints that the mechanism is trusted to have play for [m].
    pub play_budget: f64,
    /// Least distance asked for between bodies [m].
    pub clearance: f64,
    /// Least distance of a wafer from the slots above and below it [m].
    pub slot_clearance: f64,
    /// Acceleration of gravity, down in the base frame [m/s²].
    pub gravity: f64,
    /// How far the loaded wafer's plane may be from the station's after compensation [rad].
    pub plane_threshold: f64,
}

impl Cell {
    /// How the cell's wafer sags on an effector; the same for all places of it, so that it is found once.
    ///
    /// # Errors
    /// Those of [`sag`].
    ///
    /// # Panics
    /// If the robot has no such effector.
    pub fn sag(&self, effector: EffectorId) -> Result<Sag, SagError> {
        let support = &self.robot.arms[effector.arm].effectors[effector.effector].support;
        sag(&self.wafer, support, self.gravity)
    }
}

impl Fingerprinted for Zone {
    fn append_to(&self, fingerprint: &mut Fingerprint) {
        let Self { name, rule, base_from_shape, shape } = self;
        fingerprint.add(name).add(&(*rule == ZoneRule::Safe)).add(base_from_shape).add(shape);
    }
}
