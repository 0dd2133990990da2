//! Models of other programs: their formats, and damaged files of each.

use jointplay_interop::import::{Dialect, Problem, is_model, parse};
use proptest::prelude::*;

use super::testing;

const MODELS: [&str; 4] = [
    include_str!("../../../validation/golden/models/frames.sdf"),
    include_str!("../../../validation/golden/models/defaults.mjcf.xml"),
    include_str!("../../../validation/golden/models/orientations.mjcf.xml"),
    include_str!("../../../validation/golden/models/tree.urdf"),
];

#[test]
fn the_root_element_determines_the_format() {
    let dialects = MODELS.map(|model| testing::read(model).dialect);
    assert_eq!(dialects.map(Dialect::name), ["SDF", "MJCF", "MJCF", "URDF"]);
    for first in ["OndselSolver", "freeCAD: 3D CAD with Motion Simulation  by  askoh.com "] {
        let assembly = format!("{first}\nAssembly\n");
        assert_eq!(*parse(&assembly).unwrap_err().problem, Problem::NoUnit);
    }
    testing::refuse("<robots/>", "<robots/>", "<svg/>", "<svg/>", "<Document> (FCStd)");
    testing::refuse("<sdf><a></sdf>", "", "", "", "not well-formed XML: expected 'a' tag");
    assert!(is_model("\u{feff}\n <robot/>") && !is_model("kind = \"mechanism\""));
}

#[test]
fn truncated_models_do_not_panic() {
    for model in MODELS {
        for cut in (0..model.len()).filter(|cut| model.is_char_boundary(*cut)) {
            for text in [&model[..cut], &model[cut..]] {
                if let Err(error) = parse(text) {
                    let _ = error.with_excerpt("x");
                }
            }
        }
    }
}

proptest! {
    #[test]
    fn mutated_models_do_not_panic(
        model in 0..MODELS.len(),
        cuts in prop::collection::vec(
            (0.0..1.0, 0..30_usize, "[-<>/\"=.0-9a-z\n ]{0,4}|nan|1e999|world|::"), 1..4
        ),
    ) {
        let mut text = MODELS[model].to_owned();
        for (part, length, replacement) in cuts {
            let start = (part * text.len() as f64) as usize;
            let end = (start + length).min(text.len());
            if text.is_char_boundary(start) && text.is_char_boundary(end) {
                text.replace_range(start..end, &replacement);
            }
        }
        match parse(&text) {
            Ok(model) => {
                let written = jointplay_format::mechanism::write(&model.mechanism, None);
                let read = jointplay_format::mechanism::parse(&written);
                prop_assert!(read.is_ok(), "{}", read.unwrap_err().with_excerpt("written"));
            }
            Err(error) => {
                let _ = error.with_excerpt("x");
            }
        }
    }
}
