//! Tables as TOML files.

use super::table::{DhConvention, DhError, DhRow, DhTable, MAX_ROWS, Names};
use crate::robot::names::{self, list, quote};
use crate::robot::report::Report;
use crate::robot::toml_table::{Entries, Value, read_toml, real, wrong_type};
use crate::robot::{Diagnostic, JointKind, Limits, degrees_suspected, millimetres_suspected};

const KEYS: [&str; 9] =
    ["name", "base", "convention", "joint", "planar", "limits", "velocity", "acceleration", "jerk"];
const ROW_KEYS: [&str; 13] = [
    "name",
    "link",
    "kind",
    "a",
    "alpha",
    "d",
    "theta",
    "offset",
    "flip",
    "limits",
    "velocity",
    "acceleration",
    "jerk",
];
const KINDS: [JointKind; 4] =
    [JointKind::Revolute, JointKind::Continuous, JointKind::Prismatic, JointKind::Fixed];

impl DhTable {
    /// Returns the table in a TOML text.
    ///
    /// At the top: `name` of the robot (empty unless given), `base` (the first link, default `base`), `convention` (`"standard"` or
    /// `"modified"`), and the rows as `[[joint]]`, each with `a`, `alpha`, `d`, `theta` (0 unless given; angles in rad or
    /// as expressions in pi), `kind` (`"revolute"`, `"continuous"`, `"prismatic"`, `"fixed"`; revolute with `limits`,
    /// continuous without, unless given), `offset` (added to `theta`, or to `d` of a prismatic row) and `flip` (the joint counts
    /// against z) as in Corke's Robotics Toolbox, `limits = [lower, upper]`, `velocity`, `acceleration`, `jerk`, `name` of the joint (default `joint1`,
    /// `joint2`, ...) and of the `link` with the row's frame (default `link1`, ..., and `tip` for the last). Or, for an arm
    /// in the plane, `planar = [1.0, 0.8]` with the lengths of its links, and the limits of all joints.
    ///
    /// # Errors
    /// [`DhError::Text`] with everything that is wrong, by place.
    pub fn from_toml(text: &str) -> Result<DhTable, DhError> {
        Self::from_toml_with_findings(text).map(|(table, _)| table)
    }

    /// Returns the table, and the doubts about it.
    pub(in crate::robot) fn from_toml_with_findings(
        text: &str,
    ) -> Result<(DhTable, Vec<Diagnostic>), DhError> {
        let (table, found) = read_toml(text, read);
        match table {
            Some(table) => Ok((table, found)),
            None => Err(DhError::Text(found)),
        }
    }
}

fn read(file: &Entries<'_, '_>, report: &mut Report<'_>) -> Option<DhTable> {
    if let Some((place, cause)) = is_something_else(file) {
        report.error(place, cause);
        return None;
    }
    file.check_keys("a table of a robot", &KEYS, report);
    let name = file.text("name", report).unwrap_or_default().to_owned();
    if let Some(problem) = names::problem(&name).filter(|_| !name.is_empty()) {
        report.error(file.place("name"), format!("`name` {problem}"));
    }
    let base = file.text("base", report).unwrap_or("base").to_owned();
    let (convention, rows) = match (file.value("planar"), file.value("joint")) {
        (Some(value), None) => {
            let place = value.span().start;
            let rows = planar(file, report)?.into_iter().map(|row| (place, row));
            (DhConvention::Modified, rows.collect())
        }
        (None, Some(value)) => {
            let (convention, rows) = (convention(file, report), rows(file, value, report)?);
            (convention?, rows)
        }
        (Some(second), Some(_)) => {
            report.error(second.span().start, "`planar` and `joint` both describe the arm; keep one of them");
            return None;
        }
        (None, None) => {
            let cause = "there is no arm in this file: write rows `[[joint]]` with a, alpha, d and theta, and \
                         `convention`, or `planar` with the lengths of the links";
            report.error(0, cause);
            return None;
        }
    };
    if !rows.iter().any(|(_, row)| row.kind.is_movable()) {
        report.error(file.place("joint"), "no row of the table moves");
    }
    if let Some((place, _)) = rows.get(MAX_ROWS) {
        let cause = format!("the table has {} rows, more than the {MAX_ROWS} that are read", rows.len());
        report.error(*place, cause);
        return None;
    }
    match Names::new(&base) {
        Ok(names) => check_names(names, &rows, convention, report),
        Err(problem) => report.error(file.place("base"), format!("`base` {problem}")),
    }
    let rows = rows.into_iter().map(|(_, row)| row).collect();
    Some(DhTable { name, base, convention, rows })
}

/// Reports the rows whose names are there already, or can not be names.
fn check_names(mut names: Names, rows: &[(usize, DhRow)], convention: DhConvention, report: &mut Report<'_>) {
    for (place, row) in rows {
        if let Err(problem) = names.take(row, convention) {
            report.error(*place, problem);
        }
    }
}

/// Says what other TOML file this is, and where that shows.
fn is_something_else(file: &Entries<'_, '_>) -> Option<(usize, String)> {
    let key = ["arm", "sigma", "formula"].into_iter().find(|key| file.value(key).is_some());
    if let Some(key) = key {
        let cause = format!(
            "a table of a robot has no key `{key}`: this looks like a scenario or a file of formulas, which \
             `kinstep plan` and `kinstep formula check` read"
        );
        return Some((file.place(key), cause));
    }
    let is_calibration = file.value("joint").is_some_and(|joint| joint.get_ref().is_table());
    is_calibration.then(|| {
        let cause = "this looks like a calibration, which goes with a robot (`calibration` of an arm, or \
                     `--calibration`); a table of a robot has rows, each begun by a line [[joint]]";
        (file.place("joint"), cause.to_owned())
    })
}

/// Returns the rows and where they stand.
fn rows(
    file: &Entries<'_, '_>,
    joints: Value<'_, '_>,
    report: &mut Report<'_>,
) -> Option<Vec<(usize, DhRow)>> {
    let Some(entries) = joints.get_ref().as_array() else {
        wrong_type("joint", "a list of rows, each begun by a line [[joint]]", joints, report);
        return None;
    };
    for key in ["limits", "velocity", "acceleration", "jerk"] {
        if file.value(key).is_some() {
            report.error(file.place(key), format!("`{key}` belongs into the rows, or beside `planar`"));
        }
    }
    let count = entries.len();
    let row = |(index, entry): (usize, Value<'_, '_>)| {
        let Some(table) = entry.get_ref().as_table() else {
            wrong_type("joint", "rows that are tables", entry, report);
            return None;
        };
        let offset = entry.span().start;
        Some((offset, row(&Entries { table, offset }, index, count, report)?))
    };
    Some(entries.iter().enumerate().filter_map(row).collect())
}

fn convention(file: &Entries<'_, '_>, report: &mut Report<'_>) -> Option<DhConvention> {
    let remedy = "\"standard\" is Rz(theta) Tz(d) Tx(a) Rx(alpha), \"modified\" (Craig) is \
                  Rx(alpha) Tx(a) Rz(theta) Tz(d)";
    if file.value("convention").is_none() {
        report.error(file.place("joint"), format!("the key `convention` is missing: {remedy}"));
        return None;
    }
    match file.text("convention", report)? {
        "standard" => Some(DhConvention::Standard),
        "modified" => Some(DhConvention::Modified),
        other => {
            let cause = format!("{} is no convention: {remedy}", quote(other));
            report.error(file.place("convention"), cause);
            None
        }
    }
}

fn planar(file: &Entries<'_, '_>, report: &mut Report<'_>) -> Option<Vec<DhRow>> {
    if file.value("convention").is_some() {
        report
            .error(file.place("convention"), "`convention` is about rows; an arm given by `planar` has none");
    }
    let lengths = file.numbers("planar", report)?;
    let limits = limits(file, report);
    let kind = default_kind(file);
    let mut rows = DhTable::planar("", &lengths).rows;
    for row in rows.iter_mut().filter(|row| row.kind.is_movable()) {
        (row.limits, row.kind) = (limits, kind);
        if let Some((key, problem)) = row.problem() {
            let key = if file.value(key).is_some() { key } else { "planar" };
            report.error(file.place(key), problem);
            return None;
        }
    }
    Some(rows)
}

fn row(table: &Entries<'_, '_>, index: usize, count: usize, report: &mut Report<'_>) -> Option<DhRow> {
    table.check_keys("a row", &ROW_KEYS, report);
    let own = |key: &str, report: &mut Report<'_>, default: String| {
        table.text(key, report).map_or(default, str::to_owned)
    };
    let joint = own("name", report, format!("joint{}", index + 1));
    let default = if index + 1 == count { "tip".to_owned() } else { format!("link{}", index + 1) };
    let link = own("link", report, default);
    let kind = kind(table, report)?;
    let [a, alpha, d, theta] = ["a", "alpha", "d", "theta"].map(|key| table.number(key, report));
    let (offset, flip) = (table.number("offset", report), table.flag("flip", report).unwrap_or(false));
    let (d, theta) = if kind.is_rotation() { (d, theta + offset) } else { (d + offset, theta) };
    let row = DhRow { joint, link, kind, a, alpha, d, theta, flip, limits: limits(table, report) };
    if let Some((key, problem)) = row.problem() {
        report.error(table.place(key), format!("joint {}: {problem}", quote(&row.joint)));
    }
    question_units(&row, table, report);
    Some(row)
}

/// Questions numbers that are likely to be in another unit.
fn question_units(row: &DhRow, table: &Entries<'_, '_>, report: &mut Report<'_>) {
    let doubts = [
        ("alpha", degrees_suspected(&[row.alpha])),
        ("theta", degrees_suspected(&[row.theta])),
        ("a", millimetres_suspected(&[row.a])),
        ("d", millimetres_suspected(&[row.d])),
        (
            "limits",
            row.kind
                .is_rotation()
                .then(|| degrees_suspected(&[row.limits.lower, row.limits.upper]))
                .flatten(),
        ),
    ];
    for (key, doubt) in doubts.into_iter().filter_map(|(key, doubt)| Some((key, doubt?))) {
        report.warning(table.place(key), format!("joint {}: `{key}`: {doubt}", quote(&row.joint)));
    }
}

fn default_kind(table: &Entries<'_, '_>) -> JointKind {
    if table.value("limits").is_some() { JointKind::Revolute } else { JointKind::Continuous }
}

fn kind(table: &Entries<'_, '_>, report: &mut Report<'_>) -> Option<JointKind> {
    if table.value("kind").is_none() {
        return Some(default_kind(table));
    }
    let word = table.text("kind", report)?;
    let kind = KINDS.into_iter().find(|kind| kind.as_str() == word);
    if kind.is_none() {
        let words = KINDS.map(JointKind::as_str);
        let suggestion = report.suggestion(word, words);
        let cause =
            format!("{} is no kind of joint{suggestion}; rows are {}", quote(word), list(&words, "or"));
        report.error(table.place("kind"), cause);
    }
    kind
}

fn limits(table: &Entries<'_, '_>, report: &mut Report<'_>) -> Limits {
    let mut limits = Limits::UNLIMITED;
    if let Some(value) = table.value("limits") {
        match value.get_ref().as_array().map(|ends| ends.iter().collect::<Vec<_>>()).as_deref() {
            Some([lower, upper]) => {
                limits.lower = real("limits[0]", lower, report).unwrap_or(limits.lower);
                limits.upper = real("limits[1]", upper, report).unwrap_or(limits.upper);
            }
            _ => wrong_type("limits", "two numbers, [lower, upper]", value, report),
        }
    }
    let mut magnitude =
        |key: &str| table.value(key).and_then(|value| real(key, value, report)).unwrap_or(f64::INFINITY);
    limits.velocity = magnitude("velocity");
    limits.acceleration = magnitude("acceleration");
    limits.jerk = magnitude("jerk");
    limits
}
