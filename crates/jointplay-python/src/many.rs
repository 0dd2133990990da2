//! Many poses at a time.

use jointplay::bulk::{Column, PoseSolver, Quantity, Status, StatusCounts, parts};
use jointplay::gpr::Gpr;
use jointplay::study::parallel::{self, PoseColumns};
use jointplay::virtualization::SolveOptions;
use numpy::PyArray;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};

use crate::arrays::{Output, Spread, Triples};
use crate::errors;
use crate::model::{Model, ModelNames};
use crate::quantities::Named;
use crate::skin::{self, fields};
use crate::threads::Threads;

/// The statuses as an array of `uint8`, and the number of poses with each.
pub(crate) fn evidence<'py>(
    py: Python<'py>,
    shape: &[usize],
    status: Vec<Status>,
    tally: StatusCounts,
    fields: &Bound<'py, PyDict>,
) -> PyResult<()> {
    let numbers: Vec<u8> = status.into_iter().map(|status| status as u8).collect();
    let numbers = numpy::ndarray::ArrayD::from_shape_vec(shape, numbers)
        .map_err(|error| errors::internal(&error.to_string()))?;
    fields.set_item("status", PyArray::from_owned_array(py, numbers))?;
    let counts = PyDict::new(py);
    for status in Status::ALL {
        if status != Status::Solved && tally.count(status) > 0 {
            counts.set_item(status.name(), tally.count(status))?;
        }
    }
    fields.set_item("failed", tally.failed())?;
    fields.set_item("failure_counts", counts)
}

/// Poses between two looks at whether the user has had enough: some milliseconds of them.
const PART: usize = 1 << 18;

/// Does the work without holding up Python's other threads, and stops where a signal asks for it.
fn in_parts(
    py: Python<'_>,
    given: [Column<'_>; 3],
    status: &mut [Status],
    written: Vec<&mut [f64]>,
    work: impl Fn(
        [Column<'_>; 3],
        &mut [Status],
        Vec<&mut [f64]>,
    ) -> Result<StatusCounts, jointplay::Error>
    + Sync,
) -> PyResult<StatusCounts> {
    let mut sum = StatusCounts::default();
    for (given, status, written) in parts(given, status, written, PART) {
        py.check_signals()?;
        sum +=
            py.detach(|| work(given, status, written)).map_err(|error| errors::core(py, &error))?;
    }
    Ok(sum)
}

/// Requested quantities, and arrays to write them into.
pub(crate) struct Wanted<'a, 'py> {
    pub(crate) quantities: Option<&'a Bound<'py, PyAny>>,
    pub(crate) out: Option<&'a Bound<'py, PyDict>>,
    pub(crate) threads: Option<&'a Bound<'py, PyAny>>,
}

impl<'py> Wanted<'_, 'py> {
    /// The requested names: those given, else those of the output arrays.
    fn names(&self) -> PyResult<Option<Vec<String>>> {
        match (self.quantities, self.out) {
            (Some(names), _) if names.is_instance_of::<PyString>() => {
                Ok(Some(vec![names.extract()?]))
            }
            (Some(names), _) => {
                names.try_iter()?.map(|name| name?.extract()).collect::<PyResult<_>>().map(Some)
            }
            (None, Some(out)) => out.keys().iter().map(|name| name.extract()).collect(),
            (None, None) => Ok(None),
        }
    }

    /// An array for each quantity: the caller's, or a new one.
    fn outputs(
        &self,
        py: Python<'py>,
        shape: &[usize],
        virtual_joints: usize,
    ) -> PyResult<Vec<(&'static Named, Output<'py>)>> {
        let names = self.names()?;
        let named = Named::of(py, names.as_deref())?;
        if let Some(out) = self.out {
            for name in out.keys() {
                let name: String = name.extract()?;
                if !named.iter().any(|one| one.name == name) {
                    let known: Vec<String> = named.iter().map(|one| one.name.to_owned()).collect();
                    let what = "an array is given for a quantity that is not asked for:";
                    return Err(errors::unknown_name(py, what, &name, &known));
                }
            }
        }
        let output = |one: &'static Named| {
            let given = self.out.map(|out| out.get_item(one.name)).transpose()?.flatten();
            let width = one.width(virtual_joints);
            let made = match given {
                Some(array) => Output::given(&array, &format!("out[{:?}]", one.name), shape, width),
                None => Output::new(py, shape, width),
            };
            Ok((one, made?))
        };
        named.into_iter().map(output).collect()
    }
}

/// Where the platform is for each of many rods: by the solver of the robot, or by an own virtualization.
pub(crate) fn forward<'py>(
    py: Python<'py>,
    (gpr, solver): (&Gpr, Option<&PoseSolver>),
    rods: &Triples<'py>,
    model: &Model,
    options: &SolveOptions,
    wanted: &Wanted<'_, 'py>,
) -> PyResult<Bound<'py, PyAny>> {
    let virtual_joints = model.virtualization().joints().len();
    let threads = Threads::of(wanted.threads, rods.poses())?;
    let mut outputs = wanted.outputs(py, &rods.shape, virtual_joints)?;
    let mut status = vec![Status::Solved; rods.poses()];
    let columns = rods.columns()?;
    let mut slices: Vec<(Quantity, &mut [f64])> = Vec::new();
    for (named, output) in &mut outputs {
        slices.extend(named.quantities(virtual_joints).into_iter().zip(output.slices()?));
    }
    let (quantities, written): (Vec<Quantity>, Vec<&mut [f64]>) = slices.into_iter().unzip();
    let tally = in_parts(py, columns, &mut status, written, |columns, status, written| {
        let mut wanted: Vec<_> = quantities.iter().copied().zip(written).collect();
        match (solver, &threads) {
            // Python's own code runs in one thread at a time anyhow.
            (None, _) => {
                gpr.forward_many(columns, model.virtualization(), options, status, &mut wanted)
            }
            (Some(solver), Threads::Here) => solver.forward_many(columns, status, &mut wanted),
            (Some(solver), Threads::Pool(pool)) => {
                pool.install(|| parallel::poses_many(solver, columns, status, &mut wanted))
            }
        }
    });
    if let Some(raised) = model.raised() {
        return Err(raised);
    }
    let tally = tally?;
    let names = ModelNames::of_model(model);
    let fields = fields!(py;
        virtualization = names.name.as_str(),
        virtual_joint_names = PyTuple::new(py, names.joint_names())?,
    );
    let arrays = PyDict::new(py);
    for (named, output) in outputs {
        arrays.set_item(named.name, output.array)?;
    }
    fields.set_item("arrays", arrays)?;
    evidence(py, &rods.shape, status, tally, &fields)?;
    skin::result(py, "ForwardMany", &fields)
}

/// The limits that many poses break.
pub(crate) fn broken_limits<'py>(
    py: Python<'py>,
    gpr: &Gpr,
    rods: &Triples<'py>,
    tilt_angle: Option<&Spread<'py>>,
) -> PyResult<Bound<'py, PyAny>> {
    let mut broken = [(); 4].map(|()| vec![false; rods.poses()]);
    let tilt_angle =
        tilt_angle.map(Spread::columns).transpose()?.and_then(|columns| columns.first().copied());
    gpr.broken_limits_many(
        rods.columns()?,
        tilt_angle,
        broken.each_mut().map(|column| &mut column[..]),
    )
    .map_err(|error| errors::core(py, &error))?;
    let array = |column: Vec<bool>| {
        let column = numpy::ndarray::ArrayD::from_shape_vec(&rods.shape[..], column)
            .map_err(|error| errors::internal(&error.to_string()))?;
        Ok::<_, PyErr>(PyArray::from_owned_array(py, column))
    };
    let [first, second, third, tilt] = broken;
    let each = [array(first)?, array(second)?, array(third)?];
    let along_last = fields!(py; axis = -1);
    let rods =
        py.import("numpy")?.call_method("stack", (PyTuple::new(py, each)?,), Some(&along_last))?;
    skin::result(py, "BrokenLimits", &fields!(py; rods = rods, tilt = array(tilt)?))
}

/// The rods of many tilts.
pub(crate) fn inverse<'py>(
    py: Python<'py>,
    gpr: &Gpr,
    given: &Spread<'py>,
    out: Option<&Bound<'py, PyAny>>,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let threads = Threads::of(threads, given.poses())?;
    let mut output = match out {
        Some(array) => Output::given(array, "out", &given.shape, Some(3))?,
        None => Output::new(py, &given.shape, Some(3))?,
    };
    let mut status = vec![Status::Solved; given.poses()];
    let columns = given.columns()?;
    let columns: [Column<'_>; 3] =
        columns.try_into().map_err(|_| errors::internal("a tilt is not three columns"))?;
    let tally = in_parts(py, columns, &mut status, output.slices()?, |columns, status, rods| {
        let Ok(rods) = <[&mut [f64]; 3]>::try_from(rods) else {
            unreachable!("an output of width three has three columns")
        };
        let [azimuth, tilt_angle, height] = columns;
        match &threads {
            Threads::Here => gpr.inverse_many(azimuth, tilt_angle, height, status, rods),
            Threads::Pool(pool) => pool.install(|| {
                parallel::inverse_many(
                    gpr,
                    PoseColumns { azimuth, tilt_angle, height },
                    status,
                    rods,
                )
            }),
        }
    })?;
    let fields = fields!(py; rods_m = output.array);
    evidence(py, &given.shape, status, tally, &fields)?;
    skin::result(py, "InverseMany", &fields)
}
