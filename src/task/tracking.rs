use super::{Motion, Task, TaskInstant, TaskKind, TaskRows};

/// The plain task of an arm: its tip tracks a motion in the components that a [`TaskKind`] names.
#[derive(Debug)]
pub struct Tracking {
    /// What of the tip tracks the motion.
    pub kind: TaskKind,
    /// Where it shall be.
    pub motion: Motion,
}

impl Task for Tracking {
    fn name(&self) -> &str {
        self.kind.name()
    }

    fn rows(&self) -> usize {
        self.kind.rows()
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let (tip, reference, rows) = (at.tip(0), self.motion.at(at.t), self.rows());
        let error = self.kind.error(&tip.pose, &reference);
        out.error.copy_from_slice(&error.as_slice()[..rows]);
        out.feedforward.copy_from_slice(&reference.twist.as_slice()[..rows]);
        for (column, &joint) in tip.jacobian.iter().zip(&tip.joints) {
            out.jacobian.column_mut(joint).copy_from_slice(&column.as_slice()[..rows]);
        }
    }

    fn tracking(&self) -> Option<(TaskKind, &Motion)> {
        Some((self.kind, &self.motion))
    }
}
