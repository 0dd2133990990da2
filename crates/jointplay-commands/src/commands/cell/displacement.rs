//! `jointplay cell displacement`: displacement of wafers and the uncertainty of their positions.

use std::fmt::Write as _;

use clap::Args;
use jointplay::cell::displacement::{PlacedWafer, WaferDisplacement};
use jointplay::cell::program::expand;
use jointplay::cell::robot::EffectorId;
use jointplay::cell::station::SlotId;
use jointplay::cell::wafer::Unreachable;
use jointplay::cell::workcell::Cell;
use jointplay::format::cell::explain::explain_unreachable_pose;
use jointplay::format::display_units::DisplayUnits;
use jointplay::format::number::number;
use jointplay::format::place::not_known;
use jointplay::format::units::m_from_mm;
use jointplay::report::{self, DisplacementReport, WaferDisplacementReport};
use jointplay::spatial::Tilt;

use super::input::InputArgs;
use crate::arguments::{azimuth, finite, length, within_right_angle};
use crate::failure::Failure;
use crate::output;
use jointplay::format::number::fixed;

/// Compute how far wafers are displaced by tilt, droop and play, and how certain their positions are
///
/// By default at all hand-offs of the program; with --station in one slot, with --tilt-deg for a tilt of the platform.
/// The displacement is that of the wafer's centre from the level platform of a rigid robot with the same motor positions.
/// The uncertainty includes what the cell file states: `[tolerances]`, taught points and `uncertainty` of stations.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell displacement
  jointplay cell displacement --station LP2 --slot 25
  jointplay cell displacement --tilt-deg 0,0.6 --at-mm 700,0
  jointplay cell displacement --format json

Exit codes: 0 done, 1 a pose is not reached, 2 bad input or usage.")]
pub(super) struct Displacement {
    #[command(flatten)]
    pub(super) input: InputArgs,
    /// Name of the station in which the wafer rests
    #[arg(long, value_name = "NAME", conflicts_with = "tilt_deg")]
    station: Option<String>,
    /// Slot of the station [default: the highest]
    #[arg(long, value_name = "N", requires = "station")]
    slot: Option<usize>,
    /// Tilt of the platform: direction and angle
    #[arg(long, value_name = "AZIMUTH,ANGLE", value_parser = tilt)]
    tilt_deg: Option<Tilt>,
    /// Horizontal position of the wafer over the level platform [default: that of the home positions]
    #[arg(long, value_name = "X,Y", value_parser = position, requires = "tilt_deg", allow_hyphen_values = true)]
    at_mm: Option<Position>,
    /// Name of the effector [default: all that can reach it]
    #[arg(long, value_name = "NAME")]
    effector: Option<String>,
}

/// A horizontal position (m).
#[derive(Clone, Copy, Debug)]
struct Position([f64; 2]);

fn two(text: &str, read: impl Fn(&str) -> Result<f64, String>) -> Result<[f64; 2], String> {
    let values = text.split(',').map(read).collect::<Result<Vec<f64>, String>>()?;
    values
        .try_into()
        .map_err(|values: Vec<f64>| format!("expected 2 numbers, got {}", values.len()))
}

fn tilt(text: &str) -> Result<Tilt, String> {
    let [direction, angle] = two(text, finite)?;
    within_right_angle(angle)?;
    Ok(Tilt { azimuth: azimuth(direction), angle: angle.to_radians() })
}

fn position(text: &str) -> Result<Position, String> {
    Ok(Position(two(text, length)?.map(m_from_mm)))
}

impl Displacement {
    pub(super) fn run(&self) -> Result<(), Failure> {
        if self.station.is_none() && self.tilt_deg.is_none() {
            let planned = self.input.load()?;
            let cell = &planned.cell.cell;
            let steps =
                expand(cell, &planned.program).map_err(|errors| planned.refused(&errors))?;
            let mut wafers = cell.wafers_at_handoffs(&steps);
            if let Some(effector) = self.effector(cell)? {
                wafers.retain(|wafer| wafer.effector == effector);
            }
            if wafers.is_empty() {
                let text = "the program has no hand-off: use --station or --tilt-deg";
                return Err(Failure::Usage(text.to_owned()));
            }
            return self.print(cell, &wafers, true);
        }
        let source = self.input.load_cell()?;
        let cell = &source.cell;
        let chosen = self.effector(cell)?;
        let wafers = match (&self.station, self.tilt_deg) {
            (Some(name), _) => self.in_station(cell, name, chosen)?,
            (None, tilt) => {
                let tilt = tilt.unwrap_or(Tilt::LEVEL);
                let center = self.at_mm.map(|Position(center)| center);
                let reached = |effector| cell.wafer_over_tilt(effector, tilt, center);
                reachable(cell, chosen, cell.robot.effectors(), reached)?
            }
        };
        self.print(cell, &wafers, false)
    }

    fn effector(&self, cell: &Cell) -> Result<Option<EffectorId>, Failure> {
        let Some(name) = &self.effector else { return Ok(None) };
        let found = cell.robot.effectors().find(|&id| cell.effector_name(id) == name);
        let names: Vec<String> =
            cell.robot.effectors().map(|id| cell.effector_name(id).to_owned()).collect();
        match found {
            Some(found) => Ok(Some(found)),
            None => Err(Failure::Usage(not_known("the effector", name, &names))),
        }
    }

    fn in_station(
        &self,
        cell: &Cell,
        name: &str,
        chosen: Option<EffectorId>,
    ) -> Result<Vec<PlacedWafer>, Failure> {
        let Some(station) = cell.stations.iter().position(|station| station.name == name) else {
            let names: Vec<String> =
                cell.stations.iter().map(|station| station.name.clone()).collect();
            return Err(Failure::Usage(not_known("the station", name, &names)));
        };
        let slots = cell.stations[station].slots;
        let slot = self.slot.unwrap_or(slots);
        if !cell.stations[station].has_slot(slot) {
            let text = format!("{name} has slots 1 to {slots}, but no slot {slot}");
            return Err(Failure::Usage(text));
        }
        let effectors = cell.stations[station].effectors.clone();
        let reached = |effector| cell.wafer_in_slot(effector, SlotId { station, slot });
        reachable(cell, chosen, effectors.into_iter(), reached)
    }

    fn print(&self, cell: &Cell, wafers: &[PlacedWafer], is_program: bool) -> Result<(), Failure> {
        let displacement = |wafer: &PlacedWafer| {
            let found = cell.wafer_displacement(wafer, &cell.tolerances);
            found.map_err(|error| unreachable(cell, wafer.effector, &error))
        };
        let found = wafers.iter().map(displacement);
        let found = found.collect::<Result<Vec<WaferDisplacement>, Failure>>()?;
        let document = report::displacement(cell, &found);
        if self.input.format().json() {
            output::json(&document)
        } else {
            output::text(&text(&document, is_program))
        }
    }
}

/// The wafers of all effectors that reach a place, or of the chosen one.
fn reachable(
    cell: &Cell,
    chosen: Option<EffectorId>,
    effectors: impl Iterator<Item = EffectorId>,
    reached: impl Fn(EffectorId) -> Result<PlacedWafer, Unreachable>,
) -> Result<Vec<PlacedWafer>, Failure> {
    let (mut wafers, mut first) = (Vec::new(), None);
    for effector in effectors.filter(|&effector| chosen.is_none_or(|chosen| chosen == effector)) {
        match reached(effector) {
            Ok(wafer) => wafers.push(wafer),
            Err(error) => first = first.or(Some(unreachable(cell, effector, &error))),
        }
    }
    match first {
        Some(failure) if wafers.is_empty() => Err(failure),
        None if wafers.is_empty() => {
            Err(Failure::Usage("the station does not allow this effector".to_owned()))
        }
        _ => Ok(wafers),
    }
}

fn unreachable(cell: &Cell, effector: EffectorId, error: &Unreachable) -> Failure {
    let why = explain_unreachable_pose(&cell.robot, error, DisplayUnits::Metric);
    Failure::Unsolved(format!(
        "the wafer of {} is not reached: {why}",
        cell.effector_name(effector)
    ))
}

fn text(report: &DisplacementReport, is_program: bool) -> String {
    let mut text = format!(
        "{} with {}, {} virtualization, coverage factor {}\n",
        report.cell,
        report.robot,
        report.virtualization,
        number(report.coverage_factor)
    );
    if is_program {
        let _ = writeln!(
            text,
            "  {:<24} {:>8} {:>23} {:>19} {:>19}",
            "", "", "displacement (mm)", "coverage f. (±µm)", "linear sum (±µm)"
        );
        let _ = writeln!(
            text,
            "  {:<24} {:>8} {:>12} {:>10} {:>10} {:>8} {:>10} {:>8}",
            "station", "tilt (°)", "horizontal", "vertical", "hor.", "ver.", "hor.", "ver."
        );
        for (wafer, slots) in largest_by_station(&report.wafers) {
            let name = match (&wafer.station, slots) {
                (Some(station), 2..) => {
                    format!("{station}, {slots} slots, with {}", wafer.effector)
                }
                _ => place(wafer),
            };
            let (expanded, linear_sum) = (&wafer.expanded, &wafer.linear_sum);
            let _ = writeln!(
                text,
                "  {name:<24} {:>8} {:>12} {:>10} {:>10} {:>8} {:>10} {:>8}",
                fixed(wafer.tilt_angle_deg, 4),
                fixed(wafer.total_horizontal_mm, 4),
                fixed(wafer.total_mm[2], 4),
                fixed(expanded.horizontal_um, 1),
                fixed(expanded.vertical_um, 1),
                fixed(linear_sum.horizontal_um, 1),
                fixed(linear_sum.vertical_um, 1)
            );
        }
        let most = |wafer: &&WaferDisplacementReport| wafer.linear_sum.horizontal_um;
        if let Some(wafer) = report.wafers.iter().max_by(|a, b| most(a).total_cmp(&most(b))) {
            text.push_str("least certain horizontally\n");
            write_wafer(&mut text, wafer, report.coverage_factor);
        }
        return text;
    }
    for wafer in &report.wafers {
        write_wafer(&mut text, wafer, report.coverage_factor);
    }
    text
}

fn place(wafer: &WaferDisplacementReport) -> String {
    match (&wafer.station, wafer.slot) {
        (Some(station), Some(slot)) => format!("{station} slot {slot} with {}", wafer.effector),
        _ => format!("wafer of {}", wafer.effector),
    }
}

/// For each station and effector the wafer with the largest uncertainty, and the number of slots.
fn largest_by_station(
    wafers: &[WaferDisplacementReport],
) -> Vec<(&WaferDisplacementReport, usize)> {
    let mut groups: Vec<(&WaferDisplacementReport, usize)> = Vec::new();
    for wafer in wafers {
        let is_same = |(other, _): &&mut (&WaferDisplacementReport, usize)| {
            (&other.station, &other.effector) == (&wafer.station, &wafer.effector)
        };
        match groups.iter_mut().find(is_same) {
            Some((largest, slots)) => {
                *slots += 1;
                if wafer.linear_sum.horizontal_um > largest.linear_sum.horizontal_um {
                    *largest = wafer;
                }
            }
            None => groups.push((wafer, 1)),
        }
    }
    groups
}

fn write_wafer(text: &mut String, wafer: &WaferDisplacementReport, coverage_factor: f64) {
    let _ = writeln!(
        text,
        "{}: tilt {}° toward {}°, reach {} mm, {} mm over the platform",
        place(wafer),
        fixed(wafer.tilt_angle_deg, 4),
        fixed(wafer.tilt_azimuth_deg, 2),
        fixed(wafer.reach_mm, 3),
        fixed(wafer.lever_mm, 3)
    );
    let _ = writeln!(
        text,
        "  {:<24} {:>11} {:>11} {:>11} {:>11}",
        "displacement (mm)", "x", "y", "z", "horizontal"
    );
    let mut row = |name: &str, [x, y, z]: [f64; 3], horizontal: f64, basis: &str| {
        let [x, y, z, horizontal] = [x, y, z, horizontal].map(|value| fixed(value, 4));
        let line = format!("  {name:<24} {x:>11} {y:>11} {z:>11} {horizontal:>11}  {basis}");
        let _ = writeln!(text, "{}", line.trim_end());
    };
    for shift in &wafer.shifts {
        row(shift.cause, shift.shift_mm, shift.horizontal_mm, shift.basis);
    }
    row("total", wafer.total_mm, wafer.total_horizontal_mm, "");
    let of = match wafer.station {
        Some(_) => "relative to the slot",
        None => "of the position",
    };
    let _ = writeln!(text, "  uncertainty {of} (µm), horizontal and vertical");
    let _ = writeln!(
        text,
        "  {:<24} {:>23} {:>23}",
        "",
        format!("coverage factor {}", number(coverage_factor)),
        "linear sum"
    );
    let mut row = |name: &str, values: [f64; 4], basis: &str| {
        let [a, b, c, d] = values.map(|value| fixed(value, 2));
        let line = format!("  {name:<24} {a:>11} {b:>11} {c:>11} {d:>11}  {basis}");
        let _ = writeln!(text, "{}", line.trim_end());
    };
    for one in &wafer.contributions {
        let (expanded, linear_sum) = (&one.expanded, &one.linear_sum);
        let values = [
            expanded.horizontal_um,
            expanded.vertical_um,
            linear_sum.horizontal_um,
            linear_sum.vertical_um,
        ];
        row(one.cause, values, one.basis);
    }
    let (expanded, linear_sum) = (&wafer.expanded, &wafer.linear_sum);
    let values = [
        expanded.horizontal_um,
        expanded.vertical_um,
        linear_sum.horizontal_um,
        linear_sum.vertical_um,
    ];
    row("all", values, "");
    if !wafer.unknown.is_empty() {
        let _ = writeln!(text, "  not stated in full, and not included");
    }
    for unknown in &wafer.unknown {
        let _ = writeln!(text, "    {:<22} missing: {}", unknown.cause, unknown.keys.join(", "));
    }
}
