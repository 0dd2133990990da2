//! A dialect of a controller or the language of a host never panics; one that is read writes a motion, or answers its host.

#![no_main]

use std::sync::LazyLock;

use jointplay::cell::program::expand;
use jointplay::cell::trajectory::{Trajectory, TrajectoryOptions, plan_trajectory};
use jointplay::cell::workcell::Cell;
use jointplay::format::{cell, program};
use jointplay::interop::export::MotionExport;
use jointplay::interop::export::dialect::Dialect;
use jointplay::interop::host::{HostLanguage, HostSession};
use libfuzzer_sys::fuzz_target;

const PROGRAM: &str = "GET LP1 SLOT 3 WITH A\nWAIT 0.5 s\n";

static CELL: LazyLock<Cell> = LazyLock::new(|| {
    cell::read(cell::EXAMPLE, &mut |_| Err("no files".to_owned())).expect("the example is sound")
});

static MOTION: LazyLock<Trajectory> = LazyLock::new(|| {
    let program = program::parse(PROGRAM).expect("the program is sound");
    let steps = expand(&CELL, &program).expect("the cell has these stations");
    plan_trajectory(&CELL, steps, &TrajectoryOptions::default()).expect("they are in reach")
});

fuzz_target!(|text: &str| {
    match Dialect::parse(text) {
        Ok(dialect) => {
            let motion_export = MotionExport {
                cell: &CELL,
                motion: &MOTION,
                program: PROGRAM,
                violation_notes: &[],
            };
            let _ = dialect.write(&motion_export, 2.0);
        }
        Err(errors) => drop(errors.with_excerpt("dialect")),
    }
    match HostLanguage::parse(text) {
        Ok(language) => {
            let session = HostSession::new(&language, CELL.clone(), 1.0);
            let mut session = session.expect("the example is sound");
            // An answer may have no value, such as a division by zero; then the session ends.
            let _ = session.welcome();
            for line in ["", "STATUS", "MAP LP1", "STOP", "RESET", "GET LP1 3"] {
                let _ = session.receive(line.as_bytes(), 0.0);
            }
        }
        Err(errors) => drop(errors.with_excerpt("language")),
    }
});
