//! Figures whose text LaTeX sets.

use resvg::usvg::{Group, Node, TextAnchor};

use crate::svg::px;
use crate::{Error, png, svg_to_pdf};

/// A figure for LaTeX: graphics, and the text to be set over it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LatexFigure {
    /// LaTeX source for `\input`: the graphics, and all text in the font of the document.
    pub tex: String,
    /// The graphics without text.
    pub pdf: Vec<u8>,
}

/// An SVG of this crate for LaTeX, with its text as LaTeX source, in the font and size of the document.
///
/// The source needs the package `graphicx`; `\figurewidth`, if it is defined before, is the width, by default 180 mm for 720 px.
/// Text between two `$` is a formula in the texts of the author; all other text is escaped, so that no name of a file becomes a command of LaTeX.
///
/// # Arguments
/// * `pdf_name` – file of the graphics, as the document finds it
/// * `own_texts` – title and labels that the author of the figure has written
///
/// # Errors
/// [`Error::Paint`] for an SVG that cannot be converted; [`Error::LatexName`] for a file name with special characters of LaTeX.
pub fn svg_to_latex(svg: &str, pdf_name: &str, own_texts: &[String]) -> Result<LatexFigure, Error> {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "-_. +".contains(letter);
    if !pdf_name.chars().all(is_plain) {
        return Err(Error::LatexName { name: pdf_name.to_owned() });
    }
    let tree = png::parse(svg)?;
    let (width, height) = (f64::from(tree.size().width()), f64::from(tree.size().height()));
    let mut tex = format!(
        "% Needs \\usepackage{{graphicx}}. To change the width: \\newcommand{{\\figurewidth}}{{88mm}}\n\
         \\begingroup\n\
         \\providecommand{{\\figurewidth}}{{{}mm}}%\n\
         \\setlength{{\\unitlength}}{{\\dimexpr\\figurewidth*100/{:.0}\\relax}}%\n\
         \\begin{{picture}}({},{})%\n\
         \\put(0,0){{\\includegraphics[width={}\\unitlength]{{{pdf_name}}}}}%\n",
        px(0.25 * width),
        100.0 * width,
        px(width),
        px(height),
        px(width),
    );
    write_text(tree.root(), height, own_texts, &mut tex);
    tex.push_str("\\end{picture}%\n\\endgroup\n");
    Ok(LatexFigure { tex, pdf: svg_to_pdf(&without_text(svg))? })
}

/// Writes all text of a group; `height` is that of the page (px).
fn write_text(group: &Group, height: f64, own_texts: &[String], tex: &mut String) {
    for node in group.children() {
        match node {
            Node::Group(inner) => write_text(inner, height, own_texts, tex),
            Node::Text(text) => {
                let to_page = text.abs_transform();
                for chunk in text.chunks() {
                    let mut at = resvg::tiny_skia::Point::from_xy(
                        chunk.x().unwrap_or(0.0),
                        chunk.y().unwrap_or(0.0),
                    );
                    to_page.map_point(&mut at);
                    let side = match chunk.anchor() {
                        TextAnchor::Start => 'l',
                        TextAnchor::Middle => 'c',
                        TextAnchor::End => 'r',
                    };
                    let turn = -f64::from(to_page.ky.atan2(to_page.sx)).to_degrees();
                    let text = match own_texts.iter().any(|own| own == chunk.text()) {
                        true => latex(chunk.text()),
                        false => escaped(chunk.text()),
                    };
                    let mut set = format!("\\makebox[0pt][{side}]{{{text}}}");
                    if turn.abs() > 0.01 {
                        // A box without height turns about its base line.
                        set = format!("\\rotatebox{{{}}}{{\\smash{{{set}}}}}", px(turn));
                    }
                    let (x, y) = (f64::from(at.x), height - f64::from(at.y));
                    tex.push_str(&format!("\\put({},{}){{{set}}}%\n", px(x), px(y)));
                }
            }
            Node::Path(_) | Node::Image(_) => {}
        }
    }
}

/// The SVG without its text elements.
fn without_text(svg: &str) -> String {
    let mut rest = svg;
    let mut found = String::with_capacity(svg.len());
    while let Some((before, after)) = rest.split_once("<text") {
        found.push_str(before);
        rest = after.split_once("</text>").map_or("", |(_, after)| after);
    }
    found + rest
}

/// Text as LaTeX source; formulas between two `$` stay as they are.
fn latex(text: &str) -> String {
    let parts: Vec<&str> = text.split('$').collect();
    if parts.len().is_multiple_of(2) {
        return escaped(text);
    }
    let set = |(k, part): (usize, &&str)| match k % 2 {
        0 => escaped(part),
        _ => format!("${part}$"),
    };
    parts.iter().enumerate().map(set).collect()
}

/// Text with the special characters of LaTeX, and with signs that its fonts have as formulas only.
fn escaped(text: &str) -> String {
    const GREEK: [&str; 25] = [
        "alpha",
        "beta",
        "gamma",
        "delta",
        "varepsilon",
        "zeta",
        "eta",
        "theta",
        "iota",
        "kappa",
        "lambda",
        "mu",
        "nu",
        "xi",
        "omicron",
        "pi",
        "rho",
        "varsigma",
        "sigma",
        "tau",
        "upsilon",
        "varphi",
        "chi",
        "psi",
        "omega",
    ];
    let mut found = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\\' => found.push_str("\\textbackslash{}"),
            '^' => found.push_str("\\textasciicircum{}"),
            '~' => found.push_str("\\textasciitilde{}"),
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => found.extend(['\\', letter]),
            'µ' => found.push_str("$\\mu$"),
            'ο' => found.push('o'),
            'α'..='ω' => {
                let index = u32::from(letter) - u32::from('α');
                found.push_str(&format!("$\\{}$", GREEK[index as usize]));
            }
            'Δ' => found.push_str("$\\Delta$"),
            '°' => found.push_str("$^\\circ$"),
            '−' => found.push_str("$-$"),
            '×' => found.push_str("$\\times$"),
            '·' => found.push_str("$\\cdot$"),
            '±' => found.push_str("$\\pm$"),
            '≤' => found.push_str("$\\le$"),
            '≥' => found.push_str("$\\ge$"),
            '⁻' => found.push_str("$^-$"),
            '¹' => found.push_str("$^1$"),
            '²' => found.push_str("$^2$"),
            '³' => found.push_str("$^3$"),
            '⁰' | '⁴'..='⁹' => {
                found.push_str(&format!("$^{}$", u32::from(letter) - u32::from('⁰')));
            }
            other => found.push(other),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Curve, Figure, Panel, rod_style};

    #[test]
    fn text_is_escaped_and_formulas_are_kept() {
        for (text, set) in [
            ("rod_1 (50 %)", "rod\\_1 (50 \\%)"),
            ("5 $", "5 \\$"),
            ("angle $\\theta_1$ (°)", "angle $\\theta_1$ ($^\\circ$)"),
            ("−2 ×10⁻⁶ µm", "$-$2 $\\times$10$^-$$^6$ $\\mu$m"),
            ("ω α", "$\\omega$ $\\alpha$"),
        ] {
            assert_eq!(latex(text), set);
        }
    }

    #[test]
    fn all_text_is_in_the_source_and_none_in_the_graphics() {
        let curve = Curve::new("rod 1", vec![0.0, 1.0], vec![0.0, 2.0], rod_style(0));
        let axes = [Axis::linear("$t$ (s)"), Axis::linear("length & more (mm)")];
        let [x, y] = axes;
        let figure = Figure::new("50 %").with_panel(Panel::new(x, y).with_curve(curve));
        let svg = figure.to_svg().unwrap();
        let LatexFigure { tex, pdf } =
            svg_to_latex(&svg, "figure.pdf", &["$t$ (s)".to_owned()]).unwrap();
        assert_eq!(tex.matches("\\put(").count(), svg.matches("<text").count() + 1, "{tex}");
        for part in [
            "\\makebox[0pt][c]{50 \\%}",
            "{$t$ (s)}",
            "\\rotatebox{90}{\\smash{\\makebox[0pt][c]{length \\& more (mm)}}}",
            "\\includegraphics[width=720\\unitlength]{figure.pdf}",
        ] {
            assert!(tex.contains(part), "{part}: {tex}");
        }
        assert!(!String::from_utf8_lossy(&pdf).contains("DejaVuSans"));
        assert!(pdf.starts_with(b"%PDF-"));
        // The text of another than the author is no formula, and no name is a comment.
        let LatexFigure { tex, .. } = svg_to_latex(&svg, "figure.pdf", &[]).unwrap();
        assert!(tex.contains("{\\$t\\$ (s)}"), "{tex}");
        let refused = svg_to_latex(&svg, "a%b.pdf", &[]).unwrap_err();
        assert!(refused.to_string().contains("a%b.pdf"), "{refused}");
    }
}
