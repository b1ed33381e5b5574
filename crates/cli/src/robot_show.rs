//! `kinstep robot show`: the tree as people draw it, the chains through it, and what to ask next.

use std::collections::HashSet;
use std::fmt::Write;

use serde::Serialize;

use super::output::Show;
use super::robot::Problem;
use super::shell::{option, quoted};
use kinstep::robot::names::{printable, quote};
use kinstep::robot::{Chain, Joint, JointKind, Link, Robot};
use kinstep_report::{Table, short};

/// Most chains that are listed.
const MOST_CHAINS: usize = 50;
/// How many branches of branches are set in.
const MOST_BRANCHES: usize = 20;
/// Most joint positions in a command that is suggested.
const MOST_POSITIONS: usize = 100;

/// A robot as people and programs look at it.
#[derive(Serialize)]
pub(super) struct RobotCard {
    name: String,
    links: Vec<String>,
    roots: Vec<String>,
    tips: Vec<String>,
    joints: Vec<JointLine>,
    /// The first of the chains; all of many would fill pages, and each has as many joints as it is long.
    chains: Vec<ChainLine>,
    /// How many more there are.
    more_chains: usize,
    problems: Vec<Problem>,
    #[serde(skip)]
    rows: Vec<Row>,
    /// The robot and what was done to it, as words of a command.
    #[serde(skip)]
    asked: String,
}

/// One joint of a robot; a limit that is not known is null.
#[derive(Serialize)]
struct JointLine {
    name: String,
    kind: &'static str,
    parent: String,
    child: String,
    lower: Option<f64>,
    upper: Option<f64>,
    velocity: Option<f64>,
    acceleration: Option<f64>,
    jerk: Option<f64>,
    mimics: Option<String>,
}

/// A chain to a tip: its joints and reach; a reach that is not known is null.
#[derive(Serialize)]
struct ChainLine {
    base: String,
    tip: String,
    dof: usize,
    reach: Option<f64>,
    joints: Vec<String>,
    /// Positions within the limits, as near to zero as can be.
    #[serde(skip)]
    q: Vec<f64>,
}

/// A line of the drawn tree: the link with its branches, and the joint above it by its place.
struct Row {
    drawn: String,
    joint: Option<usize>,
}

impl RobotCard {
    pub(super) fn new(robot: &Robot, asked: String) -> Self {
        let (chains, more_chains) = chains(robot);
        let names = |links: Vec<&Link>| links.iter().map(|link| link.name.clone()).collect();
        Self {
            name: robot.name().to_owned(),
            links: names(robot.links().iter().collect()),
            roots: names(robot.roots().collect()),
            tips: names(robot.leaves().collect()),
            joints: robot.joints().iter().map(|joint| JointLine::new(robot, joint)).collect(),
            chains,
            more_chains,
            problems: robot.diagnostics().iter().map(Problem::from).collect(),
            rows: rows(robot),
            asked,
        }
    }
}

impl JointLine {
    fn new(robot: &Robot, joint: &Joint) -> Self {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let link = |index: usize| robot.links()[index].name.clone();
        Self {
            name: joint.name.clone(),
            kind: joint.kind.as_str(),
            parent: link(joint.parent),
            child: link(joint.child),
            lower: finite(joint.limits.lower),
            upper: finite(joint.limits.upper),
            velocity: finite(joint.limits.velocity),
            acceleration: finite(joint.limits.acceleration),
            jerk: finite(joint.limits.jerk),
            mimics: joint.mimic.map(|mimic| robot.joints()[mimic.driver].name.clone()),
        }
    }
}

/// The chains that something moves: to every tip from the link furthest above it that a chain reaches; and how many there
/// are beyond those that are listed.
fn chains(robot: &Robot) -> (Vec<ChainLine>, usize) {
    // Parents stand before their children: what is known of a parent is known of the way to its child.
    let mut ways: Vec<Way> = Vec::with_capacity(robot.links().len());
    let is_sound = |joint: &Joint| {
        let links = [joint.parent, joint.child].map(|link| &robot.links()[link]);
        joint.defect.is_none() && links.iter().all(|link| link.defect.is_none())
    };
    for (index, link) in robot.links().iter().enumerate() {
        let joint = link.parent_joint.map(|joint| &robot.joints()[joint]);
        let passed = joint.filter(|joint| joint.kind.is_supported() && is_sound(joint));
        ways.push(passed.map_or(Way { base: index, moves: false }, |joint| {
            let above = &ways[joint.parent];
            Way { base: above.base, moves: above.moves || joint.kind.is_movable() }
        }));
    }
    let ends = robot.links().iter().zip(&ways).filter(|(_, way)| way.moves);
    let is_tip: HashSet<&str> = robot.leaves().map(|link| link.name.as_str()).collect();
    let mut ends = ends.filter(|(link, _)| is_tip.contains(link.name.as_str()));
    let line = |(tip, way): (&Link, &Way)| {
        let chain = robot.chain(&robot.links()[way.base].name, &tip.name).ok()?;
        Some(ChainLine::new(&chain))
    };
    let listed = ends.by_ref().filter_map(line).take(MOST_CHAINS).collect();
    (listed, ends.count())
}

/// How a link is reached from above.
struct Way {
    /// Index of the link furthest above that a chain reaches.
    base: usize,
    /// Whether anything moves in between.
    moves: bool,
}

impl ChainLine {
    fn new(chain: &Chain) -> Self {
        Self {
            base: chain.base().to_owned(),
            tip: chain.tip().to_owned(),
            dof: chain.dof(),
            reach: Some(chain.reach()).filter(|reach| reach.is_finite()),
            joints: chain.joints().iter().map(|joint| joint.name.clone()).collect(),
            q: chain.position_limits().map(near_zero).collect(),
        }
    }
}

/// Zero, or the middle of the limits where zero lies outside.
fn near_zero((lower, upper): (f64, f64)) -> f64 {
    let middle = f64::midpoint(lower, upper);
    if lower <= 0.0 && 0.0 <= upper || !middle.is_finite() { 0.0 } else { (middle * 100.0).round() / 100.0 }
}

/// Draws the tree: branches where a link has several children, and one below the other where it has one. Branches of
/// branches are set in to a bound; beyond it the link is named that such a branch is on.
fn rows(robot: &Robot) -> Vec<Row> {
    let mut children = vec![0_usize; robot.links().len()];
    robot.joints().iter().for_each(|joint| children[joint.parent] += 1);
    // What stands before the children of each link.
    let mut indents = vec![String::new(); robot.links().len()];
    let mut drawn = Vec::with_capacity(robot.links().len());
    for (index, row) in robot.tree().enumerate() {
        let (joint, name) = (row.link.parent_joint, &row.link.name);
        let above = joint.map(|joint| robot.joints()[joint].parent);
        let indent = above.map_or_else(String::new, |above| indents[above].clone());
        let is_deep = indent.chars().count() >= 2 * MOST_BRANCHES;
        let branched = above.filter(|&above| children[above] > 1);
        let (mark, below) = match branched {
            Some(_) if is_deep => ("… ", ""),
            Some(_) if row.is_last => ("└ ", "  "),
            Some(_) => ("├ ", "│ "),
            None => ("", ""),
        };
        let far = branched.filter(|&above| is_deep && above + 1 != index);
        let on = far.map_or_else(String::new, |above| format!(" (on {})", robot.links()[above].name));
        drawn.push(Row { drawn: format!("{indent}{mark}{name}{on}"), joint });
        indents[index] = format!("{indent}{below}");
    }
    drawn
}

impl Show for RobotCard {
    fn text(&self) -> String {
        let mut text = format!("{}\n\n{}\n", self.heading(), self.tree());
        text.push_str(
            "Limits in rad, rad/s (revolute) or m, m/s (prismatic); - where the file gives none. A link hangs from the \
             one above it, or from the one whose branch it is on.\n",
        );
        if !self.chains.is_empty() {
            let _ = write!(text, "\n{}", self.chain_table());
        }
        if self.more_chains > 0 {
            let (more, asked) = (self.more_chains, &self.asked);
            let _ = writeln!(
                text,
                "and {more} more; one of them: kinstep robot jacobian {asked} --base LINK --tip LINK"
            );
        }
        self.suggest(&mut text);
        let loud = self.problems.iter().filter(|problem| problem.severity != "note").count();
        if loud > 0 {
            let count = if loud == 1 { "1 problem".to_owned() } else { format!("{loud} problems") };
            let _ = writeln!(text, "\n{count} in the file: see `kinstep robot check {}`.", self.asked);
        }
        text
    }
}

impl RobotCard {
    fn heading(&self) -> String {
        let fixed = self.joints.iter().filter(|joint| joint.kind == JointKind::Fixed.as_str()).count();
        let followers = self.joints.iter().filter(|joint| joint.mimics.is_some()).count();
        let following = match followers {
            0 => String::new(),
            n => format!(" ({n} of them by following another)"),
        };
        let moving = match self.joints.len() - fixed {
            1 => "1 joint that moves".to_owned(),
            n => format!("{n} joints that move"),
        };
        let (name, links) = (printable(&self.name), self.links.len());
        format!("{name}: {links} links, {moving}{following}, {fixed} fixed")
    }

    fn tree(&self) -> Table {
        let heads = ["link", "joint", "type", "lower", "upper", "velocity", "acceleration", "jerk"];
        // Most files know nothing of the last two.
        let is_known = |joint: &JointLine| joint.acceleration.or(joint.jerk).is_some();
        let columns = heads.len() - if self.joints.iter().any(is_known) { 0 } else { 2 };
        let mut table = Table::new(heads.into_iter().take(columns));
        let limit = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), short);
        for row in &self.rows {
            let Some(joint) = row.joint.map(|joint| &self.joints[joint]) else {
                let mark = if self.roots.len() > 1 { "(a root)" } else { "" };
                table.row([row.drawn.as_str(), mark]);
                continue;
            };
            let kind = joint
                .mimics
                .as_ref()
                .map_or_else(|| joint.kind.to_owned(), |driver| format!("{}, follows {driver}", joint.kind));
            let mut cells = vec![row.drawn.clone(), joint.name.clone(), kind];
            if joint.kind != JointKind::Fixed.as_str() {
                let JointLine { lower, upper, velocity, acceleration, jerk, .. } = *joint;
                cells.extend([lower, upper, velocity, acceleration, jerk].map(limit));
                cells.truncate(columns);
            }
            table.row(cells);
        }
        table
    }

    fn chain_table(&self) -> Table {
        let mut table = Table::new(["from", "to", "dof", "reach [m]", "joints"]);
        for chain in &self.chains {
            let reach = chain.reach.map_or_else(|| "-".to_owned(), short);
            let joints = between(&chain.joints);
            let dof = chain.dof.to_string();
            table.row([chain.base.clone(), chain.tip.clone(), dof, reach, joints]);
        }
        table
    }

    /// Says what can be asked next, with a command that works as it stands.
    fn suggest(&self, text: &mut String) {
        let reach = |chain: &&ChainLine| chain.reach.unwrap_or(0.0);
        let short = self.chains.iter().filter(|chain| chain.dof <= MOST_POSITIONS);
        let most = short.rev().max_by(|a, b| reach(a).total_cmp(&reach(b)));
        if let Some(chain) = most {
            let q: Vec<String> = chain.q.iter().map(f64::to_string).collect();
            let _ = writeln!(
                text,
                "\nAny two links are base and tip of a chain, in either direction, for example:\n  \
                 kinstep robot jacobian {}{}{} --q={}",
                self.asked,
                option("--base", &chain.base),
                option("--tip", &chain.tip),
                q.join(",")
            );
        }
        let is_free = |joint: &&JointLine| ["floating", "planar", "spherical"].contains(&joint.kind);
        if let Some(free) = self.joints.iter().find(is_free) {
            let _ = writeln!(
                text,
                "\nNo chain passes through {}, which is {}, unless it is held still: --lock {}",
                quote(&free.name),
                free.kind,
                quoted(&format!("{}=0", free.name))
            );
        }
    }
}

/// The first and the last of many names.
fn between(names: &[String]) -> String {
    match names {
        [first, .., last] if names.len() > 3 => format!("{first} ... {last}"),
        _ => names.join(", "),
    }
}
