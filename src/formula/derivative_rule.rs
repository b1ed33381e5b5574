//! Differences that take the velocity of a streamed reference from its past samples.

use std::sync::LazyLock;

use num_traits::{One, Zero};
use serde::Deserialize;

use crate::math::{Rational, parse_rational, rational_to_f64};

const BUILTIN: &str = include_str!("derivative_rules.toml");

/// A rule for the derivative of a sampled signal: x'(t_n) ~ (1/sigma) sum_j a_j x_(n-j), from samples up to the present
/// one, newest first.
///
/// ```
/// use kinstep::formula::DerivativeRule;
/// let rule = DerivativeRule::get("bd3").ok_or("no such rule")?;
/// assert_eq!((rule.order(), rule.error_constant().to_string()), (3, "-1/4".to_owned()));
/// assert!((rule.noise_gain() - 3.836954811074).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct DerivativeRule {
    id: String,
    name: String,
    source: String,
    weights: Vec<Rational>,
    order: usize,
    error_constant: Rational,
}

/// A rule as its file has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    id: String,
    name: String,
    difference: Vec<i64>,
    denominator: i64,
    order: usize,
    error_constant: String,
    source: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    derivative_rule: Vec<Written>,
}

impl DerivativeRule {
    /// Returns the built-in rules, each checked against what it declares.
    ///
    /// # Panics
    /// Never in a build whose tests have passed: they read this table.
    pub fn builtin() -> &'static [Self] {
        static RULES: LazyLock<Vec<DerivativeRule>> = LazyLock::new(|| {
            read(BUILTIN)
                .unwrap_or_else(|error| panic!("the built-in derivative rules are at fault: {error}"))
        });
        &RULES
    }

    /// Returns the built-in rule of an id.
    pub fn get(id: &str) -> Option<&'static Self> {
        Self::builtin().iter().find(|rule| rule.id == id)
    }

    /// Returns the rule with these weights of x_n, x_(n-1), ..., `None` where they are no consistent rule for a derivative.
    pub fn new(id: &str, name: &str, source: &str, weights: Vec<Rational>) -> Option<Self> {
        let (order, error_constant) = order_of(&weights)?;
        let [id, name, source] = [id, name, source].map(str::to_owned);
        Some(Self { id, name, source, weights, order, error_constant })
    }

    /// Returns the id of the rule.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Returns the name of the rule for people.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns where the weights are from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Returns a_0, a_1, ...: the weights of x_n, x_(n-1), ...
    pub fn weights(&self) -> &[Rational] {
        &self.weights
    }

    /// Returns the order q: the error is O(sigma^q).
    pub fn order(&self) -> usize {
        self.order
    }

    /// Returns c of rule = x' + c sigma^q x^(q+1) + ...
    pub fn error_constant(&self) -> &Rational {
        &self.error_constant
    }

    /// Returns the l2 norm of the weights: white noise of unit strength in the samples becomes this much over sigma
    /// in the derivative.
    pub fn noise_gain(&self) -> f64 {
        rational_to_f64(&self.weights.iter().map(|a| a * a).sum()).sqrt()
    }
}

/// sum_j a_j (-j)^m, which is 1 for m = 1 and 0 for the other m up to the order.
fn moment(weights: &[Rational], m: usize) -> Rational {
    let power = |j: usize| num_traits::pow(-Rational::from_integer(j.into()), m);
    weights.iter().enumerate().map(|(j, a)| a * power(j)).sum()
}

/// The order and the error constant, `None` for weights that miss the derivative itself.
fn order_of(weights: &[Rational]) -> Option<(usize, Rational)> {
    let defect = |m: usize| moment(weights, m) - if m == 1 { Rational::one() } else { Rational::zero() };
    if weights.is_empty() || !defect(0).is_zero() || !defect(1).is_zero() {
        return None;
    }
    // s + 1 weights meet at most s + 1 conditions: the search ends.
    let first = (2..=weights.len() + 1).find(|&m| !defect(m).is_zero())?;
    let factorial: Rational = (1..=first).map(|k| Rational::from_integer(k.into())).product();
    Some((first - 1, defect(first) / factorial))
}

fn read(text: &str) -> Result<Vec<DerivativeRule>, String> {
    let file: File = toml::from_str(text).map_err(|error| error.to_string())?;
    file.derivative_rule.into_iter().map(checked).collect()
}

fn checked(written: Written) -> Result<DerivativeRule, String> {
    let Written { id, name, difference, denominator, order, error_constant, source } = written;
    if denominator == 0 {
        return Err(format!("rule {id} has the denominator 0"));
    }
    let weights = difference.iter().map(|a| Rational::new((*a).into(), denominator.into())).collect();
    let rule = DerivativeRule::new(&id, &name, &source, weights)
        .ok_or_else(|| format!("rule {id} is no rule for a derivative"))?;
    let declared = parse_rational(&error_constant).map_err(|error| format!("rule {id}: {error}"))?;
    if rule.order != order || rule.error_constant != declared {
        let (p, c) = (rule.order, &rule.error_constant);
        return Err(format!("rule {id} has order {p} and error constant {c}, not {order} and {declared}"));
    }
    Ok(rule)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backward_differences_have_the_constants_of_the_textbook() {
        // c = -1/(q+1) for the backward difference of order q.
        for (rule, q) in DerivativeRule::builtin().iter().zip(1_usize..) {
            assert_eq!(rule.order(), q);
            assert_eq!(*rule.error_constant(), Rational::new((-1).into(), (q + 1).into()));
        }
        let gains: Vec<f64> = DerivativeRule::builtin().iter().map(DerivativeRule::noise_gain).collect();
        let known = [
            std::f64::consts::SQRT_2,
            2.549_509_756_796,
            3.836_954_811_074,
            5.583_955_189_25,
            8.241_797_268_935,
            12.578_840_257_441,
        ];
        assert!(gains.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-11), "{gains:?}");
    }

    #[test]
    fn is_exact_on_polynomials_up_to_its_order() {
        for rule in DerivativeRule::builtin() {
            for power in 0..=rule.order() as u32 {
                let sampled: Rational = rule
                    .weights()
                    .iter()
                    .enumerate()
                    .map(|(j, a)| {
                        a * Rational::from_integer(
                            (7 - i64::try_from(j).expect("few weights")).pow(power).into(),
                        )
                    })
                    .sum();
                let slope = if power == 0 { 0 } else { i64::from(power) * 7_i64.pow(power - 1) };
                assert_eq!(sampled, Rational::from_integer(slope.into()), "{} {power}", rule.id());
            }
        }
    }

    #[test]
    fn refuses_a_rule_that_lies_about_itself() {
        let lying = BUILTIN.replacen("\"-1/3\"", "\"-1/4\"", 1);
        assert_eq!(read(&lying).unwrap_err(), "rule bd2 has order 2 and error constant -1/3, not 2 and -1/4");
        let broken = BUILTIN.replacen("[3, -4, 1]", "[3, -4, 2]", 1);
        assert_eq!(read(&broken).unwrap_err(), "rule bd2 is no rule for a derivative");
    }
}
