use crate::law::Law;
use crate::task::Task;
use std::sync::Arc;

/// Arms that are resolved as one system, because a task ties them together or because one law shall see all their joints.
///
/// ```
/// use kinstep::law::Pseudoinverse;
/// use kinstep::planner::JointSystem;
///
/// let pair = JointSystem::of(["left", "right"]).with_law(Pseudoinverse::new());
/// # let _ = pair;
/// ```
pub struct JointSystem {
    pub(in crate::planner) arms: Vec<String>,
    pub(in crate::planner) tasks: Vec<AddedTask>,
    pub(in crate::planner) law: Option<Box<dyn Law>>,
}

/// A task beside those of the arms.
#[derive(Clone)]
pub(in crate::planner) struct AddedTask {
    pub(in crate::planner) name: String,
    pub(in crate::planner) task: Arc<dyn Task>,
    /// The arms whose tips it is about, in its own order.
    pub(in crate::planner) arms: Vec<String>,
    pub(in crate::planner) priority: usize,
    pub(in crate::planner) weight: f64,
}

impl std::fmt::Debug for JointSystem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let tasks: Vec<&str> = self.tasks.iter().map(|added| added.name.as_str()).collect();
        f.debug_struct("JointSystem").field("arms", &self.arms).field("tasks", &tasks).finish_non_exhaustive()
    }
}

impl JointSystem {
    /// The arms of these names as one system, with their own tasks, resolved by the least-norm law.
    pub fn of(arms: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self { arms: arms.into_iter().map(Into::into).collect(), tasks: Vec::new(), law: None }
    }

    /// The same with one more task over the tips of all its arms, in the order in which they were named.
    #[must_use]
    pub fn with_task(self, task: impl Task + 'static) -> Self {
        let arms = self.arms.clone();
        self.with_task_of(arms, task, 0, 1.0)
    }

    /// The same with one more task over the tips of the arms of these names, of a priority (what comes first is met first)
    /// and a weight among tasks that can not all be met, for laws that know of either.
    #[must_use]
    pub fn with_task_of(
        mut self,
        arms: impl IntoIterator<Item = impl Into<String>>,
        task: impl Task + 'static,
        priority: usize,
        weight: f64,
    ) -> Self {
        let arms = arms.into_iter().map(Into::into).collect();
        let name = task.name().to_owned();
        self.tasks.push(AddedTask { name, task: Arc::new(task), arms, priority, weight });
        self
    }

    /// The same with a name for the task that was added last, in place of that of its kind.
    #[must_use]
    pub fn called(mut self, name: impl Into<String>) -> Self {
        if let Some(added) = self.tasks.last_mut() {
            added.name = name.into();
        }
        self
    }

    /// The same with a law of its own, in place of those of its arms.
    #[must_use]
    pub fn with_law(mut self, law: impl Law + 'static) -> Self {
        self.law = Some(Box::new(law));
        self
    }
}
