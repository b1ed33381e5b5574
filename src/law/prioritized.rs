use super::criteria_sum::CriteriaSum;
use super::damping::threshold;
use super::task_stack::TaskStack;
use super::{
    Criteria, Criterion, Infeasible, Instant, JointVelocity, Law, LawKind, MakeLaw, Resolution, SystemShape,
};
use crate::kind::Kind;
use crate::math::{RowRotations, dot};
use std::ops::Range;

/// Singular values below this fraction of the longest row are rounding.
const ROUNDING: f64 = 1e-12;

/// A stack of tasks: what comes first is met first, and each further task as well as those before it leave it free.
///
/// With the tasks of one priority as the rows `J_k q' = v_k`, level after level (Siciliano and Slotine 1991, with the projectors of
/// Baerlocher and Boulic 1998): `q'_k = q'_(k-1) + (J_k P_(k-1))^+ (v_k - J_k q'_(k-1))` and `P_k = P_(k-1) - (J_k P_(k-1))^+ (J_k
/// P_(k-1))`, from `q'_0 = 0` and `P_0 = I`; the null-space criteria come last, `q' = q'_m + P_m c`. In every
/// inverse a singular value `s` below the threshold `epsilon` counts as `s / epsilon^2` instead of `1 / s` (numerical filtering,
/// Maciejewski and Klein 1988); projectors are never damped. A task of a lower level whose rows
/// the levels before it take has them missing: that is said in the plan and stops no run.
///
/// ```
/// use kinstep::law::Prioritized;
/// use kinstep::planner::JointSystem;
///
/// let pair = JointSystem::of(["left", "right"]).with_law(Prioritized::new());
/// # let _ = pair;
/// ```
#[derive(Default)]
pub struct Prioritized {
    given_threshold: Option<f64>,
    threshold: f64,
    criteria: CriteriaSum,
    stack: TaskStack,
    levels: Vec<Level>,
    /// `P`, row after row.
    projector: Vec<f64>,
}

/// The tasks of one priority.
struct Level {
    rows: Vec<usize>,
    rotations: RowRotations,
    /// `J_k P`, row after row.
    projected: Vec<f64>,
    /// `v_k - J_k q'`.
    rest: Vec<f64>,
}

impl std::fmt::Debug for Prioritized {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Prioritized").field("levels", &self.levels.len()).finish_non_exhaustive()
    }
}

impl Prioritized {
    /// The law with the default threshold and no criterion.
    pub fn new() -> Self {
        Self::default()
    }

    /// The same with a threshold of your own on the smallest singular values.
    #[must_use]
    pub fn with_threshold(mut self, threshold: f64) -> Self {
        self.given_threshold = Some(threshold);
        self
    }

    /// The same with a criterion for what all tasks leave free; criteria add up.
    #[must_use]
    pub fn with_criterion(mut self, criterion: impl Criterion + 'static) -> Self {
        self.criteria.push(criterion);
        self
    }

    fn with_criteria(self, criteria: Criteria) -> Self {
        Self { criteria: CriteriaSum::of(criteria), ..self }
    }
}

/// The rows of the tasks of each priority, in the order of these.
fn levels(shape: &SystemShape) -> Vec<Vec<usize>> {
    let mut first = 0;
    let spans: Vec<(usize, Range<usize>)> = shape
        .tasks
        .iter()
        .map(|task| {
            let rows = first..first + task.rows();
            first = rows.end;
            (task.priority, rows)
        })
        .collect();
    let mut priorities: Vec<usize> = spans.iter().map(|(priority, _)| *priority).collect();
    priorities.sort_unstable();
    priorities.dedup();
    let rows = |level: usize| {
        spans.iter().filter(move |(priority, _)| *priority == level).flat_map(|(_, rows)| rows.clone())
    };
    priorities.into_iter().map(|level| rows(level).collect()).collect()
}

impl Level {
    fn new(rows: Vec<usize>, joints: usize) -> Self {
        let count = rows.len();
        Self {
            rows,
            rotations: RowRotations::with_capacity(count, joints),
            projected: vec![0.0; count * joints],
            rest: vec![0.0; count],
        }
    }

    /// Decomposes `J_k P`; `None` for `P` is the identity.
    fn decompose(&mut self, stack: &TaskStack, projector: Option<&[f64]>, joints: usize) {
        for (projected, &row) in self.projected.chunks_exact_mut(joints).zip(&self.rows) {
            match projector {
                // P is symmetric.
                Some(projector) => {
                    for (entry, column) in projected.iter_mut().zip(projector.chunks_exact(joints)) {
                        *entry = dot(stack.row(row), column);
                    }
                }
                None => projected.copy_from_slice(stack.row(row)),
            }
        }
        let projected = &self.projected;
        self.rotations.compute(joints, |row, joint| projected[row * joints + joint]);
    }

    /// Adds what the level asks for beyond what `velocity` does already: directions below the threshold are damped one by one,
    /// and what is nothing but rounding is left out, so that nothing leaks into the levels before.
    fn add(&mut self, stack: &TaskStack, asked: &[f64], threshold: f64, velocity: &mut [f64]) {
        let mut size = 0.0_f64;
        for (rest, &row) in self.rest.iter_mut().zip(&self.rows) {
            *rest = asked[row] - dot(stack.row(row), velocity);
            size = size.max(dot(stack.row(row), stack.row(row)));
        }
        let least = ROUNDING * size.sqrt();
        let weight = |s: f64| match s {
            s if s <= least => 0.0,
            s if s < threshold => s / (threshold * threshold),
            s => s.recip(),
        };
        self.rotations.apply(&self.rest, weight, velocity);
    }

    /// Takes from the projector the directions that the level moves, and returns how many of its rows are missing.
    fn take_from(&self, projector: &mut [f64], threshold: f64, joints: usize) -> usize {
        let mut missing = 0;
        for (value, _, right) in self.rotations.directions() {
            if value < threshold {
                missing += 1;
                continue;
            }
            for (row, a) in projector.chunks_exact_mut(joints).zip(right) {
                for (entry, b) in row.iter_mut().zip(right) {
                    *entry -= a * b / (value * value);
                }
            }
        }
        missing
    }
}

impl Law for Prioritized {
    fn prepare(&mut self, shape: &SystemShape) {
        let joints = shape.joints.len();
        self.threshold = threshold(self.given_threshold, shape);
        self.criteria.prepare(shape);
        self.stack = TaskStack::new(shape);
        self.levels = levels(shape).into_iter().map(|rows| Level::new(rows, joints)).collect();
        self.projector = vec![0.0; joints * joints];
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        let joints = velocity.feedforward.len();
        self.stack.collect(instant.tasks);
        velocity.feedforward.fill(0.0);
        velocity.feedback.fill(0.0);
        self.projector.fill(0.0);
        self.projector.iter_mut().step_by(joints + 1).for_each(|diagonal| *diagonal = 1.0);
        let mut resolution = Resolution::default();
        for (place, level) in self.levels.iter_mut().enumerate() {
            let projector = (place > 0).then_some(&self.projector[..]);
            level.decompose(&self.stack, projector, joints);
            level.add(&self.stack, &self.stack.feedforward, self.threshold, velocity.feedforward);
            level.add(&self.stack, &self.stack.feedback, self.threshold, velocity.feedback);
            let missing = level.take_from(&mut self.projector, self.threshold, joints);
            if place == 0 {
                let smallest = level.rotations.smallest();
                resolution.smallest_singular_value = smallest;
                resolution.damped = smallest < self.threshold;
            }
            resolution.missing_rows += missing;
        }
        if !self.criteria.is_empty() {
            self.criteria.evaluate(instant);
            for (f, row) in velocity.feedforward.iter_mut().zip(self.projector.chunks_exact(joints)) {
                *f += dot(row, self.criteria.sum());
            }
            resolution.criterion_rate = self.criteria.rate_at(instant);
        }
        Ok(resolution)
    }

    fn threshold(&self) -> f64 {
        self.threshold
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        if shape.tasks.is_empty() {
            return Some("needs a task to resolve".to_owned());
        }
        self.criteria.objection(shape)
    }

    fn keeps_distances(&self) -> bool {
        self.criteria.keeps_distances()
    }

    fn criterion_rate(&self) -> Option<f64> {
        self.criteria.rate()
    }
}

pub(super) const KIND: LawKind = Kind::new(
    "prioritized",
    "A stack of tasks by their priorities: what comes first is met first, the next as well as the first leaves it free.",
    &[super::pseudoinverse::THRESHOLD],
    MakeLaw::WithCriteria(|given, criteria| {
        let law = Prioritized::new().with_criteria(criteria);
        Box::new(given.number("threshold").into_iter().fold(law, Prioritized::with_threshold))
    }),
);
