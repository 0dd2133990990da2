//! A program never panics; one that is read is laid out and written as the same program.

#![no_main]

use jointplay::format::program;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match program::parse(text) {
        Ok(read) => {
            let even = program::format(text).expect("what is read is laid out");
            assert_eq!(program::format(&even).expect("the layout is a program"), even);
            let again = program::parse(&even).expect("the layout is a program");
            // Positions differ, messages do not.
            let written = program::write(&read);
            assert_eq!(program::write(&again), written);
            let back = program::parse(&written).expect("what is written is read");
            assert_eq!(program::write(&back), written);
        }
        Err(errors) => {
            for error in errors {
                drop(error.with_excerpt("program"));
            }
        }
    }
});
