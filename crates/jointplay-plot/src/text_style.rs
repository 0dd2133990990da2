//! Font and size of the text of finished figures.

use crate::Error;
use crate::svg::px;
use crate::text::FAMILIES;

/// Text sizes, as multiples of the default.
const SCALES: (f64, f64) = (0.25, 10.0);

/// An SVG of this crate in another font, enlarged by a factor.
///
/// A figure that is drawn narrower by this factor keeps its width, so that its text is larger by the factor.
///
/// # Arguments
/// * `family` – name of a font family, before the families of this crate, by which the room of text is measured
/// * `scale` – factor of width and height
///
/// # Errors
/// [`Error::Font`] for a name with other characters than letters, digits, spaces and hyphens; [`Error::TextScale`] for a factor below 0.25 or above 10.
pub fn restyle_svg(svg: &str, family: Option<&str>, scale: f64) -> Result<String, Error> {
    let (min, max) = SCALES;
    if !(min..=max).contains(&scale) {
        return Err(Error::TextScale { found: scale, min, max });
    }
    let mut svg = svg.to_owned();
    if let Some(family) = family {
        let valid = |letter: char| letter.is_alphanumeric() || letter == ' ' || letter == '-';
        if family.trim().is_empty() || !family.chars().all(valid) {
            return Err(Error::Font { family: family.to_owned() });
        }
        let name = match family {
            // Keywords of CSS are not in quotation marks.
            "serif" | "sans-serif" | "monospace" => family.to_owned(),
            _ => format!("'{family}'"),
        };
        svg = svg.replacen(FAMILIES, &format!("{name}, {FAMILIES}"), 1);
    }
    if let Some(start) = svg.find(" width=\"")
        && let Some(end) = svg.find(" viewBox=\"")
        && let [_, width, _, height, _] = svg[start..end].split('"').collect::<Vec<_>>()[..]
        && let (Ok(width), Ok(height)) = (width.parse::<f64>(), height.parse::<f64>())
    {
        let size = format!(" width=\"{}\" height=\"{}\"", px(width * scale), px(height * scale));
        svg.replace_range(start..end, &size);
    }
    Ok(svg)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::svg::Svg;

    #[test]
    fn font_and_size() {
        let svg = Svg::new(360.0, 200.5, "title").finish();
        let changed = restyle_svg(&svg, Some("Times New Roman"), 2.0).unwrap();
        assert!(changed.contains(" width=\"720\" height=\"401\" viewBox=\"0 0 360 200.5\""));
        assert!(changed.contains("font-family=\"'Times New Roman', 'DejaVu Sans', Verdana"));
        assert!(restyle_svg(&svg, Some("serif"), 1.0).unwrap().contains("=\"serif, 'DejaVu"));
        assert_eq!(restyle_svg(&svg, None, 1.0).unwrap(), svg);
        for family in ["", "a\"b", "a'", "x;y"] {
            assert!(matches!(restyle_svg(&svg, Some(family), 1.0), Err(Error::Font { .. })));
        }
        for scale in [0.0, 100.0, f64::NAN] {
            assert!(matches!(restyle_svg(&svg, None, scale), Err(Error::TextScale { .. })));
        }
    }
}
