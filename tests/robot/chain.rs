//! Chains through small robots: direction, folding, mimic joints, refusals.

use std::f64::consts::FRAC_PI_2;

use kinstep::nalgebra::Vector6;
use kinstep::robot::{ChainError, Robot};

const DEMO: &str = r#"<robot name="demo">
  <link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
  <joint name="j1" type="revolute"><origin xyz="0 0 1"/><parent link="base"/><child link="a"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="2"/></joint>
  <joint name="j2" type="prismatic"><parent link="a"/><child link="b"/>
    <axis xyz="1 0 0"/><limit lower="0" upper="0.5" effort="1" velocity="1"/></joint>
  <joint name="j3" type="fixed"><origin xyz="1 0 0"/><parent link="b"/><child link="tip"/></joint>
</robot>"#;

#[test]
fn poses_and_differentiates_a_turn_and_a_slide() {
    let robot = Robot::from_urdf(DEMO).unwrap();
    let chain = robot.chain("base", "tip").unwrap();
    assert_eq!(chain.joints().iter().map(|joint| joint.name.as_str()).collect::<Vec<_>>(), ["j1", "j2"]);
    assert_eq!(chain.reach(), 1.5);
    let mut scratch = chain.scratch();
    let posed = chain.forward(&[FRAC_PI_2, 0.25], &mut scratch);
    let position = posed.pose().translation;
    assert!((position.vector - kinstep::nalgebra::Vector3::new(0.0, 1.25, 1.0)).norm() < 1e-15);
    let mut columns = [Vector6::zeros(); 2];
    posed.geometric_jacobian(&mut columns);
    assert!((columns[0] - Vector6::new(-1.25, 0.0, 0.0, 0.0, 0.0, 1.0)).norm() < 1e-15);
    assert!((columns[1] - Vector6::new(0.0, 1.0, 0.0, 0.0, 0.0, 0.0)).norm() < 1e-15);
}

#[test]
fn refuses_an_unknown_tip_with_the_nearest_names() {
    let robot = Robot::from_urdf(DEMO).unwrap();
    let error = robot.chain("base", "tipp").unwrap_err();
    assert_eq!(error.to_string(), "the robot has no link `tipp`; did you mean `tip`?");
    assert!(matches!(robot.chain("tip", "tip"), Err(ChainError::SameLink { .. })));
}

#[test]
fn links_with_fixed_joints_between_them_have_a_constant_pose() {
    let robot = Robot::from_urdf(
        r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/>
        <joint name="up" type="fixed"><parent link="a"/><child link="b"/><origin xyz="0 0 2" rpy="0 0 1.5"/></joint>
        <joint name="out" type="fixed"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/></joint></robot>"#,
    )
    .unwrap();
    let chain = robot.chain("a", "c").unwrap();
    assert_eq!((chain.dof(), chain.reach()), (0, 0.0));
    let pose = chain.forward(&[], &mut chain.scratch()).pose();
    let expected = kinstep::nalgebra::Vector3::new(1.5_f64.cos(), 1.5_f64.sin(), 2.0);
    assert!((pose.translation.vector - expected).norm() < 1e-15);
    let back = robot.chain("c", "a").unwrap().mounted(&pose);
    let origin = back.forward(&[], &mut back.scratch()).pose();
    assert!(origin.translation.vector.norm() < 1e-15 && origin.rotation.angle() < 1e-15);
}

#[test]
fn a_driver_on_the_path_keeps_its_own_place() {
    let urdf = r#"<robot name="r"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
        <joint name="j1" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><mimic joint="j3" multiplier="2"/></joint>
        <joint name="j2" type="continuous"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>
        <joint name="j3" type="continuous"><parent link="c"/><child link="d"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint></robot>"#;
    let robot = Robot::from_urdf(urdf).unwrap();
    let names = |base: &str, tip: &str| -> Vec<String> {
        robot.chain(base, tip).unwrap().joints().iter().map(|joint| joint.name.clone()).collect()
    };
    assert_eq!(names("a", "d"), ["j2", "j3"]);
    assert_eq!(names("d", "a"), ["j3", "j2"]);
    // Off the path, the driver stands where its follower is.
    assert_eq!(names("a", "c"), ["j3", "j2"]);
    // j1 turns by twice j3: at (j2, j3) = (0, 0.3) the tip link is turned by 0.9.
    let chain = robot.chain("a", "d").unwrap();
    let pose = chain.forward(&[0.0, 0.3], &mut chain.scratch()).pose();
    assert!((pose.rotation.angle() - 0.9).abs() < 1e-15);
}
