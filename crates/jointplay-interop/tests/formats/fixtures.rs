//! Models with one part each, in every format that is imported: `base` and `part`, with the joint `j` between them.

use std::fmt::Write as _;

use jointplay_core::mechanism::JointKind;

use super::probes::{CLEARANCE, LEAD, LENGTH, LIMITS, STIFFNESS};

/// Formats that are imported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    MechanismFile,
    Mjcf,
    Sdf,
    Urdf,
    LoopsFile,
    LoopClosures,
    RobotYaml,
    FcStd,
    Asmt,
}

/// A part of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part {
    Joint(JointKind),
    LinkName,
    Limits,
    OneLimit,
    Actuated,
    Start,
    Frame,
    Clearance,
    JointStiffness,
    VirtualJoint,
    Parameters,
    CharacteristicLength,
    Coupling,
    Shape,
    Mass,
    Damping,
}

/// A model, and the file that closes its loops.
pub(crate) struct Fixture {
    pub(crate) text: String,
    pub(crate) loops: Option<String>,
}

/// The name of a link with letters that formats have to escape.
pub(crate) const NAME: &str = "Teil ä & \"co\"";
const ESCAPED: &str = "Teil ä &amp; &quot;co&quot;";
const START: f64 = 0.5;

/// The model with a part; `None` where the format has no such part.
pub(crate) fn fixture(format: Format, part: Part) -> Option<Fixture> {
    let alone = |text: String| Fixture { text, loops: None };
    match format {
        Format::MechanismFile => mechanism_file(part).map(alone),
        Format::Mjcf => mjcf(part).map(alone),
        Format::Sdf => sdf(part).map(alone),
        Format::Urdf => urdf(part).map(alone),
        Format::LoopsFile | Format::LoopClosures | Format::RobotYaml => loops(format, part),
        Format::FcStd => fcstd(part).map(alone),
        Format::Asmt => asmt(part).map(alone),
    }
}

/// Keys of a joint in TOML.
fn toml_joint(part: Part, links: &str) -> Option<String> {
    let kind = if let Part::Joint(kind) = part { kind } else { JointKind::Revolute };
    let mut keys = format!(
        "name = \"j\"\nkind = \"{}\"\nlinks = {links}\npoint = [0.1, 0.02, 0.05]\n",
        kind.name()
    );
    if !matches!(kind, JointKind::Spherical | JointKind::Fixed | JointKind::Floating) {
        keys += "axis = [0, 0, 1]\n";
    }
    match part {
        Part::Joint(JointKind::Universal) => keys += "second_axis = [1, 0, 0]\n",
        Part::Joint(JointKind::Helical { .. }) => {
            writeln!(keys, "lead = {}", LEAD * std::f64::consts::TAU).ok()?;
        }
        Part::Limits => writeln!(keys, "limits = [{}, {}]", LIMITS[0], LIMITS[1]).ok()?,
        Part::OneLimit => writeln!(keys, "limits = [-inf, {}]", LIMITS[1]).ok()?,
        Part::Actuated => keys += "actuated = true\n",
        Part::Start => writeln!(keys, "guess = {START}").ok()?,
        Part::Clearance => writeln!(keys, "clearance = {{ linear = {CLEARANCE} }}").ok()?,
        Part::JointStiffness => writeln!(keys, "stiffness = {{ linear = {STIFFNESS} }}").ok()?,
        _ => {}
    }
    Some(keys)
}

fn mechanism_file(part: Part) -> Option<String> {
    let link = if part == Part::LinkName { NAME } else { "part" }.replace('"', "\\\"");
    let mut head = "kind = \"mechanism\"\nname = \"model\"\nunits = { length = \"m\", angle = \"rad\" }\nbase = \"base\"\n".to_owned();
    let mut joint = toml_joint(part, &format!("[\"base\", \"{link}\"]"))?;
    let mut tail = String::new();
    match part {
        Part::Parameters => {
            head += "[parameters]\narm = 0.2\n";
            joint = joint.replace("point = [0.1", "point = [\"arm / 2\"");
        }
        Part::CharacteristicLength => {
            writeln!(head, "characteristic_length = {LENGTH}").ok()?;
        }
        Part::VirtualJoint => {
            tail += "[[virtual_joint]]\nname = \"play\"\njoint = \"j\"\nslide = [1, 0, 0]\n";
        }
        Part::Frame => {
            tail += "[[frame]]\nname = \"tool tip\"\nlink = \"part\"\npoint = [0, 0, 0.1]\n";
        }
        Part::Coupling => {
            tail += "[[joint]]\nname = \"k\"\nkind = \"revolute\"\nlinks = [\"part\", \"second\"]\npoint = [0, 0, 0]\naxis = [0, 0, 1]\n[[coupling]]\nname = \"gear\"\ncoordinate = \"k\"\nterms = [{ coordinate = \"j\", ratio = 2 }]\n";
        }
        Part::Shape | Part::Mass | Part::Damping => return None,
        _ => {}
    }
    Some(format!("{head}[[joint]]\n{joint}{tail}"))
}

fn mjcf(part: Part) -> Option<String> {
    let name = if part == Part::LinkName { ESCAPED } else { "part" };
    let hinge = "<joint name=\"j\" type=\"hinge\"/>";
    let (mut joints, mut inside, mut sections) = (hinge.to_owned(), "", "");
    let with = |attributes: &str| hinge.replace("/>", &format!(" {attributes}/>"));
    match part {
        Part::Joint(kind) => {
            joints = match kind {
                JointKind::Revolute => hinge.to_owned(),
                JointKind::Prismatic => "<joint name=\"j\" type=\"slide\"/>".to_owned(),
                JointKind::Spherical => "<joint name=\"j\" type=\"ball\"/>".to_owned(),
                JointKind::Floating => "<freejoint name=\"j\"/>".to_owned(),
                JointKind::Fixed => String::new(),
                JointKind::Cylindrical => {
                    format!("<joint name=\"s\" type=\"slide\"/>{hinge}")
                }
                JointKind::Universal => {
                    format!("{hinge}<joint name=\"k\" axis=\"1 0 0\"/>")
                }
                JointKind::Planar => format!(
                    "<joint name=\"x\" type=\"slide\" axis=\"1 0 0\"/><joint name=\"y\" type=\"slide\" axis=\"0 1 0\"/>{hinge}"
                ),
                _ => return None,
            }
        }
        Part::Limits => joints = with(&format!("range=\"{} {}\"", LIMITS[0], LIMITS[1])),
        Part::OneLimit => joints = with(&format!("range=\"-1e10 {}\"", LIMITS[1])),
        Part::Start => joints = with(&format!("ref=\"{START}\"")),
        Part::Damping => joints = with("damping=\"0.3\""),
        Part::JointStiffness => joints = with(&format!("stiffness=\"{STIFFNESS}\"")),
        Part::Actuated => sections = "<actuator><motor joint=\"j\"/></actuator>",
        Part::Frame => inside = "<site name=\"tool tip\" pos=\"0 0 0.1\"/>",
        Part::Shape => inside = "<geom type=\"box\" size=\"0.1 0.1 0.1\"/>",
        Part::Mass => {
            inside = "<inertial pos=\"0 0 0\" mass=\"2\" diaginertia=\"1 1 1\"/>";
        }
        Part::Coupling => {
            inside = "<body name=\"second\"><joint name=\"k\" type=\"hinge\"/></body>";
            sections =
                "<equality><joint joint1=\"k\" joint2=\"j\" polycoef=\"0 2 0 0 0\"/></equality>";
        }
        Part::LinkName => {}
        _ => return None,
    }
    Some(format!(
        "<mujoco model=\"model\"><compiler angle=\"radian\"/><worldbody><body name=\"{name}\" pos=\"0.1 0.02 0.05\">{joints}{inside}</body></worldbody>{sections}</mujoco>"
    ))
}

fn sdf(part: Part) -> Option<String> {
    let name = if part == Part::LinkName { ESCAPED } else { "part" };
    let (mut kind, mut inside) = ("revolute", String::new());
    let (mut in_link, mut after) = ("", "");
    match part {
        Part::Joint(of) => match of {
            JointKind::Revolute => {}
            JointKind::Prismatic => kind = "prismatic",
            JointKind::Helical { lead } => {
                kind = "screw";
                let pitch = lead * std::f64::consts::TAU;
                inside = format!("<screw_thread_pitch>{pitch}</screw_thread_pitch>");
            }
            JointKind::Universal => {
                kind = "universal";
                inside = "<axis2><xyz>1 0 0</xyz></axis2>".to_owned();
            }
            JointKind::Spherical => kind = "ball",
            JointKind::Fixed => kind = "fixed",
            JointKind::Floating => kind = "",
            _ => return None,
        },
        Part::OneLimit => inside = format!("<limit><upper>{}</upper></limit>", LIMITS[1]),
        Part::Limits => {
            inside =
                format!("<limit><lower>{}</lower><upper>{}</upper></limit>", LIMITS[0], LIMITS[1]);
        }
        Part::Damping => inside = "<dynamics><damping>0.3</damping></dynamics>".to_owned(),
        Part::JointStiffness => {
            inside =
                format!("<dynamics><spring_stiffness>{STIFFNESS}</spring_stiffness></dynamics>");
        }
        Part::Coupling => {
            inside = "<mimic joint=\"k\"><multiplier>2</multiplier><offset>0</offset><reference>0</reference></mimic>".to_owned();
            after = "<link name=\"second\"/><joint name=\"k\" type=\"revolute\"><parent>part</parent><child>second</child><axis><xyz>0 0 1</xyz></axis></joint>";
        }
        Part::Actuated => {
            after = "<plugin filename=\"p\" name=\"gz::sim::systems::JointPositionController\"><joint_name>j</joint_name></plugin>";
        }
        Part::Frame => {
            after =
                "<frame name=\"tool tip\" attached_to=\"part\"><pose>0 0 0.1 0 0 0</pose></frame>";
        }
        Part::Shape => {
            in_link =
                "<visual name=\"v\"><geometry><box><size>1 1 1</size></box></geometry></visual>";
        }
        Part::Mass => in_link = "<inertial><mass>2</mass></inertial>",
        Part::LinkName => {}
        _ => return None,
    }
    let axis = match kind {
        "ball" | "fixed" => String::new(),
        "universal" | "screw" => format!("<axis><xyz>0 0 1</xyz></axis>{inside}"),
        _ => format!("<axis><xyz>0 0 1</xyz>{inside}</axis>"),
    };
    let joint = format!(
        "<joint name=\"j\" type=\"{kind}\"><parent>world</parent><child>{name}</child>{axis}</joint>"
    );
    let joint = if kind.is_empty() {
        // A body that nothing holds, next to one that is held.
        "<link name=\"held\"/><joint name=\"h\" type=\"fixed\"><parent>world</parent><child>held</child></joint>".to_owned()
    } else {
        joint
    };
    Some(format!(
        "<sdf version=\"1.11\"><model name=\"model\"><link name=\"{name}\"><pose>0.1 0.02 0.05 0 0 0</pose>{in_link}</link>{joint}{after}</model></sdf>"
    ))
}

fn urdf(part: Part) -> Option<String> {
    let name = if part == Part::LinkName { ESCAPED } else { "part" };
    let (mut kind, mut inside) = ("continuous", String::new());
    let (mut in_link, mut after) = ("", "");
    match part {
        Part::Joint(of) => {
            kind = match of {
                JointKind::Revolute => "continuous",
                JointKind::Prismatic => {
                    inside =
                        "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>".to_owned();
                    "prismatic"
                }
                JointKind::Fixed => "fixed",
                JointKind::Floating => "floating",
                JointKind::Planar => "planar",
                JointKind::Spherical => "spherical",
                _ => return None,
            }
        }
        Part::OneLimit => {
            kind = "revolute";
            inside = format!("<limit lower=\"-1e16\" upper=\"{}\"/>", LIMITS[1]);
        }
        Part::Limits => {
            kind = "revolute";
            inside = format!(
                "<limit lower=\"{}\" upper=\"{}\" effort=\"1\" velocity=\"1\"/>",
                LIMITS[0], LIMITS[1]
            );
        }
        Part::Damping => inside = "<dynamics damping=\"0.3\" friction=\"0.1\"/>".to_owned(),
        Part::Coupling => {
            inside = "<mimic joint=\"k\" multiplier=\"2\" offset=\"0\"/>".to_owned();
            after = "<link name=\"second\"/><joint name=\"k\" type=\"continuous\"><parent link=\"part\"/><child link=\"second\"/><axis xyz=\"0 0 1\"/></joint>";
        }
        Part::Actuated => after = "<transmission name=\"t\"><joint name=\"j\"/></transmission>",
        Part::Start => {
            after = "<ros2_control name=\"c\" type=\"system\"><joint name=\"j\"><state_interface name=\"position\"><param name=\"initial_value\">0.5</param></state_interface></joint></ros2_control>";
        }
        Part::Frame => {
            after = "<link name=\"tool tip\"/><joint name=\"tip\" type=\"fixed\"><origin xyz=\"0 0 0.1\"/><parent link=\"part\"/><child link=\"tool tip\"/></joint>";
        }
        Part::Shape => in_link = "<visual><geometry><mesh filename=\"a.stl\"/></geometry></visual>",
        Part::Mass => {
            in_link = "<inertial><mass value=\"2\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>";
        }
        Part::LinkName => {}
        _ => return None,
    }
    Some(urdf_of(name, kind, &inside, in_link, after))
}

fn urdf_of(name: &str, kind: &str, inside: &str, in_link: &str, after: &str) -> String {
    format!(
        "<robot name=\"model\"><link name=\"base\"/><link name=\"{name}\">{in_link}</link><joint name=\"j\" type=\"{kind}\"><origin xyz=\"0.1 0.02 0.05\"/><parent link=\"base\"/><child link=\"{name}\"/><axis xyz=\"0 0 1\"/>{inside}</joint>{after}</robot>"
    )
}

/// A URDF whose loop a second file closes: the part hangs on the joint `tree`, and the second file adds its joint.
fn loops(format: Format, part: Part) -> Option<Fixture> {
    let tree =
        |name: &str| urdf_of(name, "floating", "", "", "").replace("name=\"j\"", "name=\"tree\"");
    let turning = urdf_of(
        "part",
        "continuous",
        "",
        "",
        "<link name=\"end\"/><joint name=\"tree\" type=\"floating\"><parent link=\"base\"/><child link=\"end\"/></joint>",
    );
    let (text, loops) = match format {
        Format::LoopsFile => {
            let joint = match part {
                Part::Joint(_)
                | Part::Limits
                | Part::OneLimit
                | Part::Actuated
                | Part::Start
                | Part::Clearance
                | Part::JointStiffness => toml_joint(part, "[\"base\", \"part\"]")?,
                Part::Coupling => {
                    let joint = toml_joint(part, "[\"base\", \"part\"]")?;
                    let coupling = "[[coupling]]\nname = \"gear\"\ncoordinate = \"k\"\nterms = [{ coordinate = \"j\", ratio = 2 }]\n";
                    format!("{joint}{coupling}")
                }
                Part::Parameters => {
                    let joint = toml_joint(part, "[\"base\", \"part\"]")?;
                    joint.replace("point = [0.1", "point = [\"arm / 2\"")
                }
                _ => return None,
            };
            let parameters =
                if part == Part::Parameters { "[parameters]\narm = 0.2\n" } else { "" };
            let head = "kind = \"loops\"\nunits = { length = \"m\", angle = \"rad\" }\n";
            let second = "<link name=\"second\"/><joint name=\"k\" type=\"continuous\"><parent link=\"part\"/><child link=\"second\"/><axis xyz=\"0 0 1\"/></joint></robot>";
            let text = match part {
                Part::Coupling => tree("part").replace("</robot>", second),
                _ => tree("part"),
            };
            (text, format!("{head}{parameters}[[joint]]\n{joint}"))
        }
        Format::LoopClosures => {
            let closure = "closures:\n- {link_a: base, link_b: part, point: [0.1, 0.02, 0.05], axis: [0, 0, 1]}\n";
            match part {
                Part::Joint(JointKind::Revolute) => (tree("part"), closure.to_owned()),
                Part::Actuated => {
                    let closure = closure.replace("link_a: base", "link_a: end");
                    (turning, format!("{closure}independent: [j]\n"))
                }
                Part::Coupling => {
                    let mimic =
                        "<mimic joint=\"tree\" multiplier=\"2\"/></joint><link name=\"end\"/>";
                    let text = turning.replacen("</joint><link name=\"end\"/>", mimic, 1);
                    let text = text.replace("type=\"floating\"", "type=\"continuous\"");
                    let closure = closure.replace("link_a: base", "link_a: end");
                    (text, format!("{closure}independent: [tree]\ndependent: [j]\n"))
                }
                _ => return None,
            }
        }
        _ => {
            let pair = |kind: &str| format!("closed_loop: [[part, end]]\ntype: [{kind}]\n");
            match part {
                Part::Joint(JointKind::Fixed) => (turning, pair("6d")),
                Part::Joint(JointKind::Spherical) => (turning, pair("3d")),
                Part::Joint(JointKind::Universal) => {
                    (turning, pair("6d") + "joint_name: [j]\njoint_type: [UJOINT_ZX]\n")
                }
                Part::Actuated => (turning, pair("6d") + "name_mot: [j]\n"),
                Part::Coupling => return None,
                _ => return None,
            }
        }
    };
    Some(Fixture { text, loops: Some(loops) })
}

/// A document of FreeCAD with the properties that joints of an assembly have.
fn fcstd(part: Part) -> Option<String> {
    let property =
        |name: &str, value: &str| format!("<Property name=\"{name}\">{value}</Property>");
    let text = |name: &str, value: &str| property(name, &format!("<String value=\"{value}\"/>"));
    let placement = |name: &str, [x, y, z]: [f64; 3], turn: f64| {
        let (sine, cosine) = (0.5 * turn).sin_cos();
        property(
            name,
            &format!(
                "<PropertyPlacement Px=\"{x}\" Py=\"{y}\" Pz=\"{z}\" Q0=\"0\" Q1=\"0\" Q2=\"{sine:?}\" Q3=\"{cosine:?}\"/>"
            ),
        )
    };
    let group = |names: &[&str]| {
        let links: String = names.iter().map(|name| format!("<Link value=\"{name}\"/>")).collect();
        property("Group", &format!("<LinkList>{links}</LinkList>"))
    };
    let reference = |name: &str, part: &str| {
        property(
            name,
            &format!("<XLink file=\"\" name=\"Assembly\"><Sub value=\"{part}.Face1\"/></XLink>"),
        )
    };
    let number = match part {
        Part::Joint(kind) => match kind {
            JointKind::Fixed => 0,
            JointKind::Revolute => 1,
            JointKind::Cylindrical => 2,
            JointKind::Prismatic => 3,
            JointKind::Spherical => 4,
            // A screw constrains a cylindrical joint.
            JointKind::Helical { .. } => 2,
            _ => return None,
        },
        Part::LinkName
        | Part::Coupling
        | Part::Limits
        | Part::OneLimit
        | Part::Actuated
        | Part::Start
        | Part::Shape => 1,
        _ => return None,
    };
    let label = if part == Part::LinkName { ESCAPED } else { "part" };
    let turn = if part == Part::Start { START } else { 0.0 };
    let flag = |name: &str, on: bool| property(name, &format!("<Bool value=\"{on}\"/>"));
    let float = |name: &str, value: f64| property(name, &format!("<Float value=\"{value:?}\"/>"));
    let limited = [part == Part::Limits, matches!(part, Part::Limits | Part::OneLimit)];
    let frames =
        |name: &str, number: usize, [(first, place), (second, other)]: [(&str, [f64; 3]); 2]| {
            [
                property("JointType", &format!("<Integer value=\"{number}\"/>")),
                text("Label", name),
                reference("Reference1", first),
                reference("Reference2", second),
                placement("Placement1", place, 0.0),
                placement("Placement2", other, 0.0),
            ]
            .concat()
        };
    let joint = [
        frames("j", number, [("Base", [100.0, 20.0, 50.0]), ("Moved", [0.0; 3])]),
        flag("EnableAngleMin", limited[0]),
        flag("EnableAngleMax", limited[1]),
        float("AngleMin", LIMITS[0].to_degrees()),
        float("AngleMax", LIMITS[1].to_degrees()),
    ]
    .concat();
    let mut objects = vec![
        (
            "Assembly",
            "Assembly::AssemblyObject",
            text("Label", "model") + &group(&["Joints", "Base", "Moved", "Second", "Motion"]),
        ),
        ("Joints", "Assembly::JointGroup", group(&["Ground", "Joint", "Axle", "Pair"])),
        ("Base", "Part::Box", text("Label", "base") + &placement("Placement", [0.0; 3], 0.0)),
        (
            "Moved",
            "Part::Box",
            text("Label", label) + &placement("Placement", [100.0, 20.0, 50.0], turn),
        ),
        (
            "Ground",
            "App::FeaturePython",
            text("Label", "ground") + &property("ObjectToGround", "<Link value=\"Base\"/>"),
        ),
        ("Joint", "App::FeaturePython", joint),
    ];
    let none = String::new;
    let (mut axle, mut pair, mut second) = (none(), none(), none());
    match part {
        Part::Coupling => {
            let place = [300.0, 0.0, 0.0];
            second = text("Label", "second") + &placement("Placement", place, 0.0);
            let of_second = |at| ("Second", at);
            axle = frames("k", 1, [("Base", place), of_second([0.0; 3])])
                + &flag("EnableAngleMin", false)
                + &flag("EnableAngleMax", false);
            pair = frames("belt", 12, [("Moved", [0.0; 3]), of_second([0.0; 3])])
                + &float("Distance", 20.0)
                + &float("Distance2", 10.0);
        }
        Part::Joint(JointKind::Helical { lead }) => {
            let ends = [("Base", [100.0, 20.0, 50.0]), ("Moved", [0.0; 3])];
            let pitch = 1000.0 * lead * std::f64::consts::TAU;
            pair = frames("thread", 10, ends) + &float("Distance", pitch);
        }
        _ => {}
    }
    objects.push(("Second", "Part::Box", second));
    objects.push(("Axle", "App::FeaturePython", axle));
    objects.push(("Pair", "App::FeaturePython", pair));
    let motion = if part == Part::Actuated {
        property("MotionType", "<Integer value=\"0\"/>")
            + &property("Joint", "<Link value=\"Joint\"/>")
    } else {
        String::new()
    };
    objects.push(("Motion", "App::FeaturePython", text("Label", "motion") + &motion));
    let declared: String = objects
        .iter()
        .map(|(name, kind, _)| format!("<Object type=\"{kind}\" name=\"{name}\"/>"))
        .collect();
    let data: String = objects
        .iter()
        .map(|(name, _, properties)| {
            format!("<Object name=\"{name}\"><Properties>{properties}</Properties></Object>")
        })
        .collect();
    Some(format!(
        "<Document><Objects>{declared}</Objects><ObjectData>{data}</ObjectData></Document>"
    ))
}

/// An assembly of FreeCAD's solver, in metres.
fn asmt(part: Part) -> Option<String> {
    let kind = match part {
        Part::Joint(kind) => match kind {
            JointKind::Revolute => "RevoluteJoint",
            JointKind::Prismatic => "TranslationalJoint",
            JointKind::Cylindrical => "CylindricalJoint",
            JointKind::Spherical => "SphericalJoint",
            JointKind::Fixed => "FixedJoint",
            JointKind::Universal => "UniversalJoint",
            JointKind::Planar => "PlanarJoint",
            // A screw constrains a cylindrical joint.
            JointKind::Helical { .. } => "CylindricalJoint",
            JointKind::Floating => return None,
        },
        Part::LinkName
        | Part::Coupling
        | Part::Limits
        | Part::OneLimit
        | Part::Actuated
        | Part::Start
        | Part::Frame
        | Part::Mass => "RevoluteJoint",
        _ => return None,
    };
    let name = if part == Part::LinkName { NAME } else { "part" };
    let turn = if part == Part::Start { START } else { 0.0 };
    let pose = |level: usize, [x, y, z]: [f64; 3], rows: [[f64; 3]; 3]| {
        let tab = "\t".repeat(level);
        let rows: String =
            rows.iter().map(|[a, b, c]| format!("{tab}\t{a:?}\t{b:?}\t{c:?}\n")).collect();
        format!("{tab}Position3D\n{tab}\t{x:?}\t{y:?}\t{z:?}\n{tab}RotationMatrix\n{rows}")
    };
    let level_rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let turned = |turn: f64| {
        let (sine, cosine) = turn.sin_cos();
        [[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]]
    };
    let marker = |level: usize, name: &str, at: [f64; 3], rows: [[f64; 3]; 3]| {
        let tab = "\t".repeat(level);
        format!(
            "{tab}RefPoint\n{}{tab}\tMarkers\n{tab}\t\tMarker\n{tab}\t\t\tName\n{tab}\t\t\t\t{name}\n{}",
            pose(level + 1, [0.0; 3], level_rows),
            pose(level + 3, at, rows)
        )
    };
    // The second axis of a universal joint is z of its second marker.
    let second = if kind == "UniversalJoint" {
        [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    } else {
        level_rows
    };
    let mut markers = marker(4, "m", [0.0; 3], second);
    if part == Part::Frame {
        markers += &marker(4, "tool tip", [0.0, 0.0, 0.1], level_rows);
    }
    let mass = if part == Part::Mass {
        "\t\t\tPrincipalMassMarker\n\t\t\t\tMass\n\t\t\t\t\t2.0\n"
    } else {
        ""
    };
    let motions = match part {
        Part::Actuated => "\t\tMotions\n\t\t\tRotationalMotion\n\t\t\t\tName\n\t\t\t\t\tm\n\t\t\t\tMotionJoint\n\t\t\t\t\t/model/j\n\t\t\t\tRotationZ\n\t\t\t\t\ttime\n".to_owned(),
        Part::Limits | Part::OneLimit => {
            let limit = |kind: &str, value: f64| {
                format!("\t\t\tRotationLimit\n\t\t\t\tName\n\t\t\t\t\tl\n\t\t\t\tMarkerI\n\t\t\t\t\t/model/g\n\t\t\t\tMarkerJ\n\t\t\t\t\t/model/part/m\n\t\t\t\tLimit\n\t\t\t\t\t{value:?}\n\t\t\t\tType\n\t\t\t\t\t{kind}\n")
            };
            let least = if part == Part::Limits { limit("=>", LIMITS[0]) } else { String::new() };
            format!("\t\tLimits\n{least}{}", limit("=<", LIMITS[1]))
        }
        _ => String::new(),
    };
    let between = |kind: &str, name: &str, ends: [&str; 2], values: &str| {
        let [first, second] = ends;
        format!(
            "\t\t\t{kind}\n\t\t\t\tName\n\t\t\t\t\t{name}\n\t\t\t\tMarkerI\n\t\t\t\t\t/model/{first}\n\t\t\t\tMarkerJ\n\t\t\t\t\t/model/{second}\n{values}"
        )
    };
    let value = |label: &str, value: f64| format!("\t\t\t\t{label}\n\t\t\t\t\t{value:?}\n");
    let (mut others, mut more, mut bearing) = (String::new(), String::new(), String::new());
    match part {
        Part::Coupling => {
            let place = [0.3, 0.0, 0.0];
            bearing = marker(2, "h", place, level_rows);
            others = format!(
                "\t\tPart\n\t\t\tName\n\t\t\t\tsecond\n{}\t\t\tRefPoints\n{}",
                pose(3, place, level_rows),
                marker(4, "m", [0.0; 3], level_rows)
            );
            // Belts of FreeCAD are gears with a negative radius.
            let radii = value("radiusI", 0.02) + &value("radiusJ", -0.01);
            more = between("RevoluteJoint", "k", ["h", "second/m"], "")
                + &between("GearJoint", "belt", ["part/m", "second/m"], &radii);
        }
        Part::Joint(JointKind::Helical { lead }) => {
            let pitch = value("pitch", lead * std::f64::consts::TAU);
            more = between("ScrewJoint", "thread", ["g", "part/m"], &pitch);
        }
        _ => {}
    }
    Some(format!(
        "OndselSolver\nAssembly\n\tName\n\t\tmodel\n{}\tRefPoints\n{}\tParts\n\t\tPart\n\t\t\tName\n\t\t\t\t{name}\n{}{mass}\t\t\tRefPoints\n{markers}{others}\tConstraintSets\n\t\tJoints\n\t\t\t{kind}\n\t\t\t\tName\n\t\t\t\t\tj\n\t\t\t\tMarkerI\n\t\t\t\t\t/model/g\n\t\t\t\tMarkerJ\n\t\t\t\t\t/model/{name}/m\n{more}{motions}",
        pose(1, [0.0; 3], level_rows),
        marker(2, "g", [0.1, 0.02, 0.05], level_rows) + &bearing,
        pose(3, [0.1, 0.02, 0.05], turned(turn)),
    ))
}
