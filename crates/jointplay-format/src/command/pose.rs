//! Commands to the pose of a link or frame: `platform: tilt 1 about [1, 1, 0]; move by [_, _, 2]`.

use jointplay_core::mechanism::joint::Coordinate;
use jointplay_core::mechanism::{FrameId, FramePath, FrameTarget, Mechanism, OrientationTarget};
use jointplay_core::spatial::{Pose, tilt_rotation};
use nalgebra::{Rotation3, Unit, Vector3};

use super::names::Names;
use super::problem::Error;
use super::value::CommandValue;
use crate::coordinates;
use crate::number::{number, rounded};

/// Cosine of the angle between the axis of a tilt and the z axis of a frame, up to which they are perpendicular.
const PERPENDICULAR: f64 = 1e-9;

/// Command to the pose of a link or an attached frame, relative to its pose in the closed configuration of the file.
///
/// | command | meaning |
/// | --- | --- |
/// | `tilt 1 about [1, 1, 0]` | rotate the z axis of the frame about an axis perpendicular to it, given in the base frame; the rotation about the z axis itself is free |
/// | `tilt 1 toward 30` | tilt the z axis toward an azimuth |
/// | `precess 1` | tilt toward the azimuth `t`, which runs round |
/// | `turn 5 about [0, 0, 1]` | rotate the frame; all its angles are commanded |
/// | `move by [0, 0, 2]` | displace the origin; `_` for a free coordinate |
/// | `move to [0, 0, 120]` | place the origin in the base frame |
///
/// `tilt`, `precess` and `turn` exclude each other; one of them and one `move` may be joined by `;`.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseCommand {
    frame: FrameId,
    text: String,
    rotation: Option<Rotation>,
    displacement: Option<Displacement>,
}

#[derive(Debug, Clone, PartialEq)]
struct Rotation {
    kind: RotationKind,
    angle: CommandValue,
}

#[derive(Debug, Clone, PartialEq)]
enum RotationKind {
    TiltAbout([CommandValue; 3]),
    TiltToward(CommandValue),
    TurnAbout([CommandValue; 3]),
}

#[derive(Debug, Clone, PartialEq)]
struct Displacement {
    /// Whether the values count from home.
    relative: bool,
    values: [Option<CommandValue>; 3],
}

/// Words of a command, for messages.
const FORM: &str = "tilt ANGLE about [X, Y, Z], tilt ANGLE toward AZIMUTH, precess ANGLE, turn ANGLE about [X, Y, Z], move by [X, Y, Z] or move to [X, Y, Z]";

impl PoseCommand {
    /// Parses `FRAME: COMMAND` or `FRAME: COMMAND; COMMAND`.
    ///
    /// # Errors
    /// [`Error`]
    pub fn parse(text: &str, mechanism: &Mechanism, names: &Names<'_>) -> Result<Self, Error> {
        let invalid = || Error::Pose { text: text.trim().to_owned(), expected: FORM };
        let (name, commands) = text.rsplit_once(':').ok_or_else(invalid)?;
        let frame = coordinates::frame(mechanism, name.trim())?;
        if mechanism.link_of_frame(frame) == 0 {
            return Err(Error::BaseCommanded { name: name.trim().to_owned() });
        }
        let mut command =
            Self { frame, text: text.trim().to_owned(), rotation: None, displacement: None };
        for part in commands.split(';').map(str::trim) {
            let (word, rest) = part.split_once(char::is_whitespace).ok_or_else(invalid)?;
            let rotation = match word {
                "tilt" => match (split(rest, " about "), split(rest, " toward ")) {
                    (Some((angle, axis)), _) => {
                        let kind =
                            RotationKind::TiltAbout(vector(axis, names)?.ok_or_else(invalid)?);
                        Some((kind, angle))
                    }
                    (None, Some((angle, azimuth))) => Some((
                        RotationKind::TiltToward(CommandValue::parse(azimuth, names)?),
                        angle,
                    )),
                    (None, None) => return Err(invalid()),
                },
                "precess" => {
                    let variable = names.variable().unwrap_or("t");
                    let azimuth = CommandValue::parse(variable, names)?;
                    Some((RotationKind::TiltToward(azimuth), rest))
                }
                "turn" => {
                    let (angle, axis) = split(rest, " about ").ok_or_else(invalid)?;
                    let kind = RotationKind::TurnAbout(vector(axis, names)?.ok_or_else(invalid)?);
                    Some((kind, angle))
                }
                "move" => {
                    let (relative, values) = match rest.trim().split_once(char::is_whitespace) {
                        Some(("by", values)) => (true, values),
                        Some(("to", values)) => (false, values),
                        _ => return Err(invalid()),
                    };
                    let values = elements(values).ok_or_else(invalid)?;
                    let parse = |text: &str| match text {
                        "_" => Ok(None),
                        text => CommandValue::parse(text, names).map(Some),
                    };
                    let [x, y, z] = values.map(parse);
                    let values = [x?, y?, z?];
                    if command.displacement.is_some() || values.iter().all(Option::is_none) {
                        return Err(invalid());
                    }
                    command.displacement = Some(Displacement { relative, values });
                    None
                }
                _ => return Err(invalid()),
            };
            if let Some((kind, angle)) = rotation {
                if command.rotation.is_some() {
                    return Err(invalid());
                }
                let angle = CommandValue::parse(angle, names)?;
                command.rotation = Some(Rotation { kind, angle });
            }
        }
        Ok(command)
    }

    /// The frame.
    #[must_use]
    pub fn frame(&self) -> FrameId {
        self.frame
    }

    /// The text that was parsed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether it depends on the variable of `names`.
    #[must_use]
    pub fn varies(&self, names: &Names<'_>) -> bool {
        self.values().any(|value| value.varies(names))
    }

    /// Whether a name occurs in it.
    #[must_use]
    pub fn uses(&self, name: &str) -> bool {
        self.values().any(|value| value.uses(name))
    }

    fn values(&self) -> impl Iterator<Item = &CommandValue> {
        let rotation = self.rotation.iter().flat_map(|rotation| {
            let of_kind: &[CommandValue] = match &rotation.kind {
                RotationKind::TiltAbout(axis) | RotationKind::TurnAbout(axis) => axis,
                RotationKind::TiltToward(azimuth) => std::slice::from_ref(azimuth),
            };
            of_kind.iter().chain([&rotation.angle])
        });
        let displacement = self.displacement.iter().flat_map(|one| one.values.iter().flatten());
        rotation.chain(displacement)
    }

    /// The commanded pose.
    ///
    /// # Arguments
    /// * `home` – pose of the frame in the closed configuration of the file, in the base frame (m)
    /// * `at` – value of the variable
    /// * `share` – share of the command that is done, from 0 for home to 1
    ///
    /// # Errors
    /// [`Error`]
    pub fn target(
        &self,
        home: &Pose,
        names: &Names<'_>,
        at: f64,
        share: f64,
    ) -> Result<FrameTarget, Error> {
        let mut target = FrameTarget { position: [None; 3], orientation: OrientationTarget::Free };
        if let Some(Rotation { kind, angle }) = &self.rotation {
            let angle = share * angle.evaluate(Coordinate::Turn, names, at)?;
            let z = home.rotation * Vector3::z();
            target.orientation = match kind {
                RotationKind::TurnAbout(axis) => {
                    let axis = self.direction(axis, names, at)?;
                    let turn = Rotation3::from_axis_angle(&axis, angle);
                    OrientationTarget::Full(turn * home.rotation)
                }
                RotationKind::TiltAbout(axis) => {
                    let axis = self.direction(axis, names, at)?;
                    if axis.dot(&z).abs() > PERPENDICULAR {
                        let text = self.text.clone();
                        return Err(Error::AxisNotPerpendicular { text, z: z.into() });
                    }
                    let turn = Rotation3::from_axis_angle(&axis, angle);
                    OrientationTarget::Normal(Unit::new_normalize(turn * z))
                }
                RotationKind::TiltToward(azimuth) => {
                    let azimuth = azimuth.evaluate(Coordinate::Turn, names, at)?;
                    let toward =
                        tilt_rotation(&z) * Vector3::new(azimuth.cos(), azimuth.sin(), 0.0);
                    let normal = z * angle.cos() + toward * angle.sin();
                    OrientationTarget::Normal(Unit::new_normalize(normal))
                }
            };
        }
        if let Some(Displacement { relative, values }) = &self.displacement {
            for (k, value) in values.iter().enumerate() {
                let Some(value) = value else { continue };
                let value = value.evaluate(Coordinate::Slide, names, at)?;
                let here = home.translation.vector[k];
                let by = if *relative { value } else { value - here };
                target.position[k] = Some(here + share * by);
            }
        }
        Ok(target)
    }

    /// The command whose end is the target at a share of this one, with numbers in the units of the file.
    ///
    /// # Errors
    /// [`Error`]
    pub fn at_share(
        &self,
        home: &Pose,
        names: &Names<'_>,
        at: f64,
        share: f64,
    ) -> Result<String, Error> {
        let mut parts = Vec::new();
        if let Some(Rotation { kind, angle }) = &self.rotation {
            let in_file = |radians: f64| rounded(names.units().angle.from_radians(radians), 6);
            let angle = in_file(share * angle.evaluate(Coordinate::Turn, names, at)?);
            let listed = |axis: &[CommandValue; 3]| {
                let [x, y, z] = axis.each_ref().map(|value| value.number(names, at));
                Ok::<_, Error>(format!("[{}, {}, {}]", number(x?), number(y?), number(z?)))
            };
            parts.push(match kind {
                RotationKind::TiltAbout(axis) => format!("tilt {angle} about {}", listed(axis)?),
                RotationKind::TurnAbout(axis) => format!("turn {angle} about {}", listed(axis)?),
                RotationKind::TiltToward(azimuth) => {
                    let azimuth = azimuth.evaluate(Coordinate::Turn, names, at)?;
                    format!("tilt {angle} toward {}", in_file(azimuth))
                }
            });
        }
        if self.displacement.is_some() {
            let position = self.target(home, names, at, share)?.position;
            let [x, y, z] = position.map(|value| match value {
                Some(value) => rounded(names.units().length.from_meters(value), 6),
                None => "_".to_owned(),
            });
            parts.push(format!("move to [{x}, {y}, {z}]"));
        }
        let name = self.text.rsplit_once(':').map_or("", |(name, _)| name);
        Ok(format!("{name}: {}", parts.join("; ")))
    }

    fn direction(
        &self,
        axis: &[CommandValue; 3],
        names: &Names<'_>,
        at: f64,
    ) -> Result<Unit<Vector3<f64>>, Error> {
        let [x, y, z] = axis.each_ref().map(|value| value.number(names, at));
        let axis = Vector3::new(x?, y?, z?);
        let largest = axis.amax();
        let unit = (largest > 0.0).then(|| Unit::new_normalize(axis / largest));
        unit.ok_or_else(|| Error::NoAxis { text: self.text.clone() })
    }
}

/// A point of a path of poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PosePoint {
    /// Value of the variable.
    pub at: f64,
    /// Share of the command that is done, 0 to 1.
    pub share: f64,
}

/// The paths of commanded frames through points.
///
/// # Arguments
/// * `home` – pose of the frame of each command in the closed configuration of the file, in the base frame (m)
///
/// # Errors
/// [`Error::CommandedTwice`], and those of [`PoseCommand::target`].
pub fn frame_paths(
    commands: &[PoseCommand],
    home: &[Pose],
    names: &Names<'_>,
    points: &[PosePoint],
) -> Result<Vec<FramePath>, Error> {
    let mut paths: Vec<FramePath> = Vec::with_capacity(commands.len());
    for (command, home) in commands.iter().zip(home) {
        if paths.iter().any(|path| path.frame == command.frame) {
            return Err(Error::CommandedTwice { text: command.text.clone() });
        }
        let target = |point: &PosePoint| command.target(home, names, point.at, point.share);
        let targets = points.iter().map(target).collect::<Result<_, Error>>()?;
        paths.push(FramePath { frame: command.frame, targets });
    }
    Ok(paths)
}

/// The parts before and after a word.
fn split<'t>(text: &'t str, word: &str) -> Option<(&'t str, &'t str)> {
    text.split_once(word)
}

/// The texts of `[X, Y, Z]`.
fn elements(text: &str) -> Option<[&str; 3]> {
    let inner = text.trim().strip_prefix('[')?.strip_suffix(']')?;
    let mut depth = 0_usize;
    let parts: Vec<&str> = inner
        .split(|character: char| {
            match character {
                '(' => depth += 1,
                ')' => depth = depth.saturating_sub(1),
                _ => {}
            }
            depth == 0 && character == ','
        })
        .map(str::trim)
        .collect();
    parts.try_into().ok()
}

fn vector(text: &str, names: &Names<'_>) -> Result<Option<[CommandValue; 3]>, Error> {
    let Some(parts) = elements(text) else { return Ok(None) };
    let [x, y, z] = parts.map(|part| CommandValue::parse(part, names));
    Ok(Some([x?, y?, z?]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{MechanismFile, parse};

    fn file() -> MechanismFile {
        parse(crate::catalogue::find("gpr-mechanism").unwrap().text).unwrap()
    }

    fn target(text: &str, at: f64, share: f64) -> Result<FrameTarget, Error> {
        let file = file();
        let names = Names::of(&file).with_variable("t")?;
        let home = Pose::translation(0.0, 0.0, 0.1);
        PoseCommand::parse(text, &file.mechanism, &names)?.target(&home, &names, at, share)
    }

    #[test]
    fn tilts_turns_and_displacements_have_their_geometry() {
        let normal = |text: &str, at: f64| match target(text, at, 1.0).unwrap().orientation {
            OrientationTarget::Normal(normal) => normal.into_inner(),
            other => panic!("{other:?}"),
        };
        let (sin, cos) = 1_f64.to_radians().sin_cos();
        let about_x = normal("platform: tilt 1 about [1, 0, 0]", 0.0);
        assert!((about_x - Vector3::new(0.0, -sin, cos)).norm() < 1e-15);
        assert!((normal("platform: tilt 1 toward -90", 0.0) - about_x).norm() < 1e-15);
        assert!((normal("platform: precess 1", -90.0) - about_x).norm() < 1e-15);
        let moved =
            target("platform: turn 90 about [0, 0, 2]; move by [_, 1, 2*t]", 3.0, 0.5).unwrap();
        assert_eq!(moved.position[0], None);
        assert!((moved.position[2].unwrap() - 0.103).abs() < 1e-15);
        let OrientationTarget::Full(turn) = moved.orientation else { panic!() };
        assert!((turn.angle() - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
        let placed = target("platform: move to [_, _, max(1, 110)]", 0.0, 1.0).unwrap();
        assert_eq!(placed.position, [None, None, Some(0.11)]);
    }

    #[test]
    fn texts_that_are_no_commands_are_refused() {
        let refuse = |text: &str, message: &str| {
            let error = target(text, 0.0, 1.0).unwrap_err().to_string();
            assert!(error.contains(message), "{text}: {error}");
        };
        refuse("platform", "expected FRAME: COMMAND");
        refuse("platfrom: tilt 1 toward 0", "did you mean `platform`?");
        refuse("base: tilt 1 toward 0", "the base does not move");
        refuse("platform: tilt 1", "expected FRAME: COMMAND");
        refuse("platform: tilt 1 about [0, 0, 1]", "is not perpendicular to the z axis");
        refuse("platform: tilt 1 about [0, 0, 0]", "the axis is zero");
        refuse("platform: tilt 1 mm toward 0", "the value is an angle, but mm");
        refuse("platform: tilt 1 toward 0; turn 1 about [1, 0, 0]", "expected FRAME");
        refuse("platform: move by [_, _, _]", "expected FRAME");
        refuse("platform: move by [1, 2]", "expected FRAME");
        refuse("platform: move by [1, 2, 1/0]", "infinite");
        refuse("platform: tilt qq toward 0", "unknown name `qq`");
    }
}
