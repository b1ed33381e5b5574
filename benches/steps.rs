//! Wall time of what a control loop repeats: `cargo bench --bench steps`.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use kinstep::formula::FormulaTable;
use kinstep::nalgebra::{IsometryMatrix3, Vector3, Vector6};
use kinstep::planner::{Arm, Planner};
use kinstep::robot::{Chain, embedded};
use kinstep::task::{Circle, Motion, Planar, Sin2, TaskKind};
use std::hint::black_box;

const ARMS: [(&str, &str, &str, &[f64]); 3] = [
    ("ur5e", "base_link", "tool0", &[0.2, -1.3, 1.7, -1.4, -1.2, 0.4]),
    ("panda", "panda_link0", "panda_link8", &[0.1, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6]),
    ("iiwa14", "iiwa_link_0", "iiwa_link_ee", &[0.1, 0.6, 0.2, -1.4, 0.3, 1.1, 0.4]),
];

fn chain(robot: &str, base: &str, tip: &str) -> Chain {
    embedded::get(robot).expect("an embedded robot").chain(base, tip).expect("a chain of that robot")
}

/// Forward kinematics and geometric Jacobian of one arm.
fn kinematics(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("forward kinematics and Jacobian");
    for (robot, base, tip, q) in ARMS {
        let chain = chain(robot, base, tip);
        let mut scratch = chain.scratch();
        let mut columns = vec![Vector6::zeros(); chain.dof()];
        group.bench_function(BenchmarkId::from_parameter(robot), |bencher| {
            bencher.iter(|| {
                let posed = chain.forward(black_box(q), &mut scratch);
                posed.geometric_jacobian(&mut columns);
                black_box(posed.pose())
            });
        });
    }
    group.finish();
}

fn panda(name: &str, side: f64) -> Arm {
    let mount = IsometryMatrix3::new(Vector3::new(0.0, side, 0.0), Vector3::zeros());
    let (_, base, tip, q) = ARMS[1];
    let chain = chain("panda", base, tip).mounted(&mount);
    let start = chain.forward(q, &mut chain.scratch()).pose();
    let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.05 }), Sin2, 4000.0, &start);
    Arm::new(name, chain, q.to_vec(), TaskKind::Pose, motion)
}

/// One step of two Pandas on full-pose paths: path, kinematics, Jacobians, errors, solves, checks and history.
fn dual_arm_step(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("dual Panda pose step");
    for (id, h) in [("la6-wang-guo", 0.4), ("split-ab6", 1.0)] {
        let formula = FormulaTable::builtin().get(id).expect("a row of the built-in table");
        let build = || {
            let arms = [panda("left", -0.5), panda("right", 0.5)];
            Planner::builder().formula(formula).sigma(1e-3).duration(4000.0).h(h).arms(arms).build()
        };
        let mut planner = build().expect("a plan within range");
        group.bench_function(BenchmarkId::from_parameter(id), |bencher| {
            bencher.iter(|| {
                if planner.is_finished() {
                    planner = build().expect("a plan within range");
                }
                planner.step();
                black_box(planner.arm(1).positions[0])
            });
        });
    }
    group.finish();
}

criterion_group!(benches, kinematics, dual_arm_step);
criterion_main!(benches);
