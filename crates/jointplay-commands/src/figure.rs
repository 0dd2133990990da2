//! Figures as files, and the figure that `--figure` writes.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::plot::cell::{Gantt, Taught, TopView};
use jointplay::plot::{
    Error, Figure, LatexFigure, MechanismPicture, restyle_svg, svg_to_latex, svg_to_pdf, svg_to_png,
};

use crate::arguments::finite;
use crate::failure::Failure;
use crate::folder::{self, ForceArgs};

/// Points of a figure's curves in place of each given tilt angle, so that the curves look smooth.
pub(crate) const FIGURE_REFINEMENT: u32 = 10;
/// Width of PNG figures [px]: 180 mm at 250 dots per inch.
const PNG_WIDTH: u32 = 1800;

/// A figure or picture that can be drawn as SVG, PNG and PDF.
pub(crate) trait Drawable: Clone {
    /// The title, empty for none, and the width (px).
    fn title_and_width(&mut self) -> (&mut String, &mut f64);
    /// The labels that the user has written.
    fn own_labels(&self) -> Vec<String> {
        Vec::new()
    }
    /// The SVG text.
    fn svg(&self) -> Result<String, Error>;
    /// The PNG bytes.
    fn png(&self) -> Result<Vec<u8>, Error>;
}

macro_rules! drawable {
    ($($figure:ty $(, $own_labels:item)?);+) => {$(
        impl Drawable for $figure {
            $($own_labels)?

            fn title_and_width(&mut self) -> (&mut String, &mut f64) {
                (&mut self.title, &mut self.width)
            }

            fn svg(&self) -> Result<String, Error> {
                self.to_svg()
            }

            fn png(&self) -> Result<Vec<u8>, Error> {
                self.to_png(PNG_WIDTH)
            }
        }
    )+};
}
drawable!(
    Figure;
    MechanismPicture<'_>,
    fn own_labels(&self) -> Vec<String> {
        self.own_labels.values().cloned().collect()
    };
    TopView<'_>;
    Taught<'_>;
    Gantt
);

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
    /// Write the figure into this file: SVG, PNG or PDF by the end of its name; with .tex, LaTeX source with all text, and a PDF of the same name without it
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
    /// Title of the figure
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Draw no title
    #[arg(long, conflicts_with = "title")]
    no_title: bool,
    /// Width in px, of which 720 are 180 mm on paper [default: 720]
    #[arg(long, value_name = "PX", value_parser = finite)]
    width: Option<f64>,
    /// Size of text and lines, as a multiple of the default; the figure keeps its width
    #[arg(long, value_name = "FACTOR", value_parser = finite, default_value_t = 1.0)]
    text_scale: f64,
    /// Font family of SVG figures; PNG and PDF have the included font, and .tex has that of the document
    #[arg(long, value_name = "FAMILY")]
    font: Option<String>,
    #[command(flatten)]
    force: ForceArgs,
}

/// Formats of figures.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Format {
    Svg,
    Png,
    Pdf,
    Latex,
}

impl FigureArgs {
    /// The file of the figure; `None` without --figure.
    pub(crate) fn target(&self) -> Result<Option<&Path>, Failure> {
        let format = self.format()?;
        if self.font.is_some() && format.is_some_and(|format| format != Format::Svg) {
            let text = "--font needs an SVG figure: PNG and PDF have the included font, and .tex has that of the document";
            return Err(Failure::Usage(text.to_owned()));
        }
        let path = format.and(self.figure.as_deref());
        if let Some(path) = path {
            let failed = |source| Failure::Figure { figure: path.display().to_string(), source };
            self.check_style().map_err(failed)?;
        }
        Ok(path)
    }

    /// Refuses text styles that no figure can have.
    fn check_style(&self) -> Result<(), Error> {
        restyle_svg("", self.font.as_deref(), self.text_scale).map(|_| ())
    }

    /// The format of the figure, by the name of its file; `None` without --figure.
    fn format(&self) -> Result<Option<Format>, Failure> {
        let Some(path) = &self.figure else { return Ok(None) };
        let extension = path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("svg") => Ok(Some(Format::Svg)),
            Some("png") => Ok(Some(Format::Png)),
            Some("pdf") => Ok(Some(Format::Pdf)),
            Some("tex") => Ok(Some(Format::Latex)),
            _ => Err(Failure::FigureKind { path: path.clone() }),
        }
    }

    /// The figure as SVG, with the title, width and text of the options.
    pub(crate) fn svg(&self, figure: &impl Drawable) -> Result<String, Error> {
        let mut figure = figure.clone();
        let (title, width) = figure.title_and_width();
        if self.no_title {
            title.clear();
        } else if let Some(text) = &self.title {
            title.clone_from(text);
        }
        if let Some(given) = self.width {
            *width = given;
        }
        // An invalid scale is refused before it can make the width invalid.
        self.check_style()?;
        *width /= self.text_scale;
        restyle_svg(&figure.svg()?, self.font.as_deref(), self.text_scale)
    }

    /// Draws and writes the figure; its path, or `None` without --figure.
    ///
    /// Called after the answer is printed, so that a failure to write cannot hide it.
    pub(crate) fn write(&self, figure: &impl Drawable) -> Result<Option<&Path>, Failure> {
        let (Some(format), Some(path)) = (self.format()?, self.target()?) else { return Ok(None) };
        folder::check_file(path, self.force)?;
        let graphics = path.with_extension("pdf");
        if format == Format::Latex {
            folder::check_file(&graphics, self.force)?;
        }
        let failed = |source| Failure::Figure { figure: path.display().to_string(), source };
        let svg = self.svg(figure).map_err(failed)?;
        let drawn = match format {
            Format::Svg => svg.into_bytes(),
            Format::Png => svg_to_png(&svg, PNG_WIDTH).map_err(failed)?,
            Format::Pdf => svg_to_pdf(&svg).map_err(failed)?,
            Format::Latex => {
                let name = graphics.file_name().unwrap_or_default().to_string_lossy();
                let own = figure.own_labels().into_iter().chain(self.title.clone());
                let own: Vec<String> = own.collect();
                let LatexFigure { tex, pdf } = svg_to_latex(&svg, &name, &own).map_err(failed)?;
                folder::write_file(&graphics, &pdf, self.force)?;
                tex.into_bytes()
            }
        };
        folder::write_file(path, &drawn, self.force)?;
        Ok(Some(path))
    }
}
