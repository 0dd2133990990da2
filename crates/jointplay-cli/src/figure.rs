//! Figures as files, and the figure that `--figure` writes.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::plot::cell::{Gantt, Taught, TopView};
use jointplay::plot::{Error, Figure, MechanismPicture, svg_to_pdf};

use crate::failure::Failure;
use crate::folder::{self, ForceArgs};

/// Points of a figure's curves in place of each given tilt angle, so that the curves look smooth.
pub(crate) const FIGURE_REFINEMENT: u32 = 10;
/// Width of PNG figures [px]: 180 mm at 250 dots per inch.
const PNG_WIDTH: u32 = 1800;

/// A figure or picture that can be drawn as SVG, PNG and PDF.
pub(crate) trait Drawable {
    /// The SVG text.
    fn svg(&self) -> Result<String, Error>;
    /// The PNG bytes.
    fn png(&self) -> Result<Vec<u8>, Error>;
}

macro_rules! drawable {
    ($($figure:ty),+) => {$(
        impl Drawable for $figure {
            fn svg(&self) -> Result<String, Error> {
                self.to_svg()
            }

            fn png(&self) -> Result<Vec<u8>, Error> {
                self.to_png(PNG_WIDTH)
            }
        }
    )+};
}
drawable!(Figure, MechanismPicture<'_>, TopView<'_>, Taught<'_>, Gantt);

/// A figure as SVG text.
///
/// # Arguments
/// * `name` – in messages
pub(crate) fn svg(name: &str, figure: &impl Drawable) -> Result<String, Failure> {
    figure.svg().map_err(|source| Failure::Figure { figure: name.to_owned(), source })
}

/// A figure as the files `NAME.svg` and `NAME.png`.
pub(crate) fn svg_and_png(
    name: &str,
    figure: &impl Drawable,
) -> Result<[(String, Vec<u8>); 2], Failure> {
    let failed = |source| Failure::Figure { figure: name.to_owned(), source };
    let svg = figure.svg().map_err(failed)?.into_bytes();
    let png = figure.png().map_err(failed)?;
    Ok([(format!("{name}.svg"), svg), (format!("{name}.png"), png)])
}

/// The file of a figure.
#[derive(Args)]
pub(crate) struct FigureArgs {
    /// Write the figure into this file; the name must end in .svg, .png or .pdf
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
}

/// Formats of figures.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Svg,
    Png,
    Pdf,
}

impl FigureArgs {
    /// The file of the figure; `None` without --figure.
    pub(crate) fn target(&self) -> Result<Option<&Path>, Failure> {
        self.format().map(|_| self.figure.as_deref())
    }

    /// The format of the figure, by the name of its file; `None` without --figure.
    fn format(&self) -> Result<Option<Format>, Failure> {
        let Some(path) = &self.figure else { return Ok(None) };
        let extension = path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("svg") => Ok(Some(Format::Svg)),
            Some("png") => Ok(Some(Format::Png)),
            Some("pdf") => Ok(Some(Format::Pdf)),
            _ => Err(Failure::FigureKind { path: path.clone() }),
        }
    }

    /// Draws and writes the figure; its path, or `None` without --figure.
    ///
    /// Called after the answer is printed, so that a failure to write cannot hide it.
    pub(crate) fn write(&self, figure: &impl Drawable) -> Result<Option<&Path>, Failure> {
        let (Some(format), Some(path)) = (self.format()?, &self.figure) else { return Ok(None) };
        folder::check_file(path, self.force)?;
        let drawn = match format {
            Format::Svg => figure.svg().map(String::into_bytes),
            Format::Png => figure.png(),
            Format::Pdf => figure.svg().and_then(|svg| svg_to_pdf(&svg)),
        };
        let failed = |source| Failure::Figure { figure: path.display().to_string(), source };
        folder::write_file(path, &drawn.map_err(failed)?, self.force)?;
        Ok(Some(path))
    }
}
