//! Programs with expressions, conditions, routines and parameters, compared with their unrolled equals.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::LazyLock;

use jointplay_cell::program::{Step, expand};
use jointplay_cell::workcell::Cell;
use jointplay_cell::{IncrementalPlanner, PlanOptions};
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::program::{Setting, explain, format, parse, with_parameters};
use jointplay_format::{cell, place};
use proptest::prelude::*;

static CELL: LazyLock<Cell> = LazyLock::new(|| {
    cell::read(cell::EXAMPLE, &mut |path| Err(format!("{path} does not exist"))).unwrap()
});

/// All errors of a program, with their places.
fn refused(text: &str) -> String {
    let errors = expand(&CELL, &parse(text).unwrap()).unwrap_err();
    let messages = errors.iter().map(|error| {
        let shown = explain(&CELL.robot, text, error, DisplayUnits::Metric);
        format!("{}:{}: {shown}\n", shown.place.line, shown.place.column)
    });
    messages.collect()
}

/// The steps of a program without their places in the text.
#[track_caller]
fn steps(text: &str) -> Vec<Step> {
    let program = parse(text).unwrap_or_else(|errors| panic!("{text}\n{errors:?}"));
    let mut steps = expand(&CELL, &program).unwrap_or_else(|_| panic!("{text}\n{}", refused(text)));
    steps.iter_mut().for_each(|step| step.place = Default::default());
    steps
}

#[track_caller]
fn assert_equals_unrolled(text: &str, unrolled: &str) {
    assert_eq!(steps(text), steps(unrolled), "{text}");
}

#[test]
fn expressions_conditions_and_routines_have_the_steps_of_their_unrolled_equal() {
    assert_equals_unrolled(
        "PARAMETER lot = 2\nPARAMETER lift = 5 mm\nREPEAT lot AS n\n  CALL exchange(2 * n - 1, LP1, A)\n  MOVE LINE WITH A BY Z (lift / n) mm\n  HOME\nEND\nROUTINE exchange(k, port, arm)\n  TRANSFER port SLOT k TO ALIGN WITH arm\n  TRANSFER ALIGN TO LP2 SLOT 26 - k WITH arm\nEND\n",
        "TRANSFER LP1 SLOT 1 TO ALIGN WITH A\nTRANSFER ALIGN TO LP2 SLOT 25 WITH A\nMOVE LINE WITH A BY Z 5 mm\nHOME\nTRANSFER LP1 SLOT 3 TO ALIGN WITH A\nTRANSFER ALIGN TO LP2 SLOT 23 WITH A\nMOVE LINE WITH A BY Z 2.5 mm\nHOME\n",
    );
    // The wafer is where the program has moved it.
    assert_equals_unrolled(
        "REPEAT 3 AS n\n  IF ALIGN EMPTY\n    TRANSFER LP1 SLOT n TO ALIGN WITH A\n  ELSE IF A HAS WAFER\n    HOME\n  ELSE\n    TRANSFER ALIGN TO LP2 SLOT n WITH A\n  END\nEND\nGET LP1 SLOT 25 WITH B\nIF B HAS WAFER AND NOT A HAS WAFER AND LP1 SLOT 25 EMPTY\n  WAIT 1 s\nEND\n",
        "TRANSFER LP1 SLOT 1 TO ALIGN WITH A\nTRANSFER ALIGN TO LP2 SLOT 2 WITH A\nTRANSFER LP1 SLOT 3 TO ALIGN WITH A\nGET LP1 SLOT 25 WITH B\nWAIT 1 s\n",
    );
    // Without WITH, the effector follows from the stations of each call.
    assert_equals_unrolled(
        "CALL visit(ALIGN)\nCALL visit(ALIGN)\nCALL look(A)\nCALL look(ALIGN)\nROUTINE visit(place)\n  GOTO place WITH A\nEND\nROUTINE look(where)\n  IF where EMPTY\n    WAIT 1 s\n  END\nEND\n",
        "GOTO ALIGN WITH A\nGOTO ALIGN WITH A\nWAIT 1 s\nWAIT 1 s\n",
    );
    assert_equals_unrolled("REPEAT 1 - 1\n  HOME\nEND\nWAIT 1 s\n", "WAIT 1 s\n");
    assert_equals_unrolled(
        "REPEAT 3 AS n\n  REPEAT n AS m\n    WAIT (n + m / 10) s\n  END\nEND\n",
        "WAIT 1.1 s\nWAIT 2.1 s\nWAIT 2.2 s\nWAIT 3.1 s\nWAIT 3.2 s\nWAIT 3.3 s\n",
    );
}

#[test]
fn a_program_has_the_plan_of_its_unrolled_equal_to_the_bit() {
    let text = "PARAMETER pace = 80 %\nSPEED pace %\nBLEND (pace / 20) mm\nREPEAT 2 AS n\n  IF n = 1\n    MOVE T (30.1 * n) deg\n  ELSE\n    TRANSFER LP1 SLOT n TO LP2 SLOT n WITH A\n  END\nEND\n";
    let unrolled =
        "SPEED 80 %\nBLEND 4 mm\nMOVE T 30.1 deg\nTRANSFER LP1 SLOT 2 TO LP2 SLOT 2 WITH A\n";
    let plan = |text: &str| {
        let options = PlanOptions::default();
        let program = parse(text).unwrap();
        IncrementalPlanner::default().plan(&CELL, &program, &options).unwrap()
    };
    let ((motion, report), (expected, expected_report)) = (plan(text), plan(unrolled));
    assert_eq!(motion.duration().to_bits(), expected.duration().to_bits());
    for (step, other) in motion.steps.iter().zip(&expected.steps) {
        assert_eq!((&step.from, &step.to), (&other.from, &other.to));
    }
    assert_eq!(report.violations.len(), expected_report.violations.len());
    let mut planner = IncrementalPlanner::default();
    let options = PlanOptions::default();
    planner.plan(&CELL, &parse(text).unwrap(), &options).unwrap();
    // A value of a parameter that changes nothing reuses all segments.
    let changed = text.replace("30.1 * n", "60.2 / 2 * n");
    let (again, _) = planner.plan(&CELL, &parse(&changed).unwrap(), &options).unwrap();
    assert_eq!(again.duration().to_bits(), motion.duration().to_bits());
    assert_eq!(planner.segment_cache_stats().misses, 0);
}

#[test]
fn planning_errors_name_values_of_counters_and_calls() {
    let text = "PARAMETER lot = 3 FROM 5 TO 7\nPARAMETER twice = 2 * lost\nPARAMETER lot = 4\nREPEAT 5 AS n\n  GOTO LP1 SLOT n / 2 WITH A\n  WAIT (2 - n) s\n  IF 1 / (n - 3) > 1\n  END\n  CALL serve(n, LP1, A)\nEND\nCALL serve(1, nowhere, C)\nCALL serve(1, ALIGN)\nCALL serve(2 * n, A, ALIGN)\nCALL serve(1, 2, 3)\nCALL both(1)\nREPEAT 2 AS m\n  GET LP1 SLOT m-1 WITH A\nEND\nIF nothing HAS WAFER OR LP1 EMPTY OR LP1 SLOT 99 EMPTY\nEND\nREPEAT 1 / 0\nEND\nREPEAT 5 / 2\nEND\nROUTINE serve(k, port, arm)\n  CALL inner(k + 1, port, arm)\nEND\nROUTINE inner(m, port, arm)\n  GOTO port SLOT 30 - 2 * m WITH arm\n  GOTO port SLOT 29 - m WITH arm\nEND\nROUTINE both(x)\n  WAIT x s\n  GOTO x WITH A\nEND\nROUTINE double(x, x)\nEND\nROUTINE shadow(n)\n  REPEAT 2 AS n\n  END\nEND\n";
    insta::assert_snapshot!(refused(text));
}

#[test]
fn arguments_that_contradict_the_cell_are_reported_in_the_routine() {
    let text = "CALL use(LP1, A)\nCALL use(ALIGN, B)\nCALL change(ALIGN, A, A)\nCALL only(LP1)\nCALL first(LP1)\nROUTINE use(port, arm)\n  GOTO port SLOT 1 WITH arm\nEND\nROUTINE change(port, one, other)\n  SWAP port GET one PUT other\nEND\nROUTINE only(port)\n  GOTO port SLOT 1\nEND\nROUTINE first(port)\n  GOTO port WITH A\nEND\n";
    insta::assert_snapshot!(refused(text));
}

#[test]
fn programs_without_end_are_rejected_before_and_during_their_expansion() {
    let check = |text: &str, expected: &str| {
        let found = refused(text);
        assert!(found.contains(expected), "{text}: {found}");
    };
    // The number of passes is known before.
    check("PARAMETER k = 1e12\nREPEAT k\n  WAIT 0 s\nEND\n", "2:1: this REPEAT expands to");
    // It is known in each pass only.
    let limit = "the program expands to more than 20000 instructions, and reaches this number here";
    check("REPEAT 1000 AS n\n  REPEAT n\n    WAIT 0 s\n  END\nEND\n", &format!("3:5: {limit}"));
    check("REPEAT 3 AS n\n  REPEAT n * 1e12\n  END\nEND\n", &format!("2:3: {limit}"));
    check(
        "REPEAT 3 AS n\n  REPEAT n * 1e12\n    IF A HAS WAFER\n      HOME\n    END\n  END\nEND\n",
        &format!("3:5: {limit}"),
    );
    check(
        "CALL again(3)\nROUTINE again(n)\n  IF n > 0\n    CALL again(n - 1)\n  END\nEND\n",
        "4:5: this CALL never ends: again calls again",
    );
    // A condition excludes a part that would be too long.
    assert_eq!(
        steps(
            "PARAMETER k = 3\nIF k > 3\n  REPEAT 15000\n    HOME\n  END\nELSE\n  WAIT 1 s\nEND\n"
        )
        .len(),
        1
    );
}

#[test]
fn after_an_error_conditions_on_wafers_report_no_further_errors() {
    let text =
        "GET nowhere WITH A\nIF A HAS WAFER\n  PUT ALIGN WITH A\nELSE\n  PUT ALIGN WITH A\nEND\n";
    assert_eq!(refused(text).lines().count(), 1, "{}", refused(text));
}

fn set(text: &str, settings: &[(&str, &str)]) -> Result<String, String> {
    let settings: Vec<Setting> = settings
        .iter()
        .map(|(name, value)| Setting { name: (*name).into(), value: (*value).into() })
        .collect();
    with_parameters(text, &settings).map_err(|errors| {
        let shown = |error: &place::Error<_>| {
            format!("{}:{}: {error}\n", error.place.line, error.place.column)
        };
        errors.iter().map(shown).collect()
    })
}

#[test]
fn parameters_are_set_in_the_text() {
    let text = "\u{feff}# lot\r\nPARAMETER lot =  25 FROM 1 TO 25 # wafers\r\nparameter \"the é lift\"=(5+1) mm\r\nWAIT 1 s";
    assert_eq!(
        set(text, &[("the é lift", " 7MM"), ("lot", "+13")]).unwrap(),
        "\u{feff}# lot\r\nPARAMETER lot =  13 FROM 1 TO 25 # wafers\r\nparameter \"the é lift\"=7 mm\r\nWAIT 1 s"
    );
    assert_eq!(set(text, &[]).unwrap(), text);
    let errors = [
        (
            "lott",
            "3",
            "2:18: the parameter `lott` is not known (did you mean `lot`?); known: lot, the é lift",
        ),
        ("lot", "26", "2:18: the parameter lot is 26, but has to be from 1 to 25"),
        (
            "lot",
            "3 mm",
            "2:18: the value of lot has to be a number without unit, as in `3`, found 3 mm",
        ),
        ("lot", "n", "2:18: the value of lot has to be a number, found \"n\""),
        ("lot", "", "2:18: the value of lot has to be a number, found \"\""),
        ("lot", "3 # 4", "has to be a number, found \"3 # 4\""),
        ("lot", "1\nHOME", "has to be a number, found \"1\\nHOME\""),
        (
            "the é lift",
            "7",
            "3:24: the value of the é lift has to be a number in mm, as in `7 mm`, found 7",
        ),
        ("the é lift", "7 deg", "has to be a number in mm, as in `7 mm`, found 7 deg"),
        ("the é lift", "7 m", "the value of the é lift has to be a number in mm, found \"7 m\""),
    ];
    for (name, value, message) in errors {
        let found = set(text, &[(name, value)]).unwrap_err();
        assert!(found.contains(message), "{name}={value}: {found}");
    }
    let twice = set(text, &[("lot", "3"), ("lot", "4")]).unwrap_err();
    assert!(twice.contains("the parameter lot is set twice"), "{twice}");
    assert!(set("HOME", &[("lot", "3")]).unwrap_err().contains("1:1: the parameter `lot` is not"));
}

#[test]
fn a_set_parameter_changes_those_that_depend_on_it() {
    let text = "PARAMETER lot = 4\nPARAMETER half = lot / 2\nREPEAT half AS n\n  WAIT n s\nEND\n";
    let changed = set(text, &[("lot", "2")]).unwrap();
    assert_equals_unrolled(text, "WAIT 1 s\nWAIT 2 s\n");
    assert_equals_unrolled(&changed, "WAIT 1 s\n");
    assert!(refused(&set(text, &[("lot", "3")]).unwrap()).contains(
        "3:8: the number of passes is 1.5, but has to be a whole number from 0 to 1000000000000000"
    ));
}

/// An expression with whole numbers, evaluated by the test itself.
#[derive(Debug, Clone)]
enum Sum {
    Number(i32),
    Name(usize),
    Add(Box<Sum>, Box<Sum>),
    Subtract(Box<Sum>, Box<Sum>),
    Multiply(Box<Sum>, Box<Sum>),
    Divide(Box<Sum>, Box<Sum>),
    Negate(Box<Sum>),
    Minimum(Box<Sum>, Box<Sum>),
}

/// A statement of a random program.
#[derive(Debug, Clone)]
enum Statement {
    Wait(Sum),
    Turn(Sum),
    Repeat(Sum, Vec<Statement>),
    Compare(Sum, Sum, Vec<Statement>, Vec<Statement>),
    /// Moves the wafer of a slot to another port, or back, wherever it is.
    Exchange(Sum, Vec<Statement>),
    /// Calls the routine with the first argument.
    Call(Sum),
}

fn sums() -> impl Strategy<Value = Sum> {
    let leaf = prop_oneof![(0..9_i32).prop_map(Sum::Number), (0..6_usize).prop_map(Sum::Name)];
    leaf.prop_recursive(3, 8, 2, |inner| {
        let pair = || (inner.clone().prop_map(Box::new), inner.clone().prop_map(Box::new));
        prop_oneof![
            pair().prop_map(|(a, b)| Sum::Add(a, b)),
            pair().prop_map(|(a, b)| Sum::Subtract(a, b)),
            pair().prop_map(|(a, b)| Sum::Multiply(a, b)),
            pair().prop_map(|(a, b)| Sum::Divide(a, b)),
            pair().prop_map(|(a, b)| Sum::Minimum(a, b)),
            inner.clone().prop_map(|a| Sum::Negate(Box::new(a))),
        ]
    })
}

fn statements() -> impl Strategy<Value = Vec<Statement>> {
    let leaf = prop_oneof![
        sums().prop_map(Statement::Wait),
        sums().prop_map(Statement::Turn),
        sums().prop_map(Statement::Call),
    ];
    let statement = leaf.prop_recursive(3, 12, 3, |inner| {
        let body = || proptest::collection::vec(inner.clone(), 0..3);
        prop_oneof![
            (sums(), body()).prop_map(|(times, body)| Statement::Repeat(times, body)),
            (sums(), sums(), body(), body())
                .prop_map(|(a, b, then, otherwise)| Statement::Compare(a, b, then, otherwise)),
            (sums(), body()).prop_map(|(slot, body)| Statement::Exchange(slot, body)),
        ]
    });
    proptest::collection::vec(statement, 1..4)
}

/// Names of counters and arguments around a statement, innermost last, with their values while unrolling.
type Names = Vec<(String, f64)>;

impl Sum {
    /// The text, with as few parentheses as needed to keep the tree.
    fn text(&self, names: &Names) -> String {
        let of = |sum: &Sum| sum.text(names);
        match self {
            Self::Number(value) => value.to_string(),
            Self::Name(index) if names.is_empty() => index.to_string(),
            Self::Name(index) => names[index % names.len()].0.clone(),
            Self::Add(a, b) => format!("({} + {})", of(a), of(b)),
            Self::Subtract(a, b) => format!("({} - {})", of(a), of(b)),
            Self::Multiply(a, b) => format!("{} * ({})", of(a), of(b)),
            // Never a quotient by 0.
            Self::Divide(a, b) => format!("({}) / (abs({}) + 1)", of(a), of(b)),
            Self::Negate(a) => format!("-({})", of(a)),
            Self::Minimum(a, b) => format!("min({}, {})", of(a), of(b)),
        }
    }

    fn value(&self, names: &Names) -> f64 {
        let of = |sum: &Sum| sum.value(names);
        match self {
            Self::Number(value) => f64::from(*value),
            Self::Name(index) if names.is_empty() => *index as f64,
            Self::Name(index) => names[index % names.len()].1,
            Self::Add(a, b) => of(a) + of(b),
            Self::Subtract(a, b) => of(a) - of(b),
            Self::Multiply(a, b) => of(a) * of(b),
            Self::Divide(a, b) => of(a) / (of(b).abs() + 1.0),
            Self::Negate(a) => -of(a),
            Self::Minimum(a, b) => of(a).min(of(b)),
        }
    }

    /// A whole number from 0 to below `count`.
    fn whole_text(&self, names: &Names, count: u32) -> String {
        format!("floor(mod({}, {count}))", self.text(names))
    }

    fn whole(&self, names: &Names, count: u32) -> f64 {
        self.value(names).rem_euclid(f64::from(count)).floor()
    }
}

/// The state of a program while the test unrolls it.
#[derive(Default)]
struct Unrolled {
    text: String,
    /// Ports in which the wafers of the first slots are, by slot.
    ports: BTreeMap<u32, usize>,
    routine: Vec<Statement>,
}

const PORTS: [&str; 2] = ["LP1", "LP2"];

fn write_statements(out: &mut String, body: &[Statement], names: &mut Names) {
    for statement in body {
        let inner = format!("n{}", names.len());
        match statement {
            Statement::Wait(sum) => writeln!(out, "WAIT abs({}) s", sum.text(names)),
            Statement::Turn(sum) => writeln!(out, "MOVE T mod({}, 90) deg", sum.text(names)),
            Statement::Repeat(times, body) => {
                writeln!(out, "REPEAT {} AS {inner}", times.whole_text(names, 3)).unwrap();
                names.push((inner, 0.0));
                write_statements(out, body, names);
                names.pop();
                writeln!(out, "END")
            }
            Statement::Compare(a, b, then, otherwise) => {
                let (a, b) = (a.text(names), b.text(names));
                writeln!(out, "IF {a} < {b}").unwrap();
                write_statements(out, then, names);
                writeln!(out, "ELSE").unwrap();
                write_statements(out, otherwise, names);
                writeln!(out, "END")
            }
            Statement::Exchange(slot, body) => {
                let slot = format!("1 + {}", slot.whole_text(names, 3));
                writeln!(out, "IF LP1 SLOT {slot} HAS WAFER\nTRANSFER LP1 SLOT {slot} TO LP2 SLOT {slot} WITH A").unwrap();
                write_statements(out, body, names);
                writeln!(out, "ELSE IF NOT LP2 SLOT {slot} EMPTY\nTRANSFER LP2 SLOT {slot} TO LP1 SLOT {slot} WITH A\nEND")
            }
            Statement::Call(sum) => writeln!(out, "CALL inner({}, A)", sum.text(names)),
        }
        .unwrap();
    }
}

impl Unrolled {
    fn run(&mut self, body: &[Statement], names: &mut Names, calls: bool) {
        for statement in body {
            match statement {
                Statement::Wait(sum) => {
                    writeln!(self.text, "WAIT {} s", sum.value(names).abs()).unwrap();
                }
                Statement::Turn(sum) => {
                    let angle = sum.value(names).rem_euclid(90.0);
                    writeln!(self.text, "MOVE T {angle} deg").unwrap();
                }
                Statement::Repeat(times, body) => {
                    for pass in 1..=times.whole(names, 3) as u32 {
                        names.push((String::new(), f64::from(pass)));
                        self.run(body, names, calls);
                        names.pop();
                    }
                }
                Statement::Compare(a, b, then, otherwise) => {
                    let chosen = if a.value(names) < b.value(names) { then } else { otherwise };
                    self.run(chosen, names, calls);
                }
                Statement::Exchange(slot, body) => {
                    let slot = 1 + slot.whole(names, 3) as u32;
                    let port = *self.ports.entry(slot).or_default();
                    self.ports.insert(slot, 1 - port);
                    let (from, to) = (PORTS[port], PORTS[1 - port]);
                    writeln!(self.text, "TRANSFER {from} SLOT {slot} TO {to} SLOT {slot} WITH A")
                        .unwrap();
                    if port == 0 {
                        self.run(body, names, calls);
                    }
                }
                Statement::Call(sum) if calls => {
                    let routine = self.routine.clone();
                    let mut inner = vec![("k".to_owned(), sum.value(names))];
                    self.run(&routine, &mut inner, false);
                }
                Statement::Call(_) => {}
            }
        }
    }
}

/// The statements without calls, for the routine.
fn without_calls(body: &[Statement]) -> Vec<Statement> {
    let kept = body.iter().filter_map(|statement| {
        Some(match statement {
            Statement::Call(_) => return None,
            Statement::Repeat(times, body) => Statement::Repeat(times.clone(), without_calls(body)),
            Statement::Compare(a, b, then, otherwise) => Statement::Compare(
                a.clone(),
                b.clone(),
                without_calls(then),
                without_calls(otherwise),
            ),
            Statement::Exchange(slot, body) => {
                Statement::Exchange(slot.clone(), without_calls(body))
            }
            other => other.clone(),
        })
    });
    kept.collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]
    #[test]
    fn random_programs_have_the_steps_of_their_unrolled_equal(
        body in statements(),
        routine in statements(),
    ) {
        let routine = without_calls(&routine);
        let mut text = String::new();
        write_statements(&mut text, &body, &mut Vec::new());
        text.push_str("WAIT 1 s\nROUTINE inner(k, arm)\nIF arm EMPTY\nEND\n");
        write_statements(&mut text, &routine, &mut vec![("k".to_owned(), 0.0)]);
        text.push_str("END\n");
        let mut unrolled = Unrolled { routine, ..Unrolled::default() };
        unrolled.run(&body, &mut Vec::new(), true);
        unrolled.text.push_str("WAIT 1 s\n");
        prop_assume!(unrolled.text.lines().count() < 60);
        let even = format(&text).unwrap();
        prop_assert_eq!(format(&even).unwrap(), even.clone());
        let (found, expected) = (steps(&even), steps(&unrolled.text));
        prop_assert!(found == expected, "{}\n{}", even, unrolled.text);
    }
}
