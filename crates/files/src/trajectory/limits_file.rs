//! Limits of joints in a file of their own, as `MoveIt` and `ros2_control` keep them: `joint_limits.yaml`.

use super::error::{Problem, TextPlace};
use super::node::Node;
use super::yaml::documents;
use kinstep::robot::names::quote;
use kinstep::robot::{Diagnostic, Limits, LimitsError, Robot, Severity, degrees_suspected};

/// What of a joint is limited: the word, the key that says whether, and the keys of the values.
const QUANTITIES: [(&str, &str, &[&str]); 4] = [
    ("position", "has_position_limits", &["min_position", "max_position"]),
    ("velocity", "has_velocity_limits", &["max_velocity"]),
    ("acceleration", "has_acceleration_limits", &["max_acceleration"]),
    ("jerk", "has_jerk_limits", &["max_jerk"]),
];
/// What such files also hold of a joint, and kinematics does not apply.
const NOT_APPLIED: [&str; 10] = [
    "has_deceleration_limits",
    "max_deceleration",
    "has_effort_limits",
    "max_effort",
    "has_soft_limits",
    "k_position",
    "k_velocity",
    "soft_lower_limit",
    "soft_upper_limit",
    "angle_wraparound",
];
/// What stands beside the joints and is not applied either.
const BESIDE: [&str; 3] =
    ["default_velocity_scaling_factor", "default_acceleration_scaling_factor", "cartesian_limits"];

/// Limits of joints by name, to be laid over those of a [`Robot`].
///
/// ```
/// use kinstep_files::trajectory::LimitsFile;
/// let file = LimitsFile::from_yaml(
///     "joint_limits:
///   panda_joint1:
///     has_velocity_limits: true
///     max_velocity: 1.5
///     has_acceleration_limits: true
///     max_acceleration: 3.75
/// ").map_err(|found| found[0].to_string())?;
/// let (robot, notes) = file.over(&kinstep::robot::embedded::get("panda")?).map_err(|found| found[0].to_string())?;
/// let limits = robot.joint("panda_joint1").expect("it is there").limits;
/// assert_eq!((limits.velocity, limits.acceleration, limits.upper), (1.5, 3.75, 2.8973));
/// assert!(notes.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct LimitsFile {
    joints: Vec<JointEntry>,
    found: Vec<Diagnostic>,
}

/// What the file says of one joint: a value for each of lower, upper, velocity, acceleration and jerk.
#[derive(Clone, Debug)]
struct JointEntry {
    name: String,
    line: usize,
    column: usize,
    said: Vec<Said>,
}

/// One quantity of a joint.
#[derive(Clone, Debug)]
struct Said {
    /// The place in [`QUANTITIES`].
    quantity: usize,
    /// Its values; nothing where the file says that there is no limit.
    values: Option<Vec<f64>>,
}

/// Findings with their places in a text.
struct Findings<'t> {
    text: &'t str,
    found: Vec<Diagnostic>,
}

impl Findings<'_> {
    fn place(&self, byte: usize) -> (usize, usize) {
        let TextPlace { line, column, .. } = TextPlace::of_byte(self.text, byte);
        (line, column)
    }

    fn add(&mut self, severity: Severity, byte: usize, message: impl Into<String>) {
        let (line, column) = self.place(byte);
        self.found.push(Diagnostic::new(severity, line, column, message));
    }

    fn problem(&mut self, problem: Problem) {
        self.add(Severity::Error, problem.at.unwrap_or(0), problem.message);
    }
}

impl LimitsFile {
    /// Returns the limits in a YAML text: `joint_limits` with a map by joint of `has_position_limits`, `min_position`,
    /// `max_position`, `has_velocity_limits`, `max_velocity`, `has_acceleration_limits`, `max_acceleration`,
    /// `has_jerk_limits`, `max_jerk`, at the top or below the names of parameters and nodes (rad or m, s).
    ///
    /// # Errors
    /// Everything that is wrong, by place.
    pub fn from_yaml(text: &str) -> Result<Self, Vec<Diagnostic>> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut findings = Findings { text, found: Vec::new() };
        let mut read_documents = Vec::new();
        let documents = documents(text, &mut |document| {
            read_documents.push(document);
            Ok(())
        });
        let joints = match documents {
            Ok(()) => read(&read_documents, &mut findings),
            Err(problem) => {
                findings.problem(problem);
                Vec::new()
            }
        };
        let mut found = findings.found;
        found.sort_by_key(|found| (found.line, found.column));
        if found.iter().any(|found| found.severity == Severity::Error) {
            Err(found)
        } else {
            Ok(Self { joints, found })
        }
    }

    /// Returns the robot with these limits over its own, and what has to be said of that: limits that are wider than the
    /// robot's own, and what the file holds and is not applied. Where the file says that a joint has no limit of a kind, the
    /// robot's own stays.
    ///
    /// # Errors
    /// Joints that the robot does not have, with the names that it has, and limits that no joint can have.
    pub fn over(&self, robot: &Robot) -> Result<(Robot, Vec<Diagnostic>), Vec<Diagnostic>> {
        let (mut robot, mut notes, mut errors) = (robot.clone(), self.found.clone(), Vec::new());
        for entry in &self.joints {
            let at = |severity, message: String| Diagnostic::new(severity, entry.line, entry.column, message);
            let own = robot.joint(&entry.name).map_or(Limits::UNLIMITED, |joint| joint.limits);
            let (limits, said) = entry.over(&own);
            match robot.with_limits(&entry.name, limits) {
                Ok(changed) => {
                    robot = changed;
                    notes.extend(said.into_iter().map(|note| at(Severity::Note, note)));
                }
                Err(error @ LimitsError::NoPosition { .. }) => {
                    notes.push(at(Severity::Note, error.to_string()));
                }
                Err(error) => errors.push(at(Severity::Error, error.to_string())),
            }
        }
        if errors.is_empty() { Ok((robot, notes)) } else { Err(errors) }
    }
}

impl JointEntry {
    /// The limits of this entry over a joint's own, and what has to be said of it.
    fn over(&self, own: &Limits) -> (Limits, Vec<String>) {
        let (mut limits, mut notes) = (*own, Vec::new());
        for Said { quantity, values } in &self.said {
            let (word, key, _) = QUANTITIES[*quantity];
            let own_values = of_quantity(own, *quantity);
            let Some(values) = values else {
                if own_values.iter().any(|limit| limit.is_finite()) {
                    notes.push(format!(
                        "joint {}: `{key}` is false, and the robot's own {word} limit stays",
                        quote(&self.name)
                    ));
                }
                continue;
            };
            if is_wider(values, &own_values) {
                notes.push(format!(
                    "joint {}: the {word} limit {} is wider than the robot's own {}, and counts",
                    quote(&self.name),
                    range(values),
                    range(&own_values)
                ));
            }
            set_quantity(&mut limits, *quantity, values);
        }
        (limits, notes)
    }
}

fn range(values: &[f64]) -> String {
    values.iter().map(f64::to_string).collect::<Vec<_>>().join(" to ")
}

/// Whether limits allow more than a joint's own do.
fn is_wider(values: &[f64], own: &[f64]) -> bool {
    match (values, own) {
        ([lower, upper], [own_lower, own_upper]) => lower < own_lower || upper > own_upper,
        ([most], [own]) => most > own,
        _ => false,
    }
}

fn of_quantity(limits: &Limits, quantity: usize) -> Vec<f64> {
    match quantity {
        0 => vec![limits.lower, limits.upper],
        1 => vec![limits.velocity],
        2 => vec![limits.acceleration],
        _ => vec![limits.jerk],
    }
}

fn set_quantity(limits: &mut Limits, quantity: usize, values: &[f64]) {
    match (quantity, values) {
        (0, &[lower, upper]) => (limits.lower, limits.upper) = (lower, upper),
        (1, &[most]) => limits.velocity = most,
        (2, &[most]) => limits.acceleration = most,
        (3, &[most]) => limits.jerk = most,
        _ => {}
    }
}

/// The map that holds `joint_limits`, at the top or below other names.
fn holder<'a, 't>(node: &'a Node<'t>) -> Option<&'a Node<'t>> {
    let Node::Map(entries, _) = node else { return None };
    if node.get("joint_limits").is_some() {
        Some(node)
    } else {
        entries.iter().find_map(|(_, node)| holder(node))
    }
}

fn read(documents: &[Node<'_>], findings: &mut Findings<'_>) -> Vec<JointEntry> {
    let Some(top) = documents.iter().find_map(holder) else {
        findings.add(
            Severity::Error,
            0,
            "`joint_limits` is missing here: a map of joints to their limits, as MoveIt's",
        );
        return Vec::new();
    };
    if let Node::Map(entries, _) = top {
        for (key, node) in entries.iter().filter(|(key, _)| key != "joint_limits") {
            if BESIDE.contains(&key.as_ref()) {
                findings.add(Severity::Note, node.at(), format!("{} is not applied", quote(key)));
            } else {
                let known: Vec<&str> = std::iter::once("joint_limits").chain(BESIDE).collect();
                unknown("a file of limits", key, node, &known, findings);
            }
        }
    }
    let Some(Node::Map(joints, _)) = top.get("joint_limits") else {
        findings.add(Severity::Error, top.at(), "`joint_limits` has to be a map of joints");
        return Vec::new();
    };
    let mut read: Vec<JointEntry> = Vec::new();
    for (name, node) in joints {
        if read.iter().any(|other| other.name == *name) {
            findings.add(
                Severity::Error,
                node.at(),
                format!("joint {} stands twice; remove one", quote(name)),
            );
        }
        read.push(joint(name, node, findings));
    }
    read
}

fn unknown(what: &str, key: &str, node: &Node<'_>, known: &[&str], findings: &mut Findings<'_>) {
    let likeness = |known: &&&str| strsim::normalized_damerau_levenshtein(key, known);
    let nearest = known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    let hint = match nearest.filter(|nearest| likeness(nearest) > 0.6) {
        Some(nearest) => format!("; did you mean `{nearest}`?"),
        None => format!("; it has {}", listed(known)),
    };
    findings.add(Severity::Error, node.at(), format!("{what} has no key {}{hint}", quote(key)));
}

fn listed(keys: &[&str]) -> String {
    keys.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ")
}

fn joint(name: &str, node: &Node<'_>, findings: &mut Findings<'_>) -> JointEntry {
    let (line, column) = findings.place(node.at());
    let mut entry = JointEntry { name: name.to_owned(), line, column, said: Vec::new() };
    let Node::Map(entries, _) = node else {
        findings.add(
            Severity::Error,
            node.at(),
            format!("joint {}: expected a map of its limits", quote(name)),
        );
        return entry;
    };
    let own_keys =
        || QUANTITIES.iter().flat_map(|(_, has, values)| std::iter::once(has).chain(values.iter()));
    for (place, (key, value)) in entries.iter().enumerate() {
        if entries[..place].iter().any(|(other, _)| other == key) {
            let message = format!("joint {}: {} stands twice; remove one", quote(name), quote(key));
            findings.add(Severity::Error, value.at(), message);
        }
        if NOT_APPLIED.contains(&key.as_ref()) {
            // That there is none of what is not applied needs no word.
            if !value.text().is_ok_and(|text| text.eq_ignore_ascii_case("false")) && key.starts_with("has_") {
                findings.add(
                    Severity::Note,
                    value.at(),
                    format!("joint {}: {} is not applied", quote(name), quote(key)),
                );
            }
        } else if !own_keys().any(|known| known == key) {
            let known: Vec<&str> = own_keys().copied().collect();
            unknown(&format!("joint {}", quote(name)), key, value, &known, findings);
        }
    }
    entry.said = (0..QUANTITIES.len()).filter_map(|quantity| said(name, quantity, node, findings)).collect();
    entry
}

/// What is said of one quantity.
fn said(name: &str, quantity: usize, node: &Node<'_>, findings: &mut Findings<'_>) -> Option<Said> {
    let (word, has, keys) = QUANTITIES[quantity];
    let given: Vec<&Node<'_>> = keys.iter().filter_map(|key| node.get(key)).collect();
    match node.get(has).map(|flag| (flag, flag.text().unwrap_or_default().to_ascii_lowercase())) {
        None => {
            if let Some(first) = given.first() {
                let message =
                    format!("joint {}: its {word} limit does nothing without `{has}: true`", quote(name));
                findings.add(Severity::Note, first.at(), message);
            }
            None
        }
        Some((_, text)) if text == "false" => Some(Said { quantity, values: None }),
        Some((flag, text)) if text == "true" => {
            if given.len() < keys.len() {
                let message = format!("joint {}: with `{has}: true` it needs {}", quote(name), listed(keys));
                findings.add(Severity::Error, flag.at(), message);
                return None;
            }
            let values: Result<Vec<f64>, Problem> = given.iter().map(|node| node.number()).collect();
            let values = values.map_err(|problem| findings.problem(problem)).ok()?;
            if let Some(doubt) = degrees_suspected(&values).filter(|_| quantity == 0) {
                findings.add(
                    Severity::Warning,
                    given[0].at(),
                    format!("joint {}: a position limit of {doubt}", quote(name)),
                );
            }
            Some(Said { quantity, values: Some(values) })
        }
        Some((flag, _)) => {
            findings.add(
                Severity::Error,
                flag.at(),
                format!("joint {}: `{has}` is true or false", quote(name)),
            );
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::robot::embedded;

    fn errors(text: &str) -> Vec<String> {
        let panda = embedded::get("panda").unwrap();
        let result = LimitsFile::from_yaml(text).and_then(|file| file.over(&panda));
        result.unwrap_err().iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_lacks_is_added_and_what_is_wider_is_said() {
        let text = "robot:\n  ros__parameters:\n    default_velocity_scaling_factor: 0.1\n    joint_limits:\n      panda_joint1:\n        \
                    has_velocity_limits: true\n        max_velocity: 9.0\n        has_jerk_limits: true\n        max_jerk: 7500\n        \
                    max_acceleration: 3\n        has_position_limits: false\n      panda_joint2: {has_position_limits: true, min_position: -90, max_position: 0.5}\n";
        let panda = embedded::get("panda").unwrap();
        let (robot, notes) = LimitsFile::from_yaml(text).unwrap().over(&panda).unwrap();
        let limits = |joint: &str| robot.joint(joint).unwrap().limits;
        assert_eq!((limits("panda_joint1").velocity, limits("panda_joint1").jerk), (9.0, 7500.0));
        assert_eq!(
            (limits("panda_joint1").acceleration, limits("panda_joint1").upper),
            (f64::INFINITY, 2.8973)
        );
        assert_eq!((limits("panda_joint2").lower, limits("panda_joint2").upper), (-90.0, 0.5));
        let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
        for part in [
            "`default_velocity_scaling_factor` is not applied",
            "velocity limit 9 is wider than the robot's own",
            "its acceleration limit does nothing without `has_acceleration_limits: true`",
            "`has_position_limits` is false, and the robot's own position limit stays",
            "warning: joint `panda_joint2`: a position limit of -90 looks like degrees",
        ] {
            assert!(notes.iter().any(|note| note.contains(part)), "{part}: {notes:#?}");
        }
    }

    #[test]
    fn what_is_not_known_or_can_not_be_is_refused_with_its_place() {
        assert!(errors("limits: 3")[0].contains("`joint_limits` is missing"));
        let found = errors("joint_limits:\n  panda_joint1: {has_velocity_limit: true}\n");
        assert_eq!(
            found,
            [
                "2:38: error: joint `panda_joint1` has no key `has_velocity_limit`; did you mean `has_velocity_limits`?"
            ]
        );
        let found = errors(
            "joint_limits:\n  panda_joint1: {has_velocity_limits: true, max_velocity: 0.5, max_velocity: 0.7}\n",
        );
        assert!(found[0].contains("`max_velocity` stands twice"), "{found:?}");
        let found = errors("joint_limits:\n  elbow: {has_velocity_limits: true, max_velocity: 1}\n");
        assert!(
            found[0]
                .starts_with("2:10: error: the robot has no joint `elbow`; its joints are `panda_joint1`"),
            "{found:?}"
        );
        assert!(
            errors("joint_limits:\n  panda_joint1: {has_velocity_limits: true, max_velocity: -1}\n")[0]
                .contains("lets it never move")
        );
        assert!(
            errors("joint_limits:\n  panda_joint1: {has_velocity_limits: true}\n")[0]
                .contains("it needs `max_velocity`")
        );
    }
}
