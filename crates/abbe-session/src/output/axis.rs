//! Axes of plots: their ranges, and their ticks at round numbers.

use abbe_spectra::math::elementary::{log10, powf};

/// A round number is one of these digits, multiplied by a power of ten.
const ROUND_DIGITS: [f64; 3] = [1.0, 2.0, 5.0];

/// The intervals of a linear axis, each of whose lengths is then rounded up to a round number.
const LINEAR_INTERVALS: f64 = 6.0;

/// A logarithmic axis has a label at every tick if it covers fewer decades than this.
const FEW_DECADES: f64 = 2.5;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axis {
    scale: AxisScale,
    /// The ends: values on a linear axis, and their decimal logarithms on a logarithmic axis.
    range: (f64, f64),
    page: (f64, f64),
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum AxisScale {
    Linear { step: f64 },
    Logarithmic,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) value: f64,
    /// The number beside the tick, if there is one.
    pub(super) label: Option<String>,
}

impl Axis {
    /// Returns a linear axis for the finite values, which begins and ends at ticks. `page` holds
    /// the positions of both ends.
    pub(super) fn linear(values: impl Iterator<Item = f64>, from_zero: bool, page: (f64, f64)) -> Self {
        Self::linear_with(values, from_zero, LINEAR_INTERVALS, page)
    }

    /// Returns an axis like [`Self::linear`] with at most about this number of intervals.
    pub(super) fn linear_with(
        values: impl Iterator<Item = f64>,
        from_zero: bool,
        intervals: f64,
        page: (f64, f64),
    ) -> Self {
        let (mut least, mut most) = extremes(values.filter(|value| value.is_finite()));
        if from_zero || least > most {
            (least, most) = (least.min(0.0), most.max(0.0));
        }
        if most - least <= 1e-12 * most.abs().max(least.abs()) {
            // A constant curve is drawn at half height. If all values are 0, the axis ends at 1.
            let margin = if most == 0.0 { 1.0 } else { 0.1 * most.abs() };
            (least, most) = (if from_zero { least.min(0.0) } else { least - margin }, most + margin);
        }
        let step = round_step((most - least) / intervals);
        let range = ((least / step).floor() * step, (most / step).ceil() * step);
        Self { scale: AxisScale::Linear { step }, range, page }
    }

    /// Returns a linear axis between two values, of which the first is smaller, with ticks at round
    /// numbers inside and at most about this number of intervals.
    pub(super) fn between(range: (f64, f64), intervals: f64, page: (f64, f64)) -> Self {
        Self { scale: AxisScale::Linear { step: round_step((range.1 - range.0) / intervals) }, range, page }
    }

    /// Returns a logarithmic axis for the positive finite values, with a small margin and at least
    /// one decade. `page` holds the positions of both ends.
    pub(super) fn logarithmic(values: impl Iterator<Item = f64>, page: (f64, f64)) -> Self {
        let (least, most) = extremes(values.filter(|value| *value > 0.0 && value.is_finite()).map(log10));
        let (least, most) = if least <= most { (least, most) } else { (0.0, 0.0) };
        let margin = (0.04 * (most - least)).max(0.5 * (1.0 - (most - least))).max(0.02);
        Self { scale: AxisScale::Logarithmic, range: (least - margin, most + margin), page }
    }

    pub(super) fn position(&self, value: f64) -> f64 {
        let value = match self.scale {
            AxisScale::Linear { .. } => value,
            AxisScale::Logarithmic => log10(value),
        };
        let (low, high) = self.range;
        self.page.0 + (value - low) / (high - low) * (self.page.1 - self.page.0)
    }

    /// Returns the ticks in ascending order, all with labels on a linear axis, but only at powers
    /// of ten on a logarithmic axis over many decades.
    pub(super) fn ticks(&self) -> Vec<Tick> {
        let (low, high) = self.range;
        match self.scale {
            AxisScale::Linear { step } => {
                let first = (low / step - 1e-9).ceil() * step;
                let values = (0..=((high - first) / step + 1e-9).floor() as usize).map(|i| first + i as f64 * step);
                let largest = high.abs().max(low.abs());
                values.map(|value| Tick { value, label: Some(linear_label(value, step, largest)) }).collect()
            }
            AxisScale::Logarithmic => {
                let all = round_numbers(low.floor() as i32..=high.ceil() as i32);
                let inside = all.filter(|(_, value)| (low..=high).contains(&log10(*value)));
                let has_label = |digit: f64| high - low < FEW_DECADES || digit == 1.0;
                let tick = |(digit, value)| Tick { value, label: has_label(digit).then(|| logarithmic_label(value)) };
                inside.map(tick).collect()
            }
        }
    }
}

/// Returns the least and the largest value, or (∞, −∞) if there are no values.
fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| (least.min(value), most.max(value)))
}

/// Returns pairs of the first digit and the round number in these decades, in ascending order.
fn round_numbers(decades: std::ops::RangeInclusive<i32>) -> impl Iterator<Item = (f64, f64)> {
    decades.flat_map(|decade| ROUND_DIGITS.map(|digit| (digit, digit * 10.0_f64.powi(decade))))
}

fn round_step(step: f64) -> f64 {
    let decade = log10(step).floor() as i32;
    let mut steps = round_numbers(decade..=decade + 1).map(|(_, round)| round);
    steps.find(|round| *round >= step * (1.0 - 1e-9)).unwrap_or(step)
}

/// Returns true if numbers of this magnitude are printed as plain decimals.
fn is_plain(magnitude: f64) -> bool {
    (1e-2..1e5).contains(&magnitude)
}

/// Formats a label of a linear axis, with the decimals that the distance between ticks needs, and a
/// power of ten if the largest value of the axis is very large or small.
fn linear_label(value: f64, step: f64, largest: f64) -> String {
    let exponent = if is_plain(largest) { 0 } else { log10(largest).floor() as i32 };
    let unit = 10.0_f64.powi(exponent);
    let decimals = (-log10(step / unit * (1.0 + 1e-9)).floor()).clamp(0.0, 9.0) as usize;
    // A zero from a subtraction is printed without a sign.
    let is_zero = value.abs() < step / 2.0;
    let number = format!("{:.decimals$}", if is_zero { 0.0 } else { value / unit });
    if exponent == 0 || is_zero { number } else { format!("{number}·{}", power_of_ten(exponent)) }
}

/// Formats a label of a logarithmic axis, with a power of ten if the number is very large or small.
fn logarithmic_label(value: f64) -> String {
    if is_plain(value) {
        return format!("{}", (value * 1e6).round() / 1e6);
    }
    let exponent = (log10(value) + 1e-9).floor();
    let digit = (value / powf(10.0_f64, exponent)).round();
    let power = power_of_ten(exponent as i32);
    if digit == 1.0 { power } else { format!("{digit}·{power}") }
}

/// Formats a power of ten, such as 10⁻⁴.
pub fn power_of_ten(exponent: i32) -> String {
    let small = |c: char| match c {
        '-' => '⁻',
        _ => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][c.to_digit(10).unwrap_or(0) as usize],
    };
    format!("10{}", exponent.to_string().chars().map(small).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: (f64, f64) = (0.0, 100.0);

    #[test]
    fn linear_axes_end_at_round_numbers_that_contain_all_values() {
        let range = |values: &[f64], from_zero| Axis::linear(values.iter().copied(), from_zero, PAGE).range;
        assert_eq!(range(&[0.13, 0.87], false), (0.0, 1.0));
        let index = range(&[1.5133, 1.5308], false);
        assert!(index.0 <= 1.5133 && index.1 >= 1.5308 && index.1 - index.0 < 0.03, "{index:?}");
        let zero = range(&[0.0], true);
        assert!(zero.0 == 0.0 && zero.1 >= 1.0);
        let constant = range(&[0.5, 0.5], true);
        assert!(constant.0 == 0.0 && constant.1 >= 0.5);
        let empty = range(&[f64::NAN], false);
        assert!(empty.0.is_finite() && empty.1 > empty.0, "{empty:?}");
    }

    #[test]
    fn an_axis_between_given_ends_has_round_ticks_inside() {
        let values = |range| Axis::between(range, 4.0, PAGE).ticks().iter().map(|tick| tick.value).collect::<Vec<_>>();
        assert_eq!(values((0.0, 14.0)), [0.0, 5.0, 10.0]);
        assert_eq!(values((-1.0, 1.0)), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(values((430.0, 655.0)), [500.0, 600.0]);
    }

    #[test]
    fn powers_are_evenly_spaced_on_a_logarithmic_axis() {
        let axis = Axis::logarithmic([1.0, 100.0].into_iter(), PAGE);
        let [a, b, c] = [1.0, 10.0, 100.0].map(|value| axis.position(value));
        assert!((b - a - (c - b)).abs() < 1e-9 && a > 0.0 && c < 100.0);
    }

    #[test]
    fn steps_and_labels_of_linear_axes_are_short() {
        assert_eq!([0.11, 0.2, 3.0, 7.0].map(round_step), [0.2, 0.2, 5.0, 10.0]);
        assert_eq!(linear_label(0.30000000000000004, 0.1, 0.6), "0.3");
        assert_eq!(linear_label(-1e-17, 0.1, 0.6), "0.0");
        assert_eq!(linear_label(1.525, 0.005, 1.53), "1.525");
        assert_eq!(linear_label(2e13, 1e13, 6e13), "2·10¹³");
        assert_eq!([5e-5, 2e-4].map(|value| linear_label(value, 5e-5, 2e-4)), ["0.5·10⁻⁴", "2.0·10⁻⁴"]);
    }

    #[test]
    fn labels_of_logarithmic_axes_are_short() {
        let labels = [0.01, 1.0, 50.0, 2e-3, 1e-4, 1e7].map(logarithmic_label);
        assert_eq!(labels, ["0.01", "1", "50", "2·10⁻³", "10⁻⁴", "10⁷"]);
        let ticks = Axis::logarithmic([0.9, 12.0].into_iter(), PAGE).ticks();
        let labels: Vec<&str> = ticks.iter().filter_map(|tick| tick.label.as_deref()).collect();
        assert_eq!(labels, ["1", "2", "5", "10"]);
        let empty = Axis::logarithmic([].into_iter(), PAGE);
        assert!(empty.range.0 < empty.range.1 && empty.ticks().len() >= 2);
    }
}
