//! The simulated controller: its commands move as programs do, and nothing else moves it.

use jointplay_cell::{IncrementalPlanner, PlanOptions};
use jointplay_format::{cell, program};
use jointplay_interop::host::{
    HostEvent, HostLanguage, HostSession, HostSnapshot, MAX_LINE_BYTES, NEUTRAL, Outcome,
};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::planned::example;

/// A host that waits for each answer.
struct Host<'l> {
    session: HostSession<'l>,
    now: f64,
}

impl<'l> Host<'l> {
    fn new(language: &'l HostLanguage, speed: f64) -> Self {
        Self { session: HostSession::new(language, example(), speed).unwrap(), now: 0.0 }
    }

    fn send(&mut self, line: &str) -> String {
        self.session.receive(line.as_bytes(), self.now).unwrap()
    }

    /// Sends a line, and waits until the robot is at rest.
    fn execute(&mut self, line: &str) -> String {
        let mut answers = self.send(line);
        while let Some(time) = self.session.next_event() {
            self.now = time;
            answers.push_str(&self.session.advance(time).unwrap());
        }
        answers
    }
}

#[test]
fn each_command_moves_as_the_instruction_of_a_program_does() {
    let pairs = [
        ("GET LP1 3 A", "GET LP1 SLOT 3 WITH A"),
        ("GOTO LP2 12 A", "GOTO LP2 SLOT 12 WITH A"),
        ("PUT LP2 12 A", "PUT LP2 SLOT 12 WITH A"),
        ("SPEED 50", "SPEED 50 %"),
        ("GET LP1 4 B", "GET LP1 SLOT 4 WITH B"),
        ("TILT 0.5 TOWARD 30", "TILT 0.5 deg TOWARD 30 deg"),
        ("LEVEL", "TILT LEVEL"),
        ("MOVE T 12.345678", "MOVE T 12.345678 deg"),
        ("PUT LP2 13 B", "PUT LP2 SLOT 13 WITH B"),
        ("HOME", "HOME"),
    ];
    let cell = example();
    let whole: Vec<&str> = pairs.iter().map(|(_, instruction)| *instruction).collect();
    let whole = program::parse(&whole.join("\n")).unwrap();
    let (motion, report) =
        IncrementalPlanner::default().plan(&cell, &whole, &PlanOptions::default()).unwrap();
    let language = HostLanguage::neutral();
    let mut host = Host::new(&language, 1.0);
    for (k, (command, _)) in pairs.into_iter().enumerate() {
        let answers = host.execute(command);
        let lines: Vec<&str> = answers.lines().collect();
        let [accepted, completed] = lines[..] else { panic!("{answers}") };
        let result = report.by_instruction.iter().find(|one| one.place.line == k + 1);
        let duration = result.map_or(0.0, |result| result.duration);
        assert_eq!(accepted, format!("ACCEPTED {duration:.3} {command}"));
        assert_eq!(completed, format!("COMPLETED {duration:.3} {command}"));
    }
    assert!((host.now - motion.duration()).abs() < 1e-9);
    assert_eq!(host.send("MAP LP2").trim_end(), {
        let slots = (1..=25).map(|slot| if slot == 12 || slot == 13 { "1" } else { "0" });
        format!("MAP LP2 {}", slots.collect::<Vec<_>>().join(" "))
    });
}

#[test]
fn while_the_robot_moves_it_answers_its_state_and_refuses_other_motions() {
    let language = HostLanguage::neutral();
    let mut host = Host::new(&language, 2.0);
    assert!(host.send("GET LP1 3 A").starts_with("ACCEPTED "));
    let end = host.session.next_event().unwrap();
    // Half of the time of the clock is half of the motion, at any speed.
    host.now = 0.5 * end;
    let status = host.send("STATUS");
    let words: Vec<&str> = status.split_whitespace().collect();
    assert_eq!(words[..2], ["STATUS", "moving"]);
    let remaining: f64 = words[2].parse().unwrap();
    assert!((remaining - 0.5 * end * 2.0).abs() < 1e-3, "{status} {end}");
    assert!(status.contains(" A=0 ") || status.contains(" A=1 "), "{status}");
    assert!(host.send("HOME").starts_with("REFUSED 3 the robot executes GET LP1 3 A"));
    assert!(host.send("RESET").starts_with("REFUSED 3 "));
    host.now = end;
    let answers = host.send("STATUS");
    assert!(answers.starts_with("COMPLETED "), "{answers}");
    assert!(answers.contains("\nSTATUS idle 0.000 "), "{answers}");
    assert!(answers.trim_end().ends_with("A=1 B=0"), "{answers}");
}

#[test]
fn a_snapshot_is_the_planned_motion_at_any_time_and_wafers_keep_their_names() {
    let language = HostLanguage::neutral();
    let mut host = Host::new(&language, 4.0);
    let home = host.session.snapshot().state_at(0.0);
    assert_eq!((home.command, home.duration), (None, 0.0));
    let program = program::parse("GET LP1 SLOT 3 WITH A\nPUT LP2 SLOT 5 WITH A").unwrap();
    let (motion, _) =
        IncrementalPlanner::default().plan(&example(), &program, &PlanOptions::default()).unwrap();
    let mut before = 0.0;
    for command in ["GET LP1 3 A", "PUT LP2 5 A"] {
        host.send(command);
        let (start, end) = (host.now, host.session.next_event().unwrap());
        for share in [0.0, 0.25, 0.625, 1.0] {
            // A snapshot is independent of the session, and of the time at which it is read.
            let now = start + share * (end - start);
            let state = host.session.snapshot().state_at(now);
            assert_eq!(state.command.as_deref(), Some(command));
            assert!((state.elapsed - 4.0 * (now - start)).abs() < 1e-9);
            let planned = motion.sample_at(before + state.elapsed).positions;
            let differs = state.positions.iter().zip(&planned).any(|(a, b)| (a - b).abs() > 1e-9);
            assert!(!differs, "{command} at {}: {:?} {planned:?}", state.elapsed, state.positions);
        }
        before += 4.0 * (end - start);
        host.now = end;
        host.session.advance(end).unwrap();
    }
    let snapshot = host.session.snapshot();
    let state = snapshot.state_at(host.now);
    let slot = |name: &str| state.wafers.iter().find(|(one, _)| one == name).unwrap().1.slot();
    assert_eq!(slot("wafer of LP1 3").map(|slot| slot.slot), Some(5));
    assert_eq!(slot("wafer of LP1 4").map(|slot| slot.slot), Some(4));
    // Frames have the names of the scene at the start.
    let names = |snapshot: &HostSnapshot, now| {
        let mut names: Vec<String> =
            snapshot.frames_at(now).unwrap().into_iter().map(|frame| frame.name).collect();
        names.sort_unstable();
        names
    };
    host.execute("RESET");
    assert_eq!(names(&snapshot, host.now), names(&host.session.snapshot(), host.now));
    // The last commands are listed with what became of them; memory is bounded.
    host.send("GET LP1 99 A");
    let events = host.session.snapshot().events().to_vec();
    assert!(matches!(events.last().unwrap().outcome, Outcome::Refused { .. }), "{events:?}");
    assert_eq!(events[0].outcome, Outcome::Accepted { duration: motion_part(&events[1]) });
    (0..100).for_each(|_| drop(host.send("NONSENSE")));
    assert!(host.session.snapshot().events().len() <= 20);
}

/// Duration of a completed motion.
fn motion_part(event: &HostEvent) -> f64 {
    match event.outcome {
        Outcome::Completed { duration } => duration,
        _ => panic!("{event:?}"),
    }
}

#[test]
fn a_stop_ends_at_the_end_of_a_segment_and_the_next_command_starts_there() {
    let language = HostLanguage::neutral();
    let mut host = Host::new(&language, 1.0);
    let whole = host.execute("GET LP1 3 A");
    assert!(whole.contains("COMPLETED"), "{whole}");
    host.execute("RESET");
    host.send("GET LP1 3 A");
    let end = host.session.next_event().unwrap();
    host.now += 0.1;
    let accepted = host.send("STOP");
    let stopped = host.session.next_event().unwrap();
    assert_eq!(accepted.trim_end(), format!("ACCEPTED {:.3} STOP", stopped - host.now));
    assert!(stopped < end, "{stopped} {end}");
    host.now = stopped;
    let answer = host.session.advance(stopped).unwrap();
    assert!(answer.starts_with("STOPPED ") && answer.contains("GET LP1 3 A"), "{answer}");
    assert!(host.send("STATUS").contains("A=0"));
    // The next command starts there.
    assert!(host.execute("GET LP1 3 A").contains("COMPLETED"));
    assert_eq!(host.send("STOP").trim_end(), "STOPPED 0.000 STOP");
}

#[test]
fn refusals_have_a_code_a_reason_and_leave_everything_as_it_was() {
    let language = HostLanguage::neutral();
    let mut host = Host::new(&language, 1.0);
    let before = host.send("STATUS");
    for (line, refusal) in [
        ("GET LP9 3 A", "REFUSED 2 found \"LP9\" in place of a station: LP1, LP2"),
        ("GET LP1 3 C", "REFUSED 2 found \"C\" in place of an effector: A, B"),
        ("GET LP1 x A", "REFUSED 2 found \"x\" in place of a whole number"),
        ("GET LP1 3", "REFUSED 2 "),
        // Before, these were "incomplete or too long", without what was found.
        (
            "GET LP1 3 A B",
            "REFUSED 2 found \"B\" in place of the end of the line; the command is GET {station}",
        ),
        ("GET LP1", "REFUSED 2 found the end of the line in place of {slot}; the command is GET"),
        ("GET LP1x 3 A", "REFUSED 2 found \"x\" in place of a space; the command is GET"),
        (
            "MOVE T 1e9",
            "REFUSED 2 found \"e9\" in place of the end of the line; the command is MOVE",
        ),
        ("DANCE", "REFUSED 2 not a command; commands: HOME | GET"),
        ("GET LP1 99 A", "REFUSED 4 "),
        ("GET LP2 3 A", "REFUSED 4 "),
        ("PUT LP1 3 A", "REFUSED 4 "),
        ("MOVE T 1e3", "REFUSED 2 "),
        ("MOVE T 99999", "REFUSED 5 "),
        ("SPEED 0", "REFUSED 4 "),
        ("SPEED 400", "REFUSED 4 "),
        ("MOVE T 10\u{7}", "REFUSED 2 "),
    ] {
        let answer = host.send(line);
        assert!(answer.starts_with(refusal), "{line}: {answer}");
        assert_eq!(answer.lines().count(), 1, "{answer}");
    }
    assert!(host.session.receive(&[0xff, 0xfe], 0.0).unwrap().starts_with("REFUSED 1 "));
    let long = vec![b'x'; MAX_LINE_BYTES + 1];
    assert!(host.session.receive(&long, 0.0).unwrap().starts_with("REFUSED 1 "));
    assert_eq!(host.send("STATUS"), before);
}

#[test]
fn motions_with_violations_are_refused() {
    // An obstacle between the robot and the load port.
    let wall = "[[body]]\nname = \"obstacle\"\nbox = { size_mm = [200.0, 200.0, 400.0] }\nposition_mm = [-250.0, 250.0, 500.0]\n";
    let text = format!("{}\n{wall}", cell::EXAMPLE);
    let cell = cell::read(&text, &mut |_| Err("no files".to_owned())).unwrap();
    let language = HostLanguage::neutral();
    let mut session = HostSession::new(&language, cell, 1.0).unwrap();
    let answer = session.receive(b"GET LP1 3 A", 0.0).unwrap();
    assert!(answer.starts_with("REFUSED 6 "), "{answer}");
    assert!(answer.contains("obstacle"), "{answer}");
    assert_eq!(session.next_event(), None);
}

/// A language with codes, numbers of commands and checksums.
fn framed() -> HostLanguage {
    let text = NEUTRAL
        .replace(
            "pattern = \"GET {station} {slot} {effector}\"",
            "pattern = \"{id},GET,{station_code}S{slot},{effector_code}\"",
        )
        .replace("COMPLETED {duration} {command}", "{id},DONE,{duration:08.3f}");
    let tables = r#"
[station_codes]
LP1 = "P1"
LP2 = "P10"
[effector_codes]
A = 1
B = 2
[input]
covered = "${text},"
line = "{covered}{checksum:02X}"
checksum = "sum"
[output]
covered = "${text},"
line = "{covered}{checksum:02X}"
checksum = "sum"
line_end = "crlf"
"#;
    HostLanguage::parse(&format!("{text}{tables}")).unwrap()
}

/// A line with the checksum of [`framed`], computed here.
fn with_sum(text: &str) -> String {
    let covered = format!("${text},");
    let sum = covered.bytes().fold(0_u8, u8::wrapping_add);
    format!("{covered}{sum:02X}")
}

#[test]
fn lines_have_codes_identifiers_and_checksums() {
    let language = framed();
    let mut host = Host::new(&language, 1.0);
    let answers = host.execute(&with_sum("77,GET,P1S03,1"));
    let done = answers.lines().last().unwrap();
    assert!(done.starts_with("$77,DONE,"), "{answers}");
    let text = &done[1..done.len() - 3];
    assert_eq!(done, with_sum(text));
    assert!(answers.ends_with("\r\n"));
    // The longest code that fits is taken: P10 is LP2, whose slot 3 is empty.
    let refused = host.send(&with_sum("78,GET,P10S3,2"));
    assert!(refused.starts_with("$REFUSED 4 "), "{refused}");
    for invalid in ["$78,GET,P1S04,2,00", "78,GET,P1S04,2", "$", ""] {
        let refused = host.send(invalid);
        assert!(refused.starts_with("$REFUSED 1 "), "{invalid}: {refused}");
    }
}

/// Before, the controller filled both templates for each part of the line that can be the command: hours, and gigabytes.
#[test]
fn forms_of_lines_that_multiply_the_text_fit_no_line() {
    let input = format!(
        "\n[input]\ncovered = \"{}\"\nline = \"{}\"\n",
        "{text}".repeat(1000),
        "{covered}".repeat(1000)
    );
    let language = HostLanguage::parse(&(NEUTRAL.to_owned() + &input)).unwrap();
    let mut host = Host::new(&language, 1.0);
    let answer = host.send(&"STATUS ".repeat(100));
    assert!(answer.starts_with("REFUSED 1 "), "{answer}");
}

/// What earlier commands did with wafers is not the start of a program.
#[test]
fn refusals_of_wafers_state_what_is_there() {
    let language = HostLanguage::neutral();
    let mut host = Host::new(&language, 1.0);
    host.execute("GET LP1 3 A");
    for (line, answer) in [
        ("GET LP1 3 B", "REFUSED 4 slot 3 of LP1 is empty; PUT a wafer there first\n"),
        ("GET LP1 4 A", "REFUSED 4 effector A already carries a wafer; PUT that first\n"),
        ("PUT LP1 4 A", "REFUSED 4 slot 4 of LP1 already holds a wafer; GET that first\n"),
        ("PUT LP1 3 B", "REFUSED 4 effector B carries no wafer; GET one first\n"),
    ] {
        assert_eq!(host.send(line).replace('\r', ""), answer);
    }
}

#[test]
fn names_of_a_cell_cannot_become_commands() {
    let text = cell::EXAMPLE.replace("\"LP1\"", "\"WITH\"");
    let cell = cell::read(&text, &mut |_| Err("no files".to_owned())).unwrap();
    let language = HostLanguage::neutral();
    let mut session = HostSession::new(&language, cell, 1.0).unwrap();
    let answer = session.receive(b"GET WITH 3 A", 0.0).unwrap();
    assert!(answer.starts_with("ACCEPTED "), "{answer}");
    let end = session.next_event().unwrap();
    session.advance(end).unwrap();
    let map = session.receive(b"MAP WITH", end).unwrap();
    assert!(map.starts_with("MAP WITH 1 1 0 1 "), "{map}");
}

#[test]
fn invalid_languages_are_rejected_with_the_place_of_each_error() {
    let refuse = |from: &str, to: &str, message: &str| {
        let text = NEUTRAL.replacen(from, to, 1);
        assert_ne!(text, NEUTRAL, "{from}");
        let errors = HostLanguage::parse(&text).unwrap_err();
        let shown: Vec<String> = errors.iter().map(|error| error.with_excerpt("x.toml")).collect();
        assert!(shown.join("\n").contains(message), "{}", shown.join("\n"));
    };
    refuse("pattern = \"GET {station}", "pattern = \"GET {statoin}", "did you mean `station`");
    refuse(
        "pattern = \"GET {station}",
        "pattern = \"GET {station_code}",
        "needs the table `[station_codes]`",
    );
    refuse("{slot} {effector}\"", "{slot}{effector}\"", "text has to separate them");
    refuse("pattern = \"HOME\"", "pattern = \"{x}\"", "at least one word");
    refuse("pattern = \"HOME\"", "pattern = \"HOME {\"", "no counterpart");
    refuse("PUT {effector_2}\"\nprogram", "PUT {effector}\"\nprogram", "is twice in this pattern");
    refuse("program = [\"HOME\"]", "program = [\"HOEM\"]", "is not a program");
    refuse("program = [\"HOME\"]", "", "either a `program` or an `action`");
    refuse("action = \"status\"", "action = \"state\"", "known: ");
    refuse("pattern = \"MAP {station}\"", "pattern = \"MAP\"", "needs {station}");
    refuse("completed = [", "complete = [", "unknown key");
    refuse("{remaining}", "{remainder}", "is not a name of this template");
    refuse(
        "program = [\"MOVE {axis}",
        "program = [\"MOVE {slot}",
        "is not a name of this template",
    );
}

/// Commands, lines of their words, and either with other bytes in places, as a faulty host sends them.
fn faulty_lines() -> impl Strategy<Value = Vec<Vec<u8>>> {
    let words = prop::sample::select(vec![
        "GET",
        "PUT",
        "SWAP",
        "GOTO",
        "MOVE",
        "TILT",
        "TOWARD",
        "SPEED",
        "LP1",
        "LP2",
        "A",
        "B",
        "T",
        "RA",
        "q1",
        "1",
        "3",
        "25",
        "26",
        "-1",
        "0.5",
        "1e9",
        "1e-300",
        "99999999999999999999",
        "NaN",
        "inf",
        "",
        "\u{00e4}",
        "*",
    ]);
    let words = vec(words, 1..7).prop_map(|words| words.join(" "));
    let commands = prop::sample::select(vec![
        "HOME",
        "GET LP1 3 A",
        "GET LP1 4 B",
        "PUT LP2 3 A",
        "PUT LP2 4 B",
        "SWAP LP1 5 GET B PUT A",
        "GOTO LP1 1 A",
        "MOVE T 10",
        "MOVE q1 380",
        "TILT 0.5 TOWARD 30",
        "LEVEL",
        "SPEED 50",
        "STATUS",
        "MAP LP1",
        "STOP",
        "RESET",
    ]);
    let line = prop_oneof![3 => commands.prop_map(str::to_owned), 1 => words];
    let line = line.prop_map(String::into_bytes);
    let changes = vec((any::<prop::sample::Index>(), any::<u8>()), 0..3);
    let changed = (line, changes, 0..8_u8).prop_map(|(mut line, changes, is_changed)| {
        let length = line.len();
        for (place, byte) in changes.into_iter().filter(|_| is_changed == 0 && length > 0) {
            line[place.index(length)] = byte;
        }
        line
    });
    vec(changed, 1..8)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// As the fuzz target `host`, with lines that are commands more often.
    #[test]
    fn any_order_of_commands_leaves_a_state_of_the_robot(
        lines in faulty_lines(),
        waits in any::<u8>(),
        is_framed in any::<bool>(),
    ) {
        let language = if is_framed { framed() } else { HostLanguage::neutral() };
        let mut session = HostSession::new(&language, example(), 1000.0).unwrap();
        let mut now = 0.0;
        for (number, line) in lines.iter().enumerate() {
            now += 0.001;
            let answer = session.receive(line, now).unwrap();
            prop_assert!(!answer.is_empty() && answer.ends_with('\n'), "{:?}: {:?}", line, answer);
            // Half of the commands are interrupted by the next line.
            if waits >> (number % 8) & 1 == 1 {
                while let Some(time) = session.next_event() {
                    prop_assert!(time.is_finite() && time >= now, "{} after {}", time, now);
                    now = time;
                    session.advance(now).unwrap();
                }
            }
        }
        let snapshot = session.snapshot();
        let state = snapshot.state_at(now);
        let are_numbers = state.positions.iter().all(|position| position.is_finite());
        prop_assert!(are_numbers && state.wafers.len() == example().occupied.len(), "{:?}", state);
        prop_assert!(snapshot.events().len() <= 20);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_get_one_refusal_and_move_nothing(line in vec(any::<u8>(), 0..80)) {
        let language = framed();
        let mut host = Host::new(&language, 1.0);
        let answer = host.session.receive(&line, 0.0).unwrap();
        prop_assert!(answer.starts_with("$REFUSED "), "{}", answer);
        prop_assert_eq!(answer.lines().count(), 1);
        prop_assert_eq!(host.session.next_event(), None);
    }
}
