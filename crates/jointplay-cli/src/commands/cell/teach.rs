//! `jointplay cell teach`: stations from taught points.

use std::fmt::Write as _;
use std::path::Path;

use clap::Args;
use jointplay::format::cell::{self, Change};
use jointplay::format::number::number;
use jointplay::format::place::not_known;
use jointplay::format::report::{self, StationReport, TeachReport};
use jointplay::format::units::m_from_mm;
use jointplay::nalgebra::Vector3;
use jointplay::plot::cell::Taught;

use super::input::{CellArgs, Named};
use super::pictures::PNG_WIDTH;
use crate::arguments::{finite, length};
use crate::failure::Failure;
use crate::figure::{FigureArgs, Format};
use crate::folder::{self, ForceArgs};
use crate::output::{self, fixed};

/// Place a station from taught points, or tell where stations are
///
/// Three points or more on the resting plane give its tilt with its uncertainty, their distances from the plane, and a verdict; the place of the first and the last wafer gives the tilt by drift.
/// Without points it tells what the cell file says of its stations.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell teach
  jointplay cell teach --figure stations.png
  jointplay cell teach --station LP2 --first-mm -495,-495,500 --last-mm -492,-495,740

Exit codes: 0 done, 1 the robot cannot tilt so far, or the points are scattered or leave the plane too uncertain, 2 bad input or usage.")]
pub(super) struct Teach {
    #[command(flatten)]
    pub(super) cell: CellArgs,
    /// Which station
    #[arg(long, value_name = "NAME")]
    station: Option<String>,
    /// A point of the resting plane in the base frame; three or more
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires = "station", conflicts_with_all = ["first_mm", "last_mm"])]
    point_mm: Vec<Point>,
    /// How far from the plane a point may be
    #[arg(long, value_name = "UM", default_value = "100", value_parser = threshold)]
    threshold_um: f64,
    /// Standard deviation of a measured coordinate; without it the noise is unknown and estimated from the points
    #[arg(long, value_name = "UM", value_parser = threshold, requires = "point_mm")]
    noise_um: Option<f64>,
    /// Where the wafer of the first slot rests, in the base frame
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires_all = ["station", "last_mm"])]
    first_mm: Option<Point>,
    /// Where the wafer of the last slot rests, in the base frame
    #[arg(long, value_name = "X,Y,Z", value_parser = point, requires_all = ["station", "first_mm"])]
    last_mm: Option<Point>,
    #[command(flatten)]
    figure: FigureArgs,
    /// Write it into the cell file, whose comments stay
    #[arg(long, requires = "station")]
    write: bool,
}

/// A point [m].
#[derive(Clone, Debug)]
struct Point(Vector3<f64>);

fn point(text: &str) -> Result<Point, String> {
    let values = text.split(',').map(length).collect::<Result<Vec<f64>, String>>()?;
    let values: [f64; 3] = values.try_into().map_err(|values: Vec<f64>| {
        format!("a point has 3 coordinates, {} are given", values.len())
    })?;
    Ok(Point(Vector3::from(values.map(m_from_mm))))
}

fn threshold(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value > 0.0 && value <= 1e5 {
        Ok(value)
    } else {
        Err(format!("{} µm is not within 0 to 100000 µm", number(value)))
    }
}

impl Teach {
    pub(super) fn run(&self) -> Result<(), Failure> {
        self.figure.target()?;
        let mut named = self.cell.load()?;
        if let Some(station) = &self.station {
            let names: Vec<String> =
                named.cell.stations.iter().map(|station| station.name.clone()).collect();
            if !names.contains(station) {
                return Err(Failure::Usage(not_known("the station", station, &names)));
            }
            if let Some(change) = self.change() {
                named = changed(named, station, change)?;
                if self.write {
                    self.save(&named)?;
                }
            }
        }
        let document = report::teach(&named.cell, self.station.as_deref());
        if self.cell.format.json() {
            output::json(&document)?;
        } else {
            output::text(&text(&document))?;
        }
        let picture = self.picture(&named);
        let written = self.figure.write(|format| match format {
            Format::Svg => picture.to_svg().map(String::into_bytes),
            Format::Png => picture.to_png(PNG_WIDTH),
        })?;
        if let Some(path) = written.filter(|_| !self.cell.format.json()) {
            output::text(&format!("picture: {}\n", path.display()))?;
        }
        let scattered = document.stations.iter().find(|station| {
            station.plane.as_ref().is_some_and(|plane| plane.verdict == "scattered")
        });
        if let Some(station) = scattered {
            return Err(Failure::Unsolved(format!(
                "the taught points of {} are scattered: teach them again, or allow more by --threshold-um",
                station.name
            )));
        }
        let uncertain = document.stations.iter().find_map(|station| {
            let plane = station.plane.as_ref().filter(|plane| plane.verdict == "uncertain")?;
            Some((&station.name, plane, plane.uncertainty.as_ref()?))
        });
        uncertain.map_or(Ok(()), |(name, plane, known)| {
            Err(Failure::Unsolved(format!(
                "the taught plane of {name} is known to ±{} µrad, allowed are {} µrad (`plane_urad`): teach points farther apart, more of them, or with less noise",
                fixed(known.tilt_95_urad, 1),
                fixed(plane.allowed_urad, 1)
            )))
        })
    }

    /// The picture of the stations asked about.
    fn picture<'a>(&self, named: &'a Named) -> Taught<'a> {
        let mut picture = Taught::new(&named.cell);
        if let Some(station) = &self.station {
            picture.stations.retain(|&k| named.cell.stations[k].name == *station);
            picture.title = named.cell.name.clone();
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

    fn save(&self, named: &Named) -> Result<(), Failure> {
        if self.cell.is_standard_input() {
            let text = "--write: standard input is no file; name the cell file";
            return Err(Failure::Usage(text.to_owned()));
        }
        if named.folder.is_none() {
            let text = "--write: the example is no file; `jointplay cell example` makes one of it";
            return Err(Failure::Usage(text.to_owned()));
        }
        folder::write_file(Path::new(&named.label), named.text.as_bytes(), ForceArgs::REPLACE)
    }
}

/// The cell with another place of one station.
fn changed(named: Named, station: &str, change: Change) -> Result<Named, Failure> {
    let text = cell::set_station(&named.text, station, &[change])
        .map_err(|problem| Failure::at(&problem, &named.label))?;
    match Named::read(named.label, named.stem, text, named.folder) {
        // The file was sound before: what is wrong now are the points.
        Err(Failure::Invalid(all)) => Err(Failure::Infeasible(all)),
        other => other,
    }
}

fn text(report: &TeachReport) -> String {
    let mut text = format!("{}, stations\n", report.cell);
    for station in &report.stations {
        let _ = writeln!(text, "{}", station.name);
        one(&mut text, station, report.tilt_limit_deg);
    }
    text
}

fn one(text: &mut String, station: &StationReport, limit: f64) {
    let [x, y, z] = station.position_mm.map(|value| fixed(value, 3));
    let how = match station.from {
        "taught" => "in the plane of taught points",
        "drift" => "from the places of first and last wafer",
        _ => "nominal, not taught",
    };
    let _ = writeln!(text, "  place (mm)           {x}, {y}, {z}; {how}");
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
        let verdict = match plane.verdict {
            "fits" => "fits",
            "uncertain" => "uncertain: the plane may be off by more than `plane_urad` allows",
            "unproven" if plane.freedom == 0 => {
                "unproven: three points always lie in a plane, teach a fourth"
            }
            "unproven" => {
                "unproven: too few points to test their noise; give --noise-um, or teach 6 or more"
            }
            _ => "scattered: teach them again",
        };
        let _ = writeln!(
            text,
            "  points off it (µm)   {}; at most {}, allowed {}",
            distances.join(", "),
            fixed(plane.worst_um, 1),
            fixed(plane.threshold_um, 1)
        );
        let freedom = match plane.freedom {
            1 => "1 degree of freedom".to_owned(),
            freedom => format!("{freedom} degrees of freedom"),
        };
        let noise = match (&plane.noise_um, &plane.uncertainty) {
            (Some(noise), _) => format!("{} µm a coordinate, as given", fixed(*noise, 1)),
            (None, Some(known)) => {
                format!("not given; {} µm by the distances", fixed(known.noise_um, 1))
            }
            (None, None) => "not given, and three points do not show it".to_owned(),
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
                let _ = writeln!(text, "  uncertainty          unknown; --noise-um gives it");
            }
        }
        let _ = writeln!(text, "  verdict              {verdict}");
    }
}
