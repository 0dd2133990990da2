//! Studies of programs in work cells.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::display_units::DisplayUnits;
use jointplay_cell::program::name_errors;
use jointplay_study::plan::{Portions, Study as _, SweepPlan, SweptValue, Variation};

use super::Problem;
use super::cell_sample::{CellQuantity, Subject, SweptInput, SweptProgram};
use super::fact::{self, Fact};
use super::file::StudyFile;
use super::names::{Column, Source};
use super::quantity::{Asked, Group, LENGTHS, NUMBERS, TIMES, Term, quantities};
use super::sources::{Sources, text_of};
use super::spread::{self, Allowed, GridSize, in_order};
use super::tree::{Entry, Table, count, entries, report_twice};
use crate::file_problem::FileProblem;
use crate::units::{Unit, m_from_mm};
use crate::{cell, program};

/// Name of the included cell and of its program.
const EXAMPLE: &str = "example";
/// Longest displacement of a station (mm).
const LONGEST_MM: f64 = 1e5;
/// Keys of displacements, with the axes of the base frame.
const DISPLACEMENTS: [(&str, &str); 3] = [("dx_mm", "x"), ("dy_mm", "y"), ("dz_mm", "z")];
/// Displacement by which it is tested that a station can be displaced (m), and its tolerance: rounding of decimals.
const TRIAL: (f64, f64) = (1e-3, 1e-12);

/// A varied input, with its column.
struct Varied {
    input: SweptInput,
    values: SweptValue,
    /// Name of its column, without unit.
    name: String,
    unit: Unit,
    /// The table of the study that it is in.
    key: &'static str,
}

/// Reads a study of a cell.
pub(super) fn read(
    top: &Table,
    entry: &Entry,
    name: Option<String>,
    text: &str,
    sources: &mut Sources,
) -> Option<StudyFile> {
    let reader = top.reader;
    for other in ["robot", "mechanism"] {
        if let Some(found) = top.entry(other) {
            let message = format!("a study has either `{other}` or `cell`");
            found.report(reader, Problem::Mechanism { message });
        }
    }
    let draws = count(top, "samples", 1);
    let seed = count(top, "seed", 0);
    let asked = quantities(top, &terms(), &groups());
    let tables = [
        ("stations", "`[stations]`"),
        ("parameters", "`[parameters]`"),
        ("program_parameters", "`[program_parameters]`"),
    ];
    let tables = tables.map(|(key, whose)| top.entry(key).map(|entry| entry.table(reader, whose)));
    let cell_name = entry.text(reader);
    let listed = top.entry("program");
    let (mut subject, cell) = read_cell(top, cell_name?, sources)?;
    let programs = read_programs(top, listed.as_ref(), cell_name?, sources);
    let [stations, parameters, program_parameters] = tables;
    let mut varied = Vec::new();
    let mut are_valid = true;
    let mut add = |found: Option<Vec<Varied>>| {
        are_valid &= found.is_some();
        varied.extend(found.unwrap_or_default());
    };
    let programs = programs.unwrap_or_default();
    if programs.len() > 1 {
        add(Some(vec![program_number(programs.len())]));
    }
    if let Some(table) = parameters {
        add(table.and_then(|table| cell_parameters(&table, &subject.cell)));
    }
    if let Some(table) = stations {
        add(table.and_then(|table| displacements(&table, &subject, &cell)));
    }
    if let Some(table) = program_parameters {
        add(table.and_then(|table| parameters_of_programs(&table, &programs)));
    }
    for program in &programs {
        let errors = name_errors(&cell, &program::parse_recovering(&program.text).0);
        if !errors.is_empty() {
            let explained = errors.iter().map(|error| {
                program::explain(&cell.robot, &program.text, error, DisplayUnits::Metric)
            });
            let errors = lines(explained.map(|error| (error.place.line, error.to_string())));
            let name = program.name.clone();
            top.report_at(program_key(top), Problem::ProgramFile { name, errors });
            are_valid = false;
        }
    }
    let (draws, seed, asked) = (draws?, seed?, asked?);
    let random = varied.iter().find(|one| one.values.values.is_random()).map(|one| one.key);
    let span = top.entry("samples").map_or(entry.span(), |entry| entry.span());
    if !are_valid || programs.is_empty() || !spread::has_draws(top, draws, random, span.clone()) {
        return None;
    }
    let (columns, wanted) = columns(&varied, &asked);
    subject.inputs = varied.iter().map(|one| one.input.clone()).collect();
    subject.quantities = wanted;
    subject.programs = programs;
    let draws = draws.unwrap_or(1);
    let seed = seed.unwrap_or(0);
    let facts = facts(&subject, &varied, draws, seed, &columns);
    let subject = Arc::new(subject);
    let plan = SweepPlan::new(
        varied.into_iter().map(|one| one.values).collect(),
        draws,
        seed,
        subject.quantities.len(),
        "program".to_owned(),
        Portions::SLOWEST,
        Arc::new(move || Subject::function(&subject)),
    );
    plan.samples().map_err(|error| reader.report(span, Problem::Plan(error))).ok()?;
    Some(StudyFile {
        name: name?,
        text: text.to_owned(),
        mechanism: cell.name,
        files: BTreeMap::new(),
        facts,
        plan: Arc::new(plan),
        columns,
    })
}

/// The folder of a name, with its slash.
fn folder_of(name: &str) -> &str {
    name.rfind('/').map_or("", |end| &name[..=end])
}

/// The cell with the files that it names.
fn read_cell(
    top: &Table,
    name: &str,
    sources: &mut Sources,
) -> Option<(Subject, jointplay_cell::workcell::Cell)> {
    let report = |problem: Problem| top.report_at("cell", problem);
    let text = if name == EXAMPLE {
        cell::EXAMPLE.to_owned()
    } else if name.ends_with(".toml") {
        text_of(name, sources).map_err(|message| report(Problem::Mechanism { message })).ok()?
    } else {
        let message = format!(
            "invalid cell {name:?}: `cell` names a file in the folder of the study whose name ends in .toml, or the included cell {EXAMPLE:?}"
        );
        report(Problem::Mechanism { message });
        return None;
    };
    let mut files = BTreeMap::new();
    let found = cell::read(&text, &mut |file| {
        let bytes = sources(&format!("{}{file}", folder_of(name)))?;
        files.insert(file.to_owned(), bytes.clone());
        Ok(bytes)
    });
    let invalid = |errors| report(Problem::CellFile { name: name.to_owned(), errors });
    let found = found.map_err(invalid).ok()?;
    let (programs, inputs, quantities) = (Vec::new(), Vec::new(), Vec::new());
    Some((Subject { cell: text, files, programs, inputs, quantities }, found))
}

/// The programs: those of the file, or the one next to the cell.
fn read_programs(
    top: &Table,
    listed: Option<&Entry>,
    cell: &str,
    sources: &mut Sources,
) -> Option<Vec<SweptProgram>> {
    let reader = top.reader;
    let names: Vec<String> = match listed {
        None if cell == EXAMPLE => vec![EXAMPLE.to_owned()],
        None => vec![format!("{}.program", cell.strip_suffix(".toml").unwrap_or(cell))],
        Some(entry) if entry.is_text() => vec![entry.text(reader)?.to_owned()],
        Some(entry) => {
            let mut names: Vec<String> = Vec::new();
            for one in entries(entry, reader)? {
                let name = one.text(reader)?.to_owned();
                if names.contains(&name) {
                    report_twice(&one, reader, &name);
                    return None;
                }
                names.push(name);
            }
            names
        }
    };
    let report = |problem: Problem| top.report_at(program_key(top), problem);
    let mut programs = Vec::new();
    for name in names {
        let text = if name == EXAMPLE {
            program::EXAMPLE.to_owned()
        } else {
            let message = |message| report(Problem::Mechanism { message });
            text_of(&name, sources).map_err(message).ok()?
        };
        let (_, errors) = program::parse_recovering(&text);
        if !errors.is_empty() {
            let errors = lines(errors.iter().map(|error| (error.place.line, error.to_string())));
            report(Problem::ProgramFile { name, errors });
            return None;
        }
        let parameters = program::parameters(&text);
        programs.push(SweptProgram { name, text, parameters });
    }
    Some(programs)
}

/// The key that names the program: that of the cell where it is next to it.
fn program_key(top: &Table) -> &'static str {
    if top.entry("program").is_some() { "program" } else { "cell" }
}

/// Largest number of errors of a program that a message lists.
const MOST_ERRORS: usize = 5;

/// The first messages with their lines.
fn lines(errors: impl Iterator<Item = (usize, String)>) -> String {
    let all: Vec<String> =
        errors.map(|(line, message)| format!("line {line}: {message}")).collect();
    let left = all.len().saturating_sub(MOST_ERRORS);
    let listed = all[..all.len() - left].join("\n");
    if left == 0 { listed } else { format!("{listed}\nand {left} more errors") }
}

/// The number of the program, of several.
fn program_number(count: usize) -> Varied {
    let values = Variation::Values((1..=count).map(|number| number as f64).collect());
    Varied {
        input: SweptInput::Program,
        values: SweptValue { number: 0, values },
        name: "program".to_owned(),
        unit: Unit::One,
        key: "program",
    }
}

/// First random numbers of the tables of a study, far apart.
const CELL_PARAMETERS: u32 = 1 << 24;
const STATIONS: u32 = 2 << 24;
const PROGRAM_PARAMETERS: u32 = 3 << 24;

/// Parameters of the cell file, in its units.
fn cell_parameters(table: &Table, cell: &str) -> Option<Vec<Varied>> {
    let names = cell::parameter_names(cell);
    let known: Vec<&str> = names.iter().map(String::as_str).collect();
    let found = spread::parameters(table, &known)?.into_iter().map(|(index, values)| Varied {
        input: SweptInput::CellParameter(names[index].clone()),
        values: SweptValue { number: number_of(CELL_PARAMETERS, index), values },
        name: names[index].clone(),
        unit: Unit::One,
        key: "parameters",
    });
    Some(found.collect())
}

/// A random number: texts of at most a megabyte name fewer than 2²⁴ things.
fn number_of(first: u32, index: usize) -> u32 {
    first + u32::try_from(index).unwrap_or(u32::MAX >> 8)
}

/// Parameters that all programs have, in their units.
fn parameters_of_programs(table: &Table, programs: &[SweptProgram]) -> Option<Vec<Varied>> {
    let (first, others) = programs.split_first()?;
    let has = |program: &SweptProgram, name: &str| {
        program.parameters.iter().any(|(known, _)| known == name)
    };
    let names = first.parameters.iter().map(|(name, _)| name.as_str());
    let known: Vec<&str> = names.filter(|name| others.iter().all(|one| has(one, name))).collect();
    let found = spread::parameters(table, &known)?.into_iter().map(|(index, values)| Varied {
        input: SweptInput::ProgramParameter(known[index].to_owned()),
        values: SweptValue { number: number_of(PROGRAM_PARAMETERS, index), values },
        name: known[index].to_owned(),
        unit: Unit::One,
        key: "program_parameters",
    });
    Some(found.collect())
}

/// Displacements of stations.
fn displacements(
    table: &Table,
    subject: &Subject,
    cell: &jointplay_cell::workcell::Cell,
) -> Option<Vec<Varied>> {
    let reader = table.reader;
    let known = || cell.stations.iter().map(|station| station.name.as_str());
    let mut all = Vec::new();
    let mut are_valid = true;
    let mut size = GridSize::new();
    for (entry, span) in in_order(table) {
        let Some(station) = known().position(|name| name == entry.key) else {
            reader.report(span, FileProblem::unknown("station", entry.key, known()));
            are_valid = false;
            continue;
        };
        let displaced = entry.table(reader, "the displacement of a station")?;
        if displaced.entries().next().is_none() {
            entry.report(reader, Problem::Empty { key: entry.key.to_owned() });
            are_valid = false;
        }
        for (axis, (key, letter)) in DISPLACEMENTS.into_iter().enumerate() {
            let Some(value) = displaced.entry(key) else { continue };
            let allowed = Allowed { bounds: (-LONGEST_MM, LONGEST_MM), to_si: &m_from_mm };
            let Some(values) = spread::read(reader, &allowed, &value) else {
                are_valid = false;
                continue;
            };
            if !size.add(&values) {
                // Reported with the number of samples, which these directions exceed already.
                all.push(displacement(entry.key, station, (axis, letter), values));
                return are_valid.then_some(all);
            }
            if let Err(why) = try_displacement(subject, cell, station, axis) {
                let station = entry.key.to_owned();
                value.report(reader, Problem::Station { station, axis: letter, why });
                are_valid = false;
                continue;
            }
            all.push(displacement(entry.key, station, (axis, letter), values));
        }
        displaced.finish();
    }
    are_valid.then_some(all)
}

/// A displacement of a station along an axis with a letter.
fn displacement(
    name: &str,
    station: usize,
    (axis, letter): (usize, &str),
    values: Variation,
) -> Varied {
    Varied {
        input: SweptInput::Displacement { station, axis },
        values: SweptValue { number: number_of(STATIONS, 3 * station + axis), values },
        name: format!("{name}_d{letter}"),
        unit: Unit::Millimeter,
        key: "stations",
    }
}

/// Tests that a changed position in the file displaces the station by as much: it does not where taught points determine the frame.
fn try_displacement(
    subject: &Subject,
    cell: &jointplay_cell::workcell::Cell,
    station: usize,
    axis: usize,
) -> Result<(), String> {
    let (by, tolerance) = TRIAL;
    let text = subject.displaced(cell, &[(station, axis, by)])?;
    let moved = subject.cell(&text, &[]).map_err(|errors| errors.to_string())?;
    let mut expected = cell.stations[station].base_from_station.translation.vector;
    expected[axis] += by;
    let found = moved.stations[station].base_from_station.translation.vector;
    if (found - expected).norm() > tolerance {
        return Err("its frame is determined by taught points or other values; vary parameters of the cell file instead".to_owned());
    }
    Ok(())
}

/// All that can be asked for of a program in a cell.
fn terms() -> Vec<Term<CellQuantity>> {
    let all = [
        ("cycle_time", TIMES, CellQuantity::CycleTime),
        ("wafers_per_hour", NUMBERS, CellQuantity::WafersPerHour),
        ("min_distance", LENGTHS, CellQuantity::MinimumDistance),
        ("velocity", NUMBERS, CellQuantity::Velocity),
        ("acceleration", NUMBERS, CellQuantity::Acceleration),
        ("jerk", NUMBERS, CellQuantity::Jerk),
        ("tilt", NUMBERS, CellQuantity::Tilt),
        ("play", NUMBERS, CellQuantity::Play),
        ("slip", NUMBERS, CellQuantity::Slip),
        ("violations", NUMBERS, CellQuantity::Violations),
    ];
    let term = |(stem, units, wanted): (&str, _, _)| Term { stem: stem.to_owned(), units, wanted };
    all.map(term).into()
}

/// Names of several quantities.
fn groups() -> Vec<Group<CellQuantity>> {
    let is_margin = |wanted: &CellQuantity| {
        use CellQuantity::{Acceleration, Jerk, MinimumDistance, Play, Slip, Tilt, Velocity};
        matches!(wanted, MinimumDistance | Velocity | Acceleration | Jerk | Tilt | Play | Slip)
    };
    vec![Group { name: "margins", units: &[], has: Box::new(is_margin) }]
}

/// The columns of a table: sample, draw, what varies, what is asked for, and the status; with the quantities of the function.
fn columns(varied: &[Varied], asked: &[Asked<CellQuantity>]) -> (Vec<Column>, Vec<CellQuantity>) {
    let mut columns = vec![Column { name: "sample".to_owned(), source: Source::Sample }];
    let is_random = |one: &Varied| one.values.values.is_random();
    let is_grid = |one: &Varied| one.values.values.values() > 1;
    if varied.iter().any(is_random) && varied.iter().any(is_grid) {
        columns.push(Column { name: "draw".to_owned(), source: Source::Draw });
    }
    let own: Vec<String> = asked.iter().map(column_name).collect();
    let is_reserved =
        |name: &str| ["draw", "status"].contains(&name) || own.iter().any(|other| other == name);
    for (index, one) in varied.iter().enumerate() {
        let (unit, repeats) = (one.unit, !is_random(one));
        let mut name = format!("{}{}", one.name, unit.suffix());
        // Parameters have any name: one that another column has is preceded by its table.
        if is_reserved(&name) || columns.iter().any(|column| column.name == name) {
            name = format!("{}.{name}", one.key);
        }
        let source = Source::Number { index, unit, typed: true, repeats };
        columns.push(Column { name, source });
    }
    for (k, one) in asked.iter().enumerate() {
        let name = column_name(one);
        let (index, repeats) = (varied.len() + k, one.wanted == CellQuantity::Violations);
        let source = Source::Number { index, unit: one.unit, typed: false, repeats };
        columns.push(Column { name, source });
    }
    columns.push(Column { name: "status".to_owned(), source: Source::Status { model: 0 } });
    (columns, asked.iter().map(|one| one.wanted).collect())
}

/// The name of a quantity, with its unit.
fn column_name(asked: &Asked<CellQuantity>) -> String {
    let terms = terms();
    let term = terms.iter().find(|term| term.wanted == asked.wanted);
    let stem = &term.expect("what is asked for was found among the terms").stem;
    format!("{stem}{}", asked.unit.suffix())
}

/// Facts that determine the numbers of a study.
fn facts(
    subject: &Subject,
    varied: &[Varied],
    draws: u64,
    seed: u64,
    columns: &[Column],
) -> Vec<Fact> {
    let file = |(name, bytes): (&String, &Vec<u8>)| format!("{name} {}", bytes.escape_ascii());
    let files: Vec<String> = subject.files.iter().map(file).collect();
    let programs: Vec<&str> = subject.programs.iter().map(|one| one.text.as_str()).collect();
    let exact = varied.iter().map(|one| {
        let SweptValue { number, values } = &one.values;
        format!("{} {} {number} {}", one.key, one.name, fact::exact(values))
    });
    let shown = varied.iter().map(|one| {
        let values = fact::shown(&one.values.values, |value| one.unit.typed_from_si(value));
        format!("{}{} {values}", one.name, one.unit.suffix())
    });
    let values = Fact {
        key: "values",
        exact: exact.collect::<Vec<_>>().join("; "),
        shown: Some(shown.collect::<Vec<_>>().join("; ")),
    };
    let columns: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
    vec![
        Fact::not_shown("cell", subject.cell.clone()),
        Fact::not_shown("files", files.join("\n")),
        Fact::not_shown("programs", programs.join("\0")),
        values,
        Fact::text("samples", draws.to_string()),
        Fact::text("seed", seed.to_string()),
        Fact::text("columns", columns.join(", ")),
    ]
}
