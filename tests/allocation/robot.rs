//! Kinematics allocates nothing, whatever the path holds.

use allocation_counter::measure;
use kinstep::nalgebra::Vector6;
use kinstep::robot::{Robot, embedded};

#[test]
fn forward_and_jacobian_allocate_nothing_on_any_embedded_robot() {
    for name in embedded::names() {
        let robot = embedded::get(name).unwrap();
        let root = &robot.roots().next().unwrap().name;
        for leaf in robot.leaves() {
            let Ok(chain) = robot.chain(&leaf.name, root) else { continue };
            let q = vec![0.3; chain.dof()];
            let mut columns = vec![Vector6::zeros(); chain.dof()];
            let mut scratch = chain.scratch();
            let counted = measure(|| {
                for _ in 0..100 {
                    let posed = chain.forward(&q, &mut scratch);
                    posed.geometric_jacobian(&mut columns);
                    std::hint::black_box(posed.pose());
                }
            });
            assert_eq!(counted.count_total, 0, "{name}, from {} to {root}", leaf.name);
        }
    }
}

#[test]
fn a_scratch_of_a_shorter_chain_grows_once() {
    let robot = Robot::from_urdf(include_str!("../data/two_fingers.urdf")).unwrap();
    let (short, long) = (robot.chain("palm", "left").unwrap(), robot.chain("left_tip", "right_tip").unwrap());
    let mut scratch = short.scratch();
    let q = vec![0.01; long.dof()];
    assert!(
        measure(|| {
            long.forward(&q, &mut scratch);
        })
        .count_total
            > 0
    );
    assert_eq!(
        measure(|| {
            long.forward(&q, &mut scratch);
        })
        .count_total,
        0
    );
}
