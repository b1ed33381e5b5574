use super::Target;
use super::descent::Descent;
use super::nearest::{self, distance};
use super::starts::{EvenPoints, range};
use crate::robot::{Chain, ChainJoint, Limits, PositionsError};
use nalgebra::{IsometryMatrix3, Vector6};
use thiserror::Error;

/// The task error that counts as reached, as a fraction of the largest length involved (of at least one metre).
const TOLERANCE: f64 = 1e-12;
/// Steps downhill from each starting place.
const STEPS: usize = 100;
/// Steps downhill from the best place when none led to the target, to know the distance well.
const LAST_STEPS: usize = 2000;

/// Why a search could not begin.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SearchError {
    /// The configuration to stay near does not fit the chain.
    #[error("the configuration to stay near: {0}")]
    Near(#[from] PositionsError),
    /// The target, or the position of a held joint, has an infinite or NaN component.
    #[error("the target, or the position of a held joint, is not a finite number")]
    Target,
}

/// How joint positions for a [`Target`] are looked for: from where, how often, and near what.
///
/// The descent is a Levenberg-Marquardt method with the limits as bounds. It begins where the joints should stay near,
/// then at places spread evenly over the limits; the same search always gives the same answer. Of the first few
/// solutions the one nearest to that configuration is taken, drawn nearer still along the self-motion of a redundant
/// arm. Nothing here proves a target out of reach: a search that fails has tried its starts.
///
/// ```
/// use kinstep::inverse::{Search, Target};
/// use kinstep::nalgebra::Vector3;
/// use kinstep::robot::embedded;
///
/// let chain = embedded::get("panda")?.chain("panda_link0", "panda_hand_tcp")?;
/// let down = -Vector3::z_axis();
/// let solution = Search::new().solve(&chain, &Target::axis(Vector3::new(0.5, 0.1, 0.2), down))?;
/// assert!(solution.is_found() && chain.within_limits(&solution.q));
/// let tip = chain.forward(&solution.q, &mut chain.scratch()).position();
/// assert!((tip - Vector3::new(0.5, 0.1, 0.2)).norm() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Search {
    starts: usize,
    solutions: usize,
    seed: u64,
    near: Option<Vec<f64>>,
    held: Vec<(usize, f64)>,
    keeps_limits: bool,
}

impl Default for Search {
    fn default() -> Self {
        Self { starts: 100, solutions: 8, seed: 0, near: None, held: Vec::new(), keeps_limits: true }
    }
}

/// Where a search ended: at the target, or as near to it as it came.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution {
    /// Joint positions [rad or m], one per joint of the chain.
    pub q: Vec<f64>,
    /// The pose of the tip at these joint positions.
    pub tip: IsometryMatrix3<f64>,
    /// The task error at these joint positions (linear \[m\]; angular \[rad\]).
    pub error: Vector6<f64>,
    /// How many starting places were tried.
    pub starts: usize,
    is_found: bool,
}

impl Solution {
    /// Returns whether the tip is at the target, as far as the arithmetic allows.
    pub fn is_found(&self) -> bool {
        self.is_found
    }

    /// The norm of the task error.
    pub fn distance(&self) -> f64 {
        self.error.norm()
    }

    /// The distance of the tip from the target's position \[m\].
    pub fn position_error(&self) -> f64 {
        self.error.fixed_rows::<3>(0).norm()
    }

    /// The angle between the tip's orientation, or axis, and the target's \[rad\].
    pub fn orientation_error(&self) -> f64 {
        self.error.fixed_rows::<3>(3).norm()
    }
}

impl Search {
    /// Returns a search from 100 places within the limits, near their middle.
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the search from at most so many starting places (at least one).
    #[must_use]
    pub fn starts(mut self, starts: usize) -> Self {
        self.starts = starts.max(1);
        self
    }

    /// Returns the search that ends as soon as it has so many solutions to choose from (at least one, 8 unless given).
    #[must_use]
    pub fn solutions(mut self, solutions: usize) -> Self {
        self.solutions = solutions.max(1);
        self
    }

    /// Returns the search from other starting places, which the seed chooses.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// Returns the search for joint positions near the configuration `q` [rad or m]; unless given, near the middle of
    /// the limits.
    #[must_use]
    pub fn near(mut self, q: &[f64]) -> Self {
        self.near = Some(q.to_vec());
        self
    }

    /// Returns the search with a joint, by its index in the chain, held at a position [rad or m].
    #[must_use]
    pub fn holding(mut self, joint: usize, position: f64) -> Self {
        self.held.push((joint, position));
        self
    }

    /// Returns the search with all joints free to move beyond their limits: a question about geometry alone.
    #[must_use]
    pub fn beyond_limits(mut self) -> Self {
        self.keeps_limits = false;
        self
    }

    /// Looks for joint positions of `chain` that bring its tip to `target`.
    ///
    /// A target that can not be reached is an answer, not an error: [`Solution::is_found`] is false then, and the rest
    /// says how near the tip came.
    ///
    /// # Errors
    /// A configuration to stay near that does not fit the chain, or a number that is not finite.
    pub fn solve(&self, chain: &Chain, target: &Target) -> Result<Solution, SearchError> {
        self.check(chain, target)?;
        let limits = self.limits(chain);
        let near = self.near.clone().unwrap_or_else(|| middle(&limits));
        let near: Vec<f64> = near.iter().zip(&limits).map(|(q, l)| q.clamp(l.lower, l.upper)).collect();
        let reach = Some(chain.reach()).filter(|reach| reach.is_finite()).unwrap_or(0.0);
        let length = target.length().max(reach).max(1.0);
        let mut descent = Descent::new(chain, target, limits, TOLERANCE * length);

        let mut solutions: Vec<Vec<f64>> = Vec::new();
        let mut best = (f64::INFINITY, near.clone());
        let mut starts = 0;
        let places = Places::new(chain, &descent.limits, length, &near, self);
        while starts < self.starts && solutions.len() < self.solutions {
            let mut q = places.get(starts);
            starts += 1;
            if starts == 1 && descent.measure(&q).1.norm() <= descent.tolerance {
                // Already there: joints that need not move do not.
                solutions.push(q);
                break;
            }
            let error = descent.descend(&mut q, STEPS);
            if error <= descent.tolerance {
                nearest::draw(&mut descent, &mut q, &near);
                solutions.push(q);
            } else if error < best.0 {
                best = (error, q);
            }
        }
        let by_distance = |a: &Vec<f64>, b: &Vec<f64>| distance(a, &near).total_cmp(&distance(b, &near));
        let q = solutions.into_iter().min_by(by_distance).unwrap_or_else(|| {
            descent.descend(&mut best.1, LAST_STEPS);
            best.1
        });
        let (tip, error) = descent.measure(&q);
        Ok(Solution { is_found: error.norm() <= descent.tolerance, q, tip, error, starts })
    }

    fn check(&self, chain: &Chain, target: &Target) -> Result<(), SearchError> {
        if !target.is_finite() || self.held.iter().any(|(_, position)| !position.is_finite()) {
            return Err(SearchError::Target);
        }
        self.near.as_ref().map_or(Ok(()), |near| Ok(chain.check_positions(near)?))
    }

    fn limits(&self, chain: &Chain) -> Vec<Limits> {
        let own = |joint: &ChainJoint| if self.keeps_limits { joint.limits } else { Limits::UNLIMITED };
        let mut limits: Vec<Limits> = chain.joints().iter().map(own).collect();
        for &(joint, position) in &self.held {
            if let Some(limits) = limits.get_mut(joint) {
                (limits.lower, limits.upper) = (position, position);
            }
        }
        limits
    }
}

/// The middle of the limits; zero, or the limit nearest to it, where one of them is not known.
fn middle(limits: &[Limits]) -> Vec<f64> {
    let of = |l: &Limits| {
        let both = l.lower.is_finite() && l.upper.is_finite();
        if both { f64::midpoint(l.lower, l.upper) } else { 0.0_f64.clamp(l.lower, l.upper) }
    };
    limits.iter().map(of).collect()
}

/// The starting places of a search: `near` first, then by turns anywhere in the joints' ranges and ever further around `near`.
struct Places<'a> {
    near: &'a [f64],
    ranges: Vec<(f64, f64)>,
    limits: Vec<Limits>,
    points: EvenPoints,
    count: usize,
}

impl<'a> Places<'a> {
    fn new(chain: &Chain, limits: &[Limits], length: f64, near: &'a [f64], search: &Search) -> Self {
        let ranges = chain.joints().iter().zip(limits).map(|(joint, limits)| range(joint, limits, length));
        Self {
            near,
            ranges: ranges.collect(),
            limits: limits.to_vec(),
            points: EvenPoints::new(chain.dof(), search.seed),
            count: search.starts,
        }
    }

    fn get(&self, k: usize) -> Vec<f64> {
        let place = |(i, &(low, high)): (usize, &(f64, f64))| {
            let (point, width) = (self.points.component(k, i), high - low);
            if k % 2 == 1 {
                return low + point * width;
            }
            // The first of these is `near` itself.
            let around = k as f64 / self.count as f64;
            (self.near[i] + around * width * (point - 0.5)).clamp(self.limits[i].lower, self.limits[i].upper)
        };
        self.ranges.iter().enumerate().map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::embedded;
    use nalgebra::Vector3;

    fn planar() -> Chain {
        embedded::get("planar4").unwrap().chain("base", "tip").unwrap()
    }

    #[test]
    fn beyond_the_reach_the_nearest_place_is_the_stretched_arm() {
        // Four unit links towards a point 8 m away.
        let target = Target::position_xy(4.8, 6.4);
        let solution = Search::new().solve(&planar(), &target).unwrap();
        assert!(!solution.is_found());
        assert!((solution.distance() - 4.0).abs() < 1e-9, "{}", solution.distance());
        assert!((solution.tip.translation.vector - Vector3::new(2.4, 3.2, 0.0)).norm() < 1e-4);
        assert_eq!(solution.starts, 100);
    }

    #[test]
    fn joints_that_are_there_already_do_not_move() {
        let q = [0.3, 0.4, -0.5, 0.6];
        let chain = planar();
        let pose = chain.forward(&q, &mut chain.scratch()).pose();
        let solution = Search::new().near(&q).solve(&chain, &Target::pose(&pose)).unwrap();
        assert_eq!((solution.q.as_slice(), solution.starts), (&q[..], 1));
    }

    #[test]
    fn the_answer_is_the_nearest_that_the_self_motion_allows() {
        // Two redundant joints: at the nearest solution the way to `near` has no part along the self-motion.
        let (chain, near) = (planar(), [0.3, 0.4, -0.5, 0.6]);
        let target = Target::position_xy(1.5, 1.5);
        let solution = Search::new().near(&near).solve(&chain, &target).unwrap();
        assert!(solution.is_found());
        let mut way: Vec<f64> = near.iter().zip(&solution.q).map(|(near, q)| near - q).collect();
        let limits = vec![Limits::UNLIMITED; 4];
        Descent::new(&chain, &target, limits, 1e-12).self_motion(&solution.q, &mut way);
        assert!(distance(&way, &[0.0; 4]) < 1e-3, "{way:?}");
        // Neither another seed nor more solutions find a nearer one.
        let more = Search::new().near(&near).seed(5).solutions(60).solve(&chain, &target).unwrap();
        assert!(distance(&solution.q, &near) <= distance(&more.q, &near) * (1.0 + 1e-5));
    }

    #[test]
    fn a_held_joint_stays_where_it_is() {
        let target = Target::position_xy(1.5, 1.5);
        let solution = Search::new().holding(1, 0.7).solve(&planar(), &target).unwrap();
        assert!(solution.is_found() && solution.q[1] == 0.7, "{solution:?}");
        // With three of four joints held, a circle is all that is left.
        let held =
            Search::new().holding(1, 0.0).holding(2, 0.0).holding(3, 0.0).solve(&planar(), &target).unwrap();
        assert!((held.distance() - (4.0 - 4.5_f64.sqrt())).abs() < 1e-12);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let target = Target::position_xy(1.0, 1.0);
        let refused =
            |near: &[f64], target: &Target| Search::new().near(near).solve(&planar(), target).unwrap_err();
        assert_eq!(
            refused(&[0.0], &target).to_string(),
            "the configuration to stay near: expected 4 positions (j1, j2, j3, j4), got 1"
        );
        let error = refused(&[0.0, f64::NAN, 0.0, 0.0], &target);
        assert!(matches!(error, SearchError::Near(PositionsError::NonFinite { index: 1, .. })));
        assert_eq!(refused(&[0.0; 4], &Target::position_xy(f64::INFINITY, 0.0)), SearchError::Target);
    }
}
