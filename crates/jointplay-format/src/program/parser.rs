//! From text to a program.

use jointplay_cell::program::{
    AxisTarget, Command, Instruction, Name, Program, Routine, SlotName, SlotNumber, SourceLocation,
};
use jointplay_cell::robot::AxisKind;
use jointplay_core::spatial::Tilt;

use super::cursor::Cursor;
use super::lexer::{Kind, lines};
use super::problem::{Error, Problem};
use super::words::{COMMANDS, DIRECTIONS, Unit, meant};
use crate::place;

/// Longer texts are refused unread.
pub const MAX_BYTES: usize = 1_000_000;

/// Greatest depth of nested blocks.
pub const MAX_DEPTH: usize = 32;

/// Farthest target of an axis, of a rotary and of a linear one (deg or mm).
const FARTHEST: f64 = 1e6;
/// Longest pause: a day (s).
const LONGEST_WAIT: f64 = 86_400.0;
/// Largest tilt; rods cannot support a vertical platform (deg).
const STEEPEST: f64 = 89.0;
/// Lowest speed (% of the limits).
const SLOWEST: f64 = 0.01;
/// Largest blend radius (mm).
const WIDEST_BLEND: f64 = 1000.0;
/// Largest number of a slot, far above the slots of any station.
const MOST_SLOTS: i64 = 100_000;
/// Largest number of passes in a text; planning limits it further.
const MOST_PASSES: i64 = 1_000_000_000_000_000;

/// Reads a program.
///
/// # Errors
/// All errors, at most one per line, in the order of the text.
pub fn parse(text: &str) -> Result<Program, Vec<Error>> {
    let (program, errors) = parse_recovering(text);
    if errors.is_empty() { Ok(program) } else { Err(errors) }
}

/// Reads the valid lines of a program, and returns the errors of the others.
///
/// A block whose first line is invalid is omitted with all its lines.
#[must_use]
pub fn parse_recovering(text: &str) -> (Program, Vec<Error>) {
    if text.len() > MAX_BYTES {
        let problem = Problem::TooLong { found: text.len(), allowed: MAX_BYTES };
        return (Program::default(), vec![Error::at(text, 0..0, problem)]);
    }
    let mut parser = Parser::default();
    for line in lines(text) {
        let mut cursor = Cursor::new(&line);
        if let Err(error) = parser.line(&mut cursor) {
            parser.errors.push(error);
        }
    }
    parser.finish()
}

#[derive(Default)]
struct Parser {
    program: Program,
    /// Open blocks, from the outermost to the innermost.
    open: Vec<Block>,
    errors: Vec<Error>,
}

/// A block before its END.
struct Block {
    kind: BlockKind,
    place: place::Place,
    body: Vec<Instruction>,
}

enum BlockKind {
    Repeat {
        times: u64,
        counter: Option<Name>,
    },
    Routine(Name),
    /// An invalid block, which still has an END.
    Lost(&'static str),
}

impl Block {
    fn word(&self) -> &'static str {
        match self.kind {
            BlockKind::Repeat { .. } => "REPEAT",
            BlockKind::Routine(_) => "ROUTINE",
            BlockKind::Lost(word) => word,
        }
    }
}

impl Parser {
    fn line(&mut self, cursor: &mut Cursor<'_, '_>) -> Result<(), Error> {
        let Some(first) = cursor.peek() else { return Ok(()) };
        let place = cursor.place();
        let Some(command) = COMMANDS.into_iter().find(|command| first.is(command)) else {
            return Err(self.unknown(cursor));
        };
        let opening = cursor.error(Problem::UnmatchedEnd).place;
        cursor.advance();
        match command {
            "REPEAT" => self.opened(cursor, opening, "REPEAT", repeat),
            "ROUTINE" => self.opened(cursor, opening, "ROUTINE", routine),
            "END" => self.closed(cursor, opening),
            _ => {
                let command = simple(command, cursor)?;
                cursor.end()?;
                self.push(Instruction { place, command });
                Ok(())
            }
        }
    }

    /// Adds an instruction to the innermost open block.
    fn push(&mut self, instruction: Instruction) {
        let body = self.open.last_mut().map_or(&mut self.program.body, |block| &mut block.body);
        body.push(instruction);
    }

    fn opened(
        &mut self,
        cursor: &mut Cursor<'_, '_>,
        place: place::Place,
        word: &'static str,
        read: fn(&mut Cursor<'_, '_>) -> Result<BlockKind, Error>,
    ) -> Result<(), Error> {
        let problem = match self.open.last() {
            Some(outer) if word == "ROUTINE" => {
                Some(Problem::InnerRoutine { outer: outer.word(), line: outer.place.line })
            }
            _ if self.open.len() >= MAX_DEPTH => Some(Problem::TooDeep { allowed: MAX_DEPTH }),
            _ => None,
        };
        let read = match problem {
            Some(problem) => Err(Error { place: place.clone(), problem: Box::new(problem) }),
            None => read(cursor).and_then(|kind| cursor.end().map(|()| kind)),
        };
        // Its END follows in any case.
        let (kind, result) = match read {
            Ok(kind) => (kind, Ok(())),
            Err(error) => (BlockKind::Lost(word), Err(error)),
        };
        self.open.push(Block { kind, place, body: Vec::new() });
        result
    }

    fn closed(&mut self, cursor: &mut Cursor<'_, '_>, end: place::Place) -> Result<(), Error> {
        let Some(block) = self.open.pop() else {
            return Err(Error { place: end, problem: Box::new(Problem::UnmatchedEnd) });
        };
        self.close(block);
        cursor.end()
    }

    /// Adds a complete block to the block around it.
    fn close(&mut self, Block { kind, place, body }: Block) {
        let place = SourceLocation { line: place.line, column: place.column };
        match kind {
            BlockKind::Repeat { times, counter } => {
                self.push(Instruction { place, command: Command::Repeat { times, counter, body } });
            }
            BlockKind::Routine(name) => self.program.routines.push(Routine { name, body }),
            BlockKind::Lost(_) => {}
        }
    }

    /// The error of a line that starts with no command.
    fn unknown(&mut self, cursor: &Cursor<'_, '_>) -> Error {
        let (found, is_word) = cursor
            .peek()
            .map_or_else(Default::default, |token| (token.text, token.kind == Kind::Word));
        let nearest = meant(found, COMMANDS.into_iter()).filter(|_| is_word);
        let found: String = found.escape_debug().collect();
        let error = cursor.error(Problem::Command {
            found,
            known: COMMANDS.map(str::to_owned).to_vec(),
            nearest: nearest.map(str::to_owned),
        });
        // A misspelt block has an END, which is not an error of its own.
        let lost = ["REPEAT", "ROUTINE"].into_iter().find(|word| nearest == Some(word));
        if let Some(word) = lost {
            self.open.push(Block {
                kind: BlockKind::Lost(word),
                place: error.place.clone(),
                body: Vec::new(),
            });
        }
        error
    }

    fn finish(mut self) -> (Program, Vec<Error>) {
        while let Some(block) = self.open.pop() {
            let problem = Box::new(Problem::NoEnd { opened: block.word() });
            self.errors.push(Error { place: block.place.clone(), problem });
            self.close(block);
        }
        self.errors.sort_by_key(|error| (error.place.line, error.place.column));
        (self.program, self.errors)
    }
}

fn repeat(cursor: &mut Cursor<'_, '_>) -> Result<BlockKind, Error> {
    let what = "the number of passes";
    let times = cursor.accept_whole(what, 1, MOST_PASSES)?.ok_or_else(|| cursor.unexpected())?;
    let times = times.unsigned_abs();
    let counter = if cursor.accept("AS") { Some(cursor.name("a counter")?) } else { None };
    Ok(BlockKind::Repeat { times, counter })
}

fn routine(cursor: &mut Cursor<'_, '_>) -> Result<BlockKind, Error> {
    cursor.name("a routine").map(BlockKind::Routine)
}

/// The arguments of a command that is no block.
fn simple(command: &str, cursor: &mut Cursor<'_, '_>) -> Result<Command, Error> {
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
            cursor.require("GET")?;
            let get = cursor.name("an effector")?;
            cursor.require("PUT")?;
            Command::Swap { at, get, put: cursor.name("an effector")? }
        }
        "GOTO" => Command::Goto { to: slot(cursor)?, effector: with(cursor)? },
        "WAIT" => {
            let (seconds, _) = cursor.quantity("a time", &[(Unit::Second, 0.0, LONGEST_WAIT)])?;
            Command::Wait { seconds }
        }
        "SPEED" => {
            let allowed = [(Unit::Percent, SLOWEST, 100.0)];
            Command::Speed { fraction: cursor.quantity("a share of the limits", &allowed)?.0 }
        }
        "BLEND" if cursor.accept("OFF") => Command::Blend { radius: 0.0 },
        "BLEND" => {
            let allowed = [(Unit::Millimeter, 0.0, WIDEST_BLEND)];
            Command::Blend { radius: cursor.quantity("a radius of blending", &allowed)?.0 }
        }
        "TILT" => Command::Tilt { tilt: tilt(cursor)? },
        _ => Command::Call { routine: cursor.name("a routine")? },
    })
}

fn axes(cursor: &mut Cursor<'_, '_>) -> Result<Command, Error> {
    const ALLOWED: [(Unit, f64, f64); 2] =
        [(Unit::Degree, -FARTHEST, FARTHEST), (Unit::Millimeter, -FARTHEST, FARTHEST)];
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
        let (position, unit) = cursor.quantity("a position", &ALLOWED)?;
        let kind = if unit == Unit::Degree { AxisKind::Rotary } else { AxisKind::Linear };
        targets.push(AxisTarget { axis, kind, position });
    }
}

fn line(cursor: &mut Cursor<'_, '_>) -> Result<Command, Error> {
    let effector = with(cursor)?;
    cursor.require("BY")?;
    let mut by = [None; 3];
    loop {
        let column = cursor.place().column;
        let Some(direction) = DIRECTIONS.into_iter().position(|word| cursor.accept(word)) else {
            if by == [None; 3] {
                return Err(cursor.unexpected());
            }
            return Ok(Command::MoveLine { effector, by: by.map(|it| it.unwrap_or(0.0)) });
        };
        if by[direction].is_some() {
            let problem = Problem::Twice { name: DIRECTIONS[direction].to_owned() };
            return Err(cursor.error_at(column, 1, problem));
        }
        let allowed = [(Unit::Millimeter, -FARTHEST, FARTHEST)];
        by[direction] = Some(cursor.quantity("a length", &allowed)?.0);
    }
}

fn with(cursor: &mut Cursor<'_, '_>) -> Result<Option<Name>, Error> {
    if cursor.accept("WITH") { cursor.name("an effector").map(Some) } else { Ok(None) }
}

fn slot(cursor: &mut Cursor<'_, '_>) -> Result<SlotName, Error> {
    let station = cursor.name("a station")?;
    let slot = if cursor.accept("SLOT") { Some(slot_number(cursor)?) } else { None };
    Ok(SlotName { station, slot })
}

fn slot_number(cursor: &mut Cursor<'_, '_>) -> Result<SlotNumber, Error> {
    let place = cursor.place();
    // A decreasing slot number may start beyond the last slot.
    if let Some(number) = cursor.accept_whole("the number of the slot", 1, MOST_SLOTS)? {
        if cursor.accept_sign("-") {
            let counter = cursor.name("a counter")?;
            return Ok(SlotNumber::Counted { counter, offset: number, down: true });
        }
        let number = usize::try_from(number).unwrap_or(usize::MAX);
        return Ok(SlotNumber::Fixed { number, place });
    }
    let counter = cursor.name("a counter")?;
    let plus = cursor.accept_sign("+");
    let minus = !plus && cursor.accept_sign("-");
    // Without a space, the sign is part of the number token.
    let signed = cursor.peek().is_some_and(|next| next.text.starts_with(['+', '-']));
    let offset = if plus || minus || signed {
        let what = "the number added to the counter";
        let number = cursor.accept_whole(what, -MOST_SLOTS, MOST_SLOTS)?;
        let number = number.ok_or_else(|| cursor.unexpected())?;
        if minus { -number } else { number }
    } else {
        0
    };
    Ok(SlotNumber::Counted { counter, offset, down: false })
}

fn tilt(cursor: &mut Cursor<'_, '_>) -> Result<Tilt, Error> {
    if cursor.accept("LEVEL") {
        return Ok(Tilt::LEVEL);
    }
    let (pitch, _) = cursor.quantity("a tilt", &[(Unit::Degree, -STEEPEST, STEEPEST)])?;
    cursor.require("TOWARD")?;
    let (yaw, _) = cursor.quantity("an azimuth", &[(Unit::Degree, -FARTHEST, FARTHEST)])?;
    Ok(Tilt { yaw, pitch })
}
