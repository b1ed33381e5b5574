//! What tests of laws share: instants made of columns and velocities.

use super::{Instant, JointVelocity, Law, Resolution, SystemShape};
use crate::task::TaskRows;
use nalgebra::{DMatrix, Vector6};

/// The first `rows` rows of a Jacobian with these columns, and what is asked of them.
pub(super) fn task(rows: usize, columns: &[Vector6<f64>], feedforward: &[f64], feedback: &[f64]) -> TaskRows {
    let jacobian = DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row]);
    let (feedforward, feedback) = (feedforward[..rows].to_vec(), feedback[..rows].to_vec());
    TaskRows { feedforward, feedback, jacobian, ..TaskRows::zeros(rows, columns.len()) }
}

/// The law prepared for one task, judged by a length of a metre.
pub(super) fn prepared<L: Law>(mut law: L, rows: usize, joints: usize) -> L {
    law.prepare(&SystemShape::of_one_task(rows, joints, 1.0));
    law
}

/// Both parts of the answer of a prepared law.
pub(super) fn resolve(law: &mut impl Law, q: &[f64], tasks: &[TaskRows]) -> ([Vec<f64>; 2], Resolution) {
    let (mut f, mut g) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    let rest = vec![0.0; q.len()];
    let instant = Instant {
        t: 0.0,
        sigma: 0.01,
        is_sample: true,
        q,
        previous_velocity: &rest,
        limits: &[],
        tasks,
        tips: &[],
        next: None,
        avoidance: None,
    };
    let mut answer = JointVelocity { feedforward: &mut f, feedback: &mut g };
    let resolution = law.resolve(&instant, &mut answer).expect("a law that always has an answer");
    ([f, g], resolution)
}
