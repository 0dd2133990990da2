//! A motion as MCAP for Foxglove and PlotJuggler: messages of ROS 2 with their definitions.
//!
//! | topic | message | how often |
//! | --- | --- | --- |
//! | `/joint_states` | `sensor_msgs/msg/JointState` | each sample |
//! | `/joint_trajectory` | `trajectory_msgs/msg/JointTrajectory` | each step of the program, at its start, with its samples |
//! | `/tf` | `tf2_msgs/msg/TFMessage` | each sample, with the frames that move then |
//! | `/program` | `std_msgs/msg/String` | each instruction at its start, as it is written |
//! | `/violations` | `std_msgs/msg/String` | each violation, when it begins |

mod cdr;

use std::collections::BTreeMap;
use std::io::Cursor;

use ::mcap::records::{MessageHeader, Metadata};
use ::mcap::{McapError, WriteOptions, Writer};
use jointplay_cell::trajectory::Sample;

use self::cdr::Cdr;
use super::error::Error;
use super::motion_export::MotionExport;
use super::scene::{Scene, is_key};

// Definitions of the messages, each with the definitions of its parts.
const JOINT_STATE: &str = "\
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
";
const JOINT_TRAJECTORY: &str = "\
std_msgs/Header header
string[] joint_names
trajectory_msgs/JointTrajectoryPoint[] points
";
const POINT: &str = "\
float64[] positions
float64[] velocities
float64[] accelerations
float64[] effort
builtin_interfaces/Duration time_from_start
";
const TF: &str = "geometry_msgs/TransformStamped[] transforms\n";
const TRANSFORM_STAMPED: &str = "\
std_msgs/Header header
string child_frame_id
geometry_msgs/Transform transform
";
const TRANSFORM: &str = "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n";
const VECTOR: &str = "float64 x\nfloat64 y\nfloat64 z\n";
const QUATERNION: &str = "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
const HEADER: &str = "builtin_interfaces/Time stamp\nstring frame_id\n";
const TIME: &str = "int32 sec\nuint32 nanosec\n";
const STRING: &str = "string data\n";

/// Frame to which all others refer.
const BASE: &str = "base";

impl From<McapError> for Error {
    fn from(_: McapError) -> Self {
        Self::Mcap
    }
}

/// An incomplete file.
struct File {
    writer: Writer<Cursor<Vec<u8>>>,
    sequence: u32,
}

/// The motion as an MCAP file; its clock begins at 0.
///
/// # Arguments
/// * `rate` – number of samples per second; the last sample is the end of the motion (Hz)
///
/// # Errors
/// [`Error::Rate`], [`Error::TooManySamples`], [`Error::TooManyPoses`], [`Error::Placing`], [`Error::Mcap`]
pub fn write(motion_export: &MotionExport<'_>, rate: f64) -> Result<Vec<u8>, Error> {
    motion_export.check_rate(rate)?;
    let samples: Vec<Sample> = motion_export.motion.samples(rate).collect();
    let times = samples.iter().map(|sample| sample.time).collect();
    let scene = Scene::at_times(motion_export, times, false)?;
    let options = WriteOptions::new()
        .compression(None)
        .profile("ros2")
        .library(concat!("jointplay ", env!("CARGO_PKG_VERSION")));
    let mut file = File { writer: options.create(Cursor::new(Vec::new()))?, sequence: 0 };
    let point = [("builtin_interfaces/Duration", TIME)];
    let states = file.topic(
        "/joint_states",
        "sensor_msgs/msg/JointState",
        JOINT_STATE,
        &[("std_msgs/Header", HEADER), ("builtin_interfaces/Time", TIME)],
    )?;
    let trajectory = file.topic(
        "/joint_trajectory",
        "trajectory_msgs/msg/JointTrajectory",
        JOINT_TRAJECTORY,
        &[
            ("std_msgs/Header", HEADER),
            ("builtin_interfaces/Time", TIME),
            ("trajectory_msgs/JointTrajectoryPoint", POINT),
            point[0],
        ],
    )?;
    let tf = file.topic(
        "/tf",
        "tf2_msgs/msg/TFMessage",
        TF,
        &[
            ("geometry_msgs/TransformStamped", TRANSFORM_STAMPED),
            ("std_msgs/Header", HEADER),
            ("builtin_interfaces/Time", TIME),
            ("geometry_msgs/Transform", TRANSFORM),
            ("geometry_msgs/Vector3", VECTOR),
            ("geometry_msgs/Quaternion", QUATERNION),
        ],
    )?;
    let program = file.topic("/program", "std_msgs/msg/String", STRING, &[])?;
    let violations = file.topic("/violations", "std_msgs/msg/String", STRING, &[])?;
    file.about(motion_export)?;

    let motion = motion_export.motion;
    let names: Vec<&str> =
        motion_export.cell.robot.axes.iter().map(|axis| axis.name.as_str()).collect();
    let mut violation_notes: Vec<_> = motion_export.violation_notes.iter().collect();
    violation_notes.sort_by(|a, b| a.from.total_cmp(&b.from));
    let mut violation_notes = violation_notes.into_iter().peekable();
    let mut step = 0;
    for (k, sample) in samples.iter().enumerate() {
        while step < motion.steps.len() && motion.times[step] <= sample.time {
            let start = motion.times[step];
            let before = step.checked_sub(1).map(|before| motion.steps[before].instruction);
            if before != Some(motion.steps[step].instruction) {
                file.push(program, start, text(motion_export.line(step)))?;
            }
            let of_step = [start, motion.times[step + 1]];
            if motion.has_duration(step) {
                file.push(
                    trajectory,
                    start,
                    joint_trajectory(motion_export, &names, of_step, &samples[k..]),
                )?;
            }
            step += 1;
        }
        while let Some(violation_note) =
            violation_notes.next_if(|violation_note| violation_note.from <= sample.time)
        {
            file.push(violations, violation_note.from, text(&violation_note.message))?;
        }
        file.push(states, sample.time, joint_state(&names, sample))?;
        file.push(tf, sample.time, transforms(&scene, k))?;
    }
    file.writer.finish()?;
    Ok(file.writer.into_inner().into_inner())
}

impl File {
    fn topic(
        &mut self,
        topic: &str,
        name: &str,
        definition: &str,
        parts: &[(&str, &str)],
    ) -> Result<u16, Error> {
        let rule = "=".repeat(80);
        let parts = parts.iter().map(|(name, text)| format!("{rule}\nMSG: {name}\n{text}"));
        let definition = definition.to_owned() + &parts.collect::<String>();
        let schema = self.writer.add_schema(name, "ros2msg", definition.as_bytes())?;
        Ok(self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?)
    }

    /// Writes name and duration of the motion, and a warning if it has violations.
    fn about(&mut self, motion_export: &MotionExport<'_>) -> Result<(), Error> {
        let mut metadata = BTreeMap::from([
            ("cell".to_owned(), motion_export.cell.name.clone()),
            ("duration_s".to_owned(), motion_export.motion.duration().to_string()),
        ]);
        if let Some(warning) = motion_export.warning() {
            metadata.insert("warning".to_owned(), warning);
        }
        Ok(self.writer.write_metadata(&Metadata { name: "jointplay".to_owned(), metadata })?)
    }

    fn push(&mut self, channel_id: u16, time: f64, message: Vec<u8>) -> Result<(), Error> {
        let (sec, nanosec) = cdr::split(time);
        let log_time = u64::try_from(sec).unwrap_or(0) * 1_000_000_000 + u64::from(nanosec);
        let header =
            MessageHeader { channel_id, sequence: self.sequence, log_time, publish_time: log_time };
        self.sequence = self.sequence.wrapping_add(1);
        Ok(self.writer.write_to_known_channel(&header, &message)?)
    }
}

fn text(text: &str) -> Vec<u8> {
    let mut message = Cdr::new();
    message.string(text);
    message.finish()
}

fn joint_state(names: &[&str], sample: &Sample) -> Vec<u8> {
    let mut message = Cdr::new();
    message.header(sample.time, BASE);
    message.strings(names);
    message.numbers(&sample.positions);
    message.numbers(&sample.velocities);
    message.numbers(&[]);
    message.finish()
}

/// The samples within a step, including its exact ends.
fn joint_trajectory(
    motion_export: &MotionExport<'_>,
    names: &[&str],
    [start, end]: [f64; 2],
    from_here: &[Sample],
) -> Vec<u8> {
    let within =
        from_here.iter().skip_while(|one| one.time <= start).take_while(|one| one.time < end);
    let ends = [motion_export.motion.sample_at(start), motion_export.motion.sample_at(end)];
    let points: Vec<&Sample> =
        std::iter::once(&ends[0]).chain(within).chain(std::iter::once(&ends[1])).collect();
    let mut message = Cdr::new();
    message.header(start, BASE);
    message.strings(names);
    message.count(points.len());
    for point in points {
        message.numbers(&point.positions);
        message.numbers(&point.velocities);
        message.numbers(&point.accelerations);
        message.numbers(&[]);
        message.time(point.time - start);
    }
    message.finish()
}

/// The frames that move at sample `k`; all frames at the first sample.
fn transforms(scene: &Scene, k: usize) -> Vec<u8> {
    let moving: Vec<_> = scene
        .tracks
        .iter()
        .filter(|track| is_key(&track.places, k) || is_key(&track.turns, k))
        .collect();
    let mut message = Cdr::new();
    message.count(moving.len());
    for track in moving {
        let parent = track.parent.map_or(BASE, |parent| &scene.tracks[parent].name);
        message.header(scene.times[k], parent);
        message.string(&track.name);
        message.fixed(&track.places[k]);
        message.fixed(&track.turns[k]);
    }
    message.finish()
}
