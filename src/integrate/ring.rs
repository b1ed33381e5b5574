/// The last few samples of a vector, newest first, in one allocation.
#[derive(Clone, Debug)]
pub(super) struct Ring<T> {
    samples: Vec<T>,
    dimension: usize,
    capacity: usize,
    newest: usize,
}

impl<T: Copy> Ring<T> {
    pub(super) fn new(capacity: usize, dimension: usize, zero: T) -> Self {
        Self { samples: vec![zero; capacity * dimension], dimension, capacity, newest: 0 }
    }

    /// The sample `age` steps before the newest; `age` is below the capacity.
    pub(super) fn get(&self, age: usize) -> &[T] {
        debug_assert!(age < self.capacity);
        let slot = self.newest + age;
        let slot = if slot >= self.capacity { slot - self.capacity } else { slot };
        &self.samples[slot * self.dimension..(slot + 1) * self.dimension]
    }

    /// Makes room for a new sample (the oldest one goes) and lends it for writing.
    pub(super) fn push(&mut self) -> &mut [T] {
        if self.capacity == 0 {
            return &mut [];
        }
        self.newest = if self.newest == 0 { self.capacity - 1 } else { self.newest - 1 };
        self.newest_mut()
    }

    /// The newest sample, to be written.
    pub(super) fn newest_mut(&mut self) -> &mut [T] {
        &mut self.samples[self.newest * self.dimension..(self.newest + 1) * self.dimension]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_newest_samples_newest_first() {
        let mut ring = Ring::new(3, 2, 0);
        for k in 1..=5 {
            ring.push().copy_from_slice(&[k, -k]);
        }
        assert_eq!([ring.get(0)[0], ring.get(1)[0], ring.get(2)[0]], [5, 4, 3]);
        assert_eq!(ring.get(2), [3, -3]);
    }
}
