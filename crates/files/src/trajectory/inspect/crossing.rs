//! Limits that a joint crosses: when first, how far, for how long.

use super::Met;
use super::segment::Segment;
use kinstep::planner::LimitKind;

/// A limit that a joint crosses.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// The joint.
    pub joint: String,
    /// What crosses its limit.
    pub kind: LimitKind,
    /// When it is first beyond the limit \[s\].
    pub first: f64,
    /// For how long it is beyond it, all in all \[s\]. `None` where the samples prove that the limit is crossed between them,
    /// by any smooth motion, but not for how long.
    pub outside: Option<f64>,
    /// Where it is furthest beyond the limit, and when.
    pub worst: Met,
    /// The limit [rad or m and their derivatives].
    pub limit: f64,
}

/// What is beyond one limit while a trajectory is gone through.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beyond {
    kind: LimitKind,
    limit: f64,
    /// `1` for a limit from above, `-1` for one from below.
    side: f64,
    /// Whether the values are but known to be met somewhere near their times.
    is_bound: bool,
    found: Option<Found>,
}

#[derive(Clone, Copy, Debug)]
struct Found {
    first: f64,
    outside: f64,
    worst: Met,
}

impl Beyond {
    /// A limit from below and one from above.
    pub(super) fn both(kind: LimitKind, [lower, upper]: [f64; 2]) -> [Self; 2] {
        [(lower, -1.0), (upper, 1.0)].map(|(limit, side)| Self {
            kind,
            limit,
            side,
            is_bound: false,
            found: None,
        })
    }

    /// Takes a value that is met somewhere near `at.t` by any smooth motion, and known but for `slack`; the samples that
    /// prove it begin at `start` \[s\].
    pub(super) fn take_bound(&mut self, at: Met, start: f64, slack: f64) {
        self.is_bound = true;
        if self.excess(at.value) > slack {
            self.note(start, 0.0, at);
        }
    }

    /// Takes what happens over one step, whose values have these bounds: at its ends known but for the rounding `slacks[0]`,
    /// between them for `slacks[1]`.
    pub(super) fn take(&mut self, segment: &Segment, [least, largest]: [f64; 2], slacks: [f64; 2]) {
        if !(self.excess(least) > 0.0 || self.excess(largest) > 0.0) {
            return;
        }
        let at = |s: f64| Met { value: segment.value(s), t: segment.time(s) };
        let ends = [0.0, 1.0].map(|s| (at(s), slacks[0]));
        let between = segment.turning_points().into_iter().map(|s| (at(s), slacks[1]));
        let beyond = ends.into_iter().chain(between).filter(|(met, slack)| self.excess(met.value) > *slack);
        let further = |a: (Met, f64), b: (Met, f64)| {
            if self.excess(b.0.value) > self.excess(a.0.value) { b } else { a }
        };
        if let Some((worst, _)) = beyond.reduce(further) {
            let (first, outside) = self.outside(segment);
            self.note(first.unwrap_or(worst.t), outside, worst);
        }
    }

    /// When the step is first beyond the limits, and for how long.
    fn outside(&self, segment: &Segment) -> (Option<f64>, f64) {
        let places = [&[0.0], &segment.passes(self.limit)[..], &[1.0]].concat();
        let is_outside = |pair: &&[f64]| self.excess(segment.value(f64::midpoint(pair[0], pair[1]))) > 0.0;
        let mut first = None;
        let mut outside = 0.0;
        for pair in places.windows(2).filter(is_outside) {
            first.get_or_insert(segment.time(pair[0]));
            outside += (pair[1] - pair[0]) * segment.duration;
        }
        (first, outside)
    }

    fn note(&mut self, first: f64, outside: f64, worst: Met) {
        let mut found = self.found.unwrap_or(Found { first, outside: 0.0, worst });
        found.outside += outside;
        if self.excess(worst.value) > self.excess(found.worst.value) {
            found.worst = worst;
        }
        self.found = Some(found);
    }

    /// What is limited; nothing where there is no limit.
    pub(super) fn limited(&self) -> Option<LimitKind> {
        self.limit.is_finite().then_some(self.kind)
    }

    fn excess(&self, value: f64) -> f64 {
        self.side * (value - self.limit)
    }

    /// Returns what was found.
    pub(super) fn crossing(&self, joint: &str) -> Option<Crossing> {
        let Found { first, outside, worst } = self.found?;
        let outside = (!self.is_bound).then_some(outside);
        Some(Crossing { joint: joint.to_owned(), kind: self.kind, first, outside, worst, limit: self.limit })
    }
}
