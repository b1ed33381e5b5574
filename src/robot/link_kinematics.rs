//! Many links of one robot at once: their poses, and how points of them move with the joints.

use fearless_simd::{Level, Simd};
use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Vector3};

use super::displacement::displacement;
use super::kinematics::Motions;
use super::path::{self, Step};
use super::{ChainError, Joint, JointKind, Robot};
use crate::math::{Kernel, level, with_instructions};

/// Where the position of a joint comes from, for [`LinkKinematics::new`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointSource {
    /// It is the entry of that index of the positions that are given each time.
    Column(usize),
    /// It stays at this position \[rad\] or \[m\].
    Held(f64),
}

/// The paths from one link of a robot to others of its links, to be run together.
///
/// A [`Chain`](super::Chain) is folded for the sake of its tip, and gives the pose of no link on its way; this gives every link
/// that is asked for, in one pass over the joints that lead to any of them.
///
/// ```
/// use kinstep::nalgebra::{IsometryMatrix3, Vector3};
/// use kinstep::robot::{JointSource, LinkKinematics, embedded};
/// let panda = embedded::get("panda")?;
/// let (links, mount) = (["panda_link2", "panda_link7"], IsometryMatrix3::identity());
/// let number = |name: &str| name.strip_prefix("panda_joint").and_then(|n| n.parse::<usize>().ok());
/// let source = |joint: &kinstep::robot::Joint| match number(&joint.name) {
///     Some(number) => JointSource::Column(number - 1),
///     None => JointSource::Held(0.0),
/// };
/// let kinematics = LinkKinematics::new(&panda, "panda_link0", &links, &mount, source)?;
/// let mut scratch = kinematics.scratch();
/// let posed = kinematics.forward(&[0.0; 7], &mut scratch);
/// assert!((posed.pose(0).translation.z - 0.333).abs() < 1e-12);
/// // The first joint moves a point that is half a metre in front of it to the side.
/// let mut row = [0.0; 7];
/// posed.add_velocity(1, &Vector3::new(0.5, 0.0, 0.0), &Vector3::y(), 1.0, &mut row);
/// assert!((row[0] - 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LinkKinematics {
    start: IsometryMatrix3<f64>,
    /// Every one after the one that it continues.
    passes: Vec<Pass>,
    /// For every link the pass that leads to it; none for the base.
    ends: Vec<Option<usize>>,
    /// The number of positions that are needed.
    columns: usize,
}

/// One joint on the way: `before displacement(q) after`.
#[derive(Debug, Clone)]
struct Pass {
    step: Step,
    continues: Option<usize>,
    before: IsometryMatrix3<f64>,
    motion: Option<Drive>,
    after: IsometryMatrix3<f64>,
}

/// How a joint is moved: to `multiplier q_column + offset`, along an axis that points the other way where it is passed upward.
#[derive(Debug, Clone)]
struct Drive {
    column: usize,
    multiplier: f64,
    offset: f64,
    turns: bool,
    axis: Vector3<f64>,
}

/// Working memory of [`LinkKinematics::forward`].
#[derive(Debug, Clone)]
pub struct LinkScratch {
    level: Level,
    motions: Motions,
    positions: Vec<f64>,
    poses: Vec<IsometryMatrix3<f64>>,
    /// A point of each axis, and its direction.
    axes: Vec<[Vector3<f64>; 2]>,
}

/// Links whose kinematics have been run, as [`LinkKinematics::forward`] returns them.
#[derive(Debug, Clone, Copy)]
pub struct PosedLinks<'a> {
    kinematics: &'a LinkKinematics,
    scratch: &'a LinkScratch,
}

impl LinkKinematics {
    /// Returns the kinematics of `links` of a robot whose link `base` stands at `world_from_base`. `source` says of every joint
    /// that moves on its own where its position comes from; joints that follow others follow.
    ///
    /// # Errors
    /// [`ChainError`]: a link that the robot does not have, or that no chain from the base leads to.
    pub fn new(
        robot: &Robot,
        base: &str,
        links: &[&str],
        world_from_base: &IsometryMatrix3<f64>,
        source: impl Fn(&Joint) -> JointSource,
    ) -> Result<LinkKinematics, ChainError> {
        let mut kinematics =
            LinkKinematics { start: *world_from_base, passes: Vec::new(), ends: Vec::new(), columns: 0 };
        if let Err(error @ ChainError::UnknownLink { .. }) = path::steps(robot, base, base) {
            return Err(error);
        }
        for &link in links {
            let steps = match path::steps(robot, base, link) {
                Err(ChainError::SameLink { .. }) => Vec::new(),
                steps => steps?,
            };
            let mut end = None;
            for step in steps {
                end = Some(kinematics.continued(robot, end, step, &source));
            }
            kinematics.ends.push(end);
        }
        Ok(kinematics)
    }

    /// The place of the pass that takes a step after another pass, which is added where it is not there yet.
    fn continued(
        &mut self,
        robot: &Robot,
        continues: Option<usize>,
        step: Step,
        source: &impl Fn(&Joint) -> JointSource,
    ) -> usize {
        let known = self.passes.iter().position(|pass| pass.continues == continues && pass.step == step);
        known.unwrap_or_else(|| {
            let pass = Pass::new(robot, continues, step, source);
            if let Some(drive) = &pass.motion {
                self.columns = self.columns.max(drive.column + 1);
            }
            self.passes.push(pass);
            self.passes.len() - 1
        })
    }

    /// Returns working memory for the kinematics.
    pub fn scratch(&self) -> LinkScratch {
        let length = self.passes.len();
        LinkScratch {
            level: level(),
            motions: Motions::with_length(length),
            positions: vec![0.0; length.next_multiple_of(4)],
            poses: vec![self.start; length],
            axes: vec![[Vector3::zeros(); 2]; length],
        }
    }

    /// Runs the kinematics at the positions `q` \[rad\] or \[m\]. Allocates nothing.
    ///
    /// # Panics
    /// When `q` has fewer entries than the columns that were given, or `scratch` was made for another robot.
    pub fn forward<'a>(&'a self, q: &[f64], scratch: &'a mut LinkScratch) -> PosedLinks<'a> {
        assert!(q.len() >= self.columns, "one position for every column");
        for (position, pass) in scratch.positions.iter_mut().zip(&self.passes) {
            *position =
                pass.motion.as_ref().map_or(0.0, |drive| drive.multiplier * q[drive.column] + drive.offset);
        }
        with_instructions(
            scratch.level,
            Turns { motions: &mut scratch.motions, positions: &scratch.positions },
        );
        for (index, pass) in self.passes.iter().enumerate() {
            let previous = pass.continues.map_or(self.start, |before| scratch.poses[before]);
            scratch.poses[index] = match &pass.motion {
                None => previous * pass.before,
                Some(drive) => {
                    let frame = previous * pass.before;
                    scratch.axes[index] = [frame.translation.vector, frame.rotation * drive.axis];
                    let turn = [scratch.motions.sines[index], scratch.motions.cosines[index]];
                    frame * drive.displacement(scratch.positions[index], turn) * pass.after
                }
            };
        }
        PosedLinks { kinematics: self, scratch }
    }

    /// The links as they were posed last in that memory.
    pub(crate) fn posed<'a>(&'a self, scratch: &'a LinkScratch) -> PosedLinks<'a> {
        PosedLinks { kinematics: self, scratch }
    }

    /// Returns the number of positions that are needed: one more than the largest column that was given.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns whether positions that are given move the link.
    pub fn moves(&self, link: usize) -> bool {
        self.drives(link).next().is_some()
    }

    /// Returns whether two of the links always keep their relative pose.
    pub fn are_rigid(&self, link: usize, other: usize) -> bool {
        let passes = |link| self.drives(link).map(|(index, _)| index);
        passes(link).eq(passes(other))
    }

    /// The driven passes on the way to a link, the last one first.
    fn drives(&self, link: usize) -> impl Iterator<Item = (usize, &Drive)> {
        let way = std::iter::successors(self.ends[link], |&index| self.passes[index].continues);
        way.filter_map(|index| Some((index, self.passes[index].motion.as_ref()?)))
    }
}

impl Pass {
    fn new(
        robot: &Robot,
        continues: Option<usize>,
        step: Step,
        source: &impl Fn(&Joint) -> JointSource,
    ) -> Pass {
        let joint = &robot.joints[step.joint];
        let (driver, multiplier, offset) = match joint.mimic {
            Some(mimic) => (&robot.joints[mimic.driver], mimic.multiplier, mimic.offset),
            None => (joint, 1.0, 0.0),
        };
        let source = if joint.kind.is_movable() { source(driver) } else { JointSource::Held(0.0) };
        let identity = IsometryMatrix3::identity();
        match source {
            JointSource::Held(position) => {
                let motion = displacement(joint.kind, joint.axis, multiplier * position + offset);
                let down = joint.origin * motion;
                let before = if step.upward { down.inverse() } else { down };
                Pass { step, continues, before, motion: None, after: identity }
            }
            JointSource::Column(column) => {
                let turns = joint.kind != JointKind::Prismatic;
                let axis = if step.upward { -joint.axis } else { joint.axis };
                let motion = Some(Drive { column, multiplier, offset, turns, axis });
                let (before, after) =
                    if step.upward { (identity, joint.origin.inverse()) } else { (joint.origin, identity) };
                Pass { step, continues, before, motion, after }
            }
        }
    }
}

impl Drive {
    /// The displacement of the joint, `turn` being the sine and the cosine of its position.
    fn displacement(&self, position: f64, [sine, cosine]: [f64; 2]) -> IsometryMatrix3<f64> {
        if !self.turns {
            return IsometryMatrix3::from_parts((self.axis * position).into(), Rotation3::identity());
        }
        let axis = &self.axis;
        let turn = axis * axis.transpose() * (1.0 - cosine)
            + axis.cross_matrix() * sine
            + Matrix3::from_diagonal_element(cosine);
        IsometryMatrix3::from_parts(Vector3::zeros().into(), Rotation3::from_matrix_unchecked(turn))
    }
}

/// The sines and cosines of all positions.
struct Turns<'a> {
    motions: &'a mut Motions,
    positions: &'a [f64],
}

impl Kernel for Turns<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        self.motions.turn_to(simd, self.positions);
    }
}

impl PosedLinks<'_> {
    /// Returns the pose in the world of the link of that index among those that were asked for.
    pub fn pose(&self, link: usize) -> IsometryMatrix3<f64> {
        self.kinematics.ends[link].map_or(self.kinematics.start, |end| self.scratch.poses[end])
    }

    /// Adds to `row` how fast a point of a link moves in a direction, times `factor`, per unit of velocity of every column:
    /// `factor direction . (z x (point - o))` for a joint that turns about `z` through `o`, `factor direction . z` for one that
    /// slides along `z`. `point` \[m\] and `direction` are given in the world.
    ///
    /// # Panics
    /// When `row` has fewer entries than the columns that were given.
    pub fn add_velocity(
        &self,
        link: usize,
        point: &Vector3<f64>,
        direction: &Vector3<f64>,
        factor: f64,
        row: &mut [f64],
    ) {
        for (index, drive) in self.kinematics.drives(link) {
            let [origin, axis] = &self.scratch.axes[index];
            let speed =
                if drive.turns { axis.cross(&(point - origin)).dot(direction) } else { axis.dot(direction) };
            row[drive.column] += factor * drive.multiplier * speed;
        }
    }

    /// Returns the longest lever by which a joint moves a point of a link, given in the world: the distance from the axis \[m\] of
    /// one that turns, 1 of one that slides; times the factor by which it follows another. With it the point departs from the motion
    /// that its velocities promise by at most `1/2 lever (sum |dq|)^2`.
    pub fn lever(&self, link: usize, point: &Vector3<f64>) -> f64 {
        let levers = self.kinematics.drives(link).map(|(index, drive)| {
            let [origin, axis] = &self.scratch.axes[index];
            let lever = if drive.turns { axis.cross(&(point - origin)).norm() } else { 1.0 };
            lever * drive.multiplier.abs().max(drive.multiplier * drive.multiplier)
        });
        levers.fold(0.0, f64::max)
    }
}
