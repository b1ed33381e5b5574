use crate::integrate::IntegrateError;
use crate::math::number_text;
use crate::robot::PositionsError;
use thiserror::Error;

/// Why a planner could not be made. The text is a sentence that names the remedy.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum PlannerError {
    /// No arm was added.
    #[error("a plan needs at least one arm")]
    NoArms,
    /// Two arms have one name.
    #[error("two arms are called `{name}`; names tell the columns of the output apart, so give each its own")]
    DuplicateArm {
        /// The name.
        name: String,
    },
    /// What is said of the surroundings makes no sense.
    #[error("what stands around the arms: {problem}")]
    Surroundings {
        /// What is wrong.
        problem: String,
    },
    /// Two bodies start nearer to each other than they may come.
    #[error(
        "`{one}` and `{other}` {}, and the margin is {} m; start elsewhere, lower the margin, or allow the pair if the two may touch",
        start_apart(*.distance), number_text(*.margin)
    )]
    TooNear {
        /// The machine and the link.
        one: String,
        /// Another of these, or an obstacle.
        other: String,
        /// How far they are apart \[m\]; negative where they overlap.
        distance: f64,
        /// How near they may come \[m\].
        margin: f64,
    },
    /// The formula was not set.
    #[error("no formula was chosen")]
    NoFormula,
    /// The duration is not a positive number.
    #[error("the duration is {value} s; it must be a positive number")]
    Duration {
        /// What was given \[s\].
        value: f64,
    },
    /// The sampling gap is not positive, not finite, or longer than the plan.
    #[error("sigma is {value} s; it must be positive and at most the duration, {duration} s")]
    Sigma {
        /// What was given \[s\].
        value: f64,
        /// The duration \[s\].
        duration: f64,
    },
    /// The plan would not fit into memory.
    #[error(
        "sigma = {sigma} s makes {steps:.3e} steps: about {gibibytes:.3e} GiB of samples and {seconds:.1e} s of work; choose a larger sigma or a shorter duration"
    )]
    TooManySteps {
        /// The sampling gap \[s\].
        sigma: f64,
        /// Steps.
        steps: f64,
        /// Memory of the samples \[GiB\].
        gibibytes: f64,
        /// Estimated time \[s\].
        seconds: f64,
    },
    /// Neither or an unusable feedback was given.
    #[error("the feedback {what} is {value}; it must be a number, zero or positive")]
    Feedback {
        /// "step h" or "gain".
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// The noise has something that is no standard deviation.
    #[error("the noise `{what}` is {value}; a standard deviation is a number, zero or positive")]
    Noise {
        /// Which of its numbers.
        what: &'static str,
        /// What was given.
        value: f64,
    },
    /// The feedback step lies outside the range in which the loop is stable.
    #[error(
        "h = {shown} lies outside the feedback range {range} of formula `{formula}`: the closed loop would not be stable there; choose h inside the range, or allow unstable runs",
        shown = crate::math::number_text(*h)
    )]
    StepSizeOutsideRange {
        /// The feedback step.
        h: f64,
        /// The row.
        formula: String,
        /// The range as text, such as `(0, 2/3)`.
        range: String,
    },
    /// A null-space criterion pulls faster than the row can follow.
    #[error(
        "arm `{arm}`: the null-space criterion has rate {rate} 1/s, and at sigma = {sigma} s formula `{formula}` follows rates below {limit:.6} 1/s only; lower the rate or sigma"
    )]
    CriterionTooFast {
        /// The arm.
        arm: String,
        /// The criterion's rate [1/s].
        rate: f64,
        /// The sampling gap \[s\].
        sigma: f64,
        /// The row.
        formula: String,
        /// The limit [1/s].
        limit: f64,
    },
    /// The initial joint positions do not fit the chain, or lie outside its limits.
    #[error("arm `{arm}`: q0: {problem}")]
    Initial {
        /// The arm.
        arm: String,
        /// What does not fit.
        problem: PositionsError,
    },
    /// The path does not begin where the tip is.
    #[error(
        "arm `{arm}`: its path begins {distance:.6} m (or rad) away from the tip at q0; leave out `center` to have the path begin at the tip, or change q0"
    )]
    PathStart {
        /// The arm.
        arm: String,
        /// Norm of the task error at the start [m or rad].
        distance: f64,
    },
    /// The path begins so far from the tip that the arm would count as lost before the feedback could bring it in.
    #[error(
        "arm `{arm}`: its path begins {distance:.6} m (or rad) away from the tip at q0, further than feedback brings an arm in; lead it there instead, or change q0"
    )]
    TooFar {
        /// The arm.
        arm: String,
        /// Norm of the task error at the start [m or rad].
        distance: f64,
    },
    /// Two arms move a joint in common, and start it at different positions.
    #[error(
        "arms `{arm}` and `{other}` share joint `{joint}`, which starts at {} in the one and at {} in the other; give it one position",
        crate::math::number_text(*.value), crate::math::number_text(*.other_value)
    )]
    SharedStart {
        /// The joint.
        joint: String,
        /// The arm named first.
        arm: String,
        /// Where the joint starts there [rad or m].
        value: f64,
        /// The other arm.
        other: String,
        /// Where the joint starts there [rad or m].
        other_value: f64,
    },
    /// An arm that is resolved together with others has a law of its own that is not the plain least-norm law.
    #[error(
        "arm `{arm}` is resolved together with other arms and was given a law that is not the plain least-norm law; give one law to all of them, with `JointSystem::with_law`"
    )]
    SharedLaw {
        /// The arm.
        arm: String,
    },
    /// A system names an arm that there is not.
    #[error("there is no arm `{name}`; the arms are `{known}`")]
    UnknownArm {
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// Arms that are resolved as one system were given two laws.
    #[error(
        "the arms `{arms}` are resolved as one system and were given two laws for it; leave one of them out"
    )]
    TwoLaws {
        /// The arms.
        arms: String,
    },
    /// A law can not resolve the system that it was given.
    #[error("the law of `{arms}`: this law {objection}")]
    LawDoesNotFit {
        /// The arms of the system.
        arms: String,
        /// What the law says of it.
        objection: String,
    },
    /// A task can not be a part of any system.
    #[error("task `{task}` {problem}")]
    Task {
        /// The task.
        task: String,
        /// What is wrong with it.
        problem: String,
    },
    /// An arm has no task of its own, and no other task is about it.
    #[error(
        "arm `{arm}` has no task of its own, and no task that it has together with others says what it does; give it one"
    )]
    NoTask {
        /// The arm.
        arm: String,
    },
    /// Tasks ask for the same motion, whatever the joint positions.
    #[error(
        "{task} asks for what {others} asks for already, so that no q0 is regular; leave one of them out, or mask rows of one"
    )]
    DependentTasks {
        /// The task, with its arm where it is its own.
        task: String,
        /// Those that it depends on, in the same words.
        others: String,
        /// The arm whose own task it is.
        arm: Option<String>,
        /// The name of the task alone.
        name: String,
    },
    /// No joint moves some rows of a task.
    #[error("{task} asks for {rows}, which no joint of its arms moves; leave those rows out")]
    StillRows {
        /// The task, with its arm where it is its own.
        task: String,
        /// The rows.
        rows: String,
        /// The arm whose own task it is.
        arm: Option<String>,
        /// The name of the task alone.
        name: String,
    },
    /// A system has no arm.
    #[error("a system was asked for that names no arm; name those that are to be resolved together")]
    SystemWithoutArms,
    /// A task over several tips does not begin where they are.
    #[error(
        "task `{task}` has an error of {distance:.6} m (or rad) at q0; change q0, or have the task begin there"
    )]
    TaskStart {
        /// The task.
        task: String,
        /// Norm of its error at the start [m or rad].
        distance: f64,
    },
    /// The chain has no movable joint.
    #[error("arm `{arm}`: nothing moves between `{base}` and `{tip}`")]
    NoJoints {
        /// The arm.
        arm: String,
        /// The chain's base.
        base: String,
        /// The chain's tip.
        tip: String,
    },
    /// The stepper refused the row or the start.
    #[error(transparent)]
    Integrate(#[from] IntegrateError),
}

/// How far two bodies are apart at the start, to a micrometre.
fn start_apart(distance: f64) -> String {
    let length = number_text((distance.abs() * 1e6).round() / 1e6);
    if distance < 0.0 {
        format!("overlap by {length} m at the start")
    } else {
        format!("start {length} m apart")
    }
}
