//! Shapes and frames of cell files: boxes with openings, tilts as measured, slots that are displaced.

use jointplay_cell::EntityId;
use jointplay_cell::check::{CheckOptions, Report, check};
use jointplay_cell::geometry::Shape;
use jointplay_cell::program::expand;
use jointplay_cell::trajectory::{TrajectoryOptions, plan_trajectory};
use jointplay_cell::workcell::Cell;
use jointplay_core::spatial::Tilt;
use jointplay_format::cell::{EXAMPLE, read};
use jointplay_format::program;
use nalgebra::Vector3;

fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("there is no {name}"))
}

/// The example with a part replaced.
fn changed(from: &str, to: &str) -> Result<Cell, String> {
    assert!(EXAMPLE.contains(from), "{from:?} is not in the file");
    read(&EXAMPLE.replacen(from, to, 1), &mut no_files).map_err(|errors| errors.to_string())
}

const LP2_TILT: &str = "tilt = { azimuth_deg = 100.0, angle_deg = 0.8 }";

#[test]
fn a_tilt_measured_about_x_and_y_is_the_rotation_vector_in_the_base_plane() {
    let tilt = |keys: &str| {
        let cell = changed(LP2_TILT, &format!("tilt = {{ {keys} }}")).unwrap();
        Tilt::from_normal(&(cell.stations[1].base_from_station.rotation * Vector3::z()))
    };
    // 0.6° about y and 0.3° about x: √(0.6² + 0.3²) toward atan2(−0.3, 0.6).
    let measured = tilt("x_deg = 0.3, y_deg = 0.6");
    assert!((measured.angle.to_degrees() - 0.670_820_393_249_937).abs() < 1e-12, "{measured:?}");
    assert!((measured.azimuth.to_degrees() + 26.565_051_177_077_99).abs() < 1e-9, "{measured:?}");
    // A rotation about +y tilts the normal toward +x.
    let about_y = tilt("y_deg = 0.6");
    assert!(about_y.azimuth.abs() < 1e-12 && (about_y.angle.to_degrees() - 0.6).abs() < 1e-12);
    let refused = |keys: &str, message: &str| {
        let found = changed(LP2_TILT, &format!("tilt = {{ {keys} }}")).unwrap_err();
        assert!(found.contains(message), "{found}");
    };
    refused("x_deg = 0.3, angle_deg = 0.6", "either `azimuth_deg` and `angle_deg`, or `x_deg`");
    refused("x_deg = 89, y_deg = 89", "amount to a tilt by 125.865");
    refused("x_deg = 0.1, z_deg = 0.1", "unknown key `z_deg`");
    refused("x_deg = 1.2, y_deg = 1.0", "tilts 1.562° toward -50.2°");
}

#[test]
fn displaced_slots_stay_level_and_follow_the_step() {
    let pitch = "pitch_mm = 10.0";
    let step = changed(pitch, "pitch_mm = 10.0\nslot_step_mm = [0.2, -0.1]").unwrap();
    let plain = changed(pitch, pitch).unwrap();
    let [step, plain] = [&step, &plain].map(|cell| &cell.stations[0]);
    for slot in 1..=25 {
        let (found, before) = (step.slot_frame(slot), plain.slot_frame(slot));
        assert_eq!(found.rotation, before.rotation);
        let shift = before.inverse_transform_point(&found.translation.vector.into());
        let expected = Vector3::new(0.2e-3, -0.1e-3, 0.0) * (slot as f64 - 1.0);
        assert!((shift.coords - expected).norm() < 1e-15, "{slot}: {shift}");
    }
}

/// The four bodies of the slit wall of the example.
fn slit_wall() -> &'static str {
    let from = EXAMPLE.find("[[body]]\nname = \"slit-below\"").unwrap();
    let to = from + EXAMPLE[from..].find("\n# The wall of the cell").unwrap();
    &EXAMPLE[from..to]
}

/// A box with the same slit, displaced along y.
fn one_wall(shift_mm: f64) -> Cell {
    let wall = format!(
        "[[body]]\nname = \"slit\"\nposition_mm = [560.0, 0.0, 625.0]\nbox = {{ size_mm = [20.0, 500.0, 450.0], openings = [{{ position_mm = [0, {shift_mm}, 0], size_mm = [30.0, 360.0, 50.0] }}] }}\n"
    );
    changed(slit_wall(), &wall).unwrap()
}

fn checked(cell: &Cell) -> Report {
    let steps = program::parse("HOME\nTRANSFER LP1 SLOT 1 TO PM1 WITH A\nHOME\n").unwrap();
    let steps = expand(cell, &steps).unwrap();
    let trajectory = plan_trajectory(cell, steps, &TrajectoryOptions::default()).unwrap();
    check(cell, &trajectory, &CheckOptions::default())
}

#[test]
fn a_wall_with_an_opening_is_checked_as_its_four_boxes() {
    let four = changed(slit_wall(), slit_wall()).unwrap();
    let one = one_wall(0.0);
    assert_eq!(four.bodies.len(), one.bodies.len() + 3);
    let (four_report, one_report) = (checked(&four), checked(&one));
    assert!(one_report.violations.is_empty(), "{:#?}", one_report.violations);
    // The least distance of each body of the robot from the wall is that from the nearest of the four.
    let of_slit = |cell: &Cell, entity: EntityId| cell.entity_name(entity).starts_with("slit");
    let nearest = |cell: &Cell, report: &Report| {
        let with_slit = |pair: &[EntityId; 2]| pair.iter().any(|&entity| of_slit(cell, entity));
        let all = report.distances.iter().filter(|found| with_slit(&found.entities));
        all.map(|found| found.distance).fold(f64::INFINITY, f64::min)
    };
    let (by_four, by_one) = (nearest(&four, &four_report), nearest(&one, &one_report));
    assert!(by_four.is_finite() && (by_four - by_one).abs() < 1e-9, "{by_four} {by_one}");
    let count = one_report.distances.iter().filter(|found| {
        found.entities.iter().any(|&entity| of_slit(&one, entity))
            && found.entities.iter().any(|&entity| one.entity_name(entity) == "blade-A")
    });
    assert!(count.count() <= 1, "the four boxes are one body in the report");
}

#[test]
fn a_displaced_opening_is_a_collision_with_the_one_body() {
    let cell = one_wall(60.0);
    let report = checked(&cell);
    let hits: Vec<String> =
        report.violations.iter().map(|violation| violation.describe(&cell)).collect();
    assert!(hits.iter().any(|hit| hit.contains("slit")), "{hits:#?}");
}

#[test]
fn invalid_openings_are_reported_with_their_place() {
    let wall = "box = { size_mm = [600.0, 20.0, 1000.0] }";
    let refused = |openings: &str, message: &str| {
        let text = format!("box = {{ size_mm = [600.0, 20.0, 1000.0], openings = {openings} }}");
        let found = changed(wall, &text).unwrap_err();
        assert!(found.contains(message), "{found}");
    };
    refused(
        "[{ size_mm = [1, 1, 1] }, { position_mm = [0, 900, 0], size_mm = [1, 1, 1] }]",
        "opening 2 has no common interior with the box",
    );
    refused("[{ size_mm = [600, 20, 1000] }]", "remove all of it");
    refused("[{ size_mm = [1, 1] }]", "`size_mm` has 2 entries, but needs 3");
    refused("[{ size = [1, 1, 1] }]", "did you mean `size_mm`?");
    refused("3", "has to be a list");
    let safe = "rule = \"safe\"\nposition_mm = [0.0, 0.0, 600.0]\ncylinder = { radius_mm = 60.0, height_mm = 700.0 }";
    let opened = "rule = \"safe\"\nposition_mm = [0.0, 0.0, 600.0]\nbox = { size_mm = [90, 90, 700], openings = [{ size_mm = [1, 1, 1] }] }";
    let found = changed(safe, opened).unwrap_err();
    assert!(found.contains("a safe zone has no openings"), "{found}");
}

/// A binary glTF file: the node `frame`, moved by 1 m along x and turned by 90° about y, with the children `door`, twice as large, and `lamp`, mirrored; both show a tetrahedron.
fn glb(children: [&str; 2], extra: &str) -> Vec<u8> {
    let points: [[f32; 3]; 4] = [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
    let triangles: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut binary: Vec<u8> = points.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    binary.extend(triangles.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    let [door, lamp] = children;
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let mut json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [
            {{"name": "frame", "translation": [1, 0, 0], "rotation": [0, {half}, 0, {half}], "children": [1, 2]}},
            {{"name": "{door}", "scale": [2, 2, 2], "mesh": 0}},
            {{"name": "{lamp}", "matrix": [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1], "mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [0.1, 0.1, 0.1]}},
            {{"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}}],
        "bufferViews": [
            {{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 24}}],
        "buffers": [{{"byteLength": 72}}]{extra}}}"#
    );
    while json.len() % 4 != 0 {
        json.push(' ');
    }
    let mut bytes = b"glTF".to_vec();
    let length = |bytes: usize| u32::try_from(bytes).unwrap().to_le_bytes();
    bytes.extend(length(2));
    bytes.extend(length(12 + 8 + json.len() + 8 + binary.len()));
    for (kind, chunk) in [(b"JSON", json.as_bytes()), (b"BIN\0", &binary)] {
        bytes.extend(length(chunk.len()));
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// The wall of the example with the shape of a file.
fn wall_of(file: &str, keys: &str, bytes: &[u8]) -> Result<Shape, String> {
    let wall = "box = { size_mm = [600.0, 20.0, 1000.0] }";
    let mesh = format!("mesh = {{ file = \"{file}\"{keys} }}");
    let text = EXAMPLE.replacen(wall, &mesh, 1);
    let cell = read(&text, &mut |_| Ok(bytes.to_vec())).map_err(|errors| errors.to_string())?;
    Ok(cell.bodies.into_iter().find(|body| body.name == "wall").unwrap().shape)
}

/// Vertices, and the volume within the triangles.
fn measured(shape: Shape) -> (Vec<Vector3<f64>>, f64) {
    let Shape::Mesh { vertices, triangles } = shape else { panic!("{shape:?}") };
    let vertices: Vec<Vector3<f64>> = vertices.into_iter().map(Vector3::from).collect();
    let at = |k: u32| vertices[k as usize];
    let volumes = triangles.iter().map(|t| at(t[0]).dot(&at(t[1]).cross(&at(t[2]))) / 6.0);
    let volume = volumes.sum();
    (vertices, volume)
}

#[test]
fn nodes_of_a_binary_gltf_file_are_bodies_with_z_up() {
    let file = glb(["door", "lamp"], "");
    let (door, volume) = measured(wall_of("tool.glb", ", node = \"door\"", &file).unwrap());
    // Scaled by 2, turned x → −z about y, moved by 1 along x; then y up becomes z up: (x, y, z) → (x, −z, y).
    let expected = [[1.0, 0.0, 0.0], [1.0, 0.2, 0.0], [1.0, 0.0, 0.2], [1.2, 0.0, 0.0]];
    for (found, expected) in door.iter().zip(expected.map(Vector3::from)) {
        assert!((found - expected).norm() < 1e-7, "{found} {expected}");
    }
    assert!((volume - 8.0 * 1e-3 / 6.0).abs() < 1e-9, "{volume}");
    // The mirrored node faces outward, too; the whole scene and the common parent have both.
    let (lamp, volume) = measured(wall_of("tool.glb", ", node = \"lamp\"", &file).unwrap());
    assert!((volume - 1e-3 / 6.0).abs() < 1e-9 && (lamp[0].z - 5.0).abs() < 1e-6, "{volume}");
    for keys in ["", ", node = \"frame\""] {
        let (all, volume) = measured(wall_of("tool.glb", keys, &file).unwrap());
        assert!(all.len() == 8 && (volume - 9.0 * 1e-3 / 6.0).abs() < 1e-9);
    }
    assert!(matches!(wall_of("tool.glb", ", convex = true", &file), Ok(Shape::Convex { .. })));
}

#[test]
fn unusable_meshes_are_refused_with_the_reason() {
    let file = glb(["door", "lamp"], "");
    let refused = |name: &str, keys: &str, bytes: &[u8], message: &str| {
        let found = wall_of(name, keys, bytes).unwrap_err();
        assert!(found.contains(message), "{found}");
    };
    refused(
        "t.glb",
        ", node = \"dor\"",
        &file,
        "no node \"dor\" (did you mean `door`?); known: frame",
    );
    refused("t.glb", ", node = \"d\"", &glb(["d", "d"], ""), "it has 2 nodes \"d\"");
    refused("t.glb", ", unit = \"m\"", &file, "is in metres: remove `unit`");
    refused("t.stl", ", node = \"door\"", &file, "has nodes: remove `node`");
    let draco = r#", "extensionsRequired": ["KHR_draco_mesh_compression"]"#;
    refused("t.glb", "", &glb(["a", "b"], draco), "export it without compression");
    refused("t.step", "", b"ISO-10303-21;", "files that end in .step are not read");
    refused("t.gltf", "", b"{}", "save it as binary glTF");
    refused("t.ply", "", b"ply", "neither in .stl, .obj nor in .glb");
    refused("t.glb", "", b"{}", "it does not start with `glTF`");
    for cut in (0..file.len()).step_by(7) {
        assert!(wall_of("t.glb", "", &file[..cut]).is_err());
        let mut damaged = file.clone();
        damaged[cut] = damaged[cut].wrapping_add(1);
        let _ = wall_of("t.glb", "", &damaged);
    }
}
