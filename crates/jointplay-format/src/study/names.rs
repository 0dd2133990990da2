//! Names of quantities with their units, and the columns of a study's table.

use jointplay_core::bulk::Quantity;
use jointplay_core::virtualization::{VirtualJointKind, Virtualization};
use jointplay_study::plan::{Dimension, OutputQuantity, Plan, PlatformQuantity, TiltForm};

use super::quantity::{ANGLES, Asked, Group, LENGTHS, NUMBERS, Term};
use crate::units::Unit;

/// A column of a study's table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Its name, with the unit at its end.
    pub name: String,
    /// The source of its values.
    pub source: Source,
}

/// The source of the values of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The number of the sample.
    Sample,
    /// The number of its draw.
    Draw,
    /// Something wanted of it, in a unit.
    Number {
        /// Which, in the order of the plan.
        index: usize,
        /// Its unit.
        unit: Unit,
        /// Whether it was typed, as what is commanded: then it is written as it was typed.
        typed: bool,
        /// Whether few values come again and again.
        repeats: bool,
    },
    /// Status of the sample under a virtualization.
    Status {
        /// Which, in the order of the plan.
        model: usize,
    },
}

/// Names of several quantities of the robot.
pub(super) fn groups() -> Vec<Group<OutputQuantity>> {
    vec![
        Group {
            name: "rods",
            units: &Unit::LENGTHS,
            has: Box::new(|wanted| matches!(wanted, OutputQuantity::Rod(_))),
        },
        Group {
            name: "sides",
            units: &Unit::LENGTHS,
            has: Box::new(|wanted| matches!(wanted, OutputQuantity::Side(_))),
        },
        Group {
            name: "dimensions",
            units: &[],
            has: Box::new(|wanted| matches!(wanted, OutputQuantity::Built { .. })),
        },
        Group {
            name: "ball_displacements",
            units: &Unit::LENGTHS,
            has: Box::new(|wanted| {
                matches!(
                    wanted,
                    OutputQuantity::Model {
                        measure: PlatformQuantity::Quantity(Quantity::BallDisplacement(_)),
                        ..
                    }
                )
            }),
        },
        Group {
            name: "virtual_joints",
            units: &[],
            has: Box::new(|wanted| {
                matches!(
                    wanted,
                    OutputQuantity::Model {
                        measure: PlatformQuantity::Quantity(Quantity::VirtualJoint(_)),
                        ..
                    }
                )
            }),
        },
    ]
}

/// All that can be asked for under these virtualizations.
pub(super) fn terms(models: &[&'static (dyn Virtualization + Sync)]) -> Vec<Term<OutputQuantity>> {
    let mut terms = Vec::new();
    let mut free = |stem: String, units, wanted| terms.push(Term { stem, units, wanted });
    for k in 0..3 {
        free(format!("q{}", k + 1), LENGTHS, OutputQuantity::Rod(k));
    }
    for (k, name) in ["L12", "L23", "L31"].into_iter().enumerate() {
        free(name.to_owned(), LENGTHS, OutputQuantity::Side(k));
    }
    for dimension in Dimension::ALL {
        let (name, units) = match dimension {
            Dimension::SocketRadius => ("socket_radius", LENGTHS),
            Dimension::SocketAngle => ("socket_angle", ANGLES),
            Dimension::BaseX => ("base_x", LENGTHS),
            Dimension::BaseY => ("base_y", LENGTHS),
        };
        for limb in 0..3 {
            free(format!("{name}_{}", limb + 1), units, OutputQuantity::Built { limb, dimension });
        }
    }
    for (model, virtualization) in models.iter().enumerate() {
        let mut add = |stem: &str, units, measure| {
            let wanted = OutputQuantity::Model { model, measure };
            terms.push(Term { stem: stem.to_owned(), units, wanted });
        };
        let quantity = PlatformQuantity::Quantity;
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            add(&format!("origin_{name}"), LENGTHS, quantity(Quantity::Origin(axis)));
        }
        add("center_shift", LENGTHS, PlatformQuantity::CenterShift);
        add("axis_height", LENGTHS, quantity(Quantity::AxisHeight));
        add("azimuth", ANGLES, quantity(Quantity::Azimuth));
        add("tilt", ANGLES, quantity(Quantity::TiltAngle));
        add("tilt_x", ANGLES, PlatformQuantity::TiltX);
        add("tilt_y", ANGLES, PlatformQuantity::TiltY);
        add("tilt_error", ANGLES, PlatformQuantity::TiltError);
        add("torsion", ANGLES, quantity(Quantity::Torsion));
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            add(&format!("normal_{name}"), NUMBERS, quantity(Quantity::Normal(axis)));
        }
        add("displacement", LENGTHS, quantity(Quantity::Displacement));
        for k in 0..3 {
            let ball = quantity(Quantity::BallDisplacement(k));
            add(&format!("ball_displacement_{}", k + 1), LENGTHS, ball);
        }
        for k in 0..3 {
            add(&format!("sensitivity_{}", k + 1), NUMBERS, quantity(Quantity::Sensitivity(k)));
        }
        add("residual", LENGTHS, quantity(Quantity::Residual));
        add("iterations", NUMBERS, quantity(Quantity::Iterations));
        for (k, joint) in virtualization.joints().iter().enumerate() {
            let units = match joint.motion {
                VirtualJointKind::Linear => LENGTHS,
                VirtualJointKind::Angular => ANGLES,
            };
            let stem = format!("{}{}", joint.symbol, joint.limb + 1);
            add(&stem, units, quantity(Quantity::VirtualJoint(k)));
        }
    }
    terms
}

/// Columns of what is commanded, with what is wanted for them.
pub(super) fn commanded(plan: &Plan) -> Vec<(String, Asked<OutputQuantity>, bool)> {
    let (first, second) = match plan.tilt.form {
        TiltForm::AzimuthAngle => ("azimuth", "tilt"),
        TiltForm::AboutXAndY => ("tilt_x", "tilt_y"),
    };
    let column = |stem: &str, wanted, unit: Unit, spread: &jointplay_study::plan::Variation| {
        (format!("{stem}{}", unit.suffix()), Asked { wanted, unit }, !spread.is_random())
    };
    vec![
        column(first, OutputQuantity::FirstAngle, Unit::Degree, &plan.tilt.first),
        column(second, OutputQuantity::SecondAngle, Unit::Degree, &plan.tilt.second),
        column("height", OutputQuantity::Height, Unit::Millimeter, &plan.height),
    ]
}

/// The columns of a table: sample, draw, what is commanded, what no virtualization changes, then each virtualization with its status.
///
/// Puts what is wanted into the plan, in the same order.
pub(super) fn columns(plan: &mut Plan, asked: &[Asked<OutputQuantity>]) -> Vec<Column> {
    let mut columns = vec![Column { name: "sample".to_owned(), source: Source::Sample }];
    let grid = [&plan.height, &plan.tilt.first, &plan.tilt.second];
    if plan.draws_anything() && grid.iter().any(|spread| spread.values() > 1) {
        columns.push(Column { name: "draw".to_owned(), source: Source::Draw });
    }
    let mut wanted = Vec::new();
    let mut number = |name: String, asked: &Asked<OutputQuantity>, typed: bool, repeats: bool| {
        wanted.push(asked.wanted);
        let source = Source::Number { index: wanted.len() - 1, unit: asked.unit, typed, repeats };
        Column { name, source }
    };
    for (name, asked, listed) in commanded(plan) {
        columns.push(number(name, &asked, true, listed));
    }
    let terms = terms(&plan.models);
    let stem = |wanted: &OutputQuantity| {
        let term = terms.iter().find(|term| term.wanted == *wanted);
        &term.expect("what is asked for was found among the terms").stem
    };
    for asked in asked.iter().filter(|asked| !matches!(asked.wanted, OutputQuantity::Model { .. }))
    {
        let typed = matches!(asked.wanted, OutputQuantity::Built { .. });
        let name = format!("{}{}", stem(&asked.wanted), asked.unit.suffix());
        columns.push(number(name, asked, typed, typed && !plan.tolerances.any()));
    }
    for (k, virtualization) in plan.models.iter().enumerate() {
        let model = virtualization.name();
        for asked in asked {
            if matches!(asked.wanted, OutputQuantity::Model { model, .. } if model == k) {
                let name = format!("{model}_{}{}", stem(&asked.wanted), asked.unit.suffix());
                let repeats = matches!(
                    asked.wanted,
                    OutputQuantity::Model {
                        measure: PlatformQuantity::Quantity(Quantity::Iterations),
                        ..
                    }
                );
                columns.push(number(name, asked, false, repeats));
            }
        }
        columns
            .push(Column { name: format!("{model}_status"), source: Source::Status { model: k } });
    }
    plan.wanted = wanted;
    columns
}
