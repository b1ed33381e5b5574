//! What a candidate is worth, in doubles.

use super::figures::Figures;
use super::objective::Objective;
use super::space::Space;

/// Beyond every merit of a stable row.
const UNSTABLE: f64 = 1e4;
/// Beyond every merit of a row with range enough.
const TOO_NARROW: f64 = 1e3;
/// Coordinates beyond this belong to rows with roots so near the circle that doubles can not tell.
const FARTHEST: f64 = 10.0;

/// A space of rows with what is wanted of them.
pub(super) struct Judge<'a> {
    pub(super) space: &'a Space,
    pub(super) objective: &'a Objective,
    pub(super) least_range: f64,
}

impl Judge<'_> {
    /// Returns the merit of free coefficients, lower is better; beyond [`Judge::is_acceptable`] it says how far from stability
    /// or from the wanted range the row is.
    pub(super) fn merit(&self, free: &[f64]) -> f64 {
        let Some(row) = self.space.float_row(free) else { return 2.0 * UNSTABLE };
        if !row.is_strictly_stable() {
            return UNSTABLE + row.parasitic_radius().min(UNSTABLE);
        }
        let h_max = row.range_end();
        if h_max > self.widest() {
            return 2.0 * UNSTABLE;
        }
        if h_max < self.least_range {
            return TOO_NARROW + self.least_range - h_max;
        }
        let per_step = row.per_step(self.space.order);
        let (h_opt, r_opt) = if self.objective.needs_optimum() { row.optimum(h_max) } else { (1.0, 1.0) };
        let merit = self.objective.merit(&Figures {
            h_max,
            per_step,
            error_constant: per_step / row.beta.iter().sum::<f64>().abs(),
            h_opt,
            r_opt,
            noise: if self.objective.needs_noise() { row.noise(h_opt) } else { 0.0 },
        });
        if merit.is_nan() { 2.0 * UNSTABLE } else { merit }
    }

    /// Returns the merit of a point of the space.
    pub(super) fn merit_at(&self, point: &[f64]) -> f64 {
        match point.iter().map(|x| x.abs()).fold(0.0, f64::max) {
            far if far > FARTHEST => 2.0 * UNSTABLE + far,
            _ => self.merit(&self.space.free(point)),
        }
    }

    /// No explicit row has a wider range: h gamma_j is at most 2 C(s, j) for all j, and one gamma_j is at least 1/s.
    fn widest(&self) -> f64 {
        let steps = self.space.steps as f64;
        steps * (steps + 1.0).exp2()
    }

    /// Returns whether a merit is that of a stable row with range enough.
    pub(super) fn is_acceptable(merit: f64) -> bool {
        merit < TOO_NARROW / 2.0
    }
}
