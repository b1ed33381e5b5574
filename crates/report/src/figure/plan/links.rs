//! The links that an arm is drawn through.

use kinstep::robot::Robot;

/// Returns the links of a robot from one to another, by their places: up to what both hang from, and down again.
pub(super) fn links_between(robot: &Robot, base: &str, tip: &str) -> Vec<usize> {
    let place = |name: &str| robot.links().iter().position(|link| link.name == name);
    let (Some(base), Some(tip)) = (place(base), place(tip)) else { return Vec::new() };
    let (mut up, down) = (ancestors(robot, base), ancestors(robot, tip));
    let Some(common) = down.iter().position(|link| up.contains(link)) else { return Vec::new() };
    up.truncate(up.iter().position(|link| *link == down[common]).unwrap_or(0));
    up.extend(down[..=common].iter().rev());
    up
}

/// A link and all that it hangs from.
fn ancestors(robot: &Robot, link: usize) -> Vec<usize> {
    let above = |link: &usize| robot.links()[*link].parent_joint.map(|joint| robot.joints()[joint].parent);
    std::iter::successors(Some(link), above).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::robot::embedded;

    #[test]
    fn links_lead_from_hand_to_hand_through_what_carries_both() {
        let robot = embedded::get("baxter").unwrap();
        let names = |base: &str, tip: &str| -> Vec<&str> {
            links_between(&robot, base, tip)
                .into_iter()
                .map(|link| robot.links()[link].name.as_str())
                .collect()
        };
        let across = names("left_gripper", "right_gripper");
        assert_eq!((across[0], across[across.len() - 1]), ("left_gripper", "right_gripper"));
        assert_eq!(across.iter().filter(|name| **name == "torso").count(), 1, "{across:?}");
        let mut back = names("right_gripper", "left_gripper");
        back.reverse();
        assert_eq!(across, back);
        assert!(names("left_gripper", "nowhere").is_empty());
    }
}
