use super::Solution;
use super::crossing::root;
use super::engine::Engine;
use super::event::Event;
use super::solution::{Happening, Sample, StepRecord};
use crate::integrate::adaptive::{Piece, SolveStatus};
use crate::integrate::error::IntegrateError;
use crate::math::Scalar;

/// Into how many parts a step is taken to look for events: what crosses zero twice within one of them is missed.
const PARTS: usize = 4;

/// What is observed of a solution while it is made.
pub(super) struct Run<'e, T> {
    before: T,
    /// Where a terminal event ended it.
    stop: Option<(T, Vec<T>)>,
    times: Vec<T>,
    samples: Vec<Sample<T>>,
    events: Vec<Watched<'e, T>>,
    happened: Vec<Happening<T>>,
    steps: Option<Vec<StepRecord<T>>>,
    pieces: Option<Vec<Piece<T>>>,
    state: Vec<T>,
}

/// An event, with the last value of its function that was not zero.
struct Watched<'e, T> {
    event: Event<'e, T>,
    value: f64,
    /// Whether the function has been zero since: then that crossing has been told.
    is_told: bool,
}

impl<'e, T: Scalar> Run<'e, T> {
    pub(super) fn new(
        (t0, x0, end): (T, &[T], T),
        times: Vec<T>,
        events: Vec<Event<'e, T>>,
        keeps_steps: bool,
        is_dense: bool,
    ) -> Result<Self, IntegrateError> {
        let is_within = |t: &T| (*t - t0).to_f64() * (*t - end).to_f64() <= 0.0;
        if let Some(t) = times.iter().find(|t| !is_within(t)) {
            let (t, start, end) = (format!("{t:?}"), format!("{t0:?}"), format!("{end:?}"));
            return Err(IntegrateError::SampleTime { t, start, end });
        }
        let watch = |mut event: Event<'e, T>| {
            let value = event.value(t0, x0);
            Watched { event, value, is_told: value == 0.0 }
        };
        let start = || StepRecord { t: t0, x: x0.to_vec(), order: 0 };
        let mut run = Self {
            before: t0,
            stop: None,
            times,
            samples: Vec::new(),
            events: events.into_iter().map(watch).collect(),
            happened: Vec::new(),
            steps: keeps_steps.then(|| vec![start()]),
            pieces: is_dense.then(Vec::new),
            state: x0.to_vec(),
        };
        // Times at the start, and then in the order in which they are met.
        let ahead = |t: &T| (*t - t0).to_f64().abs();
        run.times.sort_by(|a, b| ahead(a).total_cmp(&ahead(b)));
        run.times.reverse();
        while run.times.last().is_some_and(|t| *t == t0) {
            run.times.pop();
            run.samples.push(Sample { t: t0, x: x0.to_vec() });
        }
        Ok(run)
    }

    /// Whether it has come to a terminal event.
    pub(super) fn is_at_event(&self) -> bool {
        self.stop.is_some()
    }

    /// Takes what there is to see of the last step.
    pub(super) fn take_step(&mut self, engine: &Engine<T>) {
        if !self.events.is_empty() {
            self.look_for_events(engine);
        }
        let now = self.stop.as_ref().map_or(engine.time(), |(t, _)| *t);
        let start = self.before;
        while let Some(t) = self.times.last().copied() {
            if (t - start).to_f64() * (t - now).to_f64() > 0.0 {
                break;
            }
            self.times.pop();
            if t == engine.time() {
                self.state.copy_from_slice(engine.state());
            } else {
                engine.state_at(t, &mut self.state);
            }
            self.samples.push(Sample { t, x: self.state.clone() });
        }
        if let Some(pieces) = &mut self.pieces {
            let mut piece = engine.piece();
            piece.times[0] = start;
            pieces.push(piece);
        }
        if let Some(steps) = &mut self.steps {
            let x = self.stop.as_ref().map_or_else(|| engine.state().to_vec(), |(_, x)| x.clone());
            steps.push(StepRecord { t: now, x, order: engine.order() });
        }
        self.before = now;
    }

    fn look_for_events(&mut self, engine: &Engine<T>) {
        let (start, end) = (self.before, engine.time());
        let mut found: Vec<(usize, T)> = Vec::new();
        let mut state = std::mem::take(&mut self.state);
        for (place, watched) in self.events.iter_mut().enumerate() {
            let mut at = start;
            for part in 1..=PARTS {
                let next = if part == PARTS {
                    end
                } else {
                    start + (end - start) * T::from_f64(part as f64 / PARTS as f64)
                };
                if let Some(t) = watched.crossing(engine, [at, next], &mut state) {
                    found.push((place, t));
                }
                at = next;
            }
        }
        found.sort_by(|a, b| (a.1 - start).to_f64().abs().total_cmp(&(b.1 - start).to_f64().abs()));
        for (place, t) in found {
            engine.state_at(t, &mut state);
            let event = &self.events[place].event;
            let name = event.name().to_owned();
            self.happened.push(Happening { event: place, name, t, x: state.clone() });
            if event.is_terminal() {
                self.stop = Some((t, state.clone()));
                break;
            }
        }
        self.state = state;
    }

    pub(super) fn finish(self, status: SolveStatus, engine: &Engine<T>) -> Solution<T> {
        let (t, x) = self.stop.unwrap_or_else(|| (engine.time(), engine.state().to_vec()));
        Solution {
            status,
            reason: reason(status, t),
            method: engine.methods(),
            t,
            x,
            samples: self.samples,
            events: self.happened,
            steps: self.steps.unwrap_or_default(),
            statistics: engine.statistics(),
            warnings: engine.warnings().to_vec(),
            pieces: self.pieces.unwrap_or_default(),
        }
    }
}

impl<T: Scalar> Watched<'_, T> {
    /// Where the function crosses zero between two times within the last step, in the direction that is asked for.
    fn crossing(&mut self, engine: &Engine<T>, [from, to]: [T; 2], state: &mut [T]) -> Option<T> {
        let value = self.value_at(engine, to, state);
        let (before, was_told) = (self.value, self.is_told);
        self.is_told = value == 0.0 && (was_told || before != 0.0);
        if value != 0.0 && !value.is_nan() {
            self.value = value;
        }
        let changes = value == 0.0 || (value > 0.0) != (before > 0.0);
        if before == 0.0 || before.is_nan() || value.is_nan() || !changes || was_told {
            return None;
        }
        if !self.event.is_crossed(before, value) {
            return None;
        }
        if value == 0.0 {
            return Some(to);
        }
        let whole = to - from;
        let at = |s: f64| from + whole * T::from_f64(s);
        let start = self.value_at(engine, from, state);
        let start = if start == 0.0 || (start > 0.0) != (before > 0.0) { before } else { start };
        let s = root([0.0, 1.0], [start, value], |s| self.value_at(engine, at(s), state));
        Some(if s >= 1.0 { to } else { at(s) })
    }

    fn value_at(&mut self, engine: &Engine<T>, t: T, state: &mut [T]) -> f64 {
        if t == engine.time() {
            state.copy_from_slice(engine.state());
        } else {
            engine.state_at(t, state);
        }
        self.event.value(t, state)
    }
}

/// Why a solution did not come to its end.
fn reason<T: Scalar>(status: SolveStatus, t: T) -> Option<String> {
    let sentence = match status {
        SolveStatus::Completed | SolveStatus::Event => return None,
        SolveStatus::NonFinite => "the right-hand side is infinite or NaN behind",
        SolveStatus::StepTooSmall => {
            "no step is short enough for the tolerances (a singularity, or tolerances below what the numbers resolve) at"
        }
        SolveStatus::TooManySteps => "as many steps as are allowed were made up to",
        SolveStatus::NoConvergence => {
            "the equation of an implicit step could not be solved, however short the step, at"
        }
    };
    Some(format!("{sentence} t = {t:?}"))
}
