//! The fields of requests in JSON: each error names the field, what it is, and what is allowed.

use std::collections::BTreeMap;
use std::fmt;

use jointplay::format::place::nearest;
use serde::de::{Deserialize, Deserializer, Error as _, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};

use crate::catch::Failure;

/// Most characters of a value in an error.
const MOST_QUOTED: usize = 60;

/// Joint coordinates by name (m, rad).
pub(crate) type Values = BTreeMap<String, f64>;

/// The fields of an object.
pub(crate) struct Fields {
    /// Name of the object with a point, nothing for the request itself.
    path: String,
    fields: Map<String, Value>,
}

/// A field that is not as it has to be.
fn invalid(path: &str, allowed: &str, found: &Value) -> Failure {
    let found = match found {
        Value::Array(_) => "a list".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        other => {
            let text = other.to_string();
            match text.char_indices().nth(MOST_QUOTED) {
                Some((end, _)) => format!("{}…", &text[..end]),
                None => text,
            }
        }
    };
    Failure::input(format!("request: `{path}` has to be {allowed}, but is {found}"))
}

impl Fields {
    /// The fields of a request.
    pub(crate) fn of_request(request: &str) -> Result<Self, Failure> {
        let Unique(value) = serde_json::from_str(request)
            .map_err(|error| Failure::input(format!("request: not valid JSON: {error}")))?;
        match value {
            Value::Object(fields) => Ok(Self { path: String::new(), fields }),
            _ => Err(Failure::input(
                "request: has to be an object, such as {\"kind\": \"mobility\"}",
            )),
        }
    }

    /// The kind of the request, one of those that are known.
    pub(crate) fn kind(&mut self, known: &[&'static str]) -> Result<&'static str, Failure> {
        let listed = || known.join(", ");
        let allowed = || format!("one of {}", listed());
        match self.fields.remove("kind") {
            Some(Value::String(found)) => known
                .iter()
                .find(|name| **name == found)
                .copied()
                .ok_or_else(|| invalid("kind", &allowed(), &Value::String(found))),
            Some(other) => Err(invalid("kind", &allowed(), &other)),
            None => Err(Failure::input(format!("request: `kind` is missing; known: {}", listed()))),
        }
    }

    /// Refuses fields that are not known.
    pub(crate) fn only(self, known: &[&str]) -> Result<Self, Failure> {
        let Some(unknown) = self.fields.keys().find(|name| !known.contains(&name.as_str())) else {
            return Ok(self);
        };
        let quoted: String = unknown.chars().take(MOST_QUOTED).collect();
        let meant = match nearest(unknown, known.iter().copied()) {
            Some(name) => format!(" (did you mean `{name}`?)"),
            None => String::new(),
        };
        let (path, known) = (&self.path, known.join(", "));
        Err(Failure::input(format!(
            "request: `{path}{quoted}` is not known{meant}; known: {known}"
        )))
    }

    /// A field with its name; `None` if it is missing or null.
    fn take(&mut self, name: &str) -> Option<(String, Value)> {
        let value = self.fields.remove(name).filter(|value| !value.is_null())?;
        Some((format!("{}{name}", self.path), value))
    }

    fn read<T>(
        &mut self,
        name: &str,
        read: impl FnOnce(&str, Value) -> Result<T, Failure>,
    ) -> Result<Option<T>, Failure> {
        self.take(name).map(|(path, value)| read(&path, value)).transpose()
    }

    pub(crate) fn number(&mut self, name: &str) -> Result<Option<f64>, Failure> {
        self.read(name, number)
    }

    pub(crate) fn three(&mut self, name: &str) -> Result<Option<[f64; 3]>, Failure> {
        self.read(name, |path, value| {
            let allowed = "a list of 3 numbers";
            match value {
                Value::Array(found) if found.len() == 3 => {
                    let numbers = list(path, found, number)?;
                    Ok([numbers[0], numbers[1], numbers[2]])
                }
                Value::Array(found) => {
                    let found = format!("a list of {}", found.len());
                    Err(Failure::input(format!(
                        "request: `{path}` has to be {allowed}, but is {found}"
                    )))
                }
                other => Err(invalid(path, allowed, &other)),
            }
        })
    }

    pub(crate) fn whole(&mut self, name: &str) -> Result<Option<usize>, Failure> {
        self.read(name, |path, value| {
            let found = value.as_u64().and_then(|found| usize::try_from(found).ok());
            found.ok_or_else(|| invalid(path, "a whole number from 0", &value))
        })
    }

    pub(crate) fn truth(&mut self, name: &str) -> Result<bool, Failure> {
        let found = self.read(name, |path, value| {
            value.as_bool().ok_or_else(|| invalid(path, "true or false", &value))
        })?;
        Ok(found.unwrap_or(false))
    }

    pub(crate) fn text(&mut self, name: &str) -> Result<Option<String>, Failure> {
        self.read(name, text)
    }

    pub(crate) fn texts(&mut self, name: &str) -> Result<Option<Vec<String>>, Failure> {
        self.read(name, |path, value| match value {
            Value::Array(found) => list(path, found, text),
            other => Err(invalid(path, "a list of names", &other)),
        })
    }

    pub(crate) fn values(&mut self, name: &str) -> Result<Option<Values>, Failure> {
        self.read(name, values)
    }

    pub(crate) fn lists_of_values(&mut self, name: &str) -> Result<Vec<Values>, Failure> {
        let found = self.read(name, |path, value| match value {
            Value::Array(found) => list(path, found, values),
            other => Err(invalid(path, "a list of objects of joint coordinates", &other)),
        })?;
        Ok(found.unwrap_or_default())
    }

    /// One of several words, by their values.
    pub(crate) fn word<T: Copy>(
        &mut self,
        name: &str,
        words: &[(&str, T)],
    ) -> Result<Option<T>, Failure> {
        self.read(name, |path, value| {
            let found = words.iter().find(|(word, _)| value.as_str() == Some(*word));
            found.map(|(_, found)| *found).ok_or_else(|| {
                let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
                invalid(path, &format!("one of {}", known.join(", ")), &value)
            })
        })
    }

    /// An object with fields of its own, without any if it is missing.
    pub(crate) fn object(&mut self, name: &str, known: &[&str]) -> Result<Self, Failure> {
        let found = self.read(name, |path, value| match value {
            Value::Object(fields) => Ok(Self { path: format!("{path}."), fields }),
            other => Err(invalid(path, &format!("an object with {}", known.join(", ")), &other)),
        })?;
        found.unwrap_or_else(|| Self { path: String::new(), fields: Map::new() }).only(known)
    }
}

/// A field that the request has to have.
pub(crate) fn needed<T>(name: &str, found: Option<T>) -> Result<T, Failure> {
    found.ok_or_else(|| Failure::input(format!("request: `{name}` is missing")))
}

fn list<T>(
    path: &str,
    found: Vec<Value>,
    read: impl Fn(&str, Value) -> Result<T, Failure>,
) -> Result<Vec<T>, Failure> {
    found.into_iter().enumerate().map(|(k, value)| read(&format!("{path}[{k}]"), value)).collect()
}

fn number(path: &str, value: Value) -> Result<f64, Failure> {
    value.as_f64().ok_or_else(|| invalid(path, "a number", &value))
}

fn text(path: &str, value: Value) -> Result<String, Failure> {
    match value {
        Value::String(found) => Ok(found),
        other => Err(invalid(path, "a text", &other)),
    }
}

fn values(path: &str, value: Value) -> Result<Values, Failure> {
    let Value::Object(found) = value else {
        let allowed = "an object of joint coordinates (m, rad), such as {\"crank\": 0.5}";
        return Err(invalid(path, allowed, &value));
    };
    let of_name = |(name, value): (String, Value)| {
        let quoted: String = name.chars().take(MOST_QUOTED).collect();
        Ok((name, number(&format!("{path}.{quoted}"), value)?))
    };
    found.into_iter().map(of_name).collect()
}

/// A value in which no object has a name twice.
struct Unique(Value);

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;

        impl<'de> Visitor<'de> for Any {
            type Value = Value;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a value")
            }

            fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
                Ok(Value::from(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
                Ok(Value::from(value))
            }

            fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
                Ok(Value::from(value))
            }

            fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
                Ok(Value::from(value))
            }

            fn visit_str<E>(self, value: &str) -> Result<Value, E> {
                Ok(Value::from(value))
            }

            fn visit_unit<E>(self) -> Result<Value, E> {
                Ok(Value::Null)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
                let mut values = Vec::new();
                while let Some(Unique(value)) = list.next_element()? {
                    values.push(value);
                }
                Ok(Value::Array(values))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut object: A) -> Result<Value, A::Error> {
                let mut fields = Map::new();
                while let Some((name, Unique(value))) = object.next_entry::<String, Unique>()? {
                    if fields.contains_key(&name) {
                        let quoted: String = name.chars().take(MOST_QUOTED).collect();
                        return Err(A::Error::custom(format!("{quoted:?} is given twice")));
                    }
                    fields.insert(name, value);
                }
                Ok(Value::Object(fields))
            }
        }

        deserializer.deserialize_any(Any).map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused<T>(result: Result<T, Failure>) -> String {
        result.err().map(|failure| failure.text).unwrap_or_default()
    }

    /// Before, these were words of Rust without the field, such as "invalid type: boolean `true`, expected f64".
    #[test]
    fn errors_name_the_field_what_it_is_and_what_is_allowed() {
        let read = |text: &str| {
            let mut fields = Fields::of_request(text)?;
            let kind = fields.kind(&["forward", "move"])?;
            let mut fields =
                fields.only(&["rods_m", "at", "steps", "poses", "rank", "stiffness"])?;
            fields.three("rods_m")?;
            fields.values("at")?;
            fields.whole("steps")?;
            fields.truth("poses")?;
            fields.word("rank", &[("norm", 0), ("largest", 1)])?;
            let mut stiffness = fields.object("stiffness", &["linear", "angular"])?;
            stiffness.number("linear")?;
            Ok::<_, Failure>(kind)
        };
        let long = "x".repeat(100_000);
        for (text, message) in [
            ("[]", "request: has to be an object, such as {\"kind\": \"mobility\"}"),
            ("{", "request: not valid JSON: EOF while parsing an object at line 1 column 1"),
            (
                r#"{"kind": "move", "at": {"A": 1, "A": 2}}"#,
                "request: not valid JSON: \"A\" is given twice at line 1 column ",
            ),
            ("{}", "request: `kind` is missing; known: forward, move"),
            (r#"{"kind": 3}"#, "request: `kind` has to be one of forward, move, but is 3"),
            (
                r#"{"kind": "mov"}"#,
                "request: `kind` has to be one of forward, move, but is \"mov\"",
            ),
            (
                r#"{"kind": "move", "step": 3}"#,
                "request: `step` is not known (did you mean `steps`?); known: rods_m, at, steps, poses, rank, stiffness",
            ),
            (
                r#"{"kind": "forward", "rods_m": [0.5, true, 0.5]}"#,
                "request: `rods_m[1]` has to be a number, but is true",
            ),
            (
                r#"{"kind": "forward", "rods_m": [0.5]}"#,
                "request: `rods_m` has to be a list of 3 numbers, but is a list of 1",
            ),
            (
                r#"{"kind": "move", "at": {"A": "1"}}"#,
                "request: `at.A` has to be a number, but is \"1\"",
            ),
            (
                r#"{"kind": "move", "at": [1]}"#,
                "request: `at` has to be an object of joint coordinates (m, rad), such as {\"crank\": 0.5}, but is a list",
            ),
            (
                r#"{"kind": "move", "steps": 1.5}"#,
                "request: `steps` has to be a whole number from 0, but is 1.5",
            ),
            (
                r#"{"kind": "move", "poses": {}}"#,
                "request: `poses` has to be true or false, but is an object",
            ),
            (
                r#"{"kind": "move", "rank": "small"}"#,
                "request: `rank` has to be one of norm, largest, but is \"small\"",
            ),
            (
                r#"{"kind": "move", "stiffness": {"linear": "1"}}"#,
                "request: `stiffness.linear` has to be a number, but is \"1\"",
            ),
            (
                r#"{"kind": "move", "stiffness": {"liner": 1}}"#,
                "request: `stiffness.liner` is not known (did you mean `linear`?); known: linear, angular",
            ),
        ] {
            let found = refused(read(text));
            assert!(found.starts_with(message), "{text}: {found}");
        }
        assert_eq!(read(r#"{"kind": "move", "at": null, "stiffness": {}}"#).ok(), Some("move"));
        let refused = refused(read(&format!("{{\"kind\": \"{long}\"}}")));
        assert!(refused.chars().count() < 200, "{refused}");
    }
}
