use super::bounds::Deviation;
use super::limits::{JointLimits, excess};
use crate::law::{LimitKind, Resolution};
use crate::math::{Kernel, Lane, Lanes, level, with_instructions};
use crate::robot::Chain;
use fearless_simd::Simd;
use nalgebra::Vector6;

/// The worst crossing of one limit of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Violation {
    /// The joint.
    pub joint: String,
    /// Which of its limits.
    pub kind: LimitKind,
    /// When it was worst \[s\].
    pub t: f64,
    /// The position, velocity, acceleration or jerk then.
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

/// The larger of the two, the first when the second is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// What is watched on every sample of one arm: errors, limits, conditioning. Nothing here allocates after `new`.
#[derive(Clone, Debug)]
pub(in crate::planner) struct Monitor {
    position: Vec<Worst>,
    velocity: Vec<Worst>,
    /// The joints that started outside their position limits and have not been within since.
    returning: Vec<usize>,
    /// When the last of them came back \[s\].
    pub(in crate::planner) returned: Option<f64>,
    /// The positions one sample ago.
    pub(in crate::planner) previous: Vec<f64>,
    limits: Vec<JointLimits<[f64; 1]>>,
    sigma: f64,
    largest: Deviation,
    largest_sum: f64,
    pub(in crate::planner) max_error_component: f64,
    pub(in crate::planner) damped_samples: usize,
    pub(in crate::planner) smallest_singular_value: f64,
    pub(in crate::planner) smallest_at: f64,
    /// How many rows of a stack of tasks could not be met at most, and when.
    pub(in crate::planner) most_missing_rows: (usize, f64),
    /// The largest rate [1/s] of null-space criteria, and when.
    pub(in crate::planner) largest_rate: (f64, f64),
}

/// How far the joints of one arm are beyond their limits at most.
struct Excess<'a> {
    limits: &'a [JointLimits<[f64; 1]>],
    positions: &'a [f64],
    previous: &'a [f64],
    velocities: &'a [f64],
}

impl Kernel for Excess<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> f64 {
        let lane = |entries: &[f64], joint: usize| Lane::splat(simd, entries[joint]);
        let mut most = Lane::splat(simd, 0.0);
        for (joint, limits) in self.limits.iter().enumerate() {
            let [q, previous, velocity] =
                [self.positions, self.previous, self.velocities].map(|entries| lane(entries, joint));
            most = excess(simd, limits, [q, previous, velocity], most);
        }
        most.value
    }
}

impl Monitor {
    /// The monitor of a chain whose joints start at `q0` [rad or m].
    pub(in crate::planner) fn new(chain: &Chain, q0: &[f64], sigma: f64) -> Self {
        let starts = chain.joints().iter().zip(q0).enumerate();
        let outside = starts.filter(|(_, (joint, q))| !joint.limits.contains(**q));
        Self {
            returning: outside.map(|(joint, _)| joint).collect(),
            returned: None,
            position: vec![Worst::NONE; chain.dof()],
            velocity: vec![Worst::NONE; chain.dof()],
            previous: vec![f64::NAN; chain.dof()],
            limits: chain.joints().iter().map(|joint| JointLimits::of(&joint.limits, sigma)).collect(),
            sigma,
            largest: Deviation { position: 0.0, orientation: 0.0 },
            largest_sum: 0.0,
            max_error_component: 0.0,
            damped_samples: 0,
            smallest_singular_value: f64::INFINITY,
            smallest_at: 0.0,
            most_missing_rows: (0, 0.0),
            largest_rate: (0.0, 0.0),
        }
    }

    /// The limits of all joints.
    pub(in crate::planner) fn limits(&self) -> &[JointLimits<[f64; 1]>] {
        &self.limits
    }

    pub(in crate::planner) fn observe_error(&mut self, error: &Vector6<f64>) {
        let Deviation { position, orientation } = Deviation::of(error);
        let component = error.iter().fold(0.0, |a, b| larger(a, b.abs()));
        self.observe_largest([position, orientation, position + orientation], component);
    }

    /// Takes note of the squares of a position error, of an orientation error and of both, and of the largest component.
    fn observe_largest(&mut self, [position, orientation, sum]: [f64; 3], component: f64) {
        self.largest.position = larger(self.largest.position, position);
        self.largest.orientation = larger(self.largest.orientation, orientation);
        self.largest_sum = larger(self.largest_sum, sum);
        self.max_error_component = larger(self.max_error_component, component);
    }

    /// Takes note of many samples: the largest of what [`observe_error`](Self::observe_error) looks at, and the smallest
    /// singular value with the time of its first occurrence.
    pub(in crate::planner) fn observe_extremes(
        &mut self,
        squares: [f64; 3],
        component: f64,
        smallest: (f64, f64),
    ) {
        self.observe_largest(squares, component);
        let known = (self.smallest_singular_value, self.smallest_at);
        if smallest.0 < known.0 || (smallest.0 == known.0 && smallest.1 < known.1) {
            (self.smallest_singular_value, self.smallest_at) = smallest;
        }
    }

    /// The largest norm of the task error.
    pub(in crate::planner) fn max_error(&self) -> f64 {
        self.largest_sum.sqrt()
    }

    /// The largest position error \[m\].
    pub(in crate::planner) fn max_position_error(&self) -> f64 {
        self.largest.position.sqrt()
    }

    /// The largest orientation error \[rad\].
    pub(in crate::planner) fn max_orientation_error(&self) -> f64 {
        self.largest.orientation.sqrt()
    }

    pub(in crate::planner) fn observe_joints(&mut self, t: f64, q: &[f64], velocity: &[f64]) {
        let (limits, previous) = (&self.limits, &self.previous);
        let excess = Excess { limits, positions: q, previous, velocities: velocity };
        // Joints that come back from outside are looked at until they are within.
        if with_instructions(level(), excess) > 0.0 || !self.returning.is_empty() {
            self.look_closely(t, q, velocity);
        }
        self.previous.copy_from_slice(q);
    }

    /// Takes down the crossings of a sample that is not clearly within all limits.
    #[cold]
    pub(in crate::planner) fn look_closely(&mut self, t: f64, q: &[f64], velocity: &[f64]) {
        for (i, limit) in self.limits.iter().enumerate() {
            let ([lower], [upper], [fastest]) = (limit.lower, limit.upper, limit.velocity);
            self.position[i].observe(t, q[i], lower, upper);
            if self.returning.contains(&i) && lower <= q[i] && q[i] <= upper {
                // What was asked for has been done: the limits hold from here on.
                self.returning.retain(|&joint| joint != i);
                (self.returned, self.position[i]) = (Some(t), Worst::NONE);
            }
            self.velocity[i].observe(t, velocity[i], -fastest, fastest);
            // NaN before the first step compares as no violation.
            let mean = (q[i] - self.previous[i]) / self.sigma;
            self.velocity[i].observe(t, mean, -fastest, fastest);
        }
    }

    pub(in crate::planner) fn observe_conditioning(&mut self, resolution: &Resolution, t: f64) {
        self.damped_samples += usize::from(resolution.damped);
        if resolution.smallest_singular_value < self.smallest_singular_value {
            self.smallest_singular_value = resolution.smallest_singular_value;
            self.smallest_at = t;
        }
        if resolution.missing_rows > self.most_missing_rows.0 {
            self.most_missing_rows = (resolution.missing_rows, t);
        }
        // A rate that is not a number is none that could be followed.
        if !(resolution.criterion_rate <= self.largest_rate.0) {
            self.largest_rate = (resolution.criterion_rate, t);
        }
    }

    /// The joints that started outside their position limits and never came back.
    pub(in crate::planner) fn stayed_outside(&self) -> &[usize] {
        &self.returning
    }

    pub(in crate::planner) fn violations(&self, chain: &Chain) -> Vec<Violation> {
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
