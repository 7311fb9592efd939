//! Smooth maxima of a sampled function: Kreisselmeier–Steinhauser and induced exponential.

use super::Scalar;

/// Side of the maximum on which an aggregate lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bound {
    /// Never above it.
    #[default]
    Below,
    /// Never below it.
    Above,
}

/// The softmax of values g_k with quadrature weights c_k: KS = (1/ρ) ln Σ c_k e^{ρ g_k}, with
/// ∂KS/∂g_k = w_k. Σ c_k = 1 for quadratures in time.
///
/// Every exponent ρ (g_k − g_m) is ≤ 0 for the largest value g_m, so none overflows.
#[derive(Clone, Debug)]
pub struct SoftMax<S> {
    /// Weights w_k = ∂KS/∂g_k = c_k e^{ρ(g_k − g_m)} / Σ, Σ w_k = 1.
    pub weights: Vec<S>,
    /// g_m + (1/ρ) ln Σ c_k e^{ρ(g_k − g_m)} (Kennedy & Hicken 2015, eq. 10).
    pub ks: S,
    /// The true maximum g_m.
    pub maximum: f64,
    /// Index of the maximum (the first).
    pub peak: usize,
}

impl<S: Scalar> SoftMax<S> {
    /// Aggregates `values` with the parameter `rho` > 0 and the quadrature weights `c` (Σ c = 1, or
    /// numbers of maxima minus minima).
    ///
    /// # Panics
    /// `values` is empty.
    pub fn new(values: &[S], c: impl Fn(usize) -> S, rho: f64) -> Self {
        let peak = (0..values.len())
            .reduce(|best, k| {
                if values[k].re() > values[best].re() {
                    k
                } else {
                    best
                }
            })
            .expect("a run has at least one instant");
        let top = values[peak];
        let mut weights: Vec<S> = values
            .iter()
            .enumerate()
            .map(|(k, &g)| ((g - top) * rho).exp() * c(k))
            .collect();
        let sum = weights.iter().fold(S::zero(), |sum, &w| sum + w);
        for w in &mut weights {
            *w /= sum;
        }
        Self {
            weights,
            ks: top + sum.ln() / rho,
            maximum: top.re(),
            peak,
        }
    }

    /// The induced exponential Σ w_k g_k (Kennedy & Hicken 2015, eq. 16).
    pub fn induced_exponential(&self, values: &[S]) -> S {
        let top = values[self.peak];
        let sum = |sum, (&w, &g): (&S, &S)| sum + w * (g - top);
        self.weights.iter().zip(values).fold(top, sum)
    }
}

/// An aggregate that differs from what it stands for by more than this part is told.
const NEAR: f64 = 0.01;
/// Largest number of parameters that are tried, and the ratio of two of them that are close enough.
const TRIALS: usize = 20;
const CLOSE: f64 = 1.2;
/// A true value below this part of the size of what is smoothed is zero.
pub const ZERO: f64 = 1e-6;
/// Above this factor the samples decide which value is smoothed.
const SHARPEST: f64 = 1e7;

/// ρ times the size of the values of an aggregate that is far from its true value.
const BLUNT: f64 = 3.0;

/// What a smooth aggregate stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothed {
    /// The true value.
    pub value: f64,
    /// How far the aggregate is from it, if that is more than 1 %.
    pub far: Option<Far>,
}

/// An aggregate that is not near its true value.
#[derive(Clone, Debug, PartialEq)]
pub struct Far {
    /// The difference, relative to the true value, or to the size of what is smoothed if the true value is zero.
    pub part: f64,
    /// Whether the true value is zero.
    pub of_zero: bool,
    /// Parameters ρ that would leave at most 1 % of it, if some are known.
    pub rho: Option<Vec<f64>>,
}

impl std::fmt::Display for Far {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "the aggregate differs from it by {:.2} %{}",
            100.0 * self.part,
            if self.of_zero {
                " of the largest size"
            } else {
                ""
            }
        )?;
        let Some(rho) = &self.rho else {
            return write!(
                f,
                ", and with these samples no \"rho\" brings it within 1 %"
            );
        };
        let rho: Vec<String> = rho.iter().map(|rho| format!("{rho}")).collect();
        write!(
            f,
            "; a \"rho\" of {} keeps it within 1 %",
            rho.join(" and ")
        )
    }
}

/// Compares an aggregate with its true value; `scale` is the size that differences are relative to, and `with` gives
/// the aggregate with every ρ times a factor.
pub fn smoothed(
    aggregate: f64,
    (value, scale): (f64, f64),
    rho: Vec<f64>,
    with: impl Fn(f64) -> f64,
) -> Smoothed {
    let most = NEAR * scale;
    let mut difference = (aggregate - value).abs();
    if !(difference > most && most > 0.0) {
        return Smoothed { value, far: None };
    }
    let part = difference / scale;
    // The factors of an aggregate that is far and of one that is near.
    let (mut far, mut near) = (1.0, f64::INFINITY);
    for _ in 0..TRIALS {
        // The difference falls as ln(number of values)/ρ or faster.
        let factor = match near.is_finite() {
            true => f64::sqrt(far * near),
            false => far * (difference / most).clamp(1.1, 1e3),
        };
        difference = (with(factor) - value).abs();
        match difference <= most {
            true => near = factor,
            false => far = factor,
        }
        if near < CLOSE * far {
            break;
        }
    }
    let rho = (near < SHARPEST).then(|| {
        let sharper = rho.iter().map(|rho| two_digits(rho * near));
        sharper.collect()
    });
    Smoothed {
        value,
        far: Some(Far {
            part,
            of_zero: value.abs() < ZERO * scale,
            rho,
        }),
    }
}

/// The smallest ρ of two digits that keeps an aggregate within 1 % of its true value, relative to `scale`; `with` gives the
/// aggregate with a ρ. `None` if there is none.
pub fn near(of: (f64, f64), with: impl Fn(f64) -> f64) -> Option<f64> {
    // The first is far from any but single values.
    let first = BLUNT / of.1;
    let found = smoothed(with(first), of, vec![first], |factor| with(first * factor));
    match found.far {
        Some(far) => far.rho?.first().copied(),
        None => (first > 0.0 && first.is_finite()).then(|| two_digits(first)),
    }
}

/// A number of two digits that is not below `x` > 0: half a unit of the second digit is at most 5 % of it.
pub fn two_digits(x: f64) -> f64 {
    format!("{:.1e}", 1.05 * x).parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_rho_is_finite_and_bounded_by_the_maximum() {
        let values = [-850.0, 3.0, 849.0, 12.0];
        for rho in [1e-3, 0.3, 1e3, 1e6] {
            let soft = SoftMax::new(&values, |_| 0.25, rho);
            assert!(soft.ks.is_finite() && soft.ks <= soft.maximum);
            assert!(soft.ks >= soft.maximum + 0.25_f64.ln() / rho);
            assert!((soft.weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            assert!(soft.induced_exponential(&values) <= 849.0 + 1e-9);
        }
    }

    /// The minimum −(1/ρ) ln Σ e^{−ρ f} of n equal values lies ln n / ρ below them: 1 % of them at ρ = 100 ln n / f.
    #[test]
    fn the_rho_that_is_told_brings_the_aggregate_within_one_percent() {
        for (value, count, rho) in [
            (7.0, 4, 0.1),
            (1e-3, 9, 3.0),
            (2e6, 2, 1e-8),
            (0.5, 100, 40.0),
        ] {
            let gap = |rho: f64| f64::from(count).ln() / rho;
            let with = |factor: f64| value - gap(rho * factor);
            let found = smoothed(with(1.0), (value, value), vec![rho], with);
            let far = found.far.expect("it is far");
            assert!((far.part - gap(rho) / value).abs() < 1e-12 * far.part);
            let told = far.rho.expect("it is known")[0];
            assert!(gap(told) <= 0.01 * value, "{told}");
            let least = 100.0 * f64::from(count).ln() / value;
            assert!(told < 1.4 * least, "{told} {least}");
            let near = smoothed(value - gap(told), (value, value), vec![told], |_| f64::NAN);
            assert_eq!(near.far, None);
        }
        // What no ρ brings near, and a scale of zero.
        let never = smoothed(2.0, (1.0, 1.0), vec![1.0], |_| 2.0);
        assert_eq!(never.far.expect("it is far").rho, None);
        let late = smoothed(2.0, (1.0, 1.0), vec![1.0], |factor| {
            if factor < 1e12 { 2.0 } else { 1.0 }
        });
        assert_eq!(late.far.expect("it is far").rho, None);
        // A true value of zero, beside a quantity of the size 3.
        let zero = smoothed(-0.9, (0.0, 3.0), vec![1.0], |factor| -0.9 / factor);
        let far = zero.far.expect("it is far");
        assert!(far.of_zero && (far.part - 0.3).abs() < 1e-15, "{far}");
        assert!(
            far.rho
                .as_ref()
                .is_some_and(|rho| rho[0] >= 30.0 && rho[0] < 45.0),
            "{far}"
        );
        assert_eq!(smoothed(2.0, (0.0, 0.0), vec![1.0], |_| 2.0).far, None);
    }

    #[test]
    fn numbers_of_two_digits_are_not_below() {
        for x in [1.0, 1.04, 9.94, 9.99, 1.23e-7, 8.76e9] {
            let rounded = two_digits(x);
            assert!(rounded >= x && rounded <= 1.11 * x, "{x} {rounded}");
        }
    }

    /// Comparison with the formula itself, with exponents that do not overflow.
    #[test]
    fn value_is_the_logarithm_of_the_mean_exponential() {
        let values = [0.3, -1.2, 2.0, 1.9, 0.0];
        let c = [0.1, 0.25, 0.05, 0.35, 0.25];
        for rho in [1e-3, 0.3, 2.0, 50.0] {
            let soft = SoftMax::new(&values, |k| c[k], rho);
            let exponential = |(c, g): (&f64, &f64)| c * (rho * g).exp();
            let sum: f64 = c.iter().zip(&values).map(exponential).sum();
            assert!((soft.ks - sum.ln() / rho).abs() < 1e-12, "{rho}");
            let mean = |(w, g): (&f64, &f64)| w * g;
            let induced: f64 = soft.weights.iter().zip(&values).map(mean).sum();
            assert!((soft.induced_exponential(&values) - induced).abs() < 1e-14);
        }
        // ∫₀¹ e^{ρ t} dt = (e^ρ − 1)/ρ, by Simpson's rule.
        let n = 200;
        let line: Vec<f64> = (0..=n).map(|k| f64::from(k) / f64::from(n)).collect();
        let simpson = |k: usize| match k {
            0 | 200 => 1.0 / 600.0,
            k if k % 2 == 1 => 4.0 / 600.0,
            _ => 2.0 / 600.0,
        };
        for rho in [0.1_f64, 1.0, 5.0] {
            let exact = (rho.exp_m1() / rho).ln() / rho;
            assert!(
                (SoftMax::new(&line, simpson, rho).ks - exact).abs() < 1e-8,
                "{rho}"
            );
        }
    }

    #[test]
    fn the_integral_form_does_not_move_with_refinement() {
        let aggregate = |n: usize| {
            let values: Vec<f64> = (0..=n).map(|k| (3.0 * k as f64 / n as f64).sin()).collect();
            let c = |k: usize| if k == 0 || k == n { 0.5 } else { 1.0 } / n as f64;
            SoftMax::new(&values, c, 10.0).ks
        };
        assert!((aggregate(200) - aggregate(3200)).abs() < 1e-3);
        assert!((aggregate(1600) - aggregate(3200)).abs() < 2e-5);
    }
}
