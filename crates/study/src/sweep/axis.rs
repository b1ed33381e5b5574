//! What varies: a key of the scenario with a list of values or a distribution.

use kinstep::math::random::{normal, unit};
use thiserror::Error;

/// The most values of one list.
const MOST_VALUES: usize = 10_000_000;

/// Why a variation does not read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("--vary {text}: {problem}")]
pub struct AxisError {
    /// The variation as it was given.
    pub text: String,
    /// The sentence.
    pub problem: String,
}

/// A key of a scenario and the values that it takes.
///
/// ```
/// use kinstep_study::sweep::Axis;
/// let axis = Axis::parse("law.h=linspace(0.1, 0.3, 3)")?;
/// assert_eq!(axis.key(), "law.h");
/// assert_eq!((0..3).map(|k| axis.value(k, 0)).collect::<Vec<_>>(), ["0.1", "0.2", "0.3"]);
/// assert_eq!(Axis::parse("formula=ab4, split-ab4")?.value(1, 0), "split-ab4");
/// assert!(Axis::parse("arm.left.q0[1]=normal(0, 0.1)")?.is_random());
/// # Ok::<(), kinstep_study::sweep::AxisError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    key: String,
    values: Values,
}

#[derive(Clone, Debug, PartialEq)]
enum Values {
    List(Vec<String>),
    Even { from: f64, to: f64, count: usize },
    Geometric { from: f64, to: f64, count: usize },
    Uniform { from: f64, to: f64 },
    LogUniform { from: f64, to: f64 },
    Normal { mean: f64, deviation: f64 },
}

impl Axis {
    /// Reads `key=a,b,c`, `key=linspace(from, to, count)`, `key=logspace(from, to, count)`, `key=uniform(from, to)`,
    /// `key=loguniform(from, to)` or `key=normal(mean, deviation)`.
    ///
    /// # Errors
    /// [`AxisError`] with what is wrong.
    pub fn parse(text: &str) -> Result<Self, AxisError> {
        let refuse = |problem: String| AxisError { text: text.to_owned(), problem };
        let (key, values) = text
            .split_once('=')
            .filter(|(key, _)| !key.trim().is_empty())
            .ok_or_else(|| refuse("write key.path=values, for example law.h=0.2,0.3,0.4".to_owned()))?;
        let values = values.trim();
        let values = match call(values) {
            Some((name, arguments)) => numbers(name, arguments).map_err(refuse)?,
            None => Values::List(list(values).map_err(refuse)?),
        };
        Ok(Self { key: key.trim().to_owned(), values })
    }

    /// The key of the scenario.
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Whether the values are drawn.
    pub fn is_random(&self) -> bool {
        matches!(self.values, Values::Uniform { .. } | Values::LogUniform { .. } | Values::Normal { .. })
    }

    /// How many values there are; one for a distribution.
    pub fn len(&self) -> usize {
        match &self.values {
            Values::List(list) => list.len(),
            Values::Even { count, .. } | Values::Geometric { count, .. } => *count,
            _ => 1,
        }
    }

    /// Whether there is no value; never so for an axis that was read.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Value `index` of a list, or the one that the random bits `draw` give.
    ///
    /// # Panics
    /// If the list is shorter.
    pub fn value(&self, index: usize, draw: u64) -> String {
        let share = |count: usize| index as f64 / (count.max(2) - 1) as f64;
        match &self.values {
            Values::List(list) => list[index].clone(),
            Values::Even { from, to, count } => short(from + (to - from) * share(*count)),
            Values::Geometric { from, to, count } => short(from * (to / from).powf(share(*count))),
            Values::Uniform { from, to } => exact(from + (to - from) * unit(draw)),
            Values::LogUniform { from, to } => exact(from * (to / from).powf(unit(draw))),
            Values::Normal { mean, deviation } => exact(mean + deviation * normal(draw)),
        }
    }
}

/// Twelve digits: the ends of evenly spaced values come out as they were written.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.11e}").parse().unwrap_or(value);
    exact(rounded)
}

/// All digits, and always a float of TOML.
fn exact(value: f64) -> String {
    format!("{value:?}")
}

/// Splits `name(arguments)`.
fn call(text: &str) -> Option<(&str, &str)> {
    let (name, rest) = text.split_once('(')?;
    let arguments = rest.strip_suffix(')')?;
    let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_lowercase());
    (is_name && !arguments.contains(['(', ')'])).then_some((name, arguments))
}

fn numbers(name: &str, arguments: &str) -> Result<Values, String> {
    let parts: Vec<&str> = arguments.split(',').map(str::trim).collect();
    let number = |part: &str| {
        let value =
            kinstep_files::scenario::evaluate(part).map_err(|_| format!("\"{part}\" is not a number"))?;
        if value.is_finite() { Ok(value) } else { Err(format!("\"{part}\" is not a finite number")) }
    };
    let known = || {
        Err(format!(
            "\"{name}({arguments})\" is none of linspace(from, to, count), logspace(from, to, count), uniform(from, to), loguniform(from, to), normal(mean, deviation)"
        ))
    };
    let positive = |from: f64, to: f64, values: Values| {
        if from > 0.0 && to > 0.0 { Ok(values) } else { Err("both ends have to be positive".to_owned()) }
    };
    match (name, parts.as_slice()) {
        ("linspace" | "logspace", [from, to, count]) => {
            let (from, to) = (number(from)?, number(to)?);
            let count = count.parse().ok().filter(|count| (1..=MOST_VALUES).contains(count));
            let count =
                count.ok_or_else(|| format!("the count is a whole number from 1 to {MOST_VALUES}"))?;
            match name {
                "linspace" => Ok(Values::Even { from, to, count }),
                _ => positive(from, to, Values::Geometric { from, to, count }),
            }
        }
        ("uniform", [from, to]) => Ok(Values::Uniform { from: number(from)?, to: number(to)? }),
        ("loguniform", [from, to]) => {
            let (from, to) = (number(from)?, number(to)?);
            positive(from, to, Values::LogUniform { from, to })
        }
        ("normal", [mean, deviation]) => {
            Ok(Values::Normal { mean: number(mean)?, deviation: number(deviation)? })
        }
        _ => known(),
    }
}

/// Splits at the commas that are in no brackets and no quotes.
fn list(text: &str) -> Result<Vec<String>, String> {
    let (mut parts, mut part) = (Vec::new(), String::new());
    let (mut depth, mut quote) = (0_usize, None);
    for c in text.chars() {
        match (quote, c) {
            (Some(open), _) if c == open => quote = None,
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{' | '(') => depth += 1,
            (None, ']' | '}' | ')') => depth = depth.saturating_sub(1),
            (None, ',') if depth == 0 => {
                parts.push(std::mem::take(&mut part));
                continue;
            }
            _ => {}
        }
        part.push(c);
    }
    parts.push(part);
    let parts: Vec<String> = parts.iter().map(|part| part.trim().to_owned()).collect();
    if parts.iter().any(String::is_empty) {
        return Err("a value is missing between commas".to_owned());
    }
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::math::random::mix;

    #[test]
    fn lists_are_split_where_people_would_split_them() {
        let values = |text: &str| {
            let axis = Axis::parse(&format!("k={text}")).unwrap();
            (0..axis.len()).map(|k| axis.value(k, 0)).collect::<Vec<_>>()
        };
        assert_eq!(values("[1, 2], [3, 4]"), ["[1, 2]", "[3, 4]"]);
        assert_eq!(values("\"a,b\", c"), ["\"a,b\"", "c"]);
        assert_eq!(values("logspace(1e-4, 1e-2, 3)"), ["0.0001", "0.001", "0.01"]);
        assert_eq!(values("linspace(1, 2, 1)"), ["1.0"]);
    }

    #[test]
    fn what_does_not_read_is_refused_with_a_reason() {
        for (text, reason) in [
            ("law.h", "write key.path=values"),
            ("=1", "write key.path=values"),
            ("law.h=1,,2", "a value is missing"),
            ("law.h=", "a value is missing"),
            ("law.h=linspace(1,2)", "none of linspace"),
            ("law.h=linspace(1,2,0)", "whole number from 1"),
            ("law.h=logspace(-1,2,3)", "positive"),
            ("law.h=gauss(1,2)", "none of linspace"),
            ("law.h=normal(a,2)", "\"a\" is not a number"),
        ] {
            let error = Axis::parse(text).unwrap_err().to_string();
            assert!(error.contains(reason), "{text}: {error}");
        }
    }

    #[test]
    fn distributions_have_their_moments() {
        let axis = |text: &str| Axis::parse(text).unwrap();
        let draws = |axis: &Axis| -> Vec<f64> {
            (0..20_000).map(|k| axis.value(0, mix(mix(k))).parse().unwrap()).collect()
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let normal = draws(&axis("k=normal(1, 2)"));
        let spread = mean(&normal.iter().map(|x| (x - 1.0) * (x - 1.0)).collect::<Vec<_>>()).sqrt();
        assert!((mean(&normal) - 1.0).abs() < 0.06 && (spread - 2.0).abs() < 0.05, "{spread}");
        let uniform = draws(&axis("k=uniform(2, 4)"));
        assert!((mean(&uniform) - 3.0).abs() < 0.02 && uniform.iter().all(|x| (2.0..4.0).contains(x)));
        let decades = draws(&axis("k=loguniform(1e-4, 1e-2)"));
        assert!(decades.iter().all(|x| (1e-4..1e-2).contains(x)));
        assert!((mean(&decades.iter().map(|x| x.log10()).collect::<Vec<_>>()) + 3.0).abs() < 0.02);
    }
}
