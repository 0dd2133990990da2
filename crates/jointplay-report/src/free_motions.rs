//! Report on motions that commands leave free.

use std::fmt;

use jointplay_core::Error;
use jointplay_core::mechanism::{FreeMotion, Mechanism, free_motions};
use jointplay_format::place::listed;
use nalgebra::DVector;

/// Motions other than spins that a text lists.
const MOST_LISTED: usize = 4;

/// Independent motions of the same joints that the commands do not determine.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct FreeMotionReport {
    /// Number of the motions.
    pub count: usize,
    /// Names of the links that move.
    pub links: Vec<String>,
    /// Names of the joints that move.
    pub joints: Vec<String>,
    /// Whether it is the turn of a link between two balls about the line through them.
    pub is_spin: bool,
}

/// Motions that commands leave free, in groups that share no joint; as text, the first of them.
#[derive(Debug, Clone, Default, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[serde(transparent)]
pub struct FreeMotionsReport(pub Vec<FreeMotionReport>);

impl FreeMotionsReport {
    /// The motions of [`free_motions`] with the names of their links and joints.
    ///
    /// # Arguments
    /// * `coordinates` – (f + M) of a closed configuration (m, rad)
    /// * `held` – indices of the commanded joint coordinates
    ///
    /// # Errors
    /// Those of [`free_motions`].
    pub fn new(
        mechanism: &Mechanism,
        coordinates: &DVector<f64>,
        held: &[usize],
    ) -> Result<Self, Error> {
        let report = |motion: FreeMotion| FreeMotionReport {
            count: motion.count,
            links: motion.links.iter().map(|&k| mechanism.links()[k].clone()).collect(),
            joints: motion.joints.iter().map(|&k| mechanism.joints()[k].name.clone()).collect(),
            is_spin: motion.is_spin,
        };
        let motions = free_motions(mechanism, coordinates, held)?;
        Ok(Self(motions.into_iter().map(report).collect()))
    }

    /// Number of motions in all groups.
    #[must_use]
    pub fn count(&self) -> usize {
        self.0.iter().map(|motion| motion.count).sum()
    }

    /// The text of an error: who leaves them free, and what to do.
    ///
    /// # Arguments
    /// * `commands` – what is held, such as `drives`
    /// * `remedy` – what to do for motions that are no spins
    #[must_use]
    pub fn explained(&self, commands: &str, remedy: &str) -> String {
        let count = self.count();
        let plural = if count == 1 { "" } else { "s" };
        let remedy = if self.0.iter().all(|motion| motion.is_spin) {
            "make one of the two balls of each a universal joint, whose axes are perpendicular to the line through the balls"
        } else {
            remedy
        };
        format!("the {commands} leave {count} motion{plural} free: {self}; {remedy}")
    }
}

impl fmt::Display for FreeMotionsReport {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (spins, others): (Vec<_>, Vec<_>) = self.0.iter().partition(|motion| motion.is_spin);
        let mut texts = Vec::new();
        let spinning: Vec<String> = spins.iter().flat_map(|spin| spin.links.clone()).collect();
        match spinning.len() {
            0 => {}
            1 => texts.push(format!("the spin of {} between two balls", listed(&spinning))),
            _ => texts.push(format!("the spins of {} between two balls", listed(&spinning))),
        }
        texts.extend(others.iter().take(MOST_LISTED).map(|motion| {
            let (links, joints) = (listed(&motion.links), listed(&motion.joints));
            match motion.count {
                1 => format!("a motion of {links} by {joints}"),
                count => format!("{count} motions of {links} by {joints}"),
            }
        }));
        if others.len() > MOST_LISTED {
            texts.push(format!("{} more", others.len() - MOST_LISTED));
        }
        to.write_str(&texts.join("; "))
    }
}
