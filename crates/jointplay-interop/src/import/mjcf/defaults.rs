//! Default classes: values of attributes that are absent in elements.

use std::collections::BTreeMap;

use roxmltree::Node;

use super::placing::PLACING;
use crate::import::draft::Draft;
use crate::import::problem::Error;
use crate::import::xml::{Value, Xml, attribute, children, elements};

/// The class from which all others inherit.
const MAIN: &str = "main";

/// Values by element and attribute.
type Class<'a> = BTreeMap<(&'a str, &'static str), Value<'a>>;

/// All classes by name.
#[derive(Default)]
pub(super) struct Defaults<'a> {
    classes: BTreeMap<&'a str, Class<'a>>,
}

impl<'a> Defaults<'a> {
    /// Reads a section at the top level; several sections are merged.
    pub(super) fn section(
        &mut self,
        draft: &mut Draft<'a>,
        section: Node<'a, 'a>,
    ) -> Result<(), Error> {
        if let Some(class) = attribute(section, "class").filter(|class| class.text != MAIN) {
            return Err(draft
                .xml
                .unusable(&class, "main, as the outermost class is always called"));
        }
        let before = self.classes.get(MAIN).cloned().unwrap_or_default();
        let mut open = vec![(section, MAIN, before)];
        while let Some((node, name, parent)) = open.pop() {
            let class = own(draft, node, parent);
            for nested in elements(node, "default") {
                let Some(value) = attribute(nested, "class") else {
                    return Err(draft.xml.missing(nested, "class"));
                };
                let name = draft.xml.printable(&value)?;
                if name == MAIN || self.classes.contains_key(name) {
                    return Err(draft.xml.unusable(&value, "a name that no other class has"));
                }
                // Entered at once, so that a second class of this name is detected.
                self.classes.insert(name, Class::new());
                open.push((nested, name, class.clone()));
            }
            self.classes.insert(name, class);
        }
        Ok(())
    }

    /// The name of an existing class.
    pub(super) fn known(&self, xml: Xml<'a>, class: &Value<'a>) -> Result<&'a str, Error> {
        if class.text == MAIN || self.classes.contains_key(class.text) {
            Ok(class.text)
        } else {
            Err(xml.unknown("default class", class, self.classes.keys().copied()))
        }
    }

    /// The class of an element: its own, or else that of the bodies and frames around it.
    pub(super) fn class_of(
        &self,
        xml: Xml<'a>,
        node: Node<'a, 'a>,
        around: Option<&'a str>,
    ) -> Result<&'a str, Error> {
        match attribute(node, "class") {
            Some(class) => self.known(xml, &class),
            None => Ok(around.unwrap_or(MAIN)),
        }
    }

    /// The value of an attribute in a class.
    pub(super) fn attribute_value(
        &self,
        class: &str,
        element: &str,
        attribute: &'static str,
    ) -> Option<Value<'a>> {
        self.classes.get(class)?.get(&(element, attribute)).cloned()
    }
}

/// A class: its own values over those of its parent.
fn own<'a>(draft: &mut Draft<'a>, node: Node<'a, 'a>, mut class: Class<'a>) -> Class<'a> {
    for child in children(node) {
        let element = child.tag_name().name();
        let used: &[&'static str] = match element {
            "default" => continue,
            "joint" => &["type", "pos", "axis", "ref", "range", "limited"],
            "site" => &PLACING,
            "equality" => &["active"],
            _ => {
                draft.ignore(format!("default of {element}"));
                continue;
            }
        };
        let turns = |name: &str| element == "site" && name != "pos";
        if used.iter().any(|name| turns(name) && child.has_attribute(*name)) {
            class.retain(|(of, name), _| *of != element || !turns(name));
        }
        for &name in used {
            if let Some(value) = attribute(child, name) {
                class.insert((element, name), value);
            }
        }
        draft.ignore_attributes(child, used);
    }
    class
}
