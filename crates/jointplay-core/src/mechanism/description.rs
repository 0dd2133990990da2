//! Description of a mechanism by the user.

use nalgebra::{Unit, Vector3};

use super::JointKind;
use super::attached_frame::AttachedFrame;
use super::coupling::Coupling;
use super::mechanism_error::MechanismError;
use crate::spatial::Pose;

/// Most links of a mechanism, so that an erroneous file is refused instead of computed for hours.
pub const MAX_LINKS: usize = 10_000;

/// Largest ratio of a characteristic length to the distances of the joints, and of them to it: beyond, the weight of angles or of lengths is that of rounding errors.
const MAX_LENGTH_RATIO: f64 = 1e4;

/// Longest characteristic length of mechanisms of any size (m): distances may be those of tolerances alone, as of joints whose axes nearly meet in one point.
const ALWAYS_PERMITTED_LENGTH: f64 = 1e3;

/// Free travel or stiffness of a joint in the directions that it should hold still.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LinearAndAngular {
    /// Along a direction: clearance (m) or stiffness (N/m).
    pub linear: Option<f64>,
    /// About a direction: clearance (rad) or stiffness (N m/rad).
    pub angular: Option<f64>,
}

/// A joint between two links.
///
/// ```text
///    from_from_to  =  frames[0] · T(q) · frames[1]⁻¹        T(q): the motion of the kind, identity at q = 0
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, unique among the joints.
    pub name: String,
    /// Kind: the motions that it allows.
    pub kind: JointKind,
    /// Indices of its links; positive coordinates move the second against the first.
    pub links: [usize; 2],
    /// The joint frame in the frame of each link (m).
    pub frames: [Pose; 2],
    /// Whether a motor drives it.
    pub actuated: bool,
    /// Start of the search for a closed configuration, a number for each freedom (m, rad); empty for zeros.
    pub guess: Vec<f64>,
    /// Least and greatest value of each freedom, infinite at an end without limit (m, rad); empty where there are none.
    pub limits: Vec<[f64; 2]>,
    /// Free travel, where known.
    pub clearance: LinearAndAngular,
    /// Stiffness, where known.
    pub stiffness: LinearAndAngular,
}

/// An imagined freedom of a joint, which play or elasticity supplies.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualJoint {
    /// Name, unique among joints and virtual joints.
    pub name: String,
    /// Index of the joint that has it.
    pub joint: usize,
    /// The link of the joint that carries it.
    pub carrier: Carrier,
    /// Its motion, in the frame of the link that carries it.
    pub motion: VirtualMotion,
    /// Largest displacement in either direction (m or rad); `None` where not known.
    pub clearance: Option<f64>,
    /// Stiffness (N/m or N m/rad) that weighs it in place of the characteristic length; `None` where not known.
    pub stiffness: Option<f64>,
}

/// The link of a joint that a virtual joint moves with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carrier {
    /// The first link of the joint.
    First,
    /// The second link of the joint.
    Second,
}

/// The motion of a virtual joint: of its joint's place on the carrying link, in that link's frame.
///
/// Several on one side are stacked in the order given, the first nearest the carrying link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VirtualMotion {
    /// Along a direction.
    Slide(Unit<Vector3<f64>>),
    /// About an axis.
    Turn {
        /// Direction of the axis.
        axis: Unit<Vector3<f64>>,
        /// A point of it (m).
        point: Vector3<f64>,
    },
}

/// Links and joints, with any number of loops, the virtual joints that relieve them, couplings of joints, and frames attached to links.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    name: String,
    links: Vec<String>,
    joints: Vec<Joint>,
    virtual_joints: Vec<VirtualJoint>,
    pub(super) couplings: Vec<Coupling>,
    pub(super) frames: Vec<AttachedFrame>,
    pub(super) characteristic_length: Option<f64>,
}

impl Mechanism {
    /// A mechanism without virtual joints; the first link is the base.
    ///
    /// # Errors
    /// [`MechanismError`].
    pub fn new(
        name: impl Into<String>,
        links: Vec<String>,
        joints: Vec<Joint>,
    ) -> Result<Self, MechanismError> {
        let name = name.into();
        let mechanism = Self {
            name,
            links,
            joints,
            virtual_joints: Vec::new(),
            couplings: Vec::new(),
            frames: Vec::new(),
            characteristic_length: None,
        };
        mechanism.check_links()?;
        mechanism.joints.iter().try_for_each(check_joint)?;
        mechanism.check_names()?;
        Ok(mechanism)
    }

    /// The same mechanism with these joints in place of its own, the indices of which its virtual joints and couplings keep.
    ///
    /// # Errors
    /// [`MechanismError`].
    pub fn with_joints(self, joints: Vec<Joint>) -> Result<Self, MechanismError> {
        let Self { name, links, virtual_joints, couplings, frames, characteristic_length, .. } =
            self;
        let changed = Self::new(name, links, joints)?
            .with_virtual_joints(virtual_joints)?
            .with_couplings(couplings)?
            .with_frames(frames)?;
        match characteristic_length {
            Some(length) => changed.with_characteristic_length(length),
            None => Ok(changed),
        }
    }

    /// The same mechanism with these virtual joints in place of its own.
    ///
    /// # Errors
    /// [`MechanismError`].
    pub fn with_virtual_joints(
        mut self,
        virtual_joints: Vec<VirtualJoint>,
    ) -> Result<Self, MechanismError> {
        for virtual_joint in &virtual_joints {
            let VirtualJoint { name, joint, clearance, stiffness, .. } = virtual_joint;
            if *joint >= self.joints.len() {
                let joints = self.joints.len();
                return Err(MechanismError::NoSuchJoint {
                    name: name.clone(),
                    joint: *joint,
                    joints,
                });
            }
            positive("the clearance", name, *clearance)?;
            positive("the stiffness", name, *stiffness)?;
        }
        self.virtual_joints = virtual_joints;
        self.check_names()?;
        Ok(self)
    }

    /// The same mechanism with this characteristic length, by which angles are weighed against lengths (m).
    ///
    /// # Errors
    /// [`MechanismError::NotPositive`]; [`MechanismError::CharacteristicLength`] for one that is shorter than a ten-thousandth of the distances of the joints of a link, or longer than 10 000 times these and than 1 km.
    pub fn with_characteristic_length(mut self, length: f64) -> Result<Self, MechanismError> {
        positive("the characteristic length", &self.name, Some(length))?;
        let spread = self.joint_spread(&self.joint_middles());
        let [min, max] =
            [spread / MAX_LENGTH_RATIO, (spread * MAX_LENGTH_RATIO).max(ALWAYS_PERMITTED_LENGTH)];
        if !(min..=max).contains(&length) {
            return Err(MechanismError::CharacteristicLength { found: length, min, max });
        }
        self.characteristic_length = Some(length);
        Ok(self)
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Names of its links, the base first.
    #[must_use]
    pub fn links(&self) -> &[String] {
        &self.links
    }

    /// Its joints.
    #[must_use]
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Its virtual joints.
    #[must_use]
    pub fn virtual_joints(&self) -> &[VirtualJoint] {
        &self.virtual_joints
    }

    /// The length by which the user weighs angles against lengths, if one was given (m).
    #[must_use]
    pub fn characteristic_length(&self) -> Option<f64> {
        self.characteristic_length
    }

    /// Middle of the joints of each link, in its own frame (m).
    pub(super) fn joint_middles(&self) -> Vec<Vector3<f64>> {
        let mut sums = vec![(Vector3::zeros(), 0.0); self.links.len()];
        for joint in &self.joints {
            for side in 0..2 {
                let (sum, count) = &mut sums[joint.links[side]];
                *sum += joint.frames[side].translation.vector;
                *count += 1.0;
            }
        }
        sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { sum }).collect()
    }

    /// Root mean square distance of the joints from the middles of their links, or 1 m, by [`default_length`].
    pub(super) fn joint_spread(&self, middles: &[Vector3<f64>]) -> f64 {
        let (mut sum, mut count, mut largest) = (0.0, 0.0, 0.0_f64);
        for joint in &self.joints {
            for side in 0..2 {
                let point = joint.frames[side].translation.vector;
                sum += (point - middles[joint.links[side]]).norm_squared();
                count += 1.0;
                largest = largest.max(point.amax());
            }
        }
        default_length(f64::sqrt(sum / count), largest)
    }

    /// Index of a joint by its name.
    #[must_use]
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// Index of a link by its name.
    #[must_use]
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link == name)
    }

    /// Σ f_j: freedoms of all joints.
    #[must_use]
    pub fn joint_freedoms(&self) -> usize {
        self.joints.iter().map(|joint| joint.kind.freedoms()).sum()
    }

    /// Indices of the coordinates of the actuated joints.
    #[must_use]
    pub fn actuated_coordinates(&self) -> Vec<usize> {
        let joints = self.joints.iter();
        let actuated =
            joints.flat_map(|joint| std::iter::repeat_n(joint.actuated, joint.kind.freedoms()));
        actuated.enumerate().filter_map(|(k, actuated)| actuated.then_some(k)).collect()
    }

    /// Number of independent loops: joints − links + 1.
    #[must_use]
    pub fn loops(&self) -> usize {
        self.joints.len() + 1 - self.links.len()
    }

    /// Freedoms by the Kutzbach–Grübler count, less one for each coupling.
    #[must_use]
    pub fn kutzbach_mobility(&self) -> i64 {
        let freedoms: Vec<usize> = self.joints.iter().map(|joint| joint.kind.freedoms()).collect();
        let couplings = i64::try_from(self.couplings.len()).unwrap_or(i64::MAX / 16);
        crate::mobility::kutzbach_mobility(self.links.len(), &freedoms) - couplings
    }

    /// Number of equations between the joint coordinates: six for each loop and one for each coupling.
    #[must_use]
    pub fn constraints(&self) -> usize {
        6 * self.loops() + self.couplings.len()
    }

    fn check_links(&self) -> Result<(), MechanismError> {
        if self.joints.is_empty() || self.links.is_empty() {
            return Err(MechanismError::NoJoints);
        }
        let links = self.links.len();
        if links > MAX_LINKS {
            return Err(MechanismError::TooManyLinks { found: links, allowed: MAX_LINKS });
        }
        let mut neighbours = vec![Vec::new(); links];
        for joint in &self.joints {
            let name = &joint.name;
            if let Some(&link) = joint.links.iter().find(|&&link| link >= links) {
                return Err(MechanismError::NoSuchLink { joint: name.clone(), link, links });
            }
            let [first, second] = joint.links;
            if first == second {
                let link = self.links[first].clone();
                return Err(MechanismError::JoinedToItself { joint: name.clone(), link });
            }
            neighbours[first].push(second);
            neighbours[second].push(first);
        }
        let (mut reached, mut open) = (vec![false; links], vec![0]);
        reached[0] = true;
        while let Some(link) = open.pop() {
            for &neighbour in &neighbours[link] {
                if !std::mem::replace(&mut reached[neighbour], true) {
                    open.push(neighbour);
                }
            }
        }
        match reached.iter().position(|&reached| !reached) {
            None => Ok(()),
            Some(link) => Err(MechanismError::Dangling {
                link: self.links[link].clone(),
                base: self.links[0].clone(),
            }),
        }
    }

    pub(super) fn check_names(&self) -> Result<(), MechanismError> {
        let joints = self.joints.iter().map(|joint| &joint.name);
        let virtual_joints = self.virtual_joints.iter().map(|joint| &joint.name);
        let frames = self.frames.iter().map(|frame| &frame.name);
        let couplings = self.couplings.iter().map(|coupling| &coupling.name);
        let found = twice(self.links.iter().chain(frames))
            .or_else(|| twice(joints.chain(virtual_joints).chain(couplings)));
        found.map_or(Ok(()), |name| Err(MechanismError::NameTwice { name }))
    }
}

/// The characteristic length where none is given: the distance of the joints, or 1 m where all are in one point, to rounding errors or to the size of an atom, since no length matters there.
///
/// # Arguments
/// * `spread` – root mean square distance of the joints from a middle (m)
/// * `largest` – largest coordinate of a joint (m)
pub(super) fn default_length(spread: f64, largest: f64) -> f64 {
    if spread > (1e-12 * largest).max(1e-10) { spread } else { 1.0 }
}

/// The first name that was there before.
fn twice<'a>(mut names: impl Iterator<Item = &'a String>) -> Option<String> {
    let mut seen = std::collections::BTreeSet::new();
    names.find(|name| !seen.insert(*name)).cloned()
}

fn check_joint(joint: &Joint) -> Result<(), MechanismError> {
    let name = &joint.name;
    let freedoms = joint.kind.freedoms();
    let finite = |what, value: f64| {
        if value.is_finite() {
            Ok(())
        } else {
            Err(MechanismError::NotFinite { what, name: name.clone(), value })
        }
    };
    for frame in &joint.frames {
        frame.to_homogeneous().iter().try_for_each(|&value| finite("the frame", value))?;
    }
    if let JointKind::Helical { lead } = joint.kind {
        finite("the lead", lead)?;
    }
    joint.guess.iter().try_for_each(|&value| finite("the guess", value))?;
    let limits = joint.limits.iter().flatten();
    limits.filter(|value| value.is_nan()).try_for_each(|&value| finite("a limit", value))?;
    for (what, found) in [("the guess", joint.guess.len()), ("the limits", joint.limits.len())] {
        if found != 0 && found != freedoms {
            let name = name.clone();
            return Err(MechanismError::CountMismatch { what, name, found, expected: freedoms });
        }
    }
    if let Some(&[min, max]) = joint.limits.iter().find(|[min, max]| min >= max) {
        return Err(MechanismError::LimitsReversed { name: name.clone(), min, max });
    }
    for value in [joint.clearance.linear, joint.clearance.angular] {
        positive("the clearance", name, value)?;
    }
    for value in [joint.stiffness.linear, joint.stiffness.angular] {
        positive("the stiffness", name, value)?;
    }
    Ok(())
}

fn positive(what: &'static str, name: &str, value: Option<f64>) -> Result<(), MechanismError> {
    match value {
        Some(value) if !value.is_finite() => {
            Err(MechanismError::NotFinite { what, name: name.to_owned(), value })
        }
        Some(value) if value <= 0.0 => {
            Err(MechanismError::NotPositive { what, name: name.to_owned(), value })
        }
        _ => Ok(()),
    }
}
