//! Where the path of a reference ends: in which frame a placement is.

use super::document::{ASSEMBLY, Document, Object, SUB_ASSEMBLY};
use crate::import::problem::Error;

/// Where a path of names continues after an object.
pub(super) enum PathEnd {
    /// Nowhere: placements are in the frame of this object.
    Here,
    /// In the object.
    Inside,
    /// In an object of another file.
    OtherFile,
}

/// # Arguments
/// * `next` – the next name of the path
pub(super) fn end_of<'a>(
    document: &Document<'a>,
    object: &Object<'a>,
    next: Option<&&'a str>,
) -> Result<PathEnd, Error> {
    let has_next_as_datum = |body: &Object<'a>| {
        let group = document.group(body)?;
        let found = group.iter().find(|inner| next.is_some_and(|next| inner.name == *next));
        Ok::<bool, Error>(found.is_some_and(|inner| is_datum(inner)))
    };
    let within = |object: &Object<'a>| {
        let continues = match object.kind {
            "PartDesign::Body" => has_next_as_datum(object)?,
            _ => is_container(object) || is_group(object),
        };
        Ok(if continues { PathEnd::Inside } else { PathEnd::Here })
    };
    if !matches!(object.kind, "App::Link" | "App::LinkPython" | "App::LinkElement") {
        return within(object);
    }
    match document.reference(object, "LinkedObject")? {
        Some(linked) if !linked.file.is_empty() => Ok(PathEnd::OtherFile),
        _ => match document.link(object, "LinkedObject")? {
            Some(linked) => within(linked),
            None => Ok(PathEnd::Inside),
        },
    }
}

/// A folder of the tree, which places nothing.
pub(super) fn is_group(object: &Object) -> bool {
    let kind = object.kind;
    kind.starts_with("App::DocumentObjectGroup")
        || kind == "App::LinkGroup"
        || (kind.starts_with("Assembly::") && kind.ends_with("Group"))
}

/// An object with others that move with it.
fn is_container(object: &Object) -> bool {
    matches!(object.kind, "App::Part" | ASSEMBLY | SUB_ASSEMBLY)
}

/// A sketch, plane, line or point of a body, in whose own frame placements are.
fn is_datum(object: &Object) -> bool {
    matches!(
        object.kind,
        "Sketcher::SketchObject"
            | "PartDesign::Plane"
            | "PartDesign::Line"
            | "PartDesign::Point"
            | "PartDesign::CoordinateSystem"
            | "Part::DatumPlane"
            | "Part::DatumLine"
            | "Part::DatumPoint"
            | "Part::LocalCoordinateSystem"
            | "App::Plane"
            | "App::Line"
            | "App::Point"
            | "App::LocalCoordinateSystem"
    )
}
