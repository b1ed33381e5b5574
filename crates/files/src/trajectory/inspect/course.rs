//! Whether a trajectory does the path that it should, from where to where, and how closely.

use std::borrow::Cow;

use super::interpolant::{Interpolation, Knots};
use super::met::Met;
use crate::trajectory::ArmTrajectory;
use kinstep::planner::Arm;

/// Into how many parts a path is taken at least, to look at it between samples that are far apart.
const PARTS: f64 = 1000.0;
/// The fraction of a path's duration that may be missing at its ends.
const MISSING: f64 = 1e-6;

/// The part of a path that a trajectory covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course {
    /// The time stamp \[s\] at which the path begins: zero, or the first stamp.
    pub origin: f64,
    /// From where to where in the path's own time the samples go \[s\].
    pub covered: [f64; 2],
    /// How long the path takes \[s\].
    pub duration: f64,
}

impl Course {
    /// Returns the part of a path of `duration` \[s\], and of the way to it where there is one, that the samples cover. Stamps that do not begin at zero are those of the
    /// path, or else of a clock that was started elsewhere: whichever brings the arms nearer to their paths.
    ///
    /// Every arm comes with the one whose path it should follow, and has the same joints in the same order.
    pub fn of(times: &[f64], arms: &[(Cow<'_, ArmTrajectory>, &Arm)], duration: f64) -> Self {
        let (first, last) = (times[0], times[times.len() - 1]);
        let way = arms.iter().map(|(_, path)| path.lead_duration()).fold(0.0, f64::max);
        let duration = way + duration;
        let at = |origin: f64| Self { origin, covered: [first - origin, last - origin], duration };
        let (own, moved) = (at(0.0), at(first));
        let worst = |course: Self| -> f64 {
            let errors = arms.iter().map(|(arm, path)| course.worst_at_samples(arm, path, times));
            errors.fold(0.0, f64::max)
        };
        let is_elsewhere = first < -MISSING * duration || first >= duration;
        if first == 0.0 || !is_elsewhere && worst(own) <= worst(moved) { own } else { moved }
    }

    /// Whether the path is done from its beginning to its end.
    pub fn is_done(&self) -> bool {
        self.missing().is_empty()
    }

    /// The parts of the path's time \[s\] that are not covered.
    pub fn missing(&self) -> Vec<[f64; 2]> {
        let allowed = MISSING * self.duration;
        let [begin, end] = self.covered;
        let before = (begin > allowed).then_some([0.0, begin.min(self.duration)]);
        let after = (end < self.duration - allowed).then_some([end.max(0.0), self.duration]);
        before.into_iter().chain(after).collect()
    }

    /// Returns the worst norm of the task error (m and rad together) while the path lasts, and its time stamp \[s\]: at samples,
    /// and between those that are further apart than a thousandth of the path. The way to the path is not the path; of an arm
    /// that never comes there all counts.
    pub fn worst_error(
        &self,
        arm: &ArmTrajectory,
        path: &Arm,
        times: &[f64],
        interpolation: Interpolation,
    ) -> Met {
        let parts_of = |n: usize| {
            let gap = times.get(n + 1).map_or(0.0, |next| next - times[n]);
            (gap * PARTS / self.duration).ceil().min(PARTS)
        };
        let is_dense = (0..times.len()).all(|n| !(parts_of(n) > 1.0));
        let joints = if is_dense { 0 } else { arm.joints.len() };
        let knots: Vec<Knots<'_>> = (0..joints).map(|joint| Knots::of(arm, joint, times)).collect();
        let own_times: Vec<f64> = times.iter().map(|t| t - self.origin).collect();
        let errors = arm.task_errors(path, &own_times);
        let first =
            Some(path.on_path_from(&own_times, &errors)).filter(|&first| first < times.len()).unwrap_or(0);
        let mut scratch = path.chain().scratch();
        let mut worst = Met { value: 0.0, t: times[first] };
        let mut take = |error: f64, t: f64| {
            if self.lasts(t) && !(error <= worst.value) {
                worst = Met { value: error, t };
            }
        };
        for n in first..times.len() {
            take(errors[n].norm(), times[n]);
            let parts = parts_of(n);
            if parts > 1.0 {
                let segments: Vec<_> =
                    knots.iter().map(|knots| knots.segments(interpolation, n)[0]).collect();
                for part in 1..parts as usize {
                    let s = part as f64 / parts;
                    let q: Vec<f64> = segments.iter().map(|segment| segment.value(s)).collect();
                    let t = segments[0].time(s);
                    take(path.task_error(t - self.origin, &q, &mut scratch).norm(), t);
                }
            }
        }
        worst
    }

    fn lasts(&self, t: f64) -> bool {
        let allowed = MISSING * self.duration;
        t - self.origin >= -allowed && t - self.origin <= self.duration + allowed
    }

    fn worst_at_samples(&self, arm: &ArmTrajectory, path: &Arm, times: &[f64]) -> f64 {
        let own_times: Vec<f64> = times.iter().map(|t| t - self.origin).collect();
        let errors = arm.task_errors(path, &own_times);
        let lasting =
            errors.iter().zip(times).filter(|(_, t)| self.lasts(**t)).map(|(error, _)| error.norm());
        lasting.fold(0.0, |worst, error| if error <= worst { worst } else { error })
    }
}
