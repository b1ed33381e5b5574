use super::SystemShape;
use crate::math::dot;
use crate::task::TaskRows;

/// The rows of all tasks of a system, one after the other: `J`, and what is asked of it in both parts.
#[derive(Clone, Debug, Default)]
pub(super) struct TaskStack {
    joints: usize,
    /// Row after row.
    pub(super) jacobian: Vec<f64>,
    pub(super) feedforward: Vec<f64>,
    pub(super) feedback: Vec<f64>,
    /// The tasks that rows belong to, and their places there.
    places: Vec<(usize, usize)>,
}

impl TaskStack {
    /// Room for systems of this shape.
    pub(super) fn new(shape: &SystemShape) -> Self {
        let (rows, joints) = (shape.rows(), shape.joints.len());
        let places = shape.tasks.iter().enumerate();
        Self {
            joints,
            jacobian: vec![0.0; rows * joints],
            feedforward: vec![0.0; rows],
            feedback: vec![0.0; rows],
            places: places.flat_map(|(task, shape)| (0..shape.rows()).map(move |row| (task, row))).collect(),
        }
    }

    /// Stacks the rows of all tasks.
    pub(super) fn collect(&mut self, tasks: &[TaskRows]) {
        let mut first = 0;
        for task in tasks {
            let rows = first..first + task.rows();
            self.feedforward[rows.clone()].copy_from_slice(&task.feedforward);
            self.feedback[rows.clone()].copy_from_slice(&task.feedback);
            let stacked = self.jacobian.chunks_exact_mut(self.joints).skip(first);
            for (row, stacked) in (0..task.rows()).zip(stacked) {
                for (entry, own) in stacked.iter_mut().zip(task.jacobian.row(row).iter()) {
                    *entry = *own;
                }
            }
            first = rows.end;
        }
    }

    /// A row of `J`.
    pub(super) fn row(&self, row: usize) -> &[f64] {
        &self.jacobian[row * self.joints..(row + 1) * self.joints]
    }

    /// The task that a row belongs to, and its place there.
    pub(super) fn place(&self, row: usize) -> (usize, usize) {
        self.places[row]
    }

    /// Writes `J` times a velocity of all joints.
    pub(super) fn image(&self, velocity: &[f64], out: &mut [f64]) {
        for (row, out) in out.iter_mut().enumerate() {
            *out = dot(self.row(row), velocity);
        }
    }
}
