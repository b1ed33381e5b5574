//! How distances change with the joints, held against their differences, on random trees and arms.

use kinstep::collision::{
    Capsule, CollisionModel, Cuboid, HalfSpace, JointPlaces, Pairings, PlacedScene, Scene, SceneBuilder,
};
use kinstep::nalgebra::{IsometryMatrix3, Rotation3, Vector3};
use kinstep::robot::{Chain, JointSource, LinkKinematics, Robot};
use kinstep_strategies::{ArmCase, ChainCase, arms, chains};
use proptest::prelude::*;

/// Step of the differences [rad or m].
const STEP: f64 = 1e-5;

/// A capsule about every link, of a size that depends on its number.
fn dressed(robot: &Robot) -> CollisionModel {
    let capsule = |number: usize| {
        let end = Vector3::new(0.1, 0.02 * number as f64, -0.05);
        Capsule::new(Vector3::new(0.0, 0.01, 0.0), end, 0.02 + 0.003 * number as f64).unwrap()
    };
    let links = robot.links().iter().enumerate();
    links.fold(CollisionModel::new(robot), |model, (number, link)| {
        model.with_capsule(&link.name, capsule(number)).unwrap()
    })
}

fn mount() -> IsometryMatrix3<f64> {
    IsometryMatrix3::from_parts(
        Vector3::new(0.2, -0.4, 0.1).into(),
        Rotation3::new(Vector3::new(0.1, 0.5, -0.3)),
    )
}

/// Two machines of the same robot, the joints of the second before those of the first, and an obstacle of each kind.
fn scene(robot: &Robot, chain: &Chain) -> Scene {
    let n = chain.dof();
    let (first, second): (Vec<usize>, Vec<usize>) = ((n..2 * n).collect(), (0..n).collect());
    let model = dressed(robot);
    let tilted =
        IsometryMatrix3::from_parts(Vector3::new(0.5, 0.5, 0.0).into(), Rotation3::new(Vector3::repeat(0.4)));
    SceneBuilder::new(2 * n)
        .with_machine(
            "one",
            robot,
            &model,
            chain.base(),
            &mount(),
            &JointPlaces::new().with_arm(chain, &first),
        )
        .unwrap()
        .with_machine(
            "two",
            robot,
            &model,
            chain.base(),
            &tilted,
            &JointPlaces::new().with_arm(chain, &second),
        )
        .unwrap()
        .with_obstacle("ball", Capsule::sphere(Vector3::new(0.3, 0.3, 0.3), 0.1).unwrap())
        .with_obstacle("box", Cuboid::new(tilted, Vector3::new(0.1, 0.2, 0.3)).unwrap())
        .with_obstacle(
            "floor",
            HalfSpace::new(Vector3::new(0.0, 0.0, -0.8), Vector3::new(0.1, 0.0, 1.0)).unwrap(),
        )
        .build()
}

/// The distance of a pair at one joint's position moved by `by`.
fn moved(scene: &Scene, q: &[f64], pair: usize, joint: usize, by: f64) -> f64 {
    let mut q = q.to_vec();
    q[joint] += by;
    scene.place(&q, &mut scene.scratch()).separation(pair).distance
}

/// Asks that every row is the slope of its distance; where the slopes on both sides differ there is a kink, and the row lies
/// between them.
fn rows_are_slopes(scene: &Scene, q: &[f64]) -> Result<(), TestCaseError> {
    let (mut scratch, mut found) = (scene.scratch(), scene.proximities());
    scene.place(q, &mut scratch).within(f64::INFINITY, &mut found);
    prop_assert_eq!(found.len(), scene.pairs());
    for (proximity, row) in found.iter() {
        let here = proximity.separation.distance;
        for (joint, slope) in row.iter().enumerate() {
            let there = moved(scene, q, proximity.pair, joint, STEP);
            let back = moved(scene, q, proximity.pair, joint, -STEP);
            let (left, right) = ((here - back) / STEP, (there - here) / STEP);
            // The slope changes by its derivative times the step, and a nearest point that jumps makes a kink.
            let slack = 1e-3 + 2.0 * (right - left).abs();
            let middle = f64::midpoint(left, right);
            prop_assert!(
                (slope - middle).abs() < slack,
                "{:?} of {:?}: {slope} {left} {right}",
                joint,
                proximity
            );
            if (right - left).abs() < 1e-4 {
                prop_assert!(
                    (slope - middle).abs() < 1e-5,
                    "{:?} of {:?}: {slope} {middle}",
                    joint,
                    proximity
                );
            }
        }
    }
    Ok(())
}

fn nearest_of_all(posed: &PlacedScene<'_>, pairs: usize) -> f64 {
    (0..pairs).map(|pair| posed.separation(pair).distance).fold(f64::INFINITY, f64::min)
}

fn of_arm(arm: &ArmCase) -> (Robot, Chain, Vec<f64>) {
    (Robot::from_urdf(&arm.urdf()).unwrap(), arm.chain().unwrap(), arm.q0())
}

fn of_chain(case: &ChainCase) -> (Robot, Chain, Vec<f64>) {
    (case.tree.robot().unwrap(), case.chain().unwrap(), case.q())
}

fn both(q: &[f64]) -> Vec<f64> {
    q.iter().map(|q| q + 0.1).chain(q.iter().copied()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn rows_are_the_slopes_of_distances_on_arms(arm in arms()) {
        let (robot, chain, q) = of_arm(&arm);
        rows_are_slopes(&scene(&robot, &chain), &both(&q))?;
    }

    /// With joints that follow others, paths that go up the tree, and branches that stay.
    #[test]
    fn rows_are_the_slopes_of_distances_on_trees(case in chains()) {
        let (robot, chain, q) = of_chain(&case);
        rows_are_slopes(&scene(&robot, &chain), &both(&q))?;
    }

    #[test]
    fn the_broad_phase_loses_nothing(arm in arms(), influence in 0.0..0.8_f64) {
        let (robot, chain, q) = of_arm(&arm);
        let scene = scene(&robot, &chain);
        let (mut scratch, mut found) = (scene.scratch(), scene.proximities());
        let posed = scene.place(&both(&q), &mut scratch);
        posed.within(influence, &mut found);
        let near = (0..scene.pairs()).filter(|pair| posed.separation(*pair).distance <= influence);
        prop_assert!(found.iter().map(|(proximity, _)| proximity.pair).eq(near));
        let least = posed.minimum().unwrap().separation.distance;
        prop_assert_eq!(least, nearest_of_all(&posed, scene.pairs()));
    }

    #[test]
    fn links_stand_where_the_chain_puts_its_tip(case in chains()) {
        let (robot, chain, q) = of_chain(&case);
        let place = |name: &str| chain.joints().iter().position(|joint| joint.name == name);
        let source = |joint: &kinstep::robot::Joint| match place(&joint.name) {
            Some(place) => JointSource::Column(place),
            None => JointSource::Held(0.0),
        };
        let links = LinkKinematics::new(&robot, chain.base(), &[chain.tip()], &mount(), source).unwrap();
        let (mut scratch, mut of_chain) = (links.scratch(), chain.scratch());
        let pose = links.forward(&q, &mut scratch).pose(0);
        let expected = mount() * chain.forward(&q, &mut of_chain).pose();
        prop_assert!((pose.to_homogeneous() - expected.to_homogeneous()).norm() < 1e-12);
    }
}

const TWINS: &str = r#"<robot name="twins">
    <link name="torso"/> <link name="left"/> <link name="right"/> <link name="left_hand"/> <link name="left_camera"/>
    <joint name="l" type="continuous"><parent link="torso"/><child link="left"/><origin xyz="0 0.3 0"/><axis xyz="0 0 1"/></joint>
    <joint name="r" type="continuous"><parent link="torso"/><child link="right"/><origin xyz="0 -0.3 0"/><axis xyz="0 0 1"/></joint>
    <joint name="lh" type="continuous"><parent link="left"/><child link="left_hand"/><origin xyz="0.3 0 0"/><axis xyz="0 0 1"/></joint>
    <joint name="c" type="fixed"><parent link="left_hand"/><child link="left_camera"/></joint>
</robot>"#;

fn pairs_of(pairings: Pairings, driven: &[&str]) -> Vec<String> {
    let robot = Robot::from_urdf(TWINS).unwrap();
    let places = driven.iter().enumerate().fold(JointPlaces::new(), |places, (index, tip)| {
        let chain = robot.chain(if *tip == "left_hand" { "left" } else { "torso" }, tip).unwrap();
        places.with_arm(&chain, &[index])
    });
    let scene = SceneBuilder::new(driven.len())
        .with_machine("m", &robot, &dressed(&robot), "torso", &IsometryMatrix3::identity(), &places)
        .unwrap()
        .with_obstacle("ball", Capsule::sphere(Vector3::new(2.0, 0.0, 0.0), 0.1).unwrap())
        .with_pairings(pairings)
        .allowing("left_camera", "ball")
        .build();
    (0..scene.pairs()).map(|pair| scene.pair_names(pair).join(" - ").replace("m ", "")).collect()
}

#[test]
fn neighbours_and_what_moves_as_one_are_left_out() {
    let all = pairs_of(Pairings::default(), &["left", "right", "left_hand"]);
    // The camera is fixed to the hand: with it, it is a neighbour of the left arm.
    assert_eq!(
        all,
        [
            "torso - left_hand",
            "torso - left_camera",
            "left - right",
            "left - ball",
            "left_hand - right",
            "left_hand - ball",
            "left_camera - right",
            "right - ball"
        ]
    );
}

#[test]
fn pairs_of_which_nothing_moves_are_left_out() {
    let one = pairs_of(Pairings::default(), &["right"]);
    assert_eq!(one, ["left - right", "left_hand - right", "left_camera - right", "right - ball"]);
    let no_self = Pairings { within_machines: false, ..Pairings::default() };
    assert_eq!(pairs_of(no_self, &["right"]), ["right - ball"]);
}

#[test]
fn a_base_or_a_link_that_no_chain_leads_to_is_an_error() {
    let robot = Robot::from_urdf(TWINS).unwrap();
    let error = |base: &str, model: &CollisionModel| {
        let identity = IsometryMatrix3::identity();
        let built =
            SceneBuilder::new(0).with_machine("m", &robot, model, base, &identity, &JointPlaces::new());
        built.unwrap_err().to_string()
    };
    assert!(error("torsi", &CollisionModel::new(&robot)).contains("did you mean `torso`"));
}
