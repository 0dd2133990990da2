//! The effector that an instruction uses at its stations.

use super::ProgramProblem;
use crate::robot::{EffectorId, HybridRobot};
use crate::workcell::Cell;

/// The effector for stations: the one that is named, or the only one that all of them are open to.
///
/// # Errors
/// The first problem: a station that the effector may not use, no effector for all stations, or several.
pub(super) fn choose_effector(
    cell: &Cell,
    named: Option<EffectorId>,
    stations: &[usize],
) -> Result<EffectorId, ProgramProblem> {
    let robot = &cell.robot;
    if let Some(effector) = named {
        let closed = stations.iter().map(|&station| &cell.stations[station]);
        return match closed.into_iter().find(|it| !it.effectors.contains(&effector)) {
            None => Ok(effector),
            Some(station) => Err(ProgramProblem::NotAllowed {
                effector: effector_name(robot, effector).to_owned(),
                station: station.name.clone(),
                known: names(robot, &station.effectors),
            }),
        };
    }
    match stations {
        [] => {
            let all: Vec<EffectorId> = robot.effectors().collect();
            only_one(robot, "the robot has several effectors".to_owned(), &all)
        }
        [one] => {
            let station = &cell.stations[*one];
            let context = format!("station {} is open to several effectors", station.name);
            only_one(robot, context, &station.effectors)
        }
        [one, other, ..] => {
            let (one, other) = (&cell.stations[*one], &cell.stations[*other]);
            let may = one.effectors.iter().filter(|id| other.effectors.contains(id));
            let both: Vec<EffectorId> = may.copied().collect();
            if both.is_empty() {
                return Err(ProgramProblem::NoCommonEffector {
                    from: one.name.clone(),
                    to: other.name.clone(),
                    may_from: names(robot, &one.effectors),
                    may_to: names(robot, &other.effectors),
                });
            }
            let context =
                format!("stations {} and {} are open to several effectors", one.name, other.name);
            only_one(robot, context, &both)
        }
    }
}

/// Checks that a SWAP has two effectors.
pub(super) fn check_swap(
    cell: &Cell,
    get: EffectorId,
    put: EffectorId,
) -> Result<(), ProgramProblem> {
    if get != put {
        return Ok(());
    }
    Err(ProgramProblem::SameEffector { effector: effector_name(&cell.robot, get).to_owned() })
}

/// The only element of a list, or the problem that there are several or none.
fn only_one(
    robot: &HybridRobot,
    context: String,
    ids: &[EffectorId],
) -> Result<EffectorId, ProgramProblem> {
    match ids {
        &[only] => Ok(only),
        _ => Err(ProgramProblem::WhichEffector { context, known: names(robot, ids) }),
    }
}

/// Names of effectors, in messages.
pub(super) fn names(robot: &HybridRobot, ids: &[EffectorId]) -> Vec<String> {
    ids.iter().map(|&id| effector_name(robot, id).to_owned()).collect()
}

pub(super) fn effector_name(robot: &HybridRobot, id: EffectorId) -> &str {
    &robot.arms[id.arm].effectors[id.effector].name
}
