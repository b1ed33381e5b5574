//! A task over the tips of several arms, beside their own.

use nalgebra::IsometryMatrix3;
use serde::{Deserialize, Serialize};

use super::error::{ErrorKind, ScenarioError, suggestion};
use super::key_path::KeyPath;
use super::kind_reader::named;
use super::kinds::Kinds;
use super::model::Scenario;
use kinstep::kind::Parameters;
use kinstep::planner::Arm;
use kinstep::task::{Task, TaskStart};

/// What the tips of several arms do together, beside what each of them does: these arms are resolved as one system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(transform = super::kind_schema::tasks))]
#[serde(expecting = "a table such as { kind = \"distance\", arms = [\"left\", \"right\"] }")]
pub struct TaskSpec {
    /// The task.
    pub kind: String,
    /// The arms whose tips it is about, by name, in the task's own order.
    pub arms: Vec<String>,
    /// The parameters of its kind.
    #[serde(flatten)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub parameters: Parameters,
}

impl TaskSpec {
    /// Returns a task of that kind over the tips of these arms, without parameters.
    pub fn new(kind: &str, arms: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let arms = arms.into_iter().map(Into::into).collect();
        Self { kind: kind.to_owned(), arms, parameters: Parameters::new() }
    }

    /// Checks which arms it names.
    pub(super) fn check_arms(
        &self,
        at: &KeyPath,
        kinds: &Kinds,
        scenario: &Scenario,
    ) -> Result<(), ScenarioError> {
        let at_arms = at.key("arms");
        let refuse = |at: &KeyPath, problem: String| ScenarioError::at(ErrorKind::Scenario, at, problem);
        let tips = named(&kinds.tasks, &at.key("kind"), &self.kind)?.make.tips;
        if self.arms.len() != tips {
            let (kind, got) = (&self.kind, self.arms.len());
            return Err(refuse(&at_arms, format!("a {kind} is about the tips of {tips} arms, got {got}")));
        }
        for (index, name) in self.arms.iter().enumerate() {
            if scenario.arm.iter().all(|arm| arm.name != *name) {
                let hint = suggestion(name, scenario.arm.iter().map(|arm| arm.name.as_str()));
                return Err(refuse(&at_arms.index(index), format!("there is no arm \"{name}\"; {hint}")));
            }
            if self.arms[..index].contains(name) {
                return Err(refuse(&at_arms.index(index), format!("the arm \"{name}\" is named twice")));
            }
        }
        Ok(())
    }

    /// Returns the task of arms as they start.
    pub(super) fn task(
        &self,
        at: &KeyPath,
        kinds: &Kinds,
        arms: &[Arm],
        duration: f64,
    ) -> Result<Box<dyn Task>, ScenarioError> {
        let kind = named(&kinds.tasks, &at.key("kind"), &self.kind)?;
        let own = self.arms.iter().filter_map(|name| arms.iter().find(|arm| arm.name() == name));
        let tips: Vec<IsometryMatrix3<f64>> = own.map(tip_at_start).collect();
        (kind.make.make)(&self.parameters, &TaskStart { tips: &tips, duration })
            .map_err(|problem| ScenarioError::at(ErrorKind::Scenario, at, problem))
    }
}

fn tip_at_start(arm: &Arm) -> IsometryMatrix3<f64> {
    let (chain, joints) = (arm.chain(), arm.chain().joints().iter());
    let q0: Vec<f64> = joints.filter_map(|joint| arm.start_of(&joint.name)).collect();
    chain.forward(&q0, &mut chain.scratch()).pose()
}
