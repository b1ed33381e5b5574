//! What was found of a trajectory, as a table and as JSON.

use std::fmt::Write;

use serde::Serialize;

use super::super::output::{Show, moment};
use kinstep::planner::LimitKind;
use kinstep_files::trajectory::{
    Course, Crossing, Disagreement, Interpolation, JointFigures, Met, Straying, TimeFigures,
};
use kinstep_report::{Table, short};

#[derive(Serialize)]
pub(super) struct Checked {
    pub(super) ok: bool,
    pub(super) samples: usize,
    pub(super) duration: f64,
    pub(super) time: Clock,
    /// What of the scenario's paths is done.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) path: Option<PathChecked>,
    pub(super) arms: Vec<ArmChecked>,
    /// The arms of the scenario whose machines do not move here.
    pub(super) absent: Vec<String>,
    /// The tasks over several tips, which are not checked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) unchecked: Vec<String>,
    /// What was recognised and assumed of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) notes: Vec<String>,
    /// What is questionable about it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) warnings: Vec<String>,
    /// What failed, as sentences.
    pub(super) failures: Vec<String>,
}

#[derive(Serialize)]
pub(super) struct Clock {
    gap: f64,
    smallest_gap: f64,
    largest_gap: f64,
    even: bool,
    repeated_samples: usize,
}

#[derive(Serialize)]
pub(super) struct PathChecked {
    /// The time stamp at which the path begins.
    origin: f64,
    /// From where to where in the path's own time the samples go.
    covered: [f64; 2],
    duration: f64,
    done: bool,
}

#[derive(Serialize)]
pub(super) struct ArmChecked {
    name: String,
    interpolation: &'static str,
    joints: Vec<JointChecked>,
    limits: LimitsChecked,
    continuous: bool,
    velocities_agree: Option<bool>,
    accelerations_agree: Option<bool>,
    starts_at_rest: Option<bool>,
    ends_at_rest: Option<bool>,
    /// Whether joints that follow others do; of those that are in the file.
    followers_follow: bool,
    /// The worst norm of the task error, where there is a path to follow.
    max_error: Option<f64>,
    max_error_at: Option<f64>,
}

#[derive(Serialize)]
struct LimitsChecked {
    ok: bool,
    violations: Vec<Violation>,
    /// Limits of which the interpolation does not decide whether they are crossed.
    undecided: Vec<Undecided>,
}

#[derive(Serialize)]
struct Violation {
    joint: String,
    kind: &'static str,
    /// When the limit is first crossed.
    t: f64,
    /// The furthest value beyond it, and when.
    value: f64,
    worst_at: f64,
    limit: f64,
    /// For how long it is crossed, in all; null where that is not known.
    outside: Option<f64>,
}

#[derive(Serialize)]
struct Undecided {
    joint: String,
    kind: &'static str,
}

#[derive(Serialize)]
struct JointChecked {
    joint: String,
    lowest: f64,
    highest: f64,
    /// The fastest declared velocity.
    velocity: Option<f64>,
    /// The fastest velocity of the interpolant.
    peak_velocity: f64,
    mean_velocity: f64,
    acceleration: f64,
    jerk: f64,
    velocity_disagreement: Option<f64>,
    jumps: usize,
}

impl Clock {
    pub(super) fn of(clock: &TimeFigures) -> Self {
        Self {
            gap: clock.gap,
            smallest_gap: clock.gaps[0].value,
            largest_gap: clock.gaps[1].value,
            even: clock.is_even,
            repeated_samples: clock.repeated.map_or(0, |(count, _)| count),
        }
    }
}

impl PathChecked {
    pub(super) fn of(course: &Course) -> Self {
        let Course { origin, covered, duration } = *course;
        Self { origin, covered, duration, done: course.is_done() }
    }
}

impl From<&JointFigures> for JointChecked {
    fn from(figures: &JointFigures) -> Self {
        let size = |met: Met| met.value.abs();
        let worst = figures.worst_disagreement(LimitKind::Velocity).map_or(0.0, Disagreement::size);
        Self {
            joint: figures.joint.clone(),
            lowest: figures.positions[0].value,
            highest: figures.positions[1].value,
            velocity: figures.declared_velocity.map(size),
            peak_velocity: size(figures.velocity),
            mean_velocity: size(figures.mean_velocity),
            acceleration: size(figures.acceleration),
            jerk: size(figures.jerk),
            velocity_disagreement: figures.disagreements.as_ref().map(|_| worst),
            jumps: figures.jumps.len(),
        }
    }
}

impl From<&Crossing> for Violation {
    fn from(found: &Crossing) -> Self {
        Self {
            joint: found.joint.clone(),
            kind: found.kind.name(),
            t: found.first,
            value: found.worst.value,
            worst_at: found.worst.t,
            limit: found.limit,
            outside: found.outside,
        }
    }
}

impl LimitsChecked {
    fn of(figures: &[JointFigures]) -> Self {
        let violations: Vec<Violation> =
            figures.iter().flat_map(|figures| &figures.crossings).map(Violation::from).collect();
        let of_joint = |figures: &JointFigures| -> Vec<Undecided> {
            let undecided = |kind: &LimitKind| Undecided { joint: figures.joint.clone(), kind: kind.name() };
            figures.undecided.iter().map(undecided).collect()
        };
        let undecided = figures.iter().flat_map(of_joint).collect();
        Self { ok: violations.is_empty(), violations, undecided }
    }
}

impl ArmChecked {
    pub(super) fn new(
        name: &str,
        figures: &[JointFigures],
        straying: &[Straying],
        interpolation: Interpolation,
        error: Option<Met>,
    ) -> Self {
        let is_continuous = |figures: &JointFigures| figures.jumps.is_empty();
        let agrees = |figures: &JointFigures, kind: LimitKind| {
            figures.disagreements.as_ref()?;
            Some(figures.worst_disagreement(kind).is_none() && is_continuous(figures))
        };
        let agree = |kind: LimitKind| all(figures.iter().map(|figures| agrees(figures, kind)));
        let rests = |end: usize| all(figures.iter().map(|figures| figures.rests[end].is_rest()));
        Self {
            name: name.to_owned(),
            interpolation: interpolation.name(),
            joints: figures.iter().map(JointChecked::from).collect(),
            limits: LimitsChecked::of(figures),
            continuous: figures.iter().all(is_continuous),
            velocities_agree: agree(LimitKind::Velocity),
            accelerations_agree: agree(LimitKind::Acceleration)
                .filter(|_| interpolation == Interpolation::Quintic),
            starts_at_rest: rests(0),
            ends_at_rest: rests(1),
            followers_follow: straying.is_empty(),
            max_error: error.map(|error| error.value),
            max_error_at: error.map(|error| error.t),
        }
    }
}

impl ArmChecked {
    /// What the samples are too far apart to tell.
    fn unknown(&self) -> Option<String> {
        let declares = self.joints.iter().any(|joint| joint.velocity.is_some());
        let unknown = [
            (
                declares && self.velocities_agree.is_none(),
                "whether declared velocities are those of the positions",
            ),
            (self.starts_at_rest.is_none(), "whether it starts at rest"),
            (self.ends_at_rest.is_none(), "whether it ends at rest"),
        ];
        let unknown: Vec<&str> =
            unknown.iter().filter(|(is_unknown, _)| *is_unknown).map(|(_, what)| *what).collect();
        let name = &self.name;
        (!unknown.is_empty())
            .then(|| format!("{name}: samples this far apart do not tell {}", unknown.join(", ")))
    }
}

/// Whether all hold: not where one does not, and unknown where one is.
fn all(each: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let mut known = Some(true);
    for one in each {
        match one {
            Some(false) => return Some(false),
            Some(true) => {}
            None => known = None,
        }
    }
    known
}

impl Checked {
    fn header(&self) -> String {
        let Clock { gap, smallest_gap, largest_gap, even, .. } = &self.time;
        let evenness = if *even {
            format!("even time, {} s apart", short(*gap))
        } else {
            format!("uneven time, {} to {} s apart", short(*smallest_gap), short(*largest_gap))
        };
        let mut between: Vec<&str> = self.arms.iter().map(|arm| arm.interpolation).collect();
        between.dedup();
        let (samples, duration, between) = (self.samples, short(self.duration), between.join(", "));
        format!("{samples} samples over {duration} s, {evenness}; {between} between them\n\n")
    }

    fn table(&self) -> Table {
        let mut table = Table::new(["joint", "from", "to", "velocity", "declared", "acceleration", "jerk"]);
        for arm in &self.arms {
            for joint in &arm.joints {
                let declared = joint.velocity.map_or_else(|| "-".to_owned(), short);
                table.row([
                    format!("{}.{}", arm.name, joint.joint),
                    short(joint.lowest),
                    short(joint.highest),
                    short(joint.peak_velocity),
                    declared,
                    short(joint.acceleration),
                    short(joint.jerk),
                ]);
            }
        }
        table
    }

    /// What is known of the paths, and what is not known of the joints.
    fn remarks(&self) -> Vec<String> {
        let mut remarks = Vec::new();
        if let Some(path) = &self.path {
            if path.origin != 0.0 {
                let origin = moment(path.origin);
                remarks.push(format!(
                    "time stamps begin elsewhere: {origin} s is taken for the path's beginning"
                ));
            }
            if path.covered[1] > path.duration * (1.0 + 1e-6) {
                let duration = moment(path.duration);
                remarks.push(format!("the path ends at {duration} s: later samples are not held against it"));
            }
        }
        for arm in &self.arms {
            if let (Some(error), Some(t)) = (arm.max_error, arm.max_error_at) {
                remarks.push(format!(
                    "{}: worst task error {} at t = {} s",
                    arm.name,
                    short(error),
                    moment(t)
                ));
            }
            remarks.extend(arm.unknown());
            let mut kinds: Vec<&str> = arm.limits.undecided.iter().map(|undecided| undecided.kind).collect();
            kinds.sort_unstable();
            kinds.dedup();
            for kind in kinds {
                let joints = arm.limits.undecided.iter().filter(|undecided| undecided.kind == kind);
                let joints: Vec<&str> = joints.map(|undecided| undecided.joint.as_str()).collect();
                remarks.push(format!(
                    "{}: limits of {kind} are not decided for {}: between {} samples it steps",
                    arm.name,
                    joints.join(", "),
                    arm.interpolation
                ));
            }
        }
        remarks.extend(self.absent.iter().map(|arm| format!("{arm}: nothing of it moves here")));
        let unchecked =
            |task: &String| format!("task {task}: not checked, tasks over several tips are not yet");
        remarks.extend(self.unchecked.iter().map(unchecked));
        remarks
    }

    fn is_whole(&self) -> bool {
        let is_whole = |arm: &ArmChecked| arm.limits.undecided.is_empty() && arm.unknown().is_none();
        self.unchecked.is_empty() && self.arms.iter().all(is_whole)
    }
}

impl Show for Checked {
    fn text(&self) -> String {
        let mut text = self.header();
        text.push_str(&self.table().to_string());
        // Writing to a String can not fail.
        for remark in self.remarks() {
            let _ = writeln!(text, "{remark}");
        }
        match self.failures.as_slice() {
            [] if self.is_whole() => text.push_str("\nevery check holds\n"),
            [] => text.push_str("\nevery check that was made holds\n"),
            failures => {
                text.push('\n');
                for failure in failures {
                    let _ = writeln!(text, "FAILED  {failure}");
                }
            }
        }
        text
    }
}
