use crate::math::Scalar;

/// More differences than any family has.
pub(super) const MOST: usize = 16;

/// Modified divided differences of a vector at the times `t_n, t_{n-1}, ...` of the last steps, and the coefficients of the step to
/// `t_{n+1} = t_n + h`.
///
/// With `psi_i(n) = t_n - t_{n-i}` they are `phi_i(n) = psi_1(n) ... psi_{i-1}(n) y[t_n, ..., t_{n-i+1}]`, i = 1, 2, ...; at equal
/// steps backward differences. (Shampine and Gordon, Computer Solution of Ordinary Differential Equations, 1975, chapter 5;
/// Brenan, Campbell and Petzold, Numerical Solution of Initial-Value Problems in Differential-Algebraic Equations, section 5.2.)
///
/// Indices here count from zero: entry `i` is `phi_{i+1}`.
#[derive(Clone, Debug)]
pub(super) struct Differences<T> {
    phi: Vec<T>,
    dimension: usize,
    /// `psi_{i+1}(n)`, and the same at the end of the step.
    psi: Vec<T>,
    next_psi: Vec<T>,
    /// `alpha_{i+1} = h / psi_{i+1}(n+1)`.
    pub(super) alpha: Vec<T>,
    /// `beta_{i+1}`, which takes `phi_{i+1}(n)` to what it is when `t_{n+1}` joins its times.
    pub(super) beta: Vec<T>,
    /// How many differences are known.
    known: usize,
}

/// Some differences and the times that they belong to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Newest<'a, T> {
    pub(super) phi: &'a [T],
    pub(super) psi: &'a [T],
    pub(super) dimension: usize,
}

impl<'a, T> Newest<'a, T> {
    /// The differences, one after another.
    fn rows(self) -> impl Iterator<Item = &'a [T]> {
        self.phi.chunks_exact(self.dimension)
    }

    /// How many there are.
    fn count(self) -> usize {
        self.psi.len()
    }
}

impl<T: Scalar> Newest<'_, T> {
    /// Writes the polynomial through the vectors, at `offset` from the newest time.
    pub(super) fn value(self, offset: T, out: &mut [T]) {
        out.fill(T::zero());
        let (mut weight, mut reach) = (T::one(), offset);
        for (row, &psi) in self.rows().zip(self.psi) {
            for (entry, &difference) in out.iter_mut().zip(row) {
                *entry += weight * difference;
            }
            weight = weight * (reach / psi);
            reach = offset + psi;
        }
    }

    /// Writes the integral of that polynomial from the newest time to `offset` from it, by parts.
    pub(super) fn integral(self, offset: T, out: &mut [T]) {
        let count = self.count();
        let mut integrals = [T::zero(); MOST];
        for (q, entry) in integrals.iter_mut().enumerate().take(count) {
            *entry = T::one() / T::from_index(q + 1);
        }
        out.fill(T::zero());
        let mut reach = offset;
        for (j, (row, &psi)) in self.rows().zip(self.psi).enumerate() {
            for (entry, &difference) in out.iter_mut().zip(row) {
                *entry += offset * integrals[0] * difference;
            }
            let (gamma, eta) = (reach / psi, offset / psi);
            for q in 0..count - j - 1 {
                integrals[q] = gamma * integrals[q] - eta * integrals[q + 1];
            }
            reach = offset + psi;
        }
    }
}

impl<T: Scalar> Differences<T> {
    /// Room for differences up to the `capacity`-th, of vectors of so many entries.
    pub(super) fn new(capacity: usize, dimension: usize) -> Self {
        let row = || vec![T::zero(); capacity];
        Self {
            phi: vec![T::zero(); capacity * dimension],
            dimension,
            psi: row(),
            next_psi: row(),
            alpha: row(),
            beta: row(),
            known: 0,
        }
    }

    /// Begins with the differences at the first time: the vector itself and, where it is given, the second one, which is `h` times a
    /// derivative.
    pub(super) fn begin(&mut self, first: &[T], second: Option<(&[T], T)>) {
        self.row_mut(0).copy_from_slice(first);
        self.known = 1;
        if let Some((derivative, h)) = second {
            for (entry, &derivative) in self.row_mut(1).iter_mut().zip(derivative) {
                *entry = h * derivative;
            }
            self.psi[0] = h;
            self.known = 2;
        }
    }

    /// How many differences are known.
    pub(super) fn known(&self) -> usize {
        self.known
    }

    /// The difference `phi_{i+1}(n)`.
    #[inline]
    pub(super) fn row(&self, i: usize) -> &[T] {
        &self.phi[i * self.dimension..][..self.dimension]
    }

    fn row_mut(&mut self, i: usize) -> &mut [T] {
        &mut self.phi[i * self.dimension..][..self.dimension]
    }

    /// `psi_{i+1}(n) = t_n - t_{n-i-1}`.
    pub(super) fn psi(&self, i: usize) -> T {
        self.psi[i]
    }

    /// The newest `count` differences.
    pub(super) fn newest(&self, count: usize) -> Newest<'_, T> {
        Newest {
            phi: &self.phi[..count * self.dimension],
            psi: &self.psi[..count],
            dimension: self.dimension,
        }
    }

    /// Computes the coefficients of the step `h` for as many differences as are known.
    pub(super) fn prepare(&mut self, h: T) {
        let mut beta = T::one();
        let mut span = h;
        for i in 0..self.known {
            self.beta[i] = beta;
            self.next_psi[i] = span;
            self.alpha[i] = h / span;
            beta = beta * (span / self.psi[i]);
            span = h + self.psi[i];
        }
    }

    /// Writes `sum_{i < count} weights_i beta_i phi_i(n)`.
    #[inline]
    pub(super) fn combine(&self, count: usize, weights: &[T], out: &mut [T]) {
        out.fill(T::zero());
        for i in (0..count).rev() {
            let weight = weights[i] * self.beta[i];
            for (entry, &difference) in out.iter_mut().zip(self.row(i)) {
                *entry += weight * difference;
            }
        }
    }

    /// Takes the new vector among the differences; `top` is what it is more than the polynomial through `count` past ones.
    pub(super) fn commit(&mut self, count: usize, top: &mut [T]) {
        let capacity = self.alpha.len();
        if count + 1 < capacity {
            let beta = if count < self.known { self.beta[count] } else { T::zero() };
            for k in 0..self.dimension {
                let below = self.phi[count * self.dimension + k];
                self.phi[(count + 1) * self.dimension + k] = top[k] - beta * below;
            }
        }
        if count < capacity {
            self.row_mut(count).copy_from_slice(top);
        }
        for i in (0..count).rev() {
            let beta = self.beta[i];
            for (entry, sum) in
                self.phi[i * self.dimension..][..self.dimension].iter_mut().zip(top.iter_mut())
            {
                *sum += beta * *entry;
                *entry = *sum;
            }
        }
        self.known = (self.known + 1).min(count + 2).min(capacity);
        std::mem::swap(&mut self.psi, &mut self.next_psi);
    }
}
