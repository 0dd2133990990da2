//! A file of loops never panics.

#![no_main]

use std::sync::LazyLock;

use jointplay::format::mechanism;
use jointplay::interop::import;
use jointplay::mechanism::Mechanism;
use libfuzzer_sys::fuzz_target;

static CHAIN: LazyLock<Mechanism> = LazyLock::new(|| {
    let model = include_str!("../../validation/golden/models/tree.urdf");
    import::parse(model).expect("the model is sound").mechanism
});

fuzz_target!(|text: &str| {
    if let Err(error) = mechanism::with_loops(&CHAIN, text) {
        drop(error.with_excerpt("loops"));
    }
});
