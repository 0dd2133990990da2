//! Bodies and zones of a cell file.

use std::collections::BTreeMap;

use crate::display_units::DisplayUnits;
use jointplay_cell::geometry::{AxisAlignedBox, Shape, box_with_openings};
use jointplay_cell::workcell::{Body, ParentFrame, Zone, ZoneRule};
use jointplay_cell::{CellError, MAX_BODIES};

use super::explain::explain;
use super::files::Files;
use super::frames::{Parents, Placement, names_of};
use super::mesh;
use super::pose::points;
use super::problem::Fault;
use super::tree::{AllowedRange, Entry, Table};
use super::unique::unique;
use crate::file_problem::FileProblem;
use crate::units::m_from_mm;

/// All bodies.
pub(super) fn bodies(top: &Table, parents: &Parents, files: &mut Files) -> Vec<Body> {
    let mut names = BTreeMap::new();
    let mut bodies = Vec::new();
    for mut table in few(top, "body") {
        let name = table.name("name");
        if let Some(name) = &name {
            table.whose = format!("the body {name:?}");
            unique(&table, "body", name, &mut names);
        }
        let placement = parents.placement(&table);
        let shape = shape(&table, files);
        table.finish();
        let (Some(name), Some(placement), Some(shape)) = (name, placement, shape) else { continue };
        let Placement { parent, parent_from_frame, station } = placement;
        bodies.push(Body { name, parent, parent_from_shape: parent_from_frame, shape, station });
    }
    bodies
}

/// All zones.
pub(super) fn zones(top: &Table, parents: &Parents, files: &mut Files) -> Vec<Zone> {
    let mut names = BTreeMap::new();
    let mut zones = Vec::new();
    for mut table in few(top, "zone") {
        let name = table.name("name");
        if let Some(name) = &name {
            table.whose = format!("the zone {name:?}");
            unique(&table, "zone", name, &mut names);
        }
        let known = [("keep-out", ZoneRule::KeepOut), ("safe", ZoneRule::Safe)];
        let rule = table.needed("rule").and_then(|rule| rule.word(table.reader, "rule", &known));
        let placement = parents.placement(&table);
        let shape = shape(&table, files);
        table.finish();
        let (Some(name), Some(rule), Some(shape)) = (name, rule, shape) else { continue };
        let Some(placement) = placement else { continue };
        if placement.parent != ParentFrame::World {
            let why = "a zone is fixed: `on` has to be \"world\", a station, or a fixed frame";
            table.report_at("on", Fault::Unfit(why.to_owned()));
            continue;
        }
        let base_from_shape = placement.parent_from_frame;
        if rule == ZoneRule::Safe && matches!(shape, Shape::Boxes { .. }) {
            let why = "a safe zone has no openings: describe what it excludes by a keep-out zone";
            table.report_at("box", Fault::Unfit(why.to_owned()));
            continue;
        }
        zones.push(Zone { name, rule, base_from_shape, shape });
    }
    zones
}

fn few<'r, 'a>(top: &Table<'r, 'a>, key: &'static str) -> Vec<Table<'r, 'a>> {
    let mut tables = top.tables(key);
    if tables.len() > MAX_BODIES {
        let (found, needed) = (tables.len(), format!("at most {MAX_BODIES}"));
        tables[MAX_BODIES].report(FileProblem::Count { key: key.to_owned(), found, needed });
        tables.truncate(MAX_BODIES);
    }
    tables
}

/// Pairs of bodies that may touch each other, by index.
pub(super) fn pairs(top: &Table, bodies: &[Body]) -> Vec<[usize; 2]> {
    let reader = top.reader;
    let Some(entry) = top.entry("may_touch") else { return Vec::new() };
    let names = names_of(top, "body");
    let index = |entry: &Entry| {
        let name = entry.text(reader)?;
        // A body with errors was reported already.
        if !names.iter().any(|known| known == name) {
            entry.unknown(reader, "body", name, &names);
        }
        bodies.iter().position(|known| known.name == name)
    };
    let pair = |pair: Entry| {
        let list = pair.list(reader)?;
        let [one, other] = list.as_slice() else {
            let (key, found, needed) = ("may_touch".to_owned(), list.len(), "2 bodies".to_owned());
            pair.report(reader, FileProblem::Count { key, found, needed });
            return None;
        };
        Some([index(one)?, index(other)?])
    };
    entry.list(reader).unwrap_or_default().into_iter().filter_map(pair).collect()
}

/// Exactly one of the shapes.
fn shape(table: &Table, files: &mut Files) -> Option<Shape> {
    let reader = table.reader;
    let kinds = ["box", "cylinder", "capsule", "convex", "mesh"];
    let found: Vec<Entry> = kinds.into_iter().filter_map(|kind| table.entry(kind)).collect();
    let [entry] = found.as_slice() else {
        table.report(Fault::Unfit(format!(
            "{} needs one shape out of {}; found {}",
            table.whose,
            kinds.map(|kind| format!("`{kind}`")).join(", "),
            match found.len() {
                0 => "none".to_owned(),
                count => count.to_string(),
            }
        )));
        return None;
    };
    let inner = entry.table(reader, format!("a {}", entry.key))?;
    let shape = match entry.key {
        "box" => solid_box(&inner),
        "cylinder" => {
            let radius = inner.length("radius_mm", AllowedRange::Positive);
            let height = inner.length("height_mm", AllowedRange::Positive);
            radius
                .zip(height)
                .map(|(radius, height)| Shape::Cylinder { radius, half_height: height / 2.0 })
        }
        "capsule" => {
            let (from, to) = (inner.point("from_mm"), inner.point("to_mm"));
            let radius = inner.length("radius_mm", AllowedRange::Positive);
            from.zip(to).zip(radius).map(|((from, to), radius)| Shape::Capsule {
                ends: [from.into(), to.into()],
                radius,
            })
        }
        "convex" => inner.needed("points_mm").and_then(|entry| {
            let points = points(&entry, reader)?.into_iter().map(Into::into).collect();
            let hull = Shape::Convex { points };
            if let Err(CellError::FlatHull { .. }) = hull.validate() {
                let why = "a convex body needs at least 4 points that do not lie in one plane";
                entry.report(reader, Fault::Unfit(why.to_owned()));
                return None;
            }
            Some(hull)
        }),
        _ => mesh::shape(&inner, files),
    };
    inner.finish();
    shape
}

/// A box, with its openings removed.
fn solid_box(table: &Table) -> Option<Shape> {
    let reader = table.reader;
    let size = |table: &Table| {
        let size = table.needed("size_mm")?.numbers::<3, _>(reader, AllowedRange::Positive)?;
        Some(size.map(m_from_mm))
    };
    let outer = size(table);
    let Some(listed) = table.entry("openings") else {
        return Some(Shape::Box { half: outer?.map(|side| side / 2.0) });
    };
    let listed = listed.list(reader)?;
    let opening = |entry: &Entry| {
        let opening = entry.table(reader, "an opening")?;
        let center = opening
            .entry("position_mm")
            .map_or(Some([0.0; 3]), |position| position.point(reader).map(<[f64; 3]>::from));
        let size = size(&opening);
        opening.finish();
        Some(centered(center?, size?))
    };
    let openings: Vec<_> = listed.iter().map(opening).collect();
    let openings: Vec<_> = openings.into_iter().collect::<Option<_>>()?;
    let error = match box_with_openings(&centered([0.0; 3], outer?), &openings) {
        Ok(boxes) => return Some(Shape::Boxes { boxes }),
        Err(error) => error,
    };
    if let CellError::OpeningOutside { index } = error {
        let why = format!(
            "opening {} has no common interior with the box: its `position_mm` is that of its centre from the centre of the box",
            index + 1
        );
        listed[index].report(reader, Fault::Unfit(why));
    } else {
        table.report_at("openings", Fault::Unfit(explain(&error, DisplayUnits::Metric)));
    }
    None
}

/// A box by centre and size (m).
fn centered(center: [f64; 3], size: [f64; 3]) -> AxisAlignedBox {
    AxisAlignedBox {
        min: std::array::from_fn(|k| center[k] - size[k] / 2.0),
        max: std::array::from_fn(|k| center[k] + size[k] / 2.0),
    }
}
