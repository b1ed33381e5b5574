//! From a scenario to a planner: robots and rows looked up, chains mounted, paths laid.

use std::collections::HashSet;
use std::path::Path;

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Unit, Vector3};

use super::approach::{Approach, TOLERANCE, reach};
use super::error::{ErrorKind, ScenarioError};
use super::key_path::KeyPath;
use super::kinds::Kinds;
use super::law_spec::LawSpec;
use super::model::{ArmSpec, Mount, Scenario};
use super::noise_spec::NoiseSpec;
use super::path_spec::PathSpec;
use super::robots::RobotSource;
use super::start_pose::StartPose;
use super::time_law_spec::TimeLawSpec;
use kinstep::formula::{Duty, Formula, FormulaTable};
use kinstep::integrate::Starter;
use kinstep::kind::Real;
use kinstep::planner::{Arm, JointSystem, Planner, PlannerBuilder, PlannerError, joint_sets};
use kinstep::robot::{Chain, ChainError, ChainJoint, PositionsError, Robot, UrdfOptions};
use kinstep::task::{self, Leaning, Linear, MakeCurve, Motion, Planar, TimeLaw, Turning};

impl Scenario {
    /// Returns a planner for the scenario with a row of `table`; robot files are looked for from `folder`, the place
    /// of the scenario's own file.
    ///
    /// # Errors
    /// [`ScenarioError`] with the path of the key at fault: [`ScenarioText::placed`](super::ScenarioText::placed)
    /// gives it a place.
    pub fn planner(&self, table: &FormulaTable, folder: Option<&Path>) -> Result<Planner, ScenarioError> {
        self.planner_with(&Kinds::builtin(), table, folder)
    }

    /// As [`Scenario::planner`], with kinds of the program's own beside the built-in ones.
    ///
    /// # Errors
    /// As [`Scenario::planner`].
    pub fn planner_with(
        &self,
        kinds: &Kinds,
        table: &FormulaTable,
        folder: Option<&Path>,
    ) -> Result<Planner, ScenarioError> {
        let read = self.read_and_checked(kinds)?.with_waypoints_read(kinds, folder)?;
        read.planner_of_checked(kinds, table, folder)
    }

    fn planner_of_checked(
        &self,
        kinds: &Kinds,
        table: &FormulaTable,
        folder: Option<&Path>,
    ) -> Result<Planner, ScenarioError> {
        if self.problem.is_some() {
            let problem =
                "this scenario is an initial value problem and moves no arm; `kinstep order` runs it";
            return Err(ScenarioError::at(ErrorKind::Scenario, &KeyPath::dotted("problem"), problem));
        }
        let formula = self.formula_of(table);
        let arms = self.build_arms(kinds, folder);
        let refusals = arms.iter().filter_map(|arm| arm.as_ref().err());
        if let Some(all) = ScenarioError::all(formula.as_ref().err().into_iter().chain(refusals)) {
            return Err(all);
        }
        let arms: Vec<Arm> = arms.into_iter().collect::<Result<_, _>>()?;
        self.law.check_joints(kinds, &arms)?;
        let arms = self.on_machines(arms)?;
        let systems = self.systems(kinds, &arms)?;
        let mut builder = self.builder(formula?).arms(arms);
        if let Some(surroundings) = self.surroundings(kinds, folder)? {
            builder = builder.surroundings(surroundings);
        }
        systems.into_iter().fold(builder, PlannerBuilder::system).build().map_err(|e| self.refused(&e))
    }

    /// Returns the arms that tasks tie together, and those that share joints and have a law that sees all of these.
    fn systems(&self, kinds: &Kinds, arms: &[Arm]) -> Result<Vec<JointSystem>, ScenarioError> {
        let mut systems = Vec::new();
        for (index, spec) in self.relation.iter().enumerate() {
            let at = KeyPath::dotted("relation").index(index);
            let task = spec.task(&at, kinds, arms, self.duration.value())?;
            let weight = value_or(spec.weight.as_ref(), 1.0);
            let system = JointSystem::of(&spec.arms);
            let system = system.with_task_of(&spec.arms, task, spec.priority, weight);
            systems.push(system.called(self.relation_name(index)));
        }
        let law = self.law.law(kinds, &[])?;
        if law.fast_path().is_some() {
            return Ok(systems);
        }
        let index = |name: &String| arms.iter().position(|arm| arm.name() == name);
        let mut ties: Vec<Vec<usize>> =
            self.relation.iter().map(|relation| relation.arms.iter().filter_map(index).collect()).collect();
        // A law that keeps bodies apart has to see all of them.
        if self.collision.is_some() && law.keeps_distances() {
            ties.push((0..arms.len()).collect());
        }
        for set in joint_sets(arms, &ties) {
            let arms: Vec<&Arm> = set.into_iter().map(|arm| &arms[arm]).collect();
            let law = self.law.law(kinds, &common_start(&arms))?;
            systems.push(JointSystem::of(arms.iter().map(|arm| arm.name())).with_law(law));
        }
        Ok(systems)
    }

    /// Returns the arms on their machines, with the paths that they should follow.
    ///
    /// # Errors
    /// As [`Scenario::planner`].
    pub fn arms(&self, folder: Option<&Path>) -> Result<Vec<Arm>, ScenarioError> {
        self.arms_with(&Kinds::builtin(), folder)
    }

    /// As [`Scenario::arms`], with kinds of the program's own beside the built-in ones.
    ///
    /// # Errors
    /// As [`Scenario::planner`].
    pub fn arms_with(&self, kinds: &Kinds, folder: Option<&Path>) -> Result<Vec<Arm>, ScenarioError> {
        let read = self.read_and_checked(kinds)?.with_waypoints_read(kinds, folder)?;
        read.on_machines(read.build_arms(kinds, folder).into_iter().collect::<Result<_, _>>()?)
    }

    /// Returns the row that the scenario names, or the best general one, if it may be run.
    pub(crate) fn formula_of<'t>(&self, table: &'t FormulaTable) -> Result<&'t Formula, ScenarioError> {
        let at = KeyPath::dotted("formula");
        let formula = match &self.formula {
            Some(id) => table.get(id).map_err(|e| ScenarioError::at(ErrorKind::Scenario, &at, e))?,
            None => match FormulaTable::builtin().best_for(&Duty::default()) {
                Some((formula, _)) => formula,
                None => return Err(ScenarioError::at(ErrorKind::Scenario, &at, "this key is missing")),
            },
        };
        let runnable =
            if self.allow_unstable { formula.runnable() } else { formula.runnable_with_feedback() };
        runnable.map_err(|e| ScenarioError::at(ErrorKind::Formula, &at, e))?;
        Ok(formula)
    }

    fn builder(&self, formula: &Formula) -> PlannerBuilder {
        let builder = Planner::builder()
            .formula(formula)
            .sigma(self.sigma.value())
            .duration(self.duration.value())
            .allow_unstable(self.allow_unstable)
            .start(self.start.map_or(Starter::Sufficient, Starter::from))
            .noise(self.noise.as_ref().map(NoiseSpec::noise).unwrap_or_default());
        match (&self.law.h, &self.law.gain) {
            (Some(h), _) => builder.h(h.value()),
            (None, Some(gain)) => builder.gain(gain.value()),
            (None, None) => builder,
        }
    }

    /// Returns the arms in their order. Those with a `start_pose` are built last: where they share joints with others,
    /// these are where the others have them.
    fn build_arms(&self, kinds: &Kinds, folder: Option<&Path>) -> Vec<Result<Arm, ScenarioError>> {
        let mut built: Vec<(usize, Result<Arm, ScenarioError>)> = Vec::new();
        let mut order: Vec<usize> = (0..self.arm.len()).collect();
        order.sort_by_key(|&i| self.arm[i].start_pose.is_some());
        for i in order {
            let spec = &self.arm[i];
            let on_machine = built.iter().filter(|(j, _)| self.arm[*j].is_same_machine(spec));
            let machine: Vec<&Arm> = on_machine.filter_map(|(_, arm)| arm.as_ref().ok()).collect();
            let arm = self.build_arm(spec, kinds, folder, &machine);
            built.push((i, arm));
        }
        built.sort_by_key(|(i, _)| *i);
        built.into_iter().map(|(_, arm)| arm).collect()
    }

    fn build_arm(
        &self,
        spec: &ArmSpec,
        kinds: &Kinds,
        folder: Option<&Path>,
        machine: &[&Arm],
    ) -> Result<Arm, ScenarioError> {
        let at = KeyPath::dotted("arm").key(&spec.name);
        let chain = chain(&at, spec, &self.law, folder)?.mounted(&spec.mount.pose());
        let given: Vec<f64> = spec.q0.iter().map(Real::value).collect();
        if !given.is_empty() || spec.start_pose.is_none() {
            let checked = if self.law.law(kinds, &[])?.keeps_limits() {
                chain.check_positions(&given)
            } else {
                chain.check_within_limits(&given)
            };
            checked.map_err(|problem| refused_positions(&at, &problem))?;
        }
        let held = positions_in_common(&chain, machine);
        let solve =
            |start: &StartPose| start.solve(&at, spec, (&chain, &held), (kinds, self.duration.value()));
        let found = spec.start_pose.as_ref().map(solve);
        let (q0, distance) = match found.transpose()? {
            Some(solution) => (solution.q.clone(), Some(solution.distance())),
            None => (given, None),
        };
        let start = chain.forward(&q0, &mut chain.scratch()).pose();
        let unknown =
            || ScenarioError::at(ErrorKind::Scenario, &at.key("path").key("kind"), "there is no such curve");
        let motion = match &spec.path {
            Some(path) => path.motion_with(kinds, &start, self.duration.value()).ok_or_else(unknown)?,
            None => Motion::held(&start),
        };
        let way = match spec.approach {
            Some(Approach::Reach) => reach(&at, spec, (&chain, &held), &motion, &q0)?,
            Some(Approach::Converge) | None => None,
        };
        let (q0, lead) = way.map_or((q0.clone(), None), |way| (way.q0, Some((q0, way.duration))));
        let law = self.law.law(kinds, &q0)?;
        let task = spec.task.of_motion(&at.key("task"), motion, spec.mount.pose().rotation)?;
        let mut arm = Arm::with_own_task(spec.name.clone(), chain, q0, task).with_law(law);
        if let Some(distance) = distance {
            arm = arm.with_start_distance(distance);
        }
        if let Some((from, duration)) = lead {
            arm = arm.with_lead(from, duration);
        }
        if spec.approach == Some(Approach::Converge) {
            arm = arm.converging_to(spec.approach_tolerance.as_ref().map_or(TOLERANCE, Real::value));
        }
        Ok(arm)
    }

    /// Puts arms that are parts of one machine onto it: arms of the same robot with their bases at the same place. At
    /// different places they are two of a kind.
    ///
    /// # Errors
    /// Two arms with a joint in common that shall be independent, or of which it can not be said whether they are one
    /// machine, since their bases are different links of it, or the robot is not calibrated and locked alike.
    fn on_machines(&self, arms: Vec<Arm>) -> Result<Vec<Arm>, ScenarioError> {
        let all: Vec<(&ArmSpec, &Arm)> = self.arm.iter().zip(&arms).collect();
        for (i, &own) in all.iter().enumerate() {
            let objection = all[..i].iter().find_map(|&other| objection(own, other));
            objection.map_or(Ok(()), Err)?;
        }
        // A machine is called after the first of its arms.
        let machine = |own: &ArmSpec| self.arm.iter().find(|other| other.is_same_machine(own));
        let placed = arms.into_iter().zip(self.arm.iter().map(machine));
        let arms = placed.map(|(arm, first)| arm.on_machine(first.map_or("", |first| first.name.as_str())));
        Ok(self.led_together(arms.collect()))
    }

    /// Returns the planner's refusal with the key that it is about.
    fn refused(&self, error: &PlannerError) -> ScenarioError {
        let of_arm = |arm: &str, key: &str| KeyPath::dotted("arm").key(arm).key(key);
        let feedback = if self.law.gain.is_some() { "law.gain" } else { "law.h" };
        let (kind, path) = match error {
            PlannerError::Duration { .. } => (ErrorKind::Scenario, KeyPath::dotted("duration")),
            PlannerError::Sigma { .. } | PlannerError::TooManySteps { .. } => {
                (ErrorKind::Scenario, KeyPath::dotted("sigma"))
            }
            PlannerError::Feedback { .. } | PlannerError::StepSizeOutsideRange { .. } => {
                (ErrorKind::Scenario, KeyPath::dotted(feedback))
            }
            PlannerError::Initial { arm, problem } => {
                return refused_positions(&KeyPath::dotted("arm").key(arm), problem);
            }
            PlannerError::PathStart { arm, .. } => {
                let remedy = "; `start_pose = \"path\"` has q0 solved for, `approach = \"reach\"` plans a way to the path, and with \
                              `approach = \"converge\"` the feedback brings the arm in";
                let at = of_arm(arm, "path").key("center");
                return ScenarioError::at(ErrorKind::Scenario, &at, format!("{error}{remedy}"));
            }
            PlannerError::TooFar { arm, .. } => {
                let remedy = " (`approach = \"reach\"`)";
                let at = of_arm(arm, "approach");
                return ScenarioError::at(ErrorKind::Scenario, &at, format!("{error}{remedy}"));
            }
            PlannerError::SharedStart { other, .. } => {
                let remedy = ", or the arms different mounts if there are two such robots";
                return ScenarioError::at(
                    ErrorKind::Scenario,
                    &of_arm(other, "q0"),
                    format!("{error}{remedy}"),
                );
            }
            PlannerError::NoJoints { arm, .. } => (ErrorKind::Robot, of_arm(arm, "tip")),
            PlannerError::LawDoesNotFit { .. } | PlannerError::CriterionTooFast { .. } => {
                (ErrorKind::Scenario, KeyPath::dotted("law"))
            }
            PlannerError::TaskStart { task, .. } => (ErrorKind::Scenario, self.place_of_relation(task)),
            PlannerError::NoTask { arm }
            | PlannerError::DependentTasks { arm: Some(arm), .. }
            | PlannerError::StillRows { arm: Some(arm), .. } => (ErrorKind::Scenario, of_arm(arm, "task")),
            PlannerError::DependentTasks { name, .. } | PlannerError::StillRows { name, .. } => {
                (ErrorKind::Scenario, self.place_of_relation(name))
            }
            PlannerError::Surroundings { .. } => (ErrorKind::Scenario, KeyPath::dotted("collision")),
            PlannerError::TooNear { .. } => (ErrorKind::Scenario, KeyPath::dotted("collision").key("margin")),
            PlannerError::Integrate(_) => (ErrorKind::Formula, KeyPath::dotted("formula")),
            _ => (ErrorKind::Scenario, KeyPath::default()),
        };
        if path == KeyPath::default() {
            return ScenarioError::new(kind, error.to_string());
        }
        ScenarioError::at(kind, &path, error)
    }
}

/// The joints of a chain, by their places in it, that other arms move too, and where these have them.
fn positions_in_common(chain: &Chain, arms: &[&Arm]) -> Vec<(usize, f64)> {
    let common = |(place, joint): (usize, &ChainJoint)| {
        let of = |arm: &&Arm| arm.start_of(&joint.name);
        arms.iter().find_map(of).map(|position| (place, position))
    };
    chain.joints().iter().enumerate().filter_map(common).collect()
}

/// Where the joints of a system of arms start: those of the first arm, then those of the next that are not there yet.
fn common_start(arms: &[&Arm]) -> Vec<f64> {
    let mut q0 = Vec::new();
    let mut there: HashSet<(&str, &str)> = HashSet::new();
    for arm in arms {
        for joint in arm.chain().joints() {
            let is_new = arm.machine().is_none_or(|machine| there.insert((machine, joint.name.as_str())));
            q0.extend(arm.start_of(&joint.name).filter(|_| is_new));
        }
    }
    q0
}

fn refused_positions(at: &KeyPath, problem: &PositionsError) -> ScenarioError {
    let at = at.key("q0");
    let at = problem.index().map_or(at.clone(), |index| at.index(index));
    let remedy = match problem {
        PositionsError::OutsideLimits(_) => "; laws that keep limits, such as \"qp\", bring a joint back",
        _ => "",
    };
    ScenarioError::at(ErrorKind::Scenario, &at, format!("{problem}{remedy}"))
}

/// Says why two arms with a joint in common can not be planned as they stand.
fn objection((spec, arm): (&ArmSpec, &Arm), (other_spec, other): (&ArmSpec, &Arm)) -> Option<ScenarioError> {
    let is_one = spec.is_same_machine(other_spec);
    let is_unclear = !is_one && (&spec.robot, &spec.mount) == (&other_spec.robot, &other_spec.mount);
    let apart = [spec, other_spec].into_iter().find(|own| own.independent).filter(|_| is_one);
    if !is_unclear && apart.is_none() {
        return None;
    }
    let joint = in_common(arm, other)?;
    let (key, remedy) = if is_one {
        ("independent", "leave `independent` out to share the joint, or hold it still with `lock` in both")
    } else if spec.base == other_spec.base {
        (
            "robot",
            "give them the same `calibration`, `limits`, `lock` and `assume_unlimited` to share the joint, or different mounts if \
                   there are two such robots",
        )
    } else {
        (
            "base",
            "give them the same `base` to share the joint, or different mounts if there are two such robots",
        )
    };
    let (one, two) = (&other_spec.name, &spec.name);
    let problem = format!("arms `{one}` and `{two}` both move joint `{joint}` of one robot; {remedy}");
    let at = KeyPath::dotted("arm").key(&apart.unwrap_or(spec).name).key(key);
    Some(ScenarioError::at(ErrorKind::Scenario, &at, problem))
}

/// The first joint that two arms both move.
fn in_common<'a>(arm: &'a Arm, other: &Arm) -> Option<&'a str> {
    let theirs: HashSet<&str> = other.chain().joints().iter().map(|joint| joint.name.as_str()).collect();
    arm.chain().joints().iter().map(|joint| joint.name.as_str()).find(|name| theirs.contains(name))
}

/// Returns where the robot of an arm comes from, and the robot as it is there.
pub(super) fn read_robot(
    at: &KeyPath,
    spec: &ArmSpec,
    folder: Option<&Path>,
) -> Result<(RobotSource, Robot), ScenarioError> {
    let refuse = |e: ScenarioError| ScenarioError::at(e.kind, &at.key("robot"), e.message);
    let source = RobotSource::find(&spec.robot, folder).map_err(refuse)?;
    let options = UrdfOptions { assume_unlimited: spec.assume_unlimited, ..UrdfOptions::default() };
    let robot = source.read(&options).map_err(|e| {
        let refusal = source.refusal(&e);
        let message = format!("{}: {}", at.key("robot"), refusal.message);
        let path = Some(at.key("robot")).filter(|_| refusal.kind == ErrorKind::File);
        ScenarioError { message, path, ..refusal }
    })?;
    Ok((source, robot))
}

fn chain(at: &KeyPath, spec: &ArmSpec, law: &LawSpec, folder: Option<&Path>) -> Result<Chain, ScenarioError> {
    let (source, robot) = read_robot(at, spec, folder)?;
    let (robot, tip) = spec.tooled(at, spec.changed(at, robot, law, folder)?)?;
    let chain = robot.chain(&spec.base, &tip).map_err(|e| {
        let key = if robot.link(&spec.base).is_none() { "base" } else { "tip" };
        let is_free = matches!(e, ChainError::UnsupportedJoint { .. });
        let remedy = if is_free { ", or hold the joint still with `lock`" } else { "" };
        ScenarioError::at(ErrorKind::Robot, &at.key(key), format!("robot {}: {e}{remedy}", source.label()))
    })?;
    if chain.dof() == 0 {
        let problem = format!("nothing moves between `{}` and `{}`", spec.base, spec.tip);
        return Err(ScenarioError::at(ErrorKind::Robot, &at.key("tip"), problem));
    }
    Ok(chain)
}

impl Mount {
    /// Returns the pose of the arm's base in the world.
    pub fn pose(&self) -> IsometryMatrix3<f64> {
        let [roll, pitch, yaw] = self.rpy.each_ref().map(Real::value);
        let rotation = Rotation3::from_euler_angles(roll, pitch, yaw);
        IsometryMatrix3::from_parts(Translation3::from(vector(&self.xyz)), rotation)
    }
}

impl ArmSpec {
    /// Whether two arms are parts of one machine: of the same robot, with their bases at the same place.
    pub(super) fn is_same_machine(&self, other: &Self) -> bool {
        (&self.robot, &self.base, &self.mount) == (&other.robot, &other.base, &other.mount)
            && (&self.calibration, &self.limits, &self.lock)
                == (&other.calibration, &other.limits, &other.lock)
            && self.assume_unlimited == other.assume_unlimited
    }
}

/// Two numbers are x and y.
pub(super) fn vector(numbers: &[Real]) -> Vector3<f64> {
    let number = |axis: usize| numbers.get(axis).map_or(0.0, Real::value);
    Vector3::new(number(0), number(1), number(2))
}

fn value_or(number: Option<&Real>, default: f64) -> f64 {
    number.map_or(default, Real::value)
}

impl PathSpec {
    /// Returns the motion along the path of a tip that stands at `start`, in so many seconds; nothing where its curve or
    /// its time law is not built in, or its waypoints stand in a file, which only [`Scenario::planner`] and
    /// [`Scenario::arms`] read.
    pub fn motion(&self, start: &IsometryMatrix3<f64>, duration: f64) -> Option<Motion> {
        self.motion_with(&Kinds::builtin(), start, duration)
    }

    /// As [`PathSpec::motion`], with kinds of the program's own beside the built-in ones.
    pub fn motion_with(&self, kinds: &Kinds, start: &IsometryMatrix3<f64>, duration: f64) -> Option<Motion> {
        if self.awaits_file() {
            return None;
        }
        let path = self.path(kinds, start)?;
        let time_law: Box<dyn TimeLaw> = match &self.time_law {
            Some(law) => law.law(kinds)?,
            // Waypoints with times say themselves how time runs.
            None if self.parameters.get("times").is_some() => Box::new(Linear),
            None => TimeLawSpec::new(kinds.time_laws.iter().next()?.name).law(kinds)?,
        };
        Some(match &self.center {
            Some(center) => {
                let mut place = vector(center);
                if center.len() == 2 {
                    place.z = start.translation.z;
                }
                let initial = path.initial_orientation().unwrap_or(start.rotation);
                Motion::centered(path, time_law, duration, place, initial)
            }
            None => Motion::from_pose(path, time_law, duration, start),
        })
    }

    fn path(&self, kinds: &Kinds, start: &IsometryMatrix3<f64>) -> Option<Box<dyn task::Path>> {
        let path: Box<dyn task::Path> = match kinds.curves.get(&self.kind)?.make {
            MakeCurve::FromTip(make) => make(&self.parameters, &start.translation.vector),
            MakeCurve::Centered(make) => make(&self.parameters),
            MakeCurve::Planar(make) => Box::new(Planar::new(
                make(&self.parameters),
                self.plane.unwrap_or_default(),
                value_or(self.rotation.as_ref(), 0.0),
                value_or(self.from.as_ref(), 0.0),
                value_or(self.sweep.as_ref(), std::f64::consts::TAU),
            )),
        };
        let Some(turn) = &self.turn else { return Some(path) };
        let (axis, angle) = (Unit::new_normalize(vector(&turn.axis)), turn.angle.value());
        Some(if turn.back {
            Box::new(Leaning::new(path, axis, angle))
        } else {
            Box::new(Turning::new(path, axis, angle))
        })
    }
}
