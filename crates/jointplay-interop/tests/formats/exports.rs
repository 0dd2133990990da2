//! Mechanisms written and read again.

use jointplay_core::mechanism::{
    Carrier, Coupling, Joint, JointCoordinate, JointKind, LinearAndAngular, Mechanism, guess,
};
use jointplay_format::mechanism;
use jointplay_interop::export::mechanism::{Written, mjcf, modelica, sdf, urdf};
use jointplay_interop::import::{parse, parse_closed};
use nalgebra::DVector;

use crate::modelica_text;

use super::probes::{
    CLEARANCE, LENGTH, LIMITS, STIFFNESS, closed_by, frame, has_limits, is_near, joint, kinds,
    kinds_of, named, pair, play, pose_difference, slide, turn, with_joint,
};

const COLUMNS: [&str; 5] = ["mechanism file", "MJCF", "Modelica", "SDF", "URDF and file of loops"];

/// A part of a mechanism, and how it is recognised in what is read.
struct Row {
    part: &'static str,
    mechanism: Mechanism,
    /// The exported configuration (m, rad).
    at: DVector<f64>,
    /// Begins the report of a loss.
    report: &'static str,
    /// Text of the part in a file.
    mark: &'static str,
    /// How the part is kept; `None` where it is not.
    kept: Kept,
}

type Kept = Box<dyn Fn(&Reading) -> Option<String>>;

/// Result of reading a written file.
struct Reading {
    text: String,
    lost: Vec<String>,
    is_in_two_files: bool,
    found: Mechanism,
}

fn yes(kept: bool) -> Option<String> {
    kept.then(|| "kept".to_owned())
}

fn row(
    part: &'static str,
    mechanism: Mechanism,
    report: &'static str,
    kept: impl Fn(&Reading) -> Option<String> + 'static,
) -> Row {
    let at = guess(&mechanism);
    Row { part, mechanism, at, report, mark: "\0", kept: Box::new(kept) }
}

/// Writes and reads; an error is the refusal of the writer.
fn read(column: usize, mechanism: &Mechanism, at: &DVector<f64>) -> Result<Reading, String> {
    let written = match column {
        0 => Ok(Written {
            text: mechanism::write(mechanism, Some("origin of the probe")),
            loops: None,
            lost: Vec::new(),
        }),
        1 => mjcf(mechanism, at),
        2 => modelica(mechanism, at, "Package"),
        3 => sdf(mechanism, at),
        _ => urdf(mechanism, at),
    };
    let Written { text, loops, lost } = written.map_err(|error| error.to_string())?;
    let found = if column == 0 {
        mechanism::parse(&text).map_err(|error| error.with_excerpt("written")).unwrap().mechanism
    } else if column == 2 {
        modelica_text::read(&text)
    } else {
        let model = match &loops {
            None => parse(&text).map_err(|error| error.with_excerpt("written")),
            Some(loops) => parse_closed(&text, None, loops).map_err(|error| error.to_string()),
        };
        model.unwrap().mechanism
    };
    let is_in_two_files = loops.is_some();
    let text = text + loops.as_deref().unwrap_or_default();
    Ok(Reading { text, lost, is_in_two_files, found })
}

pub(crate) fn table() -> String {
    let rows: Vec<(&str, Vec<String>)> = rows()
        .iter()
        .map(|row| (row.part, (0..COLUMNS.len()).map(|column| cell(column, row)).collect()))
        .collect();
    super::table("part of a mechanism", &COLUMNS, &rows)
}

/// A part that is absent is refused, reported as lost, or in the file and passed over by the reader of jointplay.
fn cell(column: usize, row: &Row) -> String {
    let reading = match read(column, &row.mechanism, &row.at) {
        Ok(reading) => reading,
        Err(message) => {
            let states_why = ["cannot describe", "cannot be exported"];
            assert!(
                states_why.iter().any(|words| message.contains(words)),
                "{}: {message}",
                row.part
            );
            return "refused".to_owned();
        }
    };
    if let Some(kept) = (row.kept)(&reading) {
        return kept;
    }
    if reading.lost.iter().any(|lost| lost.contains(row.report)) {
        return "lost, reported".to_owned();
    }
    assert!(
        reading.text.contains(row.mark),
        "{} is lost in {} without a report: {:?}\n{}",
        row.part,
        COLUMNS[column],
        reading.lost,
        reading.text
    );
    "in the file, not imported".to_owned()
}

fn rows() -> Vec<Row> {
    let mut rows = names_and_places();
    for kind in kinds() {
        let mechanism = pair(joint(kind));
        let part = match kind {
            JointKind::Revolute => "revolute joint",
            JointKind::Prismatic => "prismatic joint",
            JointKind::Helical { .. } => "helical joint",
            JointKind::Cylindrical => "cylindrical joint",
            JointKind::Universal => "universal joint",
            JointKind::Spherical => "spherical joint",
            JointKind::Planar => "planar joint",
            JointKind::Fixed => "fixed joint",
            JointKind::Floating => "floating joint",
        };
        let original = mechanism.clone();
        rows.push(row(part, mechanism, "is a ball", move |reading| {
            let found = &reading.found;
            assert_eq!(found.joint_freedoms(), original.joint_freedoms(), "{part}");
            assert!(pose_difference(&original, &guess(&original), found) < 1e-9, "{part}");
            let kinds = kinds_of(found.joints().iter());
            let lead = match (kind, found.joints()[0].kind) {
                (JointKind::Helical { lead }, JointKind::Helical { lead: found }) => {
                    (lead - found).abs() < 1e-15
                }
                _ => true,
            };
            let is_same = kinds == format!("1 {}", kind.name()) && lead;
            yes(is_same).or(Some(format!("as {kinds}")))
        }));
    }
    rows.extend(loops());
    rows.extend(limits_and_motors());
    rows.extend(play_and_stiffness());
    rows.extend(couplings());
    rows
}

fn names_and_places() -> Vec<Row> {
    let names = ["base <1>".to_owned(), "Teil ä & \"co\"".to_owned()];
    let links = Mechanism::new("pair", names.to_vec(), vec![joint(JointKind::Revolute)]).unwrap();
    let mut odd = joint(JointKind::Revolute);
    odd.name = "hinge <1> & \"co\"".to_owned();
    let moved = with_joint(|joint| joint.frames[1] = joint.frames[0].inverse());
    let original = moved.clone();
    let at = DVector::from_element(1, 0.5);
    let place = at.clone();
    let mut poses = row("poses of links", moved.clone(), "pose", move |reading| {
        yes(pose_difference(&original, &place, &reading.found) < 1e-12)
    });
    poses.at.clone_from(&at);
    // A mechanism file has the guess of the mechanism and no configuration of its own.
    let start = |joint: &mut jointplay_core::mechanism::Joint| joint.guess = vec![0.5];
    poses.mechanism = moved.clone().with_joints(with(&moved, start)).unwrap();
    let mut coordinates = row(
        "value of a coordinate in this configuration",
        poses.mechanism.clone(),
        "at zero in the reference configuration",
        |reading| {
            let value = named(&reading.found, "j")?.guess.first().copied().unwrap_or(0.0);
            yes(is_near(value, 0.5))
        },
    );
    coordinates.at = at;
    let length = pair(joint(JointKind::Revolute)).with_characteristic_length(LENGTH).unwrap();
    let formula = "kind = \"mechanism\"\nname = \"pair\"\nunits = { length = \"mm\", angle = \"deg\" }\nbase = \"base\"\n[parameters]\narm = 120\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\nlinks = [\"base\", \"part\"]\npoint = [\"arm / 2\", 0, 0]\naxis = [0, 0, 1]\n";
    let formula = mechanism::parse(formula).unwrap();
    assert_eq!(formula.parameters.len(), 1);
    vec![
        row("names of links", links, "name", move |reading| {
            yes(names.iter().all(|name| reading.found.link(name).is_some()))
        }),
        row("names of joints", pair(odd), "name", |reading| {
            yes(named(&reading.found, "hinge <1> & \"co\"").is_some())
        }),
        row("name of the mechanism", pair(joint(JointKind::Revolute)), "name", |reading| {
            yes(reading.found.name() == "pair")
        }),
        poses,
        coordinates,
        row("dimensions as parameters and formulas", formula.mechanism, "parameter", |reading| {
            let found = &named(&reading.found, "j")?.frames[0];
            let own = mechanism::parse(&reading.text).ok().map(|file| file.parameters.len());
            let is_same = is_near(found.translation.x, 0.06);
            yes(own.is_some_and(|count| count > 0))
                .or_else(|| is_same.then(|| "as numbers".to_owned()))
        }),
        {
            let mut frames = row("attached frames", frame(), "frame", |reading| {
                let expected = &frame().frames()[0].link_from_frame.to_homogeneous();
                let frames = reading.found.frames();
                if let Some(found) = frames.iter().find(|found| found.name == "tool tip") {
                    return yes((found.link_from_frame.to_homogeneous() - expected).amax() < 1e-12);
                }
                let link = reading.found.link("tool tip")?;
                let fixed = reading.found.joints().iter().find(|one| one.links[1] == link)?;
                let place = fixed.frames[0] * fixed.frames[1].inverse();
                let off = (place.to_homogeneous() - expected).amax();
                (fixed.kind == JointKind::Fixed && off < 1e-9).then(|| "as a fixed link".to_owned())
            });
            frames.mark = "tool tip";
            frames
        },
        row("characteristic length", length, "characteristic length", |reading| {
            yes(reading.found.characteristic_length().is_some_and(|found| is_near(found, LENGTH)))
        }),
    ]
}

/// The joints of a mechanism with a changed first one.
fn with(
    mechanism: &Mechanism,
    change: impl FnOnce(&mut jointplay_core::mechanism::Joint),
) -> Vec<jointplay_core::mechanism::Joint> {
    let mut joints = mechanism.joints().to_vec();
    change(&mut joints[0]);
    joints
}

fn loops() -> Vec<Row> {
    let kinds = [
        ("loop closed by a revolute joint", JointKind::Revolute),
        ("loop closed by a spherical joint", JointKind::Spherical),
        ("loop closed by a cylindrical joint", JointKind::Cylindrical),
        ("loop closed by a universal joint", JointKind::Universal),
    ];
    let one = |(part, kind): (&'static str, JointKind)| {
        let original = closed_by(kind);
        let mechanism = original.clone();
        row(part, mechanism, "loop", move |reading| {
            let found = &reading.found;
            let is_closed = found.loops() == original.loops()
                && pose_difference(&original, &guess(&original), found) < 1e-9;
            let file = if reading.is_in_two_files { ", in the second file" } else { "" };
            let same = named(found, "C").is_some_and(|joint| joint.kind == kind);
            let of_tree = ["A", "B", "D"];
            let closing = found.joints().iter().filter(|one| !of_tree.contains(&one.name.as_str()));
            let how = if same { "kept".to_owned() } else { format!("as {}", kinds_of(closing)) };
            is_closed.then(|| format!("{how}{file}"))
        })
    };
    kinds.into_iter().map(one).collect()
}

fn limits_and_motors() -> Vec<Row> {
    let limited = |kind: JointKind| {
        let mut joint = joint(kind);
        joint.limits = vec![LIMITS; kind.freedoms()];
        pair(joint)
    };
    let driven = |kind: JointKind| {
        let mut joint = joint(kind);
        joint.actuated = true;
        pair(joint)
    };
    let all_limited = |count: usize| {
        move |reading: &Reading| {
            let limits: Vec<[f64; 2]> =
                reading.found.joints().iter().flat_map(|joint| joint.limits.clone()).collect();
            let is_same = limits.len() == count
                && limits.iter().all(|[a, b]| is_near(*a, LIMITS[0]) && is_near(*b, LIMITS[1]));
            yes(is_same)
        }
    };
    let one_limit = |end: usize| {
        let kind = [JointKind::Prismatic, JointKind::Revolute][end];
        let limits = [[LIMITS[0], f64::INFINITY], [f64::NEG_INFINITY, LIMITS[1]]][end];
        pair(Joint { limits: vec![limits], ..joint(kind) })
    };
    let all_driven = |count: usize| {
        move |reading: &Reading| yes(reading.found.actuated_coordinates().len() == count)
    };
    vec![
        row("limits of a revolute joint", limited(JointKind::Revolute), "limits", |reading| {
            yes(has_limits(named(&reading.found, "j")?, &[LIMITS]))
        }),
        row("limit of a revolute joint at one end", one_limit(1), "limits", |reading| {
            let [[least, most]] = named(&reading.found, "j")?.limits[..] else { return None };
            yes(least == f64::NEG_INFINITY && is_near(most, LIMITS[1]))
        }),
        row("limit of a prismatic joint at one end", one_limit(0), "limits", |reading| {
            let [[least, most]] = named(&reading.found, "j")?.limits[..] else { return None };
            yes(is_near(least, LIMITS[0]) && most == f64::INFINITY)
        }),
        row("limits of a prismatic joint", limited(JointKind::Prismatic), "limits", |reading| {
            yes(has_limits(named(&reading.found, "j")?, &[LIMITS]))
        }),
        row(
            "limits of a cylindrical joint",
            limited(JointKind::Cylindrical),
            "limits",
            all_limited(2),
        ),
        row("limits of a spherical joint", limited(JointKind::Spherical), "limits", all_limited(3)),
        row(
            "prismatic joint without limits",
            pair(joint(JointKind::Prismatic)),
            "limits",
            |reading| yes(named(&reading.found, "j")?.limits.is_empty()),
        ),
        row("actuated revolute joint", driven(JointKind::Revolute), "actuator", all_driven(1)),
        row("actuated universal joint", driven(JointKind::Universal), "actuator", all_driven(2)),
        row("actuated spherical joint", driven(JointKind::Spherical), "actuator", all_driven(3)),
    ]
}

fn play_and_stiffness() -> Vec<Row> {
    let both = LinearAndAngular { linear: Some(CLEARANCE), angular: None };
    let stiff = LinearAndAngular { linear: Some(STIFFNESS), angular: None };
    let as_joint = |kind: JointKind| {
        move |reading: &Reading| {
            let found = &reading.found;
            match found.virtual_joints() {
                [only] if only.name == "play" && only.carrier == Carrier::First => yes(true),
                _ => {
                    let joint = named(found, "play")?;
                    (joint.kind == kind).then(|| format!("as a {} joint", kind.name()))
                }
            }
        }
    };
    let clearance = |reading: &Reading| {
        let found = &reading.found;
        match found.virtual_joints() {
            [only] => yes(only.clearance.is_some_and(|found| is_near(found, CLEARANCE))),
            _ => has_limits(named(found, "play")?, &[[-CLEARANCE, CLEARANCE]])
                .then(|| "as limits".to_owned()),
        }
    };
    let mut stiffness = row(
        "stiffness of a virtual joint",
        play(slide(), Some(CLEARANCE), Some(STIFFNESS)),
        "stiffness of virtual joints",
        |reading| match reading.found.virtual_joints() {
            [only] => yes(only.stiffness.is_some_and(|found| is_near(found, STIFFNESS))),
            _ => None,
        },
    );
    stiffness.mark = "43210";
    vec![
        row(
            "clearance of a joint",
            with_joint(|joint| joint.clearance = both),
            "clearance of a joint",
            |reading| yes(named(&reading.found, "j")?.clearance.linear == Some(CLEARANCE)),
        ),
        row(
            "stiffness of a joint",
            with_joint(|joint| joint.stiffness = stiff),
            "stiffness of a joint",
            |reading| yes(named(&reading.found, "j")?.stiffness.linear == Some(STIFFNESS)),
        ),
        row(
            "virtual slide",
            play(slide(), None, Some(STIFFNESS)),
            "virtual joint",
            as_joint(JointKind::Prismatic),
        ),
        row(
            "virtual turn",
            play(turn(), None, Some(STIFFNESS)),
            "virtual joint",
            as_joint(JointKind::Revolute),
        ),
        row(
            "clearance of a virtual joint",
            play(slide(), Some(CLEARANCE), Some(STIFFNESS)),
            "clearance",
            clearance,
        ),
        stiffness,
    ]
}

/// Couplings of one, two and three coordinates of a joint.
fn couplings() -> Vec<Row> {
    let coordinate = |freedom| JointCoordinate { joint: 0, freedom };
    let coupled = |part, kind, ratios: Vec<f64>| {
        let terms: Vec<(JointCoordinate, f64)> =
            (1..).map(coordinate).zip(ratios.iter().copied()).collect();
        let coupling =
            Coupling { name: "gear".to_owned(), follower: coordinate(0), terms, offset: 0.0 };
        let mechanism = pair(joint(kind)).with_couplings(vec![coupling]).unwrap();
        row(part, mechanism, "coupling", move |reading| {
            let [coupling] = reading.found.couplings() else { return None };
            let found: Vec<f64> = coupling.terms.iter().map(|&(_, ratio)| ratio).collect();
            let same = found.len() == ratios.len()
                && found.iter().zip(&ratios).all(|(a, b)| (a - b).abs() < 1e-12);
            yes(same)
        })
    };
    let joined = JointCoordinate { joint: 0, freedom: 0 };
    let terms = vec![(JointCoordinate { joint: 0, freedom: 1 }, 0.002)];
    let named = Coupling { name: "gear".to_owned(), follower: joined, terms, offset: 0.0 };
    let named = pair(joint(JointKind::Cylindrical)).with_couplings(vec![named]).unwrap();
    vec![
        row("name of a coupling", named, "name of the coupling", |reading| {
            yes(reading.found.couplings()[0].name == "gear")
        }),
        coupled("coupling of two coordinates", JointKind::Cylindrical, vec![0.002]),
        coupled("coupling of three coordinates", JointKind::Planar, vec![0.5, 0.1]),
        coupled("coupling that fixes a coordinate", JointKind::Revolute, Vec::new()),
    ]
}
