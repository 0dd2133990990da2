//! The three-rod robot, many poses at a time.

use jointplay::bulk::{Column, PoseSolver, Quantity, Status};
use jointplay::gpr::Gpr;
use jointplay::nalgebra::{Rotation3, Translation3, Vector3};
use jointplay::spatial::{Pose, Tilt};
use jointplay::study::parallel::{self, PoseColumns};
use jointplay::virtualization::{BuiltIn, Solver, Virtualization};

use crate::gpr;
use crate::work::Work;

/// Arguments of `gpr bulk`.
pub(crate) const USAGE: &str = "expected gpr bulk WHAT [COPIES [cores]]: joints, pose, least, planar, planar-pose, radial, radial-pose or inverse, how often the poses are repeated, and whether all cores share them";

/// Work by its name; `None` for an unknown name.
pub(crate) fn named(what: &str, rest: &[&str]) -> Option<Box<dyn Work>> {
    let (copies, shared) = match rest {
        [] => (1, false),
        [copies] => (copies.parse().ok()?, false),
        [copies, "cores"] => (copies.parse().ok()?, true),
        _ => return None,
    };
    let (newton, closed) = (Solver::Newton, Solver::ClosedForm);
    Some(match what {
        "joints" => Box::new(Forward::new(BuiltIn::Polar, newton, &RESIDUAL, copies, shared)),
        "pose" => Box::new(Forward::new(BuiltIn::Polar, newton, &POSE, copies, shared)),
        "least" => {
            Box::new(Forward::new(BuiltIn::Polar, Solver::LeastNorm, &RESIDUAL, copies, shared))
        }
        "planar" => Box::new(Forward::new(BuiltIn::Planar, closed, &[], copies, shared)),
        "planar-pose" => Box::new(Forward::new(BuiltIn::Planar, closed, &POSE, copies, shared)),
        "radial" => Box::new(Forward::new(BuiltIn::Radial, closed, &[], copies, shared)),
        "radial-pose" => Box::new(Forward::new(BuiltIn::Radial, closed, &POSE, copies, shared)),
        "inverse" => Box::new(Inverse::new(copies, shared)),
        _ => return None,
    })
}

const RESIDUAL: [Quantity; 1] = [Quantity::Residual];
const POSE: [Quantity; 8] = [
    Quantity::Residual,
    Quantity::Origin(0),
    Quantity::Origin(1),
    Quantity::Origin(2),
    Quantity::Normal(0),
    Quantity::Normal(1),
    Quantity::Normal(2),
    Quantity::Torsion,
];

/// Columns of rods, and columns of what is wanted of them: X, and what else.
struct Forward {
    gpr: Gpr,
    solver: PoseSolver,
    virtualization: &'static dyn Virtualization,
    rods: [Vec<f64>; 3],
    wanted: Vec<Quantity>,
    columns: Vec<Vec<f64>>,
    status: Vec<Status>,
    shared: bool,
}

impl Forward {
    fn new(
        virtualization: BuiltIn,
        solver: Solver,
        more: &[Quantity],
        copies: usize,
        shared: bool,
    ) -> Self {
        let gpr = gpr::robot();
        let options = gpr::options(&gpr, solver);
        let solver = PoseSolver::new(&gpr, virtualization, &options).expect("the metric is valid");
        let virtualization = virtualization.model();
        let rods = columns(&gpr::rods(), copies);
        let joints = (0..virtualization.joints().len()).map(Quantity::VirtualJoint);
        let wanted: Vec<Quantity> = joints.chain(more.iter().copied()).collect();
        let columns = vec![vec![0.0; rods[0].len()]; wanted.len()];
        let status = vec![Status::Solved; rods[0].len()];
        Self { gpr, solver, virtualization, rods, wanted, columns, status, shared }
    }

    /// A pose and its virtual joints as those of the polar model: where the sockets are is what programs can be compared by.
    fn answer(&self, pose: usize) -> Option<Vec<f64>> {
        if self.status[pose] != Status::Solved {
            return None;
        }
        let row: Vec<f64> = self.columns.iter().map(|column| column[pose]).collect();
        let (x, rest) = row.split_at(self.virtualization.joints().len());
        let platform = self.gpr.platform();
        let sockets = self.virtualization.sockets(platform, x);
        let mut polar = [0.0; 6];
        for (k, (socket, out)) in sockets.iter().zip(platform.directions()).enumerate() {
            polar[k] = socket.norm();
            polar[3 + k] = out.perp(socket).atan2(out.dot(socket));
        }
        let &[_, ox, oy, oz, nx, ny, nz, torsion] = rest else {
            return Some(polar.to_vec());
        };
        let normal = Vector3::new(nx, ny, nz);
        let tilt = Rotation3::rotation_between(&Vector3::z(), &normal)?;
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), torsion);
        Some(gpr::numbers(&(Pose::from_parts(Translation3::new(ox, oy, oz), tilt * turn), polar)))
    }
}

impl Work for Forward {
    fn solve(&mut self) -> usize {
        self.first(self.status.len())
    }

    fn call(&mut self, times: usize) -> Option<usize> {
        Some(self.first(times.min(self.status.len())))
    }

    fn answers(&self) -> Vec<Option<Vec<f64>>> {
        (0..self.status.len()).map(|pose| self.answer(pose)).collect()
    }
}

impl Forward {
    /// Solves the first so many poses; how many were solved.
    fn first(&mut self, poses: usize) -> usize {
        let rods = [0, 1, 2].map(|k| Column::from(&self.rods[k][..poses]));
        let columns = self.columns.iter_mut().map(|column| &mut column[..poses]);
        let mut wanted: Vec<_> = self.wanted.iter().copied().zip(columns).collect();
        let status = &mut self.status[..poses];
        let done = if self.shared {
            parallel::poses_many(&self.solver, rods, status, &mut wanted)
        } else {
            self.solver.forward_many(rods, status, &mut wanted)
        };
        done.map_or(0, |tally| tally.poses() - tally.failed())
    }
}

/// Columns of tilts, whose rods are wanted.
struct Inverse {
    gpr: Gpr,
    tilts: [Vec<f64>; 2],
    rods: [Vec<f64>; 3],
    status: Vec<Status>,
    shared: bool,
}

impl Inverse {
    fn new(copies: usize, shared: bool) -> Self {
        let tilts: Vec<[f64; 2]> =
            gpr::tilts().map(|Tilt { azimuth, angle: tilt_angle }| [azimuth, tilt_angle]).collect();
        let tilts = columns(&tilts, copies);
        let poses = tilts[0].len();
        Self {
            gpr: gpr::robot(),
            tilts,
            rods: [(); 3].map(|()| vec![0.0; poses]),
            status: vec![Status::Solved; poses],
            shared,
        }
    }

    /// The rods of the first so many poses; how many were found.
    fn first(&mut self, poses: usize) -> usize {
        let height = Column::constant(&gpr::HEIGHT, poses);
        let [azimuth, tilt_angle] = [0, 1].map(|k| Column::from(&self.tilts[k][..poses]));
        let rods = self.rods.each_mut().map(|column| &mut column[..poses]);
        let status = &mut self.status[..poses];
        let done = if self.shared {
            parallel::inverse_many(
                &self.gpr,
                PoseColumns { azimuth, tilt_angle, height },
                status,
                rods,
            )
        } else {
            self.gpr.inverse_many(azimuth, tilt_angle, height, status, rods)
        };
        done.map_or(0, |tally| tally.poses() - tally.failed())
    }
}

impl Work for Inverse {
    fn solve(&mut self) -> usize {
        self.first(self.status.len())
    }

    fn call(&mut self, times: usize) -> Option<usize> {
        Some(self.first(times.min(self.status.len())))
    }

    fn answers(&self) -> Vec<Option<Vec<f64>>> {
        let rods = (0..self.status.len()).map(|pose| {
            let solved = self.status[pose] == Status::Solved;
            solved.then(|| self.rods.iter().map(|column| column[pose]).collect())
        });
        rods.collect()
    }
}

/// Rows as columns, so many times after each other.
fn columns<const N: usize>(rows: &[[f64; N]], copies: usize) -> [Vec<f64>; N] {
    std::array::from_fn(|k| {
        rows.iter().cycle().take(rows.len() * copies).map(|row| row[k]).collect()
    })
}
