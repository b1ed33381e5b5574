//! From the errors of a ladder to slopes, and from slopes to a verdict.

use super::fit::Fit;
use std::fmt;

/// Slopes that differ by more than this are not those of one power law.
const UNLIKE: f64 = 0.5;
/// Without a claim, a slope below this is no order.
const LEAST_ORDER: f64 = 0.5;

/// What a study asks of its errors before it speaks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria {
    /// How far the slope of the finest pair may be from the order; the pair before may be off by twice as much.
    pub tolerance: f64,
    /// How many times the round-off floor an error has to be to count.
    pub floor_margin: f64,
}

impl Default for Criteria {
    fn default() -> Self {
        Self { tolerance: 0.2, floor_margin: 100.0 }
    }
}

impl Criteria {
    /// The same with another tolerance of slopes.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
}

/// What became of one rung.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// It counts.
    Used,
    /// Left out: too coarse, its slope is not yet that of the finer rungs.
    PreAsymptotic,
    /// Left out: the error is within the margin of the round-off floor.
    NearFloor,
    /// Left out: the row is unstable at this gap, because the problem is stiff.
    Unstable,
    /// Left out: there is nothing to compare the run with.
    NoReference,
    /// Left out: the run stopped early, or the error is not a number.
    Stopped,
}

impl Mark {
    /// The words used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Used => "used",
            Self::PreAsymptotic => "pre-asymptotic",
            Self::NearFloor => "near the floor",
            Self::Unstable => "unstable",
            Self::NoReference => "no reference",
            Self::Stopped => "stopped",
        }
    }
}

/// Why a study does not decide.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Undecidable {
    /// The ladder itself is too short.
    ShortLadder {
        /// How many rungs it has.
        rungs: usize,
    },
    /// Most runs stopped before their end.
    Stopped {
        /// How many.
        stopped: usize,
        /// Of how many.
        rungs: usize,
    },
    /// The errors lie at the floor: the gaps are finer than the numbers can show.
    AtFloor {
        /// The floor.
        floor: f64,
    },
    /// There is nothing to compare with: the reference does not converge.
    NoReference,
    /// Two references with all digits at hand differ: nothing follows the solution to its end.
    NotFollowed {
        /// By how much they differ.
        uncertainty: f64,
        /// The largest entry of the solution.
        scale: f64,
    },
    /// The runs have left a solution that they could not follow: small changes grow too much on the way.
    Sensitive {
        /// How many times a small change of the start has grown.
        growth: f64,
    },
    /// The problem is stiff: the row is unstable at most gaps.
    Unstable {
        /// At how many gaps it is.
        unstable: usize,
        /// Of how many.
        rungs: usize,
        /// The largest spectral radius of the Jacobian matrix that was met \[1/s\].
        rate: f64,
    },
    /// The right-hand side has fewer derivatives than the order needs.
    NotSmooth {
        /// Where it was seen first \[s\].
        at: f64,
        /// The slope of the finest pair.
        finest: f64,
    },
    /// Nothing was claimed, and the errors do not fall.
    NotFalling {
        /// The slope of the finest pair.
        finest: f64,
    },
    /// Two pairs of neighbouring rungs are needed.
    TooFewRungs {
        /// How many neighbouring rungs could be used.
        usable: usize,
    },
    /// The slopes of the finest pairs are still moving.
    Unsettled {
        /// The slope of the last pair but one.
        before: f64,
        /// The slope of the finest pair.
        finest: f64,
    },
}

/// What a study says of an order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The order was seen.
    Confirmed {
        /// The order.
        order: usize,
        /// The slope of the finest pair.
        slope: f64,
    },
    /// The errors fall more slowly than claimed.
    NotReached {
        /// The order claimed.
        claimed: usize,
        /// The slope of the finest pair.
        slope: f64,
    },
    /// The errors fall faster than claimed.
    Exceeded {
        /// The order claimed.
        claimed: usize,
        /// The slope of the finest pair.
        slope: f64,
    },
    /// Nothing was claimed; the slopes have settled.
    Seen {
        /// The slope of the finest pair.
        slope: f64,
        /// The slope of the pair before.
        before: f64,
    },
    /// These runs do not tell.
    Undecidable(Undecidable),
}

impl Verdict {
    /// Whether the order was seen.
    pub fn is_confirmed(&self) -> bool {
        matches!(self, Self::Confirmed { .. })
    }

    /// Whether the errors were seen to fall more slowly than claimed.
    pub fn is_not_reached(&self) -> bool {
        matches!(self, Self::NotReached { .. })
    }

    /// Whether these runs tell anything.
    pub fn is_decided(&self) -> bool {
        !matches!(self, Self::Undecidable(_))
    }

    /// The word used in reports.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Confirmed { .. } => "confirmed",
            Self::NotReached { .. } => "not reached",
            Self::Exceeded { .. } => "exceeded",
            Self::Seen { .. } => "seen",
            Self::Undecidable(_) => "not decidable here",
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Confirmed { order, slope } => {
                write!(f, "order {order} confirmed: the finest pair has slope {slope:.3}")
            }
            Self::NotReached { claimed, slope } => {
                write!(f, "order {claimed} not reached: the finest pair has slope {slope:.3}")
            }
            Self::Exceeded { claimed, slope } => {
                write!(f, "order {claimed} exceeded: the finest pair has slope {slope:.3}")
            }
            Self::Seen { slope, before } => {
                write!(f, "nothing is claimed; the finest two pairs have slopes {before:.3} and {slope:.3}")
            }
            Self::Undecidable(why) => write!(f, "not decidable here: {why}"),
        }
    }
}

impl fmt::Display for Undecidable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ShortLadder { rungs } => {
                let gaps = if *rungs == 1 { "one gap" } else { "two gaps" };
                write!(f, "{gaps} can not show whether a slope has settled; give three or more")
            }
            Self::Stopped { stopped, rungs } => {
                write!(
                    f,
                    "{stopped} of {rungs} runs stopped before their end, and a stopped run has no error"
                )
            }
            Self::AtFloor { floor } => write!(
                f,
                "all errors lie within reach of the floor of {floor:.1e}, what rounding and the reference leave uncertain; use coarser gaps"
            ),
            Self::NoReference => {
                f.write_str("the reference does not converge, so there is nothing to compare with")
            }
            Self::NotFollowed { uncertainty, scale } => write!(
                f,
                "the problem is too sensitive to be followed so far: two references with 32 digits differ by {uncertainty:.1e}, where the solution measures {scale:.1e}; choose a shorter duration"
            ),
            Self::Sensitive { growth } => write!(
                f,
                "the problem is sensitive: a small change of the start has grown {growth:.1e} times at the end, and the runs have left the solution; choose a shorter duration or finer gaps"
            ),
            Self::Unstable { unstable, rungs, rate } => write!(
                f,
                "the problem is stiff: at {unstable} of {rungs} gaps the row is unstable, because its stability region does not reach gap times {rate:.1e} 1/s, the spectral radius of the Jacobian matrix; use finer gaps"
            ),
            Self::NotSmooth { at, finest } => write!(
                f,
                "the right-hand side is not smooth at t = {at:.6} s, which limits the order of every row; the finest pair has slope {finest:.3}"
            ),
            Self::NotFalling { finest } => {
                write!(f, "the errors do not fall: the finest pair has slope {finest:.3}")
            }
            Self::TooFewRungs { usable } => write!(
                f,
                "{usable} neighbouring rungs lie well above the round-off floor, three are needed; use coarser gaps, closer together"
            ),
            Self::Unsettled { before, finest } => write!(
                f,
                "the slopes of the finest two pairs, {before:.3} and {finest:.3}, are still moving; use finer gaps"
            ),
        }
    }
}

/// One kind of error over the rungs of a ladder, and what follows from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    /// The error of every rung, coarsest first; NaN for a run that stopped.
    pub errors: Vec<f64>,
    /// The slope `log(e_i / e_{i+1}) / log(sigma_i / sigma_{i+1})` of every pair of neighbouring rungs.
    pub slopes: Vec<f64>,
    /// What became of every rung.
    pub marks: Vec<Mark>,
    /// The round-off (or the uncertainty of the reference) below which no error can be seen.
    pub floor: f64,
    /// The power law through the asymptotic window: the rungs that are used, where there are three.
    pub fit: Option<Fit>,
    /// What follows.
    pub verdict: Verdict,
}

impl Convergence {
    /// Judges `errors` at the gaps `sigmas`, coarsest first, against the order `claimed`; without a claim it says what was
    /// seen, once the slopes of the finest two pairs agree to the tolerance.
    ///
    /// Three neighbouring rungs, two pairs, must lie `floor_margin` times above the floor. The order is confirmed when the
    /// finest pair is within the tolerance of it and the one before within twice that. It is not reached (or
    /// exceeded) when both slopes are alike and head elsewhere: the limit that the last two slopes point to, where they approach the
    /// claim, else the finest slope itself, is more than a half and the tolerance away from it. Anything else is not decided.
    ///
    /// ```
    /// use kinstep_study::{Convergence, Criteria};
    /// let errors = [5.85e-5, 4.89e-6, 3.47e-7, 2.27e-8, 1.43e-9, 8.99e-11];
    /// let sigmas = [0.04, 0.02, 0.01, 0.005, 0.0025, 0.00125];
    /// let seen = Convergence::judge(&sigmas, &errors, 1e-15, Some(4), &Criteria::default());
    /// assert_eq!(seen.verdict.to_string(), "order 4 confirmed: the finest pair has slope 3.992");
    /// ```
    ///
    /// # Panics
    /// If there are not as many gaps as errors.
    pub fn judge(
        sigmas: &[f64],
        errors: &[f64],
        floor: f64,
        claimed: Option<usize>,
        criteria: &Criteria,
    ) -> Self {
        Self::judge_without(sigmas, errors, floor, claimed, criteria, &vec![None; errors.len()])
    }

    /// The same, with the rungs left out that have a mark already.
    pub(super) fn judge_without(
        sigmas: &[f64],
        errors: &[f64],
        floor: f64,
        claimed: Option<usize>,
        criteria: &Criteria,
        left_out: &[Option<Mark>],
    ) -> Self {
        assert_eq!(sigmas.len(), errors.len(), "one error per gap");
        let slope = |i: usize| (errors[i] / errors[i + 1]).ln() / (sigmas[i] / sigmas[i + 1]).ln();
        let slopes: Vec<f64> = (0..errors.len().saturating_sub(1)).map(slope).collect();
        let least = floor * criteria.floor_margin;
        let mut marks: Vec<Mark> = errors
            .iter()
            .zip(left_out)
            .map(|(&error, known)| known.unwrap_or_else(|| mark(error, least)))
            .collect();
        let (from, to) = finest_usable(&marks);
        let verdict = if to - from < 3 {
            Verdict::Undecidable(shortage(&marks, floor, to - from))
        } else {
            let (before, finest) = (slopes[to - 3], slopes[to - 2]);
            let ratio = sigmas[to - 1] / sigmas[to - 2];
            name_pre_asymptotic(&mut marks[..to - 2], &slopes[..to - 2], finest);
            match claimed {
                Some(claimed) => verdict(claimed, before, finest, ratio, criteria),
                None => unclaimed(before, finest, criteria),
            }
        };
        let (from, to) = finest_usable(&marks);
        let fit = Fit::of(sigmas, errors, from, to);
        Self { errors: errors.to_vec(), slopes, marks, floor, fit, verdict }
    }

    /// The order seen: the slope of the finest pair that counts, where the study decides anything.
    pub fn order(&self) -> Option<f64> {
        self.verdict.is_decided().then(|| self.finest_slope()).flatten()
    }

    /// The slope of the finest pair that counts.
    pub fn finest_slope(&self) -> Option<f64> {
        let (from, to) = finest_usable(&self.marks);
        (to - from >= 2).then(|| self.slopes[to - 2])
    }
}

/// What is said of slopes where nothing is claimed.
fn unclaimed(before: f64, finest: f64, criteria: &Criteria) -> Verdict {
    if finest < LEAST_ORDER {
        Verdict::Undecidable(Undecidable::NotFalling { finest })
    } else if (finest - before).abs() <= criteria.tolerance {
        Verdict::Seen { slope: finest, before }
    } else {
        Verdict::Undecidable(Undecidable::Unsettled { before, finest })
    }
}

/// What keeps a study from having three neighbouring rungs.
fn shortage(marks: &[Mark], floor: f64, usable: usize) -> Undecidable {
    let count = |what: Mark| marks.iter().filter(|&&mark| mark == what).count();
    let (rungs, stopped) = (marks.len(), count(Mark::Stopped));
    if !floor.is_finite() {
        Undecidable::NoReference
    } else if rungs < 3 {
        Undecidable::ShortLadder { rungs }
    } else if stopped > rungs / 2 {
        Undecidable::Stopped { stopped, rungs }
    } else if count(Mark::NearFloor) + stopped == rungs {
        Undecidable::AtFloor { floor }
    } else {
        Undecidable::TooFewRungs { usable }
    }
}

fn mark(error: f64, least: f64) -> Mark {
    if !error.is_finite() {
        Mark::Stopped
    } else if error > least {
        Mark::Used
    } else {
        Mark::NearFloor
    }
}

/// The finest run of neighbouring rungs that are used, as a half-open range.
fn finest_usable(marks: &[Mark]) -> (usize, usize) {
    let to = marks.iter().rposition(|&mark| mark == Mark::Used).map_or(0, |last| last + 1);
    let from = marks[..to].iter().rposition(|&mark| mark != Mark::Used).map_or(0, |before| before + 1);
    (from, to)
}

/// Going from fine to coarse, everything beyond the first slope unlike the finest one is pre-asymptotic.
fn name_pre_asymptotic(marks: &mut [Mark], slopes: &[f64], finest: f64) {
    let unlike = |slope: &f64| !((slope - finest).abs() <= UNLIKE);
    let coarse = slopes.iter().rposition(unlike).map_or(0, |i| (i + 1).min(marks.len()));
    for mark in marks[..coarse].iter_mut().filter(|mark| **mark == Mark::Used) {
        *mark = Mark::PreAsymptotic;
    }
}

fn verdict(claimed: usize, before: f64, finest: f64, ratio: f64, criteria: &Criteria) -> Verdict {
    // Beyond the middle between two whole numbers, and by the tolerance, slopes head for the other one.
    let elsewhere = 0.5 + criteria.tolerance;
    let order = claimed as f64;
    let off = |slope: f64| (slope - order).abs();
    if off(finest) <= criteria.tolerance && off(before) <= 2.0 * criteria.tolerance {
        return Verdict::Confirmed { order: claimed, slope: finest };
    }
    let settled = (finest - before).abs() <= UNLIKE;
    // Slopes err in proportion to sigma: two of them point to their limit. Where they point past the claim, it is not
    // the claim that they speak against.
    let approaching = off(finest) < off(before) && (before - order) * (finest - order) > 0.0;
    let limit = match finest + (finest - before) * ratio / (1.0 - ratio) {
        _ if !approaching => finest,
        beyond if (beyond - order) * (finest - order) < 0.0 => order,
        limit => limit,
    };
    if settled && limit < order - elsewhere {
        Verdict::NotReached { claimed, slope: finest }
    } else if settled && limit > order + elsewhere {
        Verdict::Exceeded { claimed, slope: finest }
    } else {
        Verdict::Undecidable(Undecidable::Unsettled { before, finest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judge(claimed: usize, error: impl Fn(f64) -> f64) -> Convergence {
        let sigmas: Vec<f64> = (0..7).map(|k| 0.1 / f64::from(1 << k)).collect();
        let errors: Vec<f64> = sigmas.iter().map(|&sigma| error(sigma)).collect();
        Convergence::judge(&sigmas, &errors, 1e-15, Some(claimed), &Criteria::default())
    }

    #[test]
    fn confirms_a_power_law_and_no_other() {
        for order in 1..8_i32 {
            let error = |sigma: f64| 0.3 * sigma.powi(order) * (1.0 + 2.0 * sigma);
            assert!(judge(order as usize, error).verdict.is_confirmed());
            assert!(judge(order as usize + 1, error).verdict.is_not_reached());
            assert!(matches!(judge(order as usize - 1, error).verdict, Verdict::Exceeded { .. }));
        }
    }

    #[test]
    fn a_lower_order_term_that_takes_over_late_is_not_confirmed() {
        let seen = judge(4, |sigma| sigma.powi(4) + 1e-5 * sigma.powi(2));
        assert!(!seen.verdict.is_confirmed(), "{}", seen.verdict);
        assert!(judge(4, |sigma| sigma.powi(4) + 1e-2 * sigma.powi(2)).verdict.is_not_reached());
    }

    #[test]
    fn coarse_rungs_and_rungs_at_the_floor_are_named_and_left_out() {
        let seen = judge(4, |sigma| sigma.powi(4) * (1.0 + (40.0 * sigma).powi(3)) * 1e-3 + 1e-15);
        assert_eq!(seen.marks[0], Mark::PreAsymptotic);
        assert_eq!(seen.marks[6], Mark::NearFloor);
        assert!(seen.marks[3..5].iter().all(|&mark| mark == Mark::Used), "{:?}", seen.marks);
    }

    #[test]
    fn the_fit_uses_the_asymptotic_window_alone() {
        let seen = judge(4, |sigma| sigma.powi(4) * (1.0 + (20.0 * sigma).powi(3)));
        let fit = seen.fit.unwrap();
        assert_eq!((fit.from, fit.to), (2, 7));
        let sigmas: Vec<f64> = (0..7).map(|k| 0.1 / f64::from(1 << k)).collect();
        let all = Fit::of(&sigmas, &seen.errors, 0, 7).unwrap();
        assert!((fit.order - 4.0).abs() < (all.order - 4.0).abs() && fit.standard_error < all.standard_error);
    }

    #[test]
    fn too_few_rungs_are_no_reason_to_guess() {
        let floor = judge(4, |_| 3e-15);
        assert_eq!(floor.verdict, Verdict::Undecidable(Undecidable::AtFloor { floor: 1e-15 }));
        assert!(floor.marks.iter().all(|&mark| mark == Mark::NearFloor));
        let stopped = judge(4, |sigma| if sigma < 0.02 { f64::NAN } else { sigma });
        assert!(!stopped.verdict.is_decided() || stopped.verdict.is_not_reached());
        let one = Convergence::judge(&[0.1], &[0.1], 0.0, None, &Criteria::default());
        assert_eq!(one.verdict, Verdict::Undecidable(Undecidable::ShortLadder { rungs: 1 }));
        assert!(one.slopes.is_empty() && one.fit.is_none());
        let lost = judge(4, |_| f64::NAN);
        assert_eq!(lost.verdict, Verdict::Undecidable(Undecidable::Stopped { stopped: 7, rungs: 7 }));
        let two = judge(4, |sigma| if sigma > 0.04 { 1e-3 * sigma.powi(4) } else { 0.0 });
        assert_eq!(two.verdict, Verdict::Undecidable(Undecidable::TooFewRungs { usable: 2 }));
        let adrift =
            Convergence::judge(&[0.1, 0.05, 0.025], &[1.0; 3], f64::INFINITY, Some(4), &Criteria::default());
        assert_eq!(adrift.verdict, Verdict::Undecidable(Undecidable::NoReference));
    }

    #[test]
    fn without_a_claim_it_says_what_was_seen_and_confirms_nothing() {
        let sigmas = [0.1, 0.05, 0.025];
        let seen = Convergence::judge(&sigmas, &[1e-2, 2.5e-3, 6.25e-4], 0.0, None, &Criteria::default());
        assert_eq!(
            seen.verdict.to_string(),
            "nothing is claimed; the finest two pairs have slopes 2.000 and 2.000"
        );
        assert!(seen.verdict.is_decided() && !seen.verdict.is_confirmed() && seen.order().is_some());
        let between = Convergence::judge(&sigmas, &[1.0, 0.177, 0.0313], 0.0, None, &Criteria::default());
        assert!(matches!(between.verdict, Verdict::Seen { slope, .. } if (slope - 2.5).abs() < 0.01));
        let wild = Convergence::judge(&sigmas, &[1e-2, 1e-4, 5e-5], 0.0, None, &Criteria::default());
        assert!(!wild.verdict.is_decided());
        for errors in [[1e-2; 3], [1e-2, 2e-2, 4e-2]] {
            let stuck = Convergence::judge(&sigmas, &errors, 0.0, None, &Criteria::default());
            assert!(matches!(stuck.verdict, Verdict::Undecidable(Undecidable::NotFalling { .. })));
        }
    }

    #[test]
    fn slopes_that_hurry_towards_the_claim_do_not_speak_against_it() {
        let sigmas = [4.5, 3.0, 2.0];
        let errors: Vec<f64> = [0.0, 3.573, 3.573 + 3.175].map(|falls: f64| 1.5_f64.powf(-falls)).to_vec();
        let seen = Convergence::judge(&sigmas, &errors, 0.0, Some(3), &Criteria::default());
        assert!(!seen.verdict.is_decided(), "{}", seen.verdict);
    }

    #[test]
    fn slopes_that_still_move_are_not_decided() {
        let seen = judge(4, |sigma| sigma.powi(4) * (1.0 + 30.0 * sigma.sqrt()));
        assert!(!seen.verdict.is_not_reached(), "{}", seen.verdict);
    }
}
