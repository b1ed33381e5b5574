use super::arm::{Arm, pose, tip_of};
use crate::task::{Task, TaskInstant, TaskRows};
use nalgebra::DMatrix;

/// How far the derivatives that a task states are from those of its error: what a test of a task of your own asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DerivativeErrors {
    /// The norm of the error itself [m, rad]: where the error is an angle, the Jacobian is its derivative on the path only.
    pub error: f64,
    /// The largest difference between an entry of the Jacobian and the central difference of the error.
    pub jacobian: f64,
    /// The largest difference between an entry of the feedforward and minus the central difference of the error in time.
    pub feedforward: f64,
}

/// Compares what a task states with central differences of its error, with steps of `step` in joints and time, at the joint
/// positions at which `arms` start and at time `t` \[s\]. The task is about all the arms, in their order; each moves joints of
/// its own.
///
/// ```
/// use kinstep::planner::{Arm, derivative_errors};
/// use kinstep::robot::embedded;
/// use kinstep::task::{Circle, Motion, Planar, Quintic, TaskKind, Tracking};
///
/// let chain = embedded::get("planar4")?.chain("base", "tip")?;
/// let q0 = vec![0.3, 0.4, 0.5, 0.6];
/// let start = chain.forward(&q0, &mut chain.scratch()).pose();
/// let motion = || Motion::from_pose(Planar::whole(Circle { radius: 0.3 }), Quintic, 2.0, &start);
/// let task = Tracking { kind: TaskKind::PositionXy, motion: motion() };
/// let arm = Arm::new("arm", chain, q0, TaskKind::PositionXy, motion());
/// let errors = derivative_errors(&[arm], &task, 0.0, 1e-5);
/// assert!(errors.error < 1e-12 && errors.jacobian < 1e-9 && errors.feedforward < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derivative_errors(arms: &[Arm], task: &dyn Task, t: f64, step: f64) -> DerivativeErrors {
    let q: Vec<f64> = arms.iter().flat_map(|arm| arm.q0.clone()).collect();
    let stated = rows_at(arms, task, t, &q);
    let difference = |ahead: TaskRows, behind: TaskRows| {
        let pairs = ahead.error.into_iter().zip(behind.error);
        pairs.map(|(ahead, behind)| (ahead - behind) / (2.0 * step)).collect::<Vec<f64>>()
    };
    let mut jacobian = DMatrix::zeros(stated.rows(), q.len());
    for joint in 0..q.len() {
        let moved = |by: f64| {
            let mut q = q.clone();
            q[joint] += by;
            rows_at(arms, task, t, &q)
        };
        jacobian.column_mut(joint).copy_from_slice(&difference(moved(step), moved(-step)));
    }
    let in_time = difference(rows_at(arms, task, t + step, &q), rows_at(arms, task, t - step, &q));
    // A NaN is the largest of all: what can not be compared is not right.
    let largest = |sum: f64, difference: f64| if difference.abs() <= sum { sum } else { difference.abs() };
    DerivativeErrors {
        error: stated.error.iter().map(|entry| entry * entry).sum::<f64>().sqrt(),
        jacobian: (&jacobian - &stated.jacobian).iter().copied().fold(0.0, largest),
        feedforward: stated
            .feedforward
            .iter()
            .zip(&in_time)
            .map(|(stated, seen)| stated + seen)
            .fold(0.0, largest),
    }
}

/// The rows of a task over all the arms, in their order, at the joint positions at which they start and at time `t` \[s\]. The
/// columns of its Jacobian are the joints of the arms one after the other.
pub fn rows_at_start(arms: &[Arm], task: &dyn Task, t: f64) -> TaskRows {
    let q: Vec<f64> = arms.iter().flat_map(|arm| arm.q0.clone()).collect();
    rows_at(arms, task, t, &q)
}

fn rows_at(arms: &[Arm], task: &dyn Task, t: f64, q: &[f64]) -> TaskRows {
    let (mut tips, mut first) = (Vec::new(), 0);
    for arm in arms {
        let joints: Vec<usize> = (first..first + arm.chain.dof()).collect();
        first += joints.len();
        let mut tip = tip_of(&arm.chain, joints);
        let mut scratch = arm.chain.scratch();
        pose(&mut tip, arm.chain.forward(&q[first - arm.chain.dof()..first], &mut scratch));
        tips.push(tip);
    }
    let chosen: Vec<usize> = (0..tips.len()).collect();
    let mut rows = TaskRows::zeros(task.rows(), q.len());
    task.evaluate(&TaskInstant::new(t, q, &tips, &chosen), &mut rows);
    rows
}
