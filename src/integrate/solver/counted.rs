use crate::integrate::affine::{Affine, Solved};
use crate::integrate::field::{Field, Parts};

/// A field whose evaluations are counted.
pub(super) struct Counted<'f, F> {
    field: &'f mut F,
    evaluations: usize,
}

impl<'f, F> Counted<'f, F> {
    pub(super) fn new(field: &'f mut F) -> Self {
        Self { field, evaluations: 0 }
    }

    pub(super) fn evaluations(&self) -> usize {
        self.evaluations
    }
}

impl<T, F: Field<T>> Field<T> for Counted<'_, F> {
    fn dimension(&self) -> usize {
        self.field.dimension()
    }

    fn parts(&self) -> Parts {
        self.field.parts()
    }

    fn evaluate(&mut self, t: T, x: &[T], f: &mut [T], g: &mut [T]) {
        self.evaluations += 1;
        self.field.evaluate(t, x, f, g);
    }

    fn solve(&mut self, t: T, next: Affine<'_, T>, x: &mut [T]) -> Solved {
        self.field.solve(t, next, x)
    }

    fn jacobian(&mut self, t: T, x: &[T], jacobian: &mut [T]) -> bool {
        self.field.jacobian(t, x, jacobian)
    }
}
