//! Which arms form which systems.

use super::PlannerError;
use super::system::{
    AddedTask, Arm, ArmRuntime, JointSystem, Surroundings, System, check_common_starts, joint_sets,
};
use crate::law::Law;
use crate::task::Task;

/// The arms with their scratch memory, and the systems that they form: first those of several arms, then single arms. Where a law
/// keeps distances, all arms are one system.
pub(super) fn resolved(
    arms: Vec<Arm>,
    mut asked: Vec<JointSystem>,
    sigma: f64,
    surroundings: Option<&Surroundings>,
) -> Result<(Vec<ArmRuntime>, Vec<System>), PlannerError> {
    let mut laws = arms.iter().map(|arm| &arm.law).chain(asked.iter().map(|system| &system.law));
    if surroundings.is_some() && laws.any(|law| law.as_deref().is_some_and(Law::keeps_distances)) {
        asked.push(JointSystem::of(arms.iter().map(Arm::name)));
    }
    let added = || asked.iter().flat_map(|system| &system.tasks);
    for arm in arms.iter().filter(|arm| !arm.has_own_task()) {
        if !added().any(|added| added.arms.contains(&arm.name)) {
            return Err(PlannerError::NoTask { arm: arm.name.clone() });
        }
    }
    for added in added() {
        check_task(&added.name, &*added.task, added.arms.len(), added.weight)?;
    }
    let ties: Vec<Vec<usize>> = asked.iter().map(|system| tie(system, &arms)).collect::<Result<_, _>>()?;
    let sets = joint_sets(&arms, &ties);
    let is_apart = |arm: &usize| !sets.iter().any(|set| set.contains(arm));
    let apart: Vec<Vec<usize>> = (0..arms.len()).filter(is_apart).map(|arm| vec![arm]).collect();
    let mut laws = Vec::new();
    for set in sets.iter().chain(&apart) {
        check_common_starts(&arms, set)?;
        let own = ties.iter().zip(&mut asked).filter(|(tie, _)| tie.iter().any(|arm| set.contains(arm)));
        laws.push(law_and_tasks(own.map(|(_, system)| system), &arms, set)?);
    }
    let mut runtimes: Vec<ArmRuntime> = arms.into_iter().map(|arm| ArmRuntime::new(arm, sigma)).collect();
    let mut systems = Vec::new();
    for (set, (law, tasks)) in sets.iter().chain(&apart).zip(laws) {
        systems.push(System::new(&mut runtimes, set, &tasks, law, sigma, surroundings)?);
    }
    Ok((runtimes, systems))
}

/// Checks what a task over tips says of itself, and that it is given as many tips as it needs.
fn check_task(name: &str, task: &dyn Task, tips: usize, weight: f64) -> Result<(), PlannerError> {
    let problem = if task.rows() == 0 {
        "has no rows; it needs one at least".to_owned()
    } else if tips < task.least_tips() {
        format!("needs {} tips and was given {tips}", task.least_tips())
    } else if !(weight > 0.0 && weight.is_finite()) {
        format!("has weight {weight}; a weight is a positive number")
    } else {
        return Ok(());
    };
    Err(PlannerError::Task { task: name.to_owned(), problem })
}

/// The arms that are asked to be one system, by their indices.
fn tie(system: &JointSystem, arms: &[Arm]) -> Result<Vec<usize>, PlannerError> {
    if system.arms.is_empty() {
        return Err(PlannerError::SystemWithoutArms);
    }
    let index = |name: &String| {
        arms.iter().position(|arm| arm.name == *name).ok_or_else(|| PlannerError::UnknownArm {
            name: name.clone(),
            known: arms.iter().map(|arm| arm.name.as_str()).collect::<Vec<_>>().join("`, `"),
        })
    };
    let named = system.arms.iter().chain(system.tasks.iter().flat_map(|added| &added.arms));
    let mut tie: Vec<usize> = named.map(index).collect::<Result<_, _>>()?;
    tie.sort_unstable();
    tie.dedup();
    Ok(tie)
}

type LawAndTasks = (Option<Box<dyn Law>>, Vec<AddedTask>);

/// The law that a set of arms was given as a system, and the tasks beside those of the arms.
fn law_and_tasks<'a>(
    asked: impl Iterator<Item = &'a mut JointSystem>,
    arms: &[Arm],
    set: &[usize],
) -> Result<LawAndTasks, PlannerError> {
    let (mut law, mut tasks) = (None, Vec::new());
    for system in asked {
        tasks.append(&mut system.tasks);
        if let Some(own) = system.law.take()
            && law.replace(own).is_some()
        {
            let arms = set.iter().map(|&arm| arms[arm].name.as_str()).collect::<Vec<_>>().join("`, `");
            return Err(PlannerError::TwoLaws { arms });
        }
    }
    let unusual = set.iter().map(|&arm| &arms[arm]).find(|arm| !arm.has_plain_law());
    match unusual {
        Some(arm) if law.is_none() && set.len() > 1 => Err(PlannerError::SharedLaw { arm: arm.name.clone() }),
        _ => Ok((law, tasks)),
    }
}
