//! Times as files have them: in a unit, since a start of their own or since 1970.

use std::str::FromStr;

use super::error::excerpt;

/// Ticks in one of a unit: nine decimals are kept of what is written.
const TICKS: i128 = 1_000_000_000;
/// The first time \[s\] that is taken for a date: three years.
const DATE: i128 = 100_000_000;

/// The unit in which times are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// Seconds.
    Seconds,
    /// Milliseconds.
    Milliseconds,
    /// Microseconds.
    Microseconds,
    /// Nanoseconds.
    Nanoseconds,
}

impl TimeUnit {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Seconds, Self::Milliseconds, Self::Microseconds, Self::Nanoseconds];

    /// The sign for it: `s`, `ms`, `us` or `ns`.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Seconds => "s",
            Self::Milliseconds => "ms",
            Self::Microseconds => "us",
            Self::Nanoseconds => "ns",
        }
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Seconds => "seconds",
            Self::Milliseconds => "milliseconds",
            Self::Microseconds => "microseconds",
            Self::Nanoseconds => "nanoseconds",
        }
    }

    /// How many make a second.
    pub fn per_second(self) -> f64 {
        self.in_second() as f64
    }

    fn in_second(self) -> i128 {
        match self {
            Self::Seconds => 1,
            Self::Milliseconds => 1_000,
            Self::Microseconds => 1_000_000,
            Self::Nanoseconds => 1_000_000_000,
        }
    }

    /// The unit of a date that is a whole number. Dates from 1973 to 2286 have so many digits in each unit, and in a coarser
    /// one would be thousands of years away.
    fn of_date(whole: i128) -> Option<Self> {
        [
            (10_i128.pow(17), Self::Nanoseconds),
            (10_i128.pow(14), Self::Microseconds),
            (10_i128.pow(11), Self::Milliseconds),
        ]
        .into_iter()
        .find(|&(least, _)| (least..100 * least).contains(&whole))
        .map(|(_, unit)| unit)
    }
}

impl FromStr for TimeUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|unit| unit.symbol() == text);
        found.ok_or_else(|| format!("\"{text}\" is no unit of time; known are s, ms, us, ns"))
    }
}

/// Where times that are kept as whole numbers begin, and how many ticks make a second.
#[derive(Clone, Copy, Debug)]
struct Exact {
    base: i128,
    per_second: i128,
}

/// The times of the samples while they are read. Dates are kept as whole numbers until the first is taken off: a double holds
/// only a quarter of a microsecond of them.
#[derive(Clone, Debug)]
pub(super) struct Times {
    unit: Option<TimeUnit>,
    exact: Option<Exact>,
    /// Whether a first time has decided what they are.
    is_begun: bool,
    seconds: Vec<f64>,
    note: Option<String>,
}

impl Times {
    /// No times yet, in a unit where it is known.
    pub(super) fn new(unit: Option<TimeUnit>) -> Self {
        Self { unit, exact: None, is_begun: false, seconds: Vec::new(), note: None }
    }

    pub(super) fn reserve(&mut self, samples: usize) {
        self.seconds.reserve(samples);
    }

    pub(super) fn len(&self) -> usize {
        self.seconds.len()
    }

    /// Adds a time as it is written.
    pub(super) fn push(&mut self, text: &str) -> Result<(), String> {
        let ticks = if !self.is_begun || self.exact.is_some() { ticks(text) } else { None };
        if !self.is_begun
            && let Some(ticks) = ticks
        {
            self.begin(ticks);
        }
        let seconds = match (self.exact, ticks) {
            (Some(exact), Some(ticks)) => exact.seconds(ticks),
            _ => number(text)? / self.unit.map_or(1.0, TimeUnit::per_second),
        };
        self.add(seconds)
    }

    /// Whether there are times, and they are taken as they are written.
    pub(super) fn are_plain_seconds(&self) -> bool {
        self.is_begun && self.exact.is_none() && self.unit.is_none()
    }

    /// Adds a time \[s\] to [plain](Self::are_plain_seconds) ones, and returns whether it comes after them.
    pub(super) fn push_seconds(&mut self, time: f64) -> bool {
        self.add(time).is_ok()
    }

    /// No times yet, of those that go on behind these.
    pub(super) fn following(&self) -> Self {
        Self { seconds: Vec::new(), note: None, ..*self }
    }

    /// Adds times that go on behind these, and returns whether they come after them.
    pub(super) fn append(&mut self, other: &Self) -> bool {
        let is_later = match (self.seconds.last(), other.seconds.first()) {
            (Some(last), Some(first)) => first > last,
            _ => true,
        };
        self.seconds.extend_from_slice(&other.seconds);
        is_later
    }

    /// Adds a time of a format that has numbers.
    pub(super) fn push_real(&mut self, time: f64) -> Result<(), String> {
        // The decimals of a double read back as it was.
        self.push(&time.to_string())
    }

    /// Adds a time of whole nanoseconds.
    pub(super) fn push_nanoseconds(&mut self, nanoseconds: i128) -> Result<(), String> {
        if !self.is_begun {
            let (base, note) = start(nanoseconds, TICKS);
            self.exact = Some(Exact { base, per_second: TICKS });
            self.note = note;
        }
        let exact = self.exact.unwrap_or(Exact { base: 0, per_second: TICKS });
        self.add(exact.seconds(nanoseconds * (exact.per_second / TICKS)))
    }

    /// Decides by the first time what all of them are.
    fn begin(&mut self, ticks: i128) {
        let whole = (ticks % TICKS == 0).then_some(ticks / TICKS);
        let guess = whole.and_then(TimeUnit::of_date).filter(|_| self.unit.is_none());
        let unit = guess.or(self.unit).unwrap_or(TimeUnit::Seconds);
        let per_second = TICKS * unit.in_second();
        let (base, date) = start(ticks, per_second);
        if base == 0 && unit == TimeUnit::Seconds {
            return;
        }
        self.exact = Some(Exact { base, per_second });
        let guessed = guess.map(|unit| format!("times are whole {} since 1970", unit.name()));
        self.note = [guessed, date].into_iter().flatten().reduce(|one, other| format!("{one}; {other}"));
    }

    fn add(&mut self, seconds: f64) -> Result<(), String> {
        match self.seconds.last() {
            Some(&before) if seconds <= before => Err(super::read::not_later(before, seconds)),
            _ => {
                self.is_begun = true;
                self.seconds.push(seconds);
                Ok(())
            }
        }
    }

    /// Returns the times \[s\], and adds what there is to say of them.
    pub(super) fn finish(self, notes: &mut Vec<String>) -> Vec<f64> {
        notes.extend(self.note);
        self.seconds
    }
}

impl Exact {
    fn seconds(self, ticks: i128) -> f64 {
        let since = ticks - self.base;
        // Below 104 days this is a quotient of two doubles that are exact, and so the nearest.
        if since % TICKS == 0 {
            (since / TICKS) as f64 / (self.per_second / TICKS) as f64
        } else {
            since as f64 / self.per_second as f64
        }
    }
}

/// From where times count that begin with this one, and what to say of it.
fn start(ticks: i128, per_second: i128) -> (i128, Option<String>) {
    let seconds = ticks / per_second;
    if seconds < DATE {
        return (0, None);
    }
    (ticks, Some(format!("times count from the first sample, {seconds} s since 1970")))
}

/// A decimal number without exponent, in ticks.
fn ticks(text: &str) -> Option<i128> {
    let (sign, plain) = text.strip_prefix('-').map_or((1, text), |plain| (-1, plain));
    let (whole, fraction) = plain.split_once('.').unwrap_or((plain, ""));
    let is_plain = |digits: &str| digits.len() <= 20 && digits.bytes().all(|digit| digit.is_ascii_digit());
    if whole.is_empty() || !is_plain(whole) || !is_plain(fraction) {
        return None;
    }
    let mut part = fraction.bytes().chain(std::iter::repeat(b'0')).take(9).fold(0, digit);
    part += whole.bytes().fold(0, digit) * TICKS;
    Some(sign * part)
}

fn digit(value: i128, digit: u8) -> i128 {
    10 * value + i128::from(digit - b'0')
}

fn number(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) => Err(format!("the time is {value}, which is not a finite number")),
        Err(_) if text.is_empty() => Err("a gap: the time is missing".to_owned()),
        Err(_) => Err(format!("the time is not a number: `{}`", excerpt(text))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(unit: Option<TimeUnit>, texts: &[String]) -> (Vec<f64>, Vec<String>) {
        let mut times = Times::new(unit);
        texts.iter().try_for_each(|text| times.push(text)).unwrap();
        let mut notes = Vec::new();
        (times.finish(&mut notes), notes)
    }

    proptest! {
        #[test]
        fn dates_in_every_unit_keep_their_nanoseconds(
            start in 200_000_000_i128..4_000_000_000, gaps in proptest::collection::vec(1_i128..1_000_000_000, 1..6),
        ) {
            let mut since = vec![0];
            for gap in &gaps {
                since.push(since[since.len() - 1] + gap);
            }
            for unit in TimeUnit::ALL {
                // A unit with nine decimals, without a point where it is nanoseconds.
                let scale = TICKS / unit.in_second();
                let written = |ns: &i128| -> String {
                    let all = start * TICKS + ns / scale * scale;
                    if scale == TICKS { format!("{}.{:09}", all / TICKS, start * TICKS % TICKS + ns % TICKS) } else { (all / scale).to_string() }
                };
                let kept = |ns: &i128| if scale == TICKS { *ns } else { ns / scale * scale };
                let mut whole: Vec<i128> = since.iter().map(kept).collect();
                whole.dedup();
                let mut texts: Vec<String> = since.iter().map(written).collect();
                texts.dedup();
                prop_assume!(texts.len() == whole.len());
                let expected: Vec<f64> = whole.iter().map(|&ns| ns as f64 / 1e9).collect();
                for unit in [None, Some(unit)] {
                    let (seconds, notes) = read(unit, &texts);
                    let apart = seconds.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    prop_assert!(seconds.len() == expected.len() && apart < 1e-12, "{:?} {:?}", seconds, expected);
                    prop_assert!(notes[0].contains("count from the first sample"), "{:?}", notes);
                }
            }
        }
    }

    #[test]
    fn times_that_may_be_seconds_are_taken_as_they_are() {
        for texts in [["0", "1000000"], ["0.1", "0.30000000000000004"], ["-5e-1", "99999999"]] {
            let (seconds, notes) = read(None, &texts.map(str::to_owned));
            assert_eq!(seconds, texts.map(|text| text.parse::<f64>().unwrap()));
            assert!(notes.is_empty(), "{notes:?}");
        }
        let (seconds, _) = read(Some(TimeUnit::Milliseconds), &["8", "16.5"].map(str::to_owned));
        assert_eq!(seconds, [0.008, 0.0165]);
        assert!("h".parse::<TimeUnit>().unwrap_err().contains("ns"));
    }
}
