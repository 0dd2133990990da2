//! A reader of exported models in Modelica, which knows only the components that exports have.

use std::collections::BTreeMap;

use jointplay_core::mechanism::{
    Coupling, Joint, JointCoordinate, JointKind, LinearAndAngular, Mechanism,
};
use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Quaternion, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

/// A component of a model.
struct Component {
    class: String,
    terms: BTreeMap<String, String>,
    description: String,
}

/// Text up to the closing parenthesis of the first one.
fn enclosed(text: &str) -> (&str, &str) {
    let mut depth = 0;
    for (k, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return (&text[1..k], &text[k + 1..]);
        }
    }
    panic!("{text:?} is not closed");
}

/// Terms `name = value` and `name(terms)`, the latter as `name.name`.
fn terms(text: &str, prefix: &str, found: &mut BTreeMap<String, String>) {
    let (mut depth, mut start) = (0, 0);
    for (k, c) in text.char_indices().chain([(text.len(), ',')]) {
        match c {
            '(' | '{' => depth += 1,
            ')' | '}' => depth -= 1,
            ',' if depth == 0 => {
                let term = text[start..k].trim();
                start = k + 1;
                let name = term.split([' ', '(']).next().unwrap();
                let rest = &term[name.len()..];
                if let Some(value) = rest.strip_prefix(" = ") {
                    found.insert(format!("{prefix}{name}"), value.to_owned());
                } else if rest.starts_with('(') {
                    terms(enclosed(rest).0, &format!("{prefix}{name}."), found);
                }
            }
            _ => {}
        }
    }
}

fn unquoted(text: &str) -> String {
    let inner = text.trim().strip_prefix('"').and_then(|text| text.strip_suffix("\";"));
    let inner = inner.unwrap_or_else(|| panic!("{text:?} is no description"));
    inner.replace("\\\"", "\"").replace("\\\\", "\\")
}

impl Component {
    fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        let text = self.terms.get(name)?;
        let numbers = text.split(['{', '}', ',', ' ']).filter(|word| !word.is_empty());
        Some(numbers.map(|word| word.parse().unwrap()).collect())
    }

    fn number(&self, name: &str) -> Option<f64> {
        self.numbers(name).map(|all| all[0])
    }

    fn vector(&self, name: &str) -> Option<Vector3<f64>> {
        self.numbers(name).map(|all| Vector3::from_row_slice(&all))
    }

    fn pose(&self, ending: &str) -> Pose {
        let origin = self.vector(&format!("r{ending}")).unwrap_or_default();
        let rows = self.numbers(&format!("R{ending}"));
        let rotation = rows.map_or(Matrix3::identity(), |rows| Matrix3::from_row_slice(&rows));
        Pose::from_parts(Translation3::from(origin), Rotation3::from_matrix_unchecked(rotation))
    }

    /// The joint of a component without names, and its pose at the start.
    fn joint(&self, input: Option<&Self>) -> (Joint, Pose) {
        let of_start = input.map_or(self, |input| input);
        let prefix = if input.is_some() { "" } else { "q." };
        let start = of_start.number(&format!("{prefix}start"));
        let class = self.class.trim_start_matches("Driven");
        let (before, after) = (self.pose("_before"), self.pose("_after"));
        let mut joint = Joint {
            name: self.description.clone(),
            kind: JointKind::Fixed,
            links: [0, 0],
            frames: [before, after.inverse()],
            actuated: input.is_some(),
            guess: Vec::new(),
            limits: Vec::new(),
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        };
        let sign = self.number("turn").or(self.number("travel")).unwrap_or(1.0).signum();
        joint.kind = match class {
            "Turn" => JointKind::Revolute,
            "Slide" => JointKind::Prismatic,
            "Screw" => JointKind::Helical {
                lead: self.number("travel").unwrap() * self.number("turn").unwrap_or(1.0),
            },
            "Ball" => {
                let [w, x, y, z] = self.numbers("Q.start").unwrap()[..] else { panic!("Q") };
                let turned = UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z));
                joint.kind = JointKind::Spherical;
                joint.guess = turned.scaled_axis().iter().copied().collect();
                return (
                    joint,
                    before
                        * Pose::from_parts(Translation3::identity(), turned.to_rotation_matrix())
                        * after,
                );
            }
            other => panic!("{other} is no joint"),
        };
        // The axis is z in the frames of a joint.
        let sign = if class == "Screw" { self.number("turn").unwrap_or(1.0) } else { sign };
        let axis = Unit::new_normalize(self.vector("n").unwrap_or(Vector3::z()) * sign);
        let turned = Rotation3::rotation_between(&Vector3::z(), &axis).unwrap_or_else(|| {
            Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
        });
        let point = self.vector("p").unwrap_or_default();
        let on_axis = Pose::from_parts(Translation3::from(point), turned);
        joint.frames = [before * on_axis, after.inverse() * on_axis];
        let q = start.unwrap_or(0.0);
        joint.guess = vec![q];
        let [least, most] = ["min", "max"].map(|end| of_start.number(&format!("{prefix}{end}")));
        if least.or(most).is_some() {
            joint.limits =
                vec![[least.unwrap_or(f64::NEG_INFINITY), most.unwrap_or(f64::INFINITY)]];
        }
        let (turn, travel) = match joint.kind {
            JointKind::Prismatic => (0.0, q),
            JointKind::Helical { lead } => (q, lead * q),
            _ => (q, 0.0),
        };
        let moved = Pose::from_parts(
            Translation3::new(0.0, 0.0, travel),
            Rotation3::from_axis_angle(&Vector3::z_axis(), turn),
        );
        let pose = joint.frames[0] * moved * joint.frames[1].inverse();
        (joint, pose)
    }
}

/// The mechanism of a package; virtual joints are joints.
pub(crate) fn read(text: &str) -> Mechanism {
    let model = text.split("  model Mechanism ").nth(1).unwrap();
    let (name, model) = model.split_once('\n').unwrap();
    let name = unquoted(&format!("{name};"));
    let (model, _) = model.split_once("  end Mechanism;").unwrap();
    let (declared, equations) = model.split_once("  equation\n").unwrap();
    let mut components: Vec<(String, Component)> = Vec::new();
    for line in declared.lines() {
        let (class, rest) = line.trim().split_once(' ').unwrap();
        let identifier = rest.split(['(', ' ']).next().unwrap();
        let mut rest = &rest[identifier.len()..];
        let mut found = BTreeMap::new();
        if rest.starts_with('(') {
            let (inner, after) = enclosed(rest);
            terms(inner, "", &mut found);
            rest = after;
        }
        let description = unquoted(rest);
        let component = Component { class: class.to_owned(), terms: found, description };
        assert!(components.iter().all(|(other, _)| other != identifier), "{identifier} twice");
        components.push((identifier.to_owned(), component));
    }
    let of = |name: &str| &components.iter().find(|(other, _)| other == name).unwrap().1;
    let connections: Vec<[&str; 2]> = equations
        .lines()
        .map(|line| {
            let inner = line.trim().strip_prefix("connect(").unwrap();
            let (one, other) = inner.strip_suffix(");").unwrap().split_once(", ").unwrap();
            [one, other]
        })
        .collect();
    // Connected frames are those of one link.
    let mut link_of: BTreeMap<&str, usize> = BTreeMap::new();
    let mut links: Vec<String> = Vec::new();
    for (identifier, component) in &components {
        if ["Base", "Link"].contains(&component.class.as_str()) {
            for [one, other] in &connections {
                for (end, far) in [(one, other), (other, one)] {
                    if end.strip_suffix(".frame") == Some(identifier) {
                        link_of.insert(far, links.len());
                    }
                }
            }
            links.push(component.description.clone());
        }
    }
    for ends in &connections {
        if ends.iter().all(|end| end.ends_with(".a") || end.ends_with(".b")) {
            links.push(format!("between {}", ends.join(" and ")));
            link_of.extend(ends.map(|end| (end, links.len() - 1)));
        }
    }
    let far = |end: &str| {
        let is_at = |ends: &&[&str; 2]| ends.contains(&end);
        let ends = connections.iter().find(is_at)?;
        Some(ends[usize::from(ends[0] == end)])
    };
    let mut joints: Vec<Joint> = Vec::new();
    let mut of_joint: BTreeMap<&str, usize> = BTreeMap::new();
    let mut poses: Vec<Option<Pose>> = vec![None; links.len()];
    poses[0] = Some(Pose::identity());
    for (identifier, component) in &components {
        let at = ["a", "b"].map(|end| link_of.get(format!("{identifier}.{end}").as_str()).copied());
        let [Some(a), Some(b)] = at else { continue };
        let (mut joint, pose) = match component.class.as_str() {
            "ClosureOfPoints" | "ClosureOfFrames" => continue,
            "Rigid" => {
                let pose = component.pose("");
                let fixed = Component {
                    class: "Turn".to_owned(),
                    terms: BTreeMap::new(),
                    description: component.description.clone(),
                };
                let mut joint = fixed.joint(None).0;
                (joint.kind, joint.frames) = (JointKind::Fixed, [pose, Pose::identity()]);
                joint.guess.clear();
                (joint, pose)
            }
            _ => component.joint(far(&format!("{identifier}.u")).map(of)),
        };
        joint.links = [a, b];
        assert!(poses[b].is_none(), "two joints move {}", links[b]);
        of_joint.insert(identifier, joints.len());
        joints.push(joint);
        // Joints are in the order of their bodies, the nearest the base first.
        poses[b] = Some(poses[a].unwrap_or_else(|| panic!("{} has no pose", links[a])) * pose);
    }
    for (identifier, component) in &components {
        if !component.class.starts_with("Closure") {
            continue;
        }
        let ends = ["a", "b"].map(|end| link_of[format!("{identifier}.{end}").as_str()]);
        let frames = [component.pose("_a"), component.pose("_b")];
        let at = [0, 1].map(|side| poses[ends[side]].unwrap() * frames[side]);
        let across = at[0].inverse() * at[1];
        let is_ball = component.class == "ClosureOfPoints";
        let turned = UnitQuaternion::from_rotation_matrix(&across.rotation);
        let guess = turned.scaled_axis().iter().copied().collect();
        joints.push(Joint {
            name: component.description.clone(),
            kind: if is_ball { JointKind::Spherical } else { JointKind::Fixed },
            links: ends,
            frames,
            actuated: false,
            guess: if is_ball { guess } else { Vec::new() },
            limits: Vec::new(),
            clearance: LinearAndAngular::default(),
            stiffness: LinearAndAngular::default(),
        });
    }
    let coordinate = |end: &str| {
        let joint = far(end).unwrap().strip_suffix(".flange").unwrap();
        JointCoordinate { joint: of_joint[joint], freedom: 0 }
    };
    let couplings =
        components.iter().filter(|(_, component)| component.terms.contains_key("offset"));
    let couplings = couplings.map(|(identifier, component)| Coupling {
        name: component.description.clone(),
        follower: coordinate(&format!("{identifier}.follower")),
        terms: (1..)
            .map(|k| format!("{identifier}.others[{k}]"))
            .zip(component.numbers("ratio").unwrap_or_default())
            .map(|(end, ratio)| (coordinate(&end), ratio))
            .collect(),
        offset: component.number("offset").unwrap(),
    });
    let couplings: Vec<Coupling> = couplings.collect();
    Mechanism::new(&name, links, joints).unwrap().with_couplings(couplings).unwrap()
}
