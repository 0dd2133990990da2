//! Entities of a cell, by kind and name.

use jointplay_cell::EntityId;
use jointplay_cell::workcell::Cell;
use serde::Serialize;

/// Kind of an entity of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum EntityKind {
    /// Axis of the robot.
    Axis,
    /// End effector.
    Effector,
    /// Link of an arm.
    Link,
    /// Collision body.
    Body,
    /// Wafer, named by its location at the start.
    Wafer,
    /// Zone.
    Zone,
    /// Station.
    Station,
}

/// An entity of a cell; names are unique within one kind only.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct EntityReport {
    /// Kind.
    pub kind: EntityKind,
    /// Name among the entities of this kind.
    pub name: String,
}

impl EntityReport {
    /// An entity of a cell.
    ///
    /// # Panics
    /// If the cell has no such entity.
    #[must_use]
    pub fn new(cell: &Cell, entity: EntityId) -> Self {
        let kind = match entity {
            EntityId::Axis(_) => EntityKind::Axis,
            EntityId::Effector(_) => EntityKind::Effector,
            EntityId::Link { .. } => EntityKind::Link,
            EntityId::Body(_) => EntityKind::Body,
            EntityId::Wafer(_) | EntityId::HeldWafer(_) => EntityKind::Wafer,
            EntityId::Zone(_) => EntityKind::Zone,
            EntityId::Station(_) => EntityKind::Station,
        };
        Self { kind, name: cell.entity_name(entity) }
    }
}
