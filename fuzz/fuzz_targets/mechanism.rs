//! A mechanism file never panics; one that is read is written as the same mechanism.

#![no_main]

use jointplay::format::mechanism;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match mechanism::parse(text) {
        Ok(file) => {
            let written = mechanism::write(&file.mechanism, file.source.as_deref());
            let read = mechanism::parse(&written).map_err(|error| error.with_excerpt("written"));
            let read = read.unwrap_or_else(|message| panic!("{message}")).mechanism;
            assert_eq!(read.joint_freedoms(), file.mechanism.joint_freedoms());
            assert_eq!(read.loops(), file.mechanism.loops());
        }
        Err(error) => drop(error.with_excerpt("file")),
    }
    let _ = mechanism::kind_of(text);
});
