//! Collision objects of a cell, and where they are.

use std::sync::Arc;

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector3};

use super::link_poses::{Places, Unplaced};
use super::object::{Holder, Item, Role};
use crate::EntityId;
use crate::geometry::{Placed, Shape, Solid, Solids};
use crate::program::Handover;
use crate::robot::{ArmChain, EffectorId};
use crate::workcell::{Carrier, Cell, ZoneRule};

/// Everything that takes room in a cell.
#[derive(Clone)]
pub(crate) struct Scene<'a> {
    pub(crate) cell: &'a Cell,
    pub(crate) items: Vec<Arc<Item>>,
    /// Effectors that carry a wafer, and which.
    carried: Vec<(EffectorId, usize)>,
    /// Zones that wafers' centres have to stay in while the robot turns, by index in the cell.
    pub(crate) safe: Vec<(usize, Solid)>,
    /// By arm and effector.
    arms: Vec<Vec<ArmChain>>,
}

impl<'a> Scene<'a> {
    pub(crate) fn new(cell: &'a Cell, solids: &mut Solids) -> Self {
        let (mut items, mut carried) = (Vec::new(), Vec::new());
        for (index, body) in cell.bodies.iter().enumerate() {
            // A body on a link with several effectors is there once for each deflection.
            let holders = match body.carrier {
                Carrier::World => vec![Holder::World],
                Carrier::Platform => vec![Holder::Platform],
                Carrier::Link { arm, link } if link + 1 == cell.robot.arms[arm].joints.len() => {
                    let effectors = 0..cell.robot.arms[arm].effectors.len();
                    effectors.map(|effector| Holder::Tip(EffectorId { arm, effector })).collect()
                }
                Carrier::Link { arm, link } => vec![Holder::Link { arm, link }],
            };
            for holder in holders {
                if let Some(solid) = solids.get(&body.shape, &body.carrier_from_shape) {
                    let what = (holder, Role::Body(index));
                    items.push(Item::new(EntityId::Body(index), solid, what, solids));
                }
            }
        }
        let mut safe = Vec::new();
        for (index, zone) in cell.zones.iter().enumerate() {
            let Some(solid) = solids.get(&zone.shape, &zone.base_from_shape) else { continue };
            match zone.rule {
                ZoneRule::KeepOut => {
                    let what = (Holder::World, Role::KeepOut);
                    items.push(Item::new(EntityId::Zone(index), solid, what, solids));
                }
                ZoneRule::Safe => safe.push((index, solid.1)),
            }
        }
        // A wafer lies on the plane of its frame, thickness upward.
        let half_height = 0.5 * cell.wafer.thickness;
        let disc = Shape::Cylinder { radius: 0.5 * cell.wafer.diameter, half_height };
        let middle = Pose::from_parts(
            Vector3::new(0.0, 0.0, half_height).into(),
            nalgebra::Rotation3::identity(),
        );
        if let Some(disc) = solids.get(&disc, &middle) {
            for &slot in &cell.occupied {
                let what = (Holder::Slot(slot), Role::Wafer);
                let mut item = Item::new(EntityId::Wafer(slot), disc.clone(), what, solids);
                item.stand(cell.stations[slot.station].slot_frame(slot.slot), solids);
                items.push(item);
            }
            for &id in &cell.carried {
                carried.push((id, items.len()));
                let what = (Holder::Effector(id), Role::Wafer);
                items.push(Item::new(EntityId::HeldWafer(id), disc.clone(), what, solids));
            }
        }
        let planar = |arm: usize| {
            let effectors = 0..cell.robot.arms[arm].effectors.len();
            effectors.map(move |effector| ArmChain::new(&cell.robot, EffectorId { arm, effector }))
        };
        let arms = (0..cell.robot.arms.len()).map(|arm| planar(arm).collect()).collect();
        let items = items.into_iter().map(Arc::new).collect();
        Self { cell, items, carried, safe, arms }
    }

    /// Poses of all that moves, in the room given.
    ///
    /// # Errors
    /// [`Unplaced`]
    pub(crate) fn places(
        &self,
        positions: &[f64],
        mut room: Vec<Pose>,
    ) -> Result<Places, Unplaced> {
        let robot = &self.cell.robot;
        let platform = robot.platform(positions)?;
        let base_from_platform = platform.base_from_platform;
        let loaded = |id: EffectorId| self.carried_by(id).is_some();
        for arm in 0..robot.arms.len() {
            let placed = (arm, &base_from_platform);
            self.cell.place_arm(placed, positions, loaded, |found| found, &mut room)?;
        }
        Ok(Places { base_from_platform, normal: platform.normal(), poses: room })
    }

    /// The number of an arm's first pose among the places.
    fn first_of(&self, arm: usize) -> usize {
        let before = &self.cell.robot.arms[..arm];
        before.iter().map(|arm| arm.joints.len() + 2 * arm.effectors.len()).sum()
    }

    /// The number of the pose of an effector's last link among the places; that of its wafer is the next.
    fn tip_of(&self, EffectorId { arm, effector }: EffectorId) -> usize {
        self.first_of(arm) + self.cell.robot.arms[arm].joints.len() + 2 * effector
    }

    /// The arm to an effector.
    pub(crate) fn planar(&self, id: EffectorId) -> &ArmChain {
        &self.arms[id.arm][id.effector]
    }

    /// Pose of an effector's wafer, or of where it would be, its arm deflected.
    ///
    /// # Errors
    /// [`Unplaced`]
    pub(crate) fn wafer(&self, id: EffectorId, positions: &[f64]) -> Result<Pose, Unplaced> {
        let platform = self.cell.robot.platform(positions)?.base_from_platform;
        let loaded = self.carried_by(id).is_some();
        Ok(self.cell.wafer_over(&platform, self.planar(id), positions, loaded)?)
    }

    /// Where an item is.
    pub(crate) fn placed<'b>(&'b self, item: usize, places: &'b Places) -> Placed<'b> {
        let item = &self.items[item];
        let base_from_carrier = match item.holder {
            Holder::World | Holder::Slot(_) => &item.standing,
            Holder::Platform => &places.base_from_platform,
            Holder::Link { arm, link } => &places.poses[self.first_of(arm) + link],
            Holder::Tip(id) => &places.poses[self.tip_of(id)],
            Holder::Effector(id) => &places.poses[self.tip_of(id) + 1],
        };
        Placed { solid: &item.solid, base_from_carrier }
    }

    /// Rotation of a carrier against the base, an arm taken as rigid; none for the world and for slots.
    pub(crate) fn turned(&self, holder: Holder, places: &Places) -> Rotation3<f64> {
        match holder {
            Holder::World | Holder::Slot(_) => Rotation3::identity(),
            Holder::Platform => places.base_from_platform.rotation,
            Holder::Link { arm, link } => places.poses[self.first_of(arm) + link].rotation,
            Holder::Tip(EffectorId { arm, .. }) | Holder::Effector(EffectorId { arm, .. }) => {
                places.poses[self.first_of(arm) + self.last_link(arm)].rotation
            }
        }
    }

    /// Index of the last link of an arm.
    pub(super) fn last_link(&self, arm: usize) -> usize {
        self.cell.robot.arms[arm].joints.len() - 1
    }

    /// The wafer that an effector carries, by index among the items.
    pub(crate) fn carried_by(&self, id: EffectorId) -> Option<usize> {
        self.carried.iter().find(|(by, _)| *by == id).map(|(_, item)| *item)
    }

    /// Does what the end of a step does to wafers.
    pub(crate) fn hand_over(&mut self, handover: Handover, solids: &mut Solids) {
        let (from, to) = match handover {
            Handover::Picked(id, slot) => (Holder::Slot(slot), Holder::Effector(id)),
            Handover::Placed(id, slot) => (Holder::Effector(id), Holder::Slot(slot)),
        };
        let Some(index) = self.items.iter().position(|item| item.holder == from) else { return };
        match handover {
            Handover::Picked(id, _) => self.carried.push((id, index)),
            Handover::Placed(id, _) => self.carried.retain(|(by, _)| *by != id),
        }
        let item = Arc::make_mut(&mut self.items[index]);
        item.holder = to;
        if let Holder::Slot(slot) = to {
            item.stand(self.cell.stations[slot.station].slot_frame(slot.slot), solids);
            item.laid = true;
        }
    }
}
