//! `jointplay cell teach`: station poses from taught points.

use std::fmt::Write as _;

use clap::Args;
use jointplay::cell::station::teach::ReferencePoint;
use jointplay::format::cell::{self, Change, TaughtNoise};
use jointplay::format::number::{counted, number};
use jointplay::format::place::not_known;
use jointplay::format::units::m_from_mm;
use jointplay::nalgebra::{Vector2, Vector3};
use jointplay::plot::cell::Taught;
use jointplay::report::{
    self, PlaneReport, ReferenceReport, StationReport, StationUncertaintyReport, TeachReport,
};

use super::input::{CellArgs, CellSource};
use crate::arguments::{finite, length};
use crate::failure::{Diagnostic, Failure};
use crate::figure::FigureArgs;
use crate::folder::{self, ForceArgs};
use crate::output;
use jointplay::format::number::fixed;

/// Compute the pose of a station from taught points, or list the poses of all stations
///
/// Three or more points on the resting plane determine its tilt and height; five or more of known noise also test it.
/// Reference points, such as the centre of a wafer and pins, determine the centre and the heading.
/// The positions of the first and the last wafer determine the tilt by the carrier axis through them.
/// Each result has its uncertainty, and the point to be measured again or next.
/// Without points, the poses in the cell file are listed.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell teach
  jointplay cell teach --figure stations.png
  jointplay cell teach --station LP2 --first-mm -495,-495,500 --last-mm -492,-495,740

Exit codes: 0 done, 1 the points are inconsistent, too few to be judged, or the tilt is too uncertain or exceeds the robot's limit, 2 bad input or usage.")]
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
    /// Standard deviation of the coordinates: one value, or one for each point, separated by commas [default: estimated from the points]
    #[arg(long, value_name = "UM", value_delimiter = ',', value_parser = threshold, requires = "point_mm")]
    noise_um: Vec<f64>,
    /// Name of the sensor that measured the points, a `[[sensor]]` of the cell file
    #[arg(long, value_name = "NAME", requires = "point_mm", conflicts_with = "noise_um")]
    sensor: Option<String>,
    /// Reference point: its position across and inward in the station, and its measured position in the base frame; 0,0 is the wafer centre
    #[arg(long, value_name = "X,Y=X,Y,Z", value_parser = reference, requires = "station", conflicts_with_all = ["first_mm", "last_mm"])]
    reference: Vec<Reference>,
    /// Standard deviation of the coordinates of references: one value, or one for each, separated by commas
    #[arg(long, value_name = "UM", value_delimiter = ',', value_parser = threshold, requires = "reference")]
    reference_noise_um: Vec<f64>,
    /// Name of the sensor that measured the references
    #[arg(
        long,
        value_name = "NAME",
        requires = "reference",
        conflicts_with = "reference_noise_um"
    )]
    reference_sensor: Option<String>,
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

/// A reference point.
#[derive(Clone, Debug)]
struct Reference(ReferencePoint);

fn reference(text: &str) -> Result<Reference, String> {
    let (nominal, measured) = text.split_once('=').ok_or(
        "expected the position in the station and the measured one, as 0,0=350.1,606.2,600",
    )?;
    let values = nominal.split(',').map(length).collect::<Result<Vec<f64>, String>>()?;
    let values: [f64; 2] = values.try_into().map_err(|values: Vec<f64>| {
        format!("expected 2 coordinates in the station, got {}", values.len())
    })?;
    let nominal = Vector2::from(values.map(m_from_mm));
    Ok(Reference(ReferencePoint { nominal, measured: point(measured)?.0 }))
}

/// Noise from flags: of a sensor, of all points, or of each point.
fn noise(noise_um: &[f64], sensor: Option<&String>) -> Option<TaughtNoise> {
    let micro = |noise: &f64| m_from_mm(noise / 1e3);
    match (noise_um, sensor) {
        (_, Some(sensor)) => Some(TaughtNoise::Sensor(sensor.clone())),
        ([], None) => None,
        ([one], None) => Some(TaughtNoise::Equal(micro(one))),
        (many, None) => Some(TaughtNoise::PerPoint(many.iter().map(micro).collect())),
    }
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
            let changes = self.changes();
            let taught = source.cell.stations.iter().find(|one| one.name == *station);
            self.check_usage(taught.map_or(1, |station| station.slots))?;
            if !changes.is_empty() {
                source = changed(source, station, &changes)?;
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
        let unjudged: Vec<String> = document.stations.iter().flat_map(unjudged).collect();
        if unjudged.is_empty() { Ok(()) } else { Err(Failure::Unsolved(unjudged.join("\n"))) }
    }

    /// Whether the options suit each other and the station.
    fn check_usage(&self, slots: usize) -> Result<(), Failure> {
        let counts = [
            ("noise-um", &self.noise_um, self.point_mm.len(), "point"),
            ("reference-noise-um", &self.reference_noise_um, self.reference.len(), "reference"),
        ];
        for (option, noises, points, what) in counts {
            if noises.len() > 1 && noises.len() != points {
                let (found, needed) = (counted(noises.len(), "value"), counted(points, what));
                let text =
                    format!("--{option} has {found} for {needed}: give one, or one for each");
                return Err(Failure::Usage(text));
            }
        }
        if self.first_mm.is_some() && slots < 2 {
            let text = "--first-mm and --last-mm need a station with several slots, but it has one";
            return Err(Failure::Usage(text.to_owned()));
        }
        Ok(())
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

    fn changes(&self) -> Vec<Change> {
        if let (Some(first), Some(last)) = (&self.first_mm, &self.last_mm) {
            return vec![Change::CarrierAxis { first: first.0, last: last.0 }];
        }
        let mut changes = Vec::new();
        if !self.point_mm.is_empty() {
            changes.push(Change::Taught {
                points: self.point_mm.iter().map(|point| point.0).collect(),
                threshold: m_from_mm(self.threshold_um / 1e3),
                noise: noise(&self.noise_um, self.sensor.as_ref()),
            });
        }
        if !self.reference.is_empty() {
            changes.push(Change::References {
                references: self.reference.iter().map(|reference| reference.0).collect(),
                noise: noise(&self.reference_noise_um, self.reference_sensor.as_ref()),
            });
        }
        changes
    }

    fn save(&self, source: &CellSource) -> Result<(), Failure> {
        if self.cell.is_standard_input() {
            let text = "--write needs a cell file, not standard input";
            return Err(Failure::Usage(text.to_owned()));
        }
        let Some(path) = self.cell.path() else {
            let text = "--write needs a cell file; use `jointplay cell example` to write the example into files";
            return Err(Failure::Usage(text.to_owned()));
        };
        folder::write_file(path, source.text.as_bytes(), ForceArgs::REPLACE)
    }
}

/// The cell with another pose of one station.
fn changed(source: CellSource, station: &str, changes: &[Change]) -> Result<CellSource, Failure> {
    let text = cell::set_station(&source.text, station, changes)
        .map_err(|problem| Failure::at(&problem, &source.label))?;
    let label = source.label.clone();
    match CellSource::parse(source.label, source.stem, text, source.folder, &[]) {
        // The file was valid before: the new points are infeasible. They are not in the file, so that no line of it is quoted.
        Err(Failure::Invalid(all)) => {
            let message = |one: &Diagnostic| format!("{label}: station {station}: {}", one.message);
            Err(Failure::Unsolved(all.iter().map(message).collect::<Vec<_>>().join("\n")))
        }
        other => other,
    }
}

/// The reasons why a taught station is not accepted.
fn unjudged(station: &StationReport) -> Vec<String> {
    let mut reasons = Vec::new();
    if let Some(plane) = &station.plane {
        let next = || next_points(plane).unwrap_or_default();
        match (plane.result, &plane.uncertainty) {
            ("untested", _) => reasons.push(format!(
                "the plane of {} cannot be judged with {}{}",
                station.name,
                counted(plane.distances_um.len(), "point"),
                next()
            )),
            ("uncertain", Some(known)) => reasons.push(format!(
                "the tilt of the taught plane of {} is uncertain by ±{} µrad (coverage factor {}), but only {} µrad are allowed (`plane_urad`){}",
                station.name,
                fixed(known.tilt_expanded_urad, 1),
                number(station.uncertainty.coverage_factor),
                fixed(plane.allowed_urad, 1),
                next()
            )),
            _ => {}
        }
    }
    if let Some(references) = station.references.as_ref().filter(|it| it.result == "untested") {
        reasons.push(format!(
            "the centre and the heading of {} cannot be judged with {}: measure {} more, far from each other",
            station.name,
            counted(references.deviations_um.len(), "reference"),
            references.missing
        ));
    }
    reasons
}

/// Advice on the next point to measure.
fn next_points(plane: &PlaneReport) -> Option<String> {
    let next = plane.next.as_ref()?;
    let [x, y, z] = next.points_mm.first()?.map(|value| fixed(value, 1));
    let quieter = match next.noise_um {
        Some(noise) => format!(", or reduce the noise to {} µm", fixed(noise, 2)),
        None => String::new(),
    };
    Some(if next.suffices {
        let count = next.points_mm.len();
        let (points, best) =
            if count == 1 { ("point", "best") } else { ("points", "the next one best") };
        format!(": measure {count} more {points}, {best} near {x}, {y}, {z}{quieter}")
    } else {
        format!(
            ": {} more points do not suffice: measure points farther apart{quieter}",
            next.points_mm.len()
        )
    })
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
        "taught" if station.plane.is_none() => "reference points",
        "taught" => "plane of taught points",
        "carrier axis" => "positions of first and last wafer",
        _ => "nominal, not taught",
    };
    let _ = writeln!(text, "  position (mm)        {x}, {y}, {z}; {origin}");
    if let Some(pitch) = station.pitch_mm {
        let _ = writeln!(text, "  pitch (mm)           {}", fixed(pitch, 3));
    }
    let _ = writeln!(
        text,
        "  tilt                 {}° at azimuth {}°, {} % of the robot's {}°",
        fixed(station.tilt_angle_deg, 4),
        fixed(station.tilt_azimuth_deg, 2),
        fixed(100.0 * station.tilt_share, 0),
        fixed(limit, 3)
    );
    if let Some(carrier_axis) = station.horizontal_offset_mm {
        let _ = writeln!(text, "  axis offset (mm)     {}", fixed(carrier_axis, 3));
    }
    if let Some(plane) = &station.plane {
        write_plane(text, plane, station.uncertainty.coverage_factor);
    }
    if let Some(references) = &station.references {
        write_references(text, references);
    }
    write_uncertainty(text, &station.uncertainty);
}

/// A list of values with one decimal.
fn listed(values: &[f64]) -> String {
    values.iter().map(|&one| fixed(one, 1)).collect::<Vec<_>>().join(", ")
}

/// The noise of points: one value, or one for each.
fn noise_text(noise: &[f64]) -> String {
    match noise {
        [first, rest @ ..] if rest.iter().all(|one| one == first) => fixed(*first, 1),
        all => listed(all),
    }
}

/// The standardized residuals, if all are known; with an estimated noise they are studentized.
fn write_standardized(text: &mut String, values: &[Option<f64>], is_noise_given: bool) {
    let Some(values) = values.iter().copied().collect::<Option<Vec<f64>>>() else { return };
    let name = if is_noise_given { "standardized" } else { "studentized" };
    let values: Vec<String> = values.iter().map(|&one| fixed(one, 2)).collect();
    let _ = writeln!(text, "  {name:<20} {}", values.join(", "));
}

fn chi_square(found: Option<f64>, limit: Option<f64>) -> String {
    match (found, limit) {
        (Some(found), Some(limit)) => {
            format!("; chi-square {}, limit {}", fixed(found, 2), fixed(limit, 2))
        }
        _ => String::new(),
    }
}

fn write_plane(text: &mut String, plane: &PlaneReport, coverage_factor: f64) {
    let result = match plane.result {
        "fits" => "fits".to_owned(),
        "uncertain" => format!("uncertain{}", next_points(plane).unwrap_or_default()),
        "untested" => format!("untested{}", next_points(plane).unwrap_or_default()),
        _ => "inconsistent: measure the points again".to_owned(),
    };
    let _ = writeln!(
        text,
        "  residuals (µm)       {}; largest {}, allowed {}",
        listed(&plane.distances_um),
        fixed(plane.worst_um, 1),
        fixed(plane.threshold_um, 1)
    );
    write_standardized(text, &plane.standardized, plane.noise_um.is_some());
    let leverages: Vec<String> = plane.leverages.iter().map(|&one| fixed(one, 2)).collect();
    let _ = writeln!(text, "  leverage             {}", leverages.join(", "));
    let freedom = counted_freedom(plane.freedom);
    let noise = match (&plane.noise_um, &plane.uncertainty) {
        (Some(noise), _) => format!("{} µm per coordinate, given", noise_text(noise)),
        (None, Some(known)) => {
            format!("not given; {} µm estimated from the distances", fixed(known.noise_um, 1))
        }
        (None, None) => "not given; cannot be estimated from three points".to_owned(),
    };
    let chi = chi_square(plane.chi_square, plane.chi_square_limit);
    let _ = writeln!(text, "  noise                {noise}, {freedom}{chi}");
    if let Some(known) = &plane.uncertainty {
        let _ = writeln!(
            text,
            "  tilt uncertainty     ±{} µrad about the least certain axis (coverage factor {}), allowed {}; angle of the normal ±{} µrad (95 %), {} µrad rms",
            fixed(known.tilt_expanded_urad, 1),
            number(coverage_factor),
            fixed(plane.allowed_urad, 1),
            fixed(known.tilt_95_urad, 1),
            fixed(known.tilt_rms_urad, 1)
        );
    }
    let _ = writeln!(text, "  plane                {result}");
}

fn counted_freedom(freedom: usize) -> String {
    match freedom {
        1 => "1 degree of freedom".to_owned(),
        freedom => format!("{freedom} degrees of freedom"),
    }
}

fn write_references(text: &mut String, references: &ReferenceReport) {
    let [x, y] = references.shift_mm.map(|value| fixed(value, 4));
    let heading = match references.turn_deg {
        Some(turn) => format!("heading {}°", fixed(turn, 4)),
        None => "heading nominal: add a reference at another place".to_owned(),
    };
    let _ = writeln!(text, "  from nominal (mm)    {x} across, {y} inward; {heading}");
    let _ = writeln!(
        text,
        "  reference dev. (µm)  {}; largest {}, allowed {}",
        listed(&references.deviations_um),
        fixed(references.worst_um, 1),
        fixed(references.threshold_um, 1)
    );
    write_standardized(text, &references.standardized, references.noise_um.is_some());
    let noise = match &references.noise_um {
        Some(noise) => format!("{} µm per coordinate, given", noise_text(noise)),
        None => "not given".to_owned(),
    };
    let freedom = counted_freedom(references.freedom);
    let chi = chi_square(references.chi_square, references.chi_square_limit);
    let _ = writeln!(text, "  noise                {noise}, {freedom}{chi}");
    let result = match references.result {
        "fits" => "fits".to_owned(),
        "untested" => {
            format!("untested: measure {} more, far from each other", references.missing)
        }
        _ => "inconsistent: measure the references again".to_owned(),
    };
    let _ = writeln!(text, "  references           {result}");
}

fn write_uncertainty(text: &mut String, known: &StationUncertaintyReport) {
    if known.slots.is_empty() {
        let _ = writeln!(text, "  uncertainty          not known");
        return;
    }
    let factor = if (known.applied_factor - known.coverage_factor).abs() < 5e-3 {
        number(known.coverage_factor)
    } else {
        let [given, applied] = [number(known.coverage_factor), fixed(known.applied_factor, 2)];
        format!("{given}, {applied} for the estimated noise")
    };
    let by_tilt = if known.unknown.contains(&"position") { " by its tilt" } else { "" };
    let slots: Vec<String> = known
        .slots
        .iter()
        .map(|one| {
            format!(
                "slot {} ±{} µm sideways{by_tilt}, ±{} µm in height",
                one.slot,
                fixed(one.lateral_um, 1),
                fixed(one.height_um, 1)
            )
        })
        .collect();
    let unknown = match known.unknown.as_slice() {
        [] => String::new(),
        unknown => format!("; not known and counted as exact: {}", unknown.join(", ")),
    };
    let _ = writeln!(
        text,
        "  uncertainty          {} (coverage factor {factor}){unknown}",
        slots.join("; ")
    );
}
