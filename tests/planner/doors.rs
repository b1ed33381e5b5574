//! Laws and tasks of one's own, through the doors that the built-in ones use.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use approx::assert_abs_diff_eq;
use kinstep::formula::FormulaTable;
use kinstep::integrate::Starter;
use kinstep::law::{
    Conflict, Infeasible, Instant, JointVelocity, Law, LimitKind, LinearityKind, Pseudoinverse, Resolution,
    SystemShape,
};
use kinstep::nalgebra::{IsometryMatrix3, Vector3, Vector6};
use kinstep::planner::{
    Arm, JointSystem, Plan, PlanStatus, Planner, PlannerBuilder, PlannerError, derivative_errors,
};
use kinstep::robot::{Chain, embedded};
use kinstep::task::{Circle, Component, Motion, Planar, Quintic, Task, TaskInstant, TaskKind, TaskRows};
use std::sync::{Arc, Mutex};

const DURATION: f64 = 2.0;
const LEFT: [f64; 4] = [0.3, 0.4, 0.5, 0.6];
const RIGHT: [f64; 4] = [0.5, 0.6, 0.4, 0.3];

fn planar(side: f64) -> Chain {
    let mount = IsometryMatrix3::new(Vector3::new(side, 0.0, 0.0), Vector3::zeros());
    embedded::get("planar4").unwrap().chain("base", "tip").unwrap().mounted(&mount)
}

fn on_circle(name: &str, chain: Chain, q0: &[f64], radius: f64) -> Arm {
    let start = chain.forward(q0, &mut chain.scratch()).pose();
    let motion = Motion::from_pose(Planar::whole(Circle { radius }), Quintic, DURATION, &start);
    Arm::new(name, chain, q0.to_vec(), TaskKind::PositionXy, motion)
}

fn both() -> [Arm; 2] {
    [on_circle("left", planar(0.0), &LEFT, 0.2), on_circle("right", planar(2.0), &RIGHT, 0.2)]
}

fn builder(formula: &str, sigma: f64) -> PlannerBuilder {
    let formula = FormulaTable::builtin().get(formula).unwrap();
    Planner::builder().formula(formula).sigma(sigma).duration(DURATION).h(0.4)
}

/// What a law has seen.
#[derive(Default)]
struct Seen {
    accepted: Vec<f64>,
    /// The largest difference between the velocity that was remembered and the one that was told, and between the state that
    /// was foretold and the one that came.
    largest_difference: f64,
    foretold: Option<Vec<f64>>,
    velocity: Vec<f64>,
}

/// The least-norm law, slowed down where a joint would be faster than its limit or accelerate too much.
struct Capped {
    inner: Pseudoinverse,
    largest_velocity: f64,
    largest_acceleration: f64,
    seen: Arc<Mutex<Seen>>,
    answer: Vec<f64>,
}

impl Capped {
    fn new(largest_velocity: f64, largest_acceleration: f64, seen: &Arc<Mutex<Seen>>) -> Self {
        let (inner, seen) = (Pseudoinverse::new(), Arc::clone(seen));
        Self { inner, largest_velocity, largest_acceleration, seen, answer: Vec::new() }
    }
}

impl Law for Capped {
    fn prepare(&mut self, shape: &SystemShape) {
        self.answer = vec![0.0; shape.joints.len()];
        self.inner.prepare(shape);
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        let resolution = self.inner.resolve(instant, velocity)?;
        for joint in 0..instant.q.len() {
            let total = velocity.feedforward[joint] + velocity.feedback[joint];
            let limit = instant.limits[joint].velocity.min(self.largest_velocity);
            let change = (total - instant.previous_velocity[joint]).abs();
            if total.abs() > limit || change > self.largest_acceleration * instant.sigma {
                let conflicts = vec![
                    Conflict::Task { task: 0, row: 1 },
                    Conflict::Limit { joint, kind: LimitKind::Velocity },
                ];
                return Err(Infeasible { conflicts });
            }
            velocity.feedforward[joint] = total;
            // What a law that is not linear leaves here is of no account.
            velocity.feedback[joint] = f64::NAN;
            self.answer[joint] = total;
        }
        Ok(resolution)
    }

    fn accept(&mut self, instant: &Instant<'_>) {
        let mut seen = self.seen.lock().unwrap();
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if let Some(foretold) = seen.foretold.take() {
            let difference =
                apart(&foretold, instant.q).max(apart(&seen.velocity, instant.previous_velocity));
            seen.largest_difference = seen.largest_difference.max(difference);
        }
        let next = instant.next.unwrap();
        let foretold = next.known.iter().zip(&self.answer).map(|(known, answer)| known + next.first * answer);
        seen.foretold = Some(foretold.collect());
        seen.velocity.clone_from(&self.answer);
        seen.accepted.push(instant.t);
    }

    fn kind(&self) -> LinearityKind {
        LinearityKind::Total
    }

    fn needs_next_state(&self) -> bool {
        true
    }

    fn threshold(&self) -> f64 {
        self.inner.threshold()
    }
}

#[test]
fn a_law_sees_limits_the_velocity_before_and_the_state_that_it_leads_to_once_per_sample() {
    for (formula, start) in [
        ("la6-wang-guo", Starter::Paper),
        ("la6-wang-guo", Starter::Ramp),
        ("ab4", Starter::Ramp),
        ("split-ab4", Starter::Paper),
    ] {
        let seen = Arc::new(Mutex::new(Seen::default()));
        let arm = on_circle("arm", planar(0.0), &LEFT, 0.2).with_law(Capped::new(9.0, 90.0, &seen));
        let plan = builder(formula, 0.01).h(0.1).start(start).arm(arm).build().unwrap().run();
        assert!(plan.is_completed(), "{:?}", plan.reason);
        let seen = seen.lock().unwrap();
        let times: Vec<f64> = (0..plan.samples()).map(|n| plan.time(n)).collect();
        assert_eq!(seen.accepted, times, "{formula}: once for every sample, and for nothing else");
        assert!(seen.largest_difference < 1e-12, "{formula}: {}", seen.largest_difference);
    }
}

#[test]
fn stages_of_a_runge_kutta_start_are_no_samples() {
    let seen = Arc::new(Mutex::new(Seen::default()));
    let arm = on_circle("arm", planar(0.0), &LEFT, 0.2).with_law(Capped::new(9.0, 90.0, &seen));
    let plan = builder("la6-wang-guo", 0.01).start(Starter::Rk8).arm(arm).build().unwrap().run();
    assert_eq!(seen.lock().unwrap().accepted.len(), plan.samples());
}

#[test]
fn a_law_that_is_not_linear_keeps_the_order_and_is_held_to_the_range_of_its_coefficients() {
    let run = |sigma: f64| {
        let seen = Arc::new(Mutex::new(Seen::default()));
        let arm = on_circle("arm", planar(0.0), &LEFT, 0.2).with_law(Capped::new(9.0, 90.0, &seen));
        builder("la6-wang-guo", sigma).arm(arm).build().unwrap().run().arms[0].max_error_steady
    };
    let slope = (run(0.01) / run(0.005)).log2();
    assert_abs_diff_eq!(slope, 4.0, epsilon = 0.3);
    // The feedback of this row acts on the newest state alone, and h = 1 lies in its range; beta's own range is narrower.
    let build = |law: Option<Capped>| {
        let arm = on_circle("arm", planar(0.0), &LEFT, 0.2);
        let arm = match law {
            Some(law) => arm.with_law(law),
            None => arm,
        };
        builder("split-ab4", 0.01).h(1.0).arm(arm).build()
    };
    assert!(build(None).is_ok());
    let refused = build(Some(Capped::new(9.0, 90.0, &Arc::default()))).unwrap_err();
    assert!(matches!(refused, PlannerError::StepSizeOutsideRange { .. }), "{refused}");
}

#[test]
fn what_can_not_be_met_within_the_limits_stops_the_run_and_names_the_rows() {
    let law = Capped::new(0.25, 90.0, &Arc::default());
    let arm = on_circle("left", planar(0.0), &LEFT, 0.2).with_law(law);
    let plan = builder("la6-wang-guo", 0.01).arm(arm).build().unwrap().run();
    assert_eq!(plan.status, PlanStatus::Limit);
    let reason = plan.reason.unwrap();
    let names = ["`left`", "row 2 of task `position-xy`", "the velocity limit of joint `j"];
    assert!(names.iter().all(|name| reason.contains(name)), "{reason}");
    let samples = plan.arms[0].errors.len();
    assert!(samples > 10 && samples < plan.steps, "what came before is kept: {samples}");
    assert_eq!(plan.arms[0].positions.len(), samples * 4);
}

/// Two tips keep their distance along the way \[m\].
struct Distance {
    at_start: f64,
    swing: f64,
}

impl Distance {
    fn wanted(&self, t: f64) -> (f64, f64) {
        // At rest to second order at the start.
        let (s, c) = (std::f64::consts::PI * t / DURATION).sin_cos();
        let rate = std::f64::consts::PI / DURATION;
        (self.at_start + self.swing * s.powi(4), self.swing * 4.0 * s.powi(3) * c * rate)
    }
}

impl Task for Distance {
    fn name(&self) -> &'static str {
        "distance"
    }

    fn rows(&self) -> usize {
        1
    }

    fn least_tips(&self) -> usize {
        2
    }

    fn component(&self, _row: usize) -> Component {
        Component::Linear(0)
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let (one, other) = (at.tip(0), at.tip(1));
        let apart = other.pose.translation.vector - one.pose.translation.vector;
        let (along, (wanted, rate)) = (apart.normalize(), self.wanted(at.t));
        let direction = Vector6::new(along.x, along.y, along.z, 0.0, 0.0, 0.0);
        out.error[0] = apart.norm() - wanted;
        out.feedforward[0] = rate;
        out.add_to_row(0, other, &direction);
        out.add_to_row(0, one, &-direction);
    }
}

/// Each arm follows the height of its tip only, so that both have joints to spare.
struct Height(Motion);

impl Task for Height {
    fn name(&self) -> &'static str {
        "height"
    }

    fn rows(&self) -> usize {
        1
    }

    fn component(&self, _row: usize) -> Component {
        Component::Linear(1)
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let (tip, reference) = (at.tip(0), self.0.at(at.t));
        out.error[0] = tip.pose.translation.y - reference.position.y;
        out.feedforward[0] = reference.twist[1];
        out.add_to_row(0, tip, &Vector6::y());
    }
}

fn height(name: &str, side: f64, q0: &[f64]) -> Arm {
    let chain = planar(side);
    let start = chain.forward(q0, &mut chain.scratch()).pose();
    let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.2 }), Quintic, DURATION, &start);
    Arm::with_own_task(name, chain, q0.to_vec(), Box::new(Height(motion)))
}

fn distance_of(arms: &[Arm], swing: f64) -> Distance {
    let place = |arm: &Arm, q: &[f64]| arm.chain().forward(q, &mut arm.chain().scratch()).position();
    Distance { at_start: (place(&arms[1], &RIGHT) - place(&arms[0], &LEFT)).norm(), swing }
}

fn pair(sigma: f64) -> Plan {
    let arms = [height("left", 0.0, &LEFT), height("right", 2.0, &RIGHT)];
    let system = JointSystem::of(["left", "right"]).with_task(distance_of(&arms, 0.3));
    builder("la6-wang-guo", sigma).arms(arms).system(system).build().unwrap().run()
}

#[test]
fn a_task_over_two_tips_is_met_with_the_order_of_the_row() {
    let plan = pair(0.01);
    assert!(plan.is_completed(), "{:?}", plan.reason);
    assert_eq!((plan.tasks[0].name.as_str(), plan.tasks[0].rows), ("distance", 1));
    assert_eq!(plan.tasks[0].arms, ["left", "right"]);
    assert_eq!(plan.tasks[0].errors.len(), plan.samples());
    assert!(plan.shared.is_empty(), "they share no joint");
    // What is stated is what the chains say.
    let distance = |plan: &Plan, n: usize| {
        let [left, right] = [0.0, 2.0].map(planar);
        let place = |chain: &Chain, q: &[f64]| chain.forward(q, &mut chain.scratch()).position();
        (place(&right, plan.arms[1].position(n)) - place(&left, plan.arms[0].position(n))).norm()
    };
    let wanted = distance_of(&both(), 0.3);
    for n in (0..plan.samples()).step_by(17) {
        let error = distance(&plan, n) - wanted.wanted(plan.time(n)).0;
        assert_abs_diff_eq!(error, plan.tasks[0].error(n)[0], epsilon = 1e-12);
    }
    let worst =
        |plan: &Plan| plan.tasks[0].max_error().max(plan.arms[0].max_error).max(plan.arms[1].max_error);
    let slope = (worst(&pair(0.01)) / worst(&pair(0.005))).log2();
    assert_abs_diff_eq!(slope, 4.0, epsilon = 0.4);
    assert!(worst(&plan) < 1e-4, "{}", worst(&plan));
}

/// The Jacobian of this one is of the other sign in one arm.
struct Wrong(Distance);
impl Task for Wrong {
    fn name(&self) -> &'static str {
        "wrong"
    }
    fn rows(&self) -> usize {
        1
    }
    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        self.0.evaluate(at, out);
        for joint in 0..4 {
            out.jacobian[(0, joint)] *= -1.0;
        }
    }
}

#[test]
fn derivatives_of_a_task_are_held_against_differences() {
    let arms = both();
    let errors = derivative_errors(&arms, &distance_of(&arms, 0.3), 0.0, 1e-5);
    assert!(errors.error < 1e-12 && errors.jacobian < 1e-8 && errors.feedforward < 1e-8, "{errors:?}");

    let wrong = derivative_errors(&arms, &Wrong(distance_of(&arms, 0.3)), 0.0, 1e-5);
    assert!(wrong.jacobian > 0.1, "{wrong:?}");
    // What is no number is not right either.
    let nowhere = Distance { at_start: f64::NAN, swing: 0.0 };
    let nowhere = derivative_errors(&arms, &nowhere, 0.0, 1e-5);
    assert!(!(nowhere.jacobian <= 1.0) && !(nowhere.feedforward <= 1.0), "{nowhere:?}");
}

#[test]
fn arms_that_nothing_ties_move_as_one_system_as_they_do_apart() {
    let run = |tied: bool| {
        let planner = builder("la6-wang-guo", 0.01).arms(both());
        let planner = if tied { planner.system(JointSystem::of(["left", "right"])) } else { planner };
        planner.build().unwrap().run()
    };
    let (together, apart) = (run(true), run(false));
    for (together, apart) in together.arms.iter().zip(&apart.arms) {
        assert_abs_diff_eq!(&together.positions[..], &apart.positions[..], epsilon = 1e-12);
    }
}

#[test]
fn systems_that_can_not_be_are_refused_by_name() {
    let refused = |system: JointSystem, other: Option<JointSystem>| {
        let mut planner = builder("la6-wang-guo", 0.01).arms(both()).system(system);
        if let Some(other) = other {
            planner = planner.system(other);
        }
        planner.build().unwrap_err().to_string()
    };
    let unknown = refused(JointSystem::of(["left", "rigth"]), None);
    assert!(unknown.contains("no arm `rigth`") && unknown.contains("`left`, `right`"), "{unknown}");
    let pair = || JointSystem::of(["left", "right"]);
    let two = refused(pair().with_law(Pseudoinverse::new()), Some(pair().with_law(Pseudoinverse::new())));
    assert!(two.contains("two laws"), "{two}");
    let away = refused(pair().with_task(Distance { at_start: 7.0, swing: 0.0 }), None);
    assert!(away.contains("task `distance` has an error of"), "{away}");
    let second = Distance { swing: 0.0, ..distance_of(&both(), 0.0) };
    let nobody = refused(JointSystem::of(Vec::<String>::new()), None);
    assert!(nobody.contains("names no arm"), "{nobody}");
    let one = refused(JointSystem::of(["left"]).with_task(distance_of(&both(), 0.0)), None);
    assert!(one.contains("task `distance` needs 2 tips and was given 1"), "{one}");
    let distance = distance_of(&both(), 0.0);
    let weightless = refused(pair().with_task_of(["left", "right"], distance, 0, f64::NAN), None);
    assert!(weightless.contains("weight NaN"), "{weightless}");
    let stack = refused(pair().with_task_of(["left", "right"], second, 1, 1.0), None);
    assert!(stack.contains("`distance` has priority 1"), "{stack}");
}
