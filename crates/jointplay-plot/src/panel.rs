//! A panel: two axes and what is drawn between them.

use crate::{Axis, Style};

/// A named series of points.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name in the legend; empty for none.
    pub name: String,
    /// Values along the x axis (unit of the axis).
    pub x: Vec<f64>,
    /// Values along the y axis (unit of the axis); a value that is not finite breaks the line.
    pub y: Vec<f64>,
    /// Style of the curve.
    pub style: Style,
}

impl Curve {
    /// A curve through the points (`x`, `y`), both (unit of their axis).
    pub fn new(name: impl Into<String>, x: Vec<f64>, y: Vec<f64>, style: Style) -> Self {
        Self { name: name.into(), x, y, style }
    }

    /// The points, finite or not, in order.
    pub(crate) fn points(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.x.iter().copied().zip(self.y.iter().copied())
    }
}

/// A dashed vertical line, named above the panel.
#[derive(Debug, Clone, PartialEq)]
pub struct Marker {
    /// Position along the x axis (unit of the axis).
    pub x: f64,
    /// Name, such as `singular pass`.
    pub label: String,
}

/// A text at a data point, placed next to the point.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Position along the x axis (unit of the axis).
    pub x: f64,
    /// Position along the y axis (unit of the axis).
    pub y: f64,
    /// The text.
    pub text: String,
}

/// Two axes and what is drawn between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Caption above the panel, such as `(a) lengths`; empty for none.
    pub title: String,
    /// Horizontal axis; panels that all have the same one share it, with one range.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Series, drawn in this order.
    pub curves: Vec<Curve>,
    /// Vertical lines; those outside a fixed range are omitted.
    pub markers: Vec<Marker>,
    /// Texts at points; those outside a fixed range are omitted.
    pub labels: Vec<Label>,
    /// Whether one unit is equally long on both axes, as geometry needs.
    pub equal_aspect: bool,
    /// Height between the lower and the upper end of the y axis (px); with equal aspect, its largest value.
    pub height: f64,
}

impl Panel {
    /// An empty panel, 230 px high.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self {
            title: String::new(),
            x,
            y,
            curves: Vec::new(),
            markers: Vec::new(),
            labels: Vec::new(),
            equal_aspect: false,
            height: 230.0,
        }
    }

    /// The same panel with a caption.
    pub fn with_title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The same panel with one more curve.
    pub fn with_curve(mut self, curve: Curve) -> Self {
        self.curves.push(curve);
        self
    }

    /// The same panel with a vertical line at `x` (unit of the axis).
    pub fn with_marker(mut self, x: f64, label: impl Into<String>) -> Self {
        self.markers.push(Marker { x, label: label.into() });
        self
    }

    /// The same panel with a text at the point (`x`, `y`), both (unit of their axis).
    pub fn with_label(mut self, x: f64, y: f64, text: impl Into<String>) -> Self {
        self.labels.push(Label { x, y, text: text.into() });
        self
    }

    /// The same panel, at most 420 px high, with one unit equally long on both axes.
    pub fn with_equal_aspect(mut self) -> Self {
        self.equal_aspect = true;
        self.height = 420.0;
        self
    }

    /// The same panel, `height` (px) between the ends of the y axis.
    pub fn with_height(mut self, height: f64) -> Self {
        self.height = height;
        self
    }
}
