//! From text to a cell.

use std::cell::OnceCell;
use std::ops::Range;

use crate::display_units::DisplayUnits;
use jointplay_cell::displacement::Tolerances;
use jointplay_cell::robot::{EffectorId, HybridRobot};
use jointplay_cell::station::{DwellLimits, SlotId, WaferRules};
use jointplay_cell::wafer::{Material, Wafer, check_thin_plate};
use jointplay_cell::workcell::Cell;
use jointplay_cell::{CellError, CellPart, InvalidPart, MAX_COVERAGE_FACTOR};
use toml::de::DeTable;

use super::effectors::{Effectors, effectors, named_effectors};
use super::expansion::{self, Library};
use super::explain::explain;
use super::files::{Files, read_named_file};
use super::frames::Parents;
use super::problem::{Errors, Fault};
use super::rules::visits;
use super::stations::Dwell;
use super::tree::{AllowedRange, Entry, Reader, Table};
use super::{bodies, robot, stations};
use crate::catalogue;
use crate::expression::AngleUnit;
use crate::number::number;
use crate::toml_reader::parameters::{self, Parameters};

/// Longer texts are refused unread.
pub const MAX_BYTES: usize = 1_000_000;

/// Standard gravity (m/s²).
const GRAVITY: f64 = 9.80665;

/// Default of the coverage factor: about 95 % of a normal distribution.
const COVERAGE_FACTOR: f64 = 2.0;

/// Materials by name: Young's modulus in GPa, Poisson's ratio, density in kg/m³.
///
/// Silicon is not isotropic; these are the means over the directions of a (100) wafer's plane.
///
/// # Source
/// \[Hopcroft\] for silicon
const MATERIALS: [(&str, [f64; 3]); 2] =
    [("silicon", [148.0, 0.18, 2329.0]), ("glass", [73.0, 0.23, 2480.0])];

/// Reads a cell file and the files that it names.
///
/// # Arguments
/// * `files` – returns the bytes of a file that the cell names, by a path within the cell's folder, or the reason why it cannot be read; not called for robots of the catalogue
///
/// # Errors
/// All errors with their places: malformed TOML; missing or unknown keys; values of another type; unknown names; files that cannot be read; values that contradict each other.
pub fn read(text: &str, files: &mut Files) -> Result<Cell, Errors> {
    read_with(text, &[], files)
}

/// Reads a cell file with other values for some of its parameters, for example for a sweep.
///
/// # Arguments
/// * `replaced` – names of parameters of the file, and their values in the units of the file
/// * `files` – as for [`read`]
///
/// # Errors
/// As [`read`]; a name that is no parameter of the file is an error at its start.
pub fn read_with(
    text: &str,
    replaced: &[(String, f64)],
    files: &mut Files,
) -> Result<Cell, Errors> {
    whole(text, replaced, files, |_, _| ()).map(|(cell, ())| cell)
}

/// The text of a cell file without parameters, templates, patterns and parts: [`read`] returns the same cell for both.
///
/// Comments are not included.
///
/// # Arguments
/// * `replaced`, `files` – as for [`read_with`]
///
/// # Errors
/// As [`read_with`].
pub fn expand(text: &str, replaced: &[(String, f64)], files: &mut Files) -> Result<String, Errors> {
    whole(text, replaced, files, expansion::print).map(|(_, text)| text)
}

/// Names of the parameters of a cell file, in its order; none of a text that is no TOML.
#[must_use]
pub fn parameter_names(text: &str) -> Vec<String> {
    let reader = Reader::new(text);
    if !reader.has_at_most(MAX_BYTES) {
        return Vec::new();
    }
    let document = reader.parse();
    let top = Table::new(&reader, "a cell", document.get_ref(), 0..0);
    parameters::resolve(&top, &[], AngleUnit::Degree).order
}

/// The cell, and a result from its expanded document.
fn whole<T>(
    text: &str,
    replaced: &[(String, f64)],
    files: &mut Files,
    result: impl for<'a> FnOnce(&DeTable<'a>, &Reader<'a>) -> T,
) -> Result<(Cell, T), Errors> {
    let library = OnceCell::new();
    let reader = Reader::new(text);
    if !reader.has_at_most(MAX_BYTES) {
        return reader.done(None);
    }
    let document = reader.parse();
    let top = Table::new(&reader, "a cell", document.get_ref(), 0..0);
    if top.entry("kind").is_some() && top.has_other_kind("cell") {
        drop(top);
        return reader.done(None);
    }
    let Parameters { scope, .. } = parameters::resolve(&top, replaced, AngleUnit::Degree);
    reader.set_scope(0, scope);
    let library = library.get_or_init(|| Library::load(document.get_ref(), files));
    let expanded = expansion::expand(&reader, document.get_ref(), library);
    let top = Table::new(&reader, "a cell", &expanded, 0..0);
    let cell = contents(&top, files);
    top.finish();
    // Values that can be read one by one may still be invalid together.
    if reader.is_clean()
        && let Some(Err(invalid)) = cell.as_ref().map(Cell::validate)
    {
        for InvalidPart { part, error } in invalid {
            reader.report(span_of(&top, part), Fault::Unfit(explain(&error, DisplayUnits::Metric)));
        }
    }
    let result = reader.is_clean().then(|| result(&expanded, &reader));
    drop(top);
    reader.done(cell.zip(result))
}

/// Location of a part of a cell.
fn span_of(top: &Table, part: CellPart) -> Range<usize> {
    let nth = |key, index| top.tables(key).get(index).map(|table: &Table| table.span.clone());
    let entry = |key| top.entry(key).map(|entry| entry.span());
    let found = match part {
        CellPart::Cell => entry("budgets"),
        CellPart::Robot(_) => entry("robot"),
        CellPart::Wafer => entry("wafer"),
        CellPart::Station(index) => nth("station", index),
        CellPart::Body(index) => nth("body", index),
        CellPart::Zone(index) => nth("zone", index),
        CellPart::AllowedPair(_) => entry("may_touch"),
        CellPart::Occupied(_) => entry("station"),
        CellPart::LoadedEffector(_) => entry("carried"),
        CellPart::Rules => entry("rule"),
    };
    found.unwrap_or(0..0)
}

fn contents(top: &Table, files: &mut Files) -> Option<Cell> {
    let reader = top.reader;
    let kind = top.needed("kind").and_then(|kind| kind.word(reader, "kind", &[("cell", ())]));
    let name = top.needed("name").and_then(|name| name.line(reader)).map(str::to_owned);
    let robot = top.needed("robot").and_then(|name| read_robot(&name, reader, files));
    let assumed = lines(top, "assumed");
    let wafer = top.table("wafer", "`[wafer]`").map_or_else(
        || {
            top.missing("wafer");
            None
        },
        |table| wafer(&table),
    );
    let effectors = robot.as_ref().map(effectors);
    let budgets = top.table("budgets", "`[budgets]`").map_or_else(
        || {
            top.missing("budgets");
            None
        },
        |table| budgets(&table),
    );
    let tolerances = top
        .table("tolerances", "`[tolerances]`")
        .map_or_else(Tolerances::default, |table| tolerances(&table));
    let bare = bare(robot.as_ref(), wafer.as_ref(), budgets);
    let read = stations::read(top, (robot.as_ref(), bare.as_ref()), effectors.as_ref());
    let dwell = read.iter().enumerate().filter_map(|(station, read)| {
        read.dwell.map(|Dwell { min, max }| DwellLimits { station, min, max })
    });
    let dwell = dwell.collect();
    let (stations, occupied): (Vec<_>, Vec<Vec<usize>>) =
        read.into_iter().map(|read| (read.station, read.wafers)).unzip();
    let rules = WaferRules { dwell, visits: visits(top, &stations) };
    let parents = Parents::read(top, robot.as_ref(), effectors.as_ref(), &stations);
    let bodies = bodies::bodies(top, &parents, files);
    let allowed_pairs = bodies::pairs(top, &bodies);
    let zones = bodies::zones(top, &parents, files);
    let loaded_effectors = loaded_effectors(top, effectors.as_ref());
    kind?;
    let occupied = occupied
        .into_iter()
        .enumerate()
        .flat_map(|(station, slots)| slots.into_iter().map(move |slot| SlotId { station, slot }));
    Some(Cell {
        name: name?,
        assumed,
        occupied: occupied.collect(),
        stations,
        loaded_effectors,
        bodies,
        allowed_pairs,
        zones,
        rules,
        tolerances,
        ..bare?
    })
}

/// A cell with robot, wafer and budgets only.
fn bare(
    robot: Option<&HybridRobot>,
    wafer: Option<&Wafer>,
    budgets: Option<Budgets>,
) -> Option<Cell> {
    let Budgets {
        play_budget,
        clearance,
        slot_clearance,
        plane_threshold,
        coverage_factor,
        gravity,
    } = budgets?;
    Some(Cell {
        name: String::new(),
        assumed: Vec::new(),
        robot: robot?.clone(),
        wafer: wafer?.clone(),
        stations: Vec::new(),
        occupied: Vec::new(),
        loaded_effectors: Vec::new(),
        bodies: Vec::new(),
        allowed_pairs: Vec::new(),
        zones: Vec::new(),
        rules: WaferRules::default(),
        play_budget,
        clearance,
        slot_clearance,
        plane_threshold,
        coverage_factor,
        gravity,
        tolerances: Tolerances::default(),
    })
}

fn loaded_effectors(top: &Table, effectors: Option<&Effectors>) -> Vec<EffectorId> {
    let (Some(entry), Some(known)) = (top.entry("carried"), effectors) else { return Vec::new() };
    named_effectors(&entry, top.reader, known)
}

fn lines(top: &Table, key: &'static str) -> Vec<String> {
    let Some(entry) = top.entry(key) else { return Vec::new() };
    let list = entry.list(top.reader).unwrap_or_default();
    list.into_iter().filter_map(|line| line.line(top.reader)).map(str::to_owned).collect()
}

/// The robot of a cell file that may have errors elsewhere; `None` where it cannot be read itself.
pub(super) fn robot_of(text: &str, files: &mut Files) -> Option<HybridRobot> {
    let reader = Reader::new(text);
    if !reader.has_at_most(MAX_BYTES) {
        return None;
    }
    let document = reader.parse();
    let top = Table::new(&reader, "a cell", document.get_ref(), 0..0);
    let Parameters { scope, .. } = parameters::resolve(&top, &[], AngleUnit::Degree);
    reader.set_scope(0, scope);
    read_robot(&top.entry("robot")?, &reader, files)
}

/// A robot by name or as a table.
fn read_robot<'r, 'a>(
    named: &Entry<'r, 'a>,
    reader: &'r Reader<'a>,
    files: &mut Files,
) -> Option<HybridRobot> {
    if named.value.get_ref().is_table() {
        return robot::from_table(&named.table(reader, "the robot")?);
    }
    let name = named.line(reader)?;
    let cannot = |why: String| {
        named.report(reader, Fault::File { name: name.to_owned(), why });
        None
    };
    let known = || robot::names().map(str::to_owned).collect::<Vec<_>>();
    let text = match catalogue::find(name) {
        Some(entry) if entry.kind().as_deref() == Some(robot::KIND) => entry.text.to_owned(),
        Some(_) => {
            let names = known().join(", ");
            let why = format!("{name:?} is a mechanism without arms; robots with arms: {names}");
            named.report(reader, Fault::Unfit(why));
            return None;
        }
        None if !name.ends_with(".toml") => {
            let mut known = known();
            known.push("or a file ….toml".to_owned());
            named.unknown(reader, "robot with arms", name, &known);
            return None;
        }
        None => match read_named_file(name, files).map(String::from_utf8) {
            Ok(Ok(text)) => text,
            Ok(Err(_)) => return cannot("it is not text in UTF-8".to_owned()),
            Err(why) => return cannot(why),
        },
    };
    match robot::parse(&text) {
        Ok(robot) => Some(robot),
        Err(problems) => {
            let mut problems = problems.into_iter();
            if let Some(inner) = problems.next() {
                let (inner, others) = (Box::new(inner), problems.collect());
                named.report(reader, Fault::Within { name: name.to_owned(), inner, others });
            }
            None
        }
    }
}

fn wafer(table: &Table) -> Option<Wafer> {
    let reader = table.reader;
    let diameter = table.length("diameter_mm", AllowedRange::Positive);
    let thickness = table.length("thickness_mm", AllowedRange::Positive);
    let material = table.needed("material").and_then(|entry| {
        if entry.is_text() {
            let known = MATERIALS.map(|(name, values)| (name, (name, values)));
            let (name, values) = entry.word(reader, "material", &known)?;
            return Some(material(name, values));
        }
        let table = entry.table(reader, "a material")?;
        let name = table.needed("name").and_then(|name| name.line(reader));
        let young = table.number("young_gpa", AllowedRange::Positive);
        let poisson = table.number("poisson", AllowedRange::Within(-0.99, 0.49));
        let density = table.number("density_kg_m3", AllowedRange::Positive);
        table.finish();
        Some(material(name?, [young?, poisson?, density?]))
    });
    table.finish();
    let (diameter, thickness) = (diameter?, thickness?);
    if let Err(CellError::NotThin { .. }) = check_thin_plate(thickness, diameter) {
        let why = format!(
            "a wafer {} mm thick and {} mm wide is too thick: its thickness may be a tenth of its diameter at most",
            number(crate::units::mm(thickness)),
            number(crate::units::mm(diameter))
        );
        table.report_at("thickness_mm", Fault::Unfit(why));
    }
    Some(Wafer { diameter, thickness, material: material? })
}

fn material(name: &str, [young, poisson, density]: [f64; 3]) -> Material {
    let young = crate::units::shift(young, 9);
    Material { name: name.to_owned(), young, poisson, density }
}

/// Tolerances, each to either side.
fn tolerances(table: &Table) -> Tolerances {
    let scaled = |key, exponent| {
        let value = table.entry(key)?.number(table.reader, AllowedRange::NotNegative)?;
        Some(crate::units::shift(value, exponent))
    };
    let found = Tolerances {
        guide: scaled("guide_um", -6),
        socket: scaled("socket_um", -6),
        rod_zero: scaled("rod_zero_um", -6),
        mount: scaled("mount_um", -6),
        link: scaled("link_um", -6),
        joint_zero: scaled("joint_zero_urad", -6),
        linear_resolution: scaled("linear_resolution_um", -6),
        rotary_resolution: scaled("rotary_resolution_urad", -6),
        droop_share: scaled("droop_percent", -2),
        sag_share: scaled("sag_percent", -2),
    };
    table.finish();
    found
}

/// Budgets of a cell, as in [`Cell`].
#[derive(Clone, Copy)]
struct Budgets {
    play_budget: f64,
    clearance: f64,
    slot_clearance: f64,
    plane_threshold: f64,
    coverage_factor: f64,
    gravity: f64,
}

fn budgets(table: &Table) -> Option<Budgets> {
    let micro = |key, span| table.number(key, span).map(|value| crate::units::shift(value, -6));
    let play = micro("virtual_joint_norm_um", AllowedRange::Positive);
    let clearance = table.length("min_distance_mm", AllowedRange::NotNegative);
    let slot_clearance = table.length("slot_min_distance_mm", AllowedRange::NotNegative);
    let plane = micro("plane_urad", AllowedRange::Positive);
    let gravity = table.number_or("gravity_m_s2", AllowedRange::NotNegative, GRAVITY);
    let range = AllowedRange::Within(0.0, MAX_COVERAGE_FACTOR);
    let coverage_factor = table.number_or("coverage_factor", range, COVERAGE_FACTOR);
    table.finish();
    Some(Budgets {
        play_budget: play?,
        clearance: clearance?,
        slot_clearance: slot_clearance?,
        plane_threshold: plane?,
        coverage_factor,
        gravity,
    })
}
