//! Pictures of mechanisms: links, joints by kind, and what is driven.

mod glyph;
mod labels;
mod order;
mod page;
mod paint;
mod scene;
mod view;

use jointplay_core::mechanism::{Kinematics, Mechanism, exaggerate_play};
use nalgebra::DVector;

use crate::{Error, png};
pub(crate) use page::bar;
use scene::Scene;
pub use view::View;

/// A mechanism in a configuration, as an orthographic picture.
///
/// Links are bars between two joints and plates between more; the base is hatched.
/// Each joint is drawn by its kind, in its place and direction: a sleeve for a revolute, a block on a rail for a prismatic joint, a ball for a spherical one, a cross for a universal one.
/// Actuated joints and virtual joints are accented.
///
/// Joints that may stand anywhere along their axis are drawn where they can be seen: a slide in the middle of its telescope, hinges whose axes meet in a point around it.
///
/// ```
/// use jointplay_core::mechanism::{Joint, JointKind, Mechanism, LinearAndAngular};
/// use jointplay_core::spatial::Pose;
/// use jointplay_plot::MechanismPicture;
/// use nalgebra::DVector;
///
/// let hinge = Joint {
///     name: "hinge".to_owned(),
///     kind: JointKind::Revolute,
///     links: [0, 1],
///     frames: [Pose::identity(); 2],
///     actuated: true,
///     guess: vec![],
///     limits: vec![],
///     clearance: LinearAndAngular::default(),
///     stiffness: LinearAndAngular::default(),
/// };
/// let links = vec!["wall".to_owned(), "door".to_owned()];
/// let door = Mechanism::new("Door", links, vec![hinge])?;
/// let svg = MechanismPicture::new(&door, DVector::zeros(1)).to_svg()?;
/// assert!(svg.contains(">hinge</text>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismPicture<'a> {
    /// The mechanism.
    pub mechanism: &'a Mechanism,
    /// Its configuration (f + M) [m, rad].
    pub coordinates: DVector<f64>,
    /// Another configuration, of which the links are shown faintly (f + M) [m, rad].
    pub ghost: Option<DVector<f64>>,
    /// By how much the play taken is shown larger than it is, and said to be; `None` shows the configuration as it is.
    pub exaggeration: Option<f64>,
    /// From where it is seen; `None` chooses.
    pub view: Option<View>,
    /// Title above the picture; empty for none.
    pub title: String,
    /// Width [px].
    pub width: f64,
}

impl<'a> MechanismPicture<'a> {
    /// A picture titled by the mechanism's name, 720 px wide, seen from where most can be seen.
    #[must_use]
    pub fn new(mechanism: &'a Mechanism, coordinates: DVector<f64>) -> Self {
        let title = mechanism.name().to_owned();
        Self {
            mechanism,
            coordinates,
            ghost: None,
            exaggeration: None,
            view: None,
            title,
            width: 720.0,
        }
    }

    /// The same picture, with the links of another configuration shown faintly.
    #[must_use]
    pub fn with_ghost(mut self, coordinates: DVector<f64>) -> Self {
        self.ghost = Some(coordinates);
        self
    }

    /// The same picture, with its play shown larger by a factor.
    #[must_use]
    pub fn with_exaggeration(mut self, factor: f64) -> Self {
        self.exaggeration = Some(factor);
        self
    }

    /// The same picture, seen from there.
    #[must_use]
    pub fn with_view(mut self, view: View) -> Self {
        self.view = Some(view);
        self
    }

    /// The same picture under another title.
    #[must_use]
    pub fn with_title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The same picture, `width` wide [px].
    #[must_use]
    pub fn with_width(mut self, width: f64) -> Self {
        self.width = width;
        self
    }

    /// The picture as SVG with real text, on white.
    ///
    /// # Errors
    /// [`Error::Coordinates`] if they are not numbers of this mechanism;
    /// [`Error::Unplaced`] if a joint is beyond the range of numbers;
    /// [`Error::Size`] if the width is out of bounds.
    pub fn to_svg(&self) -> Result<String, Error> {
        crate::check::width(self.width)?;
        let kinematics = Kinematics::new(self.mechanism);
        let mut scene =
            Scene::of(self.mechanism, &kinematics.link_poses(&self.coordinates)?, None)?;
        if let Some(factor) = self.exaggeration {
            scene.exaggerate(&exaggerate_play(self.mechanism, &self.coordinates, factor)?);
        }
        let ghost = match &self.ghost {
            None => None,
            Some(at) => {
                let poses = kinematics.link_poses(at)?;
                Some(Scene::of(self.mechanism, &poses, Some(&scene))?)
            }
        };
        Ok(page::draw(self, &scene, ghost.as_ref()))
    }

    /// The SVG painted as PNG, `width_px` pixels wide, with the embedded DejaVu Sans.
    ///
    /// # Errors
    /// As [`Self::to_svg`]; [`Error::Size`] if `width_px` is 0 or over 20 000; [`Error::Paint`] if painting fails.
    pub fn to_png(&self, width_px: u32) -> Result<Vec<u8>, Error> {
        png::paint(&self.to_svg()?, width_px)
    }
}
