//! Figures of results, for papers: SVG text, PNG and PDF bytes from the same description.
//!
//! This crate draws columns of numbers and computes no results.
//! It reads no files, uses an embedded font, and returns the same bytes for the same input.
//!
//! ```
//! use jointplay_plot::{Axis, Curve, Figure, Panel, rod_style};
//!
//! let pass = vec![0.0, 1.0, 2.0, 3.0];
//! let length = vec![93.2181, 93.2184, f64::NAN, 93.2192]; // NaN breaks the line
//! let panel = Panel::new(Axis::linear("pass"), Axis::linear("length (mm)"))
//!     .with_curve(Curve::new("rod 1", pass, length, rod_style(0)))
//!     .with_marker(1.5, "singular pass");
//! let svg = Figure::new("Rod lengths").with_panel(panel).to_svg()?;
//! assert!(svg.contains(">length (mm)</text>"));
//! # Ok::<(), jointplay_plot::Error>(())
//! ```
//!
//! | type | role |
//! | --- | --- |
//! | [`Figure`] | title and panels, stacked from top to bottom |
//! | [`Panel`] | two axes and what is drawn between them |
//! | [`Axis`], [`Scale`] | label with unit, linear or logarithmic, automatic or fixed range |
//! | [`Curve`], [`Marker`], [`Label`] | a series, a vertical line, a text at a point |
//! | [`Style`], [`Colour`], [`Dash`], [`Point`] | styles of curves, distinct in colour and in grey |
//! | [`rod_style`], [`model_style`] | the styles of rods and of models |
//! | [`MechanismPicture`], [`View`] | a mechanism in space, and the viewing direction |
//! | [`cell`] | top view of a work cell, and timing diagram of its axes |
//! | [`results`] | figures of this project's own studies and comparisons |
//! | [`svg_to_png`], [`svg_to_pdf`], [`svg_to_latex`] | any of these figures in another format |
//! | [`restyle_svg`] | any of these figures with another font or text size |
//! | [`Error`] | why a figure cannot be drawn |

mod axis;
pub mod cell;
mod check;
mod decimal;
mod draw;
mod error;
mod figure;
mod label;
mod latex;
mod layout;
mod legend;
mod linear_ticks;
mod log_ticks;
mod markers;
mod mechanism;
mod panel;
mod path;
mod pdf;
mod png;
mod ranges;
mod render;
pub mod results;
mod scale_bar;
mod span;
mod style;
mod svg;
mod text;
mod text_style;
mod tick;
mod ticks;

pub use axis::{Axis, Scale};
pub use error::Error;
pub use figure::Figure;
pub use latex::{LatexFigure, svg_to_latex};
pub use mechanism::{Labels, MechanismPicture, View};
pub use panel::{Curve, Label, Marker, Panel};
pub use pdf::svg_to_pdf;
pub use png::svg_to_png;
pub use style::{Colour, Dash, Model, Point, Style, model_style, rod_style};
pub use text::escape_xml;
pub use text_style::restyle_svg;
