use super::choice::Choice;
use super::fixed_steps::FixedSteps;
use crate::integrate::adaptive::{Family, Piece, SolveStatus, Statistics, VariableOrder};
use crate::integrate::error::IntegrateError;
use crate::integrate::field::Field;
use crate::math::Scalar;

/// What makes the steps of a solution.
pub(super) struct Engine<T> {
    stepper: Stepper<T>,
    tolerances: (f64, Vec<f64>),
    largest: Option<T>,
    /// What was done before the family changed.
    before: Statistics,
    /// What made steps so far.
    methods: Vec<String>,
    warnings: Vec<String>,
}

enum Stepper<T> {
    Variable(Box<VariableOrder<T>>),
    Fixed(Box<FixedSteps<T>>),
}

impl<T: Scalar> Engine<T> {
    pub(super) fn new(
        choice: &Choice<T>,
        field: &mut impl Field<T>,
        (t0, x0, end): (T, &[T], T),
        (relative, absolute): (f64, &[f64]),
    ) -> Result<Self, IntegrateError> {
        let mut variable = |family: Family| -> Result<_, IntegrateError> {
            let stepper = VariableOrder::new(family, field, t0, x0, end, relative, absolute)?;
            Ok((Stepper::Variable(Box::new(stepper)), family.id().to_owned()))
        };
        let (stepper, method) = match choice {
            Choice::Automatic => variable(Family::ADAMS)?,
            Choice::Family(family) => variable(*family)?,
            Choice::Method(method, step) => {
                let id = match method.predictor() {
                    Some(predictor) => format!("{}+{}", predictor.id(), method.row().id()),
                    None => method.row().id().to_owned(),
                };
                let fixed = FixedSteps::new(method.clone(), field, (t0, x0, end), *step)?;
                (Stepper::Fixed(Box::new(fixed)), id)
            }
        };
        let tolerances = (relative, absolute.to_vec());
        let (methods, warnings) = (vec![method], Vec::new());
        Ok(Self { stepper, tolerances, largest: None, before: Statistics::default(), methods, warnings })
    }

    /// Sets the length of the first step and the largest one, where they are given.
    pub(super) fn set_steps(&mut self, [first, largest]: [Option<T>; 2]) -> Result<(), IntegrateError> {
        for length in [first, largest].into_iter().flatten() {
            if !length.is_finite() || length == T::zero() {
                return Err(IntegrateError::SamplingGap { text: format!("{length:?}") });
            }
        }
        self.largest = largest;
        if let Stepper::Variable(stepper) = &mut self.stepper {
            if let Some(first) = first {
                stepper.set_step(first);
            }
            if let Some(largest) = largest {
                stepper.set_largest_step(largest);
            }
        }
        Ok(())
    }

    pub(super) fn time(&self) -> T {
        match &self.stepper {
            Stepper::Variable(stepper) => stepper.time(),
            Stepper::Fixed(stepper) => stepper.time(),
        }
    }

    pub(super) fn state(&self) -> &[T] {
        match &self.stepper {
            Stepper::Variable(stepper) => stepper.state(),
            Stepper::Fixed(stepper) => stepper.state(),
        }
    }

    /// The order of the last step.
    pub(super) fn order(&self) -> usize {
        match &self.stepper {
            Stepper::Variable(stepper) => stepper.last_order(),
            Stepper::Fixed(stepper) => stepper.order(),
        }
    }

    /// Writes the state at a time within the last step.
    pub(super) fn state_at(&self, t: T, out: &mut [T]) {
        match &self.stepper {
            Stepper::Variable(stepper) => stepper.state_at(t, out),
            Stepper::Fixed(stepper) => stepper.state_at(t, out),
        }
    }

    pub(super) fn piece(&self) -> Piece<T> {
        match &self.stepper {
            Stepper::Variable(stepper) => stepper.piece(),
            Stepper::Fixed(stepper) => stepper.piece(),
        }
    }

    pub(super) fn statistics(&self) -> Statistics {
        let mut statistics = self.before;
        statistics += match &self.stepper {
            Stepper::Variable(stepper) => stepper.statistics(),
            Stepper::Fixed(stepper) => stepper.statistics(),
        };
        statistics
    }

    pub(super) fn methods(&self) -> String {
        self.methods.join("+")
    }

    pub(super) fn warnings(&self) -> &[String] {
        &self.warnings
    }

    pub(super) fn advance(&mut self, field: &mut impl Field<T>) -> Option<SolveStatus> {
        match &mut self.stepper {
            Stepper::Variable(stepper) => {
                let status = stepper.advance(field);
                if stepper.is_stiff() && self.warnings.is_empty() {
                    let t = stepper.time();
                    self.warnings.push(format!(
                        "stiff from about t = {t:?} on: steps are bounded by the stability of the Adams formulas and not by their errors"
                    ));
                }
                status
            }
            Stepper::Fixed(stepper) => stepper.advance(field),
        }
    }

    /// Goes on by the other family where that is the better one.
    pub(super) fn change_family(&mut self, field: &mut impl Field<T>, end: T) -> Result<(), IntegrateError> {
        let Stepper::Variable(stepper) = &self.stepper else { return Ok(()) };
        let other = match (stepper.is_stiff(), stepper.is_nonstiff()) {
            (true, _) => Family::BDF,
            (_, true) => Family::ADAMS,
            _ => return Ok(()),
        };
        if stepper.time() == end {
            return Ok(());
        }
        let (relative, absolute) = (self.tolerances.0, &self.tolerances.1);
        let (t, x) = (stepper.time(), stepper.state().to_vec());
        let mut next = VariableOrder::new(other, field, t, &x, end, relative, absolute)?;
        if let Some(largest) = self.largest {
            next.set_largest_step(largest);
        }
        self.before += stepper.statistics();
        self.warnings.clear();
        if !self.methods.iter().any(|method| method == other.id()) {
            self.methods.push(other.id().to_owned());
        }
        self.stepper = Stepper::Variable(Box::new(next));
        Ok(())
    }
}
