//! Shapes from files: STL, OBJ and binary glTF.

use std::io::Cursor;

use jointplay_cell::CellError;
use jointplay_cell::geometry::Shape;

use super::files::{Files, read_named_file};
use super::glb;
use super::problem::Fault;
use super::surface::{MAX_TRIANGLES, Mesh, too_many};
use super::tree::Table;
use crate::units::m_from_mm;

/// Larger files of shapes are refused unread.
pub const MAX_MESH_BYTES: usize = 64 << 20;

/// Bytes of a binary STL file before its triangles, and for each of them.
const STL_HEAD: usize = 84;
const STL_TRIANGLE: usize = 50;

/// Endings of files of surfaces without triangles, which no reader here reads.
const CAD_ENDINGS: [&str; 6] = ["step", "stp", "iges", "igs", "sldprt", "x_t"];

/// The shape of `{ file = …, unit = …, convex = …, node = … }`.
pub(super) fn shape(table: &Table, files: &mut Files) -> Option<Shape> {
    let reader = table.reader;
    let file = table.needed("file");
    let unit = table
        .entry("unit")
        .map_or(Some(true), |unit| unit.word(reader, "unit", &[("mm", true), ("m", false)]));
    let convex = table.entry("convex").map_or(Some(false), |convex| convex.flag(reader));
    let node = table.entry("node").map(|node| node.line(reader));
    let file = file?;
    let name = file.line(reader)?;
    let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    let is_glb = ending.as_deref() == Some("glb");
    if node.is_some() && !is_glb {
        let why = "only a binary glTF file (.glb) has nodes: remove `node`";
        table.report_at("node", Fault::Unfit(why.to_owned()));
        return None;
    }
    if is_glb && table.entry("unit").is_some() {
        let why = "a binary glTF file (.glb) is in metres: remove `unit`";
        table.report_at("unit", Fault::Unfit(why.to_owned()));
        return None;
    }
    let node = match node {
        Some(node) => Some(node?),
        None => None,
    };
    let (is_mm, convex) = (unit? && !is_glb, convex?);
    if let Some(ending) = ending.as_deref().filter(|ending| CAD_ENDINGS.contains(ending)) {
        // Also where the file does not exist: another file is needed.
        let why = format!(
            "files that end in .{ending} are not read, because they have no triangles: convert it to .glb, .stl or .obj, with FreeCAD (File > Export) or the CAD program, and name that file"
        );
        file.report(reader, Fault::File { name: name.to_owned(), why });
        return None;
    }
    let mesh = read_named_file(name, files)
        .and_then(|bytes| parse(ending.as_deref().unwrap_or_default(), node, &bytes));
    let mesh =
        mesh.map_err(|why| file.report(reader, Fault::File { name: name.to_owned(), why })).ok()?;
    let length = |value: f64| if is_mm { m_from_mm(value) } else { value };
    let vertices: Vec<_> = mesh.vertices.iter().map(|vertex| vertex.map(length)).collect();
    if !convex {
        return Some(Shape::Mesh { vertices, triangles: mesh.triangles });
    }
    let hull = Shape::Convex { points: vertices };
    if let Err(CellError::FlatHull { .. }) = hull.validate() {
        let why = "its points lie in one plane, and make no convex body".to_owned();
        file.report(reader, Fault::File { name: name.to_owned(), why });
        return None;
    }
    Some(hull)
}

fn parse(ending: &str, node: Option<&str>, bytes: &[u8]) -> Result<Mesh, String> {
    if bytes.len() > MAX_MESH_BYTES {
        return Err(format!(
            "it has {} bytes, but at most {MAX_MESH_BYTES} are allowed; simplify the shape",
            bytes.len()
        ));
    }
    let mesh = match ending {
        "stl" => stl(bytes)?,
        "obj" => obj(bytes)?,
        "glb" => glb::surface(bytes, node)?,
        "gltf" => return Err("save it as binary glTF, which ends in .glb".to_owned()),
        _ => return Err("its name ends neither in .stl, .obj nor in .glb".to_owned()),
    };
    if mesh.triangles.is_empty() {
        return Err("it has no triangles".to_owned());
    }
    if mesh.vertices.iter().flatten().any(|value| !value.is_finite()) {
        return Err("it has coordinates that are not finite numbers".to_owned());
    }
    if mesh.triangles.iter().flatten().any(|&index| index as usize >= mesh.vertices.len()) {
        return Err("it names corners that it does not have".to_owned());
    }
    Ok(mesh)
}

fn stl(bytes: &[u8]) -> Result<Mesh, String> {
    let mut bytes = bytes.to_vec();
    // Many programs begin the free text of a binary file with `solid`, the mark of a text file.
    let count = bytes.get(80..STL_HEAD).and_then(|count| count.try_into().ok());
    let count = count.map_or(usize::MAX, |count| u32::from_le_bytes(count) as usize);
    let is_binary = count
        .checked_mul(STL_TRIANGLE)
        .and_then(|length| length.checked_add(STL_HEAD))
        .is_some_and(|length| length == bytes.len());
    if is_binary {
        bytes[0] = b' ';
    }
    let length = bytes.len();
    let mut cursor = Cursor::new(bytes);
    let broken = |error: std::io::Error| match error.kind() {
        std::io::ErrorKind::UnexpectedEof => {
            format!(
                "it is no STL file, or a broken one: its {length} bytes end before its triangles do"
            )
        }
        _ => format!("it is no STL file, or a broken one: {error}"),
    };
    let found = stl_io::create_stl_reader(&mut cursor).map_err(broken)?;
    let mut corners = Vec::new();
    let mut triangles = Vec::new();
    for triangle in found {
        if triangles.len() == MAX_TRIANGLES {
            return Err(too_many());
        }
        let first = corners.len() as u32;
        corners.extend(triangle.map_err(broken)?.vertices.map(|vertex| vertex.0));
        triangles.push([first, first + 1, first + 2]);
    }
    Ok(joined(corners, triangles))
}

/// The surface with equal corners merged.
fn joined(corners: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Mesh {
    let key = |corner: &[f32; 3]| corner.map(|value| (value + 0.0).to_bits());
    let mut indices = std::collections::BTreeMap::new();
    let mut vertices = Vec::new();
    let index: Vec<u32> = corners
        .iter()
        .map(|corner| {
            *indices.entry(key(corner)).or_insert_with(|| {
                vertices.push(corner.map(f64::from));
                vertices.len() as u32 - 1
            })
        })
        .collect();
    let triangles = triangles.into_iter().map(|corners| corners.map(|k| index[k as usize]));
    Mesh { vertices, triangles: triangles.collect() }
}

fn obj(bytes: &[u8]) -> Result<Mesh, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        single_index: true,
        ignore_points: true,
        ignore_lines: true,
    };
    // Materials do not affect collisions, and would need another file.
    let none = |_: &std::path::Path| Ok((Vec::new(), Default::default()));
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, none)
        .map_err(|error| format!("it is no OBJ file, or a broken one: {error}"))?;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for model in models {
        let first = vertices.len() as u32;
        let positions = model.mesh.positions.chunks_exact(3);
        vertices.extend(positions.map(|p| [p[0], p[1], p[2]].map(f64::from)));
        let corners = model.mesh.indices.chunks_exact(3);
        triangles.extend(corners.map(|c| [first + c[0], first + c[1], first + c[2]]));
        if triangles.len() > MAX_TRIANGLES {
            return Err(too_many());
        }
    }
    Ok(Mesh { vertices, triangles })
}
