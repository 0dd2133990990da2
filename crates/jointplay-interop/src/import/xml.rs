//! Elements, attributes and numbers of a model, each with its place.

use std::ops::Range;

use nalgebra::{Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use super::problem::{Error, Problem};
use super::xml_limits;
use jointplay_format::place::nearest;

/// Longest value that a message quotes, in characters.
pub(super) const MOST_QUOTED: usize = 60;

/// Longest name, in bytes: names of nested models are concatenated, and would grow without bound.
pub(super) const LONGEST_NAME: usize = 1000;

/// Limits of joints from here on mean no limit: mechanism files have none beyond (m, rad).
pub(super) const ENDLESS: f64 = 1e6;

/// Advice for files that xacro has not expanded.
pub(super) const EXPAND_XACRO: Advice = Advice("expand the file first: xacro FILE > robot.urdf");

/// Most elements, texts and comments, about 250 MB of memory; a document of FreeCAD has 20 for each kilobyte.
const MOST_NODES: u32 = 3_000_000;

/// The element tree of a text, or the error of the parser.
pub(super) fn tree(text: &str) -> Result<Document<'_>, roxmltree::Error> {
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options)
}

/// The element tree of a text within the limits.
pub(super) fn document(text: &str) -> Result<Document<'_>, Error> {
    xml_limits::check(text).map_err(|(span, problem)| Error::at(text, span, problem))?;
    tree(text).map_err(|error| {
        let at = error.pos();
        let (row, column) = (at.row.max(1) as usize, at.col.max(1) as usize);
        let lines = text.split_inclusive('\n').take(row);
        let before: usize = lines.clone().take(row - 1).map(str::len).sum();
        let line = lines.last().unwrap_or_default();
        let within = line.char_indices().nth(column - 1).map_or(line.trim_end().len(), |(i, _)| i);
        let message = error.to_string();
        // The message is shown with its place, which it must not repeat.
        let plain = message.rsplit_once(" at ").map_or(message.as_str(), |(plain, _)| plain);
        let place = before + within;
        let what = match error {
            roxmltree::Error::DtdDetected => {
                "a document type cannot be imported: remove `<!DOCTYPE …>`, and replace its entities"
                    .to_owned()
            }
            _ => format!("not well-formed XML: {plain}"),
        };
        Error::at(text, place..place, Problem::Xml(what))
    })
}

/// Whether an element belongs to another vocabulary than the model, by its namespace.
pub(super) fn is_foreign(node: Node) -> bool {
    node.tag_name().namespace() != node.document().root_element().tag_name().namespace()
}

/// The child elements of the model's vocabulary with this name.
pub(super) fn elements<'a>(
    node: Node<'a, 'a>,
    name: &'a str,
) -> impl Iterator<Item = Node<'a, 'a>> {
    children(node).filter(move |child| child.tag_name().name() == name && !is_foreign(*child))
}

/// All child elements of an element.
pub(super) fn children<'a>(node: Node<'a, 'a>) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(Node::is_element)
}

/// Range of an element in the text; messages show its first line.
pub(super) fn place(node: Node) -> Range<usize> {
    node.range()
}

/// Reason why a part is not imported, or a remedy.
pub(super) struct Advice(pub(super) &'static str);

/// A value of an attribute, or the text of an element.
#[derive(Debug, Clone)]
pub(super) struct Value<'a> {
    /// Name of the attribute or element.
    pub(super) what: &'a str,
    /// The value without surrounding white space.
    pub(super) text: &'a str,
    /// Range in the text.
    pub(super) span: Range<usize>,
}

/// The value of an attribute.
pub(super) fn attribute<'a>(node: Node<'a, 'a>, name: &str) -> Option<Value<'a>> {
    let found = node.attribute_node(name)?;
    Some(Value { what: found.name(), text: found.value().trim(), span: found.range_value() })
}

/// The text of an element.
pub(super) fn content<'a>(node: Node<'a, 'a>) -> Value<'a> {
    let text = node
        .children()
        .find(|child| child.is_text() && child.text().is_some_and(|text| !text.trim().is_empty()));
    let (text, span) = match text {
        Some(child) => {
            let (text, range) = (child.text().unwrap_or_default(), child.range());
            let source = &child.document().input_text()[range.clone()];
            let start = range.start + (source.len() - source.trim_start().len());
            (text.trim(), start..range.start + source.trim_end().len())
        }
        None => ("", place(node)),
    };
    Value { what: node.tag_name().name(), text, span }
}

/// The text of the first child with this name.
pub(super) fn child<'a>(node: Node<'a, 'a>, name: &'a str) -> Option<Value<'a>> {
    elements(node, name).next().map(content)
}

/// The text of a model, for the places of errors.
#[derive(Clone, Copy)]
pub(super) struct Xml<'a> {
    pub(super) text: &'a str,
}

impl<'a> Xml<'a> {
    pub(super) fn error(&self, span: Range<usize>, problem: impl Into<Problem>) -> Error {
        Error::at(self.text, span, problem.into())
    }

    pub(super) fn unsupported(
        &self,
        node: Node,
        what: impl Into<String>,
        Advice(advice): Advice,
    ) -> Error {
        let problem = Problem::Unsupported { what: what.into(), advice: advice.to_owned() };
        self.error(place(node), problem)
    }

    pub(super) fn missing(&self, node: Node, what: &'static str) -> Error {
        let whose = node.tag_name().name().to_owned();
        self.error(place(node), Problem::Missing { whose, what })
    }

    /// Error of an invalid value.
    pub(super) fn unusable(&self, value: &Value, expected: &'static str) -> Error {
        if value.text.contains("${") || value.text.contains("$(") {
            let what = format!("an expression of xacro in `{}`", value.what);
            let advice = EXPAND_XACRO.0.to_owned();
            return self.error(value.span.clone(), Problem::Unsupported { what, advice });
        }
        let found = match value.text.char_indices().nth(MOST_QUOTED) {
            Some((end, _)) => format!("{}…", &value.text[..end]),
            None => value.text.to_owned(),
        };
        let problem = Problem::Value { what: value.what.to_owned(), found, expected };
        self.error(value.span.clone(), problem)
    }

    /// Error of an unknown name.
    pub(super) fn unknown<'n>(
        &self,
        what: &'static str,
        value: &Value,
        known: impl Iterator<Item = &'n str> + Clone,
    ) -> Error {
        let problem = Problem::Unknown {
            what,
            found: value.text.chars().take(MOST_QUOTED).collect(),
            nearest: nearest(value.text, known.clone()),
            known: known.map(str::to_owned).collect(),
        };
        self.error(value.span.clone(), problem)
    }

    /// The name of an element, if it has one.
    pub(super) fn name(&self, node: Node<'a, 'a>) -> Result<Option<&'a str>, Error> {
        let Some(value) = attribute(node, "name") else { return Ok(None) };
        self.printable(&value).map(Some)
    }

    /// The name of an element, which is required.
    pub(super) fn needed_name(&self, node: Node<'a, 'a>) -> Result<&'a str, Error> {
        self.name(node)?.ok_or_else(|| self.missing(node, "name"))
    }

    /// A value without control characters.
    pub(super) fn printable(&self, value: &Value<'a>) -> Result<&'a str, Error> {
        if value.text.is_empty() || value.text.chars().any(char::is_control) {
            return Err(self.unusable(value, "a name, not empty and without control characters"));
        }
        if value.text.len() > LONGEST_NAME {
            return Err(self.unusable(value, "a name of at most 1000 bytes"));
        }
        Ok(value.text)
    }

    pub(super) fn truth(&self, value: &Value) -> Result<bool, Error> {
        match value.text {
            "true" | "1" => Ok(true),
            "false" | "0" => Ok(false),
            _ => Err(self.unusable(value, "true or false")),
        }
    }

    /// An end of a range (in the unit of the file); infinite for numbers that mean no limit.
    pub(super) fn bound(&self, value: &Value) -> Result<f64, Error> {
        match value.text.parse::<f64>() {
            Ok(bound) if bound.abs() >= ENDLESS => Ok(f64::INFINITY.copysign(bound)),
            Ok(bound) if bound.is_finite() => Ok(bound),
            _ => Err(self.unusable(value, "a number")),
        }
    }

    pub(super) fn number(&self, value: &Value) -> Result<f64, Error> {
        let [number] = self.numbers(value, "a number")?;
        Ok(number)
    }

    pub(super) fn vector(&self, value: &Value) -> Result<Vector3<f64>, Error> {
        self.numbers(value, "3 numbers").map(Vector3::from)
    }

    pub(super) fn numbers<const N: usize>(
        &self,
        value: &Value,
        expected: &'static str,
    ) -> Result<[f64; N], Error> {
        let numbers: Result<Vec<f64>, _> = value.text.split_whitespace().map(str::parse).collect();
        let numbers = numbers.ok().filter(|numbers| numbers.iter().all(|n| n.is_finite()));
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        numbers.ok_or_else(|| self.unusable(value, expected))
    }

    pub(super) fn direction(&self, value: &Value) -> Result<Unit<Vector3<f64>>, Error> {
        self.unit(value, self.vector(value)?)
    }

    /// The direction of a vector that was read from a value.
    pub(super) fn unit(
        &self,
        value: &Value,
        vector: Vector3<f64>,
    ) -> Result<Unit<Vector3<f64>>, Error> {
        let largest = vector.amax();
        if largest == 0.0 {
            return Err(self.unusable(value, "a direction that is not 0"));
        }
        // Divided first, because squares of very large or small numbers overflow or underflow.
        Ok(Unit::new_normalize(vector / largest))
    }

    /// The rotation of a quaternion, its real part first.
    pub(super) fn quaternion(
        &self,
        value: &Value,
        [w, x, y, z]: [f64; 4],
    ) -> Result<Rotation3<f64>, Error> {
        let largest = [w, x, y, z].into_iter().map(f64::abs).fold(0.0, f64::max);
        if largest == 0.0 {
            return Err(self.unusable(value, "a quaternion that is not 0"));
        }
        let quaternion = Quaternion::new(w, x, y, z) / largest;
        Ok(UnitQuaternion::new_normalize(quaternion).to_rotation_matrix())
    }
}
