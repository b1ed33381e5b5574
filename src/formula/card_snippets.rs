//! A row as text to paste: LaTeX, Rust, Python.

use std::fmt::Write;

use num_traits::{One, Signed, Zero};

use crate::math::{Rational, latex_fraction};

use super::analysis::Analysis;

/// The languages that a row can be written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Snippet {
    /// The recursion as a displayed equation.
    Latex,
    /// The weights and the recursion as a Rust function without dependencies.
    Rust,
    /// The weights as exact fractions and the recursion as a Python function without dependencies.
    Python,
}

impl Snippet {
    /// Returns the row of this id and these weights in the language.
    pub fn of(self, id: &str, analysis: &Analysis) -> String {
        match self {
            Self::Latex => latex(analysis),
            Self::Rust => code(id, analysis, &RUST),
            Self::Python => code(id, analysis, &PYTHON),
        }
    }
}

/// Returns the recursion of a row solved for the new state, as plain text such as `x_n+1 = 5/24 x_n + ... + sigma (2 f_n)`.
pub fn recursion(analysis: &Analysis) -> String {
    let plain = Notation { fraction: |c| c.to_string(), sample: plain_sample, sigma: "sigma", gap: " " };
    recursion_in(analysis, &plain)
}

fn latex(analysis: &Analysis) -> String {
    let notation = Notation { fraction: latex_fraction, sample: latex_sample, sigma: "\\sigma", gap: " " };
    format!("\\begin{{equation}}\n  {}\n\\end{{equation}}\n", recursion_in(analysis, &notation))
}

/// How numbers and samples are written.
struct Notation {
    fraction: fn(&Rational) -> String,
    /// A letter at the time n + 1 - j.
    sample: fn(&str, usize) -> String,
    sigma: &'static str,
    gap: &'static str,
}

fn plain_sample(letter: &str, j: usize) -> String {
    match j {
        0 => format!("{letter}_n+1"),
        1 => format!("{letter}_n"),
        _ => format!("{letter}_n-{}", j - 1),
    }
}

fn latex_sample(letter: &str, j: usize) -> String {
    match j {
        0 => format!("{letter}_{{n+1}}"),
        1 => format!("{letter}_{{n}}"),
        _ => format!("{letter}_{{n-{}}}", j - 1),
    }
}

fn recursion_in(analysis: &Analysis, notation: &Notation) -> String {
    let past: Vec<Rational> = analysis
        .alpha()
        .iter()
        .enumerate()
        .map(|(j, a)| if j == 0 { Rational::zero() } else { -a })
        .collect();
    let mut text = format!("{} = {}", (notation.sample)("x", 0), sum(&past, "x", notation));
    let slopes = [(analysis.beta(), "f"), (analysis.gamma(), "g")];
    for (weights, letter) in slopes.into_iter().take(if analysis.is_split() { 2 } else { 1 }) {
        let single = weights.iter().filter(|c| !c.is_zero()).count() == 1;
        let terms = sum(weights, letter, notation);
        let (sigma, gap) = (notation.sigma, notation.gap);
        let positive = weights.iter().all(|c| !c.is_negative());
        if single && positive {
            let _ = write!(text, " + {}", sum(weights, &format!("{sigma}{gap}{letter}"), notation));
        } else {
            let _ = write!(text, " + {sigma}{gap}({terms})");
        }
    }
    text
}

/// The weighted samples with their signs; `0` when there are none.
fn sum(weights: &[Rational], letter: &str, notation: &Notation) -> String {
    let mut text = String::new();
    for (j, c) in weights.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
        let sign = match (text.is_empty(), c.is_negative()) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        let size = c.abs();
        let factor = if size.is_one() {
            String::new()
        } else {
            format!("{}{}", (notation.fraction)(&size), notation.gap)
        };
        let _ = write!(text, "{sign}{factor}{}", (notation.sample)(letter, j));
    }
    if text.is_empty() { "0".to_owned() } else { text }
}

/// What differs between the programming languages.
struct Language {
    comment: &'static str,
    list: fn(&str, &[Rational]) -> String,
    function: fn(bool, bool) -> String,
    prologue: &'static str,
}

const RUST: Language = Language { comment: "//", list: rust_list, function: rust_function, prologue: "" };
const PYTHON: Language = Language {
    comment: "#",
    list: python_list,
    function: python_function,
    prologue: "from fractions import Fraction as F\n\n",
};

fn code(id: &str, analysis: &Analysis, language: &Language) -> String {
    let mark = language.comment;
    let mut text = format!("{mark} {id}: {}\n", recursion(analysis));
    let _ = writeln!(text, "{mark} Newest sample first: entry j belongs to time n+1-j.");
    text.push_str(language.prologue);
    text.push_str(&(language.list)("ALPHA", analysis.alpha()));
    text.push_str(&(language.list)("BETA", analysis.beta()));
    if analysis.is_split() {
        text.push_str(&(language.list)("GAMMA", analysis.gamma()));
    }
    text.push_str(&(language.function)(analysis.is_split(), analysis.is_explicit()));
    text
}

fn rust_list(name: &str, weights: &[Rational]) -> String {
    let number = |c: &Rational| {
        if c.is_integer() { format!("{}.0", c.numer()) } else { format!("{}.0 / {}.0", c.numer(), c.denom()) }
    };
    let numbers: Vec<String> = weights.iter().map(number).collect();
    format!("pub const {name}: [f64; {}] = [{}];\n", weights.len(), numbers.join(", "))
}

fn python_list(name: &str, weights: &[Rational]) -> String {
    let numbers: Vec<String> = weights.iter().map(|c| format!("F({}, {})", c.numer(), c.denom())).collect();
    format!("{name} = [{}]\n", numbers.join(", "))
}

/// What the function returns, in words.
fn returned(explicit: bool) -> &'static str {
    if explicit { "x_n+1" } else { "the part of x_n+1 that is known before f_n+1 is" }
}

fn rust_function(split: bool, explicit: bool) -> String {
    let (argument, term) = if split { (", g: &[f64]", " + GAMMA[j] * g[j - 1]") } else { ("", "") };
    let slopes = if split { "`f` and `g` hold their" } else { "`f` holds its" };
    format!(
        "\n/// Returns {} from past samples, newest first: `x` holds x_n, x_n-1, ...; {slopes} values there.\n\
         pub fn step(x: &[f64], f: &[f64]{argument}, sigma: f64) -> f64 {{\n    \
         (1..ALPHA.len()).map(|j| -ALPHA[j] * x[j - 1] + sigma * (BETA[j] * f[j - 1]{term})).sum()\n}}\n",
        returned(explicit)
    )
}

fn python_function(split: bool, explicit: bool) -> String {
    let (argument, term) = if split { ("g, ", " + GAMMA[j] * g[j - 1]") } else { ("", "") };
    format!(
        "\n\ndef step(x, f, {argument}sigma):\n    \"\"\"Return {} from past samples, newest first: x = [x_n, x_n-1, ...].\"\"\"\n    \
         return sum(-ALPHA[j] * x[j - 1] + sigma * (BETA[j] * f[j - 1]{term}) for j in range(1, len(ALPHA)))\n",
        returned(explicit)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::FormulaTable;

    fn of(id: &str) -> &'static Analysis {
        FormulaTable::builtin().get(id).expect("a built-in row").analysis()
    }

    #[test]
    fn the_recursion_reads_as_in_a_paper() {
        assert_eq!(
            recursion(of("la6-wang-guo")),
            "x_n+1 = 5/24 x_n + 1/2 x_n-1 + 1/4 x_n-2 + 1/6 x_n-3 - 1/8 x_n-4 + 2 sigma f_n"
        );
        assert_eq!(recursion(of("ab2")), "x_n+1 = x_n + sigma (3/2 f_n - 1/2 f_n-1)");
        assert_eq!(recursion(of("split-ab2")), "x_n+1 = x_n + sigma (3/2 f_n - 1/2 f_n-1) + sigma g_n");
        assert!(
            latex(of("ab2"))
                .contains("x_{n+1} = x_{n} + \\sigma (\\frac{3}{2} f_{n} - \\frac{1}{2} f_{n-1})")
        );
    }

    /// The snippet as it was written down; a build that compiles this test compiles the snippet too.
    mod snippet {
        #![allow(dead_code, unreachable_pub, missing_docs)]
        include!("../../tests/data/snippet_split_ab3.rs");
    }

    #[test]
    fn the_rust_snippet_compiles_and_steps_as_the_row_says() {
        let written = include_str!("../../tests/data/snippet_split_ab3.rs");
        assert_eq!(Snippet::Rust.of("split-ab3", of("split-ab3")), written);
        // One step of x' = f + g with f = 1, 2, 3 and g = 5 at the newest state: 7 + 0.1 ((23 - 32 + 15)/12 + 5).
        let stepped = snippet::step(&[7.0, 0.0, 0.0], &[1.0, 2.0, 3.0], &[5.0, 9.0, 9.0], 0.1);
        assert!((stepped - 7.55).abs() < 1e-14);
    }

    #[test]
    fn the_python_snippet_holds_the_exact_weights() {
        for formula in FormulaTable::builtin() {
            let text = Snippet::Python.of(formula.id(), formula.analysis());
            let read = |name: &str| -> Vec<Rational> {
                let line = text.lines().find(|line| line.starts_with(name)).expect("the list is there");
                line.split("F(")
                    .skip(1)
                    .map(|part| {
                        let (pair, _) = part.split_once(')').expect("a closing bracket");
                        crate::math::parse_rational(&pair.replace(", ", "/")).expect("a fraction")
                    })
                    .collect()
            };
            assert_eq!(read("ALPHA"), formula.alpha(), "{}", formula.id());
            assert_eq!(read("BETA"), formula.beta(), "{}", formula.id());
            assert_eq!(text.contains("GAMMA"), formula.is_split());
        }
    }
}
