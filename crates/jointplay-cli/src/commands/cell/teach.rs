//! `jointplay cell teach`: station poses from taught points.

use std::fmt::Write as _;
use std::path::Path;

use clap::Args;
use jointplay::format::cell::{self, Change};
use jointplay::format::number::number;
use jointplay::format::place::not_known;
use jointplay::format::units::m_from_mm;
use jointplay::nalgebra::Vector3;
use jointplay::plot::cell::Taught;
use jointplay::report::{self, StationReport, TeachReport};

use super::input::{CellArgs, CellSource};
use crate::arguments::{finite, length};
use crate::failure::Failure;
use crate::figure::FigureArgs;
use crate::folder::{self, ForceArgs};
use crate::output::{self, fixed};

/// Compute the pose of a station from taught points, or list the poses of all stations
///
/// Three or more points on the resting plane determine its tilt, the uncertainty of the tilt, and the distances of the points from the plane.
/// The positions of the first and the last wafer determine the tilt by the drift between them.
/// Without points, the poses in the cell file are listed.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell teach
  jointplay cell teach --figure stations.png
  jointplay cell teach --station LP2 --first-mm -495,-495,500 --last-mm -492,-495,740

Exit codes: 0 done, 1 the tilt exceeds the robot's limit, the points are scattered, or the plane is too uncertain, 2 bad input or usage.")]
pub(super) struct Teach {
    #[command(flatten)]
    pub(super) cell: CellArgs,
    /// Name of the station
    #[arg(long, value_name = "NAME")]
    station: Option<String>,
    /// Point of the resting plane in the base frame; give three or more
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "station", conflicts_with_all = ["first_mm", "last_mm"])]
    point_mm: Vec<Point>,
    /// Largest accepted distance of a point from the plane
    #[arg(long, value_name = "UM", default_value = "100", value_parser = threshold)]
    threshold_um: f64,
    /// Standard deviation of a measured coordinate [default: estimated from the points]
    #[arg(long, value_name = "UM", value_parser = threshold, requires = "point_mm")]
    noise_um: Option<f64>,
    /// Position of the wafer in the first slot, in the base frame
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires_all = ["station", "last_mm"])]
    first_mm: Option<Point>,
    /// Position of the wafer in the last slot, in the base frame
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires_all = ["station", "first_mm"])]
    last_mm: Option<Point>,
    #[command(flatten)]
    figure: FigureArgs,
    /// Write the pose into the cell file, keeping its comments
    #[arg(long, requires = "station")]
    write: bool,
}

/// A point (m).
#[derive(Clone, Debug)]
struct Point(Vector3<f64>);

fn point(text: &str) -> Result<Point, String> {
    let values = text.split(',').map(length).collect::<Result<Vec<f64>, String>>()?;
    let values: [f64; 3] = values
        .try_into()
        .map_err(|values: Vec<f64>| format!("expected 3 coordinates, got {}", values.len()))?;
    Ok(Point(Vector3::from(values.map(m_from_mm))))
}

fn threshold(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value > 0.0 && value <= 1e5 {
        Ok(value)
    } else {
        Err(format!("value must be above 0 and at most 100000 µm, got {} µm", number(value)))
    }
}

impl Teach {
    pub(super) fn run(&self) -> Result<(), Failure> {
        self.figure.target()?;
        let mut source = self.cell.load()?;
        if let Some(station) = &self.station {
            let names: Vec<String> =
                source.cell.stations.iter().map(|station| station.name.clone()).collect();
            if !names.contains(station) {
                return Err(Failure::Usage(not_known("the station", station, &names)));
            }
            if let Some(change) = self.change() {
                source = changed(source, station, change)?;
                if self.write {
                    self.save(&source)?;
                }
            }
        }
        let document = report::teach(&source.cell, self.station.as_deref());
        if self.cell.format.json() {
            output::json(&document)?;
        } else {
            output::text(&text(&document))?;
        }
        let picture = self.picture(&source);
        let written = self.figure.write(&picture)?;
        if let Some(path) = written.filter(|_| !self.cell.format.json()) {
            output::text(&format!("picture: {}\n", path.display()))?;
        }
        let scattered = document.stations.iter().find(|station| {
            station.plane.as_ref().is_some_and(|plane| plane.verdict == "scattered")
        });
        if let Some(station) = scattered {
            return Err(Failure::Unsolved(format!(
                "the taught points of {} are scattered: teach them again, or increase --threshold-um",
                station.name
            )));
        }
        let uncertain = document.stations.iter().find_map(|station| {
            let plane = station.plane.as_ref().filter(|plane| plane.verdict == "uncertain")?;
            Some((&station.name, plane, plane.uncertainty.as_ref()?))
        });
        uncertain.map_or(Ok(()), |(name, plane, known)| {
            Err(Failure::Unsolved(format!(
                "the tilt of the taught plane of {name} is uncertain by ±{} µrad, but only {} µrad are allowed (`plane_urad`): teach more points, points farther apart, or reduce the noise",
                fixed(known.tilt_95_urad, 1),
                fixed(plane.allowed_urad, 1)
            )))
        })
    }

    /// The picture of the selected stations.
    fn picture<'a>(&self, source: &'a CellSource) -> Taught<'a> {
        let mut picture = Taught::new(&source.cell);
        if let Some(station) = &self.station {
            picture.stations.retain(|&k| source.cell.stations[k].name == *station);
            picture.title = source.cell.name.clone();
        }
        picture
    }

    fn change(&self) -> Option<Change> {
        match (&self.first_mm, &self.last_mm) {
            (Some(first), Some(last)) => Some(Change::Drift { first: first.0, last: last.0 }),
            _ if self.point_mm.is_empty() => None,
            _ => Some(Change::Taught {
                points: self.point_mm.iter().map(|point| point.0).collect(),
                threshold: m_from_mm(self.threshold_um / 1e3),
                noise: self.noise_um.map(|noise| m_from_mm(noise / 1e3)),
            }),
        }
    }

    fn save(&self, source: &CellSource) -> Result<(), Failure> {
        if self.cell.is_standard_input() {
            let text = "--write needs a cell file, not standard input";
            return Err(Failure::Usage(text.to_owned()));
        }
        if source.folder.is_none() {
            let text = "--write needs a cell file; use `jointplay cell example` to write the example into files";
            return Err(Failure::Usage(text.to_owned()));
        }
        folder::write_file(Path::new(&source.label), source.text.as_bytes(), ForceArgs::REPLACE)
    }
}

/// The cell with another pose of one station.
fn changed(source: CellSource, station: &str, change: Change) -> Result<CellSource, Failure> {
    let text = cell::set_station(&source.text, station, &[change])
        .map_err(|problem| Failure::at(&problem, &source.label))?;
    match CellSource::parse(source.label, source.stem, text, source.folder) {
        // The file was valid before: the new points are infeasible.
        Err(Failure::Invalid(all)) => Err(Failure::Infeasible(all)),
        other => other,
    }
}

fn text(report: &TeachReport) -> String {
    let mut text = format!("{}, stations\n", report.cell);
    for station in &report.stations {
        let _ = writeln!(text, "{}", station.name);
        write_station(&mut text, station, report.tilt_limit_deg);
    }
    text
}

fn write_station(text: &mut String, station: &StationReport, limit: f64) {
    let [x, y, z] = station.position_mm.map(|value| fixed(value, 3));
    let origin = match station.from {
        "taught" => "plane of taught points",
        "drift" => "positions of first and last wafer",
        _ => "nominal, not taught",
    };
    let _ = writeln!(text, "  position (mm)        {x}, {y}, {z}; {origin}");
    if let Some(pitch) = station.pitch_mm {
        let _ = writeln!(text, "  pitch (mm)           {}", fixed(pitch, 3));
    }
    let _ = writeln!(
        text,
        "  tilt                 {}° toward yaw {}°, {} % of the robot's {}°",
        fixed(station.tilt_pitch_deg, 4),
        fixed(station.tilt_yaw_deg, 2),
        fixed(100.0 * station.tilt_share, 0),
        fixed(limit, 3)
    );
    if let Some(drift) = station.drift_mm {
        let _ = writeln!(text, "  drift (mm)           {}", fixed(drift, 3));
    }
    if let Some(plane) = &station.plane {
        let distances: Vec<String> = plane.distances_um.iter().map(|&one| fixed(one, 1)).collect();
        let result = match plane.verdict {
            "fits" => "fits",
            "uncertain" => "uncertain: the tilt uncertainty exceeds `plane_urad`",
            "unproven" if plane.freedom == 0 => {
                "unverified: three points always define a plane, teach a fourth"
            }
            "unproven" => {
                "unverified: too few points to test their noise; use --noise-um, or teach 6 or more"
            }
            _ => "scattered: teach them again",
        };
        let _ = writeln!(
            text,
            "  point distances (µm) {}; largest {}, allowed {}",
            distances.join(", "),
            fixed(plane.worst_um, 1),
            fixed(plane.threshold_um, 1)
        );
        let freedom = match plane.freedom {
            1 => "1 degree of freedom".to_owned(),
            freedom => format!("{freedom} degrees of freedom"),
        };
        let noise = match (&plane.noise_um, &plane.uncertainty) {
            (Some(noise), _) => format!("{} µm per coordinate, given", fixed(*noise, 1)),
            (None, Some(known)) => {
                format!("not given; {} µm estimated from the distances", fixed(known.noise_um, 1))
            }
            (None, None) => "not given; cannot be estimated from three points".to_owned(),
        };
        let _ = writeln!(text, "  noise                {noise}, {freedom}");
        match &plane.uncertainty {
            Some(known) => {
                let _ = writeln!(
                    text,
                    "  uncertainty          tilt ±{} µrad, height ±{} µm (95 %); tilt {} µrad rms, allowed {}",
                    fixed(known.tilt_95_urad, 1),
                    fixed(known.height_95_um, 1),
                    fixed(known.tilt_rms_urad, 1),
                    fixed(plane.allowed_urad, 1)
                );
            }
            None => {
                let _ = writeln!(text, "  uncertainty          unknown; use --noise-um");
            }
        }
        let _ = writeln!(text, "  result               {result}");
    }
}
