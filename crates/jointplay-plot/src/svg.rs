//! Writing of SVG elements.

use crate::text::{FAMILIES, escape_xml};
use crate::{Point, Style};

/// A white outline that keeps text readable on lines.
pub(crate) const RIM: &str =
    " stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"";

/// Ink of text, frame and ticks.
pub(crate) const INK: &str = "#222222";

/// Alignment of a text at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    /// Right of it.
    Start,
    /// About it.
    Middle,
    /// Left of it.
    End,
}

impl Anchor {
    fn name(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

/// A picture in the making.
pub(crate) struct Svg(String);

/// A length to a hundredth of a px, without needless zeros (px).
pub(crate) fn px(length: f64) -> String {
    let text = format!("{length:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

impl Svg {
    /// A white page `width` by `height` (px), described by `title`.
    pub(crate) fn new(width: f64, height: f64, title: &str) -> Self {
        let (w, h) = (px(width), px(height));
        let about = escape_xml(title);
        Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             role=\"img\" aria-label=\"{about}\" font-family=\"{FAMILIES}\" fill=\"none\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n"
        ))
    }

    /// The finished text.
    pub(crate) fn finish(mut self) -> String {
        self.0.push_str("</svg>\n");
        self.0
    }

    /// A path with these attributes.
    pub(crate) fn path(&mut self, data: &str, attributes: &str) {
        self.0.push_str(&element(data, attributes));
    }

    /// Finished elements.
    pub(crate) fn elements(&mut self, elements: &str) {
        self.0.push_str(elements);
    }

    /// A text at (`x`, `y`) (px) of this `size` (px), with further attributes.
    pub(crate) fn text(
        &mut self,
        (x, y): (f64, f64),
        size: f64,
        anchor: Anchor,
        text: &str,
        more: &str,
    ) {
        self.0.push_str(&format!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\" text-anchor=\"{}\" fill=\"{INK}\"{more}>{}</text>\n",
            px(x),
            px(y),
            px(size),
            anchor.name(),
            escape_xml(text)
        ));
    }
}

/// A path with these attributes; nothing without data.
pub(crate) fn element(data: &str, attributes: &str) -> String {
    if data.is_empty() {
        return String::new();
    }
    format!("<path d=\"{data}\"{attributes}/>\n")
}

/// Path data through these positions; a single one becomes a stroke of no length, which round ends make a dot.
pub(crate) fn path_data(stroke: &[(f64, f64)]) -> String {
    let mut data = String::new();
    for (index, (x, y)) in stroke.iter().enumerate() {
        let letter = match index {
            0 => "M",
            1 => "L",
            _ => " ",
        };
        data.push_str(&format!("{letter}{} {}", px(*x), px(*y)));
    }
    if stroke.len() == 1 {
        data.push_str("h0");
    }
    data
}

/// Attributes of the line of a style; none if it has no line.
pub(crate) fn line_attributes(style: &Style) -> Option<String> {
    let dash = style.line?;
    let dashes =
        dash.array().map_or(String::new(), |array| format!(" stroke-dasharray=\"{array}\""));
    Some(format!(
        " stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{dashes}",
        style.colour.hex(),
        px(style.width)
    ))
}

/// Path data and attributes of a point of this shape at (`x`, `y`) (px).
pub(crate) fn point_data(shape: Point, (x, y): (f64, f64)) -> String {
    let at = |dx: f64, dy: f64| format!("{} {}", px(x + dx), px(y + dy));
    match shape {
        Point::Circle | Point::Ring => {
            format!("M{}a3 3 0 1 0 6 0a3 3 0 1 0 -6 0z", at(-3.0, 0.0))
        }
        Point::Square => format!("M{}h5.4v5.4h-5.4z", at(-2.7, -2.7)),
        Point::Triangle => format!("M{}l3.5 6h-7z", at(0.0, -4.0)),
        Point::Diamond => format!("M{}l3.7 3.7l-3.7 3.7l-3.7 -3.7z", at(0.0, -3.7)),
        Point::Cross => format!("M{}l6 6m0 -6l-6 6", at(-3.0, -3.0)),
    }
}

/// Attributes of the points of a style.
pub(crate) fn point_attributes(style: &Style, shape: Point) -> String {
    let colour = style.colour.hex();
    match shape {
        Point::Ring => format!(" fill=\"#ffffff\" stroke=\"{colour}\" stroke-width=\"1.4\""),
        Point::Cross => format!(" stroke=\"{colour}\" stroke-width=\"1.6\""),
        _ => format!(" fill=\"{colour}\""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths() {
        for (length, text) in [(1.0, "1"), (0.125, "0.12"), (-0.001, "0"), (100.0, "100")] {
            assert_eq!(px(length), text);
        }
    }

    #[test]
    fn paths() {
        assert_eq!(path_data(&[(0.0, 1.0), (2.0, 3.5), (4.0, 5.0)]), "M0 1L2 3.5 4 5");
        assert_eq!(path_data(&[(0.0, 1.0)]), "M0 1h0");
        assert_eq!(path_data(&[]), "");
    }
}
