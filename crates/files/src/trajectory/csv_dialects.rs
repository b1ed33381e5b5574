//! How columns of tables are named: as this program does, as others do, and as rules say.

use std::collections::HashSet;

use super::column_map::{ColumnMap, Target};
use super::csv_layout::{Head, ONLY_ARM, Part, Refused, listed, no_times};
use super::quantity::Quantity;
use super::{ReadOptions, TimeUnit};

/// What a column of times may be called, the surest first.
const TIMES: [&str; 7] = ["t", "time", "timestamp", "__time", "%time", "times", "stamp"];

/// A column of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TimeColumn {
    /// The unit that its name says.
    pub(super) unit: Option<TimeUnit>,
}

/// Returns the column of times that a name stands for, if it does.
pub(super) fn time_named(name: &str) -> Option<TimeColumn> {
    let name = name.trim().to_ascii_lowercase();
    if TIMES.contains(&name.as_str()) {
        return Some(TimeColumn { unit: None });
    }
    let of_unit = |unit: TimeUnit| {
        let symbol = unit.symbol();
        let behind = [format!("_{symbol}"), format!("[{symbol}]"), format!("({symbol})")];
        let stem = behind.iter().find_map(|behind| name.strip_suffix(behind.as_str()))?;
        TIMES.contains(&stem.trim()).then_some(TimeColumn { unit: Some(unit) })
    };
    TimeUnit::ALL.into_iter().find_map(of_unit)
}

fn time_column(names: &[&str]) -> Option<usize> {
    let plain = |time: &&str| names.iter().position(|name| name.eq_ignore_ascii_case(time));
    let stamp =
        || names.iter().position(|name| name.ends_with("header.stamp") || name.ends_with("header/stamp"));
    let with_unit = || names.iter().position(|name| time_named(name).is_some());
    TIMES.iter().find_map(plain).or_else(with_unit).or_else(stamp)
}

/// Marks the column of times, or the two that have whole seconds and nanoseconds.
fn mark_time(names: &[&str], parts: &mut [Part]) {
    if let Some(time) = time_column(names) {
        parts[time] = Part::Time;
        return;
    }
    for ending in [".stamp.secs", ".stamp.sec", "/stamp/sec", "/stamp/secs"] {
        let Some(seconds) = names.iter().position(|name| name.ends_with(ending)) else { continue };
        let stem = &names[seconds][..names[seconds].len() - ending.len() + "/stamp/".len()];
        let rest = ["nsecs", "nanosec", "nanosecs"].map(|word| format!("{stem}{word}"));
        if let Some(rest) = names.iter().position(|name| rest.iter().any(|known| known == name)) {
            parts[seconds] = Part::Time;
            parts[rest] = Part::Nanoseconds;
            return;
        }
    }
}

/// `t`, then `ARM.JOINT`, or plain names of the joints of one arm.
pub(super) fn plain_parts(names: &[&str]) -> Result<Vec<Part>, Refused> {
    let known: HashSet<&str> = names.iter().copied().collect();
    let time = Some(time_column(names).ok_or_else(no_times)?);
    let is_position = |&(column, name): &(usize, &&str)| {
        Some(column) != time
            && !name.ends_with(".effort")
            && matches!(plain_part(name, &known), Plain::Joint(Quantity::Position, _))
    };
    let mut positions = names.iter().enumerate().filter(is_position);
    let is_plain = !positions.any(|(_, name)| name.contains('.'));
    let part = |(column, name): (usize, &&str)| -> Result<Part, Refused> {
        if Some(column) == time {
            return Ok(Part::Time);
        }
        if name.is_empty() || name.ends_with(".effort") {
            return Ok(Part::Other);
        }
        match plain_part(name, &known) {
            Plain::Error(_) if is_plain => Ok(Part::Error(ONLY_ARM.to_owned())),
            Plain::Error(arm) => Ok(Part::Error(arm.to_owned())),
            Plain::Joint(quantity, name) => {
                let (arm, joint) = split(name, is_plain).map_err(|message| (column, message))?;
                Ok(Part::Joint(quantity, arm.to_owned(), joint.to_owned()))
            }
        }
    };
    names.iter().enumerate().map(part).collect()
}

enum Plain<'n> {
    Joint(Quantity, &'n str),
    Error(&'n str),
}

fn plain_part<'n>(name: &'n str, known: &HashSet<&str>) -> Plain<'n> {
    let rates = [Quantity::Velocity, Quantity::Acceleration];
    for quantity in rates {
        if let Some(joint) = name.strip_suffix(quantity.suffix()) {
            return Plain::Joint(quantity, joint);
        }
    }
    let is_error = name == "error" || name.strip_suffix(".error").is_some();
    let has_rate = |quantity: Quantity| known.contains(format!("{name}{}", quantity.suffix()).as_str());
    if is_error && !rates.into_iter().any(has_rate) {
        return Plain::Error(name.strip_suffix(".error").unwrap_or_default());
    }
    Plain::Joint(Quantity::Position, name)
}

/// Returns the arm and the joint that a name means. Arms' names have no dot in them, joints' may.
fn split(name: &str, is_plain: bool) -> Result<(&str, &str), String> {
    if is_plain {
        return Ok((ONLY_ARM, name));
    }
    name.split_once('.')
        .ok_or_else(|| format!("`{name}` names no arm although other columns do; call it ARM.{name}"))
}

/// `TOPIC/JOINT/position`, as PlotJuggler exports joint states; nothing where no column is called so.
pub(super) fn slash_parts(names: &[&str]) -> Option<Vec<Part>> {
    let part = |name: &&str| {
        let joint = |quantity: Quantity| {
            let joint = name.strip_suffix(quantity.name())?.strip_suffix('/')?.rsplit('/').next()?;
            Some(Part::Joint(quantity, ONLY_ARM.to_owned(), joint.to_owned()))
        };
        Quantity::ALL.into_iter().find_map(joint).unwrap_or(Part::Other)
    };
    let mut parts: Vec<Part> = names.iter().map(part).collect();
    if !parts.iter().any(|part| matches!(part, Part::Joint(Quantity::Position, ..))) {
        return None;
    }
    mark_time(names, &mut parts);
    Some(parts)
}

/// `name.0`, `position.0`, `velocity.0` and the like: entries of joint states; nothing where no column is called so.
pub(super) fn array_parts(
    head: Head<'_>,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Option<Vec<Part>>, Refused> {
    let entry = |word: &str, name: &str| -> Option<usize> {
        let plain = name.trim_end_matches(']');
        let stem = plain.trim_end_matches(|c: char| c.is_ascii_digit());
        let number = plain[stem.len()..].parse().ok()?;
        let stem = stem.trim_end_matches(['.', '_', '[', '/']);
        let own = stem.strip_suffix(word).or_else(|| stem.strip_suffix(&format!("{word}s")))?;
        (own.is_empty() || own.ends_with(['.', '/', '_'])).then_some(number)
    };
    let mut positions: Vec<usize> = head.names.iter().filter_map(|name| entry("position", name)).collect();
    positions.sort_unstable();
    if positions.is_empty() {
        return Ok(None);
    }
    let named = |number: usize| {
        let column = head.names.iter().position(|name| entry("name", name) == Some(number))?;
        head.first.get(column).map(|name| (*name).to_owned())
    };
    let joints: Option<Vec<String>> = positions.iter().map(|&number| named(number)).collect();
    let joints = match joints {
        Some(joints) => joints,
        None => numbered(&positions, "position", options, notes).map_err(|message| (0, message))?,
    };
    let part = |name: &&str| {
        let joint = |quantity: Quantity| {
            let number = entry(quantity.name(), name)?;
            let place = positions.binary_search(&number).ok()?;
            Some(Part::Joint(quantity, ONLY_ARM.to_owned(), joints[place].clone()))
        };
        Quantity::ALL.into_iter().find_map(joint).unwrap_or(Part::Other)
    };
    let mut parts: Vec<Part> = head.names.iter().map(part).collect();
    mark_time(head.names, &mut parts);
    Ok(Some(parts))
}

/// Returns the robot's joints that such numbers count from 0 or 1, in order.
pub(super) fn numbered(
    numbers: &[usize],
    columns: &str,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<String>, String> {
    let first = numbers.first().copied().unwrap_or_default();
    let counts = first <= 1 && numbers.iter().enumerate().all(|(place, &number)| number == first + place);
    if !counts {
        return Err(format!("the columns `{columns}` have numbers that do not count from 0 or 1"));
    }
    let own = options.joints.iter().filter(|joint| !joint.follows);
    let own: Vec<&str> = own.map(|joint| joint.name.as_str()).collect();
    let count = numbers.len();
    match own.len() {
        0 => Err(format!(
            "the columns `{columns}` count {count} joints and do not name them: give the robot whose joints they are, in its \
             order, or name each by --map COLUMN=JOINT"
        )),
        known if known < count => Err(format!(
            "the columns `{columns}` count {count} joints, and the robot has {known}: {}; name each by --map COLUMN=JOINT",
            own.join(", ")
        )),
        known => {
            let names = own[..count].join(", ");
            let first = if known > count { format!(" first {count} of {known}") } else { String::new() };
            let note = format!("`{columns}` counts the robot's{first} joints in its order: {names}");
            if !notes.contains(&note) {
                notes.push(note);
            }
            Ok(own[..count].iter().map(|&name| name.to_owned()).collect())
        }
    }
}

/// What rules say.
pub(super) fn mapped_parts(
    names: &[&str],
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<Part>, Refused> {
    let rule = |name: &&str| -> Option<(&ColumnMap, String)> {
        options.map.iter().find_map(|map| Some((map, map.meant(name)?.to_owned())))
    };
    let rules: Vec<Option<(&ColumnMap, String)>> = names.iter().map(rule).collect();
    let mut parts = vec![Part::Other; names.len()];
    for map in &options.map {
        let is_own = |rule: &Option<(&ColumnMap, String)>| rule.as_ref().is_some_and(|(own, _)| *own == map);
        let columns: Vec<usize> = (0..names.len()).filter(|&column| is_own(&rules[column])).collect();
        let stars: Vec<&str> = columns
            .iter()
            .filter_map(|&column| rules[column].as_ref())
            .map(|(_, star)| star.as_str())
            .collect();
        if columns.is_empty() {
            let known = listed(names).unwrap_or_default();
            return Err((0, format!("--map {map}: no column is called so; there are {known}")));
        }
        let joints = joints_of(map, &stars, options, notes).map_err(|message| (columns[0], message))?;
        for (place, &column) in columns.iter().enumerate() {
            parts[column] = match &map.target {
                Target::Time => Part::Time,
                Target::Starred(quantity) | Target::Joint(quantity, _) => {
                    Part::Joint(*quantity, ONLY_ARM.to_owned(), joints[place].clone())
                }
            };
        }
    }
    if !parts.contains(&Part::Time) {
        mark_time(names, &mut parts);
    }
    Ok(parts)
}

/// The joints that the columns of a rule are of, by what its `*` stands for in each.
fn joints_of(
    map: &ColumnMap,
    stars: &[&str],
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Vec<String>, String> {
    if let Target::Joint(_, name) = &map.target {
        return Ok(stars.iter().map(|star| ColumnMap::joint(name, star)).collect());
    }
    let numbers: Option<Vec<usize>> = stars.iter().map(|star| star.parse().ok()).collect();
    let Some(numbers) = numbers.filter(|_| map.target != Target::Time) else {
        return Ok(stars.iter().map(|&star| star.to_owned()).collect());
    };
    let mut sorted = numbers.clone();
    sorted.sort_unstable();
    let joints = numbered(&sorted, &map.to_string(), options, notes)?;
    let place = |number: &usize| sorted.binary_search(number).unwrap_or_default();
    Ok(numbers.iter().map(|number| joints[place(number)].clone()).collect())
}
