//! Suggestions against all sets of small mechanisms, by another formulation.
//!
//! Here the unknowns are the poses of all links, not joint coordinates; derivatives are differences; and the least displacement is that of a penalty method.

use crate::robot;

use jointplay_core::Error;
use jointplay_core::mechanism::{
    Carrier, JointKind, LinearAndAngular, Mechanism, SuggestOptions, Suggestion, SuggestionRank,
    VirtualMotion, suggest,
};
use jointplay_core::nalgebra::{
    DMatrix, DVector, Isometry3, Matrix3xX, Translation3, UnitQuaternion, Vector3,
};

use robot::{gpr, home, joint, legs, names};

/// Weight of the closure of loops against displacements, both in units of the mechanism.
const PENALTY: f64 = 1e6;
/// Steps of links cost this share of a displacement.
const DAMPING: f64 = 1e-6;
/// Characteristic length of the mechanisms (m).
const LENGTH: f64 = 0.3;
/// Directions of one leg that differ by no more than this are the same (rad).
const SAME: f64 = 0.05;

/// A displacement of the place of a joint on one of its links.
#[derive(Debug, Clone)]
struct Play {
    joint: usize,
    /// Which of the two links of the joint carries it.
    side: usize,
    slides: bool,
    direction: Vector3<f64>,
    point: Vector3<f64>,
}

impl Play {
    fn of(joint: &jointplay_core::mechanism::VirtualJoint, mechanism: &Mechanism) -> Self {
        let side = usize::from(joint.carrier == Carrier::Second);
        let place = mechanism.joints()[joint.joint].frames[side].translation.vector;
        let (slides, direction, point) = match joint.motion {
            VirtualMotion::Slide(direction) => (true, direction, place),
            VirtualMotion::Turn { axis, point } => (false, axis, point),
        };
        Self { joint: joint.joint, side, slides, direction: direction.into_inner(), point }
    }

    fn by(&self, y: f64) -> Isometry3<f64> {
        if self.slides {
            return Isometry3::from(Translation3::from(self.direction * y));
        }
        let turn = UnitQuaternion::from_scaled_axis(self.direction * y);
        Isometry3::from_parts(Translation3::from(self.point - turn * self.point), turn)
    }

    /// Whether both displace a leg in the same manner.
    fn is_same(&self, other: &Self) -> bool {
        let parallel = self.direction.cross(&other.direction).norm() <= SAME;
        let off = (self.point - other.point).cross(&self.direction).norm();
        self.slides == other.slides && parallel && (self.slides || off < 1e-9)
    }
}

/// A mechanism whose links are all at the origin at home, with commanded coordinates of revolute and prismatic joints.
struct Case {
    mechanism: Mechanism,
    commanded: Vec<usize>,
    commands: Vec<Vec<f64>>,
    /// Largest number of virtual joints in a set.
    joints: usize,
    /// Linear and angular stiffness of each joint, for a rank by stiffness (N/m, N m/rad).
    stiffness: Option<Vec<[f64; 2]>>,
}

impl Case {
    /// Stiffness of a displacement, or its weight in the metric (N/m and N m/rad, or 1 and m²).
    fn weight(&self, play: &Play) -> f64 {
        match &self.stiffness {
            Some(all) => all[play.joint][usize::from(!play.slides)],
            None if play.slides => 1.0,
            None => self.length() * self.length(),
        }
    }

    /// The same displacement of a leg at that of its joints where it needs the least energy.
    fn softest(&self, play: Play) -> Play {
        let joints = self.mechanism.joints();
        let leg = self.legs();
        let moved = |j: usize| {
            let count = |link| joints.iter().filter(|other| other.links.contains(&link)).count();
            let side = usize::from(count(joints[j].links[1]) >= count(joints[j].links[0]));
            let point = joints[j].frames[0].translation.vector;
            Play { joint: j, side, point, ..play.clone() }
        };
        let others = (0..joints.len()).filter(|&j| {
            let axis = joints[j].frames[0].rotation * Vector3::z();
            let along = play.direction.cross(&axis).norm() < 1e-6;
            let free = joints[j].kind == JointKind::Prismatic && along;
            self.stiffness.is_some() && play.slides && leg[j] == leg[play.joint] && !free
        });
        let all = others.map(moved);
        all.fold(play.clone(), |a, b| if self.weight(&b) < self.weight(&a) { b } else { a })
    }

    fn length(&self) -> f64 {
        self.mechanism.characteristic_length().unwrap()
    }

    /// Joint that has a coordinate of one freedom.
    fn joint_of(&self, coordinate: usize) -> usize {
        let mut first = 0;
        for (j, joint) in self.mechanism.joints().iter().enumerate() {
            if first == coordinate {
                assert_eq!(joint.kind.freedoms(), 1);
                return j;
            }
            first += joint.kind.freedoms();
        }
        panic!("no such coordinate")
    }

    fn legs(&self) -> Vec<usize> {
        let joints = self.mechanism.joints();
        let mut leg: Vec<usize> = (0..joints.len()).collect();
        for _ in 0..joints.len() {
            for link in 0..self.mechanism.links().len() {
                let on: Vec<usize> =
                    (0..joints.len()).filter(|&j| joints[j].links.contains(&link)).collect();
                if on.len() == 2 {
                    let least = leg[on[0]].min(leg[on[1]]);
                    on.iter().for_each(|&j| leg[j] = least);
                }
            }
        }
        leg
    }

    /// Radial, tangential and normal slides and turns that the joints lack, one of each kind for a leg.
    fn candidates(&self) -> Vec<Play> {
        let joints = self.mechanism.joints();
        let mut all = Vec::new();
        for (j, joint) in joints.iter().enumerate() {
            let count = |link| joints.iter().filter(|other| other.links.contains(&link)).count();
            let side = usize::from(count(joint.links[1]) >= count(joint.links[0]));
            let link = joint.links[side];
            let places: Vec<Vector3<f64>> = joints
                .iter()
                .filter(|other| other.links.contains(&link))
                .map(|other| other.frames[0].translation.vector)
                .collect();
            let middle = places.iter().sum::<Vector3<f64>>() / places.len() as f64;
            let axis = joint.frames[0].rotation * Vector3::z();
            let spread = places.iter().flat_map(|a| places.iter().map(move |b| (a, b)));
            let areas = spread.map(|(a, b)| (a - middle).cross(&(b - middle)));
            let area = areas.max_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap();
            let normal = if area.norm() > 1e-9 { area.normalize() } else { axis };
            let point = joint.frames[0].translation.vector;
            let across = |v: Vector3<f64>| v - normal * v.dot(&normal);
            let arm = across(point - middle);
            let own = across(joint.frames[0].rotation * Vector3::x());
            let radial = if arm.norm() > 1e-9 { arm.normalize() } else { own.normalize() };
            for direction in [radial, normal.cross(&radial), normal] {
                let along = direction.cross(&axis).norm() < 1e-6;
                let (slide_is_free, turn_is_free) = match joint.kind {
                    JointKind::Prismatic => (along, false),
                    JointKind::Revolute => (false, along),
                    JointKind::Spherical => (false, true),
                    _ => panic!("not in these mechanisms"),
                };
                for (slides, free) in [(true, slide_is_free), (false, turn_is_free)] {
                    if !free {
                        all.push(Play { joint: j, side, slides, direction, point });
                    }
                }
            }
        }
        all.sort_by_key(|play| std::cmp::Reverse(joints[play.joint].kind.freedoms()));
        let leg = self.legs();
        let mut found: Vec<Play> = Vec::new();
        for play in all {
            if !found
                .iter()
                .any(|known| leg[known.joint] == leg[play.joint] && known.is_same(&play))
            {
                found.push(play);
            }
        }
        found.into_iter().map(|play| self.softest(play)).collect()
    }

    /// Candidates, with the directions in which a leg is displaced or a joint turned by the least displacement of all of them.
    fn candidates_with_principal(&self) -> Vec<Play> {
        let mut all = self.candidates();
        let leg = self.legs();
        let least: Vec<Vec<f64>> =
            (0..self.commands.len()).map(|c| self.least(c, &all).unwrap()).collect();
        let length = self.length();
        let scale = |play: &Play| if play.slides { 1.0 } else { length };
        let group =
            |play: &Play| (play.slides, if play.slides { leg[play.joint] } else { play.joint });
        let largest = least
            .iter()
            .flat_map(|y| y.iter().zip(&all).map(|(y, play)| y.abs() * scale(play)))
            .fold(0.0, f64::max);
        let mut groups: Vec<(bool, usize)> = all.iter().map(group).collect();
        groups.dedup();
        let mut done = Vec::new();
        let mut found = Vec::new();
        for one in groups {
            if done.contains(&one) {
                continue;
            }
            done.push(one);
            let members: Vec<usize> = (0..all.len()).filter(|&k| group(&all[k]) == one).collect();
            let columns: Vec<Vector3<f64>> = least
                .iter()
                .map(|y| members.iter().map(|&k| all[k].direction * (y[k] * scale(&all[k]))).sum())
                .collect();
            let d = Matrix3xX::from_columns(&columns);
            let parts = (&d * d.transpose()).symmetric_eigen();
            let sizes = parts.eigenvalues.map(|x| x.max(0.0).sqrt());
            let mut order = [0, 1, 2];
            order.sort_by(|&a, &b| sizes[b].total_cmp(&sizes[a]));
            for (n, &k) in order.iter().enumerate() {
                let direction = parts.eigenvectors.column(k).into_owned();
                let unique = (0..3_usize).all(|m| {
                    m.abs_diff(n) != 1 || (sizes[order[m]] - sizes[k]).abs() > 0.05 * sizes[k]
                });
                let known =
                    members.iter().any(|&m| all[m].direction.cross(&direction).norm() <= SAME);
                if unique && !known && sizes[k] > 1e-3 * largest {
                    found.push(self.softest(Play { direction, ..all[members[0]].clone() }));
                }
            }
        }
        all.extend(found);
        all
    }

    /// Mismatches of all joints and commands, and the poses of links moved by `x`.
    fn mismatches(
        &self,
        command: usize,
        poses: &[Isometry3<f64>],
        plays: &[Play],
        y: &[f64],
    ) -> Vec<f64> {
        let length = self.length();
        let mut found = Vec::new();
        for (j, joint) in self.mechanism.joints().iter().enumerate() {
            let side = |s: usize| {
                let mut pose = poses[joint.links[s]];
                for (play, &y) in
                    plays.iter().zip(y).filter(|(play, _)| play.joint == j && play.side == s)
                {
                    pose *= play.by(y);
                }
                let frame = joint.frames[s];
                let turn = UnitQuaternion::from_rotation_matrix(&frame.rotation);
                pose * Isometry3::from_parts(frame.translation, turn)
            };
            let relative = side(0).inverse() * side(1);
            let (p, r) = (relative.translation.vector / length, relative.rotation.scaled_axis());
            let wanted = self.commanded.iter().position(|&k| self.is_at(k, j));
            let wanted = wanted.map(|n| self.commands[command][n]);
            match joint.kind {
                JointKind::Revolute => {
                    // Tilts of the axis, whatever the angle about it.
                    let axis = relative.rotation * Vector3::z();
                    found.extend([p.x, p.y, p.z, axis.x, axis.y]);
                    if let Some(wanted) = wanted {
                        let x = relative.rotation * Vector3::x();
                        found.push(x.y.atan2(x.x) - wanted);
                    }
                }
                JointKind::Prismatic => {
                    found.extend([p.x, p.y, r.x, r.y, r.z]);
                    found.extend(wanted.map(|wanted| p.z - wanted / length));
                }
                JointKind::Spherical => found.extend([p.x, p.y, p.z]),
                _ => panic!("not in these mechanisms"),
            }
        }
        found
    }

    fn is_at(&self, coordinate: usize, joint: usize) -> bool {
        self.joint_of(coordinate) == joint
    }

    /// Least displacements for a command (m, rad), if these plays are sufficient.
    fn least(&self, command: usize, plays: &[Play]) -> Option<Vec<f64>> {
        let links = self.mechanism.links().len();
        let (moving, m) = (6 * (links - 1), plays.len());
        let length = self.length();
        // In units of the largest weight, and of the characteristic length.
        let unit = plays.iter().filter(|play| play.slides).map(|play| self.weight(play));
        let unit = unit.fold(0.0, f64::max) * length * length;
        let unit = if unit > 0.0 { unit } else { length * length };
        let weight = |play: &Play| (self.weight(play) / unit).sqrt();
        let mut poses = vec![Isometry3::identity(); links];
        let mut y = vec![0.0; m];
        let moved = |poses: &[Isometry3<f64>], k: usize, by: f64| {
            let mut poses = poses.to_vec();
            let (link, axis) = (1 + k / 6, k % 6);
            let mut v = Vector3::zeros();
            v[axis % 3] = by;
            let by = if axis < 3 {
                Isometry3::from(Translation3::from(v * length))
            } else {
                Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_scaled_axis(v))
            };
            poses[link] = by * poses[link];
            poses
        };
        let mut first = f64::NAN;
        for step in 0..60 {
            let c = DVector::from_vec(self.mismatches(command, &poses, plays, &y));
            if step == 0 {
                first = c.norm();
            }
            let rows = c.len();
            let mut system = DMatrix::zeros(rows + m + moving, moving + m);
            let mut right = DVector::zeros(rows + m + moving);
            let h = 1e-6;
            for k in 0..moving {
                let [up, down] = [h, -h].map(|by| {
                    DVector::from_vec(self.mismatches(command, &moved(&poses, k, by), plays, &y))
                });
                system
                    .view_mut((0, k), (rows, 1))
                    .copy_from(&((up - down) * (PENALTY / (2.0 * h))));
                system[(rows + m + k, k)] = DAMPING;
            }
            for k in 0..m {
                let scale = weight(&plays[k]);
                let [up, down] = [h, -h].map(|by| {
                    let mut y = y.clone();
                    y[k] += by / scale;
                    DVector::from_vec(self.mismatches(command, &poses, plays, &y))
                });
                let column = moving + k;
                system
                    .view_mut((0, column), (rows, 1))
                    .copy_from(&((up - down) * (PENALTY / (2.0 * h))));
                system[(rows + k, column)] = 1.0;
                right[rows + k] = -y[k] * scale;
            }
            right.rows_mut(0, rows).copy_from(&(-&c * PENALTY));
            let qr = system.qr();
            let short = qr.r().solve_upper_triangular(&(qr.q().transpose() * right))?;
            for k in 0..moving {
                poses = moved(&poses, k, short[k]);
            }
            for k in 0..m {
                y[k] += short[moving + k] / weight(&plays[k]);
            }
            let left = DVector::from_vec(self.mismatches(command, &poses, plays, &y)).norm();
            if left < 1e-9 * first && short.rows(moving, m).norm() < 1e-9 * first {
                return Some(y);
            }
            if step == 3 && left > 1e-2 * first {
                return None;
            }
        }
        None
    }

    /// The largest √(Σ w y²) over the commands (m, or √J by stiffness), if these plays are sufficient.
    fn size(&self, plays: &[Play]) -> Option<f64> {
        let mut size = 0.0_f64;
        for command in 0..self.commands.len() {
            let y = self.least(command, plays)?;
            let squares = y.iter().zip(plays).map(|(y, play)| self.weight(play) * y * y);
            size = size.max(squares.sum::<f64>().sqrt());
        }
        Some(size)
    }

    /// Displacements of all minimal sets, the least first.
    fn all_sets(&self) -> Vec<f64> {
        let all = self.candidates_with_principal();
        let leg = self.legs();
        let allowed = |a: &Play, b: &Play| {
            let apart = leg[a.joint] != leg[b.joint] || !a.slides || !b.slides;
            apart || a.direction.dot(&b.direction).abs() <= SAME
        };
        let mut sufficient: Vec<(Vec<usize>, f64)> = Vec::new();
        let mut of_size: Vec<Vec<usize>> = vec![Vec::new()];
        for _ in 0..self.joints {
            let mut larger = Vec::new();
            for set in &of_size {
                let next = set.last().map_or(0, |last| last + 1);
                for k in next..all.len() {
                    if set.iter().all(|&other| allowed(&all[other], &all[k])) {
                        larger.push([set.as_slice(), &[k]].concat());
                    }
                }
            }
            larger.retain(|set| {
                !sufficient.iter().any(|(known, _)| known.iter().all(|k| set.contains(k)))
            });
            of_size = Vec::new();
            for set in larger {
                let plays: Vec<Play> = set.iter().map(|&k| all[k].clone()).collect();
                match self.size(&plays) {
                    Some(size) => sufficient.push((set, size)),
                    None => of_size.push(set),
                }
            }
        }
        let mut sizes: Vec<f64> = sufficient.into_iter().map(|(_, size)| size).collect();
        sizes.sort_by(f64::total_cmp);
        sizes
    }

    #[track_caller]
    fn check(mut self, name: &str) {
        if let Some(stiffness) = &self.stiffness {
            let mut joints = self.mechanism.joints().to_vec();
            for (joint, &[linear, angular]) in joints.iter_mut().zip(stiffness) {
                joint.stiffness = LinearAndAngular { linear: Some(linear), angular: Some(angular) };
            }
            let links = self.mechanism.links().to_vec();
            self.mechanism = Mechanism::new(self.mechanism.name(), links, joints).unwrap();
        }
        // One metric for all configurations.
        self.mechanism = self.mechanism.with_characteristic_length(LENGTH).unwrap();
        let commands: Vec<DVector<f64>> =
            self.commands.iter().map(|one| DVector::from_row_slice(one)).collect();
        let rank = match self.stiffness {
            Some(_) => SuggestionRank::Stiffness,
            None => SuggestionRank::Norm,
        };
        let options =
            SuggestOptions { joints: Some(self.joints), rank, ..SuggestOptions::default() };
        let root = |energy: Option<f64>| (2.0 * energy.unwrap()).sqrt();
        let size = |set: &Suggestion| match self.stiffness {
            Some(_) => root(set.energy),
            None => set.size,
        };
        let start = home(&self.mechanism);
        let found = suggest(&self.mechanism, &start, &self.commanded, &commands, &options).unwrap();
        assert!(found.needed && !found.cut_short, "{name}");
        // The first sets need what is stated; the last ones may turn by large angles, where the other formulation does not converge.
        let same = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-5;
        let plays = |set: &Suggestion| -> Vec<Play> {
            set.virtual_joints.iter().map(|joint| Play::of(joint, &self.mechanism)).collect()
        };
        for set in found.sets.iter().take(5) {
            let own = self.size(&plays(set)).unwrap_or_else(|| panic!("{name}: {set:?}"));
            assert!(same(own, size(set)), "{name}: {own} {}", size(set));
            let least = self.stiffness.as_ref().map(|_| root(found.least_energy));
            assert!(size(set) > (1.0 - 1e-3) * least.unwrap_or(found.lower_bound), "{name}");
        }
        // Symmetric sets may have smaller sufficient ones in them; all others are minimal.
        let has_smaller = |set: &Suggestion| {
            found.sets.iter().any(|other| {
                other.virtual_joints.len() < set.virtual_joints.len()
                    && other.virtual_joints.iter().all(|one| set.virtual_joints.contains(one))
            })
        };
        let minimal: Vec<f64> =
            found.sets.iter().filter(|set| !has_smaller(set)).map(size).collect();
        let naive = self.all_sets();
        let count = naive.len().min(3);
        assert!(count > 0 && minimal.len() >= count, "{name}: {} {}", minimal.len(), naive.len());
        for (found, naive) in minimal.iter().zip(&naive).take(3) {
            assert!(same(*found, *naive), "{name}: {found} {naive}");
        }
    }
}

const Z: [f64; 3] = [0.0, 0.0, 1.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];

fn ring(points: &[[f64; 3]], axis: [f64; 3]) -> Mechanism {
    let count = points.len();
    let joints = (0..count)
        .map(|k| {
            let links = [k, (k + 1) % count];
            joint(&format!("j{k}"), JointKind::Revolute, links, points[k], axis)
        })
        .collect();
    Mechanism::new("ring", names(count), joints).unwrap()
}

/// A beam on two guides that tilt by some angles, with hinges.
fn beam(tilts: [f64; 2]) -> Mechanism {
    let mut joints = Vec::new();
    for (k, x) in [(0, -0.4), (1, 0.4)] {
        let axis = [f64::sin(tilts[k]), 0.0, f64::cos(tilts[k])];
        joints.push(joint(
            &format!("guide {k}"),
            JointKind::Prismatic,
            [0, k + 1],
            [x, 0.0, 0.0],
            axis,
        ));
        joints.push(joint(
            &format!("hinge {k}"),
            JointKind::Revolute,
            [k + 1, 3],
            [x, 0.0, 0.3],
            Y,
        ));
    }
    Mechanism::new("beam", names(4), joints).unwrap()
}

#[test]
fn a_four_bar_with_two_commands() {
    let points = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.3], [3.0, 2.0, 0.0], [3.5, 0.0, 0.0]];
    let (commanded, commands) = (vec![0, 3], vec![vec![0.02, 0.0]]);
    Case { mechanism: ring(&points, Z), commanded, commands, joints: 2, stiffness: None }
        .check("four-bar");
}

#[test]
fn a_slider_crank_with_two_commands() {
    let mut joints = vec![
        joint("crank", JointKind::Revolute, [0, 1], [0.0, 0.0, 0.0], Z),
        joint("pin", JointKind::Revolute, [1, 2], [0.05, 0.08, 0.0], Z),
        joint("piston pin", JointKind::Revolute, [2, 3], [0.35, 0.0, 0.01], Z),
    ];
    joints.push(joint("cylinder", JointKind::Prismatic, [0, 3], [0.45, 0.0, 0.0], [1.0, 0.0, 0.0]));
    let mechanism = Mechanism::new("slider-crank", names(4), joints).unwrap();
    let (commanded, commands) = (vec![0, 3], vec![vec![0.002, 0.0]]);
    Case { mechanism, commanded, commands, joints: 2, stiffness: None }.check("slider-crank");
}

#[test]
fn three_cranks_on_one_coupler() {
    let mut joints = Vec::new();
    for (k, x) in [(0, 0.0), (1, 0.2), (2, 0.5)] {
        joints.push(joint(&format!("a{k}"), JointKind::Revolute, [0, k + 1], [x, 0.0, 0.0], Z));
        joints.push(joint(&format!("b{k}"), JointKind::Revolute, [k + 1, 4], [x, 0.15, 0.0], Z));
    }
    let mechanism = Mechanism::new("cranks", names(5), joints).unwrap();
    let (commanded, commands) = (vec![0, 2], vec![vec![0.05, 0.045]]);
    Case { mechanism, commanded, commands, joints: 2, stiffness: None }.check("cranks");
}

#[test]
fn a_beam_on_two_columns() {
    let (commanded, commands) = (vec![0, 2], vec![vec![0.01, -0.006]]);
    Case { mechanism: beam([0.0, 0.0]), commanded, commands, joints: 2, stiffness: None }
        .check("two columns");
}

#[test]
fn a_beam_on_inclined_guides() {
    let (commanded, commands) = (vec![0, 2], vec![vec![0.01, 0.01]]);
    Case { mechanism: beam([0.3, -0.2]), commanded, commands, joints: 2, stiffness: None }
        .check("inclined guides");
}

#[test]
fn three_legs_under_a_plate() {
    let tilt = [0.002, -0.0011, -0.0004];
    let (commanded, commands) = (vec![0, 4, 8], vec![tilt.to_vec()]);
    Case { mechanism: gpr(|_, _| Vec::new()), commanded, commands, joints: 3, stiffness: None }
        .check("three legs");
}

#[test]
fn two_inclined_legs_and_a_vertical_one() {
    let points = [[0.1, 0.0], [-0.06, 0.08], [-0.05, -0.09]];
    let (commanded, commands) = (vec![0, 1, 2], vec![vec![0.0003, 0.0003, 0.0003]]);
    Case { mechanism: legs(&points, 0.05), commanded, commands, joints: 3, stiffness: None }
        .check("inclined legs");
}

#[test]
fn a_beam_whose_joints_have_different_stiffness() {
    let (commanded, commands) = (vec![0, 2], vec![vec![0.01, -0.006]]);
    // The hinges are the soft joints of one leg, the guide is that of the other.
    let stiffness = Some(vec![[4e6, 900.0], [1e6, 2000.0], [0.5e6, 300.0], [3e6, 5000.0]]);
    let mechanism = beam([0.0, 0.0]);
    Case { mechanism, commanded, commands, joints: 2, stiffness }.check("elastic columns");
}

#[test]
fn three_legs_by_the_energy_of_balls_and_guides() {
    let tilt = [0.002, -0.0011, -0.0004];
    let (commanded, commands) = (vec![0, 4, 8], vec![tilt.to_vec()]);
    let mechanism = gpr(|_, _| Vec::new());
    let stiffness = mechanism.joints().iter().enumerate().map(|(k, joint)| match joint.kind {
        JointKind::Prismatic => [2e7 + 1e6 * k as f64, 5e3],
        _ => [3e7 - 4e6 * k as f64, 1e3],
    });
    let stiffness = Some(stiffness.collect());
    Case { mechanism, commanded, commands, joints: 3, stiffness }.check("elastic legs");
}

#[test]
fn a_rank_by_stiffness_needs_the_stiffness_of_every_joint() {
    let mechanism = beam([0.0, 0.0]);
    let commands = [DVector::from_row_slice(&[0.01, -0.006])];
    let mut options =
        SuggestOptions { rank: SuggestionRank::Stiffness, ..SuggestOptions::default() };
    options.stiffness.linear = Some(1e6);
    let found = suggest(&mechanism, &home(&mechanism), &[0, 2], &commands, &options);
    let Err(Error::NoStiffness { direction: "angular", .. }) = found else { panic!("{found:?}") };
    options.stiffness.angular = Some(1e4);
    let found = suggest(&mechanism, &home(&mechanism), &[0, 2], &commands, &options).unwrap();
    // Of equal stiffness, slides only: the energy is that of their size.
    let first = found.sets.iter().find(|set| {
        set.virtual_joints.iter().all(|one| matches!(one.motion, VirtualMotion::Slide(_)))
    });
    let first = first.unwrap();
    let (energy, size) = (first.energy.unwrap(), first.size);
    assert!((energy / (0.5e6 * size * size) - 1.0).abs() < 1e-9, "{energy} {size}");
}
