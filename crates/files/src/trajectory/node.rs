//! Documents as trees that know their places.

use std::borrow::Cow;

use super::error::{Problem, excerpt};
use super::points::{POINTS, Points};

/// A node of a document, and the byte at which it begins.
#[derive(Clone, Debug)]
pub(super) enum Node<'t> {
    Scalar(Cow<'t, str>, usize),
    List(Vec<Node<'t>>, usize),
    Map(Vec<(Cow<'t, str>, Node<'t>)>, usize),
    /// The points of a joint trajectory, which take no more room than their numbers.
    Points(Box<Points>, usize),
}

impl<'t> Node<'t> {
    /// Puts points where the first list of points stands empty.
    pub(super) fn fill(&mut self, points: &mut Option<Box<Points>>) {
        let inner: Vec<&mut Node<'t>> = match self {
            Self::Map(entries, _) => {
                let empty = entries
                    .iter_mut()
                    .find(|(key, node)| key == POINTS && node.text().is_ok_and(str::is_empty));
                if let Some((_, node)) = empty
                    && let Some(points) = points.take()
                {
                    *node = Self::Points(points, node.at());
                }
                entries.iter_mut().map(|(_, node)| node).collect()
            }
            Self::List(items, _) => items.iter_mut().collect(),
            Self::Scalar(..) | Self::Points(..) => return,
        };
        for node in inner {
            if points.is_some() {
                node.fill(points);
            }
        }
    }

    pub(super) fn at(&self) -> usize {
        match self {
            Self::Scalar(_, at) | Self::List(_, at) | Self::Map(_, at) | Self::Points(_, at) => *at,
        }
    }

    pub(super) fn get(&self, key: &str) -> Option<&Node<'t>> {
        let Self::Map(entries, _) = self else { return None };
        entries.iter().find(|(known, _)| known == key).map(|(_, node)| node)
    }

    pub(super) fn items(&self) -> Option<&[Node<'t>]> {
        if let Self::List(items, _) = self { Some(items) } else { None }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.items().is_some_and(<[_]>::is_empty)
    }

    pub(super) fn need(&self, key: &str) -> Result<&Node<'t>, Problem> {
        self.get(key).ok_or_else(|| Problem::at(self.at(), format!("`{key}` is missing here")))
    }

    pub(super) fn list(&self, what: &str) -> Result<&[Node<'t>], Problem> {
        self.items().ok_or_else(|| Problem::at(self.at(), format!("expected {what}")))
    }

    pub(super) fn text(&self) -> Result<&str, Problem> {
        if let Self::Scalar(text, _) = self {
            Ok(text)
        } else {
            Err(Problem::at(self.at(), "expected a name"))
        }
    }

    /// Appends the finite numbers of a list.
    pub(super) fn numbers_of(&self, into: &mut Vec<f64>) -> Result<(), Problem> {
        self.list("a list of numbers")?.iter().try_for_each(|item| {
            into.push(item.number()?);
            Ok(())
        })
    }

    /// A finite number.
    pub(super) fn number(&self) -> Result<f64, Problem> {
        let value = self.real()?;
        if value.is_finite() { Ok(value) } else { Err(self.no_number()) }
    }

    /// A number, or what stands for none.
    pub(super) fn real(&self) -> Result<f64, Problem> {
        match self.text()? {
            ".nan" | ".NaN" | ".NAN" | "null" => Ok(f64::NAN),
            ".inf" | "+.inf" => Ok(f64::INFINITY),
            "-.inf" => Ok(f64::NEG_INFINITY),
            text => text.parse().map_err(|_| self.no_number()),
        }
    }

    fn no_number(&self) -> Problem {
        let shown = excerpt(self.text().unwrap_or_default());
        Problem::at(self.at(), format!("`{shown}` is not a finite number"))
    }

    /// The keys of a map.
    pub(super) fn keys(&self) -> Vec<&str> {
        let Self::Map(entries, _) = self else { return Vec::new() };
        entries.iter().map(|(key, _)| key.as_ref()).collect()
    }

    /// The whole nanoseconds of a time or a span in any of the spellings of the Robot Operating System; nothing where it has none
    /// of them.
    pub(super) fn nanoseconds(&self) -> Result<Option<i128>, Problem> {
        let part = |names: &[&str]| -> Result<Option<f64>, Problem> {
            names.iter().find_map(|name| self.get(name)).map(Node::number).transpose()
        };
        let Some(seconds) = part(&["sec", "secs"])? else { return Ok(None) };
        let rest = part(&["nanosec", "nsecs", "nanosecs", "nsec"])?.ok_or_else(|| {
            Problem::at(self.at(), "the seconds have no `nanosec` (or `nsecs`) beside them")
        })?;
        Ok(Some(
            (seconds.trunc() as i128) * 1_000_000_000
                + (seconds.fract() * 1e9).round() as i128
                + rest as i128,
        ))
    }

    /// Appends the numbers of a list that has so many.
    pub(super) fn numbers(&self, count: usize, into: &mut Vec<f64>) -> Result<(), Problem> {
        let items = self.list("a list of numbers")?;
        if items.len() != count {
            let got = items.len();
            return Err(Problem::at(
                self.at(),
                format!("expected {count} numbers, one per joint, got {got}"),
            ));
        }
        self.numbers_of(into)
    }
}
