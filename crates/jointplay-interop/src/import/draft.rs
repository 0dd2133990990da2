//! An incomplete mechanism: links and joints by name, ignored parts, and places in the model.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use jointplay_core::mechanism::{
    AttachedFrame, Coupling, Joint, JointCoordinate, JointKind, LinearAndAngular, Mechanism,
    MechanismError,
};
use jointplay_core::spatial::Pose;
use roxmltree::Node;

use super::model::{Dialect, Imported};
use super::problem::{Error, Problem};
use super::starts::start;
use super::xml::{Value, Xml, place};

pub(super) struct Draft<'a> {
    pub(super) xml: Xml<'a>,
    root: Range<usize>,
    links: Named,
    joints: Named,
    pub(super) descriptions: Vec<Joint>,
    couplings: Vec<(Coupling, Range<usize>)>,
    frames: Vec<AttachedFrame>,
    frame_names: BTreeSet<String>,
    /// Names of constraints in the model.
    constraints: BTreeSet<String>,
    /// Names in the model, which generated names avoid.
    taken: BTreeSet<&'a str>,
    ignored: BTreeMap<String, usize>,
    remarks: Vec<String>,
}

/// Names with their indices and places.
#[derive(Default)]
struct Named {
    names: Vec<String>,
    numbers: BTreeMap<String, usize>,
    places: Vec<Range<usize>>,
}

impl Named {
    fn add(&mut self, name: String, place: Range<usize>) -> Result<usize, MechanismError> {
        let number = self.names.len();
        if self.numbers.contains_key(&name) {
            return Err(MechanismError::NameTwice { name });
        }
        self.numbers.insert(name.clone(), number);
        self.names.push(name);
        self.places.push(place);
        Ok(number)
    }

    fn place(&self, name: &str) -> Option<Range<usize>> {
        self.numbers.get(name).map(|&number| self.places[number].clone())
    }
}

impl<'a> Draft<'a> {
    pub(super) fn new(xml: Xml<'a>, root: Node<'a, 'a>) -> Self {
        Self {
            xml,
            root: place(root),
            links: Named::default(),
            joints: Named::default(),
            descriptions: Vec::new(),
            couplings: Vec::new(),
            frames: Vec::new(),
            frame_names: BTreeSet::new(),
            constraints: BTreeSet::new(),
            taken: root.descendants().filter_map(|node| node.attribute("name")).collect(),
            ignored: BTreeMap::new(),
            remarks: Vec::new(),
        }
    }

    /// Adds a link; the first is the base.
    pub(super) fn add_link(
        &mut self,
        name: impl Into<String>,
        place: Range<usize>,
    ) -> Result<usize, Error> {
        let added = self.links.add(name.into(), place.clone());
        added.map_err(|error| self.xml.error(place, error))
    }

    pub(super) fn link(&self, name: &str) -> Option<usize> {
        self.links.numbers.get(name).copied()
    }

    /// Number of links so far.
    pub(super) fn links(&self) -> usize {
        self.links.names.len()
    }

    pub(super) fn link_name(&self, link: usize) -> &str {
        &self.links.names[link]
    }

    pub(super) fn link_place(&self, link: usize) -> Range<usize> {
        self.links.places[link].clone()
    }

    pub(super) fn link_names(&self) -> impl Iterator<Item = &str> + Clone {
        self.links.names.iter().map(String::as_str)
    }

    pub(super) fn add_joint(&mut self, joint: Joint, place: Range<usize>) -> Result<(), Error> {
        let added = self.joints.add(joint.name.clone(), place.clone());
        added.map_err(|error| self.xml.error(place, error))?;
        self.descriptions.push(joint);
        Ok(())
    }

    /// Adds a coupling.
    pub(super) fn add_coupling(&mut self, coupling: Coupling, place: Range<usize>) {
        self.couplings.push((coupling, place));
    }

    /// Adds a frame that moves with a link; with a number, and a remark, if a link has its name.
    pub(super) fn add_frame(
        &mut self,
        name: &str,
        place: Range<usize>,
        link: usize,
        link_from_frame: Pose,
    ) -> Result<(), Error> {
        let mut own = name.to_owned();
        if self.link(name).is_some() {
            own = self.fresh(own);
            self.remark(format!("frame {name:?} is called {own:?}: a link has its name"));
        }
        if !self.frame_names.insert(own.clone()) {
            return Err(self.xml.error(place, MechanismError::NameTwice { name: own }));
        }
        self.frames.push(AttachedFrame { name: own, link, link_from_frame });
        Ok(())
    }

    fn is_frame(&self, name: &str) -> bool {
        self.frame_names.contains(name)
    }

    /// Number of couplings so far.
    pub(super) fn couplings(&self) -> usize {
        self.couplings.len()
    }

    /// Whether a coupling has this name.
    pub(super) fn is_coupling(&self, name: &str) -> bool {
        self.couplings.iter().any(|(coupling, _)| coupling.name == name)
    }

    /// The coordinate of a joint, which has to have one.
    pub(super) fn coordinate(&self, joint: &Value) -> Result<JointCoordinate, Error> {
        let number = self.joint(joint.text);
        let number = number.ok_or_else(|| self.xml.unknown("joint", joint, self.joint_names()))?;
        match self.descriptions[number].kind.freedoms() {
            1 => Ok(JointCoordinate { joint: number, freedom: 0 }),
            _ => Err(self.xml.unusable(joint, "a joint with one coordinate")),
        }
    }

    pub(super) fn joint(&self, name: &str) -> Option<usize> {
        self.joints.numbers.get(name).copied()
    }

    pub(super) fn joint_names(&self) -> impl Iterator<Item = &str> + Clone {
        self.joints.names.iter().map(String::as_str)
    }

    /// A generated name: this one, with a number if the model already has it.
    pub(super) fn fresh(&self, name: String) -> String {
        let is_free = |name: &str| {
            !(self.taken.contains(name) || self.is_coupling(name) || self.is_frame(name))
                && self.link(name).is_none()
                && self.joint(name).is_none()
        };
        if is_free(&name) {
            return name;
        }
        let numbered = (2..).map(|number| format!("{name} ({number})"));
        numbered.into_iter().find(|name| is_free(name)).expect("names are finitely many")
    }

    /// The name for a constraint that has one in the model: with a number, and a remark, if a joint has the same.
    pub(super) fn constraint_name(
        &mut self,
        name: &str,
        place: Range<usize>,
    ) -> Result<String, Error> {
        if !self.constraints.insert(name.to_owned()) {
            return Err(self.xml.error(place, MechanismError::NameTwice { name: name.to_owned() }));
        }
        if self.joint(name).is_none() && !self.is_coupling(name) {
            return Ok(name.to_owned());
        }
        let fresh = self.fresh(name.to_owned());
        self.remark(format!("constraint {name:?} is called {fresh:?}: a joint has its name"));
        Ok(fresh)
    }

    pub(super) fn ignore(&mut self, what: impl Into<String>) {
        *self.ignored.entry(what.into()).or_default() += 1;
    }

    /// Adds a remark to the list of ignored parts.
    pub(super) fn remark(&mut self, what: String) {
        self.remarks.push(what);
    }

    /// Adds the attributes of an element that are not used to the ignored parts.
    pub(super) fn ignore_attributes(&mut self, node: Node, used: &[&str]) {
        for attribute in node.attributes().filter(|found| !used.contains(&found.name())) {
            self.ignore(format!("{} of {}", attribute.name(), node.tag_name().name()));
        }
    }

    /// The mechanism, or an error with its place.
    pub(super) fn finish(self, name: &str, dialect: Dialect) -> Result<Imported, Error> {
        let Self { xml, root, links, joints, mut descriptions, frames, ignored, .. } = self;
        let mut remarks = self.remarks;
        let (couplings, places): (Vec<_>, Vec<_>) = self.couplings.into_iter().unzip();
        remarks.extend(start(&mut descriptions, &couplings));
        let names: Vec<String> = couplings.iter().map(|one| one.name.clone()).collect();
        let place_of = |coupling: &String| {
            let number = names.iter().position(|name| name == coupling)?;
            Some(places[number].clone())
        };
        let mechanism = Mechanism::new(name, links.names.clone(), descriptions)
            .and_then(|mechanism| mechanism.with_couplings(couplings)?.with_frames(frames));
        let mechanism = mechanism.map_err(|error| {
            use MechanismError as E;
            let found = match &error {
                E::Dangling { link, .. } => links.place(link),
                E::CoupledRotation { coupling, .. }
                | E::CoupledTwice { coupling, .. }
                | E::CoupledMany { coupling, .. } => place_of(coupling),
                E::NameTwice { name } => place_of(name),
                E::JoinedToItself { joint: name, .. }
                | E::NotFinite { name, .. }
                | E::LimitsReversed { name, .. } => joints.place(name),
                _ => None,
            };
            xml.error(found.unwrap_or_else(|| root.clone()), error)
        })?;
        remarks.extend(ignored.into_iter().map(|(what, count)| format!("{count} × {what}")));
        let imported = Imported { mechanism, dialect, ignored: remarks };
        imported.check_numbers().map_err(|problem| {
            let found = match &problem {
                Problem::TooLarge { whose, .. } => joints.place(whose).or_else(|| place_of(whose)),
                _ => None,
            };
            xml.error(found.unwrap_or(root), problem)
        })?;
        Ok(imported)
    }
}

/// A joint with a kind, links and frames only.
pub(super) fn bare(name: String, kind: JointKind, links: [usize; 2], frames: [Pose; 2]) -> Joint {
    Joint {
        name,
        kind,
        links,
        frames,
        actuated: false,
        guess: Vec::new(),
        limits: Vec::new(),
        clearance: LinearAndAngular::default(),
        stiffness: LinearAndAngular::default(),
    }
}
