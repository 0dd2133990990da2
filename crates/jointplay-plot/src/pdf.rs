//! Conversion of a finished SVG to PDF, with the embedded font only.

use svg2pdf::{ConversionOptions, PageOptions};

use crate::{Error, png};

/// Pixels of a figure per inch: 720 px are 180 mm.
const DPI: f32 = 101.6;

/// An SVG of this crate as PDF with one page: vectors, and text that can be selected, in embedded subsets of DejaVu Sans.
///
/// Figures that are 720 px wide become 180 mm wide.
/// The bytes depend only on the SVG.
///
/// # Errors
/// [`Error::Paint`] for an SVG that cannot be converted.
pub fn svg_to_pdf(svg: &str) -> Result<Vec<u8>, Error> {
    let tree = png::parse(svg)?;
    svg2pdf::to_pdf(&tree, ConversionOptions::default(), PageOptions { dpi: DPI })
        .map_err(|error| Error::Paint { reason: error.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_the_size_of_the_figure_and_embedded_text() {
        let svg = "<svg xmlns='http://www.w3.org/2000/svg' width='720' height='360'>\
                   <text font-size='20' y='30' font-family='DejaVu Sans'>ΔX (µm)</text></svg>";
        let pdf = svg_to_pdf(svg).unwrap();
        assert_eq!(pdf, svg_to_pdf(svg).unwrap());
        let text = String::from_utf8_lossy(&pdf);
        assert!(text.starts_with("%PDF-1."));
        // 180 mm are 510.236 pt.
        assert!(text.contains("/MediaBox [0 0 510.236"), "{:.2000}", text);
        assert!(text.contains("DejaVuSans"), "the font is embedded");
        assert!(matches!(svg_to_pdf("<svg"), Err(Error::Paint { .. })));
    }
}
