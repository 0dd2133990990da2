//! Postures of an arm along a whole path of its wafer: redundancy and branch are resolved for the path, not for each of its points.

use std::array::from_fn;

use super::decomposition::Decomposition;
use super::posture_path::{NoPosturePath, PlanarPath, PosturePath};
use super::posture_search::{Posture, PostureCandidate, PostureSearch};
use super::posture_smoothing::Smoothing;
use crate::robot::arm_chain::ArmChain;
use crate::robot::hybrid_robot::{EffectorId, HybridRobot};

/// Number of intervals that one interval of the search is divided into for smoothing.
const REFINEMENT: usize = 2;

impl HybridRobot {
    /// Whether [`Self::posture_candidates`] follows lines of an arm: an arm whose free motor is a slide has none with a prescribed heading.
    pub(crate) fn plans_postures(&self, id: EffectorId, prescribes_heading: bool) -> bool {
        let chain = ArmChain::new(self, id);
        chain.axes().len() > 2
            && Decomposition::new(&chain).is_some_and(|it| it.is_closed(prescribes_heading))
    }

    /// Whether an arm can hold its wafer at a point in several postures that a path connects: it has motors to spare, or a pair of links with two elbows and a heading to keep.
    pub(crate) fn has_posture_paths(&self, id: EffectorId) -> bool {
        let chain = ArmChain::new(self, id);
        chain.axes().len() > 2 && Decomposition::new(&chain).is_some()
    }

    /// Postures of an arm along a path of its wafer's centre in the arm's plane, without a jump and within limits: a candidate for each first posture that is better than its neighbours, the cheapest first.
    ///
    /// ```text
    ///    min ∫ Σ_a (q_a′/v_a)² + c (q_a″/v_a)² + w Σ_a 1/(1 − u_a²) + w/sin² β ds
    /// ```
    /// v: velocity limit of an axis, u: its position, from −1 at one limit to 1 at the other, β: the elbow angle. The first posture is free, at a small cost for its distance from home, which is added; the axes that turn the whole arm do not contribute to that distance.
    /// The shortest paths through a grid of free angles, elbows and revolutions minimize the cost without the term of curvature, over steps between neighbouring cells of the grid.
    /// First postures of other elbows, and of other revolutions, are no neighbours: each that has a path has one here.
    ///
    /// # Errors
    /// [`NoPosturePath`] where no grid path exists.
    ///
    /// # Panics
    /// The effector does not exist, or the arm has no closed form; see [`Self::has_posture_paths`].
    pub(crate) fn posture_candidates(
        &self,
        id: EffectorId,
        path: &PlanarPath,
    ) -> Result<Vec<PostureCandidate>, NoPosturePath> {
        let chain = ArmChain::new(self, id);
        let decomposition = Decomposition::new(&chain).expect("the arm has a closed form");
        PostureSearch::new(self, &chain, &decomposition, path).shortest_paths()
    }

    /// As [`Self::posture_candidates`], on a finer grid, which finds paths through narrower passages.
    ///
    /// # Errors
    /// As [`Self::posture_candidates`].
    ///
    /// # Panics
    /// As [`Self::posture_candidates`].
    pub(crate) fn fine_posture_candidates(
        &self,
        id: EffectorId,
        path: &PlanarPath,
    ) -> Result<Vec<PostureCandidate>, NoPosturePath> {
        let chain = ArmChain::new(self, id);
        let decomposition = Decomposition::new(&chain).expect("the arm has a closed form");
        PostureSearch::new(self, &chain, &decomposition, path).finer().shortest_paths()
    }

    /// Positions of an arm's motors along a path, by a descent of the whole cost of [`Self::posture_candidates`] from one of them.
    ///
    /// # Panics
    /// As [`Self::posture_candidates`].
    pub(crate) fn posture_path(
        &self,
        id: EffectorId,
        path: &PlanarPath,
        candidate: &PostureCandidate,
    ) -> PosturePath {
        let chain = ArmChain::new(self, id);
        let decomposition = Decomposition::new(&chain).expect("the arm has a closed form");
        let search = PostureSearch::new(self, &chain, &decomposition, path);
        smoothed(&search, &candidate.postures)
    }
}

/// The path with smooth free angles, on a finer grid of samples where all of them can be reached.
fn smoothed(search: &PostureSearch<'_>, found: &[Posture]) -> PosturePath {
    let postures = refined(search, found).unwrap_or_else(|| found.to_vec());
    let last = (postures.len() - 1) as f64;
    let fractions: Vec<f64> = (0..postures.len()).map(|k| k as f64 / last).collect();
    let mut smoothing = Smoothing { search, fractions: &fractions, postures };
    smoothing.run();
    let postures = smoothing.postures.iter();
    let positions = postures.map(|it| it.arm_positions[..search.ranges.count].to_vec()).collect();
    PosturePath { fractions, positions }
}

/// Postures with others between them, their free angles interpolated.
fn refined(search: &PostureSearch<'_>, found: &[Posture]) -> Option<Vec<Posture>> {
    let count = search.intervals * REFINEMENT;
    let mut refined = vec![found[0]];
    for k in 1..=count {
        let (at, t) = (k / REFINEMENT, (k % REFINEMENT) as f64 / REFINEMENT as f64);
        let from = &found[at];
        let next = found.get(at + 1).unwrap_or(from);
        let free = from_fn(|f| from.free[f] + t * (next.unknown[2 + f] - from.unknown[2 + f]));
        let seed = refined[k - 1];
        let posture = search.posture_near(k as f64 / count as f64, free, &seed)?;
        search.is_continuous(&seed, &posture).then(|| refined.push(posture))?;
    }
    Some(refined)
}
