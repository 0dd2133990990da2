//! A file of loops, in TOML or in YAML, never panics.

#![no_main]

use std::sync::LazyLock;

use jointplay::format::mechanism;
use jointplay::interop::import::{self, ClosedError, LoopsError};
use jointplay::mechanism::Mechanism;
use libfuzzer_sys::fuzz_target;

const MODEL: &str = include_str!("../../validation/golden/models/tree.urdf");

static CHAIN: LazyLock<Mechanism> =
    LazyLock::new(|| import::parse(MODEL).expect("the model is sound").mechanism);

fuzz_target!(|text: &str| {
    if let Err(error) = mechanism::with_loops(&CHAIN, text) {
        drop(error.with_excerpt("loops"));
    }
    let closed = import::parse_closed(MODEL, None, text);
    if let Err(ClosedError::Loops(LoopsError::Yaml(error))) = closed {
        drop(error.with_excerpt("loops"));
    }
});
