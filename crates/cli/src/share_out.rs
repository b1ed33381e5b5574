//! What moves in a file, shared out among the arms of a scenario.
//!
//! Tables hold one trajectory for each arm, messages one for each machine, and other programs name theirs as they like.

use super::failure::{Exit, Failure};
use super::loaded::unknown_joint;
use kinstep::planner::Arm;
use kinstep_files::scenario::suggestion;
use kinstep_files::trajectory::ArmTrajectory;

/// What moves, arm by arm.
pub(super) struct Shares {
    /// What was found of each arm, its joints in the order of the arm's chain; then, as it was, what belongs to no arm.
    pub(super) moved: Vec<(ArmTrajectory, Option<Arm>)>,
    /// The arms on machines of which nothing was found.
    pub(super) absent: Vec<String>,
}

/// An arm of a scenario, and the joints of its robot that follow its own.
pub(super) struct Taker {
    pub(super) arm: Arm,
    pub(super) followers: Vec<String>,
}

/// Shares out what was found in a file. What no arm takes is kept only where `keeps_others`.
///
/// An arm takes its joints from what is called after it or else after its machine, or else from the only one that has them
/// all and is not called after another machine.
pub(super) fn share_out(
    found: &[ArmTrajectory],
    takers: Vec<Taker>,
    keeps_others: bool,
) -> Result<Shares, Failure> {
    let (arms, followers): (Vec<Arm>, Vec<Vec<String>>) =
        takers.into_iter().map(|taker| (taker.arm, taker.followers)).unzip();
    let takes: Vec<Option<usize>> = arms.iter().map(|arm| taken(arm, found, &arms)).collect();
    check_absence(found, &arms, &takes)?;
    let mut others = Vec::new();
    for (place, one) in found.iter().enumerate() {
        let takers = arms.iter().zip(&followers).zip(&takes).filter(|(_, take)| **take == Some(place));
        let (takers, following): (Vec<&Arm>, Vec<&Vec<String>>) = takers.map(|(taker, _)| taker).unzip();
        match takers.first() {
            Some(first) => check_takers(one, first, &takers, &following)?,
            None if keeps_others || arms.is_empty() => others.push((one.clone(), None)),
            None => {
                let hint = suggestion(&one.name, arms.iter().map(Arm::name));
                return Err(Failure::usage(format!("the scenario has no arm `{}`; {hint}", one.name)));
            }
        }
    }
    let (mut moved, mut absent) = (Vec::new(), Vec::new());
    for ((arm, followers), take) in arms.into_iter().zip(followers).zip(takes) {
        match take {
            Some(place) => moved.push((part(&found[place], &arm, &followers)?, Some(arm))),
            None => absent.push(arm.name().to_owned()),
        }
    }
    moved.extend(others);
    Ok(Shares { moved, absent })
}

fn machine(arm: &Arm) -> &str {
    arm.machine().unwrap_or(arm.name())
}

fn joints(arm: &Arm) -> Vec<&str> {
    arm.chain().joints().iter().map(|joint| joint.name.as_str()).collect()
}

/// The place of what an arm takes its joints from.
fn taken(arm: &Arm, found: &[ArmTrajectory], arms: &[Arm]) -> Option<usize> {
    let named = |name: &str| found.iter().position(|one| one.name == name);
    if let Some(place) = named(arm.name()).or_else(|| named(machine(arm))) {
        return Some(place);
    }
    let is_lone = found.len() == 1 && arms.iter().all(|other| machine(other) == machine(arm));
    let is_anothers = |one: &ArmTrajectory| {
        let others = arms.iter().filter(|other| machine(other) != machine(arm));
        others.flat_map(|other| [other.name(), machine(other)]).any(|name| name == one.name)
    };
    let own = joints(arm);
    let has_all = |one: &ArmTrajectory| own.iter().all(|joint| one.joints.iter().any(|known| known == joint));
    let candidates = found.iter().enumerate();
    let mut candidates = candidates.filter(|(_, one)| is_lone || has_all(one) && !is_anothers(one));
    let (place, _) = candidates.next()?;
    candidates.next().is_none().then_some(place)
}

/// Refuses an arm that is missing from a machine that moves, and a file in which none of the arms moves.
fn check_absence(found: &[ArmTrajectory], arms: &[Arm], takes: &[Option<usize>]) -> Result<(), Failure> {
    let is_there = |arm: &Arm| {
        let all = arms.iter().zip(takes);
        let mut here = all.filter(|(_, take)| take.is_some()).map(|(other, _)| machine(other)).peekable();
        here.peek().is_none() || here.any(|other| other == machine(arm))
    };
    let missing = arms.iter().zip(takes).find(|(arm, take)| take.is_none() && is_there(arm));
    let Some((missing, _)) = missing else { return Ok(()) };
    let hint = suggestion(missing.name(), found.iter().map(|one| one.name.as_str()));
    Err(Failure::usage(format!("the trajectory has no arm `{}`; {hint}", missing.name())))
}

/// Refuses what would be two machines at once, and joints that none of the arms has.
fn check_takers(
    one: &ArmTrajectory,
    first: &Arm,
    takers: &[&Arm],
    followers: &[&Vec<String>],
) -> Result<(), Failure> {
    if let Some(other) = takers.iter().find(|other| machine(other) != machine(first)) {
        let (name, first, other) = (&one.name, first.name(), other.name());
        return Err(Failure::usage(format!(
            "`{name}` may be arm `{first}` or arm `{other}`, which are two machines; --arm NAME says which"
        )));
    }
    let known: Vec<&str> = takers.iter().flat_map(|arm| joints(arm)).collect();
    let follows = |joint: &String| followers.iter().any(|followers| followers.contains(joint));
    match one.joints.iter().find(|joint| !known.contains(&joint.as_str()) && !follows(joint)) {
        Some(joint) => Err(unknown_joint(joint, &known, &of_scenario(takers))),
        None => Ok(()),
    }
}

/// `arm A of the scenario`, or `arms A and B of the scenario`.
fn of_scenario(arms: &[&Arm]) -> String {
    let names: Vec<String> = arms.iter().map(|arm| format!("`{}`", arm.name())).collect();
    let word = if names.len() == 1 { "arm" } else { "arms" };
    format!("{word} {} of the scenario", names.join(" and "))
}

/// The joints of an arm and those that follow them, out of what moves them.
fn part(one: &ArmTrajectory, arm: &Arm, followers: &[String]) -> Result<ArmTrajectory, Failure> {
    let mut joints = joints(arm);
    if let Some(missing) = joints.iter().find(|joint| !one.joints.iter().any(|known| known == *joint)) {
        let message = format!("the trajectory does not move joint `{missing}` of {}", of_scenario(&[arm]));
        return Err(Failure::new(Exit::Robot, message));
    }
    joints.extend(followers.iter().map(String::as_str));
    Ok(ArmTrajectory { name: arm.name().to_owned(), ..one.with_joints(&joints).into_owned() })
}
