//! Objects of a document of FreeCAD and their properties.

use std::collections::BTreeMap;

use jointplay_core::spatial::Pose;
use jointplay_format::mechanism::LengthUnit;
use nalgebra::{Translation3, Vector3};
use roxmltree::Node;

use crate::import::problem::{Error, Problem};
use crate::import::xml::{Advice, Value, Xml, attribute, children, elements, place};

/// Kind of an assembly.
pub(super) const ASSEMBLY: &str = "Assembly::AssemblyObject";
/// Kind of an assembly in another.
pub(super) const SUB_ASSEMBLY: &str = "Assembly::AssemblyLink";
/// The unit of lengths in every document.
pub(super) const UNIT: LengthUnit = LengthUnit::Millimeter;

/// Objects by their names, in the order of the file.
pub(super) struct Document<'a> {
    pub(super) xml: Xml<'a>,
    objects: BTreeMap<&'a str, Object<'a>>,
    order: Vec<&'a str>,
}

/// An object with its properties.
pub(super) struct Object<'a> {
    /// Name, unique in the document.
    pub(super) name: &'a str,
    /// Type, such as `App::Link`.
    pub(super) kind: &'a str,
    pub(super) node: Node<'a, 'a>,
    properties: BTreeMap<&'a str, Node<'a, 'a>>,
}

/// A link to a place in an object: the names of objects along the path, without those of faces and edges.
pub(super) struct Reference<'a> {
    /// File of the object; empty for the document itself.
    pub(super) file: &'a str,
    pub(super) object: &'a str,
    pub(super) path: Vec<&'a str>,
    /// Name of the face, edge or vertex; empty for the whole object.
    pub(super) element: &'a str,
    pub(super) node: Node<'a, 'a>,
}

impl<'a> Document<'a> {
    pub(super) fn new(xml: Xml<'a>, root: Node<'a, 'a>) -> Result<Self, Error> {
        let mut objects = BTreeMap::new();
        let mut order = Vec::new();
        let declared = elements(root, "Objects").flat_map(|all| elements(all, "Object"));
        for node in declared {
            let name = required(xml, node, "name")?.text;
            let kind = required(xml, node, "type")?.text;
            let object = Object { name, kind, node, properties: BTreeMap::new() };
            if objects.insert(name, object).is_some() {
                let what = format!("a second object {name:?}");
                return Err(xml.unsupported(node, what, Advice("names of objects are unique")));
            }
            order.push(name);
        }
        let data = elements(root, "ObjectData").flat_map(|all| elements(all, "Object"));
        for node in data {
            let name = required(xml, node, "name")?;
            let Some(object) = objects.get_mut(name.text) else {
                return Err(xml.unknown("object", &name, order.iter().copied()));
            };
            object.node = node;
            let properties = elements(node, "Properties").flat_map(children);
            object.properties = properties
                .filter(|property| property.tag_name().name() == "Property")
                .filter_map(|property| Some((property.attribute("name")?, property)))
                .collect();
        }
        Ok(Self { xml, objects, order })
    }

    pub(super) fn object(&self, name: &str) -> Option<&Object<'a>> {
        self.objects.get(name)
    }

    /// All objects, in the order of the file.
    pub(super) fn objects(&self) -> impl Iterator<Item = &Object<'a>> {
        self.order.iter().map(|name| &self.objects[name])
    }

    /// The object that a link names.
    pub(super) fn linked(&self, link: &Value<'a>) -> Result<&Object<'a>, Error> {
        let found = self.object(link.text);
        found.ok_or_else(|| self.xml.unknown("object", link, self.order.iter().copied()))
    }

    /// The objects in a group.
    pub(super) fn group(&self, object: &Object<'a>) -> Result<Vec<&Object<'a>>, Error> {
        let list = object.content("Group").filter(|list| list.tag_name().name() == "LinkList");
        let links = list.into_iter().flat_map(|list| elements(list, "Link"));
        links.map(|link| self.linked(&required(self.xml, link, "value")?)).collect()
    }

    /// The name that the user gave, or else the name in the file.
    pub(super) fn label(&self, object: &Object<'a>) -> Result<String, Error> {
        let Some(label) = object.value("Label").filter(|label| !label.text.is_empty()) else {
            return Ok(object.name.to_owned());
        };
        self.xml.printable(&label).map(str::to_owned)
    }

    /// A yes or no; no where the object does not have it.
    pub(super) fn flag(&self, object: &Object<'a>, name: &str) -> Result<Option<bool>, Error> {
        object.value(name).map(|value| self.xml.truth(&value)).transpose()
    }

    /// A number, in the unit of the file.
    pub(super) fn number(&self, object: &Object<'a>, name: &'static str) -> Result<f64, Error> {
        let missing = || self.missing(object, name);
        self.xml.number(&object.value(name).ok_or_else(missing)?)
    }

    /// The chosen name of an enumeration.
    ///
    /// # Arguments
    /// * `names` – names of those that have no list in the file
    pub(super) fn choice(
        &self,
        object: &Object<'a>,
        name: &'static str,
        names: &[&'a str],
    ) -> Result<&'a str, Error> {
        let value = object.value(name).ok_or_else(|| self.missing(object, name))?;
        let property = object.properties[name];
        let own: Vec<&'a str> = elements(property, "CustomEnumList")
            .flat_map(|list| elements(list, "Enum"))
            .filter_map(|one| one.attribute("value"))
            .collect();
        let names = if own.is_empty() { names } else { &own };
        let found = value.text.parse().ok().and_then(|number: usize| names.get(number).copied());
        found.ok_or_else(|| self.xml.unusable(&value, "the number of a choice, counted from 0"))
    }

    /// The pose of an object or of a frame in it (m); the identity where it has none.
    pub(super) fn placement(&self, object: &Object<'a>, name: &str) -> Result<Pose, Error> {
        let Some(node) = object.content(name) else { return Ok(Pose::identity()) };
        let number = |key| self.xml.number(&required(self.xml, node, key)?);
        let [x, y, z] = [number("Px")?, number("Py")?, number("Pz")?];
        let quaternion = [number("Q3")?, number("Q0")?, number("Q1")?, number("Q2")?];
        let rotation = self.xml.quaternion(&required(self.xml, node, "Q0")?, quaternion)?;
        let point = Vector3::new(x, y, z).map(|x| UNIT.to_meters(x));
        Ok(Pose::from_parts(Translation3::from(point), rotation))
    }

    /// The object that a property links to, without the place in it.
    pub(super) fn link(
        &self,
        object: &Object<'a>,
        name: &'static str,
    ) -> Result<Option<&Object<'a>>, Error> {
        let Some(node) = object.content(name) else { return Ok(None) };
        let value = attribute(node, "value").or_else(|| attribute(node, "name"));
        match value.filter(|value| !value.text.is_empty()) {
            Some(value) => self.linked(&value).map(Some),
            None => Ok(None),
        }
    }

    /// The place in an object that a property links to; `None` where it is empty or absent.
    pub(super) fn reference(
        &self,
        object: &Object<'a>,
        name: &str,
    ) -> Result<Option<Reference<'a>>, Error> {
        let Some(node) = object.content(name) else { return Ok(None) };
        let Some(linked) = attribute(node, "name").filter(|name| !name.text.is_empty()) else {
            return Ok(None);
        };
        let first = elements(node, "Sub").next().and_then(|sub| sub.attribute("value"));
        let place = node.attribute("sub").or(first).unwrap_or_default();
        // The last name is that of a face, an edge or a corner, or empty; generated names of those start with a semicolon.
        let mut path: Vec<&str> = place.split('.').collect();
        let element = path.pop().unwrap_or_default();
        path.retain(|name| !name.starts_with(';'));
        let file = node.attribute("file").unwrap_or_default();
        Ok(Some(Reference { file, object: linked.text, path, element, node }))
    }

    pub(super) fn missing(&self, object: &Object<'a>, what: &'static str) -> Error {
        let problem = Problem::Missing { whose: object.name.to_owned(), what };
        self.xml.error(place(object.node), problem)
    }
}

impl<'a> Object<'a> {
    pub(super) fn has(&self, name: &str) -> bool {
        self.properties.contains_key(name)
    }

    /// The element with the value of a property.
    fn content(&self, name: &str) -> Option<Node<'a, 'a>> {
        children(*self.properties.get(name)?).next()
    }

    /// The value of a property that has one.
    pub(super) fn value(&self, name: &str) -> Option<Value<'a>> {
        attribute(self.content(name)?, "value")
    }
}

fn required<'a>(xml: Xml<'a>, node: Node<'a, 'a>, name: &'static str) -> Result<Value<'a>, Error> {
    let found = attribute(node, name).filter(|value| !value.text.is_empty());
    found.ok_or_else(|| xml.missing(node, name))
}
