use crate::collision::Proximities;
use crate::robot::Limits;
use crate::task::{TaskRows, Tip};

/// Everything that decides what the joints of a system do at one instant.
///
/// A system has `n` joints and any number of tasks; task `i` asks for `J_i q' = phi_i' - k e_i`.
#[derive(Clone, Copy, Debug)]
pub struct Instant<'a> {
    /// Time \[s\].
    pub t: f64,
    /// The sampling gap of the run \[s\].
    pub sigma: f64,
    /// Whether it is a sample of the run, one `sigma` after the one before, rather than a stage between samples.
    pub is_sample: bool,
    /// Joint positions [rad or m], `n` of them.
    pub q: &'a [f64],
    /// The joint velocities [rad/s or m/s] that were resolved at the sample before, both parts together; zero before the
    /// first sample.
    pub previous_velocity: &'a [f64],
    /// What the joints allow: positions [rad or m] and speeds [rad/s or m/s], infinite where nothing is known.
    pub limits: &'a [Limits],
    /// The rows of all tasks, each over all `n` joints.
    pub tasks: &'a [TaskRows],
    /// The tips of the system's arms, in their order, with pose and geometric Jacobian.
    pub tips: &'a [Tip],
    /// How the next state depends on what is resolved here, if the law [asks for it](super::Law::needs_next_state).
    pub next: Option<NextState<'a>>,
    /// The pairs of bodies that are near, if something stands around the arms and the law
    /// [keeps distances](super::Law::keeps_distances).
    pub avoidance: Option<Avoidance<'a>>,
}

/// Pairs of bodies that are near, and how they are to be kept apart.
#[derive(Clone, Copy, Debug)]
pub struct Avoidance<'a> {
    /// The pairs nearer than `influence`, each with its distance \[m\] and the derivatives of that by the joints; behind each the
    /// ends of its capsules as far as these are near too.
    pub contacts: &'a Proximities,
    /// How near they may come \[m\].
    pub margin: f64,
    /// From where on they count \[m\]: more than the margin.
    pub influence: f64,
    /// How fast they may come nearer where they begin to count [m/s].
    pub speed: f64,
}

/// The joint positions of the next sample as a function of what is resolved now:
/// `q_{n+1} = known + first * f + second * g`, with `f` the feedforward part and `g` the feedback part.
///
/// Limits belong to that state. While a start is under way whose step is no row (a Runge-Kutta step), it is the state that
/// one Euler step would lead to.
#[derive(Clone, Copy, Debug)]
pub struct NextState<'a> {
    /// What the history contributes [rad or m], one entry per joint.
    pub known: &'a [f64],
    /// What the feedforward part is multiplied by \[s\]: `sigma beta_1 / alpha_0`.
    pub first: f64,
    /// What the feedback part is multiplied by \[s\]: `sigma gamma_1 / alpha_0`.
    pub second: f64,
}

/// The answer of a law, to be written: one entry per joint in both parts [rad/s or m/s].
#[derive(Debug)]
pub struct JointVelocity<'a> {
    /// What is integrated with the row's `beta`: `J^+ phi'` and the null-space part; of a law that is not linear, everything.
    pub feedforward: &'a mut [f64],
    /// What is integrated with the row's `gamma`: `-k J^+ e`. Of a law that is not linear, zero, whatever it writes here.
    pub feedback: &'a mut [f64],
}
