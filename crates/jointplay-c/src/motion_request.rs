//! Requests in JSON about motions, and virtual joints that make them possible.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use jointplay::format::coordinates::Coordinates;
use jointplay::format::mechanism::MechanismFile;
use jointplay::mechanism::{
    Commands, Drive, DrivePath, LinearAndAngular, MechanismSystem, SuggestOptions, SuggestionRank,
    close_nearly, drive_from, held_actuators, pose_commanded, single_commands,
    single_displacements, small_commands,
};
use jointplay::nalgebra::DVector;
use jointplay::report::{self, MotionReport, SuggestReport};
use serde::Deserialize;

use crate::catch::Failure;

/// Joint coordinates by name (m, rad).
pub(crate) type Values = BTreeMap<String, f64>;

/// Steps of a motion if the request has no number, as of the command.
const STEPS: usize = 60;
/// The most steps of a motion: a report has all its configurations.
const MOST_STEPS: usize = 100_000;
/// Number of sets with displacements of single motors, as the command has them.
const LISTED: usize = 10;

/// A mechanism whose coordinates requests name.
#[derive(Clone, Copy)]
pub(crate) struct Named<'m> {
    pub(crate) file: &'m MechanismFile,
    pub(crate) coordinates: &'m Coordinates,
}

impl Named<'_> {
    pub(crate) fn index(&self, name: &str) -> Result<usize, Failure> {
        let found = self.coordinates.find(&self.file.mechanism, name);
        found.map_err(|error| Failure::input(error.to_string()))
    }

    /// Coordinates with their values (m, rad).
    pub(crate) fn commands(&self, values: &Values) -> Result<Vec<(usize, f64)>, Failure> {
        let checked = |(name, value): (&String, &f64)| {
            let k = self.index(name)?;
            let value = self.coordinates.checked(k, *value);
            Ok((k, value.map_err(|error| Failure::input(error.to_string()))?))
        };
        values.iter().map(checked).collect()
    }
}

/// A straight motion of joints from a closed configuration.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Move {
    /// Commanded coordinates at the start; the closed configuration of the file, if there are none.
    at: Option<Values>,
    /// Values at the end.
    to: Values,
    steps: Option<usize>,
    /// Motors that follow, instead of being held.
    free: Option<Vec<String>>,
    /// Whether the answer has the poses of links and attached frames.
    poses: Option<bool>,
}

impl Move {
    pub(crate) fn answer(&self, named: Named<'_>) -> Result<MotionReport, Failure> {
        let steps = self.steps.unwrap_or(STEPS);
        if !(1..=MOST_STEPS).contains(&steps) {
            return Err(Failure::input(format!(
                "steps must be from 1 to {MOST_STEPS}, got {steps}"
            )));
        }
        if self.to.is_empty() {
            return Err(Failure::input("to must name at least one joint coordinate"));
        }
        let mechanism = &named.file.mechanism;
        let targets = named.commands(&self.to)?;
        let free = self.free.iter().flatten().map(|name| named.index(name));
        let free = free.collect::<Result<Vec<usize>, _>>()?;
        let start = pose_commanded(
            mechanism,
            &named.commands(self.at.as_ref().unwrap_or(&Values::new()))?,
            None,
        )?;
        let start = start.closed.coordinates;
        let drives: Vec<Drive> =
            targets.iter().map(|&(coordinate, to)| Drive { coordinate, to }).collect();
        let path = DrivePath::line(&start, &drives)?;
        let mut held = held_actuators(mechanism, path.coordinates());
        held.retain(|k| !free.contains(k));
        let moved = drive_from(mechanism, &start, &path, &held, steps, None, &mut |_| {
            ControlFlow::Continue(())
        })?;
        let commanded = [path.coordinates(), &held].concat();
        let report = report::motion(named.file, path.coordinates(), &held, None, &moved)
            .with_free_motions(named.file, &moved, &commanded)?;
        if self.poses != Some(true) {
            return Ok(report);
        }
        report.with_poses(named.file, &moved).map_err(Failure::from)
    }
}

/// Virtual joints that make commands possible.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Suggest {
    /// Commands to the same coordinates; small ones to each motor, if there are none.
    commands: Option<Vec<Values>>,
    limit: Option<usize>,
    joints: Option<usize>,
    symmetric: Option<bool>,
    rank: Option<RankName>,
    stiffness: Option<Stiffness>,
}

/// Order of the suggested sets.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum RankName {
    Norm,
    Largest,
    Stiffness,
}

/// Stiffness of the virtual joints (N/m, N m/rad).
#[derive(Clone, Copy, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stiffness {
    linear: Option<f64>,
    angular: Option<f64>,
}

impl Suggest {
    pub(crate) fn answer(&self, named: Named<'_>) -> Result<SuggestReport, Failure> {
        let mut file = named.file.clone();
        // The search replaces the virtual joints of the file.
        let bare = file.mechanism.clone().with_virtual_joints(Vec::new());
        file.mechanism = bare.map_err(|error| Failure::internal(error.to_string()))?;
        let coordinates = Coordinates::of(&file);
        let named = Named { file: &file, coordinates: &coordinates };
        let mechanism = &file.mechanism;
        MechanismSystem::check_size(mechanism)
            .map_err(|error| Failure::input(error.to_string()))?;
        let home = close_nearly(&named.file.mechanism)?.coordinates;
        let commands = match self.commands(named)? {
            Some(commands) => commands,
            None => small_commands(mechanism, &home)?.ok_or_else(|| {
                Failure::input("the mechanism has no actuated joint: give commands")
            })?,
        };
        let defaults = SuggestOptions::default();
        let positive = |name: &str, value: Option<f64>| match value {
            Some(value) if value.is_finite() && value > 0.0 => Ok(Some(value)),
            None => Ok(None),
            Some(value) => {
                Err(Failure::input(format!("{name} stiffness must be positive, got {value}")))
            }
        };
        let stiffness = self.stiffness.unwrap_or_default();
        let options = SuggestOptions {
            limit: self.limit.unwrap_or(defaults.limit),
            joints: self.joints,
            symmetric_only: self.symmetric.unwrap_or(defaults.symmetric_only),
            rank: match self.rank {
                Some(RankName::Norm) => SuggestionRank::Norm,
                Some(RankName::Largest) => SuggestionRank::Largest,
                Some(RankName::Stiffness) => SuggestionRank::Stiffness,
                None => defaults.rank,
            },
            stiffness: LinearAndAngular {
                linear: positive("linear", stiffness.linear)?,
                angular: positive("angular", stiffness.angular)?,
            },
        };
        let Commands { commanded, values } = &commands;
        let found = jointplay::mechanism::suggest(mechanism, &home, commanded, values, &options)?;
        let names = commanded.iter().map(|&k| coordinates.all()[k].name.clone()).collect();
        let in_file = |command: &DVector<f64>| {
            let values = commanded.iter().zip(command.iter());
            values.map(|(&k, &value)| coordinates.from_si(k, value)).collect()
        };
        let in_file = values.iter().map(in_file).collect();
        let mut report = report::suggestions(&file, names, in_file, &found);
        let displacements = single_displacements(mechanism, &home, &commands)?;
        let mut single = Vec::new();
        for set in found.sets.iter().take(LISTED) {
            let relieved = mechanism.clone().with_virtual_joints(set.virtual_joints.clone());
            let relieved = relieved.map_err(|error| Failure::internal(error.to_string()))?;
            single.push(single_commands(&relieved, &home, &displacements)?);
        }
        report::add_single_commands(&mut report, &file, &single);
        Ok(report)
    }

    fn commands(&self, named: Named<'_>) -> Result<Option<Commands>, Failure> {
        let all = self.commands.as_deref().unwrap_or_default();
        let Some(first) = all.first() else { return Ok(None) };
        let commanded: Vec<usize> = named.commands(first)?.into_iter().map(|(k, _)| k).collect();
        let mut values = Vec::with_capacity(all.len());
        for command in all {
            let command = named.commands(command)?;
            if command.is_empty() || !command.iter().map(|(k, _)| k).eq(&commanded) {
                let text =
                    "each of the commands must name the same joint coordinates, at least one";
                return Err(Failure::input(text));
            }
            values.push(DVector::from_iterator(command.len(), command.iter().map(|one| one.1)));
        }
        Ok(Some(Commands { commanded, values }))
    }
}
