//! Elements of XML files.

use std::fmt::Write as _;

use jointplay_plot::escape_xml;
use nalgebra::{Rotation3, UnitQuaternion, Vector3};

/// A file in progress, with the depth of its next element.
pub(crate) struct Xml {
    pub(crate) text: String,
    open: Vec<&'static str>,
}

impl Xml {
    pub(crate) fn new() -> Self {
        Self { text: "<?xml version=\"1.0\"?>\n".to_owned(), open: Vec::new() }
    }

    fn start(&mut self, tag: &str, attributes: &[(&str, String)], end: &str) {
        let indent = "  ".repeat(self.open.len());
        let _ = write!(self.text, "{indent}<{tag}");
        for (name, value) in attributes {
            let _ = write!(self.text, " {name}=\"{}\"", escape_xml(value));
        }
        self.text.push_str(end);
    }

    /// An element without contents.
    pub(crate) fn empty(&mut self, tag: &str, attributes: &[(&str, String)]) {
        self.start(tag, attributes, "/>\n");
    }

    /// An element with text.
    pub(super) fn with_text(&mut self, tag: &str, attributes: &[(&str, String)], text: &str) {
        self.start(tag, attributes, ">");
        let _ = writeln!(self.text, "{}</{tag}>", escape_xml(text));
    }

    /// Opens an element; [`Xml::close`] closes it.
    pub(crate) fn open(&mut self, tag: &'static str, attributes: &[(&str, String)]) {
        self.start(tag, attributes, ">\n");
        self.open.push(tag);
    }

    /// Closes the element opened last.
    pub(crate) fn close(&mut self) {
        if let Some(tag) = self.open.pop() {
            let indent = "  ".repeat(self.open.len());
            let _ = writeln!(self.text, "{indent}</{tag}>");
        }
    }
}

/// Numbers with spaces between them, each the shortest decimal of its value.
pub(super) fn numbers(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|&value| number(value)).collect();
    texts.join(" ")
}

/// The shortest decimal of a value, without a negative zero.
pub(crate) fn number(value: f64) -> String {
    let value = value + 0.0;
    let size = value.abs();
    if size == 0.0 || (1e-5..1e15).contains(&size) {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

pub(super) fn vector(vector: &Vector3<f64>) -> String {
    numbers(vector.as_slice())
}

/// Unit quaternion w, x, y, z.
pub(super) fn quaternion(rotation: &Rotation3<f64>) -> String {
    let q = UnitQuaternion::from_rotation_matrix(rotation);
    numbers(&[q.w, q.i, q.j, q.k])
}

/// Angles about fixed x, y, z (rad).
pub(super) fn roll_pitch_yaw(rotation: &Rotation3<f64>) -> String {
    let (roll, pitch, yaw) = rotation.euler_angles();
    numbers(&[roll, pitch, yaw])
}
