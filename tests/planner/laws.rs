//! What every law and every criterion of the registries promises: one walk over all of them.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::FormulaTable;
use kinstep::integrate::Starter;
use kinstep::kind::Parameters;
use kinstep::law::{
    CRITERIA, Criteria, Instant, JointVelocity, LAWS, Law, LimitKind, NextState, SystemShape,
};
use kinstep::nalgebra::{DMatrix, DVector, Vector6};
use kinstep::planner::{Arm, ArmPlan, Batch, Plan, PlanStatus, Planner, PlannerBuilder};
use kinstep::robot::{Chain, Limits, Robot, embedded};
use kinstep::task::{Circle, Motion, Planar, Plane, Quintic, TaskKind, TaskRows};
use proptest::prelude::*;

const DURATION: f64 = 2.0;
const START: [f64; 4] = [0.3, 0.4, 0.5, 0.6];

/// Parameters with which a law keeps the order of its tasks, where it needs any.
fn parameters(law: &str) -> Vec<Parameters> {
    let none = Parameters::new;
    match law {
        "weighted" => {
            vec![none().with("weights", kinstep::kind::Value::Table(vec![("j1".into(), 9.0.into())]))]
        }
        "damped" => vec![none(), none().with("method", "selective").with("max_velocity", 1e6)],
        "qp" => vec![none(), none().with("tasks", "least-squares")],
        _ => vec![none()],
    }
}

/// Every law by its name, with the given criteria.
fn laws(criteria: impl Fn() -> Criteria) -> Vec<(String, Box<dyn Law>)> {
    let of_kind = |kind: &kinstep::law::LawKind| {
        let make =
            |given: Parameters| (format!("{} {given:?}", kind.name), kind.make.law(&given, criteria()));
        parameters(kind.name).into_iter().map(make).collect::<Vec<_>>()
    };
    LAWS.iter().flat_map(of_kind).collect()
}

/// Four joints with limits, which are never reached here.
fn planar() -> Chain {
    let limits = Limits { lower: -0.5, upper: 2.5, velocity: 10.0, ..Limits::UNLIMITED };
    let robot = embedded::get("planar4").unwrap().clone();
    let limited = |robot: Robot, joint| robot.with_limits(joint, limits).unwrap();
    ["j1", "j2", "j3", "j4"].into_iter().fold(robot, limited).chain("base", "tip").unwrap()
}

fn on_circle(chain: Chain, q0: &[f64], law: Box<dyn Law>) -> Arm {
    let start = chain.forward(q0, &mut chain.scratch()).pose();
    let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.2 }), Quintic, DURATION, &start);
    Arm::new("arm", chain, q0.to_vec(), TaskKind::PositionXy, motion).with_law(law)
}

fn builder(formula: &str, sigma: f64) -> PlannerBuilder {
    let formula = FormulaTable::builtin().get(formula).unwrap();
    Planner::builder().formula(formula).sigma(sigma).duration(DURATION).start(Starter::Rk8).h(0.2)
}

fn run(law: Box<dyn Law>, formula: &str, sigma: f64) -> Plan {
    builder(formula, sigma).arm(on_circle(planar(), &START, law)).build().unwrap().run()
}

fn criterion(name: &str, given: &Parameters) -> Criteria {
    let kind = CRITERIA.iter().find(|kind| kind.name == name).unwrap();
    vec![(kind.make)(given, &START)]
}

#[test]
fn every_law_keeps_the_order_of_its_tasks_with_and_without_a_criterion() {
    let pull = || criterion("posture", &Parameters::new().with("rate", 2.0).with("q", vec![0.5; 4]));
    let rows = FormulaTable::builtin();
    for formula in ["la6-wang-guo", "split-ab4"] {
        let order = rows.get(formula).unwrap().order();
        for ((name, coarse), (_, fine)) in laws(pull)
            .into_iter()
            .chain(laws(Criteria::new))
            .zip(laws(pull).into_iter().chain(laws(Criteria::new)))
        {
            let errors = [(coarse, 0.005), (fine, 0.0025)].map(|(law, sigma)| {
                let plan = run(law, formula, sigma);
                assert_eq!(plan.status, PlanStatus::Completed, "{name}: {:?}", plan.reason);
                plan.arms[0].max_error_steady
            });
            let seen = (errors[0] / errors[1]).log2();
            assert!(
                seen > order as f64 + 0.5,
                "{name} with {formula}: order {seen:.2} of {errors:?}, not {}",
                order + 1
            );
        }
    }
}

/// One instant of a planar task and what a law makes of it: both parts together.
fn resolve(law: &mut dyn Law, q: &[f64], limits: &[Limits], tasks: &[TaskRows]) -> Vec<f64> {
    let (mut f, mut g) = (vec![0.0; q.len()], vec![0.0; q.len()]);
    let rest = vec![0.0; q.len()];
    let next = law.needs_next_state().then_some(NextState { known: q, first: 0.01, second: 0.01 });
    let instant = Instant {
        t: 0.0,
        sigma: 0.01,
        is_sample: true,
        q,
        previous_velocity: &rest,
        limits,
        tasks,
        tips: &[],
        next,
        avoidance: None,
    };
    law.resolve(&instant, &mut JointVelocity { feedforward: &mut f, feedback: &mut g }).unwrap();
    f.iter().zip(&g).map(|(f, g)| f + g).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_criteria_ask_for_moves_no_task(
        entries in prop::collection::vec(-1.0..1.0_f64, 21), q in prop::collection::vec(-1.0..1.0_f64, 7),
        v in prop::collection::vec(-1.0..1.0_f64, 3),
    ) {
        let jacobian = DMatrix::from_row_slice(3, 7, &entries);
        prop_assume!((&jacobian * jacobian.transpose()).symmetric_eigenvalues().min() > 0.05 * 0.05);
        let task = TaskRows { feedforward: v.clone(), jacobian: jacobian.clone(), ..TaskRows::zeros(3, 7) };
        let kind = CRITERIA.iter().find(|kind| kind.name == "posture").unwrap();
        let pull = || vec![(kind.make)(&Parameters::new().with("rate", 1.0), &[0.0; 7])];
        let shape = SystemShape::of_one_task(3, 7, 1.0);
        for ((name, mut pulled), (_, mut plain)) in laws(pull).into_iter().zip(laws(Criteria::new)) {
            pulled.prepare(&shape);
            plain.prepare(&shape);
            let limits = [Limits::UNLIMITED; 7];
            let [with, without] = [&mut pulled, &mut plain]
                .map(|law| DVector::from_vec(resolve(&mut **law, &q, &limits, std::slice::from_ref(&task))));
            let moved = (&jacobian * (&with - &without)).norm();
            let allowed = 1e-12 * jacobian.norm() * (1.0 + with.norm().max(without.norm()) / 0.05);
            prop_assert!(moved <= allowed, "{name} moves the task by {moved:.2e}");
            prop_assert!((&with - &without).norm() > 1e-6 || DVector::from_vec(q.clone()).norm() < 1e-3);
        }
    }
}

/// A Panda whose tip runs a circle, with limits of so much of what the least-norm law asks of each joint.
fn limited_panda(law: &str, free: &ArmPlan, shares: &[[f64; 2]], sigma: f64) -> Plan {
    let mut robot = embedded::get("panda").unwrap().clone();
    for ((joint, name), [fastest, most]) in free.joints.iter().enumerate().zip(shares) {
        let own = robot.joint(name).unwrap().limits;
        let peak = |series: &[f64]| {
            series.iter().skip(joint).step_by(7).fold(0.0_f64, |most, entry| most.max(entry.abs()))
        };
        let velocity = (fastest * peak(&free.velocities)).max(1e-3);
        let slopes: Vec<f64> =
            free.velocities.iter().zip(&free.velocities[7..]).map(|(a, b)| (b - a) / sigma).collect();
        let acceleration = (most * peak(&slopes)).max(1e-2);
        robot = robot.with_limits(name, Limits { velocity, acceleration, ..own }).unwrap();
    }
    panda(robot.chain("panda_link0", "panda_link8").unwrap(), law, "split-ab4", sigma)
}

fn panda(chain: Chain, law: &str, formula: &str, sigma: f64) -> Plan {
    let q0 = vec![0.0, -0.6, 0.0, -2.2, 0.0, 1.6, 0.8];
    let pose = chain.forward(&q0, &mut chain.scratch()).pose();
    let path = Planar::new(Circle { radius: 0.1 }, Plane::Yz, 0.0, 0.0, std::f64::consts::TAU);
    let motion = Motion::from_pose(path, Quintic, DURATION, &pose);
    let kind = LAWS.iter().find(|kind| kind.name == law).unwrap();
    let law = kind.make.law(&Parameters::new(), Criteria::new());
    let arm = Arm::new("arm", chain, q0, TaskKind::Position, motion).with_law(law);
    builder(formula, sigma).arm(arm).build().unwrap().run()
}

fn free_panda(sigma: f64) -> Plan {
    panda(panda_chain(), "pseudoinverse", "split-ab4", sigma)
}

fn panda_chain() -> Chain {
    embedded::get("panda").unwrap().chain("panda_link0", "panda_link8").unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn laws_that_keep_limits_keep_them_at_every_sample_or_say_which_are_in_the_way(
        shares in prop::collection::vec([0.6..1.3_f64, 0.8..2.0_f64], 7),
    ) {
        let sigma = 0.01;
        let free = free_panda(sigma);
        for law in ["qp", "saturated"] {
            let plan = limited_panda(law, &free.arms[0], &shares, sigma);
            match plan.status {
                PlanStatus::Completed => {
                    prop_assert!(plan.is_within_limits(), "{law}: {:?}", plan.arms[0].violations);
                    prop_assert!(plan.arms[0].max_error < 1e-3, "{law}: {:.2e}", plan.arms[0].max_error);
                }
                PlanStatus::Limit => {
                    let reason = plan.reason.unwrap();
                    prop_assert!(reason.contains("limit of joint `panda_joint"), "{law}: {reason}");
                }
                other => prop_assert!(false, "{law}: {other:?} {:?}", plan.reason),
            }
        }
    }
}

#[test]
fn limits_that_bite_are_kept_where_the_least_norm_law_crosses_them() {
    let sigma = 0.01;
    let free = free_panda(sigma);
    // What saturates jumps, so limits of accelerations leave the greedy law no way.
    for (law, most) in [("qp", 9.0), ("network", 9.0), ("saturated", 1e6)] {
        let shares = [3.0, 0.9, 3.0, 3.0, 3.0, 0.9, 3.0].map(|fastest| [fastest, most]);
        let crossing = limited_panda("pseudoinverse", &free.arms[0], &shares, sigma);
        assert!(!crossing.is_within_limits(), "the limits bite");
        let plan = limited_panda(law, &free.arms[0], &shares, sigma);
        assert!(
            plan.is_completed() && plan.is_within_limits(),
            "{law}: {:?} {:?}",
            plan.reason,
            plan.arms[0].violations
        );
    }
    // Half of what the path needs of every joint is too little, and said so.
    let plan = limited_panda("qp", &free.arms[0], &[[0.3, 0.3]; 7], sigma);
    assert_eq!(plan.status, PlanStatus::Limit);
    assert!(plan.reason.unwrap().contains(LimitKind::Acceleration.name()));
}

#[test]
fn while_no_limit_is_active_the_answer_is_that_of_the_least_norm_law_to_the_last_bit() {
    for formula in ["la6-wang-guo", "split-ab4", "split-ab6"] {
        let plain = panda(panda_chain(), "pseudoinverse", formula, 0.01);
        for law in ["qp", "saturated", "network"] {
            let plan = panda(panda_chain(), law, formula, 0.01);
            assert_eq!(plan.arms[0].positions, plain.arms[0].positions, "{law} with {formula}");
        }
    }
}

#[test]
fn a_law_gives_the_same_bits_alone_and_in_company() {
    for ((name, alone), (_, one), (_, other)) in laws(Criteria::new)
        .into_iter()
        .zip(laws(Criteria::new))
        .zip(laws(Criteria::new))
        .map(|((a, b), c)| (a, b, c))
    {
        let planner =
            |law| builder("la6-wang-guo", 0.02).arm(on_circle(planar(), &START, law)).build().unwrap();
        let alone = planner(alone).run();
        for plan in Batch::new([planner(one), planner(other)]).run() {
            assert_eq!(plan.arms[0].positions, alone.arms[0].positions, "{name}");
        }
    }
}

/// The measure that a criterion is to make smaller, at joint positions of the planar arm.
fn measure(criterion: &str, chain: &Chain, q: &[f64]) -> f64 {
    match criterion {
        "repetitive" => apart(q, &START),
        "posture" => apart(q, &[0.5; 4]),
        "joint-limits" => {
            let share = |(q, (lower, upper)): (&f64, (f64, f64))| {
                ((q - f64::midpoint(lower, upper)) / (upper - lower)).powi(2)
            };
            q.iter().zip(chain.position_limits()).map(share).sum()
        }
        "manipulability" => {
            let mut columns = vec![Vector6::zeros(); chain.dof()];
            chain.forward(q, &mut chain.scratch()).geometric_jacobian(&mut columns);
            let jacobian = DMatrix::from_fn(2, chain.dof(), |row, column| columns[column][row]);
            -(&jacobian * jacobian.transpose()).determinant()
        }
        other => panic!("no measure is known of the criterion {other}"),
    }
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn every_criterion_moves_the_joints_and_betters_its_own_measure() {
    let plain = run(LAWS[0].make.law(&Parameters::new(), Criteria::new()), "la6-wang-guo", 0.01);
    let chain = planar();
    // What keeps away from obstacles is tested where there are some.
    for kind in CRITERIA.iter().filter(|kind| kind.name != "clearance") {
        let given = Parameters::new().with("rate", 2.0);
        let given = if kind.name == "posture" { given.with("q", vec![0.5; 4]) } else { given };
        let law = LAWS[0].make.law(&given, criterion(kind.name, &given));
        let plan = run(law, "la6-wang-guo", 0.01);
        let last = plan.samples() - 1;
        let ends = [&plan, &plain].map(|plan| plan.arms[0].position(last).to_vec());
        assert!(apart(&ends[0], &ends[1]) > 1e-6, "{} moves no joint: {ends:?}", kind.name);
        let [with, without] = ends.map(|q| measure(kind.name, &chain, &q));
        assert!(with < without, "{}: {with:.4e} is no better than {without:.4e}", kind.name);
        assert!(plan.arms[0].max_error < 1e-5);
    }
}

#[test]
fn a_stack_meets_what_comes_first_and_the_next_as_well_as_it_can() {
    let mut shape = SystemShape::of_one_task(2, 4, 1.0);
    let mut second = SystemShape::of_one_task(3, 4, 1.0).tasks.remove(0);
    second.priority = 1;
    shape.tasks.push(second);
    let kind = LAWS.iter().find(|kind| kind.name == "prioritized").unwrap();
    let mut law = kind.make.law(&Parameters::new(), Criteria::new());
    assert_eq!(law.objection(&shape), None);
    law.prepare(&shape);
    let first = DMatrix::from_row_slice(2, 4, &[1.0, 0.4, 0.2, -0.3, 0.1, 0.9, -0.5, 0.2]);
    let next = DMatrix::from_row_slice(3, 4, &[0.3, 0.1, 0.8, 0.5, 0.2, 0.2, 0.1, 0.9, 0.4, -0.6, 0.3, 0.2]);
    let rows = |jacobian: &DMatrix<f64>, v: &[f64], priority| TaskRows {
        feedforward: v.to_vec(),
        jacobian: jacobian.clone(),
        priority,
        ..TaskRows::zeros(v.len(), 4)
    };
    let (v, w) = ([0.3, -0.2], [0.5, 0.1, -0.4]);
    let limits = [Limits::UNLIMITED; 4];
    let x =
        DVector::from_vec(resolve(&mut *law, &[0.0; 4], &limits, &[rows(&first, &v, 0), rows(&next, &w, 1)]));
    assert!((&first * &x - DVector::from_row_slice(&v)).norm() < 1e-13, "the first is met");
    // Among all that meet the first it misses the second by least: the gradient has no part in the null space of the first.
    let missed = &next * &x - DVector::from_row_slice(&w);
    let pseudo = first.transpose() * (&first * first.transpose()).try_inverse().unwrap();
    let projector = DMatrix::identity(4, 4) - pseudo * &first;
    assert!((projector * next.transpose() * &missed).norm() < 1e-12 && missed.norm() > 1e-3);
    // The other laws say that they do not know of priorities, and which one does.
    let plain = LAWS[0].make.law(&Parameters::new(), Criteria::new());
    assert!(plain.objection(&shape).unwrap().contains("\"prioritized\""));
}

#[test]
fn weights_make_a_joint_move_less() {
    let weighted = |weight: f64| {
        let kind = LAWS.iter().find(|kind| kind.name == "weighted").unwrap();
        let table = kinstep::kind::Value::Table(vec![("j2".to_owned(), weight.into())]);
        let law = kind.make.law(&Parameters::new().with("weights", table), Criteria::new());
        let plan = run(law, "la6-wang-guo", 0.01);
        assert!(plan.is_completed());
        let joint = plan.arms[0].velocities.iter().skip(1).step_by(4);
        joint.fold(0.0_f64, |most, velocity| most.max(velocity.abs()))
    };
    let (light, heavy) = (weighted(1.0), weighted(100.0));
    assert!(heavy < 0.1 * light, "{heavy} {light}");
}

#[test]
fn a_joint_that_starts_outside_its_limits_is_brought_back_and_kept() {
    let robot = embedded::get("planar4").unwrap().clone();
    let limited = |upper: f64| {
        let limits = Limits { lower: -1.0, upper, velocity: 2.0, ..Limits::UNLIMITED };
        robot.with_limits("j4", limits).unwrap().chain("base", "tip").unwrap()
    };
    for name in ["qp", "saturated", "network"] {
        let law = || {
            LAWS.iter().find(|kind| kind.name == name).unwrap().make.law(&Parameters::new(), Criteria::new())
        };
        // The fourth joint starts at 0.6.
        let arm = on_circle(limited(0.55), &START, law());
        let plan = builder("la6-wang-guo", 0.01).arm(arm).build().unwrap().run();
        assert!(plan.is_completed() && plan.is_within_limits(), "{name}: {:?}", plan.reason);
        assert!(
            plan.warnings.iter().any(|said| said.contains("was within them from t =")),
            "{:?}",
            plan.warnings
        );
        let fourth: Vec<f64> = plan.arms[0].positions.iter().skip(3).step_by(4).copied().collect();
        let back = fourth.iter().position(|q| *q <= 0.55).unwrap();
        assert!(back > 2 && fourth[back..].iter().all(|q| *q <= 0.55), "{name}");
        assert!(plan.arms[0].max_error < 1e-4, "{name}: {:.2e}", plan.arms[0].max_error);
    }
    // The least-norm law has no such promise.
    let plain = on_circle(limited(0.55), &START, LAWS[0].make.law(&Parameters::new(), Criteria::new()));
    assert!(builder("la6-wang-guo", 0.01).arm(plain).build().is_err());
}
