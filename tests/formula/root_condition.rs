//! The root condition on polynomials whose roots are known by construction: no wrong verdict is allowed.

use std::collections::BTreeMap;

use kinstep::math::{Polynomial, Rational, RootCondition, is_schur, root_condition, root_moduli};

/// A small generator with a fixed seed, so that a failing case can be found again.
struct Dice(u64);

impl Dice {
    /// A number below `bound` (splitmix64).
    fn below(&mut self, bound: u64) -> i64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % bound).cast_signed()
    }

    /// A fraction strictly between -1 and 1.
    fn proper(&mut self) -> Rational {
        let denominator = self.below(30) + 2;
        Rational::new(
            (self.below(2 * denominator.unsigned_abs() - 1) - denominator + 1).into(),
            denominator.into(),
        )
    }
}

fn whole(n: i64) -> Rational {
    Rational::from_integer(n.into())
}

/// z - root
fn linear(root: Rational) -> Polynomial {
    Polynomial::from_rationals_descending(&[whole(1), -root])
}

/// z^2 - 2 r c z + r^2: a pair of modulus r and cosine c.
fn pair(radius: &Rational, cosine: &Rational) -> Polynomial {
    let middle = -(whole(2) * radius * cosine);
    Polynomial::from_rationals_descending(&[whole(1), middle, radius * radius])
}

/// A polynomial being built from factors, and what its verdict must be.
struct Specimen {
    product: Polynomial,
    outside: bool,
    /// How often each circle factor is in it, by its text.
    on_circle: BTreeMap<String, usize>,
}

impl Specimen {
    fn new() -> Self {
        Self { product: Polynomial::constant(1), outside: false, on_circle: BTreeMap::new() }
    }

    fn times(&mut self, factor: &Polynomial) {
        self.product = &self.product * factor;
    }

    fn times_on_circle(&mut self, factor: &Polynomial) {
        self.times(factor);
        *self.on_circle.entry(factor.to_text("z")).or_default() += 1;
    }

    fn verdict(&self) -> RootCondition {
        if self.outside || self.on_circle.values().any(|count| *count > 1) {
            RootCondition::Unstable
        } else if self.on_circle.keys().any(|factor| factor != "z - 1") {
            RootCondition::WeaklyStable
        } else {
            RootCondition::StrictlyStable
        }
    }
}

fn specimen(case: usize, dice: &mut Dice) -> Specimen {
    let hair = Rational::new(1.into(), 1_000_000_000_000_i64.into());
    let mut specimen = Specimen::new();
    for _ in 0..dice.below(3) {
        specimen.times(&linear(dice.proper()));
    }
    for _ in 0..dice.below(3) {
        let radius = dice.proper();
        specimen.times(&pair(&radius, &dice.proper()));
    }
    if dice.below(4) > 0 {
        specimen.times_on_circle(&linear(whole(1)));
    }
    match case % 3 {
        0 => {
            for _ in 0..=dice.below(2) {
                let factor = pair(&whole(1), &dice.proper());
                specimen.times_on_circle(&factor);
                if dice.below(3) == 0 {
                    specimen.times_on_circle(&factor);
                }
            }
        }
        1 => {
            let outside = dice.below(2) == 0;
            let radius = if outside { whole(1) + &hair } else { whole(1) - &hair };
            specimen.outside |= outside;
            if dice.below(2) == 0 {
                specimen.times(&pair(&radius, &dice.proper()));
            } else {
                specimen.times(&linear(if dice.below(2) == 0 { radius } else { -radius }));
            }
        }
        _ => match dice.below(5) {
            0 => specimen.times_on_circle(&linear(whole(-1))),
            1 => {
                specimen.times_on_circle(&linear(whole(-1)));
                specimen.times_on_circle(&linear(whole(-1)));
            }
            2 => {
                // A root and its mirror image in the circle: they hide in gcd(rho, rho*) among the circle's own.
                let inside = dice.proper() / whole(3) + Rational::new(1.into(), 2.into());
                specimen.outside = true;
                specimen.times(&linear(inside.recip()));
                specimen.times(&linear(inside));
            }
            3 => {
                specimen.outside = true;
                specimen.times(&pair(&(whole(2) + dice.proper()), &dice.proper()));
            }
            _ => specimen.times(&Polynomial::power(2)),
        },
    }
    specimen
}

#[test]
fn no_verdict_is_wrong_in_five_thousand() {
    let mut dice = Dice(20_201_545);
    let mut seen = BTreeMap::new();
    for case in 0..5000 {
        let specimen = specimen(case, &mut dice);
        let expected = specimen.verdict();
        let found = root_condition(&specimen.product);
        assert_eq!(found, expected, "case {case}: {}", specimen.product);
        *seen.entry(format!("{expected:?}")).or_insert(0) += 1;
    }
    assert!(seen.len() == 3 && seen.values().all(|count| *count > 500), "the sample is one-sided: {seen:?}");
}

#[test]
fn the_inside_of_the_circle_agrees_with_the_verdict() {
    let mut dice = Dice(7);
    for case in 0..1500 {
        let specimen = specimen(case, &mut dice);
        let strictly_inside = !specimen.outside && specimen.on_circle.is_empty();
        assert_eq!(is_schur(&specimen.product), strictly_inside, "case {case}: {}", specimen.product);
    }
}

#[test]
fn shown_moduli_are_clean_even_for_double_roots_on_the_circle() {
    let mut dice = Dice(99);
    for case in (0..600).step_by(3) {
        let specimen = specimen(case, &mut dice);
        let on_circle =
            specimen.on_circle.iter().map(|(factor, n)| n * if factor.contains("z^2") { 2 } else { 1 });
        let near_one = root_moduli(&specimen.product).iter().filter(|m| (*m - 1.0).abs() < 1e-15).count();
        assert_eq!(near_one, on_circle.sum::<usize>(), "case {case}: {}", specimen.product);
    }
}
