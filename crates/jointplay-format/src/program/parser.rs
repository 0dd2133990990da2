//! From text to a program.

use jointplay_cell::program::{
    AllowedValues, Branch, Command, Condition, Instruction, Name, Number, Parameter, Program,
    Routine, SourceLocation,
};

use super::commands::{list, simple};
use super::condition::condition;
use super::cursor::Cursor;
use super::dimension::unit_errors;
use super::lexer::{Kind, lines};
use super::problem::{Error, Problem};
use super::words::{COMMANDS, meant};
use crate::place;

/// Longer texts are refused unread.
pub const MAX_BYTES: usize = 1_000_000;

/// Greatest depth of nested blocks.
pub const MAX_DEPTH: usize = 32;

/// Whether a text is a program and no file of another kind: most of its lines begin with a command.
#[must_use]
pub fn is_program(text: &str) -> bool {
    let (mut commands, mut others) = (0_usize, 0_usize);
    for line in lines(text) {
        let Some(first) = line.tokens.first() else { continue };
        // A key of a TOML file may have the name of a command.
        let is_key = line.tokens.get(1).is_some_and(|next| next.text == "=");
        match !is_key && COMMANDS.into_iter().any(|command| first.is(command)) {
            true => commands += 1,
            false => others += 1,
        }
    }
    commands > others
}

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
    let (program, mut errors) = parser.finish();
    if errors.is_empty() {
        errors = unit_errors(text, &program);
    }
    (program, errors)
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
        times: Number,
        counter: Option<Name>,
    },
    If {
        /// Branches before the open one.
        branches: Vec<Branch>,
        /// Condition of the open branch; `None` after ELSE.
        condition: Option<Condition>,
    },
    Routine {
        name: Name,
        parameters: Vec<Name>,
    },
    /// An invalid block, which still has an END.
    Lost(&'static str),
}

impl Block {
    fn word(&self) -> &'static str {
        match self.kind {
            BlockKind::Repeat { .. } => "REPEAT",
            BlockKind::If { .. } => "IF",
            BlockKind::Routine { .. } => "ROUTINE",
            BlockKind::Lost(word) => word,
        }
    }

    /// The problem of a declaration within this block.
    fn contains(&self, inner: &'static str) -> Problem {
        Problem::InnerDeclaration { inner, outer: self.word(), line: self.place.line }
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
            "IF" => self.opened(cursor, opening, "IF", branch),
            "ELSE" => self.otherwise(cursor, opening),
            "PARAMETER" => self.parameter(cursor, opening),
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
            Some(outer) if word == "ROUTINE" => Some(outer.contains(word)),
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

    /// Opens the next branch of an IF.
    fn otherwise(&mut self, cursor: &mut Cursor<'_, '_>, place: place::Place) -> Result<(), Error> {
        let next = if cursor.accept("IF") { condition(cursor).map(Some) } else { Ok(None) };
        let next = next.and_then(|next| cursor.end().map(|()| next));
        let Some(Block { kind, body, .. }) = self.open.last_mut() else {
            return Err(Error { place, problem: Box::new(Problem::UnmatchedElse) });
        };
        match kind {
            BlockKind::If { branches, condition } => {
                let Some(before) = condition.take() else {
                    *kind = BlockKind::Lost("IF");
                    return Err(Error { place, problem: Box::new(Problem::ElseAfterElse) });
                };
                branches.push(Branch { condition: before, body: std::mem::take(body) });
                match next {
                    Ok(next) => *condition = next,
                    Err(error) => {
                        *kind = BlockKind::Lost("IF");
                        return Err(error);
                    }
                }
                Ok(())
            }
            BlockKind::Lost("IF") => next.map(|_| ()),
            _ => Err(Error { place, problem: Box::new(Problem::UnmatchedElse) }),
        }
    }

    /// Declares a parameter of the program.
    fn parameter(&mut self, cursor: &mut Cursor<'_, '_>, place: place::Place) -> Result<(), Error> {
        if let Some(outer) = self.open.last() {
            return Err(Error { place, problem: Box::new(outer.contains("PARAMETER")) });
        }
        self.program.parameters.push(parameter(cursor)?);
        Ok(())
    }

    /// Adds a complete block to the block around it.
    fn close(&mut self, Block { kind, place, body }: Block) {
        let place = SourceLocation { line: place.line, column: place.column };
        match kind {
            BlockKind::Repeat { times, counter } => {
                self.push(Instruction { place, command: Command::Repeat { times, counter, body } });
            }
            BlockKind::If { mut branches, condition } => {
                let otherwise = match condition {
                    Some(condition) => {
                        branches.push(Branch { condition, body });
                        Vec::new()
                    }
                    None => body,
                };
                self.push(Instruction { place, command: Command::If { branches, otherwise } });
            }
            BlockKind::Routine { name, parameters } => {
                self.program.routines.push(Routine { name, parameters, body });
            }
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
        let lost = ["REPEAT", "ROUTINE", "IF"].into_iter().find(|word| nearest == Some(word));
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
    // A literal number of passes is at least 1; an expression may be 0.
    let allowed = AllowedValues { min: 1.0, ..AllowedValues::PASSES };
    let times = cursor.literal_or_number("the number of passes", allowed)?;
    let counter = if cursor.accept("AS") { Some(cursor.name("a counter")?) } else { None };
    Ok(BlockKind::Repeat { times, counter })
}

fn routine(cursor: &mut Cursor<'_, '_>) -> Result<BlockKind, Error> {
    let name = cursor.name("a routine")?;
    let parameters = list(cursor, |cursor| cursor.name("a parameter"))?;
    Ok(BlockKind::Routine { name, parameters })
}

fn branch(cursor: &mut Cursor<'_, '_>) -> Result<BlockKind, Error> {
    Ok(BlockKind::If { branches: Vec::new(), condition: Some(condition(cursor)?) })
}

/// The declaration of a parameter, up to the end of the line.
pub(super) fn parameter(cursor: &mut Cursor<'_, '_>) -> Result<Parameter, Error> {
    let name = cursor.name("a parameter")?;
    cursor.require_sign("=", "`=`")?;
    let (value, unit) = cursor.number_with_unit("the number of its value")?;
    let range = if cursor.accept("FROM") {
        let min = cursor.bound(unit)?;
        cursor.require("TO")?;
        Some([min, cursor.bound(unit)?])
    } else {
        None
    };
    cursor.end()?;
    Ok(Parameter { name, value, unit, range })
}
