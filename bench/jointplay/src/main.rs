//! The work of the side-by-side bench, done by jointplay.
//!
//! `write FOLDER` writes the work for every program, `words FOLDER` what jointplay says of mechanisms; `gpr closed-form`, `gpr general` and `linkage NAME` do it.
//! A worker says `ready`, then answers `run N` by doing all of its work N times, and `tell FILE` by writing its answers.

mod gpr;
mod linkage;
mod tree;
mod words;

use std::fmt::Write as _;
use std::io::{BufRead as _, Write as _};
use std::path::Path;
use std::process::ExitCode;

use jointplay::virtualization::Solver;

/// Something to solve again and again.
trait Work {
    /// Solves everything; how many were solved.
    fn solve(&mut self) -> usize;
    /// The numbers of the last answers, `None` for what was not solved.
    fn answers(&self) -> Vec<Option<Vec<f64>>>;
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        ["write", folder] => write(Path::new(folder)),
        ["words", folder] => words::write(Path::new(folder)),
        ["gpr", "closed-form"] => serve(&mut gpr::ClosedForm::new(Solver::Newton)),
        ["gpr", "least-norm"] => serve(&mut gpr::ClosedForm::new(Solver::LeastNorm)),
        ["gpr", "general"] => serve(&mut gpr::General::new()),
        ["linkage", name] => match linkage::Linkage::new(name) {
            Some(mut linkage) => serve(&mut linkage),
            None => Err(format!("no linkage is called {name:?}").into()),
        },
        _ => Err(
            "say one of: write FOLDER, words FOLDER, gpr closed-form, gpr general, linkage NAME"
                .into(),
        ),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
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
            Some(("tell", path)) => {
                let mut text = String::new();
                for answer in work.answers() {
                    let numbers: Vec<String> =
                        answer.unwrap_or_default().iter().map(f64::to_string).collect();
                    writeln!(text, "{}", numbers.join(" "))?;
                }
                std::fs::write(path, text)?;
                writeln!(out, "done")?;
            }
            _ => return Err(format!("say run N or tell FILE, not {line:?}").into()),
        }
        out.flush()?;
    }
    Ok(())
}
