//! Any bytes as URDF: a robot or an error, and a robot that can be used and written down again.
#![no_main]

use kinstep::nalgebra::Vector6;
use kinstep::robot::{Robot, UrdfOptions};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    for strict in [false, true] {
        let options = UrdfOptions { strict, assume_unlimited: !strict, ..UrdfOptions::default() };
        match Robot::from_urdf_bytes(bytes, &options) {
            Ok(robot) => use_it(&robot),
            Err(error) => assert!(error.first().is_some(), "an error without a finding"),
        }
    }
});

fn use_it(robot: &Robot) {
    assert!(robot.joints().iter().all(|joint| joint.parent < joint.child));
    assert_eq!(robot.link_poses(&[]).len(), robot.links().len());
    let root = robot.roots().next().expect("a tree has a root").name.clone();
    for tip in robot.leaves().take(20) {
        let Ok(chain) = robot.chain(&root, &tip.name) else { continue };
        let mut columns = vec![Vector6::zeros(); chain.dof()];
        let mut scratch = chain.scratch();
        chain.forward(&vec![0.1; chain.dof()], &mut scratch).geometric_jacobian(&mut columns);
    }
    if let Ok(text) = robot.to_urdf() {
        let again = Robot::from_urdf(&text).expect("what is written reads");
        assert_eq!(again.links(), robot.links());
        for (own, read) in robot.joints().iter().zip(again.joints()) {
            assert_eq!((&own.name, own.kind, own.limits), (&read.name, read.kind, read.limits));
        }
    }
}
