//! The three-rod robot as a mechanism of links and joints.

use nalgebra::{Unit, Vector3};

use super::Gpr;
use crate::mechanism::{
    Carrier, Joint, JointKind, LinearAndAngular, Mechanism, VirtualJoint, VirtualMotion,
};
use crate::spatial::Pose;
use crate::virtualization::BuiltIn;

impl Gpr {
    /// The robot as five links, three prismatic and three spherical joints, without virtual joints.
    ///
    /// The coordinate of a rod is its length less the working height. The link frames are those of the robot: the base frame, and the platform frame in O_p.
    /// Limits of the rods and the clearance of the balls are those of the robot; a mechanism has no limit of the tilt.
    ///
    /// # Arguments
    /// * `name` – name of the mechanism
    #[must_use]
    pub fn to_mechanism(&self, name: &str) -> Mechanism {
        let links = ["base", "rod 1", "rod 2", "rod 3", "platform"].map(str::to_owned).to_vec();
        let height = self.working_height();
        let rods = (0..3).map(|k| Joint {
            actuated: true,
            limits: vec![[self.limits().rod_min - height, self.limits().rod_max - height]],
            ..joint(
                format!("rod {}", k + 1),
                JointKind::Prismatic,
                [0, k + 1],
                [self.base_points()[k].push(height); 2],
            )
        });
        let balls = (0..3).map(|k| Joint {
            clearance: LinearAndAngular { linear: self.ball_clearance(), angular: None },
            ..joint(
                format!("S{}", k + 1),
                JointKind::Spherical,
                [k + 1, 4],
                [self.base_points()[k].push(height), self.platform().sockets()[k].push(0.0)],
            )
        });
        let joints = rods.chain(balls).collect();
        Mechanism::new(name, links, joints)
            .and_then(|mechanism| {
                mechanism.with_characteristic_length(self.platform().mean_radius())
            })
            .expect("a robot within its ranges is a mechanism")
    }

    /// The robot as a mechanism, with the virtual joints of a virtualization at the sockets, which are zero at the nominal sockets.
    ///
    /// `None` for [`BuiltIn::Offset`]: no virtual joint of a mechanism is a displacement in polar coordinates.
    #[must_use]
    pub fn to_relieved_mechanism(&self, name: &str, virtualization: BuiltIn) -> Option<Mechanism> {
        let mut virtual_joints = Vec::new();
        for k in 0..3 {
            for (symbol, motion) in self.virtual_motions(k, virtualization)? {
                virtual_joints.push(VirtualJoint {
                    name: format!("{symbol}{}", k + 1),
                    joint: 3 + k,
                    carrier: Carrier::Second,
                    motion,
                    clearance: None,
                    stiffness: None,
                });
            }
        }
        let relieved = self.to_mechanism(name).with_virtual_joints(virtual_joints);
        Some(relieved.expect("virtual joints at the balls, with names of their own"))
    }

    /// Motions of a socket in the platform frame, with their symbols.
    fn virtual_motions(
        &self,
        k: usize,
        virtualization: BuiltIn,
    ) -> Option<Vec<(&'static str, VirtualMotion)>> {
        let radial = Unit::new_normalize(self.platform().directions()[k].push(0.0));
        let slide = ("l", VirtualMotion::Slide(radial));
        match virtualization {
            BuiltIn::Radial => Some(vec![slide]),
            BuiltIn::Polar => {
                let turn = VirtualMotion::Turn { axis: Vector3::z_axis(), point: Vector3::zeros() };
                Some(vec![("phi", turn), slide])
            }
            BuiltIn::Planar => Some(vec![
                ("x", VirtualMotion::Slide(Vector3::x_axis())),
                ("y", VirtualMotion::Slide(Vector3::y_axis())),
            ]),
            BuiltIn::Offset => None,
        }
    }
}

/// A joint with its place on each of its links, and its axis along z.
fn joint(name: String, kind: JointKind, links: [usize; 2], points: [Vector3<f64>; 2]) -> Joint {
    Joint {
        name,
        kind,
        links,
        frames: points.map(Pose::from),
        actuated: false,
        guess: Vec::new(),
        limits: Vec::new(),
        clearance: LinearAndAngular::default(),
        stiffness: LinearAndAngular::default(),
    }
}
