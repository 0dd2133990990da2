//! Programs as text: what is read, what is refused, and that writing and laying out lose nothing.

use jointplay_cell::program::{
    AxisTarget, Branch, Command, Condition, Instruction, MAX_CALL_DEPTH, Name, Number, Parameter,
    Program, Quantity, Relation, Routine, SlotName, SourceLocation, TiltTarget, Unit,
};
use jointplay_core::expression::{BinaryOperator, Expression, Function, Operation};
use jointplay_format::program::{MAX_BYTES, MAX_DEPTH, format, parse, write};
use proptest::prelude::*;

/// A name whose place is of no matter.
fn name(text: &str) -> Name {
    Name { text: text.to_owned(), place: SourceLocation::default() }
}

fn slot(station: &str, slot: Option<Number>) -> SlotName {
    SlotName { station: name(station), slot }
}

fn fixed(number: usize) -> Option<Number> {
    Some(Number::whole(number))
}

fn quantity(value: f64, unit: Unit) -> Quantity {
    Quantity { number: Number::constant(value), unit }
}

/// The same program without the places of its parts.
fn anywhere(mut program: Program) -> Program {
    for parameter in &mut program.parameters {
        parameter.name.place = SourceLocation::default();
        forget_number(&mut parameter.value);
    }
    program.body.iter_mut().for_each(forget);
    for routine in &mut program.routines {
        routine.name.place = SourceLocation::default();
        routine.parameters.iter_mut().for_each(|it| it.place = SourceLocation::default());
        routine.body.iter_mut().for_each(forget);
    }
    program
}

fn forget_number(number: &mut Number) {
    number.place = SourceLocation::default();
    let unplaced = number.expression.try_map(|variable| Ok::<_, ()>(name(&variable.text)));
    number.expression = unplaced.unwrap();
}

fn forget_slot(slot: &mut SlotName) {
    slot.station.place = SourceLocation::default();
    slot.slot.iter_mut().for_each(forget_number);
}

fn forget_condition(condition: &mut Condition) {
    match condition {
        Condition::Comparison { left, right, .. } => {
            forget_number(left);
            forget_number(right);
        }
        Condition::Presence { location, .. } => forget_slot(location),
        Condition::Not(inner) => forget_condition(inner),
        Condition::All(inner) | Condition::Any(inner) => {
            inner.iter_mut().for_each(forget_condition);
        }
    }
}

fn forget(instruction: &mut Instruction) {
    fn of(name: &mut Option<Name>) {
        if let Some(name) = name {
            name.place = SourceLocation::default();
        }
    }
    instruction.place = SourceLocation::default();
    match &mut instruction.command {
        Command::Home => {}
        Command::Move { targets } => targets.iter_mut().for_each(|target| {
            target.axis.place = SourceLocation::default();
            forget_number(&mut target.position.number);
        }),
        Command::MoveLine { effector, by } => {
            of(effector);
            by.iter_mut().flatten().for_each(|length| forget_number(&mut length.number));
        }
        Command::Get { from: slot, effector }
        | Command::Put { to: slot, effector }
        | Command::Goto { to: slot, effector } => {
            forget_slot(slot);
            of(effector);
        }
        Command::Transfer { from, to, effector } => {
            forget_slot(from);
            forget_slot(to);
            of(effector);
        }
        Command::Swap { at: slot, get, put } => {
            forget_slot(slot);
            get.place = SourceLocation::default();
            put.place = SourceLocation::default();
        }
        Command::Call { routine, arguments } => {
            routine.place = SourceLocation::default();
            arguments.iter_mut().for_each(forget_number);
        }
        Command::Repeat { times, counter, body } => {
            forget_number(times);
            of(counter);
            body.iter_mut().for_each(forget);
        }
        Command::If { branches, otherwise } => {
            for branch in branches {
                forget_condition(&mut branch.condition);
                branch.body.iter_mut().for_each(forget);
            }
            otherwise.iter_mut().for_each(forget);
        }
        Command::Wait { duration: quantity } | Command::Speed { fraction: quantity } => {
            forget_number(&mut quantity.number);
        }
        Command::Blend { radius } => {
            radius.iter_mut().for_each(|radius| forget_number(&mut radius.number));
        }
        Command::Tilt { tilt } => {
            if let Some(tilt) = tilt {
                forget_number(&mut tilt.angle.number);
                forget_number(&mut tilt.azimuth.number);
            }
        }
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
    use Unit::{Degree, Millimeter, Percent, Second};
    let axis =
        |axis: &str, value, unit| AxisTarget { axis: name(axis), position: quantity(value, unit) };
    let some_mm = |value| Some(quantity(value, Millimeter));
    let some = |text: &str| Some(name(text));
    reads_as("HOME", Command::Home);
    reads_as(
        "move T -30deg R 200.5 MM # both",
        Command::Move { targets: vec![axis("T", -30.0, Degree), axis("R", 200.5, Millimeter)] },
    );
    reads_as(
        "MOVE LINE WITH A BY x 10 mm Z -0.5 mm",
        Command::MoveLine { effector: some("A"), by: [some_mm(10.0), None, some_mm(-0.5)] },
    );
    reads_as(
        "MOVE LINE BY Y 1e2 mm",
        Command::MoveLine { effector: None, by: [None, some_mm(100.0), None] },
    );
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
    for swap in ["SWAP port-1 SLOT 3 GET A PUT B", "SWAP port-1 SLOT 3 GET WITH A PUT WITH B"] {
        reads_as(swap, Command::Swap { at: from.clone(), get: name("A"), put: name("B") });
    }
    reads_as("GOTO port-1 SLOT 3", Command::Goto { to: from, effector: None });
    reads_as("WAIT 0.25 s", Command::Wait { duration: quantity(0.25, Second) });
    reads_as("SPEED 50 %", Command::Speed { fraction: quantity(50.0, Percent) });
    reads_as("SPEED 33.3%", Command::Speed { fraction: quantity(33.3, Percent) });
    reads_as("BLEND 2.5 mm", Command::Blend { radius: some_mm(2.5) });
    reads_as("blend off", Command::Blend { radius: None });
    reads_as("TILT LEVEL", Command::Tilt { tilt: None });
    reads_as(
        "TILT 0.8 deg TOWARD 90 deg",
        Command::Tilt {
            tilt: Some(TiltTarget {
                angle: quantity(0.8, Degree),
                azimuth: quantity(90.0, Degree),
            }),
        },
    );
    reads_as("CALL lot", Command::Call { routine: name("lot"), arguments: Vec::new() });
}

/// The expression of a slot number, in postfix order.
fn postfix(text: &str) -> String {
    let program = parse(&format!("GET port SLOT {text}")).unwrap();
    let Command::Get { from: SlotName { slot: Some(number), .. }, .. } = &program.body[0].command
    else {
        panic!("{text}")
    };
    let operation = |operation: &Operation<Name>| match operation {
        Operation::Constant(value) => value.to_string(),
        Operation::Variable(name) => name.text.clone(),
        Operation::Negate => "neg".to_owned(),
        Operation::Binary(operator) => format!("{operator:?}"),
        Operation::Call { function, arguments } => format!("{function:?}{arguments}"),
    };
    number.expression.operations().iter().map(operation).collect::<Vec<_>>().join(" ")
}

#[test]
fn numbers_are_expressions() {
    assert_eq!(postfix("n"), "n");
    for plus in ["n + 3", "n +3", "n+3", "n+ 3", "\"n\"+3"] {
        assert_eq!(postfix(plus), "n 3 Add");
    }
    for minus in ["26 - n", "26-n", "26 -n"] {
        assert_eq!(postfix(minus), "26 n Subtract");
    }
    assert_eq!(postfix("n -1"), "n 1 Subtract");
    assert_eq!(postfix("n-1"), "n-1");
    assert_eq!(postfix("2 * (n + -1) ^ 2"), "2 n -1 Add 2 Power Multiply");
    assert_eq!(postfix("mod(n - 1, 4) + min(a, b, 25)"), "n 1 Subtract 4 Mod2 a b 25 Min3 Add");
    // A name is a function only before a parenthesis.
    assert_eq!(postfix("round / floor(round)"), "round round Floor1 Divide");
}

#[test]
fn quantities_are_expressions_in_parentheses_before_a_unit() {
    let text = "PARAMETER lift = 5 mm\nPARAMETER angle = 30 deg\nMOVE LINE BY Z (lift / 2) mm X -lift mm\nMOVE T -angle deg R (lift + 2) mm\nWAIT min(2, 3) s\n";
    let program = parse(text).unwrap();
    assert_eq!(write(&program).replace("\n\n", "\n").lines().count(), 5);
    let Command::MoveLine { by: [Some(x), None, Some(z)], .. } = &program.body[0].command else {
        panic!()
    };
    let value = |quantity: &Quantity| quantity.number.expression.evaluate(|_| Ok::<_, ()>(5.0));
    assert_eq!((value(x), value(z)), (Ok(-5.0), Ok(2.5)));
    let Command::Move { targets } = &program.body[1].command else { panic!() };
    assert_eq!(targets[0].position.unit, Unit::Degree);
    assert_eq!(value(&targets[1].position), Ok(7.0));
}

#[test]
fn conditions_bind_not_before_and_before_or() {
    let read = |text: &str| {
        let program = anywhere(parse(&format!("IF {text}\nEND")).unwrap());
        let Command::If { branches, otherwise } = &program.body[0].command else { panic!() };
        assert!(otherwise.is_empty());
        branches[0].condition.clone()
    };
    let presence =
        |text: &str, occupied| Condition::Presence { location: slot(text, None), occupied };
    assert_eq!(read("aligner HAS WAFER"), presence("aligner", true));
    assert_eq!(read("(A empty)"), presence("A", false));
    assert_eq!(
        read("port SLOT n + 1 EMPTY"),
        Condition::Presence {
            location: slot(
                "port",
                Some(Number {
                    place: SourceLocation::default(),
                    expression: Expression::from_postfix(vec![
                        Operation::Variable(name("n")),
                        Operation::Constant(1.0),
                        Operation::Binary(BinaryOperator::Add),
                    ])
                    .unwrap(),
                })
            ),
            occupied: false,
        }
    );
    let less = |left, right| Condition::Comparison {
        left: Number::constant(left),
        relation: Relation::Less,
        right: Number::constant(right),
        unit: None,
    };
    assert_eq!(
        read("1 < 2 OR NOT A HAS WAFER AND (3) < 4"),
        Condition::Any(vec![
            less(1.0, 2.0),
            Condition::All(vec![Condition::Not(Box::new(presence("A", true))), less(3.0, 4.0)]),
        ])
    );
    assert_eq!(
        read("(1 < 2 OR A HAS WAFER) AND 3 < 4"),
        Condition::All(vec![
            Condition::Any(vec![less(1.0, 2.0), presence("A", true)]),
            less(3.0, 4.0),
        ])
    );
}

#[test]
fn branches_routines_and_parameters_are_read() {
    let text = "PARAMETER lot = 25 FROM 1 TO 25\nif lot = 1\nHOME\nelse if lot<>2\nelse\nWAIT 1 s\nend\ncall serve ( lot-1,A, 2*lot)\nroutine serve(k, arm, m)\nend\n";
    let program = parse(text).unwrap();
    assert_eq!(program.parameters[0].range, Some([1.0, 25.0]));
    let Command::If { branches, otherwise } = &program.body[0].command else { panic!() };
    assert_eq!((branches.len(), branches[1].body.len(), otherwise.len()), (2, 0, 1));
    let Command::Call { arguments, .. } = &program.body[1].command else { panic!() };
    assert_eq!(arguments.len(), 3);
    let parameters: Vec<&str> =
        program.routines[0].parameters.iter().map(|name| name.text.as_str()).collect();
    assert_eq!(parameters, ["k", "arm", "m"]);
    assert_eq!(
        format(text).unwrap(),
        "PARAMETER lot = 25 FROM 1 TO 25\nIF lot = 1\n  HOME\nELSE IF lot <> 2\nELSE\n  WAIT 1 s\nEND\nCALL serve(lot-1, A, 2 * lot)\nROUTINE serve(k, arm, m)\nEND\n"
    );
}

#[test]
fn formatting_separates_operators_and_not_signs_or_arguments() {
    let text = "PARAMETER lift=-5MM FROM -10 mm TO +5 mm\nMOVE T -30deg R -( lift+-2 )mm\nMOVE T (2-1) deg min -atan2(1,2) deg\nMOVE LINE BY x -lift mm Z(lift)mm\nGET port SLOT 2*( n -1)\nIF NOT(n-1<=-3 and lift>-2 mm)OR port slot 3 empty\nEND\n";
    let even = "PARAMETER lift = -5 mm FROM -10 mm TO +5 mm\nMOVE T -30 deg R -(lift + -2) mm\nMOVE T (2 - 1) deg min -atan2(1, 2) deg\nMOVE LINE BY X -lift mm Z (lift) mm\nGET port SLOT 2 * (n - 1)\nIF NOT (n-1 <= -3 AND lift > -2 mm) OR port SLOT 3 EMPTY\nEND\n";
    assert_eq!(format(text).unwrap(), even);
    assert_eq!(format(even).unwrap(), even);
}

#[test]
fn units_of_parameters_are_checked() {
    let declared = "PARAMETER lift = 5 mm\nPARAMETER turn = 30 deg\nPARAMETER lot = 25\n";
    let check = |line: &str, message: &str| {
        let text = format!("{declared}{line}\n");
        if message.is_empty() {
            assert!(parse(&text).is_ok(), "{line}: {:?}", parse(&text));
        } else {
            let found = refused(&text);
            assert!(found.contains(message), "{line}: {found}");
            assert!(found.starts_with("4:"), "{found}");
        }
    };
    check("MOVE LINE BY Z lift mm", "");
    check("MOVE LINE BY Z (lift * cos(turn) + 2) mm", "");
    check("MOVE LINE BY Z sqrt(lift ^ 2 + lift * lift) mm", "");
    check("MOVE T atan2(lift, 2 * lift) deg", "");
    check("GET port SLOT lot / 5", "");
    check("IF lift > 3 mm\nEND", "");
    check("IF lift > 3\nEND", "");
    check("SPEED lift %", "the expression is in mm, but has to be in %");
    check("MOVE LINE BY Z turn mm", "the expression is in deg, but has to be in mm");
    check("GET port SLOT lift", "the expression is in mm, but has to be a number without unit");
    check("WAIT (lift + turn) s", "mm and deg have no common unit");
    check("WAIT (1 / lift) s", "the expression is in 1 / mm, but has to be in s");
    check("IF lift > 3 deg\nEND", "mm and deg have no common unit");
    check("WAIT asin(lift) s", "the expression is in mm, but has to be a number without unit");
    check("MOVE LINE BY Z lift / 2 mm", "needs parentheses, as in `(2 * lift) mm`");
    check("PARAMETER half = lift / 2", "but has to be a number without unit");
    check("PARAMETER half = lift / 2 mm", "needs parentheses");
    check("PARAMETER half = (lift / 2) mm", "");
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
    let Command::Repeat { times, counter: Some(counter), body } = &routine.body[0].command else {
        panic!()
    };
    assert_eq!(times.expression.as_constant(), Some(2.0));
    assert_eq!(counter.text, "n");
    assert_eq!(routine.body[0].place, SourceLocation { line: 4, column: 3 });
    let Command::Repeat { times, counter: None, body } = &body[0].command else { panic!() };
    assert_eq!(times.expression.as_constant(), Some(3.0));
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
fn errors_of_a_swap_show_its_form_in_the_names_of_the_line() {
    for (text, form) in [
        ("SWAP PM WITH B", "SWAP PM GET B PUT A"),
        ("SWAP PM GET WITH B", "SWAP PM GET B PUT A"),
        ("SWAP PM GET WITH B WITH A", "SWAP PM GET B PUT A"),
        ("SWAP PM GET upper WITH lower", "SWAP PM GET upper PUT lower"),
        ("SWAP PM SLOT 2 GET A", "SWAP PM SLOT 2 GET A PUT B"),
        ("SWAP PM GET WITH", "SWAP PM GET B PUT A"),
        ("SWAP \"TO\" GET WITH WITH", "SWAP \"TO\" GET B PUT A"),
        ("SWAP PM", "SWAP PM GET B PUT A"),
    ] {
        let message = refused(text);
        assert!(message.contains(&format!("; write `{form}`")), "{text}: {message}");
        assert!(!message.contains("quotes"), "{text}: {message}");
        assert!(parse(form).is_ok(), "{form}");
    }
}

#[test]
fn syntax_errors_name_their_line_and_column() {
    insta::assert_snapshot!(refused(include_str!("programs/invalid.program")));
    insta::assert_snapshot!(refused(include_str!("programs/invalid-expressions.program")));
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
        ["HOME", "SPEED", "MOVE", "LINE", "GOTO", "CALL", "WAIT", "BLEND", "TILT", "SWAP", "IF"]
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
    assert_eq!(page.matches("\n### ").count(), 16);
    for limit in [MAX_DEPTH, MAX_CALL_DEPTH] {
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

/// Numbers of a few decimals, as users write them.
fn decimals() -> impl Strategy<Value = f64> {
    (-999_999..=999_999_i32, 0..=6_i32)
        .prop_map(|(digits, places)| f64::from(digits) / 10_f64.powi(places))
}

type Operations = Vec<Operation<Name>>;

/// Expressions as the parser makes them: a negative constant is not a negated one.
fn expressions() -> impl Strategy<Value = Expression<Name>> {
    let leaf = prop_oneof![
        decimals().prop_map(|value| vec![Operation::Constant(value)]),
        names().prop_map(|name| vec![Operation::Variable(name)]),
    ];
    let operators = proptest::sample::select(vec![
        BinaryOperator::Add,
        BinaryOperator::Subtract,
        BinaryOperator::Multiply,
        BinaryOperator::Divide,
        BinaryOperator::Power,
    ]);
    let functions =
        proptest::sample::select(vec![Function::SinDegrees, Function::Floor, Function::Max]);
    let operations = leaf.prop_recursive(4, 12, 3, move |inner| {
        let pair = (inner.clone(), inner.clone());
        prop_oneof![
            inner.clone().prop_map(|mut operand: Operations| {
                if !matches!(operand[..], [Operation::Constant(_)]) {
                    operand.push(Operation::Negate);
                }
                operand
            }),
            (pair, operators.clone()).prop_map(|((mut left, right), operator)| {
                left.extend(right);
                left.push(Operation::Binary(operator));
                left
            }),
            (inner, functions.clone()).prop_map(|(mut argument, function)| {
                argument.push(Operation::Call { function, arguments: 1 });
                argument
            }),
        ]
    });
    operations.prop_map(|operations| Expression::from_postfix(operations).unwrap())
}

fn number(expression: Expression<Name>) -> Number {
    Number { place: SourceLocation::default(), expression }
}

/// Literal numbers in a range, and expressions.
fn numbers(literal: impl Strategy<Value = f64> + 'static) -> impl Strategy<Value = Number> {
    let computed =
        expressions().prop_filter("literals have a range", |it| it.as_constant().is_none());
    prop_oneof![literal.prop_map(Number::constant), computed.prop_map(number)]
}

fn quantities(
    literal: impl Strategy<Value = f64> + 'static,
    unit: Unit,
) -> impl Strategy<Value = Quantity> {
    numbers(literal).prop_map(move |number| Quantity { number, unit })
}

fn slots() -> impl Strategy<Value = SlotName> {
    let slot = proptest::option::of(numbers((1..=100_000_u32).prop_map(f64::from)));
    (names(), slot).prop_map(|(station, slot)| SlotName { station, slot })
}

fn conditions() -> impl Strategy<Value = Condition> {
    use Relation::{Equal, Greater, GreaterOrEqual, Less, LessOrEqual, NotEqual};
    let relations = vec![Less, LessOrEqual, Greater, GreaterOrEqual, Equal, NotEqual];
    let relation = proptest::sample::select(relations);
    let units = proptest::option::of(proptest::sample::select(Unit::ALL.to_vec()));
    let leaf = prop_oneof![
        (numbers(decimals()), relation, numbers(decimals()), units).prop_map(
            |(left, relation, right, unit)| Condition::Comparison { left, relation, right, unit }
        ),
        (slots(), proptest::bool::ANY)
            .prop_map(|(location, occupied)| Condition::Presence { location, occupied }),
    ];
    leaf.prop_recursive(3, 8, 3, |inner| {
        let several = || proptest::collection::vec(inner.clone(), 2..4);
        prop_oneof![
            inner.clone().prop_map(|condition| Condition::Not(Box::new(condition))),
            several().prop_map(Condition::All),
            several().prop_map(Condition::Any),
        ]
    })
}

fn targets() -> impl Strategy<Value = AxisTarget> {
    let position =
        prop_oneof![quantities(decimals(), Unit::Degree), quantities(decimals(), Unit::Millimeter)];
    (names(), position).prop_map(|(axis, position)| AxisTarget { axis, position })
}

fn commands() -> impl Strategy<Value = Command> {
    let effector = || proptest::option::of(names());
    let length = || proptest::option::of(quantities(decimals(), Unit::Millimeter));
    let tenths = |range: std::ops::RangeInclusive<i32>| range.prop_map(|it| f64::from(it) / 10.0);
    let leaf = prop_oneof![
        Just(Command::Home),
        proptest::collection::vec(targets(), 1..4).prop_map(|mut targets| {
            targets.sort_by(|a, b| a.axis.text.cmp(&b.axis.text));
            targets.dedup_by(|a, b| a.axis == b.axis);
            Command::Move { targets }
        }),
        (effector(), [length(), length(), length()])
            .prop_filter("a line has a direction", |(_, by)| by.iter().any(Option::is_some))
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
        quantities(tenths(0..=864_000), Unit::Second)
            .prop_map(|duration| Command::Wait { duration }),
        quantities(tenths(1..=1000), Unit::Percent)
            .prop_map(|fraction| Command::Speed { fraction }),
        proptest::option::of(quantities(tenths(0..=10_000), Unit::Millimeter))
            .prop_map(|radius| Command::Blend { radius }),
        proptest::option::of((
            quantities(tenths(-890..=890), Unit::Degree),
            quantities(decimals(), Unit::Degree)
        ))
        .prop_map(|tilt| Command::Tilt {
            tilt: tilt.map(|(angle, azimuth)| TiltTarget { angle, azimuth })
        }),
        (names(), proptest::collection::vec(numbers(decimals()), 0..3))
            .prop_map(|(routine, arguments)| Command::Call { routine, arguments }),
    ];
    leaf.prop_recursive(4, 24, 4, |inner| {
        let times = numbers((1..=1_000_000_u32).prop_map(f64::from));
        let repeat = (times, proptest::option::of(names()), bodies(inner.clone()))
            .prop_map(|(times, counter, body)| Command::Repeat { times, counter, body });
        let branch = (conditions(), bodies(inner.clone()))
            .prop_map(|(condition, body)| Branch { condition, body });
        let branches = (proptest::collection::vec(branch, 1..3), bodies(inner))
            .prop_map(|(branches, otherwise)| Command::If { branches, otherwise });
        prop_oneof![repeat, branches]
    })
}

fn bodies(commands: impl Strategy<Value = Command>) -> impl Strategy<Value = Vec<Instruction>> {
    let instruction =
        commands.prop_map(|command| Instruction { place: SourceLocation::default(), command });
    proptest::collection::vec(instruction, 0..4)
}

fn parameters() -> impl Strategy<Value = Parameter> {
    let unit = proptest::option::of(proptest::sample::select(Unit::ALL.to_vec()));
    let range = proptest::option::of([decimals(), decimals()]);
    (numbers(decimals()), unit, range).prop_map(|(value, unit, range)| {
        // Names of parameters with units would restrict the expressions of the program.
        Parameter { name: name("own parameter"), value, unit, range }
    })
}

fn programs() -> impl Strategy<Value = Program> {
    let routine = (names(), proptest::collection::vec(names(), 0..3), bodies(commands()))
        .prop_map(|(name, parameters, body)| Routine { name, parameters, body });
    let parameters = proptest::collection::vec(parameters(), 0..2);
    (parameters, bodies(commands()), proptest::collection::vec(routine, 0..3))
        .prop_map(|(parameters, body, routines)| Program { parameters, body, routines })
}

/// A text that might be meant as a program.
fn attempts() -> impl Strategy<Value = String> {
    let part = prop_oneof![
        "[ \n\t]{1,3}",
        "[a-zA-Z]{1,3}",
        "-?[0-9.]{1,4}",
        Just("\n".to_owned()),
        proptest::sample::select(vec![
            "HOME",
            "MOVE",
            "LINE",
            "GET",
            "port",
            "SLOT",
            "WITH",
            "A",
            "BY",
            "X",
            "mm",
            "deg",
            "%",
            "s",
            "REPEAT",
            "2",
            "AS",
            "n",
            "END\n",
            "ROUTINE",
            "+",
            "-",
            "\"",
            "#",
            "é",
            "\u{0}",
            "TILT",
            "WAIT",
            "IF",
            "ELSE",
            "HAS",
            "WAFER",
            "EMPTY",
            "NOT",
            "AND",
            "OR",
            "PARAMETER",
            "=",
            "<",
            "(",
            ")",
            ",",
            "*",
            "min(",
            "FROM",
            "TO",
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
