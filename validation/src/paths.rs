//! Solutions of a solver that starts at the last pose instead of the nominal one.

use jointplay::gpr::{AxisHeight, Gpr, ball_sides};
use jointplay::linalg::least_norm_of_three;
use jointplay::spatial::{Pose, Tilt, fit_in_plane};
use jointplay::virtualization::{MAX_VIRTUAL_JOINTS, Sides, Sockets, Virtualization};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Steps of each warm-started solve; four reach round-off from a neighbouring pose.
const STEPS: usize = 8;

/// One turn of precession: the same tilt angle (rad) toward `samples` azimuths, from azimuth 0 up to and with 2π.
pub fn turn(tilt_angle: f64, samples: u32) -> impl Iterator<Item = Tilt> {
    (0..=samples).map(move |i| Tilt {
        azimuth: std::f64::consts::TAU * f64::from(i) / f64::from(samples),
        angle: tilt_angle,
    })
}

/// Poses along tilts at axis height 0.5 m, each solve started where the last one ended.
///
/// The first starts at the nominal X. The iteration is the paper's, X ← X − J† F.
///
/// # Arguments
/// * `rho` – ρ of the metric (m)
///
/// # Panics
/// If a tilt is not a pose of the robot.
#[must_use]
pub fn warm_started(
    gpr: &Gpr,
    virtualization: &dyn Virtualization,
    rho: f64,
    tilts: &[Tilt],
) -> Vec<Pose> {
    let platform = gpr.platform();
    let count = virtualization.joints().len();
    let mut x = vec![0.0; count];
    virtualization.nominal(platform, &mut x);
    tilts
        .iter()
        .map(|tilt| {
            let rods = gpr.inverse(*tilt, AxisHeight(0.5)).expect("a pose of the robot");
            let balls = gpr.ball_centers(&rods);
            for _ in 0..STEPS {
                step(gpr, virtualization, rho, &ball_sides(&balls), &mut x);
            }
            fit_in_plane(&virtualization.sockets(platform, &x), &balls, &tilt.normal())
        })
        .collect()
}

/// One step X ← X − J† F.
fn step(gpr: &Gpr, virtualization: &dyn Virtualization, rho: f64, sides: &Sides, x: &mut [f64]) {
    let count = x.len();
    let sockets = virtualization.sockets(gpr.platform(), x);
    let mut velocities = [Sockets::default(); MAX_VIRTUAL_JOINTS];
    virtualization.socket_velocities(gpr.platform(), x, &mut velocities[..count]);
    let edges = [0, 1, 2].map(|k| sockets[(k + 1) % 3] - sockets[k]);
    let target = Vector3::from([0, 1, 2].map(|k| sides[k] * sides[k] - edges[k].norm_squared()));
    let columns: Vec<Vector3<f64>> = velocities[..count]
        .iter()
        .map(|v| [0, 1, 2].map(|k| 2.0 * edges[k].dot(&(v[(k + 1) % 3] - v[k]))).into())
        .collect();
    let compliance: Vec<f64> =
        virtualization.joints().iter().map(|joint| joint.motion.weight(rho).powi(-2)).collect();
    let mut change = vec![0.0; count];
    assert!(
        least_norm_of_three(&columns, &compliance, &target, &mut change),
        "the sides of a proper triangle are independent"
    );
    for (value, change) in x.iter_mut().zip(change) {
        *value += change;
    }
}

/// Rotations of a platform that moves from each normal to the next by the shortest rotation, from level on.
///
/// This is parallel transport of the platform frame: least rotation of the whole platform, instead of least displacement from nominal.
#[must_use]
pub fn least_rotation(tilts: &[Tilt]) -> Vec<Rotation3<f64>> {
    let (mut rotation, mut last) = (Rotation3::identity(), Vector3::z());
    tilts
        .iter()
        .map(|tilt| {
            let normal = tilt.normal();
            rotation = shortest(&last, &normal) * rotation;
            last = normal;
            rotation
        })
        .collect()
}

/// The shortest rotation from one unit vector to another, not its opposite.
fn shortest(from: &Vector3<f64>, to: &Vector3<f64>) -> Rotation3<f64> {
    let axis = from.cross(to);
    let cross = axis.cross_matrix();
    let factor = 1.0 / (1.0 + from.dot(to));
    Rotation3::from_matrix_unchecked(Matrix3::identity() + cross + cross * cross * factor)
}

/// Turn of a rotation about its own e_3, beyond the shortest rotation from level (rad).
#[must_use]
pub fn torsion(rotation: &Rotation3<f64>) -> f64 {
    let normal = rotation.matrix().column(2).into_owned();
    let rest = shortest(&Vector3::z(), &normal).inverse() * rotation;
    rest.matrix()[(1, 0)].atan2(rest.matrix()[(0, 0)])
}
