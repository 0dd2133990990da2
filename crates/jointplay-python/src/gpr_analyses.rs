//! Analyses of the three-rod robot.

use std::collections::BTreeSet;

use jointplay::gpr::AxisHeight;
use jointplay::mobility::{RANK_THRESHOLD, augmented_mobility, finite_mobility};
use jointplay::sensitivity::sensitivity;
use jointplay::spatial::Tilt;
use jointplay::study::{Order, Raster, check_bounds, compare, simulate, summarize};
use jointplay::virtualization::{Planar, SolveOptions, Virtualization, built_in};
use pyo3::prelude::*;

use crate::gpr::{PyGpr, axis_height};
use crate::model::{self, Model, ModelNames, with_model};
use crate::numbers::{one_triple, optional_real, real};
use crate::skin::{self, fields};
use crate::{analyses, arrays, errors};

/// The most poses that a study may have: every one is kept in memory.
const MOST_POSES: usize = 5_000_000;

#[pymethods]
impl PyGpr {
    /// Kutzbach, instantaneous and finite mobility.
    ///
    /// Parameters
    /// ----------
    /// rods_m : array of shape (3,), optional
    ///     Rod lengths (m); default: level at the working height.
    /// virtualization : str or Virtualization, optional
    ///     Also the mobility with these virtual joints free.
    ///
    /// Returns
    /// -------
    /// Mobility
    ///     With singular values and threshold, motions and self-stresses; coordinates in the order q_1, q_2, q_3, P_1, P_2, P_3.
    #[pyo3(signature = (rods_m=None, virtualization=None))]
    fn mobility<'py>(
        &self,
        py: Python<'py>,
        rods_m: Option<&Bound<'py, PyAny>>,
        virtualization: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (gpr, options) = (&self.gpr, SolveOptions::default());
        let failed = |error: jointplay::Error| errors::core(py, &error);
        let rods = match rods_m {
            Some(rods) => one_triple(rods)?,
            None => gpr.inverse(Tilt::LEVEL, axis_height(None, gpr)).map_err(failed)?,
        };
        // The rigid robot is the one whose virtual joints are held; which virtualization holds them makes no difference.
        let rigid = gpr.system(&Planar);
        let pose = gpr.forward(rods, &Planar, &options).map_err(failed)?;
        let at = rigid.configuration(&pose);
        let finite = py.detach(|| finite_mobility(&rigid, &at, RANK_THRESHOLD)).map_err(failed)?;
        let model = virtualization.map(|given| Model::of(Some(given), gpr)).transpose()?;
        let augmented = model.as_ref().map(|model| {
            let found = with_model!(model, v => gpr.forward(rods, v, &options).and_then(|pose| {
                let relieved = gpr.system(v);
                augmented_mobility(&relieved, &relieved.configuration(&pose), RANK_THRESHOLD)
            }));
            Ok::<_, PyErr>((model.virtualization().name(), model.checked(py, found)?))
        });
        let augmented = augmented.transpose()?;
        let augmented = augmented.as_ref().map(|(name, found)| (*name, found));
        analyses::mobility(py, gpr.kutzbach_mobility(), &finite, augmented)
    }

    /// How far the virtual joints move for a small motion of the robot: ∂X/∂P with its singular values.
    ///
    /// Parameters
    /// ----------
    /// rods_m : array of shape (3,)
    ///     Rod lengths (m).
    /// virtualization, solver, metric
    ///     Those of `forward`.
    #[pyo3(signature = (rods_m, virtualization=None, *, solver=None, metric=None))]
    fn sensitivity<'py>(
        &self,
        py: Python<'py>,
        rods_m: &Bound<'py, PyAny>,
        virtualization: Option<&Bound<'py, PyAny>>,
        solver: Option<&str>,
        metric: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (gpr, rods) = (&self.gpr, one_triple(rods_m)?);
        let model = Model::of(virtualization, gpr)?;
        let options = model::options(py, solver, metric)?;
        let found = with_model!(&model, v => gpr.forward(rods, v, &options).and_then(|pose| {
            let system = gpr.system(v);
            let rho = pose.solution.characteristic_length;
            sensitivity(&system, &system.configuration(&pose), rho, RANK_THRESHOLD)
        }));
        let found = model.checked(py, found)?;
        analyses::sensitivity(py, &found, ModelNames::of_model(&model))
    }

    /// Displacement of the virtual joints from level to a tilt at the same axis height, with the paper's first-order bounds.
    ///
    /// Parameters
    /// ----------
    /// azimuth_rad, tilt_rad : float
    ///     The tilt (rad).
    /// height_m : float, optional
    ///     Axis height (m); default: the working height.
    /// virtualization, solver, metric
    ///     Those of `forward`.
    #[pyo3(signature = (azimuth_rad, tilt_rad, height_m=None, virtualization=None, *, solver=None, metric=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn tilt_play<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = real)] azimuth_rad: f64,
        #[pyo3(from_py_with = real)] tilt_rad: f64,
        #[pyo3(from_py_with = optional_real)] height_m: Option<f64>,
        virtualization: Option<&Bound<'py, PyAny>>,
        solver: Option<&str>,
        metric: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let gpr = &self.gpr;
        let model = Model::of(virtualization, gpr)?;
        let options = model::options(py, solver, metric)?;
        let tilt = Tilt { azimuth: azimuth_rad, angle: tilt_rad };
        let height = axis_height(height_m, gpr);
        let found = with_model!(&model, v => gpr.tilt_play(tilt, height, v, &options));
        let found = model.checked(py, found)?;
        analyses::tilt_play(py, &found, ModelNames::of_model(&model))
    }

    /// All models side by side over a range of tilts.
    ///
    /// Parameters
    /// ----------
    /// tilt_rad : array of shape (n,)
    ///     Tilt angles (rad).
    /// azimuth_rad : float, optional
    ///     Azimuth of all tilts (rad).
    /// height_m : float, optional
    ///     Axis height (m); default: the working height.
    /// virtualizations : sequence of str or Virtualization, optional
    ///     Which, each with a name of its own; default: all of the library.
    /// solver, metric
    ///     Those of `forward`.
    #[pyo3(signature = (tilt_rad, azimuth_rad=0.0, height_m=None, *, virtualizations=None, solver=None, metric=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn compare<'py>(
        &self,
        py: Python<'py>,
        tilt_rad: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = real)] azimuth_rad: f64,
        #[pyo3(from_py_with = optional_real)] height_m: Option<f64>,
        virtualizations: Option<Vec<Bound<'py, PyAny>>>,
        solver: Option<&str>,
        metric: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let gpr = &self.gpr;
        let options = model::options(py, solver, metric)?;
        let tilt_angles = arrays::row(tilt_rad, "tilt_rad")?;
        let models = match virtualizations {
            Some(given) => given
                .iter()
                .map(|one| Model::of(Some(one), gpr))
                .collect::<PyResult<Vec<Model>>>()?,
            None => Vec::new(),
        };
        let chosen: Vec<&dyn Virtualization> = if models.is_empty() {
            built_in().to_vec()
        } else {
            models.iter().map(|model| model.virtualization() as &dyn Virtualization).collect()
        };
        let mut names = BTreeSet::new();
        if let Some(twice) = chosen.iter().find(|one| !names.insert(one.name())) {
            let message = format!("two virtualizations are named {:?}", twice.name());
            return Err(errors::input(py, &format!("{message}: give each another name")));
        }
        let height = axis_height(height_m, gpr);
        let found = compare(gpr, &chosen, azimuth_rad, &tilt_angles, height, &options);
        if let Some(raised) = models.iter().find_map(Model::raised) {
            return Err(raised);
        }
        analyses::comparison(py, &found.map_err(|error| errors::study(py, &error))?)
    }

    /// A raster of tilts under one virtualization, every pose from the nominal virtual joints; see `jointplay.study`.
    #[pyo3(signature = (virtualization, azimuth_rad, tilt_rad, height_m, serpentine, solver, metric))]
    #[expect(clippy::too_many_arguments, reason = "called by the package alone")]
    fn _simulate<'py>(
        &self,
        py: Python<'py>,
        virtualization: Option<&Bound<'py, PyAny>>,
        azimuth_rad: Option<&Bound<'py, PyAny>>,
        tilt_rad: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = optional_real)] height_m: Option<f64>,
        serpentine: bool,
        solver: Option<&str>,
        metric: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = Model::of(virtualization, &self.gpr)?;
        let options = model::options(py, solver, metric)?;
        let raster = self.raster(py, azimuth_rad, tilt_rad, height_m, serpentine)?;
        let found = py.detach(
            || with_model!(&model, v => simulate(&self.gpr, &raster, v, &options, &mut |_| ())),
        );
        if let Some(raised) = model.raised() {
            return Err(raised);
        }
        let samples = found.map_err(|error| errors::study(py, &error))?;
        let summary = summarize(&self.gpr, &samples);
        analyses::study(py, &samples, &summary, ModelNames::of_model(&model))
    }

    /// The first-order bounds over a raster; see `jointplay.study`.
    #[pyo3(signature = (virtualization, azimuth_rad, tilt_rad, height_m, solver, metric))]
    #[expect(clippy::too_many_arguments, reason = "called by the package alone")]
    fn _check_bounds<'py>(
        &self,
        py: Python<'py>,
        virtualization: Option<&Bound<'py, PyAny>>,
        azimuth_rad: Option<&Bound<'py, PyAny>>,
        tilt_rad: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = optional_real)] height_m: Option<f64>,
        solver: Option<&str>,
        metric: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = Model::of(virtualization, &self.gpr)?;
        let options = model::options(py, solver, metric)?;
        let raster = self.raster(py, azimuth_rad, tilt_rad, height_m, false)?;
        let found = py.detach(
            || with_model!(&model, v => check_bounds(&self.gpr, &raster, v, &options, &mut |_| ())),
        );
        if let Some(raised) = model.raised() {
            return Err(raised);
        }
        let found = found.map_err(|error| errors::study(py, &error))?;
        let fields = fields!(py;
            poses = found.poses,
            held_at_start = found.held_at_start,
            held_at_midpoint = found.held_at_midpoint,
            held_at_end = found.held_at_end,
        );
        skin::result(py, "BoundsCheck", &fields)
    }
}

impl PyGpr {
    /// The paper's raster, with what is given in place of its own.
    fn raster(
        &self,
        py: Python<'_>,
        azimuth_rad: Option<&Bound<'_, PyAny>>,
        tilt_rad: Option<&Bound<'_, PyAny>>,
        height_m: Option<f64>,
        serpentine: bool,
    ) -> PyResult<Raster> {
        let paper = Raster::paper();
        let azimuths = azimuth_rad.map(|given| arrays::row(given, "azimuth_rad")).transpose()?;
        let tilt_angles = tilt_rad.map(|given| arrays::row(given, "tilt_rad")).transpose()?;
        let raster = Raster {
            azimuths: azimuths.unwrap_or(paper.azimuths),
            tilt_angles: tilt_angles.unwrap_or(paper.tilt_angles),
            height: height_m.map_or_else(|| AxisHeight(self.gpr.working_height()), AxisHeight),
            order: if serpentine { Order::Serpentine } else { Order::Raster },
        };
        if raster.len() > MOST_POSES {
            let message = format!(
                "the study has {} poses, but at most {MOST_POSES} are taken: forward and inverse take arrays of any length",
                raster.len()
            );
            return Err(errors::input(py, &message));
        }
        Ok(raster)
    }
}
