//! Axes: ranges, ticks and the numbers at them.

use super::canvas::text_width;

/// How values are spread along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scale {
    Linear,
    /// By the logarithm to base ten.
    Logarithmic,
}

/// A range of values with its ticks.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    pub low: f64,
    pub high: f64,
    pub scale: Scale,
    pub label: String,
    pub ticks: Vec<(f64, String)>,
}

/// A logarithmic axis spans at most this many decades; what lies deeper is marked.
const DECADES: f64 = 24.0;

impl Axis {
    /// A linear axis over all finite values, with a margin at both ends and at most `count + 1`
    /// ticks.
    pub fn linear(values: impl Iterator<Item = f64>, count: usize, label: &str) -> Axis {
        let (low, high) = range(values);
        // A range that is tiny relative to its values would give equal numbers at all ticks.
        let least = 1e-8 * low.abs().max(high.abs());
        let margin = if high - low > least {
            0.05 * (high - low)
        } else {
            (0.05 * low.abs()).max(1e-3)
        };
        Axis::exact(low - margin, high + margin, count, label)
    }

    /// A linear axis from `low` to `high`.
    pub fn exact(low: f64, high: f64, count: usize, label: &str) -> Axis {
        let mut ticks = linear_ticks(low, high, nice_step((high - low) / count as f64));
        if ticks.len() < 2 {
            // A single number at the ticks does not show a range.
            ticks = linear_ticks(low, high, nice_step((high - low) / 5.0));
        }
        Axis {
            low,
            high,
            scale: Scale::Linear,
            label: label.to_owned(),
            ticks,
        }
    }

    /// An axis of whole numbers from 0 to `last`.
    pub fn counts(last: usize, count: usize, label: &str) -> Axis {
        let last = last.max(1) as f64;
        let margin = 0.02 * last;
        let mut axis = Axis::exact(-margin, last + margin, count, label);
        let step = nice_step(last / count as f64).max(1.0);
        axis.ticks = linear_ticks(0.0, last, step);
        axis
    }

    /// A logarithmic axis over all positive finite values, from one power of ten to another.
    /// Zeros and values far below the others lie under its floor.
    pub fn logarithmic(values: impl Iterator<Item = f64>, count: usize, label: &str) -> Axis {
        let (least, most) = range(values.filter(|&value| value > 0.0).map(f64::log10));
        let top = (most + 0.05).ceil();
        let floor = (least - 0.05).floor().max(top - DECADES).min(top - 1.0);
        let step = ((top - floor) / count as f64).ceil().max(1.0);
        let mut ticks = Vec::new();
        let mut decade = (floor / step).ceil() * step;
        while decade <= top {
            ticks.push((10_f64.powf(decade), format!("1e{decade}")));
            decade += step;
        }
        Axis {
            low: 10_f64.powf(floor),
            high: 10_f64.powf(top),
            scale: Scale::Logarithmic,
            label: label.to_owned(),
            ticks,
        }
    }

    /// The place of a value, 0 at the lower end and 1 at the upper one.
    pub fn fraction(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Logarithmic => (value / self.low).log10() / (self.high / self.low).log10(),
        }
    }

    /// Width of the widest number at a tick \[px\].
    pub fn widest(&self) -> f64 {
        let widths = self.ticks.iter().map(|(_, text)| text_width(text));
        widths.fold(0.0, f64::max)
    }
}

/// Smallest and largest finite value; (0, 0) if there is none.
pub(super) fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let finite = values.filter(|value| value.is_finite());
    let both = finite.fold(None, |both: Option<(f64, f64)>, value| match both {
        Some((low, high)) => Some((low.min(value), high.max(value))),
        None => Some((value, value)),
    });
    both.unwrap_or((0.0, 0.0))
}

/// The smallest of 1, 2, 5 times a power of ten that is not below `step`.
fn nice_step(step: f64) -> f64 {
    let power = 10_f64.powf(step.log10().floor());
    let factors = [1.0, 2.0, 5.0, 10.0];
    let nice = factors.iter().find(|&&f| f * power >= step * (1.0 - 1e-9));
    nice.unwrap_or(&10.0) * power
}

fn linear_ticks(low: f64, high: f64, step: f64) -> Vec<(f64, String)> {
    let largest = low.abs().max(high.abs());
    let first = (low / step - 1e-9).ceil();
    let last = (high / step + 1e-9).floor();
    let count = (last - first).max(0.0) as usize;
    (0..=count)
        .map(|i| (first + i as f64) * step)
        .map(|value| (value, number(value, step, largest)))
        .collect()
}

/// The number at a tick: as many decimals as the step between ticks needs, and `1.0e-3` where
/// plain numbers would be long. `largest` is the largest magnitude on the axis.
fn number(value: f64, step: f64, largest: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    // Steps are 1, 2 or 5 times a power of ten up to rounding.
    let last_digit = (step.log10() + 1e-6).floor();
    let plain = if (0.1..1e6).contains(&largest) {
        let decimals = (-last_digit).max(0.0) as usize;
        format!("{value:.decimals$}")
    } else {
        let digits = ((value.abs().log10() + 1e-9).floor() - last_digit).max(1.0) as usize;
        format!("{value:.digits$e}")
    };
    plain.replace('-', "−").replace("e−", "e-")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis) -> Vec<&str> {
        axis.ticks.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_the_decimals_they_need() {
        assert_eq!(
            texts(&Axis::exact(-0.3, 0.55, 5, "")),
            ["−0.2", "0.0", "0.2", "0.4"].map(|t| if t == "0.0" { "0" } else { t })
        );
        assert_eq!(
            texts(&Axis::exact(0.0, 870.0, 5, "")),
            ["0", "200", "400", "600", "800"]
        );
        assert_eq!(
            texts(&Axis::exact(-2e-3, 1e-3, 4, "")),
            ["−2.0e-3", "−1.0e-3", "0", "1.0e-3"]
        );
        assert_eq!(
            texts(&Axis::exact(0.0, 1.5e6, 4, "")),
            ["0", "5.0e5", "1.0e6", "1.5e6"]
        );
        assert_eq!(texts(&Axis::counts(3, 8, "")), ["0", "1", "2", "3"]);
    }

    #[test]
    fn a_constant_still_has_a_range() {
        for value in [0.0, 849.8985, -1e-9, 1e12] {
            let axis = Axis::linear([value].into_iter(), 4, "");
            assert!(axis.low < value && value < axis.high, "{axis:?}");
            assert!(axis.ticks.len() > 1, "{axis:?}");
            let mut distinct = texts(&axis);
            distinct.dedup();
            assert_eq!(distinct.len(), axis.ticks.len(), "{axis:?}");
        }
    }

    #[test]
    fn logarithmic_axes_span_whole_decades_and_not_too_many() {
        let axis = Axis::logarithmic([0.0, 3e-9, 2.0].into_iter(), 6, "");
        assert_eq!(texts(&axis), ["1e-8", "1e-6", "1e-4", "1e-2", "1e0"]);
        assert!(axis.fraction(3e-9) > 0.0 && axis.fraction(2.0) < 1.0);
        let deep = Axis::logarithmic([1e-300, 1.0].into_iter(), 6, "");
        assert!((deep.high / deep.low).log10() < DECADES + 0.5);
        let nothing = Axis::logarithmic([0.0, f64::NAN].into_iter(), 6, "");
        assert!(nothing.ticks.len() > 1 && nothing.low > 0.0, "{nothing:?}");
    }
}
