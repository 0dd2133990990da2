//! Arms and effectors of cell files, added, duplicated and removed.

use jointplay_cell::check::CheckOptions;
use jointplay_cell::robot::HybridRobot;
use jointplay_cell::workcell::Cell;
use jointplay_cell::{IncrementalPlanner, PlanOptions};
use jointplay_format::cell::{
    self, ArmEdits, EXAMPLE, EntryAdded, EntryList, NewEntry, add_entry, duplicate_entry, expand,
    remove_entry,
};
use jointplay_format::program;
use proptest::prelude::*;

/// A cell with one arm in its own table, with comments everywhere, expressions, templates, and a frame on the arm.
const OWN: &str = concat!(
    r#"# A cell of a stranger.
kind = "cell"   # always
name = "Own robot"
assumed = ["everything"]
# Built into each other.
may_touch = [
    ["mast", "lower-link"], # first
    # The blade sits on the hand.
    ["hand", "blade"], # second
]

[parameters]
link_mm = 230.0
deck_mm = 60
# Robot: one arm.
[robot] # in this file
name = "Mine"
gpr = "gpr"

[robot.rods]
home_mm = 500.0
empty = { velocity_mm_s = 300.0, acceleration_mm_s2 = 1500.0, jerk_mm_s3 = 15000.0 }
loaded = { velocity_mm_s = 200.0, acceleration_mm_s2 = 800.0, jerk_mm_s3 = 8000.0 }

# The arm turns with T.
[[robot.axis]]
name = "T"
kind = "turn"
range_deg = [-190.0, 190.0] # more than a turn
home_deg = 0.0
empty = { velocity_deg_s = 270.0, acceleration_deg_s2 = 800.0, jerk_deg_s3 = 8000.0 }
loaded = { velocity_deg_s = 180.0, acceleration_deg_s2 = 360.0, jerk_deg_s3 = 3600.0 }

[[robot.axis]]
name = "R"
kind = "turn"
range_deg = [-45.0, 80.0]
home_deg = -40.0
empty = { velocity_deg_s = 300.0, acceleration_deg_s2 = 1200.0, jerk_deg_s3 = 12000.0 }
loaded = { velocity_deg_s = 150.0, acceleration_deg_s2 = 400.0, jerk_deg_s3 = 4000.0 }

# The only one.
[[robot.arm]]
name = "arm"
mount_mm = [0.0, 0.0, "deck_mm"] # on the deck
joint = [
    { kind = "turn", zero_deg = -90, drives = { T = 1, R = 1 }, length_mm = "link_mm" },
    { kind = "turn", zero_deg = 180, drives = { R = -2 }, length_mm = "link_mm", rise_mm = 15 }, # elbow
    { kind = "turn", zero_deg = -90, drives = { R = 1 }, rise_mm = 15 },
]
effector = [{ name = "E", wafer_center_mm = [300, 0, 10], support = { kind = "edge" }, friction = 0.4 }]

"#,
    include_str!("wafer_and_budgets.toml"),
    r#"
# Ports.
[[station]]
name = "P1"
position_mm = [-700.0, 0.0, 560.0]
heading_deg = 90.0
stroke = { below_mm = 4.0, above_mm = 3.0, speed_mm_s = 20.0 }
retract_mm = 10.0
effectors = ["E"]
wafers = "all"

[[template]]
name = "on-hand"
on = { arm = "arm", link = 3 }

[[frame]]
name = "hand-frame" # of the hand
on = { arm = "arm", link = 3 }
position_mm = [0, 0, 2]

[[body]]
name = "mast"
on = "platform"
cylinder = { radius_mm = 40, height_mm = 20 }

[[body]]
name = "lower-link"
on = { arm = "arm", link = 1 }
position_mm = [115, 0, 0]
box = { size_mm = [280, 50, 10] }

[[body]]
name = "hand"
like = "on-hand"
position_mm = [60, 0, 0]
box = { size_mm = [150, 40, 8] }

# Holes of the hand.
[[body]]
name = "pin"
on = { frame = "hand-frame" }
repeat = { count = 2, step_mm = [20, 0, 0] }
cylinder = { radius_mm = 3, height_mm = 8 }

[[part]]
name = "blade"
part = "fork-blade"
on = { effector = "E" }
# The end.
"#
);

fn no_files(_: &str) -> Result<Vec<u8>, String> {
    Err("no files".to_owned())
}

#[track_caller]
fn read(text: &str) -> Cell {
    cell::read(text, &mut no_files).unwrap_or_else(|errors| {
        let all: Vec<String> = errors.iter().map(|it| it.with_excerpt("cell.toml")).collect();
        panic!("{}\n{text}", all.join("\n"))
    })
}

fn comments(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| line.find('#').map(|at| line[at..].trim())).collect()
}

/// Names of arms, axes without rods, and effectors.
fn names(robot: &HybridRobot) -> [Vec<&str>; 3] {
    [
        robot.arms.iter().map(|arm| arm.name.as_str()).collect(),
        robot.axes[3..].iter().map(|axis| axis.name.as_str()).collect(),
        robot.arms.iter().flat_map(|arm| &arm.effectors).map(|one| one.name.as_str()).collect(),
    ]
}

const NONE: [&str; 0] = [];

/// Violations of a program, which has to be valid.
#[track_caller]
fn violations(cell: &Cell, program: &str) -> Vec<String> {
    let check = CheckOptions { rate: 100.0, report_distance: 0.05 };
    let options = PlanOptions { check, ..PlanOptions::default() };
    let program = program::parse(program).unwrap();
    let (_, report) = IncrementalPlanner::default().plan(cell, &program, &options).unwrap();
    report.violations.iter().map(|violation| violation.describe(cell)).collect()
}

fn add(text: &str) -> EntryAdded {
    add_entry(text, &NewEntry::Arm, &mut no_files).unwrap()
}

fn add_effector(text: &str, arm: &str) -> EntryAdded {
    add_entry(text, &NewEntry::Effector { arm: arm.to_owned() }, &mut no_files).unwrap()
}

fn duplicate(text: &str, list: EntryList, name: &str) -> EntryAdded {
    duplicate_entry(text, list, name, &mut no_files).unwrap()
}

#[test]
fn a_robot_can_be_described_in_the_cell_file() {
    let cell = read(OWN);
    assert_eq!(names(&cell.robot), [vec!["arm"], vec!["T", "R"], vec!["E"]]);
    assert!((cell.robot.arms[0].mount[2] - 0.06).abs() < 1e-12);
    assert!((cell.robot.arms[0].joints[0].length - 0.23).abs() < 1e-12);
    assert_eq!(violations(&cell, "HOME\nGET P1\nPUT P1\nHOME\n"), NONE);
    // The expansion has the values of the expressions, and describes the same cell.
    let expanded = expand(OWN, &[], &mut no_files).unwrap();
    assert_eq!(format!("{:?}", read(&expanded)), format!("{cell:?}"));
    // Errors have their places; a robot with contradictions is an error, too.
    let folded = |text: &str| {
        let text = text.replace("drives = { T = 1, R = 1 }", "drives = { T = 1 }");
        text.replace("drives = { R = -2 }", "drives = { T = -2 }")
            .replace("drives = { R = 1 }", "drives = { T = 1 }")
    };
    for (changed, expected, place) in [
        (OWN.replace("\"deck_mm\"]", "\"dek_mm\"]"), "dek_mm", "dek_mm"),
        (OWN.replace("gpr = ", "colour = 1\ngpr = "), "colour", "colour"),
        (OWN.replace("{ R = -2 }", "{ S = -2 }"), "known: T, R", "S = -2"),
        (folded(OWN), "along 1 of the 2 directions", "name = \"E\""),
    ] {
        let errors = cell::read(&changed, &mut no_files).unwrap_err();
        let found = errors.iter().find(|error| error.to_string().contains(expected));
        let found = found.unwrap_or_else(|| panic!("{expected}: {errors}"));
        assert!(found.place.text.contains(place), "{found} {:?}", found.place);
    }
}

#[test]
fn an_added_arm_is_usable_and_removed_without_a_trace() {
    let EntryAdded { text, name } = add(OWN);
    assert_eq!(name, "arm-1");
    let cell = read(&text);
    assert_eq!(
        names(&cell.robot),
        [vec!["arm", "arm-1"], vec!["T", "R", "T2", "R2"], vec!["E", "A"]]
    );
    assert_eq!(cell.bodies.len(), read(OWN).bodies.len() + 4);
    for line in comments(OWN) {
        assert!(comments(&text).contains(&line), "{line}");
    }
    // It hits nothing at home and while the other arm works, and reaches a station.
    assert_eq!(violations(&cell, "HOME\nGET P1 WITH E\nPUT P1 WITH E\nHOME\n"), NONE);
    let all = read(&text.replace("effectors = [\"E\"]\n", ""));
    assert_eq!(violations(&all, "HOME\nGET P1 WITH A\nPUT P1 WITH A\nHOME\n"), NONE);
    assert_eq!(remove_entry(&text, EntryList::Arm, "arm-1").unwrap(), OWN);
}

#[test]
fn a_duplicated_arm_has_axes_effectors_and_bodies_of_its_own_above_the_original() {
    let EntryAdded { text, name } = duplicate(OWN, EntryList::Arm, "arm");
    assert_eq!(name, "arm2");
    let cell = read(&text);
    assert_eq!(
        names(&cell.robot),
        [vec!["arm", "arm2"], vec!["T", "T2", "R", "R2"], vec!["E", "E2"]]
    );
    let bodies: Vec<&str> = cell.bodies.iter().map(|body| body.name.as_str()).collect();
    for name in ["lower-link2", "hand2", "pin-2-1", "pin-2-2", "blade2-plate"] {
        assert!(bodies.contains(&name), "{bodies:?}");
    }
    assert!(!bodies.contains(&"mast2"));
    assert!(text.contains("[\"hand2\", \"blade2\"]"), "{text}");
    assert!(text.contains("\"(deck_mm) + "), "{text}");
    assert_eq!(violations(&cell, "HOME\nGET P1 WITH E\nPUT P1 WITH E\nHOME\n"), NONE);
    assert_eq!(remove_entry(&text, EntryList::Arm, "arm2").unwrap(), OWN);
    // What is left after the original is removed works as before.
    let rest = remove_entry(&text, EntryList::Arm, "arm").unwrap();
    let rest = rest.replace("effectors = [\"E\"]", "effectors = [\"E2\"]");
    assert_eq!(violations(&read(&rest), "HOME\nGET P1\nPUT P1\nHOME\n"), NONE);
}

#[test]
fn effectors_are_duplicated_and_removed_with_their_bodies() {
    let EntryAdded { text, name } = duplicate(OWN, EntryList::Effector, "E");
    assert_eq!(name, "E2");
    let cell = read(&text);
    let [one, other] = &cell.robot.arms[0].effectors[..] else { panic!("{text}") };
    assert!((other.wafer_center[2] - one.wafer_center[2] - 0.01).abs() < 1e-12);
    assert!(cell.bodies.iter().any(|body| body.name == "blade2-plate"));
    assert_eq!(remove_entry(&text, EntryList::Effector, "E2").unwrap(), OWN);
    let rest = remove_entry(&text, EntryList::Effector, "E").unwrap();
    assert!(!rest.contains("\"blade\"\npart"), "{rest}");
    // References of stations remain, as an error with its place.
    let errors = cell::read(&rest, &mut no_files).unwrap_err();
    assert!(errors.to_string().contains("effector \"E\" is not known"), "{errors}");
}

#[test]
fn an_added_effector_is_usable_and_removed_without_a_trace() {
    let EntryAdded { text, name } = add_effector(OWN, "arm");
    assert_eq!(name, "E2");
    let cell = read(&text);
    let [one, other] = &cell.robot.arms[0].effectors[..] else { panic!("{text}") };
    for (found, expected) in other.wafer_center.iter().zip([0.3, 0.0, 0.02]) {
        assert!((found - expected).abs() < 1e-12, "{:?}", other.wafer_center);
    }
    assert_eq!(other.heading, one.heading);
    // Its blade is below its wafer, and above the wafer of the other effector.
    let blade = cell.bodies.iter().find(|body| body.name == "E2-blade").unwrap();
    let surface = blade.shape.surface();
    for point in &surface.vertices {
        let z = (blade.parent_from_shape * nalgebra::Point3::from(*point)).z;
        assert!(z > 0.01 + cell.wafer.thickness + 0.001 && z < 0.02, "{z}");
    }
    assert_eq!(cell.bodies.len(), read(OWN).bodies.len() + 1);
    for line in comments(OWN) {
        assert!(comments(&text).contains(&line), "{line}");
    }
    let all = read(&text.replace("effectors = [\"E\"]\n", ""));
    for effector in ["E", "E2"] {
        let program = format!("HOME\nGET P1 WITH {effector}\nPUT P1 WITH {effector}\nHOME\n");
        assert_eq!(violations(&all, &program), NONE);
    }
    // Both carry a wafer at the same time.
    let both = "HOME\nGET P1 SLOT 1 WITH E\nGET P2 SLOT 1 WITH E2\nPUT P1 SLOT 1 WITH E\nPUT P2 SLOT 1 WITH E2\nHOME\n";
    let station = &OWN[OWN.find("[[station]]").unwrap()..OWN.find("[[template]]").unwrap()];
    let second = station.replace("P1", "P2").replace("[-700.0, 0.0,", "[700.0, 0.0,");
    let second = second.replace("heading_deg = 90.0", "heading_deg = -90.0");
    let two = text.replace("[[template]]", &format!("{second}[[template]]"));
    assert_eq!(violations(&read(&two.replace("effectors = [\"E\"]\n", "")), both), NONE);
    assert_eq!(remove_entry(&text, EntryList::Effector, "E2").unwrap(), OWN);
}

#[test]
fn an_added_effector_is_above_the_highest_one_of_its_arm() {
    // The highest effector is not the last one, and an expression; it points backward.
    let effectors = r#"effector = [
    { name = "up", wafer_center_mm = ["-300", 0, "link_mm / 10"], heading_deg = "90 * 2", support = { kind = "edge" }, friction = 0.4 }, # high
    { name = "low", wafer_center_mm = [300, 0, 10], support = { kind = "edge" }, friction = 0.4 },
]"#;
    let start = OWN.find("effector = [{").unwrap();
    let end = start + OWN[start..].find('\n').unwrap();
    let text = format!("{}{effectors}{}", &OWN[..start], &OWN[end..]);
    let text = text.replace("effectors = [\"E\"]", "effectors = [\"low\"]");
    let text = text.replace("effector = \"E\"", "effector = \"low\"");
    let added = add_effector(&text, "arm");
    assert_eq!(added.name, "up2");
    let cell = read(&added.text);
    let new = &cell.robot.arms[0].effectors[2];
    assert!((new.wafer_center[2] - 0.033).abs() < 1e-12, "{:?}", new.wafer_center);
    assert!((new.heading - std::f64::consts::PI).abs() < 1e-12);
    assert!(added.text.contains("\"(link_mm / 10) + 10"), "{}", added.text);
    assert_eq!(comments(&added.text), comments(&text));
    assert_eq!(remove_entry(&added.text, EntryList::Effector, "up2").unwrap(), text);
    // Without one, it is that of the catalogue.
    let none = format!("{}effector = []{}", &OWN[..start], &OWN[end..]);
    let none = none.replace("effectors = [\"E\"]\n", "");
    let none = none.replace("    [\"hand\", \"blade\"], # second\n", "");
    let none = &none[..none.find("[[part]]").unwrap()];
    let first = add_effector(none, "arm");
    assert_eq!(violations(&read(&first.text), "HOME\nGET P1\nPUT P1\nHOME\n"), NONE);
    // The robot of the catalogue is copied first, and the effector belongs to the named arm.
    let copied = add_effector(EXAMPLE, "lower");
    assert_eq!(copied.name, "B2");
    assert_eq!(names(&read(&copied.text).robot)[2], ["A", "B", "B2"]);
}

#[test]
fn a_robot_of_the_catalogue_is_copied_into_the_cell_file() {
    let before = read(EXAMPLE);
    let text = remove_entry(EXAMPLE, EntryList::Arm, "upper").unwrap();
    let after = read(&text);
    assert_eq!(names(&after.robot), [vec!["lower"], vec!["T", "RB"], vec!["B"]]);
    let on_upper = ["hub", "upper-arm-A", "forearm-A", "post-A", "bracket-A", "blade-A"];
    assert_eq!(after.bodies.len(), before.bodies.len() - on_upper.len());
    let pairs = text.lines().filter(|line| line.starts_with("    [\"")).collect::<Vec<_>>();
    assert!(
        !pairs.iter().any(|line| on_upper.iter().any(|name| line.contains(&format!("\"{name}\""))))
    );
    // The comment directly above `hub` is removed with it.
    let of_others = |line: &&str| !line.starts_with("# Links of an arm");
    for line in comments(EXAMPLE).into_iter().filter(of_others) {
        assert!(comments(&text).contains(&line), "{line}");
    }
    assert!(
        text.contains("# Copied from \"dual-arm\" of the catalogue.\n# Two arms that move wafers"),
        "{text}"
    );
    // The order in which arms change does not matter: the copy is made once.
    let again = add(&text);
    assert_eq!(
        violations(
            &read(&again.text),
            "HOME\nGET LP1 SLOT 2 WITH A\nPUT PM1 WITH A\nGET PM1 WITH B\nPUT LP2 SLOT 3 WITH B\nHOME\n"
        ),
        NONE
    );
    assert_eq!(remove_entry(&again.text, EntryList::Arm, &again.name).unwrap(), text);
    // Comments next to `robot` follow it.
    let named =
        "# Ours.\n\n# A good one.\nrobot = \"radial-arm\" # since May\nname = \"x\"\n# End.\n";
    let text = add(named).text;
    assert!(text.starts_with("# Ours.\n\nname = \"x\"\n"), "{text}");
    assert!(text.contains("# A good one.\n# Copied from \"radial-arm\""), "{text}");
    assert!(text.contains("[robot] # since May\n"), "{text}");
    assert!(text.contains("# End.\n"), "{text}");
}

#[test]
fn arms_of_every_robot_of_the_catalogue_are_duplicated_and_removed() {
    for robot in cell::robot::names() {
        let text = EXAMPLE.replace("robot = \"dual-arm\"", &format!("robot = {robot:?}"));
        // Bodies of the example belong to the arms of its own robot.
        let text = if robot == "dual-arm" { text } else { without_bodies(&text) };
        let arms: Vec<String> = read(&text).robot.arms.iter().map(|arm| arm.name.clone()).collect();
        for arm in &arms {
            let one = match arms.iter().find(|other| *other != arm) {
                Some(other) => remove_entry(&text, EntryList::Arm, other).unwrap(),
                None => text.clone(),
            };
            let EntryAdded { text: two, name } = duplicate(&one, EntryList::Arm, arm);
            let cell = read(&two);
            assert_eq!(cell.robot.arms.len(), 2, "{robot} {arm}");
            assert_eq!(violations(&cell, "HOME\n"), NONE, "{robot} {arm}");
            let back = remove_entry(&two, EntryList::Arm, &name).unwrap();
            if one.contains("[robot]") {
                assert_eq!(back, one, "{robot} {arm}");
            }
            // A second duplicate in its place is the same.
            assert_eq!(duplicate(&back, EntryList::Arm, arm).text, two, "{robot} {arm}");
            let effector = cell.robot.arms[0].effectors[0].name.clone();
            let blades = duplicate(&two, EntryList::Effector, &effector);
            assert_eq!(violations(&read(&blades.text), "HOME\n"), NONE, "{robot} {arm}");
            assert_eq!(remove_entry(&blades.text, EntryList::Effector, &blades.name).unwrap(), two);
            let blades = add_effector(&two, arm);
            assert_eq!(violations(&read(&blades.text), "HOME\n"), NONE, "{robot} {arm}");
            assert_eq!(remove_entry(&blades.text, EntryList::Effector, &blades.name).unwrap(), two);
        }
    }
}

/// A cell without the bodies of a robot, and without their allowed contacts.
fn without_bodies(text: &str) -> String {
    let mut document: toml::Table = text.parse().unwrap();
    document.remove("may_touch");
    let bodies = document["body"].as_array_mut().unwrap();
    bodies.retain(|body| body.get("on").is_none_or(|on| on.get("arm").is_none()));
    toml::to_string(&document).unwrap()
}

#[test]
fn inline_robots_and_lists_are_changed_too() {
    let inline = r#"kind = "cell"
name = "inline"
# The robot on one line.
robot = { name = "r", gpr = "gpr", rods = { empty = { velocity_mm_s = 300, acceleration_mm_s2 = 1500, jerk_mm_s3 = 15000 }, loaded = { velocity_mm_s = 200, acceleration_mm_s2 = 800, jerk_mm_s3 = 8000 } }, axis = [
    { name = "T", kind = "turn", range_deg = [-190, 190], home_deg = 0, empty = { velocity_deg_s = 270, acceleration_deg_s2 = 800, jerk_deg_s3 = 8000 }, loaded = { velocity_deg_s = 180, acceleration_deg_s2 = 360, jerk_deg_s3 = 3600 } }, # turns
    { name = "X", kind = "slide", range_mm = [0, 500], home_mm = 10, empty = { velocity_mm_s = 270, acceleration_mm_s2 = 800, jerk_mm_s3 = 8000 }, loaded = { velocity_mm_s = 180, acceleration_mm_s2 = 360, jerk_mm_s3 = 3600 } } # slides
], arm = [{ name = "a", mount_mm = [0, 0, 50], joint = [{ kind = "turn", drives = { T = 1 }, length_mm = 0 }, { kind = "slide", drives = { X = 1 } }], effector = [{ name = "e", wafer_center_mm = [0, 0, 5], support = { kind = "edge" }, friction = 0.5 }] }] } # so
wafer = { diameter_mm = 300, thickness_mm = 0.775, material = "silicon" }
budgets = { virtual_joint_norm_um = 60, min_distance_mm = 4, slot_min_distance_mm = 1, plane_urad = 20 }
body = [
    # The slide.
    { name = "s", on = { arm = "a", link = 2 }, box = { size_mm = [100, 40, 10] } }, # moves
    { name = "floor", box = { size_mm = [100, 40, 10] } },
]
may_touch = [["s", "floor"]]
station = [{ name = "P", position_mm = [400, 0, 560], heading_deg = -90, stroke = { below_mm = 4, above_mm = 3, speed_mm_s = 20 }, retract_mm = 20 }]
"#;
    let before = read(inline);
    assert_eq!(names(&before.robot), [vec!["a"], vec!["T", "X"], vec!["e"]]);
    let two = duplicate(inline, EntryList::Arm, "a");
    assert_eq!(violations(&read(&two.text), "HOME\n"), NONE);
    assert_eq!(comments(&two.text), comments(inline));
    assert_eq!(remove_entry(&two.text, EntryList::Arm, &two.name).unwrap(), inline);
    let added = add(inline);
    let cell = read(&added.text);
    assert_eq!(names(&cell.robot), [vec!["a", "arm-1"], vec!["T", "X", "T2", "R"], vec!["e", "A"]]);
    assert_eq!(violations(&cell, "HOME\n"), NONE);
    assert_eq!(comments(&added.text), comments(inline));
    assert_eq!(remove_entry(&added.text, EntryList::Arm, &added.name).unwrap(), inline);
    let blades = duplicate(inline, EntryList::Effector, "e");
    assert_eq!(read(&blades.text).robot.arms[0].effectors.len(), 2);
    assert_eq!(remove_entry(&blades.text, EntryList::Effector, "e2").unwrap(), inline);
    let blade = add_effector(inline, "a");
    assert_eq!(comments(&blade.text), comments(inline));
    assert_eq!(violations(&read(&blade.text), "HOME\n"), NONE);
    assert_eq!(remove_entry(&blade.text, EntryList::Effector, "e2").unwrap(), inline);
    let rest = remove_entry(&two.text, EntryList::Arm, "a").unwrap();
    // Comments of what is removed are removed with it.
    assert_eq!(comments(&rest), ["# The robot on one line.", "# so"]);
    read(&rest);
}

#[test]
fn a_robot_without_arms_is_invalid_until_it_gets_one() {
    let lists = OWN.find("# The arm turns").unwrap()..OWN.find("[wafer]").unwrap();
    let bodies = OWN.find("[[template]]").unwrap();
    let text = format!("{}arm = []\naxis = []\n{}", &OWN[..lists.start], &OWN[lists.end..bodies]);
    // Values of `[robot]` are above its tables.
    let text = text.replace("arm = []\naxis = []\n", "");
    let text = text.replace("gpr = \"gpr\"\n", "gpr = \"gpr\"\narm = [] # none yet\naxis = []\n");
    let text = text.replace("effectors = [\"E\"]\n", "");
    let text = format!(
        "{}{}",
        &text[..text.find("# Built").unwrap()],
        &text[text.find("[parameters]").unwrap()..]
    );
    let errors = cell::read(&text, &mut no_files).unwrap_err();
    assert!(errors.to_string().contains("arms"), "{errors}");
    let added = add(&text);
    let cell = read(&added.text);
    assert_eq!(names(&cell.robot), [vec!["arm-1"], vec!["T", "R"], vec!["A"]]);
    assert_eq!(violations(&cell, "HOME\nGET P1\nPUT P1\nHOME\n"), NONE);
    assert!(added.text.contains("# none yet"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn mutated_cells_are_changed_or_refused_without_panic(at in 0..OWN.len(), length in 0..60_usize, put in "[-0-9a-z_.=\"\\[\\]{}#,\n ]{0,6}") {
        let start = OWN.floor_char_boundary(at);
        let end = OWN.floor_char_boundary((start + length).min(OWN.len()));
        let text = format!("{}{put}{}", &OWN[..start], &OWN[end..]);
        let files = &mut no_files;
        if let Ok(cell) = cell::read(&text, files) {
            // A valid cell with one arm gets another one, and loses it without a trace.
            let added = add_entry(&text, &NewEntry::Arm, files).unwrap();
            prop_assert_eq!(cell::read(&added.text, files).unwrap().robot.arms.len(), cell.robot.arms.len() + 1);
            prop_assert_eq!(&remove_entry(&added.text, EntryList::Arm, &added.name).unwrap(), &text);
            let name = &cell.robot.arms[0].name;
            let two = duplicate_entry(&text, EntryList::Arm, name, files).unwrap();
            prop_assert_eq!(cell::read(&two.text, files).unwrap().robot.arms.len(), 2);
            prop_assert_eq!(&remove_entry(&two.text, EntryList::Arm, &two.name).unwrap(), &text);
            let blade = add_entry(&text, &NewEntry::Effector { arm: name.clone() }, files).unwrap();
            prop_assert_eq!(cell::read(&blade.text, files).unwrap().robot.arms[0].effectors.len(), 2);
            prop_assert_eq!(&remove_entry(&blade.text, EntryList::Effector, &blade.name).unwrap(), &text);
        } else {
            let _ = add_entry(&text, &NewEntry::Arm, files);
            let _ = add_entry(&text, &NewEntry::Effector { arm: "arm".to_owned() }, files);
            for (list, name) in [(EntryList::Arm, "arm"), (EntryList::Effector, "E"), (EntryList::Station, "P1")] {
                let _ = duplicate_entry(&text, list, name, files);
                let _ = remove_entry(&text, list, name);
            }
        }
    }
}

#[test]
fn what_cannot_be_changed_is_refused_with_the_reason() {
    let message = |found: Result<EntryAdded, cell::Problem>| found.unwrap_err().to_string();
    let removal = |found: Result<String, cell::Problem>| found.unwrap_err().to_string();
    let files = &mut no_files;
    assert!(message(add_entry(EXAMPLE, &NewEntry::Arm, files)).contains("at most 2"));
    assert!(
        message(duplicate_entry(EXAMPLE, EntryList::Arm, "upper", files)).contains("at most 2")
    );
    assert!(removal(remove_entry(EXAMPLE, EntryList::Arm, "uper")).contains("`upper`"));
    assert!(removal(remove_entry(EXAMPLE, EntryList::Effector, "C")).contains("known: A, B"));
    assert!(
        removal(remove_entry(EXAMPLE, EntryList::Effector, "A")).contains("at least one effector")
    );
    assert!(removal(remove_entry(OWN, EntryList::Arm, "arm")).contains("at least one arm"));
    let mut text = OWN.to_owned();
    for _ in 0..3 {
        text = duplicate(&text, EntryList::Effector, "E").text;
    }
    assert!(message(duplicate_entry(&text, EntryList::Effector, "E", files)).contains("at most 4"));
    let effector = |arm: &str| NewEntry::Effector { arm: arm.to_owned() };
    assert!(message(add_entry(&text, &effector("arm"), files)).contains("at most 4"));
    assert!(message(add_entry(EXAMPLE, &effector("uper"), files)).contains("`upper`"));
    let like = format!("{OWN}[[body]]\nname = \"finger\"\nlike = \"lower-link\"\non = \"world\"\n");
    assert!(
        removal(remove_entry(&add(&like).text, EntryList::Arm, "arm"))
            .contains("\"finger\" takes values")
    );
    for robot in ["robot = \"arms.toml\"\n", "robot = \"gpr\"\n"] {
        for entry in [NewEntry::Arm, effector("arm")] {
            assert!(message(add_entry(robot, &entry, files)).contains("are described in"));
        }
    }
    for robot in ["", "robot = 3\n"] {
        assert!(message(add_entry(robot, &NewEntry::Arm, files)).contains("no robot"));
    }
}

#[test]
fn the_reasons_are_known_in_advance() {
    let edits = |text: &str| ArmEdits::new(text, &read(text).robot);
    let found = edits(EXAMPLE);
    assert!(found.add_arm.unwrap().contains("at most 2") && found.remove_arm.is_none());
    assert_eq!(found.add_effector, [None, None]);
    assert!(found.remove_effector.iter().all(Option::is_some));
    let found = edits(&duplicate(OWN, EntryList::Effector, "E").text);
    assert!(found.add_arm.is_none() && found.remove_arm.unwrap().contains("at least one arm"));
    assert_eq!((found.add_effector, found.remove_effector), (vec![None], vec![None]));
    let file = ArmEdits::new("robot = \"arms.toml\"\n", &read(EXAMPLE).robot);
    for reason in [
        file.add_arm,
        file.remove_arm,
        file.add_effector[1].clone(),
        file.remove_effector[0].clone(),
    ] {
        assert!(reason.unwrap().contains("arms.toml"));
    }
}

#[test]
fn arms_and_stations_change_in_any_order_without_a_trace() {
    // Each step is undone by the last one of the same name.
    let start = remove_entry(EXAMPLE, EntryList::Arm, "lower").unwrap();
    let body = NewEntry::Body { position: nalgebra::Vector3::new(0.9, 0.9, 0.1) };
    let with_body = add_entry(&start, &body, &mut no_files).unwrap();
    let with_arm = duplicate(&with_body.text, EntryList::Arm, "upper");
    let with_station = duplicate(&with_arm.text, EntryList::Station, "LP1");
    assert_eq!(violations(&read(&with_station.text), "HOME\n"), NONE);
    let text = remove_entry(&with_station.text, EntryList::Arm, &with_arm.name).unwrap();
    let text = remove_entry(&text, EntryList::Body, &with_body.name).unwrap();
    let text = remove_entry(&text, EntryList::Station, &with_station.name).unwrap();
    assert_eq!(text, start);
}
