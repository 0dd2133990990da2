//! Symmetries of a mechanism: rotations and reflections that map its joints onto each other.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::coupling_rows::coupling_rows;
use super::{CommandedJoints, JointKind, MechanismSystem};
use crate::Error;
use crate::constraint::System;
use crate::linalg::svd;
use crate::spatial::Pose;

/// Places and directions that differ by no more than this map onto each other, in characteristic lengths and radians.
const SAME: f64 = 1e-6;
/// Symmetries are looked for up to this many joints.
const MOST_JOINTS: usize = 64;

/// A rotation or reflection about the middle of the joints that maps every joint onto one of the same kind, every link onto a link, and the base onto itself.
pub(super) struct Symmetry {
    /// (joints) the joint that each is mapped onto; never all onto themselves.
    pub(super) joints: Vec<usize>,
    /// (links) the link that each is mapped onto.
    pub(super) links: Vec<usize>,
    /// The orthogonal matrix, in the base frame.
    pub(super) turn: Matrix3<f64>,
}

/// A joint in the base frame.
struct Place {
    /// From the middle of the joints (m).
    at: Vector3<f64>,
    /// Directions that the kind has, without sense.
    axes: Vec<Vector3<f64>>,
}

/// Whether two directions are parallel, in either sense.
pub(super) fn parallel(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    a.cross(b).norm() <= SAME
}

/// All symmetries of a mechanism at a configuration but those that leave every joint where it is.
///
/// Joints that all lie on one line have none here: what turns about the line is not looked for.
/// Couplings are mapped onto combinations of couplings, or the map is no symmetry.
///
/// # Arguments
/// * `home` – (f + M) (m, rad)
pub(super) fn symmetries(
    system: &MechanismSystem<'_>,
    home: &DVector<f64>,
) -> Result<Vec<Symmetry>, Error> {
    let mechanism = system.kinematics().mechanism();
    let links = system.kinematics().link_poses(home)?;
    let unit = system.characteristic_length();
    let joints = mechanism.joints();
    if joints.len() > MOST_JOINTS || joints.is_empty() {
        return Ok(Vec::new());
    }
    let mut places: Vec<Place> = Vec::with_capacity(joints.len());
    for joint in joints {
        let frame = links[joint.links[0]] * joint.frames[0];
        let other = links[joint.links[1]] * joint.frames[1];
        let axes = match joint.kind {
            JointKind::Spherical | JointKind::Fixed | JointKind::Floating => Vec::new(),
            JointKind::Universal => {
                vec![frame.rotation * Vector3::z(), other.rotation * Vector3::x()]
            }
            _ => vec![frame.rotation * Vector3::z()],
        };
        places.push(Place { at: frame.translation.vector, axes });
    }
    #[expect(clippy::cast_precision_loss, reason = "a count of joints")]
    let middle = places.iter().map(|place| place.at).sum::<Vector3<f64>>() / places.len() as f64;
    places.iter_mut().for_each(|place| place.at -= middle);
    // Two places off the middle, whose images fix the map up to its sense.
    let farthest = |size: &dyn Fn(&Place) -> f64| {
        (0..places.len()).max_by(|&a, &b| size(&places[a]).total_cmp(&size(&places[b])))
    };
    let Some(a) = farthest(&|place| place.at.norm()) else { return Ok(Vec::new()) };
    let first = places[a].at;
    let Some(b) = farthest(&|place| first.cross(&place.at).norm()) else { return Ok(Vec::new()) };
    let second = places[b].at;
    let across = first.cross(&second);
    if across.norm() <= SAME * unit * unit {
        return Ok(Vec::new());
    }
    let Some(inverse) = Matrix3::from_columns(&[first, second, across]).try_inverse() else {
        return Ok(Vec::new());
    };
    let near = |a: f64, b: f64| (a - b).abs() <= SAME * unit * unit;
    let has_sense = joints.iter().any(|joint| matches!(joint.kind, JointKind::Helical { .. }));
    let mut found = Vec::new();
    for image_of_a in &places {
        if !near(image_of_a.at.norm_squared(), first.norm_squared()) {
            continue;
        }
        for image_of_b in &places {
            let alike = near(image_of_b.at.norm_squared(), second.norm_squared())
                && near(image_of_a.at.dot(&image_of_b.at), first.dot(&second));
            if !alike {
                continue;
            }
            let normal = image_of_a.at.cross(&image_of_b.at);
            for sense in [1.0, -1.0] {
                if has_sense && sense < 0.0 {
                    continue;
                }
                let images = Matrix3::from_columns(&[image_of_a.at, image_of_b.at, normal * sense]);
                let turn = images * inverse;
                if let Some(symmetry) = mapped(system, &places, &turn, unit)
                    && keeps_couplings(system, &links, &symmetry)?
                {
                    found.push(symmetry);
                }
            }
        }
    }
    Ok(found)
}

/// Whether a symmetry maps each coupling onto a combination of the couplings.
///
/// Coordinates of joints that have no single axis are not examined: a coupling of them counts as unsymmetric.
fn keeps_couplings(
    system: &MechanismSystem<'_>,
    links: &[Pose],
    symmetry: &Symmetry,
) -> Result<bool, Error> {
    let kinematics = system.kinematics();
    let (length, dimensions) = (system.characteristic_length(), kinematics.dimensions());
    let rows = coupling_rows(kinematics, length);
    let mut couplings = DMatrix::zeros(kinematics.mechanism().joint_freedoms(), rows.len());
    let mut images = couplings.clone();
    for (c, row) in rows.iter().enumerate() {
        for &(k, factor) in &row.entries {
            let Some((image, sign)) = image_of(system, links, symmetry, k) else {
                return Ok(false);
            };
            let scaled = factor * dimensions[k].unit(length);
            couplings[(k, c)] = scaled;
            images[(image, c)] = sign * scaled;
        }
    }
    if rows.is_empty() {
        return Ok(true);
    }
    let found = svd(&couplings)?;
    let rank = found.singular_values.iter().filter(|&&value| value > SAME).count();
    let span = found.u.columns(0, rank);
    let outside = &images - span * span.tr_mul(&images);
    Ok(outside.amax() <= SAME)
}

/// The coordinate onto which a symmetry maps one, and whether it reverses its sense.
fn image_of(
    system: &MechanismSystem<'_>,
    links: &[Pose],
    symmetry: &Symmetry,
    coordinate: usize,
) -> Option<(usize, f64)> {
    let kinematics = system.kinematics();
    let joints = kinematics.mechanism().joints();
    let j = (0..joints.len()).find(|&j| kinematics.coordinates_of(j).contains(&coordinate))?;
    let freedom = coordinate - kinematics.coordinates_of(j).start;
    let axial = match (joints[j].kind, freedom) {
        (JointKind::Revolute | JointKind::Helical { .. }, _) | (JointKind::Cylindrical, 1) => true,
        (JointKind::Prismatic | JointKind::Cylindrical, _) => false,
        _ => return None,
    };
    let image = symmetry.joints[j];
    let [from, to] = [j, image].map(|joint| {
        let joint = &joints[joint];
        (links[joint.links[0]] * joint.frames[0]).rotation * Vector3::z()
    });
    // Reversed where the image of the first link is the second link.
    let kept = symmetry.links[joints[j].links[0]] == joints[image].links[0];
    let handedness = if axial { symmetry.turn.determinant() } else { 1.0 };
    let along = (symmetry.turn * from).dot(&to) * handedness;
    let sign = if kept { along.signum() } else { -along.signum() };
    Some((kinematics.coordinates_of(image).start + freedom, sign))
}

/// Whether a symmetry maps each command onto one of the commands.
///
/// A command is the displacement of the commanded joints from home, slides as vectors and turns as axial vectors.
/// Joints with several freedoms, other than balls of which all coordinates are commanded, are not examined: a command of them counts as unsymmetric.
///
/// # Arguments
/// * `links` – poses of the links at home
/// * `commands` – values of the commanded coordinates (m, rad)
pub(super) fn maps_commands(
    system: &MechanismSystem<'_>,
    links: &[Pose],
    symmetry: &Symmetry,
    commanded: &CommandedJoints,
    commands: &[DVector<f64>],
) -> bool {
    let joints = system.kinematics().mechanism().joints();
    let unit = system.characteristic_length();
    let mut of_commands = Vec::with_capacity(commands.len());
    for command in commands {
        let start = commanded.start(command.iter().copied(), 0);
        let moved = system.kinematics().displacement(&commanded.start([], 0), &start);
        let mut vectors = vec![None; joints.len()];
        for (j, joint) in joints.iter().enumerate() {
            let coordinates = system.kinematics().coordinates_of(j);
            let by_command = |k: &usize| commanded.coordinates().contains(k);
            let count = coordinates.clone().filter(by_command).count();
            if count == 0 {
                continue;
            }
            let by: Vec<f64> = coordinates.map(|k| moved[k]).collect();
            let (local, axial) = match joint.kind {
                JointKind::Prismatic => (Vector3::z() * (by[0] / unit), false),
                JointKind::Revolute | JointKind::Helical { .. } => (Vector3::z() * by[0], true),
                JointKind::Spherical if count == 3 => (Vector3::new(by[0], by[1], by[2]), true),
                _ => return false,
            };
            let frame = links[joint.links[0]] * joint.frames[0];
            vectors[j] = Some((frame.rotation * local, axial));
        }
        of_commands.push(vectors);
    }
    let largest =
        of_commands.iter().flatten().flatten().fold(0.0_f64, |most, one| most.max(one.0.norm()));
    let handedness = symmetry.turn.determinant();
    of_commands.iter().all(|from| {
        of_commands.iter().any(|to| {
            from.iter().enumerate().all(|(j, from)| {
                let image = symmetry.joints[j];
                // Reversed where the image of the first link is the second link.
                let kept = symmetry.links[joints[j].links[0]] == joints[image].links[0];
                let sense = if kept { 1.0 } else { -1.0 };
                match (from, &to[image]) {
                    (None, None) => true,
                    (Some((from, axial)), Some((to, _))) => {
                        let sense = if *axial { sense * handedness } else { sense };
                        (symmetry.turn * from * sense - to).norm() <= SAME * largest
                    }
                    _ => false,
                }
            })
        })
    })
}

/// The symmetry that a map is, if it is one and moves a joint.
fn mapped(
    system: &MechanismSystem<'_>,
    places: &[Place],
    turn: &Matrix3<f64>,
    unit: f64,
) -> Option<Symmetry> {
    let mechanism = system.kinematics().mechanism();
    let kinds = mechanism.joints();
    let mut images: Vec<usize> = Vec::with_capacity(places.len());
    for (j, place) in places.iter().enumerate() {
        let at = turn * place.at;
        let axes: Vec<Vector3<f64>> = place.axes.iter().map(|axis| turn * axis).collect();
        let image = (0..places.len()).find(|&k| {
            !images.contains(&k)
                && kinds[k].kind == kinds[j].kind
                && kinds[k].actuated == kinds[j].actuated
                && (places[k].at - at).norm() <= SAME * unit
                && axes.iter().all(|axis| places[k].axes.iter().any(|other| parallel(axis, other)))
        })?;
        images.push(image);
    }
    if images.iter().enumerate().all(|(j, &image)| j == image) {
        return None;
    }
    // A link is known by its joints.
    let on = |link: usize| -> Vec<usize> {
        (0..kinds.len()).filter(|&j| kinds[j].links.contains(&link)).collect()
    };
    let count = mechanism.links().len();
    let all: Vec<Vec<usize>> = (0..count).map(on).collect();
    let mut links = Vec::with_capacity(count);
    for joints in &all {
        let mut mapped: Vec<usize> = joints.iter().map(|&j| images[j]).collect();
        mapped.sort_unstable();
        links.push((0..count).find(|&l| all[l] == mapped && !links.contains(&l))?);
    }
    (links[0] == 0).then_some(Symmetry { joints: images, links, turn: *turn })
}
