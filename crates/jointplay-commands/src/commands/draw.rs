//! `jointplay draw`: pictures of mechanisms.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use jointplay::format::number::number;
use jointplay::mechanism::{JointWrench, MechanismSystem, self_stresses};
use jointplay::mobility::{RANK_THRESHOLD, instantaneous_mobility};
use jointplay::nalgebra::DVector;
use jointplay::plot::{Labels, MechanismPicture, View};
use serde::Serialize;

use super::motion_run::driven;
use crate::arguments::{finite, positive_whole};
use crate::failure::Failure;
use crate::figure::FigureArgs;
use crate::mechanism_input::{Input, JointValues, joint_values};
use crate::output::{self, FormatArgs};
use crate::set_args::SetArgs;

/// Largest play scale: a nanometre drawn as a metre.
const LARGEST_FACTOR: f64 = 1e9;

/// Draw a mechanism: links, joints by kind, actuators, virtual joints
///
/// Use --figure to write the picture into a file; without it, SVG is printed on standard output.
/// The loops are closed from the initial guess in the file.
/// The default view separates the joints best; a planar mechanism is seen almost along its normal.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay draw bennett > bennett.svg
  jointplay draw four-bar --at A=30 --ghost A=120 --figure motion.png
  jointplay draw hexapod --view=-30,20 --figure hexapod.svg
  jointplay draw gpr-mechanism --redundant 1 --figure redundant.svg
  jointplay draw four-bar --no-title --width 360 --labels links --label A=crank --figure column.pdf
  jointplay draw four-bar --label 'A=$\\theta_1$' --figure paper.tex
  jointplay draw gpr-mechanism --at \"rod 1=5,rod 2=0,rod 3=0\" --exaggerate 500 --figure play.svg")]
pub(crate) struct Draw {
    /// Mechanism file (TOML), model (MJCF, SDF, URDF, .FCStd), or a name from `jointplay catalogue`
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    /// Commanded joint coordinates, in the units of the file
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values)]
    at: Vec<JointValues>,
    /// Also draw the links faintly with these joints driven to these values
    #[arg(long, value_name = "JOINT=VALUE", value_parser = joint_values)]
    ghost: Vec<JointValues>,
    /// Play scale: draw the displacement of the virtual joints larger by this factor; joints keep their positions
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    exaggerate: Option<f64>,
    /// Draw redundant constraint N, as numbered by `mobility`: forces and moments of its self-stress on the second links of the joints
    #[arg(long, value_name = "N", value_parser = positive_whole::<u32>, conflicts_with = "exaggerate")]
    redundant: Option<u32>,
    /// Direction to the viewer: azimuth and elevation in degrees, with z up
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = view)]
    view: Option<View>,
    #[command(flatten)]
    appearance: Appearance,
    #[command(flatten)]
    figure: FigureArgs,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

/// Names in the picture.
#[derive(Args)]
struct Appearance {
    /// Names in the picture
    #[arg(long, value_name = "WHICH", value_enum, default_value_t = LabelArg::Auto)]
    labels: LabelArg,
    /// Text in place of the name of a joint, virtual joint or link, shown whatever --labels is; an empty text hides the name
    #[arg(long, value_name = "NAME=TEXT", value_parser = label)]
    label: Vec<(String, String)>,
}

/// Names in the picture, as an option.
#[derive(Clone, Copy, ValueEnum)]
enum LabelArg {
    /// Joints and virtual joints; from 16 of them, only actuated joints
    Auto,
    /// All joints and virtual joints
    Joints,
    /// Links
    Links,
    /// Joints, virtual joints and links
    All,
    /// None
    None,
}

impl From<LabelArg> for Labels {
    fn from(labels: LabelArg) -> Self {
        match labels {
            LabelArg::Auto => Self::Auto,
            LabelArg::Joints => Self::Joints,
            LabelArg::Links => Self::Links,
            LabelArg::All => Self::All,
            LabelArg::None => Self::None,
        }
    }
}

impl Appearance {
    fn apply(&self, picture: &mut MechanismPicture<'_>) {
        picture.labels = self.labels.into();
        picture.own_labels = self.label.iter().cloned().collect();
    }
}

fn label(text: &str) -> Result<(String, String), String> {
    let (name, label) = text
        .split_once('=')
        .ok_or_else(|| format!("invalid label {text:?}: expected NAME=TEXT"))?;
    Ok((name.trim().to_owned(), label.trim().to_owned()))
}

/// The picture: the file that it was written to, or its SVG text.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
enum Drawn {
    Figure(String),
    Svg(String),
}

fn view(text: &str) -> Result<View, String> {
    let (azimuth, elevation) = text
        .split_once(',')
        .ok_or_else(|| format!("invalid view {text:?}: expected AZIMUTH,ELEVATION"))?;
    let (azimuth, elevation) = (finite(azimuth)?, finite(elevation)?);
    if elevation.abs() > 90.0 {
        return Err(format!("elevation must be from -90° to 90°, got {}°", number(elevation)));
    }
    let azimuth = (azimuth % 360.0).to_radians();
    Ok(View { azimuth, elevation: elevation.to_radians() })
}

fn factor(text: &str) -> Result<f64, String> {
    let factor = finite(text)?;
    if (1.0..=LARGEST_FACTOR).contains(&factor) {
        Ok(factor)
    } else {
        Err(format!("the play scale must be from 1 to {LARGEST_FACTOR:e}, got {}", number(factor)))
    }
}

/// Loads of the joints in a redundant constraint, by its number.
fn redundant(input: &Input, at: &DVector<f64>, number: u32) -> Result<Vec<JointWrench>, Failure> {
    let system = MechanismSystem::new(&input.file.mechanism, at.clone())?;
    let first = instantaneous_mobility(&system, &system.at_home(), RANK_THRESHOLD)?;
    let found = self_stresses(&system, &first)?.stresses;
    let count = found.len();
    let index = usize::try_from(number).unwrap_or(usize::MAX) - 1;
    match found.into_iter().nth(index) {
        Some(stress) => Ok(stress.wrenches),
        None if count == 0 => {
            let text = "--redundant: no constraint is redundant in this configuration";
            Err(Failure::Usage(text.to_owned()))
        }
        None => Err(Failure::Usage(format!("--redundant must be from 1 to {count}, got {number}"))),
    }
}

impl Draw {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        self.figure.target()?;
        let input = Input::read(&self.file, &self.set.set)?;
        let posed = input.posed(&input.commands(&self.at)?)?;
        if self.exaggerate.is_some() && posed.relief.is_none() {
            let text = "--exaggerate: the virtual joints are not displaced in this configuration; use --at to command one that needs them";
            return Err(Failure::Usage(text.to_owned()));
        }
        let mut picture = MechanismPicture::new(&input.file.mechanism, posed.closed.coordinates);
        (picture.view, picture.exaggeration) = (self.view, self.exaggerate);
        self.appearance.apply(&mut picture);
        if let Some(number) = self.redundant {
            picture.loads = redundant(&input, &picture.coordinates, number)?;
        }
        if !self.ghost.is_empty() {
            let to = input.commands(&self.ghost)?;
            picture.ghost = Some(driven(&input, &picture.coordinates, &to, "--ghost")?);
        }
        let written = self.figure.write(&picture)?;
        let drawn = match written {
            Some(path) => Drawn::Figure(path.display().to_string()),
            None => {
                let failed = |source| Failure::Figure { figure: "the picture".to_owned(), source };
                Drawn::Svg(self.figure.svg(&picture).map_err(failed)?)
            }
        };
        match &drawn {
            _ if self.format.json() => output::json(&drawn),
            Drawn::Figure(path) => output::text(&format!("picture: {path}\n")),
            Drawn::Svg(svg) => output::raw(svg),
        }
    }
}
