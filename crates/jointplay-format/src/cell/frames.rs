//! Frames to which bodies and zones are attached.

use std::collections::BTreeMap;

use jointplay_cell::robot::{EffectorId, HybridRobot};
use jointplay_cell::station::Station;
use jointplay_cell::station::teach::frame;
use jointplay_cell::workcell::ParentFrame;
use jointplay_core::spatial::{Pose, Tilt};
use nalgebra::{Rotation3, Vector3};

use super::effectors::Effectors;
use super::pose::heading_and_tilt;
use super::tree::{Entry, Table};
use super::unique::unique;

/// A frame of a cell.
#[derive(Clone, Copy)]
pub(super) struct Placement {
    /// The part of the cell with which it moves.
    pub(super) parent: ParentFrame,
    pub(super) parent_from_frame: Pose,
    /// Index of the station in whose frame it is described.
    pub(super) station: Option<usize>,
}

impl Placement {
    fn new(parent: ParentFrame) -> Self {
        Self { parent, parent_from_frame: Pose::identity(), station: None }
    }
}

/// All frames to which a body can be attached.
pub(super) struct Parents<'c> {
    robot: Option<&'c HybridRobot>,
    effectors: Option<&'c Effectors>,
    stations: &'c [Station],
    /// Names of all stations, also of those with errors.
    station_names: Vec<String>,
    frames: BTreeMap<String, Placement>,
    /// Names of all frames, also of those with errors.
    frame_names: Vec<String>,
}

impl<'c> Parents<'c> {
    /// The frames of a cell: those of its robot and stations, and of its `[[frame]]` tables.
    pub(super) fn read(
        top: &Table,
        robot: Option<&'c HybridRobot>,
        effectors: Option<&'c Effectors>,
        stations: &'c [Station],
    ) -> Self {
        let mut parents = Self {
            robot,
            effectors,
            stations,
            station_names: names_of(top, "station"),
            frames: BTreeMap::new(),
            frame_names: Vec::new(),
        };
        let mut names = BTreeMap::new();
        for mut table in top.tables("frame") {
            let name = table.name("name");
            if let Some(name) = &name {
                table.whose = format!("the frame {name:?}");
                unique(&table, "frame", name, &mut names);
            }
            let placement = parents.placement(&table);
            table.finish();
            let Some(name) = name else { continue };
            if let Some(placement) = placement {
                parents.frames.entry(name.clone()).or_insert(placement);
            }
            parents.frame_names.push(name);
        }
        parents
    }

    /// The frame of a table with `on`, `position_mm`, `heading_deg` and `tilt`.
    pub(super) fn placement(&self, table: &Table) -> Option<Placement> {
        let position = table.entry("position_mm").map(|entry| entry.point(table.reader));
        let (heading, tilt) = heading_and_tilt(table);
        let parent = match table.entry("on") {
            Some(on) => self.parent(table, &on)?,
            None => Placement::new(ParentFrame::World),
        };
        let normal = tilt.unwrap_or(Tilt::LEVEL).normal();
        let pose = frame(position.unwrap_or_default().unwrap_or_default(), &normal, heading);
        Some(Placement { parent_from_frame: parent.parent_from_frame * pose, ..parent })
    }

    fn parent(&self, table: &Table, entry: &Entry) -> Option<Placement> {
        let reader = table.reader;
        if entry.is_text() {
            let known = [("world", ParentFrame::World), ("platform", ParentFrame::Platform)];
            return Some(Placement::new(entry.word(reader, "parent", &known)?));
        }
        let on = entry.table(reader, "a parent")?;
        let keys = ["station", "frame", "effector", "arm", "link"].map(|key| on.entry(key));
        on.finish();
        match keys {
            [Some(station), None, None, None, None] => {
                let name = station.text(reader)?;
                let found = self.stations.iter().position(|known| known.name == name);
                // A station with errors was reported already.
                if found.is_none() && !self.station_names.iter().any(|known| known == name) {
                    station.unknown(reader, "station", name, &self.station_names);
                }
                Some(Placement {
                    parent_from_frame: self.stations[found?].base_from_station,
                    station: found,
                    parent: ParentFrame::World,
                })
            }
            [None, Some(named), None, None, None] => {
                let name = named.text(reader)?;
                let found = self.frames.get(name).copied();
                if found.is_none() && !self.frame_names.iter().any(|known| known == name) {
                    named.unknown(reader, "frame", name, &self.frame_names);
                }
                found
            }
            [None, None, Some(effector), None, None] => {
                let (name, known) = (effector.text(reader)?, self.effectors?);
                let Some((_, id)) = known.iter().find(|(known, _)| known == name) else {
                    let names: Vec<String> = known.iter().map(|(name, _)| name.clone()).collect();
                    effector.unknown(reader, "effector", name, &names);
                    return None;
                };
                Some(wafer_frame(self.robot?, *id))
            }
            [None, None, None, Some(arm), Some(link)] => {
                let (name, robot) = (arm.text(reader)?, self.robot?);
                let Some(index) = robot.arms.iter().position(|known| known.name == name) else {
                    let names: Vec<String> =
                        robot.arms.iter().map(|arm| arm.name.clone()).collect();
                    arm.unknown(reader, "arm", name, &names);
                    return None;
                };
                let link = link.count(reader, 1, robot.arms[index].joints.len())? - 1;
                Some(Placement::new(ParentFrame::Link { arm: index, link }))
            }
            _ => {
                let needed = "\"world\", \"platform\", { station = … }, { frame = … }, { effector = … } or { arm = …, link = … }";
                entry.type_error(reader, needed);
                None
            }
        }
    }
}

/// The frame of the wafer on an effector: x along its heading, the origin at the centre of the lower face.
fn wafer_frame(robot: &HybridRobot, id: EffectorId) -> Placement {
    let arm = &robot.arms[id.arm];
    let effector = &arm.effectors[id.effector];
    let heading = Rotation3::from_axis_angle(&Vector3::z_axis(), effector.heading);
    let center = Vector3::from(effector.wafer_center);
    Placement {
        parent_from_frame: Pose::from_parts(center.into(), heading),
        ..Placement::new(ParentFrame::Link { arm: id.arm, link: arm.joints.len() - 1 })
    }
}

/// The names in all tables of a key, including tables with errors.
pub(super) fn names_of(top: &Table, key: &'static str) -> Vec<String> {
    let name_of = |table: Table| Some(table.entry("name")?.value.get_ref().as_str()?.to_owned());
    top.tables(key).into_iter().filter_map(name_of).collect()
}
