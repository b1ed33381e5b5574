//! What a scenario must satisfy before anything is looked up or computed.

use super::approach::Approach;
use super::arm_task::ArmTask;
use super::error::{ErrorKind, ScenarioError};
use super::key_path::KeyPath;
use super::kind_reader::check_length;
use super::kinds::Kinds;
use super::model::{ArmSpec, Scenario};
use super::noise_spec::NoiseSpec;
use super::path_spec::{PathSpec, TurnSpec};
use super::start_pose::{self, StartPose};
use super::study_spec::StudySpec;
use kinstep::kind::Real;
use kinstep::planner::{MAX_SAMPLE_BYTES, sample_bytes};

/// Largest length [m], angle [rad] or other number of an arm that is believed.
pub(super) const MAX_SIZE: f64 = 1e6;

pub(super) fn refuse(path: &KeyPath, problem: impl std::fmt::Display) -> ScenarioError {
    ScenarioError::at(ErrorKind::Scenario, path, problem)
}

pub(super) fn require(
    holds: bool,
    path: &KeyPath,
    problem: impl FnOnce() -> String,
) -> Result<(), ScenarioError> {
    if holds { Ok(()) } else { Err(refuse(path, problem())) }
}

impl Scenario {
    /// Checks what can be checked without the robots and the formula table: signs, ranges, names, and that each
    /// path has the parameters of its kind and no others.
    ///
    /// # Errors
    /// [`ScenarioError`] for the first thing that does not hold, with all others beside it.
    pub fn check(&self) -> Result<(), ScenarioError> {
        self.check_with(&Kinds::builtin())
    }

    /// As [`Scenario::check`], with kinds of the program's own beside the built-in ones.
    ///
    /// # Errors
    /// As [`Scenario::check`].
    pub fn check_with(&self, kinds: &Kinds) -> Result<(), ScenarioError> {
        let arms = KeyPath::dotted("arm");
        let mut found = vec![self.check_time(), self.check_law().and_then(|()| self.law.check_kinds(kinds))];
        found.extend(self.noise.as_ref().map(NoiseSpec::check));
        found.extend(self.study.as_ref().map(StudySpec::check));
        if self.problem.is_some() {
            found.push(require(self.arm.is_empty(), &arms, || {
                "a scenario has arms or a [problem], not both: take one of them away".to_owned()
            }));
            found.push(self.equations().map(|_| ()));
        } else {
            found.push(require(!self.arm.is_empty(), &arms, || {
                "a scenario needs at least one [[arm]]".to_owned()
            }));
        }
        for (index, arm) in self.arm.iter().enumerate() {
            let name = arms.index(index).key("name");
            let taken = self.arm[..index].iter().any(|other| other.name == arm.name);
            found.push(check_name(&name, &arm.name));
            found.push(require(!taken, &name, || {
                format!("two arms are called \"{}\"; each needs a name of its own", arm.name)
            }));
            found.extend(check_arm(&arms.key(&arm.name), arm, kinds));
        }
        found.extend(self.check_relations(kinds));
        found.extend(self.check_surroundings(kinds));
        // How many steps there are is worth a word only when they are numbers of seconds at all.
        if found[0].is_ok() {
            found.push(self.check_size());
        }
        ScenarioError::all(found.iter().filter_map(|found| found.as_ref().err())).map_or(Ok(()), Err)
    }

    fn check_time(&self) -> Result<(), ScenarioError> {
        let (sigma, duration) = (self.sigma.value(), self.duration.value());
        let at = KeyPath::dotted("sigma");
        require(sigma.is_finite() && sigma > 0.0, &at, || {
            let sigma = &self.sigma;
            format!("{sigma} s is not a sampling gap; give a positive number of seconds such as 0.01")
        })?;
        require(duration.is_finite() && duration > 0.0, &KeyPath::dotted("duration"), || {
            let duration = &self.duration;
            format!("{duration} s is not the length of a motion; give a positive number of seconds")
        })?;
        require(sigma <= duration, &at, || {
            let (sigma, duration) = (&self.sigma, &self.duration);
            format!("{sigma} s is longer than the motion of {duration} s; it must be at most the duration")
        })
    }

    fn check_law(&self) -> Result<(), ScenarioError> {
        let law = KeyPath::dotted("law");
        if let (Some(h), Some(gain)) = (&self.law.h, &self.law.gain) {
            let problem = format!("h = {h} and gain = {gain} say the same thing twice; give one of them");
            return Err(refuse(&law.key("gain"), problem));
        }
        if let Some(h) = &self.law.h {
            let feeds_back = h.value() > 0.0 || (h.value() == 0.0 && self.allow_unstable);
            require(feeds_back, &law.key("h"), || {
                let remedy = "set allow_unstable = true to run without feedback (h = 0)";
                format!("{h} is not a feedback step; h is positive and below the formula's h_max; {remedy}")
            })?;
        }
        if let Some(gain) = &self.law.gain {
            require(gain.value() > 0.0, &law.key("gain"), || {
                format!("{gain} 1/s is not a gain; it is positive")
            })?;
        }
        Ok(())
    }

    fn check_size(&self) -> Result<(), ScenarioError> {
        let steps = self.duration.value() / self.sigma.value();
        // A problem has components where a plan has joints.
        let components = self.problem.as_ref().map_or(0, |problem| problem.equations.len().max(1));
        let joints = components + self.arm.iter().map(|arm| arm.q0.len()).sum::<usize>();
        let bytes = sample_bytes(steps, joints, self.arm.len());
        require(bytes <= MAX_SAMPLE_BYTES, &KeyPath::dotted("sigma"), || {
            let (gigabytes, hours) = (bytes / 1e9, steps * self.arm.len() as f64 * 1e-6 / 3600.0);
            format!(
                "{} s over {} s are {steps:.3e} steps: {gigabytes:.3e} GB of trajectory and about {hours:.1e} hours; \
                 take a longer gap or a shorter motion (at most {:.0} GB)",
                self.sigma,
                self.duration,
                MAX_SAMPLE_BYTES / 1e9
            )
        })
    }
}

fn check_name(at: &KeyPath, name: &str) -> Result<(), ScenarioError> {
    let plain = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || matches!(c, '-' | '_'));
    require(plain, at, || {
        format!(
            "\"{name}\" is not a name for an arm; letters, digits, '-' and '_' are, since it heads columns of files"
        )
    })
}

/// What is found in the parts of an arm, each by itself.
fn check_arm(at: &KeyPath, arm: &ArmSpec, kinds: &Kinds) -> Vec<Result<(), ScenarioError>> {
    let mut found = vec![require(!arm.q0.is_empty() || arm.start_pose.is_some(), &at.key("q0"), || {
        "give one position per joint of the chain, or a `start_pose` that they are to be solved for"
            .to_owned()
    })];
    found.extend(arm.q0.iter().zip(0..).map(|(value, joint)| believable(&at.key("q0").index(joint), value)));
    if let Some(tolerance) = &arm.approach_tolerance {
        let at = at.key("approach_tolerance");
        found.push(require(tolerance.value() > 0.0 && tolerance.value().is_finite(), &at, || {
            format!("{tolerance} is not a tolerance; give a positive number of m or rad")
        }));
        found.push(require(arm.approach == Some(Approach::Converge), &at, || {
            "only an arm with approach = \"converge\" has a tolerance".to_owned()
        }));
    }
    let begins_by_itself = arm.path.as_ref().is_some_and(|path| path.center.is_some());
    found.push(require(arm.approach.is_none() || begins_by_itself, &at.key("approach"), || {
        "a path without `center` begins at the tip: there is nothing to approach".to_owned()
    }));
    for (name, pose) in [("mount", &arm.mount), ("tool", &arm.tool)] {
        for (key, triple) in [("xyz", &pose.xyz), ("rpy", &pose.rpy)] {
            let at = at.key(name).key(key);
            found.extend(triple.iter().zip(0..).map(|(value, axis)| believable(&at.index(axis), value)));
        }
    }
    for (joint, held) in &arm.lock {
        let at = at.key("lock").key(joint);
        found.extend(held.numbers().iter().map(|value| believable(&at, value)));
    }
    found.extend(arm.start_pose.as_ref().map(|start| check_start(&at.key("start_pose"), arm, start)));
    found.push(arm.task.check(&at.key("task")));
    found.push(check_own_path(&at.key("path"), arm, kinds));
    found
}

fn check_start(at: &KeyPath, arm: &ArmSpec, start: &StartPose) -> Result<(), ScenarioError> {
    let (xyz, rpy) = start.parts();
    if let Some(xyz) = xyz {
        check_point(&at.key("xyz"), xyz, &arm.task)?;
        for (value, axis) in xyz.iter().zip(0..) {
            believable(&at.key("xyz").index(axis), value)?;
        }
    }
    for (value, axis) in rpy.into_iter().flatten().zip(0..) {
        believable(&at.key("rpy").index(axis), value)?;
    }
    start_pose::objection(arm, start).map_or(Ok(()), |problem| Err(refuse(at, problem)))
}

/// The one rule for the size of lengths and angles: beyond it nothing of the arithmetic would be left.
pub(super) fn believable(at: &KeyPath, number: &Real) -> Result<(), ScenarioError> {
    require(number.value().is_finite(), at, || format!("{number} is not a finite number"))?;
    require(number.value().abs() <= MAX_SIZE, at, || {
        format!("{number} is beyond any arm; lengths [m] and angles [rad] are at most {MAX_SIZE} in size")
    })
}

/// An arm has a path if it has a task of its own.
fn check_own_path(at: &KeyPath, arm: &ArmSpec, kinds: &Kinds) -> Result<(), ScenarioError> {
    match &arm.path {
        Some(_) if arm.task.is_none() => Err(refuse(
            at,
            "an arm without a task of its own follows no path; take it away, or give the arm a task",
        )),
        Some(path) => check_path(at, path, &arm.task, kinds),
        None => require(arm.task.is_none(), at, || {
            "give the path of the tip, `{ kind = \"hold\" }` where it stays; only an arm with task = \"none\" has none"
                .to_owned()
        }),
    }
}

pub(super) fn check_path(
    at: &KeyPath,
    path: &PathSpec,
    task: &ArmTask,
    kinds: &Kinds,
) -> Result<(), ScenarioError> {
    path.check_kind(at, kinds, task)?;
    for (key, index, number) in path.numbers() {
        believable(&index.map_or_else(|| at.key(key), |index| at.key(key).index(index)), number)?;
    }
    path.center.as_ref().map_or(Ok(()), |center| check_point(&at.key("center"), center, task))?;
    path.turn.as_ref().map_or(Ok(()), |turn| check_turn(&at.key("turn"), turn, task))
}

fn check_point(at: &KeyPath, value: &[Real], task: &ArmTask) -> Result<(), ScenarioError> {
    check_length(at, value.len(), task.is_planar())
}

fn check_turn(at: &KeyPath, turn: &TurnSpec, task: &ArmTask) -> Result<(), ScenarioError> {
    require(task.turns(), at, || "only a task \"pose\" has an orientation to turn".to_owned())?;
    believable(&at.key("angle"), &turn.angle)?;
    let length = turn.axis.iter().map(|x| x.value() * x.value()).sum::<f64>().sqrt();
    require(length > 0.0 && length.is_finite(), &at.key("axis"), || {
        format!("an axis of length {length} points nowhere; give a direction such as [0, 0, 1]")
    })
}
