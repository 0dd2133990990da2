//! Styles of curves, distinct in colour and, by dashes and points, in grey.

/// A colour of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour {
    /// Red, 0 to 255.
    pub red: u8,
    /// Green, 0 to 255.
    pub green: u8,
    /// Blue, 0 to 255.
    pub blue: u8,
}

/// The palette of Okabe and Ito, which colour-blind readers can distinguish, without its yellow (too pale on white).
impl Colour {
    /// Black.
    pub const BLACK: Self = Self::rgb(0, 0, 0);
    /// Orange.
    pub const ORANGE: Self = Self::rgb(230, 159, 0);
    /// Sky blue.
    pub const SKY_BLUE: Self = Self::rgb(86, 180, 233);
    /// Bluish green.
    pub const GREEN: Self = Self::rgb(0, 158, 115);
    /// Blue.
    pub const BLUE: Self = Self::rgb(0, 114, 178);
    /// Vermillion.
    pub const VERMILLION: Self = Self::rgb(213, 94, 0);
    /// Reddish purple.
    pub const PURPLE: Self = Self::rgb(204, 121, 167);
    /// Grey, the usual addition to the palette.
    pub const GREY: Self = Self::rgb(120, 120, 120);

    /// A colour from its three parts, each 0 to 255.
    pub const fn rgb(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// `#rrggbb`.
    pub(crate) fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.red, self.green, self.blue)
    }
}

/// How a line is interrupted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Dash {
    /// Not at all.
    #[default]
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// Dash and dot in turn.
    DashDot,
    /// Long dashes.
    LongDash,
    /// A dash and two dots in turn.
    DashDotDot,
}

impl Dash {
    /// Lengths of strokes and gaps in px, as SVG writes them.
    pub(crate) fn array(self) -> Option<&'static str> {
        match self {
            Dash::Solid => None,
            Dash::Dashed => Some("7 3.5"),
            Dash::Dotted => Some("1.8 2.4"),
            Dash::DashDot => Some("9 3 2 3"),
            Dash::LongDash => Some("15 4"),
            Dash::DashDotDot => Some("9 3 2 3 2 3"),
        }
    }
}

/// Shape of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Point {
    /// Filled circle.
    Circle,
    /// Filled square.
    Square,
    /// Filled triangle.
    Triangle,
    /// Filled diamond.
    Diamond,
    /// Two crossing strokes.
    Cross,
    /// Circle with a white inside.
    Ring,
}

/// How a curve looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Style {
    /// Colour of line and points.
    pub colour: Colour,
    /// Dashes of the line; `None` draws no line.
    pub line: Option<Dash>,
    /// Width of the line (px).
    pub width: f64,
    /// Shape of the points; `None` draws no points.
    pub point: Option<Point>,
}

impl Style {
    /// A line without points.
    pub const fn line(colour: Colour, dash: Dash) -> Self {
        Self { colour, line: Some(dash), width: 1.6, point: None }
    }

    /// Points without a line.
    pub const fn points(colour: Colour, point: Point) -> Self {
        Self { colour, line: None, width: 1.6, point: Some(point) }
    }

    /// The same style with points of this shape.
    pub const fn with_point(mut self, point: Point) -> Self {
        self.point = Some(point);
        self
    }

    /// The same style with a line of this width (px).
    pub const fn with_width(mut self, width: f64) -> Self {
        self.width = width;
        self
    }
}

/// The look of rod `rod`, counted from 0: rod 1 blue and solid, rod 2 vermillion and dashed, rod 3 green and dotted.
///
/// Further rods go on with purple, orange and sky blue, then from the start.
pub fn rod_style(rod: usize) -> Style {
    const RODS: [Style; 6] = [
        Style::line(Colour::BLUE, Dash::Solid),
        Style::line(Colour::VERMILLION, Dash::Dashed),
        Style::line(Colour::GREEN, Dash::Dotted),
        Style::line(Colour::PURPLE, Dash::DashDot),
        Style::line(Colour::ORANGE, Dash::LongDash),
        Style::line(Colour::SKY_BLUE, Dash::DashDotDot),
    ];
    RODS[rod % RODS.len()]
}

/// The models of the robot whose results are compared in figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Model {
    /// The radial model.
    Radial,
    /// The polar model.
    Polar,
    /// The offset model.
    Offset,
    /// The planar model.
    Planar,
    /// The approximate model.
    Approximate,
}

impl Model {
    /// All models, in the order of a legend.
    pub const ALL: [Self; 5] =
        [Self::Radial, Self::Polar, Self::Offset, Self::Planar, Self::Approximate];
}

/// The look of a model, the same in every figure and unlike that of any of the first three rods.
pub fn model_style(model: Model) -> Style {
    match model {
        Model::Radial => Style::line(Colour::BLACK, Dash::Solid),
        Model::Polar => Style::line(Colour::ORANGE, Dash::Dashed),
        Model::Offset => Style::line(Colour::SKY_BLUE, Dash::DashDot),
        Model::Planar => Style::line(Colour::PURPLE, Dash::Dotted),
        Model::Approximate => Style::line(Colour::GREY, Dash::LongDash),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn styles_differ_in_colour_and_in_dash() {
        let rods: Vec<Style> = (0..3).map(rod_style).collect();
        let models: Vec<Style> = Model::ALL.into_iter().map(model_style).collect();
        for group in [&rods, &models] {
            for (i, a) in group.iter().enumerate() {
                for b in &group[i + 1..] {
                    assert_ne!(a.colour, b.colour);
                    assert_ne!(a.line, b.line);
                }
            }
        }
        assert!(rods.iter().all(|rod| models.iter().all(|model| rod.colour != model.colour)));
        assert_eq!(rod_style(6), rod_style(0));
    }

    #[test]
    fn hexadecimal() {
        assert_eq!(Colour::VERMILLION.hex(), "#d55e00");
    }
}
