//! Bodies, wafers and zones, and where they are.

use std::sync::Arc;

use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Vector3};

use super::report::Kind;
use crate::cell::{Carrier, Cell, Shape, ZoneRule};
use crate::memory::Key;
use crate::program::{Handover, Path, Phase, Step};
use crate::robot::{ArmChain, EffectorId};
use crate::solid::{Placed, Solid, Solids, Span};
use crate::station::SlotId;
use crate::wafer::DroopError;

/// What holds an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Holder {
    World,
    Platform,
    /// A link before the last one of its arm.
    Link {
        arm: usize,
        link: usize,
    },
    /// The last link of an arm, deflected as at this effector.
    Tip(EffectorId),
    Slot(SlotId),
    Effector(EffectorId),
}

impl Holder {
    pub(super) fn moves(self) -> bool {
        !matches!(self, Self::World | Self::Slot(_))
    }
}

/// What an item is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Of the cell, by index.
    Body(usize),
    Wafer,
    KeepOut,
}

/// Something that takes room.
#[derive(Clone)]
pub(super) struct Item {
    pub(super) name: String,
    pub(super) solid: Solid,
    /// Number of its solid, which no other solid has.
    number: u64,
    /// Number of its solid where it stands, for what does not move.
    stands: u64,
    pub(super) holder: Holder,
    pub(super) role: Role,
    /// Where its holder stands, for what does not move.
    standing: Pose,
    /// A box around it, axes those of the base, for what does not move.
    pub(super) around: [Span; 3],
    /// Whether it was ever laid into a slot.
    pub(super) laid: bool,
}

/// Where all that moves is at one time.
#[derive(Debug)]
pub(super) struct Places {
    base_from_platform: Pose,
    pub(super) normal: Vector3<f64>,
    /// Arm by arm, as [`Cell::place_arm`] adds them: links, then for each effector the last link deflected, and its wafer.
    poses: Vec<Pose>,
}

/// Why the poses of all that moves are unknown at one time.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Unplaced {
    /// [`Kind::Platform`] or [`Kind::Droop`].
    pub(super) kind: Kind,
    pub(super) why: String,
}

impl From<crate::CellError> for Unplaced {
    fn from(error: crate::CellError) -> Self {
        Self { kind: Kind::Platform, why: error.to_string() }
    }
}

impl From<DroopError> for Unplaced {
    fn from(error: DroopError) -> Self {
        Self { kind: Kind::Droop, why: error.to_string() }
    }
}

impl Places {
    /// The room that they took.
    pub(super) fn into_room(mut self) -> Vec<Pose> {
        self.poses.clear();
        self.poses
    }
}

/// Everything that takes room in a cell.
#[derive(Clone)]
pub(super) struct Scene<'a> {
    pub(super) cell: &'a Cell,
    pub(super) items: Vec<Arc<Item>>,
    /// Effectors that carry a wafer, and which.
    carried: Vec<(EffectorId, usize)>,
    /// Zones that wafers' centres have to stay in while the robot turns, by index in the cell.
    pub(super) safe: Vec<(usize, Solid)>,
    /// By arm and effector.
    arms: Vec<Vec<ArmChain>>,
}

impl<'a> Scene<'a> {
    pub(super) fn new(cell: &'a Cell, solids: &mut Solids) -> Self {
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
                    items.push(Item::new(body.name.clone(), solid, what, solids));
                }
            }
        }
        let mut safe = Vec::new();
        for (index, zone) in cell.zones.iter().enumerate() {
            let Some(solid) = solids.get(&zone.shape, &zone.base_from_shape) else { continue };
            match zone.rule {
                ZoneRule::KeepOut => {
                    let what = (Holder::World, Role::KeepOut);
                    items.push(Item::new(zone.name.clone(), solid, what, solids));
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
                let name = format!("wafer of {}", slot_name(cell, slot));
                let what = (Holder::Slot(slot), Role::Wafer);
                let mut item = Item::new(name, disc.clone(), what, solids);
                item.stand(cell.stations[slot.station].slot_frame(slot.slot), solids);
                items.push(item);
            }
            for &id in &cell.carried {
                let name = format!("wafer from {}", effector_name(cell, id));
                carried.push((id, items.len()));
                let what = (Holder::Effector(id), Role::Wafer);
                items.push(Item::new(name, disc.clone(), what, solids));
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
    pub(super) fn places(
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
    pub(super) fn planar(&self, id: EffectorId) -> &ArmChain {
        &self.arms[id.arm][id.effector]
    }

    /// Pose of an effector's wafer, or of where it would be, its arm deflected.
    ///
    /// # Errors
    /// [`Unplaced`]
    pub(super) fn wafer(&self, id: EffectorId, positions: &[f64]) -> Result<Pose, Unplaced> {
        let platform = self.cell.robot.platform(positions)?.base_from_platform;
        let (arm, loaded) = ((id, self.planar(id)), self.carried_by(id).is_some());
        Ok(self.cell.wafer_over(&platform, arm, positions, loaded)?)
    }

    /// Where an item is.
    pub(super) fn placed<'b>(&'b self, item: usize, places: &'b Places) -> Placed<'b> {
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
    pub(super) fn turned(&self, holder: Holder, places: &Places) -> Rotation3<f64> {
        match holder {
            Holder::World | Holder::Slot(_) => Rotation3::identity(),
            Holder::Platform => places.base_from_platform.rotation,
            Holder::Link { arm, link } => places.poses[self.first_of(arm) + link].rotation,
            Holder::Tip(EffectorId { arm, .. }) | Holder::Effector(EffectorId { arm, .. }) => {
                places.poses[self.first_of(arm) + self.last_link(arm)].rotation
            }
        }
    }

    /// The wafer that an effector carries, by index among the items.
    pub(super) fn carried_by(&self, id: EffectorId) -> Option<usize> {
        self.carried.iter().find(|(by, _)| *by == id).map(|(_, item)| *item)
    }

    /// Does what the end of a step does to wafers.
    pub(super) fn hand_over(&mut self, handover: Handover, solids: &mut Solids) {
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

impl Item {
    fn new(
        name: String,
        (number, solid): (u64, Solid),
        (holder, role): (Holder, Role),
        solids: &mut Solids,
    ) -> Self {
        let (around, standing) = ([Span { least: 0.0, most: 0.0 }; 3], Pose::identity());
        let (stands, laid) = (0, false);
        let mut item = Self { name, solid, number, stands, holder, role, standing, around, laid };
        item.stand(standing, solids);
        item
    }

    fn stand(&mut self, standing: Pose, solids: &mut Solids) {
        self.standing = standing;
        self.stands = solids.standing(self.number, &standing);
        let placed = Placed { solid: &self.solid, base_from_carrier: &self.standing };
        self.around = placed.around();
    }

    /// Adds what it is and what holds it to inputs.
    pub(super) fn key(&self, key: &mut Key) {
        match self.holder {
            Holder::World | Holder::Slot(_) => key.extend([0, self.stands]),
            Holder::Platform => key.extend([1, self.number]),
            Holder::Link { arm, link } => {
                key.extend([2, self.number, arm as u64, link as u64]);
            }
            Holder::Effector(EffectorId { arm, effector }) => {
                key.extend([3, self.number, arm as u64, effector as u64]);
            }
            Holder::Tip(EffectorId { arm, effector }) => {
                key.extend([4, self.number, arm as u64, effector as u64]);
            }
        }
    }
}

/// A slot in words: the station, and the slot's number where there are several.
pub(super) fn slot_name(cell: &Cell, slot: SlotId) -> String {
    let station = &cell.stations[slot.station];
    if station.slots > 1 { format!("{} {}", station.name, slot.slot) } else { station.name.clone() }
}

/// An effector's name.
pub(super) fn effector_name(cell: &Cell, id: EffectorId) -> String {
    cell.robot.arms[id.arm].effectors[id.effector].name.clone()
}

/// What is asked of the distance of two items during a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rule {
    /// Nothing.
    Free,
    /// Not to touch, and to stay this far apart [m].
    Apart(f64),
    /// As before, asked for by the slots of a station.
    Slots(f64),
    /// Not to enter.
    Out,
}

/// The effector that a step is about.
pub(super) fn acting(step: &Step) -> Option<EffectorId> {
    match (step.path, step.handover) {
        (Path::Line(id), _) => Some(id),
        (_, Some(Handover::Picked(id, _) | Handover::Placed(id, _))) => Some(id),
        _ => None,
    }
}

impl Rule {
    /// Adds what is asked to inputs.
    pub(super) fn key(self, key: &mut Key) {
        let (kind, limit) = match self {
            Self::Free => (0, 0.0),
            Self::Apart(limit) => (1, limit),
            Self::Slots(limit) => (2, limit),
            Self::Out => (3, 0.0),
        };
        key.extend([kind, f64::to_bits(limit)]);
    }
}

impl Scene<'_> {
    /// What is asked of two items, whatever the step.
    ///
    /// Nothing is asked of bodies on one carrier or on two that a joint connects, of pairs that the cell allows, and of a wafer and the link that carries it.
    pub(super) fn general_rule(&self, a: usize, b: usize) -> Rule {
        let (first, second) = (&self.items[a], &self.items[b]);
        if !(first.holder.moves() || second.holder.moves()) || self.joined(a, b) {
            return Rule::Free;
        }
        if let (Role::Body(i), Role::Body(j)) = (first.role, second.role) {
            let allowed = &self.cell.allowed_pairs;
            if allowed.contains(&[i, j]) || allowed.contains(&[j, i]) {
                return Rule::Free;
            }
        }
        if first.role == Role::KeepOut || second.role == Role::KeepOut {
            return Rule::Out;
        }
        Rule::Apart(self.cell.clearance)
    }

    /// What is asked during a step of an item that moves and one that stands.
    ///
    /// While a step reaches into a slot, what reaches there has to keep the slots' clearance from the wafers of that station and from all that stands, where that is less than the general one; while it lifts or lowers there, its last link may touch the wafer of that very slot.
    pub(super) fn rule(&self, mover: usize, standing: usize, step: &Step) -> Rule {
        let general = self.general_rule(mover, standing);
        let (Rule::Apart(_), Some(slot), Some(id)) = (general, step.slot, acting(step)) else {
            return general;
        };
        let [inside, other] = [mover, standing].map(|item| self.items[item].holder);
        if inside != Holder::Effector(id) && !carries(inside, id) {
            return general;
        }
        let nearer = self.cell.slot_clearance.min(self.cell.clearance);
        match other {
            Holder::Slot(there) if there == slot => {
                let handing = matches!(step.phase, Phase::Lift | Phase::Lower);
                if handing { Rule::Free } else { Rule::Slots(nearer) }
            }
            Holder::Slot(there) if there.station == slot.station => {
                Rule::Slots(self.cell.slot_clearance)
            }
            _ => Rule::Apart(nearer),
        }
    }

    fn last_link(&self, arm: usize) -> usize {
        self.cell.robot.arms[arm].joints.len() - 1
    }

    /// Whether two items are on one carrier, or on two that a joint connects, or one carries the other.
    fn joined(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.items[a].holder, self.items[b].holder);
        let linked = |x: Holder, y: Holder| match (x, y) {
            (Holder::Platform, Holder::Link { link: 0, .. }) => true,
            (Holder::Platform, Holder::Tip(id)) => self.last_link(id.arm) == 0,
            (Holder::Link { arm, link }, Holder::Link { arm: other, link: next }) => {
                arm == other && link + 1 == next
            }
            (Holder::Link { arm, link }, Holder::Tip(id)) => {
                arm == id.arm && link + 1 == self.last_link(arm)
            }
            (Holder::Tip(one), Holder::Tip(other)) => one.arm == other.arm,
            (link, Holder::Effector(id)) => carries(link, id),
            _ => false,
        };
        a == b || linked(a, b) || linked(b, a)
    }
}

/// Whether a carrier is the link that an effector's wafer is on.
fn carries(link: Holder, id: EffectorId) -> bool {
    matches!(link, Holder::Tip(tip) if tip.arm == id.arm)
}
