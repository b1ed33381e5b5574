//! Who names what of whom, and the circles in it.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// For everyone who names something, whose and what.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Graph(BTreeMap<String, BTreeMap<String, BTreeSet<String>>>);

impl Graph {
    /// Notes that `from` names `what` of `to`.
    pub(super) fn add(&mut self, from: &str, to: &str, what: &str) {
        let named = self.0.entry(from.to_owned()).or_default();
        named.entry(to.to_owned()).or_default().insert(what.to_owned());
    }

    /// Whom `from` names something of.
    pub(super) fn named_by(&self, from: &str) -> BTreeSet<String> {
        self.0.get(from).map(|named| named.keys().cloned().collect()).unwrap_or_default()
    }

    /// What `from` names of `to`, as a list in words.
    pub(super) fn names(&self, from: &str, to: &str) -> String {
        let names = self.0.get(from).and_then(|named| named.get(to)).into_iter().flatten();
        names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
    }

    /// Returns circles, as sentences, until everyone who is in one is in one of those that are told.
    pub(super) fn circles(&self) -> Vec<String> {
        let mut told: BTreeSet<&str> = BTreeSet::new();
        let mut circles = Vec::new();
        for start in self.0.keys() {
            if let Some(circle) = self.circle(start).filter(|_| !told.contains(start.as_str())) {
                circles.push(self.sentence(&circle));
                told.extend(circle);
            }
        }
        circles
    }

    /// The shortest way from someone back to itself.
    fn circle<'a>(&'a self, start: &'a str) -> Option<Vec<&'a str>> {
        let mut before: BTreeMap<&str, &str> = BTreeMap::new();
        let mut waiting = VecDeque::from([start]);
        while let Some(at) = waiting.pop_front() {
            for next in self.0.get(at).into_iter().flat_map(BTreeMap::keys) {
                if next == start {
                    let mut circle: Vec<&str> =
                        std::iter::successors(Some(at), |at| before.get(at).copied()).collect();
                    circle.reverse();
                    return Some(circle);
                }
                if !before.contains_key(next.as_str()) {
                    before.insert(next, at);
                    waiting.push_back(next);
                }
            }
        }
        None
    }

    fn sentence(&self, circle: &[&str]) -> String {
        let next = circle.iter().cycle().skip(1);
        let steps = circle.iter().zip(next).map(|(from, to)| {
            let names = self.names(from, to);
            format!("\n  {from} names {names} of {to}")
        });
        format!("a circle of {}:{}", circle.len(), steps.collect::<String>())
    }
}
