//! Finite mobility and branches of mechanisms whose motions are known by thought, and of mechanisms made of several.
#![expect(clippy::cast_precision_loss, reason = "small counts")]

use crate::families;
use crate::robot;

use jointplay_core::mechanism::{
    Joint, JointKind, Mechanism, MechanismError, MechanismMobility, MechanismSystem, OpenLoops,
    SparseMobility, SparseSystem, assemble, blocks, guess, mechanism_mobility,
};
use jointplay_core::mobility::RANK_THRESHOLD;
use jointplay_core::nalgebra::DVector;

const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Joints between named links; the first link named is the base.
#[derive(Default)]
struct Drawing {
    links: Vec<String>,
    joints: Vec<Joint>,
}

impl Drawing {
    fn on(base: &str) -> Self {
        Self { links: vec![base.to_owned()], joints: Vec::new() }
    }

    fn link(&mut self, name: &str) -> usize {
        self.links.iter().position(|link| link == name).unwrap_or_else(|| {
            self.links.push(name.to_owned());
            self.links.len() - 1
        })
    }

    fn add(&mut self, kind: JointKind, links: [&str; 2], point: [f64; 3], axis: [f64; 3]) {
        let links = links.map(|name| self.link(name));
        let name = format!("j{}", self.joints.len());
        self.joints.push(robot::joint(&name, kind, links, point, axis));
    }

    fn hinge(&mut self, links: [&str; 2], x: f64, y: f64) {
        self.add(JointKind::Revolute, links, [x, y, 0.0], Z);
    }

    /// A closed chain of hinges along z from the base back to it.
    fn chain(&mut self, tag: &str, points: &[[f64; 2]]) {
        let names: Vec<String> = (1..points.len()).map(|k| format!("{tag}{k}")).collect();
        let base = self.links[0].clone();
        let link = |k: usize| k.checked_sub(1).map_or(base.clone(), |k| names[k].clone());
        for (k, &[x, y]) in points.iter().enumerate() {
            self.hinge([&link(k), &link((k + 1) % points.len())], x, y);
        }
    }

    fn mechanism(self) -> Mechanism {
        Mechanism::new("drawing", self.links, self.joints).unwrap()
    }
}

fn analysed(mechanism: &Mechanism) -> MechanismMobility {
    let home = DVector::zeros(mechanism.joint_freedoms());
    let system = MechanismSystem::new(mechanism, home).unwrap();
    mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused).unwrap()
}

/// Compares the instantaneous mobility, the finite mobility and the dimensions of the branches.
#[track_caller]
fn check(drawing: Drawing, first: usize, finite: usize, branches: &[usize]) {
    let found = analysed(&drawing.mechanism());
    let bounds = (found.finite.lower_bound, found.finite.upper_bound);
    assert_eq!(
        (found.finite.instantaneous.mobility, bounds, found.branch_dimensions.as_deref()),
        (first, (finite, finite), Some(branches).filter(|_| finite < first)),
        "{:?}",
        found.finite.nearby
    );
}

/// The plate moves on a sphere, by two freedoms, without turning, and every leg spins: 8. A turn of the plate would need legs of other lengths.
#[test]
fn equal_parallel_legs_under_a_congruent_plate() {
    let feet = [[1.0, 0.1], [0.4, 0.9], [-0.5, 0.8], [-1.1, 0.05], [-0.45, -0.9], [0.6, -0.7]];
    let mut legs = Drawing::on("ground");
    for (k, [x, y]) in feet.into_iter().enumerate() {
        let leg = format!("leg {k}");
        legs.add(JointKind::Spherical, ["ground", &leg], [x, y, 0.0], Z);
        legs.add(JointKind::Spherical, [&leg, "plate"], [x, y, 1.0], Z);
    }
    check(legs, 9, 8, &[8]);
}

/// n hinges on a line, not all bars in one sense: the closure is an indefinite quadric in n − 2 motions, a cone of dimension n − 3.
#[test]
fn closed_chains_with_all_hinges_on_a_line() {
    let places = [0.0, 1.0, 3.0, 2.2, 4.0, 1.7, 0.6];
    for n in 5..=7 {
        let mut chain = Drawing::on("ground");
        let points: Vec<[f64; 2]> = places[..n].iter().map(|&x| [x, 0.0]).collect();
        chain.chain("bar ", &points);
        check(chain, n - 2, n - 3, &[n - 3]);
    }
}

/// Independent mechanisms on one base move independently, each along one branch at a time.
#[test]
fn independent_mechanisms_are_not_kinematotropic() {
    let flat = |x: f64| [[x, 0.0], [x + 1.0, 0.0], [x + 3.0, 0.0], [x + 2.0, 0.0]];
    let bent = |x: f64| [[x, 0.0], [x + 0.5, 1.0], [x + 2.5, 1.5], [x + 2.0, 0.0]];
    let mut two = Drawing::on("ground");
    two.chain("a", &flat(0.0));
    two.chain("b", &flat(4.0));
    check(two, 4, 2, &[2]);
    let mut two = Drawing::on("ground");
    two.chain("a", &flat(0.0));
    two.chain("b", &bent(4.0));
    two.hinge(["b2", "arm"], 9.0, 0.0);
    check(two, 4, 3, &[3]);
}

/// Three cranks or more keep the coupler parallel: of the flat parallelogram's two branches one remains.
#[test]
fn flat_parallelograms_with_many_cranks() {
    for count in [3, 4, 5] {
        let mut cranks = Drawing::on("ground");
        for (k, x) in [0.0, 1.0, 2.3, 3.1, 4.4].into_iter().take(count).enumerate() {
            let crank = format!("crank {k}");
            cranks.hinge(["ground", &crank], x, 0.0);
            cranks.hinge([&crank, "coupler"], x + 1.7, 0.0);
        }
        check(cranks, 2, 1, &[1]);
    }
}

/// A flat sheet folds along its straight creases alone, each by itself, or along one or both of its zigzags with one freedom.
#[test]
fn flat_miura_folds() {
    for (size, first, finite, branches) in [(2, 2, 1, vec![1]), (3, 4, 2, vec![1, 2])] {
        let (sin, cos) = 60.0_f64.to_radians().sin_cos();
        let corner = |row: usize, column: usize| {
            [column as f64 + (row % 2) as f64 * cos, row as f64 * sin, 0.0]
        };
        let panel = |row: usize, column: usize| format!("panel {row} {column}");
        let mut sheet = Drawing::on("panel 0 0");
        let mut crease = |panels: [String; 2], ends: [[f64; 3]; 2]| {
            let axis = [0, 1, 2].map(|k| ends[1][k] - ends[0][k]);
            sheet.add(JointKind::Revolute, [&panels[0], &panels[1]], ends[0], axis);
        };
        for row in 0..size {
            for column in 0..size {
                if column + 1 < size {
                    let ends = [corner(row, column + 1), corner(row + 1, column + 1)];
                    crease([panel(row, column), panel(row, column + 1)], ends);
                }
                if row + 1 < size {
                    let ends = [corner(row + 1, column), corner(row + 1, column + 1)];
                    crease([panel(row, column), panel(row + 1, column)], ends);
                }
            }
        }
        check(sheet, first, finite, &branches);
    }
}

/// Two of Watt's linkages with a bar between their middle pins: the pins move up s and t along almost straight lines, and (s − t)² is a fifth power, a cusp.
#[test]
fn double_watt_cusps() {
    for sense in [1.0, -1.0] {
        let mut watt = Drawing::on("ground");
        for (tag, x, sense) in [("a", 0.0, 1.0), ("b", 1.5, sense)] {
            let [left, coupler, right] = ["left", "coupler", "right"].map(|l| format!("{l} {tag}"));
            watt.hinge(["ground", &left], x - 2.0, 0.5 * sense);
            watt.hinge([&left, &coupler], x, 0.5 * sense);
            watt.hinge([&coupler, &right], x, -0.5 * sense);
            watt.hinge([&right, "ground"], x + 2.0, -0.5 * sense);
        }
        watt.hinge(["coupler a", "bar"], 0.0, 0.0);
        watt.hinge(["bar", "coupler b"], 1.5, 0.0);
        check(watt, 2, 1, &[1]);
    }
}

/// A symmetric four-bar with a chain of three bars, stretched from its coupler to the centre of curvature of the path there: away from symmetry the coupler comes nearer to this centre, by the fourth order, and the chain is slack.
///
/// The closure of the chain is positive in the two motions across it and leaves the motion of the four-bar free, which is finite; but the configurations are a horn of two dimensions about it.
#[test]
fn a_stretched_chain_to_the_centre_of_curvature_moves_with_two_freedoms() {
    let mut bars = Drawing::on("ground");
    bars.hinge(["ground", "left"], -1.0, 0.0);
    bars.hinge(["left", "coupler"], -0.5, 1.0);
    bars.hinge(["coupler", "right"], 0.5, 1.0);
    bars.hinge(["right", "ground"], 1.0, 0.0);
    // The middle of the coupler has the distance 2/3 − 0.567 x⁴ + … from (0, 1/3), with x its coordinate along the base.
    bars.hinge(["coupler", "a"], 0.0, 1.0);
    bars.hinge(["a", "b"], 0.0, 0.8);
    bars.hinge(["b", "c"], 0.0, 0.5);
    bars.hinge(["c", "ground"], 0.0, 1.0 / 3.0);
    check(bars, 3, 2, &[2]);
}

/// Three bars of length 1 and a base shorter than 3 by ε: the angles stay within about √ε, and the linkage moves all the same.
#[test]
fn four_bars_near_their_stretched_position() {
    for exponent in [4, 6, 8, 10] {
        let gap = 10.0_f64.powi(-exponent);
        let cos = 1.0 - 0.5 * gap;
        let sin = (gap * (1.0 - 0.25 * gap)).sqrt();
        let mut bars = Drawing::on("ground");
        bars.chain("bar", &[[0.0, 0.0], [cos, sin], [3.0 - gap - cos, sin], [3.0 - gap, 0.0]]);
        check(bars, 1, 1, &[]);
    }
    // Stretched, it is a point.
    let mut bars = Drawing::on("ground");
    bars.chain("bar", &[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]);
    check(bars, 2, 0, &[]);
}

#[test]
fn any_permitted_characteristic_length_decides_alike() {
    let mut bars = Drawing::on("ground");
    bars.chain("bar", &[[0.0, 0.0], [0.05, 0.1], [0.25, 0.15], [0.2, 0.0]]);
    let bars = bars.mechanism();
    // The joints of a link are 0.056 to 0.1 m from its middle.
    for length in [1e-5, 1e-4, 1e-2, 1.0, 1e3] {
        let bars = bars.clone().with_characteristic_length(length).unwrap();
        let found = analysed(&bars).finite;
        assert_eq!((found.instantaneous.mobility, found.mobility), (1, Some(1)), "{length}");
    }
    for length in [1e-300, 5e-6, 2e3, 1e11, f64::MAX] {
        let refused = bars.clone().with_characteristic_length(length).unwrap_err();
        let MechanismError::CharacteristicLength { found, min, max } = refused else {
            panic!("{refused}")
        };
        assert_eq!(found, length);
        assert!(5e-6 < min && min < 1e-5 && max == 1e3, "{min} {max}");
    }
}

/// Four axes that meet in one point, but for rounding errors: without another length, these are no size of the mechanism.
#[test]
fn rounding_errors_are_no_size_of_a_mechanism() {
    let axes = [[1.0, 0.0, 0.0], [0.6, 0.3, 0.8], [0.1, 0.7, 0.6], [0.2, 0.95, -0.1]];
    for off in [0.0, 1e-300, 1e-17, 1e-16, 1e-15] {
        let joint = |k: usize, links| {
            let point = [0, 1, 2].map(|i| off * f64::sin((3 * k + i) as f64));
            robot::joint(&format!("J{k}"), JointKind::Revolute, links, point, axes[k])
        };
        let joints = [[0, 1], [1, 2], [2, 3], [0, 3]].into_iter().enumerate();
        let joints = joints.map(|(k, links)| joint(k, links)).collect();
        let linkage = Mechanism::new("spherical", robot::names(4), joints).unwrap();
        let found = analysed(&linkage).finite;
        assert_eq!((found.instantaneous.mobility, found.mobility), (1, Some(1)), "{off}");
        let home = DVector::zeros(4);
        let sparse = SparseSystem::new(&linkage, home).unwrap();
        assert_eq!(sparse.characteristic_length(), 1.0, "{off}");
    }
}

/// Bennett's linkage moves wherever its base is; ten kilometres away, the last digit of its place is more than loops may be open.
#[test]
fn the_place_of_the_base_decides_nothing() {
    for far in [0.0, 1.0, 100.0, 1e3] {
        let linkage = families::bennett_row(1);
        let mut joints = linkage.joints().to_vec();
        for joint in &mut joints {
            for side in 0..2 {
                if joint.links[side] == 0 {
                    joint.frames[side].translation.vector.x += far;
                    joint.frames[side].translation.vector.y += 0.3 * far;
                }
            }
        }
        let moved = Mechanism::new("Bennett", linkage.links().to_vec(), joints).unwrap();
        let closed = assemble(&moved, &guess(&moved), &[], 0).unwrap();
        let system = MechanismSystem::new(&moved, closed.coordinates).unwrap();
        let found = mechanism_mobility(&system, RANK_THRESHOLD, OpenLoops::Refused).unwrap().finite;
        assert_eq!((found.instantaneous.mobility, found.mobility), (1, Some(1)), "{far}");
    }
}

fn sparse(mechanism: &Mechanism) -> SparseMobility {
    let home = DVector::zeros(mechanism.joint_freedoms());
    SparseSystem::new(mechanism, home).unwrap().mobility(RANK_THRESHOLD).unwrap()
}

/// All freedoms of a tree are motions; a chain and a star of thousands of joints would take hours by elimination.
#[test]
fn trees_of_any_size() {
    for (count, star) in [(3000, false), (9000, true)] {
        let joint = |k: usize| {
            let links = [if star { 0 } else { k }, k + 1];
            let kind = [JointKind::Revolute, JointKind::Cylindrical, JointKind::Fixed][k % 3];
            robot::joint(&format!("j{k}"), kind, links, [0.1 * k as f64, 0.0, 0.0], Z)
        };
        let joints: Vec<Joint> = (0..count).map(joint).collect();
        let tree = Mechanism::new("tree", robot::names(count + 1), joints).unwrap();
        assert_eq!(blocks(&tree).len(), count);
        let found = sparse(&tree);
        assert_eq!((found.mobility, found.finite, found.rank), (count, Some(count), 0));
        assert_eq!(found.motions.len(), count);
        assert_eq!(found.null_space(), None);
    }
}

/// Many loops on one base, two of them flat: each is a block of its own.
#[test]
fn a_row_of_four_bars_with_flat_ones() {
    let row = |count: usize| {
        let mut row = Drawing::on("ground");
        for k in 0..count {
            let x = 4.0 * k as f64;
            let flat = [[x, 0.0], [x + 1.0, 0.0], [x + 3.0, 0.0], [x + 2.0, 0.0]];
            let bent = [[x, 0.0], [x + 0.5, 1.0], [x + 2.5, 1.5], [x + 2.0, 0.0]];
            row.chain(&format!("{k} "), if k < 2 { &flat } else { &bent });
        }
        row
    };
    check(row(21), 23, 21, &[21]);
    // Too large for dense algebra: the same answer.
    let found = sparse(&row(70).mechanism());
    assert_eq!((found.mobility, found.finite, found.redundancy), (72, Some(70), 3 * 70 + 2));
}

#[test]
fn blocks_of_a_graph() {
    let mut drawing = Drawing::on("ground");
    drawing.hinge(["ground", "arm"], 0.0, 0.0);
    // A loop of two links, a loop beyond it that shares a link only, and a hand.
    drawing.hinge(["arm", "plate"], 1.0, 0.0);
    drawing.hinge(["plate", "arm"], 1.0, 0.0);
    drawing.hinge(["plate", "x"], 2.0, 0.0);
    drawing.hinge(["x", "y"], 2.0, 1.0);
    drawing.hinge(["y", "plate"], 2.0, 2.0);
    drawing.hinge(["y", "hand"], 3.0, 2.0);
    let found = blocks(&drawing.mechanism());
    let joints: Vec<&[usize]> = found.iter().map(|block| block.joints.as_slice()).collect();
    assert_eq!(joints, [&[0][..], &[1, 2], &[3, 4, 5], &[6]]);
    assert_eq!(found.iter().map(|block| block.base).collect::<Vec<_>>(), [0, 1, 2, 4]);
}
