use super::{Motion, TaskKind};
use crate::robot::MovingAxis;
use nalgebra::{DMatrix, IsometryMatrix3, Vector6};

/// What the joints of a system shall do: rows `J q' = phi' - k e`, of any number, over one tip or several.
///
/// Three methods are required. A task is evaluated once per instant: it writes its error, the derivative of the error by the
/// joints, and the velocity that keeps the error where it is. Tasks of your own use the same door as the built-in ones:
///
/// ```
/// use kinstep::nalgebra::Vector6;
/// use kinstep::task::{Task, TaskInstant, TaskRows};
///
/// /// Two tips keep their distance \[m\].
/// struct Distance(f64);
///
/// impl Task for Distance {
///     fn name(&self) -> &str {
///         "distance"
///     }
///
///     fn rows(&self) -> usize {
///         1
///     }
///
///     fn least_tips(&self) -> usize {
///         2
///     }
///
///     fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
///         let (one, other) = (at.tip(0), at.tip(1));
///         let apart = other.pose.translation.vector - one.pose.translation.vector;
///         let along = apart.normalize();
///         let direction = Vector6::new(along.x, along.y, along.z, 0.0, 0.0, 0.0);
///         out.error[0] = apart.norm() - self.0;
///         out.feedforward[0] = 0.0;
///         out.add_to_row(0, other, &direction);
///         out.add_to_row(0, one, &-direction);
///     }
/// }
/// ```
pub trait Task: Send + Sync {
    /// The name used in reports.
    fn name(&self) -> &str;

    /// How many rows it has: at least one.
    fn rows(&self) -> usize;

    /// How many tips it needs to be given at least: one unless overridden. Fewer are refused before a run.
    fn least_tips(&self) -> usize {
        1
    }

    /// Writes the rows at an instant: `error`, `feedforward` and `jacobian`, which is zero before.
    ///
    /// On the path, where the error is zero, `d error / dt = J q' - feedforward`; `planner::derivative_errors` checks it by
    /// finite differences.
    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows);

    /// What a row is: by this, errors are added up in metres and in radians. Unless overridden, rows are linear x, y and z,
    /// then angular x, y and z.
    fn component(&self, row: usize) -> Component {
        Component::ALL[row % 6]
    }

    /// What its tip tracks in which components, if that is all there is to the task: the planner evaluates several such
    /// tasks at once, and knows more of why a run was lost.
    fn tracking(&self) -> Option<(TaskKind, &Motion)> {
        None
    }
}

impl Task for Box<dyn Task> {
    fn name(&self) -> &str {
        (**self).name()
    }

    fn rows(&self) -> usize {
        (**self).rows()
    }

    fn least_tips(&self) -> usize {
        (**self).least_tips()
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        (**self).evaluate(at, out);
    }

    fn component(&self, row: usize) -> Component {
        (**self).component(row)
    }

    fn tracking(&self) -> Option<(TaskKind, &Motion)> {
        (**self).tracking()
    }
}

/// What a row of a task measures, in axes of the task's own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// A length \[m\] along an axis (0, 1, 2 for x, y, z).
    Linear(usize),
    /// An angle \[rad\] about an axis (0, 1, 2 for x, y, z).
    Angular(usize),
}

impl Component {
    /// All six in their order: linear first.
    pub const ALL: [Self; 6] = [
        Self::Linear(0),
        Self::Linear(1),
        Self::Linear(2),
        Self::Angular(0),
        Self::Angular(1),
        Self::Angular(2),
    ];

    /// Their names in files, in the same order.
    pub const NAMES: [&'static str; 6] = ["x", "y", "z", "rx", "ry", "rz"];

    /// The component of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().position(|own| *own == name).map(|place| Self::ALL[place])
    }

    /// Its name in files.
    pub fn name(self) -> &'static str {
        Self::NAMES[self.place()]
    }

    /// Its place in a 6-vector (linear; angular).
    pub fn place(self) -> usize {
        match self {
            Self::Linear(axis) => axis % 3,
            Self::Angular(axis) => 3 + axis % 3,
        }
    }

    /// Whether it is an angle.
    pub fn is_angular(self) -> bool {
        matches!(self, Self::Angular(_))
    }
}

/// A tip of a system at an instant.
#[derive(Clone, Debug)]
pub struct Tip {
    /// Its pose in the world.
    pub pose: IsometryMatrix3<f64>,
    /// The columns of its geometric Jacobian (linear; angular) in world axes, one per joint that moves it.
    pub jacobian: Vec<Vector6<f64>>,
    /// The axes that these columns are sums of, from the base to the tip.
    pub axes: Vec<MovingAxis>,
    /// The places of these joints among those of the system.
    pub joints: Vec<usize>,
}

/// What a task is evaluated at: the time, the joints of the system, and the tips that the task is about.
#[derive(Clone, Copy, Debug)]
pub struct TaskInstant<'a> {
    /// Time \[s\].
    pub t: f64,
    /// Joint positions of the whole system [rad or m].
    pub q: &'a [f64],
    tips: &'a [Tip],
    chosen: &'a [usize],
}

impl<'a> TaskInstant<'a> {
    /// An instant of a system with these `tips`, of which a task sees the `chosen` ones, in that order.
    pub fn new(t: f64, q: &'a [f64], tips: &'a [Tip], chosen: &'a [usize]) -> Self {
        Self { t, q, tips, chosen }
    }

    /// The tip `i` of those that the task is about, in the order in which it was given their arms.
    ///
    /// # Panics
    /// If the task is about fewer tips.
    pub fn tip(&self, i: usize) -> &'a Tip {
        &self.tips[self.chosen[i]]
    }

    /// How many tips the task is about.
    pub fn tips(&self) -> usize {
        self.chosen.len()
    }
}

/// The rows of a task at an instant: what it asks of the joints of its system, `J q' = phi' - k e`.
#[derive(Clone, Debug)]
pub struct TaskRows {
    /// The error `e` [m or rad], one entry per row.
    pub error: Vec<f64>,
    /// The velocity `phi'` [m/s or rad/s] that the motion itself asks for.
    pub feedforward: Vec<f64>,
    /// The corrective velocity `-k e` [m/s or rad/s], written by the planner.
    pub feedback: Vec<f64>,
    /// The Jacobian `J`: rows x joints of the system.
    pub jacobian: DMatrix<f64>,
    /// Its place in a stack of tasks: what comes first is met first.
    pub priority: usize,
    /// Its weight among tasks that can not all be met.
    pub weight: f64,
}

impl TaskRows {
    /// Rows that are all zero.
    pub fn zeros(rows: usize, joints: usize) -> Self {
        Self {
            error: vec![0.0; rows],
            feedforward: vec![0.0; rows],
            feedback: vec![0.0; rows],
            jacobian: DMatrix::zeros(rows, joints),
            priority: 0,
            weight: 1.0,
        }
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.error.len()
    }

    /// Adds to a row of the Jacobian what a motion of the tip along `direction` (linear; angular) adds to the error.
    pub fn add_to_row(&mut self, row: usize, tip: &Tip, direction: &Vector6<f64>) {
        for (column, &joint) in tip.jacobian.iter().zip(&tip.joints) {
            self.jacobian[(row, joint)] += column.dot(direction);
        }
    }

    /// The error as a 6-vector (linear \[m\]; angular \[rad\]) by what the rows of `task` are. Rows that are the same
    /// component add up as squares.
    pub fn error_by_component(&self, task: &dyn Task) -> Vector6<f64> {
        let mut error = Vector6::<f64>::zeros();
        for (row, &entry) in self.error.iter().enumerate() {
            let sum = &mut error[task.component(row).place()];
            *sum = if *sum == 0.0 { entry } else { sum.hypot(entry) };
        }
        error
    }
}
