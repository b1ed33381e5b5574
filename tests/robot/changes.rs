//! Changed copies of robots: locked joints, calibrations, tools, and robots written as URDF and read again.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::trees::{distance, poses, poses_at};
use kinstep::nalgebra::{IsometryMatrix3, Rotation3, Vector3, Vector6};
use kinstep::robot::{
    Calibration, CalibrationError, Chain, Joint, JointCorrection, JointKind, LockError, Robot, ToolError,
    embedded,
};
use kinstep_strategies::{ChainCase, TreeCase, chains, trees};
use proptest::prelude::*;
use proptest::sample::Index;
use std::collections::BTreeMap;

fn pose(chain: &Chain, q: &[f64]) -> IsometryMatrix3<f64> {
    chain.forward(q, &mut chain.scratch()).pose()
}

fn columns(chain: &Chain, q: &[f64]) -> Vec<Vector6<f64>> {
    let mut columns = vec![Vector6::zeros(); chain.dof()];
    chain.forward(q, &mut chain.scratch()).geometric_jacobian(&mut columns);
    columns
}

/// The positions of a chain's joints, of which one is read differently.
fn q_with(tree: &TreeCase, chain: &Chain, joint: &str, position: f64) -> Vec<f64> {
    let q = tree.q_of(chain);
    chain.joints().iter().zip(q).map(|(own, q)| if own.name == joint { position } else { q }).collect()
}

/// A joint of the tree that moves on its own, if there is one.
fn mover(robot: &Robot, pick: Index) -> Option<String> {
    let movers: Vec<_> = robot.movable_joints().map(|joint| joint.name.clone()).collect();
    (!movers.is_empty()).then(|| pick.get(&movers).clone())
}

/// A tree of which some joints are corrected and some are held, by their places.
struct Edited<'a> {
    tree: &'a TreeCase,
    /// Position of the model where the arm reads zero, and the sign with which it counts.
    corrections: BTreeMap<usize, (f64, f64)>,
    /// The readings at which joints are held.
    locks: BTreeMap<usize, f64>,
}

impl Edited<'_> {
    /// What the arm reads at a joint: followers are coupled to the body of the joint that they name.
    fn reading(&self, i: usize) -> f64 {
        match (self.locks.get(&i), self.tree.joints[i].follower) {
            (Some(&held), _) => held,
            (None, Some(follower)) => {
                f64::from(follower.multiplier) / 4.0 * self.body(follower.driver)
                    + f64::from(follower.offset) / 10.0
            }
            (None, None) => self.tree.position(i),
        }
    }

    /// Where the model's joint stands.
    fn body(&self, i: usize) -> f64 {
        let (zero, sign) = self.corrections.get(&i).copied().unwrap_or((0.0, 1.0));
        sign * self.reading(i) + zero
    }

    fn name(i: usize) -> String {
        format!("j{}", i + 1)
    }
}

proptest! {
    #[test]
    fn locks_and_calibrations_reach_followers_of_followers(
        tree in trees(),
        corrections in prop::collection::vec((any::<Index>(), -0.5..0.5, prop::bool::ANY), 0..4),
        locks in prop::collection::vec((any::<Index>(), -1.0..1.0), 0..4),
    ) {
        let robot = tree.robot().unwrap();
        let movable: Vec<usize> = (0..tree.joints.len()).filter(|&i| tree.joints[i].kind != JointKind::Fixed).collect();
        let mut edited = Edited { tree: &tree, corrections: BTreeMap::new(), locks: BTreeMap::new() };
        let mut calibration = Calibration::default();
        for (pick, zero, reversed) in corrections {
            let joint = *pick.get(&movable);
            calibration.insert(Edited::name(joint), JointCorrection { zero, reversed, ..JointCorrection::default() });
            edited.corrections.insert(joint, (zero, if reversed { -1.0 } else { 1.0 }));
        }
        let mut changed = robot.with_calibration(&calibration).unwrap();
        for (pick, held) in locks {
            let joint = *pick.get(&movable);
            // It may stand still already, or leave a follower no place within its limits.
            if let Ok(locked) = changed.with_locked(&Edited::name(joint), &[held]) {
                changed = locked;
                edited.locks.insert(joint, held);
            }
        }
        let expected = poses_at(&tree, |i| edited.body(i));
        let positions: Vec<f64> = changed.joints().iter().map(|own| tree.position_of(&own.name).unwrap()).collect();
        let at = |link: &str| &expected[link[1..].parse::<usize>().unwrap()];
        for (link, found) in changed.links().iter().zip(changed.link_poses(&positions)) {
            prop_assert!(distance(&found, at(&link.name)) < 1e-11, "{}", link.name);
        }
        for link in changed.leaves() {
            let Ok(chain) = changed.chain("l0", &link.name) else { continue };
            prop_assert!(chain.joints().iter().all(|own| changed.movable_joints().any(|free| free.name == own.name)));
            prop_assert!(distance(&pose(&chain, &tree.q_of(&chain)), at(&link.name)) < 1e-11, "{}", link.name);
        }
        // Written down, it is the same robot: it can be changed further.
        let again = Robot::from_urdf(&changed.to_urdf().unwrap());
        if let Ok(again) = again {
            prop_assert!(changed.joints().iter().zip(again.joints()).all(|(own, read)| own.mimic == read.mimic));
            for own in changed.joints() {
                let name = |followed: Option<&Joint>| followed.map(|followed| followed.name.clone());
                prop_assert_eq!(name(changed.joint_followed_by(&own.name)), name(again.joint_followed_by(&own.name)));
            }
        }
    }

    #[test]
    fn a_locked_joint_is_the_same_robot_with_that_joint_left_alone(
        ChainCase { tree, base, tip } in chains(), pick in any::<Index>(),
    ) {
        let robot = tree.robot().unwrap();
        let Some(name) = mover(&robot, pick) else { return Ok(()) };
        let (base, tip) = (format!("l{base}"), format!("l{tip}"));
        let held = tree.position_of(&name).unwrap();
        // A follower may have to stay within its own limits.
        let locked = robot.with_locked(&name, &[held]);
        if let Err(LockError::Follower { .. }) = locked { return Ok(()) }
        let locked = locked.unwrap();
        let (Ok(free), Ok(still)) = (robot.chain(&base, &tip), locked.chain(&base, &tip)) else { return Ok(()) };
        prop_assert!(still.joints().iter().all(|joint| joint.name != name));
        let (q, rest) = (tree.q_of(&free), tree.q_of(&still));
        prop_assert!(distance(&pose(&free, &q), &pose(&still, &rest)) < 1e-12);
        let moving: Vec<_> = free.joints().iter().zip(columns(&free, &q)).filter(|(own, _)| own.name != name).collect();
        prop_assert_eq!(moving.len(), still.dof());
        for (joint, column) in still.joints().iter().zip(columns(&still, &rest)) {
            let same = moving.iter().find(|(own, _)| own.name == joint.name).unwrap();
            prop_assert!((same.1 - column).norm() < 1e-11);
        }
    }

    #[test]
    fn a_calibrated_arm_reads_otherwise_and_stands_alike(
        ChainCase { tree, base, tip } in chains(), pick in any::<Index>(), zero in -0.5..0.5, reversed in prop::bool::ANY,
    ) {
        let robot = tree.robot().unwrap();
        let Some(name) = mover(&robot, pick) else { return Ok(()) };
        let mut calibration = Calibration::default();
        calibration.insert(&name, JointCorrection { zero, reversed, ..JointCorrection::default() });
        let calibrated = robot.with_calibration(&calibration).unwrap();
        let (base, tip) = (format!("l{base}"), format!("l{tip}"));
        let (Ok(model), Ok(arm)) = (robot.chain(&base, &tip), calibrated.chain(&base, &tip)) else { return Ok(()) };
        let position = tree.position_of(&name).unwrap();
        let reading = if reversed { zero - position } else { position - zero };
        let (q, readings) = (tree.q_of(&model), q_with(&tree, &arm, &name, reading));
        // Followers on the path are coupled to the body, not to its reading: they stand alike too.
        prop_assert!(distance(&pose(&model, &q), &pose(&arm, &readings)) < 1e-12);
        let sign = if reversed { -1.0 } else { 1.0 };
        for ((own, a), b) in model.joints().iter().zip(columns(&model, &q)).zip(columns(&arm, &readings)) {
            let turned = if own.name == name { sign } else { 1.0 };
            prop_assert!((a - b * turned).norm() < 1e-11);
        }
        // What the arm's stops allow stays what they allow.
        for ((own, limits), reading) in model.joints().iter().zip(arm.joints()).zip(&readings) {
            let model_position = if own.name == name { position } else { *reading };
            let margin = (own.limits.upper - model_position).min(model_position - own.limits.lower);
            let read = (limits.limits.upper - reading).min(reading - limits.limits.lower);
            prop_assert!((margin - read).abs() < 1e-9 || (margin.is_infinite() && read.is_infinite()));
        }
    }

    #[test]
    fn a_corrected_origin_is_moved_and_turned_in_its_parents_axes(
        tree in trees(), pick in any::<Index>(), xyz in prop::array::uniform3(-0.1..0.1), rpy in prop::array::uniform3(-0.1..0.1),
    ) {
        let robot = tree.robot().unwrap();
        let joint = pick.get(robot.joints());
        let mut calibration = Calibration::default();
        calibration.insert(&joint.name, JointCorrection { xyz, rpy, ..JointCorrection::default() });
        let corrected = robot.with_calibration(&calibration).unwrap();
        let own = corrected.joint(&joint.name).unwrap();
        let moved = joint.origin.translation.vector + Vector3::from(xyz);
        let turned = Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]) * joint.origin.rotation;
        prop_assert!((own.origin.translation.vector - moved).norm() < 1e-15);
        prop_assert!((own.origin.rotation.matrix() - turned.matrix()).norm() < 1e-15);
        for other in robot.joints().iter().filter(|other| other.name != joint.name) {
            prop_assert_eq!(other, corrected.joint(&other.name).unwrap());
        }
    }

    #[test]
    fn a_tool_is_one_more_constant_at_the_tip(
        ChainCase { tree, base, tip } in chains(),
        shift in prop::array::uniform3(-1.0..1.0), turn in prop::array::uniform3(-3.0..3.0),
    ) {
        let robot = tree.robot().unwrap();
        let tool = IsometryMatrix3::new(Vector3::from(shift), Vector3::from(turn));
        let (base, tip) = (format!("l{base}"), format!("l{tip}"));
        let tooled = robot.with_tool(&tip, "tool", &tool).unwrap();
        let (Ok(bare), Ok(with_tool)) = (robot.chain(&base, &tip), tooled.chain(&base, "tool")) else { return Ok(()) };
        let q = tree.q_of(&bare);
        prop_assert!(distance(&(pose(&bare, &q) * tool), &pose(&with_tool, &q)) < 1e-12);
        // Everything else stays, depth first.
        let before: Vec<_> = robot.tree().map(|row| (row.link.name.clone(), row.depth)).collect();
        let after: Vec<_> = tooled.tree().map(|row| (row.link.name.clone(), row.depth)).collect();
        let without: Vec<_> = after.iter().filter(|(name, _)| name != "tool").cloned().collect();
        prop_assert_eq!(before, without);
        prop_assert!(tooled.joints().iter().all(|joint| joint.parent < joint.child));
        for row in tooled.tree().filter(|row| row.driver.is_some()) {
            let name = &row.joint.unwrap().name;
            let driver = robot.tree().find(|other| other.joint.is_some_and(|own| own.name == *name)).unwrap().driver;
            prop_assert_eq!(&row.driver.unwrap().name, &driver.unwrap().name);
        }
    }

    #[test]
    fn what_is_written_as_urdf_reads_back_with_every_double(tree in trees()) {
        let robot = tree.robot().unwrap();
        let text = robot.to_urdf().unwrap();
        let again = Robot::from_urdf(&text).unwrap();
        prop_assert_eq!(again.joints(), robot.joints());
        prop_assert_eq!(again.links(), robot.links());
        prop_assert_eq!(again.to_urdf().unwrap(), text);
    }

    #[test]
    fn a_changed_robot_reads_back_to_the_last_places(
        ChainCase { tree, base, tip } in chains(), pick in any::<Index>(), zero in -0.5..0.5, rpy in prop::array::uniform3(-3.0..3.0),
    ) {
        let robot = tree.robot().unwrap();
        let Some(name) = mover(&robot, pick) else { return Ok(()) };
        let mut calibration = Calibration::default();
        calibration.insert(&name, JointCorrection { zero, rpy, reversed: true, ..JointCorrection::default() });
        let robot = robot.with_calibration(&calibration).unwrap();
        let text = robot.to_urdf().unwrap();
        let again = Robot::from_urdf(&text).unwrap();
        prop_assert_eq!(&again.to_urdf().unwrap(), &text, "what is read is written again");
        let (base, tip) = (format!("l{base}"), format!("l{tip}"));
        let (Ok(one), Ok(two)) = (robot.chain(&base, &tip), again.chain(&base, &tip)) else { return Ok(()) };
        prop_assert_eq!(one.joints(), two.joints());
        let q = tree.q_of(&one);
        prop_assert!(distance(&pose(&one, &q), &pose(&two, &q)) < 1e-13);
    }

    #[test]
    fn the_poses_of_all_links_are_those_of_the_chains(tree in trees()) {
        let robot = tree.robot().unwrap();
        let position = |joint: &Joint| tree.position_of(&joint.name).unwrap();
        let positions: Vec<f64> = robot.joints().iter().map(position).collect();
        let (found, expected) = (robot.link_poses(&positions), poses(&tree));
        for (link, found) in robot.links().iter().zip(&found) {
            prop_assert!(distance(found, &expected[link.name[1..].parse::<usize>().unwrap()]) < 1e-12);
        }
    }
}

#[test]
fn every_embedded_robot_is_written_and_read_alike() {
    for name in embedded::names() {
        let robot = embedded::get(name).unwrap();
        let again = Robot::from_urdf(&robot.to_urdf().unwrap()).unwrap();
        assert_eq!((again.name(), again.joints()), (robot.name(), robot.joints()), "{name}");
        assert_eq!(again.links(), robot.links(), "{name}");
    }
}

const FREE: &str = r#"<robot name="free &amp; &lt;wide&gt;" version="1.1">
  <link name="world"/><link name="base"/><link name="plate"/><link name="arm"/><link name="finger"/>
  <joint name="float" type="floating"><parent link="world"/><child link="base"/><origin xyz="0 0 1"/></joint>
  <joint name="slide" type="planar"><parent link="base"/><child link="plate"/><axis xyz="0 1 0"/></joint>
  <joint name="turn" type="revolute"><parent link="plate"/><child link="arm"/><origin quat_xyzw="0.5 0.5 0.5 0.5"/>
    <axis xyz="0 0 1"/><limit lower="-1" effort="1" velocity="inf"/></joint>
  <joint name="grip &quot;a&quot;" type="prismatic"><parent link="arm"/><child link="finger"/><axis xyz="1 2 2"/>
    <limit effort="1"/><mimic joint="turn" multiplier="0.1" offset="0.3"/></joint>
</robot>"#;

#[test]
fn joints_with_many_freedoms_are_passed_once_they_are_held() {
    let robot = Robot::from_urdf(FREE).unwrap();
    assert!(robot.chain("world", "arm").is_err());
    let half = std::f64::consts::FRAC_PI_2;
    let held = robot.with_locked("float", &[0.1, 0.2, 0.3, 0.0, 0.0, half]).unwrap();
    let held = held.with_locked("slide", &[0.0]).unwrap();
    let chain = held.chain("world", "plate").unwrap();
    assert_eq!(chain.dof(), 0);
    let found = pose(&chain, &[]);
    assert!((found.translation.vector - Vector3::new(0.1, 0.2, 1.3)).norm() < 1e-15);
    assert!((found.rotation * Vector3::x() - Vector3::y()).norm() < 1e-15);
    assert_eq!(held.chain("world", "finger").unwrap().dof(), 1);
    // What follows a held joint is held with it.
    let still = held.with_locked("turn", &[-0.5]).unwrap();
    assert_eq!(still.joint("grip \"a\"").unwrap().kind, JointKind::Fixed);
    let apart = still.joint("grip \"a\"").unwrap().origin.translation.vector;
    assert!((apart - Vector3::new(1.0, 2.0, 2.0) / 3.0 * 0.25).norm() < 1e-15);
}

#[test]
fn a_follower_in_the_middle_is_held_with_what_follows_it_alone() {
    let joint = |name: &str, ends: [&str; 2], rest: &str| {
        let [parent, child] = ends;
        format!(
            "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/>{rest}</joint>"
        )
    };
    let text = format!(
        "<robot name=\"mc\"><link name=\"a\"/><link name=\"b\"/><link name=\"c\"/><link name=\"d\"/>{}{}{}</robot>",
        joint("j1", ["a", "b"], ""),
        joint("j2", ["b", "c"], "<mimic joint=\"j1\"/>"),
        joint("j3", ["c", "d"], "<mimic joint=\"j2\" multiplier=\"2\"/>"),
    );
    let robot = Robot::from_urdf(&text).unwrap();
    assert_eq!(robot.joint_followed_by("j3").unwrap().name, "j2");
    assert_eq!(robot.joint("j3").unwrap().mimic.unwrap().driver, 0, "the one that drives it in the end");
    let locked = robot.with_locked("j2", &[0.4]).unwrap();
    let chain = locked.chain("c", "d").unwrap();
    assert_eq!(chain.dof(), 0);
    assert!((pose(&chain, &[]).rotation.angle() - 0.8).abs() < 1e-15);
    assert_eq!(locked.chain("a", "b").unwrap().dof(), 1, "what it followed is free");
    let refused = robot.with_locked("j2", &[1.5]).unwrap_err();
    assert!(refused.to_string().contains("`j3`, which follows it, would stand at 3"), "{refused}");
    assert_eq!(robot.with_locked("j1", &[0.4]).unwrap().chain("a", "d").unwrap().dof(), 0);
}

#[test]
fn odd_names_free_joints_and_unknown_limits_survive_the_writing() {
    let robot = Robot::from_urdf(FREE).unwrap();
    let text = robot.to_urdf().unwrap();
    let again = Robot::from_urdf(&text).unwrap();
    assert_eq!(again.name(), "free & <wide>");
    for (own, read) in robot.joints().iter().zip(again.joints()) {
        assert_eq!(
            (&own.name, own.kind, own.limits, own.axis),
            (&read.name, read.kind, read.limits, read.axis)
        );
        assert_eq!(own.mimic, read.mimic);
        assert!(distance(&own.origin, &read.origin) < 1e-15);
    }
    assert!(text.contains("inertias") && text.contains("1e308 stands for a limit that is not known"));
}

#[test]
fn a_defective_robot_is_not_written_as_a_sound_one() {
    let wrong = FREE.replace("xyz=\"1 2 2\"", "xyz=\"0 0 0\"");
    let error = Robot::from_urdf(&wrong).unwrap().to_urdf().unwrap_err().to_string();
    assert!(
        error.starts_with("joint `grip \"a\"` is defective (line 7): its axis `0 0 0` has no direction"),
        "{error}"
    );
    let lost = FREE.replace("<child link=\"finger\"/>", "<child link=\"fnger\"/>");
    assert!(Robot::from_urdf(&lost).unwrap().to_urdf().is_err(), "a joint that the tree can not hold");
}

#[test]
fn a_joint_that_can_not_be_locked_says_why() {
    let robot = Robot::from_urdf(FREE).unwrap();
    let refused = |joint: &str, values: &[f64]| robot.with_locked(joint, values).unwrap_err().to_string();
    assert_eq!(refused("trun", &[0.0]), "the robot has no joint `trun` to lock; did you mean `turn`?");
    assert!(refused("plate", &[0.0]).contains("`plate` is a link, the joint above it is `slide`"));
    assert!(refused("zzzzz", &[0.0]).contains("the joints that move are `float`, `slide`"));
    assert_eq!(refused("turn", &[2.0]), "joint `turn` can not be locked at 2: it moves between -1 and 0");
    assert!(matches!(robot.with_locked("turn", &[f64::NAN]), Err(LockError::OutsideLimits { .. })));
    assert_eq!(
        refused("turn", &[0.0, 0.0]),
        "joint `turn` is revolute and is locked at one number, not at 2 numbers"
    );
    assert!(refused("float", &[0.5]).contains("six numbers x y z roll pitch yaw"));
    assert!(refused("float", &[0.0, 0.0, f64::INFINITY, 0.0, 0.0, 0.0]).contains("a finite pose"));
    let narrow = Robot::from_urdf(
        &FREE.replace("<limit effort=\"1\"/>", "<limit lower=\"0.25\" upper=\"1\" effort=\"1\"/>"),
    );
    assert_eq!(
        narrow.unwrap().with_locked("turn", &[-1.0]).unwrap_err().to_string(),
        "joint `turn` can not be locked at -1: `grip \"a\"`, which follows it, would stand at 0.19999999999999998, and \
         moves between 0.25 and 1"
    );
    let once = robot.with_locked("turn", &[0.0]).unwrap();
    assert!(matches!(once.with_locked("turn", &[0.0]), Err(LockError::Fixed { .. })));
    let lost =
        Robot::from_urdf(&FREE.replace("<child link=\"finger\"/>", "<child link=\"fnger\"/>")).unwrap();
    let error = lost.with_locked("grip \"a\"", &[0.0]).unwrap_err();
    assert!(matches!(error, LockError::Defective { .. }), "{error}");
}

#[test]
fn a_joint_is_locked_only_where_it_can_be() {
    let planar = Robot::from_urdf(FREE).unwrap();
    let spherical = Robot::from_urdf(&FREE.replace("type=\"planar\"", "type=\"spherical\"")).unwrap();
    let refused = |robot: &Robot, pose: [f64; 6]| robot.with_locked("slide", &pose).unwrap_err().to_string();
    // The plane is that of x and z.
    planar.with_locked("slide", &[0.1, 0.0, 0.2, 0.0, 0.3, 0.0]).unwrap();
    assert_eq!(
        refused(&planar, [0.1, 0.2, 0.0, 0.0, 0.0, 0.0]),
        "joint `slide` can not be locked there: it is planar, and moves in the plane normal to its axis alone"
    );
    assert!(refused(&planar, [0.1, 0.0, 0.0, 0.3, 0.0, 0.0]).contains("turns about the normal of its plane"));
    spherical.with_locked("slide", &[0.0, 0.0, 0.0, 0.1, 0.2, 0.3]).unwrap();
    assert!(refused(&spherical, [0.1, 0.0, 0.0, 0.0, 0.0, 0.0]).contains("turns about its origin"));
}

#[test]
fn a_calibration_that_does_not_fit_says_where() {
    let robot = Robot::from_urdf(FREE).unwrap();
    let refused = |text: &str| {
        let calibration = Calibration::from_toml(text);
        calibration.and_then(|calibration| robot.with_calibration(&calibration)).unwrap_err()
    };
    let unknown = refused("[joint.turn]\nzero = 0.1\n\n[joint.tunr]\nzero = 0.1");
    assert_eq!(unknown.to_string(), "line 4: the robot has no joint `tunr` to correct; did you mean `turn`?");
    assert_eq!(unknown.line(), Some(4));
    assert!(refused("[joint.zzzzz]").to_string().contains("its joints are `float`, `slide`"));
    assert!(matches!(refused("[joint.float]\nzero = 1"), CalibrationError::NoPosition { .. }));
    let text = "[joint.turn]\nzreo = 1\nxyz = [0, 1]\nrpy = \"pi\"\nreversed = 1\n[link.arm]\nmass = 3";
    let CalibrationError::Text(found) = refused(text) else { panic!("a text error") };
    let lines: Vec<_> =
        found.iter().map(|found| (found.line, found.message.split(';').next().unwrap())).collect();
    assert_eq!(
        lines,
        [
            (2, "a correction has no key `zreo`"),
            (3, "`xyz`: expected 3 numbers, found 2"),
            (4, "`rpy`: expected a list of numbers, found the text `pi`"),
            (5, "`reversed`: expected true or false, found the integer `1`"),
            (6, "a calibration has no key `link`"),
        ]
    );
    assert!(refused("").to_string().contains("corrects nothing"));
    assert!(refused("joint = 3").to_string().contains("expected tables `[joint.NAME]`"));
    let mut huge = Calibration::default();
    huge.insert("turn", JointCorrection { zero: f64::NAN, ..JointCorrection::default() });
    assert!(matches!(robot.with_calibration(&huge), Err(CalibrationError::Size { .. })));
    let empty = robot.with_calibration(&Calibration::default()).unwrap();
    assert_eq!(empty.joints(), robot.joints());
}

#[test]
fn a_tool_needs_a_link_and_a_name_of_its_own() {
    let robot = embedded::get("panda").unwrap();
    let tool = IsometryMatrix3::identity();
    let error = robot.with_tool("panda_hnad", "pen", &tool).unwrap_err().to_string();
    assert!(error.contains("did you mean `panda_hand`"), "{error}");
    assert!(matches!(robot.with_tool("panda_hand", "panda_joint1", &tool), Err(ToolError::NameTaken { .. })));
    for part in [f64::NAN, f64::INFINITY, 1e154] {
        let far = IsometryMatrix3::translation(0.0, part, 0.0);
        assert!(matches!(robot.with_tool("panda_hand", "pen", &far), Err(ToolError::Size { .. })), "{part}");
    }
    let twice = robot.with_tool("panda_hand", "pen", &tool).unwrap().with_tool("pen", "nib", &tool).unwrap();
    assert_eq!(twice.chain("panda_link0", "nib").unwrap().dof(), 7);
}

#[test]
fn limits_of_acceleration_and_jerk_are_read_carried_and_written() {
    let urdf = |rest: &str| {
        format!(
            r#"<robot name="r"><link name="base"/><link name="l"/><link name="tip"/>
            <joint name="a" type="continuous"><parent link="base"/><child link="l"/><axis xyz="0 0 1"/>
            <limit velocity="2" effort="1" acceleration="3" {rest}/></joint>
            <joint name="b" type="prismatic"><parent link="l"/><child link="tip"/><axis xyz="0 0 1"/>
            <limit lower="-2" upper="2" velocity="2" effort="1" acceleration="4" jerk="5"/>
            <mimic joint="a" multiplier="-2"/></joint></robot>"#
        )
    };
    let robot = Robot::from_urdf(&urdf(r#"jerk="100""#)).unwrap();
    let limits = |robot: &Robot, joint: &str| {
        let limits = robot.joint(joint).unwrap().limits;
        (limits.acceleration, limits.jerk)
    };
    assert_eq!((limits(&robot, "a"), limits(&robot, "b")), ((3.0, 100.0), (4.0, 5.0)));
    let chain = robot.chain("base", "tip").unwrap();
    assert_eq!((chain.joints()[0].limits.acceleration, chain.joints()[0].limits.jerk), (2.0, 2.5));
    assert_eq!(Robot::from_urdf(&robot.to_urdf().unwrap()).unwrap().joints(), robot.joints());
    let reversed = JointCorrection { reversed: true, zero: 0.1, ..JointCorrection::default() };
    let mut calibration = Calibration::default();
    calibration.insert("a", reversed);
    assert_eq!(limits(&robot.with_calibration(&calibration).unwrap(), "a"), (3.0, 100.0));
    for (wrong, cause) in [("-1", "negative"), ("fast", "not a number"), ("nan", "not a number")] {
        let robot = Robot::from_urdf(&urdf(&format!(r#"jerk="{wrong}""#))).unwrap();
        assert!(robot.joint("a").unwrap().defect.as_ref().unwrap().reason.contains(cause), "{wrong}");
    }
    let said = Robot::from_urdf(&urdf(r#"deceleration="1""#)).unwrap();
    assert!(
        said.diagnostics().iter().any(|found| found.message.contains("`deceleration` limit is not checked"))
    );
}
