//! From one starting place downhill: damped least squares that keeps within limits.

use super::Target;
use crate::math::GramCholesky;
use crate::robot::{Chain, ChainScratch, Limits};
use nalgebra::{IsometryMatrix3, Vector6};

/// The damping at the start, as a fraction of the mean squared singular value.
const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-13;
/// Damping beyond which no step helps.
const MOST_DAMPING: f64 = 1e6;
/// Steps taken beyond the tolerance: convergence is quadratic, so they reach what rounding leaves.
const FINISHING_STEPS: usize = 3;
/// Steps that gain less than this fraction end a descent to where the target can not be reached.
const LEAST_GAIN: f64 = 1e-9;

/// The Levenberg-Marquardt method on the task error of one chain, with its memory.
///
/// The step is `J^T (J J^T + damping I)^-1 e` over the joints that are free: a joint at a limit beyond which the error
/// would fall is held there. Steps end at the limits they meet.
pub(super) struct Descent<'a> {
    pub(super) chain: &'a Chain,
    target: &'a Target,
    pub(super) limits: Vec<Limits>,
    /// The norm of the task error that counts as reached.
    pub(super) tolerance: f64,
    scratch: ChainScratch,
    /// The Jacobian where the joints are, and where a step would take them.
    columns: Vec<Vector6<f64>>,
    next_columns: Vec<Vector6<f64>>,
    /// The columns of the free joints (zero for the others), and one for the damping of each row.
    system: Vec<Vector6<f64>>,
    next: Vec<f64>,
}

impl<'a> Descent<'a> {
    pub(super) fn new(chain: &'a Chain, target: &'a Target, limits: Vec<Limits>, tolerance: f64) -> Self {
        let joints = chain.dof();
        let zeros = vec![Vector6::zeros(); joints];
        Self {
            chain,
            target,
            limits,
            tolerance,
            scratch: chain.scratch(),
            next_columns: zeros.clone(),
            columns: zeros,
            system: vec![Vector6::zeros(); joints + target.rows()],
            next: vec![0.0; joints],
        }
    }

    /// The pose of the tip at `q`, and its task error.
    pub(super) fn measure(&mut self, q: &[f64]) -> (IsometryMatrix3<f64>, Vector6<f64>) {
        let tip = self.chain.forward(q, &mut self.scratch).pose();
        (tip, self.target.error(&tip))
    }

    /// Moves `q` downhill, and returns the norm of the task error there.
    pub(super) fn descend(&mut self, q: &mut [f64], most_steps: usize) -> f64 {
        match self.target.rows() {
            2 => self.descend_rows::<2>(q, most_steps),
            3 => self.descend_rows::<3>(q, most_steps),
            _ => self.descend_rows::<6>(q, most_steps),
        }
    }

    fn descend_rows<const M: usize>(&mut self, q: &mut [f64], most_steps: usize) -> f64 {
        self.next.copy_from_slice(q);
        let mut error = self.look();
        std::mem::swap(&mut self.columns, &mut self.next_columns);
        let (mut damping, mut finishing) = (FIRST_DAMPING, FINISHING_STEPS);
        for _ in 0..most_steps {
            let before = error.norm();
            if before <= self.tolerance {
                if finishing == 0 {
                    break;
                }
                finishing -= 1;
            }
            let found = self.step::<M>(q, &error, damping).filter(|next| next.norm() < before);
            if let Some(next) = found {
                q.copy_from_slice(&self.next);
                std::mem::swap(&mut self.columns, &mut self.next_columns);
                error = next;
                damping = (damping * 0.2).max(LEAST_DAMPING);
                if error.norm() > before * (1.0 - LEAST_GAIN) {
                    break;
                }
            } else if before <= self.tolerance || damping > MOST_DAMPING {
                break;
            } else {
                damping *= 5.0;
            }
        }
        error.norm()
    }

    /// Runs the kinematics at `next`: the Jacobian goes to `next_columns`, the task error is returned.
    fn look(&mut self) -> Vector6<f64> {
        let posed = self.chain.forward(&self.next, &mut self.scratch);
        let tip = posed.pose();
        posed.geometric_jacobian(&mut self.next_columns);
        self.target.drop_free_turns(&tip, &mut self.next_columns);
        self.target.error(&tip)
    }

    /// The task error where one damped step from `q` leads, which is put into `next`.
    fn step<const M: usize>(
        &mut self,
        q: &[f64],
        error: &Vector6<f64>,
        damping: f64,
    ) -> Option<Vector6<f64>> {
        for (i, column) in self.columns.iter().enumerate() {
            // Downhill is against the gradient.
            let is_held = self.limits[i].holds(q[i], -column.dot(error));
            self.system[i] = if is_held { Vector6::zeros() } else { *column };
        }
        let y = self.solve::<M>(error, damping)?;
        for (i, next) in self.next.iter_mut().enumerate() {
            let step: f64 = (0..M).map(|row| self.system[i][row] * y[row]).sum();
            *next = (q[i] - step).clamp(self.limits[i].lower, self.limits[i].upper);
        }
        Some(self.look())
    }

    /// `(J J^T + damping scale I)^-1 v` over the columns in `system`, with the mean squared singular value as the scale.
    fn solve<const M: usize>(&mut self, v: &Vector6<f64>, damping: f64) -> Option<[f64; M]> {
        let joints = self.chain.dof();
        let squares = self.system[..joints].iter().map(|column| column.fixed_rows::<M>(0).norm_squared());
        let scale = squares.sum::<f64>() / M as f64;
        if !(scale > 0.0) {
            return None;
        }
        for row in 0..M {
            self.system[joints + row] = Vector6::ith(row, (damping * scale).sqrt());
        }
        Some(GramCholesky::<M>::new(&self.system)?.solve(&std::array::from_fn(|row| v[row])))
    }

    /// Writes the part of the joint displacement `d` at `q` that leaves the tip where it is, over the joints that may
    /// move that way: `d - J^T (J J^T)^-1 J d`. Joints at a limit that it would take them across are left out of it.
    pub(super) fn self_motion(&mut self, q: &[f64], d: &mut [f64]) {
        match self.target.rows() {
            2 => self.self_motion_rows::<2>(q, d),
            3 => self.self_motion_rows::<3>(q, d),
            _ => self.self_motion_rows::<6>(q, d),
        }
    }

    fn self_motion_rows<const M: usize>(&mut self, q: &[f64], d: &mut [f64]) {
        self.next.copy_from_slice(q);
        self.look();
        self.system[..q.len()].copy_from_slice(&self.next_columns);
        let wanted = d.to_vec();
        let mut held = vec![false; q.len()];
        // Every round holds at least one more joint, or is the last.
        for _ in 0..=q.len() {
            let moved: Vector6<f64> = self.system.iter().zip(&wanted).map(|(column, &d)| column * d).sum();
            let Some(y) = self.solve::<M>(&moved, LEAST_DAMPING) else { return d.fill(0.0) };
            let mut holds_another = false;
            for i in 0..q.len() {
                if held[i] {
                    continue;
                }
                let back: f64 = (0..M).map(|row| self.system[i][row] * y[row]).sum();
                d[i] = wanted[i] - back;
                if self.limits[i].holds(q[i], d[i]) {
                    (held[i], d[i], self.system[i]) = (true, 0.0, Vector6::zeros());
                    holds_another = true;
                }
            }
            if !holds_another {
                return;
            }
        }
    }
}

trait Holds {
    /// Whether a joint at `position` stands at a limit that a move in the direction of `velocity` would cross.
    fn holds(&self, position: f64, velocity: f64) -> bool;
}

impl Holds for Limits {
    fn holds(&self, position: f64, velocity: f64) -> bool {
        (position <= self.lower && velocity < 0.0) || (position >= self.upper && velocity > 0.0)
    }
}
