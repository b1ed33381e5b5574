//! Whether a problem can be studied at all: it begins somewhere, and its solution solves it.

use kinstep::integrate::{EquationField, Equations, Field};
use kinstep::math::DoubleDouble;
use num_traits::Zero;

/// A derivative that differs by more than this fraction contradicts the equations.
const CONTRADICTS: f64 = 1e-6;
/// How many times its own uncertainty a difference must be to count.
const CERTAIN: f64 = 1e3;
/// Times at which a solution is looked at.
const SAMPLES: usize = 48;
/// Steps of differences, as parts of the duration: slow solutions need long ones, fast ones short ones.
const STEPS: [f64; 4] = [1e-3, 1e-5, 1e-7, 1e-9];
/// Times that differences are halved.
const HALVINGS: usize = 4;

/// Which line of a problem is at fault, and why.
#[derive(Debug, PartialEq)]
pub(super) struct Fault {
    /// Which list of the problem.
    pub(super) list: &'static str,
    /// Which unknown the line is about.
    pub(super) unknown: usize,
    /// The sentence.
    pub(super) message: String,
}

/// Sees that a problem begins with finite numbers and that its solution, where it states one, agrees with its equations.
/// Returns how far that solution may be off for what is left of the disagreement.
pub(super) fn check(equations: &Equations, duration: f64) -> Result<f64, Fault> {
    begins(equations)?;
    let Some(solution) = equations.solution::<DoubleDouble>() else { return Ok(0.0) };
    let mut checked = Checked { equations, field: equations.field(), solution, duration };
    let start = checked.start()?;
    Ok(start + duration * checked.residual()?)
}

/// A run can not begin where the right-hand side is infinite or no number.
fn begins(equations: &Equations) -> Result<(), Fault> {
    let start = equations.initial::<DoubleDouble>();
    let names = equations.unknowns();
    let refuse = |list, unknown: usize, message| Err(Fault { list, unknown, message });
    if let Some(unknown) = start.iter().position(|entry| !entry.is_finite()) {
        let value = start[unknown].to_f64();
        return refuse(
            "initial",
            unknown,
            format!("{} begins at {value}, not a finite number", names[unknown]),
        );
    }
    let mut f = vec![DoubleDouble::zero(); start.len()];
    equations.field().evaluate(DoubleDouble::zero(), &start, &mut f, &mut []);
    let Some(unknown) = f.iter().position(|entry| !entry.is_finite()) else { return Ok(()) };
    let state = names.iter().zip(&start).take(6).map(|(name, x)| format!("{name} = {}", x.to_f64()));
    let message = format!(
        "the derivative of {} is {} at the start, t = 0, {}: no run can begin there; begin where it is finite",
        names[unknown],
        f[unknown].to_f64(),
        state.collect::<Vec<_>>().join(", ")
    );
    refuse("equations", unknown, message)
}

/// A problem whose stated solution is looked at.
struct Checked<'a, S> {
    equations: &'a Equations,
    field: EquationField<DoubleDouble>,
    solution: S,
    duration: f64,
}

impl<S: FnMut(DoubleDouble) -> Vec<DoubleDouble>> Checked<'_, S> {
    /// How far the solution is from the initial values.
    fn start(&mut self) -> Result<f64, Fault> {
        let (stated, initial) = ((self.solution)(DoubleDouble::zero()), self.equations.initial());
        let scale =
            initial.iter().chain(&stated).fold(0.0, |most: f64, x: &DoubleDouble| most.max(x.to_f64().abs()));
        let mut most = 0.0_f64;
        for (unknown, (&stated, &initial)) in stated.iter().zip(&initial).enumerate() {
            let off = (stated - initial).to_f64().abs();
            if off > CONTRADICTS * scale {
                let (name, stated, initial) =
                    (&self.equations.unknowns()[unknown], stated.to_f64(), initial.to_f64());
                let message = format!(
                    "the solution contradicts the start: at t = 0 it gives {name} = {stated}, while `initial` says {initial}; one of them is wrong"
                );
                return Err(Fault { list: "exact", unknown, message });
            }
            most = most.max(off);
        }
        Ok(most)
    }

    /// By how much the derivative of the solution differs from the right-hand side \[1/s\].
    fn residual(&mut self) -> Result<f64, Fault> {
        let dimension = self.equations.unknowns().len();
        let mut samples = Vec::new();
        for k in 0..SAMPLES {
            // Not at round times, where solutions have their zeros.
            let t = DoubleDouble::from(self.duration * (0.0213 + 0.9571 * k as f64 / SAMPLES as f64));
            let state = (self.solution)(t);
            let mut f = vec![DoubleDouble::zero(); dimension];
            self.field.evaluate(t, &state, &mut f, &mut []);
            samples.push((t, f, self.derivative(t)));
        }
        let mut most = 0.0_f64;
        for unknown in 0..dimension {
            let sizes =
                samples.iter().flat_map(|(_, f, x)| [f[unknown], x[unknown].0]).map(|v| v.to_f64().abs());
            let scale = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
            let mut worst: Option<(f64, usize)> = None;
            for (k, (_, f, stated)) in samples.iter().enumerate() {
                let (derivative, uncertainty) = stated[unknown];
                let off = (f[unknown] - derivative).to_f64().abs();
                if off > CERTAIN * uncertainty && worst.is_none_or(|(most, _)| off > most) {
                    worst = Some((off, k));
                }
            }
            let Some((off, k)) = worst else { continue };
            if off > CONTRADICTS * scale {
                let (t, f, stated) = &samples[k];
                return Err(self.contradiction(
                    unknown,
                    t.to_f64(),
                    stated[unknown].0.to_f64(),
                    f[unknown].to_f64(),
                ));
            }
            most = most.max(off);
        }
        Ok(most)
    }

    fn contradiction(&self, unknown: usize, t: f64, stated: f64, f: f64) -> Fault {
        let name = &self.equations.unknowns()[unknown];
        let message = format!(
            "the solution contradicts the equations: at t = {t:.6} the derivative of {name} is {stated:.9} by `exact`, and {f:.9} by the equation for {name}' at that solution; one of them is wrong"
        );
        Fault { list: "exact", unknown, message }
    }

    /// The derivative of every entry of the solution by extrapolated central differences, and how far it may be off.
    fn derivative(&mut self, t: DoubleDouble) -> Vec<(DoubleDouble, f64)> {
        let mut best: Vec<(DoubleDouble, f64)> = Vec::new();
        for part in STEPS {
            let found = self.differences(t, DoubleDouble::from(part * self.duration));
            if best.is_empty() {
                best.clone_from(&found);
            }
            for (best, found) in best.iter_mut().zip(found) {
                if found.1 < best.1 {
                    *best = found;
                }
            }
        }
        best
    }

    fn differences(&mut self, t: DoubleDouble, step: DoubleDouble) -> Vec<(DoubleDouble, f64)> {
        let number = |value: f64| DoubleDouble::from(value);
        let mut step = step;
        let mut last: Vec<Vec<DoubleDouble>> = Vec::new();
        let mut uncertainty = Vec::new();
        for _ in 0..HALVINGS {
            let (after, before) = ((self.solution)(t + step), (self.solution)(t - step));
            let twice = step + step;
            let mut row = vec![after.iter().zip(&before).map(|(&a, &b)| (a - b) / twice).collect::<Vec<_>>()];
            let mut four = 1.0;
            for k in 0..last.len() {
                four *= 4.0;
                let better =
                    |(&new, &old): (&DoubleDouble, &DoubleDouble)| new + (new - old) / number(four - 1.0);
                row.push(row[k].iter().zip(&last[k]).map(better).collect());
            }
            if let (Some(new), Some(old)) = (row.last(), last.last()) {
                uncertainty = new.iter().zip(old).map(|(&a, &b)| (a - b).to_f64().abs()).collect();
            }
            step = step * number(0.5);
            last = row;
        }
        let best = last.pop().unwrap_or_default();
        let finite = |x: f64| if x.is_finite() { x } else { f64::INFINITY };
        best.into_iter().zip(uncertainty).map(|(x, u)| (x, finite(u))).collect()
    }
}
