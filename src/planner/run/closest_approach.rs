/// How near two bodies of a plan came to each other.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosestApproach {
    /// The least distance over all pairs and samples \[m\]; negative where bodies overlap.
    pub minimum: f64,
    /// The two bodies: arms with their links, or an obstacle.
    pub pair: [String; 2],
    /// The time of the first sample at which they were that near \[s\].
    pub t: f64,
    /// How near they may come \[m\].
    pub margin: f64,
    /// The least distance over all pairs at every sample \[m\].
    pub course: Vec<f64>,
}

impl ClosestApproach {
    /// Whether no pair came nearer than it may, but for rounding.
    pub fn is_kept(&self) -> bool {
        self.minimum >= self.margin - ROUNDING
    }
}

/// What rounding may take from a distance \[m\].
const ROUNDING: f64 = 1e-9;
