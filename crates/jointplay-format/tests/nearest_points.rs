//! Nearest points of the pairs of a pose, in the example cell.

use jointplay_cell::EntityId;
use jointplay_cell::check::{CheckOptions, PoseContext, check_pose, nearest_points};
use jointplay_cell::geometry::Shape;
use jointplay_cell::program::expand;
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::ParentFrame;
use jointplay_format::{cell, program};
use nalgebra::{Point3, Vector3};
use proptest::prelude::RngExt;
use proptest::test_runner::{RngAlgorithm, TestRng};

/// Distance of a point from the surface of a shape in its own frame, positive outside (m).
fn off_the_surface(shape: &Shape, point: &Point3<f64>) -> Option<f64> {
    let beyond = |outside: &[f64]| {
        let positive = outside.iter().map(|it| it.max(0.0).powi(2)).sum::<f64>().sqrt();
        positive + outside.iter().copied().fold(f64::NEG_INFINITY, f64::max).min(0.0)
    };
    match shape {
        Shape::Box { half } => {
            let outside: Vec<f64> = (0..3).map(|k| point[k].abs() - half[k]).collect();
            Some(beyond(&outside))
        }
        Shape::Cylinder { radius, half_height } => {
            Some(beyond(&[point.coords.xy().norm() - radius, point.z.abs() - half_height]))
        }
        _ => None,
    }
}

#[test]
fn they_are_on_both_surfaces_at_the_reported_distance() {
    let cell = cell::read(cell::EXAMPLE, &mut |_| Err("no files".to_owned())).unwrap();
    let program = program::parse("HOME\n").unwrap();
    let steps = expand(&cell, &program).unwrap();
    let trajectory = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
    let context = PoseContext { trajectory: &trajectory, time: 0.0, slot_access: None };
    let options = CheckOptions { report_distance: 0.4, ..CheckOptions::default() };
    let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &[11; 32]);
    let (mut pairs, mut surfaces, mut contacts) = (0, 0, 0);
    for _ in 0..40 {
        let mut positions: Vec<f64> = cell.robot.axes.iter().map(|axis| axis.home).collect();
        for (position, axis) in positions.iter_mut().zip(&cell.robot.axes).skip(3) {
            *position = random.random_range(axis.min..axis.max);
        }
        let report = check_pose(&cell, &context, &positions, &options).unwrap();
        let found = nearest_points(&cell, &context, &positions, &report.distances).unwrap();
        assert_eq!(found.len(), report.distances.len());
        for (minimum, points) in report.distances.iter().zip(found) {
            let names = minimum.entities.map(|one| cell.entity_name(one));
            let Some(points) = points else {
                contacts += 1;
                assert!(minimum.distance < 1e-6, "{names:?} without points: {minimum:?}");
                continue;
            };
            pairs += 1;
            let apart: Vector3<f64> = points[1] - points[0];
            assert!((apart.norm() - minimum.distance).abs() < 1e-6, "{names:?}: {minimum:?}");
            for (entity, point) in minimum.entities.into_iter().zip(points) {
                let EntityId::Body(index) = entity else { continue };
                let body = &cell.bodies[index];
                if body.parent != ParentFrame::World {
                    continue;
                }
                let local = body.parent_from_shape.inverse() * Point3::from(point);
                let Some(off) = off_the_surface(&body.shape, &local) else { continue };
                surfaces += 1;
                assert!(off.abs() < 1e-6, "{names:?}: {off} m from the surface");
            }
        }
    }
    assert!(pairs > 300 && surfaces > 100 && contacts > 5, "{pairs} {surfaces} {contacts}");
}
