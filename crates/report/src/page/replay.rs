//! The data of the replay: trees of the robots, and the joints' positions at some samples.

use std::fmt::Write;

use serde::Serialize;

use super::PlanPage;
use super::keyframes::keyframes;
use super::looks::{Library, Look, Looks, Surface, rows};
use super::markup::{doubles, escaped, json_in_script, singles};
use super::summary::worst_sample;
use kinstep::robot::{Joint, Robot};
use kinstep_files::trajectory::{ArmTrajectory, Machine, StagedArm};

/// How many colours there are for arms; then they begin again.
pub(super) const COLOURS: usize = 7;

#[derive(Serialize)]
struct Scene<'a> {
    /// Times of the frames \[s\], doubles.
    times: String,
    machines: Vec<Tree<'a>>,
    arms: Vec<Arm<'a>>,
    meshes: Vec<Vec<Surface>>,
}

#[derive(Serialize)]
struct Tree<'a> {
    links: usize,
    world: [f64; 12],
    rest: &'a [f64],
    joints: Vec<Branch>,
    looks: Vec<Look>,
    /// Whether links lack a shape that they should have.
    lacks: bool,
}

#[derive(Serialize)]
struct Branch {
    parent: usize,
    child: usize,
    origin: [f64; 12],
    axis: [f64; 3],
    /// `turn`, `slide` or `fixed`.
    kind: &'static str,
    /// Driver, multiplier, offset.
    #[serde(skip_serializing_if = "Option::is_none")]
    mimic: Option<(usize, f64, f64)>,
}

#[derive(Serialize)]
struct Arm<'a> {
    name: &'a str,
    colour: usize,
    machine: usize,
    tip: usize,
    /// The links between base and tip, both included.
    links: Vec<usize>,
    /// The place of each joint in its machine.
    joints: Vec<usize>,
    /// Positions [rad or m], singles, frame after frame.
    positions: String,
    /// Norms of the task errors, doubles; empty where unknown.
    errors: String,
    /// From the path to the tip \[m\], singles, three per frame; empty where unknown.
    strays: String,
}

/// The replay's part of the page; nothing where there is no robot to show.
pub(super) fn section(page: &PlanPage<'_>) -> String {
    let stage = page.recording.stage;
    if stage.machines.is_empty() {
        return String::new();
    }
    let frames = frames(page);
    let (library, looks) = Library::of(&stage.machines);
    let scene = Scene {
        times: doubles(frames.iter().map(|&n| page.recording.trajectory.times[n])),
        machines: stage.machines.iter().zip(looks).map(|(machine, looks)| Tree::of(machine, looks)).collect(),
        arms: arms(page, &frames),
        meshes: library.meshes,
    };
    // Numbers and strings can be written.
    let json = json_in_script(&serde_json::to_string(&scene).unwrap_or_default());
    let mut notes = String::new();
    for note in library.notes {
        // Writing to a String can not fail.
        let _ = write!(notes, "<li>{}</li>", escaped(&note));
    }
    let notes = if notes.is_empty() {
        String::new()
    } else {
        format!(
            "<details class=\"notes\"><summary>Shapes that are not shown</summary><ul>{notes}</ul></details>"
        )
    };
    format!("{notes}<script type=\"application/json\" id=\"scene\">{json}</script>")
}

/// The samples that are shown: even ones, and those that the page speaks of.
fn frames(page: &PlanPage<'_>) -> Vec<usize> {
    let plan = page.plan;
    let sample = |time: f64| (time / plan.sigma).round() as usize;
    let worst = plan.arms.iter().filter_map(worst_sample);
    let singular = plan.arms.iter().map(|arm| sample(arm.smallest_singular_value.1));
    let crossed = plan.arms.iter().flat_map(|arm| &arm.violations).map(|violation| sample(violation.t));
    keyframes(page.recording.trajectory.samples(), worst.chain(singular).chain(crossed))
}

fn arms<'a>(page: &PlanPage<'a>, frames: &[usize]) -> Vec<Arm<'a>> {
    let (stage, trajectory) = (page.recording.stage, page.recording.trajectory);
    let recorded = trajectory.arms.iter().zip(&stage.arms).enumerate();
    recorded
        .filter_map(|(index, (arm, staged))| {
            let robot = &stage.machines.get(staged.machine)?.robot;
            let errors = page.plan.arms.get(index).map(|arm| arm.errors.as_slice()).unwrap_or_default();
            let errors: Vec<_> = frames.iter().filter_map(|&n| errors.get(n)).collect();
            let arm = Arm {
                strays: singles(errors.iter().flat_map(|error| [error[0], error[1], error[2]])),
                errors: doubles(errors.iter().map(|error| error.norm())),
                ..Arm::of(index, arm, staged, robot, frames)?
            };
            Some(arm)
        })
        .collect()
}

impl<'a> Arm<'a> {
    fn of(
        index: usize,
        arm: &'a ArmTrajectory,
        staged: &StagedArm,
        robot: &Robot,
        frames: &[usize],
    ) -> Option<Self> {
        let link = |name: &str| robot.links().iter().position(|link| link.name == name);
        let joint = |name: &String| robot.joints().iter().position(|joint| joint.name == *name);
        let (base, tip) = (link(staged.chain.base())?, link(staged.chain.tip())?);
        Some(Self {
            name: &arm.name,
            colour: index % COLOURS,
            machine: staged.machine,
            tip,
            links: between(robot, base, tip),
            joints: arm.joints.iter().map(joint).collect::<Option<_>>()?,
            positions: singles(frames.iter().flat_map(|&n| position(arm, n).iter().copied())),
            errors: String::new(),
            strays: String::new(),
        })
    }
}

/// The positions of a sample, where there are any.
fn position(arm: &ArmTrajectory, sample: usize) -> &[f64] {
    let joints = arm.joints.len();
    arm.positions.get(sample * joints..(sample + 1) * joints).unwrap_or_default()
}

/// The links on the way between two: up from either, without what is above both.
fn between(robot: &Robot, mut a: usize, mut b: usize) -> Vec<usize> {
    let parent = |link: usize| robot.links()[link].parent_joint.map(|joint| robot.joints()[joint].parent);
    let mut links = vec![a, b];
    // Parents stand before their children: the later of two can not be above the other.
    while a != b {
        let Some(above) = parent(a.max(b)) else { break };
        if a > b {
            a = above;
        } else {
            b = above;
        }
        links.push(above);
    }
    links.sort_unstable();
    links.dedup();
    links
}

impl<'a> Tree<'a> {
    fn of(machine: &'a Machine, looks: Looks) -> Self {
        Self {
            links: machine.robot.links().len(),
            world: rows(&machine.world_from_root),
            rest: &machine.rest,
            joints: machine.robot.joints().iter().map(Branch::of).collect(),
            lacks: !looks.is_whole,
            looks: looks.shown,
        }
    }
}

impl Branch {
    fn of(joint: &Joint) -> Self {
        Self {
            parent: joint.parent,
            child: joint.child,
            origin: rows(&joint.origin),
            axis: joint.axis.into(),
            kind: match () {
                () if joint.kind.is_rotation() => "turn",
                () if joint.kind.is_movable() => "slide",
                () => "fixed",
            },
            mimic: joint.mimic.map(|mimic| (mimic.driver, mimic.multiplier, mimic.offset)),
        }
    }
}
