//! Conditions of IF.

use jointplay_cell::program::{Condition, Relation, SlotName};

use super::commands::slot_number;
use super::cursor::Cursor;
use super::lexer::Kind;
use super::problem::{Error, Problem};
use crate::expression::ExpressionProblem;

/// Deepest nesting of parentheses and NOT, so that no text overflows the stack.
const MAX_DEPTH: usize = 32;

/// Relations with their signs.
pub(super) const RELATIONS: [(&str, Relation); 6] = [
    ("<", Relation::Less),
    ("<=", Relation::LessOrEqual),
    (">", Relation::Greater),
    (">=", Relation::GreaterOrEqual),
    ("=", Relation::Equal),
    ("<>", Relation::NotEqual),
];

/// A condition: `condition = conjunction { "OR" conjunction }`.
pub(super) fn condition(cursor: &mut Cursor<'_, '_>) -> Result<Condition, Error> {
    any(cursor, 0)
}

fn any(cursor: &mut Cursor<'_, '_>, depth: usize) -> Result<Condition, Error> {
    let mut conditions = vec![all(cursor, depth)?];
    while cursor.accept("OR") {
        conditions.push(all(cursor, depth)?);
    }
    Ok(joined(conditions, Condition::Any))
}

fn all(cursor: &mut Cursor<'_, '_>, depth: usize) -> Result<Condition, Error> {
    let mut conditions = vec![single(cursor, depth)?];
    while cursor.accept("AND") {
        conditions.push(single(cursor, depth)?);
    }
    Ok(joined(conditions, Condition::All))
}

/// The only condition, or several as one.
fn joined(mut conditions: Vec<Condition>, join: fn(Vec<Condition>) -> Condition) -> Condition {
    match conditions.pop() {
        Some(only) if conditions.is_empty() => only,
        last => {
            conditions.extend(last);
            join(conditions)
        }
    }
}

fn single(cursor: &mut Cursor<'_, '_>, depth: usize) -> Result<Condition, Error> {
    if depth == MAX_DEPTH {
        return Err(cursor.error(Problem::Expression(ExpressionProblem::TooDeep)));
    }
    if cursor.accept("NOT") {
        return Ok(Condition::Not(Box::new(single(cursor, depth + 1)?)));
    }
    let follows = |word| cursor.peek_second().is_some_and(|token| token.is(word));
    let is_name = cursor.peek().is_some_and(|it| matches!(it.kind, Kind::Word | Kind::Quoted));
    if is_name && ["SLOT", "HAS", "EMPTY"].into_iter().any(follows) {
        return presence(cursor);
    }
    // A parenthesis is one of an expression if a comparison follows that.
    let start = cursor.position();
    let is_open = cursor.accept_sign("(");
    cursor.rewind(start);
    let first = match comparison(cursor) {
        Err(error) if is_open => error,
        result => return result,
    };
    cursor.rewind(start);
    cursor.accept_sign("(");
    let inner = any(cursor, depth + 1).and_then(|inner| {
        cursor.require_sign(")", "`)`")?;
        Ok(inner)
    });
    // The attempt that read more of the line is the one that is meant.
    inner.map_err(|error| if error.place.column > first.place.column { error } else { first })
}

fn comparison(cursor: &mut Cursor<'_, '_>) -> Result<Condition, Error> {
    let left = cursor.number("a condition")?;
    let relation = relation(cursor)?;
    let (right, unit) = cursor.number_with_unit("the number to compare")?;
    Ok(Condition::Comparison { left, relation, right, unit })
}

fn relation(cursor: &mut Cursor<'_, '_>) -> Result<Relation, Error> {
    if let Some((_, relation)) = RELATIONS.into_iter().find(|(sign, _)| cursor.accept_sign(sign)) {
        return Ok(relation);
    }
    for (other, sign) in [("==", "="), ("!=", "<>")] {
        if cursor.peek().is_some_and(|token| token.text == other) {
            let (expected, found) = (vec!["a comparison".to_owned()], format!("`{other}`"));
            let nearest = Some(sign.to_owned());
            return Err(cursor.error(Problem::Expected { expected, found, nearest }));
        }
    }
    Err(cursor.expecting(&["a comparison: < <= > >= = <>", "HAS WAFER", "EMPTY"]))
}

fn presence(cursor: &mut Cursor<'_, '_>) -> Result<Condition, Error> {
    let station = cursor.name("a station or effector")?;
    let slot = if cursor.accept("SLOT") { Some(slot_number(cursor)?) } else { None };
    let location = SlotName { station, slot };
    if cursor.accept("HAS") {
        cursor.require("WAFER")?;
        return Ok(Condition::Presence { location, occupied: true });
    }
    cursor.require("EMPTY")?;
    Ok(Condition::Presence { location, occupied: false })
}
