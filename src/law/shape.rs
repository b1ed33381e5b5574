/// What stays the same of a system from instant to instant: by it a law allocates what it needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SystemShape {
    /// The names of the joints, in the order of the entries of a joint velocity.
    pub joints: Vec<String>,
    /// The tasks, in the order in which an instant has them.
    pub tasks: Vec<TaskShape>,
    /// The sampling gap of the run \[s\].
    pub sigma: f64,
}

/// What stays the same of a task in a system.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TaskShape {
    /// The task's name.
    pub name: String,
    /// How many rows it has.
    pub rows: usize,
    /// Whether some of its rows are angles beside lengths: its singular values then depend on the unit of length.
    pub mixes_units: bool,
    /// The length \[m\] by which its singular values are judged: the reach of its tips.
    pub length: f64,
    /// The places of the joints that it may depend on; in all other columns its Jacobian is zero.
    pub joints: Vec<usize>,
    /// Its place in a stack of tasks: what comes first is met first. Zero unless it was given one.
    pub priority: usize,
}

impl SystemShape {
    /// The shape of one task of `rows` rows that depends on all of so many joints, with singular values judged by `length` \[m\].
    pub fn of_one_task(rows: usize, joints: usize, length: f64) -> Self {
        let task = TaskShape {
            name: "task".to_owned(),
            rows,
            mixes_units: rows == 6,
            length,
            joints: (0..joints).collect(),
            priority: 0,
        };
        Self {
            joints: (0..joints).map(|joint| format!("joint {joint}")).collect(),
            tasks: vec![task],
            sigma: 0.0,
        }
    }

    /// How many rows all tasks have together.
    pub fn rows(&self) -> usize {
        self.tasks.iter().map(|task| task.rows).sum()
    }
}
