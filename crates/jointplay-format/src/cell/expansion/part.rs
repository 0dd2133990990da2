//! Parts: `[[part]]` with `part = "slit-valve"`.

use std::borrow::Cow;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use super::super::problem::{Fault, Problem};
use super::super::stations::STATION_KEYS;
use super::super::tree::{AllowedRange, Entry, Reader, Table};
use super::document::{Node, Value, moved_table};
use super::groups::Groups;
use super::inheritance::take_keys;
use super::library::{Library, PART_KIND};
use super::lists::Lists;
use crate::expression::AngleUnit;
use crate::file_problem::FileProblem;
use crate::place::{Form, malformed, nearest};
use crate::toml_reader::{Inclusion, parameters};

/// Keys of the frame of a part without a station.
const FRAME_KEYS: [&str; 4] = ["on", "position_mm", "heading_deg", "tilt"];

/// The parts of a document, and what they add to it.
pub(super) struct Parts<'e, 'a> {
    pub(super) reader: &'e Reader<'a>,
    pub(super) library: &'a Library,
    pub(super) lists: Lists<'a>,
    pub(super) groups: Groups,
    /// Pairs of bodies that may touch.
    pub(super) contacts: Vec<Value<'a>>,
}

/// Name of an instance, with its position.
#[derive(Clone)]
struct Name {
    text: String,
    span: Range<usize>,
}

impl Name {
    /// The name of a body of the instance.
    fn of(&self, own: &str) -> String {
        format!("{}-{own}", self.text)
    }
}

/// The content of a part with the parameters of an instance.
struct Content<'a> {
    table: DeTable<'a>,
    parameters: Vec<String>,
}

impl<'a> Parts<'_, 'a> {
    /// Adds the stations, bodies and zones of an instance.
    pub(super) fn add(&mut self, instance: &Node<'a>) {
        let reader = self.reader;
        let table = Table::new(reader, "`[[part]]`", &instance.table, instance.span.clone());
        let (name, part) = (table.name("name"), table.needed("part"));
        let (Some(text), Some(part)) = (name, part) else { return };
        let Some(named) = table.entry("name") else { return };
        let name = Name { text, span: named.span() };
        let Some(content) = self.content(&part, instance) else { return };
        let Content { table: mut content, parameters } = content;
        let mut groups = Groups::default();
        let lists = Lists::take(reader, &mut content, &[], &mut groups);
        let count = 1 + lists.bodies.len() + lists.zones.len();
        if !self.groups.add_copies(count) {
            part.report(reader, Groups::too_many());
            return;
        }
        let station = content.get("station").and_then(|station| station.get_ref().as_table());
        let is_placed = |node: &Node<'a>| !node.table.contains_key("on");
        let has_frame = station.is_none() && lists.bodies.iter().chain(&lists.zones).any(is_placed);
        let mut keys = instance.table.clone();
        for key in ["name", "part"].into_iter().chain(parameters.iter().map(String::as_str)) {
            keys.remove(key);
        }
        let known: &[&'static str] = match station {
            Some(_) => &STATION_KEYS,
            None if has_frame => &FRAME_KEYS,
            None => &[],
        };
        self.remove_unknown(&mut keys, known, &parameters);
        let mut own = Node { span: instance.span.clone(), table: keys };
        own.set_text("name", name.text.clone(), name.span.clone());
        let parent = if let Some(station) = station {
            take_keys(&mut own.table, station);
            self.lists.stations.push(own);
            "station"
        } else {
            if has_frame {
                self.lists.frames.push(own);
            }
            "frame"
        };
        let place = |mut node: Node<'a>| {
            if is_placed(&node) {
                let on = [(parent, name.text.clone())].map(|(key, text)| {
                    let key = Spanned::new(name.span.clone(), Cow::Borrowed(key));
                    (key, Spanned::new(name.span.clone(), DeValue::String(text.into())))
                });
                let on = DeValue::Table(on.into_iter().collect());
                node.set("on", Spanned::new(name.span.clone(), on));
            }
            if let Some(own) = node.text("name").map(|own| name.of(own)) {
                node.set_text("name", own, name.span.clone());
            }
            node
        };
        for body in lists.bodies {
            let body = place(body);
            if let Some(member) = body.text("name") {
                self.groups.add(&name.text, member);
            }
            self.lists.bodies.push(body);
        }
        self.lists.zones.extend(lists.zones.into_iter().map(place));
        groups.add_prefixed(&mut self.groups, &|own| name.of(own));
        if let Some(pairs) = content.get("may_touch") {
            self.contacts.extend(contacts(pairs, &name));
        }
    }

    /// Reports and removes the keys of an instance that its part does not have.
    fn remove_unknown(
        &self,
        keys: &mut DeTable<'a>,
        known: &[&'static str],
        parameters: &[String],
    ) {
        let all = || {
            let own = ["name", "part", "like", "repeat"];
            let known = own.into_iter().chain(known.iter().copied());
            known.chain(parameters.iter().map(String::as_str))
        };
        let unknown: Vec<_> =
            keys.keys().filter(|key| !known.contains(&key.get_ref().as_ref())).cloned().collect();
        for key in unknown {
            let name: &str = key.get_ref();
            let form = Form::UnknownKey {
                key: name.to_owned(),
                nearest: nearest(name, all()),
                known: all().map(str::to_owned).collect(),
            };
            self.reader.report(key.span(), FileProblem::from(form));
            keys.remove(name);
        }
    }

    /// The tables of the part of an instance; expressions in them have its parameters.
    fn content(&self, part: &Entry<'_, 'a>, instance: &Node<'a>) -> Option<Content<'a>> {
        let reader = self.reader;
        let (name, text) = self.library.text(part, reader)?;
        let inclusion = Inclusion { name, span: part.span(), problem: within };
        let base = reader.include(text, inclusion);
        let (document, errors) = DeTable::parse_recoverable(text);
        let start = |error: &toml::de::Error| error.span().map_or(0, |span| span.start);
        if let Some(first) = errors.iter().min_by_key(|error| start(error)) {
            let span = first.span().unwrap_or(0..0);
            let problem = FileProblem::from(malformed(first.message()));
            reader.report(base + span.start..base + span.end, problem);
            return None;
        }
        let table = moved_table(document.get_ref(), base);
        let top = Table::new(reader, "a part", &table, base..base);
        let kind = top.needed("kind").and_then(|it| it.word(reader, "kind", &[(PART_KIND, ())]));
        for key in
            ["name", "description", "meaning", "parameters", "station", "body", "zone", "may_touch"]
        {
            let _ = top.entry(key);
        }
        top.finish();
        let declared = top.table("parameters", "`[parameters]`");
        let declared: Vec<_> = declared.iter().flat_map(Table::entries).collect();
        let replaced = |(default, _): &(Entry<'_, 'a>, Range<usize>)| {
            let value = instance.table.get(default.key)?;
            // A parameter with a positive default is a size or a count.
            let allowed = match default.any_number() {
                Some(default) if default > 0.0 => AllowedRange::Positive,
                _ => AllowedRange::Any,
            };
            let value = Entry { key: default.key, value }.number(reader, allowed)?;
            Some((default.key.to_owned(), value))
        };
        let replaced: Vec<(String, f64)> = declared.iter().filter_map(replaced).collect();
        let names = declared.iter().map(|(entry, _)| entry.key.to_owned()).collect();
        let found = parameters::resolve(&top, &replaced, AngleUnit::Degree);
        reader.set_scope(base, found.scope);
        kind?;
        Some(Content { table, parameters: names })
    }
}

/// The problem of a document that the text of a part has an error.
fn within(name: String, inner: Problem) -> Fault {
    Fault::Within { name, inner: Box::new(inner), others: Vec::new() }
}

/// The pairs of a part with the names of the bodies of an instance.
fn contacts<'a>(pairs: &Value<'a>, name: &Name) -> Vec<Value<'a>> {
    let named = |value: &Value<'a>| match value.get_ref() {
        DeValue::String(own) => Spanned::new(value.span(), DeValue::String(name.of(own).into())),
        _ => value.clone(),
    };
    let pair = |pair: &Value<'a>| match pair.get_ref() {
        DeValue::Array(list) => {
            let list: DeArray<'a> = list.iter().map(named).collect();
            Spanned::new(pair.span(), DeValue::Array(list))
        }
        _ => pair.clone(),
    };
    match pairs.get_ref() {
        DeValue::Array(list) => list.iter().map(pair).collect(),
        // A value of another type is reported where contacts are read.
        _ => vec![pairs.clone()],
    }
}
