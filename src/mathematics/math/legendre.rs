//! Legendre polynomials on [−1, 1], and Gauss' rule on [0, 1].

use super::Scalar;

/// P_0(t) … P_n(t) by Bonnet's recurrence (k + 1) P_{k+1} = (2k + 1) t P_k − k P_{k−1}.
pub fn legendre<S: Scalar>(n: usize, t: S) -> Vec<S> {
    let mut p = vec![S::one()];
    if n > 0 {
        p.push(t);
    }
    for k in 1..n {
        let at = k as f64;
        p.push((t * p[k] * (2.0 * at + 1.0) - p[k - 1] * at) / (at + 1.0));
    }
    p
}

/// P_0'(t) … P_n'(t) from the polynomials: P'_{k+1} = P'_{k−1} + (2k + 1) P_k.
pub fn legendre_slopes<S: Scalar>(p: &[S]) -> Vec<S> {
    let mut slopes = vec![S::zero()];
    if p.len() > 1 {
        slopes.push(S::one());
    }
    for k in 1..p.len().saturating_sub(1) {
        slopes.push(slopes[k - 1] + p[k] * (2.0 * k as f64 + 1.0));
    }
    slopes
}

/// Points and weights of Gauss' rule on [0, 1], exact for polynomials of degree 2n − 1. The points are the
/// zeros of P_n by Newton's method from Tricomi's estimate.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let zero = |i: usize| {
        let mut t = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let p = legendre(n, t);
            slope = legendre_slopes(&p)[n];
            let step = p[n] / slope;
            t -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        (0.5 - 0.5 * t, 1.0 / ((1.0 - t * t) * slope * slope))
    };
    (0..n).map(zero).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_integrates_powers_up_to_its_degree() {
        for n in 1..40 {
            let rule = gauss(n);
            for power in 0..2 * n {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(power as i32)).sum();
                let exact = 1.0 / (power as f64 + 1.0);
                assert!((sum - exact).abs() < 1e-14, "{n} points, x^{power}: {sum}");
            }
        }
    }

    #[test]
    fn legendre_polynomials_are_orthogonal_and_have_their_slopes() {
        let rule = gauss(24);
        for i in 0..20 {
            for j in 0..20 {
                let product = |x: f64| {
                    let p = legendre(20, 2.0 * x - 1.0);
                    p[i] * p[j]
                };
                let sum: f64 = rule.iter().map(|&(x, w)| w * product(x)).sum();
                let exact = if i == j {
                    1.0 / (2.0 * i as f64 + 1.0)
                } else {
                    0.0
                };
                assert!((sum - exact).abs() < 1e-14, "{i} {j}: {sum}");
            }
        }
        for t in [-0.9, -0.2, 0.4, 1.0] {
            let t = crate::math::Dual::new(t, 1.0);
            let p = legendre(12, t);
            for (p, slope) in p.iter().zip(legendre_slopes(&p)) {
                assert!((p.du - slope.re).abs() < 1e-12 * slope.re.abs().max(1.0));
            }
        }
    }
}
