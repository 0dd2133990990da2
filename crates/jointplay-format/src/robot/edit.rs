//! Changes of a robot file that keep its comments.

use toml_edit::{Array, Document, DocumentMut, Item, Table, TableLike, Value};

use super::{Error, Errors, Problem, parse_with, short};
use crate::file_problem::FileProblem;
use crate::line_ends;
use crate::place::Form;
use crate::units::{deg, mm, um};

/// A number of a robot file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Dimension {
    /// A parameter, in the units of the file.
    Parameter(String),
    /// Distance of the socket of a limb from the platform centre; limbs are counted from 0 (m).
    SocketRadius(usize),
    /// Direction of the socket of a limb, counted from x toward y of the platform (rad).
    SocketAngle(usize),
    /// x of the point of a rod in the base plane (m).
    BaseX(usize),
    /// y of the point of a rod in the base plane (m).
    BaseY(usize),
    /// Shortest rod (m).
    RodMin,
    /// Longest rod (m).
    RodMax,
    /// Largest tilt toward any azimuth (rad).
    TiltLimit,
    /// Axis height at which the robot works (m).
    WorkingHeight,
    /// Clearance of the balls, as a radius (m).
    BallClearance,
}

/// Place of a number in a file: its table, its key, and its index in a list.
struct Location {
    table: Place,
    key: String,
    index: Option<usize>,
}

/// A table of a robot file.
enum Place {
    Named(&'static str),
    Limb(usize),
}

impl Dimension {
    fn location(&self) -> Location {
        let location = |table, key: &str, index| Location { table, key: key.to_owned(), index };
        match self {
            Self::Parameter(name) => location(Place::Named("parameters"), name, None),
            &Self::SocketRadius(limb) => location(Place::Limb(limb), "socket_radius_mm", None),
            &Self::SocketAngle(limb) => location(Place::Limb(limb), "socket_angle_deg", None),
            &Self::BaseX(limb) => location(Place::Limb(limb), "base_point_mm", Some(0)),
            &Self::BaseY(limb) => location(Place::Limb(limb), "base_point_mm", Some(1)),
            Self::RodMin => location(Place::Named("limits"), "rod_mm", Some(0)),
            Self::RodMax => location(Place::Named("limits"), "rod_mm", Some(1)),
            Self::TiltLimit => location(Place::Named("limits"), "tilt_deg", None),
            Self::WorkingHeight => location(Place::Named("working"), "height_mm", None),
            Self::BallClearance => location(Place::Named("ball"), "clearance_radius_um", None),
        }
    }

    /// A value in the unit of the file.
    fn in_file(&self, value: f64) -> f64 {
        match self {
            Self::Parameter(_) => value,
            Self::SocketAngle(_) | Self::TiltLimit => short(deg(value)),
            Self::BallClearance => short(um(value)),
            _ => short(mm(value)),
        }
    }
}

/// The numbers of a robot file that users may change.
#[derive(Debug, Clone, PartialEq)]
pub struct Dimensions {
    /// Parameters that are numbers, with their values in the units of the file.
    pub parameters: Vec<(String, f64)>,
    /// Numbers that are expressions of parameters, with their text: changing them means changing a parameter or the text.
    pub expressions: Vec<(Dimension, String)>,
}

/// The numbers of a robot file, without checks; none for text that is no TOML.
#[must_use]
pub fn dimensions(text: &str) -> Dimensions {
    let mut found = Dimensions { parameters: Vec::new(), expressions: Vec::new() };
    let Ok(document) = Document::parse(text) else { return found };
    if let Some(table) = document.get("parameters").and_then(Item::as_table_like) {
        let numbers = table.iter().filter_map(|(key, item)| Some((key.to_owned(), number(item)?)));
        found.parameters.extend(numbers);
    }
    let of_limb = |limb| {
        use Dimension::{BaseX, BaseY, SocketAngle, SocketRadius};
        [SocketRadius(limb), SocketAngle(limb), BaseX(limb), BaseY(limb)]
    };
    let all = [0, 1, 2].into_iter().flat_map(of_limb).chain([
        Dimension::RodMin,
        Dimension::RodMax,
        Dimension::TiltLimit,
        Dimension::WorkingHeight,
        Dimension::BallClearance,
    ]);
    for dimension in all {
        let item = item(document.as_table(), &dimension.location());
        if let Some(expression) = item.and_then(Found::expression) {
            found.expressions.push((dimension, expression.to_owned()));
        }
    }
    found
}

fn number(item: &Item) -> Option<f64> {
    item.as_float().or_else(|| {
        #[expect(clippy::cast_precision_loss, reason = "files have numbers of few digits")]
        let number = item.as_integer().map(|number| number as f64);
        number
    })
}

/// A value of a file, or one of a list.
#[derive(Clone, Copy)]
enum Found<'d> {
    Item(&'d Item),
    InList(&'d Value),
}

impl<'d> Found<'d> {
    fn expression(self) -> Option<&'d str> {
        match self {
            Self::Item(item) => item.as_str(),
            Self::InList(value) => value.as_str(),
        }
    }

    fn span(self) -> Option<std::ops::Range<usize>> {
        match self {
            Self::Item(item) => item.span(),
            Self::InList(value) => value.span(),
        }
    }
}

fn item<'d>(top: &'d Table, location: &Location) -> Option<Found<'d>> {
    let item = match location.table {
        Place::Named(name) => top.get(name)?.as_table_like()?.get(&location.key)?,
        Place::Limb(limb) => match top.get("limb")? {
            Item::ArrayOfTables(tables) => tables.get(limb)?.get(&location.key)?,
            Item::Value(Value::Array(list)) => {
                let value = list.get(limb)?.as_inline_table()?.get(&location.key)?;
                return match (location.index, value) {
                    (Some(index), Value::Array(list)) => list.get(index).map(Found::InList),
                    _ => Some(Found::InList(value)),
                };
            }
            _ => return None,
        },
    };
    match location.index {
        Some(index) if item.is_array() => item.as_array()?.get(index).map(Found::InList),
        _ => Some(Found::Item(item)),
    }
}

/// Replaces numbers in the text of a robot file; everything else remains, including comments.
///
/// The new values are not checked: read the returned text to check them.
///
/// # Arguments
/// * `changes` – numbers with their new values, in SI units; parameters in the units of the file
///
/// # Errors
/// The text is not TOML, has no such table or parameter, or has an expression in place of the number.
/// A point in the base plane that the file does not have needs a file without errors.
pub fn with_dimensions(text: &str, changes: &[(Dimension, f64)]) -> Result<String, Errors> {
    let original = Document::parse(text).map_err(|error| {
        let message = error.message().replace('\n', " ");
        let span = error.span().unwrap_or(0..0);
        Errors::from(vec![Error::at(
            text,
            span,
            FileProblem::from(Form::Malformed { message }).into(),
        )])
    })?;
    let mut document: DocumentMut = original.clone().into_mut();
    for (dimension, value) in changes {
        let location = dimension.location();
        if let Some(found) = item(original.as_table(), &location)
            && let Some(expression) = found.expression()
        {
            let problem =
                Problem::Expression { key: location.key, expression: expression.to_owned() };
            let span = found.span().unwrap_or(0..0);
            return Err(vec![Error::at(text, span, problem)].into());
        }
        let missing = |whose: &str, key: &str| {
            let problem = FileProblem::MissingKey { whose: whose.to_owned(), key: key.to_owned() };
            Errors::from(vec![Error::at(text, 0..0, problem.into())])
        };
        let value = dimension.in_file(*value);
        match dimension {
            Dimension::Parameter(name) if item(original.as_table(), &location).is_none() => {
                let known = dimensions(text).parameters;
                let known = known.iter().map(|(name, _)| name.as_str());
                let problem = FileProblem::unknown("parameter", name, known);
                return Err(vec![Error::at(text, 0..0, problem.into())].into());
            }
            Dimension::BaseX(limb) | Dimension::BaseY(limb) => {
                // The point under the socket, where the changes before this one have put it.
                let so_far = document.to_string();
                let table = limb_table(&mut document, *limb)
                    .ok_or_else(|| missing("a robot", "[[limb]]"))?;
                if table.get(&location.key).is_none() {
                    let point = parse_with(&so_far, &[])?.gpr.limbs()[*limb].base_point;
                    let point = [point.x, point.y].map(|coordinate| short(mm(coordinate)));
                    table.insert(&location.key, Item::Value(Array::from_iter(point).into()));
                }
                set(table, &location, value);
            }
            Dimension::SocketRadius(limb) | Dimension::SocketAngle(limb) => {
                let table = limb_table(&mut document, *limb)
                    .ok_or_else(|| missing("a robot", "[[limb]]"))?;
                set(table, &location, value);
            }
            _ => {
                let Place::Named(name) = location.table else { continue };
                if matches!(dimension, Dimension::BallClearance) && !document.contains_key(name) {
                    document.insert(name, Item::Table(Table::new()));
                }
                let table = document.get_mut(name).and_then(Item::as_table_like_mut);
                let table = table.ok_or_else(|| missing("a robot", &format!("[{name}]")))?;
                set(table, &location, value);
            }
        }
    }
    Ok(line_ends::as_before(document.to_string(), text))
}

fn limb_table(document: &mut DocumentMut, limb: usize) -> Option<&mut dyn TableLike> {
    match document.get_mut("limb")? {
        Item::ArrayOfTables(tables) => Some(tables.get_mut(limb)? as &mut dyn TableLike),
        Item::Value(Value::Array(list)) => {
            Some(list.get_mut(limb)?.as_inline_table_mut()? as &mut dyn TableLike)
        }
        _ => None,
    }
}

/// Replaces a number and keeps the comments around it.
fn set(table: &mut dyn TableLike, location: &Location, value: f64) {
    let Some(item) = table.get_mut(&location.key) else {
        table.insert(&location.key, Item::Value(value.into()));
        return;
    };
    match (location.index, item) {
        (Some(index), Item::Value(Value::Array(list))) if index < list.len() => {
            list.replace(index, value);
        }
        // A list that is too short is an error of the file, which reading the text reports.
        (Some(_), Item::Value(Value::Array(_))) => {}
        (_, Item::Value(old)) => {
            let decor = old.decor().clone();
            *old = value.into();
            *old.decor_mut() = decor;
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{PAPER, parse};

    fn changed(text: &str, dimension: Dimension, value: f64) -> String {
        with_dimensions(text, &[(dimension, value)]).unwrap()
    }

    #[test]
    fn only_the_number_changes() {
        for (dimension, value, from, to) in [
            (Dimension::RodMin, 0.25, "[246.0, 754.0]", "[250.0, 754.0]"),
            (Dimension::RodMax, 0.7, "[246.0, 754.0]", "[246.0, 700.0]"),
            (Dimension::TiltLimit, 2_f64.to_radians(), "tilt_deg = 1.5", "tilt_deg = 2.0"),
            (Dimension::WorkingHeight, 0.5123, "height_mm = 500.0", "height_mm = 512.3"),
            (Dimension::SocketRadius(0), 0.1, "radius_mm = 93.218", "radius_mm = 100.0"),
            (Dimension::SocketAngle(1), 2.0, "= 120.0", "= 114.59155902616465"),
        ] {
            assert_eq!(changed(PAPER, dimension, value), PAPER.replacen(from, to, 1));
        }
    }

    #[test]
    fn changes_of_one_call_are_those_of_one_call_after_the_other() {
        let (radius, x) = ((Dimension::SocketRadius(1), 0.12), (Dimension::BaseX(1), -0.05));
        let together = with_dimensions(PAPER, &[radius.clone(), x.clone()]).unwrap();
        let first = with_dimensions(PAPER, &[radius]).unwrap();
        assert_eq!(together, with_dimensions(&first, &[x]).unwrap());
    }

    #[test]
    fn missing_numbers_are_added() {
        let text = changed(PAPER, Dimension::BallClearance, 12.5e-6);
        assert!(text.starts_with(PAPER), "{text}");
        assert_eq!(parse(&text).unwrap().gpr.ball_clearance(), Some(12.5e-6));
        // The other coordinate is that under the socket.
        let text = changed(PAPER, Dimension::BaseX(1), -0.05);
        let [limb, other] =
            [parse(&text).unwrap().gpr, parse(PAPER).unwrap().gpr].map(|gpr| gpr.base_points()[1]);
        assert_eq!(limb.x, -0.05);
        assert!((limb.y - other.y).abs() < 1e-15, "{text}");
    }

    #[test]
    fn files_written_by_others_keep_their_form() {
        let text = "kind = 'gpr' # ours\r\nlimits = { rod_mm = [ 200, # short\r\n  800 ], tilt_deg = 3 } # wide\r\nworking.height_mm = 5e2\r\n[parameters]\r\nr = 80 # as ordered\r\n[[limb]]\r\nsocket_radius_mm = 'r'\r\nsocket_angle_deg = 10\r\n[[limb]]\r\nsocket_radius_mm = 'r + 1'\r\nsocket_angle_deg = 130\r\nbase_point_mm = ['-r/2', 60]\r\n[[limb]]\r\nsocket_radius_mm = 80\r\nsocket_angle_deg = 250\r\n";
        parse(text).unwrap();
        for (dimension, value, from, to) in [
            (Dimension::RodMin, 0.21, "[ 200,", "[ 210.0,"),
            (Dimension::RodMax, 0.81, "  800 ]", "  810.0 ]"),
            (Dimension::WorkingHeight, 0.51, "5e2", "510.0"),
            (Dimension::Parameter("r".to_owned()), 81.0, "r = 80 #", "r = 81.0 #"),
            (Dimension::BaseY(1), 0.061, ", 60]", ", 61.0]"),
        ] {
            assert_eq!(changed(text, dimension, value), text.replacen(from, to, 1));
        }
        let listed = dimensions(text);
        assert_eq!(listed.parameters, [("r".to_owned(), 80.0)]);
        let expected = [
            (Dimension::SocketRadius(0), "r".to_owned()),
            (Dimension::SocketRadius(1), "r + 1".to_owned()),
            (Dimension::BaseX(1), "-r/2".to_owned()),
        ];
        assert_eq!(listed.expressions, expected);
    }

    #[test]
    fn expressions_and_missing_tables_are_refused_with_their_place() {
        let text =
            PAPER.replacen("[246.0, 754.0]", "[\"h - 254\", 754]", 1) + "[parameters]\nh = 500\n";
        let error = with_dimensions(&text, &[(Dimension::RodMin, 0.3)]).unwrap_err();
        assert_eq!(error[0].place.line, 26);
        assert!(error.to_string().contains("`rod_mm` is the expression \"h - 254\""), "{error}");
        assert!(with_dimensions(&text, &[(Dimension::RodMax, 0.8)]).is_ok());
        for (text, dimension) in [
            ("kind = \"gpr\"", Dimension::TiltLimit),
            ("limits = 3", Dimension::RodMin),
            ("limb = [1]", Dimension::SocketRadius(0)),
            (PAPER, Dimension::SocketRadius(3)),
            (PAPER, Dimension::Parameter("r".to_owned())),
            ("= =", Dimension::TiltLimit),
        ] {
            let error = with_dimensions(text, &[(dimension, 0.3)]).unwrap_err();
            assert_eq!(error.len(), 1, "{error}");
        }
        assert_eq!(dimensions("= =").parameters, []);
    }
}
