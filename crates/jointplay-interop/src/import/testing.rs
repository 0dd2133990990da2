//! Models in tests.

use super::model::Imported;
use super::read::parse;

#[track_caller]
pub(super) fn read(text: &str) -> Imported {
    parse(text).map_err(|error| error.with_excerpt("model")).unwrap_or_else(|m| panic!("{m}"))
}

/// Replaces a part of a model, and checks an error message and the text above its carets.
#[track_caller]
pub(super) fn refuse(model: &str, from: &str, to: &str, blamed: &str, message: &str) {
    assert!(model.contains(from), "{from:?} is not in the model");
    let error = parse(&model.replacen(from, to, 1)).unwrap_err();
    let shown = error.with_excerpt("model");
    assert!(error.to_string().contains(message), "{shown}");
    let place = &error.place;
    let found: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
    assert_eq!(found, blamed, "{shown}");
}
