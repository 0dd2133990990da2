//! Studies of programs in cells, compared with checks of single cells.

use std::collections::BTreeMap;

use jointplay_cell::check::{CheckResult, Report};
use jointplay_cell::{IncrementalPlanner, PlanOptions};
use jointplay_format::study::{Source, StudyFile, from_files, parse};
use jointplay_format::{cell, program};
use jointplay_study::plan::{Block, Outcome, ProgramOutcome, compute_chunk, quantiles};

/// A cell of another user: the example with parameters, and a robot file that the test writes.
fn cell_text() -> String {
    let text = cell::EXAMPLE
        .replace("[350.0, 606.0, 600.0]", "[\"x\", 606.0, \"z + 100\"]")
        .replace("robot = \"dual-arm\"", "robot = \"robots/mine.toml\"");
    format!("{text}\n[parameters]\nx = 350\nz = 500\n")
}

const PROGRAM: &str = "\
PARAMETER pace = 100 FROM 10 TO 100
PARAMETER pause = 0.5 s
PARAMETER n = 2
SPEED pace %
WAIT pause s
REPEAT n AS k
  TRANSFER LP1 SLOT k TO ALIGN WITH A
  TRANSFER ALIGN TO LP2 SLOT k WITH A
END
HOME
";

fn files() -> BTreeMap<String, Vec<u8>> {
    let robot = jointplay_format::catalogue::find("dual-arm").unwrap().text;
    let files = [
        ("cells/mine.toml", cell_text()),
        ("cells/robots/mine.toml", robot.to_owned()),
        ("cells/mine.program", PROGRAM.to_owned()),
        ("short.program", "GET LP1 SLOT 3 WITH B\nPUT LP2 SLOT 3 WITH B\n".to_owned()),
    ];
    files.map(|(name, text)| (name.to_owned(), text.into_bytes())).into()
}

fn study(text: &str) -> StudyFile {
    parse(text, &mut from_files(&files()))
        .unwrap_or_else(|error| panic!("{}", error.with_excerpt("s.toml")))
}

fn computed(study: &StudyFile) -> Block {
    let samples: Vec<u64> = (0..study.plan.samples().unwrap()).collect();
    study.plan.compute(&samples).unwrap()
}

fn column<'a>(study: &StudyFile, block: &'a Block, name: &str) -> &'a [f64] {
    let found = study.columns.iter().find(|column| column.name == name);
    let Some(Source::Number { index, .. }) = found.map(|column| column.source) else {
        panic!("no column {name}");
    };
    &block.columns[index]
}

/// The check of one cell and program by themselves.
fn checked(cell_text: &str, parameters: &[(&str, f64)], program_text: &str) -> Report {
    let files = files();
    let parameters: Vec<(String, f64)> =
        parameters.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let cell = cell::read_with(cell_text, &parameters, &mut |name| {
        Ok(files[&format!("cells/{name}")].clone())
    });
    let program = program::parse(program_text).unwrap();
    let mut planner = IncrementalPlanner::default();
    planner.plan(&cell.unwrap(), &program, &PlanOptions::default()).unwrap().1
}

fn compare(study: &StudyFile, block: &Block, row: usize, report: &Report) {
    let of = |name: &str| column(study, block, name)[row];
    let most = |value: &dyn Fn(usize) -> Option<f64>| {
        (0..report.by_instruction.len()).filter_map(value).reduce(f64::max).unwrap()
    };
    let rows = &report.by_instruction;
    let nearest = report.distances.iter().map(|pair| pair.distance).fold(f64::INFINITY, f64::min);
    assert_eq!(of("min_distance_mm"), nearest, "row {row}");
    assert_eq!(of("slip"), most(&|k| rows[k].slip.map(|one| one.ratio)));
    assert_eq!(of("velocity"), most(&|k| rows[k].velocity.map(|one| one.ratio)));
    assert_eq!(of("tilt"), most(&|k| Some(rows[k].tilt)));
    assert_eq!(of("play"), most(&|k| Some(rows[k].play)));
    assert_eq!(of("violations"), report.violations.len() as f64);
    let passed = report.result == CheckResult::Passed;
    let outcome = if passed { ProgramOutcome::Passed } else { ProgramOutcome::Violations };
    assert_eq!(block.outcomes[0][row], Outcome::Program(outcome), "row {row}");
    if passed {
        assert_eq!(of("cycle_time_s"), report.duration, "row {row}");
    } else {
        assert!(of("cycle_time_s").is_nan(), "a program with violations has no cycle time");
    }
}

const QUANTITIES: &str = "quantities = [\"cycle_time_s\", \"margins\", \"violations\"]";

#[test]
fn samples_are_the_checks_of_single_cells() {
    let study = study(&format!(
        "kind = \"study\"\ncell = \"cells/mine.toml\"\n{QUANTITIES}
        [parameters]\nx = [350, 340.5]\n[program_parameters]\npace = [100, 37]\nn = 1\npause = 1.5"
    ));
    let block = computed(&study);
    assert_eq!(block.samples.len(), 4);
    for row in 0..4 {
        let (x, speed) = ([350.0, 340.5][row / 2], [100, 37][row % 2]);
        let program = PROGRAM.replace("pace = 100", &format!("pace = {speed}"));
        let program = program.replace("n = 2", "n = 1").replace("0.5 s", "1.5 s");
        compare(&study, &block, row, &checked(&cell_text(), &[("x", x)], &program));
    }
    assert_eq!(column(&study, &block, "x"), [350.0, 350.0, 340.5, 340.5]);
    // Each sample by itself, and chunk by chunk, has the same bits.
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    let again = self::study(&study.text);
    for (row, sample) in [(3, 3), (0, 0)] {
        let alone = again.plan.compute(&[sample]).unwrap();
        for (all, one) in block.columns.iter().zip(&alone.columns) {
            assert_eq!(bits(&all[row..=row]), bits(one));
        }
    }
    let fresh = self::study(&study.text);
    let chunk = compute_chunk(&*fresh.plan, 0).unwrap();
    assert_eq!(bits(&chunk[0].columns[3]), bits(&block.columns[3]));
    let median = quantiles(&*fresh.plan, &[0.0, 1.0]).unwrap();
    let slip = column(&study, &block, "slip");
    let ends = [f64::min, f64::max].map(|of| slip.iter().copied().reduce(of));
    let index = fresh.columns.iter().find(|column| column.name == "slip").unwrap().source;
    let Source::Number { index, .. } = index else { panic!("slip is a number") };
    assert_eq!(median[index], ends);
}

#[test]
fn displaced_stations_are_those_of_an_edited_file() {
    let study = study(&format!(
        "kind = \"study\"\ncell = \"cells/mine.toml\"\nprogram = \"short.program\"\n{QUANTITIES}
        [stations.LP2]\ndx_mm = [0, 5.25]\ndz_mm = -2.5"
    ));
    let block = computed(&study);
    for (row, x) in ["-495.0", "-489.75"].into_iter().enumerate() {
        let from = "position_mm = [-495.0, -495.0, 500.0]";
        let text = cell_text().replace(from, &format!("position_mm = [{x}, -495.0, 497.5]"));
        assert_ne!(text, cell_text());
        let program = "GET LP1 SLOT 3 WITH B\nPUT LP2 SLOT 3 WITH B\n";
        compare(&study, &block, row, &checked(&text, &[], program));
    }
}

#[test]
fn samples_without_an_answer_are_outcomes() {
    let study = study(&format!(
        "kind = \"study\"\ncell = \"cells/mine.toml\"\nprogram = [\"short.program\", \"cells/mine.program\"]\n{QUANTITIES}
        [parameters]\nx = [350, 2000, -1e6]\n"
    ));
    let block = computed(&study);
    // The short program does not use the displaced station; the last cell has a station far away, which is valid.
    let outcome = |row: usize| match block.outcomes[0][row] {
        Outcome::Program(outcome) => outcome,
        other => panic!("{other:?}"),
    };
    let found: Vec<ProgramOutcome> = (0..6).map(outcome).collect();
    let (passed, out) = (ProgramOutcome::Passed, ProgramOutcome::OutOfReach);
    assert_eq!(found, [passed, passed, passed, passed, out, out]);
    assert_eq!(column(&study, &block, "program"), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    let numbers = block.columns[2..].iter();
    assert!(numbers.clone().all(|column| column[4].is_nan() && column[5].is_nan()));
    assert!(numbers.clone().all(|column| column[0].is_finite()));

    let others = self::study(&format!(
        "kind = \"study\"\ncell = \"cells/mine.toml\"\n{QUANTITIES}
        [program_parameters]\npace = [5, 100]\nn = [0, 1, 26]\n"
    ));
    let block = computed(&others);
    let found: Vec<&str> = block.outcomes[0].iter().map(|outcome| outcome.name()).collect();
    let out_of_range = "invalid program";
    let expected = [out_of_range; 3].into_iter().chain(["no motion", "passed", out_of_range]);
    assert_eq!(found, expected.collect::<Vec<_>>());
}

#[track_caller]
fn refuse_all(text: &str, line: usize, message: &str) {
    let Err(errors) = parse(text, &mut from_files(&files())) else { panic!("{text} is accepted") };
    let is_reported = |error: &jointplay_format::study::Error| {
        error.place.line == line && error.to_string().contains(message)
    };
    assert!(errors.iter().any(is_reported), "{}", errors.with_excerpt("s.toml"));
}

#[test]
fn invalid_studies_of_cells_are_refused_with_their_places() {
    let head = format!("kind = \"study\"\n{QUANTITIES}\ncell = \"cells/mine.toml\"\n");
    let refuse = |text: &str, line: usize, message: &str| {
        refuse_all(&format!("{head}{text}"), line, message)
    };
    refuse("mechanism = \"slider-crank\"", 4, "either `mechanism` or `cell`");
    refuse("program = \"missing.program\"", 4, "there is no file");
    refuse("program = [\"short.program\", \"short.program\"]", 4, "twice");
    refuse("program = \"cells/mine.toml\"", 4, "more errors");
    refuse("[parameters]\ny = 1", 5, "parameter");
    refuse("[program_parameters]\nfeed = 1", 5, "pace");
    refuse("[stations.LP3]\ndx_mm = 1", 4, "LP1");
    refuse("[stations.LP2]\ndx = 1", 5, "dx_mm");
    refuse("[stations.LP2]\n", 4, "at least one entry");
    refuse("[stations.PM1]\ndz_mm = 1", 5, "taught points");
    refuse("[stations.ALIGN]\ndx_mm = 1", 5, "expression");
    refuse("[stations.LP2]\ndx_mm = { normal = [0, 1] }", 4, "samples");
    refuse("samples = 5", 4, "nothing is random");
    refuse_all(
        "kind = \"study\"\nquantities = [\"cycle_time\"]\ncell = \"example\"",
        2,
        "cycle_time_s",
    );
    refuse_all(
        "kind = \"study\"\nquantities = [\"slip\"]\ncell = \"dual-arm\"",
        3,
        "invalid cell \"dual-arm\"",
    );
    refuse_all("kind = \"study\"\nquantities = [\"slip\"]\ncell = \"short.toml\"", 3, "no file");
}
