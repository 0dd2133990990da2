//! Studies of mechanisms with loops.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use jointplay_core::mechanism::joint::Coordinate;
use jointplay_core::mechanism::{FrameId, Mechanism};
use jointplay_study::plan::{
    MechanismOf, MechanismPlan, MechanismQuantity, Study as _, VariedDrive, VariedParameter,
};

use super::Problem;
use super::fact::{self, Fact};
use super::file::StudyFile;
use super::names::{Column, Source};
use super::quantity::{ANGLES, Asked, Group, LENGTHS, NUMBERS, Term, quantities};
use super::sources::{Sources, text_of};
use super::spread::{self, Allowed, GridSize, in_order};
use super::tree::{Entry, Table, count, report_twice};
use crate::coordinates::Coordinates;
use crate::mechanism::{self, AngleUnit, LengthUnit, MechanismFile, Units};
use crate::units::Unit;

/// Reads a study of a mechanism.
pub(super) fn read(
    top: &Table,
    entry: &Entry,
    name: Option<String>,
    text: &str,
    sources: &mut Sources,
) -> Option<StudyFile> {
    let reader = top.reader;
    if let Some(robot) = top.entry("robot") {
        let message = "a study has either `robot` or `mechanism`".to_owned();
        robot.report(reader, Problem::Mechanism { message });
    }
    let subject = read_mechanism(top, entry, sources);
    let draws = count(top, "samples", 1);
    let seed = count(top, "seed", 0);
    let tables = [("drives", "`[drives]`"), ("parameters", "`[parameters]`")]
        .map(|(key, whose)| top.entry(key).map(|entry| entry.table(reader, whose)));
    // Names are known from the mechanism only; without it, quantities are not read, but are no unknown key either.
    let _ = top.entry("quantities");
    let (file, mechanism_text) = subject?;
    let [drives, parameters] = tables;
    let coordinates = Coordinates::of(&file);
    let drives = match drives {
        Some(table) => drives_of(&table?, &file.mechanism, &coordinates),
        None => Some(Vec::new()),
    };
    let parameters = match parameters {
        Some(table) => parameters_of(&table?, &file),
        None => Some(Vec::new()),
    };
    let driven: Vec<usize> = drives.iter().flatten().map(|drive| drive.coordinate).collect();
    let quantities = quantities(top, &terms(&file, &coordinates), &groups(&file, &driven));
    let (drives, parameters) = (drives?, parameters?);
    let (draws, seed) = (draws?, seed?);
    let names: Vec<String> =
        parameters.iter().map(|one| file.parameters[one.number].0.clone()).collect();
    let mut plan = MechanismPlan {
        design: file.mechanism.clone(),
        mechanism_of: mechanism_of(mechanism_text.clone(), names.clone()),
        parameters,
        drives,
        draws: draws.unwrap_or(1),
        seed: seed.unwrap_or(0),
        wanted: Vec::new(),
    };
    let span = ["samples", "drives", "parameters", "mechanism"];
    let span = span.into_iter().find_map(|key| top.entry(key)).map_or(0..0, |entry| entry.span());
    let is_dimension = plan.parameters.iter().any(|one| one.values.is_random());
    let random = if is_dimension { "parameters" } else { "drives" };
    let random = plan.draws_anything().then_some(random);
    if !spread::has_draws(top, draws, random, span.clone()) {
        return None;
    }
    let columns = columns(&mut plan, &quantities?, &names, &file, &coordinates);
    if let Some(name) = repeated(&columns) {
        top.report_at("mechanism", Problem::SameColumn { name: name.to_owned() });
        return None;
    }
    plan.samples().map_err(|error| reader.report(span.clone(), Problem::Plan(error))).ok()?;
    plan.check().map_err(|error| top.report_at("mechanism", Problem::Plan(error))).ok()?;
    Some(StudyFile {
        name: name?,
        text: text.to_owned(),
        mechanism: file.mechanism.name().to_owned(),
        facts: facts(&plan, (file.units, &coordinates), &mechanism_text, &names, &columns),
        files: BTreeMap::new(),
        plan: Arc::new(plan),
        columns,
    })
}

fn read_mechanism(
    top: &Table,
    entry: &Entry,
    sources: &mut Sources,
) -> Option<(MechanismFile, String)> {
    let name = entry.text(top.reader)?;
    let report = |problem: Problem| top.report_at("mechanism", problem);
    let text =
        text_of(name, sources).map_err(|message| report(Problem::Mechanism { message })).ok()?;
    if let Some(kind) = mechanism::kind_of(&text).filter(|kind| kind != "mechanism") {
        let message = match kind.as_str() {
            "gpr" => format!("{name:?} is a three-rod robot: write `robot = {name:?}`"),
            _ => format!(
                "{name:?} is of the kind {kind:?}, but `mechanism` names files of the kind \"mechanism\""
            ),
        };
        report(Problem::Mechanism { message });
        return None;
    }
    let invalid = |errors| report(Problem::MechanismFile { name: name.to_owned(), errors });
    let file = mechanism::parse(&text).map_err(invalid).ok()?;
    Some((file, text))
}

/// Makes the mechanism of a file with other values of some parameters.
fn mechanism_of(text: String, names: Vec<String>) -> MechanismOf {
    Arc::new(move |values| {
        let replaced: Vec<(String, f64)> =
            names.iter().cloned().zip(values.iter().copied()).collect();
        mechanism::parse_with(&text, &replaced).ok().map(|file| file.mechanism)
    })
}

fn drives_of(
    table: &Table,
    mechanism: &Mechanism,
    coordinates: &Coordinates,
) -> Option<Vec<VariedDrive>> {
    let reader = table.reader;
    let mut drives: Vec<VariedDrive> = Vec::new();
    let mut are_valid = true;
    let mut size = GridSize::new();
    for (entry, span) in in_order(table) {
        let found = coordinates.find(mechanism, entry.key);
        let drive = found.map_err(|error| reader.report(span, Problem::Coordinate(error))).ok();
        let drive = drive.and_then(|coordinate| {
            if drives.iter().any(|one| one.coordinate == coordinate) {
                report_twice(&entry, reader, entry.key);
                return None;
            }
            let most = coordinates.largest(coordinate);
            let to_si = |value| coordinates.to_si(coordinate, value);
            let allowed = Allowed { bounds: (-most, most), to_si: &to_si };
            let values = spread::read(reader, &allowed, &entry)?;
            Some(VariedDrive { coordinate, values })
        });
        are_valid &= drive.is_some();
        let is_counted = drive.as_ref().is_none_or(|drive| size.add(&drive.values));
        drives.extend(drive);
        if !is_counted {
            break;
        }
    }
    are_valid.then_some(drives)
}

fn parameters_of(table: &Table, file: &MechanismFile) -> Option<Vec<VariedParameter>> {
    let known: Vec<&str> = file.parameters.iter().map(|(name, _)| name.as_str()).collect();
    let found = spread::parameters(table, &known)?;
    Some(found.into_iter().map(|(number, values)| VariedParameter { number, values }).collect())
}

/// All that can be asked for of a mechanism.
fn terms(file: &MechanismFile, coordinates: &Coordinates) -> Vec<Term<MechanismQuantity>> {
    let mechanism = &file.mechanism;
    let mut terms = Vec::new();
    let mut add = |stem: String, units, wanted| terms.push(Term { stem, units, wanted });
    for (k, named) in coordinates.all().iter().enumerate() {
        let units = match named.quantity {
            Coordinate::Slide => LENGTHS,
            Coordinate::Turn => ANGLES,
        };
        add(named.name.clone(), units, MechanismQuantity::Coordinate(k));
    }
    let frames: Vec<(FrameId, &str)> =
        mechanism.moving_frames().map(|frame| (frame, mechanism.frame_name(frame))).collect();
    for &(frame, name) in &frames {
        for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
            let wanted = MechanismQuantity::Origin(frame, axis);
            add(format!("{name}_{letter}"), LENGTHS, wanted);
        }
        for (part, letter) in ["qw", "qx", "qy", "qz"].into_iter().enumerate() {
            let wanted = MechanismQuantity::Quaternion(frame, part);
            add(format!("{name}_{letter}"), NUMBERS, wanted);
        }
        // The frame of a link is that of the base in the reference configuration, whatever the dimensions.
        if matches!(frame, FrameId::Attached(_)) {
            let wanted = MechanismQuantity::PositionError(frame);
            add(format!("{name}_position_error"), LENGTHS, wanted);
            let wanted = MechanismQuantity::OrientationError(frame);
            add(format!("{name}_orientation_error"), ANGLES, wanted);
        }
    }
    let virtual_joints = mechanism.virtual_joints();
    // With stiffness of all, the size of a displacement is no length.
    if virtual_joints.iter().any(|joint| joint.stiffness.is_none()) {
        add("displacement".to_owned(), LENGTHS, MechanismQuantity::Displacement);
    }
    add("mobility".to_owned(), NUMBERS, MechanismQuantity::Mobility);
    add("rank".to_owned(), NUMBERS, MechanismQuantity::Rank);
    add("redundant".to_owned(), NUMBERS, MechanismQuantity::Redundant);
    terms
}

/// Names of several quantities of a mechanism.
fn groups(file: &MechanismFile, driven: &[usize]) -> Vec<Group<MechanismQuantity>> {
    let joints = file.mechanism.joint_freedoms();
    let driven = driven.to_vec();
    let coordinate = |wanted: &MechanismQuantity| match *wanted {
        MechanismQuantity::Coordinate(k) => Some(k),
        _ => None,
    };
    let mut groups = vec![Group {
        name: "joints",
        units: &[],
        has: Box::new(move |wanted| {
            coordinate(wanted).is_some_and(|k| k < joints && !driven.contains(&k))
        }),
    }];
    if !file.mechanism.virtual_joints().is_empty() {
        groups.push(Group {
            name: "virtual_joints",
            units: &[],
            has: Box::new(move |wanted| coordinate(wanted).is_some_and(|k| k >= joints)),
        });
    }
    groups
}

/// The columns of a table: sample, draw, what varies, what is asked for, and the status.
///
/// Puts what is wanted into the plan, in the same order.
fn columns(
    plan: &mut MechanismPlan,
    asked: &[Asked<MechanismQuantity>],
    parameters: &[String],
    file: &MechanismFile,
    coordinates: &Coordinates,
) -> Vec<Column> {
    let mut columns = vec![Column { name: "sample".to_owned(), source: Source::Sample }];
    let parameter = plan.parameters.iter().map(|one| &one.values);
    let mut varied = parameter.chain(plan.drives.iter().map(|one| &one.values));
    if plan.draws_anything() && varied.any(|one| one.values() > 1) {
        columns.push(Column { name: "draw".to_owned(), source: Source::Draw });
    }
    let mut wanted = Vec::new();
    let mut number = |name: String, quantity, unit, typed, repeats| {
        wanted.push(quantity);
        let source = Source::Number { index: wanted.len() - 1, unit, typed, repeats };
        columns.push(Column { name, source });
    };
    for (k, (one, name)) in plan.parameters.iter().zip(parameters).enumerate() {
        let listed = !one.values.is_random();
        number(name.clone(), MechanismQuantity::Parameter(k), Unit::One, true, listed);
    }
    for (k, one) in plan.drives.iter().enumerate() {
        let unit = unit(file.units, coordinates, one.coordinate);
        let name = format!("{}{}", coordinates.all()[one.coordinate].name, unit.suffix());
        number(name, MechanismQuantity::Drive(k), unit, true, !one.values.is_random());
    }
    let terms = terms(file, coordinates);
    let is_commanded = |asked: &Asked<MechanismQuantity>| {
        let of = |one: &VariedDrive| {
            let same = asked.wanted == MechanismQuantity::Coordinate(one.coordinate);
            same && asked.unit == unit(file.units, coordinates, one.coordinate)
        };
        plan.drives.iter().any(of)
    };
    // The column of a commanded coordinate is there already.
    for asked in asked.iter().filter(|asked| !is_commanded(asked)) {
        let term = terms.iter().find(|term| term.wanted == asked.wanted);
        let stem = &term.expect("what is asked for was found among the terms").stem;
        let counts = matches!(
            asked.wanted,
            MechanismQuantity::Mobility | MechanismQuantity::Rank | MechanismQuantity::Redundant
        );
        let name = format!("{stem}{}", asked.unit.suffix());
        number(name, asked.wanted, asked.unit, false, counts);
    }
    columns.push(Column { name: "status".to_owned(), source: Source::Status { model: 0 } });
    plan.wanted = wanted;
    columns
}

/// The name of two columns.
fn repeated(columns: &[Column]) -> Option<&str> {
    let mut known = HashSet::new();
    columns.iter().map(|column| column.name.as_str()).find(|name| !known.insert(*name))
}

/// The unit of a coordinate in a table: that of the file, or mm for inches.
fn unit(units: Units, coordinates: &Coordinates, k: usize) -> Unit {
    match (coordinates.all()[k].quantity, units.length, units.angle) {
        (Coordinate::Slide, LengthUnit::Meter, _) => Unit::Meter,
        (Coordinate::Slide, LengthUnit::Millimeter | LengthUnit::Inch, _) => Unit::Millimeter,
        (Coordinate::Slide, LengthUnit::Micrometer, _) => Unit::Micrometer,
        (Coordinate::Turn, _, AngleUnit::Degree) => Unit::Degree,
        (Coordinate::Turn, _, AngleUnit::Radian) => Unit::Radian,
    }
}

/// Facts that determine the numbers of a study.
fn facts(
    plan: &MechanismPlan,
    (units, coordinates): (Units, &Coordinates),
    mechanism_text: &str,
    parameters: &[String],
    columns: &[Column],
) -> Vec<Fact> {
    let of_parameters = plan.parameters.iter().zip(parameters);
    let of_parameters: Vec<[String; 2]> = of_parameters
        .map(|(one, name)| {
            [fact::exact(&one.values), fact::shown(&one.values, |value| value)]
                .map(|values| format!("{name} {values}"))
        })
        .collect();
    let of_drives = plan.drives.iter().map(|one| {
        let (k, name) = (one.coordinate, &coordinates.all()[one.coordinate].name);
        let unit = unit(units, coordinates, k);
        let shown = fact::shown(&one.values, |value| unit.typed_from_si(value));
        let shown = format!("{name} {shown} {}", unit.code().unwrap_or_default());
        [format!("{k} {}", fact::exact(&one.values)), shown]
    });
    let of_drives: Vec<[String; 2]> = of_drives.collect();
    let columns: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    vec![
        Fact::not_shown("mechanism", mechanism_text.to_owned()),
        joined("parameters", &of_parameters),
        joined("drives", &of_drives),
        Fact::text("samples", plan.draws.to_string()),
        Fact::text("seed", plan.seed.to_string()),
        Fact::text("columns", columns.join(", ")),
    ]
}

/// Varied quantities, exact and for messages.
fn joined(key: &'static str, values: &[[String; 2]]) -> Fact {
    let [exact, shown] = [0, 1].map(|k| {
        let texts: Vec<&str> = values.iter().map(|one| one[k].as_str()).collect();
        if texts.is_empty() { "none".to_owned() } else { texts.join("; ") }
    });
    Fact { key, exact, shown: Some(shown) }
}
