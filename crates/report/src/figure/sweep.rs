//! What came of a sweep: a map of two keys, lines along one, distributions of what was drawn.

use super::axis::{Axis, Scale};
use super::figure::{Cell, Figure, Mark, Shape};
use crate::short;
use kinstep_study::sweep::{SweepRow, SweepTable};

/// What is drawn of every case, and what axes call it.
const MEASURE: &str = "max_error";
const MEASURED: &str = "largest task error [m, rad]";
/// A key with so many values, out of order, was drawn from a distribution.
const MANY: usize = 8;
/// The most maps of one sweep, and the most lines of a figure.
const MOST_MAPS: usize = 8;
const MOST_LINES: usize = 12;
/// The most points of a figure: more are a cloud anyway.
const MOST_POINTS: usize = 1500;
/// Bars of a histogram.
const BARS: usize = 24;
/// A range that is so many times longer than its beginning is drawn by powers of ten.
const DECADES: f64 = 15.0;

/// A key with its values, in the order in which they come.
#[derive(Debug, Clone)]
struct Key {
    name: String,
    /// Where a row has it; the scenario is beyond them all.
    place: usize,
    values: Vec<String>,
}

impl Key {
    fn of<'r>(&self, row: &'r SweepRow) -> &'r str {
        row.values.get(self.place).unwrap_or(&row.scenario)
    }

    fn index(&self, row: &SweepRow) -> Option<usize> {
        self.values.iter().position(|value| value == self.of(row))
    }

    /// The values as numbers, if they all are.
    fn numbers(&self) -> Option<Vec<f64>> {
        let number = |value: &String| value.parse::<f64>().ok().filter(|number| number.is_finite());
        self.values.iter().map(number).collect()
    }

    fn is_random(&self) -> bool {
        let rises = |numbers: &[f64]| numbers.windows(2).all(|pair| pair[0] < pair[1]);
        let falls = |numbers: &[f64]| numbers.windows(2).all(|pair| pair[0] > pair[1]);
        self.numbers().is_some_and(|numbers| numbers.len() >= MANY && !rises(&numbers) && !falls(&numbers))
    }

    /// The key as an axis that counts.
    fn axis(&self, numbers: &[f64]) -> Axis {
        let (low, high) = numbers.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(*x), b.max(*x)));
        if low > 0.0 && high / low > DECADES {
            return Axis::new(&self.name, &self.name, Scale::Logarithmic, (low / 1.15, high * 1.15));
        }
        let room = 0.04 * (high - low);
        Axis::new(&self.name, &self.name, Scale::Linear, (low - room, high + room))
    }
}

/// Returns the figures of a sweep: where keys have distributions, the histogram of the errors and the errors against each
/// of them; else lines along a key, and of two keys a map. Without anything that varies there is none.
pub fn sweep_figures(table: &SweepTable) -> Vec<Figure> {
    let keys = keys(table);
    let (drawn, listed): (Vec<Key>, Vec<Key>) = keys.into_iter().partition(Key::is_random);
    let rows: Vec<&SweepRow> = table.rows.iter().collect();
    if !drawn.is_empty() {
        let scatters = drawn.iter().map(|key| scatter(key, listed.first(), &rows));
        return std::iter::once(histogram(listed.first(), &rows)).chain(scatters).collect();
    }
    match listed.as_slice() {
        [] => Vec::new(),
        [key] => vec![lines("sweep", (key, None), &rows, "")],
        [first, second, others @ ..] => of_two((first, second), others, &rows),
    }
}

/// What varies; the scenario too if there are several.
fn keys(table: &SweepTable) -> Vec<Key> {
    let names = table.keys.iter().map(String::as_str).chain(["scenario"]);
    let key = |(place, name): (usize, &str)| {
        let mut key = Key { name: name.to_owned(), place, values: Vec::new() };
        let mut known = std::collections::HashSet::new();
        for row in &table.rows {
            let value = key.of(row);
            if known.insert(value.to_owned()) {
                let value = value.to_owned();
                key.values.push(value);
            }
        }
        key
    };
    names.enumerate().map(key).filter(|key| key.values.len() > 1).collect()
}

/// A map, and lines, for every combination of the other keys.
fn of_two((first, second): (&Key, &Key), others: &[Key], rows: &[&SweepRow]) -> Vec<Figure> {
    let mut figures = Vec::new();
    for (n, (sentence, rows)) in combinations(others, rows).into_iter().enumerate() {
        let suffix = if others.is_empty() { String::new() } else { format!("-{}", n + 1) };
        figures.push(map(&format!("sweep-map{suffix}"), (second, first), &rows, &sentence));
        // Lines go along a key that counts.
        let (along, beside) = if second.numbers().is_some() { (second, first) } else { (first, second) };
        figures.push(lines(&format!("sweep-lines{suffix}"), (along, Some(beside)), &rows, &sentence));
    }
    figures
}

/// The rows by the values of these keys, with a sentence that tells them; too many are taken together.
fn combinations<'r>(keys: &[Key], rows: &[&'r SweepRow]) -> Vec<(String, Vec<&'r SweepRow>)> {
    if keys.iter().map(|key| key.values.len()).product::<usize>() > MOST_MAPS {
        let names: Vec<&str> = keys.iter().map(|key| key.name.as_str()).collect();
        return vec![(format!("The worst over all values of {}.", names.join(" and ")), rows.to_vec())];
    }
    let mut parts: Vec<(String, Vec<&SweepRow>)> = Vec::new();
    for row in rows {
        let values: Vec<String> = keys.iter().map(|key| format!("{} = {}", key.name, key.of(row))).collect();
        let sentence = if values.is_empty() { String::new() } else { format!("{}.", values.join(", ")) };
        match parts.iter_mut().find(|(known, _)| *known == sentence) {
            Some((_, part)) => part.push(row),
            None => parts.push((sentence, vec![row])),
        }
    }
    parts
}

/// What came of the cases of a cell: the worst error, or how the first that did not come to its end ended.
fn outcome<'r>(rows: impl Iterator<Item = &'r SweepRow>) -> Option<Result<f64, &'r str>> {
    let worse = |a: Result<f64, &'r str>, b: Result<f64, &'r str>| match (a, b) {
        (Ok(a), Ok(b)) => Ok(a.max(b)),
        (Err(status), _) | (_, Err(status)) => Err(status),
    };
    rows.map(|row| if row.is_completed() { Ok(row.figure(MEASURE)) } else { Err(row.status.as_str()) })
        .reduce(worse)
}

fn map(name: &str, (across, up): (&Key, &Key), rows: &[&SweepRow], sentence: &str) -> Figure {
    let mut cells = Vec::new();
    for x in 0..across.values.len() {
        for y in 0..up.values.len() {
            let own = rows.iter().filter(|row| across.index(row) == Some(x) && up.index(row) == Some(y));
            cells.extend(outcome(own.copied()).map(|outcome| (x, y, outcome)));
        }
    }
    let errors =
        || cells.iter().filter_map(|cell| cell.2.ok()).filter(|error| error.is_finite() && *error > 0.0);
    let (low, high) = errors().fold((f64::MAX, f64::MIN_POSITIVE), |(a, b), e| (a.min(e), b.max(e)));
    let shade = |error: f64| ((error / low).ln() / (high / low).ln().max(f64::EPSILON)).clamp(0.0, 1.0);
    let cell = |(x, y, outcome): &(usize, usize, Result<f64, &str>)| Cell {
        at: (*x as f64, *y as f64),
        value: outcome.unwrap_or(f64::NAN),
        shade: outcome.ok().filter(|error| error.is_finite()).map(shade),
        text: outcome.map_or_else(str::to_owned, short),
    };
    let cells = cells.iter().map(cell).collect();
    let range = if errors().next().is_some() {
        format!(
            "The darker, the larger: from {} to {}. Grey: did not come to its end.",
            short(low),
            short(high)
        )
    } else {
        "No case came to its end.".to_owned()
    };
    Figure {
        name: name.to_owned(),
        title: MEASURED.to_owned(),
        x: Axis::named(&across.name, &across.name, across.values.clone()),
        y: Axis::named(&up.name, &up.name, up.values.clone()),
        is_isometric: false,
        caption: format!("{sentence} {range}").trim().to_owned(),
        size: None,
        parameter: Some(MEASURE.to_owned()),
        marks: vec![Mark::Cells { name: MEASURE.to_owned(), cells }],
    }
}

/// Errors along a key, a line for each value of another.
fn lines(name: &str, (along, beside): (&Key, Option<&Key>), rows: &[&SweepRow], sentence: &str) -> Figure {
    let numbers = along.numbers();
    let place = |k: usize| numbers.as_ref().map_or(k as f64, |numbers| numbers[k]);
    let groups: Vec<(String, Option<usize>)> = match beside {
        None => vec![(MEASURE.to_owned(), None)],
        Some(key) => {
            let named = |(k, value): (usize, &String)| (format!("{} = {value}", key.name), Some(k));
            key.values.iter().enumerate().map(named).collect()
        }
    };
    let shown = groups.len().min(MOST_LINES);
    let mut marks = Vec::new();
    for (style, (name, group)) in groups.into_iter().take(shown).enumerate() {
        let own = |row: &&&SweepRow| group.is_none_or(|k| beside.and_then(|key| key.index(row)) == Some(k));
        let worst = |k: usize| {
            let cases = rows.iter().filter(own).filter(|row| along.index(row) == Some(k));
            outcome(cases.copied()).and_then(Result::ok).unwrap_or(f64::NAN)
        };
        let mut points: Vec<(f64, f64)> = (0..along.values.len()).map(|k| (place(k), worst(k))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let seen: Vec<(f64, f64)> = points.iter().copied().filter(|point| point.1 > 0.0).collect();
        if seen.is_empty() {
            continue;
        }
        if numbers.is_some() {
            marks.push(Mark::Line { name: name.clone(), points, parameter: Vec::new(), style });
        }
        marks.push(Mark::Points {
            name: if numbers.is_some() { String::new() } else { name },
            points: seen,
            shape: Shape::Disk,
            style,
        });
    }
    let x = match &numbers {
        Some(numbers) => along.axis(numbers),
        None => Axis::named(&along.name, &along.name, along.values.clone()),
    };
    let fewer = beside.map_or(0, |key| key.values.len().saturating_sub(MOST_LINES));
    let fewer = if fewer > 0 { format!(" {fewer} more values are not drawn.") } else { String::new() };
    let caption =
        format!("{sentence} Runs that did not come to their end have no point.{fewer}").trim().to_owned();
    let y = error_axis(MEASURED, MEASURE, rows);
    let title = format!("largest task error by {}", along.name);
    Figure {
        name: name.to_owned(),
        title,
        x,
        y,
        is_isometric: false,
        caption,
        size: None,
        parameter: None,
        marks,
    }
}

fn error_axis(label: &str, column: &str, rows: &[&SweepRow]) -> Axis {
    let errors = rows.iter().filter(|row| row.is_completed()).map(|row| row.figure(MEASURE));
    let errors = errors.filter(|error| error.is_finite() && *error > 0.0);
    let (low, high) = errors.fold((f64::MAX, f64::MIN_POSITIVE), |(a, b), e| (a.min(e), b.max(e)));
    // Where nothing came to its end there is no size of errors.
    let range = if low <= high { (low / 2.0, high * 2.0) } else { (1e-9, 1.0) };
    Axis::new(label, column, Scale::Logarithmic, range)
}

/// The rows by the values of a key, if there is one.
fn grouped<'r>(key: Option<&Key>, rows: &[&'r SweepRow]) -> Vec<(String, Vec<&'r SweepRow>)> {
    let Some(key) = key else { return vec![("all cases".to_owned(), rows.to_vec())] };
    let own = |value: &String| rows.iter().copied().filter(|row| key.of(row) == value).collect();
    key.values.iter().take(MOST_LINES).map(|value| (format!("{} = {value}", key.name), own(value))).collect()
}

/// How often errors of each size came, a line for each value of a key.
fn histogram(key: Option<&Key>, rows: &[&SweepRow]) -> Figure {
    let x = error_axis(MEASURED, MEASURE, rows);
    let (low, high) = (x.range.0.ln(), x.range.1.ln());
    let edge = |bar: usize| (low + (high - low) * bar as f64 / BARS as f64).exp();
    let mut marks = Vec::new();
    for (style, (name, rows)) in grouped(key, rows).into_iter().enumerate() {
        let mut counts = [0_usize; BARS];
        for error in rows.iter().filter(|row| row.is_completed()).map(|row| row.figure(MEASURE)) {
            let share = (error.ln() - low) / (high - low);
            if share.is_finite() {
                counts[((share * BARS as f64) as usize).min(BARS - 1)] += 1;
            }
        }
        let bars = counts.iter().enumerate();
        let points = bars
            .flat_map(|(bar, count)| [(edge(bar), *count as f64), (edge(bar + 1), *count as f64)])
            .collect();
        marks.push(Mark::Line { name, points, parameter: Vec::new(), style });
    }
    let most = marks.iter().flat_map(super::robot::points_of).map(|point| point.1).fold(1.0, f64::max);
    let stopped = rows.iter().filter(|row| !row.is_completed()).count();
    let caption = format!("{} cases; {stopped} did not come to their end.", rows.len());
    Figure {
        name: "sweep-histogram".to_owned(),
        title: "how large the largest task errors are".to_owned(),
        x,
        y: Axis::new("cases", "cases", Scale::Linear, (0.0, 1.08 * most)),
        is_isometric: false,
        caption,
        size: None,
        parameter: None,
        marks,
    }
}

/// Errors against a key that was drawn, in the colours of the values of another.
fn scatter(key: &Key, listed: Option<&Key>, rows: &[&SweepRow]) -> Figure {
    let stride = rows.len().div_ceil(MOST_POINTS).max(1);
    let some: Vec<&SweepRow> = rows.iter().copied().step_by(stride).collect();
    let mut marks = Vec::new();
    for (style, (name, rows)) in grouped(listed, &some).into_iter().enumerate() {
        let point = |row: &&SweepRow| Some((key.of(row).parse().ok()?, row.figure(MEASURE)));
        let points = rows.iter().filter(|row| row.is_completed()).filter_map(point).collect();
        let shape = [Shape::Disk, Shape::Circle, Shape::Diamond, Shape::Square, Shape::Cross][style % 5];
        marks.push(Mark::Points { name, points, shape, style });
    }
    let plain = |c: char| if c.is_alphanumeric() { c } else { '_' };
    let stem: String = key.name.chars().map(plain).collect();
    let shown = if stride > 1 { format!("One of {stride} cases is drawn.") } else { String::new() };
    Figure {
        name: format!("sweep-by-{stem}"),
        title: format!("largest task error by {}", key.name),
        x: key.axis(&key.numbers().unwrap_or_default()),
        y: error_axis(MEASURED, MEASURE, rows),
        is_isometric: false,
        caption: shown,
        size: None,
        parameter: None,
        marks,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    fn table(varied: &[&str], values: impl Iterator<Item = (Vec<String>, f64)>) -> SweepTable {
        let keys: Vec<String> = varied.iter().map(|key| format!("varied.{key}")).collect();
        let mut text =
            format!("case,status,scenario,{},formula,start,steps,max_error,reason\n", keys.join(","));
        for (n, (values, error)) in values.enumerate() {
            let status = if error < 1.0 { "completed" } else { "diverged" };
            let values = values.join(",");
            let _ = writeln!(text, "{n},{status},s,{values},ab4,rk4,10,{error:e},");
        }
        SweepTable::parse(&text).unwrap()
    }

    fn names(table: &SweepTable) -> Vec<String> {
        sweep_figures(table).into_iter().map(|figure| figure.name).collect()
    }

    #[test]
    fn two_keys_make_a_map_with_every_case_in_it() {
        let cases = (0..36)
            .map(|k| (vec![format!("0.{}", k / 6 + 1), format!("{}", 1 << (k % 6))], 10_f64.powi(k - 34)));
        let table = table(&["law.h", "sigma"], cases);
        let figures = sweep_figures(&table);
        assert_eq!(names(&table), ["sweep-map", "sweep-lines"]);
        let csv = figures[0].to_csv();
        assert!(csv.starts_with("mark,sigma,law.h,max_error\n") && csv.lines().count() == 37, "{csv}");
        assert!(csv.contains("max_error,1,0.1,") && figures[0].to_svg().contains("diverged"), "{csv}");
        assert_eq!(figures[1].marks.iter().filter(|mark| matches!(mark, Mark::Line { .. })).count(), 6);
    }

    #[test]
    fn one_key_makes_a_line_and_words_stand_by_themselves() {
        let numbers = table(&["law.h"], (1..6).map(|k| (vec![format!("0.{k}")], 1e-6 * f64::from(k))));
        assert_eq!(names(&numbers), ["sweep"]);
        let words =
            table(&["formula"], ["ab2", "ab4", "bdf2"].iter().map(|id| (vec![(*id).to_owned()], 1e-5)));
        let figure = &sweep_figures(&words)[0];
        assert!(
            figure.to_svg().contains(">bdf2<") && figure.to_csv().contains("max_error,ab4,"),
            "{}",
            figure.to_csv()
        );
    }

    #[test]
    fn draws_make_a_histogram_that_counts_every_case() {
        let draw = |k: i32| f64::from(k * 37 % 101) / 101.0;
        let table = table(&["q"], (0..100).map(|k| (vec![format!("{}", draw(k))], 1e-9 * (1.0 + draw(k)))));
        assert_eq!(names(&table), ["sweep-histogram", "sweep-by-q"]);
        let Mark::Line { points, .. } = &sweep_figures(&table)[0].marks[0] else { panic!("a line") };
        // Every bar has two ends.
        assert_eq!(points.iter().map(|point| point.1).sum::<f64>(), 200.0);
    }

    #[test]
    fn nothing_that_varies_is_nothing_to_draw() {
        assert!(sweep_figures(&table(&["q"], [(vec!["1".to_owned()], 1e-3)].into_iter())).is_empty());
    }
}
