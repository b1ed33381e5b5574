use std::fmt;
use std::ops::RangeInclusive;

/// What a family keeps of the past.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::integrate) enum Past {
    /// Derivatives: the next state is the integral of the polynomial through them (Adams).
    Derivatives,
    /// States: the polynomial through them has the derivative that the equation asks for (backward differentiation).
    States,
}

/// Formulas of one kind and all orders, of which a solver takes the one that goes furthest.
///
/// | family | formulas | orders | for |
/// |---|---|---|---|
/// | [`ADAMS`](Self::ADAMS) | Adams-Bashforth predicts, Adams-Moulton of one order more corrects, PECE | 1 to 12 | problems that are not stiff |
/// | [`BDF`](Self::BDF) | backward differentiation, solved by Newton's method | 1 to 5 | stiff problems |
///
/// ```
/// use kinstep::integrate::Family;
/// let low = Family::ADAMS.with_orders(1..=4).unwrap();
/// assert_eq!((low.id(), low.orders()), ("adams", 1..=4));
/// assert!(Family::BDF.with_orders(1..=7).is_none());
/// assert_eq!(Family::by_id("bdf"), Some(Family::BDF));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Family {
    id: &'static str,
    past: Past,
    lowest: usize,
    highest: usize,
}

impl Family {
    /// Adams-Bashforth-Moulton with variable coefficients, orders 1 to 12.
    pub const ADAMS: Self = Self { id: "adams", past: Past::Derivatives, lowest: 1, highest: 12 };
    /// Backward differentiation with variable coefficients and fixed leading coefficient, orders 1 to 5.
    pub const BDF: Self = Self { id: "bdf", past: Past::States, lowest: 1, highest: 5 };
    /// Both.
    pub const ALL: [Self; 2] = [Self::ADAMS, Self::BDF];

    /// Returns the family of that id.
    pub fn by_id(id: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|family| family.id == id)
    }

    /// Returns the id.
    pub fn id(self) -> &'static str {
        self.id
    }

    /// Returns the orders.
    pub fn orders(self) -> RangeInclusive<usize> {
        self.lowest..=self.highest
    }

    /// Returns the family with some of its orders, the lowest of which is one; `None` where it does not have them.
    pub fn with_orders(self, orders: RangeInclusive<usize>) -> Option<Self> {
        let (lowest, highest) = orders.into_inner();
        let whole = Self::by_id(self.id)?;
        (lowest == 1 && (lowest..=whole.highest).contains(&highest)).then_some(Self {
            lowest,
            highest,
            ..self
        })
    }

    pub(in crate::integrate) fn past(self) -> Past {
        self.past
    }

    pub(in crate::integrate) fn highest(self) -> usize {
        self.highest
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.id)
    }
}
