//! Machines and obstacles put together.

use nalgebra::IsometryMatrix3;

use super::scene::{Body, Machine, Other, Pair};
use super::{JointPlaces, Pairings, Scene};
use crate::collision::{CollisionModel, Shape};
use crate::robot::{ChainError, LinkKinematics, Robot};

/// What is around: machines with their capsules, and obstacles. [`build`](SceneBuilder::build) makes a [`Scene`] of it.
///
/// Arms of one robot on one mount, such as those that share a torso, are one machine.
#[derive(Debug, Clone, Default)]
pub struct SceneBuilder {
    columns: usize,
    machines: Vec<Machine>,
    models: Vec<CollisionModel>,
    bodies: Vec<Body>,
    obstacles: Vec<(String, Shape)>,
    pairings: Pairings,
    allowed: Vec<[String; 2]>,
}

impl SceneBuilder {
    /// Returns a builder for a system of that many joints in which there is nothing yet.
    pub fn new(columns: usize) -> SceneBuilder {
        SceneBuilder { columns, ..SceneBuilder::default() }
    }

    /// Adds a machine: a robot whose link `base` stands at `world_from_base`, and which joints of it are the system's.
    ///
    /// # Errors
    /// [`ChainError`]: there is no link `base`, or a link with a capsule to which no chain leads from there.
    ///
    /// # Panics
    /// When a place is not among the system's joints.
    pub fn with_machine(
        mut self,
        name: &str,
        robot: &Robot,
        model: &CollisionModel,
        base: &str,
        world_from_base: &IsometryMatrix3<f64>,
        places: &JointPlaces,
    ) -> Result<SceneBuilder, ChainError> {
        let links: Vec<&str> = model.capsules().iter().map(|capsule| capsule.link.as_str()).collect();
        let source = |joint: &crate::robot::Joint| places.source(joint);
        let kinematics = LinkKinematics::new(robot, base, &links, world_from_base, source)?;
        assert!(kinematics.columns() <= self.columns, "the places of {name} are among the system's joints");
        let machine = self.machines.len();
        for (link, capsule) in model.capsules().iter().enumerate() {
            let name = capsule.link.clone();
            self.bodies.push(Body { machine, link, name, capsule: capsule.capsule });
        }
        self.machines.push(Machine { name: name.to_owned(), kinematics });
        self.models.push(model.clone());
        Ok(self)
    }

    /// Adds an obstacle that stands still, given in the world.
    #[must_use]
    pub fn with_obstacle(mut self, name: &str, shape: impl Into<Shape>) -> SceneBuilder {
        self.obstacles.push((name.to_owned(), shape.into()));
        self
    }

    /// Says which kinds of pairs are checked.
    #[must_use]
    pub fn with_pairings(mut self, pairings: Pairings) -> SceneBuilder {
        self.pairings = pairings;
        self
    }

    /// Leaves out all pairs of a link and another, or of a link and an obstacle, of these names: a foot on the floor that it is
    /// screwed to, say.
    #[must_use]
    pub fn allowing(mut self, one: &str, other: &str) -> SceneBuilder {
        self.allowed.push([one.to_owned(), other.to_owned()]);
        self
    }

    /// Returns the scene: every pair that is to be checked. A pair of which nothing moves, or that moves as one, is none.
    pub fn build(self) -> Scene {
        let mut pairs = Vec::new();
        for (first, body) in self.bodies.iter().enumerate() {
            let others =
                (first + 1..self.bodies.len()).filter(|other| self.may_meet(body, &self.bodies[*other]));
            pairs.extend(others.map(|other| Pair { body: first, other: Other::Body(other) }));
            if self.pairings.obstacles && self.moves(body) {
                let obstacles = (0..self.obstacles.len())
                    .filter(|&other| !self.is_allowed(&body.name, &self.obstacles[other].0));
                pairs.extend(obstacles.map(|other| Pair { body: first, other: Other::Obstacle(other) }));
            }
        }
        let SceneBuilder { columns, machines, bodies, obstacles, .. } = self;
        Scene { columns, machines, bodies, obstacles, pairs }
    }

    fn may_meet(&self, one: &Body, other: &Body) -> bool {
        if self.is_allowed(&one.name, &other.name) {
            return false;
        }
        if one.machine != other.machine {
            return self.pairings.between_machines && (self.moves(one) || self.moves(other));
        }
        self.pairings.within_machines
            && !self.machines[one.machine].kinematics.are_rigid(one.link, other.link)
            && self.models[one.machine].checks(&one.name, &other.name)
    }

    fn moves(&self, body: &Body) -> bool {
        self.machines[body.machine].kinematics.moves(body.link)
    }

    fn is_allowed(&self, one: &str, other: &str) -> bool {
        self.allowed.iter().any(|[a, b]| (a == one && b == other) || (a == other && b == one))
    }
}
