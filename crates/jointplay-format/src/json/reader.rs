//! A value of JSON as the types of requests.

use serde::de::value::StringDeserializer;
use serde::de::{DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, SeqAccess, Visitor};
use serde::forward_to_deserialize_any;
use serde_json::{Map, Value, map};

use super::error::{Allowed, Found, JsonError, Problem};

/// A value that is checked against the type it is read as, before that type sees it.
pub(super) struct Reader(pub(super) Value);

fn mismatch(allowed: Allowed, value: &Value) -> JsonError {
    Problem::Type { allowed, found: Found::of(value) }.at("")
}

impl Reader {
    fn list<'de, V: Visitor<'de>>(found: Vec<Value>, visitor: V) -> Result<V::Value, JsonError> {
        visitor.visit_seq(List { rest: found.into_iter(), next: 0 })
    }

    fn object<'de, V: Visitor<'de>>(
        found: Map<String, Value>,
        visitor: V,
    ) -> Result<V::Value, JsonError> {
        visitor.visit_map(Object { rest: found.into_iter(), value: None })
    }
}

/// Methods that read a whole number within the range of its type.
macro_rules! whole_numbers {
    ($($method:ident $visit:ident $type:ty,)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
            let (min, max) = (<$type>::MIN.into(), <$type>::MAX.into());
            let found = self.0.as_number().and_then(serde_json::Number::as_i128);
            match found.and_then(|found| <$type>::try_from(found).ok()) {
                Some(found) => visitor.$visit(found),
                None => Err(mismatch(Allowed::WholeNumber { min, max }, &self.0)),
            }
        }
    )*};
}

impl<'de> Deserializer<'de> for Reader {
    type Error = JsonError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        match self.0 {
            Value::Null => visitor.visit_unit(),
            Value::Bool(found) => visitor.visit_bool(found),
            Value::Number(found) => match (found.as_u64(), found.as_i64(), found.as_f64()) {
                (Some(found), _, _) => visitor.visit_u64(found),
                (None, Some(found), _) => visitor.visit_i64(found),
                (None, None, Some(found)) => visitor.visit_f64(found),
                (None, None, None) => Err(mismatch(Allowed::Number, &Value::Number(found))),
            },
            Value::String(found) => visitor.visit_string(found),
            Value::Array(found) => Self::list(found, visitor),
            Value::Object(found) => Self::object(found, visitor),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        match self.0 {
            Value::Bool(found) => visitor.visit_bool(found),
            other => Err(mismatch(Allowed::Truth, &other)),
        }
    }

    whole_numbers! {
        deserialize_i8 visit_i8 i8,
        deserialize_i16 visit_i16 i16,
        deserialize_i32 visit_i32 i32,
        deserialize_i64 visit_i64 i64,
        deserialize_u8 visit_u8 u8,
        deserialize_u16 visit_u16 u16,
        deserialize_u32 visit_u32 u32,
        deserialize_u64 visit_u64 u64,
    }

    fn deserialize_f32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        self.deserialize_f64(visitor)
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        match self.0.as_f64() {
            Some(found) => visitor.visit_f64(found),
            None => Err(mismatch(Allowed::Number, &self.0)),
        }
    }

    fn deserialize_str<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        match self.0 {
            Value::String(found) => visitor.visit_string(found),
            other => Err(mismatch(Allowed::Text, &other)),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        self.deserialize_str(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        match self.0 {
            Value::Null => visitor.visit_none(),
            found => visitor.visit_some(Self(found)),
        }
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        match self.0 {
            Value::Null => visitor.visit_unit(),
            other => Err(mismatch(Allowed::Null, &other)),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, JsonError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        match self.0 {
            Value::Array(found) => Self::list(found, visitor),
            other => Err(mismatch(Allowed::List, &other)),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        allowed: usize,
        visitor: V,
    ) -> Result<V::Value, JsonError> {
        match &self.0 {
            Value::Array(found) if found.len() != allowed => {
                Err(Problem::Length { allowed, found: found.len() }.at(""))
            }
            _ => self.deserialize_seq(visitor),
        }
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, JsonError> {
        self.deserialize_tuple(length, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, JsonError> {
        match self.0 {
            Value::Object(found) => Self::object(found, visitor),
            other => Err(mismatch(Allowed::Object, &other)),
        }
    }

    // serde would also read a list as the fields in their order.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, JsonError> {
        self.deserialize_map(visitor)
    }

    // Requests choose the variants with content by a field `kind`; see `super::kind`.
    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        variants: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, JsonError> {
        match self.0 {
            Value::String(found) if variants.contains(&found.as_str()) => {
                let found: StringDeserializer<JsonError> = found.into_deserializer();
                visitor.visit_enum(found)
            }
            other => Err(mismatch(Allowed::OneOf(variants), &other)),
        }
    }

    forward_to_deserialize_any! {
        char bytes byte_buf unit_struct identifier ignored_any
    }
}

/// The elements of a list.
struct List {
    rest: std::vec::IntoIter<Value>,
    /// Index of the next one.
    next: usize,
}

impl<'de> SeqAccess<'de> for List {
    type Error = JsonError;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, JsonError> {
        let Some(value) = self.rest.next() else { return Ok(None) };
        let k = self.next;
        self.next += 1;
        seed.deserialize(Reader(value)).map(Some).map_err(|error| error.within(&format!("[{k}]")))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

/// The fields of an object.
struct Object {
    rest: map::IntoIter,
    /// The field whose name was read last.
    value: Option<(String, Value)>,
}

impl<'de> MapAccess<'de> for Object {
    type Error = JsonError;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, JsonError> {
        let Some((name, value)) = self.rest.next() else { return Ok(None) };
        self.value = Some((name.clone(), value));
        let name: StringDeserializer<JsonError> = name.into_deserializer();
        seed.deserialize(name).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, JsonError> {
        let (name, value) = self.value.take().expect("a value is read after its name");
        seed.deserialize(Reader(value)).map_err(|error| error.within(&name))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}
