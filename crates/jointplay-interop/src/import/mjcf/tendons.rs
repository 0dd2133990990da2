//! Equalities of fixed tendons, which are sums of joint coordinates.

use jointplay_core::mechanism::{Coupling, JointCoordinate};
use roxmltree::Node;

use super::reader::Reader;
use crate::import::problem::Error;
use crate::import::xml::{Advice, Value, attribute, children, elements, place};

/// A sum of coordinates, each once.
type Sum = Vec<Term>;

/// Terms of one coordinate that cancel to this share of the largest leave round-off.
const CANCELLED: f64 = 1e-12;

/// A coordinate with its coefficient.
#[derive(Clone, Copy)]
struct Term {
    coordinate: JointCoordinate,
    coefficient: f64,
    /// The largest coefficient that was added, without sign.
    largest: f64,
}

impl<'a> Reader<'a> {
    /// A polynomial between the lengths of one or two tendons: y − y₀ = a₀ + a₁ (x − x₀), counted from the reference positions.
    pub(super) fn tendon_equality(&mut self, node: Node<'a, 'a>) -> Result<(), Error> {
        let xml = self.draft.xml;
        let first = attribute(node, "tendon1").ok_or_else(|| xml.missing(node, "tendon1"))?;
        let mut sum = self.tendon(node, &first)?;
        let second = attribute(node, "tendon2");
        let second = second.map(|second| self.tendon(node, &second)).transpose()?;
        let [constant, ratio] = self.linear_polynomial(node, second.is_some())?;
        for term in second.unwrap_or_default() {
            add(&mut sum, term.coordinate, -ratio * term.coefficient);
        }
        sum.retain(|term| term.coefficient.abs() > CANCELLED * term.largest);
        if sum.is_empty() {
            let advice = Advice("all its coefficients are zero");
            return Err(xml.unsupported(node, "this equality of tendons", advice));
        }
        let at_reference: f64 =
            sum.iter().map(|term| term.coefficient * self.reference(term.coordinate)).sum();
        let Term { coordinate: follower, coefficient: factor, .. } = sum.remove(0);
        let offset = (constant + at_reference) / factor;
        let terms = sum.iter().map(|term| (term.coordinate, -term.coefficient / factor)).collect();
        let name = match xml.name(node)? {
            Some(name) => self.draft.constraint_name(name, place(node))?,
            None => self.draft.fresh(format!("coupling {}", self.draft.couplings() + 1)),
        };
        let used = ["name", "class", "active", "tendon1", "tendon2", "polycoef"];
        self.draft.ignore_attributes(node, &used);
        self.draft.add_coupling(Coupling { name, follower, terms, offset }, place(node));
        Ok(())
    }

    /// The sum that is the length of a fixed tendon.
    fn tendon(&self, node: Node<'a, 'a>, name: &Value) -> Result<Sum, Error> {
        let xml = self.draft.xml;
        let root = node.document().root_element();
        let tendons: Vec<Node> = elements(root, "tendon").flat_map(children).collect();
        let names = tendons.iter().filter_map(|tendon| tendon.attribute("name"));
        let found = tendons.iter().find(|tendon| tendon.attribute("name") == Some(name.text));
        let found = found.ok_or_else(|| xml.unknown("tendon", name, names))?;
        if found.tag_name().name() != "fixed" {
            let advice = Advice(
                "only fixed tendons are sums of joints; set active=\"false\" to import the model without this equality",
            );
            return Err(xml.unsupported(node, "an equality of spatial tendons", advice));
        }
        let mut sum = Sum::new();
        for term in elements(*found, "joint") {
            let joint = attribute(term, "joint").ok_or_else(|| xml.missing(term, "joint"))?;
            let coefficient = attribute(term, "coef").ok_or_else(|| xml.missing(term, "coef"))?;
            add(&mut sum, self.draft.coordinate(&joint)?, xml.number(&coefficient)?);
        }
        Ok(sum)
    }
}

fn add(sum: &mut Sum, coordinate: JointCoordinate, coefficient: f64) {
    match sum.iter_mut().find(|term| term.coordinate == coordinate) {
        Some(term) => {
            term.coefficient += coefficient;
            term.largest = term.largest.max(coefficient.abs());
        }
        None => sum.push(Term { coordinate, coefficient, largest: coefficient.abs() }),
    }
}

#[cfg(test)]
mod tests {
    use crate::import::testing;

    const ARMS: &str = r#"<mujoco><compiler angle="radian"/><worldbody>
  <body><joint name="a" type="hinge" ref="0.2"/><geom size="1"/></body>
  <body><joint name="b" type="hinge"/><geom size="1"/></body>
  <body><joint name="c" type="slide"/><geom size="1"/></body>
</worldbody>
<tendon>
  <fixed name="sum"><joint joint="a" coef="2"/><joint joint="b" coef="-1"/></fixed>
  <fixed name="other"><joint joint="c" coef="4"/><joint joint="b" coef="1"/></fixed>
  <spatial name="rope"/>
</tendon>
<equality><tendon tendon1="sum" tendon2="other" polycoef="0.3 0.5 0 0 0"/></equality></mujoco>"#;

    #[test]
    fn an_equality_of_tendons_couples_all_their_joints() {
        let read = testing::read(ARMS);
        let [coupling] = read.mechanism.couplings() else { panic!("{read:?}") };
        // 2 (a − 0.2) − b − 0.5 (4 c + b) = 0.3.
        for (b, c) in [(0.0, 0.0), (0.7, -0.1), (-0.4, 0.25)] {
            let a = 0.2 + (0.3 + b + 0.5 * (4.0 * c + b)) / 2.0;
            assert_eq!(coupling.follower.joint, 0);
            let value = |joint: usize| [a, b, c][joint];
            let sum: f64 = coupling.terms.iter().map(|(one, r)| r * value(one.joint)).sum();
            assert!((coupling.offset + sum - a).abs() < 1e-12, "{coupling:?}");
        }
        let alone = ARMS.replace(" tendon2=\"other\"", "");
        let read = testing::read(&alone);
        let [coupling] = read.mechanism.couplings() else { panic!("{read:?}") };
        assert!((coupling.offset - (0.2 + 0.15)).abs() < 1e-12);
        assert_eq!(coupling.terms.len(), 1);
    }

    #[test]
    fn coordinates_that_cancel_are_not_coupled() {
        // 0.3 a + b = 3 (0.1 a + c), where 0.3 − 3 · 0.1 is −5.6e-17 in floating point.
        let model = ARMS
            .replace(
                r#"joint="a" coef="2"/><joint joint="b" coef="-1""#,
                r#"joint="a" coef="0.3"/><joint joint="b" coef="1""#,
            )
            .replace(
                r#"joint="c" coef="4"/><joint joint="b" coef="1""#,
                r#"joint="a" coef="0.1"/><joint joint="c" coef="1""#,
            )
            .replace("0.3 0.5 0 0 0", "0 3 0 0 0");
        let read = testing::read(&model);
        let [coupling] = read.mechanism.couplings() else { panic!("{read:?}") };
        assert_eq!(coupling.follower.joint, 1);
        let [(one, ratio)] = coupling.terms[..] else { panic!("{coupling:?}") };
        assert_eq!((one.joint, ratio), (2, 3.0));
    }

    #[test]
    fn equalities_of_other_tendons_are_refused() {
        let refuse = |from, to, blamed, message| testing::refuse(ARMS, from, to, blamed, message);
        refuse("tendon2=\"other\"", "tendon2=\"othr\"", "othr", "did you mean `other`");
        let spatial = "<tendon tendon1=\"sum\" tendon2=\"rope\" polycoef=\"0.3 0.5 0 0 0\"/>";
        refuse("tendon2=\"other\"", "tendon2=\"rope\"", spatial, "spatial tendons");
        refuse("joint=\"c\"", "joint=\"d\"", "d", "joint \"d\" is not known");
        refuse(" coef=\"4\"", "", "<joint joint=\"c\"/>", "needs `coef`");
        refuse(
            "0.3 0.5 0",
            "0.3 0.5 1",
            "<tendon tendon1=\"sum\" tendon2=\"other\" polycoef=\"0.3 0.5 1 0 0\"/>",
            "higher degree",
        );
    }
}
