//! The program of an order of hand-offs.

use super::candidate::{Candidate, MotionSettings};
use super::flow::RoutedHandoff;
use crate::program::{
    Command, Handoff, Instruction, Name, Number, Program, Quantity, SlotName, SourceLocation, Unit,
};
use crate::station::SlotId;
use crate::workcell::Cell;

/// The program that executes hand-offs in an order, from the home position and back: GET and PUT, and TRANSFER and SWAP where both follow each other.
///
/// # Arguments
/// * `candidate` – with the speeds and blend radii
pub(super) fn order_program(
    cell: &Cell,
    order: &[RoutedHandoff],
    candidate: &Candidate,
) -> Program {
    let mut body = Body::default();
    let place = body.place;
    body.add(candidate.settings, Command::Home);
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
        let settings = candidate.settings_at(first.handoff.slot().station);
        let is_alike = |slot: SlotId| candidate.settings_at(slot.station) == settings;
        let (command, used) = match (first.handoff, second) {
            (Handoff::Picked(id, from), Some(Handoff::Placed(by, to)))
                if id == by && is_alike(to) =>
            {
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
        body.add(settings, command);
        rest = &rest[used..];
    }
    body.add(candidate.settings, Command::Home);
    Program { body: body.instructions, ..Program::default() }
}

/// Instructions so far, and the settings that apply after them.
struct Body {
    place: SourceLocation,
    instructions: Vec<Instruction>,
    settings: MotionSettings,
}

impl Default for Body {
    fn default() -> Self {
        let settings = MotionSettings::FULL_SPEED;
        Self { place: SourceLocation::default(), instructions: Vec::new(), settings }
    }
}

impl Body {
    /// Adds a command, after those that change the settings to its own.
    fn add(&mut self, settings: MotionSettings, command: Command) {
        let MotionSettings { speed, blend_radius } = settings;
        let mut push = |command| {
            self.instructions.push(Instruction { place: self.place, command });
        };
        if speed != self.settings.speed {
            push(Command::Speed { fraction: Quantity::from_si(speed, Unit::Percent) });
        }
        if blend_radius != self.settings.blend_radius {
            let radius = Quantity::from_si(blend_radius, Unit::Millimeter);
            push(Command::Blend { radius: (blend_radius > 0.0).then_some(radius) });
        }
        push(command);
        self.settings = settings;
    }
}
