/// What a stepper knows of a sample.
#[derive(Clone, Copy)]
pub(in crate::planner) struct Sample<'a> {
    /// Joint positions [rad or m].
    pub(in crate::planner) positions: &'a [f64],
    /// Joint positions one sample ago, the same at the start.
    pub(in crate::planner) previous: &'a [f64],
    /// Feedforward joint velocities [rad/s or m/s].
    pub(in crate::planner) velocities: &'a [f64],
}

impl<'a> Sample<'a> {
    /// The part of the state that begins there.
    pub(in crate::planner) fn from(&self, from: usize) -> Sample<'a> {
        Sample {
            positions: &self.positions[from..],
            previous: &self.previous[from..],
            velocities: &self.velocities[from..],
        }
    }
}
