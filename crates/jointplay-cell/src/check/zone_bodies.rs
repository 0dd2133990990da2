//! Fixed bodies in keep-out zones.

use jointplay_core::spatial::Pose;

use crate::collision::CONTACT_RESOLUTION;
use crate::geometry::{Collider, PlacedCollider, bounding_sphere_gap, distance, penetration_depth};
use crate::workcell::{Cell, ParentFrame, Zone, ZoneRule};

/// Fixed body that is in a keep-out zone.
///
/// It is no violation, because zones restrict the robot and its wafers; a zone that a body enters by mistake is in the incorrect place or too large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyInZone {
    /// Index of the body.
    pub body: usize,
    /// Index of the zone.
    pub zone: usize,
    /// Penetration depth (m).
    pub depth: f64,
}

/// Bodies fixed in the world that are in keep-out zones by more than the resolution of distances, in the order of zones and bodies.
#[must_use]
pub fn bodies_in_zones(cell: &Cell) -> Vec<BodyInZone> {
    let is_keep_out = |(_, zone): &(usize, &Zone)| zone.rule == ZoneRule::KeepOut;
    let collider = |shape, pose| Collider::new(shape, pose);
    let fixed =
        cell.bodies.iter().enumerate().filter(|(_, body)| body.parent == ParentFrame::World);
    let fixed: Vec<(usize, Collider)> = fixed
        .filter_map(|(index, body)| Some((index, collider(&body.shape, &body.parent_from_shape)?)))
        .collect();
    let mut found = Vec::new();
    let base_from_parent = &Pose::identity();
    for (zone, described) in cell.zones.iter().enumerate().filter(is_keep_out) {
        let Some(space) = collider(&described.shape, &described.base_from_shape) else { continue };
        let space = PlacedCollider { collider: &space, base_from_parent };
        for (body, collider) in &fixed {
            let placed = PlacedCollider { collider, base_from_parent };
            if bounding_sphere_gap(placed, space) > 0.0 || distance(placed, space) > 0.0 {
                continue;
            }
            let depth = penetration_depth(placed, space);
            if depth > CONTACT_RESOLUTION {
                found.push(BodyInZone { body: *body, zone, depth });
            }
        }
    }
    found
}
