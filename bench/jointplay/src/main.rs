//! The work of the side-by-side bench, done by jointplay.
//!
//! `write FOLDER` writes the work for every program, `words FOLDER` the analyses of mechanisms by jointplay; `gpr METHOD SOLVER` and `linkage NAME` do the work.
//! The methods are `own` (pose by pose, with the platform's pose), `joints` (virtual joints alone), `general` (as any mechanism), with newton or least-norm as the solver; and `bulk WHAT`, many poses at a time; `linkage NAME many` solves all positions in one call.
//! `scaling FAMILY LOOPS` prints the times for mechanisms of many loops.
//! A worker prints `ready`, then answers `run N` by doing all of its work N times, and `write FILE` by writing its answers; some also answer `call N` by N single calls.

// The families know the façade by the name of the crate below it.
extern crate jointplay as jointplay_core;

mod bulk;
#[path = "../../../crates/jointplay-core/tests/families/mod.rs"]
mod families;
mod gpr;
mod linkage;
mod scaling;
mod tree;
mod words;
mod work;

use std::fmt::Write as _;
use std::io::{BufRead as _, Write as _};
use std::path::Path;
use std::process::ExitCode;

use jointplay::mechanism::ReliefSolver;
use jointplay::virtualization::Solver;

use work::Work;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        ["write", folder] => write(Path::new(folder)),
        ["words", folder] => words::write(Path::new(folder)),
        ["gpr", "bulk", what, rest @ ..] => match bulk::named(what, rest) {
            Some(mut bulk) => serve(bulk.as_mut()),
            None => Err(bulk::USAGE.into()),
        },
        ["gpr", method, solver] => match gpr_work(method, solver) {
            Some(mut work) => serve(work.as_mut()),
            None => Err("expected gpr own, joints or general, then newton or least-norm".into()),
        },
        ["linkage", name] => match linkage::Linkage::new(name) {
            Some(mut linkage) => serve(&mut linkage),
            None => Err(format!("no linkage is called {name:?}").into()),
        },
        ["linkage", name, "many"] => match linkage::Linkage::many(name) {
            Some(mut many) => serve(&mut many),
            None => Err(format!("no linkage is called {name:?}").into()),
        },
        ["scaling", family, loops] => scale(family, loops),
        _ => Err(
            "expected one of: write FOLDER, words FOLDER, gpr METHOD SOLVER, gpr bulk WHAT, linkage NAME [many], scaling FAMILY LOOPS"
                .into(),
        ),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // A closed standard error is no failure.
            let _ = writeln!(std::io::stderr(), "{error}");
            ExitCode::from(2)
        }
    }
}

fn gpr_work(method: &str, solver: &str) -> Option<Box<dyn Work>> {
    let (solver, relief) = match solver {
        "newton" => (Solver::Newton, ReliefSolver::Newton),
        "least-norm" => (Solver::LeastNorm, ReliefSolver::LeastNorm),
        _ => return None,
    };
    Some(match method {
        "own" => Box::new(gpr::Own::new(solver)),
        "joints" => Box::new(gpr::JointsAlone::new(solver)),
        "general" => Box::new(gpr::General::new(relief)),
        _ => return None,
    })
}

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn write(folder: &Path) -> Outcome {
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("gpr.txt"), gpr::text())?;
    for (name, _) in linkage::MECHANISMS {
        let linkage = linkage::Linkage::new(name).ok_or("a mechanism is not in the catalogue")?;
        std::fs::write(folder.join(format!("{name}.txt")), linkage.text())?;
    }
    Ok(())
}

fn scale(family: &str, loops: &str) -> Outcome {
    let times = scaling::scaling(family, loops.parse()?)
        .ok_or_else(|| format!("no family is called {family:?}"))?;
    writeln!(std::io::stdout(), "{times}")?;
    Ok(())
}

fn serve(work: &mut dyn Work) -> Outcome {
    let mut out = std::io::stdout();
    writeln!(out, "ready")?;
    out.flush()?;
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        match line.split_once(' ') {
            Some(("run", times)) => {
                let mut solved = 0;
                for _ in 0..times.parse::<u32>()? {
                    solved = work.solve();
                }
                writeln!(out, "done {solved}")?;
            }
            Some(("call", times)) => {
                let solved = work.call(times.parse()?).ok_or("this work is not called singly")?;
                writeln!(out, "done {solved}")?;
            }
            Some(("write", path)) => {
                let mut text = String::new();
                for answer in work.answers() {
                    let numbers: Vec<String> =
                        answer.unwrap_or_default().iter().map(f64::to_string).collect();
                    writeln!(text, "{}", numbers.join(" "))?;
                }
                std::fs::write(path, text)?;
                writeln!(out, "done")?;
            }
            _ => return Err(format!("expected run N, call N or write FILE, got {line:?}").into()),
        }
        out.flush()?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(work: &mut dyn Work, expected: usize) {
        assert_eq!(work.solve(), expected);
        let answers = work.answers();
        assert_eq!(answers.len(), expected);
        assert!(answers.iter().all(|answer| answer.as_ref().is_some_and(|numbers| {
            !numbers.is_empty() && numbers.iter().all(|number| number.is_finite())
        })));
    }

    #[test]
    fn every_position_is_found() {
        for solver in [Solver::Newton, Solver::LeastNorm] {
            check(&mut gpr::Own::new(solver), 14_400);
            check(&mut gpr::JointsAlone::new(solver), 14_400);
        }
        for what in
            ["joints", "pose", "least", "planar", "planar-pose", "radial", "radial-pose", "inverse"]
        {
            let mut one = bulk::named(what, &[]).expect("there is such work");
            check(one.as_mut(), 14_400);
            let mut shared = bulk::named(what, &["2", "cores"]).expect("there is such work");
            check(shared.as_mut(), 28_800);
            assert!(one.answers() == shared.answers()[14_400..], "{what}");
        }
        for relief in [ReliefSolver::Newton, ReliefSolver::LeastNorm] {
            check(&mut gpr::General::new(relief), 14_400);
        }
        for (name, _) in linkage::MECHANISMS {
            let mut one = linkage::Linkage::new(name).expect("it is in the catalogue");
            let mut many = linkage::Linkage::many(name).expect("it is in the catalogue");
            check(&mut one, 200);
            check(&mut many, 200);
            let numbers = |work: &dyn Work| {
                work.answers().into_iter().flatten().flatten().collect::<Vec<f64>>()
            };
            let apart = numbers(&one).into_iter().zip(numbers(&many)).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-10, "{name}");
        }
    }

    #[test]
    fn closed_form_and_general_mechanism_agree_on_the_robot() {
        let mut own = gpr::Own::new(Solver::LeastNorm);
        let mut general = gpr::General::new(ReliefSolver::LeastNorm);
        own.solve();
        general.solve();
        for (own, general) in own.answers().iter().zip(general.answers()) {
            let apart =
                own.iter().flatten().zip(general.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-9);
        }
    }

    #[test]
    fn many_at_a_time_equal_one_by_one() {
        let answers = |mut work: Box<dyn Work>| {
            work.solve();
            work.answers().into_iter().flatten().flatten().collect::<Vec<f64>>()
        };
        let bulk = |what| answers(bulk::named(what, &[]).expect("there is such work"));
        let rods: Vec<f64> = gpr::rods().concat();
        for (many, one) in [
            (bulk("joints"), answers(Box::new(gpr::JointsAlone::new(Solver::Newton)))),
            (bulk("pose"), answers(Box::new(gpr::Own::new(Solver::Newton)))),
            (bulk("least"), answers(Box::new(gpr::JointsAlone::new(Solver::LeastNorm)))),
            (bulk("inverse"), rods),
        ] {
            assert_eq!(many.len(), one.len());
            let apart = many.iter().zip(&one).map(|(a, b)| (a - b).abs());
            // A gap of 10⁻¹² m is a turn of 10⁻¹¹ rad.
            assert!(apart.fold(0.0, f64::max) < 1e-11);
        }
    }

    /// Tables of the documents are those that `bench/run.py --write-docs` writes from the recorded results.
    #[test]
    fn documents_quote_the_results() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let copies = std::env::temp_dir().join(format!("jointplay-bench-{}", std::process::id()));
        let pages = ["README.md", "docs/explanation/performance.md"];
        for page in pages {
            let copy = copies.join(page);
            std::fs::create_dir_all(copy.parent().expect("a folder")).expect("a folder is made");
            std::fs::copy(root.join(page), copy).expect("the page is copied");
        }
        let script = root.join("bench/harness/documents.py");
        let done = std::process::Command::new("python3")
            .args([script, root.join("bench/results"), copies.clone()])
            .output()
            .expect("python3 runs");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        for page in pages {
            let [written, copy] = [root.join(page), copies.join(page)].map(|path| {
                std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path:?}: {error}"))
            });
            assert!(written.matches("<!-- bench: end -->").count() > 0, "{page} has tables");
            assert_eq!(written, copy, "write {page} by `python3 bench/run.py --write-docs`");
        }
        std::fs::remove_dir_all(copies).expect("the copies are removed");
    }
}
