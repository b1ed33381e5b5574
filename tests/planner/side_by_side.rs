//! Arms of one shape are evaluated together in the lanes of registers; nobody can tell from the result.

#![allow(clippy::unwrap_used)]

use kinstep::formula::FormulaTable;
use kinstep::law::{Infeasible, Instant, JointVelocity, Law, Pseudoinverse, Resolution, SystemShape};
use kinstep::nalgebra::{IsometryMatrix3, Vector3};
use kinstep::planner::{Arm, Batch, Plan, Planner, run_together};
use kinstep::robot::embedded;
use kinstep::task::{Circle, Motion, Planar, Plane, Quintic, TaskKind};

/// The least-norm law behind a door of its own, so that the planner takes it for something special.
struct Apart(Pseudoinverse);

impl Law for Apart {
    fn prepare(&mut self, shape: &SystemShape) {
        self.0.prepare(shape);
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        self.0.resolve(instant, velocity)
    }

    fn threshold(&self) -> f64 {
        self.0.threshold()
    }
}

const PANDA: (&str, &str, &str, &[f64]) =
    ("panda", "panda_link0", "panda_link8", &[0.1, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6]);
const IIWA: (&str, &str, &str, &[f64]) =
    ("iiwa14", "iiwa_link_0", "iiwa_link_ee", &[0.1, 0.6, 0.2, -1.4, 0.3, 1.1, 0.4]);
const UR5E: (&str, &str, &str, &[f64]) = ("ur5e", "base_link", "tool0", &[0.2, -1.3, 1.7, -1.4, -1.2, 0.4]);
const PLANAR: (&str, &str, &str, &[f64]) = ("planar4", "base", "tip", &[0.3, 0.4, 0.5, 0.6]);

fn arm(
    i: usize,
    (robot, base, tip, q): (&str, &str, &str, &[f64]),
    task: TaskKind,
    radius: f64,
    apart: bool,
) -> Arm {
    let mount =
        IsometryMatrix3::new(Vector3::new(0.1, 0.7 * i as f64, 0.0), Vector3::new(0.0, 0.1, i as f64));
    let chain = embedded::get(robot).unwrap().chain(base, tip).unwrap().mounted(&mount);
    let q: Vec<f64> = q.iter().map(|q| q + 0.01 * i as f64).collect();
    let start = chain.forward(&q, &mut chain.scratch()).pose();
    let plane = if task == TaskKind::Pose { Plane::Yz } else { Plane::Xy };
    let path = Planar::new(Circle { radius }, plane, 0.2 * i as f64, 0.0, 6.0);
    let motion = Motion::from_pose(path, Quintic, 1.0, &start);
    let arm = Arm::new(format!("arm {i}"), chain, q, task, motion);
    if apart { arm.with_law(Apart(Pseudoinverse::new())) } else { arm }
}

type Robot = (&'static str, &'static str, &'static str, &'static [f64]);

fn planner(formula: &str, gain: f64, robots: &[(Robot, TaskKind)], radius: f64, apart: bool) -> Planner {
    let formula = FormulaTable::builtin().get(formula).unwrap();
    let arms = robots.iter().enumerate().map(|(i, &(robot, task))| arm(i, robot, task, radius, apart));
    Planner::builder().formula(formula).sigma(0.01).duration(1.0).gain(gain).arms(arms).build().unwrap()
}

fn plan(robots: &[(Robot, TaskKind)], radius: f64, apart: bool) -> Plan {
    planner("la6-wang-guo", 20.0, robots, radius, apart).run()
}

fn assert_same(together: &Plan, apart: &Plan) {
    assert_eq!((together.status, &together.reason), (apart.status, &apart.reason));
    for (a, b) in together.arms.iter().zip(&apart.arms) {
        assert_eq!(a.positions, b.positions, "{}", a.name);
        assert_eq!(a.velocities, b.velocities, "{}", a.name);
        assert_eq!(a.errors, b.errors, "{}", a.name);
        assert_eq!(a.smallest_singular_value, b.smallest_singular_value, "{}", a.name);
        assert_eq!(a.damped_samples, b.damped_samples, "{}", a.name);
    }
}

#[test]
fn arms_together_move_as_each_would_apart_to_the_last_bit() {
    use TaskKind::{Pose, Position, PositionXy};
    let cases: [&[(Robot, TaskKind)]; 6] = [
        &[(PANDA, Pose)],
        &[(PANDA, Pose), (PANDA, Pose)],
        // Two makers' robots of one shape, and three or five in lanes of four.
        &[(PANDA, Pose), (IIWA, Pose), (PANDA, Pose)],
        &[
            (PANDA, Pose),
            (UR5E, Pose),
            (PANDA, Position),
            (IIWA, Pose),
            (UR5E, Pose),
            (PANDA, Pose),
            (IIWA, Pose),
        ],
        &[(PLANAR, PositionXy), (PLANAR, PositionXy), (UR5E, Position), (UR5E, Position)],
        &[(PANDA, Position), (IIWA, Position), (PANDA, Position), (PANDA, Position), (PANDA, Position)],
    ];
    for robots in cases {
        let together = plan(robots, 0.05, false);
        assert!(together.is_completed(), "{:?}", together.reason);
        assert_same(&together, &plan(robots, 0.05, true));
    }
}

#[test]
fn a_lane_that_comes_near_a_singularity_is_resolved_by_its_law() {
    // The circle is too wide: both arms stretch out, are damped, and stop.
    let robots = [(PANDA, TaskKind::Pose), (PANDA, TaskKind::Pose)];
    let (together, apart) = (plan(&robots, 0.45, false), plan(&robots, 0.45, true));
    assert!(!together.is_completed());
    assert_same(&together, &apart);
}

#[test]
fn plans_together_are_the_plans_one_by_one_to_the_last_bit() {
    use TaskKind::{Pose, Position};
    let dual: &[(Robot, TaskKind)] = &[(PANDA, Pose), (IIWA, Pose)];
    let (single, six): (&[_], &[_]) = (&[(PANDA, Position)], &[(UR5E, Position)]);
    // Plans of several kinds in disorder, six of them alike; one loses its path while its neighbours go on.
    let cases = [
        ("la6-wang-guo", 20.0, dual, 0.05),
        ("split-ab5", 20.0, single, 0.04),
        ("la6-wide", 20.0, dual, 0.03),
        ("la6-wang-guo", 20.0, dual, 0.45),
        ("la6-wang-guo", 25.0, dual, 0.05),
        ("la6-wang-guo", 20.0, six, 0.05),
        ("la2-euler", 20.0, dual, 0.02),
        ("split-ab6", 20.0, dual, 0.06),
        ("split-ab6", 20.0, dual, 0.01),
        ("la6-wang-guo", 20.0, single, 0.05),
    ];
    let make = |&(formula, gain, robots, radius): &(&str, f64, &[_], f64)| {
        planner(formula, gain, robots, radius, false)
    };
    let together = run_together(cases.iter().map(make).collect());
    assert_eq!(together.len(), cases.len());
    assert!(!together[3].is_completed() && together[2].is_completed());
    for (together, case) in together.iter().zip(&cases) {
        let alone = make(case).run();
        assert_eq!(together.formula, alone.formula);
        assert_same(together, &alone);
    }
    assert!(run_together(Vec::new()).is_empty());
}

#[test]
fn a_batch_is_its_plans_sample_by_sample_also_when_some_leave_early() {
    // Of the plans alike, one loses its path, one is shorter, and one has gone ahead of the others.
    let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
    let make = |&(radius, duration, ahead): &(f64, f64, usize)| {
        let arms = [PANDA, IIWA].into_iter().enumerate();
        let arms = arms.map(|(i, robot)| arm(i, robot, TaskKind::Pose, radius, false));
        let planner = Planner::builder().formula(formula).sigma(0.01).duration(duration).gain(20.0);
        let mut planner = planner.arms(arms).build().unwrap();
        (0..ahead).for_each(|_| planner.step());
        planner
    };
    let cases =
        [(0.05, 1.0, 3), (0.45, 1.0, 3), (0.04, 0.6, 3), (0.03, 1.0, 3), (0.05, 1.0, 7), (0.02, 1.0, 3)];
    let mut alone: Vec<Planner> = cases.iter().map(make).collect();
    let mut batch = Batch::new(cases.iter().map(make));
    assert_eq!(batch.plans(), cases.len());
    while !batch.is_finished() {
        batch.step();
        for (plan, alone) in alone.iter_mut().enumerate() {
            alone.step();
            assert_eq!(batch.index(plan), alone.index(), "plan {plan}");
            assert_eq!(batch.stop(plan), alone.stop(), "plan {plan}");
            assert_eq!(batch.is_plan_finished(plan), alone.is_finished(), "plan {plan}");
            for i in 0..2 {
                let (together, alone) = (batch.arm(plan, i), alone.arm(i));
                assert_eq!(together.positions, alone.positions, "plan {plan}");
                assert_eq!(together.velocities, alone.velocities, "plan {plan}");
                assert_eq!((together.error, together.damped), (alone.error, alone.damped), "plan {plan}");
            }
        }
    }
    assert!(batch.stop(1).is_some() && batch.stop(0).is_none() && batch.index(2) == 60);
    let together = run_together(cases.iter().map(make).collect());
    for (together, case) in together.iter().zip(&cases) {
        let alone = make(case).run();
        assert_same(together, &alone);
        for (a, b) in together.arms.iter().zip(&alone.arms) {
            assert_eq!(a.violations, b.violations, "{}", a.name);
            assert_eq!(
                (a.max_error, a.max_error_component),
                (b.max_error, b.max_error_component),
                "{}",
                a.name
            );
        }
    }
}

#[test]
fn a_plan_that_is_not_finite_stops_alone() {
    use kinstep::task::PathPoint;
    // One path jumps to infinity on its way.
    let make = |breaks: bool| {
        let (robot, base, tip, q) = PANDA;
        let chain = embedded::get(robot).unwrap().chain(base, tip).unwrap();
        let start = chain.forward(q, &mut chain.scratch()).pose();
        let path = move |u: f64| PathPoint {
            position: Vector3::new(0.05 * u, 0.0, 0.0),
            tangent: Vector3::new(if breaks && u > 0.5 { f64::INFINITY } else { 0.05 }, 0.0, 0.0),
        };
        let motion = Motion::from_pose(path, Quintic, 1.0, &start);
        let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
        let arm = Arm::new("arm", chain, q.to_vec(), TaskKind::Pose, motion);
        Planner::builder().formula(formula).sigma(0.01).duration(1.0).gain(20.0).arm(arm).build().unwrap()
    };
    let plans = run_together(vec![make(false), make(true), make(false)]);
    assert_eq!(plans[1].status.name(), "non_finite");
    for (plan, breaks) in plans.iter().zip([false, true, false]) {
        let alone = make(breaks).run();
        assert_eq!(plan.is_completed(), !breaks);
        // The last velocities of the one that broke are NaN, which equals nothing.
        assert_eq!((plan.status, &plan.reason), (alone.status, &alone.reason));
        assert_eq!(plan.arms[0].positions, alone.arms[0].positions);
        assert_eq!(format!("{:?}", plan.arms[0].velocities), format!("{:?}", alone.arms[0].velocities));
    }
}
