use super::criteria_sum::CriteriaSum;
use super::damping::threshold;
use super::task_stack::TaskStack;
use super::{
    Criteria, Criterion, Infeasible, Instant, JointVelocity, Law, LawKind, LinearityKind, MakeLaw,
    Resolution, SystemShape,
};
use crate::kind::{Form, Kind, Parameter, Parameters};
use crate::math::{RowRotations, dot};
use crate::robot::Limits;

/// How an inverse is damped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Damping {
    /// Everywhere by the same factor `lambda`, in the unit of the singular values: `s / (s^2 + lambda^2)` in place of `1 / s`
    /// (Wampler 1986; Nakamura and Hanafusa 1986). A task is never met quite, by the share `lambda^2 / (s^2 + lambda^2)` of what
    /// it asks for.
    Constant(f64),
    /// Only where the smallest singular value lies below the law's threshold `epsilon`, by `lambda^2 = lambda_max^2 (1 - (s_min /
    /// epsilon)^2)` (Chiaverini 1997), with the threshold itself as `lambda_max` unless given.
    Adaptive(Option<f64>),
    /// Direction by direction, so that none moves a joint faster than `v_max` [rad/s or m/s] and those that move joints far for
    /// little motion of the tip are held to less (Buss and Kim 2005); the least velocity limit of the joints unless given, or 1
    /// where none has any.
    Selective(Option<f64>),
}

/// Damped least squares: near a singularity the tasks are met as well as bounded joint velocities allow.
///
/// With the singular value decomposition `J = sum s_i u_i v_i^T`, `q' = sum v_i w_i (u_i . (phi' - k e)) + (I - J^+ J) c` with
/// weights `w_i` by the [`Damping`] and `c` what the null-space criteria ask for. The projector is never damped: it drops the
/// directions below the threshold. [`Pseudoinverse`](super::Pseudoinverse) is the adaptive one with the default `lambda_max`, and
/// faster.
///
/// ```
/// use kinstep::law::{Damped, Damping};
/// use kinstep::planner::JointSystem;
///
/// let pair = JointSystem::of(["left", "right"]).with_law(Damped::new(Damping::Constant(0.01)));
/// # let _ = pair;
/// ```
pub struct Damped {
    damping: Damping,
    given_threshold: Option<f64>,
    threshold: f64,
    criteria: CriteriaSum,
    stack: TaskStack,
    rotations: RowRotations,
    /// `J c`, and what of it the joints can do; what selective damping adds up.
    image: Vec<f64>,
    projected: Vec<f64>,
    /// For each task and joint the length of the column of its Jacobian.
    lengths: Vec<f64>,
}

impl std::fmt::Debug for Damped {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Damped").field("damping", &self.damping).finish_non_exhaustive()
    }
}

impl Damped {
    /// The law with the default threshold and no criterion.
    pub fn new(damping: Damping) -> Self {
        Self {
            damping,
            given_threshold: None,
            threshold: 0.0,
            criteria: CriteriaSum::default(),
            stack: TaskStack::default(),
            rotations: RowRotations::with_capacity(0, 0),
            image: Vec::new(),
            projected: Vec::new(),
            lengths: Vec::new(),
        }
    }

    /// The same with a threshold of your own on the smallest singular value of the task Jacobian.
    #[must_use]
    pub fn with_threshold(mut self, threshold: f64) -> Self {
        self.given_threshold = Some(threshold);
        self
    }

    /// The same with a criterion for the null space; criteria add up.
    #[must_use]
    pub fn with_criterion(mut self, criterion: impl Criterion + 'static) -> Self {
        self.criteria.push(criterion);
        self
    }

    fn with_criteria(self, criteria: Criteria) -> Self {
        Self { criteria: CriteriaSum::of(criteria), ..self }
    }

    /// `lambda^2` at this instant.
    fn factor(&self, smallest: f64) -> f64 {
        match self.damping {
            Damping::Constant(factor) => factor * factor,
            Damping::Adaptive(most) => {
                let (most, part) = (most.unwrap_or(self.threshold), smallest / self.threshold);
                most * most * (1.0 - part * part).max(0.0)
            }
            Damping::Selective(_) => 0.0,
        }
    }

    /// Writes both parts together, direction by direction.
    fn select(&mut self, most: f64, tasks: &[crate::task::TaskRows], x: &mut [f64]) {
        let joints = x.len();
        for (lengths, task) in self.lengths.chunks_exact_mut(joints).zip(tasks) {
            for (length, column) in lengths.iter_mut().zip(task.jacobian.column_iter()) {
                *length = column.norm();
            }
        }
        x.fill(0.0);
        for (value, u, right) in self.rotations.directions() {
            if value == 0.0 {
                continue;
            }
            let asked = dot(u, &self.stack.feedforward) + dot(u, &self.stack.feedback);
            let (mut first, mut seen, mut moved) = (0, 0.0, 0.0);
            for (task, lengths) in tasks.iter().zip(self.lengths.chunks_exact(joints)) {
                let own = &u[first..first + task.rows()];
                seen += dot(own, own).sqrt();
                let ways = right.iter().zip(lengths).map(|(entry, length)| entry.abs() * length);
                moved += ways.sum::<f64>() / (value * value);
                first += task.rows();
            }
            let allowed = most * (seen / moved).min(1.0);
            // Rows of the decomposition are s_i v_i.
            let wanted = asked / (value * value);
            let largest = right.iter().fold(0.0_f64, |most, entry| most.max(entry.abs()));
            let speed = (wanted.abs() * largest).max(f64::MIN_POSITIVE);
            let scale = wanted * (allowed / speed).min(1.0);
            for (x, entry) in x.iter_mut().zip(right) {
                *x += scale * entry;
            }
        }
        let largest = x.iter().fold(most, |most, entry| most.max(entry.abs()));
        for x in x {
            *x *= most / largest;
        }
    }

    /// Adds `(I - J^+ J) c`, never damped.
    fn add_criteria(&mut self, instant: &Instant<'_>, feedforward: &mut [f64]) -> f64 {
        if self.criteria.is_empty() {
            return 0.0;
        }
        self.criteria.evaluate(instant);
        let c = self.criteria.sum();
        self.stack.image(c, &mut self.image);
        self.projected.fill(0.0);
        let weight = |s: f64| if s < self.threshold { 0.0 } else { s.recip() };
        self.rotations.apply(&self.image, weight, &mut self.projected);
        for (f, (c, projected)) in feedforward.iter_mut().zip(c.iter().zip(&self.projected)) {
            *f += c - projected;
        }
        self.criteria.rate_at(instant)
    }
}

impl Law for Damped {
    fn prepare(&mut self, shape: &SystemShape) {
        let (rows, joints) = (shape.rows(), shape.joints.len());
        self.threshold = threshold(self.given_threshold, shape);
        self.criteria.prepare(shape);
        self.stack = TaskStack::new(shape);
        self.rotations = RowRotations::with_capacity(rows, joints);
        self.image = vec![0.0; rows];
        self.projected = vec![0.0; joints];
        self.lengths = vec![0.0; shape.tasks.len() * joints];
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        let joints = velocity.feedforward.len();
        self.stack.collect(instant.tasks);
        let jacobian = &self.stack.jacobian;
        self.rotations.compute(joints, |row, joint| jacobian[row * joints + joint]);
        let smallest = self.rotations.smallest();
        velocity.feedback.fill(0.0);
        if let Damping::Selective(most) = self.damping {
            let most = most.unwrap_or_else(|| least_velocity(instant.limits));
            self.select(most, instant.tasks, velocity.feedforward);
        } else {
            velocity.feedforward.fill(0.0);
            let factor = self.factor(smallest);
            let weight = |s: f64| s / (s * s + factor);
            self.rotations.apply(&self.stack.feedforward, weight, velocity.feedforward);
            self.rotations.apply(&self.stack.feedback, weight, velocity.feedback);
        }
        let criterion_rate = self.add_criteria(instant, velocity.feedforward);
        let damped = smallest < self.threshold;
        Ok(Resolution { smallest_singular_value: smallest, damped, criterion_rate, ..Resolution::default() })
    }

    fn kind(&self) -> LinearityKind {
        match self.damping {
            Damping::Selective(_) => LinearityKind::Total,
            Damping::Constant(_) | Damping::Adaptive(_) => LinearityKind::Split,
        }
    }

    fn threshold(&self) -> f64 {
        self.threshold
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        super::shape::one_priority(shape).or_else(|| self.criteria.objection(shape))
    }

    fn keeps_distances(&self) -> bool {
        self.criteria.keeps_distances()
    }

    fn criterion_rate(&self) -> Option<f64> {
        self.criteria.rate()
    }
}

/// The least velocity limit of all joints [rad/s or m/s]; one where none has any.
fn least_velocity(limits: &[Limits]) -> f64 {
    let least = limits.iter().map(|limits| limits.velocity).fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 1.0 }
}

pub(super) const KIND: LawKind = Kind::new(
    "damped",
    "Damped least squares: joint velocities stay bounded near singularities, and tasks are met as well as they allow.",
    &[
        Parameter::optional(
            "method",
            Form::OneOf(&["adaptive", "constant", "selective"]),
            "",
            "How it is damped: near singularities only, everywhere alike, or direction by direction. Default: adaptive.",
        ),
        Parameter::optional(
            "damping",
            Form::Positive { noun: "damping factor" },
            "",
            "The factor lambda of constant damping, in the unit of the singular values; of adaptive damping the largest one. Default: the threshold.",
        ),
        Parameter::optional(
            "max_velocity",
            Form::Positive { noun: "velocity" },
            "rad/s or m/s",
            "Largest joint velocity with selective damping. Default: the least velocity limit of the joints, or 1.",
        ),
        super::pseudoinverse::THRESHOLD,
    ],
    MakeLaw::WithCriteria(|given, criteria| {
        let law = Damped::new(damping(given)).with_criteria(criteria);
        Box::new(given.number("threshold").into_iter().fold(law, Damped::with_threshold))
    }),
)
.with_objection(|given| {
    let has = |name| given.get(name).is_some();
    let objection = match given.text("method").unwrap_or("adaptive") {
        "constant" if !has("damping") => Some("constant damping needs its factor `damping`"),
        "selective" if has("damping") => Some("selective damping has no factor `damping`; `max_velocity` bounds it"),
        "adaptive" | "constant" if has("max_velocity") => {
            Some("`max_velocity` is of method = \"selective\" only; `damping` is what bounds the others")
        }
        _ => None,
    };
    objection.map(str::to_owned)
});

fn damping(given: &Parameters) -> Damping {
    match given.text("method") {
        Some("constant") => Damping::Constant(given.number("damping").unwrap_or(0.0)),
        Some("selective") => Damping::Selective(given.number("max_velocity")),
        _ => Damping::Adaptive(given.number("damping")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::trial::{prepared, resolve, task};
    use super::super::{Posture, Pseudoinverse};
    use super::*;
    use nalgebra::{DMatrix, DVector, Vector6};
    use proptest::prelude::*;

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn constant_damping_is_the_regularised_inverse(
            entries in prop::collection::vec(-1.0..1.0_f64, 42), v in prop::array::uniform6(-1.0..1.0_f64), factor in 0.01..1.0_f64,
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let jacobian = DMatrix::from_fn(6, 7, |row, column| columns[column][row]);
            let gram = &jacobian * jacobian.transpose() + DMatrix::identity(6, 6) * factor * factor;
            let expected = jacobian.transpose() * gram.cholesky().unwrap().solve(&DVector::from_row_slice(&v));
            let mut law = prepared(Damped::new(Damping::Constant(factor)), 6, 7);
            let ([f, g], _) = resolve(&mut law, &[0.0; 7], &[task(6, &columns, &v, &v)]);
            prop_assert!(apart(&f, expected.as_slice()) < 1e-9 && apart(&g, expected.as_slice()) < 1e-9);
        }

        #[test]
        fn adaptive_damping_is_that_of_the_least_norm_law_unless_told_otherwise(
            entries in prop::collection::vec(-1.0..1.0_f64, 42), v in prop::array::uniform6(-1.0..1.0_f64), threshold in 0.01..2.0_f64,
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let demand = [task(6, &columns, &v, &v)];
            let posture = || Posture::new(1.0, vec![0.1; 7]);
            let damped = Damped::new(Damping::Adaptive(None)).with_threshold(threshold).with_criterion(posture());
            let plain = Pseudoinverse::new().with_threshold(threshold).with_criterion(posture());
            let ([f, g], own) = resolve(&mut prepared(damped, 6, 7), &[0.0; 7], &demand);
            let ([h, i], other) = resolve(&mut prepared(plain, 6, 7), &[0.0; 7], &demand);
            prop_assume!(own.smallest_singular_value > 1e-3);
            prop_assert!(apart(&f, &h) < 1e-7 && apart(&g, &i) < 1e-7);
            // The least-norm law decides by a bound where that suffices.
            prop_assert!(own.damped == other.damped);
        }

        #[test]
        fn selective_damping_bounds_every_joint_and_does_nothing_where_there_is_room(
            entries in prop::collection::vec(-1.0..1.0_f64, 42), v in prop::array::uniform6(-1.0..1.0_f64), most in 0.01..1.0_f64,
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let zero = [0.0; 6];
            let demand = [task(6, &columns, &v, &zero)];
            let of = |most| {
                let mut law = prepared(Damped::new(Damping::Selective(Some(most))), 6, 7);
                resolve(&mut law, &[0.0; 7], &demand).0[0].clone()
            };
            prop_assert!(of(most).iter().all(|x| x.abs() <= most * (1.0 + 1e-12)));
            let (free, plain) = (of(1e9), resolve(&mut prepared(Pseudoinverse::new(), 6, 7), &[0.0; 7], &demand));
            prop_assume!(plain.1.smallest_singular_value > 1e-2);
            prop_assert!(apart(&free, &plain.0[0]) < 1e-8);
        }
    }

    #[test]
    fn parameters_that_belong_to_another_method_are_refused() {
        let objection = |given: Parameters| (KIND.objection.unwrap())(&given);
        let given = Parameters::new;
        assert_eq!(objection(given()), None);
        assert!(objection(given().with("method", "constant")).unwrap().contains("`damping`"));
        assert!(objection(given().with("method", "selective").with("damping", 0.1)).is_some());
        assert!(objection(given().with("max_velocity", 0.1)).is_some());
    }
}
