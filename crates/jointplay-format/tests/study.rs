//! Study files: what is read, what is refused and where.

use jointplay_format::study::{Error, included, parse};

use crate::example_study::{STUDY, study};

/// Replaces a part of the study and checks the error message.
#[track_caller]
fn refuse(from: &str, to: &str, line: usize, message: &str) {
    assert!(STUDY.contains(from), "{from:?} is not in the study");
    let Err(errors) = parse(&STUDY.replacen(from, to, 1), &mut included) else {
        panic!("{to:?} is accepted");
    };
    let is_reported =
        |error: &Error| error.place.line == line && error.to_string().contains(message);
    assert!(errors.iter().any(is_reported), "{}", errors.with_excerpt("s.toml"));
}

#[test]
fn a_study_defines_samples_and_columns() {
    let file = study(STUDY);
    assert_eq!((file.name.as_str(), file.mechanism.as_str()), ("a study", "GPR of the paper"));
    assert_eq!(file.plan.samples(), Ok(1000));
    let names: Vec<&str> = file.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names[..6], ["sample", "draw", "azimuth_deg", "tilt_deg", "height_mm", "q1_mm"]);
    assert_eq!(names[6..8], ["planar_center_shift_um", "planar_u1_mm"]);
    assert_eq!(names.last(), Some(&"polar_status"));
    let least =
        "kind = \"study\"\nquantities = [\"torsion_mrad\"]\n[pose]\ntilt_x_deg = 1\ntilt_y_deg = 0";
    let least = study(least);
    assert_eq!(least.plan.samples(), Ok(1));
    let names: Vec<&str> = least.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(
        names,
        ["sample", "tilt_x_deg", "tilt_y_deg", "height_mm", "planar_torsion_mrad", "planar_status"]
    );
}

#[test]
fn the_example_of_the_reference_is_a_valid_study() {
    let page = include_str!("../../../docs/reference/study-files.md");
    let (_, rest) = page.split_once("```toml\n").unwrap();
    let file = study(rest.split_once("```").unwrap().0);
    assert_eq!(file.plan.samples(), Ok(30_000));
    // And every quantity of its table is one, with the unit that it is shown with.
    let (_, rest) = page.split_once("| quantity | meaning |").unwrap();
    let cells = rest.lines().skip(2).take_while(|line| line.starts_with('|'));
    let mut count = 0;
    for cell in cells.filter_map(|line| line.split('|').nth(1)) {
        for name in cell.split('`').skip(1).step_by(2) {
            let models = "[\"radial\", \"polar\", \"offset\", \"planar\"]";
            study(&format!(
                "kind = \"study\"\nvirtualizations = {models}\nquantities = [\"{name}\"]\n[pose]\nazimuth_deg = 0\ntilt_deg = 0"
            ));
            count += 1;
        }
    }
    assert!(count > 30, "{count}");
}

#[test]
fn invalid_studies_are_rejected_with_the_place_of_the_error() {
    refuse("kind = \"study\"", "kind = \"gpr\"", 1, "known: study");
    refuse("\"a study\"", "\"a\\u001b\"", 2, "control characters");
    refuse("\"gpr\"", "\"delta\"", 3, "of the kind \"mechanism\"");
    let mut broken = |_: &str| Ok(b"kind = \"gpr\"\nlimb = 3".to_vec());
    let error = parse(STUDY, &mut broken).err().unwrap();
    assert!(error.to_string().contains("the robot \"gpr\" is invalid: line 1:"), "{error}");
    refuse("\"gpr\"", "\"gprs\"", 3, "not in the catalogue");
    refuse("\"planar\",", "\"planer\",", 4, "did you mean `planar`?");
    refuse("[\"planar\", \"polar\"]", "[]", 4, "`virtualizations` is empty");
    refuse("\"polar\"]", "\"planar\"]", 4, "`virtualizations` has \"planar\" twice");
    refuse("\"newton\"", "\"newtown\"", 5, "did you mean `newton`?");
    refuse("12.5", "-1", 6, "the metric has to be");
    refuse("12.5", "\"rad\"", 6, "the metric has to be");
    refuse("samples = 100", "samples = 0", 7, "`samples` is 0, but has to be at least 1");
    refuse("= 100", "= 9000000000000000000", 7, "more samples than can be counted");
    refuse("samples = 100\n", "", 11, "need `samples`");
    refuse("seed = 9", "seed = -9", 8, "`seed` is -9, but has to be at least 0");
    refuse("seed = 9", "sead = 9", 8, "did you mean `seed`?");
    refuse("center_shift_um", "centre_shift_um", 9, "did you mean `center_shift_mm`?");
    let units = "needs a unit: center_shift_mm, center_shift_um, center_shift_nm, center_shift_m";
    refuse("center_shift_um", "center_shift", 9, units);
    refuse("center_shift_um", "rods", 9, "needs a unit: rods_mm");
    refuse("center_shift_um", "u1_deg", 9, "`u1` needs a unit: u1_mm");
    refuse("center_shift_um", "l4_mm", 9, "is not known");
    refuse("center_shift_um", "normal_x_mm", 9, "is not known");
    refuse("center_shift_um", "u1_mm", 9, "`quantities` has \"virtual_joints\" twice");
    refuse("[0, 360]", "[360, 0]", 12, "invalid range, uniform from 360 to 0");
    refuse("[0, 360]", "[0, 360, 1]", 12, "has to be a number, a range");
    refuse("[0, 360]", "[0, nan]", 12, "`azimuth_deg` is not a number");
    refuse("uniform", "unifrom", 12, "did you mean `uniform`?");
    refuse("{ uniform = [0, 360] }", "true", 12, "has to be a number, a range");
    refuse("{ uniform = [0, 360] }", "[]", 12, "`azimuth_deg` is empty");
    refuse("{ uniform = [0, 360] }", "[1, \"2\"]", 12, "has to be a number, a range");
    refuse("[0, 360] }", "[0, 1], normal = [0, 1] }", 12, "has to be a number, a range");
    refuse("\"-1:1:0.5\"", "\"-1:1:0.3\"", 13, "`tilt_deg`: steps of 0.3 from -1 miss 1");
    refuse("\"-1:1:0.5\"", "90", 13, "`tilt_deg` is 90, but has to be from -89.999");
    refuse("tilt_deg = \"-1:1:0.5\"\n", "", 11, "found: azimuth_deg");
    refuse("tilt_deg", "tilt_x_deg", 11, "found: azimuth_deg, tilt_x_deg");
    refuse("[480.1, 500]", "1e9", 14, "`height_mm` is 1000000000, but has to be from");
    refuse("[0, 0.01]", "[0, 0]", 17, "a standard deviation of 0 is not positive");
    refuse("{ normal = [0, 0.01] }", "0.1", 17, "`base_x_mm` has to be drawn");
    refuse("base_x_mm = { normal = [0, 0.01] }", "", 16, "no tolerances here");
    refuse("base_x_mm", "rods_from = \"guess\"\nbase_x_mm", 17, "known: nominal, as-built");
    let still = STUDY.replace("{ uniform = [0, 360] }", "5");
    let (still, _) = still.split_once("[tolerances]").unwrap();
    let error = parse(still, &mut included).err().unwrap();
    assert!(
        error.to_string().contains("line 7:") && error.to_string().contains("nothing is random"),
        "{error}"
    );
}

#[test]
fn differences_of_two_studies_name_their_key() {
    let begun = study(STUDY);
    let differences =
        |from: &str, to: &str| begun.differences(&study(&STUDY.replacen(from, to, 1)));
    assert_eq!(differences("a study", "another name"), [""; 0]);
    assert_eq!(differences("seed = 9", "# a comment\nseed = 9"), [""; 0]);
    assert_eq!(
        differences("seed = 9", "seed = 8"),
        ["seed: 9 in the study that was started, 8 in this file"]
    );
    assert_eq!(
        differences("newton", "least-norm"),
        ["solver: newton in the study that was started, least-norm in this file"]
    );
    for (from, to, started, found) in [
        ("480.1", "480.2", "height_mm: [480.1, 500]", "[480.2, 500]"),
        ("360", "180", "azimuth_deg: uniform [0, 360]", "uniform [0, 180]"),
        ("0.01", "0.02", "base_x_mm: normal [0, 0.01]", "normal [0, 0.02]"),
        ("base_x_mm =", "base_y_mm =", "base_x_mm: normal [0, 0.01]", "none"),
        ("12.5", "12", "metric: 12.5 mm", "12 mm"),
        ("metric = 12.5", "metric = \"radius\"", "metric: 12.5 mm", "radius"),
    ] {
        let expected = format!("{started} in the study that was started, {found} in this file");
        assert_eq!(differences(from, to)[0], expected);
    }
    // The same to twelve digits.
    assert_eq!(differences("480.1", "480.1000000000001"), ["height_mm: not the same"]);
    let columns = differences("center_shift_um", "center_shift_mm");
    assert!(columns.len() == 1 && columns[0].starts_with("columns: "), "{columns:?}");
}

/// Words of studies, valid and invalid.
const WORDS: [&str; 36] = [
    "kind",
    "=",
    "\"study\"",
    "\n",
    "quantities",
    "[",
    "]",
    "{",
    "}",
    "\"q1_mm\"",
    "virtualizations",
    "[pose]",
    "azimuth_deg",
    "tilt_deg",
    "height_mm",
    "0",
    "1e300",
    "nan",
    "inf",
    "-1",
    "uniform",
    "normal",
    ",",
    "\"-1:1:1e-9\"",
    "[tolerances]",
    "socket_radius_mm",
    "samples",
    "seed",
    "9223372036854775807",
    "#",
    "é",
    "metric",
    "\"planar\"",
    "\"virtual_joints\"",
    "\"_mm\"",
    "\"\"",
];

proptest::proptest! {
    #[test]
    fn any_text_is_read_without_panic(
        words in proptest::collection::vec(proptest::sample::select(&WORDS[..]), 0..60),
        from in 0..STUDY.len(),
        to in 0..STUDY.len(),
        noise in "\\PC{0,12}",
    ) {
        let piece = STUDY.get(from..to).unwrap_or_default();
        let texts = [
            words.join(" "),
            format!("{piece}{noise}"),
            STUDY.replacen(piece, &noise, 1),
            STUDY.replacen(piece, &words.concat(), 1),
        ];
        for text in texts {
            if let Err(error) = parse(&text, &mut included) {
                let _ = error.with_excerpt("s.toml");
            }
        }
    }
}
