//! Values of a program's parameters from outside.

use jointplay_cell::program::Unit;

use super::cursor::Cursor;
use super::lexer::{Line, Token, line_at, lines};
use super::parser::parameter;
use super::write::value;
use crate::place::{self, Place, not_known};

/// A value for a parameter of a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Setting {
    /// Name of the parameter.
    pub name: String,
    /// Its value as text: a number, with the unit of the parameter.
    pub value: String,
}

/// Why a value does not suit a parameter; numbers are in the units of the text.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingProblem {
    /// The program has no such parameter.
    #[error("{}", not_known("the parameter", found, known))]
    Unknown {
        /// The name found.
        found: String,
        /// All parameters of the program.
        known: Vec<String>,
    },
    /// A parameter that is set twice.
    #[error("the parameter {name} is set twice")]
    Twice {
        /// Name of the parameter.
        name: String,
    },
    /// A value that is no number with an optional unit.
    #[error("the value of {name} has to be a number{}, found {found:?}", unit_of(*.unit))]
    NoNumber {
        /// Name of the parameter.
        name: String,
        /// The value found.
        found: String,
        /// Unit of the parameter.
        unit: Option<Unit>,
    },
    /// A value in another unit, or without unit.
    #[error("the value of {name} has to be a number{}, found {found}", match .unit {
        Some(unit) => format!(" in {}, as in `{} {}`", unit.symbol(), .number, unit.symbol()),
        None => format!(" without unit, as in `{}`", .number),
    })]
    Unit {
        /// Name of the parameter.
        name: String,
        /// The value found.
        found: String,
        /// Its number.
        number: f64,
        /// Unit of the parameter.
        unit: Option<Unit>,
    },
    /// A value out of the range of the parameter.
    #[error("the parameter {name} is {found}, but has to be from {min} to {max}{}", symbol(*.unit))]
    Range {
        /// Name of the parameter.
        name: String,
        /// The value found.
        found: String,
        /// Least value.
        min: f64,
        /// Largest value.
        max: f64,
        /// Unit of the parameter.
        unit: Option<Unit>,
    },
}

fn symbol(unit: Option<Unit>) -> String {
    unit.map_or_else(String::new, |unit| format!(" {}", unit.symbol()))
}

fn unit_of(unit: Option<Unit>) -> String {
    unit.map_or_else(String::new, |unit| format!(" in {}", unit.symbol()))
}

/// The declaration of a parameter in the text.
struct Declaration {
    name: String,
    unit: Option<Unit>,
    range: Option<[f64; 2]>,
    /// Line number, counted from 1.
    line: usize,
    /// Columns of the value, counted from 1.
    columns: std::ops::Range<usize>,
}

/// The text of a program with other values of its parameters; everything else remains.
///
/// Programs with syntax errors are returned with the values of the parameters that can be read.
///
/// # Errors
/// Unknown parameters, and values that are no numbers, in another unit or out of range; the place is that of the declaration.
///
/// # Example
/// ```
/// use jointplay_format::program::{Setting, with_parameters};
///
/// let setting = Setting { name: "lot".to_owned(), value: "13".to_owned() };
/// let text = with_parameters("PARAMETER lot = 25  # wafers\nHOME\n", &[setting])?;
/// assert_eq!(text, "PARAMETER lot = 13  # wafers\nHOME\n");
/// # Ok::<(), Vec<jointplay_format::place::Error<jointplay_format::program::SettingProblem>>>(())
/// ```
pub fn with_parameters(
    text: &str,
    settings: &[Setting],
) -> Result<String, Vec<place::Error<SettingProblem>>> {
    let (declarations, complete) = declarations(text);
    let mut errors = Vec::new();
    let mut replaced: Vec<(usize, std::ops::Range<usize>, String)> = Vec::new();
    for (index, Setting { name, value }) in settings.iter().enumerate() {
        let declaration = declarations.iter().find(|declaration| declaration.name == *name);
        let Some(declaration) = declaration else {
            if complete {
                let known = declarations.iter().map(|one| one.name.clone()).collect();
                let problem = SettingProblem::Unknown { found: name.clone(), known };
                errors.push(error(text, declarations.first(), problem));
            }
            continue;
        };
        let checked = if settings[..index].iter().any(|other| other.name == *name) {
            Err(SettingProblem::Twice { name: name.clone() })
        } else {
            checked(declaration, value)
        };
        match checked {
            Ok(value) => replaced.push((declaration.line, declaration.columns.clone(), value)),
            Err(problem) => errors.push(error(text, Some(declaration), problem)),
        }
    }
    if !errors.is_empty() {
        return Err(errors);
    }
    let mark = '\u{feff}';
    let unmarked = text.strip_prefix(mark);
    let mut new: String = unmarked.map(|_| mark).into_iter().collect();
    for (index, line) in unmarked.unwrap_or(text).split_inclusive('\n').enumerate() {
        let Some((_, columns, value)) = replaced.iter().find(|(line, ..)| *line == index + 1)
        else {
            new.push_str(line);
            continue;
        };
        new.extend(line.chars().take(columns.start - 1));
        new.push_str(value);
        new.extend(line.chars().skip(columns.end - 1));
    }
    Ok(new)
}

/// Names and units of the parameters of a program, in its order; declarations with syntax errors are omitted.
pub(crate) fn parameters(text: &str) -> Vec<(String, Option<Unit>)> {
    declarations(text).0.into_iter().map(|one| (one.name, one.unit)).collect()
}

/// The value of a parameter as text, in its unit.
pub(crate) fn value_text(number: f64, unit: Option<Unit>) -> String {
    value(number, unit)
}

/// The declarations of all parameters, and whether all of them can be read.
fn declarations(text: &str) -> (Vec<Declaration>, bool) {
    let (mut found, mut complete) = (Vec::new(), true);
    for line in lines(text) {
        if !line.tokens.first().is_some_and(|first| first.is("PARAMETER")) {
            continue;
        }
        let mut cursor = Cursor::new(&line);
        cursor.advance();
        let (Ok(parameter), Some(columns)) = (parameter(&mut cursor), value_columns(&line)) else {
            complete = false;
            continue;
        };
        found.push(Declaration {
            name: parameter.name.text,
            unit: parameter.unit,
            range: parameter.range,
            line: line.number,
            columns,
        });
    }
    (found, complete)
}

/// Columns of the value in the declaration of a parameter: from `=` to FROM.
fn value_columns(line: &Line<'_>) -> Option<std::ops::Range<usize>> {
    let after = line.tokens.iter().position(|token| token.text == "=")? + 1;
    let values = &line.tokens[after..];
    let count = values.iter().position(|token| token.is("FROM")).unwrap_or(values.len());
    let end = |token: &Token<'_>| token.column + token.width();
    Some(values.first()?.column..end(values[..count].last()?))
}

/// A value as text, if it suits the parameter.
fn checked(declaration: &Declaration, given: &str) -> Result<String, SettingProblem> {
    let Declaration { name, unit, range, .. } = declaration;
    let name = || name.clone();
    let unit = *unit;
    let found = given.to_owned();
    let line = lines(given).next();
    let no_number = || SettingProblem::NoNumber { name: name(), found: found.clone(), unit };
    let line = line.filter(|line| line.comment.is_none() && given.lines().count() == 1);
    let line = line.ok_or_else(no_number)?;
    let mut cursor = Cursor::new(&line);
    let (number, given_unit) = cursor.number_with_unit("a number").map_err(|_| no_number())?;
    cursor.end().map_err(|_| no_number())?;
    let number = number.expression.as_constant().filter(|number| number.is_finite());
    let number = number.ok_or_else(no_number)?;
    if given_unit != unit {
        return Err(SettingProblem::Unit { name: name(), found, number, unit });
    }
    match *range {
        Some([min, max]) if !(min..=max).contains(&number) => {
            Err(SettingProblem::Range { name: name(), found, min, max, unit })
        }
        _ => Ok(value(number, unit)),
    }
}

/// An error at a declaration, or at the start of a text without any.
fn error(
    text: &str,
    declaration: Option<&Declaration>,
    problem: SettingProblem,
) -> place::Error<SettingProblem> {
    let (line, columns) = declaration.map_or((1, 1..1), |it| (it.line, it.columns.clone()));
    let text = line_at(text, line).map_or_else(String::new, |line| line.text.to_owned());
    let place = Place { line, column: columns.start, width: columns.len(), text };
    place::Error { place, problem: Box::new(problem) }
}
