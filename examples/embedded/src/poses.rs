//! Poses of two robots, written with all digits.

use core::fmt::{self, Write};

use jointplay_core::gpr::{AxisHeight, Gpr, Limb, Limits};
use jointplay_core::nalgebra::{Vector2, Vector3};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{SolveOptions, Solver, built_in};

/// Tilts: azimuth and angle (rad).
const TILTS: [(f64, f64); 5] = [(0.0, 0.0), (0.3, 0.02), (-2.4, 0.0261), (1.0, 1e-6), (2.0, 0.2)];

/// A robot whose sockets are not equally spaced, and whose rods are not below them.
fn uneven() -> Gpr {
    let limb = |x, y, socket_radius, socket_angle| Limb {
        base_point: Vector2::new(x, y),
        socket_radius,
        socket_angle,
    };
    let limbs = [
        limb(0.0803, 0.0012, 0.08, 0.0),
        limb(-0.0452, 0.0831, 0.095, 2.07),
        limb(-0.0371, -0.0789, 0.087, 4.27),
    ];
    let limits = Limits { rod_min: 0.1, rod_max: 0.4, tilt_max: 0.05 };
    let robot = Gpr::new(limbs, limits, 0.25).expect("the limbs make up a robot");
    robot.with_ball_clearance(150e-6).expect("a clearance")
}

/// Writes rods, poses, virtual joints and derivatives of both robots, and the refusals.
pub(crate) fn write_poses(output: &mut impl Write) -> fmt::Result {
    for (name, robot) in [("paper", Gpr::paper()), ("uneven", uneven())] {
        let height = AxisHeight(robot.working_height());
        for (azimuth, angle) in TILTS {
            writeln!(output, "{name} {azimuth:?} {angle:?}")?;
            let rods = match robot.inverse(Tilt { azimuth, angle }, height) {
                Ok(rods) => rods,
                Err(error) => {
                    writeln!(output, "  {error}")?;
                    continue;
                }
            };
            writeln!(output, "  rods {rods:?}")?;
            for virtualization in built_in() {
                for solver in [Solver::ClosedForm, Solver::Newton] {
                    let options = SolveOptions { solver, ..SolveOptions::default() };
                    let pose = match robot.forward(rods, virtualization, &options) {
                        Ok(pose) => pose,
                        Err(error) => {
                            writeln!(output, "  {} {solver} {error}", virtualization.name())?;
                            continue;
                        }
                    };
                    let platform = pose.base_from_platform;
                    let x_axis = platform.rotation * Vector3::x();
                    let center = platform.translation.vector;
                    let clearance = robot.needed_clearance(&pose, virtualization);
                    writeln!(
                        output,
                        "  {} {} {:?} {:?} {:?} {:?} {:?}",
                        virtualization.name(),
                        pose.solution.solver,
                        center.as_slice(),
                        x_axis.as_slice(),
                        pose.solution.virtual_joints,
                        clearance.upper_bound(),
                        clearance.is_sufficient(),
                    )?;
                    if let Ok(jacobian) = robot.platform_jacobian(&pose, virtualization) {
                        writeln!(output, "    {:?}", jacobian.matrix.as_slice())?;
                    }
                }
            }
        }
    }
    let few = SolveOptions { solver: Solver::Newton, max_iterations: 1, ..SolveOptions::default() };
    let refused = Gpr::paper().forward([0.5, 0.501, 0.499], built_in()[1], &few);
    match refused {
        Ok(_) => writeln!(output, "found"),
        Err(error) => writeln!(output, "{error}"),
    }
}
