//! Joint states: messages that name joints and say where they are, one after another.

use std::collections::HashMap;

use super::error::Problem;
use super::times::Times;
use super::{ArmTrajectory, ReadOptions, Trajectory};

/// A joint state.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Where it stands in the text.
    pub(super) at: Option<usize>,
    /// Its time as it is written, or in nanoseconds.
    pub(super) time: StateTime,
    pub(super) names: Vec<String>,
    pub(super) positions: Vec<f64>,
    /// Empty where they are not known.
    pub(super) velocities: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum StateTime {
    Nanoseconds(i128),
    Written(String),
}

/// The states while they are read, each set of joints by itself.
///
/// Messages may name their joints in any order. Some publishers name only a part of the joints in each message: what is kept
/// is the set of joints that has the most of the robot's, or else one that has all the others in it.
#[derive(Clone, Debug, Default)]
pub(super) struct States {
    sets: Vec<Set>,
    of_names: HashMap<Vec<String>, usize>,
}

/// The states that name the same joints.
#[derive(Clone, Debug)]
struct Set {
    /// The joints, in the order in which the first message has them.
    joints: Vec<String>,
    sorted: Vec<String>,
    times: Times,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    is_reordered: bool,
    has_gaps: bool,
}

impl States {
    pub(super) fn is_empty(&self) -> bool {
        self.sets.is_empty()
    }

    /// Adds a state.
    pub(super) fn push(&mut self, state: &State, options: &ReadOptions) -> Result<(), Problem> {
        let refuse = |message: String| Problem { message, at: state.at };
        let (joints, got) = (state.names.len(), state.positions.len());
        if joints != got {
            return Err(refuse(format!("a joint state names {joints} joints and has {got} positions")));
        }
        let place = match self.of_names.get(&state.names) {
            Some(&place) => place,
            None => self.set_of(state, options),
        };
        self.sets[place].push(state).map_err(refuse)
    }

    fn set_of(&mut self, state: &State, options: &ReadOptions) -> usize {
        let mut sorted = state.names.clone();
        sorted.sort();
        let known = self.sets.iter().position(|set| set.sorted == sorted);
        let place = known.unwrap_or(self.sets.len());
        if known.is_none() {
            let times = Times::new(options.time_unit);
            self.sets.push(Set { times, ..Set::new(state, sorted) });
        }
        self.of_names.insert(state.names.clone(), place);
        place
    }

    /// Returns the trajectory, and adds what there is to say of it.
    pub(super) fn finish(
        mut self,
        name: &str,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Trajectory, Problem> {
        let chosen = self.chosen(options)?;
        let all: usize = self.sets.iter().map(|set| set.times.len()).sum();
        let set = self.sets.swap_remove(chosen);
        let samples = set.times.len();
        if samples < all {
            let others = all - samples;
            notes.push(format!(
                "{others} of {all} joint states do not name exactly the joints {}, and are left out",
                set.joints.join(", ")
            ));
        }
        if set.is_reordered {
            notes.push(
                "joint states have their joints in an order that changes; they are taken by their names"
                    .to_owned(),
            );
        }
        if set.has_gaps && !set.velocities.is_empty() {
            notes.push("not every joint state has velocities that are numbers; they are left out".to_owned());
        }
        let velocities = if set.has_gaps { Vec::new() } else { set.velocities };
        let arm = ArmTrajectory {
            joints: set.joints,
            positions: set.positions,
            velocities,
            ..ArmTrajectory::empty(name)
        };
        Ok(Trajectory { about: None, times: set.times.finish(notes), arms: vec![arm] })
    }

    fn chosen(&self, options: &ReadOptions) -> Result<usize, Problem> {
        let has_all =
            |set: &Set, other: &Set| other.sorted.iter().all(|joint| set.sorted.binary_search(joint).is_ok());
        let covers = |set: &Set| self.sets.iter().all(|other| has_all(set, other));
        if let Some(place) = self.sets.iter().position(covers) {
            return Ok(place);
        }
        let prefix = options.prefix.as_deref().unwrap_or_default();
        let own = |set: &Set| {
            let names = set.joints.iter().map(|joint| joint.strip_prefix(prefix).unwrap_or(joint));
            names.filter(|name| options.joint(name).is_some()).count()
        };
        let most = self.sets.iter().map(own).max().unwrap_or(0);
        let mut best = (0..self.sets.len()).filter(|&place| own(&self.sets[place]) == most);
        match (best.next(), best.next()) {
            (Some(place), None) if most > 0 => Ok(place),
            _ => {
                let list = |set: &Set| format!("{} ({})", set.joints.join(" "), set.times.len());
                let sets: Vec<String> = self.sets.iter().map(list).collect();
                Err(Problem::new(format!(
                    "joint states of different joints are mixed here, and no message names all of them: {}; keep those of one \
                     publisher",
                    sets.join(", ")
                )))
            }
        }
    }
}

impl Set {
    fn new(state: &State, sorted: Vec<String>) -> Self {
        Self {
            joints: state.names.clone(),
            sorted,
            times: Times::new(None),
            positions: Vec::new(),
            velocities: Vec::new(),
            is_reordered: false,
            has_gaps: false,
        }
    }

    fn push(&mut self, state: &State) -> Result<(), String> {
        let added = match &state.time {
            StateTime::Nanoseconds(time) => self.times.push_nanoseconds(*time),
            StateTime::Written(text) => self.times.push(text),
        };
        added.map_err(|message| match state.time {
            StateTime::Nanoseconds(0) => {
                "header.stamp is zero, here and in the joint state before: these are not stamped".to_owned()
            }
            _ => message,
        })?;
        self.has_gaps |=
            state.velocities.len() != self.joints.len() || state.velocities.iter().any(|v| !v.is_finite());
        let width = self.joints.len();
        if state.names == self.joints {
            self.positions.extend(&state.positions);
            self.velocities.extend(state.velocities.iter().take(width));
            return Ok(());
        }
        self.is_reordered = true;
        for joint in &self.joints {
            let place = state.names.iter().position(|name| name == joint);
            let place = place.ok_or_else(|| format!("a joint state has `{joint}` twice or not at all"))?;
            self.positions.push(state.positions[place]);
            self.velocities.extend(state.velocities.get(place));
        }
        Ok(())
    }
}
