//! Studies of any length: every sample by itself, the same in any company.

use jointplay_core::bulk::{Quantity, Status};
use jointplay_core::gpr::{AxisHeight, Gpr};
use jointplay_core::spatial::Tilt;
use jointplay_core::virtualization::{Metric, Planar, Polar, Radial, SolveOptions, Solver};
use jointplay_study::Error;
use jointplay_study::plan::{
    Block, Dimension, Outcome, OutputQuantity, Plan, PlatformQuantity, Portions, RodsFrom,
    Study as _, TiltForm, Tilts, Tolerances, Totals, Variation, quantiles, run,
};

const ANGLE: f64 = 0.02;

fn quantity(model: usize, quantity: Quantity) -> OutputQuantity {
    OutputQuantity::Model { model, measure: PlatformQuantity::Quantity(quantity) }
}

fn uniform(from: f64, to: f64) -> Variation {
    Variation::Uniform { from, to }
}

/// Random tilts at three heights, two virtualizations.
fn plan() -> Plan {
    Plan {
        gpr: Gpr::paper(),
        height: Variation::Values(vec![0.4, 0.5, 0.6]),
        tilt: Tilts {
            form: TiltForm::AzimuthAngle,
            first: uniform(0.0, 6.0),
            second: Variation::Normal { mean: 0.0, deviation: ANGLE },
        },
        tolerances: Tolerances::default(),
        rods_from: RodsFrom::Nominal,
        draws: 5000,
        seed: 3,
        models: vec![&Planar, &Polar],
        options: SolveOptions { solver: Solver::Newton, ..SolveOptions::default() },
        wanted: vec![
            OutputQuantity::Height,
            OutputQuantity::FirstAngle,
            OutputQuantity::SecondAngle,
            OutputQuantity::Rod(1),
            OutputQuantity::Side(2),
            quantity(0, Quantity::Origin(0)),
            quantity(1, Quantity::VirtualJoint(4)),
            OutputQuantity::Model { model: 1, measure: PlatformQuantity::CenterShift },
            OutputQuantity::Model { model: 1, measure: PlatformQuantity::TiltX },
            OutputQuantity::Model { model: 1, measure: PlatformQuantity::TiltError },
        ],
    }
}

fn tolerances() -> Tolerances {
    Tolerances {
        socket_radius: Some(Variation::Normal { mean: 1e-5, deviation: 1e-5 }),
        base_y: Some(uniform(-2e-5, 2e-5)),
        ..Tolerances::default()
    }
}

fn bits(block: &Block) -> Vec<Vec<u64>> {
    block.columns.iter().map(|column| column.iter().map(|v| v.to_bits()).collect()).collect()
}

#[test]
fn a_sample_is_what_one_pose_is() {
    let plan = plan();
    let samples: Vec<u64> = (0..300).collect();
    let block = plan.compute(&samples).unwrap();
    for i in 0..samples.len() {
        let at = |column: usize| block.columns[column][i];
        assert_eq!(at(0), [0.4, 0.5, 0.6][i % 3], "the height runs within a draw");
        assert_eq!(block.draws[i], i as u64 / 3);
        let tilt = Tilt { azimuth: at(1), angle: at(2) };
        let gpr = plan.gpr.without_limit_checks();
        let rods = gpr.inverse(tilt, AxisHeight(at(0))).unwrap();
        let planar = gpr.forward(rods, &Planar, &plan.options).unwrap();
        let polar = gpr.forward(rods, &Polar, &plan.options).unwrap();
        assert!((at(3) - rods[1]).abs() < 2e-16);
        assert!((at(4) - polar.sides[2]).abs() < 1e-15);
        let expected = [
            planar.base_from_platform.translation.x,
            polar.solution.virtual_joints[4],
            polar.center_shift().norm(),
            polar.tilt().about_x_and_y().0,
            0.0,
        ];
        for (k, expected) in (5..).zip(expected) {
            assert!((at(k) - expected).abs() < 1e-12, "column {k} of {i}");
        }
    }
    assert!(block.outcomes.iter().flatten().all(|o| *o == Outcome::Pose(Status::Solved)));
}

#[test]
fn a_sample_is_the_same_in_any_company() {
    for plan in [plan(), Plan { tolerances: tolerances(), ..plan() }] {
        let all: Vec<u64> = (0..700).collect();
        let whole = bits(&plan.compute(&all).unwrap());
        for samples in [vec![699], vec![5, 4, 5], (100..600).step_by(7).collect()] {
            let some = bits(&plan.compute(&samples).unwrap());
            for (column, all) in some.iter().zip(&whole) {
                for (value, &sample) in column.iter().zip(&samples) {
                    assert_eq!(*value, all[sample as usize], "sample {sample}");
                }
            }
        }
    }
}

#[test]
fn tolerances_leave_the_poses_as_they_were() {
    let samples: Vec<u64> = (0..90).collect();
    let before = plan().compute(&samples).unwrap();
    let after = Plan { tolerances: tolerances(), ..plan() }.compute(&samples).unwrap();
    assert_eq!(before.columns[..4], after.columns[..4], "commanded as designed");
    assert_ne!(before.columns[4], after.columns[4]);
}

#[test]
fn a_robot_as_built_is_a_robot() {
    let built = |limb, dimension| OutputQuantity::Built { limb, dimension };
    let wanted = (0..3)
        .flat_map(|limb| Dimension::ALL.map(|dimension| built(limb, dimension)))
        .chain([
            OutputQuantity::Rod(0),
            OutputQuantity::Rod(1),
            OutputQuantity::Rod(2),
            quantity(0, Quantity::TiltAngle),
        ])
        .chain([OutputQuantity::Model { model: 0, measure: PlatformQuantity::TiltError }])
        .collect();
    let mut plan = Plan { tolerances: tolerances(), wanted, ..plan() };
    let samples: Vec<u64> = (0..60).collect();
    for rods_from in [RodsFrom::Nominal, RodsFrom::AsBuilt] {
        plan.rods_from = rods_from;
        let block = plan.compute(&samples).unwrap();
        let mut errors: f64 = 0.0;
        for i in 0..samples.len() {
            let at = |column: usize| block.columns[column][i];
            let mut limbs = plan.gpr.limbs();
            for (k, limb) in limbs.iter_mut().enumerate() {
                assert!(
                    (at(4 * k) - limb.socket_radius).abs() < 8e-5
                        && at(4 * k) != limb.socket_radius
                );
                assert_eq!(at(4 * k + 1), limb.socket_angle);
                assert!((at(4 * k + 3) - limb.base_point.y).abs() <= 2e-5);
                limb.socket_radius = at(4 * k);
                limb.base_point = [at(4 * k + 2), at(4 * k + 3)].into();
            }
            let robot = Gpr::new(limbs, *plan.gpr.limits(), 0.5).unwrap().without_limit_checks();
            let pose = robot.forward([at(12), at(13), at(14)], &Planar, &plan.options).unwrap();
            assert!((pose.tilt().angle - at(15)).abs() < 1e-12);
            errors = errors.max(at(16));
        }
        // A measured robot reaches the commanded pose; one that was not measured deviates from it.
        match rods_from {
            RodsFrom::AsBuilt => assert!(errors < 1e-12, "{errors}"),
            RodsFrom::Nominal => assert!(errors > 1e-6 && errors < 1e-3, "{errors}"),
        }
    }
}

#[test]
fn a_grid_runs_through_the_second_angle_first() {
    let values = |values: &[f64]| Variation::Values(values.to_vec());
    let tilt = Tilts {
        form: TiltForm::AboutXAndY,
        first: values(&[0.0, 0.1]),
        second: values(&[0.01, 0.02]),
    };
    let plan = Plan { tilt, draws: 1, ..plan() };
    assert_eq!((plan.samples().unwrap(), plan.draws_anything()), (12, false));
    let block = plan.compute(&(0..12).collect::<Vec<u64>>()).unwrap();
    assert_eq!(block.columns[2][..4], [0.01, 0.02, 0.01, 0.02]);
    assert_eq!(block.columns[1][..5], [0.0, 0.0, 0.1, 0.1, 0.0]);
    assert_eq!(block.columns[0][3..5], [0.4, 0.5]);
    let about_x = &block.columns[8];
    assert!((about_x[2] - 0.1).abs() < 1e-12 && about_x[0].abs() < 1e-12);
}

#[test]
fn samples_without_an_answer_say_why() {
    let tolerances = Tolerances {
        socket_radius: Some(Variation::Normal { mean: 0.0, deviation: 0.08 }),
        ..Tolerances::default()
    };
    let steep = Variation::Normal { mean: 0.0, deviation: 0.8 };
    let tilt = Tilts { second: steep, ..plan().tilt };
    let options = SolveOptions { max_iterations: 4, ..plan().options };
    let plan = Plan {
        tolerances,
        tilt,
        options,
        models: vec![&Radial, &Planar],
        wanted: vec![OutputQuantity::Rod(0), quantity(1, Quantity::TiltAngle)],
        ..plan()
    };
    let samples: Vec<u64> = (0..3000).collect();
    let block = plan.compute(&samples).unwrap();
    let mut totals = Totals::new(2, 2);
    totals.add(&Totals::of_chunk(std::slice::from_ref(&block)));
    let tally = totals.outcomes[1];
    let count = |outcome: Outcome| tally.counts[outcome.index()];
    assert!(count(Outcome::NoMechanism) > 0 && count(Outcome::Pose(Status::TiltTooLarge)) > 0);
    assert_eq!(tally.solved() + tally.failed(), 3000);
    assert_eq!(tally.reasons().map(|(_, count)| count).sum::<u64>(), tally.failed());
    assert_eq!(totals.columns[1].count, tally.solved());
    for (i, outcome) in block.outcomes[1].iter().enumerate() {
        assert_eq!(block.columns[1][i].is_nan(), *outcome != Outcome::Pose(Status::Solved));
    }
}

#[test]
fn moments_are_those_of_the_whole_column() {
    let plan = Plan { draws: 40_000, ..plan() };
    let mut totals = Totals::new(plan.wanted.len(), plan.models.len());
    let mut values = vec![Vec::new(); plan.wanted.len()];
    run::<(), Error>(
        &plan,
        0,
        |_| Ok(()),
        |blocks, ()| {
            totals.add(&Totals::of_chunk(blocks));
            for block in blocks {
                values.iter_mut().zip(&block.columns).for_each(|(all, more)| all.extend(more));
            }
            Ok(true)
        },
    )
    .unwrap();
    assert_eq!(totals.samples, 120_000);
    for (moments, values) in totals.columns.iter().zip(&values) {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
        assert_eq!(moments.count, 120_000);
        assert_eq!(moments.min, values.iter().copied().fold(f64::INFINITY, f64::min));
        assert_eq!(moments.max, values.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        let size = moments.max.abs().max(moments.min.abs());
        assert!((moments.mean - mean).abs() <= 1e-12 * size);
        assert!(
            (moments.deviation().unwrap() - variance.sqrt()).abs()
                <= 1e-9 * variance.sqrt() + 1e-12 * size
        );
    }
}

#[test]
fn a_run_is_the_same_on_any_number_of_threads_and_from_any_chunk() {
    let plan = Plan {
        draws: 70_000,
        models: vec![&Planar],
        wanted: vec![OutputQuantity::FirstAngle, quantity(0, Quantity::Origin(1))],
        ..plan()
    };
    let collected = |threads: usize, from: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let (mut samples, mut values) = (Vec::<u64>::new(), Vec::<u64>::new());
        let take = |blocks: &[Block], encoded: usize| {
            assert_eq!(encoded, blocks.len());
            for block in blocks {
                samples.extend(&block.samples);
                values.extend(block.columns[1].iter().map(|v| v.to_bits()));
            }
            Ok(true)
        };
        pool.install(|| run::<_, Error>(&plan, from, |blocks| Ok(blocks.len()), take)).unwrap();
        (samples, values)
    };
    let (samples, values) = collected(1, 0);
    assert!(samples.iter().copied().eq(0..210_000));
    for threads in [2, 3, 17] {
        assert!(collected(threads, 0) == (samples.clone(), values.clone()), "{threads} threads");
    }
    let skipped = 2 * Portions::QUICK.chunk as usize;
    assert!(collected(2, 2) == (samples[skipped..].to_vec(), values[skipped..].to_vec()));
    assert_eq!(collected(2, 4).0.len(), 0);

    let mut taken = 0;
    let stop = |_: &[Block], ()| {
        taken += 1;
        Ok(taken < 2)
    };
    run::<(), Error>(&plan, 0, |_| Ok(()), stop).unwrap();
    assert_eq!(taken, 2);
}

#[test]
fn quantiles_are_exact_for_few_and_near_for_many() {
    let shares = [0.0, 0.01, 0.5, 0.95, 1.0];
    let few = Plan { draws: 1000, wanted: vec![OutputQuantity::FirstAngle], ..plan() };
    let column = few.compute(&(0..3000).collect::<Vec<u64>>()).unwrap().columns.remove(0);
    let mut sorted = column;
    sorted.sort_by(f64::total_cmp);
    let found = quantiles(&few, &shares).unwrap().remove(0);
    for (share, found) in shares.iter().zip(&found) {
        let place = share * 2999.0;
        let (low, high) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
        assert_eq!(found.unwrap(), low + (high - low) * place.fract());
    }
    // Uniform from 0 to 6: the quantile is six times the share.
    let many = Plan { draws: 1 << 40, height: Variation::Values(vec![0.5]), ..few };
    let found = quantiles(&many, &shares[1..4]).unwrap().remove(0);
    for (share, found) in shares[1..4].iter().zip(&found) {
        let error = (share * (1.0 - share) / Portions::QUICK.quantiles as f64).sqrt();
        assert!((found.unwrap() / 6.0 - share).abs() < 4.0 * error, "{share}: {found:?}");
    }
    let steep = Tilts { second: Variation::Values(vec![3.0]), ..plan().tilt };
    let none = Plan { tilt: steep, wanted: vec![quantity(0, Quantity::TiltAngle)], ..plan() };
    assert_eq!(quantiles(&none, &shares).unwrap(), [[None; 5]]);
}

#[test]
fn plans_that_cannot_be_are_refused() {
    let refused = |plan: Plan, message: &str| {
        let error = plan.compute(&[0]).unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    };
    refused(Plan { height: Variation::Values(vec![]), ..plan() }, "no samples");
    refused(Plan { draws: u64::MAX, ..plan() }, "more samples than can be counted");
    refused(Plan { draws: 1 << 62, ..plan() }, "more samples than can be counted");
    refused(Plan { draws: 0, ..plan() }, "there is no sample 0");
    refused(Plan { wanted: vec![quantity(2, Quantity::Azimuth)], ..plan() }, "no virtualization 2");
    refused(
        Plan { wanted: vec![quantity(0, Quantity::VirtualJoint(6))], ..plan() },
        "virtual joint",
    );
    let options = SolveOptions { metric: Metric::Length(-1.0), ..SolveOptions::default() };
    refused(Plan { options, ..plan() }, "characteristic length");
}
