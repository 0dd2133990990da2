//! From a program to text.

use std::fmt::Write;

use jointplay_cell::program::{
    AxisTarget, Command, Condition, Instruction, Name, Number, Program, Quantity, SlotName, Unit,
};

use super::condition::RELATIONS;
use super::layout::INDENT;
use super::words::{DIRECTIONS, is_plain};
use crate::expression::{self, Rank};

/// The text of a program, parameters first and routines last; reading the text returns the same program.
#[must_use]
pub fn write(program: &Program) -> String {
    let mut text = String::new();
    for parameter in &program.parameters {
        let assigned = with_unit(&parameter.value, parameter.unit);
        let range = parameter.range.map(|[min, max]| {
            format!(" FROM {} TO {}", value(min, parameter.unit), value(max, parameter.unit))
        });
        let (name, range) = (name(&parameter.name), range.unwrap_or_default());
        line(&mut text, 0, format_args!("PARAMETER {name} = {assigned}{range}"));
    }
    if !text.is_empty() && !program.body.is_empty() {
        text.push('\n');
    }
    block(&mut text, &program.body, 0);
    for routine in &program.routines {
        if !text.is_empty() {
            text.push('\n');
        }
        let parameters: Vec<String> = routine.parameters.iter().map(name).collect();
        let parameters = list(&parameters);
        line(&mut text, 0, format_args!("ROUTINE {}{parameters}", name(&routine.name)));
        block(&mut text, &routine.body, 1);
        line(&mut text, 0, format_args!("END"));
    }
    text
}

fn line(text: &mut String, depth: usize, what: std::fmt::Arguments<'_>) {
    for _ in 0..depth {
        text.push_str(INDENT);
    }
    // Writing to a string does not fail.
    let _ = writeln!(text, "{what}");
}

fn block(text: &mut String, body: &[Instruction], depth: usize) {
    for instruction in body {
        match &instruction.command {
            Command::Repeat { times, counter, body } => {
                let counter = counter.as_ref().map(|it| format!(" AS {}", name(it)));
                let counter = counter.unwrap_or_default();
                line(text, depth, format_args!("REPEAT {}{counter}", number(times)));
                block(text, body, depth + 1);
                line(text, depth, format_args!("END"));
            }
            Command::If { branches, otherwise } => {
                for (index, branch) in branches.iter().enumerate() {
                    let word = if index == 0 { "IF" } else { "ELSE IF" };
                    let condition = condition(&branch.condition, Priority::Any);
                    line(text, depth, format_args!("{word} {condition}"));
                    block(text, &branch.body, depth + 1);
                }
                if !otherwise.is_empty() {
                    line(text, depth, format_args!("ELSE"));
                    block(text, otherwise, depth + 1);
                }
                line(text, depth, format_args!("END"));
            }
            command => line(text, depth, format_args!("{}", simple(command))),
        }
    }
}

fn simple(command: &Command) -> String {
    match command {
        Command::Home => "HOME".to_owned(),
        Command::Move { targets } => {
            targets.iter().fold("MOVE".to_owned(), |text, it| text + " " + &axis(it))
        }
        Command::MoveLine { effector, by } => {
            let some = by.iter().zip(DIRECTIONS);
            let some = some.filter_map(|(length, direction)| Some((length.as_ref()?, direction)));
            let mut lengths = some.fold(String::new(), |text, (length, direction)| {
                text + &format!(" {direction} {}", quantity(length))
            });
            if lengths.is_empty() {
                lengths.push_str(" X 0 mm");
            }
            format!("MOVE LINE{} BY{lengths}", with(effector.as_ref()))
        }
        Command::Get { from, effector } => format!("GET {}{}", slot(from), with(effector.as_ref())),
        Command::Put { to, effector } => format!("PUT {}{}", slot(to), with(effector.as_ref())),
        Command::Transfer { from, to, effector } => {
            format!("TRANSFER {} TO {}{}", slot(from), slot(to), with(effector.as_ref()))
        }
        Command::Swap { at, get, put } => {
            format!("SWAP {} GET {} PUT {}", slot(at), name(get), name(put))
        }
        Command::Goto { to, effector } => format!("GOTO {}{}", slot(to), with(effector.as_ref())),
        Command::Wait { duration } => format!("WAIT {}", quantity(duration)),
        Command::Speed { fraction } => format!("SPEED {}", quantity(fraction)),
        Command::Blend { radius: None } => "BLEND OFF".to_owned(),
        Command::Blend { radius: Some(radius) } => format!("BLEND {}", quantity(radius)),
        Command::Tilt { tilt: None } => "TILT LEVEL".to_owned(),
        Command::Tilt { tilt: Some(tilt) } => {
            format!("TILT {} TOWARD {}", quantity(&tilt.angle), quantity(&tilt.azimuth))
        }
        Command::Call { routine, arguments } => {
            let arguments: Vec<String> = arguments.iter().map(number).collect();
            format!("CALL {}{}", name(routine), list(&arguments))
        }
        Command::Repeat { .. } | Command::If { .. } => unreachable!("a block is no single line"),
    }
}

fn axis(target: &AxisTarget) -> String {
    format!("{} {}", name(&target.axis), quantity(&target.position))
}

/// A list in parentheses; nothing for an empty one.
fn list(items: &[String]) -> String {
    if items.is_empty() { String::new() } else { format!("({})", items.join(", ")) }
}

/// A number without unit.
fn number(number: &Number) -> String {
    expression::text(&number.expression, Rank::Sum, name)
}

fn quantity(quantity: &Quantity) -> String {
    with_unit(&quantity.number, Some(quantity.unit))
}

/// A number with its unit, if it has one.
fn with_unit(number: &Number, unit: Option<Unit>) -> String {
    match unit {
        Some(unit) => {
            let number = expression::text(&number.expression, Rank::Signed, name);
            format!("{number} {}", unit.symbol())
        }
        None => self::number(number),
    }
}

/// A constant with its unit, if it has one.
pub(super) fn value(number: f64, unit: Option<Unit>) -> String {
    unit.map_or_else(|| number.to_string(), |unit| format!("{number} {}", unit.symbol()))
}

/// Priority of a condition: one of lower priority needs parentheses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Priority {
    Any,
    All,
    Single,
}

fn condition(of: &Condition, least: Priority) -> String {
    let joined = |conditions: &[Condition], word: &str, inner: Priority| {
        let parts: Vec<String> = conditions.iter().map(|one| condition(one, inner)).collect();
        parts.join(word)
    };
    let (text, priority) = match of {
        Condition::Comparison { left, relation, right, unit } => {
            let sign = RELATIONS.iter().find(|(_, known)| known == relation);
            let (left, sign) = (number(left), sign.map_or("", |(sign, _)| sign));
            (format!("{left} {sign} {}", with_unit(right, *unit)), Priority::Single)
        }
        Condition::Presence { location, occupied } => {
            let state = if *occupied { "HAS WAFER" } else { "EMPTY" };
            (format!("{} {state}", slot(location)), Priority::Single)
        }
        Condition::Not(inner) => {
            (format!("NOT {}", condition(inner, Priority::Single)), Priority::Single)
        }
        Condition::All(conditions) => {
            (joined(conditions, " AND ", Priority::Single), Priority::All)
        }
        Condition::Any(conditions) => (joined(conditions, " OR ", Priority::All), Priority::Any),
    };
    if priority < least { format!("({text})") } else { text }
}

fn with(effector: Option<&Name>) -> String {
    effector.map_or_else(String::new, |effector| format!(" WITH {}", name(effector)))
}

fn slot(slot: &SlotName) -> String {
    let station = name(&slot.station);
    match &slot.slot {
        None => station,
        Some(slot) => format!("{station} SLOT {}", number(slot)),
    }
}

/// A name, in quotes where it could be misread.
pub(super) fn name(name: &Name) -> String {
    if is_plain(&name.text) {
        name.text.clone()
    } else {
        format!("\"{}\"", name.text.replace('"', "\"\""))
    }
}
