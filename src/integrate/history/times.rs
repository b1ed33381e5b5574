use crate::math::Scalar;

/// The times of the samples of a history, and the step that is to follow.
///
/// At equal steps a time is `t_0 + n sigma`, computed from its index and never accumulated: sums would drift. At varying
/// steps the times themselves are kept.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::integrate) struct Times<T> {
    index: usize,
    t0: T,
    step: T,
    /// The times of the last samples, newest first, where steps may vary.
    stored: Option<Vec<T>>,
}

impl<T: Scalar> Times<T> {
    /// Times in steps of `sigma` from `t0` on.
    pub(in crate::integrate) fn uniform(t0: T, sigma: T) -> Self {
        Self { index: 0, t0, step: sigma, stored: None }
    }

    /// The times of so many samples, from `t0` on, the first step being `step`.
    pub(in crate::integrate) fn stored(t0: T, step: T, capacity: usize) -> Self {
        Self { index: 0, t0, step, stored: Some(vec![t0; capacity.max(1)]) }
    }

    /// The index `n` of the newest sample.
    pub(in crate::integrate) fn index(&self) -> usize {
        self.index
    }

    /// The time of the newest sample.
    pub(in crate::integrate) fn now(&self) -> T {
        match &self.stored {
            None => self.t0 + T::from_index(self.index) * self.step,
            Some(times) => times[0],
        }
    }

    /// The step that is to follow.
    pub(in crate::integrate) fn step(&self) -> T {
        self.step
    }

    /// The time of the sample that is to follow.
    pub(in crate::integrate) fn next(&self) -> T {
        match &self.stored {
            None => self.t0 + T::from_index(self.index + 1) * self.step,
            Some(times) => times[0] + self.step,
        }
    }

    /// Makes the step that is to follow another one; at equal steps nothing changes.
    pub(in crate::integrate) fn set_step(&mut self, another: T) {
        if self.may_vary() {
            self.step = another;
        }
    }

    /// Whether steps may vary.
    pub(in crate::integrate) fn may_vary(&self) -> bool {
        self.stored.is_some()
    }

    /// Goes on to the next sample.
    #[inline]
    pub(super) fn commit(&mut self) {
        if let Some(times) = &mut self.stored {
            let next = times[0] + self.step;
            times.rotate_right(1);
            times[0] = next;
        }
        self.index += 1;
    }

    /// Writes the ratios of the steps, newest first: entry `i` is the step `i` steps before the next one over the step before
    /// that, `(t_(n+1-i) - t_(n-i)) / (t_(n-i) - t_(n-1-i))`. All are one at equal steps.
    pub(in crate::integrate) fn write_ratios(&self, ratios: &mut [T]) {
        let Some(times) = &self.stored else {
            ratios.fill(T::one());
            return;
        };
        let mut newer = self.step;
        for (i, ratio) in ratios.iter_mut().enumerate() {
            let older = times[i] - times[i + 1];
            *ratio = newer / older;
            newer = older;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_steps_are_not_accumulated() {
        let mut times = Times::uniform(1.0, 0.1);
        for _ in 0..1000 {
            times.commit();
        }
        assert_eq!(
            (times.index(), times.now(), times.next()),
            (1000, 1.0 + 1000.0 * 0.1, 1.0 + 1001.0 * 0.1)
        );
        times.set_step(0.2);
        assert_eq!((times.step(), times.may_vary()), (0.1, false));
    }

    #[test]
    fn varying_steps_are_kept_and_give_their_ratios() {
        let mut times = Times::stored(0.0, 1.0, 3);
        times.commit();
        times.set_step(2.0);
        times.commit();
        times.set_step(6.0);
        let mut ratios = [0.0; 2];
        times.write_ratios(&mut ratios);
        assert_eq!((times.now(), times.next(), ratios), (3.0, 9.0, [3.0, 2.0]));
        // Nothing is committed before the step is.
        times.set_step(1.0);
        times.write_ratios(&mut ratios);
        assert_eq!((times.now(), times.next(), ratios), (3.0, 4.0, [0.5, 2.0]));
    }
}
