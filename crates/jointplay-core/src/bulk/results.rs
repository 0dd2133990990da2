//! Columns of results, as blocks of poses write them.

use pulp::Simd;

use super::Quantity;
use crate::kernel::Lanes;

/// How much is computed of each pose.
///
/// A type, so that a loop over poses is compiled for each: numbers that none of them needs take no registers.
pub(super) trait Extent {
    /// Whether the platform may be needed.
    const PLATFORM: bool;
    /// Whether anything may be needed.
    const ANYTHING: bool;
}

/// The virtual joints, and the residual.
pub(super) struct Joints;
/// Origin, normal and torsion of the platform too.
pub(super) struct OfPlatform;
/// Any quantities.
pub(super) struct Anything;

impl Extent for Joints {
    const PLATFORM: bool = false;
    const ANYTHING: bool = false;
}

impl Extent for OfPlatform {
    const PLATFORM: bool = true;
    const ANYTHING: bool = false;
}

impl Extent for Anything {
    const PLATFORM: bool = true;
    const ANYTHING: bool = true;
}

/// Groups of quantities that are requested; no others are computed.
pub(super) struct Needs {
    pub(super) sides: bool,
    pub(super) displacement: bool,
    pub(super) virtual_displacements: bool,
    pub(super) ball_displacements: bool,
    pub(super) residual: bool,
    pub(super) iterations: bool,
    pub(super) pose: bool,
    pub(super) rotation: bool,
    /// Angles of the tilt, or the height.
    pub(super) coordinates: bool,
    pub(super) azimuth: bool,
    pub(super) tilt_angle: bool,
    pub(super) torsion: bool,
    pub(super) axis_height: bool,
    pub(super) sensitivity: bool,
    /// Whether those of [`Joints`] alone.
    pub(super) only_joints: bool,
    /// Whether those of [`OfPlatform`] alone.
    pub(super) only_platform: bool,
}

impl Needs {
    pub(super) fn of(wanted: &[(Quantity, &mut [f64])]) -> Self {
        let any = |asked: fn(Quantity) -> bool| wanted.iter().any(|(quantity, _)| asked(*quantity));
        let azimuth = any(|q| q == Quantity::Azimuth);
        let tilt_angle = any(|q| q == Quantity::TiltAngle);
        let torsion = any(|q| q == Quantity::Torsion);
        let axis_height = any(|q| q == Quantity::AxisHeight);
        let pose = any(|q| matches!(q, Quantity::Origin(_) | Quantity::Normal(_)));
        let rotation = any(|q| matches!(q, Quantity::Rotation(..)));
        let coordinates = azimuth || tilt_angle || axis_height;
        Self {
            sides: any(|q| matches!(q, Quantity::Side(_))),
            displacement: any(|q| q == Quantity::Displacement),
            virtual_displacements: any(|q| matches!(q, Quantity::VirtualDisplacement(_))),
            ball_displacements: any(|q| matches!(q, Quantity::BallDisplacement(_))),
            residual: any(|q| q == Quantity::Residual),
            iterations: any(|q| q == Quantity::Iterations),
            pose: pose || coordinates || torsion || rotation,
            rotation,
            coordinates,
            azimuth,
            tilt_angle,
            torsion,
            axis_height,
            sensitivity: any(|q| matches!(q, Quantity::Sensitivity(_))),
            only_joints: !any(|q| !is_of_joints(q)),
            only_platform: !any(|q| {
                use Quantity::{Normal, Origin, Torsion};
                !is_of_joints(q) && !matches!(q, Origin(_) | Normal(_) | Torsion)
            }),
        }
    }
}

fn is_of_joints(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::VirtualJoint(_) | Quantity::Residual)
}

/// Places for the values of all quantities.
pub(super) const PLACES: usize = 43;

/// Index of the value of a quantity among those of a block.
#[inline(always)]
pub(super) fn place(quantity: Quantity) -> usize {
    match quantity {
        Quantity::VirtualJoint(joint) => joint,
        Quantity::Side(side) => 6 + side,
        Quantity::Origin(axis) => 9 + axis,
        Quantity::Normal(axis) => 12 + axis,
        Quantity::Sensitivity(index) => 15 + index,
        Quantity::Azimuth => 18,
        Quantity::TiltAngle => 19,
        Quantity::Torsion => 20,
        Quantity::AxisHeight => 21,
        Quantity::Displacement => 22,
        Quantity::Residual => 23,
        Quantity::Iterations => 24,
        Quantity::BallDisplacement(ball) => 25 + ball,
        Quantity::VirtualDisplacement(joint) => 28 + joint,
        Quantity::Rotation(row, column) => 34 + 3 * row + column,
    }
}

/// Columns of registers, one for each place; empty where nothing is wanted.
pub(super) struct Results<'c, S: Simd> {
    columns: [&'c mut [S::f64s]; PLACES],
}

/// The registers of one block of poses.
pub(super) struct Block<'r, 'c, S: Simd> {
    results: &'r mut Results<'c, S>,
    block: usize,
}

impl<'c, S: Simd> Results<'c, S> {
    /// Registers of the columns that are wanted; of a quantity that is wanted more than once, of the first.
    pub(super) fn new(wanted: &'c mut [(Quantity, &mut [f64])]) -> Self {
        let mut columns: [&mut [S::f64s]; PLACES] = std::array::from_fn(|_| &mut [][..]);
        let mut seen = [false; PLACES];
        for (quantity, column) in wanted {
            let place = place(*quantity);
            if !std::mem::replace(&mut seen[place], true) {
                (columns[place], _) = S::as_mut_simd_f64s(column);
            }
        }
        Self { columns }
    }

    /// One register for each quantity.
    pub(super) fn one(registers: &'c mut [S::f64s; PLACES]) -> Self {
        Self { columns: registers.each_mut().map(std::slice::from_mut) }
    }

    #[inline(always)]
    pub(super) fn block(&mut self, block: usize) -> Block<'_, 'c, S> {
        Block { results: self, block }
    }
}

impl<S: Simd> Block<'_, '_, S> {
    #[inline(always)]
    pub(super) fn put(&mut self, quantity: Quantity, value: Lanes<S>) {
        if let Some(register) = self.results.columns[place(quantity)].get_mut(self.block) {
            *register = value.register();
        }
    }
}

/// Copies the first column of each quantity that is wanted more than once to its others.
pub(super) fn repeat(wanted: &mut [(Quantity, &mut [f64])], poses: usize) {
    let mut first = [None; PLACES];
    for k in 0..wanted.len() {
        let (before, from_here) = wanted.split_at_mut(k);
        let (quantity, column) = &mut from_here[0];
        match first[place(*quantity)] {
            None => first[place(*quantity)] = Some(k),
            Some(first) => column[..poses].copy_from_slice(&before[first].1[..poses]),
        }
    }
}
