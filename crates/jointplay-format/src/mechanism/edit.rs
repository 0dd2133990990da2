//! Changes of a mechanism file that keep its comments.

use jointplay_core::mechanism::{Mechanism, VirtualJoint, VirtualMotion};
use nalgebra::{Unit, Vector3};
use toml_edit::{DocumentMut, Item, Value};

use super::problem::{Error, Problem};
use super::values::Units;
use super::write::write_virtual_joint;
use crate::file_problem::FileProblem;
use crate::line_ends;
use crate::place::Form;

/// Directions in files have components of this resolution, and points of this many metres.
const RESOLUTION: f64 = 1e-12;

/// Replaces the virtual joints in the text of a mechanism file; everything else remains, including comments and order.
///
/// The new virtual joints are at the end of the file.
/// Where the file has no virtual joints of its own and no parameter is replaced, its text remains to the byte.
/// Characters that names in files cannot have are replaced by spaces.
///
/// # Arguments
/// * `mechanism` – the mechanism of the file, whose joints the virtual joints refer to
/// * `units` – the units of the file
/// * `replaced` – names of parameters of the file, and their new values in its units
///
/// # Errors
/// For text that is no TOML.
pub fn with_virtual_joints(
    text: &str,
    mechanism: &Mechanism,
    units: Units,
    virtual_joints: &[VirtualJoint],
    replaced: &[(String, f64)],
) -> Result<String, Error> {
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        let message = error.message().replace('\n', " ");
        let span = error.span().unwrap_or(0..0);
        Error::at(text, span, Problem::from(FileProblem::from(Form::Malformed { message })))
    })?;
    let removed = document.remove("virtual_joint").is_some();
    for (name, value) in replaced {
        if let Some(Item::Value(old)) =
            document.get_mut("parameters").and_then(|it| it.get_mut(name))
        {
            let decor = old.decor().clone();
            *old = Value::from(*value);
            *old.decor_mut() = decor;
        }
    }
    let unchanged = !removed && replaced.is_empty();
    let mut written = if unchanged { text.to_owned() } else { document.to_string() };
    if !written.is_empty() && !written.ends_with('\n') {
        written.push('\n');
    }
    let mut names: Vec<String> = mechanism.joints().iter().map(|one| one.name.clone()).collect();
    for joint in virtual_joints {
        let mut tidy = VirtualJoint { motion: rounded(joint.motion), ..joint.clone() };
        tidy.name = valid_name(&joint.name, &names);
        names.push(tidy.name.clone());
        write_virtual_joint(&mut written, mechanism, &tidy, units);
    }
    Ok(line_ends::as_before(written, text))
}

/// A name that files accept and that differs from all others.
fn valid_name(name: &str, others: &[String]) -> String {
    let valid: String = name
        .chars()
        .map(|one| if matches!(one, ',' | '=' | '[' | ']') { ' ' } else { one })
        .collect();
    let mut numbered = valid.clone();
    let mut number = 2;
    while others.contains(&numbered) {
        numbered = format!("{valid} {number}");
        number += 1;
    }
    numbered
}

/// A motion without the round-off of its numbers.
fn rounded(motion: VirtualMotion) -> VirtualMotion {
    // Zero has no sign.
    let round = |x: f64| (x / RESOLUTION).round() * RESOLUTION + 0.0;
    let decimal = |x: f64| format!("{:.12}", round(x)).parse().unwrap_or(x) + 0.0;
    let direction = |axis: Unit<Vector3<f64>>| Unit::new_unchecked(axis.map(decimal));
    match motion {
        VirtualMotion::Slide(axis) => VirtualMotion::Slide(direction(axis)),
        VirtualMotion::Turn { axis, point } => {
            VirtualMotion::Turn { axis: direction(axis), point: point.map(decimal) }
        }
    }
}

#[cfg(test)]
mod tests {
    use jointplay_core::mechanism::Carrier;

    use super::*;
    use crate::mechanism::parse;

    const FILE: &str = "# A window.\nkind = \"mechanism\"\nname = \"window\"\nunits = { length = \"mm\", angle = \"deg\" }\nbase = \"wall\"\n\n[[virtual_joint]] # measured\nname = \"old\"\njoint = \"hinge\"\nslide = [1, 0, 0]\n\n[parameters]\nwidth = 900 # as built\n\n[[joint]] # oiled\nname = \"hinge\"\nkind = \"revolute\"\nlinks = [\"wall\", \"leaf, left\"]\npoint = [\"width\", 0, 0]\naxis = [0, 0, 1]\n";

    fn joints() -> [VirtualJoint; 2] {
        let joint = |name: &str, motion| VirtualJoint {
            name: name.to_owned(),
            joint: 0,
            carrier: Carrier::First,
            motion,
            clearance: None,
            stiffness: None,
        };
        let axis = Unit::new_normalize(Vector3::new(1.0, 1e-17, 1.0));
        [
            joint("slide of leaf, left", VirtualMotion::Slide(axis)),
            VirtualJoint {
                clearance: Some(0.01_f64.to_radians()),
                ..joint(
                    "hinge",
                    VirtualMotion::Turn { axis, point: Vector3::new(0.9, 0.1, -1e-19) },
                )
            },
        ]
    }

    #[test]
    fn everything_but_the_virtual_joints_remains() {
        let file = parse(FILE).unwrap();
        let written =
            with_virtual_joints(FILE, &file.mechanism, file.units, &joints(), &[]).unwrap();
        let (before, after) = FILE.split_once("[[virtual_joint]]").unwrap();
        let after = &after[after.find("[parameters]").unwrap()..];
        assert!(written.starts_with(before.trim_end()), "{written}");
        assert!(written.contains(after), "{written}");
        assert!(!written.contains("measured"), "{written}");
        let read = parse(&written).unwrap().mechanism;
        let [slide, turn] = read.virtual_joints() else { panic!("{written}") };
        assert_eq!((slide.name.as_str(), turn.name.as_str()), ("slide of leaf  left", "hinge 2"));
        let VirtualMotion::Turn { axis, point } = turn.motion else { panic!("{written}") };
        assert!(
            (axis.into_inner() - Vector3::new(0.5, 0.0, 0.5).scale(2.0_f64.sqrt())).amax() < 1e-12
        );
        assert!((point - Vector3::new(0.9, 0.1, 0.0)).amax() < 1e-15);
        assert!((turn.clearance.unwrap() - 0.01_f64.to_radians()).abs() < 1e-15);
        assert!(written.contains("about = [900.0, 100.0, 0.0]\nclearance = 0.01\n"), "{written}");
    }

    #[test]
    fn text_without_virtual_joints_remains_to_the_byte() {
        let text = FILE.replace("[[virtual_joint]] # measured\nname = \"old\"\njoint = \"hinge\"\nslide = [1, 0, 0]\n\n", "");
        let text = text.replace('\n', "\r\n");
        let file = parse(&text).unwrap();
        let written =
            with_virtual_joints(&text, &file.mechanism, file.units, &joints(), &[]).unwrap();
        assert!(written.starts_with(&text));
        assert_eq!(written.matches('\n').count(), written.matches("\r\n").count());
        assert_eq!(parse(&written).unwrap().mechanism.virtual_joints().len(), 2);
    }

    #[test]
    fn replaced_parameters_are_in_the_file() {
        let file = parse(FILE).unwrap();
        let replaced = [("width".to_owned(), 700.0)];
        let written =
            with_virtual_joints(FILE, &file.mechanism, file.units, &joints(), &replaced).unwrap();
        assert!(written.contains("width = 700.0 # as built"), "{written}");
    }
}
