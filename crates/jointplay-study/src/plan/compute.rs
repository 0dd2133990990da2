//! Some samples of a plan, on one core.

use std::ops::Range;

use jointplay_core::bulk::{Column, Quantity, Status};
use jointplay_core::gpr::{BrokenLimit, BrokenLimits, Gpr, ball_sides};

use super::as_built::RodsFrom;
use super::as_built::{RobotSampler, value};
use super::block::{Block, Outcome, Portions, SampleLimit};
use super::definition::Plan;
use super::grid;
use super::inputs::Inputs;
use super::moments::Moments;
use super::output::{self, OutputQuantity};
use super::study::{self, Study};
use crate::Error;

impl Study for Plan {
    fn samples(&self) -> Result<u64, Error> {
        grid::samples(self.pose().into_iter(), self.draws)
    }

    fn seed(&self) -> u64 {
        self.seed
    }

    fn columns(&self) -> usize {
        self.wanted.len()
    }

    fn solved_for(&self) -> Vec<String> {
        self.models.iter().map(|model| model.name().to_owned()).collect()
    }

    fn limits(&self) -> &'static [SampleLimit] {
        &[SampleLimit::Rods, SampleLimit::Tilt]
    }

    fn depends_on_processor(&self) -> bool {
        false
    }

    fn portions(&self) -> Portions {
        Portions::QUICK
    }

    fn compute(&self, samples: &[u64]) -> Result<Block, Error> {
        compute(self, samples)
    }
}

/// Computes samples of a plan.
///
/// # Errors
/// As [`Study::compute`]; [`Error::NoSuchModel`] for what is wanted.
fn compute(plan: &Plan, samples: &[u64]) -> Result<Block, Error> {
    study::check(plan, samples)?;
    let inputs = Inputs::of(plan, samples)?;
    let nominal = plan.gpr.without_limit_checks();
    let all = 0..samples.len();
    let mut work = Work {
        plan,
        inputs: &inputs,
        rods: [(); 3].map(|()| vec![f64::NAN; samples.len()]),
        sides: [(); 3].map(|()| vec![f64::NAN; samples.len()]),
        unreached: vec![Status::Solved; samples.len()],
        models: models(plan, samples.len())?,
    };
    let mut built = Vec::new();
    if plan.tolerances.any() {
        if plan.rods_from == RodsFrom::Nominal {
            work.inverse(&nominal, all)?;
        }
        let mut workshop = RobotSampler::new(&plan.gpr, &plan.tolerances, plan.seed);
        let mut first = 0;
        for same in inputs.draw.chunk_by(|a, b| a == b) {
            let part = first..first + same.len();
            first = part.end;
            let limbs = workshop.limbs(same[0]);
            built.extend(std::iter::repeat_n(limbs, same.len()));
            let Ok(robot) = workshop.robot(limbs) else {
                work.no_robot(part);
                continue;
            };
            if plan.rods_from == RodsFrom::AsBuilt {
                work.inverse(&robot, part.clone())?;
            }
            work.forward(&robot, part)?;
        }
    } else {
        work.inverse(&nominal, all.clone())?;
        work.forward(&nominal, all)?;
    }
    let Work { rods, sides, models, .. } = work;
    let columns: Vec<Vec<f64>> = plan
        .wanted
        .iter()
        .map(|wanted| match *wanted {
            OutputQuantity::Height => inputs.height.clone(),
            OutputQuantity::FirstAngle => inputs.angles[0].clone(),
            OutputQuantity::SecondAngle => inputs.angles[1].clone(),
            OutputQuantity::Rod(k) => rods[k].clone(),
            OutputQuantity::Side(k) => sides[k].clone(),
            OutputQuantity::Built { limb, dimension } if built.is_empty() => {
                vec![value(plan.gpr.limbs()[limb], dimension); samples.len()]
            }
            OutputQuantity::Built { limb, dimension } => {
                built.iter().map(|limbs| value(limbs[limb], dimension)).collect()
            }
            OutputQuantity::Model { model, measure } => {
                measure.values(&models[model].columns, |i| inputs.tilt(i))
            }
        })
        .collect();
    let broken: Vec<BrokenLimits> = (0..samples.len())
        .map(|i| plan.gpr.limits().broken(&[0, 1, 2].map(|k| rods[k][i]), inputs.tilt(i)))
        .collect();
    Ok(Block {
        beyond_rods: broken.iter().filter(|broken| too_long_or_short(broken)).count() as u64,
        beyond_tilt: broken.iter().filter(|broken| broken.tilt()).count() as u64,
        beyond_joints: 0,
        moments: columns.iter().map(|column| Moments::of(column)).collect(),
        samples: samples.to_vec(),
        draws: inputs.draw,
        columns,
        outcomes: models.into_iter().map(|model| model.outcomes).collect(),
    })
}

/// Whether a rod that was found is beyond its limits.
fn too_long_or_short(broken: &BrokenLimits) -> bool {
    broken.iter().any(|limit| matches!(limit, BrokenLimit::Rod { length, .. } if !length.is_nan()))
}

/// Columns under computation for one virtualization.
struct Model {
    columns: output::Columns,
    outcomes: Vec<Outcome>,
}

fn models(plan: &Plan, len: usize) -> Result<Vec<Model>, Error> {
    for wanted in &plan.wanted {
        if let OutputQuantity::Model { model, measure } = *wanted {
            let count = plan.models.len();
            let virtualization =
                plan.models.get(model).ok_or(Error::NoSuchModel { found: model, count })?;
            measure.check(*virtualization)?;
        }
    }
    let of = |wanted: usize| {
        let measures = plan.wanted.iter().filter_map(move |entry| match *entry {
            OutputQuantity::Model { model, measure } if model == wanted => Some(measure),
            _ => None,
        });
        let outcomes = vec![Outcome::NoMechanism; len];
        Model { columns: output::columns(measures, len), outcomes }
    };
    Ok((0..plan.models.len()).map(of).collect())
}

/// Samples under computation.
struct Work<'a> {
    plan: &'a Plan,
    inputs: &'a Inputs,
    /// (m).
    rods: [Vec<f64>; 3],
    /// (m).
    sides: [Vec<f64>; 3],
    /// Status of the inverse kinematics.
    unreached: Vec<Status>,
    models: Vec<Model>,
}

impl Work<'_> {
    /// The rods of some samples.
    fn inverse(&mut self, robot: &Gpr, part: Range<usize>) -> Result<(), Error> {
        let Inputs { azimuth, tilt_angle, height, .. } = self.inputs;
        let [azimuth, tilt_angle, height] =
            [azimuth, tilt_angle, height].map(|column| Column::from(&column[part.clone()]));
        robot.inverse_many(
            azimuth,
            tilt_angle,
            height,
            &mut self.unreached[part.clone()],
            self.rods.each_mut().map(|rods| &mut rods[part.clone()]),
        )?;
        Ok(())
    }

    /// The poses of some samples.
    fn forward(&mut self, robot: &Gpr, part: Range<usize>) -> Result<(), Error> {
        for i in part.clone() {
            let sides = ball_sides(&robot.ball_centers(&[0, 1, 2].map(|k| self.rods[k][i])));
            for (column, side) in self.sides.iter_mut().zip(sides) {
                column[i] = side;
            }
        }
        let rods = self.rods.each_ref().map(|rods| Column::from(&rods[part.clone()]));
        let mut statuses = vec![Status::Solved; part.len()];
        for (model, virtualization) in self.models.iter_mut().zip(&self.plan.models) {
            let mut wanted: Vec<(Quantity, &mut [f64])> = model
                .columns
                .iter_mut()
                .map(|(quantity, column)| (*quantity, &mut column[part.clone()]))
                .collect();
            let options = &self.plan.options;
            robot.forward_many(rods, *virtualization, options, &mut statuses, &mut wanted)?;
            for (i, status) in part.clone().zip(&statuses) {
                // Without rods there is no pose: the reason is the one for which there are none.
                let first = self.unreached[i];
                let ended = if first == Status::Solved { *status } else { first };
                model.outcomes[i] = Outcome::Pose(ended);
            }
        }
        Ok(())
    }

    /// Marks samples whose dimensions do not form a robot.
    fn no_robot(&mut self, part: Range<usize>) {
        for rods in &mut self.rods {
            rods[part.clone()].fill(f64::NAN);
        }
    }
}
