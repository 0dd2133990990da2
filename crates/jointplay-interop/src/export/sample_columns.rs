//! Columns of the table of samples, chosen by name or group.

use jointplay_cell::EntityId;
use jointplay_cell::robot::{AxisKind, ChainPose, EffectorId, RODS};
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Pose;
use jointplay_format::place::nearest;

use super::error::Error;

/// A column of the table of samples.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleColumn {
    /// Name with its unit, such as `q1_mm`.
    pub name: String,
    /// Meaning of the values.
    pub meaning: String,
    /// Groups that contain the column.
    pub groups: Vec<String>,
    pub(super) quantity: Quantity,
}

/// Quantity of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Quantity {
    Time,
    Line,
    Step,
    Axis {
        axis: usize,
        derivative: Derivative,
    },
    Frame {
        frame: RobotFrame,
        quantity: FrameQuantity,
    },
    /// A part of the unit quaternion w, x, y, z of a frame.
    Quaternion {
        frame: RobotFrame,
        part: usize,
    },
    /// Displacement of the virtual joints of the platform.
    VirtualDisplacement,
    Speed(EffectorId),
    Acceleration(EffectorId),
    Loaded(EffectorId),
    /// Share of the largest tilt of the platform.
    TiltShare,
    /// Share of the available friction that a held wafer needs.
    FrictionShare(EffectorId),
    Violations,
}

/// Frame that moves with the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum RobotFrame {
    Rod(usize),
    Platform,
    Link { arm: usize, link: usize },
    Wafer(EffectorId),
}

impl RobotFrame {
    /// Its pose in the base frame.
    pub(super) fn of(self, cell: &Cell, pose: &ChainPose) -> Pose {
        match self {
            Self::Rod(k) => {
                let base = cell.robot.gpr.base_points()[k];
                Pose::translation(base.x, base.y, pose.platform.rods[k])
            }
            Self::Platform => pose.platform.base_from_platform,
            Self::Link { arm, link } => pose.base_from_link[arm][link],
            Self::Wafer(EffectorId { arm, effector }) => pose.base_from_wafer[arm][effector],
        }
    }
}

/// Frames of a robot with their names: rods, platform, links, then effectors with the frames of their wafers.
pub(super) fn robot_frames(cell: &Cell) -> Vec<(String, RobotFrame)> {
    let robot = &cell.robot;
    let rods = (0..RODS).map(|k| (robot.axes[k].name.clone(), RobotFrame::Rod(k)));
    let platform = std::iter::once(("platform".to_owned(), RobotFrame::Platform));
    let links = robot.arms.iter().enumerate().flat_map(|(arm, described)| {
        let links = 0..described.joints.len();
        links.map(move |link| {
            let name = cell.entity_name(EntityId::Link { arm, link });
            (name, RobotFrame::Link { arm, link })
        })
    });
    let wafers = robot
        .effectors()
        .map(|id| (cell.entity_name(EntityId::Effector(id)), RobotFrame::Wafer(id)));
    rods.chain(platform).chain(links).chain(wafers).collect()
}

/// Derivative of the position of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Derivative {
    Position,
    Velocity,
    Acceleration,
    Jerk,
}

/// Number of a frame in the base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FrameQuantity {
    X,
    Y,
    Z,
    /// Rotation about the normal: heading of a wafer, torsion of the platform.
    Heading,
    Tilt,
    TiltAzimuth,
}

/// Group of the columns of a table without a choice.
pub const DEFAULT_COLUMNS: &str = "default";

/// Group of the columns of poses.
pub const POSE_COLUMNS: &str = "poses";

/// Groups with their meaning; in addition, the name of each axis, effector and column without its unit is a group.
pub const COLUMN_GROUPS: [(&str, &str); 19] = [
    (DEFAULT_COLUMNS, "columns without --columns"),
    ("all", "all columns"),
    ("time", "time"),
    ("program", "line of the program, and number of the step"),
    ("axes", "all columns of all axes"),
    ("positions", "position of each axis"),
    ("velocities", "velocity of each axis"),
    ("accelerations", "acceleration of each axis"),
    ("jerks", "jerk of each axis"),
    ("platform", "origin, torsion and tilt of the platform"),
    ("wafers", "all columns of all effectors"),
    (
        POSE_COLUMNS,
        "poses of rods, platform, links and wafers on effectors in the base frame: origin, and unit quaternion; and the displacement of the virtual joints",
    ),
    ("x", "x of each wafer centre"),
    ("y", "y of each wafer centre"),
    ("z", "z of each wafer centre"),
    ("heading", "heading of each effector's wafer"),
    ("tilt", "tilt angle and azimuth of the platform and of each effector's wafer"),
    ("speed", "speed and acceleration of each wafer centre"),
    (
        "budgets",
        "shares of the largest tilt of the platform and of the friction of each held wafer",
    ),
];

/// All columns that a table of samples of a cell can have, in their order.
#[must_use]
pub fn sample_columns(cell: &Cell) -> Vec<SampleColumn> {
    let mut columns = vec![
        column("time_s", "time", &[DEFAULT_COLUMNS, "time"], Quantity::Time),
        column("line", "line of the program", &[DEFAULT_COLUMNS, "program"], Quantity::Line),
        column("step", "number of the step", &[DEFAULT_COLUMNS, "program"], Quantity::Step),
    ];
    for (axis, described) in cell.robot.axes.iter().enumerate() {
        let name = &described.name;
        let unit = if described.kind == AxisKind::Rotary { "deg" } else { "mm" };
        for (derivative, suffix, group, what) in [
            (Derivative::Position, "", "positions", "position"),
            (Derivative::Velocity, "_per_s", "velocities", "velocity"),
            (Derivative::Acceleration, "_per_s2", "accelerations", "acceleration"),
            (Derivative::Jerk, "_per_s3", "jerks", "jerk"),
        ] {
            let mut groups = vec!["axes", group, name];
            if derivative != Derivative::Jerk {
                groups.push(DEFAULT_COLUMNS);
            }
            let meaning = format!("{what} of the axis {name}");
            let quantity = Quantity::Axis { axis, derivative };
            columns.push(column(&format!("{name}_{unit}{suffix}"), &meaning, &groups, quantity));
        }
    }
    let frames = robot_frames(cell);
    for (name, frame) in &frames {
        if matches!(frame, RobotFrame::Rod(_)) {
            columns.extend(pose_columns(name, &format!("rod {name}"), *frame));
        }
    }
    let platform = FrameTerms { name: "platform", what: "platform", rotation: "torsion" };
    let of_platform = |coordinate| match coordinate {
        "x" | "y" | "z" => vec!["platform", POSE_COLUMNS],
        // The groups of one coordinate concern wafers.
        "tilt" => vec!["platform", "tilt"],
        _ => vec!["platform"],
    };
    columns.extend(frame_columns(&platform, of_platform, RobotFrame::Platform));
    columns.extend(quaternion_columns("platform", "platform", &[], RobotFrame::Platform));
    let meaning = "tilt of the platform, as a share of its limit";
    columns.push(column(
        "platform_tilt_percent",
        meaning,
        &["budgets", "platform"],
        Quantity::TiltShare,
    ));
    columns.push(column(
        "virtual_displacement_um",
        "displacement of the virtual joints of the platform",
        &[POSE_COLUMNS],
        Quantity::VirtualDisplacement,
    ));
    for (name, frame) in &frames {
        if matches!(frame, RobotFrame::Link { .. }) {
            columns.extend(pose_columns(name, &format!("link {name}"), *frame));
        }
    }
    for effector in cell.robot.effectors() {
        let name = &cell.robot.arms[effector.arm].effectors[effector.effector].name;
        let what = format!("wafer on {name}");
        let wafer = FrameTerms { name, what: &what, rotation: "heading" };
        let of_wafer = |coordinate| {
            let mut groups = vec!["wafers", name, coordinate];
            if ["x", "y", "z"].contains(&coordinate) {
                groups.extend([DEFAULT_COLUMNS, POSE_COLUMNS]);
            }
            groups
        };
        let frame = RobotFrame::Wafer(effector);
        columns.extend(frame_columns(&wafer, of_wafer, frame));
        columns.extend(quaternion_columns(name, &what, &["wafers", name], frame));
        for (end, unit, meaning, quantity) in [
            ("speed", "_mm_per_s", "speed of the centre of the", Quantity::Speed(effector)),
            (
                "acceleration",
                "_mm_per_s2",
                "magnitude of the acceleration of the centre of the",
                Quantity::Acceleration(effector),
            ),
            ("loaded", "", "1 while there is a", Quantity::Loaded(effector)),
            (
                "friction",
                "_percent",
                "share of the available friction, 0 while there is no",
                Quantity::FrictionShare(effector),
            ),
        ] {
            let short = format!("{name}_{end}");
            let mut groups = vec!["wafers", name.as_str(), short.as_str()];
            match quantity {
                Quantity::Speed(_) | Quantity::Acceleration(_) => groups.push("speed"),
                Quantity::FrictionShare(_) => groups.push("budgets"),
                _ => {}
            }
            let meaning = format!("{meaning} {what}");
            columns.push(column(&format!("{short}{unit}"), &meaning, &groups, quantity));
        }
    }
    columns.push(column(
        "violations",
        "number of violations at this time",
        &[],
        Quantity::Violations,
    ));
    columns
}

fn column(name: &str, meaning: &str, groups: &[&str], quantity: Quantity) -> SampleColumn {
    let groups = groups.iter().map(|&group| group.to_owned()).collect();
    SampleColumn { name: name.to_owned(), meaning: meaning.to_owned(), groups, quantity }
}

/// Names of a frame.
struct FrameTerms<'n> {
    /// Name in columns.
    name: &'n str,
    /// Name in meanings.
    what: &'n str,
    /// Term for its rotation about its normal.
    rotation: &'static str,
}

/// The columns of a frame.
///
/// # Arguments
/// * `groups` – groups of a coordinate
fn frame_columns<'g>(
    &FrameTerms { name, what, rotation }: &FrameTerms<'_>,
    groups: impl Fn(&'static str) -> Vec<&'g str>,
    frame: RobotFrame,
) -> Vec<SampleColumn> {
    let columns = [
        ("x", "mm", "x", "x of the centre", FrameQuantity::X),
        ("y", "mm", "y", "y of the centre", FrameQuantity::Y),
        ("z", "mm", "z", "z of the centre", FrameQuantity::Z),
        (rotation, "deg", "heading", rotation, FrameQuantity::Heading),
        ("tilt", "deg", "tilt", "tilt angle", FrameQuantity::Tilt),
        ("tilt_azimuth", "deg", "tilt", "tilt azimuth", FrameQuantity::TiltAzimuth),
    ];
    let frame_column = |(end, unit, coordinate, meaning, kind)| {
        let short = format!("{name}_{end}");
        let meaning = format!("{meaning} of the {what}");
        let quantity = Quantity::Frame { frame, quantity: kind };
        let mut one = column(&format!("{short}_{unit}"), &meaning, &groups(coordinate), quantity);
        one.groups.push(short);
        one
    };
    columns.into_iter().map(frame_column).collect()
}

/// The columns of the pose of a frame without other columns: origin, and unit quaternion.
fn pose_columns(name: &str, what: &str, frame: RobotFrame) -> Vec<SampleColumn> {
    let axes =
        [("x", FrameQuantity::X), ("y", FrameQuantity::Y), ("z", FrameQuantity::Z)].into_iter();
    let origin = axes.map(|(axis, quantity)| {
        let meaning = format!("{axis} of the origin of the {what}");
        let quantity = Quantity::Frame { frame, quantity };
        let mut one = column(&format!("{name}_{axis}_mm"), &meaning, &[POSE_COLUMNS], quantity);
        one.groups.push(format!("{name}_{axis}"));
        one
    });
    origin.chain(quaternion_columns(name, what, &[], frame)).collect()
}

/// The columns of the unit quaternion of a frame.
///
/// # Arguments
/// * `groups` – groups other than that of poses
fn quaternion_columns(
    name: &str,
    what: &str,
    groups: &[&str],
    frame: RobotFrame,
) -> Vec<SampleColumn> {
    let groups = [groups, &[POSE_COLUMNS]].concat();
    let quaternion_column = |(part, letter): (usize, &str)| {
        let meaning = format!("{letter} of the unit quaternion of the {what}");
        let quantity = Quantity::Quaternion { frame, part };
        column(&format!("{name}_q{letter}"), &meaning, &groups, quantity)
    };
    ["w", "x", "y", "z"].into_iter().enumerate().map(quaternion_column).collect()
}

/// The columns of names and groups, in their order, each once.
///
/// # Errors
/// [`Error::UnknownColumn`]
pub fn select_columns(cell: &Cell, names: &[String]) -> Result<Vec<SampleColumn>, Error> {
    let all = sample_columns(cell);
    let mut selected: Vec<SampleColumn> = Vec::new();
    for name in names {
        let is_named = |column: &&SampleColumn| {
            name == "all" || column.name == *name || column.groups.contains(name)
        };
        let found: Vec<_> = all.iter().filter(is_named).collect();
        if found.is_empty() {
            return Err(unknown_column(name, &all));
        }
        for column in found {
            if !selected.contains(column) {
                selected.push(column.clone());
            }
        }
    }
    Ok(selected)
}

fn unknown_column(name: &str, all: &[SampleColumn]) -> Error {
    let columns: Vec<&str> = all.iter().map(|column| column.name.as_str()).collect();
    let groups = COLUMN_GROUPS.map(|(group, _)| group);
    let known = groups.into_iter().chain(columns.iter().copied());
    Error::UnknownColumn {
        found: name.to_owned(),
        nearest: nearest(name, known),
        groups: groups.join(", "),
        columns: columns.join(", "),
    }
}
