//! Mechanisms in motion for 3D viewers, as simple bodies or as the parts of a CAD model.

use std::f64::consts::FRAC_1_SQRT_2;

use gltf_json::scene::UnitQuaternion as Rotation;
use gltf_json::{Index, Node};
use jointplay_core::mechanism::{Kinematics, Mechanism, exaggerated_link_poses};
use jointplay_core::spatial::Pose;
use nalgebra::{DVector, Quaternion, UnitQuaternion};
use serde_json::{Value, json};

use super::check_tolerance;
use super::document::{Document, Title, Tolerance};
use super::link_shape::show_link;
use super::material::Material;
use super::numbers::single;
use super::parts_file::{PartsFile, UpAxis};
use crate::export::error::Error;
use crate::export::joint_points::{drawn_points, joint_points, size};

/// Poses of the links of a mechanism over time.
#[derive(Debug, Clone, PartialEq)]
pub struct MechanismMotion<'a> {
    mechanism: &'a Mechanism,
    /// Pose of each link in the base frame at the reference configuration (m).
    reference: Vec<Pose>,
    /// Time of each configuration (s).
    times: Vec<f64>,
    /// Pose of each link in the base frame, for each configuration (m).
    poses: Vec<Vec<Pose>>,
    exaggeration: f64,
}

/// Times from 0 to a duration, in proportion to a parameter that grows or falls from one configuration to the next (s).
///
/// # Arguments
/// * `parameter` – of each configuration, such as the variable of a curve; numbers from 0 on for equal intervals
///
/// # Errors
/// [`Error::Duration`]
///
/// # Example
/// ```
/// use jointplay_interop::export::proportional_times;
///
/// assert_eq!(proportional_times(2.0, &[10.0, 5.0, 0.0])?, [0.0, 1.0, 2.0]);
/// # Ok::<(), jointplay_interop::export::Error>(())
/// ```
pub fn proportional_times(duration: f64, parameter: &[f64]) -> Result<Vec<f64>, Error> {
    if !(duration.is_finite() && duration > 0.0) {
        return Err(Error::Duration { duration });
    }
    let [first, .., last] = parameter else { return Ok(vec![0.0; parameter.len()]) };
    Ok(parameter.iter().map(|at| duration * ((at - first) / (last - first))).collect())
}

/// Origins and unit quaternions x, y, z, w.
type PlacesAndTurns = (Vec<[f64; 3]>, Vec<[f64; 4]>);

impl<'a> MechanismMotion<'a> {
    /// The motion through configurations.
    ///
    /// # Arguments
    /// * `reference` – (f + M) coordinates at which parts of a CAD model are in the places of their file (m, rad)
    /// * `configurations` – (f + M) coordinates each (m, rad)
    /// * `times` – time of each configuration, such as by [`proportional_times`] (s)
    /// * `exaggeration` – factor of the displacements of the virtual joints, as in [`exaggerated_link_poses`]
    ///
    /// # Errors
    /// [`Error::Times`], [`Error::TimeCount`]; [`Error::Configuration`] for coordinates that are not those of the mechanism.
    pub fn new<'c>(
        mechanism: &'a Mechanism,
        reference: &DVector<f64>,
        configurations: impl IntoIterator<Item = &'c DVector<f64>>,
        times: Vec<f64>,
        exaggeration: f64,
    ) -> Result<Self, Error> {
        let poses: Vec<Vec<Pose>> = configurations
            .into_iter()
            .map(|at| exaggerated_link_poses(mechanism, at, exaggeration))
            .collect::<Result<_, _>>()?;
        if times.len() != poses.len() {
            return Err(Error::TimeCount { times: times.len(), configurations: poses.len() });
        }
        // Viewers have times in single precision.
        let grows = |pair: &&[f64]| single(pair[0]) < single(pair[1]);
        if let Some(pair) = times.windows(2).find(|pair| !grows(pair)) {
            return Err(Error::Times { time: pair[0], next: pair[1] });
        }
        let reference = Kinematics::new(mechanism).link_poses(reference)?;
        Ok(Self { mechanism, reference, times, poses, exaggeration })
    }

    /// The mechanism drawn by simple bodies, as binary glTF with one animation.
    ///
    /// There is a node for each link, with the name of the link; its frame is that of the link.
    ///
    /// # Arguments
    /// * `tolerance` – largest deviation of a joint of a link from the configurations between which a viewer interpolates (m)
    ///
    /// # Errors
    /// [`Error::Tolerance`], [`Error::TooLarge`].
    pub fn gltf(&self, tolerance: f64) -> Result<Vec<u8>, Error> {
        check_tolerance(tolerance)?;
        let points = joint_points(self.mechanism);
        let size = size(&points, &self.reference);
        let points = drawn_points(self.mechanism, points, size);
        let mut document = Document::default();
        let base = Index::push(&mut document.nodes, Node::default());
        let mut links = Vec::new();
        for (link, name) in self.mechanism.links().iter().enumerate() {
            let (places, turns) = self.track(|at| self.poses[at][link]);
            let material = match link {
                0 => Material::Robot,
                _ if link % 2 == 1 => Material::Arm,
                _ => Material::OtherArm,
            };
            let shown = show_link(&mut document, &points[link], size, material);
            let node = Node {
                name: Some(name.clone()),
                translation: places.first().map(|place| place.map(single)),
                rotation: turns.first().map(|turn| Rotation(turn.map(single))),
                children: (!shown.is_empty()).then_some(shown),
                ..Default::default()
            };
            let node = Index::push(&mut document.nodes, node);
            links.push(node);
            let reach = points[link].iter().map(|point| point.norm()).fold(size, f64::max);
            let tolerance = parts_of(tolerance, reach);
            document.animate_lines(node, &self.times, (&places, &turns), tolerance);
        }
        let [x, y, z, w] = UP.map(single);
        document.nodes[base.value()] = Node {
            name: Some("z up".to_owned()),
            rotation: Some(Rotation([x, y, z, w])),
            children: Some(links),
            ..Default::default()
        };
        let notes = self.notes();
        let title = Title { scene: self.mechanism.name(), animation: "motion", notes: &notes };
        document.file(&title)
    }

    /// The parts of a CAD model moved as the links, as binary glTF: the file of the parts with one animation more.
    ///
    /// A part at the reference configuration is in its place in the file.
    ///
    /// # Arguments
    /// * `table` – names of nodes with the names of the links that they move with; other nodes move with the link of the same name
    /// * `up` – the axis of the file that is z of the base frame
    /// * `tolerance` – largest deviation of a part, as far from the origin as the mechanism is, between configurations (m)
    ///
    /// # Errors
    /// [`Error::Tolerance`], [`Error::TooLarge`], [`Error::Parts`].
    pub fn gltf_of_parts(
        &self,
        parts: &PartsFile,
        table: &[(String, String)],
        up: UpAxis,
        tolerance: f64,
    ) -> Result<AnimatedParts, Error> {
        check_tolerance(tolerance)?;
        let links = self.mechanism.links();
        let moved = parts.assign(links, table)?;
        let missing = (1..links.len()).filter(|link| moved.iter().all(|(of, _)| of != link));
        let missing = missing.map(|link| links[link].clone()).collect();
        let file_from_base = match up {
            UpAxis::Y => UnitQuaternion::new_unchecked(Quaternion::new(UP[3], UP[0], UP[1], UP[2])),
            UpAxis::Z => UnitQuaternion::identity(),
        };
        let file_from_base = Pose::from_parts(
            nalgebra::Translation3::identity(),
            file_from_base.to_rotation_matrix(),
        );
        let points = joint_points(self.mechanism);
        let far = points.iter().zip(&self.reference).flat_map(|(points, pose)| {
            points.iter().map(move |point| (pose * nalgebra::Point3::from(*point)).coords.norm())
        });
        let tolerance = parts_of(tolerance, far.fold(size(&points, &self.reference), f64::max));
        let mut animation = Document::default();
        let first = parts.node_count();
        let mut nodes = Vec::new();
        for (link, node) in moved {
            let home = self.reference[link].inverse();
            let (places, turns) = self.track(|at| {
                file_from_base * (self.poses[at][link] * home) * file_from_base.inverse()
            });
            let name = format!("motion of {}", links[link]);
            let animated = u32::try_from(first + nodes.len()).expect("few links");
            let track = (&places[..], &turns[..]);
            animation.animate_lines(Index::new(animated), &self.times, track, tolerance);
            let start = places.first().copied().zip(turns.first().copied());
            nodes.push((name, node, start));
        }
        let bytes = parts.animated(&nodes, animation, &self.notes())?;
        Ok(AnimatedParts { bytes, missing })
    }

    /// Origins and unit quaternions of a frame at each configuration; neighbours have a positive dot product.
    fn track(&self, pose: impl Fn(usize) -> Pose) -> PlacesAndTurns {
        let (mut places, mut turns) = (Vec::new(), Vec::<[f64; 4]>::new());
        for at in 0..self.times.len() {
            let pose = pose(at);
            places.push(pose.translation.vector.into());
            let turn = UnitQuaternion::from_rotation_matrix(&pose.rotation).into_inner().coords;
            let other_side =
                turns.last().is_some_and(|&last| turn.dot(&nalgebra::Vector4::from(last)) < 0.0);
            turns.push(if other_side { -turn } else { turn }.into());
        }
        (places, turns)
    }

    fn notes(&self) -> Value {
        json!({
            "duration_s": self.times.last().copied().unwrap_or(0.0),
            "exaggeration": self.exaggeration,
        })
    }
}

/// Parts of a CAD model in motion.
#[derive(Debug, Clone, PartialEq)]
pub struct AnimatedParts {
    /// The binary glTF file.
    pub bytes: Vec<u8>,
    /// Links, except the base, that no part moves with.
    pub missing: Vec<String>,
}

/// Rotation that turns z, up in the base frame, to glTF's y: unit quaternion x, y, z, w.
const UP: [f64; 4] = [-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2];

/// The parts of a tolerance (m) for the origin, and for the rotation of points at a distance from it.
fn parts_of(tolerance: f64, reach: f64) -> Tolerance {
    Tolerance { place: 0.5 * tolerance, turn: 0.5 * tolerance / reach }
}
