//! Controller text by dialects: formats, codes, checksums and line numbers.

use jointplay_cell::program::Path;
use jointplay_cell::trajectory::Trajectory;
use jointplay_cell::workcell::Cell;
use jointplay_interop::export::dialect::Dialect;
use jointplay_interop::export::{Error, MotionExport};

use crate::planned::{example, planned};

const PROGRAM: &str = "HOME\nTRANSFER LP1 SLOT 3 TO LP2 SLOT 12 WITH B\nHOME\n";

/// The keys that each dialect needs, with hand-offs only.
const HEAD: &str = r#"
name = "mine"
about = "hand-offs"
extension = "cmd"
length = "mm"
angle = "deg"
decimals = 3
time_decimals = 3
axis = "{value:+09.3f}"
between = ","
comment = "; {text}"
axes = []
line = []
still = []
"#;

fn example_motion() -> (Cell, Trajectory) {
    let cell = example();
    let motion = planned(&cell, PROGRAM);
    (cell, motion)
}

fn write(rest: &str) -> Result<String, Error> {
    let (cell, motion) = example_motion();
    let dialect = Dialect::parse(&format!("{HEAD}{rest}")).unwrap();
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: PROGRAM, violation_notes: &[] };
    dialect.write(&motion_export, 10.0)
}

const CODES: &str = r#"
[station_codes]
LP1 = "P1"
LP2 = "P2"
[effector_codes]
A = 1
B = 2
"#;

/// XOR of the bytes of a text.
fn xor(text: &str) -> u8 {
    text.bytes().fold(0, |value, byte| value ^ byte)
}

#[test]
fn hand_offs_have_formatted_slots_and_codes_of_the_controller() {
    let rest = r#"
taken = ["GET,{station_code},S{slot:02},{effector_code:03}"]
left = ["PUT,{station_code},S{slot - 1:02},{effector_code:x}"]
"#;
    assert_eq!(write(&format!("{rest}{CODES}")).unwrap(), "GET,P1,S03,002\nPUT,P2,S11,2\n");
}

#[test]
fn lines_have_numbers_and_checksums_and_the_file_has_one() {
    let rest = r##"
begin = ["; by jointplay", "M1 {positions}"]
taken = ["GET {station} {slot}"]
left = ["PUT {station} {slot}"]
[output]
covered = "N{10 * number:04} {text}"
line = "{covered}*{checksum:02X}"
checksum = "xor"
except = [";", "#"]
line_end = "crlf"
file_checksum = "crc-32"
last = ["; {lines} lines", "#{checksum:08x}"]
"##;
    let text = write(rest).unwrap();
    assert!(text.ends_with("\r\n"));
    let lines: Vec<&str> = text.split_terminator("\r\n").collect();
    assert_eq!((lines.len(), lines[0], lines[4]), (6, "; by jointplay", "; 4 lines"));
    assert!(lines[1].starts_with("N0010 M1 +0500.000,"), "{text}");
    assert!(lines[2].starts_with("N0020 GET LP1 3*"), "{text}");
    for line in &lines[1..4] {
        let (covered, checksum) = line.rsplit_once('*').unwrap();
        assert_eq!(u8::from_str_radix(checksum, 16).unwrap(), xor(covered), "{line}");
    }
    // All bytes before the last lines; the value of an own bitwise CRC-32.
    let body = &text[..text.find("; 4 lines").unwrap()];
    let crc = body.bytes().fold(u32::MAX, |crc, byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            if crc & 1 == 1 { (crc >> 1) ^ 0xEDB8_8320 } else { crc >> 1 }
        })
    });
    assert_eq!(lines[5], format!("#{:08x}", !crc));
}

#[test]
fn a_sentence_has_its_checksum_without_its_frame() {
    let rest = r#"
taken = ["GET,{station},{slot}"]
[output]
line = "${covered}*{checksum:02X}"
checksum = "xor"
"#;
    assert_eq!(write(rest).unwrap(), format!("$GET,LP1,3*{:02X}\n", xor("GET,LP1,3")));
}

#[test]
fn stations_without_a_code_are_all_reported() {
    let rest =
        "taken = [\"{station_code}\"]\nleft = [\"{station_code}\"]\n[station_codes]\nLP3 = 1\n";
    let Err(Error::Dialect(errors)) = write(rest) else { panic!("no error") };
    let shown = errors.with_excerpt("mine.toml");
    assert_eq!(errors.len(), 2, "{shown}");
    for name in ["LP1", "LP2"] {
        let message = format!("`[station_codes]` has no code for \"{name}\" (did you mean `LP3`?)");
        assert!(shown.contains(&message), "{shown}");
    }
    assert!(shown.contains("mine.toml:17:1: "), "{shown}");
    // Codes that no template writes are not needed.
    assert!(write("taken = [\"{station}\"]\n[station_codes]\nLP3 = 1\n").is_ok());
}

#[test]
fn divisions_by_zero_are_reported_with_place_and_values() {
    let Err(Error::Dialect(errors)) = write("taken = [\"GET {1 / (slot - 3)}\"]\n") else {
        panic!("no error")
    };
    let shown = errors.with_excerpt("mine.toml");
    assert!(
        shown.starts_with("mine.toml:15:16: `1 / (slot - 3)` is infinite for slot = 3"),
        "{shown}"
    );
}

/// Numbers of a text between spaces and commas.
fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
}

#[test]
fn hand_offs_have_the_poses_of_their_slots() {
    let rest = "taken = [\"{x}, {y}, {z}, {heading}, {tilt:.6f}\"]\nleft = [\"{x}, {y}, {z}, {heading}\"]\n";
    let text = write(rest).unwrap();
    let lines: Vec<Vec<f64>> = text.lines().map(numbers).collect();
    // Positions of LP1 and LP2 in the cell file, with 20 mm and 110 mm to slots 3 and 12; the effector points along y of the station.
    let slots = [[-495.0, 495.0, 520.0, 135.0], [-495.0, -495.0, 610.0, -135.0]];
    // LP2 tilts by 0.8°, by which slot 12 is displaced by 1.5 mm.
    for ((line, slot), tolerance) in lines.iter().zip(slots).zip([0.1, 1.7]) {
        for (found, expected) in line.iter().zip(slot) {
            assert!((found - expected).abs() < tolerance, "{text}");
        }
    }
    assert_eq!(lines.len(), 2, "{text}");
    // In other units.
    let in_inches =
        HEAD.replace("length = \"mm\"", "length = \"in\"").replace("\"deg\"", "\"rad\"");
    let dialect = Dialect::parse(&format!("{in_inches}{rest}")).unwrap();
    let (cell, motion) = example_motion();
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: PROGRAM, violation_notes: &[] };
    let converted = dialect.write(&motion_export, 10.0).unwrap();
    for (line, converted) in lines.iter().zip(converted.lines().map(numbers)) {
        for (k, (found, expected)) in converted.iter().zip(line).enumerate() {
            let expected = if k < 3 { expected / 25.4 } else { expected.to_radians() };
            assert!((found - expected).abs() < 6e-4, "{found} {expected}");
        }
    }
}

#[test]
fn poses_at_ends_of_lines_and_at_even_times_are_those_of_the_wafers() {
    let (cell, motion) = example_motion();
    let motion_export =
        MotionExport { cell: &cell, motion: &motion, program: PROGRAM, violation_notes: &[] };
    let write = |head: String| Dialect::parse(&head).unwrap().write(&motion_export, 10.0).unwrap();
    let effectors: Vec<_> = cell.robot.effectors().collect();
    let expected = |id, positions: &[f64], loaded: &[_]| {
        let pose = cell.wafer_pose(id, positions, loaded.contains(&id)).unwrap();
        pose.translation.vector * 1e3
    };
    let agrees = |found: &[f64], expected: nalgebra::Vector3<f64>| {
        found.iter().zip(expected.iter()).all(|(found, expected)| (found - expected).abs() < 6e-4)
    };

    let of_lines = HEAD.replace("line = []", "line = [\"{effector} {x} {y} {z}\"]");
    let text = write(of_lines);

    let lines = motion.steps.iter().filter_map(|step| match step.path {
        Path::Line(id) if step.from != step.to => Some((id, step)),
        _ => None,
    });
    let mut rows = text.lines();
    let mut count = 0;
    for (id, step) in lines {
        let row = rows.next().unwrap();
        let center = expected(id, &step.to, &step.loaded);
        assert!(agrees(&numbers(row), center), "{row} {center}");
        count += 1;
    }
    assert!(count > 6 && rows.next().is_none(), "{count}");

    let of_points = HEAD.replace(
        "axes = []\nline = []\nstill = []",
        "point = [\"{poses}\"]\npose = \"{x} {y} {z}\"",
    );
    let text = write(of_points);

    for (row, sample) in text.lines().zip(motion.samples(10.0)) {
        let loaded = &motion.steps[sample.step].loaded;
        for (part, &id) in row.split(',').zip(&effectors) {
            let center = expected(id, &sample.positions, loaded);
            assert!(agrees(&numbers(part), center), "{row} {center}");
        }
    }
    assert_eq!(text.lines().count(), motion.samples(10.0).count());
}

#[test]
fn poses_need_their_template_and_axes_have_no_pose() {
    for (rest, message) in [
        ("begin = [\"{poses}\"]", "needs the key `pose`"),
        ("begin = [\"{x}\"]", "`{x}` is not a name of this template"),
        ("pose = \"{value}\"", "effector"),
        ("pose = \"{effector_code}\"", "needs the table `[effector_codes]`"),
    ] {
        let errors = Dialect::parse(&format!("{HEAD}{rest}\n")).unwrap_err();
        let shown = errors.with_excerpt("mine.toml");
        assert!(shown.contains(message), "{rest}: {shown}");
    }
    let with_axes = HEAD.replace("axes = []", "axes = [\"{x}\"]");
    assert!(Dialect::parse(&with_axes).is_err());
    let rest = "pose = \"{effector_code}\"\nbegin = [\"{poses}\"]\n[effector_codes]\nA = 1\n";
    let Err(Error::Dialect(errors)) = write(rest) else { panic!("no error") };
    assert!(errors.with_excerpt("mine.toml").contains("has no code for \"B\""));
}
