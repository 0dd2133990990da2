//! The robot under the platform, and the model of the platform's position.

use crate::display_units::DisplayUnits;
use jointplay_cell::robot::PlatformModel;
use jointplay_core::gpr::{Gpr, Limb, Limits};
use jointplay_core::virtualization::{BuiltIn, Metric, SolveOptions, Solver};
use nalgebra::Vector2;

use super::super::problem::Fault;
use super::super::tree::{AllowedRange, Entry, Reader, Table};
use crate::explain::explain;
use crate::file_problem::FileProblem;
use crate::units::m_from_mm;
use crate::{catalogue, robot};

/// A three-rod robot by name or as a table.
pub(super) fn three_rods(reader: &Reader, entry: Entry) -> Option<Gpr> {
    if entry.is_text() {
        let name = entry.text(reader)?;
        let is_gpr = |entry: &&catalogue::Entry| entry.kind().as_deref() == Some("gpr");
        let known = catalogue::entries().iter().filter(is_gpr);
        let Some(found) = known.clone().find(|entry| entry.name == name) else {
            let names: Vec<String> = known.map(|entry| entry.name.to_owned()).collect();
            entry.unknown(reader, "three-rod robot", name, &names);
            return None;
        };
        return robot::parse(found.text).ok().map(|robot| robot.gpr);
    }
    let table = entry.table(reader, "`[gpr]`")?;
    let limbs: Vec<Option<Limb>> = table.tables("limb").iter().map(limb).collect();
    let limits = table.needed("limits").and_then(|entry| entry.table(reader, "`[gpr.limits]`"));
    let limits = limits.and_then(|limits| {
        let rods = limits
            .needed("rod_mm")
            .and_then(|rods| rods.numbers::<2, _>(reader, AllowedRange::Within(-1e6, 1e6)));
        let tilt = limits.number("tilt_deg", AllowedRange::Positive);
        limits.finish();
        let [rod_min, rod_max] = rods?.map(m_from_mm);
        Some(Limits { rod_min, rod_max, tilt_max: tilt?.to_radians() })
    });
    let working = table.needed("working").and_then(|entry| entry.table(reader, "`[gpr.working]`"));
    let height = working.and_then(|working| {
        let height = working.length("height_mm", AllowedRange::Any);
        working.finish();
        height
    });
    table.finish();
    if limbs.len() != 3 {
        let found = limbs.len();
        table.report(FileProblem::Count { key: "limb".to_owned(), found, needed: "3".to_owned() });
        return None;
    }
    let limbs: Vec<Limb> = limbs.into_iter().collect::<Option<_>>()?;
    let made = Gpr::new([limbs[0], limbs[1], limbs[2]], limits?, height?);
    made.map_err(|error| table.report(Fault::Unfit(explain(&error, DisplayUnits::Metric)))).ok()
}

fn limb(table: &Table) -> Option<Limb> {
    let radius = table.length("socket_radius_mm", AllowedRange::Positive);
    let angle = table.number("socket_angle_deg", AllowedRange::Within(-36_000.0, 36_000.0));
    let point = table
        .entry("base_point_mm")
        .map(|entry| entry.numbers::<2, _>(table.reader, AllowedRange::Within(-1e6, 1e6)));
    table.finish();
    let mut limb = Limb::under_socket(radius?, angle?.to_radians());
    if let Some(point) = point {
        limb.base_point = Vector2::from(point?.map(m_from_mm));
    }
    Some(limb)
}

/// Words for metrics that are not lengths.
const METRICS: [(&str, Metric); 2] = [("paper", Metric::Paper), ("radius", Metric::PlatformRadius)];

/// Model of the platform's position over the rods; planar in closed form by default.
pub(super) fn platform(table: &Table) -> Option<PlatformModel> {
    let reader = table.reader;
    let Some(entry) = table.entry("platform") else { return Some(PlatformModel::default()) };
    let table = entry.table(reader, "`[platform]`")?;
    let kernels = [
        ("radial", BuiltIn::Radial),
        ("polar", BuiltIn::Polar),
        ("offset", BuiltIn::Offset),
        ("planar", BuiltIn::Planar),
    ];
    let kernel = table
        .needed("virtualization")
        .and_then(|entry| entry.word(reader, "virtualization", &kernels));
    let (solver, metric) = (table.entry("solver"), table.entry("metric"));
    table.finish();
    let virtualization = kernel?;
    let has_angles = matches!(virtualization, BuiltIn::Polar | BuiltIn::Offset);
    let mut options = SolveOptions::default();
    let mut solvers = vec![Solver::Newton, Solver::LeastNorm];
    if has_angles {
        // The least-norm solver is the default of virtualizations without a closed form.
        options.solver = Solver::LeastNorm;
    } else {
        solvers.push(Solver::ClosedForm);
    }
    if let Some(entry) = solver {
        let names: Vec<String> = solvers.iter().map(Solver::to_string).collect();
        let known: Vec<(&str, Solver)> = names.iter().map(String::as_str).zip(solvers).collect();
        let name = virtualization_name(virtualization);
        options.solver = entry.word(reader, &format!("a solver of {name},"), &known)?;
    }
    if let Some(entry) = metric {
        if !has_angles {
            let why = "`metric` weighs angles against lengths, and only polar and offset have angles; remove it";
            entry.report(reader, Fault::Unfit(why.to_owned()));
            return None;
        }
        options.metric = if entry.is_text() {
            entry.word(reader, "a metric that is no length in mm,", &METRICS)?
        } else {
            let length = entry.number(reader, AllowedRange::Within(1e-9, 1e9))?;
            Metric::Length(m_from_mm(length))
        };
    }
    Some(PlatformModel { virtualization, options })
}

/// Name of a virtualization in files and on the command line.
#[must_use]
pub fn virtualization_name(kernel: BuiltIn) -> &'static str {
    match kernel {
        BuiltIn::Radial => "radial",
        BuiltIn::Polar => "polar",
        BuiltIn::Offset => "offset",
        BuiltIn::Planar => "planar",
    }
}
