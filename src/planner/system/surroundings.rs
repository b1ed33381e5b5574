use super::arm::Arm;
use crate::collision::{CollisionModel, JointPlaces, Pairings, Scene, SceneBuilder, Shape};
use crate::planner::PlannerError;
use crate::robot::Robot;
use nalgebra::IsometryMatrix3;

/// From how far beyond the margin on pairs count, unless given \[m\].
const INFLUENCE: f64 = 0.1;
/// How fast the way to the margin may shrink, unless given [1/s].
const RATE: f64 = 5.0;

/// What stands around the arms of a plan: the bodies of their machines, obstacles, and how near these may come to each other.
///
/// With it a plan says how near they came ([`Plan::distance`](crate::planner::Plan::distance)), and laws that
/// [keep distances](crate::law::Law::keeps_distances) see what is near.
///
/// ```
/// use kinstep::collision::{Capsule, CollisionModel};
/// use kinstep::nalgebra::{IsometryMatrix3, Vector3};
/// use kinstep::planner::Surroundings;
/// use kinstep::robot::embedded;
/// let panda = embedded::get("panda")?;
/// let model = CollisionModel::embedded("panda")?;
/// let surroundings = Surroundings::new(0.02)
///     .with_machine("arm", panda, model, "panda_link0", IsometryMatrix3::identity(), ["arm"])
///     .with_obstacle("ball", Capsule::sphere(Vector3::new(0.7, 0.0, 0.5), 0.1)?);
/// # let _ = surroundings;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Surroundings {
    machines: Vec<MachineBodies>,
    obstacles: Vec<(String, Shape)>,
    pairings: Pairings,
    allowed: Vec<[String; 2]>,
    margin: f64,
    influence: f64,
    speed: Option<f64>,
}

/// The bodies of a machine and the arms that move it.
#[derive(Clone, Debug)]
struct MachineBodies {
    name: String,
    robot: Robot,
    model: CollisionModel,
    base: String,
    world_from_base: IsometryMatrix3<f64>,
    arms: Vec<String>,
}

impl Surroundings {
    /// Nothing yet, with bodies that may come as near as `margin` \[m\].
    pub fn new(margin: f64) -> Self {
        Self {
            machines: Vec::new(),
            obstacles: Vec::new(),
            pairings: Pairings::default(),
            allowed: Vec::new(),
            margin,
            influence: margin + INFLUENCE,
            speed: None,
        }
    }

    /// The same with a machine: a robot with its bodies, whose link `base` stands at `world_from_base`, and the names of the arms
    /// that move it. Joints of it that no arm moves stay at zero, or at the limit that is nearest to it.
    #[must_use]
    pub fn with_machine(
        mut self,
        name: impl Into<String>,
        robot: Robot,
        model: CollisionModel,
        base: impl Into<String>,
        world_from_base: IsometryMatrix3<f64>,
        arms: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        self.machines.push(MachineBodies {
            name: name.into(),
            robot,
            model,
            base: base.into(),
            world_from_base,
            arms: arms.into_iter().map(Into::into).collect(),
        });
        self
    }

    /// The same with an obstacle that stands still, given in the world.
    #[must_use]
    pub fn with_obstacle(mut self, name: impl Into<String>, shape: impl Into<Shape>) -> Self {
        self.obstacles.push((name.into(), shape.into()));
        self
    }

    /// The same with pairs of these kinds only.
    #[must_use]
    pub fn with_pairings(mut self, pairings: Pairings) -> Self {
        self.pairings = pairings;
        self
    }

    /// The same without the pairs of a link and another, or of a link and an obstacle, of these names.
    #[must_use]
    pub fn allowing(mut self, one: impl Into<String>, other: impl Into<String>) -> Self {
        self.allowed.push([one.into(), other.into()]);
        self
    }

    /// The same with pairs that count from a distance on \[m\]; by default from 0.1 m beyond the margin.
    #[must_use]
    pub fn with_influence(mut self, influence: f64) -> Self {
        self.influence = influence;
        self
    }

    /// The same with how fast a pair may come nearer where it begins to count [m/s]; by default five times the way from there
    /// to the margin per second.
    #[must_use]
    pub fn with_closing_speed(mut self, speed: f64) -> Self {
        self.speed = Some(speed);
        self
    }

    /// How near bodies may come to each other \[m\].
    pub fn margin(&self) -> f64 {
        self.margin
    }

    /// From where on pairs count \[m\].
    pub(in crate::planner) fn influence(&self) -> f64 {
        self.influence
    }

    /// How fast a pair may come nearer where it begins to count [m/s].
    pub(in crate::planner) fn closing_speed(&self) -> f64 {
        self.speed.unwrap_or(RATE * (self.influence - self.margin))
    }

    /// What is not looked at because there is no body for it, machine by machine.
    pub(in crate::planner) fn missing(&self) -> impl Iterator<Item = String> {
        self.machines.iter().flat_map(|machine| {
            machine.model.missing().iter().map(|missing| {
                let link = if missing.link.is_empty() {
                    String::new()
                } else {
                    format!("link `{}`: ", missing.link)
                };
                format!(
                    "not all of `{}` is kept apart from what is around it: {link}{}",
                    machine.name, missing.reason
                )
            })
        })
    }

    /// Checks its numbers, and that it names arms that there are.
    pub(in crate::planner) fn check(&self, arms: &[Arm]) -> Result<(), PlannerError> {
        let refuse = |problem: String| Err(PlannerError::Surroundings { problem });
        if !(self.margin >= 0.0 && self.margin.is_finite()) {
            return refuse(format!("the margin is {} m; it is a length, zero or more", self.margin));
        }
        if !(self.influence > self.margin && self.influence.is_finite()) {
            return refuse(format!(
                "pairs count from {} m on, and the margin is {} m; it takes more than that for a motion to be slowed down",
                self.influence, self.margin
            ));
        }
        if !(self.closing_speed() > 0.0 && self.closing_speed().is_finite()) {
            return refuse(format!("the closing speed is {} m/s; it is positive", self.closing_speed()));
        }
        let named = self.machines.iter().flat_map(|machine| &machine.arms);
        for name in named {
            if arms.iter().all(|arm| arm.name != *name) {
                let known = arms.iter().map(|arm| arm.name.as_str()).collect::<Vec<_>>().join("`, `");
                return Err(PlannerError::UnknownArm { name: name.clone(), known });
            }
        }
        Ok(())
    }

    /// The scene in which arms have their joints at these places of so many positions.
    pub(in crate::planner) fn scene(
        &self,
        columns: usize,
        arms: &[(&Arm, Vec<usize>)],
    ) -> Result<Scene, PlannerError> {
        let mut builder = SceneBuilder::new(columns).with_pairings(self.pairings);
        for machine in &self.machines {
            let MachineBodies { name, robot, model, base, world_from_base, .. } = machine;
            let own = arms.iter().filter(|(arm, _)| machine.arms.contains(&arm.name));
            let places = own.fold(JointPlaces::new(), |all, (arm, places)| all.with_arm(&arm.chain, places));
            builder = builder.with_machine(name, robot, model, base, world_from_base, &places).map_err(
                |error| PlannerError::Surroundings { problem: format!("machine `{name}`: {error}") },
            )?;
        }
        let builder =
            self.obstacles.iter().fold(builder, |all, (name, shape)| all.with_obstacle(name, *shape));
        let builder = self.allowed.iter().fold(builder, |all, [one, other]| all.allowing(one, other));
        Ok(builder.build())
    }
}
