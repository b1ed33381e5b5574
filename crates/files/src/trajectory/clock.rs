//! Times as messages have them: whole seconds and nanoseconds.

/// Nanoseconds in a second.
const BILLION: u32 = 1_000_000_000;

/// A time or a span of seconds and nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Stamp {
    pub(super) sec: i32,
    pub(super) nanosec: u32,
}

impl Stamp {
    pub(super) const ZERO: Self = Self { sec: 0, nanosec: 0 };

    /// Returns a time \[s\] rounded to nanoseconds; nothing where it has more than 31 bits of seconds, or is none.
    pub(super) fn of(seconds: f64) -> Option<Self> {
        if !(seconds.abs() < f64::from(i32::MAX)) {
            return None;
        }
        // Both parts are exact, so only the last one is rounded.
        let whole = seconds.floor();
        let nanosec = ((seconds - whole) * f64::from(BILLION)).round() as u32;
        let carry = nanosec == BILLION;
        Some(Self { sec: whole as i32 + i32::from(carry), nanosec: if carry { 0 } else { nanosec } })
    }

    /// The same in nanoseconds; times before zero count as zero.
    pub(super) fn nanoseconds(self) -> u64 {
        u64::try_from(self.sec).map_or(0, |sec| sec * u64::from(BILLION) + u64::from(self.nanosec))
    }

    /// The same in seconds: the double nearest to it.
    pub(super) fn seconds(self) -> f64 {
        let all = i64::from(self.sec) * i64::from(BILLION) + i64::from(self.nanosec);
        // Below 104 days this is a quotient of two doubles that are exact, and so the nearest.
        all as f64 / f64::from(BILLION)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn whole_nanoseconds_come_back(sec in -1000_i32..1_000_000, nanosec in 0..BILLION) {
            let stamp = Stamp { sec, nanosec };
            prop_assert_eq!(Stamp::of(stamp.seconds()), Some(stamp));
        }
    }

    #[test]
    fn a_time_just_below_a_second_is_carried() {
        assert_eq!(Stamp::of(1.0 - 1e-12), Some(Stamp { sec: 1, nanosec: 0 }));
        assert_eq!(Stamp::of(3e9), None);
        assert_eq!(Stamp::of(f64::NAN), None);
    }
}
