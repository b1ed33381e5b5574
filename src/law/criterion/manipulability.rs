use super::super::{Instant, SystemShape};
use super::{Criterion, CriterionKind, MakeCriterion};
use crate::kind::{Form, Kind, Parameter, Parameters};
use crate::task::Tip;
use nalgebra::{Matrix6, Vector6};

/// Moves joints away from singular configurations: the steepest ascent of the logarithm of the manipulability
/// `w = sqrt(det(J J^T))` (Yoshikawa 1985), `c = rate grad ln w`.
///
/// `J` has the components of the tip's twist that the tip's own tasks ask for, in world axes; the logarithms of several tips
/// add up. The gradient is exact: `d ln w / dq_i = sum_j ((J J^T)^-1 J_j) . dJ_j/dq_i`, with the derivatives of the columns
/// from the axes themselves ([`MovingAxis`](crate::robot::MovingAxis)). Where `J J^T` is not definite there is no gradient,
/// and the joints are left alone.
///
/// ```
/// use kinstep::law::{Manipulability, Pseudoinverse};
///
/// let law = Pseudoinverse::new().with_criterion(Manipulability::new(1.0));
/// # let _ = law;
/// ```
#[derive(Clone, Debug, Default)]
pub struct Manipulability {
    rate: f64,
    /// For each tip which of the six components count.
    counts: Vec<[bool; 6]>,
    /// Of one tip, by its columns, `y_j = (J J^T)^-1 J_j`.
    dual: Vec<Vector6<f64>>,
    /// The changes of the twists of the axes, of the columns and of the `y_j` when one joint moves.
    axes_moved: Vec<Vector6<f64>>,
    columns_moved: Vec<Vector6<f64>>,
    dual_moved: Vec<Vector6<f64>>,
    /// One row of the second derivative.
    row: Vec<f64>,
    /// A bound of the eigenvalues of `dc/dq` at the instant that was met last [1/s].
    bound: f64,
}

impl Manipulability {
    /// The ascent at `rate` [1/s]: the joint velocity [rad/s] where `ln w` grows by one per radian.
    pub fn new(rate: f64) -> Self {
        Self { rate, ..Self::default() }
    }

    /// Writes `y_j` for every column of a tip, and returns `(J J^T)^-1`, if there is one.
    fn invert(&mut self, tip: &Tip, counts: [bool; 6]) -> Option<Matrix6<f64>> {
        let mut gram = Matrix6::zeros();
        for column in &tip.jacobian {
            let column = masked(column, counts);
            gram += column * column.transpose();
        }
        for (component, counts) in counts.into_iter().enumerate() {
            gram[(component, component)] += if counts { 0.0 } else { 1.0 };
        }
        let inverse = gram.cholesky()?.inverse();
        for (dual, column) in self.dual.iter_mut().zip(&tip.jacobian) {
            *dual = inverse * masked(column, counts);
        }
        Some(inverse)
    }

    /// Adds `rate grad ln w` of a tip.
    fn ascend(&self, tip: &Tip, c: &mut [f64]) {
        for (a, axis) in tip.axes.iter().enumerate() {
            let along = |(b, moved): (usize, &crate::robot::MovingAxis)| {
                self.dual[moved.joint].dot(&derivative((a, &axis.twist), (b, &moved.twist)))
            };
            c[tip.joints[axis.joint]] += self.rate * tip.axes.iter().enumerate().map(along).sum::<f64>();
        }
    }

    /// The largest sum of the moduli of a row of the second derivative of `ln w`, which no eigenvalue exceeds.
    fn curvature(&mut self, tip: &Tip, counts: [bool; 6], inverse: &Matrix6<f64>) -> f64 {
        let mut most = 0.0_f64;
        for joint in 0..tip.jacobian.len() {
            self.move_joint(tip, joint);
            self.move_dual(tip, counts, inverse);
            self.write_row(tip);
            most = most.max(self.row[..tip.jacobian.len()].iter().map(|entry| entry.abs()).sum());
        }
        most
    }

    /// What the motion of a joint does to all axes and columns.
    fn move_joint(&mut self, tip: &Tip, joint: usize) {
        self.columns_moved.fill(Vector6::zeros());
        for (b, moved) in tip.axes.iter().enumerate() {
            let own = tip.axes.iter().enumerate().filter(|(_, axis)| axis.joint == joint);
            let change: Vector6<f64> =
                own.map(|(a, axis)| derivative((a, &axis.twist), (b, &moved.twist))).sum();
            self.axes_moved[b] = change;
            self.columns_moved[moved.joint] += change;
        }
    }

    /// `dy_j = (J J^T)^-1 (dJ_j - (dJ J^T + J dJ^T) y_j)`.
    fn move_dual(&mut self, tip: &Tip, counts: [bool; 6], inverse: &Matrix6<f64>) {
        let mut gram = Matrix6::zeros();
        for (column, moved) in tip.jacobian.iter().zip(&self.columns_moved) {
            let product = masked(moved, counts) * masked(column, counts).transpose();
            gram += product + product.transpose();
        }
        let all = self.dual_moved.iter_mut().zip(&self.dual).zip(&self.columns_moved);
        for ((dual_moved, dual), moved) in all {
            *dual_moved = inverse * (masked(moved, counts) - gram * dual);
        }
    }

    fn write_row(&mut self, tip: &Tip) {
        self.row.fill(0.0);
        for (a, axis) in tip.axes.iter().enumerate() {
            for (b, moved) in tip.axes.iter().enumerate() {
                let first = derivative((a, &axis.twist), (b, &moved.twist));
                let second = derivative((a, &self.axes_moved[a]), (b, &moved.twist))
                    + derivative((a, &axis.twist), (b, &self.axes_moved[b]));
                self.row[axis.joint] +=
                    self.dual_moved[moved.joint].dot(&first) + self.dual[moved.joint].dot(&second);
            }
        }
    }
}

/// The components that count.
fn masked(column: &Vector6<f64>, counts: [bool; 6]) -> Vector6<f64> {
    Vector6::from_fn(|component, _| if counts[component] { column[component] } else { 0.0 })
}

/// How the twist of axis `b` changes per unit of the motion of axis `a`, each with its place from the base to the tip:
/// `(w_a x v_b; w_a x w_b)` if `a` comes before `b`, else `(w_b x v_a; 0)`. It is linear in both.
fn derivative((a, twist_a): (usize, &Vector6<f64>), (b, twist_b): (usize, &Vector6<f64>)) -> Vector6<f64> {
    let (linear, angular) = (
        |twist: &Vector6<f64>| twist.fixed_rows::<3>(0).into_owned(),
        |twist: &Vector6<f64>| twist.fixed_rows::<3>(3).into_owned(),
    );
    let mut change = Vector6::zeros();
    if a < b {
        change.fixed_rows_mut::<3>(0).copy_from(&angular(twist_a).cross(&linear(twist_b)));
        change.fixed_rows_mut::<3>(3).copy_from(&angular(twist_a).cross(&angular(twist_b)));
    } else {
        change.fixed_rows_mut::<3>(0).copy_from(&angular(twist_b).cross(&linear(twist_a)));
    }
    change
}

impl Criterion for Manipulability {
    fn prepare(&mut self, shape: &SystemShape) {
        self.counts = vec![[false; 6]; shape.axes.len()];
        for task in shape.tasks.iter().filter(|task| task.tips.len() == 1) {
            for component in &task.components {
                self.counts[task.tips[0]][component.place()] = true;
            }
        }
        let axes = shape.axes.iter().copied().max().unwrap_or(0);
        for buffer in [&mut self.dual, &mut self.axes_moved, &mut self.columns_moved, &mut self.dual_moved] {
            *buffer = vec![Vector6::zeros(); axes];
        }
        self.row = vec![0.0; axes];
    }

    fn velocity(&mut self, instant: &Instant<'_>, c: &mut [f64]) {
        c.fill(0.0);
        self.bound = 0.0;
        for (place, tip) in instant.tips.iter().enumerate() {
            let counts = self.counts[place];
            if let Some(inverse) = self.invert(tip, counts) {
                self.ascend(tip, c);
                self.bound += self.rate * self.curvature(tip, counts, &inverse);
            }
        }
    }

    fn rate(&self) -> Option<f64> {
        None
    }

    /// A bound of the eigenvalues of `dc/dq`, which grows without bound towards a singularity.
    fn rate_at(&self, _instant: &Instant<'_>) -> f64 {
        self.bound
    }
}

pub(super) const KIND: CriterionKind = Kind::new(
    "manipulability",
    "Moves the joints away from singular configurations: c = rate grad ln sqrt(det(J J^T)).",
    &[Parameter::required(
        "rate",
        Form::Positive { noun: "rate" },
        "1/s",
        "Rate of the ascent: the joint velocity where ln w grows by one per radian.",
    )],
    make as MakeCriterion,
)
.with_draw(|_, whole| Parameters::new().with("rate", f64::from(whole(1, 4)) * 0.1));

fn make(given: &Parameters, _start: &[f64]) -> Box<dyn Criterion> {
    Box::new(Manipulability::new(given.number("rate").unwrap_or(0.0)))
}

#[cfg(test)]
mod tests {
    use super::super::super::TaskShape;
    use super::*;
    use crate::robot::{Chain, Limits, MovingAxis, Robot, embedded};
    use crate::task::Component;
    use nalgebra::DMatrix;
    use proptest::prelude::*;

    /// An arm whose third joint makes another one follow it, across the second.
    const FOLLOWING: &str = r#"<robot name="f"><link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/><link name="l4"/>
<joint name="a" type="revolute"><parent link="l0"/><child link="l1"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="b" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0.3 0 0.1" rpy="0.3 0.4 0"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="c" type="prismatic"><parent link="l2"/><child link="l3"/><origin xyz="0.2 0.1 0"/><axis xyz="1 0 0"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<joint name="d" type="revolute"><parent link="l3"/><child link="l4"/><origin xyz="0.2 0 0.2"/><axis xyz="1 0 1"/><mimic joint="a" multiplier="-0.7"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
<link name="tip"/><joint name="e" type="fixed"><parent link="l4"/><child link="tip"/><origin xyz="0.1 0.3 0.1"/></joint></robot>"#;

    fn chains() -> Vec<(Chain, usize)> {
        let following = Robot::from_urdf(FOLLOWING).unwrap();
        let panda = embedded::get("panda").unwrap();
        vec![
            (following.chain("l0", "tip").unwrap(), 2),
            (panda.chain("panda_link0", "panda_link8").unwrap(), 6),
            (panda.chain("panda_link0", "panda_link8").unwrap(), 3),
        ]
    }

    fn tip(chain: &Chain, q: &[f64]) -> Tip {
        let mut scratch = chain.scratch();
        let posed = chain.forward(q, &mut scratch);
        let mut axes = vec![MovingAxis::default(); chain.moving_axes()];
        let mut jacobian = vec![Vector6::zeros(); chain.dof()];
        posed.axes(&mut axes);
        posed.geometric_jacobian(&mut jacobian);
        Tip { pose: posed.pose(), jacobian, axes, joints: (0..chain.dof()).collect() }
    }

    fn velocity(chain: &Chain, rows: usize, q: &[f64]) -> (Vec<f64>, f64) {
        let mut criterion = Manipulability::new(1.0);
        let tips = [tip(chain, q)];
        let mut shape = SystemShape::of_one_task(rows, chain.dof(), 1.0);
        shape.axes = vec![chain.moving_axes()];
        shape.tasks[0] = TaskShape { components: Component::ALL[..rows].to_vec(), ..shape.tasks[0].clone() };
        criterion.prepare(&shape);
        let (rest, limits) = (vec![0.0; q.len()], vec![Limits::UNLIMITED; q.len()]);
        let mut c = vec![f64::NAN; q.len()];
        let instant = Instant {
            t: 0.0,
            sigma: 0.01,
            is_sample: true,
            q,
            previous_velocity: &rest,
            limits: &limits,
            tasks: &[],
            tips: &tips,
            next: None,
            avoidance: None,
        };
        criterion.velocity(&instant, &mut c);
        (c, criterion.rate_at(&instant))
    }

    /// `ln w`, by a determinant.
    fn logarithm(chain: &Chain, rows: usize, q: &[f64]) -> f64 {
        let columns = tip(chain, q).jacobian;
        let jacobian = DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row]);
        (&jacobian * jacobian.transpose()).determinant().ln() / 2.0
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn it_is_the_gradient_of_the_logarithm_and_its_rate_is_bounded(
            q in proptest::array::uniform7(-2.0..2.0_f64), step in Just(1e-5),
        ) {
            for (chain, rows) in chains() {
                let q = &q[..chain.dof()];
                prop_assume!(logarithm(&chain, rows, q) > -5.0);
                let (c, bound) = velocity(&chain, rows, q);
                let mut second = DMatrix::zeros(q.len(), q.len());
                for joint in 0..q.len() {
                    let moved = |by: f64| {
                        let mut q = q.to_vec();
                        q[joint] += by;
                        q
                    };
                    let (ahead, behind) = (moved(step), moved(-step));
                    let difference = logarithm(&chain, rows, &ahead) - logarithm(&chain, rows, &behind);
                    prop_assert!((difference / (2.0 * step) - c[joint]).abs() < 1e-6 * (1.0 + bound));
                    let pairs = velocity(&chain, rows, &ahead).0.into_iter().zip(velocity(&chain, rows, &behind).0);
                    for (row, (ahead, behind)) in pairs.enumerate() {
                        second[(row, joint)] = (ahead - behind) / (2.0 * step);
                    }
                }
                let largest = second.complex_eigenvalues().iter().map(|value| value.norm()).fold(0.0, f64::max);
                prop_assert!(largest <= bound * (1.0 + 1e-6), "{largest} {bound}");
                prop_assert!(bound <= largest * (q.len() as f64).sqrt() * (1.0 + 1e-6), "{largest} {bound}");
            }
        }
    }

    #[test]
    fn where_there_is_no_gradient_joints_are_left_alone() {
        let chain = embedded::get("planar4").unwrap().chain("base", "tip").unwrap();
        let (c, bound) = velocity(&chain, 3, &[0.1, 0.2, 0.3, 0.4]);
        assert_eq!((c, bound), (vec![0.0; 4], 0.0));
    }
}
