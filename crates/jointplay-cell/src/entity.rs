//! Identity of the things that results refer to.

use crate::robot::EffectorId;
use crate::station::SlotId;
use crate::workcell::Cell;

/// Thing in a cell that a violation, a minimum distance or a contact refers to; indices are those of the cell and of its robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EntityId {
    /// Axis of the robot.
    Axis(usize),
    /// End effector.
    Effector(EffectorId),
    /// Link of an arm.
    Link {
        /// Index of the arm.
        arm: usize,
        /// Index of the link in the arm.
        link: usize,
    },
    /// Body of the cell.
    Body(usize),
    /// Wafer that is in this slot at the start, wherever it is later.
    Wafer(SlotId),
    /// Wafer that this effector holds at the start, wherever it is later.
    HeldWafer(EffectorId),
    /// Zone of the cell.
    Zone(usize),
    /// Station of the cell.
    Station(usize),
}

impl EntityId {
    /// Whether this is a wafer.
    #[must_use]
    pub fn is_wafer(self) -> bool {
        matches!(self, Self::Wafer(_) | Self::HeldWafer(_))
    }

    /// The word for the kind of this entity.
    fn kind(self) -> &'static str {
        match self {
            Self::Axis(_) => "axis",
            Self::Effector(_) => "effector",
            Self::Link { .. } => "link",
            Self::Body(_) => "body",
            Self::Wafer(_) | Self::HeldWafer(_) => "wafer",
            Self::Zone(_) => "zone",
            Self::Station(_) => "station",
        }
    }
}

impl Cell {
    /// Name of an entity, as in reports, exports and pictures: a wafer is named by its slot or effector at the start.
    ///
    /// # Panics
    /// If the cell has no such entity.
    #[must_use]
    pub fn entity_name(&self, entity: EntityId) -> String {
        match entity {
            EntityId::Axis(axis) => self.robot.axes[axis].name.clone(),
            EntityId::Effector(id) => self.effector_name(id).to_owned(),
            EntityId::Link { arm, link } => {
                format!("{} link {}", self.robot.arms[arm].name, link + 1)
            }
            EntityId::Body(body) => self.bodies[body].name.clone(),
            EntityId::Wafer(SlotId { station, slot }) => {
                format!("wafer of {} {slot}", self.stations[station].name)
            }
            EntityId::HeldWafer(id) => format!("wafer of {}", self.effector_name(id)),
            EntityId::Zone(zone) => self.zones[zone].name.clone(),
            EntityId::Station(station) => self.stations[station].name.clone(),
        }
    }

    /// Name of an entity, preceded by its kind if an axis, effector, body, zone or station of another kind has the same name.
    ///
    /// # Panics
    /// If the cell has no such entity.
    #[must_use]
    pub fn entity_label(&self, entity: EntityId) -> String {
        let name = self.entity_name(entity);
        let kind = entity.kind();
        let kinds_with_name = [
            ("axis", self.robot.axes.iter().any(|axis| axis.name == name)),
            ("effector", self.robot.effectors().any(|id| self.effector_name(id) == name)),
            ("body", self.bodies.iter().any(|body| body.name == name)),
            ("zone", self.zones.iter().any(|zone| zone.name == name)),
            ("station", self.stations.iter().any(|station| station.name == name)),
        ];
        let is_shared = kinds_with_name.iter().any(|&(other, has)| has && other != kind);
        if is_shared { format!("{kind} {name}") } else { name }
    }

    /// Name of an effector.
    ///
    /// # Panics
    /// If the robot has no such effector.
    #[must_use]
    pub fn effector_name(&self, id: EffectorId) -> &str {
        &self.robot.arms[id.arm].effectors[id.effector].name
    }
}
