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

/// What is watched on every sample of one arm: errors, limits, conditioning. Nothing here allocates after `new`.
#[derive(Clone, Debug)]
pub(super) struct Monitor {
    position: Vec<Worst>,
    velocity: Vec<Worst>,
    previous: Vec<f64>,
    pub(super) max_error: f64,
    pub(super) max_error_component: f64,
    pub(super) max_position_error: f64,
    pub(super) max_orientation_error: f64,
    pub(super) damped_samples: usize,
    pub(super) smallest_singular_value: f64,
    pub(super) smallest_at: f64,
}

impl Monitor {
    pub(super) fn new(joints: usize) -> Self {
        Self {
            position: vec![Worst::NONE; joints],
            velocity: vec![Worst::NONE; joints],
            previous: vec![f64::NAN; joints],
            max_error: 0.0,
            max_error_component: 0.0,
            max_position_error: 0.0,
            max_orientation_error: 0.0,
            damped_samples: 0,
            smallest_singular_value: f64::INFINITY,
            smallest_at: 0.0,
        }
    }

    pub(super) fn observe_error(&mut self, error: &Vector6<f64>) {
        let norm = error.norm();
        self.max_error = self.max_error.max(norm);
        self.max_error_component = self.max_error_component.max(error.amax());
        self.max_position_error = self.max_position_error.max(error.fixed_rows::<3>(0).norm());
        self.max_orientation_error = self.max_orientation_error.max(error.fixed_rows::<3>(3).norm());
    }

    pub(super) fn observe_joints(&mut self, chain: &Chain, t: f64, sigma: f64, q: &[f64], velocity: &[f64]) {
        for (i, joint) in chain.joints().iter().enumerate() {
            let limits = &joint.limits;
            self.position[i].observe(t, q[i], limits.lower, limits.upper);
            self.velocity[i].observe(t, velocity[i], -limits.velocity, limits.velocity);
            // NaN before the first step compares as no violation.
            let mean = (q[i] - self.previous[i]) / sigma;
            self.velocity[i].observe(t, mean, -limits.velocity, limits.velocity);
            self.previous[i] = q[i];
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
