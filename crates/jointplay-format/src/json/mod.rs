//! Requests in JSON, read strictly: each error has the field, what it is, and what is allowed.
//!
//! Objects have no field twice and none that is not known, and a list is never read as an object.
//!
//! ```
//! use jointplay_format::json;
//!
//! #[derive(serde::Deserialize)]
//! #[serde(deny_unknown_fields)]
//! struct Move {
//!     to_m: [f64; 3],
//! }
//!
//! let error = json::read::<Move>(br#"{"to_m": [0.5, true, 0.5]}"#).err().unwrap();
//! assert_eq!(error.field, "to_m[1]");
//! assert_eq!(error.to_string(), "`to_m[1]`: expected a number, got true");
//! ```

mod error;
mod reader;
mod unique;

use serde::de::DeserializeOwned;
use serde_json::Value;

pub use error::{Allowed, Found, JsonError, Problem};

use reader::Reader;
use unique::Unique;

/// Field with the kind of an object.
const KIND: &str = "kind";

/// Parses a text as JSON.
///
/// # Errors
///
/// [`Problem::NotJson`] if it is not valid, or an object has a field twice.
pub fn parse(text: &[u8]) -> Result<Value, JsonError> {
    let parsed = serde_json::from_slice(text);
    parsed.map(|Unique(value)| value).map_err(|error| Problem::NotJson(error).at(""))
}

/// Reads a text of JSON as `T`.
///
/// # Errors
///
/// As [`parse`] and [`read_value`].
pub fn read<T: DeserializeOwned>(text: &[u8]) -> Result<T, JsonError> {
    read_value(parse(text)?, "")
}

/// Reads the value of a field as `T`; the name of the field is empty for a whole request.
///
/// # Errors
///
/// [`JsonError`] with the first field that cannot be read.
pub fn read_value<T: DeserializeOwned>(value: Value, field: &str) -> Result<T, JsonError> {
    T::deserialize(Reader(value)).map_err(|error| error.within(field))
}

/// The kind of an object at a field, one of `known`.
///
/// # Errors
///
/// [`JsonError`] if the value is not an object with one of these kinds.
pub fn kind(
    value: &Value,
    field: &str,
    known: &'static [&'static str],
) -> Result<&'static str, JsonError> {
    let Value::Object(fields) = value else {
        let found = Found::of(value);
        return Err(Problem::Type { allowed: Allowed::ObjectOfKind(known), found }.at(field));
    };
    let Some(kind) = fields.get(KIND) else {
        return Err(Problem::MissingKind { known }.at(field));
    };
    let of_name = |name: &str| known.iter().find(|known| **known == name).copied();
    kind.as_str().and_then(of_name).ok_or_else(|| {
        let (allowed, found) = (Allowed::OneOf(known), Found::of(kind));
        Problem::Type { allowed, found }.at(KIND).within(field)
    })
}

/// The kind of a request, and the request without it.
///
/// # Errors
///
/// As [`parse`] and [`kind`].
pub fn request_of_kind(
    text: &[u8],
    known: &'static [&'static str],
) -> Result<(&'static str, Value), JsonError> {
    let mut value = parse(text)?;
    let kind = kind(&value, "", known)?;
    if let Value::Object(fields) = &mut value {
        fields.shift_remove(KIND);
    }
    Ok((kind, value))
}

#[cfg(test)]
mod tests;
