//! Kinds of a program's own, named in the text of a scenario, and the built-in criterion and task.

use kinstep::formula::FormulaTable;
use kinstep::kind::{Form, Kind, Parameter};
use kinstep::law::{Criterion, CriterionKind, Infeasible, Instant, JointVelocity, Law, MakeLaw};
use kinstep::law::{Pseudoinverse, Resolution, SystemShape};
use kinstep::nalgebra::Vector6;
use kinstep::planner::Plan;
use kinstep::task::{Circle, MakeCurve, MakeTask, Task, TaskInstant, TaskRows, TimeLaw};
use kinstep_files::scenario::{CriterionSpec, Kinds, RelationSpec, Scenario, ScenarioError, ScenarioText};

const ONE: &str = r#"
sigma = 0.01
duration = 2.0
formula = "la6-wang-guo"
start = "rk8"

[law]
h = 0.4

[[arm]]
name = "left"
robot = "planar4"
base = "base"
tip = "tip"
task = "position-xy"
q0 = [0.3, 0.4, 0.5, 0.6]
path = { kind = "circle", radius = 0.1, time_law = "sin2sin2" }
"#;

/// Two arms of which one stands higher; how high their tips are is left to them.
const PAIR: &str = r#"
sigma = 0.01
duration = 2.0
formula = "la6-wang-guo"
start = "rk8"

[law]
h = 0.4

[[arm]]
name = "left"
robot = "panda"
base = "panda_link0"
tip = "panda_hand_tcp"
task = "position-xy"
q0 = [0.0, "-pi/4", 0.0, "-3*pi/4", 0.0, "pi/2", "pi/4"]
mount = { xyz = [0, 0, 0] }
path = { kind = "circle", radius = 0.05, time_law = "sin2sin2" }

[[arm]]
name = "right"
robot = "panda"
base = "panda_link0"
tip = "panda_hand_tcp"
task = "position-xy"
q0 = [0.0, "-pi/4", 0.0, "-3*pi/4", 0.0, "pi/2", "pi/4"]
mount = { xyz = [0.5, 0, 0.4] }
path = { kind = "circle", radius = 0.05, time_law = "sin2sin2" }
"#;

fn read(text: &str, kinds: &Kinds) -> Result<Scenario, ScenarioError> {
    ScenarioText::parse(text)?.scenario_with(kinds)
}

fn run(text: &str, kinds: &Kinds) -> Result<Plan, ScenarioError> {
    Ok(read(text, kinds)?.planner_with(kinds, FormulaTable::builtin(), None)?.run())
}

fn refusal(text: &str, kinds: &Kinds) -> String {
    run(text, kinds).expect_err("this scenario should be refused").message
}

fn last(plan: &Plan, arm: usize) -> Vec<f64> {
    plan.arms[arm].position(plan.samples() - 1).to_vec()
}

fn apart(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The slope of the task error between two gaps.
fn order(text: &str, kinds: &Kinds) -> f64 {
    let error = |sigma: &str| {
        let text = text.replace("sigma = 0.01", &format!("sigma = {sigma}"));
        run(&text, kinds).expect("a sound scenario").arms[0].max_error_steady
    };
    (error("0.02") / error("0.01")).log2()
}

/// Turns every joint at the same speed: `c = speed`.
struct Drift(f64);

impl Criterion for Drift {
    fn velocity(&mut self, _: &Instant<'_>, c: &mut [f64]) {
        c.fill(self.0);
    }

    fn rate(&self) -> Option<f64> {
        None
    }
}

const DRIFT: CriterionKind = Kind::new(
    "drift",
    "Turns every joint.",
    &[Parameter::required("speed", Form::Number, "rad/s", "Speed of every joint.")],
    |given, _| Box::new(Drift(given.number("speed").unwrap_or(0.0))),
);

#[test]
fn a_criterion_of_ones_own_changes_the_motion_and_not_the_order_of_the_error() {
    let kinds = Kinds::builtin().with_criterion(DRIFT);
    let own = ONE.replace("h = 0.4", "h = 0.4\n[[law.criterion]]\nkind = \"drift\"\nspeed = 0.2");
    let (plain, drifting) = (run(ONE, &kinds).unwrap(), run(&own, &kinds).unwrap());
    assert!(apart(&last(&plain, 0), &last(&drifting, 0)) > 0.01);
    let (plain, drifting) = (order(ONE, &kinds), order(&own, &kinds));
    assert!((plain - drifting).abs() < 0.3 && drifting > 3.5, "{plain} {drifting}");
    let scenario = read(&own, &kinds).unwrap();
    assert_eq!(read(&scenario.to_toml(), &kinds).unwrap(), scenario);
    let message = refusal(&own, &Kinds::builtin());
    assert!(message.starts_with("law.criterion[0].kind: \"drift\" is not one of repetitive, "), "{message}");
    let message = refusal(&own.replace("speed = 0.2", "sped = 0.2"), &kinds);
    assert_eq!(message, "law.criterion[0].sped: there is no such key; did you mean speed?");
    let message = refusal(&own.replace("speed = 0.2", ""), &kinds);
    assert_eq!(message, "law.criterion[0].speed: a drift needs this");
    let message = refusal(&own.replace("\"drift\"", "\"drft\""), &kinds);
    assert_eq!(
        message,
        "law.criterion[0].kind: \"drft\" is not one of repetitive, joint-limits, manipulability, posture, clearance, drift; did you mean drift?"
    );
}

#[test]
fn the_posture_holds_the_joints_where_they_start_or_pulls_them_elsewhere() {
    let kinds = Kinds::builtin();
    let posture = |q: &str| {
        ONE.replace("h = 0.4", &format!("h = 0.4\n[[law.criterion]]\nkind = \"posture\"\nrate = 4\n{q}"))
    };
    let (plain, held) = (run(ONE, &kinds).unwrap(), run(&posture(""), &kinds).unwrap());
    let q0 = plain.arms[0].position(0).to_vec();
    assert!(held.is_completed() && apart(&last(&held, 0), &q0) < apart(&last(&plain, 0), &q0));
    let given = run(&posture("q = [0.3, 0.4, 0.5, 0.6]"), &kinds).unwrap();
    assert_eq!(last(&given, 0), last(&held, 0));
    assert!(apart(&last(&run(&posture("q = [0.5, 0.1, \"pi/6\", 1]"), &kinds).unwrap(), 0), &q0) > 0.05);
    let message = refusal(&posture("q = [0.3, 0.4]"), &kinds);
    assert!(
        message.starts_with("law: ") && message.contains("a posture of 2 positions for 4 joints"),
        "{message}"
    );
    let message = refusal(&posture("").replace("rate = 4", "rate = -4"), &kinds);
    assert_eq!(message, "law.criterion[0].rate: -4 1/s is not a rate; it is positive");
    let message = refusal(&posture("").replace("rate = 4", "rate = 4000"), &kinds);
    assert!(message.starts_with("law: "), "a criterion that the row can not follow: {message}");
}

#[test]
fn a_posture_sees_the_joints_of_all_arms_that_are_tied() {
    let criterion = "h = 0.4\n[[law.criterion]]\nkind = \"posture\"\nrate = 2";
    let tied = format!("{PAIR}[[relation]]\nkind = \"distance\"\narms = [\"left\", \"right\"]\n")
        .replace("h = 0.4", criterion);
    let plan = run(&tied, &Kinds::builtin()).unwrap();
    assert!(plan.is_completed() && plan.tasks[0].max_error() < 1e-5);
    assert!(plan.arms.iter().all(|arm| arm.max_error_steady < 1e-5));
}

/// The transposed Jacobian.
struct Transposed(f64);

impl Law for Transposed {
    fn prepare(&mut self, _: &SystemShape) {}

    fn resolve(&mut self, at: &Instant<'_>, v: &mut JointVelocity<'_>) -> Result<Resolution, Infeasible> {
        v.feedforward.fill(0.0);
        v.feedback.fill(0.0);
        for task in at.tasks {
            for (joint, column) in task.jacobian.column_iter().enumerate() {
                for row in 0..task.rows() {
                    v.feedback[joint] += self.0 * column[row] * task.feedback[row];
                    v.feedforward[joint] += self.0 * column[row] * task.feedforward[row];
                }
            }
        }
        Ok(Resolution::default())
    }
}

const TRANSPOSED: Kind<MakeLaw> = Kind::new(
    "transposed",
    "The transposed Jacobian.",
    &[Parameter::optional("rate", Form::Positive { noun: "rate" }, "", "Factor. Default: 0.1.")],
    MakeLaw::Plain(|given| Box::new(Transposed(given.number("rate").unwrap_or(0.1)))),
);

#[test]
fn a_law_of_ones_own_is_named_like_the_built_in_one() {
    let kinds = Kinds::builtin().with_law(TRANSPOSED);
    let own = ONE.replace("h = 0.4", "h = 0.4\nkind = \"transposed\"\nrate = 0.2");
    let (plain, transposed) = (run(ONE, &kinds).unwrap(), run(&own, &kinds).unwrap());
    assert!(transposed.arms[0].max_error > 100.0 * plain.arms[0].max_error);
    let message = refusal(&own.replace("\"transposed\"", "\"transpose\""), &kinds);
    assert_eq!(
        message,
        "law.kind: \"transpose\" is not one of pseudoinverse, damped, weighted, prioritized, qp, saturated, network, transposed; did you mean transposed?"
    );
    let message = refusal(&own.replace("rate = 0.2", "threshold = 0.2"), &kinds);
    assert_eq!(
        message,
        "law.threshold: a transposed has no such parameter; it has h, gain, acceleration_limit, rate"
    );
    let criterion = own.replace("rate = 0.2", "[[law.criterion]]\nkind = \"posture\"\nrate = 1");
    let message = refusal(&criterion, &kinds);
    assert_eq!(
        message,
        "law.criterion: a transposed has no such parameter; it has h, gain, acceleration_limit, rate"
    );
    let replaced = MakeLaw::Plain(|_| Box::new(Pseudoinverse::new()));
    let kinds = kinds.with_law(Kind::new("transposed", "No longer.", &[], replaced));
    let again = run(&own.replace("rate = 0.2", ""), &kinds).unwrap();
    assert_eq!(last(&again, 0), last(&plain, 0));
}

/// The tips keep their offset in height, times a factor.
struct Level {
    offset: f64,
    factor: f64,
}

impl Task for Level {
    fn name(&self) -> &'static str {
        "level"
    }

    fn rows(&self) -> usize {
        1
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let up = Vector6::new(0.0, 0.0, self.factor, 0.0, 0.0, 0.0);
        let height = |i: usize| at.tip(i).pose.translation.z;
        out.error[0] = self.factor * (height(1) - height(0) - self.offset);
        out.feedforward[0] = 0.0;
        out.add_to_row(0, at.tip(1), &up);
        out.add_to_row(0, at.tip(0), &-up);
    }
}

const LEVEL: Kind<MakeTask> = Kind::new(
    "level",
    "Two tips keep their offset in height.",
    &[Parameter::optional("factor", Form::Number, "", "Factor. Default: 1.")],
    MakeTask::of(2, |given, start| {
        let [one, other] = start.tips else { return Err("this is about two tips".to_owned()) };
        let offset = other.translation.z - one.translation.z;
        Ok(Box::new(Level { offset, factor: given.number("factor").unwrap_or(1.0) }))
    }),
);

#[test]
fn a_task_of_ones_own_ties_two_tips() {
    let kinds = Kinds::builtin().with_task(LEVEL);
    let own = format!("{PAIR}[[relation]]\nkind = \"level\"\narms = [\"left\", \"right\"]\nfactor = 2\n");
    let plan = run(&own, &kinds).unwrap();
    assert_eq!((plan.tasks[0].name.as_str(), plan.tasks[0].rows), ("level", 1));
    assert!(plan.is_completed() && plan.tasks[0].max_error() < 1e-5, "{}", plan.tasks[0].max_error());
    let scenario = read(&own, &kinds).unwrap();
    assert_eq!(read(&scenario.to_toml(), &kinds).unwrap(), scenario);
    let message = refusal(&own, &Kinds::builtin());
    assert!(
        message
            .starts_with("relation[0].kind: \"level\" is not one of relative, cooperative, object, distance"),
        "{message}"
    );
}

#[test]
fn tips_keep_their_distance_or_the_one_that_is_asked_for() {
    let kinds = Kinds::builtin();
    let tied = |more: &str| {
        format!("{PAIR}[[relation]]\nkind = \"distance\"\narms = [\"left\", \"right\"]\n{more}\n")
    };
    let plan = run(&tied(""), &kinds).unwrap();
    assert!(plan.is_completed() && plan.tasks[0].max_error() < 1e-5, "{}", plan.tasks[0].max_error());
    assert_eq!(plan.tasks[0].arms, ["left", "right"]);
    let nearer = run(&tied("to = 0.6"), &kinds).unwrap();
    assert!(nearer.is_completed() && nearer.tasks[0].max_error() < 1e-5, "{}", nearer.tasks[0].max_error());
    assert!(apart(&last(&plan, 0), &last(&nearer, 0)) > 1e-3);
    let by_its_other_name = tied("").replace("[[relation]]", "[[task]]");
    assert_eq!(read(&by_its_other_name, &kinds).unwrap(), read(&tied(""), &kinds).unwrap());
    let spec = RelationSpec::new("distance", ["left", "right"]);
    let mut scenario = read(PAIR, &kinds).unwrap();
    scenario.relation.push(spec);
    assert_eq!(read(&scenario.to_toml(), &kinds).unwrap(), read(&tied(""), &kinds).unwrap());
    for (more, said) in [
        ("distance = 9", "relation[0]: task `distance`"),
        ("distance = 0", "relation[0].distance: 0 m is not a distance; it is positive"),
        ("distance = \"tau\"", "relation[0].distance: \"tau\", column 1"),
        ("distance = true", "relation[0].distance: invalid type: boolean `true`, expected a number"),
        ("distanz = 1", "relation[0].distanz: there is no such key; did you mean distance?"),
    ] {
        let message = refusal(&tied(more), &kinds);
        assert!(message.starts_with(said), "{more}: {message}");
    }
    for (arms, said) in [
        ("[\"left\"]", "relation[0].arms: a distance is about the tips of 2 arms, got 1"),
        ("[\"left\", \"rigt\"]", "relation[0].arms[1]: there is no arm \"rigt\"; did you mean right?"),
        ("[\"left\", \"left\"]", "relation[0].arms[1]: the arm \"left\" is named twice"),
    ] {
        let message = refusal(&tied("").replace("[\"left\", \"right\"]", arms), &kinds);
        assert_eq!(message, said);
    }
}

const HOOP: Kind<MakeCurve> = Kind::new(
    "hoop",
    "2 size (cos a, sin a).",
    &[Parameter::required("size", Form::Positive { noun: "size" }, "m", "Half the radius.")],
    MakeCurve::Planar(|given| Box::new(Circle { radius: 2.0 * given.number("size").unwrap_or(0.0) })),
);

/// `t^2 (3 - 2 t)`.
struct Cubic;

impl TimeLaw for Cubic {
    fn progress(&self, tau: f64) -> (f64, f64) {
        (tau * tau * (3.0 - 2.0 * tau), 6.0 * tau * (1.0 - tau))
    }
}

#[test]
fn a_curve_and_a_time_law_of_ones_own_are_named_in_a_path() {
    let kinds =
        Kinds::builtin()
            .with_curve(HOOP)
            .with_time_law(Kind::new("cubic", "t^2 (3 - 2 t).", &[], |_| Box::new(Cubic)));
    let own = ONE.replace("kind = \"circle\", radius = 0.1", "kind = \"hoop\", size = 0.05");
    let (plain, hooped) = (run(ONE, &kinds).unwrap(), run(&own, &kinds).unwrap());
    assert_eq!(last(&plain, 0), last(&hooped, 0));
    let cubic = run(&own.replace("sin2sin2", "cubic"), &kinds).unwrap();
    assert!(cubic.is_completed() && apart(&cubic.arms[0].positions[..], &plain.arms[0].positions[..]) > 1e-3);
    let message = refusal(&own.replace("\"hoop\"", "\"hop\""), &kinds);
    assert!(message.ends_with("spline, polyline, hoop; did you mean hoop?"), "{message}");
    let message = refusal(&own.replace("size = 0.05", "radius = 0.05"), &kinds);
    assert!(
        message.ends_with("it has plane, rotation, from, sweep, center, size, time_law, turn"),
        "{message}"
    );
    let message = refusal(&own.replace("sin2sin2", "cubik"), &kinds);
    assert_eq!(
        message,
        "arm.left.path.time_law: \"cubik\" is not one of sin2, sin2sin2, linear, quintic, trapezoid, s-curve, cubic; did you mean cubic?"
    );
    let message = refusal(&own, &Kinds::builtin());
    assert!(message.starts_with("arm.left.path.kind: \"hoop\" is not one of circle"), "{message}");
}

#[test]
fn what_a_program_makes_is_read_like_a_file() {
    let kinds = Kinds::builtin();
    let mut scenario = read(ONE, &kinds).unwrap();
    let mut posture = CriterionSpec::new("posture");
    posture.parameters.set("rate", "8/2");
    scenario.law.criterion.push(posture);
    let text = ONE.replace("h = 0.4", "h = 0.4\n[[law.criterion]]\nkind = \"posture\"\nrate = 4");
    let made = scenario.planner(FormulaTable::builtin(), None).unwrap().run();
    assert_eq!(last(&made, 0), last(&run(&text, &kinds).unwrap(), 0));
    scenario.law.criterion[0].parameters.set("rate", true);
    let refused = scenario.planner(FormulaTable::builtin(), None).unwrap_err();
    assert!(refused.message.starts_with("law.criterion[0].rate: invalid type: boolean"), "{refused}");
}
