//! Lines into stations of arms with an elbow and a slide behind it.

use jointplay_cell::program::{Phase, expand};
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_format::cell::explain_trajectory::explain_step;
use jointplay_format::display_units::DisplayUnits;
use jointplay_format::{cell, program};

/// A cell with a station in front of an arm of two links of 210 mm and a slide, with a wrist between them or without.
fn slide_cell(wrist: bool, retract_mm: f64, distance_mm: f64) -> Cell {
    let axis = |name: &str, kind: &str, range: &str, home: &str, unit: &str| {
        let limits = if unit == "deg" { [240.0, 700.0, 7000.0] } else { [400.0, 2000.0, 20000.0] };
        let [v, a, j] = limits;
        let limits = format!(
            "{{ velocity_{unit}_s = {v:.1}, acceleration_{unit}_s2 = {a:.1}, jerk_{unit}_s3 = {j:.1} }}"
        );
        format!(
            "[[robot.axis]]\nname = \"{name}\"\nkind = \"{kind}\"\nrange_{unit} = {range}\nhome_{unit} = {home}\nempty = {limits}\nloaded = {limits}\n"
        )
    };
    let wrist_axis =
        if wrist { axis("W", "turn", "[-220, 220]", "-90", "deg") } else { String::new() };
    let wrist_joint =
        if wrist { "  { kind = \"turn\", drives = { W = 1 }, length_mm = 0 },\n" } else { "" };
    let text = format!(
        r#"kind = "cell"
name = "elbow and slide"
[robot]
name = "slides"
gpr = "gpr"
[robot.rods]
empty = {{ velocity_mm_s = 250.0, acceleration_mm_s2 = 1200.0, jerk_mm_s3 = 11000.0 }}
loaded = {{ velocity_mm_s = 180.0, acceleration_mm_s2 = 700.0, jerk_mm_s3 = 7000.0 }}
{}{}{wrist_axis}{}
[[robot.arm]]
name = "arm"
mount_mm = [0, 0, 55.0]
joint = [
  {{ kind = "turn", drives = {{ S = 1 }}, length_mm = 210 }},
  {{ kind = "turn", drives = {{ E = 1 }}, length_mm = 210 }},
{wrist_joint}  {{ kind = "slide", drives = {{ P = 1 }}, rise_mm = 9.0 }},
]
[[robot.arm.effector]]
name = "A"
wafer_center_mm = [210.0, 0.0, 8.0]
support = {{ kind = "edge" }}
friction = 0.45
{}
[[station]]
name = "Oven"
position_mm = [0, -{distance_mm}, 576]
heading_deg = 180
stroke = {{ below_mm = 4.0, above_mm = 4.0, speed_mm_s = 15.0 }}
retract_mm = {retract_mm}
wafers = [1]
"#,
        axis("S", "turn", "[-200, 200]", "-120", "deg"),
        axis("E", "turn", "[-165, 165]", "100", "deg"),
        axis("P", "slide", "[-40, 160]", "0", "mm"),
        include_str!("wafer_and_budgets.toml"),
    );
    cell::read(&text, &mut |_| Err("no files".to_owned()))
        .unwrap_or_else(|errors| panic!("{errors:?}\n{text}"))
}

/// Centre of the wafer in the plane of the arm (m).
fn tip(wrist: bool, motors: &[f64]) -> [f64; 2] {
    let [s, e] = [motors[0], motors[1]];
    let (w, p) = if wrist { (motors[2], motors[3]) } else { (0.0, motors[2]) };
    let polar = |length: f64, angle: f64| [length * angle.cos(), length * angle.sin()];
    let links = [polar(0.21, s), polar(0.21, s + e), polar(0.21 + p, s + e + w)];
    [0, 1].map(|k| links.iter().map(|link| link[k]).sum())
}

#[test]
fn lines_into_stations_are_planned_for_arms_with_an_elbow_and_a_slide() {
    for wrist in [false, true] {
        for (retract_mm, distance_mm) in
            [(250.0, 590.0), (320.0, 590.0), (380.0, 590.0), (450.0, 590.0), (300.0, 640.0)]
        {
            let cell = slide_cell(wrist, retract_mm, distance_mm);
            let moves = if wrist { "MOVE S -122 deg E 41 deg W 0 deg\n" } else { "" };
            for start in ["", moves] {
                let text = format!("{start}GET Oven WITH A\nPUT Oven WITH A\nHOME\n");
                let steps = expand(&cell, &program::parse(&text).unwrap())
                    .unwrap_or_else(|errors| panic!("{retract_mm} {errors:?}"));
                let plan = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
                let mut lines = 0;
                for (step, times) in plan.steps.iter().zip(plan.times.windows(2)) {
                    if !matches!(step.phase, Phase::Extend | Phase::Retract) {
                        continue;
                    }
                    lines += 1;
                    // A jagged path of the axes takes many times as long.
                    let duration = times[1] - times[0];
                    assert!(duration < 2.5, "{wrist} {retract_mm} {duration}");
                    for (positions, end) in [
                        (&step.from, step.phase == Phase::Retract),
                        (&step.to, step.phase == Phase::Extend),
                    ] {
                        for (axis, position) in cell.robot.axes.iter().zip(positions) {
                            assert!((axis.min..=axis.max).contains(position), "{}", axis.name);
                        }
                        let [x, y] = tip(wrist, &positions[3..]);
                        let wanted = if end { distance_mm } else { retract_mm };
                        assert!(x.abs() < 2e-3 && (y + wanted / 1e3).abs() < 2e-3, "{x} {y}");
                    }
                }
                assert_eq!(lines, 4);
            }
        }
    }
}

#[test]
fn lines_without_planned_postures_have_smooth_paths_of_the_axes() {
    let cell = slide_cell(true, 300.0, 590.0);
    // A jagged path takes three to eight times as long.
    let text = "MOVE S -100 deg E 100 deg W -50 deg P 0 mm\n\
        MOVE LINE BY X 100 mm Y 150 mm\n\
        MOVE LINE BY X -150 mm Y 150 mm\n\
        MOVE S -136.98 deg E 145.42 deg W -122.81 deg P -7.83 mm\n\
        MOVE LINE BY X -20 mm Y -230 mm\n\
        MOVE LINE BY X 20 mm Y 230 mm\n";
    let steps = expand(&cell, &program::parse(text).unwrap()).unwrap();
    let plan = plan_trajectory(&cell, steps, &TrajectoryOptions::default()).unwrap();
    for times in plan.times.windows(2) {
        let duration = times[1] - times[0];
        assert!(duration < 0.9, "{duration} s");
    }
}

#[test]
fn errors_of_relative_lines_give_no_advice_about_stations() {
    let cell = slide_cell(false, 320.0, 590.0);
    let steps_of = |line: &str| {
        let text = format!("MOVE S 0 deg E 90 deg P 0 mm\nMOVE LINE BY {line}\n");
        expand(&cell, &program::parse(&text).unwrap()).ok()
    };
    let mut refused = 0;
    for by in (-40..=40).flat_map(|x| (-40..=40).map(move |y| [20 * x, 20 * y])) {
        let Some(steps) = steps_of(&format!("X {} mm Y {} mm", by[0], by[1])) else { continue };
        let Err(error) = plan_trajectory(&cell, steps, &TrajectoryOptions::default()) else {
            continue;
        };
        let message = explain_step(&cell.robot, &error.steps[0], DisplayUnits::Metric);
        assert!(!message.contains("retract_mm") && !message.contains("station"), "{message}");
        refused += 1;
        if refused > 5 {
            return;
        }
    }
    panic!("no line is refused");
}
