//! The program of an order of hand-offs.

use super::flow::RoutedHandoff;
use crate::program::{
    Command, Handoff, Instruction, Name, Number, Program, Quantity, SlotName, SourceLocation, Unit,
};
use crate::station::SlotId;
use crate::workcell::Cell;

/// The program that executes hand-offs in an order, from the home position and back: GET and PUT, and TRANSFER and SWAP where both follow each other.
///
/// # Arguments
/// * `speed` – share of the limits, above 0 and at most 1
/// * `blend_radius` – 0 for none (m)
pub(super) fn order_program(
    cell: &Cell,
    order: &[RoutedHandoff],
    speed: f64,
    blend_radius: f64,
) -> Program {
    let place = SourceLocation::default();
    let mut body = Vec::new();
    let mut add = |command| body.push(Instruction { place, command });
    if speed < 1.0 {
        add(Command::Speed { fraction: Quantity::from_si(speed, Unit::Percent) });
    }
    if blend_radius > 0.0 {
        add(Command::Blend { radius: Some(Quantity::from_si(blend_radius, Unit::Millimeter)) });
    }
    add(Command::Home);
    let name = |text: &str| Name { text: text.to_owned(), place };
    let slot = |slot: SlotId| {
        let station = &cell.stations[slot.station];
        let number = (station.slots > 1).then(|| Number::whole(slot.slot));
        SlotName { station: name(&station.name), slot: number }
    };
    let mut rest = order;
    while let Some((first, others)) = rest.split_first() {
        let second = others.first().map(|next| next.handoff);
        let effector = |id| name(cell.effector_name(id));
        let (command, used) = match (first.handoff, second) {
            (Handoff::Picked(id, from), Some(Handoff::Placed(by, to))) if id == by => {
                let (from, to) = (slot(from), slot(to));
                (Command::Transfer { from, to, effector: Some(effector(id)) }, 2)
            }
            (Handoff::Picked(get, at), Some(Handoff::Placed(put, to))) if at == to => {
                let (get, put) = (effector(get), effector(put));
                (Command::Swap { at: slot(at), get, put }, 2)
            }
            (Handoff::Picked(id, from), _) => {
                (Command::Get { from: slot(from), effector: Some(effector(id)) }, 1)
            }
            (Handoff::Placed(id, to), _) => {
                (Command::Put { to: slot(to), effector: Some(effector(id)) }, 1)
            }
        };
        add(command);
        rest = &rest[used..];
    }
    add(Command::Home);
    Program { body, ..Program::default() }
}
