use super::criteria_sum::CriteriaSum;
use super::damping::{DampedInverse, is_regular, threshold};
use super::fixed_rows::FixedRows;
use super::shape::one_priority;
use super::stacked::StackedRows;
use super::{
    Criteria, Criterion, Infeasible, Instant, JointVelocity, Law, LawKind, MakeLaw, Resolution, SystemShape,
};
use crate::kind::{Form, Kind, Parameter};
use crate::math::RowRotations;
use crate::task::TaskRows;

/// The least-norm law `J^+ v` for all tasks of a system at once, with null-space criteria if any are set.
///
/// While the smallest singular value of `J` is certain to lie above the threshold, `J^+ v = J^T (J J^T)^-1 v` by a
/// Cholesky factorisation of the Gram matrix. Otherwise a one-sided Jacobi decomposition decides, and below the
/// threshold `epsilon` the answer is damped, `sum v_i s_i / (s_i^2 + lambda^2) u_i`, with
/// `lambda^2 = epsilon^2 (1 - (s_min / epsilon)^2)`, which sets in continuously (Nakamura and Hanafusa 1986,
/// Chiaverini 1997). The null-space projector is never damped: it drops the directions below the threshold.
///
/// The threshold is 1e-3 of the reach of a task's tips (of at most one metre where orientation is asked for too), the largest
/// of all tasks, unless given. Tasks are met exactly where they can be, so their weights do not matter; tasks of different
/// priorities are refused.
#[derive(Default)]
pub struct Pseudoinverse {
    given_threshold: Option<f64>,
    criteria: CriteriaSum,
    threshold: f64,
    workspace: Option<Workspace>,
}

/// What a resolution needs, in the size of the system.
struct Workspace {
    gram: Gram,
    rotations: RowRotations,
    /// `phi'` and `-k e` of all tasks.
    feedforward: Vec<f64>,
    feedback: Vec<f64>,
    /// `phi' - J c`.
    corrected: Vec<f64>,
}

/// The factorisation in the size of the tasks.
enum Gram {
    Two,
    Three,
    Six,
    Stacked(StackedRows),
}

impl std::fmt::Debug for Pseudoinverse {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pseudoinverse").field("threshold", &self.threshold).finish_non_exhaustive()
    }
}

impl Pseudoinverse {
    /// The law with the default threshold and no criterion.
    pub fn new() -> Self {
        Self::default()
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

    /// The law with these criteria.
    pub(super) fn with_criteria(criteria: Criteria) -> Self {
        Self { criteria: CriteriaSum::of(criteria), ..Self::default() }
    }

    /// The sum `c` of what the criteria asked for last.
    pub(super) fn criteria_sum(&self) -> &[f64] {
        self.criteria.sum()
    }
}

impl Law for Pseudoinverse {
    fn prepare(&mut self, shape: &SystemShape) {
        self.threshold = threshold(self.given_threshold, shape);
        self.criteria.prepare(shape);
        self.workspace = Some(Workspace::new(shape));
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        let Some(workspace) = &mut self.workspace else { return Err(Infeasible::default()) };
        workspace.collect(instant.tasks);
        if self.criteria.is_empty() {
            return Ok(workspace.resolve(instant.tasks, self.threshold, None, velocity));
        }
        self.criteria.evaluate(instant);
        let c = self.criteria.sum();
        subtract_image(instant.tasks, c, &mut workspace.corrected);
        let resolution = workspace.resolve(instant.tasks, self.threshold, Some(c), velocity);
        Ok(Resolution { criterion_rate: self.criteria.rate_at(instant), ..resolution })
    }

    fn threshold(&self) -> f64 {
        self.threshold
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        one_priority(shape).or_else(|| self.criteria.objection(shape))
    }

    fn fast_path(&self) -> Option<f64> {
        self.criteria.is_empty().then_some(self.threshold)
    }

    fn keeps_distances(&self) -> bool {
        self.criteria.keeps_distances()
    }

    fn criterion_rate(&self) -> Option<f64> {
        self.criteria.rate()
    }
}

/// The parameter of laws that are damped below a threshold.
pub(super) const THRESHOLD: Parameter = Parameter::optional(
    "threshold",
    Form::Positive { noun: "threshold for singular values" },
    "",
    "Smallest singular value of the task Jacobian that is inverted undamped; below it the inverse is damped, and the report says so.",
);

pub(super) const KIND: LawKind = Kind::new(
    "pseudoinverse",
    "The joint velocity of least norm, by the pseudoinverse of the task Jacobian.",
    &[THRESHOLD],
    MakeLaw::WithCriteria(|given, criteria| {
        Box::new(Pseudoinverse {
            given_threshold: given.number("threshold"),
            ..Pseudoinverse::with_criteria(criteria)
        })
    }),
);

impl Workspace {
    fn new(shape: &SystemShape) -> Self {
        let (rows, joints) = (shape.rows(), shape.joints.len());
        Self {
            gram: match (shape.tasks.len(), rows) {
                (1, 2) => Gram::Two,
                (1, 3) => Gram::Three,
                (1, 6) => Gram::Six,
                _ => Gram::Stacked(StackedRows::new(shape)),
            },
            rotations: RowRotations::with_capacity(rows, joints),
            feedforward: vec![0.0; rows],
            feedback: vec![0.0; rows],
            corrected: vec![0.0; rows],
        }
    }

    /// Puts what all tasks ask for one after the other.
    fn collect(&mut self, tasks: &[TaskRows]) {
        let mut first = 0;
        for task in tasks {
            let rows = first..first + task.rows();
            self.feedforward[rows.clone()].copy_from_slice(&task.feedforward);
            self.feedback[rows.clone()].copy_from_slice(&task.feedback);
            first = rows.end;
        }
        self.corrected.copy_from_slice(&self.feedforward);
    }

    fn resolve(
        &mut self,
        tasks: &[TaskRows],
        threshold: f64,
        c: Option<&[f64]>,
        velocity: &mut JointVelocity<'_>,
    ) -> Resolution {
        let (bound, smallest_pivot) = self.solve(tasks, velocity);
        if is_regular(bound, smallest_pivot, threshold) {
            if let Some(c) = c {
                add(c, velocity.feedforward);
            }
            return Resolution { smallest_singular_value: bound, ..Resolution::default() };
        }
        decompose(&mut self.rotations, tasks, velocity.feedforward.len());
        let inverse = DampedInverse::new(&self.rotations, threshold);
        inverse.apply(&self.feedforward, velocity.feedforward);
        inverse.apply(&self.feedback, velocity.feedback);
        if let Some(c) = c {
            let image = &mut self.corrected;
            image.fill(0.0);
            subtract_image(tasks, c, image);
            inverse.add_undamped(image, velocity.feedforward);
            add(c, velocity.feedforward);
        }
        inverse.resolution()
    }

    /// Writes the undamped solution, and returns a lower bound of the smallest singular value and the smallest pivot: where
    /// this is not positive, neither means anything.
    fn solve(&mut self, tasks: &[TaskRows], velocity: &mut JointVelocity<'_>) -> (f64, f64) {
        let wanted = [&self.corrected[..], &self.feedback[..]];
        let (f, g) = (&mut *velocity.feedforward, &mut *velocity.feedback);
        match (&mut self.gram, tasks) {
            (Gram::Two, [task]) => FixedRows::<2>::of(task, wanted, f, g).solve(),
            (Gram::Three, [task]) => FixedRows::<3>::of(task, wanted, f, g).solve(),
            (Gram::Six, [task]) => FixedRows::<6>::of(task, wanted, f, g).solve(),
            (Gram::Stacked(stacked), _) => {
                stacked.stack(tasks);
                stacked.solve(wanted, f, g).map_or((0.0, 0.0), |bound| (bound, 1.0))
            }
            _ => (0.0, 0.0),
        }
    }
}

fn add(summand: &[f64], sum: &mut [f64]) {
    for (sum, summand) in sum.iter_mut().zip(summand) {
        *sum += summand;
    }
}

/// Subtracts `J c` from the rows of all tasks, one task after the other.
fn subtract_image(tasks: &[TaskRows], c: &[f64], rows: &mut [f64]) {
    let mut first = 0;
    for task in tasks {
        let rows = &mut rows[first..first + task.rows()];
        for (column, velocity) in task.jacobian.column_iter().zip(c) {
            for (row, entry) in rows.iter_mut().zip(column.iter()) {
                *row -= entry * velocity;
            }
        }
        first += task.rows();
    }
}

/// Decomposes the stacked Jacobian of all tasks.
fn decompose(rotations: &mut RowRotations, tasks: &[TaskRows], joints: usize) {
    rotations.compute(joints, |row, column| {
        let mut row = row;
        for task in tasks {
            if row < task.rows() {
                return task.jacobian[(row, column)];
            }
            row -= task.rows();
        }
        0.0
    });
}

#[cfg(test)]
mod tests {
    use super::super::TaskShape;
    use super::super::trial::{prepared, resolve, task};
    use super::*;
    use nalgebra::Vector6;
    use proptest::prelude::*;

    struct Homing;

    impl Criterion for Homing {
        fn velocity(&mut self, instant: &Instant<'_>, c: &mut [f64]) {
            for (c, q) in c.iter_mut().zip(instant.q) {
                *c = -2.0 * q;
            }
        }

        fn rate(&self) -> Option<f64> {
            Some(2.0)
        }
    }

    fn image(columns: &[Vector6<f64>], velocities: &[f64]) -> Vector6<f64> {
        columns.iter().zip(velocities).map(|(c, v)| c * *v).sum()
    }

    proptest! {
        #[test]
        fn the_four_conditions_of_penrose_hold_in_effect(
            entries in proptest::collection::vec(-1.0..1.0_f64, 42), q in proptest::collection::vec(-1.0..1.0_f64, 7),
            v in proptest::array::uniform6(-1.0..1.0_f64), rows in 1..=6_usize,
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let demand = [task(rows, &columns, &v, &v)];
            let v = Vector6::from(v);
            let mut law = prepared(Pseudoinverse::new(), rows, 7);
            let ([f, g], resolution) = resolve(&mut law, &q, &demand);
            prop_assume!(resolution.smallest_singular_value > 0.02);
            prop_assert_eq!(&f, &g);
            // The demand is met, and the answer has no component that the rows do not span (least norm).
            let met = image(&columns, &f);
            prop_assert!((met - v).rows(0, rows).norm() < 1e-9);
            let mut homed = prepared(Pseudoinverse::new().with_criterion(Homing), rows, 7);
            let ([h, _], resolution) = resolve(&mut homed, &q, &demand);
            prop_assert_eq!(resolution.criterion_rate, 2.0);
            prop_assert!((image(&columns, &h) - v).rows(0, rows).norm() < 1e-9, "the criterion leaves the task alone");
            let null: Vec<f64> = h.iter().zip(&f).map(|(a, b)| a - b).collect();
            let dot: f64 = null.iter().zip(&f).map(|(a, b)| a * b).sum();
            prop_assert!(dot.abs() < 1e-7, "the least-norm part is orthogonal to the null space: {dot}");
        }

        #[test]
        fn both_ways_agree_where_both_may_be_used(
            entries in proptest::collection::vec(-1.0..1.0_f64, 42), v in proptest::array::uniform6(-1.0..1.0_f64),
            rows in 4..=6_usize,
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let (demand, q) = ([task(rows, &columns, &v, &v)], [0.3; 7]);
            let mut rotations = RowRotations::with_capacity(rows, 7);
            rotations.compute(7, |row, column| columns[column][row]);
            prop_assume!(rotations.smallest() > 0.02);
            // A threshold just below the smallest singular value forces the decomposition, yet damps nothing.
            let forced = Pseudoinverse::new().with_threshold(rotations.smallest() * 0.999).with_criterion(Homing);
            let mut plain = prepared(Pseudoinverse::new().with_criterion(Homing), rows, 7);
            let ([f, _], _) = resolve(&mut plain, &q, &demand);
            let ([h, _], resolution) = resolve(&mut prepared(forced, rows, 7), &q, &demand);
            prop_assert!(!resolution.damped);
            for (a, b) in f.iter().zip(&h) {
                prop_assert!((a - b).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn damping_acts_below_the_threshold_and_bounds_the_velocity() {
        let column = |x: f64, y: f64| Vector6::new(x, y, 0.0, 0.0, 0.0, 0.0);
        let v = [0.0, 1.0];
        let mut law = prepared(Pseudoinverse::new().with_threshold(0.1), 2, 2);
        for tilt in [0.0, 1e-9, 1e-3, 0.05] {
            let demand = [task(2, &[column(1.0, 0.0), column(1.0, tilt)], &v, &v)];
            let ([f, _], resolution) = resolve(&mut law, &[0.0; 2], &demand);
            assert!(resolution.damped && resolution.smallest_singular_value < 0.1);
            assert!(f.iter().all(|x| x.abs() <= 1.0 / 0.1), "{f:?}");
        }
    }

    /// Two tasks of six rows; the first `shared` columns move both, then six move the first and seven the second.
    fn stacked(entries: &[f64], shared: usize, [v, w]: [&[f64]; 2]) -> (SystemShape, Vec<TaskRows>) {
        let joints = shared + 13;
        let moved = [
            (0..shared + 6).collect::<Vec<usize>>(),
            (0..shared).chain(shared + 6..joints).collect::<Vec<usize>>(),
        ];
        let mut shape = SystemShape::of_one_task(6, joints, 1.0);
        let alike = shape.tasks[0].clone();
        shape.tasks =
            moved.iter().map(|joints| TaskShape { joints: joints.clone(), ..alike.clone() }).collect();
        let rows = moved.iter().enumerate().map(|(which, moved)| {
            let mut rows = TaskRows::zeros(6, joints);
            for &joint in moved {
                rows.jacobian.column_mut(joint).copy_from_slice(&entries[12 * joint + 6 * which..][..6]);
            }
            rows.feedforward.copy_from_slice(&v[6 * which..][..6]);
            rows.feedback.copy_from_slice(&w[6 * which..][..6]);
            rows
        });
        (shape, rows.collect())
    }

    fn image_of_all(tasks: &[TaskRows], velocity: &[f64]) -> Vec<f64> {
        let velocity = nalgebra::DVector::from_column_slice(velocity);
        tasks
            .iter()
            .flat_map(|task| (&task.jacobian * &velocity).iter().copied().collect::<Vec<f64>>())
            .collect()
    }

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    fn with_threshold(threshold: f64, shape: &SystemShape) -> Pseudoinverse {
        let mut law = Pseudoinverse::new().with_threshold(threshold);
        law.prepare(shape);
        law
    }

    proptest! {
        #[test]
        fn the_answer_meets_all_tasks_and_has_the_least_norm(
            entries in prop::collection::vec(-1.0..1.0_f64, 12 * 15), v in prop::collection::vec(-1.0..1.0_f64, 12),
            w in prop::collection::vec(-1.0..1.0_f64, 12), other in prop::collection::vec(-1.0..1.0_f64, 15),
        ) {
            let (shape, tasks) = stacked(&entries, 2, [&v, &w]);
            let (mut law, q) = (with_threshold(1e-3, &shape), [0.0; 15]);
            let ([f, g], resolution) = resolve(&mut law, &q, &tasks);
            prop_assume!(resolution.smallest_singular_value > 0.02);
            prop_assert!(apart(&image_of_all(&tasks, &f), &v) < 1e-10 && apart(&image_of_all(&tasks, &g), &w) < 1e-10);
            // The part of any motion that no task sees is at right angles to the answer.
            let moved = image_of_all(&tasks, &other);
            let ([seen, _], _) = resolve(&mut law, &q, &stacked(&entries, 2, [&moved, &v]).1);
            let dot: f64 = f.iter().zip(other.iter().zip(&seen)).map(|(f, (o, s))| f * (o - s)).sum();
            prop_assert!(dot.abs() < 1e-9, "{dot}");
            // Rotations of the rows give the same answer.
            let mut forced = with_threshold(resolution.smallest_singular_value, &shape);
            let ([slow, back], exact) = resolve(&mut forced, &q, &tasks);
            prop_assert!(!exact.damped && apart(&slow, &f) < 1e-9 && apart(&back, &g) < 1e-9);
            let (bound, exact) = (resolution.smallest_singular_value, exact.smallest_singular_value);
            prop_assert!(bound <= exact * (1.0 + 1e-6) && exact <= bound * 12.0_f64.sqrt() * (1.0 + 1e-6));
        }

        #[test]
        fn tasks_that_share_nothing_are_resolved_as_if_alone(
            entries in prop::collection::vec(-1.0..1.0_f64, 12 * 13), v in prop::collection::vec(-1.0..1.0_f64, 12),
        ) {
            let (shape, tasks) = stacked(&entries, 0, [&v, &v]);
            let ([f, g], resolution) = resolve(&mut with_threshold(1e-3, &shape), &[0.0; 13], &tasks);
            prop_assume!(resolution.smallest_singular_value > 0.02);
            let mut alone = Vec::new();
            for (which, joints) in [(0, 0..6), (1, 6..13)] {
                let own = |i: usize| Vector6::from_column_slice(&entries[12 * i + 6 * which..][..6]);
                let (columns, velocity): (Vec<_>, _) = (joints.map(own).collect(), &v[6 * which..]);
                let mut law = prepared(Pseudoinverse::new().with_threshold(1e-3), 6, columns.len());
                let demand = [task(6, &columns, velocity, velocity)];
                alone.extend(resolve(&mut law, &vec![0.0; columns.len()], &demand).0[0].clone());
            }
            prop_assert!(apart(&f, &alone) < 1e-10 && f == g);
        }
    }

    #[test]
    fn tasks_that_contradict_each_other_are_damped_and_bounded() {
        // Two tasks of one row, and joints that move them as these columns say.
        let asked = |columns: &[[f64; 2]], v: [f64; 2], w: [f64; 2]| {
            let mut shape = SystemShape::of_one_task(1, columns.len(), 1.0);
            shape.tasks.push(shape.tasks[0].clone());
            let row = |which: usize| {
                let columns: Vec<_> =
                    columns.iter().map(|c| Vector6::new(c[which], 0.0, 0.0, 0.0, 0.0, 0.0)).collect();
                task(1, &columns, &[v[which]], &[w[which]])
            };
            resolve(&mut with_threshold(0.1, &shape), &vec![0.0; columns.len()], &[row(0), row(1)])
        };
        let ([f, g], resolution) = asked(&[[1.0, 1.0]], [1.0, -1.0], [1.0, 1.0]);
        assert!(!resolution.damped && (resolution.smallest_singular_value - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!(f[0].abs() < 1e-15 && (g[0] - 1.0).abs() < 1e-15, "the best that one joint can do");
        // Two joints that come ever nearer to being one.
        for tilt in [0.0, 1e-9, 1e-3, 0.05] {
            let ([f, g], resolution) = asked(&[[1.0, 1.0], [1.0, 1.0 + tilt]], [0.0, 1.0], [1.0, 0.0]);
            assert!(resolution.damped && f.iter().chain(&g).all(|x| x.abs() <= 1.0 / 0.1), "{f:?} {g:?}");
        }
    }

    #[test]
    fn tasks_of_different_priorities_are_refused() {
        let mut shape = SystemShape::of_one_task(2, 4, 1.0);
        shape.tasks.push(TaskShape { name: "second".to_owned(), priority: 1, ..shape.tasks[0].clone() });
        let objection = Pseudoinverse::new().objection(&shape).unwrap();
        assert!(objection.contains("`second` has priority 1"), "{objection}");
        assert_eq!(Pseudoinverse::new().objection(&SystemShape::of_one_task(2, 4, 1.0)), None);
    }
}
