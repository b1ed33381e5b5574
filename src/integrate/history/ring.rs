/// Components are combined so many at a time: their sums stay in registers.
pub(in crate::integrate) const BLOCK: usize = 8;

/// The last few samples of a vector, newest first, in one allocation. Samples are filled up to whole blocks with zeros.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct Ring<T> {
    samples: Vec<[T; BLOCK]>,
    dimension: usize,
    blocks: usize,
    capacity: usize,
    /// Where the newest sample begins.
    newest: usize,
}

impl<T: Copy> Ring<T> {
    pub(in crate::integrate) fn new(capacity: usize, dimension: usize, zero: T) -> Self {
        let blocks = dimension.div_ceil(BLOCK);
        Self { samples: vec![[zero; BLOCK]; capacity * blocks], dimension, blocks, capacity, newest: 0 }
    }

    /// A ring of components that come from several rings of one capacity: each from an entry of one of them, or zero.
    pub(in crate::integrate) fn gathered(
        rings: &[&Self],
        origins: &[Option<(usize, usize)>],
        zero: T,
    ) -> Self {
        let capacity = rings.first().map_or(0, |ring| ring.capacity);
        let mut gathered = Self::new(capacity, origins.len(), zero);
        for age in (0..capacity).rev() {
            for (entry, origin) in gathered.push().iter_mut().zip(origins) {
                *entry = origin.map_or(zero, |(ring, i)| rings[ring].get(age)[i]);
            }
        }
        gathered
    }

    /// The sample `age` steps before the newest; `age` is below the capacity.
    #[inline]
    pub(in crate::integrate) fn get(&self, age: usize) -> &[T] {
        &self.blocks(age).as_flattened()[..self.dimension]
    }

    /// The same in blocks, the last one filled up.
    #[inline]
    pub(in crate::integrate) fn blocks(&self, age: usize) -> &[[T; BLOCK]] {
        &self.samples[self.place(age)..][..self.blocks]
    }

    /// Where the sample `age` steps before the newest begins.
    #[inline(always)]
    fn place(&self, age: usize) -> usize {
        debug_assert!(age < self.capacity);
        let place = self.newest + age * self.blocks;
        if place >= self.samples.len() { place - self.samples.len() } else { place }
    }

    /// The `B` blocks from the block `from` on.
    #[inline(always)]
    pub(in crate::integrate) fn part<const B: usize>(&self, age: usize, from: usize) -> &[[T; BLOCK]; B] {
        self.samples[self.place(age) + from..].first_chunk().expect("as many blocks as the state has")
    }

    /// The newest sample, for writing; there has to be room for one.
    pub(in crate::integrate) fn newest_mut(&mut self) -> &mut [T] {
        &mut self.samples[self.newest..][..self.blocks].as_flattened_mut()[..self.dimension]
    }

    /// Makes room for a new sample (the oldest one goes) and lends it for writing.
    pub(in crate::integrate) fn push(&mut self) -> &mut [T] {
        let dimension = self.dimension;
        let sample = self.push_blocks().as_flattened_mut();
        let kept = dimension.min(sample.len());
        &mut sample[..kept]
    }

    /// The same in blocks; what is written beyond the dimension must be zero.
    pub(in crate::integrate) fn push_blocks(&mut self) -> &mut [[T; BLOCK]] {
        let end = if self.newest == 0 { self.samples.len() } else { self.newest };
        // Nothing is kept where no capacity was asked for.
        self.newest = end.saturating_sub(self.blocks);
        &mut self.samples[self.newest..end]
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
