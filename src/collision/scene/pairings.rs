//! Which kinds of pairs are checked.

/// Which kinds of pairs a [`Scene`](super::Scene) checks; all of them unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pairings {
    /// Links of one machine against each other.
    pub within_machines: bool,
    /// Links of one machine against those of another.
    pub between_machines: bool,
    /// Links against obstacles.
    pub obstacles: bool,
}

impl Default for Pairings {
    fn default() -> Pairings {
        Pairings { within_machines: true, between_machines: true, obstacles: true }
    }
}
