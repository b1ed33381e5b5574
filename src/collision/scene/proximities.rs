//! Pairs that are near, and how their distances change.

use crate::collision::Separation;

/// The nearest points of a pair, and the ends of both segments.
pub(super) const MOST_OF_A_PAIR: usize = 5;

/// A pair and how far it is apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proximity {
    /// The number of the pair in its scene ([`Scene::pair_names`](super::Scene::pair_names)).
    pub pair: usize,
    /// How far it is apart, where and in which direction.
    pub separation: Separation,
    /// The longest lever by which a joint moves one of the two points \[m\]: a motion `dq` of the joints changes the distance by
    /// `row dq` less `1/2 lever (sum |dq|)^2` at least, as far as it is decided by these points.
    pub lever: f64,
}

/// Pairs that are near, each with the derivatives of its distance by the system's joints: what
/// [`PlacedScene::within`](super::PlacedScene::within) or [`PlacedScene::contacts`](super::PlacedScene::contacts) finds.
#[derive(Debug, Clone)]
pub struct Proximities {
    columns: usize,
    found: Vec<Proximity>,
    rows: Vec<f64>,
}

impl Proximities {
    pub(super) fn with_capacity(pairs: usize, columns: usize) -> Proximities {
        let most = pairs * MOST_OF_A_PAIR;
        Proximities { columns, found: Vec::with_capacity(most), rows: Vec::with_capacity(most * columns) }
    }

    pub(super) fn clear(&mut self) {
        self.found.clear();
        self.rows.clear();
    }

    /// Adds a pair, and returns its row of zeros.
    pub(super) fn push(&mut self, proximity: Proximity) -> &mut [f64] {
        self.found.push(proximity);
        let begin = self.rows.len();
        self.rows.resize(begin + self.columns, 0.0);
        &mut self.rows[begin..]
    }

    /// Returns the number of pairs that were found.
    pub fn len(&self) -> usize {
        self.found.len()
    }

    /// Returns whether no pair was found.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// Returns the most that can be found.
    pub fn capacity(&self) -> usize {
        self.found.capacity()
    }

    /// Returns the pairs in the order of the scene, each with the derivatives of its distance by the system's joints \[m/rad\] or
    /// \[1\].
    pub fn iter(&self) -> impl Iterator<Item = (&Proximity, &[f64])> {
        let row = |index: usize| &self.rows[index * self.columns..(index + 1) * self.columns];
        self.found.iter().enumerate().map(move |(index, proximity)| (proximity, row(index)))
    }
}
