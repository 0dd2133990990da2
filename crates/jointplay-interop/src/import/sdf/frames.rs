//! Frames by name: their poses and the links to which they belong.

use std::collections::BTreeMap;

use jointplay_core::mechanism::MechanismError;
use jointplay_core::spatial::Pose;
use roxmltree::Node;

use super::pose::pose;
use crate::import::problem::{Error, Problem};
use crate::import::xml::{LONGEST_NAME, Value, Xml, attribute, child, elements, place};

/// The frame of the world.
pub(super) const WORLD: usize = 0;

/// First version in which links and joints of one model must have different names.
const UNIQUE_NAMES: (u32, u32) = (1, 7);

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    World,
    Model,
    Link { is_static: bool },
    Joint,
    Frame,
}

struct Frame<'a> {
    kind: Kind,
    /// Name, including those of the models around the frame.
    name: String,
    /// Element of the frame; `None` for the world.
    node: Option<Node<'a, 'a>>,
    /// The model or world around the frame.
    scope: usize,
    relative_to: usize,
    /// Pose as written (m).
    pose: Pose,
    /// For a model: the frame inside it whose pose is given instead.
    placed_by: Option<usize>,
    /// The frame to which this one is attached; for a link, itself.
    attached_to: usize,
    /// Pose in the world (m).
    world_from: Pose,
    /// The link, or the world, with which the frame moves; `None` for circular attachments.
    link: Option<usize>,
}

pub(super) struct Frames<'a> {
    xml: Xml<'a>,
    version: (u32, u32),
    frames: Vec<Frame<'a>>,
    by_name: BTreeMap<String, usize>,
}

impl<'a> Frames<'a> {
    /// Whether axes are in the frame of the model unless they state otherwise, as before version 1.5.
    pub(super) fn axes_are_in_model(&self) -> bool {
        self.version < (1, 5)
    }

    pub(super) fn new(xml: Xml<'a>, version: (u32, u32)) -> Self {
        let world = Frame {
            kind: Kind::World,
            name: String::new(),
            node: None,
            scope: WORLD,
            relative_to: WORLD,
            pose: Pose::identity(),
            placed_by: None,
            attached_to: WORLD,
            world_from: Pose::identity(),
            link: Some(WORLD),
        };
        Self { xml, version, frames: vec![world], by_name: BTreeMap::new() }
    }

    /// Enters a frame with its name.
    pub(super) fn add(
        &mut self,
        scope: usize,
        kind: Kind,
        node: Node<'a, 'a>,
    ) -> Result<usize, Error> {
        let name = self.full_name(scope, self.xml.needed_name(node)?);
        if name.len() > LONGEST_NAME {
            let value = attribute(node, "name").expect("it was just read");
            let expected = "at most 1000 bytes long, together with those of the models around it";
            return Err(self.xml.unusable(&value, expected));
        }
        let index = self.frames.len();
        if self.by_name.contains_key(&name) {
            if kind != Kind::Joint || self.version >= UNIQUE_NAMES {
                return Err(self.xml.error(place(node), MechanismError::NameTwice { name }));
            }
        } else {
            self.by_name.insert(name.clone(), index);
        }
        self.frames.push(Frame {
            kind,
            name,
            node: Some(node),
            scope,
            relative_to: scope,
            pose: pose(self.xml, node)?,
            placed_by: None,
            attached_to: index,
            world_from: Pose::identity(),
            link: None,
        });
        Ok(index)
    }

    pub(super) fn len(&self) -> usize {
        self.frames.len()
    }

    pub(super) fn node(&self, frame: usize) -> Node<'a, 'a> {
        self.frames[frame].node.expect("only the world has no element")
    }

    /// Name of a frame, including those of the models around it.
    pub(super) fn name(&self, frame: usize) -> &str {
        &self.frames[frame].name
    }

    pub(super) fn scope(&self, frame: usize) -> usize {
        self.frames[frame].scope
    }

    /// Pose in the world, in the reference configuration (m).
    pub(super) fn world_from(&self, frame: usize) -> Pose {
        self.frames[frame].world_from
    }

    pub(super) fn links(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|&frame| matches!(self.frames[frame].kind, Kind::Link { .. }))
    }

    /// Frames with an element `<frame>`.
    pub(super) fn explicit(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|&frame| self.frames[frame].kind == Kind::Frame)
    }

    pub(super) fn is_static(&self, frame: usize) -> bool {
        self.frames[frame].kind == Kind::Link { is_static: true }
    }

    /// The canonical link of the first model.
    pub(super) fn canonical_link(&self) -> Option<usize> {
        let model = self.frames.iter().position(|frame| frame.kind == Kind::Model)?;
        self.link_of(model).ok().filter(|&link| link != WORLD)
    }

    /// The link, or the world, at an end of a joint.
    pub(super) fn end(&self, joint: usize, end: &'static str) -> Result<usize, Error> {
        let frame = self.end_frame(joint, end)?;
        self.link_of(frame)
    }

    fn end_frame(&self, joint: usize, end: &'static str) -> Result<usize, Error> {
        let node = self.node(joint);
        let value = child(node, end).ok_or_else(|| self.xml.missing(node, end))?;
        if value.text == "world" {
            return Ok(WORLD);
        }
        self.find(self.frames[joint].scope, &value)
    }

    /// The frame that an attribute names; `None` for an absent or empty attribute.
    pub(super) fn named(
        &self,
        scope: usize,
        node: Node<'a, 'a>,
        name: &str,
    ) -> Result<Option<usize>, Error> {
        let value = attribute(node, name).filter(|value| !value.text.is_empty());
        value.map(|value| self.find(scope, &value)).transpose()
    }

    /// The frame with a name, as seen from a scope.
    pub(super) fn find(&self, scope: usize, value: &Value<'a>) -> Result<usize, Error> {
        if value.text == "__model__" && scope != WORLD || value.text == "world" && scope == WORLD {
            return Ok(scope);
        }
        if let Some(model) = value.text.strip_suffix("::__model__") {
            let found = self.by_name.get(&self.full_name(scope, model)).copied();
            if let Some(model) = found.filter(|&found| self.frames[found].kind == Kind::Model) {
                return Ok(model);
            }
        }
        let found = self.by_name.get(&self.full_name(scope, value.text)).copied();
        found.ok_or_else(|| {
            let prefix = self.full_name(scope, "");
            let known = self.by_name.keys().filter_map(|name| name.strip_prefix(&prefix));
            self.xml.unknown("frame", value, known)
        })
    }

    fn full_name(&self, scope: usize, name: &str) -> String {
        match self.frames[scope].kind {
            Kind::World => name.to_owned(),
            _ => format!("{}::{name}", self.frames[scope].name),
        }
    }

    /// Resolves all references between frames, after all frames are entered.
    pub(super) fn resolve(&mut self) -> Result<(), Error> {
        let mut first_inside = vec![None; self.len()];
        for index in (1..self.len()).rev() {
            if matches!(self.frames[index].kind, Kind::Link { .. }) {
                first_inside[self.frames[index].scope] = Some(index);
            }
        }
        for index in (1..self.len()).rev() {
            let Frame { kind, scope, .. } = self.frames[index];
            if kind == Kind::Model && first_inside[scope].is_none() {
                first_inside[scope] = Some(index);
            }
        }
        for (index, first) in first_inside.into_iter().enumerate().skip(1) {
            let (node, scope) = (self.node(index), self.frames[index].scope);
            let (attached_to, default_parent) = match self.frames[index].kind {
                Kind::World | Kind::Link { .. } => (index, scope),
                Kind::Joint => {
                    let child = self.end_frame(index, "child")?;
                    (child, child)
                }
                Kind::Frame => {
                    let attached_to = self.named(scope, node, "attached_to")?.unwrap_or(scope);
                    (attached_to, attached_to)
                }
                Kind::Model => {
                    let canonical = self.named(index, node, "canonical_link")?;
                    self.frames[index].placed_by = self.named(index, node, "placement_frame")?;
                    (canonical.or(first).unwrap_or(index), scope)
                }
            };
            let pose = elements(node, "pose").next();
            let relative_to =
                pose.map(|pose| self.named(scope, pose, "relative_to")).transpose()?.flatten();
            self.frames[index].attached_to = attached_to;
            self.frames[index].relative_to = relative_to.unwrap_or(default_parent);
        }
        self.attach_all();
        self.place_all()
    }

    fn place_all(&mut self) -> Result<(), Error> {
        let mut locals = vec![None; self.len()];
        let mut is_placed = vec![false; self.len()];
        is_placed[WORLD] = true;
        for index in 1..self.len() {
            let (mut path, mut frame) = (Vec::new(), index);
            while !is_placed[frame] {
                if path.len() > self.len() {
                    return Err(self.circle("the pose of", index));
                }
                path.push(frame);
                frame = self.frames[frame].relative_to;
            }
            while let Some(next) = path.pop() {
                let local = self.local(next, &mut locals)?;
                let around = self.frames[next].relative_to;
                self.frames[next].world_from = self.frames[around].world_from * local;
                is_placed[next] = true;
            }
        }
        Ok(())
    }

    /// Pose of a frame in the frame to which it is relative (m).
    fn local(&self, frame: usize, locals: &mut [Option<Pose>]) -> Result<Pose, Error> {
        if let Some(known) = locals[frame] {
            return Ok(known);
        }
        let mut local = self.frames[frame].pose;
        if let Some(inner) = self.frames[frame].placed_by {
            let (mut model_from_inner, mut at) = (Pose::identity(), inner);
            let mut steps = 0;
            while at != frame {
                steps += 1;
                if at == WORLD || steps > self.len() {
                    return Err(self.circle("the pose of", frame));
                }
                model_from_inner = self.local(at, locals)? * model_from_inner;
                at = self.frames[at].relative_to;
            }
            local *= model_from_inner.inverse();
        }
        locals[frame] = Some(local);
        Ok(local)
    }

    /// The link, or the world, with which a frame moves.
    pub(super) fn link_of(&self, frame: usize) -> Result<usize, Error> {
        self.frames[frame].link.ok_or_else(|| self.circle("the link of", frame))
    }

    fn attach_all(&mut self) {
        let mut is_seen = vec![false; self.len()];
        is_seen[WORLD] = true;
        for index in 1..self.len() {
            let (mut path, mut frame) = (Vec::new(), index);
            while !std::mem::replace(&mut is_seen[frame], true) {
                path.push(frame);
                if let Kind::Link { .. } = self.frames[frame].kind {
                    self.frames[frame].link = Some(frame);
                    break;
                }
                frame = self.frames[frame].attached_to;
            }
            // Frames in a circle have no link.
            let link = self.frames[frame].link;
            path.into_iter().for_each(|frame| self.frames[frame].link = link);
        }
    }

    fn circle(&self, what: &'static str, frame: usize) -> Error {
        let name = self.frames[frame].name.clone();
        self.xml.error(place(self.node(frame)), Problem::Circle { what, name })
    }
}
