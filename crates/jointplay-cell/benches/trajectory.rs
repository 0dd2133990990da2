//! Duration of planning and checking a lot of 25 wafers, collisions included, at 1 kHz.
//!
//! A radial arm picks each wafer of one port and places it into another; both ports have walls.
#![expect(clippy::unwrap_used, reason = "a benchmark of a failure would be none")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::A;
use criterion::{Criterion, criterion_group, criterion_main};
use jointplay_cell::check::{CheckOptions, check};
use jointplay_cell::geometry::Shape;
use jointplay_cell::program::{
    Command, Instruction, Name, Number, Program, SlotName, SourceLocation, Step, expand,
};
use jointplay_cell::station::teach::FrameUncertainty;
use jointplay_cell::station::{Approach, Origin, SlotId, Station, Stroke};
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::{Body, Cell, ParentFrame};
use jointplay_core::spatial::Pose;
use nalgebra::{Rotation3, Translation3, Vector3};

const WAFERS: usize = 25;

/// A port in a direction from the robot's axis, its lowest slot 0.6 m from it and 0.62 m high.
fn port(name: &str, direction: f64) -> Station {
    let out = Vector3::new(direction.cos(), direction.sin(), 0.0) * 0.6;
    let turn =
        Rotation3::from_axis_angle(&Vector3::z_axis(), direction - std::f64::consts::FRAC_PI_2);
    let place = Translation3::new(out.x, out.y, 0.62);
    Station {
        name: name.to_owned(),
        base_from_station: Pose::from_parts(place, turn),
        origin: Origin::Nominal,
        uncertainty: FrameUncertainty::UNKNOWN,
        slots: WAFERS,
        pitch: 0.01,
        slot_step: [0.0; 2],
        stroke: Stroke { below: 0.003, above: 0.003, speed: 0.05 },
        offset: [0.0; 3],
        retract_reach: 0.3,
        via: Vec::new(),
        approach: Approach::Radial,
        effectors: vec![A],
        process_time: 0.0,
    }
}

fn body(name: &str, parent: ParentFrame, pose: Pose, half: [f64; 3]) -> Body {
    let shape = Shape::Box { half };
    Body { name: name.to_owned(), parent, parent_from_shape: pose, shape, station: None }
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_parts(Translation3::new(x, y, z), Rotation3::identity())
}

fn cell() -> Cell {
    let stations = vec![port("P1", 0.4), port("P2", -1.2)];
    let link = |link| ParentFrame::Link { arm: 0, link };
    let mut bodies = vec![
        body("upper arm", link(0), at(0.125, 0.0, -0.02), [0.15, 0.03, 0.005]),
        body("forearm", link(1), at(0.125, 0.0, -0.02), [0.15, 0.03, 0.005]),
        body("blade", link(2), at(0.15, 0.0, 0.004), [0.15, 0.02, 0.0005]),
    ];
    for station in &stations {
        let walls = [
            ("left", at(-0.17, 0.0, 0.12), [0.005, 0.16, 0.14]),
            ("right", at(0.17, 0.0, 0.12), [0.005, 0.16, 0.14]),
            ("back", at(0.0, 0.17, 0.12), [0.17, 0.005, 0.14]),
        ];
        for (side, pose, half) in walls {
            let name = format!("{} {side}", station.name);
            bodies.push(body(&name, ParentFrame::World, station.base_from_station * pose, half));
        }
    }
    Cell {
        stations,
        occupied: (1..=WAFERS).map(|slot| SlotId { station: 0, slot }).collect(),
        loaded_effectors: Vec::new(),
        bodies,
        plane_threshold: 1e-5,
        coverage_factor: 2.0,
        tolerances: jointplay_cell::displacement::Tolerances::default(),
        ..common::cell(common::kind(0, [0.25, 0.22, 0.2]))
    }
}

fn lot(cell: &Cell) -> Vec<Step> {
    let place = SourceLocation { line: 1, column: 1 };
    let name = |text: &str| Name { text: text.to_owned(), place };
    let slot = |station: &str, number| SlotName {
        station: name(station),
        slot: Some(Number::whole(number)),
    };
    let body = (1..=WAFERS).map(|number| Instruction {
        place,
        command: Command::Transfer {
            from: slot("P1", number),
            to: slot("P2", number),
            effector: None,
        },
    });
    let program = Program { body: body.collect(), ..Program::default() };
    expand(cell, &program).unwrap()
}

fn motion(criterion: &mut Criterion) {
    let cell = cell();
    let steps = lot(&cell);
    let options = TrajectoryOptions::default();
    let motion = plan_trajectory(&cell, steps.clone(), &options).unwrap();
    let named = format!("{} steps, {:.0} s", steps.len(), motion.duration());
    let mut group = criterion.benchmark_group("lot of 25");
    group.sample_size(10);
    group.bench_function(format!("plan_trajectory: {named}"), |bench| {
        bench.iter(|| plan_trajectory(&cell, black_box(steps.clone()), &options).unwrap());
    });
    group.bench_function(format!("checked at 1 kHz: {named}"), |bench| {
        bench.iter(|| check(&cell, black_box(&motion), &CheckOptions::default()));
    });
    group.finish();
}

criterion_group!(benches, motion);
criterion_main!(benches);
