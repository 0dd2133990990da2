//! A figure, and its two pictures.

use crate::check::check;
use crate::layout::lay_out;
use crate::{Error, Panel, draw, png};

/// Panels under a common title, stacked from top to bottom.
///
/// Panels that hold the same curves by name and style share one legend, and panels with the same x axis share that.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Title above the panels; empty for none.
    pub title: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Width [px]; 720 px suits the full width of a page, 360 px a column.
    pub width: f64,
}

impl Figure {
    /// A figure without panels, 720 px wide.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), panels: Vec::new(), width: 720.0 }
    }

    /// The same figure with one more panel below the others.
    pub fn with_panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// The same figure, `width` wide [px].
    pub fn with_width(mut self, width: f64) -> Self {
        self.width = width;
        self
    }

    /// The figure as SVG with real text, on white.
    ///
    /// # Errors
    /// [`Error::NoPanel`], [`Error::NoFinitePoint`], [`Error::UnequalLengths`] if there is nothing sound to draw;
    /// [`Error::NotPositive`], [`Error::NotFinite`], [`Error::Range`], [`Error::EqualAspect`] if an axis cannot hold it;
    /// [`Error::Size`] if a width or height is out of bounds.
    ///
    /// # Numerics
    /// Of points within the same half px only the extremes are written.
    /// Values that differ by less than 1e-12 of their size are drawn as equal.
    pub fn to_svg(&self) -> Result<String, Error> {
        check(self)?;
        Ok(draw::figure(self, &lay_out(self)?))
    }

    /// The SVG painted as PNG, `width_px` pixels wide, with the embedded DejaVu Sans.
    ///
    /// # Errors
    /// As [`Figure::to_svg`]; [`Error::Size`] if `width_px` is 0 or over 20 000; [`Error::Paint`] if painting fails.
    pub fn to_png(&self, width_px: u32) -> Result<Vec<u8>, Error> {
        png::paint(&self.to_svg()?, width_px)
    }
}
