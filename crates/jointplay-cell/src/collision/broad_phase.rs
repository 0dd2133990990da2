//! Broad phase: pairs of collision objects that may come near each other in a step.

use std::sync::OnceLock;

use super::adaptive_bisection::{CandidatePair, RelativeMotion};
use super::allowed_collisions::ClearanceRule;
use super::motion_bound::MotionBoundModel;
use super::motion_bound_coefficients::{MotionBoundCoefficients, common_ancestor};
use super::scene::Scene;
use super::swept_aabb::SweptAabb;
use crate::incremental::CacheKey;
use crate::program::Step;

/// Moving and fixed objects of a scene, and the pairs of moving objects.
pub(crate) struct BroadPhase {
    /// Moving objects, as indices in the scene.
    pub(crate) moving: Vec<usize>,
    /// Fixed objects, as indices in the scene.
    fixed: Vec<usize>,
    /// For each moving object the distance from the origin of its parent up to which its points are relevant (m).
    relevant_radii: Vec<f64>,
    /// Bound coefficients of the moving objects.
    pub(crate) coefficients: Vec<MotionBoundCoefficients>,
    /// Pairs of moving objects that are checked.
    pairs: Vec<CandidatePair>,
    /// Relative motion of these pairs, computed at its first use.
    relative: OnceLock<Vec<RelativeMotion>>,
    /// Cache key of the moving objects.
    pub(crate) cache_key: CacheKey,
}

/// Candidate pairs of one step.
pub(crate) struct CandidatePairs {
    /// Objects of the pairs, as indices in the scene, moving objects first.
    pub(crate) objects: Vec<usize>,
    pub(crate) pairs: Vec<CandidatePair>,
    /// Cache key of everything that their distances depend on.
    pub(crate) cache_key: CacheKey,
}

impl BroadPhase {
    /// # Arguments
    /// * `max_distance` – distance from which on no pair is relevant (m)
    pub(crate) fn new(scene: &Scene<'_>, bounds: &MotionBoundModel, max_distance: f64) -> Self {
        let (moving, fixed): (Vec<usize>, Vec<usize>) =
            (0..scene.objects.len()).partition(|&object| scene.objects[object].parent.moves());
        let mut cache_key = CacheKey::default();
        for &object in &moving {
            cache_key.add(&*scene.objects[object]);
        }
        let relevant_radii = relevant_radii(scene, &moving, &fixed, bounds, max_distance);
        for (&object, &radius) in moving.iter().zip(&relevant_radii) {
            // A radius that is clipped depends on the other objects.
            if radius < scene.objects[object].collider.bounding_radius() {
                cache_key.add(&radius);
            }
        }
        let coefficients = |(&object, &radius): (&usize, &f64)| {
            MotionBoundCoefficients::new(scene.cell, &scene.objects[object], radius)
        };
        let coefficients = moving.iter().zip(&relevant_radii).map(coefficients).collect();
        let mut pairs = Vec::new();
        for a in 0..moving.len() {
            for b in a + 1..moving.len() {
                let rule = scene.general_clearance_rule(moving[a], moving[b]);
                if rule != ClearanceRule::Unchecked {
                    pairs.push(CandidatePair { objects: [a, b], rule });
                }
            }
        }
        let relative = OnceLock::new();
        Self { moving, fixed, relevant_radii, coefficients, pairs, relative, cache_key }
    }

    /// Relative motion of the pairs of two moving objects.
    pub(crate) fn relative_motion(&self, scene: &Scene<'_>) -> &[RelativeMotion] {
        let of_pair = |pair: &CandidatePair| {
            let objects =
                pair.objects.map(|k| (&*scene.objects[self.moving[k]], self.relevant_radii[k]));
            let ancestor = common_ancestor(&scene.cell.robot, objects[0].0, objects[1].0);
            let coefficients = MotionBoundCoefficients::relative(scene.cell, objects, ancestor);
            RelativeMotion { coefficients, ancestor }
        };
        self.relative.get_or_init(|| self.pairs.iter().map(of_pair).collect())
    }

    /// Objects whose swept boxes come within a distance of each other (m), moving ones first, and their pairs.
    ///
    /// # Arguments
    /// * `swept_boxes` – swept boxes of the moving objects
    pub(crate) fn candidates(
        &self,
        scene: &Scene<'_>,
        step: &Step,
        swept_boxes: &[Option<SweptAabb>],
        distance: f64,
    ) -> (Vec<usize>, Vec<CandidatePair>) {
        let (mut objects, mut pairs) = (self.moving.clone(), self.pairs.clone());
        let all_boxes = SweptAabb::union(swept_boxes.iter().flatten());
        for &fixed in &self.fixed {
            let aabb = &scene.objects[fixed].aabb;
            if !all_boxes.as_ref().is_some_and(|all| all.is_within(aabb, distance)) {
                continue;
            }
            let mut index = None;
            for (moving, boxes) in swept_boxes.iter().enumerate() {
                if !boxes.as_ref().is_some_and(|boxes| boxes.is_within(aabb, distance)) {
                    continue;
                }
                let rule = scene.clearance_rule(self.moving[moving], fixed, step);
                if rule == ClearanceRule::Unchecked {
                    continue;
                }
                let index = *index.get_or_insert_with(|| {
                    objects.push(fixed);
                    objects.len() - 1
                });
                pairs.push(CandidatePair { objects: [moving, index], rule });
            }
        }
        (objects, pairs)
    }
}

/// For each moving object the distance from the origin of its parent up to which its points are relevant (m).
///
/// A point farther out than any other object can be is not near any of them, so that the motion bound of a long object need not cover its far end:
///
/// ```text
///    |a − o|  ≤  |a − b| + |b − O| + |O − o|        a, b: closest points of both, o: origin of the parent of a, O: origin of the platform
/// ```
fn relevant_radii(
    scene: &Scene<'_>,
    moving: &[usize],
    fixed: &[usize],
    bounds: &MotionBoundModel,
    max_distance: f64,
) -> Vec<f64> {
    let platform_radius = bounds.max_platform_distance(&scene.cell.robot);
    let farthest_corner = |&object: &usize| {
        let corner =
            scene.objects[object].aabb.map(|extent| extent.min.abs().max(extent.max.abs()));
        corner[0].hypot(corner[1]).hypot(corner[2]) + platform_radius
    };
    let of_fixed = fixed.iter().map(farthest_corner).fold(0.0, f64::max);
    let radius = |&object: &usize, relevant_radius: f64| {
        MotionBoundCoefficients::new(scene.cell, &scene.objects[object], relevant_radius).radius()
    };
    let radii: Vec<f64> = moving
        .iter()
        .map(|object| radius(object, scene.objects[*object].collider.bounding_radius()))
        .collect();
    let relevant_radius = |(index, object): (usize, &usize)| {
        let others = radii.iter().enumerate().filter(|(other, _)| *other != index);
        let of_moving = others.map(|(_, radius)| *radius).fold(0.0, f64::max);
        let bound = radius(object, 0.0) + of_fixed.max(of_moving) + max_distance;
        bound.min(scene.objects[*object].collider.bounding_radius())
    };
    moving.iter().enumerate().map(relevant_radius).collect()
}
