//! The robots of a scenario as they stand, for whatever shows or hands on what they did.

use std::path::Path;

use super::build::read_robot;
use super::error::{ErrorKind, ScenarioError};
use super::key_path::KeyPath;
use super::model::{ArmSpec, Scenario};
use super::robots::RobotSource;
use crate::trajectory::{Machine, Stage, StagedArm};
use kinstep::robot::Robot;

/// A machine while its tools are put on.
struct Draft<'s> {
    owner: &'s ArmSpec,
    source: RobotSource,
    robot: Robot,
}

impl Scenario {
    /// Returns the robots of the scenario and the chains of its arms; robot files are looked for from `folder`, the place of
    /// the scenario's own file. Arms of one robot at one place are parts of one machine.
    ///
    /// # Errors
    /// As [`Scenario::planner`].
    pub fn stage(&self, folder: Option<&Path>) -> Result<Stage, ScenarioError> {
        let mut drafts: Vec<Draft<'_>> = Vec::new();
        let mut places = Vec::new();
        for spec in &self.arm {
            let at = KeyPath::dotted("arm").key(&spec.name);
            let known = drafts.iter().position(|draft| draft.owner.is_same_machine(spec));
            let machine = known.unwrap_or(drafts.len());
            if known.is_none() {
                let (source, robot) = read_robot(&at, spec, folder)?;
                let robot = spec.changed(&at, robot, &self.law, folder)?;
                drafts.push(Draft { owner: spec, source, robot });
            }
            let (robot, tip) = spec.tooled(&at, drafts[machine].robot.clone())?;
            drafts[machine].robot = robot;
            places.push((spec, machine, tip));
        }
        let machines: Vec<Machine> = drafts.into_iter().map(Draft::finished).collect();
        let arms = places.iter().map(|(spec, machine, tip)| staged(spec, *machine, &machines[*machine], tip));
        let arms = arms.collect::<Result<_, _>>()?;
        Ok(Stage { machines, arms })
    }
}

impl Draft<'_> {
    fn finished(self) -> Machine {
        Machine {
            urdf: self.source.urdf(),
            folder: self.source.folder(),
            ..Machine::new(&self.owner.name, self.robot, &self.owner.base, &self.owner.mount.pose())
        }
    }
}

fn staged(spec: &ArmSpec, index: usize, machine: &Machine, tip: &str) -> Result<StagedArm, ScenarioError> {
    let at = KeyPath::dotted("arm").key(&spec.name).key("tip");
    let refused = |e: &dyn std::fmt::Display| ScenarioError::at(ErrorKind::Robot, &at, e);
    let chain = machine.robot.chain(&spec.base, tip).map_err(|e| refused(&e))?.mounted(&spec.mount.pose());
    StagedArm::new(&spec.name, (index, &machine.robot), chain, spec.task.whole())
        .ok_or_else(|| refused(&"the chain moves a joint that the robot does not have"))
}

#[cfg(test)]
mod tests {
    use crate::scenario::ScenarioText;
    use crate::trajectory::assert_tips_stand_where_the_chains_have_them;

    #[test]
    fn arms_of_one_machine_stand_on_it_together_with_their_tools() {
        let text = include_str!("../../../../examples/shared_torso.toml");
        let mut text = ScenarioText::parse(text).unwrap();
        let names: Vec<String> = text.scenario().unwrap().arm.iter().map(|arm| arm.name.clone()).collect();
        for (name, x) in names.iter().zip(["0.1", "0.2"]) {
            text.set(&format!("arm.{name}.tool.xyz=[{x}, 0, 0]")).unwrap();
        }
        let stage = text.scenario().unwrap().stage(None).unwrap();
        assert_eq!((stage.machines.len(), stage.arms.len()), (1, 2));
        assert_tips_stand_where_the_chains_have_them(&stage, |_| 0.2);
    }
}
