//! The Python binding: reads arrays and names, calls the façade, returns arrays.
//!
//! Classes for single poses, mechanisms and cells are here; errors and results of many numbers are Python classes in `python/jointplay/`, which this module fills.

mod analyses;
mod arrays;
mod arrow;
mod cell;
mod cell_plan;
mod command;
mod errors;
mod files;
mod fmu;
mod gpr;
mod gpr_analyses;
mod gpr_derivatives;
mod limits;
mod link_poses;
mod many;
mod mechanism;
mod mechanism_analyses;
mod mechanism_derivatives;
mod mechanism_drives;
mod mechanism_exports;
mod mechanism_results;
mod mechanism_suggest;
mod model;
mod numbers;
mod own_virtualization;
mod picture;
mod pose;
mod posed;
mod prepared;
mod quantities;
mod skin;
mod study_gathering;
mod study_plan;
mod symbol;
mod threads;

use pyo3::prelude::*;

#[pymodule]
fn _jointplay(module: &Bound<'_, PyModule>) -> PyResult<()> {
    // Loads NumPy now: its interface must not be asked for while a signal waits.
    let _ = numpy::PyArray1::<f64>::zeros(module.py(), 0, false);
    module.add_class::<gpr::PyGpr>()?;
    module.add_class::<mechanism::PyMechanism>()?;
    module.add_function(wrap_pyfunction!(mechanism::catalogue_of_names, module)?)?;
    module.add_class::<cell::PyCell>()?;
    module.add_class::<cell_plan::PyCellPlan>()?;
    module.add_class::<study_plan::PyPlan>()?;
    module.add_class::<study_plan::PyChunk>()?;
    module.add_class::<study_plan::PySchema>()?;
    module.add_class::<study_gathering::PyGathering>()?;
    module.add_class::<pose::PyForward>()?;
    module.add_class::<pose::PyInverse>()?;
    module.add_function(wrap_pyfunction!(arrow::arrow_stream, module)?)?;
    module.add_function(wrap_pyfunction!(picture::picture_as_png, module)?)?;
    module.add_function(wrap_pyfunction!(picture::picture_as_pdf, module)?)?;
    module.add_function(wrap_pyfunction!(picture::picture_as_latex, module)?)?;
    module.add_function(wrap_pyfunction!(command::run_command, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
