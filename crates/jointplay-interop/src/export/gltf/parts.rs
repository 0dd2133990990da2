//! Visible parts: bodies of the cell, and simple shapes for parts without bodies.

use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Mesh, Node};
use jointplay_cell::geometry::Shape;
use jointplay_cell::station::Station;
use jointplay_cell::workcell::{Body, Cell, ParentFrame, ZoneRule};
use jointplay_core::spatial::Pose;
use serde_json::json;

use super::document::Document;
use super::material::Material;
use super::numbers::{extras, single};
use crate::export::scene::Part;

/// Radius of the shape of a rod or a link without a body (m).
const BAR: f64 = 0.008;
/// Half the thickness of the shape of a platform without a body (m).
const PLATE: f64 = 0.004;
/// Half the thickness of what marks a slot, and how much wider than a wafer it is (m).
const SLOT: [f64; 2] = [0.000_2, 0.004];

/// Meshes that are used more than once.
#[derive(Default)]
pub(super) struct Parts {
    wafer: Option<Index<Mesh>>,
    slot: Option<Index<Mesh>>,
}

impl Parts {
    /// Nodes of the part that moves with a track.
    pub(super) fn of_track(
        &mut self,
        document: &mut Document,
        cell: &Cell,
        part: Part,
    ) -> Vec<Index<Node>> {
        let robot = &cell.robot;
        let parent = match part {
            Part::Wafer(_) => {
                let made = *self.wafer.get_or_insert_with(|| {
                    let half_height = 0.5 * cell.wafer.thickness;
                    let shape = Shape::Cylinder { radius: 0.5 * cell.wafer.diameter, half_height };
                    let up = Pose::translation(0.0, 0.0, half_height);
                    document
                        .mesh_at("wafer", &shape, &up, Material::Wafer)
                        .expect("a wafer is a body")
                });
                return vec![document.node("wafer", made, &Pose::identity())];
            }
            Part::Rod(k) => {
                let low = robot.axes[k].min.max(2.0 * BAR);
                let shape = Shape::Capsule { ends: [[0.0, 0.0, -low], [0.0; 3]], radius: BAR };
                return document.show("rod", &shape, &Pose::identity(), Material::Robot);
            }
            Part::Platform => ParentFrame::Platform,
            Part::Link { arm, link } => ParentFrame::Link { arm, link },
        };
        let material = match part {
            Part::Link { arm: 0, .. } => Material::Arm,
            Part::Link { .. } => Material::OtherArm,
            _ => Material::Robot,
        };
        let bodies = bodies(document, cell, parent, material);
        if !bodies.is_empty() {
            return bodies;
        }
        match part {
            Part::Link { arm, link } => {
                let arm = &robot.arms[arm];
                let last = link + 1 == arm.joints.len();
                let ends: Vec<[f64; 3]> = if last {
                    arm.effectors.iter().map(|effector| effector.wafer_center).collect()
                } else {
                    vec![[arm.joints[link].length, arm.joints[link].offset, 0.0]]
                };
                let shown = ends.into_iter().flat_map(|end| {
                    let shape = Shape::Capsule { ends: [[0.0; 3], end], radius: BAR };
                    document.show("link", &shape, &Pose::identity(), material)
                });
                shown.collect()
            }
            _ => {
                let radius = robot.gpr.platform().mean_radius();
                let shape = Shape::Cylinder { radius, half_height: PLATE };
                document.show("plate", &shape, &Pose::translation(0.0, 0.0, -PLATE), material)
            }
        }
    }

    /// Nodes of the stationary parts: bodies, stations, zones.
    pub(super) fn of_world(&mut self, document: &mut Document, cell: &Cell) -> Vec<Index<Node>> {
        let mut nodes = bodies(document, cell, ParentFrame::World, Material::Body);
        for station in &cell.stations {
            let mesh = *self.slot.get_or_insert_with(|| {
                let [half_height, wider] = SLOT;
                let radius = 0.5 * cell.wafer.diameter + wider;
                let down = Pose::translation(0.0, 0.0, -2.0 * half_height);
                let shape = Shape::Cylinder { radius, half_height };
                document
                    .mesh_at("slot", &shape, &down, Material::Station)
                    .expect("a slot is a body")
            });
            for slot in 1..=station.slots {
                let name = slot_name(station, slot);
                let node = document.node(&name, mesh, &station.slot_frame(slot));
                document.nodes[node.value()].extras = extras(&json!({ "station": station.name }));
                nodes.push(node);
            }
        }
        for zone in &cell.zones {
            let material = match zone.rule {
                ZoneRule::KeepOut => Material::KeepOut,
                ZoneRule::Safe => Material::Safe,
            };
            nodes.extend(document.show(&zone.name, &zone.shape, &zone.base_from_shape, material));
        }
        nodes
    }
}

/// The name of the node of a slot.
pub(super) fn slot_name(station: &Station, slot: usize) -> String {
    format!("{} {slot}", station.name)
}

/// Nodes of the bodies with one parent; those of stations name their station.
fn bodies(
    document: &mut Document,
    cell: &Cell,
    parent: ParentFrame,
    material: Material,
) -> Vec<Index<Node>> {
    let carried = cell.bodies.iter().filter(|body| body.parent == parent);
    let show = |body: &Body| {
        let shown = document.show(&body.name, &body.shape, &body.parent_from_shape, material);
        if let (Some(station), &[node]) = (body.station, shown.as_slice()) {
            let name = &cell.stations[station].name;
            document.nodes[node.value()].extras = extras(&json!({ "station": name }));
        }
        shown
    };
    carried.flat_map(show).collect()
}

impl Document {
    /// A shape at its place, as a node; none where it has no surface.
    pub(super) fn show(
        &mut self,
        name: &str,
        shape: &Shape,
        at: &Pose,
        material: Material,
    ) -> Vec<Index<Node>> {
        let mesh = self.mesh_at(name, shape, &Pose::identity(), material);
        mesh.map(|mesh| self.node(name, mesh, at)).into_iter().collect()
    }

    /// A mesh of a shape that is displaced within it.
    fn mesh_at(
        &mut self,
        name: &str,
        shape: &Shape,
        at: &Pose,
        material: Material,
    ) -> Option<Index<Mesh>> {
        let surface = shape.surface();
        if surface.triangles.is_empty() {
            return None;
        }
        let placed = |corner: &[f64; 3]| {
            let corner = at * nalgebra::Point3::from(*corner);
            [corner.x, corner.y, corner.z].map(single)
        };
        let vertices: Vec<[f32; 3]> = surface.vertices.iter().map(placed).collect();
        let material = self.material(material);
        let position = self.buffer.vertices(&vertices);
        let indices = self.buffer.triangles(&surface.triangles);
        let primitive = Primitive {
            attributes: [(Valid(Semantic::Positions), position)].into(),
            indices: Some(indices),
            material: Some(material),
            mode: Valid(Mode::Triangles),
            targets: None,
            extensions: None,
            extras: None,
        };
        let mesh = Mesh {
            name: Some(name.to_owned()),
            primitives: vec![primitive],
            weights: None,
            extensions: None,
            extras: None,
        };
        Some(Index::push(&mut self.meshes, mesh))
    }

    /// Index of a material, which is described when it is first used.
    fn material(&mut self, material: Material) -> Index<gltf_json::Material> {
        let known = self.materials.iter().position(|&one| one == material);
        let index = known.unwrap_or_else(|| {
            self.materials.push(material);
            self.materials.len() - 1
        });
        Index::new(u32::try_from(index).expect("there are few materials"))
    }

    /// A node with a mesh.
    fn node(&mut self, name: &str, mesh: Index<Mesh>, at: &Pose) -> Index<Node> {
        let rotation: [f64; 4] =
            nalgebra::UnitQuaternion::from_rotation_matrix(&at.rotation).into_inner().coords.into();
        let translation: [f64; 3] = at.translation.vector.into();
        let node = Node {
            name: Some(name.to_owned()),
            mesh: Some(mesh),
            translation: (translation != [0.0; 3]).then(|| translation.map(single)),
            rotation: (rotation[3] != 1.0).then(|| UnitQuaternion(rotation.map(single))),
            ..Default::default()
        };
        Index::push(&mut self.nodes, node)
    }
}
