//! A joint between two frames of parts that are placed in an assembly.

use jointplay_core::mechanism::{Joint, JointKind};
use jointplay_core::spatial::Pose;
use nalgebra::{Matrix3, Rotation3, Translation3, Unit, Vector3};

use crate::import::draft::bare;
use crate::import::starts::coordinates_between;

/// A frame of a part: its link, and its pose there and in the assembly as drawn (m).
pub(super) struct PlacedFrame {
    pub(super) link: usize,
    pub(super) in_link: Pose,
    pub(super) drawn: Pose,
}

impl PlacedFrame {
    /// The frame at another point, in its own coordinates (m).
    pub(super) fn shifted(&self, by: Vector3<f64>) -> Self {
        self.moved(Pose::from_parts(Translation3::from(by), Rotation3::identity()))
    }

    /// The frame turned about its origin.
    pub(super) fn turned(&self, by: Rotation3<f64>) -> Self {
        self.moved(Pose::from_parts(Translation3::identity(), by))
    }

    fn moved(&self, by: Pose) -> Self {
        Self { link: self.link, in_link: self.in_link * by, drawn: self.drawn * by }
    }
}

/// A joint between two frames, which starts as drawn.
pub(super) fn placed_joint(
    name: String,
    kind: JointKind,
    [first, second]: [&PlacedFrame; 2],
    ignore: &mut impl FnMut(String),
) -> Joint {
    let first_from_second = first.drawn.inverse() * second.drawn;
    // The solver also accepts frames that differ by half a turn about one of their axes.
    let turn = half_turn(kind, first_from_second.rotation);
    let turn = if kind == JointKind::Universal {
        // The second axis is z of the second frame, and x of our joint frame.
        Rotation3::from_matrix_unchecked(Matrix3::new(0., 0., 1., 0., -1., 0., 1., 0., 0.))
    } else {
        if turn != Rotation3::identity() {
            ignore("opposite direction of an axis".to_owned());
        }
        turn
    };
    let turn = Pose::from_parts(Translation3::identity(), turn);
    let (drawn, in_second) = (first_from_second * turn, second.in_link * turn);
    let mut joint = bare(name, kind, [first.link, second.link], [first.in_link, in_second]);
    joint.guess = coordinates_between(kind, &drawn);
    joint
}

/// The half turn of the second frame that brings its axes next to those of the first.
fn half_turn(kind: JointKind, first_from_second: Rotation3<f64>) -> Rotation3<f64> {
    let about = |axis| Rotation3::from_axis_angle(&axis, std::f64::consts::PI);
    let exact = |axis: Unit<Vector3<f64>>| {
        // Entries are 0 and ±1 exactly.
        Rotation3::from_matrix_unchecked(about(axis).matrix().map(f64::round))
    };
    let by_x = exact(Vector3::x_axis());
    match kind {
        JointKind::Spherical | JointKind::Universal => Rotation3::identity(),
        JointKind::Fixed | JointKind::Prismatic => {
            let (by_y, by_z) = (exact(Vector3::y_axis()), exact(Vector3::z_axis()));
            let turns = [by_z, by_y, by_x, Rotation3::identity()];
            let nearness = |turn: &Rotation3<f64>| (first_from_second * turn).matrix().trace();
            // Of equals the last.
            let best = turns.into_iter().max_by(|a, b| nearness(a).total_cmp(&nearness(b)));
            best.unwrap_or_default()
        }
        _ if first_from_second[(2, 2)] < 0.0 => by_x,
        _ => Rotation3::identity(),
    }
}
