use super::least_norm::least_norm;
use super::{Criterion, Demand, Law, Resolution};
use crate::math::{Kernel, Lane, Lanes, SingularValues, level, with_instructions};
use fearless_simd::Simd;
use nalgebra::Vector6;

/// The default threshold, as a fraction of the length scale of the chain.
const RELATIVE_THRESHOLD: f64 = 1e-3;

/// The least-norm law `J^+ v`, with a null-space criterion if one is set.
///
/// While the smallest singular value of `J` is certain to lie above the threshold, `J^+ v = J^T (J J^T)^-1 v` by a
/// Cholesky factorisation of the Gram matrix. Otherwise a one-sided Jacobi decomposition decides, and below the
/// threshold `epsilon` the answer is damped, `sum v_i s_i / (s_i^2 + lambda^2) u_i`, with
/// `lambda^2 = epsilon^2 (1 - (s_min / epsilon)^2)`, which sets in continuously (Nakamura and Hanafusa 1986,
/// Chiaverini 1997). The null-space projector is never damped: it drops the directions below the threshold.
///
/// The threshold is 1e-3 of the chain's reach (of at most one metre where orientation is asked for too), unless given.
#[derive(Default)]
pub struct Pseudoinverse {
    given_threshold: Option<f64>,
    criterion: Option<Box<dyn Criterion>>,
    threshold: f64,
    c: Vec<f64>,
    decomposition: Option<Decomposition>,
}

/// The decomposition's workspace in the size of the task.
#[derive(Debug)]
enum Decomposition {
    Two(SingularValues<2>),
    Three(SingularValues<3>),
    Six(SingularValues<6>),
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

    /// The same with a criterion for the null space.
    #[must_use]
    pub fn with_criterion(mut self, criterion: impl Criterion + 'static) -> Self {
        self.criterion = Some(Box::new(criterion));
        self
    }

    fn resolve_rows<const M: usize>(
        &mut self,
        demand: &Demand<'_>,
        pick: impl Fn(&mut Decomposition) -> Option<&mut SingularValues<M>>,
        f: &mut [f64],
        g: &mut [f64],
    ) -> Resolution {
        if let Some(criterion) = &self.criterion {
            criterion.velocity(demand.q, &mut self.c);
        }
        let homogeneous = self.criterion.is_some().then_some(&self.c[..]);
        let regular = Regular::<M> { demand, homogeneous, f: &mut *f, g: &mut *g };
        let (bound, is_definite) = with_instructions(level(), regular);
        if is_definite && bound > self.threshold {
            return Resolution { smallest_singular_value: bound, damped: false };
        }
        let Some(decomposition) = self.decomposition.as_mut().and_then(pick) else {
            return Resolution { smallest_singular_value: 0.0, damped: true };
        };
        decomposition.compute(demand.jacobian);
        resolve_near_singular(decomposition, self.threshold, demand, homogeneous, f, g)
    }
}

impl Law for Pseudoinverse {
    fn prepare(&mut self, rows: usize, joints: usize, length: f64) {
        let length = if rows == 6 { length.min(1.0) } else { length };
        self.threshold = self.given_threshold.unwrap_or(RELATIVE_THRESHOLD * length);
        self.c = vec![0.0; joints];
        self.decomposition = Some(match rows {
            2 => Decomposition::Two(SingularValues::with_capacity(joints)),
            3 => Decomposition::Three(SingularValues::with_capacity(joints)),
            _ => Decomposition::Six(SingularValues::with_capacity(joints)),
        });
    }

    fn resolve(&mut self, demand: &Demand<'_>, feedforward: &mut [f64], feedback: &mut [f64]) -> Resolution {
        match demand.rows {
            2 => self.resolve_rows::<2>(
                demand,
                |d| if let Decomposition::Two(s) = d { Some(s) } else { None },
                feedforward,
                feedback,
            ),
            3 => self.resolve_rows::<3>(
                demand,
                |d| if let Decomposition::Three(s) = d { Some(s) } else { None },
                feedforward,
                feedback,
            ),
            _ => self.resolve_rows::<6>(
                demand,
                |d| if let Decomposition::Six(s) = d { Some(s) } else { None },
                feedforward,
                feedback,
            ),
        }
    }

    fn threshold(&self) -> f64 {
        self.threshold
    }

    fn least_norm_threshold(&self) -> Option<f64> {
        self.criterion.is_none().then_some(self.threshold)
    }

    fn criterion_rate(&self) -> Option<f64> {
        self.criterion.as_ref().map(|criterion| criterion.rate())
    }
}

/// `f = c + J^T (J J^T)^-1 (phi' - J c)` and `g = J^T (J J^T)^-1 (-k e)`.
struct Regular<'a, const M: usize> {
    demand: &'a Demand<'a>,
    homogeneous: Option<&'a [f64]>,
    f: &'a mut [f64],
    g: &'a mut [f64],
}

impl<const M: usize> Kernel for Regular<'_, M> {
    /// The bound of the smallest singular value, and whether any of this means something.
    type Output = (f64, bool);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> (f64, bool) {
        let Self { demand, homogeneous, f, g } = self;
        let jacobian = demand.jacobian;
        let mut wanted = head::<M>(demand.feedforward);
        if let Some(c) = homogeneous {
            subtract_image(jacobian, c, &mut wanted);
        }
        let lanes = |velocity: [f64; M]| velocity.map(|entry| Lane::splat(simd, entry));
        let found = least_norm(
            simd,
            jacobian,
            #[inline(always)]
            |column, row| Lane::splat(simd, column[row]),
            #[inline(always)]
            || [lanes(wanted), lanes(head::<M>(demand.feedback))],
            #[inline(always)]
            |column, forward: Lane<S>, back: Lane<S>| {
                f[column] = homogeneous.map_or(forward.value, |c| c[column] + forward.value);
                g[column] = back.value;
            },
        );
        (found.bound.value, found.smallest_pivot.value > 0.0)
    }
}

fn resolve_near_singular<const M: usize>(
    decomposition: &SingularValues<M>,
    threshold: f64,
    demand: &Demand<'_>,
    homogeneous: Option<&[f64]>,
    f: &mut [f64],
    g: &mut [f64],
) -> Resolution {
    let smallest = decomposition.smallest();
    let damping = (threshold * threshold - smallest * smallest).max(0.0);
    let damped = |s: f64| s / (s * s + damping);
    f.fill(0.0);
    g.fill(0.0);
    decomposition.apply(&head::<M>(demand.feedforward), damped, f);
    decomposition.apply(&head::<M>(demand.feedback), damped, g);
    if let Some(c) = homogeneous {
        let mut image = [0.0; M];
        subtract_image(demand.jacobian, c, &mut image);
        decomposition.apply(&image, |s| if s < threshold { 0.0 } else { s.recip() }, f);
        for (entry, c) in f.iter_mut().zip(c) {
            *entry += c;
        }
    }
    Resolution { smallest_singular_value: smallest, damped: damping > 0.0 }
}

fn head<const M: usize>(v: &Vector6<f64>) -> [f64; M] {
    std::array::from_fn(|i| v[i])
}

/// Subtracts the first `M` rows of `J c` from `v`.
fn subtract_image<const M: usize>(jacobian: &[Vector6<f64>], c: &[f64], v: &mut [f64; M]) {
    for (column, &velocity) in jacobian.iter().zip(c) {
        for row in 0..M {
            v[row] -= column[row] * velocity;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    struct Homing;

    impl Criterion for Homing {
        fn velocity(&self, q: &[f64], c: &mut [f64]) {
            for (c, q) in c.iter_mut().zip(q) {
                *c = -2.0 * q;
            }
        }

        fn rate(&self) -> f64 {
            2.0
        }
    }

    fn prepared(law: Pseudoinverse, rows: usize, joints: usize) -> Pseudoinverse {
        let mut law = law;
        law.prepare(rows, joints, 1.0);
        law
    }

    fn image(columns: &[Vector6<f64>], velocities: &[f64]) -> Vector6<f64> {
        columns.iter().zip(velocities).map(|(c, v)| c * *v).sum()
    }

    fn demand<'a>(columns: &'a [Vector6<f64>], q: &'a [f64], v: &'a Vector6<f64>, rows: usize) -> Demand<'a> {
        Demand { rows, jacobian: columns, q, feedforward: v, feedback: v }
    }

    proptest! {
        #[test]
        fn the_four_conditions_of_penrose_hold_in_effect(
            entries in proptest::collection::vec(-1.0..1.0_f64, 42), q in proptest::collection::vec(-1.0..1.0_f64, 7),
            v in proptest::array::uniform6(-1.0..1.0_f64), rows in prop::sample::select(vec![2_usize, 3, 6]),
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let v = Vector6::from(v);
            let (mut f, mut g) = (vec![0.0; 7], vec![0.0; 7]);
            let mut law = prepared(Pseudoinverse::new(), rows, 7);
            let resolution = law.resolve(&demand(&columns, &q, &v, rows), &mut f, &mut g);
            prop_assume!(resolution.smallest_singular_value > 0.02);
            prop_assert_eq!(&f, &g);
            // The demand is met, and the answer has no component that the rows do not span (least norm).
            let met = image(&columns, &f);
            prop_assert!((met - v).rows(0, rows).norm() < 1e-9);
            let mut homed = prepared(Pseudoinverse::new().with_criterion(Homing), rows, 7);
            let mut h = vec![0.0; 7];
            homed.resolve(&demand(&columns, &q, &v, rows), &mut h, &mut g);
            prop_assert!((image(&columns, &h) - v).rows(0, rows).norm() < 1e-9, "the criterion leaves the task alone");
            let null: Vec<f64> = h.iter().zip(&f).map(|(a, b)| a - b).collect();
            let dot: f64 = null.iter().zip(&f).map(|(a, b)| a * b).sum();
            prop_assert!(dot.abs() < 1e-7, "the least-norm part is orthogonal to the null space: {dot}");
        }

        #[test]
        fn both_ways_agree_where_both_may_be_used(
            entries in proptest::collection::vec(-1.0..1.0_f64, 42), v in proptest::array::uniform6(-1.0..1.0_f64),
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let (v, q) = (Vector6::from(v), [0.3; 7]);
            let smallest = SingularValues::<6>::of(&columns).smallest();
            prop_assume!(smallest > 0.02);
            let (mut f, mut g, mut h) = (vec![0.0; 7], vec![0.0; 7], vec![0.0; 7]);
            // A threshold just below the smallest singular value forces the decomposition, yet damps nothing.
            let forced = Pseudoinverse::new().with_threshold(smallest * 0.999).with_criterion(Homing);
            let mut plain = prepared(Pseudoinverse::new().with_criterion(Homing), 6, 7);
            plain.resolve(&demand(&columns, &q, &v, 6), &mut f, &mut g);
            let resolution = prepared(forced, 6, 7).resolve(&demand(&columns, &q, &v, 6), &mut h, &mut g);
            prop_assert!(!resolution.damped);
            for (a, b) in f.iter().zip(&h) {
                prop_assert!((a - b).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn damping_acts_below_the_threshold_and_bounds_the_velocity() {
        let column = |x: f64, y: f64| Vector6::new(x, y, 0.0, 0.0, 0.0, 0.0);
        let v = Vector6::new(0.0, 1.0, 0.0, 0.0, 0.0, 0.0);
        let mut law = prepared(Pseudoinverse::new().with_threshold(0.1), 2, 2);
        let (mut f, mut g) = ([0.0; 2], [0.0; 2]);
        for tilt in [0.0, 1e-9, 1e-3, 0.05] {
            let resolution = law.resolve(
                &demand(&[column(1.0, 0.0), column(1.0, tilt)], &[0.0; 2], &v, 2),
                &mut f,
                &mut g,
            );
            assert!(resolution.damped && resolution.smallest_singular_value < 0.1);
            assert!(f.iter().all(|x| x.abs() <= 1.0 / 0.1), "{f:?}");
        }
    }
}
