//! `jointplay simulate`: data and figures of the paper's studies.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use jointplay::format::number::number;
use jointplay::format::units::{deg, m_from_mm, mm};
use jointplay::format::{robot, steps};
use jointplay::gpr::AxisHeight;
use jointplay::plot::Figure;
use jointplay::plot::results::{rods, sides, virtual_joints};
use jointplay::report::table;
use jointplay::report::{self, StudyReport};
use jointplay::study::{Order, Raster, Samples, SeriesKind, check_bounds, simulate, summarize};

use super::simulate_text;
use crate::arguments::{
    MetricArgs, RobotArgs, SolverName, Steps, VirtualizationName, finite, length, tilt_angles,
};
use crate::failure::Failure;
use crate::figure::{FIGURE_REFINEMENT, svg_and_png};
use crate::folder::{self, ForceArgs};
use crate::output::{self, FormatArgs};
use crate::progress::Progress;

/// Run the paper's studies and write data and figures
///
/// Computes a raster over azimuth and angle of the tilt (yaw and pitch in the paper) under each virtualization; every pose is solved from the nominal virtual joints.
/// By default these are the paper's studies VI.A (polar) and VI.B (offset), and the same for radial and planar.
/// As in the paper, the raster exceeds the robot's tilt limit.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay simulate
  jointplay simulate --azimuth-step-deg 1 --virtualization polar,planar --out fine-study
  jointplay simulate --tilt-deg -1.5:1.5:0.1 --order serpentine --metric radius --out serpentine")]
pub(crate) struct Simulate {
    /// Virtualizations, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "all")]
    virtualization: Vec<VirtualizationChoice>,
    /// Solver for the virtual joints
    #[arg(long, value_enum, default_value = "newton")]
    solver: SolverName,
    #[command(flatten)]
    metric: MetricArgs,
    /// Step of the azimuth from 0° to 360°, both ends included
    #[arg(long, value_name = "DEG", default_value = "10", value_parser = finite)]
    azimuth_step_deg: f64,
    /// Range of the tilt angle of each azimuth
    #[arg(long, value_name = "FROM:TO:STEP", default_value = "-2:2:0.2", value_parser = tilt_angles)]
    tilt_deg: Steps,
    /// Axis height [default: the robot's working height]
    #[arg(long, value_name = "MM", value_parser = length)]
    height_mm: Option<f64>,
    /// Order of the samples
    #[arg(long, value_enum, default_value = "raster")]
    order: OrderName,
    /// Format of the sample tables; parquet needs a build with --features parquet
    #[arg(long, value_enum, default_value = "csv")]
    table: TableFormat,
    /// Folder for the results
    #[arg(short, long, value_name = "FOLDER", default_value = "paper-study")]
    out: PathBuf,
    #[command(flatten)]
    force: ForceArgs,
    #[command(flatten)]
    robot: RobotArgs,
    #[command(flatten)]
    pub(crate) format: FormatArgs,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum VirtualizationChoice {
    /// all four
    All,
    /// three radial displacements
    Radial,
    /// the paper's V.A
    Polar,
    /// the paper's V.B
    Offset,
    /// displacements in Cartesian coordinates
    Planar,
}

#[derive(Clone, Copy, ValueEnum)]
enum OrderName {
    /// every azimuth from the first tilt angle to the last, as in the paper
    Raster,
    /// every other azimuth from the last tilt angle to the first, continuous in time
    Serpentine,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum TableFormat {
    /// text, for spreadsheets
    Csv,
    /// binary columns, for data frames
    #[cfg(feature = "parquet")]
    Parquet,
}

/// File with the results of a run and the list of its files.
const SUMMARY: &str = "summary.json";
/// File that explains the others.
const README: &str = "README.md";
/// Value of `command` in summaries of this program.
const COMMAND: &str = "jointplay simulate";
/// Largest number of poses of a study: all are kept in memory, for each virtualization.
const MOST_POSES: usize = 500_000;

/// One virtualization's study.
struct Study {
    samples: Samples,
    /// One tilt direction in finer steps, for its figures.
    one_direction: Samples,
    report: StudyReport,
}

impl Simulate {
    pub(crate) fn run(&self) -> Result<(), Failure> {
        let robot = self.robot.load()?;
        let raster = self.raster(&robot)?;
        if raster.len() > MOST_POSES {
            return Err(Failure::TooManyPoses { found: raster.len(), allowed: MOST_POSES });
        }
        let own = own_files(&self.out);
        folder::check_folder(&self.out, self.force)?;
        let names = self.virtualizations();
        let mut progress = Progress::new(raster.len() * names.len() * 2);
        let studies = names
            .iter()
            .map(|&name| self.study(&robot, &raster, name, &mut progress))
            .collect::<Result<Vec<Study>, Failure>>()?;
        progress.stage("drawing figures");
        let mut files = Vec::new();
        for study in &studies {
            files.push(self.table(&study.samples)?);
        }
        let figures: Vec<(String, Figure)> = figures(&studies);
        for (name, figure) in &figures {
            files.extend(svg_and_png(name, figure)?);
        }
        // Written first: it identifies the other files as results of this program, even if the run is killed.
        let mut names: Vec<String> = files.iter().map(|(name, _)| name.clone()).collect();
        names.insert(0, SUMMARY.to_owned());
        names.push(README.to_owned());
        let summary = self.summary(&robot, &raster, &studies, &names);
        files.insert(0, (SUMMARY.to_owned(), summary.clone().into_bytes()));
        files.push((README.to_owned(), simulate_text::READ_ME.as_bytes().to_vec()));
        folder::write(&self.out, &files, self.force)?;
        folder::remove_stale(&self.out, &own, &files)?;
        drop(progress);
        if self.format.json() {
            return output::raw(&summary);
        }
        let reports: Vec<&StudyReport> = studies.iter().map(|study| &study.report).collect();
        let heading = format!(
            "{}: {} poses, azimuth 0° to 360° by {}°, tilt angle {}° to {}°, axis height {} mm",
            robot.name,
            raster.len(),
            number(self.azimuth_step_deg),
            number(self.tilt_deg.0.first().copied().unwrap_or_default()),
            number(self.tilt_deg.0.last().copied().unwrap_or_default()),
            number(mm(raster.height.0)),
        );
        let mut text = simulate_text::table(&heading, &reports);
        text.push_str(&format!("{} files written into {}\n", files.len(), self.out.display()));
        output::text(&text)
    }

    fn raster(&self, robot: &robot::Robot) -> Result<Raster, Failure> {
        let step = self.azimuth_step_deg;
        if step > 360.0 {
            let source = steps::Error::Misses {
                from: 0.0,
                to: 360.0,
                step,
                intervals: 360.0 / step,
                nearest: 360.0,
            };
            return Err(Failure::AzimuthStep { step, source });
        }
        let azimuths = steps::spread(0.0, 360.0, step)
            .map_err(|source| Failure::AzimuthStep { step, source })?;
        Ok(Raster {
            azimuths: azimuths.into_iter().map(f64::to_radians).collect(),
            tilt_angles: self.tilt_deg.0.iter().map(|tilt_angle| tilt_angle.to_radians()).collect(),
            height: AxisHeight(self.height_mm.map_or(robot.gpr.working_height(), m_from_mm)),
            order: match self.order {
                OrderName::Raster => Order::Raster,
                OrderName::Serpentine => Order::Serpentine,
            },
        })
    }

    /// The selected virtualizations, each once, in the order of the list.
    fn virtualizations(&self) -> Vec<VirtualizationName> {
        use VirtualizationChoice as Choice;
        let all = [
            (Choice::Radial, VirtualizationName::Radial),
            (Choice::Polar, VirtualizationName::Polar),
            (Choice::Offset, VirtualizationName::Offset),
            (Choice::Planar, VirtualizationName::Planar),
        ];
        let chosen = |choice| {
            self.virtualization.contains(&Choice::All) || self.virtualization.contains(&choice)
        };
        all.into_iter().filter(|&(choice, _)| chosen(choice)).map(|(_, name)| name).collect()
    }

    fn study(
        &self,
        robot: &robot::Robot,
        raster: &Raster,
        name: VirtualizationName,
        progress: &mut Progress,
    ) -> Result<Study, Failure> {
        let (gpr, model) = (&robot.gpr, name.model());
        let options = self.metric.options(self.solver);
        progress.stage(model.name());
        let samples = simulate(gpr, raster, model, &options, &mut |done| progress.at(done))?;
        let one_direction =
            simulate(gpr, &raster.one_direction(FIGURE_REFINEMENT), model, &options, &mut |_| {})?;
        progress.part_done(raster.len());
        let bounds = check_bounds(gpr, raster, model, &options, &mut |done| progress.at(done))?;
        progress.part_done(raster.len());
        let report = report::study(gpr, &samples, &summarize(gpr, &samples), &bounds);
        Ok(Study { samples, one_direction, report })
    }

    fn table(&self, samples: &Samples) -> Result<(String, Vec<u8>), Failure> {
        let columns = table::columns(samples);
        let stem = format!("samples-{}", samples.virtualization);
        match self.table {
            TableFormat::Csv => Ok((format!("{stem}.csv"), table::csv(&columns).into_bytes())),
            #[cfg(feature = "parquet")]
            TableFormat::Parquet => {
                let bytes = table::parquet(&columns).map_err(|_| Failure::Parquet)?;
                Ok((format!("{stem}.parquet"), bytes))
            }
        }
    }

    fn summary(
        &self,
        robot: &robot::Robot,
        raster: &Raster,
        studies: &[Study],
        files: &[String],
    ) -> String {
        let tilt_angles = &self.tilt_deg.0;
        let document = serde_json::json!({
            "command": COMMAND,
            "robot": robot.name,
            "poses": raster.len(),
            "azimuth_step_deg": self.azimuth_step_deg,
            "tilt_deg": { "from": tilt_angles.first(), "to": tilt_angles.last(), "values": tilt_angles.len() },
            "axis_height_mm": mm(raster.height.0),
            "order": match raster.order { Order::Raster => "raster", Order::Serpentine => "serpentine" },
            "beyond_limits_on_purpose": deg(robot.gpr.limits().tilt_max)
                < tilt_angles.iter().fold(0.0, |most: f64, tilt_angle| most.max(tilt_angle.abs())),
            "studies": studies.iter().map(|study| &study.report).collect::<Vec<_>>(),
            "files": files,
        });
        output::to_json(&document) + "\n"
    }
}

/// The figures of all studies: Figs. 5 to 11 by the paper's numbers, the other virtualizations by name.
///
/// Rods and sides do not depend on the virtualization; they are drawn once.
fn figures(studies: &[Study]) -> Vec<(String, Figure)> {
    type Part = fn(&Study) -> &Samples;
    let parts: [(Part, &str); 2] =
        [(|study| &study.samples, ""), (|study| &study.one_direction, "-zoom")];
    let mut figures = Vec::new();
    for (part, suffix) in parts {
        if let Some(study) = studies.first() {
            figures.push((format!("fig05-rods{suffix}"), rods(part(study))));
            figures.push((format!("fig08-fig11-sides{suffix}"), sides(part(study))));
        }
        for study in studies {
            for (kind, name) in [(SeriesKind::Linear, "linear"), (SeriesKind::Angular, "angular")] {
                let stem = figure_stem(&study.report.virtualization, name);
                let figure = virtual_joints(part(study), kind);
                figures.extend(figure.map(|figure| (format!("{stem}{suffix}"), figure)));
            }
        }
    }
    figures
}

/// Name of a figure, with its number in the paper if it has one.
fn figure_stem(virtualization: &str, part: &str) -> String {
    let number = match (virtualization, part) {
        ("polar", "linear") => "fig06-",
        ("polar", "angular") => "fig07-",
        ("offset", "linear") => "fig09-",
        ("offset", "angular") => "fig10-",
        _ => "",
    };
    format!("{number}{virtualization}-{part}")
}

/// Files of the last run, as listed in the summary of its folder; none without a summary of this program.
fn own_files(folder: &Path) -> BTreeSet<String> {
    let text = std::fs::read_to_string(folder.join(SUMMARY)).unwrap_or_default();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    if summary["command"] != COMMAND {
        return BTreeSet::new();
    }
    let files = summary["files"].as_array().into_iter().flatten();
    files.filter_map(|name| name.as_str()).map(str::to_owned).collect()
}
