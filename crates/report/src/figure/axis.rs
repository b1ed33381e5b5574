//! Axes: their ranges, and ticks at round numbers.

use std::f64::consts::PI;

use super::style::{FONT_SIZE, shortened, text_width};
use crate::short;

/// How an axis counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By powers of ten; the range must be positive.
    Logarithmic,
    /// Evenly, with ticks at fractions of pi.
    Angle,
    /// By names: 0, 1, 2 and so on stand for them.
    Named,
}

/// One side of a figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What is counted, with its unit.
    pub label: String,
    /// The name of the column in the CSV file.
    pub column: String,
    /// How.
    pub scale: Scale,
    /// From where to where.
    pub range: (f64, f64),
    /// What 0, 1, 2 and so on stand for on an axis of names.
    pub names: Vec<String>,
}

/// A mark on an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    /// Text, and an exponent to be raised.
    pub(super) label: (String, Option<String>),
}

impl Axis {
    /// Returns an axis; a range without length is widened.
    pub fn new(label: &str, column: &str, scale: Scale, (low, high): (f64, f64)) -> Self {
        // The length of the range has to be a number too.
        const FAR: f64 = f64::MAX / 4.0;
        let (low, high) = if low.is_finite() && high.is_finite() {
            (low.clamp(-FAR, FAR), high.clamp(-FAR, FAR))
        } else {
            (low, high)
        };
        let usable = low.is_finite() && high.is_finite() && low < high;
        let positive = scale != Scale::Logarithmic || low > 0.0;
        let range = match (usable && positive, scale) {
            (true, _) => (low, high),
            (false, Scale::Logarithmic) => {
                let top = if high.is_finite() && high > 0.0 { high } else { 1.0 };
                (top / 10.0, top * 1.1)
            }
            (false, _) if low.is_finite() => (low - 0.5, low + 0.5),
            (false, _) => (0.0, 1.0),
        };
        Self { label: label.to_owned(), column: column.to_owned(), scale, range, names: Vec::new() }
    }

    /// Returns an axis of names, each with as much room as the others.
    pub fn named(label: &str, column: &str, names: Vec<String>) -> Self {
        let range = (-0.5, names.len().max(1) as f64 - 0.5);
        Self { label: label.to_owned(), column: column.to_owned(), scale: Scale::Named, range, names }
    }

    /// The place of a value along the axis: 0 at its beginning, 1 at its end.
    pub(super) fn place(&self, value: f64) -> f64 {
        let (low, high) = self.range;
        match self.scale {
            Scale::Logarithmic => (value.ln() - low.ln()) / (high.ln() - low.ln()),
            _ => (value - low) / (high - low),
        }
    }

    /// The ticks of an axis that is `room` long, for labels that take `label` of it [px].
    pub(super) fn ticks(&self, room: f64, label: f64) -> Vec<Tick> {
        // A few ticks stand closer, as one tells nothing about a scale.
        let few = (room / (1.55 * label)).clamp(1.5, 4.0);
        let most = (room / (2.8 * label + 4.0)).clamp(few, 14.0);
        match self.scale {
            Scale::Linear => linear_ticks(self.range, most.min(12.0)),
            Scale::Angle => angle_ticks(self.range),
            Scale::Named => self.named_ticks(room, label),
            Scale::Logarithmic => logarithmic_ticks(self.range, 1.2 * most),
        }
    }
}

impl Axis {
    /// A tick for each name, or for one of several where they would stand over each other. Labels may be as wide as a row
    /// is high in an upright axis, whose `label` is no wider than the letters are high.
    fn named_ticks(&self, room: f64, label: f64) -> Vec<Tick> {
        const WORD: usize = 18;
        let upright = label <= FONT_SIZE;
        let each = room / self.names.len().max(1) as f64;
        let longest = if upright { WORD } else { ((each / text_width("x", FONT_SIZE)) as usize).max(6) };
        let text = |name: &String| shortened(&plain(name), longest);
        let wide = |name: &String| text_width(&text(name), FONT_SIZE) + 6.0;
        let needed = if upright { FONT_SIZE + 2.0 } else { self.names.iter().map(wide).fold(0.0, f64::max) };
        let stride = (needed / each).ceil().max(1.0) as usize;
        let names = self.names.iter().enumerate().step_by(stride);
        names.map(|(k, name)| Tick { value: k as f64, label: (text(name), None) }).collect()
    }
}

/// A name as it is; a number with many digits with as many as tell something.
fn plain(name: &str) -> String {
    const LONG: usize = 7;
    let number = name.parse::<f64>().ok().filter(|_| name.len() > LONG);
    number.map_or_else(|| name.to_owned(), short)
}

fn linear_ticks((low, high): (f64, f64), wanted: f64) -> Vec<Tick> {
    let rough = (high - low) / wanted;
    let power = rough.log10().floor();
    let step =
        [1.0, 2.0, 5.0, 10.0].map(|m| m * 10_f64.powf(power)).into_iter().find(|s| *s >= rough * 0.999);
    let step = step.unwrap_or(rough);
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let size = low.abs().max(high.abs());
    let is_plain = (1e-3..1e5).contains(&size) && decimals < 6;
    let (first, last) = ((low / step - 1e-9).ceil() as i64, (high / step + 1e-9).floor() as i64);
    (first..=last)
        .map(|k| {
            let value = k as f64 * step;
            let label =
                if is_plain { (signed(&format!("{value:.decimals$}")), None) } else { powered(value, step) };
            Tick { value, label }
        })
        .collect()
}

/// A number as digits and a power of ten, with the digits that tell it from its neighbours `step` away.
fn powered(value: f64, step: f64) -> (String, Option<String>) {
    if value == 0.0 {
        return ("0".to_owned(), None);
    }
    let digits = (value.abs().log10().floor() - step.log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$e}");
    let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
    (format!("{}\u{b7}10", signed(digits)), Some(signed(power)))
}

/// A number with a proper minus, and none before a zero.
fn signed(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text.to_owned(),
    }
}

fn angle_ticks((low, high): (f64, f64)) -> Vec<Tick> {
    let quarters = ((low / PI * 4.0 - 1e-9).ceil() as i64)..=((high / PI * 4.0 + 1e-9).floor() as i64);
    quarters
        .map(|k| {
            let label = match (k, k % 4, k % 2) {
                (0, ..) => "0".to_owned(),
                (4, ..) => "\u{3c0}".to_owned(),
                (_, 0, _) => format!("{}\u{3c0}", k / 4),
                (2, ..) => "\u{3c0}/2".to_owned(),
                (_, _, 0) => format!("{}\u{3c0}/2", k / 2),
                (1, ..) => "\u{3c0}/4".to_owned(),
                _ => format!("{k}\u{3c0}/4"),
            };
            Tick { value: k as f64 * PI / 4.0, label: (label, None) }
        })
        .collect()
}

fn logarithmic_ticks((low, high): (f64, f64), most: f64) -> Vec<Tick> {
    const LEAST: usize = 3;
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let decades = high.log10() - low.log10();
    let inside = |value: f64| value >= low * 0.999_999 && value <= high * 1.000_001;
    let multiples: &[u32] = if decades < 2.0 { &[1, 2, 5] } else { &[1] };
    let stride = (decades / most).ceil().max(1.0) as usize;
    let mut ticks = Vec::new();
    for power in (first..=last).step_by(stride) {
        for &m in multiples {
            let value = f64::from(m) * 10_f64.powi(power);
            if inside(value) {
                ticks.push(Tick { value, label: logarithmic_label(m, power, decades) });
            }
        }
    }
    // On a short stretch of the axis powers of ten are rare, and even steps serve as well.
    if ticks.len() < LEAST && decades < 2.0 { linear_ticks((low, high), most) } else { ticks }
}

fn logarithmic_label(m: u32, power: i32, decades: f64) -> (String, Option<String>) {
    if decades < 2.0 && (-3..=3).contains(&power) {
        let decimals = (-power).max(0) as usize;
        return (format!("{:.decimals$}", f64::from(m) * 10_f64.powi(power)), None);
    }
    let base = if m == 1 { "10".to_owned() } else { format!("{m}\u{b7}10") };
    (base, Some(signed(&power.to_string())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, range: (f64, f64)) -> Vec<String> {
        let axis = Axis::new("x", "x", scale, range);
        axis.ticks(460.0, 26.0)
            .into_iter()
            .map(|t| t.label.0 + &t.label.1.map_or_else(String::new, |e| "^".to_owned() + &e))
            .collect()
    }

    #[test]
    fn ticks_stand_at_round_numbers() {
        assert_eq!(labels(Scale::Linear, (0.0, 1.0)), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(Scale::Linear, (-1.1, 1.1)), ["\u{2212}1.0", "\u{2212}0.5", "0.0", "0.5", "1.0"]);
        assert_eq!(labels(Scale::Angle, (0.0, PI)), ["0", "π/4", "π/2", "3π/4", "π"]);
        assert_eq!(labels(Scale::Logarithmic, (0.1, 5.0)), ["0.1", "0.2", "0.5", "1", "2", "5"]);
        assert_eq!(labels(Scale::Logarithmic, (1e-4, 1.0)), ["10^−4", "10^−3", "10^−2", "10^−1", "10^0"]);
    }

    #[test]
    fn a_range_without_length_is_widened() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            for range in [(1.0, 1.0), (0.0, 0.0), (f64::NAN, 1.0), (2.0, f64::INFINITY)] {
                let (low, high) = Axis::new("x", "x", scale, range).range;
                assert!(low < high && high.is_finite(), "{scale:?} {range:?}");
            }
        }
    }
}
