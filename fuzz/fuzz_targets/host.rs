//! The session of a host that sends any bytes never panics: each line has an answer in whole lines, and no line moves anything but the robot.

#![no_main]

use std::sync::LazyLock;

use jointplay::cell::workcell::Cell;
use jointplay::format::cell;
use jointplay::interop::host::{HostLanguage, HostSession, MAX_LINE_BYTES};
use libfuzzer_sys::fuzz_target;

static CELL: LazyLock<Cell> = LazyLock::new(|| {
    cell::read(cell::EXAMPLE, &mut |_| Err("no files".to_owned())).expect("the example is sound")
});

/// The neutral language, and one whose lines have checksums and codes.
static LANGUAGES: LazyLock<[HostLanguage; 2]> = LazyLock::new(|| {
    let framed = include_str!("../seeds/dialect/framed-host.toml");
    let framed = HostLanguage::parse(framed)
        .unwrap_or_else(|errors| panic!("{}", errors.with_excerpt("framed-host")));
    [HostLanguage::neutral(), framed]
});

fuzz_target!(|bytes: &[u8]| {
    let Some((&choice, bytes)) = bytes.split_first() else { return };
    let language = &LANGUAGES[usize::from(choice) % LANGUAGES.len()];
    let session = HostSession::new(language, CELL.clone(), 1000.0);
    let mut session = session.expect("the example is sound");
    let mut now = 0.0;
    for line in bytes.split(|byte| matches!(byte, b'\n' | b'\r')).take(16) {
        now += 0.001;
        let answer = match line.len() > MAX_LINE_BYTES {
            true => session.receive_too_long(now),
            false => session.receive(line, now),
        };
        let answer = answer.expect("templates of these languages have values");
        assert!(!answer.is_empty() && answer.ends_with('\n'), "{answer:?}");
    }
    let snapshot = session.snapshot();
    let state = snapshot.state_at(now);
    let are_numbers = state.positions.iter().all(|position| position.is_finite());
    assert!(are_numbers && state.wafers.len() == CELL.occupied.len(), "{state:?}");
    assert!(snapshot.events().len() <= 20);
});
