//! Whether a joint rests where a trajectory begins and ends.

use super::continuity::CLOSE;
use super::interpolant::Knots;
use super::noise::noise;

/// The fastest declared velocity [rad/s or m/s] that is rest: what `ros2_control`'s joint trajectory controller takes for it.
pub(super) const REST: f64 = 1e-6;
/// How many times the hardest acceleration elsewhere a start from rest may need.
const LIKE_ELSEWHERE: f64 = 2.0;
/// How many times the hardest acceleration elsewhere a start from rest needs that is none.
const UNLIKE_ELSEWHERE: f64 = 10.0;

/// Whether a joint rests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rest {
    /// It rests, or may have with accelerations like those elsewhere in the motion.
    AtRest,
    /// It moves at about this velocity [rad/s or m/s].
    InMotion(f64),
    /// Positions alone, far apart, do not tell.
    Unknown,
}

impl Rest {
    /// Returns whether the joint rests, where that is known.
    pub fn is_rest(self) -> Option<bool> {
        match self {
            Self::AtRest => Some(true),
            Self::InMotion(_) => Some(false),
            Self::Unknown => None,
        }
    }
}

/// Says of the start and of the end whether the joint rests. Declared velocities say so themselves, but for their noise; positions say it of a
/// motion that would have to begin much harder than it goes on.
pub(super) fn rests(knots: &Knots<'_>) -> [Rest; 2] {
    if let [first, .., last] = knots.velocities[..] {
        let rest = REST + noise(&knots.velocities);
        let said = |v: f64| if v.abs() <= rest { Rest::AtRest } else { Rest::InMotion(v) };
        return [first, last].map(said);
    }
    let elsewhere = knots.hardest();
    let rounding = knots.resolution();
    [0, knots.steps() - 1].map(|n| {
        let (slope, gap) = (knots.slope(n), knots.gap(n));
        // From rest to a position at a distance takes twice the distance over the time squared.
        let needed = 2.0 * slope.abs() / gap - 4.0 * rounding / (gap * gap);
        if needed <= 0.0 || gap <= CLOSE && needed <= LIKE_ELSEWHERE * elsewhere {
            Rest::AtRest
        } else if gap <= CLOSE && needed > UNLIKE_ELSEWHERE * elsewhere {
            Rest::InMotion(slope)
        } else {
            Rest::Unknown
        }
    })
}
