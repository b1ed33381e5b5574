//! The capsules that come with embedded robots.

use kinstep::collision::{CollisionModel, JointPlaces, Scene, SceneBuilder};
use kinstep::nalgebra::IsometryMatrix3;
use kinstep::robot::embedded;

/// A robot, its base and tip, a configuration in which it stands free, and one in which it is folded into itself [rad].
type Case = (&'static str, [&'static str; 2], &'static [f64], &'static [f64]);

const CASES: [Case; 2] = [
    (
        "panda",
        ["panda_link0", "panda_hand_tcp"],
        &[0.0, -0.78, 0.0, -2.35, 0.0, 1.57, 0.78],
        &[0.0, 0.0, 0.0, -3.07, 0.0, 0.0, 0.0],
    ),
    ("planar4", ["base", "tip"], &[0.3, 0.4, 0.5, 0.6], &[0.0, 2.0, 2.0, 2.0]),
];

fn scene(name: &str, [base, tip]: [&str; 2]) -> Scene {
    let robot = embedded::get(name).unwrap();
    let chain = robot.chain(base, tip).unwrap();
    let places = JointPlaces::new().with_arm(&chain, &(0..chain.dof()).collect::<Vec<_>>());
    let model = CollisionModel::embedded(name).unwrap();
    let identity = IsometryMatrix3::identity();
    let builder =
        SceneBuilder::new(chain.dof()).with_machine("arm", &robot, &model, base, &identity, &places);
    builder.unwrap().build()
}

#[test]
fn every_robot_with_capsules_is_tried() {
    let with_capsules = embedded::names().into_iter().filter(|name| embedded::collision_text(name).is_some());
    let mut tried = CASES.map(|case| case.0);
    tried.sort_unstable();
    assert!(with_capsules.eq(tried));
}

#[test]
fn arms_are_free_at_home_and_folded_ones_are_seen() {
    for (name, ends, home, folded) in CASES {
        let scene = scene(name, ends);
        let mut scratch = scene.scratch();
        let free = scene.place(home, &mut scratch).minimum().unwrap();
        let pair = scene.pair_names(free.pair);
        assert!(free.separation.distance > 0.01, "{name}: {pair:?} {free:?}");
        let caught = scene.place(folded, &mut scratch).minimum().unwrap();
        assert!(caught.separation.distance < 0.0, "{name}: {:?} {caught:?}", scene.pair_names(caught.pair));
    }
}
