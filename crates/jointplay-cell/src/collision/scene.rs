//! Collision objects of a cell, and their poses.

use std::sync::Arc;

use jointplay_core::spatial::Pose;
use nalgebra::{Point3, Rotation3, Vector3};

use super::link_poses::{LinkPoses, PoseError};
use super::object::{CollisionObject, Parent, Role};
use crate::EntityId;
use crate::geometry::{Collider, ColliderCache, PlacedCollider, Shape};
use crate::program::{LocationChange, WaferLocation, WaferLocations};
use crate::robot::{ArmChain, EffectorId};
use crate::station::SlotId;
use crate::workcell::{Cell, ParentFrame, ZoneRule};

/// All collision objects of a cell, and the wafers that effectors hold.
#[derive(Clone)]
pub(crate) struct Scene<'a> {
    pub(crate) cell: &'a Cell,
    pub(crate) objects: Vec<Arc<CollisionObject>>,
    /// Index of the object of the first wafer; `None` where wafers have no collider.
    first_wafer: Option<usize>,
    /// Effectors that hold a wafer, with the index of its object.
    held: Vec<(EffectorId, usize)>,
    /// Safe zones, by index in the cell.
    pub(crate) safe_zones: Vec<(usize, Collider)>,
    /// Chain to each effector, by arm and effector.
    chains: Vec<Vec<ArmChain>>,
    /// Distances that the slots of each station need for the uncertainty of its frame (m).
    slot_margins: Arc<Vec<Vec<f64>>>,
}

impl<'a> Scene<'a> {
    pub(crate) fn new(cell: &'a Cell, cache: &mut ColliderCache) -> Self {
        let (mut objects, mut held) = (Vec::new(), Vec::new());
        for (index, body) in cell.bodies.iter().enumerate() {
            // A body on a link with several effectors has one object for the deflection at each of them.
            let parents = match body.parent {
                ParentFrame::World => vec![Parent::World],
                ParentFrame::Platform => vec![Parent::Platform],
                ParentFrame::Link { arm, link }
                    if link + 1 == cell.robot.arms[arm].joints.len() =>
                {
                    let effectors = 0..cell.robot.arms[arm].effectors.len();
                    effectors
                        .map(|effector| Parent::DeflectedLastLink(EffectorId { arm, effector }))
                        .collect()
                }
                ParentFrame::Link { arm, link } => vec![Parent::Link { arm, link }],
            };
            // So has a body of several boxes: one for each of them.
            for parent in parents {
                for collider in cache.get_convex(&body.shape, &body.parent_from_shape) {
                    let (entity, role) = (EntityId::Body(index), Role::Body(index));
                    objects.push(CollisionObject::new(entity, collider, parent, role, cache));
                }
            }
        }
        let mut safe_zones = Vec::new();
        for (index, zone) in cell.zones.iter().enumerate() {
            let (shape, pose) = (&zone.shape, &zone.base_from_shape);
            match zone.rule {
                ZoneRule::KeepOut => {
                    let (entity, role) = (EntityId::Zone(index), Role::KeepOut);
                    for collider in cache.get_convex(shape, pose) {
                        let object =
                            CollisionObject::new(entity, collider, Parent::World, role, cache);
                        objects.push(object);
                    }
                }
                ZoneRule::Safe => {
                    safe_zones.extend(cache.get(shape, pose).map(|it| (index, it.collider)));
                }
            }
        }
        // The lower face of a wafer is in the xy plane of its frame.
        let half_height = 0.5 * cell.wafer.thickness;
        let disc = Shape::Cylinder { radius: 0.5 * cell.wafer.diameter, half_height };
        let middle = Pose::from_parts(
            Vector3::new(0.0, 0.0, half_height).into(),
            nalgebra::Rotation3::identity(),
        );
        let mut first_wafer = None;
        if let Some(disc) = cache.get(&disc, &middle) {
            first_wafer = Some(objects.len());
            let locations = WaferLocations::at_start(cell);
            for wafer in locations.wafers() {
                let (entity, location) = (locations.wafer_id(wafer), locations.location(wafer));
                let (disc, parent) = (disc.clone(), Parent::from(location));
                let mut object = CollisionObject::new(entity, disc, parent, Role::Wafer, cache);
                match location {
                    WaferLocation::Slot(slot) => {
                        let frame = cell.stations[slot.station].slot_frame(slot.slot);
                        object.set_fixed_pose(frame, cache);
                    }
                    WaferLocation::Effector(id) => held.push((id, objects.len())),
                }
                objects.push(object);
            }
        }
        let chains_of = |arm: usize| {
            let effectors = 0..cell.robot.arms[arm].effectors.len();
            effectors.map(move |effector| ArmChain::new(&cell.robot, EffectorId { arm, effector }))
        };
        let chains = (0..cell.robot.arms.len()).map(|arm| chains_of(arm).collect()).collect();
        let objects = objects.into_iter().map(Arc::new).collect();
        let slot_margins = Arc::new(cell.stations.iter().map(|it| cell.slot_margins(it)).collect());
        Self { cell, objects, first_wafer, held, safe_zones, chains, slot_margins }
    }

    /// Poses of all moving bodies at axis positions.
    ///
    /// # Arguments
    /// * `buffer` – an empty vector whose memory is reused
    ///
    /// # Errors
    /// [`PoseError`]
    pub(crate) fn link_poses(
        &self,
        positions: &[f64],
        mut buffer: Vec<Pose>,
    ) -> Result<LinkPoses, PoseError> {
        let robot = &self.cell.robot;
        let platform = robot.platform(positions)?;
        let base_from_platform = platform.base_from_platform;
        let loaded = |id: EffectorId| self.held_wafer(id).is_some();
        buffer.reserve(self.first_of(robot.arms.len()));
        for arm in 0..robot.arms.len() {
            let base_from_platform = &base_from_platform;
            let resolve = |found| found;
            self.cell.append_arm_poses(
                arm,
                base_from_platform,
                positions,
                loaded,
                resolve,
                &mut buffer,
            )?;
        }
        Ok(LinkPoses { base_from_platform, normal: platform.normal(), poses: buffer })
    }

    /// Index of the first pose of an arm.
    fn first_of(&self, arm: usize) -> usize {
        let before = &self.cell.robot.arms[..arm];
        before.iter().map(|arm| arm.joints.len() + 2 * arm.effectors.len()).sum()
    }

    /// Index of the pose of the deflected last link at an effector; that of its wafer is the next.
    fn tip_of(&self, EffectorId { arm, effector }: EffectorId) -> usize {
        self.first_of(arm) + self.cell.robot.arms[arm].joints.len() + 2 * effector
    }

    /// Kinematic chain to an effector.
    pub(crate) fn chain(&self, id: EffectorId) -> &ArmChain {
        &self.chains[id.arm][id.effector]
    }

    /// Pose of the wafer of an effector, whether it holds one or not, with the deflection of the arm.
    ///
    /// # Errors
    /// [`PoseError`]
    pub(crate) fn wafer_pose(&self, id: EffectorId, positions: &[f64]) -> Result<Pose, PoseError> {
        let platform = self.cell.robot.platform(positions)?.base_from_platform;
        let loaded = self.held_wafer(id).is_some();
        Ok(self.cell.wafer_over(&platform, self.chain(id), positions, loaded)?)
    }

    /// Collider of an object at its pose.
    pub(crate) fn collider_at<'b>(
        &'b self,
        object: usize,
        poses: &'b LinkPoses,
    ) -> PlacedCollider<'b> {
        let object = &self.objects[object];
        let base_from_parent = match object.parent {
            Parent::World | Parent::Slot(_) => &object.base_from_fixed_parent,
            Parent::Platform => &poses.base_from_platform,
            Parent::Link { arm, link } => &poses.poses[self.first_of(arm) + link],
            Parent::DeflectedLastLink(id) => &poses.poses[self.tip_of(id)],
            Parent::Effector(id) => &poses.poses[self.tip_of(id) + 1],
        };
        PlacedCollider { collider: &object.collider, base_from_parent }
    }

    /// Reach of an arm: distance of the wafer's centre from the first joint, in the plane of the arm and without its deflection (m).
    pub(super) fn reach(&self, EffectorId { arm, effector }: EffectorId, poses: &LinkPoses) -> f64 {
        let described = &self.cell.robot.arms[arm];
        let last = &poses.poses[self.first_of(arm) + self.last_link(arm)];
        let center = last * Point3::from(described.effectors[effector].wafer_center);
        let joint = poses.base_from_platform * Point3::from(described.mount);
        let out = center - joint;
        (out - poses.normal * out.dot(&poses.normal)).norm()
    }

    /// Rotation of a parent in the base frame without the deflection of arms; identity for the world and for slots.
    pub(crate) fn rotation_of(&self, parent: Parent, poses: &LinkPoses) -> Rotation3<f64> {
        match parent {
            Parent::World | Parent::Slot(_) => Rotation3::identity(),
            Parent::Platform => poses.base_from_platform.rotation,
            Parent::Link { arm, link } => poses.poses[self.first_of(arm) + link].rotation,
            Parent::DeflectedLastLink(EffectorId { arm, .. })
            | Parent::Effector(EffectorId { arm, .. }) => {
                poses.poses[self.first_of(arm) + self.last_link(arm)].rotation
            }
        }
    }

    /// Distance that a slot needs for the uncertainty of its station (m).
    pub(super) fn slot_margin(&self, SlotId { station, slot }: SlotId) -> f64 {
        self.slot_margins[station].get(slot - 1).copied().unwrap_or(0.0)
    }

    /// Largest of these distances (m).
    pub(crate) fn largest_slot_margin(&self) -> f64 {
        self.slot_margins.iter().flatten().copied().fold(0.0, f64::max)
    }

    /// Index of the last link of an arm.
    pub(super) fn last_link(&self, arm: usize) -> usize {
        self.cell.robot.arms[arm].joints.len() - 1
    }

    /// Index of the first object of an object's entity; the objects of an entity follow each other.
    pub(crate) fn first_object_of_entity(&self, object: usize) -> usize {
        let entity = self.objects[object].entity;
        let before = self.objects[..object].iter().rev();
        object - before.take_while(|one| one.entity == entity).count()
    }

    /// Index of the wafer that an effector holds.
    pub(crate) fn held_wafer(&self, id: EffectorId) -> Option<usize> {
        self.held.iter().find(|(by, _)| *by == id).map(|(_, object)| *object)
    }

    /// Attaches a wafer to its new parent at a hand-off.
    pub(crate) fn move_wafer(&mut self, change: &LocationChange, cache: &mut ColliderCache) {
        let Some(first) = self.first_wafer else { return };
        let index = first + change.wafer;
        self.held.retain(|&(_, wafer)| wafer != index);
        let object = Arc::make_mut(&mut self.objects[index]);
        object.parent = Parent::from(change.to);
        match change.to {
            WaferLocation::Effector(id) => self.held.push((id, index)),
            WaferLocation::Slot(slot) => {
                let frame = self.cell.stations[slot.station].slot_frame(slot.slot);
                object.set_fixed_pose(frame, cache);
            }
        }
    }
}
