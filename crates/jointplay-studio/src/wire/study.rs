//! A motion and the requested quantities of its samples.

use jointplay::bulk::Quantity;
use jointplay::format::{json, steps};
use jointplay::gpr::{AxisHeight, Gpr};
use jointplay::spatial::Tilt;
use jointplay::study::{KeyMotion, KeyPose, Order, Raster};
use jointplay::virtualization::{VirtualJointKind, Virtualization};
use serde::Deserialize;
use serde_json::Value;
use utoipa::ToSchema;

use super::robot_file::RobotSource;
use super::{ModelChoice, length, tilt_angle};
use crate::problem::Problem;

/// Maximum number of samples of a study.
pub(crate) const MAX_SAMPLES: usize = 5_000_000;
/// Maximum number of key poses of a motion.
const MAX_KEYS: usize = 1000;

/// A motion and the requested quantities of its samples.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StudyRequest {
    /// Robot in place of that of this server.
    pub(crate) robot: Option<RobotSource>,
    /// A sequence of poses.
    pub(crate) motion: MotionFields,
    /// The model.
    #[serde(default)]
    #[schema(required = false)]
    pub(crate) model: ModelChoice,
    /// Quantities in addition to the command; default: all except sensitivity.
    pub(crate) quantities: Option<Vec<QuantityName>>,
}

/// A quantity of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum QuantityName {
    /// `q1_m` to `q3_m`.
    Rods,
    /// `L12_m`, `L23_m`, `L31_m`.
    Sides,
    /// Virtual joints by symbol and limb, such as `l1_m` and `phi1_rad`.
    VirtualJoints,
    /// `origin_x_m`, `origin_y_m`, `origin_z_m`; the first two are the centre shift.
    Origin,
    /// `torsion_rad`.
    Torsion,
    /// `displacement_m`: norm of the displacement of the virtual joints, in the metric.
    Displacement,
    /// `sensitivity_1` to `sensitivity_3`: singular values of ∂X/∂P in the metric.
    Sensitivity,
    /// `residual_m`.
    Residual,
    /// `iterations`.
    Iterations,
}

impl QuantityName {
    const USUAL: [Self; 8] = [
        Self::Rods,
        Self::Sides,
        Self::VirtualJoints,
        Self::Origin,
        Self::Torsion,
        Self::Displacement,
        Self::Residual,
        Self::Iterations,
    ];
}

/// A sequence of poses.
#[derive(ToSchema)]
#[serde(untagged)]
pub(crate) enum MotionChoice {
    /// A raster over azimuth and tilt angle.
    Raster(RasterMotion),
    /// A motion through key poses.
    Keys(KeysMotion),
}

// Read by its kind, so that errors name the inner field.
/// A sequence of poses.
#[derive(Deserialize, ToSchema)]
#[schema(value_type = MotionChoice)]
pub(crate) struct MotionFields(Value);

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum RasterKind {
    /// For each azimuth, all tilt angles from first to last, as in the paper.
    Raster,
    /// Every other azimuth in reverse order, continuous in time.
    Serpentine,
}

/// A raster over azimuth and tilt angle; defaults are those of the paper.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RasterMotion {
    /// Order of the poses.
    kind: RasterKind,
    /// Azimuth angles, in degrees so that steps are exact decimals; default: 0 to 360 by 10 (deg).
    azimuth_deg: Option<Steps>,
    /// Tilt angles; default: -2 to 2 by 0.2 (deg).
    tilt_deg: Option<Steps>,
    /// Height at which the platform plane crosses the base axis; default: the working height of the robot (m).
    #[schema(minimum = -1000, maximum = 1000)]
    axis_height_m: Option<f64>,
}

/// Evenly spaced values, both ends included.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Steps {
    /// First value.
    from: f64,
    /// Last value.
    to: f64,
    /// Step; it must divide the range.
    step: f64,
}

#[derive(Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum KeysKind {
    Keys,
}

/// A motion through key poses, at rest in each of them.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct KeysMotion {
    /// Kind of the motion.
    #[expect(dead_code, reason = "read before the other fields")]
    kind: KeysKind,
    /// The key poses.
    #[schema(min_items = 2, max_items = 1000)]
    keys: Vec<KeyFields>,
    /// Minimum sampling rate (Hz).
    #[schema(exclusive_minimum = 0, maximum = 100000)]
    rate_hz: f64,
}

/// A key pose.
#[derive(Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct KeyFields {
    /// Tilt about x (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    about_x_rad: f64,
    /// Tilt about y (rad).
    #[schema(minimum = -1.1, maximum = 1.1)]
    about_y_rad: f64,
    /// Height at which the platform plane crosses the base axis; default: the working height of the robot (m).
    #[schema(minimum = -1000, maximum = 1000)]
    axis_height_m: Option<f64>,
    /// Duration of the motion from the previous pose; ignored for the first pose (s).
    #[schema(minimum = 0, maximum = 100000)]
    duration_s: f64,
}

/// The samples of a study.
pub(crate) enum Samples {
    /// Of a raster.
    Raster(Raster),
    /// Of a motion in time.
    Keys(KeyMotion),
}

/// A commanded pose.
pub(crate) struct Commanded {
    /// Time, for a motion with time stamps (s).
    pub(crate) time: f64,
    /// Tilt of the platform.
    pub(crate) tilt: Tilt,
    /// Height at which the platform plane crosses the base axis.
    pub(crate) height: AxisHeight,
}

impl MotionFields {
    /// Checks the motion at `field`.
    pub(crate) fn read(self, gpr: &Gpr, field: &str) -> Result<Samples, Problem> {
        let Self(value) = self;
        let kind = json::kind(&value, field, &["raster", "serpentine", "keys"])?;
        let choice = match kind {
            "keys" => MotionChoice::Keys(json::read_value(value, field)?),
            _ => MotionChoice::Raster(json::read_value(value, field)?),
        };
        let samples = match choice {
            MotionChoice::Raster(found) => Samples::Raster(raster(found, gpr, field)?),
            MotionChoice::Keys(found) => Samples::Keys(keys(found, gpr, field)?),
        };
        let found = samples.len();
        if found > MAX_SAMPLES {
            let detail = format!(
                "the motion has {found} samples, at most {MAX_SAMPLES} are allowed: use larger steps"
            );
            return Err(Problem::field(field, detail));
        }
        Ok(samples)
    }
}

fn raster(found: RasterMotion, gpr: &Gpr, field: &str) -> Result<Raster, Problem> {
    let spread = |steps: Option<Steps>, usual: [f64; 3], name: &str| {
        let [from, to, step] = steps.map_or(usual, |steps| [steps.from, steps.to, steps.step]);
        steps::spread(from, to, step)
            .map_err(|error| Problem::field(format!("{field}.{name}"), error.to_string()))
    };
    let radians = |degrees: Vec<f64>| degrees.into_iter().map(f64::to_radians).collect();
    let azimuths: Vec<f64> = radians(spread(found.azimuth_deg, [0.0, 360.0, 10.0], "azimuth_deg")?);
    let tilt_angles: Vec<f64> = radians(spread(found.tilt_deg, [-2.0, 2.0, 0.2], "tilt_deg")?);
    for &end in [tilt_angles.first(), tilt_angles.last()].into_iter().flatten() {
        tilt_angle(end, &format!("{field}.tilt_deg"))?;
    }
    Ok(Raster {
        azimuths,
        tilt_angles,
        height: height(found.axis_height_m, gpr, &format!("{field}.axis_height_m"))?,
        order: match found.kind {
            RasterKind::Raster => Order::Raster,
            RasterKind::Serpentine => Order::Serpentine,
        },
    })
}

fn keys(found: KeysMotion, gpr: &Gpr, field: &str) -> Result<KeyMotion, Problem> {
    if found.keys.len() > MAX_KEYS {
        let detail =
            format!("{} key poses are given, at most {MAX_KEYS} are allowed", found.keys.len());
        return Err(Problem::field(format!("{field}.keys"), detail));
    }
    let keys = found.keys.iter().enumerate().map(|(k, key)| {
        let at = |name: &str| format!("{field}.keys[{k}].{name}");
        let about_x = tilt_angle(key.about_x_rad, &at("about_x_rad"))?;
        let about_y = tilt_angle(key.about_y_rad, &at("about_y_rad"))?;
        let tilt = Tilt::from_about_x_and_y(about_x, about_y);
        tilt_angle(tilt.angle, &format!("{field}.keys[{k}]"))?;
        let height = height(key.axis_height_m, gpr, &at("axis_height_m"))?;
        Ok(KeyPose { tilt, height, duration: key.duration_s })
    });
    let keys = keys.collect::<Result<_, Problem>>()?;
    KeyMotion::new(keys, found.rate_hz).map_err(|error| Problem::field(field, error.to_string()))
}

fn height(asked: Option<f64>, gpr: &Gpr, field: &str) -> Result<AxisHeight, Problem> {
    length(asked.unwrap_or(gpr.working_height()), field).map(AxisHeight)
}

impl Samples {
    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Raster(raster) => raster.azimuths.len().saturating_mul(raster.tilt_angles.len()),
            Self::Keys(motion) => motion.samples(),
        }
    }

    /// Whether the motion has time stamps.
    pub(crate) fn timed(&self) -> bool {
        matches!(self, Self::Keys(_))
    }

    /// The commanded poses, in order.
    pub(crate) fn commanded(&self) -> Box<dyn Iterator<Item = Commanded> + '_> {
        match self {
            Self::Raster(raster) => Box::new(raster.tilts().map(|tilt| Commanded {
                time: 0.0,
                tilt,
                height: raster.height,
            })),
            Self::Keys(motion) => Box::new((0..motion.samples()).map(|sample| {
                let time = motion.time(sample);
                let (tilt, height) = motion.tilt_and_height_at(time);
                Commanded { time, tilt, height }
            })),
        }
    }
}

/// One column of a study.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ColumnName {
    /// Its name, with its unit at the end if it has one.
    pub(crate) name: String,
    /// Contents.
    pub(crate) source: Source,
}

/// Contents of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Source {
    /// Time (s).
    Time,
    /// Commanded azimuth (rad).
    Azimuth,
    /// Commanded tilt angle (rad).
    TiltAngle,
    /// Commanded height (m).
    Height,
    /// A rod (m).
    Rod(usize),
    /// Result of the model, in SI units.
    Model(Quantity),
}

/// The columns of a study, in order, without the status.
pub(crate) fn columns(
    samples: &Samples,
    model: &(dyn Virtualization + Sync),
    wanted: Option<&[QuantityName]>,
) -> Vec<ColumnName> {
    let mut columns = Vec::new();
    let mut add = |name: String, source| columns.push(ColumnName { name, source });
    if samples.timed() {
        add("time_s".to_owned(), Source::Time);
    }
    add("azimuth_rad".to_owned(), Source::Azimuth);
    add("tilt_rad".to_owned(), Source::TiltAngle);
    add("axis_height_m".to_owned(), Source::Height);
    let wanted = wanted.unwrap_or(&QuantityName::USUAL);
    let all = QuantityName::USUAL.into_iter().chain([QuantityName::Sensitivity]);
    for name in all.filter(|name| wanted.contains(name)) {
        let mut add_result = |name: &str, quantity| add(name.to_owned(), Source::Model(quantity));
        match name {
            QuantityName::Rods => {
                (0..3).for_each(|k| add(format!("q{}_m", k + 1), Source::Rod(k)));
            }
            QuantityName::Sides => {
                for (k, name) in ["L12_m", "L23_m", "L31_m"].into_iter().enumerate() {
                    add_result(name, Quantity::Side(k));
                }
            }
            QuantityName::VirtualJoints => {
                for (k, joint) in model.joints().iter().enumerate() {
                    let unit = match joint.motion {
                        VirtualJointKind::Linear => "m",
                        VirtualJointKind::Angular => "rad",
                    };
                    let name = format!("{}{}_{unit}", joint.symbol, joint.limb + 1);
                    add_result(&name, Quantity::VirtualJoint(k));
                }
            }
            QuantityName::Origin => {
                for (k, name) in ["origin_x_m", "origin_y_m", "origin_z_m"].into_iter().enumerate()
                {
                    add_result(name, Quantity::Origin(k));
                }
            }
            QuantityName::Torsion => add_result("torsion_rad", Quantity::Torsion),
            QuantityName::Displacement => add_result("displacement_m", Quantity::Displacement),
            QuantityName::Sensitivity => {
                (0..3).for_each(|k| {
                    add_result(&format!("sensitivity_{}", k + 1), Quantity::Sensitivity(k))
                });
            }
            QuantityName::Residual => add_result("residual_m", Quantity::Residual),
            QuantityName::Iterations => add_result("iterations", Quantity::Iterations),
        }
    }
    columns
}
