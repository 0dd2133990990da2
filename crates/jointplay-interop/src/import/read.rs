//! Import of a mechanism from the text of a model.

use std::collections::BTreeSet;

use jointplay_format::mechanism::{LengthUnit, MAX_BYTES};
use roxmltree::Document;

use super::draft::Draft;
use super::freecad::{MAX_DOCUMENT_BYTES, asmt, assembly};
use super::loops::{LoopFile, LoopsError};
use super::model::Imported;
use super::problem::{Error, Problem};
use super::repair::repaired;
use super::xml::{Advice, Xml};
use super::{mjcf, sdf, urdf, xml};

/// Whether a text is XML or an assembly of FreeCAD, and so a model instead of a mechanism file.
#[must_use]
pub fn is_model(text: &str) -> bool {
    is_assembly(text) || text.trim_start_matches('\u{feff}').trim_start().starts_with('<')
}

/// Whether a text is an assembly of FreeCAD, which does not state its unit of length.
#[must_use]
pub fn is_assembly(text: &str) -> bool {
    let first = text.trim_start_matches('\u{feff}').lines().next();
    first.is_some_and(|line| asmt::FIRST_LINES.contains(&line.trim()))
}

/// Whether a text is a picture (SVG), which is XML but no model.
#[must_use]
pub fn is_picture(text: &str) -> bool {
    begins_with(text, "<svg")
}

/// Whether a text may be that of a document of FreeCAD, which is longer than other models.
fn is_document(text: &str) -> bool {
    begins_with(text, "<Document")
}

/// Whether XML begins with an element, after only declarations and comments.
fn begins_with(text: &str, element: &str) -> bool {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let end = match rest {
            _ if rest.starts_with("<?") => "?>",
            _ if rest.starts_with("<!--") => "-->",
            _ if rest.starts_with("<!DOCTYPE") => ">",
            _ => return rest.starts_with(element),
        };
        let Some((_, after)) = rest.split_once(end) else { return false };
        rest = after.trim_start();
    }
}

/// Imports a model, whose root element determines its format.
///
/// # Errors
/// [`Error`] with its place: malformed XML, invalid values, or unsupported parts that would affect the mechanism; an assembly of FreeCAD, which does not state its unit, see [`parse_with_unit`].
///
/// # Source
/// \[ASMT\], \[MJCF\], \[SDFormat\], \[URDF\]
pub fn parse(text: &str) -> Result<Imported, Error> {
    open(text, None)
}

/// Imports a model as [`parse`] does, with the unit of lengths for assemblies, which do not state theirs.
///
/// XML models state their units, or their formats do.
///
/// # Errors
/// Those of [`parse`].
pub fn parse_with_unit(text: &str, unit: LengthUnit) -> Result<Imported, Error> {
    open(text, Some(unit))
}

/// Imports a model without a file of loops.
fn open(text: &str, unit: Option<LengthUnit>) -> Result<Imported, Error> {
    accepted(read(text, unit, &BTreeSet::new())?, text)
}

/// A model with names and numbers that mechanism files allow.
fn accepted(model: Imported, text: &str) -> Result<Imported, Error> {
    model.check_numbers().map_err(|problem| Error::at(text, 0..0, problem))?;
    model.with_allowed_names().map_err(|error| Error::at(text, 0..0, error.into()))
}

/// Error of a model, or of the file that closes its loops.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClosedError {
    /// Error of the model.
    #[error(transparent)]
    Model(#[from] Error),
    /// Error of the file of loops.
    #[error(transparent)]
    Loops(#[from] LoopsError),
}

/// Imports a model as [`parse`] does, and closes its loops by a second file, for formats such as URDF that have trees only.
///
/// The file is a TOML file of loops, see [`jointplay_format::mechanism::with_loops`], or YAML of other programs:
/// with the key `closures`, of exporters of SolidWorks, or with `closed_loop`, of the robot collections of Pinocchio.
///
/// # Arguments
/// * `unit` – unit of lengths for assemblies, which do not state theirs
/// * `loops` – text of the second file
///
/// # Errors
/// [`ClosedError`].
///
/// # Example
/// ```
/// let chain = r#"<robot name="pair">
///     <link name="base"/><link name="left"/><link name="right"/><link name="tip"/>
///     <joint name="a" type="continuous"><parent link="base"/><child link="left"/></joint>
///     <joint name="b" type="continuous"><parent link="base"/><child link="right"/></joint>
///     <joint name="end" type="fixed"><origin xyz="0 0 1"/><parent link="left"/><child link="tip"/></joint>
/// </robot>"#;
/// let loops = "closed_loop: [[right, tip]]\ntype: ['3d']\nname_mot: [a]\n";
/// let model = jointplay_interop::import::parse_closed(chain, None, loops)?;
/// assert_eq!(model.mechanism.loops(), 1);
/// # Ok::<(), jointplay_interop::import::ClosedError>(())
/// ```
///
/// # Source
/// \[LoopClosures\], \[ParallelRobots\]
pub fn parse_closed(
    text: &str,
    unit: Option<LengthUnit>,
    loops: &str,
) -> Result<Imported, ClosedError> {
    let file = LoopFile::parse(loops)?;
    let Imported { mechanism, dialect, mut ignored } = read(text, unit, &file.solved())?;
    let mechanism = file.close(&mechanism, &mut ignored)?;
    // After the loops are closed: their file refers to joints by the names in the model.
    Ok(accepted(Imported { mechanism, dialect, ignored }, text)?)
}

/// Imports a model.
///
/// # Arguments
/// * `solved` – joints that the loops of a second file determine
fn read(text: &str, unit: Option<LengthUnit>, solved: &BTreeSet<&str>) -> Result<Imported, Error> {
    let allowed = if is_document(text) { MAX_DOCUMENT_BYTES } else { MAX_BYTES };
    if text.len() > allowed {
        let problem = Problem::TooLong { found: text.len(), allowed };
        return Err(Error::at(text, 0..0, problem));
    }
    if is_assembly(text) {
        let first = 0..text.lines().next().map_or(0, str::len);
        let unit = unit.ok_or_else(|| Error::at(text, first, Problem::NoUnit))?;
        return asmt::read(text, unit);
    }
    match xml::document(text) {
        Ok(document) => read_document(text, &document, solved),
        Err(error) if !matches!(*error.problem, Problem::Xml(_)) => Err(error),
        Err(error) => {
            let text = repaired(text).ok_or(error)?;
            read_document(&text, &xml::document(&text)?, solved)
        }
    }
}

fn read_document(
    text: &str,
    document: &Document<'_>,
    solved: &BTreeSet<&str>,
) -> Result<Imported, Error> {
    let root = document.root_element();
    let draft = Draft::new(Xml { text }, root);
    match root.tag_name().name() {
        "mujoco" => mjcf::read(draft, root),
        "sdf" => sdf::read(draft, root),
        "robot" => urdf::read(draft, root, solved),
        "Document" => assembly::read(draft, root),
        other => Err(draft.xml.unsupported(
            root,
            format!("a file of <{other}>"),
            Advice(
                "models are <mujoco> (MJCF), <sdf> (SDF), <robot> (URDF) and <Document> (FCStd)",
            ),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing;
    use super::*;
    use jointplay_format::mechanism;

    #[test]
    fn deep_trees_do_not_overflow_the_stack() {
        let deep = |open: &str, close: &str, count: usize| {
            format!("{}{}", open.repeat(count), close.repeat(count))
        };
        let mjcf = |inner: String| format!("<mujoco><worldbody>{inner}</worldbody></mujoco>");
        let tree = parse(&mjcf(deep("<body>", "</body>", 900))).unwrap();
        assert_eq!(tree.mechanism.joints().len(), 900);
        let refuse = |text: String, message: &str| {
            let error = parse(&text).unwrap_err();
            assert!(error.to_string().contains(message), "{error}");
        };
        for (open, close) in [("<body>", "</body>"), ("<frame>", "</frame>")] {
            refuse(mjcf(deep(open, close, 100_000)), "more than 1000 deep");
        }
        let models = |count| deep("<model name=\"m\">", "</model>", count);
        let sdf = |inner: String| format!("<sdf version=\"1.9\">{inner}</sdf>");
        refuse(sdf(models(100_000)), "more than 1000 deep");
        refuse(sdf(models(900)), "at most 1000 bytes long, together");
    }

    /// Before, each of these files of less than 4 MB took minutes, in time that grows with the square or the cube of its length.
    #[test]
    fn elements_with_thousands_of_attributes_or_namespaces_are_refused() {
        let attributes: String = (0..300_000).map(|k| format!(" a{k}=\"\"")).collect();
        let (open, close) = ((0..20_000).map(|k| format!("<a xmlns:n{k}=\"u{k}\">")), "</a>");
        let nested = format!(
            "<robot name=\"r\">{}{}</robot>",
            open.collect::<String>(),
            close.repeat(20_000)
        );
        for (text, message) in [
            (format!("<mujoco><a{attributes}/></mujoco>"), "at most 256 attributes of an element"),
            (nested, "at most 64 namespaces around an element"),
        ] {
            let error = parse(&text).unwrap_err();
            assert!(error.to_string().contains(message), "{error}");
        }
    }

    #[test]
    fn places_are_correct_after_entities_and_other_line_ends() {
        let sdf = "<sdf version=\"1.9\"><model name=\"m\">\r\n<link name=\"l\"><pose>&#32;\u{2003}\u{2003}1 &lt; 3\r\n</pose></link></model></sdf>";
        testing::refuse(sdf, "", "", "&#32;\u{2003}\u{2003}1 &lt; 3", "`pose` is \"1 < 3\"");
    }

    #[test]
    fn long_names_are_rejected() {
        let name = "n".repeat(1001);
        let text = format!("<robot name=\"{name}\"><link name=\"a\"/></robot>");
        assert!(parse(&text).unwrap_err().to_string().contains("at most 1000 bytes"));
    }

    #[test]
    fn numbers_that_a_file_may_not_have_are_refused() {
        let chain = |x: f64| {
            format!(
                "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><joint name=\"j\" type=\"continuous\"><origin xyz=\"0 {x} 0\"/><parent link=\"a\"/><child link=\"b\"/></joint></robot>"
            )
        };
        for x in [1e6, -1e6] {
            let model = parse(&chain(x)).unwrap();
            let read = mechanism::parse(&mechanism::write(&model.mechanism, None)).unwrap();
            assert_eq!(read.mechanism.joints(), model.mechanism.joints());
        }
        let error = parse(&chain(1_000_001.0)).unwrap_err().to_string();
        let expected = "the position (m) of \"j\" is 1000001, but has to be within ±1e6";
        assert!(error.contains(expected), "{error}");
    }

    #[test]
    fn numbers_too_large_have_the_place_of_their_element() {
        let model = "<robot name=\"r\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>
<joint name=\"i\" type=\"continuous\"><parent link=\"a\"/><child link=\"b\"/></joint>
  <joint name=\"j\" type=\"continuous\"><origin xyz=\"2e6 0 0\"/><parent link=\"a\"/><child link=\"c\"/></joint>
</robot>";
        let error = parse(model).unwrap_err();
        assert_eq!((error.place.line, error.place.column), (3, 3), "{error}");
        let body = "<mujoco><worldbody>\n<body><joint name=\"i\"/><geom size=\"1\"/>
<body name=\"far\" pos=\"0 0 -3e6\"><joint name=\"j\"/></body></body></worldbody></mujoco>";
        assert_eq!(parse(body).unwrap_err().place.line, 3);
        let coupled = "<mujoco><worldbody><body><joint name=\"i\"/>\n<body><joint name=\"j\"/></body></body></worldbody>
<equality>\n<joint joint1=\"i\" joint2=\"j\" polycoef=\"0 1e15 0 0 0\"/></equality></mujoco>";
        assert_eq!(parse(coupled).unwrap_err().place.line, 4);
    }

    #[test]
    fn models_with_a_document_type_are_refused_for_it() {
        let text =
            "<!DOCTYPE robot [<!ENTITY a \"b\">]>\n<robot name=\"&a;\"><link name=\"a\"/></robot>";
        let error = parse(text).unwrap_err().to_string();
        assert!(error.contains("remove `<!DOCTYPE") && !error.contains("well-formed"), "{error}");
    }

    #[test]
    fn long_models_are_rejected() {
        let text = format!("<robot name=\"r\">{}</robot>", " ".repeat(MAX_BYTES));
        assert!(parse(&text).unwrap_err().to_string().contains("at most 4000000 are allowed"));
    }
}
