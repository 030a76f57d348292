//! Axes: range, ticks at round numbers, labels.

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// A linear or logarithmic axis over a range that is not empty; above zero where it is logarithmic.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    range: Range<f64>,
    logarithmic: bool,
}

/// Numbers beyond this are left out: their differences would not be numbers.
const LARGEST: f64 = 1e300;

/// Whether a value can stand on an axis.
pub(super) fn is_drawable(value: f64, logarithmic: bool) -> bool {
    value.abs() <= LARGEST && (!logarithmic || value > 1.0 / LARGEST)
}

impl Axis {
    /// An axis that holds exactly these values.
    pub(super) fn exact(values: impl Iterator<Item = f64>, logarithmic: bool) -> Self {
        let (low, high) = values
            .filter(|&v| is_drawable(v, logarithmic))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
        let range = if low < high {
            low..high
        } else if low == high && logarithmic {
            low / 2.0..high * 2.0
        } else if low == high {
            let half = (low.abs() * 0.5).max(0.5);
            low - half..high + half
        } else {
            0.1..1.0
        };
        Self { range, logarithmic }
    }

    /// An axis with some air around these values, from zero where that is near and wanted.
    pub(super) fn roomy(values: impl Iterator<Item = f64>, logarithmic: bool, from_zero: bool) -> Self {
        let Range { start: low, end: high } = Self::exact(values, logarithmic).range;
        let range = if logarithmic {
            let air = (high / low).powf(0.05);
            low / air..high * air
        } else {
            let start = if from_zero && low >= 0.0 && low < 0.5 * high { 0.0 } else { low - 0.05 * (high - low) };
            start..high + 0.06 * (high - start)
        };
        Self { range, logarithmic }
    }

    /// First and last value.
    pub(super) fn ends(&self) -> [f64; 2] {
        [self.range.start, self.range.end]
    }

    /// Round numbers on the axis, about `count` of them or fewer.
    fn ticks(&self, count: usize) -> Vec<f64> {
        if !self.logarithmic {
            return linear_ticks(&self.range, count);
        }
        let decades = self.range.start.log10().floor() as i32..=self.range.end.log10().ceil() as i32;
        let inside = |factors: &[f64], every: i32| -> Vec<f64> {
            decades
                .clone()
                .filter(|d| d.rem_euclid(every) == 0)
                .flat_map(|d| factors.iter().map(move |f| f * 10f64.powi(d)))
                .filter(|v| self.range.contains(v))
                .collect()
        };
        let choices: [(&[f64], i32); 3] = [(&[1.0, 2.0, 5.0], 1), (&[1.0, 3.0], 1), (&[1.0], 1)];
        let fine = choices.iter().map(|&(factors, every)| inside(factors, every)).find(|t| t.len() <= count);
        let ticks = fine.unwrap_or_else(|| inside(&[1.0], decades.clone().count().div_ceil(count.max(1)) as i32));
        // within a decade round numbers are as good as powers
        if ticks.len() < 2 { linear_ticks(&self.range, count) } else { ticks }
    }
}

fn linear_ticks(range: &Range<f64>, count: usize) -> Vec<f64> {
    let least = (range.end - range.start) / count.max(1) as f64;
    let power = 10f64.powf(least.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|&s| s >= least).unwrap_or(least);
    if !(step > 0.0 && step.is_finite()) {
        return Vec::new();
    }
    let first = (range.start / step).ceil();
    // adding zero makes -0 and 0 equal
    (0..=count).map(|k| (first + k as f64) * step + 0.0).take_while(|&v| v <= range.end).collect()
}

impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let part = |v: f64, low: f64, high: f64| (v - low) / (high - low);
        let Range { start, end } = self.range;
        let part = if self.logarithmic { part(value.ln(), start.ln(), end.ln()) } else { part(*value, start, end) };
        // a little outside at most: what is drawn is inside but for rounding
        let part = part.clamp(-0.01, 1.01);
        limit.0 + (part * f64::from(limit.1 - limit.0)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // no finer lines between the labelled ones
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks(hint.max_num_points().clamp(2, 10)) }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        label(*value)
    }
}

/// A number in few characters: thousands in groups, powers of ten where it is very large or small.
pub(super) fn label(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-4..1e9).contains(&size) {
        return format!("{value:.3e}").replace(".000e", "e");
    }
    // ticks are multiples of round steps: six significant digits tell neighbours apart and hide rounding
    let decimals = (5 - size.max(1e-4).log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let (sign, digits) = whole.strip_prefix('-').map_or(("", whole), |d| ("-", d));
    let mut grouped = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            grouped.push(',');
        }
        grouped.push(digit);
    }
    let point = if fraction.is_empty() { "" } else { "." };
    format!("{sign}{grouped}{point}{fraction}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_short_and_grouped() {
        let cases = [
            (0.0, "0"),
            (131_072.0, "131,072"),
            (-5000.0, "-5,000"),
            (0.30000000000000004, "0.3"),
            (12.5, "12.5"),
            (999.0, "999"),
            (2e12, "2e12"),
            (1e-7, "1e-7"),
            (0.0005, "0.0005"),
        ];
        for (value, expected) in cases {
            assert_eq!(label(value), expected);
        }
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let linear = Axis { range: -3.0..104.0, logarithmic: false };
        assert_eq!(linear.ticks(6), [0.0, 20.0, 40.0, 60.0, 80.0, 100.0]);
        let wide = Axis { range: 0.5..2e4, logarithmic: true };
        assert_eq!(wide.ticks(6), [1.0, 10.0, 100.0, 1000.0, 10_000.0]);
        let narrow = Axis { range: 1.5..60.0, logarithmic: true };
        assert_eq!(narrow.ticks(6), [2.0, 5.0, 10.0, 20.0, 50.0]);
    }

    #[test]
    fn an_axis_holds_its_values() {
        let axis = Axis::exact([3.0, f64::NAN, -2.0].into_iter(), false);
        assert_eq!(axis.range, -2.0..3.0);
        let axis = Axis::exact([3.0, 0.0, 30.0].into_iter(), true);
        assert_eq!(axis.range, 3.0..30.0);
        assert_eq!(Axis::roomy([1.0, 100.0].into_iter(), false, true).range.start, 0.0);
        assert!(Axis::roomy([90.0, 100.0].into_iter(), false, true).range.start > 80.0);
        assert!(Axis::roomy([1.0, 100.0].into_iter(), false, false).range.start < 0.0);
    }
}
