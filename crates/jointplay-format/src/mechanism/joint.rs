//! Joints and virtual joints from their tables.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use jointplay_core::mechanism::{
    Carrier, Joint, JointKind, LinearAndAngular, Mechanism, VirtualJoint, VirtualMotion,
};
use toml::Spanned;

use super::file::{JointTable, Number, OneOrMany, PlayTable, VirtualJointTable};
use super::frame;
use super::names::{joint_name, printable_name};
use super::problem::{Error, Problem};
use super::values::{Values, choice, unknown};

const KINDS: [(&str, JointKind); 9] = [
    ("revolute", JointKind::Revolute),
    ("prismatic", JointKind::Prismatic),
    ("helical", JointKind::Helical { lead: 0.0 }),
    ("cylindrical", JointKind::Cylindrical),
    ("universal", JointKind::Universal),
    ("spherical", JointKind::Spherical),
    ("planar", JointKind::Planar),
    ("fixed", JointKind::Fixed),
    ("floating", JointKind::Floating),
];

/// Links in order of first mention, by name.
#[derive(Default)]
pub(super) struct Links {
    pub(super) names: Vec<String>,
    indices: BTreeMap<String, usize>,
}

impl Links {
    /// Links that are there already, in this order.
    pub(super) fn of(names: &[String]) -> Self {
        let mut links = Self::default();
        names.iter().for_each(|name| {
            links.index(name);
        });
        links
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.indices.contains_key(name)
    }

    pub(super) fn index(&mut self, name: &str) -> usize {
        if let Some(&index) = self.indices.get(name) {
            return index;
        }
        self.indices.insert(name.to_owned(), self.names.len());
        self.names.push(name.to_owned());
        self.names.len() - 1
    }
}

/// A joint from its table; counts its links in.
pub(super) fn joint(
    values: &Values,
    table: &JointTable,
    links: &mut Links,
) -> Result<Joint, Error> {
    let name = joint_name(values.text, &table.name)?;
    let [first, second] = table.links.get_ref().as_slice() else {
        let problem = Problem::Count {
            key: "links",
            found: table.links.get_ref().len(),
            needed: "2".to_owned(),
        };
        return Err(values.wrong(table.links.span(), problem));
    };
    let first = links.index(&printable_name(values.text, "links", first)?);
    let second = links.index(&printable_name(values.text, "links", second)?);
    let kind = kind(values, table)?;
    Ok(Joint {
        name,
        kind,
        links: [first, second],
        frames: frame::both(values, table, kind)?,
        actuated: table.actuated,
        guess: guess(values, table, kind)?,
        limits: limits(values, table, kind)?,
        clearance: play(values, &table.clearance, |v| values.length(v), |v| values.angle(v))?,
        stiffness: play(values, &table.stiffness, |v| v, |v| v)?,
    })
}

fn kind(values: &Values, table: &JointTable) -> Result<JointKind, Error> {
    let kind = choice(values.text, "kind of joint", &table.kind, &KINDS)?;
    match (kind, &table.lead) {
        (JointKind::Helical { .. }, Some(lead)) => {
            let lead = values.scalar("lead", lead, |lead| values.length(lead) / TAU)?;
            Ok(JointKind::Helical { lead })
        }
        (JointKind::Helical { .. }, None) => {
            let whose = format!("the helical joint {:?}", table.name.get_ref());
            Err(values.wrong(table.name.span(), Problem::Missing { whose, key: "lead" }))
        }
        (_, Some(lead)) => {
            let why = format!("only helical joints have it, this one is {}", kind.name());
            Err(values.wrong(lead.span(), Problem::Misplaced { key: "lead", why }))
        }
        (_, None) => Ok(kind),
    }
}

fn guess(values: &Values, table: &JointTable, kind: JointKind) -> Result<Vec<f64>, Error> {
    let Some(guess) = &table.guess else { return Ok(Vec::new()) };
    let numbers = numbers(guess);
    let coordinates = kind.coordinates();
    if numbers.len() != coordinates.len() {
        return Err(values.wrong(guess.span(), count("guess", numbers.len(), kind)));
    }
    let read = coordinates.iter().zip(numbers).map(|(&coordinate, (number, span))| {
        let value = values.number("guess", number, span.clone())?;
        values.within("guess", coordinate, value, span)
    });
    read.collect()
}

fn limits(values: &Values, table: &JointTable, kind: JointKind) -> Result<Vec<[f64; 2]>, Error> {
    let Some(limits) = &table.limits else { return Ok(Vec::new()) };
    let entries = limits.get_ref();
    let coordinates = kind.coordinates();
    let is_pair = |entry: &Spanned<OneOrMany>| matches!(entry.get_ref(), OneOrMany::Many(_));
    let pairs: Vec<_> = if entries.iter().any(is_pair) {
        entries.iter().map(|entry| (numbers(entry), entry.span())).collect()
    } else {
        vec![(entries.iter().flat_map(numbers).collect(), limits.span())]
    };
    if pairs.len() != coordinates.len() {
        return Err(values.wrong(limits.span(), count("limits", pairs.len(), kind)));
    }
    let read = coordinates.iter().zip(pairs).map(|(&coordinate, (pair, span))| {
        let [least, most] = pair.as_slice() else {
            let needed = "pairs of least and greatest".to_owned();
            let problem = Problem::Count { key: "limits", found: pair.len(), needed };
            return Err(values.wrong(span, problem));
        };
        let min = values.number("limits", least.0, least.1.clone())?;
        let max = values.number("limits", most.0, most.1.clone())?;
        if min < max {
            let within = |value, span| values.within("limits", coordinate, value, span);
            Ok([within(min, least.1.clone())?, within(max, most.1.clone())?])
        } else {
            Err(values.wrong(span, Problem::LimitsReversed { min, max }))
        }
    });
    read.collect()
}

/// The one or many numbers, with their places.
fn numbers(entry: &Spanned<OneOrMany>) -> Vec<(&Number, std::ops::Range<usize>)> {
    match entry.get_ref() {
        OneOrMany::One(number) => vec![(number, entry.span())],
        OneOrMany::Many(list) => list.iter().map(|n| (n.get_ref(), n.span())).collect(),
    }
}

/// That a list does not have an entry for each freedom.
fn count(key: &'static str, found: usize, kind: JointKind) -> Problem {
    let of_each = if key == "limits" { "pairs, one" } else { "numbers, one" };
    let needed =
        format!("{} {of_each} for each freedom of a {} joint", kind.freedoms(), kind.name());
    Problem::Count { key, found, needed }
}

fn play(
    values: &Values,
    table: &PlayTable,
    linear: impl Fn(f64) -> f64,
    angular: impl Fn(f64) -> f64,
) -> Result<LinearAndAngular, Error> {
    Ok(LinearAndAngular {
        linear: values.positive("linear", table.linear.as_ref(), linear)?,
        angular: values.positive("angular", table.angular.as_ref(), angular)?,
    })
}

/// A virtual joint from its table.
pub(super) fn virtual_joint(
    values: &Values,
    table: &VirtualJointTable,
    mechanism: &Mechanism,
    indices: &BTreeMap<&str, usize>,
) -> Result<VirtualJoint, Error> {
    let name = joint_name(values.text, &table.name)?;
    let wanted = table.joint.get_ref().as_str();
    let Some(&index) = indices.get(wanted) else {
        let names = mechanism.joints().iter().map(|joint| joint.name.as_str());
        return Err(values.wrong(table.joint.span(), unknown("joint", wanted, names)));
    };
    let joint = &mechanism.joints()[index];
    let carrier = match &table.on {
        None => Carrier::Second,
        Some(on) => {
            let names = joint.links.map(|link| mechanism.links()[link].as_str());
            let carriers = [(names[0], Carrier::First), (names[1], Carrier::Second)];
            choice(values.text, "link of this joint", on, &carriers)?
        }
    };
    let frame = &joint.frames[usize::from(carrier == Carrier::Second)];
    let motion = match (&table.slide, &table.turn) {
        (Some(slide), None) => {
            if let Some(about) = &table.about {
                let why = "only a `turn` has an axis to go through a point".to_owned();
                return Err(values.wrong(about.span(), Problem::Misplaced { key: "about", why }));
            }
            VirtualMotion::Slide(values.direction("slide", slide)?)
        }
        (None, Some(turn)) => VirtualMotion::Turn {
            axis: values.direction("turn", turn)?,
            point: match &table.about {
                Some(about) => values.point("about", about)?,
                None => frame.translation.vector,
            },
        },
        (Some(_), Some(turn)) => {
            let why =
                "a virtual joint has one freedom: state two, a `slide` and a `turn`".to_owned();
            return Err(values.wrong(turn.span(), Problem::Misplaced { key: "turn", why }));
        }
        (None, None) => {
            let whose = format!("the virtual joint {name:?}");
            let problem = Problem::Missing { whose, key: "slide` or `turn" };
            return Err(values.wrong(table.name.span(), problem));
        }
    };
    let clearance =
        values.positive("clearance", table.clearance.as_ref(), |value| match motion {
            VirtualMotion::Slide(_) => values.length(value),
            VirtualMotion::Turn { .. } => values.angle(value),
        })?;
    let stiffness = values.positive("stiffness", table.stiffness.as_ref(), |value| value)?;
    Ok(VirtualJoint { name, joint: index, carrier, motion, clearance, stiffness })
}
