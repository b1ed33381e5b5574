use super::bundle::Sample;
use super::field::SynchronousField;
use super::lost::{check_lost, check_start};
use super::noise::NoisyLoop;
use super::runtime::ArmRuntime;
use super::{ArmPlan, Noise, Plan, PlanStatus, Stop};
use crate::integrate::{Field, Multistep, Status};
use nalgebra::Vector6;
use std::collections::HashMap;
use std::ops::Range;

/// What a plan says of itself.
#[derive(Clone, Debug)]
pub(super) struct Description {
    pub(super) formula: String,
    pub(super) sigma: f64,
    pub(super) h: f64,
    /// Whether `h` lies in the formula's feedback range.
    pub(super) is_stable: bool,
    pub(super) start: &'static str,
    pub(super) steps: usize,
    pub(super) warnings: Vec<String>,
}

/// One of the plans of a fleet.
pub(super) struct Course {
    pub(super) description: Description,
    /// Which arms of the fleet are its own.
    pub(super) arms: Range<usize>,
    pub(super) stop: Option<Stop>,
    /// The index of the sample at which it left the fleet, while others went on.
    left_at: Option<usize>,
}

/// Plans that advance together: one stepper, whose state holds the joints of all their arms.
pub(super) struct Fleet {
    stepper: Multistep<f64>,
    pub(super) field: SynchronousField,
    pub(super) courses: Vec<Course>,
    /// The noise that a plan of its own suffers.
    noisy: Option<NoisyLoop>,
    /// Whether an arm has met a singularity that it has not recovered from.
    remembers: bool,
    /// The index of the sample at which the first of those that are still under way is finished.
    first_end: usize,
}

/// What a stepper knows of the present sample.
fn sample(stepper: &Multistep<f64>) -> Sample<'_> {
    Sample { positions: stepper.state(), previous: stepper.previous(), velocities: stepper.derivative() }
}

impl Fleet {
    /// One plan. Takes a stepper whose first state has been evaluated and told to the arms.
    pub(super) fn begin(
        description: Description,
        stepper: Multistep<f64>,
        field: SynchronousField,
        noise: Option<Noise>,
    ) -> Self {
        let noisy = noise.map(|noise| NoisyLoop::new(noise, stepper.state().to_vec()));
        let course = Course { description, arms: 0..field.arms.len(), stop: None, left_at: None };
        let mut fleet = Self { stepper, field, courses: vec![course], noisy, remembers: false, first_end: 0 };
        fleet.field.remind(&sample(&fleet.stepper));
        for arm in &mut fleet.field.arms {
            arm.watch(0.0);
        }
        fleet.courses[0].stop = check_start(&mut fleet.field.arms);
        fleet.remembers = fleet.courses[0].stop.is_some();
        fleet
    }

    /// Whether another fleet can join: it advances by the same formula and gain and is at the same sample, and nobody shares
    /// joints or suffers noise.
    pub(super) fn is_in_step_with(&self, other: &Self) -> bool {
        self.field.gain == other.field.gain
            && self.stepper.is_in_step_with(&other.stepper)
            && self.field.shared.is_empty()
            && other.field.shared.is_empty()
            && self.noisy.is_none()
            && other.noisy.is_none()
    }

    /// Joins fleets that are [in step](Self::is_in_step_with) into one; `None` if there is none.
    pub(super) fn join(fleets: Vec<Self>) -> Option<Self> {
        let gain = fleets.first()?.field.gain;
        let remembers = fleets.iter().any(|fleet| fleet.remembers);
        let (mut arms, mut courses, mut steppers) = (Vec::new(), Vec::new(), Vec::new());
        let mut components = HashMap::new();
        for (which, mut fleet) in fleets.into_iter().enumerate() {
            let first = arms.len();
            fleet.field.hand_over();
            for (i, owner) in fleet.field.owners().iter().enumerate() {
                if let Some((arm, joint)) = *owner {
                    components.insert((first + arm, joint), (which, i));
                }
            }
            courses.extend(fleet.courses.into_iter().map(|course| {
                let arms = first + course.arms.start..first + course.arms.end;
                Course { arms, ..course }
            }));
            arms.append(&mut fleet.field.arms);
            steppers.push(fleet.stepper);
        }
        let moving = moving(&courses);
        let mut field = SynchronousField::of_moving(arms, moving, gain);
        let stepper = gathered(&steppers, &field, &components)?;
        evaluate_again(&stepper, &mut field);
        Some(Self { stepper, field, courses, noisy: None, remembers, first_end: 0 })
    }

    /// The index of the present sample of a plan.
    pub(super) fn index(&self, course: usize) -> usize {
        self.courses[course].left_at.unwrap_or(self.stepper.index())
    }

    /// The time of the present sample of a plan \[s\].
    pub(super) fn time(&self, course: usize) -> f64 {
        self.index(course) as f64 * self.courses[course].description.sigma
    }

    /// Whether a plan has reached its last sample or has stopped.
    pub(super) fn is_finished(&self, course: usize) -> bool {
        self.courses[course].stop.is_some() || self.index(course) >= self.courses[course].description.steps
    }

    /// Whether all have.
    pub(super) fn are_all_finished(&self) -> bool {
        (0..self.courses.len()).all(|course| self.is_finished(course))
    }

    /// Goes to the next sample and tells every arm what is known of it there; plans that are [finished](Self::is_finished) stay where they are.
    pub(super) fn step(&mut self) {
        if self.advance() {
            match &mut self.noisy {
                None => self.stepper.evaluate(&mut self.field),
                Some(noisy) => noisy.evaluate(&mut self.stepper, &mut self.field),
            }
            self.look_around();
        }
    }

    /// Lets plans that are finished leave, while others go on.
    fn part(&mut self) {
        self.let_leave();
        let under_way = (0..self.courses.len()).filter(|&course| !self.is_finished(course));
        self.first_end = under_way.map(|course| self.courses[course].description.steps).min().unwrap_or(0);
    }

    fn let_leave(&mut self) {
        let leaves = |fleet: &Self, course: usize| {
            fleet.courses[course].left_at.is_none() && fleet.is_finished(course)
        };
        let everyone = 0..self.courses.len();
        if everyone.len() == 1
            || !everyone.clone().any(|course| leaves(self, course))
            || self.are_all_finished()
        {
            return;
        }
        self.field.hand_over();
        self.field.tell(&sample(&self.stepper));
        let index = self.stepper.index();
        for course in everyone {
            if leaves(self, course) {
                self.courses[course].left_at = Some(index);
            }
        }
        let mut components = HashMap::new();
        for (i, owner) in self.field.owners().iter().enumerate() {
            if let Some(owner) = *owner {
                components.insert(owner, (0, i));
            }
        }
        let arms = std::mem::take(&mut self.field.arms);
        let mut field = SynchronousField::of_moving(arms, moving(&self.courses), self.field.gain);
        if let Some(stepper) = gathered(std::slice::from_ref(&self.stepper), &field, &components) {
            self.stepper = stepper;
        }
        evaluate_again(&self.stepper, &mut field);
        self.field = field;
    }

    /// Moves on to the next sample, which is to be evaluated then; false when there is none.
    fn advance(&mut self) -> bool {
        loop {
            if self.stepper.index() >= self.first_end {
                self.part();
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
        let owners = self.field.owners();
        let arms: Vec<usize> =
            self.stepper.not_finite().filter_map(|i| owners[i].map(|owner| owner.0)).collect();
        let t = self.stepper.time();
        evaluate_again(&self.stepper, &mut self.field);
        if let Some(noisy) = &self.noisy {
            noisy.look(&self.stepper, &mut self.field);
        }
        for course in &mut self.courses {
            if course.left_at.is_none() && arms.iter().any(|arm| course.arms.contains(arm)) {
                let reason =
                    format!("a joint position became infinite or NaN in the step after t = {t:.6} s");
                course.stop = Some(Stop { status: PlanStatus::NonFinite, reason });
            }
        }
        self.first_end = 0;
    }

    /// Checks and observes a sample that was evaluated.
    fn look_around(&mut self) {
        let (t, sample) = (self.stepper.time(), sample(&self.stepper));
        if !self.remembers && self.field.is_on_course() {
            self.field.watch(t, &sample);
            return;
        }
        self.field.tell(&sample);
        self.field.remind(&sample);
        self.remembers = false;
        for course in
            self.courses.iter_mut().filter(|course| course.left_at.is_none() && course.stop.is_none())
        {
            let arms = &mut self.field.arms[course.arms.clone()];
            course.stop = check_lost(arms, course.description.is_stable, t);
            if course.stop.is_some() {
                self.first_end = 0;
            } else {
                for arm in arms {
                    arm.watch(t);
                    self.remembers |= arm.was_singular;
                }
            }
        }
    }

    /// Records with the first sample in them.
    fn begin_records(&self) -> Vec<Vec<ArmPlan>> {
        let begin = |course: &Course| {
            let arms = self.field.arms[course.arms.clone()].iter();
            arms.map(|arm| empty_plan(arm, course.description.steps)).collect()
        };
        let mut records: Vec<Vec<ArmPlan>> = self.courses.iter().map(begin).collect();
        for (course, record) in records.iter_mut().enumerate() {
            self.write_down(course, record);
        }
        records
    }

    /// Records the present sample of a plan, as it was told to the arms.
    fn write_down(&self, course: usize, record: &mut [ArmPlan]) {
        for (arm, plan) in self.courses[course].arms.clone().zip(record) {
            let state = self.field.arm(arm);
            plan.positions.extend_from_slice(state.positions);
            plan.velocities.extend_from_slice(state.velocities);
            plan.errors.push(state.error);
        }
    }

    /// Runs all plans to their ends, telling `progress` after every step how far the first is.
    pub(super) fn run_with(mut self, mut progress: impl FnMut(usize, usize)) -> Vec<Plan> {
        let mut records = self.begin_records();
        let mut written: Vec<usize> = (0..self.courses.len()).map(|course| self.index(course)).collect();
        while !self.are_all_finished() {
            self.step();
            for (course, record) in records.iter_mut().enumerate() {
                // A sample at which a run stopped is not one to send to a robot.
                let index = self.index(course);
                if index > written[course] && self.courses[course].stop.is_none() {
                    written[course] = index;
                    self.write_down(course, record);
                    progress(index, self.courses[course].description.steps);
                }
            }
        }
        self.conclude(records)
    }

    /// The plans that came of it.
    fn conclude(mut self, records: Vec<Vec<ArmPlan>>) -> Vec<Plan> {
        self.field.hand_over();
        let Self { field, courses, noisy, .. } = self;
        let noise = noisy.map(|noisy| *noisy.noise());
        let conclude = |(course, record)| Plan { noise, ..conclude(course, record, &field) };
        courses.into_iter().zip(records).map(conclude).collect()
    }
}

/// The arms of the plans that have not left.
fn moving(courses: &[Course]) -> Vec<usize> {
    courses.iter().filter(|course| course.left_at.is_none()).flat_map(|course| course.arms.clone()).collect()
}

/// A stepper for `field` whose components come from where `components` says.
fn gathered(
    steppers: &[Multistep<f64>],
    field: &SynchronousField,
    components: &HashMap<(usize, usize), (usize, usize)>,
) -> Option<Multistep<f64>> {
    let origin = |owner: &Option<(usize, usize)>| owner.and_then(|owner| components.get(&owner).copied());
    let origins: Vec<_> = field.owners().iter().map(origin).collect();
    Multistep::gathered(&steppers.iter().collect::<Vec<_>>(), &origins)
}

/// Brings arms back to the present sample, after an attempt to leave it or in new company.
fn evaluate_again(stepper: &Multistep<f64>, field: &mut SynchronousField) {
    let (mut f, mut g) = (vec![0.0; field.dimension()], vec![0.0; field.dimension()]);
    field.evaluate(stepper.time(), stepper.state(), &mut f, &mut g);
    field.tell(&sample(stepper));
}

fn conclude(course: Course, mut arms: Vec<ArmPlan>, field: &SynchronousField) -> Plan {
    let Description { formula, sigma, h, start, steps, mut warnings, .. } = course.description;
    for (plan, runtime) in arms.iter_mut().zip(&field.arms[course.arms]) {
        let monitor = &runtime.monitor;
        plan.max_error = monitor.max_error();
        plan.max_error_component = monitor.max_error_component;
        plan.max_error_steady = steady_maximum(&plan.errors);
        plan.rms_error_steady = steady_mean_square(&plan.errors).sqrt();
        plan.max_position_error = monitor.max_position_error();
        plan.max_orientation_error = monitor.max_orientation_error();
        plan.smallest_singular_value = (monitor.smallest_singular_value, monitor.smallest_at);
        plan.damped_samples = monitor.damped_samples;
        plan.violations = monitor.violations(&runtime.arm.chain);
        warnings.extend(damping_warning(plan, runtime.arm.law.threshold()));
    }
    let (status, reason) = match course.stop {
        Some(stop) => (stop.status, Some(stop.reason)),
        None => (PlanStatus::Completed, None),
    };
    let shared = field.shared.iter().map(|shared| shared.report(&field.arms)).collect();
    Plan { status, reason, formula, sigma, h, start, steps, noise: None, arms, shared, warnings }
}

/// The largest norm over the second half of the samples.
fn steady_maximum(errors: &[Vector6<f64>]) -> f64 {
    errors[errors.len() / 2..].iter().map(Vector6::norm).fold(0.0, f64::max)
}

/// The mean square of the norm over the second half of the samples.
fn steady_mean_square(errors: &[Vector6<f64>]) -> f64 {
    let half = &errors[errors.len() / 2..];
    half.iter().map(Vector6::norm_squared).sum::<f64>() / half.len() as f64
}

fn damping_warning(plan: &ArmPlan, threshold: f64) -> Option<String> {
    let (smallest, at) = plan.smallest_singular_value;
    (plan.damped_samples > 1).then(|| {
        format!(
            "arm `{}` came near a singularity: damped least squares acted on {} samples; the smallest singular value was {smallest:.3e} at t = {at:.6} s (threshold {threshold:.3e})",
            plan.name, plan.damped_samples
        )
    })
}

fn empty_plan(runtime: &ArmRuntime, steps: usize) -> ArmPlan {
    let joints = runtime.arm.joint_names();
    let entries = (steps + 1) * joints.len();
    ArmPlan {
        name: runtime.arm.name.clone(),
        joints,
        positions: Vec::with_capacity(entries),
        velocities: Vec::with_capacity(entries),
        errors: Vec::with_capacity(steps + 1),
        max_error: 0.0,
        max_error_component: 0.0,
        max_error_steady: 0.0,
        rms_error_steady: 0.0,
        max_position_error: 0.0,
        max_orientation_error: 0.0,
        smallest_singular_value: (f64::INFINITY, 0.0),
        damped_samples: 0,
        violations: Vec::new(),
        start_distance: runtime.arm.start_distance,
    }
}
