//! Mechanisms as models in Modelica.

mod names;
mod writer;

use jointplay_core::mechanism::Mechanism;
use nalgebra::DVector;

use self::writer::Writer;
use super::Written;
use super::error::Error;
use super::skeleton::Skeleton;

pub use self::names::modelica_class;

/// Stiffness of a virtual slide where the file states none (N/m). Without masses only ratios of stiffness matter; at this one, forces of closures have less round-off than compilers allow.
const STIFFNESS: f64 = 1.0;

/// A mechanism at a closed configuration as a package in Modelica, which needs no library.
///
/// The model `Mechanism` of the package has an input for each actuated coordinate; links are components with a frame, and joints are components with the coordinates and limits of the mechanism.
/// Virtual joints are turns and slides with a spring.
/// The model is quasi-static: links have no masses, and each passive coordinate has a damper, so that the springs settle within microseconds.
/// Stiff springs close the loops and couple coordinates, so that redundant constraints are no obstacle.
/// The model `Reference` holds the inputs at the configuration.
///
/// # Arguments
/// * `coordinates` – (f + M) of a closed configuration, in which the model starts (m, rad)
/// * `class` – name of the package, an identifier such as those of [`modelica_class`]
///
/// # Errors
/// [`Error::Core`] for coordinates that are not those of the mechanism; [`Error::Coupling`] for couplings of joints that close loops, and of balls.
///
/// # Source
/// \[Modelica\]
pub fn modelica(
    mechanism: &Mechanism,
    coordinates: &DVector<f64>,
    class: &str,
) -> Result<Written, Error> {
    let skeleton = Skeleton::with_default_stiffness(mechanism, coordinates, STIFFNESS)?;
    let couplings = mechanism.couplings().iter();
    let couplings = couplings.map(|one| Ok((one, skeleton.coupled(one, "Modelica")?)));
    let couplings = couplings.collect::<Result<Vec<_>, Error>>()?;
    let mut writer = Writer::new(&skeleton);
    writer.bodies();
    writer.frames();
    writer.closures();
    for (coupling, (follower, others)) in couplings {
        let others: Vec<_> = others.iter().map(|(joint, ratio)| (joint.name, *ratio)).collect();
        writer.coupling(coupling, follower.name, &others)?;
    }
    let mut lost = skeleton.lost.clone();
    let text = writer.finish(class, &mut lost);
    Ok(Written { text, loops: None, lost })
}
