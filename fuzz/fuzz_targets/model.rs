//! A model of another program never panics; one that is taken over is written as the same mechanism.

#![no_main]

use jointplay::format::mechanism;
use jointplay::interop::import;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match import::parse(text) {
        Ok(model) => {
            let written = mechanism::write(&model.mechanism, None);
            let read = mechanism::parse(&written).map_err(|error| error.with_excerpt("written"));
            let read = read.unwrap_or_else(|message| panic!("{message}")).mechanism;
            assert_eq!(read.joint_freedoms(), model.mechanism.joint_freedoms());
            assert_eq!(read.loops(), model.mechanism.loops());
        }
        Err(error) => drop(error.with_excerpt("model")),
    }
});
