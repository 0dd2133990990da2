//! `jointplay draw`: a picture of a mechanism.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::plot::{MechanismPicture, View};

use super::motion::driven;
use crate::arguments::finite;
use crate::failure::Failure;
use crate::mechanism_input::{Assignment, Input, SetArgs, Source, assignment};
use crate::{folder, output};

/// Width of a PNG figure [px].
const PNG_WIDTH: u32 = 1800;
/// Play is shown larger by this much at most: a nanometre as a metre.
const LARGEST_FACTOR: f64 = 1e9;
/// What every picture of a mechanism holds: the hatching of its base.
const MARK: &str = "<pattern id=\"base\"";

/// Draw a mechanism: its links, its joints by kind, what is actuated, its virtual joints
///
/// The mechanism is closed from the guesses of its file.
/// It is seen from where its joints stand apart best, a planar one nearly square on.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay draw bennett
  jointplay draw four-bar --at A=30 --ghost A=120 --figure motion.png
  jointplay draw hexapod --view=-30,20 --figure hexapod.svg
  jointplay draw gpr-mechanism --at \"rod 1=5,rod 2=0,rod 3=0\" --exaggerate 500 --figure play.svg")]
pub(crate) struct Draw {
    /// Mechanism file (TOML), or a name from `jointplay catalogue`
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    set: SetArgs,
    /// Joint coordinates that are to have these values, in the units of the file
    #[arg(long, value_name = "JOINT=VALUE", value_delimiter = ',', value_parser = assignment)]
    at: Vec<Assignment>,
    /// Show the links faintly where they are once these joints are driven to these values
    #[arg(long, value_name = "JOINT=VALUE", value_delimiter = ',', value_parser = assignment)]
    ghost: Vec<Assignment>,
    /// Show the play that the configuration takes larger by this factor; all joints stay where they truly are
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    exaggerate: Option<f64>,
    /// From where it is seen: azimuth and elevation of the eye in degrees, z being up
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = view, allow_hyphen_values = true)]
    view: Option<View>,
    /// Picture to write, .svg or .png; without it, NAME.svg if no other file of that name is there
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
}

fn view(text: &str) -> Result<View, String> {
    let (azimuth, elevation) =
        text.split_once(',').ok_or_else(|| format!("{text:?} is not AZIMUTH,ELEVATION"))?;
    let (azimuth, elevation) = (finite(azimuth)?, finite(elevation)?);
    if elevation.abs() > 90.0 {
        return Err(format!("an elevation of {elevation}° is not between -90° and 90°"));
    }
    let azimuth = (azimuth % 360.0).to_radians();
    Ok(View { azimuth, elevation: elevation.to_radians() })
}

fn factor(text: &str) -> Result<f64, String> {
    let factor = finite(text)?;
    if (1.0..=LARGEST_FACTOR).contains(&factor) {
        Ok(factor)
    } else {
        Err(format!("play is shown larger by a factor from 1 to {LARGEST_FACTOR:e}, not {text}"))
    }
}

impl Draw {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let input = Input::parse(&Source::read(&self.file)?, &self.set.set)?;
        let path = self.path()?;
        let posed = input.posed(&input.commands(&self.at)?)?;
        if self.exaggerate.is_some() && posed.relief.is_none() {
            let text = "--exaggerate: this configuration takes no play that could be shown larger; say one with --at that closes by the file's virtual joints only";
            return Err(Failure::Misused(text.to_owned()));
        }
        let mut picture = MechanismPicture::new(&input.file.mechanism, posed.closed.coordinates);
        (picture.view, picture.exaggeration) = (self.view, self.exaggerate);
        if !self.ghost.is_empty() {
            let to = input.commands(&self.ghost)?;
            picture.ghost = Some(driven(&input, &picture.coordinates, &to, "--ghost")?);
        }
        let failed = |source| Failure::Figure { figure: path.display().to_string(), source };
        let bytes = match ending(&path).as_deref() {
            Some("png") => picture.to_png(PNG_WIDTH).map_err(failed)?,
            _ => picture.to_svg().map_err(failed)?.into_bytes(),
        };
        folder::write_file(&path, &bytes)?;
        output::text(&format!("picture: {}\n", path.display()))
    }

    /// Where the picture goes.
    fn path(&self) -> Result<PathBuf, Failure> {
        if let Some(path) = &self.figure {
            return match ending(path).as_deref() {
                Some("svg" | "png") => Ok(path.clone()),
                _ => Err(Failure::FigureKind { path: path.clone() }),
            };
        }
        let stem = self.file.file_stem().unwrap_or_default();
        let path = PathBuf::from(stem).with_extension("svg");
        if replaceable(&path) {
            return Ok(path);
        }
        let source = std::io::Error::new(
            std::io::ErrorKind::AlreadyExists,
            "it is there and no picture of a mechanism; name another with --figure",
        );
        Err(Failure::Write { path, source })
    }
}

/// What a name ends in, in small letters.
fn ending(path: &Path) -> Option<String> {
    path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase())
}

/// Whether nothing is lost by writing there: no file, or a picture of a mechanism.
fn replaceable(path: &Path) -> bool {
    match std::fs::read_to_string(path) {
        Ok(text) => text.starts_with("<svg") && text.contains(MARK),
        Err(error) => error.kind() == std::io::ErrorKind::NotFound,
    }
}
