//! Times for mechanisms of many loops, by dense and by sparse algebra.

use std::time::{Duration, Instant};

use jointplay::Error;
use jointplay::mechanism::{
    Drive, DrivenMotion, Mechanism, MechanismSystem, SparseSystem, drive, guess,
};
use jointplay::mobility::{RANK_THRESHOLD, finite_mobility};
use serde_json::{Value, json};

use crate::families::{bennett_row, scissor_lift};

/// Each work is repeated for so long; the shortest time is reported.
const LEAST: Duration = Duration::from_millis(300);
/// Displacement of the drive (rad), and number of steps.
const DRIVE: (f64, usize) = (0.1, 10);
/// Dense algebra is measured up to so many loops; it refuses larger mechanisms.
const MOST_DENSE: usize = 30;

/// Times of one family at a number of loops (s), or why there is none.
pub(crate) fn scaling(family: &str, loops: usize) -> Option<Value> {
    // Driven coordinate, and those held: a lift would also turn about its foot.
    let (mechanism, driven, held): (Mechanism, usize, &[usize]) = match family {
        "scissor-lift" => (scissor_lift(loops + 1), 1, &[0]),
        "bennett-row" => (bennett_row(loops), 0, &[]),
        _ => return None,
    };
    let closed = || {
        let mut system = SparseSystem::new(&mechanism, guess(&mechanism))?;
        system.close(&[], 100)?;
        Ok::<_, Error>(system)
    };
    let start = closed().ok()?.coordinates().clone();
    let drives = [Drive { coordinate: driven, to: start[driven] + DRIVE.0 }];
    let free: Vec<usize> = (0..start.len()).filter(|k| *k != driven && !held.contains(k)).collect();
    let dense = |work: &dyn Fn() -> Result<Option<usize>, Error>| {
        if loops > MOST_DENSE { Value::Null } else { timed(work) }
    };
    let arrived = |motion: DrivenMotion| motion.stopped.is_none().then_some(motion.waypoints.len());
    Some(json!({
        "family": family,
        "loops": mechanism.loops(),
        "links": mechanism.links().len(),
        "joints": mechanism.joints().len(),
        "mobility_dense": dense(&|| {
            let system = MechanismSystem::new(&mechanism, start.clone())?;
            Ok(finite_mobility(&system, &system.at_home(), RANK_THRESHOLD)?.mobility)
        }),
        "mobility_sparse": timed(&|| {
            Ok(SparseSystem::new(&mechanism, start.clone())?.mobility(RANK_THRESHOLD)?.finite)
        }),
        "drive_dense": dense(&|| {
            let system = MechanismSystem::new(&mechanism, start.clone())?;
            Ok(arrived(drive(&system, &drives, &free, DRIVE.1)?))
        }),
        "drive_sparse": timed(&|| {
            let system = SparseSystem::new(&mechanism, start.clone())?;
            Ok(arrived(system.drive(&drives, held, DRIVE.1)?))
        }),
    }))
}

/// The shortest time of a work, with its answer.
fn timed(work: &dyn Fn() -> Result<Option<usize>, Error>) -> Value {
    let (begin, mut least) = (Instant::now(), f64::INFINITY);
    loop {
        let start = Instant::now();
        let answer = match work() {
            Ok(answer) => answer,
            Err(error) => return json!({ "error": error.to_string() }),
        };
        least = least.min(start.elapsed().as_secs_f64());
        if begin.elapsed() > LEAST {
            return json!({ "seconds": least, "answer": answer });
        }
    }
}
