//! From a program to text.

use std::fmt::Write;

use jointplay_cell::program::{
    AxisTarget, Command, Instruction, Name, Program, SlotName, SlotNumber,
};
use jointplay_cell::robot::AxisKind;
use jointplay_core::spatial::Tilt;

use super::layout::INDENT;
use super::words::{DIRECTIONS, is_plain};
use crate::units::{mm, shift};

/// The text of a program, routines last; reading the text returns the same program.
///
/// Angles that came from a text keep every bit.
#[must_use]
pub fn write(program: &Program) -> String {
    let mut text = String::new();
    block(&mut text, &program.body, 0);
    for routine in &program.routines {
        if !text.is_empty() {
            text.push('\n');
        }
        line(&mut text, 0, format_args!("ROUTINE {}", name(&routine.name)));
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
                line(text, depth, format_args!("REPEAT {times}{counter}"));
                block(text, body, depth + 1);
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
            let some = by.iter().zip(DIRECTIONS).filter(|(length, _)| **length != 0.0);
            let mut shift = some.fold(String::new(), |text, (&length, direction)| {
                text + &format!(" {direction} {} mm", mm(length))
            });
            if shift.is_empty() {
                shift.push_str(" X 0 mm");
            }
            format!("MOVE LINE{} BY{shift}", with(effector.as_ref()))
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
        Command::Wait { seconds } => format!("WAIT {seconds} s"),
        Command::Speed { fraction } => format!("SPEED {} %", shift(*fraction, 2)),
        Command::Blend { radius } if *radius == 0.0 => "BLEND OFF".to_owned(),
        Command::Blend { radius } => format!("BLEND {} mm", mm(*radius)),
        Command::Tilt { tilt } if *tilt == Tilt::LEVEL => "TILT LEVEL".to_owned(),
        Command::Tilt { tilt } => {
            format!("TILT {} deg TOWARD {} deg", deg(tilt.pitch), deg(tilt.yaw))
        }
        Command::Call { routine } => format!("CALL {}", name(routine)),
        Command::Repeat { .. } => unreachable!("a block is no single line"),
    }
}

fn axis(target: &AxisTarget) -> String {
    match target.kind {
        AxisKind::Rotary => format!("{} {} deg", name(&target.axis), deg(target.position)),
        AxisKind::Linear => format!("{} {} mm", name(&target.axis), mm(target.position)),
    }
}

/// The shortest decimal of degrees that reads back as these radians, if there is one.
fn deg(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    let rounded = |digits: usize| format!("{degrees:.digits$e}").parse().unwrap_or(degrees);
    (0..17).map(rounded).find(|it| it.to_radians() == radians).unwrap_or(degrees)
}

fn with(effector: Option<&Name>) -> String {
    effector.map_or_else(String::new, |effector| format!(" WITH {}", name(effector)))
}

fn slot(slot: &SlotName) -> String {
    let station = name(&slot.station);
    match &slot.slot {
        None => station,
        Some(SlotNumber::Fixed { number, .. }) => format!("{station} SLOT {number}"),
        Some(SlotNumber::Counted { counter, offset, down: true }) => {
            format!("{station} SLOT {offset} - {}", name(counter))
        }
        Some(SlotNumber::Counted { counter, offset: 0, down: false }) => {
            format!("{station} SLOT {}", name(counter))
        }
        Some(SlotNumber::Counted { counter, offset, down: false }) => {
            let sign = if *offset < 0 { '-' } else { '+' };
            format!("{station} SLOT {} {sign} {}", name(counter), offset.unsigned_abs())
        }
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
