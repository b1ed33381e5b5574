//! What a search is for.

use crate::formula::Formula;

use super::error::SearchError;
use super::figures::Figures;

/// What a search makes best.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Objective {
    /// The largest h_max.
    Range,
    /// The smallest r_opt.
    Decay,
    /// The smallest |c|.
    ErrorConstant,
    /// The smallest |C| = |c beta(1)|.
    PerStep,
    /// The smallest gain of noise in phi' at h_opt.
    Noise,
    /// The smallest C/h_opt.
    Steady,
    /// The smallest C/(h_max (1 - r_opt)).
    Economy,
    /// A product of powers of the others.
    Weighted(Vec<Weight>),
    /// No worse than a formula in h_max, C and r_opt, and as much better as can be in one of them.
    Beat(Target),
}

/// A simple objective and its exponent.
#[derive(Debug, Clone, PartialEq)]
pub struct Weight {
    /// The objective that is weighted.
    pub objective: Objective,
    /// The exponent of the objective, positive.
    pub weight: f64,
}

/// The figures of a formula to be surpassed.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// The id of the formula.
    pub id: String,
    /// The exactly decided figures of the formula.
    pub figures: Figures,
}

const WORDS: [(&str, Objective); 7] = [
    ("range", Objective::Range),
    ("decay", Objective::Decay),
    ("error-constant", Objective::ErrorConstant),
    ("per-step", Objective::PerStep),
    ("noise", Objective::Noise),
    ("steady", Objective::Steady),
    ("economy", Objective::Economy),
];

impl Objective {
    /// Returns the objective of a word such as `range`, or of weights such as `range=2,decay=1`.
    ///
    /// # Errors
    /// [`SearchError`] for unknown words and for weights that are no positive numbers.
    ///
    /// ```
    /// use kinstep::formula::search::Objective;
    /// assert_eq!(Objective::parse("decay")?, Objective::Decay);
    /// assert!(Objective::parse("rnge").unwrap_err().to_string().contains("nearest: range"));
    /// # Ok::<(), kinstep::formula::search::SearchError>(())
    /// ```
    pub fn parse(text: &str) -> Result<Self, SearchError> {
        if !text.contains(['=', ',']) {
            return of_word(text.trim());
        }
        let weight = |part: &str| {
            let (word, weight) = part.split_once('=').unwrap_or((part, "1"));
            let objective = of_word(word.trim())?;
            match weight.trim().parse::<f64>() {
                Ok(weight) if weight > 0.0 && weight.is_finite() => Ok(Weight { objective, weight }),
                _ => Err(SearchError::Weight { word: word.to_owned(), text: weight.to_owned() }),
            }
        };
        text.split(',').map(weight).collect::<Result<_, _>>().map(Self::Weighted)
    }

    /// Returns the objective of surpassing a formula.
    ///
    /// # Errors
    /// [`SearchError::NoTarget`] for a formula without a feedback range.
    pub fn beating(formula: &Formula) -> Result<Self, SearchError> {
        let id = formula.id().to_owned();
        match Figures::exact(formula.analysis()) {
            Some(figures) => Ok(Self::Beat(Target { id, figures })),
            None => Err(SearchError::NoTarget { id }),
        }
    }

    /// Returns the word for the objective, fit for an id.
    pub fn word(&self) -> String {
        match self {
            Self::Weighted(weights) => {
                weights.iter().map(|w| w.objective.word()).collect::<Vec<_>>().join("-")
            }
            Self::Beat(target) => format!("beats-{}", target.id),
            simple => WORDS
                .iter()
                .find(|(_, objective)| objective == simple)
                .map_or_else(String::new, |(word, _)| (*word).to_owned()),
        }
    }

    /// Returns the logarithm of what is to be small; for [`Objective::Beat`] minus the best improvement where the figures are
    /// nowhere worse, else how much worse the worst is.
    pub fn merit(&self, figures: &Figures) -> f64 {
        match self {
            Self::Range => -figures.h_max.ln(),
            Self::Decay => figures.radius().ln(),
            Self::ErrorConstant => figures.error_constant.ln(),
            Self::PerStep => figures.per_step.ln(),
            Self::Noise => figures.noise.ln(),
            Self::Steady => figures.steady().ln(),
            Self::Economy => figures.economy().ln(),
            Self::Weighted(weights) => weights.iter().map(|w| w.weight * w.objective.merit(figures)).sum(),
            Self::Beat(target) => {
                let t = &target.figures;
                let gains = [
                    (figures.h_max / t.h_max).ln(),
                    (t.per_step / figures.per_step).ln(),
                    (t.radius() / figures.radius()).ln(),
                ];
                let least = gains.iter().copied().fold(f64::INFINITY, f64::min);
                let most = gains.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                if least < -1e-12 { -least } else { -most }
            }
        }
    }

    /// Returns the figure that the objective makes large or small.
    pub fn value(&self, figures: &Figures) -> f64 {
        match self {
            Self::Range => figures.h_max,
            // The merit keeps it off zero.
            Self::Decay => figures.r_opt,
            Self::Beat(_) => (-self.merit(figures)).exp_m1(),
            _ => self.merit(figures).exp(),
        }
    }

    /// Whether h_opt and r_opt are needed.
    pub(super) fn needs_optimum(&self) -> bool {
        match self {
            Self::Range | Self::ErrorConstant | Self::PerStep => false,
            Self::Weighted(weights) => weights.iter().any(|w| w.objective.needs_optimum()),
            _ => true,
        }
    }

    /// Whether the gain of noise is needed.
    pub(super) fn needs_noise(&self) -> bool {
        match self {
            Self::Noise => true,
            Self::Weighted(weights) => weights.iter().any(|w| w.objective.needs_noise()),
            _ => false,
        }
    }
}

fn of_word(word: &str) -> Result<Objective, SearchError> {
    if let Some((_, objective)) = WORDS.iter().find(|(known, _)| *known == word) {
        return Ok(objective.clone());
    }
    let known: Vec<&str> = WORDS.iter().map(|(word, _)| *word).collect();
    let nearest = known
        .iter()
        .map(|known| (strsim::jaro_winkler(word, known), known))
        .filter(|(likeness, _)| *likeness >= 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    Err(SearchError::UnknownObjective {
        word: crate::math::shortened(word),
        nearest: nearest.map(|(_, word)| (*word).to_owned()),
        known: known.join(", "),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIGURES: Figures =
        Figures { h_max: 2.0, per_step: 0.5, error_constant: 0.25, h_opt: 1.0, r_opt: 0.5, noise: 3.0 };

    #[test]
    fn weights_multiply_and_bad_ones_are_refused() {
        let both = Objective::parse("range=2,decay=1").expect("two weights");
        assert!((both.value(&FIGURES) - 0.5 / 4.0).abs() < 1e-15);
        assert!(matches!(Objective::parse("range=-1"), Err(SearchError::Weight { .. })));
        assert!(matches!(Objective::parse("range=nan,decay"), Err(SearchError::Weight { .. })));
        assert!(matches!(Objective::parse("speed"), Err(SearchError::UnknownObjective { .. })));
    }

    #[test]
    fn beating_means_nowhere_worse() {
        let beat = Objective::Beat(Target { id: "t".to_owned(), figures: FIGURES });
        let wider = Figures { h_max: 2.2, ..FIGURES };
        assert!((beat.value(&wider) - 0.1).abs() < 1e-12);
        assert!(beat.merit(&Figures { r_opt: 0.6, ..wider }) > 0.0);
    }
}
