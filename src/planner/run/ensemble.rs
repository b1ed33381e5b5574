use super::field::{Evaluated, SynchronousField};
use super::noise::{Noise, NoisyLoop};
use super::plan::{Plan, PlanStatus, Stop};
use super::record::{Description, Record};
use super::stop_criteria::{check_added_tasks, check_lost, check_start, infeasible};
use crate::integrate::{Multistep, Status};
use crate::planner::system::{JointIndex, System};
use std::collections::HashMap;
use std::ops::Range;

/// One of the plans of an ensemble.
pub(in crate::planner) struct Run {
    pub(in crate::planner) description: Description,
    /// Which arms of the ensemble are its own.
    pub(in crate::planner) arms: Range<usize>,
    pub(in crate::planner) stop: Option<Stop>,
    /// The index of the sample at which it left the ensemble, while others went on.
    left_at: Option<usize>,
}

/// Plans that advance together: one stepper, whose state holds the joints of all their arms.
pub(in crate::planner) struct Ensemble {
    stepper: Multistep<f64>,
    pub(in crate::planner) field: SynchronousField,
    pub(in crate::planner) runs: Vec<Run>,
    /// The noise that is injected into a plan of its own.
    noisy: Option<NoisyLoop>,
    /// Whether an arm has met a singularity that it has not recovered from.
    remembers: bool,
    /// The index of the sample at which the first of those that are still under way is finished.
    first_end: usize,
}

impl Ensemble {
    /// One plan. Takes a stepper whose first state has been evaluated and scattered to the arms.
    pub(in crate::planner) fn begin(
        description: Description,
        stepper: Multistep<f64>,
        field: SynchronousField,
        noise: Option<Noise>,
    ) -> Self {
        let noisy = noise.map(|noise| NoisyLoop::new(noise, stepper.state().to_vec()));
        let run = Run { description, arms: 0..field.arms.len(), stop: None, left_at: None };
        let mut ensemble = Self { stepper, field, runs: vec![run], noisy, remembers: false, first_end: 0 };
        for arm in &mut ensemble.field.arms {
            arm.observe(0.0);
        }
        ensemble.stop_what_is_infeasible(0.0);
        let stop = check_start(&mut ensemble.field.arms);
        ensemble.runs[0].stop = ensemble.runs[0].stop.take().or(stop);
        ensemble.remembers = ensemble.runs[0].stop.is_some();
        ensemble
    }

    /// Whether another ensemble can join: it advances by the same formula and gain and is at the same sample, every arm
    /// of both is resolved by itself, and no noise is injected.
    pub(in crate::planner) fn is_in_step_with(&self, other: &Self) -> bool {
        self.field.gain == other.field.gain
            && self.stepper.is_in_step_with(&other.stepper)
            && self.field.systems.len() == self.field.arms.len()
            && other.field.systems.len() == other.field.arms.len()
            && self.noisy.is_none()
            && other.noisy.is_none()
    }

    /// Joins ensembles that are [in step](Self::is_in_step_with) into one; `None` if there is none.
    pub(in crate::planner) fn join(ensembles: Vec<Self>) -> Option<Self> {
        let gain = ensembles.first()?.field.gain;
        let remembers = ensembles.iter().any(|ensemble| ensemble.remembers);
        let (mut arms, mut systems, mut runs, mut steppers) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut components = HashMap::new();
        for (which, mut ensemble) in ensembles.into_iter().enumerate() {
            let first = arms.len();
            ensemble.field.flush_to_monitors();
            for (i, joint) in ensemble.field.joints().iter().enumerate() {
                if let Some(JointIndex { arm, joint }) = *joint {
                    components.insert(JointIndex { arm: first + arm, joint }, (which, i));
                }
            }
            runs.extend(ensemble.runs.into_iter().map(|run| {
                let arms = first + run.arms.start..first + run.arms.end;
                Run { arms, ..run }
            }));
            arms.append(&mut ensemble.field.arms);
            systems.extend(ensemble.field.systems.into_iter().map(|system| system.moved_by(first)));
            steppers.push(ensemble.stepper);
        }
        let moving = moving(&runs, &systems);
        let mut field = SynchronousField::new(arms, systems, &moving, gain);
        let stepper = gathered(&steppers, &field, &components)?;
        Evaluated::again(&stepper, &mut field).scatter_to_arms();
        Some(Self { stepper, field, runs, noisy: None, remembers, first_end: 0 })
    }

    /// The index of the present sample of a plan.
    pub(in crate::planner) fn index(&self, run: usize) -> usize {
        self.runs[run].left_at.unwrap_or(self.stepper.index())
    }

    /// The time of the present sample of a plan \[s\].
    pub(in crate::planner) fn time(&self, run: usize) -> f64 {
        self.index(run) as f64 * self.runs[run].description.sigma
    }

    /// Whether a plan has reached its last sample or has stopped.
    pub(in crate::planner) fn is_finished(&self, run: usize) -> bool {
        self.runs[run].stop.is_some() || self.index(run) >= self.runs[run].description.steps
    }

    /// Whether all plans have reached their last samples or have stopped.
    pub(in crate::planner) fn are_all_finished(&self) -> bool {
        (0..self.runs.len()).all(|run| self.is_finished(run))
    }

    /// Goes to the next sample of all plans; those that are [finished](Self::is_finished) stay where they are.
    pub(in crate::planner) fn step(&mut self) {
        if self.advance() {
            match &mut self.noisy {
                None => self.field.evaluate_sample(&mut self.stepper),
                Some(noisy) => noisy.evaluate(&mut self.stepper, &mut self.field),
            }
            self.check_and_observe();
        }
    }

    /// Takes plans that are finished out of the ensemble, while others go on.
    fn retire_finished(&mut self) {
        let retires =
            |ensemble: &Self, run: usize| ensemble.runs[run].left_at.is_none() && ensemble.is_finished(run);
        let is_needed = self.runs.len() > 1
            && (0..self.runs.len()).any(|run| retires(self, run))
            && !self.are_all_finished();
        if is_needed {
            self.field.flush_to_monitors();
            Evaluated::of(&self.stepper, &mut self.field).scatter_to_arms();
            let index = self.stepper.index();
            for run in 0..self.runs.len() {
                if retires(self, run) {
                    self.runs[run].left_at = Some(index);
                }
            }
            self.regroup();
        }
        let under_way = (0..self.runs.len()).filter(|&run| !self.is_finished(run));
        self.first_end = under_way.map(|run| self.runs[run].description.steps).min().unwrap_or(0);
    }

    /// Groups the arms that still move anew, with their histories.
    fn regroup(&mut self) {
        let joints = self.field.joints().iter().enumerate();
        let components = joints.filter_map(|(i, joint)| Some(((*joint)?, (0, i)))).collect();
        let arms = std::mem::take(&mut self.field.arms);
        let systems = std::mem::take(&mut self.field.systems);
        let moving = moving(&self.runs, &systems);
        let mut field = SynchronousField::new(arms, systems, &moving, self.field.gain);
        if let Some(stepper) = gathered(std::slice::from_ref(&self.stepper), &field, &components) {
            self.stepper = stepper;
        }
        Evaluated::again(&self.stepper, &mut field).scatter_to_arms();
        self.field = field;
    }

    /// Moves on to the next sample, which is to be evaluated then; false when there is none.
    fn advance(&mut self) -> bool {
        loop {
            if self.stepper.index() >= self.first_end {
                self.retire_finished();
                if self.are_all_finished() {
                    return false;
                }
            }
            if self.stepper.step(&mut self.field) == Status::Running {
                return true;
            }
            self.stop_what_is_not_finite();
        }
    }

    /// Stops the plans whose step was not finite; they stay at their last good sample.
    fn stop_what_is_not_finite(&mut self) {
        let joints = self.field.joints();
        let arms: Vec<usize> =
            self.stepper.not_finite().filter_map(|i| joints[i].map(|joint| joint.arm)).collect();
        let t = self.stepper.time();
        Evaluated::again(&self.stepper, &mut self.field).scatter_to_arms();
        if let Some(noisy) = &self.noisy {
            noisy.look(&self.stepper, &mut self.field);
        }
        for run in &mut self.runs {
            if run.left_at.is_none() && arms.iter().any(|arm| run.arms.contains(arm)) {
                let reason =
                    format!("a joint position became infinite or NaN in the step after t = {t:.6} s");
                run.stop = Some(Stop { status: PlanStatus::NonFinite, reason });
            }
        }
        self.first_end = 0;
    }

    /// Checks and observes a sample that was evaluated.
    fn check_and_observe(&mut self) {
        let evaluated = Evaluated::of(&self.stepper, &mut self.field);
        if self.remembers {
            evaluated.scatter_to_arms();
        } else {
            match evaluated.observed() {
                Ok(()) => return,
                Err(evaluated) => evaluated.scatter_to_arms(),
            }
        }
        self.remembers = false;
        let t = self.stepper.time();
        self.stop_what_is_infeasible(t);
        for run in self.runs.iter_mut().filter(|run| run.left_at.is_none() && run.stop.is_none()) {
            let arms = &mut self.field.arms[run.arms.clone()];
            run.stop = check_lost(arms, run.description.is_stable, t).or_else(|| {
                let mut own = self.field.systems.iter().filter(|system| run.has(system));
                own.find_map(|system| check_added_tasks(system, &self.field.arms, t))
            });
            if run.stop.is_some() {
                self.first_end = 0;
                continue;
            }
            for arm in &mut self.field.arms[run.arms.clone()] {
                arm.observe(t);
                self.remembers |= arm.was_singular;
            }
        }
    }

    /// Stops the plans that could not meet what was asked for within what is allowed.
    fn stop_what_is_infeasible(&mut self, t: f64) {
        for system in &mut self.field.systems {
            let Some(reason) = system.take_infeasible() else { continue };
            let mut own = self.runs.iter_mut().filter(|run| run.has(system) && run.stop.is_none());
            if let Some(run) = own.next() {
                run.stop = Some(infeasible(system, &reason, t));
                self.first_end = 0;
            }
        }
    }

    /// Records with the first sample in them.
    fn begin_records(&self) -> Vec<Record> {
        let begin = |run: &Run| {
            let systems = self.field.systems.iter().filter(|system| run.has(system));
            Record::new(&self.field.arms[run.arms.clone()], systems, run.description.steps)
        };
        let mut records: Vec<Record> = self.runs.iter().map(begin).collect();
        for (run, record) in records.iter_mut().enumerate() {
            self.write_down(run, record);
        }
        records
    }

    /// Records the present sample of a plan.
    fn write_down(&self, run: usize, record: &mut Record) {
        let run = &self.runs[run];
        record.write_arms(run.arms.clone().map(|arm| self.field.arm(arm)));
        if record.has_tasks() {
            record.write_tasks(self.field.systems.iter().filter(|system| run.has(system)));
        }
    }

    /// Runs all plans to their ends, telling `progress` after every step how far the first is.
    pub(in crate::planner) fn run_with(mut self, mut progress: impl FnMut(usize, usize)) -> Vec<Plan> {
        let mut records = self.begin_records();
        let mut written: Vec<usize> = (0..self.runs.len()).map(|run| self.index(run)).collect();
        while !self.are_all_finished() {
            self.step();
            for (run, record) in records.iter_mut().enumerate() {
                // A sample at which a run stopped is not one to send to a robot.
                let index = self.index(run);
                if index > written[run] && self.runs[run].stop.is_none() {
                    written[run] = index;
                    self.write_down(run, record);
                    progress(index, self.runs[run].description.steps);
                }
            }
        }
        self.conclude(records)
    }

    /// The plans that came of it.
    fn conclude(mut self, records: Vec<Record>) -> Vec<Plan> {
        self.field.flush_to_monitors();
        let noise = self.noisy.as_ref().map(|noisy| *noisy.noise());
        let conclude = |(run, record): (Run, Record)| {
            let Run { description, arms, stop, .. } = run;
            let systems = self.field.systems.iter().filter(|system| system.is_within(&arms));
            Plan { noise, ..record.conclude(description, stop, &self.field.arms[arms.clone()], systems) }
        };
        self.runs.into_iter().zip(records).map(conclude).collect()
    }
}

impl Run {
    /// Whether a system is of its arms.
    fn has(&self, system: &System) -> bool {
        system.is_within(&self.arms)
    }
}

/// The systems of the plans that have not left.
fn moving(runs: &[Run], systems: &[System]) -> Vec<usize> {
    let moves = |system: &System| runs.iter().any(|run| run.left_at.is_none() && run.has(system));
    (0..systems.len()).filter(|&system| moves(&systems[system])).collect()
}

/// A stepper for `field` whose components come from where `components` says.
fn gathered(
    steppers: &[Multistep<f64>],
    field: &SynchronousField,
    components: &HashMap<JointIndex, (usize, usize)>,
) -> Option<Multistep<f64>> {
    let origin = |joint: &Option<JointIndex>| joint.and_then(|joint| components.get(&joint).copied());
    let origins: Vec<_> = field.joints().iter().map(origin).collect();
    Multistep::gathered(&steppers.iter().collect::<Vec<_>>(), &origins)
}
