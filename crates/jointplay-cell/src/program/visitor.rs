//! Traversal of the names and numbers of programs.

use super::{Command, Condition, Instruction, Name, Number, Quantity, SlotName, Unit};

/// A use of all names and numbers in instructions, in the order of the text.
///
/// Names of axes, routines and counters are not visited.
pub trait ProgramVisitor {
    /// A number, with the unit in which the text has it.
    fn number(&mut self, number: &Number, unit: Option<Unit>);

    /// Two numbers that a condition compares, with the unit of both where it is written.
    fn comparison(&mut self, left: &Number, right: &Number, unit: Option<Unit>) {
        self.number(left, unit);
        self.number(right, unit);
    }

    /// The arguments of a call.
    fn arguments(&mut self, routine: &Name, arguments: &[Number]);

    /// A station.
    fn station(&mut self, _name: &Name) {}

    /// A station or an effector.
    fn location(&mut self, _name: &Name) {}

    /// An effector.
    fn effector(&mut self, _name: &Name) {}

    /// Visits all instructions of a block.
    fn block(&mut self, body: &[Instruction]) {
        body.iter().for_each(|instruction| self.command(&instruction.command));
    }

    /// Visits a quantity.
    fn quantity(&mut self, quantity: &Quantity) {
        self.number(&quantity.number, Some(quantity.unit));
    }

    /// Visits a slot.
    fn slot(&mut self, slot: &SlotName) {
        self.station(&slot.station);
        slot.slot.iter().for_each(|number| self.number(number, None));
    }

    /// Visits a condition.
    fn condition(&mut self, condition: &Condition) {
        match condition {
            Condition::Comparison { left, right, unit, .. } => self.comparison(left, right, *unit),
            Condition::Presence { location, .. } if location.slot.is_some() => self.slot(location),
            Condition::Presence { location, .. } => self.location(&location.station),
            Condition::Not(condition) => self.condition(condition),
            Condition::All(conditions) | Condition::Any(conditions) => {
                conditions.iter().for_each(|condition| self.condition(condition));
            }
        }
    }

    /// Visits a command.
    fn command(&mut self, command: &Command) {
        match command {
            Command::Home => {}
            Command::Move { targets } => {
                targets.iter().for_each(|target| self.quantity(&target.position));
            }
            Command::MoveLine { effector, by } => {
                effector.iter().for_each(|name| self.effector(name));
                by.iter().flatten().for_each(|length| self.quantity(length));
            }
            Command::Get { from: slot, effector }
            | Command::Put { to: slot, effector }
            | Command::Goto { to: slot, effector } => {
                self.slot(slot);
                effector.iter().for_each(|name| self.effector(name));
            }
            Command::Transfer { from, to, effector } => {
                self.slot(from);
                self.slot(to);
                effector.iter().for_each(|name| self.effector(name));
            }
            Command::Swap { at, get, put } => {
                self.slot(at);
                self.effector(get);
                self.effector(put);
            }
            Command::Wait { duration: quantity } | Command::Speed { fraction: quantity } => {
                self.quantity(quantity);
            }
            Command::Blend { radius } => radius.iter().for_each(|radius| self.quantity(radius)),
            Command::Tilt { tilt } => {
                if let Some(tilt) = tilt {
                    self.quantity(&tilt.angle);
                    self.quantity(&tilt.azimuth);
                }
            }
            Command::Call { routine, arguments } => self.arguments(routine, arguments),
            Command::Repeat { times, body, .. } => {
                self.number(times, None);
                self.block(body);
            }
            Command::If { branches, otherwise } => {
                for branch in branches {
                    self.condition(&branch.condition);
                    self.block(&branch.body);
                }
                self.block(otherwise);
            }
        }
    }
}
