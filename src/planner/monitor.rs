use crate::law::Resolution;
use crate::robot::Chain;
use nalgebra::Vector6;

/// Which limit of a joint was crossed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitKind {
    /// Lower or upper position limit [rad or m].
    Position,
    /// Velocity limit [rad/s or m/s], of the joint velocity or of the mean velocity between two samples.
    Velocity,
}

impl LimitKind {
    /// The word used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
        }
    }
}

/// The worst crossing of one limit of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The joint.
    pub joint: String,
    /// Which of its limits.
    pub kind: LimitKind,
    /// When it was worst \[s\].
    pub t: f64,
    /// The position or velocity then.
    pub value: f64,
    /// The limit crossed.
    pub limit: f64,
}

/// A crossing of a limit while the run goes on: where it was worst.
#[derive(Clone, Copy, Debug)]
struct Worst {
    excess: f64,
    t: f64,
    value: f64,
    limit: f64,
}

impl Worst {
    const NONE: Self = Self { excess: 0.0, t: 0.0, value: 0.0, limit: 0.0 };

    fn observe(&mut self, t: f64, value: f64, lower: f64, upper: f64) {
        let (excess, limit) = if value > upper { (value - upper, upper) } else { (lower - value, lower) };
        if excess > self.excess {
            *self = Self { excess, t, value, limit };
        }
    }
}

/// The squared lengths of a task error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deviation {
    /// \[m^2\]
    pub(super) position: f64,
    /// \[rad^2\]
    pub(super) orientation: f64,
}

impl Deviation {
    pub(super) fn of(error: &Vector6<f64>) -> Self {
        Self {
            position: error.fixed_rows::<3>(0).norm_squared(),
            orientation: error.fixed_rows::<3>(3).norm_squared(),
        }
    }
}

/// The larger of the two, the first when the second is NaN: one instruction where `f64::max` takes five.
fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// What is watched on every sample of one arm: errors, limits, conditioning. Nothing here allocates after `new`.
#[derive(Clone, Debug)]
pub(super) struct Monitor {
    position: Vec<Worst>,
    velocity: Vec<Worst>,
    /// The positions one sample ago.
    previous: Vec<f64>,
    bounds: Bounds,
    sigma: f64,
    largest: Deviation,
    largest_sum: f64,
    pub(super) max_error_component: f64,
    pub(super) damped_samples: usize,
    pub(super) smallest_singular_value: f64,
    pub(super) smallest_at: f64,
}

/// The limits of all joints, in the form in which most samples are done with at a glance.
#[derive(Clone, Debug)]
struct Bounds {
    lower: Vec<f64>,
    upper: Vec<f64>,
    velocity: Vec<f64>,
    /// How far a joint may go in one step, less what rounding could make of it.
    stride: Vec<f64>,
}

impl Bounds {
    fn of(chain: &Chain, sigma: f64) -> Self {
        let all = |pick: fn(&crate::robot::Limits) -> f64| -> Vec<f64> {
            chain.joints().iter().map(|joint| pick(&joint.limits)).collect()
        };
        let velocity = all(|limits| limits.velocity);
        let stride = velocity.iter().map(|limit| limit * sigma * (1.0 - 1e-12)).collect();
        Self { lower: all(|limits| limits.lower), upper: all(|limits| limits.upper), velocity, stride }
    }

    /// Whether no limit can have been crossed. Every joint is looked at, whatever the others are: that is quicker than to
    /// stop early.
    #[expect(clippy::needless_bitwise_bool, reason = "without branches the loop is vectorised")]
    fn hold(&self, q: &[f64], velocity: &[f64], previous: &[f64]) -> bool {
        let n = self.lower.len();
        let (q, velocity, previous) = (&q[..n], &velocity[..n], &previous[..n]);
        let (upper, fastest, stride) = (&self.upper[..n], &self.velocity[..n], &self.stride[..n]);
        let mut all = true;
        for i in 0..n {
            all &= (q[i] >= self.lower[i])
                & (q[i] <= upper[i])
                & (velocity[i].abs() <= fastest[i])
                & ((q[i] - previous[i]).abs() <= stride[i]);
        }
        all
    }
}

impl Monitor {
    pub(super) fn new(chain: &Chain, sigma: f64) -> Self {
        Self {
            position: vec![Worst::NONE; chain.dof()],
            velocity: vec![Worst::NONE; chain.dof()],
            previous: vec![f64::NAN; chain.dof()],
            bounds: Bounds::of(chain, sigma),
            sigma,
            largest: Deviation { position: 0.0, orientation: 0.0 },
            largest_sum: 0.0,
            max_error_component: 0.0,
            damped_samples: 0,
            smallest_singular_value: f64::INFINITY,
            smallest_at: 0.0,
        }
    }

    pub(super) fn observe_error(&mut self, error: &Vector6<f64>, deviation: &Deviation) {
        self.largest_sum = larger(self.largest_sum, deviation.position + deviation.orientation);
        self.largest.position = larger(self.largest.position, deviation.position);
        self.largest.orientation = larger(self.largest.orientation, deviation.orientation);
        self.max_error_component = error.iter().fold(self.max_error_component, |a, b| larger(a, b.abs()));
    }

    /// The largest norm of the task error.
    pub(super) fn max_error(&self) -> f64 {
        self.largest_sum.sqrt()
    }

    /// The largest position error \[m\].
    pub(super) fn max_position_error(&self) -> f64 {
        self.largest.position.sqrt()
    }

    /// The largest orientation error \[rad\].
    pub(super) fn max_orientation_error(&self) -> f64 {
        self.largest.orientation.sqrt()
    }

    pub(super) fn observe_joints(&mut self, t: f64, q: &[f64], velocity: &[f64]) {
        if !self.bounds.hold(q, velocity, &self.previous) {
            self.look_closely(t, q, velocity);
        }
        self.previous.copy_from_slice(q);
    }

    /// Takes down the crossings of a sample that is not clearly within all limits.
    #[cold]
    fn look_closely(&mut self, t: f64, q: &[f64], velocity: &[f64]) {
        let bounds = &self.bounds;
        for i in 0..q.len() {
            let fastest = bounds.velocity[i];
            self.position[i].observe(t, q[i], bounds.lower[i], bounds.upper[i]);
            self.velocity[i].observe(t, velocity[i], -fastest, fastest);
            // NaN before the first step compares as no violation.
            let mean = (q[i] - self.previous[i]) / self.sigma;
            self.velocity[i].observe(t, mean, -fastest, fastest);
        }
    }

    pub(super) fn observe_conditioning(&mut self, resolution: &Resolution, t: f64) {
        self.damped_samples += usize::from(resolution.damped);
        if resolution.smallest_singular_value < self.smallest_singular_value {
            self.smallest_singular_value = resolution.smallest_singular_value;
            self.smallest_at = t;
        }
    }

    pub(super) fn violations(&self, chain: &Chain) -> Vec<Violation> {
        let mut violations = Vec::new();
        for (i, joint) in chain.joints().iter().enumerate() {
            for (kind, worst) in
                [(LimitKind::Position, &self.position[i]), (LimitKind::Velocity, &self.velocity[i])]
            {
                if worst.excess > 0.0 {
                    let Worst { t, value, limit, .. } = *worst;
                    violations.push(Violation { joint: joint.name.clone(), kind, t, value, limit });
                }
            }
        }
        violations
    }
}
