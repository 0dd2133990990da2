//! Stations of a cell file.

use std::collections::BTreeMap;

use crate::display_units::DisplayUnits;
use jointplay_cell::CellError;
use jointplay_cell::robot::HybridRobot;
use jointplay_cell::station::teach::{self, FrameUncertainty, NominalFrame};
use jointplay_cell::station::{Approach, MAX_SLOTS, Origin, Station, Stroke};
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::{Pose, Tilt};

use super::effectors::{Effectors, named_effectors};
use super::explain::{explain_teach, leveling_angle};
use super::pose::{heading_and_tilt, points};
use super::problem::Fault;
use super::taught::{self, Sensors};
use super::tree::{AllowedRange, Entry, Reader, Table};
use super::unique::unique;
use crate::file_problem::FileProblem;
use crate::number::number;
use crate::units::{deg, m_from_mm, mm, shift};

/// Largest relative deviation of the pitch between the first and the last slot.
const PITCH_SHARE: f64 = 0.01;

/// Keys of a station, without its name.
pub(super) const STATION_KEYS: [&str; 19] = [
    "slots",
    "pitch_mm",
    "slot_step_mm",
    "position_mm",
    "heading_deg",
    "tilt",
    "taught",
    "carrier_axis",
    "uncertainty",
    "offset_mm",
    "retract_mm",
    "via_mm",
    "approach",
    "effectors",
    "stroke",
    "process_s",
    "min_dwell_s",
    "max_dwell_s",
    "wafers",
];

/// A station with its occupied slots and the limits of stays.
pub(super) struct ReadStation {
    pub(super) station: Station,
    pub(super) wafers: Vec<usize>,
    pub(super) dwell: Option<Dwell>,
}

/// Limits of the stay of a wafer (s).
#[derive(Clone, Copy)]
pub(super) struct Dwell {
    pub(super) min: f64,
    pub(super) max: Option<f64>,
}

/// All stations.
pub(super) fn read(
    top: &Table,
    robot: (Option<&HybridRobot>, Option<&Cell>),
    effectors: Option<&Effectors>,
) -> Vec<ReadStation> {
    let sensors = taught::sensors(top);
    let mut names = BTreeMap::new();
    let tables = top.tables("station");
    if tables.is_empty() {
        top.missing("station");
    }
    let mut stations = Vec::new();
    for mut table in tables {
        let name = table.name("name");
        if let Some(name) = &name {
            table.whose = format!("the station {name:?}");
            unique(&table, "station", name, &mut names);
        }
        stations.extend(station(&table, name, robot, effectors, &sensors));
        table.finish();
    }
    stations
}

fn station(
    table: &Table,
    name: Option<String>,
    (robot, bare): (Option<&HybridRobot>, Option<&Cell>),
    effectors: Option<&Effectors>,
    sensors: &Sensors,
) -> Option<ReadStation> {
    let reader = table.reader;
    let slots = table.entry("slots").map_or(Some(1), |slots| slots.count(reader, 1, MAX_SLOTS));
    let pitch =
        table.entry("pitch_mm").and_then(|pitch| pitch.number(reader, AllowedRange::Positive));
    let step = table.entry("slot_step_mm").map_or(Some([0.0; 2]), |step| {
        step.numbers::<2, _>(reader, AllowedRange::Any).map(|step| step.map(m_from_mm))
    });
    let placed = place(table, slots.unwrap_or(1), pitch.map(m_from_mm), sensors);
    let stated = taught::stated_uncertainty(table);
    let offset = table.entry("offset_mm").and_then(|offset| offset.point(reader));
    let retract_reach = table.length("retract_mm", AllowedRange::NotNegative);
    let via = table.entry("via_mm").and_then(|via| points(&via, reader)).unwrap_or_default();
    let approach = table.entry("approach").map_or(Some(Approach::Radial), |approach| {
        let known = [("radial", Approach::Radial), ("line", Approach::Line)];
        approach.word(reader, "approach", &known)
    });
    let all: Vec<_> = effectors.into_iter().flatten().map(|(_, id)| *id).collect();
    let named = table.entry("effectors");
    let may = match (named, effectors) {
        (Some(named), Some(known)) => {
            let may = named_effectors(&named, reader, known);
            if named.list_is_empty() {
                let (key, needed) = ("effectors".to_owned(), "1 or more".to_owned());
                named.report(reader, FileProblem::Count { key, found: 0, needed });
            }
            may
        }
        _ => all,
    };
    let stroke = stroke(table);
    let process_time = table.number_or("process_s", AllowedRange::NotNegative, 0.0);
    let dwell = dwell(table, process_time);
    let wafers = wafers(table, slots.unwrap_or(MAX_SLOTS));
    let Place { frame, origin, uncertainty, pitch } = placed?;
    let station = Station {
        name: name?,
        base_from_station: frame,
        origin,
        uncertainty: uncertainty.or_stated(&stated),
        slots: slots?,
        pitch,
        slot_step: step?,
        stroke: stroke?,
        offset: offset.unwrap_or_default().into(),
        retract_reach: retract_reach?,
        via: via.into_iter().map(Into::into).collect(),
        approach: approach?,
        effectors: may,
        process_time,
    };
    if let Some(robot) = robot {
        check_tilt(table, &station, robot, bare);
        check_reach(table, &station, robot);
    }
    Some(ReadStation { station, wafers, dwell })
}

/// Limits of the stay of a wafer, without the station's index; none where there are no keys.
fn dwell(table: &Table, process_time: f64) -> Option<Dwell> {
    let seconds = |key| {
        let entry = table.entry(key)?;
        entry.number(table.reader, AllowedRange::NotNegative)
    };
    let (min, max) = (seconds("min_dwell_s"), seconds("max_dwell_s"));
    let longest_need = [("min_dwell_s", min), ("process_s", Some(process_time))];
    for (key, need) in longest_need {
        if let (Some(need), Some(max)) = (need, max)
            && need > max
        {
            let (need, max) = (number(need), number(max));
            table.report_at("max_dwell_s", Fault::Unfit(format!(
                "`max_dwell_s` of {} is {max}, but `{key}` requires a dwell of {need} s: increase `max_dwell_s` to {need} or more",
                table.whose
            )));
        }
    }
    (min.is_some() || max.is_some()).then(|| Dwell { min: min.unwrap_or(0.0), max })
}

fn stroke(table: &Table) -> Option<Stroke> {
    let Some(stroke) = table.table("stroke", "a stroke") else {
        table.entry("stroke").is_none().then(|| table.missing("stroke"));
        return None;
    };
    let below = stroke.length("below_mm", AllowedRange::Positive);
    let above = stroke.length("above_mm", AllowedRange::Positive);
    let speed = stroke.length("speed_mm_s", AllowedRange::Positive);
    stroke.finish();
    Some(Stroke { below: below?, above: above?, speed: speed? })
}

/// Frame of a station, and its pitch.
struct Place {
    frame: Pose,
    origin: Origin,
    uncertainty: FrameUncertainty,
    pitch: f64,
}

fn place(table: &Table, slots: usize, pitch: Option<f64>, sensors: &Sensors) -> Option<Place> {
    let reader = table.reader;
    let (heading, tilt) = heading_and_tilt(table);
    let taught = table.table("taught", "taught points");
    let carrier_axis = table.table("carrier_axis", "a carrier axis");
    let has_plane =
        taught.as_ref().is_some_and(|it| carrier_axis.is_some() || taught::has_plane(it));
    let sources: Vec<&str> =
        [("tilt", tilt.is_some()), ("taught", has_plane), ("carrier_axis", carrier_axis.is_some())]
            .into_iter()
            .filter_map(|(key, is_there)| is_there.then_some(key))
            .collect();
    if let [one, other, ..] = sources.as_slice() {
        table.report(Fault::Unfit(format!(
            "{} has both `{one}` and `{other}`; its tilt must come from only one of them",
            table.whose
        )));
        return None;
    }
    let nominal_pitch = || match pitch {
        None if slots > 1 => {
            if table.entry("pitch_mm").is_none() {
                table.missing("pitch_mm");
            }
            None
        }
        pitch => Some(pitch.unwrap_or(0.0)),
    };
    if let Some(carrier_axis) = carrier_axis {
        let (first, last) = (carrier_axis.point("first_mm"), carrier_axis.point("last_mm"));
        let noise =
            carrier_axis.entry("noise_um").and_then(|it| it.number(reader, AllowedRange::Positive));
        let noise = noise.map(|noise| shift(noise, -6));
        carrier_axis.finish();
        if let Some(entry) = table.entry("position_mm") {
            let why = "`position_mm` cannot be combined with `carrier_axis`, whose `first_mm` is the position of the station";
            entry.report(reader, Fault::Unfit(why.to_owned()));
        }
        let found = teach::carrier_axis(first?, last?, slots, noise)
            .map_err(|error| {
                carrier_axis.report(Fault::Unfit(explain_teach(&error, DisplayUnits::Metric)))
            })
            .ok()?;
        if let Some(pitch) = pitch.filter(|pitch| (found.pitch / pitch - 1.0).abs() > PITCH_SHARE) {
            carrier_axis.report(Fault::Unfit(format!(
                "the first and the last slot were taught {} mm apart, which is a pitch of {:.4} mm, but `pitch_mm` is {}",
                mm((found.pitch * (slots as f64 - 1.0) * 1e9).round() / 1e9),
                found.pitch * 1e3,
                mm(pitch)
            )));
        }
        let frame = teach::frame(found.first, &found.tilt.normal(), heading);
        let (uncertainty, pitch) = (found.uncertainty(), found.pitch);
        return Some(Place { frame, origin: Origin::CarrierAxis(found), uncertainty, pitch });
    }
    let position = table.point("position_mm");
    let nominal = position.map(|origin| NominalFrame {
        origin,
        heading,
        normal: tilt.unwrap_or(Tilt::LEVEL).normal(),
    });
    if let Some(taught) = taught {
        let found = taught::taught(&taught, nominal, sensors)?;
        let frame = found.frame(&nominal?);
        let uncertainty = found.uncertainty(&frame);
        let origin = Origin::Taught(Box::new(found));
        return Some(Place { frame, origin, uncertainty, pitch: nominal_pitch()? });
    }
    let pitch = nominal_pitch();
    let (frame, uncertainty) = (nominal?.in_plane(None), FrameUncertainty::UNKNOWN);
    Some(Place { frame, origin: Origin::Nominal, uncertainty, pitch: pitch? })
}

/// Checks that the platform can tilt as far as a station requires.
///
/// # Arguments
/// * `bare` – the cell with robot, wafer and budgets, for the tilt that compensates the deflection of the arms
fn check_tilt(table: &Table, station: &Station, robot: &HybridRobot, bare: Option<&Cell>) {
    let Err(CellError::StationTilt { tilt, max, .. }) = station.check_tilt(robot) else { return };
    let from = ["tilt", "taught", "carrier_axis"].into_iter().find_map(|key| table.entry(key));
    let span = from.map_or(table.span.clone(), |entry| entry.span());
    let (angle, azimuth) = (deg(tilt.angle), deg(tilt.azimuth));
    let excess = angle - deg(max);
    let by = bare.and_then(|cell| cell.leveling(station)).map_or(excess, deg);
    let by = by.max(excess);
    table.reader.report(span, Fault::Unfit(format!(
        "{} tilts {angle:.3}° toward {azimuth:.1}°, but the robot tilts by at most {:.3}°: level the station by at least {}",
        table.whose,
        deg(max),
        leveling_angle(by, by - excess)
    )));
}

fn check_reach(table: &Table, station: &Station, robot: &HybridRobot) {
    if let Err(CellError::RetractReach { found, reach, .. }) = station.check_retract_reach(robot) {
        table.report_at(
            "retract_mm",
            Fault::Unfit(format!(
                "`retract_mm` is {}, but the wafer of {} is only {:.3} mm from the first joint of the arm",
                number(mm(found)),
                table.whose,
                reach * 1e3
            )),
        );
    }
}

/// Occupied slots: `"all"`, or a list of numbers.
fn wafers(table: &Table, slots: usize) -> Vec<usize> {
    let reader: &Reader = table.reader;
    let Some(entry) = table.entry("wafers") else { return Vec::new() };
    if entry.is_text() {
        return match entry.word(reader, "`wafers`", &[("all", true), ("none", false)]) {
            Some(true) => (1..=slots).collect(),
            _ => Vec::new(),
        };
    }
    let list = entry.list(reader).unwrap_or_default();
    let mut found: Vec<usize> =
        list.iter().filter_map(|entry| occupied_slot(reader, entry, slots)).collect();
    found.sort_unstable();
    if let Some(pair) = found.windows(2).find(|pair| pair[0] == pair[1]) {
        let why = format!("slot {} is listed twice, but holds one wafer", pair[0]);
        entry.report(reader, Fault::Unfit(why));
    }
    found
}

/// Number of an occupied slot; a range such as `"5-9"` is reported as such, and not as the difference that it is as an expression.
fn occupied_slot(reader: &Reader, entry: &Entry, slots: usize) -> Option<usize> {
    if entry.is_text()
        && let Some((first, last)) = entry.text(reader)?.split_once('-')
        && let (Ok(first), Ok(last)) = (first.trim().parse::<u32>(), last.trim().parse::<u32>())
    {
        let why = format!("list the slots from {first} to {last} one by one, such as [1, 2, 5]");
        entry.report(reader, Fault::Unfit(why));
        return None;
    }
    entry.count(reader, 1, slots)
}
