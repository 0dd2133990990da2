//! Programs as text: what is read, what is refused, and that writing and laying out lose nothing.

#![expect(clippy::unwrap_used, reason = "tests may")]

use jointplay_cell::program::{
    AxisTarget, Command, Instruction, MAX_CALLS, Name, Program, Routine, SlotName, SlotNumber,
    SourceLocation,
};
use jointplay_cell::robot::AxisKind;
use jointplay_core::spatial::Tilt;
use jointplay_format::program::{MAX_BYTES, MAX_DEPTH, format, parse, write};
use proptest::prelude::*;

/// A name whose place is of no matter.
fn name(text: &str) -> Name {
    Name { text: text.to_owned(), place: SourceLocation::default() }
}

fn slot(station: &str, slot: Option<SlotNumber>) -> SlotName {
    SlotName { station: name(station), slot }
}

fn fixed(number: usize) -> Option<SlotNumber> {
    Some(SlotNumber::Fixed { number, place: SourceLocation::default() })
}

/// The same program without the places of its parts.
fn anywhere(mut program: Program) -> Program {
    program.body.iter_mut().for_each(forget);
    for routine in &mut program.routines {
        routine.name.place = SourceLocation::default();
        routine.body.iter_mut().for_each(forget);
    }
    program
}

fn forget(instruction: &mut Instruction) {
    fn at(slot: &mut SlotName) {
        slot.station.place = SourceLocation::default();
        match &mut slot.slot {
            Some(SlotNumber::Fixed { place, .. }) => *place = SourceLocation::default(),
            Some(SlotNumber::Counted { counter, .. }) => counter.place = SourceLocation::default(),
            None => {}
        }
    }
    fn of(name: &mut Option<Name>) {
        if let Some(name) = name {
            name.place = SourceLocation::default();
        }
    }
    instruction.place = SourceLocation::default();
    match &mut instruction.command {
        Command::Move { targets } => {
            targets.iter_mut().for_each(|target| target.axis.place = SourceLocation::default());
        }
        Command::MoveLine { effector, .. } => of(effector),
        Command::Get { from: slot, effector }
        | Command::Put { to: slot, effector }
        | Command::Goto { to: slot, effector } => {
            at(slot);
            of(effector);
        }
        Command::Transfer { from, to, effector } => {
            at(from);
            at(to);
            of(effector);
        }
        Command::Swap { at: slot, get, put } => {
            at(slot);
            get.place = SourceLocation::default();
            put.place = SourceLocation::default();
        }
        Command::Call { routine } => routine.place = SourceLocation::default(),
        Command::Repeat { counter, body, .. } => {
            of(counter);
            body.iter_mut().for_each(forget);
        }
        Command::Home
        | Command::Wait { .. }
        | Command::Speed { .. }
        | Command::Blend { .. }
        | Command::Tilt { .. } => {}
    }
}

/// Checks the command of a line.
#[track_caller]
fn reads_as(line: &str, command: Command) {
    let program = anywhere(parse(line).unwrap());
    let [instruction] = &program.body[..] else { panic!("{program:?}") };
    assert_eq!(instruction.command, command);
}

#[test]
fn every_command_is_read() {
    let axis = |axis: &str, kind, position| AxisTarget { axis: name(axis), kind, position };
    let some = |text: &str| Some(name(text));
    reads_as("HOME", Command::Home);
    reads_as(
        "move T -30deg R 200.5 MM # both",
        Command::Move {
            targets: vec![
                axis("T", AxisKind::Rotary, (-30_f64).to_radians()),
                axis("R", AxisKind::Linear, 0.2005),
            ],
        },
    );
    reads_as(
        "MOVE LINE WITH A BY x 10 mm Z -0.5 mm",
        Command::MoveLine { effector: some("A"), by: [0.01, 0.0, -0.0005] },
    );
    reads_as("MOVE LINE BY Y 1e2 mm", Command::MoveLine { effector: None, by: [0.0, 0.1, 0.0] });
    let from = slot("port-1", fixed(3));
    reads_as("Get port-1 Slot 3 With A", Command::Get { from: from.clone(), effector: some("A") });
    reads_as("PUT aligner", Command::Put { to: slot("aligner", None), effector: None });
    reads_as("PUT \"SLOT\"", Command::Put { to: slot("SLOT", None), effector: None });
    reads_as(
        "TRANSFER port-1 SLOT 3 TO \"the \"\"hot\"\" one\" WITH A",
        Command::Transfer {
            from: from.clone(),
            to: slot("the \"hot\" one", None),
            effector: some("A"),
        },
    );
    reads_as(
        "SWAP port-1 SLOT 3 GET A PUT B",
        Command::Swap { at: from.clone(), get: name("A"), put: name("B") },
    );
    reads_as("GOTO port-1 SLOT 3", Command::Goto { to: from, effector: None });
    reads_as("WAIT 0.25 s", Command::Wait { seconds: 0.25 });
    reads_as("SPEED 50 %", Command::Speed { fraction: 0.5 });
    reads_as("SPEED 33.3%", Command::Speed { fraction: 0.333 });
    reads_as("BLEND 2.5 mm", Command::Blend { radius: 0.0025 });
    reads_as("blend off", Command::Blend { radius: 0.0 });
    reads_as("TILT LEVEL", Command::Tilt { tilt: Tilt::LEVEL });
    reads_as(
        "TILT 0.8 deg TOWARD 90 deg",
        Command::Tilt { tilt: Tilt { pitch: 0.8_f64.to_radians(), yaw: 90_f64.to_radians() } },
    );
    reads_as("CALL lot", Command::Call { routine: name("lot") });
}

#[test]
fn slot_numbers_may_depend_on_a_counter() {
    let counted = |offset, down| {
        let number = SlotNumber::Counted { counter: name("n"), offset, down };
        Command::Get { from: slot("port", Some(number)), effector: None }
    };
    reads_as("GET port SLOT n", counted(0, false));
    for plus in ["n + 3", "n +3", "n+3", "n+ 3"] {
        reads_as(&format!("GET port SLOT {plus}"), counted(3, false));
    }
    reads_as("GET port SLOT n - 1", counted(-1, false));
    reads_as("GET port SLOT n -1", counted(-1, false));
    reads_as("GET port SLOT \"n\"-1", counted(-1, false));
    for minus in ["26 - n", "26-n", "26 -n"] {
        reads_as(&format!("GET port SLOT {minus}"), counted(26, true));
    }
}

#[test]
fn blocks_contain_the_lines_up_to_their_end() {
    let text = "\u{feff}call twice\r\n\r\nROUTINE twice # here\r\n  repeat 2 as n\r\n    REPEAT 3\n HOME\nEND\n  END\nEND\nHOME";
    let program = parse(text).unwrap();
    assert_eq!(program.body.len(), 2);
    assert_eq!(program.body[1].place, SourceLocation { line: 10, column: 1 });
    let [routine] = &program.routines[..] else { panic!() };
    assert_eq!(
        routine.name,
        Name { text: "twice".to_owned(), place: SourceLocation { line: 3, column: 9 } }
    );
    let Command::Repeat { times: 2, counter: Some(counter), body } = &routine.body[0].command
    else {
        panic!()
    };
    assert_eq!(counter.text, "n");
    assert_eq!(routine.body[0].place, SourceLocation { line: 4, column: 3 });
    let Command::Repeat { times: 3, counter: None, body } = &body[0].command else { panic!() };
    assert_eq!(body[0].command, Command::Home);
}

/// All messages of a text, with their places.
fn refused(text: &str) -> String {
    let errors = parse(text).unwrap_err();
    let lines = errors
        .iter()
        .map(|error| format!("{}:{}: {error}\n", error.place.line, error.place.column));
    lines.collect()
}

#[test]
fn syntax_errors_name_their_line_and_column() {
    insta::assert_snapshot!(refused(include_str!("programs/invalid.program")));
}

#[test]
fn an_error_shows_its_line_with_carets() {
    let errors = parse("HOME\nWAIT 2 ms  # long").unwrap_err();
    assert_eq!(
        errors[0].with_excerpt("lot.program"),
        "lot.program:2:8: 2 ms: the unit has to be s\n  |\n2 | WAIT 2 ms  # long\n  |        ^^"
    );
}

#[test]
fn the_fuzzing_seed_contains_every_command() {
    let text = include_str!("../../../fuzz/seeds/program/all.program");
    assert_eq!(format(text).unwrap(), text);
    for command in
        ["HOME", "SPEED", "MOVE", "LINE", "GOTO", "CALL", "WAIT", "BLEND", "TILT", "SWAP"]
    {
        assert!(text.contains(command));
    }
}

#[test]
fn examples_of_the_reference_are_formatted_programs() {
    let page = include_str!("../../../docs/reference/programs.md");
    let examples: Vec<&str> =
        page.split("```program\n").skip(1).map(|rest| rest.split_once("```").unwrap().0).collect();
    for example in &examples {
        let even = format(example).unwrap_or_else(|errors| panic!("{example}{errors:?}"));
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(words(&even), words(example));
    }
    let all = examples.concat();
    let headings = page.lines().filter_map(|line| line.strip_prefix("### "));
    for command in headings.flat_map(|heading| heading.split(" and ")) {
        assert!(all.lines().any(|line| line.starts_with(command)), "{command} has no example");
        assert!(page.contains(&format!("\"{}\"", command.split(' ').next().unwrap())));
    }
    assert_eq!(page.matches("\n### ").count(), 14);
    for limit in [MAX_DEPTH, MAX_CALLS] {
        assert!(page.contains(&format!("| {limit} |")));
    }
}

#[test]
fn length_and_depth_are_limited() {
    let long = "#".repeat(MAX_BYTES + 1);
    assert!(refused(&long).contains("at most 1000000 are allowed"));
    assert!(parse(&long[..MAX_BYTES]).is_ok());
    let deep = |depth: usize| "REPEAT 2\n".repeat(depth) + &"END\n".repeat(depth);
    assert!(parse(&deep(MAX_DEPTH)).is_ok());
    let message = refused(&deep(MAX_DEPTH + 2));
    assert_eq!(message.lines().count(), 2, "{message}");
    assert!(message.contains("33:1: blocks are nested more than 32 deep"), "{message}");
}

#[test]
fn formatting_preserves_comments() {
    let text = "\n\n#lot\n\n\nrepeat 25 as n#each\nget port  slot n+1 with A   ##  two\n\n  Move line with x by x 1MM y -2 mm\n# last\nend\nSpeed 50%\n";
    let even = "# lot\n\nREPEAT 25 AS n  # each\n  GET port SLOT n + 1 WITH A  ##  two\n\n  MOVE LINE WITH x BY X 1 mm Y -2 mm\n  # last\nEND\nSPEED 50 %\n";
    assert_eq!(format(text).unwrap(), even);
    assert_eq!(format(even).unwrap(), even);
    assert_eq!(anywhere(parse(text).unwrap()), anywhere(parse(even).unwrap()));
    assert!(format("GET").is_err());
}

/// Names, some of which need quotes.
fn names() -> impl Strategy<Value = Name> {
    prop_oneof![
        "[a-zA-Z_][a-zA-Z0-9_-]{0,6}",
        "[a-z0-9 #\"%.+-]{0,5}[a-z]",
        Just("GET".to_owned()),
        Just("x".to_owned()),
        Just("mm".to_owned()),
        Just("π".to_owned()),
    ]
    .prop_map(|text| name(&text))
}

fn slots() -> impl Strategy<Value = SlotName> {
    let counted = |down| move |(counter, offset)| SlotNumber::Counted { counter, offset, down };
    let number = prop_oneof![
        (1..=100_000_usize).prop_map(|number| fixed(number).unwrap()),
        (names(), -30..=30_i64).prop_map(counted(false)),
        (names(), 1..=30_i64).prop_map(counted(true)),
    ];
    (names(), proptest::option::of(number)).prop_map(|(station, slot)| SlotName { station, slot })
}

/// Numbers of a few decimals, as users write them.
fn decimals() -> impl Strategy<Value = f64> {
    (-999_999..=999_999_i32, 0..=6_i32)
        .prop_map(|(digits, places)| f64::from(digits) / 10_f64.powi(places))
}

fn lengths() -> impl Strategy<Value = f64> {
    decimals().prop_map(jointplay_format::units::m_from_mm)
}

fn targets() -> impl Strategy<Value = AxisTarget> {
    let turn = decimals().prop_map(|deg| (AxisKind::Rotary, deg.to_radians()));
    let slide = lengths().prop_map(|m| (AxisKind::Linear, m));
    (names(), prop_oneof![turn, slide]).prop_map(|(axis, (kind, position))| AxisTarget {
        axis,
        kind,
        position,
    })
}

fn commands() -> impl Strategy<Value = Command> {
    let effector = || proptest::option::of(names());
    let leaf = prop_oneof![
        Just(Command::Home),
        proptest::collection::vec(targets(), 1..4).prop_map(|mut targets| {
            targets.sort_by(|a, b| a.axis.text.cmp(&b.axis.text));
            targets.dedup_by(|a, b| a.axis == b.axis);
            Command::Move { targets }
        }),
        (effector(), [lengths(), lengths(), lengths()])
            .prop_map(|(effector, by)| Command::MoveLine { effector, by }),
        (slots(), effector()).prop_map(|(from, effector)| Command::Get { from, effector }),
        (slots(), effector()).prop_map(|(to, effector)| Command::Put { to, effector }),
        (slots(), slots(), effector()).prop_map(|(from, to, effector)| Command::Transfer {
            from,
            to,
            effector
        }),
        (slots(), names(), names()).prop_map(|(at, get, put)| Command::Swap { at, get, put }),
        (slots(), effector()).prop_map(|(to, effector)| Command::Goto { to, effector }),
        (0..=864_000_u32).prop_map(|tenths| Command::Wait { seconds: f64::from(tenths) / 10.0 }),
        (1..=10_000_u32).prop_map(|share| Command::Speed { fraction: f64::from(share) / 1e4 }),
        (0..=1000_u32).prop_map(|radius| Command::Blend { radius: f64::from(radius) / 1000.0 }),
        (-8900..=8900_i32, decimals()).prop_map(|(pitch, yaw)| {
            let pitch = (f64::from(pitch) / 100.0).to_radians();
            Command::Tilt { tilt: Tilt { pitch, yaw: yaw.to_radians() } }
        }),
        names().prop_map(|routine| Command::Call { routine }),
    ];
    leaf.prop_recursive(4, 24, 4, |inner| {
        (1..=1_000_000_u64, proptest::option::of(names()), bodies(inner))
            .prop_map(|(times, counter, body)| Command::Repeat { times, counter, body })
    })
}

fn bodies(commands: impl Strategy<Value = Command>) -> impl Strategy<Value = Vec<Instruction>> {
    let instruction =
        commands.prop_map(|command| Instruction { place: SourceLocation::default(), command });
    proptest::collection::vec(instruction, 0..4)
}

fn programs() -> impl Strategy<Value = Program> {
    let routine = (names(), bodies(commands())).prop_map(|(name, body)| Routine { name, body });
    (bodies(commands()), proptest::collection::vec(routine, 0..3))
        .prop_map(|(body, routines)| Program { body, routines })
}

/// A text that might be meant as a program.
fn attempts() -> impl Strategy<Value = String> {
    let part = prop_oneof![
        "[ \n\t]{1,3}",
        "[a-zA-Z]{1,3}",
        "-?[0-9.]{1,4}",
        Just("\n".to_owned()),
        proptest::sample::select(vec![
            "HOME", "MOVE", "LINE", "GET", "port", "SLOT", "WITH", "A", "BY", "X", "mm", "deg",
            "%", "s", "REPEAT", "2", "AS", "n", "END\n", "ROUTINE", "+", "-", "\"", "#", "é",
            "\u{0}", "TILT", "WAIT",
        ])
        .prop_map(str::to_owned),
    ];
    proptest::collection::vec(part, 0..40).prop_map(|parts| parts.join(" "))
}

proptest! {
    #[test]
    fn a_written_program_reads_back_equal(program in programs()) {
        let text = write(&program);
        let read = parse(&text);
        prop_assert!(read.is_ok(), "{text}\n{read:?}");
        prop_assert_eq!(anywhere(read.unwrap()), program);
        prop_assert_eq!(format(&text).unwrap(), text);
    }

    #[test]
    fn any_text_is_read_without_panic_and_formatting_is_idempotent(text in attempts()) {
        match parse(&text) {
            Ok(program) => {
                let even = format(&text).unwrap();
                prop_assert_eq!(format(&even).unwrap(), even.clone());
                prop_assert_eq!(anywhere(parse(&even).unwrap()), anywhere(program));
            }
            Err(errors) => {
                prop_assert!(!errors.is_empty());
                for error in errors {
                    prop_assert!(error.with_excerpt("text").lines().count() == 4);
                }
            }
        }
    }
}
