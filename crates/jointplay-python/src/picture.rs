//! Pictures of mechanisms, and their formats.

use std::collections::BTreeMap;

use jointplay::nalgebra::DVector;
use jointplay::plot::{
    Labels, LatexFigure, MechanismPicture, View, restyle_svg, svg_to_latex, svg_to_pdf, svg_to_png,
};
use numpy::{PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::arrays::real;
use crate::errors;
use crate::mechanism::PyMechanism;
use crate::numbers::{optional_real, real as number};
use crate::skin::{self, fields};

#[pymethods]
impl PyMechanism {
    /// A picture: links, joints by kind, actuators and virtual joints; notebooks show it.
    ///
    /// Parameters
    /// ----------
    /// at : dict of str to float, Configuration, Relief or array, optional
    ///     Commanded joint coordinates (m, rad), with which the loops are closed; or all coordinates, shape (f + M,).
    /// ghost : dict of str to float, Configuration, Relief or array, optional
    ///     Another configuration, whose links are drawn faintly.
    /// exaggerate : float, optional
    ///     Play scale: the displacement of the virtual joints is drawn larger by this factor, from 1 to 1e9; joints keep their positions.
    /// view_rad : (float, float), optional
    ///     Azimuth and elevation of the direction to the viewer, with z up (rad); default: the view that separates the joints best.
    /// title : str, optional
    ///     Title above the picture, empty for none; default: the mechanism's name.
    /// width_px : float, optional
    ///     Width (px), of which 720 are 180 mm on paper.
    /// labels : str or dict of str to str, optional
    ///     Names in the picture: ``'auto'``, ``'joints'``, ``'links'``, ``'all'`` or ``'none'``; or own texts in place of the names of joints, virtual joints and links, of which an empty one hides the name.
    /// text_scale : float, optional
    ///     Size of text and lines, as a multiple of the default; the picture keeps its width.
    /// font : str, optional
    ///     Font family of the SVG; PNG and PDF have the included font.
    ///
    /// Returns
    /// -------
    /// Picture
    #[pyo3(signature = (at=None, *, ghost=None, exaggerate=None, view_rad=None, title=None, width_px=720.0, labels=None, text_scale=1.0, font=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn draw<'py>(
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyAny>>,
        ghost: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = optional_real)] exaggerate: Option<f64>,
        view_rad: Option<(f64, f64)>,
        title: Option<String>,
        #[pyo3(from_py_with = number)] width_px: f64,
        labels: Option<LabelsArg>,
        #[pyo3(from_py_with = number)] text_scale: f64,
        font: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let configuration = self.configuration(py, at)?;
        let mut picture = MechanismPicture::new(&self.file.mechanism, configuration);
        if let Some(ghost) = ghost {
            picture.ghost = Some(self.configuration(py, Some(ghost))?);
        }
        if let Some(factor) = exaggerate {
            if !(1.0..=LARGEST_FACTOR).contains(&factor) {
                let message = format!("exaggerate is {factor}, but has to be from 1 to 1e9");
                return Err(errors::input(py, &message));
            }
            picture.exaggeration = Some(factor);
        }
        if let Some((azimuth, elevation)) = view_rad {
            if !(azimuth.is_finite() && elevation.abs() <= std::f64::consts::FRAC_PI_2) {
                let message =
                    "view_rad has to be a finite azimuth, and an elevation from -π/2 to π/2 rad";
                return Err(errors::input(py, message));
            }
            picture.view = Some(View { azimuth, elevation });
        }
        let mut own_texts: Vec<String> = Vec::new();
        if let Some(title) = title {
            own_texts.push(title.clone());
            picture.title = title;
        }
        match labels {
            Some(LabelsArg::Which(which)) => picture.labels = which_labels(py, &which)?,
            Some(LabelsArg::Own(texts)) => {
                own_texts.extend(texts.values().cloned());
                picture.own_labels = texts;
            }
            None => {}
        }
        let drawn = py.detach(|| {
            // An invalid scale is refused before it can make the width invalid.
            restyle_svg("", None, text_scale)?;
            picture.width = width_px / text_scale;
            restyle_svg(&picture.to_svg()?, font, text_scale)
        });
        let svg = drawn.map_err(|error| errors::input(py, &error.to_string()))?;
        skin::result(py, "Picture", &fields!(py; svg = svg, own_texts = own_texts))
    }
}

/// Names in a picture: which, or own texts.
#[derive(FromPyObject)]
enum LabelsArg {
    Which(String),
    Own(BTreeMap<String, String>),
}

/// Which names a picture shows, by their name.
fn which_labels(py: Python<'_>, name: &str) -> PyResult<Labels> {
    Ok(match name {
        "auto" => Labels::Auto,
        "joints" => Labels::Joints,
        "links" => Labels::Links,
        "all" => Labels::All,
        "none" => Labels::None,
        other => {
            let known = ["auto", "joints", "links", "all", "none"].map(str::to_owned);
            return Err(errors::unknown_name(py, "labels", other, &known));
        }
    })
}

/// Largest play scale: a nanometre drawn as a metre.
const LARGEST_FACTOR: f64 = 1e9;

impl PyMechanism {
    /// All coordinates, given as commands, as a configuration or as an array.
    fn configuration(
        &self,
        py: Python<'_>,
        given: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<DVector<f64>> {
        let commands = match given {
            None => self.commands(py, None)?,
            Some(given) => match given.cast::<PyDict>() {
                Ok(commands) => self.commands(py, Some(commands))?,
                Err(_) => return self.all_coordinates(py, given),
            },
        };
        let posed = py.detach(|| self.posed(&commands, None));
        posed.map(|posed| posed.coordinates).map_err(|error| errors::core(py, &error))
    }

    /// All coordinates of a configuration or an array.
    fn all_coordinates(&self, py: Python<'_>, given: &Bound<'_, PyAny>) -> PyResult<DVector<f64>> {
        let given = given.getattr_opt("configuration")?.unwrap_or_else(|| given.clone());
        let given = given.getattr_opt("coordinates")?.unwrap_or(given);
        let width = self.coordinates.all().len();
        let expected = format!("a dict, a Configuration or an array of shape ({width},)");
        let array = real(&given, "at", &expected)?;
        if array.shape() != [width] {
            let message =
                format!("a configuration has to be {expected}, but has shape {:?}", array.shape());
            return Err(errors::input(py, &message));
        }
        let values: Vec<f64> = array.readonly().as_array().iter().copied().collect();
        Ok(DVector::from_vec(values))
    }
}

/// A picture as PNG.
#[pyfunction]
pub(crate) fn picture_as_png<'py>(
    py: Python<'py>,
    svg: &str,
    width_px: u32,
) -> PyResult<Bound<'py, PyBytes>> {
    bytes(py, py.detach(|| svg_to_png(svg, width_px)))
}

/// A picture as PDF.
#[pyfunction]
pub(crate) fn picture_as_pdf<'py>(py: Python<'py>, svg: &str) -> PyResult<Bound<'py, PyBytes>> {
    bytes(py, py.detach(|| svg_to_pdf(svg)))
}

/// A picture for LaTeX: source, and graphics as PDF.
#[pyfunction]
pub(crate) fn picture_as_latex<'py>(
    py: Python<'py>,
    svg: &str,
    pdf_name: &str,
    own_texts: Vec<String>,
) -> PyResult<(String, Bound<'py, PyBytes>)> {
    let made = py.detach(|| svg_to_latex(svg, pdf_name, &own_texts));
    let LatexFigure { tex, pdf } = made.map_err(|error| errors::input(py, &error.to_string()))?;
    Ok((tex, PyBytes::new(py, &pdf)))
}

fn bytes<'py>(
    py: Python<'py>,
    made: Result<Vec<u8>, jointplay::plot::Error>,
) -> PyResult<Bound<'py, PyBytes>> {
    let made = made.map_err(|error| errors::input(py, &error.to_string()))?;
    Ok(PyBytes::new(py, &made))
}
