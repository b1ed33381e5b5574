use crate::math::Rational;
use crate::math::Scalar;

/// An explicit Runge-Kutta tableau, used to start multistep rows.
///
/// `k_i = f(t + c_i sigma, x + sigma sum_{j<i} a_ij k_j)`, `x_next = x + sigma sum_i b_i k_i`.
#[derive(Clone, Debug, PartialEq)]
pub struct Tableau<T> {
    /// Row `i` holds `a_ij` for `j < i`; the first row is empty.
    pub a: Vec<Vec<T>>,
    /// The weights of the stages.
    pub b: Vec<T>,
    /// The abscissas `c_i`, each the sum of its row.
    pub c: Vec<T>,
}

impl<T: Scalar> Tableau<T> {
    fn new(a: Vec<Vec<T>>, b: Vec<T>) -> Self {
        let c = a.iter().map(|row| row.iter().fold(T::zero(), |sum, &entry| sum + entry)).collect();
        Self { a, b, c }
    }

    /// Number of stages.
    pub fn stages(&self) -> usize {
        self.b.len()
    }

    /// The classical method of order 4 (Kutta 1901).
    pub fn rk4() -> Self {
        let q = |n: i64, d: i64| T::from_rational(&Rational::new(n.into(), d.into()));
        let o = T::zero;
        Self::new(
            vec![vec![], vec![q(1, 2)], vec![o(), q(1, 2)], vec![o(), o(), T::one()]],
            vec![q(1, 6), q(1, 3), q(1, 3), q(1, 6)],
        )
    }

    /// The eleven-stage method of order 8 of Cooper and Verner (SIAM J. Numer. Anal. 9, 1972), whose coefficients
    /// lie in Q(sqrt 21) and are therefore as exact as the scalar.
    pub fn rk8() -> Self {
        let root = T::from_index(21).sqrt();
        // (n + m sqrt 21) / d
        let q = |n: i64, m: i64, d: i64| {
            T::from_rational(&Rational::new(n.into(), d.into()))
                + root * T::from_rational(&Rational::new(m.into(), d.into()))
        };
        let o = T::zero;
        let a = vec![
            vec![],
            vec![q(1, 0, 2)],
            vec![q(1, 0, 4), q(1, 0, 4)],
            vec![q(1, 0, 7), q(-7, -3, 98), q(21, 5, 49)],
            vec![q(11, 1, 84), o(), q(18, 4, 63), q(21, -1, 252)],
            vec![q(5, 1, 48), o(), q(9, 1, 36), q(-231, 14, 360), q(63, -7, 80)],
            vec![q(10, -1, 42), o(), q(-432, 92, 315), q(633, -145, 90), q(-504, 115, 70), q(63, -13, 35)],
            vec![q(1, 0, 14), o(), o(), o(), q(14, -3, 126), q(13, -3, 63), q(1, 0, 9)],
            vec![
                q(1, 0, 32),
                o(),
                o(),
                o(),
                q(91, -21, 576),
                q(11, 0, 72),
                q(-385, -75, 1152),
                q(63, 13, 128),
            ],
            vec![
                q(1, 0, 14),
                o(),
                o(),
                o(),
                q(1, 0, 9),
                q(-733, -147, 2205),
                q(515, 111, 504),
                q(-51, -11, 56),
                q(132, 28, 245),
            ],
            vec![
                o(),
                o(),
                o(),
                o(),
                q(-42, 7, 18),
                q(-18, 28, 45),
                q(-273, -53, 72),
                q(301, 53, 72),
                q(28, -28, 45),
                q(49, -7, 18),
            ],
        ];
        let mut b = vec![q(1, 0, 20), o(), o(), o(), o(), o(), o()];
        b.extend([q(49, 0, 180), q(16, 0, 45), q(49, 0, 180), q(1, 0, 20)]);
        Self::new(a, b)
    }
}
