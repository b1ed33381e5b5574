use super::factors::Factors;
use super::problem::{Constraint, LeastDistance, dot};

/// A normal whose part beside the active ones is smaller than this fraction of it depends on them.
const DEPENDENT: f64 = 1e-11;

/// Constraints that hold as equalities, with their factors and multipliers, and the nearest point to the target on them.
#[derive(Clone, Debug)]
pub(super) struct ActiveSet {
    pub(super) factors: Factors,
    /// Equalities first, in the order in which the factors have them.
    pub(super) constraints: Vec<Constraint>,
    /// `x - c = N u`.
    pub(super) multipliers: Vec<f64>,
    pub(super) normal: Vec<f64>,
    /// `Q^T n` of a constraint that is looked at.
    pub(super) projected: Vec<f64>,
    /// The direction of a step, and how it changes the multipliers.
    pub(super) step: Vec<f64>,
    pub(super) change: Vec<f64>,
    residual: Vec<f64>,
}

impl ActiveSet {
    pub(super) fn with_capacity(unknowns: usize) -> Self {
        let zeros = vec![0.0; unknowns];
        Self {
            factors: Factors::with_capacity(unknowns),
            constraints: Vec::with_capacity(unknowns),
            multipliers: Vec::with_capacity(unknowns),
            normal: zeros.clone(),
            projected: zeros.clone(),
            step: zeros.clone(),
            change: zeros.clone(),
            residual: zeros,
        }
    }

    pub(super) fn clear(&mut self) {
        self.factors.clear();
        self.constraints.clear();
        self.multipliers.clear();
    }

    /// Looks at a constraint: writes its normal, the step that it asks for and what that does to the multipliers. Returns its
    /// value, and the square of the free part of its normal; zero where it depends on the active ones.
    pub(super) fn look_at(&mut self, problem: &LeastDistance<'_>, constraint: Constraint) -> (f64, f64) {
        let value = problem.normal(constraint, &mut self.normal);
        self.factors.project(&self.normal, &mut self.projected);
        self.factors.solve(&self.projected, &mut self.change);
        self.factors.free_part(&self.projected, &mut self.step);
        let square = |entries: &[f64]| entries.iter().map(|entry| entry * entry).sum::<f64>();
        let free = square(&self.projected[self.factors.active()..]);
        (value, if free > DEPENDENT * DEPENDENT * square(&self.normal) { free } else { 0.0 })
    }

    /// Takes in the constraint that was looked at last.
    pub(super) fn add(&mut self, constraint: Constraint, multiplier: f64) {
        self.factors.add(&mut self.projected);
        self.constraints.push(constraint);
        self.multipliers.push(multiplier);
    }

    pub(super) fn remove(&mut self, place: usize) {
        self.factors.remove(place);
        self.constraints.remove(place);
        self.multipliers.remove(place);
    }

    /// Writes the nearest point to the target on the active constraints, and its multipliers: by the factors, refined once.
    pub(super) fn solve(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) {
        x.copy_from_slice(problem.target);
        self.come_nearer(problem, x);
        // N u = Q_1 R u = x - c.
        for (projected, (x, c)) in self.residual.iter_mut().zip(x.iter().zip(problem.target)) {
            *projected = x - c;
        }
        let count = self.constraints.len();
        self.factors.project(&self.residual, &mut self.projected);
        self.factors.solve(&self.projected, &mut self.change);
        self.multipliers.copy_from_slice(&self.change[..count]);
        self.come_nearer(problem, x);
    }

    /// Moves `x` onto the active constraints along their normals.
    fn come_nearer(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) {
        for (place, &constraint) in self.constraints.iter().enumerate() {
            let value = problem.normal(constraint, &mut self.normal);
            self.residual[place] = value - dot(&self.normal, x);
        }
        self.factors.solve_transposed(&self.residual, &mut self.change);
        self.factors.add_active_part(&self.change, x);
    }
}
