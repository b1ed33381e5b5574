//! The capsules that come with the embedded robots.

use kinstep::collision::{CollisionModel, JointPlaces, Scene, SceneBuilder};
use kinstep::nalgebra::IsometryMatrix3;
use kinstep::robot::embedded;

/// Robots, their base and tip, and a configuration in which they stand free \[rad\].
const HOMES: [(&str, &str, &str, &[f64]); 4] = [
    ("panda", "panda_link0", "panda_hand_tcp", &[0.0, -0.7854, 0.0, -2.3562, 0.0, 1.5708, 0.7854]),
    ("iiwa14", "iiwa_link_0", "iiwa_link_ee", &[0.0, 0.6, 0.0, -1.4, 0.0, 1.1, 0.0]),
    ("ur5e", "base_link", "tool0", &[0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0]),
    ("ur10e", "base_link", "tool0", &[0.0, -1.5708, 1.5708, -1.5708, -1.5708, 0.0]),
];

fn scene(name: &str, base: &str, tip: &str) -> Scene {
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
fn arms_are_free_at_home_and_stretched_out() {
    for (name, base, tip, home) in HOMES {
        let scene = scene(name, base, tip);
        for q in [home, &vec![0.0; home.len()]] {
            if name == "panda" && q[3] == 0.0 {
                continue; // Its fourth joint can not be stretched.
            }
            let mut scratch = scene.scratch();
            let nearest = scene.place(q, &mut scratch).minimum().unwrap();
            let pair = scene.pair_names(nearest.pair);
            assert!(nearest.separation.distance > 0.005, "{name}: {pair:?} {nearest:?}");
        }
    }
}

#[test]
fn an_arm_that_is_folded_into_itself_is_seen() {
    let folded: [(&str, &[f64]); 4] = [
        ("panda", &[0.0, 0.0, 0.0, -3.07, 0.0, 0.0, 0.0]),
        ("iiwa14", &[0.0, 2.0, 0.0, -2.09, 0.0, -2.09, 0.0]),
        ("ur5e", &[0.0, -1.5708, 3.1, 0.0, 0.0, 0.0]),
        ("ur10e", &[0.0, -1.5708, 3.1, 0.0, 0.0, 0.0]),
    ];
    for ((name, base, tip, _), (_, q)) in HOMES.into_iter().zip(folded) {
        let scene = scene(name, base, tip);
        let mut scratch = scene.scratch();
        let nearest = scene.place(q, &mut scratch).minimum().unwrap();
        assert!(nearest.separation.distance < 0.0, "{name}: {nearest:?}");
    }
}
