//! Null-space criteria: one file each, one row in [`CRITERIA`].

mod clearance;
#[expect(clippy::module_inception, reason = "the file is named after the trait that it holds")]
mod criterion;
mod criterion_kind;
mod joint_limits;
mod manipulability;
mod posture;
mod repetitive;

pub use clearance::Clearance;
pub use criterion::Criterion;
pub use criterion_kind::{CriterionKind, MakeCriterion};
pub use joint_limits::JointLimits;
pub use manipulability::Manipulability;
pub use posture::Posture;

/// Every built-in null-space criterion.
pub const CRITERIA: &[CriterionKind] =
    &[repetitive::KIND, joint_limits::KIND, manipulability::KIND, posture::KIND, clearance::KIND];

#[cfg(test)]
mod tests {
    use super::super::trial::{prepared, resolve, task};
    use super::super::{Instant, Pseudoinverse, SystemShape};
    use super::*;
    use crate::robot::Limits;
    use nalgebra::{DMatrix, Vector6};

    const START: [f64; 4] = [0.1, 0.2, 0.3, 0.4];

    fn velocity(criterion: &mut dyn Criterion, q: &[f64]) -> Vec<f64> {
        let (previous, mut c) = (vec![0.0; q.len()], vec![f64::NAN; q.len()]);
        let limits: Vec<Limits> = (1..=q.len())
            .map(|i| Limits { lower: -(i as f64), upper: i as f64, ..Limits::UNLIMITED })
            .collect();
        let instant = Instant {
            t: 0.5,
            sigma: 0.01,
            is_sample: true,
            q,
            previous_velocity: &previous,
            limits: &limits,
            tasks: &[],
            tips: &[],
            next: None,
            avoidance: None,
        };
        criterion.velocity(&instant, &mut c);
        c
    }

    /// The largest modulus of the eigenvalues of `dc / dq`, by central differences.
    fn rate(criterion: &mut dyn Criterion, q: &[f64]) -> f64 {
        let (n, step) = (q.len(), 1e-6);
        let mut derivative = DMatrix::zeros(n, n);
        for joint in 0..n {
            let mut moved = |by: f64| {
                let mut q = q.to_vec();
                q[joint] += by;
                velocity(criterion, &q)
            };
            for (row, (after, before)) in moved(step).into_iter().zip(moved(-step)).enumerate() {
                derivative[(row, joint)] = (after - before) / (2.0 * step);
            }
        }
        derivative.complex_eigenvalues().iter().map(|value| value.norm()).fold(0.0, f64::max)
    }

    #[test]
    fn every_criterion_knows_its_rate_and_leaves_the_task_alone() {
        for kind in CRITERIA {
            let given = kind.draw.expect(kind.name)(1.0, &mut |low, _| low);
            let mut criterion = (kind.make)(&given, &START);
            criterion.prepare(&SystemShape::of_one_task(2, 4, 1.0));
            let q = [0.4, -0.2, 0.7, 0.1];
            if let Some(declared) = criterion.rate() {
                let measured = rate(&mut *criterion, &q);
                assert!((measured - declared).abs() < 1e-6 * declared, "{}: {measured}", kind.name);
            }
            let columns = [[1.0, 0.2], [0.5, 1.0], [0.3, -0.4], [0.1, 0.8]];
            let columns = columns.map(|[x, y]| Vector6::new(x, y, 0.0, 0.0, 0.0, 0.0));
            let (demand, v) = ([task(2, &columns, &[0.3, -0.1], &[0.0; 2])], [0.3, -0.1]);
            let mut law = prepared(Pseudoinverse::new().with_criterion(criterion), 2, 4);
            let ([f, _], _) = resolve(&mut law, &q, &demand);
            for row in 0..2 {
                let met: f64 = columns.iter().zip(&f).map(|(column, f)| column[row] * f).sum();
                assert!((met - v[row]).abs() < 1e-12, "{}", kind.name);
            }
        }
    }
}
