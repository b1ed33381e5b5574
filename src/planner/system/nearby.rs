use super::surroundings::Surroundings;
use crate::collision::{Proximities, Scene, SceneScratch};
use crate::law::Avoidance;

/// What of a system is near to something, for a law that keeps distances.
pub(in crate::planner) struct Nearby {
    scene: Scene,
    scratch: SceneScratch,
    found: Proximities,
    margin: f64,
    influence: f64,
    speed: f64,
}

impl Nearby {
    /// The scene of the system, whose columns are its joints.
    pub(in crate::planner) fn new(scene: Scene, surroundings: &Surroundings) -> Self {
        Self {
            scratch: scene.scratch(),
            found: scene.proximities(),
            scene,
            margin: surroundings.margin(),
            influence: surroundings.influence(),
            speed: surroundings.closing_speed(),
        }
    }

    /// How many rows there may be.
    pub(in crate::planner) fn rows(&self) -> usize {
        self.found.capacity()
    }

    /// What the two bodies of a pair are called.
    pub(in crate::planner) fn pair_names(&self, pair: usize) -> [String; 2] {
        self.scene.pair_names(pair)
    }

    /// Finds what is near at the joint positions `q`.
    pub(in crate::planner) fn look(&mut self, q: &[f64]) {
        self.scene.place(q, &mut self.scratch).contacts(self.influence, &mut self.found);
    }

    /// What was found last.
    pub(in crate::planner) fn avoidance(&self) -> Avoidance<'_> {
        Avoidance { contacts: &self.found, margin: self.margin, influence: self.influence, speed: self.speed }
    }
}
