//! A figure as data: panels under a title.

use crate::Panel;

/// Panels under a common title, stacked from top to bottom.
///
/// Panels that hold the same curves by name and style share one legend, and panels with the same x axis share that.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Title above the panels; empty for none.
    pub title: String,
    /// Panels from top to bottom.
    pub panels: Vec<Panel>,
    /// Width (px); 720 px suits the full width of a page, 360 px a column.
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

    /// The same figure, `width` wide (px).
    pub fn with_width(mut self, width: f64) -> Self {
        self.width = width;
        self
    }
}
