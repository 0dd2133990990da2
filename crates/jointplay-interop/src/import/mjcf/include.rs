//! `include` of MJCF: the contents of another file in place of the element.

use std::collections::BTreeSet;
use std::ops::Range;

use jointplay_format::mechanism::MAX_BYTES;
use roxmltree::{Document, Node};

use crate::import::problem::{Error, Problem};
use crate::import::xml::{attribute, document};

/// Greatest depth of files that include each other.
const DEEPEST: usize = 32;
/// Most files of a model.
const MOST_FILES: usize = 1024;

/// A model with the files that it includes, as one text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Expanded {
    /// The text without `include`.
    pub text: String,
    /// Names of the included files.
    files: Vec<String>,
    /// For each line of the text, the index of the included file and the line there, from 1; `None` for the model itself.
    lines: Vec<(Option<usize>, usize)>,
}

/// Error of a model or of a file that it includes.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{error}")]
pub struct IncludeError {
    /// Name of the included file; `None` for the model itself.
    pub file: Option<String>,
    /// The error, with its place in this file.
    pub error: Error,
}

impl Expanded {
    /// An error of the whole text at its place in the model or in an included file.
    #[must_use]
    pub fn locate(&self, mut error: Error) -> IncludeError {
        let place = error.place.line.checked_sub(1).and_then(|line| self.lines.get(line));
        let Some(&(file, line)) = place else { return IncludeError { file: None, error } };
        error.place.line = line;
        IncludeError { file: file.map(|file| self.files[file].clone()), error }
    }
}

/// Replaces every `include` of an MJCF model by the contents of its file; other models are returned as they are.
///
/// A name is relative to the folder of the model, or else to that of the including file; each file is included at most once, as in MuJoCo.
///
/// # Arguments
/// * `read` – reads a file by its name relative to the folder of the model, or returns why it does not
///
/// # Errors
/// [`IncludeError`]: a file that is not read, is included twice or by itself, is not MJCF, or a text beyond the size limit.
pub fn expand_includes(
    text: &str,
    read: &mut dyn FnMut(&str) -> Result<String, String>,
) -> Result<Expanded, IncludeError> {
    let mut expansion = Expansion {
        read,
        files: Vec::new(),
        included: BTreeSet::new(),
        bytes: text.len(),
        depth: 0,
    };
    let mut pieces = Pieces::default();
    // A text that is no XML has no includes; its reader reports the error.
    let is_model = document(text).is_ok_and(|found| found.root_element().has_tag_name("mujoco"));
    if is_model {
        expansion.file(text, None, 0..text.len(), &mut pieces)?;
    } else {
        pieces.push(text, 0..text.len(), None);
    }
    let Pieces { text, lines } = pieces;
    Ok(Expanded { text, files: expansion.files, lines })
}

/// The text so far, and the origin of its lines.
#[derive(Default)]
struct Pieces {
    text: String,
    lines: Vec<(Option<usize>, usize)>,
}

impl Pieces {
    /// Adds a part of a file, from a new line on.
    fn push(&mut self, source: &str, part: Range<usize>, file: Option<usize>) {
        if self.text.ends_with('\n') {
            // The empty last line continues in this part.
            self.lines.pop();
        } else if !self.text.is_empty() {
            self.text.push('\n');
        }
        let first = source[..part.start].matches('\n').count() + 1;
        let part = &source[part];
        let count = part.matches('\n').count() + 1;
        self.lines.extend((first..first + count).map(|line| (file, line)));
        self.text.push_str(part);
    }
}

struct Expansion<'r> {
    read: &'r mut dyn FnMut(&str) -> Result<String, String>,
    files: Vec<String>,
    included: BTreeSet<String>,
    /// Bytes read.
    bytes: usize,
    /// Depth of the file that is read.
    depth: usize,
}

impl Expansion<'_> {
    fn failed(
        &self,
        text: &str,
        file: Option<usize>,
        node: Node,
        problem: Problem,
    ) -> IncludeError {
        let error = Error::at(text, node.range(), problem);
        IncludeError { file: file.map(|file| self.files[file].clone()), error }
    }

    /// Adds a part of a file with its includes replaced.
    fn file(
        &mut self,
        text: &str,
        file: Option<usize>,
        part: Range<usize>,
        pieces: &mut Pieces,
    ) -> Result<(), IncludeError> {
        let parsed = document(text).map_err(|error| {
            let file = file.map(|file| self.files[file].clone());
            IncludeError { file, error }
        })?;
        let mut start = part.start;
        let includes = parsed.descendants().filter(|node| node.has_tag_name("include"));
        for node in includes {
            pieces.push(text, start..node.range().start, file);
            start = node.range().end;
            self.include(text, file, node, pieces)?;
        }
        pieces.push(text, start..part.end, file);
        Ok(())
    }

    fn include(
        &mut self,
        text: &str,
        file: Option<usize>,
        node: Node,
        pieces: &mut Pieces,
    ) -> Result<(), IncludeError> {
        let fail = |this: &Self, problem| Err(this.failed(text, file, node, problem));
        let unsupported = |what: String, advice: String| Problem::Unsupported { what, advice };
        if node.children().any(|child| child.is_element()) {
            let advice = "an include has no contents; move them next to it".to_owned();
            return fail(self, unsupported("an <include> with elements in it".to_owned(), advice));
        }
        let Some(name) = attribute(node, "file") else {
            let whose = "include".to_owned();
            return fail(self, Problem::Missing { whose, what: "file" });
        };
        let shown = || format!("<include> of {:?}", name.text);
        if self.files.len() >= MOST_FILES {
            let advice = "a model may include at most 1024 files".to_owned();
            return fail(self, unsupported(shown(), advice));
        }
        if self.depth >= DEEPEST {
            let advice = "files may include each other at most 32 deep".to_owned();
            return fail(self, unsupported(shown(), advice));
        }
        let (path, included) = match self.read_near(name.text, file) {
            Ok(read) => read,
            Err(reason) => return fail(self, unsupported(shown(), reason)),
        };
        if !self.included.insert(path.clone()) {
            let advice = "a file is included at most once".to_owned();
            return fail(self, unsupported(shown(), advice));
        }
        self.bytes += included.len();
        if self.bytes > MAX_BYTES {
            return fail(self, Problem::TooLong { found: self.bytes, allowed: MAX_BYTES });
        }
        let number = self.files.len();
        self.files.push(path);
        let Some(inside) = contents(&included) else {
            // With the place of the error, where the file is no XML at all.
            if let Err(error) = document(&included) {
                return Err(IncludeError { file: self.files.pop(), error });
            }
            let advice = "included files are <mujoco> or <mujocoinclude>".to_owned();
            return fail(self, unsupported(shown(), advice));
        };
        self.depth += 1;
        self.file(&included, Some(number), inside, pieces)?;
        self.depth -= 1;
        Ok(())
    }

    /// Reads a file by its name relative to the model, or else to the including file.
    fn read_near(&mut self, name: &str, by: Option<usize>) -> Result<(String, String), String> {
        let plain = |path: &str| {
            let parts = path.split('/').filter(|part| !matches!(*part, "" | "."));
            // A leading slash remains, so that absolute paths are refused.
            let root = if path.starts_with('/') { "/" } else { "" };
            format!("{root}{}", parts.collect::<Vec<_>>().join("/"))
        };
        let path = plain(name);
        let read = (self.read)(&path);
        let folder = by.and_then(|by| self.files[by].rsplit_once('/')).map(|(folder, _)| folder);
        match (read, folder) {
            (Ok(text), _) => Ok((path, text)),
            (Err(reason), None) => Err(reason),
            (Err(reason), Some(folder)) => {
                let path = plain(&format!("{folder}/{name}"));
                let read = (self.read)(&path).map_err(|_| reason)?;
                Ok((path, read))
            }
        }
    }
}

/// The part of an included file inside its root element; `None` for another root element.
fn contents(text: &str) -> Option<Range<usize>> {
    let parsed: Document = document(text).ok()?;
    let root = parsed.root_element();
    if !matches!(root.tag_name().name(), "mujoco" | "mujocoinclude") {
        return None;
    }
    let start = root.first_child().map_or(0, |child| child.range().start);
    Some(start..root.last_child().map_or(start, |child| child.range().end))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::import::parse;

    const MAIN: &str = "<mujoco>\n  <include file=\"defaults.xml\"/>\n  <worldbody>\n    <include file=\"parts/arm.xml\"/>\n  </worldbody>\n</mujoco>";

    fn folder() -> BTreeMap<&'static str, &'static str> {
        BTreeMap::from([
            ("defaults.xml", "<mujoco><compiler angle=\"radian\"/></mujoco>"),
            (
                "parts/arm.xml",
                "<?xml version=\"1.0\"?>\n<mujocoinclude>\n<body name=\"arm\">\n<joint name=\"j\" range=\"-1 1\"/>\n<include file=\"./hand.xml\"/></body>\n</mujocoinclude>",
            ),
            ("parts/hand.xml", "<mujoco><body name=\"hand\"/></mujoco>"),
            ("self.xml", "<mujoco><include file=\"self.xml\"/></mujoco>"),
            ("svg.xml", "<svg/>"),
            ("cut.xml", "<mujoco>"),
        ])
    }

    fn expand(text: &str, files: &BTreeMap<&str, &str>) -> Result<Expanded, IncludeError> {
        expand_includes(text, &mut |name| {
            files.get(name).map(|text| (*text).to_owned()).ok_or_else(|| format!("no {name}"))
        })
    }

    #[test]
    fn files_are_included_in_place_of_their_elements() {
        let expanded = expand(MAIN, &folder()).unwrap();
        let mechanism = parse(&expanded.text).unwrap().mechanism;
        assert_eq!(mechanism.links(), ["world", "arm", "hand"]);
        // In radians, by the first file.
        assert_eq!(mechanism.joints()[0].limits, [[-1.0, 1.0]]);
        let model = "<robot name=\"r\"><include file=\"x\"/></robot>";
        assert_eq!(expand(model, &folder()).unwrap().text, model);
        assert_eq!(expand("<mujoco", &folder()).unwrap().text, "<mujoco");
    }

    #[test]
    fn errors_have_their_place_in_the_included_file() {
        let mut files = folder();
        let broken = files["parts/arm.xml"].replace("-1 1", "-1 x");
        files.insert("parts/arm.xml", &broken);
        let expanded = expand(MAIN, &files).unwrap();
        let found = expanded.locate(parse(&expanded.text).unwrap_err());
        assert_eq!(found.file.as_deref(), Some("parts/arm.xml"));
        assert_eq!((found.error.place.line, found.error.place.column), (4, 24));
        // After the includes, the lines are those of the model again.
        let late =
            MAIN.replace("  </worldbody>", "  <body><joint range=\"x\"/></body></worldbody>");
        let expanded = expand(&late, &folder()).unwrap();
        let found = expanded.locate(parse(&expanded.text).unwrap_err());
        assert_eq!((found.file, found.error.place.line), (None, 5));
    }

    #[test]
    fn missing_repeated_and_foreign_files_are_refused() {
        let refuse = |file: &str, place: Option<&str>, message: &str| {
            let text = format!(
                "<mujoco><include file=\"{file}\"/><include file=\"defaults.xml\"/><include file=\"./defaults.xml\"/></mujoco>"
            );
            let error = expand(&text, &folder()).unwrap_err();
            assert_eq!(error.file.as_deref(), place, "{error}");
            assert!(error.to_string().contains(message), "{error}");
        };
        refuse("absent.xml", None, "no absent.xml");
        refuse("/defaults.xml", None, "no /defaults.xml");
        refuse("self.xml", Some("self.xml"), "included at most once");
        refuse("svg.xml", None, "<mujoco> or <mujocoinclude>");
        refuse("cut.xml", Some("cut.xml"), "not well-formed XML");
        refuse("parts/hand.xml", None, "included at most once");
        let nested =
            "<mujoco><include file=\"svg.xml\"><include file=\"defaults.xml\"/></include></mujoco>";
        let error = expand(nested, &folder()).unwrap_err();
        assert!(error.to_string().contains("with elements in it"), "{error}");
        let error = expand("<mujoco><include/></mujoco>", &folder()).unwrap_err();
        assert!(error.to_string().contains("`include` needs `file`"), "{error}");
    }

    #[test]
    fn long_chains_and_long_files_are_refused() {
        let error = expand_includes("<mujoco><include file=\"0\"/></mujoco>", &mut |name| {
            let next: usize = name.parse::<usize>().unwrap() + 1;
            Ok(format!("<mujoco><include file=\"{next}\"/></mujoco>"))
        });
        assert!(error.unwrap_err().to_string().contains("at most 32 deep"));
        let long = " ".repeat(MAX_BYTES);
        let error = expand_includes("<mujoco><include file=\"a\"/></mujoco>", &mut |_| {
            Ok(format!("<mujoco>{long}</mujoco>"))
        });
        assert!(error.unwrap_err().to_string().contains("at most 4000000"));
    }
}
