//! Figures as SVG and PNG.

use crate::check::check;
use crate::layout::lay_out;
use crate::{Error, Figure, draw, png};

impl Figure {
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
        png::svg_to_png(&self.to_svg()?, width_px)
    }
}
