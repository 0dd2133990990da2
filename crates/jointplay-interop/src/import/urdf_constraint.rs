//! `<constraint>`, proposed for loops in URDF: a joint between a frame on each of two links.

use jointplay_core::mechanism::{Joint, JointKind};
use jointplay_core::spatial::Pose;
use jointplay_format::mechanism::frame::{pose, some_perpendicular};
use nalgebra::{Rotation3, Unit, Vector3};
use roxmltree::Node;

use super::draft::{Draft, bare};
use super::problem::Error;
use super::starts::coordinates_between;
use super::urdf_place::{end, pose_of};
use super::xml::{Advice, attribute, children, place};

/// Elements of a constraint.
const PARTS: [&str; 6] =
    ["parent", "child", "parent_origin", "child_origin", "parent_axis", "child_axis"];

/// Adds the joint of a constraint, which starts where the links are with all joints at zero.
///
/// Its coordinate is zero where the two frames coincide; an axis of the child that is not given is that of the parent.
///
/// # Arguments
/// * `base_from_links` – poses of the links with all joints at zero (m)
///
/// # Source
/// \[URDFConstraints\]
pub(super) fn constraint<'a>(
    draft: &mut Draft<'a>,
    node: Node<'a, 'a>,
    base_from_links: &[Pose],
) -> Result<(), Error> {
    let xml = draft.xml;
    let name = draft.constraint_name(xml.needed_name(node)?, place(node))?;
    let value = attribute(node, "type").ok_or_else(|| xml.missing(node, "type"))?;
    let kind = match value.text {
        "revolute" | "continuous" => JointKind::Revolute,
        "prismatic" => JointKind::Prismatic,
        "cylindrical" => JointKind::Cylindrical,
        "universal" => JointKind::Universal,
        "spherical" | "ball" => JointKind::Spherical,
        "planar" => JointKind::Planar,
        "fixed" => JointKind::Fixed,
        _ => {
            let expected = "revolute, continuous, prismatic, cylindrical, universal, spherical, planar or fixed";
            return Err(xml.unusable(&value, expected));
        }
    };
    let mut parts = [None; PARTS.len()];
    for part in children(node) {
        let found = part.tag_name().name();
        let Some(number) = PARTS.iter().position(|known| *known == found) else {
            let advice = Advice(
                "it has parent, parent_origin, parent_axis, child, child_origin and child_axis; describe other loops by a joint in a second file of loops",
            );
            return Err(xml.unsupported(part, format!("<{found}> of a constraint"), advice));
        };
        if parts[number].replace(part).is_some() {
            let what = format!("a second <{found}> of a constraint");
            return Err(xml.unsupported(part, what, Advice("a constraint has at most one")));
        }
    }
    let [parent, child, parent_origin, child_origin, parent_axis, child_axis] = parts;
    let links = [end(draft, node, parent, "parent")?, end(draft, node, child, "child")?];
    let origins = [parent_origin, child_origin]
        .map(|origin| origin.map_or(Ok(Pose::identity()), |origin| pose_of(draft, origin)));
    let [parent_origin, child_origin] = origins;
    let (parent_origin, child_origin) = (parent_origin?, child_origin?);
    let direction = |axis: Option<Node<'a, 'a>>| {
        let xyz = axis.and_then(|axis| attribute(axis, "xyz"));
        xyz.map(|xyz| xml.direction(&xyz)).transpose()
    };
    let first = direction(parent_axis)?.unwrap_or(Vector3::x_axis());
    let second = direction(child_axis)?;
    let about = |x, z| pose(Vector3::zeros(), x, z);
    let [on_parent, on_child] = match kind {
        JointKind::Fixed | JointKind::Spherical => [Pose::identity(); 2],
        JointKind::Universal => {
            let second = second.ok_or_else(|| xml.missing(node, "child_axis"))?;
            let z = some_perpendicular(second);
            let z = Unit::new_normalize(z.into_inner() - second.scale(z.dot(&second)));
            [about(some_perpendicular(first), first), about(second, z)]
        }
        _ => {
            let x = some_perpendicular(first);
            let second = second.unwrap_or(first);
            // The least rotation from one axis to the other; of opposite axes about x.
            let turn = Rotation3::rotation_between(&first, &second);
            let turned = turn.map_or(x, |turn| Unit::new_normalize(turn * x.into_inner()));
            [about(x, first), about(turned, second)]
        }
    };
    let frames = [parent_origin * on_parent, child_origin * on_child];
    let [one, other] = [0, 1].map(|k| base_from_links[links[k]] * frames[k]);
    let guess = coordinates_between(kind, &(one.inverse() * other));
    draft.add_joint(Joint { guess, ..bare(name, kind, links, frames) }, place(node))
}

#[cfg(test)]
mod tests {
    use jointplay_core::mechanism::{Mechanism, close_commanded};
    use jointplay_core::mechanism::{MechanismSystem, OpenLoops, mechanism_mobility};
    use jointplay_core::mobility::RANK_THRESHOLD;

    use super::*;
    use crate::import::testing;

    /// A four-bar linkage, cut at the end of its coupler.
    const FOUR_BAR: &str = r#"<robot name="four-bar">
  <link name="ground"/><link name="crank"/><link name="coupler"/><link name="rocker"/>
  <joint name="A" type="continuous"><parent link="ground"/><child link="crank"/><axis xyz="0 0 1"/></joint>
  <joint name="B" type="continuous"><origin xyz="0 0.1 0"/><parent link="crank"/><child link="coupler"/><axis xyz="0 0 1"/></joint>
  <joint name="D" type="continuous"><origin xyz="0.3 0 0" rpy="0 0 0.5"/><parent link="ground"/><child link="rocker"/><axis xyz="0 0 1"/></joint>
  <constraint name="C" type="revolute">
    <parent link="coupler"/><parent_origin xyz="0.3 0.1 0"/><parent_axis xyz="0 0 1"/>
    <child link="rocker"/><child_origin xyz="0.0958851077208406 0.17551651237807455 0" rpy="0 0 -0.5"/>
  </constraint>
</robot>"#;

    /// Instantaneous and finite mobility where the loops close.
    fn mobility(mechanism: &Mechanism) -> (usize, Option<usize>) {
        let closed = close_commanded(mechanism, &[], None).unwrap();
        assert!(closed.is_closed());
        let system = MechanismSystem::new(mechanism, closed.coordinates).unwrap();
        let found = mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused).unwrap();
        (found.finite.instantaneous.mobility, found.finite.mobility)
    }

    #[test]
    fn a_constraint_closes_a_loop() {
        let model = testing::read(FOUR_BAR);
        assert_eq!(model.mechanism.loops(), 1);
        let [.., closing] = model.mechanism.joints() else { panic!() };
        assert_eq!((closing.name.as_str(), closing.kind), ("C", JointKind::Revolute));
        // The frames have the same orientation with all joints at zero.
        assert!(closing.guess[0].abs() < 1e-15, "{:?}", closing.guess);
        assert_eq!(mobility(&model.mechanism), (1, Some(1)));
        let ball = FOUR_BAR.replace("type=\"revolute\"", "type=\"spherical\"");
        assert_eq!(testing::read(&ball).mechanism.kutzbach_mobility(), 0);
        // An axis of the child in the other direction is another frame, half a turn away.
        let opposite = FOUR_BAR.replace(
            "<child link=\"rocker\"/><child_origin",
            "<child link=\"rocker\"/><child_axis xyz=\"0 0 -1\"/><child_origin",
        );
        let opposite = testing::read(&opposite).mechanism;
        assert!(close_commanded(&opposite, &[], None).is_err());
    }

    /// Two shafts whose axes meet at 30 degrees, joined by a cross.
    #[test]
    fn a_universal_joint_has_an_axis_on_each_link() {
        let shafts = r#"<robot name="shafts">
  <link name="frame"/><link name="one"/><link name="two"/>
  <joint name="A" type="continuous"><parent link="frame"/><child link="one"/><axis xyz="0 0 1"/></joint>
  <joint name="B" type="continuous"><origin rpy="0.5235987755982988 0 0"/><parent link="frame"/><child link="two"/><axis xyz="0 0 1"/></joint>
  <constraint name="cross" type="universal">
    <parent link="one"/><parent_axis xyz="1 0 0"/>
    <child link="two"/><child_axis xyz="0 1 0"/>
  </constraint>
</robot>"#;
        let model = testing::read(shafts);
        assert_eq!(model.mechanism.kutzbach_mobility(), -2);
        assert_eq!(mobility(&model.mechanism), (1, Some(1)));
        testing::refuse(
            shafts,
            "<child_axis xyz=\"0 1 0\"/>",
            "",
            "<constraint name=\"cross\" type=\"universal\">",
            "`constraint` needs `child_axis`",
        );
    }

    #[test]
    fn every_kind_closes_a_loop() {
        for (kind, freedoms) in [
            ("continuous", 1),
            ("prismatic", 1),
            ("cylindrical", 2),
            ("ball", 3),
            ("planar", 3),
            ("fixed", 0),
        ] {
            let model =
                testing::read(&FOUR_BAR.replace("type=\"revolute\"", &format!("type=\"{kind}\"")));
            let [.., closing] = model.mechanism.joints() else { panic!() };
            assert_eq!(closing.kind.freedoms(), freedoms, "{kind}");
            assert!(close_commanded(&model.mechanism, &[], None).unwrap().is_closed(), "{kind}");
        }
    }

    #[test]
    fn invalid_constraints_are_refused() {
        let refuse =
            |from, to, blamed, message| testing::refuse(FOUR_BAR, from, to, blamed, message);
        refuse("type=\"revolute\"", "type=\"rolling\"", "rolling", "has to be revolute");
        refuse(
            "<parent_axis xyz=\"0 0 1\"/>",
            "<axis xyz=\"0 0 1\"/>",
            "<axis xyz=\"0 0 1\"/>",
            "<axis> of a constraint",
        );
        refuse(
            "<child link=\"rocker\"/><child_origin",
            "<child link=\"roker\"/><child_origin",
            "roker",
            "did you mean `rocker`?",
        );
        refuse("name=\"C\" ", "", "<constraint type=\"revolute\">", "`constraint` needs `name`");
        refuse(
            "<parent_axis xyz=\"0 0 1\"/>",
            "<parent_axis xyz=\"0 0 0\"/>",
            "0 0 0",
            "a direction that is not 0",
        );
    }
}
