//! Models in tests, also in those of the folder `tests`.

use jointplay_format::mechanism::LengthUnit;

use super::{Imported, parse_with_unit};

#[track_caller]
pub(super) fn read(text: &str) -> Imported {
    parse_with_unit(text, LengthUnit::Meter)
        .map_err(|error| error.with_excerpt("model"))
        .unwrap_or_else(|m| panic!("{m}"))
}

/// Replaces a part of a model, and checks an error message and the text above its carets.
#[track_caller]
pub(super) fn refuse(model: &str, from: &str, to: &str, blamed: &str, message: &str) {
    assert!(model.contains(from), "{from:?} is not in the model");
    let changed = model.replacen(from, to, 1);
    let error = parse_with_unit(&changed, LengthUnit::Meter).unwrap_err();
    let shown = error.with_excerpt("model");
    assert!(error.to_string().contains(message), "{shown}");
    let place = &error.place;
    let found: String = place.text.chars().skip(place.column - 1).take(place.width).collect();
    assert_eq!(found, blamed, "{shown}");
}
