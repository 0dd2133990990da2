//! The figure that `--figure` writes.

use std::path::{Path, PathBuf};

use clap::Args;
use jointplay::plot;

use crate::failure::Failure;
use crate::folder::{self, ForceArgs};

/// Points of a figure's curves in place of each given pitch, so that the curves look smooth.
pub(crate) const FIGURE_REFINEMENT: u32 = 10;

/// The file of a figure.
#[derive(Args)]
pub(crate) struct FigureArgs {
    /// Write the figure into this file; the name must end in .svg or .png
    #[arg(long, value_name = "FILE")]
    figure: Option<PathBuf>,
    #[command(flatten)]
    force: ForceArgs,
}

/// Formats of figures.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    Svg,
    Png,
}

impl FigureArgs {
    /// The file of the figure and its format; `None` without --figure.
    pub(crate) fn target(&self) -> Result<Option<(&Path, Format)>, Failure> {
        let Some(path) = &self.figure else { return Ok(None) };
        let ending = path.extension().map(|end| end.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("svg") => Ok(Some((path, Format::Svg))),
            Some("png") => Ok(Some((path, Format::Png))),
            _ => Err(Failure::FigureKind { path: path.clone() }),
        }
    }

    /// Draws and writes the figure; its path, or `None` without --figure.
    ///
    /// Called after the answer is printed, so that a failure to write cannot hide it.
    pub(crate) fn write(
        &self,
        draw: impl FnOnce(Format) -> Result<Vec<u8>, plot::Error>,
    ) -> Result<Option<&Path>, Failure> {
        let Some((path, format)) = self.target()? else { return Ok(None) };
        folder::check_file(path, self.force)?;
        let failed = |source| Failure::Figure { figure: path.display().to_string(), source };
        folder::write_file(path, &draw(format).map_err(failed)?, self.force)?;
        Ok(Some(path))
    }
}
