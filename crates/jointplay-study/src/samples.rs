//! All poses of a study under one virtualization, as columns.

use jointplay_core::gpr::Gpr;
use jointplay_core::virtualization::{
    SolveOptions, Solver, VirtualJoint, VirtualJointKind, Virtualization,
};

use crate::{Error, Order, Raster};

/// The poses of a study, one entry a sample in every column.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Name of the virtualization.
    pub virtualization: String,
    /// The virtual joint of each column of `virtual_joints`.
    pub joints: Vec<VirtualJoint>,
    /// Solver used for the last sample: differs from the one asked for where a closed form does not exist.
    pub solver: Solver,
    /// ρ of the metric (m).
    pub characteristic_length: f64,
    /// Samples in one run over the tilt angles.
    pub samples_per_row: usize,
    /// Order of the samples.
    pub order: Order,
    /// Azimuth γ (rad).
    pub azimuth: Vec<f64>,
    /// Tilt angle α as commanded, either sign (rad).
    pub tilt_angle: Vec<f64>,
    /// Rods q_1, q_2, q_3 (m).
    pub rods: [Vec<f64>; 3],
    /// Sides L_12, L_23, L_31 (m).
    pub sides: [Vec<f64>; 3],
    /// Virtual joints X, a column each ((m), (rad)).
    pub virtual_joints: Vec<Vec<f64>>,
    /// Platform origin O_p in the base frame (m).
    pub origin: [Vec<f64>; 3],
    /// Torsion about the platform normal (rad).
    pub torsion: Vec<f64>,
    /// Iterations of the solver.
    pub iterations: Vec<usize>,
    /// Largest difference between a side and its virtual length (m).
    pub residual: Vec<f64>,
}

/// Kind of quantity of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SeriesKind {
    /// A rod length (m).
    Rod,
    /// A side (m).
    Side,
    /// A linear virtual joint (m).
    Linear,
    /// An angular virtual joint (rad).
    Angular,
}

/// One column with what it is called.
#[derive(Debug, Clone, PartialEq)]
pub struct Series<'a> {
    /// Symbol and limb or side, such as `q1`, `L12`, `phi3`.
    pub name: String,
    /// Kind of quantity.
    pub kind: SeriesKind,
    /// The values, in SI.
    pub values: &'a [f64],
}

/// Names of the sides, by the balls that they join.
const SIDES: [&str; 3] = ["L12", "L23", "L31"];

impl Samples {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        self.azimuth.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.azimuth.is_empty()
    }

    /// The series that the paper plots: rods, sides, virtual joints.
    #[must_use]
    pub fn series(&self) -> Vec<Series<'_>> {
        let rods = self.rods.iter().enumerate().map(|(k, values)| Series {
            name: format!("q{}", k + 1),
            kind: SeriesKind::Rod,
            values,
        });
        let sides = self.sides.iter().zip(SIDES).map(|(values, name)| Series {
            name: name.to_owned(),
            kind: SeriesKind::Side,
            values,
        });
        let joints = self.virtual_joints.iter().zip(&self.joints).map(|(values, joint)| Series {
            name: format!("{}{}", joint.symbol, joint.limb + 1),
            kind: match joint.motion {
                VirtualJointKind::Linear => SeriesKind::Linear,
                VirtualJointKind::Angular => SeriesKind::Angular,
            },
            values,
        });
        rods.chain(sides).chain(joints).collect()
    }

    /// Samples that pass through the singular configuration: level, all rods equal.
    pub fn singular_passes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|&i| self.tilt_angle[i] == 0.0)
    }
}

/// Computes all poses of a raster under one virtualization, each from the nominal virtual joints.
///
/// Samples are independent of each other: another order gives the same values.
/// Poses beyond the limits are computed too; [`summarize`](crate::summarize) counts them.
///
/// # Arguments
/// * `progress` – called with the number of samples done, from time to time
///
/// # Errors
/// [`Error::Empty`]; [`Error::Pose`] with the first pose that cannot be computed.
pub fn simulate<V: Virtualization + ?Sized>(
    gpr: &Gpr,
    raster: &Raster,
    virtualization: &V,
    options: &SolveOptions,
    progress: &mut dyn FnMut(usize),
) -> Result<Samples, Error> {
    if raster.is_empty() {
        return Err(Error::Empty {
            azimuths: raster.azimuths.len(),
            tilt_angles: raster.tilt_angles.len(),
        });
    }
    let gpr = &gpr.without_limit_checks();
    let count = raster.len();
    let columns = || -> [Vec<f64>; 3] { std::array::from_fn(|_| Vec::with_capacity(count)) };
    let joints = virtualization.joints().to_vec();
    let mut samples = Samples {
        virtualization: virtualization.name().to_owned(),
        solver: options.solver,
        characteristic_length: f64::NAN,
        samples_per_row: raster.tilt_angles.len(),
        order: raster.order,
        azimuth: Vec::with_capacity(count),
        tilt_angle: Vec::with_capacity(count),
        rods: columns(),
        sides: columns(),
        virtual_joints: vec![Vec::with_capacity(count); joints.len()],
        joints,
        origin: columns(),
        torsion: Vec::with_capacity(count),
        iterations: Vec::with_capacity(count),
        residual: Vec::with_capacity(count),
    };
    for (sample, tilt) in raster.tilts().enumerate() {
        let pose = gpr
            .inverse(tilt, raster.height)
            .and_then(|rods| gpr.forward(rods, virtualization, options))
            .map_err(|source| Error::pose(sample, tilt, source))?;
        samples.azimuth.push(tilt.azimuth);
        samples.tilt_angle.push(tilt.angle);
        for k in 0..3 {
            samples.rods[k].push(pose.rods[k]);
            samples.sides[k].push(pose.sides[k]);
            samples.origin[k].push(pose.base_from_platform.translation.vector[k]);
        }
        for (column, &x) in
            samples.virtual_joints.iter_mut().zip(pose.solution.virtual_joints.iter())
        {
            column.push(x);
        }
        samples.torsion.push(pose.torsion());
        samples.iterations.push(pose.solution.iterations);
        samples.residual.push(pose.solution.residual);
        samples.solver = pose.solution.solver;
        samples.characteristic_length = pose.solution.characteristic_length;
        if sample % 256 == 255 {
            progress(sample + 1);
        }
    }
    progress(count);
    Ok(samples)
}
