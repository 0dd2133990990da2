//! Pictures of mechanisms as SVG and PNG.

use jointplay_core::mechanism::{Kinematics, exaggerate_play};
use nalgebra::Vector3;

use super::page;
use super::picture::MechanismPicture;
use super::scene::Scene;
use super::view::View;
use crate::{Error, png};

impl MechanismPicture<'_> {
    /// The picture as SVG with real text, on white.
    ///
    /// # Errors
    /// [`Error::Coordinates`] if they are not numbers of this mechanism;
    /// [`Error::Unplaced`] if a joint is beyond the range of numbers;
    /// [`Error::Size`] if the width is out of bounds;
    /// [`Error::NoSuchName`] if a label is given for a name that nothing has.
    pub fn to_svg(&self) -> Result<String, Error> {
        crate::check::width(self.width)?;
        let kinematics = Kinematics::new(self.mechanism);
        let mut scene =
            Scene::of(self.mechanism, &kinematics.link_poses(&self.coordinates)?, None)?;
        if let Some(factor) = self.exaggeration {
            scene.exaggerate(&exaggerate_play(self.mechanism, &self.coordinates, factor)?);
        }
        scene.load(&self.loads);
        if let Some(name) = self.own_labels.keys().find(|name| !scene.has(name)) {
            return Err(Error::NoSuchName { name: name.clone() });
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

    /// Unit vector from the mechanism toward the viewer of the picture, in the frame of the base.
    ///
    /// # Errors
    /// [`Error::Coordinates`], [`Error::Unplaced`] as [`Self::to_svg`].
    pub fn toward_viewer(&self) -> Result<Vector3<f64>, Error> {
        let poses = Kinematics::new(self.mechanism).link_poses(&self.coordinates)?;
        let view = match self.view {
            Some(view) => view,
            None => View::of(&Scene::of(self.mechanism, &poses, None)?),
        };
        let [_, _, eye] = view.frame();
        Ok(eye)
    }

    /// The SVG painted as PNG, `width_px` pixels wide, with the embedded DejaVu Sans.
    ///
    /// # Errors
    /// As [`Self::to_svg`]; [`Error::Size`] if `width_px` is 0 or over 20 000; [`Error::Paint`] if painting fails.
    pub fn to_png(&self, width_px: u32) -> Result<Vec<u8>, Error> {
        png::svg_to_png(&self.to_svg()?, width_px)
    }
}
