//! Mechanisms of requests: texts, checked and parsed.

use std::collections::BTreeMap;

use jointplay::format::coordinates::Coordinates;
use jointplay::format::mechanism::{self, MechanismFile};
use jointplay::format::place::{Error, Errors};
use jointplay::format::{robot, three_rods};
use jointplay::interop::FileKind;
use jointplay::interop::import::{self, ClosedError, Imported, LoopsError};
use jointplay::nalgebra::DVector;
use jointplay::virtualization::BuiltIn;

use crate::problem::Problem;
use crate::wire::mechanism_view::{FileKindName, MechanismDiagnostic, MechanismSource};

/// A parsed mechanism.
pub(crate) struct ReadMechanism {
    pub(crate) kind: FileKind,
    pub(crate) file: MechanismFile,
    pub(crate) coordinates: Coordinates,
    /// The text as a mechanism file.
    pub(crate) text: String,
    /// What was converted or ignored.
    pub(crate) note: Option<String>,
}

/// Why a text is no mechanism.
pub(crate) enum Unread {
    /// It has errors.
    Invalid(Vec<MechanismDiagnostic>),
    /// It is a file of another kind.
    OtherKind(FileKind),
}

impl From<Option<FileKind>> for FileKindName {
    fn from(kind: Option<FileKind>) -> Self {
        match kind {
            Some(FileKind::Mechanism) => Self::Mechanism,
            Some(FileKind::Model) => Self::Model,
            Some(FileKind::ThreeRods) => Self::ThreeRods,
            Some(FileKind::Arms) => Self::Arms,
            Some(FileKind::Cell) => Self::Cell,
            Some(FileKind::Study) => Self::Study,
            Some(FileKind::Loops) => Self::Loops,
            Some(FileKind::Program) => Self::Program,
            None | Some(FileKind::Part | FileKind::Picture | FileKind::Fmu) => Self::Unknown,
        }
    }
}

/// What a file of a kind without a view of mechanisms is, and how it is opened.
pub(crate) fn how_to_open(kind: FileKind) -> String {
    let how = match kind {
        FileKind::Cell => "open it with `jointplay studio FILE`",
        FileKind::Arms => "a work cell refers to it by its key `robot`",
        FileKind::Part => "a work cell refers to it in a table `[[part]]`",
        FileKind::Program => "open its work cell with `jointplay studio FILE`",
        FileKind::Picture | FileKind::Fmu => "jointplay does not read it",
        FileKind::Study => "run it with `jointplay study FILE`",
        FileKind::Loops => "open the model whose loops it closes, then this file",
        FileKind::Mechanism | FileKind::Model | FileKind::ThreeRods => "open it here",
    };
    format!("This is {}, and not a mechanism: {how}.", kind.noun())
}

fn diagnostic<P: std::fmt::Display>(error: &Error<P>, in_loops: bool) -> MechanismDiagnostic {
    let place = &error.place;
    MechanismDiagnostic {
        in_loops,
        line: place.line,
        column: place.column,
        width: place.width,
        message: error.to_string(),
    }
}

/// An error of a whole text.
fn of_whole(message: String, in_loops: bool) -> MechanismDiagnostic {
    MechanismDiagnostic { in_loops, line: 1, column: 1, width: 0, message }
}

fn all<P: std::fmt::Display>(errors: &Errors<P>, in_loops: bool) -> Unread {
    Unread::Invalid(errors.iter().map(|error| diagnostic(error, in_loops)).collect())
}

/// Reads a mechanism.
pub(crate) fn read(source: &MechanismSource) -> Result<ReadMechanism, Unread> {
    let kind = FileKind::detect(&source.text);
    let replaced: Vec<(String, f64)> =
        source.parameters.iter().map(|(name, &value)| (name.clone(), value)).collect();
    let (file, text, note) = match kind {
        None | Some(FileKind::Mechanism) => {
            let file = mechanism::parse_with(&source.text, &replaced)
                .map_err(|errors| all(&errors, false))?;
            (file, source.text.clone(), None)
        }
        Some(FileKind::ThreeRods) => {
            let robot =
                robot::parse_with(&source.text, &replaced).map_err(|errors| all(&errors, false))?;
            let file = three_rods::mechanism_file(&robot, BuiltIn::Planar)
                .expect("the planar virtualization has slides");
            let note = "This is a three-rod robot, shown as a mechanism with the virtual joints of the planar model; `jointplay studio FILE` opens it in the robot view.";
            let text = mechanism::write(&file.mechanism, file.source.as_deref());
            (file, text, Some(note.to_owned()))
        }
        Some(FileKind::Model) => {
            if let Some((name, _)) = replaced.first() {
                let message = format!(
                    "parameter {name:?}: a model has no parameters; the mechanism file that it is converted to can have them"
                );
                return Err(Unread::Invalid(vec![of_whole(message, false)]));
            }
            let model = model(source)?;
            let note = imported_note(&model);
            let text = mechanism::write(&model.mechanism, None);
            (model.into_file(), text, Some(note))
        }
        Some(other) => return Err(Unread::OtherKind(other)),
    };
    let kind = kind.unwrap_or(FileKind::Mechanism);
    let coordinates = Coordinates::of(&file);
    Ok(ReadMechanism { kind, file, coordinates, text, note })
}

fn model(source: &MechanismSource) -> Result<Imported, Unread> {
    let invalid =
        |error: &import::Error, in_loops| Unread::Invalid(vec![diagnostic(error, in_loops)]);
    match &source.loops {
        None => import::parse(&source.text).map_err(|error| invalid(&error, false)),
        Some(loops) => {
            import::parse_closed(&source.text, None, loops).map_err(|error| match error {
                ClosedError::Model(error) => invalid(&error, false),
                ClosedError::Loops(LoopsError::Toml(errors)) => all(&errors, true),
                ClosedError::Loops(LoopsError::Yaml(error)) => invalid(&error, true),
                other => Unread::Invalid(vec![of_whole(other.to_string(), true)]),
            })
        }
    }
}

fn imported_note(model: &Imported) -> String {
    let mut note = format!("Converted from {} to a mechanism file.", model.dialect.name());
    if !model.ignored.is_empty() {
        note += &format!(" Ignored: {}.", model.ignored.join(", "));
    }
    if model.mechanism.loops() == 0 {
        note += " The model has no loops; open the file that closes them, if there is one.";
    }
    note
}

/// Reads the mechanism of a request that needs one.
pub(crate) fn required(source: &MechanismSource) -> Result<ReadMechanism, Problem> {
    read(source).map_err(|unread| match unread {
        Unread::Invalid(found) => {
            let lines = found.iter().map(|one| format!("line {}: {}", one.line, one.message));
            let in_loops = found.iter().any(|one| one.in_loops);
            let field = if in_loops { "mechanism.loops" } else { "mechanism.text" };
            Problem::field(field, lines.collect::<Vec<_>>().join("\n"))
        }
        Unread::OtherKind(kind) => Problem::field("mechanism.text", how_to_open(kind)),
    })
}

impl ReadMechanism {
    /// (f + M) coordinates of a request (m, rad).
    pub(crate) fn checked(&self, values: &[f64], field: &str) -> Result<DVector<f64>, Problem> {
        let expected = self.coordinates.all().len();
        if values.len() != expected {
            let detail = format!("expected {expected} coordinates, found {}", values.len());
            return Err(Problem::field(field, detail));
        }
        for (k, &value) in values.iter().enumerate() {
            self.coordinates
                .checked(k, value)
                .map_err(|error| Problem::field(format!("{field}[{k}]"), error.to_string()))?;
        }
        Ok(DVector::from_row_slice(values))
    }

    /// Coordinates by name, with their texts: expressions in the units of the file.
    pub(crate) fn commands(
        &self,
        texts: &BTreeMap<String, String>,
        field: &str,
    ) -> Result<Vec<(usize, f64)>, Problem> {
        let names = jointplay::format::command::Names::of(&self.file);
        let mut commands = BTreeMap::new();
        for (name, text) in texts {
            let failed = |why: String| Problem::field(format!("{field}.{name}"), why);
            let k = self
                .coordinates
                .find(&self.file.mechanism, name)
                .map_err(|error| failed(error.to_string()))?;
            let text = typed(text, &format!("{field}.{name}"))?;
            let value = jointplay::format::command::CommandValue::parse(text, &names)
                .map_err(|error| failed(error.to_string()))?
                .evaluate(self.coordinates.all()[k].quantity, &names, 0.0)
                .map_err(|error| failed(error.to_string()))?;
            let value = self.coordinates.checked(k, value);
            commands.insert(k, value.map_err(|error| failed(error.to_string()))?);
        }
        Ok(commands.into_iter().collect())
    }
}

/// Longest text of a value (bytes).
const LONGEST: usize = 1000;

/// Checks the length of the text of a value; messages quote it.
pub(crate) fn typed<'a>(text: &'a str, field: &str) -> Result<&'a str, Problem> {
    if text.len() <= LONGEST {
        return Ok(text);
    }
    let detail = format!("the text has {} bytes, at most {LONGEST} are allowed", text.len());
    Err(Problem::field(field, detail))
}

/// Checks a play scale.
pub(crate) fn play_scale(factor: f64) -> Result<f64, Problem> {
    if (1.0..=1e9).contains(&factor) {
        return Ok(factor);
    }
    let detail = format!("the play scale must be from 1 to 1e9, got {factor:e}");
    Err(Problem::field("play_scale", detail))
}

/// The problem of a mechanism with too many loops for an analysis.
pub(crate) fn too_large(error: &jointplay::Error) -> Problem {
    Problem::field("mechanism.text", error.to_string())
}
