//! A control loop allocates nothing once it is set up.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::collision::{Capsule, CollisionModel};
use kinstep::formula::FormulaTable;
use kinstep::integrate::{
    Attempt, Decision, Method, Mode, Multistep, Ode, RatioCoefficients, RatioRow, Starter, StepController,
};
use kinstep::kind::{Parameters, Value};
use kinstep::law::{CRITERIA, Clearance, LAWS, QuadraticProgram};
use kinstep::nalgebra::{IsometryMatrix3, Rotation3, Vector3};
use kinstep::planner::{Arm, Batch, Noise, Planner, PlannerBuilder, Surroundings};
use kinstep::robot::{Limits, embedded};
use kinstep::scheme;
use kinstep::task::{
    Circle, Ends, Line, Motion, Path, Planar, Plane, Polyline, SCurve, Sin2, Spline, TaskKind, Waypoints,
};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Two Pandas, a metre apart, each on a circle with its orientation held.
fn planner(start: Starter<f64>) -> Planner {
    builder(start).build().unwrap()
}

fn builder(start: Starter<f64>) -> PlannerBuilder {
    let arm = |name: &str, y: f64| {
        let chain = embedded::get("panda").unwrap().chain("panda_link0", "panda_link8").unwrap();
        let chain = chain.mounted(&IsometryMatrix3::new(Vector3::new(0.0, y, 0.0), Vector3::zeros()));
        let q0 = vec![0.0, -0.6, 0.0, -2.2, 0.0, 1.6, 0.8];
        let pose = chain.forward(&q0, &mut chain.scratch()).pose();
        let path = Planar::new(Circle { radius: 0.05 }, Plane::Yz, 0.0, 0.0, TAU);
        Arm::new(name, chain, q0, TaskKind::Pose, Motion::from_pose(path, Sin2, 2.0, &pose))
    };
    let arms = [arm("left", 0.5), arm("right", -0.5)];
    scheme::dtsmp(arms, 0.001, 0.4).start(start).duration(2.0)
}

/// Asserts that a planner takes a thousand steps, and that none of them allocates.
fn steps_without_allocating(mut planner: Planner) {
    let spent = allocation_counter::measure(|| {
        for _ in 0..1000 {
            planner.step();
        }
    });
    assert_eq!((planner.index(), planner.stop()), (1000, None));
    assert_eq!(spent.count_total, 0, "{spent:?}");
}

#[test]
fn a_thousand_steps_of_two_seven_joint_arms_allocate_nothing() {
    for start in [Starter::Paper, Starter::Ramp, Starter::Rk4, Starter::Rk8] {
        steps_without_allocating(planner(start));
    }
}

#[test]
fn a_thousand_steps_of_three_plans_at_once_allocate_nothing() {
    for start in [Starter::Paper, Starter::Rk8] {
        let mut batch = Batch::new((0..3).map(|_| planner(start.clone())));
        let spent = allocation_counter::measure(|| {
            for _ in 0..1000 {
                batch.step();
            }
        });
        assert_eq!((batch.index(2), batch.stop(2)), (1000, None));
        assert_eq!(spent.count_total, 0, "{spent:?}");
    }
}

#[test]
fn a_thousand_steps_along_waypoints_allocate_nothing() {
    let points = [[0.0, 0.0, 0.0], [0.03, 0.0, 0.0], [0.03, 0.03, 0.0], [0.0, 0.03, 0.03]].map(Vector3::from);
    let turns = [0.0, 0.1, 0.2, 0.1].map(|angle| Rotation3::new(Vector3::y() * angle));
    let waypoints = Waypoints::new(points.to_vec(), Some(turns.to_vec()), None).unwrap();
    let paths: [Box<dyn Path>; 2] = [
        Box::new(Spline::through(&waypoints, Ends::Natural).unwrap()),
        Box::new(Polyline::through(&waypoints, 0.01).unwrap()),
    ];
    for path in paths {
        let chain = embedded::get("panda").unwrap().chain("panda_link0", "panda_link8").unwrap();
        let q0 = vec![0.0, -0.6, 0.0, -2.2, 0.0, 1.6, 0.8];
        let pose = chain.forward(&q0, &mut chain.scratch()).pose();
        let motion = Motion::from_pose(path, SCurve { ramp: 0.3, rounding: 0.5 }, 2.0, &pose);
        let arm = Arm::new("arm", chain, q0, TaskKind::Pose, motion);
        steps_without_allocating(scheme::dtsmp([arm], 0.001, 0.4).duration(2.0).build().unwrap());
    }
}

/// Two arms on a common torso, each on a circle with its orientation held.
fn shared() -> Planner {
    let arm = |tip: &str, side: f64| {
        let chain = embedded::get("torso14").unwrap().chain("floor", tip).unwrap();
        let q0 = vec![0.2, 0.1, -0.58 * side, -0.82, -0.7, -1.36 * side, 0.68, 0.08 * side];
        let pose = chain.forward(&q0, &mut chain.scratch()).pose();
        let path = Planar::new(Circle { radius: 0.05 }, Plane::Yz, 0.0, 0.0, TAU);
        let motion = Motion::from_pose(path, Sin2, 2.0, &pose);
        Arm::new(tip, chain, q0, TaskKind::Pose, motion).on_machine("torso")
    };
    let arms = [arm("left_tool", 1.0), arm("right_tool", -1.0)];
    scheme::dtsmp(arms, 0.001, 0.4).duration(2.0).build().unwrap()
}

#[test]
fn a_thousand_steps_of_arms_with_a_common_torso_allocate_nothing() {
    steps_without_allocating(shared());
}

#[test]
fn a_thousand_steps_with_noise_allocate_nothing() {
    let noise = Noise { seed: 1, position: 1e-5, linear_velocity: 1e-5, joints: 1e-6, ..Noise::default() };
    steps_without_allocating(builder(Starter::Rk4).noise(noise).build().unwrap());
}

/// Every law of the registry with a criterion, on an arm whose limits are active for a part of the time.
#[test]
fn a_thousand_steps_of_every_law_allocate_nothing() {
    let table = Value::Table(vec![("panda_joint2".to_owned(), 4.0.into())]);
    let posture = CRITERIA.iter().find(|kind| kind.name == "posture").unwrap();
    for kind in LAWS {
        let given = match kind.name {
            "weighted" => Parameters::new().with("weights", table.clone()),
            _ => Parameters::new(),
        };
        let robot = embedded::get("panda").unwrap().clone();
        let own = robot.joint("panda_joint4").unwrap().limits;
        let robot = robot.with_limits("panda_joint4", Limits { velocity: 0.06, ..own }).unwrap();
        let chain = robot.chain("panda_link0", "panda_link8").unwrap();
        let q0 = vec![0.0, -0.6, 0.0, -2.2, 0.0, 1.6, 0.8];
        let pose = chain.forward(&q0, &mut chain.scratch()).pose();
        let motion = Motion::from_pose(
            Planar::new(Circle { radius: 0.05 }, Plane::Yz, 0.0, 0.0, TAU),
            Sin2,
            2.0,
            &pose,
        );
        let criterion = (posture.make)(&Parameters::new().with("rate", 1.0), &q0);
        let law = kind.make.law(&given, vec![criterion]);
        let arm = Arm::new("arm", chain, q0, TaskKind::Position, motion).with_law(law);
        steps_without_allocating(scheme::dtsmp([arm], 0.001, 0.4).duration(2.0).build().unwrap());
    }
}

#[test]
fn the_counter_counts() {
    let spent = allocation_counter::measure(|| drop(std::hint::black_box(planner(Starter::Rk4))));
    assert!(spent.count_total > 10);
}

/// The Adams-Bashforth formula of two steps for varying steps.
#[derive(Debug)]
struct VaryingAb2;

impl RatioCoefficients<f64> for VaryingAb2 {
    fn id(&self) -> &'static str {
        "ab2-varying"
    }

    fn steps(&self) -> usize {
        2
    }

    fn order(&self) -> usize {
        2
    }

    fn write(&self, ratios: &[f64], row: RatioRow<'_, f64>) {
        row.alpha[..2].copy_from_slice(&[1.0, -1.0]);
        row.beta[1..].copy_from_slice(&[1.0 + ratios[0] / 2.0, -ratios[0] / 2.0]);
    }

    fn per_step_constant(&self, ratios: &[f64]) -> f64 {
        1.0 / 6.0 + 1.0 / (4.0 * ratios[0])
    }
}

/// Rejects every other attempt.
struct Undecided(bool);

impl StepController<f64> for Undecided {
    fn judge(&mut self, attempt: &Attempt<'_, f64>) -> Decision<f64> {
        self.0 = !self.0;
        if self.0 {
            return Decision::Reject { retry: 0.9 * attempt.step };
        }
        Decision::Accept { next: attempt.step / 0.9 }
    }
}

#[test]
fn steps_that_solve_correct_or_vary_allocate_nothing() {
    let row = |id| FormulaTable::builtin().get(id).unwrap();
    let methods = [
        Method::of(row("bdf3")),
        Method::pair(row("ab4"), row("am3"), Mode::Pec),
        Method::pair(row("ab4"), row("am3"), Mode::Solved),
        Method::of(Arc::new(VaryingAb2)),
    ];
    for method in methods {
        let mut field = Ode::new(9, |t: f64, x: &[f64], f: &mut [f64]| {
            for (f, x) in f.iter_mut().zip(x) {
                *f = x * t.cos();
            }
        });
        let mut stepper = Multistep::of_method(method, &Starter::Rk4, &field, 0.0, 1e-3, &[1.0; 9]).unwrap();
        let spent = allocation_counter::measure(|| {
            for _ in 0..500 {
                stepper.step(&mut field);
            }
        });
        assert_eq!((stepper.index(), spent.count_total), (500, 0));
        let mut controller = Undecided(true);
        let spent = allocation_counter::measure(|| {
            for _ in 0..500 {
                stepper.step_under(&mut field, &mut controller);
            }
        });
        assert_eq!(spent.count_total, 0);
    }
}

#[test]
fn a_thousand_steps_past_a_ball_allocate_nothing() {
    let panda = embedded::get("panda").unwrap();
    let chain = panda.chain("panda_link0", "panda_hand_tcp").unwrap();
    let q0 = vec![0.0, -0.6, 0.0, -2.2, 0.0, 1.6, 0.8];
    let pose = chain.forward(&q0, &mut chain.scratch()).pose();
    let line = || Line { displacement: Vector3::new(0.0, 0.4, 0.0) };
    for law in [QuadraticProgram::new(), QuadraticProgram::new().in_least_squares(1e-8)] {
        let law = law.with_criterion(Clearance::new(1.0));
        let motion = Motion::from_pose(line(), Sin2, 2.0, &pose);
        let arm = Arm::new("arm", chain.clone(), q0.clone(), TaskKind::Position, motion).with_law(law);
        let ball = Capsule::sphere(Vector3::new(0.25, 0.25, 0.6), 0.08).unwrap();
        let model = CollisionModel::embedded("panda").unwrap();
        let around = Surroundings::new(0.02)
            .with_machine("arm", panda.clone(), model, "panda_link0", IsometryMatrix3::identity(), ["arm"])
            .with_obstacle("ball", ball);
        let planner = scheme::dtsmp([arm], 0.001, 0.4).duration(2.0).surroundings(around).build().unwrap();
        steps_without_allocating(planner);
    }
}
