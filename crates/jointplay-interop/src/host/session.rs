//! The session of a host: commands in, answers out.

use std::sync::Arc;

use jointplay_cell::controller::{Controller, Execution};
use jointplay_cell::program::{WaferLocation, WaferLocations};
use jointplay_cell::robot::AxisKind;
use jointplay_cell::station::SlotId;
use jointplay_cell::workcell::Cell;
use jointplay_cell::{InvalidPart, PlanOptions};
use jointplay_format::place::Error;
use jointplay_format::program;

use super::command::{Action, CommandRule, Effect};
use super::field::{IDENTIFIER, UNIT};
use super::language::HostLanguage;
use super::pattern::{Values, Vocabulary};
use super::read::{program_text, unit_of};
use super::refusal::{Mismatch, RefusalReason, Refused};
use super::snapshot::{EventLog, Executed, HostSnapshot, Outcome};
use crate::controller_text::{Codes, Output, Problem, Template, Value, count, one_line};

/// Longest accepted line of a host (bytes), without its end.
pub const MAX_LINE_BYTES: usize = 1_000;

/// The robot of one host, and the language in which the host talks to it.
///
/// Times are those of the caller's clock, in seconds, and do not decrease.
/// While a program is executed, the robot is where the planned motion has it at this time; other programs are refused.
pub struct HostSession<'l> {
    language: &'l HostLanguage,
    controller: Controller,
    /// Factor of the time of the robot.
    speed: f64,
    output: Output<'l>,
    /// Number of received lines.
    received: usize,
    moving: Option<Moving>,
    log: EventLog,
}

/// A command of a host.
#[derive(Clone)]
struct Request {
    number: usize,
    text: String,
    id: String,
}

/// A program in execution.
struct Moving {
    request: Request,
    execution: Arc<Execution>,
    /// When it started, by the caller's clock (s).
    start: f64,
    /// Time of the motion at which it ends (s).
    end: f64,
    /// The last step, if it is stopped there.
    last_step: Option<usize>,
}

type Answered = Result<(), Error<Problem>>;

impl<'l> HostSession<'l> {
    /// A session with the robot at home.
    ///
    /// # Arguments
    /// * `speed` – factor of the time of the robot: at 2 every motion takes half of its planned time
    ///
    /// # Errors
    /// All invalid parts of the cell.
    pub fn new(
        language: &'l HostLanguage,
        cell: Cell,
        speed: f64,
    ) -> Result<Self, Vec<InvalidPart>> {
        let controller = Controller::new(cell)?;
        let output = Output::new(&language.output);
        let log = EventLog::default();
        Ok(Self { language, controller, speed, output, received: 0, moving: None, log })
    }

    /// The robot until the next event of this session, for observers.
    #[must_use]
    pub fn snapshot(&self) -> HostSnapshot {
        let executed = self.moving.as_ref().map(|moving| Executed {
            command: moving.request.text.clone(),
            execution: Arc::clone(&moving.execution),
            start: moving.start,
            end: moving.end,
        });
        HostSnapshot::new(&self.controller, executed, self.speed, &self.log)
    }

    /// The answer to a new connection.
    ///
    /// # Errors
    /// An expression of a template without a value.
    pub fn welcome(&mut self) -> Result<String, Error<Problem>> {
        let cell = self.controller.cell();
        let (name, robot, axes) = (cell.name.clone(), cell.robot.name.clone(), self.axes());
        let lines = &self.language.answer.welcome;
        self.push(lines, |name_of| match name_of {
            "cell" => Value::Text(one_line(&name)),
            "robot" => Value::Text(one_line(&robot)),
            _ => Value::Text(axes.clone()),
        })?;
        Ok(self.take())
    }

    /// Time at which [`Self::advance`] has an answer (s); `None` while the robot is at rest.
    #[must_use]
    pub fn next_event(&self) -> Option<f64> {
        self.moving.as_ref().map(|moving| moving.start + moving.end / self.speed)
    }

    /// Answers at a time: the completion of a program, if it has ended.
    ///
    /// # Errors
    /// An expression of a template without a value.
    pub fn advance(&mut self, now: f64) -> Result<String, Error<Problem>> {
        self.log.now = now;
        if self.next_event().is_some_and(|end| end <= now)
            && let Some(moving) = self.moving.take()
        {
            let duration = moving.end;
            let (lines, outcome) = match moving.last_step {
                Some(step) => {
                    self.controller.stop_after(&moving.execution, step);
                    (&self.language.answer.stopped, Outcome::Stopped { duration })
                }
                None => {
                    self.controller.complete(&moving.execution);
                    (&self.language.answer.completed, Outcome::Completed { duration })
                }
            };
            self.log.push(&moving.request.text, outcome);
            self.answer(lines, &moving.request, |_| Value::Real(moving.end))?;
        }
        Ok(self.take())
    }

    /// Answers to a line without its end.
    ///
    /// # Errors
    /// An expression of a template without a value.
    pub fn receive(&mut self, line: &[u8], now: f64) -> Result<String, Error<Problem>> {
        let mut text = self.advance(now)?;
        self.received += 1;
        let shown = one_line(&String::from_utf8_lossy(&line[..line.len().min(MAX_LINE_BYTES)]));
        let request = Request { number: self.received, text: shown, id: String::new() };
        match self.command(line) {
            Ok((request_text, rule, values)) => {
                let id = values.iter().find(|(name, _)| *name == IDENTIFIER);
                let id = match id {
                    Some((_, Value::Text(id))) => id.clone(),
                    _ => String::new(),
                };
                let request = Request { text: request_text, id, ..request };
                match &rule.effect {
                    Effect::Program(templates) => {
                        self.start(request, templates, &values, now)?;
                    }
                    Effect::Action(action) => self.act(&request, *action, &values, now)?,
                }
            }
            Err(refused) => self.refuse(&request, &refused)?,
        }
        text.push_str(&self.take());
        Ok(text)
    }

    /// Answer to a line that was too long to be received.
    ///
    /// # Errors
    /// An expression of a template without a value.
    pub fn receive_too_long(&mut self, now: f64) -> Result<String, Error<Problem>> {
        let mut text = self.advance(now)?;
        self.received += 1;
        let request = Request { number: self.received, text: String::new(), id: String::new() };
        let why = format!("the line is longer than {MAX_LINE_BYTES} bytes");
        self.refuse(&request, &Refused::new(RefusalReason::Unreadable, why))?;
        text.push_str(&self.take());
        Ok(text)
    }

    /// The command of a line, with its text and the values of its fields.
    fn command(&self, line: &[u8]) -> Result<(String, &'l CommandRule, Values), Refused> {
        let unreadable = |why: &str| Refused::new(RefusalReason::Unreadable, why);
        let line = std::str::from_utf8(line)
            .map_err(|_| unreadable("the line is not text in UTF-8"))?
            .trim_matches([' ', '\t']);
        if line.len() > MAX_LINE_BYTES {
            return Err(unreadable(&format!("the line is longer than {MAX_LINE_BYTES} bytes")));
        }
        let text = self.language.input.text_of(line).ok_or_else(|| {
            unreadable("the line does not have the form of `[input]`, or its checksum is incorrect")
        })?;
        let text = text.trim_matches([' ', '\t']);
        let vocabulary = Vocabulary {
            cell: self.controller.cell(),
            station_codes: self.language.station_codes.as_ref(),
            effector_codes: self.language.effector_codes.as_ref(),
        };
        let mut nearest: Option<(Mismatch, &CommandRule)> = None;
        for rule in &self.language.commands {
            match rule.pattern.values(text, vocabulary) {
                Ok(values) => return Ok((text.to_owned(), rule, values)),
                Err(mismatch) => {
                    let fits_more = |(least, _): &(Mismatch, _)| mismatch.rank() > least.rank();
                    if mismatch.rank() > 0 && nearest.as_ref().is_none_or(fits_more) {
                        nearest = Some((mismatch, rule));
                    }
                }
            }
        }
        let why = match nearest {
            Some((
                Mismatch::Field { found, expected, .. } | Mismatch::Text { found, expected, .. },
                rule,
            )) => {
                let found = if found.is_empty() {
                    "the end of the line".to_owned()
                } else {
                    format!("{found:?}")
                };
                format!("found {found} in place of {expected}; the command is {}", rule.text)
            }
            None => {
                let known: Vec<&str> =
                    self.language.commands.iter().map(|rule| rule.text.as_str()).collect();
                format!("not a command; commands: {}", known.join(" | "))
            }
        };
        Err(Refused::new(RefusalReason::Unknown, why))
    }

    /// Plans a program and starts it.
    fn start(
        &mut self,
        request: Request,
        templates: &[Template],
        values: &Values,
        now: f64,
    ) -> Answered {
        if let Some(moving) = &self.moving {
            let why = format!("the robot executes {}", moving.request.text);
            return self.refuse(&request, &Refused::new(RefusalReason::Busy, why));
        }
        let axes = &self.controller.cell().robot.axes;
        let unit = values.iter().find_map(|(name, value)| match (*name, value) {
            ("axis", Value::Text(axis)) => axes.iter().find(|one| one.name == *axis),
            _ => None,
        });
        let unit = unit_of(unit.map_or(AxisKind::Linear, |axis| axis.kind));
        let value = |name: &str| {
            if name == UNIT {
                return Value::Text(unit.to_owned());
            }
            match values.iter().find(|(known, _)| *known == name) {
                Some((_, Value::Text(text))) => {
                    Value::Text(format!("\"{}\"", text.replace('"', "\"\"")))
                }
                Some((_, value)) => value.clone(),
                None => Value::Text(String::new()),
            }
        };
        let planned = match program_text(templates, value) {
            Ok(text) => self.plan(&text),
            Err(problem) => Err(Refused::new(RefusalReason::Invalid, problem.to_string())),
        };
        match planned {
            Ok(execution) => {
                let end = execution.trajectory.duration();
                let lines = &self.language.answer.accepted;
                self.answer(lines, &request, |_| Value::Real(end))?;
                self.log.push(&request.text, Outcome::Accepted { duration: end });
                let execution = Arc::new(execution);
                self.moving = Some(Moving { request, execution, start: now, end, last_step: None });
                // A program without motion, such as a setting of the speed, ends at once.
                let text = self.take();
                let ended = self.advance(now)?;
                self.output.text.push_str(&text);
                self.output.text.push_str(&ended);
                Ok(())
            }
            Err(refused) => self.refuse(&request, &refused),
        }
    }

    fn plan(&mut self, text: &str) -> Result<Execution, Refused> {
        let invalid = |why: String| Refused::new(RefusalReason::Invalid, why);
        let program = program::parse(text).map_err(|errors| {
            invalid(errors.first().map_or_else(String::new, ToString::to_string))
        })?;
        let planned = self.controller.plan(&program, &PlanOptions::default());
        planned.map_err(|refusal| Refused::of(refusal, self.controller.cell(), text))
    }

    fn act(&mut self, request: &Request, action: Action, values: &Values, now: f64) -> Answered {
        match action {
            Action::Status => self.status(request, now),
            Action::Map => self.map(request, values, now),
            Action::Stop => match &mut self.moving {
                None => {
                    let lines = &self.language.answer.stopped;
                    self.answer(lines, request, |_| Value::Real(0.0))
                }
                Some(moving) => {
                    let time = (now - moving.start) * self.speed;
                    let step = moving.execution.stopping_step(time);
                    moving.end = moving.execution.trajectory.times[step + 1].min(moving.end);
                    // At the end of its last step, the program is completed.
                    let is_last = step + 1 == moving.execution.trajectory.steps.len();
                    moving.last_step = (!is_last).then_some(step);
                    let remaining = (moving.end - time).max(0.0);
                    let lines = &self.language.answer.accepted;
                    self.answer(lines, request, |_| Value::Real(remaining))
                }
            },
            Action::Reset if self.moving.is_some() => {
                let why = "the robot moves; it can be stopped first";
                self.refuse(request, &Refused::new(RefusalReason::Busy, why))
            }
            Action::Reset => {
                self.controller.reset();
                self.log.push(&request.text, Outcome::Completed { duration: 0.0 });
                let lines = &self.language.answer.completed;
                self.answer(lines, request, |_| Value::Real(0.0))
            }
        }
    }

    fn status(&mut self, request: &Request, now: f64) -> Answered {
        let cell = self.controller.cell();
        let (positions, remaining) = match &self.moving {
            Some(moving) => {
                let time = (now - moving.start) * self.speed;
                let sample = moving.execution.trajectory.sample_at(time);
                (sample.positions, (moving.end - time).max(0.0))
            }
            None => (self.controller.state().positions.clone(), 0.0),
        };
        let positions = self.language.axis.values(&cell.robot, &positions)?;
        let locations = self.locations(now);
        let effectors = cell.robot.effectors().map(|id| {
            self.language.effector.fill(|name| match name {
                "name" => Value::Text(cell.effector_name(id).to_owned()),
                _ => count(usize::from(locations.occupant(WaferLocation::Effector(id)).is_some())),
            })
        });
        let effectors = effectors.collect::<Result<Vec<_>, _>>()?.join(&self.language.axis.between);
        let state = if self.moving.is_some() { "moving" } else { "idle" };
        let axes = self.axes();
        let lines = &self.language.answer.status;
        self.answer(lines, request, |name| match name {
            "state" => Value::Text(state.to_owned()),
            "remaining" => Value::Real(remaining),
            "axes" => Value::Text(axes.clone()),
            "positions" => Value::Text(positions.clone()),
            _ => Value::Text(effectors.clone()),
        })
    }

    fn map(&mut self, request: &Request, values: &Values, now: f64) -> Answered {
        let cell = self.controller.cell();
        let name = values.iter().find(|(name, _)| *name == "station");
        let Some((_, Value::Text(name))) = name else { return Ok(()) };
        let station = cell.stations.iter().position(|station| station.name == *name);
        let Some(station) = station else { return Ok(()) };
        let locations = self.locations(now);
        let slots = (1..=cell.stations[station].slots).map(|slot| {
            let location = WaferLocation::Slot(SlotId { station, slot });
            self.language.slot.fill(|name| match name {
                "number" => count(slot),
                _ => count(usize::from(locations.occupant(location).is_some())),
            })
        });
        let slots = slots.collect::<Result<Vec<_>, _>>()?.join(&self.language.axis.between);
        let code = self.language.station_codes.as_ref().map(|codes: &Codes| codes.code(name));
        let lines = &self.language.answer.map;
        self.answer(lines, request, |known| match known {
            "station" => Value::Text(name.clone()),
            "station_code" => code.clone().unwrap_or(Value::Text(String::new())),
            _ => Value::Text(slots.clone()),
        })
    }

    /// Locations of the wafers at a time.
    fn locations(&self, now: f64) -> WaferLocations {
        match &self.moving {
            Some(moving) => {
                let time = (now - moving.start) * self.speed;
                moving.execution.locations_at(self.controller.cell(), time)
            }
            None => self.controller.locations(),
        }
    }

    fn axes(&self) -> String {
        let axes = self.controller.cell().robot.axes.iter().map(|axis| axis.name.as_str());
        axes.collect::<Vec<_>>().join(&self.language.axis.between)
    }

    fn refuse(&mut self, request: &Request, refused: &Refused) -> Answered {
        let (reason, message) = (refused.reason, one_line(&refused.text));
        self.log.push(&request.text, Outcome::Refused { reason, message });
        let lines = &self.language.answer.refused;
        self.answer(lines, request, |name| match name {
            "code" => Value::Integer(refused.reason.code()),
            "reason" => Value::Text(refused.reason.word().to_owned()),
            _ => Value::Text(one_line(&refused.text)),
        })
    }

    /// Adds an answer to a request.
    fn answer(
        &mut self,
        lines: &[Template],
        request: &Request,
        value: impl Fn(&str) -> Value,
    ) -> Answered {
        self.push(lines, |name| match name {
            "number" => count(request.number),
            "command" => Value::Text(request.text.clone()),
            IDENTIFIER => Value::Text(request.id.clone()),
            name => value(name),
        })
    }

    fn push(&mut self, lines: &[Template], value: impl Fn(&str) -> Value) -> Answered {
        lines.iter().try_for_each(|line| self.output.push(&line.fill(&value)?))
    }

    fn take(&mut self) -> String {
        std::mem::take(&mut self.output.text)
    }
}
