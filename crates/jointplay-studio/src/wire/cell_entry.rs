//! Documents of requests to add, duplicate and remove entries of a cell file.

use jointplay::format::cell::{EntryList, NewEntry};
use jointplay::nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::Triple;
use crate::problem::Problem;

/// A change of the entries of a cell file.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EntryRequest {
    /// Text of the cell; default: that of the file.
    #[serde(default)]
    pub(crate) cell: Option<String>,
    /// What is done.
    pub(crate) action: EntryAction,
    /// The list of the entry.
    pub(crate) list: EntryListName,
    /// Name of the duplicated or removed entry.
    #[serde(default)]
    pub(crate) name: Option<String>,
    /// Position of an added station or body in the base frame, of a station at least 0.3 m from the robot's axis (m); default: the origin. An arm is mounted above the others.
    #[serde(default)]
    pub(crate) position_m: Option<Triple>,
    /// Name of the arm of an added effector, which is 10 mm above the highest one of this arm.
    #[serde(default)]
    pub(crate) arm: Option<String>,
    /// Heading of an added station (rad).
    #[serde(default)]
    #[schema(required = false, default = 0.0, minimum = -1000, maximum = 1000)]
    pub(crate) heading_rad: f64,
}

/// A change of the entries of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum EntryAction {
    /// An entry with assumed dimensions is added.
    Add,
    /// An entry is duplicated, with everything attached to it.
    Duplicate,
    /// An entry is removed, with everything attached to it.
    Remove,
}

/// A list of a cell file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum EntryListName {
    /// Stations.
    Station,
    /// Bodies.
    Body,
    /// Arms of the robot.
    Arm,
    /// Effectors of all arms.
    Effector,
}

/// Text of a cell file with changed entries.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(crate) struct EntryDocument {
    /// Text of the cell file.
    pub(crate) cell: String,
    /// Name of the new entry; `null` after a removal.
    #[schema(required = true)]
    pub(crate) name: Option<String>,
}

impl EntryRequest {
    pub(crate) fn entry_list(&self) -> EntryList {
        match self.list {
            EntryListName::Station => EntryList::Station,
            EntryListName::Body => EntryList::Body,
            EntryListName::Arm => EntryList::Arm,
            EntryListName::Effector => EntryList::Effector,
        }
    }

    /// Name of the entry of an action that needs one.
    pub(crate) fn required_name(&self) -> Result<&str, Problem> {
        self.name.as_deref().ok_or_else(|| Problem::field("name", "this action needs a name"))
    }

    /// The entry to add.
    pub(crate) fn new_entry(&self) -> Result<NewEntry, Problem> {
        let Triple(position) = self.position_m.unwrap_or(Triple([0.0; 3]));
        for (k, &value) in position.iter().enumerate() {
            super::length(value, &format!("position_m[{k}]"))?;
        }
        let position = Vector3::from(position);
        let heading = super::angle(self.heading_rad, "heading_rad")?;
        Ok(match self.list {
            EntryListName::Station => NewEntry::Station { position, heading },
            EntryListName::Body => NewEntry::Body { position },
            EntryListName::Arm => NewEntry::Arm,
            EntryListName::Effector => {
                let arm = self.arm.clone();
                let arm = arm.ok_or_else(|| Problem::field("arm", "an effector needs an arm"))?;
                NewEntry::Effector { arm }
            }
        })
    }
}
