//! A picture of a mechanism as data: configuration, view and title.

use std::collections::BTreeMap;

use jointplay_core::mechanism::{JointWrench, Mechanism};
use nalgebra::DVector;

use super::view::View;

/// Which names a picture shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Labels {
    /// Those of joints and virtual joints; from 16 of them, only those of actuated joints.
    #[default]
    Auto,
    /// Those of all joints and virtual joints.
    Joints,
    /// Those of links.
    Links,
    /// Those of joints, virtual joints and links.
    All,
    /// None.
    None,
}

/// A mechanism in a configuration, as an orthographic picture.
///
/// Links are bars between two joints and plates between more; the base is hatched.
/// Each joint is drawn by its kind, at its position and in its direction: a sleeve for a revolute, a block on a rail for a prismatic joint, a ball for a spherical one, a cross for a universal one.
/// Actuated joints and virtual joints are highlighted.
///
/// Joints whose position along their axis is arbitrary are drawn at a visible position: a prismatic joint in the middle of its telescope, hinges with intersecting axes around the intersection.
///
/// ```
/// use jointplay_core::mechanism::{Joint, JointKind, LinearAndAngular, Mechanism};
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
    /// Its configuration (f + M) (m, rad).
    pub coordinates: DVector<f64>,
    /// Another configuration whose links are drawn faintly (f + M) (m, rad).
    pub ghost: Option<DVector<f64>>,
    /// Play scale, shown in the legend; `None` draws the configuration to scale.
    pub exaggeration: Option<f64>,
    /// Loads of joints on their second links, drawn as arrows whose lengths are relative to the largest: a force has one head, a moment has two.
    pub loads: Vec<JointWrench>,
    /// Direction to the viewer; `None` for the default.
    pub view: Option<View>,
    /// Names that are shown.
    pub labels: Labels,
    /// Texts in place of the names of joints, virtual joints and links; they are shown whatever `labels` is, and an empty one hides the name.
    pub own_labels: BTreeMap<String, String>,
    /// Title above the picture; empty for none.
    pub title: String,
    /// Width (px).
    pub width: f64,
}

impl<'a> MechanismPicture<'a> {
    /// A picture titled by the mechanism's name, 720 px wide, in the default view.
    #[must_use]
    pub fn new(mechanism: &'a Mechanism, coordinates: DVector<f64>) -> Self {
        let title = mechanism.name().to_owned();
        Self {
            mechanism,
            coordinates,
            ghost: None,
            exaggeration: None,
            loads: Vec::new(),
            view: None,
            labels: Labels::default(),
            own_labels: BTreeMap::new(),
            title,
            width: 720.0,
        }
    }

    /// The picture with the links of another configuration drawn faintly.
    #[must_use]
    pub fn with_ghost(mut self, coordinates: DVector<f64>) -> Self {
        self.ghost = Some(coordinates);
        self
    }

    /// The picture with a play scale.
    #[must_use]
    pub fn with_exaggeration(mut self, factor: f64) -> Self {
        self.exaggeration = Some(factor);
        self
    }

    /// The picture with loads of joints, such as those of a self-stress.
    #[must_use]
    pub fn with_loads(mut self, loads: Vec<JointWrench>) -> Self {
        self.loads = loads;
        self
    }

    /// The picture in another view.
    #[must_use]
    pub fn with_view(mut self, view: View) -> Self {
        self.view = Some(view);
        self
    }

    /// The picture with other names.
    #[must_use]
    pub fn with_labels(mut self, labels: Labels) -> Self {
        self.labels = labels;
        self
    }

    /// The picture with another text in place of the name of a joint, virtual joint or link.
    #[must_use]
    pub fn with_label(mut self, name: impl Into<String>, text: impl Into<String>) -> Self {
        self.own_labels.insert(name.into(), text.into());
        self
    }

    /// The picture with another title.
    #[must_use]
    pub fn with_title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// The picture with another width (px).
    #[must_use]
    pub fn with_width(mut self, width: f64) -> Self {
        self.width = width;
        self
    }
}
