//! The search itself: many starts, the best of them refined, fractions near by, exact verdicts.

use std::time::{Duration, Instant};

use rayon::prelude::*;

use super::error::SearchError;
use super::evolve::{Best, Random, evolve};
use super::figures::Figures;
use super::found::Found;
use super::front::front;
use super::judge::Judge;
use super::lattice::{Candidate, descend};
use super::objective::{Objective, Weight};
use super::space::{Family, Space};

/// What to search for, and how long.
#[derive(Debug, Clone)]
pub struct Options {
    /// The kind of rows.
    pub family: Family,
    /// The number of steps s.
    pub steps: usize,
    /// The order p.
    pub order: usize,
    /// What is to be best.
    pub objective: Objective,
    /// The largest denominator of the free coefficients.
    pub denominator: u32,
    /// The least h_max that a row must have.
    pub least_range: f64,
    /// The seed of the random starting points.
    pub seed: u64,
    /// The number of starting points.
    pub starts: usize,
    /// The most rows in the outcome.
    pub rows: usize,
    /// Whether to look for the Pareto front too.
    pub front: bool,
    /// After this time the search ends with what it has; then the outcome depends on the machine.
    pub limit: Option<Duration>,
    /// The number of threads, all processors if `None`; it does not change what is found.
    pub threads: Option<usize>,
}

impl Options {
    /// Returns the usual options: denominators up to 480, 64 starts from seed 1, three rows, no limit of time.
    pub fn new(family: Family, steps: usize, order: usize, objective: Objective) -> Self {
        Self {
            family,
            steps,
            order,
            objective,
            denominator: 480,
            least_range: 0.0,
            seed: 1,
            starts: 64,
            rows: 3,
            front: false,
            limit: None,
            threads: None,
        }
    }
}

/// How far a search has come.
#[derive(Debug, Clone, PartialEq)]
pub struct Progress {
    /// What is being done, in words.
    pub stage: &'static str,
    /// Pieces of work of this stage that are done.
    pub done: usize,
    /// All pieces of work of this stage.
    pub total: usize,
    /// The best value of the objective so far, in real numbers.
    pub best: Option<f64>,
}

/// Receives the progress of a search, and may end it.
pub trait Observer: Sync {
    /// Returns whether the search goes on; called often, from several threads.
    fn goes_on(&self) -> bool {
        true
    }
    /// Receives how far the search has come.
    fn hears(&self, _progress: &Progress) {}
}

/// No observer: the search runs to its end.
impl Observer for () {}

/// What a search has found.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The best value of the objective that a row was exactly decided to have, whatever its denominator: never better than the best
    /// there is.
    pub bound: f64,
    /// The best row within the denominators, then the simplest ones that are nearly as good.
    pub rows: Vec<Found>,
    /// The Pareto front in (h_max, C, r_opt) of the rows that were met; empty unless asked for.
    pub front: Vec<Found>,
    /// Whether the search came to its end; otherwise time or the observer ended it early.
    pub complete: bool,
}

/// Starts are worked off in groups of this size; between groups the observer hears of the best.
const GROUP: usize = 8;
/// So many of the best starts are refined and brought to fractions.
const REFINED: usize = 8;
/// So many of the refined points are decided exactly with fractions as fine as can be.
const MOST_FINE: usize = 3;
/// Of all denominators between two powers of two, so many candidates are decided exactly.
const MOST_OF_OCTAVE: usize = 12;
/// So many candidates are decided exactly before the best of them is taken: an exact decision takes a tenth of a second and more.
const MOST_DECIDED: usize = 24;
/// What the merit in doubles may promise too much.
const AGREEMENT: f64 = 2e-3;

/// Returns the rows that are best at an objective, exactly decided, with the best value that any row was confirmed to have.
///
/// A search with a larger denominator contains the searches with smaller ones: unless it is cut short, it finds nothing worse.
///
/// # Errors
/// [`SearchError`] when there is nothing to search or nothing was found.
pub fn search(options: &Options, observer: &impl Observer) -> Result<Outcome, SearchError> {
    let space = Space::new(options.family, options.steps, options.order)?;
    let denominators = space.denominators(options.denominator)?;
    let deadline = options.limit.and_then(|limit| Instant::now().checked_add(limit));
    let stop = || !observer.goes_on() || deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let run = Run { options, space: &space, denominators, observer, stop: &stop };
    match options.threads {
        None => run.search(),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .build()
            .map_err(|_| SearchError::Threads(threads))?
            .install(|| run.search()),
    }
}

struct Run<'a, O: Observer, S: Fn() -> bool + Sync> {
    options: &'a Options,
    space: &'a Space,
    denominators: Vec<u32>,
    observer: &'a O,
    stop: &'a S,
}

impl<O: Observer, S: Fn() -> bool + Sync> Run<'_, O, S> {
    fn search(&self) -> Result<Outcome, SearchError> {
        let judge = self.judge(&self.options.objective);
        let mut refined = self.refine(&judge, self.explore(&judge));
        refined.retain(|best| Judge::<'_>::is_acceptable(best.merit));
        let candidates = self.to_fractions(&judge, &refined);
        let rows = self.pick(&judge, candidates);
        // Beside double roots doubles promise too much: what counts is what the exact decision says.
        let fine = refined.iter().filter(|_| !(self.stop)()).filter_map(|best| self.finest(&judge, best));
        let best =
            rows.iter().cloned().chain(fine.take(MOST_FINE)).min_by(|a, b| a.merit.total_cmp(&b.merit));
        let best = best.ok_or(SearchError::NothingFound {
            starts: self.options.starts,
            least_range: self.options.least_range,
        })?;
        let bound = self.options.objective.value(&best.figures);
        let front = if self.options.front { self.front(&rows) } else { Vec::new() };
        Ok(Outcome { bound, rows, front, complete: !(self.stop)() })
    }

    fn judge<'a>(&'a self, objective: &'a Objective) -> Judge<'a> {
        Judge { space: self.space, objective, least_range: self.options.least_range }
    }

    /// The value of the objective that belongs to a merit.
    fn value(&self, merit: f64) -> f64 {
        match self.options.objective {
            Objective::Range => (-merit).exp(),
            Objective::Beat(_) => (-merit).exp_m1(),
            _ => merit.exp(),
        }
    }

    fn say(&self, stage: &'static str, done: usize, total: usize, merit: Option<f64>) {
        let best = merit.filter(|merit| Judge::<'_>::is_acceptable(*merit)).map(|merit| self.value(merit));
        self.observer.hears(&Progress { stage, done, total, best });
    }

    /// Random starts, each walked downhill; best first.
    fn explore(&self, judge: &Judge<'_>) -> Vec<Best> {
        let starts: Vec<usize> = (0..self.options.starts.max(1)).collect();
        let mut found: Vec<Best> = Vec::new();
        for group in starts.chunks(GROUP) {
            if (self.stop)() && !found.is_empty() {
                break;
            }
            let walked: Vec<Best> = group.par_iter().map(|&i| self.walk(judge, i as u64)).collect();
            found.extend(walked);
            let best = found.iter().map(|best| best.merit).fold(f64::INFINITY, f64::min);
            self.say("starting points", found.len(), starts.len(), Some(best));
        }
        sorted(found)
    }

    fn walk(&self, judge: &Judge<'_>, index: u64) -> Best {
        const TRIES: usize = 12;
        let mut random = Random::new(self.options.seed, index);
        let drawn = (0..TRIES).map(|_| self.space.start(&mut random)).map(|point| at(judge, point));
        let start = drawn.min_by(|a, b| a.merit.total_cmp(&b.merit)).unwrap_or_else(|| at(judge, Vec::new()));
        let evaluations = 300 + 250 * self.space.dimension();
        evolve(|point| judge.merit_at(point), start, 0.4, evaluations, &mut random, self.stop)
    }

    /// The best starts, walked on with small steps.
    fn refine(&self, judge: &Judge<'_>, mut found: Vec<Best>) -> Vec<Best> {
        found.truncate(REFINED);
        let evaluations = 600 + 400 * self.space.dimension();
        let refine = |(k, start): (usize, Best)| {
            let mut random = Random::new(self.options.seed, u64::MAX - k as u64);
            evolve(|point| judge.merit_at(point), start, 0.02, evaluations, &mut random, self.stop)
        };
        sorted(found.into_par_iter().enumerate().map(refine).collect())
    }

    /// The row of a point in fractions so fine that hardly anything is lost, exactly decided.
    fn finest(&self, judge: &Judge<'_>, best: &Best) -> Option<Found> {
        const FINE: u32 = 4_000_000_000;
        let unit = self.denominators.first().copied().unwrap_or(1);
        let denominator = FINE / unit * unit;
        let fine = |u: f64| (u * f64::from(denominator)).round() as i64;
        let numerators = self.space.free(&best.point).into_iter().map(fine).collect();
        let candidate = Candidate { numerators, denominator, merit: best.merit };
        self.decide(judge.objective, &candidate, "bound")
    }

    /// Fractions of every denominator near the refined points.
    fn to_fractions(&self, judge: &Judge<'_>, refined: &[Best]) -> Vec<Candidate> {
        let total = self.denominators.len();
        let mut found: Vec<Candidate> = Vec::new();
        // From both ends: if time runs out, the largest are there, near to which the best are, and the simplest.
        let ends = self.denominators.iter().rev().zip(&self.denominators);
        let all: Vec<u32> = ends.flat_map(|(&large, &small)| [large, small]).take(total).collect();
        for (k, group) in all.chunks(GROUP).enumerate() {
            if (self.stop)() && !found.is_empty() {
                break;
            }
            let near = |denominator: u32| {
                let candidates = refined
                    .iter()
                    .map(|best| descend(judge, &self.space.free(&best.point), denominator, self.stop));
                candidates.min_by(|a, b| a.merit.total_cmp(&b.merit))
            };
            found.extend(group.par_iter().filter_map(|&d| near(d)).collect::<Vec<_>>());
            let best = refined.first().map(|best| best.merit);
            self.say("fractions", (k * GROUP + group.len()).min(total), total, best);
        }
        found.retain(|candidate| Judge::<'_>::is_acceptable(candidate.merit));
        found.sort_by(|a, b| a.merit.total_cmp(&b.merit).then(a.denominator.cmp(&b.denominator)));
        found
    }

    /// The best candidate by exact figures, then the simplest ones within 2 %, 10 % and more of it.
    fn pick(&self, judge: &Judge<'_>, candidates: Vec<Candidate>) -> Vec<Found> {
        const SLACK: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 0.4];
        let mut rows: Vec<Found> = self.best_of(judge, &candidates).into_iter().collect();
        let Some(best_merit) = rows.first().map(|best| best.merit) else { return rows };
        let mut simplest = candidates;
        if matches!(judge.objective, Objective::Beat(_)) && best_merit < 0.0 {
            simplest.retain(|candidate| candidate.merit < 0.0);
        }
        simplest.sort_by_key(|candidate| candidate.denominator);
        let word = judge.objective.word();
        for slack in SLACK {
            if rows.len() >= self.options.rows || (self.stop)() {
                break;
            }
            let enough = |candidate: &&Candidate| candidate.merit <= best_merit + slack;
            let row = simplest
                .iter()
                .filter(enough)
                .take(MOST_DECIDED)
                .find_map(|candidate| self.confirm(judge.objective, candidate, &word));
            rows.extend(row.filter(|row| rows.iter().all(|known| known.checked.row() != row.checked.row())));
        }
        rows
    }

    /// The best candidate by exact figures, from small denominators to large ones: of each octave some of those that promise more than
    /// the best so far keeps. What is decided of a denominator does not depend on larger ones.
    fn best_of(&self, judge: &Judge<'_>, candidates: &[Candidate]) -> Option<Found> {
        let word = judge.objective.word();
        let mut rising: Vec<&Candidate> = candidates.iter().collect();
        // When time has run out, there is only some for what promises most.
        if !(self.stop)() {
            rising.sort_by_key(|candidate| candidate.denominator);
        }
        let mut best: Option<Found> = None;
        let (mut octave, mut decided) = (0, 0);
        for candidate in rising {
            if (self.stop)() && best.is_some() {
                break;
            }
            if candidate.denominator.ilog2() != octave {
                (octave, decided) = (candidate.denominator.ilog2(), 0);
            }
            let promises = best.as_ref().is_none_or(|best| candidate.merit < best.merit);
            if !promises || decided >= MOST_OF_OCTAVE {
                continue;
            }
            // Rows that are not even stable are refused at once and do not count.
            let Some(found) = self.decide(judge.objective, candidate, &word) else { continue };
            decided += 1;
            if best.as_ref().is_none_or(|best| found.merit < best.merit) {
                best = Some(found);
            }
        }
        best
    }

    /// The row of a candidate, unless the exact figures disagree with those in doubles.
    fn confirm(&self, objective: &Objective, candidate: &Candidate, word: &str) -> Option<Found> {
        self.decide(objective, candidate, word).filter(|found| found.merit <= candidate.merit + AGREEMENT)
    }

    /// The row of a candidate with its exact figures, `None` where it is not what was asked for.
    fn decide(&self, objective: &Objective, candidate: &Candidate, word: &str) -> Option<Found> {
        let Candidate { numerators, denominator, .. } = candidate;
        let Options { steps, order, family, .. } = self.options;
        let prefix = if *family == Family::LookAhead {
            format!("la{}", steps + 1)
        } else {
            format!("{family}-s{steps}")
        };
        let id = format!("{prefix}-o{order}-{word}-{denominator}");
        let checked = self.space.row(&id, numerators, *denominator)?.check();
        if !checked.analysis().is_strictly_zero_stable() || checked.analysis().order() < Some(*order) {
            return None;
        }
        let range = checked.analysis().feedback_range()?.value();
        if range < self.options.least_range {
            return None;
        }
        let figures = Figures::exact(checked.analysis())?;
        let merit = objective.merit(&figures);
        Some(Found { checked, figures, merit, denominator: *denominator })
    }

    /// Rows that are best at many mixtures of range, error and decay, none dominated by another.
    fn front(&self, rows: &[Found]) -> Vec<Found> {
        let mixtures = mixtures();
        let mut found: Vec<Found> = rows.to_vec();
        for (k, group) in mixtures.chunks(GROUP).enumerate() {
            if (self.stop)() {
                break;
            }
            let best_at = |(j, objective): (usize, &Objective)| {
                let judge = self.judge(objective);
                let index = (k * GROUP + j) as u64;
                let walked: Vec<Best> =
                    (0..3).map(|n| self.walk(&judge, (1 << 32) + 3 * index + n)).collect();
                let best = sorted(walked).into_iter().next()?;
                let free = self.space.free(&best.point);
                let largest = self.denominators.last()?;
                let candidate = descend(&judge, &free, *largest, self.stop);
                Judge::<'_>::is_acceptable(candidate.merit)
                    .then(|| self.confirm(objective, &candidate, &format!("front{}", index + 1)))?
            };
            found.extend(group.par_iter().enumerate().map(best_at).collect::<Vec<_>>().into_iter().flatten());
            self.say("Pareto front", k * GROUP + group.len(), mixtures.len(), None);
        }
        front(found)
    }
}

fn at(judge: &Judge<'_>, point: Vec<f64>) -> Best {
    Best { merit: judge.merit_at(&point), point }
}

/// Best first; of equals, the earlier start.
fn sorted(mut found: Vec<Best>) -> Vec<Best> {
    found.sort_by(|a, b| a.merit.total_cmp(&b.merit));
    found
}

/// Weights of range, error of a step and decay that add up to 1, none of them zero.
fn mixtures() -> Vec<Objective> {
    const PARTS: u32 = 8;
    let mut all = Vec::new();
    for range in 1..PARTS - 1 {
        for error in 1..PARTS - range {
            let weight =
                |objective, parts: u32| Weight { objective, weight: f64::from(parts) / f64::from(PARTS) };
            all.push(Objective::Weighted(vec![
                weight(Objective::Range, range),
                weight(Objective::PerStep, error),
                weight(Objective::Decay, PARTS - range - error),
            ]));
        }
    }
    all
}
