//! Strong stability preservation: bounds that Euler's method keeps and a multistep method keeps too.

use num_traits::{Signed, Zero};

use crate::math::Rational;

/// Returns c = min over beta_j > 0 of -alpha_j/beta_j, j >= 1, for rows whose recursion weights -alpha_j and beta_j are
/// nowhere negative; `None` for others and where c = 0.
///
/// Whatever convex bound x + sigma f(x) keeps for sigma up to sigma_E, the row keeps for sigma up to c sigma_E: its step is a mean of
/// such Euler steps (Shu 1988; Gottlieb, Ketcheson and Shu 2011, chapter 8). beta_0 of an implicit row may be positive and does
/// not enter.
pub(crate) fn ssp_coefficient(alpha: &[Rational], beta: &[Rational]) -> Option<Rational> {
    let averages = alpha.iter().skip(1).all(|a| !a.is_positive()) && beta.iter().all(|b| !b.is_negative());
    let ratios = alpha.iter().zip(beta).skip(1).filter(|(_, b)| b.is_positive()).map(|(a, b)| -a / b);
    ratios.min().filter(|c| averages && !c.is_zero())
}

#[cfg(test)]
mod tests {
    use crate::formula::FormulaTable;

    #[test]
    fn finds_the_coefficients_of_the_literature() {
        // Shu's three-step row of order two has c = 1/2, Euler's c = 1; Adams-Bashforth has none.
        let of = |id: &str| {
            let formula = FormulaTable::builtin().get(id).expect("a built-in row");
            formula.analysis().ssp_coefficient().map(|c| c.to_string())
        };
        assert_eq!(of("la2-euler").as_deref(), Some("1"));
        assert_eq!(of("ab3"), None);
        assert_eq!(of("la6-wang-guo"), None);
    }

    #[test]
    fn every_row_of_the_ssp_family_has_one() {
        let mut count = 0;
        for formula in FormulaTable::builtin().iter().filter(|formula| formula.family() == "ssp-lmm") {
            count += 1;
            assert!(formula.analysis().ssp_coefficient().is_some(), "{}", formula.id());
        }
        assert!(count >= 5);
    }

    #[test]
    fn no_look_ahead_row_of_order_three_has_one() {
        let rows =
            FormulaTable::builtin().iter().filter(|row| row.family() == "look-ahead" && row.order() >= 3);
        rows.for_each(|row| assert_eq!(row.analysis().ssp_coefficient(), None, "{}", row.id()));
    }
}
