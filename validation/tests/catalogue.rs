//! Every mechanism of the catalogue against the numbers in its file and those of an independent program.
//!
//! Provenance: `validation/golden/README.md`.

use std::collections::BTreeMap;

use jointplay::format::mechanism::{MechanismFile, kind_of, parse};
use jointplay::mechanism::{
    Drive, MechanismSystem, PositionSolver, ReliefSolver, SparseSystem, assemble, drive, guess,
};
use jointplay::mobility::{RANK_THRESHOLD, finite_mobility, kutzbach_mobility};
use jointplay_validation::golden;

/// All mechanism files by name.
fn catalogue() -> BTreeMap<String, MechanismFile> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/jointplay-format/robots");
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        if kind_of(&text).as_deref() == Some("mechanism") {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            let file = parse(&text).unwrap_or_else(|e| panic!("{}", e.with_excerpt(&name)));
            files.insert(name, file);
        }
    }
    files
}

#[test]
fn mobility_of_every_mechanism() {
    let files = catalogue();
    let rows = golden("mechanisms.csv");
    assert_eq!(rows.len(), files.len());
    let mut failures = Vec::new();
    for row in &rows {
        let name = row.text("name");
        let MechanismFile { mechanism, expected, .. } = &files[name];
        let closed = match assemble(mechanism, &guess(mechanism), &[], 0) {
            Ok(closed) => closed,
            Err(error) => {
                failures.push(format!("{name}: {error}"));
                continue;
            }
        };
        // Joint by joint and by sparse algebra: the same counts, and never another answer.
        let sparse = SparseSystem::new(mechanism, closed.coordinates.clone()).unwrap();
        let sparse = sparse.mobility(RANK_THRESHOLD).unwrap();
        let system = MechanismSystem::new(mechanism, closed.coordinates).unwrap();
        let found = finite_mobility(&system, &system.at_home(), RANK_THRESHOLD).unwrap();
        let first = &found.instantaneous;
        let freedoms: Vec<usize> =
            mechanism.joints().iter().map(|joint| joint.kind.freedoms()).collect();
        let counted = kutzbach_mobility(mechanism.links().len(), &freedoms);
        let by_sparse = (sparse.mobility, sparse.rank, sparse.redundancy);
        if by_sparse != (first.mobility, first.rank, first.redundancy)
            || (sparse.finite.is_some() && sparse.finite != found.mobility)
            || !(sparse.lower_bound..=sparse.upper_bound).contains(&found.lower_bound)
        {
            failures.push(format!("{name}: by sparse algebra {sparse:?}"));
        }
        let ours = [
            ("freedoms", Some(mechanism.joint_freedoms()), expected.freedoms),
            ("rank", Some(first.rank), expected.rank),
            ("instantaneous", Some(first.mobility), expected.instantaneous),
            ("finite", found.mobility, expected.finite),
            ("redundancy", Some(first.redundancy), expected.redundancy),
        ];
        for (what, ours, in_file) in ours {
            let program = row.text(what).parse::<usize>().ok();
            if ours != in_file || ours != program {
                failures.push(format!("{name}: {what} {ours:?}, file {in_file:?}, program {program:?}; {:?} {} {} {:?}", first.singular_values.as_slice(), found.lower_bound, found.upper_bound, found.nearby));
            }
        }
        if expected.kutzbach != Some(counted) {
            failures.push(format!("{name}: Kutzbach {counted}, file {:?}", expected.kutzbach));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn motion_of_every_mechanism_with_one_drive() {
    let files = catalogue();
    let rows = golden("mechanism_drive.csv");
    // By mechanism and step: drive, joint, coordinate.
    type Coordinates = Vec<(String, String, f64)>;
    let mut by_step: BTreeMap<(String, usize), Coordinates> = BTreeMap::new();
    for row in &rows {
        let key = (row.text("name").to_owned(), row.text("step").parse().unwrap());
        by_step.entry(key).or_default().push((
            row.text("drive").to_owned(),
            row.text("joint").to_owned(),
            row.text("coordinate").parse().unwrap(),
        ));
    }
    assert!(by_step.len() >= 60);
    for name in by_step.keys().map(|key| key.0.clone()).collect::<std::collections::BTreeSet<_>>() {
        let mechanism = &files[&name].mechanism;
        let start = guess(mechanism);
        let steps: Vec<_> = by_step.iter().filter(|(key, _)| key.0 == name).collect();
        let driver = mechanism.joint(&steps[0].1[0].0).unwrap();
        let whole = MechanismSystem::new(mechanism, start.clone()).unwrap();
        let driven = whole.kinematics().coordinates_of(driver).start;
        let closed = assemble(mechanism, &start, &[driven], 0).unwrap();
        let free: Vec<usize> = (0..mechanism.joint_freedoms()).filter(|&k| k != driven).collect();
        let last = steps.last().unwrap();
        let to = last.1.iter().find(|(drive, joint, _)| drive == joint).unwrap().2;
        let system = MechanismSystem::new(mechanism, closed.coordinates).unwrap();
        let motion =
            drive(&system, &[Drive { coordinate: driven, to }], &free, steps.len() - 1).unwrap();
        assert_eq!(motion.stopped, None, "{name}");
        let mut solver = PositionSolver::new(&system, &[driven]).unwrap();
        let mut position = system.home().clone();
        for (waypoint, (key, expected)) in motion.waypoints.iter().zip(&steps) {
            for (_, joint, value) in *expected {
                let k = whole.kinematics().coordinates_of(mechanism.joint(joint).unwrap()).start;
                let off = waypoint.coordinates[k] - value;
                // A passive turn may be counted from another full turn.
                let turns = (off / std::f64::consts::TAU).round() * std::f64::consts::TAU;
                assert!((off - turns).abs() < 1e-9, "{key:?} {joint}: {off}");
            }
            // The fast solver from the waypoint before: every link where it was by continuation.
            position[driven] = waypoint.coordinates[driven];
            solver.solve(position.as_mut_slice(), ReliefSolver::LeastNorm).unwrap();
            let by_solver = whole.kinematics().link_poses(&position).unwrap();
            let by_drive = whole.kinematics().link_poses(&waypoint.coordinates).unwrap();
            for (a, b) in by_solver.iter().zip(&by_drive) {
                let off = (a.to_homogeneous() - b.to_homogeneous()).amax();
                assert!(off < 1e-9, "{key:?}: {off:e}");
            }
        }
    }
}
