//! Painting of a finished SVG as PNG, with the embedded font only.

use std::io::Read as _;
use std::sync::{Arc, LazyLock};

use flate2::read::GzDecoder;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

use crate::Error;

/// DejaVu Sans, the first family that figures ask for, in gzip.
static FONT: &[u8] = include_bytes!("../fonts/DejaVuSans.ttf.gz");

/// The fonts known to the painter: the embedded one.
static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| {
    let mut font = Vec::new();
    GzDecoder::new(FONT).read_to_end(&mut font).expect("the embedded font is whole");
    let mut fonts = fontdb::Database::new();
    fonts.load_font_source(fontdb::Source::Binary(Arc::new(font)));
    fonts.set_sans_serif_family("DejaVu Sans");
    Arc::new(fonts)
});

/// Greatest width of a picture (px).
const WIDEST: u32 = 20_000;

/// The SVG as the painter understands it.
pub(crate) fn parse(svg: &str) -> Result<Tree, Error> {
    let options = Options { fontdb: FONTS.clone(), ..Options::default() };
    Tree::from_str(svg, &options).map_err(|error| Error::Paint { reason: error.to_string() })
}

/// An SVG of this crate as PNG, `width` pixels wide, with the embedded font.
///
/// # Errors
/// [`Error::Size`] if `width` is 0 or over 20 000; [`Error::Paint`] for an SVG that cannot be rendered.
pub fn svg_to_png(svg: &str, width: u32) -> Result<Vec<u8>, Error> {
    let found = f64::from(width);
    if !(1..=WIDEST).contains(&width) {
        let what = "width of the picture";
        return Err(Error::Size { what, found, min: 1.0, max: f64::from(WIDEST) });
    }
    let tree = parse(svg)?;
    let page = tree.size();
    let scale = width as f32 / page.width();
    let height = ((page.height() * scale).round() as u32).max(1);
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| Error::Paint { reason: format!("no room for {width} x {height} px") })?;
    let stretch = Transform::from_scale(width as f32 / page.width(), height as f32 / page.height());
    resvg::render(&tree, stretch, &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| Error::Paint { reason: error.to_string() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text;

    #[test]
    fn widths_of_text_are_those_of_the_font() {
        for sample in ["length (mm)", "Models: Gijk 0123.456", "−0.5 ×10⁻¹²", "~#%&@"] {
            let svg = format!(
                "<svg xmlns='http://www.w3.org/2000/svg' width='900' height='99'>\
                 <text font-size='20' font-kerning='none' font-family='DejaVu Sans'>{}</text></svg>",
                text::escape_xml(sample)
            );
            let tree = parse(&svg).expect("well-formed");
            let painted = f64::from(tree.root().bounding_box().width());
            let known = text::width(sample, 20.0);
            // Side bearings are part of the advance, and not of the painted box.
            assert!((painted - known).abs() < 6.0, "{sample}: {painted} {known}");
        }
    }

    #[test]
    fn sizes() {
        for width in [0, WIDEST + 1] {
            assert!(matches!(svg_to_png("<svg/>", width), Err(Error::Size { .. })));
        }
        assert!(matches!(svg_to_png("<svg", 10), Err(Error::Paint { .. })));
    }
}
