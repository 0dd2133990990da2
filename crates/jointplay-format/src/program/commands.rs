//! Commands of one line.

use jointplay_cell::program::{
    AllowedValues, AxisTarget, Command, Name, Number, SlotName, TiltTarget,
};

use super::cursor::Cursor;
use super::problem::{Error, Problem};
use super::words::DIRECTIONS;

/// The arguments of a command that is no block.
pub(super) fn simple(command: &str, cursor: &mut Cursor<'_, '_>) -> Result<Command, Error> {
    Ok(match command {
        "HOME" => Command::Home,
        "MOVE" if cursor.accept("LINE") => line(cursor)?,
        "MOVE" => axes(cursor)?,
        "GET" => Command::Get { from: slot(cursor)?, effector: with(cursor)? },
        "PUT" => Command::Put { to: slot(cursor)?, effector: with(cursor)? },
        "TRANSFER" => {
            let from = slot(cursor)?;
            cursor.require("TO")?;
            Command::Transfer { from, to: slot(cursor)?, effector: with(cursor)? }
        }
        "SWAP" => {
            let at = slot(cursor)?;
            swap(at, cursor).map_err(|error| with_swap_form(error, cursor))?
        }
        "GOTO" => Command::Goto { to: slot(cursor)?, effector: with(cursor)? },
        "WAIT" => Command::Wait { duration: cursor.quantity("a time", &[AllowedValues::TIME])? },
        "SPEED" => {
            let what = "a share of the limits";
            Command::Speed { fraction: cursor.quantity(what, &[AllowedValues::SPEED])? }
        }
        "BLEND" if cursor.accept("OFF") => Command::Blend { radius: None },
        "BLEND" => {
            let radius = cursor.quantity("a radius of blending", &[AllowedValues::BLEND_RADIUS])?;
            Command::Blend { radius: Some(radius) }
        }
        "TILT" => Command::Tilt { tilt: tilt(cursor)? },
        _ => {
            let routine = cursor.name("a routine")?;
            let argument = |cursor: &mut Cursor<'_, '_>| cursor.number("an argument");
            Command::Call { routine, arguments: list(cursor, argument)? }
        }
    })
}

fn axes(cursor: &mut Cursor<'_, '_>) -> Result<Command, Error> {
    const ALLOWED: [AllowedValues; 2] = [AllowedValues::ANGLE, AllowedValues::LENGTH];
    let mut targets: Vec<AxisTarget> = Vec::new();
    loop {
        let before = cursor.peek();
        let Some(axis) = cursor.accept_name("an axis")? else {
            // At least one axis is required.
            if targets.is_empty() {
                return Err(cursor.unexpected());
            }
            return Ok(Command::Move { targets });
        };
        if let Some(token) = before.filter(|_| targets.iter().any(|it| it.axis.text == axis.text)) {
            let problem = Problem::Twice { name: axis.text };
            return Err(cursor.error_at(token.column, token.width(), problem));
        }
        targets.push(AxisTarget { axis, position: cursor.quantity("a position", &ALLOWED)? });
    }
}

fn line(cursor: &mut Cursor<'_, '_>) -> Result<Command, Error> {
    let effector = with(cursor)?;
    cursor.require("BY")?;
    let mut by = [None, None, None];
    loop {
        let column = cursor.place().column;
        let Some(direction) = DIRECTIONS.into_iter().position(|word| cursor.accept(word)) else {
            if by.iter().all(Option::is_none) {
                return Err(cursor.unexpected());
            }
            return Ok(Command::MoveLine { effector, by });
        };
        if by[direction].is_some() {
            let problem = Problem::Twice { name: DIRECTIONS[direction].to_owned() };
            return Err(cursor.error_at(column, 1, problem));
        }
        by[direction] = Some(cursor.quantity("a length", &[AllowedValues::LENGTH])?);
    }
}

/// Words before the effectors of SWAP.
const EFFECTOR_WORDS: [&str; 3] = ["GET", "PUT", "WITH"];

/// The effectors of SWAP.
fn swap(at: SlotName, cursor: &mut Cursor<'_, '_>) -> Result<Command, Error> {
    cursor.require("GET")?;
    let get = effector(cursor)?;
    cursor.require("PUT")?;
    Ok(Command::Swap { at, get, put: effector(cursor)? })
}

/// An error in the effectors of SWAP with the form of the command, in the names of the line.
fn with_swap_form(error: Error, cursor: &Cursor<'_, '_>) -> Error {
    let Error { place, problem } = error;
    let (expected, found) = match *problem {
        Problem::Expected { expected, found, .. } => (expected, found),
        Problem::Reserved { expected, word } => (expected, format!("`{word}`")),
        other => return Error { place, problem: Box::new(other) },
    };
    // Names of effectors follow these words; without them the form has those of the examples.
    let named = cursor.names_after(&EFFECTOR_WORDS);
    let [get, put] = match named.as_slice() {
        [get, put, ..] if get != put => [*get, *put],
        [get] if *get == "A" => ["A", "B"],
        [get] => [*get, "A"],
        _ => ["B", "A"],
    };
    let form = format!("{} GET {get} PUT {put}", cursor.text_before(&EFFECTOR_WORDS));
    Error { place, problem: Box::new(Problem::Form { expected, found, form }) }
}

/// An effector of SWAP: WITH, which other commands need, is optional.
fn effector(cursor: &mut Cursor<'_, '_>) -> Result<Name, Error> {
    cursor.accept("WITH");
    cursor.name("an effector")
}

fn with(cursor: &mut Cursor<'_, '_>) -> Result<Option<Name>, Error> {
    if cursor.accept("WITH") { cursor.name("an effector").map(Some) } else { Ok(None) }
}

pub(super) fn slot(cursor: &mut Cursor<'_, '_>) -> Result<SlotName, Error> {
    let station = cursor.name("a station")?;
    let slot = if cursor.accept("SLOT") { Some(slot_number(cursor)?) } else { None };
    Ok(SlotName { station, slot })
}

/// The number after SLOT.
pub(super) fn slot_number(cursor: &mut Cursor<'_, '_>) -> Result<Number, Error> {
    cursor.literal_or_number("the number of the slot", AllowedValues::SLOT_NUMBER)
}

fn tilt(cursor: &mut Cursor<'_, '_>) -> Result<Option<TiltTarget>, Error> {
    if cursor.accept("LEVEL") {
        return Ok(None);
    }
    let angle = cursor.quantity("a tilt", &[AllowedValues::TILT])?;
    cursor.require("TOWARD")?;
    let azimuth = cursor.quantity("an azimuth", &[AllowedValues::ANGLE])?;
    Ok(Some(TiltTarget { angle, azimuth }))
}

/// A list in parentheses, separated by commas; empty without parentheses.
pub(super) fn list<T>(
    cursor: &mut Cursor<'_, '_>,
    mut read: impl FnMut(&mut Cursor<'_, '_>) -> Result<T, Error>,
) -> Result<Vec<T>, Error> {
    let mut items = Vec::new();
    if !cursor.accept_sign("(") {
        return Ok(items);
    }
    loop {
        items.push(read(cursor)?);
        if cursor.accept_sign(")") {
            return Ok(items);
        }
        cursor.require_sign(",", "`,` or `)`")?;
    }
}
