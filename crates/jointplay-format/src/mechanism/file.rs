//! The tables of a mechanism file, as TOML has them.

use std::collections::BTreeMap;
use std::fmt;

use serde::Deserialize;
use serde::de::{Deserializer, SeqAccess, Visitor, value::SeqAccessDeserializer};
use toml::Spanned;

/// A number, or an expression that stands for one.
#[derive(Debug, Clone)]
pub(super) enum Number {
    Value(f64),
    Expression(String),
}

/// A number, or a list of them.
pub(super) enum OneOrMany {
    One(Number),
    Many(Vec<Spanned<Number>>),
}

/// Numbers of a point or direction.
pub(super) type Numbers = Spanned<Vec<Spanned<Number>>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) kind: Spanned<String>,
    pub(super) name: Spanned<String>,
    pub(super) source: Option<Spanned<String>>,
    pub(super) units: UnitsTable,
    pub(super) base: Spanned<String>,
    pub(super) characteristic_length: Option<Spanned<Number>>,
    #[serde(default)]
    pub(super) parameters: BTreeMap<Spanned<String>, Spanned<Number>>,
    #[serde(default)]
    pub(super) expected: ExpectedTable,
    pub(super) joint: Vec<Spanned<JointTable>>,
    #[serde(default)]
    pub(super) virtual_joint: Vec<Spanned<VirtualJointTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct UnitsTable {
    pub(super) length: Spanned<String>,
    pub(super) angle: Spanned<String>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct ExpectedTable {
    pub(super) freedoms: Option<usize>,
    pub(super) rank: Option<usize>,
    pub(super) kutzbach: Option<i64>,
    pub(super) instantaneous: Option<usize>,
    pub(super) finite: Option<usize>,
    pub(super) redundancy: Option<usize>,
    pub(super) note: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct JointTable {
    pub(super) name: Spanned<String>,
    pub(super) kind: Spanned<String>,
    pub(super) links: Spanned<Vec<Spanned<String>>>,
    /// In which link's frame the joint is placed; of files of loops only.
    pub(super) r#in: Option<Spanned<String>>,
    pub(super) point: Option<Numbers>,
    pub(super) axis: Option<Numbers>,
    pub(super) zero: Option<Numbers>,
    pub(super) second_axis: Option<Numbers>,
    pub(super) frames: Option<Spanned<Vec<Spanned<FrameTable>>>>,
    pub(super) lead: Option<Spanned<Number>>,
    #[serde(default)]
    pub(super) actuated: bool,
    pub(super) limits: Option<Spanned<Vec<Spanned<OneOrMany>>>>,
    pub(super) guess: Option<Spanned<OneOrMany>>,
    #[serde(default)]
    pub(super) clearance: PlayTable,
    #[serde(default)]
    pub(super) stiffness: PlayTable,
}

/// A file of joints that close loops.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LoopsFile {
    pub(super) kind: Spanned<String>,
    pub(super) units: UnitsTable,
    #[serde(default)]
    pub(super) parameters: BTreeMap<Spanned<String>, Spanned<Number>>,
    pub(super) joint: Vec<Spanned<JointTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FrameTable {
    pub(super) point: Option<Numbers>,
    pub(super) axis: Option<Numbers>,
    pub(super) zero: Option<Numbers>,
    pub(super) second_axis: Option<Numbers>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct PlayTable {
    pub(super) linear: Option<Spanned<Number>>,
    pub(super) angular: Option<Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct VirtualJointTable {
    pub(super) name: Spanned<String>,
    pub(super) joint: Spanned<String>,
    pub(super) on: Option<Spanned<String>>,
    pub(super) slide: Option<Numbers>,
    pub(super) turn: Option<Numbers>,
    pub(super) about: Option<Numbers>,
    pub(super) clearance: Option<Spanned<Number>>,
    pub(super) stiffness: Option<Spanned<Number>>,
}

// By hand and not by `serde(untagged)`, whose messages say neither what is wrong nor where.
impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl Visitor<'_> for Either {
            type Value = Number;
            fn expecting(&self, to: &mut fmt::Formatter) -> fmt::Result {
                to.write_str("a number or an expression")
            }
            fn visit_i64<E>(self, value: i64) -> Result<Number, E> {
                Ok(Number::Value(value as f64))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Number, E> {
                Ok(Number::Value(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Number, E> {
                Ok(Number::Value(value))
            }
            fn visit_str<E>(self, text: &str) -> Result<Number, E> {
                Ok(Number::Expression(text.to_owned()))
            }
        }
        deserializer.deserialize_any(Either)
    }
}

impl<'de> Deserialize<'de> for OneOrMany {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = OneOrMany;
            fn expecting(&self, to: &mut fmt::Formatter) -> fmt::Result {
                to.write_str("a number, an expression, or a list of them")
            }
            fn visit_i64<E>(self, value: i64) -> Result<OneOrMany, E> {
                Ok(OneOrMany::One(Number::Value(value as f64)))
            }
            fn visit_u64<E>(self, value: u64) -> Result<OneOrMany, E> {
                Ok(OneOrMany::One(Number::Value(value as f64)))
            }
            fn visit_f64<E>(self, value: f64) -> Result<OneOrMany, E> {
                Ok(OneOrMany::One(Number::Value(value)))
            }
            fn visit_str<E>(self, text: &str) -> Result<OneOrMany, E> {
                Ok(OneOrMany::One(Number::Expression(text.to_owned())))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<OneOrMany, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(OneOrMany::Many)
            }
        }
        deserializer.deserialize_any(Either)
    }
}
