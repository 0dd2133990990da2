//! Draws the figures of the documents: `cargo run -p jointplay-validation --bin figures`.
//!
//! Writes `docs/figures/*.svg`, `docs/reference/catalogue.md` and its pictures; with a folder as argument, also the same pictures as PNG there, to look at.

mod divergence;
mod first_order;
mod paths;
mod play;
mod shift;

use std::error::Error;
use std::path::Path;

use jointplay::plot::Figure;
use jointplay_validation::gallery;

fn main() -> Result<(), Box<dyn Error>> {
    let figures: [(&str, Figure); 9] = [
        ("errata-divergence", divergence::figure()),
        ("characteristic-length", shift::against_characteristic_length()?),
        ("centre-shift", shift::against_tilt()?),
        ("triangle-centres", shift::triangle()),
        ("angular-parts", play::angular_parts()),
        ("newton-least-norm", play::newton_least_norm()),
        ("path-dependence", paths::figure()),
        ("singular-values", first_order::singular_values()?),
        ("bounds", first_order::bounds()?),
    ];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/figures");
    std::fs::create_dir_all(&folder)?;
    let pictures = std::env::args_os().nth(1);
    for (name, figure) in &figures {
        std::fs::write(folder.join(format!("{name}.svg")), figure.to_svg()?)?;
        if let Some(pictures) = &pictures {
            std::fs::write(Path::new(pictures).join(format!("{name}.png")), figure.to_png(1440)?)?;
        }
    }
    let catalogue = folder.join("catalogue");
    std::fs::create_dir_all(&catalogue)?;
    for (entry, file) in &gallery::mechanisms() {
        let picture = gallery::picture(file)?;
        std::fs::write(catalogue.join(format!("{}.svg", entry.name)), picture.to_svg()?)?;
        if let Some(pictures) = &pictures {
            let png = Path::new(pictures).join(format!("{}.png", entry.name));
            std::fs::write(png, picture.to_png(1120)?)?;
        }
    }
    std::fs::write(folder.join("../reference/catalogue.md"), gallery::page()?)?;
    Ok(())
}

/// `count` values from `first` to `last`, both included.
fn evenly(first: f64, last: f64, count: u32) -> Vec<f64> {
    let step = (last - first) / f64::from(count - 1);
    (0..count).map(|i| first + step * f64::from(i)).collect()
}

/// `count` values from `first` to `last`, each the same multiple of the one before.
fn by_decades(first: f64, last: f64, count: u32) -> Vec<f64> {
    evenly(first.log10(), last.log10(), count).into_iter().map(|x| 10f64.powf(x)).collect()
}
