//! Reader of files of host languages.

use jointplay_cell::robot::AxisKind;
use jointplay_format::place::Errors;
use jointplay_format::program;
use jointplay_format::toml_reader::read_document;

use super::command::{ACTIONS, Action, CommandRule, Effect};
use super::field::{FieldKind, IDENTIFIER, UNIT};
use super::language::{Answers, HostLanguage, InputFormat, NEUTRAL};
use super::pattern::Pattern;
use crate::controller_text::{
    AxisFormat, Checksum, Codes, CommandProblem, Decimals, Kind, Names, Problem, Table, Template,
    TemplateTable, Value,
};

/// Longest accepted file of a host language (bytes).
pub const MAX_BYTES: usize = 100_000;

/// Decimals of numbers in programs, so that none of a host's digits is lost.
const PROGRAM_DECIMALS: usize = 12;

// Names that a template may contain, by kind of template.
const EFFECTOR: [(&str, Kind); 2] = [("name", Kind::Text), ("loaded", Kind::Integer)];
const SLOT: [(&str, Kind); 2] = [("number", Kind::Integer), ("loaded", Kind::Integer)];
const WELCOME: [(&str, Kind); 3] =
    [("cell", Kind::Text), ("robot", Kind::Text), ("axes", Kind::Text)];
const REQUEST: [(&str, Kind); 3] =
    [("number", Kind::Integer), ("command", Kind::Text), (IDENTIFIER, Kind::Text)];
const DURATION: [(&str, Kind); 1] = [("duration", Kind::Time)];
const REFUSED: [(&str, Kind); 3] =
    [("code", Kind::Integer), ("reason", Kind::Text), ("text", Kind::Text)];
const STATUS: [(&str, Kind); 5] = [
    ("state", Kind::Text),
    ("remaining", Kind::Time),
    ("axes", Kind::Text),
    ("positions", Kind::Text),
    ("effectors", Kind::Text),
];
const MAP: [(&str, Kind); 2] = [("station", Kind::Text), ("slots", Kind::Text)];

impl HostLanguage {
    /// Reads the file of a host language.
    ///
    /// # Errors
    /// All errors in the order of their places, at least one: invalid TOML, missing and unknown keys, unknown fields and names, commands without effect, programs that do not parse.
    pub fn parse(text: &str) -> Result<Self, Errors<Problem>> {
        read_document(text, MAX_BYTES, "a host language", |top| {
            let language = read(top);
            top.finish();
            language
        })
    }

    /// The neutral language.
    #[must_use]
    pub fn neutral() -> Self {
        Self::parse(NEUTRAL).expect("the included language is valid, as a test checks")
    }
}

fn read(top: &Table<'_, '_>) -> Option<HostLanguage> {
    let reader = top.reader;
    let text = |key| top.needed(key)?.text(reader).map(str::to_owned);
    let (name, about) = (text("name"), text("about"));
    let (file, are_decimals_valid) = TemplateTable::of_file(top);
    let decimals = file.decimals;
    let axis = AxisFormat::read(&file);
    let effector = file.required("effector", &Names::new(&EFFECTOR));
    let slot = file.required("slot", &Names::new(&SLOT));
    let station_codes = Codes::read(top, "station_codes");
    let effector_codes = Codes::read(top, "effector_codes");
    let has_codes =
        HasCodes { stations: station_codes.is_some(), effectors: effector_codes.is_some() };
    let tables = top.tables("command");
    let commands: Vec<_> = tables.iter().map(|table| command(table, has_codes)).collect();
    if commands.is_empty() {
        top.report(Problem::from(CommandProblem::NoCommand));
    }
    let answer = match top.table("answer", "`[answer]`") {
        Some(table) => {
            let answer = answers(&TemplateTable { top: &table, decimals }, &station_codes);
            table.finish();
            answer
        }
        None => {
            top.missing("answer");
            None
        }
    };
    let output = file.output_or_default();
    let input = match top.table("input", "`[input]`") {
        Some(table) => {
            let input = input(&TemplateTable { top: &table, decimals });
            table.finish();
            input
        }
        None => Some(InputFormat::default()),
    };
    if !are_decimals_valid {
        return None;
    }
    Some(HostLanguage {
        name: name?,
        about: about?,
        axis: axis?,
        effector: effector?,
        slot: slot?,
        commands: commands.into_iter().collect::<Option<_>>()?,
        station_codes,
        effector_codes,
        input: input?,
        answer: answer?,
        output: output?,
    })
}

#[derive(Clone, Copy)]
struct HasCodes {
    stations: bool,
    effectors: bool,
}

/// A table `[[command]]`.
fn command(table: &Table<'_, '_>, has_codes: HasCodes) -> Option<CommandRule> {
    let reader = table.reader;
    let read = || {
        let entry = table.needed("pattern")?;
        let text = entry.text(reader)?;
        let span = |part| entry.part_span(reader, text, part);
        let parsed = Pattern::parse(text);
        let pattern = parsed
            .map_err(|(part, problem)| reader.report(span(part), Problem::from(problem)))
            .ok()?;
        for field in pattern.fields() {
            let (name, table) = match field.kind {
                FieldKind::StationCode if !has_codes.stations => (field.name, "station_codes"),
                FieldKind::EffectorCode if !has_codes.effectors => (field.name, "effector_codes"),
                _ => continue,
            };
            entry.report(reader, Problem::from(CommandProblem::NoCodes { name, table }));
        }
        Some((text.to_owned(), pattern))
    };
    let pattern = read();
    let effect = match (table.entry("program"), table.entry("action")) {
        (Some(entry), None) => {
            let names = pattern.as_ref().map(|(_, pattern)| program_names(pattern));
            let decimals = Decimals { values: PROGRAM_DECIMALS, times: PROGRAM_DECIMALS };
            let file = TemplateTable { top: table, decimals };
            let templates = names.and_then(|names| file.templates(&entry, &names));
            templates.and_then(|templates| {
                let checked = check_program(&templates);
                let report = |problem| entry.report(reader, Problem::from(problem));
                checked.map_err(report).ok().map(|()| Effect::Program(templates))
            })
        }
        (None, Some(entry)) => {
            let action = entry.word(reader, "action", &ACTIONS);
            let names_station = |(_, pattern): &(String, Pattern)| {
                pattern.fields().any(|field| field.in_templates == "station")
            };
            if action == Some(Action::Map) && !pattern.as_ref().is_none_or(names_station) {
                entry.report(reader, Problem::from(CommandProblem::NoStation));
            }
            action.map(Effect::Action)
        }
        _ => {
            table.report(Problem::from(CommandProblem::NoEffect));
            None
        }
    };
    table.finish();
    let (text, pattern) = pattern?;
    Some(CommandRule { text, pattern, effect: effect? })
}

/// Names of the program of a command.
fn program_names(pattern: &Pattern) -> Names {
    let mut known: Vec<_> = pattern
        .fields()
        .filter(|field| field.kind != FieldKind::Identifier)
        .map(|field| (field.in_templates, field.kind.value_kind()))
        .collect();
    if pattern.fields().any(|field| field.kind == FieldKind::Axis) {
        known.push((UNIT, Kind::Text));
    }
    Names::new(&known)
}

/// The text of a program.
pub(super) fn program_text(
    templates: &[Template],
    value: impl Fn(&str) -> Value,
) -> Result<String, Box<Problem>> {
    let lines: Result<Vec<String>, _> =
        templates.iter().map(|template| template.fill(&value)).collect();
    lines.map(|lines| lines.join("\n")).map_err(|error| error.problem)
}

/// Unit of an axis in programs.
pub(super) fn unit_of(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Linear => "mm",
        AxisKind::Rotary => "deg",
    }
}

/// Whether a program with some values parses.
fn check_program(templates: &[Template]) -> Result<(), CommandProblem> {
    let value = |name: &str| match name {
        UNIT => Value::Text("mm".to_owned()),
        "slot" | "slot_2" => Value::Integer(1),
        name if super::field::FIELDS
            .iter()
            .any(|field| field.in_templates == name && field.kind.value_kind() == Kind::Text) =>
        {
            Value::Text(format!("\"{name}\""))
        }
        _ => Value::Real(1.0),
    };
    let failed = |text: String, why: String| CommandProblem::Program { text, why };
    let text = program_text(templates, value)
        .map_err(|problem| failed(String::new(), problem.to_string()))?;
    match program::parse(&text) {
        Ok(_) => Ok(()),
        Err(errors) => {
            let why = errors.first().map_or_else(String::new, ToString::to_string);
            Err(failed(text, why))
        }
    }
}

/// The table `[answer]`.
fn answers(file: &TemplateTable<'_, '_, '_>, station_codes: &Option<Codes>) -> Option<Answers> {
    let names = |known: &[(&'static str, Kind)]| Names::new(&[&REQUEST, known].concat());
    let map = names(&MAP).with(
        "station_code",
        "the table `[station_codes]`",
        station_codes.as_ref().map(|codes| codes.kind),
    );
    let required = |key, names: &Names| file.templates(&file.top.needed(key)?, names);
    let welcome = file.list("welcome", &Names::new(&WELCOME));
    let accepted = file.list("accepted", &names(&DURATION));
    let completed = required("completed", &names(&DURATION));
    let stopped = file.list("stopped", &names(&DURATION));
    let refused = required("refused", &names(&REFUSED));
    let status = file.list("status", &names(&STATUS));
    let map = file.list("map", &map);
    Some(Answers {
        welcome: welcome?,
        accepted: accepted?,
        completed: completed?,
        stopped: stopped?,
        refused: refused?,
        status: status?,
        map: map?,
    })
}

/// The table `[input]`.
fn input(file: &TemplateTable<'_, '_, '_>) -> Option<InputFormat> {
    let top = file.top;
    let checksum = match top.entry("checksum") {
        Some(entry) => entry.word(top.reader, "checksum", &Checksum::ALL).map(Some),
        None => Some(None),
    };
    let one = |key, names: &Names| match top.entry(key) {
        Some(entry) => file.template(&entry, names).map(Some),
        None => Some(None),
    };
    let covered = one("covered", &Names::new(&[("text", Kind::Text)]));
    let kind = checksum.flatten().map(|_| Kind::Integer);
    let line = Names::new(&[("text", Kind::Text), ("covered", Kind::Text)]);
    let line = one("line", &line.with("checksum", "the key `checksum`", kind));
    let (covered, line) = (covered?, line?);
    let is_covered = covered.as_ref().is_none_or(|covered| covered.uses("text"));
    let keeps = match &line {
        Some(line) => {
            let keeps = line.uses("text") || (line.uses("covered") && is_covered);
            file.keeps_text("line", keeps, "{text}, and no {covered} with it", "commands")
        }
        None => file.keeps_text("covered", is_covered, "{text}", "commands"),
    };
    keeps.then_some(InputFormat { covered, line, checksum: checksum? })
}
