use crate::task::Component;

/// What stays the same of a system from instant to instant: by it a law allocates what it needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SystemShape {
    /// The names of the joints, in the order of the entries of a joint velocity.
    pub joints: Vec<String>,
    /// The tasks, in the order in which an instant has them.
    pub tasks: Vec<TaskShape>,
    /// How many axes move each of the tips of its arms.
    pub axes: Vec<usize>,
    /// The sampling gap of the run \[s\].
    pub sigma: f64,
    /// How many entries [`Avoidance::contacts`](super::Avoidance::contacts) may have.
    pub contacts: usize,
}

/// What stays the same of a task in a system.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskShape {
    /// The task's name.
    pub name: String,
    /// What each of its rows measures.
    pub components: Vec<Component>,
    /// The tips that it is about, by their places among those of the system.
    pub tips: Vec<usize>,
    /// The length \[m\] by which its singular values are judged: the reach of its tips.
    pub length: f64,
    /// The places of the joints that it may depend on; in all other columns its Jacobian is zero.
    pub joints: Vec<usize>,
    /// Its place in a stack of tasks: what comes first is met first. Zero unless it was given one.
    pub priority: usize,
    /// Its weight among tasks that can not all be met: one unless it was given another.
    pub weight: f64,
}

impl SystemShape {
    /// The shape of one task of `rows` rows that depends on all of so many joints, with singular values judged by `length` \[m\].
    pub fn of_one_task(rows: usize, joints: usize, length: f64) -> Self {
        let task = TaskShape {
            name: "task".to_owned(),
            components: Component::ALL.into_iter().cycle().take(rows).collect(),
            tips: vec![0],
            length,
            joints: (0..joints).collect(),
            priority: 0,
            weight: 1.0,
        };
        Self {
            joints: (0..joints).map(|joint| format!("joint {joint}")).collect(),
            tasks: vec![task],
            axes: vec![joints],
            sigma: 0.0,
            contacts: 0,
        }
    }

    /// How many rows all tasks have together.
    pub fn rows(&self) -> usize {
        self.tasks.iter().map(TaskShape::rows).sum()
    }
}

impl TaskShape {
    /// How many rows it has.
    pub fn rows(&self) -> usize {
        self.components.len()
    }

    /// Whether some of its rows are angles.
    pub fn has_angles(&self) -> bool {
        self.components.iter().any(|component| component.is_angular())
    }
}

/// What a law that meets all tasks alike has to say of a shape, as the end of a sentence that begins with "this law".
pub(super) fn one_priority(shape: &SystemShape) -> Option<String> {
    let [first, rest @ ..] = &shape.tasks[..] else { return Some("needs a task to resolve".to_owned()) };
    let other = rest.iter().find(|task| task.priority != first.priority)?;
    Some(format!(
        "meets all tasks alike, and `{}` has priority {} beside the {} of `{}`; the law \"prioritized\" meets one after the other",
        other.name, other.priority, first.priority, first.name
    ))
}
