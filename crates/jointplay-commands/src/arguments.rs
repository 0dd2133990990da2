//! Flags shared by several commands, and the parsers of their values.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jointplay::format::number::number;
use jointplay::format::units::m_from_mm;
use jointplay::format::{robot, steps};
use jointplay::gpr::{AxisHeight, BrokenLimit, Gpr};
use jointplay::spatial::Tilt;
use jointplay::virtualization::{
    BuiltIn, Metric, Offset, Planar, Polar, Radial, SolveOptions, Solver, Virtualization,
};

use crate::failure::Failure;
pub(crate) use crate::finite::finite;
use crate::output::FormatArgs;
use crate::set_args::SetArgs;
use crate::source::{Kind, Source};

/// Largest accepted robot file (bytes).
const LARGEST_ROBOT_FILE: usize = 1_000_000;

#[derive(Args)]
pub(crate) struct RobotArgs {
    /// Robot file (TOML), or a name from `jointplay catalogue` [default: the paper's robot]
    #[arg(long, value_name = "FILE")]
    pub(crate) robot: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) set: SetArgs,
}

impl RobotArgs {
    pub(crate) fn load(&self) -> Result<robot::Robot, Failure> {
        let Some(path) = &self.robot else {
            self.set.refuse("--set needs a file: use --robot for a robot file")?;
            return Ok(robot::paper());
        };
        let source = Self::read(path)?;
        robot::parse_with(&source.text, &self.set.replaced())
            .map_err(|errors| Failure::invalid(&errors, &source.label))
    }

    fn read(path: &Path) -> Result<Source, Failure> {
        let source = Source::read(path, LARGEST_ROBOT_FILE)?;
        source.require(&[Kind::ThreeRods], "a three-rod robot")?;
        Ok(source)
    }

    /// Name and text of the robot file; those of the paper's robot without one.
    #[cfg(feature = "studio")]
    pub(crate) fn text(&self) -> Result<(String, String), Failure> {
        let Some(path) = &self.robot else {
            return Ok(("gpr.toml".to_owned(), robot::PAPER.to_owned()));
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok((name, Self::read(path)?.text))
    }

    /// The robot given as FILE instead of --robot.
    #[cfg(feature = "studio")]
    pub(crate) fn or(&self, file: &Path) -> Result<Self, Failure> {
        if self.robot.is_some() {
            let text = "the robot is given twice: by FILE and by --robot";
            return Err(Failure::Usage(text.to_owned()));
        }
        Ok(Self { robot: Some(file.to_owned()), set: self.set.clone() })
    }

    /// The robot file, if one exists.
    #[cfg(feature = "studio")]
    pub(crate) fn file(&self) -> Option<&Path> {
        self.robot.as_deref().filter(|path| path.exists())
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum VirtualizationName {
    /// three radial displacements
    Radial,
    /// three radial displacements and three rotations about the platform centre (the paper's V.A)
    Polar,
    /// a displacement of each socket in polar coordinates (the paper's V.B)
    Offset,
    /// a displacement of each socket in Cartesian coordinates
    Planar,
}

impl VirtualizationName {
    pub(crate) fn model(self) -> &'static dyn Virtualization {
        match self {
            Self::Radial => &Radial,
            Self::Polar => &Polar,
            Self::Offset => &Offset,
            Self::Planar => &Planar,
        }
    }

    pub(crate) fn built_in(self) -> BuiltIn {
        match self {
            Self::Radial => BuiltIn::Radial,
            Self::Polar => BuiltIn::Polar,
            Self::Offset => BuiltIn::Offset,
            Self::Planar => BuiltIn::Planar,
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SolverName {
    /// the paper's iteration: close to the least displacement
    Newton,
    /// the exact least displacement, iteratively
    LeastNorm,
    /// the exact least displacement in closed form, or least-norm if there is no closed form
    ClosedForm,
}

impl SolverName {
    pub(crate) fn solver(self) -> Solver {
        match self {
            Self::Newton => Solver::Newton,
            Self::LeastNorm => Solver::LeastNorm,
            Self::ClosedForm => Solver::ClosedForm,
        }
    }
}

#[derive(Args)]
pub(crate) struct MetricArgs {
    /// Characteristic length, by which angles are multiplied: paper (1 mm), radius (mean socket radius), or a length in mm
    #[arg(long, value_name = "paper|radius|LENGTH_MM", default_value = "paper", value_parser = metric)]
    metric: Metric,
}

impl MetricArgs {
    pub(crate) fn options(&self, solver: SolverName) -> SolveOptions {
        SolveOptions { solver: solver.solver(), metric: self.metric, ..SolveOptions::default() }
    }
}

/// Virtualization, solver and metric of one pose.
#[derive(Args)]
pub(crate) struct ModelArgs {
    /// Virtualization: the virtual joints that model the play
    #[arg(long, value_enum, default_value = "planar")]
    virtualization: VirtualizationName,
    /// Solver for the virtual joints
    #[arg(long, value_enum, default_value = "closed-form")]
    solver: SolverName,
    #[command(flatten)]
    metric: MetricArgs,
}

impl ModelArgs {
    pub(crate) fn model(&self) -> &'static dyn Virtualization {
        self.virtualization.model()
    }

    pub(crate) fn options(&self) -> SolveOptions {
        self.metric.options(self.solver)
    }
}

#[derive(Args)]
pub(crate) struct LimitArgs {
    /// Compute poses beyond the robot's limits, and report the exceeded limits
    #[arg(long)]
    pub(crate) ignore_limits: bool,
}

impl LimitArgs {
    /// The limits that a pose exceeds; an error unless --ignore-limits is given.
    pub(crate) fn check(
        &self,
        gpr: &Gpr,
        rods: &[f64; 3],
        tilt: Tilt,
    ) -> Result<Vec<BrokenLimit>, Failure> {
        self.accepted(gpr.limits().broken(rods, tilt).iter().collect())
    }

    /// Exceeded limits; an error if there are any, unless --ignore-limits is given.
    pub(crate) fn accepted(&self, broken: Vec<BrokenLimit>) -> Result<Vec<BrokenLimit>, Failure> {
        if broken.is_empty() || self.ignore_limits {
            Ok(broken)
        } else {
            Err(Failure::Limits(broken))
        }
    }

    /// The limits that rod lengths and the plane through the balls exceed; needs no virtual joints.
    pub(crate) fn check_rods(
        &self,
        gpr: &Gpr,
        rods: &[f64; 3],
    ) -> Result<Vec<BrokenLimit>, Failure> {
        self.check(gpr, rods, gpr.plane_tilt(rods))
    }
}

/// Flags of commands that analyse one robot.
#[derive(Args)]
pub(crate) struct AnswerArgs {
    #[command(flatten)]
    pub(crate) robot: RobotArgs,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

impl AnswerArgs {
    /// The robot without limit checks; [`LimitArgs`] checks them.
    pub(crate) fn load(&self) -> Result<Gpr, Failure> {
        Ok(self.robot.load()?.gpr.without_limit_checks())
    }
}

/// A tilt and an axis height; the height defaults to the robot's working height.
#[derive(Args)]
pub(crate) struct TiltArgs {
    /// Tilt direction γ: azimuth of the platform normal, from x toward y
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = finite)]
    azimuth_deg: f64,
    /// Tilt angle α between the platform normal and the vertical
    #[arg(long, value_name = "DEG", value_parser = tilt_angle)]
    tilt_deg: Option<f64>,
    /// Height of the platform [default: the robot's working height]
    #[arg(long, value_name = "MM", value_parser = length)]
    height_mm: Option<f64>,
}

impl TiltArgs {
    /// The commanded tilt.
    ///
    /// # Arguments
    /// * `default_angle` – tilt angle if none is given (rad)
    pub(crate) fn tilt(&self, default_angle: f64) -> Tilt {
        let tilt_angle = self.tilt_deg.map_or(default_angle, f64::to_radians);
        Tilt { azimuth: azimuth(self.azimuth_deg), angle: tilt_angle }
    }

    /// The commanded height (m).
    pub(crate) fn height(&self, gpr: &Gpr) -> f64 {
        self.height_mm.map_or(gpr.working_height(), m_from_mm)
    }

    pub(crate) fn axis_height(&self, gpr: &Gpr) -> AxisHeight {
        AxisHeight(self.height(gpr))
    }
}

/// Three rod lengths.
#[derive(Args)]
pub(crate) struct RodArgs {
    /// Rod lengths [default: all at the robot's working height]
    #[arg(long, value_name = "Q1,Q2,Q3", value_parser = rods)]
    pub(crate) q_mm: Option<Rods>,
}

impl RodArgs {
    pub(crate) fn rods(&self, gpr: &Gpr) -> [f64; 3] {
        self.q_mm.as_ref().map_or([gpr.working_height(); 3], |rods| rods.0)
    }
}

/// Three rod lengths (m).
#[derive(Clone)]
pub(crate) struct Rods(pub(crate) [f64; 3]);

/// Values of a range, in the unit of the flag.
#[derive(Clone)]
pub(crate) struct Steps(pub(crate) Vec<f64>);

/// A whole number within bounds.
pub(crate) fn whole<N: TryFrom<u64>>(text: &str, least: u64, most: u64) -> Result<N, String> {
    let value = text.trim().parse().ok().filter(|value| (least..=most).contains(value));
    value.and_then(|value| N::try_from(value).ok()).ok_or_else(|| match most {
        u64::MAX => format!("expected a whole number from {least}"),
        _ => format!("expected a whole number from {least} to {most}"),
    })
}

/// A whole number from 1.
pub(crate) fn positive_whole<N: TryFrom<u64>>(text: &str) -> Result<N, String> {
    whole(text, 1, u64::MAX)
}

/// An azimuth in radians; full turns are removed before the conversion, where they are exact.
pub(crate) fn azimuth(degrees: f64) -> f64 {
    (degrees % 360.0).to_radians()
}

/// The longest length accepted by a flag (mm): one kilometre, far below overflow of squares.
const LONGEST_MM: f64 = 1e6;

/// A length (mm).
pub(crate) fn length(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value.abs() <= LONGEST_MM {
        Ok(value)
    } else {
        let (found, most) = (number(value), number(LONGEST_MM));
        Err(format!("length must be within ±{most} mm, got {found} mm"))
    }
}

pub(crate) fn tilt_angle(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    within_right_angle(value).map(|()| value)
}

/// Checks a tilt angle (deg).
pub(crate) fn within_right_angle(tilt_angle: f64) -> Result<(), String> {
    if tilt_angle.abs() < 90.0 {
        Ok(())
    } else {
        let tilt_angle = number(tilt_angle);
        Err(format!("the tilt angle must be between -90° and 90°, got {tilt_angle}°"))
    }
}

pub(crate) fn tilt_angles(text: &str) -> Result<Steps, String> {
    let values = steps::parse(text).map_err(|error| error.to_string())?;
    values.iter().try_for_each(|&value| within_right_angle(value))?;
    Ok(Steps(values))
}

pub(crate) fn rods(text: &str) -> Result<Rods, String> {
    let values = text.split(',').map(length).collect::<Result<Vec<f64>, String>>()?;
    let rods: [f64; 3] = values
        .try_into()
        .map_err(|values: Vec<f64>| format!("expected 3 rod lengths, got {}", values.len()))?;
    Ok(Rods(rods.map(m_from_mm)))
}

fn metric(text: &str) -> Result<Metric, String> {
    match text {
        "paper" => Ok(Metric::Paper),
        "radius" => Ok(Metric::PlatformRadius),
        _ => match finite(text.strip_suffix("mm").unwrap_or(text)) {
            Ok(length) if (1e-9..=1e9).contains(&length) => Ok(Metric::Length(m_from_mm(length))),
            Ok(length) if length > 0.0 => Err(format!(
                "characteristic length must be from 1e-9 to 1e9 mm, got {} mm",
                number(length)
            )),
            Ok(length) => {
                Err(format!("characteristic length must be positive, got {} mm", number(length)))
            }
            Err(_) => Err("expected paper, radius, or a length in mm".to_owned()),
        },
    }
}
