//! Machines among obstacles: distances of all pairs at a configuration, and their derivatives by the joints.

use nalgebra::Vector3;

use super::Proximities;
use super::proximities::Proximity;
use crate::collision::{Capsule, Separation, Shape};
use crate::robot::{LinkKinematics, LinkScratch};

/// Points nearer to each other than this are one \[m\].
const SAME_POINT: f64 = 1e-9;

/// Machines among obstacles, and the pairs of them that are to be kept apart.
///
/// ```
/// use kinstep::collision::{Capsule, CollisionModel, JointPlaces, SceneBuilder};
/// use kinstep::nalgebra::{IsometryMatrix3, Vector3};
/// use kinstep::robot::embedded;
/// let panda = embedded::get("panda")?;
/// let chain = panda.chain("panda_link0", "panda_hand_tcp")?;
/// let places = JointPlaces::new().with_arm(&chain, &[0, 1, 2, 3, 4, 5, 6]);
/// let model = CollisionModel::embedded("panda")?;
/// let scene = SceneBuilder::new(7)
///     .with_machine("arm", &panda, &model, "panda_link0", &IsometryMatrix3::identity(), &places)?
///     .with_obstacle("ball", Capsule::sphere(Vector3::new(0.7, 0.0, 0.5), 0.1)?)
///     .build();
/// let q = [0.0, -0.8, 0.0, -2.3, 0.0, 1.6, 0.8];
/// let (mut scratch, mut found) = (scene.scratch(), scene.proximities());
/// let posed = scene.place(&q, &mut scratch);
/// let nearest = posed.minimum().expect("there are pairs");
/// assert!(nearest.separation.distance > 0.0, "the arm is free at home");
/// // What comes closer than 30 cm, and how these distances change with the joints.
/// posed.within(0.3, &mut found);
/// for (proximity, row) in found.iter() {
///     let [one, other] = scene.pair_names(proximity.pair);
///     println!("{one} to {other}: {} m, {row:?}", proximity.separation.distance);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    pub(super) columns: usize,
    pub(super) machines: Vec<Machine>,
    pub(super) bodies: Vec<Body>,
    pub(super) obstacles: Vec<(String, Shape)>,
    pub(super) pairs: Vec<Pair>,
}

#[derive(Debug, Clone)]
pub(super) struct Machine {
    pub(super) name: String,
    pub(super) kinematics: LinkKinematics,
}

/// A capsule of a link.
#[derive(Debug, Clone)]
pub(super) struct Body {
    pub(super) machine: usize,
    /// Its number in the machine's kinematics.
    pub(super) link: usize,
    pub(super) name: String,
    pub(super) capsule: Capsule,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Pair {
    pub(super) body: usize,
    pub(super) other: Other,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Other {
    Body(usize),
    Obstacle(usize),
}

/// Working memory of [`Scene::place`].
#[derive(Debug, Clone)]
pub struct SceneScratch {
    machines: Vec<LinkScratch>,
    placed: Vec<Placed>,
}

/// A capsule in the world, and the sphere around it.
#[derive(Debug, Clone, Copy)]
struct Placed {
    capsule: Capsule,
    middle: Vector3<f64>,
    reach: f64,
}

/// A scene whose machines stand somewhere, as [`Scene::place`] returns it.
#[derive(Debug, Clone, Copy)]
pub struct PlacedScene<'a> {
    scene: &'a Scene,
    scratch: &'a SceneScratch,
}

impl Placed {
    fn new(capsule: Capsule) -> Placed {
        let (middle, reach) = capsule.bounding_sphere();
        Placed { capsule, middle, reach }
    }
}

impl Scene {
    /// Returns the number of the system's joints: the length of `q` and of every row.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns the number of pairs that are checked.
    pub fn pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Returns what a pair is called: `left panda_link5` (the machine and its link), and likewise or the obstacle's name.
    ///
    /// # Panics
    /// When there is no such pair.
    pub fn pair_names(&self, pair: usize) -> [String; 2] {
        let named = |body: usize| {
            let Body { machine, name, .. } = &self.bodies[body];
            format!("{} {name}", self.machines[*machine].name)
        };
        let Pair { body, other } = self.pairs[pair];
        let other = match other {
            Other::Body(other) => named(other),
            Other::Obstacle(obstacle) => self.obstacles[obstacle].0.clone(),
        };
        [named(body), other]
    }

    /// Returns working memory for the scene.
    pub fn scratch(&self) -> SceneScratch {
        SceneScratch {
            machines: self.machines.iter().map(|machine| machine.kinematics.scratch()).collect(),
            placed: self.bodies.iter().map(|body| Placed::new(body.capsule)).collect(),
        }
    }

    /// Returns memory for what [`PlacedScene::within`] finds, enough for all pairs.
    pub fn proximities(&self) -> Proximities {
        Proximities::with_capacity(self.pairs.len(), self.columns)
    }

    /// Puts the machines where the joint positions `q` \[rad\] or \[m\] put them. Allocates nothing.
    ///
    /// # Panics
    /// When `q` has not [`columns`](Scene::columns) entries, or `scratch` belongs to another scene.
    pub fn place<'a>(&'a self, q: &[f64], scratch: &'a mut SceneScratch) -> PlacedScene<'a> {
        assert_eq!(q.len(), self.columns, "one position per joint of the system");
        for (machine, scratch) in self.machines.iter().zip(&mut scratch.machines) {
            machine.kinematics.forward(q, scratch);
        }
        for (body, placed) in self.bodies.iter().zip(&mut scratch.placed) {
            let posed = self.machines[body.machine].kinematics.posed(&scratch.machines[body.machine]);
            *placed = Placed::new(body.capsule.placed(&posed.pose(body.link)));
        }
        PlacedScene { scene: self, scratch }
    }
}

impl PlacedScene<'_> {
    /// Finds every pair that is no farther apart than `influence` \[m\], with the row of derivatives of its distance by the
    /// system's joints: `n . (v_a - v_b)` at the witness points. Pairs whose bounding spheres are farther apart are not looked at.
    /// Allocates nothing where `found` is of the scene ([`Scene::proximities`]).
    pub fn within(&self, influence: f64, found: &mut Proximities) {
        found.clear();
        for pair in 0..self.scene.pairs.len() {
            if self.least_distance(pair) > influence {
                continue;
            }
            let separation = self.separation(pair);
            if separation.distance <= influence {
                self.note(pair, &separation, found);
            }
        }
    }

    /// Finds what [`within`](PlacedScene::within) does and, behind each pair, the ends of its capsules that are no farther from
    /// the other body than `influence` \[m\] either. Where bodies come to lie side by side the nearest points jump from one end
    /// to the other: what holds for the ends as well holds through the jump. Allocates nothing where `found` is of the scene.
    pub fn contacts(&self, influence: f64, found: &mut Proximities) {
        found.clear();
        for pair in 0..self.scene.pairs.len() {
            if self.least_distance(pair) > influence {
                continue;
            }
            let separation = self.separation(pair);
            if separation.distance > influence {
                continue;
            }
            self.note(pair, &separation, found);
            let Pair { body, other } = self.scene.pairs[pair];
            let one = self.scratch.placed[body].capsule;
            for end in one.ends() {
                let of_end = match other {
                    Other::Body(other) => end.separation(&self.scratch.placed[other].capsule),
                    Other::Obstacle(obstacle) => end.separation_from(&self.scene.obstacles[obstacle].1),
                };
                self.note_end(pair, &separation, of_end, influence, found);
            }
            if let Other::Body(other) = other {
                for end in self.scratch.placed[other].capsule.ends() {
                    self.note_end(pair, &separation, one.separation(&end), influence, found);
                }
            }
        }
    }

    /// Takes note of an end, unless it is too far or the nearest point itself.
    fn note_end(
        &self,
        pair: usize,
        nearest: &Separation,
        of_end: Separation,
        influence: f64,
        found: &mut Proximities,
    ) {
        let apart = (0..2).map(|side| (of_end.points[side] - nearest.points[side]).amax());
        if of_end.distance <= influence && apart.fold(0.0, f64::max) > SAME_POINT {
            self.note(pair, &of_end, found);
        }
    }

    fn note(&self, pair: usize, separation: &Separation, found: &mut Proximities) {
        let lever = self.lever(pair, separation);
        let row = found.push(Proximity { pair, separation: *separation, lever });
        self.add_derivatives(pair, separation, row);
    }

    /// The longest lever by which a joint moves one of the witness points.
    fn lever(&self, pair: usize, separation: &Separation) -> f64 {
        let Pair { body, other } = self.scene.pairs[pair];
        let lever = |body: usize, point: &Vector3<f64>| {
            let &Body { machine, link, .. } = &self.scene.bodies[body];
            let posed = self.scene.machines[machine].kinematics.posed(&self.scratch.machines[machine]);
            posed.lever(link, point)
        };
        let own = lever(body, &separation.points[0]);
        match other {
            Other::Body(other) => own.max(lever(other, &separation.points[1])),
            Other::Obstacle(_) => own,
        }
    }

    /// Returns the pair that is closest, with its distance; `None` where there are no pairs. Pairs whose bounding spheres are
    /// farther apart than the closest so far are not looked at.
    pub fn minimum(&self) -> Option<Proximity> {
        let mut best: Option<Proximity> = None;
        for pair in 0..self.scene.pairs.len() {
            let bound = best.map_or(f64::INFINITY, |best| best.separation.distance);
            if self.least_distance(pair) < bound {
                let separation = self.separation(pair);
                if separation.distance < bound {
                    best = Some(Proximity { pair, separation, lever: self.lever(pair, &separation) });
                }
            }
        }
        best
    }

    /// Returns the separation of a pair, wherever it is.
    ///
    /// # Panics
    /// When there is no such pair.
    pub fn separation(&self, pair: usize) -> Separation {
        let Pair { body, other } = self.scene.pairs[pair];
        let capsule = &self.scratch.placed[body].capsule;
        match other {
            Other::Body(other) => capsule.separation(&self.scratch.placed[other].capsule),
            Other::Obstacle(obstacle) => capsule.separation_from(&self.scene.obstacles[obstacle].1),
        }
    }

    /// Adds to `row` the derivatives of a pair's distance by the system's joints, `n . (v_a - v_b)` at the witness points of its
    /// separation: \[m/rad\] or \[1\]. They are exact wherever the distance has derivatives; it has none where a pair has several
    /// nearest points, such as parallel capsules side by side.
    ///
    /// # Panics
    /// When there is no such pair, or `row` has not [`Scene::columns`] entries.
    pub fn add_derivatives(&self, pair: usize, separation: &Separation, row: &mut [f64]) {
        assert_eq!(row.len(), self.scene.columns, "one entry per joint of the system");
        let Pair { body, other } = self.scene.pairs[pair];
        self.add_velocity(body, &separation.points[0], &separation.normal, 1.0, row);
        if let Other::Body(other) = other {
            self.add_velocity(other, &separation.points[1], &separation.normal, -1.0, row);
        }
    }

    fn add_velocity(
        &self,
        body: usize,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
        factor: f64,
        row: &mut [f64],
    ) {
        let &Body { machine, link, .. } = &self.scene.bodies[body];
        let posed = self.scene.machines[machine].kinematics.posed(&self.scratch.machines[machine]);
        posed.add_velocity(link, point, normal, factor, row);
    }

    /// A lower bound of the distance of a pair.
    fn least_distance(&self, pair: usize) -> f64 {
        let Pair { body, other } = self.scene.pairs[pair];
        let Placed { middle, reach, .. } = &self.scratch.placed[body];
        match other {
            Other::Body(other) => {
                let other = &self.scratch.placed[other];
                (middle - other.middle).norm() - reach - other.reach
            }
            Other::Obstacle(obstacle) => self.scene.obstacles[obstacle].1.least_distance(middle, *reach),
        }
    }
}
