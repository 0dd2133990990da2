//! A mechanism from the text of its file.

use std::ops::Range;

use jointplay_core::mechanism::{Joint, Mechanism, MechanismError};

use super::attached_frame::attached_frame;
use super::coupling::{NamedCoordinates, coupling};
use super::header::{MAX_BYTES, units};
use super::joint::{Links, joint};
use super::names::{printable_name, prose};
use super::problem::{Errors, Problem};
use super::tree::{Entry, Table};
use super::values::{LengthUnit, Units, Values};
use super::virtual_joint::{Joints, virtual_joint};
use crate::expression::AngleUnit;
use crate::file_problem::FileProblem;
use crate::toml_reader::parameters::{self, Parameters};
use crate::toml_reader::read_document;

/// A mechanism as read.
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismFile {
    /// The mechanism (m, rad).
    pub mechanism: Mechanism,
    /// Source of the mechanism.
    pub source: Option<String>,
    /// The units of the file, for messages.
    pub units: Units,
    /// Values of all parameters, in the order and the units of the file.
    pub parameters: Vec<(String, f64)>,
    /// Expected results of an analysis.
    pub expected: Expected,
}

/// Expected results of an analysis, from the file; `None` where the file has none.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Expected {
    /// Freedoms of all joints together.
    pub freedoms: Option<usize>,
    /// Rank of the closure equations.
    pub rank: Option<usize>,
    /// Mobility by the count of Kutzbach.
    pub kutzbach: Option<i64>,
    /// Instantaneous mobility.
    pub instantaneous: Option<usize>,
    /// Finite mobility.
    pub finite: Option<usize>,
    /// Redundant closure equations.
    pub redundancy: Option<usize>,
    /// A remark.
    pub note: Option<String>,
}

/// Reads a mechanism file.
///
/// # Errors
/// All errors in the order of their places: invalid TOML, keys that are missing, unknown or contradictory, numbers out of range, links and joints that make no mechanism.
pub fn parse(text: &str) -> Result<MechanismFile, Errors> {
    parse_with(text, &[])
}

/// Reads a mechanism file with other values for some of its parameters, for example for a sweep.
///
/// # Arguments
/// * `replaced` – names of parameters of the file, and their values in the units of the file
///
/// # Errors
/// As [`parse`], and if the file has no parameter of a name.
pub fn parse_with(text: &str, replaced: &[(String, f64)]) -> Result<MechanismFile, Errors> {
    read_document(text, MAX_BYTES, "a mechanism", |top| {
        if !top.reader.is_clean() || top.has_other_kind("mechanism") {
            return None;
        }
        let file = read(top, replaced);
        top.finish();
        file
    })
}

/// Units that allow the widest range, for the numbers of a file without valid units.
pub(super) const FALLBACK_UNITS: Units =
    Units { length: LengthUnit::Micrometer, angle: AngleUnit::Degree };

fn read(top: &Table, replaced: &[(String, f64)]) -> Option<MechanismFile> {
    let reader = top.reader;
    let name = top.needed("name").and_then(|entry| printable_name(reader, &entry));
    let source = prose(top, "source");
    let units = units(top);
    let base = top.needed("base").and_then(|entry| printable_name(reader, &entry));
    let length = top.entry("characteristic_length");
    let angle = units.unwrap_or(FALLBACK_UNITS).angle;
    let Parameters { scope, order } = parameters::resolve(top, replaced, angle);
    let expected = top.table("expected", "`[expected]`").map(|table| expected(&table));
    let values = Values { reader, units: units.unwrap_or(FALLBACK_UNITS), scope };
    let names = (name.as_deref().unwrap_or_default(), base.as_deref());
    let mechanism = mechanism(&values, top, names);
    let length = length.map(|_| values.positive(top, "characteristic_length"));
    let mut mechanism = mechanism?;
    name?;
    if let Some(length) = length {
        let placed = mechanism.with_characteristic_length(values.length(length?));
        mechanism = placed.map_err(|error| top.report_at("characteristic_length", error)).ok()?;
    }
    let value = |name: String| {
        let value = *values.scope.values.get(&name)?;
        Some((name, value))
    };
    Some(MechanismFile {
        mechanism,
        source,
        units: units?,
        parameters: order.into_iter().map(value).collect::<Option<_>>()?,
        expected: expected.unwrap_or_default(),
    })
}

/// The expected results of an analysis.
fn expected(table: &Table) -> Expected {
    let count = |key| {
        let entry = table.entry(key)?;
        let found = entry.integer(table.reader)?;
        let count = usize::try_from(found).ok();
        if count.is_none() {
            let (key, needed) = (entry.key.to_owned(), "0 or more".to_owned());
            let problem = FileProblem::OutOfRange { key, value: found as f64, needed };
            entry.report(table.reader, problem);
        }
        count
    };
    let expected = Expected {
        freedoms: count("freedoms"),
        rank: count("rank"),
        kutzbach: table.entry("kutzbach").and_then(|entry| entry.integer(table.reader)),
        instantaneous: count("instantaneous"),
        finite: count("finite"),
        redundancy: count("redundancy"),
        note: prose(table, "note"),
    };
    table.finish();
    expected
}

/// The mechanism without its characteristic length.
fn mechanism(
    values: &Values,
    top: &Table,
    (title, base): (&str, Option<&str>),
) -> Option<Mechanism> {
    let mut links = Links::default();
    if let Some(base) = base {
        links.index(base);
    }
    let mut tables = joint_tables(top);
    let joints: Vec<Option<Joint>> = tables
        .iter_mut()
        .map(|table| {
            let why = "all points are in the base frame; `frames` places a joint on its links";
            let misplaced = |entry: Entry| {
                let problem = Problem::Misplaced { key: "in", why: why.to_owned() };
                entry.report(values.reader, problem);
            };
            table.refused("in").map(misplaced);
            joint(values, table, &mut links)
        })
        .collect();
    let mut virtual_tables = top.tables("virtual_joint");
    let known = Joints::new(&tables, &joints, &links.names);
    let virtual_joints: Vec<_> =
        virtual_tables.iter_mut().map(|table| virtual_joint(values, table, &known)).collect();
    let named_coordinates = NamedCoordinates::new(&joints);
    let mut coupling_tables = top.tables("coupling");
    let couplings: Vec<_> = coupling_tables
        .iter_mut()
        .map(|table| coupling(values, table, &named_coordinates))
        .collect();
    let mut frame_tables = top.tables("frame");
    let frames: Vec<_> =
        frame_tables.iter_mut().map(|table| attached_frame(values, table, &links)).collect();
    let base = base?;
    let joints = joints.iter().cloned().collect::<Option<Vec<Joint>>>()?;
    if !joints.is_empty() && joints.iter().all(|joint| !joint.links.contains(&0)) {
        let entry = top.entry("base")?;
        entry.unknown(values.reader, "base", base, &links.names[1..]);
        return None;
    }
    let blamed = |error: MechanismError| {
        let tables = [&tables, &virtual_tables, &coupling_tables, &frame_tables].map(Vec::as_slice);
        values.reader.report(blame(top, tables, &error), error);
    };
    let mechanism = Mechanism::new(title, links.names.clone(), joints).map_err(blamed).ok()?;
    let virtual_joints = virtual_joints.into_iter().collect::<Option<Vec<_>>>()?;
    let mechanism = mechanism.with_virtual_joints(virtual_joints).map_err(blamed).ok()?;
    let couplings = couplings.into_iter().collect::<Option<Vec<_>>>()?;
    let mechanism = mechanism.with_couplings(couplings).map_err(blamed).ok()?;
    let frames = frames.into_iter().collect::<Option<Vec<_>>>()?;
    mechanism.with_frames(frames).map_err(blamed).ok()
}

/// The tables of the joints, of which there is at least one.
fn joint_tables<'r, 'a>(top: &Table<'r, 'a>) -> Vec<Table<'r, 'a>> {
    top.needed("joint");
    top.tables("joint")
}

/// The links that a joint names.
fn links<'r, 'a>(table: &Table<'r, 'a>) -> Vec<Entry<'r, 'a>> {
    let list = table.entry("links").and_then(|entry| entry.list(table.reader));
    list.unwrap_or_default()
}

/// The part of the file that an error of the mechanism is about.
///
/// # Arguments
/// * `tables` – of joints, virtual joints, couplings and frames
fn blame(top: &Table, tables: [&[Table]; 4], error: &MechanismError) -> Range<usize> {
    use MechanismError as E;
    let joints = tables[0];
    let is_named = |table: &&Table, name: &str| {
        table.entry("name").and_then(|entry| entry.value.get_ref().as_str()) == Some(name)
    };
    let text = |entry: &Entry| entry.value.get_ref().as_str().map(str::to_owned);
    let span = |table: &Table, key| Some(table.entry(key)?.span());
    let found = match error {
        // A frame can have the name of a link, which is nowhere but in the lists of the joints.
        E::NameTwice { name } => {
            let named = tables.iter().copied().flatten().filter(|table| is_named(table, name));
            let named: Vec<&Table> = named.collect();
            named.get(1).or(named.last()).and_then(|table| span(table, "name"))
        }
        E::NoSuchLink { joint, .. } | E::JoinedToItself { joint, .. } => joints
            .iter()
            .find(|table| {
                let links = links(table);
                is_named(table, joint)
                    && links.first().and_then(text) == links.last().and_then(text)
            })
            .and_then(|table| span(table, "links")),
        E::Dangling { link, .. } => joints
            .iter()
            .flat_map(links)
            .find(|entry| entry.value.get_ref().as_str() == Some(link))
            .map(|entry| entry.span()),
        E::CoupledRotation { coupling, .. }
        | E::CoupledTwice { coupling, .. }
        | E::CoupledMany { coupling, .. } => {
            let found = tables[2].iter().find(|table| is_named(table, coupling));
            found.and_then(|table| span(table, "coordinate"))
        }
        E::NotFinite { name, .. } => {
            joints.iter().find(|table| is_named(table, name)).and_then(|table| span(table, "name"))
        }
        _ => None,
    };
    found.or_else(|| span(top, "name")).unwrap_or(0..0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::header::MAX_BYTES;
    use crate::mechanism::kind::kind_of;
    use jointplay_core::mechanism::{Carrier, JointKind, VirtualMotion};
    use nalgebra::Vector3;
    use proptest::prelude::*;

    const SAMPLE: &str = include_str!("sample.toml");

    #[test]
    fn a_file_is_read_into_si_units() {
        let file = parse(SAMPLE).unwrap();
        let [crank, cardan, screw, slider] = file.mechanism.joints() else { panic!() };
        assert_eq!(file.mechanism.links(), ["ground", "arm", "cross", "nut"]);
        assert_eq!(file.mechanism.characteristic_length(), Some(0.44));
        assert_eq!(crank.frames[0].translation.vector, Vector3::new(0.11, 0.0, 0.0));
        assert_eq!(crank.frames[0].rotation.matrix(), &nalgebra::Matrix3::identity());
        assert!(crank.actuated && !cardan.actuated);
        assert_eq!(crank.limits, [[-90.0, 90.0].map(f64::to_radians)]);
        assert_eq!(crank.guess, [f64::to_radians(30.0)]);
        assert_eq!(crank.clearance.linear, Some(2e-5));
        assert_eq!(crank.clearance.angular, Some(f64::to_radians(0.1)));
        assert_eq!(crank.stiffness.linear, Some(1e6));
        assert_eq!(cardan.frames[1].rotation * Vector3::x(), Vector3::x());
        assert_eq!(cardan.frames[1].rotation * Vector3::z(), Vector3::y());
        assert_eq!(cardan.limits[1], [-2.0, 90.0].map(f64::to_radians));
        assert_eq!(screw.kind, JointKind::Helical { lead: 0.005 / std::f64::consts::TAU });
        assert_eq!(screw.frames[0].rotation * Vector3::z(), -Vector3::y());
        assert_eq!(screw.frames[1].translation.vector, Vector3::zeros());
        assert!((slider.frames[0].rotation.matrix().determinant() - 1.0).abs() < 1e-15);
        let [v1, v2] = file.mechanism.virtual_joints() else { panic!() };
        assert_eq!((v1.carrier, v1.clearance), (Carrier::First, Some(2e-5)));
        assert_eq!(v2.clearance, Some(f64::to_radians(0.5)));
        let point = Vector3::new(0.11, 0.0, 0.0);
        assert_eq!(v2.motion, VirtualMotion::Turn { axis: Vector3::z_axis(), point });
        let [tip, center] = file.mechanism.frames() else { panic!() };
        assert_eq!((tip.name.as_str(), tip.link), ("tip", 3));
        assert_eq!(tip.link_from_frame.translation.vector, Vector3::new(0.22, 0.0, 0.01));
        assert_eq!(tip.link_from_frame.rotation * Vector3::x(), Vector3::y());
        assert_eq!(center.link_from_frame, jointplay_core::spatial::Pose::identity());
        assert_eq!(file.source.as_deref(), Some("[Source]"));
        assert_eq!(file.expected.kutzbach, Some(-2));
        let of = |name: &str, value| (name.to_owned(), value);
        assert_eq!(file.parameters, [of("half", 110.0), of("a", 220.0), of("alpha", 90.0)]);
    }

    #[test]
    fn parameters_can_be_replaced() {
        let file = parse_with(SAMPLE, &[("a".to_owned(), 100.0)]).unwrap();
        assert_eq!(file.parameters[0].1, 50.0);
        let file = parse_with(SAMPLE, &[("half".to_owned(), 7.0)]).unwrap();
        assert_eq!(file.mechanism.joints()[0].frames[0].translation.x, 0.007);
        let error = parse_with(SAMPLE, &[("alhpa".to_owned(), 1.0)]).unwrap_err();
        let message = "line 1: parameter \"alhpa\" is not known (did you mean `alpha`?); known: a, alpha, half";
        assert_eq!(error.to_string(), message);
        assert!(parse_with(SAMPLE, &[("a".to_owned(), f64::NAN)]).is_err());
    }

    /// Replaces a piece of the sample; expects an error with a message, at the text `blamed`.
    #[track_caller]
    fn refuse(from: &str, to: &str, blamed: &str, message: &str) {
        assert!(SAMPLE.contains(from), "{from:?} is not in the file");
        let errors = parse(&SAMPLE.replacen(from, to, 1)).unwrap_err();
        let is_blamed = errors.iter().any(|error| {
            let place = &error.place;
            let found: String =
                place.text.chars().skip(place.column - 1).take(place.width).collect();
            error.to_string().contains(message) && found == blamed
        });
        assert!(is_blamed, "{}", errors.with_excerpt("x.toml"));
    }

    #[test]
    fn unknown_words_are_refused_with_the_known_ones() {
        refuse("axis = [0, 0, 2]", "axes = [0, 0, 2]", "axes", "did you mean `axis`?");
        refuse(
            "axis = [0, 0, 2]",
            "foo = 1",
            "foo",
            "known here: name, kind, links, frames, point",
        );
        refuse("\"mechanism\"", "\"mechansim\"", "\"mechansim\"", "known: mechanism");
        refuse("\"mm\"", "\"cm\"", "\"cm\"", "known: m, mm, um, in");
        refuse("\"deg\"", "\"degree\"", "\"degree\"", "did you mean `deg`?");
        refuse("\"revolute\"", "\"revolut\"", "\"revolut\"", "did you mean `revolute`?");
        refuse("on = \"ground\"", "on = \"nut\"", "\"nut\"", "known: ground, arm");
        refuse("joint = \"crank\"", "joint = \"krank\"", "\"krank\"", "did you mean `crank`?");
        refuse("base = \"ground\"", "base = \"grund\"", "\"grund\"", "did you mean `ground`?");
        refuse("\"Sample\"", "\"a\\u001b[31m\"", "\"a\\u001b[31m\"", "control characters");
        refuse("\"Sample\"", "\" \"", "\" \"", "empty");
        refuse("freedoms = 8", "freedoms = -8", "-8", "");
    }

    #[test]
    fn invalid_formulas_are_refused_with_their_place() {
        refuse("\"-a * cos(alpha)\"", "\"-a * cos(alhpa)\"", "alhpa", "did you mean `alpha`?");
        refuse("\"-a * cos(alpha)\"", "\"-a * ?\"", "?", "column 6 of the expression");
        refuse("\"a / 2\"", "\"b / 2\"", "b", "unknown name `b`; known here: a, alpha, half, pi");
        refuse("a = 220", "a = \"2 * half\"", "\"2 * half\"", "in a circle: a → half → a");
        refuse("a = 220", "a = \"a\"", "\"a\"", "a → a");
        refuse("a = 220", "a = nan", "nan", "`a` is not a number");
        refuse("a = 220", "a = 220\npi = 1", "pi", "no parameter can be called \"pi\"");
        refuse("\"a / 2\"", "\"sin / 2\"", "sin", "`sin` is a function: write its arguments");
        refuse("lead = 5", "lead = \"1 / 0\"", "1 / 0", "is infinite");
    }

    #[test]
    fn invalid_numbers_are_refused() {
        refuse("[0, 0, 2]", "[0, 0, 0]", "[0, 0, 0]", "all its numbers are 0");
        refuse("[0, 0, 2]", "[0, 2]", "[0, 2]", "has 2 entries, but needs 3");
        refuse("[0, 0, 2]", "[0, 0, inf]", "inf", "`axis` is infinite");
        refuse("point = [1, 2, 3]", "point = [1, 2, 1e308]", "1e308", "within ±1e12");
        refuse("point = [1, 2, 3]", "point = [1, 2, 1e10]", "1e10", "within ±1000000000 mm");
        refuse("guess = 30", "guess = 1e308", "1e308", "`guess` is 1e308, but has to be within");
        refuse("[0, 0, 2]", "[0, 0, 1e308]", "1e308", "within ±1e12");
        refuse("[0, 0, 2]", "[0, 0, \"1e13\"]", "\"1e13\"", "within ±1e12");
        refuse(
            "[0, 0, 2]",
            "[0, 0, true]",
            "true",
            "has to be a number or an expression, but is true",
        );
        refuse("zero = [1, 0, 5]", "zero = [0, 0, 5]", "[0, 0, 5]", "parallel to the axis");
        let tilted = "second_axis = [1, 1e-5, 0]";
        refuse("second_axis = [1, 0, 0]", tilted, "[1, 1e-5, 0]", "is 89.999427° from the axis");
        refuse("[-90, 90]", "[90, -90]", "[90, -90]", "reversed: least 90, most -90");
        refuse("[-90, 90]", "[90]", "[90]", "pairs of least and greatest");
        refuse("[[-1, 1], [-2, \"alpha\"]]", "[-1, 1]", "[-1, 1]", "needs 2 pairs, one for each");
        refuse("[[-1, 1],", "[[1, 1],", "[1, 1]", "`limits` are an empty range: least 1, most 1");
        refuse("guess = 30", "guess = [1, 2]", "[1, 2]", "needs 1 numbers");
        refuse("linear = 0.02", "linear = -0.02", "-0.02", "`linear` is -0.02");
        refuse("clearance = 0.5", "clearance = 0", "0", "has to be positive");
        refuse("\"2 * a\"", "0", "0", "`characteristic_length` is 0");
    }

    #[test]
    fn keys_that_miss_or_contradict_are_refused() {
        refuse("axis = [1, 1, 1]", "", "\"slider\"", "\"slider\" needs `axis`");
        refuse("point = [1, 2, 3]", "", "\"slider\"", "\"slider\" needs `point`");
        refuse("lead = 5", "", "\"screw\"", "\"screw\" needs `lead`");
        refuse("lead = 5", "lead = 5\npoint = [0, 0, 0]", "[0, 0, 0]", "`frames` places");
        refuse("axis = [1, 1, 1]", "axis = [1, 1, 1]\nlead = 2", "2", "only helical joints");
        refuse("second_axis = [1, 0, 0]", "", "\"cardan\"", "needs `second_axis`");
        refuse("second_axis = [1, 0, 0]", "zero = [1, 0, 0]", "[1, 0, 0]", "`second_axis` instead");
        let both = "turn = [0, 0, 1]\nslide = [1, 0, 0]";
        refuse("turn = [0, 0, 1]", both, "[0, 0, 1]", "state two");
        refuse("turn = [0, 0, 1]", "", "\"v2\"", "needs `slide` or `turn`");
        let about = "slide = [1, 1, 0]\nabout = [0, 0, 1]";
        refuse("slide = [1, 1, 0]", about, "[0, 0, 1]", "only a `turn`");
        let within = "point = [1, 2, 3]\nin = \"nut\"";
        refuse("point = [1, 2, 3]", within, "\"nut\"", "`in` does not belong here: all points");
        refuse("units =", "# units =", "", "a mechanism needs `units`");
    }

    #[test]
    fn directions_of_a_joint_of_unknown_kind_are_checked() {
        let text =
            SAMPLE.replace("\"universal\"", "3").replace("second_axis = [1,", "second_axis = [");
        let errors = parse(&text).unwrap_err();
        let lines: Vec<usize> = errors.iter().map(|error| error.place.line).collect();
        assert_eq!(lines, [33, 37], "{errors}");
    }

    #[test]
    fn links_that_make_no_mechanism_are_refused() {
        refuse("[\"arm\", \"cross\"]", "[\"arm\", \"arm\"]", "[\"arm\", \"arm\"]", "to itself");
        for joint in ["crank[0]", "crank,cardan", "crank=1"] {
            let named = format!("{joint:?}");
            refuse("name = \"crank\"", &format!("name = {named}"), &named, "cannot be called");
        }
        refuse("name = \"v2\"", "name = \"crank\"", "\"crank\"", "used twice");
        refuse("name = \"tip\"", "name = \"arm\"", "\"arm\"", "used twice");
        refuse("link = \"nut\"", "link = \"nutt\"", "\"nutt\"", "did you mean `nut`?");
        refuse("zero = [0, 1, 0]", "zero = [0, 0, 1]", "[0, 0, 1]", "parallel to the axis");
        refuse("name = \"cardan\"", "name = \"crank\"", "\"crank\"", "used twice");
        let apart = "[[joint]]\nname = \"apart\"\nkind = \"fixed\"\nlinks = [\"p\", \"q\"]\n";
        let text = format!("{apart}\n[[virtual_joint]]");
        refuse("[[virtual_joint]]", &text, "\"p\"", "\"p\" is not connected to the base");
        refuse("[\"nut\", \"ground\"]", "[\"nut\"]", "[\"nut\"]", "has 1 entry, but needs 2");
    }

    #[test]
    fn endless_files_are_refused() {
        let error = parse(&format!("{SAMPLE}#{}", "x".repeat(MAX_BYTES))).unwrap_err();
        assert!(error.to_string().contains("at most 4000000 are allowed"), "{error}");
        let mut text = SAMPLE.replace("[[virtual_joint]]", "[[ignored]]");
        text.truncate(text.find("[[ignored]]").unwrap());
        for link in 0..10_000 {
            text += &format!(
                "[[joint]]\nname = \"j{link}\"\nkind = \"fixed\"\nlinks = [\"ground\", \"l{link}\"]\n"
            );
        }
        let error = parse(&text).unwrap_err();
        assert!(error.to_string().contains("at most 10000 are allowed"), "{error}");
    }

    #[test]
    fn long_chains_of_parameters_are_resolved() {
        let chain: String =
            (0..20_000).map(|index| format!("p{index} = \"p{} + 1\"\n", index + 1)).collect();
        let text = SAMPLE.replace("a = 220", &format!("a = 220\n{chain}p20000 = 0"));
        let file = parse(&text).unwrap();
        assert_eq!(file.parameters[2], ("p0".to_owned(), 20_000.0));
    }

    #[test]
    fn the_kind_is_found() {
        assert_eq!(kind_of(SAMPLE).as_deref(), Some("mechanism"));
        assert_eq!(kind_of(crate::robot::PAPER).as_deref(), Some("gpr"));
        assert_eq!(kind_of("kind = \"gpr\"\nname = = 3\n").as_deref(), Some("gpr"));
        assert_eq!(kind_of("name = 3\n[a]\nkind = \"gpr\"\nb = ="), None);
        let error = parse(crate::robot::PAPER).unwrap_err();
        assert!(error.to_string().starts_with("line 6: kind \"gpr\" is not known"), "{error}");
    }

    #[test]
    fn an_error_shows_the_line() {
        let text = SAMPLE.replacen("\"half\", 0,", "\"hlaf\", 0,", 1);
        let shown = parse(&text).unwrap_err().with_excerpt("my.toml");
        let expected = "my.toml:22:11: unknown name `hlaf` (did you mean `half`?); known here: a, alpha, half, pi\n   |\n22 | point = [\"hlaf\", 0, \"-a * cos(alpha)\"]\n   |           ^^^^";
        assert_eq!(shown, expected);
    }

    proptest! {
        #[test]
        fn no_mutated_text_panics(
            cuts in prop::collection::vec((0..SAMPLE.len(), 0..30_usize, "[-\\[\\]\"={},.0-9a\n ]{0,3}"), 1..4)
        ) {
            let mut text = SAMPLE.to_owned();
            for (start, length, replacement) in cuts {
                let start = start.min(text.len());
                let end = (start + length).min(text.len());
                if text.is_char_boundary(start) && text.is_char_boundary(end) {
                    text.replace_range(start..end, &replacement);
                }
            }
            if let Err(error) = parse(&text) {
                let _ = error.with_excerpt("x");
            }
            let _ = kind_of(&text);
        }
    }
}
