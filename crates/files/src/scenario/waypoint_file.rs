//! Waypoints in a table beside the scenario: comma-separated values with named columns.

use std::path::Path;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::arm_task::ArmTask;
use super::check::{MAX_SIZE, refuse};
use super::document::read_text;
use super::error::{ErrorKind, Place, ScenarioError, suggestion};
use super::files::{find, missing};
use super::key_path::KeyPath;
use super::kinds::Kinds;
use super::model::{ArmSpec, Scenario};
use super::path_spec::PathSpec;
use super::start_pose;
use crate::trajectory::csv_records::{Field, Records};
use kinstep::kind::Parameters;
use kinstep::math::number_text;
use kinstep::task::{TaskKind, WaypointProblem, Waypoints};

/// The columns of a table, and the list that each group of them makes.
const GROUPS: [(&str, &[&str]); 5] = [
    ("times", &["t"]),
    ("points", &["x", "y", "z"]),
    ("quaternions", &["qx", "qy", "qz", "qw"]),
    ("rpy", &["roll", "pitch", "yaw"]),
    ("rotation vectors", &["rx", "ry", "rz"]),
];

impl Scenario {
    /// Returns the scenario with the waypoints of files in its paths, in place of the names of the files.
    pub(super) fn with_waypoints_read(
        mut self,
        kinds: &Kinds,
        folder: Option<&Path>,
    ) -> Result<Self, ScenarioError> {
        for arm in &mut self.arm {
            let (at, task) = (KeyPath::dotted("arm").key(&arm.name), arm.task.clone());
            let Some(path) = arm.path.as_mut().filter(|path| path.awaits_file()) else { continue };
            path.take_waypoints(&at.key("path"), kinds, &task, folder)?;
            let objection = arm.start_pose.as_ref().and_then(|start| start_pose::objection(arm, start));
            objection.map_or(Ok(()), |problem| Err(refuse(&at.key("start_pose"), problem)))?;
        }
        for (index, relation) in self.relation.iter_mut().enumerate() {
            let at = KeyPath::dotted("relation").index(index);
            for (key, path) in [("path", &mut relation.path), ("relative", &mut relation.relative)] {
                let Some(path) = path.as_mut().filter(|path| path.awaits_file()) else { continue };
                path.take_waypoints(&at.key(key), kinds, &TaskKind::Pose.into(), folder)?;
            }
        }
        Ok(self)
    }

    /// Says where the times of waypoints are stretched or shortened to the duration of the motion; tables of waypoints are
    /// looked for from `folder`.
    pub fn timing_findings(&self, folder: Option<&Path>) -> Vec<String> {
        let Ok(read) = self.clone().with_waypoints_read(&Kinds::builtin(), folder) else { return Vec::new() };
        let duration = self.duration.value();
        let finding = |arm: &ArmSpec| {
            let path = arm.path.as_ref().filter(|path| path.time_law.is_none())?;
            let times = path.parameters.numbers("times")?;
            let span = times.last()? - times.first()?;
            let [given, taken] = [span, duration].map(number_text);
            let is_other = (span - duration).abs() > 1e-9 * duration;
            is_other.then(|| format!("arm `{}`: its waypoints take {given} s by their times and {taken} s by `duration`, which holds", arm.name))
        };
        read.arm.iter().filter_map(finding).collect()
    }
}

impl PathSpec {
    /// Takes the waypoints of the file that it names in place of the name.
    fn take_waypoints(
        &mut self,
        at: &KeyPath,
        kinds: &Kinds,
        task: &ArmTask,
        folder: Option<&Path>,
    ) -> Result<(), ScenarioError> {
        let named = self.parameters.text("file").unwrap_or_default();
        let file = find(named, folder).ok_or_else(|| {
            let missing = missing(named, folder);
            ScenarioError {
                file: None,
                ..ScenarioError::at(ErrorKind::File, &at.key("file"), missing.message)
            }
        })?;
        self.read_file(&file, task.whole())?;
        self.check_kind(at, kinds, task)
    }

    /// Takes the waypoints of a file.
    fn read_file(&mut self, file: &Path, task: TaskKind) -> Result<(), ScenarioError> {
        let text = read_text(file)?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
        let refusal = |Refused { at, message }| {
            let place = Place::of_byte(Some(file.display().to_string()), text, at);
            ScenarioError::new(ErrorKind::Scenario, message).or_placed(Some(place))
        };
        let table = Table::read(text, task).map_err(refusal)?;
        self.parameters.remove("file");
        for (list, rows) in table.lists() {
            match list {
                "times" => self.parameters.set(list, rows.into_iter().flatten().collect::<Vec<f64>>()),
                _ => self.parameters.set(list, rows),
            }
        }
        Waypoints::of(&self.parameters).map(|_| ()).map_err(|problem| refusal(table.placed(&problem)))
    }

    /// Whether the waypoints have orientations, as far as is known before a file of them is read.
    pub(super) fn has_orientations(&self) -> bool {
        is_given(&self.parameters, "rpy") || is_given(&self.parameters, "quaternions")
    }

    /// Whether its waypoints stand in a file that was not read.
    pub(super) fn awaits_file(&self) -> bool {
        is_given(&self.parameters, "file")
    }
}

fn is_given(parameters: &Parameters, name: &str) -> bool {
    parameters.get(name).is_some()
}

/// What is wrong with a table, and the byte where.
struct Refused {
    at: usize,
    message: String,
}

fn refused(at: usize, message: impl Into<String>) -> Refused {
    Refused { at, message: message.into() }
}

/// The numbers of a table, row by row, and where they stand.
struct Table {
    columns: Vec<&'static str>,
    rows: Vec<Vec<(f64, usize)>>,
    end: usize,
}

impl Table {
    fn read(text: &str, task: TaskKind) -> Result<Self, Refused> {
        let mut records = Records::new(text);
        let mut fields = Vec::new();
        if !next(&mut records, &mut fields)? {
            return Err(refused(
                0,
                "the table is empty; its first line names columns such as t, x, y, z, qx, qy, qz, qw",
            ));
        }
        let columns = columns(&fields, task)?;
        let mut table = Self { columns, rows: Vec::new(), end: text.trim_end().len() };
        while next(&mut records, &mut fields)? {
            if fields.len() != table.columns.len() {
                let (got, expected) = (fields.len(), table.columns.len());
                return Err(refused(
                    fields[0].at(),
                    format!("this row has {got} fields under {expected} columns"),
                ));
            }
            let named = fields.iter().zip(&table.columns);
            table.rows.push(named.map(|(field, column)| number(field, column)).collect::<Result<_, _>>()?);
        }
        Ok(table)
    }

    /// The lists that the columns make; rotation vectors become quaternions.
    fn lists(&self) -> Vec<(&'static str, Vec<Vec<f64>>)> {
        let mut lists = Vec::new();
        for (list, columns) in GROUPS {
            let places: Vec<Option<usize>> = columns.iter().map(|column| self.place(column)).collect();
            if places.iter().all(Option::is_none) {
                continue;
            }
            // A plane has no z.
            let of_row = |row: &Vec<(f64, usize)>| -> Vec<f64> {
                places.iter().map(|place| place.map_or(0.0, |place| row[place].0)).collect()
            };
            let rows = self.rows.iter().map(of_row);
            lists.push(match list {
                "rotation vectors" => ("quaternions", rows.map(|row| quaternion(&row)).collect()),
                _ => (list, rows.collect()),
            });
        }
        lists
    }

    fn place(&self, column: &str) -> Option<usize> {
        self.columns.iter().position(|own| *own == column)
    }

    /// What is wrong with the waypoints, where they stand in the table.
    fn placed(&self, problem: &WaypointProblem) -> Refused {
        let columns = GROUPS.iter().filter(|(list, _)| {
            *list == problem.list || problem.list == "quaternions" && *list == "rotation vectors"
        });
        let column =
            columns.flat_map(|(_, columns)| *columns).find_map(|column| Some((column, self.place(column)?)));
        let at =
            column.and_then(|(_, place)| Some(self.rows.get(problem.index)?[place].1)).unwrap_or(self.end);
        let what = match problem.list {
            "times" => "the time",
            "points" => "the position",
            _ => "the orientation",
        };
        refused(at, format!("{what} {}", problem.problem))
    }
}

fn quaternion(row: &[f64]) -> Vec<f64> {
    let rotation = Rotation3::new(Vector3::new(row[0], row[1], row[2]));
    let quaternion = UnitQuaternion::from_rotation_matrix(&rotation);
    vec![quaternion.i, quaternion.j, quaternion.k, quaternion.w]
}

/// Reads the next record, or returns false at the end.
fn next<'t>(records: &mut Records<'t>, fields: &mut Vec<Field<'t>>) -> Result<bool, Refused> {
    records.read(fields).map_err(|problem| refused(problem.at.unwrap_or(0), problem.message))
}

/// The columns that a header names.
fn columns(header: &[Field<'_>], task: TaskKind) -> Result<Vec<&'static str>, Refused> {
    let known: Vec<&'static str> = GROUPS.iter().flat_map(|(_, columns)| *columns).copied().collect();
    let mut found: Vec<&'static str> = Vec::new();
    for field in header {
        let name = field.text.trim();
        if name.parse::<f64>().is_ok() {
            let example = "x, y, z";
            return Err(refused(
                field.at(),
                format!("a number where the first line names columns, such as {example}"),
            ));
        }
        let Some(column) = known.iter().find(|column| column.eq_ignore_ascii_case(name)) else {
            let separated = if name.contains([';', '\t']) {
                "fields are separated by commas"
            } else {
                &suggestion(name, known.iter().copied())
            };
            return Err(refused(field.at(), format!("\"{name}\" is no column of waypoints; {separated}")));
        };
        if found.contains(column) {
            return Err(refused(field.at(), format!("the column {column} stands here twice")));
        }
        found.push(column);
    }
    let at = header.last().map_or(0, Field::at);
    let mut orientations = Vec::new();
    for (list, columns) in GROUPS {
        let has = |column: &&&str| found.contains(*column);
        let is_asked = list == "points" || columns.iter().any(|column| has(&column));
        let is_free = |column: &str| column == "z" && task == TaskKind::PositionXy;
        if let Some(missing) = columns.iter().find(|column| is_asked && !has(column) && !is_free(column)) {
            return Err(refused(
                at,
                format!("there is no column {missing}; {list} take {}", columns.join(", ")),
            ));
        }
        if is_asked && list != "points" && list != "times" {
            orientations.push(list);
        }
    }
    match orientations.as_slice() {
        [one, other, ..] => {
            Err(refused(at, format!("orientations stand here twice, as {one} and as {other}")))
        }
        _ => Ok(found),
    }
}

fn number(field: &Field<'_>, column: &str) -> Result<(f64, usize), Refused> {
    let (text, at) = (field.text.trim(), field.at());
    if text.is_empty() {
        return Err(refused(at, format!("{column} is missing in this row")));
    }
    let number: f64 =
        text.parse().map_err(|_| refused(at, format!("{column}: \"{text}\" is not a number")))?;
    if !number.is_finite() {
        return Err(refused(at, format!("{column}: {text} is not a finite number")));
    }
    if number.abs() > MAX_SIZE && column != "t" {
        return Err(refused(
            at,
            format!(
                "{column}: {text} is beyond any arm; lengths [m] and angles [rad] are at most {MAX_SIZE} in size"
            ),
        ));
    }
    Ok((number, at))
}
